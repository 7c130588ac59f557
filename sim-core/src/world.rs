//! The world with all its robots: queries of published motion, and the end of a slot.
//!
//! The world does not change during a slot. The robots query the motion that was published at the start of the slot
//! ([`World::cast`], [`World::touching`]), each at its own virtual time. At the end of the slot, [`World::advance`]
//! resolves the contacts between bodies, publishes the changed motions and advances to the next slot.

mod discs;
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
    sort::sort_few,
    time::Time,
};
use discs::{Disc, DiscCache};
pub use lifetime::Lifetime;
pub use objects::ObjectStep;
use objects::Objects;
pub use ray::{HitSurface, Ray, RayCaster, RayHit, Tilt};
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
    /// Robot whose body met the obstacle.
    pub robot: RobotId,
    /// The obstacle.
    pub with: Thing,
    /// Point of contact in the world frame, in metres.
    pub point: DVec2,
}

/// A piece of a robot's published motion: constant twist, then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedPiece {
    /// Start of the piece.
    pub start: Time,
    /// Pose of the robot's centre at the start.
    pub world_from_robot: Pose,
    /// Twist of the robot's centre in the robot's frame.
    pub twist: Twist,
    /// Seconds from the start until the robot comes to rest; can be infinite.
    pub duration: f64,
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
    /// Published motions of the robots, in the order of their ids.
    tracks: Vec<Track>,
    /// Index of the moving bodies, by the bounds of their published motion from 100 ms before the present slot to its
    /// end.
    moving: BoundsIndex<RobotId>,
    /// Index of the bodies whose centres are at rest, by their bounds.
    resting: BoundsIndex<RobotId>,
    /// For each robot, true if its body is in the index `resting` and its [track](Track::is_resting) has not changed
    /// since the body was added.
    are_resting: Vec<bool>,
    /// Number of robots that were removed before the published history begins.
    removed_count: usize,
    /// Buffer for the rebuild of an index.
    bounds: Vec<(RobotId, Bounds)>,
    truth: TrueMotions,
    discs: DiscCache,
    /// The movable objects; `None` in a scene without any.
    objects: Option<Box<Objects>>,
    /// Geometry that only three-dimensional rays and legs can touch.
    indexed_space: Arc<IndexedSpace>,
    quiescence: Quiescence,
    radio: Channel,
    /// Published stances of the robots with legs and of the robots in the water.
    stances: BTreeMap<RobotId, PublishedStance>,
}

/// Published stance of a robot with legs or in the water: its posture at the start of the present slot.
#[derive(Clone, Debug, PartialEq)]
struct PublishedStance {
    stance: Stance,
    /// Pose of each leg part in the robot's frame.
    parts: Vec<Pose3>,
}

/// Time until which the only robot of a world follows its plan without a contact to resolve or a change to publish.
/// Valid only for the plan with this revision.
#[derive(Clone, Copy, Debug, Default)]
struct Quiescence {
    revision: u64,
    until: Time,
}

/// Maximum duration of a [`Quiescence`]. This limit keeps the bounds of the robot in the index small.
const MAX_QUIESCENCE: Time = Time::from_millis(10_000);

impl World {
    /// Creates a world at time 0 with slots of length `slot` and the robots of `motions`, in the order of their ids
    /// from 1 on.
    ///
    /// # Panics
    /// If `slot` is not positive or the ids are not 1, 2, ... in this order.
    pub fn new<'a>(walls: Arc<Walls>, slot: Time, motions: impl IntoIterator<Item = &'a mut Motion>) -> Self {
        assert!(slot > Time::ZERO, "the length of a slot is positive");
        let indexed_space = Arc::new(IndexedSpace::new(Space::default(), &walls));
        let mut world = Self {
            walls,
            slot,
            now: Time::ZERO,
            tracks: Vec::new(),
            moving: BoundsIndex::default(),
            resting: BoundsIndex::default(),
            are_resting: Vec::new(),
            removed_count: 0,
            bounds: Vec::new(),
            truth: TrueMotions::default(),
            discs: DiscCache::default(),
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

    /// Adds movable objects at rest at the given poses; their ids are 1, 2, ... in this order.
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

    /// Sets the geometry that only three-dimensional rays and legs can touch: shapes, heights and surfaces.
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

    /// The channel, mutable. Between two slots, the caller passes the messages that robots have sent to the channel.
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
        let robots = (0..self.tracks.len()).map(RobotId::from_index);
        let others = robots.filter(|other| *other != robot && self.is_robot_present(*other, at));
        let reachable = |other: RobotId| {
            let offset = self.tracks[other.index()].centre(at) - position;
            let distance = offset.length();
            if range.is_some_and(|range| distance > range) {
                return Err(Loss::Range);
            }
            let is_occluded =
                line_of_sight && distance > 0.0 && self.walls.cast(position, offset / distance, distance).is_some();
            if is_occluded { Err(Loss::Sight) } else { Ok(()) }
        };
        others.filter_map(|other| Some((other, reachable(other).err()?))).collect()
    }

    /// Number of movable objects, including removed ones.
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
    /// the present slot.
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
    /// called before [`World::advance`]. Of several calls for one object, only the last one has an effect.
    ///
    /// Any pose is allowed: an object inside a wall or a body is pushed out. For a removed object, the call has no
    /// effect.
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

    /// Places a movable object at `world_from_object`, at rest and awake, at the start of the present slot, and
    /// publishes the pose immediately.
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

    /// Starts to keep the steps of movable objects for [`World::take_object_steps`].
    pub fn keep_object_steps(&mut self) {
        if let Some(objects) = &mut self.objects {
            objects.keep_steps();
        }
    }

    /// Returns the steps of movable objects since the last call or, at the first call, since
    /// [`World::keep_object_steps`], in order of time.
    pub fn take_object_steps(&mut self) -> Vec<ObjectStep> {
        self.objects.as_mut().map(|objects| objects.take_steps()).unwrap_or_default()
    }

    /// The movable objects that moved in the previous slot, in ascending order.
    pub fn moved_objects(&self) -> &[ObjectId] {
        self.objects.as_ref().map_or(&[], |objects| objects.moved())
    }

    /// Returns true if a movable object moves, or was placed so recently that it may still be pushed out of an overlap.
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

    /// Published disc of a robot at `at`; `None` if the robot is not present.
    fn disc(&self, robot: RobotId, at: Time) -> Option<Disc> {
        let track = &self.tracks[robot.index()];
        track.lifetime.contains(at).then(|| Disc { centre: track.centre(at), radius: track.radius() })
    }

    /// Published pose of a robot's centre at `at`, which is at most 100 ms before the present slot.
    ///
    /// For a robot's own exact pose see [`Motion::pose`].
    pub fn robot_pose(&self, robot: RobotId, at: Time) -> Pose {
        self.tracks[robot.index()].pose(at)
    }

    /// Published motion of a robot in the present slot: at least one piece, in the order of time. The first piece
    /// includes the slot's start.
    pub fn published_pieces(&self, robot: RobotId) -> impl Iterator<Item = PublishedPiece> {
        let passages = self.tracks[robot.index()].passages();
        // `until` of the last passage is `Time::NEVER`.
        let first = passages.iter().position(|passage| passage.until > self.now).unwrap_or(passages.len() - 1);
        let in_slot = passages[first..]
            .iter()
            .enumerate()
            .take_while(|(index, passage)| *index == 0 || passage.begin_time() < self.slot_end());
        in_slot.map(|(_, passage)| {
            let (start, world_from_robot, twist, duration) = passage.constant_twist(self.now, self.slot_end());
            PublishedPiece { start, world_from_robot, twist, duration }
        })
    }

    /// The bodies of other robots that touch the body of `motion` at `at`, in the order of their ids, for
    /// [`Motion::command`]. The other robots have their published poses, and `motion` has its exact pose.
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
        sort_few(&mut bodies, |body| body.robot);
        bodies.dedup_by_key(|body| body.robot);
        bodies
    }

    /// Ends the present slot: resolves the contacts between bodies in this slot, releases bodies whose path has become
    /// free, publishes the changed motions, and advances to the next slot.
    ///
    /// `active` must contain the motions of all [active](Motion::is_active) robots, in any order; the motions of other
    /// robots may be omitted. Returns the contacts that began in the slot, in the order of (time, robot).
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

    /// First part of the end of a slot: resolves the contacts between bodies, and releases bodies whose path has become
    /// free. `active` contains the motions that [`World::advance`] requires, in the order of ids. `observe` is called
    /// with each motion once the motion's contacts are resolved, while the whole slot can still be queried.
    ///
    /// Returns false if nothing can have changed; the world has then already advanced to the next slot. Otherwise the
    /// caller must publish all [publications](World::publications) and call [`World::conclude`].
    pub(crate) fn settle(
        &mut self,
        active: &mut [&mut Motion],
        pool: &dyn Pool,
        mut observe: impl FnMut(&mut Motion),
    ) -> bool {
        let end = self.slot_end();
        if let [motion] = active
            && self.is_quiescent(motion, end + self.slot)
        {
            observe(motion);
            motion.skip_slot(end);
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
        self.discs.renew(self.tracks.len());
        let mut tracks = self.tracks.iter_mut().enumerate();
        self.truth.active_mut().iter_mut().map(move |slot_motion| {
            let index = slot_motion.robot.index();
            let track = tracks.find(|(other, _)| *other == index);
            let track = track.map(|(_, track)| track).expect("each robot has a track");
            track.is_alone = is_alone;
            Publication { slot_motion, track }
        })
    }

    /// Last part of the end of a slot, after the motions of `active` were published: advances to the next slot.
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
        if self.has_published_plan_only() {
            self.quiescence = Quiescence::default();
            self.are_resting.fill(false);
            return;
        }
        if let [motion] = active
            && self.has_single_robot()
        {
            self.quiescence = Quiescence {
                revision: motion.revision(),
                until: motion.unchanged_until(end).min(end + MAX_QUIESCENCE),
            };
            let (from, to) = (end - HISTORY, self.slot_end().max(self.quiescence.until));
            let published = self.publications().filter(|publication| publication.slot_motion.published.is_some());
            published.for_each(|publication| publication.refresh(from, to));
        }
        let truth = std::mem::take(&mut self.truth);
        self.refresh_index_after(Some(&truth));
        self.truth = truth;
    }

    /// Publishes the plan of `motion` again at the start of the present slot, after the robot was
    /// [placed](Motion::place) or changed at that time.
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
        if !motion.has_variable_height() {
            return;
        }
        let stance = motion.stance(now);
        let parts = motion.legs().map(|legs| legs.parts(&stance)).unwrap_or_default();
        self.stances.insert(motion.id(), PublishedStance { stance, parts });
    }

    /// Three-dimensional pose of a robot's frame at `at`. The height is that of the published stance at the start of
    /// the present slot.
    pub fn robot_pose_in_space(&self, robot: RobotId, at: Time) -> Pose3 {
        Pose3::from_planar(&self.robot_pose(robot, at), self.stance(robot).map_or(0.0, |stance| stance.lift))
    }

    /// Published stance of a robot with legs or in the water, at the start of the present slot; `None` for other
    /// robots.
    pub fn stance(&self, robot: RobotId) -> Option<&Stance> {
        self.stances.get(&robot).map(|published| &published.stance)
    }

    /// Pose in the world at `at` of a part of a robot's legs. The joint angles and the height are those at the start of
    /// the present slot. Parts are indexed as in [`Legs::parts`](crate::drive::legged::Legs::parts); `None` if there is
    /// no such part.
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

    /// Returns true if there is only one robot and its published plan has no passages yet; the robot is then not in the
    /// indices.
    fn has_published_plan_only(&self) -> bool {
        self.has_single_robot() && self.tracks[0].has_plan()
    }

    /// Returns true if there is a single robot and nothing needs to be resolved or published before `until`.
    fn is_quiescent(&self, motion: &Motion, until: Time) -> bool {
        until <= self.quiescence.until
            && motion.revision() == self.quiescence.revision
            && motion.is_uncommanded()
            && self.has_single_robot()
    }

    /// Skips to the slot that starts at `slot_start`. Precondition: until that time no robot is
    /// [active](Motion::is_active), [no object moves](World::is_object_moving) and no program of a robot runs.
    ///
    /// # Panics
    /// If `slot_start` is not the start of the present slot or of a later one.
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

    /// Updates the indices with the bounds of the published motion. Bodies that stay at rest keep their entries.
    fn refresh_index(&mut self) {
        self.refresh_index_after(None);
    }

    /// Like [`World::refresh_index`], but uses the bounds in `published` for the active robots, which have just
    /// published their motion.
    fn refresh_index_after(&mut self, published: Option<&TrueMotions>) {
        let (from, to) = (self.now - HISTORY, self.slot_end().max(self.quiescence.until));
        self.discs.renew(self.tracks.len());
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
                    self.removed_count += usize::from(track.lifetime.until <= from);
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
        // A body that has begun to move stays in the index of bodies at rest until that index is rebuilt.
        let count = self.tracks.len() - self.removed_count - self.bounds.len();
        if has_rest_changed || count != self.resting.len() {
            self.bounds.clear();
            let at_rest = self.tracks.iter().enumerate().filter(|(index, _)| self.are_resting[*index]);
            self.bounds.extend(at_rest.map(|(index, track)| (RobotId::from_index(index), track.bounds())));
            self.resting.rebuild(&self.bounds);
        }
    }

    /// Visits each robot that is present at `at` and may come into `bounds` by its published motion.
    fn for_each_near(&self, bounds: Bounds, at: Time, mut visit: impl FnMut(RobotId)) {
        let mut visit = |robot| {
            if self.is_robot_present(robot, at) {
                visit(robot);
            }
        };
        if self.has_published_plan_only() {
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

    /// Ends the slot of `motion` at `end`, reports the contacts that began in it, in order of time, and publishes the
    /// motion up to `next_end`.
    pub fn publish(self, motion: &mut Motion, end: Time, next_end: Time, mut report_contact: impl FnMut(Contact)) {
        let impacts = self.slot_motion.impacts.take().unwrap_or_else(|| motion.commit(end));
        for impact in impacts.into_iter().filter(|impact| impact.fresh) {
            let Impact { time, thing: with, point, .. } = impact;
            report_contact(Contact { time, robot: self.slot_motion.robot, with, point });
        }
        if self.track.is_alone && self.track.publish_plan(motion, end, next_end) {
            return;
        }
        self.track.publish(motion, end, next_end);
        if !self.track.is_resting() {
            self.refresh(end - HISTORY, next_end);
        }
    }

    /// Computes the bounds of the published motion from `from` to `to`.
    fn refresh(self, from: Time, to: Time) {
        self.track.refresh(from, to);
        self.slot_motion.published = Some((self.track.bounds(), self.track.is_resting()));
    }
}

/// The passage at `at`: the last passage that has begun, or the first if none has.
fn passage_at(passages: &[Passage], at: Time) -> &Passage {
    let last_begun = passages.iter().rposition(|passage| passage.begin_time() <= at);
    &passages[last_begun.unwrap_or(0)]
}
