//! Cache folder of built programs, shared by concurrent runs.
//!
//! An entry is a folder that one atomic rename puts in place. Each use of an entry checks its library against the
//! stored digest; a broken entry is built again. Once a day a build removes the entries that were not used for
//! [`KEEP`].

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

/// Time for which an entry is kept after its last use.
pub const KEEP: Duration = Duration::from_secs(60 * 24 * 3600);

/// Time for which the folder of an unfinished build is kept.
const KEEP_UNFINISHED: Duration = Duration::from_secs(24 * 3600);

/// Time between two sweeps of the cache.
const SWEEP_PERIOD: Duration = Duration::from_secs(24 * 3600);

const LIBRARY: &str = "program.so";
const RECORD: &str = "entry.json";

/// Empty file, written at each sweep.
const SWEPT: &str = "swept";

/// A cache folder.
#[derive(Clone, Debug)]
pub struct Cache {
    root: PathBuf,
}

/// A built program in the cache.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CacheEntry {
    /// The shared library, or the object file of a shim.
    pub library: PathBuf,
    /// Output of the build as given to [`Cache::insert`]: warnings and remarks.
    pub output: String,
}

#[derive(Serialize, Deserialize)]
struct EntryRecord {
    library_blake3: String,
    output: String,
}

impl Cache {
    /// Opens the cache in `root`, and creates the folder if it does not exist.
    ///
    /// # Errors
    /// The folder cannot be created or written to.
    pub fn open(root: &Path) -> io::Result<Self> {
        fs::create_dir_all(root)?;
        tempfile::Builder::new().prefix("tmp-").tempfile_in(root)?;
        Ok(Self { root: std::path::absolute(root)? })
    }

    /// Opens the cache of this user in `$EYESIM_CACHE` or, if that is not set, in `$XDG_CACHE_HOME/eyesim` or
    /// `~/.cache/eyesim`. If `$EYESIM_CACHE` is not set and the other folder cannot be written to, opens a private
    /// folder in the temporary folder.
    ///
    /// # Errors
    /// `$EYESIM_CACHE` is set and cannot be written to, or none of the other folders can.
    pub fn of_user() -> io::Result<Self> {
        let path_of = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        if let Some(root) = path_of("EYESIM_CACHE") {
            return Self::open(&root).map_err(|error| {
                io::Error::new(error.kind(), format!("$EYESIM_CACHE `{}` cannot be used: {error}", root.display()))
            });
        }
        // A relative $XDG_CACHE_HOME must be ignored: XDG Base Directory Specification, 0.8.
        let user_folder = path_of("XDG_CACHE_HOME")
            .filter(|root| root.is_absolute())
            .or_else(|| Some(path_of("HOME")?.join(".cache")));
        if let Some(cache) = user_folder.and_then(|user_folder| Self::open(&user_folder.join("eyesim")).ok()) {
            return Ok(cache);
        }
        Self::open(&private_temporary_folder()?)
    }

    /// The folder of the cache, absolute.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Creates a folder to build in, on the same file system as the entries; it is removed when dropped.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn build_folder(&self) -> io::Result<tempfile::TempDir> {
        tempfile::Builder::new().prefix("tmp-").tempdir_in(&self.root)
    }

    /// The subfolder `name` of the cache, created if it does not exist.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn folder(&self, name: &str) -> io::Result<PathBuf> {
        let folder = self.root.join(name);
        fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// The entry of `key`, if it exists and is complete. Marks it as used.
    pub fn entry(&self, key: &str) -> Option<CacheEntry> {
        let folder = self.entry_folder(key);
        let record: EntryRecord = serde_json::from_slice(&fs::read(folder.join(RECORD)).ok()?).ok()?;
        let library = folder.join(LIBRARY);
        let digest = blake3::hash(&fs::read(&library).ok()?).to_hex();
        if digest.as_str() != record.library_blake3 {
            return None;
        }
        mark_used(&folder.join(RECORD));
        Some(CacheEntry { library, output: record.output })
    }

    /// Stores the file `library`, built in the folder `build`, as the entry of `key`.
    ///
    /// If another run has stored an entry of this key meanwhile, that entry is kept and returned.
    ///
    /// # Errors
    /// A file cannot be written or renamed.
    pub fn insert(&self, key: &str, build: tempfile::TempDir, library: &Path, output: &str) -> io::Result<CacheEntry> {
        let bytes = fs::read(library)?;
        let digest = blake3::hash(&bytes).to_hex().to_string();
        let entry_build = self.build_folder()?;
        // The copy belongs to this user, even if the compiler ran as another user in a sandbox.
        fs::write(entry_build.path().join(LIBRARY), bytes)?;
        let record = EntryRecord { library_blake3: digest, output: output.to_owned() };
        fs::write(entry_build.path().join(RECORD), serde_json::to_vec(&record)?)?;
        build.close()?;
        let folder = self.entry_folder(key);
        fs::create_dir_all(folder.parent().unwrap_or(&self.root))?;
        // Before each attempt another run may have stored its entry, or removed a broken one.
        for _ in 0..8 {
            match fs::rename(entry_build.path(), &folder) {
                Ok(()) => {
                    let _ = entry_build.keep();
                    self.sweep_if_due();
                    break;
                }
                Err(error) if !folder.exists() => return Err(error),
                Err(_) => {}
            }
            if let Some(entry) = self.entry(key) {
                return Ok(entry);
            }
            // The stored entry is broken.
            let discarded = self.build_folder()?;
            let _ = fs::rename(&folder, discarded.path().join("broken"));
        }
        self.entry(key).ok_or_else(|| io::Error::other(format!("the entry `{}` stays broken", folder.display())))
    }

    /// A small text stored beside the entries under `key`, such as the headers that a source included. Marks it as
    /// used.
    pub fn note(&self, key: &str) -> Option<String> {
        let path = self.note_path(key);
        let text = fs::read_to_string(&path).ok()?;
        mark_used(&path);
        Some(text)
    }

    /// Stores `text` under `key`, replacing an earlier text.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn set_note(&self, key: &str, text: &str) -> io::Result<()> {
        self.write_atomically(&self.note_path(key), text.as_bytes())
    }

    /// Writes `path` (inside the cache) atomically, so that readers never see an incomplete file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_atomically(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        fs::create_dir_all(path.parent().unwrap_or(&self.root))?;
        let mut file = tempfile::Builder::new().prefix("tmp-").tempfile_in(&self.root)?;
        io::Write::write_all(&mut file, bytes)?;
        file.persist(path).map(drop).map_err(|error| error.error)
    }

    fn entry_folder(&self, key: &str) -> PathBuf {
        self.root.join("programs").join(key)
    }

    fn note_path(&self, key: &str) -> PathBuf {
        self.root.join("notes").join(key)
    }

    /// Sweeps the cache once per [`SWEEP_PERIOD`]: a sweep reads the times of all entries, so it must not delay every
    /// build.
    fn sweep_if_due(&self) {
        let swept = self.root.join(SWEPT);
        // A time in the future, from a clock that was wrong, does not stop sweeps.
        if age(&swept).is_some_and(|age| age < SWEEP_PERIOD) {
            return;
        }
        if fs::write(&swept, "").is_ok() {
            self.sweep();
        }
    }

    /// Removes entries, notes and unfinished builds that were not used for a long time. Files that cannot be removed
    /// are skipped: another run may use them.
    fn sweep(&self) {
        let is_older = |path: &Path, max_age: Duration| age(path).is_some_and(|age| age > max_age);
        for folder in paths_in(&self.root.join("programs")) {
            let record = folder.join(RECORD);
            if is_older(if record.exists() { &record } else { &folder }, KEEP) {
                let _ = fs::remove_dir_all(&folder);
            }
        }
        for note in paths_in(&self.root.join("notes")).filter(|note| is_older(note, KEEP)) {
            let _ = fs::remove_file(note);
        }
        let is_unfinished = |path: &PathBuf| {
            let name = path.file_name().and_then(|name| name.to_str());
            name.is_some_and(|name| name.starts_with("tmp-")) && is_older(path, KEEP_UNFINISHED)
        };
        for path in paths_in(&self.root).filter(is_unfinished) {
            let _ = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}

fn paths_in(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path())
}

/// Time since the last change of `path`; `None` if `path` does not exist or the change lies in the future.
fn age(path: &Path) -> Option<Duration> {
    SystemTime::now().duration_since(fs::metadata(path).ok()?.modified().ok()?).ok()
}

fn mark_used(path: &Path) {
    // A cache on a read-only disk still works; only the times of use are unknown.
    let _ = fs::File::options().append(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// Creates a folder in the system's temporary folder. Only this user can write to the created folder, since its files
/// are loaded and run.
fn private_temporary_folder() -> io::Result<PathBuf> {
    use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _};
    // SAFETY: geteuid reads a number of this process, takes no argument and cannot fail.
    let user = unsafe { libc::geteuid() };
    let folder = std::env::temp_dir().join(format!("eyesim-{user}"));
    match fs::DirBuilder::new().mode(0o700).create(&folder) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    let metadata = fs::symlink_metadata(&folder)?;
    if !metadata.is_dir() || metadata.uid() != user || metadata.mode() & 0o022 != 0 {
        let text = format!("`{}` belongs to somebody else: set $EYESIM_CACHE to a folder of yours", folder.display());
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, text));
    }
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cache() -> (tempfile::TempDir, Cache) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = Cache::open(&folder.path().join("cache")).expect("a cache");
        (folder, cache)
    }

    fn put(cache: &Cache, key: &str, bytes: &[u8]) -> CacheEntry {
        let build = cache.build_folder().expect("a folder");
        let library = build.path().join("built.so");
        fs::write(&library, bytes).expect("a library");
        cache.insert(key, build, &library, "a warning").expect("an entry")
    }

    #[test]
    fn first_stored_entry_is_kept() {
        let (_folder, cache) = cache();
        assert_eq!(cache.entry("k"), None);
        let first = put(&cache, "k", b"one");
        assert_eq!(cache.entry("k"), Some(first.clone()));
        assert_eq!(first.output, "a warning");
        assert_eq!(put(&cache, "k", b"two"), first);
        assert_eq!(fs::read(&first.library).expect("the library"), b"one");
        let mut left: Vec<PathBuf> = paths_in(cache.root()).collect();
        left.sort();
        let expected = ["programs", SWEPT].map(|name| cache.root().join(name));
        assert_eq!(left, expected, "no unfinished folder is left");
    }

    #[test]
    fn broken_entries_are_replaced() {
        let (_folder, cache) = cache();
        let entry = put(&cache, "k", b"whole");
        fs::write(&entry.library, b"wh").expect("cut short");
        assert_eq!(cache.entry("k"), None);
        put(&cache, "k", b"whole again");
        assert_eq!(fs::read(cache.entry("k").expect("an entry").library).expect("the library"), b"whole again");
        fs::remove_file(cache.root().join("programs/k").join(RECORD)).expect("half written");
        assert_eq!(cache.entry("k"), None);
        put(&cache, "k", b"a third time");
        assert_eq!(fs::read(cache.entry("k").expect("an entry").library).expect("the library"), b"a third time");
    }

    fn set_used(path: &Path, at: SystemTime) {
        let file = fs::File::options().append(true).open(path).expect("a file");
        file.set_modified(at).expect("a time");
    }

    #[test]
    fn unused_entries_are_removed_once_a_day() {
        let (_folder, cache) = cache();
        let long_ago = SystemTime::now() - KEEP - Duration::from_secs(60);
        put(&cache, "old", b"old");
        cache.set_note("old", "note").expect("a note");
        for path in [cache.root().join("programs/old").join(RECORD), cache.root().join("notes/old")] {
            set_used(&path, long_ago);
        }
        put(&cache, "new", b"new");
        assert!(cache.root().join("programs/old").exists(), "the cache was swept a moment ago");
        set_used(&cache.root().join(SWEPT), SystemTime::now() - SWEEP_PERIOD);
        put(&cache, "newer", b"newer");
        assert!(!cache.root().join("programs/old").exists());
        assert_eq!(cache.note("old"), None);
        assert!(cache.entry("new").is_some());
    }

    #[test]
    fn wrong_clock_does_not_stop_sweeps() {
        let (_folder, cache) = cache();
        put(&cache, "k", b"one");
        let swept = cache.root().join(SWEPT);
        set_used(&swept, SystemTime::now() + 10 * SWEEP_PERIOD);
        put(&cache, "l", b"two");
        assert!(age(&swept).is_some_and(|age| age < SWEEP_PERIOD), "swept again");
    }

    #[test]
    fn concurrent_inserts_return_complete_entries() {
        let (_folder, cache) = cache();
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for key in 0..20 {
                        let entry = put(&cache, &key.to_string(), b"the same");
                        assert_eq!(fs::read(entry.library).expect("the library"), b"the same");
                    }
                });
            }
        });
    }
}
