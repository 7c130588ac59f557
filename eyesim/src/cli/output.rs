//! Lines on the standard streams, which may be closed or full, and checks of output files before a command begins.

use std::io::{self, ErrorKind, Write as _};
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::builder::{PathBufValueParser, TypedValueParser};
use parking_lot::Mutex;
use sim_host::record::log::Printable;

/// First error of [`put`] that nobody has taken yet.
static FAILURE: Mutex<Option<io::Error>> = Mutex::new(None);

/// Prints a line on standard output, as [`put`] does.
pub fn tell(line: impl std::fmt::Display) {
    put(&format!("{line}\n"));
}

/// Prints text on standard output. An error is kept for [`take_failure`], so that a command still writes its files; a
/// closed pipe (`| head`) is not an error.
pub fn put(text: &str) {
    let mut out = io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && error.kind() != ErrorKind::BrokenPipe
    {
        FAILURE.lock().get_or_insert(error);
    }
}

/// Prints to standard output; a closed pipe is not an error.
///
/// # Errors
/// Standard output cannot be written to.
pub fn print(text: &str) -> anyhow::Result<()> {
    put(text);
    take_failure()
}

/// Reports an error of [`put`] once.
///
/// # Errors
/// Standard output could not be written to.
pub fn take_failure() -> anyhow::Result<()> {
    FAILURE.lock().take().map_or(Ok(()), |error| Err(error).context("standard output"))
}

/// The error and its causes, except those that the text before them ends with.
pub fn causes(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .reduce(|text, cause| if text.ends_with(&cause) { text } else { format!("{text}: {cause}") })
        .unwrap_or_default()
}

/// Prints text on standard error, if that can be written to.
pub fn print_error(text: &str) {
    // There is no other stream for the error.
    _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Prints lines on standard error. They may quote programs and foreign files: control characters, which a terminal
/// would interpret, are shown as escapes.
pub fn say(text: impl std::fmt::Display) {
    for line in text.to_string().lines() {
        print_error(&format!("{}\n", Printable(line)));
    }
}

/// Identity of the files behind standard output and standard error, which programs on threads of this process can
/// replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StandardStreams([Option<[u64; 3]>; 2]);

impl StandardStreams {
    /// The current standard streams.
    pub fn current() -> Self {
        Self([1, 2].map(|descriptor| {
            let metadata = std::fs::metadata(format!("/proc/self/fd/{descriptor}")).ok()?;
            Some([metadata.dev(), metadata.ino(), metadata.rdev()])
        }))
    }

    /// Checks that the standard streams are still these files.
    ///
    /// # Errors
    /// A program has closed or replaced a stream.
    pub fn check(&self) -> anyhow::Result<()> {
        if Self::current() == *self {
            return Ok(());
        }
        bail!(
            "a program has closed or replaced the descriptors of standard output or standard error: what was printed since is lost \
             (`--exec process` keeps such a program apart)"
        )
    }
}

/// Parser of the name of an output; `-`, which stands for standard output in other commands, is refused.
pub fn output_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path.as_os_str() == "-" {
        true => Err("standard output is not supported here; `./-` has this name"),
        false => Ok(path),
    })
}

/// Checks that the files to be written lie in existing folders, can be written, and overwrite neither an input nor each
/// other.
///
/// `outputs` are options with their file names; `inputs` are the files that are read.
///
/// # Errors
/// The first of `outputs` that fails the check.
pub fn check_outputs<'a>(outputs: &[(&str, &Path)], inputs: impl Iterator<Item = &'a str>) -> anyhow::Result<()> {
    let mut seen_files: Vec<(String, PathBuf)> = Vec::new();
    for input in inputs {
        if let Ok(path) = std::fs::canonicalize(input) {
            seen_files.push((format!("the input `{input}`"), path));
        }
    }
    for (option, path) in outputs {
        let path_text = path.display();
        if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            bail!("{option} `{path_text}` is a folder, expected a file");
        }
        let target = link_target(path);
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = std::fs::canonicalize(folder)
            .with_context(|| format!("{option} `{path_text}`: there is no folder `{}`", folder.display()))?;
        let canonical =
            std::fs::canonicalize(path).unwrap_or_else(|_| folder.join(target.file_name().unwrap_or_default()));
        if canonical.is_dir() {
            bail!("{option} `{path_text}` is a folder, expected a file");
        }
        // Devices such as /dev/null take any number of outputs.
        if canonical.starts_with("/dev") && canonical.exists() && !canonical.is_file() {
            continue;
        }
        if let Some((owner, _)) = seen_files.iter().find(|(_, other)| is_same_file(other, &canonical)) {
            bail!("{option} `{path_text}` would overwrite {owner}");
        }
        check_writable(&canonical, &folder).with_context(|| format!("{option} `{path_text}` cannot be written"))?;
        seen_files.push((format!("what {option} writes"), canonical));
    }
    Ok(())
}

/// Checks that the file `path` can be opened for writing, or created in `folder`; changes neither.
fn check_writable(path: &Path, folder: &Path) -> io::Result<()> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => std::fs::OpenOptions::new().write(true).open(path).map(drop),
        // Opening a pipe waits for its reader.
        Ok(_) => Ok(()),
        Err(_) => tempfile::tempfile_in(folder).map(drop),
    }
}

/// The file that would be created through `path`: the target of a dangling symbolic link, otherwise `path`.
fn link_target(path: &Path) -> PathBuf {
    match std::fs::read_link(path) {
        Ok(target) if !path.exists() => path.parent().unwrap_or(Path::new("")).join(target),
        _ => path.to_owned(),
    }
}

/// Returns true if both canonical paths refer to one file, possibly by two hard links.
fn is_same_file(a: &Path, b: &Path) -> bool {
    let identity = |path: &Path| std::fs::metadata(path).map(|metadata| (metadata.dev(), metadata.ino())).ok();
    a == b || identity(a).is_some_and(|file| identity(b) == Some(file))
}

/// Options that the user has given, with their files.
pub fn given_outputs<'a>(options: &[(&'a str, &'a Option<PathBuf>)]) -> Vec<(&'a str, &'a Path)> {
    options.iter().filter_map(|(option, path)| Some((*option, path.as_deref()?))).collect()
}
