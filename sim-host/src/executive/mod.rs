//! Executing robot programs: who runs when, on what, and what happens when one breaks.
//!
//! [`Executor`] is the seam: how a robot's flow of control is run, suspended and resumed. [`thread`] fills it with one OS
//! thread a robot, which serves the robot's [`process`] where it has one; a fiber a robot fits behind it too. Above the seam nothing knows which:
//! [`run`] is what flows share, [`conductor`] decides who runs, and [`scheduler`] is the value by which its owner advances a
//! run; [`script`] is one such owner, the window another. Below the seam, [`signal`] and [`watchdog`] catch programs that fault or
//! never return.

pub mod bell;
pub mod conductor;
pub mod damage;
pub mod fault;
mod flow;
pub mod interrupt;
pub mod intervene;
pub mod load;
pub mod pace;
pub mod process;
pub mod program;
pub mod run;
pub mod scheduler;
pub mod script;
pub mod signal;
pub mod spawn;
pub mod standing;
pub mod thread;
pub mod watchdog;

use std::sync::Arc;

use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use crate::robios::call::Call;

/// How robots' flows of control are run: the one seam that a thread, a process or a fiber a robot fills.
///
/// A robot has one flow for each of its tasks, of which one has the robot's baton: first that of `main`. A flow starts suspended.
/// Exactly the robots run that the conductor resumed and that have not suspended themselves since, each by the flow with the baton.
pub trait Executor: Send + Sync {
    /// A run begins, whose supervisor waits for `bell`: flows that break ring it. To be told before the first flow starts.
    fn begin(&self, bell: &Arc<bell::Bell>);

    /// The run is over: gives back what its flows took. Those that have broken are lost with all that they hold, and so are those of
    /// robots that have not `departed`. True when none is.
    fn end(&self, departed: &dyn Fn(RobotId) -> bool) -> bool;

    /// True when the run's flows must not go on because of what a program of another run has done to this process.
    fn is_doomed(&self) -> bool;

    /// Gets ready for robots up to this one.
    fn admit(&self, robot: RobotId);

    /// Creates a flow of the robot, suspended, for its task of this number ([`MAIN`](crate::robios::task::MAIN) for `main`'s, which
    /// comes first). `flow` returns when the task has ended: the number of the task that gets the baton then, none for `main`'s.
    ///
    /// # Errors
    /// When the system has no room for another flow.
    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> std::io::Result<()>;

    /// The flow of the robot's first task serves this process, in which its program runs. To be told before it is resumed.
    fn serve(&self, robot: RobotId, child: Arc<process::Child>);

    /// Lets the robot's flow with the baton go on, in `lane`: the flows of one lane run one after the other, so they are best kept
    /// on one processor. Called once for each time that the robot suspended itself or was created.
    fn resume(&self, robot: RobotId, lane: u32);

    /// Suspends the calling flow, which has the baton of `robot`, until that is resumed.
    fn suspend(&self, robot: RobotId);

    /// The calling flow, which has the baton of `robot`, would be suspended, but is the one that is resumed, and so goes on.
    fn go_on(&self, robot: RobotId);

    /// Hands the baton of `robot` from the calling flow to that of task `task`, until it is handed back.
    fn switch(&self, robot: RobotId, task: u32);

    /// The calling flow, which has the baton of `robot`, enters `call`; false when it has no stack left to serve it.
    fn enter(&self, robot: RobotId, call: Call) -> bool;

    /// The calling flow, which has the baton of `robot`, goes back to its program.
    fn leave(&self, robot: RobotId);

    /// Calls a function of the robot's program from within a call that the calling flow is in, or at the beginning of a task; the
    /// flow has the baton of `robot` and holds no lock.
    ///
    /// # Errors
    /// [`Stop`] when the program must be left: the call in progress returns it.
    fn call_back(&self, robot: RobotId, callback: Callback) -> Result<(), Stop>;

    /// Flows that broke (a fault, or stopped as overdue) and will never run again, with what is known of it.
    fn broken(&self) -> Vec<(RobotId, fault::Broken)>;

    /// Looks at the robot's flow with the baton, if it runs: true when it has run for `timeout` seconds of its own processor time,
    /// or has been blocked in the kernel for as long, since it was last resumed or handed the baton. Called about twenty times a second.
    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool;

    /// Stops the overdue flow with the baton where it is; [`Executor::broken`] tells of it soon after.
    fn break_overdue(&self, robot: RobotId);
}

/// Keeps the memory of a thousand threads small, for the rest of this process: without huge pages, of which the heap would take
/// one or two for every thread that allocates a few bytes.
pub fn save_memory() {
    // SAFETY: prctl with these arguments takes no pointer; where the kernel refuses, only memory is lost.
    unsafe { libc::prctl(libc::PR_SET_THP_DISABLE, 1, 0, 0, 0) };
}
