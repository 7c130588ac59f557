//! Errors of a robot's motion and odometry.

use super::{Events, Purpose};
use crate::RobotId;
use crate::drive::{DriveKind, Imperfection, Resolution, TwistNoise};

/// How a robot's drive differs from a perfect one: what a noise profile says of it. The default: not at all.
///
/// All but `diameter_sigma` is what [`Imperfection`] has, too, which carries it out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// By what share the wheels on the left (of a car: the driven ones) are larger than their nominal diameter.
    pub left: f64,
    /// The same on the right.
    pub right: f64,
    /// Standard deviation between wheels of that share.
    pub diameter_sigma: f64,
    /// Share of a wheel's way that it slips.
    pub slip: f64,
    /// Standard deviation of that share from tick to tick.
    pub slip_sigma: f64,
    /// Between the commanded and the true twist.
    pub command: TwistNoise,
    /// Between the twist of the wheels and what odometry takes from it.
    pub odometry: TwistNoise,
    /// Steps in which odometry is read.
    pub resolution: Resolution,
}

/// Smallest true diameter of a wheel, as a share of the nominal one.
const SMALLEST: f64 = 0.1;

impl Motion {
    /// The imperfection of the drive of `robot`, of this kind, in a run with `seed`.
    ///
    /// Each wheel's diameter is the nominal one times 1 + `left` or `right` + `diameter_sigma` G, G standard normal and
    /// drawn once for each wheel; at least a tenth of the nominal one, at most twice. The one motor of a car drives what is
    /// on the left.
    pub fn imperfection(&self, kind: DriveKind, seed: u64, robot: RobotId) -> Imperfection {
        let sides = match kind {
            DriveKind::Differential => [Some(self.left), Some(self.right), None, None],
            DriveKind::Ackermann => [Some(self.left), None, None, None],
            DriveKind::Omni => [self.left, self.right, self.left, self.right].map(Some),
            DriveKind::Legged => [None; 4],
        };
        let mut made = Events::new(seed, robot, Purpose::Make, "").at(0);
        let diameters = sides.map(|side| {
            side.map_or(0.0, |share| (share + self.diameter_sigma * made.normal()).clamp(SMALLEST - 1.0, 1.0))
        });
        Imperfection {
            diameters,
            slip: self.slip,
            slip_deviation: self.slip_sigma,
            command: self.command,
            odometry: self.odometry,
            resolution: self.resolution,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_errors_a_drive_is_perfect() {
        for kind in [DriveKind::Differential, DriveKind::Ackermann, DriveKind::Omni] {
            assert_eq!(Motion::default().imperfection(kind, 7, RobotId(1)), Imperfection::default());
        }
    }

    #[test]
    fn sides_are_given_to_the_wheels_of_each_drive() {
        let motion = Motion { left: 0.1, right: -0.2, ..Motion::default() };
        let of = |kind| motion.imperfection(kind, 7, RobotId(1)).diameters;
        assert_eq!(of(DriveKind::Differential), [0.1, -0.2, 0.0, 0.0]);
        assert_eq!(of(DriveKind::Ackermann), [0.1, 0.0, 0.0, 0.0]);
        assert_eq!(of(DriveKind::Omni), [0.1, -0.2, 0.1, -0.2]);
    }

    #[test]
    fn diameters_are_drawn_for_each_wheel_and_robot() {
        let motion = Motion { diameter_sigma: 0.01, ..Motion::default() };
        let of = |robot| motion.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters;
        assert_eq!(of(1), of(1));
        let mut all: Vec<f64> = (1..=2_500).flat_map(of).collect();
        let variance = all.iter().map(|share| share * share).sum::<f64>() / 1e4;
        // The variance of 10,000 draws has a standard deviation of sqrt(2 / 10,000), 1.4 %.
        assert!((variance / 1e-4 - 1.0).abs() < 0.06, "{variance}");
        all.sort_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), 10_000, "no two are alike");
        let far = Motion { diameter_sigma: 10.0, ..Motion::default() };
        let range = SMALLEST - 1.0..=1.0;
        assert!(
            (1..100)
                .flat_map(|robot| far.imperfection(DriveKind::Omni, 7, RobotId(robot)).diameters)
                .all(|share| range.contains(&share))
        );
    }

    #[test]
    fn what_a_profile_may_say_is_accepted() {
        let most = TwistNoise { speed: 100.0, speed_share: 10.0, turn: 873.0, turn_share: 10.0 };
        let motion = Motion {
            left: 1.0,
            right: -0.5,
            diameter_sigma: 0.05,
            slip: -1.0,
            slip_sigma: 1.0,
            command: most,
            odometry: most,
            resolution: Resolution { length: 1e3, angle: 6.3 },
        };
        assert_eq!(motion.imperfection(DriveKind::Omni, 7, RobotId(1)).check(), Ok(()));
    }
}
