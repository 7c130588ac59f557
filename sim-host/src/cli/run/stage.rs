//! From what the arguments name to a run that is over: read, built, loaded, run.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use parking_lot::Mutex;
use sim_core::spec::{CostsRef, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_format::{Diagnostic, Files, InputFile, Severity, decode, is_scene, load_scene_with};

use super::outcome::{Ran, report};
use super::sink::{recording, sinks, trace_header};
use super::{DEFAULT_UNTIL, RunArgs, Speed};
use crate::cli::check;
use crate::cli::diagnostic::{self, Colour, Format};
use crate::cli::options::{Options, give_noise};
use crate::cli::output;
use crate::cli::progress::{Building, Counts, Progress};
use crate::executive::interrupt::Interrupt;
use crate::executive::pace::Pace;
use crate::executive::program::RobotProgram;
use crate::executive::run::Run;
use crate::executive::scheduler::{self, Limits, Parts, Scheduler};
use crate::executive::script::Script;
use crate::executive::thread::ThreadExecutor;
use crate::files::{DiskFiles, slashed};
use crate::plot;
use crate::program::{Builder, Cache, Kits, SearchPath, Tools};
use crate::record::frame::{FrameFailures, Frames};
use crate::record::report::Input;
use crate::record::{RecordError, Recorded, Sink, Sinks, Trace, Trails};
use crate::robios::robot::Robot;
use crate::scenery::LazyScenery;
use crate::setup::{Programs, RobotOptions};
use crate::workshop::Workshop;
use sim_core::record::{Digest, KindSet, Record, Recorder};

/// A scene whose programs have been built.
pub struct Built {
    options: Options,
    scene: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    pub(super) programs: Programs,
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

/// A run that has started.
pub struct Running {
    /// What advances it.
    pub scheduler: Scheduler,
    progress: Progress,
    options: Options,
    scene: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    inputs: Vec<Input>,
    trails: Option<Arc<Mutex<Trails>>>,
}

/// Who watches a run beside its user.
#[derive(Default)]
pub struct Company {
    /// Who else wants to see its records.
    pub sinks: Vec<Box<dyn Sink>>,
    /// When it ends where neither the user nor the scene says it.
    pub until: Option<Time>,
    /// Where the messages of its programs and its progress go.
    pub is_quiet: bool,
    /// Who ends it early.
    pub interrupt: Interrupt,
}

/// Shows what is wrong with the scene, and refuses to run it if it is an error or, when `strict`, anything.
pub(in crate::cli) fn tell(diagnostics: &[Diagnostic], inputs: &[InputFile], strict: bool) -> anyhow::Result<()> {
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

    /// Starts it: what is recorded has its first line, and the run stands before its first slot.
    ///
    /// # Errors
    /// Files that cannot be written, and a system without room for the robots.
    pub fn start(self, args: &RunArgs, company: Company) -> anyhow::Result<Running> {
        let Self { built, programs: loaded } = self;
        let Built { options, scene, scenery, programs, inputs, frames, workshop, world, robots } = built;
        let until = options.until.or(company.until).unwrap_or(Time::from_seconds_ceil(DEFAULT_UNTIL));
        let is_hidden = args.verbose || args.quiet || company.is_quiet;
        let progress = if is_hidden { Progress::hidden() } else { Progress::new(until) };
        let (mut all, trails) = sinks(args, &options, &scene, &progress);
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
        let sinks: Sinks<'_> = all.into_iter().collect();
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
            recorder: Recorder::new(options.seed, options.slot, sinks.interest()),
            sinks,
            interrupt: company.interrupt,
        };
        let scheduler = Scheduler::start(parts, &limits).context("cannot start the robots")?;
        Ok(Running { scheduler, progress, options, scene, scenery, inputs, trails })
    }
}

impl Running {
    /// How long the run goes on between two looks at its progress.
    const STRETCH: Duration = Duration::from_millis(50);

    /// Takes the run to its end as `script` has it.
    pub fn follow(&mut self, script: &mut Script) {
        while script.advance(&mut self.scheduler, Self::STRETCH) == scheduler::Progress::Paused {
            let run = self.scheduler.run();
            self.progress.update(run.slot_start(), || counts(run));
        }
    }

    /// Ends it, to the last line of its report.
    pub fn finish(self) -> Ran {
        let Self { scheduler, mut progress, options, scene, scenery, mut inputs, trails } = self;
        let ended = scheduler.finish();
        progress.clear();
        if let Some(built) = scenery.built() {
            let files = built.inputs.iter().map(|file| Input::new(Path::new(&file.path), &file.bytes));
            let new: Vec<Input> = files.filter(|file| inputs.iter().all(|known| known.path != file.path)).collect();
            inputs.extend(new);
        }
        let report = report(&options, &scene, &ended, inputs);
        Ran { options, scene, scenery, ended, report, trails }
    }
}

/// The pace and the recorded actions that the arguments ask for.
///
/// # Errors
/// A trace that cannot be read.
pub(super) fn script(args: &RunArgs) -> anyhow::Result<Script> {
    let pace = match args.speed {
        Speed::Max => None,
        Speed::Factor(factor) => Some(Pace::new(factor)),
    };
    let actions = args.repeat.as_ref().map(|trace| Recorded::read(trace).context("--repeat")).transpose()?;
    Ok(Script::new(actions.into_iter().flat_map(|recorded| recorded.interventions)).paced(pace))
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

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
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

/// Those of the options that the user has given.
pub(super) fn given<'a>(options: &[(&'a str, &'a Option<PathBuf>)]) -> Vec<(&'a str, &'a Path)> {
    options.iter().filter_map(|(option, path)| Some((*option, path.as_deref()?))).collect()
}
