//! Bayesian occupancy grid: each cell stores the log-odds l = ln(p / (1 - p)) of its probability p of being occupied.
//!
//! The initial odds are even. An independent reading z with the inverse sensor model p(occupied | z) adds
//! ln(p(occupied | z) / (1 - p(occupied | z))) to l. So a wrong cell is corrected by as much evidence as
//! made it wrong, at most [`LIMIT`].
//!
//! Source: Elfes 1989; Thrun, Burgard & Fox 2005, sections 4.2 and 9.2. The numbers of [`SonarModel`] are our choice.

use crate::grid::{Grid, GridGeometry};
use crate::math;
use crate::sonar::{Beam, Echo};

/// Limit of log-odds in either direction: a probability of 0.999, from which a cell can still be corrected.
pub const LIMIT: f64 = 6.9;

/// The log-odds of a probability in (0, 1).
pub fn log_odds(probability: f64) -> f64 {
    math::ln(probability / (1.0 - probability))
}

/// The probability for given log-odds.
pub fn probability(log_odds: f64) -> f64 {
    1.0 / (1.0 + math::exp(-log_odds))
}

/// Evidence of a reading for the cells of its beam, scaled by 1 - (angle / half angle)^2. The angle is
/// measured from the axis of the beam.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SonarModel {
    /// The beam.
    pub beam: Beam,
    /// Log-odds of a cell in the arc, above 0.
    pub arc: f64,
    /// Log-odds of a cell in front of the arc, below 0.
    pub cone: f64,
    /// Log-odds of a cell within the range of a reading without an echo, at most 0.
    pub no_echo: f64,
}

impl SonarModel {
    /// Probabilities of 0.7 in the arc and 0.3 in front of it. A reading without an echo is no evidence, since a mirror
    /// may be the cause.
    pub fn new(beam: Beam) -> Self {
        Self { beam, arc: log_odds(0.7), cone: log_odds(0.3), no_echo: 0.0 }
    }
}

/// A grid of log-odds.
#[derive(Clone, PartialEq, Debug)]
pub struct LogOddsGrid {
    cells: Grid<f64>,
}

impl LogOddsGrid {
    /// A grid without evidence: even odds in each cell.
    pub fn new(frame: GridGeometry) -> Self {
        Self { cells: Grid::new(frame, 0.0) }
    }

    /// The log-odds of each cell.
    pub fn log_odds(&self) -> &Grid<f64> {
        &self.cells
    }

    /// The probability of each cell.
    pub fn probabilities(&self) -> Grid<f64> {
        self.cells.map(|log_odds| probability(*log_odds))
    }

    /// Adds evidence about a cell, as log-odds; cells outside the grid are ignored.
    pub fn add(&mut self, cell: crate::grid::Cell, log_odds: f64) {
        if let Some(value) = self.cells.get_mut(cell) {
            *value = (*value + log_odds).clamp(-LIMIT, LIMIT);
        }
    }

    /// Adds a reading of a sonar; its arc is one cell thick.
    pub fn add_echo(&mut self, echo: Echo, model: &SonarModel) {
        let frame = *self.cells.frame();
        let half_cell = 0.5 * frame.cell_size();
        let max_distance = echo.distance.map_or(model.beam.farthest, |distance| distance + half_cell);
        for in_beam in model.beam.cells(&frame, echo.sonar, max_distance) {
            let evidence = match echo.distance {
                None => model.no_echo,
                Some(distance) if in_beam.distance > distance - half_cell => model.arc,
                Some(_) => model.cone,
            };
            let relative_angle = in_beam.angle / model.beam.half_angle;
            self.add(in_beam.cell, evidence * (1.0 - relative_angle * relative_angle));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Cell;
    use crate::pose::{Point, Pose};

    #[test]
    fn independent_readings_multiply_odds() {
        let mut grid = LogOddsGrid::new(GridGeometry::new(Point::origin(), 1.0, 1, 1));
        let cell = Cell::new(0, 0);
        // Bayes' rule: two readings of 0.7 with even prior odds give 0.49 / (0.49 + 0.09).
        grid.add(cell, log_odds(0.7));
        grid.add(cell, log_odds(0.7));
        assert!((grid.probabilities()[cell] - 0.49 / 0.58).abs() < 1e-12);
        grid.add(cell, 2.0 * log_odds(0.3));
        assert!((grid.probabilities()[cell] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn evidence_is_strongest_in_the_middle_of_the_beam() {
        let frame = GridGeometry::new(Point::origin(), 0.1, 30, 20);
        let model = SonarModel::new(Beam { half_angle: 0.26, nearest: 0.03, farthest: 2.0 });
        let mut grid = LogOddsGrid::new(frame);
        grid.add_echo(Echo { sonar: Pose::new(0.05, 1.05, 0.0), distance: Some(1.0) }, &model);
        let at = |x, y| *grid.log_odds().at(Point::new(x, y)).expect("in the grid");
        assert!((at(1.05, 1.05) - log_odds(0.7)).abs() < 1e-9 && (at(0.55, 1.05) - log_odds(0.3)).abs() < 1e-9);
        assert!(at(1.05, 1.25) > 0.0 && at(1.05, 1.25) < 0.5 * at(1.05, 1.05));
        assert_eq!((at(1.15, 1.05), at(1.05, 1.45)), (0.0, 0.0));
    }
}
