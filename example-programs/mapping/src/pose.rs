//! Points and poses in the plane.

use std::f64::consts::{PI, TAU};

use crate::math;

/// A point of the plane, in metres.
pub type Point = nalgebra::Point2<f64>;

/// A displacement or direction in the plane, in metres.
pub type Vector = nalgebra::Vector2<f64>;

/// Pose of a frame in its parent frame: its origin, and its rotation, counter-clockwise.
///
/// Heading 0 points along the parent's x axis. The x axis of a robot's frame points forward, its y axis to the left.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pose {
    /// The frame's origin, in the parent.
    pub position: Point,
    /// The angle of the frame's x axis, in radians.
    pub heading: f64,
}

impl Pose {
    /// The pose at (x, y), in metres, turned by `heading`, in radians.
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Point::new(x, y), heading }
    }

    /// Transforms a point from this frame to its parent.
    pub fn outward(&self, point: Point) -> Point {
        self.position + rotated(point.coords, self.heading)
    }

    /// Transforms a point from the parent to this frame.
    pub fn inward(&self, point: Point) -> Point {
        Point::from(rotated(point - self.position, -self.heading))
    }

    /// Composition: the pose `other` of this frame, expressed in the parent frame.
    pub fn then(&self, other: &Self) -> Self {
        Self { position: self.outward(other.position), heading: wrapped(self.heading + other.heading) }
    }
}

/// The unit vector at `angle` radians from the x axis.
pub fn direction(angle: f64) -> Vector {
    let (sin, cos) = math::sin_cos(angle);
    Vector::new(cos, sin)
}

/// `vector`, turned counter-clockwise by `angle` radians.
pub fn rotated(vector: Vector, angle: f64) -> Vector {
    let (sin, cos) = math::sin_cos(angle);
    Vector::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

/// The angle wrapped to [-pi, pi), in radians.
pub fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn frame_turned_left_points_along_y() {
        let pose = Pose::new(1.0, 2.0, FRAC_PI_2);
        let ahead = pose.outward(Point::new(3.0, 0.0));
        assert!((ahead - Point::new(1.0, 5.0)).norm() < 1e-15);
        assert!((pose.inward(ahead) - Point::new(3.0, 0.0)).norm() < 1e-15);
        let twice = pose.then(&pose);
        assert!((twice.position - Point::new(-1.0, 3.0)).norm() < 1e-15);
        assert!((twice.heading.abs() - PI).abs() < 1e-15);
    }

    #[test]
    fn angles_are_wrapped_to_plus_minus_pi() {
        for (angle, expected) in [(0.0, 0.0), (3.5 * PI, -0.5 * PI), (-2.25 * PI, -0.25 * PI), (PI, -PI)] {
            assert!((wrapped(angle) - expected).abs() < 1e-12, "{angle}");
        }
    }
}
