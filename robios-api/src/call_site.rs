//! Where in the program's source the call in progress was made, so that messages can say so.

use std::cell::Cell;
use std::panic::Location;

thread_local! {
    static LAST: Cell<Option<&'static Location<'static>>> = const { Cell::new(None) };
}

/// Notes where the call that starts now was made. The one place that publishes it.
pub(crate) fn note_call_site(location: &'static Location<'static>) {
    LAST.set(Some(location));
}

/// Where the last call on this thread was made.
pub(crate) fn last() -> Option<&'static Location<'static>> {
    LAST.get()
}
