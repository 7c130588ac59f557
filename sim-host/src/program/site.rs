//! Where a program called a function.

use robios_sys::CallSite;

/// Where a program called a function: kept as it is told, put in words only when somebody asks.
#[derive(Clone, Debug)]
pub enum Site {
    /// In this process.
    Here(CallSite),
    /// In its own.
    There(RemoteSite),
}

impl Default for Site {
    fn default() -> Self {
        Self::Here(CallSite::NONE)
    }
}

/// Where a program in a process of its own made a call, as it has told.
#[derive(Clone, Debug, Default)]
pub struct RemoteSite {
    /// The address to which the call returns; 0 where it is not known.
    pub address: u64,
    /// The line in `file`; 0 where it is not known.
    pub line: u32,
    /// The source file, of a program that tells it itself.
    pub file: String,
}
