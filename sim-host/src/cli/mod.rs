//! The command line: one file a subcommand.

pub mod cc;
pub mod new;
pub mod check;
pub mod progress;
pub mod table;
