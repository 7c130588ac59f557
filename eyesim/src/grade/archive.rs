//! Reads untrusted archives and folders: writes nothing, follows no links, and limits all sizes.

use std::collections::BTreeMap;
use std::fs::{self, FileType};
use std::io::{self, Cursor, Read};
use std::os::unix::fs::FileTypeExt as _;
use std::path::Path;

use sim_host::files::read_regular;
use sim_host::record::log::Printable;
use zip::ZipArchive;
use zip::result::ZipError;

/// Maximum total size of a submission's files, packed and unpacked, in bytes.
pub const MAX_BYTES: u64 = 256 << 20;
/// Maximum number of entries of a submission.
pub const MAX_ENTRIES: usize = 20_000;
/// Maximum unpacked size of an archive with all submissions, in bytes.
const MAX_CLASS_BYTES: u64 = 1 << 30;
/// Maximum number of entries of an archive with all submissions.
const MAX_CLASS_ENTRIES: usize = 400_000;
/// Maximum nesting depth of folders. A path in an archive has at most [`MAX_NESTED`] times as many parts.
const MAX_DEPTH: usize = 12;
/// Maximum nesting depth of archives, the outer one included.
const MAX_NESTED: usize = 3;
/// Maximum length of a path, in bytes.
const MAX_PATH: usize = 1024;
/// Maximum length of a file name, in bytes: the limit of Linux.
const MAX_NAME: usize = 255;

/// Files that were read, and remarks about files that were not read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// Contents of the files, by their paths with slashes.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Remarks about links, devices, unsupported archives and names that are too long.
    pub notes: Vec<String>,
}

/// Reasons why a submission is refused.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The file cannot be read.
    #[error("`{name}` cannot be read: {error}")]
    Io {
        /// The file or archive.
        name: String,
        /// The reason.
        error: io::Error,
    },
    /// The file is not an archive, or is broken.
    #[error("`{name}` is not a readable archive: {error}")]
    Broken {
        /// The archive.
        name: String,
        /// The reason.
        error: String,
    },
    /// An entry's path leads out of the archive.
    #[error("the entry `{entry}` of `{name}` leads out of the archive")]
    Outside {
        /// The archive.
        name: String,
        /// The entry.
        entry: String,
    },
    /// The total size of the files exceeds this limit, in bytes.
    #[error("its files have more than {} MiB", .0 >> 20)]
    Size(u64),
    /// The number of entries exceeds this limit.
    #[error("it has more than {0} entries")]
    Entries(usize),
    /// Archives are nested too deeply.
    #[error("`{0}` lies too deep: at most {MAX_NESTED} archives within each other, and {MAX_DEPTH} folders, are read")]
    Depth(String),
}

/// Supported kinds of archives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArchiveKind {
    Zip,
    Tar,
    TarGz,
}

/// Extensions of supported archives.
const KINDS: [(&str, ArchiveKind); 4] = [
    (".zip", ArchiveKind::Zip),
    (".tar", ArchiveKind::Tar),
    (".tar.gz", ArchiveKind::TarGz),
    (".tgz", ArchiveKind::TarGz),
];
/// Extensions of unsupported archives.
const UNSUPPORTED: [&str; 9] = [".rar", ".7z", ".tar.xz", ".txz", ".tar.bz2", ".tbz2", ".tar.zst", ".gz", ".xz"];

/// Name of a supported archive without its extension; `None` for any other name.
pub fn stem_of_archive(name: &str) -> Option<&str> {
    Some(kind_of(name)?.0)
}

/// Name of an unsupported archive without its extension; `None` for any other name.
pub fn stem_of_unsupported_archive(name: &str) -> Option<&str> {
    if kind_of(name).is_some() { None } else { UNSUPPORTED.iter().find_map(|ending| without_ending(name, ending)) }
}

fn kind_of(name: &str) -> Option<(&str, ArchiveKind)> {
    KINDS.into_iter().find_map(|(ending, kind)| Some((without_ending(name, ending)?, kind)))
}

/// The name without this extension, compared case-insensitively.
fn without_ending<'n>(name: &'n str, ending: &str) -> Option<&'n str> {
    let at = name.len().checked_sub(ending.len())?;
    let matches = name.is_char_boundary(at) && name[at..].eq_ignore_ascii_case(ending);
    matches.then(|| &name[..at])
}

/// Reads the parts of a submission; the limits apply to their sum.
pub struct Reader<'w> {
    /// Returns true for the paths of files whose contents are wanted; archives are always opened.
    is_wanted: &'w dyn Fn(&str) -> bool,
    /// True for an archive with all submissions. Archives in it stay closed, and all other entries are listed; only the
    /// wanted ones have contents.
    is_class: bool,
    byte_limit: u64,
    max_entries: usize,
    remaining: u64,
    entry_count: usize,
    contents: Contents,
}

impl<'w> Reader<'w> {
    /// Creates a reader of the files for which `is_wanted` returns true.
    pub fn new(is_wanted: &'w dyn Fn(&str) -> bool) -> Self {
        Self {
            is_wanted,
            is_class: false,
            byte_limit: MAX_BYTES,
            max_entries: MAX_ENTRIES,
            remaining: MAX_BYTES,
            entry_count: 0,
            contents: Contents::default(),
        }
    }

    /// Creates a reader of an archive with all submissions: archives in it are treated as files.
    pub fn of_class(is_wanted: &'w dyn Fn(&str) -> bool) -> Self {
        Self {
            is_class: true,
            byte_limit: MAX_CLASS_BYTES,
            max_entries: MAX_CLASS_ENTRIES,
            remaining: MAX_CLASS_BYTES,
            ..Self::new(is_wanted)
        }
    }

    /// Returns what has been read.
    pub fn into_contents(self) -> Contents {
        self.contents
    }

    /// Reads the file, archive or folder `path` of the disk under the name `name`; links are not followed.
    ///
    /// # Errors
    /// [`ArchiveError`].
    pub fn read_path(&mut self, path: &Path, name: &str) -> Result<(), ArchiveError> {
        self.walk(path, name, 0)
    }

    fn walk(&mut self, path: &Path, name: &str, depth: usize) -> Result<(), ArchiveError> {
        let io = |error| ArchiveError::Io { name: printable(name), error };
        self.count_entry()?;
        let metadata = fs::symlink_metadata(path).map_err(io)?;
        if metadata.is_dir() {
            if depth == MAX_DEPTH {
                return Err(ArchiveError::Depth(printable(name)));
            }
            let mut entries = fs::read_dir(path).map_err(io)?.collect::<Result<Vec<_>, _>>().map_err(io)?;
            entries.sort_by_key(fs::DirEntry::file_name);
            for entry in entries {
                let entry_name = entry.file_name().to_string_lossy().into_owned();
                let name = if name.is_empty() { entry_name } else { format!("{name}/{entry_name}") };
                self.walk(&entry.path(), &name, depth + 1)?;
            }
            return Ok(());
        }
        if !metadata.is_file() {
            if !is_junk(name) {
                self.note(name, describe_kind(metadata.file_type()));
            }
            return Ok(());
        }
        if is_junk(name) || !self.is_read(name) {
            return Ok(());
        }
        if metadata.len() > self.remaining {
            return Err(self.too_large());
        }
        let bytes = read_regular(path).map_err(io)?;
        self.read_file(name, bytes, 0)
    }

    /// Adds a file with these contents if the file is wanted, or opens it if it is an archive; `nested` is the number
    /// of archives that contain it.
    ///
    /// # Errors
    /// [`ArchiveError`].
    pub fn read_file(&mut self, name: &str, bytes: Vec<u8>, nested: usize) -> Result<(), ArchiveError> {
        self.remaining = self.remaining.checked_sub(bytes.len() as u64).ok_or_else(|| self.too_large())?;
        match kind_of(name) {
            _ if self.is_class && nested > 0 => {
                self.contents.files.insert(name.to_owned(), bytes);
                Ok(())
            }
            Some(_) if nested == MAX_NESTED => Err(ArchiveError::Depth(printable(name))),
            Some((stem, kind)) => self.open(name, stem, kind, bytes, nested + 1),
            None if (self.is_wanted)(name) => {
                self.add(name, bytes);
                Ok(())
            }
            None if stem_of_unsupported_archive(name).is_some() => {
                self.note(name, "is an archive, but not .zip, .tar or .tar.gz");
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// Adds a file. Another version of a file gets a folder of its own, so that none is lost.
    fn add(&mut self, name: &str, bytes: Vec<u8>) {
        let files = &mut self.contents.files;
        let versions = (2..).map(|version| format!("version {version}/{name}"));
        let is_free = |path: &String| files.get(path).is_none_or(|other| *other == bytes);
        if let Some(path) = std::iter::once(name.to_owned()).chain(versions).find(is_free) {
            files.insert(path, bytes);
        }
    }

    fn open(
        &mut self,
        name: &str,
        stem: &str,
        kind: ArchiveKind,
        bytes: Vec<u8>,
        nested: usize,
    ) -> Result<(), ArchiveError> {
        let broken = |error: String| ArchiveError::Broken { name: printable(name), error };
        match kind {
            ArchiveKind::Zip => self.open_zip(name, stem, bytes, nested),
            ArchiveKind::Tar => self.open_tar(name, stem, Cursor::new(bytes), nested),
            ArchiveKind::TarGz => {
                // Skipped entries are decompressed, too.
                let max_bytes = self.remaining + (self.max_entries as u64) * 1024;
                let mut inflated = flate2::read::MultiGzDecoder::new(Cursor::new(bytes)).take(max_bytes + 1);
                let result = self.open_tar(name, stem, &mut inflated, nested);
                if inflated.limit() == 0 {
                    return Err(self.too_large());
                }
                result.map_err(|error| match error {
                    ArchiveError::Io { error, .. } => broken(error.to_string()),
                    error => error,
                })
            }
        }
    }

    fn open_zip(&mut self, name: &str, stem: &str, bytes: Vec<u8>, nested: usize) -> Result<(), ArchiveError> {
        let broken = |error: ZipError| ArchiveError::Broken { name: printable(name), error: error.to_string() };
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        for index in 0..archive.len() {
            self.count_entry()?;
            let mut file = archive.by_index(index).map_err(broken)?;
            // In archives from macOS, names are in UTF-8, but the flag for UTF-8 is not set.
            let entry_name =
                std::str::from_utf8(file.name_raw()).map_or_else(|_| file.name().to_owned(), str::to_owned);
            let Some(path) = self.path_of_entry(name, stem, &entry_name)? else { continue };
            let mode = file.unix_mode().map_or(0, |mode| mode & 0o170_000);
            if file.is_symlink() || !matches!(mode, 0 | 0o100_000 | 0o040_000) {
                self.note(&path, "is a link or a device");
            } else if file.is_dir() || !self.is_read(&path) {
                self.list_entry(&path, file.is_dir());
            } else {
                let content = self
                    .read_entry(&mut file)
                    .map_err(|error| error.map_or_else(|| self.too_large(), |error| broken(ZipError::Io(error))))?;
                drop(file);
                self.read_file(&path, content, nested)?;
            }
        }
        Ok(())
    }

    fn open_tar(&mut self, name: &str, stem: &str, bytes: impl Read, nested: usize) -> Result<(), ArchiveError> {
        let broken = |error: io::Error| ArchiveError::Broken { name: printable(name), error: error.to_string() };
        let mut archive = tar::Archive::new(bytes);
        for entry in archive.entries().map_err(broken)? {
            self.count_entry()?;
            let mut entry = entry.map_err(broken)?;
            let entry_name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
            let kind = entry.header().entry_type();
            if kind == tar::EntryType::XGlobalHeader {
                continue;
            }
            let Some(path) = self.path_of_entry(name, stem, &entry_name)? else { continue };
            if kind.is_dir() {
                self.list_entry(&path, true);
            } else if !(kind.is_file() || kind.is_contiguous() || kind.is_gnu_sparse()) {
                self.note(&path, "is a link or a device");
            } else if self.is_read(&path) {
                let content =
                    self.read_entry(&mut entry).map_err(|error| error.map_or_else(|| self.too_large(), broken))?;
                self.read_file(&path, content, nested)?;
            } else {
                self.list_entry(&path, false);
            }
        }
        Ok(())
    }

    /// Content of an entry; `Err(None)` if it is too large. The size in the entry's header is not trusted.
    fn read_entry(&self, file: &mut impl Read) -> Result<Vec<u8>, Option<io::Error>> {
        let mut content = Vec::new();
        let read = file.take(self.remaining + 1).read_to_end(&mut content).map_err(Some)?;
        if read as u64 > self.remaining { Err(None) } else { Ok(content) }
    }

    /// Path of an entry of the archive `name`; `None` for files that operating systems add and for names that are too
    /// long.
    fn path_of_entry(&mut self, name: &str, stem: &str, entry: &str) -> Result<Option<String>, ArchiveError> {
        let outside = || ArchiveError::Outside { name: printable(name), entry: printable(entry) };
        let slashed = entry.replace('\\', "/");
        let has_drive = slashed.as_bytes().get(1) == Some(&b':');
        if slashed.starts_with('/') || has_drive || slashed.contains('\0') {
            return Err(outside());
        }
        let mut parts = vec![stem];
        for part in slashed.split('/') {
            match part {
                "" | "." => {}
                ".." => return Err(outside()),
                part => parts.push(part),
            }
        }
        let path = parts.join("/");
        if parts.len() > MAX_DEPTH * MAX_NESTED {
            return Err(ArchiveError::Depth(printable(&path)));
        }
        if path.len() > MAX_PATH || parts.iter().any(|part| part.len() > MAX_NAME) {
            self.note(&path.chars().take(80).collect::<String>(), "has a name that is too long");
            return Ok(None);
        }
        Ok(Some(path).filter(|path| !is_junk(path)))
    }

    /// Returns true if the content of the file is read: it is wanted, or an archive.
    fn is_read(&mut self, name: &str) -> bool {
        let is_read = (self.is_wanted)(name) || kind_of(name).is_some();
        if !is_read && stem_of_unsupported_archive(name).is_some() {
            self.note(name, "is an archive, but not .zip, .tar or .tar.gz");
        }
        is_read
    }

    /// Lists an entry of an archive with all submissions without its contents, so that no student is missing.
    fn list_entry(&mut self, path: &str, is_folder: bool) {
        if self.is_class {
            let path = if is_folder { format!("{path}/.") } else { path.to_owned() };
            self.contents.files.insert(path, Vec::new());
        }
    }

    fn count_entry(&mut self) -> Result<(), ArchiveError> {
        self.entry_count += 1;
        if self.entry_count > self.max_entries { Err(ArchiveError::Entries(self.max_entries)) } else { Ok(()) }
    }

    fn too_large(&self) -> ArchiveError {
        ArchiveError::Size(self.byte_limit)
    }

    fn note(&mut self, name: &str, reason: &str) {
        const MAX_NOTES: usize = 20;
        if self.contents.notes.len() < MAX_NOTES {
            self.contents.notes.push(format!("`{}` {reason}: it is not read", printable(name)));
        }
    }
}

/// Returns true for files and folders that operating systems and editors add.
pub fn is_junk(path: &str) -> bool {
    path.split('/').any(|part| {
        matches!(part, "__MACOSX" | ".DS_Store" | ".git" | ".svn" | ".hg" | "Thumbs.db" | "desktop.ini")
            || part.starts_with("._")
    })
}

/// Describes a file that is neither a regular file nor a folder.
fn describe_kind(kind: FileType) -> &'static str {
    if kind.is_symlink() {
        "is a link"
    } else if kind.is_fifo() {
        "is a FIFO"
    } else if kind.is_socket() {
        "is a socket"
    } else {
        "is a device"
    }
}

/// Replaces control characters in a name, for messages.
pub(super) fn printable(name: &str) -> String {
    Printable(name).to_string()
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    fn zip_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            writer.start_file(*name, SimpleFileOptions::default()).expect("an entry");
            writer.write_all(bytes).expect("bytes");
        }
        writer.finish().expect("an archive").into_inner()
    }

    fn tar_of(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut builder = tar::Builder::new(Vec::new());
        for (name, bytes) in entries {
            let mut header = tar::Header::new_gnu();
            header.set_size(bytes.len() as u64);
            // `set_path` would refuse names that lead out of the archive.
            header.as_gnu_mut().expect("a header").name[..name.len()].copy_from_slice(name.as_bytes());
            header.set_cksum();
            builder.append(&header, *bytes).expect("an entry");
        }
        builder.into_inner().expect("an archive")
    }

    fn gz(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).expect("bytes");
        encoder.finish().expect("an archive")
    }

    fn read(name: &str, bytes: Vec<u8>) -> Result<Contents, ArchiveError> {
        let is_wanted = |path: &str| path.ends_with(".c") || path.ends_with(".h");
        let mut reader = Reader::new(&is_wanted);
        reader.read_file(name, bytes, 0)?;
        Ok(reader.into_contents())
    }

    fn paths(contents: &Contents) -> Vec<&str> {
        contents.files.keys().map(String::as_str).collect()
    }

    #[test]
    fn nested_archives_are_read() {
        let entries: [(&str, &[u8]); 4] =
            [("lab/a.c", b"1"), ("lab\\map.h", b"2"), ("__MACOSX/lab/._a.c", b"3"), ("lab/notes.txt", b"4")];
        let expected = ["x/lab/a.c", "x/lab/map.h"];
        assert_eq!(paths(&read("x.zip", zip_of(&entries)).expect("files")), expected);
        assert_eq!(paths(&read("x.TAR", tar_of(&entries)).expect("files")), expected);
        assert_eq!(paths(&read("x.tar.gz", gz(&tar_of(&entries))).expect("files")), expected);
        assert_eq!(paths(&read("x.tgz", gz(&tar_of(&entries))).expect("files")), expected);
        let inner = zip_of(&entries);
        let outer = zip_of(&[("y/x.zip", &inner), ("b.c", b"5"), ("old.rar", b"6")]);
        let contents = read("z.zip", outer).expect("files");
        assert_eq!(paths(&contents), ["z/b.c", "z/y/x/lab/a.c", "z/y/x/lab/map.h"]);
        assert!(contents.notes[0].contains("old.rar"), "{contents:?}");
        assert_eq!(read("x.zip", zip_of(&[])).expect("nothing"), Contents::default());
    }

    #[test]
    fn versions_of_a_file_are_kept() {
        let is_wanted = |path: &str| path.ends_with(".c");
        let mut reader = Reader::new(&is_wanted);
        for text in ["1", "2", "1", "3", "2"] {
            reader.read_file("lab.zip", zip_of(&[("a.c", text.as_bytes())]), 0).expect("files");
        }
        assert_eq!(paths(&reader.into_contents()), ["lab/a.c", "version 2/lab/a.c", "version 3/lab/a.c"]);
    }

    #[test]
    fn entries_outside_the_archive_are_refused() {
        for name in ["../a.c", "/etc/a.c", "a/../../a.c", "c:\\a.c", "..\\a.c"] {
            for result in [read("x.zip", zip_of(&[(name, b"1")])), read("x.tar", tar_of(&[(name, b"1")]))] {
                assert!(matches!(result, Err(ArchiveError::Outside { .. })), "{name}: {result:?}");
            }
        }
    }

    #[test]
    fn links_and_devices_are_skipped() {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        writer.add_symlink("a.c", "/etc/passwd", SimpleFileOptions::default()).expect("a link");
        let contents = read("x.zip", writer.finish().expect("an archive").into_inner()).expect("files");
        assert!(contents.files.is_empty() && contents.notes.len() == 1, "{contents:?}");
        let mut builder = tar::Builder::new(Vec::new());
        for (kind, name) in [
            (tar::EntryType::Symlink, "a.c"),
            (tar::EntryType::Link, "b.c"),
            (tar::EntryType::Fifo, "c.c"),
            (tar::EntryType::Char, "d.c"),
        ] {
            let mut header = tar::Header::new_gnu();
            header.set_entry_type(kind);
            header.set_path(name).expect("a path");
            header.set_link_name("/etc/passwd").expect("a link");
            header.set_size(0);
            header.set_cksum();
            builder.append(&header, io::empty()).expect("an entry");
        }
        let contents = read("x.tar", builder.into_inner().expect("an archive")).expect("files");
        assert!(contents.files.is_empty() && contents.notes.len() == 4, "{contents:?}");
    }

    #[test]
    fn bombs_and_broken_archives_are_refused() {
        let zeros = vec![0; (MAX_BYTES / 4) as usize + 1];
        let entries: Vec<(String, &[u8])> = (0..4).map(|index| (format!("{index}.c"), &zeros[..])).collect();
        let entries: Vec<(&str, &[u8])> = entries.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
        let bomb = zip_of(&entries);
        assert!(bomb.len() < 2 << 20, "{}", bomb.len());
        assert!(matches!(read("x.zip", bomb), Err(ArchiveError::Size(_))));
        // Skipped entries are decompressed, too.
        let skipped: Vec<(&str, &[u8])> = (0..6).map(|_| ("film.avi", &zeros[..])).collect();
        assert!(matches!(read("x.tgz", gz(&tar_of(&skipped))), Err(ArchiveError::Size(_))));
        let names: Vec<String> = (0..=MAX_ENTRIES).map(|index| format!("{index}.c")).collect();
        let many: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &b""[..])).collect();
        assert!(matches!(read("x.zip", zip_of(&many)), Err(ArchiveError::Entries(_))));
        let mut nested = zip_of(&[("a.c", b"1")]);
        for _ in 0..MAX_NESTED {
            nested = zip_of(&[("x.zip", &nested)]);
        }
        assert!(matches!(read("x.zip", nested), Err(ArchiveError::Depth(_))));
        for (name, bytes) in
            [("x.zip", &b""[..]), ("x.zip", b"PK\x05\x06"), ("x.tgz", b"\x1f\x8b"), ("x.tar", &[7; 600])]
        {
            assert!(matches!(read(name, bytes.to_vec()), Err(ArchiveError::Broken { .. })), "{name}");
        }
    }
}
