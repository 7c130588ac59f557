//! From a scene to a run that can start: finds, builds and loads the programs, makes world and robots.

use std::collections::BTreeMap;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::RobotId;
use sim_core::build;
use sim_core::drive::Motion;
use sim_core::format::SceneSpec;
use sim_core::time::Time;
use sim_core::world::World;

use crate::executive::run::Program;
use crate::program::build::{Builder, Built, Tools};
use crate::program::cache::Cache;
use crate::program::find::{ProgramSource, SearchPath, find_program};
use crate::program::image::ProgramImage;
use crate::program::load::{LoadError, Loader, c_arguments, check_mappings};
use crate::robios::Devices;
use crate::robios::key::{Keys, Press};
use crate::robios::robot::{Robot, RobotParts};

/// Memory mappings of a robot's flow: its stack, the guard below it, its alternate stack and the kernel's neighbours.
const MAPPINGS_PER_FLOW: usize = 4;

/// A program that was found and built.
pub struct BuiltProgram {
    /// The library, read.
    pub image: Arc<ProgramImage>,
    /// What the compiler said, and remarks on how it was found.
    pub remarks: Vec<String>,
    /// Files whose contents decide what runs: sources, or the library itself.
    pub inputs: Vec<PathBuf>,
}

/// Why a scene cannot be run.
#[derive(Debug)]
pub enum SetupError {
    /// A file or the command line is wrong.
    Input(anyhow::Error),
    /// A robot's program cannot be loaded.
    Program(anyhow::Error),
}

impl From<anyhow::Error> for SetupError {
    fn from(error: anyhow::Error) -> Self {
        Self::Input(error)
    }
}

/// Finds and builds the programs of all robots, each once; in the order of the robots.
///
/// # Errors
/// All programs that cannot be found or built, in one message with the lines of the sim file.
pub fn build_programs(scene: &SceneSpec, search: &SearchPath) -> anyhow::Result<Vec<Arc<BuiltProgram>>> {
    let mut found = BTreeMap::new();
    let mut mistakes = Vec::new();
    for robot in &scene.robots {
        let text = &robot.program.text;
        if !found.contains_key(text) {
            match find_program(text, search) {
                Ok(program) => {
                    found.insert(text.clone(), program);
                }
                Err(error) => {
                    let line = robot.program.span.line;
                    mistakes.push(format!("{}:{line}: {error}", scene.file));
                }
            }
        }
    }
    fail_with(&mistakes)?;

    let cache = Cache::of_user().context("no folder for built programs")?;
    let builder = Builder::new(cache, crate::program::compile::ShimKit::robios6(), Tools::of_environment());
    let sources: Vec<ProgramSource> = found.values().map(|program| program.source.clone()).collect();
    let mut built = BTreeMap::new();
    for ((text, found), result) in found.iter().zip(builder.build_all(&sources)) {
        let program = result.map_err(anyhow::Error::from).and_then(|built| read_program(built, &found.notes));
        match program {
            Ok(program) => {
                built.insert(text.as_str(), Arc::new(program));
            }
            Err(error) => mistakes.push(format!("program `{text}`: {error:#}")),
        }
    }
    fail_with(&mistakes)?;
    Ok(scene.robots.iter().map(|robot| Arc::clone(&built[robot.program.text.as_str()])).collect())
}

fn fail_with(mistakes: &[String]) -> anyhow::Result<()> {
    if mistakes.is_empty() { Ok(()) } else { Err(anyhow!("{}", mistakes.join("\n"))) }
}

fn read_program(built: Built, notes: &[String]) -> anyhow::Result<BuiltProgram> {
    let source_folder = match &built.source {
        ProgramSource::Library(_) => None,
        ProgramSource::C(sources) => sources.first().and_then(|source| source.parent()),
        ProgramSource::Cargo(folder) => Some(folder.as_path()),
    };
    let image = ProgramImage::read(&built.library, source_folder)?;
    let inputs = match built.source {
        ProgramSource::C(sources) => sources,
        ProgramSource::Library(_) | ProgramSource::Cargo(_) => vec![built.library],
    };
    let output = Some(built.output).filter(|output| !output.is_empty());
    Ok(BuiltProgram { image: Arc::new(image), remarks: notes.iter().cloned().chain(output).collect(), inputs })
}

/// Maps a private copy of its program for each robot, with the arguments that its `main` gets.
///
/// # Errors
/// [`SetupError::Program`] for the first program that cannot be loaded.
pub fn load_programs(
    scene: &SceneSpec,
    programs: &[Arc<BuiltProgram>],
    arguments: &BTreeMap<RobotId, Vec<String>>,
) -> Result<Vec<Program>, SetupError> {
    let counted = programs.iter().map(|program| (&*program.image, 1));
    check_mappings(counted, MAPPINGS_PER_FLOW).map_err(|error| SetupError::Input(error.into()))?;
    let mut loader = Loader::new().context("no folder to load programs from")?;
    let mut loaded = Vec::with_capacity(programs.len());
    for (robot, program) in scene.robots.iter().zip(programs) {
        let failed = |error: LoadError| {
            SetupError::Program(anyhow!("{} (`{}`): {error}", robot.id, robot.program.text))
        };
        let name = program_name(&robot.program.text);
        let words = arguments.get(&robot.id).into_iter().flatten().map(String::as_str);
        let arguments: Vec<CString> = c_arguments(name, words)
            .map_err(|place| anyhow!("argument {place} of {} holds a NUL character", robot.id))?;
        loaded.push(Program { loaded: loader.load(&program.image).map_err(failed)?, arguments });
    }
    Ok(loaded)
}

/// A program's name without folder and extension.
pub fn program_name(reference: &str) -> &str {
    let file = reference.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(reference);
    file.rsplit_once('.').map_or(file, |(stem, _)| if stem.is_empty() { file } else { stem })
}

/// What a run's robots are made with, besides the scene.
pub struct RobotOptions<'a> {
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Key presses of all robots.
    pub keys: &'a [Press],
    /// True when every call is to be recorded.
    pub is_verbose: bool,
}

/// The world at time 0 and its robots.
///
/// # Errors
/// A robot type with which nothing can be computed.
pub fn build_world(scene: &SceneSpec, options: &RobotOptions<'_>) -> anyhow::Result<(World, Vec<Robot>)> {
    debug_assert!(scene.robots.iter().enumerate().all(|(index, robot)| robot.id.index() == index));
    let walls = build::walls(&scene.world);
    let mut models = BTreeMap::new();
    let mut robots = Vec::with_capacity(scene.robots.len());
    for spec in &scene.robots {
        let model = models.entry(&spec.robi.file).or_insert_with(|| Arc::new(build::model(&spec.robi)));
        model.check().with_context(|| format!("robot type `{}`", spec.robi.file))?;
        let presses = options.keys.iter().filter(|press| press.robot.is_none_or(|robot| robot == spec.id));
        let mut robot = Robot::new(RobotParts {
            program: program_name(&spec.program.text).to_owned(),
            motion: Motion::new(spec.id, Arc::clone(model), Arc::clone(&walls), spec.start),
            spec: Arc::clone(&spec.robi),
            devices: Devices::new(&spec.robi, Keys::scripted(presses.map(|press| (press.at, press.code)))),
            seed: options.seed,
            is_verbose: options.is_verbose,
        });
        robot.record_start();
        robots.push(robot);
    }
    let world = World::new(walls, options.slot, robots.iter_mut().map(|robot| &mut robot.motion));
    Ok((world, robots))
}
