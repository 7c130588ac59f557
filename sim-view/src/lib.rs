//! The window through which people watch a simulation and take part in it: a server, the page that it shows, and the protocol
//! between the two.
//!
//! Knows nothing of the simulator: who runs it fills the types of [`protocol`] and carries out what pages ask for.
#![forbid(unsafe_code)]

pub mod page;
pub mod protocol;
pub mod window;

pub use page::Page;
pub use window::{Access, Asked, Commands, Download, Look, OpenError, Options, Window};
