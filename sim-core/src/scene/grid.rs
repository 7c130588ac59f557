//! A uniform grid of square cells: the cell of a point, and the cells along a ray.

use std::ops::{ControlFlow, RangeInclusive};

use glam::DVec2;

use super::bounds::{Bounds, PARALLEL};

/// Limit of coordinates, in metres; larger ones would overflow in products.
pub(super) const MAX_COORDINATE: f64 = 1e100;

/// Returns true if products with the point's coordinates stay finite; false for NaN.
#[inline]
pub(super) fn is_usable(point: DVec2) -> bool {
    point.abs().cmple(DVec2::splat(MAX_COORDINATE)).all()
}

/// Returns true if the arguments describe a valid ray: the origin's coordinates are at most [`MAX_COORDINATE`], the
/// range is not negative, and the direction has length 1 within 10^-6.
#[inline]
pub(super) fn is_ray(origin: DVec2, direction: DVec2, range: f64) -> bool {
    // Comparisons with NaN are false.
    (direction.length_squared() - 1.0).abs() < 1e-6 && is_usable(origin) && range >= 0.0
}

/// Relative rounding error, as a multiple of a coordinate, by which a ray may miss a point that it touches in exact
/// arithmetic. The ray's origin and direction, the point, and the products of the test each contribute one or two units
/// in the last place.
pub(super) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Upper bound of the distance by which rounding makes a ray from `origin` miss a point inside `bounds`.
#[inline]
pub(super) fn rounding_error(origin: DVec2, bounds: &Bounds) -> f64 {
    let reach = (bounds.min - origin).abs().max((bounds.max - origin).abs());
    ROUNDING * (origin.abs().element_sum() + reach.element_sum())
}

/// A margin larger than twice the [`rounding_error`] of every ray that starts inside `bounds`, and larger than the
/// rounding of the ray's cells.
pub(super) fn rounding_margin(bounds: &Bounds) -> f64 {
    16.0 * ROUNDING * bounds.min.abs().max(bounds.max.abs()).max_element()
}

/// Square cells over a rectangle, numbered row by row from the lower left.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    /// Area covered by the cells; points outside belong to the outermost cells.
    bounds: Bounds,
    cell: f64,
    cells_per_metre: f64,
    columns: usize,
    rows: usize,
}

impl Grid {
    /// Cells of `cell` metres, which must be positive, over finite `bounds`.
    pub fn new(bounds: Bounds, cell: f64) -> Self {
        let size = bounds.max - bounds.min;
        let count = |extent: f64| (extent / cell) as usize + 1;
        Self { bounds, cell, cells_per_metre: 1.0 / cell, columns: count(size.x), rows: count(size.y) }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Area covered by the cells.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Side of a cell, m.
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    #[inline]
    pub fn column(&self, x: f64) -> usize {
        // `as` saturates, and maps NaN to 0; a conversion to 32 bits takes half as many instructions as one to 64 bits.
        (((x - self.bounds.min.x) * self.cells_per_metre) as u32 as usize).min(self.columns - 1)
    }

    #[inline]
    pub fn row(&self, y: f64) -> usize {
        (((y - self.bounds.min.y) * self.cells_per_metre) as u32 as usize).min(self.rows - 1)
    }

    #[inline]
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    /// Left border of a column.
    pub fn left(&self, column: usize) -> f64 {
        self.bounds.min.x + column as f64 * self.cell
    }

    /// Lower border of a row.
    pub fn lower(&self, row: usize) -> f64 {
        self.bounds.min.y + row as f64 * self.cell
    }

    /// Columns and rows that overlap `area`.
    pub fn span(&self, area: &Bounds) -> (RangeInclusive<usize>, RangeInclusive<usize>) {
        (self.column(area.min.x)..=self.column(area.max.x), self.row(area.min.y)..=self.row(area.max.y))
    }

    /// Visits the cells along a ray in order, up to `range` metres or until `visit` breaks. `direction` has length 1;
    /// all arguments except `range` are finite.
    ///
    /// Distances to the cell borders are not summed but recomputed at each step. So every visited cell is at most a
    /// few units in the last place of the ray's coordinates away from the ray, for any number of cells.
    #[inline]
    pub fn walk(
        &self,
        origin: DVec2,
        direction: DVec2,
        range: f64,
        mut visit: impl FnMut(&CellVisit<'_>) -> ControlFlow<()>,
    ) {
        let (entry, far) = if self.bounds.contains(origin) {
            (origin, range)
        } else {
            let Some((near, far)) = self.bounds.clip(origin, direction, range) else { return };
            (origin + direction * near, far)
        };
        let (column, row) = (self.column(entry.x), self.row(entry.y));
        let mut x_axis = Axis::new(origin.x, direction.x, self.bounds.min.x, self.cell, [column, self.columns], 1);
        let mut y_axis = Axis::new(origin.y, direction.y, self.bounds.min.y, self.cell, [row, self.rows], self.columns);
        let mut cell_visit = CellVisit { grid: self, cell: self.index(column, row), exit: 0.0, entered: None };
        let (mut x_exit, mut y_exit) = (x_axis.exit(), y_axis.exit());
        loop {
            // Not `min`, which needs extra code for NaN.
            cell_visit.exit = if x_exit < y_exit { x_exit } else { y_exit };
            if visit(&cell_visit).is_break() || cell_visit.exit > far {
                return;
            }
            let is_outside = if x_exit < y_exit {
                let is_outside = x_axis.advance(&mut cell_visit.cell);
                x_exit = x_axis.exit();
                cell_visit.entered = Some((0, x_axis.index, x_axis.step > 0.0));
                is_outside
            } else {
                let is_outside = y_axis.advance(&mut cell_visit.cell);
                y_exit = y_axis.exit();
                cell_visit.entered = Some((1, y_axis.index, y_axis.step > 0.0));
                is_outside
            };
            if is_outside {
                return;
            }
        }
    }
}

/// A cell on the path of a ray.
pub(super) struct CellVisit<'a> {
    grid: &'a Grid,
    /// Index of the cell.
    pub cell: usize,
    /// Distance at which the ray leaves the cell.
    pub exit: f64,
    /// Axis along which the ray has entered the cell, the cell's index on that axis, and true if the ray runs in the
    /// positive direction of the axis. `None` for the ray's first cell.
    entered: Option<(usize, f64, bool)>,
}

impl CellVisit<'_> {
    /// Returns true if this is the ray's first cell among the cells that `area` [spans](Grid::span): a ray enters the
    /// cells of an area once. `area` must overlap this cell.
    #[inline]
    pub fn is_first_of(&self, area: &Bounds) -> bool {
        let Some((axis, index, is_positive)) = self.entered else { return true };
        // The computation of `Grid::column` and `Grid::row`.
        let cell_coordinate = |corner: DVec2| (corner[axis] - self.grid.bounds.min[axis]) * self.grid.cells_per_metre;
        if is_positive { cell_coordinate(area.min) >= index } else { cell_coordinate(area.max) < index + 1.0 }
    }
}

/// Crossings of a ray with the cell borders of one axis.
struct Axis {
    /// Distance at which the ray leaves column or row 0: at its upper border, or at its lower border if the ray runs in
    /// the negative direction of the axis.
    first_exit: f64,
    /// Distance along the ray between successive borders; negative for the negative direction.
    border_spacing: f64,
    /// Current column or row, a whole number.
    index: f64,
    /// Change of `index` from cell to cell.
    step: f64,
    /// Number of columns or rows.
    count: f64,
    /// Change of the cell's index from cell to cell, wrapping.
    stride: usize,
}

impl Axis {
    #[inline]
    fn new(origin: f64, direction: f64, min: f64, cell: f64, [index, count]: [usize; 2], stride: usize) -> Self {
        let (index, count) = (index as f64, count as f64);
        if direction.abs() < PARALLEL {
            return Self { first_exit: f64::INFINITY, border_spacing: 0.0, index, step: 0.0, count, stride: 0 };
        }
        let reciprocal = 1.0 / direction;
        let (step, stride) = if direction > 0.0 { (1.0, stride) } else { (-1.0, stride.wrapping_neg()) };
        let exit_side = if direction > 0.0 { cell } else { 0.0 };
        let first_exit = (min - origin + exit_side) * reciprocal;
        Self { first_exit, border_spacing: cell * reciprocal, index, step, count, stride }
    }

    /// Distance at which the ray leaves the column or row.
    #[inline]
    fn exit(&self) -> f64 {
        self.first_exit + self.index * self.border_spacing
    }

    /// Moves on to the next column or row and updates `cell`; returns true if the ray has left the grid.
    #[inline]
    fn advance(&mut self, cell: &mut usize) -> bool {
        *cell = cell.wrapping_add(self.stride);
        self.index += self.step;
        (self.index < 0.0) | (self.index >= self.count)
    }
}

/// Contents of the cells: one list, sorted by cell.
#[derive(Clone, Debug)]
pub(super) struct Cells<T> {
    /// Index of the first entry of each cell, followed by the number of entries.
    starts: Vec<u32>,
    entries: Vec<T>,
}

impl<T> Default for Cells<T> {
    fn default() -> Self {
        Self { starts: Vec::new(), entries: Vec::new() }
    }
}

impl<T: Copy> Cells<T> {
    /// Inserts each item into the cells (numbers below `count`) that `cells_of` yields for it. A cell keeps the order
    /// of the items.
    pub fn fill(
        &mut self,
        count: usize,
        items: impl DoubleEndedIterator<Item = T> + Clone,
        cells_of: impl Fn(T, &mut dyn FnMut(usize)),
    ) {
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        for item in items.clone() {
            cells_of(item, &mut |cell| self.starts[cell] += 1);
        }
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        self.entries.clear();
        let Some(placeholder) = items.clone().next() else { return };
        self.entries.resize(total as usize, placeholder);
        // In reverse order, so that each start moves from the end of its cell to the beginning.
        for item in items.rev() {
            cells_of(item, &mut |cell| {
                self.starts[cell] -= 1;
                self.entries[self.starts[cell] as usize] = item;
            });
        }
    }

    /// Entries of a cell.
    #[inline]
    pub fn entries(&self, cell: usize) -> &[T] {
        self.entries_between(cell, cell)
    }

    /// Entries of the cells from `first` to `last`.
    #[inline]
    pub fn entries_between(&self, first: usize, last: usize) -> &[T] {
        &self.entries[self.starts[first] as usize..self.starts[last + 1] as usize]
    }
}
