use glam::DVec2;

use super::Bounds;
use crate::math;

/// The trace of a vertical wall on the floor, from `a` to `b`, in metres in the world frame.
///
/// A wall of length 0 is a point obstacle: only a ray through that point hits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// One end.
    pub a: DVec2,
    /// The other end.
    pub b: DVec2,
}

impl Segment {
    /// The wall from `a` to `b`.
    pub const fn new(a: DVec2, b: DVec2) -> Self {
        Self { a, b }
    }

    /// Length in metres.
    pub fn length(&self) -> f64 {
        math::hypot(self.b.x - self.a.x, self.b.y - self.a.y)
    }

    /// The bounding rectangle of the wall.
    pub fn bounds(&self) -> Bounds {
        Bounds { min: self.a.min(self.b), max: self.a.max(self.b) }
    }

    /// The point of the wall that is nearest to `point`.
    pub fn nearest_point(&self, point: DVec2) -> DVec2 {
        let along = self.b - self.a;
        let length_squared = along.length_squared();
        if length_squared == 0.0 {
            return self.a;
        }
        let fraction = (point - self.a).dot(along) / length_squared;
        // Computed from the nearer end, so that both ends are exact.
        if fraction <= 0.0 {
            self.a
        } else if fraction >= 1.0 {
            self.b
        } else if fraction < 0.5 {
            self.a + along * fraction
        } else {
            self.b - along * (1.0 - fraction)
        }
    }

    /// Distance from `point` to the nearest point of the wall, in metres.
    pub fn distance(&self, point: DVec2) -> f64 {
        let offset = point - self.nearest_point(point);
        math::hypot(offset.x, offset.y)
    }

    /// The four sides, counter-clockwise, of a wall `thickness` metres thick with this centre line.
    ///
    /// The ends are flush with the ends of the centre line (our choice). The common corner of neighbouring sides is
    /// bit-identical. A centre line of length 0 gives a rectangle of length 0 parallel to the y axis.
    pub fn thickened(&self, thickness: f64) -> [Segment; 4] {
        let along = self.b - self.a;
        let length = self.length();
        let to_left =
            if length > 0.0 { along.perp() * (0.5 * thickness / length) } else { DVec2::Y * (0.5 * thickness) };
        let corners = [self.a - to_left, self.b - to_left, self.b + to_left, self.a + to_left];
        std::array::from_fn(|side| Segment::new(corners[side], corners[(side + 1) % 4]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thick_wall_is_a_closed_rectangle() {
        let sides = Segment::new(DVec2::new(1.0, 1.0), DVec2::new(4.0, 5.0)).thickened(0.5);
        assert_eq!(sides[0].a, DVec2::new(1.2, 0.85));
        assert_eq!(sides[2].a, DVec2::new(3.8, 5.15));
        for side in 0..4 {
            assert_eq!(sides[side].b, sides[(side + 1) % 4].a);
        }
    }

    #[test]
    fn distances_to_a_wall_match_plane_geometry() {
        let wall = Segment::new(DVec2::ZERO, DVec2::new(4.0, 0.0));
        assert_eq!(wall.distance(DVec2::new(3.0, -2.0)), 2.0);
        assert_eq!(wall.distance(DVec2::new(7.0, 4.0)), 5.0);
        assert_eq!(wall.distance(DVec2::new(-3.0, 4.0)), 5.0);
        assert_eq!(Segment::new(DVec2::ONE, DVec2::ONE).distance(DVec2::new(4.0, 5.0)), 5.0);
    }
}
