//! Execution of robot programs: scheduling, flows, crashes and the watchdog.
//!
//! [`Executor`] abstracts over how a flow is run, suspended and resumed. [`thread`] implements it with one OS thread
//! for each flow, which serves the robot's [`process`] if it has one; [`fiber`] implements it with fibers. Code above
//! the trait is independent of the kind of flow. There, [`run`] is the state that flows share, [`dispatcher`] holds the
//! run queues, and the owner of a run, such as [`script`] or the window, advances it through [`scheduler`]. Below the
//! trait, [`signal`] and [`watchdog`] catch programs that crash or never return.

mod answer;
pub mod confine;
pub mod damage;
pub mod dispatcher;
pub mod embedded;
pub mod failure;
pub mod fiber;
mod flow;
pub mod fork;
mod guard;
pub mod interrupt;
pub mod intervene;
pub mod load;
pub mod mixed;
pub mod notifier;
pub mod pace;
mod prefetch;
pub mod process;
pub mod program;
pub mod program_status;
mod reason;
pub mod run;
pub mod scheduler;
pub mod script;
pub mod shared_loop;
pub mod signal;
pub mod spawn;
pub mod subreaper;
pub mod thread;
pub mod watchdog;

use std::sync::Arc;

use sim_core::RobotId;

use self::program::RobotProgram;

/// Runs the flows of robots; implemented with threads, processes or fibers.
///
/// A robot has one flow for each of its tasks, one of which holds the robot's run token: initially the flow of `main`.
/// A flow starts suspended. A robot runs from the time that the dispatcher resumes it until it suspends itself, on the
/// flow with the run token.
pub trait Executor: Send + Sync {
    /// Begins a run. Flows that fail notify `notifier`, for which the run's supervisor waits. Must be called before the
    /// first flow starts.
    fn begin(&self, notifier: &Arc<notifier::Notifier>);

    /// Ends the run and releases the resources of its flows. Failed flows, and flows of robots that have not
    /// departed, are lost with everything that they hold. Returns true if no flow is lost.
    fn end(&self, has_departed: &dyn Fn(RobotId) -> bool) -> bool;

    /// Returns true if the run must end because a program of another run has corrupted the heap of this process.
    fn must_end(&self) -> bool;

    /// Prepares for robots with ids up to `robot`, which runs `program`. `member` is `None` for a robot that is being
    /// spawned.
    fn admit(&self, robot: RobotId, program: &RobotProgram, member: Option<&Arc<run::Member>>);

    /// Creates a suspended flow of the robot for task number `task` ([`MAIN`](crate::robios::task::MAIN) for `main`,
    /// whose flow is created first). `flow` returns when the task has ended, with the number of the task that gets the
    /// run token next; `None` if the task is `main`.
    ///
    /// # Errors
    /// The system lacks the resources for another flow.
    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> std::io::Result<()>;

    /// Makes the flow of the robot's first task serve `child`, the process of the robot's program. Must be called
    /// before the flow is first resumed.
    fn serve(&self, robot: RobotId, child: Arc<process::Child>);

    /// Resumes the robot's flow with the run token on this `worker`. The flows of one worker run one after the other,
    /// so they are best bound to one processor. Called once after each creation or suspension of the robot.
    fn resume(&self, robot: RobotId, worker: u32);

    /// Suspends the calling flow, which holds the run token of `robot`, until it is resumed.
    fn suspend(&self, robot: RobotId);

    /// Continues the calling flow, which holds the run token of `robot`: equivalent to a suspension with an immediate
    /// resumption.
    fn continue_running(&self, robot: RobotId);

    /// Hands the run token of `robot` from the calling flow to the flow of task `task`; returns when the calling flow
    /// has the token again.
    fn switch(&self, robot: RobotId, task: u32);

    /// Number of threads on which [`Executor::run_loop`] runs a loop, the calling one included.
    fn helping_workers(&self) -> usize {
        1
    }

    /// Runs a loop of the scheduler step on the calling thread, and on idle workers. Returns when no thread uses the
    /// job any more.
    fn run_loop(&self, job: &shared_loop::Job<'_>) {
        job.work();
    }

    /// Flows that failed (by a crash, or because they were overdue) and never run again, with the cause.
    fn failures(&self) -> Vec<(RobotId, failure::Failure)>;

    /// Returns true if the robot's flow with the run token has used `timeout` seconds of processor time, or has been
    /// blocked in the kernel for as long, since it was last resumed or handed the run token. Called about twenty times
    /// per second.
    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool;

    /// Location at which the robot's flow with the run token computes: the program counter, then words of the stack
    /// that may be return addresses, innermost first. Empty if the flow does not compute, if it is inside a call, or if
    /// the program has its own process (see [`process::Child::current_location`]).
    fn backtrace(&self, robot: RobotId) -> Vec<usize>;

    /// Stops the overdue flow with the run token where it is; [`Executor::failures`] reports it soon after.
    fn break_overdue(&self, robot: RobotId);
}

/// Limit of the main thread's stack, in bytes; none if the kernel does not report it.
pub fn stack_limit() -> Option<u64> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: the call writes only to `limit`.
    (unsafe { libc::getrlimit(libc::RLIMIT_STACK, &raw mut limit) } == 0).then_some(limit.rlim_cur)
}

/// Disables transparent huge pages for this process, so that a thousand threads take little memory: with huge pages,
/// the heap would take one or two of them for every thread that allocates a few bytes.
pub fn save_memory() {
    // SAFETY: prctl with these arguments takes no pointer; if the kernel refuses, the process only needs more memory.
    unsafe { libc::prctl(libc::PR_SET_THP_DISABLE, 1, 0, 0, 0) };
}
