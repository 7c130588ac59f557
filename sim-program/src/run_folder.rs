//! Temporary folders of runs: each is locked by its process, and folders of killed processes are removed at the next
//! start.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Prefix of the folders' names.
const PREFIX: &str = "eyesim-run-";

/// Name of the file in each folder that the folder's process has locked.
const LOCK: &str = "lock";

/// A folder of this process in the temporary folder; removed when dropped.
#[derive(Debug)]
pub struct RunFolder {
    folder: tempfile::TempDir,
    /// Locked until the folder is dropped or the process ends.
    _lock: File,
}

impl RunFolder {
    /// Creates a folder, and removes the folders of this user whose processes have been killed.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn new() -> io::Result<Self> {
        Self::new_in(&std::env::temp_dir())
    }

    /// Removes the folders of this user whose processes have been killed.
    pub fn remove_abandoned() {
        remove_abandoned_in(&std::env::temp_dir());
    }

    fn new_in(parent: &Path) -> io::Result<Self> {
        remove_abandoned_in(parent);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(parent)?;
        // The file gets its name once it is locked: without that name no process mistakes the folder for an abandoned
        // one.
        let unnamed = folder.path().join("new-lock");
        let lock = File::create(&unnamed)?;
        lock.lock()?;
        fs::rename(unnamed, folder.path().join(LOCK))?;
        Ok(Self { folder, _lock: lock })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes the folders of runs in `parent` that no process has locked. Folders of other users cannot be opened and
/// remain.
fn remove_abandoned_in(parent: &Path) {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    let run_folders = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(PREFIX));
    for folder in run_folders.map(|entry| entry.path()).filter(is_abandoned) {
        // Another process may remove it at the same time.
        let _ = fs::remove_dir_all(folder);
    }
}

fn is_abandoned(folder: &PathBuf) -> bool {
    let is_folder = fs::symlink_metadata(folder).is_ok_and(|metadata| metadata.is_dir());
    let lock = File::options().write(true).open(folder.join(LOCK));
    is_folder && lock.is_ok_and(|lock| lock.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_folders_of_killed_processes_are_removed() {
        let parent = tempfile::tempdir().unwrap();
        let living = RunFolder::new_in(parent.path()).unwrap();
        for (name, has_lock) in [("eyesim-run-dead", true), ("eyesim-run-young", false), ("other-dead", true)] {
            fs::create_dir(parent.path().join(name)).unwrap();
            fs::write(parent.path().join(name).join("maze-1.so"), "x").unwrap();
            if has_lock {
                fs::write(parent.path().join(name).join(LOCK), "").unwrap();
            }
        }
        let own = RunFolder::new_in(parent.path()).unwrap();
        assert!(living.path().exists() && own.path().exists());
        assert!(!parent.path().join("eyesim-run-dead").exists());
        assert!(parent.path().join("eyesim-run-young").exists() && parent.path().join("other-dead").exists());
        let path = own.path().to_owned();
        drop(own);
        assert!(!path.exists());
    }
}
