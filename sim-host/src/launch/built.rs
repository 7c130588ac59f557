//! A scene whose programs have been built.

use std::path::PathBuf;
use std::sync::Arc;

use sim_core::spec::SceneSpec;

use super::ready::Ready;
use super::settings::Settings;
use super::{Error, Options};
use crate::executive::load::load_programs;
use crate::executive::spawn::{RobotOptions, Spawner};
use crate::program::scene::Programs;
use crate::record::frame::Frames;
use crate::record::report::Input;
use crate::scenery::LazyScenery;

/// A scene whose programs have been built.
pub struct BuiltScene {
    pub(super) options: Options,
    pub(super) settings: Settings,
    pub(super) scene: Arc<SceneSpec>,
    pub(super) scenery: Arc<LazyScenery>,
    pub(super) inputs: Vec<Input>,
    pub(super) programs: Programs,
}

impl BuiltScene {
    /// Every file that determines the run.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Messages for the user about the programs: notes of the search, output of the compiler, warnings about the guarantee of equal runs.
    pub fn remarks(&self) -> &[String] {
        &self.programs.remarks
    }

    /// Returns true if at least one robot has a program.
    pub fn has_programs(&self) -> bool {
        self.programs.iter().next().is_some()
    }

    /// Creates the robots and loads their programs.
    ///
    /// # Errors
    /// [`Error::Load`] for a program that cannot be loaded, [`Error::Robot`] for a robot that cannot be simulated, [`Error::Frames`] for
    /// a folder of images that cannot be created.
    pub fn load(self) -> Result<Ready, Error> {
        let Self { options, settings, scene, scenery, inputs, programs } = self;
        let frames = |folder: &PathBuf| {
            let frames = Frames::create(folder, scene.robots.len());
            frames.map_err(|error| Error::Frames { folder: folder.clone(), error })
        };
        let mut frames = options.frames.as_ref().map(frames).transpose()?;
        if options.keep_frames {
            frames = Some(frames.unwrap_or_default().storing());
        }
        let frames = frames.map(Arc::new);
        let robot_options = RobotOptions {
            seed: settings.seed,
            slot: settings.slot,
            keys: settings.keys.clone(),
            may_execute: options.allow_execute,
            output_limit: options.output_limit,
            is_verbose: options.is_verbose,
            scenery: Arc::clone(&scenery),
            frames: frames.clone(),
            exec: options.exec,
        };
        let mut spawner = Spawner::new(Arc::clone(&scene), &programs, robot_options);
        let (world, robots) = spawner.start()?;
        let loaded = load_programs(&scene, &programs, options.exec, options.debug.as_ref())?;
        Ok(Ready { options, settings, scene, scenery, inputs, frames, spawner, world, robots, programs: loaded })
    }
}
