//! Floor friction of a moving object.
//!
//! The friction of a body that slides and turns at the same time lies on the ellipsoid of maximum dissipation (Goyal,
//! Ruina and Papadopoulos 1991; Howe and Cutkosky 1996). Let p, the arm of the friction torque, be the mean distance of
//! the touched floor's points from the centre. The force is then proportional to v / l and the torque to p² w / l,
//! where l² = v² + p² w², v is the speed and w the turning speed.
//!
//! For a disc p is 2/3 of the radius, and p / k = 2 sqrt(2) / 3 with the radius of gyration k. That ratio is used for
//! all shapes, so p² / k² = 8/9. For a square p is then 0.6 % too large, for a long bar 9 %.

use glam::DVec2;

/// Square of the arm of the friction torque divided by the square of the radius of gyration.
pub(super) const ARM: f64 = 8.0 / 9.0;

/// Velocity of the centre of mass, m/s, and turning speed, rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Velocity {
    pub linear: DVec2,
    pub omega: f64,
}

impl Velocity {
    /// Mean sliding speed l of the floor's points, m/s.
    pub fn sliding(&self, gyration_squared: f64) -> f64 {
        (self.linear.length_squared() + ARM * gyration_squared * self.omega * self.omega).sqrt()
    }

    /// Decelerations at this velocity: of the centre, m/s², and of the rotation, rad/s².
    pub fn decelerations(&self, deceleration: f64, gyration_squared: f64) -> (f64, f64) {
        let sliding = self.sliding(gyration_squared);
        if sliding == 0.0 {
            return (0.0, 0.0);
        }
        let ratio = deceleration / sliding;
        (ratio * self.linear.length(), ARM * ratio * self.omega.abs())
    }
}
