//! Map of the ground around a robot: a TSK height map that moves with the robot.
//!
//! Source: Gois and Hiller, section 3. The axes of the map are parallel to those of odometry, and the map moves by
//! whole cells, so heights are never resampled (our choice).

use crate::grid::{Grid, GridGeometry};
use crate::inverse::{SonarModel, SonarPose};
use crate::math;
use crate::pose::Point;
use crate::tsk::{Activation, Partition, Settings, Tsk};

/// A square height map; the robot is in its central cell.
#[derive(Clone, Debug)]
pub struct LocalMap {
    tsk: Tsk,
    model: SonarModel,
}

/// Estimate of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// x of its centre, in the odometry frame, m.
    pub x: f64,
    /// y of its centre, in the odometry frame, m.
    pub y: f64,
    /// Estimated height, m.
    pub z: f64,
    /// Standard deviation of the height, m.
    pub sigma: f64,
}

impl LocalMap {
    /// A map around (0, 0) with cells of the side `cell` m. Its sides are at least `half_side` m from (0, 0).
    ///
    /// # Panics
    /// As [`Tsk::new`].
    pub fn new(cell: f64, half_side: f64, model: SonarModel, settings: Settings) -> Self {
        let half = (half_side / cell).ceil() as i64;
        let side = 2 * half as usize + 1;
        let partition = Partition { cell, columns: side, rows: side, low: (-half, -half) };
        Self { tsk: Tsk::new(partition, settings), model }
    }

    /// Moves the map with the robot, which is now at (x, y); the estimates of cells that leave the map are discarded.
    pub fn follow(&mut self, x: f64, y: f64) {
        let partition = *self.tsk.partition();
        let (column, row) = partition.cell_index(x, y);
        let low = (column - partition.columns as i64 / 2, row - partition.rows as i64 / 2);
        if low != partition.low {
            self.tsk.move_to(low);
        }
    }

    /// Fuses a reading of a sonar that was at `sonar` in the odometry frame. Returns the number of cells updated.
    ///
    /// # Panics
    /// If a number is not finite.
    pub fn observe(&mut self, sonar: &SonarPose, measured: f64) -> usize {
        self.tsk.fuse(&self.model, sonar, measured)
    }

    /// Lowers the ground in front of a sonar whose line of sight is about level. A surface higher than `height` m and
    /// nearer than `distance` m, within `half_angle` rad on both sides of the line of sight, would have caused an echo.
    /// So each cell there with a higher estimate gets `height` as a reading, weighted by the squared beam gain (there
    /// and back); cells that the beam does not reach stay as they are.
    ///
    /// The use of readings as evidence of empty space comes from occupancy maps (Moravec and Elfes 1985; Oriolo, Ulivi
    /// and Venditelli 1999); Gois and Hiller use readings only as evidence of occupied points.
    ///
    /// # Panics
    /// If a number is not finite.
    pub fn clear(&mut self, sonar: &SonarPose, distance: f64, half_angle: f64, height: f64) {
        let partition = *self.tsk.partition();
        let yaw = math::atan2(sonar.axis.y, sonar.axis.x);
        // The cell of the echo itself is not cleared.
        let free_distance = distance - partition.cell;
        for index in partition.cells_around(sonar.origin.x, sonar.origin.y, free_distance.max(0.0)) {
            let Some(slot) = partition.slot(index) else { continue };
            let (x, y) = partition.centre(index);
            let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
            let bearing = math::atan2(dy, dx) - yaw;
            let off_axis_angle = math::atan2(math::sin(bearing), math::cos(bearing)).abs();
            if off_axis_angle > half_angle || math::hypot(dx, dy) > free_distance {
                continue;
            }
            let gain = self.model.membership_of_alpha(off_axis_angle);
            let weight = gain * gain;
            if weight >= f64::MIN_POSITIVE && self.tsk.height(x, y).is_some_and(|estimate| estimate > height) {
                let activation = Activation { cell_index: index, slot, weight: 1.0, x, y, height };
                self.tsk.add_height(&activation, weight);
            }
        }
    }

    /// Estimated height at (x, y), m; `None` outside the map.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        self.tsk.height(x, y)
    }

    /// All cells, row by row from the minimum y.
    pub fn patches(&self) -> impl Iterator<Item = Patch> {
        self.tsk.partition().cells().filter_map(|index| {
            let (x, y) = self.tsk.partition().centre(index);
            Some(Patch { x, y, z: self.tsk.height(x, y)?, sigma: self.tsk.sigma(x, y)? })
        })
    }

    /// All cells as a grid in the odometry frame.
    pub fn grid(&self) -> Grid<Patch> {
        let partition = *self.tsk.partition();
        let (column, row) = partition.low;
        let origin = Point::new(column as f64 * partition.cell, row as f64 * partition.cell);
        let frame = GridGeometry::new(origin, partition.cell, partition.columns, partition.rows);
        let patches: Vec<Patch> = self.patches().collect();
        Grid::from_fn(frame, |cell| patches[cell.row * partition.columns + cell.column])
    }

    /// The height map as a TSK system.
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
    fn follow_keeps_cells_that_stay_in_the_map() {
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
        let patch = *map.grid().at(Point::new(11.1, -2.9)).unwrap();
        assert_eq!((patch.x, patch.y, patch.z), (11.25, -2.75, height), "in the grid too");
        map.follow(7.0, -3.2);
        assert_eq!(map.height(11.1, -2.9), None, "fell out");
        map.follow(10.1, -3.2);
        assert_eq!(map.height(11.1, -2.9), Some(0.0), "and is forgotten");
    }

    #[test]
    fn clear_lowers_cells_nearer_than_the_echo_within_the_angle() {
        let mut map = LocalMap::new(0.5, 5.0, SonarModel::srf08(), Settings::default());
        let high = SonarPose::new(Vector3::new(3.25, 0.25, 3.0), 0.0, -FRAC_PI_2);
        let aside = SonarPose::new(Vector3::new(2.25, 3.25, 3.0), 0.0, -FRAC_PI_2);
        for _ in 0..50 {
            map.observe(&high, 2.0);
            map.observe(&aside, 2.0);
        }
        let heights = |map: &LocalMap| (map.height(3.25, 0.25).unwrap(), map.height(2.25, 3.25).unwrap());
        assert!(heights(&map).0 > 0.5 && heights(&map).1 > 0.5);
        let ahead = SonarPose::new(Vector3::new(0.0, 0.25, 1.2), 0.0, 0.3);
        for _ in 0..50 {
            map.clear(&ahead, 3.0, 0.3, 0.3);
        }
        assert!(heights(&map).0 > 0.5, "behind the echo");
        for _ in 0..50 {
            map.clear(&ahead, 5.0, 0.3, 0.3);
        }
        assert!(heights(&map).0 < 0.4 && heights(&map).1 > 0.5, "{:?}", heights(&map));
        let away = SonarPose::new(Vector3::new(4.0, 3.25, 1.2), 0.0, 0.3);
        map.clear(&away, 5.0, 4.0, 0.3);
        assert!(heights(&map).1 > 0.5, "behind the sonar");
    }

    /// A level sonar raises the map at its echo and not in front of it.
    #[test]
    fn obstacle_is_higher_than_the_free_ground_in_front_of_it() {
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
