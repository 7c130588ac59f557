//! From a scene to a run that can start: finds, builds and loads the programs, makes world and robots.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use sim_core::spec::{ObjectSpec, PathRef, RobotSpec, SceneSpec, Span};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

use crate::executive::damage;
use crate::executive::process::serve::{Refusal, RemoteProgram};
use crate::executive::process::{Child, Debugger};
use crate::executive::program::{Exec, RobotProgram};
use crate::program::build::Builder;
use crate::program::find::{Found, SearchPath, find_program};
use crate::program::generation::{Generation, Wanted};
use crate::program::load::{LoadError, Loader, OpenError, check_mappings};
use crate::program::prepare::{Code, Prepared, prepare};
use crate::record::frame::Frames;
use crate::robios::key::Press;
use crate::robios::robot::Robot;
use crate::robios::truth::{Census, Counted};
use crate::scenery::LazyScenery;
use crate::workshop::Maker;

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
        check_room(self.iter(), exec)?;
        let mut loader = Loader::new().context("no folder to load programs from")?;
        Child::make_room(self.iter().filter(|program| exec_of(program, exec) == Exec::Process).count());
        // All processes start before the first one is waited for.
        let mut loading = Vec::with_capacity(scene.robots.len());
        for (robot, program) in scene.robots.iter().zip(&self.of_robots) {
            let debugger = debug.filter(|debug| debug.robot == robot.id).map(|debug| &debug.debugger);
            let begun = program.as_ref().map(|program| Loading::begin(robot, program, exec, &mut loader, debugger));
            loading.push(begun.transpose().map_err(|error| of_robot(robot, &error))?);
        }
        let finish = |(robot, loading): (&RobotSpec, Option<Loading>)| {
            loading.map(|loading| loading.finish(robot).map_err(|error| of_robot(robot, &error))).transpose()
        };
        scene.robots.iter().zip(loading).map(finish).collect()
    }
}

/// Loads its program for one more robot, as [`Programs::load`] does for those of the scene.
///
/// # Errors
/// Why it cannot be loaded.
pub fn load_program(
    robot: &RobotSpec,
    program: &Arc<Prepared>,
    exec: Exec,
    loader: &mut Loader,
) -> anyhow::Result<RobotProgram> {
    check_room([program], exec)?;
    let loading = Loading::begin(robot, program, exec, loader, None);
    loading.and_then(|loading| loading.finish(robot)).map_err(|error| of_robot(robot, &error))
}

/// Checks that this process can run these programs after what earlier ones have done to it, and that the kernel lets it map their
/// copies and stacks.
fn check_room<'a>(programs: impl IntoIterator<Item = &'a Arc<Prepared>>, exec: Exec) -> anyhow::Result<()> {
    let mut in_host = programs.into_iter().filter(|program| exec_of(program, exec) == Exec::Thread).peekable();
    if in_host.peek().is_some() {
        damage::check()?;
    }
    Ok(check_mappings(in_host.filter_map(|program| Some((&**program.image()?, 1))), MAPPINGS_PER_FLOW)?)
}

fn of_robot(robot: &RobotSpec, error: &LoadError) -> anyhow::Error {
    anyhow!("{} (`{}`): {error}", robot.id, robot.program_name())
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
        exec: Exec,
        loader: &mut Loader,
        debugger: Option<&Debugger>,
    ) -> Result<Self, LoadError> {
        if debugger.is_none() && exec_of(program, exec) == Exec::Thread {
            return loader.load(program, &robot.arguments).map(RobotProgram::Thread).map(Self::Done);
        }
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
    Maker::new(scene, options).world(scene, &programs.of_robots)
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
    Census { robots: scene.robots.len(), objects, ..Census::default() }
}
