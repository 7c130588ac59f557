//! Several files in one input: a text with a line `-- PATH --` before each file, as in Go's txtar format.

use std::collections::BTreeMap;

use sim_format::{FileError, Files};

/// Folder of the simulated installation.
const HOME: &str = "/home/eyesim";

/// The files of an archive, as a file system.
#[derive(Clone, Debug, Default)]
pub struct Archive {
    files: BTreeMap<String, Vec<u8>>,
    first: String,
}

impl Archive {
    /// Splits `bytes` into files; text before the first header becomes a file named `input`.
    pub fn new(bytes: &[u8]) -> Self {
        let mut archive = Self { files: BTreeMap::new(), first: String::new() };
        let mut path = "input".to_owned();
        let mut file: Vec<u8> = Vec::new();
        let mut has_header = false;
        for line in bytes.split_inclusive(|byte| *byte == b'\n') {
            match header(line) {
                Some(next) => {
                    if has_header || !file.is_empty() {
                        archive.insert(path, std::mem::take(&mut file));
                    }
                    path = next.to_owned();
                    has_header = true;
                }
                None => file.extend_from_slice(line),
            }
        }
        archive.insert(path, file);
        archive
    }

    /// Path of the first file.
    pub fn first(&self) -> &str {
        &self.first
    }

    /// Content of a file.
    pub fn bytes(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(Vec::as_slice)
    }

    fn insert(&mut self, path: String, file: Vec<u8>) {
        if self.files.is_empty() {
            self.first.clone_from(&path);
        }
        self.files.insert(path, file);
    }
}

impl Files for Archive {
    /// Simulates unreadable files: those whose name begins with `locked` exist but cannot be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        match self.files.get(path) {
            Some(_) if path.starts_with("locked") => Err(FileError::Unreadable("permission denied".to_owned())),
            Some(bytes) => Ok(bytes.clone()),
            None => Err(FileError::Missing),
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let prefix = match folder {
            "" | "/" => folder.to_owned(),
            folder => format!("{folder}/"),
        };
        let below = self.files.keys().filter_map(|path| path.strip_prefix(&prefix));
        let mut names: Vec<String> = below.map(|rest| rest.split('/').next().unwrap_or_default().to_owned()).collect();
        names.dedup();
        names
    }

    fn home(&self) -> Option<&str> {
        Some(HOME)
    }
}

fn header(line: &[u8]) -> Option<&str> {
    let line = std::str::from_utf8(line).ok()?.trim_end_matches(['\n', '\r']);
    let path = line.strip_prefix("-- ")?.strip_suffix(" --")?;
    (!path.trim().is_empty()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_archive_is_split_into_its_files() {
        let archive = Archive::new(b"-- a/b.sim --\nworld w.wld\r\n-- a/w.wld --\r\n-- a/c --\nx");
        assert_eq!((archive.first(), archive.list("a")), ("a/b.sim", vec!["b.sim".into(), "c".into(), "w.wld".into()]));
        assert_eq!(archive.bytes("a/b.sim"), Some(&b"world w.wld\r\n"[..]));
        assert_eq!((archive.bytes("a/w.wld"), archive.bytes("a/c")), (Some(&b""[..]), Some(&b"x"[..])));
        assert_eq!(Archive::new(b"world w.wld").first(), "input");
    }
}
