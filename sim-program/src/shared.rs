//! Copies of a library that several robots use in turn; each robot has its own values of the variables.
//!
//! A private copy of a library costs about six memory mappings, of which a process may have 65,530, and space in the
//! processor's caches and branch predictors. Robots on one worker run one after the other, so one copy suffices for all
//! of them: before a robot runs, the values of the previous robot are copied out, and its own values are copied in.

use std::cell::UnsafeCell;
use std::ops::Range;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, Ordering};

use super::load::Opened;

/// A mapped library that the robots of one worker use.
pub struct SharedCopy {
    opened: Arc<Opened>,
    /// Worker on which all its robots run.
    worker: u32,
    /// Address ranges of the variables.
    ranges: Vec<Range<usize>>,
    /// Values of the variables after loading.
    initial: Box<[u8]>,
    /// The variables whose values are in the copy; null if the values belong to no robot.
    current: AtomicPtr<Variables>,
}

/// The variables of one robot in a shared copy.
pub struct Variables {
    copy: Arc<SharedCopy>,
    /// The robot's values while another robot's values are in the copy.
    values: UnsafeCell<Box<[u8]>>,
}

// SAFETY: `values` is used only by `swap_in`, which runs on the copy's worker.
unsafe impl Send for Variables {}
// SAFETY: as above.
unsafe impl Sync for Variables {}

impl SharedCopy {
    /// Shares the newly opened library among the robots of `worker`; its variables are in the address `ranges`,
    /// relative to its base.
    ///
    /// # Safety
    /// The ranges are writable memory of the library, which only code of the library changes.
    pub unsafe fn new(opened: Opened, worker: u32, ranges: &[Range<usize>]) -> Self {
        let ranges: Vec<_> = ranges.iter().map(|range| opened.base + range.start..opened.base + range.end).collect();
        let mut initial = vec![0; ranges.iter().map(Range::len).sum()].into_boxed_slice();
        let mut offset = 0;
        for range in &ranges {
            // SAFETY: memory of the library by this function's contract, which no code uses now; the buffer has the
            // total size of all ranges.
            unsafe {
                let from = ptr::with_exposed_provenance::<u8>(range.start);
                ptr::copy_nonoverlapping(from, initial[offset..].as_mut_ptr(), range.len());
            }
            offset += range.len();
        }
        Self { opened: Arc::new(opened), worker, ranges, initial, current: AtomicPtr::default() }
    }

    /// The library.
    pub fn opened(&self) -> &Arc<Opened> {
        &self.opened
    }
}

impl std::fmt::Debug for SharedCopy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SharedCopy").field("base", &self.opened.base).field("worker", &self.worker).finish()
    }
}

impl Variables {
    /// Creates the variables of a further robot, with the values after loading.
    pub fn new(copy: Arc<SharedCopy>) -> Self {
        Self { values: UnsafeCell::new(copy.initial.clone()), copy }
    }

    /// The worker on which the robot runs.
    #[inline]
    pub fn worker(&self) -> u32 {
        self.copy.worker
    }

    /// Addresses at which the values are stored while another robot's values are in the copy.
    ///
    /// # Safety
    /// See [`Variables::swap_in`].
    #[inline]
    pub unsafe fn saved(&self) -> Range<*const u8> {
        // SAFETY: no code changes the values meanwhile, by this function's contract.
        unsafe { (*self.values.get()).as_ptr_range() }
    }

    /// Swaps the values of these variables into the copy.
    ///
    /// # Safety
    /// Called on the thread of the copy's worker, while no code of the library runs on it. Variables of the copy are
    /// dropped only when none of their robots runs any more.
    #[inline]
    pub unsafe fn swap_in(&self) {
        let this = ptr::from_ref(self).cast_mut();
        let current = self.copy.current.load(Ordering::Relaxed);
        if current == this {
            return;
        }
        let mut offset = 0;
        for range in &self.copy.ranges {
            let memory = ptr::with_exposed_provenance_mut::<u8>(range.start);
            // SAFETY: memory of the library, which no other code uses now, by the contracts of this function and of
            // `SharedCopy::new`; `current` is alive, since it resets the pointer when it is dropped; all buffers have
            // the total length of all ranges.
            unsafe {
                if let Some(current) = current.as_ref() {
                    ptr::copy_nonoverlapping(memory, (&mut *current.values.get())[offset..].as_mut_ptr(), range.len());
                }
                ptr::copy_nonoverlapping((&*self.values.get())[offset..].as_ptr(), memory, range.len());
            }
            offset += range.len();
        }
        self.copy.current.store(this, Ordering::Relaxed);
    }
}

impl Drop for Variables {
    fn drop(&mut self) {
        let this = ptr::from_mut(self);
        // The exchange fails if another robot's values are in the copy.
        let _ = self.copy.current.compare_exchange(this, ptr::null_mut(), Ordering::Relaxed, Ordering::Relaxed);
    }
}
