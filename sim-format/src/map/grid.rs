//! Occupancy grids, the walls around their free cells, and grids of worlds.

use std::collections::VecDeque;

use glam::DVec2;

use crate::spec::{DEFAULT_WALL_HEIGHT, WallSpec, WorldSpec};
use sim_core::pose::Pose;

/// Maximum number of cells of a grid: 8192 times 8192.
pub(crate) const MAX_CELLS: u64 = 1 << 26;

/// Maximum number of walls of a world made from a grid. Our choice: some 100 MB.
pub(crate) const MAX_WALLS: usize = 1_000_000;

/// Maximum distance, in sides of a cell, between a wall and the border of a cell on which the wall lies.
const BORDER_TOLERANCE: f64 = 1e-6;

/// State of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Free: robots can drive here.
    Free,
    /// Occupied by an obstacle.
    Occupied,
    /// Unknown: not observed.
    Unknown,
}

/// A grid of square cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// Side of the cells in metres.
    pub cell: f64,
    /// Pose of the lower left corner of the lower left cell, and of the grid's axes, in the frame of the file.
    pub origin: Pose,
    /// The cells, row by row, each from left to right, the lowest row first.
    pub cells: Vec<Cell>,
}

impl Grid {
    /// The cell in this column and row; `Unknown` outside of the grid.
    pub fn at(&self, column: usize, row: usize) -> Cell {
        let [columns, rows] = self.size;
        if column < columns && row < rows { self.cells[row * columns + column] } else { Cell::Unknown }
    }

    /// Number of cells of this kind.
    pub fn count(&self, kind: Cell) -> usize {
        self.cells.iter().filter(|cell| **cell == kind).count()
    }

    /// The world with walls around all free cells: robots cannot enter other cells, and the border is closed.
    ///
    /// Walls have thickness 0 and are as long as possible; free cells lie on the left of a wall, seen from its first
    /// end. The world has its origin at the lower left corner of the rectangle around the grid, whose axes may be
    /// turned. Also returns the position of the origin of the grid's frame in the world. `None` if there would be more
    /// than [`MAX_WALLS`] walls.
    pub(crate) fn world(&self, file: &str) -> Option<(WorldSpec, DVec2)> {
        let [columns, rows] = self.size.map(|side| side as f64 * self.cell);
        let rotation = Pose { position: DVec2::ZERO, heading: self.origin.heading };
        let is_rotated = rotation.heading.remainder() != 0.0;
        let corners = [DVec2::ZERO, DVec2::new(columns, 0.0), DVec2::new(0.0, rows), DVec2::new(columns, rows)];
        let [low, high] = if is_rotated {
            let corners = corners.map(|corner| rotation.transform_point(corner));
            let fold = |combine: fn(DVec2, DVec2) -> DVec2| corners.into_iter().reduce(combine).unwrap_or_default();
            [fold(DVec2::min), fold(DVec2::max)]
        } else {
            [DVec2::ZERO, corners[3]]
        };
        let offset = |column: usize, row: usize| {
            let point = DVec2::new(column as f64 * self.cell, row as f64 * self.cell);
            if is_rotated { rotation.transform_point(point) - low } else { point }
        };
        let mut walls = Vec::new();
        for (from, to) in self.outlines() {
            if walls.len() == MAX_WALLS {
                return None;
            }
            let [from, to] = [from, to].map(|[column, row]| offset(column, row));
            walls.push(WallSpec { from, to, height: DEFAULT_WALL_HEIGHT, ..WallSpec::default() });
        }
        let cell = (!is_rotated).then_some(self.cell);
        let world = WorldSpec { file: file.to_owned(), floor: high - low, cell, walls, ..WorldSpec::default() };
        Some((world, -low - self.origin.position))
    }

    /// Borders between free and other cells, each with its two ends as column and row of grid corners: vertical borders
    /// from left to right, then horizontal ones upwards.
    fn outlines(&self) -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
        let [columns, rows] = self.size;
        let is_free = move |column: usize, row: usize| self.at(column, row) == Cell::Free;
        let vertical = (0..=columns).flat_map(move |x| {
            runs(rows, move |y| free_side(x > 0 && is_free(x.wrapping_sub(1), y), is_free(x, y)))
                .map(move |(from, to)| ([x, from], [x, to]))
        });
        let horizontal = (0..=rows).flat_map(move |y| {
            runs(columns, move |x| free_side(is_free(x, y), y > 0 && is_free(x, y.wrapping_sub(1))))
                .map(move |(from, to)| ([from, y], [to, y]))
        });
        vertical.chain(horizontal)
    }

    /// The grid of a world, with cells of side `cell`. It covers the floor, and one row or column more where walls are
    /// on the edge of the floor.
    ///
    /// A cell is occupied where a wall passes through it. A wall without thickness between two cells fills the cell
    /// that cannot be reached; if both can be reached, the cell on its right, seen from its first end; if none can, no
    /// cell. The cells that can be reached from the world's starts are free; without starts, all unoccupied cells are
    /// free. The rest is unknown. `None` if there are too many cells.
    pub fn of_world(world: &WorldSpec, cell: f64) -> Option<Self> {
        let mut raster = Raster::new(world, cell)?;
        world.walls.iter().for_each(|wall| raster.draw_wall(wall));
        let starts: Vec<DVec2> = world.starts.iter().map(|start| start.pose.position).collect();
        Some(raster.into_grid(&starts))
    }
}

/// Free side of a border: true for the left side, false for the right one; `None` if both sides are free or none is.
fn free_side(left: bool, right: bool) -> Option<bool> {
    (left != right).then_some(left)
}

/// Maximal runs of equal sides among `count` borders in a line: first and last corner, such that the free side is on
/// the left.
fn runs(count: usize, free_side: impl Fn(usize) -> Option<bool>) -> impl Iterator<Item = (usize, usize)> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let (first, is_left) = (next..count).find_map(|index| Some((index, free_side(index)?)))?;
        next = (first..count).find(|index| free_side(*index) != Some(is_left)).unwrap_or(count);
        Some(if is_left { (first, next) } else { (next, first) })
    })
}

/// A border between two cells that a wall closes.
#[derive(Clone, Copy)]
struct Border {
    /// The cells on the left and the right of the wall.
    cells: [usize; 2],
}

/// A grid on which walls are drawn, with a margin of one cell.
struct Raster {
    /// Columns and rows, with the margin.
    size: [usize; 2],
    cell: f64,
    is_filled: Vec<bool>,
    /// True if a wall closes the border to the right neighbour; `above`: to the neighbour above.
    right: Vec<bool>,
    above: Vec<bool>,
    borders: Vec<Border>,
}

impl Raster {
    fn new(world: &WorldSpec, cell: f64) -> Option<Self> {
        let sides = (world.floor / cell - BORDER_TOLERANCE).ceil().max(DVec2::ONE) + 2.0;
        let count = sides.x * sides.y;
        if count.is_nan() || count > MAX_CELLS as f64 {
            return None;
        }
        let size = [sides.x as usize, sides.y as usize];
        let none = vec![false; size[0] * size[1]];
        Some(Self { size, cell, is_filled: none.clone(), right: none.clone(), above: none, borders: Vec::new() })
    }

    fn draw_wall(&mut self, wall: &WallSpec) {
        // Ends of the wall in sides of a cell, from the corner of the margin.
        let [from, to] = [wall.from, wall.to].map(|end| end / self.cell + 1.0);
        let thickness = wall.thickness / self.cell;
        let is_on_border =
            |a: f64, b: f64| (a - a.round()).abs() < BORDER_TOLERANCE && (a - b).abs() < BORDER_TOLERANCE;
        if thickness < BORDER_TOLERANCE && is_on_border(from.x, to.x) {
            return self.draw_vertical(from.x.round(), from.y, to.y);
        }
        if thickness < BORDER_TOLERANCE && is_on_border(from.y, to.y) {
            return self.draw_horizontal(from.y.round(), from.x, to.x);
        }
        let direction = (to - from).normalize_or_zero();
        let half_width = direction.perp() * (0.5 * thickness);
        self.fill_polygon(&[from + half_width, to + half_width, to - half_width, from - half_width]);
    }

    /// Indices of the cells in a row or column that an interval overlaps by more than an end point.
    fn covered_cells(from: f64, to: f64, count: usize) -> std::ops::Range<usize> {
        let (low, high) = (from.min(to) + BORDER_TOLERANCE, from.max(to) - BORDER_TOLERANCE);
        let middle = 0.5 * (from + to);
        let (low, high) = if low <= high { (low, high) } else { (middle, middle) };
        let first = low.floor().clamp(0.0, count as f64) as usize;
        first..((high.floor() + 1.0).clamp(0.0, count as f64) as usize).max(first)
    }

    /// Adds a wall along the border to the left of the column `x`.
    fn draw_vertical(&mut self, x: f64, from: f64, to: f64) {
        let [columns, rows] = self.size;
        if !(1.0..columns as f64).contains(&x) {
            return;
        }
        for row in Self::covered_cells(from, to, rows) {
            let (left, right) = (row * columns + x as usize - 1, row * columns + x as usize);
            self.right[left] = true;
            self.borders.push(Border { cells: if to > from { [left, right] } else { [right, left] } });
        }
    }

    /// Adds a wall along the border below the row `y`.
    fn draw_horizontal(&mut self, y: f64, from: f64, to: f64) {
        let [columns, rows] = self.size;
        if !(1.0..rows as f64).contains(&y) {
            return;
        }
        for column in Self::covered_cells(from, to, columns) {
            let (below, above) = ((y as usize - 1) * columns + column, y as usize * columns + column);
            self.above[below] = true;
            self.borders.push(Border { cells: if to > from { [above, below] } else { [below, above] } });
        }
    }

    /// Fills the cells whose interior a convex polygon overlaps.
    fn fill_polygon(&mut self, corners: &[DVec2; 4]) {
        let [columns, rows] = self.size;
        let (low, high) = corners
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| (low.min(corner.y), high.max(corner.y)));
        for row in Self::covered_cells(low, high, rows) {
            let (bottom, top) = ((row as f64).max(low), (row as f64 + 1.0).min(high));
            let mut x_range = (f64::INFINITY, f64::NEG_INFINITY);
            for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                // The part of the edge within the row.
                let fraction_at =
                    |y: f64| if from.y == to.y { 0.0 } else { ((y - from.y) / (to.y - from.y)).clamp(0.0, 1.0) };
                let ends = if from.y == to.y { [0.0, 1.0] } else { [fraction_at(bottom), fraction_at(top)] };
                for point in ends.map(|fraction| from.lerp(*to, fraction)) {
                    if point.y >= bottom - BORDER_TOLERANCE && point.y <= top + BORDER_TOLERANCE {
                        x_range = (x_range.0.min(point.x), x_range.1.max(point.x));
                    }
                }
            }
            if x_range.0 <= x_range.1 {
                for column in Self::covered_cells(x_range.0, x_range.1, columns) {
                    self.is_filled[row * columns + column] = true;
                }
            }
        }
    }

    /// Cells that can be reached from the cells in `queue` without passing walls.
    fn reachable_cells(&self, mut queue: VecDeque<usize>) -> Vec<bool> {
        let [columns, rows] = self.size;
        let mut is_reached = vec![false; columns * rows];
        queue.retain(|cell| !self.is_filled[*cell] && !std::mem::replace(&mut is_reached[*cell], true));
        while let Some(cell) = queue.pop_front() {
            let (column, row) = (cell % columns, cell / columns);
            let neighbours = [
                (column + 1 < columns && !self.right[cell]).then(|| cell + 1),
                (column > 0 && !self.right[cell.wrapping_sub(1)]).then(|| cell.wrapping_sub(1)),
                (row + 1 < rows && !self.above[cell]).then(|| cell + columns),
                (row > 0 && !self.above[cell.wrapping_sub(columns)]).then(|| cell.wrapping_sub(columns)),
            ];
            for next in neighbours.into_iter().flatten() {
                let is_margin = self.is_margin(next);
                if !is_margin && !self.is_filled[next] && !std::mem::replace(&mut is_reached[next], true) {
                    queue.push_back(next);
                }
            }
        }
        is_reached
    }

    fn is_margin(&self, cell: usize) -> bool {
        let [columns, rows] = self.size;
        let (column, row) = (cell % columns, cell / columns);
        column == 0 || row == 0 || column + 1 == columns || row + 1 == rows
    }

    fn into_grid(mut self, starts: &[DVec2]) -> Grid {
        let [columns, rows] = self.size;
        let cell_of = |point: DVec2| {
            let [column, row] = (point / self.cell + 1.0).to_array().map(|side| side.floor().max(0.0) as usize);
            (column < columns && row < rows).then(|| row * columns + column)
        };
        let seeds: VecDeque<usize> = starts.iter().filter_map(|start| cell_of(*start)).collect();
        let has_seeds = seeds.iter().any(|seed| !self.is_filled[*seed]);
        let is_reached = if has_seeds {
            self.reachable_cells(seeds)
        } else {
            (0..columns * rows).map(|cell| !self.is_filled[cell] && !self.is_margin(cell)).collect()
        };
        for Border { cells: [left, right] } in std::mem::take(&mut self.borders) {
            match (is_reached[left], is_reached[right]) {
                (true, _) => self.is_filled[right] = true,
                (false, true) => self.is_filled[left] = true,
                (false, false) => {}
            }
        }
        let kind = |cell: usize| match (self.is_filled[cell], is_reached[cell]) {
            (true, _) => Cell::Occupied,
            (false, true) => Cell::Free,
            (false, false) => Cell::Unknown,
        };
        // A side of the margin is part of the grid if it contains an obstacle.
        let contains_obstacle = |mut cells: Box<dyn Iterator<Item = usize>>| cells.any(|cell| self.is_filled[cell]);
        let left = contains_obstacle(Box::new((0..rows).map(|row| row * columns)));
        let below = contains_obstacle(Box::new(0..columns));
        let right = contains_obstacle(Box::new((0..rows).map(|row| row * columns + columns - 1)));
        let above = contains_obstacle(Box::new((rows - 1) * columns..rows * columns));
        let range = |low: bool, high: bool, count: usize| usize::from(!low)..count - usize::from(!high);
        let (column_range, row_range) = (range(left, right, columns), range(below, above, rows));
        let size = [column_range.len(), row_range.len()];
        let corner = DVec2::new(column_range.start as f64 - 1.0, row_range.start as f64 - 1.0) * self.cell;
        let cells = row_range
            .flat_map(|row| column_range.clone().map(move |column| row * columns + column))
            .map(kind)
            .collect();
        Grid { size, cell: self.cell, origin: Pose::new(corner.x, corner.y, 0.0), cells }
    }
}
