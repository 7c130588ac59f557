//! Files of a record whose completeness is verified at the end of a run.

use std::fs::{self, File, Metadata};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use parking_lot::Mutex;

/// A file that hashes and counts the bytes written to it.
pub struct RecordFile {
    file: File,
    expected_file: Arc<ExpectedFile>,
}

/// Identity and expected contents of a file, to check its completeness at the end of the run.
pub struct ExpectedFile {
    path: PathBuf,
    /// Device and inode; `None` if the file is not a regular one (for example a pipe) and cannot be checked.
    identity: Option<(u64, u64)>,
    written: AtomicU64,
    /// Hash of the written bytes.
    content: Mutex<blake3::Hasher>,
}

impl RecordFile {
    /// Creates the file at `path`, or empties it. All writes append, so that a file that is truncated during the run is
    /// too short at the end.
    ///
    /// # Errors
    /// The file cannot be created or emptied.
    pub fn create(path: &Path) -> io::Result<Self> {
        let file = File::options().append(true).create(true).open(path)?;
        let metadata = file.metadata()?;
        let is_regular = metadata.is_file();
        if is_regular {
            file.set_len(0)?;
        }
        let identity = (is_regular && !path.starts_with("/dev")).then(|| identity(&metadata));
        let (written, content) = (AtomicU64::new(0), Mutex::default());
        Ok(Self { file, expected_file: Arc::new(ExpectedFile { path: path.to_owned(), identity, written, content }) })
    }

    /// The expected contents, which must be checked after everything is written.
    pub fn expected_file(&self) -> Arc<ExpectedFile> {
        Arc::clone(&self.expected_file)
    }
}

impl ExpectedFile {
    /// Checks that the file at the path is still this file and contains exactly the written bytes.
    ///
    /// # Errors
    /// The file is missing, was replaced, or has other contents.
    pub fn check(&self) -> io::Result<()> {
        let Some(expected) = self.identity else { return Ok(()) };
        let written = self.written.load(Ordering::Relaxed);
        let lost = |what: String| io::Error::other(format!("it is not complete: {what} during the run"));
        match fs::metadata(&self.path) {
            Ok(metadata) if identity(&metadata) != expected => {
                Err(lost("another file was put in its place".to_owned()))
            }
            Ok(metadata) if metadata.len() != written => {
                let length = metadata.len();
                Err(lost(format!(
                    "{written} bytes were written, and it has {length}: it was changed, or its descriptor was,"
                )))
            }
            Ok(_) => {
                let mut content = blake3::Hasher::new();
                content.update_reader(File::open(&self.path)?)?;
                match content.finalize() == self.content.lock().finalize() {
                    true => Ok(()),
                    false => Err(lost("its content was changed".to_owned())),
                }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Err(lost("it was deleted".to_owned())),
            Err(error) => Err(error),
        }
    }
}

fn identity(metadata: &Metadata) -> (u64, u64) {
    (metadata.dev(), metadata.ino())
}

impl Write for RecordFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.expected_file.written.fetch_add(count as u64, Ordering::Relaxed);
        if self.expected_file.identity.is_some() {
            self.expected_file.content.lock().update(&bytes[..count]);
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for RecordFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result of the check for a file of five bytes after `damage`.
    fn check_after(damage: impl FnOnce(&Path)) -> Result<(), String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t");
        fs::write(&path, "older than the run").unwrap();
        let mut file = RecordFile::create(&path).unwrap();
        file.write_all(b"abc").unwrap();
        damage(&path);
        // A descriptor that a program has closed cannot be tried here: the process would lose another file.
        file.write_all(b"de").unwrap();
        file.expected_file().check().map_err(|error| error.to_string())
    }

    #[test]
    fn damaged_file_gives_an_error() {
        assert_eq!(check_after(|_| ()), Ok(()));
        assert!(check_after(|path| fs::remove_file(path).unwrap()).unwrap_err().contains("deleted"));
        let cut = check_after(|path| File::options().write(true).open(path).unwrap().set_len(0).unwrap());
        assert!(cut.unwrap_err().contains("5 bytes were written, and it has 2"));
        let changed = check_after(|path| fs::write(path, "abx").unwrap());
        assert!(changed.unwrap_err().contains("its content was changed"));
        let replaced = check_after(|path| {
            fs::write(path.with_extension("new"), "abcde").unwrap();
            fs::rename(path.with_extension("new"), path).unwrap();
        });
        assert!(replaced.unwrap_err().contains("another file"));
    }

    #[test]
    fn device_is_not_checked() {
        let mut file = RecordFile::create(Path::new("/dev/null")).unwrap();
        file.write_all(b"abc").unwrap();
        file.expected_file().check().unwrap();
    }
}
