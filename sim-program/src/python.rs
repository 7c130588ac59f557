//! Commands that run Python programs: an interpreter runs each in its own process, through the module `eye`.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use super::cache::Cache;
use super::command::{COMMAND_TIMEOUT, build_output};
use super::compiler::{tool_folders, which};
use crate::host;

/// Oldest minor version of Python 3 that `eye.py` supports.
const OLDEST_MINOR: u32 = 7;

/// Interpreter and module that run Python programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Python {
    /// The interpreter: `$PYTHON`, otherwise the interpreter of the [host](host), otherwise `python3` on the search
    /// path.
    interpreter: PathBuf,
    /// File of the module `eye`. Started as a script, it runs the robot program that its argument names.
    eye: PathBuf,
}

/// Interpreter and folders of an installation of Python.
#[derive(Clone, Debug)]
struct PythonHome {
    /// The interpreter itself, not its launcher.
    executable: PathBuf,
    /// Folder of modules that the user has installed without root.
    user_base: PathBuf,
    /// Folders that the interpreter reads: its installation, and the modules that it finds.
    folders: Vec<PathBuf>,
}

impl PythonHome {
    /// Queries an interpreter.
    ///
    /// # Errors
    /// The interpreter does not start, or does not answer.
    fn query(interpreter: &Path) -> io::Result<Self> {
        // Files of the working folder cannot shadow `sys` and `site`: the interpreter has imported both before it adds
        // that folder to its search path.
        const QUERY: &str = "import sys, site; print(sys.executable, sys.prefix, sys.base_prefix, site.USER_BASE or '', *sys.path, sep='\\n')";
        let mut command = Command::new(interpreter);
        let answer = build_output(command.args(["-c", QUERY]), COMMAND_TIMEOUT)?;
        let answer_text = String::from_utf8_lossy(&answer.stdout);
        let mut lines = answer_text.lines().map(PathBuf::from);
        let (Some(executable), Some(prefix), Some(base_prefix), Some(user_base)) =
            (lines.next(), lines.next(), lines.next(), lines.next())
        else {
            return Err(io::Error::other(format!("`{}` does not report its folders", interpreter.display())));
        };
        let mut folders: Vec<PathBuf> = lines.filter(|path| path.is_absolute()).collect();
        let real = std::fs::canonicalize(&executable)?;
        folders.extend(tool_folders(&executable).into_iter().chain(tool_folders(&real)));
        folders.extend([prefix, base_prefix].iter().flat_map(|prefix| tool_folders(&prefix.join("bin/python3"))));
        Ok(Self { executable, user_base, folders })
    }

    /// Sets the variable with which `command`, which does not inherit the user's environment, finds the modules that
    /// the user has installed.
    fn keep_modules(&self, command: &mut Command) {
        if !self.user_base.as_os_str().is_empty() {
            command.env("PYTHONUSERBASE", &self.user_base);
        }
    }
}

/// Prepares `command`, which starts the [host] again without the user's environment: sets the variable with which a
/// Python host finds the user's modules. Returns the files and folders that the host reads.
///
/// # Errors
/// The path of this executable cannot be determined, or the host is an interpreter that does not answer.
pub fn restricted_host(command: &mut Command) -> io::Result<Vec<PathBuf>> {
    /// The interpreter is queried only once in a process.
    static HOME: OnceLock<PythonHome> = OnceLock::new();
    let Some(python) = host::current().and_then(|host| host.python.as_deref()) else {
        return Ok(vec![std::env::current_exe()?]);
    };
    let home = match HOME.get() {
        Some(home) => home,
        None => {
            let queried = PythonHome::query(python)?;
            HOME.get_or_init(|| queried)
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
    #[error("`{}` is not Python 3.{OLDEST_MINOR} or newer: it says `{answer}`", interpreter.display())]
    Unfit {
        /// The interpreter.
        interpreter: PathBuf,
        /// Output of the interpreter when its version is queried.
        answer: String,
    },
    /// The module `eye` cannot be written into the cache.
    #[error("cannot write `eye.py` into the cache: {0}")]
    Cache(io::Error),
}

impl Python {
    /// Finds the interpreter and writes `eye.py` into `cache`. Does not start the interpreter. If a program fails to
    /// start later, [`Self::check`] finds out whether the interpreter is the reason.
    ///
    /// # Errors
    /// [`PythonError`].
    pub fn find(interpreter: Option<&Path>, cache: &Cache) -> Result<Self, PythonError> {
        let host_interpreter = || host::current().and_then(|host| host.python.as_deref());
        let interpreter = interpreter.or_else(host_interpreter).unwrap_or(Path::new("python3")).to_owned();
        if interpreter.to_str().and_then(which).is_none() {
            let error = io::Error::from_raw_os_error(libc::ENOENT);
            return Err(PythonError::Missing { interpreter, error });
        }
        Ok(Self { interpreter, eye: write_eye(cache).map_err(PythonError::Cache)? })
    }

    /// Checks the version that the interpreter reports.
    ///
    /// # Errors
    /// [`PythonError`] if it does not start, is too old, or is not Python.
    pub fn check(&self) -> Result<(), PythonError> {
        let interpreter = self.interpreter.clone();
        let mut command = Command::new(&interpreter);
        command.args(["-c", "import sys; print(*sys.version_info[:2])"]);
        let output = match build_output(&mut command, COMMAND_TIMEOUT) {
            Ok(output) => output,
            Err(error) => return Err(PythonError::Missing { interpreter, error }),
        };
        let answer = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        let mut version = answer.split(' ').map(str::parse);
        let fits = matches!((version.next(), version.next()), (Some(Ok(3)), Some(Ok(minor))) if minor >= OLDEST_MINOR);
        if output.status.success() && fits { Ok(()) } else { Err(PythonError::Unfit { interpreter, answer }) }
    }

    /// Like [`Self::command`], for a process without the user's environment; also returns the folders that the
    /// interpreter reads.
    ///
    /// # Errors
    /// The interpreter does not start, or does not answer.
    pub fn restricted_command(&self, program: &Path) -> io::Result<(Command, Vec<PathBuf>)> {
        let mut home = PythonHome::query(&self.interpreter)?;
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
        // Multi-threaded sums depend on the number of threads, which differs by machine; the user may still set these
        // variables.
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
    if !std::fs::read(&path).is_ok_and(|existing| existing == text.as_bytes()) {
        cache.write_atomically(&path, text.as_bytes())?;
    }
    Ok(path)
}
