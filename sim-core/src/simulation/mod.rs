//! The simulation: robots with their devices in one environment, advanced slot by slot.
//!
//! [`Robot`] is all that is known of one robot, [`Environment`] what they share. Programs, threads and files are not known here:
//! whoever runs programs lets each robot act within the slot, at its own virtual time, and ends the slot.

mod environment;
mod placement;
mod robot;
mod station;
mod traffic;

pub use environment::{Environment, SlotEnd};
pub use placement::{Placeable, Placement};
pub use robot::{Robot, WalkRecord};
