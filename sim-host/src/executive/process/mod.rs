//! Robot programs in their own processes: a fault ends only one robot, and a program may be in any language that can map memory.
//!
//! In the host the robot's flow is an ordinary flow of the executor: its thread serves the child's calls instead of
//! making calls, so dispatcher, calls and record are independent of processes. Both sides share [`channel`], [`client`]
//! is the child's side, [`child`] the host's handle of the process, and [`serve`] answers calls in the host.
//! `docs/protocol.md` describes the protocol.

pub mod channel;
pub mod child;
pub mod client;
pub mod debugger;
mod output;
pub mod serve;

pub use channel::ComputingLocation;
pub use child::{CHILD_NAME, Child};
pub use debugger::Debugger;
