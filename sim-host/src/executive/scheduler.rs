//! Scheduler: the handle with which the owner of a run advances it, inspects it between two slots, and finishes it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use sim_core::check::Monitor;
use sim_core::pose::Pose;
use sim_core::record::{Action, Digest, Outcome, Recorder};
use sim_core::simulation::{Faults, Simulation};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::Executor;
use super::dispatcher::{Boundary, EndReason};
use super::failure::Failure;
use super::interrupt::{self, Interrupt};
use super::intervene::Refusal;
use super::program::RobotProgram;
use super::program_status::{PossibleSenders, ProgramStatus, RunEnd};
use super::run::{EXIT_TIMEOUT, Run};
use super::signal::Handlers;
use super::spawn::Spawner;
use super::{damage, program_status, watchdog};
use crate::record::{HintLocations, Sinks};
use crate::robios::console::print_lines;
use crate::robios::cost::Costs;
use crate::robios::forbidden::Forbidden;
use crate::robios::panel::Panel;
use crate::robios::robot::{Ending, Robot};

/// A run in progress, advanced by its owner. Between two calls no robot runs: the owner may read the world and the
/// robots, and [act](Scheduler::act).
///
/// If it is dropped before it is [finished](Scheduler::finish), all programs exit.
pub struct Scheduler {
    run: Arc<Run>,
    /// Processor time in seconds that a program may use within one slot.
    timeout: f64,
    start: Instant,
    /// Robots that failed, and how.
    failures: Vec<(RobotId, Failure)>,
    /// Robots whose programs did not exit although they were removed or stopped: their flows are abandoned.
    abandoned: Vec<RobotId>,
    /// Robots whose programs were requested to stop, each with the time of the request.
    stopping: Vec<(RobotId, Instant)>,
    /// All programs have been requested to exit.
    has_requested_exit: bool,
    /// Pending faults of the scene.
    faults: Faults,
    /// Listener for programs that compute for long.
    listener: Option<Listener>,
    /// Time of the last check of the limits of processes.
    limits_checked: Instant,
}

/// Callback that receives a line of text.
type Listener = Box<dyn FnMut(&str) + Send>;

/// State of a run after it was advanced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The run is paused between two slots; [`Scheduler::boundary`] shows whether anything is left to run.
    Paused,
    /// The run has ended and must be [finished](Scheduler::finish).
    Over,
}

/// Reasons why a run cannot be copied.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The listed robots have programs.
    #[error("a run with programs cannot be copied, those of {}", names(.0))]
    Programs(Vec<RobotId>),
}

fn names(robots: &[RobotId]) -> String {
    robots.iter().map(RobotId::to_string).collect::<Vec<_>>().join(", ")
}

/// Components of a run.
pub struct RunParts {
    /// The world at time 0.
    pub world: World,
    /// Evaluates the checks on motion.
    pub monitor: Option<Monitor>,
    /// Faults of the scene.
    pub faults: Faults,
    /// All robots, in the order of their ids.
    pub robots: Vec<Robot>,
    /// Their programs, in the same order; `None` for a robot without a program.
    pub programs: Vec<Option<RobotProgram>>,
    /// Spawns robots and objects during the run.
    pub spawner: Spawner,
    /// Runs the flows.
    pub executor: Box<dyn Executor>,
    /// Virtual time that each call costs.
    pub costs: Costs,
    /// Functions that programs must not call.
    pub forbidden: Forbidden,
    /// Collects the events.
    pub recorder: Recorder,
    /// Sinks of the record.
    pub sinks: Sinks<'static>,
    /// Takes the lines of programs at which hints are given.
    pub hint_locations: HintLocations,
    /// Ends the run early.
    pub interrupt: Interrupt,
}

/// Limits of a run, set by its user.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Number of workers: robots that may run at the same time.
    pub workers: usize,
    /// Virtual time at which the run ends.
    pub until: Time,
    /// Processor time in seconds that a program may use within one slot.
    pub timeout: f64,
    /// Every call is recorded.
    pub is_verbose: bool,
    /// Virtual time for which the run continues while a robot moves, after its last program has ended. Drives in
    /// progress are completed in any case.
    pub linger: Time,
}

/// Results of a run.
pub struct Ended {
    /// Reason for the end.
    pub end: EndReason,
    /// Virtual time at the end.
    pub time: Time,
    /// Wall-clock time that the run took.
    pub real_time: Duration,
    /// Digest of all recorded events.
    pub digest: Digest,
    /// Final state of each robot, in the order of ids.
    pub robots: Vec<RobotEnd>,
    /// Final pose of each movable object, in the order of ids.
    pub objects: Vec<Pose>,
    /// The run itself, at rest, with its world and its robots; their displays have been moved to `robots`.
    pub run: Arc<Run>,
}

/// State of a robot at the end of a run.
pub struct RobotEnd {
    /// Outcome of its program.
    pub outcome: Outcome,
    /// Reason for the outcome, unless the outcome explains itself.
    pub reason: Option<String>,
    /// The exit code of its program, if it gave one.
    pub exit_code: Option<i32>,
    /// Its program has called a RoBIOS function, in a task that has ended.
    pub has_called: bool,
    /// Its virtual time.
    pub virtual_time: Time,
    /// True pose of its centre in the world.
    pub pose: Pose,
    /// Depth of the top of its hull below the surface of the water, m; `None` for a robot that is not in the water.
    pub depth: Option<f64>,
    /// Angles of the joints of its legs, leg by leg, rad.
    pub joints: Vec<f64>,
    /// Pose by its odometry.
    pub odometry: Pose,
    /// Length of its path, m.
    pub path: f64,
    /// Number of contacts with other bodies.
    pub contacts: u32,
    /// Instant at which its centre first left the floor.
    pub left_floor: Option<Time>,
    /// Number of footfalls, and of contacts of other parts; `None` for a robot without legs.
    pub steps: Option<[u64; 2]>,
    /// Its display.
    pub panel: Panel,
    /// Bytes that its program printed beyond the limit.
    pub output_cut: u64,
}

/// Interval at which the supervisor checks the programs.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Minimum wait for the notifier.
const MIN_WAIT: Duration = Duration::from_millis(1);

/// Processor time without a call after which a program is reported as computing, and the interval of these reports.
const LONG_COMPUTATION: Duration = Duration::from_secs(1);

/// Time within which a stopped program must react before its flow is abandoned.
const STOP_TIMEOUT: Duration = Duration::from_secs(2);

/// Processor or wall-clock time in seconds that programs may still use after the user has interrupted the run.
const INTERRUPT_TIMEOUT: f64 = 0.5;

impl Scheduler {
    /// Creates a run before its first slot, with the flows of its programs suspended.
    ///
    /// # Errors
    /// The system lacks the resources for the robots' flows.
    pub fn start(mut parts: RunParts, limits: &Limits) -> std::io::Result<Self> {
        let start = Instant::now();
        let faults = std::mem::take(&mut parts.faults);
        let run = Run::new(parts, limits)?;
        run.executor().begin(run.notifier());
        let (failures, abandoned) = (Vec::new(), Vec::new());
        let mut scheduler = Self {
            run,
            timeout: limits.timeout,
            start,
            failures,
            abandoned,
            stopping: Vec::new(),
            has_requested_exit: false,
            faults,
            listener: None,
            limits_checked: Instant::now(),
        };
        if let Err(error) = scheduler.run.start_programs() {
            scheduler.has_requested_exit = true;
            // The flows started so far exit again, up to the first robot without one.
            scheduler.run.ids_with_program().all(|id| scheduler.exit_program(id, EXIT_TIMEOUT));
            return Err(error);
        }
        Ok(scheduler)
    }

    /// Sets the listener that receives, once a second, the programs that have computed for a second or longer without a
    /// call: `r1 computes at loop.c:5`. It is called on the thread that advances the run, and does not change the run.
    pub fn listen_to_computing(&mut self, listener: impl FnMut(&str) + Send + 'static) {
        self.listener = Some(Box::new(listener));
    }

    /// State that the robots' flows share.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Runs the slots that start before `time` and before the run's limit; the calling thread supervises the programs.
    pub fn advance_to(&mut self, time: Time) -> Progress {
        self.advance_within(time, Duration::MAX)
    }

    /// Like [`Scheduler::advance_to`], but also pauses at the end of the first slot after the wall-clock time `budget`
    /// has passed; for [`Duration::ZERO`] after one slot.
    pub fn advance_within(&mut self, time: Time, budget: Duration) -> Progress {
        let deadline = Instant::now().checked_add(budget);
        loop {
            let fault = self.carry_out_faults(time);
            self.advance_slots(fault.unwrap_or(time), budget, deadline);
            let is_due = fault.is_some_and(|at| self.boundary().next.is_some_and(|next| at <= next));
            if self.is_ending() {
                return Progress::Over;
            }
            if !is_due || deadline.is_some_and(|deadline| deadline <= Instant::now()) {
                return Progress::Paused;
            }
        }
    }

    /// Runs the slots that start before `time`, or until the calling thread finds that `deadline` has passed.
    fn advance_slots(&mut self, time: Time, budget: Duration, deadline: Option<Instant>) {
        self.run.is_pausing.store(budget.is_zero(), Ordering::Relaxed);
        let outcome = self.run.dispatcher.lock().advance(&self.run, time, deadline);
        self.run.resume(&outcome.resume);
        if !outcome.is_at_rest {
            self.supervise(deadline);
        }
    }

    /// Carries out the scene's faults of the slot with which the paused run continues. Returns the start of the slot of
    /// the next fault, if it is before `time`. A run does not continue only for faults; a fault that cannot be carried
    /// out, such as that of a removed robot, is skipped.
    fn carry_out_faults(&mut self, time: Time) -> Option<Time> {
        while let Some(at) = self.faults.next() {
            let boundary = self.boundary();
            let next = boundary.next?;
            let start = at.floor_to(boundary.slot).max(boundary.following);
            if start > next || start >= time {
                return Some(start).filter(|start| *start < time);
            }
            let action = self.faults.pop().map(|(_, action)| action);
            action.into_iter().for_each(|action| _ = self.act(start, &action));
        }
        None
    }

    /// Position of the paused run.
    pub fn boundary(&self) -> Boundary {
        self.run.dispatcher.lock().boundary(&self.run.environment.read())
    }

    /// Returns true if the reason for the end of the run is known: no further slot begins.
    pub fn is_ending(&self) -> bool {
        self.run.dispatcher.lock().is_ending()
    }

    /// Carries out `action` in the paused run, at the start of the slot that contains `at`, but not before the
    /// [following](Boundary::following) slot and not after the [next](Boundary::next) one.
    ///
    /// # Errors
    /// [`Refusal`] if the action is invalid or the run is over; nothing changes then.
    pub fn act(&mut self, at: Time, action: &Action) -> Result<(), Refusal> {
        self.run.dispatcher.lock().act(at, action, &self.run, &mut self.run.environment.write())
    }

    /// Copies the paused run into a simulation whose owner drives the robots and must supply the scenery for cameras.
    ///
    /// # Errors
    /// [`SnapshotError`] if the run has programs, whose stacks cannot be copied. Such a run can only be repeated from
    /// the start with the same seed.
    pub fn snapshot(&self) -> Result<Simulation, SnapshotError> {
        let run = &*self.run;
        let with_programs: Vec<RobotId> = run.ids_with_program().collect();
        if !with_programs.is_empty() {
            return Err(SnapshotError::Programs(with_programs));
        }
        let robots: Vec<_> = (0..run.robot_count()).map(|index| run.robot(RobotId::from_index(index))).collect();
        let robots: Vec<_> = robots.iter().map(|robot| &robot.state).collect();
        let spawner = run.spawner();
        let environment = run.environment.read();
        Ok(Simulation::copy_of(&environment, &robots, spawner.roster(), spawner.factory(), self.faults.clone()))
    }

    /// Ends the paused run at its position, as an interrupt by the user does.
    pub fn interrupt(&mut self) {
        self.run.dispatcher.lock().end_with(EndReason::Interrupted);
    }

    /// Lets every program that has not ended exit, and completes the record. A run in which nothing happens any more
    /// before its limit ends normally; any other run ends as interrupted.
    pub fn finish(mut self) -> Ended {
        self.run.dispatcher.lock().close(&self.run);
        self.exit_programs();
        self.failures.append(&mut self.run.failed_processes.lock());
        let ended = self.conclude();
        interrupt::disarm_last_resort();
        ended
    }

    /// Supervises the programs until no robot runs.
    fn supervise(&mut self, deadline: Option<Instant>) {
        let mut last_check = Instant::now();
        let mut last_report = last_check;
        let mut interrupted_at: Option<Instant> = None;
        loop {
            let remaining =
                deadline.map_or(POLL_INTERVAL, |deadline| deadline.saturating_duration_since(Instant::now()));
            if remaining.is_zero() {
                self.run.is_pausing.store(true, Ordering::Relaxed);
            }
            let wait = if remaining.is_zero() { POLL_INTERVAL } else { remaining.clamp(MIN_WAIT, POLL_INTERVAL) };
            self.run.notifier().wait(wait);
            if !self.failures.is_empty() {
                interrupt::arm_last_resort();
            }
            // Flows rarely fail, and a check of all flows takes time.
            if self.run.notifier().take_failure() {
                for (id, failure) in self.run.executor().failures() {
                    self.handle_failure(id, failure, deadline);
                }
            }
            if self.limits_checked.elapsed() >= POLL_INTERVAL {
                self.limits_checked = Instant::now();
                // A process that exceeds its limits fails in its next call.
                self.run.programs().filter_map(RobotProgram::child).for_each(|child| _ = child.check_limits());
            }
            // A flow keeps the lock while it runs scheduler steps over many slots in which no robot is due.
            let Some(mut dispatcher) = self.run.dispatcher.try_lock_for(POLL_INTERVAL) else { continue };
            if dispatcher.is_at_rest() {
                return;
            }
            let mut timeout = self.timeout;
            if self.run.interrupt().is_set() {
                dispatcher.end_with(EndReason::Interrupted);
                timeout = timeout.min(INTERRUPT_TIMEOUT);
                if interrupted_at.get_or_insert_with(Instant::now).elapsed().as_secs_f64() > INTERRUPT_TIMEOUT {
                    // The user waits, possibly while many programs compute or the machine is loaded.
                    dispatcher.skip_queue();
                    timeout = 0.0;
                }
            }
            if self.run.executor().must_end() {
                dispatcher.end_with(EndReason::HeapLost);
                timeout = timeout.min(INTERRUPT_TIMEOUT);
            }
            if last_check.elapsed() >= POLL_INTERVAL {
                last_check = Instant::now();
                self.reinstall_handlers();
                let running: Vec<_> = dispatcher.running().collect();
                drop(dispatcher);
                self.break_overdue(&running, timeout);
                if last_report.elapsed() >= LONG_COMPUTATION {
                    last_report = Instant::now();
                    self.report_computing(&running);
                }
                for id in self.unresponsive(&running) {
                    self.handle_failure(id, Failure::unstoppable(), deadline);
                    self.abandoned.push(id);
                }
            }
        }
    }

    /// Handles a failed flow of robot `id`: ends the run, unless the robot was removed and its program did not exit in
    /// time.
    fn handle_failure(&mut self, id: RobotId, failure: Failure, deadline: Option<Instant>) {
        if self.abandoned.contains(&id) || self.failures.iter().any(|(known, _)| *known == id) {
            return;
        }
        let run = &self.run;
        if failure.is_overdue && run.is_removed(id) {
            self.abandoned.push(id);
            let ending = run.abandon(id);
            run.robot(id).ending.get_or_insert(ending);
        } else {
            let failure = run.with_task(id, failure);
            if run.program(id).is_some_and(|program| program_status::has_lost_heap(&failure, program)) {
                damage::mark_heap_lost();
            }
            let failure = {
                let mut robot = run.robot(id);
                let failure = failure.with_reason(robot.ending.as_ref());
                failure.unfinished.iter().for_each(|(stream, line)| print_lines(&mut robot, *stream, line));
                robot.ending.get_or_insert(failure.ending());
                failure
            };
            self.failures.push((id, failure));
            run.dispatcher.lock().end_with(EndReason::ProgramFailed);
        }
        // The thread of a program that has ended may still crash in a destructor of a thread-local.
        if !run.dispatcher.lock().has_departed(id) {
            run.end_robot(id, deadline);
        }
    }

    /// Stops the running programs that are overdue after `timeout` seconds, unless a debugger is attached.
    fn break_overdue(&mut self, running: &[RobotId], timeout: f64) {
        if watchdog::is_debugged() {
            return;
        }
        self.stopping.retain(|(id, _)| running.contains(id));
        let executor = self.run.executor();
        for id in running {
            let timeout = if self.run.is_removed(*id) { timeout.min(EXIT_TIMEOUT.as_secs_f64()) } else { timeout };
            if executor.is_overdue(*id, timeout) {
                executor.break_overdue(*id);
                if self.stopping.iter().all(|(other, _)| other != id) {
                    self.stopping.push((*id, Instant::now()));
                }
            }
        }
    }

    /// Reports to the listener which of the `running` programs have computed for [`LONG_COMPUTATION`], and where.
    fn report_computing(&mut self, running: &[RobotId]) {
        /// Maximum number of programs that are reported.
        const MAX: usize = 3;
        let (run, Some(listener)) = (&self.run, &mut self.listener) else { return };
        let is_long =
            |id: &&RobotId| run.executor().is_overdue(**id, LONG_COMPUTATION.as_secs_f64()) && !run.is_removed(**id);
        let reports = running.iter().filter(is_long).take(MAX).map(|id| {
            let location = run.program(*id).and_then(|program| match program.child() {
                Some(child) => program_status::line_of_location(&child.current_location()?, program),
                None => program_status::line_of(&run.executor().backtrace(*id), program),
            });
            location.map_or(format!("{id} computes"), |location| format!("{id} computes at {location}"))
        });
        let report = reports.collect::<Vec<_>>().join(", ");
        if !report.is_empty() {
            listener(&report);
        }
    }

    /// Reinstalls the signal handlers that programs on threads have replaced.
    fn reinstall_handlers(&self) {
        let is_of_program = |address: usize| {
            let address_ranges = self.run.programs().filter_map(|program| match program {
                RobotProgram::InHost { program, .. } => Some(program.addresses()),
                RobotProgram::Process(_) | RobotProgram::Embedded(_) => None,
            });
            address_ranges.into_iter().any(|addresses| addresses.contains(&address))
        };
        Handlers::reinstall(is_of_program);
        interrupt::reinstall(is_of_program);
    }

    /// The `running` robots whose programs have not reacted within [`STOP_TIMEOUT`] (after an interrupt, half of it) to
    /// a request to stop.
    fn unresponsive(&self, running: &[RobotId]) -> Vec<RobotId> {
        let timeout = if self.run.interrupt().is_set() { STOP_TIMEOUT / 2 } else { STOP_TIMEOUT };
        let is_late = |(id, since): &&(RobotId, Instant)| since.elapsed() > timeout && running.contains(id);
        self.stopping.iter().filter(is_late).map(|(id, _)| *id).collect()
    }

    /// Lets every program that has not ended exit, one after the other in the order of ids. Does nothing if a flow has
    /// failed, so that no code of a damaged process adds to the record.
    fn exit_programs(&mut self) {
        if self.has_requested_exit || !self.failures.is_empty() || self.run.executor().must_end() {
            return;
        }
        self.has_requested_exit = true;
        let mut has_timed_out = false;
        for id in self.run.ids_with_program() {
            // Each program has its own timeout, but after an interrupt all share one, because the user waits.
            let timeout = if has_timed_out && self.run.interrupt().is_set() { Duration::ZERO } else { EXIT_TIMEOUT };
            has_timed_out |= !self.exit_program(id, timeout);
        }
    }

    /// Lets the program of robot `id` exit if it has not ended; returns false if it does not within `timeout`.
    fn exit_program(&self, id: RobotId, timeout: Duration) -> bool {
        let run = &self.run;
        run.is_stopping.store(true, Ordering::Release);
        let has_departed = || run.dispatcher.lock().has_departed(id);
        if !has_departed() {
            run.executor().resume(id, 0);
        }
        let deadline = Instant::now() + timeout;
        while !has_departed() && Instant::now() < deadline {
            run.notifier().wait(deadline.saturating_duration_since(Instant::now()));
        }
        has_departed()
    }

    /// Collects the results, once no robot runs any more.
    fn conclude(&self) -> Ended {
        let run = &self.run;
        let mut dispatcher = run.dispatcher.lock();
        let mut environment = run.environment.write();
        let time = dispatcher.time(&environment.world);
        let end = dispatcher.take_end();
        let senders = PossibleSenders::among(run.ids_with_program().map(|id| run.robot(id)));
        let run_end = RunEnd { end: &end, time, robots: run.robot_count(), senders };
        let is_settled = matches!(end, EndReason::Finished | EndReason::Stuck) && !environment.is_robot_moving();
        environment.finish_monitor(time, is_settled);
        environment.finish(time);
        let mut robots = Vec::with_capacity(run.robot_count());
        for id in (0..run.robot_count()).map(RobotId::from_index) {
            let mut robot = run.robot(id);
            let failure = self.failures.iter().find(|(other, _)| *other == id).map(|(_, failure)| failure);
            let status = match run.program(id) {
                Some(_) if failure.is_none() && run.is_removed(id) && robot.ending == Some(Ending::Stopped) => {
                    if robot.is_halted { ProgramStatus::halted() } else { ProgramStatus::removed() }
                }
                Some(program) => program_status::judge(&mut robot, &run_end, failure, program),
                None => ProgramStatus::without_program(),
            };
            environment.finish_radio(&mut robot.state);
            status.record(&mut robot);
            environment.recorder().collect(&mut robot.journal);
            robots.push(RobotEnd {
                has_called: robot.has_called,
                virtual_time: robot.now,
                pose: robot.motion.pose(time),
                depth: robot.motion.depth(time),
                joints: if robot.motion.legs().is_some() { robot.motion.stance(time).joints } else { Vec::new() },
                odometry: robot.motion.odometry(time),
                path: robot.motion.path_length(time),
                contacts: robot.motion.contacts(time),
                left_floor: robot.left_floor(),
                steps: robot.motion.legs().map(|_| [robot.walk.footfalls, robot.walk.touches]),
                panel: robot.robios.take_panel(),
                output_cut: robot.robios.console.cut_bytes(),
                outcome: status.outcome,
                reason: status.reason,
                exit_code: status.exit_code,
            });
        }
        let (digest, completed) = dispatcher.sinks().finish_record(environment.recorder(), time);
        let end = completed.map_or_else(EndReason::Record, |()| end);
        let world = &environment.world;
        let objects =
            (0..world.object_count()).map(|index| world.object_pose(ObjectId::from_index(index), time)).collect();
        Ended { end, time, real_time: self.start.elapsed(), digest, robots, objects, run: Arc::clone(run) }
    }
}

impl Drop for Scheduler {
    fn drop(&mut self) {
        let is_at_rest = self.run.dispatcher.lock().is_at_rest();
        if is_at_rest {
            self.exit_programs();
        }
        let deadline = Instant::now() + EXIT_TIMEOUT;
        self.run.programs().for_each(|program| program.end(deadline));
        if is_at_rest && !self.has_requested_exit && !damage::is_heap_lost() {
            // The remaining programs exit and release what they hold, up to the first program that does not exit.
            self.run.ids_with_program().all(|id| self.exit_program(id, EXIT_TIMEOUT));
        }
        let has_departed = |id| self.run.dispatcher.lock().has_departed(id) && !self.abandoned.contains(&id);
        if !self.run.executor().end(&has_departed) {
            // The thread of a lost flow may still run code of its program, which stays mapped.
            std::mem::forget(Arc::clone(&self.run));
        }
    }
}
