//! The operator's part: a direction of travel for the body, chosen on the local map.
//!
//! Towards the goal where the way is free; else the free direction that turns away from it least, with a memory of the side on which
//! an obstacle is being passed. The paper leaves the direction to a person with a joystick; this rule stands in for that one.

use std::f64::consts::{PI, TAU};

use mapping::local_map::Patch;
use mapping::math;

/// Directions that are looked at, all around.
const DIRECTIONS: usize = 72;

/// The operator's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// How far to each side of its middle the robot needs room, m.
    pub half_width: f64,
    /// A direction is free if nothing high stands on the way for so far, m.
    pub look_ahead: f64,
}

/// The operator, with a memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operator {
    /// The direction of the last look, rad.
    last: Option<f64>,
    /// On which side of the goal's direction an obstacle is being passed: 1 to its left, -1 to its right.
    side: Option<f64>,
}

/// A thing to keep clear of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Its place, m ahead and to the left of the robot along the axes of the odometry.
    pub x: f64,
    /// Its place, m.
    pub y: f64,
}

impl Obstacle {
    /// A patch of the map as seen from (x, y).
    pub fn seen_from(patch: &Patch, x: f64, y: f64) -> Self {
        Self { x: patch.x - x, y: patch.y - y }
    }
}

impl Operator {
    /// The direction to walk to, rad, and how far it is free, m: as near to the direction `goal` (rad) as may be. The way counts up to
    /// `distance` m, where the goal is.
    pub fn look(&mut self, view: &View, goal: f64, distance: f64, obstacles: &[Obstacle]) -> (f64, f64) {
        let needed = view.look_ahead.min(distance);
        let ways: Vec<(f64, f64)> = (0..DIRECTIONS)
            .map(|index| {
                let turn = (index as f64 / DIRECTIONS as f64 - 0.5) * TAU;
                (turn, free_way(view, goal + turn, obstacles).min(view.look_ahead))
            })
            .collect();
        let chosen = ways
            .iter()
            .filter(|(_, free)| *free >= needed)
            .min_by(|a, b| self.cost(goal, a.0).total_cmp(&self.cost(goal, b.0)))
            // Nothing is free: the longest way, and of those the best.
            .or_else(|| {
                ways.iter().min_by(|a, b| {
                    let cost = |way: &(f64, f64)| self.cost(goal, way.0) - 10.0 * way.1;
                    cost(a).total_cmp(&cost(b))
                })
            });
        let (turn, free) = chosen.copied().unwrap_or((0.0, 0.0));
        self.remember(turn);
        let direction = wrapped(goal + turn);
        self.last = Some(direction);
        (direction, free)
    }

    /// How little a direction is liked that is turned by `turn` from the goal's.
    fn cost(&self, goal: f64, turn: f64) -> f64 {
        let unsteady = self.last.map_or(0.0, |last| wrapped(goal + turn - last).abs());
        // The other side of the obstacle is worth half a turn: else two ways about as long are taken by turns.
        let is_other_side = self.side.is_some_and(|side| turn * side < 0.0);
        turn.abs() + 0.3 * unsteady + if is_other_side { PI / 2.0 } else { 0.0 }
    }

    fn remember(&mut self, turn: f64) {
        if turn.abs() < 0.2 {
            self.side = None;
        } else if self.side.is_none() && turn.abs() > 0.6 {
            self.side = Some(turn.signum());
        }
    }
}

/// How far the robot's middle can go to `direction` before an obstacle is within its width, m.
fn free_way(view: &View, direction: f64, obstacles: &[Obstacle]) -> f64 {
    let (sin, cos) = (math::sin(direction), math::cos(direction));
    let mut free = f64::INFINITY;
    for Obstacle { x, y } in obstacles {
        let (ahead, aside) = (cos * x + sin * y, cos * y - sin * x);
        if aside.abs() >= view.half_width || ahead <= 0.0 {
            continue;
        }
        // What is within the width already does not stop a way that leads off it.
        let touch = (view.half_width * view.half_width - aside * aside).sqrt();
        free = free.min((ahead - touch).max(0.0));
    }
    free
}

/// An angle in [-pi, pi), rad.
pub fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View { half_width: 1.0, look_ahead: 4.0 };

    fn look(operator: &mut Operator, obstacles: &[Obstacle]) -> f64 {
        operator.look(&VIEW, 0.0, 20.0, obstacles).0
    }

    #[test]
    fn a_free_way_is_taken_straight() {
        assert_eq!(look(&mut Operator::default(), &[]), 0.0);
        let behind_and_aside = [Obstacle { x: -1.5, y: 0.0 }, Obstacle { x: 2.0, y: 1.2 }];
        assert_eq!(look(&mut Operator::default(), &behind_and_aside), 0.0);
        // Behind the goal nothing matters.
        let goal = Operator::default().look(&VIEW, 0.0, 1.0, &[Obstacle { x: 3.0, y: 0.0 }]);
        assert!(goal.0 == 0.0 && goal.1 >= 1.0, "{goal:?}");
    }

    #[test]
    fn an_obstacle_is_passed_on_the_nearer_side_and_on_that_for_good() {
        let mut operator = Operator::default();
        let direction = look(&mut operator, &[Obstacle { x: 2.0, y: -0.3 }]);
        assert!(direction > 0.2 && direction < 0.6, "{direction}");
        let direction = look(&mut operator, &[Obstacle { x: 1.2, y: -0.3 }]);
        assert!(direction > 0.6 && operator.side == Some(1.0), "{direction}");
        // Seen anew, the other side is a little nearer; it stays on the side that it took.
        let direction = look(&mut operator, &[Obstacle { x: 1.2, y: 0.1 }]);
        assert!(direction > 0.6, "{direction}");
        assert_eq!(look(&mut operator, &[]), 0.0);
        assert_eq!(operator.side, None);
    }

    #[test]
    fn angles_are_wrapped() {
        assert!((wrapped(3.0 * PI + 0.1) - (0.1 - PI)).abs() < 1e-12);
        assert_eq!(wrapped(0.5), 0.5);
    }
}
