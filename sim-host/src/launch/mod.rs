//! Runs of scenes with robot programs, as a library: no command line, no console.
//!
//! [`Scene::open`] reads a scene with all files to which it refers, and lists the mistakes in them as diagnostics.
//! [`Scene::load`] builds and loads the programs of the robots. [`Ready::start`] returns a [`Running`] run, which its
//! owner advances step by step or to its end; [`Running::finish`] returns the results. Several runs may exist side by
//! side in one process.

mod built;
pub mod check;
mod child;
mod finished;
mod option_error;
mod options;
mod ready;
mod scene;
pub mod settings;

pub use built::BuiltScene;
pub use child::serve_child;
pub use finished::Finished;
pub use option_error::{CostFileError, OptionError, UnknownRobot};
pub use options::{DEFAULT_UNTIL, Options, UnpackedArchive};
pub use ready::{EndedRun, Observers, Ready, Running};
pub use scene::{NotAScene, ProgramCache, Scene};

use std::path::PathBuf;

use sim_core::simulation::FactoryError;
use sim_format::{Diagnostic, InputFile};

use crate::executive::load::ProgramLoadError;
use crate::program::scene::ProgramsError;
use crate::record::RecordError;
use crate::record::frame::FolderError;

/// Reasons why a scene cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene's files have mistakes.
    #[error(transparent)]
    Rejected(#[from] Rejected),
    /// The path is not that of a scene.
    #[error(transparent)]
    NotAScene(#[from] NotAScene),
    /// An option does not fit the scene.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// A folder that the run needs is missing or cannot be used.
    #[error("no {purpose}: {error}")]
    Folder {
        /// Purpose of the folder.
        purpose: &'static str,
        /// The reason.
        error: std::io::Error,
    },
    /// Programs cannot be found or built.
    #[error(transparent)]
    Programs(#[from] ProgramsError),
    /// The folder for images cannot be used.
    #[error("--frames `{}`: {error}", folder.display())]
    Frames {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        error: FolderError,
    },
    /// A robot's type, or the noise model of its drive, has values that cannot be simulated.
    #[error(transparent)]
    Robot(#[from] FactoryError),
    /// A program that was built cannot be loaded.
    #[error(transparent)]
    Load(#[from] ProgramLoadError),
    /// The system lacks the resources for the robots.
    #[error("cannot start the robots: {0}")]
    Start(std::io::Error),
    /// A file of the run's record cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
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
