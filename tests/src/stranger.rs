//! Helpers for tests with untrusted programs: the users that run them, and the files and processes that must remain
//! unchanged.

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// An ordinary user without files.
pub const NOBODY: u32 = 65534;

/// Users that run a test: the current user and, if that is root, also an ordinary user.
///
/// # Panics
/// If there is no `/proc`.
pub fn users() -> Vec<Option<u32>> {
    let own = std::fs::metadata("/proc/self").expect("/proc").uid();
    if own == 0 { vec![None, Some(NOBODY)] } else { vec![None] }
}

/// Makes `user` the owner of `path` and of everything below it.
///
/// # Panics
/// If the current user has no permission to do this.
pub fn chown_all(path: &Path, user: u32) {
    std::os::unix::fs::lchown(path, Some(user), Some(user)).expect("root gives files away");
    if path.is_dir() && !path.is_symlink() {
        std::fs::read_dir(path).expect("a folder").for_each(|entry| chown_all(&entry.expect("an entry").path(), user));
    }
}

/// `path` and every file and folder below it, one line each: mode, owner, time of modification and content.
///
/// # Panics
/// If a file cannot be read.
pub fn listing(path: &Path) -> Vec<String> {
    let mut lines = Vec::new();
    list(path, &mut lines);
    lines
}

fn list(path: &Path, lines: &mut Vec<String>) {
    let file = path.symlink_metadata().expect("a file");
    let content = if file.is_file() { std::fs::read(path).expect("a file") } else { Vec::new() };
    let times = (file.mtime(), file.mtime_nsec());
    lines.push(format!("{} {:o} {} {times:?} {content:?}", path.display(), file.mode(), file.uid()));
    if file.is_dir() {
        let mut entries: Vec<PathBuf> =
            std::fs::read_dir(path).expect("a folder").map(|entry| entry.expect("one").path()).collect();
        entries.sort();
        entries.iter().for_each(|entry| list(entry, lines));
    }
}

/// Processes whose binary or working folder is in `folder`.
///
/// # Panics
/// If there is no `/proc`.
pub fn processes_in(folder: &Path) -> Vec<String> {
    let folder = folder.to_string_lossy();
    let processes = std::fs::read_dir("/proc").expect("/proc").flatten().map(|entry| entry.path());
    let is_of_folder = |process: &PathBuf| {
        let link = |name: &str| {
            std::fs::read_link(process.join(name)).is_ok_and(|path| path.to_string_lossy().contains(&*folder))
        };
        process.join("stat").exists() && (link("exe") || link("cwd"))
    };
    processes.filter(is_of_folder).map(|process| process.display().to_string()).collect()
}
