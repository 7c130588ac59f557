//! The world with all its robots: queries about published motion, and the end of a slot.
//!
//! The world does not change during a slot: robots query the motion published at the start of the slot
//! ([`World::cast`], [`World::touching`]), each at its own virtual time. At the end of the slot, [`World::advance`]
//! resolves the contacts between bodies, publishes the changes and continues with the next slot.

mod lifetime;
mod near;
mod objects;
mod ray;
mod settle;
mod space;
mod touch;
mod track;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use crate::{
    ObjectId, RobotId,
    contact::{Body, TOUCH, Thing},
    drive::{HISTORY, Impact, Motion, Passage, legged::Stance},
    object::{Properties, State},
    parallel::{Pool, Serial},
    pose::{PlacementError, Pose, Pose3, Twist},
    radio::{Channel, Loss, RadioModel},
    scene::{Bounds, BoundsIndex, Walls},
    time::Time,
};
pub use lifetime::Lifetime;
pub use objects::ObjectStep;
use objects::Objects;
pub use ray::{HitSurface, Ray, RayHit, Tilt};
use settle::{ContactResolution, SlotMotion, TrueMotions};
use space::IndexedSpace;
pub use space::{Space, ThickWall};
pub use touch::{LegClearance, LegContact};
use track::Track;

/// A contact that began in a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Instant of the contact, rounded up to a microsecond.
    pub time: Time,
    /// Robot whose body was stopped.
    pub robot: RobotId,
    /// Obstacle that stopped the body.
    pub with: Thing,
    /// Point of contact in the world frame, in metres.
    pub point: DVec2,
}

/// A part of a robot's published motion: constant twist, then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Start of the stretch.
    pub start: Time,
    /// Pose of the robot's centre at the start.
    pub from: Pose,
    /// Twist of the robot's centre in the robot's frame.
    pub twist: Twist,
    /// Seconds from the start until the robot comes to rest; may be infinite.
    pub after: f64,
}

/// The static walls and the published motion of all robots, for the present slot and the 100 ms before.
///
/// A clone is independent of the original and evolves bit-identically. Both share the immutable parts: walls, shapes,
/// surfaces.
#[derive(Clone, Debug)]
pub struct World {
    walls: Arc<Walls>,
    slot: Time,
    now: Time,
    /// In the order of the robots' ids.
    tracks: Vec<Track>,
    /// Index over the moving bodies: bounds of their published motion from 100 ms before the present slot to the slot's
    /// end.
    moving: BoundsIndex<RobotId>,
    /// Index over the bodies at rest.
    resting: BoundsIndex<RobotId>,
    /// For each robot, true if its body is in `resting` and its [track](Track::is_resting) has not changed since.
    are_resting: Vec<bool>,
    /// Number of robots that were removed before the start of the queryable history.
    forgotten: usize,
    /// Buffer for the next rebuild of an index.
    bounds: Vec<(RobotId, Bounds)>,
    truth: TrueMotions,
    /// The movable objects; `None` in a scene without any.
    objects: Option<Box<Objects>>,
    /// Geometry that only rays in space can hit.
    indexed_space: Arc<IndexedSpace>,
    quiescence: Quiescence,
    radio: Channel,
    /// Published stances of the robots with legs and of those in the water.
    stances: BTreeMap<RobotId, PublishedStance>,
}

/// Published stance of a robot with legs or in the water: its posture at the start of the present slot.
#[derive(Clone, Debug, PartialEq)]
struct PublishedStance {
    stance: Stance,
    /// Pose of each leg part in the robot's frame.
    parts: Vec<Pose3>,
}

/// Time up to which a world's only robot follows its plan without a contact to resolve or a change to publish.
/// Valid while the plan has this revision.
#[derive(Clone, Copy, Debug, Default)]
struct Quiescence {
    revision: u64,
    until: Time,
}

/// Maximum look-ahead of [`Quiescence`]; it limits the size of the robot's rectangle in the index.
const MAX_QUIESCENCE: Time = Time::from_millis(10_000);

impl World {
    /// A world at time 0 with slots of length `slot` and the robots of `motions`, in the order of their ids from 1 on.
    ///
    /// # Panics
    /// If `slot` is not positive or the ids are not 1, 2, ... in this order.
    pub fn new<'a>(walls: Arc<Walls>, slot: Time, motions: impl IntoIterator<Item = &'a mut Motion>) -> Self {
        assert!(slot > Time::ZERO, "the slot length is positive");
        let indexed_space = Arc::new(IndexedSpace::new(Space::default(), &walls));
        let mut world = Self {
            walls,
            slot,
            now: Time::ZERO,
            tracks: Vec::new(),
            moving: BoundsIndex::default(),
            resting: BoundsIndex::default(),
            are_resting: Vec::new(),
            forgotten: 0,
            bounds: Vec::new(),
            truth: TrueMotions::default(),
            objects: None,
            indexed_space,
            quiescence: Quiescence::default(),
            radio: Channel::default(),
            stances: BTreeMap::new(),
        };
        for (index, motion) in motions.into_iter().enumerate() {
            assert_eq!(motion.id().index(), index, "robots are given in the order of their ids");
            world.tracks.push(Track::new(motion, Lifetime::ALWAYS, (Time::ZERO, slot)));
            world.publish_stance(motion, Time::ZERO);
        }
        world.refresh_index();
        world
    }

    /// Adds movable objects at rest at these poses, in the order of their ids from 1 on.
    ///
    /// # Panics
    /// If `objects` is not empty in a build without the feature `objects`.
    pub fn with_objects(mut self, objects: impl IntoIterator<Item = (Arc<Properties>, Pose)>) -> Self {
        let mut objects = objects.into_iter().peekable();
        if objects.peek().is_some() {
            self.objects = Some(Box::new(Objects::new(&self.walls, objects)));
        }
        self
    }

    /// Sets the geometry that only rays in space can hit: shapes, heights and surfaces.
    pub fn with_space(mut self, space: Space) -> Self {
        self.indexed_space = Arc::new(IndexedSpace::new(space, &self.walls));
        self
    }

    /// Sets the channel between the robots' radios.
    pub fn with_radio(mut self, channel: Channel) -> Self {
        self.radio = channel;
        self
    }

    /// The channel between the robots' radios, as published at the start of the slot.
    pub fn radio(&self) -> &Channel {
        &self.radio
    }

    /// The channel, mutable. It takes the queued messages between two slots.
    pub fn radio_mut(&mut self) -> &mut Channel {
        &mut self.radio
    }

    /// Robots that cannot receive a message sent by `robot` from `position` at `at`, each with the reason, in the order
    /// of their ids. These robots are out of the channel's range or, if the channel needs a line of sight, behind a
    /// wall of any height. Bodies do not block messages: our choice.
    pub fn unreachable_robots(&self, robot: RobotId, position: DVec2, at: Time) -> Vec<(RobotId, Loss)> {
        let RadioModel { range, line_of_sight, .. } = *self.radio.model();
        if range.is_none() && !line_of_sight {
            return Vec::new();
        }
        let others = (0..self.tracks.len()).map(RobotId::from_index);
        let others = others.filter(|other| *other != robot && self.is_robot_present(*other, at));
        let check_reach = |other: RobotId| {
            let offset = self.tracks[other.index()].centre(at) - position;
            let distance = offset.length();
            if range.is_some_and(|range| distance > range) {
                return Err(Loss::Range);
            }
            let is_hidden =
                line_of_sight && distance > 0.0 && self.walls.cast(position, offset / distance, distance).is_some();
            if is_hidden { Err(Loss::Sight) } else { Ok(()) }
        };
        others.filter_map(|other| Some((other, check_reach(other).err()?))).collect()
    }

    /// Number of movable objects, removed ones included.
    pub fn object_count(&self) -> usize {
        self.objects.as_ref().map_or(0, |objects| objects.len())
    }

    /// Published pose of a movable object at `at`, which is at most 100 ms before the present slot.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_pose(&self, object: ObjectId, at: Time) -> Pose {
        self.objects().pose(object, at)
    }

    /// Constant properties of a movable object.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_properties(&self, object: ObjectId) -> &Properties {
        self.objects().properties(object)
    }

    /// State of a movable object at the end of the last completed step of 1 ms.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_state(&self, object: ObjectId) -> State {
        self.objects().state(object)
    }

    /// Sets the velocity of a movable object's centre of mass, m/s, and its angular velocity, rad/s, at the start of
    /// the slot.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn set_object_velocity(&mut self, object: ObjectId, velocity: DVec2, omega: f64) {
        let (now, end) = (self.now, self.slot_end());
        let objects = self.objects.as_mut().expect("the scene has this object");
        objects.set_velocity(object, velocity, omega, now);
        objects.publish(now, end);
    }

    /// Places a movable object at `world_from_object`, at rest and awake, at the end of the present slot. Must be
    /// called before [`World::advance`]. If it is called several times for one object, the last call applies.
    ///
    /// Any pose is allowed: an object inside a wall or a body is pushed out. A removed object stays removed.
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn place_object(&mut self, object: ObjectId, world_from_object: Pose) -> Result<(), PlacementError> {
        world_from_object.check_placement()?;
        self.objects.as_mut().expect("the scene has this object").queue_placement(object, world_from_object);
        Ok(())
    }

    /// Places a movable object at `world_from_object` now, at the start of the slot, at rest and awake; publishes the
    /// pose immediately.
    ///
    /// Any pose is allowed: an object inside a wall or a body is pushed out.
    ///
    /// # Errors
    /// [`PlacementError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn place_object_now(&mut self, object: ObjectId, world_from_object: Pose) -> Result<(), PlacementError> {
        self.place_object(object, world_from_object)?;
        let (now, end) = (self.now, self.slot_end());
        let objects = self.objects.as_mut().expect("the scene has this object");
        objects.apply_placements();
        objects.publish(now, end);
        Ok(())
    }

    /// Starts recording the steps of movable objects for [`World::take_object_steps`].
    pub fn keep_object_steps(&mut self) {
        if let Some(objects) = &mut self.objects {
            objects.keep_steps();
        }
    }

    /// Removes and returns the recorded steps of movable objects, in order of time; see [`World::keep_object_steps`].
    pub fn take_object_steps(&mut self) -> Vec<ObjectStep> {
        self.objects.as_mut().map(|objects| objects.take_steps()).unwrap_or_default()
    }

    /// The movable objects that moved in the previous slot, in ascending order.
    pub fn moved_objects(&self) -> &[ObjectId] {
        self.objects.as_ref().map_or(&[], |objects| objects.moved())
    }

    /// Returns true while a movable object moves, or was placed so recently that it may still be pushed out of an
    /// overlap.
    pub fn is_object_moving(&self) -> bool {
        self.objects.as_ref().is_some_and(|objects| objects.is_moving())
    }

    fn objects(&self) -> &Objects {
        self.objects.as_ref().expect("the scene has this object")
    }

    /// The static walls.
    pub fn walls(&self) -> &Arc<Walls> {
        &self.walls
    }

    /// Length of a slot.
    pub fn slot(&self) -> Time {
        self.slot
    }

    /// Start of the present slot.
    pub fn slot_start(&self) -> Time {
        self.now
    }

    /// End of the present slot, exclusive.
    pub fn slot_end(&self) -> Time {
        self.now + self.slot
    }

    /// Published body of a robot at `at`, which is at most 100 ms before the present slot.
    pub fn body(&self, robot: RobotId, at: Time) -> Body {
        let track = &self.tracks[robot.index()];
        Body { robot, centre: track.centre(at), radius: track.radius() }
    }

    /// Published pose of a robot's centre at `at`, which is at most 100 ms before the present slot.
    ///
    /// For the exact pose of a robot whose motion the caller has, see [`Motion::pose`].
    pub fn robot_pose(&self, robot: RobotId, at: Time) -> Pose {
        self.tracks[robot.index()].pose(at)
    }

    /// Published motion of a robot in the present slot: at least one part, in the order of time; the first one
    /// covers the slot's start.
    pub fn stretches(&self, robot: RobotId) -> impl Iterator<Item = Stretch> {
        let passages = self.tracks[robot.index()].passages();
        // The last passage has no end.
        let first = passages.iter().position(|passage| passage.until > self.now).unwrap_or(passages.len() - 1);
        let in_slot = passages[first..]
            .iter()
            .enumerate()
            .take_while(|(index, passage)| *index == 0 || passage.since() < self.slot_end());
        in_slot.map(|(_, passage)| {
            let (start, from, twist, after) = passage.stretch(self.now, self.slot_end());
            Stretch { start, from, twist, after }
        })
    }

    /// The bodies of other robots that touch the body of `motion` at `at`, in the order of their ids: the argument of
    /// [`Motion::command`]. Their poses are the published ones; the pose of `motion` is exact.
    pub fn touching(&self, motion: &mut Motion, at: Time) -> Vec<Body> {
        if self.tracks.len() < 2 {
            return Vec::new();
        }
        let centre = motion.pose(at).position;
        let radius = motion.radius();
        let mut bodies = Vec::new();
        let mut visit = |robot: RobotId| {
            if robot != motion.id() && self.is_robot_present(robot, at) {
                let body = self.body(robot, at);
                if (body.centre - centre).length() <= radius + body.radius + TOUCH {
                    bodies.push(body);
                }
            }
        };
        let bounds = Bounds::of_disc(centre, radius + TOUCH);
        self.resting.visit_in(&bounds, &mut visit);
        self.moving.visit_in(&bounds, &mut visit);
        bodies.sort_by_key(|body| body.robot);
        bodies.dedup_by_key(|body| body.robot);
        bodies
    }

    /// Ends the present slot: resolves the contacts between bodies within it, releases bodies whose path has become
    /// free, publishes the changes, and advances to the next slot.
    ///
    /// `active` holds the motions of all [active](Motion::is_active) robots, in any order; passive robots may be
    /// omitted. Returns the contacts that began in the slot, in the order of (time, robot).
    pub fn advance(&mut self, active: &mut [&mut Motion]) -> Vec<Contact> {
        active.sort_by_key(|motion| motion.id());
        let mut contacts = Vec::new();
        if self.settle(active, &Serial, |_| {}) {
            let (end, next_end) = (self.slot_end(), self.slot_end() + self.slot);
            for (motion, publication) in active.iter_mut().zip(self.publications()) {
                publication.publish(motion, end, next_end, |contact| contacts.push(contact));
            }
            contacts.sort_by_key(|contact| (contact.time, contact.robot));
            self.conclude(active);
        }
        contacts
    }

    /// First part of the end of a slot: resolves the contacts between bodies, and releases bodies whose path has become free. `active`
    /// holds the motions as in [`World::advance`], sorted by id. `observe` is called with each motion when its contacts are resolved and
    /// the whole slot can still be queried.
    ///
    /// Returns false if the world has already advanced because nothing can have changed. Otherwise the caller must publish all
    /// [publications](World::publications) and call [`World::conclude`].
    pub(crate) fn settle(
        &mut self,
        active: &mut [&mut Motion],
        pool: &impl Pool,
        mut observe: impl FnMut(&mut Motion),
    ) -> bool {
        let end = self.slot_end();
        if let [motion] = active
            && self.is_quiescent(motion, end + self.slot)
        {
            observe(motion);
            motion.pass(end);
            self.now = end;
            self.publish_stance(motion, end);
            return false;
        }
        let mut truth = std::mem::take(&mut self.truth);
        let mut objects = self.objects.take();
        let mut resolution = ContactResolution::new(&mut truth, self, active, pool);
        resolution.run(objects.as_deref_mut(), pool);
        resolution.for_each_active(&mut observe);
        resolution.resume();
        self.objects = objects;
        self.truth = truth;
        true
    }

    /// Second part of the end of a slot: the publication of each active robot, in the order of ids.
    pub(crate) fn publications(&mut self) -> impl Iterator<Item = Publication<'_>> {
        let is_alone = self.has_single_robot();
        let mut tracks = self.tracks.iter_mut().enumerate();
        self.truth.active_mut().iter_mut().map(move |slot_motion| {
            let index = slot_motion.robot.index();
            let track = tracks.find(|(other, _)| *other == index);
            let track = track.map(|(_, track)| track).expect("each robot has a track");
            track.is_alone = is_alone;
            Publication { slot_motion, track }
        })
    }

    /// Last part of the end of a slot, after all robots of `active` have published: advances to the next slot.
    pub(crate) fn conclude(&mut self, active: &mut [&mut Motion]) {
        let end = self.slot_end();
        self.now = end;
        if let Some(objects) = &mut self.objects {
            objects.apply_placements();
            objects.publish(end, end + self.slot);
        }
        if self.has_stances() {
            active.iter_mut().for_each(|motion| self.publish_stance(motion, end));
        }
        if self.has_plan_alone() {
            self.quiescence = Quiescence::default();
            self.are_resting.fill(false);
            return;
        }
        if let [motion] = active
            && self.has_single_robot()
        {
            self.quiescence =
                Quiescence { revision: motion.revision(), until: motion.steady_until(end).min(end + MAX_QUIESCENCE) };
            let (from, to) = (end - HISTORY, self.slot_end().max(self.quiescence.until));
            let published = self.publications().filter(|publication| publication.slot_motion.published.is_some());
            published.for_each(|publication| publication.refresh(from, to));
        }
        let truth = std::mem::take(&mut self.truth);
        self.refresh_index_after(Some(&truth));
        self.truth = truth;
    }

    /// Publishes the plan of `motion` at the start of the present slot again, after the robot was [placed](Motion::place)
    /// or changed there.
    pub fn republish(&mut self, motion: &mut Motion) {
        let (now, end) = (self.now, self.slot_end());
        self.tracks[motion.id().index()].publish(motion, now, end);
        self.are_resting[motion.id().index()] = self.tracks[motion.id().index()].is_resting();
        self.publish_stance(motion, now);
        self.quiescence = Quiescence::default();
        self.refresh_index();
    }

    /// Publishes the stance of a robot with legs or in the water at `now`.
    fn publish_stance(&mut self, motion: &mut Motion, now: Time) {
        if !motion.has_height() {
            return;
        }
        let stance = motion.stance(now);
        let parts = motion.legs().map(|legs| legs.parts(&stance)).unwrap_or_default();
        self.stances.insert(motion.id(), PublishedStance { stance, parts });
    }

    /// Pose of a robot's body in space at `at`. Its height is taken from the published stance at the start of the
    /// present slot.
    pub fn robot_pose_in_space(&self, robot: RobotId, at: Time) -> Pose3 {
        Pose3::from_planar(&self.robot_pose(robot, at), self.stance(robot).map_or(0.0, |stance| stance.lift))
    }

    /// Published stance of a robot with legs or in the water, at the start of the present slot; `None` for other robots.
    pub fn stance(&self, robot: RobotId) -> Option<&Stance> {
        self.stances.get(&robot).map(|published| &published.stance)
    }

    /// Pose in the world at `at` of a part of a robot's legs; the stance is the one at the start of the present slot. Parts
    /// are indexed as in [`Legs::parts`](crate::drive::legged::Legs::parts); `None` if there is no such part.
    pub fn leg_part_pose(&self, robot: RobotId, part: usize, at: Time) -> Option<Pose3> {
        let robot_from_part = self.stances.get(&robot)?.parts.get(part)?;
        Some(self.robot_pose_in_space(robot, at).then(robot_from_part))
    }

    /// Returns true if there is a robot with legs or in the water.
    pub(crate) fn has_stances(&self) -> bool {
        !self.stances.is_empty()
    }

    /// Returns true if there is only one robot and no movable object.
    fn has_single_robot(&self) -> bool {
        self.tracks.len() == 1 && self.objects.is_none()
    }

    /// Returns true if the only robot has published a plan without its passages; the plan is then not in the indices.
    fn has_plan_alone(&self) -> bool {
        self.has_single_robot() && self.tracks[0].has_plan()
    }

    /// Returns true if nothing needs to be resolved or published before `until`, the usual case for a single robot.
    fn is_quiescent(&self, motion: &Motion, until: Time) -> bool {
        until <= self.quiescence.until
            && motion.revision() == self.quiescence.revision
            && motion.is_uncommanded()
            && self.has_single_robot()
    }

    /// Skips to the slot that starts at `slot_start`. Precondition: before it, no robot is [active](Motion::is_active),
    /// [no object moves](World::is_object_moving) and no robot wakes.
    ///
    /// # Panics
    /// If `slot_start` is not the start of a slot, or lies before the present one.
    pub fn advance_to(&mut self, slot_start: Time) {
        assert!(
            slot_start >= self.now && slot_start.floor_to(self.slot) == slot_start,
            "{slot_start} is not the start of a later slot"
        );
        if slot_start == self.now {
            return;
        }
        if let Some(objects) = &mut self.objects {
            objects.skip_to(slot_start);
            objects.publish(slot_start, slot_start + self.slot);
        }
        self.now = slot_start;
        self.refresh_index();
    }

    /// Updates the indices with the bounds of the published motion. Bodies that stay at rest need no update.
    fn refresh_index(&mut self) {
        self.refresh_index_after(None);
    }

    /// Like [`World::refresh_index`], after the active robots of `published` have published their motion.
    fn refresh_index_after(&mut self, published: Option<&TrueMotions>) {
        let (from, to) = (self.now - HISTORY, self.slot_end().max(self.quiescence.until));
        let mut has_rest_changed = false;
        self.bounds.clear();
        self.are_resting.resize(self.tracks.len(), false);
        for index in 0..self.tracks.len() {
            let robot = RobotId::from_index(index);
            let slot_motion = published.and_then(|published| published.slot_motion(robot));
            let (bounds, is_resting) = match slot_motion.and_then(|slot_motion| slot_motion.published) {
                Some(published) => published,
                None if self.are_resting[index] => continue,
                None => {
                    let track = &mut self.tracks[index];
                    track.refresh(from, to);
                    self.forgotten += usize::from(track.lifetime.until <= from);
                    (track.bounds(), track.is_resting())
                }
            };
            self.are_resting[index] = is_resting;
            has_rest_changed |= is_resting;
            if !is_resting {
                self.bounds.push((robot, bounds));
            }
        }
        if !(self.bounds.is_empty() && self.moving.is_empty()) {
            self.moving.rebuild(&self.bounds);
        }
        // A body that has started moving stays in the index of bodies at rest until that index is rebuilt.
        let count = self.tracks.len() - self.forgotten - self.bounds.len();
        if has_rest_changed || count != self.resting.len() {
            self.bounds.clear();
            let at_rest = self.tracks.iter().enumerate().filter(|(index, _)| self.are_resting[*index]);
            self.bounds.extend(at_rest.map(|(index, track)| (RobotId::from_index(index), track.bounds())));
            self.resting.rebuild(&self.bounds);
        }
    }

    /// Visits each robot present at `at` whose published motion comes near `bounds`.
    fn for_each_near(&self, bounds: Bounds, at: Time, mut visit: impl FnMut(RobotId)) {
        let mut visit = |robot| {
            if self.is_robot_present(robot, at) {
                visit(robot);
            }
        };
        if self.has_plan_alone() {
            return visit(RobotId::from_index(0));
        }
        self.resting.for_each_in(bounds, &mut visit);
        self.moving.for_each_in(bounds, &mut visit);
    }
}

/// Publication of an active robot at the end of a slot.
pub(crate) struct Publication<'a> {
    slot_motion: &'a mut SlotMotion,
    track: &'a mut Track,
}

impl Publication<'_> {
    /// Robot of the motion.
    pub fn robot(&self) -> RobotId {
        self.slot_motion.robot
    }

    /// Ends the slot at `end` for `motion`, calls `report` with the contacts that began in the slot, in order of time, and publishes
    /// the motion up to `next_end`.
    pub fn publish(self, motion: &mut Motion, end: Time, next_end: Time, mut report: impl FnMut(Contact)) {
        let impacts = self.slot_motion.impacts.take().unwrap_or_else(|| motion.commit(end));
        for impact in impacts.into_iter().filter(|impact| impact.fresh) {
            let Impact { time, thing: with, point, .. } = impact;
            report(Contact { time, robot: self.slot_motion.robot, with, point });
        }
        if self.track.is_alone && self.track.publish_plan(motion, end, next_end) {
            return;
        }
        self.track.publish(motion, end, next_end);
        if !self.track.is_resting() {
            self.refresh(end - HISTORY, next_end);
        }
    }

    /// Computes the bounds of the motion published from `from` to `to`.
    fn refresh(self, from: Time, to: Time) {
        self.track.refresh(from, to);
        self.slot_motion.published = Some((self.track.bounds(), self.track.is_resting()));
    }
}

/// The passage in force at `at`: the last passage that has started by `at`, or the first if none has.
fn passage_at(passages: &[Passage], at: Time) -> &Passage {
    let started = passages.iter().rposition(|passage| passage.since() <= at);
    &passages[started.unwrap_or(0)]
}
