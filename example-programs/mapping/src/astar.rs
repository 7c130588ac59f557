//! Shortest paths on grids: A* and Dijkstra over eight neighbours.
//!
//! A step leads to one of the eight neighbours; a diagonal step requires that both cells beside it may be entered, so
//! paths do not cut corners. The cost of a step is its length in metres times the factor of the cell that it enters.
//! The choice among paths of equal cost is deterministic.
//!
//! For clearance, `factor` can return `None` for cells that are too near to obstacles (see
//! [`distance`](crate::distance)), and higher costs for cells at the edge of the clearance.
//!
//! Source: Hart, Nilsson & Raphael 1968; the rule about corners is our choice.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

use crate::grid::{Cell, Grid, GridGeometry};

/// A path from cell to neighbouring cell.
#[derive(Clone, PartialEq, Debug)]
pub struct Path {
    /// The cells, from the start to the goal, both included.
    pub cells: Vec<Cell>,
    /// The sum of the costs of the steps: the length in metres if all factors are 1.
    pub cost: f64,
}

/// A path of minimum cost from `start` to `goal`; `None` if there is no path.
///
/// `factor` is the cost per metre of a step into a cell, at least 1, or `None` if the cell must not be entered. No
/// step enters the start, so a robot can leave a forbidden cell.
///
/// # Panics
/// If start or goal lie outside the frame, or a factor is below 1 (then the estimate of the remaining cost would be too
/// high).
pub fn shortest_path(
    frame: &GridGeometry,
    factor: impl Fn(Cell) -> Option<f64>,
    start: Cell,
    goal: Cell,
) -> Option<Path> {
    assert!(frame.has(goal), "{goal:?} beyond the grid");
    search(frame, factor, start, |cell| cell == goal, |cell| octile(cell, goal) * frame.cell_size())
}

/// A path of minimum cost from `start` to any cell for which `is_goal` returns true; `None` if no such cell can be
/// reached.
///
/// # Panics
/// As [`shortest_path`].
pub fn nearest(
    frame: &GridGeometry,
    factor: impl Fn(Cell) -> Option<f64>,
    start: Cell,
    is_goal: impl Fn(Cell) -> bool,
) -> Option<Path> {
    search(frame, factor, start, is_goal, |_| 0.0)
}

/// Minimum cost of a path from `start` to each cell; infinite if there is no path.
///
/// # Panics
/// As [`shortest_path`].
pub fn costs(frame: &GridGeometry, factor: impl Fn(Cell) -> Option<f64>, start: Cell) -> Grid<f64> {
    let mut search = Search::new(frame, start);
    while search.settle_next(&factor, &|_| 0.0).is_some() {}
    search.costs
}

/// Octile distance: length of the shortest path between two cells over eight neighbours without obstacles, in units of
/// a cell's side.
fn octile(from: Cell, to: Cell) -> f64 {
    let (columns, rows) = (from.column.abs_diff(to.column) as f64, from.row.abs_diff(to.row) as f64);
    columns.max(rows) + (SQRT_2 - 1.0) * columns.min(rows)
}

fn search(
    frame: &GridGeometry,
    factor: impl Fn(Cell) -> Option<f64>,
    start: Cell,
    is_goal: impl Fn(Cell) -> bool,
    estimate: impl Fn(Cell) -> f64,
) -> Option<Path> {
    let mut search = Search::new(frame, start);
    while let Some(cell) = search.settle_next(&factor, &estimate) {
        if is_goal(cell) {
            return Some(search.path_to(cell));
        }
    }
    None
}

/// State of a search: costs and predecessors of the cells seen, and the open cells.
struct Search {
    frame: GridGeometry,
    costs: Grid<f64>,
    predecessors: Grid<Option<Cell>>,
    is_final: Grid<bool>,
    open: BinaryHeap<Open>,
}

impl Search {
    fn new(frame: &GridGeometry, start: Cell) -> Self {
        let mut costs = Grid::new(*frame, f64::INFINITY);
        costs[start] = 0.0;
        let open = BinaryHeap::from([Open { estimated_total: 0.0, cell: start }]);
        Self { frame: *frame, costs, predecessors: Grid::new(*frame, None), is_final: Grid::new(*frame, false), open }
    }

    /// Makes the cost of the next open cell final, updates its neighbours, and returns the cell; `None` if no cell is
    /// open.
    fn settle_next(&mut self, factor: &impl Fn(Cell) -> Option<f64>, estimate: &impl Fn(Cell) -> f64) -> Option<Cell> {
        let cell = loop {
            let Open { cell, .. } = self.open.pop()?;
            if !std::mem::replace(&mut self.is_final[cell], true) {
                break cell;
            }
        };
        for next in self.frame.neighbours(cell) {
            if self.is_final[next] {
                continue;
            }
            let Some(step) = self.step(cell, next, factor) else { continue };
            let cost = self.costs[cell] + step;
            if cost < self.costs[next] {
                self.costs[next] = cost;
                self.predecessors[next] = Some(cell);
                self.open.push(Open { estimated_total: cost + estimate(next), cell: next });
            }
        }
        Some(cell)
    }

    /// Cost of a step between neighbours; `None` if the step is forbidden.
    fn step(&self, from: Cell, to: Cell, factor: &impl Fn(Cell) -> Option<f64>) -> Option<f64> {
        let cell_factor = factor(to)?;
        assert!(cell_factor >= 1.0, "a factor of {cell_factor} for {to:?}");
        let is_diagonal = from.column != to.column && from.row != to.row;
        if is_diagonal {
            factor(Cell::new(from.column, to.row))?;
            factor(Cell::new(to.column, from.row))?;
        }
        Some(cell_factor * self.frame.cell_size() * if is_diagonal { SQRT_2 } else { 1.0 })
    }

    fn path_to(&self, goal: Cell) -> Path {
        let mut cells: Vec<Cell> = std::iter::successors(Some(goal), |cell| self.predecessors[*cell]).collect();
        cells.reverse();
        Path { cells, cost: self.costs[goal] }
    }
}

/// An open cell. The order is reversed for the heap: the minimum estimate comes first, and the minimum cell among
/// equals.
struct Open {
    /// Cost to the cell plus the estimated remaining cost.
    estimated_total: f64,
    cell: Cell,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimated_total.total_cmp(&self.estimated_total).then_with(|| other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::pose::Point;

    /// A map from text, the upper row first: `#` must not be entered, a digit is a factor, any other character is free.
    fn map(text: &str) -> Grid<Option<f64>> {
        let rows: Vec<Vec<char>> = text.split_whitespace().rev().map(|row| row.chars().collect()).collect();
        let frame = GridGeometry::new(Point::origin(), 0.5, rows[0].len(), rows.len());
        Grid::from_fn(frame, |cell| match rows[cell.row][cell.column] {
            '#' => None,
            c => Some(c.to_digit(10).map_or(1.0, f64::from)),
        })
    }

    /// Costs of all cells, by relaxing all steps until no cost changes.
    fn brute_force(map: &Grid<Option<f64>>, start: Cell) -> Grid<f64> {
        let mut costs = Grid::new(*map.frame(), f64::INFINITY);
        costs[start] = 0.0;
        loop {
            let previous = costs.clone();
            for cell in map.frame().cells() {
                for next in map.frame().neighbours(cell) {
                    let beside = [Cell::new(cell.column, next.row), Cell::new(next.column, cell.row)];
                    let is_diagonal = !beside.contains(&cell);
                    if is_diagonal && beside.iter().any(|cell| map[*cell].is_none()) {
                        continue;
                    }
                    let Some(factor) = map[next] else { continue };
                    let length = 0.5 * if is_diagonal { SQRT_2 } else { 1.0 };
                    costs[next] = costs[next].min(costs[cell] + length * factor);
                }
            }
            if costs == previous {
                return costs;
            }
        }
    }

    fn check(text: &str, from: Cell, to: Cell, expected: Option<f64>) {
        let map = map(text);
        let path = shortest_path(map.frame(), |cell| map[cell], from, to);
        match (path, expected) {
            (Some(path), Some(expected)) => assert!((path.cost - expected).abs() < 1e-12, "{text}: {path:?}"),
            (path, expected) => assert_eq!(path.map(|path| path.cost), expected, "{text}"),
        }
    }

    #[test]
    fn paths_are_shortest_and_cut_no_corners() {
        let (left, right) = (Cell::new(0, 0), Cell::new(2, 0));
        check("...", left, right, Some(1.0));
        check("...", left, left, Some(0.0));
        check("... .#.", left, right, Some(2.0));
        check(".#. .#.", left, right, None);
        check("... .9.", left, right, Some(2.0 * 0.5 * SQRT_2));
        check("...", Cell::new(0, 0), Cell::new(1, 0), Some(0.5));
        check(".. #.", Cell::new(1, 0), Cell::new(0, 1), Some(1.0));
    }

    #[test]
    fn path_may_start_in_a_forbidden_cell() {
        check("#..", Cell::new(0, 0), Cell::new(2, 0), Some(1.0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn agrees_with_brute_force(
            (columns, rows, kinds) in (1usize..9, 1usize..9)
                .prop_flat_map(|(columns, rows)| (Just(columns), Just(rows), prop::collection::vec(0u8..6, columns * rows))),
            end_indices in (0usize..81, 0usize..81),
        ) {
            let frame = GridGeometry::new(Point::origin(), 0.5, columns, rows);
            let map = Grid::from_fn(frame, |cell| match kinds[cell.row * columns + cell.column] {
                0 | 1 => None,
                2 => Some(2.5),
                _ => Some(1.0),
            });
            let cell = |index: usize| Cell::new(index % columns, index / columns % rows);
            let (start, goal) = (cell(end_indices.0), cell(end_indices.1));
            let expected = brute_force(&map, start);
            let is_close = |a: f64, b: f64| a == b || (a - b).abs() < 1e-9;
            for (cell, cost) in costs(&frame, |cell| map[cell], start).iter() {
                prop_assert!(is_close(*cost, expected[cell]), "{:?}", cell);
            }
            let found = [
                shortest_path(&frame, |cell| map[cell], start, goal),
                nearest(&frame, |cell| map[cell], start, |cell| cell == goal),
            ];
            for path in found {
                let Some(path) = path else {
                    prop_assert!(expected[goal].is_infinite());
                    continue;
                };
                prop_assert!(is_close(path.cost, expected[goal]));
                prop_assert_eq!((path.cells[0], path.cells[path.cells.len() - 1]), (start, goal));
                let mut cost = 0.0;
                for step in path.cells.windows(2) {
                    cost += octile(step[0], step[1]) * 0.5 * map[step[1]].expect("enters only free cells");
                }
                prop_assert!(is_close(cost, path.cost));
            }
        }
    }
}
