//! Help for tests with programs of strangers: users as whom they run, and what they must leave as it was.

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

/// An ordinary user without files.
pub const NOBODY: u32 = 65534;

/// Users as whom a test runs: this one and, if it is root, an ordinary one.
///
/// # Panics
/// If there is no `/proc`.
pub fn users() -> Vec<Option<u32>> {
    let own = std::fs::metadata("/proc/self").expect("/proc").uid();
    if own == 0 { vec![None, Some(NOBODY)] } else { vec![None] }
}

/// Gives `path` with everything below it to `user`.
///
/// # Panics
/// If this user may not.
pub fn chown_all(path: &Path, user: u32) {
    std::os::unix::fs::lchown(path, Some(user), Some(user)).expect("root gives files away");
    if path.is_dir() && !path.is_symlink() {
        std::fs::read_dir(path).expect("a folder").for_each(|entry| chown_all(&entry.expect("an entry").path(), user));
    }
}

/// Every file below `path` with what a program could change of it, a line each.
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

/// Processes whose binary or working folder lies in `folder`.
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
