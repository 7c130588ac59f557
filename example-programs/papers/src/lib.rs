//! The scenes of three papers, run with `eyesim`, and what they say set beside what we find.
//!
//! One module a paper. Each runs its scenes ([`run`]), reads their traces ([`trace`]) and makes a page of figures, tables and
//! claims ([`page`]); [`doc`] puts the tables into a page of the docs, or finds out whether they are there. Nothing here is
//! known to a robot program.

pub mod alduro;
pub mod doc;
pub mod france;
pub mod page;
pub mod run;
pub mod trace;
pub mod wu;
