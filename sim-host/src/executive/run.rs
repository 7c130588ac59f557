//! State that the flows of a run share (robots, world, run queues), and the functions that the flows execute.

use std::ops::Range;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU32, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

use parking_lot::{MappedRwLockReadGuard, Mutex, MutexGuard, RwLock, RwLockReadGuard};
use robios_sys::{Callback, Stop};
use sim_core::RobotId;
use sim_core::simulation::Environment;
use sim_core::time::Time;
use sim_core::world::World;

use super::Executor;
use super::dispatcher::{BarrierOutcome, Dispatcher, Plan, Return, ReturnQueue};
use super::failure::Failure;
use super::flow::{self, RobotFlow};
use super::interrupt::Interrupt;
use super::notifier::Notifier;
use super::prefetch::prefetch;
use super::program::RobotProgram;
use super::program_status::{self, PossibleSenders};
use super::scheduler::{Limits, RunParts};
use super::spawn::Spawner;
use crate::program::command;
use crate::program::site::Site;
use crate::record::HintLocations;
use crate::robios::call::Call;
use crate::robios::caller::Caller;
use crate::robios::cost::Costs;
use crate::robios::forbidden::Forbidden;
use crate::robios::radio;
use crate::robios::robot::{Ending, Robot};
use crate::robios::task::MAIN;

/// State shared by the robots' flows.
pub struct Run {
    /// World, recorder and radio channel; written only between slots, while no robot runs.
    pub(crate) environment: RwLock<Environment>,
    /// All robots that were ever in the run, in the order of their ids.
    members: boxcar::Vec<Arc<Member>>,
    /// Creates spawned robots and objects.
    spawner: Mutex<Spawner>,
    pub(super) dispatcher: Mutex<Dispatcher>,
    /// For each worker, the robots that come back to the barrier.
    returns: Vec<ReturnQueue>,
    executor: Box<dyn Executor>,
    /// Robots whose processes failed, and how; the run continues without them.
    pub(super) failed_processes: Mutex<Vec<(RobotId, Failure)>>,
    costs: Costs,
    forbidden: Forbidden,
    /// Lines of programs at which hints were given.
    pub(super) hint_locations: HintLocations,
    notifier: Arc<Notifier>,
    interrupt: Interrupt,
    /// Bounds of the current slot in microseconds: a copy that calls read without the world's lock.
    slot_start: AtomicI64,
    slot_end: AtomicI64,
    /// All programs must exit.
    pub(super) is_stopping: AtomicBool,
    /// The run must pause at the end of the current slot.
    pub(super) is_pausing: AtomicBool,
    is_verbose: bool,
    /// See [`Limits::linger`].
    linger: Time,
    /// True once the recording of calls has been turned on for an individual robot; the robots' journals store for
    /// which ones.
    has_verbose_robots: AtomicBool,
    /// Reference to this run for the flows of spawned robots.
    weak_self: Weak<Run>,
}

/// A robot in a run.
pub struct Member {
    robot: Mutex<Robot>,
    /// `None` for a robot without a program.
    program: Option<RobotProgram>,
    /// The robot has been removed: its program must exit.
    is_removed: AtomicBool,
    /// Its program has ended or failed.
    has_departed: AtomicBool,
    /// Worker on which it was released last.
    worker: AtomicU32,
}

impl Member {
    pub(super) fn new(robot: Robot, program: Option<RobotProgram>) -> Self {
        let has_departed = AtomicBool::new(program.is_none());
        Self {
            robot: Mutex::new(robot),
            program,
            is_removed: AtomicBool::new(false),
            has_departed,
            worker: AtomicU32::new(0),
        }
    }

    /// Locks the state of the robot.
    #[inline]
    pub fn robot(&self) -> MutexGuard<'_, Robot> {
        self.robot.lock()
    }

    /// Prefetches the fields that the robot's calls touch, without reading any.
    pub fn prefetch_fields(&self) {
        let robot: *const u8 = self.robot.data_ptr().cast_const().cast();
        // The lock lies beside the robot.
        prefetch(ptr::from_ref(&self.robot).cast()..robot);
        for Range { start, end } in Robot::HOT_FIELDS {
            prefetch(robot.wrapping_add(start)..robot.wrapping_add(end));
        }
    }

    /// Prefetches the heap memory that the robot's calls touch; does nothing if the robot is locked.
    pub fn prefetch_heap(&self) {
        if let Some(robot) = self.robot.try_lock() {
            robot.hot_memory().for_each(prefetch);
        }
    }

    /// Returns true once the robot has been removed.
    #[inline]
    pub fn is_removed(&self) -> bool {
        self.is_removed.load(Ordering::Acquire)
    }
}

/// Time within which a stopped program must exit before its flow is abandoned.
pub(super) const EXIT_TIMEOUT: Duration = Duration::from_secs(1);

impl Run {
    /// Creates a run without starting any flow.
    ///
    /// # Errors
    /// The process has no file descriptor left.
    pub(super) fn new(parts: RunParts, limits: &Limits) -> std::io::Result<Arc<Self>> {
        let has_program: Vec<bool> = parts.programs.iter().map(Option::is_some).collect();
        let bound_worker =
            |program: &Option<RobotProgram>| program.as_ref()?.variables().map(|variables| variables.worker());
        let bound_workers = parts.programs.iter().map(bound_worker).collect();
        let plan = Plan { has_program, bound_workers, workers: limits.workers, until: limits.until };
        let notifier = Arc::new(Notifier::new()?);
        let has_verbose_robots = parts.robots.iter().any(|robot| robot.journal.is_verbose());
        let members = parts.robots.into_iter().zip(parts.programs);
        Ok(Arc::new_cyclic(|weak_self| Self {
            slot_start: AtomicI64::new(parts.world.slot_start().0),
            slot_end: AtomicI64::new(parts.world.slot_end().0),
            environment: RwLock::new(Environment::new(parts.world, parts.recorder).with_monitor(parts.monitor)),
            members: members.map(|(robot, program)| Arc::new(Member::new(robot, program))).collect(),
            spawner: Mutex::new(parts.spawner),
            returns: (0..Dispatcher::max_workers(&plan)).map(|_| ReturnQueue::default()).collect(),
            dispatcher: Mutex::new(Dispatcher::new(&plan, parts.sinks)),
            executor: parts.executor,
            failed_processes: Mutex::default(),
            costs: parts.costs,
            forbidden: parts.forbidden,
            hint_locations: parts.hint_locations,
            notifier,
            interrupt: parts.interrupt,
            is_stopping: AtomicBool::new(false),
            is_pausing: AtomicBool::new(false),
            is_verbose: limits.is_verbose,
            linger: limits.linger,
            has_verbose_robots: AtomicBool::new(has_verbose_robots),
            weak_self: Weak::clone(weak_self),
        }))
    }

    /// Starts the first flow of each program, suspended.
    ///
    /// # Errors
    /// The system lacks the resources for all of them.
    pub(super) fn start_programs(&self) -> std::io::Result<()> {
        self.ids_with_program()
            .filter_map(|id| Some((id, self.program(id)?)))
            .try_for_each(|(id, program)| self.start_program(id, program))
    }

    /// Starts the first flow of the program of robot `id`, suspended.
    ///
    /// # Errors
    /// The system lacks the resources for it.
    pub(super) fn start_program(&self, id: RobotId, program: &RobotProgram) -> std::io::Result<()> {
        if matches!(program, RobotProgram::InHost { .. }) {
            // The processes that the spawner's thread starts inherit nothing from a program's thread, and the memory of
            // the spawner's thread is not on a heap that programs can damage.
            command::start_spawner()?;
        }
        let weak_self = Weak::clone(&self.weak_self);
        self.executor.admit(id, program, self.members.get(id.index()));
        self.executor.start(id, MAIN, Box::new(move || weak_self.upgrade()?.run_main_flow(id)))?;
        if let Some(child) = program.child() {
            self.executor.serve(id, Arc::clone(child));
        }
        Ok(())
    }

    /// Adds a spawned robot, which has the next id.
    pub(super) fn admit(&self, member: Member) {
        self.has_verbose_robots.fetch_or(member.robot().journal.is_verbose(), Ordering::Relaxed);
        self.members.push(Arc::new(member));
    }

    /// Marks robot `id` as removed: its program must exit, and its calls return [`Stop`].
    pub(super) fn mark_removed(&self, id: RobotId) {
        self.members[id.index()].is_removed.store(true, Ordering::Release);
    }

    /// The spawner of robots and objects, with the registry of all robots and objects that were ever in the run.
    pub fn spawner(&self) -> MutexGuard<'_, Spawner> {
        self.spawner.lock()
    }

    /// The state of robot `id`.
    pub fn robot(&self, id: RobotId) -> MutexGuard<'_, Robot> {
        self.members[id.index()].robot()
    }

    /// The world as published at the start of the current slot. The guard must not be held while the run continues.
    pub fn world(&self) -> MappedRwLockReadGuard<'_, World> {
        RwLockReadGuard::map(self.environment.read(), |environment| &environment.world)
    }

    /// Like [`Run::world`], for a robot's running flow. Takes no lock, since all workers would change the lock's reader
    /// count with each call.
    #[inline]
    pub(super) fn world_in_slot(&self) -> &World {
        debug_assert!(!self.environment.is_locked_exclusive(), "nobody writes while a robot runs");
        // SAFETY: the environment is written only between slots, while no robot runs: by the scheduler step, which the
        // last flow at the barrier runs once all others have suspended themselves, and by the owner of a paused run.
        // The calling flow runs, and by the contract of `Flow::world` it drops the reference before it suspends itself.
        unsafe { &(*self.environment.data_ptr()).world }
    }

    /// Number of robots, removed ones included; equal to the last robot's id.
    pub fn robot_count(&self) -> usize {
        self.members.count()
    }

    /// All programs, those of removed robots included.
    pub(super) fn programs(&self) -> impl Iterator<Item = &RobotProgram> {
        self.members.iter().filter_map(|(_, member)| member.program.as_ref())
    }

    /// The program of robot `id`.
    pub(super) fn program(&self, id: RobotId) -> Option<&RobotProgram> {
        self.members[id.index()].program.as_ref()
    }

    /// The worker on which robot `id` has to run, because the copy of its library belongs to that worker; `None` for
    /// any worker.
    pub(super) fn bound_worker(&self, id: RobotId) -> Option<u32> {
        self.program(id)?.variables().map(|variables| variables.worker())
    }

    /// Returns true if robot `id` is bound to its worker.
    pub(super) fn is_bound_to_worker(&self, id: RobotId) -> bool {
        self.program(id).is_some_and(RobotProgram::is_fiber)
    }

    /// Returns true for a robot that has a program, even one that has ended.
    pub fn has_program(&self, id: RobotId) -> bool {
        self.program(id).is_some()
    }

    /// The robots that have a program.
    pub fn ids_with_program(&self) -> impl Iterator<Item = RobotId> {
        self.members.iter().filter(|(_, member)| member.program.is_some()).map(|(index, _)| RobotId::from_index(index))
    }

    /// Start of the current slot.
    #[inline]
    pub fn slot_start(&self) -> Time {
        Time(self.slot_start.load(Ordering::Acquire))
    }

    /// End of the current slot.
    #[inline]
    pub fn slot_end(&self) -> Time {
        Time(self.slot_end.load(Ordering::Acquire))
    }

    /// Locks world, recorder and checks for reading, between two slots; the caller may already hold such a lock.
    pub fn environment(&self) -> RwLockReadGuard<'_, Environment> {
        self.environment.read_recursive()
    }

    /// The executor of the flows.
    pub(crate) fn executor(&self) -> &dyn Executor {
        &*self.executor
    }

    /// Virtual time that `call` takes.
    #[inline]
    pub(crate) fn cost(&self, call: Call) -> Time {
        self.costs.of(call)
    }

    /// Functions that the scene forbids.
    #[inline]
    pub(super) fn forbidden(&self) -> &Forbidden {
        &self.forbidden
    }

    /// Returns true if the calls of the robot of `member` are recorded.
    #[inline]
    pub(super) fn is_verbose(&self, member: &Member) -> bool {
        self.is_verbose || self.has_verbose_robots.load(Ordering::Relaxed) && member.robot().journal.is_verbose()
    }

    /// Turns the recording of the calls of robot `id` on or off, between two slots.
    pub fn set_verbose(&self, id: RobotId, is_verbose: bool) {
        self.robot(id).journal.set_verbose(is_verbose);
        self.has_verbose_robots.fetch_or(is_verbose, Ordering::Relaxed);
    }

    /// Returns true once all programs must exit.
    #[inline]
    pub(super) fn is_stopping(&self) -> bool {
        self.is_stopping.load(Ordering::Acquire)
    }

    /// Returns true once robot `id` has been removed.
    pub fn is_removed(&self, id: RobotId) -> bool {
        self.members[id.index()].is_removed()
    }

    /// Returns true once the program of robot `id` must exit: all its calls return [`Stop`].
    pub(crate) fn is_exiting(&self, id: RobotId) -> bool {
        self.is_stopping() || self.is_removed(id)
    }

    /// Returns true if the run must pause at the end of the current slot.
    pub(super) fn is_pausing(&self) -> bool {
        self.is_pausing.load(Ordering::Relaxed)
    }

    /// The notifier that wakes the supervisor.
    pub(super) fn notifier(&self) -> &Arc<Notifier> {
        &self.notifier
    }

    /// The interrupt that ends the run early.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Publishes the bounds of the current slot to the robots' calls.
    pub(super) fn publish_slot(&self, world: &World) {
        self.slot_start.store(world.slot_start().0, Ordering::Release);
        self.slot_end.store(world.slot_end().0, Ordering::Release);
    }

    /// Suspends the calling flow of `robot` until the slot that contains `wake`, or earlier if its awaited condition
    /// changes.
    ///
    /// # Errors
    /// [`Stop`] if the program must exit or its flow was abandoned.
    pub(crate) fn suspend(&self, robot: RobotId, wake: Time) -> Result<(), Stop> {
        let (has_requests, awaits_step) = {
            let state = self.robot(robot);
            (state.has_requests() || state.robios.storage.has_pending_writes(), state.awaits_step())
        };
        let member = &self.members[robot.index()];
        let mut continues = false;
        let returns = self.returns(member.worker.load(Ordering::Relaxed) as usize);
        let is_last =
            returns.put(Return { robot, wake, has_requests, awaits_step }, &member.has_departed).ok_or(Stop)?;
        if is_last {
            let outcome = self.dispatcher.lock().suspend(self, robot);
            self.apply(&outcome);
            continues = outcome.continues;
        }
        if continues {
            self.executor.continue_running(robot);
        } else {
            self.executor.suspend(robot);
        }
        if self.is_exiting(robot) { Err(Stop) } else { Ok(()) }
    }

    /// Queue of the robots of `worker` that have come back to the barrier.
    pub(super) fn returns(&self, worker: usize) -> &ReturnQueue {
        &self.returns[worker]
    }

    /// Sets the worker on which robot `id` is released.
    pub(super) fn set_worker(&self, id: RobotId, worker: u32) {
        self.members[id.index()].worker.store(worker, Ordering::Relaxed);
    }

    /// Flag that is true once robot `id` has departed: its program has ended or failed.
    pub(super) fn has_departed_flag(&self, id: RobotId) -> &AtomicBool {
        &self.members[id.index()].has_departed
    }

    /// Resumes these robots, each on its worker.
    pub(super) fn resume(&self, robots: &[(RobotId, u32)]) {
        for (robot, worker) in robots {
            self.executor.resume(*robot, *worker);
        }
    }

    /// Carries out the result of a robot's return to the barrier.
    fn apply(&self, outcome: &BarrierOutcome) {
        self.resume(&outcome.resume);
        if outcome.is_at_rest {
            self.notifier.notify();
        }
    }

    /// Body of a robot's first flow, which runs `main`.
    fn run_main_flow(self: Arc<Self>, id: RobotId) -> Option<u32> {
        if let (false, Some(program)) = (self.is_exiting(id), self.program(id)) {
            let member = Arc::clone(&self.members[id.index()]);
            let caller = Caller::new(RobotFlow { run: Arc::clone(&self), member, id });
            let result = program.run(&caller);
            self.robot(id).has_called |= flow::has_called();
            if result.is_ok() && !self.is_exiting(id) {
                self.robot(id).hint_at_unfinished_tasks();
            }
            // The other tasks exit through calls that `caller` answers.
            self.end_tasks(id);
            let ending = match result {
                Err(failure) if failure.is_overdue && self.is_removed(id) => self.abandon(id),
                Err(failure) if !program.child().is_some_and(|child| child.is_ending()) => {
                    let task = self.robot(id).tasks.first_exiting();
                    let failure =
                        self.with_task(id, if let Some(task) = task { failure.in_task(task) } else { failure });
                    let failure = failure.with_reason(self.robot(id).ending.as_ref());
                    let ending = failure.ending();
                    self.failed_processes.lock().push((id, failure));
                    ending
                }
                _ if self.is_exiting(id) => Ending::Stopped,
                Ok(code) => Ending::Exited { code },
                Err(_) => Ending::Stopped,
            };
            self.robot(id).ending.get_or_insert(ending);
        } else if self.is_removed(id) {
            self.robot(id).ending.get_or_insert(Ending::Stopped);
        }
        if self.is_stopping() {
            self.dispatcher.lock().mark_departed(&self, id);
            self.notifier.notify();
        } else {
            self.end_robot(id, None);
        }
        if let Some(program) = self.program(id) {
            program.end(Instant::now() + EXIT_TIMEOUT);
        }
        None
    }

    /// Abandons the flow of robot `id`, which has been removed and whose program has not exited in time; returns
    /// the program's ending.
    pub(super) fn abandon(&self, id: RobotId) -> Ending {
        self.robot(id).state.hint("the robot was removed, but its program did not exit: its thread is abandoned");
        Ending::Stopped
    }

    /// Adds the name of the task that failed to the description.
    pub(super) fn with_task(&self, id: RobotId, mut failure: Failure) -> Failure {
        if let Some(task) = failure.task.take() {
            failure.description += &format!(" in {}", self.robot(id).tasks.name(task));
        }
        failure
    }

    /// Starts the flow of task `task` of robot `id`, which runs `code` when it gets the run token.
    ///
    /// # Errors
    /// The system lacks the resources for another flow.
    pub(crate) fn start_task(self: &Arc<Self>, id: RobotId, task: u32, code: Callback) -> std::io::Result<()> {
        let run = Arc::clone(self);
        self.executor.start(id, task, Box::new(move || Some(run.run_task_flow(id, code))))
    }

    /// Body of the flow of a task of robot `id` other than `main`; returns the task that gets the run token next.
    fn run_task_flow(&self, id: RobotId, code: Callback) -> u32 {
        let must_exit = {
            let tasks = &self.robot(id).tasks;
            self.is_exiting(id) || tasks.is_exiting() || tasks.is_killed()
        };
        self.program(id).into_iter().for_each(RobotProgram::register_consoles);
        let result = if must_exit { Err(Stop) } else { flow::call_back(code) };
        let mut robot = self.robot(id);
        robot.has_called |= flow::has_called();
        if result.is_err() && !robot.tasks.is_killed() {
            robot.tasks.begin_exit();
        }
        let now = robot.now;
        robot.tasks.end_current(now)
    }

    /// Lets all other tasks of robot `id` exit, one after the other, once its `main` has returned.
    fn end_tasks(&self, id: RobotId) {
        loop {
            let mut robot = self.robot(id);
            robot.tasks.begin_exit();
            let Some(task) = robot.tasks.next_to_exit() else { return };
            let now = robot.now;
            robot.tasks.switch_to(task, now);
            drop(robot);
            self.executor.switch(id, task);
        }
    }

    /// Time until which the run continues while a robot moves, after its last program has ended: the last end of the
    /// drives in progress, but not before [`Limits::linger`] has passed.
    pub(super) fn drives_end(&self) -> Time {
        let drive_end = |id| self.robot(id).motion.drive_end().filter(|_| !self.is_removed(id));
        let ends = (0..self.robot_count()).map(RobotId::from_index).filter_map(drive_end);
        // Saturates at the end of representable time.
        let linger_end = Time(self.slot_start().0.saturating_add(self.linger.0));
        ends.fold(linger_end, Time::max)
    }

    /// Location of the call in progress of robot `id`; called by a flow of the robot on behalf of the program.
    pub(crate) fn call_site(&self, id: RobotId) -> Site {
        self.program(id).map(RobotProgram::call_site).unwrap_or_default()
    }

    /// Describes the wait of each task of `robot`.
    pub(crate) fn waits_of(&self, robot: &Robot) -> String {
        let words = |program| program_status::describe_tasks(robot, program, PossibleSenders::Other);
        self.program(robot.id).map(words).unwrap_or_default()
    }

    /// Ends robot `id` in the run, which continues without it: stops its motors, ends its radio and takes it out of the
    /// schedule. For `deadline` see [`Dispatcher::advance`].
    pub(super) fn end_robot(&self, id: RobotId, deadline: Option<Instant>) {
        {
            let mut robot = self.robot(id);
            // On EyeSim VR, motors keep their last command after a successful exit.
            let keeps_driving = robot.ending == Some(Ending::Exited { code: 0 }) && robot.robios.is_of_robios7();
            if !keeps_driving {
                if matches!(robot.ending, Some(Ending::Exited { .. })) {
                    robot.hint_at_pending_drive();
                }
                robot.halt(&self.world());
            }
            radio::end(&mut robot);
        }
        let outcome = self.dispatcher.lock().depart(self, id, deadline);
        self.apply(&outcome);
    }
}
