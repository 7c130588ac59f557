//! Environment: the state that robots share (world, messages in transit, record), and the end of a slot.

use super::robot::record_contact;
use super::traffic::Traffic;
use super::{Placeable, Placement, Robot, Robots};
use crate::check::Monitor;
use crate::drive::Motion;
use crate::parallel::{self, Pool};
use crate::record::{Digest, Event, Journal, Recorder, WORLD};
use crate::time::Time;
use crate::world::{Publication, World};
use crate::{ObjectId, RobotId};

/// State shared by all robots of a simulation.
///
/// During a slot robots only read this state. At the end of the slot, [`Environment::affected_robots`] returns the
/// robots that the end affects. [`Environment::end_slot`], called with exactly these robots, advances the world,
/// delivers messages and collects journals.
#[derive(Clone, Debug)]
pub struct Environment {
    /// The world.
    pub world: World,
    recorder: Recorder,
    /// Journal of the world's events.
    journal: Journal,
    /// Robots that move or are blocked by another body at the start of the present slot.
    moving: Vec<RobotId>,
    /// Robots affected by the end of the present slot.
    affected: Vec<RobotId>,
    /// For each affected robot, true if the end of the next slot affects it too, even if its program does not act.
    is_active: Vec<bool>,
    /// True once a robot has been removed.
    has_removed_robots: bool,
    traffic: Traffic,
    placements: Vec<Placement>,
    /// True once the initial poses of the movable objects are recorded.
    has_recorded_starts: bool,
    /// Evaluates the checks on motion.
    monitor: Option<Box<Monitor>>,
    /// Reused memory for vectors of references.
    spare_motions: Vec<usize>,
    spare_endings: Vec<[usize; 4]>,
}

/// End of a slot for one robot: inputs and results.
struct RobotEnding<'a> {
    robot: &'a mut Robot,
    /// The robot's publication; `None` if the world has not processed its motion.
    publication: Option<Publication<'a>>,
    is_active: &'a mut bool,
}

/// Effects of the end of a slot on the robots.
#[derive(Clone, Debug, Default)]
pub struct SlotEnd {
    /// End of the slot.
    pub at: Time,
    /// Receivers of messages, each with the time when the message becomes visible. The robot's virtual time has not
    /// reached this time yet.
    pub arrivals: Vec<(RobotId, Time)>,
}

impl Environment {
    /// Environment with `world` before the first slot; `recorder` records it.
    pub fn new(world: World, recorder: Recorder) -> Self {
        Self {
            world,
            recorder,
            journal: Journal::new(WORLD, false),
            moving: Vec::new(),
            affected: Vec::new(),
            is_active: Vec::new(),
            has_removed_robots: false,
            traffic: Traffic::default(),
            placements: Vec::new(),
            has_recorded_starts: false,
            monitor: None,
            spare_motions: Vec::new(),
            spare_endings: Vec::new(),
        }
    }

    /// This environment with a monitor of the robots' motion; must be called before the first slot.
    pub fn with_monitor(mut self, monitor: Option<Monitor>) -> Self {
        self.monitor = monitor.map(Box::new);
        if self.monitor.as_ref().is_some_and(|monitor| monitor.needs_objects()) {
            self.world.keep_object_steps();
        }
        self
    }

    /// The monitor, if the scene has checks on motion.
    pub fn monitor(&self) -> Option<&Monitor> {
        self.monitor.as_deref()
    }

    /// Ends the run at `time` for the monitor; `is_settled` is true if nothing can happen after `time`.
    pub fn finish_monitor(&mut self, time: Time, is_settled: bool) {
        if let Some(monitor) = &mut self.monitor {
            monitor.finish(&mut self.world, time, is_settled);
        }
    }

    /// The recorder of the run, mutable.
    pub fn recorder(&mut self) -> &mut Recorder {
        &mut self.recorder
    }

    /// Digest of the run up to the last ended slot.
    pub fn digest(&self) -> Digest {
        self.recorder.digest()
    }

    /// Journal of the world's events.
    pub fn journal(&mut self) -> &mut Journal {
        &mut self.journal
    }

    /// Returns true if a robot moves or is blocked by another body at the start of the present slot.
    pub fn is_robot_moving(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Next instant whose slot must be run for messages even if no robot is due; [`Time::NEVER`] if no message is in
    /// transit.
    pub fn message_due(&self) -> Time {
        self.traffic.due(self.world.radio())
    }

    /// Handles the removal of robot `id` from the world: removes it from the list of moving robots.
    pub fn forget_robot(&mut self, id: RobotId) {
        self.has_removed_robots = true;
        self.moving.retain(|moving| *moving != id);
    }

    /// Finds the robots affected by the end of the present slot: robots that have acted in it (`acted`), moving robots,
    /// receivers and senders of messages, and robots that are to be placed. Returns them in the order of their ids.
    /// `requesting` are the robots that may have [requests](Robot::has_requests), in the order of their ids.
    pub fn affected_robots(
        &mut self,
        acted: &[RobotId],
        requesting: &[RobotId],
        robots: &mut (impl Robots + ?Sized),
    ) -> &[RobotId] {
        let Self { world, traffic, placements, affected, .. } = self;
        std::mem::swap(affected, &mut self.moving);
        self.moving.clear();
        affected.extend_from_slice(acted);
        affected.sort_unstable();
        affected.dedup();
        for id in requesting {
            robots.with(*id, |robot| {
                placements.append(&mut robot.placements);
                traffic.collect(robot, world.radio_mut());
            });
        }
        // The sort is stable, and the placements of each robot are already in order.
        placements.sort_by_key(|placement| (placement.time, placement.by));
        let count = affected.len();
        traffic.exchange(world.slot_end(), world.radio_mut(), affected);
        affected.extend(placements.iter().filter_map(|placement| match placement.what {
            Placeable::Robot(id) => Some(id),
            Placeable::Object(_) => None,
        }));
        if affected.len() > count {
            affected.sort_unstable();
            affected.dedup();
        }
        &self.affected
    }

    /// Ends the present slot with the [affected robots](Environment::affected_robots), in the order of their ids.
    /// Applies requested placements, moves the bodies to the end of the slot, resolves their contacts, delivers
    /// messages, and collects the journals. Work for a single robot runs on `pool`.
    pub fn end_slot(&mut self, robots: &mut [&mut Robot], pool: &dyn Pool) -> SlotEnd {
        let at = self.world.slot_end();
        self.record_starts();
        for placement in std::mem::take(&mut self.placements) {
            self.place(&placement, robots);
        }
        let mut motions: Vec<&mut Motion> = parallel::reuse(std::mem::take(&mut self.spare_motions));
        let has_removed = self.has_removed_robots;
        let present = robots.iter_mut().filter(|robot| !(has_removed && robot.is_removed));
        motions.extend(present.map(|robot| &mut robot.motion));
        let (monitor, slot) = (&mut self.monitor, (self.world.slot_start(), at));
        let is_settled = self.world.settle(&mut motions, pool, |motion| {
            if let Some(monitor) = monitor {
                monitor.observe(motion, slot);
            }
        });
        self.spare_motions = parallel::reuse(motions);
        let arrivals = self.traffic.deliver(robots);
        // The posture is recorded before the pose, so that a reader has the height of the body before it reads the
        // pose. The contacts of legs, which are recorded with the posture, depend on the published motion of all
        // robots.
        let has_stances = self.world.has_stances();
        let next_slot_end = at + self.world.slot();
        self.is_active.clear();
        self.is_active.resize(robots.len(), false);
        let mut endings: Vec<RobotEnding<'_>> = parallel::reuse(std::mem::take(&mut self.spare_endings));
        {
            let mut publications = is_settled.then(|| self.world.publications()).into_iter().flatten().peekable();
            for ((robot, id), is_active) in robots.iter_mut().zip(&self.affected).zip(&mut self.is_active) {
                let publication = publications.next_if(|publication| publication.robot() == *id);
                endings.push(RobotEnding { robot, publication, is_active });
            }
        }
        pool.for_each(&mut endings, |RobotEnding { robot, publication, is_active }| {
            if let Some(publication) = publication.take() {
                let Robot { motion, journal, .. } = &mut **robot;
                publication.publish(motion, at, next_slot_end, |contact| record_contact(journal, &contact));
            }
            if !has_stances {
                **is_active = robot.end_slot(None, at);
            }
        });
        self.spare_endings = parallel::reuse(endings);
        if is_settled {
            let mut motions: Vec<&mut Motion> = parallel::reuse(std::mem::take(&mut self.spare_motions));
            let present = robots.iter_mut().filter(|robot| !(has_removed && robot.is_removed));
            motions.extend(present.map(|robot| &mut robot.motion));
            self.world.conclude(&mut motions);
            self.spare_motions = parallel::reuse(motions);
        }
        if let Some(monitor) = &mut self.monitor {
            monitor.end_slot(&mut self.world, at);
        }
        let Self { world, journal, recorder, .. } = self;
        record_objects(journal, world, at, world.moved_objects().iter().copied());
        recorder.collect(journal);
        for ((robot, id), is_active) in robots.iter_mut().zip(&self.affected).zip(&self.is_active) {
            let is_active = if has_stances { robot.end_slot(Some(world), at) } else { *is_active };
            if is_active {
                self.moving.push(*id);
            }
            recorder.collect(&mut robot.journal);
        }
        SlotEnd { at, arrivals }
    }

    /// Ends the run at `time`: messages whose outcome is not decided are lost, and the world's events are recorded. The
    /// caller must then call [`Environment::finish_radio`] for each robot, in the order of their ids.
    pub fn finish(&mut self, time: Time) {
        self.traffic.finish(time, self.world.radio_mut());
        self.recorder.collect(&mut self.journal);
    }

    /// Records the outcomes of the messages that were in transit to `robot` when the run ended.
    pub fn finish_radio(&mut self, robot: &mut Robot) {
        self.traffic.finish_robot(robot);
    }

    /// Records the initial poses of the movable objects, once.
    pub fn record_starts(&mut self) {
        if !std::mem::replace(&mut self.has_recorded_starts, true) {
            let objects = (0..self.world.object_count()).map(ObjectId::from_index);
            record_objects(&mut self.journal, &self.world, Time::ZERO, objects);
        }
    }

    /// Records the pose of a movable object at `at`.
    pub fn record_object(&mut self, at: Time, object: ObjectId) {
        record_objects(&mut self.journal, &self.world, at, std::iter::once(object));
    }

    /// Places a robot or an object at the end of the slot.
    fn place(&mut self, placement: &Placement, robots: &mut [&mut Robot]) {
        let Placement { by, what, pose, .. } = *placement;
        let slot_end = self.world.slot_end();
        match what {
            Placeable::Robot(id) => {
                let Ok(index) = robots.binary_search_by_key(&id, |robot| robot.id) else { return };
                // The pose was validated with the request, also for objects.
                let _ = robots[index].motion.place(slot_end, pose);
                robots[index].record_placed(slot_end, by, &pose);
            }
            Placeable::Object(object) => {
                let _ = self.world.place_object(object, pose);
                let (x_m, y_m) = (pose.position.x, pose.position.y);
                let phi_rad = pose.heading.remainder();
                self.journal.record(slot_end, &Event::ObjectPlaced { object: object.0, by: by.0, x_m, y_m, phi_rad });
            }
        }
    }
}

/// Records the poses of movable objects at `at`.
fn record_objects(journal: &mut Journal, world: &World, at: Time, objects: impl Iterator<Item = ObjectId>) {
    for object in objects {
        let pose = world.object_pose(object, at);
        let event = Event::Object {
            object: object.0,
            x_m: pose.position.x,
            y_m: pose.position.y,
            phi_rad: pose.heading.remainder(),
            turns: pose.heading.turns(),
        };
        journal.record(at, &event);
    }
}
