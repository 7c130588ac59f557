//! Poses and twists in the plane, with the closed form of motion at constant twist; three-dimensional poses of sensors
//! and links.
//!
//! The world frame has x to the right, y up and angles counter-clockwise from x; a robot's frame has x forward and y
//! left. In three dimensions, z points up in both frames.

mod link;

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec2, DVec3};

use crate::math;
pub use link::{Link, link_pose};

/// A direction in the plane as a number of whole turns and a remainder, so that the remainder keeps full precision
/// after many turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Heading {
    turns: i64,
    remainder: f64,
}

impl Heading {
    /// The heading of `radians`, split into whole turns and a remainder; 0 for a value that is not finite.
    pub fn new(radians: f64) -> Self {
        Self::default().turned(radians)
    }

    /// Angle without the whole turns, rad, in [-pi, pi).
    pub fn remainder(self) -> f64 {
        self.remainder
    }

    /// Number of whole turns, counter-clockwise.
    pub fn turns(self) -> i64 {
        self.turns
    }

    /// The total angle in radians, rounded to one `f64`.
    pub fn radians(self) -> f64 {
        self.turns as f64 * TAU + self.remainder
    }

    /// This heading turned by `radians` (counter-clockwise positive); unchanged by a value that is not finite.
    pub fn turned(self, radians: f64) -> Self {
        if !radians.is_finite() {
            return self;
        }
        let whole_turns = (radians / TAU).round();
        let mut heading = Self {
            turns: self.turns.saturating_add(whole_turns as i64),
            remainder: self.remainder + (radians - whole_turns * TAU),
        };
        if heading.remainder >= PI {
            heading.remainder -= TAU;
            heading.turns = heading.turns.saturating_add(1);
        }
        if heading.remainder < -PI {
            heading.remainder += TAU;
            heading.turns = heading.turns.saturating_sub(1);
        }
        // Adding a whole turn may have rounded the remainder up to pi, which is not in the interval.
        if heading.remainder >= PI {
            heading.remainder = -PI;
            heading.turns = heading.turns.saturating_add(1);
        }
        heading
    }

    /// Unit vector of the heading.
    pub fn direction(self) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.remainder);
        DVec2::new(cos, sin)
    }
}

/// Position in metres and heading of one frame in another. A pose named `world_from_robot` transforms coordinates in
/// the robot's frame into coordinates in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Pose {
    /// Origin of the inner frame in the outer frame, in metres.
    pub position: DVec2,
    /// Direction of the inner frame's x axis in the outer frame.
    pub heading: Heading,
}

impl Pose {
    /// The pose at (`x`, `y`) metres, turned by `phi` radians.
    pub fn new(x: f64, y: f64, phi: f64) -> Self {
        Self { position: DVec2::new(x, y), heading: Heading::new(phi) }
    }

    /// Coordinates in the outer frame of `point`, given in the inner frame.
    pub fn transform_point(&self, point: DVec2) -> DVec2 {
        self.position + self.heading.direction().rotate(point)
    }

    /// Components in the outer frame of `vector`, given in the inner frame; the vector is rotated, not translated.
    pub fn transform_vector(&self, vector: DVec2) -> DVec2 {
        self.heading.direction().rotate(vector)
    }

    /// Coordinates in the inner frame of `point`, given in the outer frame.
    pub fn inverse_transform_point(&self, point: DVec2) -> DVec2 {
        let direction = self.heading.direction();
        DVec2::new(direction.x, -direction.y).rotate(point - self.position)
    }

    /// Composes two poses: `outer_from_inner.compose(&inner_from_child)` is `outer_from_child`.
    pub fn compose(&self, child: &Pose) -> Pose {
        let turned = self.heading.turned(child.heading.remainder);
        Pose {
            position: self.transform_point(child.position),
            heading: Heading { turns: turned.turns.saturating_add(child.heading.turns), ..turned },
        }
    }

    /// Checks that a body can be placed at this pose: at most 10^9 m from the origin along each axis. At this distance
    /// an `f64` has a resolution of about a tenth of a micrometre.
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is farther away or not finite.
    pub fn check_placement(&self) -> Result<(), PlacementError> {
        let [x, y] = self.position.to_array();
        if [x, y].iter().all(|value| value.abs() <= 1e9) { Ok(()) } else { Err(PlacementError) }
    }

    /// This pose after moving by `displacement` at constant twist, in closed form.
    ///
    /// Exact for straight lines, arcs and turns on the spot; the result is continuous when the angle approaches 0.
    pub fn moved(&self, displacement: Twist) -> Pose {
        self.moved_along(self.heading.direction(), displacement)
    }

    /// [`Pose::moved`] for a caller that already has the unit vector of the heading.
    pub(crate) fn moved_along(&self, forward: DVec2, displacement: Twist) -> Pose {
        let Twist { vx, vy, omega } = displacement;
        let (s, c) = (math::sinc(omega), math::cosc(omega));
        let chord = DVec2::new(vx * s - vy * c, vx * c + vy * s);
        Pose { position: self.position + forward.rotate(chord), heading: self.heading.turned(omega) }
    }
}

/// Error for a pose at which no body can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a coordinate is not that of a place, accepted: finite values up to 1e9 m")]
pub struct PlacementError;

/// Three-dimensional pose of one frame in another: `world_from_sensor` transforms coordinates in the sensor's frame
/// into coordinates in the world frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose3 {
    /// Origin of the inner frame in the outer frame, m.
    pub position: DVec3,
    /// Rotation whose columns are the inner frame's axes in the outer frame.
    pub rotation: DMat3,
}

impl Default for Pose3 {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose3 {
    /// The identity transform.
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, rotation: DMat3::IDENTITY };

    /// The frame at `position`, turned about x by `roll`, then about y so that x rises by `pitch`, then about z by
    /// `yaw`. All rotations are about the outer frame's axes and in rad: Rz(yaw) Ry(-pitch) Rx(roll).
    ///
    /// A positive `pitch` raises the x axis, a positive `roll` raises the left side, a positive `yaw` turns to the
    /// left. Rotations by 0 are exact: without roll and pitch, the x and y axes are exactly level.
    pub fn from_angles(position: DVec3, roll: f64, pitch: f64, yaw: f64) -> Self {
        let (sin_roll, cos_roll) = math::sin_cos(roll);
        let (sin_pitch, cos_pitch) = math::sin_cos(pitch);
        // The yaw is computed like the heading of a planar pose, so that the results are bit-identical.
        let DVec2 { x: cos_yaw, y: sin_yaw } = Heading::new(yaw).direction();
        let about_x =
            DMat3::from_cols(DVec3::X, DVec3::new(0.0, cos_roll, sin_roll), DVec3::new(0.0, -sin_roll, cos_roll));
        let about_y =
            DMat3::from_cols(DVec3::new(cos_pitch, 0.0, sin_pitch), DVec3::Y, DVec3::new(-sin_pitch, 0.0, cos_pitch));
        let about_z = DMat3::from_cols(DVec3::new(cos_yaw, sin_yaw, 0.0), DVec3::new(-sin_yaw, cos_yaw, 0.0), DVec3::Z);
        Self { position, rotation: about_z * about_y * about_x }
    }

    /// The frame of a planar pose at the height `z`, m.
    pub fn from_planar(pose: &Pose, z: f64) -> Self {
        let forward = pose.heading.direction();
        let rotation = DMat3::from_cols(forward.extend(0.0), DVec3::new(-forward.y, forward.x, 0.0), DVec3::Z);
        Self { position: pose.position.extend(z), rotation }
    }

    /// The frame at the outer frame's origin, rotated about `axis`, a unit vector, by `angle` rad; right-handed.
    ///
    /// Source: Rodrigues' formula.
    pub fn about_axis(axis: DVec3, angle: f64) -> Self {
        let (sin, cos) = math::sin_cos(angle);
        let turned = |vector: DVec3| vector * cos + axis.cross(vector) * sin + axis * (axis.dot(vector) * (1.0 - cos));
        Self { position: DVec3::ZERO, rotation: DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z)) }
    }

    /// Composes two poses: `outer_from_inner.then(&inner_from_child)` is `outer_from_child`.
    pub fn then(&self, child: &Pose3) -> Pose3 {
        Pose3 { position: self.transform_point(child.position), rotation: self.rotation * child.rotation }
    }

    /// Coordinates in the outer frame of `point`, given in the inner frame.
    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.position + self.rotation * point
    }

    /// Coordinates in the inner frame of `point`, given in the outer frame.
    pub fn inverse_transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation.transpose() * (point - self.position)
    }

    /// The inner frame's x axis in the outer frame: a sensor's line of sight.
    pub fn forward(&self) -> DVec3 {
        self.rotation.x_axis
    }

    /// Roll, pitch and yaw of the inner frame, rad, as in [`from_angles`](Self::from_angles); the pitch is within a
    /// quarter turn.
    ///
    /// If the x axis is vertical, the yaw is undefined; the result is then 0.
    pub fn angles(&self) -> [f64; 3] {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.rotation;
        let horizontal = math::hypot(x.x, x.y);
        let pitch = math::atan2(x.z, horizontal);
        // Below this length the x axis is regarded as vertical.
        if horizontal < 1e-12 {
            return [math::atan2(-z.y, y.y), pitch, 0.0];
        }
        [math::atan2(y.z, z.z), pitch, math::atan2(x.y, x.x)]
    }

    /// Returns true if the inner frame's x and y axes are exactly level.
    pub fn is_level(&self) -> bool {
        self.rotation.x_axis.z == 0.0 && self.rotation.y_axis.z == 0.0
    }
}

/// Velocity in the plane, in the moving frame. A twist multiplied by a time is used as a displacement along a path of
/// constant twist.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Twist {
    /// Forward speed, m/s; in a displacement, the arc length forwards, m.
    pub vx: f64,
    /// Speed to the left, m/s; in a displacement, the arc length to the left, m.
    pub vy: f64,
    /// Turning speed counter-clockwise, rad/s; in a displacement, the angle, rad.
    pub omega: f64,
}

impl Twist {
    /// The twist of a body at rest.
    pub const ZERO: Self = Self { vx: 0.0, vy: 0.0, omega: 0.0 };

    /// Twist with the forward speed `v`, m/s, and the turning speed `omega`, rad/s.
    pub fn new(v: f64, omega: f64) -> Self {
        Self { vx: v, vy: 0.0, omega }
    }

    /// The twist with each component multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self { vx: self.vx * factor, vy: self.vy * factor, omega: self.omega * factor }
    }

    /// The component-wise sum of both twists.
    pub fn plus(self, other: Self) -> Self {
        Self { vx: self.vx + other.vx, vy: self.vy + other.vy, omega: self.omega + other.omega }
    }

    /// Speed of the frame's origin, m/s; in a displacement, its path length, m.
    pub fn speed(self) -> f64 {
        math::hypot(self.vx, self.vy)
    }

    /// Twist of a parallel frame on the same rigid body; its origin is at `offset` in this frame, m.
    pub fn at_offset(self, offset: DVec2) -> Self {
        Self { vx: self.vx - self.omega * offset.y, vy: self.vy + self.omega * offset.x, omega: self.omega }
    }

    /// Returns true if all components are 0.
    pub fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// Returns true if every component is a finite number.
    pub fn is_finite(self) -> bool {
        self.vx.is_finite() && self.vy.is_finite() && self.omega.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_circle_matches_geometry() {
        let start = Pose::new(1.0, 2.0, 0.0);
        let radius = 0.5;
        let end = start.moved(Twist::new(radius * PI / 2.0, PI / 2.0));
        assert!((end.position - DVec2::new(1.5, 2.5)).length() < 1e-15, "within a rounding error: {end:?}");
        assert_eq!(end.heading, Heading::new(PI / 2.0));
    }

    #[test]
    fn arcs_converge_to_the_straight_line() {
        for omega in [0.0, 1e-300, -1e-300, 1e-12] {
            let end = Pose::default().moved(Twist::new(3.0, omega));
            assert!((end.position - DVec2::new(3.0, 1.5 * omega)).length() < 1e-15, "omega {omega}: {end:?}");
        }
    }

    #[test]
    fn remainder_is_exact_after_a_million_turns() {
        let mut heading = Heading::new(0.25);
        for _ in 0..1_000_000 {
            heading = heading.turned(TAU);
        }
        assert_eq!((heading.turns(), heading.remainder()), (1_000_000, 0.25));
        assert_eq!(Heading::new(PI).remainder(), -PI);
        assert_eq!(Heading::new(-PI), Heading { turns: 0, remainder: -PI });
    }

    #[test]
    fn point_behind_the_centre_of_rotation_moves_sideways() {
        let twist_of_axle = Twist::new(0.0, 2.0);
        let twist_of_centre = twist_of_axle.at_offset(DVec2::new(-0.04, 0.0));
        assert_eq!(twist_of_centre, Twist { vx: 0.0, vy: -0.08, omega: 2.0 });
    }

    #[test]
    fn rotations_have_the_signs_of_the_conventions() {
        let (roll, pitch, yaw) = (0.3, 0.4, 0.5);
        let assert_close =
            |found: DVec3, expected: DVec3| assert!((found - expected).length() < 1e-15, "{found} {expected}");
        let (sin, cos) = math::sin_cos(0.4);
        assert_close(Pose3::from_angles(DVec3::ZERO, roll, pitch, 0.0).forward(), DVec3::new(cos, 0.0, sin));
        let left = Pose3::from_angles(DVec3::ZERO, roll, 0.0, 0.0).rotation.y_axis;
        assert!(left.z > 0.0 && left.x == 0.0, "the left side rises: {left}");
        let rotation = |axis, angle| Pose3::about_axis(axis, angle);
        let product = rotation(DVec3::Z, yaw).then(&rotation(DVec3::Y, -pitch)).then(&rotation(DVec3::X, roll));
        let pose = Pose3::from_angles(DVec3::new(1.0, 2.0, 3.0), roll, pitch, yaw);
        for (found, expected) in [
            (pose.rotation.x_axis, product.rotation.x_axis),
            (pose.rotation.y_axis, product.rotation.y_axis),
            (pose.rotation.z_axis, product.rotation.z_axis),
        ] {
            assert_close(found, expected);
        }
        let angles = [[roll, pitch, yaw], [-3.0, -1.5, 3.1], [0.0, 1.0, 0.0], [2.0, std::f64::consts::FRAC_PI_2, 0.0]];
        for [roll, pitch, yaw] in angles {
            let found = Pose3::from_angles(DVec3::ZERO, roll, pitch, yaw).angles();
            assert_close(found.into(), DVec3::new(roll, pitch, yaw));
        }
        let point = DVec3::new(0.1, -0.2, 0.3);
        assert_close(pose.inverse_transform_point(pose.transform_point(point)), point);
    }

    #[test]
    fn level_pose_in_space_equals_the_planar_pose() {
        let planar = Pose::new(1.0, -2.0, 2.5);
        let space = Pose3::from_planar(&planar, 0.3);
        assert_eq!(space, Pose3::from_angles(DVec3::new(1.0, -2.0, 0.3), 0.0, 0.0, 2.5));
        assert!(space.is_level() && !Pose3::from_angles(DVec3::ZERO, 0.0, 1e-9, 1.0).is_level());
        let child = space.then(&Pose3::from_angles(DVec3::new(0.3, 0.4, 0.1), 0.0, 0.0, 1.0));
        let composed = planar.compose(&Pose::new(0.3, 0.4, 1.0));
        assert!(
            (child.position.truncate() - composed.position).length() < 1e-15 && (child.position.z - 0.4).abs() < 1e-15
        );
        assert!((child.forward().truncate() - composed.heading.direction()).length() < 1e-15);
    }

    #[test]
    fn inverse_transform_inverts_transform() {
        let world_from_robot = Pose::new(1.0, -2.0, 2.5);
        let point = DVec2::new(0.3, 0.4);
        let back = world_from_robot.inverse_transform_point(world_from_robot.transform_point(point));
        assert!((back - point).length() < 1e-15);
        let twice = world_from_robot.compose(&Pose::new(0.3, 0.4, 1.0));
        assert!((twice.position - world_from_robot.transform_point(point)).length() < 1e-15);
        assert!((twice.heading.radians() - 3.5).abs() < 1e-15);
    }
}
