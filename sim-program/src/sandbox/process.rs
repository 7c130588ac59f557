//! Restricts a process between fork and exec, with system calls only and without allocation.

use std::ffi::CString;
use std::io;
use std::os::fd::{AsRawFd as _, OwnedFd};
use std::os::unix::ffi::OsStrExt as _;

use libc::sock_filter;

use super::calls::OWN_PROCESS;
use super::limits::{self, Values};
use super::{Grant, Role};

/// User ids for restricted processes of root begin here: a range without users on Linux systems.
const FIRST_USER: u32 = 0x4000_0000;

/// All restrictions of a process, prepared before the fork.
pub(super) struct Restriction {
    pub limits: Values,
    /// User to which a process of root changes.
    pub user: Option<User>,
    /// Landlock's rules.
    pub files: Option<OwnedFd>,
    /// Filters of system calls.
    pub calls: Vec<Vec<sock_filter>>,
}

/// User of a restricted process that root starts, since limits on processes and permissions of files do not apply to
/// root.
///
/// The user id is otherwise unused, and unique because it is derived from the id of a living process: the program's
/// process or, for the compilers of one host, which share a folder, the host's process. Programs and their data may lie
/// in root's folders. The process may read these by `CAP_DAC_READ_SEARCH`, the only capability that it keeps; Landlock
/// limits which files it reads.
pub(super) struct User {
    /// The process from whose id the user id is derived; `None` for the restricted process itself.
    source_process: Option<u32>,
    /// The scratch folder, which the user will own.
    scratch: CString,
}

impl User {
    /// The user for a child of this process; `None` if this process is not root's.
    ///
    /// # Errors
    /// The path of the scratch folder cannot be passed to a system call.
    pub fn of_process(grant: &Grant<'_>) -> io::Result<Option<Self>> {
        // SAFETY: the call takes no pointer and always succeeds.
        if unsafe { libc::geteuid() } != 0 {
            return Ok(None);
        }
        let scratch = CString::new(grant.scratch.as_os_str().as_bytes())?;
        let source_process = (grant.role == Role::Build).then(std::process::id);
        Ok(Some(Self { source_process, scratch }))
    }

    /// Changes the calling process to this user. Async-signal-safe.
    fn enter(&self) -> io::Result<()> {
        /// From <linux/securebits.h>.
        const SECBIT_NO_SETUID_FIXUP: libc::c_ulong = 1 << 2;
        // SAFETY: the calls get numbers and one string that ends in 0.
        unsafe {
            let id = FIRST_USER + self.source_process.unwrap_or_else(|| libc::getpid().cast_unsigned());
            check(libc::chown(self.scratch.as_ptr(), id, id))?;
            // With this flag the change of the user keeps capabilities, and `access`, with which gcc checks its
            // temporary folder, takes them into account.
            check(libc::prctl(libc::PR_SET_SECUREBITS, SECBIT_NO_SETUID_FIXUP, 0, 0, 0))?;
            check(libc::setgroups(0, std::ptr::null()))?;
            check(libc::setresgid(id, id, id))?;
            check(libc::setresuid(id, id, id))?;
        }
        keep_read_capability()
    }
}

/// Keeps only `CAP_DAC_READ_SEARCH`, also across exec. Async-signal-safe.
fn keep_read_capability() -> io::Result<()> {
    const CAP_DAC_READ_SEARCH: u32 = 2;
    /// `_LINUX_CAPABILITY_VERSION_3` of <linux/capability.h>.
    const VERSION: u32 = 0x2008_0522;
    let only = 1 << CAP_DAC_READ_SEARCH;
    // Header: version and process; data: effective, permitted, inheritable, then their upper halves.
    let (header, data) = ([VERSION, 0], [only, only, only, 0, 0, 0]);
    // SAFETY: header and data have the layout of <linux/capability.h> and are only read.
    unsafe {
        check(libc::syscall(libc::SYS_capset, header.as_ptr(), data.as_ptr()) as i32)?;
        let capability = libc::c_ulong::from(CAP_DAC_READ_SEARCH);
        check(libc::prctl(libc::PR_CAP_AMBIENT, libc::PR_CAP_AMBIENT_RAISE as libc::c_ulong, capability, 0, 0))
    }
}

impl Restriction {
    /// Restricts the calling process irrevocably. Async-signal-safe.
    ///
    /// # Errors
    /// The kernel refuses a restriction.
    pub fn enter(&self) -> io::Result<()> {
        close_descriptors()?;
        // SAFETY: umask takes no pointer and always succeeds.
        unsafe { libc::umask(0o022) };
        for (limit, value) in self.limits {
            // For an ordinary user this limit also counts the processes of the user's session.
            if limit != libc::RLIMIT_NPROC || self.user.is_some() {
                limits::set(limit, value)?;
            }
        }
        if let Some(user) = &self.user {
            user.enter()?;
        }
        // SAFETY: the calls take only numbers.
        unsafe {
            // The change of the user has reset this setting.
            check(libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL as libc::c_ulong, 0, 0, 0))?;
            check(libc::prctl(libc::PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0))?;
        }
        if let Some(files) = &self.files {
            restrict_files(files)?;
        }
        self.calls.iter().try_for_each(|filter| install(filter))
    }
}

/// Lets exec close all descriptors except the standard streams. Async-signal-safe.
fn close_descriptors() -> io::Result<()> {
    // SAFETY: the call takes only numbers.
    let result = unsafe { libc::syscall(libc::SYS_close_range, 3, u32::MAX, libc::CLOSE_RANGE_CLOEXEC) };
    check(result as i32)
}

/// Adds the process's own folder in /proc, whose number is known only now, and enters Landlock's rules.
/// Async-signal-safe.
fn restrict_files(rules: &OwnedFd) -> io::Result<()> {
    /// `struct landlock_path_beneath_attr` of <linux/landlock.h>.
    #[repr(C, packed)]
    struct PathBeneath {
        allowed: u64,
        folder: i32,
    }
    /// The right to read files, and to list folders.
    const READ: u64 = 1 << 2 | 1 << 3;
    const RULE_PATH_BENEATH: u32 = 1;
    // SAFETY: the path ends in 0, the rule is valid for the length of its call; the kernel closes the descriptor at
    // exec.
    unsafe {
        let folder = libc::open(c"/proc/self".as_ptr(), libc::O_PATH | libc::O_CLOEXEC);
        if folder >= 0 {
            let rule = PathBeneath { allowed: READ, folder };
            let rule = &raw const rule;
            check(libc::syscall(libc::SYS_landlock_add_rule, rules.as_raw_fd(), RULE_PATH_BENEATH, rule, 0) as i32)?;
        }
        check(libc::syscall(libc::SYS_landlock_restrict_self, rules.as_raw_fd(), 0) as i32)
    }
}

/// Maximum length of a filter, in instructions.
pub(super) const LONGEST_FILTER: usize = 2048;

/// Installs a filter of system calls for the calling process, whose id replaces [`OWN_PROCESS`]. Async-signal-safe.
fn install(filter: &[sock_filter]) -> io::Result<()> {
    let mut instructions = [sock_filter { code: 0, jt: 0, jf: 0, k: 0 }; LONGEST_FILTER];
    let instructions = instructions.get_mut(..filter.len()).ok_or_else(|| io::Error::from_raw_os_error(libc::E2BIG))?;
    instructions.copy_from_slice(filter);
    // SAFETY: getpid takes no arguments and always succeeds.
    let process = unsafe { libc::getpid() }.cast_unsigned();
    instructions
        .iter_mut()
        .filter(|instruction| instruction.k == OWN_PROCESS)
        .for_each(|instruction| instruction.k = process);
    let program = libc::sock_fprog { len: instructions.len() as u16, filter: instructions.as_mut_ptr() };
    // Without this flag the kernel slows down all later code of the process.
    let flags = libc::SECCOMP_FILTER_FLAG_SPEC_ALLOW;
    // SAFETY: the program is valid, and copied by the kernel.
    check(unsafe { libc::syscall(libc::SYS_seccomp, libc::SECCOMP_SET_MODE_FILTER, flags, &raw const program) } as i32)
}

/// Keeps other processes of this user from reading, writing and tracing this process.
pub(super) fn hide_own_memory() {
    // SAFETY: the call takes only numbers, and fails only for invalid ones.
    unsafe { libc::prctl(libc::PR_SET_DUMPABLE, 0, 0, 0, 0) };
}

fn check(result: i32) -> io::Result<()> {
    if result < 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
}
