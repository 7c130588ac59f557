//! Wheel lag, and the controllers that drive the wheels: two PI controllers for speed and turning speed, or one PID
//! controller per wheel.

use super::{
    hull::HullState,
    model::{Model, Wheels},
    rare::{ConstDefault, Rare},
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
    /// Returns true for factors from 0 to 10^12 and times from 10^-12 to 10^12 s; with other values the output could be
    /// infinite or NaN.
    pub fn is_valid(&self) -> bool {
        let factor = |v: f64| (0.0..=1e12).contains(&v);
        let time = |t: f64| (1e-12..=1e12).contains(&t);
        factor(self.vv) && factor(self.vw) && time(self.tv) && time(self.tw)
    }
}

/// Parameters of a wheel's PID controller: output = p e + i integral of e + d de/dt, with the error e of the wheel's
/// rate. The output is the rate to which the motor is set.
///
/// The derivative part uses only the measured rate of the wheel, so that a new command causes no jump. If i = 0, an
/// error remains: the wheel reaches p / (1 + p) of the commanded rate. Source: `MOTORPID` of RoBIOS-7; form and units
/// are our choice.
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

impl ConstDefault for Controllers {
    const DEFAULT: &'static Self = &Self { body: None, wheels: [None; 4] };
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
    pub const REST: Self = Self { rates: [0.0; 4], memory: Rare::DEFAULT };
}

/// State of controllers and hull.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Memory {
    /// Integral of the error of the speed, m.
    pub sum_v: f64,
    /// Integral of the error of the turning speed, rad.
    pub sum_w: f64,
    /// For each wheel whose PID controller is active, the integral of the error of its rate, rad.
    pub sums: Wheels,
    /// For each wheel whose PID controller is active, its rate one tick before, rad/s.
    pub previous_rates: Wheels,
    /// State of a hull in the water. The hull's mean velocity over the last tick is in [`Actuation::rates`].
    pub hull: HullState,
}

impl ConstDefault for Memory {
    const DEFAULT: &'static Self = &Self {
        sum_v: 0.0,
        sum_w: 0.0,
        sums: [0.0; 4],
        previous_rates: [0.0; 4],
        hull: HullState { velocity: [0.0; 4], height: 0.0 },
    };
}

/// Set points of the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// Rates of the motors, rad/s. A wheel that `regulated` marks is regulated by its PID controller if that runs; the
    /// other wheels are open loop.
    Wheels { rates: Wheels, regulated: [bool; 4] },
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

/// Computes one tick of controllers and wheel lag: the state with the wheel rates until the next tick.
///
/// Outputs are limited to the maximum rate of the wheels: the output of a wheel's controller is clamped, and those of
/// the PI controllers are scaled down together. Integrals do not grow while the output is saturated (anti-windup).
pub(super) fn step(
    model: &Model,
    controllers: &Controllers,
    target: Target,
    steering: f64,
    before: &Actuation,
) -> Actuation {
    let mut actuation = before.clone();
    let rates_before = before.rates;
    let (motor_rates, set_rates) = match (target, &controllers.body) {
        (Target::Wheels { rates, regulated }, _) => {
            let pid = |i: usize| controllers.wheels[i].filter(|_| regulated[i]);
            (std::array::from_fn(|i| wheel_output(model, pid(i), rates[i], i, &mut actuation)), rates)
        }
        (Target::Twist(twist), None) => {
            let wheels = model.wheels_from_twist(twist);
            (wheels, wheels)
        }
        (Target::Twist(twist), Some(gains)) => {
            (body_output(model, gains, twist, steering, &mut actuation), model.wheels_from_twist(twist))
        }
    };
    let step_fraction = 1.0 - math::exp(-TICK.seconds() / model.wheel_lag);
    let close = 1e-9 * model.max_wheel_rate;
    let is_close = |a: &Wheels, b: &Wheels| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= close);
    // Within a billionth of the maximum rate the wheels are regarded as settled: the rates become constant, so no
    // further pieces of motion are needed.
    if is_close(&actuation.rates, &set_rates) && is_close(&motor_rates, &set_rates) {
        actuation.rates = set_rates;
    } else {
        actuation.rates = std::array::from_fn(|i| rates_before[i] + step_fraction * (motor_rates[i] - rates_before[i]));
    }
    actuation
}

/// Rate to which the motor of wheel `i` is set, for the commanded rate `set_point`. Integrates the error if the wheel's
/// PID controller is active.
fn wheel_output(model: &Model, pid: Option<Pid>, set_point: f64, i: usize, actuation: &mut Actuation) -> f64 {
    let Some(pid) = pid else {
        if !actuation.memory.is_unwritten() {
            (actuation.memory.sums[i], actuation.memory.previous_rates[i]) = (0.0, 0.0);
        }
        return set_point;
    };
    let limit = model.max_wheel_rate;
    let rate = actuation.rates[i];
    let memory = &mut *actuation.memory;
    // This tolerance is finer than that of settled wheels, so that the error of a settled wheel is 0.
    let error = if (set_point - rate).abs() <= 1e-10 * limit { 0.0 } else { set_point - rate };
    // Without an integral part the sum stays 0. Otherwise the sum, and so the state, would never become constant.
    let sum = if pid.i > 0.0 { memory.sums[i] + error * TICK.seconds() } else { 0.0 };
    let output = pid.p * error + pid.i * sum - pid.d * (rate - memory.previous_rates[i]) / TICK.seconds();
    // While the output is saturated, the sum may only shrink: a larger sum would cause overshoot later.
    if output.abs() <= limit || error * output <= 0.0 {
        memory.sums[i] = sum;
    }
    memory.previous_rates[i] = rate;
    output.clamp(-limit, limit)
}

/// Rates to which the PI controllers set the wheels; integrates the errors.
fn body_output(model: &Model, gains: &Gains, set_point: Twist, steering: f64, actuation: &mut Actuation) -> Wheels {
    let actual = model.twist_from_wheels(&actuation.rates, steering);
    // This tolerance is finer than that of settled wheels, so that all errors of settled wheels are 0.
    let close = 1e-10 * model.max_wheel_rate * model.wheel_diameter;
    let error = |set: f64, actual: f64, close: f64| if (set - actual).abs() <= close { 0.0 } else { set - actual };
    let (error_v, error_w) = (
        error(set_point.vx, actual.vx, close),
        error(set_point.omega, actual.omega, close / model.track.min(model.wheelbase)),
    );
    let memory = &mut *actuation.memory;
    let sum_v = memory.sum_v + error_v * TICK.seconds();
    let sum_w = memory.sum_w + error_w * TICK.seconds();
    let output = Twist {
        vx: gains.vv * (error_v + sum_v / gains.tv),
        // RoBIOS has no controller for the sideways speed.
        vy: set_point.vy,
        omega: gains.vw * (error_w + sum_w / gains.tw),
    };
    let wheels = model.wheels_from_twist(output);
    let excess = model.wheel_excess(&wheels);
    let is_saturated = excess > 1.0;
    // While the output is saturated, a sum may only shrink: a larger sum would cause overshoot later.
    if !is_saturated || error_v * output.vx <= 0.0 {
        memory.sum_v = sum_v;
    }
    if !is_saturated || error_w * output.omega <= 0.0 {
        memory.sum_w = sum_w;
    }
    if is_saturated { wheels.map(|rate| rate / excess) } else { wheels }
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

    fn open_loop(rates: Wheels) -> Target {
        Target::Wheels { rates, regulated: [false; 4] }
    }

    fn body(gains: &Gains) -> Controllers {
        Controllers { body: Some(*gains), ..Controllers::DEFAULT.clone() }
    }

    #[test]
    fn wheel_lag_is_first_order() {
        let model = model(0.1);
        let mut actuation = Actuation::REST;
        for tick in 1..=30 {
            actuation = step(&model, Controllers::DEFAULT, open_loop([8.0, -4.0, 0.0, 0.0]), 0.0, &actuation);
            let step_response = 1.0 - math::exp(-0.1 * f64::from(tick));
            assert!((actuation.rates[0] - 8.0 * step_response).abs() < 1e-13, "tick {tick}");
            assert!((actuation.rates[1] + 4.0 * step_response).abs() < 1e-13, "tick {tick}");
        }
        for _ in 0..300 {
            actuation = step(&model, Controllers::DEFAULT, open_loop([8.0, -4.0, 0.0, 0.0]), 0.0, &actuation);
        }
        assert_eq!(actuation.rates, [8.0, -4.0, 0.0, 0.0], "the rates settle");
    }

    /// Number of ticks until the state no longer changes, with the final twist and state.
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
    fn controllers_reach_the_set_speed_without_steady_state_error() {
        let model = model(0.1);
        let set = Twist::new(0.2, 0.7);
        let reached = |gains: &Gains| {
            let (ticks, twist, _) = settle(&model, gains, set, Actuation::REST);
            assert!((twist.vx - set.vx).abs() < 1e-12 && (twist.omega - set.omega).abs() < 1e-12, "{twist:?}");
            ticks
        };
        // The parameters of the demonstration program in the RoBIOS ROM, slow ones, and those of the RoBIOS book.
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
    fn extreme_gains_keep_the_rates_within_limits() {
        let gains = Gains { vv: 0.0, tv: 1e-300, vw: 1e300, tw: 1e-3 };
        let mut actuation = Actuation::REST;
        for _ in 0..1000 {
            actuation = step(&model(0.05), &body(&gains), Target::Twist(Twist::new(0.1, 0.5)), 0.0, &actuation);
            assert!(actuation.rates.iter().all(|rate| rate.abs() <= 10.0 + 1e-9), "{actuation:?}");
        }
    }
}
