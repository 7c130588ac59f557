//! From what was found to images that robots can load: each program is built and read once.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::build::{BuildError, Builder, Built};
use super::find::{Found, ProgramSource};
use super::generation::Choice;
use super::image::{ImageError, ProgramImage};
use super::python::Python;
use super::symbols::warnings_about;

/// A program that is built and read, for every robot that runs it.
#[derive(Debug)]
pub struct Prepared {
    /// Its name, the `argv[0]` of its robots.
    pub name: String,
    /// What it was made from.
    pub source: ProgramSource,
    /// What robots load of it.
    pub code: Code,
    /// What the compiler said, now or when the library was built.
    pub output: String,
    /// Whether a compiler ran now.
    pub compiled: bool,
    /// The generation of RoBIOS that its sources are compiled for, and why; `None` where eyesim did not choose it.
    pub choice: Option<Choice>,
    /// What in the program is outside the guarantee of equal runs, a line each.
    pub warnings: Vec<String>,
}

/// What robots load of a program.
#[derive(Debug)]
pub enum Code {
    /// A shared library.
    Library(Arc<ProgramImage>),
    /// A Python program, and what runs it, always in a process of its own.
    Python(Python),
}

impl Prepared {
    /// The library; none of a Python program.
    pub fn image(&self) -> Option<&Arc<ProgramImage>> {
        match &self.code {
            Code::Library(image) => Some(image),
            Code::Python(_) => None,
        }
    }

    /// The generation of RoBIOS that it was built for, where that is known.
    pub fn generation(&self) -> Option<u32> {
        match &self.code {
            Code::Library(image) => image.description().map(|description| description.generation),
            Code::Python(_) => Some(7),
        }
    }

    /// What is told when it is compiled: `maze.c: RoBIOS-7 (VWStraight, VWWait)`.
    pub fn generation_remark(&self) -> Option<String> {
        self.choice.as_ref()?.remark(self.source.path())
    }

    /// The files that make the program what it is, for the list of a run's inputs.
    pub fn inputs(&self) -> Vec<PathBuf> {
        match &self.source {
            ProgramSource::Sources { files, .. } => files.clone(),
            ProgramSource::Library(path) | ProgramSource::Python(path) => vec![path.clone()],
            ProgramSource::Cargo(_) => self.image().map(|image| image.path().to_owned()).into_iter().collect(),
        }
    }
}

/// A program that cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// It does not build.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// What was built or given is not a library that can be loaded.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// Builds and reads each program of `found` once, in parallel; the results are in the order of `found`, and programs
/// from one source share theirs.
///
/// # Errors
/// For each program [`PrepareError`] on its own.
pub fn prepare(builder: &Builder, found: &[Found]) -> Vec<Result<Arc<Prepared>, Arc<PrepareError>>> {
    let mut distinct: Vec<&Found> = Vec::new();
    for program in found {
        if distinct.iter().all(|known| known.source != program.source) {
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
                let (code, warnings) = match &program.source {
                    ProgramSource::Python(_) => (Code::Python(builder.python()?), Vec::new()),
                    source => {
                        let image = ProgramImage::read(&built.library, source_folder(source))?;
                        let warnings = warnings_about(&image, &program.name);
                        (Code::Library(Arc::new(image)), warnings)
                    }
                };
                let name = program.name.clone();
                let Built { source, output, compiled, choice, .. } = built;
                Ok(Prepared { name, source, code, output, compiled, choice, warnings })
            };
            prepare().map(Arc::new).map_err(Arc::new)
        })
        .collect();
    let place = |program: &Found| distinct.iter().position(|known| known.source == program.source);
    found.iter().filter_map(|program| prepared.get(place(program)?).cloned()).collect()
}

/// The folder from which source files are named in messages.
fn source_folder(source: &ProgramSource) -> Option<&Path> {
    match source {
        ProgramSource::Sources { files, .. } => files.first()?.parent(),
        ProgramSource::Cargo(folder) => Some(folder),
        ProgramSource::Library(_) | ProgramSource::Python(_) => None,
    }
}
