//! Call sites in programs.

use robios_sys::CallSite;

/// Place of a call in a program: stored in raw form, and put in words only on demand.
#[derive(Clone, Debug)]
pub enum Site {
    /// In a program that runs in this process.
    InHost(CallSite),
    /// In a program that runs in its own process.
    InChild(RemoteSite),
}

impl Default for Site {
    fn default() -> Self {
        Self::InHost(CallSite::NONE)
    }
}

/// Place of a call in a program in its own process, as that process reported it.
#[derive(Clone, Debug, Default)]
pub struct RemoteSite {
    /// Return address of the call; 0 if unknown.
    pub address: u64,
    /// The line in `file`; 0 if unknown.
    pub line: u32,
    /// The source file, for programs that report it themselves; else empty.
    pub file: String,
}
