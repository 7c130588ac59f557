//! Finds the program that a sim file or the command line names: a library, C or C++ sources, a Cargo package, a Python
//! file, or code of the embedding process.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::io::Read as _;
use std::path::{Component, Path, PathBuf};

use super::calls::included_file;
use super::embedded::EmbeddedProgram;
use super::generation::GenerationHint;
use super::kind::{FileKind, HEAD_BYTES, file_kind};
use super::language::{Language, without_txt};
use super::parts::parts_of;
use crate::files::{open_regular, walk};
use sim_format::path::{is_absolute, relocated_candidates};

/// Folders that are searched for programs, in this order: the sim file's folder, the working folder, further folders.
#[derive(Clone, Debug, Default)]
pub struct SearchPath {
    /// Folder of the sim file that names the program; `None` for a program named on the command line.
    pub sim_folder: Option<PathBuf>,
    /// The working folder of this process.
    pub working_folder: PathBuf,
    /// Further folders, such as those of `--programs`.
    pub folders: Vec<PathBuf>,
    /// The folder of the installation: the value of `%sim%`, and the root for absolute names that do not exist.
    pub installation: Option<PathBuf>,
    /// Programs of the process that embeds the simulator, found by their references before any file.
    pub embedded: Vec<EmbeddedProgram>,
}

/// Source of a program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ProgramSource {
    /// A shared library, loaded as it is.
    Library(PathBuf),
    /// C and C++ sources, each compiled in the language of its extension, and linked together.
    Sources {
        /// The sources.
        files: Vec<PathBuf>,
        /// The generation that the user or the scene states.
        hint: GenerationHint,
    },
    /// The folder of a Cargo package with a `cdylib` target.
    Cargo(PathBuf),
    /// A Python program.
    Python(PathBuf),
    /// Code of the process that embeds the simulator.
    Embedded(EmbeddedProgram),
}

impl ProgramSource {
    /// C and C++ sources whose generation is not stated.
    pub fn of_files(files: Vec<PathBuf>) -> Self {
        Self::Sources { files, hint: GenerationHint::default() }
    }

    /// The files that are built or loaded; none for a Cargo package, which Cargo searches.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Sources { files, .. } => files.clone(),
            Self::Library(path) | Self::Python(path) => vec![path.clone()],
            Self::Embedded(_) | Self::Cargo(_) => Vec::new(),
        }
    }

    /// Headers and modules in the folders of the program's files, see [`parts_of`].
    pub fn parts(&self) -> Vec<PathBuf> {
        match self {
            Self::Sources { files, .. } => files.iter().flat_map(|file| parts_of(file)).collect(),
            Self::Python(file) => parts_of(file),
            Self::Library(_) | Self::Embedded(_) | Self::Cargo(_) => Vec::new(),
        }
    }

    /// The files that a user edits to change the program: those that are built or loaded, with their parts; of a package,
    /// the Rust and TOML files of its folder, without those of other packages in it.
    pub fn sources(&self) -> Vec<PathBuf> {
        let Self::Cargo(folder) = self else { return [self.files(), self.parts()].concat() };
        let mut sources = Vec::new();
        let mut add = |file: &Path| {
            let is_source = file.extension().is_some_and(|extension| extension == "rs" || extension == "toml");
            sources.extend(is_source.then(|| file.to_owned()));
        };
        walk(folder, &mut add, &mut |_unreadable, _error| {});
        // The files of the folder itself come first, and so does the package's own manifest.
        let manifests = sources.iter().filter(|file| file.ends_with("Cargo.toml")).skip(1);
        let others: Vec<PathBuf> = manifests.filter_map(|file| Some(file.parent()?.to_owned())).collect();
        sources.retain(|file| !others.iter().any(|other| file.starts_with(other)));
        sources
    }

    /// The path that represents the program in messages: the library, the first source, the package's folder, the
    /// Python file, or the reference of an embedded program.
    pub fn path(&self) -> &Path {
        match self {
            Self::Library(path) | Self::Cargo(path) | Self::Python(path) => path,
            Self::Embedded(program) => Path::new(&program.reference),
            Self::Sources { files, .. } => files.first().map_or(Path::new(""), PathBuf::as_path),
        }
    }
}

/// A program that was found, with notes about the search.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// The program's name, its `argv[0]`: the name of the file, without folder and extension, or of the folder.
    pub name: String,
    /// The source to build or load.
    pub source: ProgramSource,
    /// Remarks such as "`maze.dll` is a Windows library or program: `maze.c` beside it is used instead".
    pub notes: Vec<String>,
}

impl Found {
    /// Sets the stated generation, if the program is built from sources.
    pub fn with_hint(mut self, new_hint: GenerationHint) -> Self {
        if let ProgramSource::Sources { hint, .. } = &mut self.source {
            *hint = new_hint;
        }
        self
    }
}

/// A path that was searched without success.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attempt {
    /// The path that was tried.
    pub path: PathBuf,
    /// Description of an unusable file or folder at the path; `None` if nothing is there.
    pub problem: Option<String>,
}

/// A search without a usable result: all attempts, and similar names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FindError {
    /// The reference, as the user wrote it.
    pub reference: String,
    /// Every path tried, in order.
    pub attempts: Vec<Attempt>,
    /// Programs in the searched folders that have a similar name.
    pub similar: Vec<String>,
}

impl std::error::Error for FindError {}

impl std::fmt::Display for FindError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let foreign: Vec<&Attempt> = self.attempts.iter().filter(|attempt| attempt.problem.is_some()).collect();
        match foreign.as_slice() {
            [] => write!(f, "program `{}` is not found", self.reference)?,
            _ => write!(f, "program `{}` cannot be run here", self.reference)?,
        }
        let mut folder = None;
        for Attempt { path, problem } in &self.attempts {
            match (problem, path.file_name()) {
                (Some(what), _) => write!(f, "\n  `{}` is {what}", path.display())?,
                (None, Some(name)) if folder == Some(path.parent()) => write!(f, ", `{}`", name.display())?,
                (None, _) => write!(f, "\n  tried `{}`", path.display())?,
            }
            folder = problem.is_none().then(|| path.parent());
        }
        // For a source of another language, the attempt's description contains the advice.
        let is_source = |path: &Path| Language::of(path).is_some() || is_python(path) || other_language(path).is_some();
        if foreign.iter().any(|attempt| !is_source(&attempt.path) && !attempt.path.is_dir()) {
            f.write_str(
                "\n  put its source beside it: a `.c` or `.cpp` file, or a folder with a Cargo package, of the same name",
            )?;
        }
        match self.similar.as_slice() {
            [] => Ok(()),
            names => write!(f, "\n  did you mean {}?", quoted(names)),
        }
    }
}

fn quoted(names: &[String]) -> String {
    let mut text = String::new();
    for (index, name) in names.iter().enumerate() {
        let between = if index == 0 { "" } else { " or " };
        // Writing to a string does not fail.
        let _ = write!(text, "{between}`{name}`");
    }
    text
}

/// Finds the program that `reference` names.
///
/// `reference` names an embedded program, or is a path to a shared library, a Python file, a C or C++ file, several C
/// or C++ files separated by commas (`main.cpp,map.c`), a folder of such files, or the folder of a Cargo package (or
/// its `Cargo.toml`). Backslashes separate folders too, and `%sim%` is the installation.
///
/// In each folder of the [`SearchPath`], the name itself is tried first, then the sources from which a `Makefile`
/// beside the named file builds it, then the sources and libraries of the same name in this file's folder. If no folder
/// has such a program, sources with a further extension `.txt` are tried. If these do not exist either, the path is
/// searched below the sim file's folder, like the paths of worlds, and then all names without regard to upper and lower
/// case.
///
/// # Errors
/// [`FindError`] with every path tried if nothing usable is found.
pub fn find_program(reference: &str, search: &SearchPath) -> Result<Found, FindError> {
    if let Some(program) = search.embedded.iter().find(|program| program.reference == reference) {
        let source = ProgramSource::Embedded(program.clone());
        return Ok(Found { name: program.name.clone(), source, notes: Vec::new() });
    }
    let mut finder = Finder { search, attempts: Vec::new(), notes: Vec::new(), folder_name: None };
    if let Some(source) = finder.find(reference) {
        return Ok(finder.found(source));
    }
    let parts: Vec<&str> = reference.split(',').map(str::trim).collect();
    if parts.len() > 1 && parts.iter().all(|part| Language::of(Path::new(part)).is_some()) {
        finder.attempts.clear();
        let sources: Option<Vec<PathBuf>> = parts.iter().map(|part| finder.find_source_file(part)).collect();
        if let Some(source) = sources.map(ProgramSource::of_files) {
            return Ok(finder.found(source));
        }
    } else if let Some(source) = finder.find_elsewhere(reference) {
        return Ok(finder.found(source));
    }
    let similar = finder.similar_names(reference);
    Err(FindError { reference: reference.to_owned(), attempts: finder.attempts, similar })
}

/// The name of the file or folder `path`; of a file without its extension.
fn program_name(path: &Path) -> String {
    // Resolves `.` and `..`, so that they get a name too.
    let absolute = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let name = if absolute.is_dir() { absolute.file_name() } else { without_txt(&absolute).file_stem() };
    name.map_or_else(|| "program".into(), |name| name.to_string_lossy().into_owned())
}

struct Finder<'a> {
    search: &'a SearchPath,
    attempts: Vec<Attempt>,
    notes: Vec<String>,
    /// The name of the folder, if a folder was found.
    folder_name: Option<String>,
}

impl Finder<'_> {
    fn found(self, source: ProgramSource) -> Found {
        let name = self.folder_name.unwrap_or_else(|| program_name(source.path()));
        Found { name, source, notes: self.notes }
    }

    fn find(&mut self, reference: &str) -> Option<ProgramSource> {
        let paths = self.candidates(reference);
        let found = paths.iter().find_map(|path| self.search_at(path));
        found.or_else(|| paths.iter().find_map(|path| self.source_with_txt(path)))
    }

    /// Searches for a path from another machine, or of another arrangement of folders, below the sim file's folder,
    /// then for all names without regard to upper and lower case.
    fn find_elsewhere(&mut self, reference: &str) -> Option<ProgramSource> {
        let attempt_count = self.attempts.len();
        let text = |path: &Path| path.to_str().map(str::to_owned);
        let folder = text(self.search.sim_folder.as_deref().unwrap_or(&self.search.working_folder))?;
        let installation = self.search.installation.as_deref().and_then(text);
        // `~/eyesim/maze.x`
        let path = reference.trim().trim_start_matches('~');
        // A mistyped relative path on the command line must not run another program of this name.
        let may_move = self.search.sim_folder.is_some() || is_absolute(&path.replace('\\', "/"));
        let moved = may_move.then(|| relocated_candidates(path, &folder, installation.as_deref()));
        let moved: Vec<PathBuf> = moved.into_iter().flatten().map(PathBuf::from).collect();
        let all = moved.iter().cloned().chain(self.candidates(reference));
        let other_case: Vec<PathBuf> = all.filter_map(|path| in_other_case(&path)).collect();
        let source = moved.iter().chain(&other_case).find_map(|path| self.search_at(path));
        // The paths of the usual search are enough for a message.
        self.attempts.truncate(attempt_count);
        let source = source?;
        self.notes.push(format!("`{reference}` does not exist: `{}` is used instead", source.path().display()));
        Some(source)
    }

    fn find_source_file(&mut self, part: &str) -> Option<PathBuf> {
        match self.find(part).or_else(|| self.find_elsewhere(part))? {
            ProgramSource::Sources { mut files, .. } if files.len() == 1 => files.pop(),
            _ => None,
        }
    }

    /// The possible paths of `reference`, in the order of the search and each once.
    fn candidates(&self, reference: &str) -> Vec<PathBuf> {
        let search = self.search;
        let mut name = reference.trim().replace('\\', "/");
        if let Some(rest) = strip_prefix_ignoring_case(&name, "%sim%") {
            name = match &search.installation {
                Some(installation) => format!("{}/{}", installation.display(), rest.trim_start_matches('/')),
                None => rest.trim_start_matches('/').to_owned(),
            };
        }
        let mut bases: Vec<&Path> = Vec::new();
        bases.extend(search.sim_folder.as_deref());
        bases.push(&search.working_folder);
        bases.extend(search.folders.iter().map(PathBuf::as_path));
        let mut folders = Vec::new();
        bases.retain(|base| {
            // The folder of a sim file in the working folder is empty.
            let base = if base.as_os_str().is_empty() { Path::new(".") } else { base };
            let folder = fs::canonicalize(base).unwrap_or_else(|_| base.to_path_buf());
            let is_new = !folders.contains(&folder);
            folders.push(folder);
            is_new
        });
        let mut paths = Vec::new();
        let has_drive = matches!(name.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic());
        if has_drive {
            // `C:\eyesim\maze.dll`: there is no such drive here, but the file may exist in the folders.
            name = name.rsplit(['/', ':']).next().unwrap_or_default().to_owned();
        }
        if Path::new(&name).is_absolute() {
            paths.push(PathBuf::from(&name));
            // `/programs/maze.so` in old sim files is a path below the installation.
            bases.clear();
            bases.extend(search.installation.as_deref());
            bases.extend(search.sim_folder.as_deref());
        }
        let relative = name.trim_start_matches('/');
        if !relative.is_empty() {
            paths.extend(bases.iter().map(|base| tidy(&base.join(relative))));
        }
        let mut seen = Vec::new();
        paths.retain(|path| {
            !seen.contains(path) && {
                seen.push(path.clone());
                true
            }
        });
        paths
    }

    /// The program at `path`, or its replacement in the same folder; unusable files are added to the attempts.
    fn search_at(&mut self, path: &Path) -> Option<ProgramSource> {
        let first_problem = match self.program_at(path) {
            Ok(source) => return Some(source),
            Err(first_problem) => first_problem,
        };
        self.attempts.push(Attempt { path: path.to_owned(), problem: first_problem.clone() });
        if let Some(files) = sources_in_makefile(path) {
            if let [first, _, ..] = files.as_slice() {
                let (count, first) = (files.len(), first.display());
                self.notes.push(format!(
                    "`{}` is built from `{first}` and {} more, as `Makefile` says",
                    path.display(),
                    count - 1
                ));
            }
            return Some(ProgramSource::of_files(files));
        }
        for replacement in replacement_paths(path) {
            match self.program_at(&replacement) {
                Ok(source) => {
                    if let Some(description) = first_problem {
                        let (path, replacement) = (path.display(), replacement.display());
                        let description = description.split(':').next().unwrap_or_default();
                        self.notes
                            .push(format!("`{path}` is {description}: `{replacement}` beside it is used instead"));
                    }
                    return Some(source);
                }
                Err(problem) => self.attempts.push(Attempt { path: replacement, problem }),
            }
        }
        None
    }

    /// The source that was saved as `maze.c.txt` instead of `maze.c`, for the program `path`.
    fn source_with_txt(&mut self, path: &Path) -> Option<ProgramSource> {
        let sources = std::iter::once(path.to_owned()).chain(replacement_paths(path));
        let is_source = |path: &PathBuf| Language::of(path).is_some() || has_extension(path, "py");
        let mut renamed = sources.filter(is_source).map(|source| source.with_added_extension("txt"));
        let (found, source) = renamed.find_map(|path| Some((path.clone(), self.program_at(&path).ok()?)))?;
        self.notes.push(format!("`{}` is used for `{}`", found.display(), path.display()));
        Some(source)
    }

    /// The program at `path`; the error describes an unusable file or folder there (`None` if nothing is there).
    fn program_at(&mut self, path: &Path) -> Result<ProgramSource, Option<String>> {
        let Ok(metadata) = fs::metadata(path) else { return Err(None) };
        if metadata.is_dir() {
            let source = program_in_folder(path)?;
            self.folder_name = Some(program_name(path));
            return Ok(source);
        }
        if path.file_name().is_some_and(|name| name == "Cargo.toml") {
            // The folder of a sim file in the working folder is empty.
            return Ok(ProgramSource::Cargo(tidy(path.parent().unwrap_or(Path::new("")))));
        }
        let head = read_head(path).map_err(|error| Some(format!("unreadable ({error})")))?;
        if Language::of(path).is_some() {
            return Ok(ProgramSource::of_files(vec![path.to_owned()]));
        }
        if is_python(path) {
            return Ok(ProgramSource::Python(path.to_owned()));
        }
        if let Some(language) = other_language(path) {
            return Err(Some(language.to_owned()));
        }
        match file_kind(&head) {
            FileKind::Library => {
                self.note_newer_source(path);
                Ok(ProgramSource::Library(path.to_owned()))
            }
            FileKind::Foreign(what) => Err(Some(what)),
        }
    }

    fn note_newer_source(&mut self, library: &Path) {
        let modified = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
        let is_newer = |source: &PathBuf| modified(source) > modified(library);
        if let Some(source) = sources_of_name(&library.with_extension("")).into_iter().find(is_newer) {
            let (library, source) = (library.display(), source.display());
            self.notes.push(format!("`{library}` is older than `{source}` beside it: name the source to build it"));
        }
    }

    /// Up to three programs in the searched folders whose names are similar to the requested one.
    fn similar_names(&self, reference: &str) -> Vec<String> {
        let mut similar: Vec<(usize, String)> = Vec::new();
        for path in self.candidates(reference) {
            let (Some(folder), Some(requested)) = (path.parent(), path.file_stem().and_then(|stem| stem.to_str()))
            else {
                continue;
            };
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let path = tidy(&entry.path());
                let Some(stem) = path.file_stem().and_then(|stem| stem.to_str()) else { continue };
                let distance = strsim::osa_distance(&stem.to_lowercase(), &requested.to_lowercase());
                let is_tried = self.attempts.iter().any(|attempt| attempt.path == path);
                if distance <= (requested.chars().count() / 3).max(1) && !is_tried && looks_like_program(&path) {
                    similar.push((distance, path.display().to_string()));
                }
            }
        }
        similar.sort();
        similar.dedup();
        similar.into_iter().map(|(_, name)| name).take(3).collect()
    }
}

/// Maximum number of bytes of a source in which lines `#include` are searched.
const MAX_SCANNED: u64 = 1 << 20;

fn program_in_folder(folder: &Path) -> Result<ProgramSource, Option<String>> {
    if folder.join("Cargo.toml").is_file() {
        return Ok(ProgramSource::Cargo(folder.to_owned()));
    }
    let entries = fs::read_dir(folder).map_err(|error| Some(format!("an unreadable folder ({error})")))?;
    let is_source = |path: &PathBuf| Language::of(path).is_some() && path.is_file();
    let mut sources: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_source).collect();
    // Otherwise a copy `main.c.txt` would be compiled beside `main.c`.
    if sources.iter().any(|source| !has_extension(source, "txt")) {
        sources.retain(|source| !has_extension(source, "txt"));
    }
    sources.sort();
    let included: BTreeSet<PathBuf> = sources.iter().flat_map(|source| included_sources(source)).collect();
    sources.retain(|source| !included.contains(source));
    if sources.is_empty() {
        Err(Some("a folder without `Cargo.toml`, `.c` or `.cpp` files".into()))
    } else {
        Ok(ProgramSource::of_files(sources))
    }
}

/// The sources that `source` includes, which are parts of it: `#include "map.c"`.
fn included_sources(source: &Path) -> Vec<PathBuf> {
    let mut text = Vec::new();
    // An unreadable source is an error of its compilation.
    _ = open_regular(source).and_then(|file| file.take(MAX_SCANNED).read_to_end(&mut text));
    let text = String::from_utf8_lossy(&text);
    let included = text.lines().filter_map(included_file).map(|name| source.with_file_name(name));
    included.filter(|path| Language::of(path).is_some() && path != source).collect()
}

/// Paths of possible sources for a program `maze`: `maze.c`, then the C++ sources.
fn sources_of_name(stem: &Path) -> Vec<PathBuf> {
    let extensions = Language::ALL.into_iter().flat_map(Language::extensions);
    extensions.map(|extension| stem.with_added_extension(extension)).collect()
}

/// Paths of sources and libraries that may replace the file `path`: `maze.c`, `maze.cpp`, `maze.cc`, `maze.cxx`,
/// `maze.c++`, the folder or package `maze`, `maze.so`. Empty if `path` has an extension other than those of programs
/// that are not in C or C++, libraries and object files.
fn replacement_paths(path: &Path) -> Vec<PathBuf> {
    const REPLACED: [&str; 7] = ["dll", "exe", "x", "so", "py", "hex", "o"];
    let is_replaced = path.extension().is_none() || REPLACED.iter().any(|extension| has_extension(path, extension));
    if !is_replaced || path.file_name().is_none() {
        return Vec::new();
    }
    let stem = path.with_extension("");
    let mut paths = sources_of_name(&stem);
    if stem != path {
        paths.push(stem.clone());
    }
    // Last, since it may be older than its source, or built for another simulator.
    if stem != path && !has_extension(path, "so") {
        paths.push(stem.with_added_extension("so"));
    }
    // `libmaze.so` is not tried: the Cargo package `maze`, from which it is built, is.
    paths
}

/// The sources from which the `Makefile` beside the program `path` builds it, as in `maze.x: main.c map.o`; `None` if
/// there is no such file or rule, the rule has functions, or a source does not exist. Variables are replaced, patterns
/// are not. Prerequisites that are no sources, such as headers and the `Makefile` itself, are ignored.
fn sources_in_makefile(path: &Path) -> Option<Vec<PathBuf>> {
    /// Larger files and rules are not written by hand.
    const MAX_BYTES: usize = 1 << 20;
    if replacement_paths(path).is_empty() {
        return None;
    }
    let (folder, target) = (path.parent()?, path.file_name()?.to_str()?);
    let mut text = String::new();
    let file = ["Makefile", "makefile"].iter().find_map(|name| open_regular(&folder.join(name)).ok())?;
    file.take(MAX_BYTES as u64).read_to_string(&mut text).ok()?;
    let text = text.replace("\\\n", " ");
    let variables: Vec<(&str, &str)> = text
        .lines()
        .filter_map(|line| line.split_once('='))
        .map(|(name, value)| (name.trim_end_matches([' ', ':']), value))
        .collect();
    let rule = text.lines().find_map(|line| {
        let (targets, sources) = line.split_once(':')?;
        targets.split_whitespace().any(|name| name == target).then_some(sources)
    })?;
    let mut sources = rule.split('#').next()?.to_owned();
    for (name, value) in &variables {
        sources = sources.replace(&format!("$({name})"), value).replace(&format!("${{{name}}}"), value);
        if sources.len() > MAX_BYTES {
            return None;
        }
    }
    let source = |name: &str| {
        let path = tidy(&folder.join(name));
        let sources = if has_extension(&path, "o") { sources_of_name(&path.with_extension("")) } else { vec![path] };
        sources.into_iter().find(|path| Language::of(path).is_some() && path.is_file())
    };
    // A `$` begins a function, whose sources are unknown.
    let is_source = |name: &&str| {
        let path = Path::new(name);
        has_extension(path, "o") || Language::of(path).is_some() || name.contains('$')
    };
    let files: Option<Vec<PathBuf>> = sources.split_whitespace().filter(is_source).map(source).collect();
    files.filter(|files| !files.is_empty())
}

/// An existing path that matches the missing `path` without regard to upper and lower case, or that differs from such a
/// match only in the extension and may replace the program `path`; `None` if there is no such path.
fn in_other_case(path: &Path) -> Option<PathBuf> {
    let mut found = PathBuf::new();
    let mut components = path.components().peekable();
    while let Some(component) = components.next() {
        let next = found.join(component);
        if next.symlink_metadata().is_ok() {
            found = next;
            continue;
        }
        let folder = if found.as_os_str().is_empty() { Path::new(".") } else { &found };
        let mut entries: Vec<PathBuf> = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
        entries.sort();
        let wanted = Path::new(component.as_os_str());
        let is_named = |entry: &&PathBuf| entry.file_name().is_some_and(|name| name.eq_ignore_ascii_case(wanted));
        if let Some(entry) = entries.iter().find(is_named) {
            found.push(entry.file_name()?);
            continue;
        }
        let is_replaceable = components.peek().is_none() && !replacement_paths(wanted).is_empty();
        let stem = wanted.file_stem()?;
        let is_replacement = |entry: &&PathBuf| {
            looks_like_program(entry) && entry.file_stem().is_some_and(|name| name.eq_ignore_ascii_case(stem))
        };
        let mut replacements = entries.iter().filter(is_replacement).filter(|_| is_replaceable);
        // A source before a library, which may be older.
        let replacement =
            replacements.clone().find(|entry| Language::of(entry).is_some()).or_else(|| replacements.next());
        return Some(found.join(replacement?.file_name()?));
    }
    (found != path).then_some(found)
}

/// Description of a Rust source or a header, neither of which is a program itself; completes "it is ...". `None` for
/// other extensions.
fn other_language(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    match extension.as_str() {
        "rs" => Some("a Rust source: name the folder of its Cargo package"),
        "h" | "hh" | "hpp" | "hxx" => Some("a header: name the `.c` or `.cpp` file"),
        _ => None,
    }
}

/// Returns true for the name of a Python program, `maze.py` or `maze.py.txt`.
pub(crate) fn is_python(path: &Path) -> bool {
    has_extension(without_txt(path), "py")
}

fn looks_like_program(path: &Path) -> bool {
    has_extension(path, "so")
        || is_python(path)
        || Language::of(path).is_some()
        || path.is_dir() && path.join("Cargo.toml").is_file()
}

fn read_head(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut head = Vec::new();
    open_regular(path)?.take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    Ok(head)
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn strip_prefix_ignoring_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// `path` without `.` and empty components; `..` is kept, since a folder may be a symbolic link.
fn tidy(path: &Path) -> PathBuf {
    let tidied: PathBuf = path.components().filter(|component| *component != Component::CurDir).collect();
    if tidied.as_os_str().is_empty() { PathBuf::from(".") } else { tidied }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct TestFolder {
        folder: tempfile::TempDir,
        search: SearchPath,
    }

    impl TestFolder {
        /// A folder with `files`, searched in `sims/`, then `.`, then `more/`.
        fn with(files: &[(&str, &[u8])]) -> Self {
            let folder = tempfile::tempdir().expect("a temporary folder");
            for (path, bytes) in files {
                let path = folder.path().join(path);
                fs::create_dir_all(path.parent().expect("a parent")).expect("folders");
                fs::write(path, bytes).expect("a file");
            }
            let search = SearchPath {
                sim_folder: Some(folder.path().join("sims")),
                working_folder: folder.path().to_owned(),
                folders: vec![folder.path().join("more")],
                installation: Some(folder.path().join("home")),
                embedded: Vec::new(),
            };
            Self { folder, search }
        }

        fn check(&self, reference: &str, expected: &[&str]) -> Found {
            let found = find_program(reference, &self.search).unwrap_or_else(|error| panic!("{error}"));
            let paths = match &found.source {
                ProgramSource::Sources { files, .. } => files.clone(),
                other => vec![other.path().to_owned()],
            };
            let expected: Vec<PathBuf> = expected.iter().map(|path| self.folder.path().join(path)).collect();
            assert_eq!(paths, expected, "{reference}");
            found
        }

        fn check_missing(&self, reference: &str) -> String {
            find_program(reference, &self.search).expect_err("not found").to_string()
        }
    }

    #[test]
    fn an_included_source_is_not_compiled_separately() {
        let included = b"#include <stdio.h>\n # include \"image.c\"\n#include \"main.c\"\n#include \"map.h\"\n";
        let folder = TestFolder::with(&[
            ("sims/drive/main.c", included),
            ("sims/drive/image.c", b"int f;\n"),
            ("sims/drive/map.c", b""),
        ]);
        folder.check("drive", &["sims/drive/main.c", "sims/drive/map.c"]);
    }

    #[test]
    fn sources_saved_with_txt_are_found_last() {
        let test_folder = TestFolder::with(&[
            ("sims/go.c.txt", b""),
            ("sims/turn.cpp.TXT", b""),
            ("sims/walk.py.txt", b"from eye import *\n"),
            ("sims/go2.c.txt", b""),
            ("go2.c", b""),
            ("sims/lab/main.c", b""),
            ("sims/lab/main.c.txt", b""),
        ]);
        for reference in ["go.c", "go.x", "go"] {
            let found = test_folder.check(reference, &["sims/go.c.txt"]);
            assert!(found.name == "go" && found.notes[0].contains("sims/go.c.txt` is used for `"), "{found:?}");
        }
        assert_eq!(test_folder.check("turn.cpp.TXT", &["sims/turn.cpp.TXT"]).notes, [""; 0]);
        let python = test_folder.check("walk.py", &["sims/walk.py.txt"]);
        assert!(python.name == "walk" && matches!(python.source, ProgramSource::Python(_)), "{python:?}");
        test_folder.check("go2.c", &["go2.c"]);
        test_folder.check("lab", &["sims/lab/main.c"]);
    }

    #[test]
    fn a_folder_that_is_also_the_working_folder_is_listed_once() {
        let working_folder = std::env::current_dir().expect("the working folder");
        let search = SearchPath { sim_folder: Some(PathBuf::new()), working_folder, ..SearchPath::default() };
        let message = find_program("gone.c", &search).expect_err("not found").to_string();
        assert_eq!(message, "program `gone.c` is not found\n  tried `gone.c`");
    }

    #[test]
    fn package_in_the_working_folder_has_the_name_of_the_folder() {
        // Tests run in the folder of their package.
        let search = SearchPath { sim_folder: Some(PathBuf::new()), ..SearchPath::default() };
        assert_eq!(find_program("Cargo.toml", &search).expect("a package").name, "sim-program");
    }

    #[test]
    fn programs_of_other_machines_and_in_other_case_are_found() {
        let test_folder = TestFolder::with(&[("sims/go.c", b""), ("sims/progs/Turn.cpp", b""), ("sims/Main.C", b"")]);
        for (reference, expected) in [
            ("/home/bob/eyesim/go.x", "sims/go.c"),
            ("~/eyesim/progs/Turn.x", "sims/progs/Turn.cpp"),
            ("PROGS\\TURN.EXE", "sims/progs/Turn.cpp"),
            ("/home/bob/PROGS/turn.x", "sims/progs/Turn.cpp"),
            ("../../progs/go.c", "sims/go.c"),
            ("GO.C", "sims/go.c"),
            ("main.c", "sims/Main.C"),
            ("MAIN", "sims/Main.C"),
        ] {
            let found = test_folder.check(reference, &[expected]);
            assert!(found.notes[0].contains("does not exist") && found.notes.len() == 1, "{:?}", found.notes);
        }
        let notes = test_folder.check("x/go.c,progs/Turn.cpp", &["sims/go.c", "sims/progs/Turn.cpp"]).notes;
        assert!(notes.len() == 1 && notes[0].starts_with("`x/go.c` does not exist"), "{notes:?}");
        assert!(test_folder.check("go.x", &["sims/go.c"]).notes.is_empty());
        test_folder.check_missing("/home/bob/eyesim/stop.x");
    }

    #[test]
    fn a_makefile_names_the_sources() {
        let makefile = b"CC = gcc\nOBJS = main.o \\\n\tmap.o\nall: maze.x\nmaze.x: $(OBJS) map.h Makefile | build # all\n\t$(CC) -o $@ $^\ngone.x: main.c gone.c\n\
                         many.x: $(wildcard *.c) main.c\n";
        let test_folder = TestFolder::with(&[
            ("sims/Makefile", makefile),
            ("sims/main.c", b""),
            ("sims/map.cpp", b""),
            ("sims/map.h", b""),
            ("sims/all.c", b""),
        ]);
        let notes = test_folder.check("maze.x", &["sims/main.c", "sims/map.cpp"]).notes;
        assert!(notes[0].contains("Makefile") && notes.len() == 1, "{notes:?}");
        assert!(test_folder.check("main.x", &["sims/main.c"]).notes.is_empty());
        test_folder.check("all.x", &["sims/all.c"]);
        test_folder.check_missing("gone.x");
        test_folder.check_missing("many.x");
    }

    /// A shared library: the head of this test program without the segments that make it an executable.
    fn library() -> Vec<u8> {
        let mut bytes = read_head(&std::env::current_exe().expect("this program")).expect("its bytes");
        // The type ET_DYN, no program headers.
        bytes[16] = 3;
        bytes[56..58].fill(0);
        bytes
    }

    #[test]
    fn sim_folder_precedes_working_folder_and_further_folders() {
        let test_folder =
            TestFolder::with(&[("sims/a.c", b""), ("a.c", b""), ("b.c", b""), ("more/b.c", b""), ("more/c.c", b"")]);
        test_folder.check("a.c", &["sims/a.c"]);
        test_folder.check("b.c", &["b.c"]);
        test_folder.check("c.c", &["more/c.c"]);
        test_folder.check("../b.c", &["sims/../b.c"]);
        test_folder.check(r"..\b.c", &["sims/../b.c"]);
        test_folder.check(r".\a.c", &["sims/a.c"]);
    }

    #[test]
    fn missing_library_is_replaced_by_its_source() {
        let test_folder =
            TestFolder::with(&[("sims/maze.c", b""), ("sims/wall/Cargo.toml", b""), ("sims/wall/src/lib.rs", b"")]);
        for name in ["maze.dll", "maze.so", "maze.x", "maze.py", "maze.hex", "maze.o", "maze"] {
            test_folder.check(name, &["sims/maze.c"]);
        }
        for name in ["wall.so", "wall.dll", "wall", "wall/", "wall/Cargo.toml"] {
            let found = test_folder.check(name, &["sims/wall"]);
            assert!(matches!(found.source, ProgramSource::Cargo(_)), "{name}");
            assert_eq!(found.name, "wall", "{name}");
        }
    }

    #[test]
    fn file_of_another_system_is_replaced_by_its_source() {
        let test_folder =
            TestFolder::with(&[("sims/maze.dll", b"MZ\x90\0"), ("sims/maze.c", b""), ("sims/alone.dll", b"MZ\x90\0")]);
        let found = test_folder.check("maze.dll", &["sims/maze.c"]);
        assert!(found.notes[0].contains("maze.dll` is a Windows library or program: `"), "{:?}", found.notes);
        let message = test_folder.check_missing("alone.dll");
        assert!(message.starts_with("program `alone.dll` cannot be run here"), "{message}");
        assert!(message.contains("alone.dll` is a Windows library or program"), "{message}");
        assert!(message.contains("put its source beside it"), "{message}");
    }

    #[test]
    fn programs_of_eyesim_vr_are_replaced() {
        let executable = read_head(&std::env::current_exe().expect("this program")).expect("its bytes");
        let test_folder = TestFolder::with(&[
            ("sims/a.x", &executable),
            ("sims/a.c", b""),
            ("sims/b.x", b"\xcf\xfa\xed\xfe\x07\0\0\x01"),
            ("sims/b/Cargo.toml", b""),
            ("sims/c.exe", b"MZ\x90\0"),
            ("sims/c.so", &library()),
            ("sims/d.py", b"from eye import *"),
            ("sims/d.c", b""),
            ("sims/e.so", &library()),
            ("sims/alone.x", &executable),
        ]);
        for (name, expected, note) in [
            ("a.x", "sims/a.c", "a.x` is an executable for "),
            ("b.x", "sims/b", "b.x` is a macOS library or program: "),
            ("c.exe", "sims/c.so", "c.exe` is a Windows library or program: "),
        ] {
            let found = test_folder.check(name, &[expected]);
            assert!(found.notes[0].contains(note), "{:?}", found.notes);
        }
        // A missing file does not cause a note.
        assert_eq!(test_folder.check("e.exe", &["sims/e.so"]).notes, <[String; 0]>::default());
        let message = test_folder.check_missing("alone.x");
        assert!(message.contains("alone.x` is an executable for ") && message.contains("put its source"), "{message}");
    }

    #[test]
    fn library_of_this_system_is_found() {
        let test_folder = TestFolder::with(&[("sims/maze.c", b""), ("sims/maze.so", &library())]);
        let found = test_folder.check("maze.so", &["sims/maze.so"]);
        assert!(matches!(found.source, ProgramSource::Library(_)));
    }

    #[test]
    fn several_sources_are_named_by_commas_or_by_their_folder() {
        let test_folder =
            TestFolder::with(&[("sims/main.c", b""), ("map.c", b""), ("sims/bug/b.c", b""), ("sims/bug/a.c", b"")]);
        assert_eq!(test_folder.check("main.c,map.c", &["sims/main.c", "map.c"]).name, "main");
        test_folder.check("main.c, map.c", &["sims/main.c", "map.c"]);
        assert_eq!(test_folder.check("bug", &["sims/bug/a.c", "sims/bug/b.c"]).name, "bug");
        assert!(test_folder.check_missing("main.c,mop.c").contains("mop.c"));
    }

    #[test]
    fn c_sources_precede_cpp_sources() {
        let test_folder = TestFolder::with(&[
            ("sims/a.cpp", b""),
            ("sims/a.cc", b""),
            ("sims/b.cc", b""),
            ("sims/b/x.c", b""),
            ("sims/c.c", b""),
            ("sims/c.cpp", b""),
            ("sims/mix/main.cpp", b""),
            ("sims/mix/map.c", b""),
            ("sims/mix/map.h", b""),
        ]);
        for name in ["a.x", "a.exe", "a.dll", "a.so", "a", "a.cpp"] {
            test_folder.check(name, &["sims/a.cpp"]);
        }
        test_folder.check("b.x", &["sims/b.cc"]);
        test_folder.check("b", &["sims/b/x.c"]);
        test_folder.check("c.dll", &["sims/c.c"]);
        test_folder.check("mix", &["sims/mix/main.cpp", "sims/mix/map.c"]);
        assert_eq!(test_folder.check("mix/main.cpp,mix/map.c", &["sims/mix/main.cpp", "sims/mix/map.c"]).name, "main");
    }

    #[test]
    fn old_references_to_the_installation_are_resolved() {
        let test_folder = TestFolder::with(&[("home/programs/a.c", b""), ("sims/b.c", b"")]);
        test_folder.check(r"%sim%\programs\a.dll", &["home/programs/a.c"]);
        test_folder.check("%SIM%/programs/a.c", &["home/programs/a.c"]);
        test_folder.check("/programs/a.so", &["home/programs/a.c"]);
        test_folder.check(r"C:\eyesim\b.dll", &["sims/b.c"]);
    }

    #[test]
    fn attempts_and_similar_names_are_listed() {
        let test_folder = TestFolder::with(&[("sims/maze.c", b""), ("sims/mace.txt", b""), ("sims/other.c", b"")]);
        let message = test_folder.check_missing("mzae.dll");
        let root = test_folder.folder.path().display();
        let beside = "`mzae.c`, `mzae.cpp`, `mzae.cc`, `mzae.cxx`, `mzae.c++`, `mzae`, `mzae.so`";
        let expected = format!(
            "program `mzae.dll` is not found\n  tried `{root}/sims/mzae.dll`, {beside}\n  \
             tried `{root}/mzae.dll`, {beside}\n  tried `{root}/more/mzae.dll`, {beside}\n  \
             did you mean `{root}/sims/maze.c`?"
        );
        assert_eq!(message, expected);
    }

    #[test]
    fn file_that_is_not_a_program_is_not_replaced() {
        let test_folder =
            TestFolder::with(&[("sims/good.c", b""), ("sims/good.txt", b"text"), ("sims/mine.c/x.txt", b"")]);
        assert!(test_folder.check_missing("good.txt").contains("`good.txt` cannot be run here"));
        assert!(test_folder.check_missing("good.md").contains("did you mean"));
        let folder = test_folder.check_missing("mine.c");
        assert!(folder.contains("mine.c` is a folder without `Cargo.toml`, `.c` or `.cpp` files"), "{folder}");
        assert!(!folder.contains("put its source") && !folder.contains("did you mean"), "{folder}");
        let _socket = std::os::unix::net::UnixListener::bind(test_folder.folder.path().join("sims/bound.c"));
        let unreadable = test_folder.check_missing("bound.c");
        assert!(unreadable.contains("bound.c` is unreadable"), "{unreadable}");
        assert!(!unreadable.contains("put its source"), "{unreadable}");
    }

    #[test]
    fn sources_of_other_languages_are_described() {
        let test_folder =
            TestFolder::with(&[("sims/a.py", b""), ("sims/b.rs", b""), ("sims/c.hpp", b""), ("sims/d/x.txt", b"")]);
        assert!(matches!(test_folder.check("a.py", &["sims/a.py"]).source, ProgramSource::Python(_)));
        assert!(test_folder.check_missing("b.rs").contains("name the folder of its Cargo package"));
        assert!(test_folder.check_missing("c.hpp").contains("a header: name the `.c` or `.cpp` file"));
        assert!(test_folder.check_missing("d").contains("a folder without `Cargo.toml`, `.c` or `.cpp` files"));
    }
}
