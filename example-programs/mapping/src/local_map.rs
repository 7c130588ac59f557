//! The ground around a robot: a TSK surface that goes along with its body.
//!
//! Source: Gois and Hiller, section 3. The map keeps the directions of the axes of the robot's odometry and is shifted by whole
//! cells, so that nothing is ever resampled (our choice).

use crate::inverse::{SonarModel, SonarPose};
use crate::tsk::{Partition, Settings, Tsk};

/// A square of ground whose middle cell is the one that the body is in.
#[derive(Clone, Debug)]
pub struct LocalMap {
    tsk: Tsk,
    model: SonarModel,
}

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Its middle, in the frame of the odometry, m.
    pub x: f64,
    /// Its middle, in the frame of the odometry, m.
    pub y: f64,
    /// Estimated height there, m.
    pub z: f64,
    /// Standard deviation of it, m.
    pub sigma: f64,
}

impl LocalMap {
    /// A map around (0, 0), of cells with the side `cell` m that reach at least `reach` m to every side.
    ///
    /// # Panics
    /// As [`Tsk::new`].
    pub fn new(cell: f64, reach: f64, model: SonarModel, settings: Settings) -> Self {
        let half = (reach / cell).ceil() as i64;
        let side = 2 * half as usize + 1;
        let partition = Partition { cell, columns: side, rows: side, low: (-half, -half) };
        Self { tsk: Tsk::new(partition, settings), model }
    }

    /// Goes along with a body that is at (x, y) now: what falls out at the far side is forgotten.
    pub fn follow(&mut self, x: f64, y: f64) {
        let partition = *self.tsk.partition();
        let (column, row) = partition.place(x, y);
        let low = (column - partition.columns as i64 / 2, row - partition.rows as i64 / 2);
        if low != partition.low {
            self.tsk.move_to(low);
        }
    }

    /// Fuses a reading of a sonar that was at `sonar` in the frame of the odometry. How many cells it told of.
    ///
    /// # Panics
    /// If a number is not finite.
    pub fn observe(&mut self, sonar: &SonarPose, measured: f64) -> usize {
        self.tsk.fuse(&self.model, sonar, measured)
    }

    /// Estimated height at (x, y), m; `None` outside the map.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.tsk.height(x, y)
    }

    /// All cells, row by row from the least y.
    pub fn patches(&self) -> impl Iterator<Item = Patch> {
        self.tsk.partition().places().filter_map(|place| {
            let (x, y) = self.tsk.partition().centre(place);
            Some(Patch { x, y, z: self.tsk.height(x, y)?, sigma: self.tsk.sigma(x, y)? })
        })
    }

    /// The surface.
    pub fn surface(&self) -> &Tsk {
        &self.tsk
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn it_goes_along_and_keeps_what_stays_in_it() {
        let mut map = LocalMap::new(0.5, 2.0, SonarModel::srf08(), Settings::default());
        assert_eq!(map.patches().count(), 81);
        map.follow(10.1, -3.2);
        let down = SonarPose::new(Vector3::new(11.0, -3.0, 2.0), 0.0, -FRAC_PI_2);
        for _ in 0..200 {
            assert!(map.observe(&down, 1.4) > 3);
        }
        let height = map.height(11.1, -2.9).unwrap();
        assert!((height - 0.6).abs() < 0.1, "{height}");
        map.follow(9.4, -3.2);
        assert_eq!(map.height(11.1, -2.9), Some(height), "the same cell");
        map.follow(7.0, -3.2);
        assert_eq!(map.height(11.1, -2.9), None, "fell out");
        map.follow(10.1, -3.2);
        assert_eq!(map.height(11.1, -2.9), Some(0.0), "and is forgotten");
    }

    /// A sonar that looks level says that something stands where its echo is, and nothing before it.
    #[test]
    fn an_obstacle_ahead_stands_out_of_the_free_ground_before_it() {
        let settings = Settings { floor: 0.0, ..Settings::default() };
        let mut map = LocalMap::new(0.5, 5.0, SonarModel::srf08(), settings);
        for step in 0..40 {
            let x = 0.05 * f64::from(step);
            map.follow(x, 0.0);
            let ahead = SonarPose::new(Vector3::new(x, 0.25, 1.2), 0.0, 0.17);
            map.observe(&ahead, 4.25 - x);
        }
        assert!(map.height(4.25, 0.25).unwrap() > 0.6, "{:?}", map.height(4.25, 0.25));
        assert!(map.height(3.25, 0.25).unwrap() < 0.2, "{:?}", map.height(3.25, 0.25));
        assert!(map.height(2.75, 0.25).unwrap() < 0.1, "{:?}", map.height(2.75, 0.25));
    }
}
