//! Where in the program's source the call in progress was made, so that messages can say so.

use std::cell::Cell;
use std::ffi::c_void;
use std::panic::Location;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU32, AtomicUsize, Ordering::Relaxed};

use robios_sys::CallSite;

thread_local! {
    static LAST: Cell<Option<&'static Location<'static>>> = const { Cell::new(None) };
}

/// A [`CallSite`] that threads may write at the same time, as the tests of a program do.
#[repr(C)]
struct Published {
    address: AtomicPtr<c_void>,
    file: AtomicPtr<u8>,
    file_len: AtomicUsize,
    line: AtomicU32,
}

const _: () = assert!(size_of::<Published>() == size_of::<CallSite>());

static PUBLISHED: Published = Published {
    address: AtomicPtr::new(ptr::null_mut()),
    file: AtomicPtr::new(ptr::null_mut()),
    file_len: AtomicUsize::new(0),
    line: AtomicU32::new(0),
};

/// What the program's description points to.
pub(crate) const fn published() -> *const CallSite {
    (&raw const PUBLISHED).cast()
}

/// Notes where the call that starts now was made. The one place that publishes it.
pub(crate) fn note_call_site(location: &'static Location<'static>) {
    LAST.set(Some(location));
    let file = location.file();
    PUBLISHED.file.store(file.as_ptr().cast_mut(), Relaxed);
    PUBLISHED.file_len.store(file.len(), Relaxed);
    PUBLISHED.line.store(location.line(), Relaxed);
}

/// Where the last call on this thread was made, since the last [`forget`].
pub(crate) fn last() -> Option<&'static Location<'static>> {
    LAST.get()
}

/// Forgets where calls were made before.
pub(crate) fn forget() {
    LAST.set(None);
}
