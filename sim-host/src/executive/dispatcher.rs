//! The dispatcher: the run queues and the scheduler step, which ends a slot and begins the next slot.
//!
//! The dispatcher has no thread. The last flow that reaches the barrier at a slot's end runs the scheduler step: it
//! advances the world and releases the next robots. It does this slot after slot, up to the horizon that the run's
//! owner has set, so a single robot needs no hand-over. At the horizon the run pauses until its owner advances it
//! again.
//!
//! At most `workers` robots run at the same time, one on each worker. Their order does not influence results, since
//! robots interact only at the slots' ends. A worker switches between its own robots as long as it can, since waking a
//! thread on another processor costs several times as much. It steals robots of another worker only when it would be
//! idle otherwise.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use parking_lot::{Mutex, MutexGuard};
use sim_core::RobotId;
use sim_core::parallel::{self, Pool};
use sim_core::simulation::{self, Environment, SlotEnd};
use sim_core::time::Time;
use sim_core::world::World;

use super::intervene::{self, Members, Refusal, RunEffect};
use super::run::Run;
use super::shared_loop::WorkerPool;
use crate::program::load::robots_per_turn;
use crate::record::{RecordError, Sinks};
use crate::robios::robot::Robot;
use sim_core::record::Action;

/// Run queues, wake times and sinks of a run.
pub struct Dispatcher {
    workers: Vec<Worker>,
    /// Upper limit of the number of workers.
    max_workers: usize,
    /// Affinity: for each robot the worker on which it ran last.
    affinity: Vec<u32>,
    /// Robots that suspended themselves, ended or were changed by an intervention in the current slot.
    touched: Vec<RobotId>,
    /// The touched robots that may have requests to other robots, or have written files.
    requesting: Vec<RobotId>,
    /// Wake times before `soon_until`, the end of the next slot, unordered: the wake times of most robots are here.
    soon: Vec<Wake>,
    soon_until: Time,
    /// The other wake times.
    wakes: BinaryHeap<Reverse<Wake>>,
    /// For each robot the number of its valid entry in `soon` or `wakes`; entries with other numbers are stale.
    wake_numbers: Vec<u32>,
    /// For each robot, true if its suspended program waits for an event that the scheduler step can cause.
    await_step: Vec<bool>,
    /// For each robot, true if its program has ended or it has none.
    departed: Vec<bool>,
    /// Number of robots with a program that has not ended.
    alive: usize,
    /// End of the last drive in progress and of the linger time, see [`Run::drives_end`]; set when `alive` becomes 0.
    drives_end: Time,
    /// End of the run: no slot begins at or after it.
    limit: Time,
    /// Slots that start before this time begin without the run's owner; `None` while the run is paused.
    horizon: Option<Time>,
    /// An intervention is pending, so that the following slot is due.
    is_intervention_pending: bool,
    /// Sinks of the record.
    sinks: Sinks<'static>,
    end: Option<EndReason>,
    /// Allocation that lists of references reuse from slot to slot.
    spare: Vec<[usize; 4]>,
    spare_states: Vec<usize>,
}

/// A worker: one robot runs on it at a time.
#[derive(Default)]
struct Worker {
    /// Run queue: robots due in the current slot and not yet released, in order of their ids.
    run_queue: VecDeque<RobotId>,
    /// Released robots whose return to the barrier the dispatcher has not yet processed.
    running: Vec<RobotId>,
}

/// Maximum number of robots that are released together. They run one after the other on their worker; the last one that
/// comes back takes the dispatcher's lock once for all of them.
const MAX_RELEASE: usize = 16;

/// Queue of the robots of one worker that come back to the barrier.
#[derive(Default)]
pub struct ReturnQueue {
    returns: Mutex<Vec<Return>>,
    /// Number of released robots that have not come back.
    remaining: AtomicUsize,
}

/// A robot that has come back to the barrier.
pub struct Return {
    /// The robot.
    pub robot: RobotId,
    /// Time until which it sleeps.
    pub wake: Time,
    /// The robot may have requests to other robots, or has written files.
    pub has_requests: bool,
    /// The robot waits for an event that the scheduler step can cause, so it may wake earlier.
    pub awaits_step: bool,
}

impl ReturnQueue {
    /// Adds a robot that has come back to the barrier. Returns true if all robots that were released with it have come
    /// back, too; then the caller must call [`Dispatcher::suspend`]. Returns `None` if the robot has departed: its flow
    /// was abandoned before it came back.
    pub fn put(&self, robot: Return, has_departed: &AtomicBool) -> Option<bool> {
        let mut returns = self.returns.lock();
        if has_departed.load(Ordering::Acquire) {
            return None;
        }
        returns.push(robot);
        drop(returns);
        Some(self.count_down())
    }

    /// Removes a released robot that departs instead of coming back; returns true if it was the last released robot.
    fn depart(&self, robot: RobotId) -> bool {
        let mut returns = self.returns.lock();
        let position = returns.iter().position(|other| other.robot == robot);
        match position {
            Some(index) => {
                returns.swap_remove(index);
                false
            }
            None => self.count_down(),
        }
    }

    /// Decrements the number of released robots; returns true if no released robot is left.
    fn count_down(&self) -> bool {
        self.remaining.fetch_sub(1, Ordering::AcqRel) == 1
    }
}

/// Minimum length of a worker's run queue for another worker to steal from it.
const MIN_QUEUE_TO_STEAL: usize = 4;

/// An entry of the wake queue; valid while `number` equals the robot's current number.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Wake {
    at: Time,
    robot: RobotId,
    number: u32,
}

/// Reason for the end of a run.
#[derive(Debug)]
pub enum EndReason {
    /// Every program has ended, or there is none.
    Finished,
    /// The run reached the time limit that the user set.
    Until,
    /// Deadlock: nothing moves, and every program that has not ended waits for something that cannot happen any more.
    Stuck,
    /// The user interrupted the run, or its owner finished it early.
    Interrupted,
    /// A program failed in a way after which no program may continue.
    ProgramFailed,
    /// A program of another run in this process crashed in the heap of the C library, which all programs of the process
    /// share.
    HeapLost,
    /// The record cannot be written.
    Record(RecordError),
}

/// Result of a robot's return to the barrier.
#[derive(Debug, Default)]
pub struct BarrierOutcome {
    /// Robots to resume, each with the worker on which it runs.
    pub resume: Vec<(RobotId, u32)>,
    /// The robot that came back is due again and continues.
    pub continues: bool,
    /// No robot runs: control returns to the run's owner.
    pub is_at_rest: bool,
}

/// Position of a run between two slots, while no robot runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boundary {
    /// Start of the slot after the completed slot.
    pub following: Time,
    /// Start of the next slot in which anything happens, `following` or later. `None` if nothing happens any more
    /// without an intervention, because no program is alive, or all wait for something that cannot happen.
    pub next: Option<Time>,
    /// End of the run: no slot begins at or after it.
    pub limit: Time,
    /// Length of a slot.
    pub slot: Time,
}

impl Boundary {
    /// Start of the slot with which the run continues; `None` if nothing happens before its limit.
    pub fn next_within_limit(&self) -> Option<Time> {
        self.next.filter(|next| *next < self.limit)
    }
}

/// Configuration of the dispatcher.
pub struct Plan {
    /// For each robot, true if it has a program.
    pub has_program: Vec<bool>,
    /// For each robot the worker on which it has to run; `None` for any.
    pub bound_workers: Vec<Option<u32>>,
    /// Number of workers: robots that may run at one time.
    pub workers: usize,
    /// Virtual time at which the run ends.
    pub until: Time,
}

impl Dispatcher {
    /// Maximum number of workers that a run of `plan` can have.
    pub fn max_workers(plan: &Plan) -> usize {
        let min_workers = plan.bound_workers.iter().flatten().max().map_or(0, |worker| *worker as usize + 1);
        plan.workers.max(min_workers).max(1)
    }

    /// Creates a dispatcher paused before the first slot: all robots with programs are due at 0.
    pub fn new(plan: &Plan, sinks: Sinks<'static>) -> Self {
        let count = plan.has_program.len();
        let ids = |has_program| {
            let robots = plan.has_program.iter().enumerate().filter(move |(_, has)| **has == has_program);
            robots.map(|(index, _)| RobotId::from_index(index))
        };
        let alive = ids(true).count();
        let min_workers = plan.bound_workers.iter().flatten().max().map_or(0, |worker| *worker as usize + 1);
        let workers = plan.workers.clamp(1, alive.max(1)).max(min_workers);
        let mut dispatcher = Self {
            workers: (0..workers).map(|_| Worker::default()).collect(),
            max_workers: plan.workers,
            affinity: vec![0; count],
            touched: Vec::new(),
            requesting: Vec::new(),
            soon: Vec::new(),
            soon_until: Time::ZERO,
            wakes: BinaryHeap::new(),
            wake_numbers: vec![0; count],
            await_step: vec![false; count],
            departed: plan.has_program.iter().map(|has_program| !has_program).collect(),
            alive,
            drives_end: Time::ZERO,
            // The first slot runs even if the limit is 0.
            limit: plan.until.max(Time(1)),
            horizon: None,
            is_intervention_pending: false,
            sinks,
            end: None,
            spare: Vec::new(),
            spare_states: Vec::new(),
        };
        let turn_size = robots_per_turn(alive, workers);
        for (position, robot) in ids(true).enumerate() {
            dispatcher.affinity[robot.index()] =
                plan.bound_workers[robot.index()].unwrap_or((position / turn_size % workers) as u32);
            dispatcher.sleep_until(robot, Time::ZERO);
        }
        if alive > 0 {
            // The first slot also records the start of robots without a program.
            dispatcher.touched.extend(ids(false));
        }
        dispatcher
    }

    /// Ends the run after the current slot. An earlier reason for the end is kept; only a record that cannot be written
    /// overrides it.
    pub fn end_with(&mut self, end: EndReason) {
        self.end.get_or_insert(end);
    }

    /// Keeps the robots asleep that are due in the current slot but have not run in it yet: the run is ending, and its
    /// user waits for the end.
    pub fn skip_queue(&mut self) {
        self.workers.iter_mut().for_each(|worker| worker.run_queue.clear());
    }

    /// Robots that have been released and have not come back to the barrier.
    pub fn running(&self) -> impl Iterator<Item = RobotId> {
        self.workers.iter().flat_map(|worker| worker.running.iter().copied())
    }

    /// Sinks of the record.
    pub fn sinks(&mut self) -> &mut Sinks<'static> {
        &mut self.sinks
    }

    /// Runs the slots that start before `horizon`. The run also pauses at the end of the first slot after `deadline`
    /// that the calling thread finishes.
    pub fn advance(&mut self, run: &Run, horizon: Time, deadline: Option<Instant>) -> BarrierOutcome {
        self.horizon = Some(horizon);
        if self.end.is_none() {
            self.begin_slot(run, &mut run.environment.write());
        }
        self.dispatch(run, None, deadline)
    }

    /// Processes the return to the barrier of `robot` and of the robots that were released with it; `robot` is the last
    /// one of them that came back (see [`ReturnQueue::put`]).
    pub fn suspend(&mut self, run: &Run, robot: RobotId) -> BarrierOutcome {
        self.take_returns(run, self.affinity[robot.index()] as usize);
        self.dispatch(run, Some(robot), None)
    }

    /// Processes the robots of a worker that have come back to the barrier.
    fn take_returns(&mut self, run: &Run, worker: usize) {
        let mut returns = std::mem::take(&mut *run.returns(worker).returns.lock());
        for Return { robot, wake, has_requests, awaits_step } in returns.drain(..) {
            self.vacate_worker(robot);
            self.await_step[robot.index()] = awaits_step;
            if has_requests {
                self.requesting.push(robot);
            }
            self.sleep_until(robot, wake);
        }
        *run.returns(worker).returns.lock() = returns;
    }

    /// Removes `robot`, whose program has ended or failed, from the schedule; for `deadline` see
    /// [`Dispatcher::advance`].
    pub fn depart(&mut self, run: &Run, robot: RobotId, deadline: Option<Instant>) -> BarrierOutcome {
        if std::mem::replace(&mut self.departed[robot.index()], true) {
            // The flow was abandoned, but has come back after all.
            return BarrierOutcome::default();
        }
        // From here on the robot cannot come back.
        run.has_departed_flag(robot).store(true, Ordering::Release);
        let was_running = self.vacate_worker(robot);
        self.requesting.push(robot);
        self.await_step[robot.index()] = false;
        self.wake_numbers[robot.index()] += 1;
        self.alive -= 1;
        if self.alive == 0 {
            self.drives_end = run.drives_end();
        }
        let worker = self.affinity[robot.index()] as usize;
        if was_running && run.returns(worker).depart(robot) {
            self.take_returns(run, worker);
        }
        self.dispatch(run, None, deadline)
    }

    /// Position of the paused run.
    pub fn boundary(&mut self, environment: &Environment) -> Boundary {
        let next = self.next_start(environment);
        let world = &environment.world;
        Boundary { following: world.slot_start(), next, limit: self.limit, slot: world.slot() }
    }

    /// Ends the paused run, if it has not ended, and completes the slot that an intervention has begun.
    pub fn close(&mut self, run: &Run) {
        let next = self.next_start(&run.environment.read());
        self.end_with(match next {
            Some(start) if start < self.limit => EndReason::Interrupted,
            _ if self.alive == 0 => EndReason::Finished,
            Some(_) => EndReason::Until,
            None => EndReason::Stuck,
        });
        while !self.is_over() {
            self.finish_slot(run, None);
        }
        self.horizon = None;
    }

    /// Marks `robot` as departed: its program has exited after the end of the run.
    pub fn mark_departed(&mut self, run: &Run, robot: RobotId) {
        run.has_departed_flag(robot).store(true, Ordering::Release);
        self.departed[robot.index()] = true;
    }

    /// Returns true if the program of `robot` has ended or failed, or if it has none.
    pub fn has_departed(&self, robot: RobotId) -> bool {
        self.departed[robot.index()]
    }

    /// Virtual time at the end of the run: the end of the last slot, or the limit if the run ended at the limit.
    pub fn time(&self, world: &World) -> Time {
        match self.end {
            Some(EndReason::Until) => world.slot_start().max(self.limit),
            _ => world.slot_start(),
        }
    }

    /// Takes the reason for the end of the run; called once, at the very end.
    pub fn take_end(&mut self) -> EndReason {
        self.end.take().unwrap_or(EndReason::Finished)
    }

    /// Removes `robot` from its worker; returns true if it was released there.
    fn vacate_worker(&mut self, robot: RobotId) -> bool {
        let running = &mut self.workers[self.affinity[robot.index()] as usize].running;
        let index = running.iter().position(|id| *id == robot);
        debug_assert!(index.is_some(), "only a robot that runs comes back");
        index.map(|index| running.swap_remove(index));
        self.touched.push(robot);
        index.is_some()
    }

    fn enqueue(&mut self, robot: RobotId) {
        self.workers[self.affinity[robot.index()] as usize].run_queue.push_back(robot);
    }

    /// Takes the next robot for the idle `worker`: from its own run queue, or stolen from the longest run queue of
    /// another worker, unless that robot is bound to the other worker.
    fn take_next_for(&mut self, worker: usize, run: &Run) -> Option<RobotId> {
        if let Some(robot) = self.workers[worker].run_queue.pop_front() {
            return Some(robot);
        }
        let busiest = self.workers.iter_mut().max_by_key(|worker| worker.run_queue.len())?;
        if busiest.run_queue.len() < MIN_QUEUE_TO_STEAL {
            return None;
        }
        let robot = busiest.run_queue.pop_back_if(|robot| !run.is_bound_to_worker(*robot))?;
        self.affinity[robot.index()] = worker as u32;
        Some(robot)
    }

    /// Releases `first` on the idle `worker`. If `first` is bound to the worker, also releases the next robots of the
    /// run queue, up to the first robot that is not bound and to at most [`MAX_RELEASE`] robots in all.
    fn release(&mut self, worker: usize, first: RobotId, run: &Run) {
        let Worker { run_queue, running } = &mut self.workers[worker];
        running.push(first);
        if run.is_bound_to_worker(first) {
            while running.len() < MAX_RELEASE
                && let Some(next) = run_queue.pop_front_if(|robot| run.is_bound_to_worker(*robot))
            {
                running.push(next);
            }
        }
        run.returns(worker).remaining.store(running.len(), Ordering::Release);
        running.iter().for_each(|robot| run.set_worker(*robot, worker as u32));
    }

    /// Replaces the robot's wake time; with [`Time::NEVER`], the robot has none.
    fn sleep_until(&mut self, robot: RobotId, at: Time) {
        let number = &mut self.wake_numbers[robot.index()];
        *number += 1;
        let wake = Wake { at, robot, number: *number };
        if at < self.soon_until {
            self.soon.push(wake);
        } else if at < Time::NEVER {
            self.wakes.push(Reverse(wake));
        }
    }

    /// Releases a robot on each idle worker; runs scheduler steps until a robot is due or the run is at rest.
    fn dispatch(&mut self, run: &Run, returning: Option<RobotId>, deadline: Option<Instant>) -> BarrierOutcome {
        let mut outcome = BarrierOutcome::default();
        loop {
            for worker in 0..self.workers.len() {
                if self.workers[worker].running.is_empty()
                    && let Some(first) = self.take_next_for(worker, run)
                {
                    self.release(worker, first, run);
                    outcome.continues |= Some(first) == returning;
                    let released = self.workers[worker].running.iter().copied();
                    let others = released.skip(usize::from(Some(first) == returning));
                    outcome.resume.extend(others.map(|robot| (robot, worker as u32)));
                }
            }
            outcome.is_at_rest = self.is_at_rest();
            if outcome.is_at_rest || self.running().next().is_some() {
                return outcome;
            }
            self.finish_slot(run, deadline);
        }
    }

    /// Returns true if the run has ended and its last slot is complete.
    pub fn is_over(&self) -> bool {
        let is_idle = |worker: &Worker| worker.running.is_empty() && worker.run_queue.is_empty();
        self.end.is_some() && self.touched.is_empty() && self.workers.iter().all(is_idle)
    }

    /// Returns true if the run is paused or over: no robot runs until the run's owner advances it.
    pub fn is_at_rest(&self) -> bool {
        self.horizon.is_none() || self.is_over()
    }

    /// Returns true if the reason for the end of the run is known: no further slot begins.
    pub fn is_ending(&self) -> bool {
        self.end.is_some()
    }

    /// Completes the current slot and, unless the run ends or pauses there, begins the next one in which anything
    /// happens.
    fn finish_slot(&mut self, run: &Run, deadline: Option<Instant>) {
        let mut environment = run.environment.write();
        if let Err(error) = self.end_slot(run, &mut environment) {
            self.end = Some(EndReason::Record(error));
        }
        if run.interrupt().is_set() {
            self.end_with(EndReason::Interrupted);
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

    /// Begins the next slot in which anything happens, or pauses if none starts before the horizon.
    fn begin_slot(&mut self, run: &Run, environment: &mut Environment) {
        let horizon = self.horizon.map_or(Time::ZERO, |horizon| horizon.min(self.limit));
        let Some(start) = self.next_start(environment).filter(|start| *start < horizon) else {
            self.horizon = None;
            return;
        };
        self.is_intervention_pending = false;
        environment.world.advance_to(start);
        run.publish_slot(&environment.world);
        let slot_end = environment.world.slot_end();
        self.enqueue_due(slot_end);
        self.soon_until = slot_end + environment.world.slot();
    }

    /// Carries out `action` at the start of the slot that contains `at`, or of the next slot in which anything happens,
    /// whichever is earlier.
    ///
    /// # Errors
    /// [`Refusal`] if the action is invalid or the run is over; nothing changes then.
    pub fn act(&mut self, at: Time, action: &Action, run: &Run, environment: &mut Environment) -> Result<(), Refusal> {
        let at = self.next_start(environment).map_or(at, |next| at.min(next));
        let at = at.floor_to(environment.world.slot()).max(environment.world.slot_start());
        if at >= self.limit {
            return Err(Refusal::Over);
        }
        let validated = intervene::validate(action, at, run, &environment.world)?;
        self.is_intervention_pending = true;
        environment.record_intervention(at, action);
        let effect = intervene::carry_out(validated, at, run, environment);
        self.apply_effect(effect, at, run);
        Ok(())
    }

    /// Updates the wake queue after an intervention at `at`.
    fn apply_effect(&mut self, effect: RunEffect, at: Time, run: &Run) {
        for id in effect.robots {
            if let Some(wake) = run.robot(id).earliest_wake_after(at).filter(|_| !self.has_departed(id)) {
                self.sleep_until(id, wake);
            }
            self.touched.push(id);
            self.requesting.push(id);
        }
        if let Some((id, has_program)) = effect.spawned {
            self.admit(id, has_program, run.bound_worker(id), at);
        }
        if let Some(id) = effect.removed {
            // Wakes its program, whose calls return `Stop` from now on.
            if !self.has_departed(id) {
                self.sleep_until(id, at);
            }
        }
        if effect.ends_run {
            self.end_with(EndReason::Interrupted);
        }
    }

    /// Adds a spawned robot, which has the next id; it is due at `at` if it has a program.
    fn admit(&mut self, robot: RobotId, has_program: bool, bound_worker: Option<u32>, at: Time) {
        self.affinity.push(0);
        self.wake_numbers.push(0);
        self.await_step.push(false);
        self.departed.push(!has_program);
        if has_program {
            self.alive += 1;
            let worker_count =
                self.max_workers.min(self.alive).max(bound_worker.map_or(0, |worker| worker as usize + 1));
            while self.workers.len() < worker_count {
                self.workers.push(Worker::default());
            }
            self.affinity[robot.index()] = bound_worker.unwrap_or((robot.index() % self.workers.len()) as u32);
            self.sleep_until(robot, at);
        }
        self.touched.push(robot);
    }

    /// Ends the slot for all affected robots, and passes the collected record to the sinks.
    fn end_slot(&mut self, run: &Run, environment: &mut Environment) -> Result<(), RecordError> {
        let pool: &dyn Pool = &WorkerPool(run.executor());
        self.requesting.sort_unstable();
        self.requesting.dedup();
        let affected = environment.affected_robots(&self.touched, &self.requesting, &mut Members(run));
        self.touched.clear();
        let mut robots: Vec<AffectedRobot<'_>> = parallel::reuse(std::mem::take(&mut self.spare));
        robots.extend(affected.iter().map(|id| AffectedRobot { id: *id, robot: None, wake: None }));
        pool.for_each(&mut robots, |affected| affected.robot = Some(run.robot(affected.id)));
        save_files(&mut robots, &self.requesting);
        self.requesting.clear();
        let SlotEnd { at, arrivals } = {
            let mut states: Vec<&mut simulation::Robot> = parallel::reuse(std::mem::take(&mut self.spare_states));
            states.extend(robots.iter_mut().filter_map(|affected| Some(&mut affected.robot.as_mut()?.state)));
            let end = environment.end_slot(&mut states, pool);
            self.spare_states = parallel::reuse(states);
            end
        };
        for (id, visible) in arrivals {
            if let Some(robot) = AffectedRobot::find(&mut robots, id) {
                robot.tasks.recheck_radio(visible);
            }
        }
        let await_step = &self.await_step;
        pool.for_each(&mut robots, |affected| {
            let robot = affected.robot.take();
            let robot = robot.filter(|robot| await_step[affected.id.index()] && !robot.is_removed);
            affected.wake = robot.and_then(|mut robot| robot.earliest_wake_after(at));
        });
        for AffectedRobot { id, wake, .. } in &robots {
            if let Some(wake) = wake {
                self.sleep_until(*id, *wake);
            }
        }
        self.spare = parallel::reuse(robots);
        self.sinks.take_slot(environment.recorder(), at)
    }

    /// Start of the next slot in which a body moves, a robot is due, a message arrives or an intervention is pending;
    /// `None` if nothing happens any more.
    fn next_start(&mut self, environment: &Environment) -> Option<Time> {
        let world = &environment.world;
        // The world is already at the slot after the finished one.
        let following = world.slot_start();
        if self.is_intervention_pending || world.is_object_moving() {
            return Some(following);
        }
        if environment.is_robot_moving() {
            // Once all programs have ended, a drive without an end may go on forever: the run does not continue for it.
            return (self.alive > 0 || following < self.drives_end).then_some(following);
        }
        while let Some(Reverse(wake)) = self.wakes.peek()
            && self.wake_numbers[wake.robot.index()] != wake.number
        {
            self.wakes.pop();
        }
        let soon = self.soon.iter().filter(|wake| self.wake_numbers[wake.robot.index()] == wake.number);
        let soon = soon.map(|wake| wake.at).min().unwrap_or(Time::NEVER);
        let wake = self.wakes.peek().map_or(Time::NEVER, |Reverse(wake)| wake.at).min(soon);
        // Once no program is alive, the run does not continue for a message either.
        let message = if self.alive > 0 { environment.message_due() } else { Time::NEVER };
        let due = wake.min(message);
        (due < Time::NEVER).then(|| due.floor_to(world.slot()).max(following))
    }

    /// Moves the robots that are due before `slot_end` to the run queues.
    fn enqueue_due(&mut self, slot_end: Time) {
        let mut soon = std::mem::take(&mut self.soon);
        for wake in soon.drain(..) {
            if wake.at >= slot_end {
                self.wakes.push(Reverse(wake));
            } else if self.wake_numbers[wake.robot.index()] == wake.number {
                self.enqueue(wake.robot);
            }
        }
        self.soon = soon;
        while self.wakes.peek().is_some_and(|Reverse(wake)| wake.at < slot_end)
            && let Some(Reverse(Wake { robot, number, .. })) = self.wakes.pop()
        {
            if self.wake_numbers[robot.index()] == number {
                self.enqueue(robot);
            }
        }
        for worker in &mut self.workers {
            worker.run_queue.make_contiguous().sort_unstable();
        }
    }
}

/// A robot that the end of a slot affects.
struct AffectedRobot<'a> {
    id: RobotId,
    /// Its state, while the step uses it.
    robot: Option<MutexGuard<'a, Robot>>,
    /// Its new wake time; `None` if the step has not changed it.
    wake: Option<Time>,
}

impl<'a> AffectedRobot<'a> {
    /// The state of robot `id` among `robots`, which are in the order of ids.
    fn find<'r>(robots: &'r mut [Self], id: RobotId) -> Option<&'r mut MutexGuard<'a, Robot>> {
        let index = robots.binary_search_by_key(&id, |affected| affected.id).ok()?;
        robots[index].robot.as_mut()
    }
}

/// Saves the files that the robots `writers` wrote in the slot that ends, in order of (virtual time, robot).
fn save_files(robots: &mut [AffectedRobot<'_>], writers: &[RobotId]) {
    let mut files = Vec::new();
    for id in writers {
        if let Some(robot) = AffectedRobot::find(robots, *id) {
            files.extend(robot.robios.storage.take_pending_writes().map(|file| (file, *id)));
        }
    }
    files.sort_by_key(|(file, id)| (file.at, *id));
    for (file, id) in files {
        if let Err(error) = file.save()
            && let Some(robot) = AffectedRobot::find(robots, id)
        {
            robot.state.hint(&format!("`{}` cannot be written: {error}", file.path.display()));
        }
    }
}
