//! Seccomp filters for the system calls that a program must not make. On a thread of the host, these are the calls that
//! end, replace or trace the whole process. In a process of its own, they are the calls that send signals to the host
//! or trace it.
//!
//! On a thread of the host, the filter turns such a call into a crash (SIGSYS), which is reported like any other crash;
//! in a process of its own, the call fails with `EPERM`. All threads of programs get a filter, since the imports of a
//! program do not show the system calls of its assembly code. The kernel caches the set of allowed calls, so an allowed
//! call costs almost no time. While programs run on its threads, the host ends the process only through
//! [`exit_at_once`].

use std::cell::Cell;

use libc::{BPF_ABS, BPF_JEQ, BPF_JMP, BPF_JUMP, BPF_K, BPF_LD, BPF_RET, BPF_STMT, BPF_W, sock_filter, sock_fprog};

/// The system calls that are refused, with their names.
const REFUSED: [(libc::c_long, &str); 4] = [
    (libc::SYS_exit_group, "exit_group"),
    (libc::SYS_execve, "execve"),
    (libc::SYS_execveat, "execveat"),
    (libc::SYS_ptrace, "ptrace"),
];

/// The architecture of system calls as the kernel's filters see it: <linux/audit.h>.
#[cfg(target_arch = "x86_64")]
const ARCHITECTURE: u32 = 0xC000_003E;
#[cfg(target_arch = "aarch64")]
const ARCHITECTURE: u32 = 0xC000_00B7;

/// The system calls that are refused in a program's own process if their first argument, a process id, is that of the
/// host, of its group or of all processes.
const HOST_CALLS: [libc::c_long; 7] = [
    libc::SYS_kill,
    libc::SYS_tgkill,
    libc::SYS_rt_sigqueueinfo,
    libc::SYS_rt_tgsigqueueinfo,
    libc::SYS_pidfd_open,
    libc::SYS_process_vm_writev,
    libc::SYS_prlimit64,
];

/// Offsets in the kernel's `struct seccomp_data`: of the number, the architecture, the halves of the program counter,
/// and the lower half of the first argument.
const NUMBER_OFFSET: u32 = 0;
const ARCHITECTURE_OFFSET: u32 = 4;
const COUNTER_OFFSETS: [u32; 2] = [8, 12];
const FIRST_ARGUMENT_OFFSET: u32 = 16;

/// Loads the word at `offset` of the `seccomp_data`.
fn load(offset: u32) -> sock_filter {
    // SAFETY: the function only composes an instruction.
    unsafe { BPF_STMT((BPF_LD | BPF_W | BPF_ABS) as u16, offset) }
}

/// Skips `equal` instructions if the loaded word is `value`, otherwise `other` instructions.
fn jump(value: u32, equal: u8, other: u8) -> sock_filter {
    // SAFETY: the function only composes an instruction.
    unsafe { BPF_JUMP((BPF_JMP | BPF_JEQ | BPF_K) as u16, value, equal, other) }
}

/// Returns `action` to the kernel.
fn return_action(action: u32) -> sock_filter {
    // SAFETY: the function only composes an instruction.
    unsafe { BPF_STMT((BPF_RET | BPF_K) as u16, action) }
}

/// Installs a filter for the calling thread and all threads that it starts; does nothing if the kernel refuses.
/// Async-signal-safe.
fn install(filter: &mut [sock_filter]) {
    let program = sock_fprog { len: filter.len() as u16, filter: filter.as_mut_ptr() };
    // SAFETY: the program is valid and is copied by the kernel; if the kernel refuses it, nothing changes.
    unsafe {
        libc::prctl(libc::PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
        let flags = libc::SECCOMP_FILTER_FLAG_SPEC_ALLOW;
        libc::syscall(libc::SYS_seccomp, libc::SECCOMP_SET_MODE_FILTER, flags, &raw const program);
    }
}

/// Makes the kernel refuse (`EPERM`) the `HOST_CALLS` of this process to the process `host`, to its group and to all
/// processes, and also every `tkill` and `ptrace`, since a stopped host could report nothing. A program's own process
/// calls this function before it loads the program. Async-signal-safe.
pub fn protect_host(host: i32) {
    /// Number of instructions other than those for [`HOST_CALLS`].
    const OTHER_INSTRUCTIONS: usize = 12;
    // SAFETY: getpgid takes no pointer. The group id is 0 for a group of another namespace; 0 would mean the
    // caller's own group.
    let group = unsafe { libc::getpgid(host) }.max(1);
    let calls = HOST_CALLS.len() as u8;
    let mut filter = [return_action(libc::SECCOMP_RET_ALLOW); OTHER_INSTRUCTIONS + HOST_CALLS.len()];
    // Calls of another architecture have different numbers.
    filter[0] = load(ARCHITECTURE_OFFSET);
    filter[1] = jump(ARCHITECTURE, 0, calls + 9);
    filter[2] = load(NUMBER_OFFSET);
    filter[3] = jump(libc::SYS_ptrace as u32, calls + 7, 0);
    filter[4] = jump(libc::SYS_tkill as u32, calls + 6, 0);
    for (index, number) in HOST_CALLS.iter().enumerate() {
        filter[5 + index] = jump(*number as u32, calls - index as u8, 0);
    }
    let rest = &mut filter[5 + HOST_CALLS.len()..];
    rest[1] = load(FIRST_ARGUMENT_OFFSET);
    rest[2] = jump(host as u32, 3, 0);
    rest[3] = jump(-1_i32 as u32, 2, 0);
    rest[4] = jump(-group as u32, 1, 0);
    rest[6] = return_action(libc::SECCOMP_RET_ERRNO | libc::EPERM as u32);
    install(&mut filter[..]);
}

/// Turns the system calls that end, replace or trace the process into crashes, for the calling thread and all threads
/// that it starts. Does nothing if the kernel does not support such filters.
pub fn confine_thread() {
    thread_local! {
        /// True once the thread has its filter; a second filter would only cost time.
        static IS_CONFINED: Cell<bool> = const { Cell::new(false) };
    }
    if IS_CONFINED.replace(true) {
        return;
    }
    let own_call_end = (exit_at_once as *const () as usize + EXIT_CALL_END) as u64;
    let refused = REFUSED.len() as u8;
    // Calls of another architecture have different numbers.
    let mut filter = vec![load(ARCHITECTURE_OFFSET), jump(ARCHITECTURE, 0, refused + 7), load(NUMBER_OFFSET)];
    for (before, (number, _)) in REFUSED.iter().enumerate() {
        filter.push(jump(*number as u32, refused - before as u8, 0));
    }
    filter.push(return_action(libc::SECCOMP_RET_ALLOW));
    // The host's own call has the program counter of `exit_at_once`.
    filter.extend([
        load(COUNTER_OFFSETS[0]),
        jump(own_call_end as u32, 0, 3),
        load(COUNTER_OFFSETS[1]),
        jump((own_call_end >> 32) as u32, 0, 1),
    ]);
    filter.extend([return_action(libc::SECCOMP_RET_ALLOW), return_action(libc::SECCOMP_RET_TRAP)]);
    install(&mut filter);
}

/// Ends the process immediately with this exit code, on any thread; async-signal-safe.
#[unsafe(naked)]
pub extern "C" fn exit_at_once(code: i32) -> ! {
    #[cfg(target_arch = "x86_64")]
    std::arch::naked_asm!("mov eax, {call}", "syscall", "ud2", call = const libc::SYS_exit_group);
    #[cfg(target_arch = "aarch64")]
    std::arch::naked_asm!("mov x8, {call}", "svc 0", "brk 1", call = const libc::SYS_exit_group);
}

/// Distance from the start of [`exit_at_once`] to the end of its system call, in bytes.
#[cfg(target_arch = "x86_64")]
const EXIT_CALL_END: usize = 7;
#[cfg(target_arch = "aarch64")]
const EXIT_CALL_END: usize = 8;

/// Name of a refused system call.
pub fn name_of(number: usize) -> &'static str {
    let call = REFUSED.iter().find(|(refused, _)| *refused as usize == number);
    call.map_or("of another architecture", |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_call_is_at_the_address_of_the_filter() {
        #[cfg(target_arch = "x86_64")]
        const CALL: &[u8] = &[0x0f, 0x05];
        #[cfg(target_arch = "aarch64")]
        const CALL: &[u8] = &[0x01, 0x00, 0x00, 0xd4];
        let start = (exit_at_once as *const ()).cast::<u8>();
        // SAFETY: code of this binary, which is readable.
        let code = unsafe { std::slice::from_raw_parts(start, EXIT_CALL_END) };
        assert!(code.ends_with(CALL), "{code:x?}");
    }
}
