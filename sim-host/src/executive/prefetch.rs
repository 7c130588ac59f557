//! Prefetch of memory into the processor's caches while a worker does other work.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
use std::ops::Range;

/// Length of a cache line in bytes.
const LINE: usize = 64;

/// Prefetches the memory at these addresses into the second-level cache on x86-64; does nothing elsewhere. Addresses
/// that are not mapped are allowed.
#[inline]
pub fn prefetch(addresses: Range<*const u8>) {
    if addresses.is_empty() {
        return;
    }
    let mut line = addresses.start.map_addr(|address| address & !(LINE - 1));
    while line < addresses.end {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a prefetch reads nothing and never faults.
        unsafe {
            _mm_prefetch::<_MM_HINT_T1>(line.cast())
        };
        line = line.wrapping_add(LINE);
    }
}

/// Prefetches the memory of a value, without reading it.
#[inline]
pub fn prefetch_value<T>(value: &T) {
    let start = std::ptr::from_ref(value);
    prefetch(start.cast()..start.wrapping_add(1).cast());
}
