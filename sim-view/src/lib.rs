//! The window in which users watch a simulation and intervene in it: a server, the page that it serves, and the
//! protocol between the two.
//!
//! The crate does not depend on the simulator, which fills the types of [`protocol`] and carries out the pages'
//! commands.
#![forbid(unsafe_code)]

pub mod page;
pub mod protocol;
pub mod window;

pub use page::Page;
pub use window::{Access, Commands, Download, Look, OpenError, Options, PendingCommand, Window};
