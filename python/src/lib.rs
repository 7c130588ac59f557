//! The extension module `eyesim._native`, which the Python package calls.
//!
//! The rooms convert between Python's numbers, buffers and exceptions and the library's values. The package's own files
//! in `python/eyesim` add names, types and shapes. While the library works, other Python threads run.

mod batch;
mod callable;
mod command;
mod error;
mod run;
mod simulation;

use pyo3::prelude::*;

/// The host does not use libc's heap: a crashed robot program may leave libc's heap locked or corrupt.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Functions and classes that the package `eyesim` uses; `_native.pyi` gives their types.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::{Batch, episode_seed};
    #[pymodule_export]
    use super::callable::Calls;
    #[pymodule_export]
    use super::command::{describe_host, eye_source, main};
    #[pymodule_export]
    use super::run::run;
    #[pymodule_export]
    use super::simulation::Simulation;
}
