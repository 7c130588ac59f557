//! Runs scenes, two at a time, and reads their traces.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use anyhow::{Context as _, bail};
use parking_lot::Mutex;
use sim_core::time::Time;
use sim_host::executive::dispatcher::EndReason;
use sim_host::launch::{self, Observers, Options};
use sim_host::record::Sink;

use crate::trace::Trace;

/// Number of simultaneous runs: the pages are made on a machine with two processors.
const AT_ONCE: usize = 2;

/// A scene to run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name of the trace, and of the scene's file if the scene is given as text.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Options in addition to the scene: the seed, the noise.
    pub options: Options,
}

/// Source of a scene.
#[derive(Clone, Debug)]
pub enum Scene {
    /// A file, relative to the checkout: `sims/walker.scene.toml`.
    File(PathBuf),
    /// The text of a scene in TOML. It is kept in a file beside the trace; `%sim%` in it stands for the checkout.
    Text(String),
}

/// What the runs for one paper share: the paper's name, the folder of their files, the seed.
#[derive(Debug)]
pub struct Job {
    paper: String,
    folder: PathBuf,
    seed: u64,
}

impl Job {
    /// A job whose files go into `folder`; creates the folder.
    ///
    /// # Errors
    /// If the folder cannot be created.
    pub fn new(paper: &str, folder: &Path, seed: u64) -> anyhow::Result<Self> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
        Ok(Self { paper: paper.to_owned(), folder: folder.to_owned(), seed })
    }

    /// The folder of the paper's page and files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The seed that the user chose.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Default options of the job's runs, with its seed.
    pub fn options(&self) -> Options {
        Options { seed: Some(self.seed), ..Options::default() }
    }

    /// Prints a progress message on standard error.
    pub fn tell(&self, what: &str) {
        eprintln!("{}: {what}", self.paper);
    }

    /// Runs `runs`, two at a time, and reads each trace with `read` as soon as it is complete. The results are in the
    /// order of the runs. Scenes and traces stay in the folder `runs` of the paper's folder.
    ///
    /// # Errors
    /// If a scene cannot be run, a program fails, a trace cannot be written, or `read` fails. Then no further run is
    /// started.
    pub fn run<T: Send>(
        &self,
        runs: &[Run],
        read: impl Fn(&Run, Trace) -> anyhow::Result<T> + Sync,
    ) -> anyhow::Result<Vec<T>> {
        let folder = self.folder.join("runs");
        fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
        let (next, has_failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let done: Vec<Mutex<Option<anyhow::Result<T>>>> = runs.iter().map(|_| Mutex::new(None)).collect();
        let work = || {
            while !has_failed.load(Ordering::Relaxed) {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(run) = runs.get(index) else { break };
                let begin = Instant::now();
                let result =
                    self.run_one(run, &folder).and_then(|trace| read(run, trace)).with_context(|| run.name.clone());
                has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
                let seconds = begin.elapsed().as_secs_f64();
                self.tell(&format!("{} ({} of {}): {seconds:.1} s", run.name, index + 1, runs.len()));
                *done[index].lock() = Some(result);
            }
        };
        thread::scope(|scope| {
            let spawn = |number| thread::Builder::new().name(format!("run {number}")).spawn_scoped(scope, work);
            (0..AT_ONCE.min(runs.len())).try_for_each(|number| spawn(number).map(|_| ()))
        })
        .context("a thread cannot be started")?;
        let results = done.into_iter().filter_map(Mutex::into_inner);
        let read: Vec<T> = results.collect::<anyhow::Result<_>>()?;
        anyhow::ensure!(
            read.len() == runs.len(),
            "{} of {} runs were not finished",
            runs.len() - read.len(),
            runs.len()
        );
        Ok(read)
    }

    /// Runs one scene to its end and also writes its trace to a file.
    fn run_one(&self, run: &Run, folder: &Path) -> anyhow::Result<Trace> {
        let scene = match &run.scene {
            Scene::File(path) => root().join(path),
            Scene::Text(text) => {
                let path = folder.join(format!("{}.scene.toml", run.name));
                fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
                path
            }
        };
        let ready = launch::Scene::open(&scene, run.options.clone())?.load()?;
        let file =
            sim_host::record::TraceFile::create(&folder.join(format!("{}.jsonl", run.name)), &ready.trace_header())?;
        let trace = Arc::new(Mutex::new(Trace::default()));
        let sinks: Vec<Box<dyn Sink>> = vec![Box::new(file), Box::new(Arc::clone(&trace))];
        let mut running = ready.start(Observers { sinks, ..Observers::default() })?;
        running.scheduler.advance_to(Time::NEVER);
        let finished = running.finish();
        if let EndReason::Record(error) = &finished.ended.end {
            bail!("`{}`: {error}", scene.display());
        }
        if let Some(robot) = finished.report.robots.iter().find(|robot| robot.outcome.is_failure()) {
            let reason = robot.reason.as_deref().unwrap_or("no reason given");
            bail!("the program of robot {} failed in `{}`: {reason}", robot.id, scene.display());
        }
        Ok(std::mem::take(&mut *trace.lock()))
    }
}

/// The checkout from which this program was built.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
