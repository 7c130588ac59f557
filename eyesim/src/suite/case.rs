//! A case of a suite, and its run in this process.

use std::collections::{BTreeMap, VecDeque};
use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use sim_core::build;
use sim_core::record::{Digest, Event, Kind, KindSet, Outcome, Record, digest};
use sim_core::time::Time;
use sim_format::suite::check_of_suite;
use sim_format::{Diagnostic, Severity};
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::fork::processor_seconds;
use sim_host::executive::interrupt::Interrupt;
use sim_host::executive::scheduler;
use sim_host::executive::subreaper::Subreaper;
use sim_host::files::slashed;
use sim_host::launch::{BuiltScene, Error, Finished, Observers, Options, ProgramCache, Rejected, Scene};
use sim_host::program::Builder;
use sim_host::program::load::Loader;
use sim_host::record::report::{CheckReport, Input};
use sim_host::record::trail::BodyTrails;
use sim_host::record::{self, RecordError, Sink, Trails};

use super::Suite;
use super::row::{CaseResult, ROW_SCHEMA, Row, RowOutcome, RowRobot, Trace};

/// A case: everything that determines its row, except the contents of files.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name: the settings, such as `noise=real,seed=3`.
    pub name: String,
    /// Name without the seed.
    pub variant: String,
    /// Path of the scene.
    pub scene: PathBuf,
    /// Options of the run.
    pub options: Options,
    /// Settings of the matrix.
    pub settings: Vec<(String, String)>,
}

/// State that the cases of one process share: built programs and mapped libraries.
pub struct Session {
    builder: Builder,
    programs: ProgramCache,
    loader: Option<Loader>,
    subreaper: Option<Subreaper>,
    /// Files that cases have read, with their digests.
    inputs: BTreeMap<String, String>,
    /// Policy for keeping traces; by default none are kept.
    pub keep: Keep,
    /// Ends the running case.
    pub interrupt: Interrupt,
}

/// Policy for keeping traces, as `KEY.jsonl.zst` in an existing folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// No traces are kept.
    #[default]
    None,
    /// Traces of cases that do not pass are kept.
    Failed(PathBuf),
    /// All traces are kept.
    All(PathBuf),
}

impl Keep {
    /// Path of the unfinished trace of the case with this key; `None` if no traces are kept.
    fn temporary_path(&self, key: &str) -> Option<PathBuf> {
        match self {
            Self::None => None,
            Self::Failed(folder) | Self::All(folder) => Some(folder.join(format!("{key}.part.jsonl.zst"))),
        }
    }

    /// Keeps or removes the trace of a finished case.
    fn keep_or_remove(&self, key: &str, outcome: RowOutcome) -> io::Result<()> {
        let Some(part) = self.temporary_path(key) else { return Ok(()) };
        let is_kept = match outcome {
            RowOutcome::Interrupted => false,
            RowOutcome::Passed => matches!(self, Self::All(_)),
            RowOutcome::Failed | RowOutcome::Error => true,
        };
        if is_kept { fs::rename(&part, part.with_file_name(format!("{key}.jsonl.zst"))) } else { fs::remove_file(part) }
    }
}

impl Session {
    /// A session that builds programs with `builder`.
    pub fn new(builder: Builder, interrupt: Interrupt) -> Self {
        Self {
            builder,
            programs: ProgramCache::default(),
            loader: None,
            subreaper: None,
            inputs: BTreeMap::new(),
            keep: Keep::None,
            interrupt,
        }
    }

    /// Builds the programs of a case. Returns true if the programs may share a process with other cases, because all of
    /// them run on fibers.
    ///
    /// # Errors
    /// [`PrepareError`].
    pub fn prepare(&mut self, suite: &Suite, case: &Case) -> Result<bool, PrepareError> {
        match self.build(suite, case) {
            Ok(built) => Ok(built.uses_only_fibers()),
            Err(Failure { is_build_failure: false, .. }) => Err(PrepareError::Scene),
            Err(failure) => Err(PrepareError::Programs(Box::new(failure.result(suite, case)))),
        }
    }

    /// Hash of everything that determines the row of a case: its [`Row::key`].
    ///
    /// # Errors
    /// The result of a case that cannot be run because a file cannot be read or a program cannot be built.
    pub fn key(&mut self, suite: &Suite, case: &Case) -> Result<String, Box<CaseResult>> {
        match self.build(suite, case) {
            Ok(built) => Ok(key_of(suite, case, built.inputs())),
            Err(failure) => Err(Box::new(failure.result(suite, case))),
        }
    }

    /// Removes the observer of builds.
    pub(super) fn end_building(&mut self) {
        self.builder.remove_observer();
    }

    /// Forgets the mapped libraries, and removes their files.
    pub fn unload(&mut self) {
        self.loader = None;
    }

    fn build(&mut self, suite: &Suite, case: &Case) -> Result<BuiltScene, Failure> {
        let mut scene = Scene::open(&case.scene, case.options.clone())?;
        let check_diagnostics = check_of_suite(&suite.spec, scene.spec());
        let diagnostics = scene.diagnostics().iter().chain(&check_diagnostics);
        if let Some(first) = diagnostics.clone().find(|diagnostic| diagnostic.severity == Severity::Error) {
            let details = diagnostics.map(Diagnostic::to_string).collect::<Vec<_>>().join("\n");
            return Err(Failure { message: first.to_string(), details, is_build_failure: false });
        }
        if scene.spec().robots.is_empty() {
            return Err(Failure::of("the scene has no robots"));
        }
        scene.spec_mut().checks.extend(suite.spec.checks.iter().cloned());
        let built = scene.build_with(&self.builder, &mut self.programs)?;
        for Input { path, sha256 } in built.inputs() {
            if self.inputs.entry(path.clone()).or_insert_with(|| sha256.clone()) != sha256 {
                return Err(Failure::of(format!(
                    "`{path}` has changed since the first case: later cases would differ"
                )));
            }
        }
        Ok(built)
    }
}

/// Reasons why the programs of a case are not built.
#[derive(Debug)]
pub enum PrepareError {
    /// The scene cannot be used, perhaps only with the seed of this case.
    Scene,
    /// A program cannot be built. Contains the result of the case.
    Programs(Box<CaseResult>),
}

/// Reason why a case cannot be run.
struct Failure {
    message: String,
    details: String,
    is_build_failure: bool,
}

impl Failure {
    fn of(text: impl ToString) -> Self {
        let text = text.to_string();
        let is_long = text.lines().nth(1).is_some();
        // A compiler's first line names only the location, and a linker's last line says only that it failed.
        let find =
            |part: &str| text.lines().find(|line| is_long && line.contains(part) && !line.contains("ld returned"));
        let linker_error = || find("multiple definition of").or_else(|| find("undefined reference to"));
        let first = find(" error: ").or_else(linker_error).or(text.lines().next());
        let message = first.unwrap_or_default().trim().to_owned();
        let details = if is_long { text } else { String::new() };
        Self { message, details, is_build_failure: false }
    }

    fn result(self, suite: &Suite, case: &Case) -> CaseResult {
        let row =
            Row { outcome: RowOutcome::Error, message: self.message, details: self.details, ..row_of(suite, case) };
        CaseResult { row, real_time_s: 0.0, traces: Vec::new(), output: Vec::new() }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match &error {
            Error::Rejected(Rejected { diagnostics, .. }) => {
                let details = diagnostics.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n");
                let first = diagnostics.iter().max_by_key(|diagnostic| diagnostic.severity);
                let message = first.map_or_else(|| error.to_string(), Diagnostic::to_string);
                Self { message, details, is_build_failure: false }
            }
            Error::Programs(_) => Self { is_build_failure: true, ..Self::of(error) },
            _ => Self::of(error),
        }
    }
}

/// Row of a case that has not been run.
pub(super) fn row_of(suite: &Suite, case: &Case) -> Row {
    let points: f64 = suite.spec.checks.iter().map(|check| check.points).sum();
    Row {
        schema: ROW_SCHEMA,
        key: String::new(),
        suite: suite.spec.file.clone(),
        case: case.name.clone(),
        variant: case.variant.clone(),
        scene: slashed(&case.scene),
        seed: case.options.seed.unwrap_or_default(),
        settings: case.settings.clone(),
        outcome: RowOutcome::Error,
        message: String::new(),
        details: String::new(),
        at_s: None,
        x_m: None,
        y_m: None,
        points: 0.0,
        max_points: points,
        checks: Vec::new(),
        robots: Vec::new(),
        sim_time_s: 0.0,
        digest: None,
        words: Vec::new(),
    }
}

/// Result of a case that could not be run to its end, with `message` as the reason.
pub(crate) fn unfinished_case_result(suite: &Suite, case: &Case, message: &str) -> CaseResult {
    Failure::of(message).result(suite, case)
}

/// Runs a case in this process.
pub fn run_case(suite: &Suite, case: &Case, session: &mut Session) -> CaseResult {
    let start = Instant::now();
    match try_run(suite, case, session) {
        Ok(result) => CaseResult { real_time_s: start.elapsed().as_secs_f64(), ..result },
        Err(failure) => failure.result(suite, case),
    }
}

/// Interval at which the processor time of a case is compared with its limit.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

fn try_run(suite: &Suite, case: &Case, session: &mut Session) -> Result<CaseResult, Failure> {
    let built = session.build(suite, case)?;
    let key = key_of(suite, case, built.inputs());
    if !built.uses_only_fibers() && session.subreaper.is_none() {
        session.subreaper = Some(Subreaper::start());
    }
    let loader = match session.loader.take() {
        Some(loader) => loader,
        None => Loader::new().map_err(Failure::of)?,
    };
    let ready = built.load_with(session.loader.insert(loader))?;
    let mut words = ready.repeat_arguments();
    if !suite.spec.checks.is_empty() {
        let file = suite.archive.as_ref().map_or(suite.spec.file.clone(), |archive| archive.packed(&suite.spec.file));
        words.push(format!("--checks={file}"));
    }
    let scene = Arc::clone(ready.scene());
    let starts: Vec<_> = scene.robots.iter().map(|robot| robot.start).collect();
    let objects: Vec<_> = build::movable_objects(&scene).map(|object| object.pose).collect();
    let trails = Arc::new(Mutex::new(Trails::new(&starts, &objects)));
    let output = Arc::new(Mutex::new(Output::default()));
    let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&trails)), Box::new(Arc::clone(&output))];
    if let Some(part) = session.keep.temporary_path(&key) {
        sinks.push(Box::new(record::TraceFile::create(&part, &ready.trace_header()).map_err(Failure::of)?));
    }
    let observers = Observers { sinks, interrupt: session.interrupt.clone(), ..Observers::default() };
    let start_seconds = processor_seconds();
    let mut running = ready.start(observers)?;
    let mut is_over_limit = false;
    while running.scheduler.advance_within(Time::NEVER, CHECK_INTERVAL) == scheduler::Progress::Paused
        && running.scheduler.boundary().next_within_limit().is_some()
    {
        if processor_seconds() - start_seconds > suite.spec.limits.processor {
            is_over_limit = true;
            running.scheduler.interrupt();
            break;
        }
    }
    let ended_run = running.end();
    // Programs of checks run only after all processes that the robot programs have started have ended.
    session.subreaper.iter().for_each(|subreaper| _ = subreaper.end_all());
    let finished = ended_run.judge();
    let limit = is_over_limit.then_some(suite.spec.limits.processor);
    let mut row = Row { key, words, ..judge(suite, case, &finished, limit) };
    if session.interrupt.is_set() && row.checks.iter().any(|check| check.broken) {
        (row.outcome, row.message) = (RowOutcome::Interrupted, "interrupted".to_owned());
    }
    session
        .keep
        .keep_or_remove(&row.key, row.outcome)
        .map_err(|error| Failure::of(format!("its trace is lost: {error}")))?;
    let is_shown = row.outcome != RowOutcome::Passed;
    let trace = |(index, trail): (usize, &BodyTrails)| {
        let points = |line: Vec<glam::DVec2>| line.into_iter().map(|point| point.to_array()).collect();
        Trace { robot: index as u32 + 1, lines: trail.lines().into_iter().map(points).collect() }
    };
    let traces = if is_shown { trails.lock().trails().iter().enumerate().map(trace).collect() } else { Vec::new() };
    let output = if is_shown { output.lock().lines.iter().cloned().collect() } else { Vec::new() };
    Ok(CaseResult { row, real_time_s: 0.0, traces, output })
}

/// Judges a finished run; `limit` is the limit of processor time if the run exceeded it.
fn judge(suite: &Suite, case: &Case, finished: &Finished, limit: Option<f64>) -> Row {
    let Finished { ended, report, settings, .. } = finished;
    let failed_robot = report.robots.iter().find(|robot| robot.outcome.is_failure());
    let broken_check = report.checks.iter().find(|check| check.broken);
    // The earliest failure is taken as the cause of later ones. Of several failures at one instant, a missed goal is
    // taken last, since the others are its cause.
    let instant = |check: &CheckReport| check.at_s.unwrap_or(f64::INFINITY);
    let is_goal = |check: &CheckReport| check.kind == "reach";
    let failed_checks = report.checks.iter().filter(|check| !check.passed);
    let by_cause =
        |a: &&CheckReport, b: &&CheckReport| instant(a).total_cmp(&instant(b)).then(is_goal(a).cmp(&is_goal(b)));
    let failed_check = broken_check.or(failed_checks.min_by(by_cause));
    let robot_message = failed_robot.map(|robot| {
        let reason = robot.reason.as_deref().unwrap_or(robot.outcome.name());
        format!("r{} (`{}`) {reason}", robot.id, robot.program)
    });
    let check_message = failed_check.map(|check| format!("{}: {}", check.name, check.message));
    let (outcome, message) = match &ended.end {
        _ if let Some(limit) = limit => {
            (RowOutcome::Failed, format!("the case has used {limit} s of processor time (`processor_s` of `[limits]`)"))
        }
        EndReason::Interrupted => (RowOutcome::Interrupted, "interrupted".to_owned()),
        EndReason::Record(error) => (RowOutcome::Error, error.to_string()),
        _ if let (Some(_), Some(message)) = (broken_check, &check_message) => (RowOutcome::Error, message.clone()),
        _ => match (robot_message, check_message) {
            (Some(message), _) | (None, Some(message)) => (RowOutcome::Failed, message),
            (None, None) => (RowOutcome::Passed, String::new()),
        },
    };
    // How far a program got before it was stopped for its processor time depends on the machine.
    let is_timed_out = limit.is_some() || report.robots.iter().any(|robot| robot.outcome == Outcome::Timeout);
    let failure_time = failed_check.and_then(|check| check.at_s);
    let failure_time = failure_time.or(failed_robot.filter(|_| limit.is_none()).map(|robot| match robot.outcome {
        // A program that hangs does so within a slot, at an instant that may depend on the machine.
        Outcome::Timeout => (robot.virtual_time_s / settings.slot.seconds() + 1e-9).floor() * settings.slot.seconds(),
        _ => robot.virtual_time_s,
    }));
    // The robots' poses are from the end of the run, not from the instant of a check.
    let robot_position = failed_robot.or(report.robots.first()).map(|robot| (robot.pose.x_m, robot.pose.y_m));
    let position = match failed_check {
        Some(check) if check.at_s.is_some() => check.x_m.zip(check.y_m),
        _ => robot_position,
    };
    let position = position.filter(|_| outcome != RowOutcome::Passed && !is_timed_out);
    let robots = report.robots.iter().map(|robot| RowRobot {
        id: robot.id,
        program: robot.program.clone(),
        outcome: robot.outcome,
        reason: robot.reason.clone(),
        metrics: robot.metrics.clone(),
        forbidden_calls: robot.forbidden_calls.clone(),
    });
    Row {
        outcome,
        message,
        seed: settings.seed,
        at_s: failure_time.filter(|_| outcome != RowOutcome::Passed),
        x_m: position.map(|position| position.0),
        y_m: position.map(|position| position.1),
        points: if failed_robot.is_some() || limit.is_some() { 0.0 } else { report.points },
        max_points: report.max_points,
        checks: report.checks.clone(),
        robots: robots.collect(),
        sim_time_s: if limit.is_some() { 0.0 } else { report.sim_time_s },
        digest: (!is_timed_out).then(|| report.digest.to_string()),
        ..row_of(suite, case)
    }
}

/// Hash of everything that determines the row of a case. It is independent of the path of the suite's folder.
fn key_of(suite: &Suite, case: &Case, inputs: &[Input]) -> String {
    let folder = suite.spec.folder.trim_end_matches('/');
    let in_folder = |path: &str| match folder {
        "" => (!path.starts_with('/') && !path.starts_with("../")).then(|| path.to_owned()),
        _ => Some(path.strip_prefix(folder)?.strip_prefix('/')?.to_owned()),
    };
    let relative_name = |text: &str| in_folder(text).unwrap_or_else(|| text.to_owned());
    let noise = case.options.noise.as_deref().map(relative_name);
    let Options { seed, slot, until, linger, keys, arguments, settings, programs, forbid, .. } = &case.options;
    let mut hasher = blake3::Hasher::new();
    let mut add = |text: String| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    add(format!("eyesim {} {ROW_SCHEMA} {}", env!("CARGO_PKG_VERSION"), digest::VERSION));
    add(format!("{seed:?} {slot:?} {until:?} {linger:?} {keys:?} {arguments:?} {noise:?}"));
    settings.iter().for_each(|setting| add(setting.to_string()));
    programs.iter().for_each(|program| add(program.with_program(&relative_name(program.program())).to_string()));
    forbid.iter().for_each(|functions| add(format!("forbid {functions}")));
    add(format!("{} {:?}", suite.checks_text, suite.spec.limits));
    // Files elsewhere, such as those of the installation, are named without their folders.
    let name = |path: &str| in_folder(path).unwrap_or_else(|| path.rsplit('/').next().unwrap_or_default().to_owned());
    let mut files: Vec<String> = inputs.iter().map(|input| format!("{} {}", name(&input.path), input.sha256)).collect();
    files.sort_unstable();
    files.into_iter().for_each(add);
    hasher.finalize().to_hex()[..32].to_owned()
}

/// Sink that keeps the last lines that programs print.
#[derive(Default)]
struct Output {
    lines: VecDeque<String>,
}

/// Maximum number of lines kept.
const MAX_LINES: usize = 40;
/// Maximum number of characters kept of a line.
const MAX_LINE: usize = 400;

impl Sink for Output {
    fn interest(&self) -> KindSet {
        KindSet::of(&[Kind::Stdout, Kind::Stderr])
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        if let Event::Stdout { text } | Event::Stderr { text } = &record.event {
            for line in text.lines() {
                if self.lines.len() == MAX_LINES {
                    self.lines.pop_front();
                }
                self.lines.push_back(format!("{}: {}", record.robot, line.chars().take(MAX_LINE).collect::<String>()));
            }
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}
