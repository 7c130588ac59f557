//! Recording of a simulation: events, the robots' journals, the digest, and interventions.
//!
//! Each robot appends its events to its own [`Journal`] while a slot runs. At the slot's end the [`Recorder`] adds the
//! events to the digest and merges them in the order (virtual time, robot, sequence) for the observer. Recording never
//! influences the simulation, and the digest does not depend on the observer.

mod action;
pub mod digest;
pub mod event;
pub mod journal;
pub mod recorder;

pub use action::Action;
pub use digest::Digest;
pub use event::{ActionText, Cell, CellType, Event, FloatList, Kind, KindSet, Obstacle, Outcome, Record, WORLD};
pub use journal::Journal;
pub use recorder::Recorder;
