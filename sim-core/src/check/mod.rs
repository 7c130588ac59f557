//! Evaluation of checks on the motion of bodies, at exact instants.
//!
//! A [`Monitor`] sees the motion of each slot before the world forgets it, as sections in closed form, and evaluates it
//! in cells of 100 ms of virtual time. Cells and sections do not depend on the slots, and neither do instants and
//! verdicts. A monitor only reads: it draws no random numbers and records nothing. The host evaluates checks on events,
//! output and the report.

mod pending;
mod region;
mod section;
mod swarm;
#[cfg(test)]
mod tests;
mod watch;

use std::sync::Arc;

use glam::DVec2;

use crate::drive::Motion;
use crate::object::STEP;
use crate::scene::Walls;
use crate::spec::{BodyRef, CheckKind, SceneSpec};
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};
use pending::PendingMotion;
use watch::{Surroundings, Watch};

/// Length of a cell: the interval of virtual time that is evaluated at once.
const CELL: Time = Time::from_millis(100);

/// Result of a check on motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// True if the condition is met.
    pub is_met: bool,
    /// Instant of the verdict, s: when the condition was met, or first violated, or came nearest to being met.
    pub at: Option<f64>,
    /// Position of the body at that instant, world frame, m.
    pub position: Option<DVec2>,
    /// The measured quantity, which depends on the variant of [`CheckKind`]: distance to the place, number of places or
    /// passages, smallest gap, share, maximum error; in m, or a pure number.
    pub value: Option<f64>,
}

/// Evaluates the checks of a scene that concern motion: `reach`, `visits`, `stays_in`, `laps`, `clearance`,
/// `follows_wall`, `coverage`, `odometry_error`, `swarm`.
#[derive(Clone, Debug)]
pub struct Monitor {
    /// The checks with their indices in the scene.
    watches: Vec<(usize, Watch)>,
    walls: Arc<Walls>,
    /// Instant after which motion does not count.
    until: Time,
    /// Robots in the order of their ids; `None` for a robot that was not observed yet.
    robots: Vec<Option<PendingMotion>>,
    objects: Vec<Option<PendingMotion>>,
    /// Robots whose odometry is checked.
    odometry_of: Vec<RobotId>,
    /// True if a check concerns movable objects.
    wants_objects: bool,
    /// Start of the first cell that has not been evaluated.
    cell: Time,
}

impl Monitor {
    /// Monitor of a run of `scene` up to `until`; `None` if no check of the scene concerns motion.
    pub fn new(scene: &SceneSpec, walls: &Arc<Walls>, until: Time) -> Option<Self> {
        let watches = scene.checks.iter().enumerate();
        let watches: Vec<(usize, Watch)> =
            watches.filter_map(|(index, check)| Some((index, Watch::new(&check.kind, scene)?))).collect();
        if watches.is_empty() {
            return None;
        }
        let odometry_of = scene.checks.iter().filter_map(|check| match check.kind {
            CheckKind::OdometryError { robot, .. } => Some(robot),
            _ => None,
        });
        let mut bodies = scene.checks.iter().flat_map(|check| check.kind.bodies());
        Some(Self {
            watches,
            walls: Arc::clone(walls),
            until: until.max(Time(1)),
            robots: Vec::new(),
            objects: Vec::new(),
            odometry_of: odometry_of.collect(),
            wants_objects: bodies.any(|body| matches!(body, BodyRef::Object(_))),
            cell: Time::ZERO,
        })
    }

    /// Returns true if a check concerns movable objects.
    pub fn wants_objects(&self) -> bool {
        self.wants_objects
    }

    /// Takes the motion of a robot in the slot `from` to `to`, as resolved and not yet committed.
    pub(crate) fn observe(&mut self, motion: &mut Motion, (from, to): (Time, Time)) {
        let to = to.min(self.until);
        if from >= to {
            return;
        }
        let index = motion.id().index();
        if self.robots.len() <= index {
            self.robots.resize_with(index + 1, || None);
        }
        let wants_odometry = self.odometry_of.contains(&motion.id());
        let pending = self.robots[index].get_or_insert_with(|| PendingMotion::of_robot(motion, from, wants_odometry));
        pending.append_robot(motion, (from, to));
    }

    /// Ends the slot that ends at `to`: bodies not observed in it were at rest. Evaluates the complete cells.
    pub(crate) fn end_slot(&mut self, world: &mut World, to: Time) {
        let to = to.min(self.until);
        self.rest(world, to);
        while self.cell + CELL <= to {
            let is_at_rest = self.pending().all(PendingMotion::is_at_rest);
            let until = if is_at_rest { to.floor_to(CELL) } else { self.cell + CELL };
            self.evaluate(until);
        }
    }

    /// Ends the run at `time`; `is_settled` if it ended because nothing can happen any more.
    pub fn finish(&mut self, world: &mut World, time: Time, is_settled: bool) {
        // A run of length 0 shows where the bodies start.
        let time = time.min(self.until).max(Time(1));
        self.end_slot(world, time);
        if self.cell < time {
            self.evaluate(time);
        }
        let end = time.seconds();
        self.watches.iter_mut().for_each(|(_, watch)| watch.finish(end, is_settled));
    }

    /// The findings up to the last cell, each with the index of its check in the scene.
    pub fn findings(&self) -> impl Iterator<Item = (usize, Finding)> {
        self.watches.iter().map(|(index, watch)| (*index, watch.finding()))
    }

    /// The metrics of swarms over time, each with the index of its check in the scene: instants (s) at which the value
    /// changed, with the new values.
    pub fn series(&self) -> impl Iterator<Item = (usize, &[[f64; 2]])> {
        self.watches.iter().filter_map(|(index, watch)| Some((*index, watch.series()?)))
    }

    fn pending(&self) -> impl Iterator<Item = &PendingMotion> {
        self.robots.iter().chain(&self.objects).flatten()
    }

    /// Keeps all bodies that were not observed up to `to` at rest until then, or until their removal.
    fn rest(&mut self, world: &mut World, to: Time) {
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
        if !self.wants_objects {
            return;
        }
        self.objects.resize_with(world.object_count(), || None);
        let steps = world.take_object_steps();
        for (index, pending) in self.objects.iter_mut().enumerate() {
            let id = ObjectId::from_index(index);
            let lifetime = world.object_lifetime(id);
            let (until, since) = (to.min(lifetime.until), lifetime.since.max(Time::ZERO));
            let mut own = steps.iter().filter(|step| step.object == id).peekable();
            let first = own.peek().map_or_else(|| world.object_pose(id, to).position, |step| step.from);
            let pending = pending.get_or_insert_with(|| PendingMotion::resting(first, 0.0, since));
            own.filter(|step| step.end <= until).for_each(|step| pending.step(step));
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
        let times = (self.cell, until);
        let surroundings = Surroundings { walls: &self.walls, robots: &robots, objects: &objects };
        self.watches.iter_mut().for_each(|(_, watch)| watch.take(&surroundings, times));
        self.cell = until;
    }
}
