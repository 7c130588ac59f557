//! Loading of a scene: finds and reads all files that it refers to.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::scene::{self, Draw, read_scene_with};
use super::set::{self, Setting};
use super::spec::{
    CostTable, CostsRef, DEFAULT_WALL_HEIGHT, Dialect, ModelSpec, ObjectType, RobiSpec, RobotSpec, RunSpec, SceneSpec,
    SensorShape, SerialLine, SimSpec, SpannedText, TypeRef, WallSpec, WorldKind, WorldSpec,
};
use super::{
    CellRules, MeshReader, NoiseRef, Span, builtin, checks, clearance, faults, line, map, path, place, read_companion,
    read_costs, read_esobj, read_noise, read_robi, read_sim, types, unknown_sensors,
};
use sim_core::build::{self, MeshSource};
use sim_core::drive::DriveKind;
use sim_core::unit::mm_from_metres;

/// Maximum difference in height between ground and floor, in metres, at which the ground is level for wheels.
/// Our choice.
const LEVEL_TOLERANCE: f64 = 1e-3;

/// File system interface of the readers; paths have slashes.
pub trait Files {
    /// Content of a file.
    ///
    /// # Errors
    /// [`FileError::Missing`] if the file does not exist, [`FileError::Unreadable`] if it cannot be read.
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError>;

    /// Names of the files and folders in a folder, in any order; empty if the folder does not exist. `""` is the
    /// working folder.
    fn list(&self, folder: &str) -> Vec<String>;

    /// Folder of the installation, for `%sim%`; `None` if there is none.
    fn home(&self) -> Option<&str>;
}

/// In-memory file system, indexed by path, for a scene in a string and the files that it refers to. It has no
/// installation.
#[derive(Clone, Debug, Default)]
pub struct MemoryFiles {
    files: BTreeMap<String, Vec<u8>>,
}

impl MemoryFiles {
    /// Adds a file, replacing an existing one of the same path.
    pub fn insert(&mut self, path: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.insert(path.into(), bytes.into());
    }
}

impl<P: Into<String>, B: Into<Vec<u8>>> FromIterator<(P, B)> for MemoryFiles {
    fn from_iter<I: IntoIterator<Item = (P, B)>>(files: I) -> Self {
        Self { files: files.into_iter().map(|(path, bytes)| (path.into(), bytes.into())).collect() }
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        self.files.get(path).cloned().ok_or(FileError::Missing)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let prefix = match folder {
            "" | "/" => folder.to_owned(),
            folder => format!("{folder}/"),
        };
        let paths_in_folder = self.files.keys().filter_map(|path| path.strip_prefix(&prefix));
        let mut names: Vec<String> =
            paths_in_folder.map(|rest| rest.split('/').next().unwrap_or_default().to_owned()).collect();
        names.dedup();
        names
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

/// Reason why a file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// The file does not exist.
    #[error("no such file")]
    Missing,
    /// The file exists but cannot be read.
    #[error("{0}")]
    Unreadable(String),
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Path under which it was found.
    pub path: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// Result of loading a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The scene; complete if and only if there are no errors.
    pub scene: SceneSpec,
    /// Mistakes, in the order in which the files were read.
    pub diagnostics: Vec<Diagnostic>,
    /// Files that were read, in the order of reading, without duplicates.
    pub inputs: Vec<InputFile>,
    /// Notes on the interpretation of maps and mazes of other programs, a line each.
    pub notes: Vec<String>,
}

impl Loaded {
    /// Returns true if the scene has errors and must not be run.
    pub fn has_errors(&self) -> bool {
        super::has_errors(&self.diagnostics)
    }
}

/// Loads a scene (in TOML if its name ends in `.toml`, otherwise a sim file) and all worlds, robis, object files, noise
/// profiles and cost tables that it refers to. Of the meshes, reads only those that range sensors detect; does not
/// search for programs.
///
/// Robots without a pose take the starts of the world in order, or the start of their letter. A type is read once for
/// all robots or objects that use it. Robots and objects that start inside other bodies cause a warning.
pub fn load_scene(path: &str, files: &dyn Files) -> Loaded {
    load_scene_with(path, Overrides::default(), files)
}

/// Values that override those of a scene and change how its files are read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides<'a> {
    /// Seed of the run, on which random layouts depend.
    pub seed: Option<u64>,
    /// EyeSim version whose conventions the scene follows.
    pub dialect: Option<Dialect>,
    /// Side of the cells of the scene's maze or map file, in metres; positive.
    pub maze_cell: Option<f64>,
    /// Values of a scene in TOML, which override the values in its text.
    pub settings: &'a [Setting],
}

/// Maximum number of attempts to draw a scene that meets its requirements.
const MAX_ATTEMPTS: u32 = 100;
/// Number of attempts without enough room after which no further attempt is made.
const MAX_FULL_ATTEMPTS: u32 = 5;
/// Number of seeds for which [`check_scene`] loads a scene with random values.
const CHECKED_SEED_COUNT: u64 = 10;
/// Extensions of the files that a `.sim` file names, which users omit.
const EXTENSIONS: [&str; 4] = [".wld", ".maz", ".robi", ".esobj"];

/// Extensions, and the kinds of their files.
const FILE_KINDS: [(&str, &str); 10] = [
    ("sim", "a scene"),
    ("wld", "a world"),
    ("maz", "a maze"),
    ("maze", "a maze"),
    ("robi", "a robot type"),
    ("esObj", "an object type"),
    ("obj", "a mesh"),
    ("c", "a program"),
    ("cpp", "a program"),
    ("py", "a program"),
];

/// Loads a scene like [`load_scene`], with values that override those of the scene.
///
/// Random values are drawn from the seed. If a requirement of the scene on its positions is not met, all values are
/// drawn again, up to 100 times.
pub fn load_scene_with(path: &str, overrides: Overrides<'_>, files: &dyn Files) -> Loaded {
    load_with_spec(path, overrides, files).0
}

/// Loads a scene like [`load_scene_with`], and searches for mistakes that other seeds would reveal: tries the minimum
/// and maximum of each random range, all choices, and ten seeds.
pub fn check_scene(path: &str, overrides: Overrides<'_>, files: &dyn Files) -> Loaded {
    let (mut loaded, sim) = load_with_spec(path, overrides, files);
    let is_random = !sim.drawn.is_empty() || !loaded.scene.drawn.is_empty();
    if !is_random && !loaded.has_errors() {
        return loaded;
    }
    let Some(text) = files.read(path).ok().filter(|_| path::extension(path) == "toml") else { return loaded };
    let text = decode(&text).0;
    let choices = scene::choices(&text);
    let add = |loaded: &mut Loaded, diagnostics: Vec<Diagnostic>, note: &str| {
        for new in diagnostics {
            if loaded.diagnostics.iter().all(|known| (known.code, known.span) != (new.code, new.span)) {
                let message = format!("{} ({note})", new.message);
                loaded.diagnostics.push(Diagnostic { message, ..new });
            }
        }
    };
    for number in 0..choices {
        let diagnostics = read_scene_with(path, &text, overrides.settings, Draw::Extreme(number)).1;
        let note =
            if number % 2 == 0 { "with the least of random values" } else { "with the greatest of random values" };
        add(&mut loaded, diagnostics, note);
    }
    if choices > 0 || is_random {
        for seed in 0..CHECKED_SEED_COUNT {
            let seeded = load_scene_with(path, Overrides { seed: Some(seed), ..overrides }, files);
            add(&mut loaded, seeded.diagnostics, &format!("with seed {seed}"));
        }
    }
    loaded
}

/// Loads a scene; also returns the spec of its text, with the random values of the last attempt.
pub(super) fn load_with_spec(path: &str, overrides: Overrides<'_>, files: &dyn Files) -> (Loaded, SimSpec) {
    let mut full_attempts = 0;
    for attempt in 0.. {
        let (loaded, sim, may_retry) = load_attempt(path, overrides, files, attempt);
        let is_random = !sim.drawn.is_empty() || !loaded.scene.drawn.is_empty();
        full_attempts += u32::from(loaded.diagnostics.iter().any(|it| it.code == Code::SceneRoom));
        if !may_retry || !is_random || attempt + 1 >= MAX_ATTEMPTS || full_attempts >= MAX_FULL_ATTEMPTS {
            return (loaded, sim);
        }
    }
    unreachable!("the attempts end")
}

/// Makes one attempt to load a scene. Also returns the spec of its text, and true if another attempt may succeed.
fn load_attempt(path: &str, overrides: Overrides<'_>, files: &dyn Files, attempt: u32) -> (Loaded, SimSpec, bool) {
    let mut loader = Loader::new(files);
    let Some(text) = loader.read_root(path) else {
        let scene = SceneSpec { file: path.to_owned(), ..SceneSpec::default() };
        return (loader.finish(scene), SimSpec::default(), false);
    };
    let is_toml = path::extension(path) == "toml";
    let Overrides { seed, dialect, maze_cell, settings } = overrides;
    let (mut sim, diagnostics) =
        if is_toml { read_scene_with(path, &text, settings, Draw::Seed(seed, attempt)) } else { read_sim(path, &text) };
    let sim_as_written = sim.clone();
    loader.diagnostics.extend(diagnostics);
    if !is_toml && !settings.is_empty() {
        loader.diagnostics.push(set::not_toml(path));
    }
    sim.run.seed = seed.or(sim.run.seed);
    sim.run.dialect = dialect.or(sim.run.dialect);
    sim.world.iter_mut().for_each(|line| line.cell = maze_cell.or(line.cell));
    let folder = path::folder_of(path).to_owned();
    for (robi, _) in &mut sim.inline.robot_types {
        loader.read_serial_files(path, &folder, robi);
    }
    loader.read_profiles(path, &folder, &mut sim);
    let mut world = loader.find_world(&sim, &folder);
    loader.read_meshes(path, world.as_mut(), &mut sim.inline.object_types);
    let placement = place::place(&mut loader, &sim, &folder, world.as_ref(), attempt);
    if let Some(world) = &mut world {
        world.walls = placement.walls;
    }
    let costs = sim.run.costs.take().and_then(|costs| loader.find_costs(path, &folder, costs));
    checks::set_folder(&mut sim.checks, &folder);
    let scene = SceneSpec {
        file: path.to_owned(),
        folder,
        world: world.unwrap_or_default(),
        robots: placement.robots,
        objects: placement.objects,
        markers: sim.markers,
        settings: sim.settings,
        run: RunSpec { costs, ..sim.run },
        radio: sim.radio,
        checks: sim.checks,
        faults: sim.faults,
        drawn: sim.drawn.into_iter().chain(placement.drawn).collect(),
    };
    loader.diagnostics.extend(unknown_sensors(&scene.robots));
    loader.check_wheels_on_terrain(&scene);
    loader.check_hulls(&scene);
    loader.diagnostics.extend(checks::check(&scene));
    loader.diagnostics.extend(faults::check(&scene));
    loader.diagnostics.extend(clearance::check(&scene, placement.world_object_count));
    (loader.finish(scene), sim_as_written, placement.may_retry)
}

/// Reads only a world file of any kind; the scene of the result has no robots.
pub fn load_world(path: &str, files: &dyn Files) -> Loaded {
    load_world_with(path, CellRules::default(), files)
}

/// Reads only a world file of any kind, with `rules` for the size of its cells; the scene of the result has no robots.
pub fn load_world_with(path: &str, rules: CellRules, files: &dyn Files) -> Loaded {
    let mut loader = Loader::new(files);
    let mut scene = SceneSpec { file: path.to_owned(), ..SceneSpec::default() };
    if let Some(bytes) = loader.read_root_bytes(path) {
        scene.world = map::read_world_file(&mut loader, path, bytes, WorldKind::World, rules);
    }
    loader.finish(scene)
}

/// Reads only a robi and its companion; `None` if the file does not exist. The scene of the result is empty.
pub fn load_robi(path: &str, files: &dyn Files) -> (Option<RobiSpec>, Loaded) {
    let mut loader = Loader::new(files);
    let robi = loader.read_root(path).map(|text| loader.read_robi_text(path, &text));
    (robi, loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() }))
}

/// Reads only an object file; `None` if the file does not exist. The scene of the result is empty.
pub fn load_object(path: &str, files: &dyn Files) -> (Option<ObjectType>, Loaded) {
    let mut loader = Loader::new(files);
    let object = loader.read_root(path).map(|text| {
        let (object, diagnostics) = read_esobj(path, &text);
        loader.diagnostics.extend(diagnostics);
        object
    });
    (object, loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() }))
}

/// Reads only a noise profile; `None` if the file does not exist. The scene of the result is empty.
pub fn load_noise(path: &str, files: &dyn Files) -> (Option<NoiseRef>, Loaded) {
    let mut loader = Loader::new(files);
    let noise = loader.read_root(path).map(|text| loader.read_profile(path, &text));
    (noise, loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() }))
}

/// Reads only a cost table; `None` if the file does not exist. The scene of the result is empty.
pub fn load_costs(path: &str, files: &dyn Files) -> (Option<CostTable>, Loaded) {
    let mut loader = Loader::new(files);
    let costs = loader.read_root(path).map(|text| {
        let (table, diagnostics) = read_costs(path, &text);
        loader.diagnostics.extend(diagnostics);
        table
    });
    (costs, loader.finish(SceneSpec { file: path.to_owned(), ..SceneSpec::default() }))
}

/// Decodes a file as UTF-8; invalid bytes become U+FFFD. Also returns the offset of the first invalid byte, if any.
pub fn decode(bytes: &[u8]) -> (String, Option<usize>) {
    match std::str::from_utf8(bytes) {
        Ok(text) => (text.to_owned(), None),
        Err(error) => (String::from_utf8_lossy(bytes).into_owned(), Some(error.valid_up_to())),
    }
}

/// Finds files, reads each type once, and collects the diagnostics.
pub(super) struct Loader<'a> {
    pub(super) files: &'a dyn Files,
    pub(super) diagnostics: Vec<Diagnostic>,
    pub(super) inputs: Vec<InputFile>,
    pub(super) notes: Vec<String>,
    robots: TypeCache<RobiSpec>,
    objects: TypeCache<ObjectType>,
}

/// Cache of types that were read.
struct TypeCache<T> {
    /// Types by the text of the reference; `None` for a file that does not exist.
    by_reference: BTreeMap<String, Option<Arc<T>>>,
    /// Types by the path of the file.
    by_path: BTreeMap<String, Arc<T>>,
}

impl<T> Default for TypeCache<T> {
    fn default() -> Self {
        Self { by_reference: BTreeMap::new(), by_path: BTreeMap::new() }
    }
}

impl<'a> Loader<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        let (robots, objects) = (TypeCache::default(), TypeCache::default());
        Self { files, diagnostics: Vec::new(), inputs: Vec::new(), notes: Vec::new(), robots, objects }
    }

    pub(super) fn finish(self, scene: SceneSpec) -> Loaded {
        Loaded { scene, diagnostics: self.diagnostics, inputs: self.inputs, notes: self.notes }
    }

    /// Reads the file that the user named.
    pub(super) fn read_root(&mut self, path: &str) -> Option<String> {
        self.read_root_bytes(path).map(|bytes| self.decode_input(path, bytes))
    }

    /// Reads the bytes of the file that the user named.
    pub(super) fn read_root_bytes(&mut self, path: &str) -> Option<Vec<u8>> {
        match self.files.read(path) {
            Ok(bytes) => Some(bytes),
            Err(error) => {
                let mut sink = Sink::new(path);
                sink.error(error.code(), Span::default(), format!("{error}"), "a file that can be read");
                self.diagnostics.extend(sink.finish());
                None
            }
        }
    }

    /// Records a file as input and decodes it. Reports an error for UTF-16 and returns an empty text.
    pub(super) fn decode_input(&mut self, path: &str, bytes: Vec<u8>) -> String {
        if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
            let mut sink = Sink::new(path);
            let diagnostic = sink.error(Code::FileEncoding, Span::default(), "the file is UTF-16", "UTF-8 or ASCII");
            diagnostic.suggestion = Some("save it as UTF-8".to_owned());
            self.diagnostics.extend(sink.finish());
            self.inputs.push(InputFile { path: path.to_owned(), bytes });
            return String::new();
        }
        let (text, invalid) = decode(&bytes);
        if let Some(index) = invalid {
            let starts = line::line_starts(&text[..index]);
            let line = &text[starts.last().copied().unwrap_or_default()..index];
            // Only at the start of the text, U+FEFF is a byte order mark.
            let line = if starts.len() == 1 { line.trim_start_matches('\u{feff}') } else { line };
            let span = Span {
                start: index,
                end: index + char::REPLACEMENT_CHARACTER.len_utf8(),
                line: starts.len() as u32,
                column: line.chars().count() as u32 + 1,
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

    /// Path and content of the file that `reference` in `file` refers to. If no file is at the paths of the reference,
    /// a file with a name in other case, with a further `.txt` or in another folder is taken, with a warning; if there
    /// is none, an error lists the paths.
    pub(super) fn find(&mut self, file: &str, folder: &str, reference: &SpannedText) -> Option<(String, Vec<u8>)> {
        self.find_or(Severity::Error, file, folder, reference)
    }

    /// Like [`Loader::find`], with a given `severity` for a missing file.
    pub(super) fn find_or(
        &mut self,
        severity: Severity,
        file: &str,
        folder: &str,
        reference: &SpannedText,
    ) -> Option<(String, Vec<u8>)> {
        let candidates = path::candidates(&reference.text, folder, self.files.home());
        let mut sink = Sink::new(file);
        let mut found = None;
        for candidate in &candidates {
            match self.files.read(candidate) {
                Ok(bytes) => found = Some((candidate.clone(), bytes)),
                Err(FileError::Missing) => continue,
                Err(error) => {
                    let message = format!("`{candidate}` cannot be read: {error}");
                    sink.report(severity, error.code(), reference.span, message, "a file that can be read");
                    self.diagnostics.extend(sink.finish());
                    return None;
                }
            }
            break;
        }
        if found.is_none() {
            found = candidates.iter().find_map(|candidate| self.find_in_other_case(candidate));
            if let Some((candidate, _)) = &found {
                let message =
                    format!("`{}` is found only as `{candidate}`: upper and lower case differ", reference.text);
                sink.warn(Code::FileCase, reference.span, message, "the name as the file has it");
            }
        }
        if found.is_none() {
            let renamed = candidates.iter().filter_map(|candidate| path::with_txt(candidate));
            found = renamed.into_iter().find_map(|path| Some((path.clone(), self.files.read(&path).ok()?)));
            if let Some((candidate, _)) = &found {
                let message = format!("`{}` is not found; `{candidate}` is used instead", reference.text);
                sink.warn(Code::FileMoved, reference.span, message, "the name as the file has it");
            }
        }
        if found.is_none() {
            let relocated = path::relocated_candidates(&reference.text, folder, self.files.home());
            let exact =
                relocated.iter().find_map(|candidate| Some((candidate.clone(), self.files.read(candidate).ok()?)));
            found = exact.or_else(|| relocated.iter().find_map(|candidate| self.find_in_other_case(candidate)));
            if let Some((candidate, _)) = &found {
                let message = format!("`{}` is not found; `{candidate}` is used instead", reference.text);
                sink.warn(Code::FileMoved, reference.span, message, "a name relative to this file");
            }
        }
        if found.is_none() {
            let message = format!("`{}` is not found; tried {}", reference.text, tried_paths(&candidates));
            let expected = "a file relative to this one, to the working folder or to the installation (`%sim%`)";
            let diagnostic = sink.report(severity, Code::FileMissing, reference.span, message, expected);
            let stem = path::stem(&reference.text);
            let built_in = builtin::ROBOTS.iter().find(|name| name.eq_ignore_ascii_case(stem));
            let built_in = built_in.filter(|_| matches!(path::extension(&reference.text).as_str(), "robi" | ""));
            diagnostic.suggestion = match built_in {
                Some(name) => Some(format!("`{name}` is built in: write `{name} X Y PHI PROGRAM`")),
                None if reference.text.starts_with(['~', '$']) => {
                    Some("`~` and variables such as `$HOME` are not expanded: write the whole path".to_owned())
                }
                None => self.similar_path(&candidates).map(|name| format!("there is `{name}`")),
            };
        }
        self.diagnostics.extend(sink.finish());
        found
    }

    /// File whose path differs from `wanted` only in letter case.
    fn find_in_other_case(&self, wanted: &str) -> Option<(String, Vec<u8>)> {
        let root = if wanted.starts_with('/') { "/" } else { "" };
        let mut path = root.to_owned();
        for part in wanted.split('/').filter(|part| !part.is_empty()) {
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

    /// File with a similar name, or with an extension in addition, in one of the folders tried.
    fn similar_path(&self, paths: &[String]) -> Option<String> {
        paths.iter().find_map(|path| {
            let folder = &path[..path.len() - path::file_name(path).len()];
            let mut names = self.files.list(path::folder_of(path));
            // A name without an extension is probably that of a folder.
            names.retain(|name| name.contains('.'));
            names.sort_unstable();
            let name = path::file_name(path).to_lowercase();
            let is_of_stem = |other: &&String| {
                let other = other.to_lowercase();
                EXTENSIONS.iter().any(|extension| other.strip_suffix(extension) == Some(&name))
            };
            let nearest = match names.iter().find(is_of_stem) {
                Some(name) => name,
                None => line::nearest(path::file_name(path), names.iter().map(String::as_str))?,
            };
            Some(format!("{folder}{nearest}"))
        })
    }

    /// Reads the world of a scene, from its text or from the file that it refers to. A scene without a world gets a
    /// default world, or `None` and an error.
    fn find_world(&mut self, sim: &SimSpec, folder: &str) -> Option<WorldSpec> {
        if let Some(world) = &sim.inline.world {
            return Some(world.clone());
        }
        let Some(line) = &sim.world else {
            // A line that could not be read has already caused an error.
            if super::has_errors(&self.diagnostics) {
                return None;
            }
            let is_classic = sim.robots.iter().any(|robot| matches!(robot.kind, TypeRef::File(_)));
            let (severity, message) = if is_classic {
                (Severity::Error, "no world is given")
            } else {
                (Severity::Warning, "no world is given: an empty box of 2000 mm by 2000 mm is used, as in EyeSim VR")
            };
            let mut sink = Sink::new(&sim.file);
            let expected = "`world FILE.wld` or `maze FILE.maz`";
            sink.report(severity, Code::SimWorldMissing, Span::default(), message, expected);
            self.diagnostics.extend(sink.finish());
            return (!is_classic).then(empty_box);
        };
        if !self.is_of_kind(Severity::Error, &sim.file, &line.path, &["a world", "a maze"]) {
            return None;
        }
        let (path, bytes) = self.find(&sim.file, folder, &line.path)?;
        // A file at another place is reported already.
        let home = self.files.home();
        let is_at_its_place = path::candidates(&line.path.text, folder, home).contains(&path);
        if is_at_its_place && path::is_from_installation(&line.path.text, folder, &path, home) {
            self.tell_of_installation(&sim.file, folder, &line.path, (&path, &bytes));
        }
        let rules = CellRules { dialect: sim.run.dialect, cell: line.cell };
        let world = map::read_world_file(self, &path, bytes, line.kind, rules);
        Some(WorldSpec { looks: line.looks, ..world })
    }

    /// Notes that a file of the installation is used; warns if a file of this name with another content is near
    /// `folder`.
    fn tell_of_installation(&mut self, file: &str, folder: &str, reference: &SpannedText, found: (&str, &[u8])) {
        let (path, bytes) = found;
        let name = path::file_name(&reference.text);
        let is_other = |path: &String| self.files.read(&path::join(folder, path)).is_ok_and(|other| other != bytes);
        let Some(nearby) = types::files_nearby(self.files, folder, name).into_iter().find(is_other) else {
            self.notes.push(format!("{file}: `{}` is that of the installation, `{path}`", reference.text));
            return;
        };
        let message = format!("`{}` is that of the installation, `{path}`, and not `{nearby}`", reference.text);
        let mut sink = Sink::new(file);
        let diagnostic =
            sink.warn(Code::FileMoved, reference.span, message, "a name relative to this file, or `%sim%/NAME`");
        diagnostic.suggestion = Some(format!("write `{nearby}`, if that file is meant"));
        self.diagnostics.extend(sink.finish());
    }

    /// Cost table of the scene `file`; reads it if `costs` refers to a file.
    fn find_costs(&mut self, file: &str, folder: &str, costs: CostsRef) -> Option<CostsRef> {
        let CostsRef::File(reference) = costs else {
            return Some(costs);
        };
        let (path, bytes) = self.find(file, folder, &reference)?;
        let text = self.decode_input(&path, bytes);
        let (table, diagnostics) = read_costs(&path, &text);
        self.diagnostics.extend(diagnostics);
        Some(CostsRef::Table(table))
    }

    /// Reads the noise profiles that the scene `file` and its robots refer to.
    fn read_profiles(&mut self, file: &str, folder: &str, sim: &mut SimSpec) {
        let mut read: BTreeMap<String, Option<NoiseRef>> = BTreeMap::new();
        let robot_noise = sim.robots.iter_mut().map(|line| &mut line.noise);
        for noise in robot_noise.chain([&mut sim.run.noise]) {
            let Some(NoiseRef::File(reference)) = noise else { continue };
            *noise = match read.get(&reference.text) {
                Some(cached) => cached.clone(),
                None => {
                    let profile = self.find(file, folder, reference).map(|(path, bytes)| {
                        let text = self.decode_input(&path, bytes);
                        self.read_profile(&path, &text)
                    });
                    read.insert(reference.text.clone(), profile.clone());
                    profile
                }
            };
        }
    }

    fn read_profile(&mut self, path: &str, text: &str) -> NoiseRef {
        let (profile, diagnostics) = read_noise(path, text);
        self.diagnostics.extend(diagnostics);
        NoiseRef::Profile(Arc::new(profile))
    }

    /// Reports a `reference` whose extension is that of a file of other than these `kinds`, and returns false.
    fn is_of_kind(&mut self, severity: Severity, file: &str, reference: &SpannedText, kinds: &[&str]) -> bool {
        let extension = path::extension(&reference.text);
        let found = FILE_KINDS.iter().find(|(other, _)| other.eq_ignore_ascii_case(&extension));
        let Some((_, kind)) = found.filter(|(_, kind)| !kinds.contains(kind)) else {
            return true;
        };
        let mut sink = Sink::new(file);
        let message = format!("`{}` is {kind}, and not {}", reference.text, kinds.join(" or "));
        let extensions: Vec<&str> =
            FILE_KINDS.iter().filter(|(_, kind)| kinds.contains(kind)).map(|(extension, _)| *extension).collect();
        let expected = format!("a file that ends in .{}", extensions.join(" or ."));
        sink.report(severity, Code::FileKind, reference.span, message, expected);
        self.diagnostics.extend(sink.finish());
        false
    }

    /// Robot type that `reference` in the sim file `file` refers to; an error if it does not exist.
    pub(super) fn robot_type(&mut self, file: &str, folder: &str, reference: &SpannedText) -> Option<Arc<RobiSpec>> {
        if let Some(cached) = self.robots.by_reference.get(&reference.text) {
            return cached.clone();
        }
        let is_robi = self.is_of_kind(Severity::Error, file, reference, &["a robot type"]);
        let found = if is_robi { self.find(file, folder, reference) } else { None };
        let robi = found.map(|(path, bytes)| {
            if let Some(robi) = self.robots.by_path.get(&path) {
                return Arc::clone(robi);
            }
            let text = self.decode_input(&path, bytes);
            let robi = Arc::new(self.read_robi_text(&path, &text));
            self.robots.by_path.insert(path, Arc::clone(&robi));
            robi
        });
        self.robots.by_reference.insert(reference.text.clone(), robi.clone());
        robi
    }

    /// Object type that `reference` in the sim file `file` refers to; a warning if it does not exist.
    pub(super) fn object_type(&mut self, file: &str, folder: &str, reference: &SpannedText) -> Option<Arc<ObjectType>> {
        if let Some(cached) = self.objects.by_reference.get(&reference.text) {
            return cached.clone();
        }
        let is_object = self.is_of_kind(Severity::Warning, file, reference, &["an object type"]);
        let found = if is_object { self.find_or(Severity::Warning, file, folder, reference) } else { None };
        let object = found.map(|(path, bytes)| {
            if let Some(object) = self.objects.by_path.get(&path) {
                return Arc::clone(object);
            }
            let text = self.decode_input(&path, bytes);
            let (object, diagnostics) = read_esobj(&path, &text);
            self.diagnostics.extend(diagnostics);
            let object = Arc::new(object);
            self.objects.by_path.insert(path, Arc::clone(&object));
            object
        });
        self.objects.by_reference.insert(reference.text.clone(), object.clone());
        object
    }

    /// Reads a robi and the companion beside it.
    fn read_robi_text(&mut self, path: &str, text: &str) -> RobiSpec {
        let (mut robi, diagnostics) = read_robi(path, text);
        self.diagnostics.extend(diagnostics);
        let companion = path::with_extension(path, "toml");
        match self.files.read(&companion) {
            Ok(bytes) => {
                let text = self.decode_input(&companion, bytes);
                self.diagnostics.extend(read_companion(&companion, &text, &mut robi));
                self.read_serial_files(&companion, path::folder_of(&companion), &mut robi);
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
}

impl Loader<'_> {
    /// Reads the data files of the devices at the serial interfaces of a type in `file`.
    fn read_serial_files(&mut self, file: &str, folder: &str, robi: &mut RobiSpec) {
        for serial in &mut robi.serials {
            if let SerialLine::File { path, bytes } = &mut serial.line
                && let Some((found_path, content)) = self.find(file, folder, path)
            {
                *bytes = content.as_slice().into();
                self.inputs.push(InputFile { path: found_path, bytes: content });
            }
        }
    }
}

impl Loader<'_> {
    /// Reads the meshes that range sensors detect: those of the terrain and of objects. `file` is the scene.
    fn read_meshes(&mut self, file: &str, world: Option<&mut WorldSpec>, objects: &mut [(ObjectType, Span)]) {
        let mut reader = MeshReader::new(self.files);
        let mut sink = Sink::new(file);
        let mut report_missing = |model: &ModelSpec| {
            let message = format!("range sensors are to see the mesh `{}`, which cannot be read", model.path.text);
            sink.error(Code::MeshSolid, model.path.span, message, "an .obj file with triangles");
        };
        if let Some(world) = world {
            reader.terrain(world);
        }
        for (object, _) in objects {
            let Some(model) = object.model.as_ref().filter(|_| object.sensor_shape != SensorShape::Colliders) else {
                continue;
            };
            let mesh = reader.object(object);
            if mesh.is_none() {
                report_missing(model);
            }
            object.sensor_shape = SensorShape::Mesh(mesh);
        }
        let (diagnostics, inputs) = reader.finish();
        self.diagnostics.extend(diagnostics);
        self.diagnostics.extend(sink.finish());
        self.inputs.extend(inputs);
    }
}

impl Loader<'_> {
    /// Warns once if a robot on wheels starts on ground that is not level with the floor.
    fn check_wheels_on_terrain(&mut self, scene: &SceneSpec) {
        let Some(terrain) = &scene.world.terrain else { return };
        let Some(field) = &terrain.field else { return };
        let is_not_level = |robot: &&RobotSpec| {
            if matches!(robot.robi.drive.kind, DriveKind::Legged | DriveKind::Thrusters) {
                return false;
            }
            let (low, high) = field.height_bounds_in(robot.start.position, 0.5 * robot.robi.diameter);
            low.abs().max(high.abs()) > LEVEL_TOLERANCE
        };
        let Some(robot) = scene.robots.iter().find(is_not_level) else { return };
        let message =
            format!("robot {} has wheels: it stands and drives on the plane z = 0, not on the terrain", robot.id.0);
        let mut sink = Sink::new(&scene.world.file);
        sink.warn(Code::TerrainWheels, terrain.span, message, "level ground at height 0 under robots with wheels");
        self.diagnostics.extend(sink.finish());
    }
}

impl Loader<'_> {
    /// Reports robots with thrusters whose hull the water does not cover.
    fn check_hulls(&mut self, scene: &SceneSpec) {
        let mut sink = Sink::new(&scene.file);
        let depth = scene.world.water.unwrap_or_default();
        for robot in
            scene.robots.iter().filter(|robot| build::hull(&robot.robi, depth).is_some_and(|hull| hull.ceiling < 0.0))
        {
            let height = mm_from_metres(build::hull_height(&robot.robi));
            let message = match scene.world.water {
                None => format!("robot {} has thrusters, and the world no water", robot.id.0),
                Some(depth) => {
                    let depth = mm_from_metres(depth);
                    format!("the water is {depth:.0} mm deep, the hull of robot {} {height:.0} mm high", robot.id.0)
                }
            };
            let expected = format!(
                "a world with `water DEPTH` in its .wld, or `water_mm` in its table, of {height:.0} mm or more"
            );
            sink.error(Code::WaterMissing, robot.span, message, expected);
        }
        self.diagnostics.extend(sink.finish());
    }
}

/// EyeSim VR's default world for a scene without a world: a box with a wall on each side.
fn empty_box() -> WorldSpec {
    const SIDE: f64 = 2.0;
    let corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)].map(DVec2::from);
    let wall = |side: usize| WallSpec {
        from: corners[side],
        to: corners[(side + 1) % 4],
        thickness: 0.0,
        height: DEFAULT_WALL_HEIGHT,
        colour: None,
        surface: None,
        scatter: None,
        span: Span::default(),
    };
    WorldSpec { floor: DVec2::splat(SIDE), walls: (0..4).map(wall).collect(), ..WorldSpec::default() }
}

impl FileError {
    fn code(&self) -> Code {
        match self {
            FileError::Missing => Code::FileMissing,
            FileError::Unreadable(_) => Code::FileUnreadable,
        }
    }
}

fn tried_paths(paths: &[String]) -> String {
    if paths.is_empty() {
        return "nothing, since the installation's folder is unknown".to_owned();
    }
    paths.iter().map(|path| format!("`{path}`")).collect::<Vec<_>>().join(", ")
}
