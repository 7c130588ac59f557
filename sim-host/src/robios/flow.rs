//! What a robot's calls need of the run in which they are made.

use parking_lot::{MappedRwLockReadGuard, MutexGuard};
use robios_sys::{Callback, Stop};
use sim_core::RobotId;
use sim_core::time::Time;
use sim_core::world::World;

use super::call::Call;
use super::robot::Robot;
use crate::program::site::Site;

/// A robot's flow of control, and the run around it, as the calls of its program see them. The executive fills it, with threads,
/// processes or fibers: nothing here knows which.
pub trait Flow: Send + Sync + 'static {
    /// The robot.
    fn id(&self) -> RobotId;

    /// Its state.
    fn robot(&self) -> MutexGuard<'_, Robot>;

    /// The world, as it was made public at the start of the present slot.
    fn world(&self) -> MappedRwLockReadGuard<'_, World>;

    /// Virtual time that `call` takes.
    fn cost(&self, call: Call) -> Time;

    /// Start of the present slot.
    fn slot_start(&self) -> Time;

    /// End of the present slot.
    fn slot_end(&self) -> Time;

    /// Suspends the calling flow until the slot that contains `wake`, or earlier if what it waits for changes.
    ///
    /// # Errors
    /// [`Stop`] when the program is to leave.
    fn suspend(&self, wake: Time) -> Result<(), Stop>;

    /// True once the program is to leave: every call is turned back.
    fn is_leaving(&self) -> bool;

    /// True when the calls of the robot are recorded.
    fn is_verbose(&self) -> bool;

    /// The calling flow enters `call`; false when it has no stack left to serve it.
    fn enter(&self, call: Call) -> bool;

    /// The calling flow goes back to its program.
    fn leave(&self);

    /// Hands the run token of the robot from the calling flow to that of task `task`, until it is handed back.
    fn switch(&self, task: u32);

    /// Starts the flow of task `task`, which runs `code` when its turn comes.
    ///
    /// # Errors
    /// When the system has no room for another flow.
    fn start_task(&self, task: u32, code: Callback) -> std::io::Result<()>;

    /// Calls a function of the program from within a call; no lock is held.
    ///
    /// # Errors
    /// [`Stop`] when the program must be left: the call in progress returns it.
    fn call_back(&self, callback: Callback) -> Result<(), Stop>;

    /// Where the program made the call that it is in.
    fn call_site(&self) -> Site;

    /// What each task of `robot`, which is this one, waits for, in words.
    fn waits_of(&self, robot: &Robot) -> String;
}
