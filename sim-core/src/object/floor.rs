//! Floor friction of a moving object.
//!
//! The friction of a body that slides and turns at the same time is approximated by an ellipsoidal limit surface with
//! maximum dissipation (Goyal, Ruina and Papadopoulos 1991; Howe and Cutkosky 1996). Let p be the arm of the friction
//! torque: the mean distance of the contact area's points from its centre. Then the force is proportional to v / l and
//! the torque to p² w / l, with the speed v, the turning speed w and l² = v² + p² w².
//!
//! For a disc p is 2/3 of the radius, and p / k = 2 sqrt(2) / 3 with the radius of gyration k. This ratio is used for
//! all shapes, so p² / k² = 8/9. The resulting p is 0.6 % too large for a square, and 9 % too large for a long bar.

use glam::DVec2;

/// Square of the arm of the friction torque, divided by the square of the radius of gyration.
pub(super) const ARM_SQUARED_RATIO: f64 = 8.0 / 9.0;

/// Velocity of the centre of mass, m/s, and turning speed, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Velocity {
    pub linear: DVec2,
    pub omega: f64,
}

impl Velocity {
    /// Effective sliding speed l of the contact area, m/s.
    pub fn sliding_speed(&self, gyration_squared: f64) -> f64 {
        (self.linear.length_squared() + ARM_SQUARED_RATIO * gyration_squared * self.omega * self.omega).sqrt()
    }

    /// Decelerations of the centre, m/s², and of the rotation, rad/s², at this velocity; `deceleration` is the
    /// deceleration of a body that does not rotate, m/s².
    pub fn decelerations(&self, deceleration: f64, gyration_squared: f64) -> (f64, f64) {
        let sliding_speed = self.sliding_speed(gyration_squared);
        if sliding_speed == 0.0 {
            return (0.0, 0.0);
        }
        let ratio = deceleration / sliding_speed;
        (ratio * self.linear.length(), ARM_SQUARED_RATIO * ratio * self.omega.abs())
    }
}
