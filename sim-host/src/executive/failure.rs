//! Descriptions of failures of robot programs: crashes, other illegal ends and overdue programs.

use super::confine;
use super::guard::is_in_guard;
use super::signal::{self, Crash, DIVISION_BY_ZERO, EXIT_CALLED, OVERDUE_SIGNAL, THREAD_ENDED};
use crate::robios::robot::Ending;

/// Why a flow never runs again: a crash, an illegal end or a stop by the watchdog.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Description of the failure, without the location: `null pointer used (segmentation fault at address 0x0)`.
    pub description: String,
    /// True if the watchdog stopped the flow; false for a crash or an illegal end.
    pub is_overdue: bool,
    /// Number of the last RoBIOS call, `u16::MAX` before the first.
    pub last_call: u16,
    /// The task that failed, if it is one of several.
    pub task: Option<u32>,
    /// The location as text, if the program has reported it; otherwise empty.
    pub location: String,
    /// Program counter at the failure, then the words of the stack that may be return addresses, innermost first.
    pub addresses: Vec<usize>,
    /// Lines that the program has printed without a line end, each with its [`stream`](robios_sys::support::stream).
    pub unfinished: Vec<(i32, String)>,
}

/// Depth of the search for return addresses from the stack pointer, in words.
pub(super) const MAX_SEARCH_WORDS: usize = 4096;

/// The words of a stack without those that are left over from earlier calls: if `call`, the program's call site, is in
/// progress, those below it; otherwise those of this last call, which become 0. Async-signal-safe.
pub(super) fn live_words(words: &mut [usize], call: usize) -> &[usize] {
    if let Some(index) = words.iter().position(|word| *word == call && call != 0) {
        return &words[index..];
    }
    // The shim makes the site less by 1 when the call returns.
    words.iter_mut().filter(|word| **word == call.wrapping_add(1)).for_each(|word| *word = 0);
    words
}

/// Distance from the low end of the stack, in bytes, within which a crash is reported as a stack overflow (a guard page
/// lies below the stack).
const GUARD_REACH: usize = 64 << 10;

/// Beginning of the description of a null pointer dereference.
pub(super) const NULL_POINTER: &str = "null pointer used";

/// Description of a stack overflow.
pub(super) const STACK_OVERFLOW: &str = "stack overflow";

/// Accesses below this address are attributed to a null pointer: nothing is ever mapped there.
const NULL_PAGE: usize = 4096;

/// Description of a crash at a trap instruction; the compiler emits one where the program's behaviour is undefined.
pub(super) const ILLEGAL_INSTRUCTION: &str =
    "division by zero, null pointer or missing `return`, found by the compiler (illegal instruction)";

/// Like [`ILLEGAL_INSTRUCTION`], at a line that can only crash by a division.
pub(super) const ILLEGAL_DIVISION: &str = "division by zero, found by the compiler (illegal instruction)";

/// Usual causes of a crash at an address that is neither near 0 nor at the end of the stack.
pub(super) const INVALID_POINTER: &str =
    "an uninitialized pointer, an index beyond its array, or a write to a string literal";

/// Code of a crash whose address the kernel does not know (from <asm-generic/siginfo.h>).
const SI_KERNEL: i32 = 0x80;

/// Maximum depth in words at which a stack counts as too shallow to have overflowed.
const MAX_SHALLOW: usize = 1024;

impl Failure {
    /// Describes `crash` of a thread whose stack lies between `low` and `high`; `stack_words` are the words on its
    /// stack from the stack pointer upwards.
    pub(super) fn new(crash: Crash, [low, high]: [usize; 2], last_call: u16, stack_words: Vec<usize>) -> Self {
        // A shallow stack has not overflowed: the crash is then an access to other memory, which may end just below the
        // stack.
        let is_deep = stack_words.is_empty() || stack_words.len() > MAX_SHALLOW;
        let is_near_guard = low > 0
            && is_deep
            && (low.saturating_sub(GUARD_REACH)..low.saturating_add(GUARD_REACH)).contains(&crash.address);
        let description = match crash.signal {
            OVERDUE_SIGNAL => "endless loop, or too long without a RoBIOS call".into(),
            EXIT_CALLED => "the program called `exit` of the C library, which would have ended eyesim".into(),
            libc::SIGSYS => format!(
                "the program would have ended or replaced eyesim by the system call {}",
                confine::name_of(crash.address)
            ),
            THREAD_ENDED => "the program ended its own thread without the C library (such as by `syscall(SYS_exit)`)".into(),
            signal if crash.code < 0 && name_of_signal(signal).is_some_and(|name| name != "SIGABRT") => {
                format!("the program sent itself the signal {}", name_of_signal(signal).unwrap_or_default())
            }
            libc::SIGSEGV | libc::SIGBUS if is_near_guard => STACK_OVERFLOW.into(),
            libc::SIGSEGV if is_in_guard(crash.address, high) => {
                "the program wrote or read beyond the top of its stack (an array overrun)".into()
            }
            // The kernel reports no address for a non-canonical pointer such as 0x4141414141414141.
            libc::SIGSEGV if crash.code == SI_KERNEL => format!("segmentation fault at no address ({INVALID_POINTER})"),
            libc::SIGSEGV if crash.address < NULL_PAGE && crash.address == crash.pc => {
                format!("{NULL_POINTER} as a function (segmentation fault at address {:#x})", crash.address)
            }
            libc::SIGSEGV if crash.address < NULL_PAGE => {
                format!("{NULL_POINTER} (segmentation fault at address {:#x})", crash.address)
            }
            libc::SIGSEGV if crash.address == crash.pc => format!(
                "segmentation fault by a jump to address {:#x}, where there is no code (an array overrun, or an uninitialized function pointer)",
                crash.address
            ),
            libc::SIGSEGV => format!("segmentation fault at address {:#x} ({INVALID_POINTER})", crash.address),
            libc::SIGBUS => format!("bus error at address {:#x}", crash.address),
            libc::SIGFPE => format!("{} (arithmetic fault)", cause_of_sigfpe(crash.code)),
            libc::SIGILL => ILLEGAL_INSTRUCTION.into(),
            libc::SIGABRT => {
                "aborted by the C library (in C usually a write beyond the end of allocated memory, or memory freed twice)".into()
            }
            libc::SIGTRAP => "trap instruction".into(),
            other => format!("signal {other}"),
        };
        let mut addresses = vec![crash.pc];
        addresses.extend(stack_words);
        Self {
            description,
            is_overdue: crash.signal == OVERDUE_SIGNAL,
            last_call,
            task: None,
            location: String::new(),
            addresses,
            unfinished: Vec::new(),
        }
    }

    /// Adds the lines that the program has printed without a line end.
    #[must_use]
    pub(super) fn with_unfinished(self, unfinished: Vec<(i32, String)>) -> Self {
        Self { unfinished, ..self }
    }

    /// Replaces the description by the reason that the program reported before it failed, if any. An overdue program
    /// keeps its description.
    #[must_use]
    pub(super) fn with_reason(self, ending: Option<&Ending>) -> Self {
        match ending {
            Some(Ending::Failed { reason }) if !self.is_overdue => Self { description: reason.clone(), ..self },
            _ => self,
        }
    }

    /// Describes an overdue program that was stopped at `location`; `last_call` is the number of its last RoBIOS call.
    pub(super) fn overdue(last_call: u16, location: String) -> Self {
        let crash = Crash { signal: OVERDUE_SIGNAL, ..Crash::default() };
        Self { location, ..Self::new(crash, [0; 2], last_call, Vec::new()) }
    }

    /// Describes a flow that receives no signals and therefore cannot be stopped; it is abandoned.
    pub(super) fn unstoppable() -> Self {
        Self {
            description:
                "too long without a RoBIOS call, and the program blocks the signals by which it would be stopped"
                    .to_owned(),
            is_overdue: true,
            last_call: u16::MAX,
            task: None,
            location: String::new(),
            addresses: Vec::new(),
            unfinished: Vec::new(),
        }
    }

    /// How this failure ends the program.
    pub(super) fn ending(&self) -> Ending {
        let reason = self.description.clone();
        if self.is_overdue { Ending::Overdue { reason } } else { Ending::Failed { reason } }
    }

    /// Sets the task that failed.
    #[must_use]
    pub(super) fn in_task(mut self, task: u32) -> Self {
        self.task = Some(task);
        self
    }
}

/// Name of a signal that a crash raises; `None` for other signals.
fn name_of_signal(signal: i32) -> Option<&'static str> {
    let names = [
        (libc::SIGSEGV, "SIGSEGV"),
        (libc::SIGBUS, "SIGBUS"),
        (libc::SIGFPE, "SIGFPE"),
        (libc::SIGILL, "SIGILL"),
        (libc::SIGABRT, "SIGABRT"),
        (libc::SIGTRAP, "SIGTRAP"),
    ];
    names.iter().find(|(number, _)| *number == signal).map(|(_, name)| *name)
}

/// Describes the cause of a SIGFPE with this signal code (`si_code`).
fn cause_of_sigfpe(code: i32) -> &'static str {
    // The numbers of <asm-generic/siginfo.h>, which the crate `libc` does not have.
    match code {
        DIVISION_BY_ZERO => "integer division by zero",
        2 => "integer division by zero, or of INT_MIN by -1",
        3 => "floating-point division by zero, for which the program has enabled a trap",
        4 => "floating-point overflow, for which the program has enabled a trap",
        5 => "floating-point underflow, for which the program has enabled a trap",
        6 => "inexact floating-point result, for which the program has enabled a trap",
        7 => "invalid floating-point operation, for which the program has enabled a trap",
        _ => "floating-point operation or integer division",
    }
}

/// The mapped words on a parked thread's stack from `sp` upwards, at most [`MAX_SEARCH_WORDS`] of them.
pub(super) fn stack_words(sp: usize, [low, high]: [usize; 2]) -> Vec<usize> {
    let sp = sp.next_multiple_of(align_of::<usize>());
    if sp < low || sp >= high {
        return Vec::new();
    }
    let mut words = vec![0_usize; ((high - sp) / size_of::<usize>()).min(MAX_SEARCH_WORDS)];
    // The program may have unmapped its stack, or a part of it.
    let mapped = signal::copy_own_memory(sp, &mut words);
    words.truncate(mapped);
    words
}
