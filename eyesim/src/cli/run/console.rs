//! Steps of a run from the command line: open, build, start, advance, finish, with the output for the user.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use accuracy::figure::{Figure, Mark, Scale, Series};
use anyhow::{Context, bail, ensure};
use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::spec::{CheckKind, SceneSpec, SwarmMetric};
use sim_format::{Code, Diagnostic, InputFile};
use sim_host::executive::interrupt::{self, Interrupt};
use sim_host::executive::pace::Pace;
use sim_host::executive::program::Exec;
use sim_host::executive::run::Run;
use sim_host::executive::scheduler::{self, Scheduler};
use sim_host::executive::script::Script;
use sim_host::files::slashed;
use sim_host::launch::settings::index_of;
use sim_host::launch::{BuiltScene, Error, Finished, Observers, OptionError, Ready, Rejected, Running, Scene, check};
use sim_host::record::log::{Filter, Pattern};
use sim_host::record::report::Input;
use sim_host::record::trace::TraceHeader;
use sim_host::record::{Log, RecordError, Recorded, Report, Sink, TraceFile, Trails};
use sim_host::robios::forbidden;

use super::{RunArgs, Speed};
use crate::cli::diagnostic::{self, Colour, Format};
use crate::cli::output::{self, given_outputs, print, print_error, say};
use crate::cli::progress::{Building, Counts, Progress};
use crate::plot;

/// Opens the scene of the arguments and shows its diagnostics.
///
/// # Errors
/// If files or arguments are wrong; [`Rejected`] if diagnostics reject the scene.
pub fn open(args: &RunArgs) -> anyhow::Result<Scene> {
    let scene = Scene::open(&args.sim, args.options())?;
    report_diagnostics(scene.diagnostics(), scene.inputs(), args.strict)?;
    if args.verbose {
        scene.notes().iter().for_each(say);
    }
    if let Some(dialect) = scene.guessed_dialect().filter(|_| !args.quiet) {
        say(format_args!(
            "`{}` is written for EyeSim VR of 2018 (`robi` or `obj` loads a type): --dialect={} is used, --dialect=vr2023 selects today's conventions",
            args.sim.display(),
            dialect.word()
        ));
    }
    Ok(scene)
}

/// Builds the programs of a scene, with progress on a terminal, and checks the output files of the run.
///
/// # Errors
/// If files or arguments are wrong; [`Rejected`] if diagnostics reject the scene.
pub fn build(scene: Scene, args: &RunArgs) -> anyhow::Result<BuiltScene> {
    interrupt::of_process().context("cannot install signal handlers")?;
    let mut builder = scene.builder()?;
    if !args.quiet {
        builder = builder.with_observer(Box::new(Building::on_stderr()));
    }
    let built = scene.build(&builder).inspect_err(|error| {
        if let Error::Rejected(Rejected { diagnostics, inputs }) = error {
            _ = show(diagnostics, inputs);
        }
    })?;
    check_outputs(args, built.inputs())?;
    built.remarks().iter().for_each(say);
    if args.verbose || args.exec() != Exec::Auto {
        built.placement_remarks().iter().for_each(say);
    }
    Ok(built)
}

/// Shows the diagnostics of a scene; rejects the scene if there are errors or, when `strict`, warnings.
pub(in crate::cli) fn report_diagnostics(
    diagnostics: &[Diagnostic],
    inputs: &[InputFile],
    strict: bool,
) -> anyhow::Result<()> {
    if !diagnostics.is_empty() {
        show(diagnostics, inputs)?;
    }
    if check::is_rejected(diagnostics, strict) {
        bail!(Error::Rejected(Rejected { diagnostics: diagnostics.to_vec(), inputs: inputs.to_vec() }));
    }
    Ok(())
}

/// Shows diagnostics on standard error: of each code in each file only the first few, and the number of the others.
fn show(diagnostics: &[Diagnostic], inputs: &[InputFile]) -> anyhow::Result<()> {
    /// Maximum number of diagnostics with one code in one file.
    const MAX_ALIKE: usize = 20;
    let mut counts: BTreeMap<(&str, Code), usize> = BTreeMap::new();
    let mut shown: Vec<Diagnostic> = Vec::new();
    for diagnostic in diagnostics {
        let count = counts.entry((&diagnostic.file, diagnostic.code)).or_default();
        *count += 1;
        if *count <= MAX_ALIKE {
            shown.push(diagnostic.clone());
        }
    }
    let screen = diagnostic::Screen::of_stderr(Colour::Auto);
    print_error(&diagnostic::render(&shown, inputs, Format::Auto, screen)?);
    for ((file, code), count) in counts.into_iter().filter(|(_, count)| *count > MAX_ALIKE) {
        say(format_args!("{file}: {} more of {}: `eyesim check` lists them", count - MAX_ALIKE, code.name()));
    }
    Ok(())
}

/// Checks before the run that its output files overwrite no input and lie in existing folders.
fn check_outputs(args: &RunArgs, inputs: &[Input]) -> anyhow::Result<()> {
    let report = args.report_file();
    let outputs = [("--report", &report), ("--trace", &args.trace), ("--record", &args.record), ("--plot", &args.plot)];
    let repeated = args.repeat.as_deref().map(slashed);
    let inputs = inputs.iter().map(|input| input.path.as_str()).chain(repeated.as_deref());
    output::check_outputs(&given_outputs(&outputs), inputs)?;
    args.plot.as_deref().map(plot::PictureKind::of).transpose().context("--plot")?;
    Ok(())
}

/// A run with its output for the user.
pub struct ConsoleRun {
    running: Running,
    progress: Progress,
    trails: Option<Arc<Mutex<Trails>>>,
}

impl ConsoleRun {
    /// Interval between two updates of the progress.
    const PROGRESS_INTERVAL: Duration = Duration::from_millis(50);

    /// Starts `ready` with the output files that the arguments name; shows no progress if `is_quiet`.
    ///
    /// # Errors
    /// If a file cannot be written, or the system lacks resources for the robots.
    pub fn start(ready: Ready, args: &RunArgs, observers: Observers, is_quiet: bool) -> anyhow::Result<Self> {
        let is_hidden = args.verbose || args.quiet || is_quiet;
        let progress = if is_hidden { Progress::hidden() } else { Progress::new(ready.settings().until) };
        let mut sinks: Vec<Box<dyn Sink>> = Vec::new();
        if !args.is_silent {
            let out = if args.prints_report() { progress.stderr() } else { progress.stdout() };
            let log = Log::new(filter(args, ready.scene())?, out, progress.stderr());
            sinks.push(Box::new(log.with_hint_locations(observers.hint_locations.clone())));
        }
        let trails = args.plot.is_some().then(|| Arc::new(Mutex::new(Trails::of_scene(ready.scene()))));
        sinks.extend(trails.iter().map(|trails| Box::new(Arc::clone(trails)) as Box<dyn Sink>));
        sinks.extend(interrupt::outside_of_run(|| create_files(&ready, args, &observers.interrupt))?);
        sinks.extend(observers.sinks);
        let mut err = progress.stderr();
        let print = move |diagnostics: &[Diagnostic], inputs: &[InputFile]| {
            let screen = diagnostic::Screen::of_stderr(Colour::Auto);
            let text = diagnostic::render(diagnostics, inputs, Format::Auto, screen);
            let written = text.map_err(std::io::Error::other).and_then(|text| err.write_all(text.as_bytes()));
            written.map_err(|source| RecordError::Print { stream: "standard error", source })
        };
        let mut running = ready.start(Observers { sinks, diagnostics: Some(Box::new(print)), ..observers })?;
        if let Some(computing) = progress.computing() {
            running.scheduler.listen_to_computing(computing);
        }
        Ok(Self { running, progress, trails })
    }

    /// Scheduler of the run.
    pub fn scheduler(&mut self) -> &mut Scheduler {
        &mut self.running.scheduler
    }

    /// Advances the run to its end, following `script`.
    pub fn follow(&mut self, script: &mut Script) {
        let scheduler = &mut self.running.scheduler;
        while script.advance(scheduler, Self::PROGRESS_INTERVAL) == scheduler::Progress::Paused {
            let run = scheduler.run();
            self.progress.update(run.slot_start(), || counts(run));
        }
    }

    /// Ends the run, calls `after_end`, and completes the report.
    pub fn finish(self, after_end: impl FnOnce()) -> FinishedRun {
        let Self { running, mut progress, trails } = self;
        let ended_run = running.end();
        after_end();
        let finished = ended_run.judge();
        progress.clear();
        FinishedRun { finished, trails }
    }
}

/// Creates the files that the arguments name for the record of the run.
fn create_files(ready: &Ready, args: &RunArgs, interrupt: &Interrupt) -> anyhow::Result<Vec<Box<dyn Sink>>> {
    ensure!(!interrupt.is_set(), "interrupted before the run");
    let mut sinks: Vec<Box<dyn Sink>> = Vec::new();
    if let Some(path) = &args.trace {
        let only = args.trace_only.as_ref().map(|filter| filter.words().to_vec()).unwrap_or_default();
        sinks.push(Box::new(TraceFile::create(path, &TraceHeader { only, ..ready.trace_header() })?));
    }
    #[cfg(feature = "window")]
    if let Some(path) = &args.record {
        sinks.push(Box::new(super::recording::create(path, ready)?));
    }
    #[cfg(not(feature = "window"))]
    if args.record.is_some() {
        return Err(crate::cli::absent::error("recordings in MCAP"));
    }
    Ok(sinks)
}

/// A finished run, and the trails for its plot.
pub struct FinishedRun {
    /// The run.
    pub finished: Finished,
    trails: Option<Arc<Mutex<Trails>>>,
}

impl FinishedRun {
    /// Writes the report and the plot that the arguments name.
    ///
    /// # Errors
    /// The first error; the remaining files are still written.
    pub fn write_files(&self, args: &RunArgs) -> anyhow::Result<()> {
        let Self { finished, trails } = self;
        if finished.scenery.built().is_some() {
            // Images that cameras loaded during the run are inputs, too.
            let report = args.report_file();
            let outputs = [("--report", &report), ("--plot", &args.plot)];
            output::check_outputs(
                &given_outputs(&outputs),
                finished.report.inputs.iter().map(|input| input.path.as_str()),
            )?;
        }
        let plot = |(path, trails): (&std::path::PathBuf, &Arc<Mutex<Trails>>)| {
            plot::write(&plot::draw_finished(finished, &trails.lock()), path, None)?;
            write_charts(&finished.report, &finished.scene, path)
        };
        let written = [
            args.report.as_ref().map(|path| match args.prints_report() {
                true => print(&finished.report.to_json()?),
                false => Ok(finished.report.write(path)?),
            }),
            args.plot.as_ref().zip(trails.as_ref()).map(plot),
        ];
        written.into_iter().flatten().collect()
    }
}

/// Writes a chart of each swarm metric over time into the folder of the plot at `path`: for `run.svg`, the chart of the
/// check NAME is `run-NAME.svg`. Of charts with the same file name, all but the first have a number at its end.
fn write_charts(report: &Report, scene: &SceneSpec, path: &Path) -> anyhow::Result<()> {
    let mut names = BTreeSet::new();
    for (check, spec) in report.checks.iter().zip(&scene.checks) {
        let (Some(series), CheckKind::Swarm { metric, .. }) = (&check.series, &spec.kind) else { continue };
        // Each value holds until the time of the next.
        let ends = series.iter().skip(1).map(|[time, _]| *time).chain([report.sim_time_s]);
        let points =
            series.iter().zip(ends).flat_map(|([time, value], end)| [(*time, *value), (end, *value)]).collect();
        let label = match metric {
            SwarmMetric::Spread => "mean distance from the middle, m",
            SwarmMetric::Order => "order",
            SwarmMetric::Groups { .. } => "connected groups",
            SwarmMetric::Coverage { .. } => "covered share",
        };
        let figure = Figure {
            name: check.name.clone(),
            title: format!("{}: {}", check.name, check.message),
            x_label: "simulated time, s".to_owned(),
            y_label: label.to_owned(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series: vec![Series { name: check.name.clone(), mark: Mark::Line, points }],
        };
        let name: String = check.name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let name = std::iter::once(name.clone()).chain(numbered).find(|name| names.insert(name.clone()));
        let name = name.unwrap_or_default();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let file = path.with_file_name(format!("{stem}-{name}.svg"));
        std::fs::write(&file, plot::chart::to_svg(&figure)?).with_context(|| format!("`{}`", file.display()))?;
    }
    Ok(())
}

/// Script of a run: the pace and the recorded interventions that the arguments name.
///
/// # Errors
/// If the trace cannot be read.
pub(super) fn script(args: &RunArgs) -> anyhow::Result<Script> {
    let pace = match args.speed {
        Speed::Max => None,
        Speed::Factor(factor) => Some(Pace::new(factor)),
    };
    // A pipe may have no writer yet.
    let read = |trace: &std::path::PathBuf| interrupt::outside_of_run(|| Recorded::read(trace)).context("--repeat");
    let actions = args.repeat.as_ref().map(read).transpose()?;
    Ok(Script::new(actions.into_iter().flat_map(|recorded| recorded.interventions)).paced(pace))
}

/// Filter of the lines shown during the run.
///
/// # Errors
/// If the scene has no such robot, or a pattern matches no function.
pub(super) fn filter(args: &RunArgs, scene: &SceneSpec) -> anyhow::Result<Filter> {
    let robot = args.robot.map(|robot| index_of(scene, robot).context("--robot")).transpose()?;
    let mistakes = args.only.as_deref().map(forbidden::mistakes_with_services).unwrap_or_default();
    if let Some((pattern, suggestion)) = mistakes.into_iter().next() {
        return Err(OptionError::UnknownFunction { option: "--only", pattern, suggestion }.into());
    }
    Ok(Filter {
        is_verbose: args.verbose,
        only: args.only.as_deref().map(Pattern::parse_list).unwrap_or_default(),
        robots: robot.into_iter().map(RobotId::from_index).collect(),
    })
}

/// Numbers of robots in each state.
fn counts(run: &Run) -> Counts {
    let mut counts = Counts::default();
    for id in run.ids_with_program() {
        let robot = run.robot(id);
        if robot.ending.is_some() {
            counts.ended += 1;
        } else if robot.tasks.are_all_waiting() {
            counts.waiting += 1;
        } else {
            counts.running += 1;
        }
    }
    counts
}
