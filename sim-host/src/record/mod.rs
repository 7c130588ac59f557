//! What a run leaves behind: events, digest, trace, report, pictures and the lines on the terminal.
//!
//! Each robot appends its events to a [`Journal`] of its own while a slot runs; at the slot's end the [`Recorder`] seals
//! the journals (digest), merges them in the one order (virtual time, robot, sequence) and hands them to the sinks.
//! Nothing here decides what happens in a run: with or without sinks the run and its digest are the same.

pub mod digest;
pub mod event;
pub mod frame;
pub mod journal;
pub mod log;
pub mod mcap;
pub mod png;
pub mod read;
pub mod recorder;
pub mod report;
pub mod tape;
pub mod trace;
pub mod trail;

pub use digest::Digest;
pub use event::{ActionText, Event, Kind, Numbers, Obstacle, Outcome, Record};
pub use journal::Journal;
pub use log::Log;
pub use mcap::Mcap;
pub use read::{Recorded, TraceError, TraceReader};
pub use recorder::{RecordError, Recorder, Sink};
pub use report::Report;
pub use tape::Tape;
pub use trace::Trace;
pub use trail::Trails;
