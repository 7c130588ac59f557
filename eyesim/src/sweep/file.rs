//! Files of rows in JSON Lines: each session appends a line for each row, after a header line if its header is new.

use std::fs::{self, File, TryLockError};
use std::io::{BufRead as _, BufReader, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::{Shard, SweepError};
use crate::suite::{ROW_SCHEMA, Row};

/// Version of the format of these files.
const SCHEMA: u32 = 1;

/// First characters of a header, which distinguish it from a row.
const HEAD: &str = "{\"sweep\":";

/// Header line of the rows that follow it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the format.
    sweep: u32,
    /// Version of the program.
    eyesim_version: String,
    /// Path of the suite.
    pub suite: String,
    /// Number of cases of the suite.
    pub cases: usize,
    /// Number of cases of the shard.
    pub shard_cases: usize,
}

impl Head {
    /// Creates the header of a sweep of this suite.
    pub fn new(suite: &str, cases: usize, shard: Shard) -> Self {
        Self {
            sweep: SCHEMA,
            eyesim_version: env!("CARGO_PKG_VERSION").to_owned(),
            suite: suite.to_owned(),
            cases,
            shard_cases: shard.count_of(cases),
        }
    }
}

/// A row with its line number.
#[derive(Clone, Debug)]
pub struct Line {
    /// Number of the line, from 1.
    pub number: usize,
    /// The row.
    pub row: Row,
}

/// Contents of a file of rows.
#[derive(Clone, Debug)]
pub struct Lines {
    /// The file.
    pub path: PathBuf,
    /// Shard of the rows.
    pub shard: Shard,
    /// Last header; none in an empty file.
    pub head: Option<Head>,
    /// The rows, in the order in which they were written.
    pub rows: Vec<Line>,
    /// Length of an incomplete last line in bytes; 0 if there is none.
    pub torn: u64,
    /// Length of the complete lines in bytes.
    complete_length: u64,
}

impl Lines {
    /// Reads a file of rows.
    ///
    /// # Errors
    /// It cannot be read, is of another version, or has a line that is neither a header nor a row.
    pub fn read(path: &Path, shard: Shard) -> Result<Self, SweepError> {
        let io = |error| SweepError::Io { path: path.to_owned(), error };
        Self::read_from(&open(path, File::options().read(true)).map_err(io)?, path, shard)
    }

    fn read_from(file: &File, path: &Path, shard: Shard) -> Result<Self, SweepError> {
        let io = |error| SweepError::Io { path: path.to_owned(), error };
        if !file.metadata().map_err(io)?.is_file() {
            return Err(SweepError::Kind { path: path.to_owned(), expected: "file" });
        }
        let mut lines =
            Self { path: path.to_owned(), shard, head: None, rows: Vec::new(), torn: 0, complete_length: 0 };
        let mut reader = BufReader::new(file);
        let (mut bytes, mut number) = (Vec::new(), 0);
        loop {
            bytes.clear();
            let count = reader.read_until(b'\n', &mut bytes).map_err(io)? as u64;
            if count == 0 {
                return Ok(lines);
            }
            number += 1;
            if bytes.last() != Some(&b'\n') {
                // A file that does not begin with a header was not written by a sweep.
                let part = &bytes[..bytes.len().min(HEAD.len())];
                if number == 1 && !HEAD.as_bytes().starts_with(part) {
                    lines.add(&bytes, number)?;
                }
                lines.torn = count;
                return Ok(lines);
            }
            lines.add(&bytes, number)?;
            lines.complete_length += count;
        }
    }

    fn add(&mut self, bytes: &[u8], number: usize) -> Result<(), SweepError> {
        let bytes = bytes.trim_ascii_end();
        let path = || self.path.clone();
        let error = |error: serde_json::Error| {
            let text = error.to_string();
            let message = text.split(" at line ").next().unwrap_or_default().to_owned();
            SweepError::Line { path: path(), line: number, column: error.column().max(1), what: message }
        };
        let invalid = |message: String| SweepError::Line { path: path(), line: number, column: 1, what: message };
        if bytes.starts_with(HEAD.as_bytes()) {
            let head: Head = serde_json::from_slice(bytes).map_err(error)?;
            if head.eyesim_version != env!("CARGO_PKG_VERSION") || head.sweep != SCHEMA {
                return Err(SweepError::Version { path: path(), line: number, version: head.eyesim_version });
            }
            self.head = Some(head);
            return Ok(());
        }
        if self.head.is_none() {
            return Err(invalid("the file does not begin with a sweep header".to_owned()));
        }
        let row: Row = serde_json::from_slice(bytes).map_err(error)?;
        if row.schema != ROW_SCHEMA {
            return Err(invalid(format!("the row is of schema {}, not {ROW_SCHEMA}", row.schema)));
        }
        self.rows.push(Line { number, row });
        Ok(())
    }
}

/// Opens a file without waiting, even if it is a pipe.
fn open(path: &Path, options: &mut fs::OpenOptions) -> std::io::Result<File> {
    options.custom_flags(libc::O_NONBLOCK).open(path)
}

/// The files of rows of a sweep, in the order of their shards.
///
/// # Errors
/// The folder cannot be read or has no such files; see [`Lines::read`].
pub fn read_all(folder: &Path) -> Result<Vec<Lines>, SweepError> {
    let io = |error| SweepError::Io { path: folder.to_owned(), error };
    let mut shards = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        shards.extend(entry.map_err(io)?.file_name().to_str().and_then(Shard::of_file_name));
    }
    if shards.is_empty() {
        return Err(SweepError::Empty { folder: folder.to_owned() });
    }
    shards.sort_unstable();
    shards.into_iter().map(|shard| Lines::read(&folder.join(shard.file_name()), shard)).collect()
}

/// Maximum time until the processes of a killed sweep have released their lock.
const RELEASE_TIMEOUT: Duration = Duration::from_secs(3);

/// The file of a shard, locked for this process.
#[derive(Debug)]
pub struct ShardFile {
    path: PathBuf,
    /// Holds the lock. Forks of this process inherit the descriptor, so it is not open for writing.
    file: File,
}

impl ShardFile {
    /// Opens the file of a shard in `folder`, creating both if necessary, and reads its contents.
    ///
    /// # Errors
    /// See [`Lines::read`]; [`SweepError::Busy`] if another process has locked it.
    pub fn open(folder: &Path, shard: Shard) -> Result<(Self, Lines), SweepError> {
        if fs::metadata(folder).is_ok_and(|metadata| !metadata.is_dir()) {
            return Err(SweepError::Kind { path: folder.to_owned(), expected: "folder" });
        }
        fs::create_dir_all(folder).map_err(|error| SweepError::Io { path: folder.to_owned(), error })?;
        let path = folder.join(shard.file_name());
        let io = |error| SweepError::Io { path: path.clone(), error };
        open(&path, File::options().read(true).append(true).create(true)).map_err(io)?;
        let file = open(&path, File::options().read(true)).map_err(io)?;
        lock(&file, &path)?;
        let lines = Lines::read_from(&file, &path, shard)?;
        Ok((Self { path, file }, lines))
    }

    /// Begins a session: removes an incomplete last line, and writes `head` unless the last header equals it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self, lines: &Lines, head: &Head) -> Result<(), SweepError> {
        if lines.torn > 0 {
            let file = File::options().write(true).open(&self.path);
            file.and_then(|file| file.set_len(lines.complete_length)).map_err(|error| self.io(error))?;
        }
        if lines.head.as_ref() == Some(head) { Ok(()) } else { self.write(head) }
    }

    /// Appends a row; it has been passed to the operating system when this returns.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn append(&self, row: &Row) -> Result<(), SweepError> {
        self.write(row)
    }

    /// Waits until all rows are on the disk.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn sync(&self) -> Result<(), SweepError> {
        self.file.sync_all().map_err(|error| self.io(error))
    }

    /// Appends a line in one call, so that only the last line can be incomplete if this process is killed.
    fn write(&self, line: &impl Serialize) -> Result<(), SweepError> {
        let mut bytes = serde_json::to_vec(line).map_err(|error| self.io(error.into()))?;
        bytes.push(b'\n');
        let file = File::options().append(true).open(&self.path);
        file.and_then(|mut file| file.write_all(&bytes)).map_err(|error| self.io(error))
    }

    fn io(&self, error: std::io::Error) -> SweepError {
        SweepError::Io { path: self.path.clone(), error }
    }
}

/// Locks a file for this process. On a file system without locks, it does nothing: a second process is not detected.
fn lock(file: &File, path: &Path) -> Result<(), SweepError> {
    let start = Instant::now();
    loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if start.elapsed() > RELEASE_TIMEOUT => {
                return Err(SweepError::Busy { path: path.to_owned() });
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(50)),
            Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => return Ok(()),
            Err(TryLockError::Error(error)) => return Err(SweepError::Io { path: path.to_owned(), error }),
            Ok(()) => return Ok(()),
        }
    }
}
