//! Evaluation of checks on the motion of bodies, at exact instants.
//!
//! A [`Monitor`] receives the motion of each slot, as sections in closed form, before the world discards the slot. It
//! evaluates the motion in cells: intervals of 100 ms of virtual time. Cells and sections do not depend on the slots,
//! so the verdicts and their instants do not either. A monitor only reads: it draws no random numbers and records
//! nothing. The host evaluates checks on events, output and the report.

mod condition;
mod pending;
mod region;
mod section;
mod swarm;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::DVec2;

use crate::drive::Motion;
use crate::object::STEP;
use crate::scene::Walls;
use crate::spec::{BodyRef, CheckKind, SceneSpec};
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};
use condition::{Condition, Surroundings};
use pending::PendingMotion;

/// Length of a cell: the interval of virtual time that is evaluated at once.
const CELL: Time = Time::from_millis(100);

/// Result of a check on motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// True if the condition is met.
    pub is_met: bool,
    /// Instant of the verdict, s: when the condition was met or first violated, when the body was nearest to the place
    /// that it did not reach, or when it visited the last of the places so far.
    pub at: Option<f64>,
    /// Position of the body at that instant, world frame, m.
    pub position: Option<DVec2>,
    /// The measured quantity, in m or as a pure number. It depends on the variant of [`CheckKind`]: distance to the
    /// centre of the place (for a polygon, to its border), number of places or passages, minimum gap, fraction, maximum
    /// error, or metric of a swarm.
    pub value: Option<f64>,
}

/// Evaluates the checks of a scene that concern motion: `reach`, `visits`, `stays_in`, `laps`, `clearance`,
/// `follows_wall`, `coverage`, `odometry_error`, `swarm`.
#[derive(Clone, Debug)]
pub struct Monitor {
    /// The checks with their indices in the scene.
    conditions: Vec<(usize, Condition)>,
    walls: Arc<Walls>,
    /// Instant after which motion is not evaluated.
    until: Time,
    /// Robots in the order of their ids; `None` for a robot that was not observed yet.
    robots: Vec<Option<PendingMotion>>,
    objects: Vec<Option<PendingMotion>>,
    /// Robots whose odometry is checked.
    odometry_robots: Vec<RobotId>,
    /// True if a check concerns movable objects.
    needs_objects: bool,
    /// Start of the first cell that is not yet evaluated.
    cell_start: Time,
}

impl Monitor {
    /// Monitor of a run of `scene` up to `until`; `None` if no check of the scene concerns motion.
    pub fn new(scene: &SceneSpec, walls: &Arc<Walls>, until: Time) -> Option<Self> {
        let conditions = scene.checks.iter().enumerate();
        let conditions: Vec<(usize, Condition)> =
            conditions.filter_map(|(index, check)| Some((index, Condition::new(&check.kind, scene)?))).collect();
        if conditions.is_empty() {
            return None;
        }
        let odometry_robots = scene.checks.iter().filter_map(|check| match check.kind {
            CheckKind::OdometryError { robot, .. } => Some(robot),
            _ => None,
        });
        let mut bodies = scene.checks.iter().flat_map(|check| check.kind.bodies());
        Some(Self {
            conditions,
            walls: Arc::clone(walls),
            until: until.max(Time(1)),
            robots: Vec::new(),
            objects: Vec::new(),
            odometry_robots: odometry_robots.collect(),
            needs_objects: bodies.any(|body| matches!(body, BodyRef::Object(_))),
            cell_start: Time::ZERO,
        })
    }

    /// Returns true if a check concerns movable objects.
    pub fn needs_objects(&self) -> bool {
        self.needs_objects
    }

    /// Adds the motion of a robot in the slot from `from` to `to`. Its contacts must be resolved, and the slot must not
    /// be committed yet ([`Motion::commit`]).
    pub(crate) fn observe(&mut self, motion: &mut Motion, (from, to): (Time, Time)) {
        let to = to.min(self.until);
        if from >= to {
            return;
        }
        let index = motion.id().index();
        if self.robots.len() <= index {
            self.robots.resize_with(index + 1, || None);
        }
        let needs_odometry = self.odometry_robots.contains(&motion.id());
        let pending = self.robots[index].get_or_insert_with(|| PendingMotion::of_robot(motion, from, needs_odometry));
        pending.append_robot(motion, (from, to));
    }

    /// Ends the slot at `to` and evaluates all complete cells. Bodies that were not observed in the slot were at rest.
    pub(crate) fn end_slot(&mut self, world: &mut World, to: Time) {
        let to = to.min(self.until);
        self.extend_rest(world, to);
        while self.cell_start + CELL <= to {
            let is_at_rest = self.pending().all(PendingMotion::is_at_rest);
            let until = if is_at_rest { to.floor_to(CELL) } else { self.cell_start + CELL };
            self.evaluate(until);
        }
    }

    /// Ends the run at `time`; `is_settled` is true if the run ended because nothing can happen any more.
    pub fn finish(&mut self, world: &mut World, time: Time, is_settled: bool) {
        // In a run of length 0 the conditions are evaluated at the initial positions.
        let time = time.min(self.until).max(Time(1));
        self.end_slot(world, time);
        if self.cell_start < time {
            self.evaluate(time);
        }
        let end = time.seconds();
        self.conditions.iter_mut().for_each(|(_, condition)| condition.finish(end, is_settled));
    }

    /// Findings up to the last evaluated cell, each with the index of its check in the scene.
    pub fn findings(&self) -> impl Iterator<Item = (usize, Finding)> {
        self.conditions.iter().map(|(index, condition)| (*index, condition.finding()))
    }

    /// Metrics of swarms over time, each with the index of its check in the scene. A metric is a list of pairs: the
    /// instant of a change in s, and the new value.
    pub fn series(&self) -> impl Iterator<Item = (usize, &[[f64; 2]])> {
        self.conditions.iter().filter_map(|(index, condition)| Some((*index, condition.series()?)))
    }

    fn pending(&self) -> impl Iterator<Item = &PendingMotion> {
        self.robots.iter().chain(&self.objects).flatten()
    }

    /// Extends the motion of each body to `to`, or to the body's removal: objects make the steps of the slot, and a
    /// body without further motion rests.
    fn extend_rest(&mut self, world: &mut World, to: Time) {
        self.robots.resize_with(world.robot_count(), || None);
        for (index, pending) in self.robots.iter_mut().enumerate() {
            let id = RobotId::from_index(index);
            let lifetime = world.robot_lifetime(id);
            let until = to.min(lifetime.until);
            let since = lifetime.since.max(Time::ZERO);
            let pending = pending.get_or_insert_with(|| {
                let body = world.body(id, to.max(since));
                PendingMotion::resting(body.centre, body.radius, since)
            });
            pending.rest_until(until);
        }
        if !self.needs_objects {
            return;
        }
        self.objects.resize_with(world.object_count(), || None);
        let steps = world.take_object_steps();
        for (index, pending) in self.objects.iter_mut().enumerate() {
            let id = ObjectId::from_index(index);
            let lifetime = world.object_lifetime(id);
            let (until, since) = (to.min(lifetime.until), lifetime.since.max(Time::ZERO));
            let mut object_steps = steps.iter().filter(|step| step.object == id).peekable();
            let first_position =
                object_steps.peek().map_or_else(|| world.object_pose(id, to).position, |step| step.from);
            let pending = pending.get_or_insert_with(|| PendingMotion::resting(first_position, 0.0, since));
            object_steps.filter(|step| step.end <= until).for_each(|step| pending.append_step(step));
            // The next step begins on the grid of steps even if the slot does not end on it.
            pending.rest_until(if until < lifetime.until { until.floor_to(STEP) } else { until });
        }
    }

    /// Evaluates all sections from the start of the current cell to `until`.
    fn evaluate(&mut self, until: Time) {
        let seconds = until.seconds();
        let [robots, objects] = [&mut self.robots, &mut self.objects]
            .map(|bodies| bodies.iter_mut().map(|pending| pending.as_mut().map(|pending| pending.take_until(seconds))));
        let (robots, objects) = (robots.collect::<Vec<_>>(), objects.collect::<Vec<_>>());
        let times = (self.cell_start, until);
        let surroundings = Surroundings { walls: &self.walls, robots: &robots, objects: &objects };
        self.conditions.iter_mut().for_each(|(_, condition)| condition.evaluate(&surroundings, times));
        self.cell_start = until;
    }
}
