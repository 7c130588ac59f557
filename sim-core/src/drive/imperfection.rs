//! Imperfect motion: errors between the wheels and the ground, and between the wheels and odometry.
//!
//! With systematic errors a motion keeps its closed form. Random errors are drawn at each tick of the global 10 ms grid
//! and stay constant until the next tick. They depend only on the index of the tick, not on the times at which the
//! motion is queried.

use std::sync::Arc;

use glam::DVec2;

use super::{
    command::{ActiveCommand, CommandState},
    control::Actuation,
    hull::Hull,
    model::{DriveKind, Model, ModelError, Wheels},
};
use crate::{
    RobotId,
    noise::{self, DriveBound, EventStreams, Purpose, Resolution, Stream, TwistNoise},
    pose::{Pose, Twist},
    time::{TICK, Time},
};

/// Errors of a robot's motion and of its odometry, relative to the motion that its wheels would give without errors. If
/// all values are 0, motion and odometry are perfect.
///
/// Source: Koestler & Bräunl, section 5 (additive Gaussian noise on the v-omega interface); slip, diameters and
/// resolution are our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfection {
    /// Relative error of each wheel's diameter (true diameter divided by the nominal one, minus 1), in the order of the
    /// [`DriveKind`]; above -1, up to 1.
    pub diameters: Wheels,
    /// Slip ratio: the wheel moves over the ground at (1 - slip) times the speed of its rim; -1 to 1.
    pub slip: f64,
    /// Standard deviation of the random part of the slip ratio, drawn for each wheel and tick; the total ratio is
    /// clamped to -1 to 1.
    pub slip_deviation: f64,
    /// Noise of the true motion for a commanded speed and turning speed (`VWSetSpeed`, drives). There is no noise while
    /// the commanded speed and turning speed are 0, or while the program commands the rates of the motors.
    pub command: TwistNoise,
    /// Maximum errors of the targets of drives.
    pub bound: DriveBound,
    /// Noise of the twist that odometry computes from the wheels; no noise while the wheels are at rest.
    pub odometry: TwistNoise,
    /// Resolution of odometry readings.
    pub resolution: Resolution,
}

/// Minimum true diameter of a wheel, as a fraction of the nominal one.
const MIN_DIAMETER: f64 = 0.1;

impl noise::MotionNoise {
    /// The imperfection of the drive of `robot`, a drive of this kind, in a run with `seed`.
    ///
    /// Each wheel's diameter is the nominal one times (1 + e + `diameter_sigma` G), where e is `left` or `right`, and G
    /// is a standard normal number drawn once for each wheel. The result is at least a tenth of the nominal diameter
    /// and at most twice that diameter. An Ackermann drive, with one motor, uses `left`.
    pub fn imperfection(&self, kind: DriveKind, seed: u64, robot: RobotId) -> Imperfection {
        let sides = match kind {
            DriveKind::Differential => [Some(self.left), Some(self.right), None, None],
            DriveKind::Ackermann => [Some(self.left), None, None, None],
            DriveKind::Omni => [self.left, self.right, self.left, self.right].map(Some),
            DriveKind::Legged | DriveKind::Thrusters => [None; 4],
        };
        let mut stream = EventStreams::new(seed, robot, Purpose::DeviceConstant, "").at(0);
        let diameters = sides.map(|side| {
            side.map_or(0.0, |fraction| {
                (fraction + self.diameter_sigma * stream.normal()).clamp(MIN_DIAMETER - 1.0, 1.0)
            })
        });
        Imperfection {
            diameters,
            slip: self.slip,
            slip_deviation: self.slip_sigma,
            command: self.command,
            bound: self.bound,
            odometry: self.odometry,
            resolution: self.resolution,
        }
    }
}

impl Imperfection {
    /// Checks that all numbers are within their ranges.
    ///
    /// # Errors
    /// The first number that is out of range, with the accepted values.
    pub fn check(&self) -> Result<(), ModelError> {
        let check = |field, value: f64, accepted, ok: bool| {
            if ok { Ok(()) } else { Err(ModelError { field, value, accepted }) }
        };
        for value in self.diameters {
            check("wheel diameter error", value, "more than -1, up to 1", value > -1.0 && value <= 1.0)?;
        }
        check("slip", self.slip, "-1 to 1", self.slip.abs() <= 1.0)?;
        let deviations = [
            ("slip deviation", self.slip_deviation),
            ("command noise of the speed", self.command.speed),
            ("command noise of the speed as a share", self.command.speed_share),
            ("command noise of the turning speed", self.command.turn),
            ("command noise of the turning speed as a share", self.command.turn_share),
            ("bound of the distance of a drive", self.bound.length),
            ("bound of the angle of a drive", self.bound.angle),
            ("odometry noise of the speed", self.odometry.speed),
            ("odometry noise of the speed as a share", self.odometry.speed_share),
            ("odometry noise of the turning speed", self.odometry.turn),
            ("odometry noise of the turning speed as a share", self.odometry.turn_share),
            ("odometry resolution of a length", self.resolution.length),
            ("odometry resolution of an angle", self.resolution.angle),
        ];
        for (field, value) in deviations {
            check(field, value, "0 to 1000", (0.0..=1e3).contains(&value))?;
        }
        Ok(())
    }
}

impl TwistNoise {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The noise of `twist`, computed from standard normal numbers.
    fn noise_of(&self, twist: Twist, kind: DriveKind, [ahead, lateral, turn]: [f64; 3]) -> Twist {
        let deviation = |absolute: f64, fraction: f64, value: f64| {
            let part = fraction * value;
            (absolute * absolute + part * part).sqrt()
        };
        Twist {
            vx: deviation(self.speed, self.speed_share, twist.vx) * ahead,
            vy: match kind {
                DriveKind::Omni | DriveKind::Legged => deviation(self.speed, self.speed_share, twist.vy) * lateral,
                DriveKind::Differential | DriveKind::Ackermann | DriveKind::Thrusters => 0.0,
            },
            omega: deviation(self.turn, self.turn_share, twist.omega) * turn,
        }
    }
}

impl Resolution {
    /// `pose`, rounded to the resolution.
    pub(super) fn rounded(&self, pose: Pose) -> Pose {
        let round_to = |value: f64, step: f64| if step > 0.0 { (value / step).round() * step } else { value };
        let heading = pose.heading;
        let remainder = heading.remainder();
        Pose {
            position: DVec2::new(round_to(pose.position.x, self.length), round_to(pose.position.y, self.length)),
            heading: heading.turned(round_to(remainder, self.angle) - remainder),
        }
    }
}

/// Behaviour of a robot that is pushed against a wall.
///
/// Source: docs/motion.md, section Sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactRule {
    /// The body stops, its wheels stall, and the command stays in force.
    #[default]
    Stall,
    /// The body slides if the direction of its push is outside the friction cone; its wheels then slip over the floor.
    Slide {
        /// Coefficient of friction between the body and walls.
        friction: f64,
    },
}

/// Constant properties of one robot's motion: its model, its errors and its behaviour at walls.
#[derive(Clone, Debug)]
pub(super) struct Vehicle {
    pub model: Arc<Model>,
    /// Errors of the motion; `None` for perfect motion.
    pub errors: Option<Arc<MotionErrors>>,
    pub contact: ContactRule,
    /// Hull of a robot in the water.
    pub hull: Option<Hull>,
}

/// An imperfection with its random streams.
#[derive(Clone, Debug)]
pub(super) struct MotionErrors {
    pub imperfection: Imperfection,
    slip: EventStreams,
    command: EventStreams,
    odometry: EventStreams,
    drive: EventStreams,
}

/// Twists of the axle with motion errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DisturbedTwists {
    pub truth: Twist,
    pub odometry: Twist,
    /// True if the twists include random errors, so that they are valid only until the next tick.
    pub are_random: bool,
}

impl Vehicle {
    /// Twists from `start` on at the wheel rates of `actuation`; `nominal` is the twist of error-free wheels at these
    /// rates.
    pub fn disturbed_twists(
        &self,
        start: Time,
        commands: &CommandState,
        actuation: &Actuation,
        nominal: Twist,
    ) -> DisturbedTwists {
        match &self.errors {
            // The errors apply to wheels and legs, not to hulls.
            Some(errors) if actuation.rates != [0.0; 4] && self.hull.is_none() => {
                errors.apply(&self.model, start, commands, actuation, nominal)
            }
            _ => DisturbedTwists { truth: nominal, odometry: nominal, are_random: false },
        }
    }
}

impl MotionErrors {
    /// The errors of `robot` in a run with `seed`; `None` for perfect motion.
    pub fn unless_perfect(imperfection: Imperfection, seed: u64, robot: RobotId) -> Option<Arc<Self>> {
        (imperfection != Imperfection::default()).then(|| Arc::new(Self::new(imperfection, seed, robot)))
    }

    fn new(imperfection: Imperfection, seed: u64, robot: RobotId) -> Self {
        let stream = |purpose, name| EventStreams::new(seed, robot, purpose, name);
        Self {
            imperfection,
            slip: stream(Purpose::Command, "slip"),
            command: stream(Purpose::Command, ""),
            odometry: stream(Purpose::Odometry, ""),
            drive: stream(Purpose::Drive, ""),
        }
    }

    /// `displacement` of a drive that begins at `at`, with the error of its target. The random numbers are indexed by
    /// `at`. An Ackermann drive keeps the commanded curve, which may be the tightest possible; so the angle has the
    /// same relative error as the length.
    pub fn with_target_error(&self, kind: DriveKind, at: Time, displacement: Twist) -> Twist {
        let DriveBound { length, angle } = self.imperfection.bound;
        if length == 0.0 && angle == 0.0 {
            return displacement;
        }
        let mut stream = self.drive.at(EventStreams::index(at, Time(1)));
        // Both errors are always drawn, so that the error of the angle does not depend on the bound of the length.
        let [length_error, angle_error] = [length, angle].map(|bound| bound * (2.0 * stream.unit() - 1.0));
        let (distance, turn) = (displacement.speed(), displacement.omega.abs());
        let scale = if distance > 0.0 { 1.0 + length_error.clamp(-distance, distance) / distance } else { 1.0 };
        let scaled = displacement.scaled(scale);
        if kind == DriveKind::Ackermann {
            return scaled;
        }
        let omega = displacement.omega + if turn > 0.0 { angle_error.clamp(-turn, turn) } else { 0.0 };
        Twist { omega, ..scaled }
    }

    fn apply(
        &self,
        model: &Model,
        start: Time,
        commands: &CommandState,
        actuation: &Actuation,
        nominal: Twist,
    ) -> DisturbedTwists {
        let Imperfection { diameters, slip, slip_deviation, command, odometry, .. } = self.imperfection;
        let tick = EventStreams::index(start, TICK);
        let mut twists = DisturbedTwists { truth: nominal, odometry: nominal, are_random: false };
        let mut slips = [slip; 4];
        // The feet of legs do not slip.
        let can_slip = model.kind != DriveKind::Legged;
        if slip_deviation > 0.0 && can_slip {
            twists.are_random = true;
            slips = normals(self.slip.at(tick)).map(|normal: f64| (slip + slip_deviation * normal).clamp(-1.0, 1.0));
        }
        let factors: Wheels = std::array::from_fn(|i| (1.0 + diameters[i]) * (1.0 - slips[i]));
        if factors != [1.0; 4] && can_slip {
            let rates = std::array::from_fn(|i| actuation.rates[i] * factors[i]);
            twists.truth = model.twist_from_wheels(&rates, commands.steering);
        }
        let is_commanded = match commands.active {
            ActiveCommand::Twist(twist) | ActiveCommand::Drive { rate: twist, .. } => !twist.is_zero(),
            ActiveCommand::Idle | ActiveCommand::Wheels { .. } => false,
        };
        if is_commanded && !command.is_none() {
            twists.are_random = true;
            twists.truth = twists.truth.plus(command.noise_of(nominal, model.kind, normals(self.command.at(tick))));
        }
        if !odometry.is_none() {
            twists.are_random = true;
            twists.odometry = nominal.plus(odometry.noise_of(nominal, model.kind, normals(self.odometry.at(tick))));
        }
        twists
    }
}

/// Standard normal numbers for one tick.
fn normals<const N: usize>(mut stream: Stream) -> [f64; N] {
    std::array::from_fn(|_| stream.normal())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::MotionNoise;

    #[test]
    fn default_noise_gives_no_imperfection() {
        for kind in [DriveKind::Differential, DriveKind::Ackermann, DriveKind::Omni] {
            assert_eq!(MotionNoise::default().imperfection(kind, 7, RobotId(1)), Imperfection::default());
        }
    }

    #[test]
    fn left_and_right_errors_apply_to_the_wheels_of_each_drive() {
        let motion = MotionNoise { left: 0.1, right: -0.2, ..MotionNoise::default() };
        let diameters = |kind| motion.imperfection(kind, 7, RobotId(1)).diameters;
        assert_eq!(diameters(DriveKind::Differential), [0.1, -0.2, 0.0, 0.0]);
        assert_eq!(diameters(DriveKind::Ackermann), [0.1, 0.0, 0.0, 0.0]);
        assert_eq!(diameters(DriveKind::Omni), [0.1, -0.2, 0.1, -0.2]);
    }

    #[test]
    fn diameters_are_drawn_for_each_wheel_and_robot() {
        let motion = MotionNoise { diameter_sigma: 0.01, ..MotionNoise::default() };
        let diameters = |robot| motion.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters;
        assert_eq!(diameters(1), diameters(1));
        let mut errors: Vec<f64> = (1..=2_500).flat_map(diameters).collect();
        let variance = errors.iter().map(|fraction| fraction * fraction).sum::<f64>() / 1e4;
        // The variance of 10,000 draws has a standard deviation of sqrt(2 / 10,000), 1.4 %.
        assert!((variance / 1e-4 - 1.0).abs() < 0.06, "{variance}");
        errors.sort_by(f64::total_cmp);
        errors.dedup();
        assert_eq!(errors.len(), 10_000, "all errors differ");
        let wide = MotionNoise { diameter_sigma: 10.0, ..MotionNoise::default() };
        let range = MIN_DIAMETER - 1.0..=1.0;
        assert!(
            (1..100)
                .flat_map(|robot| wide.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters)
                .all(|fraction| range.contains(&fraction))
        );
    }

    #[test]
    fn extreme_values_of_a_profile_are_accepted() {
        let max = TwistNoise { speed: 100.0, speed_share: 10.0, turn: 873.0, turn_share: 10.0 };
        let motion = MotionNoise {
            left: 1.0,
            right: -0.5,
            diameter_sigma: 0.05,
            slip: -1.0,
            slip_sigma: 1.0,
            command: max,
            bound: DriveBound { length: 1e3, angle: 6.3 },
            odometry: max,
            resolution: Resolution { length: 1e3, angle: 6.3 },
        };
        assert_eq!(motion.imperfection(DriveKind::Omni, 7, RobotId(1)).check(), Ok(()));
    }
}
