//! Poses and twists in the plane: the closed form of motion with constant twist.
//!
//! The world frame has x to the right, y up and angles counter-clockwise from x; a robot's frame has x forward and y left.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::math;

/// A direction that remembers its whole turns, so that the remainder never loses digits.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Heading {
    turns: i64,
    remainder: f64,
}

impl Heading {
    /// The heading of `radians`, whole turns split off; 0 for a value that is not finite.
    pub fn new(radians: f64) -> Self {
        Self::default().turned(radians)
    }

    /// Angle within the turn, in [-pi, pi).
    pub fn remainder(self) -> f64 {
        self.remainder
    }

    /// Whole turns counter-clockwise.
    pub fn turns(self) -> i64 {
        self.turns
    }

    /// The whole angle in radians, rounded to one double.
    pub fn radians(self) -> f64 {
        self.turns as f64 * TAU + self.remainder
    }

    /// This heading turned by `radians` (counter-clockwise positive); unchanged by a value that is not finite.
    pub fn turned(self, radians: f64) -> Self {
        if !radians.is_finite() {
            return self;
        }
        let whole = (radians / TAU).round();
        let mut heading = Self {
            turns: self.turns.saturating_add(whole as i64),
            remainder: self.remainder + (radians - whole * TAU),
        };
        if heading.remainder >= PI {
            heading.remainder -= TAU;
            heading.turns = heading.turns.saturating_add(1);
        }
        if heading.remainder < -PI {
            heading.remainder += TAU;
            heading.turns = heading.turns.saturating_sub(1);
        }
        // Adding a full turn may have rounded onto the open end.
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

/// A position in metres and a heading, of a frame in another: a pose named `world_from_robot` takes coordinates of the
/// robot's frame to the world's.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Pose {
    /// Origin of the inner frame in the outer one, in metres.
    pub position: DVec2,
    /// Direction of the inner frame's x axis in the outer one.
    pub heading: Heading,
}

impl Pose {
    /// The pose at (`x`, `y`) metres, turned by `phi` radians.
    pub fn new(x: f64, y: f64, phi: f64) -> Self {
        Self { position: DVec2::new(x, y), heading: Heading::new(phi) }
    }

    /// The inner frame's `point` in the outer frame.
    pub fn transform_point(&self, point: DVec2) -> DVec2 {
        self.position + self.heading.direction().rotate(point)
    }

    /// The inner frame's vector in the outer frame: turned, not moved.
    pub fn transform_vector(&self, vector: DVec2) -> DVec2 {
        self.heading.direction().rotate(vector)
    }

    /// The outer frame's `point` in the inner frame.
    pub fn inverse_transform_point(&self, point: DVec2) -> DVec2 {
        let direction = self.heading.direction();
        DVec2::new(direction.x, -direction.y).rotate(point - self.position)
    }

    /// `outer_from_inner * inner_from_point`.
    pub fn compose(&self, inner: &Pose) -> Pose {
        let turned = self.heading.turned(inner.heading.remainder);
        Pose {
            position: self.transform_point(inner.position),
            heading: Heading { turns: turned.turns.saturating_add(inner.heading.turns), ..turned },
        }
    }

    /// Checks that something can be placed here: up to 10^9 m from the origin along each axis, where doubles still tell a
    /// quarter of a micrometre.
    ///
    /// # Errors
    /// [`PlaceError`] for what is farther away or not finite.
    pub fn check_place(&self) -> Result<(), PlaceError> {
        let [x, y] = self.position.to_array();
        if [x, y].iter().all(|value| value.abs() <= 1e9) { Ok(()) } else { Err(PlaceError) }
    }

    /// This pose after moving with `displacement` at constant twist, the closed form.
    ///
    /// Exact for straight lines, arcs and turns on the spot alike; finite and continuous as the angle goes to 0.
    pub fn moved(&self, displacement: Twist) -> Pose {
        let Twist { vx, vy, omega } = displacement;
        let (s, c) = (math::sinc(omega), math::cosc(omega));
        let chord = DVec2::new(vx * s - vy * c, vx * c + vy * s);
        Pose { position: self.transform_point(chord), heading: self.heading.turned(omega) }
    }
}

/// A pose at which nothing can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a coordinate is not that of a place, accepted: finite values up to 1e9 m")]
pub struct PlaceError;

/// A planar velocity in the moving frame, or that velocity times a time: a displacement along a path of constant twist.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Twist {
    /// Forward speed, m/s (as a displacement: arc length, m).
    pub vx: f64,
    /// Speed to the left, m/s (m).
    pub vy: f64,
    /// Turning speed counter-clockwise, rad/s (rad).
    pub omega: f64,
}

impl Twist {
    /// Rest.
    pub const ZERO: Self = Self { vx: 0.0, vy: 0.0, omega: 0.0 };

    /// Straight ahead at `v` m/s while turning at `omega` rad/s.
    pub fn new(v: f64, omega: f64) -> Self {
        Self { vx: v, vy: 0.0, omega }
    }

    /// Each component times `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self { vx: self.vx * factor, vy: self.vy * factor, omega: self.omega * factor }
    }

    /// Speed of the frame's origin, m/s.
    pub fn speed(self) -> f64 {
        math::hypot(self.vx, self.vy)
    }

    /// The same motion of the rigid body, as the twist of a frame whose origin is `offset` (in this frame, metres), with
    /// parallel axes.
    pub fn at_offset(self, offset: DVec2) -> Self {
        Self { vx: self.vx - self.omega * offset.y, vy: self.vy + self.omega * offset.x, omega: self.omega }
    }

    /// True when nothing moves.
    pub fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// True when every component is a finite number.
    pub fn is_finite(self) -> bool {
        self.vx.is_finite() && self.vy.is_finite() && self.omega.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        let start = Pose::new(1.0, 2.0, 0.0);
        let radius = 0.5;
        let end = start.moved(Twist::new(radius * PI / 2.0, PI / 2.0));
        assert!((end.position - DVec2::new(1.5, 2.5)).length() < 1e-15, "within a rounding error: {end:?}");
        assert_eq!(end.heading, Heading::new(PI / 2.0));
    }

    #[test]
    fn the_arc_goes_over_into_the_line() {
        for omega in [0.0, 1e-300, -1e-300, 1e-12] {
            let end = Pose::default().moved(Twist::new(3.0, omega));
            assert!((end.position - DVec2::new(3.0, 1.5 * omega)).length() < 1e-15, "omega {omega}: {end:?}");
        }
    }

    #[test]
    fn a_million_turns_keep_the_remainder() {
        let mut heading = Heading::new(0.25);
        for _ in 0..1_000_000 {
            heading = heading.turned(TAU);
        }
        assert_eq!((heading.turns(), heading.remainder()), (1_000_000, 0.25));
        assert_eq!(Heading::new(PI).remainder(), -PI);
        assert_eq!(Heading::new(-PI), Heading { turns: 0, remainder: -PI });
    }

    #[test]
    fn a_body_turning_about_a_point_ahead_moves_sideways() {
        let twist_of_axle = Twist::new(0.0, 2.0);
        let twist_of_centre = twist_of_axle.at_offset(DVec2::new(-0.04, 0.0));
        assert_eq!(twist_of_centre, Twist { vx: 0.0, vy: -0.08, omega: 2.0 });
    }

    #[test]
    fn compose_and_inverse_agree() {
        let world_from_robot = Pose::new(1.0, -2.0, 2.5);
        let point = DVec2::new(0.3, 0.4);
        let back = world_from_robot.inverse_transform_point(world_from_robot.transform_point(point));
        assert!((back - point).length() < 1e-15);
        let twice = world_from_robot.compose(&Pose::new(0.3, 0.4, 1.0));
        assert!((twice.position - world_from_robot.transform_point(point)).length() < 1e-15);
        assert!((twice.heading.radians() - 3.5).abs() < 1e-15);
    }
}
