//! Floor friction on a moving object during one step of the rigid bodies.

use glam::DVec2;

use crate::object::floor::{ARM, Velocity};

impl Velocity {
    pub const ZERO: Self = Self { linear: DVec2::ZERO, omega: 0.0 };

    /// Velocity after friction that would slow a sliding body without rotation by `speed`, m/s; exactly zero if
    /// friction stops the body.
    pub fn slowed(self, speed: f64, gyration_squared: f64) -> Self {
        let sliding = self.sliding(gyration_squared);
        if sliding <= speed {
            return Self::ZERO;
        }
        let ratio = speed / sliding;
        Self { linear: self.linear * (1.0 - ratio), omega: self.omega * (1.0 - ARM * ratio) }
    }
}

/// Splits `whole`, the loss of speed by friction in a step, m/s, into parts before and after the step, so that the
/// object moves at its mean speed during the step. The distance is then exact for constant deceleration, even if the
/// object comes to rest within the step.
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
            let distance = speed * until - 0.5 * deceleration * until * until;
            assert!((mean.linear.y * dt - distance).abs() < 1e-15, "{speed} m/s");
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
