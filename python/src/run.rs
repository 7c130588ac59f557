//! Runs of scenes with robot programs.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sim_core::time::Time;
use sim_host::executive::interrupt::Interrupt;
use sim_host::executive::program::Exec;
use sim_host::executive::scheduler::Progress;
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{self, Observers, Scene};
use sim_host::plot::{PictureKind, PlotError};
use sim_host::record::{RecordError, Sink, Trace, Trails};

use super::error::{error, of_launch};
use super::simulation::{duration, length, parse_settings};

/// Simulated time after which a run looks whether the user interrupts.
const SIGNAL_INTERVAL: Time = Time::from_millis(1_000);

/// Reasons why a run gives no result.
enum Failed {
    Launch(launch::Error),
    Record(RecordError),
    Plot(PlotError),
    Interrupted(PyErr),
}

impl From<launch::Error> for Failed {
    fn from(failed: launch::Error) -> Self {
        Self::Launch(failed)
    }
}

impl From<RecordError> for Failed {
    fn from(failed: RecordError) -> Self {
        Self::Record(failed)
    }
}

impl From<PlotError> for Failed {
    fn from(failed: PlotError) -> Self {
        Self::Plot(failed)
    }
}

/// Options of a run, by the names that the package gives them; an absent one has the default of `eyesim run`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RunOptions {
    seed: Option<u64>,
    noise: Option<String>,
    slot: Option<f64>,
    until: Option<f64>,
    programs: Vec<String>,
    arguments: Vec<String>,
    keys: Vec<String>,
    settings: Vec<String>,
    exec: String,
    workers: Option<usize>,
}

impl RunOptions {
    fn parse(self, py: Python<'_>) -> PyResult<launch::Options> {
        let exec = match self.exec.as_str() {
            "auto" => Exec::Auto,
            "fiber" => Exec::Fiber,
            "thread" => Exec::Thread,
            "process" => Exec::Process,
            other => return Err(error(py, format!("exec = `{other}`: expected auto, fiber, thread or process"))),
        };
        let none = || error(py, "workers = 0: expected at least 1");
        let workers = self.workers.map(|workers| NonZeroUsize::new(workers).ok_or_else(none)).transpose()?;
        let programs = self.programs.iter().map(|text| ProgramOption::parse(text));
        Ok(launch::Options {
            seed: self.seed,
            noise: self.noise,
            slot: self.slot.map(|slot| length(py, "slot", slot)).transpose()?,
            until: self.until.map(|until| duration(py, "until", until)).transpose()?,
            programs: programs.collect::<Result<_, _>>().map_err(|failed| error(py, failed))?,
            arguments: self.arguments,
            keys: self.keys,
            settings: parse_settings(py, &self.settings)?,
            exec,
            workers,
            ..launch::Options::default()
        })
    }
}

/// Runs a scene to its end; returns the report as JSON, the trace as lines of JSON if it is wanted, and the picture as SVG.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    path: PathBuf,
    text: Option<String>,
    options: RunOptions,
    has_trace: bool,
) -> PyResult<(String, Bound<'py, PyBytes>, String)> {
    let options = options.parse(py)?;
    let carried_out = py.detach(|| {
        let scene = match text {
            Some(text) => Scene::of_text(&path, &text, options),
            None => Scene::open(&path, options),
        }?;
        carry_out(scene, has_trace)
    });
    match carried_out {
        Ok((report, trace, svg)) => Ok((report, PyBytes::new(py, &trace), svg)),
        Err(Failed::Launch(failed)) => Err(of_launch(py, failed)),
        Err(Failed::Record(failed)) => Err(error(py, failed)),
        Err(Failed::Plot(failed)) => Err(error(py, failed)),
        Err(Failed::Interrupted(interrupt)) => Err(interrupt),
    }
}

fn carry_out(scene: Scene, has_trace: bool) -> Result<(String, Vec<u8>, String), Failed> {
    let ready = scene.load()?;
    let trails = Arc::new(Mutex::new(Trails::of_scene(ready.scene())));
    let lines = Lines::default();
    let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&trails))];
    if has_trace {
        let trace = Trace::new(Box::new(lines.clone()), Path::new("trace"), &ready.trace_header())?;
        sinks.push(Box::new(trace));
    }
    let interrupt = Interrupt::default();
    let mut running = ready.start(Observers { sinks, interrupt: interrupt.clone(), ..Observers::default() })?;
    let mut interrupted = Ok(());
    while let Some(next) = running.scheduler.boundary().next_within_limit() {
        let over = running.scheduler.advance_to(next.saturating_add(SIGNAL_INTERVAL)) == Progress::Over;
        interrupted = Python::attach(|py| py.check_signals());
        if over || interrupted.is_err() {
            break;
        }
    }
    let finished = running.finish();
    interrupted.map_err(Failed::Interrupted)?;
    let svg = PictureKind::Svg.render(&finished.drawing(&trails.lock()), None)?;
    let trace = std::mem::take(&mut *lines.0.lock());
    Ok((finished.report.to_json()?, trace, String::from_utf8_lossy(&svg).into_owned()))
}

/// Lines of a trace in memory.
#[derive(Clone, Default)]
struct Lines(Arc<Mutex<Vec<u8>>>);

impl Write for Lines {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
