//! Walls that do not move, and the nearest of them along a ray.

use std::ops::ControlFlow;

use glam::{DVec2, Vec2Swizzles};

use super::grid::{Cells, Grid, ROUNDING, doubt, is_ray, is_usable, rounding_margin};
use super::{Bounds, Segment};

/// A wall's number: its place in the list that [`Walls::new`] was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct WallId(pub u32);

/// The nearest wall along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Metres from the ray's origin to the wall; not negative.
    pub distance: f64,
    /// The wall; of several at the same distance, the one with the lowest number.
    pub wall: WallId,
}

/// Cells of the grid for each wall.
const CELLS_PER_WALL: f64 = 4.0;

/// Entries of walls in cells for each wall, on average, that long walls may cost.
const ENTRIES_PER_WALL: f64 = 8.0;

/// All walls of a scene, immutable, with a uniform grid over them for rays.
///
/// Any list will do: walls without length, duplicates, none at all, far from the origin. Memory is a fixed multiple of
/// the number of walls. Walls with a coordinate that is not finite or exceeds 10^100 m keep their number but are never
/// met.
///
/// # What a ray meets
/// A ray and a point touch when their distance is at most 8 units in the last place (2^-52) of the sum of the point's
/// distance and the origin's coordinates: 2e-14 m at 10 m from the world's origin, 2e-11 m at 10 km. With that,
/// - a ray that crosses a wall or touches one of its ends meets it: no ray slips through a shared corner, whose side of
///   the ray is the same value for both walls;
/// - a ray along a wall, that touches both ends, meets the nearer end;
/// - a ray that starts on a wall, nearer to it than 8 such units of the sum of the wall's length and the origin's
///   coordinates, meets it at distance 0, whatever its direction.
#[derive(Clone, Debug)]
pub struct Walls {
    segments: Vec<Segment>,
    /// By wall, m; empty when all are of any height.
    heights: Vec<f64>,
    bounds: Option<Bounds>,
    grid: Grid,
    /// Margin by which walls are larger when they are entered into cells: more than all rounding of rays and cells.
    margin: f64,
    cells: Cells<Entry>,
}

/// A wall in a cell, with its coordinates at hand.
#[derive(Clone, Copy, Debug)]
struct Entry {
    segment: Segment,
    wall: WallId,
}

impl Walls {
    /// The walls `segments`, numbered in their order, as high as it takes.
    ///
    /// # Panics
    /// If there are 2^26 walls or more.
    pub fn new(segments: Vec<Segment>) -> Self {
        assert!(segments.len() < 1 << 26, "a scene has fewer than 2^26 walls");
        let entries: Vec<Entry> = (0..)
            .zip(&segments)
            .filter(|(_, segment)| is_usable(segment.a) && is_usable(segment.b))
            .map(|(wall, &segment)| Entry { segment, wall: WallId(wall) })
            .collect();
        let extent = entries.iter().fold(Bounds::EMPTY, |bounds, entry| bounds.union(entry.segment.bounds()));
        let bounds = (!entries.is_empty()).then_some(extent);
        let (grid, margin) = match bounds {
            Some(bounds) => lay_out(bounds, &entries),
            None => (Grid::new(Bounds { min: DVec2::ZERO, max: DVec2::ZERO }, 1.0), 0.0),
        };
        let mut cells = Cells::default();
        cells.fill(grid.len(), entries.iter().copied(), |entry, visit| {
            for_each_cell(&grid, margin, &entry.segment, visit)
        });
        Self { segments, heights: Vec::new(), bounds, grid, margin, cells }
    }

    /// These walls with the heights of their upper edges above the floor, m, in the same order.
    ///
    /// # Panics
    /// If there are not as many heights as walls.
    pub fn with_heights(self, heights: Vec<f64>) -> Self {
        assert_eq!(heights.len(), self.segments.len(), "each wall has a height");
        Self { heights, ..self }
    }

    /// Height of a wall's upper edge above the floor, m; infinite where none is known.
    pub fn height(&self, id: WallId) -> f64 {
        self.heights.get(id.0 as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// Number of walls, those that no ray can meet included.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Whether there is no wall.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The wall with number `id`.
    ///
    /// # Panics
    /// If there is no such wall.
    pub fn segment(&self, id: WallId) -> &Segment {
        &self.segments[id.0 as usize]
    }

    /// All walls in the order of their numbers.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The smallest rectangle around all walls that can be met; `None` without any.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// The nearest wall at most `range` metres from `origin` along `direction`, a vector of length 1.
    ///
    /// What counts as meeting a wall stands with [`Walls`]. `range` may be infinite. `None` when nothing is met, when an
    /// argument is NaN, `origin` infinite or beyond 10^100 m, `range` negative, or the length of `direction` not 1
    /// within 10^-6.
    pub fn cast(&self, origin: DVec2, direction: DVec2, range: f64) -> Option<Hit> {
        self.cast_where(origin, direction, range, |_, _| true)
    }

    /// As [`Walls::cast`], of those walls of which `counts` is true; it is given a wall and its distance.
    #[inline]
    pub fn cast_where(
        &self,
        origin: DVec2,
        direction: DVec2,
        range: f64,
        counts: impl Fn(WallId, f64) -> bool,
    ) -> Option<Hit> {
        if !is_ray(origin, direction, range) {
            return None;
        }
        let bounds = self.bounds?;
        let mut ray = Ray::new(origin, direction, range, bounds);
        if ray.doubt < self.margin {
            self.grid.walk(origin, direction, range, |cell, exit| {
                for entry in self.cells.of(cell) {
                    ray.test(&entry.segment, entry.wall, &counts);
                }
                if ray.nearest <= exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
        } else if bounds.grown(2.0 * ray.doubt).clip(origin, direction, range).is_some() {
            // So far away that rounding exceeds the margin of the cells.
            for (wall, segment) in (0..).zip(&self.segments) {
                if is_usable(segment.a) && is_usable(segment.b) {
                    ray.test(segment, WallId(wall), &counts);
                }
            }
        }
        ray.hit()
    }

    /// Visits each wall whose rectangle meets `bounds`, once, in the order of their numbers.
    pub fn for_each_in(&self, bounds: Bounds, mut visit: impl FnMut(WallId, &Segment)) {
        if !self.bounds.is_some_and(|all| all.overlaps(&bounds)) {
            return;
        }
        for id in self.candidates(&bounds) {
            let segment = self.segment(id);
            if segment.bounds().overlaps(&bounds) {
                visit(id, segment);
            }
        }
    }

    /// Every wall in the cells that `bounds` meets, in order and once.
    fn candidates(&self, bounds: &Bounds) -> Vec<WallId> {
        let (columns, rows) = self.grid.span(bounds);
        let mut ids = Vec::new();
        for row in rows {
            let (first, last) = (self.grid.index(*columns.start(), row), self.grid.index(*columns.end(), row));
            // The cells of a row are neighbours, so are their entries.
            let entries = self.cells.of_range(first, last);
            ids.extend(entries.iter().map(|entry| entry.wall));
        }
        ids.sort_unstable();
        ids.dedup();
        ids
    }
}

/// Size of the cells, and the margin of the walls in them.
///
/// Cells are as small as three budgets, each a multiple of the number of walls, allow: the number of cells, of entries
/// (a wall enters about one cell more than its extents hold cells), and of cells that a ray can pass.
fn lay_out(bounds: Bounds, entries: &[Entry]) -> (Grid, f64) {
    let count = entries.len() as f64;
    let size = bounds.max - bounds.min;
    let lengths: f64 = entries.iter().map(|entry| (entry.segment.b - entry.segment.a).abs().element_sum()).sum();
    let rounding = rounding_margin(&bounds);
    let cell = (size.x * size.y / (CELLS_PER_WALL * count))
        .sqrt()
        .max(lengths / (ENTRIES_PER_WALL * count))
        .max((size.x + size.y) / (8.0 * count + 64.0))
        .max(1e6 * rounding)
        .max(1e-9);
    let margin = (1e-6 * cell).max(rounding);
    (Grid::new(bounds.grown(2.0 * margin), cell), margin)
}

/// Visits each cell that the wall, made larger by `margin` on all sides, meets.
fn for_each_cell(grid: &Grid, margin: f64, segment: &Segment, mut visit: impl FnMut(usize)) {
    let along = (segment.b - segment.a).abs();
    if along.x >= along.y {
        let (columns, _) = grid.span(&segment.bounds().grown(margin));
        for column in columns {
            let (left, right) = (grid.left(column) - margin, grid.left(column + 1) + margin);
            let (low, high) = heights_between(segment.a, segment.b, left, right);
            for row in grid.row(low - margin)..=grid.row(high + margin) {
                visit(grid.index(column, row));
            }
        }
    } else {
        let (_, rows) = grid.span(&segment.bounds().grown(margin));
        for row in rows {
            let (lower, upper) = (grid.lower(row) - margin, grid.lower(row + 1) + margin);
            let (low, high) = heights_between(segment.a.yx(), segment.b.yx(), lower, upper);
            for column in grid.column(low - margin)..=grid.column(high + margin) {
                visit(grid.index(column, row));
            }
        }
    }
}

/// Least and greatest y of the line from `a` to `b`, which rises by at most 1 in 1, where x lies between `left` and
/// `right` (or is as near as the line comes).
fn heights_between(a: DVec2, b: DVec2, left: f64, right: f64) -> (f64, f64) {
    let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
    let height = |x: f64| {
        if x <= a.x {
            a.y
        } else if x >= b.x {
            b.y
        } else {
            a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y)
        }
    };
    let (one, other) = (height(left), height(right));
    (one.min(other), one.max(other))
}

/// A ray on its way, with the nearest hit so far.
struct Ray {
    origin: DVec2,
    direction: DVec2,
    /// Part of the touching distance that depends on the origin alone.
    at_origin: f64,
    /// No point of the walls is touched from farther away than this.
    doubt: f64,
    /// Above the product of any wall's length with the distance from which an origin is on it.
    doubt_area: f64,
    /// Distance of the nearest hit so far, or the range.
    nearest: f64,
    /// Its wall, or [`NO_WALL`].
    wall: WallId,
}

/// Greater than all numbers of walls.
const NO_WALL: WallId = WallId(u32::MAX);

/// An end of a wall as the ray sees it.
#[derive(Clone, Copy)]
struct End {
    /// Metres along the ray.
    ahead: f64,
    /// Metres to the left of the ray's line: the same value for all walls that share the end.
    side: f64,
}

impl Ray {
    #[inline]
    fn new(origin: DVec2, direction: DVec2, range: f64, bounds: Bounds) -> Self {
        let doubt = doubt(origin, &bounds);
        Self {
            origin,
            direction,
            at_origin: ROUNDING * origin.abs().element_sum(),
            doubt,
            doubt_area: 4.0 * doubt * (bounds.max - bounds.min).element_sum(),
            nearest: range,
            wall: NO_WALL,
        }
    }

    #[inline]
    fn end(&self, point: DVec2) -> End {
        let offset = point - self.origin;
        End { ahead: self.direction.dot(offset), side: self.direction.perp_dot(offset) }
    }

    /// Takes the wall into account.
    // Conditions are joined by `&` where a branch would be mispredicted half of the time.
    #[inline(always)]
    fn test(&mut self, segment: &Segment, wall: WallId, counts: &impl Fn(WallId, f64) -> bool) {
        let (a, b) = (self.end(segment.a), self.end(segment.b));
        if ((a.side > self.doubt) & (b.side > self.doubt)) | ((a.side < -self.doubt) & (b.side < -self.doubt)) {
            return;
        }
        let area = a.ahead * b.side - b.ahead * a.side;
        let in_doubt = (a.side.abs() <= self.doubt) | (b.side.abs() <= self.doubt) | (area.abs() <= self.doubt_area);
        let distance = if in_doubt { self.touching(segment, a, b) } else { area / (b.side - a.side) };
        let is_nearer = (0.0 <= distance) & (distance <= self.nearest) && (distance < self.nearest || wall < self.wall);
        if is_nearer && counts(wall, distance) {
            self.nearest = distance;
            self.wall = wall;
        }
    }

    /// Distance to a wall of which the ray's line may touch an end, or on which the origin may lie; negative for none.
    #[cold]
    fn touching(&self, segment: &Segment, a: End, b: End) -> f64 {
        let length = (segment.b - segment.a).abs().element_sum();
        let touches = |end: End, point: DVec2| {
            end.side.abs() <= self.at_origin + ROUNDING * (point - self.origin).abs().element_sum()
        };
        if segment.distance(self.origin) <= self.at_origin + ROUNDING * length {
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

    fn hit(&self) -> Option<Hit> {
        (self.wall != NO_WALL).then_some(Hit { distance: self.nearest, wall: self.wall })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_SQRT_2;

    use super::*;

    fn walls(ends: &[[f64; 4]]) -> Walls {
        Walls::new(ends.iter().map(|&[ax, ay, bx, by]| Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by))).collect())
    }

    fn distance(walls: &Walls, origin: [f64; 2], direction: [f64; 2], range: f64) -> Option<f64> {
        walls.cast(DVec2::from(origin), DVec2::from(direction), range).map(|hit| hit.distance)
    }

    #[test]
    fn the_nearest_wall_within_range_is_met() {
        let scene = walls(&[[3.0, -1.0, 3.0, 1.0], [2.0, -1.0, 2.0, 1.0], [-1.0, -1.0, -1.0, 1.0]]);
        let hit = scene.cast(DVec2::ZERO, DVec2::X, 2.0);
        assert_eq!(hit, Some(Hit { distance: 2.0, wall: WallId(1) }));
        assert_eq!(distance(&scene, [0.0, 0.0], [1.0, 0.0], 1.999), None);
        assert_eq!(distance(&scene, [0.0, 0.0], [-1.0, 0.0], f64::INFINITY), Some(1.0));
        assert_eq!(distance(&scene, [0.0, 0.0], [0.0, 1.0], f64::INFINITY), None);
    }

    #[test]
    fn a_wall_seen_along_itself_ends_at_the_nearer_end() {
        let scene = walls(&[[5.0, 5.0, 1.0, 1.0]]);
        let near = distance(&scene, [0.0, 0.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0);
        assert!((near.unwrap() - std::f64::consts::SQRT_2).abs() < 1e-15, "within rounding: {near:?}");
        assert_eq!(distance(&scene, [2.0, 2.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0), Some(0.0), "from within");
        assert_eq!(distance(&scene, [6.0, 6.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0), None, "away from it");
    }

    #[test]
    fn from_on_a_wall_everything_is_at_0() {
        let scene = walls(&[[-1.0, 0.1, 2.0, 0.7]]);
        let on = DVec2::new(0.5, 0.1 + 0.6 / 3.0 * 1.5);
        for step in 0..64 {
            let (y, x) = crate::math::sin_cos(f64::from(step) * 0.1);
            assert_eq!(distance(&scene, on.into(), [x, y], 1.0), Some(0.0), "step {step}");
        }
    }

    #[test]
    fn walls_on_the_borders_of_cells_are_in_the_cells_on_both_sides() {
        let upright = |x: f64| [x, 0.0, x, 1.0];
        let mut ends = vec![upright(0.0), upright(1.0)];
        ends.resize(10, upright(0.5));
        let spaced = walls(&ends).grid;
        let borders: Vec<f64> = (1..9).map(|column| spaced.left(column)).filter(|&x| x < 1.0).collect();
        assert!(borders.len() > 3, "a grid of several columns: {borders:?}");
        for (end, &border) in ends[2..].iter_mut().zip(&borders) {
            *end = upright(border);
        }
        let scene = walls(&ends);
        assert_eq!(scene.grid.left(1), borders[0], "neither the bounds nor the lengths have changed");
        for &border in &borders {
            let near = border.next_down().max(border - 1e-12);
            for (x, direction) in [(border - 0.01, 1.0), (border + 0.01, -1.0), (near, 1.0), (near, -1.0)] {
                let range = (border - x).abs() + 1e-15;
                let found = distance(&scene, [x, 0.5], [direction, 0.0], range);
                assert!(found.is_some_and(|metres| metres <= range), "the wall at {border} from {x}: {found:?}");
            }
            for x in [border.next_down(), border, border.next_up()] {
                assert_eq!(distance(&scene, [x, -1.0], [0.0, 1.0], 2.0), Some(1.0), "along {border}");
                assert_eq!(distance(&scene, [x, 2.0], [0.0, -1.0], 2.0), Some(1.0), "along {border}");
            }
        }
    }

    #[test]
    fn arguments_that_are_no_ray_meet_nothing() {
        let scene = walls(&[[1.0, -1.0, 1.0, 1.0]]);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(distance(&scene, [bad, 0.0], [1.0, 0.0], 2.0), None);
            assert_eq!(distance(&scene, [0.0, bad], [1.0, 0.0], 2.0), None);
            assert_eq!(distance(&scene, [0.0, 0.0], [bad, 0.0], 2.0), None);
            assert_eq!(distance(&scene, [0.0, 0.0], [1.0, bad], 2.0), None);
        }
        assert_eq!(distance(&scene, [0.0, 0.0], [1.0, 0.0], f64::NAN), None);
        assert_eq!(distance(&scene, [0.0, 0.0], [1.0, 0.0], -1.0), None);
        assert_eq!(distance(&scene, [0.0, 0.0], [0.0, 0.0], 2.0), None);
        assert_eq!(distance(&walls(&[]), [0.0, 0.0], [1.0, 0.0], f64::INFINITY), None);
    }

    #[test]
    fn walls_without_numbers_keep_theirs() {
        let scene = walls(&[[f64::NAN, 0.0, 1.0, 0.0], [0.0, f64::INFINITY, 1.0, 0.0], [1.0, -1.0, 1.0, 1.0]]);
        assert_eq!(scene.cast(DVec2::ZERO, DVec2::X, 2.0).unwrap().wall, WallId(2));
        assert_eq!(scene.bounds(), Some(Bounds { min: DVec2::new(1.0, -1.0), max: DVec2::ONE }));
        assert_eq!(scene.len(), 3);
    }

    #[test]
    fn a_query_visits_each_wall_in_order_once() {
        let scene = walls(&[[0.0, 0.0, 4.0, 4.0], [4.0, 0.0, 0.0, 4.0], [9.0, 9.0, 9.0, 9.0]]);
        let visited = |bounds| {
            let mut ids = Vec::new();
            scene.for_each_in(bounds, |id, segment| {
                assert_eq!(segment, scene.segment(id));
                ids.push(id.0);
            });
            ids
        };
        assert_eq!(visited(Bounds::of_disc(DVec2::new(2.0, 2.0), 1.0)), [0, 1]);
        assert_eq!(visited(Bounds::of_disc(DVec2::new(9.0, 9.0), 1.0)), [2]);
        assert_eq!(visited(Bounds::EMPTY.grown(f64::NAN)), [0; 0]);
        let everything = Bounds { min: DVec2::NEG_INFINITY, max: DVec2::INFINITY };
        assert_eq!(visited(everything), [0, 1, 2]);
    }
}
