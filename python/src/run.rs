//! Runs of scenes with robot programs.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use eyesim::plot::{PictureKind, PlotError, draw_finished};
use parking_lot::Mutex;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sim_core::time::Time;
use sim_host::executive::interrupt::Interrupt;
use sim_host::executive::program::Exec;
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{self, Observers, Scene};
use sim_host::program::embedded::EmbeddedProgram;
use sim_host::record::{RecordError, Sink, Trace, Trails};

use super::callable::Callable;
use super::error::{error, of_launch, warn};
use super::simulation::{duration, length, parse_settings};

/// Interval at which a run checks for an interrupt by the user.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Stack size of a run's thread, in bytes: the usual stack size of a main thread.
const STACK: usize = 8 << 20;

/// Reasons why a run has no result.
enum Failed {
    Launch(launch::Error),
    Record(RecordError),
    Plot(PlotError),
    Thread(io::Error),
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

/// Options of a run, under their names in the package; an absent option has the default of `eyesim run`.
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
    timeout: Option<f64>,
    /// Reference, name and program of each Python function.
    functions: Vec<(String, String, Py<PyAny>)>,
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
        let default = launch::Options::default();
        let timeout = self.timeout.unwrap_or(default.timeout);
        if timeout.is_nan() || timeout <= 0.0 {
            return Err(error(py, format!("timeout = {timeout}: expected more than 0 seconds of processor time")));
        }
        let embedded =
            |(reference, name, function)| EmbeddedProgram { reference, name, code: Arc::new(Callable(function)) };
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
            timeout,
            embedded: self.functions.into_iter().map(embedded).collect(),
            ..default
        })
    }
}

/// Runs a scene to its end. Returns the report as JSON, the trace as JSON lines if `trace` is set, and the picture as
/// SVG.
#[pyfunction]
pub fn run<'py>(
    py: Python<'py>,
    path: PathBuf,
    text: Option<String>,
    options: RunOptions,
    has_trace: bool,
) -> PyResult<(String, Bound<'py, PyBytes>, String)> {
    let options = options.parse(py)?;
    let interrupt = Interrupt::default();
    let opened = py.detach(|| match text {
        Some(text) => Scene::from_text(&path, &text, options),
        None => Scene::open(&path, options),
    });
    let scene = opened.map_err(|failed| of_launch(py, failed))?;
    if !scene.is_rejected() {
        warn(py, scene.diagnostics())?;
    }
    let run = || carry_out(scene, has_trace, interrupt.clone());
    let (carried_out, interrupted) = py.detach(|| on_own_thread(run, &interrupt));
    interrupted?;
    match carried_out {
        Ok((report, trace, svg)) => Ok((report, PyBytes::new(py, &trace), svg)),
        Err(Failed::Launch(failed)) => Err(of_launch(py, failed)),
        Err(Failed::Record(failed)) => Err(error(py, failed)),
        Err(Failed::Plot(failed)) => Err(error(py, failed)),
        Err(Failed::Thread(failed)) => Err(error(py, failed)),
    }
}

/// Runs `run` on a separate thread. The calling thread, the only one that receives Python's signals, meanwhile checks
/// for Ctrl-C and then interrupts the run. Also returns the exception of the interrupt.
fn on_own_thread<T: Send>(
    run: impl FnOnce() -> Result<T, Failed> + Send,
    interrupt: &Interrupt,
) -> (Result<T, Failed>, PyResult<()>) {
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::sync_channel(1);
        // The receiver lives until the only message has arrived.
        let run = move || _ = sender.send(run());
        let thread = thread::Builder::new().name("eyesim".to_owned()).stack_size(STACK).spawn_scoped(scope, run);
        let thread = match thread {
            Ok(thread) => thread,
            Err(failed) => return (Err(Failed::Thread(failed)), Ok(())),
        };
        let mut interrupted = Ok(());
        loop {
            match receiver.recv_timeout(SIGNAL_INTERVAL) {
                Ok(result) => return (result, interrupted),
                Err(RecvTimeoutError::Timeout) if interrupted.is_ok() => {
                    interrupted = Python::attach(|py| py.check_signals());
                    if interrupted.is_err() {
                        interrupt.set();
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        match thread.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => unreachable!("it has sent its result"),
        }
    })
}

fn carry_out(scene: Scene, has_trace: bool, interrupt: Interrupt) -> Result<(String, Vec<u8>, String), Failed> {
    let ready = scene.load()?;
    let trails = Arc::new(Mutex::new(Trails::of_scene(ready.scene())));
    let lines = Lines::default();
    let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&trails))];
    if has_trace {
        let trace = Trace::new(Box::new(lines.clone()), Path::new("trace"), &ready.trace_header())?;
        sinks.push(Box::new(trace));
    }
    let mut running = ready.start(Observers { sinks, interrupt, ..Observers::default() })?;
    running.scheduler.advance_to(Time::NEVER);
    let finished = running.finish();
    let svg = PictureKind::Svg.render(&draw_finished(&finished, &trails.lock()), None)?;
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
