//! Whether robots start where there is room for them: a robot inside a wall or another robot never moves.

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::spec::{RobotSpec, WorldSpec};
use crate::scene::{Bounds, Segment, WallId, Walls};

/// Overlaps up to this depth are no mistake but rounding, in metres: the skin of the contact rule.
const SKIN: f64 = 1e-6;

/// Warns, in the sim file `file`, about each of the `robots` that starts in a wall or in a robot named before it.
pub(super) fn check(file: &str, world: &WorldSpec, robots: &[RobotSpec]) -> Vec<Diagnostic> {
    let mut sink = Sink::new(file);
    let walls = Walls::new(world.walls.iter().map(|wall| Segment::new(wall.from, wall.to)).collect());
    let thickest = world.walls.iter().map(|wall| wall.thickness).fold(0.0, f64::max);
    for robot in robots {
        let (centre, radius) = (robot.start.position, 0.5 * robot.robi.diameter);
        let mut touched: Option<WallId> = None;
        walls.for_each_in(Bounds::of_disc(centre, radius + 0.5 * thickest), |id, segment| {
            let reach = radius + 0.5 * world.walls[id.0 as usize].thickness - SKIN;
            if touched.is_none() && segment.distance(centre) < reach {
                touched = Some(id);
            }
        });
        if let Some(id) = touched {
            let line = world.walls[id.0 as usize].span.line;
            let message = format!("{} starts inside the wall in line {line} of `{}`", robot.id, world.file);
            let diameter = robot.robi.diameter * 1000.0;
            let expected = format!("a start with room for a body of {diameter} mm");
            sink.warn(Code::SimStartWall, robot.span, message, expected);
        }
    }
    for (robot, other) in overlaps(robots) {
        let message = format!("{} starts inside {}", robot.id, other.id);
        sink.warn(Code::SimStartOverlap, robot.span, message, "starts at least both radii apart");
    }
    sink.finish()
}

/// Each robot that overlaps one before it in the list, with the first such, in the order of the list.
fn overlaps(robots: &[RobotSpec]) -> impl Iterator<Item = (&RobotSpec, &RobotSpec)> {
    let widest = robots.iter().map(|robot| robot.robi.diameter).fold(0.0, f64::max);
    let mut by_x: Vec<usize> = (0..robots.len()).collect();
    by_x.sort_by(|&a, &b| robots[a].start.position.x.total_cmp(&robots[b].start.position.x));
    let mut first: Vec<Option<usize>> = vec![None; robots.len()];
    for (place, &i) in by_x.iter().enumerate() {
        for &j in &by_x[place + 1..] {
            let (a, b) = (&robots[i], &robots[j]);
            let apart = b.start.position - a.start.position;
            if apart.x > widest {
                break;
            }
            if apart.length() < 0.5 * (a.robi.diameter + b.robi.diameter) - SKIN {
                let (earlier, later) = (i.min(j), i.max(j));
                first[later] = Some(first[later].map_or(earlier, |known| known.min(earlier)));
            }
        }
    }
    robots.iter().zip(first).filter_map(|(robot, first)| Some((robot, &robots[first?])))
}
