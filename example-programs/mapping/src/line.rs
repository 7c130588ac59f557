//! Cells on a straight line, by three algorithms.
//!
//! - [`supercover`]: exactly the cells that the line touches;
//! - [`point_by_point`]: steps along one axis at a time, chosen by the sign of a deviation, as in numerically
//!   controlled machines. It needs only integer additions, which suits an 8-bit controller (Wu et al. 2013, "Local
//!   Model Establishment");
//! - [`dda`]: the digital differential analyser ("digital integration" in the same section). It steps along the longer
//!   axis and rounds the coordinate of the other one.
//!
//! The last two connect the centres of two cells, which are dx columns and dy rows apart. Point-by-point comparison
//! makes |dx| + |dy| steps, each to a cell with a common side, and may deviate from the line by nearly a cell. DDA
//! makes max(|dx|, |dy|) steps, some of them diagonal. It deviates by at most half a cell, so it visits only cells that
//! the line touches.

use crate::grid::{Cell, GridGeometry};
use crate::pose::Point;

/// The cells of `frame` whose closed square touches the line from `from` to `to` (in metres), column by column.
pub fn supercover(frame: &GridGeometry, from: Point, to: Point) -> Vec<Cell> {
    let (from, to) = (frame.in_cells(from), frame.in_cells(to));
    let (left, right) = if from.x <= to.x { (from, to) } else { (to, from) };
    let y_at = |x: f64| {
        let fraction = if right.x > left.x { ((x - left.x) / (right.x - left.x)).clamp(0.0, 1.0) } else { 0.0 };
        left.y + fraction * (right.y - left.y)
    };
    // One more cell on each side, since a point on an edge belongs to both cells; each cell is then tested exactly.
    let range = |min: f64, max: f64, count: usize| {
        let bound = |coordinate: f64| coordinate.clamp(0.0, count as f64) as usize;
        bound(min.floor() - 1.0)..bound(max.floor() + 2.0)
    };
    let mut cells = Vec::new();
    for column in range(left.x, right.x, frame.columns()) {
        let (mut low, mut high) = (y_at(column as f64), y_at(column as f64 + 1.0));
        if right.x <= left.x {
            (low, high) = (left.y, right.y);
        }
        let rows = range(low.min(high), low.max(high), frame.rows());
        cells.extend(rows.map(|row| Cell { column, row }).filter(|cell| touches(*cell, left, right)));
    }
    cells
}

/// Returns true if the closed square of a cell touches a line whose ends are in units of cells (separating axis test).
fn touches(cell: Cell, from: Point, to: Point) -> bool {
    let (x, y) = (cell.column as f64, cell.row as f64);
    let overlaps = |a: f64, b: f64, min: f64| a.max(b) >= min && a.min(b) <= min + 1.0;
    let along = to - from;
    let side = |x: f64, y: f64| along.x * (y - from.y) - along.y * (x - from.x);
    let sides = [side(x, y), side(x + 1.0, y), side(x, y + 1.0), side(x + 1.0, y + 1.0)];
    overlaps(from.x, to.x, x)
        && overlaps(from.y, to.y, y)
        && sides.iter().any(|side| *side >= 0.0)
        && sides.iter().any(|side| *side <= 0.0)
}

/// The cells from `from` to `to` by point-by-point comparison, both included.
///
/// Let (x, y) be the numbers of steps made along the axes, and (X, Y) the total numbers. The next step goes along x if
/// the deviation F = X y - Y x is above 0 (the last cell lies beyond the line in the direction of the y steps), along y
/// if F is below 0, and along x if F is 0 (our choice).
pub fn point_by_point(from: Cell, to: Cell) -> Vec<Cell> {
    let (total_x, total_y, cell_after) = steps(from, to);
    let (mut x, mut y, mut deviation) = (0, 0, 0);
    let mut cells = vec![from];
    while x + y < total_x + total_y {
        if (deviation >= 0 && x < total_x) || y == total_y {
            x += 1;
            deviation -= total_y;
        } else {
            y += 1;
            deviation += total_x;
        }
        cells.push(cell_after(x, y));
    }
    cells
}

/// The cells from `from` to `to` by DDA, both included.
///
/// This is the closed form of two integer accumulators of size max(|dx|, |dy|): at each tick, |dx| or |dy| is added to
/// the accumulator of each axis, and an overflow is a step along this axis. The accumulators begin half full, so the
/// shorter axis is rounded to the nearest cell.
pub fn dda(from: Cell, to: Cell) -> Vec<Cell> {
    let (total_x, total_y, cell_after) = steps(from, to);
    let ticks = total_x.max(total_y);
    let steps_after = |total: i64, tick: i64| if ticks == 0 { 0 } else { (2 * total * tick + ticks) / (2 * ticks) };
    (0..=ticks).map(|tick| cell_after(steps_after(total_x, tick), steps_after(total_y, tick))).collect()
}

/// Total numbers of steps along x and y between two cells, and a function that returns the cell after given numbers of
/// steps.
fn steps(from: Cell, to: Cell) -> (i64, i64, impl Fn(i64, i64) -> Cell) {
    let index_after = move |start: usize, end: usize, steps: i64| {
        if end >= start { start + steps as usize } else { start - steps as usize }
    };
    let total_x = from.column.abs_diff(to.column) as i64;
    let total_y = from.row.abs_diff(to.row) as i64;
    (total_x, total_y, move |x, y| Cell::new(index_after(from.column, to.column, x), index_after(from.row, to.row, y)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIDE: usize = 24;

    fn frame() -> GridGeometry {
        GridGeometry::new(Point::origin(), 1.0, SIDE, SIDE)
    }

    /// Returns true if a line touches the closed square of a cell, by clipping the line at the square's sides in
    /// integers. The line's ends are in eighths of a cell.
    fn meets(cell: Cell, from: (i64, i64), to: (i64, i64)) -> bool {
        // The remaining parameter interval is from `first` to `last`, both as (numerator, denominator), compared by
        // cross-multiplication (Liang-Barsky).
        let (mut first, mut last) = ((0, 1), (1, 1));
        let less = |a: (i64, i64), b: (i64, i64)| a.0 * b.1 < b.0 * a.1;
        let low = (cell.column as i64 * 8, cell.row as i64 * 8);
        for (start, step, low) in [(from.0, to.0 - from.0, low.0), (from.1, to.1 - from.1, low.1)] {
            for (p, q) in [(step, low + 8 - start), (-step, start - low)] {
                // p * t <= q
                match p.signum() {
                    0 if q < 0 => return false,
                    1 if less((q, p), last) => last = (q, p),
                    -1 if less(first, (-q, -p)) => first = (-q, -p),
                    _ => {}
                }
            }
        }
        !less(last, first)
    }

    /// Cells that a line touches, by testing each cell; the line's ends are in eighths of a cell.
    fn touched_cells(from: (i64, i64), to: (i64, i64)) -> Vec<Cell> {
        let mut cells: Vec<Cell> = frame().cells().filter(|cell| meets(*cell, from, to)).collect();
        cells.sort();
        cells
    }

    fn touched_between_middles(from: Cell, to: Cell) -> Vec<Cell> {
        let eighths = |cell: Cell| (cell.column as i64 * 8 + 4, cell.row as i64 * 8 + 4);
        touched_cells(eighths(from), eighths(to))
    }

    #[test]
    fn algorithms_differ_on_a_shallow_line() {
        let cells = |list: &[(usize, usize)]| list.iter().map(|(x, y)| Cell::new(*x, *y)).collect::<Vec<_>>();
        let (from, to) = (Cell::new(0, 0), Cell::new(4, 1));
        assert_eq!(point_by_point(from, to), cells(&[(0, 0), (1, 0), (1, 1), (2, 1), (3, 1), (4, 1)]));
        assert_eq!(dda(from, to), cells(&[(0, 0), (1, 0), (2, 1), (3, 1), (4, 1)]));
        let touched = supercover(&frame(), frame().centre(from), frame().centre(to));
        assert_eq!(touched, cells(&[(0, 0), (1, 0), (2, 0), (2, 1), (3, 1), (4, 1)]));
    }

    #[test]
    fn points_and_lines_on_an_edge_touch_the_cells_on_both_sides() {
        let count = |from: (f64, f64), to: (f64, f64)| {
            supercover(&frame(), Point::new(from.0, from.1), Point::new(to.0, to.1)).len()
        };
        assert_eq!(count((2.5, 2.5), (2.5, 2.5)), 1);
        assert_eq!(count((2.0, 2.0), (2.0, 2.0)), 4);
        assert_eq!(count((2.0, 2.5), (2.0, 3.5)), 4);
        assert_eq!(count((0.5, 0.5), (1.5, 1.5)), 4);
        assert_eq!(count((-5.0, 0.5), (-1.0, 0.5)), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn supercover_agrees_with_clipping(from in (-20i64..220, -20i64..220), to in (-20i64..220, -20i64..220)) {
            let point = |(x, y): (i64, i64)| Point::new(x as f64 / 8.0, y as f64 / 8.0);
            let mut cells = supercover(&frame(), point(from), point(to));
            cells.sort();
            prop_assert_eq!(cells, touched_cells(from, to));
        }

        #[test]
        fn point_by_point_and_dda_stay_near_the_line(ends in (0..SIDE, 0..SIDE, 0..SIDE, 0..SIDE)) {
            let (from, to) = (Cell::new(ends.0, ends.1), Cell::new(ends.2, ends.3));
            let (wide, high) = (from.column.abs_diff(to.column), from.row.abs_diff(to.row));
            let touched = touched_between_middles(from, to);
            let (by_points, by_dda) = (point_by_point(from, to), dda(from, to));
            prop_assert_eq!((by_points.len(), by_dda.len()), (wide + high + 1, wide.max(high) + 1));
            for cells in [&by_points, &by_dda] {
                prop_assert_eq!((cells[0], cells[cells.len() - 1]), (from, to));
                for step in cells.windows(2) {
                    prop_assert!(step[0].column.abs_diff(step[1].column) <= 1 && step[0].row.abs_diff(step[1].row) <= 1);
                }
            }
            for step in by_points.windows(2) {
                prop_assert_eq!(step[0].column.abs_diff(step[1].column) + step[0].row.abs_diff(step[1].row), 1);
            }
            // DDA visits only cells that the line touches; point-by-point comparison visits only these and their
            // neighbours.
            prop_assert!(by_dda.iter().all(|cell| touched.contains(cell)));
            let is_adjacent = |a: Cell, b: Cell| a.column.abs_diff(b.column) + a.row.abs_diff(b.row) <= 1;
            prop_assert!(by_points.iter().all(|cell| touched.iter().any(|other| is_adjacent(*cell, *other))));
            // The deviation of point-by-point comparison is at most one step: |F| <= max(X, Y).
            let (total_x, total_y) = (wide as i64, high as i64);
            for cell in &by_points {
                let (x, y) = (cell.column.abs_diff(from.column) as i64, cell.row.abs_diff(from.row) as i64);
                prop_assert!((total_x * y - total_y * x).abs() <= total_x.max(total_y));
            }
        }
    }
}
