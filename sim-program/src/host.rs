//! The program that hosts this library: the command that starts it again, the installation and the tools that it
//! brings.
//!
//! A host other than the binary `eyesim`, such as the Python package, describes itself once with [`set`].

use std::ffi::{OsStr, OsString};
use std::io;
use std::num::NonZeroUsize;
use std::os::unix::process::CommandExt as _;
use std::path::PathBuf;
use std::process::Command;
use std::sync::{LazyLock, OnceLock};
use std::thread;

/// Description of a host other than the binary `eyesim`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Host {
    /// Words that start the command `eyesim`, before its arguments.
    pub command: Vec<OsString>,
    /// File that is the command `eyesim`, for the settings of editors.
    pub script: PathBuf,
    /// Installation that the host brings: the folder for which `%sim%` stands unless the user names another.
    pub home: Option<PathBuf>,
    /// Interpreter of Python programs unless the user names another.
    pub python: Option<PathBuf>,
    /// Command that starts zig, the C and C++ compiler for systems without another; empty if there is none.
    pub zig: Vec<String>,
    /// Command that installs zig; empty if there is none.
    pub zig_installer: String,
}

static HOST: OnceLock<Host> = OnceLock::new();

/// Describes the host of this process. Only the first description takes effect.
pub fn set(host: Host) {
    HOST.get_or_init(|| host);
}

/// The host, if it is not the binary `eyesim`.
pub fn current() -> Option<&'static Host> {
    HOST.get()
}

/// Number of processors that this process may use; 1 if it is unknown.
pub fn processors() -> usize {
    // The standard library reads the files of the control groups in each call.
    static PROCESSORS: LazyLock<usize> = LazyLock::new(|| thread::available_parallelism().map_or(1, NonZeroUsize::get));
    *PROCESSORS
}

/// Words that start the command `eyesim`, before its arguments.
///
/// # Errors
/// The path of this executable cannot be determined.
pub fn words() -> io::Result<Vec<OsString>> {
    match current().map(|host| &host.command).filter(|command| !command.is_empty()) {
        Some(command) => Ok(command.clone()),
        None => Ok(vec![std::env::current_exe()?.into_os_string()]),
    }
}

/// File that is the command `eyesim`.
///
/// # Errors
/// See [`words`].
pub fn script() -> io::Result<PathBuf> {
    current().map_or_else(std::env::current_exe, |host| Ok(host.script.clone()))
}

/// The command `eyesim`, called `name` in lists of processes unless an interpreter runs it: an interpreter finds its
/// installation by its own name.
///
/// # Errors
/// See [`words`].
pub fn command(name: impl AsRef<OsStr>) -> io::Result<Command> {
    let words = words()?;
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]);
    if words.len() == 1 {
        command.arg0(name);
    }
    Ok(command)
}
