//! What is known of a robot program that broke, in words.

use super::signal::{Fault, OVERDUE_SIGNAL};
use crate::robios::robot::Ending;

/// A flow that will never run again, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// What happened, without the place: `segmentation fault at address 0x0`.
    pub what: String,
    /// True when the watchdog stopped the flow, false when the program itself faulted.
    pub is_overdue: bool,
    /// Number of the last RoBIOS call, `u16::MAX` before the first.
    pub last_call: u16,
    /// The task that broke, where it is one of several.
    pub task: Option<u32>,
    /// The place in words, where the program itself has told it.
    pub place: String,
    /// Program counter at the break, then what look like return addresses, innermost first.
    pub addresses: Vec<usize>,
}

/// How far from the stack pointer return addresses are looked for, in words.
pub(super) const SEARCH: usize = 4096;

/// Below the stack lies a guard page; a fault this near to it is an overflow.
const GUARD: usize = 64 << 10;

impl Broken {
    /// The words for `fault` of a thread with these bounds of its stack, and with these words on it from the stack pointer on.
    pub(super) fn new(fault: Fault, [low, _]: [usize; 2], last_call: u16, stack_words: Vec<usize>) -> Self {
        let near_guard = low > 0 && (low.saturating_sub(GUARD)..low + GUARD).contains(&fault.address);
        let what = match fault.signal {
            OVERDUE_SIGNAL => "no RoBIOS call returned in time".into(),
            libc::SIGSEGV | libc::SIGBUS if near_guard => "stack overflow".into(),
            libc::SIGSEGV => format!("segmentation fault at address {:#x}", fault.address),
            libc::SIGBUS => format!("bus error at address {:#x}", fault.address),
            libc::SIGFPE => "arithmetic fault (an integer division by zero or an overflow of one)".into(),
            libc::SIGILL => "illegal instruction".into(),
            libc::SIGABRT => "aborted by the C library".into(),
            libc::SIGTRAP => "trap instruction".into(),
            other => format!("signal {other}"),
        };
        let mut addresses = vec![fault.pc];
        addresses.extend(stack_words);
        Self {
            what,
            is_overdue: fault.signal == OVERDUE_SIGNAL,
            last_call,
            task: None,
            place: String::new(),
            addresses,
        }
    }

    /// A flow that was to be stopped and takes no signal: it is left behind as it is.
    pub(super) fn unstoppable() -> Self {
        Self {
            what: "no RoBIOS call returned in time, and the program blocks the signals by which it would be stopped"
                .to_owned(),
            is_overdue: true,
            last_call: u16::MAX,
            task: None,
            place: String::new(),
            addresses: Vec::new(),
        }
    }

    /// How the program of the flow has ended.
    pub(super) fn ending(&self) -> Ending {
        let reason = self.what.clone();
        if self.is_overdue { Ending::Overdue { reason } } else { Ending::Failed { reason } }
    }

    /// The same, told of the task that broke.
    #[must_use]
    pub(super) fn in_task(mut self, task: u32) -> Self {
        self.task = Some(task);
        self
    }
}

/// The words on a parked thread's stack from `sp` on, as far as the search goes.
pub(super) fn stack_words(sp: usize, [low, high]: [usize; 2]) -> Vec<usize> {
    let sp = sp.next_multiple_of(align_of::<usize>());
    if sp < low || sp >= high {
        return Vec::new();
    }
    let count = ((high - sp) / size_of::<usize>()).min(SEARCH);
    // SAFETY: [sp, sp + count words) lies within the mapped stack of a thread that is parked for good and so writes no more;
    // every bit pattern is a valid usize.
    (0..count).map(|i| unsafe { std::ptr::with_exposed_provenance::<usize>(sp).add(i).read_volatile() }).collect()
}
