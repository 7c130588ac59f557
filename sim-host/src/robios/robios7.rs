//! Which function of which family answers each RoBIOS-7 call, and the units between: millimetres, degrees and milliseconds.

use robios_sys::Robios7;

use super::caller::Caller;

impl Robios7 for Caller {}
