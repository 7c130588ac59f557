//! The record of a simulation: events, the robots' journals of them, their digest, and what people do from outside.
//!
//! Each robot appends its events to a [`Journal`] of its own while a slot runs; at the slot's end the [`Recorder`] seals the
//! journals (digest) and merges them in the one order (virtual time, robot, sequence) for whoever wants to see them. Nothing here
//! decides what happens: the digest is the same whether anybody looks or not.

mod action;
pub mod digest;
pub mod event;
pub mod journal;
pub mod recorder;

pub use action::Action;
pub use digest::Digest;
pub use event::{ActionText, Event, Kind, KindSet, Numbers, Obstacle, Outcome, Record, WORLD};
pub use journal::Journal;
pub use recorder::Recorder;
