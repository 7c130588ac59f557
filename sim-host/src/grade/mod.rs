//! Grading as a library: submissions are read, built and run through a suite, each apart from all others.
//!
//! [`Grader::open`] reads a suite and builds the programs that it brings; [`submission::read_all`] reads the submissions;
//! [`Grader::grade`] grades one in this process, [`grade_all`] many in copies of this process. A [`Graded`] submission depends on its
//! files, the suite and its files, and the version of eyesim only, of which [`Grader::key`] is the hash.

mod archive;
mod choice;
mod grader;
mod pool;
mod seeds;
pub mod submission;

pub use choice::{Choice, Layout};
pub use grader::{GradeError, Graded, Grader};
pub use pool::grade_all;
pub use seeds::{SeedError, parse_seeds};
