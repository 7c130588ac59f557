//! Model of the operator, who chooses the body's direction of travel on the local map.
//!
//! In the paper the operator is a person with a joystick who sees the goal. Here the operator follows the cheapest path
//! over the map: to the goal, or to the border of the map and from there in a straight line.

use mapping::astar::{costs, shortest_path};
use mapping::distance::distances;
use mapping::grid::{Cell, Grid, GridGeometry};
use mapping::math;
use mapping::pose::Point;

/// Look-ahead distance along the path, m.
const AHEAD: f64 = 1.5;
/// Additional cost of a path through the middle of high cells, as a multiple of the cost over free ground. No cell is
/// forbidden, since the map may contain phantoms.
const DEAR: f64 = 20.0;

/// Joystick command of the operator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Direction of travel, rad.
    pub direction: f64,
    /// Distance from the path ahead to the nearest high cell, m; infinite if there is none.
    pub room: f64,
}

/// Chooses the direction from `robot` towards `goal`. The cells of the map are true where an obstacle is high. The
/// centre of the robot needs `needed` m of clearance.
pub fn look(is_high: &Grid<bool>, robot: Point, goal: Point, needed: f64) -> Command {
    let room = distances(is_high, |is_high| *is_high);
    let path = path_to(&room, robot, goal, needed);
    let ahead: Vec<Point> = path.into_iter().take_while(|point| (point - robot).norm() <= AHEAD).collect();
    let target = *ahead.last().unwrap_or(&goal);
    let room = ahead.iter().filter_map(|point| room.at(*point)).copied().fold(f64::INFINITY, f64::min);
    Command { direction: math::atan2(target.y - robot.y, target.x - robot.x), room }
}

/// Points of the cheapest path over the map, without the robot's own cell. The path includes the goal if the goal is on
/// the map.
fn path_to(room: &Grid<f64>, robot: Point, goal: Point, needed: f64) -> Vec<Point> {
    let frame = room.frame();
    let factor = |cell: Cell| Some(1.0 + DEAR * (1.0 - room[cell] / needed).max(0.0));
    let Some(start) = frame.cell_at(robot) else { return Vec::new() };
    let end = frame.cell_at(goal);
    let exit = end.unwrap_or_else(|| exit(&costs(frame, factor, start), goal));
    let path = shortest_path(frame, factor, start, exit).map_or_else(Vec::new, |path| path.cells);
    let centres = path.into_iter().filter(|cell| *cell != start && Some(*cell) != end).map(|cell| frame.centre(cell));
    centres.chain(end.map(|_| goal)).collect()
}

/// For a goal beyond the map: the cell on the map's border through which the total cost of the path to the goal is
/// lowest.
fn exit(costs: &Grid<f64>, goal: Point) -> Cell {
    let frame: &GridGeometry = costs.frame();
    let is_border = |cell: &Cell| {
        cell.column == 0 || cell.row == 0 || cell.column + 1 == frame.columns() || cell.row + 1 == frame.rows()
    };
    let whole = |cell: &Cell| costs[*cell] + (goal - frame.centre(*cell)).norm();
    frame.cells().filter(is_border).min_by(|a, b| whole(a).total_cmp(&whole(b))).expect("a map has a border")
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    const ROBOT: Point = Point::new(0.25, 0.25);

    /// A map of 20 m x 20 m with the robot at the centre.
    fn map(is_high: impl Fn(Point) -> bool) -> Grid<bool> {
        let frame = GridGeometry::new(Point::new(-10.0, -10.0), 0.5, 41, 41);
        Grid::from_fn(frame, |cell| is_high(frame.centre(cell)))
    }

    fn look_from(robot: Point, goal: Point, is_high: impl Fn(Point) -> bool) -> Command {
        look(&map(is_high), robot, goal, 2.0)
    }

    fn assert_near(angle: f64, expected: f64) {
        assert!((angle - expected).abs() < 0.3, "{angle}, expected {expected}");
    }

    #[test]
    fn a_free_path_is_followed_straight() {
        let free = look_from(ROBOT, Point::new(30.25, 0.25), |_| false);
        assert!(free.direction.abs() < 1e-12 && free.room == f64::INFINITY, "{free:?}");
        let at_goal = look_from(ROBOT, Point::new(0.6, 0.95), |_| false);
        assert!((at_goal.direction - math::atan2(0.7, 0.35)).abs() < 1e-12, "the goal itself: {at_goal:?}");
        let beside = look_from(ROBOT, Point::new(30.25, 0.25), |point| point.y > 3.0);
        assert!(beside.direction.abs() < 1e-12 && (beside.room - 3.0).abs() < 1e-12, "{beside:?}");
    }

    #[test]
    fn obstacles_are_passed_with_clearance_on_the_shorter_side() {
        let goal = Point::new(9.25, 0.25);
        let block = |point: Point| (3.0..4.0).contains(&point.x) && (-4.0..1.0).contains(&point.y);
        assert!(look_from(ROBOT, goal, block).direction > 0.3);
        let beside = look_from(Point::new(3.25, 2.75), goal, block);
        assert_near(beside.direction, 0.0);
        assert!(beside.room >= 2.0, "{beside:?}");
    }

    /// A dead end; a robot that always chooses the nearest free direction would never escape.
    #[test]
    fn it_walks_out_of_a_dead_end() {
        let pocket = |point: Point| {
            (point.x > 3.0 && point.x < 4.0 && point.y.abs() < 5.0)
                || (point.y.abs() > 4.0 && point.y.abs() < 5.0 && point.x > -3.0 && point.x < 4.0)
        };
        let command = look_from(ROBOT, Point::new(9.25, 0.75), pocket);
        assert!((command.direction.abs() - PI).abs() < 0.3, "{command:?}");
    }

    #[test]
    fn it_takes_the_wider_of_two_gaps_and_without_a_gap_the_thinnest_part() {
        let goal = Point::new(9.25, 0.25);
        let wall = |point: Point| (2.0..2.5).contains(&point.x);
        let gaps = |point: Point| wall(point) && (point.y - 0.25).abs() > 0.6 && !(4.0..9.0).contains(&point.y);
        assert!(look_from(ROBOT, goal, gaps).direction > 0.5);
        let closed = look_from(ROBOT, goal, wall);
        assert_near(closed.direction, 0.0);
        assert!(closed.room < 1.0, "{closed:?}");
    }

    #[test]
    fn outside_the_map_it_goes_straight_to_the_goal() {
        let command = look_from(Point::new(50.0, 0.0), Point::new(50.0, 9.0), |_| true);
        assert!((command.direction - FRAC_PI_2).abs() < 1e-12, "{command:?}");
    }
}
