//! The C ABI between the simulator and a robot program: types, tables of functions, and the traits that a host
//! implements. No logic.
//!
//! One list of functions for each group ([`support`], [`robios6`], [`robios7`]) gives the `#[repr(C)]` table that a program gets, a
//! trait with one method a function, the thunks between them, and the description from which C headers and shim are
//! written. A program's library exports one symbol, [`PROGRAM_SYMBOL`], a [`Program`]; its `run` gets a [`Host`].
//!
//! Pointers of a program are touched only in a thunk, before the host's method runs or after it has returned: so a
//! wild pointer faults while the host holds no lock.

mod abi;
pub mod c;
pub mod constant;
pub mod param;
pub mod python;
pub mod robios6;
pub mod robios7;
pub mod support;
pub mod table;
pub mod wire;

pub use abi::*;
pub use param::{ByteRoom, ByteSlice, Bytes, Callback, In, InOut, Out, OutBytes, OutFloats, OutInts, OutNumbers, Text};
pub use robios6::{Robios6, Robios6Call, Robios6Table};
pub use robios7::{Robios7, Robios7Call, Robios7Table};
pub use support::{Support, SupportCall, SupportTable};
pub use table::{CallContext, CallRecord};
