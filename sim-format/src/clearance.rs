//! Check of start positions: a robot that starts inside a wall or another body never moves.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Span;
use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::spec::{Collider, ObjectSpec, ObjectType, SceneSpec, WorldSpec};
use sim_core::scene::{Bounds, Segment, Walls};

/// Maximum depth of an overlap, in metres, that is ignored as rounding: the skin of contacts.
const SKIN: f64 = 1e-6;

/// Maximum number of objects that start inside one body. The physics of a pile takes time and memory with the square of
/// this number: our choice, which keeps a slot below a second.
const MAX_PILE: usize = 200;

/// Robot or object, represented by a disc within its body, so that false overlaps are never reported.
struct Body {
    name: String,
    is_robot: bool,
    /// True for a fixed body, which may overlap a wall.
    is_fixed: bool,
    centre: DVec2,
    radius: f64,
    /// Span of the line that places the body.
    span: Span,
    /// True if this line is in the sim file, not in the world's file.
    is_of_sim: bool,
}

/// Warns about each robot and object of `scene` that starts off the floor, in a wall, or in a body listed before it.
/// Reports an error if more than [`MAX_PILE`] objects start inside one body.
/// The first `world_object_count` objects come from the world's file.
pub(super) fn check(scene: &SceneSpec, world_object_count: usize) -> Vec<Diagnostic> {
    let mut sinks = [Sink::new(&scene.world.file), Sink::new(&scene.file)];
    let bodies = bodies(scene, world_object_count);
    let outside = outside(&scene.world, &bodies);
    let walls = overlapped_walls(&scene.world, &bodies);
    let others = overlapped_bodies(&bodies);
    let mut inside_counts = vec![0; bodies.len()];
    for (((body, is_outside), wall), other) in bodies.iter().zip(outside).zip(walls).zip(others) {
        let sink = &mut sinks[usize::from(body.is_of_sim)];
        let room = format!("a place with room for a body of {} mm", (2e3 * body.radius).round());
        let codes = if body.is_robot {
            [Code::SimStartOutside, Code::SimStartWall, Code::SimStartOverlap]
        } else {
            [Code::SimObjectOutside, Code::SimObjectWall, Code::SimObjectOverlap]
        };
        if is_outside {
            let high_mm = scene.world.bounds().1 * 1000.0;
            let message = format!("{} starts outside the floor", body.name);
            let expected = format!("x from 0 to {} and y from 0 to {} mm", high_mm.x.round(), high_mm.y.round());
            sink.warn(codes[0], body.span, message, expected);
        }
        if let Some(line) = wall {
            let wall = match line {
                0 => "a wall".to_owned(),
                line => format!("the wall in line {line} of `{}`", scene.world.file),
            };
            sink.warn(codes[1], body.span, format!("{} starts inside {wall}", body.name), room);
        }
        if let Some(other) = other {
            inside_counts[other] += usize::from(!body.is_robot);
            if inside_counts[other] == MAX_PILE + 1 && !body.is_robot {
                let message = format!("more than {MAX_PILE} objects start inside {}", bodies[other].name);
                sink.error(codes[2], body.span, message, "places at least both radii apart");
            }
            let message = format!("{} starts inside {}", body.name, bodies[other].name);
            sink.warn(codes[2], body.span, message, "places at least both radii apart");
        }
    }
    sinks.into_iter().flat_map(Sink::finish).collect()
}

/// Robots and objects: first the world's, then the sim file's in the order of their lines.
fn bodies(scene: &SceneSpec, world_object_count: usize) -> Vec<Body> {
    let object = |(index, object): (usize, &ObjectSpec)| {
        let (offset, radius) = inner_disc(&object.kind)?;
        Some(Body {
            name: format!("`{}`", object.kind.name),
            is_robot: false,
            is_fixed: object.kind.is_fixed,
            centre: object.pose.transform_point(offset),
            radius,
            span: object.span,
            is_of_sim: index >= world_object_count,
        })
    };
    let robots = scene.robots.iter().map(|robot| Body {
        name: robot.id.to_string(),
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
fn overlapped_walls(world: &WorldSpec, bodies: &[Body]) -> Vec<Option<u32>> {
    let walls = Walls::new(world.walls.iter().map(|wall| Segment::new(wall.from, wall.to)).collect());
    let max_thickness = world.walls.iter().map(|wall| wall.thickness).fold(0.0, f64::max);
    let first_wall = |body: &Body| {
        let mut touched = None;
        walls.for_each_in(Bounds::of_disc(body.centre, body.radius + 0.5 * max_thickness), |id, segment| {
            let wall = &world.walls[id.0 as usize];
            let contact_distance = body.radius + 0.5 * wall.thickness - SKIN;
            if touched.is_none() && segment.distance(body.centre) < contact_distance {
                touched = Some(wall.span.line);
            }
        });
        touched
    };
    bodies.iter().map(|body| if body.is_fixed { None } else { first_wall(body) }).collect()
}

/// For each body, the first earlier body that it overlaps, unless both are fixed.
fn overlapped_bodies(bodies: &[Body]) -> Vec<Option<usize>> {
    let mut grids = Grids::default();
    let find_first = |(index, body): (usize, &Body)| {
        let first = grids.first_overlap(bodies, body);
        grids.add(index, body);
        first
    };
    bodies.iter().enumerate().map(find_first).collect()
}

/// Earlier bodies by the cells of their centres. Bodies of similar size share a grid, whose cells are about as large as
/// the bodies.
///
/// The search stops at the first overlap, so the cost of a body does not depend on the number of bodies, even if all
/// are at the same position.
#[derive(Default)]
struct Grids(BTreeMap<i32, BTreeMap<[i64; 2], Vec<usize>>>);

impl Grids {
    /// Level of the grid for bodies with this radius: the binary exponent of the grid's maximum radius.
    fn level_of(radius: f64) -> i32 {
        let mut level = -30;
        while level < 60 && radius > max_radius(level) {
            level += 1;
        }
        level
    }

    fn cell(level: i32, point: DVec2) -> [i64; 2] {
        let cell = (point / (2.0 * max_radius(level))).floor();
        // The conversion saturates far outside of every world.
        [cell.x as i64, cell.y as i64]
    }

    fn add(&mut self, index: usize, body: &Body) {
        let level = Self::level_of(body.radius);
        self.0.entry(level).or_default().entry(Self::cell(level, body.centre)).or_default().push(index);
    }

    /// The first body that overlaps `body`, unless both are fixed.
    fn first_overlap(&self, bodies: &[Body], body: &Body) -> Option<usize> {
        let mut first: Option<usize> = None;
        for (level, grid) in &self.0 {
            let search_radius = DVec2::splat(body.radius + max_radius(*level));
            let [low, high] =
                [body.centre - search_radius, body.centre + search_radius].map(|point| Self::cell(*level, point));
            let mut search = |indices: &[usize]| {
                let mut earlier = indices.iter().take_while(|index| first.is_none_or(|first| **index < first));
                first = earlier.find(|index| overlap(&bodies[**index], body)).copied().or(first);
            };
            if high[0].abs_diff(low[0]) < grid.len() as u64 {
                let columns = (low[0]..=high[0]).flat_map(|x| grid.range([x, low[1]]..=[x, high[1]]));
                columns.for_each(|(_, indices)| search(indices));
            } else {
                grid.range(low..=high).for_each(|(_, indices)| search(indices));
            }
        }
        first
    }
}

/// Maximum radius, in metres, of the bodies in the grid of a level.
fn max_radius(level: i32) -> f64 {
    f64::from_bits(((level + 1023) as u64) << 52)
}

fn overlap(body: &Body, other: &Body) -> bool {
    let distance = (body.centre - other.centre).length();
    !(body.is_fixed && other.is_fixed) && distance < body.radius + other.radius - SKIN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_overlap_matches_plain_search() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let bodies: Vec<Body> = (0..600)
            .map(|_| Body {
                name: String::new(),
                is_robot: true,
                is_fixed: random() < 0.3,
                centre: DVec2::new(random() * 10.0 - 5.0, random() * 10.0 - 5.0),
                radius: 2.0 * random().powi(12) + 0.001,
                span: Span::default(),
                is_of_sim: true,
            })
            .collect();
        let plain = |index: usize| bodies[..index].iter().position(|earlier| overlap(earlier, &bodies[index]));
        let expected: Vec<_> = (0..bodies.len()).map(plain).collect();
        assert_eq!(overlapped_bodies(&bodies), expected);
        assert!((50..550).contains(&expected.iter().flatten().count()), "some overlap, others do not");
    }
}
