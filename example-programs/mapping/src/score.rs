//! Classification of a map's cells, and the score of a map compared with the truth.

use crate::grid::{Cell, Grid};

/// Minimum probability of a cell that is classified as occupied: Wu et al. 2013, Eq. 2.
pub const OCCUPIED: f64 = 0.6;

/// Maximum probability of a cell that is classified as free: Wu et al. 2013, Eq. 2.
pub const FREE: f64 = 0.4;

/// Classification of a cell by a map.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Occupancy {
    /// Free space.
    Free,
    /// An obstacle.
    Occupied,
    /// Neither free nor occupied with enough certainty.
    Unknown,
}

impl Occupancy {
    /// Classifies a probability of being occupied: at least [`OCCUPIED`], at most [`FREE`], or neither.
    pub fn of(probability: f64) -> Self {
        if probability >= OCCUPIED {
            Self::Occupied
        } else if probability <= FREE {
            Self::Free
        } else {
            Self::Unknown
        }
    }
}

/// True state of a cell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Truth {
    /// Free space in which a robot could be.
    Free,
    /// A surface that is visible from free cells passes through the cell.
    Surface,
    /// Behind a surface: inside an obstacle, or beyond the walls.
    Hidden,
}

/// Comparison of a map with the truth.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Score {
    /// Cells correctly classified as free, or as occupied (a surface or hidden).
    pub right: usize,
    /// Cells wrongly classified as free or occupied.
    pub wrong: usize,
    /// Free cells and surfaces that are unknown in the map.
    pub unknown: usize,
    /// Fraction of the cells classified as occupied that are a surface or have a surface as a neighbour; NaN if no cell
    /// is classified as occupied.
    pub precision: f64,
    /// Fraction of the surface cells that are classified as occupied or have a neighbour that is; NaN without surface
    /// cells.
    pub recall: f64,
}

impl Score {
    /// Compares a map with the truth; both have the same frame.
    ///
    /// # Panics
    /// If their frames differ.
    pub fn of(map: &Grid<Occupancy>, truth: &Grid<Truth>) -> Self {
        assert_eq!(map.frame(), truth.frame(), "maps of different frames");
        let count = |is_counted: fn(Occupancy, Truth) -> bool| {
            map.values()
                .iter()
                .zip(truth.values())
                .filter(|(classified, actual)| is_counted(**classified, **actual))
                .count()
        };
        let is_right = |classified, actual| match classified {
            Occupancy::Free => actual == Truth::Free,
            Occupancy::Occupied => actual != Truth::Free,
            Occupancy::Unknown => false,
        };
        let right = count(is_right);
        Self {
            right,
            wrong: count(|classified, _| classified != Occupancy::Unknown) - right,
            unknown: count(|classified, actual| classified == Occupancy::Unknown && actual != Truth::Hidden),
            precision: fraction_with_neighbour(map, Occupancy::Occupied, truth, Truth::Surface),
            recall: fraction_with_neighbour(truth, Truth::Surface, map, Occupancy::Occupied),
        }
    }

    /// Fraction of right cells among those classified as free or occupied.
    pub fn accuracy(&self) -> f64 {
        self.right as f64 / (self.right + self.wrong) as f64
    }
}

/// Fraction of the cells with `value` in `grid` for which `others` has `other` in the same cell or in a neighbour.
fn fraction_with_neighbour<A: PartialEq, B: PartialEq>(grid: &Grid<A>, value: A, others: &Grid<B>, other: B) -> f64 {
    let cells: Vec<Cell> = grid.iter().filter(|(_, actual)| **actual == value).map(|(cell, _)| cell).collect();
    let is_near = |cell: &Cell| {
        others[*cell] == other || others.frame().neighbours(*cell).any(|neighbour| others[neighbour] == other)
    };
    cells.iter().filter(|cell| is_near(cell)).count() as f64 / cells.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GridGeometry;
    use crate::pose::Point;

    #[test]
    fn threshold_values_are_free_or_occupied() {
        let classes: Vec<Occupancy> = [0.0, 0.4, 0.45, 0.5, 0.6, 1.0].into_iter().map(Occupancy::of).collect();
        use Occupancy::{Free, Occupied, Unknown};
        assert_eq!(classes, [Free, Free, Unknown, Unknown, Occupied, Occupied]);
    }

    #[test]
    fn score_matches_a_count_by_hand() {
        let frame = GridGeometry::new(Point::origin(), 1.0, 6, 1);
        let grid = |text: &str| text.chars().collect::<Vec<char>>();
        let (classified, actual) = (grid("OO.?.?"), grid("...##x"));
        let map = Grid::from_fn(frame, |cell| match classified[cell.column] {
            'O' => Occupancy::Occupied,
            '.' => Occupancy::Free,
            _ => Occupancy::Unknown,
        });
        let truth = Grid::from_fn(frame, |cell| match actual[cell.column] {
            '.' => Truth::Free,
            '#' => Truth::Surface,
            _ => Truth::Hidden,
        });
        // Two false obstacles, far from the surface; one free cell correct; one surface cell classified as free, one
        // unknown.
        let score = Score::of(&map, &truth);
        assert_eq!((score.right, score.wrong, score.unknown), (1, 3, 1));
        assert_eq!((score.precision, score.recall, score.accuracy()), (0.0, 0.0, 0.25));
        let shifted =
            Grid::from_fn(frame, |cell| if cell.column == 2 { Occupancy::Occupied } else { Occupancy::Unknown });
        let score = Score::of(&shifted, &truth);
        assert_eq!((score.precision, score.recall), (1.0, 0.5));
    }
}
