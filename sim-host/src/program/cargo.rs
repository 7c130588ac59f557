//! Builds a robot program that is a Cargo package; cargo decides if it is up to date.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::cache::Cache;
use super::command::{CARGO_TIMEOUT, build_output, build_timeout};

/// A package that was built.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// Its shared library.
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
        /// Why it does not start.
        error: io::Error,
    },
    /// cargo does not end.
    #[error("the Rust program in `{}` does not build: cargo ran too long: {error}", folder.display())]
    Endless {
        /// The package's folder.
        folder: PathBuf,
        /// The limit.
        error: io::Error,
    },
    /// cargo ends with an error; its messages follow unchanged.
    #[error("the Rust program in `{}` does not build:\n{output}", folder.display())]
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
    /// The folder for cargo's output cannot be created.
    #[error("cannot make a folder for the build of `{}`: {error}", folder.display())]
    Io {
        /// The package's folder.
        folder: PathBuf,
        /// Why.
        error: io::Error,
    },
}

/// Variables of a cargo that runs this process (its job server and its data about the package), which would disturb the cargo
/// started here.
const FOREIGN_VARIABLES: &[&str] =
    &["MAKEFLAGS", "MFLAGS", "CARGO_MAKEFLAGS", "CARGO_MANIFEST_DIR", "CARGO_MANIFEST_PATH"];

/// Builds the package in `folder` in release mode, always with line tables and unwinding, regardless of its profile.
///
/// The target folder is in `cache`, one for each workspace: never one that a `cargo run` or `cargo test` around this process
/// may have locked.
///
/// # Errors
/// [`CargoError`].
pub fn build_package(folder: &Path, cargo: Option<&Path>, cache: &Cache) -> Result<Package, CargoError> {
    let cargo = cargo.unwrap_or(Path::new("cargo"));
    let io_error = |error| CargoError::Io { folder: folder.to_owned(), error };
    let manifest = std::fs::canonicalize(folder.join("Cargo.toml")).map_err(io_error)?;
    let missing = |error| CargoError::Missing { cargo: cargo.to_owned(), folder: folder.to_owned(), error };
    let workspace = workspace_manifest(cargo, &manifest).map_err(missing)?;
    let name = &blake3::hash(workspace.as_os_str().as_encoded_bytes()).to_hex()[..16];
    let target = cache.folder("cargo").map_err(io_error)?.join(name);

    let mut command = cargo_command(cargo, &manifest);
    command.args(["build", "--lib", "--release", "--message-format=json-render-diagnostics"]);
    command.arg("--manifest-path").arg(&manifest).arg("--target-dir").arg(target);
    for (name, value) in [("DEBUG", "line-tables-only"), ("PANIC", "unwind"), ("STRIP", "none")] {
        command.env(format!("CARGO_PROFILE_RELEASE_{name}"), value);
    }
    let output = match build_output(&mut command, build_timeout(CARGO_TIMEOUT)) {
        Err(error) if error.kind() == io::ErrorKind::TimedOut => {
            return Err(CargoError::Endless { folder: folder.to_owned(), error });
        }
        output => output.map_err(missing)?,
    };
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let messages = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        let folder = folder.to_owned();
        return Err(if said.contains("no library targets found") {
            CargoError::NoLibrary { folder }
        } else {
            CargoError::Refused { folder, output: without_progress(&said) }
        });
    }
    let (library, fresh) =
        library_of(&messages, &manifest).ok_or_else(|| CargoError::NoLibrary { folder: folder.to_owned() })?;
    Ok(Package { library, output: without_progress(&said), fresh })
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

/// The manifest of the workspace of `manifest`, or `manifest` itself if cargo fails (the build then reports the reason).
fn workspace_manifest(cargo: &Path, manifest: &Path) -> io::Result<PathBuf> {
    let mut command = cargo_command(cargo, manifest);
    command.args(["locate-project", "--workspace", "--message-format=plain", "--manifest-path"]).arg(manifest);
    let output = build_output(&mut command, build_timeout(CARGO_TIMEOUT))?;
    let said = String::from_utf8_lossy(&output.stdout);
    Ok(if output.status.success() { PathBuf::from(said.trim()) } else { manifest.to_owned() })
}

/// The shared library of the package, and true if it was up to date, from cargo's messages (one JSON value a line).
fn library_of(messages: &str, manifest: &Path) -> Option<(PathBuf, bool)> {
    messages.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok()).find_map(|message| {
        let is_ours = message["reason"] == "compiler-artifact"
            && message["manifest_path"].as_str().is_some_and(|path| Path::new(path) == manifest)
            && message["target"]["crate_types"]
                .as_array()
                .is_some_and(|types| types.iter().any(|kind| kind == "cdylib"));
        let files = message["filenames"].as_array().filter(|_| is_ours)?;
        let library = files.iter().filter_map(|file| file.as_str()).find(|file| file.ends_with(".so"))?;
        Some((PathBuf::from(library), message["fresh"] == true))
    })
}

/// The output of cargo without its progress messages.
fn without_progress(said: &str) -> String {
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
    let progress = |line: &str| PROGRESS.iter().any(|word| line.trim_start().starts_with(word));
    said.lines().filter(|line| !progress(line)).map(|line| format!("{line}\n")).collect::<String>().trim_start().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_taken_from_the_messages_of_the_right_package() {
        let manifest = Path::new("/p/maze/Cargo.toml");
        let other = r#"{"reason":"compiler-artifact","manifest_path":"/p/dep/Cargo.toml","target":{"crate_types":["cdylib"]},"filenames":["/t/libdep.so"],"fresh":true}"#;
        let ours = r#"{"reason":"compiler-artifact","manifest_path":"/p/maze/Cargo.toml","target":{"crate_types":["cdylib","rlib"]},"filenames":["/t/libmaze.rlib","/t/libmaze.so"],"fresh":false}"#;
        let script = r#"{"reason":"compiler-artifact","manifest_path":"/p/maze/Cargo.toml","target":{"crate_types":["bin"]},"filenames":["/t/build-script"],"fresh":true}"#;
        let messages = format!("not json\n{script}\n{other}\n{ours}\n");
        assert_eq!(library_of(&messages, manifest), Some((PathBuf::from("/t/libmaze.so"), false)));
        assert_eq!(library_of(other, manifest), None);
    }

    #[test]
    fn progress_is_left_out_of_the_warnings() {
        let said = "   Compiling maze v0.1.0 (/p/maze)\nwarning: unused variable: `x`\n --> src/lib.rs:3:9\n    Finished `release`\n";
        assert_eq!(without_progress(said), "warning: unused variable: `x`\n --> src/lib.rs:3:9\n");
        assert_eq!(without_progress("    Finished `release`\n"), "");
    }
}
