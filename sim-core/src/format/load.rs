//! From a sim file to a scene: finds and reads all files that it names.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::spec::{PathRef, RobiSpec, RobotLine, RobotSpec, SceneSpec, SimSpec, StartRef, WorldKind, WorldSpec};
use super::{Span, clearance, line, path, read_companion, read_maze, read_robi, read_sim, read_world};
use crate::RobotId;

/// The file system as the readers see it; paths have slashes.
pub trait Files {
    /// The bytes of a file.
    ///
    /// # Errors
    /// [`FileError::Missing`] if there is none of this name, [`FileError::Unreadable`] if it cannot be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError>;

    /// Names of the files and folders in a folder, in any order; empty if there is no such folder. `""` is the working
    /// folder.
    fn list(&self, folder: &str) -> Vec<String>;

    /// Folder of the installation, for `%sim%`; `None` if there is none.
    fn home(&self) -> Option<&str>;
}

/// Why a file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// There is no file of this name.
    #[error("no such file")]
    Missing,
    /// There is one, but it cannot be read.
    #[error("{0}")]
    Unreadable(String),
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Path under which it was found.
    pub path: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A scene with everything that was said and read on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The scene; complete if and only if there are no errors.
    pub scene: SceneSpec,
    /// What is wrong, in the order in which the files were read.
    pub diagnostics: Vec<Diagnostic>,
    /// The files that were read, in that order, each once.
    pub inputs: Vec<InputFile>,
}

impl Loaded {
    /// True when the scene must not be run.
    pub fn has_errors(&self) -> bool {
        super::has_errors(&self.diagnostics)
    }
}

/// Reads a sim file and all worlds and robis that it names. Programs are not looked for.
///
/// Robots without a pose take the starts of the world in order. A robot type is read once, however many robots have it.
/// A robot that starts inside a wall or another robot is warned about.
pub fn load_sim(path: &str, files: &dyn Files) -> Loaded {
    let mut loader = Loader::new(files);
    let Some(text) = loader.root(path) else {
        return loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() });
    };
    let (sim, diagnostics) = read_sim(path, &text);
    loader.diagnostics.extend(diagnostics);
    let folder = path::folder_of(path).to_owned();
    let world = loader.world(&sim, &folder);
    let robots = loader.robots(&sim, &folder, world.as_ref());
    let world = world.unwrap_or_default();
    loader.diagnostics.extend(clearance::check(path, &world, &robots));
    let markers = sim.markers.clone();
    let settings = sim.settings;
    let file = path.to_owned();
    loader.finish(SceneSpec { file, folder, world, robots, markers, settings, ..SceneSpec::default() })
}

/// Reads a world file alone; the scene has no robots.
pub fn load_world(path: &str, files: &dyn Files) -> Loaded {
    load_alone(path, files, read_world)
}

/// Reads a maze file alone; the scene has no robots.
pub fn load_maze(path: &str, files: &dyn Files) -> Loaded {
    load_alone(path, files, read_maze)
}

fn load_alone(path: &str, files: &dyn Files, read: fn(&str, &str) -> (WorldSpec, Vec<Diagnostic>)) -> Loaded {
    let mut loader = Loader::new(files);
    let mut scene = SceneSpec { file: path.to_owned(), ..SceneSpec::default() };
    if let Some(text) = loader.root(path) {
        let (world, diagnostics) = read(path, &text);
        loader.diagnostics.extend(diagnostics);
        scene.world = world;
    }
    loader.finish(scene)
}

/// Reads a robi and its companion alone; `None` if there is no such file. The scene of the result is empty.
pub fn load_robi(path: &str, files: &dyn Files) -> (Option<RobiSpec>, Loaded) {
    let mut loader = Loader::new(files);
    let robi = loader.root(path).map(|text| loader.robi_text(path, &text));
    (robi, loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() }))
}

/// The text of a file, and the place of the first byte that is not UTF-8, if any: such bytes become U+FFFD.
pub fn decode(bytes: &[u8]) -> (String, Option<usize>) {
    match std::str::from_utf8(bytes) {
        Ok(text) => (text.to_owned(), None),
        Err(error) => (String::from_utf8_lossy(bytes).into_owned(), Some(error.valid_up_to())),
    }
}

pub(super) struct Loader<'a> {
    files: &'a dyn Files,
    pub(super) diagnostics: Vec<Diagnostic>,
    pub(super) inputs: Vec<InputFile>,
    /// Robot types by the text of the reference, and by the path at which they were found; `None` if nowhere.
    referenced: BTreeMap<String, Option<Arc<RobiSpec>>>,
    robis: BTreeMap<String, Arc<RobiSpec>>,
}

impl<'a> Loader<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        Self { files, diagnostics: Vec::new(), inputs: Vec::new(), referenced: BTreeMap::new(), robis: BTreeMap::new() }
    }

    fn finish(self, scene: SceneSpec) -> Loaded {
        Loaded { scene, diagnostics: self.diagnostics, inputs: self.inputs }
    }

    /// The file that the user named.
    fn root(&mut self, path: &str) -> Option<String> {
        match self.files.read(path) {
            Ok(bytes) => Some(self.take(path, bytes)),
            Err(error) => {
                let mut sink = Sink::new(path);
                sink.error(error.code(), Span::default(), format!("{error}"), "a file that can be read");
                self.diagnostics.extend(sink.finish());
                None
            }
        }
    }

    /// Remembers a file and decodes it.
    pub(super) fn take(&mut self, path: &str, bytes: Vec<u8>) -> String {
        let (text, invalid) = decode(&bytes);
        if let Some(place) = invalid {
            let starts = line::line_starts(&text[..place]);
            let line_start = starts.last().copied().unwrap_or_default();
            let span = Span {
                start: place,
                end: place + char::REPLACEMENT_CHARACTER.len_utf8(),
                line: starts.len() as u32,
                column: text[line_start..place].trim_start_matches('\u{feff}').chars().count() as u32 + 1,
            };
            let mut sink = Sink::new(path);
            sink.warn(
                Code::FileEncoding,
                span,
                "the file is not UTF-8 from here on; such bytes are replaced",
                "UTF-8 or ASCII",
            );
            self.diagnostics.extend(sink.finish());
        }
        self.inputs.push(InputFile { path: path.to_owned(), bytes });
        text
    }

    /// The path and bytes of the file that `reference` in `file` names; reports all places tried if it is nowhere.
    pub(super) fn find(&mut self, file: &str, folder: &str, reference: &PathRef) -> Option<(String, Vec<u8>)> {
        let places = path::candidates(&reference.text, folder, self.files.home());
        let mut sink = Sink::new(file);
        let mut found = None;
        for place in &places {
            match self.files.read(place) {
                Ok(bytes) => found = Some((place.clone(), bytes)),
                Err(FileError::Missing) => continue,
                Err(error) => {
                    let message = format!("`{place}` cannot be read: {error}");
                    sink.error(error.code(), reference.span, message, "a file that can be read");
                    self.diagnostics.extend(sink.finish());
                    return None;
                }
            }
            break;
        }
        if found.is_none()
            && let Some(place) = path::beside(&reference.text, folder)
            && let Ok(bytes) = self.files.read(&place)
        {
            let message = format!("`{}` is not found; `{place}` is taken instead", reference.text);
            sink.warn(Code::FileMoved, reference.span, message, "a name relative to this file");
            found = Some((place, bytes));
        }
        if found.is_none() {
            found = places.iter().find_map(|place| self.in_other_case(place));
            if let Some((place, _)) = &found {
                let message = format!("`{}` is found only as `{place}`: upper and lower case differ", reference.text);
                sink.warn(Code::FileCase, reference.span, message, "the name as the file has it");
            }
        }
        if found.is_none() {
            let message = format!("`{}` is not found; tried {}", reference.text, tried(&places));
            let expected = "a file relative to this one, to the working folder or to the installation (`%sim%`)";
            let diagnostic = sink.error(Code::FileMissing, reference.span, message, expected);
            diagnostic.suggestion = self.similar(&places).map(|name| format!("there is `{name}`"));
        }
        self.diagnostics.extend(sink.finish());
        found
    }

    /// The file whose path differs from `place` only in upper and lower case.
    fn in_other_case(&self, place: &str) -> Option<(String, Vec<u8>)> {
        let root = if place.starts_with('/') { "/" } else { "" };
        let mut path = root.to_owned();
        for part in place.split('/').filter(|part| !part.is_empty()) {
            let name = if part == ".." {
                part.to_owned()
            } else {
                let mut names = self.files.list(&path);
                names.sort_unstable();
                let same = |name: &&String| name.to_lowercase() == part.to_lowercase();
                names.iter().find(|name| *name == part).or_else(|| names.iter().find(same))?.clone()
            };
            if !path.is_empty() && !path.ends_with('/') {
                path.push('/');
            }
            path.push_str(&name);
        }
        let bytes = self.files.read(&path).ok()?;
        Some((path, bytes))
    }

    /// A file in one of the folders tried whose name is nearly the one sought.
    fn similar(&self, places: &[String]) -> Option<String> {
        places.iter().find_map(|place| {
            let mut names = self.files.list(path::folder_of(place));
            names.sort_unstable();
            let folder = &place[..place.len() - path::file_name(place).len()];
            let nearest = line::nearest(path::file_name(place), names.iter().map(String::as_str))?;
            Some(format!("{folder}{nearest}"))
        })
    }

    /// The world that the sim file names; `None`, with an error, if there is none.
    fn world(&mut self, sim: &SimSpec, folder: &str) -> Option<WorldSpec> {
        let Some(line) = &sim.world else {
            // A line that could not be read has its own error.
            if !super::has_errors(&self.diagnostics) {
                let expected = "`world FILE.wld` or `maze FILE.maz`";
                self.report(
                    sim,
                    Severity::Error,
                    Code::SimWorldMissing,
                    Span::default(),
                    "no world is given",
                    expected,
                );
            }
            return None;
        };
        let (path, bytes) = self.find(&sim.file, folder, &line.path)?;
        let text = self.take(&path, bytes);
        let (world, diagnostics) = match line.kind {
            WorldKind::World => read_world(&path, &text),
            WorldKind::Maze => read_maze(&path, &text),
        };
        self.diagnostics.extend(diagnostics);
        Some(world)
    }

    fn robots(&mut self, sim: &SimSpec, folder: &str, world: Option<&WorldSpec>) -> Vec<RobotSpec> {
        let mut starts = world.map_or(&[][..], |world| &world.starts).iter();
        let mut robots = Vec::new();
        if sim.robots.is_empty() && !super::has_errors(&self.diagnostics) {
            let expected = "a line `robi FILE.robi PROGRAM`";
            let message = "the scene has no robot";
            self.report(sim, Severity::Warning, Code::SimRobotMissing, Span::default(), message, expected);
        }
        for (index, line) in sim.robots.iter().enumerate() {
            let robi = self.robi(sim, folder, line);
            let start = match line.start {
                StartRef::Pose(pose) => Some(pose),
                StartRef::Next | StartRef::Letter { .. } | StartRef::Many { .. } => {
                    starts.next().map(|start| start.pose)
                }
            };
            // Where the world is missing, that is what has to be mended.
            if let (None, Some(world)) = (start, world) {
                let message = format!("no start is left for this robot: the world has {}", world.starts.len());
                let expected = "`X Y PHI` on this line, `position X Y PHI` in the world or a start letter in the maze";
                self.report(sim, Severity::Error, Code::SimStartMissing, line.span, message, expected);
            }
            if let (Some(robi), Some(start)) = (robi, start) {
                let id = RobotId::from_index(index);
                let (program, arguments) = (line.program.clone(), line.arguments.clone());
                robots.push(RobotSpec { id, robi, start, program, arguments, span: line.span });
            }
        }
        robots
    }

    fn robi(&mut self, sim: &SimSpec, folder: &str, line: &RobotLine) -> Option<Arc<RobiSpec>> {
        if let Some(known) = self.referenced.get(&line.kind.written().text) {
            return known.clone();
        }
        let robi = self.find(&sim.file, folder, line.kind.written()).map(|(path, bytes)| self.robi_at(path, bytes));
        self.referenced.insert(line.kind.written().text.clone(), robi.clone());
        robi
    }

    fn robi_at(&mut self, path: String, bytes: Vec<u8>) -> Arc<RobiSpec> {
        if let Some(robi) = self.robis.get(&path) {
            return Arc::clone(robi);
        }
        let text = self.take(&path, bytes);
        let robi = Arc::new(self.robi_text(&path, &text));
        self.robis.insert(path, Arc::clone(&robi));
        robi
    }

    /// A robi and the companion beside it.
    fn robi_text(&mut self, path: &str, text: &str) -> RobiSpec {
        let (mut robi, diagnostics) = read_robi(path, text);
        self.diagnostics.extend(diagnostics);
        let companion = path::with_extension(path, "toml");
        match self.files.read(&companion) {
            Ok(bytes) => {
                let text = self.take(&companion, bytes);
                self.diagnostics.extend(read_companion(&companion, &text, &mut robi));
            }
            Err(FileError::Missing) => {}
            Err(error) => {
                let mut sink = Sink::new(&companion);
                sink.error(error.code(), Span::default(), format!("{error}"), "a file that can be read");
                self.diagnostics.extend(sink.finish());
            }
        }
        robi
    }

    fn report(
        &mut self,
        sim: &SimSpec,
        severity: Severity,
        code: Code,
        span: Span,
        message: impl Into<String>,
        expected: &str,
    ) {
        let mut sink = Sink::new(&sim.file);
        sink.report(severity, code, span, message, expected);
        self.diagnostics.extend(sink.finish());
    }
}

impl FileError {
    fn code(&self) -> Code {
        match self {
            FileError::Missing => Code::FileMissing,
            FileError::Unreadable(_) => Code::FileUnreadable,
        }
    }
}

fn tried(places: &[String]) -> String {
    if places.is_empty() {
        return "nothing, since the installation's folder is unknown".to_owned();
    }
    places.iter().map(|place| format!("`{place}`")).collect::<Vec<_>>().join(", ")
}
