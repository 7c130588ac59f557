use crate::{drive::Impact, pose::Heading};

/// A switch along an arc of the body's rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bumper {
    /// Middle of the arc, rad counter-clockwise from ahead, seen from the robot's centre.
    pub bearing: f64,
    /// Angle from the middle to either end, rad; pi or more covers the whole rim.
    pub half_angle: f64,
}

impl Bumper {
    /// Returns true if a contact at `bearing` (rad, robot frame) presses the bumper, ends included.
    pub fn covers(&self, bearing: f64) -> bool {
        let angle = Heading::new(bearing - self.bearing).remainder().abs();
        // The tolerance of 10^-12 rad covers the rounding of a contact exactly at an end.
        angle <= self.half_angle + 1e-12
    }

    /// Returns true if this impact presses the bumper.
    pub fn is_pressed_by(&self, impact: &Impact) -> bool {
        self.covers(impact.bearing)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn bearings_wrap_at_pi() {
        let back = Bumper { bearing: PI, half_angle: 0.5 };
        assert!(back.covers(PI) && back.covers(-PI) && back.covers(-PI + 0.49) && back.covers(PI - 0.5));
        assert!(!back.covers(-PI + 0.51) && !back.covers(0.0));
        let ring = Bumper { bearing: 0.0, half_angle: PI };
        assert!([-3.1, 0.0, 3.1].iter().all(|&bearing| ring.covers(bearing)));
    }
}
