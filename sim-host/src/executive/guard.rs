//! Guard page above a program's frames on its thread's stack.
//!
//! The C library stores a thread's thread-locals, including those of the host, above its stack. A program may write
//! beyond the top of its frames, such as by an array overrun. It then crashes at the guard page before it reaches the
//! thread-locals; the crash is reported like any other.

use std::mem::MaybeUninit;

use super::signal;

/// Size of a page on most machines; on others the kernel refuses the guard.
const PAGE: usize = 4096;

/// Runs `body`, which runs this thread's program, below a guard page on the thread's stack; without a guard page if the
/// kernel allows no further mappings.
#[inline(never)]
pub fn below_guard<R>(body: impl FnOnce() -> R) -> R {
    let mut room = MaybeUninit::<[u8; 2 * PAGE]>::uninit();
    let page = room.as_mut_ptr().map_addr(|address| address.next_multiple_of(PAGE));
    // SAFETY: the page lies within `room`, which no other code uses.
    let is_guarded = unsafe { libc::mprotect(page.cast(), PAGE, libc::PROT_NONE) } == 0;
    let _guard = is_guarded.then(|| Guard { page: page.cast(), outer_top: signal::set_stack_top(page.addr()) });
    run(body)
}

/// Runs `body` in frames below the caller's.
#[inline(never)]
fn run<R>(body: impl FnOnce() -> R) -> R {
    body()
}

/// The guard page; its drop makes the page accessible again.
struct Guard {
    page: *mut libc::c_void,
    /// Top of the stack without the guard.
    outer_top: usize,
}

impl Drop for Guard {
    fn drop(&mut self) {
        signal::set_stack_top(self.outer_top);
        // SAFETY: the page of `below_guard`, whose frame still exists.
        unsafe { libc::mprotect(self.page, PAGE, libc::PROT_READ | libc::PROT_WRITE) };
    }
}

/// Returns true if `address` lies in the guard page above a stack that ends at `high`.
pub fn is_in_guard(address: usize, high: usize) -> bool {
    (high..high.saturating_add(PAGE)).contains(&address)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guard_page_is_removed() {
        assert_eq!(below_guard(|| below_guard(|| 7)), 7);
        let big = std::hint::black_box([1_u8; 4 * PAGE]);
        assert!(big.iter().all(|byte| *byte == 1));
        assert!(is_in_guard(PAGE, PAGE) && !is_in_guard(2 * PAGE, PAGE) && !is_in_guard(0, PAGE));
    }
}
