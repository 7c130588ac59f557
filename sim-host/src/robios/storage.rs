//! Files outside the simulation that the RoBIOS calls of a robot read and write.
//!
//! A name is relative to the working folder of the run; a file that does not exist there is searched for in the folder
//! of the scene. A robot sees its own writes immediately; other robots see them from the next slot on, in the order
//! (virtual time, robot), so that a run does not depend on execution order. Files that other programs change during a
//! run are outside this guarantee.
//!
//! The calls of a sandboxed program read only files in its own folder and in the scene's folder; written files stay in
//! memory.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::os::unix::ffi::OsStrExt;
use std::path::{Component, Path, PathBuf};

use sim_core::time::Time;

use crate::program::sandbox::files::open_beneath;

/// Maximum size of a file that is read: larger files are not images or sounds.
const MAX_BYTES: u64 = 256 << 20;

/// Message for a program that did not find the file `name`; contains the folder that was searched.
pub fn missing_file(name: Option<&str>) -> String {
    let folder = std::env::current_dir().unwrap_or_default();
    match name {
        Some(name) if Path::new(name).is_absolute() => match Path::new(name).parent() {
            Some(parent) if !parent.exists() => format!("there is no folder `{}`", parent.display()),
            _ => format!("there is no file `{name}`"),
        },
        Some(name) => format!("there is no file `{name}` in `{}`, the folder in which eyesim runs", folder.display()),
        None => format!(
            "a file is missing: file names are relative to `{}`, the folder in which eyesim runs",
            folder.display()
        ),
    }
}

/// Files of one robot.
#[derive(Clone, Debug, Default)]
pub struct Storage {
    scene_folder: PathBuf,
    /// In a sandbox, the folder of the program and the files written.
    confined: Option<Confined>,
    /// Files written in the current slot.
    pending_writes: BTreeMap<PathBuf, (Time, Vec<u8>)>,
    /// Reason of the C library's last failure to open a file.
    open_failure: Option<String>,
}

/// Files of a robot whose program is in a sandbox.
#[derive(Clone, Debug, Default)]
struct Confined {
    program_folder: Option<PathBuf>,
    /// Written files, which exist only for this robot.
    written: BTreeMap<PathBuf, Vec<u8>>,
}

/// Maximum total size in bytes of files that a robot in a sandbox may write; our choice.
const MAX_WRITTEN: usize = 64 << 20;

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
        Self { scene_folder: scene_folder.to_owned(), ..Self::default() }
    }

    /// Files of a robot in a sandbox, whose program is in `program_folder`.
    pub fn confined(scene_folder: &Path, program_folder: Option<PathBuf>) -> Self {
        let confined = Some(Confined { program_folder, ..Confined::default() });
        Self { confined, ..Self::new(scene_folder) }
    }

    /// Reads the file called `name`.
    ///
    /// # Errors
    /// Errors of the system for `name` in the working folder; for a missing file the message names the searched folders.
    pub fn read(&self, name: &[u8]) -> io::Result<Vec<u8>> {
        let path = path_of(name);
        if let Some(confined) = &self.confined {
            return confined.read(&path, &self.scene_folder);
        }
        let path_in_scene_folder = self.scene_folder.join(&path);
        for path in [&path, &path_in_scene_folder] {
            if let Some((_, bytes)) = self.pending_writes.get(path) {
                return Ok(bytes.clone());
            }
            if path.is_file() {
                return read_file(path);
            }
        }
        read_file(if path.as_os_str().is_empty() { Path::new(".") } else { &path }).map_err(|error| {
            match error.kind() {
                io::ErrorKind::NotFound => io::Error::new(error.kind(), self.searched_folders(&path)),
                _ => error,
            }
        })
    }

    /// Message for a file that [`Self::read`] did not find.
    fn searched_folders(&self, path: &Path) -> String {
        let folder = std::env::current_dir().unwrap_or_default();
        let scene_folder = folder.join(&self.scene_folder);
        if path.is_absolute() {
            "there is no such file".to_owned()
        } else if scene_folder == folder {
            format!("there is no such file in `{}`, the folder in which eyesim runs", folder.display())
        } else {
            format!(
                "there is no such file in `{}`, the folder in which eyesim runs, or in the scene's folder `{}`",
                folder.display(),
                scene_folder.display()
            )
        }
    }

    /// Stores a file, which is written in the working folder when the slot ends; in a sandbox it stays in memory.
    ///
    /// # Errors
    /// If the parent folder does not exist, or a folder has this name. In a sandbox: if the path is absolute, contains
    /// `..` or has no file name, or if the files exceed `MAX_WRITTEN`.
    pub fn write(&mut self, now: Time, name: &[u8], bytes: Vec<u8>) -> io::Result<()> {
        let path = path_of(name);
        if let Some(confined) = &mut self.confined {
            return confined.write(path, bytes);
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if path.file_name().is_none() || path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if !folder.is_dir() {
            let folder = folder.display();
            return Err(io::Error::new(io::ErrorKind::NotFound, format!("there is no folder `{folder}`")));
        }
        self.pending_writes.insert(path, (now, bytes));
        Ok(())
    }

    /// Records that the C library could not open the file `name`; `error` is the system's error number.
    pub fn note_open_failure(&mut self, name: &str, error: i32) {
        let error = io::Error::from_raw_os_error(error);
        self.open_failure = Some(match error.kind() {
            io::ErrorKind::NotFound => missing_file(Some(name)),
            _ => format!("`{name}`: {error}"),
        });
    }

    /// Reason of the C library's last failure to open a file.
    pub fn open_failure(&self) -> Option<&str> {
        self.open_failure.as_deref()
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

impl Confined {
    fn read(&self, path: &Path, scene_folder: &Path) -> io::Result<Vec<u8>> {
        if let Some(bytes) = self.written.get(path) {
            return Ok(bytes.clone());
        }
        let mut result = Err(io::ErrorKind::NotFound.into());
        for folder in self.program_folder.iter().map(PathBuf::as_path).chain([scene_folder]) {
            result = open_beneath(folder, path).and_then(read_open);
            if result.is_ok() {
                break;
            }
        }
        result
    }

    fn write(&mut self, path: PathBuf, bytes: Vec<u8>) -> io::Result<()> {
        let is_plain = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !is_plain || path.file_name().is_none() {
            return Err(io::ErrorKind::PermissionDenied.into());
        }
        let other_sizes = self.written.iter().filter(|(other, _)| **other != path).map(|(_, bytes)| bytes.len());
        if other_sizes.sum::<usize>() + bytes.len() > MAX_WRITTEN {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.written.insert(path, bytes);
        Ok(())
    }
}

impl PendingWrite {
    /// Writes the file to the disk.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn save(&self) -> io::Result<()> {
        fs::write(&self.path, &self.bytes)
    }
}

/// Path for a name in a program: bytes, with slashes or backslashes. `./a` and `a` have the same path.
fn path_of(name: &[u8]) -> PathBuf {
    let slashed: Vec<u8> = name.iter().map(|byte| if *byte == b'\\' { b'/' } else { *byte }).collect();
    Path::new(OsStr::from_bytes(&slashed)).components().filter(|part| *part != Component::CurDir).collect()
}

fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    // Opening a pipe might block forever.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a file"));
    }
    read_open(File::open(path)?)
}

fn read_open(mut file: File) -> io::Result<Vec<u8>> {
    let metadata = file.metadata()?;
    // Reading a pipe or a terminal might never end.
    if !metadata.is_file() {
        return Err(io::Error::other("it is not a file"));
    }
    if metadata.len() > MAX_BYTES {
        return Err(io::Error::other(format!("it is larger than {} MiB", MAX_BYTES >> 20)));
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(path: &Path) -> &[u8] {
        path.as_os_str().as_bytes()
    }

    #[test]
    fn a_robot_in_a_sandbox_reads_its_program_folder_and_writes_to_memory() {
        let folder = tempfile::tempdir().unwrap();
        let program_folder = folder.path().join("own");
        fs::create_dir_all(program_folder.join("images")).unwrap();
        fs::write(folder.path().join("secret"), "s").unwrap();
        fs::write(program_folder.join("images/a.pgm"), "a").unwrap();
        std::os::unix::fs::symlink("../secret", program_folder.join("link")).unwrap();
        let mut storage = Storage::confined(Path::new("/nowhere"), Some(program_folder.clone()));
        assert_eq!(storage.read(b"images\\a.pgm").unwrap(), b"a");
        let secret = folder.path().join("secret");
        let outside: [&[u8]; 5] = [b"../secret", b"link", name(&secret), b"/etc/passwd", b"/proc/self/environ"];
        for outside in outside {
            assert!(storage.read(outside).is_err(), "{}", String::from_utf8_lossy(outside));
        }
        storage.write(Time::ZERO, b"./b.pgm", b"b".to_vec()).unwrap();
        assert_eq!(storage.read(b"b.pgm").unwrap(), b"b");
        assert!(!storage.has_pending_writes() && !program_folder.join("b.pgm").exists());
        assert!(storage.write(Time::ZERO, b"../secret", Vec::new()).is_err());
        assert!(storage.write(Time::ZERO, name(&secret), Vec::new()).is_err());
        assert!(storage.write(Time::ZERO, b"c", vec![0; MAX_WRITTEN]).is_err(), "one byte is taken");
        storage.write(Time::ZERO, b"b.pgm", vec![0; MAX_WRITTEN]).unwrap();
    }

    #[test]
    fn written_files_are_read_back_and_saved_when_the_slot_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pgm");
        let mut storage = Storage::default();
        storage.write(Time(5), name(&path), b"one".to_vec()).unwrap();
        let same_path = folder.path().join("./a.pgm");
        storage.write(Time(7), name(&same_path), b"two".to_vec()).unwrap();
        assert_eq!(storage.read(name(&path)).unwrap(), b"two");
        assert!(Storage::default().read(name(&path)).is_err(), "another robot does not see it yet");
        let written: Vec<PendingWrite> = storage.take_pending_writes().collect();
        assert_eq!(written, [PendingWrite { at: Time(7), path: path.clone(), bytes: b"two".to_vec() }]);
        written[0].save().unwrap();
        assert_eq!(Storage::default().read(name(&path)).unwrap(), b"two");
    }

    #[test]
    fn files_in_the_folder_of_the_scene_are_found() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("images")).unwrap();
        fs::write(folder.path().join("images/a.pgm"), "x").unwrap();
        let storage = Storage::new(folder.path());
        assert_eq!(storage.read(b"images\\a.pgm").unwrap(), b"x");
        assert_eq!(storage.read(b"b.pgm").unwrap_err().kind(), io::ErrorKind::NotFound);
        assert!(storage.read(b"images").is_err() && storage.read(b"").is_err() && storage.read(b"a\0b").is_err());
    }

    #[test]
    fn writing_to_an_invalid_path_fails() {
        let folder = tempfile::tempdir().unwrap();
        let mut storage = Storage::default();
        for path in [folder.path().join("none/a.pgm"), folder.path().to_owned(), PathBuf::new(), "..".into()] {
            assert!(storage.write(Time(0), name(&path), Vec::new()).is_err(), "{}", path.display());
        }
        let missing = storage.write(Time(0), name(&folder.path().join("none/a.pgm")), Vec::new());
        assert_eq!(missing.unwrap_err().kind(), io::ErrorKind::NotFound);
    }
}
