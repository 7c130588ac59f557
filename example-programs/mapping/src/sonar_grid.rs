//! Plain sonar grid: a reading is evidence that its cone is free and its arc occupied.
//!
//! Two counters of each cell count how often the cell was in an arc and how often it was in the cone in front of an
//! arc. A cell's probability is the fraction of arcs. The grid is the reference for [`sector`](crate::sector).
//!
//! Source: arcs and cones as in Moravec & Elfes 1985; counters as in the histogram grids of Borenstein & Koren 1991 and
//! the counting model of Hähnel et al. 2003. All cells of a beam have the same weight (our choice).

use crate::grid::{Grid, GridGeometry};
use crate::sonar::{Beam, Echo};

/// Interpretation of a reading without an echo.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NoEcho {
    /// No information: a mirror may be the cause.
    Ignored,
    /// The beam is free up to its maximum distance.
    Free,
}

/// A plain sonar grid.
#[derive(Clone, PartialEq, Debug)]
pub struct SonarGrid {
    beam: Beam,
    no_echo: NoEcho,
    counts: Grid<(u32, u32)>,
}

impl SonarGrid {
    /// A grid without readings.
    pub fn new(frame: GridGeometry, beam: Beam, no_echo: NoEcho) -> Self {
        Self { beam, no_echo, counts: Grid::new(frame, (0, 0)) }
    }

    /// Adds a reading; its arc is one cell thick.
    pub fn add(&mut self, echo: Echo) {
        let frame = *self.counts.frame();
        let half_cell = 0.5 * frame.cell_size();
        let (free_distance, max_distance) = match (echo.distance, self.no_echo) {
            (Some(distance), _) => (distance - half_cell, distance + half_cell),
            (None, NoEcho::Free) => (self.beam.farthest, self.beam.farthest),
            (None, NoEcho::Ignored) => return,
        };
        for in_beam in self.beam.cells(&frame, echo.sonar, max_distance) {
            let (arcs, cones) = &mut self.counts[in_beam.cell];
            *(if in_beam.distance > free_distance { arcs } else { cones }) += 1;
        }
    }

    /// For each cell, the fraction of arcs among the readings that covered it; 0.5 if no reading did.
    pub fn probabilities(&self) -> Grid<f64> {
        self.counts.map(|&(arcs, cones)| match arcs + cones {
            0 => 0.5,
            total => f64::from(arcs) / f64::from(total),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Point, Pose};

    #[test]
    fn cone_is_free_arc_is_occupied_and_silence_follows_its_setting() {
        let frame = GridGeometry::new(Point::origin(), 0.1, 30, 20);
        let beam = Beam { half_angle: 0.26, nearest: 0.03, farthest: 2.0 };
        let sonar = Pose::new(0.05, 1.05, 0.0);
        let mut grid = SonarGrid::new(frame, beam, NoEcho::Ignored);
        grid.add(Echo { sonar, distance: Some(1.0) });
        grid.add(Echo { sonar, distance: None });
        let at = |grid: &SonarGrid, x, y| *grid.probabilities().at(Point::new(x, y)).expect("in the grid");
        assert_eq!([0.55, 1.05, 1.15, 1.95].map(|x| at(&grid, x, 1.05)), [0.0, 1.0, 0.5, 0.5]);
        assert_eq!((at(&grid, 1.05, 1.25), at(&grid, 1.05, 1.45)), (1.0, 0.5));
        let mut grid = SonarGrid::new(frame, beam, NoEcho::Free);
        grid.add(Echo { sonar, distance: Some(1.0) });
        grid.add(Echo { sonar, distance: None });
        assert_eq!([0.55, 1.05, 1.15, 1.95].map(|x| at(&grid, x, 1.05)), [0.0, 0.5, 0.0, 0.0]);
    }
}
