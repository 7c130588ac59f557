//! Executing robot programs: who runs when, on what, and what happens when one breaks.
//!
//! [`Executor`] is the seam: how a robot's flow of control is run, suspended and resumed. [`thread`] fills it with one OS
//! thread a robot, which serves the robot's [`process`] where it has one; a fiber a robot fits behind it too. Above the seam nothing knows which:
//! [`conductor`] is the slot loop that decides who runs, [`run`] starts and supervises a whole run. Below it, [`signal`]
//! and [`watchdog`] catch programs that fault or never return.

pub mod bell;
pub mod conductor;
pub mod fault;
pub mod process;
pub mod program;
pub mod run;
pub mod signal;
pub mod standing;
pub mod thread;
pub mod watchdog;

use std::sync::Arc;

use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use crate::robios::caller::Call;

/// How robots' flows of control are run: the one seam that a thread, a process or a fiber a robot fills.
///
/// A flow starts suspended. Exactly the flows that the conductor resumed and that have not suspended themselves since run.
pub trait Executor: Send + Sync {
    /// Creates the robot's flow, suspended; `flow` returns when the robot's program has ended. `child` is the process that the
    /// flow serves, where its program has one of its own.
    ///
    /// # Errors
    /// When the system has no room for another flow.
    fn start(
        &self,
        robot: RobotId,
        child: Option<Arc<process::Child>>,
        flow: Box<dyn FnOnce() + Send>,
    ) -> std::io::Result<()>;

    /// Lets the robot's flow go on, in `lane`: the flows of one lane run one after the other, so they are best kept on one
    /// processor. Called once for each time that the flow suspended itself or was created.
    fn resume(&self, robot: RobotId, lane: u32);

    /// Suspends the calling flow, which is `robot`'s, until it is resumed.
    fn suspend(&self, robot: RobotId);

    /// The flow of `robot` enters `call`; false when it has no stack left to serve it.
    fn enter(&self, robot: RobotId, call: Call) -> bool;

    /// The flow of `robot` goes back to its program.
    fn leave(&self, robot: RobotId);

    /// Calls a function of the robot's program from within a call that the flow of `robot` is in, which holds no lock.
    ///
    /// # Errors
    /// [`Stop`] when the program must be left: the call in progress returns it.
    fn call_back(&self, robot: RobotId, callback: Callback) -> Result<(), Stop>;

    /// Flows that broke (a fault, or stopped as overdue) and will never run again, with what is known of it.
    fn broken(&self) -> Vec<(RobotId, fault::Broken)>;

    /// Looks at the robot's flow, if it runs: true when it has run for `timeout` seconds of its own processor time, or has
    /// been blocked in the kernel for as long, since it was last resumed. Called about twenty times a second.
    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool;

    /// Stops an overdue flow where it is; [`Executor::broken`] tells of it soon after.
    fn break_overdue(&self, robot: RobotId);
}

/// Keeps the memory of a thousand threads small, for the rest of this process: without huge pages, of which the heap would take
/// one or two for every thread that allocates a few bytes.
pub fn save_memory() {
    // SAFETY: prctl with these arguments takes no pointer; where the kernel refuses, only memory is lost.
    unsafe { libc::prctl(libc::PR_SET_THP_DISABLE, 1, 0, 0, 0) };
}
