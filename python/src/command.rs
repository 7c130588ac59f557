//! The command `eyesim` within a Python process.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use pyo3::prelude::*;
use sim_host::host::{self, Host};

/// Describes this process to the simulator: see [`Host`].
#[pyfunction]
pub fn describe_host(
    command: Vec<OsString>,
    script: PathBuf,
    home: PathBuf,
    python: PathBuf,
    zig: Vec<String>,
    zig_installer: String,
) {
    host::set(Host { command, script, home: Some(home), python: Some(python), zig, zig_installer });
}

/// The module `eye` of robot programs in Python, as text.
#[pyfunction]
pub fn eye_source() -> String {
    robios_sys::python::eye()
}

/// Runs the command `eyesim` with these arguments, the first of which is its name; returns the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    let code = py.detach(|| {
        sim_host::executive::save_memory();
        eyesim::cli::run_words(words)
    });
    // The standard library does not expose the number of an exit code, but compares exit codes.
    (0..=u8::MAX).find(|number| ExitCode::from(*number) == code).unwrap_or(eyesim::cli::EXIT_INTERNAL)
}
