//! Switch between the stacks of a worker and of its fibers, for x86-64.
//!
//! A suspended context is a stack pointer to the saved callee-saved registers (System V ABI, section 3.2.1); the
//! address at which it continues follows above them.

use std::arch::naked_asm;

/// Number of registers that [`switch`] pushes.
const SAVED_REGISTERS: usize = 6;

/// Saves the calling context, stores its stack pointer in `from`, and continues the context of the stack pointer `to`.
///
/// # Safety
/// `from` is valid for a write. `to` was stored by this function or made by [`prepare`], its context has not been
/// continued since, and its stack is alive.
#[unsafe(naked)]
pub unsafe extern "sysv64" fn switch(from: *mut usize, to: usize) {
    naked_asm!(
        "push rbp",
        "push rbx",
        "push r12",
        "push r13",
        "push r14",
        "push r15",
        "mov [rdi], rsp",
        "mov rsp, rsi",
        "jmp {land}",
        land = sym land,
    )
}

/// Continues the context to whose saved registers the stack pointer points. Never called: [`switch`] and a signal
/// handler jump here.
#[unsafe(naked)]
unsafe extern "sysv64" fn land() {
    naked_asm!("pop r15", "pop r14", "pop r13", "pop r12", "pop rbx", "pop rbp", "ret")
}

/// Calls `function` with `argument` on the stack below the stack pointer `to`, after it has stored the caller's stack
/// pointer in `from`.
///
/// # Safety
/// `from` is valid for a write. The memory below `to` is an unused stack, which is large enough for `function`.
/// `function` does not unwind, and returns before any code switches away from this thread's stack.
#[unsafe(naked)]
pub unsafe extern "sysv64" fn call_on(
    from: *mut usize,
    to: usize,
    function: unsafe extern "sysv64" fn(*mut u8),
    argument: *mut u8,
) {
    naked_asm!(
        "push rbp",
        "mov rbp, rsp",
        "mov [rdi], rsp",
        "mov rsp, rsi",
        "and rsp, -16",
        "mov rdi, rcx",
        "call rdx",
        "mov rsp, rbp",
        "pop rbp",
        "ret",
    )
}

/// Writes the context of a fiber that begins with `entry` to the fiber's stack, which ends at `top`, a multiple of 16.
/// Returns the stack pointer of the context.
///
/// # Safety
/// The 64 bytes below `top` are valid for writes and unused.
pub unsafe fn prepare(top: usize, entry: extern "sysv64" fn() -> !) -> usize {
    // The registers, the entry, and 0 as its return address, which ends the stack walk of a debugger or an unwinder.
    let mut words = [0; SAVED_REGISTERS + 2];
    words[SAVED_REGISTERS] = entry as *const () as usize;
    let sp = top - size_of_val(&words);
    // SAFETY: by this function's contract.
    unsafe { std::ptr::with_exposed_provenance_mut::<[usize; SAVED_REGISTERS + 2]>(sp).write(words) };
    sp
}

/// Changes the context of a signal so that, when its handler returns, the thread continues the context of the stack
/// pointer `to`, with no signal blocked. The interrupted code never continues. Async-signal-safe.
///
/// # Safety
/// `context` is the kernel's context of a signal on the calling thread; for `to` see [`switch`].
pub unsafe fn divert(context: *mut libc::ucontext_t, to: usize) {
    /// Flags that the calling convention requires to be clear: trap, direction, alignment check.
    const CLEARED_FLAGS: i64 = 0x100 | 0x400 | 0x4_0000;
    // SAFETY: valid by this function's contract, and no other reference to it exists.
    let context = unsafe { &mut *context };
    let registers = &mut context.uc_mcontext.gregs;
    registers[libc::REG_RIP as usize] = land as *const () as i64;
    registers[libc::REG_RSP as usize] = to as i64;
    registers[libc::REG_EFL as usize] &= !CLEARED_FLAGS;
    // SAFETY: a valid set.
    unsafe { libc::sigemptyset(&raw mut context.uc_sigmask) };
}
