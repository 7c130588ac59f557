//! The exact test of a ray against a wall, in `f64`; only this test decides which walls are hit.

use glam::DVec2;

use super::super::{Segment, grid::ROUNDING};
use super::{WallHit, WallId};

/// A ray prepared for tests against walls.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub origin: DVec2,
    pub direction: DVec2,
    /// Maximum distance between the ray and a point that it touches.
    pub rounding_error: f64,
    /// Upper bound of `length * distance` for a wall on which the origin lies: the wall's length, and the origin's
    /// distance from the wall, which rounding makes positive.
    pub area_rounding_error: f64,
}

/// An end of a wall in the ray's coordinates.
#[derive(Clone, Copy)]
struct End {
    /// Metres along the ray.
    ahead: f64,
    /// Metres to the left of the ray's line: the same value for all walls that share this end.
    side: f64,
}

impl Ray {
    #[inline(always)]
    fn end(&self, point: DVec2) -> End {
        let offset = point - self.origin;
        End { ahead: self.direction.dot(offset), side: self.direction.perp_dot(offset) }
    }

    /// Distance along the ray to a wall, even beyond the ray's range; negative if the ray misses the wall.
    // `|` instead of `||`, because branch prediction would fail half of the time.
    #[inline(always)]
    pub fn distance(&self, segment: &Segment) -> f64 {
        let (a, b) = (self.end(segment.a), self.end(segment.b));
        let area = a.ahead * b.side - b.ahead * a.side;
        if (a.side.abs() <= self.rounding_error)
            | (b.side.abs() <= self.rounding_error)
            | (area.abs() <= self.area_rounding_error)
        {
            self.touch_distance(segment, a, b)
        } else if a.side * b.side > 0.0 {
            -1.0
        } else {
            area / (b.side - a.side)
        }
    }

    /// [`Ray::distance`] for a wall on which the origin may lie, or one of whose ends the ray's line may touch.
    #[cold]
    #[inline(never)]
    fn touch_distance(&self, segment: &Segment, a: End, b: End) -> f64 {
        let is_left = (a.side > self.rounding_error) & (b.side > self.rounding_error);
        let is_right = (a.side < -self.rounding_error) & (b.side < -self.rounding_error);
        if is_left | is_right {
            return -1.0;
        }
        let length = (segment.b - segment.a).abs().element_sum();
        // Part of the touch tolerance that depends only on the origin.
        let origin_tolerance = ROUNDING * self.origin.abs().element_sum();
        let touches = |end: End, point: DVec2| {
            end.side.abs() <= origin_tolerance + ROUNDING * (point - self.origin).abs().element_sum()
        };
        if segment.distance(self.origin) <= origin_tolerance + ROUNDING * length {
            return 0.0;
        }
        match (touches(a, segment.a), touches(b, segment.b)) {
            // The ray's line runs along the wall, which lies ahead of the origin or behind it.
            (true, true) => a.ahead.min(b.ahead),
            _ if a.side * b.side < 0.0 => (a.ahead * b.side - b.ahead * a.side) / (b.side - a.side),
            (true, false) => a.ahead,
            (false, true) => b.ahead,
            (false, false) => -1.0,
        }
    }
}

/// The nearest wall so far.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    /// Distance of the wall; the range of the ray if there is no wall.
    pub distance: f64,
    /// The wall, or [`NO_WALL`].
    wall: WallId,
}

/// Sentinel greater than all wall numbers.
const NO_WALL: WallId = WallId(u32::MAX);

impl Nearest {
    /// No wall yet, for a ray of this range.
    pub fn new(range: f64) -> Self {
        Self { distance: range, wall: NO_WALL }
    }

    /// Records a hit at `distance` if three conditions are met: no earlier hit is nearer, no earlier hit at this
    /// distance has a lower number, and `accepts` returns true. A negative distance means no hit.
    #[inline(always)]
    pub fn offer(&mut self, wall: WallId, distance: f64, accepts: impl Fn(WallId, f64) -> bool) {
        let is_nearer = (0.0 <= distance) & (distance <= self.distance)
            && (distance < self.distance || wall < self.wall)
            && accepts(wall, distance);
        if is_nearer {
            *self = Self { distance, wall };
        }
    }

    pub fn hit(self) -> Option<WallHit> {
        (self.wall != NO_WALL).then_some(WallHit { distance: self.distance, wall: self.wall })
    }
}
