//! Stacks of fibers.

use std::io;
use std::ptr;
use std::sync::OnceLock;

use crate::program::share::page_size;

/// A stack: memory that is used as it is touched, between two guard pages.
pub struct Stack {
    /// Lowest address of the mapping, where the lower guard page is.
    start: usize,
    /// Address above the usable bytes, a multiple of 16.
    top: usize,
    /// The guard pages have not split the mapping.
    is_joined: bool,
}

/// Size of a stack's mapping in bytes, guard pages included.
const SIZE: usize = super::super::thread::STACK;

/// Places of stack tops within their last page: neighbours differ, so that their frames do not compete for the same sets of the
/// processor's first cache.
const COLOURS: usize = 16;

/// Bytes between two of these places.
const COLOUR_STEP: usize = 128;

/// Memory mappings for each stack: none where the kernel joins equal neighbours, four where each guard page needs one of its own.
pub fn mappings_per_stack() -> usize {
    static COUNT: OnceLock<usize> = OnceLock::new();
    *COUNT.get_or_init(|| Stack::new(0).map_or(4, |stack| if stack.is_joined { 0 } else { 4 }))
}

/// Lets accesses to pages fault without splitting their mapping (Linux 6.13).
const MADV_GUARD_INSTALL: i32 = 102;

impl Stack {
    /// Maps a stack, the `number`-th.
    ///
    /// # Errors
    /// The system has no room for it.
    pub fn new(number: usize) -> io::Result<Self> {
        let page = page_size();
        // SAFETY: a fresh anonymous mapping; advice and protection concern nothing but its pages.
        let (start, is_joined) = unsafe {
            let start = libc::mmap(
                ptr::null_mut(),
                SIZE,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE,
                -1,
                0,
            );
            if start == libc::MAP_FAILED {
                return Err(io::Error::last_os_error());
            }
            // Where the kernel has no huge pages there is nothing to refuse.
            libc::madvise(start, SIZE, libc::MADV_NOHUGEPAGE);
            let mut is_joined = true;
            for guard in [start, start.byte_add(SIZE - page)] {
                let is_advised = libc::madvise(guard, page, MADV_GUARD_INSTALL) == 0;
                is_joined &= is_advised;
                if !is_advised && libc::mprotect(guard, page, libc::PROT_NONE) != 0 {
                    let error = io::Error::last_os_error();
                    libc::munmap(start, SIZE);
                    return Err(error);
                }
            }
            (start.expose_provenance(), is_joined)
        };
        Ok(Self { start, top: start + SIZE - page - number % COLOURS * COLOUR_STEP, is_joined })
    }

    /// Lowest usable address, and the address above the usable bytes.
    pub fn bounds(&self) -> [usize; 2] {
        [self.start + page_size(), self.top]
    }
}

impl Drop for Stack {
    fn drop(&mut self) {
        // SAFETY: the whole mapping of `new`; its owner runs no code on it any more.
        unsafe { libc::munmap(ptr::with_exposed_provenance_mut(self.start), SIZE) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_have_other_places_in_their_pages_and_room_above_the_guard() {
        let stacks: Vec<_> = (0..COLOURS).map(|number| Stack::new(number).unwrap()).collect();
        let mut places: Vec<_> = stacks.iter().map(|stack| stack.bounds()[1] % page_size()).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), COLOURS);
        for stack in &stacks {
            let [low, top] = stack.bounds();
            assert!(top % 16 == 0 && top - low > SIZE - 3 * page_size(), "{low:#x} to {top:#x}");
            // SAFETY: both ends of the stack, which nobody uses.
            unsafe {
                ptr::with_exposed_provenance_mut::<u8>(low).write_volatile(1);
                ptr::with_exposed_provenance_mut::<u8>(top - 1).write_volatile(1);
            }
        }
    }
}
