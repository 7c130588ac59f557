//! Wheel lag, and the controllers that drive the wheels: two PI controllers for speed and turning speed, or one PID
//! controller per wheel.

use super::{
    hull::Afloat,
    model::{Model, Wheels},
    rare::{Rare, Usual},
};
use crate::{math, pose::Twist, time::TICK};

/// Parameters of the two PI controllers, for the speed (v) and the turning speed (w). The output is V (e + I / T), with
/// the error e, its integral I, the factor V and the integral time T.
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
    /// Returns true for factors from 0 to 10^12 and times from 10^-12 to 10^12 s; other values may give an output that
    /// is not a number.
    pub fn is_valid(&self) -> bool {
        let factor = |v: f64| (0.0..=1e12).contains(&v);
        let time = |t: f64| (1e-12..=1e12).contains(&t);
        factor(self.vv) && factor(self.vw) && time(self.tv) && time(self.tw)
    }
}

/// Parameters of a wheel's PID controller: output = p e + i integral of e + d de/dt, with the error e of the wheel's
/// rate. The output is the rate to which the motor is set.
///
/// The derivative part uses only the measured rate of the wheel, so that a new command causes no jump. Without the
/// integral part an error remains: the wheel reaches p / (1 + p) of the commanded rate. Source: `MOTORPID` of RoBIOS-7;
/// form and units are our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid {
    /// Proportional factor.
    pub p: f64,
    /// Factor of the integral, 1/s.
    pub i: f64,
    /// Factor of the derivative, s.
    pub d: f64,
}

impl Pid {
    /// Returns true for factors from 0 to 10^12.
    pub fn is_valid(&self) -> bool {
        [self.p, self.i, self.d].iter().all(|factor| (0.0..=1e12).contains(factor))
    }
}

/// The controllers in operation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Controllers {
    /// The PI controllers of speed and turning speed.
    pub body: Option<Gains>,
    /// The PID controller of each wheel.
    pub wheels: [Option<Pid>; 4],
}

impl Usual for Controllers {
    const USUAL: &'static Self = &Self { body: None, wheels: [None; 4] };
}

/// State of wheels and controllers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Actuation {
    /// Rates of the wheels, rad/s.
    pub rates: Wheels,
    /// State of controllers and hull.
    pub memory: Rare<Memory>,
}

impl Actuation {
    /// The state of wheels at rest.
    pub const REST: Self = Self { rates: [0.0; 4], memory: Rare::USUAL };
}

/// State of controllers and hull.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Memory {
    /// Integral of the error of the speed, m.
    pub sum_v: f64,
    /// Integral of the error of the turning speed, rad.
    pub sum_w: f64,
    /// For each wheel whose own controller is active, the integral of the error of its rate, rad.
    pub sums: Wheels,
    /// For each wheel whose own controller is active, its rate one tick before, rad/s.
    pub last: Wheels,
    /// State of a hull in the water; its mean velocity replaces the rates of wheels.
    pub afloat: Afloat,
}

impl Usual for Memory {
    const USUAL: &'static Self = &Self {
        sum_v: 0.0,
        sum_w: 0.0,
        sums: [0.0; 4],
        last: [0.0; 4],
        afloat: Afloat { velocity: [0.0; 4], lift: 0.0 },
    };
}

/// Set points of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// Rates of the motors, rad/s: open loop, except for wheels in `held` whose own controllers run.
    Wheels { rates: Wheels, held: [bool; 4] },
    /// Twist of the body, regulated by the PI controllers if they run.
    Twist(Twist),
}

impl Target {
    /// Rates of the motors, rad/s.
    pub fn wheels(&self, model: &Model) -> Wheels {
        match *self {
            Self::Wheels { rates, .. } => rates,
            Self::Twist(twist) => model.wheels_from_twist(twist),
        }
    }
}

/// Computes one tick of controllers and lag: the rates that hold until the next tick.
///
/// An output beyond the limits of the wheels is scaled down. Integrals do not grow during saturation (anti-windup).
pub(super) fn step(
    model: &Model,
    controllers: &Controllers,
    target: Target,
    steering: f64,
    before: &Actuation,
) -> Actuation {
    let mut actuation = before.clone();
    let before = before.rates;
    let (wheels, settled) = match (target, &controllers.body) {
        (Target::Wheels { rates, held }, _) => {
            let of_wheel = |i: usize| controllers.wheels[i].filter(|_| held[i]);
            (std::array::from_fn(|i| wheel_output(model, of_wheel(i), rates[i], i, &mut actuation)), rates)
        }
        (Target::Twist(twist), None) => {
            let wheels = model.wheels_from_twist(twist);
            (wheels, wheels)
        }
        (Target::Twist(twist), Some(gains)) => {
            (body_output(model, gains, twist, steering, &mut actuation), model.wheels_from_twist(twist))
        }
    };
    let gain = 1.0 - math::exp(-TICK.seconds() / model.wheel_lag);
    let close = 1e-9 * model.max_wheel_rate;
    let is_close = |a: &Wheels, b: &Wheels| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= close);
    // Within a billionth of the range the wheels count as settled: the rates stay constant and no further pieces are
    // opened.
    if is_close(&actuation.rates, &settled) && is_close(&wheels, &settled) {
        actuation.rates = settled;
    } else {
        actuation.rates = std::array::from_fn(|i| before[i] + gain * (wheels[i] - before[i]));
    }
    actuation
}

/// Rate to which the motor of wheel `i` is set, for the commanded rate `set`; integrates the error if the wheel's own
/// controller is active.
fn wheel_output(model: &Model, pid: Option<Pid>, set: f64, i: usize, actuation: &mut Actuation) -> f64 {
    let Some(pid) = pid else {
        if !actuation.memory.is_unwritten() {
            (actuation.memory.sums[i], actuation.memory.last[i]) = (0.0, 0.0);
        }
        return set;
    };
    let limit = model.max_wheel_rate;
    let is = actuation.rates[i];
    let memory = &mut *actuation.memory;
    // Finer than the tolerance for settled wheels, so that the error is 0 once they are settled.
    let error = if (set - is).abs() <= 1e-10 * limit { 0.0 } else { set - is };
    // Without an integral part the sum stays 0; otherwise it would never become constant.
    let sum = if pid.i > 0.0 { memory.sums[i] + error * TICK.seconds() } else { 0.0 };
    let out = pid.p * error + pid.i * sum - pid.d * (is - memory.last[i]) / TICK.seconds();
    // During saturation the sum may only shrink, because a grown sum would cause overshoot later.
    if out.abs() <= limit || error * out <= 0.0 {
        memory.sums[i] = sum;
    }
    memory.last[i] = is;
    out.clamp(-limit, limit)
}

/// Rates to which the PI controllers set the wheels; integrates the errors.
fn body_output(model: &Model, gains: &Gains, set: Twist, steering: f64, actuation: &mut Actuation) -> Wheels {
    let is = model.twist_from_wheels(&actuation.rates, steering);
    // Finer than the tolerance for settled wheels, so that all errors are 0 once they are settled.
    let close = 1e-10 * model.max_wheel_rate * model.wheel_diameter;
    let error = |set: f64, is: f64, close: f64| if (set - is).abs() <= close { 0.0 } else { set - is };
    let (error_v, error_w) =
        (error(set.vx, is.vx, close), error(set.omega, is.omega, close / model.track.min(model.wheelbase)));
    let memory = &mut *actuation.memory;
    let sum_v = memory.sum_v + error_v * TICK.seconds();
    let sum_w = memory.sum_w + error_w * TICK.seconds();
    let out = Twist {
        vx: gains.vv * (error_v + sum_v / gains.tv),
        // Sideways speed has no controller of its own in RoBIOS.
        vy: set.vy,
        omega: gains.vw * (error_w + sum_w / gains.tw),
    };
    let wheels = model.wheels_from_twist(out);
    let excess = model.wheel_excess(&wheels);
    let saturated = excess > 1.0;
    // During saturation a sum may only shrink, because a grown sum would cause overshoot later.
    if !saturated || error_v * out.vx <= 0.0 {
        memory.sum_v = sum_v;
    }
    if !saturated || error_w * out.omega <= 0.0 {
        memory.sum_w = sum_w;
    }
    if saturated { wheels.map(|rate| rate / excess) } else { wheels }
}

#[cfg(test)]
mod tests {
    use super::super::DriveKind;
    use super::*;

    fn model(wheel_lag: f64) -> Model {
        Model {
            kind: DriveKind::Differential,
            wheel_diameter: 0.1,
            max_wheel_rate: 10.0,
            ticks_per_turn: 1000.0,
            track: 0.2,
            wheelbase: 0.2,
            axis_offset: 0.0,
            max_speed: f64::INFINITY,
            max_turn: f64::INFINITY,
            body_radius: 0.15,
            wheel_lag,
            max_steering: 0.0,
            mass: 1.0,
            traction: 0.6,
        }
    }

    fn open(rates: Wheels) -> Target {
        Target::Wheels { rates, held: [false; 4] }
    }

    fn body(gains: &Gains) -> Controllers {
        Controllers { body: Some(*gains), ..Controllers::USUAL.clone() }
    }

    #[test]
    fn a_lag_is_first_order() {
        let model = model(0.1);
        let mut actuation = Actuation::REST;
        for tick in 1..=30 {
            actuation = step(&model, Controllers::USUAL, open([8.0, -4.0, 0.0, 0.0]), 0.0, &actuation);
            let risen = 1.0 - math::exp(-0.1 * f64::from(tick));
            assert!((actuation.rates[0] - 8.0 * risen).abs() < 1e-13, "tick {tick}");
            assert!((actuation.rates[1] + 4.0 * risen).abs() < 1e-13, "tick {tick}");
        }
        for _ in 0..300 {
            actuation = step(&model, Controllers::USUAL, open([8.0, -4.0, 0.0, 0.0]), 0.0, &actuation);
        }
        assert_eq!(actuation.rates, [8.0, -4.0, 0.0, 0.0], "it settles");
    }

    /// Number of ticks until nothing changes any more, and the twist then.
    fn settle(model: &Model, gains: &Gains, set: Twist, mut actuation: Actuation) -> (usize, Twist, Actuation) {
        for tick in 0..100_000 {
            let next = step(model, &body(gains), Target::Twist(set), 0.0, &actuation);
            if next == actuation {
                return (tick, model.twist_from_wheels(&actuation.rates, 0.0), actuation);
            }
            actuation = next;
        }
        panic!("does not settle");
    }

    #[test]
    fn controllers_reach_the_set_speed_without_an_error_that_stays() {
        let model = model(0.1);
        let set = Twist::new(0.2, 0.7);
        let reached = |gains: &Gains| {
            let (ticks, twist, _) = settle(&model, gains, set, Actuation::REST);
            assert!((twist.vx - set.vx).abs() < 1e-12 && (twist.omega - set.omega).abs() < 1e-12, "{twist:?}");
            ticks
        };
        // The parameters of the ROM's demonstration program, the book's parameters, and slow ones.
        let demo = reached(&Gains { vv: 7.0, tv: 0.3, vw: 7.0, tw: 0.1 });
        let slow = reached(&Gains { vv: 0.5, tv: 0.3, vw: 0.5, tw: 0.3 });
        reached(&Gains { vv: 7.0, tv: 0.3, vw: 10.0, tw: 0.1 });
        assert!(demo < slow, "greater gains settle sooner: {demo} and {slow} ticks");
    }

    #[test]
    fn a_saturated_controller_does_not_wind_up() {
        let model = model(0.1);
        let gains = Gains { vv: 2.0, tv: 0.1, vw: 2.0, tw: 0.1 };
        // 1 m/s is twice what the wheels can do.
        let (_, twist, mut actuation) = settle(&model, &gains, Twist::new(1.0, 0.0), Actuation::REST);
        assert!((twist.vx - 0.5).abs() < 1e-6, "at the limit: {twist:?}");
        let mut ticks = 0;
        while model.twist_from_wheels(&actuation.rates, 0.0).vx > 0.11 {
            actuation = step(&model, &body(&gains), Target::Twist(Twist::new(0.1, 0.0)), 0.0, &actuation);
            ticks += 1;
        }
        assert!(ticks < 50, "half a second after the set speed has fallen the robot is slow: {ticks} ticks");
        let (_, twist, _) = settle(&model, &gains, Twist::new(0.1, 0.0), actuation);
        assert!((twist.vx - 0.1).abs() < 1e-12);
    }

    #[test]
    fn without_proportional_action_nothing_moves_and_nothing_breaks() {
        let gains = Gains { vv: 0.0, tv: 1e-300, vw: 1e300, tw: 1e-3 };
        let mut actuation = Actuation::REST;
        for _ in 0..1000 {
            actuation = step(&model(0.05), &body(&gains), Target::Twist(Twist::new(0.1, 0.5)), 0.0, &actuation);
            assert!(actuation.rates.iter().all(|rate| rate.abs() <= 10.0 + 1e-9), "{actuation:?}");
        }
    }
}
