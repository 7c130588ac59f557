//! The part of `robios-sys` that loading needs.

use std::ffi::{c_char, c_int, c_void};

/// The root of the tables that a program gets.
pub type Host = c_void;
/// Version of the layouts.
pub const ABI_VERSION: u32 = 1;
/// Name of the one symbol that a program exports.
pub const PROGRAM_SYMBOL: &str = "eyesim_program";

/// Runs the program.
pub type Run =
    unsafe extern "C" fn(host: *const Host, robot: *mut c_void, argc: c_int, argv: *const *const c_char) -> c_int;

/// What a program exports.
#[repr(C)]
pub struct Program {
    /// Bytes of this struct.
    pub size: u32,
    /// ABI version.
    pub abi: u32,
    /// RoBIOS generation.
    pub generation: u32,
    /// Flags.
    pub flags: u32,
    /// Language.
    pub language: u32,
    /// Bytes of the support table.
    pub support_size: u32,
    /// Bytes of the RoBIOS table.
    pub robios_size: u32,
    /// Runs the program.
    pub run: Run,
}
