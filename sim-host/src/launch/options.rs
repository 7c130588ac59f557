//! What a run is told beside its scene.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use sim_core::time::Time;

use super::settings::ProgramOption;
use crate::executive::load::Debug;
use crate::executive::program::Exec;
use crate::program::Generation;
use crate::robios::console::DEFAULT_OUTPUT_LIMIT;

/// Simulated time after which a run ends when nobody says anything.
pub const DEFAULT_UNTIL: Time = Time::from_millis(600_000);

/// What a run is told beside its scene; by default nothing. What is said here goes before what the scene says.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of all randomness; that of the scene, else 0, where none is given.
    pub seed: Option<u64>,
    /// Length of a slot; that of the scene, else 50 ms, where none is given.
    pub slot: Option<Time>,
    /// Simulated time at which the run ends; that of the scene, else [`Options::default_until`], where none is given.
    pub until: Option<Time>,
    /// When the run ends where neither [`Options::until`] nor the scene says it: [`DEFAULT_UNTIL`].
    pub default_until: Time,
    /// How long the run goes on after its last program has ended, as long as anything moves; not at all.
    pub linger: Time,
    /// Robots that run at one time; one for each processor where nothing is given.
    pub workers: Option<NonZeroUsize>,
    /// Where programs run: on threads of this process by default. [`Exec::Process`] needs a `main` that calls [`serve_child`](super::serve_child) first.
    pub exec: Exec,
    /// Processor time in seconds that a program may compute within one slot before it is stopped; 10 s.
    pub timeout: f64,
    /// Programs of robots, in place of the scene's.
    pub programs: Vec<ProgramOption>,
    /// Generation of RoBIOS that the programs are written for.
    pub api: Option<Generation>,
    /// Keys that are pressed: `2.5:KEY1, 4:KEY4`, for one robot `2:2.5:KEY1`.
    pub keys: Vec<String>,
    /// Arguments of programs in place of the scene's: `1:--kp 0.5`, without a number for all robots.
    pub arguments: Vec<String>,
    /// The file of what RoBIOS calls cost, in place of the scene's.
    pub costs: Option<PathBuf>,
    /// Errors of devices and drives of all robots, in place of the scene's: a preset's name or a noise profile's file.
    pub noise: Option<String>,
    /// Programs may run commands of this machine with `OSExecute`.
    pub allow_execute: bool,
    /// Bytes that each program may print before the rest is cut: [`DEFAULT_OUTPUT_LIMIT`].
    pub output_limit: u64,
    /// Every RoBIOS call is recorded.
    pub is_verbose: bool,
    /// A scene that has warnings is not run.
    pub strict: bool,
    /// The folder for the images that programs take, as PNG.
    pub frames: Option<PathBuf>,
    /// The images that programs take are kept for a recording.
    pub keep_frames: bool,
    /// The robot whose program runs in a debugger.
    pub debug: Option<Debug>,
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
            exec: Exec::Thread,
            timeout: 10.0,
            programs: Vec::new(),
            api: None,
            keys: Vec::new(),
            arguments: Vec::new(),
            costs: None,
            noise: None,
            allow_execute: false,
            output_limit: DEFAULT_OUTPUT_LIMIT,
            is_verbose: false,
            strict: false,
            frames: None,
            keep_frames: false,
            debug: None,
        }
    }
}
