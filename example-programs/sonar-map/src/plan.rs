//! Choice of the next observation position, and the path to it.

use mapping::astar::{self, Path};
use mapping::distance::distances;
use mapping::grid::{Cell, Grid, GridGeometry};
use mapping::line::supercover;
use mapping::pose::Point;
use mapping::score::{OCCUPIED, Occupancy};

/// Clearance of the robot's centre from the centre of occupied cells, m: the radius of 0.12, half of a cell's diagonal,
/// and the error of odometry.
const CLEARANCE: f64 = 0.21;
/// Clearance of the robot's centre from unobserved cells, m: its body and a little more. The robot does not enter cells
/// of silent sectors, but they need no clearance; otherwise it could not move at all among mirrors.
const UNHEARD_CLEARANCE: f64 = 0.15;
/// Minimum probability of an unobserved cell; a cell of a silent sector has a slightly lower one.
const UNHEARD: f64 = 0.49;
/// Maximum distance of a frontier that counts as visible from a position, m.
const SIGHT: f64 = 0.7;
/// Minimum number of frontier cells that make a position worth visiting.
const WORTH: usize = 4;
/// Minimum distance between observation positions, m.
const APART: f64 = 0.5;
/// Minimum difference from 0.5 of a sure probability: that of a reading of 1.4 m with a range of 4 m (Wu et al. 2013,
/// Eq. 2).
const SURE: f64 = 0.38;

/// Free space and frontiers of a map, for planning.
pub struct Plan {
    frame: GridGeometry,
    room: Grid<bool>,
    frontier: Grid<bool>,
}

impl Plan {
    /// Finds free space and frontiers on a map of probabilities, given the positions of unexpected obstacles.
    pub fn new(map: &Grid<f64>, bumps: &[Point]) -> Self {
        let frame = *map.frame();
        let said = map.map(|probability| Occupancy::of(*probability));
        let to_occupied = distances(&said, |said| *said == Occupancy::Occupied);
        let to_unheard = distances(map, |probability| (UNHEARD..OCCUPIED).contains(probability));
        let is_far = |cell: Cell| bumps.iter().all(|bump| (frame.centre(cell) - bump).norm() >= CLEARANCE);
        let room = Grid::from_fn(frame, |cell| {
            let is_clear = to_occupied[cell] >= CLEARANCE && to_unheard[cell] >= UNHEARD_CLEARANCE;
            said[cell] == Occupancy::Free && is_clear && is_far(cell)
        });
        let is_open = |cell: Cell| said[cell] != Occupancy::Free && (map[cell] - 0.5).abs() < SURE;
        let frontier =
            Grid::from_fn(frame, |cell| said[cell] == Occupancy::Free && frame.neighbours(cell).any(is_open));
        Self { frame, room, frontier }
    }

    /// Path to the nearest reachable position near a frontier that is not near a position in `been`. Frontiers are free
    /// cells beside cells that are unknown or not surely occupied. `None` if there is no such position.
    pub fn next(&self, from: Point, been: &[Point]) -> Option<Vec<Point>> {
        let start = self.frame.cell_at(from)?;
        let is_new = |point: Point| been.iter().all(|old| (point - old).norm() >= APART);
        let worth = |cell: Cell| {
            let point = self.frame.centre(cell);
            is_new(point) && self.frame.disc(point, SIGHT).filter(|nearby| self.frontier[*nearby]).count() >= WORTH
        };
        let path = astar::nearest(&self.frame, |cell| self.factor(cell), start, worth)?;
        Some(self.corners(&path))
    }

    /// Cost factor of a cell: 1 if the robot has enough clearance there, else `None`.
    fn factor(&self, cell: Cell) -> Option<f64> {
        self.room[cell].then_some(1.0)
    }

    /// Corners of a path, without those that the robot can skip by driving straight on.
    fn corners(&self, path: &Path) -> Vec<Point> {
        let points: Vec<Point> = path.cells.iter().map(|cell| self.frame.centre(*cell)).collect();
        let mut corners = Vec::new();
        let mut at = 0;
        while at + 1 < points.len() {
            let straight =
                |to: &usize| supercover(&self.frame, points[at], points[*to]).iter().all(|cell| self.room[*cell]);
            at = (at + 1..points.len()).rev().find(straight).unwrap_or(at + 1);
            corners.push(points[at]);
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of cells of 0.1 m: `.` free, `#` surely occupied, `?` unknown; the upper row first.
    fn map(text: &str) -> Grid<f64> {
        let rows: Vec<Vec<char>> = text.split_whitespace().rev().map(|row| row.chars().collect()).collect();
        let frame = GridGeometry::new(Point::origin(), 0.1, rows[0].len(), rows.len());
        Grid::from_fn(frame, |cell| match rows[cell.row][cell.column] {
            '#' => 1.0,
            '.' => 0.0,
            _ => 0.5,
        })
    }

    #[test]
    fn the_robot_drives_around_obstacles_to_unknown_cells() {
        let open = "....................";
        let blocked = "..........##........";
        let edge = "..................??";
        let text = [vec![edge; 6], vec![blocked; 4], vec![open; 6]].concat().join(" ");
        let plan = Plan::new(&map(&text), &[]);
        let path = plan.next(Point::new(0.35, 1.45), &[]).expect("a path");
        let end = path[path.len() - 1];
        assert!(end.x < 1.7 && end.x > 1.0, "{path:?}");
        let been = [end];
        let other = plan.next(end, &been).expect("another position");
        assert!((other[other.len() - 1] - end).norm() >= APART);
    }

    #[test]
    fn exploration_of_a_closed_room_is_complete() {
        let (wall, row) = ("############", "#..........#");
        let text = [vec![wall], vec![row; 10], vec![wall]].concat().join(" ");
        assert_eq!(Plan::new(&map(&text), &[]).next(Point::new(0.6, 0.6), &[]), None);
    }
}
