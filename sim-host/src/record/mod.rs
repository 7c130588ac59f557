//! Output of a run: trace, report, recordings, pictures and the lines on the terminal.
//!
//! Each output is a [`Sink`] of the simulation's records. Sinks do not influence a run: its events and its digest are equal with
//! and without sinks.

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
pub mod png;
pub mod read;
pub mod report;
pub mod sink;
pub mod trace;
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
pub use trail::Trails;
