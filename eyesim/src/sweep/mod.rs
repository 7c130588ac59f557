//! Sweeps as a library: a folder holds the rows of a suite's cases, in one append-only file for each shard.
//!
//! A [`Shard`] is the part of the cases that one process runs. [`ShardFile::open`] locks and reads the file of a shard,
//! [`finished_cases`] determines which cases have rows in it, and [`ShardFile::append`] adds rows. [`read_all`] reads
//! the files of all shards, and [`merge`] joins their rows.

mod file;
mod merge;
mod shard;

pub use file::{Head, Line, Lines, ShardFile, read_all};
pub use merge::merge;
pub use shard::Shard;

use std::collections::{BTreeMap, HashMap};
use std::io;
use std::path::PathBuf;

use crate::suite::{Case, RowOutcome, Session, Suite};

/// Reasons why rows cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A file or folder cannot be read or written.
    #[error("`{}`: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: io::Error,
    },
    /// The folder is a file, or the file is not a regular file.
    #[error("`{}` is not a {expected}", path.display())]
    Kind {
        /// The path.
        path: PathBuf,
        /// The expected kind.
        expected: &'static str,
    },
    /// A line is neither a header nor a row.
    #[error(
        "{}:{line}:{column}: {what}; expected a line as `eyesim sweep` writes it. Remove the line, and its case runs again",
        path.display()
    )]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// Description of the error.
        what: String,
    },
    /// The file has rows of another version of eyesim.
    #[error("{}:{line}: the rows are of eyesim {version}, and this is {}: rows of two versions do not mix", path.display(), env!("CARGO_PKG_VERSION"))]
    Version {
        /// The file.
        path: PathBuf,
        /// Number of the line.
        line: usize,
        /// The other version.
        version: String,
    },
    /// Another process has locked the shard.
    #[error("`{}`: another `eyesim sweep` runs this shard", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The file has rows whose cases the suite no longer has, or has with other keys.
    #[error(
        "{}:{line}: the row of `{case}` is not of this suite as it is now, nor are {others} others: the suite, its files or its limits have \
         changed since. Give another folder, or remove the file to run all again",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Number of the first such line.
        line: usize,
        /// Its case.
        case: String,
        /// Number of further such rows.
        others: usize,
    },
    /// A key has two results.
    #[error(
        "the key {key} (`{case}`) has two {what}: {first}, and {second}. `eyesim sweep case SUITE {key}` runs it once more"
    )]
    Conflict {
        /// The key.
        key: String,
        /// The case.
        case: String,
        /// The quantity in which they differ.
        what: &'static str,
        /// The first result and its location.
        first: String,
        /// The second result and its location.
        second: String,
    },
    /// A folder has no rows.
    #[error("`{}` has no rows of a sweep: expected files such as `{}`", folder.display(), Shard::WHOLE.file_name())]
    Empty {
        /// The folder.
        folder: PathBuf,
    },
}

/// Indices of the cases of a shard that have rows in its file, with their outcomes; without cases that could not be
/// run.
///
/// # Errors
/// [`SweepError::Foreign`] for rows whose keys differ from the current keys of their cases.
pub fn finished_cases(
    lines: &Lines,
    shard: Shard,
    (suite, cases): (&Suite, &[Case]),
    session: &mut Session,
) -> Result<BTreeMap<usize, RowOutcome>, SweepError> {
    // Before the matrix had all of its values, a row's case may have been in this shard.
    let indices: HashMap<&str, usize> = (0..).zip(cases).map(|(index, case)| (case.name.as_str(), index)).collect();
    let mut outcomes = BTreeMap::new();
    let mut foreign: Option<(&Line, usize)> = None;
    for line in lines.rows.iter().filter(|line| line.row.outcome != RowOutcome::Error) {
        if session.interrupt.is_set() {
            break;
        }
        let index = indices.get(line.row.case.as_str()).copied();
        let current = index.filter(|&index| session.key(suite, &cases[index]).is_ok_and(|key| key == line.row.key));
        match current {
            Some(index) => _ = outcomes.insert(index, line.row.outcome),
            None => foreign = Some(foreign.map_or((line, 0), |(first, others)| (first, others + 1))),
        }
    }
    match foreign {
        None => {
            outcomes.retain(|index, _| shard.contains(*index));
            Ok(outcomes)
        }
        Some((first, others)) => Err(SweepError::Foreign {
            path: lines.path.clone(),
            line: first.number,
            case: first.row.case.clone(),
            others,
        }),
    }
}
