//! Static walls, and the search for the nearest wall along a ray.

mod batch;
mod clearance;
mod ray;

use fearless_simd::{Level, Simd, dispatch};
use glam::{DVec2, Vec2Swizzles};

use super::grid::{Cells, Grid, is_ray, is_usable, rounding_error, rounding_margin};
use super::{Bounds, Segment};
use batch::WallBatches;
use clearance::Clearance;
use ray::{Nearest, Ray};

/// A wall's number: its index in the list passed to [`Walls::new`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct WallId(pub u32);

/// The nearest wall along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallHit {
    /// Distance from the ray's origin to the wall, m; not negative.
    pub distance: f64,
    /// The wall; among walls at the same distance, the one with the lowest number.
    pub wall: WallId,
}

/// Maximum number of grid cells per wall.
const CELLS_PER_WALL: f64 = 0.5;

/// Maximum average number of cell entries per wall; limits the cost of long walls.
const ENTRIES_PER_WALL: f64 = 8.0;

/// Maximum sum of columns and rows of a grid: keeps distances to cell borders, which are summed step by step, exact
/// within 10^-7 of a cell.
const MAX_CELLS_ACROSS: f64 = 16384.0;

/// All walls of a scene, immutable, with a uniform grid over them for rays.
///
/// Any list is allowed: walls without length, duplicates, an empty list, walls far from the origin. Memory is a fixed
/// multiple of the number of walls. Walls with a coordinate that is not finite or exceeds 10^100 m keep their number
/// but are never hit.
///
/// # Definition of a hit
/// A ray and a point touch if their distance is at most 8 units in the last place (2^-52) of the sum of the point's
/// distance and the origin's coordinates: 2e-14 m at 10 m from the world's origin, 2e-11 m at 10 km. With this
/// tolerance,
/// - a ray that crosses a wall or touches one of its ends hits the wall. No ray slips through a shared corner, because
///   the side of the ray on which the corner lies is the same value for both walls;
/// - a ray along a wall, touching both ends, hits the nearer end;
/// - a ray that starts on a wall hits it at distance 0 in every direction. An origin is on the wall if its distance
///   from the wall is at most 8 such units of the sum of the wall's length and the origin's coordinates.
#[derive(Clone, Debug)]
pub struct Walls {
    segments: Vec<Segment>,
    /// Height by wall, m; empty if all walls are unlimited in height.
    heights: Vec<f64>,
    bounds: Option<Bounds>,
    grid: Grid,
    /// Margin by which walls are enlarged on insertion into cells; larger than all rounding of rays and cells.
    margin: f64,
    /// The walls' bounds, enlarged by the margin; empty without a wall that a ray can hit.
    area: Bounds,
    /// Upper bound of the [`rounding_error`] of every ray that starts in `area`, and its [`area_rounding_error`].
    inside_rounding_errors: (f64, f64),
    level: Level,
    batches: WallBatches,
    /// `None` without a wall that a ray can hit.
    clearance: Option<Clearance>,
    /// Maximum of the clearance, m.
    max_clearance: f64,
}

impl Walls {
    /// Walls along `segments`, numbered in their order, unlimited in height.
    ///
    /// # Panics
    /// If there are 2^26 walls or more.
    pub fn new(segments: Vec<Segment>) -> Self {
        assert!(segments.len() < 1 << 26, "a scene has fewer than 2^26 walls");
        let usable: Vec<u32> = (0..)
            .zip(&segments)
            .filter(|(_, segment)| is_usable(segment.a) && is_usable(segment.b))
            .map(|(wall, _)| wall)
            .collect();
        let extent = usable.iter().fold(Bounds::EMPTY, |extent, &wall| extent.union(segments[wall as usize].bounds()));
        let bounds = (!usable.is_empty()).then_some(extent);
        let (grid, margin) = match bounds {
            Some(bounds) => choose_grid(bounds, usable.iter().map(|&wall| &segments[wall as usize])),
            None => (Grid::new(Bounds { min: DVec2::ZERO, max: DVec2::ZERO }, 1.0), 0.0),
        };
        let mut cells = Cells::default();
        cells.fill(grid.len(), usable.iter().copied(), |wall, visit| {
            for_each_cell(&grid, margin, &segments[wall as usize], visit)
        });
        let batches = WallBatches::new(&grid, &cells, &segments);
        let area = extent.grown(margin);
        let rounding_error = 0.5 * rounding_margin(&area);
        let inside_rounding_errors = (rounding_error, area_rounding_error(rounding_error, &extent));
        let clearance =
            bounds.map(|bounds| Clearance::new(bounds, usable.iter().map(|&wall| &segments[wall as usize])));
        Self {
            segments,
            heights: Vec::new(),
            bounds,
            grid,
            margin,
            area,
            inside_rounding_errors,
            level: Level::new(),
            batches,
            max_clearance: clearance.as_ref().map_or(0.0, |clearance| clearance.max_bound),
            clearance,
        }
    }

    /// Sets the heights of the walls' upper edges above the floor, m, in the order of the walls.
    ///
    /// # Panics
    /// If the number of heights differs from the number of walls.
    pub fn with_heights(self, heights: Vec<f64>) -> Self {
        assert_eq!(heights.len(), self.segments.len(), "each wall has a height");
        Self { heights, ..self }
    }

    /// Height of a wall's upper edge above the floor, m; infinite if no heights were set.
    pub fn height(&self, id: WallId) -> f64 {
        self.heights.get(id.0 as usize).copied().unwrap_or(f64::INFINITY)
    }

    /// Number of walls, including those that no ray can hit.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Returns true if there are no walls.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The wall with number `id`.
    ///
    /// # Panics
    /// If the wall does not exist.
    pub fn segment(&self, id: WallId) -> &Segment {
        &self.segments[id.0 as usize]
    }

    /// All walls in the order of their numbers.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// The bounding rectangle of all walls that a ray can hit; `None` if there are none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// Lower bound of the distance from `point` to the nearest wall that a ray can hit, m.
    #[inline]
    fn clearance(&self, point: DVec2) -> f64 {
        self.clearance.as_ref().map_or(0.0, |clearance| clearance.lower_bound(point))
    }

    /// The nearest wall at most `range` metres from `origin` along `direction`, a vector of length 1.
    ///
    /// [`Walls`] defines a hit. `range` may be infinite. `None` without a hit, and for an invalid ray: an argument is
    /// NaN, `origin` is infinite or beyond 10^100 m, `range` is negative, or the length of `direction` is not 1 within
    /// 10^-6.
    pub fn cast(&self, origin: DVec2, direction: DVec2, range: f64) -> Option<WallHit> {
        if range < self.max_clearance && range < self.clearance(origin) {
            return None;
        }
        self.cast_where(origin, direction, range, |_, _| true)
    }

    /// Like [`Walls::cast`], but only for walls for which `accepts`, called with a wall and its distance, returns true.
    #[inline]
    pub fn cast_where(
        &self,
        origin: DVec2,
        direction: DVec2,
        range: f64,
        accepts: impl Fn(WallId, f64) -> bool,
    ) -> Option<WallHit> {
        dispatch!(self.level, simd => self.cast_with(simd, origin, direction, range, &accepts))
    }

    #[inline(always)]
    fn cast_with<S: Simd>(
        &self,
        simd: S,
        origin: DVec2,
        direction: DVec2,
        range: f64,
        accepts: &impl Fn(WallId, f64) -> bool,
    ) -> Option<WallHit> {
        if !is_ray(origin, direction, range) {
            return None;
        }
        let (ray, start, passed) = if self.area.contains(origin) {
            let (rounding_error, area_rounding_error) = self.inside_rounding_errors;
            (Ray { origin, direction, rounding_error, area_rounding_error }, origin, 0.0)
        } else {
            let bounds = self.bounds?;
            let ray = self.ray(origin, direction, rounding_error(origin, &bounds), bounds);
            if ray.rounding_error >= self.margin {
                return self.cast_from_afar(&ray, range, bounds, accepts);
            }
            let (entry, _) = self.area.clip(origin, direction, range)?;
            (ray, origin + direction * entry, entry)
        };
        self.batches.walk(simd, &self.segments, &ray, start, passed, Nearest::new(range), accepts).hit()
    }

    /// The nearest wall along a ray whose origin is so distant that rounding exceeds the margin of the cells.
    fn cast_from_afar(
        &self,
        ray: &Ray,
        range: f64,
        bounds: Bounds,
        accepts: &impl Fn(WallId, f64) -> bool,
    ) -> Option<WallHit> {
        bounds.grown(2.0 * ray.rounding_error).clip(ray.origin, ray.direction, range)?;
        let mut nearest = Nearest::new(range);
        for (wall, segment) in (0..).map(WallId).zip(&self.segments) {
            if is_usable(segment.a) && is_usable(segment.b) {
                nearest.offer(wall, ray.distance(segment), accepts);
            }
        }
        nearest.hit()
    }

    #[inline(always)]
    fn ray(&self, origin: DVec2, direction: DVec2, rounding_error: f64, bounds: Bounds) -> Ray {
        Ray { origin, direction, rounding_error, area_rounding_error: area_rounding_error(rounding_error, &bounds) }
    }

    /// Visits each wall that overlaps `bounds` once, in the order of their numbers. May also visit walls of which only
    /// the bounding rectangle overlaps `bounds`.
    pub fn for_each_in(&self, bounds: Bounds, mut visit: impl FnMut(WallId, &Segment)) {
        let half = 0.5 * (bounds.max - bounds.min);
        let is_clear = half.element_sum() < self.clearance(bounds.min + half);
        if is_clear || !self.bounds.is_some_and(|extent| extent.overlaps(&bounds)) {
            return;
        }
        for id in self.candidates(&bounds) {
            let segment = self.segment(id);
            if segment.bounds().overlaps(&bounds) {
                visit(id, segment);
            }
        }
    }

    /// Walls in the cells that `bounds` overlaps, without duplicates, in the order of their numbers.
    fn candidates(&self, bounds: &Bounds) -> Vec<WallId> {
        let mut ids = Vec::new();
        self.batches.collect(self.grid.span(bounds), &mut ids);
        ids.sort_unstable();
        ids.dedup();
        ids
    }
}

/// The [`area_rounding_error`](Ray::area_rounding_error) for walls within `bounds`.
fn area_rounding_error(rounding_error: f64, bounds: &Bounds) -> f64 {
    4.0 * rounding_error * (bounds.max - bounds.min).element_sum()
}

/// Chooses the cell size and the margin of the walls.
///
/// Cells are as small as three limits allow, each proportional to the number of walls: the number of cells, the number
/// of entries (a wall has about one entry more than its extents span cells), and the number of cells along a ray.
fn choose_grid<'a>(bounds: Bounds, walls: impl ExactSizeIterator<Item = &'a Segment>) -> (Grid, f64) {
    let count = walls.len() as f64;
    let size = bounds.max - bounds.min;
    let lengths: f64 = walls.map(|wall| (wall.b - wall.a).abs().element_sum()).sum();
    let rounding = rounding_margin(&bounds);
    let cell = (size.x * size.y / (CELLS_PER_WALL * count))
        .sqrt()
        .max(lengths / (ENTRIES_PER_WALL * count))
        .max((size.x + size.y) / (8.0 * count + 64.0).min(MAX_CELLS_ACROSS))
        .max(1e6 * rounding)
        .max(1e-9);
    let margin = (1e-6 * cell).max(rounding);
    (Grid::new(bounds.grown(2.0 * margin), cell), margin)
}

/// Visits each cell that the wall, enlarged by `margin` on all sides, overlaps.
fn for_each_cell(grid: &Grid, margin: f64, segment: &Segment, mut visit: impl FnMut(usize)) {
    let extent = (segment.b - segment.a).abs();
    if extent.x >= extent.y {
        let (columns, _) = grid.span(&segment.bounds().grown(margin));
        for column in columns {
            let (left, right) = (grid.left(column) - margin, grid.left(column + 1) + margin);
            let (low, high) = y_between(segment.a, segment.b, left, right);
            for row in grid.row(low - margin)..=grid.row(high + margin) {
                visit(grid.index(column, row));
            }
        }
    } else {
        let (_, rows) = grid.span(&segment.bounds().grown(margin));
        for row in rows {
            let (lower, upper) = (grid.lower(row) - margin, grid.lower(row + 1) + margin);
            let (low, high) = y_between(segment.a.yx(), segment.b.yx(), lower, upper);
            for column in grid.column(low - margin)..=grid.column(high + margin) {
                visit(grid.index(column, row));
            }
        }
    }
}

/// Minimum and maximum y, for x between `left` and `right`, of the segment from `a` to `b`, whose slope is between -1
/// and 1. If x is beyond an end, y is the y of that end.
fn y_between(a: DVec2, b: DVec2, left: f64, right: f64) -> (f64, f64) {
    let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
    let y = |x: f64| {
        if x <= a.x {
            a.y
        } else if x >= b.x {
            b.y
        } else {
            a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y)
        }
    };
    let (left_y, right_y) = (y(left), y(right));
    (left_y.min(right_y), left_y.max(right_y))
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
    fn the_nearest_wall_within_range_is_hit() {
        let scene = walls(&[[3.0, -1.0, 3.0, 1.0], [2.0, -1.0, 2.0, 1.0], [-1.0, -1.0, -1.0, 1.0]]);
        let hit = scene.cast(DVec2::ZERO, DVec2::X, 2.0);
        assert_eq!(hit, Some(WallHit { distance: 2.0, wall: WallId(1) }));
        assert_eq!(distance(&scene, [0.0, 0.0], [1.0, 0.0], 1.999), None);
        assert_eq!(distance(&scene, [0.0, 0.0], [-1.0, 0.0], f64::INFINITY), Some(1.0));
        assert_eq!(distance(&scene, [0.0, 0.0], [0.0, 1.0], f64::INFINITY), None);
    }

    #[test]
    fn a_ray_along_a_wall_hits_its_nearer_end() {
        let scene = walls(&[[5.0, 5.0, 1.0, 1.0]]);
        let near = distance(&scene, [0.0, 0.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0);
        assert!((near.unwrap() - std::f64::consts::SQRT_2).abs() < 1e-15, "within rounding: {near:?}");
        assert_eq!(
            distance(&scene, [2.0, 2.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0),
            Some(0.0),
            "from a point on the wall"
        );
        assert_eq!(distance(&scene, [6.0, 6.0], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], 9.0), None, "away from it");
    }

    #[test]
    fn a_ray_that_starts_on_a_wall_hits_it_at_distance_0() {
        let scene = walls(&[[-1.0, 0.1, 2.0, 0.7]]);
        let origin = DVec2::new(0.5, 0.1 + 0.6 / 3.0 * 1.5);
        for step in 0..64 {
            let (y, x) = crate::math::sin_cos(f64::from(step) * 0.1);
            assert_eq!(distance(&scene, origin.into(), [x, y], 1.0), Some(0.0), "step {step}");
        }
    }

    #[test]
    fn walls_on_the_borders_of_cells_are_in_the_cells_on_both_sides() {
        let upright = |x: f64| [x, 0.0, x, 1.0];
        let mut ends = vec![upright(0.0), upright(1.0)];
        ends.resize(40, upright(0.5));
        let grid = walls(&ends).grid;
        let borders: Vec<f64> = (1..9).map(|column| grid.left(column)).filter(|&x| x < 1.0).collect();
        assert!(borders.len() > 3, "a grid of several columns: {borders:?}");
        for (end, &border) in ends[2..].iter_mut().zip(&borders) {
            *end = upright(border);
        }
        let scene = walls(&ends);
        assert_eq!(scene.grid.left(1), borders[0], "equal bounds and lengths give the same grid");
        for &border in &borders {
            let just_below = border.next_down().max(border - 1e-12);
            for (x, direction) in [(border - 0.01, 1.0), (border + 0.01, -1.0), (just_below, 1.0), (just_below, -1.0)] {
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
    fn cast_agrees_with_the_test_of_every_wall() {
        // Linear congruential generator with values from 0 to 1.
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (count, offset, length) in
            [(3, 0.0, 2.0), (40, 5.0, 30.0), (200, -2e3, 0.5), (300, 1e6, 4.0), (9, 0.0, 1e5)]
        {
            let mut point = |size: f64| DVec2::new(offset + size * (unit() - 0.5), size * (unit() - 0.5));
            let mut ends: Vec<Segment> = Vec::new();
            for _ in 0..count {
                let a = ends.last().map_or_else(|| point(20.0), |last: &Segment| last.b);
                let b = a + point(length) - DVec2::new(offset, 0.0);
                ends.push(if ends.len() % 4 == 3 {
                    Segment::new(point(20.0), point(20.0))
                } else {
                    Segment::new(a, b)
                });
            }
            let scene = Walls::new(ends);
            for round in 0..4_000 {
                let origin = point([20.0, 60.0, 1e5][round % 3]);
                let target = if round % 5 == 0 { scene.segments[round % count].a } else { point(20.0) };
                let Some(direction) = (target - origin).try_normalize() else { continue };
                let range = if round % 2 == 0 { f64::INFINITY } else { 10.0 };
                let rounding_error = rounding_error(origin, &scene.bounds.unwrap());
                let ray = scene.ray(origin, direction, rounding_error, scene.bounds.unwrap());
                let mut nearest = Nearest::new(range);
                for (wall, segment) in (0..).map(WallId).zip(&scene.segments) {
                    nearest.offer(wall, ray.distance(segment), |_, _| true);
                }
                assert_eq!(scene.cast(origin, direction, range), nearest.hit(), "{origin} along {direction}");
            }
        }
    }

    #[test]
    fn invalid_rays_hit_nothing() {
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
    fn walls_with_invalid_coordinates_keep_their_numbers() {
        let scene = walls(&[[f64::NAN, 0.0, 1.0, 0.0], [0.0, f64::INFINITY, 1.0, 0.0], [1.0, -1.0, 1.0, 1.0]]);
        assert_eq!(scene.cast(DVec2::ZERO, DVec2::X, 2.0).unwrap().wall, WallId(2));
        assert_eq!(scene.bounds(), Some(Bounds { min: DVec2::new(1.0, -1.0), max: DVec2::ONE }));
        assert_eq!(scene.len(), 3);
    }

    #[test]
    fn a_query_visits_each_wall_once_and_in_order() {
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
