//! Robot programs: finds the program that a sim file names, builds it if it is a source, and loads a copy for each robot.
//!
//! The executive runs programs, and the module `robios` defines the effects of RoBIOS calls. `docs/programs.md` describes the kinds
//! of programs, the search order, the flags and the cache.

pub(crate) mod access;
mod brace;
pub mod build;
pub mod cache;
mod calls;
pub mod cargo;
pub(crate) mod code;
pub mod command;
pub mod compile;
pub mod compiler;
mod constructors;
mod data_files;
pub mod embedded;
pub mod find;
pub mod float;
pub mod generation;
mod hint;
pub mod image;
pub mod kind;
pub mod language;
pub mod load;
pub(crate) mod plain;
mod plain_rust;
pub mod prepare;
pub mod python;
pub(crate) mod run_folder;
pub mod sandbox;
pub mod scene;
pub(crate) mod share;
pub mod shared;
pub mod site;
pub mod symbols;
#[cfg(test)]
mod tests;
pub mod words;

pub use build::{Builder, Tools};
pub use cache::Cache;
pub use compile::{Kits, ShimKit};
pub use find::{Found, SearchPath, find_program};
pub use generation::{Generation, GenerationHint};
pub use load::{LoadedProgram, Loader, check_mappings};
pub use prepare::{Prepared, prepare};
pub use words::split_words;
