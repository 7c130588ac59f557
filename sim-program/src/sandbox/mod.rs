//! Sandbox: kernel-enforced restrictions on the processes that compile and run untrusted programs.
//!
//! A [`Level`] determines which [areas](Area) are closed to such a process, and [`Kernel`] determines the features with
//! which this kernel closes them. [`Sandbox::new`] refuses a level that the kernel does not support. [`Sandbox::apply`]
//! restricts a command before it is started: [`files`] with Landlock, [`calls`] with seccomp, [`limits`] with resource
//! limits, and `process` applies them between fork and exec. `docs/sandbox.md` lists what is not protected.

pub mod calls;
pub mod files;
pub mod kernel;
pub mod limits;
mod process;
pub mod scratch;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};

pub use kernel::Kernel;
pub use limits::Limits;
use process::{Restriction, User};

/// Kind of access that a sandbox denies to a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Area {
    /// Files and folders other than the system libraries', the program's own and the scratch folder.
    Files,
    /// All sockets.
    Network,
    /// Signals to any other process.
    Signals,
    /// Memory of other processes, by tracing or by any other call.
    Memory,
    /// Processor time, memory, processes, files and space beyond the [limits](Limits).
    Resources,
}

impl Area {
    /// All areas.
    pub const ALL: [Self; 5] = [Self::Files, Self::Network, Self::Signals, Self::Memory, Self::Resources];

    /// The area's name in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Files => "files",
            Self::Network => "network",
            Self::Signals => "signals",
            Self::Memory => "memory",
            Self::Resources => "resources",
        }
    }
}

/// Set of areas that a sandbox closes; each level closes all that the weaker ones close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Only resources.
    Limits,
    /// All but files: for kernels without Landlock.
    Calls,
    /// All areas.
    #[default]
    Full,
}

impl Level {
    /// All levels, weakest first.
    pub const ALL: [Self; 3] = [Self::Limits, Self::Calls, Self::Full];

    /// The level's name on the command line and in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Limits => "limits",
            Self::Calls => "calls",
            Self::Full => "full",
        }
    }

    /// The areas that the level closes.
    pub fn areas(self) -> impl Iterator<Item = Area> {
        Area::ALL.into_iter().filter(move |area| match area {
            Area::Resources => true,
            Area::Network | Area::Signals | Area::Memory => self >= Self::Calls,
            Area::Files => self == Self::Full,
        })
    }

    /// The level of this name.
    ///
    /// # Errors
    /// Message with the accepted names.
    pub fn parse(text: &str) -> Result<Self, String> {
        let level = Self::ALL.into_iter().find(|level| level.word() == text);
        level.ok_or_else(|| "expected full, calls or limits".to_owned())
    }
}

/// A level that the kernel does not support.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "this kernel cannot close {} to programs ({missing}), which the sandbox level `{}` requires: the strongest level here is `--sandbox={}`",
    area.word(), level.word(), strongest.word()
)]
pub struct UnsupportedLevel {
    level: Level,
    area: Area,
    missing: &'static str,
    strongest: Level,
}

/// Kind of process that is restricted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A robot's program: it may start threads but not processes.
    Program,
    /// A compiler or build tool: it may start processes.
    Build,
}

/// Resources that one process may use.
#[derive(Clone, Debug)]
pub struct Grant<'a> {
    /// Kind of process.
    pub role: Role,
    /// Files and folders that it may read in addition to the system's; those that do not exist are skipped.
    pub readable: Vec<PathBuf>,
    /// Folder that it may write to, which must exist. It becomes `HOME` and `TMPDIR`.
    pub scratch: &'a Path,
}

/// Restrictions for processes that run untrusted programs.
#[derive(Clone, Debug)]
pub struct Sandbox {
    level: Level,
    kernel: Kernel,
    /// Limits of a robot's program.
    pub program_limits: Limits,
    /// Limits of a compiler.
    pub build_limits: Limits,
    /// Folder that contains the sources of programs, if they lie in several folders; the folder of a program's first
    /// source is always readable.
    pub root: Option<PathBuf>,
}

/// Record of a sandbox in a report.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SandboxReport {
    /// Name of the level.
    pub level: String,
    /// Closed areas, each with the means that close it.
    pub closed: BTreeMap<String, String>,
}

impl Sandbox {
    /// A sandbox of `level` on this kernel, with the default limits. From [`Level::Calls`] on, no other process of the
    /// same user can trace this process or read its memory afterwards.
    ///
    /// # Errors
    /// [`UnsupportedLevel`] if the kernel lacks what the level needs.
    pub fn new(level: Level) -> Result<Self, UnsupportedLevel> {
        let kernel = Kernel::probe();
        kernel.check(level)?;
        if level >= Level::Calls {
            process::hide_own_memory();
        }
        Ok(Self {
            level,
            kernel,
            program_limits: Limits::PROGRAM_DEFAULT,
            build_limits: Limits::BUILD_DEFAULT,
            root: None,
        })
    }

    /// The sandbox's level.
    pub fn level(&self) -> Level {
        self.level
    }

    /// Folders that a program with these sources is built from, with symbolic links resolved: the folder of the first
    /// source, and the [root](Self::root).
    pub fn source_folders(&self, sources: &[PathBuf]) -> Vec<PathBuf> {
        let folder = sources.first().and_then(|path| path.parent());
        let folder = folder.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        folder.into_iter().chain(self.root.as_deref()).filter_map(|folder| folder.canonicalize().ok()).collect()
    }

    /// The sandbox's record in a report.
    pub fn report(&self) -> SandboxReport {
        let means = |area: Area| Some((area.word().to_owned(), self.kernel.describe_means(area).ok()?));
        SandboxReport { level: self.level.word().to_owned(), closed: self.level.areas().filter_map(means).collect() }
    }

    /// Restricts `command`: its process and all descendants get no more than `grant` allows. The environment is
    /// replaced by a short list of variables and those that were set on the command; descriptors other than the
    /// standard streams are closed. The standard streams must be pipes or files that no other process has open, because
    /// changes to a shared file affect all its users.
    ///
    /// If this process is root's, the command runs under an otherwise unused user id.
    ///
    /// # Errors
    /// The kernel refuses the rules.
    pub fn apply(&self, command: &mut Command, grant: &Grant<'_>) -> io::Result<()> {
        replace_environment(command, grant.scratch);
        let is_full = self.level == Level::Full;
        let restriction = Restriction {
            limits: match grant.role {
                Role::Program => self.program_limits.values(),
                Role::Build => self.build_limits.values(),
            },
            user: User::of_process(grant)?,
            files: is_full.then(|| files::rules(grant)).transpose()?,
            calls: match self.level {
                Level::Limits => Vec::new(),
                Level::Calls | Level::Full => calls::filters(grant.role, &self.kernel)?,
            },
        };
        // SAFETY: the function allocates nothing and makes only system calls, and so is async-signal-safe.
        unsafe { command.pre_exec(move || restriction.enter()) };
        Ok(())
    }
}

/// Environment variables that a restricted process inherits.
const INHERITED_VARIABLES: [&str; 6] = ["PATH", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "TERM"];

/// Reduces the environment of `command` to the variables that were set on it, the
/// [inherited ones](INHERITED_VARIABLES), and the scratch folder as home.
fn replace_environment(command: &mut Command, scratch: &Path) {
    let set: Vec<(OsString, OsString)> =
        command.get_envs().filter_map(|(name, value)| Some((name.to_owned(), value?.to_owned()))).collect();
    command.env_clear();
    command.envs(INHERITED_VARIABLES.iter().filter_map(|name| Some((name, std::env::var_os(name)?))));
    command.env("HOME", scratch).env("TMPDIR", scratch).envs(set);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_level_closes_the_areas_of_the_weaker_ones() {
        let closed = |level: Level| level.areas().map(Area::word).collect::<Vec<_>>();
        assert_eq!(closed(Level::Limits), ["resources"]);
        assert_eq!(closed(Level::Calls), ["network", "signals", "memory", "resources"]);
        assert_eq!(closed(Level::Full), Area::ALL.map(Area::word));
        assert!(Level::ALL.into_iter().all(|level| Level::parse(level.word()) == Ok(level)));
        assert_eq!(Level::parse("none").unwrap_err(), "expected full, calls or limits");
    }
}
