//! Robot programs in processes of their own: a fault ends one robot, and any language that can map memory can be one.
//!
//! In the host the robot's flow stays one of the executor's: its thread serves the child's calls instead of making them. So
//! conductor, calls and record know nothing of processes. [`channel`] is what both sides share, [`client`] is the child, [`child`] the
//! host's handle of it, [`serve`] the host's answers. The protocol is told in `docs/protocol.md`.

pub mod channel;
pub mod child;
pub mod client;
pub mod debugger;
pub mod serve;

pub use child::{CHILD_NAME, Child};
pub use debugger::Debugger;
