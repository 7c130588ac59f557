//! Options of a run.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use sim_core::spec::{ContactKind, Dialect};
use sim_core::time::Time;
use sim_format::{Overrides, Setting};

use super::settings::ProgramOption;
use crate::executive::load::DebugTarget;
use crate::executive::program::Exec;
use crate::host;
use crate::program::Generation;
use crate::program::embedded::EmbeddedProgram;
use crate::program::sandbox::Sandbox;
use crate::robios::console::DEFAULT_OUTPUT_LIMIT;

/// Virtual time at which a run ends if neither options nor scene set one.
pub const DEFAULT_UNTIL: Time = Time::from_millis(600_000);

/// Options of a run; they take precedence over the scene. By default no option is set.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of all randomness; default: the scene's, otherwise 0.
    pub seed: Option<u64>,
    /// Length of a slot; default: the scene's, otherwise 50 ms.
    pub slot: Option<Time>,
    /// Virtual time at which the run ends; default: the scene's, otherwise [`Options::default_until`].
    pub until: Option<Time>,
    /// End of the run if neither [`Options::until`] nor the scene sets one; default: [`DEFAULT_UNTIL`].
    pub default_until: Time,
    /// Virtual time for which the run continues while a robot moves, after its last program has ended; default: 0. The
    /// run always continues to the ends of the drives in progress, and while an object moves.
    pub linger: Time,
    /// Number of workers: robots that run at the same time; default: one for each processor.
    pub workers: Option<NonZeroUsize>,
    /// Where programs run; default: fibers and threads of this process. [`Exec::Process`] and [`Exec::Auto`] need a
    /// `main` that calls [`serve_child`](super::serve_child) first.
    pub exec: Exec,
    /// Restrictions of the programs and of the compilers that build them; needs [`Exec::Process`].
    pub sandbox: Option<Sandbox>,
    /// Processor time in seconds that a program may use within one slot before it is stopped; default: 10 s.
    pub timeout: f64,
    /// Programs of robots, instead of the scene's.
    pub programs: Vec<ProgramOption>,
    /// Generation of RoBIOS that the programs use; default: the scene's, otherwise detected from the
    /// functions that each program calls.
    pub api: Option<Generation>,
    /// EyeSim version whose conventions scene and programs follow, instead of the scene's.
    pub dialect: Option<Dialect>,
    /// Side of the cells of the scene's maze in metres, instead of the side in its file.
    pub maze_cell: Option<f64>,
    /// Values that replace those of a scene in TOML, by the paths of their keys.
    pub settings: Vec<Setting>,
    /// Key presses, such as `2.5:KEY1, 4:KEY4`, or `2:2.5:KEY1` for robot 2 only.
    pub keys: Vec<String>,
    /// File with the standard input of the programs; each robot reads a copy. `-`: this process's standard input, read
    /// to its end before the run; `typed`: lines that the user types during the run.
    pub stdin: Option<PathBuf>,
    /// Arguments of programs, instead of the scene's: `1:--kp 0.5` for robot 1, `--kp 0.5` for all robots.
    pub arguments: Vec<String>,
    /// File with the costs of RoBIOS calls, instead of the scene's.
    pub costs: Option<PathBuf>,
    /// Functions that fail for all programs, in addition to the scene's: names, in which `*` matches any characters.
    pub forbid: Vec<String>,
    /// Noise profile of all robots, instead of the scene's: a preset's name or a file.
    pub noise: Option<String>,
    /// Motion of robots that push against walls, instead of the scene's setting.
    pub contact: Option<ContactKind>,
    /// Suite whose checks judge the run, in addition to the scene's.
    pub checks: Option<PathBuf>,
    /// True if programs may run commands of this machine with `OSExecute`.
    pub allow_execute: bool,
    /// True if programs that judge the run ([`CheckKind::Script`](sim_core::spec::CheckKind::Script)) may run; default:
    /// true. Set it to false for a scene from an archive, whose author the user need not trust.
    pub may_run_checks: bool,
    /// Maximum number of bytes that each program can print; further output is discarded; default:
    /// [`DEFAULT_OUTPUT_LIMIT`].
    pub output_limit: u64,
    /// True to record every RoBIOS call.
    pub is_verbose: bool,
    /// True to reject a scene with warnings.
    pub strict: bool,
    /// Folder for the images that programs take, as PNG.
    pub frames: Option<PathBuf>,
    /// True to keep the images, scans and layers of programs, so that a recording can contain them.
    pub keep_frames: bool,
    /// The robot whose program runs in a debugger.
    pub debug: Option<DebugTarget>,
    /// Programs that are part of this process; `programs` and the scene refer to them as if they were files. A trace
    /// contains only their names, so it cannot repeat the run.
    pub embedded: Vec<EmbeddedProgram>,
    /// Archive with the files of the run. A trace names the files by their paths in the archive.
    pub archive: Option<UnpackedArchive>,
}

/// An archive whose files are in a temporary folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnpackedArchive {
    /// Path of the archive.
    pub path: String,
    /// Path of the folder.
    pub folder: String,
}

impl UnpackedArchive {
    /// The text with paths in the archive, `lab.zip/lab.scene.toml`, instead of paths in the folder.
    pub fn packed(&self, text: &str) -> String {
        text.replace(&format!("{}/", self.folder), &format!("{}/", self.path))
    }

    /// The text with paths in the folder instead of paths in the archive.
    pub fn unpacked(&self, text: &str) -> String {
        text.replace(&format!("{}/", self.path), &format!("{}/", self.folder))
    }
}

impl Options {
    /// Number of workers.
    pub fn worker_count(&self) -> usize {
        self.workers.map_or_else(host::processors, NonZeroUsize::get)
    }

    /// Values that override the scene's when its files are read.
    pub fn overrides(&self) -> Overrides<'_> {
        let Self { seed, dialect, maze_cell, settings, .. } = self;
        Overrides { seed: *seed, dialect: *dialect, maze_cell: *maze_cell, settings }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: None,
            slot: None,
            until: None,
            default_until: DEFAULT_UNTIL,
            linger: Time::ZERO,
            workers: None,
            exec: Exec::Fiber,
            sandbox: None,
            timeout: 10.0,
            programs: Vec::new(),
            api: None,
            dialect: None,
            maze_cell: None,
            settings: Vec::new(),
            keys: Vec::new(),
            stdin: None,
            arguments: Vec::new(),
            costs: None,
            forbid: Vec::new(),
            checks: None,
            noise: None,
            contact: None,
            allow_execute: false,
            may_run_checks: true,
            output_limit: DEFAULT_OUTPUT_LIMIT,
            is_verbose: false,
            strict: false,
            frames: None,
            keep_frames: false,
            debug: None,
            embedded: Vec::new(),
            archive: None,
        }
    }
}
