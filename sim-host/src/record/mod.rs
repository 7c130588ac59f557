//! Output of a run: trace, report, recordings, pictures and the lines on the terminal.
//!
//! Each output is a [`Sink`] of the simulation's records. Sinks do not influence a run: its events and its digest are
//! equal with and without sinks.

#[cfg(feature = "parquet")]
mod columnar;
pub mod diff;
pub mod event_store;
mod file;
pub mod frame;
pub mod hint_locations;
pub mod layer;
pub mod log;
#[cfg(feature = "window")]
pub mod mcap;
pub mod notes;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod png;
pub mod read;
pub mod report;
pub mod sink;
mod stored;
pub mod trace;
pub mod trace_file;
pub mod trail;
mod zstd;

pub use event_store::EventStore;
pub use hint_locations::HintLocations;
pub use log::Log;
#[cfg(feature = "window")]
pub use mcap::Mcap;
pub use read::{Recorded, TraceError, TraceReader};
pub use report::Report;
pub use sink::{RecordError, Sink, Sinks};
pub use trace::{Trace, TraceFilter};
pub use trace_file::TraceFile;
pub use trail::Trails;
