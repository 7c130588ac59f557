//! What a run leaves behind: trace, report, pictures and the lines on the terminal.
//!
//! Each is a [`Sink`] of the records that the simulation makes. Nothing here decides what happens in a run: with or without sinks
//! the run and its digest are the same.

pub mod frame;
pub mod log;
#[cfg(feature = "window")]
pub mod mcap;
pub mod png;
pub mod read;
pub mod report;
pub mod sink;
pub mod tape;
pub mod trace;
pub mod trail;

pub use log::Log;
#[cfg(feature = "window")]
pub use mcap::Mcap;
pub use read::{Recorded, TraceError, TraceReader};
pub use report::Report;
pub use sink::{RecordError, Sink, Sinks};
pub use tape::Tape;
pub use trace::Trace;
pub use trail::Trails;
