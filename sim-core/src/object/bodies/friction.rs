//! Floor friction on a moving object during one step of the rigid bodies.

use glam::DVec2;

use crate::object::floor::{ARM_SQUARED_RATIO, Velocity};

impl Velocity {
    pub const ZERO: Self = Self { linear: DVec2::ZERO, omega: 0.0 };

    /// Velocity after friction that would slow a body without rotation by `speed`, m/s; exactly zero if friction stops
    /// the body.
    pub fn slowed(self, speed: f64, gyration_squared: f64) -> Self {
        let sliding_speed = self.sliding_speed(gyration_squared);
        if sliding_speed <= speed {
            return Self::ZERO;
        }
        let ratio = speed / sliding_speed;
        Self { linear: self.linear * (1.0 - ratio), omega: self.omega * (1.0 - ARM_SQUARED_RATIO * ratio) }
    }
}

/// Splits `loss`, the loss of speed by friction in a step, m/s, into the losses before and after the solver's step, so
/// that the object moves at its mean speed during the solver's step. The distance is then exact for constant
/// deceleration, even if the object comes to rest during the step.
pub(super) fn split(sliding_speed: f64, loss: f64) -> (f64, f64) {
    let before = if sliding_speed >= loss {
        0.5 * loss
    } else {
        sliding_speed - sliding_speed * sliding_speed / (2.0 * loss).max(f64::MIN_POSITIVE)
    };
    (before, loss - before)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn step_distance_matches_constant_deceleration() {
        let (loss, dt) = (0.005, 0.001);
        for speed in [0.1, 0.005, 0.0049, 0.001, 1e-9] {
            let start = Velocity { linear: DVec2::new(0.0, speed), omega: 0.0 };
            let (before, after) = split(start.sliding_speed(1.0), loss);
            let mean = start.slowed(before, 1.0);
            let deceleration = loss / dt;
            let until = (speed / deceleration).min(dt);
            let distance = speed * until - 0.5 * deceleration * until * until;
            assert!((mean.linear.y * dt - distance).abs() < 1e-15, "{speed} m/s");
            let end = mean.slowed(after, 1.0);
            assert!((end.linear.y - (speed - loss).max(0.0)).abs() < 1e-15, "{speed} m/s");
            assert!(speed > loss || end == Velocity::ZERO, "{speed} m/s ends at rest");
        }
        assert_eq!(split(0.0, 0.0), (0.0, 0.0));
    }

    #[test]
    fn friction_never_increases_or_reverses_the_velocity() {
        let mut velocity = Velocity { linear: DVec2::new(0.02, 0.01), omega: -3.0 };
        let gyration_squared = 0.01;
        while velocity != Velocity::ZERO {
            let next = velocity.slowed(0.001, gyration_squared);
            assert!(next.linear.length() <= velocity.linear.length() && next.omega.abs() < velocity.omega.abs());
            assert!(next.omega <= 0.0, "the turn is not reversed");
            velocity = next;
        }
    }
}
