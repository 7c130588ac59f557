//! The command line: one file a subcommand.

pub mod cc;
pub mod check;
pub mod new;
pub mod progress;
pub mod table;
