//! What the robots and movable objects of a run are made of: at its start, and those that come later.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::noise::Radio;
use sim_core::spec::{ObjectSpec, RobotSpec, SceneSpec};
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
use crate::robios::key::Press;
use crate::robios::robot::Robot;
use crate::robios::storage::Storage;
use crate::robios::truth::Census;
use crate::scenery::{LazyScenery, Newcomer};
use crate::setup::{self, Programs, RobotOptions};
use sim_core::simulation::{Placeable, RobotFactory, Roster};
use sim_format::builtin;

/// Who is in a run, and what more of them are made of.
pub struct Workshop {
    scene: Arc<SceneSpec>,
    /// Everybody who ever was in the run, and the types of which more can be added.
    roster: Roster,
    /// The programs of the robots, in the order of their ids.
    programs: Vec<Option<Arc<Prepared>>>,
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
        Self {
            roster: roster_of(&scene),
            programs: programs.of_robots.clone(),
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

    /// Makes robots without programs.
    pub fn factory(&self) -> &RobotFactory {
        &self.maker.robots
    }

    /// Everybody who ever was in the run, and the types of the scene, then those that are built in.
    pub fn roster(&self) -> &Roster {
        &self.roster
    }

    /// The world at time 0 and its robots.
    ///
    /// # Errors
    /// A robot type with which nothing can be computed.
    pub fn build_world(&mut self) -> anyhow::Result<(World, Vec<Robot>)> {
        let Self { scene, programs, maker, .. } = self;
        maker.world(scene, programs)
    }

    /// The robot of `spec`, which comes at `since`; its program is that of the robot `program_of`.
    ///
    /// # Errors
    /// In words: a program that cannot be loaded, or a robot that has none.
    pub fn robot(&mut self, spec: RobotSpec, program_of: Option<RobotId>, since: Time) -> anyhow::Result<NewRobot> {
        let prepared = program_of.and_then(|id| self.programs[id.index()].clone());
        if let (Some(id), None) = (program_of, &prepared) {
            return Err(anyhow!("robot {} has no program", id.0));
        }
        let (robot, heard) = self.maker.robot(&spec, prepared.as_ref(), since)?;
        let program = prepared.map(|prepared| Ok::<_, anyhow::Error>((self.load(&spec, &prepared)?, prepared)));
        Ok(NewRobot { spec, robot, heard, program: program.transpose()? })
    }

    /// Loads a program for one more robot.
    fn load(&mut self, spec: &RobotSpec, prepared: &Arc<Prepared>) -> anyhow::Result<RobotProgram> {
        Child::make_room(self.programs.len() + 1);
        let loader = match &mut self.loader {
            Some(loader) => loader,
            None => self.loader.insert(Loader::new().context("no folder to load programs from")?),
        };
        setup::load_program(spec, prepared, self.exec, loader)
    }

    /// A robot has come into the run.
    pub fn keep_robot(&mut self, spec: RobotSpec, program: Option<Arc<Prepared>>) {
        self.maker.census.newcomers.push(Placeable::Robot(spec.id));
        self.maker.scenery.add(Newcomer::Robot(spec.id, Arc::clone(&spec.robi)));
        self.roster.keep_robot(spec);
        self.programs.push(program);
    }

    /// A movable object has come into the run.
    pub fn keep_object(&mut self, id: ObjectId, spec: ObjectSpec) {
        self.maker.census.newcomers.push(Placeable::Object(id));
        self.maker.scenery.add(Newcomer::Object(id, Arc::clone(&spec.kind)));
        self.roster.keep_object(spec);
    }
}

/// The roster of `scene`, to whose types those are added that are built in.
pub fn roster_of(scene: &SceneSpec) -> Roster {
    let mut roster = Roster::of(scene);
    for name in builtin::ROBOTS {
        if let Some(robi) = builtin::robot(name) {
            roster.robot_types.add(name, name, || Arc::new(robi));
        }
    }
    for name in builtin::OBJECTS {
        if let Some(kind) = builtin::object(name) {
            roster.object_types.add(name, name, || Arc::new(kind));
        }
    }
    roster
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
        let (mut state, heard) = self.robots.robot(spec, since)?;
        let is_meant = |press: &&Press| press.robot.is_none_or(|robot| robot == spec.id) && press.at >= since;
        let presses = self.keys.iter().filter(is_meant);
        let generation = program.and_then(|program| program.generation());
        let new_robios = if generation == Some(7) { Robios::of_robios7 } else { Robios::new };
        presses.for_each(|press| state.devices.press(press.at, press.touch));
        let mut robios = new_robios(&spec.robi).among(Arc::clone(&self.census));
        robios.storage = Storage::new(&self.folder);
        robios.os.may_execute = self.may_execute;
        robios.imaging = Imaging { scenery: Arc::clone(&self.scenery), frames: self.frames.clone() };
        let name = program.map(|program| program.name.clone()).unwrap_or_default();
        let mut robot = Robot::new(state, robios, name);
        robot.record_start();
        Ok((robot, heard))
    }
}
