//! The command line: one file a subcommand.

pub mod progress;
pub mod table;
