//! What all robots share: the world, the messages on their way, and the record; and the end of a slot.

use super::traffic::Traffic;
use super::{Placeable, Placement, Robot, Robots};
use crate::drive::Motion;
use crate::record::{Digest, Event, Journal, Recorder, WORLD};
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};

/// What all robots of a simulation share.
///
/// Within a slot robots only look at it. At the slot's end [`Environment::concerned`] tells which robots the end concerns, and
/// [`Environment::end_slot`] with exactly these brings the world to the end of the slot, delivers messages and collects journals.
#[derive(Clone, Debug)]
pub struct Environment {
    /// The world.
    pub world: World,
    recorder: Recorder,
    /// Records what belongs to no robot.
    journal: Journal,
    /// Bodies in motion, or blocked by another body, at the present slot's start.
    moving: Vec<RobotId>,
    traffic: Traffic,
    placements: Vec<Placement>,
    /// The movable objects have been recorded where they start.
    has_recorded_starts: bool,
}

/// What the end of a slot has brought to robots from outside of them.
#[derive(Clone, Debug, Default)]
pub struct SlotEnd {
    /// When the slot ended.
    pub at: Time,
    /// To whom a message comes, and when that is visible; not yet in the robot's virtual time.
    pub heard: Vec<(RobotId, Time)>,
}

impl Environment {
    /// This world before the first slot, recorded by `recorder`.
    pub fn new(world: World, recorder: Recorder) -> Self {
        Self {
            world,
            recorder,
            journal: Journal::new(WORLD, false),
            moving: Vec::new(),
            traffic: Traffic::default(),
            placements: Vec::new(),
            has_recorded_starts: false,
        }
    }

    /// The record.
    pub fn recorder(&mut self) -> &mut Recorder {
        &mut self.recorder
    }

    /// The digest of the run up to the last slot that has ended.
    pub fn digest(&self) -> Digest {
        self.recorder.digest()
    }

    /// The journal of what belongs to no robot.
    pub fn journal(&mut self) -> &mut Journal {
        &mut self.journal
    }

    /// True when some robot moves or is blocked by another body at the start of the present slot.
    pub fn is_robot_moving(&self) -> bool {
        !self.moving.is_empty()
    }

    /// When a slot is to be run for messages though nobody is due; [`Time::NEVER`] if none is under way.
    pub fn message_due(&self) -> Time {
        self.traffic.due(self.world.radio())
    }

    /// Robot `id` has been taken out of the world: it moves no more.
    pub fn forget(&mut self, id: RobotId) {
        self.moving.retain(|moving| *moving != id);
    }

    /// The robots that the end of the present slot concerns, in the order of their ids: those of `ran`, who acted in it, those that
    /// move, those that messages reach, and those that are put elsewhere.
    pub fn concerned(&mut self, ran: &[RobotId], robots: &mut (impl Robots + ?Sized)) -> Vec<RobotId> {
        let mut concerned = std::mem::take(&mut self.moving);
        concerned.extend_from_slice(ran);
        concerned.sort_unstable();
        concerned.dedup();
        let Self { world, traffic, placements, .. } = self;
        for id in &concerned {
            robots.with(*id, |robot| {
                placements.append(&mut robot.placements);
                traffic.collect(robot, world.radio_mut());
            });
        }
        // Each robot's own are in order already.
        placements.sort_by_key(|placement| (placement.time, placement.by));
        traffic.exchange(world.slot_end(), world.radio_mut(), &mut concerned);
        concerned.extend(placements.iter().filter_map(|placement| match placement.what {
            Placeable::Robot(id) => Some(id),
            Placeable::Object(_) => None,
        }));
        concerned.sort_unstable();
        concerned.dedup();
        concerned
    }

    /// Ends the present slot with the robots that it concerns, in the order of their ids: puts elsewhere what was asked for, moves
    /// the bodies to the slot's end, resolves their contacts, delivers messages, and collects what was recorded.
    pub fn end_slot(&mut self, robots: &mut [&mut Robot]) -> SlotEnd {
        let at = self.world.slot_end();
        self.record_starts();
        for placement in std::mem::take(&mut self.placements) {
            self.place(&placement, robots);
        }
        let contacts = {
            let present = robots.iter_mut().filter(|robot| !robot.is_removed);
            let mut motions: Vec<&mut Motion> = present.map(|robot| &mut robot.motion).collect();
            self.world.advance(&mut motions)
        };
        let Self { world, journal, recorder, .. } = self;
        record_objects(journal, world, at, world.moved_objects().iter().copied());
        recorder.collect(journal);
        for contact in contacts {
            if let Ok(place) = robots.binary_search_by_key(&contact.robot, |robot| robot.id) {
                robots[place].record_contact(&contact);
            }
        }
        let heard = self.traffic.deliver(at, robots);
        for robot in robots {
            if !robot.is_removed {
                // Who follows poses knows the height of a walking body then.
                robot.record_walk(world, at);
                robot.record_pose(at);
                if robot.motion.is_active() {
                    self.moving.push(robot.id);
                }
            }
            recorder.collect(&mut robot.journal);
        }
        SlotEnd { at, heard }
    }

    /// Ends the run at `time`: what of messages is undecided is lost, and what belongs to no robot is recorded. Next comes
    /// [`Environment::finish_radio`] for each robot, in the order of their ids.
    pub fn finish(&mut self, time: Time) {
        self.traffic.finish(time, self.world.radio_mut());
        self.recorder.collect(&mut self.journal);
    }

    /// Records what becomes of the messages that were on their way to `robot` when the run ended.
    pub fn finish_radio(&mut self, robot: &mut Robot) {
        self.traffic.finish_robot(robot);
    }

    /// Records where the movable objects start, once.
    pub fn record_starts(&mut self) {
        if !std::mem::replace(&mut self.has_recorded_starts, true) {
            let all = (0..self.world.object_count()).map(ObjectId::from_index);
            record_objects(&mut self.journal, &self.world, Time::ZERO, all);
        }
    }

    /// Records where a movable object is at `at`.
    pub fn record_object(&mut self, at: Time, object: ObjectId) {
        record_objects(&mut self.journal, &self.world, at, std::iter::once(object));
    }

    /// Puts a robot or an object elsewhere, at the slot's end.
    fn place(&mut self, placement: &Placement, robots: &mut [&mut Robot]) {
        let Placement { by, what, pose, .. } = *placement;
        let slot_end = self.world.slot_end();
        match what {
            Placeable::Robot(id) => {
                let Ok(place) = robots.binary_search_by_key(&id, |robot| robot.id) else { return };
                // Whoever asked has made sure that it is a place, here and below.
                let _ = robots[place].motion.place(slot_end, pose);
                robots[place].record_placed(slot_end, by, &pose);
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

/// Records where these movable objects are at `at`.
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
