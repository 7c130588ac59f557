//! Lower bounds, by cell, of the distance to the nearest wall: a shorter ray cannot hit a wall.

use glam::DVec2;

use super::super::{
    Bounds, Segment,
    grid::{Grid, rounding_margin},
};
use super::for_each_cell;

/// Number of cells in addition to the number of walls; one byte each.
const CELLS: f64 = 4096.0;

/// For each cell of a grid over the walls' bounds, the number of cells to the nearest cell with a wall.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    grid: Grid,
    /// Chebyshev distance, at most 255; 0 for a cell with a wall. A ring of cells around the grid has the maximum value.
    cells: Vec<u8>,
}

impl Clearance {
    /// The clearance of `walls`, all within `bounds`.
    pub fn new<'a>(bounds: Bounds, walls: impl ExactSizeIterator<Item = &'a Segment>) -> Self {
        let size = bounds.max - bounds.min;
        let count = walls.len() as f64 + CELLS;
        let rounding = rounding_margin(&bounds);
        let cell = (size.x * size.y / count).sqrt().max((size.x + size.y) / count).max(1e6 * rounding).max(1e-9);
        // Larger than all rounding, as for the cells of rays.
        let margin = (1e-6 * cell).max(rounding);
        let grid = Grid::new(bounds.grown(2.0 * margin), cell);
        let (columns, rows) = (grid.columns(), grid.rows());
        let width = columns + 2;
        let mut cells = vec![u8::MAX; width * (rows + 2)];
        for wall in walls {
            for_each_cell(&grid, margin, wall, |cell| cells[(cell / columns + 1) * width + cell % columns + 1] = 0);
        }
        // Two passes give the Chebyshev distance: each pass reads the neighbours that it has already processed.
        let mut approach = |cell: usize, passed: [usize; 4]| {
            let nearest = passed.into_iter().fold(u8::MAX, |least, other| least.min(cells[other]));
            cells[cell] = cells[cell].min(nearest.saturating_add(1));
        };
        let places = move || (1..=rows).flat_map(move |row| (1..=columns).map(move |column| row * width + column));
        places().for_each(|cell| approach(cell, [cell - 1, cell - width - 1, cell - width, cell - width + 1]));
        places().rev().for_each(|cell| approach(cell, [cell + 1, cell + width + 1, cell + width, cell + width - 1]));
        Self { grid, cells }
    }

    /// Lower bound of the distance from `point` to the nearest wall, m; 0 for a point outside the cells.
    #[inline]
    pub fn at(&self, point: DVec2) -> f64 {
        if !self.grid.bounds().contains(point) {
            return 0.0;
        }
        // All cells at fewer steps are empty.
        let (column, row) = (self.grid.column(point.x), self.grid.row(point.y));
        let steps = self.cells[(row + 1) * (self.grid.columns() + 2) + column + 1];
        f64::from(steps.saturating_sub(1)) * self.grid.cell()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_wall_is_nearer_than_the_bound_says() {
        let ends = [[0.0, 0.0, 9.0, 0.0], [9.0, 0.0, 9.0, 7.0], [2.0, 5.0, 3.0, 6.0], [0.0, 7.0, 0.0, 7.0]];
        let walls = ends.map(|[ax, ay, bx, by]| Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by)));
        let bounds = walls.iter().fold(Bounds::EMPTY, |all, wall| all.union(wall.bounds()));
        let clearance = Clearance::new(bounds, walls.iter());
        let mut greatest = 0.0_f64;
        for step in 0..10_000 {
            let point = DVec2::new(f64::from(step % 100) * 0.1 - 0.5, f64::from(step / 100) * 0.08 - 0.5);
            let nearest = walls.iter().map(|wall| wall.distance(point)).fold(f64::INFINITY, f64::min);
            let bound = clearance.at(point);
            assert!(bound <= nearest, "{bound} m at {point}, where a wall is {nearest} m away");
            greatest = greatest.max(bound);
        }
        assert!(greatest > 2.0, "{greatest} m: there is a place 3 m from all walls");
    }

    #[test]
    fn a_line_of_walls_needs_few_cells() {
        let wall = Segment::new(DVec2::ZERO, DVec2::new(1e6, 0.0));
        let clearance = Clearance::new(wall.bounds(), [wall].iter());
        assert!(clearance.cells.len() < 20_000, "{} cells", clearance.cells.len());
        assert_eq!(clearance.at(DVec2::new(5.0, 1.0)), 0.0, "outside");
    }
}
