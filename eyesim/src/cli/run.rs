//! `eyesim run`: runs a scene and prints its report.

mod console;
#[cfg(feature = "window")]
mod recording;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, FromArgMatches as _};
use sim_core::record::Outcome;
use sim_core::spec::{ContactKind, Dialect, SceneSpec};
use sim_core::time::Time;
use sim_core::unit;
use sim_format::Setting;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::interrupt;
use sim_host::executive::load::DebugTarget;
use sim_host::executive::program::Exec;
use sim_host::executive::subreaper::Subreaper;
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{DEFAULT_UNTIL, Error, Finished, Observers, Options, UnpackedArchive};
use sim_host::program::sandbox::{Level, Sandbox};
use sim_host::program::words::quoted;
use sim_host::program::{Generation, command};
use sim_host::record::report::RobotReport;
use sim_host::record::{Report, TraceFilter};

use super::cc::parse_api;
use super::output::{StandardStreams, output_path, print, print_error, say};
use super::table::{self, TableScreen};
use super::{EXIT_INTERRUPTED, EXIT_PROGRAM, EXIT_USAGE};

pub(super) use console::report_diagnostics;
pub use console::{ConsoleRun, FinishedRun};
#[cfg(feature = "window")]
pub(super) use console::{build, open};

/// Arguments of `eyesim run`.
#[derive(Args, Clone)]
pub struct RunArgs {
    /// Scene: a sim file or a TOML scene
    #[arg(value_name = "SCENE")]
    pub sim: PathBuf,
    /// SCENE is the name of an example, a scene in the folder `sims` of the installation: `--example demo`
    #[arg(long)]
    pub example: bool,
    /// Do not run a scene that has warnings
    #[arg(long)]
    pub strict: bool,
    /// Write the report as JSON; `-`: to standard output, and everything else to standard error
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Repeat the user interventions of the run that this trace recorded, at the same times
    #[arg(long, value_name = "TRACE")]
    pub repeat: Option<PathBuf>,
    /// Write every event as a line of JSON during the run, compressed if the name ends with `.zst`; NAME.parquet: as
    /// rows of a table for pandas, polars and DuckDB
    #[arg(long, value_name = "FILE", value_parser = output_path())]
    pub trace: Option<PathBuf>,
    /// With --trace, write only these kinds of events: `poses`, `readings`, `events` (all others), or kinds such as
    /// `contact,stdout`
    #[arg(long, value_name = "KINDS", value_parser = TraceFilter::parse, requires = "trace")]
    pub trace_only: Option<TraceFilter>,
    /// Write the run as MCAP, for Foxglove and rerun, during the run
    #[arg(long, value_name = "FILE", value_parser = output_path())]
    pub record: Option<PathBuf>,
    /// Draw the world from above with the robots' paths, as .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write every image that a program takes as .png into a folder, which must be empty or new
    #[arg(long, value_name = "FOLDER", value_parser = output_path())]
    pub frames: Option<PathBuf>,
    /// Seed of all random numbers [default: from the scene, or 0]
    #[arg(long, value_name = "NUMBER", value_parser = super::whole_number, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Length of a time slot in milliseconds, a multiple of 0.001 [default: from the scene, or 50]
    #[arg(long, value_name = "MS", value_parser = parse_slot, allow_hyphen_values = true)]
    pub slot: Option<Time>,
    /// Number of robots that run at the same time [default: one for each processor]
    #[arg(long, value_name = "NUMBER", value_parser = parse_threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,
    /// Where programs run: on threads of this process, or each in its own process, where a crash ends only its robot
    #[arg(long, value_name = "WHERE", value_parser = exec_parser(), default_value = "auto")]
    pub exec: Exec,
    /// Build and run untrusted programs in a sandbox that denies files, network, signals and the memory of other
    /// processes, and limits resources; `calls`: all of these except files, `limits`: only resources. Implies
    /// --exec=process
    #[arg(
        long,
        value_name = "LEVEL",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "full",
        value_parser = parse_sandbox,
        conflicts_with_all = ["exec", "allow_execute"]
    )]
    pub sandbox: Option<Sandbox>,
    /// Simulated seconds at which the run ends [default: from the scene, or 600]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub until: Option<Time>,
    /// Simulated seconds for which the run continues after its last program has ended, while anything moves
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub linger: Time,
    /// Simulated seconds for each second of real time, or `max`
    #[arg(long, value_name = "FACTOR", default_value = "max", value_parser = parse_speed, allow_hyphen_values = true)]
    pub speed: Speed,
    /// Processor time in seconds that a program may compute within one slot before it is stopped
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = parse_timeout, allow_hyphen_values = true)]
    pub timeout: f64,
    /// Program for the robots without one: `maze.c`; for robot 2: `2=maze.c`; for the robots with this program or type:
    /// `search.x=maze.c`
    #[arg(long = "program", value_name = "[ROBOT|NAME=]PROGRAM", value_parser = ProgramOption::parse)]
    pub programs: Vec<ProgramOption>,
    /// RoBIOS generation that the programs are written for, 6 or 7 [default: from the scene, or from the functions that
    /// they call]
    #[arg(long, value_name = "GENERATION", value_parser = parse_api)]
    pub api: Option<Generation>,
    /// Version of EyeSim whose conventions scene and programs follow: vr2018, vr2023 or classic [default: from the
    /// scene, or vr2023]
    #[arg(long, value_name = "DIALECT", value_parser = parse_dialect)]
    pub dialect: Option<Dialect>,
    /// Cell size of the scene's maze file in millimetres; overrides the file
    #[arg(long, value_name = "MM", value_parser = parse_maze_cell, allow_hyphen_values = true)]
    pub maze_cell: Option<f64>,
    /// Override a value of a TOML scene: `robot[0].x_mm=500`, `scene.noise="real"`
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = Setting::parse)]
    pub settings: Vec<Setting>,
    /// Keys to press: `2.5:KEY1, 4:KEY4`, for robot 2 `2:2.5:KEY1`
    #[arg(long, value_name = "KEYS")]
    pub keys: Vec<String>,
    /// Standard input of the programs: a file; `-`: the text of eyesim's own standard input, which each robot reads
    /// from its beginning; `typed`: the lines that the user types in the window, or that --repeat repeats
    #[arg(long, value_name = "FILE")]
    pub stdin: Option<PathBuf>,
    /// Program arguments of a robot: `1:"--kp 0.5"`, without a number for all robots; overrides the sim file
    #[arg(long, value_name = "[ROBOT:]ARGUMENTS", allow_hyphen_values = true)]
    pub args: Vec<String>,
    /// Virtual time that RoBIOS calls take, as TOML; overrides the scene
    #[arg(long, value_name = "FILE")]
    pub costs: Option<PathBuf>,
    /// RoBIOS functions that fail for all programs, in addition to those that the scene forbids: `SIM*,OSExecute`
    #[arg(long, value_name = "FUNCTIONS")]
    pub forbid: Vec<String>,
    /// Suite whose checks judge the run, in addition to those of the scene
    #[arg(long, value_name = "SUITE")]
    pub checks: Option<PathBuf>,
    /// Errors of devices and drives of all robots: none, mild, real, harsh, course, or a noise profile; overrides
    /// the scene
    #[arg(long, value_name = "NAME|FILE")]
    pub noise: Option<String>,
    /// Motion of a robot that is pushed against a wall: slide, or stall [default: from the scene, or slide]
    #[arg(long, value_name = "RULE", value_parser = parse_contact)]
    pub contact: Option<ContactKind>,
    /// Allow programs to run commands on this machine with `OSExecute`, and the check programs of an archive to run;
    /// their effects are outside of the simulation
    #[arg(long)]
    pub allow_execute: bool,
    /// Megabytes that each program may print; further output is discarded
    #[arg(long, value_name = "MB", default_value = "10", value_parser = parse_megabytes, allow_hyphen_values = true)]
    pub output_limit: u64,
    /// Show no progress of builds and of the run
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Show every RoBIOS call with its virtual time
    #[arg(short, long)]
    pub verbose: bool,
    /// With -v, show only these calls: `PSDGet,VW*`
    #[arg(long, value_name = "PATTERNS", requires = "verbose")]
    pub only: Option<String>,
    /// With -v, show only calls of this robot
    #[arg(long, value_name = "NUMBER")]
    pub robot: Option<u32>,
    /// Simulated time at which the run ends if neither the user nor the scene sets one
    #[arg(skip = DEFAULT_UNTIL)]
    pub default_until: Time,
    /// The archive from which the scene comes: the programs of its checks then need `--allow-execute`
    #[arg(skip)]
    pub archive: Option<UnpackedArchive>,
    /// True if the programs' messages are not shown
    #[arg(skip)]
    pub is_silent: bool,
    /// The robot whose program `eyesim debug` opens in a debugger
    #[arg(skip)]
    pub debug: Option<DebugTarget>,
}

impl RunArgs {
    /// Arguments of a run of `sim` without options.
    ///
    /// # Errors
    /// If `sim` looks like an option.
    pub fn of_scene(sim: &Path) -> anyhow::Result<Self> {
        Self::of_words([sim.as_os_str()])
    }

    /// Parses the words that follow `eyesim run`.
    ///
    /// # Errors
    /// If `eyesim run` does not accept the words.
    pub fn of_words(words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> anyhow::Result<Self> {
        let words = words.into_iter().map(|word| word.as_ref().to_owned());
        let words = std::iter::once("run".into()).chain(words);
        Ok(Self::from_arg_matches(&Self::augment_args(clap::Command::new("run")).try_get_matches_from(words)?)?)
    }

    /// Returns true if the report goes to standard output; then nothing else is printed there.
    pub fn prints_report(&self) -> bool {
        self.report.as_deref() == Some(Path::new("-"))
    }

    /// The file of the report, if it goes to a file.
    fn report_file(&self) -> Option<PathBuf> {
        self.report.clone().filter(|_| !self.prints_report())
    }

    /// Where programs run: the value of `--exec`, but a sandbox always needs processes.
    pub fn exec(&self) -> Exec {
        if self.sandbox.is_some() { Exec::Process } else { self.exec }
    }

    /// Options of the run for [`sim_host::launch`].
    pub fn options(&self) -> Options {
        Options {
            seed: self.seed,
            slot: self.slot,
            until: self.until,
            linger: self.linger,
            workers: self.threads,
            exec: self.exec(),
            sandbox: self.sandbox.clone(),
            timeout: self.timeout,
            programs: self.programs.clone(),
            api: self.api,
            dialect: self.dialect,
            maze_cell: self.maze_cell,
            settings: self.settings.clone(),
            keys: self.keys.clone(),
            stdin: self.stdin.clone(),
            arguments: self.args.clone(),
            costs: self.costs.clone(),
            forbid: self.forbid.clone(),
            checks: self.checks.clone(),
            noise: self.noise.clone(),
            contact: self.contact,
            allow_execute: self.allow_execute,
            may_run_checks: self.allow_execute || self.archive.is_none(),
            output_limit: self.output_limit,
            is_verbose: self.verbose,
            strict: self.strict,
            frames: self.frames.clone(),
            keep_frames: self.record.is_some(),
            debug: self.debug.clone(),
            default_until: self.default_until,
            embedded: Vec::new(),
            archive: self.archive.clone(),
        }
    }
}

/// Parser of the value of `--exec`.
fn exec_parser() -> impl TypedValueParser<Value = Exec> {
    let values = EXECS.map(|(_, name, help)| PossibleValue::new(name).help(help));
    let exec_of =
        |name: String| EXECS.into_iter().find(|(_, value, _)| *value == name).map_or(Exec::Auto, |(exec, ..)| exec);
    PossibleValuesParser::new(values).map(exec_of)
}

/// Values of `--exec`: kind, name, help.
const EXECS: [(Exec, &str, &str); 4] = [
    (
        Exec::Auto,
        "auto",
        "In a process of its own if its imports show that it could end eyesim, else on a fiber or a thread",
    ),
    (Exec::Fiber, "fiber", "On a fiber of the host, or on a thread if it cannot run on a fiber"),
    (Exec::Thread, "thread", "On a thread of the host"),
    (Exec::Process, "process", "In a process of its own"),
];

/// Pace of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// As fast as possible.
    Max,
    /// Simulated seconds per second of wall-clock time.
    Factor(f64),
}

/// Runs the command.
///
/// # Errors
/// If files or arguments are wrong.
pub fn run(args: &RunArgs) -> anyhow::Result<ExitCode> {
    let streams = StandardStreams::current();
    let Some(finished_run) = carry_out(args, |_| Ok(()))? else { return Ok(ExitCode::from(EXIT_PROGRAM)) };
    let written = interrupt::outside_of_run(|| finished_run.write_files(args));
    let table = table::render(&finished_run.finished.report, TableScreen::of_stdout());
    let view = view_command(&finished_run.finished.report).map(|line| format!("{line}\n")).unwrap_or_default();
    match args.prints_report() {
        true => print_error(&(table + &view)),
        false => print(&(table + &view))?,
    }
    explain(&finished_run.finished);
    written?;
    streams.check()?;
    Ok(exit_code(&finished_run.finished))
}

/// Reads, builds and runs the scene of the arguments if `check` accepts it. If a program cannot be loaded, shows the
/// reason to the user and returns `None`.
///
/// # Errors
/// If files or arguments are wrong, or `check` fails.
pub fn carry_out(
    args: &RunArgs,
    check: impl FnOnce(&SceneSpec) -> anyhow::Result<()>,
) -> anyhow::Result<Option<FinishedRun>> {
    ensure!(
        args.robot.is_none() || args.verbose,
        "--robot selects the robot whose calls are shown, and needs --verbose"
    );
    let scene = console::open(args)?;
    ensure!(!scene.spec().robots.is_empty(), "`{}` has no robots: there is nothing to run", args.sim.display());
    console::filter(args, scene.spec())?;
    check(scene.spec())?;
    let built = console::build(scene, args)?;
    if !built.has_programs() {
        say("no robot has a program, so no time passes: `--program FILE` gives them one");
    }
    let ready = match built.load() {
        Err(Error::Load(why)) if !command::is_interrupted() => {
            say(format_args!("error: {why}"));
            return Ok(None);
        }
        ready => ready?,
    };
    let mut script = console::script(args)?;
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let subreaper = Subreaper::start();
    let mut run = ConsoleRun::start(ready, args, Observers { interrupt, ..Observers::default() }, false)?;
    run.follow(&mut script);
    let finished_run = run.finish(|| match subreaper.end_all() {
        0 => {}
        count => say(format_args!("{count} processes that programs had started and left behind were ended")),
    });
    script.refused().iter().for_each(|(at, why)| say(format_args!("--repeat: at {at}: {why}")));
    Ok(Some(finished_run))
}

/// Prints on standard error why the run ended if the table does not show it, which forbidden functions were called, and
/// why robots failed.
pub fn explain(finished: &Finished) {
    let Finished { settings, ended, report, remarks, .. } = finished;
    remarks.iter().for_each(say);
    match &ended.end {
        EndReason::Until if settings.is_until_default => {
            say(format_args!(
                "stopped after {} s of simulated time, since neither the scene nor --until says anything else",
                settings.until.seconds()
            ));
        }
        EndReason::Record(error) => say(format_args!("error: {error}")),
        EndReason::Interrupted => say("interrupted"),
        _ => {}
    }
    /// Maximum number of robots listed.
    const MAX_LISTED: usize = 20;
    let forbidden = report.robots.iter().filter(|robot| !robot.forbidden_calls.is_empty());
    for robot in forbidden.take(MAX_LISTED) {
        let calls = forbidden_calls(&robot.forbidden_calls);
        say(format_args!("r{} (`{}`) called forbidden functions: {calls}", robot.id, robot.program));
    }
    let failed = failures(report);
    failed.iter().take(MAX_LISTED).for_each(say);
    if failed.len() > MAX_LISTED {
        say(format_args!("... and {} more: see --report", failed.len() - MAX_LISTED));
    }
}

/// The robots that failed, each with its program and the reason.
pub fn failures(report: &Report) -> Vec<String> {
    let describe = |robot: &RobotReport| {
        let reason = robot.reason.as_deref().unwrap_or("no reason given");
        let separator = if robot.outcome == Outcome::Waiting { " " } else { ": " };
        format!("r{} (`{}`){separator}{reason}", robot.id, robot.program)
    };
    report.robots.iter().filter(|robot| robot.outcome.is_failure()).map(describe).collect()
}

/// Forbidden functions with the numbers of their calls: `SIMGetRobot` once, `SIMSetRobot` 3 times.
pub fn forbidden_calls(calls: &BTreeMap<String, u64>) -> String {
    let describe = |(name, count): (&String, &u64)| match count {
        1 => format!("`{name}` once"),
        count => format!("`{name}` {count} times"),
    };
    calls.iter().map(describe).collect::<Vec<_>>().join(", ")
}

/// The command that shows in the window what led to the earliest failure of a check. It has the arguments of this run
/// except those that only concern output, and `--at` with the time one second before the failure.
fn view_command(report: &Report) -> Option<String> {
    /// Options of a run that only write files or change what it prints, those with a value first.
    const OUTPUT: [&str; 12] = [
        "--report",
        "--trace",
        "--trace-only",
        "--record",
        "--plot",
        "--frames",
        "--only",
        "--robot",
        "--quiet",
        "-q",
        "--verbose",
        "-v",
    ];
    const WITH_VALUE_COUNT: usize = 8;
    let failure_time =
        report.checks.iter().filter(|check| !check.passed).filter_map(|check| check.at_s).min_by(f64::total_cmp)?;
    let is_repeat = |word: &String| word == "--repeat" || word.starts_with("--repeat=");
    if report.argv.get(1).is_none_or(|command| command != "run") || report.argv.iter().any(is_repeat) {
        return None;
    }
    let mut words = report.argv.iter().skip(2);
    let mut line = "to see it: eyesim view".to_owned();
    while let Some(word) = words.next() {
        let option = word.split_once('=').map_or(word.as_str(), |(option, _)| option);
        match OUTPUT.iter().position(|output| *output == option) {
            Some(index) if index < WITH_VALUE_COUNT && option == word => drop(words.next()),
            Some(_) => {}
            None => line = format!("{line} {}", quoted(word)),
        }
        // The arguments of programs may look like options.
        if word == "--args" {
            line.extend(words.next().map(|arguments| format!(" {}", quoted(arguments))));
        }
    }
    Some(format!("{line} --at {:.1}", (failure_time - 1.0).max(0.0)))
}

fn exit_code(finished: &Finished) -> ExitCode {
    let Finished { ended, report, .. } = finished;
    match ended.end {
        EndReason::Interrupted => ExitCode::from(EXIT_INTERRUPTED),
        EndReason::Record(_) => ExitCode::from(EXIT_USAGE),
        _ if ended.robots.iter().any(|robot| robot.outcome.is_failure()) => ExitCode::from(EXIT_PROGRAM),
        _ if report.checks.iter().any(|check| !check.passed) => ExitCode::from(EXIT_PROGRAM),
        _ => ExitCode::SUCCESS,
    }
}

/// The sandbox of the named level.
///
/// # Errors
/// Message with the accepted names, or with what the kernel lacks.
pub fn parse_sandbox(text: &str) -> Result<Sandbox, String> {
    Sandbox::new(Level::parse(text)?).map_err(|error| error.to_string())
}

/// The named contact rule.
fn parse_contact(text: &str) -> Result<ContactKind, String> {
    ContactKind::ALL.into_iter().find(|kind| kind.word() == text).ok_or_else(|| "expected slide or stall".to_owned())
}

/// The named dialect.
///
/// # Errors
/// Message with the accepted names.
pub fn parse_dialect(text: &str) -> Result<Dialect, String> {
    Dialect::ALL
        .into_iter()
        .find(|dialect| dialect.word() == text)
        .ok_or_else(|| "expected vr2018, vr2023 or classic".to_owned())
}

/// Parses the size of a maze's cells; the result is in metres.
///
/// # Errors
/// Message with the expected unit.
pub fn parse_maze_cell(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(mm) if (MIN_CELL_MM..=MAX_CELL_MM).contains(&mm) => Ok(unit::metres_from_mm(mm)),
        _ => Err("expected millimetres, such as 360".into()),
    }
}

/// Minimum plausible size of a cell; a smaller number is in another unit.
const MIN_CELL_MM: f64 = 1.0;
const MAX_CELL_MM: f64 = 1e6;

fn parse_slot(text: &str) -> Result<Time, String> {
    let millis: f64 = text.parse().unwrap_or(f64::NAN);
    let micros = millis * 1000.0;
    let slot = Time(micros.round() as i64);
    // A slot of more than an hour is surely a mistake.
    if !millis.is_finite() || slot < Time(1) || slot > Time::from_millis(3_600_000) {
        return Err("expected 0.001 to 3600000 milliseconds".into());
    }
    if (micros - micros.round()).abs() > 1e-6 * micros {
        return Err("expected a multiple of 0.001 milliseconds".into());
    }
    Ok(slot)
}

/// Maximum simulated time of an option, in seconds.
const MAX_SECONDS: f64 = 1e9;

/// Parses simulated seconds.
///
/// # Errors
/// Message with the accepted range.
pub fn parse_seconds(text: &str) -> Result<Time, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && (0.0..=MAX_SECONDS).contains(&seconds) => {
            Ok(Time::from_seconds_ceil(seconds))
        }
        _ => Err("expected 0 to 1e9 seconds".into()),
    }
}

/// Parses megabytes; the result is in bytes.
fn parse_megabytes(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(megabytes) if (0.0..=1e6).contains(&megabytes) => Ok((megabytes * 1e6).round() as u64),
        _ => Err("expected 0 to 1e6 megabytes".into()),
    }
}

/// Parses the number of jobs that run at the same time.
///
/// # Errors
/// Message with what is expected.
pub fn parse_count(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().ok().ok_or_else(|| "expected a whole number from 1, such as 4".to_owned())
}

/// Maximum number of threads of a run; more than the processors of any machine only take memory.
const MAX_THREADS: usize = 1024;

/// Parses a number of threads.
///
/// # Errors
/// Message with what is expected.
pub fn parse_threads(text: &str) -> Result<NonZeroUsize, String> {
    let count = parse_count(text).ok().filter(|count| count.get() <= MAX_THREADS);
    count.ok_or_else(|| format!("expected a whole number from 1 to {MAX_THREADS}, such as 4"))
}

fn parse_timeout(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds > 0.0 => Ok(seconds),
        _ => Err("expected a number of seconds above 0".into()),
    }
}

fn parse_speed(text: &str) -> Result<Speed, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(Speed::Max),
        Ok(factor) if factor.is_finite() && factor > 0.0 => Ok(Speed::Factor(factor)),
        _ => Err("expected `max` or a factor above 0, such as 1 for real time".into()),
    }
}
