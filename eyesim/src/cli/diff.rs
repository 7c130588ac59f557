//! `eyesim diff`: the first difference between two runs, from their traces or reports.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use serde_json::Value;
use sim_format::MeshReader;
use sim_host::files::{DiskFiles, read_regular};
use sim_host::record::TraceReader;
use sim_host::record::diff::{Difference, TraceDiff};
use sim_host::record::read::RecordedEvent;

use super::EXIT_PROGRAM;
use super::output::print;
use super::output::{check_outputs, say};
use crate::plot::{self, Drawing, PictureKind};

/// Maximum number of differences between two reports, and of robots of two traces, that are printed.
const MAX_LINES: usize = 20;

/// Entries of a report that may differ between equal runs: arguments, wall-clock time and version.
const IGNORED_ENTRIES: [&str; 3] = ["argv", "real_time_s", "eyesim_version"];

/// Arguments of `eyesim diff`.
#[derive(Args)]
pub struct DiffArgs {
    /// A trace (`run --trace`) or a report (`run --report`)
    pub a: PathBuf,
    /// A file of the same kind
    pub b: PathBuf,
    /// Draw the paths of both runs of two traces: NAME.svg or NAME.png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
}

/// Runs the command: exit code 0 for equal runs, 1 for different ones.
///
/// # Errors
/// If a file cannot be read, is neither a trace nor a report, or the picture cannot be written.
pub fn run(args: &DiffArgs) -> anyhow::Result<ExitCode> {
    let is_equal = match (read_report(&args.a)?, read_report(&args.b)?) {
        (Some(a), Some(b)) => {
            ensure!(args.plot.is_none(), "--plot: reports have no paths: compare two traces");
            diff_reports(&a, &b)?
        }
        (None, None) => diff_traces(args)?,
        (a, _) => {
            let (report, trace) = if a.is_some() { (&args.a, &args.b) } else { (&args.b, &args.a) };
            bail!(
                "`{}` is a report, `{}` is not: expected two traces or two reports",
                report.display(),
                trace.display()
            )
        }
    };
    Ok(if is_equal { ExitCode::SUCCESS } else { ExitCode::from(EXIT_PROGRAM) })
}

/// Reads the report at `path`; returns `None` if the file is a trace.
fn read_report(path: &Path) -> anyhow::Result<Option<Value>> {
    let name = || format!("`{}`", path.display());
    ensure!(std::fs::metadata(path).with_context(name)?.is_file(), "{} is not a file", name());
    let trace_error = match TraceReader::open(path) {
        Ok(_) => return Ok(None),
        Err(error) => error,
    };
    let report: Option<Value> = serde_json::from_slice(&read_regular(path).with_context(name)?).ok();
    match report.filter(|report| report["digest"].is_string() && report["robots"].is_array()) {
        Some(report) => Ok(Some(report)),
        None => bail!("{} is not a report of a run, and {trace_error}", name()),
    }
}

/// Prints the entries in which two reports differ; returns true if there are none.
fn diff_reports(a: &Value, b: &Value) -> anyhow::Result<bool> {
    let mut lines = Vec::new();
    diff_values("", a, b, &mut lines);
    let mut text = String::new();
    for line in lines.iter().take(MAX_LINES) {
        writeln!(text, "{line}")?;
    }
    if lines.len() > MAX_LINES {
        writeln!(text, "and {} more", lines.len() - MAX_LINES)?;
    }
    if lines.is_empty() {
        writeln!(text, "equal runs: digest {}", a["digest"].as_str().unwrap_or_default())?;
    }
    print(&text)?;
    Ok(lines.is_empty())
}

fn diff_values(path: &str, a: &Value, b: &Value, lines: &mut Vec<String>) {
    let join = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            for (name, value) in a.iter().filter(|(name, _)| !IGNORED_ENTRIES.contains(&name.as_str())) {
                diff_values(&join(name), value, b.get(name).unwrap_or(&Value::Null), lines);
            }
            for (name, value) in b.iter().filter(|(name, _)| !a.contains_key(*name)) {
                diff_values(&join(name), &Value::Null, value, lines);
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            for index in 0..a.len().max(b.len()) {
                let item = |list: &[Value]| list.get(index).cloned().unwrap_or(Value::Null);
                diff_values(&format!("{path}[{index}]"), &item(a), &item(b), lines);
            }
        }
        _ if a != b => lines.push(format!("{path}: {a} in A, {b} in B")),
        _ => {}
    }
}

/// Prints where two traces diverge; returns true if the runs are equal.
fn diff_traces(args: &DiffArgs) -> anyhow::Result<bool> {
    if let Some(picture) = &args.plot {
        PictureKind::of(picture)?;
        let inputs = [&args.a, &args.b].map(|path| path.to_string_lossy().into_owned());
        check_outputs(&[("--plot", picture)], inputs.iter().map(String::as_str))?;
    }
    let readers = [TraceReader::open(&args.a)?, TraceReader::open(&args.b)?];
    let only = readers.each_ref().map(|reader| reader.header().only.join(","));
    let kinds = only
        .each_ref()
        .map(|only| if only.is_empty() { "all kinds of events".to_owned() } else { format!("`{only}`") });
    ensure!(
        only[0] == only[1],
        "the traces contain different kinds of events (--trace-only): {} in A, {} in B: compare two with the same kinds",
        kinds[0],
        kinds[1]
    );
    let scene = readers[0].header().run.first().cloned();
    let diff = TraceDiff::of(readers)?;
    print(&describe(&diff)?)?;
    if let Some(picture) = &args.plot {
        let mut files = DiskFiles::of_environment();
        let mut drawing = Drawing::new("Paths of two runs: A in colour, B in black");
        match scene.filter(|scene| Path::new(scene).exists()) {
            Some(scene) => {
                let name = files.name(Path::new(&scene));
                let loaded = sim_format::load_scene(&name, &files);
                drawing = plot::draw_ground(drawing, &loaded.scene, &mut MeshReader::new(&files));
            }
            None => say("--plot: without its scene, which is not found from here, the picture shows the paths alone"),
        }
        plot::write(&plot::draw_paths(drawing, &diff.paths), picture, None)?;
    }
    Ok(diff.is_equal())
}

/// Describes the comparison as text.
fn describe(diff: &TraceDiff) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for header in &diff.headers {
        writeln!(text, "{header}")?;
    }
    let [end_a, end_b] = diff.ends.map(|end| end.map(|end| end.to_string()).unwrap_or_default());
    match &diff.first {
        Some(first) => describe_first(&mut text, first)?,
        None if !diff.compares_events() => {
            writeln!(
                text,
                "the slots differ: only the positions of robots at the ends of slots of both runs are compared"
            )?;
            if diff.ends_differ() {
                writeln!(text, "A ends at {end_a} and B at {end_b}")?;
            }
        }
        None if diff.ends_differ() => {
            writeln!(text, "equal events, but A ends at {end_a} and B at {end_b}")?;
        }
        None if diff.ends.contains(&None) => {
            writeln!(text, "equal until {}, where a trace breaks off", diff.compared_until)?;
        }
        None => writeln!(text, "equal runs")?,
    }
    let mut farthest: Vec<_> = diff.paths.iter().filter_map(|(robot, paths)| Some((robot, paths.farthest?))).collect();
    farthest.sort_by(|(_, (a, _)), (_, (b, _))| b.total_cmp(a));
    for (robot, (distance, time)) in farthest.iter().take(MAX_LINES) {
        writeln!(text, "r{robot}: up to {} apart, at {time}", length(*distance))?;
    }
    if farthest.len() > MAX_LINES {
        writeln!(text, "and {} more robots", farthest.len() - MAX_LINES)?;
    }
    Ok(text)
}

fn describe_first(text: &mut String, first: &Difference) -> std::fmt::Result {
    let subject = first.robot.map_or("the world".to_owned(), |robot| format!("r{robot}"));
    writeln!(
        text,
        "the runs diverge at {:.6} s, in the slot that ends at {}: {subject}",
        first.at.seconds(),
        first.slot_end
    )?;
    if let Some(last) = &first.last_common {
        writeln!(text, "  equal up to {}", event_text(last))?;
    }
    match &first.events {
        [Some(a), Some(b)] if a.kind == b.kind => {
            writeln!(text, "  then `{}` differs in", a.kind)?;
            let mut lines = Vec::new();
            diff_values("", &a.fields, &b.fields, &mut lines);
            for line in lines {
                writeln!(text, "    {line}")?;
            }
        }
        events => {
            for (run, event) in ["A", "B"].iter().zip(events) {
                let event = event.as_ref().map_or("nothing more in this slot".to_owned(), event_text);
                writeln!(text, "  then in {run}: {event}")?;
            }
        }
    }
    Ok(())
}

/// The fields of the event as one line.
fn event_text(event: &RecordedEvent) -> String {
    event.fields.to_string()
}

/// Formats a length that may be tiny, in metres; below a tenth of a millimetre in scientific notation.
fn length(metres: f64) -> String {
    if metres >= 1e-4 { format!("{metres:.4} m") } else { format!("{metres:.1e} m") }
}
