//! What robot programs that broke have cost this process for good: threads that never end, perhaps the heap of the C library.

use std::ffi::CStr;
use std::ops::Range;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::signal::Fault;

/// So many flows may be lost before this process loads no more programs: each keeps its thread, its stack and all of its run. Our choice.
pub const MOST_LOST: usize = 200;

static LOST: AtomicUsize = AtomicUsize::new(0);
static IS_HEAP_LOST: AtomicBool = AtomicBool::new(false);

/// Why no more programs can run on threads of this process.
#[derive(Debug, thiserror::Error)]
pub enum Damage {
    /// Too many flows are lost.
    #[error(
        "{0} flows of robot programs have faulted, hung or been left suspended in this process and hold their threads for ever: \
         run programs in processes of their own (`--exec process`), or start a new process"
    )]
    Flows(usize),
    /// The heap of the C library is.
    #[error(
        "a robot program broke within the heap of the C library, which no other program in this process can use any more: run \
         programs in processes of their own (`--exec process`), or start a new process"
    )]
    Heap,
}

/// Checks that more programs can run on threads of this process.
///
/// # Errors
/// [`Damage`] when earlier ones have done too much.
pub fn check() -> Result<(), Damage> {
    match lost_flows() {
        _ if is_heap_lost() => Err(Damage::Heap),
        lost if lost >= MOST_LOST => Err(Damage::Flows(lost)),
        _ => Ok(()),
    }
}

/// Flows of this process whose threads never end: they faulted or were stopped as overdue, or could not be let go after that.
pub fn lost_flows() -> usize {
    LOST.load(Ordering::Acquire)
}

/// True once a program of this process broke within the heap of the C library: it may hold a lock that others wait for.
pub fn is_heap_lost() -> bool {
    IS_HEAP_LOST.load(Ordering::Acquire)
}

/// One more flow will never end.
pub(super) fn lose_flow() {
    LOST.fetch_add(1, Ordering::AcqRel);
}

/// Takes a fault into account, with what lies on the stack of its thread.
pub(super) fn assess(fault: &Fault, stack_words: &[usize]) {
    /// What lies between the functions of the heap and the signal when they end the program themselves, in words.
    const REPORTING: usize = 512;
    let heap = heap_functions();
    let is_reported = || stack_words.iter().take(REPORTING).any(|word| heap.contains(word));
    if heap.contains(&fault.pc) || fault.signal == libc::SIGABRT && is_reported() {
        IS_HEAP_LOST.store(true, Ordering::Release);
    }
}

/// Where the functions of the C library's heap lie; empty where they are not found. To be called before anything breaks: the dynamic
/// linker has a lock, too.
pub(super) fn heap_functions() -> Range<usize> {
    /// The functions without a name of their own lie before `malloc`: 10 KiB in glibc 2.36.
    const HIDDEN: usize = 16 << 10;
    static FUNCTIONS: OnceLock<Range<usize>> = OnceLock::new();
    let [first, last] = [c"malloc", c"malloc_info"];
    FUNCTIONS.get_or_init(|| address_of(first).saturating_sub(HIDDEN)..address_of(last)).clone()
}

/// Where a function of the C library lies, whoever has replaced it in this process; 0 where that is unknown.
fn address_of(name: &CStr) -> usize {
    // SAFETY: names that end in 0; RTLD_NOLOAD loads nothing, and the library stays as this program needs it.
    unsafe {
        let library = libc::dlopen(c"libc.so.6".as_ptr(), libc::RTLD_NOW | libc::RTLD_NOLOAD);
        if library.is_null() { ptr::null_mut() } else { libc::dlsym(library, name.as_ptr()) }.addr()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_functions_of_the_heap_are_found() {
        let heap = heap_functions();
        for name in [c"malloc", c"free", c"realloc", c"calloc"] {
            assert!(heap.contains(&address_of(name)), "{name:?}");
        }
        for name in [c"memcpy", c"strlen", c"printf", c"qsort"] {
            assert!(!heap.contains(&address_of(name)), "{name:?}");
        }
        assert!(heap.len() < 64 << 10, "{heap:?}");
    }
}
