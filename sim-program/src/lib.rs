//! Robot programs: finds the program that a sim file names, builds it if it is a source, and loads a copy for each
//! robot.
//!
//! The crate `sim-host` runs programs and implements the RoBIOS calls. `docs/programs.md` describes the kinds of
//! programs, the search order, the flags and the cache. [`files`] reads the files of scenes; [`host`] describes the
//! executable that contains these crates.

pub mod access;
mod beside;
mod brace;
pub mod build;
pub mod cache;
mod calls;
pub mod cargo;
pub mod code;
pub mod command;
pub mod compile;
pub mod compiler;
mod constructors;
mod data_files;
pub mod embedded;
pub mod files;
pub mod find;
pub mod float;
pub mod generation;
mod header;
mod hint;
pub mod host;
pub mod image;
mod inline;
pub mod kind;
pub mod language;
pub mod load;
pub mod parts;
pub mod plain;
mod plain_rust;
pub mod prepare;
pub mod python;
pub mod run_folder;
pub mod sandbox;
pub mod scene;
pub mod share;
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
