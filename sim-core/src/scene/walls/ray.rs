//! What a ray meets: the one place where it is decided, in `f64`.

use glam::DVec2;

use super::super::{Segment, grid::ROUNDING};
use super::{Hit, WallId};

/// A ray that may meet walls.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub origin: DVec2,
    pub direction: DVec2,
    /// No point of the walls is touched from farther away than this.
    pub doubt: f64,
    /// Above the product of any wall's length with the distance from which an origin is on it.
    pub doubt_area: f64,
}

/// An end of a wall as the ray sees it.
#[derive(Clone, Copy)]
struct End {
    /// Metres along the ray.
    ahead: f64,
    /// Metres to the left of the ray's line: the same value for all walls that share the end.
    side: f64,
}

impl Ray {
    #[inline(always)]
    fn end(self, point: DVec2) -> End {
        let offset = point - self.origin;
        End { ahead: self.direction.dot(offset), side: self.direction.perp_dot(offset) }
    }

    /// Distance to a wall, however far ahead; negative where it is not met.
    // Conditions are joined by `|` where a branch would be mispredicted half of the time.
    #[inline(always)]
    pub fn distance(self, segment: &Segment) -> f64 {
        let (a, b) = (self.end(segment.a), self.end(segment.b));
        let area = a.ahead * b.side - b.ahead * a.side;
        if (a.side.abs() <= self.doubt) | (b.side.abs() <= self.doubt) | (area.abs() <= self.doubt_area) {
            self.touching(segment, a, b)
        } else if a.side * b.side > 0.0 {
            -1.0
        } else {
            area / (b.side - a.side)
        }
    }

    /// Distance to a wall of which the ray's line may touch an end, or on which the origin may lie; negative for none.
    #[cold]
    #[inline(never)]
    fn touching(self, segment: &Segment, a: End, b: End) -> f64 {
        let is_left = (a.side > self.doubt) & (b.side > self.doubt);
        let is_right = (a.side < -self.doubt) & (b.side < -self.doubt);
        if is_left | is_right {
            return -1.0;
        }
        let length = (segment.b - segment.a).abs().element_sum();
        // The part of the touching distance that depends on the origin alone.
        let at_origin = ROUNDING * self.origin.abs().element_sum();
        let touches =
            |end: End, point: DVec2| end.side.abs() <= at_origin + ROUNDING * (point - self.origin).abs().element_sum();
        if segment.distance(self.origin) <= at_origin + ROUNDING * length {
            return 0.0;
        }
        match (touches(a, segment.a), touches(b, segment.b)) {
            // Along the wall, which lies before or behind the origin.
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
    /// Its distance, or the range.
    pub distance: f64,
    /// The wall, or [`NO_WALL`].
    wall: WallId,
}

/// Greater than all numbers of walls.
const NO_WALL: WallId = WallId(u32::MAX);

impl Nearest {
    pub fn within(range: f64) -> Self {
        Self { distance: range, wall: NO_WALL }
    }

    /// Takes a wall into account that is met at `distance`, if that is not negative.
    #[inline(always)]
    pub fn offer(&mut self, wall: WallId, distance: f64, counts: impl Fn(WallId, f64) -> bool) {
        let is_nearer = (0.0 <= distance) & (distance <= self.distance)
            && (distance < self.distance || wall < self.wall)
            && counts(wall, distance);
        if is_nearer {
            *self = Self { distance, wall };
        }
    }

    pub fn hit(self) -> Option<Hit> {
        (self.wall != NO_WALL).then_some(Hit { distance: self.distance, wall: self.wall })
    }
}
