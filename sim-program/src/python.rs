//! Python programs, which an interpreter runs through the module `eye`, each in its own process.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use super::cache::Cache;
use super::command::{COMMAND_TIMEOUT, build_output};
use super::compiler::{tool_folders, which};
use crate::host;

/// Oldest minor version of Python 3 that `eye.py` is written for.
const MINOR: u32 = 7;

/// Interpreter and module that run Python programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Python {
    /// The interpreter: `$PYTHON`, otherwise the interpreter of the [host](host), otherwise `python3` on the search
    /// path.
    interpreter: PathBuf,
    /// The module `eye`, which runs a program if it is run as a script.
    eye: PathBuf,
}

/// Interpreter and folders of an installation of Python.
#[derive(Clone, Debug)]
struct PythonHome {
    /// The interpreter itself, not a launcher of it.
    executable: PathBuf,
    /// Folder of modules that the user has installed without root.
    user: PathBuf,
    /// Folders that the interpreter reads: its installation, and the modules that it finds.
    folders: Vec<PathBuf>,
}

impl PythonHome {
    /// Queries an interpreter.
    ///
    /// # Errors
    /// It does not start, or does not answer.
    fn of(interpreter: &Path) -> io::Result<Self> {
        // The modules are loaded before files of the working folder could shadow them.
        const QUESTION: &str = "import sys, site; print(sys.executable, sys.prefix, sys.base_prefix, site.USER_BASE or '', *sys.path, sep='\\n')";
        let mut command = Command::new(interpreter);
        let answer = build_output(command.args(["-c", QUESTION]), COMMAND_TIMEOUT)?;
        let said = String::from_utf8_lossy(&answer.stdout);
        let mut lines = said.lines().map(PathBuf::from);
        let (Some(executable), Some(prefix), Some(base), Some(user)) =
            (lines.next(), lines.next(), lines.next(), lines.next())
        else {
            return Err(io::Error::other(format!("`{}` does not tell its folders", interpreter.display())));
        };
        let mut folders: Vec<PathBuf> = lines.filter(|path| path.is_absolute()).collect();
        let real = std::fs::canonicalize(&executable)?;
        folders.extend(tool_folders(&executable).into_iter().chain(tool_folders(&real)));
        folders.extend([prefix, base].iter().flat_map(|prefix| tool_folders(&prefix.join("bin/python3"))));
        Ok(Self { executable, user, folders })
    }

    /// Lets `command` find the user's modules without the user's environment.
    fn keep_modules(&self, command: &mut Command) {
        if !self.user.as_os_str().is_empty() {
            command.env("PYTHONUSERBASE", &self.user);
        }
    }
}

/// Files and folders that the [host] reads when `command` starts it again without the user's environment, in which the command then finds
/// its modules.
///
/// # Errors
/// The host is unknown, or is an interpreter that does not answer.
pub fn restricted_host(command: &mut Command) -> io::Result<Vec<PathBuf>> {
    /// The interpreter is queried only once in a process.
    static HOME: OnceLock<PythonHome> = OnceLock::new();
    let Some(python) = host::current().and_then(|host| host.python.as_deref()) else {
        return Ok(vec![std::env::current_exe()?]);
    };
    let home = match HOME.get() {
        Some(home) => home,
        None => {
            let asked = PythonHome::of(python)?;
            HOME.get_or_init(|| asked)
        }
    };
    home.keep_modules(command);
    Ok(home.folders.clone())
}

/// Reasons why Python programs cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum PythonError {
    /// The interpreter cannot be started.
    #[error("`{}`, which Python programs need, cannot be run ({error}): install it (Debian: the package `python3`), or name another one in $PYTHON", interpreter.display())]
    Missing {
        /// The interpreter.
        interpreter: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
    /// The interpreter is too old, or is not Python.
    #[error("`{}` is no Python 3.{MINOR} or newer: it says `{said}`", interpreter.display())]
    Unfit {
        /// The interpreter.
        interpreter: PathBuf,
        /// Its output when asked for its version.
        said: String,
    },
    /// The module `eye` cannot be written into the cache.
    #[error("cannot write `eye.py` into the cache: {0}")]
    Cache(io::Error),
}

impl Python {
    /// Looks for the interpreter and writes `eye.py` into `cache`. The interpreter is not started: [`Self::check`]
    /// explains later why a program did not start.
    ///
    /// # Errors
    /// [`PythonError`].
    pub fn find(interpreter: Option<&Path>, cache: &Cache) -> Result<Self, PythonError> {
        let of_host = || host::current().and_then(|host| host.python.as_deref());
        let interpreter = interpreter.or_else(of_host).unwrap_or(Path::new("python3")).to_owned();
        if interpreter.to_str().and_then(which).is_none() {
            let error = io::Error::from_raw_os_error(libc::ENOENT);
            return Err(PythonError::Missing { interpreter, error });
        }
        Ok(Self { interpreter, eye: write_eye(cache).map_err(PythonError::Cache)? })
    }

    /// Starts the interpreter and asks for its version.
    ///
    /// # Errors
    /// [`PythonError`] if it does not start, is too old, or is not Python.
    pub fn check(&self) -> Result<(), PythonError> {
        let interpreter = self.interpreter.clone();
        let mut command = Command::new(&interpreter);
        command.args(["-c", "import sys; print(*sys.version_info[:2])"]);
        let asked = match build_output(&mut command, COMMAND_TIMEOUT) {
            Ok(asked) => asked,
            Err(error) => return Err(PythonError::Missing { interpreter, error }),
        };
        let said = String::from_utf8_lossy(&asked.stdout).trim().to_owned();
        let mut version = said.split(' ').map(str::parse);
        let fits = matches!((version.next(), version.next()), (Some(Ok(3)), Some(Ok(minor))) if minor >= MINOR);
        if asked.status.success() && fits { Ok(()) } else { Err(PythonError::Unfit { interpreter, said }) }
    }

    /// Like [`Self::command`], for a process without the user's environment; also returns the folders that the
    /// interpreter reads.
    ///
    /// # Errors
    /// The interpreter does not start, or does not answer.
    pub fn restricted_command(&self, program: &Path) -> io::Result<(Command, Vec<PathBuf>)> {
        let mut home = PythonHome::of(&self.interpreter)?;
        let mut command = Self { interpreter: home.executable.clone(), eye: self.eye.clone() }.command(program);
        home.keep_modules(&mut command);
        home.folders.push(self.eye.clone());
        Ok((command, home.folders))
    }

    /// The interpreter.
    pub fn interpreter(&self) -> &Path {
        &self.interpreter
    }

    /// The command that runs `program` as a robot's child process. Environment variables that would make runs differ
    /// are fixed.
    pub fn command(&self, program: &Path) -> Command {
        let mut command = Command::new(&self.interpreter);
        command.arg("-B").arg(&self.eye).arg(program).env("PYTHONHASHSEED", "0").env("TZ", "UTC0");
        // Multi-threaded sums depend on the number of threads, which differs by machine; the user may still set these variables.
        for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
            if std::env::var_os(name).is_none() {
                command.env(name, "1");
            }
        }
        command
    }
}

fn write_eye(cache: &Cache) -> io::Result<PathBuf> {
    let text = robios_sys::python::eye();
    let digest = &blake3::hash(text.as_bytes()).to_hex()[..32];
    let path = cache.folder("kits")?.join(digest).join("eye.py");
    if !std::fs::read(&path).is_ok_and(|there| there == text.as_bytes()) {
        cache.write_atomically(&path, text.as_bytes())?;
    }
    Ok(path)
}
