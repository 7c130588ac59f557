//! `eyesim check`: reads files with all that they name, and prints what is wrong in them.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use sim_core::format::{self, Code, Diagnostic, Files, InputFile, Loaded, RobotSpec, SceneSpec, Severity, Span};

use crate::files::{DiskFiles, slashed};
use crate::program::find::{SearchPath, find_program};

/// Exit code when there are errors, or warnings under `--strict`.
const EXIT_MISTAKES: u8 = 2;

/// Columns of a source line that are shown at most.
const SHOWN_COLUMNS: usize = 120;

/// Arguments of `eyesim check`.
#[derive(Args)]
pub struct CheckArgs {
    /// Files to check: .sim (with all that it names), .robi (with its .toml), .wld, .maz, .esObj
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// How the diagnostics are printed
    #[arg(long, value_enum, default_value = "text")]
    pub format: Format,
    /// Warnings, too, lead to exit code 2
    #[arg(long)]
    pub strict: bool,
}

/// How diagnostics are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people: `file:line:column: severity[code]: message`, then the line itself
    Text,
    /// One array of objects
    Json,
}

/// Tells whether a robot's program can be found; if not, the message says what was tried.
pub type FindProgram<'a> = dyn Fn(&SceneSpec, &RobotSpec) -> Result<(), String> + 'a;

/// Runs the command: 0, or 2 where there are errors (under `--strict`: or warnings).
///
/// # Errors
/// If the working folder is unknown or the diagnostics cannot be turned into JSON.
pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let names: Vec<String> = args.files.iter().map(|file| slashed(file)).collect();
    let files = DiskFiles::of_environment();
    let working_folder = std::env::current_dir()?;
    let find = |scene: &SceneSpec, robot: &RobotSpec| {
        let search = SearchPath {
            sim_folder: Some(PathBuf::from(&scene.folder)),
            working_folder: working_folder.clone(),
            folders: Vec::new(),
            installation: files.home().map(PathBuf::from),
        };
        let Some(program) = &robot.program else { return Ok(()) };
        find_program(&program.text, &search).map(drop).map_err(|error| error.to_string())
    };
    let checked = check(&names, &files, &find);
    match args.format {
        Format::Json => println!("{}", serde_json::to_string_pretty(&checked.diagnostics)?),
        Format::Text => {
            print!("{}", render(&checked.diagnostics, &checked.inputs));
            println!("{}", checked.summary());
        }
    }
    Ok(if checked.is_rejected(args.strict) { ExitCode::from(EXIT_MISTAKES) } else { ExitCode::SUCCESS })
}

/// What a check has found in all files together.
#[derive(Debug, Default)]
pub struct Checked {
    /// What is wrong; a mistake in a file that several others name is listed once.
    pub diagnostics: Vec<Diagnostic>,
    /// The files that were read, each once.
    pub inputs: Vec<InputFile>,
}

impl Checked {
    /// True when there are errors, or when `strict` and there are warnings.
    pub fn is_rejected(&self, strict: bool) -> bool {
        format::has_errors(&self.diagnostics) || strict && !self.diagnostics.is_empty()
    }

    fn add(&mut self, loaded: Loaded) {
        let new = loaded.diagnostics.into_iter().filter(|diagnostic| !self.diagnostics.contains(diagnostic));
        let new: Vec<Diagnostic> = new.collect();
        self.diagnostics.extend(new);
        let new = loaded.inputs.into_iter().filter(|input| self.inputs.iter().all(|old| old.path != input.path));
        let new: Vec<InputFile> = new.collect();
        self.inputs.extend(new);
    }

    fn summary(&self) -> String {
        let count = |severity| self.diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
        let files = plural(self.inputs.len(), "file");
        match (errors, warnings) {
            (0, 0) => format!("{files} checked: no mistakes"),
            _ => format!("{files} checked: {}, {}", plural(errors, "error"), plural(warnings, "warning")),
        }
    }
}

fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Checks the files `names` with all that they name.
pub fn check(names: &[String], files: &dyn Files, find_program: &FindProgram<'_>) -> Checked {
    let mut checked = Checked::default();
    for name in names {
        checked.add(check_one(name, files, find_program));
    }
    checked
}

fn check_one(name: &str, files: &dyn Files, find_program: &FindProgram<'_>) -> Loaded {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    match extension.to_lowercase().as_str() {
        "sim" => check_sim(name, files, find_program),
        "wld" => format::load_world(name, files),
        "maz" | "maze" => format::load_maze(name, files),
        "esobj" => format::load_object(name, files).1,
        "robi" => format::load_robi(name, files).1,
        "toml" => format::load_robi(&format!("{stem}.robi"), files).1,
        _ => Loaded { diagnostics: vec![unknown_kind(name)], ..Loaded::default() },
    }
}

fn unknown_kind(name: &str) -> Diagnostic {
    Diagnostic {
        severity: Severity::Error,
        code: Code::FileKind,
        file: name.to_owned(),
        span: Span::default(),
        message: "the name does not say which kind of file this is".to_owned(),
        expected: "a name that ends in .sim, .robi, .toml, .wld, .maz, .maze or .esObj".to_owned(),
        suggestion: None,
    }
}

fn check_sim(name: &str, files: &dyn Files, find_program: &FindProgram<'_>) -> Loaded {
    let mut loaded = format::load_sim(name, files);
    let mut told: Vec<&str> = Vec::new();
    for robot in &loaded.scene.robots {
        // Many robots may run the same program.
        let Some(program) = robot.program.as_ref().filter(|program| !told.contains(&program.text.as_str())) else {
            continue;
        };
        told.push(&program.text);
        if let Err(message) = find_program(&loaded.scene, robot) {
            loaded.diagnostics.push(Diagnostic {
                severity: Severity::Error,
                code: Code::ProgramMissing,
                file: name.to_owned(),
                span: program.span,
                message,
                expected: "a library, a C file or a Cargo package folder".to_owned(),
                suggestion: None,
            });
        }
    }
    loaded
}

/// The `diagnostics` for people: each with the line of the source that it is about, from `inputs`.
pub fn render(diagnostics: &[Diagnostic], inputs: &[InputFile]) -> String {
    let texts: BTreeMap<&str, String> =
        inputs.iter().map(|input| (input.path.as_str(), format::decode(&input.bytes).0)).collect();
    let mut out = String::new();
    for diagnostic in diagnostics {
        let _ = writeln!(out, "{diagnostic}");
        if let Some(text) = texts.get(diagnostic.file.as_str()).filter(|_| diagnostic.span.line > 0) {
            out.push_str(&source_line(text, diagnostic.span));
        }
        let _ = writeln!(out, "   = expected: {}", diagnostic.expected);
        if let Some(suggestion) = &diagnostic.suggestion {
            let _ = writeln!(out, "   = suggestion: {suggestion}");
        }
    }
    out.chars().map(printable).collect()
}

/// The line of `span` with carets below it; a long line is cut out around them.
fn source_line(text: &str, span: Span) -> String {
    let column = span.column as usize - 1;
    let line_start = text.get(..span.start).and_then(|before| before.rfind(['\n', '\r'])).map_or(0, |place| place + 1);
    let line = text[line_start..].trim_start_matches('\u{feff}').split(['\n', '\r']).next().unwrap_or_default();
    let marked = text.get(span.start..span.end).unwrap_or_default();
    let width = marked.split(['\n', '\r']).next().unwrap_or_default().chars().count().max(1);
    let first = if column + width > SHOWN_COLUMNS { column.saturating_sub(SHOWN_COLUMNS / 4) } else { 0 };
    let shown: String = line.chars().skip(first).take(SHOWN_COLUMNS).collect();
    // Tabs stay tabs, so that the carets stand where the terminal puts the words.
    let indent: String =
        line.chars().skip(first).take(column - first).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    let carets = "^".repeat(width.min(SHOWN_COLUMNS.saturating_sub(column - first).max(1)));
    let margin = span.line.to_string().len();
    format!("{:margin$} |\n{} | {shown}\n{:margin$} | {indent}{carets}\n", "", span.line, "")
}

/// A terminal must not be steered by a file.
fn printable(character: char) -> char {
    if character.is_control() && !matches!(character, '\t' | '\n') { '\u{fffd}' } else { character }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const BROKEN: &str = "floor 4000\n0 0 100\n0 0 1OO 0\nush 100 100 0\npop\nposition 1 2\n\
                          0 0 5 5 10 200 255 0 300\n10 10 10 10\npush 0 0 inf\nfloor_texture\nfloor 4000 -1\n";

    fn find_nothing(_: &SceneSpec, robot: &RobotSpec) -> Result<(), String> {
        Err(format!("`{}` is not found", robot.program.as_ref().map_or("", |program| &program.text)))
    }

    fn find_all(_: &SceneSpec, _: &RobotSpec) -> Result<(), String> {
        Ok(())
    }

    /// A folder with the `files` in it, and the full name of each.
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
    fn each_mistake_of_a_world_has_line_column_and_expected() {
        let (folder, names) = folder(&[("a.wld", BROKEN)]);
        let checked = check(&names, &DiskFiles::with_home(folder.path()), &find_all);
        let placed: Vec<_> = checked.diagnostics.iter().filter(|diagnostic| diagnostic.span.line > 0).collect();
        let places: Vec<(u32, u32)> =
            placed.iter().map(|diagnostic| (diagnostic.span.line, diagnostic.span.column)).collect();
        let expected = [(1, 1), (2, 1), (3, 5), (4, 1), (5, 1), (6, 1), (7, 22), (8, 1), (9, 10), (10, 1), (11, 12)];
        assert_eq!(places, expected);
        assert!(placed.iter().all(|diagnostic| !diagnostic.expected.is_empty()));
        assert!(checked.is_rejected(false), "a floor of negative size loses the file");
        let text = render(&checked.diagnostics, &checked.inputs);
        insta::assert_snapshot!(text.replace(&slashed(folder.path()), "."));
    }

    #[test]
    fn a_sim_is_checked_with_its_programs() {
        let sim = "world a.wld\nrobi r.robi p.so 100 1 0\nrobi r.robi p.so 400 2 0\n";
        let robi = "wheel 54 3600 1000 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
        let (folder, names) = folder(&[("s.sim", sim), ("r.robi", robi), ("a.wld", "floor 10 10")]);
        let files = DiskFiles::with_home(folder.path());
        let checked = check(&names, &files, &find_all);
        assert_eq!(checked.diagnostics, []);
        assert_eq!((checked.summary().as_str(), checked.is_rejected(true)), ("3 files checked: no mistakes", false));
        let checked = check(&names, &files, &find_nothing);
        assert_eq!(checked.diagnostics.len(), 1, "{:?}", checked.diagnostics);
        assert_eq!((checked.diagnostics[0].code, checked.diagnostics[0].span.column), (Code::ProgramMissing, 13));
    }

    #[test]
    fn warnings_reject_only_when_strict() {
        let (folder, names) = folder(&[("a.wld", "floor 1 1\n1 2 3\n")]);
        let checked = check(&names, &DiskFiles::with_home(folder.path()), &find_all);
        assert_eq!((checked.is_rejected(false), checked.is_rejected(true)), (false, true));
    }

    #[test]
    fn files_without_a_kind_and_missing_files_are_errors() {
        let (folder, _) = folder(&[]);
        let names = ["a.txt".to_owned(), slashed(&folder.path().join("a.maz"))];
        let checked = check(&names, &DiskFiles::with_home(folder.path()), &find_all);
        let codes: Vec<Code> = checked.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
        assert_eq!(codes, [Code::FileKind, Code::FileMissing]);
    }

    #[test]
    fn json_has_the_documented_keys() {
        let (_, diagnostics) = format::read_world("a.wld", "floor 1 1\nush 1 2 3\n");
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
            "expected": "a wall of 4, 6 or 9 numbers, or one of floor, width, height, floor_texture, position, push, pop",
            "suggestion": "write `push`",
        }]);
        assert_eq!(json, expected);
    }

    #[test]
    fn the_command_line_is_understood() {
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

    #[test]
    fn carets_stand_below_the_word() {
        let span = Span { start: 6, end: 9, line: 2, column: 5 };
        assert_eq!(source_line("a\r\té bcd\n", span), "  |\n2 | \té bcd\n  | \t   ^^^\n");
        let long = "x".repeat(500);
        let span = Span { start: 400, end: 500, line: 1, column: 401 };
        let shown = source_line(&long, span);
        assert!(shown.lines().all(|line| line.len() < 130) && shown.contains("^^^"), "{shown}");
    }

    #[test]
    fn escape_sequences_of_a_file_do_not_reach_the_terminal() {
        let input = InputFile { path: "a.wld".to_owned(), bytes: b"floor 1 1\n\x1b[2J 1\n".to_vec() };
        let (_, diagnostics) = format::read_world("a.wld", "floor 1 1\n\x1b[2J 1\n");
        assert!(!render(&diagnostics, &[input]).contains('\x1b'));
    }
}
