//! Archives: a scene or a suite in one file, with everything that its runs read.
//!
//! An archive is a zip file with `eyesim-pack.json`, the [`Manifest`], and the folder `files`. [`Pack::read`] refuses
//! archives with other entries, with too many entries, or with too large files.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sim_host::files::slashed;
use sim_host::launch::UnpackedArchive;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Name of the manifest in the archive.
const MANIFEST: &str = "eyesim-pack.json";
/// Folder of the files in the archive.
const FILES: &str = "files/";
/// Version of the manifest.
const SCHEMA: u32 = 1;
/// Maximum number of entries of an archive.
const MAX_ENTRIES: usize = 10_000;
/// Maximum total size of all files, in bytes.
const MAX_BYTES: u64 = 512 << 20;
/// Maximum length of the name of an entry, in bytes.
const MAX_NAME: usize = 1024;

/// Table of contents of an archive.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of the manifest.
    pub schema: u32,
    /// Version of eyesim that wrote the archive.
    pub eyesim_version: String,
    /// Path of the scene or suite.
    pub main: String,
    /// Folder that replaces the installation (`%sim%`), if the archive contains files of it.
    pub home: Option<String>,
    /// Seed, instead of the scene's.
    pub seed: Option<u64>,
    /// Programs, instead of the scene's: the beginning of the option `--program`, such as `1=`, and the path of a file
    /// or a folder, or several paths with commas between them.
    pub programs: Vec<(String, String)>,
    /// Files that options of a run name: the value of `--noise` or `--stdin`, and the path of the file in the archive.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub options: BTreeMap<String, String>,
}

/// An archive: its manifest, and its files by their paths with slashes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pack {
    /// Table of contents.
    pub manifest: Manifest,
    /// Contents of the files.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// Reasons why an archive is refused.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file is not a zip file, or is broken.
    #[error("it is not a readable archive: {0}")]
    Zip(#[from] ZipError),
    /// The archive has no manifest.
    #[error("it was not written by `eyesim pack`: it has no `{MANIFEST}`")]
    NoManifest,
    /// The manifest cannot be read.
    #[error("`{MANIFEST}` cannot be read: {0}")]
    Manifest(#[from] serde_json::Error),
    /// The manifest has another version.
    #[error("it was written by eyesim {version}, whose archives this eyesim cannot read")]
    Schema {
        /// Version of eyesim that wrote it.
        version: String,
    },
    /// An entry would be written outside of the folder, or is not a plain file.
    #[error("the entry `{name}` {what}")]
    Entry {
        /// Name of the entry, with unprintable characters escaped.
        name: String,
        /// The mistake in the entry.
        what: &'static str,
    },
    /// Two entries have the same name.
    #[error("two of its entries have the same name")]
    Twice,
    /// There are too many entries.
    #[error("it has {0} entries, at most {MAX_ENTRIES} are read")]
    Entries(usize),
    /// The total size of the files is too large.
    #[error("its files have more than {} MiB", MAX_BYTES >> 20)]
    Size,
    /// A file that the manifest names is missing.
    #[error("`{0}`, which the manifest names, is not in it")]
    Missing(String),
}

/// An unpacked archive; its files are removed when it is dropped.
#[derive(Debug)]
pub struct Unpacked {
    folder: tempfile::TempDir,
    manifest: Manifest,
}

impl Manifest {
    /// The manifest of this version of eyesim for the scene or suite `main`.
    pub fn new(main: String) -> Self {
        let eyesim_version = env!("CARGO_PKG_VERSION").to_owned();
        let options = BTreeMap::new();
        Self { schema: SCHEMA, eyesim_version, main, home: None, seed: None, programs: Vec::new(), options }
    }
}

impl Pack {
    /// Bytes of the archive; equal contents give equal bytes.
    ///
    /// # Errors
    /// [`read`](Self::read) would refuse the archive: there are too many files, they are too large, or one has a name
    /// that leads elsewhere.
    pub fn to_bytes(&self) -> Result<Vec<u8>, PackError> {
        let manifest = serde_json::to_vec_pretty(&self.manifest)?;
        // The manifest is an entry too.
        if self.files.len() >= MAX_ENTRIES {
            return Err(PackError::Entries(self.files.len() + 1));
        }
        if manifest.len() as u64 + self.files.values().map(|bytes| bytes.len() as u64).sum::<u64>() > MAX_BYTES {
            return Err(PackError::Size);
        }
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default());
        writer.start_file(MANIFEST, options)?;
        writer.write_all(&manifest)?;
        for (name, bytes) in &self.files {
            check_path(name)?;
            writer.start_file(format!("{FILES}{name}"), options)?;
            writer.write_all(bytes)?;
        }
        Ok(writer.finish()?.into_inner())
    }

    /// Reads an archive.
    ///
    /// # Errors
    /// [`PackError`]; no part of such an archive is used.
    pub fn read(bytes: &[u8]) -> Result<Self, PackError> {
        let mut archive = ZipArchive::new(Cursor::new(bytes))?;
        if archive.len() > MAX_ENTRIES {
            return Err(PackError::Entries(archive.len()));
        }
        // The reader keeps the last of several entries with the same name.
        if entry_count(bytes).is_some_and(|count| count != archive.len()) {
            return Err(PackError::Twice);
        }
        let (mut manifest, mut files, mut remaining) = (None, BTreeMap::new(), MAX_BYTES);
        for index in 0..archive.len() {
            let mut file = archive.by_index(index)?;
            let name = file.name().to_owned();
            if file.is_symlink()
                || file.unix_mode().is_some_and(|mode| !matches!(mode & 0o170_000, 0 | 0o100_000 | 0o040_000))
            {
                return Err(entry_error(&name, "is a link or a device, which an eyesim archive cannot contain"));
            }
            let path = if name == MANIFEST { None } else { Some(path_of(&name)?) };
            if file.is_dir() {
                continue;
            }
            let mut content = Vec::new();
            let read = file.by_ref().take(remaining + 1).read_to_end(&mut content)? as u64;
            remaining = remaining.checked_sub(read).ok_or(PackError::Size)?;
            match path {
                None => manifest = Some(serde_json::from_slice::<Manifest>(&content)?),
                Some(path) => {
                    if files.insert(path, content).is_some() {
                        return Err(PackError::Twice);
                    }
                }
            }
        }
        let manifest = manifest.ok_or(PackError::NoManifest)?;
        if manifest.schema != SCHEMA {
            return Err(PackError::Schema { version: manifest.eyesim_version });
        }
        if !files.contains_key(&manifest.main) {
            return Err(PackError::Missing(manifest.main));
        }
        // A program is a file, a folder, or several files.
        let exists = |path: &str| {
            let folder = format!("{path}/");
            files.contains_key(path) || check_path(path).is_ok() && files.keys().any(|file| file.starts_with(&folder))
        };
        let mut program_paths = manifest.programs.iter().map(|(_, path)| path);
        if let Some(missing) = program_paths.find(|path| !exists(path) && !path.split(',').all(exists)) {
            return Err(PackError::Missing(missing.clone()));
        }
        if let Some(missing) = manifest.options.values().find(|path| !files.contains_key(*path)) {
            return Err(PackError::Missing(missing.clone()));
        }
        manifest.home.as_deref().filter(|home| !home.is_empty()).map_or(Ok(()), check_path)?;
        // A file at the path of a folder would otherwise be noticed only when the files are written.
        for path in files.keys() {
            let mut rest = path.as_str();
            while let Some((folder, _)) = rest.rsplit_once('/') {
                if files.contains_key(folder) {
                    return Err(entry_error(folder, "is a file and a folder"));
                }
                rest = folder;
            }
        }
        Ok(Self { manifest, files })
    }

    /// Writes the files into a new temporary folder.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn unpack(self) -> io::Result<Unpacked> {
        let folder = tempfile::Builder::new().prefix("eyesim-pack-").tempdir()?;
        for (name, bytes) in &self.files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap_or(folder.path()))?;
            fs::write(path, bytes)?;
        }
        Ok(Unpacked { folder, manifest: self.manifest })
    }
}

impl Unpacked {
    /// Table of contents.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Path of a file of the archive.
    pub fn path_of(&self, path: &str) -> PathBuf {
        self.folder.path().join(path)
    }

    /// Path of the file of the archive to which the option value `given` refers, if there is one.
    pub fn option(&self, given: &str) -> Option<PathBuf> {
        self.manifest.options.get(given).map(|path| self.path_of(path))
    }

    /// The scene or suite.
    pub fn main(&self) -> PathBuf {
        self.path_of(&self.manifest.main)
    }

    /// The folder as that of the archive at `path`, for runs of its files.
    pub fn archive(&self, path: &Path) -> UnpackedArchive {
        UnpackedArchive { path: slashed(path), folder: slashed(self.folder()) }
    }

    /// The folder of the files.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }
}

/// Path of an entry within the folder of files.
fn path_of(name: &str) -> Result<String, PackError> {
    let path = name.strip_prefix(FILES).ok_or_else(|| entry_error(name, "lies outside of the folder `files`"))?;
    let path = path.strip_suffix('/').unwrap_or(path);
    if !path.is_empty() && check_path(path).is_err() {
        return Err(entry_error(name, "has a name that leads elsewhere"));
    }
    Ok(path.to_owned())
}

/// Refuses paths that are too long, contain `\`, `:` or NUL, or have a component that is not a name.
fn check_path(path: &str) -> Result<(), PackError> {
    let is_name = |part: &str| !part.is_empty() && part != "." && part != "..";
    let is_valid = path.len() <= MAX_NAME && !path.contains(['\\', '\0', ':']) && path.split('/').all(is_name);
    if is_valid { Ok(()) } else { Err(entry_error(path, "has a name that leads elsewhere")) }
}

fn entry_error(name: &str, what: &'static str) -> PackError {
    PackError::Entry { name: name.chars().take(200).flat_map(char::escape_debug).collect(), what }
}

/// Number of entries as stated at the end of the archive; `None` if it is missing or does not fit into 16 bits.
fn entry_count(bytes: &[u8]) -> Option<usize> {
    const SIGNATURE: [u8; 4] = *b"PK\x05\x06";
    let start = bytes.windows(SIGNATURE.len()).rposition(|window| window == SIGNATURE)?;
    let count = bytes.get(start + 10..start + 12)?;
    let count = u16::from_le_bytes([count[0], count[1]]);
    (count != u16::MAX).then_some(usize::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pack() -> Pack {
        let files = [("a/x.scene.toml", "[world]"), ("b.c", "int main() {}")];
        let files = files.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
        Pack { manifest: Manifest::new("a/x.scene.toml".into()), files: files.into_iter().collect() }
    }

    /// An archive with a manifest and these entries.
    fn zip_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        let manifest = serde_json::to_vec(&pack().manifest).expect("JSON");
        let required: [(&str, &[u8]); 2] = [(MANIFEST, &manifest), ("files/a/x.scene.toml", b"[world]")];
        for (name, bytes) in required.iter().chain(entries) {
            writer.start_file(*name, SimpleFileOptions::default()).expect("an entry");
            writer.write_all(bytes).expect("bytes");
        }
        writer.finish().expect("an archive").into_inner()
    }

    #[test]
    fn written_archive_is_read_back() {
        let bytes = pack().to_bytes().expect("an archive");
        assert_eq!(Pack::read(&bytes).expect("an archive"), pack());
        assert_eq!(pack().to_bytes().expect("an archive"), bytes);
        let unpacked = pack().unpack().expect("files");
        assert_eq!(fs::read_to_string(unpacked.main()).expect("a file"), "[world]");
    }

    #[test]
    fn entries_outside_the_folder_are_refused() {
        for name in
            ["../x", "files/../../x", "/etc/x", "files//etc/x", "files/a/../x", "files/c:x", "files/a\\..\\x", "x"]
        {
            let error = Pack::read(&zip_of(&[(name, b"x")])).expect_err(name).to_string();
            assert!(error.contains("the entry"), "{error}");
        }
        let error = Pack::read(&zip_of(&[("files/a", b"x")])).expect_err("a file and a folder").to_string();
        assert!(error.contains("a file and a folder"), "{error}");
    }

    #[test]
    fn links_bombs_and_invalid_files_are_refused() {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        writer.add_symlink("files/a", "/etc/passwd", SimpleFileOptions::default()).expect("a link");
        let bytes = writer.finish().expect("an archive").into_inner();
        assert!(Pack::read(&bytes).expect_err("a link").to_string().contains("is a link"));
        // Zeros are compressed to a thousandth.
        let zeros = vec![0; 64 << 20];
        let entries: Vec<(String, &[u8])> = (0..9).map(|index| (format!("files/{index}"), &zeros[..])).collect();
        let entries: Vec<(&str, &[u8])> = entries.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
        let bomb = zip_of(&entries);
        assert!(bomb.len() < 4 << 20, "{}", bomb.len());
        assert!(matches!(Pack::read(&bomb), Err(PackError::Size)));
        assert!(matches!(Pack::read(b""), Err(PackError::Zip(_))));
        assert!(matches!(Pack::read(b"PK\x05\x06"), Err(PackError::Zip(_))));
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        writer.start_file("files/a", SimpleFileOptions::default()).expect("an entry");
        let bytes = writer.finish().expect("an archive").into_inner();
        assert!(matches!(Pack::read(&bytes), Err(PackError::NoManifest)));
    }

    #[test]
    fn archives_that_would_be_refused_are_not_written() {
        let mut many = pack();
        many.files.extend((0..MAX_ENTRIES - many.files.len() - 1).map(|index| (format!("{index}"), Vec::new())));
        assert!(Pack::read(&many.to_bytes().expect("an archive")).is_ok());
        many.files.insert("one-more".into(), Vec::new());
        assert!(matches!(many.to_bytes(), Err(PackError::Entries(count)) if count == MAX_ENTRIES + 1));
        let mut large = pack();
        large.files.insert("large".into(), vec![0; MAX_BYTES as usize]);
        assert!(matches!(large.to_bytes(), Err(PackError::Size)));
    }

    #[test]
    fn entries_with_equal_names_are_refused() {
        // The name of the second one is changed to that of the first after writing.
        let mut bytes = zip_of(&[("files/p", b"1"), ("files/q", b"2")]);
        while let Some(at) = bytes.windows(7).position(|window| window == b"files/q") {
            bytes[at + 6] = b'p';
        }
        assert!(Pack::read(&bytes).is_err());
    }
}
