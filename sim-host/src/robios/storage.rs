//! Files of a robot that its RoBIOS calls read and write outside the simulation.
//!
//! A name is relative to the working folder of the run; a file that is not there is looked for in the folder of the
//! scene. A robot reads its own writes at once; other robots see them from the next slot on, in the order (virtual
//! time, robot), so that a run does not depend on execution order. Files that other programs change during a run are
//! outside this guarantee.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use sim_core::time::Time;

/// Largest file that is read: larger ones are no images or sounds.
const MAX_BYTES: u64 = 256 << 20;

/// Files of one robot.
#[derive(Clone, Debug, Default)]
pub struct Storage {
    scene_folder: PathBuf,
    /// Files written in the present slot.
    pending_writes: BTreeMap<PathBuf, (Time, Vec<u8>)>,
}

/// A file that a robot wrote in a slot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PendingWrite {
    /// Virtual time of the write.
    pub at: Time,
    /// Path of the file.
    pub path: PathBuf,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

impl Storage {
    /// Files of a robot in a scene that is in `scene_folder`.
    pub fn new(scene_folder: &Path) -> Self {
        Self { scene_folder: scene_folder.to_owned(), pending_writes: BTreeMap::new() }
    }

    /// Reads the file called `name`.
    ///
    /// # Errors
    /// Those of the system for `name` in the working folder.
    pub fn read(&self, name: &[u8]) -> io::Result<Vec<u8>> {
        let path = path_of(name);
        let beside_scene = self.scene_folder.join(&path);
        for path in [&path, &beside_scene] {
            if let Some((_, bytes)) = self.pending_writes.get(path) {
                return Ok(bytes.clone());
            }
            if path.is_file() {
                return read_file(path);
            }
        }
        read_file(&path)
    }

    /// Stores a file to be written in the working folder when the slot ends.
    ///
    /// # Errors
    /// If the parent folder does not exist, or a folder has this name.
    pub fn write(&mut self, now: Time, name: &[u8], bytes: Vec<u8>) -> io::Result<()> {
        let path = path_of(name);
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if path.file_name().is_none() || path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if !folder.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        self.pending_writes.insert(path, (now, bytes));
        Ok(())
    }

    /// Returns true if files were written in the slot that ends.
    pub fn has_pending_writes(&self) -> bool {
        !self.pending_writes.is_empty()
    }

    /// Takes the files written in the slot that ends.
    pub fn take_pending_writes(&mut self) -> impl Iterator<Item = PendingWrite> + use<> {
        let written = std::mem::take(&mut self.pending_writes);
        written.into_iter().map(|(path, (at, bytes))| PendingWrite { at, path, bytes })
    }
}

impl PendingWrite {
    /// Writes the file to the disk.
    ///
    /// # Errors
    /// Those of the system.
    pub fn save(&self) -> io::Result<()> {
        fs::write(&self.path, &self.bytes)
    }
}

/// Path of a name as programs write it: bytes, with either slash.
fn path_of(name: &[u8]) -> PathBuf {
    let slashed: Vec<u8> = name.iter().map(|byte| if *byte == b'\\' { b'/' } else { *byte }).collect();
    PathBuf::from(OsStr::from_bytes(&slashed))
}

fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    // Reading a pipe or a terminal might never end.
    if !metadata.is_file() {
        return Err(io::Error::other("it is not a file"));
    }
    if metadata.len() > MAX_BYTES {
        return Err(io::Error::other(format!("it is larger than {} MiB", MAX_BYTES >> 20)));
    }
    fs::read(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(path: &Path) -> &[u8] {
        path.as_os_str().as_bytes()
    }

    #[test]
    fn what_is_written_is_read_back_and_saved_at_the_slots_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pgm");
        let mut storage = Storage::default();
        storage.write(Time(5), name(&path), b"one".to_vec()).unwrap();
        storage.write(Time(7), name(&path), b"two".to_vec()).unwrap();
        assert_eq!(storage.read(name(&path)).unwrap(), b"two");
        assert!(Storage::default().read(name(&path)).is_err(), "another robot does not see it yet");
        let written: Vec<PendingWrite> = storage.take_pending_writes().collect();
        assert_eq!(written, [PendingWrite { at: Time(7), path: path.clone(), bytes: b"two".to_vec() }]);
        written[0].save().unwrap();
        assert_eq!(Storage::default().read(name(&path)).unwrap(), b"two");
    }

    #[test]
    fn files_beside_the_scene_are_found() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("images")).unwrap();
        fs::write(folder.path().join("images/a.pgm"), "x").unwrap();
        let storage = Storage::new(folder.path());
        assert_eq!(storage.read(b"images\\a.pgm").unwrap(), b"x");
        assert_eq!(storage.read(b"b.pgm").unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(storage.read(b"images").is_err() && storage.read(b"").is_err() && storage.read(b"a\0b").is_err());
    }

    #[test]
    fn places_that_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut storage = Storage::default();
        for path in [folder.path().join("none/a.pgm"), folder.path().to_owned(), PathBuf::new(), "..".into()] {
            assert!(storage.write(Time(0), name(&path), Vec::new()).is_err(), "{}", path.display());
        }
    }
}
