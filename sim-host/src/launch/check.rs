//! Checks of a scene that need more than its files: programs that cannot be found, unknown RoBIOS functions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sim_core::spec::{CheckKind, CostTable, RobotSpec, SceneSpec, SpannedText};
use sim_format::{Code, Diagnostic, Files as _, Severity};

use crate::check::script;
use crate::files::DiskFiles;
use crate::program::find::{ProgramSource, SearchPath, find_program};
use crate::program::generation::{ChoiceReason, choose};
use crate::program::sandbox::Sandbox;
use crate::program::scene::generation_hint;
use crate::program::{Generation, GenerationHint};
use crate::robios::{cost, forbidden};

/// Checks that a robot's program can be found and that its generation can be chosen; otherwise returns the code of the
/// failed check and a message.
pub type FindProgram<'a> = dyn Fn(&SceneSpec, &RobotSpec) -> Result<(), (Code, String)> + 'a;

/// Folders that are searched for programs of a scene, in addition to its own: the working folder and the installation.
///
/// # Errors
/// The working folder is unknown.
pub fn search_path(files: &DiskFiles) -> std::io::Result<SearchPath> {
    let working_folder = std::env::current_dir()?;
    Ok(SearchPath { working_folder, installation: files.home().map(PathBuf::from), ..SearchPath::default() })
}

/// Returns a function that searches for programs as `eyesim run` does: in the scene's folder and along `search`. `api`
/// is the generation that replaces the scene's, and `sandbox` restricts the compilers.
pub fn finder(search: SearchPath, api: Option<Generation>, sandbox: Option<Sandbox>) -> Box<FindProgram<'static>> {
    Box::new(move |scene, robot| {
        let search = SearchPath { sim_folder: Some(PathBuf::from(&scene.folder)), ..search.clone() };
        let Some(program) = &robot.program else { return Ok(()) };
        let found = find_program(&program.text, &search);
        let found = found.map_err(|error| (Code::ProgramMissing, error.to_string()))?;
        let ProgramSource::Sources { files, .. } = found.source else { return Ok(()) };
        let scene_hint = generation_hint(robot);
        let hint = GenerationHint { api: api.or(scene_hint.api), ..scene_hint };
        let folders = sandbox.as_ref().map(|sandbox| sandbox.source_folders(&files));
        choose(&files, hint, folders.as_deref()).map(drop).map_err(|error| (Code::ProgramGeneration, error.to_string()))
    })
}

/// The generation, 6 or 7, of a robot's program if the scene states it or the functions that the program calls
/// determine it.
pub fn known_generation(search: &SearchPath, scene: &SceneSpec, robot: &RobotSpec) -> Option<u32> {
    let search = SearchPath { sim_folder: Some(PathBuf::from(&scene.folder)), ..search.clone() };
    let found = find_program(&robot.program.as_ref()?.text, &search).ok()?;
    let ProgramSource::Sources { files, .. } = found.source else { return None };
    let choice = choose(&files, generation_hint(robot), None).ok()?;
    matches!(choice.reason, ChoiceReason::Stated(_) | ChoiceReason::Calls(_)).then(|| choice.generation.number())
}

/// Returns true if a scene with these diagnostics must not be run: because of errors or, if `strict`, because of any
/// diagnostic.
pub fn is_rejected(diagnostics: &[Diagnostic], strict: bool) -> bool {
    sim_format::has_errors(diagnostics) || strict && !diagnostics.is_empty()
}

/// Numbers of errors, warnings and their files: `3 errors, 12 warnings in 2 files`.
pub fn count(diagnostics: &[Diagnostic]) -> String {
    let number_of = |severity| diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
    let counts = [(number_of(Severity::Error), "error"), (number_of(Severity::Warning), "warning")];
    let parts: Vec<_> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, noun)| plural(*n, noun)).collect();
    let files: BTreeSet<&str> = diagnostics.iter().map(|diagnostic| diagnostic.file.as_str()).collect();
    format!("{} in {}", parts.join(", "), plural(files.len(), "file"))
}

/// `1 file`, `2 files`.
pub fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Diagnostics for the entries of a cost table that do not match a RoBIOS function.
pub fn unknown_functions(table: &CostTable) -> impl Iterator<Item = Diagnostic> {
    cost::mistakes(table).map(|(entry, _)| Diagnostic {
        severity: Severity::Error,
        code: Code::CostFunction,
        file: table.file.clone(),
        span: entry.span,
        message: format!("there is no function `{}`", entry.function),
        expected: "a function of RoBIOS, or the beginning of names and `*`".to_owned(),
        suggestion: cost::most_similar(&entry.generation, &entry.function).map(|name| format!("write `{name}`")),
    })
}

/// Diagnostics for the patterns of `forbid` in `file` that do not match a RoBIOS function.
pub fn unknown_forbidden_functions(file: &str, forbid: &[SpannedText]) -> Vec<Diagnostic> {
    let diagnostics_of = |pattern: &SpannedText| {
        let diagnostic = |(name, similar): (String, Option<String>)| Diagnostic {
            severity: Severity::Error,
            code: Code::ForbidFunction,
            file: file.to_owned(),
            span: pattern.span,
            message: format!("there is no function `{name}`"),
            expected: "a function of RoBIOS, or a pattern of names such as `SIM*`".to_owned(),
            suggestion: similar.map(|name| format!("did you mean `{name}`?")),
        };
        forbidden::mistakes(&pattern.text).into_iter().map(diagnostic).collect::<Vec<_>>()
    };
    forbid.iter().flat_map(diagnostics_of).collect()
}

/// Diagnostics for the checks of a scene that count calls of an unknown function, or whose program cannot be started.
pub fn invalid_checks(scene: &SceneSpec) -> Vec<Diagnostic> {
    unknown_calls(scene).chain(wrong_scripts(scene)).collect()
}

/// Files of the programs of checks.
pub fn scripts(scene: &SceneSpec) -> impl Iterator<Item = PathBuf> {
    scene.checks.iter().filter_map(|check| match &check.kind {
        CheckKind::Script { program, folder, .. } => Some(Path::new(folder).join(&program.text)),
        _ => None,
    })
}

fn wrong_scripts(scene: &SceneSpec) -> impl Iterator<Item = Diagnostic> {
    scene.checks.iter().filter_map(|check| {
        let CheckKind::Script { program, folder, .. } = &check.kind else { return None };
        let message = script::path_of(folder, &program.text).err()?;
        Some(Diagnostic {
            severity: Severity::Error,
            code: Code::CheckProgram,
            file: scene.file.clone(),
            span: program.span,
            message,
            expected: "the path of a program from this file's folder".to_owned(),
            suggestion: None,
        })
    })
}

/// Diagnostics for the checks of a scene that count calls of an unknown function.
fn unknown_calls(scene: &SceneSpec) -> impl Iterator<Item = Diagnostic> {
    let called = scene.checks.iter().filter_map(|check| match &check.kind {
        CheckKind::Calls { function, .. } if !cost::is_function(function) => Some((check, function)),
        _ => None,
    });
    called.map(|(check, function)| Diagnostic {
        severity: Severity::Error,
        code: Code::CheckFunction,
        file: scene.file.clone(),
        span: check.span,
        message: format!("there is no function `{function}`"),
        expected: "a function of RoBIOS 6 or RoBIOS-7".to_owned(),
        suggestion: cost::SECTIONS
            .iter()
            .find_map(|section| cost::most_similar(section, function))
            .map(|name| format!("write `{name}`")),
    })
}

/// Diagnostics for programs that the files of a scene name and that are not found, or whose generation cannot be
/// chosen; each program once, in the order of the robots.
pub fn missing_programs(scene: &SceneSpec, severity: Severity, find_program: &FindProgram<'_>) -> Vec<Diagnostic> {
    let mut known_programs: BTreeSet<&str> = BTreeSet::new();
    let mut missing = Vec::new();
    for robot in &scene.robots {
        // Many robots may run the same program. A program named on the command line has no position in a file.
        let file_program = robot.program.as_ref().filter(|program| program.span.line > 0);
        let Some(program) = file_program.filter(|program| known_programs.insert(&program.text)) else { continue };
        if let Err((code, message)) = find_program(scene, robot) {
            let expected = match code {
                Code::ProgramGeneration => "functions of one generation",
                _ => "a library, a C or C++ file or the folder of a program",
            };
            let (file, span, expected) = (scene.file.clone(), program.span, expected.to_owned());
            missing.push(Diagnostic { severity, code, file, span, message, expected, suggestion: None });
        }
    }
    missing
}
