//! Loops with independent iterations, which a caller with several threads can run in parallel.

use std::sync::Mutex;

/// Number of items in a section of a loop.
const SECTION: usize = 8;

/// Threads that run loops.
pub trait Pool {
    /// Returns true if a loop over this number of sections runs on several threads.
    fn is_parallel(&self, sections: usize) -> bool;

    /// Calls `act` once for each number less than `sections`, in any order and in parallel. Returns when all calls have
    /// returned.
    fn run(&self, sections: usize, act: &(dyn Fn(usize) + Sync));
}

// A pool is passed as `&dyn Pool`: the functions that use it are compiled once, in this crate.
impl dyn Pool + '_ {
    /// Calls `act` once for each section of `items`, in any order and in parallel. A section has [`SECTION`] items; the
    /// last one may have fewer. Returns when all calls have returned.
    fn for_each_section<T: Send>(&self, items: &mut [T], act: impl Fn(&mut [T]) + Sync) {
        let count = items.len().div_ceil(SECTION);
        if !self.is_parallel(count) {
            return items.chunks_mut(SECTION).for_each(act);
        }
        // The lock is held only to take the next section; this needs neither memory nor unsafe code.
        let sections = Mutex::new(items.chunks_mut(SECTION));
        let next = || sections.lock().ok()?.next();
        self.run(count, &|_| next().into_iter().for_each(&act));
    }

    /// Calls `act` once for each of `items`, in any order and in parallel. Returns when all calls have returned.
    pub fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Sync) {
        self.for_each_section(items, |section| section.iter_mut().for_each(&act));
    }
}

/// The pool of a caller with one thread: runs the iterations of a loop one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Pool for Serial {
    fn is_parallel(&self, _: usize) -> bool {
        false
    }

    fn run(&self, sections: usize, act: &(dyn Fn(usize) + Sync)) {
        (0..sections).for_each(act);
    }
}

/// An empty vector of another type that reuses the memory of `spare` if the elements have the same layout. With it, a
/// vector of references that is needed in each slot does not allocate.
pub fn reuse<T, U>(mut spare: Vec<T>) -> Vec<U> {
    spare.clear();
    // The standard library reuses the memory of `spare` for this `collect`.
    spare.into_iter().map_while(|_| None).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reused_memory_stays_in_place() {
        let spare: Vec<usize> = Vec::with_capacity(100);
        let address = spare.as_ptr().addr();
        let value = 3;
        let mut references: Vec<&i32> = reuse(spare);
        references.push(&value);
        assert_eq!((references.as_ptr().addr(), references.capacity()), (address, 100));
        assert_eq!(references, [&3]);
        let back: Vec<usize> = reuse(references);
        assert_eq!((back.as_ptr().addr(), back.len()), (address, 0));
    }
}
