//! Runs of scenes with robot programs, as a library: no command line, no console.
//!
//! [`Scene::open`] reads a scene with all files that it names; mistakes in them are a list of diagnostics. [`Scene::load`] builds and
//! loads its programs. [`Ready::start`] returns a [`Running`] run, which its owner advances step by step or to its end;
//! [`Running::finish`] returns the results. Several runs may exist side by side in one process.

mod built;
pub mod check;
mod child;
mod finished;
mod options;
mod ready;
mod scene;
pub mod settings;

pub use built::BuiltScene;
pub use child::serve_child;
pub use finished::Finished;
pub use options::{DEFAULT_UNTIL, Options};
pub use ready::{Observers, Ready, Running};
pub use scene::Scene;

use sim_core::simulation::FactoryError;
use sim_format::{Diagnostic, InputFile};

use crate::record::RecordError;

/// Reasons why a scene cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Its files have mistakes.
    #[error(transparent)]
    Rejected(#[from] Rejected),
    /// The request makes no sense: a path that is no scene, an option that does not fit the scene, a program that cannot be built.
    #[error("{0}")]
    InvalidRequest(String),
    /// A robot's type, or the noise model of its drive, has values that cannot be simulated.
    #[error(transparent)]
    Robot(#[from] FactoryError),
    /// A program that was built cannot be loaded.
    #[error("{0}")]
    Load(String),
    /// The system has no room for the robots.
    #[error("cannot start the robots: {0}")]
    Start(String),
    /// A file of the run's record cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl Error {
    /// [`Error::InvalidRequest`] with the message of `error` and all its causes.
    pub(crate) fn invalid_request(error: anyhow::Error) -> Self {
        Self::InvalidRequest(format!("{error:#}"))
    }
}

/// A scene that cannot be run because of mistakes in its files.
#[derive(Clone, Debug, thiserror::Error)]
#[error("the scene is not run: {}", check::count(diagnostics))]
pub struct Rejected {
    /// The mistakes.
    pub diagnostics: Vec<Diagnostic>,
    /// The files to which the diagnostics refer.
    pub inputs: Vec<InputFile>,
}
