//! `eyesim check`: reads files and everything that they refer to, and prints their mistakes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use sim_core::build::MeshSource;
use sim_core::spec::{CostsRef, Dialect, SceneSpec, Span};
use sim_format::{CellRules, Code, Diagnostic, FileError, Files, InputFile, Loaded, MeshReader, Overrides, Severity};
use sim_host::files::{DiskFiles, slashed, walk};
use sim_host::launch::check::{
    FindProgram, count, finder, invalid_checks, is_rejected, missing_programs, plural, search_path,
    unknown_forbidden_functions, unknown_functions,
};
use sim_host::program::Generation;
use sim_host::program::language::Language;

use sim_format::map::{WORLD_EXTENSIONS, load_scenarios};
use sim_format::path::{extension, with_extension};
use sim_format::suite::{self, LoadedSuite, SUITE_EXTENSION, is_suite};

use super::cc::parse_api;
use super::diagnostic::{self, Colour, Format, Screen};
use super::output::print;
use super::run::{parse_dialect, parse_maze_cell};

/// Exit code when there are errors, or warnings under `--strict`.
const EXIT_MISTAKES: u8 = 2;

/// Arguments of `eyesim check`.
#[derive(Args)]
pub struct CheckArgs {
    /// Files to check: .sim and .scene.toml (with all that they name), .suite.toml (with its scene), .robi (with its
    /// .toml), .wld, .maz, .esObj, .noise.toml; maps and mazes of other programs: .yaml, .pgm, .pbm, .map, .scen,
    /// .world, .num, .txt. For a folder: all these files except those of other programs
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// How the diagnostics are printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// When colours are used
    #[arg(long, value_enum, default_value_t, value_name = "WHEN")]
    pub color: Colour,
    /// RoBIOS generation that the programs are written for, 6 or 7 [default: from the scene, or from the functions that
    /// they call]
    #[arg(long, value_name = "GENERATION", value_parser = parse_api)]
    pub api: Option<Generation>,
    /// Version of EyeSim whose conventions the files follow: vr2018, vr2023 or classic [default: from the scene, or
    /// vr2023]
    #[arg(long, value_name = "DIALECT", value_parser = parse_dialect)]
    pub dialect: Option<Dialect>,
    /// Cell size of mazes in millimetres; overrides the files
    #[arg(long, value_name = "MM", value_parser = parse_maze_cell, allow_hyphen_values = true)]
    pub maze_cell: Option<f64>,
    /// Treat warnings as errors: exit code 2
    #[arg(long)]
    pub strict: bool,
}

/// Runs the command. The exit code is 0, or 2 if there are errors or, under `--strict`, warnings.
///
/// # Errors
/// If the working folder is unknown or standard output cannot be written to.
pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let mut files = DiskFiles::of_environment();
    let (names, empty) = expand(&args.files, &mut files);
    let find = finder(search_path(&files)?, args.api, None);
    let overrides = Overrides { dialect: args.dialect, maze_cell: args.maze_cell, ..Overrides::default() };
    let mut checked = check(&names, overrides, &files, &*find);
    checked.diagnostics.extend(empty);
    let screen = Screen::of_stdout(args.color);
    let mut text = diagnostic::render(&checked.diagnostics, &checked.inputs, args.format, screen)?;
    if args.format != Format::Json {
        checked.notes.iter().for_each(|note| text.push_str(&format!("{note}\n")));
        text.push_str(&format!("{}\n", checked.summary()));
        if let Some(first) = checked.diagnostics.first().filter(|_| args.format.is_human(screen)) {
            text.push_str(&format!("See `eyesim explain {}`\n", first.code));
        }
    }
    print(&text)?;
    Ok(if checked.is_rejected(args.strict) { ExitCode::from(EXIT_MISTAKES) } else { ExitCode::SUCCESS })
}

/// Outcome of a check of several files.
#[derive(Debug, Default)]
pub struct Checked {
    /// Diagnostics. A mistake in a file to which several others refer is listed once.
    pub diagnostics: Vec<Diagnostic>,
    /// The files that were read, each once.
    pub inputs: Vec<InputFile>,
    /// Notes on how maps and mazes of other programs were read, one line each.
    pub notes: Vec<String>,
}

impl Checked {
    /// Returns true if there are errors or, when `strict`, warnings.
    pub fn is_rejected(&self, strict: bool) -> bool {
        is_rejected(&self.diagnostics, strict)
    }

    /// Summary for the user: `2 files checked: no mistakes`, or the numbers of errors and warnings.
    pub fn summary(&self) -> String {
        let files = plural(self.inputs.len(), "file");
        if self.diagnostics.is_empty() {
            return format!("{files} checked: no mistakes");
        }
        format!("{files} checked: {}", count(&self.diagnostics))
    }
}

/// Checks the files `names` and everything that they refer to.
pub fn check(names: &[String], overrides: Overrides<'_>, files: &dyn Files, find_program: &FindProgram<'_>) -> Checked {
    let mut checked = Checked::default();
    // Several files may refer to one file, which may also be in `names`.
    let mut seen: BTreeSet<(String, Span, Code, String)> = BTreeSet::new();
    let mut read: BTreeSet<String> = BTreeSet::new();
    for name in names {
        let loaded = check_one(name, overrides, files, find_program);
        let is_new = |d: &Diagnostic| seen.insert((d.file.clone(), d.span, d.code, d.message.clone()));
        checked.diagnostics.extend(loaded.diagnostics.into_iter().filter(is_new));
        checked.notes.extend(loaded.notes);
        checked.inputs.extend(loaded.inputs.into_iter().filter(|input| read.insert(input.path.clone())));
    }
    checked
}

fn check_one(name: &str, overrides: Overrides<'_>, files: &dyn Files, find_program: &FindProgram<'_>) -> Loaded {
    match extension(name).as_str() {
        "sim" => check_sim(name, overrides, files, find_program),
        "scen" => load_scenarios(name, files).1,
        extension if extension == "txt" || WORLD_EXTENSIONS.contains(&extension) => {
            let rules = CellRules { dialect: overrides.dialect, cell: overrides.maze_cell };
            with_meshes_and_images(sim_format::load_world_with(name, rules, files), files, |_| ())
        }
        "esobj" => {
            let (object, loaded) = sim_format::load_object(name, files);
            with_meshes_and_images(loaded, files, |reader| object.iter().for_each(|object| drop(reader.object(object))))
        }
        "robi" => check_robi(name, files),
        "toml" if is_suite_file(name, files) => check_suite(name, files),
        "toml" if is_scene(name, files) => check_sim(name, overrides, files, find_program),
        "toml" if is_noise(name, files) => sim_format::load_noise(name, files).1,
        "toml" if is_costs_file(name, files) => check_costs(name, files),
        "toml" if files.read(&with_extension(name, "robi")) != Err(FileError::Missing) => {
            check_robi(&with_extension(name, "robi"), files)
        }
        _ => {
            let diagnostic = match files.read(name) {
                Err(FileError::Missing) => on_file(Code::FileMissing, name, "no such file", "a file that can be read"),
                _ => unknown_kind(name),
            };
            Loaded { diagnostics: vec![diagnostic], ..Loaded::default() }
        }
    }
}

/// Returns true if the file is a scene in TOML; a file that cannot be read is judged by its name.
pub(super) fn is_scene(name: &str, files: &dyn Files) -> bool {
    let text = files.read(name).map_or(String::new(), |bytes| sim_format::decode(&bytes).0);
    sim_format::is_scene(name, &text)
}

/// Returns true if the file is a suite.
pub(super) fn is_suite_file(name: &str, files: &dyn Files) -> bool {
    let text = files.read(name).map_or(String::new(), |bytes| sim_format::decode(&bytes).0);
    is_suite(name, &text)
}

/// Checks a suite and the scenes of its cases.
fn check_suite(name: &str, files: &dyn Files) -> Loaded {
    let LoadedSuite { suite, mut loaded } = suite::check_suite(name, files);
    loaded.diagnostics.extend(unknown_forbidden_functions(&suite.file, &suite.forbid));
    let scene = SceneSpec { file: suite.file, checks: suite.checks, ..SceneSpec::default() };
    loaded.diagnostics.extend(invalid_checks(&scene));
    loaded
}

/// Returns true if the file is a noise profile.
pub(super) fn is_noise(name: &str, files: &dyn Files) -> bool {
    let text = files.read(name).map_or(String::new(), |bytes| sim_format::decode(&bytes).0);
    sim_format::is_noise(name, &text)
}

/// Returns true if the file is a cost table.
fn is_costs_file(name: &str, files: &dyn Files) -> bool {
    let text = files.read(name).map_or(String::new(), |bytes| sim_format::decode(&bytes).0);
    sim_format::is_costs(name, &text)
}

fn check_costs(name: &str, files: &dyn Files) -> Loaded {
    let (table, mut loaded) = sim_format::load_costs(name, files);
    loaded.diagnostics.extend(table.iter().flat_map(unknown_functions));
    loaded
}

/// Extensions of files checked in a folder, in addition to `.scene.toml`, `.suite.toml` and `.noise.toml`. A companion
/// is read with its robi.
const EXTENSIONS: [&str; 6] = ["sim", "wld", "maz", "maze", "robi", "esObj"];

fn check_sim(name: &str, overrides: Overrides<'_>, files: &dyn Files, find_program: &FindProgram<'_>) -> Loaded {
    let mut loaded = with_meshes_and_images(sim_format::check_scene(name, overrides, files), files, |_| ());
    // Only a warning, since EyeSim reads the file and places the robot nevertheless.
    let missing = missing_programs(&loaded.scene, Severity::Warning, find_program);
    loaded.diagnostics.extend(missing);
    if let Some(CostsRef::Table(table)) = &loaded.scene.run.costs {
        loaded.diagnostics.extend(unknown_functions(table));
    }
    loaded.diagnostics.extend(unknown_forbidden_functions(&loaded.scene.file, &loaded.scene.run.forbid));
    loaded.diagnostics.extend(invalid_checks(&loaded.scene));
    loaded
}

fn check_robi(name: &str, files: &dyn Files) -> Loaded {
    let (robi, loaded) = sim_format::load_robi(name, files);
    with_meshes_and_images(loaded, files, |reader| robi.iter().for_each(|robi| drop(reader.robot(robi))))
}

/// Adds the diagnostics of the meshes and images of a scene, and of those that `read_others` reads.
pub(super) fn with_meshes_and_images(
    mut loaded: Loaded,
    files: &dyn Files,
    read_others: impl FnOnce(&mut MeshReader<'_>),
) -> Loaded {
    let mut reader = MeshReader::new(files);
    let SceneSpec { world, robots, objects, .. } = &loaded.scene;
    drop(reader.floor(world));
    robots.iter().for_each(|robot| drop(reader.robot(&robot.robi)));
    objects.iter().for_each(|object| drop(reader.object(&object.kind)));
    read_others(&mut reader);
    let (diagnostics, inputs) = reader.finish();
    // Meshes that range sensors see have been read with the scene.
    let new_diagnostics: Vec<Diagnostic> =
        diagnostics.into_iter().filter(|diagnostic| !loaded.diagnostics.contains(diagnostic)).collect();
    loaded.diagnostics.extend(new_diagnostics);
    let new_inputs: Vec<InputFile> = inputs.into_iter().filter(|input| !loaded.inputs.contains(input)).collect();
    loaded.inputs.extend(new_inputs);
    loaded
}

/// A diagnostic on the file or folder `name` as a whole.
fn on_file(code: Code, name: &str, message: &str, expected: &str) -> Diagnostic {
    let (message, expected) = (message.to_owned(), expected.to_owned());
    let (file, span) = (name.to_owned(), Span::default());
    Diagnostic { severity: Severity::Error, code, file, span, message, expected, suggestion: None }
}

fn unknown_kind(name: &str) -> Diagnostic {
    let expected = "a name that ends in .sim, .scene.toml, .suite.toml, .noise.toml, .robi, .toml, .wld, .maz, .maze or .esObj, \
         or of a map or maze of another program: .yaml, .pgm, .pbm, .map, .scen, .world, .num, .txt";
    let is_program = Language::of(Path::new(name)).is_some()
        || [".py", ".rs", ".so"].iter().any(|extension| name.ends_with(extension));
    let message = if is_program {
        "this is a program: `eyesim run` builds it with the scene that names it, and `eyesim cc` builds a single program in C"
    } else if extension(name) == "toml" {
        "the file is no scene, suite, noise profile or cost table, and no .robi of the same name is beside it"
    } else {
        "the extension of the file name is unknown or missing"
    };
    on_file(Code::FileKind, name, message, expected)
}

/// Names, as the readers use them, of the files in `paths`; a folder is replaced by all files of known kinds below it.
/// Folders without such files, or that cannot be read, are reported.
fn expand(paths: &[PathBuf], files: &mut DiskFiles) -> (Vec<String>, Vec<Diagnostic>) {
    let mut names = Vec::new();
    let mut diagnostics = Vec::new();
    for path in paths {
        if !path.is_dir() {
            names.push(files.name(path));
            continue;
        }
        let previous_counts = (names.len(), diagnostics.len());
        let mut add_file = |found: &Path| {
            let name = files.name(found);
            let is_toml = found.extension().is_some_and(|extension| extension == "toml");
            let is_own_format = || is_scene(&name, files) || is_noise(&name, files) || is_suite_file(&name, files);
            if is_known(found) || is_toml && is_own_format() {
                names.push(name);
            }
        };
        walk(path, &mut add_file, &mut |folder, error| {
            let message = format!("the folder cannot be read: {error}");
            let expected = "a folder that can be read";
            diagnostics.push(on_file(Code::FileUnreadable, &slashed(folder), &message, expected));
        });
        if (names.len(), diagnostics.len()) == previous_counts {
            let expected = format!("a folder with files that end in .{} or .scene.toml", EXTENSIONS.join(", ."));
            let message = "there is no file in this folder that eyesim reads";
            diagnostics.push(on_file(Code::FolderEmpty, &slashed(path), message, &expected));
        }
    }
    (names, diagnostics)
}

/// Returns true if the file's name alone shows that it is of a known kind.
fn is_known(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    name.ends_with(sim_format::SCENE_EXTENSION)
        || name.ends_with(SUITE_EXTENSION)
        || name.ends_with(sim_format::NOISE_EXTENSION)
        || EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(&extension(&name)))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const BROKEN: &str = "floor 4000\n0 0 100\n0 0 1OO 0\nush 100 100 0\npop\nposition 1 2\n\
                          0 0 5 5 10 200 255 0 300\n10 10 10 10\npush 0 0 inf\nfloor_texture\nfloor 4000 -1\n";

    fn find_nothing(_: &SceneSpec, robot: &sim_core::spec::RobotSpec) -> Result<(), (Code, String)> {
        let message = format!("`{}` is not found", robot.program.as_ref().map_or("", |program| &program.text));
        Err((Code::ProgramMissing, message))
    }

    fn find_all(_: &SceneSpec, _: &sim_core::spec::RobotSpec) -> Result<(), (Code, String)> {
        Ok(())
    }

    /// Folder with the `files` in it, and their full names.
    fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, Vec<String>) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |(name, text): &(&str, &str)| {
            let path = folder.path().join(name);
            fs::write(&path, text).expect("a file");
            slashed(&path)
        };
        let names = files.iter().map(write).collect();
        (folder, names)
    }

    #[test]
    fn each_mistake_in_a_world_has_a_location_and_says_what_is_expected() {
        let (folder, names) = folder(&[("a.wld", BROKEN)]);
        let checked = check(&names, Overrides::default(), &DiskFiles::with_home(folder.path()), &find_all);
        let with_span: Vec<_> = checked.diagnostics.iter().filter(|diagnostic| diagnostic.span.line > 0).collect();
        let locations: Vec<(u32, u32)> =
            with_span.iter().map(|diagnostic| (diagnostic.span.line, diagnostic.span.column)).collect();
        let expected =
            [(1, 1), (2, 1), (3, 5), (4, 1), (5, 1), (6, 1), (7, 22), (8, 1), (9, 10), (10, 1), (11, 1), (11, 12)];
        assert_eq!(locations, expected);
        assert!(with_span.iter().all(|diagnostic| !diagnostic.expected.is_empty()));
        assert!(checked.is_rejected(false), "a floor of negative size loses the file");
        let screen = Screen { is_terminal: true, width: 100, has_colour: false };
        let text =
            diagnostic::render(&checked.diagnostics, &checked.inputs, Format::Human, screen).expect("plain text");
        insta::assert_snapshot!(text.replace(&slashed(folder.path()), "."));
    }

    #[test]
    fn programs_of_a_sim_file_are_checked() {
        let sim = "world a.wld\nrobi r.robi p.so 100 1 0\nrobi r.robi p.so 400 2 0\n";
        let robi = "wheel 54 3600 1000 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
        let (folder, names) = folder(&[("s.sim", sim), ("r.robi", robi), ("a.wld", "floor 1000 1000")]);
        let files = DiskFiles::with_home(folder.path());
        let checked = check(&names, Overrides::default(), &files, &find_all);
        assert_eq!(checked.diagnostics, []);
        assert_eq!((checked.summary().as_str(), checked.is_rejected(true)), ("3 files checked: no mistakes", false));
        let checked = check(&names, Overrides::default(), &files, &find_nothing);
        assert_eq!(checked.diagnostics.len(), 1, "{:?}", checked.diagnostics);
        assert_eq!((checked.diagnostics[0].code, checked.diagnostics[0].span.column), (Code::ProgramMissing, 13));
    }

    #[test]
    fn warnings_are_rejected_only_if_strict() {
        let (folder, names) = folder(&[("a.wld", "floor 1 1\n1 2 3\n")]);
        let checked = check(&names, Overrides::default(), &DiskFiles::with_home(folder.path()), &find_all);
        assert_eq!((checked.is_rejected(false), checked.is_rejected(true)), (false, true));
    }

    #[test]
    fn unknown_and_missing_files_are_errors() {
        let (folder, _) = folder(&[]);
        for (name, text) in [("a.doc", ""), ("a.toml", "x = 1"), ("c.toml", "[robios6]\nPSDGett = 5")] {
            fs::write(folder.path().join(name), text).expect("a file");
        }
        let names = ["a.doc", "a.maz", "a.toml", "b.toml", "c.toml"].map(|name| slashed(&folder.path().join(name)));
        let checked = check(&names, Overrides::default(), &DiskFiles::with_home(folder.path()), &find_all);
        let codes: Vec<Code> = checked.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
        let expected = [Code::FileKind, Code::FileMissing, Code::FileKind, Code::FileMissing, Code::CostFunction];
        assert_eq!(codes, expected);
    }

    #[test]
    fn json_has_the_documented_keys() {
        let (_, diagnostics) = sim_format::read_world("a.wld", "floor 1 1\nush 1 2 3\n");
        let json = serde_json::to_value(&diagnostics).expect("diagnostics are plain data");
        let expected = serde_json::json!([{
            "severity": "warning",
            "code": "wld-keyword",
            "file": "a.wld",
            "start": 10,
            "end": 13,
            "line": 2,
            "column": 1,
            "message": "unknown keyword `ush`",
            "expected": "a wall of 4, 6 or 9 numbers, or one of floor, width, height, floor_texture, water, position, push, pop",
            "suggestion": "write `push`",
        }]);
        assert_eq!(json, expected);
    }

    #[test]
    fn command_line_is_parsed() {
        #[derive(clap::Parser)]
        struct Cli {
            #[command(flatten)]
            args: CheckArgs,
        }
        let parse = |words: &[&str]| <Cli as clap::Parser>::try_parse_from(words).map(|cli| cli.args);
        let args = parse(&["check", "a.sim", "b.wld", "--format", "json", "--strict"]).expect("a good command line");
        assert_eq!((args.files.len(), args.format, args.strict), (2, Format::Json, true));
        assert!(parse(&["check"]).is_err(), "at least one file");
    }
}
