//! Movable objects: rigid bodies in the plane that robots can push and kick and that collide with each other.
//!
//! This module contains shapes, masses and friction. Motion advances in steps of [`STEP`] on the global grid of virtual
//! time. The library rapier solves the contacts. This module applies floor friction or rolling resistance before and
//! after each step of rapier, and removes energy that the step has added. It neither reads files nor computes how a
//! robot's drive reacts to a push: here, robots are discs with a velocity ([`Pusher`]).
//!
//! The solver is built with the feature `objects`. Without it, [`Bodies`] cannot be constructed, and scenes with
//! movable objects are rejected.

#[cfg(feature = "objects")]
mod bodies;
#[cfg(not(feature = "objects"))]
#[path = "no_bodies.rs"]
mod bodies;
mod floor;
mod push;
mod shape;
mod solid;
mod trajectory;

use glam::DVec2;

pub use bodies::Bodies;
pub use push::{ObjectContact, Push, Pusher};
pub use shape::Shape;
pub(crate) use shape::cast_disc;
pub use solid::{Figure, Solid, SurfaceHit};
pub use trajectory::ObjectTrajectory;

use crate::{pose::Pose, scene::Bounds, time::Time};

/// Time step of the rigid-body simulation. Our choice.
pub const STEP: Time = Time::from_millis(1);

/// Standard acceleration of gravity, m/s².
pub const GRAVITY: f64 = 9.80665;

/// Resistance of the floor to a moving object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resistance {
    /// The object slides: coefficient of Coulomb friction, 0 or more.
    Sliding(f64),
    /// The object rolls: deceleration as a fraction of gravity, 0 or more.
    Rolling(f64),
}

impl Resistance {
    /// Deceleration of an object that does not turn about its vertical axis, m/s².
    pub fn deceleration(self) -> f64 {
        let (Self::Sliding(coefficient) | Self::Rolling(coefficient)) = self;
        coefficient * GRAVITY
    }
}

/// A part of an object's footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Outline, in the part's frame.
    pub shape: Shape,
    /// Pose in the object's frame.
    pub object_from_part: Pose,
}

/// Constant properties of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Properties {
    /// Mass, kg; positive.
    pub mass: f64,
    /// Centre of mass in the object's frame, m.
    pub centre_of_mass: DVec2,
    /// The footprint; not empty.
    pub parts: Vec<Part>,
    /// Resistance of the floor.
    pub resistance: Resistance,
    /// Coefficient of restitution, 0 to 1; between two objects the smaller coefficient applies (our choice).
    pub restitution: f64,
    /// Coefficient of friction against walls, robots and other objects; between two objects the smaller coefficient
    /// applies (our choice).
    pub contact_friction: f64,
    /// Height of the object's frame above the floor, m; 0 unless the object floats. Contacts in the plane do not depend
    /// on it.
    pub lift: f64,
}

impl Properties {
    /// Square of the radius of gyration about the centre of mass, m², if all parts have the same mass per area.
    pub fn gyration_squared(&self) -> f64 {
        let mut area = 0.0;
        let mut moment = 0.0;
        for part in &self.parts {
            let arm_squared = (part.object_from_part.position - self.centre_of_mass).length_squared();
            area += part.shape.area();
            moment += part.shape.area() * (part.shape.gyration_squared() + arm_squared);
        }
        moment / area
    }

    /// Moment of inertia about the centre of mass, kg m².
    pub fn inertia(&self) -> f64 {
        self.mass * self.gyration_squared()
    }

    /// Maximum distance of a point of the footprint from the object's origin, m.
    pub fn reach(&self) -> f64 {
        let part_reach = |part: &Part| part.object_from_part.position.length() + part.shape.reach();
        self.parts.iter().map(part_reach).fold(0.0, f64::max)
    }

    /// Distance from `point`, in the object's frame, to the nearest point of the footprint, m; 0 inside.
    pub fn distance(&self, point: DVec2) -> f64 {
        let part_distance = |part: &Part| part.shape.distance(part.object_from_part.inverse_transform_point(point));
        self.parts.iter().map(part_distance).fold(f64::INFINITY, f64::min)
    }

    /// The bounding rectangle of the footprint of an object at `world_from_object`.
    pub fn bounds(&self, world_from_object: &Pose) -> Bounds {
        let part_bounds = |part: &Part| part.shape.bounds(&world_from_object.compose(&part.object_from_part));
        self.parts.iter().map(part_bounds).fold(Bounds::EMPTY, Bounds::union)
    }

    /// The outlines of the parts of an object at `world_from_object`: see [`Shape::outline`].
    pub fn outlines(&self, world_from_object: &Pose) -> Vec<Vec<DVec2>> {
        let part_outline = |part: &Part| {
            let world_from_part = world_from_object.compose(&part.object_from_part);
            part.shape.outline().into_iter().map(|corner| world_from_part.transform_point(corner)).collect()
        };
        self.parts.iter().map(part_outline).collect()
    }

    /// Distance along a ray to the footprint of an object at `world_from_object`, m: 0 if the ray starts inside, `None`
    /// if it misses the footprint.
    ///
    /// `origin` and the unit vector `direction` are in the world frame.
    pub fn cast(&self, world_from_object: &Pose, origin: DVec2, direction: DVec2) -> Option<f64> {
        let part_distance = |part: &Part| {
            let world_from_part = world_from_object.compose(&part.object_from_part);
            let axis = world_from_part.heading.direction();
            let part_from_world = DVec2::new(axis.x, -axis.y);
            let origin = part_from_world.rotate(origin - world_from_part.position);
            part.shape.cast(origin, part_from_world.rotate(direction))
        };
        self.parts.iter().filter_map(part_distance).min_by(f64::total_cmp)
    }
}

/// Pose and velocity of an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Pose of the object's frame.
    pub world_from_object: Pose,
    /// Velocity of the centre of mass, m/s.
    pub velocity: DVec2,
    /// Turning speed counter-clockwise, rad/s.
    pub omega: f64,
}

impl State {
    /// Returns true if the object does not move.
    pub fn is_resting(&self) -> bool {
        self.velocity == DVec2::ZERO && self.omega == 0.0
    }
}
