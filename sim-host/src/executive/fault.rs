//! What is known of a robot program that broke, in words.

use super::signal::{Fault, OVERDUE_SIGNAL, ThreadBlock};

/// A flow that will never run again, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// What happened, without the place: `segmentation fault at address 0x0`.
    pub what: String,
    /// True when the watchdog stopped the flow, false when the program itself faulted.
    pub is_overdue: bool,
    /// Number of the last RoBIOS call, `u16::MAX` before the first.
    pub last_call: u16,
    /// Program counter at the break, then what look like return addresses, innermost first.
    pub addresses: Vec<usize>,
}

/// How far from the stack pointer return addresses are looked for, in words.
const SEARCH: usize = 4096;

/// Below the stack lies a guard page; a fault this near to it is an overflow.
const GUARD: usize = 64 << 10;

impl Broken {
    /// The words for `fault` of the thread that `block` belongs to, which is parked.
    pub(super) fn new(fault: Fault, block: &ThreadBlock) -> Self {
        use std::sync::atomic::Ordering::Relaxed;
        let [low, high] = [block.stack[0].load(Relaxed), block.stack[1].load(Relaxed)];
        let near_guard = (low.saturating_sub(GUARD)..low + GUARD).contains(&fault.address);
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
        addresses.extend(stack_words(fault.sp, low, high));
        Self { what, is_overdue: fault.signal == OVERDUE_SIGNAL, last_call: block.last_call.load(Relaxed), addresses }
    }
}

/// The words on a parked thread's stack from `sp` on, as far as the search goes.
fn stack_words(sp: usize, low: usize, high: usize) -> Vec<usize> {
    let sp = sp.next_multiple_of(align_of::<usize>());
    if sp < low || sp >= high {
        return Vec::new();
    }
    let count = ((high - sp) / size_of::<usize>()).min(SEARCH);
    // SAFETY: [sp, sp + count words) lies within the mapped stack of a thread that is parked for good and so writes no more;
    // every bit pattern is a valid usize.
    (0..count).map(|i| unsafe { std::ptr::with_exposed_provenance::<usize>(sp).add(i).read_volatile() }).collect()
}
