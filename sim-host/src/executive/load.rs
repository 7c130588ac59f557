//! Loads the programs of a scene as private copies in this process, or in processes of their own.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use sim_core::RobotId;
use sim_core::spec::{RobotSpec, SceneSpec};

use super::embedded::EmbeddedRobot;
use super::process::serve::{LoadRefusal, RemoteProgram};
use super::process::{Child, Debugger};
use super::program::{Exec, ExecutionKind, RobotProgram};
use super::{damage, fiber};
use crate::program::load::{LoadError, Loader, OpenError, check_mappings, robots_per_turn};
use crate::program::prepare::{Code, Prepared};
use crate::program::python::restricted_host;
use crate::program::scene::Programs;

/// Memory mappings for each robot's thread: its stack with the guards below and above, its alternate stack, and the
/// adjacent mappings that the kernel splits off.
const MAPPINGS_PER_THREAD: usize = 6;

/// Reasons why the programs of robots cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ProgramLoadError {
    /// The folder for the private copies of libraries cannot be created.
    #[error("no folder to load programs from: {0}")]
    Folder(std::io::Error),
    /// Earlier programs have damaged this process too much.
    #[error(transparent)]
    Damage(#[from] damage::Damage),
    /// The kernel allows too few memory mappings.
    #[error(transparent)]
    Mappings(LoadError),
    /// The program of a robot is refused.
    #[error("{robot} (`{program}`): {error}")]
    Robot {
        /// The robot.
        robot: RobotId,
        /// Name of the program in the scene.
        program: String,
        /// The reason.
        error: LoadError,
    },
}

/// Loads the program of each robot that has one, with the arguments of its `main`: as a private copy in this process,
/// or in its own process. Robots on one of the `workers` may share a copy, as may robots of consecutive runs with the
/// same `loader`.
///
/// # Errors
/// A program cannot be loaded (the first one is reported), or the kernel's limits are too low for all programs
/// together.
pub fn load_programs(
    scene: &SceneSpec,
    programs: &Programs,
    exec: Exec,
    debug: Option<&DebugTarget>,
    workers: usize,
    loader: &mut Loader,
) -> Result<Vec<Option<RobotProgram>>, ProgramLoadError> {
    check_capacity(programs.iter(), exec, workers)?;
    loader.set_robots_per_turn(robots_per_turn(programs.iter().count(), workers));
    Child::make_room(programs.iter().filter(|program| execution_of(program, exec).0 == ExecutionKind::Process).count());
    // All processes start before the wait for the first process.
    let mut loading = Vec::with_capacity(scene.robots.len());
    for (robot, program) in scene.robots.iter().zip(&programs.of_robots) {
        let debugger = debug.filter(|debug| debug.robot == robot.id).map(|debug| &debug.debugger);
        let started = program.as_ref().map(|program| Loading::begin(robot, program, (exec, workers), loader, debugger));
        loading.push(started.transpose().map_err(|error| error_of_robot(robot, error))?);
    }
    let finish = |(robot, loading): (&RobotSpec, Option<Loading>)| {
        loading.map(|loading| loading.finish(robot).map_err(|error| error_of_robot(robot, error))).transpose()
    };
    scene.robots.iter().zip(loading).map(finish).collect()
}

/// Loads the program of a spawned robot, as [`load_programs`] does for the robots of the scene.
///
/// # Errors
/// The program cannot be loaded.
pub fn load_program(
    robot: &RobotSpec,
    program: &Arc<Prepared>,
    (exec, workers): (Exec, usize),
    loader: &mut Loader,
) -> Result<RobotProgram, ProgramLoadError> {
    check_capacity([program], exec, workers)?;
    let loading = Loading::begin(robot, program, (exec, workers), loader, None);
    loading.and_then(|loading| loading.finish(robot)).map_err(|error| error_of_robot(robot, error))
}

/// Checks that earlier programs have not damaged this process too much, and that the kernel allows the memory mappings
/// for the copies and stacks of these programs.
fn check_capacity<'a>(
    programs: impl IntoIterator<Item = &'a Arc<Prepared>>,
    exec: Exec,
    workers: usize,
) -> Result<(), ProgramLoadError> {
    // Number of copies of each program (keyed by its address), of robots in this process, and of mappings.
    let (mut copies, mut robots, mut mappings) = (BTreeMap::new(), 0, 0);
    for program in programs {
        let execution = execution_of(program, exec).0;
        let Some(image) = program.image().filter(|_| execution != ExecutionKind::Process) else { continue };
        robots += 1;
        let is_copy_shared = execution == ExecutionKind::Fiber && image.shared_variables().is_some();
        let count: &mut usize = copies.entry(Arc::as_ptr(program).addr()).or_default();
        if !is_copy_shared || *count < workers {
            *count += 1;
            mappings += image.mappings();
        }
        mappings += if execution == ExecutionKind::Fiber { fiber::mappings_per_stack() } else { MAPPINGS_PER_THREAD };
    }
    if robots > 0 {
        damage::check()?;
    }
    check_mappings(robots, mappings).map_err(ProgramLoadError::Mappings)
}

/// Adds the robot and the name of its program to an error of loading.
fn error_of_robot(robot: &RobotSpec, error: LoadError) -> ProgramLoadError {
    ProgramLoadError::Robot { robot: robot.id, program: robot.program_name().to_owned(), error }
}

/// A robot whose program runs under a debugger.
#[derive(Clone, Debug)]
pub struct DebugTarget {
    /// The robot.
    pub robot: RobotId,
    /// Settings of the debugger.
    pub debugger: Debugger,
}

/// Kind of execution of a program if the user chose `exec`. If the kind differs from the choice, or `auto` chose a
/// slower kind, the reason is also returned, as the predicate of a sentence about the program: `` uses `fork`: ... ``.
///
/// A Python program always has its own process, and so does a library whose code runs while it is loaded: if that code
/// does not return, the process can be killed.
pub fn execution_of(program: &Prepared, exec: Exec) -> (ExecutionKind, Option<String>) {
    let image = match &program.code {
        Code::Python(_) => return (ExecutionKind::Process, None),
        Code::Embedded(_) => return (ExecutionKind::Thread, None),
        Code::Library(image) => image,
    };
    let own_process = || (ExecutionKind::Process, program.danger.clone());
    match exec {
        _ if image.has_resolvers() => own_process(),
        Exec::Auto if program.danger.is_some() => own_process(),
        Exec::Auto | Exec::Fiber => {
            match program.danger.clone().or_else(|| program.why_thread_bound().map(str::to_owned)) {
                Some(reason) => (ExecutionKind::Thread, Some(reason)),
                None => (ExecutionKind::Fiber, None),
            }
        }
        Exec::Thread => (ExecutionKind::Thread, None),
        Exec::Process => (ExecutionKind::Process, None),
    }
}

/// A program that is being loaded.
enum Loading {
    Done(RobotProgram),
    /// The process, its program, and the file from which the process loads it.
    OwnProcess(Box<Child>, Arc<Prepared>, PathBuf),
}

impl Loading {
    fn begin(
        robot: &RobotSpec,
        program: &Arc<Prepared>,
        (exec, workers): (Exec, usize),
        loader: &mut Loader,
        debugger: Option<&Debugger>,
    ) -> Result<Self, LoadError> {
        let execution = if debugger.is_some() { ExecutionKind::Process } else { execution_of(program, exec).0 };
        if execution != ExecutionKind::Process {
            if let Code::Embedded(embedded) = &program.code {
                let robot = EmbeddedRobot::new(robot.id, embedded, &robot.arguments);
                return Ok(Self::Done(RobotProgram::Embedded(robot)));
            }
            let is_fiber = execution == ExecutionKind::Fiber;
            let program = loader.load(program, &robot.arguments, is_fiber.then_some(workers))?;
            return Ok(Self::Done(RobotProgram::InHost { program, is_fiber }));
        }
        let path = program.source.path().to_owned();
        let (child, library) = match (&program.code, debugger) {
            (Code::Python(_), Some(_)) => return Err(debug_error(program, "is in Python")),
            (Code::Embedded(_), Some(_)) => return Err(debug_error(program, "is code of this process")),
            (Code::Embedded(_), None) => unreachable!("an embedded program runs on a thread"),
            (Code::Python(python), None) => {
                let to_load_error = |error: std::io::Error| start_error(program, path.clone(), error.to_string());
                let (mut command, folders) = match loader.is_restricting() {
                    true => std::path::absolute(&path)
                        .and_then(|path| python.restricted_command(&path))
                        .map_err(to_load_error)?,
                    false => (python.command(&path), Vec::new()),
                };
                let scratch = loader.restrict(&mut command, program, folders).map_err(to_load_error)?;
                (Child::start_foreign(command, scratch), path.clone())
            }
            // gdb reads the library's file again while it debugs; the file in the cache is not removed.
            (Code::Library(image), Some(debugger)) => {
                (Child::start_debugged(debugger, image.path()), image.path().to_owned())
            }
            (Code::Library(_), None) => {
                let library = loader.library(program, &robot.arguments)?;
                let start = || {
                    let mut command = Child::command(&format!("{} {}", robot.id, program.name), &library)?;
                    let folders = match loader.is_restricting() {
                        true => restricted_host(&mut command)?.into_iter().chain([library.clone()]).collect(),
                        false => Vec::new(),
                    };
                    let scratch = loader.restrict(&mut command, program, folders)?;
                    Child::start(command, scratch)
                };
                (start(), library)
            }
        };
        let child = child.map_err(|error| start_error(program, path, format!("{error} ({PROCESS_HINT})")))?;
        Ok(Self::OwnProcess(Box::new(child), Arc::clone(program), library))
    }

    fn finish(self, robot: &RobotSpec) -> Result<RobotProgram, LoadError> {
        let (child, program, library) = match self {
            Self::Done(program) => return Ok(program),
            Self::OwnProcess(child, program, library) => (child, program, library),
        };
        let path = program.source.path().to_owned();
        let remote = RemoteProgram::new(*child, Arc::clone(&program), &robot.arguments);
        remote.map(RobotProgram::Process).map_err(|refusal| match refusal {
            LoadRefusal::Linker(what) => OpenError::Linker(what).of(&path, &library),
            LoadRefusal::Incompatible(what) => OpenError::Incompatible(what).of(&path, &library),
            LoadRefusal::Failed(what) => start_error(&program, path, what),
        })
    }
}

/// Error for a program that gdb cannot debug; `what` is the reason.
fn debug_error(program: &Prepared, what: &str) -> LoadError {
    let what = format!("gdb debugs programs in C, C++ and Rust, and this one {what}");
    LoadError::Incompatible { path: program.source.path().to_owned(), what }
}

/// Error for a process of `program` that has not started: the interpreter's message, otherwise `what`.
fn start_error(program: &Prepared, path: PathBuf, what: String) -> LoadError {
    match &program.code {
        Code::Python(python) => python.check().err().map_or(LoadError::Process { path, what }, LoadError::Python),
        Code::Library(_) | Code::Embedded(_) => LoadError::Process { path, what },
    }
}

/// Advice on the limits of the number of processes.
const PROCESS_HINT: &str =
    "each robot needs a process with two threads, and a thread and a file in eyesim: see `ulimit -u` and `ulimit -n`";
