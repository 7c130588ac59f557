//! Grading as a library: submissions are read, built and run with a suite, isolated from each other.
//!
//! [`Grader::open`] reads a suite and builds the suite's own programs. [`submission::read_all`] reads the submissions.
//! [`Grader::grade`] grades one submission in this process, [`grade_all`] many in forks of this process. A [`Graded`]
//! submission depends only on its files, the suite with its files, and the version of eyesim; [`Grader::key`] is the
//! hash of these.

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
