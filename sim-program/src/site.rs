//! Call sites in programs.

use robios_sys::CallSite;

/// Location of a call in a program, stored in raw form and converted to text only on demand.
#[derive(Clone, Debug)]
pub enum Site {
    /// In a program that runs in this process.
    InHost(CallSite),
    /// In a program that reports the location with the call: a program in its own process, or code of the process that
    /// embeds the simulator.
    Reported(RemoteSite),
}

impl Default for Site {
    fn default() -> Self {
        Self::InHost(CallSite::NONE)
    }
}

/// Location of a call as the program reported it.
#[derive(Clone, Debug, Default)]
pub struct RemoteSite {
    /// Return address of the call; 0 if unknown.
    pub address: u64,
    /// The line in `file`; 0 if unknown.
    pub line: u32,
    /// The source file, for programs that report it themselves; otherwise empty.
    pub file: String,
}

impl RemoteSite {
    /// Parses a site such as `maze.py:12`.
    pub fn of_line(line: &str) -> Option<Self> {
        let (file, number) = line.rsplit_once(':')?;
        Some(Self { address: 0, line: number.parse().ok()?, file: file.to_owned() })
    }

    /// The line as `maze.py:12`; `None` for a program that reports addresses.
    pub fn line(&self) -> Option<String> {
        (!self.file.is_empty()).then(|| format!("{}:{}", self.file, self.line))
    }
}
