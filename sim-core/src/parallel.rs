//! Loops with independent iterations, which a caller with several threads can run in parallel.

/// Number of items in a section of a loop.
pub const SECTION: usize = 8;

/// Runs loops, in parallel if it has several threads.
pub trait Pool {
    /// Calls `act` once for each section of `items`, in any order and in parallel. A section has [`SECTION`] items; the last one may have
    /// fewer. Returns when all calls have returned.
    fn for_each_section<T: Send>(&self, items: &mut [T], act: impl Fn(&mut [T]) + Sync);

    /// Calls `act` once for each of `items`, in any order and in parallel. Returns when all calls have returned.
    fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Sync) {
        self.for_each_section(items, |section| section.iter_mut().for_each(&act));
    }
}

/// The pool of a caller with one thread: runs the iterations of a loop one after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Pool for Serial {
    fn for_each_section<T: Send>(&self, items: &mut [T], act: impl Fn(&mut [T]) + Sync) {
        items.chunks_mut(SECTION).for_each(act);
    }
}

/// An empty vector of another type that reuses the memory of `spare` if the elements have the same layout. With it, a vector of references
/// that is needed in each slot does not allocate.
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
