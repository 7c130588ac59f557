//! What the floor takes from a moving object in one step.
//!
//! Friction under a body that slides and turns at once lies on the ellipsoid of greatest dissipation (Goyal, Ruina and
//! Papadopoulos 1991; Howe and Cutkosky 1996): with the arm p of the friction torque, mean distance of the floor's points
//! from the centre, the force goes as v / l and the torque as p² w / l, where l² = v² + p² w². For a disc p is 2/3 of its
//! radius, which is 2 sqrt(2) / 3 of its radius of gyration k; that share is taken for all shapes (for a square it is 0.6 %
//! too much, for a long bar 9 %): then p² / k² = 8/9.

use glam::DVec2;

/// Square of the arm of the friction torque over the square of the radius of gyration.
const ARM: f64 = 8.0 / 9.0;

/// Velocity of the centre of mass, m/s, and turning speed, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Velocity {
    pub linear: DVec2,
    pub omega: f64,
}

impl Velocity {
    pub const ZERO: Self = Self { linear: DVec2::ZERO, omega: 0.0 };

    /// Mean sliding speed l of the floor's points, m/s.
    pub fn sliding(&self, gyration_squared: f64) -> f64 {
        (self.linear.length_squared() + ARM * gyration_squared * self.omega * self.omega).sqrt()
    }

    /// What is left when friction takes `speed`, m/s, from a body that slides without turning; exactly nothing in the end.
    pub fn slowed(self, speed: f64, gyration_squared: f64) -> Self {
        let sliding = self.sliding(gyration_squared);
        if sliding <= speed {
            return Self::ZERO;
        }
        let share = speed / sliding;
        Self { linear: self.linear * (1.0 - share), omega: self.omega * (1.0 - ARM * share) }
    }

    /// Decelerations at this velocity: of the centre, m/s², and of the turn, rad/s².
    pub fn decelerations(&self, deceleration: f64, gyration_squared: f64) -> (f64, f64) {
        let sliding = self.sliding(gyration_squared);
        if sliding == 0.0 {
            return (0.0, 0.0);
        }
        let share = deceleration / sliding;
        (share * self.linear.length(), ARM * share * self.omega.abs())
    }
}

/// What friction takes before a step so that it is gone through at its mean speed, and what after it, m/s: together
/// `whole`, the most that it takes in a step. So constant deceleration is exact, and so is its end within a step.
pub(super) fn split(sliding: f64, whole: f64) -> (f64, f64) {
    let before =
        if sliding >= whole { 0.5 * whole } else { sliding - sliding * sliding / (2.0 * whole).max(f64::MIN_POSITIVE) };
    (before, whole - before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_covers_what_constant_deceleration_covers() {
        let (whole, dt) = (0.005, 0.001);
        for speed in [0.1, 0.005, 0.0049, 0.001, 1e-9] {
            let start = Velocity { linear: DVec2::new(0.0, speed), omega: 0.0 };
            let (before, after) = split(start.sliding(1.0), whole);
            let mean = start.slowed(before, 1.0);
            let deceleration = whole / dt;
            let until = (speed / deceleration).min(dt);
            let covered = speed * until - 0.5 * deceleration * until * until;
            assert!((mean.linear.y * dt - covered).abs() < 1e-15, "{speed} m/s");
            let end = mean.slowed(after, 1.0);
            assert!((end.linear.y - (speed - whole).max(0.0)).abs() < 1e-15, "{speed} m/s");
            assert!(speed > whole || end == Velocity::ZERO, "{speed} m/s ends at rest");
        }
        assert_eq!(split(0.0, 0.0), (0.0, 0.0));
    }

    #[test]
    fn friction_only_takes() {
        let mut velocity = Velocity { linear: DVec2::new(0.02, 0.01), omega: -3.0 };
        let gyration_squared = 0.01;
        while velocity != Velocity::ZERO {
            let next = velocity.slowed(0.001, gyration_squared);
            assert!(next.linear.length() <= velocity.linear.length() && next.omega.abs() < velocity.omega.abs());
            assert!(next.omega <= 0.0, "it does not turn back");
            velocity = next;
        }
    }
}
