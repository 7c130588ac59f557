//! The C ABI between the simulator and a robot program: types, tables of functions, and the traits that a host
//! implements. No logic.
//!
//! One list of functions per group ([`support`], [`robios6`], [`robios7`]) generates the `#[repr(C)]` table passed to a
//! program, a trait with one method per function, the thunks between them, and the description from which C headers and
//! shim are generated. A program's library exports one symbol, [`PROGRAM_SYMBOL`], a [`Program`]; its `run` gets a
//! [`Host`].
//!
//! Pointers of a program are dereferenced only in thunks, before the host's method runs or after it has returned: so a
//! wild pointer crashes while the host holds no lock.

mod abi;
pub mod c;
pub mod constant;
pub mod param;
pub mod python;
pub mod reference;
pub mod robios6;
pub mod robios7;
pub mod support;
pub mod table;
pub mod wire;

pub use abi::*;
pub use param::{
    ByteBuffer, ByteSlice, Bytes, Callback, In, InOut, Out, OutBytes, OutFloats, OutInts, OutNumbers, Text,
};
pub use robios6::{Robios6, Robios6Call, Robios6Table};
pub use robios7::{Robios7, Robios7Call, Robios7Table};
pub use support::{Support, SupportCall, SupportTable};
pub use table::{CallContext, CallRecord};
