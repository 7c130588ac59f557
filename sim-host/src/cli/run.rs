//! `eyesim run`: a sim file from its first line to the last line of its report.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context, bail, ensure};
use clap::{Args, FromArgMatches as _};
use glam::DVec2;
use parking_lot::Mutex;
use sim_core::ObjectId;
use sim_core::build;
use sim_core::format::{
    CostsRef, Diagnostic, Files, InputFile, ObjectSpec, RobotSpec, SceneSpec, Severity, decode, is_scene,
    load_scene_with,
};
use sim_core::pose::Pose;
use sim_core::time::Time;
use sim_core::world::Presence;
use sim_core::world::World;
use sim_view::protocol;

use super::cc::parse_api;
use super::diagnostic::{self, Colour, Format};
use super::options::{Options, ProgramOption, give_noise};
use super::output;
use super::progress::{Building, Counts, Progress};
use super::table::{self, Screen};
use super::{EXIT_INTERRUPTED, EXIT_PROGRAM, EXIT_USAGE, check};
use crate::executive::conductor::End;
use crate::executive::gate::Gate;
use crate::executive::pace::Pace;
use crate::executive::program::{Exec, RobotProgram};
use crate::executive::run::{Ended, Limits, Parts, RobotEnd, Run};
use crate::executive::script::{Refused, Script};
use crate::executive::thread::ThreadExecutor;
use crate::files::{DiskFiles, slashed};
use crate::plot::{self, RunObject, RunPicture, RunRobot};
use crate::program::{Builder, Cache, Generation, Kits, SearchPath, Tools};
use crate::record::event::KindSet;
use crate::record::frame::{FrameFailures, Frames};
use crate::record::mcap::Beginning;
use crate::record::report::{Input, ObjectReport, REPORT_SCHEMA, RobotReport};
use crate::record::trace::{TraceHeader, TraceRobot};
use crate::record::trail::Way;
use crate::record::{Digest, Log, Mcap, Outcome, Record, RecordError, Recorded, Recorder, Report, Sink, Trace, Trails};
use crate::robios::robot::Robot;
use crate::scenery::LazyScenery;
use crate::setup::{Debug, Programs, RobotOptions};
use crate::window::scene::{ObjectSubject, RobotSubject, Subject};
use crate::workshop::Workshop;

/// Simulated seconds after which a run ends when the user says nothing and nobody watches.
const DEFAULT_UNTIL: f64 = 600.0;

/// Arguments of `eyesim run`.
#[derive(Args, Clone)]
pub struct RunArgs {
    /// The scene: a sim file, or one in TOML
    #[arg(value_name = "SCENE")]
    pub sim: PathBuf,
    /// Do not run a scene that has warnings
    #[arg(long)]
    pub strict: bool,
    /// Write the report as JSON
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Do again what hands did in the run of a trace, at the same times
    #[arg(long, value_name = "TRACE")]
    pub repeat: Option<PathBuf>,
    /// Write every event as a line of JSON while the run goes on
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Write the run as MCAP, which Foxglove and rerun open, while it goes on
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Draw the world from above with the robots' paths, as .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write every image that a program takes as .png into a folder, which must be empty or not there yet
    #[arg(long, value_name = "FOLDER")]
    pub frames: Option<PathBuf>,
    /// Seed of all random numbers [default: that of the scene, else 0]
    #[arg(long, value_name = "NUMBER")]
    pub seed: Option<u64>,
    /// Length of a time slot in milliseconds, a multiple of 0.001 [default: that of the scene, else 50]
    #[arg(long, value_name = "MS", value_parser = parse_slot, allow_hyphen_values = true)]
    pub slot: Option<Time>,
    /// Robots that run at one time [default: one for each processor]
    #[arg(long, value_name = "NUMBER")]
    pub threads: Option<NonZeroUsize>,
    /// Where programs run: on threads of this process, or each in a process of its own, where a fault ends its robot alone
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Exec::Thread)]
    pub exec: Exec,
    /// Simulated seconds at which the run ends [default: that of the scene, else 600]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub until: Option<Time>,
    /// Simulated seconds for each second of real time, or `max`
    #[arg(long, value_name = "FACTOR", default_value = "max", value_parser = parse_speed, allow_hyphen_values = true)]
    pub speed: Speed,
    /// Processor time in seconds that a program may compute within one slot before it is stopped
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = parse_timeout, allow_hyphen_values = true)]
    pub timeout: f64,
    /// Program of the robots that have none; of one robot: `2=maze.c`; in place of a program or for a type: `search.x=maze.c`
    #[arg(long = "program", value_name = "[ROBOT|NAME=]PROGRAM", value_parser = ProgramOption::parse)]
    pub programs: Vec<ProgramOption>,
    /// RoBIOS generation that the programs are written for, 6 or 7 [default: that of the scene, else of the functions they call]
    #[arg(long, value_name = "GENERATION", value_parser = parse_api)]
    pub api: Option<Generation>,
    /// Keys that are pressed: `2.5:KEY1, 4:KEY4`, for one robot `2:2.5:KEY1`
    #[arg(long, value_name = "KEYS")]
    pub keys: Vec<String>,
    /// Arguments of a robot's program in place of those of the sim file: `1:"--kp 0.5"`, without a number for all robots
    #[arg(long, value_name = "[ROBOT:]ARGUMENTS", allow_hyphen_values = true)]
    pub args: Vec<String>,
    /// Virtual time that RoBIOS calls take, as TOML, in place of the scene's
    #[arg(long, value_name = "FILE")]
    pub costs: Option<PathBuf>,
    /// Errors of devices and drives of all robots, in place of the scene's: none, mild, real, harsh, or a noise profile
    #[arg(long, value_name = "NAME|FILE")]
    pub noise: Option<String>,
    /// Let programs run commands of this machine with `OSExecute`: what they do is outside of the simulation
    #[arg(long)]
    pub allow_execute: bool,
    /// Show no progress: neither what is being built nor how far the run is
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Show every RoBIOS call with its virtual time
    #[arg(short, long)]
    pub verbose: bool,
    /// With -v only these calls: `PSDGet,VW*`
    #[arg(long, value_name = "PATTERNS", requires = "verbose")]
    pub only: Option<String>,
    /// With -v only this robot
    #[arg(long, value_name = "NUMBER")]
    pub robot: Option<u32>,
    /// The messages of the programs are shown nowhere
    #[arg(skip)]
    pub is_silent: bool,
    /// The robot whose program `eyesim debug` opens in a debugger
    #[arg(skip)]
    pub debug: Option<Debug>,
}

impl RunArgs {
    /// A run of `sim` as without any option.
    ///
    /// # Errors
    /// When `sim` looks like an option.
    pub fn of_scene(sim: &Path) -> anyhow::Result<Self> {
        Self::of_words([sim.as_os_str()])
    }

    /// The run that these words behind `eyesim run` ask for.
    ///
    /// # Errors
    /// Words that `eyesim run` does not take.
    pub fn of_words(words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> anyhow::Result<Self> {
        let words = words.into_iter().map(|word| word.as_ref().to_owned());
        let words = std::iter::once("run".into()).chain(words);
        Ok(Self::from_arg_matches(&Self::augment_args(clap::Command::new("run")).try_get_matches_from(words)?)?)
    }

    /// Words behind `eyesim run` that ask for the same run with this seed, these slots and this limit: all that decides what
    /// happens in it.
    fn words(&self, seed: u64, slot: Time, until: Time) -> Vec<String> {
        let mut words = vec![slashed(&self.sim)];
        // One word each, so that no value is taken for an option.
        let mut add = |option: &str, value: &dyn std::fmt::Display| words.push(format!("--{option}={value}"));
        add("seed", &seed);
        add("slot", &(slot.seconds() * 1000.0));
        add("until", &until.seconds().min(MAX_SECONDS));
        self.programs.iter().for_each(|program| add("program", program));
        self.api.iter().for_each(|api| add("api", &api.number()));
        self.keys.iter().for_each(|keys| add("keys", keys));
        self.args.iter().for_each(|args| add("args", args));
        self.costs.iter().for_each(|costs| add("costs", &slashed(costs)));
        self.noise.iter().for_each(|noise| add("noise", noise));
        if self.exec == Exec::Process {
            add("exec", &"process");
        }
        if self.allow_execute {
            words.push("--allow-execute".to_owned());
        }
        words
    }
}

/// How fast a run goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// As fast as possible.
    Max,
    /// Simulated seconds for each second of real time.
    Factor(f64),
}

/// Runs the command.
///
/// # Errors
/// Files or arguments that are wrong.
pub fn run(args: &RunArgs) -> anyhow::Result<ExitCode> {
    let Some(ran) = carry_out(args, |_| Ok(()))? else { return Ok(ExitCode::from(EXIT_PROGRAM)) };
    let written = ran.write_files(args);
    print(&table::render(&ran.report, Screen::of_stdout()))?;
    explain(&ran.options, &ran.report, &ran.ended);
    written?;
    Ok(exit_code(&ran.ended))
}

/// A run that is over.
pub struct Ran {
    /// What the command line and the scene said of it.
    pub options: Options,
    /// What was run.
    pub scene: Arc<SceneSpec>,
    /// What its cameras see.
    pub scenery: Arc<LazyScenery>,
    /// How it ended.
    pub ended: Ended,
    /// The same for people and programs.
    pub report: Report,
    trails: Option<Arc<Mutex<Trails>>>,
}

impl Ran {
    /// Writes the report and the plot that the arguments ask for.
    ///
    /// # Errors
    /// The first file that cannot be written; it keeps no other from being written.
    pub fn write_files(&self, args: &RunArgs) -> anyhow::Result<()> {
        if self.scenery.built().is_some() {
            // Images that cameras have seen meanwhile are inputs, too.
            let outputs = [("--report", &args.report), ("--plot", &args.plot)];
            output::check_outputs(&given(&outputs), self.report.inputs.iter().map(|input| input.path.as_str()))?;
        }
        let plot = args.plot.as_ref().zip(self.trails.as_ref());
        let written = [
            args.report.as_ref().map(|path| Ok(self.report.write(path)?)),
            plot.map(|(path, trails)| write_plot(path, &self.scene, &trails.lock(), &self.ended)),
        ];
        written.into_iter().flatten().collect()
    }
}

/// Reads, builds and runs what the arguments name, if `check` finds nothing wrong with the scene; `None` if a program cannot be
/// loaded, of which the user is told.
///
/// # Errors
/// Files or arguments that are wrong, and what `check` finds.
pub fn carry_out(args: &RunArgs, check: impl FnOnce(&SceneSpec) -> anyhow::Result<()>) -> anyhow::Result<Option<Ran>> {
    let built = Built::new(args, |scene| {
        ensure!(!scene.robots.is_empty(), "`{}` has no robots: there is nothing to run", args.sim.display());
        check(scene)
    })?;
    if built.programs.iter().next().is_none() {
        eprintln!("no robot has a program, so no time passes: `--program FILE` gives them one");
    }
    match built.load(args) {
        Ok(ready) => {
            let (company, refused) = Company::of(args)?;
            let ran = ready.run(args, company)?;
            refused.lock().iter().for_each(|(at, why)| eprintln!("--repeat: at {at}: {why}"));
            Ok(Some(ran))
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            Ok(None)
        }
    }
}

/// A scene whose programs have been built.
pub struct Built {
    options: Options,
    scene: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    programs: Programs,
    inputs: Vec<Input>,
    frames: Option<Arc<Frames>>,
    workshop: Workshop,
    world: World,
    robots: Vec<Robot>,
}

/// A run that can start.
pub struct Ready {
    built: Built,
    programs: Vec<Option<RobotProgram>>,
}

/// Who takes part in a run beside its programs.
#[derive(Default)]
pub struct Company {
    /// Who decides when it goes on.
    pub gate: Option<Box<dyn Gate>>,
    /// Who else wants to see its records.
    pub sinks: Vec<Box<dyn Sink>>,
    /// When it ends where neither the user nor the scene says it.
    pub until: Option<Time>,
    /// Where the messages of its programs and its progress go.
    pub is_quiet: bool,
}

/// Shows what is wrong with the scene, and refuses to run it if it is an error or, when `strict`, anything.
pub(super) fn tell(diagnostics: &[Diagnostic], inputs: &[InputFile], strict: bool) -> anyhow::Result<()> {
    if diagnostics.is_empty() {
        return Ok(());
    }
    let screen = diagnostic::Screen::of_stderr(Colour::Auto);
    eprint!("{}", diagnostic::render(diagnostics, inputs, Format::Auto, screen)?);
    if check::is_rejected(diagnostics, strict) {
        let text = diagnostic::render(diagnostics, inputs, Format::Auto, diagnostic::Screen::of_page())?;
        bail!(Rejected { count: diagnostic::count(diagnostics), text });
    }
    Ok(())
}

/// Why a scene is not run: what diagnostics say of it, of which the user has been told.
#[derive(Debug, thiserror::Error)]
#[error("the scene is not run: {count}")]
pub struct Rejected {
    /// How many there are.
    pub count: String,
    /// All of them.
    pub text: String,
}

/// Refuses what is named in place of a scene, such as the program itself, before it is read as one.
fn expect_scene(path: &Path) -> anyhow::Result<()> {
    let name = path.display();
    if path.is_dir() {
        bail!("`{name}` is a folder: name the scene in it (NAME.sim or NAME.scene.toml)");
    }
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("toml") {
        // A file that cannot be read is told of by the reader.
        let is_scene = std::fs::read(path).map_or(true, |bytes| is_scene(&path.to_string_lossy(), &decode(&bytes).0));
        ensure!(is_scene, "`{name}` is no scene: it has none of `scene`, `world` and `robot` at its top level");
    } else if !extension.is_empty() && !extension.eq_ignore_ascii_case("sim") {
        bail!(
            "`{name}` is no scene: expected NAME.sim or NAME.scene.toml, which names a world and, for each robot, a type \
             and a program"
        );
    }
    Ok(())
}

impl Built {
    /// Reads and builds what the arguments name, if `check` finds nothing wrong with the scene.
    ///
    /// # Errors
    /// Files or arguments that are wrong, and what `check` finds; [`Rejected`] for what diagnostics say.
    pub fn new(args: &RunArgs, check: impl FnOnce(&SceneSpec) -> anyhow::Result<()>) -> anyhow::Result<Self> {
        ensure!(args.robot.is_none() || args.verbose, "--robot: it says whose calls are shown, and needs --verbose");
        expect_scene(&args.sim)?;
        let mut files = DiskFiles::of_environment();
        let mut loaded = load_scene_with(&files.name(&args.sim), args.seed, &files);
        if let Some(noise) = &args.noise {
            give_noise(&mut loaded, noise, &mut files).context("--noise")?;
        }
        if let Some(CostsRef::Table(table)) = loaded.scene.run.costs.as_ref().filter(|_| args.costs.is_none()) {
            loaded.diagnostics.extend(check::unknown_functions(table));
        }
        tell(&loaded.diagnostics, &loaded.inputs, args.strict)?;
        let options = Options::new(args, &mut loaded.scene)?;
        check(&loaded.scene)?;
        let missing = check::missing_programs(&loaded.scene, Severity::Error, &*check::finder(&files, args.api)?);
        tell(&missing, &loaded.inputs, args.strict)?;

        let scene = Arc::new(loaded.scene);
        let search = SearchPath {
            sim_folder: Some(PathBuf::from(&scene.folder)),
            working_folder: std::env::current_dir().context("no working folder")?,
            folders: Vec::new(),
            installation: files.home().map(PathBuf::from),
        };
        let programs = build_programs(args, &scene, &search)?;
        let inputs = inputs(&loaded.inputs, options.costs_input.as_ref(), &programs);
        check_outputs(args, &inputs)?;
        let frames = |folder: &PathBuf| {
            let frames = Frames::create(folder, scene.robots.len());
            frames.with_context(|| format!("--frames `{}`", folder.display()))
        };
        let mut frames = args.frames.as_ref().map(frames).transpose()?;
        if args.record.is_some() {
            frames = Some(frames.unwrap_or_default().keeping());
        }
        let frames = frames.map(Arc::new);
        programs.remarks.iter().for_each(|remark| eprintln!("{remark}"));
        let scenery = Arc::new(LazyScenery::new(Arc::clone(&scene), files, loaded.diagnostics, loaded.inputs));
        let robot_options = RobotOptions {
            seed: options.seed,
            slot: options.slot,
            keys: &options.keys,
            may_execute: args.allow_execute,
            is_verbose: args.verbose,
            scenery: Arc::clone(&scenery),
            frames: frames.clone(),
        };
        let mut workshop = Workshop::new(Arc::clone(&scene), &programs, args.exec, &robot_options);
        let (world, robots) = workshop.build_world()?;
        Ok(Self { options, scene, scenery, programs, inputs, frames, workshop, world, robots })
    }

    /// Loads the programs.
    ///
    /// # Errors
    /// A program that cannot be loaded.
    pub fn load(self, args: &RunArgs) -> anyhow::Result<Ready> {
        let programs = self.programs.load(&self.scene, args.exec, args.debug.as_ref())?;
        Ok(Ready { built: self, programs })
    }
}

impl Ready {
    /// What the command line and the scene say of it.
    pub fn options(&self) -> &Options {
        &self.built.options
    }

    /// What is to be run.
    pub fn scene(&self) -> &Arc<SceneSpec> {
        &self.built.scene
    }

    /// What its cameras see.
    pub fn scenery(&self) -> &Arc<LazyScenery> {
        &self.built.scenery
    }

    /// Every file that decides what is run.
    pub fn inputs(&self) -> &[Input] {
        &self.built.inputs
    }

    /// Runs it from the first line of its record to the last line of its report.
    ///
    /// # Errors
    /// Files that cannot be written, and a system without room for the robots.
    pub fn run(self, args: &RunArgs, company: Company) -> anyhow::Result<Ran> {
        let Self { built, programs: loaded } = self;
        let Built { options, scene, scenery, programs, mut inputs, frames, workshop, world, robots } = built;
        let until = options.until.or(company.until).unwrap_or(Time::from_seconds_ceil(DEFAULT_UNTIL));
        let is_hidden = args.verbose || args.quiet || company.is_quiet;
        let mut progress = if is_hidden { Progress::hidden() } else { Progress::new(until) };
        let Sinks { mut all, trails } = sinks(args, &options, &scene, &progress)?;
        if let Some(path) = &args.trace {
            let header = trace_header(args, &options, &scene, until, &inputs);
            all.push(Box::new(Trace::create(path, &header)?));
        }
        if let Some((path, frames)) = args.record.as_ref().zip(frames.clone()) {
            all.push(Box::new(recording(path, &options, &scene, &scenery, frames)?));
        }
        let remarks = SceneryRemarks {
            scenery: Arc::clone(&scenery),
            is_strict: args.strict,
            is_told: false,
            err: progress.stderr(),
        };
        all.insert(0, Box::new(remarks));
        all.extend(frames.map(|frames| Box::new(FrameFailures(frames)) as Box<dyn Sink>));
        all.extend(company.sinks);
        let limits = Limits {
            lanes: args.threads.map_or_else(processors, NonZeroUsize::get),
            until,
            timeout: args.timeout,
            is_verbose: args.verbose,
        };
        let parts = Parts {
            world,
            programs: loaded,
            executor: Box::new(ThreadExecutor::new(robots.len(), programs.iter().count(), limits.lanes)),
            robots,
            workshop: Some(workshop),
            costs: options.costs.clone(),
            recorder: Recorder::new(options.seed, options.slot, all),
            gate: company.gate,
        };
        let ended = Run::execute(parts, &limits, |run| progress.update(run.slot_start(), || counts(run)))
            .context("cannot start the robots")?;
        progress.clear();

        if let Some(built) = scenery.built() {
            let files = built.inputs.iter().map(|file| Input::new(Path::new(&file.path), &file.bytes));
            let new: Vec<Input> = files.filter(|file| inputs.iter().all(|known| known.path != file.path)).collect();
            inputs.extend(new);
        }
        let report = report(&options, &scene, &ended, inputs);
        Ok(Ran { options, scene, scenery, ended, report, trails })
    }
}

impl Company {
    /// The pace and the hand that the arguments ask for, and nobody else; what of the hand's is refused while the run goes on.
    ///
    /// # Errors
    /// A trace that cannot be read.
    fn of(args: &RunArgs) -> anyhow::Result<(Self, Arc<Refused>)> {
        let pace = match args.speed {
            Speed::Max => None,
            Speed::Factor(factor) => Some(Pace::new(factor)),
        };
        let Some(trace) = &args.repeat else {
            let gate = pace.map(|pace| Box::new(pace) as Box<dyn Gate>);
            return Ok((Self { gate, ..Self::default() }, Arc::default()));
        };
        let script = Script::new(Recorded::read(trace).context("--repeat")?.interventions).paced(pace);
        let refused = script.refused();
        Ok((Self { gate: Some(Box::new(script)), ..Self::default() }, refused))
    }
}

/// Tells, in the slot in which the first camera is used, what is wrong in the meshes and images that are read then.
struct SceneryRemarks {
    scenery: Arc<LazyScenery>,
    is_strict: bool,
    is_told: bool,
    err: Box<dyn std::io::Write + Send>,
}

impl Sink for SceneryRemarks {
    fn interest(&self) -> KindSet {
        KindSet::NONE
    }

    fn record(&mut self, _: &Record<'_>) -> Result<(), RecordError> {
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        let Some(built) = self.scenery.built().filter(|_| !self.is_told) else { return Ok(()) };
        self.is_told = true;
        if built.diagnostics.is_empty() {
            return Ok(());
        }
        let screen = diagnostic::Screen::of_stderr(Colour::Auto);
        let text = diagnostic::render(&built.diagnostics, &self.scenery.inputs(), Format::Auto, screen);
        let written = text.map_err(std::io::Error::other).and_then(|text| self.err.write_all(text.as_bytes()));
        written.map_err(|source| RecordError::Print { stream: "standard error", source })?;
        let is_rejected = check::is_rejected(&built.diagnostics, self.is_strict);
        if is_rejected { Err(RecordError::Strict(diagnostic::count(&built.diagnostics))) } else { Ok(()) }
    }
}

/// Builds the programs of `scene`, and says on a terminal what takes so long.
fn build_programs(args: &RunArgs, scene: &SceneSpec, search: &SearchPath) -> anyhow::Result<Programs> {
    let cache = Cache::of_user().context("no folder for built programs")?;
    let mut tools = Tools::of_environment();
    if args.debug.is_some() {
        // Every line is there to stop at, and every variable to look at; what the user says of it goes behind.
        tools.cflags = Some(format!("-O0 {}", tools.cflags.unwrap_or_default()));
    }
    let mut builder = Builder::new(cache, Kits::of_robios(), tools);
    if !args.quiet {
        builder = builder.watched_by(Box::new(Building::on_stderr()));
    }
    Programs::build(scene, search, &builder)
}

/// Prints to standard output; a reader who has seen enough (`| head`) is no error.
///
/// # Errors
/// What else keeps it from being written.
pub fn print(text: &str) -> anyhow::Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}

/// Checks before the run that what it writes destroys none of its inputs and has a folder to lie in.
fn check_outputs(args: &RunArgs, inputs: &[Input]) -> anyhow::Result<()> {
    let outputs =
        [("--report", &args.report), ("--trace", &args.trace), ("--record", &args.record), ("--plot", &args.plot)];
    let repeated = args.repeat.as_deref().map(slashed);
    let inputs = inputs.iter().map(|input| input.path.as_str()).chain(repeated.as_deref());
    output::check_outputs(&given(&outputs), inputs)?;
    args.plot.as_deref().map(plot::Kind::of).transpose().context("--plot")?;
    Ok(())
}

/// Those of the options that the user has given.
fn given<'a>(options: &[(&'a str, &'a Option<PathBuf>)]) -> Vec<(&'a str, &'a Path)> {
    options.iter().filter_map(|(option, path)| Some((*option, path.as_deref()?))).collect()
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// The first line of a trace of the run that `args` ask for.
pub fn trace_header(
    args: &RunArgs,
    options: &Options,
    scene: &SceneSpec,
    until: Time,
    inputs: &[Input],
) -> TraceHeader {
    let robot = |robot: &sim_core::format::RobotSpec| TraceRobot {
        id: robot.id.0,
        name: robot.robi.name.clone(),
        program: robot.program_name().to_owned(),
    };
    TraceHeader {
        seed: options.seed,
        slot_us: options.slot.0,
        robots: scene.robots.iter().map(robot).collect(),
        run: args.words(options.seed, options.slot, until),
        inputs: inputs.to_vec(),
    }
}

/// Whoever wants to see the records of a run.
struct Sinks {
    all: Vec<Box<dyn Sink>>,
    /// The one of them that the plot shows at the end.
    trails: Option<Arc<Mutex<Trails>>>,
}

/// The sinks that the arguments ask for.
fn sinks(args: &RunArgs, options: &Options, scene: &SceneSpec, progress: &Progress) -> anyhow::Result<Sinks> {
    let mut all: Vec<Box<dyn Sink>> = Vec::new();
    if !args.is_silent {
        all.push(Box::new(Log::new(options.filter.clone(), progress.stdout(), progress.stderr())));
    }
    let trails = args.plot.is_some().then(|| {
        let starts: Vec<Pose> = scene.robots.iter().map(|robot| robot.start).collect();
        let objects: Vec<Pose> = build::movable(scene).map(|object| object.pose).collect();
        Arc::new(Mutex::new(Trails::new(&starts, &objects)))
    });
    all.extend(trails.iter().map(|trails| Box::new(Arc::clone(trails)) as Box<dyn Sink>));
    Ok(Sinks { all, trails })
}

/// The recording at `path`, of what `frames` keeps beside the events.
fn recording(
    path: &Path,
    options: &Options,
    scene: &SceneSpec,
    scenery: &LazyScenery,
    frames: Arc<Frames>,
) -> anyhow::Result<Mcap> {
    let robot = |robot: &sim_core::format::RobotSpec| RobotSubject {
        id: robot.id,
        robi: Arc::clone(&robot.robi),
        program: robot.program_name().to_owned(),
        position: robot.start.position,
        has_colours: false,
    };
    let object = |(id, object): (u32, &ObjectSpec)| ObjectSubject {
        id: ObjectId(id),
        kind: Arc::clone(&object.kind),
        position: object.pose.position,
    };
    let shown = Subject {
        run: 1,
        seed: options.seed,
        slot: options.slot,
        spec: scene,
        scenery: &scenery.get(),
        robots: scene.robots.iter().map(robot).collect(),
        objects: (1..).zip(build::movable(scene)).map(object).collect(),
        workshop: protocol::Workshop::default(),
    };
    let beginning = Beginning {
        seed: options.seed,
        slot: options.slot,
        scene: shown.scene(),
        robots: scene.robots.iter().map(|robot| robot.start).collect(),
        objects: build::movable(scene).map(|object| object.pose).collect(),
        frames,
    };
    Ok(Mcap::create(path, beginning)?)
}

/// How the robots stand while the run goes on.
fn counts(run: &Run) -> Counts {
    let mut counts = Counts::default();
    for id in run.ids_with_program() {
        let robot = run.robot(id);
        if robot.ending.is_some() {
            counts.ended += 1;
        } else if robot.tasks.are_waiting() {
            counts.waiting += 1;
        } else {
            counts.running += 1;
        }
    }
    counts
}

/// Every file that decided what was run, each once, in the order in which they were read.
fn inputs(scene: &[InputFile], costs: Option<&InputFile>, programs: &Programs) -> Vec<Input> {
    let mut inputs: Vec<Input> =
        scene.iter().chain(costs).map(|file| Input::new(Path::new(&file.path), &file.bytes)).collect();
    let paths: BTreeSet<PathBuf> = programs.iter().flat_map(|program| program.inputs()).collect();
    for path in paths {
        // A source that has vanished since it was compiled cannot be hashed any more.
        if let Ok(bytes) = std::fs::read(&path) {
            inputs.push(Input::new(&path, &bytes));
        }
    }
    inputs
}

/// All robots and movable objects that ever were in the run, in order of their ids.
fn cast(scene: &SceneSpec, ended: &Ended) -> (Vec<RobotSpec>, Vec<ObjectSpec>) {
    match &*ended.run.workshop() {
        Some(workshop) => (workshop.robots().to_vec(), workshop.objects().to_vec()),
        None => (scene.robots.clone(), build::movable(scene).cloned().collect()),
    }
}

fn report(options: &Options, scene: &SceneSpec, ended: &Ended, inputs: Vec<Input>) -> Report {
    let (robots, objects) = cast(scene, ended);
    let world = ended.run.world.read();
    let added = |presence: Presence| (presence.since >= Time::ZERO).then(|| presence.since.seconds());
    let removed = |presence: Presence| (presence.until < Time::NEVER).then(|| presence.until.seconds());
    let robot = |(spec, end): (&RobotSpec, &RobotEnd)| RobotReport {
        id: spec.id.0,
        name: spec.robi.name.clone(),
        program: spec.program_name().to_owned(),
        outcome: end.outcome,
        reason: end.reason.clone(),
        exit_code: end.exit_code,
        virtual_time_s: end.virtual_time.seconds(),
        pose: end.pose.into(),
        odometry: Some(end.odometry.into()),
        path_m: end.path,
        contacts: u64::from(end.contacts),
        lcd: end.panel.lines(),
        added_s: added(world.robot_presence(spec.id)),
        removed_s: removed(world.robot_presence(spec.id)),
    };
    let object = |(id, (spec, end)): (u32, (&ObjectSpec, &Pose))| ObjectReport {
        id,
        name: spec.kind.name.clone(),
        start: spec.pose.into(),
        pose: (*end).into(),
        added_s: added(world.object_presence(ObjectId(id))),
        removed_s: removed(world.object_presence(ObjectId(id))),
    };
    Report {
        schema: REPORT_SCHEMA,
        eyesim_version: env!("CARGO_PKG_VERSION").into(),
        argv: std::env::args().collect(),
        inputs,
        seed: options.seed,
        slot_us: options.slot.0,
        sim_time_s: ended.time.seconds(),
        real_time_s: ended.real_time.as_secs_f64(),
        digest: ended.digest,
        robots: robots.iter().zip(&ended.robots).map(robot).collect(),
        objects: (1..).zip(objects.iter().zip(&ended.objects)).map(object).collect(),
    }
}

/// Writes the picture of the run.
fn write_plot(path: &Path, scene: &SceneSpec, trails: &Trails, ended: &Ended) -> anyhow::Result<()> {
    let (robots, movable) = cast(scene, ended);
    let robot = |((spec, end), trail): ((&RobotSpec, &RobotEnd), &Way)| RunRobot {
        id: spec.id.0,
        robi: Arc::clone(&spec.robi),
        start: spec.start,
        end: end.pose,
        trails: trail.lines(),
    };
    let robots: Vec<RunRobot> = robots.iter().zip(&ended.robots).zip(trails.trails()).map(robot).collect();
    let object = |object: &ObjectSpec, end: Pose, trails: Vec<Vec<DVec2>>| RunObject {
        kind: Arc::clone(&object.kind),
        start: object.pose,
        end,
        trails,
    };
    let fixed = scene.objects.iter().filter(|spec| spec.kind.is_fixed);
    let fixed = fixed.map(|spec| object(spec, spec.pose, Vec::new()));
    let moved = movable.iter().zip(ended.objects.iter().zip(trails.objects()));
    let moved = moved.map(|(spec, (end, trail))| object(spec, *end, trail.lines()));
    let objects: Vec<RunObject> = fixed.chain(moved).collect();
    let drawing = plot::draw_run(&RunPicture {
        title: &scene.file,
        world: &scene.world,
        markers: &scene.markers,
        robots: &robots,
        objects: &objects,
        contacts: trails.contacts(),
    });
    Ok(plot::write(&drawing, path, None)?)
}

/// Says on standard error why the run ended where the table alone does not.
pub fn explain(options: &Options, report: &Report, ended: &Ended) {
    match &ended.end {
        End::Until if options.until.is_none() => {
            eprintln!(
                "stopped after {DEFAULT_UNTIL} s of simulated time, since neither the scene nor --until says anything else"
            );
        }
        End::Record(error) => eprintln!("error: {error}"),
        End::Interrupted => eprintln!("interrupted"),
        _ => {}
    }
    /// Beyond so many lines nobody reads on.
    const MOST: usize = 20;
    let failed: Vec<_> = report.robots.iter().filter(|robot| robot.outcome.is_failure()).collect();
    for robot in failed.iter().take(MOST) {
        let reason = robot.reason.as_deref().unwrap_or("no reason given");
        let blank = if robot.outcome == Outcome::Waiting { " " } else { ": " };
        eprintln!("r{} (`{}`){blank}{reason}", robot.id, robot.program);
    }
    if failed.len() > MOST {
        eprintln!("... and {} more: see --report", failed.len() - MOST);
    }
}

fn exit_code(ended: &Ended) -> ExitCode {
    match ended.end {
        End::Interrupted => ExitCode::from(EXIT_INTERRUPTED),
        End::Record(_) => ExitCode::from(EXIT_USAGE),
        _ if ended.robots.iter().any(|robot| robot.outcome.is_failure()) => ExitCode::from(EXIT_PROGRAM),
        _ => ExitCode::SUCCESS,
    }
}

fn parse_slot(text: &str) -> Result<Time, String> {
    let millis: f64 = text.parse().unwrap_or(f64::NAN);
    let slot = Time((millis * 1000.0).round() as i64);
    // An hour is longer than any slot that still makes sense; beyond it the answer is surely a mistake.
    if !millis.is_finite() || slot < Time(1) || slot > Time::from_millis(3_600_000) {
        return Err("expected 0.001 to 3600000 milliseconds".into());
    }
    Ok(slot)
}

/// Most simulated seconds that an option can say.
const MAX_SECONDS: f64 = 1e9;

/// Simulated seconds of an option.
///
/// # Errors
/// What is expected instead.
pub fn parse_seconds(text: &str) -> Result<Time, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && (0.0..=MAX_SECONDS).contains(&seconds) => {
            Ok(Time::from_seconds_ceil(seconds))
        }
        _ => Err("expected 0 to 1e9 seconds".into()),
    }
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
