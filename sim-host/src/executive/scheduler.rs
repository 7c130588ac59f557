//! The scheduler of a run as its owner has it: a value that is advanced, looked at between two slots, and finished.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use sim_core::pose::Pose;
use sim_core::record::{Action, Digest, Outcome, Recorder};
use sim_core::simulation::Simulation;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::Executor;
use super::conductor::{Boundary, End};
use super::fault::Broken;
use super::interrupt::Interrupt;
use super::intervene::Refusal;
use super::program::RobotProgram;
use super::run::{LEAVE, Run};
use super::spawn::Spawner;
use super::standing::{Finish, Senders, Standing};
use super::{damage, standing, watchdog};
use crate::record::Sinks;
use crate::robios::cost::Costs;
use crate::robios::panel::Panel;
use crate::robios::robot::{Ending, Robot};

/// A run in progress, which its owner advances. Between two calls no robot runs: the owner may look at the world and the robots, and
/// [act](Scheduler::act).
///
/// Dropped before it is [finished](Scheduler::finish), it lets all programs leave.
pub struct Scheduler {
    run: Arc<Run>,
    /// Processor time in seconds that a program may use within one slot.
    timeout: f64,
    start: Instant,
    /// Robots that broke, and how.
    broken: Vec<(RobotId, Broken)>,
    /// Robots whose programs do not leave, though they were removed or stopped: nobody waits for them any more.
    left_behind: Vec<RobotId>,
    /// Robots whose programs are to be stopped, and since when.
    stopping: Vec<(RobotId, Instant)>,
    /// All programs have been let leave.
    has_left: bool,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// It stands between two slots; whether anything is left to run says [`Scheduler::boundary`].
    Paused,
    /// It has ended: it is to be [finished](Scheduler::finish).
    Over,
}

/// Why a run cannot be copied.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// These robots have programs.
    #[error("a run with programs cannot be copied, those of {}", names(.0))]
    Programs(Vec<RobotId>),
}

fn names(robots: &[RobotId]) -> String {
    robots.iter().map(RobotId::to_string).collect::<Vec<_>>().join(", ")
}

/// What a run is made of.
pub struct Parts {
    /// The world at time 0.
    pub world: World,
    /// All robots, in the order of their ids.
    pub robots: Vec<Robot>,
    /// Their programs, in the same order; none for a robot that only stands there.
    pub programs: Vec<Option<RobotProgram>>,
    /// Makes robots and objects that come later.
    pub spawner: Spawner,
    /// How flows are run.
    pub executor: Box<dyn Executor>,
    /// What calls cost.
    pub costs: Costs,
    /// Where events go.
    pub recorder: Recorder,
    /// Who wants to see them.
    pub sinks: Sinks<'static>,
    /// What ends it early.
    pub interrupt: Interrupt,
}

/// What a run is told by its user.
#[derive(Clone, Debug)]
pub struct Limits {
    /// How many robots may run at one time.
    pub lanes: usize,
    /// Simulated time at which the run ends.
    pub until: Time,
    /// Processor time in seconds that a program may use within one slot.
    pub timeout: f64,
    /// True when every call is to be recorded.
    pub is_verbose: bool,
    /// How long the run goes on after its last program has ended, as long as anything moves.
    pub linger: Time,
}

/// How a run ended.
pub struct Ended {
    /// Why it ended.
    pub end: End,
    /// Simulated time at the end.
    pub time: Time,
    /// Real time that it took.
    pub real_time: Duration,
    /// Digest of everything recorded.
    pub digest: Digest,
    /// For each robot how it stands, in the order of ids.
    pub robots: Vec<RobotEnd>,
    /// Where each movable object is, in the order of ids.
    pub objects: Vec<Pose>,
    /// The run itself, at rest: its world and its robots, whose displays have been taken out.
    pub run: Arc<Run>,
}

/// How a robot stands at the end of a run.
pub struct RobotEnd {
    /// How its program stands.
    pub outcome: Outcome,
    /// Why, where there is more to say.
    pub reason: Option<String>,
    /// The exit code of its program, where it gave one.
    pub exit_code: Option<i32>,
    /// Its virtual time.
    pub virtual_time: Time,
    /// True pose of its centre in the world.
    pub pose: Pose,
    /// Pose by its odometry.
    pub odometry: Pose,
    /// Length of its path, m.
    pub path: f64,
    /// How often it touched something.
    pub contacts: u32,
    /// How often a foot came down, and how often another part touched something; none of a robot without legs.
    pub steps: Option<[u64; 2]>,
    /// Its display.
    pub panel: Panel,
    /// Bytes that its program printed beyond the limit.
    pub output_cut: u64,
}

/// How often the supervisor looks at the programs.
const LOOK: Duration = Duration::from_millis(50);

/// The shortest wait for the bell.
const SHORTEST_WAIT: Duration = Duration::from_millis(1);

/// How long a program that is stopped may take to take notice before it is left behind.
const NOTICE: Duration = Duration::from_secs(2);

/// Processor time in seconds that a program may still compute once the user has interrupted the run.
const PATIENCE: f64 = 0.5;

impl Scheduler {
    /// A run that stands before its first slot, its programs' flows suspended.
    ///
    /// # Errors
    /// When the system has no room for the robots' flows.
    pub fn start(parts: Parts, limits: &Limits) -> std::io::Result<Self> {
        let start = Instant::now();
        let run = Run::new(parts, limits)?;
        run.executor().begin(run.bell());
        let (broken, left_behind) = (Vec::new(), Vec::new());
        let mut scheduler =
            Self { run, timeout: limits.timeout, start, broken, left_behind, stopping: Vec::new(), has_left: false };
        if let Err(error) = scheduler.run.start_programs() {
            scheduler.has_left = true;
            // Those that have got a flow give it back, up to the first without one.
            scheduler.run.ids_with_program().all(|id| scheduler.stop(id));
            return Err(error);
        }
        Ok(scheduler)
    }

    /// What its robots' flows share.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Runs the slots that start before `time` and before the run's limit. The calling thread supervises the programs meanwhile.
    pub fn advance_to(&mut self, time: Time) -> Progress {
        self.advance_within(time, Duration::MAX)
    }

    /// Like [`Scheduler::advance_to`], but pauses after the first slot that is complete when `real` has passed: after one slot for
    /// [`Duration::ZERO`].
    pub fn advance_within(&mut self, time: Time, real: Duration) -> Progress {
        let deadline = Instant::now().checked_add(real);
        self.run.is_pausing.store(real.is_zero(), Ordering::Relaxed);
        let hand_over = self.run.conductor.lock().advance(&self.run, time, deadline);
        self.run.resume(&hand_over.resume);
        if !hand_over.is_at_rest {
            self.supervise(deadline);
        }
        if self.is_ending() { Progress::Over } else { Progress::Paused }
    }

    /// Where the run stands, while it is paused.
    pub fn boundary(&self) -> Boundary {
        self.run.conductor.lock().boundary(&self.run.environment.read())
    }

    /// True once it is known why the run ends: no further slot begins.
    pub fn is_ending(&self) -> bool {
        self.run.conductor.lock().is_ending()
    }

    /// Carries out `action` in the paused run, at the start of the slot that contains `at`: at the earliest the
    /// [following](Boundary::following) one, at the latest the [next](Boundary::next).
    ///
    /// # Errors
    /// Why it is refused; nothing changes then.
    pub fn act(&mut self, at: Time, action: &Action) -> Result<(), Refusal> {
        self.run.conductor.lock().act(at, action, &self.run, &mut self.run.environment.write())
    }

    /// A copy of the paused run, in which its owner drives the robots; what cameras see is to be given to it.
    ///
    /// # Errors
    /// [`SnapshotError`]: the stack of a program cannot be copied. The way back of a run with programs is to run it again from the
    /// start with the same seed.
    pub fn snapshot(&self) -> Result<Simulation, SnapshotError> {
        let run = &*self.run;
        let with_programs: Vec<RobotId> = run.ids_with_program().collect();
        if !with_programs.is_empty() {
            return Err(SnapshotError::Programs(with_programs));
        }
        let environment = run.environment.read().clone();
        let ids = (0..run.robot_count()).map(RobotId::from_index);
        let robots = ids.map(|id| run.robot(id).state.clone()).collect();
        let spawner = run.spawner();
        Ok(Simulation::of(environment, robots, spawner.roster().clone(), spawner.factory().clone()))
    }

    /// Ends the paused run where it stands, as when the user interrupts it.
    pub fn interrupt(&mut self) {
        self.run.conductor.lock().end_with(End::Interrupted);
    }

    /// Lets every program that has not ended leave, and concludes the record. A run in which nothing happens any more before its limit
    /// has come to its end; any other one that its owner leaves is interrupted.
    pub fn finish(mut self) -> Ended {
        self.run.conductor.lock().close(&self.run);
        self.leave();
        self.broken.append(&mut self.run.lost.lock());
        self.conclude()
    }

    /// Watches over the programs until nobody runs any more.
    fn supervise(&mut self, deadline: Option<Instant>) {
        let mut looked = Instant::now();
        loop {
            let left = deadline.map_or(LOOK, |deadline| deadline.saturating_duration_since(Instant::now()));
            if left.is_zero() {
                self.run.is_pausing.store(true, Ordering::Relaxed);
            }
            let wait = if left.is_zero() { LOOK } else { left.clamp(SHORTEST_WAIT, LOOK) };
            self.run.bell().wait(wait);
            for (id, broken) in self.run.executor().broken() {
                self.take_broken(id, broken, deadline);
            }
            // A flow that goes over many slots in which nobody is due keeps the lock meanwhile.
            let Some(mut conductor) = self.run.conductor.try_lock_for(LOOK) else { continue };
            if conductor.is_at_rest() {
                return;
            }
            let mut timeout = self.timeout;
            if self.run.interrupt().is_set() {
                conductor.end_with(End::Interrupted);
                timeout = timeout.min(PATIENCE);
            }
            if self.run.executor().is_doomed() {
                conductor.end_with(End::HeapLost);
                timeout = timeout.min(PATIENCE);
            }
            if looked.elapsed() >= LOOK {
                looked = Instant::now();
                let running: Vec<_> = conductor.running().collect();
                drop(conductor);
                self.break_overdue(&running, timeout);
                for id in self.without_notice(&running) {
                    self.take_broken(id, Broken::unstoppable(), deadline);
                    self.left_behind.push(id);
                }
            }
        }
    }

    /// A flow of robot `id` broke: the run ends, unless the robot has been removed and its program did not leave.
    fn take_broken(&mut self, id: RobotId, broken: Broken, deadline: Option<Instant>) {
        if self.left_behind.contains(&id) || self.broken.iter().any(|(known, _)| *known == id) {
            return;
        }
        let run = &self.run;
        if broken.is_overdue && run.is_removed(id) {
            self.left_behind.push(id);
            let ending = run.leave_behind(id);
            run.robot(id).ending.get_or_insert(ending);
        } else {
            let broken = run.with_task(id, broken);
            run.robot(id).ending.get_or_insert(broken.ending());
            self.broken.push((id, broken));
            run.conductor.lock().end_with(End::Broken);
        }
        // A thread that ends may fault after its program has: in a destructor of a thread-local.
        if !run.conductor.lock().has_departed(id) {
            run.bury(id, deadline);
        }
    }

    /// Stops those of the programs that have run for `timeout` seconds, unless a debugger holds them.
    fn break_overdue(&mut self, running: &[RobotId], timeout: f64) {
        if watchdog::is_debugged() {
            return;
        }
        self.stopping.retain(|(id, _)| running.contains(id));
        let executor = self.run.executor();
        for id in running {
            let timeout = if self.run.is_removed(*id) { timeout.min(LEAVE.as_secs_f64()) } else { timeout };
            if executor.is_overdue(*id, timeout) {
                executor.break_overdue(*id);
                if self.stopping.iter().all(|(other, _)| other != id) {
                    self.stopping.push((*id, Instant::now()));
                }
            }
        }
    }

    /// Those of the programs that have been stopped and have taken no notice of it.
    fn without_notice(&self, running: &[RobotId]) -> Vec<RobotId> {
        let is_late = |(id, since): &&(RobotId, Instant)| since.elapsed() > NOTICE && running.contains(id);
        self.stopping.iter().filter(is_late).map(|(id, _)| *id).collect()
    }

    /// Lets every program that has not ended leave, one after the other in the order of ids; nothing of a broken process runs on into
    /// the record.
    fn leave(&mut self) {
        if self.has_left || !self.broken.is_empty() || self.run.executor().is_doomed() {
            return;
        }
        self.has_left = true;
        for id in self.run.ids_with_program() {
            self.stop(id);
        }
    }

    /// Lets the program of robot `id` leave if it has not ended; false if it does not in time.
    fn stop(&self, id: RobotId) -> bool {
        let run = &self.run;
        run.is_stopping.store(true, Ordering::Release);
        let has_departed = || run.conductor.lock().has_departed(id);
        if !has_departed() {
            run.executor().resume(id, 0);
        }
        let deadline = Instant::now() + LEAVE;
        while !has_departed() && Instant::now() < deadline {
            run.bell().wait(deadline.saturating_duration_since(Instant::now()));
        }
        has_departed()
    }

    /// What the run has come to, once nobody runs any more.
    fn conclude(&self) -> Ended {
        let run = &self.run;
        let mut conductor = run.conductor.lock();
        let mut environment = run.environment.write();
        let time = conductor.time(&environment.world);
        let end = conductor.take_end();
        let senders = Senders::among(run.ids_with_program().map(|id| run.robot(id)));
        let finish = Finish { end: &end, time, robots: run.robot_count(), senders };
        environment.finish(time);
        let mut robots = Vec::with_capacity(run.robot_count());
        for id in (0..run.robot_count()).map(RobotId::from_index) {
            let mut robot = run.robot(id);
            let broken = self.broken.iter().find(|(other, _)| *other == id).map(|(_, broken)| broken);
            let standing = match run.program(id) {
                Some(_) if broken.is_none() && run.is_removed(id) && robot.ending == Some(Ending::Stopped) => {
                    Standing::removed()
                }
                Some(program) => standing::judge(&mut robot, &finish, broken, program),
                None => Standing::without_program(),
            };
            environment.finish_radio(&mut robot.state);
            standing.record(&mut robot);
            environment.recorder().collect(&mut robot.journal);
            robots.push(RobotEnd {
                virtual_time: robot.now,
                pose: robot.motion.pose(time),
                odometry: robot.motion.odometry(time),
                path: robot.motion.path_length(time),
                contacts: robot.motion.contacts(time),
                steps: robot.motion.legs().map(|_| [robot.walk.footfalls, robot.walk.touches]),
                panel: robot.robios.take_panel(),
                output_cut: robot.robios.console.cut_bytes(),
                outcome: standing.outcome,
                reason: standing.reason,
                exit_code: standing.exit_code,
            });
        }
        let (digest, completed) = conductor.sinks().finish_record(environment.recorder(), time);
        let end = completed.map_or_else(End::Record, |()| end);
        let world = &environment.world;
        let objects =
            (0..world.object_count()).map(|index| world.object_pose(ObjectId::from_index(index), time)).collect();
        Ended { end, time, real_time: self.start.elapsed(), digest, robots, objects, run: Arc::clone(run) }
    }
}

impl Drop for Scheduler {
    fn drop(&mut self) {
        let is_at_rest = self.run.conductor.lock().is_at_rest();
        if is_at_rest {
            self.leave();
        }
        let deadline = Instant::now() + LEAVE;
        self.run.programs().for_each(|program| program.end(deadline));
        if is_at_rest && !self.has_left && !damage::is_heap_lost() {
            // The others give back what they hold, until one of them cannot.
            self.run.ids_with_program().all(|id| self.stop(id));
        }
        let has_left = |id| self.run.conductor.lock().has_departed(id) && !self.left_behind.contains(&id);
        if !self.run.executor().end(&has_left) {
            // The thread of a lost flow may still run code of its program, which stays mapped.
            std::mem::forget(Arc::clone(&self.run));
        }
    }
}
