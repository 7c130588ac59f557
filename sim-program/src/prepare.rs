//! Builds and reads each found program once, so that robots can load it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::build::{BuildError, Builder, BuiltProgram};
use super::embedded::EmbeddedProgram;
use super::find::{Found, ProgramSource};
use super::generation::GenerationChoice;
use super::image::{ImageError, ProgramImage};
use super::python::Python;
use super::symbols::{danger_to_host, warnings_about};
use crate::files::read_regular;

/// A program that is built and read, shared by all robots that run it.
#[derive(Debug)]
pub struct Prepared {
    /// Name of the program, the `argv[0]` of its robots.
    pub name: String,
    /// Source of the program.
    pub source: ProgramSource,
    /// Code that robots load.
    pub code: Code,
    /// Output of the compiler, from this build or from the earlier build of the library.
    pub output: String,
    /// A compiler has run for this build.
    pub compiled: bool,
    /// The generation of RoBIOS for which its sources are compiled, with the reason; `None` if eyesim did not choose
    /// it.
    pub choice: Option<GenerationChoice>,
    /// Warnings about functions that make runs nondeterministic, one line each.
    pub warnings: Vec<String>,
    /// Reason why the program could end or stop the host on one of its threads; `None` if there is none.
    pub danger: Option<String>,
}

/// Code of a program that robots load.
#[derive(Debug)]
pub enum Code {
    /// A shared library.
    Library(Arc<ProgramImage>),
    /// A Python program, with its interpreter; always runs in its own process.
    Python(Python),
    /// Code of the process that embeds the simulator.
    Embedded(EmbeddedProgram),
}

impl Prepared {
    /// The library; `None` for a program without one.
    pub fn image(&self) -> Option<&Arc<ProgramImage>> {
        match &self.code {
            Code::Library(image) => Some(image),
            Code::Python(_) | Code::Embedded(_) => None,
        }
    }

    /// Reason why several flows of this program cannot share a thread, see [`ProgramImage::why_thread_bound`]; `None`
    /// if they can.
    pub fn why_thread_bound(&self) -> Option<&str> {
        match (&self.code, &self.source) {
            (Code::Library(image), ProgramSource::Sources { .. }) => image.why_thread_bound(),
            _ => Some("has not been built by eyesim from sources in C"),
        }
    }

    /// The generation of RoBIOS for which the program was built, if known.
    pub fn generation(&self) -> Option<u32> {
        match &self.code {
            Code::Library(image) => image.description().map(|description| description.generation),
            Code::Python(_) | Code::Embedded(_) => Some(7),
        }
    }

    /// Message about the program's compilation: `maze.c: RoBIOS-7 (VWStraight, VWWait)`.
    pub fn generation_remark(&self) -> Option<String> {
        self.choice.as_ref()?.remark(self.source.path())
    }

    /// The program's own folder: the folder of its sources, or of its file.
    pub fn own_folder(&self) -> Option<PathBuf> {
        match &self.source {
            ProgramSource::Cargo(folder) => Some(folder.clone()),
            source => source.path().parent().map(Path::to_owned),
        }
        // A file named without a folder is in the working folder.
        .map(|folder| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder })
    }

    /// The files that determine the program, for the list of a run's inputs.
    pub fn inputs(&self) -> Vec<PathBuf> {
        match &self.source {
            ProgramSource::Cargo(_) => self.image().map(|image| image.path().to_owned()).into_iter().collect(),
            source => source.files().into_iter().chain(source.parts()).collect(),
        }
    }
}

/// A program that cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// The program does not build.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The file is not a library that can be loaded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The library of a Cargo package is not a robot program.
    #[error("{}", without_entry(.0))]
    NoEntry(PathBuf),
}

/// Message about the package in `folder`, whose library has no entry point of a program.
fn without_entry(folder: &Path) -> String {
    let root = folder.join("src/lib.rs");
    let is_blank = fs::read(&root).is_ok_and(|text| text.trim_ascii().is_empty());
    if is_blank {
        return format!("`{}` is empty: `eyesim new NAME --lang rust` shows how a program begins", root.display());
    }
    format!(
        "`{}` has no line `robios_api::program!(main);`: write it below the `use` lines, with `fn main(robot: &Robot) -> Result`",
        root.display()
    )
}

/// Builds and reads each program of `found` once, in parallel. The results are in the order of `found`; programs of the
/// same name and source share a result.
///
/// # Errors
/// [`PrepareError`] for each program separately.
pub fn prepare(builder: &Builder, found: &[Found]) -> Vec<Result<Arc<Prepared>, Arc<PrepareError>>> {
    let mut distinct: Vec<&Found> = Vec::new();
    let is_same = |known: &Found, program: &Found| (&known.name, &known.source) == (&program.name, &program.source);
    for program in found {
        if !distinct.iter().any(|known| is_same(known, program)) {
            distinct.push(program);
        }
    }
    let sources: Vec<ProgramSource> = distinct.iter().map(|program| program.source.clone()).collect();
    let built = builder.build_all(&sources);
    let prepared: Vec<Result<Arc<Prepared>, Arc<PrepareError>>> = distinct
        .iter()
        .zip(built)
        .map(|(program, built)| {
            let prepare = || {
                let built = built?;
                let (code, warnings, danger) = match &program.source {
                    ProgramSource::Python(_) => (Code::Python(builder.python()?), Vec::new(), None),
                    ProgramSource::Embedded(program) => (Code::Embedded(program.clone()), Vec::new(), None),
                    source => {
                        let image = ProgramImage::read(&built.library, source_folder(source))?;
                        if let ProgramSource::Cargo(folder) = source
                            && image.description().is_none()
                        {
                            return Err(PrepareError::NoEntry(folder.clone()));
                        }
                        let mut warnings = warnings_about(&image, &program.name);
                        if let ProgramSource::Cargo(folder) = source {
                            warnings.extend(warning_about_stdin(folder, &program.name));
                        }
                        let danger = danger_to_host(&image);
                        (Code::Library(Arc::new(image)), warnings, danger)
                    }
                };
                let name = program.name.clone();
                let BuiltProgram { source, output, compiled, choice, .. } = built;
                Ok(Prepared { name, source, code, output, compiled, choice, warnings, danger })
            };
            prepare().map(Arc::new).map_err(Arc::new)
        })
        .collect();
    let place = |program: &Found| distinct.iter().position(|known| is_same(known, program));
    found.iter().filter_map(|program| prepared.get(place(program)?).cloned()).collect()
}

/// Warning about the first line of a Cargo package that reads the standard input of the process.
fn warning_about_stdin(folder: &Path, name: &str) -> Option<String> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder.join("src")).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "rs"));
    files.sort();
    files.iter().find_map(|file| {
        let text = read_regular(file).ok()?;
        let text = String::from_utf8_lossy(&text);
        let line = text.lines().position(|line| line.contains("stdin()") && !line.trim_start().starts_with("//"))? + 1;
        let file = file.strip_prefix(folder).unwrap_or(file).display();
        Some(format!(
            "program `{name}`: {file}:{line}: a robot program has no `std::io::stdin`: write `let line = robot.read_line().unwrap();` instead, write the input into a file `in.txt` and run with `--stdin in.txt`"
        ))
    })
}

/// The folder to which the paths of source files in messages are relative.
fn source_folder(source: &ProgramSource) -> Option<&Path> {
    match source {
        ProgramSource::Sources { files, .. } => files.first()?.parent(),
        ProgramSource::Cargo(folder) => Some(folder),
        ProgramSource::Library(_) | ProgramSource::Python(_) | ProgramSource::Embedded(_) => None,
    }
}
