//! Lower bounds, by cell, of the distance to the nearest wall: a shorter ray cannot hit a wall.

use glam::DVec2;

use super::super::{
    Bounds, Segment,
    grid::{Grid, rounding_margin},
};
use super::for_each_cell;

/// Approximate number of cells of the grid, in addition to one cell per wall; a cell takes one byte.
const BASE_CELLS: f64 = 4096.0;

/// For each cell of a grid over the walls' bounds, the number of cells to the nearest cell with a wall.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    grid: Grid,
    /// Chebyshev distance of each cell from the nearest cell with a wall, at most 255. A ring of cells around the grid
    /// has the maximum value.
    distances: Vec<u8>,
    /// Maximum of all lower bounds, m.
    pub max_bound: f64,
}

impl Clearance {
    /// The clearance of `walls`, all within `bounds`.
    pub fn new<'a>(bounds: Bounds, walls: impl ExactSizeIterator<Item = &'a Segment>) -> Self {
        let size = bounds.max - bounds.min;
        let count = walls.len() as f64 + BASE_CELLS;
        let rounding = rounding_margin(&bounds);
        let cell_size = (size.x * size.y / count).sqrt().max((size.x + size.y) / count).max(1e6 * rounding).max(1e-9);
        // Exceeds every rounding error; `choose_grid` computes the margin of the walls by the same formula.
        let margin = (1e-6 * cell_size).max(rounding);
        let grid = Grid::new(bounds.grown(2.0 * margin), cell_size);
        let (columns, rows) = (grid.columns(), grid.rows());
        let width = columns + 2;
        let mut distances = vec![u8::MAX; width * (rows + 2)];
        for wall in walls {
            for_each_cell(&grid, margin, wall, |index| {
                distances[(index / columns + 1) * width + index % columns + 1] = 0
            });
        }
        // Two passes give the Chebyshev distance: each pass reads the neighbours that it has already processed.
        let mut relax = |index: usize, processed: [usize; 4]| {
            let nearest = processed.into_iter().fold(u8::MAX, |minimum, other| minimum.min(distances[other]));
            distances[index] = distances[index].min(nearest.saturating_add(1));
        };
        let indices = move || (1..=rows).flat_map(move |row| (1..=columns).map(move |column| row * width + column));
        indices().for_each(|index| relax(index, [index - 1, index - width - 1, index - width, index - width + 1]));
        indices()
            .rev()
            .for_each(|index| relax(index, [index + 1, index + width + 1, index + width, index + width - 1]));
        let max_distance = indices().map(|index| distances[index]).max().unwrap_or_default();
        let max_bound = bound(max_distance, &grid);
        Self { grid, distances, max_bound }
    }

    /// Lower bound of the distance from `point` to the nearest wall, m; 0 for a point outside the grid.
    #[inline]
    pub fn lower_bound(&self, point: DVec2) -> f64 {
        if !self.grid.bounds().contains(point) {
            return 0.0;
        }
        let (column, row) = (self.grid.column(point.x), self.grid.row(point.y));
        let distance = self.distances[(row + 1) * (self.grid.columns() + 2) + column + 1];
        bound(distance, &self.grid)
    }
}

/// Lower bound of the distance from a point in a cell to the nearest cell with a wall, which is `distance` cells away,
/// m.
fn bound(distance: u8, grid: &Grid) -> f64 {
    // All cells at a smaller Chebyshev distance are free of walls.
    f64::from(distance.saturating_sub(1)) * grid.cell()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_never_exceeds_the_distance_of_a_wall() {
        let ends = [[0.0, 0.0, 9.0, 0.0], [9.0, 0.0, 9.0, 7.0], [2.0, 5.0, 3.0, 6.0], [0.0, 7.0, 0.0, 7.0]];
        let walls = ends.map(|[ax, ay, bx, by]| Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by)));
        let bounds = walls.iter().fold(Bounds::EMPTY, |bounds, wall| bounds.union(wall.bounds()));
        let clearance = Clearance::new(bounds, walls.iter());
        let mut max_bound = 0.0_f64;
        for step in 0..10_000 {
            let point = DVec2::new(f64::from(step % 100) * 0.1 - 0.5, f64::from(step / 100) * 0.08 - 0.5);
            let nearest = walls.iter().map(|wall| wall.distance(point)).fold(f64::INFINITY, f64::min);
            let bound = clearance.lower_bound(point);
            assert!(bound <= nearest, "{bound} m at {point}, where a wall is {nearest} m away");
            max_bound = max_bound.max(bound);
        }
        assert!(max_bound > 2.0, "{max_bound} m: there is a point 3 m from all walls");
    }

    #[test]
    fn a_line_of_walls_needs_few_cells() {
        let wall = Segment::new(DVec2::ZERO, DVec2::new(1e6, 0.0));
        let clearance = Clearance::new(wall.bounds(), [wall].iter());
        assert!(clearance.distances.len() < 20_000, "{} cells", clearance.distances.len());
        assert_eq!(clearance.lower_bound(DVec2::new(5.0, 1.0)), 0.0, "outside the grid");
    }
}
