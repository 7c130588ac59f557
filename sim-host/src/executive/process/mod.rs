//! Robot programs in their own processes: a crash ends only one robot, and a program may be in any language that can
//! map memory.
//!
//! In the host, the robot has its usual flow, whose thread answers the child's calls. So the dispatcher, the
//! implementation of the calls and the record do not depend on where a program runs. Both sides share [`channel`],
//! [`client`] is the child's side, [`child`] the host's handle of the process, and [`serve`] answers calls in the host.
//! `docs/protocol.md` describes the protocol.

pub mod channel;
pub mod child;
pub mod client;
pub mod debugger;
mod output;
pub mod serve;
mod spinning;

pub use channel::CodeLocation;
pub use child::{CHILD_NAME, Child};
pub use debugger::Debugger;
