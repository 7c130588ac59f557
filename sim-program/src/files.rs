//! File system access for the readers of scenes.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use sim_format::{FileError, Files};

use crate::host;

/// Environment variable with the folder of the installation, which replaces `%sim%` in paths.
pub const HOME_VARIABLE: &str = "EYESIM_HOME";

/// Size limit of a file in MiB. Larger files are not meshes or images; reading them would only exhaust the memory.
const MAX_MEBIBYTES: u64 = 256;
/// Size limit of a scene's text file in MiB; each line of it may become a wall or a robot.
const MAX_TEXT_MEBIBYTES: u64 = 16;
/// Extensions of text files.
const TEXT_EXTENSIONS: [&str; 15] =
    ["sim", "wld", "maz", "maze", "robi", "esobj", "toml", "yaml", "yml", "map", "scen", "num", "txt", "world", "sdf"];

/// The installation folder of the archive that this process has opened.
static ARCHIVE_HOME: OnceLock<PathBuf> = OnceLock::new();

/// Makes [`DiskFiles::of_environment`] use the installation in `home`, for a process that runs an archive.
pub fn use_home(home: &Path) {
    ARCHIVE_HOME.get_or_init(|| home.to_owned());
}

/// Visits all files below `root`: those of each folder in the order of their names, then its subfolders. Hidden
/// subfolders, symbolic links to folders (which may form cycles), and subfolders of build results (those with a file
/// `CACHEDIR.TAG`, such as Cargo's `target`) are skipped.
pub fn walk(root: &Path, visit: &mut dyn FnMut(&Path), report_unreadable: &mut dyn FnMut(&Path, &io::Error)) {
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        let listed = fs::read_dir(&folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
        let mut entries = match listed {
            Ok(entries) => entries,
            Err(error) => {
                report_unreadable(&folder, &error);
                continue;
            }
        };
        if folder != root && entries.iter().any(|entry| entry.file_name() == "CACHEDIR.TAG") {
            continue;
        }
        entries.sort_by_key(fs::DirEntry::file_name);
        let mut subfolders = Vec::new();
        for entry in entries {
            // `./a.wld` and `a.wld` are one file.
            let path = entry.path();
            let path = path.strip_prefix(".").unwrap_or(&path);
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            if is_folder && !entry.file_name().as_encoded_bytes().starts_with(b".") {
                subfolders.push(path.to_owned());
            } else if !is_folder && path.is_file() {
                visit(path);
            }
        }
        folders.extend(subfolders.into_iter().rev());
    }
}

/// Files on the disk, relative to the working folder.
#[derive(Clone, Debug, Default)]
pub struct DiskFiles {
    home: Option<String>,
    /// Paths of files whose real names are not valid text or contain backslashes.
    real_paths: BTreeMap<String, PathBuf>,
    /// Files whose texts the caller supplies.
    texts: BTreeMap<String, String>,
}

impl DiskFiles {
    /// Files with the first of these installations: the one that [`use_home`] has set; the one that [`HOME_VARIABLE`]
    /// names; the one of the [host]; the folder above the running binary that contains `worlds` and `robis`; the
    /// checkout that the binary was built from, if it still exists.
    pub fn of_environment() -> Self {
        if let Some(home) = ARCHIVE_HOME.get() {
            return Self::with_home(home);
        }
        let user_home = std::env::var_os(HOME_VARIABLE).filter(|home| !home.is_empty()).map(PathBuf::from);
        let home = user_home.or_else(|| host::current()?.home.clone()).or_else(folder_above_binary).or_else(checkout);
        Self { home: home.map(|home| slashed(&home)), ..Self::default() }
    }

    /// Files with the installation in `home`.
    pub fn with_home(home: &Path) -> Self {
        Self { home: Some(slashed(home)), ..Self::default() }
    }

    /// Replaces the contents of the file `name` by `text`.
    pub fn with_text(mut self, name: &Path, text: &str) -> Self {
        self.texts.insert(slashed(name), text.to_owned());
        self
    }

    /// Name under which a reader finds the file `path`; works for any characters or bytes in its real name.
    pub fn name(&mut self, path: &Path) -> String {
        let name = slashed(path);
        if path.to_str() != Some(name.as_str()) {
            self.real_paths.insert(name.clone(), path.to_owned());
        }
        name
    }
}

impl Files for DiskFiles {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        if let Some(text) = self.texts.get(path) {
            return Ok(text.clone().into_bytes());
        }
        let path = self.real_paths.get(path).map_or(Path::new(path), PathBuf::as_path);
        let is_text = path
            .extension()
            .is_some_and(|extension| TEXT_EXTENSIONS.iter().any(|text| extension.eq_ignore_ascii_case(text)));
        let max_mebibytes = if is_text { MAX_TEXT_MEBIBYTES } else { MAX_MEBIBYTES };
        read_bounded(path, max_mebibytes).map_err(file_error)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let folder = if folder.is_empty() { "." } else { folder };
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.sort_unstable();
        names
    }

    fn home(&self) -> Option<&str> {
        self.home.as_deref()
    }
}

/// Opens the regular file at `path`; a pipe or a device, which may never end, is refused without blocking.
///
/// # Errors
/// The file cannot be opened or is not a regular file.
pub fn open_regular(path: &Path) -> io::Result<File> {
    let file = File::options().read(true).custom_flags(libc::O_NONBLOCK).open(path)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(io::Error::other("it is not a file")) }
}

/// Contents of the regular file at `path`.
///
/// # Errors
/// The file cannot be read, or is larger than 256 MiB.
pub fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    read_bounded(path, MAX_MEBIBYTES)
}

fn read_bounded(path: &Path, max_mebibytes: u64) -> io::Result<Vec<u8>> {
    let mut file = open_regular(path)?;
    let length = file.metadata()?.len();
    if length > max_mebibytes << 20 {
        return Err(io::Error::other(format!("it is larger than {max_mebibytes} MiB")));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The path with forward slashes, as the readers write paths.
pub fn slashed(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

fn file_error(error: std::io::Error) -> FileError {
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => FileError::Missing,
        _ => FileError::Unreadable(error.to_string()),
    }
}

fn folder_above_binary() -> Option<PathBuf> {
    let binary = std::env::current_exe().ok()?;
    binary.ancestors().skip(1).find(|folder| is_installation(folder)).map(Path::to_path_buf)
}

fn checkout() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    is_installation(root).then(|| root.to_path_buf())
}

fn is_installation(folder: &Path) -> bool {
    folder.join("worlds").is_dir() && folder.join("robis").is_dir()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_allowed_size_are_read() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = slashed(&folder.path().join("a.wld"));
        fs::write(&path, "floor 1 1").expect("a file");
        let files = DiskFiles::with_home(folder.path());
        assert_eq!(files.read(&path), Ok(b"floor 1 1".to_vec()));
        assert_eq!(files.read(&format!("{path}/b")), Err(FileError::Missing));
        assert_eq!(files.read(&format!("{path}x")), Err(FileError::Missing));
        assert!(matches!(files.read(&slashed(folder.path())), Err(FileError::Unreadable(_))));
        assert_eq!(files.list(&slashed(folder.path())), ["a.wld"]);
        fs::File::options()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_len((16 << 20) + 1))
            .expect("a large file");
        assert_eq!(files.read(&path), Err(FileError::Unreadable("it is larger than 16 MiB".to_owned())));
        assert_eq!(files.home(), Some(slashed(folder.path()).as_str()));
    }

    #[test]
    fn walk_skips_hidden_folders_links_and_build_results() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for path in ["b/d.rs", "b/c.rs", "e.rs", ".git/f", "target/CACHEDIR.TAG", "target/debug/g.rs"] {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, "").expect("a file");
        }
        std::os::unix::fs::symlink(folder.path(), folder.path().join("b/link")).expect("a link");
        let visited = |root: &Path| {
            let mut names = Vec::new();
            let mut add = |path: &Path| names.push(slashed(path.strip_prefix(root).expect("a file below the root")));
            walk(root, &mut add, &mut |folder, error| panic!("{}: {error}", folder.display()));
            names
        };
        assert_eq!(visited(folder.path()), ["e.rs", "b/c.rs", "b/d.rs"]);
        let target = folder.path().join("target");
        assert_eq!(visited(&target), ["CACHEDIR.TAG", "debug/g.rs"], "the user asks for this folder");
    }

    #[test]
    fn checkout_is_an_installation() {
        assert!(is_installation(&checkout().expect("the checkout holds worlds and robis")));
    }
}
