//! Permanent damage that failed robot programs have done to this process: threads that never end, and corruption of the
//! C library's heap.

use std::ffi::CStr;
use std::ops::Range;
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::signal::Crash;

/// Number of lost flows at which this process loads no more programs: each lost flow keeps its thread, its stack and
/// its whole run. Our choice.
pub const MAX_LOST_FLOWS: usize = 200;

static LOST_FLOWS: AtomicUsize = AtomicUsize::new(0);
static IS_HEAP_LOST: AtomicBool = AtomicBool::new(false);

/// Reasons why no further programs can run on threads of this process.
#[derive(Debug, thiserror::Error)]
pub enum Damage {
    /// Too many flows are lost.
    #[error(
        "{0} flows of robot programs have crashed, hung or been left suspended in this process and hold their threads for ever: \
         run programs in processes of their own (`--exec process`), or start a new process"
    )]
    Flows(usize),
    /// The heap of the C library is corrupted.
    #[error(
        "a robot program crashed within the heap of the C library, which no other program in this process can use any more: run \
         programs in processes of their own (`--exec process`), or start a new process"
    )]
    Heap,
}

/// Checks that further programs can run on threads of this process.
///
/// # Errors
/// [`Damage`] if earlier programs have corrupted the heap or left too many lost flows.
pub fn check() -> Result<(), Damage> {
    match lost_flows() {
        _ if is_heap_lost() => Err(Damage::Heap),
        lost if lost >= MAX_LOST_FLOWS => Err(Damage::Flows(lost)),
        _ => Ok(()),
    }
}

/// Number of flows in this process whose threads never end: they crashed, were stopped as overdue, or could not be
/// joined afterwards.
pub fn lost_flows() -> usize {
    LOST_FLOWS.load(Ordering::Acquire)
}

/// Returns true once a program of this process crashed within the heap of the C library: the program may still hold a
/// heap lock for which other threads wait.
pub fn is_heap_lost() -> bool {
    IS_HEAP_LOST.load(Ordering::Acquire)
}

/// Increments the number of lost flows.
pub(super) fn count_lost_flow() {
    LOST_FLOWS.fetch_add(1, Ordering::AcqRel);
}

/// Marks the heap as lost after a program in this process reported that it overwrote the heap's data between blocks.
pub(super) fn mark_heap_lost() {
    IS_HEAP_LOST.store(true, Ordering::Release);
}

/// Marks the heap as lost if `crash` happened in a heap function; `stack_words` are the words on the stack of its
/// thread.
pub(super) fn assess(crash: &Crash, stack_words: &[usize]) {
    /// Maximum stack depth in words between the heap's functions and the signal with which they abort the program.
    const MAX_DEPTH: usize = 512;
    let heap = heap_functions();
    let is_called_by_heap = || stack_words.iter().take(MAX_DEPTH).any(|word| heap.contains(word));
    if heap.contains(&crash.pc) || crash.signal == libc::SIGABRT && is_called_by_heap() {
        IS_HEAP_LOST.store(true, Ordering::Release);
    }
}

/// Address range of the C library's heap functions; empty if they are not found. The first call must be made before
/// anything fails, since it takes the dynamic linker's lock; the result is cached.
pub(super) fn heap_functions() -> Range<usize> {
    /// Upper bound of the size of the unexported functions before `malloc`: 10 KiB in glibc 2.36.
    const UNEXPORTED: usize = 16 << 10;
    static FUNCTIONS: OnceLock<Range<usize>> = OnceLock::new();
    let [first, last] = [c"malloc", c"malloc_info"];
    FUNCTIONS.get_or_init(|| address_of(first).saturating_sub(UNEXPORTED)..address_of(last)).clone()
}

/// Address of a function in the C library itself, even if it is interposed; 0 if unknown.
fn address_of(name: &CStr) -> usize {
    // SAFETY: the names end in 0; RTLD_NOLOAD loads nothing, and the library stays loaded as this program needs it.
    unsafe {
        let library = libc::dlopen(c"libc.so.6".as_ptr(), libc::RTLD_NOW | libc::RTLD_NOLOAD);
        if library.is_null() { ptr::null_mut() } else { libc::dlsym(library, name.as_ptr()) }.addr()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heap_functions_are_found() {
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
