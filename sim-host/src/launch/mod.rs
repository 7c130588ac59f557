//! Runs of scenes with robot programs, as a library: no command line, no console.
//!
//! [`Scene::open`] reads a scene with all that it names; what is wrong in its files is a list of diagnostics. [`Scene::load`] builds and
//! loads its programs. [`Ready::start`] gives a [`Running`] run, which its owner steps or takes to its end; [`Running::finish`] gives
//! what became of it. Several runs may go on side by side in one process.

mod built;
pub mod check;
mod child;
mod finished;
mod options;
mod ready;
mod scene;
pub mod settings;

pub use built::Built;
pub use child::serve_child;
pub use finished::Finished;
pub use options::{DEFAULT_UNTIL, Options};
pub use ready::{Observers, Ready, Running};
pub use scene::Scene;

use sim_core::simulation::FactoryError;
use sim_format::{Diagnostic, InputFile};

use crate::record::RecordError;

/// Why a scene is not run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Its files have mistakes.
    #[error(transparent)]
    Rejected(#[from] Rejected),
    /// What was asked for makes no sense: a path that is no scene, an option that fits nothing in it, a program that cannot be built.
    #[error("{0}")]
    Asked(String),
    /// A robot's type, or errors of its drive, with which nothing can be computed.
    #[error(transparent)]
    Robot(#[from] FactoryError),
    /// A program that was built cannot be loaded.
    #[error("{0}")]
    Load(String),
    /// The system has no room for the robots.
    #[error("cannot start the robots: {0}")]
    Start(String),
    /// A file that records the run cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl Error {
    /// What was asked for makes no sense for this reason, with all its causes.
    pub(crate) fn asked(error: anyhow::Error) -> Self {
        Self::Asked(format!("{error:#}"))
    }
}

/// A scene that is not run because of what is wrong in its files.
#[derive(Clone, Debug, thiserror::Error)]
#[error("the scene is not run: {}", check::count(diagnostics))]
pub struct Rejected {
    /// What is wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// The files of which they speak.
    pub inputs: Vec<InputFile>,
}
