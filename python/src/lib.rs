//! The extension module `eyesim._native`, which the Python package calls.
//!
//! The rooms translate: numbers, buffers and exceptions of Python on one side, the library's values on the other. The
//! package's own files in `python/eyesim` give them names, types and shapes. While the library works, other Python
//! threads run.

mod batch;
mod callable;
mod command;
mod error;
mod run;
mod simulation;

use pyo3::prelude::*;

/// The host's heap is not libc's, which a robot program that faults may leave locked or corrupted.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Functions and classes on which the package `eyesim` is built; their types are in `_native.pyi`.
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
