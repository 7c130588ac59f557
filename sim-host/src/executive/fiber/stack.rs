//! Stacks of fibers: neighbours in large mappings, so that a stack costs one system call and no mapping of its own.

use std::io;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use parking_lot::Mutex;

use crate::program::share::page_size;

/// The stacks of an executor.
#[derive(Default)]
pub struct Stacks {
    places: Mutex<Places>,
    /// No further stack will be taken, so that returned ones need not be prepared for others.
    is_ending: AtomicBool,
}

/// Places for further stacks.
#[derive(Default)]
struct Places {
    /// The newest block, with the number of stacks taken from it.
    block: Option<(Arc<Block>, usize)>,
    /// Stacks that have been returned: their blocks and lowest addresses.
    returned: Vec<(Arc<Block>, usize)>,
    /// Number of all stacks so far.
    count: usize,
}

/// A mapping of consecutive stacks, each with guard pages at its lower end; others lie above the last.
struct Block {
    /// Address of the mapping.
    mapping: usize,
    /// Length of the mapping in bytes.
    len: usize,
    /// Lowest address of the first stack.
    first: usize,
    /// Number of stacks.
    count: usize,
    /// The guard pages have not split the mapping.
    is_joined: bool,
}

/// A stack: memory that is used as it is touched, between guard pages.
pub struct Stack {
    /// Lowest address, where the lower guard pages are.
    start: usize,
    /// Address above the usable bytes, a multiple of 16.
    top: usize,
    block: Arc<Block>,
    stacks: Arc<Stacks>,
}

/// Size of a stack in bytes, its lower guard pages included.
const SIZE: usize = super::super::thread::STACK;

/// Number of stacks in the first block; each further block is twice as large, up to [`MAX_BLOCK`].
const FIRST_BLOCK: usize = 8;

/// Greatest number of stacks in a block.
const MAX_BLOCK: usize = 1024;

/// Memory whose pages the kernel keeps in one page of its tables. The border of two stacks lies in the middle of such a part, so that the
/// touched pages of one stack and the guard pages of the next one need only one.
const TABLE_REACH: usize = 2 << 20;

/// Places of stack tops within their last page: neighbours differ, so that their frames do not compete for the same sets of the
/// processor's first cache.
const COLOURS: usize = 16;

/// Bytes between two of these places.
const COLOUR_STEP: usize = 128;

/// Memory mappings for each stack: none where the kernel joins equal neighbours, two where the guard pages need one of their own.
pub fn mappings_per_stack() -> usize {
    static COUNT: OnceLock<usize> = OnceLock::new();
    *COUNT.get_or_init(|| Block::map(1).map_or(2, |block| if block.is_joined { 0 } else { 2 }))
}

/// Lets accesses to pages fault without splitting their mapping (Linux 6.13).
const MADV_GUARD_INSTALL: i32 = 102;

impl Stacks {
    /// Takes a further stack.
    ///
    /// # Errors
    /// The system has no room for it.
    pub fn take(self: &Arc<Self>) -> io::Result<Stack> {
        let mut places = self.places.lock();
        let number = places.count;
        let (block, start) = match places.returned.pop() {
            Some(returned) => returned,
            None => places.next()?,
        };
        places.count += 1;
        let top = start + SIZE - number % COLOURS * COLOUR_STEP;
        Ok(Stack { start, top, block, stacks: Arc::clone(self) })
    }

    /// Declares that no further stack will be taken.
    pub fn end(&self) {
        self.is_ending.store(true, Ordering::Relaxed);
    }
}

impl Places {
    /// The place of a stack that has not been used, in a new block if need be.
    fn next(&mut self) -> io::Result<(Arc<Block>, usize)> {
        if self.block.as_ref().is_none_or(|(block, taken)| *taken == block.count) {
            let count = self.block.as_ref().map_or(FIRST_BLOCK, |(block, _)| (2 * block.count).min(MAX_BLOCK));
            // Where there is no room for many stacks, there may be for one.
            let block = Block::map(count).or_else(|_| Block::map(1))?;
            self.block = Some((Arc::new(block), 0));
        }
        let Some((block, taken)) = &mut self.block else { unreachable!("it was just set") };
        let start = block.first + *taken * SIZE;
        // The guard pages below are those of the block or belong to the stack before.
        guard(start + SIZE)?;
        *taken += 1;
        Ok((Arc::clone(block), start))
    }
}

impl Block {
    /// Maps a block of `count` stacks, with the guard pages below the first one.
    fn map(count: usize) -> io::Result<Self> {
        let len = count * SIZE + TABLE_REACH + guard_size();
        // SAFETY: a fresh anonymous mapping; the advice concerns nothing but its pages.
        let mapping = unsafe {
            let mapping = libc::mmap(
                ptr::null_mut(),
                len,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE,
                -1,
                0,
            );
            if mapping == libc::MAP_FAILED {
                return Err(io::Error::last_os_error());
            }
            // Where the kernel has no huge pages there is nothing to refuse.
            libc::madvise(mapping, len, libc::MADV_NOHUGEPAGE);
            mapping.expose_provenance()
        };
        let first = (mapping + TABLE_REACH / 2).next_multiple_of(TABLE_REACH) - TABLE_REACH / 2;
        let mut block = Self { mapping, len, first, count, is_joined: true };
        block.is_joined = guard(first)?;
        Ok(block)
    }
}

/// Bytes between two stacks: a frame that is larger misses them.
fn guard_size() -> usize {
    2 * page_size()
}

/// Lets accesses to the pages from `address` on fault, which are some of a block's that nobody uses; true if its mapping is not split.
fn guard(address: usize) -> io::Result<bool> {
    let (page, len) = (ptr::with_exposed_provenance_mut(address), guard_size());
    // SAFETY: advice and protection concern only these pages, which nobody uses.
    unsafe {
        if libc::madvise(page, len, MADV_GUARD_INSTALL) == 0 {
            return Ok(true);
        }
        if libc::mprotect(page, len, libc::PROT_NONE) == 0 { Ok(false) } else { Err(io::Error::last_os_error()) }
    }
}

impl Drop for Block {
    fn drop(&mut self) {
        // SAFETY: the whole mapping of `map`; its stacks, which have counts of the block, are gone.
        unsafe { libc::munmap(ptr::with_exposed_provenance_mut(self.mapping), self.len) };
    }
}

impl Stack {
    /// Lowest usable address, and the address above the usable bytes.
    pub fn bounds(&self) -> [usize; 2] {
        [self.start + guard_size(), self.top]
    }
}

impl Drop for Stack {
    fn drop(&mut self) {
        if self.stacks.is_ending.load(Ordering::Relaxed) {
            return;
        }
        let [low, _] = self.bounds();
        // SAFETY: the usable pages of this stack, on which its owner runs no code any more.
        unsafe { libc::madvise(ptr::with_exposed_provenance_mut(low), self.start + SIZE - low, libc::MADV_DONTNEED) };
        self.stacks.places.lock().returned.push((Arc::clone(&self.block), self.start));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_have_other_places_in_their_pages_and_room_above_the_guard() {
        let source = Arc::new(Stacks::default());
        let stacks: Vec<_> = (0..3 * COLOURS).map(|_| source.take().unwrap()).collect();
        let mut places: Vec<_> = stacks.iter().map(|stack| stack.bounds()[1] % page_size()).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), COLOURS);
        let mut ranges: Vec<_> = stacks.iter().map(Stack::bounds).collect();
        ranges.sort_unstable();
        assert!(ranges.is_sorted_by(|[_, top], [low, _]| top + guard_size() <= *low));
        for [low, top] in ranges {
            assert!(top % 16 == 0 && top - low > SIZE - 4 * page_size(), "{low:#x} to {top:#x}");
            // SAFETY: both ends of the stack, which nobody uses.
            unsafe {
                ptr::with_exposed_provenance_mut::<u8>(low).write_volatile(1);
                ptr::with_exposed_provenance_mut::<u8>(top - 1).write_volatile(1);
            }
        }
    }

    #[test]
    fn a_returned_stack_is_taken_again_and_empty() {
        let source = Arc::new(Stacks::default());
        let low = || {
            let stack = source.take().unwrap();
            let [low, _] = stack.bounds();
            // SAFETY: the lowest byte of the stack, which nobody uses.
            let before = unsafe {
                let byte = ptr::with_exposed_provenance_mut::<u8>(low);
                let before = byte.read_volatile();
                byte.write_volatile(7);
                before
            };
            (low, before)
        };
        let (first, again) = (low(), low());
        assert_eq!(first, again);
        assert_eq!(first.1, 0);
    }
}
