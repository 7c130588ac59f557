//! The run queues and the scheduler step: which robots run now, when a slot is over, and what comes after it.
//!
//! There is no thread of its own. The last flow that reaches the barrier at a slot's end runs the step: it advances the world and
//! releases the next robots, slot after slot up to the horizon that the run's owner has set, so one robot alone needs no hand-over at
//! all. At the horizon the run pauses and its owner goes on. At most `lanes` robots run at one time; which of them does so when
//! changes nothing, since robots meet only at the slots' ends. A lane hands over within itself as long as it can, since waking a
//! thread on another processor costs several times as much; it takes work of another lane only when it would be idle otherwise.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::time::Instant;

use parking_lot::MutexGuard;
use sim_core::RobotId;
use sim_core::simulation::{self, Environment, SlotEnd};
use sim_core::time::Time;
use sim_core::world::World;

use super::intervene::{self, Effect, Members, Refusal};
use super::run::Run;
use crate::record::{RecordError, Sinks};
use crate::robios::robot::Robot;
use sim_core::record::Action;

/// Who runs, who waits until when, and where the run's record goes.
pub struct Conductor {
    lanes: Vec<Lane>,
    /// As many as there may be.
    most_lanes: usize,
    /// For each robot the lane that it ran in last.
    homes: Vec<u32>,
    /// Suspended or ended in the present slot.
    ran: Vec<RobotId>,
    wakes: BinaryHeap<Reverse<Wake>>,
    /// For each robot the number of its valid entry in `wakes`.
    wake_numbers: Vec<u32>,
    /// For each robot whether its program has ended, or it has none.
    departed: Vec<bool>,
    /// Robots with a program that has not ended.
    alive: usize,
    /// Once that is none: until when drives that have an end are under way, and the user wants to look on.
    drives_end: Time,
    /// No slot begins at or after it.
    limit: Time,
    /// Slots that start before it begin without asking the owner; none while the run is paused.
    horizon: Option<Time>,
    /// An intervention is pending: the present slot is due.
    has_acted: bool,
    /// Who wants to see the record.
    sinks: Sinks<'static>,
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

/// Why a run ended.
#[derive(Debug)]
pub enum End {
    /// Every program has ended, or there is none.
    Finished,
    /// The time that the user set is over.
    Until,
    /// Nothing moves and every program that has not ended waits for something that cannot come any more.
    Stuck,
    /// The user interrupted the run, or its owner left it early.
    Interrupted,
    /// A program broke in a way after which nothing may run on.
    Broken,
    /// A program of another run in this process broke within the heap of the C library, which all programs of the process share.
    HeapLost,
    /// What was asked to be recorded cannot be.
    Record(RecordError),
}

/// What follows from a robot's return to the barrier.
#[derive(Debug, Default)]
pub struct HandOver {
    /// Robots to resume, each with the lane that it runs in.
    pub resume: Vec<(RobotId, u32)>,
    /// The robot that came back is due again.
    pub goes_on: bool,
    /// Nobody runs: the run's owner goes on.
    pub is_at_rest: bool,
}

/// Where a run stands between two slots, while nobody runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boundary {
    /// Start of the slot after the one that has ended.
    pub following: Time,
    /// Start of the next slot in which anything happens, `following` or later; none when nothing happens any more without an
    /// intervention: no program is alive, or all wait for what cannot come.
    pub next: Option<Time>,
    /// When the run ends: no slot begins at or after it.
    pub limit: Time,
    /// Length of a slot.
    pub slot: Time,
}

impl Boundary {
    /// The slot that the run goes on with; none where nothing happens before its limit.
    pub fn next_within_limit(&self) -> Option<Time> {
        self.next.filter(|next| *next < self.limit)
    }
}

/// What the scheduler is told of a run.
pub struct Plan {
    /// For each robot whether it has a program; without one it only stands there.
    pub has_program: Vec<bool>,
    /// How many may run at one time.
    pub lanes: usize,
    /// Simulated time at which the run ends.
    pub until: Time,
}

impl Conductor {
    /// Paused before the first slot: all robots with programs are due at 0.
    pub fn new(plan: &Plan, sinks: Sinks<'static>) -> Self {
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
            wakes: BinaryHeap::new(),
            wake_numbers: vec![0; count],
            departed: plan.has_program.iter().map(|has_program| !has_program).collect(),
            alive,
            drives_end: Time::ZERO,
            // The first slot is run whatever the limit.
            limit: plan.until.max(Time(1)),
            horizon: None,
            has_acted: false,
            sinks,
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

    /// Ends the run after the present slot; an end that was found before stands, but for a record that cannot be written.
    pub fn end_with(&mut self, end: End) {
        self.end.get_or_insert(end);
    }

    /// The robots that have been released and have not come back.
    pub fn running(&self) -> impl Iterator<Item = RobotId> {
        self.lanes.iter().filter_map(|lane| lane.running)
    }

    /// Who wants to see the record.
    pub fn sinks(&mut self) -> &mut Sinks<'static> {
        &mut self.sinks
    }

    /// Lets the slots begin that start before `horizon`; at the end of the first slot after `deadline` that the calling thread
    /// finishes, the run pauses all the same.
    pub fn advance(&mut self, run: &Run, horizon: Time, deadline: Option<Instant>) -> HandOver {
        self.horizon = Some(horizon);
        if self.end.is_none() {
            self.begin_slot(run, &mut run.environment.write());
        }
        self.go_on(run, None, deadline)
    }

    /// `robot` has come back to sleep until `wake`.
    pub fn suspend(&mut self, run: &Run, robot: RobotId, wake: Time) -> HandOver {
        self.retire(robot);
        self.sleep_until(robot, wake);
        self.go_on(run, Some(robot), None)
    }

    /// The program of `robot` has ended, or broken; `deadline` as for [`Conductor::advance`].
    pub fn depart(&mut self, run: &Run, robot: RobotId, deadline: Option<Instant>) -> HandOver {
        if std::mem::replace(&mut self.departed[robot.index()], true) {
            // It was left behind, and has come back.
            return HandOver::default();
        }
        self.retire(robot);
        self.wake_numbers[robot.index()] += 1;
        self.alive -= 1;
        if self.alive == 0 {
            self.drives_end = run.drives_end();
        }
        self.go_on(run, None, deadline)
    }

    /// Where the paused run stands.
    pub fn boundary(&mut self, environment: &Environment) -> Boundary {
        let next = self.next_start(environment);
        let world = &environment.world;
        Boundary { following: world.slot_start(), next, limit: self.limit, slot: world.slot() }
    }

    /// Ends the paused run, if it has not ended, and completes the slot that an intervention has begun.
    pub fn close(&mut self, run: &Run) {
        let next = self.next_start(&run.environment.read());
        self.end_with(match next {
            Some(start) if start < self.limit => End::Interrupted,
            _ if self.alive == 0 => End::Finished,
            Some(_) => End::Until,
            None => End::Stuck,
        });
        while !self.is_over() {
            self.finish_slot(run, None);
        }
        self.horizon = None;
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
            Some(End::Until) => world.slot_start().max(self.limit),
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

    /// Fills the free lanes, over as many slots as it takes to find somebody who is due or to come to rest.
    fn go_on(&mut self, run: &Run, who_asks: Option<RobotId>, deadline: Option<Instant>) -> HandOver {
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
            hand_over.is_at_rest = self.is_at_rest();
            if hand_over.is_at_rest || self.running().next().is_some() {
                return hand_over;
            }
            self.finish_slot(run, deadline);
        }
    }

    /// True when the present slot is complete and no other follows.
    pub fn is_over(&self) -> bool {
        let is_idle = |lane: &Lane| lane.running.is_none() && lane.ready.is_empty();
        self.end.is_some() && self.ran.is_empty() && self.lanes.iter().all(is_idle)
    }

    /// True while nobody runs, and nobody does unless the run's owner goes on: paused, or over.
    pub fn is_at_rest(&self) -> bool {
        self.horizon.is_none() || self.is_over()
    }

    /// True once it is known why the run ends.
    pub fn is_ending(&self) -> bool {
        self.end.is_some()
    }

    /// Completes the present slot and, unless the run ends with it or is to pause, begins the next one in which anything happens.
    fn finish_slot(&mut self, run: &Run, deadline: Option<Instant>) {
        let mut environment = run.environment.write();
        if let Err(error) = self.end_slot(run, &mut environment) {
            self.end = Some(End::Record(error));
        }
        if run.interrupt().is_set() {
            self.end_with(End::Interrupted);
        }
        if self.end.is_some() {
            return;
        }
        if run.is_pausing() || deadline.is_some_and(|deadline| deadline <= Instant::now()) {
            self.horizon = None;
        } else {
            self.begin_slot(run, &mut environment);
        }
    }

    /// Begins the next slot in which anything happens, or pauses where none starts before the horizon.
    fn begin_slot(&mut self, run: &Run, environment: &mut Environment) {
        let horizon = self.horizon.map_or(Time::ZERO, |horizon| horizon.min(self.limit));
        let Some(start) = self.next_start(environment).filter(|start| *start < horizon) else {
            self.horizon = None;
            return;
        };
        self.has_acted = false;
        environment.world.advance_to(start);
        run.publish_slot(&environment.world);
        self.take_due(environment.world.slot_end());
    }

    /// Carries out `action` at the start of the slot that contains `at`, or of the next one in which anything happens if that is
    /// earlier.
    ///
    /// # Errors
    /// Why it is refused; nothing changes then.
    pub fn act(&mut self, at: Time, action: &Action, run: &Run, environment: &mut Environment) -> Result<(), Refusal> {
        let at = self.next_start(environment).map_or(at, |next| at.min(next));
        let at = at.floor_to(environment.world.slot()).max(environment.world.slot_start());
        if at >= self.limit {
            return Err(Refusal::Over);
        }
        let validated = intervene::validate(action, at, run, &environment.world)?;
        self.has_acted = true;
        environment.record_intervention(at, action);
        let effect = intervene::carry_out(validated, at, run, environment);
        self.take_effect(effect, at, run);
        Ok(())
    }

    /// Brings the list of wakes in line with what an action at `at` has changed.
    fn take_effect(&mut self, effect: Effect, at: Time, run: &Run) {
        for id in effect.robots {
            if let Some(wake) = run.robot(id).wake_after(at).filter(|_| !self.has_departed(id)) {
                self.sleep_until(id, wake);
            }
            self.ran.push(id);
        }
        if let Some((id, has_program)) = effect.came {
            self.admit(id, has_program, at);
        }
        if let Some(id) = effect.left {
            // Its program is turned back from the call that it is in.
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

    /// Ends the slot for all robots that it concerns, and gives the sinks what it brought.
    fn end_slot(&mut self, run: &Run, environment: &mut Environment) -> Result<(), RecordError> {
        let active = environment.concerned(&self.ran, &mut Members(run));
        self.ran.clear();
        let mut robots: Vec<MutexGuard<'_, Robot>> = active.iter().map(|id| run.robot(*id)).collect();
        save_files(&mut robots);
        let SlotEnd { at, heard } = {
            let mut states: Vec<&mut simulation::Robot> = robots.iter_mut().map(|robot| &mut robot.state).collect();
            environment.end_slot(&mut states)
        };
        for (id, visible) in heard {
            if let Ok(place) = active.binary_search(&id) {
                robots[place].tasks.look_at_radio(visible);
            }
        }
        for robot in robots.iter_mut().filter(|robot| !robot.is_removed) {
            if let Some(wake) = robot.wake_after(at) {
                self.sleep_until(robot.id, wake);
            }
        }
        drop(robots);
        self.sinks.take_slot(environment.recorder(), at)
    }

    /// The start of the next slot in which a body moves or a robot is due; none when that never happens.
    fn next_start(&mut self, environment: &Environment) -> Option<Time> {
        let world = &environment.world;
        // The world has gone on to the slot after the one that was finished.
        let following = world.slot_start();
        if self.has_acted || world.is_object_moving() {
            return Some(following);
        }
        if environment.is_robot_moving() {
            // A drive without an end may go on for ever once all programs have ended: that is no reason to run on.
            return (self.alive > 0 || following < self.drives_end).then_some(following);
        }
        while let Some(Reverse(wake)) = self.wakes.peek()
            && self.wake_numbers[wake.robot.index()] != wake.number
        {
            self.wakes.pop();
        }
        let wake = self.wakes.peek().map_or(Time::NEVER, |Reverse(wake)| wake.at);
        // A message that nobody lives to hear is no reason to run on either.
        let message = if self.alive > 0 { environment.message_due() } else { Time::NEVER };
        let due = wake.min(message);
        (due < Time::NEVER).then(|| due.floor_to(world.slot()).max(following))
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
        files.extend(robot.robios.storage.take_written().map(|file| (file, index)));
    }
    files.sort_by_key(|(file, index)| (file.at, *index));
    for (file, index) in files {
        if let Err(error) = file.save() {
            robots[index].hint(&format!("`{}` cannot be written: {error}", file.path.display()));
        }
    }
}
