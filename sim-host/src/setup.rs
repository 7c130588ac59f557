//! From a scene to a run that can start: finds, builds and loads the programs, makes world and robots.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::RobotId;
use sim_core::build;
use sim_core::drive::Motion;
use sim_core::format::SceneSpec;
use sim_core::time::Time;
use sim_core::world::World;

use crate::program::build::{Builder, Tools};
use crate::program::cache::Cache;
use crate::program::compile::ShimKit;
use crate::program::find::{SearchPath, find_program};
use crate::program::load::{LoadError, LoadedProgram, Loader, check_mappings};
use crate::program::prepare::{Prepared, prepare};
use crate::robios::Devices;
use crate::robios::key::{Keys, Press};
use crate::robios::robot::{Robot, RobotParts};

/// Memory mappings of a robot's flow: its stack, the guard below it, its alternate stack and the kernel's neighbours.
const MAPPINGS_PER_FLOW: usize = 4;

/// The programs of a scene, built.
pub struct Programs {
    /// In the order of the robots; robots with one program share it.
    pub of_robots: Vec<Arc<Prepared>>,
    /// What the user should know: how they were found, what the compiler said, what is outside the guarantee.
    pub remarks: Vec<String>,
}

impl Programs {
    /// Finds and builds the programs of all robots, each once.
    ///
    /// # Errors
    /// All programs that cannot be found or built, in one message with the lines of the sim file.
    pub fn build(scene: &SceneSpec, search: &SearchPath) -> anyhow::Result<Self> {
        let mut found = Vec::with_capacity(scene.robots.len());
        let mut mistakes = Vec::new();
        for robot in &scene.robots {
            let Some(program) = &robot.program else {
                push_new(&mut mistakes, format!("{}:{}: this robot has no program", scene.file, robot.span.line));
                continue;
            };
            match find_program(&program.text, search) {
                Ok(program) => found.push(program),
                Err(error) => push_new(&mut mistakes, format!("{}:{}: {error}", scene.file, program.span.line)),
            }
        }
        fail_with(&mistakes)?;

        let cache = Cache::of_user().context("no folder for built programs")?;
        let builder = Builder::new(cache, ShimKit::robios6(), Tools::of_environment());
        let mut of_robots = Vec::with_capacity(found.len());
        let mut remarks = Vec::new();
        for ((robot, found), prepared) in scene.robots.iter().zip(&found).zip(prepare(&builder, &found)) {
            found.notes.iter().for_each(|note| push_new(&mut remarks, note.clone()));
            match prepared {
                Ok(program) => {
                    let output = Some(program.output.trim_end()).filter(|output| !output.is_empty());
                    output.iter().for_each(|output| push_new(&mut remarks, (*output).to_owned()));
                    program.warnings.iter().for_each(|warning| push_new(&mut remarks, warning.clone()));
                    of_robots.push(program);
                }
                Err(error) => push_new(&mut mistakes, format!("program `{}`: {error}", robot.program_name())),
            }
        }
        fail_with(&mistakes)?;
        Ok(Self { of_robots, remarks })
    }

    /// Maps a private copy of its program for each robot, with the arguments that its `main` gets.
    ///
    /// # Errors
    /// The first program that cannot be loaded, or all of them if the kernel has no room.
    pub fn load(
        &self,
        scene: &SceneSpec,
        arguments: &BTreeMap<RobotId, Vec<String>>,
    ) -> anyhow::Result<Vec<LoadedProgram>> {
        check_mappings(self.of_robots.iter().map(|program| (&program.image, 1)), MAPPINGS_PER_FLOW)?;
        let mut loader = Loader::new().context("no folder to load programs from")?;
        let mut load = |(robot, program): (&sim_core::format::RobotSpec, &Arc<Prepared>)| {
            let words = arguments.get(&robot.id).map_or(&[][..], Vec::as_slice);
            let named = |error: LoadError| anyhow!("{} (`{}`): {error}", robot.id, robot.program_name());
            loader.load(program, words).map_err(named)
        };
        scene.robots.iter().zip(&self.of_robots).map(&mut load).collect()
    }
}

fn push_new(list: &mut Vec<String>, text: String) {
    if !list.contains(&text) {
        list.push(text);
    }
}

fn fail_with(mistakes: &[String]) -> anyhow::Result<()> {
    if mistakes.is_empty() { Ok(()) } else { Err(anyhow!("{}", mistakes.join("\n"))) }
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
pub fn build_world(
    scene: &SceneSpec,
    programs: &Programs,
    options: &RobotOptions<'_>,
) -> anyhow::Result<(World, Vec<Robot>)> {
    debug_assert!(scene.robots.iter().enumerate().all(|(index, robot)| robot.id.index() == index));
    let walls = build::walls(&scene.world);
    let mut models = BTreeMap::new();
    let mut robots = Vec::with_capacity(scene.robots.len());
    for (spec, program) in scene.robots.iter().zip(&programs.of_robots) {
        let model = models.entry(&spec.robi.file).or_insert_with(|| Arc::new(build::model(&spec.robi)));
        model.check().with_context(|| format!("robot type `{}`", spec.robi.file))?;
        let presses = options.keys.iter().filter(|press| press.robot.is_none_or(|robot| robot == spec.id));
        let mut robot = Robot::new(RobotParts {
            program: program.name.clone(),
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
