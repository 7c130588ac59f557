//! Makes the robots and movable objects of a run: those of its start, and those that come later.

mod types;

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::build;
use sim_core::noise::{Profile, Radio};
use sim_core::pose::Pose;
use sim_core::simulation::{FactoryError, Placeable, RobotFactory};
use sim_core::spec::{ObjectSpec, ObjectType, RobiSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use super::load;
use super::process::Child;
use super::program::{Exec, RobotProgram};
use crate::program::load::Loader;
use crate::program::prepare::Prepared;
use crate::program::scene::Programs;
use crate::record::frame::Frames;
use crate::robios::Robios;
use crate::robios::console::Console;
use crate::robios::irtv::Remote;
use crate::robios::key::{Keys, Press};
use crate::robios::robot::Robot;
use crate::robios::storage::Storage;
use crate::robios::truth::Census;
use crate::scenery::{LazyScenery, Newcomer};
pub use types::Types;

/// Most robots that may come into a run after its start, those that have left again included: each keeps its number, its record
/// and, in this process, its program as long as the run. Our choice.
pub const MOST_ROBOTS: usize = 1_000;

/// The same of movable objects.
pub const MOST_OBJECTS: usize = 10_000;

/// What a run's robots are made with, besides the scene.
pub struct RobotOptions {
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Key presses of all robots.
    pub keys: Vec<Press>,
    /// True when programs may run commands of this machine (`OSExecute`).
    pub may_execute: bool,
    /// Bytes that each program may print.
    pub output_limit: u64,
    /// True when every call is to be recorded.
    pub is_verbose: bool,
    /// What cameras see.
    pub scenery: Arc<LazyScenery>,
    /// Where the images go that programs take, if the user wants them.
    pub frames: Option<Arc<Frames>>,
    /// Where the programs run.
    pub exec: Exec,
}

/// Makes the robots and movable objects of a run, and knows all that ever were in it.
pub struct Spawner {
    scene: Arc<SceneSpec>,
    options: RobotOptions,
    factory: RobotFactory,
    /// All robots that ever were in the run, in the order of their ids.
    robots: Vec<RobotSpec>,
    objects: Vec<ObjectSpec>,
    /// Their programs, in the same order as the robots.
    programs: Vec<Option<Arc<Prepared>>>,
    types: Types,
    census: Arc<Census>,
    /// What loads the programs of those who come later; none before the first of them.
    loader: Option<Loader>,
}

/// A robot that is about to come into the run.
pub struct NewRobot {
    /// What it is.
    pub spec: RobotSpec,
    /// It itself.
    pub robot: Robot,
    /// What happens to its messages.
    pub heard: Radio,
    /// Its program, loaded, and what that is a copy of; none for a robot that only stands there.
    pub program: Option<(RobotProgram, Arc<Prepared>)>,
}

impl Spawner {
    /// That of a run of `scene` with these programs.
    pub fn new(scene: Arc<SceneSpec>, programs: &Programs, options: RobotOptions) -> Self {
        debug_assert!(scene.robots.iter().enumerate().all(|(index, robot)| robot.id.index() == index));
        Self {
            factory: RobotFactory::new(&scene, options.seed, options.slot, options.is_verbose),
            robots: scene.robots.clone(),
            objects: build::movable(&scene).cloned().collect(),
            programs: programs.of_robots.clone(),
            types: Types::of(&scene),
            census: Arc::new(Census::of(&scene)),
            scene,
            options,
            loader: None,
        }
    }

    /// The scene as its files say it.
    pub fn scene(&self) -> &Arc<SceneSpec> {
        &self.scene
    }

    /// All robots that ever were in the run, in the order of their ids, as they came.
    pub fn robots(&self) -> &[RobotSpec] {
        &self.robots
    }

    /// All movable objects that ever were in the run, in the order of their ids, as they came.
    pub fn objects(&self) -> &[ObjectSpec] {
        &self.objects
    }

    /// What can be added.
    pub fn types(&self) -> &Types {
        &self.types
    }

    /// The world at time 0 and its robots.
    ///
    /// # Errors
    /// A robot type with which nothing can be computed.
    pub fn start(&mut self) -> Result<(World, Vec<Robot>), FactoryError> {
        let scene = Arc::clone(&self.scene);
        let programs = self.programs.clone();
        let made =
            scene.robots.iter().zip(&programs).map(|(spec, program)| self.make(spec, program.as_ref(), Time::ZERO));
        let (mut robots, heard): (Vec<Robot>, Vec<Radio>) = made.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let world = self.factory.world(&scene, robots.iter_mut().map(|robot| &mut robot.state), heard)?;
        Ok((world, robots))
    }

    /// The robot that has the next id, of type `robi`, at `start` from `since` on; its program is that of the robot `program_of`.
    /// Errors of devices and drive are those of that robot, else of the first one of its type, else of the scene.
    ///
    /// # Errors
    /// In words: a program that cannot be loaded, a robot that has none, or more robots than may come.
    pub fn robot(
        &mut self,
        robi: Arc<RobiSpec>,
        program_of: Option<RobotId>,
        start: Pose,
        since: Time,
    ) -> anyhow::Result<NewRobot> {
        self.check_room(self.robots.len() - self.scene.robots.len(), MOST_ROBOTS, "robots")?;
        let model = program_of.map(|id| &self.robots[id.index()]);
        let of_type = || self.robots.iter().find(|robot| Arc::ptr_eq(&robot.robi, &robi));
        let noise = model.or_else(of_type).map_or(&self.scene.run.noise, |robot| &robot.noise).clone();
        let prepared = program_of.and_then(|id| self.programs[id.index()].clone());
        if let (Some(id), None) = (program_of, &prepared) {
            return Err(anyhow!("robot {} has no program", id.0));
        }
        let spec = RobotSpec {
            id: RobotId::from_index(self.robots.len()),
            robi,
            start,
            program: model.and_then(|robot| robot.program.clone()),
            arguments: model.map(|robot| robot.arguments.clone()).unwrap_or_default(),
            api: model.and_then(|robot| robot.api),
            noise,
            dialect: model.and_then(|robot| robot.dialect),
            span: Default::default(),
        };
        let (robot, heard) = self.make(&spec, prepared.as_ref(), since)?;
        let program = prepared.map(|prepared| Ok::<_, anyhow::Error>((self.load(&spec, &prepared)?, prepared)));
        Ok(NewRobot { spec, robot, heard, program: program.transpose()? })
    }

    /// Loads a program for one more robot.
    fn load(&mut self, spec: &RobotSpec, prepared: &Arc<Prepared>) -> anyhow::Result<RobotProgram> {
        Child::make_room(self.robots.len() + 1);
        let loader = match &mut self.loader {
            Some(loader) => loader,
            None => self.loader.insert(Loader::new().context("no folder to load programs from")?),
        };
        load::load_program(spec, prepared, self.options.exec, loader)
    }

    /// The movable object that has the next id, of type `kind`, at `pose`.
    ///
    /// # Errors
    /// In words: more objects than may come.
    pub fn object(&self, kind: Arc<ObjectType>, pose: Pose) -> anyhow::Result<ObjectSpec> {
        self.check_room(self.objects.len() - build::movable(&self.scene).count(), MOST_OBJECTS, "movable objects")?;
        let friction = kind.friction;
        Ok(ObjectSpec { kind, pose, friction, span: Default::default() })
    }

    fn check_room(&self, added: usize, most: usize, what: &str) -> anyhow::Result<()> {
        if added < most {
            Ok(())
        } else {
            Err(anyhow!("{most} {what} have been added to this run, and no more may be"))
        }
    }

    /// A robot has come into the run.
    pub fn keep_robot(&mut self, spec: RobotSpec, program: Option<Arc<Prepared>>) {
        self.census.newcomers.push(Placeable::Robot(spec.id));
        self.options.scenery.add(Newcomer::Robot(spec.id, Arc::clone(&spec.robi)));
        self.robots.push(spec);
        self.programs.push(program);
    }

    /// A movable object has come into the run.
    pub fn keep_object(&mut self, id: ObjectId, spec: ObjectSpec) {
        self.census.newcomers.push(Placeable::Object(id));
        self.options.scenery.add(Newcomer::Object(id, Arc::clone(&spec.kind)));
        self.objects.push(spec);
    }

    /// A robot that comes at `since`, and what happens to its messages.
    fn make(
        &mut self,
        spec: &RobotSpec,
        program: Option<&Arc<Prepared>>,
        since: Time,
    ) -> Result<(Robot, Radio), FactoryError> {
        let (state, heard) = self.factory.robot(spec, since)?;
        let is_meant = |press: &&Press| press.robot.is_none_or(|robot| robot == spec.id) && press.at >= since;
        let presses = self.options.keys.iter().filter(is_meant);
        let generation = program.and_then(|program| program.generation());
        let new_robios = if generation == Some(7) { Robios::of_robios7 } else { Robios::new };
        let (remote, keys): (Vec<&Press>, Vec<_>) = presses.partition(|press| press.touch.remote_key().is_some());
        let keys = Keys::scripted(keys.iter().map(|press| (press.at, press.touch)));
        let mut robios = new_robios(&spec.robi, keys).among(Arc::clone(&self.census));
        robios.remote = Remote::scripted(remote.iter().filter_map(|press| Some((press.at, press.touch.remote_key()?))));
        robios.storage = Storage::new(Path::new(&self.scene.folder));
        robios.os.may_execute = self.options.may_execute;
        robios.console = Console::new(self.options.output_limit);
        robios.camera = robios.camera.in_run(Arc::clone(&self.options.scenery), self.options.frames.clone());
        if state.noise().camera != Profile::default().camera {
            robios.camera.set_errors(state.noise(), state.seed(), state.id);
        }
        let name = program.map(|program| program.name.clone()).unwrap_or_default();
        let mut robot = Robot::new(state, robios, name);
        robot.record_start();
        Ok((robot, heard))
    }
}
