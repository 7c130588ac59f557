//! Source location of the call in progress, for messages such as `waits at src/lib.rs:88`.

use std::panic::Location;
use std::ptr::null_mut;
use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, AtomicU32, AtomicUsize, Ordering};

use robios_sys::CallSite;

/// Destination of the locations of calls.
pub(crate) enum Recorder {
    /// The host that has loaded this library. The host reads the variable that [`of_library`] points to.
    Host,
    /// A fake host in the same library.
    Fake(Arc<LastCallSite>),
}

impl Recorder {
    /// Records the location of the call that starts now. Only this function publishes locations.
    pub(crate) fn record(&self, location: &'static Location<'static>) {
        match self {
            Self::Fake(last) => last.0.store(std::ptr::from_ref(location).cast_mut(), Ordering::Relaxed),
            Self::Host => {
                let file = location.file();
                LAST.file.store(file.as_ptr().cast_mut(), Ordering::Relaxed);
                LAST.file_len.store(file.len(), Ordering::Relaxed);
                LAST.line.store(location.line(), Ordering::Relaxed);
            }
        }
    }
}

/// Location of the last call made by a program of the same library.
#[derive(Debug, Default)]
pub(crate) struct LastCallSite(AtomicPtr<Location<'static>>);

impl LastCallSite {
    /// Location of the last call; `None` before the first.
    pub(crate) fn get(&self) -> Option<&'static Location<'static>> {
        // SAFETY: the pointer is null or comes from a `&'static Location` in `Recorder::record`.
        unsafe { self.0.load(Ordering::Relaxed).as_ref() }
    }
}

/// [`CallSite`] with atomic fields, which any thread may write; it has the same fields in the same order.
#[repr(C)]
struct LastCall {
    address: AtomicPtr<u8>,
    file: AtomicPtr<u8>,
    file_len: AtomicUsize,
    line: AtomicU32,
}

const _: () =
    assert!(size_of::<LastCall>() == size_of::<CallSite>() && align_of::<LastCall>() == align_of::<CallSite>());

static LAST: LastCall = LastCall {
    address: AtomicPtr::new(null_mut()),
    file: AtomicPtr::new(null_mut()),
    file_len: AtomicUsize::new(0),
    line: AtomicU32::new(0),
};

/// Pointer to the variable of this library that the host reads.
pub(crate) const fn of_library() -> *const CallSite {
    (&raw const LAST).cast()
}
