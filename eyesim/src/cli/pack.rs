//! `eyesim pack`: writes a scene or a suite into one archive, with everything that its runs read; opens archives for
//! the other commands.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use sim_core::spec::SceneSpec;
use sim_format::suite::is_suite;
use sim_format::{Files as _, InputFile, load_scene_with};
use sim_host::files::{DiskFiles, read_regular, slashed, use_home};
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{BuiltScene, Options, Scene, check};
use sim_host::program::find::{ProgramSource, find_program};
use sim_host::program::parts::parts_of;
use sim_host::record::report::write_atomically;

use super::check::with_meshes_and_images;
use super::output::say;
use super::run::{RunArgs, report_diagnostics};
use crate::pack::{Manifest, Pack, Unpacked};
use crate::suite::{Case, Suite};

/// Maximum number of variants of a suite whose files are collected.
const MAX_VARIANTS: usize = 2000;

/// Arguments of `eyesim pack`.
#[derive(Args)]
pub struct PackArgs {
    /// The scene or the suite
    #[arg(value_name = "SCENE|SUITE")]
    pub file: PathBuf,
    /// The archive to write, NAME.zip
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Program for the robots that have none: `maze.c`; for robot 2: `2=maze.c`
    #[arg(long = "program", value_name = "[ROBOT|NAME=]PROGRAM", value_parser = ProgramOption::parse)]
    pub programs: Vec<ProgramOption>,
    /// Seed of all random numbers [default: from the scene, or 0]
    #[arg(long, value_name = "NUMBER", value_parser = super::whole_number, allow_negative_numbers = true)]
    pub seed: Option<u64>,
}

/// Runs the command.
///
/// # Errors
/// If a file cannot be read, built or written, or lies at a path that an archive cannot contain.
pub fn run(args: &PackArgs) -> anyhow::Result<ExitCode> {
    ensure!(is_archive(&args.output), "-o `{}`: expected a name that ends in .zip", args.output.display());
    let text = read_regular(&args.file).with_context(|| format!("`{}`", args.file.display()))?;
    let mut files = Collected::default();
    if is_suite(&slashed(&args.file), &sim_format::decode(&text).0) {
        let suite = Suite::open(&args.file, args.programs.clone());
        report_diagnostics(&suite.diagnostics, &suite.inputs, false)?;
        files.add_suite(&suite)?;
        let cases = suite.cases().map_err(anyhow::Error::msg)?;
        let mut variants: BTreeMap<&str, &Case> = BTreeMap::new();
        cases.iter().for_each(|case| _ = variants.entry(&case.variant).or_insert(case));
        ensure!(variants.len() <= MAX_VARIANTS, "a suite of more than {MAX_VARIANTS} variants is not packed");
        for case in variants.values() {
            files.add_scene(Scene::open(&case.scene, case.options.clone())?)?;
        }
    } else {
        let options = Options { seed: args.seed, programs: args.programs.clone(), ..Options::default() };
        files.add_scene(Scene::open(&args.file, options)?)?;
    }
    let search = check::search_path(&DiskFiles::of_environment())?;
    let mut programs = Vec::new();
    for program in &args.programs {
        let sources = files_of(&find_program(program.program(), &search)?.source)?;
        sources.iter().try_for_each(|source| files.add_program(source))?;
        programs.push((program, sources));
    }
    let root = files.root();
    let mut pack = files.into_pack(&args.file, &BTreeMap::new())?;
    pack.manifest.seed = args.seed;
    for (program, sources) in programs {
        let path = |source: &PathBuf| anyhow::Ok(slashed(normalized(source)?.strip_prefix(&root)?));
        let paths: Vec<String> = sources.iter().map(path).collect::<anyhow::Result<_>>()?;
        let text = program.to_string();
        let selector = text.strip_suffix(program.program()).unwrap_or_default().to_owned();
        pack.manifest.programs.push((selector, paths.join(",")));
    }
    let bytes = pack.to_bytes().with_context(|| format!("`{}`", args.output.display()))?;
    let count = pack.files.len();
    check_self_contained(&pack)?;
    write_atomically(&args.output, &bytes).with_context(|| format!("cannot write `{}`", args.output.display()))?;
    say(format_args!("wrote `{}`: {count} files, {} kB", args.output.display(), bytes.len().div_ceil(1000)));
    Ok(ExitCode::SUCCESS)
}

/// Returns true for the name of an archive.
pub(super) fn is_archive(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("zip"))
}

/// Files collected for an archive, by their absolute paths.
#[derive(Default)]
pub(super) struct Collected(BTreeMap<PathBuf, Vec<u8>>);

impl Collected {
    fn add_all(&mut self, inputs: &[InputFile]) -> anyhow::Result<()> {
        for input in inputs {
            self.0.insert(normalized(Path::new(&input.path))?, input.bytes.clone());
        }
        Ok(())
    }

    /// Adds a suite with the programs of its checks, but not its scenes.
    pub(super) fn add_suite(&mut self, suite: &Suite) -> anyhow::Result<()> {
        self.add_all(&suite.inputs)?;
        let check_scene = SceneSpec { checks: suite.spec.checks.clone(), ..SceneSpec::default() };
        check::scripts(&check_scene).try_for_each(|script| self.add_program(&script))
    }

    /// Adds a scene with everything that it refers to: worlds, types, meshes, images, programs.
    pub(super) fn add_scene(&mut self, scene: Scene) -> anyhow::Result<()> {
        let mut files = DiskFiles::of_environment();
        let loaded = load_scene_with(&files.name(Path::new(&scene.spec().file)), scene.options().overrides(), &files);
        let loaded = with_meshes_and_images(loaded, &files, |_| ());
        report_diagnostics(&loaded.diagnostics, &loaded.inputs, false)?;
        self.add_all(&loaded.inputs)?;
        let builder = scene.builder()?;
        let built = scene.build(&builder)?;
        built.sources().try_for_each(|source| files_of(source).map(drop))?;
        self.add_inputs(&built)
    }

    /// Adds the inputs of the built scene that are missing so far, such as files that options name.
    fn add_inputs(&mut self, built: &BuiltScene) -> anyhow::Result<()> {
        for input in built.inputs() {
            let path = normalized(Path::new(&input.path))?;
            if let Entry::Vacant(vacant) = self.0.entry(path) {
                let bytes = read_regular(vacant.key()).with_context(|| format!("`{}`", vacant.key().display()))?;
                vacant.insert(bytes);
            }
        }
        Ok(())
    }

    /// Adds a program with its parts.
    fn add_program(&mut self, path: &Path) -> anyhow::Result<()> {
        for path in parts_of(path).iter().map(PathBuf::as_path).chain([path]) {
            let bytes = read_regular(path).with_context(|| format!("`{}`", path.display()))?;
            self.0.insert(normalized(path)?, bytes);
        }
        Ok(())
    }

    /// The archive of these files. `main` is the scene or suite; `options` maps the values of options to the files that
    /// they name.
    pub(super) fn into_pack(self, main: &Path, options: &BTreeMap<String, PathBuf>) -> anyhow::Result<Pack> {
        let root = self.root();
        let mut manifest = Manifest::new(slashed(normalized(main)?.strip_prefix(&root)?));
        let home = DiskFiles::of_environment();
        let home = home.home().and_then(|home| normalized(Path::new(home)).ok());
        manifest.home = home.and_then(|home| Some(slashed(home.strip_prefix(&root).ok()?)));
        let option = |(value, path): (&String, &PathBuf)| {
            anyhow::Ok((value.clone(), slashed(normalized(path)?.strip_prefix(&root)?)))
        };
        manifest.options = options.iter().map(option).collect::<anyhow::Result<_>>()?;
        let contents = self.0.into_iter().map(|(path, bytes)| anyhow::Ok((slashed(path.strip_prefix(&root)?), bytes)));
        Ok(Pack { manifest, files: contents.collect::<anyhow::Result<_>>()? })
    }

    /// The folder that contains all files.
    fn root(&self) -> PathBuf {
        let mut folders = self.0.keys().filter_map(|path| path.parent());
        let first = folders.next().unwrap_or(Path::new("/")).to_owned();
        folders.fold(first, |root, folder| {
            let shared = root.components().zip(folder.components()).take_while(|(a, b)| a == b);
            shared.map(|(part, _)| part).collect()
        })
    }
}

/// Files of a program, without its parts.
///
/// # Errors
/// The program is a package, or is part of this process.
fn files_of(source: &ProgramSource) -> anyhow::Result<Vec<PathBuf>> {
    match source {
        ProgramSource::Cargo(folder) => {
            bail!("`{}` is a Rust package: build it, and name its library", folder.display())
        }
        ProgramSource::Embedded(program) => bail!("`{}` is not a file", program.reference),
        _ => Ok(source.files()),
    }
}

/// Absolute path without `.` and `..`.
fn normalized(path: &Path) -> anyhow::Result<PathBuf> {
    let mut result = PathBuf::new();
    for part in std::path::absolute(path)?.components() {
        match part {
            Component::ParentDir => _ = result.pop(),
            part => result.push(part),
        }
    }
    Ok(result)
}

/// Checks that the files of an archive refer to no files outside it.
pub(super) fn check_self_contained(pack: &Pack) -> anyhow::Result<()> {
    let unpacked = pack.clone().unpack()?;
    let home =
        unpacked.manifest().home.as_deref().map_or_else(|| unpacked.folder().to_owned(), |home| unpacked.path_of(home));
    let files = DiskFiles::with_home(&home);
    let main = slashed(&unpacked.main());
    let text = sim_format::decode(&read_regular(&unpacked.main())?).0;
    let loaded = if is_suite(&main, &text) {
        sim_format::suite::load_suite(&main, &files).loaded
    } else {
        load_scene_with(&main, sim_format::Overrides::default(), &files)
    };
    let loaded = with_meshes_and_images(loaded, &files, |_| ());
    let outside = loaded.inputs.iter().find(|input| !Path::new(&input.path).starts_with(unpacked.folder()));
    if let Some(input) = outside {
        bail!(
            "`{}` is named by an absolute path, which leads out of an archive: name it from the file's folder",
            input.path
        );
    }
    report_diagnostics(&loaded.diagnostics, &loaded.inputs, false).context("the archive would not be complete")
}

/// Unpacks an archive and makes its installation folder that of this process.
///
/// # Errors
/// The archive is refused, or cannot be unpacked.
pub(super) fn unpack(path: &Path) -> anyhow::Result<Unpacked> {
    let open = || anyhow::Ok(Pack::read(&read_regular(path)?)?);
    let pack = open().with_context(|| format!("`{}`", path.display()))?;
    let unpacked = pack.unpack().with_context(|| format!("cannot unpack `{}`", path.display()))?;
    if let Some(home) = &unpacked.manifest().home {
        use_home(&unpacked.path_of(home));
    }
    Ok(unpacked)
}

/// Programs of a run: those in `given`, and those of the archive for all other robots.
pub(super) fn programs(unpacked: &Unpacked, given: &[ProgramOption]) -> anyhow::Result<Vec<ProgramOption>> {
    let mut programs = Vec::new();
    for (selector, path) in &unpacked.manifest().programs {
        // A path with a comma is the path of one file, or a list of several paths.
        let parts: Vec<&str> = if unpacked.path_of(path).exists() { vec![path] } else { path.split(',').collect() };
        let paths: Vec<String> = parts.into_iter().map(|path| slashed(&unpacked.path_of(path))).collect();
        let option = ProgramOption::parse(&format!("{selector}{}", paths.join(",")));
        let option = option.map_err(anyhow::Error::msg)?;
        if !given.iter().any(|other| other.selects_same_robots(&option)) {
            programs.push(option);
        }
    }
    programs.extend(given.iter().cloned());
    Ok(programs)
}

/// The scene of the example `name` in the folder `sims` of the installation.
fn example(name: &Path) -> anyhow::Result<PathBuf> {
    let files = DiskFiles::of_environment();
    let home = files.home().context("--example: this eyesim has no installation, name one in $EYESIM_HOME")?;
    let sims = format!("{home}/sims");
    ensure!(Path::new(&sims).is_dir(), "--example: there is no folder `{sims}`: name an installation in $EYESIM_HOME");
    let endings = [".sim", ".scene.toml"];
    let candidates = endings.map(|ending| PathBuf::from(format!("{sims}/{}{ending}", name.display())));
    if let Some(scene) = candidates.into_iter().find(|scene| scene.is_file()) {
        return Ok(scene);
    }
    let listed = files.list(&sims);
    let names = listed.iter().filter_map(|file| endings.iter().find_map(|ending| file.strip_suffix(ending)));
    bail!("--example: no example is called `{}`, accepted: {}", name.display(), names.collect::<Vec<_>>().join(", "))
}

/// The archive that a path names, or to which a path such as `lab.zip/lab.scene.toml` leads.
pub(super) fn archive_of(path: &Path) -> Option<&Path> {
    path.ancestors().find(|path| is_archive(path) && !path.is_dir())
}

/// If `args` name an example, an archive or a scene in an archive, makes them refer to the scene's file. Unpacked files
/// are removed when the result is dropped.
///
/// # Errors
/// See [`unpack`].
pub(super) fn open_for_run(args: &mut RunArgs) -> anyhow::Result<Option<Unpacked>> {
    if args.example {
        args.sim = example(&args.sim)?;
    }
    let sim = args.sim.clone();
    let Some(path) = archive_of(&sim) else { return Ok(None) };
    let unpacked = unpack(path)?;
    let archive = unpacked.archive(path);
    if path == sim {
        args.sim = unpacked.main();
        args.seed = args.seed.or(unpacked.manifest().seed);
        args.programs = programs(&unpacked, &args.programs)?;
    }
    // Recorded arguments name files by their paths in the archive.
    let find = |given: &str| match unpacked.option(given) {
        Some(file) => slashed(&file),
        None => archive.unpacked(given),
    };
    for file in [Some(&mut args.sim), args.stdin.as_mut(), args.checks.as_mut()].into_iter().flatten() {
        *file = find(&slashed(file)).into();
    }
    args.noise.iter_mut().for_each(|noise| *noise = find(noise));
    args.programs.iter_mut().for_each(|program| *program = program.with_program(&find(program.program())));
    args.archive = Some(archive);
    Ok(Some(unpacked))
}
