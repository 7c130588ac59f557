//! Entry point of the processes in which robot programs run; they are started from the binary of the simulator.

use std::ffi::OsString;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::process::ExitCode;

use crate::executive::process::{CHILD_NAME, client};

/// Serves a robot's program if this process was started for one; returns the exit code with which the process must end.
///
/// A binary whose runs have robots in their own processes ([`Exec::Process`](crate::executive::program::Exec::Process))
/// must call this first in its `main`, since these processes are started from the same binary. Programs in Python do
/// not need it.
pub fn serve_child() -> Option<ExitCode> {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let [name, command, library] = &arguments[..] else { return None };
    if command != "child" || !name.as_bytes().starts_with(CHILD_NAME.as_bytes()) {
        return None;
    }
    Some(client::run(Path::new(library), false).unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    }))
}
