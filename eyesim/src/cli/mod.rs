//! The command line: one file for each subcommand, and fixed exit codes.
//!
//! Exit codes: 0, the run ended or reached `--until`; 1, a robot program or a check failed; 2, usage or file errors; 3,
//! internal error; 130, interrupted.

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Parser, Subcommand};
use output::say;
use sim_format::path::extension;
use sim_host::executive::{interrupt, stack_limit};
use sim_host::files::slashed;
use sim_host::program::command;
use sim_host::program::words::quoted;

#[cfg(not(all(feature = "accuracy", feature = "grading", feature = "lsp", feature = "window")))]
mod absent;
#[cfg(feature = "accuracy")]
pub mod accuracy;
pub mod cc;
pub mod check;
pub mod child;
pub mod convert;
pub mod debug;
pub mod diagnostic;
mod diff;
mod doctor;
pub mod excerpt;
pub mod explain;
#[cfg(feature = "grading")]
pub mod grade;
#[cfg(feature = "lsp")]
mod lsp;
pub mod new;
pub mod output;
pub mod pack;
pub mod plot;
pub mod progress;
#[cfg(feature = "window")]
pub mod replay;
pub mod run;
mod shot;
pub mod sweep;
pub mod table;
pub mod test;
#[cfg(feature = "window")]
mod view;

/// A robot program or a check of the scene failed.
pub const EXIT_PROGRAM: u8 = 1;
/// The command line or a file is wrong.
pub const EXIT_USAGE: u8 = 2;
/// An internal error of eyesim.
pub const EXIT_INTERNAL: u8 = 3;
/// The user interrupted the run.
pub const EXIT_INTERRUPTED: u8 = 130;

/// Time in s within which this process must end once its command is done.
const END_TIMEOUT: u32 = 2;

/// Minimum stack of the main thread in bytes; the command line overflows half of it.
const MIN_STACK: u64 = 1 << 20;

/// Simulates mobile robots like EyeSim: robot programs written against RoBIOS, run in lockstep.
#[derive(Parser)]
#[command(name = "eyesim", version, about, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 ended or reached --until, 1 a robot program or a check failed, 2 usage or file errors, \
                          3 internal error, 130 interrupted.";

#[derive(Subcommand)]
enum Command {
    /// Run a sim file: build and load its robot programs, run them in lockstep, and report what happened
    Run(Box<run::RunArgs>),
    /// Run the cases of suites: scenes with seeds, noise and parameters, judged by checks
    Test(test::TestArgs),
    /// Run all cases of a suite and write their rows into a folder, on one or many machines; finished cases are not
    /// repeated
    Sweep(sweep::SweepArgs),
    /// Grade submissions by a suite, each built and run separately: writes pages, tables, and results for grading
    /// services
    #[cfg(feature = "grading")]
    Grade(grade::GradeArgs),
    #[cfg(not(feature = "grading"))]
    #[command(hide = true)]
    Grade(absent::AbsentArgs),
    /// Run a sim file in the window: watch it in 3D in a browser, and intervene
    #[cfg(feature = "window")]
    View(Box<view::ViewArgs>),
    #[cfg(not(feature = "window"))]
    #[command(hide = true)]
    View(absent::AbsentArgs),
    /// Show the run of a trace in a browser, or run it again and compare
    #[cfg(feature = "window")]
    Replay(replay::ReplayArgs),
    #[cfg(not(feature = "window"))]
    #[command(hide = true)]
    Replay(absent::AbsentArgs),
    /// Compare two runs by their traces or reports: the first event in which they differ
    Diff(diff::DiffArgs),
    /// Check files and print their mistakes
    Check(check::CheckArgs),
    /// Explain a diagnostic's code: its meaning, its consequences and the correct form
    Explain(explain::ExplainArgs),
    /// Draw a sim, world, maze, robi or object file from above, to scale
    Plot(plot::PlotArgs),
    /// Run a sim file and take a picture: a robot's camera view, the scene from any viewpoint, or a robot's display
    Shot(Box<shot::ShotArgs>),
    /// Convert a scene, a world or a type to another format: .sim, .wld, .maz, .robi and .esObj to and from .toml
    Convert(convert::ConvertArgs),
    /// Write a scene or a suite with all files that its runs read into an archive, which run, view, shot and test can open
    Pack(pack::PackArgs),
    /// Print the JSON schema of TOML scenes or suites, which editors use for completion
    Schema(convert::SchemaArgs),
    /// Measure speed against error: of motion, contacts, rays, sensors and noise, beside slower and plainer methods
    #[cfg(feature = "accuracy")]
    Accuracy(accuracy::AccuracyArgs),
    #[cfg(not(feature = "accuracy"))]
    #[command(hide = true)]
    Accuracy(absent::AbsentArgs),
    /// Build a robot program from C and C++ sources
    Cc(cc::CcArgs),
    /// A robot's process of `eyesim run --exec process`
    #[command(hide = true)]
    Child(child::ChildArgs),
    /// Run a scene with the program of one robot in gdb
    Debug(debug::DebugArgs),
    /// Check files while you type: a language server for editors
    #[cfg(feature = "lsp")]
    Lsp(lsp::LspArgs),
    #[cfg(not(feature = "lsp"))]
    #[command(hide = true)]
    Lsp(absent::AbsentArgs),
    /// List the tools and limits of this system, their purpose, and how to install missing tools
    Doctor(doctor::DoctorArgs),
    /// Write a new robot program with a robi, a world and a sim file, ready to run
    New(new::NewArgs),
}

/// Runs the command line of this process, if its stack is large enough.
pub fn main() -> ExitCode {
    if let Some(limit) = stack_limit().filter(|limit| *limit < MIN_STACK) {
        let [limit, min] = [limit, MIN_STACK].map(|bytes| bytes / 1024);
        say(format_args!("error: the stack is limited to {limit} KiB, expected at least {min}: `ulimit -s`"));
        return ExitCode::from(EXIT_USAGE);
    }
    run_words(std::env::args_os())
}

/// Runs a command line: the name of the command, then its arguments. Usage errors and help end the process.
#[inline(never)] // Its frame needs a stack that `main` has checked.
pub fn run_words(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    let words: Vec<OsString> = words.into_iter().collect();
    if let Some(command) = command_for_file(&words) {
        say(format_args!("error: no command is given: `{command}` runs this file"));
        return ExitCode::from(EXIT_USAGE);
    }
    let result = match Cli::try_parse_from(&words).unwrap_or_else(|error| refuse(&error, &words)).command {
        Command::Run(mut args) => pack::open_for_run(&mut args).and_then(|_unpacked| run::run(&args)),
        Command::Pack(args) => pack::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        #[cfg(feature = "grading")]
        Command::Grade(args) => grade::run(&args),
        #[cfg(not(feature = "grading"))]
        Command::Grade(_) => Err(absent::error("grading")),
        #[cfg(feature = "window")]
        Command::View(args) => view::run(*args),
        #[cfg(feature = "window")]
        Command::Replay(args) => replay::run(&args),
        #[cfg(not(feature = "window"))]
        Command::View(_) | Command::Replay(_) => Err(absent::error("the window")),
        Command::Diff(args) => diff::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Plot(args) => plot::run(&args),
        Command::Shot(args) => shot::run(*args),
        Command::Convert(args) => convert::run(&args),
        Command::Schema(args) => convert::schema(&args),
        #[cfg(feature = "accuracy")]
        Command::Accuracy(args) => accuracy::run(&args),
        #[cfg(not(feature = "accuracy"))]
        Command::Accuracy(_) => Err(absent::error("the accuracy report")),
        Command::Cc(args) => cc::run(&args),
        Command::Child(args) => child::run(&args),
        Command::Debug(args) => debug::run(&args),
        #[cfg(feature = "lsp")]
        Command::Lsp(args) => lsp::run(&args),
        #[cfg(not(feature = "lsp"))]
        Command::Lsp(_) => Err(absent::error("the language server")),
        Command::Doctor(args) => doctor::run(&args),
        Command::New(args) => new::run(&args),
    };
    let result = result.and_then(|code| output::take_failure().map(|()| code));
    interrupt::end_within(END_TIMEOUT);
    result.unwrap_or_else(|error| {
        say(format_args!("error: {}", output::causes(&error)));
        let code = if error.is::<Internal>() {
            EXIT_INTERNAL
        } else if command::is_interrupted() {
            EXIT_INTERRUPTED
        } else {
            EXIT_USAGE
        };
        ExitCode::from(code)
    })
}

/// Ends the process with a usage error, or with the help that the user wants.
fn refuse(error: &clap::Error, words: &[OsString]) -> ! {
    if error.kind() == ErrorKind::InvalidUtf8 {
        let words: Vec<String> =
            words.iter().filter(|word| word.to_str().is_none()).map(|word| format!("{word:?}")).collect();
        say(format_args!("error: an argument is not UTF-8: {}", words.join(", ")));
        std::process::exit(EXIT_USAGE.into());
    }
    error.exit()
}

/// Parses a whole number, such as a seed.
fn whole_number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_invalid| "expected a whole number from 0".to_owned())
}

/// The command that runs the scene or suite that is the first argument instead of a subcommand.
fn command_for_file(words: &[OsString]) -> Option<String> {
    let file = Path::new(words.get(1)?);
    let name = slashed(file);
    let is_scene = file.is_file() && ["sim", "toml"].contains(&extension(&name).as_str());
    let command = if name.ends_with(".suite.toml") { "test" } else { "run" };
    is_scene.then(|| format!("eyesim {command} {}", quoted(&name)))
}

/// An error that no input should be able to cause.
#[derive(Debug, thiserror::Error)]
#[error("internal error: {0}")]
pub struct Internal(pub String);
