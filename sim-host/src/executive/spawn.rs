//! Creation of a run's robots, at its start and during the run.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use sim_core::noise::RadioNoise;
use sim_core::simulation::{FactoryError, Placeable, RobotFactory, Roster};
use sim_core::spec::{ObjectSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_format::builtin;

use super::load::{ProgramLoadError, load_program};
use super::process::Child;
use super::program::{Exec, RobotProgram};
use crate::program::find::ProgramSource;
use crate::program::load::Loader;
use crate::program::prepare::Prepared;
use crate::program::sandbox::{Level, Sandbox};
use crate::program::scene::Programs;
use crate::record::frame::Frames;
use crate::robios::Robios;
use crate::robios::camera::CameraOutput;
use crate::robios::console::Console;
use crate::robios::ground_truth::EntityNumbers;
use crate::robios::input::{Input, Source};
use crate::robios::key::Press;
use crate::robios::robot::Robot;
use crate::robios::storage::Storage;
use crate::robios::table::Table;
use crate::scenery::{LazyScenery, SpawnedEntity};

/// Options for a run's robots, in addition to the scene.
pub struct RobotOptions {
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Key presses of all robots.
    pub keys: Vec<Press>,
    /// Programs may run commands of this machine (`OSExecute`).
    pub may_execute: bool,
    /// Maximum number of bytes that each program may print.
    pub output_limit: u64,
    /// Standard input of the programs.
    pub stdin: Source,
    /// Records every call.
    pub is_verbose: bool,
    /// Scenery for the cameras.
    pub scenery: Arc<LazyScenery>,
    /// Destination of the images, scans and layers of programs, if the user has requested it.
    pub frames: Option<Arc<Frames>>,
    /// Kind of execution of the programs.
    pub exec: Exec,
    /// Restrictions of programs in processes of their own.
    pub sandbox: Option<Sandbox>,
    /// Number of workers.
    pub workers: usize,
}

/// Creates the robots of a run, and keeps a registry of all robots and objects that were ever in it.
pub struct Spawner {
    scene: Arc<SceneSpec>,
    options: RobotOptions,
    factory: RobotFactory,
    /// All robots and objects that were ever in the run, and the types that can be added.
    roster: Roster,
    /// The programs of the robots, in the order of their ids.
    programs: Vec<Option<Arc<Prepared>>>,
    entity_numbers: Arc<EntityNumbers>,
    /// Tables of devices, keyed by the files of the robot types; robots of one type share a table.
    tables: BTreeMap<String, Arc<Table>>,
    /// Loader of the programs of spawned robots; created for the first spawned robot.
    loader: Option<Loader>,
}

/// A robot that is ready to be added to the run.
pub struct NewRobot {
    /// Specification of the robot.
    pub spec: RobotSpec,
    /// The robot itself.
    pub robot: Robot,
    /// Noise model of its radio messages.
    pub radio_noise: RadioNoise,
    /// Its loaded program, and the prepared program that was copied; `None` for a robot without a program.
    pub program: Option<(RobotProgram, Arc<Prepared>)>,
}

/// Reasons why a robot cannot be added to a run.
#[derive(Debug, thiserror::Error)]
pub enum SpawnError {
    /// The robot whose program is to be used has no program.
    #[error("robot {} has no program", .0.0)]
    NoProgram(RobotId),
    /// Its type has values that cannot be simulated.
    #[error(transparent)]
    Robot(#[from] FactoryError),
    /// Its program cannot be loaded.
    #[error(transparent)]
    Program(#[from] ProgramLoadError),
}

impl Spawner {
    /// Creates the spawner for a run of `scene` with these programs.
    pub fn new(scene: Arc<SceneSpec>, programs: &Programs, options: RobotOptions) -> Self {
        debug_assert!(scene.robots.iter().enumerate().all(|(index, robot)| robot.id.index() == index));
        Self {
            factory: RobotFactory::new(&scene, options.seed, options.slot, options.is_verbose),
            roster: roster_of(&scene),
            programs: programs.of_robots.clone(),
            entity_numbers: Arc::new(EntityNumbers::of(&scene)),
            scene,
            options,
            tables: BTreeMap::new(),
            loader: None,
        }
    }

    /// Factory of robots without programs.
    pub fn factory(&self) -> &RobotFactory {
        &self.factory
    }

    /// All robots and objects that were ever in the run, and the types that can be added: the types of the scene, then
    /// the built-in ones.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// Creates the world at time 0 and its robots.
    ///
    /// # Errors
    /// [`FactoryError`] for a robot type whose values cannot be simulated.
    pub fn start(&mut self) -> Result<(World, Vec<Robot>), FactoryError> {
        let scene = Arc::clone(&self.scene);
        let programs = self.programs.clone();
        let robots =
            scene.robots.iter().zip(&programs).map(|(spec, program)| self.create(spec, program.as_ref(), Time::ZERO));
        let (mut robots, radio_noise): (Vec<Robot>, Vec<RadioNoise>) =
            robots.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let world = self.factory.world(&scene, robots.iter_mut().map(|robot| &mut robot.state), radio_noise)?;
        Ok((world, robots))
    }

    /// Creates a robot from `spec`, spawned at the time `since`, with the program of the robot `program_of`.
    ///
    /// # Errors
    /// The program cannot be loaded, or the robot `program_of` has none.
    pub fn robot(&mut self, spec: RobotSpec, program_of: Option<RobotId>, since: Time) -> Result<NewRobot, SpawnError> {
        let prepared = program_of.and_then(|id| self.programs[id.index()].clone());
        if let (Some(id), None) = (program_of, &prepared) {
            return Err(SpawnError::NoProgram(id));
        }
        let (robot, radio_noise) = self.create(&spec, prepared.as_ref(), since)?;
        let program = prepared.map(|prepared| Ok::<_, SpawnError>((self.load(&spec, &prepared)?, prepared)));
        Ok(NewRobot { spec, robot, radio_noise, program: program.transpose()? })
    }

    /// Loads the program of a spawned robot.
    fn load(&mut self, spec: &RobotSpec, prepared: &Arc<Prepared>) -> Result<RobotProgram, ProgramLoadError> {
        Child::make_room(self.programs.len() + 1);
        let loader = match &mut self.loader {
            Some(loader) => loader,
            None => self.loader.insert(Loader::new().map_err(ProgramLoadError::Folder)?),
        };
        loader.set_sandbox(self.options.sandbox.clone());
        load_program(spec, prepared, (self.options.exec, self.options.workers), loader)
    }

    /// Registers a robot that was added to the run.
    pub fn register_robot(&mut self, spec: RobotSpec, program: Option<Arc<Prepared>>) {
        self.entity_numbers.spawned.push(Placeable::Robot(spec.id));
        self.options.scenery.add(SpawnedEntity::Robot(spec.id, Arc::clone(&spec.robi)));
        self.roster.keep_robot(spec);
        self.programs.push(program);
    }

    /// Registers a movable object that was added to the run.
    pub fn register_object(&mut self, id: ObjectId, spec: ObjectSpec) {
        self.entity_numbers.spawned.push(Placeable::Object(id));
        self.options.scenery.add(SpawnedEntity::Object(id, Arc::clone(&spec.kind)));
        self.roster.keep_object(spec);
    }

    /// Creates a robot that exists from the time `since`, and the noise model of its radio messages.
    fn create(
        &mut self,
        spec: &RobotSpec,
        program: Option<&Arc<Prepared>>,
        since: Time,
    ) -> Result<(Robot, RadioNoise), FactoryError> {
        let (mut state, radio_noise) = self.factory.robot(spec, since)?;
        let is_for_robot = |press: &&Press| press.robot.is_none_or(|robot| robot == spec.id) && press.at >= since;
        let presses = self.options.keys.iter().filter(is_for_robot);
        presses.for_each(|press| state.devices.press(press.at, press.touch));
        if self.scene.checks.iter().any(|check| check.kind.counts_calls_of(spec.id)) {
            state.journal.set_verbose(true);
        }
        let generation = program.and_then(|program| program.generation());
        let new_robios = if generation == Some(7) { Robios::of_robios7 } else { Robios::new };
        let mut robios = new_robios(&spec.robi).with_entity_numbers(Arc::clone(&self.entity_numbers));
        robios.table = Arc::clone(self.tables.entry(spec.robi.file.clone()).or_insert(robios.table));
        let folder = Path::new(&self.scene.folder);
        let is_confined = self.options.sandbox.as_ref().is_some_and(|sandbox| sandbox.level() == Level::Full);
        robios.storage = match is_confined {
            true => Storage::confined(folder, program.and_then(|program| program.own_folder())),
            false => Storage::new(folder),
        };
        robios.dialect = self.scene.run.dialect.unwrap_or_default();
        robios.is_rust = program.is_some_and(|program| matches!(program.source, ProgramSource::Cargo(_)));
        robios.os.may_execute = self.options.may_execute;
        robios.console = Console::new(self.options.output_limit);
        robios.input = Input::new(self.options.stdin.clone());
        let (scenery, frames) = (Arc::clone(&self.options.scenery), self.options.frames.clone());
        robios.camera_output = CameraOutput { scenery, frames };
        let name = program.map(|program| program.name.clone()).unwrap_or_default();
        let mut robot = Robot::new(state, robios, name);
        robot.record_start();
        Ok((robot, radio_noise))
    }
}

/// The roster of `scene`, extended by the built-in types.
pub fn roster_of(scene: &SceneSpec) -> Roster {
    let mut roster = Roster::of(scene);
    for name in builtin::ROBOTS {
        if let Some(robi) = builtin::robot(name) {
            roster.robot_types.add(name, name, || robi);
        }
    }
    for name in builtin::OBJECTS {
        if let Some(kind) = builtin::object(name) {
            roster.object_types.add(name, name, || kind);
        }
    }
    roster
}
