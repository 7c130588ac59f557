//! Broad-phase index over bodies: finds the bodies that a ray may meet or that may overlap a rectangle.

use std::ops::ControlFlow;

use glam::DVec2;

use super::Bounds;
use super::grid::{Cells, Grid, MAX_COORDINATE, is_ray, rounding_error, rounding_margin};
use super::nearby::{Nearby, Rectangle};

/// Maximum number of bodies that [`BoundsIndex::add_to`] tests. One large body enlarges the area of the search, which
/// may then contain the centres of many small bodies. Our choice.
const MAX_SCANNED: usize = 256;

/// Maximum extent of an index, m, for [`BoundsIndex::add_to`]; far below the largest `f32`. Our choice.
const MAX_EXTENT: f64 = 1e30;

/// A uniform grid over the bounds of bodies, such as moving bodies during a slot.
///
/// [`BoundsIndex::rebuild`] reuses the memory of the index. Time and memory are proportional to the number of bodies,
/// independent of their size. It contains only keys and bounds; the caller tests the bodies themselves.
#[derive(Clone, Debug)]
pub struct BoundsIndex<K> {
    /// Bodies in ascending order of their keys.
    bodies: Vec<(K, Bounds)>,
    /// `None` without bodies.
    grid: Option<Grid>,
    /// Margin by which bodies are enlarged on insertion into cells; larger than all rounding of rays and cells.
    margin: f64,
    /// Indices into `bodies` of the bodies that overlap each cell.
    cells: Cells<u32>,
    /// Bodies with their centre in each cell, with their rectangles relative to the grid's lower left corner.
    middles: Cells<(K, Rectangle)>,
    /// Half of the size of the largest rectangle on each axis, m.
    max_half: DVec2,
}

impl<K> Default for BoundsIndex<K> {
    fn default() -> Self {
        Self {
            bodies: Vec::new(),
            grid: None,
            margin: 0.0,
            cells: Cells::default(),
            middles: Cells::default(),
            max_half: DVec2::ZERO,
        }
    }
}

impl<K: Copy + Ord> BoundsIndex<K> {
    /// Replaces all bodies with `bodies`: unique keys and bounds.
    ///
    /// Bounds that are empty or have a NaN coordinate are never found; infinite bounds are clamped to
    /// 10^100 m.
    ///
    /// # Panics
    /// If there are 2^32 bodies or more.
    pub fn rebuild(&mut self, bodies: &[(K, Bounds)]) {
        let limits = Bounds { min: DVec2::splat(-MAX_COORDINATE), max: DVec2::splat(MAX_COORDINATE) };
        self.bodies.clear();
        self.bodies.extend(
            bodies
                .iter()
                .filter(|(_, bounds)| bounds.overlaps(&limits) && bounds.min.cmple(bounds.max).all())
                .map(|&(id, Bounds { min, max })| (id, Bounds { min: min.max(limits.min), max: max.min(limits.max) })),
        );
        if !self.bodies.is_sorted_by_key(|body| body.0) {
            self.bodies.sort_unstable_by_key(|body| body.0);
        }
        self.choose_grid();
        let Some(grid) = &self.grid else { return };
        let all_bodies = &self.bodies;
        let indices = 0..u32::try_from(all_bodies.len()).expect("a scene has fewer than 2^32 bodies");
        self.cells.fill(grid.len(), indices, |index, visit| {
            let (columns, rows) = grid.span(&all_bodies[index as usize].1.grown(self.margin));
            for row in rows {
                for column in columns.clone() {
                    visit(grid.index(column, row));
                }
            }
        });
        self.max_half = all_bodies.iter().fold(DVec2::ZERO, |half, (_, it)| half.max(0.5 * (it.max - it.min)));
        let origin = grid.bounds().min;
        let rectangles = all_bodies.iter().map(|(key, bounds)| (*key, Rectangle::new(bounds, origin)));
        self.middles.fill(grid.len(), rectangles, |(_, rectangle), visit| {
            let middle = rectangle.middle.as_dvec2() + origin;
            visit(grid.index(grid.column(middle.x), grid.row(middle.y)));
        });
    }

    /// Number of bodies that can be found.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Returns true if no body can be found.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Visits each body whose rectangle a ray meets within `range` metres, once and approximately in the order along
    /// the ray. `direction` is a unit vector. `visit` returns the distance up to which the search must continue.
    ///
    /// Bodies whose rectangle the ray misses by less than the rectangle's size may be visited too. An invalid ray (see
    /// [`Walls::cast`](super::Walls::cast)) visits nothing.
    pub fn along_ray(&self, origin: DVec2, direction: DVec2, range: f64, mut visit: impl FnMut(K) -> f64) {
        let Some(grid) = &self.grid else { return };
        if !is_ray(origin, direction, range) {
            return;
        }
        let is_near = grid.bounds().contains(origin) || 2.0 * rounding_error(origin, grid.bounds()) < self.margin;
        if is_near {
            let (forward, lateral) = (direction.abs(), direction.perp().abs());
            let slack = 2.0 * self.margin;
            let mut limit = range;
            grid.walk(origin, direction, range, |visited| {
                for &index in self.cells.entries(visited.cell) {
                    let (id, bounds) = &self.bodies[index as usize];
                    // Most bodies of a cell lie beside the ray's line; this test detects them without a division.
                    let (middle, half) = (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min));
                    let offset = middle - origin;
                    let (ahead, reach) = (offset.dot(direction), half.dot(forward) + slack);
                    let is_hit = (direction.perp_dot(offset).abs() <= half.dot(lateral) + slack)
                        & (ahead >= -reach)
                        & (ahead - reach <= limit);
                    if is_hit && visited.is_first_of(&bounds.grown(self.margin)) {
                        limit = limit.min(visit(*id));
                    }
                }
                if visited.exit > limit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
        } else {
            let entry_of =
                |bounds: &Bounds| bounds.grown(2.0 * rounding_error(origin, bounds)).clip(origin, direction, range);
            if entry_of(grid.bounds()).is_some() {
                for (id, bounds) in &self.bodies {
                    if entry_of(bounds).is_some() {
                        visit(*id);
                    }
                }
            }
        }
    }

    /// Adds the bodies that a ray in the circle of `nearby` may meet. Returns false, with an incomplete list, if the
    /// bodies near the circle are too many, or the index is too large for single precision.
    pub fn add_to(&self, nearby: &mut Nearby<K>) -> bool {
        let Some(grid) = &self.grid else { return true };
        let (square, margin) = (nearby.square(), 2.0 * self.margin);
        let is_near = |corner| 2.0 * rounding_error(corner, grid.bounds()) < self.margin;
        let is_narrow = (grid.bounds().max - grid.bounds().min).max_element() < MAX_EXTENT;
        if !is_near(square.min) || !is_near(square.max) || !is_narrow {
            return false;
        }
        let slack = nearby.set_slack(grid.bounds(), margin);
        let reach = self.max_half + DVec2::splat(slack);
        let (columns, rows) = grid.span(&Bounds { min: square.min - reach, max: square.max + reach });
        let mut add = nearby.adder(grid.bounds().min);
        let mut scanned = 0;
        for row in rows {
            let [first, last] = [columns.start(), columns.end()].map(|column| grid.index(*column, row));
            let entries = self.middles.entries_between(first, last);
            scanned += entries.len();
            if scanned > MAX_SCANNED {
                return false;
            }
            for (key, rectangle) in entries {
                if !add(*key, rectangle) {
                    return false;
                }
            }
        }
        true
    }

    /// Visits each body whose rectangle overlaps `bounds` once, in ascending order of the keys.
    pub fn for_each_in(&self, bounds: Bounds, mut visit: impl FnMut(K)) {
        let mut indices = Vec::new();
        self.overlapping(&bounds, &mut indices);
        for index in indices {
            visit(self.bodies[index as usize].0);
        }
    }

    /// Visits each body whose rectangle overlaps `bounds` once, in no particular order, without building a list.
    pub fn visit_in(&self, bounds: &Bounds, mut visit: impl FnMut(K)) {
        let Some(grid) = &self.grid else { return };
        if !grid.bounds().overlaps(bounds) {
            return;
        }
        let (columns, rows) = grid.span(bounds);
        for row in rows {
            for column in columns.clone() {
                for &index in self.cells.entries(grid.index(column, row)) {
                    let (key, rectangle) = &self.bodies[index as usize];
                    // A body is visited only in the cell with the lower left corner of the intersection.
                    let is_corner_cell = || {
                        let corner = bounds.min.max(rectangle.min);
                        grid.column(corner.x) == column && grid.row(corner.y) == row
                    };
                    if rectangle.overlaps(bounds) && is_corner_cell() {
                        visit(*key);
                    }
                }
            }
        }
    }

    /// Fills `indices` with the indices of the bodies whose rectangles overlap `bounds`, in ascending order.
    fn overlapping(&self, bounds: &Bounds, indices: &mut Vec<u32>) {
        indices.clear();
        let Some(grid) = &self.grid else { return };
        if !grid.bounds().overlaps(bounds) {
            return;
        }
        let (columns, rows) = grid.span(bounds);
        for row in rows {
            let in_row = self.cells.entries_between(grid.index(*columns.start(), row), grid.index(*columns.end(), row));
            let overlaps = |index: u32| self.bodies[index as usize].1.overlaps(bounds);
            indices.extend(in_row.iter().filter(|&&index| overlaps(index)));
        }
        indices.sort_unstable();
        indices.dedup();
    }

    /// Chooses the grid so that an average body overlaps a few cells and there are at most a few cells per body.
    fn choose_grid(&mut self) {
        self.grid = None;
        if self.bodies.is_empty() {
            return;
        }
        let count = self.bodies.len() as f64;
        let extent = self.bodies.iter().fold(Bounds::EMPTY, |extent, (_, bounds)| extent.union(*bounds));
        let (mut sides, mut areas) = (0.0, 0.0);
        for (_, bounds) in &self.bodies {
            let size = bounds.max - bounds.min;
            sides += 0.5 * (size.x + size.y);
            areas += size.x * size.y;
        }
        let size = extent.max - extent.min;
        let rounding = rounding_margin(&extent);
        let cell = (sides / count)
            .max((areas / count).sqrt())
            .max((0.5 * size.x * size.y / count).sqrt())
            .max((size.x + size.y) / (8.0 * count + 64.0))
            .max(1e6 * rounding)
            .max(1e-9);
        self.margin = (1e-6 * cell).max(rounding);
        self.grid = Some(Grid::new(extent.grown(2.0 * self.margin), cell));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(discs: &[(u32, f64, f64, f64)]) -> BoundsIndex<u32> {
        let list: Vec<_> =
            discs.iter().map(|&(id, x, y, radius)| (id, Bounds::of_disc(DVec2::new(x, y), radius))).collect();
        let mut index = BoundsIndex::default();
        index.rebuild(&list);
        index
    }

    fn visited_along(index: &BoundsIndex<u32>, origin: DVec2, direction: DVec2, range: f64) -> Vec<u32> {
        let mut ids = Vec::new();
        index.along_ray(origin, direction, range, |id| {
            ids.push(id);
            range
        });
        ids
    }

    fn pairs(index: &BoundsIndex<u32>) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for (key, bounds) in &index.bodies {
            index.visit_in(bounds, |other| pairs.extend((other > *key).then_some((*key, other))));
        }
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn a_ray_finds_each_body_on_its_path_once() {
        let index = bodies(&[(1, 0.0, 0.0, 0.5), (2, 5.0, 0.2, 0.5), (3, 3.0, 3.0, 0.5), (4, 2.0, -0.4, 0.5)]);
        assert_eq!(visited_along(&index, DVec2::ZERO, DVec2::X, f64::INFINITY), [1, 4, 2]);
        assert_eq!(visited_along(&index, DVec2::ZERO, DVec2::X, 1.4), [1]);
        assert_eq!(visited_along(&index, DVec2::new(-1e9, 0.0), DVec2::X, f64::INFINITY), [1, 2, 4]);
        assert_eq!(visited_along(&index, DVec2::new(-9.0, 0.0), DVec2::NEG_X, f64::INFINITY), [0; 0]);
        assert_eq!(visited_along(&index, DVec2::ZERO, DVec2::NAN, 2.0), [0; 0]);
    }

    #[test]
    fn a_ray_misses_no_body_on_its_path() {
        // Linear congruential generator with values from 0 to 1.
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (count, size) in [(2, 0.3), (30, 0.1), (30, 2.0), (300, 0.2)] {
            let discs: Vec<_> = (0..count).map(|id| (id, 10.0 * unit(), 10.0 * unit(), size * unit())).collect();
            let index = bodies(&discs);
            for _ in 0..500 {
                let origin = DVec2::new(12.0 * unit() - 1.0, 12.0 * unit() - 1.0);
                let (sin, cos) = crate::math::sin_cos(7.0 * unit());
                let (direction, range) = (DVec2::new(cos, sin), 8.0 * unit());
                let mut visited = visited_along(&index, origin, direction, range);
                let found = visited.len();
                visited.sort_unstable();
                visited.dedup();
                assert_eq!(visited.len(), found, "each body is visited once");
                for &(id, x, y, radius) in &discs {
                    let is_hit = Bounds::of_disc(DVec2::new(x, y), radius).clip(origin, direction, range).is_some();
                    assert!(!is_hit || visited.contains(&id), "{id} from {origin} along {direction} up to {range} m");
                }
                let mut is_any_visited = false;
                index.along_ray(origin, direction, range, |_| {
                    is_any_visited = true;
                    0.0
                });
                assert_eq!(is_any_visited, !visited.is_empty(), "a nearer limit leaves at least the first");
            }
        }
    }

    #[test]
    fn each_pair_is_found_once() {
        let index = bodies(&[(3, 1.0, 0.0, 0.5), (1, 0.0, 0.0, 0.5), (2, 0.5, 0.5, 0.1), (9, 7.0, 7.0, 0.1)]);
        assert_eq!(pairs(&index), [(1, 2), (1, 3), (2, 3)], "bodies that touch are a pair");
    }

    #[test]
    fn infinite_bodies_are_found_and_bodies_with_nan_bounds_are_not() {
        let everywhere = Bounds { min: DVec2::NEG_INFINITY, max: DVec2::INFINITY };
        let undefined = Bounds { min: DVec2::NAN, max: DVec2::NAN };
        let mut index = BoundsIndex::default();
        index.rebuild(&[(1, Bounds::of_disc(DVec2::ONE, 0.1)), (2, everywhere), (3, undefined), (4, Bounds::EMPTY)]);
        assert_eq!(pairs(&index), [(1, 2)]);
        // The rounding of a rectangle of 10^100 m is wider than the other bodies, which may be visited too.
        assert!(visited_along(&index, DVec2::ZERO, DVec2::NEG_Y, 1.0).contains(&2));
        index.rebuild(&[]);
        assert_eq!(pairs(&index), []);
        assert_eq!(visited_along(&index, DVec2::ZERO, DVec2::NEG_Y, 1.0), [0; 0]);
    }
}
