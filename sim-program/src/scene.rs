//! Finds and builds the programs of a scene, each once.

use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use sim_core::spec::{RobotSpec, SceneSpec, Span, SpannedText};

use super::build::Builder;
use super::data_files;
use super::find::{FindError, Found, ProgramSource, SearchPath, find_program};
use super::generation::{Generation, GenerationHint};
use super::prepare::{Prepared, prepare};

/// The generation that the scene states for a robot's program.
pub fn generation_hint(robot: &RobotSpec) -> GenerationHint {
    let generation = |number: Option<u32>| number.and_then(Generation::of_number);
    GenerationHint { api: generation(robot.api), dialect: generation(robot.dialect) }
}

/// The programs of a scene, built.
#[derive(Clone)]
pub struct Programs {
    /// The programs in the order of the robots; robots with the same program share it, and a robot without a program
    /// has `None`.
    pub of_robots: Vec<Option<Arc<Prepared>>>,
    /// Messages for the user: notes of the search, chosen generations, output of the compiler, data files that lie
    /// beside a program but not in the working folder, warnings about sources of nondeterminism.
    pub remarks: Vec<String>,
}

/// Programs of a scene that cannot be found or built.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", mistakes.join("\n"))]
pub struct ProgramsError {
    /// A message for each program, each message once. For a program that is not found, the message has the line of the
    /// sim file that names it.
    pub mistakes: Vec<String>,
    /// Sources of the programs that were found.
    pub sources: Vec<ProgramSource>,
}

impl Programs {
    /// Finds and builds the programs of all robots, each once; `builder` notifies its observer of each compilation.
    ///
    /// # Errors
    /// [`ProgramsError`] with all programs that cannot be found or built.
    pub fn build(scene: &SceneSpec, search: &SearchPath, builder: &Builder) -> Result<Self, ProgramsError> {
        // A program named on the command line is searched in the working folder, not in the sim file's folder.
        let command_line_search = SearchPath { sim_folder: None, ..search.clone() };
        let mut found: Vec<Option<Found>> = Vec::with_capacity(scene.robots.len());
        // Keys: the name, and true for a program of the command line.
        let mut searched: BTreeMap<(&str, bool), Result<Found, FindError>> = BTreeMap::new();
        let mut mistakes = Vec::new();
        for robot in &scene.robots {
            let find = |program: &SpannedText| {
                let search = if is_of_command_line(program) { &command_line_search } else { search };
                find_program(&program.text, search)
            };
            found.push(robot.program.as_ref().and_then(|program| {
                let key = (&*program.text, is_of_command_line(program));
                match searched.entry(key).or_insert_with(|| find(program)) {
                    Ok(found) => Some(found.clone().with_hint(generation_hint(robot))),
                    Err(error) => {
                        push_new(&mut mistakes, format!("{}: {error}", location_of(scene, program)));
                        None
                    }
                }
            }));
        }
        let failed = |mistakes: Vec<String>| ProgramsError {
            mistakes,
            sources: found.iter().flatten().map(|found| found.source.clone()).collect(),
        };
        if !mistakes.is_empty() {
            return Err(failed(mistakes));
        }
        let mut prepared = prepare(builder, &found.iter().flatten().cloned().collect::<Vec<_>>()).into_iter();
        let mut of_robots = Vec::with_capacity(found.len());
        let mut remarks = Vec::new();
        let mut seen = BTreeSet::new();
        for (robot, found) in scene.robots.iter().zip(&found) {
            let Some((found, prepared)) = found.as_ref().and_then(|found| Some((found, prepared.next()?))) else {
                of_robots.push(None);
                continue;
            };
            found.notes.iter().for_each(|note| push_new(&mut remarks, note.clone()));
            match prepared {
                Ok(program) => {
                    let generation = program.generation_remark().filter(|_| program.compiled);
                    generation.into_iter().for_each(|remark| push_new(&mut remarks, remark));
                    let output = Some(program.output.trim_end()).filter(|output| !output.is_empty());
                    output.iter().for_each(|output| push_new(&mut remarks, (*output).to_owned()));
                    if seen.insert(&found.source) {
                        remarks.extend(data_files::remarks(&found.source, &search.working_folder));
                    }
                    program.warnings.iter().for_each(|warning| push_new(&mut remarks, warning.clone()));
                    of_robots.push(Some(program));
                }
                Err(error) => push_new(&mut mistakes, format!("program `{}`: {error}", shown_name(robot, scene))),
            }
        }
        if !mistakes.is_empty() {
            return Err(failed(mistakes));
        }
        Ok(Self { of_robots, remarks })
    }

    /// The program of each robot that has one.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<Prepared>> {
        self.of_robots.iter().flatten()
    }
}

/// Reference to a program that is named on the command line, and thus has no span in a file.
pub fn program_of_command_line(name: &str) -> SpannedText {
    SpannedText { text: name.to_owned(), span: Span::default() }
}

fn is_of_command_line(program: &SpannedText) -> bool {
    program.span.line == 0
}

/// Name of a robot's program for messages and tables: the scene's reference to it, or the name of the folder if the
/// reference is the `Cargo.toml` of a package.
pub fn shown_name(robot: &RobotSpec, scene: &SceneSpec) -> String {
    let Some(program) = &robot.program else { return String::new() };
    let text = program.text.replace('\\', "/");
    let folder = if is_of_command_line(program) { "" } else { &scene.folder };
    let package_name = || {
        let manifest = Path::new(&text);
        let folder = Path::new(folder).join(manifest.parent().filter(|_| manifest.ends_with("Cargo.toml"))?);
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
        Some(fs::canonicalize(folder).ok()?.file_name()?.to_string_lossy().into_owned())
    };
    package_name().unwrap_or_else(|| program.text.clone())
}

/// Location of the reference `program`: `line.sim:3`, or the option of the command line.
fn location_of(scene: &SceneSpec, program: &SpannedText) -> String {
    if is_of_command_line(program) { "--program".to_owned() } else { format!("{}:{}", scene.file, program.span.line) }
}

fn push_new(list: &mut Vec<String>, text: String) {
    if !list.contains(&text) {
        list.push(text);
    }
}
