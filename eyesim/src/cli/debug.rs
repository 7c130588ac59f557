//! `eyesim debug`: runs a scene with the program of one robot in gdb. While the program is stopped, simulated time does
//! not advance.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use sim_core::RobotId;
use sim_core::time::Time;
use sim_format::{Overrides, Severity, load_scene_with};
use sim_host::executive::interrupt;
use sim_host::executive::load::DebugTarget;
use sim_host::executive::process::Debugger;
use sim_host::files::DiskFiles;
use sim_host::launch::settings::{ProgramOption, assign_programs, index_of};

use super::run::{self, RunArgs, parse_seconds};

/// Limit of processor time within a slot, in seconds; so high that no program reaches it.
const NO_TIMEOUT: f64 = 1e9;

/// Arguments of `eyesim debug`.
#[derive(Args)]
pub struct DebugArgs {
    /// The scene: a sim file, or one in TOML
    #[arg(value_name = "SCENE")]
    pub sim: PathBuf,
    /// Robot whose program is debugged [default: the first robot with a program]
    #[arg(long, value_name = "NUMBER")]
    pub robot: Option<u32>,
    /// Where the program stops: `maze.c:12`, or a function [default: at the beginning of its `main`]
    #[arg(short, long = "break", value_name = "PLACE")]
    pub breakpoints: Vec<String>,
    /// Seed of all random numbers, as of `eyesim run`
    #[arg(long, value_name = "NUMBER", value_parser = super::whole_number, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Simulated seconds at which the run ends, as of `eyesim run`
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub until: Option<Time>,
    /// Programs of the command line, as of `eyesim run`
    #[arg(long = "program", value_name = "[ROBOT|NAME=]PROGRAM", value_parser = ProgramOption::parse)]
    pub programs: Vec<ProgramOption>,
    /// Arguments of programs, as of `eyesim run`
    #[arg(long, value_name = "[ROBOT:]ARGUMENTS", allow_hyphen_values = true)]
    pub args: Vec<String>,
    /// Errors of devices and drives of all robots, as of `eyesim run`
    #[arg(long, value_name = "NAME|FILE")]
    pub noise: Option<String>,
    /// Keys that are pressed, as of `eyesim run`
    #[arg(long, value_name = "KEYS")]
    pub keys: Vec<String>,
    /// Write the report as JSON
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Further arguments for gdb, after `--`: `-- -batch -ex backtrace`
    #[arg(last = true, value_name = "ARGUMENTS")]
    pub gdb: Vec<OsString>,
}

/// Runs the scene with the program of one robot in gdb.
///
/// # Errors
/// See `eyesim run`; also if gdb is missing, or there is no such robot with a program.
pub fn run(args: &DebugArgs) -> anyhow::Result<ExitCode> {
    ensure!(Debugger::is_installed(), "`gdb` is not installed: on Debian and Ubuntu it is the package `gdb`");
    let mut run = RunArgs {
        seed: args.seed,
        until: args.until,
        programs: args.programs.clone(),
        args: args.args.clone(),
        noise: args.noise.clone(),
        keys: args.keys.clone(),
        report: args.report.clone(),
        timeout: NO_TIMEOUT,
        quiet: true,
        ..RunArgs::of_scene(&args.sim)?
    };
    let (robot, program) = choose_robot(args)?;
    let name = program.to_ascii_lowercase();
    if name.ends_with(".py") || name.ends_with(".py.txt") {
        bail!("`{program}` is a Python program, which gdb cannot debug: use `print`");
    }
    let mut breakpoints = args.breakpoints.clone();
    if breakpoints.is_empty() {
        breakpoints.push(location_of_main(&program, &args.sim));
    }
    run.debug = Some(DebugTarget { robot, debugger: Debugger { breakpoints, arguments: args.gdb.clone() } });
    interrupt::leave_interrupts_to_debugger();
    run::run(&run)
}

/// Finds the robot to be debugged, and the name of its program.
fn choose_robot(args: &DebugArgs) -> anyhow::Result<(RobotId, String)> {
    let mut files = DiskFiles::of_environment();
    let overrides = Overrides { seed: args.seed, ..Overrides::default() };
    let loaded = load_scene_with(&files.name(&args.sim), overrides, &files);
    if let Some(error) = loaded.diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error) {
        bail!("{error}");
    }
    let mut scene = loaded.scene;
    assign_programs(&mut scene, &args.programs)?;
    let index = match args.robot {
        Some(robot) => index_of(&scene, robot).context("--robot")?,
        None => scene.robots.iter().position(|robot| robot.program.is_some()).unwrap_or(0),
    };
    match scene.robots.get(index).map(|robot| (robot.id, robot.program_name())) {
        Some((id, program)) if !program.is_empty() => Ok((id, program.to_owned())),
        Some((id, _)) => bail!("robot {} has no program: `--program {0}=FILE` gives it one", id.0),
        None => bail!("`{}` has no robots: there is nothing to debug", args.sim.display()),
    }
}

/// Location of the `main` of a program of the scene `sim` for gdb: the name alone would also match the `main` of
/// eyesim.
fn location_of_main(program: &str, sim: &Path) -> String {
    let first = program.split(',').next().unwrap_or(program).replace('\\', "/");
    let file = first.rsplit('/').next().unwrap_or(&first);
    if file == "Cargo.toml" {
        let folder = std::path::absolute(sim.with_file_name(first)).unwrap_or_default();
        let package = folder.parent().and_then(Path::file_name).unwrap_or_default();
        return location_of_main(&package.to_string_lossy(), sim);
    }
    let file = file.strip_suffix(".txt").unwrap_or(file);
    match file.rsplit_once('.') {
        Some((_, extension)) if ["c", "cpp", "cc", "cxx", "c++"].contains(&extension.to_lowercase().as_str()) => {
            format!("{file}:main")
        }
        Some((stem, _)) => format!("{stem}.c:main"),
        // A folder is a Cargo package, whose `main` is in its library.
        None => format!("{}::main", file.replace('-', "_")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn location_of_main_is_in_the_program() {
        for (program, main) in [
            ("maze.c", "maze.c:main"),
            ("%sim%/programs/maze.cpp", "maze.cpp:main"),
            (r"..\programs\maze.x", "maze.c:main"),
            ("main.c,map.c", "main.c:main"),
            ("../follow-wall", "follow_wall::main"),
            ("maze.c.txt", "maze.c:main"),
            ("MAZE.CPP", "MAZE.CPP:main"),
            ("Cargo.toml", "my_robot::main"),
            ("../follow-wall/Cargo.toml", "follow_wall::main"),
        ] {
            assert_eq!(location_of_main(program, Path::new("labs/my-robot/a.sim")), main, "{program}");
        }
    }
}
