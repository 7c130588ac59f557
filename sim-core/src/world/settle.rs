//! Resolution of the contacts between bodies in a slot, in the order in which they happen.
//!
//! This is an event simulation of the true motions of the slot. When two discs touch and approach each other, each disc
//! whose velocity points towards the contact is stopped at that instant; then the later commands of the slot are
//! applied to it again. Each event stops a moving body, applies one command again, or advances the movable objects by
//! one step. Time never goes back, so the simulation ends.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::{World, objects::Objects, track::passages_bounds};
use crate::{
    RobotId,
    contact::{APPROACH, Body, MovingDisc, Obstacle, Path, TOUCH, Thing, first_touch},
    drive::{DriveState, Impact, Model, Motion, Passage, Passages},
    object::{GRAVITY, Pusher, STEP},
    parallel::{self, Pool},
    pose::Twist,
    scene::{Bounds, BoundsIndex},
    time::Time,
};

/// Value of [`TrueMotions::indices`] for a robot that is not active.
const PASSIVE: u32 = u32::MAX;

/// True motions of the robots in a slot. The memory is reused for the next slot.
#[derive(Clone, Debug, Default)]
pub(super) struct TrueMotions {
    /// For each robot, its index in the list of active motions, or [`PASSIVE`].
    indices: Vec<u32>,
    /// Number of active motions.
    count: usize,
    /// The `count` active motions, in the order of ids, then spare entries.
    slot_motions: Vec<SlotMotion>,
    /// For each active motion, its first contacts with passive bodies and with active bodies of higher ids.
    found_contacts: Vec<Vec<(RobotId, Instant)>>,
    /// Bounds of the active robots' bodies in the slot: input of the index.
    bounds: Vec<(RobotId, Bounds)>,
    /// Index of the bounds before any contact was resolved.
    index: BoundsIndex<RobotId>,
    /// Robots that may leave their bounds in the index, because their motion has changed.
    strays: BTreeSet<RobotId>,
    /// Memory that is reused for vectors of references.
    spare: Vec<[usize; 2]>,
}

/// True motion of an active robot in a slot, and results for the end of the slot.
#[derive(Clone, Debug)]
pub(super) struct SlotMotion {
    pub robot: RobotId,
    passages: Passages,
    /// Bounds of the body before any contact was resolved.
    bounds: Bounds,
    /// True if the centre of the body moves.
    is_moving: bool,
    /// True if a robot blocks the body.
    is_blocked: bool,
    /// The impacts of the slot, if the motion has been committed already.
    pub impacts: Option<Vec<Impact>>,
    /// Bounds of the motion published at the end of the slot, and true if the body's centre is at rest; `None` if these
    /// bounds have not been computed.
    pub published: Option<(Bounds, bool)>,
}

impl TrueMotions {
    /// The active motions, in the order of ids.
    pub fn active(&self) -> &[SlotMotion] {
        &self.slot_motions[..self.count]
    }

    /// The active motions, mutable.
    pub fn active_mut(&mut self) -> &mut [SlotMotion] {
        &mut self.slot_motions[..self.count]
    }

    /// The motion of an active robot.
    pub fn slot_motion(&self, robot: RobotId) -> Option<&SlotMotion> {
        let index = self.indices[robot.index()];
        (index != PASSIVE).then(|| &self.slot_motions[index as usize])
    }
}

impl Default for SlotMotion {
    fn default() -> Self {
        Self {
            robot: RobotId(0),
            passages: Passages::new(),
            bounds: Bounds::EMPTY,
            is_moving: false,
            is_blocked: false,
            impacts: None,
            published: None,
        }
    }
}

impl SlotMotion {
    /// Reads the motion from `start` to `end`.
    fn read(&mut self, motion: &mut Motion, start: Time, end: Time) {
        self.robot = motion.id();
        motion.passages(start, end, &mut self.passages);
        self.bounds = passages_bounds(&self.passages, start, end).grown(motion.radius() + TOUCH);
        self.is_moving = !self.passages.iter().all(|passage| passage.path.is_resting());
        self.is_blocked = motion.blocker().is_some();
        self.impacts = None;
        self.published = None;
    }
}

/// An event. The order of events at the same instant is: inputs, contacts, steps of the objects; events of the same
/// kind are ordered by ids.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// The entry with this index in the motion's list of inputs is applied again.
    Input(RobotId, usize),
    /// Two bodies touch and approach each other.
    Contact(RobotId, RobotId),
    /// A step of the movable objects begins.
    Step,
}

/// Seconds since the start of the slot, as a key with a total order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Instant(u64);

impl Instant {
    fn new(seconds: f64) -> Self {
        // Numbers of 0 or more have the same order as their bits.
        Self(seconds.max(0.0).to_bits())
    }

    fn seconds(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// Resolution of the events of one slot.
pub(super) struct ContactResolution<'a, 'm> {
    truth: &'a mut TrueMotions,
    world: &'a World,
    active: &'a mut [&'m mut Motion],
    start: Time,
    end: Time,
    events: BTreeSet<(Instant, Event)>,
    /// Instant of each queued contact. It is needed to remove the contact when the motion of one of its robots changes.
    contacts: BTreeMap<(RobotId, RobotId), Instant>,
    /// Robots that may come near movable objects in the slot.
    near_objects: BTreeSet<RobotId>,
    /// Robots whose plans have changed since `near_objects` was updated.
    changed: Vec<RobotId>,
}

impl<'a, 'm> ContactResolution<'a, 'm> {
    /// Reads the motions of the world's present slot; `active` must be in the order of ids.
    pub fn new(
        truth: &'a mut TrueMotions,
        world: &'a World,
        active: &'a mut [&'m mut Motion],
        pool: &dyn Pool,
    ) -> Self {
        let (start, end) = (world.slot_start(), world.slot_end());
        truth.slot_motions.resize_with(truth.slot_motions.len().max(active.len()), SlotMotion::default);
        truth.found_contacts.resize_with(truth.slot_motions.len(), Vec::new);
        let mut slot_motions: Vec<(&mut Motion, &mut SlotMotion)> = parallel::reuse(std::mem::take(&mut truth.spare));
        slot_motions.extend(active.iter_mut().map(|motion| &mut **motion).zip(&mut truth.slot_motions));
        pool.for_each(&mut slot_motions, |(motion, slot_motion)| slot_motion.read(motion, start, end));
        truth.spare = parallel::reuse(slot_motions);
        truth.count = active.len();
        truth.indices.clear();
        truth.indices.resize(world.tracks.len(), PASSIVE);
        for (index, slot_motion) in truth.slot_motions[..truth.count].iter().enumerate() {
            truth.indices[slot_motion.robot.index()] = index as u32;
        }
        Self {
            truth,
            world,
            active,
            start,
            end,
            events: BTreeSet::new(),
            contacts: BTreeMap::new(),
            near_objects: BTreeSet::new(),
            changed: Vec::new(),
        }
    }

    /// Resolves all contacts in the slot.
    pub fn run(&mut self, mut objects: Option<&mut Objects>, pool: &dyn Pool) {
        let has_contacts =
            self.world.tracks.len() > 1 && self.truth.active().iter().any(|slot_motion| slot_motion.is_moving);
        if let Some(objects) = &mut objects {
            objects.skip_to(self.start);
            let active: Vec<_> = self.active.iter().map(|motion| motion.id()).collect();
            self.add_robots_near(objects, &active);
            // A robot that an object has slowed regains its speed by traction, even if the object has gone.
            let start = self.start;
            for motion in &mut *self.active {
                if motion.drive_state(start).fraction < 1.0 {
                    self.near_objects.insert(motion.id());
                }
            }
            self.queue_step(objects);
        }
        let has_steps = !self.events.is_empty();
        if has_contacts || has_steps {
            self.queue_first_contacts(pool);
        }
        while let Some((instant, event)) = self.events.pop_first() {
            match event {
                Event::Input(robot, entry) => self.apply_input(robot, entry, instant),
                Event::Contact(a, b) => {
                    self.contacts.remove(&(a, b));
                    self.stop_colliding(a, b, instant);
                }
                Event::Step => {}
            }
            let Some(objects) = &mut objects else { continue };
            if event == Event::Step {
                self.step(objects, instant);
            }
            // A body that was stopped or slowed may come near objects that were not on its planned path.
            let changed = std::mem::take(&mut self.changed);
            self.add_robots_near(objects, &changed);
            let now = self.start + Time::from_seconds_ceil(instant.seconds());
            objects.skip_to(now + STEP - Time(1));
            self.queue_step(objects);
        }
        if let Some(objects) = objects {
            objects.skip_to(self.end);
        }
    }

    /// Adds the `robots` that may come near a movable object to `near_objects`.
    fn add_robots_near(&mut self, objects: &Objects, robots: &[RobotId]) {
        for &robot in robots {
            if objects.is_near(self.view().bounds_of(robot)) {
                self.near_objects.insert(robot);
            }
        }
    }

    /// Queues the next step of the objects, if it ends within the slot and an object moves or may be pushed.
    fn queue_step(&mut self, objects: &Objects) {
        let is_idle = self.near_objects.is_empty() && objects.is_asleep();
        if !is_idle && objects.next_step() + STEP <= self.end {
            let seconds = (objects.next_step() - self.start).seconds();
            self.events.insert((Instant::new(seconds), Event::Step));
        }
    }

    /// Computes one step of the movable objects, with the robots near them.
    fn step(&mut self, objects: &mut Objects, instant: Instant) {
        for bounds in objects.awake_bounds() {
            let robots = self.robots_in(bounds);
            self.near_objects.extend(robots);
        }
        let at = objects.next_step().max(self.start);
        let neighbours: Vec<RobotId> = self.near_objects.iter().copied().collect();
        let states: Vec<Option<DriveState>> = neighbours.iter().map(|robot| self.drive_state(*robot, at)).collect();
        let is_idle = states.iter().flatten().all(|state| state.twist_without_objects.is_zero());
        if is_idle && objects.is_asleep() {
            objects.skip_to(objects.next_step() + STEP);
            return;
        }
        let mut robots = Vec::with_capacity(neighbours.len());
        let mut fractions = Vec::with_capacity(neighbours.len());
        for (robot, state) in neighbours.iter().zip(&states) {
            let (pusher, fraction) = self.pusher(*robot, state.as_ref(), at);
            robots.push(pusher);
            fractions.push(fraction);
        }
        let pushes = objects.step(&robots).to_vec();
        for (index, push) in pushes.into_iter().enumerate() {
            let (robot, Some(state)) = (neighbours[index], states[index]) else { continue };
            let active = self.truth.indices[robot.index()] as usize;
            let touched = push.contact.map(|touch| {
                let point = robots[index].centre + touch.direction * robots[index].radius;
                (touch.object, Obstacle { thing: Thing::Object(touch.object), point })
            });
            if let Some((object, obstacle)) = touched {
                self.active[active].record_touch(at, object, obstacle.point);
            }
            if state.twist_without_objects.is_zero() {
                continue;
            }
            let fraction =
                self.fraction_after(active, &state, &robots[index], fractions[index], push.velocity, push.omega);
            let obstacle = touched.map(|(_, obstacle)| obstacle).or_else(|| self.active[active].pushed_obstacle(at));
            if fraction != state.fraction
                && let Some(obstacle) = obstacle
            {
                self.active[active].slow(at, fraction, obstacle);
                self.read_plan(robot, instant.seconds());
                self.update_contacts(robot, instant.seconds());
            }
        }
    }

    /// Drive of an active robot at `at`; `None` for a passive robot.
    fn drive_state(&mut self, robot: RobotId, at: Time) -> Option<DriveState> {
        let index = self.truth.indices[robot.index()];
        (index != PASSIVE).then(|| self.active[index as usize].drive_state(at))
    }

    /// Input of the objects' solver for a robot in one step, and the fraction of its twist that the robot can reach
    /// with its traction by the end of the step.
    fn pusher(&self, robot: RobotId, state: Option<&DriveState>, at: Time) -> (Pusher, f64) {
        let radius = self.view().radius(robot);
        let Some(state) = state else {
            let centre = self.world.tracks[robot.index()].centre(at);
            let at_rest =
                Pusher { robot, centre, velocity: DVec2::ZERO, omega: 0.0, radius, mass: 1.0, is_immovable: true };
            return (at_rest, 1.0);
        };
        let model = self.active[self.truth.indices[robot.index()] as usize].model();
        let fraction = (state.fraction + max_fraction_increase(model, state.twist_without_objects)).min(1.0);
        // If the robot comes to rest during the step, its mean velocity in the step is lower.
        let mean_fraction = fraction * (state.time_to_rest / STEP.seconds()).min(1.0);
        let half_turn = 0.5 * state.twist_without_objects.omega * mean_fraction * STEP.seconds();
        let heading = state.centre.heading.turned(half_turn).direction();
        let Twist { vx, vy, omega } = state.twist_without_objects.scaled(mean_fraction);
        let pusher = Pusher {
            robot,
            centre: state.centre.position,
            velocity: heading.rotate(DVec2::new(vx, vy)),
            omega,
            radius,
            mass: model.mass,
            is_immovable: state.twist_without_objects.is_zero(),
        };
        (pusher, fraction)
    }

    /// Fraction of its twist at which a robot moves after a step. `fraction` is the value that the robot could reach by
    /// traction alone (see [`Self::pusher`]); `velocity` and `omega` are the motion of the pusher after the step.
    fn fraction_after(
        &self,
        active: usize,
        state: &DriveState,
        before: &Pusher,
        fraction: f64,
        velocity: DVec2,
        omega: f64,
    ) -> f64 {
        let model = self.active[active].model();
        let twist = |velocity: DVec2, omega: f64| Twist { vx: velocity.x, vy: velocity.y, omega };
        let twist_before = twist(before.velocity, before.omega);
        let lost_fraction = 1.0 - model.projection(twist(velocity, omega), twist_before);
        // Traction that was not needed for acceleration acts against the objects.
        let reserve = max_fraction_increase(model, state.twist_without_objects) - (fraction - state.fraction);
        let after = (fraction * (1.0 - lost_fraction.max(0.0)) + reserve.max(0.0)).clamp(0.0, fraction);
        // A speed below 0.1 mm/s is set to 0, because it is within the error of the solver.
        if after * model.energy_speed(state.twist_without_objects) < 1e-4 { 0.0 } else { after }
    }

    /// Ends the slot for the bodies that a robot blocks, after [`ContactResolution::run`]: commits their motions, and
    /// releases bodies whose path has become free.
    pub fn resume(&mut self) {
        for index in 0..self.active.len() {
            if self.truth.slot_motions[index].is_blocked {
                self.truth.slot_motions[index].impacts = Some(self.active[index].commit(self.end));
            }
        }
        for index in 0..self.active.len() {
            if self.truth.slot_motions[index].is_blocked && self.active[index].blocker().is_some() {
                let touching = self.touching(self.active[index].id(), self.end);
                self.active[index].resume(self.end, &touching);
            }
        }
    }

    /// Calls `observe` with each active motion.
    pub fn for_each_active(&mut self, observe: &mut impl FnMut(&mut Motion)) {
        self.active.iter_mut().for_each(|motion| observe(motion));
    }

    /// Queues the first contact of each pair of bodies.
    fn queue_first_contacts(&mut self, pool: &dyn Pool) {
        let mut bounds = std::mem::take(&mut self.truth.bounds);
        bounds.clear();
        bounds.extend(self.truth.active().iter().map(|slot_motion| (slot_motion.robot, slot_motion.bounds)));
        self.truth.index.rebuild(&bounds);
        self.truth.bounds = bounds;
        self.truth.strays.clear();
        let mut found = std::mem::take(&mut self.truth.found_contacts);
        let mut searches: Vec<(&SlotMotion, &mut Vec<_>)> = parallel::reuse(std::mem::take(&mut self.truth.spare));
        searches.extend(self.truth.active().iter().zip(&mut found));
        let spare = {
            let view = self.view();
            pool.for_each(&mut searches, |(slot_motion, found)| view.find_contacts(slot_motion, found));
            parallel::reuse(searches)
        };
        self.truth.spare = spare;
        for (index, list) in found[..self.truth.count].iter_mut().enumerate() {
            let robot = self.truth.slot_motions[index].robot;
            for (other, instant) in list.drain(..) {
                let (a, b) = (robot.min(other), robot.max(other));
                self.contacts.insert((a, b), instant);
                self.events.insert((instant, Event::Contact(a, b)));
            }
        }
        self.truth.found_contacts = found;
    }

    /// A read-only view of the true motions and the world.
    fn view(&self) -> MotionView<'_> {
        MotionView { truth: &*self.truth, world: self.world, start: self.start, end: self.end }
    }

    /// Queues the first contact of a pair from `from` seconds on; replaces a contact that is already queued for the
    /// pair.
    fn queue_contact(&mut self, a: RobotId, b: RobotId, from: f64) {
        let (a, b) = (a.min(b), a.max(b));
        if let Some(instant) = self.contacts.remove(&(a, b)) {
            self.events.remove(&(instant, Event::Contact(a, b)));
        }
        if let Some(seconds) = self.view().find_contact(a, b, from) {
            let instant = Instant::new(seconds);
            self.contacts.insert((a, b), instant);
            self.events.insert((instant, Event::Contact(a, b)));
        }
    }

    /// Stops each of two touching bodies whose velocity points towards the other.
    fn stop_colliding(&mut self, a: RobotId, b: RobotId, instant: Instant) {
        let seconds = instant.seconds();
        let (disc_a, _) = self.view().moving_disc(a, seconds);
        let (disc_b, _) = self.view().moving_disc(b, seconds);
        let (centre_a, centre_b) = (disc_a.path.position(disc_a.elapsed), disc_b.path.position(disc_b.elapsed));
        let towards_b = (centre_b - centre_a).normalize_or_zero();
        let approach_speed = |disc: &MovingDisc, towards: DVec2| disc.path.velocity(disc.elapsed).dot(towards);
        // The sum of both approach speeds exceeds the threshold, so at least one of them is half of the threshold or
        // more.
        let is_blocked_a = approach_speed(&disc_a, towards_b) > 0.4 * APPROACH;
        let is_blocked_b = approach_speed(&disc_b, -towards_b) > 0.4 * APPROACH;
        let point = centre_a + towards_b * disc_a.radius;
        if is_blocked_a {
            self.block(a, seconds, Obstacle { thing: Thing::Robot(b), point });
        }
        if is_blocked_b {
            self.block(b, seconds, Obstacle { thing: Thing::Robot(a), point });
        }
        if is_blocked_a {
            self.update_contacts(a, seconds);
        }
        if is_blocked_b {
            self.update_contacts(b, seconds);
        }
    }

    /// Stops a body `seconds` after the start of the slot, and queues the robot's next input.
    fn block(&mut self, robot: RobotId, seconds: f64, obstacle: Obstacle) {
        let index = self.truth.indices[robot.index()] as usize;
        let motion = &mut self.active[index];
        motion.block(self.start, seconds, obstacle);
        self.truth.slot_motions[index].is_blocked = true;
        self.read_plan(robot, seconds);
    }

    /// Reads the new plan of a motion that has changed from `seconds` after the start of the slot on, and queues the
    /// robot's next input.
    fn read_plan(&mut self, robot: RobotId, seconds: f64) {
        let index = self.truth.indices[robot.index()] as usize;
        self.active[index].passages(self.start, self.end, &mut self.truth.slot_motions[index].passages);
        // Replaces the input that an earlier change has queued.
        self.events.retain(|(_, event)| !matches!(event, Event::Input(other, _) if *other == robot));
        let journal = self.active[index].journal();
        let next = journal.partition_point(|(at, _)| (*at - self.start).seconds() <= seconds);
        self.queue_input(robot, next);
    }

    fn queue_input(&mut self, robot: RobotId, entry: usize) {
        let index = self.truth.indices[robot.index()] as usize;
        if let Some((at, _)) = self.active[index].journal().get(entry) {
            let instant = Instant::new((*at - self.start).seconds());
            self.events.insert((instant, Event::Input(robot, entry)));
        }
    }

    /// Applies again an input of a body that was stopped or slowed.
    fn apply_input(&mut self, robot: RobotId, entry: usize, instant: Instant) {
        let index = self.truth.indices[robot.index()] as usize;
        let (at, input) = self.active[index].journal()[entry];
        let touching = self.touching(robot, at);
        let motion = &mut self.active[index];
        motion.replay(at, input, &touching);
        self.truth.slot_motions[index].is_blocked |= motion.blocker().is_some();
        motion.passages(self.start, self.end, &mut self.truth.slot_motions[index].passages);
        self.queue_input(robot, entry + 1);
        self.update_contacts(robot, instant.seconds());
    }

    /// Queues again the contacts of a body; its motion has changed from `from` seconds on.
    fn update_contacts(&mut self, robot: RobotId, from: f64) {
        self.changed.push(robot);
        let bounds = self.view().bounds_of(robot);
        let indexed_bounds = self.truth.slot_motions[self.truth.indices[robot.index()] as usize].bounds;
        if !(indexed_bounds.contains(bounds.min) && indexed_bounds.contains(bounds.max)) {
            self.truth.strays.insert(robot);
        }
        let old_pairs: Vec<_> = self.contacts.keys().filter(|(a, b)| *a == robot || *b == robot).copied().collect();
        for (a, b) in old_pairs {
            self.queue_contact(a, b, from);
        }
        for other in self.neighbours(robot, bounds) {
            self.queue_contact(robot, other, from);
        }
    }

    /// Robots other than `robot` whose bodies may come into `bounds` during the slot, in the order of their ids.
    fn neighbours(&self, robot: RobotId, bounds: Bounds) -> BTreeSet<RobotId> {
        let mut others = self.robots_in(bounds);
        others.remove(&robot);
        others
    }

    /// Robots whose bodies may come into `bounds` during the slot, in the order of their ids.
    fn robots_in(&self, bounds: Bounds) -> BTreeSet<RobotId> {
        let mut robots = BTreeSet::new();
        self.truth.index.for_each_in(bounds, |other| {
            robots.insert(other);
        });
        self.world.for_each_near(bounds, self.start, |other| {
            if self.view().is_passive(other) {
                robots.insert(other);
            }
        });
        robots.extend(self.truth.strays.iter().filter(|stray| self.view().bounds_of(**stray).overlaps(&bounds)));
        robots
    }

    /// The bodies in contact with a robot at `at`, in the order of their ids.
    fn touching(&self, robot: RobotId, at: Time) -> Vec<Body> {
        let seconds = (at - self.start).seconds();
        let body = |robot: RobotId| {
            let (disc, _) = self.view().moving_disc(robot, seconds);
            Body { robot, centre: disc.path.position(disc.elapsed), radius: disc.radius }
        };
        let own_body = body(robot);
        let bounds = Bounds::of_disc(own_body.centre, own_body.radius + TOUCH);
        self.neighbours(robot, bounds)
            .into_iter()
            .map(body)
            .filter(|other| (other.centre - own_body.centre).length() <= own_body.radius + other.radius + TOUCH)
            .collect()
    }
}

/// Read-only view of the true motions of a slot, as far as they have been resolved.
#[derive(Clone, Copy)]
struct MotionView<'a> {
    truth: &'a TrueMotions,
    world: &'a World,
    start: Time,
    end: Time,
}

impl<'a> MotionView<'a> {
    /// Finds the first contacts of an active body with passive bodies and with active bodies of higher ids.
    fn find_contacts(&self, slot_motion: &SlotMotion, found: &mut Vec<(RobotId, Instant)>) {
        let robot = slot_motion.robot;
        let mut find = |other| {
            let (a, b) = (robot.min(other), robot.max(other));
            found.extend(self.find_contact(a, b, 0.0).map(|seconds| (other, Instant::new(seconds))));
        };
        self.truth.index.visit_in(&slot_motion.bounds, |other| {
            if other > robot {
                find(other);
            }
        });
        if self.truth.count < self.world.tracks.len() {
            let mut find_passive = |other| {
                if self.is_passive(other) && self.world.is_robot_present(other, self.start) {
                    find(other);
                }
            };
            self.world.resting.visit_in(&slot_motion.bounds, &mut find_passive);
            self.world.moving.visit_in(&slot_motion.bounds, &mut find_passive);
        }
    }

    fn is_passive(&self, robot: RobotId) -> bool {
        self.truth.indices[robot.index()] == PASSIVE
    }

    fn passages(&self, robot: RobotId) -> &'a [Passage] {
        match self.truth.indices[robot.index()] {
            PASSIVE => self.world.tracks[robot.index()].passages(),
            index => &self.truth.slot_motions[index as usize].passages,
        }
    }

    fn radius(&self, robot: RobotId) -> f64 {
        self.world.tracks[robot.index()].radius()
    }

    fn bounds_of(&self, robot: RobotId) -> Bounds {
        passages_bounds(self.passages(robot), self.start, self.end).grown(self.radius(robot) + TOUCH)
    }

    /// First instant from `from` on at which two bodies touch and approach each other, in seconds since the start of
    /// the slot; `None` if there is none in the slot.
    fn find_contact(&self, a: RobotId, b: RobotId, from: f64) -> Option<f64> {
        let span = (self.end - self.start).seconds();
        let mut t = from;
        while t < span {
            let (disc_a, until_a) = self.moving_disc(a, t);
            let (disc_b, until_b) = self.moving_disc(b, t);
            if until_a == f64::INFINITY
                && until_b == f64::INFINITY
                && disc_a.path.is_resting()
                && disc_b.path.is_resting()
            {
                return None;
            }
            // Each search covers at least a picosecond, so that rounding at the end of a passage cannot cause an
            // endless loop.
            let until = until_a.min(until_b).min(span).max(t + 1e-12);
            if let Some(seconds) = first_touch(&disc_a, &disc_b, until - t) {
                return Some(t + seconds);
            }
            t = until;
        }
        None
    }

    /// Motion of a body `t` seconds after the start of the slot, and the instant until which this motion is valid, in
    /// seconds since the start of the slot.
    fn moving_disc(&self, robot: RobotId, t: f64) -> (MovingDisc, f64) {
        let passages = self.passages(robot);
        // Seconds since the start of the passage's stage; with this formula, a stage that was stopped at an instant has
        // ended at exactly this instant.
        let seconds = |passage: &Passage| t - (passage.start - self.start).seconds();
        let index = passages.iter().rposition(|passage| seconds(passage) >= passage.begin).unwrap_or(0);
        let passage = &passages[index];
        let start = |passage: &Passage| (passage.start - self.start).seconds();
        let until = passages.get(index + 1).map_or(f64::INFINITY, |next| start(next) + next.begin);
        let elapsed = (seconds(passage) - passage.begin).max(0.0);
        let radius = self.radius(robot);
        if passage.path.is_resting() {
            (MovingDisc { path: passage.path, elapsed: 0.0, radius }, until)
        } else if seconds(passage) >= passage.end {
            let rest = passage.path.position(passage.end - passage.begin);
            (MovingDisc { path: Path::resting(rest), elapsed: 0.0, radius }, until)
        } else {
            (MovingDisc { path: passage.path, elapsed, radius }, until.min(start(passage) + passage.end))
        }
    }
}

/// Maximum increase, by traction in one step, of the fraction at which a robot moves; `twist` is the twist of the
/// centre without objects.
fn max_fraction_increase(model: &Model, twist: Twist) -> f64 {
    let speed = model.energy_speed(twist);
    if speed > 0.0 { model.traction * GRAVITY * STEP.seconds() / speed } else { 0.0 }
}
