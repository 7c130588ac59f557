//! A run: ready to start, running, and ended.

use std::path::Path;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::check::Monitor;
use sim_core::record::{Digest, KindSet, Record, Recorder};
use sim_core::simulation::Faults;
use sim_core::spec::{CheckKind, RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::unit;
use sim_core::world::World;
use sim_format::{Diagnostic, InputFile};

use super::finished::{self, Finished};
use super::settings::Settings;
use super::{Error, Options, check};
use crate::check::{self as verdicts, Evidence, Tally};
use crate::executive::interrupt::Interrupt;
use crate::executive::mixed::MixedExecutor;
use crate::executive::program::{Exec, RobotProgram};
use crate::executive::scheduler::{Ended, Limits, RunParts, Scheduler};
use crate::executive::spawn::Spawner;
use crate::files::slashed;
use crate::program::sandbox::{Sandbox, SandboxReport};
use crate::record::frame::{FrameFailures, Frames};
use crate::record::notes::Notes;
use crate::record::report::{Input, Report};
use crate::record::trace::{TraceHeader, TraceRobot};
use crate::record::{EventStore, HintLocations, RecordError, Sink, Sinks};
use crate::robios::console::DEFAULT_OUTPUT_LIMIT;
use crate::robios::robot::Robot;
use crate::scenery::LazyScenery;

/// A run whose programs are loaded and that is ready to start.
pub struct Ready {
    pub(super) options: Options,
    pub(super) settings: Settings,
    pub(super) scene: Arc<SceneSpec>,
    pub(super) scenery: Arc<LazyScenery>,
    pub(super) inputs: Vec<Input>,
    pub(super) frames: Option<Arc<Frames>>,
    pub(super) spawner: Spawner,
    pub(super) world: World,
    pub(super) robots: Vec<Robot>,
    pub(super) tally: Option<Arc<Mutex<Tally>>>,
    pub(super) programs: Vec<Option<RobotProgram>>,
}

/// Callback for mistakes in the meshes and images that cameras need, with the files to which the diagnostics refer.
pub type ReportDiagnostics = dyn FnMut(&[Diagnostic], &[InputFile]) -> Result<(), RecordError> + Send;

/// Observers of a run, besides the run's owner, and the interrupt of the run.
#[derive(Default)]
pub struct Observers {
    /// Receive the record, in this order.
    pub sinks: Vec<Box<dyn Sink>>,
    /// Receives the mistakes in the meshes and images, which are read when the first camera is used.
    pub diagnostics: Option<Box<ReportDiagnostics>>,
    /// Ends the run from any thread.
    pub interrupt: Interrupt,
    /// Collects the source lines to which hints refer, for sinks that show them.
    pub hint_locations: HintLocations,
}

impl Ready {
    /// The scene.
    pub fn scene(&self) -> &Arc<SceneSpec> {
        &self.scene
    }

    /// Settings of the run from the scene and the options.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Scenery for the cameras of the scene.
    pub fn scenery(&self) -> &Arc<LazyScenery> {
        &self.scenery
    }

    /// Height of the body of robot `id` at the start, m; 0 for a robot without legs that is not in the water.
    pub fn start_height(&self, id: RobotId) -> f64 {
        self.world.stance(id).map_or(0.0, |stance| stance.lift)
    }

    /// Destination of the images, scans and layers of the programs, if requested.
    pub fn frames(&self) -> Option<&Arc<Frames>> {
        self.frames.as_ref()
    }

    /// Counter of the events that checks refer to, if there are such checks.
    pub fn tally(&self) -> Option<&Arc<Mutex<Tally>>> {
        self.tally.as_ref()
    }

    /// Every file that determines the run.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// Arguments of `eyesim run` that repeat the run.
    pub fn repeat_arguments(&self) -> Vec<String> {
        repeat_arguments(&self.scene.file, &self.options, &self.settings)
    }

    /// First line of the trace, with the command line that repeats the run.
    pub fn trace_header(&self) -> TraceHeader {
        let robot = |robot: &RobotSpec| TraceRobot {
            id: robot.id.0,
            name: robot.robi.name.clone(),
            program: robot.program_name().to_owned(),
        };
        let packed = |input: &Input| match &self.options.archive {
            Some(archive) => Input { path: archive.packed(&input.path), ..input.clone() },
            None => input.clone(),
        };
        TraceHeader {
            seed: self.settings.seed,
            slot_us: self.settings.slot.0,
            robots: self.scene.robots.iter().map(robot).collect(),
            run: self.repeat_arguments(),
            inputs: self.inputs.iter().map(packed).collect(),
            only: Vec::new(),
        }
    }

    /// Starts the run, paused before its first slot.
    ///
    /// # Errors
    /// [`Error::Start`] if the system lacks the resources for the robots.
    pub fn start(self, observers: Observers) -> Result<Running, Error> {
        let has_scripts = self.scene.checks.iter().any(|check| matches!(check.kind, CheckKind::Script { .. }));
        let events = has_scripts.then(|| EventStore::new(self.trace_header())).transpose().map_err(Error::Start)?;
        let Self { options, settings, scene, scenery, inputs, frames, spawner, world, robots, tally, programs } = self;
        let Observers { sinks, diagnostics, interrupt, hint_locations } = observers;
        let scenery_diagnostics = SceneryDiagnostics {
            scenery: Arc::clone(&scenery),
            is_strict: options.strict,
            report: diagnostics.unwrap_or_else(|| Box::new(|_, _| Ok(()))),
            is_reported: false,
        };
        let frame_failures = frames.map(|frames| Box::new(FrameFailures(frames)) as Box<dyn Sink>);
        let tally_sink = tally.iter().map(|tally| Box::new(Arc::clone(tally)) as Box<dyn Sink>);
        let notes = Arc::new(Mutex::new(Notes::new(hint_locations.clone())));
        let monitor = Monitor::new(&scene, world.walls(), settings.until);
        let events = events.map(|events| Arc::new(Mutex::new(events)));
        let event_sink = events.iter().map(|events| Box::new(Arc::clone(events)) as Box<dyn Sink>);
        let noise = |id: RobotId| robots.get(id.index()).map(|robot| robot.noise().clone()).unwrap_or_default();
        let faults = Faults::new(&scene.faults, settings.seed, settings.until, noise);
        let own_sinks = [Box::new(scenery_diagnostics) as Box<dyn Sink>, Box::new(Arc::clone(&notes))];
        let sinks: Sinks<'_> =
            own_sinks.into_iter().chain(sinks).chain(tally_sink).chain(event_sink).chain(frame_failures).collect();
        let limits = Limits {
            workers: options.worker_count(),
            until: settings.until,
            timeout: options.timeout,
            is_verbose: options.is_verbose,
            linger: options.linger,
        };
        let program_count = programs.iter().flatten().count();
        let parts = RunParts {
            world,
            monitor,
            faults,
            executor: Box::new(MixedExecutor::new(robots.len(), program_count, limits.workers)),
            robots,
            programs,
            spawner,
            costs: settings.costs.clone(),
            forbidden: settings.forbidden.clone(),
            recorder: Recorder::new(settings.seed, settings.slot, sinks.interest()),
            sinks,
            hint_locations,
            interrupt: interrupt.clone(),
        };
        let scheduler = Scheduler::start(parts, &limits).map_err(Error::Start)?;
        let sandbox = options.sandbox.as_ref().map(Sandbox::report);
        let judging = Judging { sandbox, tally, notes, events, interrupt, may_run_checks: options.may_run_checks };
        Ok(Running { scheduler, settings, scene, scenery, inputs, judging })
    }

    /// Starts the run and advances it to its end.
    ///
    /// # Errors
    /// See [`Ready::start`].
    pub fn run(self) -> Result<Finished, Error> {
        let mut running = self.start(Observers::default())?;
        running.scheduler.advance_to(Time::NEVER);
        Ok(running.finish())
    }
}

/// Arguments of `eyesim run` that repeat the run: everything that determines its results.
fn repeat_arguments(scene: &str, options: &Options, settings: &Settings) -> Vec<String> {
    /// Maximum time in seconds that the command line accepts.
    const MAX_SECONDS: f64 = 1e9;
    let mut words = vec![scene.to_owned()];
    // Option and value are one word, so that a value is never mistaken for an option.
    let mut add = |option: &str, value: &dyn std::fmt::Display| words.push(format!("--{option}={value}"));
    add("seed", &settings.seed);
    add("slot", &(settings.slot.seconds() * 1000.0));
    add("until", &settings.until.seconds().min(MAX_SECONDS));
    if options.linger > Time::ZERO {
        add("linger", &options.linger.seconds().min(MAX_SECONDS));
    }
    options.programs.iter().for_each(|program| add("program", program));
    options.api.iter().for_each(|api| add("api", &api.number()));
    options.dialect.iter().for_each(|dialect| add("dialect", &dialect.word()));
    options.maze_cell.iter().for_each(|cell| add("maze-cell", &unit::mm_from_metres(*cell)));
    options.settings.iter().for_each(|setting| add("set", setting));
    options.keys.iter().for_each(|keys| add("keys", keys));
    options.stdin.iter().for_each(|path| add("stdin", &slashed(path)));
    options.arguments.iter().for_each(|arguments| add("args", arguments));
    options.costs.iter().for_each(|costs| add("costs", &slashed(costs)));
    options.forbid.iter().for_each(|functions| add("forbid", functions));
    options.checks.iter().for_each(|suite| add("checks", &slashed(suite)));
    options.noise.iter().for_each(|noise| add("noise", noise));
    options.contact.iter().for_each(|contact| add("contact", &contact.word()));
    if options.exec == Exec::Process && options.sandbox.is_none() {
        add("exec", &"process");
    }
    options.sandbox.iter().for_each(|sandbox| words.push(format!("--sandbox={}", sandbox.level().word())));
    if options.output_limit != DEFAULT_OUTPUT_LIMIT {
        words.push(format!("--output-limit={}", options.output_limit as f64 / 1e6));
    }
    if options.allow_execute {
        words.push("--allow-execute".to_owned());
    }
    options.archive.iter().for_each(|archive| words.iter_mut().for_each(|word| *word = archive.packed(word)));
    words
}

/// A run that has started. Its owner advances [`Running::scheduler`], and can read world and robots between two slots.
pub struct Running {
    /// Advances the run.
    pub scheduler: Scheduler,
    settings: Settings,
    scene: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    inputs: Vec<Input>,
    judging: Judging,
}

/// Data for judging a run, in addition to its motion.
struct Judging {
    sandbox: Option<SandboxReport>,
    tally: Option<Arc<Mutex<Tally>>>,
    notes: Arc<Mutex<Notes>>,
    /// Events for the programs of checks.
    events: Option<Arc<Mutex<EventStore>>>,
    interrupt: Interrupt,
    /// The programs of checks may run.
    may_run_checks: bool,
}

/// A run that has ended and is not yet judged.
pub struct EndedRun {
    ended: Ended,
    settings: Settings,
    scene: Arc<SceneSpec>,
    scenery: Arc<LazyScenery>,
    inputs: Vec<Input>,
    judging: Judging,
}

impl Running {
    /// Ends the run, completes its record and judges it by the checks of its scene.
    pub fn finish(self) -> Finished {
        self.end().judge()
    }

    /// Ends the run and completes its record. Before [`EndedRun::judge`] starts the programs of checks, the caller can
    /// end processes that the robots' programs have left running.
    pub fn end(self) -> EndedRun {
        let Self { scheduler, settings, scene, scenery, inputs, judging } = self;
        EndedRun { ended: scheduler.finish(), settings, scene, scenery, inputs, judging }
    }
}

impl EndedRun {
    /// Judges the run by the checks of its scene.
    pub fn judge(self) -> Finished {
        let Self { ended, settings, scene, scenery, mut inputs, judging } = self;
        let Judging { sandbox, tally, notes, events, interrupt, may_run_checks } = judging;
        if let Some(built) = scenery.built() {
            let files = built.inputs.iter().map(|file| Input::new(Path::new(&file.path), &file.bytes));
            let new: Vec<Input> = files.filter(|file| inputs.iter().all(|known| known.path != file.path)).collect();
            inputs.extend(new);
        }
        let notes = std::mem::take(&mut *notes.lock());
        let report = finished::report(&settings, &scene, &ended, inputs, &notes);
        let checks = {
            let environment = ended.run.environment.read();
            let findings = environment.monitor().into_iter().flat_map(Monitor::findings);
            let tally = tally.as_ref().map(|tally| tally.lock());
            let evidence = events.as_deref().map(|events| Evidence { events, interrupt: &interrupt, may_run_checks });
            let mut checks = verdicts::results(&scene.checks, findings, tally.as_deref(), &report, evidence);
            for (index, series) in environment.monitor().into_iter().flat_map(Monitor::series) {
                checks[index].series = Some(series.to_vec());
            }
            checks
        };
        let report = Report { sandbox, ..report.with_checks(checks) };
        let remarks = notes.remarks.into_iter().chain(finished::remarks_on_idle_programs(&ended, &report)).collect();
        Finished { settings, scene, scenery, ended, report, remarks }
    }
}

/// Sink that reports mistakes in the meshes and images that cameras need, at the end of the slot in which a camera is
/// first used. Ends the run if the scene is rejected because of these mistakes.
struct SceneryDiagnostics {
    scenery: Arc<LazyScenery>,
    is_strict: bool,
    report: Box<ReportDiagnostics>,
    is_reported: bool,
}

impl Sink for SceneryDiagnostics {
    fn interest(&self) -> KindSet {
        KindSet::NONE
    }

    fn record(&mut self, _: &Record<'_>) -> Result<(), RecordError> {
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        let Some(built) = self.scenery.built().filter(|_| !self.is_reported) else { return Ok(()) };
        self.is_reported = true;
        if built.diagnostics.is_empty() {
            return Ok(());
        }
        (self.report)(&built.diagnostics, &self.scenery.inputs())?;
        let is_rejected = check::is_rejected(&built.diagnostics, self.is_strict);
        if is_rejected { Err(RecordError::Strict(check::count(&built.diagnostics))) } else { Ok(()) }
    }
}
