//! From a scene to a run that can start: finds, builds and loads the programs, makes world and robots.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::build;
use sim_core::drive::Motion;
use sim_core::format::{NoiseRef, ObjectSpec, PathRef, RobotSpec, SceneSpec, Span};
use sim_core::noise::Profile;
use sim_core::radio::Channel;
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use crate::executive::process::serve::{Refusal, RemoteProgram};
use crate::executive::process::{Child, Debugger};
use crate::executive::program::{Exec, RobotProgram};
use crate::program::build::Builder;
use crate::program::find::{Found, SearchPath, find_program};
use crate::program::generation::{Generation, Wanted};
use crate::program::load::{LoadError, Loader, OpenError, check_mappings};
use crate::program::prepare::{Code, Prepared, prepare};
use crate::record::frame::Frames;
use crate::robios::Devices;
use crate::robios::irtv::Remote;
use crate::robios::key::{Keys, Press};
use crate::robios::robot::{Robot, RobotParts};
use crate::robios::storage::Storage;
use crate::robios::truth::{Census, Counted};
use crate::scenery::LazyScenery;

/// What the scene says of the generation that a robot's program is written for.
pub fn wanted_of(robot: &RobotSpec) -> Wanted {
    let generation = |number: Option<u32>| number.and_then(Generation::of_number);
    Wanted { api: generation(robot.api), dialect: generation(robot.dialect) }
}

/// Memory mappings of a robot's flow: its stack, the guard below it, its alternate stack and the kernel's neighbours.
const MAPPINGS_PER_FLOW: usize = 4;

/// The programs of a scene, built.
pub struct Programs {
    /// In the order of the robots; robots with one program share it, a robot that only stands there has none.
    pub of_robots: Vec<Option<Arc<Prepared>>>,
    /// What the user should know: how they were found, what the compiler said, what is outside the guarantee.
    pub remarks: Vec<String>,
}

impl Programs {
    /// Finds and builds the programs of all robots, each once; `builder` tells its observer what it compiles.
    ///
    /// # Errors
    /// All programs that cannot be found or built, in one message with the lines of the sim file.
    pub fn build(scene: &SceneSpec, search: &SearchPath, builder: &Builder) -> anyhow::Result<Self> {
        // A program that is named on the command line is looked for from where the user stands.
        let search_from_here = SearchPath { sim_folder: None, ..search.clone() };
        let mut found: Vec<Option<Found>> = Vec::with_capacity(scene.robots.len());
        let mut mistakes = Vec::new();
        for robot in &scene.robots {
            let find = |program: &PathRef| {
                let search = if is_of_command_line(program) { &search_from_here } else { search };
                find_program(&program.text, search)
            };
            found.push(robot.program.as_ref().and_then(|program| match find(program) {
                Ok(found) => Some(found.wanted(wanted_of(robot))),
                Err(error) => {
                    push_new(&mut mistakes, format!("{}: {error}", place_of(scene, program)));
                    None
                }
            }));
        }
        fail_with(&mistakes)?;

        let mut prepared = prepare(builder, &found.iter().flatten().cloned().collect::<Vec<_>>()).into_iter();
        let mut of_robots = Vec::with_capacity(found.len());
        let mut remarks = Vec::new();
        for (robot, found) in scene.robots.iter().zip(&found) {
            let Some((found, prepared)) = found.as_ref().and_then(|found| Some((found, prepared.next()?))) else {
                of_robots.push(None);
                continue;
            };
            found.notes.iter().for_each(|note| push_new(&mut remarks, note.clone()));
            match prepared {
                Ok(program) => {
                    let generation = program.generation_remark().filter(|_| program.compiled);
                    generation.into_iter().for_each(|remark| push_new(&mut remarks, remark));
                    let output = Some(program.output.trim_end()).filter(|output| !output.is_empty());
                    output.iter().for_each(|output| push_new(&mut remarks, (*output).to_owned()));
                    program.warnings.iter().for_each(|warning| push_new(&mut remarks, warning.clone()));
                    of_robots.push(Some(program));
                }
                Err(error) => push_new(&mut mistakes, format!("program `{}`: {error}", robot.program_name())),
            }
        }
        fail_with(&mistakes)?;
        Ok(Self { of_robots, remarks })
    }

    /// The programs, each once for each robot that runs it.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Prepared>> {
        self.of_robots.iter().flatten()
    }

    /// Loads its program for each robot that has one, with the arguments that its `main` gets: as a private copy in this process, or
    /// in a process of its own.
    ///
    /// # Errors
    /// The first program that cannot be loaded, or all of them if the kernel has no room.
    pub fn load(
        &self,
        scene: &SceneSpec,
        exec: Exec,
        debug: Option<&Debug>,
    ) -> anyhow::Result<Vec<Option<RobotProgram>>> {
        let in_host = self.iter().filter(|program| exec_of(program, exec) == Exec::Thread);
        let copies = in_host.filter_map(|program| Some((&**program.image()?, 1)));
        check_mappings(copies, MAPPINGS_PER_FLOW)?;
        let mut loader = Loader::new().context("no folder to load programs from")?;
        let named = |robot: &RobotSpec, error: LoadError| anyhow!("{} (`{}`): {error}", robot.id, robot.program_name());
        Child::make_room(self.iter().filter(|program| exec_of(program, exec) == Exec::Process).count());
        // All processes start before the first one is waited for.
        let mut loading = Vec::with_capacity(scene.robots.len());
        for (robot, program) in scene.robots.iter().zip(&self.of_robots) {
            let debugger = debug.filter(|debug| debug.robot == robot.id).map(|debug| &debug.debugger);
            let begun = program.as_ref().map(|program| match exec_of(program, exec) {
                Exec::Thread if debugger.is_none() => {
                    loader.load(program, &robot.arguments).map(RobotProgram::Thread).map(Loading::Done)
                }
                _ => Loading::begin(robot, program, &mut loader, debugger),
            });
            loading.push(begun.transpose().map_err(|error| named(robot, error))?);
        }
        let finish = |(robot, loading): (&RobotSpec, Option<Loading>)| {
            loading.map(|loading| loading.finish(robot).map_err(|error| named(robot, error))).transpose()
        };
        scene.robots.iter().zip(loading).map(finish).collect()
    }
}

/// A robot whose program runs under a debugger.
#[derive(Clone, Debug)]
pub struct Debug {
    /// The robot.
    pub robot: RobotId,
    /// What the debugger is told.
    pub debugger: Debugger,
}

/// Where a program runs when the user wants `exec`: a Python program has a process of its own in any case.
fn exec_of(program: &Prepared, exec: Exec) -> Exec {
    match program.code {
        Code::Library(_) => exec,
        Code::Python(_) => Exec::Process,
    }
}

/// A program on its way.
enum Loading {
    Done(RobotProgram),
    /// The process, its program, and the file from which it loads it.
    InProcess(Box<Child>, Arc<Prepared>, PathBuf),
}

impl Loading {
    fn begin(
        robot: &RobotSpec,
        program: &Arc<Prepared>,
        loader: &mut Loader,
        debugger: Option<&Debugger>,
    ) -> Result<Self, LoadError> {
        let path = program.source.path().to_owned();
        let (child, library) = match (&program.code, debugger) {
            (Code::Python(_), Some(_)) => {
                let what = "gdb debugs programs in C, C++ and Rust, and this one is in Python".to_owned();
                return Err(LoadError::Misfit { path, what });
            }
            (Code::Python(python), None) => (Child::start(python.command(&path)), path.clone()),
            // gdb reads the library's file again while it debugs: that of the cache stays.
            (Code::Library(image), Some(debugger)) => {
                (Child::start_debugged(debugger, image.path()), image.path().to_owned())
            }
            (Code::Library(_), None) => {
                let library = loader.library(program, &robot.arguments)?;
                (Child::command(&format!("{} {}", robot.id, program.name), &library).and_then(Child::start), library)
            }
        };
        let child = child.map_err(|error| LoadError::Process { path, what: format!("{error} ({PROCESS_HINT})") })?;
        Ok(Self::InProcess(Box::new(child), Arc::clone(program), library))
    }

    fn finish(self, robot: &RobotSpec) -> Result<RobotProgram, LoadError> {
        let (child, program, library) = match self {
            Self::Done(program) => return Ok(program),
            Self::InProcess(child, program, library) => (child, program, library),
        };
        let path = program.source.path().to_owned();
        RemoteProgram::new(*child, program, &robot.arguments).map(RobotProgram::Process).map_err(
            |refusal| match refusal {
                Refusal::Linker(what) => OpenError::Linker(what).of(&path, &library),
                Refusal::Misfit(what) => OpenError::Misfit(what).of(&path, &library),
                Refusal::Broken(what) => LoadError::Process { path, what },
            },
        )
    }
}

/// What limits the number of processes.
const PROCESS_HINT: &str =
    "each robot takes a process of two threads, and in eyesim a thread and a file: see `ulimit -u` and `ulimit -n`";

/// Names a program of a scene from the command line, where a file has no place.
pub fn program_of_command_line(name: &str) -> PathRef {
    PathRef { text: name.to_owned(), span: Span::default() }
}

fn is_of_command_line(program: &PathRef) -> bool {
    program.span.line == 0
}

/// Where `program` is named: `line.sim:3`, or the command line's option.
fn place_of(scene: &SceneSpec, program: &PathRef) -> String {
    if is_of_command_line(program) { "--program".to_owned() } else { format!("{}:{}", scene.file, program.span.line) }
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
    /// True when programs may run commands of this machine (`OSExecute`).
    pub may_execute: bool,
    /// True when every call is to be recorded.
    pub is_verbose: bool,
    /// What cameras see.
    pub scenery: Arc<LazyScenery>,
    /// Where the images go that programs take, if the user wants them.
    pub frames: Option<Arc<Frames>>,
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
    let walls = build::obstacles(scene);
    let census = Arc::new(census(scene));
    let mut models = BTreeMap::new();
    let mut profiles = Profiles::default();
    let mut robots = Vec::with_capacity(scene.robots.len());
    let mut heard = Vec::with_capacity(scene.robots.len());
    for (spec, program) in scene.robots.iter().zip(&programs.of_robots) {
        let model = models.entry(&spec.robi.file).or_insert_with(|| Arc::new(build::model(&spec.robi)));
        model.check().with_context(|| format!("robot type `{}`", spec.robi.file))?;
        let presses = options.keys.iter().filter(|press| press.robot.is_none_or(|robot| robot == spec.id));
        let generation = program.as_ref().and_then(|program| program.generation());
        let new_devices = if generation == Some(7) { Devices::of_robios7 } else { Devices::new };
        let (remote, keys): (Vec<&Press>, Vec<_>) = presses.partition(|press| press.touch.remote_key().is_some());
        let keys = Keys::scripted(keys.iter().map(|press| (press.at, press.touch)));
        let mut devices = new_devices(&spec.robi, keys).among(Arc::clone(&census));
        devices.remote =
            Remote::scripted(remote.iter().filter_map(|press| Some((press.at, press.touch.remote_key()?))));
        devices.storage = Storage::new(Path::new(&scene.folder));
        devices.os.may_execute = options.may_execute;
        devices.camera = devices.camera.in_run(Arc::clone(&options.scenery), options.frames.clone());
        let motion = Motion::new(spec.id, Arc::clone(model), Arc::clone(&walls), spec.start);
        let profile = profiles.of(spec);
        heard.push(profile.as_ref().map(|profile| profile.radio).unwrap_or_default());
        let mut robot = Robot::new(RobotParts {
            program: program.as_ref().map(|program| program.name.clone()).unwrap_or_default(),
            motion,
            spec: Arc::clone(&spec.robi),
            devices,
            seed: options.seed,
            is_verbose: options.is_verbose,
        });
        if let Some(profile) = profile {
            robot = robot.with_noise(&profile).context("noise of the drive")?;
        }
        robot.record_start();
        robots.push(robot);
    }
    let world = World::new(walls, options.slot, robots.iter_mut().map(|robot| &mut robot.motion));
    let objects = build::movable(scene).map(|object| (build::properties(object), object.pose));
    let radio = Channel::new(scene.radio, options.seed, heard);
    Ok((world.with_objects(objects).with_space(build::space(scene)).with_radio(radio), robots))
}

/// The noise profiles of the robots, each made once.
#[derive(Default)]
struct Profiles<'a> {
    made: Vec<(&'a NoiseRef, Option<Arc<Profile>>)>,
}

impl<'a> Profiles<'a> {
    /// The profile of a robot; `None` where it has no errors.
    fn of(&mut self, robot: &'a RobotSpec) -> Option<Arc<Profile>> {
        let noise = robot.noise.as_ref()?;
        if let Some((_, made)) = self.made.iter().find(|(known, _)| *known == noise) {
            return made.clone();
        }
        let made = noise.profile().map(Arc::new);
        self.made.push((noise, made.clone()));
        made
    }
}

/// The robots and objects of a scene by their numbers for programs.
pub fn census(scene: &SceneSpec) -> Census {
    let mut movable = 0;
    let counted = |object: &ObjectSpec| {
        if object.kind.is_fixed {
            return Counted::Fixed(object.pose);
        }
        movable += 1;
        Counted::Movable(ObjectId(movable))
    };
    let objects = scene.objects.iter().map(counted).collect();
    Census { robots: scene.robots.len(), objects }
}
