//! The plain sonar grid: each reading makes its cone free and its arc occupied.
//!
//! Each cell counts how often it was in an arc and how often in a cone before the arc; its occupancy is the fraction of the arcs. The
//! grid is the reference for [`sector`](crate::sector).
//!
//! Source: arcs and cones as in Moravec & Elfes 1985; counted as in the histogram grids of Borenstein & Koren 1991 and the counting
//! model of Hähnel et al. 2003. Without weights over the beam: our choice.

use crate::grid::{Frame, Grid};
use crate::sonar::{Beam, Echo};

/// Interpretation of a reading without an echo.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Silence {
    /// No information: it may come from a mirror.
    Nothing,
    /// The beam is free up to its farthest distance.
    Free,
}

/// A plain sonar grid.
#[derive(Clone, PartialEq, Debug)]
pub struct SonarGrid {
    beam: Beam,
    silence: Silence,
    counts: Grid<(u32, u32)>,
}

impl SonarGrid {
    /// A grid without readings.
    pub fn new(frame: Frame, beam: Beam, silence: Silence) -> Self {
        Self { beam, silence, counts: Grid::new(frame, (0, 0)) }
    }

    /// Adds a reading; its arc is one cell thick.
    pub fn add(&mut self, echo: Echo) {
        let frame = *self.counts.frame();
        let half_cell = 0.5 * frame.cell_size();
        let (free, reach) = match (echo.distance, self.silence) {
            (Some(distance), _) => (distance - half_cell, distance + half_cell),
            (None, Silence::Free) => (self.beam.farthest, self.beam.farthest),
            (None, Silence::Nothing) => return,
        };
        for seen in self.beam.cells(&frame, echo.sonar, reach) {
            let (arcs, cones) = &mut self.counts[seen.cell];
            *(if seen.distance > free { arcs } else { cones }) += 1;
        }
    }

    /// Fraction of the readings over each cell that had it in their arc; 0.5 where there was none.
    pub fn probabilities(&self) -> Grid<f64> {
        self.counts.map(|&(arcs, cones)| match arcs + cones {
            0 => 0.5,
            all => f64::from(arcs) / f64::from(all),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Point, Pose};

    #[test]
    fn the_cone_is_free_the_arc_occupied_and_silence_as_one_likes() {
        let frame = Frame::new(Point::origin(), 0.1, 30, 20);
        let beam = Beam { half_angle: 0.26, nearest: 0.03, farthest: 2.0 };
        let sonar = Pose::new(0.05, 1.05, 0.0);
        let mut grid = SonarGrid::new(frame, beam, Silence::Nothing);
        grid.add(Echo { sonar, distance: Some(1.0) });
        grid.add(Echo { sonar, distance: None });
        let at = |grid: &SonarGrid, x, y| *grid.probabilities().at(Point::new(x, y)).expect("in the grid");
        assert_eq!([0.55, 1.05, 1.15, 1.95].map(|x| at(&grid, x, 1.05)), [0.0, 1.0, 0.5, 0.5]);
        assert_eq!((at(&grid, 1.05, 1.25), at(&grid, 1.05, 1.45)), (1.0, 0.5));
        let mut grid = SonarGrid::new(frame, beam, Silence::Free);
        grid.add(Echo { sonar, distance: Some(1.0) });
        grid.add(Echo { sonar, distance: None });
        assert_eq!([0.55, 1.05, 1.15, 1.95].map(|x| at(&grid, x, 1.05)), [0.0, 0.5, 0.0, 0.0]);
    }
}
