//! Robot programs in their own processes: a fault ends only one robot, and a program may be in any language that can map memory.
//!
//! In the host the robot's flow is an ordinary one of the executor: its thread serves the child's calls instead of making them, so
//! dispatcher, calls and record are independent of processes. [`channel`] is what both sides share, [`client`] is the child's side,
//! [`child`] the host's handle of the process, [`serve`] the host's answers. `docs/protocol.md` describes the protocol.

pub mod channel;
pub mod child;
pub mod client;
pub mod debugger;
mod output;
pub mod serve;

pub use channel::ComputingPlace;
pub use child::{CHILD_NAME, Child};
pub use debugger::Debugger;
