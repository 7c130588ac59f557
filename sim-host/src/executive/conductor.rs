//! The slot loop: which robots run now, when a slot is over, and what comes after it.
//!
//! There is no thread of its own: whoever suspends last advances the world and releases the next robots, so one robot alone
//! needs no hand-over at all. At most `lanes` robots run at one time; which of them does so when changes nothing, since
//! robots meet only at the slots' ends. A lane hands over within itself as long as it can, since waking a thread on another
//! processor costs several times as much; it takes work of another lane only when it would be idle otherwise.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use parking_lot::MutexGuard;
use sim_core::drive::Motion;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::gate::{Boundary, Gate, Intervention, Pass};
use super::intervene::{self, Effect, Refusal};
use super::radio::Traffic;
use super::run::Run;
use super::signal;
use crate::record::{RecordError, Sink as _, Sinks};
use crate::robios::robot::Robot;
use crate::robios::truth::{Placeable, Placement};
use sim_core::record::{ActionText, Digest, Event, Journal, Recorder, WORLD};

/// Who runs, who waits until when, and where the run's record goes.
pub struct Conductor {
    lanes: Vec<Lane>,
    /// As many as there may be.
    most_lanes: usize,
    /// For each robot the lane that it ran in last.
    homes: Vec<u32>,
    /// Suspended or ended in the present slot.
    ran: Vec<RobotId>,
    /// Bodies in motion, or blocked by another body, at the present slot's start.
    moving: Vec<RobotId>,
    wakes: BinaryHeap<Reverse<Wake>>,
    /// For each robot the number of its valid entry in `wakes`.
    wake_numbers: Vec<u32>,
    /// For each robot whether its program has ended, or it has none.
    departed: Vec<bool>,
    /// Robots with a program that has not ended.
    alive: usize,
    until: Time,
    gate: Option<Box<dyn Gate>>,
    /// Somebody has acted since the last slot: the present one is due.
    has_acted: bool,
    recorder: Recorder,
    /// Who wants to see the record.
    sinks: Sinks<'static>,
    /// Where is recorded what belongs to no robot.
    journal: Journal,
    /// The movable objects have been recorded where they start.
    has_recorded_starts: bool,
    traffic: Traffic,
    end: Option<End>,
}

/// A place in which one robot runs at a time.
#[derive(Default)]
struct Lane {
    /// Due in the present slot, not yet released; in order of their ids.
    ready: VecDeque<RobotId>,
    /// Released and not yet back.
    running: Option<RobotId>,
}

/// So many robots must be ready in a lane before another one takes some of them.
const WORTH_TAKING: usize = 4;

/// An entry of the list of wakes; valid while `number` is the robot's present one.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Wake {
    at: Time,
    robot: RobotId,
    number: u32,
}

/// Why the slot loop stopped.
#[derive(Debug)]
pub enum End {
    /// Every program has ended, or there is none.
    Finished,
    /// The time that the user set is over.
    Until,
    /// Nothing moves and every program that has not ended waits for something that cannot come any more.
    Stuck,
    /// The user interrupted the run.
    Interrupted,
    /// A program broke in a way after which nothing may run on.
    Broken,
    /// What was asked to be recorded cannot be.
    Record(RecordError),
}

/// Whom to resume after a robot has come back, and whether that robot itself goes on at once.
#[derive(Debug, Default)]
pub struct HandOver {
    /// Robots to resume, each with the lane that it runs in.
    pub resume: Vec<(RobotId, u32)>,
    /// The robot that came back is due again.
    pub goes_on: bool,
}

/// What the slot loop is told when it is made.
pub struct Plan {
    /// For each robot whether it has a program; without one it only stands there.
    pub has_program: Vec<bool>,
    /// How many may run at one time.
    pub lanes: usize,
    /// Simulated time at which the run ends.
    pub until: Time,
}

impl Conductor {
    /// The slot loop before the first slot: all robots with programs are due at 0.
    pub fn new(plan: &Plan, recorder: Recorder, sinks: Sinks<'static>, gate: Option<Box<dyn Gate>>) -> Self {
        let count = plan.has_program.len();
        let ids = |has_program| {
            let robots = plan.has_program.iter().enumerate().filter(move |(_, has)| **has == has_program);
            robots.map(|(index, _)| RobotId::from_index(index))
        };
        let alive = ids(true).count();
        let lanes = plan.lanes.clamp(1, alive.max(1));
        let mut conductor = Self {
            lanes: (0..lanes).map(|_| Lane::default()).collect(),
            most_lanes: plan.lanes,
            homes: vec![0; count],
            ran: Vec::new(),
            moving: Vec::new(),
            wakes: BinaryHeap::new(),
            wake_numbers: vec![0; count],
            departed: plan.has_program.iter().map(|has_program| !has_program).collect(),
            alive,
            until: plan.until,
            gate,
            has_acted: false,
            recorder,
            sinks,
            journal: Journal::new(WORLD, false),
            has_recorded_starts: false,
            traffic: Traffic::default(),
            end: None,
        };
        for (place, robot) in ids(true).enumerate() {
            conductor.homes[robot.index()] = (place % lanes) as u32;
            conductor.sleep_until(robot, Time::ZERO);
        }
        if alive > 0 {
            // The first slot records the start of those without a program, too.
            conductor.ran.extend(ids(false));
        }
        conductor
    }

    /// Ends the run after the present slot; an end that was found before stands.
    pub fn end_with(&mut self, end: End) {
        self.end.get_or_insert(end);
    }

    /// The robots that have been released and have not come back.
    pub fn running(&self) -> impl Iterator<Item = RobotId> {
        self.lanes.iter().filter_map(|lane| lane.running)
    }

    /// Where events go.
    pub fn recorder(&mut self) -> &mut Recorder {
        &mut self.recorder
    }

    /// Completes the record at the end of the run, `time`: its digest, and what kept it from being complete.
    pub fn finish_record(&mut self, time: Time) -> (Digest, Result<(), RecordError>) {
        let ended = self.sinks.take_slot(&mut self.recorder, time);
        let digest = self.recorder.digest();
        (digest, ended.and_then(|()| self.sinks.finish(time, digest)))
    }

    /// Gives what is left of the world's own record to the recorder, at the very end.
    pub fn collect_world(&mut self) {
        self.recorder.collect(&mut self.journal);
    }

    /// Releases the first robots, if there are any with a program.
    pub fn begin(&mut self, run: &Run) -> HandOver {
        self.begin_slot(run, &mut run.world.write());
        if self.is_over() {
            run.bell().ring();
        }
        self.go_on(run, None)
    }

    /// `robot` has come back to sleep until `wake`; the slot loop goes on.
    pub fn suspend(&mut self, run: &Run, robot: RobotId, wake: Time) -> HandOver {
        self.retire(robot);
        self.sleep_until(robot, wake);
        self.go_on(run, Some(robot))
    }

    /// The program of `robot` has ended, or broken; the slot loop goes on.
    pub fn depart(&mut self, run: &Run, robot: RobotId) -> HandOver {
        self.retire(robot);
        self.wake_numbers[robot.index()] += 1;
        self.departed[robot.index()] = true;
        self.alive -= 1;
        self.go_on(run, None)
    }

    /// The program of `robot` has left after the end of the run.
    pub fn leave(&mut self, robot: RobotId) {
        self.departed[robot.index()] = true;
    }

    /// True once the program of `robot` has ended or broken, and for a robot without one.
    pub fn has_departed(&self, robot: RobotId) -> bool {
        self.departed[robot.index()]
    }

    /// Simulated time, once the run is over: the end of the last slot, where the world stands then, or the limit that the
    /// user set.
    pub fn time(&self, world: &World) -> Time {
        match self.end {
            Some(End::Until) => world.slot_start().max(self.until),
            _ => world.slot_start(),
        }
    }

    /// Why the run has ended; taken once, at the very end.
    pub fn take_end(&mut self) -> End {
        self.end.take().unwrap_or(End::Finished)
    }

    fn retire(&mut self, robot: RobotId) {
        let lane = &mut self.lanes[self.homes[robot.index()] as usize];
        debug_assert_eq!(lane.running, Some(robot), "only a robot that runs comes back");
        lane.running = None;
        self.ran.push(robot);
    }

    fn make_ready(&mut self, robot: RobotId) {
        self.lanes[self.homes[robot.index()] as usize].ready.push_back(robot);
    }

    /// The next robot for the free lane `lane`: its own, or one of the lane that has the most to do.
    fn next_for(&mut self, lane: usize) -> Option<RobotId> {
        if let Some(robot) = self.lanes[lane].ready.pop_front() {
            return Some(robot);
        }
        let busiest = self.lanes.iter_mut().max_by_key(|lane| lane.ready.len())?;
        if busiest.ready.len() < WORTH_TAKING {
            return None;
        }
        let robot = busiest.ready.pop_back()?;
        self.homes[robot.index()] = lane as u32;
        Some(robot)
    }

    /// Replaces the robot's wake time; [`Time::NEVER`] leaves it without one.
    fn sleep_until(&mut self, robot: RobotId, at: Time) {
        let number = &mut self.wake_numbers[robot.index()];
        *number += 1;
        if at < Time::NEVER {
            self.wakes.push(Reverse(Wake { at, robot, number: *number }));
        }
    }

    /// Fills the free lanes, over as many slots as it takes to find somebody who is due.
    fn go_on(&mut self, run: &Run, who_asks: Option<RobotId>) -> HandOver {
        let mut hand_over = HandOver::default();
        loop {
            for lane in 0..self.lanes.len() {
                if self.lanes[lane].running.is_some() {
                    continue;
                }
                let next = self.next_for(lane);
                self.lanes[lane].running = next;
                match next {
                    Some(robot) if Some(robot) == who_asks => hand_over.goes_on = true,
                    Some(robot) => hand_over.resume.push((robot, lane as u32)),
                    None => {}
                }
            }
            if self.running().next().is_some() || self.is_over() {
                return hand_over;
            }
            if let Err(error) = self.finish_slot(run) {
                self.end = Some(End::Record(error));
            }
            if self.is_over() {
                run.bell().ring();
            }
        }
    }

    /// True when the present slot is complete and no other follows.
    pub fn is_over(&self) -> bool {
        let is_idle = |lane: &Lane| lane.running.is_none() && lane.ready.is_empty();
        self.end.is_some() && self.ran.is_empty() && self.lanes.iter().all(is_idle)
    }

    /// Completes the present slot and, unless the run ends with it, begins the next one in which anything happens.
    fn finish_slot(&mut self, run: &Run) -> Result<(), RecordError> {
        let mut world = run.world.write();
        self.advance_bodies(run, &mut world)?;
        if signal::is_interrupted() {
            self.end_with(End::Interrupted);
        }
        if self.end.is_some() {
            return Ok(());
        }
        self.begin_slot(run, &mut world);
        Ok(())
    }

    /// Begins the next slot in which anything happens, once the gate lets the run go on; without one the run ends.
    fn begin_slot(&mut self, run: &Run, world: &mut World) {
        while self.end.is_none() {
            let next = self.next_start(world);
            let pass = match &mut self.gate {
                Some(gate) => {
                    let following = world.slot_start();
                    gate.wait(&Boundary { run, world, following, next, until: self.until })
                }
                None => Pass::Begin,
            };
            match (pass, next) {
                (Pass::Act { at, actions }, _) => self.act(at.min(next.unwrap_or(at)), actions, run, world),
                (Pass::End(end), _) => self.end_with(end),
                (Pass::Begin, None) => self.end_with(if self.alive == 0 { End::Finished } else { End::Stuck }),
                // The first slot is run whatever the limit.
                (Pass::Begin, Some(start)) if start >= self.until && start > Time::ZERO => {
                    self.end_with(if self.alive == 0 { End::Finished } else { End::Until });
                }
                (Pass::Begin, Some(start)) => {
                    self.has_acted = false;
                    world.advance_to(start);
                    run.publish_slot(world);
                    return self.take_due(world.slot_end());
                }
            }
        }
    }

    /// Lets these actions happen at the start of the slot that contains `at`; those that are refused change nothing.
    fn act(&mut self, at: Time, actions: Vec<Intervention>, run: &Run, world: &mut World) {
        let at = at.floor_to(world.slot()).max(world.slot_start());
        for Intervention { action, answer } in actions {
            let checked = if at < self.until { intervene::check(&action, at, run, world) } else { Err(Refusal::Over) };
            answer(checked.map(|deed| {
                world.advance_to(at);
                self.has_acted = true;
                self.record_starts(world);
                let text = serde_json::to_string(&action).unwrap_or_default();
                self.journal.record(at, &Event::Intervention { action: ActionText(&text) });
                let effect = intervene::carry_out(deed, at, run, world, &mut self.journal);
                self.take_effect(effect, at, run, world);
            }));
        }
    }

    /// Brings the list of wakes in line with what an action at `at` has changed.
    fn take_effect(&mut self, effect: Effect, at: Time, run: &Run, world: &World) {
        for id in effect.robots {
            if let Some(wake) = run.robot(id).wake_after(at).filter(|_| !self.has_departed(id)) {
                self.sleep_until(id, wake);
            }
            self.ran.push(id);
        }
        self.record_objects(world, at, effect.object.into_iter());
        if let Some((id, has_program)) = effect.came {
            self.admit(id, has_program, at);
        }
        if let Some(id) = effect.left {
            // Its program is turned back from the call that it is in.
            self.moving.retain(|moving| *moving != id);
            if !self.has_departed(id) {
                self.sleep_until(id, at);
            }
        }
        if effect.is_end {
            self.end_with(End::Interrupted);
        }
    }

    /// One more robot, which has the next id, is due at `at` if it has a program.
    fn admit(&mut self, robot: RobotId, has_program: bool, at: Time) {
        self.homes.push(0);
        self.wake_numbers.push(0);
        self.departed.push(!has_program);
        if has_program {
            self.alive += 1;
            if self.lanes.len() < self.most_lanes.min(self.alive) {
                self.lanes.push(Lane::default());
            }
            self.homes[robot.index()] = (robot.index() % self.lanes.len()) as u32;
            self.sleep_until(robot, at);
        }
        self.ran.push(robot);
    }

    /// Records where the movable objects start, once.
    fn record_starts(&mut self, world: &World) {
        if !std::mem::replace(&mut self.has_recorded_starts, true) {
            let all = (0..world.object_count()).map(ObjectId::from_index);
            self.record_objects(world, Time::ZERO, all);
        }
    }

    /// Moves the bodies to the slot's end, resolves their contacts and records what the slot brought.
    fn advance_bodies(&mut self, run: &Run, world: &mut World) -> Result<(), RecordError> {
        let slot_end = world.slot_end();
        let mut active = std::mem::take(&mut self.moving);
        active.append(&mut self.ran);
        active.sort_unstable();
        active.dedup();
        let placements = self.take_requests(run, &active, world);
        self.traffic.exchange(slot_end, world.radio_mut(), &mut active);
        active.extend(placements.iter().filter_map(|placement| match placement.what {
            Placeable::Robot(id) => Some(id),
            Placeable::Object(_) => None,
        }));
        active.sort_unstable();
        active.dedup();
        self.record_starts(world);
        let mut robots: Vec<MutexGuard<'_, Robot>> = active.iter().map(|id| run.robot(*id)).collect();
        for placement in &placements {
            self.place(placement, world, &mut robots);
        }
        let contacts = {
            let there = robots.iter_mut().filter(|robot| !run.is_removed(robot.id));
            let mut motions: Vec<&mut Motion> = there.map(|robot| &mut robot.motion).collect();
            world.advance(&mut motions)
        };
        self.record_objects(world, slot_end, world.moved_objects().iter().copied());
        self.recorder.collect(&mut self.journal);
        for contact in contacts {
            if let Ok(place) = active.binary_search(&contact.robot) {
                robots[place].record_contact(&contact);
            }
        }
        self.traffic.deliver(slot_end, &mut robots);
        save_files(&mut robots);
        for robot in &mut robots {
            if run.is_removed(robot.id) {
                self.recorder.collect(&mut robot.journal);
                continue;
            }
            // Who follows poses knows the height of a walking body then.
            robot.record_walk(world, slot_end);
            robot.record_pose(slot_end);
            if robot.motion.is_active() {
                self.moving.push(robot.id);
            }
            if let Some(wake) = robot.wake_after(slot_end) {
                self.sleep_until(robot.id, wake);
            }
            self.recorder.collect(&mut robot.journal);
        }
        self.sinks.take_slot(&mut self.recorder, slot_end)
    }

    /// Puts a robot or an object elsewhere, at the slot's end.
    fn place(&mut self, placement: &Placement, world: &mut World, robots: &mut [MutexGuard<'_, Robot>]) {
        let Placement { by, what, pose, .. } = *placement;
        let slot_end = world.slot_end();
        match what {
            Placeable::Robot(id) => {
                let Ok(place) = robots.binary_search_by_key(&id, |robot| robot.id) else { return };
                // The program's millimetres are always a place, here and below.
                let _ = robots[place].motion.place(slot_end, pose);
                robots[place].record_placed(slot_end, by, &pose);
            }
            Placeable::Object(object) => {
                let _ = world.place_object(object, pose);
                let (x_m, y_m) = (pose.position.x, pose.position.y);
                let event =
                    Event::ObjectPlaced { object: object.0, by: by.0, x_m, y_m, phi_rad: pose.heading.remainder() };
                self.journal.record(slot_end, &event);
            }
        }
    }

    /// Records where these movable objects are at `at`.
    fn record_objects(&mut self, world: &World, at: Time, objects: impl Iterator<Item = ObjectId>) {
        for object in objects {
            let pose = world.object_pose(object, at);
            let event = Event::Object {
                object: object.0,
                x_m: pose.position.x,
                y_m: pose.position.y,
                phi_rad: pose.heading.remainder(),
                turns: pose.heading.turns(),
            };
            self.journal.record(at, &event);
        }
    }

    /// The start of the next slot in which a body moves or a robot is due; none when that never happens.
    fn next_start(&mut self, world: &World) -> Option<Time> {
        // The world has gone on to the slot after the one that was finished.
        let following = world.slot_start();
        if self.has_acted || world.is_object_moving() {
            return Some(following);
        }
        if !self.moving.is_empty() {
            // A drive that nobody waits for may go on for ever once all programs have ended: that is no reason to run on.
            return (self.alive > 0).then_some(following);
        }
        while let Some(Reverse(wake)) = self.wakes.peek()
            && self.wake_numbers[wake.robot.index()] != wake.number
        {
            self.wakes.pop();
        }
        let wake = self.wakes.peek().map_or(Time::NEVER, |Reverse(wake)| wake.at);
        // A message that nobody lives to hear is no reason to run on either.
        let message = if self.alive > 0 { self.traffic.due(world.radio()) } else { Time::NEVER };
        let due = wake.min(message);
        (due < Time::NEVER).then(|| due.floor_to(world.slot()).max(following))
    }

    /// Takes what these robots' programs have asked of the world in the slot: what is to be put elsewhere, in order, and what is
    /// to be sent.
    fn take_requests(&mut self, run: &Run, robots: &[RobotId], world: &mut World) -> Vec<Placement> {
        let mut placements = Vec::new();
        for id in robots {
            let mut robot = run.robot(*id);
            placements.append(&mut robot.placements);
            self.traffic.collect(&mut robot, world.radio_mut());
        }
        // Each robot's own are in order already.
        placements.sort_by_key(|placement| (placement.time, placement.by));
        placements
    }

    /// Moves the robots that are due before `slot_end` to the ready list.
    fn take_due(&mut self, slot_end: Time) {
        while self.wakes.peek().is_some_and(|Reverse(wake)| wake.at < slot_end)
            && let Some(Reverse(Wake { robot, number, .. })) = self.wakes.pop()
        {
            if self.wake_numbers[robot.index()] == number {
                self.make_ready(robot);
            }
        }
        for lane in &mut self.lanes {
            lane.ready.make_contiguous().sort_unstable();
        }
    }
}

/// Puts on the disk what robots wrote in the slot that ends, in order of (virtual time, robot).
fn save_files(robots: &mut [MutexGuard<'_, Robot>]) {
    let mut files = Vec::new();
    for (index, robot) in robots.iter_mut().enumerate() {
        files.extend(robot.devices.storage.take_written().map(|file| (file, index)));
    }
    files.sort_by_key(|(file, index)| (file.at, *index));
    for (file, index) in files {
        if let Err(error) = file.save() {
            robots[index].hint(&format!("`{}` cannot be written: {error}", file.path.display()));
        }
    }
}
