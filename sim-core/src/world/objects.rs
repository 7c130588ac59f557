//! The movable objects of a world: their rigid bodies and their published motion.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use glam::DVec2;

use super::Lifetime;
use crate::{
    ObjectId, RobotId,
    drive::HISTORY,
    object::{Bodies, ObjectTrajectory, Properties, Push, Pusher, STEP, State},
    pose::Pose,
    scene::{Bounds, BoundsIndex, Walls},
    time::Time,
};

/// Margin in metres within which an object is regarded as near a robot, in addition to the distance that it moves in a
/// few steps.
const NEAR_DISTANCE: f64 = 5e-3;

/// Published motion of one object.
#[derive(Clone, Debug)]
struct ObjectTrack {
    lifetime: Lifetime,
    /// Trajectories, each with the start of the slot from which it is valid; never empty.
    publications: VecDeque<(Time, ObjectTrajectory)>,
    /// Bounds of the object during the published history and the present slot.
    bounds: Bounds,
    /// True if the object has been at rest, or removed, throughout the published history.
    is_resting: bool,
}

impl ObjectTrack {
    fn new(bodies: &Bodies, object: ObjectId, lifetime: Lifetime, until: Time) -> Self {
        let trajectory = ObjectTrajectory::new(Time(i64::MIN), bodies.state(object), bodies.properties(object));
        Self {
            lifetime,
            publications: VecDeque::from([(Time(i64::MIN), trajectory)]),
            bounds: trajectory.bounds(bodies.properties(object), until),
            is_resting: true,
        }
    }
}

/// The movable objects of a world.
#[derive(Clone, Debug)]
pub(super) struct Objects {
    bodies: Bodies,
    tracks: Vec<ObjectTrack>,
    /// Index of the objects by their published bounds.
    index: BoundsIndex<ObjectId>,
    /// End of the last step of the bodies, a multiple of [`STEP`].
    step_end: Time,
    /// Objects that moved in the last slot, in ascending order.
    moved: Vec<ObjectId>,
    /// Placements that are applied at the end of the slot, in the order of the calls.
    placements: Vec<(ObjectId, Pose)>,
    /// Objects that have not been asleep since they were placed; they may still be pushed out of an overlap.
    unsettled: BTreeSet<ObjectId>,
    pushes: Vec<Push>,
    /// The kept steps of the objects; `None` if steps are not kept.
    kept_steps: Option<Vec<ObjectStep>>,
}

/// Motion of a movable object's origin in one step of the bodies, along a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectStep {
    /// The object.
    pub object: ObjectId,
    /// Start of the step.
    pub start: Time,
    /// End of the step.
    pub end: Time,
    /// Position at the start, m.
    pub from: DVec2,
    /// Position at the end, m.
    pub to: DVec2,
    /// True if the object was placed at `to`, without motion between the two positions.
    pub is_jump: bool,
}

impl Objects {
    pub fn new(walls: &Walls, objects: impl IntoIterator<Item = (Arc<Properties>, Pose)>) -> Self {
        let bodies = Bodies::new(walls, objects);
        let ids = (0..bodies.len()).map(ObjectId::from_index);
        let tracks = ids.map(|object| ObjectTrack::new(&bodies, object, Lifetime::ALWAYS, Time::ZERO)).collect();
        let mut objects = Self {
            bodies,
            tracks,
            index: BoundsIndex::default(),
            step_end: Time::ZERO,
            moved: Vec::new(),
            placements: Vec::new(),
            unsettled: BTreeSet::new(),
            pushes: Vec::new(),
            kept_steps: None,
        };
        objects.rebuild_index();
        objects
    }

    pub fn len(&self) -> usize {
        self.tracks.len()
    }

    /// Adds an object at `world_from_object` from `now` on, at rest and awake; its id is the next one.
    pub fn add(&mut self, properties: Arc<Properties>, world_from_object: Pose, now: Time) -> ObjectId {
        let object = self.bodies.add(properties, world_from_object);
        let track = ObjectTrack::new(&self.bodies, object, Lifetime::since(now), now);
        self.tracks.push(ObjectTrack { is_resting: false, ..track });
        self.unsettled.insert(object);
        self.rebuild_index();
        object
    }

    /// Removes an object from `now` on.
    pub fn remove(&mut self, object: ObjectId, now: Time) {
        let track = &mut self.tracks[object.index()];
        track.lifetime.until = track.lifetime.until.min(now);
        track.is_resting = false;
        self.bodies.remove(object);
        self.unsettled.remove(&object);
        self.placements.retain(|(placed, _)| *placed != object);
        self.moved.retain(|moved| *moved != object);
    }

    /// Removes the body of a robot.
    pub fn remove_robot(&mut self, robot: RobotId) {
        self.bodies.remove_robot(robot);
    }

    /// Lifetime of an object in the world.
    pub fn lifetime(&self, object: ObjectId) -> Lifetime {
        self.tracks[object.index()].lifetime
    }

    /// The present object with the lowest id whose footprint is nearer to `centre` than `radius` at the start of the
    /// slot.
    pub fn first_within(&self, centre: DVec2, radius: f64) -> Option<ObjectId> {
        let ids = (0..self.len()).map(ObjectId::from_index);
        ids.filter(|object| !self.bodies.is_removed(*object)).find(|object| {
            let world_from_object = self.state(*object).world_from_object;
            let centre = world_from_object.inverse_transform_point(centre);
            self.properties(*object).distance(centre) < radius
        })
    }

    pub fn properties(&self, object: ObjectId) -> &Arc<Properties> {
        self.bodies.properties(object)
    }

    /// Published pose at `at`; for a removed object, its last pose.
    pub fn pose(&self, object: ObjectId, at: Time) -> Pose {
        let ObjectTrack { publications, lifetime, .. } = &self.tracks[object.index()];
        let at = at.min(lifetime.until);
        let in_force = publications.iter().rposition(|(since, _)| *since <= at).unwrap_or(0);
        publications[in_force].1.pose(self.properties(object), at)
    }

    pub fn state(&self, object: ObjectId) -> State {
        self.bodies.state(object)
    }

    pub fn set_velocity(&mut self, object: ObjectId, velocity: DVec2, omega: f64, now: Time) {
        self.bodies.set_velocity(object, velocity, omega);
        let trajectory =
            ObjectTrajectory::new(self.step_end.max(now), self.bodies.state(object), self.bodies.properties(object));
        self.tracks[object.index()].publications.push_back((now, trajectory));
        self.tracks[object.index()].is_resting = false;
    }

    /// Stores a placement for the end of the slot.
    pub fn queue_placement(&mut self, object: ObjectId, world_from_object: Pose) {
        assert!(object.index() < self.len(), "the scene has this object");
        if !self.bodies.is_removed(object) {
            self.placements.push((object, world_from_object));
        }
    }

    /// Applies the queued placements.
    pub fn apply_placements(&mut self) {
        for (object, world_from_object) in self.placements.drain(..) {
            if let Some(steps) = &mut self.kept_steps {
                let from = self.bodies.state(object).world_from_object.position;
                let (start, end, to) = (self.step_end, self.step_end, world_from_object.position);
                steps.push(ObjectStep { object, start, end, from, to, is_jump: true });
            }
            self.bodies.place(object, world_from_object);
            self.tracks[object.index()].is_resting = false;
            self.unsettled.insert(object);
        }
    }

    pub fn moved(&self) -> &[ObjectId] {
        &self.moved
    }

    /// Returns true if an object moves, or may still be pushed out of an overlap after a placement.
    pub fn is_moving(&self) -> bool {
        !self.unsettled.is_empty() || self.bodies.awake().any(|object| !self.bodies.state(object).is_resting())
    }

    /// Calls `visit` once for each object that is present at `at` and whose published bounds the ray crosses. `visit`
    /// returns the distance up to which the search continues.
    pub fn along_ray(
        &self,
        origin: DVec2,
        direction: DVec2,
        range: f64,
        at: Time,
        mut visit: impl FnMut(ObjectId) -> f64,
    ) {
        self.index.along_ray(origin, direction, range, |object| {
            if self.lifetime(object).contains(at) { visit(object) } else { range }
        });
    }

    /// Calls `visit` once for each object that is present at `at` and whose published bounds overlap `bounds`, in
    /// ascending order.
    pub fn for_each_in(&self, bounds: Bounds, at: Time, mut visit: impl FnMut(ObjectId)) {
        self.index.for_each_in(bounds, |object| self.visit_if_present(object, at, &mut visit));
    }

    fn visit_if_present(&self, object: ObjectId, at: Time, mut visit: impl FnMut(ObjectId)) {
        if self.lifetime(object).contains(at) {
            visit(object);
        }
    }

    /// Returns true if an object, asleep or awake, may come near `bounds`.
    pub fn is_near(&self, bounds: Bounds) -> bool {
        let mut is_near = false;
        self.index.for_each_in(bounds.grown(NEAR_DISTANCE), |object| is_near |= !self.bodies.is_removed(object));
        is_near
    }

    /// Bounds of the awake objects during the next step, with a margin.
    pub fn awake_bounds(&self) -> Vec<Bounds> {
        let bounds = |object| {
            let state = self.bodies.state(object);
            let properties = self.bodies.properties(object);
            let speed = state.velocity.length() + state.omega.abs() * properties.reach();
            properties.bounds(&state.world_from_object).grown(NEAR_DISTANCE + 4.0 * speed * STEP.seconds())
        };
        self.bodies.awake().map(bounds).collect()
    }

    /// Returns true if every object is asleep.
    pub fn is_asleep(&self) -> bool {
        self.bodies.awake().next().is_none()
    }

    /// Start of the next step.
    pub fn next_step(&self) -> Time {
        self.step_end
    }

    /// Advances all objects by one step in which the given robots push them.
    pub fn step(&mut self, robots: &[Pusher]) -> &[Push] {
        let positions_before = self.kept_steps.as_ref().map(|_| self.positions());
        self.bodies.step(robots, &mut self.pushes);
        let start = self.step_end;
        self.step_end += STEP;
        if let Some(positions_before) = positions_before {
            let (positions_after, end) = (self.positions(), self.step_end);
            let moved =
                positions_before.into_iter().zip(positions_after).enumerate().filter(|(_, (from, to))| from != to);
            let step = |(index, (from, to))| ObjectStep {
                object: ObjectId::from_index(index),
                start,
                end,
                from,
                to,
                is_jump: false,
            };
            self.kept_steps.iter_mut().for_each(|steps| steps.extend(moved.clone().map(step)));
        }
        &self.pushes
    }

    /// Positions of all objects at the end of the last step.
    fn positions(&self) -> Vec<DVec2> {
        let ids = (0..self.len()).map(ObjectId::from_index);
        ids.map(|object| self.bodies.state(object).world_from_object.position).collect()
    }

    /// Starts to keep the steps.
    pub fn keep_steps(&mut self) {
        self.kept_steps.get_or_insert_default();
    }

    /// Removes and returns the kept steps.
    pub fn take_steps(&mut self) -> Vec<ObjectStep> {
        self.kept_steps.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Advances the time of the next step to `until` without a step: the objects do not move.
    pub fn skip_to(&mut self, until: Time) {
        self.step_end = self.step_end.max(until.floor_to(STEP));
    }

    /// Publishes the objects' motion at `now`, the start of the slot that ends at `until`.
    pub fn publish(&mut self, now: Time, until: Time) {
        self.moved.clear();
        self.unsettled.retain(|object| !self.bodies.is_asleep(*object));
        let mut has_changed = false;
        for (index, track) in self.tracks.iter_mut().enumerate() {
            let object = ObjectId::from_index(index);
            if track.is_resting && self.bodies.is_asleep(object) {
                continue;
            }
            if self.bodies.is_removed(object) {
                if track.lifetime.until <= now - HISTORY {
                    (track.bounds, track.is_resting, has_changed) = (Bounds::EMPTY, true, true);
                }
                continue;
            }
            let properties = self.bodies.properties(object);
            let state = self.bodies.state(object);
            let (_, last) = track.publications[track.publications.len() - 1];
            let trajectory = ObjectTrajectory::new(self.step_end, state, properties);
            if last.state.is_resting() && state == last.state {
                // The object rests, and this state is already published.
            } else {
                self.moved.push(object);
                track.publications.push_back((now, trajectory));
            }
            while track.publications.len() > 1 && track.publications[1].0 <= now - HISTORY {
                track.publications.pop_front();
            }
            track.bounds = Bounds::EMPTY;
            for (publication_index, (_, trajectory)) in track.publications.iter().enumerate() {
                let until = track.publications.get(publication_index + 1).map_or(until, |(next, _)| *next);
                track.bounds = track.bounds.union(trajectory.bounds(properties, until));
            }
            track.is_resting = track.publications.len() == 1 && track.publications[0].1.state.is_resting();
            has_changed = true;
        }
        if has_changed {
            self.rebuild_index();
        }
    }

    fn rebuild_index(&mut self) {
        let bounds: Vec<_> =
            self.tracks.iter().enumerate().map(|(index, track)| (ObjectId::from_index(index), track.bounds)).collect();
        self.index.rebuild(&bounds);
    }
}
