//! Wheels that follow their command with a lag, and the PI controller of `VWStartControl` that drives them.

use super::model::{Model, Wheels};
use crate::{math, pose::Twist, time::TICK};

/// Parameters of the two PI controllers: out = V (e + 1/T integral e), for the speed (v) and the turning speed (w).
///
/// Source: `VWStartControl` of RoBIOS 6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Proportional factor for the speed.
    pub vv: f64,
    /// Integral time for the speed, s.
    pub tv: f64,
    /// Proportional factor for the turning speed.
    pub vw: f64,
    /// Integral time for the turning speed, s.
    pub tw: f64,
}

impl Gains {
    /// True for factors of 0 or more and times above 0, all finite.
    pub fn is_valid(&self) -> bool {
        let factor = |v: f64| v.is_finite() && v >= 0.0;
        let time = |t: f64| t.is_finite() && t > 0.0;
        factor(self.vv) && factor(self.vw) && time(self.tv) && time(self.tw)
    }
}

/// What the wheels turn at, and what the controllers have summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Actuation {
    /// Rates of the wheels, rad/s.
    pub rates: Wheels,
    /// Integral of the error of the speed, m.
    pub sum_v: f64,
    /// Integral of the error of the turning speed, rad.
    pub sum_w: f64,
}

/// What the wheels are to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// Rates of the motors: open loop.
    Wheels(Wheels),
    /// Twist of the body: through the controllers if they run.
    Twist(Twist),
}

/// One tick of the controllers and of the lag: the rates that are then held until the next tick.
///
/// An output beyond what the wheels can do is scaled down, and no sum grows meanwhile (anti-windup).
pub(super) fn step(
    model: &Model,
    gains: Option<&Gains>,
    target: Target,
    steering: f64,
    mut actuation: Actuation,
) -> Actuation {
    let (wheels, settled) = match (target, gains) {
        (Target::Wheels(wheels), _) => (wheels, wheels),
        (Target::Twist(twist), None) => {
            let wheels = model.wheels_from_twist(twist);
            (wheels, wheels)
        }
        (Target::Twist(twist), Some(gains)) => {
            (control(model, gains, twist, steering, &mut actuation), model.wheels_from_twist(twist))
        }
    };
    let share = 1.0 - math::exp(-TICK.seconds() / model.wheel_lag);
    let close = 1e-9 * model.max_wheel_rate;
    let is_close = |a: &Wheels, b: &Wheels| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= close);
    // Settled within a billionth of the range: from here on nothing changes, and no more pieces are opened.
    if is_close(&actuation.rates, &settled) && is_close(&wheels, &settled) {
        actuation.rates = settled;
    } else {
        actuation.rates = std::array::from_fn(|i| actuation.rates[i] + share * (wheels[i] - actuation.rates[i]));
    }
    actuation
}

/// The rates that the controllers ask of the wheels; sums up the errors.
fn control(model: &Model, gains: &Gains, set: Twist, steering: f64, actuation: &mut Actuation) -> Wheels {
    let is = model.twist_from_wheels(&actuation.rates, steering);
    let close = 1e-9 * model.max_wheel_rate * model.wheel_diameter;
    let error = |set: f64, is: f64, close: f64| if (set - is).abs() <= close { 0.0 } else { set - is };
    let (error_v, error_w) =
        (error(set.vx, is.vx, close), error(set.omega, is.omega, close / model.track.min(model.wheelbase)));
    let sum_v = actuation.sum_v + error_v * TICK.seconds();
    let sum_w = actuation.sum_w + error_w * TICK.seconds();
    let out = Twist {
        vx: gains.vv * (error_v + sum_v / gains.tv),
        // Sideways speed has no controller of its own in RoBIOS.
        vy: set.vy,
        omega: gains.vw * (error_w + sum_w / gains.tw),
    };
    let wheels = model.wheels_from_twist(out);
    let excess = model.wheel_excess(&wheels);
    let saturated = excess > 1.0;
    // Once saturated a sum may only fall, or it would have to be worked off later.
    if !saturated || error_v * out.vx <= 0.0 {
        actuation.sum_v = sum_v;
    }
    if !saturated || error_w * out.omega <= 0.0 {
        actuation.sum_w = sum_w;
    }
    if saturated { wheels.map(|rate| rate / excess) } else { wheels }
}
