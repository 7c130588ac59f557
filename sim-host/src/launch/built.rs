//! A scene whose programs have been built.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::spec::SceneSpec;

use super::ready::Ready;
use super::settings::Settings;
use super::{Error, Options};
use crate::check::Tally;
use crate::executive::load::{execution_of, load_programs};
use crate::executive::program::ExecutionKind;
use crate::executive::spawn::{RobotOptions, Spawner};
use crate::program::find::ProgramSource;
use crate::program::load::Loader;
use crate::program::prepare::Prepared;
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

    /// The files that a user edits to change the run: its inputs, with the sources of Rust packages instead of their
    /// libraries.
    pub fn edited_files(&self) -> Vec<PathBuf> {
        let packages: BTreeMap<&ProgramSource, &Arc<Prepared>> = self
            .programs
            .iter()
            .filter(|program| matches!(program.source, ProgramSource::Cargo(_)))
            .map(|program| (&program.source, program))
            .collect();
        let libraries: BTreeSet<PathBuf> = packages.values().flat_map(|program| program.inputs()).collect();
        let inputs = self.inputs.iter().map(|input| PathBuf::from(&input.path));
        let sources = packages.keys().flat_map(|package| package.sources());
        inputs.filter(|path| !libraries.contains(path)).chain(sources).collect()
    }

    /// The scene's specification.
    pub fn scene(&self) -> &SceneSpec {
        &self.scene
    }

    /// Sources of the programs.
    pub fn sources(&self) -> impl Iterator<Item = &ProgramSource> {
        self.programs.iter().map(|program| &program.source)
    }

    /// Messages for the user about the programs: notes of the search, output of the compiler, warnings about sources of
    /// nondeterminism.
    pub fn remarks(&self) -> &[String] {
        &self.programs.remarks
    }

    /// Remarks on programs that do not run on fibers, or not as [`Options::exec`](super::Options::exec) requests, with
    /// the reasons, one line each.
    pub fn placement_remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for program in self.programs.iter() {
            let (execution, reason) = execution_of(program, self.options.exec);
            let execution = if execution == ExecutionKind::Process { "in a process" } else { "on a thread" };
            let line = reason.map(|reason| format!("program `{}` runs {execution}: it {reason}", program.name));
            lines.extend(line.filter(|line| !lines.contains(line)));
        }
        lines
    }

    /// Returns true if all programs run on fibers, where eyesim handles their crashes.
    pub fn uses_only_fibers(&self) -> bool {
        self.programs.iter().all(|program| execution_of(program, self.options.exec).0 == ExecutionKind::Fiber)
    }

    /// Returns true if at least one robot has a program.
    pub fn has_programs(&self) -> bool {
        self.programs.iter().next().is_some()
    }

    /// Creates the robots and loads their programs.
    ///
    /// # Errors
    /// [`Error::Load`] for a program that cannot be loaded, [`Error::Robot`] for a robot that cannot be simulated,
    /// [`Error::Frames`] for a folder of images that cannot be created.
    pub fn load(self) -> Result<Ready, Error> {
        let mut loader = Loader::new()
            .map_err(|error| Error::Folder { purpose: "folder in $TMPDIR to load programs from", error })?;
        self.load_with(&mut loader)
    }

    /// Creates the robots and loads their programs as [`BuiltScene::load`] does, reusing the libraries that `loader`
    /// has mapped for earlier runs, which must have ended.
    ///
    /// # Errors
    /// See [`BuiltScene::load`].
    pub fn load_with(self, loader: &mut Loader) -> Result<Ready, Error> {
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
            may_execute: options.allow_execute && options.sandbox.is_none(),
            output_limit: options.output_limit,
            stdin: settings.stdin.clone(),
            is_verbose: options.is_verbose,
            scenery: Arc::clone(&scenery),
            frames: frames.clone(),
            exec: options.exec,
            sandbox: options.sandbox.clone(),
            workers: options.worker_count(),
        };
        loader.set_sandbox(options.sandbox.clone());
        let mut spawner = Spawner::new(Arc::clone(&scene), &programs, robot_options);
        let (world, robots) = spawner.start()?;
        let loaded =
            load_programs(&scene, &programs, options.exec, options.debug.as_ref(), options.worker_count(), loader)?;
        let tally = Tally::new(&scene).map(|tally| Arc::new(Mutex::new(tally)));
        Ok(Ready { options, settings, scene, scenery, inputs, frames, spawner, world, robots, tally, programs: loaded })
    }
}
