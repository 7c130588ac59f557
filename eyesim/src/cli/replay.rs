//! `eyesim replay`: shows a recorded run on the page, or runs it again and compares the two runs.

use std::collections::VecDeque;
use std::net::Ipv4Addr;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use glam::DVec2;
use parking_lot::Mutex;
use sim_core::build;
use sim_core::record::{Action, Digest, KindSet, Record, digest};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::interrupt;
use sim_host::executive::scheduler::{Progress, Scheduler};
use sim_host::executive::script::Script;
use sim_host::executive::spawn::roster_of;
use sim_host::files::slashed;
use sim_host::launch::{Error, Observers, Scene, UnpackedArchive};
use sim_host::program::command;
use sim_host::record::read::read_text;
use sim_host::record::report::{Input, write_atomically};
use sim_host::record::{RecordError, Recorded, Sink, TraceReader};
use sim_host::scenery::SpawnedEntity;
use sim_view::page::Page;
use sim_view::protocol::{AddableTypes, Recording};
use sim_view::window::{Access, Download};

use super::EXIT_PROGRAM;
use super::output::print;
use super::output::say;
use super::output::{check_outputs, output_path};
use super::pack::{archive_of, open_for_run};
use super::run::{self, ConsoleRun, RunArgs};
use super::view::{open_browser, open_window};
use crate::window::recording::recording;
use crate::window::scene::{ObjectInput, RobotInput, SceneInput};

/// Arguments of `eyesim replay`.
#[derive(Args)]
pub struct ReplayArgs {
    /// Trace written by `eyesim run --trace`
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// Run it again, with its user interventions, and report whether the two runs are equal
    #[arg(long)]
    verify: bool,
    /// Number of robots that run at the same time [default: one for each processor]
    #[arg(long, value_name = "NUMBER", value_parser = run::parse_threads, requires = "verify")]
    threads: Option<NonZeroUsize>,
    /// Write the recording and the page that plays it into one file, which a browser can open from disk
    #[arg(long, value_name = "FILE.html", conflicts_with = "verify", value_parser = output_path())]
    html: Option<PathBuf>,
    /// Do not open a browser
    #[arg(long, conflicts_with_all = ["verify", "html"])]
    no_open: bool,
    /// Port of the page, 0 for any free port [default: 7351, or any free port if 7351 is in use]
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["verify", "html"])]
    port: Option<u16>,
}

/// Runs the command.
///
/// # Errors
/// If the trace cannot be read or run again.
pub fn run(args: &ReplayArgs) -> anyhow::Result<ExitCode> {
    if args.verify {
        return verify(args);
    }
    let recorded = Recorded::read(&args.trace)?;
    let recording = Arc::new(serde_json::to_string(&recording_of(&recorded, &args.trace)?)?);
    let page = Page::load(|text| say(text));
    if let Some(path) = &args.html {
        let trace = args.trace.to_string_lossy();
        let inputs = recorded.header.inputs.iter().map(|input| input.path.as_str());
        check_outputs(&[("--html", path)], inputs.chain([&*trace]))?;
        let text = page.with_recording(&recording)?;
        write_atomically(path, text.as_bytes()).with_context(|| format!("--html `{}`", path.display()))?;
        print(&format!("{}\n", path.display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(why) = page.why_missing() {
        say(why);
    }
    let title = args.trace.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let window = open_window(page, Access::Local, Ipv4Addr::LOCALHOST.into(), args.port, &title)?;
    window.offer("recording.json", Download::new("application/json", move || Ok(recording.as_bytes().to_vec())));
    let trace = args.trace.clone();
    let trace = move || read_text(&trace).map_err(|error| error.to_string());
    window.offer("trace.jsonl", Download::new("application/jsonl", trace));
    let url = window.url();
    print(&format!("{url}\n"))?;
    if !args.no_open && !open_browser(&url) {
        say("no browser could be opened: open the address above in one, or set BROWSER");
    }
    // Ctrl-C ends the process.
    loop {
        std::thread::park();
    }
}

/// Recording of a run for the page; its scene is read from the scene's files.
fn recording_of(recorded: &Recorded, trace: &Path) -> anyhow::Result<Recording> {
    let mut args = args_of(recorded, trace)?;
    let _unpacked = open_for_run(&mut args)?;
    let mut scene = Scene::open(&args.sim, args.options())?;
    ensure!(
        !scene.is_rejected(),
        "the scene `{0}` of the trace cannot be read any more: `eyesim check {0}` says why",
        args.sim.display()
    );
    let slot = scene.settings()?.slot;
    let remarks = remarks(recorded, &current_inputs(recorded, args.archive.as_ref()));
    remarks.iter().for_each(say);
    let (spec, scenery) = scene.into_scenery();
    let mut robots: Vec<RobotInput> = spec.robots.iter().map(RobotInput::at_start).collect();
    let objects = (1..).map(ObjectId).zip(build::movable_objects(&spec));
    let mut objects: Vec<ObjectInput> = objects.map(|(id, spec)| ObjectInput::at_start(id, spec)).collect();
    let roster = roster_of(&spec);
    for (_, action) in &recorded.interventions {
        match action {
            Action::AddRobot { kind, program_of, x_m, y_m, .. } => {
                let robi = roster.robot_types.find(kind)?;
                let id = RobotId::from_index(robots.len());
                scenery.add(SpawnedEntity::Robot(id, Arc::clone(&robi)));
                let position = DVec2::new(*x_m, *y_m);
                let model = robots.iter().find(|robot| Some(robot.id.0) == *program_of);
                let (program, has_colours) =
                    model.map(|model| (model.program.clone(), model.has_colours)).unwrap_or_default();
                robots.push(RobotInput { id, robi, program, position, has_colours });
            }
            Action::AddObject { kind, x_m, y_m, .. } => {
                let kind = roster.object_types.find(kind)?;
                let id = ObjectId::from_index(objects.len());
                scenery.add(SpawnedEntity::Object(id, Arc::clone(&kind)));
                objects.push(ObjectInput { id, kind, position: DVec2::new(*x_m, *y_m) });
            }
            _ => {}
        }
    }
    let input = SceneInput {
        run: 1,
        seed: recorded.header.seed,
        slot,
        spec: &spec,
        scenery: &scenery.get(),
        robots,
        objects,
        addable_types: AddableTypes::default(),
    };
    Ok(recording(TraceReader::open(trace)?, input.scene(), &spec, remarks)?)
}

/// Current versions of the files that determined the run, some of them in an archive.
fn current_inputs(recorded: &Recorded, archive: Option<&UnpackedArchive>) -> Vec<Input> {
    let input = |old: &Input| {
        let path = archive.map_or(old.path.clone(), |archive| archive.unpacked(&old.path));
        Some(Input::new(Path::new(&old.path), &std::fs::read(path).ok()?))
    };
    recorded.header.inputs.iter().filter_map(input).collect()
}

/// Repeats the run of a trace, and compares the digests slot by slot.
fn verify(args: &ReplayArgs) -> anyhow::Result<ExitCode> {
    let recorded = Recorded::read(&args.trace)?;
    let mut run = RunArgs { threads: args.threads, is_silent: true, ..args_of(&recorded, &args.trace)? };
    let _unpacked = open_for_run(&mut run)?;
    ensure!(
        recorded.digest_version == u64::from(digest::VERSION),
        "the digests of `{}` have version {}, those of this eyesim version {}: record the run again (`eyesim diff` compares events of \
         two traces)",
        args.trace.display(),
        recorded.digest_version,
        digest::VERSION
    );
    let ready = match run::build(run::open(&run)?, &run)?.load() {
        Err(Error::Load(why)) if !command::is_interrupted() => {
            say(format_args!("error: {why}"));
            return Ok(ExitCode::from(EXIT_PROGRAM));
        }
        ready => ready?,
    };
    for remark in remarks(&recorded, &ready.trace_header().inputs) {
        say(remark);
    }
    let mut script = script_of(&recorded);
    let comparison = Arc::new(Mutex::new(Comparison::new(&recorded)));
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&comparison))];
    let observers = Observers { sinks, interrupt, ..Observers::default() };
    let mut running = ConsoleRun::start(ready, &run, observers, true)?;
    run_until_divergence(running.scheduler(), &mut script, &comparison);
    let finished = running.finish(|| {}).finished;
    for (at, why) in script.refused() {
        say(format_args!("at {at} the trace has an intervention that this run refuses: {why}"));
    }
    if let EndReason::Record(error) = &finished.ended.end {
        bail!("the run cannot continue: {error}");
    }
    let comparison = comparison.lock();
    Ok(match (&comparison.divergence, recorded.end) {
        (Some(divergence), _) => {
            print(&format!("{divergence}\n"))?;
            ExitCode::from(EXIT_PROGRAM)
        }
        (None, Some((_, digest))) => {
            print(&format!("the same digest: {digest}\n"))?;
            ExitCode::SUCCESS
        }
        (None, None) => {
            let until = recorded.slots.last().map_or(Time::ZERO, |(end, _)| *end);
            print(&format!("the same digest until {until}, where the trace was cut off\n"))?;
            ExitCode::SUCCESS
        }
    })
}

/// Arguments that repeat a recorded run; a scene or archive that is not found at its path is searched for beside the
/// trace.
///
/// # Errors
/// If the trace has no arguments, or its scene is missing.
pub fn args_of(recorded: &Recorded, trace: &Path) -> anyhow::Result<RunArgs> {
    let header = &recorded.header;
    let version = &recorded.version;
    ensure!(
        !header.run.is_empty(),
        "`{}` has no arguments to repeat the run: eyesim {version} has recorded it",
        trace.display()
    );
    let mut args = RunArgs::of_words(&header.run)?;
    let file = archive_of(&args.sim).unwrap_or(&args.sim);
    if !file.exists() {
        let beside_trace = trace.parent().unwrap_or(Path::new("")).join(file);
        ensure!(
            beside_trace.exists(),
            "there is no `{}`, the scene of this trace: run this in the folder in which it was recorded",
            file.display()
        );
        if file == args.sim {
            args.sim = beside_trace;
        } else {
            let [old, new] = [file, &beside_trace].map(|path| slashed(path) + "/");
            args = RunArgs::of_words(header.run.iter().map(|word| word.replace(&old, &new)))?;
        }
    }
    Ok(args)
}

/// Script of the interventions of a recorded run, and of its interrupt if there was one.
pub fn script_of(recorded: &Recorded) -> Script {
    let script = Script::new(recorded.interventions.iter().cloned());
    match recorded.end {
        Some((end, _)) if recorded.is_interrupted => script.interrupt_at(end),
        _ => script,
    }
}

/// Remarks on changes since the trace was recorded, which may change the outcome.
pub fn remarks(recorded: &Recorded, inputs: &[Input]) -> Vec<String> {
    let mut remarks = Vec::new();
    let (version, this_version) = (&recorded.version, env!("CARGO_PKG_VERSION"));
    if version != this_version {
        remarks.push(format!("the trace was recorded by eyesim {version}, this is {this_version}"));
    }
    if !recorded.header.only.is_empty() {
        remarks.push(format!(
            "the trace has only the events that `--trace-only {}` selected: the digests of its slots show in which slot two runs diverge, not what \
             differs, and the page and `diff` show only these events; for all events, record the run without --trace-only",
            recorded.header.only.join(",")
        ));
    }
    let name = |path: &str| Path::new(path).file_name().map(|name| name.to_owned());
    for old in &recorded.header.inputs {
        // From another folder the same file has another path.
        let new = inputs.iter().find(|new| new.path == old.path);
        let new = new.or_else(|| inputs.iter().find(|new| name(&new.path) == name(&old.path)));
        match new {
            None => remarks.push(format!("`{}` is not read any more", old.path)),
            Some(new) if new.sha256 != old.sha256 => {
                remarks.push(format!("`{}` has changed since the trace was recorded", old.path));
            }
            Some(_) => {}
        }
    }
    remarks
}

/// Comparison of the digests of a run with those of a trace.
struct Comparison {
    expected: VecDeque<(Time, Digest)>,
    end: Option<(Time, Digest)>,
    divergence: Option<Divergence>,
}

/// First difference between two runs.
#[derive(Clone, Debug, PartialEq)]
enum Divergence {
    /// The digests of this slot differ.
    Slot { end: Time, expected: Digest, found: Digest },
    /// Only one of the runs has events in this slot.
    Only { end: Time, is_in_trace: bool },
    /// The runs end at different times.
    End { expected: Time, found: Time },
}

impl std::fmt::Display for Divergence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Slot { end, expected, found } => write!(
                f,
                "the runs diverge in the slot that ends at {end}: its digest is {expected} in the trace, {found} in this run"
            ),
            Self::Only { end, is_in_trace: true } => {
                write!(f, "the runs diverge in the slot that ends at {end}: this run has no event in it")
            }
            Self::Only { end, is_in_trace: false } => {
                write!(f, "the runs diverge in the slot that ends at {end}: the trace has no event in it")
            }
            Self::End { expected, found } => {
                write!(f, "the runs diverge at their ends: the trace ends at {expected}, this run at {found}")
            }
        }
    }
}

impl Comparison {
    fn new(recorded: &Recorded) -> Self {
        Self { expected: recorded.slots.iter().copied().collect(), end: recorded.end, divergence: None }
    }

    /// Returns true if a difference was found or nothing is left to compare.
    fn is_over(&self) -> bool {
        self.divergence.is_some() || self.end.is_none() && self.expected.is_empty()
    }

    fn compare(&mut self, end: Time, found: Digest) {
        if self.is_over() {
            return;
        }
        self.divergence = match self.expected.pop_front() {
            Some((other, expected)) if other == end => {
                (expected != found).then_some(Divergence::Slot { end, expected, found })
            }
            Some((other, _)) if other < end => Some(Divergence::Only { end: other, is_in_trace: true }),
            _ => Some(Divergence::Only { end, is_in_trace: false }),
        };
    }
}

impl Sink for Comparison {
    fn interest(&self) -> KindSet {
        KindSet::NONE
    }

    fn record(&mut self, _: &Record<'_>) -> Result<(), RecordError> {
        Ok(())
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        digest.into_iter().for_each(|digest| self.compare(end, digest));
        Ok(())
    }

    fn finish(&mut self, found: Time, _: Digest) -> Result<(), RecordError> {
        if !self.is_over() {
            self.divergence = match (self.expected.pop_front(), self.end) {
                (Some((end, _)), _) => Some(Divergence::Only { end, is_in_trace: true }),
                (None, Some((expected, _))) if expected != found => Some(Divergence::End { expected, found }),
                _ => None,
            };
        }
        Ok(())
    }
}

/// Wall-clock time between two checks for a difference.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Advances the run, following `script`, to its end or to the first difference.
fn run_until_divergence(run: &mut Scheduler, script: &mut Script, comparison: &Mutex<Comparison>) {
    while !comparison.lock().is_over() {
        if script.advance(run, CHECK_INTERVAL) == Progress::Over {
            return;
        }
    }
    run.interrupt();
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIGESTS: [Digest; 3] = [Digest([1; 32]), Digest([2; 32]), Digest([3; 32])];

    /// Difference between a trace of 100 ms with two slots and a run of `slots`: end in ms and index of the digest of
    /// each.
    fn divergence(is_complete: bool, slots: &[(i64, usize)], end_ms: i64) -> Option<String> {
        let at = Time::from_millis;
        let mut comparison = Comparison {
            expected: [(at(50), DIGESTS[0]), (at(100), DIGESTS[1])].into(),
            end: is_complete.then_some((at(100), DIGESTS[1])),
            divergence: None,
        };
        for (end, digest) in slots {
            comparison.end_slot(at(*end), Some(DIGESTS[*digest])).expect("the comparison accepts all records");
            comparison.end_slot(at(*end), None).expect("the comparison accepts all records");
        }
        comparison.finish(at(end_ms), DIGESTS[2]).expect("the comparison accepts all records");
        comparison.divergence.map(|divergence| divergence.to_string())
    }

    #[test]
    fn first_different_slot_is_reported() {
        assert_eq!(divergence(true, &[(50, 0), (100, 1)], 100), None);
        let description = |slots: &[(i64, usize)], end| divergence(true, slots, end).expect("the runs differ");
        assert!(description(&[(50, 2), (100, 1)], 100).contains("ends at 0.050"), "{}", description(&[(50, 2)], 100));
        assert!(description(&[(50, 0), (100, 2)], 100).contains("0303"));
        assert!(description(&[(100, 1)], 100).ends_with("this run has no event in it"));
        assert!(description(&[(50, 0)], 100).ends_with("this run has no event in it"));
        assert!(description(&[(25, 0), (50, 0)], 100).ends_with("the trace has no event in it"));
        assert!(description(&[(50, 0), (100, 1), (150, 2)], 150).ends_with("the trace has no event in it"));
        assert!(description(&[(50, 0), (100, 1)], 150).starts_with("the runs diverge at their ends"));
    }

    #[test]
    fn complete_slots_of_a_truncated_trace_are_compared() {
        assert_eq!(divergence(false, &[(50, 0), (100, 1), (150, 2)], 200), None);
        assert!(divergence(false, &[(50, 0), (100, 2)], 200).is_some());
        assert!(divergence(false, &[(50, 0)], 50).is_some());
    }
}
