//! Where to observe next, and the way there.

use mapping::astar::{self, Path};
use mapping::distance::distances;
use mapping::grid::{Cell, Frame, Grid};
use mapping::line::supercover;
use mapping::pose::Point;
use mapping::score::{OCCUPIED, Occupancy};

/// Metres that the robot's middle keeps from the middle of occupied cells: its radius of 0.12, half of a cell's diagonal, and what
/// odometry may err by.
const CLEARANCE: f64 = 0.21;
/// Metres that it keeps from cells of which nothing was heard: its body and a little more. From those of silent sectors it keeps no
/// distance, though it does not go there: among mirrors it could not move at all.
const UNHEARD_CLEARANCE: f64 = 0.15;
/// Least probability of a cell of which nothing was heard; silence says a little less.
const UNHEARD: f64 = 0.49;
/// How far away something may be that is to be seen from a place, in metres.
const SIGHT: f64 = 0.7;
/// How many cells of a frontier make a place worth going to.
const WORTH: usize = 4;
/// How far places of observation are apart, in metres.
const APART: f64 = 0.5;
/// A probability is sure if it is as far as this from 0.5: that of a reading of 1.4 m in 4 m (Wu et al. 2013, Eq. 2).
const SURE: f64 = 0.38;

/// The robot's way through what it knows.
pub struct Plan {
    frame: Frame,
    room: Grid<bool>,
    frontier: Grid<bool>,
}

impl Plan {
    /// Looks at a map of probabilities, and at the places where the robot has bumped into something.
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

    /// The way to the nearest place that can be reached, is not near one of those where the robot has `been`, and near to which a
    /// frontier is: free cells beside cells that are unknown or not surely occupied. `None` if there is none.
    pub fn next(&self, from: Point, been: &[Point]) -> Option<Vec<Point>> {
        let start = self.frame.cell_at(from)?;
        let is_new = |point: Point| been.iter().all(|old| (point - old).norm() >= APART);
        let worth = |cell: Cell| {
            let point = self.frame.centre(cell);
            is_new(point) && self.frame.disc(point, SIGHT).filter(|near| self.frontier[*near]).count() >= WORTH
        };
        let path = astar::nearest(&self.frame, |cell| self.factor(cell), start, worth)?;
        Some(self.corners(&path))
    }

    /// Whether the way to a cell is as it was planned.
    fn factor(&self, cell: Cell) -> Option<f64> {
        self.room[cell].then_some(1.0)
    }

    /// The corners of a path, without those between which the robot can drive straight on.
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
        let frame = Frame::new(Point::origin(), 0.1, rows[0].len(), rows.len());
        Grid::from_fn(frame, |cell| match rows[cell.row][cell.column] {
            '#' => 1.0,
            '.' => 0.0,
            _ => 0.5,
        })
    }

    #[test]
    fn the_robot_goes_around_things_to_what_it_does_not_know() {
        let open = "....................";
        let blocked = "..........##........";
        let edge = "..................??";
        let text = [vec![edge; 6], vec![blocked; 4], vec![open; 6]].concat().join(" ");
        let plan = Plan::new(&map(&text), &[]);
        let way = plan.next(Point::new(0.35, 1.45), &[]).expect("a way");
        let end = way[way.len() - 1];
        assert!(end.x < 1.7 && end.x > 1.0, "{way:?}");
        let been = [end];
        let other = plan.next(end, &been).expect("another place");
        assert!((other[other.len() - 1] - end).norm() >= APART);
    }

    #[test]
    fn a_closed_room_is_done() {
        let (wall, row) = ("############", "#..........#");
        let text = [vec![wall], vec![row; 10], vec![wall]].concat().join(" ");
        assert_eq!(Plan::new(&map(&text), &[]).next(Point::new(0.6, 0.6), &[]), None);
    }
}
