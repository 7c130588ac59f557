//! Interface through which a robot's calls reach the run.

use parking_lot::MutexGuard;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;
use sim_core::time::Time;
use sim_core::world::World;

use super::call::Call;
use super::forbidden::Forbidden;
use super::robot::Robot;
use crate::program::site::Site;

/// A robot's flow of control and its run, as far as the calls of its program need them. The executive implements it
/// with threads, processes or fibers; calls do not depend on the implementation.
pub trait Flow: Send + Sync + 'static {
    /// Id of the robot.
    fn id(&self) -> RobotId;

    /// Locks the robot's state.
    fn robot(&self) -> MutexGuard<'_, Robot>;

    /// The world as published at the start of the current slot; the reference must not be kept while the flow suspends
    /// itself.
    fn world(&self) -> &World;

    /// Virtual time that `call` takes.
    fn cost(&self, call: Call) -> Time;

    /// Functions that the scene forbids.
    fn forbidden(&self) -> &Forbidden;

    /// Start of the current slot.
    fn slot_start(&self) -> Time;

    /// End of the current slot.
    fn slot_end(&self) -> Time;

    /// Suspends the calling flow until the slot that contains `wake`, or earlier if the awaited condition may
    /// have changed.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    fn suspend(&self, wake: Time) -> Result<(), Stop>;

    /// Runs the effect of a call of this flow. `effect` does not suspend the flow.
    fn run_effect(&self, effect: &mut dyn FnMut());

    /// Returns true once the program must end: calls then return [`Stop`].
    fn is_exiting(&self) -> bool;

    /// Returns true if the robot's calls are recorded.
    fn is_verbose(&self) -> bool;

    /// Marks that the calling flow enters `call`; returns false if its stack is too small for the call.
    fn enter(&self, call: Call) -> bool;

    /// Marks that the calling flow returns to its program.
    fn leave(&self);

    /// Hands the robot's run token from the calling flow to the flow of task `task`; returns when the calling flow has
    /// the token again.
    fn switch(&self, task: u32);

    /// Starts the flow of task `task`, which runs `code` when its turn comes.
    ///
    /// # Errors
    /// If the system lacks the resources for another flow.
    fn start_task(&self, task: u32, code: Callback) -> std::io::Result<()>;

    /// Calls a function of the program from within a call; the caller must hold no lock.
    ///
    /// # Errors
    /// [`Stop`] if the program must end: the call in progress returns it.
    fn call_back(&self, callback: Callback) -> Result<(), Stop>;

    /// Location in the program of the call in progress.
    fn call_site(&self) -> Site;

    /// The line of the program at `site`, such as `maze.c:88`, if known.
    fn location_of(&self, site: &Site) -> Option<String>;

    /// The innermost line of the program in a call stack, given as return addresses, the innermost first.
    fn line_of(&self, stack: &[usize]) -> Option<String>;

    /// Records that the hint `text` was given in the call in progress, made at `site`.
    fn note_hint(&self, text: &str, site: &Site);

    /// Describes what each task of `robot`, the robot of this flow, waits for.
    fn waits_of(&self, robot: &Robot) -> String;
}
