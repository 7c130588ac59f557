//! `eyesim test`: runs the cases of suites and reports them as pytest does.

pub(super) mod junit;
pub(super) mod page;
mod picture;
pub(super) mod screen;

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};
use clap::Args;
use screen::Console;
use serde::Serialize;
use sim_format::path::extension;
use sim_format::suite::is_suite;
use sim_host::executive::interrupt;
use sim_host::files::{read_regular, slashed, walk};
use sim_host::host;
use sim_host::launch::settings::ProgramOption;
use sim_host::program::sandbox::Sandbox;
use sim_host::program::{Builder, Cache, Kits, Tools};
use sim_host::record::report::write_atomically;

use super::output::{check_outputs, given_outputs, output_path};
use super::pack::{self, is_archive};
use super::progress::Building;
use super::run::{parse_count, parse_sandbox, report_diagnostics};
use super::{EXIT_INTERRUPTED, EXIT_PROGRAM};
use crate::suite::summary::{Variant, variants};
use crate::suite::{
    Case, CaseResult, Pool, PoolOptions, Preparation, ROW_SCHEMA, Row, RowOutcome, Selection, Session, Suite,
};

/// Exit code if no case is selected.
const EXIT_NO_CASES: u8 = 5;

/// Arguments of `eyesim test`.
#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct TestArgs {
    /// Suites (NAME.suite.toml), and folders in which to look for them
    #[arg(value_name = "SUITE", default_value = ".")]
    pub suites: Vec<PathBuf>,
    /// Program instead of the suite's: `1=mine.c` for robot 1, `mine.c` for the robots without one
    #[arg(long = "program", value_name = "[ROBOT|NAME=]PROGRAM", value_parser = ProgramOption::parse)]
    pub programs: Vec<ProgramOption>,
    /// Only cases whose names match: words with `and`, `or`, `not` and parentheses
    #[arg(short = 'k', value_name = "EXPRESSION")]
    pub select: Option<String>,
    /// Stop after the first case that fails
    #[arg(short = 'x', long)]
    pub exitfirst: bool,
    /// Only the cases that failed the last time that they ran; all if none did
    #[arg(long, alias = "last-failed")]
    pub lf: bool,
    /// Number of cases that run at the same time [default: one for each processor]
    #[arg(short, long, value_name = "NUMBER", value_parser = parse_count, allow_negative_numbers = true)]
    pub jobs: Option<NonZeroUsize>,
    /// Run every case in its own process
    #[arg(long)]
    pub isolate: bool,
    /// Build and run untrusted programs in a sandbox, as `eyesim run --sandbox` does: full, calls or limits
    #[arg(
        long,
        value_name = "LEVEL",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "full",
        value_parser = parse_sandbox
    )]
    pub sandbox: Option<Sandbox>,
    /// Allow the check programs of an archive to run
    #[arg(long)]
    pub allow_execute: bool,
    /// List the cases without running them
    #[arg(long, alias = "co")]
    pub collect_only: bool,
    /// Write the results in JUnit format
    #[arg(long, value_name = "FILE", value_parser = output_path())]
    pub junit: Option<PathBuf>,
    /// Write pages for a browser into this folder; the first is index.html
    #[arg(long, value_name = "FOLDER", value_parser = output_path())]
    pub html: Option<PathBuf>,
    /// Write all rows as JSON
    #[arg(long, value_name = "FILE", value_parser = output_path())]
    pub report: Option<PathBuf>,
    /// Print a line for each case
    #[arg(short, long)]
    pub verbose: bool,
    /// Print only failures and the last line
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
}

const AFTER_HELP: &str =
    "Exit codes: 0 all suites passed, 1 one failed, 2 usage or file errors, 5 no case is selected, 130 interrupted.";

/// A suite with the results of its cases.
pub struct SuiteRun {
    /// Path that the user has given: that of the suite, or of an archive.
    pub path: PathBuf,
    /// The suite.
    pub suite: Suite,
    /// All cases of the suite.
    pub cases: Vec<Case>,
    /// Indices of the cases that were to run.
    pub selected: Vec<usize>,
    /// Results, by the index of the case.
    pub results: BTreeMap<usize, CaseResult>,
    /// Results of the variants.
    pub variants: Vec<Variant>,
}

impl SuiteRun {
    /// Path of the suite's file.
    pub fn name(&self) -> &str {
        &self.suite.spec.file
    }

    /// Results of cases that did not pass, in the order of the cases.
    pub fn failures(&self) -> impl Iterator<Item = &CaseResult> {
        self.results.values().filter(|result| result.row.outcome != RowOutcome::Passed)
    }

    /// Returns true if at least one variant does not pass.
    pub fn is_failed(&self) -> bool {
        self.variants.iter().any(|variant| !variant.passed)
    }

    /// Returns true if no variant failed and all selected cases have run.
    pub fn is_passed(&self) -> bool {
        !self.is_failed() && self.missing() == 0
    }

    /// Number of selected cases that have not run, because of an interrupt or of a failure with `-x`.
    pub fn missing(&self) -> usize {
        let was_run =
            |index| self.results.get(index).is_some_and(|result| result.row.outcome != RowOutcome::Interrupted);
        self.selected.iter().filter(|index| !was_run(index)).count()
    }
}

/// Runs the command.
///
/// # Errors
/// If files or arguments are wrong, or a file cannot be written.
pub fn run(args: &TestArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let selection = args.select.as_deref().map(Selection::parse).transpose().context("-k")?;
    let paths = find_suites(&args.suites)?;
    let mut unpacked = None;
    let mut runs = Vec::new();
    for path in &paths {
        let mut suite = if is_archive(path) {
            // An archive brings its own installation, so only one can be open.
            ensure!(paths.len() == 1, "an archive is run alone, not with other suites");
            let archive = unpacked.insert(pack::unpack(path)?);
            let mut suite = Suite::open(&archive.main(), pack::programs(archive, &args.programs)?);
            suite.may_run_checks = args.allow_execute;
            suite.archive = Some(archive.archive(path));
            suite
        } else {
            Suite::open(path, args.programs.clone())
        };
        suite.sandbox = args.sandbox.clone();
        report_diagnostics(&suite.diagnostics, &suite.inputs, false)?;
        let suite_path = || format!("`{}`", path.display());
        let cases = suite.cases().map_err(anyhow::Error::msg).with_context(suite_path)?;
        suite.check_options(&cases).map_err(anyhow::Error::msg).with_context(suite_path)?;
        let (selected, results, variants) = (Vec::new(), BTreeMap::new(), Vec::new());
        runs.push(SuiteRun { path: path.clone(), suite, cases, selected, results, variants });
    }
    let suite_inputs = runs.iter().flat_map(|run| run.suite.inputs.iter().map(|input| input.path.clone()));
    let inputs: Vec<String> =
        suite_inputs.chain(args.programs.iter().map(|program| program.program().to_owned())).collect();
    check_outputs(
        &given_outputs(&[("--junit", &args.junit), ("--report", &args.report)]),
        inputs.iter().map(String::as_str),
    )?;
    let last_failed = LastFailed::of_user();
    let selected: Vec<Vec<usize>> = select(&runs, selection.as_ref(), args.lf.then_some(&last_failed));
    let selected_count: usize = selected.iter().map(Vec::len).sum();
    let jobs = job_count(args.jobs);
    let case_count = runs.iter().map(|run| run.cases.len()).sum();
    let mut console = Console::new(args.verbose, args.quiet);
    console.collected(&paths, selected_count, case_count, jobs);
    if args.collect_only {
        for (run, selected) in runs.iter().zip(&selected) {
            selected.iter().for_each(|&index| console.line(&format!("{}::{}", run.name(), run.cases[index].name)));
        }
        return Ok(ExitCode::from(if selected_count == 0 { EXIT_NO_CASES } else { 0 }));
    }
    for (run, selected) in runs.iter_mut().zip(selected) {
        run.selected = selected;
    }
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    for run in runs.iter_mut().filter(|run| !run.selected.is_empty()) {
        let SuiteRun { suite, cases, selected, results, .. } = run;
        let session = Session::new(builder(args.quiet, args.sandbox.clone())?, interrupt.clone());
        let preparation = Preparation::of(suite, selected.iter().map(|&index| &cases[index]), session);
        console.begin(&suite.spec.file, selected.len());
        let mut is_stopped = false;
        let mut pool = Pool::new(suite, cases, preparation, PoolOptions { workers: jobs, isolate: args.isolate });
        pool.run(selected, &mut |index, result| {
            console.show_done(&result.row);
            is_stopped = args.exitfirst && result.row.outcome != RowOutcome::Passed;
            results.insert(index, result);
            if is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        console.end();
        run.summarise();
        if is_stopped || interrupt.is_set() {
            break;
        }
    }
    let elapsed = start.elapsed();
    console.failures(&runs);
    console.summary(&runs, elapsed, interrupt.is_set());
    last_failed.save(&runs);
    write_files(args, &runs, elapsed)?;
    Ok(if interrupt.is_set() {
        ExitCode::from(EXIT_INTERRUPTED)
    } else if selected_count == 0 {
        ExitCode::from(EXIT_NO_CASES)
    } else if runs.iter().all(SuiteRun::is_passed) {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(EXIT_PROGRAM)
    })
}

impl SuiteRun {
    fn summarise(&mut self) {
        let rows: Vec<&Row> = self.results.values().map(|result| &result.row).collect();
        self.variants = variants(&rows, self.suite.spec.pass_rate);
    }
}

pub(super) fn builder(is_quiet: bool, sandbox: Option<Sandbox>) -> anyhow::Result<Builder> {
    let cache = Cache::of_user().context("no folder for built programs")?;
    let builder = Builder::new(cache, Kits::of_robios(), Tools::of_environment()).with_sandbox(sandbox);
    Ok(if is_quiet { builder } else { builder.with_observer(Box::new(Building::on_stderr())) })
}

/// Number of cases or submissions that run at the same time: `jobs`, or one for each processor.
pub(super) fn job_count(jobs: Option<NonZeroUsize>) -> usize {
    jobs.map_or_else(host::processors, NonZeroUsize::get)
}

/// The suites among `paths`, and those in the folders among `paths`.
fn find_suites(paths: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for path in paths {
        if is_archive(path) {
            found.push(path.clone());
            continue;
        }
        if !path.is_dir() {
            expect_suite(path)?;
            found.push(path.clone());
            continue;
        }
        let previous_count = found.len();
        let mut unreadable = None;
        let mut add_suite = |file: &Path| {
            let is_suite_name = slashed(file).to_lowercase().ends_with(sim_format::suite::SUITE_EXTENSION);
            found.extend(is_suite_name.then(|| file.to_owned()));
        };
        walk(path, &mut add_suite, &mut |folder, error| unreadable = Some(format!("`{}`: {error}", folder.display())));
        if found.len() == previous_count {
            let why = unreadable.map(|why| format!(" ({why})")).unwrap_or_default();
            bail!("there is no NAME.suite.toml in `{}`{why}", path.display());
        }
    }
    Ok(found)
}

/// Checks that a file is a suite.
///
/// # Errors
/// It cannot be read, or is not a suite.
pub(super) fn expect_suite(path: &Path) -> anyhow::Result<()> {
    let text = read_regular(path).with_context(|| format!("`{}`", path.display()))?;
    let text = sim_format::decode(&text).0;
    if is_suite(&slashed(path), &text) {
        return Ok(());
    }
    if extension(&slashed(path)) == "sim" || sim_format::is_scene(&slashed(path), &text) {
        bail!("`{0}` is a scene: `eyesim run {0}` runs it; a suite names it", path.display());
    }
    bail!("`{}` is not a suite: it has no `[suite]`", path.display());
}

/// Indices of the selected cases of each suite. With `last_failed`, only failed cases are selected, if there are any.
fn select(runs: &[SuiteRun], selection: Option<&Selection>, last_failed: Option<&LastFailed>) -> Vec<Vec<usize>> {
    let indices = |run: &SuiteRun, is_selected: &dyn Fn(&Case) -> bool| -> Vec<usize> {
        (0..run.cases.len()).filter(|index| is_selected(&run.cases[*index])).collect()
    };
    let failed_cases = |run: &SuiteRun| {
        let failed = last_failed.map(|last| last.cases(&run.path)).unwrap_or_default();
        indices(run, &|case| failed.contains(&case.name))
    };
    let mut selected: Vec<Vec<usize>> = runs.iter().map(failed_cases).collect();
    if selected.iter().all(Vec::is_empty) {
        selected = runs.iter().map(|run| indices(run, &|_| true)).collect();
    }
    for (run, selected) in runs.iter().zip(&mut selected) {
        let name = |index: usize| format!("{}::{}", run.name(), run.cases[index].name);
        selected.retain(|index| selection.is_none_or(|selection| selection.matches(&name(*index))));
    }
    selected
}

/// Files with the names of the cases that failed the last time, in the folder of built programs; `None` if there is no
/// such folder.
struct LastFailed(Option<PathBuf>);

impl LastFailed {
    fn of_user() -> Self {
        Self(Cache::of_user().and_then(|cache| cache.folder("tests")).ok())
    }

    fn file(&self, suite: &Path) -> Option<PathBuf> {
        let path = std::path::absolute(suite).ok()?;
        let name = blake3::hash(path.as_os_str().as_encoded_bytes()).to_hex();
        Some(self.0.as_ref()?.join(format!("{}.json", &name[..32])))
    }

    fn cases(&self, suite: &Path) -> BTreeSet<String> {
        let read = || serde_json::from_slice(&std::fs::read(self.file(suite)?).ok()?).ok();
        read().unwrap_or_default()
    }

    /// Saves the names of the failed cases of the suites that were run; cases that were not run keep their verdicts. If
    /// the names cannot be written, the next `--lf` runs all cases.
    fn save(&self, runs: &[SuiteRun]) {
        for run in runs.iter().filter(|run| !run.results.is_empty()) {
            let previous = self.cases(&run.path);
            let is_failed = |(index, case): &(usize, &Case)| match run.results.get(index) {
                Some(result) => result.row.outcome != RowOutcome::Passed,
                None => previous.contains(&case.name),
            };
            let failed = run.cases.iter().enumerate().filter(is_failed);
            let names: Vec<&str> = failed.map(|(_, case)| case.name.as_str()).collect();
            if let (Some(file), Ok(bytes)) = (self.file(&run.path), serde_json::to_vec(&names)) {
                _ = write_atomically(&file, &bytes);
            }
        }
    }
}

/// Report of `eyesim test` with all rows.
#[derive(Serialize)]
struct Report<'r> {
    schema: u32,
    eyesim_version: &'static str,
    /// True if all suites passed and all their cases have run.
    passed: bool,
    /// Number of selected cases that have not run.
    missing: usize,
    suites: Vec<SuiteReport<'r>>,
}

#[derive(Serialize)]
struct SuiteReport<'r> {
    suite: &'r str,
    passed: bool,
    missing: usize,
    pass_rate: f64,
    points: f64,
    max_points: f64,
    variants: &'r [Variant],
    rows: Vec<&'r Row>,
}

impl<'r> SuiteReport<'r> {
    fn of(run: &'r SuiteRun) -> Self {
        let SuiteRun { suite, results, variants, .. } = run;
        Self {
            suite: &suite.spec.file,
            passed: run.is_passed(),
            missing: run.missing(),
            pass_rate: suite.spec.pass_rate,
            points: variants.iter().map(|variant| variant.points).sum(),
            max_points: variants.iter().map(|variant| variant.max_points).sum(),
            variants,
            rows: results.values().map(|result| &result.row).collect(),
        }
    }
}

fn write_files(args: &TestArgs, runs: &[SuiteRun], elapsed: Duration) -> anyhow::Result<()> {
    let write = |option: &str, path: &Path, bytes: &[u8]| {
        write_atomically(path, bytes).with_context(|| format!("{option}: cannot write `{}`", path.display()))
    };
    if let Some(path) = &args.report {
        let report = Report {
            schema: ROW_SCHEMA,
            eyesim_version: env!("CARGO_PKG_VERSION"),
            passed: runs.iter().all(SuiteRun::is_passed),
            missing: runs.iter().map(SuiteRun::missing).sum(),
            suites: runs.iter().map(SuiteReport::of).collect(),
        };
        let mut json = serde_json::to_vec_pretty(&report)?;
        json.push(b'\n');
        write("--report", path, &json)?;
    }
    if let Some(path) = &args.junit {
        let with_results = runs.iter().filter(|run| !run.results.is_empty());
        let suites = with_results.map(|run| {
            let missing = run.selected.iter().filter(|index| !run.results.contains_key(index));
            junit::Cases {
                suite: run.name(),
                results: run.results.values().collect(),
                missing: missing.map(|index| run.cases[*index].name.as_str()).collect(),
            }
        });
        write("--junit", path, junit::document(suites, elapsed)?.as_bytes())?;
    }
    if let Some(folder) = &args.html {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("--html: cannot make the folder `{}`", folder.display()))?;
        write("--html", &folder.join("index.html"), page::document(runs, elapsed).as_bytes())?;
    }
    Ok(())
}
