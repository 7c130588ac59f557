//! Rigid bodies of a scene's objects, and their time steps.

mod energy;
mod friction;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;
use rapier2d_f64::dynamics::{
    CoefficientCombineRule, LockedAxes, MassProperties, RigidBodyBuilder, RigidBodyHandle, SpringCoefficients,
};
use rapier2d_f64::geometry::{ColliderBuilder, ColliderHandle, ContactPair, Group, InteractionGroups};
use rapier2d_f64::math::{Pose as RigidPose, Rotation, Vector};
use rapier2d_f64::pipeline::PhysicsWorld;

use super::{ObjectContact, Properties, Push, Pusher, STEP, Shape, State, floor::Velocity};
use crate::{
    ObjectId, RobotId,
    pose::{Heading, Pose},
    scene::Walls,
    time::Time,
};
use energy::IslandBody;
use friction::split;

/// One object.
#[derive(Clone)]
struct ObjectBody {
    properties: Arc<Properties>,
    gyration_squared: f64,
    handle: RigidBodyHandle,
    heading: Heading,
    is_held: bool,
    /// Last state of the object if it was removed from the world.
    final_state: Option<State>,
}

/// Objects and walls of a scene as rigid bodies.
pub struct Bodies {
    world: PhysicsWorld,
    /// Objects in the order of their ids.
    objects: Vec<ObjectBody>,
    robots: BTreeMap<RobotId, RigidBodyHandle>,
    /// Robots that are enabled in the world, in ascending order.
    present: Vec<RobotId>,
    awake: Vec<Awake>,
    /// Owner of each rigid body, indexed by the index of its handle.
    owners: Vec<Owner>,
    /// Length of a step, s.
    step: f64,
}

/// An object that is awake at the start of the step.
struct Awake {
    index: usize,
    /// Loss of speed by floor friction after the solver's step, m/s.
    loss_after: f64,
    /// For an object that is pushed from rest: the direction of the push, and the object's pose before the step.
    pushed: Option<(DVec2, RigidPose)>,
}

/// Entity that a rigid body represents.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    Wall,
    Object(usize),
    Robot(RobotId),
}

const WALLS: Group = Group::GROUP_1;
const OBJECTS: Group = Group::GROUP_2;
const ROBOTS: Group = Group::GROUP_3;

/// Time at rest after which an object falls asleep, s.
const TIME_UNTIL_SLEEP: f64 = 0.02;

impl Bodies {
    /// True, because this build has rigid bodies: the feature `objects` is on.
    pub const ARE_BUILT: bool = true;

    /// Creates the bodies of `walls` and of objects at rest at the given poses; the ids of the objects are 1, 2, ...
    pub fn new(walls: &Walls, objects: impl IntoIterator<Item = (Arc<Properties>, Pose)>) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let parameters = &mut world.integration_parameters;
        // With these spring coefficients, penetrations of robots and crates are resolved within a few ms; the default
        // values would need a tenth of a second.
        parameters.contact_softness = SpringCoefficients::new(240.0, 10.0);
        parameters.static_contact_softness = SpringCoefficients::new(480.0, 10.0);
        parameters.normalized_allowed_linear_error = 1e-5;
        parameters.normalized_max_corrective_velocity = 1.0;
        // Contacts are computed again in each step, since recycled contacts may have errors of several mm.
        parameters.contact_recycling = false;
        let mut bodies = Self {
            world,
            objects: Vec::new(),
            robots: BTreeMap::new(),
            present: Vec::new(),
            awake: Vec::new(),
            owners: Vec::new(),
            step: 0.0,
        };
        bodies.set_step(STEP);
        bodies.insert_walls(walls);
        for (properties, pose) in objects {
            bodies.add(properties, pose);
        }
        bodies
    }

    /// Adds an object at rest and awake; returns its id, the next free id.
    pub fn add(&mut self, properties: Arc<Properties>, pose: Pose) -> ObjectId {
        self.insert_object(properties, pose);
        ObjectId::from_index(self.objects.len() - 1)
    }

    /// Removes an object from the world and keeps its last state.
    pub fn remove(&mut self, object: ObjectId) {
        let state = self.state(object);
        let object_body = &mut self.objects[object.index()];
        if object_body.final_state.replace(state).is_none() {
            self.world.remove_body(object_body.handle);
        }
    }

    /// Removes the body of a robot from the world, if there is one.
    pub fn remove_robot(&mut self, robot: RobotId) {
        self.present.retain(|present| *present != robot);
        if let Some(handle) = self.robots.remove(&robot) {
            self.world.remove_body(handle);
        }
    }

    /// Returns true if an object has been removed from the world.
    pub fn is_removed(&self, object: ObjectId) -> bool {
        self.objects[object.index()].final_state.is_some()
    }

    fn insert_walls(&mut self, walls: &Walls) {
        let ground = self.world.insert_body(RigidBodyBuilder::fixed());
        self.set_owner(ground, Owner::Wall);
        for wall in walls.segments() {
            if !(wall.a.is_finite() && wall.b.is_finite()) {
                continue;
            }
            let collider = ColliderBuilder::segment(vector(wall.a), vector(wall.b))
                .restitution(1.0)
                .restitution_combine_rule(CoefficientCombineRule::Min)
                .friction(1.0)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(groups(WALLS, OBJECTS));
            self.world.insert_collider(collider, Some(ground));
        }
    }

    fn insert_object(&mut self, properties: Arc<Properties>, pose: Pose) {
        let mass = MassProperties::new(vector(properties.centre_of_mass), properties.mass, properties.inertia());
        let body = RigidBodyBuilder::dynamic()
            .pose(rigid_pose(&pose))
            .additional_mass_properties(mass)
            .ccd_enabled(true)
            .can_sleep(true);
        let handle = self.world.insert_body(body);
        let activation = self.world.bodies[handle].activation_mut();
        activation.normalized_linear_threshold = 1e-9;
        activation.angular_threshold = 1e-9;
        activation.time_until_sleep = TIME_UNTIL_SLEEP;
        for part in &properties.parts {
            let shape = match part.shape {
                Shape::Disc { radius } => ColliderBuilder::ball(radius),
                Shape::Rectangle { half } => ColliderBuilder::cuboid(half.x, half.y),
                Shape::Capsule { half_length, radius } => ColliderBuilder::capsule_x(half_length, radius),
            };
            let collider = shape
                .position(rigid_pose(&part.object_from_part))
                .density(0.0)
                .restitution(properties.restitution)
                .restitution_combine_rule(CoefficientCombineRule::Min)
                .friction(properties.contact_friction)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(groups(OBJECTS, Group::ALL));
            self.world.insert_collider(collider, Some(handle));
        }
        self.set_owner(handle, Owner::Object(self.objects.len()));
        let gyration_squared = properties.gyration_squared();
        self.objects.push(ObjectBody {
            properties,
            gyration_squared,
            handle,
            heading: pose.heading,
            is_held: false,
            final_state: None,
        });
    }

    fn set_owner(&mut self, handle: RigidBodyHandle, owner: Owner) {
        let index = handle.into_raw_parts().0 as usize;
        self.owners.resize(self.owners.len().max(index + 1), Owner::Wall);
        self.owners[index] = owner;
    }

    fn owner(&self, handle: RigidBodyHandle) -> Owner {
        self.owners[handle.into_raw_parts().0 as usize]
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Returns true if there are no objects.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// Constant properties of an object.
    pub fn properties(&self, object: ObjectId) -> &Arc<Properties> {
        &self.objects[object.index()].properties
    }

    /// Pose and velocity of an object; its last state if it was removed.
    pub fn state(&self, object: ObjectId) -> State {
        let object_body = &self.objects[object.index()];
        if let Some(state) = object_body.final_state {
            return state;
        }
        let body = &self.world.bodies[object_body.handle];
        State {
            world_from_object: Pose { position: plain(body.translation()), heading: object_body.heading },
            velocity: plain(body.linvel()),
            omega: body.angvel(),
        }
    }

    /// Sets the velocity of an object's centre of mass, m/s, and its turning speed, rad/s.
    pub fn set_velocity(&mut self, object: ObjectId, velocity: DVec2, omega: f64) {
        let handle = self.objects[object.index()].handle;
        let body = &mut self.world.bodies[handle];
        body.set_linvel(vector(velocity), true);
        body.set_angvel(omega, true);
    }

    /// Places an object at `world_from_object`, at rest and awake.
    pub fn place(&mut self, object: ObjectId, world_from_object: Pose) {
        let object_body = &mut self.objects[object.index()];
        object_body.heading = world_from_object.heading;
        let body = &mut self.world.bodies[object_body.handle];
        body.set_position(rigid_pose(&world_from_object), true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(0.0, true);
    }

    /// Returns true if an object is asleep or removed. An object falls asleep after some time at rest, and wakes when
    /// it is pushed, placed or given a velocity.
    pub fn is_asleep(&self, object: ObjectId) -> bool {
        let object_body = &self.objects[object.index()];
        object_body.final_state.is_some() || self.world.bodies[object_body.handle].is_sleeping()
    }

    /// Objects that are awake, in ascending order.
    pub fn awake(&self) -> impl Iterator<Item = ObjectId> + '_ {
        (0..self.objects.len()).map(ObjectId::from_index).filter(|&object| !self.is_asleep(object))
    }

    /// Kinetic energy of all objects, J.
    pub fn energy(&self) -> f64 {
        let body_energy = |object_body: &ObjectBody| {
            let body = &self.world.bodies[object_body.handle];
            let inertia = object_body.properties.mass * object_body.gyration_squared;
            0.5 * (object_body.properties.mass * plain(body.linvel()).length_squared()
                + inertia * body.angvel() * body.angvel())
        };
        self.objects.iter().filter(|object_body| object_body.final_state.is_none()).map(body_energy).sum()
    }

    /// Sets the length of a step, for studies of its effect on the error; the default is [`STEP`].
    ///
    /// # Panics
    /// If `step` is not positive.
    pub fn set_step(&mut self, step: Time) {
        assert!(step > Time::ZERO, "a step is positive, this one is {step}");
        self.step = step.seconds();
        let parameters = &mut self.world.integration_parameters;
        parameters.dt = self.step;
        parameters.min_ccd_dt = 0.01 * self.step;
    }

    /// Advances by one step with the given `robots`, in the order of their ids. Writes the effect on each robot to
    /// `pushes`, in the same order.
    pub fn step(&mut self, robots: &[Pusher], pushes: &mut Vec<Push>) {
        self.place_robots(robots);
        let mut velocities_before = self.velocities();
        self.apply_friction_before();
        self.update_after_friction(&mut velocities_before);
        self.world.step();
        self.limit_energy(&velocities_before);
        self.apply_friction_after();
        self.update_headings();
        pushes.clear();
        pushes.extend(robots.iter().map(|robot| self.push_of(robot.robot)));
    }

    /// Places the bodies of `robots` and disables the bodies of all other robots.
    fn place_robots(&mut self, robots: &[Pusher]) {
        for &robot in &self.present {
            if robots.binary_search_by_key(&robot, |pusher| pusher.robot).is_err() {
                self.world.bodies[self.robots[&robot]].set_enabled(false);
            }
        }
        self.present.clear();
        for pusher in robots {
            self.present.push(pusher.robot);
            if !self.robots.contains_key(&pusher.robot) {
                self.insert_robot(pusher);
            }
            let body = &mut self.world.bodies[self.robots[&pusher.robot]];
            if !body.is_enabled() {
                body.set_enabled(true);
            }
            let pose = RigidPose::from_translation(vector(pusher.centre));
            if *body.position() != pose {
                body.set_position(pose, true);
            }
            let locked = if pusher.is_immovable { LockedAxes::all() } else { LockedAxes::empty() };
            if body.locked_axes() != locked {
                body.set_locked_axes(locked, true);
            }
            let (velocity, omega) =
                if pusher.is_immovable { (DVec2::ZERO, 0.0) } else { (pusher.velocity, pusher.omega) };
            let wakes = velocity != DVec2::ZERO || omega != 0.0;
            body.set_linvel(vector(velocity), wakes);
            body.set_angvel(omega, wakes);
        }
    }

    fn insert_robot(&mut self, pusher: &Pusher) {
        let inertia = 0.5 * pusher.mass * pusher.radius * pusher.radius;
        let body = RigidBodyBuilder::dynamic()
            .translation(vector(pusher.centre))
            .additional_mass_properties(MassProperties::new(Vector::ZERO, pusher.mass, inertia));
        let handle = self.world.insert_body(body);
        let activation = self.world.bodies[handle].activation_mut();
        activation.normalized_linear_threshold = 1e-9;
        activation.angular_threshold = 1e-9;
        activation.time_until_sleep = TIME_UNTIL_SLEEP;
        let collider = ColliderBuilder::ball(pusher.radius)
            .density(0.0)
            .restitution(1.0)
            .restitution_combine_rule(CoefficientCombineRule::Min)
            .friction(1.0)
            .friction_combine_rule(CoefficientCombineRule::Min)
            .collision_groups(groups(ROBOTS, OBJECTS));
        self.world.insert_collider(collider, Some(handle));
        self.set_owner(handle, Owner::Robot(pusher.robot));
        self.robots.insert(pusher.robot, handle);
    }

    /// Applies the first part of floor friction, and locks the objects that static friction keeps at rest.
    fn apply_friction_before(&mut self) {
        self.awake.clear();
        for index in 0..self.objects.len() {
            let object_body = &self.objects[index];
            if object_body.final_state.is_some() {
                continue;
            }
            let body = &self.world.bodies[object_body.handle];
            if body.is_sleeping() {
                if self.objects[index].is_held {
                    self.set_held(index, false);
                }
                continue;
            }
            let loss = object_body.properties.resistance.deceleration() * self.step;
            let velocity = velocity_of(body);
            let gyration_squared = object_body.gyration_squared;
            let (loss_before, mut loss_after) = split(velocity.sliding_speed(gyration_squared), loss);
            let mut pushed = None;
            let mut is_held = false;
            if velocity == Velocity::ZERO {
                let push = self.possible_push(index) / object_body.properties.mass;
                let strength = push.length();
                // An object on which no body pushes is not locked, because the solver may have to move it out of a
                // wall.
                is_held = strength > 0.0 && strength <= loss;
                if strength > loss {
                    // The whole friction is applied before the solver's step, so that it acts against the push and not
                    // only against the resulting motion.
                    pushed = Some((push / strength, *body.position()));
                    loss_after = 0.0;
                }
            }
            let body = &mut self.world.bodies[object_body.handle];
            if let Some((direction, _)) = pushed {
                body.set_linvel(vector(-direction * loss), false);
            } else if loss_before > 0.0 {
                set_velocity(body, velocity.slowed(loss_before, gyration_squared));
            }
            if self.objects[index].is_held != is_held {
                self.set_held(index, is_held);
            }
            self.awake.push(Awake { index, loss_after, pushed });
        }
    }

    fn set_held(&mut self, index: usize, is_held: bool) {
        let object_body = &mut self.objects[index];
        object_body.is_held = is_held;
        let locked = if is_held { LockedAxes::all() } else { LockedAxes::empty() };
        self.world.bodies[object_body.handle].set_locked_axes(locked, false);
    }

    /// Estimate of the impulse that the neighbours of an object at rest exert on it in the next step, N s, without
    /// friction.
    ///
    /// If this impulse is smaller than the impulse of friction in a step, the object stays at rest. An example is a
    /// crate that a robot with too little traction pushes.
    fn possible_push(&self, index: usize) -> DVec2 {
        let object_body = &self.objects[index];
        let mut push = DVec2::ZERO;
        for &collider in self.world.bodies[object_body.handle].colliders() {
            for pair in self.world.narrow_phase.contact_pairs_with(collider) {
                push += self.possible_impulse(pair, collider, object_body.properties.restitution);
            }
        }
        push
    }

    /// Estimate of the impulse, N s, that the body of `collider`, which is at rest, receives in the next step from the
    /// other body of a contact pair.
    fn possible_impulse(&self, pair: &ContactPair, collider: ColliderHandle, restitution: f64) -> DVec2 {
        let is_first = pair.collider1 == collider;
        let other = if is_first { pair.collider2 } else { pair.collider1 };
        // The narrow phase may still contain pairs of a body that was removed after the last step.
        let Some(parent) = self.world.colliders.get(other).and_then(|other| other.parent()) else { return DVec2::ZERO };
        let body = &self.world.bodies[parent];
        if body.is_fixed() || body.locked_axes() == LockedAxes::all() {
            return DVec2::ZERO;
        }
        let mut strongest = (0.0, DVec2::ZERO);
        for manifold in pair.manifolds() {
            // The normal points from the first body to the second one; `towards` points to the object at rest.
            let towards = if is_first { -manifold.data.normal } else { manifold.data.normal };
            for point in &manifold.points {
                let world_from_other = self.world.colliders[other].position();
                let local = if is_first { point.local_p2 } else { point.local_p1 };
                let position = world_from_other.transform_point(local);
                let approach = body.velocity_at_point(position).dot(towards);
                let is_new = point.data.impulse == 0.0;
                // `dist` is the distance before the last step.
                if 3.0 * approach * self.step >= point.dist {
                    let bounce = if is_new { restitution } else { 0.0 };
                    let impulse = body.mass() * approach * (1.0 + bounce);
                    if impulse > strongest.0 {
                        strongest = (impulse, plain(towards) * impulse);
                    }
                }
            }
        }
        strongest.1
    }

    /// Applies the second part of floor friction.
    fn apply_friction_after(&mut self) {
        for Awake { index, loss_after, pushed } in &self.awake {
            let object_body = &self.objects[*index];
            let body = &mut self.world.bodies[object_body.handle];
            let velocity = velocity_of(body);
            if let Some((direction, pose)) = pushed
                && velocity.linear.dot(*direction) <= 0.0
            {
                // The expected push did not occur, or friction was stronger.
                body.set_position(*pose, false);
                set_velocity(body, Velocity::ZERO);
            } else if *loss_after > 0.0 && velocity != Velocity::ZERO {
                set_velocity(body, velocity.slowed(*loss_after, object_body.gyration_squared));
            }
        }
    }

    /// Updates the headings of the objects, including whole turns.
    fn update_headings(&mut self) {
        for object_body in self.objects.iter_mut().filter(|object_body| object_body.final_state.is_none()) {
            let body = &self.world.bodies[object_body.handle];
            if !body.is_sleeping() {
                let angle = crate::math::atan2(body.rotation().sin(), body.rotation().cos());
                let turned = Heading::new(angle - object_body.heading.remainder()).remainder();
                object_body.heading = object_body.heading.turned(turned);
            }
        }
    }

    /// Velocities of all bodies, indexed by the index of their handles.
    fn velocities(&self) -> Vec<Velocity> {
        let mut velocities = vec![Velocity::ZERO; self.owners.len()];
        for (handle, body) in self.world.bodies.iter() {
            velocities[handle.into_raw_parts().0 as usize] = velocity_of(body);
        }
        velocities
    }

    /// Updates `velocities` after the first part of friction, except for objects whose velocity represents friction
    /// against a push.
    fn update_after_friction(&self, velocities: &mut [Velocity]) {
        for awake in self.awake.iter().filter(|awake| awake.pushed.is_none()) {
            let handle = self.objects[awake.index].handle;
            velocities[handle.into_raw_parts().0 as usize] = velocity_of(&self.world.bodies[handle]);
        }
    }

    /// Removes the energy that the step has added to each island of touching bodies.
    fn limit_energy(&mut self, velocities_before: &[Velocity]) {
        let mut islands = Islands::new(self.owners.len());
        for pair in self.world.narrow_phase.contact_pairs() {
            if !pair.has_any_active_contact() {
                continue;
            }
            let parent = |collider| self.world.colliders.get(collider).and_then(|collider| collider.parent());
            let (Some(a), Some(b)) = (parent(pair.collider1), parent(pair.collider2)) else { continue };
            let index = |handle: RigidBodyHandle| handle.into_raw_parts().0 as usize;
            match (self.is_movable(a), self.is_movable(b)) {
                (true, true) => islands.join(index(a), index(b)),
                (true, false) => islands.hold(index(a)),
                (false, true) => islands.hold(index(b)),
                (false, false) => {}
            }
        }
        let mut members: BTreeMap<usize, (Vec<RigidBodyHandle>, Vec<IslandBody>, f64)> = BTreeMap::new();
        for (handle, body) in self.world.bodies.iter() {
            if !self.is_movable(handle) || body.is_sleeping() || !body.is_enabled() {
                continue;
            }
            let index = handle.into_raw_parts().0 as usize;
            let member = IslandBody {
                mass: body.mass(),
                inertia: self.inertia(handle),
                centre: plain(body.center_of_mass()),
                velocity: velocity_of(body),
            };
            let island = members.entry(islands.find(index)).or_default();
            island.0.push(handle);
            island.1.push(member);
            island.2 += IslandBody { velocity: velocities_before[index], ..member }.energy();
        }
        for (root, (handles, mut island, limit)) in members {
            let energy: f64 = island.iter().map(IslandBody::energy).sum();
            if energy > limit {
                energy::limit(&mut island, limit, islands.is_held(root));
                for (handle, member) in handles.iter().zip(&island) {
                    set_velocity(&mut self.world.bodies[*handle], member.velocity);
                }
            }
        }
    }

    /// Returns true if a step can move the body.
    fn is_movable(&self, handle: RigidBodyHandle) -> bool {
        let body = &self.world.bodies[handle];
        body.is_dynamic() && body.locked_axes().is_empty()
    }

    fn inertia(&self, handle: RigidBodyHandle) -> f64 {
        match self.owner(handle) {
            Owner::Object(index) => self.objects[index].properties.mass * self.objects[index].gyration_squared,
            _ => {
                let inverse = self.world.bodies[handle].mass_properties().local_mprops.inv_principal_inertia;
                if inverse > 0.0 { 1.0 / inverse } else { 0.0 }
            }
        }
    }

    /// Effect of the step on a robot.
    fn push_of(&self, robot: RobotId) -> Push {
        let body = &self.world.bodies[self.robots[&robot]];
        let mut contact: Option<ObjectContact> = None;
        for &collider in body.colliders() {
            for pair in self.world.narrow_phase.contact_pairs_with(collider) {
                let is_first = pair.collider1 == collider;
                let other = if is_first { pair.collider2 } else { pair.collider1 };
                let impulse = pair.total_impulse();
                let Some(parent) = self.world.colliders.get(other).and_then(|other| other.parent()) else { continue };
                let Owner::Object(index) = self.owner(parent) else { continue };
                let strength = impulse.length();
                if strength > 0.0 && contact.is_none_or(|strongest| strength > strongest.impulse) {
                    let direction = plain(impulse / strength) * if is_first { 1.0 } else { -1.0 };
                    contact = Some(ObjectContact { object: ObjectId::from_index(index), impulse: strength, direction });
                }
            }
        }
        Push { velocity: plain(body.linvel()), omega: body.angvel(), contact }
    }
}

impl Clone for Bodies {
    fn clone(&self) -> Self {
        let PhysicsWorld { islands, broad_phase, narrow_phase, bodies, colliders, .. } = &self.world;
        let world = PhysicsWorld {
            gravity: self.world.gravity,
            integration_parameters: self.world.integration_parameters,
            islands: islands.clone(),
            broad_phase: broad_phase.clone(),
            narrow_phase: narrow_phase.clone(),
            bodies: bodies.clone(),
            colliders: colliders.clone(),
            // Between steps the pipelines and the solver contain only buffers, so a new world with the copied state
            // gives the same results. Joints and soft bodies are not used.
            ..PhysicsWorld::new()
        };
        Self {
            world,
            objects: self.objects.clone(),
            robots: self.robots.clone(),
            present: self.present.clone(),
            awake: Vec::new(),
            owners: self.owners.clone(),
            step: self.step,
        }
    }
}

impl std::fmt::Debug for Bodies {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bodies").field("objects", &self.objects.len()).finish_non_exhaustive()
    }
}

/// Sets of bodies that touch each other, as a union-find structure.
struct Islands {
    parents: Vec<usize>,
    held: Vec<bool>,
}

impl Islands {
    fn new(count: usize) -> Self {
        Self { parents: (0..count).collect(), held: vec![false; count] }
    }

    fn find(&mut self, mut body: usize) -> usize {
        while self.parents[body] != body {
            self.parents[body] = self.parents[self.parents[body]];
            body = self.parents[body];
        }
        body
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        let (root, other) = (a.min(b), a.max(b));
        self.parents[other] = root;
        self.held[root] |= self.held[other];
    }

    fn hold(&mut self, body: usize) {
        let root = self.find(body);
        self.held[root] = true;
    }

    fn is_held(&mut self, body: usize) -> bool {
        let root = self.find(body);
        self.held[root]
    }
}

fn groups(memberships: Group, filter: Group) -> InteractionGroups {
    InteractionGroups { memberships, filter, ..InteractionGroups::default() }
}

fn vector(v: DVec2) -> Vector {
    Vector::new(v.x, v.y)
}

fn plain(v: Vector) -> DVec2 {
    DVec2::new(v.x, v.y)
}

fn rigid_pose(pose: &Pose) -> RigidPose {
    let direction = pose.heading.direction();
    RigidPose::from_parts(vector(pose.position), Rotation::from_cos_sin_unchecked(direction.x, direction.y))
}

fn velocity_of(body: &rapier2d_f64::dynamics::RigidBody) -> Velocity {
    Velocity { linear: plain(body.linvel()), omega: body.angvel() }
}

fn set_velocity(body: &mut rapier2d_f64::dynamics::RigidBody, velocity: Velocity) {
    body.set_linvel(vector(velocity.linear), false);
    body.set_angvel(velocity.omega, false);
}
