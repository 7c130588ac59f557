//! Runs scenes with `eyesim`, two at a time.
//!
//! `eyesim` is this very program, started under that name, so that the scenes are run by what was built with the pages. Each run
//! is a process of its own: a scene, a seed, and the trace that it leaves behind.

use std::ffi::OsString;
use std::fs;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use anyhow::{Context as _, bail};

use crate::trace::Trace;

/// Runs at one time: a machine for which the papers' pages are made has two processors.
const AT_ONCE: usize = 2;
/// The name under which this program is `eyesim`, and, followed by a robot's name, a robot's process of it.
const EYESIM: &str = "eyesim";

/// Whether this process was started as `eyesim` and shall do what that does.
pub fn is_eyesim() -> bool {
    let name = std::env::args_os().next().unwrap_or_default();
    let name = Path::new(&name).file_name().unwrap_or_default().to_string_lossy();
    name == EYESIM || name.starts_with(&format!("{EYESIM}: "))
}

/// A scene to run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Of its trace and, where it has none yet, of its scene's file.
    pub name: String,
    /// What is run.
    pub scene: Scene,
    /// The seed of all random numbers.
    pub seed: u64,
    /// Further words behind `eyesim run`: `--noise=real`.
    pub words: Vec<String>,
}

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum Scene {
    /// A file of the checkout, relative to it: `sims/walker.scene.toml`.
    File(PathBuf),
    /// The text of a scene in TOML, kept in a file beside the trace; `%sim%` in it is the checkout.
    Text(String),
}

/// The work on one paper: where its files go, and what runs its scenes.
#[derive(Debug)]
pub struct Job {
    paper: String,
    folder: PathBuf,
    eyesim: PathBuf,
    seed: u64,
}

impl Job {
    /// A job whose files go to `folder`, which is made, and whose scenes are run by this very program.
    ///
    /// # Errors
    /// A folder that cannot be made; a process that does not know its own program.
    pub fn new(paper: &str, folder: &Path, seed: u64) -> anyhow::Result<Self> {
        let eyesim = std::env::current_exe().context("this program does not know where it lies")?;
        Self::with_eyesim(&eyesim, paper, folder, seed)
    }

    /// A job whose scenes are run by the program `eyesim`.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn with_eyesim(eyesim: &Path, paper: &str, folder: &Path, seed: u64) -> anyhow::Result<Self> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
        Ok(Self { paper: paper.to_owned(), folder: folder.to_owned(), eyesim: eyesim.to_owned(), seed })
    }

    /// The folder of the paper's page and files.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The seed that the user chose.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Says on standard error what is going on.
    pub fn tell(&self, what: &str) {
        eprintln!("{}: {what}", self.paper);
    }

    /// Runs `runs`, two at a time, and reads the trace of each with `read` as soon as it is there; what was read stands in the order
    /// of the runs. Scenes and traces stay in the folder `runs` of the paper's.
    ///
    /// # Errors
    /// A run that ends otherwise than with exit code 0, with its messages; what `read` finds. No further run is begun then.
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
                let place = next.fetch_add(1, Ordering::Relaxed);
                let Some(run) = runs.get(place) else { break };
                let begin = Instant::now();
                let result =
                    self.run_one(run, &folder).and_then(|trace| read(run, trace)).with_context(|| run.name.clone());
                has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
                let seconds = begin.elapsed().as_secs_f64();
                self.tell(&format!("{} ({} of {}): {seconds:.1} s", run.name, place + 1, runs.len()));
                if let Ok(mut slot) = done[place].lock() {
                    *slot = Some(result);
                }
            }
        };
        thread::scope(|scope| {
            let spawn = |number| thread::Builder::new().name(format!("run {number}")).spawn_scoped(scope, work);
            (0..AT_ONCE.min(runs.len())).try_for_each(|number| spawn(number).map(|_| ()))
        })
        .context("a thread cannot be started")?;
        let results = done.into_iter().filter_map(|slot| slot.into_inner().ok().flatten());
        let read: Vec<T> = results.collect::<anyhow::Result<_>>()?;
        anyhow::ensure!(
            read.len() == runs.len(),
            "{} of {} runs were not finished",
            runs.len() - read.len(),
            runs.len()
        );
        Ok(read)
    }

    /// Runs one scene to its end.
    fn run_one(&self, run: &Run, folder: &Path) -> anyhow::Result<Trace> {
        let scene = match &run.scene {
            Scene::File(path) => root().join(path),
            Scene::Text(text) => {
                let path = folder.join(format!("{}.scene.toml", run.name));
                fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
                path
            }
        };
        let trace = folder.join(format!("{}.jsonl", run.name));
        let option = |name: &str, value: &Path| -> OsString {
            let mut word = OsString::from(name);
            word.push(value);
            word
        };
        let mut command = Command::new(&self.eyesim);
        command.arg0(EYESIM).args(["run", "--quiet"]).arg(format!("--seed={}", run.seed));
        command.arg(option("--trace=", &trace)).args(&run.words).arg(&scene).stdin(Stdio::null());
        let output = command.output().with_context(|| format!("cannot run `{}`", self.eyesim.display()))?;
        if !output.status.success() {
            let said = [output.stderr, output.stdout].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
            bail!("eyesim ended with {} on `{}`:\n{}", output.status, scene.display(), said.join("\n").trim_end());
        }
        Ok(Trace::read(&trace)?)
    }
}

/// The checkout from which this program was built.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}
