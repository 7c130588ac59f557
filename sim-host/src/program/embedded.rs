//! Programs that are code of the process which embeds the simulator, such as functions of Python.

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use robios_sys::Status;
use robios_sys::wire::Malformed;
use sim_core::RobotId;

/// Code of the embedding process that runs as the program of robots, each on a thread that the simulator has made for it.
pub trait EmbeddedCode: Send + Sync {
    /// Runs the program of `robot`, which makes its calls through `calls`, to its end.
    fn run(&self, robot: RobotId, arguments: &[String], calls: Arc<dyn Calls>) -> EmbeddedEnd;

    /// Calls the function that the program of `robot` knows by `number`, on its thread and within one of its calls. Returns
    /// [`Status::STOP`] if that call must not go on.
    fn call_back(&self, robot: RobotId, number: u64) -> Status;

    /// Asks the program of `robot`, which computes or sleeps on its thread, to end with [`EmbeddedEnd::Overdue`]. One that does not end
    /// soon is abandoned.
    fn stop(&self, robot: RobotId);
}

/// Calls of a program that runs.
pub trait Calls: Send + Sync {
    /// Carries out a call: `request` is the body of a CALL message as `docs/protocol.md` has it, and that of its answer is appended to
    /// `reply`. [`Status::STOP`] once the program must end, and on other threads than its own.
    ///
    /// # Errors
    /// [`Malformed`] for bytes that are no call.
    fn call(&self, request: &[u8], reply: &mut Vec<u8>) -> Result<Status, Malformed>;
}

/// End of an embedded program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EmbeddedEnd {
    /// It has returned, with this exit code.
    Exited(i32),
    /// It was [stopped](EmbeddedCode::stop), at this place: `notebook.py:12`, or empty.
    Overdue(String),
}

/// A program as scenes and options refer to it. Programs with one reference are equal.
#[derive(Clone)]
pub struct EmbeddedProgram {
    /// Reference to it in place of a file's, unique in a run: `drive()`.
    pub reference: String,
    /// Its name, the `argv[0]` of its robots: `drive`.
    pub name: String,
    /// What runs.
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
