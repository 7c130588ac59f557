//! Runs the scenes of four papers with `eyesim` and compares the papers' claims with our results.
//!
//! Each paper has one module. The module runs its scenes ([`run`]), reads their traces ([`trace`]) and makes a page of
//! figures, tables and claims ([`page`]). [`doc`] writes the tables into a page of the docs, or compares them with that
//! page. Robot programs do not depend on this crate.

pub mod alduro;
pub mod doc;
pub mod eyesim;
pub mod france;
pub mod page;
pub mod run;
pub mod trace;
pub mod wu;
