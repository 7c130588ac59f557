//! A scene and the contents of its files, before its programs are built.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sim_core::spec::{CostsRef, Dialect, RobotSpec, SceneSpec};
use sim_format::path::extension;
use sim_format::suite::{check_of_suite, is_suite, read_suite};
use sim_format::{Diagnostic, InputFile, Loaded, Severity, decode, is_scene, load_scene_with};

use super::built::BuiltScene;
use super::ready::Ready;
use super::settings::{Settings, assign_noise};
use super::{Error, OptionError, Options, Rejected, check};
use crate::files::{DiskFiles, read_regular, slashed};
use crate::program::find::SearchPath;
use crate::program::parts::parts_of;
use crate::program::scene::{Programs, generation_hint};
use crate::program::{Builder, Cache, GenerationHint, Kits, Tools};
use crate::record::report::Input;
use crate::scenery::LazyScenery;

/// A scene that has been read, with the options of its run.
pub struct Scene {
    options: Options,
    files: DiskFiles,
    loaded: Loaded,
}

impl Scene {
    /// Reads the scene at `path`, a sim file or a scene in TOML, with all files to which it refers. Mistakes in the
    /// files are in [`Scene::diagnostics`].
    ///
    /// # Errors
    /// [`Error::NotAScene`]; [`Error::Option`] for an unknown noise profile, the cell size of a maze without a maze
    /// file, or a suite of checks that cannot be read.
    pub fn open(path: impl AsRef<Path>, options: Options) -> Result<Self, Error> {
        let path = path.as_ref();
        expect_scene(path)?;
        Self::read(path, DiskFiles::of_environment(), options)
    }

    /// Reads a scene like [`Scene::open`], but from `text`. The file `path` need not exist: its name determines the
    /// format, and its folder is searched for the files that the scene names.
    ///
    /// # Errors
    /// [`Error::Option`] as for [`Scene::open`].
    pub fn from_text(path: impl AsRef<Path>, text: &str, options: Options) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::read(path, DiskFiles::of_environment().with_text(path, text), options)
    }

    fn read(path: &Path, mut files: DiskFiles, options: Options) -> Result<Self, Error> {
        let mut loaded = load_scene_with(&files.name(path), options.overrides(), &files);
        if options.maze_cell.is_some_and(|cell| loaded.scene.world.cell != Some(cell)) && !loaded.has_errors() {
            return Err(OptionError::NoMazeFile { scene: path.display().to_string() }.into());
        }
        loaded.scene.run.contact = options.contact.or(loaded.scene.run.contact);
        if let Some(noise) = &options.noise {
            assign_noise(&mut loaded, noise, &mut files)?;
        }
        if let Some(CostsRef::Table(table)) = loaded.scene.run.costs.as_ref().filter(|_| options.costs.is_none()) {
            loaded.diagnostics.extend(check::unknown_functions(table));
        }
        loaded.diagnostics.extend(check::unknown_forbidden_functions(&loaded.scene.file, &loaded.scene.run.forbid));
        loaded.diagnostics.extend(check::invalid_checks(&loaded.scene));
        if let Some(path) = &options.checks {
            add_checks(&mut loaded, path)?;
        }
        Ok(Self { options, files, loaded })
    }

    /// The scene's specification.
    pub fn spec(&self) -> &SceneSpec {
        &self.loaded.scene
    }

    /// The scene's specification, to be changed before it is built. A trace of the run does not contain the changes, so
    /// it cannot repeat the run by itself.
    pub fn spec_mut(&mut self) -> &mut SceneSpec {
        &mut self.loaded.scene
    }

    /// Dialect inferred from the contents of the sim file, if it is not the default dialect and no option sets one.
    pub fn guessed_dialect(&self) -> Option<Dialect> {
        let is_sim = !self.loaded.scene.file.to_lowercase().ends_with(".toml");
        self.loaded.scene.run.dialect.filter(|_| is_sim && self.options.dialect.is_none())
    }

    /// Mistakes in the scene's files.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.loaded.diagnostics
    }

    /// Notes on the interpretation and the locations of the scene's files, a line each.
    pub fn notes(&self) -> &[String] {
        &self.loaded.notes
    }

    /// The scene's files.
    pub fn inputs(&self) -> &[InputFile] {
        &self.loaded.inputs
    }

    /// Options of the run.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Returns true if the scene cannot be run because of its [diagnostics](Scene::diagnostics).
    pub fn is_rejected(&self) -> bool {
        check::is_rejected(&self.loaded.diagnostics, self.options.strict)
    }

    /// Builder for the programs, with the compilers, flags and cache folder of this process's environment.
    ///
    /// # Errors
    /// [`Error::Folder`] if no cache folder can be used.
    pub fn builder(&self) -> Result<Builder, Error> {
        let cache = Cache::of_user().map_err(folder("folder for built programs"))?;
        let mut tools = Tools::of_environment();
        if self.options.debug.is_some() {
            // Without optimisation the debugger finds every line and variable. The user's flags follow and take
            // precedence.
            tools.cflags = Some(format!("-O0 {}", tools.cflags.unwrap_or_default()));
        }
        Ok(Builder::new(cache, Kits::of_robios(), tools).with_sandbox(self.options.sandbox.clone()))
    }

    /// Finds, builds and loads the programs of the robots.
    ///
    /// # Errors
    /// See [`Scene::build`] and [`BuiltScene::load`].
    pub fn load(self) -> Result<Ready, Error> {
        let builder = self.builder()?;
        self.build(&builder)?.load()
    }

    /// Finds the programs of the robots and builds each once with `builder`.
    ///
    /// # Errors
    /// [`Error::Rejected`] for mistakes in the scene's files, which include a program that is not found;
    /// [`Error::Option`] for an option that does not fit the scene; [`Error::Programs`] for programs that cannot be
    /// built.
    pub fn build(self, builder: &Builder) -> Result<BuiltScene, Error> {
        self.build_with(builder, &mut ProgramCache::default())
    }

    /// Finds the programs like [`Scene::build`], and builds those that are not in `cache`.
    ///
    /// # Errors
    /// See [`Scene::build`].
    pub fn build_with(mut self, builder: &Builder, cache: &mut ProgramCache) -> Result<BuiltScene, Error> {
        let reject = |diagnostics, inputs| Error::Rejected(Rejected { diagnostics, inputs });
        if self.is_rejected() {
            return Err(reject(self.loaded.diagnostics, self.loaded.inputs));
        }
        let settings = self.settings()?;
        let option_files = || settings.costs_input.iter().chain(&settings.stdin_input);
        let files_of_script = |script: PathBuf| parts_of(&script).into_iter().chain([script]);
        let scripts = hash_files(check::scripts(&self.loaded.scene).flat_map(files_of_script));
        let key = ProgramCache::key(&self.loaded.scene);
        if let Some((programs, sources)) = cache.programs_by_key.get(&key) {
            let Self { options, files, loaded: Loaded { scene, diagnostics, inputs, .. } } = self;
            let inputs_read = read_files(inputs.iter().chain(option_files()), sources.iter().chain(&scripts));
            let scene = Arc::new(scene);
            let scenery = Arc::new(LazyScenery::new(Arc::clone(&scene), files, diagnostics, inputs));
            return Ok(BuiltScene {
                options,
                settings,
                scene,
                scenery,
                inputs: inputs_read,
                programs: programs.clone(),
            });
        }
        let search = check::search_path(&self.files).map_err(folder("working folder"))?;
        let search = SearchPath { embedded: self.options.embedded.clone(), ..search };
        let Self { options, files, loaded: Loaded { scene, diagnostics, inputs, .. } } = self;
        let finder = check::finder(search.clone(), options.api, options.sandbox.clone());
        let missing = check::missing_programs(&scene, Severity::Error, &*finder);
        if !missing.is_empty() {
            return Err(reject(missing, inputs));
        }
        let search = SearchPath { sim_folder: Some(PathBuf::from(&scene.folder)), ..search };
        let programs = Programs::build(&scene, &search, builder)?;
        let sources = source_inputs(&programs);
        let inputs_read = read_files(inputs.iter().chain(option_files()), sources.iter().chain(&scripts));
        cache.programs_by_key.insert(key, (programs.clone(), sources));
        let scene = Arc::new(scene);
        let scenery = Arc::new(LazyScenery::new(Arc::clone(&scene), files, diagnostics, inputs));
        Ok(BuiltScene { options, settings, scene, scenery, inputs: inputs_read, programs })
    }

    /// Computes the settings of the run, and assigns the programs and arguments of the options to its robots.
    ///
    /// # Errors
    /// An option does not fit the scene.
    pub fn settings(&mut self) -> Result<Settings, OptionError> {
        Settings::new(&self.options, &mut self.loaded.scene)
    }

    /// The scene's specification and the scenery of its cameras.
    pub fn into_scenery(self) -> (Arc<SceneSpec>, LazyScenery) {
        let Loaded { scene, diagnostics, inputs, .. } = self.loaded;
        let scene = Arc::new(scene);
        (Arc::clone(&scene), LazyScenery::new(scene, self.files, diagnostics, inputs))
    }
}

/// Adds the checks of the suite at `path` to the scene's checks.
///
/// # Errors
/// The suite cannot be read.
fn add_checks(loaded: &mut Loaded, path: &Path) -> Result<(), OptionError> {
    let file = slashed(path);
    let bytes = read_regular(path).map_err(|error| OptionError::Checks { file: file.clone(), error })?;
    let (suite, diagnostics) = read_suite(&file, &decode(&bytes).0);
    loaded.diagnostics.extend(diagnostics);
    loaded.diagnostics.extend(check_of_suite(&suite, &loaded.scene));
    let suite_scene = SceneSpec { file: file.clone(), checks: suite.checks, ..SceneSpec::default() };
    loaded.diagnostics.extend(check::invalid_checks(&suite_scene));
    loaded.scene.checks.extend(suite_scene.checks);
    loaded.inputs.push(InputFile { path: file, bytes });
    Ok(())
}

/// A path that is not that of a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAScene {
    /// The path is a folder.
    #[error("`{}` is a folder: name the scene in it (NAME.sim or NAME.scene.toml)", .0.display())]
    Folder(PathBuf),
    /// The path is a suite.
    #[error("`{path}` is a suite: `eyesim test {path}` runs it", path = .0.display())]
    Suite(PathBuf),
    /// The path is a TOML file without the tables of a scene.
    #[error("`{}` is not a scene: it has none of `scene`, `world` and `robot` at its top level", .0.display())]
    OtherToml(PathBuf),
    /// The extension belongs to another kind of file.
    #[error(
        "`{}` is not a scene: expected NAME.sim or NAME.scene.toml, which names a world and, for each robot, a type and a program",
        .0.display()
    )]
    OtherFile(PathBuf),
}

/// Function for `map_err` that converts to [`Error::Folder`].
fn folder(purpose: &'static str) -> impl Fn(std::io::Error) -> Error {
    move |error| Error::Folder { purpose, error }
}

/// Checks that the path is that of a scene and not, for example, of a program.
fn expect_scene(path: &Path) -> Result<(), NotAScene> {
    let path_buf = || path.to_owned();
    if path.is_dir() {
        return Err(NotAScene::Folder(path_buf()));
    }
    let extension = extension(&path.to_string_lossy());
    if extension == "toml" {
        // The reader reports a file that cannot be read.
        let text = read_regular(path).map(|bytes| decode(&bytes).0);
        let test = |is_kind: fn(&str, &str) -> bool| text.as_ref().map(|text| is_kind(&path.to_string_lossy(), text));
        if test(is_suite).unwrap_or(false) {
            return Err(NotAScene::Suite(path_buf()));
        }
        if !test(is_scene).unwrap_or(true) {
            return Err(NotAScene::OtherToml(path_buf()));
        }
    } else if !extension.is_empty() && extension != "sim" {
        return Err(NotAScene::OtherFile(path_buf()));
    }
    Ok(())
}

/// Hashes of `files`, followed by `hashed`.
fn read_files<'a>(files: impl Iterator<Item = &'a InputFile>, hashed: impl Iterator<Item = &'a Input>) -> Vec<Input> {
    let mut inputs: Vec<Input> = files.map(|file| Input::new(Path::new(&file.path), &file.bytes)).collect();
    inputs.extend(hashed.cloned());
    inputs
}

/// Hashes of the files of programs, each file once.
fn source_inputs(programs: &Programs) -> Vec<Input> {
    hash_files(programs.iter().flat_map(|program| program.inputs()))
}

/// Hashes of the files at these paths, each file once.
fn hash_files(paths: impl Iterator<Item = PathBuf>) -> Vec<Input> {
    let paths: BTreeSet<PathBuf> = paths.collect();
    // A source that was deleted after its compilation cannot be hashed any more.
    paths.iter().filter_map(|path| Some(Input::new(path, &read_regular(path).ok()?))).collect()
}

/// Cache of the built programs of scenes. Further runs with the same programs need not search or build them
/// again.
#[derive(Default)]
pub struct ProgramCache {
    programs_by_key: BTreeMap<CacheKey, (Programs, Vec<Input>)>,
}

/// Folder of the scene, and for each robot: program, true if a file of the scene names the program, generation and
/// dialect.
type CacheKey = (String, Vec<(String, bool, GenerationHint)>);

impl ProgramCache {
    fn key(scene: &SceneSpec) -> CacheKey {
        let robot_key = |robot: &RobotSpec| {
            let is_from_file = robot.program.as_ref().is_some_and(|program| program.span.line > 0);
            (robot.program_name().to_owned(), is_from_file, generation_hint(robot))
        };
        (scene.folder.clone(), scene.robots.iter().map(robot_key).collect())
    }
}
