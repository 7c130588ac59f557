//! Builds a robot program that is a Cargo package; cargo decides whether it is up to date.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::cache::Cache;
use super::command::{CARGO_TIMEOUT, build_output, build_timeout};
use super::plain_rust::in_plain_words;

/// A package that was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// Shared library of the package.
    pub library: PathBuf,
    /// Warnings of cargo and the compiler.
    pub output: String,
    /// The library was up to date: nothing was compiled.
    pub fresh: bool,
}

/// Reasons why a Cargo package cannot be built into a program.
#[derive(Debug, thiserror::Error)]
pub enum CargoError {
    /// cargo does not start.
    #[error(
        "cannot run `{}` to build the Rust program in `{}`: {error}; install Rust from https://rustup.rs, or set $CARGO",
        cargo.display(), folder.display()
    )]
    Missing {
        /// The command.
        cargo: PathBuf,
        /// The package's folder.
        folder: PathBuf,
        /// Reason why it does not start.
        error: io::Error,
    },
    /// cargo was killed: at the time limit, or because the user has interrupted the process.
    #[error("the Rust program in `{}` is not built: cargo was stopped: {error}", folder.display())]
    Stopped {
        /// The package's folder.
        folder: PathBuf,
        /// The error with the reason.
        error: io::Error,
    },
    /// cargo ends with an error; our hints precede its messages, from which progress messages are removed.
    #[error("{}the Rust program in `{}` does not build:\n{output}", in_plain_words(output), folder.display())]
    Refused {
        /// The package's folder.
        folder: PathBuf,
        /// Messages of cargo and the compiler.
        output: String,
    },
    /// The package builds, but has no shared library.
    #[error(
        "the package in `{}` builds no library that can be loaded: its Cargo.toml needs\n  [lib]\n  crate-type = [\"cdylib\"]",
        folder.display()
    )]
    NoLibrary {
        /// The package's folder.
        folder: PathBuf,
    },
    /// A file or folder of the build cannot be found, created, read or written.
    #[error("cannot make a folder for the build of `{}`: {error}", folder.display())]
    Io {
        /// The package's folder.
        folder: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
}

/// Environment variables of a cargo that runs this process (its job server and data about its package), which would
/// disturb the cargo that is started here.
const FOREIGN_VARIABLES: &[&str] =
    &["MAKEFLAGS", "MFLAGS", "CARGO_MAKEFLAGS", "CARGO_MANIFEST_DIR", "CARGO_MANIFEST_PATH"];

/// Builds the package in `folder` in release mode, always with line tables and unwinding, regardless of its profile.
///
/// The target folder is in `cache`: one for the members of each workspace, and one for all packages that are the root
/// of their workspace or belong to none; these packages share their built dependencies. So a `cargo run` or
/// `cargo test` that runs this process never holds the lock of the target folder.
///
/// # Errors
/// [`CargoError`].
pub fn build_package(folder: &Path, cargo: Option<&Path>, cache: &Cache) -> Result<Package, CargoError> {
    let cargo = cargo.unwrap_or(Path::new("cargo"));
    let io_error = |error| CargoError::Io { folder: folder.to_owned(), error };
    let manifest = std::fs::canonicalize(folder.join("Cargo.toml")).map_err(io_error)?;
    let workspace = workspace_manifest(cargo, &manifest).map_err(|error| not_run(cargo, folder, error))?;
    let targets = cache.folder("cargo").map_err(io_error)?;
    let name = &blake3::hash(workspace.as_os_str().as_encoded_bytes()).to_hex()[..16];
    let build = |target: &Path| build_in_folder(target, folder, &manifest, cargo);
    if workspace == manifest {
        build_in_shared_folder(&targets.join("shared"), name, cache, &io_error, |shared| match shared {
            Some(shared) => build(shared),
            None => build(&targets.join(name)),
        })
    } else {
        build(&targets.join(name))
    }
}

/// Builds a package in the target folder `shared` and keeps its library there under the package's own `key`.
///
/// Packages of the same name have the same library path in a target folder: cargo overwrites one library with the other
/// and reports both as up to date. So the library of a package is the copy that was made when cargo last built it; a
/// lock is held during build and copy. Without a copy, a library that cargo reports as up to date may belong to another
/// package: then `build(None)` builds the package in its own target folder.
fn build_in_shared_folder(
    shared: &Path,
    key: &str,
    cache: &Cache,
    io_error: &impl Fn(io::Error) -> CargoError,
    build: impl Fn(Option<&Path>) -> Result<Package, CargoError>,
) -> Result<Package, CargoError> {
    let copies = shared.join("libraries").join(key);
    fs::create_dir_all(&copies).map_err(io_error)?;
    let lock = fs::File::create(shared.join("eyesim.lock")).map_err(io_error)?;
    lock.lock().map_err(io_error)?;
    // The file with the copy's name; absent while the copy may be out of date.
    let note = copies.join("name");
    let copy = fs::read_to_string(&note).ok().map(|name| copies.join(name)).filter(|copy| copy.exists());
    if copy.is_some() {
        fs::remove_file(&note).map_err(io_error)?;
    }
    let mut package = build(Some(shared))?;
    let library = match copy.filter(|_| package.fresh) {
        Some(copy) => copy,
        None => {
            if package.fresh {
                package = build(None)?;
            }
            let copy = copies.join(package.library.file_name().unwrap_or_default());
            let bytes = fs::read(&package.library).map_err(io_error)?;
            cache.write_atomically(&copy, &bytes).map_err(io_error)?;
            copy
        }
    };
    let name = library.file_name().unwrap_or_default().as_encoded_bytes();
    cache.write_atomically(&note, name).map_err(io_error)?;
    Ok(Package { library, ..package })
}

/// Runs `cargo build` with the target folder `target`.
fn build_in_folder(target: &Path, folder: &Path, manifest: &Path, cargo: &Path) -> Result<Package, CargoError> {
    let mut command = cargo_command(cargo, manifest);
    command.args(["build", "--lib", "--release", "--message-format=json-render-diagnostics"]);
    command.arg("--manifest-path").arg(manifest).arg("--target-dir").arg(target);
    for (name, value) in [("DEBUG", "line-tables-only"), ("PANIC", "unwind"), ("STRIP", "none")] {
        command.env(format!("CARGO_PROFILE_RELEASE_{name}"), value);
    }
    let output = build_output(&mut command, build_timeout(CARGO_TIMEOUT));
    let output = output.map_err(|error| not_run(cargo, folder, error))?;
    let cargo_output = String::from_utf8_lossy(&output.stderr).into_owned();
    let messages = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        let folder = folder.to_owned();
        return Err(if cargo_output.contains("no library targets found") {
            CargoError::NoLibrary { folder }
        } else {
            CargoError::Refused { folder, output: without_progress(&cargo_output) }
        });
    }
    let (library, fresh) =
        library_of(&messages, manifest).ok_or_else(|| CargoError::NoLibrary { folder: folder.to_owned() })?;
    let output = without_progress(&cargo_output);
    Ok(Package { library, output: in_plain_words(&output) + &output, fresh })
}

/// The reason why cargo has no result: it did not start, or it was killed.
fn not_run(cargo: &Path, folder: &Path, error: io::Error) -> CargoError {
    let folder = folder.to_owned();
    match error.kind() {
        io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => CargoError::Stopped { folder, error },
        _ => CargoError::Missing { cargo: cargo.to_owned(), folder, error },
    }
}

fn cargo_command(cargo: &Path, manifest: &Path) -> Command {
    let mut command = Command::new(cargo);
    // The working folder determines which `.cargo/config.toml` and `rust-toolchain.toml` apply.
    command.current_dir(manifest.parent().unwrap_or(Path::new("."))).stdin(Stdio::null());
    for name in FOREIGN_VARIABLES {
        command.env_remove(name);
    }
    command
}

/// The manifest of the workspace of `manifest`, or `manifest` itself if cargo fails (the build then reports the
/// reason).
fn workspace_manifest(cargo: &Path, manifest: &Path) -> io::Result<PathBuf> {
    let mut command = cargo_command(cargo, manifest);
    command.args(["locate-project", "--workspace", "--message-format=plain", "--manifest-path"]).arg(manifest);
    let output = build_output(&mut command, build_timeout(CARGO_TIMEOUT))?;
    let cargo_output = String::from_utf8_lossy(&output.stdout);
    Ok(if output.status.success() { PathBuf::from(cargo_output.trim()) } else { manifest.to_owned() })
}

/// The shared library of the package, and true if it was up to date, from cargo's messages (one JSON value per line).
fn library_of(messages: &str, manifest: &Path) -> Option<(PathBuf, bool)> {
    messages.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok()).find_map(|message| {
        let is_package_library = message["reason"] == "compiler-artifact"
            && message["manifest_path"].as_str().is_some_and(|path| Path::new(path) == manifest)
            && message["target"]["crate_types"]
                .as_array()
                .is_some_and(|types| types.iter().any(|kind| kind == "cdylib"));
        let files = message["filenames"].as_array().filter(|_| is_package_library)?;
        let library = files.iter().filter_map(|file| file.as_str()).find(|file| file.ends_with(".so"))?;
        Some((PathBuf::from(library), message["fresh"] == true))
    })
}

/// The output of cargo without its progress messages.
fn without_progress(cargo_output: &str) -> String {
    const PROGRESS: &[&str] = &[
        "Compiling ",
        "Finished ",
        "Fresh ",
        "Blocking ",
        "Updating ",
        "Locking ",
        "Adding ",
        "Downloading ",
        "Downloaded ",
    ];
    let is_progress = |line: &str| PROGRESS.iter().any(|word| line.trim_start().starts_with(word));
    cargo_output
        .lines()
        .filter(|line| !is_progress(line))
        .map(|line| format!("{line}\n"))
        .collect::<String>()
        .trim_start()
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_killed_cargo_is_not_reported_as_missing() {
        let message = |kind| not_run(Path::new("cargo"), Path::new("maze"), io::Error::new(kind, "why")).to_string();
        for kind in [io::ErrorKind::Interrupted, io::ErrorKind::TimedOut] {
            assert_eq!(message(kind), "the Rust program in `maze` is not built: cargo was stopped: why");
        }
        assert!(message(io::ErrorKind::NotFound).contains("install Rust"));
    }

    #[test]
    fn library_is_found_in_messages_about_its_package() {
        let manifest = Path::new("/p/maze/Cargo.toml");
        let other = r#"{"reason":"compiler-artifact","manifest_path":"/p/dep/Cargo.toml","target":{"crate_types":["cdylib"]},"filenames":["/t/libdep.so"],"fresh":true}"#;
        let ours = r#"{"reason":"compiler-artifact","manifest_path":"/p/maze/Cargo.toml","target":{"crate_types":["cdylib","rlib"]},"filenames":["/t/libmaze.rlib","/t/libmaze.so"],"fresh":false}"#;
        let script = r#"{"reason":"compiler-artifact","manifest_path":"/p/maze/Cargo.toml","target":{"crate_types":["bin"]},"filenames":["/t/build-script"],"fresh":true}"#;
        let messages = format!("not json\n{script}\n{other}\n{ours}\n");
        assert_eq!(library_of(&messages, manifest), Some((PathBuf::from("/t/libmaze.so"), false)));
        assert_eq!(library_of(other, manifest), None);
    }

    /// Writes a package named `robot` whose library contains `text`.
    fn write_package(folder: &Path, text: &str) {
        fs::create_dir_all(folder.join("src")).expect("a folder");
        let manifest = "[package]\nname = \"robot\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n[workspace]\n";
        fs::write(folder.join("Cargo.toml"), manifest).expect("a manifest");
        let source = format!("#[unsafe(no_mangle)]\npub static TEXT: [u8; {}] = *b\"{text}\";\n", text.len());
        fs::write(folder.join("src/lib.rs"), source).expect("a source");
    }

    #[test]
    fn packages_of_the_same_name_keep_their_own_libraries() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::open(&folder.path().join("cache")).expect("a cache");
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        let cargo = std::env::var_os("CARGO").map(PathBuf::from);
        let build = |package: &Path, text: &str, fresh: bool| {
            let built = build_package(package, cargo.as_deref(), &cache).unwrap_or_else(|error| panic!("{error}"));
            let bytes = fs::read(&built.library).expect("a library");
            assert!(bytes.windows(text.len()).any(|window| window == text.as_bytes()), "{text}");
            assert_eq!(built.fresh, fresh, "{text}");
            built.library
        };
        write_package(&one, "the first of two robots");
        write_package(&two, "the other of two robots");
        let library = build(&one, "the first of two robots", false);
        build(&two, "the other of two robots", false);
        build(&one, "the first of two robots", true);
        write_package(&one, "the first after a change");
        build(&one, "the first after a change", false);
        build(&two, "the other of two robots", true);
        // The state after a build that was killed before its library was copied.
        fs::remove_file(library.with_file_name("name")).expect("a note");
        build(&one, "the first after a change", false);
        build(&one, "the first after a change", true);
    }

    #[test]
    fn progress_is_removed_from_the_output() {
        let cargo_output = "   Compiling maze v0.1.0 (/p/maze)\nwarning: unused variable: `x`\n --> src/lib.rs:3:9\n    Finished `release`\n";
        assert_eq!(without_progress(cargo_output), "warning: unused variable: `x`\n --> src/lib.rs:3:9\n");
        assert_eq!(without_progress("    Finished `release`\n"), "");
    }
}
