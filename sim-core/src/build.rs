//! From specs to the things that are simulated.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use crate::drive::Model;
use crate::format::{Axis, Collider, ObjectSpec, RobiSpec, SceneSpec, WorldSpec};
use crate::object::{Part, Properties, Resistance, Shape};
use crate::pose::Pose;
use crate::scene::{Segment, Walls};

/// Friction of an object against walls, robots and other objects. Source: our choice.
const CONTACT_FRICTION: f64 = 0.3;

/// The static walls of a world; a wall with a thickness becomes the four sides of its rectangle.
pub fn walls(world: &WorldSpec) -> Arc<Walls> {
    let (segments, heights) = segments(world);
    Arc::new(Walls::new(segments).with_heights(heights))
}

/// All of a scene that never moves: the walls of its world, then the outlines of its fixed objects.
///
/// Each outline is as high as the object's part. In place of a circle stands a regular polygon of 64 sides around it, see [`Shape::outline`].
pub fn obstacles(scene: &SceneSpec) -> Arc<Walls> {
    let (mut segments, mut heights) = segments(&scene.world);
    for object in scene.objects.iter().filter(|object| object.kind.is_fixed) {
        // An object without a shape has one part all the same.
        let tops = object.kind.colliders.iter().map(Collider::top).chain([f64::INFINITY]);
        for (corners, top) in properties(object).outlines(&object.pose).into_iter().zip(tops) {
            let next = corners.iter().cycle().skip(1);
            segments.extend(corners.iter().zip(next).map(|(a, b)| Segment::new(*a, *b)));
            heights.resize(segments.len(), top);
        }
    }
    Arc::new(Walls::new(segments).with_heights(heights))
}

/// The objects of a scene that can be moved: their numbers count from 1 on in this order.
pub fn movable(scene: &SceneSpec) -> impl Iterator<Item = &ObjectSpec> {
    scene.objects.iter().filter(|object| !object.kind.is_fixed)
}

/// The mass, the footprint and the friction of an object.
///
/// A sphere and a standing capsule or cylinder are discs, a lying capsule is its silhouette. An object without a shape is
/// a disc of 1 mm.
pub fn properties(object: &ObjectSpec) -> Arc<Properties> {
    let kind = &object.kind;
    let mut parts: Vec<Part> = kind.colliders.iter().map(part).collect();
    if parts.is_empty() {
        parts.push(Part { shape: Shape::Disc { radius: 1e-3 }, object_from_part: Pose::default() });
    }
    Arc::new(Properties {
        mass: kind.mass,
        centre_of_mass: kind.centre_of_mass.truncate(),
        parts,
        resistance: kind.rolling.map_or(Resistance::Sliding(object.friction), Resistance::Rolling),
        restitution: kind.restitution,
        contact_friction: CONTACT_FRICTION,
    })
}

/// The footprint of a collider.
fn part(collider: &Collider) -> Part {
    let disc = |radius| (Shape::Disc { radius }, 0.0);
    let (centre, (shape, phi)) = match *collider {
        Collider::Box { centre, size } => (centre, (Shape::Rectangle { half: size.truncate() * 0.5 }, 0.0)),
        Collider::Sphere { centre, radius } | Collider::Cylinder { centre, radius, .. } => (centre, disc(radius)),
        Collider::Capsule { centre, radius, axis: Axis::Z, .. } => (centre, disc(radius)),
        Collider::Capsule { centre, radius, height, axis } => {
            let half_length = 0.5 * height - radius;
            let lying = Shape::Capsule { half_length, radius };
            let phi = if axis == Axis::Y { FRAC_PI_2 } else { 0.0 };
            (centre, if half_length > 0.0 { (lying, phi) } else { disc(radius) })
        }
    };
    Part { shape, object_from_part: Pose::new(centre.x, centre.y, phi) }
}

/// The walls of a world, and the height of each.
fn segments(world: &WorldSpec) -> (Vec<Segment>, Vec<f64>) {
    let mut segments = Vec::with_capacity(world.walls.len());
    let mut heights = Vec::with_capacity(world.walls.len());
    for wall in &world.walls {
        if wall.thickness > 0.0 {
            segments.extend(Segment { a: wall.from, b: wall.to }.thickened(wall.thickness));
        } else {
            segments.push(Segment { a: wall.from, b: wall.to });
        }
        heights.resize(segments.len(), wall.height);
    }
    (segments, heights)
}

/// The drive and the body of a robot type.
pub fn model(robi: &RobiSpec) -> Model {
    Model {
        kind: robi.drive.kind,
        wheel_diameter: robi.wheel.diameter,
        max_wheel_rate: robi.wheel.max_rate,
        ticks_per_turn: robi.wheel.ticks_per_turn,
        track: robi.wheel.track,
        wheelbase: robi.drive.wheelbase,
        axis_offset: robi.axis_offset,
        max_speed: robi.max_speed,
        max_turn: robi.max_turn,
        body_radius: robi.diameter / 2.0,
        wheel_lag: robi.drive.wheel_lag,
        max_steering: robi.drive.max_steer,
        mass: robi.mass,
        traction: robi.traction,
    }
}
