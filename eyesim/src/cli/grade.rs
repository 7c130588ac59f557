//! `eyesim grade`: grades submissions with a suite, and writes pages, tables and files for grading services.

mod autograder;
mod class;
mod results;
mod student;
mod table;

use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use sim_host::executive::interrupt;
use sim_host::files::read_regular;
use sim_host::record::log::Printable;
use sim_host::record::report::write_atomically;
use student::View;

use super::EXIT_INTERRUPTED;
use super::output::{output_path, say, tell};
use super::pack::{self, Collected, is_archive};
use super::run::{parse_count, parse_sandbox, report_diagnostics};
use super::test::screen::number;
use super::test::{builder, job_count, junit};
use crate::grade::submission::{Submission, read_all, read_one};
use crate::grade::{GradeError, Graded, Grader, grade_all, parse_seeds};
use crate::pack::{Pack, Unpacked};
use crate::suite::summary::Variant;
use crate::suite::{RowOutcome, Suite};

/// Arguments of `eyesim grade`.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct GradeArgs {
    /// Suite (NAME.suite.toml, or an archive of a suite); its `submit` defines which files are programs
    #[arg(value_name = "SUITE")]
    pub suite: PathBuf,
    /// Folder or archive with a folder, archive or file for each student
    #[arg(long, value_name = "FOLDER", required_unless_present = "gradescope")]
    pub submissions: Option<PathBuf>,
    /// There is one submission: a folder, an archive or a file of one student
    #[arg(long, requires = "submissions")]
    pub single: bool,
    /// Folder for the pages, tables and results
    #[arg(short, long, value_name = "FOLDER", value_parser = output_path())]
    pub output: Option<PathBuf>,
    /// Further seeds, which students do not see: numbers and ranges such as `1..20`
    #[arg(long, value_name = "FILE")]
    pub hidden_seeds: Option<PathBuf>,
    /// Write the result of a single submission as Gradescope's results.json
    #[arg(long, value_name = "FILE", requires = "single", value_parser = output_path())]
    pub results: Option<PathBuf>,
    /// Write an archive with which Gradescope grades by this suite
    #[arg(long, value_name = "FILE", conflicts_with_all = ["submissions", "output"])]
    pub gradescope: Option<PathBuf>,
    /// Number of submissions graded at the same time [default: one for each processor]
    #[arg(short, long, value_name = "NUMBER", value_parser = parse_count, allow_negative_numbers = true)]
    pub jobs: Option<NonZeroUsize>,
    /// Sandbox level for compilers and programs of submissions: full, calls or limits
    #[arg(long, value_name = "LEVEL", default_value = "full")]
    pub sandbox: String,
    /// Allow the check programs of an archive to run
    #[arg(long)]
    pub allow_execute: bool,
    /// Print only the last lines
    #[arg(short, long)]
    pub quiet: bool,
}

const AFTER_HELP: &str = "Exit codes: 0 graded, regardless of the points, 2 usage or file errors, 130 interrupted: the same command \
                          continues.";

/// Folder of cached results, in the output folder.
const CACHED_RESULTS: &str = "graded";

/// A submission with its result.
struct Student {
    submission: Submission,
    graded: Graded,
    variants: Vec<Variant>,
}

impl Student {
    fn points(&self) -> f64 {
        self.variants.iter().map(|variant| variant.points).sum()
    }

    fn max_points(&self) -> f64 {
        self.variants.iter().map(|variant| variant.max_points).sum()
    }

    fn passed(&self) -> usize {
        self.graded.results.iter().filter(|result| result.row.outcome == RowOutcome::Passed).count()
    }

    /// Verdict: `passed` if all variants pass, `error` if no case could be run, otherwise `failed`.
    fn verdict(&self) -> &'static str {
        if self.variants.iter().all(|variant| variant.passed) {
            "passed"
        } else if self.graded.results.iter().all(|result| result.row.outcome == RowOutcome::Error) {
            "error"
        } else {
            "failed"
        }
    }

    /// Reason of the first failure, one line.
    fn message(&self) -> &str {
        let problem = self.graded.problem.as_deref().and_then(|problem| problem.lines().next());
        let failed = self.graded.results.iter().find(|result| result.row.outcome != RowOutcome::Passed);
        problem.or(failed.map(|result| result.row.message.as_str())).unwrap_or_default()
    }
}

/// Runs the command.
///
/// # Errors
/// If files or arguments are wrong, or a file cannot be written.
pub fn run(args: &GradeArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    ensure!(
        args.output.is_some() || args.results.is_some() || args.gradescope.is_some(),
        "nothing is written: expected `-o FOLDER`, `--results FILE` or `--gradescope FILE`"
    );
    let seeds = args.hidden_seeds.as_deref().map(read_seeds).transpose()?.unwrap_or_default();
    let unpacked: Option<Unpacked> = is_archive(&args.suite).then(|| pack::unpack(&args.suite)).transpose()?;
    let path = unpacked.as_ref().map_or_else(|| args.suite.clone(), Unpacked::main);
    let suite = Suite::open(&path, Vec::new());
    report_diagnostics(&suite.diagnostics, &suite.inputs, false)?;
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let may_run_checks = unpacked.is_none() || args.allow_execute;
    let sandbox = parse_sandbox(&args.sandbox).map_err(anyhow::Error::msg).context("--sandbox")?;
    let level = sandbox.level();
    let builder = builder(true, Some(sandbox.clone()))?;
    let mut grader = Grader::open(&path, &seeds, may_run_checks, (builder, sandbox), interrupt.clone())?;
    if let Some(file) = &args.gradescope {
        ensure!(is_archive(file), "--gradescope `{}`: expected a name that ends in .zip", file.display());
        let pack = suite_pack(&grader, &path)?;
        autograder::write(file, &pack, args.hidden_seeds.as_deref(), level)?;
        say(format_args!("wrote `{}`: upload it as the autograder of an assignment", file.display()));
        return Ok(ExitCode::SUCCESS);
    }
    let folder = args.submissions.as_deref().context("--submissions is missing")?;
    let (submissions, ignored) = read(args, folder, &grader)?;
    ensure!(!submissions.is_empty(), "`{}` has no submissions", folder.display());
    for name in ignored {
        say(format_args!("warning: `{}` is not a submission", Printable(&name)));
    }
    if let ([only], false, true) = (&submissions[..], args.single, folder.is_file()) {
        say(format_args!(
            "warning: `{}` has only one submission, `{}`: expected a folder, archive or file for each student",
            folder.display(),
            Printable(&only.name)
        ));
    }
    let output_dir = args.output.as_deref().map(prepare).transpose()?;
    let students = grade(args, &mut grader, submissions, output_dir.as_deref())?;
    let Some(students) = students else { return Ok(ExitCode::from(EXIT_INTERRUPTED)) };
    if let Some(file) = &args.results {
        let student = students.first().context("no submission")?;
        let view = View::of(&grader, student);
        write(file, &results::document(student, &view)?)?;
    }
    if let Some(output) = &args.output {
        write_all(output, &grader, &students, start)?;
    }
    let mean = students.iter().map(Student::points).sum::<f64>() / students.len() as f64;
    let max_points = students.iter().map(Student::max_points).fold(0.0, f64::max);
    let count = |verdict| students.iter().filter(|student| student.verdict() == verdict).count();
    tell(format_args!(
        "{} submissions: {} passed, {} failed, {} could not be run; mean {} of {} points, in {:.1} s",
        students.len(),
        count("passed"),
        count("failed"),
        count("error"),
        number(mean),
        number(max_points),
        start.elapsed().as_secs_f64()
    ));
    if let Some(output) = &args.output {
        tell(format_args!("the page of the class: {}", output.join("index.html").display()));
    }
    Ok(ExitCode::SUCCESS)
}

fn read_seeds(path: &Path) -> anyhow::Result<Vec<u64>> {
    let bytes = read_regular(path).with_context(|| format!("--hidden-seeds: `{}`", path.display()))?;
    parse_seeds(&String::from_utf8_lossy(&bytes)).with_context(|| format!("--hidden-seeds: `{}`", path.display()))
}

fn read(args: &GradeArgs, folder: &Path, grader: &Grader) -> anyhow::Result<(Vec<Submission>, Vec<String>)> {
    let is_wanted = |path: &str| grader.wants(path);
    if args.single {
        ensure!(folder.exists(), "--submissions: `{}` does not exist", folder.display());
        let absolute = std::path::absolute(folder)?;
        let name = absolute.file_name().map_or("submission".into(), |name| name.to_string_lossy());
        return Ok((vec![read_one(folder, &name, &is_wanted)], Vec::new()));
    }
    let read = read_all(folder, &is_wanted).with_context(|| format!("--submissions: `{}`", folder.display()))?;
    Ok((read.list, read.ignored))
}

/// Creates the output folder; returns the folder of cached results.
fn prepare(output: &Path) -> anyhow::Result<PathBuf> {
    let results_dir = output.join(CACHED_RESULTS);
    let is_in_use = fs::read_dir(output).is_ok_and(|mut entries| entries.next().is_some());
    if is_in_use && !results_dir.is_dir() {
        bail!("-o `{}`: expected an empty folder, or one that `eyesim grade` has written", output.display());
    }
    fs::create_dir_all(&results_dir)
        .with_context(|| format!("-o: cannot make the folder `{}`", results_dir.display()))?;
    Ok(results_dir)
}

/// Grades the submissions whose results are not cached; returns `None` if the user interrupts.
fn grade(
    args: &GradeArgs,
    grader: &mut Grader,
    submissions: Vec<Submission>,
    results_folder: Option<&Path>,
) -> anyhow::Result<Option<Vec<Student>>> {
    let keys: Vec<String> = submissions.iter().map(|submission| grader.key(submission)).collect();
    let file = |key: &str| Some(results_folder?.join(format!("{key}.json")));
    let mut results: BTreeMap<String, Graded> = BTreeMap::new();
    let mut missing: Vec<usize> = Vec::new();
    for (index, key) in keys.iter().enumerate() {
        let cached = file(key).and_then(|file| Graded::parse(&read_regular(&file).ok()?));
        match cached {
            Some(graded) => _ = results.insert(key.clone(), graded),
            // Submissions with equal files share one result.
            None if missing.iter().any(|&other| keys[other] == *key) => {}
            None => missing.push(index),
        }
    }
    let jobs = job_count(args.jobs);
    let cached_count = submissions.len() - missing.len();
    if !args.quiet && cached_count > 0 {
        tell(format_args!("{cached_count} of {} submissions are unchanged or equal to another", submissions.len()));
    }
    let mut count = 0;
    grade_all(grader, &submissions, &missing, jobs, &mut |index, graded| {
        count += 1;
        if !args.quiet {
            let passed_count = graded.results.iter().filter(|result| result.row.outcome == RowOutcome::Passed).count();
            tell(format_args!(
                "[{count}/{}] {}: {passed_count} of {} cases passed",
                missing.len(),
                Printable(&submissions[index].name),
                graded.results.len()
            ));
        }
        if let Some(path) = file(&keys[index]).filter(|_| !graded.is_of_machine) {
            let bytes = serde_json::to_vec(&graded).map_err(std::io::Error::other);
            let written = bytes.and_then(|bytes| write_atomically(&path, &bytes));
            written.map_err(|error| GradeError::Io { path, error })?;
        }
        results.insert(keys[index].clone(), graded);
        Ok(())
    })?;
    if grader.interrupt.is_set() {
        say(format_args!(
            "interrupted: {count} of {} submissions were graded; the same command continues",
            missing.len()
        ));
        return Ok(None);
    }
    let student = |(submission, key): (Submission, String)| {
        let graded = results.get(&key).cloned().context("a submission has no result")?;
        let variants = grader.variants(&graded);
        anyhow::Ok(Student { submission, graded, variants })
    };
    Ok(Some(submissions.into_iter().zip(keys).map(student).collect::<anyhow::Result<_>>()?))
}

/// Writes all pages, tables and results into the output folder.
fn write_all(output: &Path, grader: &Grader, students: &[Student], start: Instant) -> anyhow::Result<()> {
    let folders = ["students", "sources"].map(|name| output.join(name));
    for folder in &folders {
        if folder.exists() {
            fs::remove_dir_all(folder).with_context(|| format!("cannot remove `{}`", folder.display()))?;
        }
    }
    let [pages, sources] = folders;
    let mut replays = Replays::default();
    for student in students {
        let student_folder = pages.join(&student.submission.folder);
        let view = View::of(grader, student);
        write(&student_folder.join("index.html"), student::page(grader, student, &view).as_bytes())?;
        write(&student_folder.join("results.json"), &results::document(student, &view)?)?;
        for (name, scene) in &view.replays {
            if let Some(bytes) = replays.archive(grader, student, scene)? {
                write(&student_folder.join(name), &bytes)?;
            }
        }
        export_sources(&sources, grader, &student.submission)?;
    }
    write(&output.join("index.html"), class::page(grader, students).as_bytes())?;
    write(&output.join("grades.csv"), table::grades(students).as_bytes())?;
    write(&output.join("rows.csv"), table::rows(students).as_bytes())?;
    let suites = students.iter().map(|student| {
        let results = student.graded.results.iter().collect();
        junit::Cases { suite: student.submission.folder.as_str(), results, missing: Vec::new() }
    });
    write(&output.join("junit.xml"), junit::document(suites, start.elapsed())?.as_bytes())
}

/// Writes the files of a submission's programs into one folder without subfolders, as similarity checkers expect.
fn export_sources(sources: &Path, grader: &Grader, submission: &Submission) -> anyhow::Result<()> {
    let folder = sources.join(&submission.folder);
    let Some(choice) = grader.choice(submission) else { return Ok(()) };
    for (path, bytes) in &choice.files {
        let file_name = path.replace('/', "__");
        let name = path.rsplit('/').next().unwrap_or(path);
        let is_unique = choice.files.keys().filter(|other| other.rsplit('/').next() == Some(name)).count() == 1;
        write(&folder.join(if is_unique { name } else { &file_name }), bytes)?;
    }
    Ok(())
}

/// Archives of scenes without programs of students, by the path of the scene.
#[derive(Default)]
struct Replays(BTreeMap<PathBuf, Pack>);

impl Replays {
    /// Contents of the archive of a scene with the programs of a student; `None` if the submission has no programs.
    fn archive(&mut self, grader: &Grader, student: &Student, scene: &Path) -> anyhow::Result<Option<Vec<u8>>> {
        let Some(choice) = grader.choice(&student.submission) else { return Ok(None) };
        if !self.0.contains_key(scene) {
            let (mut files, mut options) = (Collected::default(), BTreeMap::new());
            // Variants have noise profiles and worlds of their own.
            for (_, case) in grader.variants_of_suite().into_iter().filter(|(_, case)| case.scene == scene) {
                files.add_scene(grader.own_scene(case)?)?;
                options.extend(grader.option_files(case));
            }
            let pack = files.into_pack(scene, &options)?;
            pack::check_self_contained(&pack)?;
            self.0.insert(scene.to_owned(), pack);
        }
        let mut pack = self.0[scene].clone();
        let layout = choice.layout();
        pack.files.extend(layout.files.into_iter().map(|(path, bytes)| (format!("submission/{path}"), bytes)));
        for (robots, paths) in layout.programs {
            let paths: Vec<String> = paths.iter().map(|path| format!("submission/{path}")).collect();
            pack.manifest.programs.push((format!("{robots}="), paths.join(",")));
        }
        Ok(Some(pack.to_bytes()?))
    }
}

/// The archive of the suite with its scenes.
fn suite_pack(grader: &Grader, path: &Path) -> anyhow::Result<Pack> {
    let mut files = Collected::default();
    files.add_suite(grader.suite())?;
    for (_, case) in grader.variants_of_suite() {
        files.add_scene(grader.own_scene(case)?)?;
    }
    let pack = files.into_pack(path, &BTreeMap::new())?;
    pack::check_self_contained(&pack)?;
    Ok(pack)
}

fn write(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let write = || fs::create_dir_all(folder).and_then(|()| write_atomically(path, bytes));
    write().with_context(|| format!("cannot write `{}`", path.display()))
}
