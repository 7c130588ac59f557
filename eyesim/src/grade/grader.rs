//! A suite for grading submissions, and the grading of one submission.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};
use sim_core::record::digest;
use sim_format::{Diagnostic, Severity};
use sim_host::executive::interrupt::Interrupt;
use sim_host::files::slashed;
use sim_host::launch::settings::{ProgramOption, remove_programs};
use sim_host::launch::{Error, Options, ProgramCache, Rejected, Scene, check};
use sim_host::program::Builder;
use sim_host::program::find::ProgramSource;
use sim_host::program::parts::parts_of;
use sim_host::program::sandbox::Sandbox;
use sim_host::record::report::Input;

use super::archive::Contents;
use super::choice::{self, Choice};
use super::submission::Submission;
use crate::suite::summary::{Variant, variants};
use crate::suite::{
    Case, CaseResult, Pool, PoolError, PoolOptions, Preparation, Row, Session, Suite, unfinished_case_result,
};

/// Version of the format of results.
const SCHEMA: u32 = 1;

/// Reasons why nothing can be graded.
#[derive(Debug, thiserror::Error)]
pub enum GradeError {
    /// The suite cannot be used for grading.
    #[error("{0}")]
    Suite(String),
    /// The system cannot start processes.
    #[error(transparent)]
    Pool(#[from] PoolError),
    /// A file cannot be written.
    #[error("`{}`: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: io::Error,
    },
}

/// Result of a submission. Except for times, it depends only on the submission's files, the suite and the version of
/// eyesim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Graded {
    /// Version of the format.
    pub schema: u32,
    /// Reason why nothing was built, such as a refused submission or a missing program.
    pub problem: Option<String>,
    /// True if the machine is the reason, not the submission: then the result is not cached.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_of_machine: bool,
    /// Remarks about files that were not read.
    pub notes: Vec<String>,
    /// Files of the programs of robots.
    pub programs: Vec<(String, Vec<String>)>,
    /// Results of all cases, in the order of the suite.
    pub results: Vec<CaseResult>,
    /// Wall-clock time of building and running, s.
    pub real_time_s: f64,
}

/// A suite for grading submissions.
pub struct Grader {
    path: PathBuf,
    /// Seeds that students do not see.
    hidden_seeds: BTreeSet<u64>,
    may_run_checks: bool,
    sandbox: Sandbox,
    suite: Suite,
    cases: Vec<Case>,
    /// Points of each variant.
    max_points: BTreeMap<String, f64>,
    /// Names of files that students have but do not write: the suite's files, and the module that `eyesim new` writes
    /// for editors.
    supplied: BTreeSet<String>,
    /// Hash of everything that determines results, except the submission.
    key: String,
    builder: Option<Builder>,
    /// Folder of built programs, as it appears in messages of compilers.
    cache: String,
    /// Folder for the files of submissions.
    scratch: tempfile::TempDir,
    /// Ends the grading.
    pub interrupt: Interrupt,
}

impl Grader {
    /// Reads the suite at `path`, adds `hidden_seeds` to its seeds, and builds the suite's own programs with `builder`.
    /// Compilers and programs of submissions run in `sandbox`.
    ///
    /// # Errors
    /// The suite or a scene has mistakes, does not declare files to submit, or one of its own programs cannot be built.
    pub fn open(
        path: &Path,
        hidden_seeds: &[u64],
        may_run_checks: bool,
        (builder, sandbox): (Builder, Sandbox),
        interrupt: Interrupt,
    ) -> Result<Self, GradeError> {
        let scratch = tempfile::Builder::new().prefix("eyesim-grade-").tempdir();
        let scratch = scratch.map_err(|error| GradeError::Io { path: std::env::temp_dir(), error })?;
        let hidden_seeds: BTreeSet<u64> = hidden_seeds.iter().copied().collect();
        let suite = open(path, &hidden_seeds, may_run_checks, &sandbox, Vec::new())?;
        if suite.spec.submit.is_empty() {
            let problem = "does not say which files of a submission are programs: expected `submit = { 1 = [\"*.c\"] }` in `[suite]`";
            return Err(GradeError::Suite(format!("`{}` {problem}", suite.spec.file)));
        }
        let cases = suite.cases().map_err(GradeError::Suite)?;
        let mut grader = Self {
            path: path.to_owned(),
            hidden_seeds,
            may_run_checks,
            sandbox,
            suite,
            cases,
            max_points: BTreeMap::new(),
            supplied: BTreeSet::new(),
            key: String::new(),
            builder: None,
            cache: format!("{}/", slashed(builder.cache().root())),
            scratch,
            interrupt,
        };
        let (mut inputs, mut max_points, mut parts) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
        let mut programs = ProgramCache::default();
        for (variant, case) in grader.variants_of_suite() {
            let built = grader.own_scene(case).and_then(|scene| scene.build_with(&builder, &mut programs));
            let built = built.map_err(|error| GradeError::Suite(describe(&error, case)))?;
            let points = grader.suite.spec.checks.iter().chain(&built.scene().checks).map(|check| check.points).sum();
            max_points.insert(variant.to_owned(), points);
            inputs.extend(built.inputs().iter().map(|input: &Input| (input.path.clone(), input.sha256.clone())));
            let of_scripts = check::scripts(built.scene()).flat_map(|script| parts_of(&script));
            parts.extend(built.sources().flat_map(ProgramSource::parts).chain(of_scripts));
        }
        grader.max_points = max_points;
        // A submission may have headers and modules of the same names as those of the suite's programs.
        let supplied = inputs.keys().map(Path::new).filter(|path| !parts.contains(*path));
        let names = supplied.filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        grader.supplied = names.chain(["eye.py".to_owned()]).collect();
        grader.key = grader.hash(&inputs);
        grader.builder = Some(builder);
        Ok(grader)
    }

    /// The suite, without programs of a submission.
    pub fn suite(&self) -> &Suite {
        &self.suite
    }

    /// The cases of the suite.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// Returns true for a file that may be part of a program: other files of a submission are not read.
    pub fn wants(&self, path: &str) -> bool {
        choice::is_wanted(&self.suite.spec.submit, path)
    }

    /// Returns true for a case with a seed that students do not see.
    pub fn is_hidden(&self, case: &Case) -> bool {
        case.options.seed.is_some_and(|seed| self.hidden_seeds.contains(&seed))
    }

    /// The scene of a case in which the robots of submissions have no programs.
    ///
    /// # Errors
    /// The scene cannot be read, or has no such robots.
    pub fn own_scene(&self, case: &Case) -> Result<Scene, Error> {
        // Arguments of robots without programs are refused.
        let options = Options { arguments: Vec::new(), ..case.options.clone() };
        let mut scene = Scene::open(&case.scene, options)?;
        let robots = self.suite.spec.submit.iter().map(|submit| submit.robots.as_str());
        remove_programs(scene.spec_mut(), robots)?;
        Ok(scene)
    }

    /// Files that the options of a case name, keyed by their names in its results.
    pub fn option_files(&self, case: &Case) -> BTreeMap<String, PathBuf> {
        let Options { noise, stdin, .. } = &case.options;
        let noise = noise.as_ref().map(PathBuf::from).filter(|path| path.is_file());
        let with_name = |path: PathBuf| {
            let mut name = slashed(&path);
            PathReplacements::of_suite(&self.suite.spec.folder).replace_in(&mut name);
            (name, path)
        };
        noise.into_iter().chain(stdin.clone()).map(with_name).collect()
    }

    /// The variants of the suite, each with its first case.
    pub fn variants_of_suite(&self) -> Vec<(&str, &Case)> {
        let mut seen = BTreeSet::new();
        let first = self.cases.iter().filter(|case| seen.insert(case.variant.as_str()));
        first.map(|case| (case.variant.as_str(), case)).collect()
    }

    /// Hash of everything that determines the result of a submission: 64 hexadecimal digits.
    pub fn key(&self, submission: &Submission) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut add = |bytes: &[u8]| {
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        };
        add(self.key.as_bytes());
        match &submission.contents {
            Ok(contents) => {
                contents.notes.iter().for_each(|note| add(note.as_bytes()));
                add(b"files");
                for (path, bytes) in &contents.files {
                    add(path.as_bytes());
                    add(bytes);
                }
            }
            Err(problem) => {
                add(b"refused");
                add(problem.as_bytes());
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// The files of a submission that become programs; `None` if the submission is refused or its files do not fit.
    pub fn choice(&self, submission: &Submission) -> Option<Choice> {
        self.choose(submission.contents.as_ref().ok()?).ok()
    }

    fn choose(&self, contents: &Contents) -> Result<Choice, String> {
        choice::choose(&self.suite.spec.submit, &self.supplied, contents)
    }

    /// Grades a submission in this process, which must be single-threaded, with `workers` forks of it. May be called
    /// only once.
    pub fn grade(&mut self, submission: &Submission, workers: usize) -> Graded {
        let start = Instant::now();
        let choice = submission.contents.as_ref().map_err(String::clone).and_then(|contents| self.choose(contents));
        let mut graded = match choice {
            Ok(choice) => self
                .run(choice, &self.key(submission), workers)
                .unwrap_or_else(|problem| self.machine_failure(&problem)),
            Err(problem) => self.ungraded_result(&problem),
        };
        graded.notes = submission.contents.as_ref().map(|contents| contents.notes.clone()).unwrap_or_default();
        graded.real_time_s = start.elapsed().as_secs_f64();
        graded
    }

    /// Builds and runs the programs of the submission with this key.
    fn run(&mut self, choice: Choice, key: &str, workers: usize) -> Result<Graded, String> {
        let folder = self.scratch.path().join(key);
        let programs = choice.write(&folder).map_err(|error| format!("its files cannot be written: {error}"))?;
        // Messages of compilers contain paths with symbolic links resolved.
        let folder = fs::canonicalize(&folder).unwrap_or(folder);
        // Sources in several folders include each other's headers.
        let mut sandbox = self.sandbox.clone();
        sandbox.root = Some(folder.clone());
        let suite = open(&self.path, &self.hidden_seeds, self.may_run_checks, &sandbox, programs)
            .map_err(|error| error.to_string())?;
        let cases = suite.cases()?;
        let builder = self.builder.take().ok_or("the builder has been used")?.with_sandbox(Some(sandbox));
        let session = Session::new(builder, self.interrupt.clone());
        let preparation = Preparation::of(&suite, cases.iter(), session);
        let mut results: BTreeMap<usize, CaseResult> = BTreeMap::new();
        let indices: Vec<usize> = (0..cases.len()).collect();
        let mut pool = Pool::new(&suite, &cases, preparation, PoolOptions { workers, isolate: true });
        let store = &mut |index, result| {
            results.insert(index, result);
            ControlFlow::Continue(())
        };
        pool.run(&indices, store).map_err(|error| error.to_string())?;
        let mut replacements =
            PathReplacements::new(&folder, &self.scratch.path().join(key), &suite.spec.folder, &choice);
        replacements.cache.clone_from(&self.cache);
        let mut graded = Graded { programs: choice.programs, ..Graded::of(results.into_values().collect()) };
        graded.results.iter_mut().for_each(|result| replacements.replace_in_result(result, key));
        _ = fs::remove_dir_all(&folder);
        Ok(graded)
    }

    /// Result of a submission that the machine failed to grade.
    pub fn machine_failure(&self, problem: &str) -> Graded {
        Graded { is_of_machine: true, ..self.ungraded_result(problem) }
    }

    /// Result of a submission that cannot be graded.
    fn ungraded_result(&self, problem: &str) -> Graded {
        let ungraded = |case: &Case| {
            let mut result = unfinished_case_result(&self.suite, case, problem);
            result.row.max_points = self.max_points.get(&case.variant).copied().unwrap_or_default();
            PathReplacements::of_suite(&self.suite.spec.folder).replace_in_result(&mut result, "");
            result
        };
        Graded { problem: Some(problem.to_owned()), ..Graded::of(self.cases.iter().map(ungraded).collect()) }
    }

    /// Variants of a graded submission.
    pub fn variants(&self, graded: &Graded) -> Vec<Variant> {
        let rows: Vec<&Row> = graded.results.iter().map(|result| &result.row).collect();
        let mut variants = variants(&rows, self.suite.spec.pass_rate);
        for variant in &mut variants {
            variant.max_points = self.max_points.get(&variant.name).copied().unwrap_or(variant.max_points);
        }
        variants
    }

    fn hash(&self, inputs: &BTreeMap<String, String>) -> String {
        let mut hasher = blake3::Hasher::new();
        let replacements = PathReplacements::of_suite(&self.suite.spec.folder);
        let mut add = |text: &str| {
            let mut text = text.to_owned();
            replacements.replace_in(&mut text);
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        };
        let (version, row_schema) = (env!("CARGO_PKG_VERSION"), crate::suite::ROW_SCHEMA);
        add(&format!("eyesim {version} {SCHEMA} {row_schema} {}", digest::VERSION));
        add(&format!("{:?} {:?} {}", self.suite.spec, self.hidden_seeds, self.may_run_checks));
        add(self.sandbox.level().word());
        for (path, sha256) in inputs {
            add(path);
            add(sha256);
        }
        hasher.finalize().to_hex().to_string()
    }
}

impl Graded {
    fn of(results: Vec<CaseResult>) -> Self {
        Self {
            schema: SCHEMA,
            problem: None,
            is_of_machine: false,
            notes: Vec::new(),
            programs: Vec::new(),
            results,
            real_time_s: 0.0,
        }
    }

    /// Reads a cached result; `None` if its format has another version or cannot be read.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        serde_json::from_slice::<Self>(bytes).ok().filter(|graded| graded.schema == SCHEMA)
    }

    /// Hash of the digests of all cases: submissions with equal hashes behave the same. `None` if a case has no digest.
    pub fn behaviour(&self) -> Option<String> {
        let mut hasher = blake3::Hasher::new();
        for result in &self.results {
            hasher.update(result.row.digest.as_ref()?.as_bytes());
        }
        (!self.results.is_empty()).then(|| hasher.finalize().to_hex()[..16].to_owned())
    }
}

/// Opens the suite with hidden seeds and programs of a submission, all in `sandbox`.
fn open(
    path: &Path,
    hidden_seeds: &BTreeSet<u64>,
    may_run_checks: bool,
    sandbox: &Sandbox,
    programs: Vec<ProgramOption>,
) -> Result<Suite, GradeError> {
    let mut suite = Suite::open(path, programs);
    let errors: Vec<&Diagnostic> =
        suite.diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
    if !errors.is_empty() {
        let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
        return Err(GradeError::Suite(lines.join("\n")));
    }
    suite.may_run_checks = may_run_checks;
    suite.sandbox = Some(sandbox.clone());
    suite.add_seeds(hidden_seeds.iter().copied()).map_err(GradeError::Suite)?;
    Ok(suite)
}

fn describe(error: &Error, case: &Case) -> String {
    let reason = match error {
        Error::Rejected(Rejected { diagnostics, .. }) => {
            diagnostics.iter().map(Diagnostic::to_string).collect::<Vec<_>>().join("\n")
        }
        error => error.to_string(),
    };
    format!("the case `{}` of the suite cannot be run: {reason}", case.name)
}

/// Replacements of paths in results, so that results do not depend on temporary folders.
struct PathReplacements {
    /// Text and its replacement, longer texts first.
    replaced: Vec<(String, String)>,
    /// The folder of built programs, in which each build has a folder of its own; empty if there is none.
    cache: String,
}

impl PathReplacements {
    fn of_suite(folder: &str) -> Self {
        let folder = folder.trim_end_matches('/');
        let is_distinctive = folder.contains('/') || folder.len() > 2;
        let replaced = is_distinctive.then(|| (format!("{folder}/"), String::new())).into_iter().collect();
        Self { replaced, cache: String::new() }
    }

    fn new(folder: &Path, unresolved_folder: &Path, suite: &str, choice: &Choice) -> Self {
        let mut replaced = Vec::new();
        for folder in [folder, unresolved_folder].map(slashed) {
            for (robots, _) in &choice.programs {
                let name = Choice::folder_of(robots);
                replaced.push((format!("{folder}/{name}/"), String::new()));
            }
            replaced.push((format!("{folder}/"), String::new()));
        }
        replaced.extend(Self::of_suite(suite).replaced);
        Self { replaced, cache: String::new() }
    }

    fn replace_in(&self, text: &mut String) {
        for (from, to) in &self.replaced {
            if text.contains(from.as_str()) {
                *text = text.replace(from.as_str(), to);
            }
        }
        while let Some(start) = text.find(&self.cache).filter(|_| !self.cache.is_empty()) {
            let rest = &text[start + self.cache.len()..];
            let build_folder_length =
                rest.starts_with("tmp-").then(|| rest.find('/')).flatten().map_or(0, |end| end + 1);
            text.replace_range(start..start + self.cache.len() + build_folder_length, "");
        }
    }

    fn replace_in_result(&self, result: &mut CaseResult, key: &str) {
        let replace = |text: &mut String| self.replace_in(text);
        let row = &mut result.row;
        let case = blake3::hash(format!("{key} {}", row.case).as_bytes());
        row.key = if key.is_empty() { String::new() } else { case.to_hex()[..32].to_owned() };
        [&mut row.suite, &mut row.scene, &mut row.message, &mut row.details].into_iter().for_each(replace);
        row.checks.iter_mut().for_each(|check| replace(&mut check.message));
        for robot in &mut row.robots {
            replace(&mut robot.program);
            robot.reason.iter_mut().for_each(replace);
        }
        row.words.iter_mut().for_each(replace);
        result.output.iter_mut().for_each(replace);
    }
}
