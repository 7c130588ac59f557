//! What the robots and movable objects of a run are made of: at its start, and those that come later.

mod types;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::build;
use sim_core::noise::Radio;
use sim_core::pose::Pose;
use sim_core::spec::{ObjectSpec, ObjectType, RobiSpec, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use crate::executive::process::Child;
use crate::executive::program::{Exec, RobotProgram};
use crate::program::load::Loader;
use crate::program::prepare::Prepared;
use crate::record::frame::Frames;
use crate::robios::Robios;
use crate::robios::camera::Imaging;
use crate::robios::irtv::Remote;
use crate::robios::key::{Keys, Press};
use crate::robios::robot::Robot;
use crate::robios::storage::Storage;
use crate::robios::truth::Census;
use crate::scenery::{LazyScenery, Newcomer};
use crate::setup::{self, Programs, RobotOptions};
use sim_core::simulation::{Placeable, RobotFactory};
pub use types::Types;

/// Most robots that may come into a run after its start, those that have left again included: each keeps its number, its record
/// and, in this process, its program as long as the run. Our choice.
pub const MOST_ROBOTS: usize = 1_000;

/// The same of movable objects.
pub const MOST_OBJECTS: usize = 10_000;

/// Who is in a run, and what more of them are made of.
pub struct Workshop {
    scene: Arc<SceneSpec>,
    /// Everybody who ever was in the run, in the order of their ids.
    robots: Vec<RobotSpec>,
    objects: Vec<ObjectSpec>,
    /// Their programs, in the same order as the robots.
    programs: Vec<Option<Arc<Prepared>>>,
    types: Types,
    maker: Maker,
    exec: Exec,
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

impl Workshop {
    /// That of a run of `scene` with these programs, which run as `exec` says.
    pub fn new(scene: Arc<SceneSpec>, programs: &Programs, exec: Exec, options: &RobotOptions<'_>) -> Self {
        let movable: Vec<ObjectSpec> = build::movable(&scene).cloned().collect();
        Self {
            robots: scene.robots.clone(),
            objects: movable,
            programs: programs.of_robots.clone(),
            types: Types::of(&scene),
            maker: Maker::new(&scene, options),
            scene,
            exec,
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
    pub fn build_world(&mut self) -> anyhow::Result<(World, Vec<Robot>)> {
        let Self { scene, programs, maker, .. } = self;
        maker.world(scene, programs)
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
        let (robot, heard) = self.maker.robot(&spec, prepared.as_ref(), since)?;
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
        setup::load_program(spec, prepared, self.exec, loader)
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
        self.maker.census.newcomers.push(Placeable::Robot(spec.id));
        self.maker.scenery.add(Newcomer::Robot(spec.id, Arc::clone(&spec.robi)));
        self.robots.push(spec);
        self.programs.push(program);
    }

    /// A movable object has come into the run.
    pub fn keep_object(&mut self, id: ObjectId, spec: ObjectSpec) {
        self.maker.census.newcomers.push(Placeable::Object(id));
        self.maker.scenery.add(Newcomer::Object(id, Arc::clone(&spec.kind)));
        self.objects.push(spec);
    }
}

/// Makes the robots of a run.
pub(crate) struct Maker {
    folder: PathBuf,
    robots: RobotFactory,
    keys: Vec<Press>,
    may_execute: bool,
    scenery: Arc<LazyScenery>,
    frames: Option<Arc<Frames>>,
    census: Arc<Census>,
}

impl Maker {
    pub fn new(scene: &SceneSpec, options: &RobotOptions<'_>) -> Self {
        Self {
            folder: Path::new(&scene.folder).to_owned(),
            robots: RobotFactory::new(scene, options.seed, options.slot, options.is_verbose),
            keys: options.keys.to_vec(),
            may_execute: options.may_execute,
            scenery: Arc::clone(&options.scenery),
            frames: options.frames.clone(),
            census: Arc::new(setup::census(scene)),
        }
    }

    /// The world at time 0 and its robots.
    pub fn world(
        &mut self,
        scene: &SceneSpec,
        programs: &[Option<Arc<Prepared>>],
    ) -> anyhow::Result<(World, Vec<Robot>)> {
        debug_assert!(scene.robots.iter().enumerate().all(|(index, robot)| robot.id.index() == index));
        let mut robots = Vec::with_capacity(scene.robots.len());
        let mut heard = Vec::with_capacity(scene.robots.len());
        for (spec, program) in scene.robots.iter().zip(programs) {
            let (robot, radio) = self.robot(spec, program.as_ref(), Time::ZERO)?;
            robots.push(robot);
            heard.push(radio);
        }
        let world = self.robots.world(scene, robots.iter_mut().map(|robot| &mut robot.state), heard);
        Ok((world, robots))
    }

    /// A robot that comes at `since`, and what happens to its messages.
    fn robot(
        &mut self,
        spec: &RobotSpec,
        program: Option<&Arc<Prepared>>,
        since: Time,
    ) -> anyhow::Result<(Robot, Radio)> {
        let (state, heard) = self.robots.robot(spec, since)?;
        let is_meant = |press: &&Press| press.robot.is_none_or(|robot| robot == spec.id) && press.at >= since;
        let presses = self.keys.iter().filter(is_meant);
        let generation = program.and_then(|program| program.generation());
        let new_robios = if generation == Some(7) { Robios::of_robios7 } else { Robios::new };
        let (remote, keys): (Vec<&Press>, Vec<_>) = presses.partition(|press| press.touch.remote_key().is_some());
        let keys = Keys::scripted(keys.iter().map(|press| (press.at, press.touch)));
        let mut robios = new_robios(&spec.robi, keys).among(Arc::clone(&self.census));
        robios.remote = Remote::scripted(remote.iter().filter_map(|press| Some((press.at, press.touch.remote_key()?))));
        robios.storage = Storage::new(&self.folder);
        robios.os.may_execute = self.may_execute;
        robios.imaging = Imaging { scenery: Arc::clone(&self.scenery), frames: self.frames.clone() };
        let name = program.map(|program| program.name.clone()).unwrap_or_default();
        let mut robot = Robot::new(state, robios, name);
        robot.record_start();
        Ok((robot, heard))
    }
}
