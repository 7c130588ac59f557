//! Limits on the resources of a restricted process.

use std::io;
use std::time::Duration;

/// Limits of one process and its descendants, as far as the kernel counts them together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Processor time, after which the kernel kills the process.
    pub processor_time: Duration,
    /// Address space that it may map, in bytes.
    pub memory: u64,
    /// Processes and threads.
    pub processes: u64,
    /// Size of one file, in bytes.
    pub file_size: u64,
    /// Bytes of all files in its scratch folder.
    pub scratch: u64,
    /// Open files.
    pub open_files: u64,
}

/// Resource limits of the kernel (`RLIMIT_...`) and their values.
pub(super) type Values = [(u32, u64); 8];

impl Limits {
    /// Default limits of a robot's program; our choice.
    pub const PROGRAM_DEFAULT: Self = Self {
        processor_time: Duration::from_secs(600),
        memory: 4 << 30,
        processes: 128,
        file_size: 32 << 20,
        scratch: 64 << 20,
        open_files: 256,
    };

    /// Default limits of a compiler; our choice.
    pub const BUILD_DEFAULT: Self = Self {
        processor_time: Duration::from_secs(600),
        memory: 8 << 30,
        processes: 512,
        file_size: 512 << 20,
        scratch: 2 << 30,
        open_files: 1024,
    };

    /// The kernel's limits and their values. The limit on processes is set only for a process that changes to an unused
    /// user id.
    pub(super) fn values(&self) -> Values {
        [
            (libc::RLIMIT_CPU, self.processor_time.as_secs().max(1)),
            (libc::RLIMIT_AS, self.memory),
            (libc::RLIMIT_FSIZE, self.file_size),
            (libc::RLIMIT_NOFILE, self.open_files),
            (libc::RLIMIT_CORE, 0),
            (libc::RLIMIT_MEMLOCK, 64 << 10),
            (libc::RLIMIT_MSGQUEUE, 0),
            (libc::RLIMIT_NPROC, self.processes),
        ]
    }
}

/// Sets a limit of the calling process, irrevocably. Async-signal-safe.
///
/// # Errors
/// The kernel refuses.
pub(super) fn set(limit: u32, value: u64) -> io::Result<()> {
    let mut current = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: both calls get one valid limit.
    let result = unsafe {
        match libc::getrlimit(limit as _, &mut current) {
            0 => {
                let value = value.min(current.rlim_max);
                libc::setrlimit(limit as _, &libc::rlimit { rlim_cur: value, rlim_max: value })
            }
            failed => failed,
        }
    };
    if result == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}
