//! Scratch folders, the only folders to which a restricted process may write; their size is checked together with the
//! program's other limits.

use std::fs;
use std::io;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use parking_lot::Mutex;

use super::Limits;
use crate::run_folder::RunFolder;

/// Interval at which a program's limits are checked; between two checks a program may exceed them.
const CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Bytes that each entry of a folder adds to the size of its contents.
const BYTES_PER_ENTRY: u64 = 1 << 10;

/// Maximum nesting depth of folders.
const MAX_DEPTH: usize = 32;

/// Number of successive checks after which folders that disappear during each of them count as an excess.
const MAX_INCOMPLETE_CHECKS: usize = 100;

/// Result of a check of a folder's size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    Fits,
    Exceeds,
    /// A folder disappeared before it was read.
    Incomplete,
}

/// The scratch folder of a restricted program; removed when dropped.
#[derive(Debug)]
pub struct Scratch {
    quota: Quota,
    /// The folder that contains the scratch folder, to which no program may write.
    _outer: RunFolder,
    limits: Limits,
}

/// Limit on the files in a scratch folder.
#[derive(Debug)]
pub struct Quota {
    folder: PathBuf,
    /// Maximum total size of all files, in bytes.
    max_bytes: u64,
    /// Time of the last check.
    last_check: Mutex<Instant>,
}

impl Quota {
    /// Allows at most `max_bytes` bytes in `folder`.
    pub fn new(folder: PathBuf, max_bytes: u64) -> Self {
        Self { folder, max_bytes, last_check: Mutex::new(Instant::now()) }
    }

    /// Returns true if a check is due: the last check was at least `CHECK_INTERVAL` ago.
    pub fn is_due(&self) -> bool {
        let mut last_check = self.last_check.lock();
        let is_due = last_check.elapsed() >= CHECK_INTERVAL;
        if is_due {
            *last_check = Instant::now();
        }
        is_due
    }

    /// Description of the limit, if the folder exceeds it.
    pub fn excess(&self) -> Option<String> {
        // A program that renames nested folders all the time could hide files from single checks.
        let mut results = std::iter::repeat_with(|| check(&self.folder, self.max_bytes)).take(MAX_INCOMPLETE_CHECKS);
        match results.find(|result| *result != Check::Incomplete) {
            Some(Check::Fits) => None,
            Some(_) => Some(format!(
                "its files exceed the limits of its sandbox: {} MiB, and {MAX_DEPTH} folders within each other",
                self.max_bytes >> 20
            )),
            None => Some("it removes or renames its folders so often that their size cannot be checked".to_owned()),
        }
    }
}

impl Scratch {
    /// Creates the folder in the temporary folder, for a program with these limits.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn new(limits: Limits) -> io::Result<Self> {
        let outer = RunFolder::new()?;
        let folder = outer.path().join("scratch");
        fs::create_dir(&folder)?;
        Ok(Self { quota: Quota::new(folder, limits.scratch), _outer: outer, limits })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.quota.folder
    }

    /// Description of the limit that the process `pid` of the program exceeds; checked at most once per interval.
    pub fn excess(&self, pid: i32) -> Option<String> {
        if !self.quota.is_due() {
            return None;
        }
        if threads_of(pid) > self.limits.processes {
            return Some(format!("it started more than {} threads, the limit of its sandbox", self.limits.processes));
        }
        self.quota.excess()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // Remaining files are removed with the run folder, or at the start of a later run.
        let _ = remove_tree(self.folder());
    }
}

/// Threads of the process `pid`, 0 if it has ended.
fn threads_of(pid: i32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let threads = status.lines().find_map(|line| line.strip_prefix("Threads:"));
    threads.and_then(|threads| threads.trim().parse().ok()).unwrap_or_default()
}

/// Checks whether all files in `folder` together take at most `max_bytes` bytes, and no folders are nested deeper than
/// [`MAX_DEPTH`]. A folder that cannot be read counts as too large.
fn check(folder: &Path, max_bytes: u64) -> Check {
    let mut size = 0;
    let mut is_complete = true;
    let mut folders = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        let entries = match fs::read_dir(folder) {
            Ok(entries) => entries,
            Err(error) if depth > 0 && is_gone(&error) => {
                is_complete = false;
                continue;
            }
            Err(_) => return Check::Exceeds,
        };
        for entry in entries {
            let Ok(entry) = entry else { continue };
            let Ok(metadata) = entry.metadata() else {
                // A file may be removed meanwhile; a folder that was renamed contains further files.
                is_complete &= !entry.file_type().is_ok_and(|kind| kind.is_dir());
                continue;
            };
            size += BYTES_PER_ENTRY + metadata.blocks() * 512;
            if metadata.is_dir() {
                folders.push((entry.path(), depth + 1));
            }
            if size > max_bytes || depth > MAX_DEPTH {
                return Check::Exceeds;
            }
        }
    }
    if is_complete { Check::Fits } else { Check::Incomplete }
}

/// Returns true if a folder cannot be read because it was removed, renamed or replaced by a file.
fn is_gone(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}

/// Removes `folder` with its contents, which may be nested too deep for any path: folders within it are moved up before
/// they are emptied.
fn remove_tree(folder: &Path) -> io::Result<()> {
    let mut moved = 0_u64;
    loop {
        fs::set_permissions(folder, fs::Permissions::from_mode(0o700))?;
        let mut is_empty = true;
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            is_empty = false;
            if !entry.file_type()?.is_dir() {
                fs::remove_file(entry.path())?;
                continue;
            }
            let inner = entry.path();
            fs::set_permissions(&inner, fs::Permissions::from_mode(0o700))?;
            for entry in fs::read_dir(&inner)? {
                let entry = entry?;
                if entry.file_type()?.is_dir() {
                    // Moving a folder requires write permission for it.
                    fs::set_permissions(entry.path(), fs::Permissions::from_mode(0o700))?;
                    moved += 1;
                    fs::rename(entry.path(), folder.join(format!("moved-{}-{moved}", std::process::id())))?;
                } else {
                    fs::remove_file(entry.path())?;
                }
            }
            fs::remove_dir(inner)?;
        }
        if is_empty {
            return fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_and_depth_of_files_and_folders_are_limited() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("scratch");
        fs::create_dir(&folder).unwrap();
        let fits = |max_bytes| check(&folder, max_bytes) == Check::Fits;
        assert!(fits(0));
        fs::write(folder.join("a"), vec![1; 10_000]).unwrap();
        assert!(fits(20_000) && !fits(10_000));
        (0..30).for_each(|number| fs::create_dir(folder.join(format!("d{number}"))).unwrap());
        assert!(!fits(20_000), "empty folders take room as well");
        let deep: PathBuf = std::iter::repeat_n("d", MAX_DEPTH + 3).collect();
        fs::create_dir_all(folder.join(deep)).unwrap();
        assert!(!fits(u64::MAX));
    }

    #[test]
    fn files_below_folders_that_are_renamed_all_the_time_are_found() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("scratch");
        let deep: PathBuf = std::iter::repeat_n("a", 20).collect();
        fs::create_dir_all(folder.join(&deep)).unwrap();
        fs::write(folder.join(&deep).join("large"), vec![1; 100_000]).unwrap();
        let is_done = std::sync::atomic::AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_done.load(std::sync::atomic::Ordering::Relaxed) {
                    let mut path = folder.clone();
                    for _ in 0..20 {
                        fs::rename(path.join("a"), path.join("b")).unwrap();
                        fs::rename(path.join("b"), path.join("a")).unwrap();
                        path.push("a");
                    }
                }
            });
            let quota = Quota::new(folder.clone(), 50_000);
            let is_found = (0..20).all(|_| quota.excess().is_some());
            is_done.store(true, std::sync::atomic::Ordering::Relaxed);
            assert!(is_found);
        });
    }

    #[test]
    fn tree_deeper_than_any_path_is_removed() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("scratch");
        fs::create_dir(&folder).unwrap();
        // 3,000 folders, 500 at a time: a step into each of them would take minutes.
        let script = "long=$(printf 'ddddd/%.0s' $(seq 500)); \
                      for i in 1 2 3 4 5 6; do mkdir -p $long && cd -P $long && echo x > f || exit 1; done; chmod 0 .";
        let made = std::process::Command::new("sh").args(["-c", script]).current_dir(&folder).status().unwrap();
        assert!(made.success());
        remove_tree(&folder).unwrap();
        assert!(!folder.exists());
    }
}
