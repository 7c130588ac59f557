//! Imperfect motion: errors between the wheels and the ground, and between the wheels and odometry.
//!
//! Systematic errors keep the closed form of a motion. Random errors are drawn at each tick of the global 10 ms grid
//! and hold until the next tick. They depend only on the index of the tick, not on the times at which the motion is
//! queried.

use std::sync::Arc;

use glam::DVec2;

use super::{
    command::{Orders, Pending},
    control::Actuation,
    hull::Hull,
    model::{DriveKind, Model, ModelError, Wheels},
};
use crate::{
    RobotId,
    noise::{self, DriveBound, Events, Purpose, Resolution, Stream, TwistNoise},
    pose::{Pose, Twist},
    time::{TICK, Time},
};

/// Differences between a robot's motion and the motion of its wheels, and between its odometry and its wheels. If all
/// values are 0, motion and odometry are perfect.
///
/// Source: Koestler & Bräunl, section 5 (additive Gaussian noise on the v-omega interface); slip, diameters and
/// resolution are our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfection {
    /// Relative excess of each wheel's true diameter over the nominal one, in the order of the [`DriveKind`]; above -1,
    /// up to 1.
    pub diameters: Wheels,
    /// Slip ratio: the wheel moves over the ground at 1 - slip times the speed of its rim; -1 to 1.
    pub slip: f64,
    /// Standard deviation of the slip ratio, drawn for each wheel and tick; the sum is clamped to -1 to 1.
    pub slip_deviation: f64,
    /// Noise between wheels and ground on a commanded speed and turning speed (`VWSetSpeed`, drives). No noise while
    /// the robot is commanded to be at rest, or while its motors are commanded one by one.
    pub command: TwistNoise,
    /// Maximum errors of the targets of drives.
    pub bound: DriveBound,
    /// Noise on the twist that odometry computes from the wheels; no noise while the wheels are at rest.
    pub odometry: TwistNoise,
    /// Resolution of odometry readings.
    pub resolution: Resolution,
}

/// Smallest true diameter of a wheel, as a fraction of the nominal one.
const MIN_DIAMETER: f64 = 0.1;

impl noise::MotionNoise {
    /// The imperfection of the drive of `robot`, of this kind, in a run with `seed`.
    ///
    /// Each wheel's diameter is the nominal one times 1 + `left` or `right` + `diameter_sigma` G, where G is standard
    /// normal and drawn once for each wheel; at least a tenth of the nominal diameter, at most twice. The only motor of
    /// a car uses `left`.
    pub fn imperfection(&self, kind: DriveKind, seed: u64, robot: RobotId) -> Imperfection {
        let sides = match kind {
            DriveKind::Differential => [Some(self.left), Some(self.right), None, None],
            DriveKind::Ackermann => [Some(self.left), None, None, None],
            DriveKind::Omni => [self.left, self.right, self.left, self.right].map(Some),
            DriveKind::Legged | DriveKind::Thrusters => [None; 4],
        };
        let mut stream = Events::new(seed, robot, Purpose::Make, "").at(0);
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

    /// The noise on `twist`, computed from standard normal numbers.
    fn noise_on(&self, twist: Twist, kind: DriveKind, [ahead, lateral, turn]: [f64; 3]) -> Twist {
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
    /// `pose` rounded to the resolution.
    pub(super) fn read(&self, pose: Pose) -> Pose {
        let nearest = |value: f64, step: f64| if step > 0.0 { (value / step).round() * step } else { value };
        let heading = pose.heading;
        let remainder = heading.remainder();
        Pose {
            position: DVec2::new(nearest(pose.position.x, self.length), nearest(pose.position.y, self.length)),
            heading: heading.turned(nearest(remainder, self.angle) - remainder),
        }
    }
}

/// Behaviour of a robot that is pushed against a wall.
///
/// Source: design, section 4; docs/motion.md, section Sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactRule {
    /// The body rests, its wheels stall, and the command stays in force.
    #[default]
    Stall,
    /// The body slides if the push is outside the friction cone, while its wheels slip over the floor.
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
    slip: Events,
    command: Events,
    odometry: Events,
    drive: Events,
}

/// Twists of the axle that result from wheels with errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ErringTwists {
    pub truth: Twist,
    pub odometry: Twist,
    /// True if random errors contribute, so that the twists hold only until the next tick.
    pub is_drawn: bool,
}

impl Vehicle {
    /// Twists that result from wheels with the rates `during`, from `start` on; `nominal` is the twist of error-free
    /// wheels at these rates.
    pub fn erring_twists(&self, start: Time, orders: &Orders, during: &Actuation, nominal: Twist) -> ErringTwists {
        match &self.errors {
            // These errors apply to wheels and legs only.
            Some(errors) if during.rates != [0.0; 4] && self.hull.is_none() => {
                errors.apply(&self.model, start, orders, during, nominal)
            }
            _ => ErringTwists { truth: nominal, odometry: nominal, is_drawn: false },
        }
    }
}

impl MotionErrors {
    /// The errors of `robot` in a run with `seed`; `None` for perfect motion.
    pub fn unless_perfect(imperfection: Imperfection, seed: u64, robot: RobotId) -> Option<Arc<Self>> {
        (imperfection != Imperfection::default()).then(|| Arc::new(Self::new(imperfection, seed, robot)))
    }

    fn new(imperfection: Imperfection, seed: u64, robot: RobotId) -> Self {
        let events = |purpose, name| Events::new(seed, robot, purpose, name);
        Self {
            imperfection,
            slip: events(Purpose::Command, "slip"),
            command: events(Purpose::Command, ""),
            odometry: events(Purpose::Odometry, ""),
            drive: events(Purpose::Drive, ""),
        }
    }

    /// `displacement` of a drive that begins at `at`, with the error of its target. The event is the instant. A car keeps the commanded
    /// curve, which may be its tightest: the angle has the same relative error as the length.
    pub fn missed(&self, kind: DriveKind, at: Time, displacement: Twist) -> Twist {
        let DriveBound { length, angle } = self.imperfection.bound;
        if length == 0.0 && angle == 0.0 {
            return displacement;
        }
        let mut stream = self.drive.at(Events::index(at, Time(1)));
        // Both are always drawn, so that the error of the angle does not depend on the error of the length.
        let [along, around] = [length, angle].map(|bound| bound * (2.0 * stream.unit() - 1.0));
        let (distance, turn) = (displacement.speed(), displacement.omega.abs());
        let scale = if distance > 0.0 { 1.0 + along.clamp(-distance, distance) / distance } else { 1.0 };
        let missed = displacement.scaled(scale);
        if kind == DriveKind::Ackermann {
            return missed;
        }
        let omega = displacement.omega + if turn > 0.0 { around.clamp(-turn, turn) } else { 0.0 };
        Twist { omega, ..missed }
    }

    fn apply(&self, model: &Model, start: Time, orders: &Orders, during: &Actuation, nominal: Twist) -> ErringTwists {
        let Imperfection { diameters, slip, slip_deviation, command, odometry, .. } = self.imperfection;
        let tick = Events::index(start, TICK);
        let mut erring = ErringTwists { truth: nominal, odometry: nominal, is_drawn: false };
        let mut slips = [slip; 4];
        // Standing feet do not slip.
        let slips_at_all = model.kind != DriveKind::Legged;
        if slip_deviation > 0.0 && slips_at_all {
            erring.is_drawn = true;
            slips = normals(self.slip.at(tick)).map(|normal: f64| (slip + slip_deviation * normal).clamp(-1.0, 1.0));
        }
        let factors: Wheels = std::array::from_fn(|i| (1.0 + diameters[i]) * (1.0 - slips[i]));
        if factors != [1.0; 4] && slips_at_all {
            let rates = std::array::from_fn(|i| during.rates[i] * factors[i]);
            erring.truth = model.twist_from_wheels(&rates, orders.steering);
        }
        let is_commanded = match orders.pending {
            Pending::Twist(twist) | Pending::Drive { rate: twist, .. } => !twist.is_zero(),
            Pending::Idle | Pending::Wheels { .. } => false,
        };
        if is_commanded && !command.is_none() {
            erring.is_drawn = true;
            erring.truth = erring.truth.plus(command.noise_on(nominal, model.kind, normals(self.command.at(tick))));
        }
        if !odometry.is_none() {
            erring.is_drawn = true;
            erring.odometry = nominal.plus(odometry.noise_on(nominal, model.kind, normals(self.odometry.at(tick))));
        }
        erring
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
    fn without_errors_a_drive_is_perfect() {
        for kind in [DriveKind::Differential, DriveKind::Ackermann, DriveKind::Omni] {
            assert_eq!(MotionNoise::default().imperfection(kind, 7, RobotId(1)), Imperfection::default());
        }
    }

    #[test]
    fn sides_are_given_to_the_wheels_of_each_drive() {
        let motion = MotionNoise { left: 0.1, right: -0.2, ..MotionNoise::default() };
        let of = |kind| motion.imperfection(kind, 7, RobotId(1)).diameters;
        assert_eq!(of(DriveKind::Differential), [0.1, -0.2, 0.0, 0.0]);
        assert_eq!(of(DriveKind::Ackermann), [0.1, 0.0, 0.0, 0.0]);
        assert_eq!(of(DriveKind::Omni), [0.1, -0.2, 0.1, -0.2]);
    }

    #[test]
    fn diameters_are_drawn_for_each_wheel_and_robot() {
        let motion = MotionNoise { diameter_sigma: 0.01, ..MotionNoise::default() };
        let of = |robot| motion.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters;
        assert_eq!(of(1), of(1));
        let mut all: Vec<f64> = (1..=2_500).flat_map(of).collect();
        let variance = all.iter().map(|fraction| fraction * fraction).sum::<f64>() / 1e4;
        // The variance of 10,000 draws has a standard deviation of sqrt(2 / 10,000), 1.4 %.
        assert!((variance / 1e-4 - 1.0).abs() < 0.06, "{variance}");
        all.sort_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), 10_000, "no two are alike");
        let far = MotionNoise { diameter_sigma: 10.0, ..MotionNoise::default() };
        let range = MIN_DIAMETER - 1.0..=1.0;
        assert!(
            (1..100)
                .flat_map(|robot| far.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters)
                .all(|fraction| range.contains(&fraction))
        );
    }

    #[test]
    fn what_a_profile_may_say_is_accepted() {
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
