//! Stacks of fibers, allocated side by side in large mappings, so that a stack costs one system call and no separate
//! mapping.

use std::io;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use parking_lot::Mutex;

use crate::program::share::page_size;

/// The stacks of an executor.
#[derive(Default)]
pub struct Stacks {
    pool: Mutex<StackPool>,
    /// No further stack will be taken, so that returned stacks need not be prepared for reuse.
    is_ending: AtomicBool,
}

/// Free slots for further stacks.
#[derive(Default)]
struct StackPool {
    /// The newest block, with the number of stacks taken from it.
    block: Option<(Arc<Block>, usize)>,
    /// Stacks that have been returned: their blocks and lowest addresses.
    returned: Vec<(Arc<Block>, usize)>,
    /// Number of all stacks so far.
    count: usize,
}

/// A mapping of consecutive stacks, each with guard pages at its lower end; further guard pages lie above the last
/// stack.
struct Block {
    /// Address of the mapping.
    mapping: usize,
    /// Length of the mapping in bytes.
    len: usize,
    /// Lowest address of the first stack.
    first: usize,
    /// Number of stacks in the block.
    count: usize,
    /// The mapping has not been split by its guard pages.
    is_joined: bool,
}

/// A stack: memory between guard pages, committed on first touch.
pub struct Stack {
    /// Lowest address, at which the lower guard pages begin.
    start: usize,
    /// Address above the usable bytes, a multiple of 16.
    top: usize,
    block: Arc<Block>,
    stacks: Arc<Stacks>,
}

/// Size of a stack in bytes, its lower guard pages included.
const STACK_SIZE: usize = super::super::thread::STACK;

/// Number of stacks in the first block; each further block is twice as large, up to [`MAX_BLOCK`].
const MIN_BLOCK: usize = 8;

/// Maximum number of stacks in a block.
const MAX_BLOCK: usize = 1024;

/// Memory covered by one page of the kernel's page tables. The border of two stacks lies in the middle of such a range,
/// so that the touched pages of one stack and the guard pages of the next share one table page.
const TABLE_SPAN: usize = 2 << 20;

/// Number of offsets of stack tops within their last page (cache colouring): neighbours differ, so that their frames do
/// not compete for the same sets of the first-level cache.
const COLOURS: usize = 16;

/// Bytes between two of these offsets.
const COLOUR_STEP: usize = 128;

/// Number of memory mappings per stack: none if guard pages do not split the mapping, two if they need mappings of
/// their own.
pub fn mappings_per_stack() -> usize {
    static COUNT: OnceLock<usize> = OnceLock::new();
    *COUNT.get_or_init(|| Block::map(1).map_or(2, |block| if block.is_joined { 0 } else { 2 }))
}

/// Makes accesses to pages fault without splitting their mapping (Linux 6.13).
const MADV_GUARD_INSTALL: i32 = 102;

impl Stacks {
    /// Takes a stack.
    ///
    /// # Errors
    /// The system lacks memory for it.
    pub fn take(self: &Arc<Self>) -> io::Result<Stack> {
        let mut pool = self.pool.lock();
        let number = pool.count;
        let (block, start) = match pool.returned.pop() {
            Some(returned) => returned,
            None => pool.take_next()?,
        };
        pool.count += 1;
        let top = start + STACK_SIZE - number % COLOURS * COLOUR_STEP;
        Ok(Stack { start, top, block, stacks: Arc::clone(self) })
    }

    /// Declares that no further stack will be taken.
    pub fn end(&self) {
        self.is_ending.store(true, Ordering::Relaxed);
    }
}

impl StackPool {
    /// Takes the next unused stack, in a new block if necessary; returns its block and its lowest address.
    fn take_next(&mut self) -> io::Result<(Arc<Block>, usize)> {
        if self.block.as_ref().is_none_or(|(block, taken)| *taken == block.count) {
            let count = self.block.as_ref().map_or(MIN_BLOCK, |(block, _)| (2 * block.count).min(MAX_BLOCK));
            // If there is no memory for many stacks, there may be enough for one.
            let block = Block::map(count).or_else(|_| Block::map(1))?;
            self.block = Some((Arc::new(block), 0));
        }
        let Some((block, taken)) = &mut self.block else { unreachable!("it was just set") };
        let start = block.first + *taken * STACK_SIZE;
        // The guard pages below this stack exist: those of the block or those above the previous stack.
        guard(start + STACK_SIZE)?;
        *taken += 1;
        Ok((Arc::clone(block), start))
    }
}

impl Block {
    /// Maps a block of `count` stacks, with the guard pages below the first one.
    fn map(count: usize) -> io::Result<Self> {
        let len = count * STACK_SIZE + TABLE_SPAN + guard_size();
        // SAFETY: a fresh anonymous mapping; the advice concerns only its pages.
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
            // A failure means that the kernel has no huge pages to disable.
            libc::madvise(mapping, len, libc::MADV_NOHUGEPAGE);
            mapping.expose_provenance()
        };
        let first = (mapping + TABLE_SPAN / 2).next_multiple_of(TABLE_SPAN) - TABLE_SPAN / 2;
        let mut block = Self { mapping, len, first, count, is_joined: true };
        block.is_joined = guard(first)?;
        Ok(block)
    }
}

/// Size in bytes of the guard pages between two stacks; a stack frame that is larger could skip them.
fn guard_size() -> usize {
    2 * page_size()
}

/// Turns the unused pages of a block at `address` into guard pages; returns true if this does not split the mapping.
fn guard(address: usize) -> io::Result<bool> {
    let (page, len) = (ptr::with_exposed_provenance_mut(address), guard_size());
    // SAFETY: advice and protection concern only these pages, which are unused.
    unsafe {
        if libc::madvise(page, len, MADV_GUARD_INSTALL) == 0 {
            return Ok(true);
        }
        if libc::mprotect(page, len, libc::PROT_NONE) == 0 { Ok(false) } else { Err(io::Error::last_os_error()) }
    }
}

impl Drop for Block {
    fn drop(&mut self) {
        // SAFETY: the whole mapping of `map`; its stacks, which own reference counts of the block, are gone.
        unsafe { libc::munmap(ptr::with_exposed_provenance_mut(self.mapping), self.len) };
    }
}

impl Stack {
    /// Lowest usable address, and the address above the usable bytes.
    pub fn bounds(&self) -> [usize; 2] {
        [self.start + guard_size(), self.top]
    }

    /// Address above the usable bytes.
    pub fn top(&self) -> usize {
        self.top
    }
}

impl Drop for Stack {
    fn drop(&mut self) {
        if self.stacks.is_ending.load(Ordering::Relaxed) {
            return;
        }
        let [low, _] = self.bounds();
        // SAFETY: the usable pages of this stack, on which its owner runs no code any more.
        unsafe {
            libc::madvise(ptr::with_exposed_provenance_mut(low), self.start + STACK_SIZE - low, libc::MADV_DONTNEED)
        };
        self.stacks.pool.lock().returned.push((Arc::clone(&self.block), self.start));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stack_tops_are_coloured_and_stacks_do_not_overlap() {
        let source = Arc::new(Stacks::default());
        let stacks: Vec<_> = (0..3 * COLOURS).map(|_| source.take().unwrap()).collect();
        let mut offsets: Vec<_> = stacks.iter().map(|stack| stack.bounds()[1] % page_size()).collect();
        offsets.sort_unstable();
        offsets.dedup();
        assert_eq!(offsets.len(), COLOURS);
        let mut ranges: Vec<_> = stacks.iter().map(Stack::bounds).collect();
        ranges.sort_unstable();
        assert!(ranges.is_sorted_by(|[_, top], [low, _]| top + guard_size() <= *low));
        for [low, top] in ranges {
            assert!(top % 16 == 0 && top - low > STACK_SIZE - 4 * page_size(), "{low:#x} to {top:#x}");
            // SAFETY: both ends of the stack, which is unused.
            unsafe {
                ptr::with_exposed_provenance_mut::<u8>(low).write_volatile(1);
                ptr::with_exposed_provenance_mut::<u8>(top - 1).write_volatile(1);
            }
        }
    }

    #[test]
    fn a_returned_stack_is_reused_and_zeroed() {
        let source = Arc::new(Stacks::default());
        let use_stack = || {
            let stack = source.take().unwrap();
            let [low, _] = stack.bounds();
            // SAFETY: the lowest byte of the stack, which is unused.
            let before = unsafe {
                let byte = ptr::with_exposed_provenance_mut::<u8>(low);
                let before = byte.read_volatile();
                byte.write_volatile(7);
                before
            };
            (low, before)
        };
        let (first, second) = (use_stack(), use_stack());
        assert_eq!(first, second);
        assert_eq!(first.1, 0);
    }
}
