//! Programs that are code of the process that embeds the simulator, such as Python functions.

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use robios_sys::Status;
use robios_sys::wire::Malformed;
use sim_core::RobotId;

/// Code of the embedding process that runs as the program of robots, each on a thread that the simulator creates for
/// it.
pub trait EmbeddedCode: Send + Sync {
    /// Runs the program of `robot`, which makes its calls through `calls`, to its end.
    fn run(&self, robot: RobotId, arguments: &[String], calls: Arc<dyn Calls>) -> EmbeddedEnd;

    /// Calls the function that the program of `robot` has registered under `number`, on the program's thread and within
    /// one of its calls. Returns [`Status::STOP`] if that call must not continue.
    fn call_back(&self, robot: RobotId, number: u64) -> Status;

    /// Requests that the program of `robot`, which computes or sleeps on its thread, end with [`EmbeddedEnd::Overdue`].
    /// A program that does not end soon is abandoned.
    fn stop(&self, robot: RobotId);
}

/// Calls of a running program.
pub trait Calls: Send + Sync {
    /// Carries out a call: `request` is the body of a CALL message as described in `docs/protocol.md`, and the body of
    /// the answer is appended to `reply`. Returns [`Status::STOP`] once the program must end, and on threads other than
    /// its own.
    ///
    /// # Errors
    /// [`Malformed`] if the bytes do not encode a call.
    fn call(&self, request: &[u8], reply: &mut Vec<u8>) -> Result<Status, Malformed>;
}

/// End of an embedded program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EmbeddedEnd {
    /// The program has returned, with this exit code.
    Exited(i32),
    /// The program was [stopped](EmbeddedCode::stop) at this location, such as `notebook.py:12`; empty if unknown.
    Overdue(String),
}

/// A program that scenes and options name by a reference. Programs with the same reference are equal.
#[derive(Clone)]
pub struct EmbeddedProgram {
    /// Reference that scenes use instead of a file name, unique in a run: `drive()`.
    pub reference: String,
    /// Name of the program, the `argv[0]` of its robots: `drive`.
    pub name: String,
    /// The code that runs.
    pub code: Arc<dyn EmbeddedCode>,
}

impl std::fmt::Debug for EmbeddedProgram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("EmbeddedProgram").field(&self.reference).finish()
    }
}

impl PartialEq for EmbeddedProgram {
    fn eq(&self, other: &Self) -> bool {
        self.reference == other.reference
    }
}

impl Eq for EmbeddedProgram {}

impl PartialOrd for EmbeddedProgram {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for EmbeddedProgram {
    fn cmp(&self, other: &Self) -> Ordering {
        self.reference.cmp(&other.reference)
    }
}

impl Hash for EmbeddedProgram {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.reference.hash(state);
    }
}
