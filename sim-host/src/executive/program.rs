//! A robot's loaded program, in this process or in its own.

use std::sync::Arc;
use std::time::Instant;

use robios_sys::{Robios6, Robios7, Support};

use super::confine::confine_thread;
use super::embedded::EmbeddedRobot;
use super::failure::Failure;
use super::process::Child;
use super::process::serve::RemoteProgram;
use super::signal::FlowBlock;
use crate::program::embedded::EmbeddedCode;
use crate::program::image::SourceLine;
use crate::program::load::LoadedProgram;
use crate::program::shared::Variables;
use crate::program::site::Site;

/// The user's choice of where programs run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Exec {
    /// In a process of its own if its imports show that it could end or stop the host; otherwise like `Fiber`.
    Auto,
    /// On a fiber of the host; on a thread if it could end the host, or if it is bound to its thread
    /// ([`why_thread_bound`](crate::program::prepare::Prepared::why_thread_bound)).
    #[default]
    Fiber,
    /// On a thread of the host.
    Thread,
    /// In a process of its own.
    Process,
}

/// Kind of execution of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExecutionKind {
    /// On a fiber of the host, which shares its thread with other fibers.
    Fiber,
    /// On a thread of the host.
    Thread,
    /// In a process of its own.
    Process,
}

/// A robot's program, ready to run.
pub enum RobotProgram {
    /// In this process, on its flow's fiber or thread.
    InHost {
        /// The program.
        program: LoadedProgram,
        /// Its flows are fibers.
        is_fiber: bool,
    },
    /// In a process of its own, which its flow's thread serves.
    Process(RemoteProgram),
    /// Code of the process that embeds the simulator, on its flow's thread.
    Embedded(EmbeddedRobot),
}

impl RobotProgram {
    /// Runs the program's `main`, answers its calls with `host` on this thread, and returns its exit code. Must not be
    /// called again before it returns.
    ///
    /// # Errors
    /// [`Failure`] if the process of the program failed, or if an embedded program was overdue. If another program in
    /// this process fails, its flow fails, and this function does not return.
    pub fn run<H: Support + Robios6 + Robios7 + Sync + 'static>(&self, host: &H) -> Result<i32, Failure> {
        match self {
            Self::InHost { program, .. } => {
                confine_thread();
                self.register_consoles();
                Ok(program.run(host))
            }
            Self::Process(program) => program.run(host),
            Self::Embedded(program) => program.run(host),
        }
    }

    /// Makes the calling flow store the program's unfinished lines if the program fails on it.
    pub fn register_consoles(&self) {
        if let Self::InHost { program, .. } = self {
            FlowBlock::current().set_consoles(program.consoles());
        }
    }

    /// Returns true if the program's flows are fibers.
    pub fn is_fiber(&self) -> bool {
        matches!(self, Self::InHost { is_fiber: true, .. })
    }

    /// The program's variables in a copy of its library that it shares with other robots; `None` if it has its own
    /// copy.
    pub fn variables(&self) -> Option<&Arc<Variables>> {
        match self {
            Self::InHost { program, .. } => program.variables(),
            Self::Process(_) | Self::Embedded(_) => None,
        }
    }

    /// The number of arguments of the program's `main`, without `argv[0]`; `None` for code of the embedding process.
    pub fn argument_count(&self) -> Option<usize> {
        match self {
            Self::InHost { program, .. } => Some(program.argument_count()),
            Self::Process(program) => Some(program.argument_count()),
            Self::Embedded(_) => None,
        }
    }

    /// The program's process, if it has its own.
    pub fn child(&self) -> Option<&Arc<Child>> {
        match self {
            Self::InHost { .. } | Self::Embedded(_) => None,
            Self::Process(program) => Some(program.child()),
        }
    }

    /// The code of the embedding process, if the program is such code.
    pub fn embedded(&self) -> Option<&Arc<dyn EmbeddedCode>> {
        match self {
            Self::Embedded(program) => Some(program.code()),
            Self::InHost { .. } | Self::Process(_) => None,
        }
    }

    /// Ends the program's own process, which may close its files until `deadline`; does nothing for a program in this
    /// process.
    pub fn end(&self, deadline: Instant) {
        if let Some(child) = self.child() {
            child.end(deadline);
        }
    }

    /// The line in the program's own sources to which a call stack leads, see [`LoadedProgram::own_source_line`].
    pub fn own_source_line(&self, addresses: &[usize]) -> Option<SourceLine> {
        match self {
            Self::InHost { program, .. } => program.own_source_line(addresses),
            Self::Process(program) => program.own_source_line(addresses),
            Self::Embedded(_) => None,
        }
    }

    /// The text of a line of the program's own sources; `None` if it cannot be read.
    pub fn text_of(&self, line: &SourceLine) -> Option<String> {
        let index = usize::try_from(line.line).ok()?.checked_sub(1)?;
        self.source_of(line)?.lines().nth(index).map(str::to_owned)
    }

    /// The text of the program's own source that contains `line`; `None` if it cannot be read.
    pub fn source_of(&self, line: &SourceLine) -> Option<String> {
        match self {
            Self::InHost { program, .. } => program.source_of(line),
            Self::Process(program) => program.source_of(line),
            Self::Embedded(_) => None,
        }
    }

    /// Name of the function in the program's library at a program counter, if the debug information contains it.
    pub fn function_at(&self, address: usize) -> Option<String> {
        let line = match self {
            Self::InHost { program, .. } => program.source_line(address),
            Self::Process(program) => program.source_line(address),
            Self::Embedded(_) => None,
        };
        line?.function
    }

    /// Location of the program's call in progress. May be called only during a call, by the flow that serves it.
    pub fn call_site(&self) -> Site {
        match self {
            Self::InHost { program, .. } => Site::InHost(program.call_site()),
            Self::Process(program) => Site::Reported(program.call_site()),
            Self::Embedded(program) => Site::Reported(program.call_site()),
        }
    }

    /// A location in this program as text, such as `maze.c:88`.
    pub fn location_of(&self, site: &Site) -> Option<String> {
        match (self, site) {
            (Self::InHost { program, .. }, Site::InHost(site)) => program.location_of(site),
            (Self::Process(program), Site::Reported(site)) => program.location_of(site),
            (Self::InHost { .. } | Self::Embedded(_), Site::Reported(site)) => site.line(),
            _ => None,
        }
    }
}
