//! Sharing of code pages among all copies of a library.
//!
//! Each robot has a copy of the library's file, for its own variables. The parts that never change (code and constants)
//! are mapped again from one common file after loading. A thousand robots then run on one set of pages instead of a
//! thousand sets, and this set stays in the processor's caches. The corresponding pages of the copy's file are freed.

use std::fs::File;
use std::ops::Range;
use std::os::fd::AsRawFd as _;

use super::image::ReadOnlySegment;

/// Maps the pages of `segments` in the copy at `base` from `common`, and frees them in `copy`, the file from which the
/// copy was loaded. Pages that cannot be shared stay as they are.
///
/// # Safety
/// A library is loaded at `base`, and not unloaded meanwhile. `segments` belong to it and are mapped read-only, from a
/// file with the same bytes there as `common`; no relocation changes them, and nothing else lies in their pages of
/// memory. No other code changes either file.
pub unsafe fn share_pages(base: usize, segments: &[ReadOnlySegment], common: &File, copy: &File) {
    let page = page_size();
    for segment in segments {
        let (start, offset) = (segment.address / page * page, segment.file.start / page * page);
        let len = (segment.address + segment.file.len()).next_multiple_of(page) - start;
        let Ok(file_offset) = libc::off_t::try_from(offset) else { continue };
        if segment.address % page != segment.file.start % page || !base.is_multiple_of(page) {
            continue;
        }
        let protection = if segment.is_code { libc::PROT_READ | libc::PROT_EXEC } else { libc::PROT_READ };
        // SAFETY: the range consists of pages of this segment only, which the dynamic linker has mapped from the same
        // offset of a file with the same bytes (this function's contract): replacing them changes no byte in use, and
        // other threads see the old or the new mapping.
        let mapped = unsafe {
            libc::mmap(
                std::ptr::with_exposed_provenance_mut(base + start),
                len,
                protection,
                libc::MAP_PRIVATE | libc::MAP_FIXED,
                common.as_raw_fd(),
                file_offset,
            )
        };
        if mapped != libc::MAP_FAILED {
            // Only whole pages are freed: the rest of a partial page may still be mapped from the copy.
            free_pages(copy, segment.file.start.next_multiple_of(page)..segment.file.end / page * page);
        }
    }
}

/// Frees the disk space of `range` in `file`; does nothing if the file system does not support it.
fn free_pages(file: &File, range: Range<usize>) {
    let (Ok(start), Ok(len)) = (libc::off_t::try_from(range.start), libc::off_t::try_from(range.len())) else {
        return;
    };
    if range.is_empty() {
        return;
    }
    // SAFETY: the descriptor is open as long as `file`; the call changes only the file.
    let _ = unsafe {
        libc::fallocate(file.as_raw_fd(), libc::FALLOC_FL_PUNCH_HOLE | libc::FALLOC_FL_KEEP_SIZE, start, len)
    };
}

/// Size of a memory page in bytes.
pub fn page_size() -> usize {
    // SAFETY: sysconf reads a constant of the system.
    let size = unsafe { libc::sysconf(libc::_SC_PAGESIZE) };
    usize::try_from(size).unwrap_or(4096).max(1)
}
