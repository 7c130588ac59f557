// Builds the page with Node.js. Shared by `build.rs`, which embeds the page, and the crate, which builds it on demand.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::SystemTime;

/// Sources of the page, relative to its folder.
pub(crate) const SOURCES: [&str; 6] =
    ["index.html", "package-lock.json", "package.json", "src", "tsconfig.json", "vite.config.ts"];
/// Minimum major version of Node.js, required by Vite 6.
const MIN_NODE_VERSION: u32 = 18;

/// Files of the page: path and content of each.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

/// Returns the page built in `folder`. If its sources have changed since the last build, calls `report` and builds it
/// first. Only one process at a time reads or builds.
///
/// If the build fails, calls `report` and uses an older page if one exists.
pub(crate) fn built(folder: &Path, report: &mut dyn FnMut(&str)) -> Result<Files, String> {
    let io = |error: io::Error| format!("cannot build the page in `{}`: {error}", folder.display());
    let lock = File::create(folder.join(".lock")).map_err(io)?;
    lock.lock().map_err(io)?;
    let dist = folder.join("dist");
    let stamp = dist.join(".sources");
    let sources = format!("{:016x}", hash_of(folder).map_err(io)?);
    if fs::read_to_string(&stamp).is_ok_and(|stamp| stamp == sources) {
        return files_in(&dist).map_err(io);
    }
    match build(folder, report) {
        Ok(()) => fs::write(&stamp, &sources).map_err(io)?,
        Err(why) if dist.join("index.html").is_file() => report(&format!("{why}\nThe page is an older one.")),
        Err(why) => return Err(why),
    }
    files_in(&dist).map_err(io)
}

fn build(folder: &Path, report: &mut dyn FnMut(&str)) -> Result<(), String> {
    check_node()?;
    if !is_installed(folder) {
        report("installing the packages of the page (npm ci): once, some seconds");
        npm(folder, &["ci", "--no-audit", "--no-fund", "--prefer-offline", "--fetch-retries=1"])?;
    }
    report("building the page (npm run build): some seconds, only when it has changed");
    npm(folder, &["run", "build"])
}

fn check_node() -> Result<(), String> {
    let hint = format!(
        "the page is built with Node.js {MIN_NODE_VERSION} or newer and npm: install them (Debian: apt install nodejs npm); \
         everything else works without"
    );
    let version = |program: &str| {
        let output = Command::new(program).arg("--version").stdin(Stdio::null()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(node) = version("node") else { return Err(format!("there is no Node.js: {hint}")) };
    let major = node.trim_start_matches('v').split('.').next().and_then(|major| major.parse().ok());
    if major.is_none_or(|major: u32| major < MIN_NODE_VERSION) {
        return Err(format!("Node.js is {node}: {hint}"));
    }
    version("npm").map(drop).ok_or(format!("there is no npm: {hint}"))
}

/// Returns true if npm has installed the packages of the lock file.
fn is_installed(folder: &Path) -> bool {
    let modified = |path: &str| fs::metadata(folder.join(path)).and_then(|file| file.modified()).ok();
    let never = SystemTime::UNIX_EPOCH;
    modified("node_modules/.package-lock.json") >= Some(modified("package-lock.json").unwrap_or(never))
}

fn npm(folder: &Path, arguments: &[&str]) -> Result<(), String> {
    let command = format!("npm {}", arguments.join(" "));
    let output = Command::new("npm").args(arguments).current_dir(folder).stdin(Stdio::null()).output();
    let output = output.map_err(|error| format!("`{command}` cannot be run: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let messages = [output.stdout, output.stderr].concat();
    Err(format!("`{command}` failed in `{}`:\n{}", folder.display(), String::from_utf8_lossy(&messages).trim()))
}

/// FNV-1a hash of the paths and contents of the sources.
fn hash_of(folder: &Path) -> io::Result<u64> {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    let mut add = |bytes: &[u8]| {
        for byte in bytes.iter().chain(&[0]) {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for source in SOURCES {
        let path = folder.join(source);
        let files = if path.is_dir() { files_in(&path)? } else { vec![(String::new(), fs::read(&path)?)] };
        for (name, content) in files {
            add(source.as_bytes());
            add(name.as_bytes());
            add(&content);
        }
    }
    Ok(hash)
}

/// All files below a folder, sorted by path, without files and folders whose names begin with a full stop.
fn files_in(folder: &Path) -> io::Result<Files> {
    let mut files = Vec::new();
    let mut folders = vec![(folder.to_owned(), String::new())];
    while let Some((folder, prefix)) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let path: PathBuf = entry?.path();
            let Some(name) = path.file_name().and_then(|name| name.to_str()).filter(|name| !name.starts_with('.'))
            else {
                continue;
            };
            let name = format!("{prefix}{name}");
            match path.is_dir() {
                true => folders.push((path, format!("{name}/"))),
                false => files.push((name, fs::read(&path)?)),
            }
        }
    }
    files.sort();
    Ok(files)
}
