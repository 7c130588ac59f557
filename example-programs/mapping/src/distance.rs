//! Exact Euclidean distance transform: the distance of each cell of a grid from the nearest feature cell.
//!
//! Two passes in integers, without rounding: the distance along each column, then in each row the lower envelope of
//! parabolas whose minima are the squares of these distances. The time is linear in the number of cells.
//!
//! Source: Meijster, Roerdink & Hesselink 2000, "A general algorithm for computing distance transforms in linear time";
//! Felzenszwalb & Huttenlocher 2012 use the same parabolas in floating point.

use crate::grid::{Cell, Grid, GridGeometry};

/// Distance in metres from the centre of each cell to the centre of the nearest cell for which `is_feature` returns
/// true; 0 for feature cells, infinite if there is no feature.
///
/// The distance to the *edge* of the nearest feature cell is shorter, by up to half of a cell's diagonal.
pub fn distances<T>(grid: &Grid<T>, is_feature: impl Fn(&T) -> bool) -> Grid<f64> {
    let size = grid.frame().cell_size();
    squared_in_cells(grid, is_feature).map(|squared| match squared {
        Some(squared) => size * (*squared as f64).sqrt(),
        None => f64::INFINITY,
    })
}

/// Exact square of the distance from each cell to the nearest feature cell, in cells; `None` if there is no feature.
pub fn squared_in_cells<T>(grid: &Grid<T>, is_feature: impl Fn(&T) -> bool) -> Grid<Option<u64>> {
    let frame = *grid.frame();
    let column_distances = along_columns(grid, is_feature);
    let mut squares = Grid::new(frame, None);
    for row in 0..frame.rows() {
        let heights: Vec<Option<i64>> =
            (0..frame.columns()).map(|column| column_distances[Cell { column, row }]).collect();
        for (column, squared) in lower_envelope(&heights).into_iter().enumerate() {
            squares[Cell { column, row }] = squared;
        }
    }
    squares
}

/// Number of rows from each cell to the nearest feature of the same column; `None` without one.
fn along_columns<T>(grid: &Grid<T>, is_feature: impl Fn(&T) -> bool) -> Grid<Option<i64>> {
    let frame: GridGeometry = *grid.frame();
    let mut distances = Grid::new(frame, None);
    for column in 0..frame.columns() {
        let upward = 0..frame.rows();
        sweep(grid, &is_feature, &mut distances, upward.clone().map(|row| Cell { column, row }));
        sweep(grid, &is_feature, &mut distances, upward.rev().map(|row| Cell { column, row }));
    }
    distances
}

/// Lowers `distances` to the number of cells since the last feature on `line`.
fn sweep<T>(
    grid: &Grid<T>,
    is_feature: impl Fn(&T) -> bool,
    distances: &mut Grid<Option<i64>>,
    line: impl Iterator<Item = Cell>,
) {
    let mut steps_since: Option<i64> = None;
    for cell in line {
        steps_since = if is_feature(&grid[cell]) { Some(0) } else { steps_since.map(|steps| steps + 1) };
        distances[cell] = match (distances[cell], steps_since) {
            (Some(old), Some(new)) => Some(old.min(new)),
            (old, new) => old.or(new),
        };
    }
}

/// Minimum over i of (x - i)^2 + heights[i]^2 for each column x; a column i without a height is left out.
fn lower_envelope(heights: &[Option<i64>]) -> Vec<Option<u64>> {
    let value = |x: i64, (centre, height): (i64, i64)| (x - centre) * (x - centre) + height * height;
    // The last column at which the parabola `left` is not above the parabola `right`; a parabola is (centre, height).
    let last_column = |left: (i64, i64), right: (i64, i64)| {
        let difference = right.0 * right.0 - left.0 * left.0 + right.1 * right.1 - left.1 * left.1;
        difference.div_euclid(2 * (right.0 - left.0))
    };
    // The parabolas of the lower envelope, each with the first column in which it is the lowest.
    let mut envelope: Vec<((i64, i64), i64)> = Vec::new();
    for (x, height) in heights.iter().enumerate() {
        let Some(height) = height else { continue };
        let new = (x as i64, *height);
        while envelope.last().is_some_and(|&(top, first)| value(first, top) > value(first, new)) {
            envelope.pop();
        }
        let first = envelope.last().map_or(0, |&(top, _)| last_column(top, new) + 1);
        if first < heights.len() as i64 {
            envelope.push((new, first));
        }
    }
    let mut squares = vec![None; heights.len()];
    let mut end = heights.len();
    for (parabola, first) in envelope.into_iter().rev() {
        for (x, square) in (first..).zip(&mut squares[first as usize..end]) {
            *square = Some(value(x, parabola) as u64);
        }
        end = first as usize;
    }
    squares
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::pose::Point;

    fn brute_force(grid: &Grid<bool>) -> Grid<Option<u64>> {
        Grid::from_fn(*grid.frame(), |cell| {
            let features = grid.iter().filter(|(_, is_feature)| **is_feature);
            let square = |a: usize, b: usize| (a.abs_diff(b) as u64).pow(2);
            features.map(|(other, _)| square(cell.column, other.column) + square(cell.row, other.row)).min()
        })
    }

    #[test]
    fn distances_are_metric_and_infinite_without_a_feature() {
        let frame = GridGeometry::new(Point::origin(), 0.1, 5, 4);
        let mut grid = Grid::new(frame, false);
        assert!(distances(&grid, |is_feature| *is_feature).values().iter().all(|distance| distance.is_infinite()));
        grid[Cell::new(0, 0)] = true;
        let distances = distances(&grid, |is_feature| *is_feature);
        assert_eq!(distances[Cell::new(0, 0)], 0.0);
        assert!((distances[Cell::new(4, 3)] - 0.5).abs() < 1e-15);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn agrees_with_brute_force(
            (columns, rows, features) in (1usize..14, 1usize..14)
                .prop_flat_map(|(columns, rows)| (Just(columns), Just(rows), prop::collection::vec(0u8..10, columns * rows))),
            fraction in 0u8..10,
        ) {
            let frame = GridGeometry::new(Point::origin(), 1.0, columns, rows);
            let grid = Grid::from_fn(frame, |cell| features[cell.row * columns + cell.column] < fraction);
            prop_assert_eq!(squared_in_cells(&grid, |is_feature| *is_feature), brute_force(&grid));
        }
    }
}
