//! System calls that a program on a thread of the host must not make: those that end or replace the whole process.
//!
//! A filter of the kernel (seccomp) turns them into a fault of the thread (SIGSYS), which is reported like any other. Only threads of
//! programs whose imports show the danger get it, since it costs each system call of the thread some nanoseconds.

use libc::{BPF_ABS, BPF_JEQ, BPF_JMP, BPF_JUMP, BPF_K, BPF_LD, BPF_RET, BPF_STMT, BPF_W, sock_filter, sock_fprog};

/// The system calls that are refused, with their names.
const REFUSED: [(libc::c_long, &str); 3] =
    [(libc::SYS_exit_group, "exit_group"), (libc::SYS_execve, "execve"), (libc::SYS_execveat, "execveat")];

/// The architecture of system calls as the kernel's filters see it: <linux/audit.h>.
#[cfg(target_arch = "x86_64")]
const ARCHITECTURE: u32 = 0xC000_003E;
#[cfg(target_arch = "aarch64")]
const ARCHITECTURE: u32 = 0xC000_00B7;

/// Turns the system calls that end or replace the process into faults of the calling thread and of all threads that it starts. Does
/// nothing where the kernel has no such filters.
pub fn confine_thread() {
    /// Offsets of the number and of the architecture in the kernel's `struct seccomp_data`.
    const NUMBER: u32 = 0;
    const OF_ARCHITECTURE: u32 = 4;
    // SAFETY: the functions only compose instructions.
    let mut filter = unsafe {
        let refused = REFUSED.len() as u8;
        let mut filter = vec![
            BPF_STMT((BPF_LD | BPF_W | BPF_ABS) as u16, OF_ARCHITECTURE),
            // Calls of another architecture have other numbers.
            BPF_JUMP((BPF_JMP | BPF_JEQ | BPF_K) as u16, ARCHITECTURE, 0, refused + 2),
            BPF_STMT((BPF_LD | BPF_W | BPF_ABS) as u16, NUMBER),
        ];
        for (before, (number, _)) in REFUSED.iter().enumerate() {
            let to_trap = refused - before as u8;
            filter.push(BPF_JUMP((BPF_JMP | BPF_JEQ | BPF_K) as u16, *number as u32, to_trap, 0));
        }
        filter.push(BPF_STMT((BPF_RET | BPF_K) as u16, libc::SECCOMP_RET_ALLOW));
        filter.push(BPF_STMT((BPF_RET | BPF_K) as u16, libc::SECCOMP_RET_TRAP));
        filter
    };
    let program = sock_fprog { len: filter.len() as u16, filter: filter.as_mut_ptr().cast::<sock_filter>() };
    // SAFETY: the program is valid and is copied by the kernel; where it is refused, nothing changes. The set is filled before it is used.
    unsafe {
        // The handler of the second interrupt ends the process: it runs on another thread.
        let mut interrupts = std::mem::zeroed();
        libc::sigemptyset(&raw mut interrupts);
        libc::sigaddset(&raw mut interrupts, libc::SIGINT);
        libc::sigaddset(&raw mut interrupts, libc::SIGTERM);
        libc::pthread_sigmask(libc::SIG_BLOCK, &raw const interrupts, std::ptr::null_mut());
        libc::prctl(libc::PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
        let flags = libc::SECCOMP_FILTER_FLAG_SPEC_ALLOW;
        libc::syscall(libc::SYS_seccomp, libc::SECCOMP_SET_MODE_FILTER, flags, &raw const program);
    }
}

/// Name of a refused system call.
pub fn name_of(number: usize) -> &'static str {
    let call = REFUSED.iter().find(|(refused, _)| *refused as usize == number);
    call.map_or("of another architecture", |(_, name)| name)
}
