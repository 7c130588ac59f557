//! Seccomp: the system calls that a restricted process may make.
//!
//! The list is an allowlist: a call that is new in the kernel, or was not considered, is denied. The filter checks the
//! architecture, and calls of the x32 interface have numbers that are not on the list. An old call that is not on the
//! list fails with `EPERM`. A call from [`FIRST_NEW`] on that is not on the list, such as `clone3`, whose flags a
//! filter cannot read, fails with `ENOSYS`, so that the C library falls back to an older call.

use std::collections::BTreeMap;
use std::io;

use libc::{c_long, sock_filter};
use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter, SeccompRule,
};

use super::process::LONGEST_FILTER;
use super::{Kernel, Role};

/// Placeholder for the process id in a filter; greater than any process id.
pub(super) const OWN_PROCESS: u32 = 0x5A17_C0DE;

/// Smallest number of a new system call: from here on, calls have the same numbers on all architectures, and old
/// kernels lack them.
pub const FIRST_NEW: c_long = 424;

/// Number up to which new system calls are filtered.
const LAST_NEW: c_long = 600;

/// Calls that a restricted process may make with any arguments.
const ALLOWED: &[c_long] = &[
    // Files; paths are checked by Landlock.
    libc::SYS_read,
    libc::SYS_write,
    libc::SYS_readv,
    libc::SYS_writev,
    libc::SYS_pread64,
    libc::SYS_pwrite64,
    libc::SYS_preadv,
    libc::SYS_pwritev,
    libc::SYS_preadv2,
    libc::SYS_pwritev2,
    libc::SYS_openat,
    libc::SYS_openat2,
    libc::SYS_close,
    libc::SYS_close_range,
    libc::SYS_fstat,
    libc::SYS_newfstatat,
    libc::SYS_statx,
    libc::SYS_statfs,
    libc::SYS_fstatfs,
    libc::SYS_lseek,
    libc::SYS_faccessat,
    libc::SYS_faccessat2,
    libc::SYS_getdents64,
    libc::SYS_getcwd,
    libc::SYS_chdir,
    libc::SYS_fchdir,
    libc::SYS_renameat2,
    libc::SYS_renameat,
    libc::SYS_mkdirat,
    libc::SYS_linkat,
    libc::SYS_symlinkat,
    libc::SYS_unlinkat,
    libc::SYS_readlinkat,
    libc::SYS_ftruncate,
    libc::SYS_fallocate,
    libc::SYS_fadvise64,
    libc::SYS_readahead,
    libc::SYS_fsync,
    libc::SYS_fdatasync,
    libc::SYS_flock,
    libc::SYS_fcntl,
    libc::SYS_umask,
    libc::SYS_dup,
    libc::SYS_dup3,
    libc::SYS_pipe2,
    libc::SYS_sendfile,
    libc::SYS_copy_file_range,
    libc::SYS_ppoll,
    libc::SYS_pselect6,
    libc::SYS_epoll_create1,
    libc::SYS_epoll_ctl,
    libc::SYS_epoll_pwait,
    libc::SYS_epoll_pwait2,
    libc::SYS_eventfd2,
    libc::SYS_signalfd4,
    libc::SYS_timerfd_create,
    libc::SYS_timerfd_settime,
    libc::SYS_timerfd_gettime,
    // The process's own memory.
    libc::SYS_mmap,
    libc::SYS_mprotect,
    libc::SYS_munmap,
    libc::SYS_mremap,
    libc::SYS_madvise,
    libc::SYS_mincore,
    libc::SYS_msync,
    libc::SYS_brk,
    libc::SYS_pkey_alloc,
    libc::SYS_pkey_free,
    libc::SYS_pkey_mprotect,
    libc::SYS_get_mempolicy,
    libc::SYS_membarrier,
    // The process's own signals and times.
    libc::SYS_rt_sigaction,
    libc::SYS_rt_sigprocmask,
    libc::SYS_rt_sigreturn,
    libc::SYS_rt_sigpending,
    libc::SYS_rt_sigtimedwait,
    libc::SYS_rt_sigsuspend,
    libc::SYS_sigaltstack,
    libc::SYS_restart_syscall,
    libc::SYS_nanosleep,
    libc::SYS_clock_nanosleep,
    libc::SYS_clock_gettime,
    libc::SYS_clock_getres,
    libc::SYS_gettimeofday,
    libc::SYS_times,
    libc::SYS_timer_create,
    libc::SYS_timer_settime,
    libc::SYS_timer_gettime,
    libc::SYS_timer_getoverrun,
    libc::SYS_timer_delete,
    libc::SYS_getitimer,
    libc::SYS_setitimer,
    // Threads and the process itself.
    libc::SYS_futex,
    libc::SYS_futex_waitv,
    libc::SYS_set_robust_list,
    libc::SYS_set_tid_address,
    libc::SYS_rseq,
    libc::SYS_sched_yield,
    libc::SYS_sched_getaffinity,
    libc::SYS_sched_getparam,
    libc::SYS_sched_getscheduler,
    libc::SYS_sched_get_priority_max,
    libc::SYS_sched_get_priority_min,
    libc::SYS_getcpu,
    libc::SYS_getrandom,
    libc::SYS_getpid,
    libc::SYS_getppid,
    libc::SYS_gettid,
    libc::SYS_getpgid,
    libc::SYS_getsid,
    libc::SYS_getuid,
    libc::SYS_geteuid,
    libc::SYS_getgid,
    libc::SYS_getegid,
    libc::SYS_getresuid,
    libc::SYS_getresgid,
    libc::SYS_getgroups,
    libc::SYS_getpriority,
    libc::SYS_getrusage,
    libc::SYS_uname,
    libc::SYS_sysinfo,
    libc::SYS_prctl,
    libc::SYS_seccomp,
    libc::SYS_exit,
    libc::SYS_exit_group,
    libc::SYS_wait4,
    libc::SYS_waitid,
    // Replaces only the program of the calling process; all restrictions remain.
    libc::SYS_execve,
];

/// Further allowed calls of this architecture: on x86-64, those that later architectures lack.
#[cfg(target_arch = "x86_64")]
const ALLOWED_ON_ARCHITECTURE: &[c_long] = &[
    libc::SYS_open,
    libc::SYS_creat,
    libc::SYS_stat,
    libc::SYS_lstat,
    libc::SYS_access,
    libc::SYS_getdents,
    libc::SYS_rename,
    libc::SYS_mkdir,
    libc::SYS_rmdir,
    libc::SYS_link,
    libc::SYS_symlink,
    libc::SYS_unlink,
    libc::SYS_readlink,
    libc::SYS_dup2,
    libc::SYS_pipe,
    libc::SYS_poll,
    libc::SYS_select,
    libc::SYS_epoll_create,
    libc::SYS_epoll_wait,
    libc::SYS_eventfd,
    libc::SYS_signalfd,
    libc::SYS_alarm,
    libc::SYS_pause,
    libc::SYS_time,
    libc::SYS_getpgrp,
    libc::SYS_getrlimit,
    libc::SYS_setrlimit,
    libc::SYS_arch_prctl,
];
#[cfg(target_arch = "aarch64")]
const ALLOWED_ON_ARCHITECTURE: &[c_long] = &[libc::SYS_getrlimit, libc::SYS_setrlimit];

/// Calls that start processes.
#[cfg(target_arch = "x86_64")]
const PROCESS_STARTING: &[c_long] = &[libc::SYS_fork, libc::SYS_vfork];
#[cfg(target_arch = "aarch64")]
const PROCESS_STARTING: &[c_long] = &[];

/// Calls that change modes, owners and times of files, which Landlock does not control. For a compiler they do nothing
/// and report success: it does not need their effect, but would fail on an error.
#[cfg(target_arch = "x86_64")]
const METADATA_CHANGING: &[c_long] = &[
    libc::SYS_fchmod,
    libc::SYS_fchmodat,
    libc::SYS_fchmodat2,
    libc::SYS_fchown,
    libc::SYS_fchownat,
    libc::SYS_utimensat,
    libc::SYS_chmod,
    libc::SYS_chown,
    libc::SYS_lchown,
    libc::SYS_utime,
    libc::SYS_utimes,
    libc::SYS_futimesat,
];
#[cfg(target_arch = "aarch64")]
const METADATA_CHANGING: &[c_long] = &[
    libc::SYS_fchmod,
    libc::SYS_fchmodat,
    libc::SYS_fchmodat2,
    libc::SYS_fchown,
    libc::SYS_fchownat,
    libc::SYS_utimensat,
];

/// Flags of `clone` that create namespaces.
const NAMESPACES: u64 = (libc::CLONE_NEWNS
    | libc::CLONE_NEWCGROUP
    | libc::CLONE_NEWUTS
    | libc::CLONE_NEWIPC
    | libc::CLONE_NEWUSER
    | libc::CLONE_NEWPID
    | libc::CLONE_NEWNET) as u32 as u64;

/// Condition on the lower 32 bits of the argument with this index, from 0.
fn argument(index: u8, compare: SeccompCmpOp, value: u64) -> Result<SeccompCondition, seccompiler::BackendError> {
    SeccompCondition::new(index, SeccompCmpArgLen::Dword, compare, value)
}

/// The filters of a process, in the order in which they are installed.
pub(super) fn filters(role: Role, kernel: &Kernel) -> io::Result<Vec<Vec<sock_filter>>> {
    let mut compiled = vec![allowlist_filter(role, kernel), missing_calls_filter()];
    if role == Role::Build {
        compiled.push(ineffective_calls_filter());
    }
    let compiled: Result<Vec<BpfProgram>, _> = compiled.into_iter().collect();
    let compiled = compiled.map_err(io::Error::other)?;
    if compiled.iter().any(|filter| filter.len() > LONGEST_FILTER) {
        return Err(io::Error::other("a filter of system calls is too long"));
    }
    let convert = |instruction: &seccompiler::sock_filter| sock_filter {
        code: instruction.code,
        jt: instruction.jt,
        jf: instruction.jf,
        k: instruction.k,
    };
    Ok(compiled.iter().map(|filter| filter.iter().map(convert).collect()).collect())
}

/// The filter that passes only allowed calls, and the new calls that [`missing_calls_filter`] answers.
fn allowlist_filter(role: Role, kernel: &Kernel) -> Result<BpfProgram, seccompiler::BackendError> {
    use SeccompCmpOp::{Eq, MaskedEq, Ne};
    let own_process = || Ok(vec![SeccompRule::new(vec![argument(0, Eq, OWN_PROCESS.into())?])?]);
    let own_process_or_zero = || {
        let rule = |process: u32| SeccompRule::new(vec![argument(0, Eq, process.into())?]);
        Ok::<_, seccompiler::BackendError>(vec![rule(0)?, rule(OWN_PROCESS)?])
    };
    let mut rules: BTreeMap<c_long, Vec<SeccompRule>> =
        ALLOWED.iter().chain(ALLOWED_ON_ARCHITECTURE).map(|call| (*call, Vec::new())).collect();
    rules.insert(libc::SYS_prlimit64, own_process_or_zero()?);
    rules.insert(libc::SYS_sched_setaffinity, own_process_or_zero()?);
    // Denies writing to the terminal's input, which other processes read.
    let terminal = [libc::TIOCSTI, libc::TIOCLINUX].map(|request| argument(1, Ne, request));
    rules.insert(libc::SYS_ioctl, vec![SeccompRule::new(terminal.into_iter().collect::<Result<_, _>>()?)?]);
    // Landlock, or the rule below, denies signals to other processes.
    let is_scoped = role == Role::Build && kernel.has_scoped_signals();
    for call in [libc::SYS_kill, libc::SYS_tgkill] {
        rules.insert(call, if is_scoped { Vec::new() } else { own_process()? });
    }
    // Before version 3 Landlock allowed a file to be truncated by its path.
    if kernel.landlock >= 3 {
        rules.insert(libc::SYS_truncate, Vec::new());
    }
    match role {
        Role::Program => {
            let thread = libc::CLONE_THREAD as u64;
            let flags = argument(0, MaskedEq(NAMESPACES | thread), thread)?;
            rules.insert(libc::SYS_clone, vec![SeccompRule::new(vec![flags])?]);
            // The report of a crash copies the process's own stack.
            rules.insert(libc::SYS_process_vm_readv, own_process()?);
        }
        Role::Build => {
            let flags = argument(0, MaskedEq(NAMESPACES), 0)?;
            rules.insert(libc::SYS_clone, vec![SeccompRule::new(vec![flags])?]);
            rules.extend(PROCESS_STARTING.iter().chain(METADATA_CHANGING).map(|call| (*call, Vec::new())));
        }
    }
    rules.insert(libc::SYS_clone3, Vec::new());
    rules.extend(new_calls().map(|call| (call, Vec::new())));
    compile(rules, SeccompAction::Errno(libc::EPERM as u32), SeccompAction::Allow)
}

/// New calls that are not allowed, and `clone3`.
fn new_calls() -> impl Iterator<Item = c_long> {
    (FIRST_NEW..=LAST_NEW).filter(|call| !ALLOWED.contains(call) && !METADATA_CHANGING.contains(call))
}

/// The filter that lets new calls fail as if the kernel lacked them.
fn missing_calls_filter() -> Result<BpfProgram, seccompiler::BackendError> {
    let rules = new_calls().map(|call| (call, Vec::new())).collect();
    compile(rules, SeccompAction::Allow, SeccompAction::Errno(libc::ENOSYS as u32))
}

/// The filter that reports success for changes of modes, owners and times of files without making them.
fn ineffective_calls_filter() -> Result<BpfProgram, seccompiler::BackendError> {
    let rules = METADATA_CHANGING.iter().map(|call| (*call, Vec::new())).collect();
    compile(rules, SeccompAction::Allow, SeccompAction::Errno(0))
}

fn compile(
    rules: BTreeMap<c_long, Vec<SeccompRule>>,
    unlisted_action: SeccompAction,
    listed_action: SeccompAction,
) -> Result<BpfProgram, seccompiler::BackendError> {
    let architecture = std::env::consts::ARCH.try_into()?;
    SeccompFilter::new(rules, unlisted_action, listed_action, architecture)?.try_into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_fit_and_allow_no_call_that_affects_other_processes() {
        let kernel = Kernel { landlock: 7, has_seccomp: true };
        for role in [Role::Program, Role::Build] {
            let filters = filters(role, &kernel).expect("filters");
            assert!(filters.iter().all(|filter| filter.len() <= LONGEST_FILTER));
        }
        let closed = [
            libc::SYS_ptrace,
            libc::SYS_process_vm_writev,
            libc::SYS_socket,
            libc::SYS_unshare,
            libc::SYS_setns,
            libc::SYS_mount,
            libc::SYS_keyctl,
            libc::SYS_bpf,
            libc::SYS_perf_event_open,
            libc::SYS_io_uring_setup,
            libc::SYS_userfaultfd,
            libc::SYS_open_by_handle_at,
            libc::SYS_setpgid,
            libc::SYS_setsid,
            libc::SYS_memfd_create,
            libc::SYS_pidfd_open,
        ];
        assert!(closed.iter().all(|call| !ALLOWED.contains(call) && !ALLOWED_ON_ARCHITECTURE.contains(call)));
    }
}
