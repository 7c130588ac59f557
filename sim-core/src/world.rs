//! All robots in one world: what each can see of the others, and the end of a slot.
//!
//! During a slot nobody changes the world: robots look at what was made public at the start of the slot ([`World::cast`],
//! [`World::touching`]), each at its own virtual time. At the end of the slot [`World::advance`] settles the contacts
//! between bodies, makes public what has changed, and goes on to the next slot.

mod near;
mod objects;
mod presence;
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
    drive::{HISTORY, Motion, Passage},
    object::{Properties, State},
    pose::{PlaceError, Pose, Pose3, Twist},
    radio::{Channel, Loss, Model},
    scene::{Bounds, Moving, Walls},
    time::Time,
};
use objects::Objects;
pub use presence::Presence;
pub use ray::{Face, Ray, RayHit, Tilt};
use settle::{Settling, Truth};
use space::Stage;
pub use space::{Block, Space};
pub use touch::{Closeness, LegTouch};
use track::Track;

/// A contact that began in a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The first microsecond not before it.
    pub time: Time,
    /// Whose body was stopped.
    pub robot: RobotId,
    /// What it met.
    pub with: Thing,
    /// The touched point, in the world.
    pub point: DVec2,
}

/// A stretch of a robot's public motion: constant rates, then rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// When it starts.
    pub start: Time,
    /// Pose of the robot's centre then.
    pub from: Pose,
    /// Twist of its centre, in its own frame.
    pub twist: Twist,
    /// Seconds from the start until it comes to rest; may be infinite.
    pub after: f64,
}

/// The static walls and the public trajectories of all robots, for the present slot and the 100 ms before.
///
/// A copy goes on as the original does, to the bit, and neither is disturbed by what the other one does. It shares what never
/// changes: walls, shapes, surfaces.
#[derive(Clone, Debug)]
pub struct World {
    walls: Arc<Walls>,
    slot: Time,
    now: Time,
    /// In the order of the robots' ids.
    tracks: Vec<Track>,
    /// Where the public trajectories lead from 100 ms before the present slot to its end, of the bodies that move.
    moving: Moving<RobotId>,
    /// Where the others stand.
    resting: Moving<RobotId>,
    /// How many have been gone for longer than the world remembers.
    forgotten: usize,
    /// For the next rebuild of an index.
    bounds: Vec<(RobotId, Bounds)>,
    truth: Truth,
    /// The movable objects, in a scene that has any.
    objects: Option<Box<Objects>>,
    /// What rays in space meet beside all these.
    stage: Arc<Stage>,
    calm: Calm,
    radio: Channel,
    /// Of robots with legs.
    held: BTreeMap<RobotId, Held>,
}

/// How a robot with legs holds itself at the start of the present slot.
#[derive(Clone, Debug, PartialEq)]
struct Held {
    lift: f64,
    /// Frames of the parts of its legs in its own.
    parts: Vec<Pose3>,
}

/// Until when a robot that is alone in the world goes on by its plan of this revision with nothing to settle or make public.
#[derive(Clone, Copy, Debug, Default)]
struct Calm {
    revision: u64,
    until: Time,
}

/// Calm is known at most this far ahead, so that a robot's rectangle in the index stays small.
const CALM: Time = Time::from_millis(10_000);

impl World {
    /// The world at the start of the run, with slots of the length `slot` and the robots of `motions`, in the order of
    /// their ids from 1 on.
    ///
    /// # Panics
    /// If `slot` is not positive or the ids are not 1, 2, ... in this order.
    pub fn new<'a>(walls: Arc<Walls>, slot: Time, motions: impl IntoIterator<Item = &'a mut Motion>) -> Self {
        assert!(slot > Time::ZERO, "a slot has a length");
        let stage = Arc::new(Stage::new(Space::default(), &walls));
        let mut world = Self {
            walls,
            slot,
            now: Time::ZERO,
            tracks: Vec::new(),
            moving: Moving::default(),
            resting: Moving::default(),
            forgotten: 0,
            bounds: Vec::new(),
            truth: Truth::default(),
            objects: None,
            stage,
            calm: Calm::default(),
            radio: Channel::default(),
            held: BTreeMap::new(),
        };
        for (index, motion) in motions.into_iter().enumerate() {
            assert_eq!(motion.id().index(), index, "robots are given in the order of their ids");
            world.tracks.push(Track::new(motion, Presence::ALWAYS, (Time::ZERO, slot)));
            world.hold(motion, Time::ZERO);
        }
        world.refresh_index();
        world
    }

    /// This world with movable objects at rest at these poses, in the order of their ids from 1 on.
    ///
    /// # Panics
    /// If there are any in a build without the feature `objects`.
    pub fn with_objects(mut self, objects: impl IntoIterator<Item = (Arc<Properties>, Pose)>) -> Self {
        let mut objects = objects.into_iter().peekable();
        if objects.peek().is_some() {
            self.objects = Some(Box::new(Objects::new(&self.walls, objects)));
        }
        self
    }

    /// This world with what only rays in space tell apart: shapes, heights and surfaces.
    pub fn with_space(mut self, space: Space) -> Self {
        self.stage = Arc::new(Stage::new(space, &self.walls));
        self
    }

    /// This world with a channel between the robots' radios.
    pub fn with_radio(mut self, channel: Channel) -> Self {
        self.radio = channel;
        self
    }

    /// The channel between the robots' radios, as it was made public at the start of the slot.
    pub fn radio(&self) -> &Channel {
        &self.radio
    }

    /// The same, to be told of what was sent, between two slots.
    pub fn radio_mut(&mut self) -> &mut Channel {
        &mut self.radio
    }

    /// Who cannot hear what the radio of `robot` sends from `position` at `at`, and why, in the order of their ids: those beyond the
    /// channel's range, those behind a wall of whatever height where it needs a line of sight. Bodies stop no message: our choice.
    pub fn out_of_reach(&self, robot: RobotId, position: DVec2, at: Time) -> Vec<(RobotId, Loss)> {
        let Model { range, line_of_sight, .. } = *self.radio.model();
        if range.is_none() && !line_of_sight {
            return Vec::new();
        }
        let others = (0..self.tracks.len()).map(RobotId::from_index);
        let others = others.filter(|other| *other != robot && self.is_robot_there(*other, at));
        let reached = |other: RobotId| {
            let way = self.tracks[other.index()].centre(at) - position;
            let distance = way.length();
            if range.is_some_and(|range| distance > range) {
                return Err(Loss::Range);
            }
            let is_hidden =
                line_of_sight && distance > 0.0 && self.walls.cast(position, way / distance, distance).is_some();
            if is_hidden { Err(Loss::Sight) } else { Ok(()) }
        };
        others.filter_map(|other| Some((other, reached(other).err()?))).collect()
    }

    /// Number of movable objects, those that are gone included.
    pub fn object_count(&self) -> usize {
        self.objects.as_ref().map_or(0, |objects| objects.len())
    }

    /// Pose of a movable object at `at`, as it was public at `at`: not more than 100 ms before the present slot.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_pose(&self, object: ObjectId, at: Time) -> Pose {
        self.objects().pose(object, at)
    }

    /// A movable object as of the last step of 1 ms that has ended.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn object_state(&self, object: ObjectId) -> State {
        self.objects().state(object)
    }

    /// Gives a movable object a velocity of its centre of mass, m/s, and a turning speed, rad/s, at the start of the slot.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn set_object_velocity(&mut self, object: ObjectId, velocity: DVec2, omega: f64) {
        let (now, end) = (self.now, self.slot_end());
        let objects = self.objects.as_mut().expect("the scene has this object");
        objects.set_velocity(object, velocity, omega, now);
        objects.publish(now, end);
    }

    /// Puts a movable object at `world_from_object`, at rest and awake, at the end of the present slot: before
    /// [`World::advance`]. Of several places the last one stands.
    ///
    /// Any place will do: in a wall or a body it is pushed out. An object that is gone stays so.
    ///
    /// # Errors
    /// [`PlaceError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn place_object(&mut self, object: ObjectId, world_from_object: Pose) -> Result<(), PlaceError> {
        world_from_object.check_place()?;
        self.objects.as_mut().expect("the scene has this object").place(object, world_from_object);
        Ok(())
    }

    /// Puts a movable object at `world_from_object` now, at the start of the slot, at rest and awake; everybody sees it there at once.
    ///
    /// Any place will do: in a wall or a body it is pushed out.
    ///
    /// # Errors
    /// [`PlaceError`] for a position that is not finite or beyond 10^9 m.
    ///
    /// # Panics
    /// If there is no such object.
    pub fn place_object_now(&mut self, object: ObjectId, world_from_object: Pose) -> Result<(), PlaceError> {
        self.place_object(object, world_from_object)?;
        let (now, end) = (self.now, self.slot_end());
        let objects = self.objects.as_mut().expect("the scene has this object");
        objects.settle_places();
        objects.publish(now, end);
        Ok(())
    }

    /// The movable objects that have moved in the slot that ended last, in ascending order.
    pub fn moved_objects(&self) -> &[ObjectId] {
        self.objects.as_ref().map_or(&[], |objects| objects.moved())
    }

    /// True while a movable object moves, or has been placed so lately that it may yet be pushed out of something.
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

    /// End of the present slot, which does not belong to it.
    pub fn slot_end(&self) -> Time {
        self.now + self.slot
    }

    /// The body of a robot at `at`, as it was public at `at`: not more than 100 ms before the present slot.
    pub fn body(&self, robot: RobotId, at: Time) -> Body {
        let track = &self.tracks[robot.index()];
        Body { robot, centre: track.centre(at), radius: track.radius() }
    }

    /// Pose of a robot's centre at `at`, as it was public at `at`: not more than 100 ms before the present slot.
    ///
    /// A robot that asks for itself has the truth in [`Motion::pose`].
    pub fn robot_pose(&self, robot: RobotId, at: Time) -> Pose {
        self.tracks[robot.index()].pose(at)
    }

    /// How a robot moves in the present slot, as far as that is public: at least one stretch, in the order of time, of which the
    /// first holds at the slot's start.
    pub fn stretches(&self, robot: RobotId) -> impl Iterator<Item = Stretch> {
        let passages = self.tracks[robot.index()].passages();
        // A passage without an end is the last one.
        let first = passages.iter().position(|passage| passage.until > self.now).unwrap_or(passages.len() - 1);
        let in_slot = passages[first..]
            .iter()
            .enumerate()
            .take_while(|(index, passage)| *index == 0 || passage.start < self.slot_end());
        in_slot.map(|(_, passage)| Stretch {
            start: passage.start,
            from: passage.pose(passage.start),
            twist: passage.path.twist,
            after: passage.after,
        })
    }

    /// The bodies of other robots that are in contact with `motion`'s at `at`, by their public trajectories and its own
    /// truth, in the order of their ids: what [`Motion::command`] needs.
    pub fn touching(&self, motion: &mut Motion, at: Time) -> Vec<Body> {
        if self.tracks.len() < 2 {
            return Vec::new();
        }
        let centre = motion.pose(at).position;
        let radius = motion.radius();
        let mut bodies = Vec::new();
        self.for_each_near(Bounds::of_disc(centre, radius + TOUCH), at, |robot| {
            if robot != motion.id() {
                let body = self.body(robot, at);
                if (body.centre - centre).length() <= radius + body.radius + TOUCH {
                    bodies.push(body);
                }
            }
        });
        bodies.sort_by_key(|body| body.robot);
        bodies
    }

    /// Ends the present slot: settles the contacts between bodies within it, lets bodies go on whose way has become free,
    /// makes public what has changed, and goes on to the next slot.
    ///
    /// `active` holds the motions of all robots that are [active](Motion::is_active), in any order; others may be left out.
    /// Returns the contacts that began in the slot, in the order of (time, robot).
    pub fn advance(&mut self, active: &mut [&mut Motion]) -> Vec<Contact> {
        let end = self.slot_end();
        if let [motion] = active
            && self.is_calm(motion, end + self.slot)
        {
            motion.pass(end);
            self.now = end;
            self.hold(motion, end);
            return Vec::new();
        }
        active.sort_by_key(|motion| motion.id());
        let mut truth = std::mem::take(&mut self.truth);
        let mut objects = self.objects.take();
        Settling::new(&mut truth, self, active).run(objects.as_deref_mut());
        self.objects = objects;
        let mut contacts = Vec::new();
        for motion in active.iter_mut() {
            let robot = motion.id();
            contacts.extend(motion.commit(end).into_iter().filter(|impact| impact.fresh).map(|impact| Contact {
                time: impact.time,
                robot,
                with: impact.thing,
                point: impact.point,
            }));
        }
        contacts.sort_by_key(|contact| (contact.time, contact.robot));
        if active.iter().any(|motion| motion.blocker().is_some()) {
            Settling::new(&mut truth, self, active).resume();
        }
        self.truth = truth;
        self.now = end;
        if let Some(objects) = &mut self.objects {
            objects.settle_places();
            objects.publish(end, end + self.slot);
        }
        for motion in active.iter_mut() {
            self.tracks[motion.id().index()].publish(motion, end, end + self.slot);
            self.hold(motion, end);
        }
        if let [motion] = active
            && self.is_for_one()
        {
            self.calm = Calm { revision: motion.revision(), until: motion.steady_until(end).min(end + CALM) };
        }
        self.refresh_index();
        contacts
    }

    /// Makes public what `motion` plans for the present slot, at its start, after it was [placed](Motion::place) or changed there.
    pub fn republish(&mut self, motion: &mut Motion) {
        let (now, end) = (self.now, self.slot_end());
        self.tracks[motion.id().index()].publish(motion, now, end);
        self.hold(motion, now);
        self.calm = Calm::default();
        self.refresh_index();
    }

    /// Makes public how a robot with legs holds itself at `now`.
    fn hold(&mut self, motion: &mut Motion, now: Time) {
        if motion.legs().is_none() {
            return;
        }
        let stance = motion.stance(now);
        let parts = motion.legs().map(|legs| legs.parts(&stance)).unwrap_or_default();
        self.held.insert(motion.id(), Held { lift: stance.lift, parts });
    }

    /// Pose of a robot's body in space at `at`, on its legs as it holds itself at the start of the present slot.
    pub fn robot_pose_in_space(&self, robot: RobotId, at: Time) -> Pose3 {
        Pose3::from_planar(&self.robot_pose(robot, at), self.held.get(&robot).map_or(0.0, |held| held.lift))
    }

    /// Pose of a part of a robot's legs, in the order of [`Legs::parts`](crate::drive::legged::Legs::parts), in the world at `at`, the
    /// robot holding itself as at the start of the present slot; `None` where there is no such part.
    pub fn leg_part_pose(&self, robot: RobotId, part: usize, at: Time) -> Option<Pose3> {
        let robot_from_part = self.held.get(&robot)?.parts.get(part)?;
        Some(self.robot_pose_in_space(robot, at).then(robot_from_part))
    }

    /// There is one robot and nothing else that moves.
    fn is_for_one(&self) -> bool {
        self.tracks.len() == 1 && self.objects.is_none()
    }

    /// Nothing is to be settled or made public until `until`: what most slots of a lone robot are like.
    fn is_calm(&self, motion: &Motion, until: Time) -> bool {
        until <= self.calm.until
            && motion.revision() == self.calm.revision
            && motion.is_uncommanded()
            && self.is_for_one()
    }

    /// Goes on to the slot that starts at `slot_start`, when no robot is [active](Motion::is_active), [no object
    /// moves](World::is_object_moving) and no robot is to wake before.
    ///
    /// # Panics
    /// If `slot_start` is not the start of a slot, or lies before the present one.
    pub fn advance_to(&mut self, slot_start: Time) {
        assert!(
            slot_start >= self.now && slot_start.floor_to(self.slot) == slot_start,
            "{slot_start} starts no later slot"
        );
        if slot_start > self.now
            && let Some(objects) = &mut self.objects
        {
            objects.skip_to(slot_start);
            objects.publish(slot_start, slot_start + self.slot);
        }
        self.now = slot_start;
        self.refresh_index();
    }

    /// Enters the bounds of the public trajectories into the indices; bodies that stay where they are cost nothing.
    fn refresh_index(&mut self) {
        let (from, to) = (self.now - HISTORY, self.slot_end().max(self.calm.until));
        let mut has_rest_changed = false;
        self.bounds.clear();
        for (index, track) in self.tracks.iter_mut().enumerate() {
            if !track.is_resting() {
                track.refresh(from, to);
                self.forgotten += usize::from(track.presence.until <= from);
                has_rest_changed |= track.is_resting();
                self.bounds.push((RobotId::from_index(index), track.bounds()));
            }
        }
        if has_rest_changed {
            self.bounds.retain(|(robot, _)| !self.tracks[robot.index()].is_resting());
        }
        if !(self.bounds.is_empty() && self.moving.is_empty()) {
            self.moving.rebuild(&self.bounds);
        }
        // A body that has set off is left in the index of those at rest only if that is built anew.
        let count = self.tracks.len() - self.forgotten - self.bounds.len();
        if has_rest_changed || count != self.resting.len() {
            self.bounds.clear();
            let at_rest = self.tracks.iter().enumerate().filter(|(_, track)| track.is_resting());
            self.bounds.extend(at_rest.map(|(index, track)| (RobotId::from_index(index), track.bounds())));
            self.resting.rebuild(&self.bounds);
        }
    }

    /// Visits each robot that is there at `at` whose public trajectory comes near `bounds`.
    fn for_each_near(&self, bounds: Bounds, at: Time, mut visit: impl FnMut(RobotId)) {
        let mut visit = |robot| {
            if self.is_robot_there(robot, at) {
                visit(robot);
            }
        };
        self.resting.for_each_in(bounds, &mut visit);
        self.moving.for_each_in(bounds, &mut visit);
    }
}

/// The passage that holds at `at`: the last that has started, or the first.
fn passage_at(passages: &[Passage], at: Time) -> &Passage {
    let started = passages.iter().rposition(|passage| passage.start <= at);
    &passages[started.unwrap_or(0)]
}
