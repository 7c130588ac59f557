//! Check of start positions: a robot that starts inside a wall or another body never moves.

use glam::DVec2;

use super::Span;
use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::spec::{Collider, ObjectSpec, ObjectType, SceneSpec, WorldSpec};
use sim_core::RobotId;
use sim_core::scene::{Bounds, BoundsIndex, Segment, Walls};

/// Depth up to which an overlap counts as rounding, in metres: the skin of the contact rule.
const SKIN: f64 = 1e-6;

/// Robot or object, represented by a disc within its body, so that no false overlap is reported.
struct Body {
    what: String,
    is_robot: bool,
    /// The body is fixed; it may overlap a wall.
    is_fixed: bool,
    centre: DVec2,
    radius: f64,
    /// Span of the line that places the body. `is_of_sim` is true if that line belongs to the sim file.
    span: Span,
    is_of_sim: bool,
}

/// Warns about each robot and object of `scene` that starts off the floor, in a wall, or in a body that is listed before it. The
/// first `of_world` objects come from the world's file.
pub(super) fn check(scene: &SceneSpec, of_world: usize) -> Vec<Diagnostic> {
    let mut sinks = [Sink::new(&scene.world.file), Sink::new(&scene.file)];
    let bodies = bodies(scene, of_world);
    let outside = outside(&scene.world, &bodies);
    let walls = in_walls(&scene.world, &bodies);
    let others = overlaps(&bodies);
    for (((body, is_outside), wall), other) in bodies.iter().zip(outside).zip(walls).zip(others) {
        let sink = &mut sinks[usize::from(body.is_of_sim)];
        let room = format!("a place with room for a body of {} mm", (2e3 * body.radius).round());
        let codes = if body.is_robot {
            [Code::SimStartOutside, Code::SimStartWall, Code::SimStartOverlap]
        } else {
            [Code::SimObjectOutside, Code::SimObjectWall, Code::SimObjectOverlap]
        };
        if is_outside {
            let high = scene.world.bounds().1 * 1000.0;
            let message = format!("{} starts outside the floor", body.what);
            let expected = format!("x from 0 to {} and y from 0 to {} mm", high.x.round(), high.y.round());
            sink.warn(codes[0], body.span, message, expected);
        }
        if let Some(line) = wall {
            let wall = match line {
                0 => "a wall".to_owned(),
                line => format!("the wall in line {line} of `{}`", scene.world.file),
            };
            sink.warn(codes[1], body.span, format!("{} starts inside {wall}", body.what), room);
        }
        if let Some(other) = other {
            let message = format!("{} starts inside {}", body.what, bodies[other].what);
            sink.warn(codes[2], body.span, message, "places at least both radii apart");
        }
    }
    sinks.into_iter().flat_map(Sink::finish).collect()
}

/// Robots and objects: first those of the world, then those of the sim file in the order of their lines.
fn bodies(scene: &SceneSpec, of_world: usize) -> Vec<Body> {
    let object = |(place, object): (usize, &ObjectSpec)| {
        let (offset, radius) = inner_disc(&object.kind)?;
        Some(Body {
            what: format!("`{}`", object.kind.name),
            is_robot: false,
            is_fixed: object.kind.is_fixed,
            centre: object.pose.transform_point(offset),
            radius,
            span: object.span,
            is_of_sim: place >= of_world,
        })
    };
    let robots = scene.robots.iter().map(|robot| Body {
        what: robot.id.to_string(),
        is_robot: true,
        is_fixed: false,
        centre: robot.start.position,
        radius: 0.5 * robot.robi.diameter,
        span: robot.span,
        is_of_sim: true,
    });
    let mut bodies: Vec<Body> = scene.objects.iter().enumerate().filter_map(object).chain(robots).collect();
    bodies.sort_by_key(|body| (body.is_of_sim, body.span));
    bodies
}

/// Centre and radius, in the object's frame, of the largest disc, seen from above, that fits into one collider.
fn inner_disc(kind: &ObjectType) -> Option<(DVec2, f64)> {
    let discs = kind.colliders.iter().map(|collider| match *collider {
        Collider::Box { centre, size } => (centre, 0.5 * size.x.min(size.y)),
        Collider::Sphere { centre, radius }
        | Collider::Capsule { centre, radius, .. }
        | Collider::Cylinder { centre, radius, .. } => (centre, radius),
    });
    let largest = discs.reduce(|a, b| if b.1 > a.1 { b } else { a });
    largest.map(|(centre, radius)| (centre.truncate(), radius))
}

/// For each body, true if its centre lies outside of the bounds of floor and walls.
fn outside(world: &WorldSpec, bodies: &[Body]) -> Vec<bool> {
    let (low, high) = world.bounds();
    let is_outside = |body: &Body| body.centre.cmplt(low - SKIN).any() || body.centre.cmpgt(high + SKIN).any();
    // The bounds of a world that could not be read are empty.
    bodies.iter().map(|body| low != high && is_outside(body)).collect()
}

/// For each body, the line of the first wall (in the order of the walls) that it overlaps.
fn in_walls(world: &WorldSpec, bodies: &[Body]) -> Vec<Option<u32>> {
    let walls = Walls::new(world.walls.iter().map(|wall| Segment::new(wall.from, wall.to)).collect());
    let thickest = world.walls.iter().map(|wall| wall.thickness).fold(0.0, f64::max);
    let wall_of = |body: &Body| {
        let mut touched = None;
        walls.for_each_in(Bounds::of_disc(body.centre, body.radius + 0.5 * thickest), |id, segment| {
            let wall = &world.walls[id.0 as usize];
            let reach = body.radius + 0.5 * wall.thickness - SKIN;
            if touched.is_none() && segment.distance(body.centre) < reach {
                touched = Some(wall.span.line);
            }
        });
        touched
    };
    bodies.iter().map(|body| if body.is_fixed { None } else { wall_of(body) }).collect()
}

/// For each body, the first earlier body that it overlaps, unless both are fixed.
fn overlaps(bodies: &[Body]) -> Vec<Option<usize>> {
    let mut index = BoundsIndex::default();
    let bounds = bodies.iter().enumerate();
    let bounds = bounds.map(|(i, body)| (RobotId::from_index(i), Bounds::of_disc(body.centre, body.radius)));
    index.rebuild(&bounds.collect::<Vec<_>>());
    let mut first: Vec<Option<usize>> = vec![None; bodies.len()];
    index.pairs(|a, b| {
        let (a, b) = (a.index(), b.index());
        let [one, other] = [&bodies[a], &bodies[b]];
        let apart = (one.centre - other.centre).length();
        if first[b].is_none() && !(one.is_fixed && other.is_fixed) && apart < one.radius + other.radius - SKIN {
            first[b] = Some(a);
        }
    });
    first
}
