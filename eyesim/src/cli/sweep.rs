//! `eyesim sweep`: runs the cases of a suite and adds their rows to a folder; a later call continues the sweep. Also
//! shows the status of a folder and merges its rows.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write as _};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};
use clap::{Args, Subcommand, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use sim_format::path::file_name;
use sim_host::executive::interrupt::{self, Interrupt};
use sim_host::record::log::Printable;
use sim_host::record::report::write_atomically;

use super::output::{check_outputs, output_path, say, tell};
use super::pack::is_archive;
use super::run::report_diagnostics;
use super::test::{builder, expect_suite, job_count};
use super::{EXIT_INTERRUPTED, EXIT_PROGRAM};
use crate::suite::table::Table;
use crate::suite::{Case, CaseResult, Keep, Pool, PoolOptions, Preparation, Row, RowOutcome, Session, Suite};
use crate::sweep::{Head, Lines, Shard, ShardFile, finished_cases, merge, read_all};

/// Arguments of `eyesim sweep`.
#[derive(Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true,
    after_help = AFTER_HELP
)]
pub struct SweepArgs {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: Option<RunArgs>,
}

#[derive(Args)]
struct RunArgs {
    /// The suite (NAME.suite.toml)
    #[arg(value_name = "SUITE")]
    suite: PathBuf,
    /// Folder for the rows; the same command continues an interrupted sweep
    #[arg(short, long, value_name = "OUT", value_parser = output_path())]
    output: PathBuf,
    /// Number of cases that run at the same time [default: one for each processor]
    #[arg(short, long, value_name = "NUMBER")]
    jobs: Option<NonZeroUsize>,
    /// Run only every N-th case, from the I-th on; other processes or machines run the others
    #[arg(long, value_name = "I/N", value_parser = Shard::parse, default_value = "1/1")]
    shard: Shard,
    /// Keep the traces of these cases, as OUT/traces/KEY.jsonl.zst
    #[arg(long, value_enum, value_name = "none|failed|all", hide_possible_values = true, default_value = "none")]
    keep: KeepArg,
    /// Run every case in its own process
    #[arg(long)]
    isolate: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum KeepArg {
    None,
    Failed,
    All,
}

#[derive(Subcommand)]
enum Command {
    /// Show which cases have rows
    Status {
        /// Folder of rows
        #[arg(value_name = "OUT")]
        folder: PathBuf,
    },
    /// Join rows into one table
    Merge {
        /// Folders of rows
        #[arg(value_name = "OUT", required = true)]
        folders: Vec<PathBuf>,
        /// Table to write: NAME.csv or NAME.parquet, or NAME.jsonl with complete rows
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
    /// Run one case alone and print its row
    Case {
        /// The suite (NAME.suite.toml)
        #[arg(value_name = "SUITE")]
        suite: PathBuf,
        /// Key of a row, or name of a case; `-` reads them from standard input, one on each line
        #[arg(value_name = "KEY")]
        key: String,
    },
    /// Build the programs and print the key and the name of each case
    Plan {
        /// The suite (NAME.suite.toml)
        #[arg(value_name = "SUITE")]
        suite: PathBuf,
    },
}

const AFTER_HELP: &str = "Exit codes: 0 all cases have rows, 1 some could not be run, 2 usage or file errors, 130 interrupted: the same \
                          command continues.";

/// Maximum number of errors that are listed one by one.
const MAX_ERRORS: usize = 5;

/// Runs the command.
///
/// # Errors
/// If files or arguments are wrong, or a file cannot be written.
pub fn run(args: &SweepArgs) -> anyhow::Result<ExitCode> {
    match (&args.command, &args.run) {
        (Some(Command::Status { folder }), _) => status(folder),
        (Some(Command::Merge { folders, output }), _) => join(folders, output),
        (Some(Command::Case { suite, key }), _) => case(suite, key),
        (Some(Command::Plan { suite }), _) => plan(suite),
        (None, Some(args)) => sweep(args),
        (None, None) => bail!("expected a suite and a folder: `eyesim sweep SUITE -o OUT`"),
    }
}

/// Opens a suite; returns it with its cases.
fn open(path: &Path) -> anyhow::Result<(Suite, Vec<Case>)> {
    ensure!(!is_archive(path), "`{0}` is an archive: unpack it (`unzip {0}`) and name the suite in it", path.display());
    expect_suite(path)?;
    let suite = Suite::open(path, Vec::new());
    report_diagnostics(&suite.diagnostics, &suite.inputs, false)?;
    let cases = suite.cases().map_err(anyhow::Error::msg).with_context(|| format!("`{}`", path.display()))?;
    Ok((suite, cases))
}

/// Prepares the run of `cases`: builds all their programs.
///
/// # Errors
/// A program cannot be built.
fn prepare(suite: &Suite, cases: &[&Case], keep: Keep, interrupt: &Interrupt) -> anyhow::Result<Preparation> {
    let mut session = Session::new(builder(false, None)?, interrupt.clone());
    session.keep = keep;
    let preparation = Preparation::of(suite, cases.iter().copied(), session);
    match cases.iter().find_map(|case| preparation.failure(suite, case)) {
        Some(result) => Err(refusal(&result)),
        None => Ok(preparation),
    }
}

fn refusal(result: &CaseResult) -> anyhow::Error {
    let Row { case, message, details, .. } = &result.row;
    let details = if details.is_empty() { String::new() } else { format!("\n{details}") };
    anyhow::anyhow!("the case `{case}` cannot be run: {message}{details}")
}

fn sweep(args: &RunArgs) -> anyhow::Result<ExitCode> {
    let start = Instant::now();
    let (suite, cases) = open(&args.suite)?;
    let indices: Vec<usize> = (0..cases.len()).filter(|&case| args.shard.contains(case)).collect();
    let (file, lines) = ShardFile::open(&args.output, args.shard).context("-o")?;
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let shard_cases: Vec<&Case> = indices.iter().map(|&index| &cases[index]).collect();
    let mut preparation = prepare(&suite, &shard_cases, keep_policy(args)?, &interrupt)?;
    let mut outcomes = finished_cases(&lines, args.shard, (&suite, &cases[..]), &mut preparation.session)?;
    file.begin(&lines, &Head::new(&suite.spec.file, cases.len(), args.shard))?;
    if lines.torn > 0 {
        say(format_args!(
            "{}: the last line was incomplete ({} bytes): its case runs again",
            lines.path.display(),
            lines.torn
        ));
    }
    if !outcomes.is_empty() {
        say(format_args!("{} of {} cases have their rows already", outcomes.len(), indices.len()));
    }
    let missing: Vec<usize> = indices.iter().copied().filter(|index| !outcomes.contains_key(index)).collect();
    let options = PoolOptions { workers: job_count(args.jobs), isolate: args.isolate };
    let (mut failure, mut errors) = (None, BTreeSet::new());
    let bar = progress(indices.len(), outcomes.len());
    Pool::new(&suite, &cases, preparation, options).run(&missing, &mut |index, CaseResult { row, .. }| {
        bar.inc(1);
        outcomes.insert(index, row.outcome);
        if row.outcome == RowOutcome::Error && errors.insert(row.message.clone()) && errors.len() <= MAX_ERRORS {
            bar.suspend(|| say(format_args!("{}: {}", row.case, row.message)));
        }
        failure = file.append(&row).err();
        if failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    bar.finish_and_clear();
    if let Some(error) = failure {
        return Err(error).context("the sweep ends here, and the same command continues it");
    }
    file.sync()?;
    if interrupt.is_set() {
        say(format_args!(
            "interrupted: {} of {} cases have rows in {}; the same command continues",
            outcomes.len(),
            indices.len(),
            lines.path.display()
        ));
        return Ok(ExitCode::from(EXIT_INTERRUPTED));
    }
    tell(format_args!(
        "{} of {} cases have rows in {}: {}, in {:.1} s",
        outcomes.len(),
        indices.len(),
        lines.path.display(),
        counts(outcomes.values().copied()),
        start.elapsed().as_secs_f64()
    ));
    let has_errors = outcomes.values().any(|outcome| *outcome == RowOutcome::Error);
    Ok(if has_errors { ExitCode::from(EXIT_PROGRAM) } else { ExitCode::SUCCESS })
}

/// Reads `--keep`, and creates the folder of traces if any are kept.
fn keep_policy(args: &RunArgs) -> anyhow::Result<Keep> {
    let folder = || {
        let folder = args.output.join("traces");
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
        anyhow::Ok(folder)
    };
    Ok(match args.keep {
        KeepArg::None => Keep::None,
        KeepArg::Failed => Keep::Failed(folder()?),
        KeepArg::All => Keep::All(folder()?),
    })
}

/// Progress bar on standard error, hidden if that is not a terminal. It has no thread, so that this process can fork.
fn progress(count: usize, done: usize) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr_with_hz(5));
    let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} {eta}");
    // The template is valid; if it were not, the default style would do.
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.with_position(done as u64)
}

/// Text with the number of cases for each outcome: `4990 passed, 10 failed`.
fn counts(outcomes: impl Iterator<Item = RowOutcome>) -> String {
    let mut counts: BTreeMap<RowOutcome, usize> = BTreeMap::new();
    outcomes.for_each(|outcome| *counts.entry(outcome).or_default() += 1);
    let parts: Vec<String> = counts.iter().map(|(outcome, count)| format!("{count} {}", outcome.word())).collect();
    if parts.is_empty() { "none".to_owned() } else { parts.join(", ") }
}

fn report_torn_lines(files: &[Lines]) {
    for lines in files.iter().filter(|lines| lines.torn > 0) {
        say(format_args!(
            "{}: the last line is incomplete ({} bytes) and is left out",
            lines.path.display(),
            lines.torn
        ));
    }
}

/// Prints how many cases have rows, and which shards lack rows.
fn status(folder: &Path) -> anyhow::Result<ExitCode> {
    let files = read_all(folder)?;
    report_torn_lines(&files);
    let cases = files.iter().filter_map(|lines| Some(lines.head.as_ref()?.cases)).max().unwrap_or_default();
    let mut incomplete = Vec::new();
    for lines in &files {
        // The file of a shard that has not continued since the suite has more cases has an old header.
        let expected = lines.shard.count_of(cases);
        let with_row = merge(vec![lines.clone()])?.iter().filter(|row| row.outcome != RowOutcome::Error).count();
        if with_row < expected || lines.head.is_none() {
            incomplete.push(format!("  shard {}: {with_row} of {expected} cases", lines.shard));
        }
    }
    let counts_of_shards: BTreeSet<usize> = files.iter().map(|lines| lines.shard.count()).collect();
    for count in counts_of_shards {
        let present: BTreeSet<usize> =
            files.iter().filter(|lines| lines.shard.count() == count).map(|lines| lines.shard.index()).collect();
        if present.len() < count {
            let missing: Vec<usize> = (1..=count).filter(|index| !present.contains(index)).collect();
            incomplete.push(format!("  not begun: {} of {count} shards ({})", missing.len(), ranges(&missing)));
        }
    }
    let rows = merge(files)?;
    tell(format_args!("{} of {cases} cases have rows: {}", rows.len(), counts(rows.iter().map(|row| row.outcome))));
    if rows.iter().filter(|row| row.outcome != RowOutcome::Error).count() >= cases {
        return Ok(ExitCode::SUCCESS);
    }
    incomplete.iter().for_each(tell);
    Ok(ExitCode::from(EXIT_PROGRAM))
}

/// Formats numbers as `1,3-5`, the format of Slurm's `--array`.
fn ranges(numbers: &[usize]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let format_run = |run: &[usize]| match run {
        [number] => number.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    runs.map(format_run).collect::<Vec<_>>().join(",")
}

fn join(folders: &[PathBuf], output: &Path) -> anyhow::Result<ExitCode> {
    let extension = output.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let name = output.display();
    ensure!(
        ["csv", "parquet", "jsonl"].contains(&extension),
        "-o `{name}`: expected NAME.csv, NAME.parquet or NAME.jsonl"
    );
    let mut files = Vec::new();
    for folder in folders {
        files.extend(read_all(folder)?);
    }
    report_torn_lines(&files);
    let inputs: Vec<String> = files.iter().map(|lines| lines.path.display().to_string()).collect();
    check_outputs(&[("-o", output)], inputs.iter().map(String::as_str))?;
    // The same suite has other paths in other folders and on other machines.
    let mut cases: BTreeMap<String, usize> = BTreeMap::new();
    for head in files.iter().filter_map(|lines| lines.head.as_ref()) {
        let count = cases.entry(file_name(&head.suite).to_owned()).or_default();
        *count = head.cases.max(*count);
    }
    let rows = merge(files)?;
    let mut keys: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    rows.iter().for_each(|row| *keys.entry((file_name(&row.suite), &row.case)).or_default() += 1);
    if let Some(((_, case), _)) = keys.iter().find(|(_, count)| **count > 1) {
        let count = keys.values().filter(|count| **count > 1).count();
        say(format_args!("warning: {count} cases have several rows, such as `{case}`: the suite or its files differ"));
    }
    for (suite, cases) in cases {
        let with_row = keys.keys().filter(|(other, _)| *other == suite).count();
        if with_row < cases {
            say(format_args!("warning: {} of {cases} cases of `{suite}` have no row", cases - with_row));
        }
    }
    let bytes = match extension {
        "csv" => Table::of(&rows).csv().into_bytes(),
        "parquet" => parquet(&Table::of(&rows))?,
        _ => json_lines(&rows)?,
    };
    write_atomically(output, &bytes).with_context(|| format!("cannot write `{}`", output.display()))?;
    tell(format_args!("{} rows in {}: {}", rows.len(), output.display(), counts(rows.iter().map(|row| row.outcome))));
    Ok(ExitCode::SUCCESS)
}

#[cfg(feature = "parquet")]
fn parquet(table: &Table) -> anyhow::Result<Vec<u8>> {
    crate::suite::parquet::parquet(table).context("rows as Parquet")
}

#[cfg(not(feature = "parquet"))]
fn parquet(_: &Table) -> anyhow::Result<Vec<u8>> {
    bail!("this eyesim is built without Parquet (cargo's feature `parquet`): write NAME.csv or NAME.jsonl")
}

fn json_lines(rows: &[Row]) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for row in rows {
        serde_json::to_writer(&mut bytes, row)?;
        bytes.push(b'\n');
    }
    Ok(bytes)
}

fn plan(path: &Path) -> anyhow::Result<ExitCode> {
    let (suite, cases) = open(path)?;
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let mut preparation = prepare(&suite, &cases.iter().collect::<Vec<_>>(), Keep::None, &interrupt)?;
    for case in &cases {
        if interrupt.is_set() {
            return Ok(ExitCode::from(EXIT_INTERRUPTED));
        }
        let key = preparation.session.key(&suite, case).map_err(|result| refusal(&result))?;
        print_line(&serde_json::json!({ "key": key, "case": case.name }))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn case(path: &Path, key: &str) -> anyhow::Result<ExitCode> {
    let (suite, cases) = open(path)?;
    let interrupt = interrupt::of_process().context("cannot install signal handlers")?;
    let session = Session::new(builder(true, None)?, interrupt.clone());
    let reads_keys = key == "-";
    // The program of a single case is built when it runs.
    let preparation = Preparation::of(&suite, cases.iter().filter(|_| reads_keys), session);
    let mut pool = Pool::new(&suite, &cases, preparation, PoolOptions { workers: 1, isolate: !reads_keys });
    let names: BTreeMap<&str, usize> = (0..).zip(&cases).map(|(index, case)| (case.name.as_str(), index)).collect();
    let mut keys: BTreeMap<String, usize> = BTreeMap::new();
    let lines: Box<dyn Iterator<Item = io::Result<String>>> =
        if reads_keys { Box::new(io::stdin().lines()) } else { Box::new(std::iter::once(Ok(key.to_owned()))) };
    for key in lines {
        let key = key.context("standard input")?;
        if !names.contains_key(key.as_str()) && keys.is_empty() {
            keys = (0..cases.len()).filter_map(|index| Some((pool.key(index).ok()?, index))).collect();
        }
        let index = names.get(key.as_str()).or(keys.get(&key)).copied();
        let unknown = || format!("`{}` is neither a key nor a case of `{}`", Printable(&key), path.display());
        let mut row = None;
        pool.run(&[index.with_context(unknown)?], &mut |_, result| {
            row = Some(result.row);
            ControlFlow::Continue(())
        })?;
        match row {
            Some(row) => print_line(&row)?,
            None => return Ok(ExitCode::from(EXIT_INTERRUPTED)),
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn print_line(line: &impl Serialize) -> anyhow::Result<()> {
    let mut bytes = serde_json::to_vec(line)?;
    bytes.push(b'\n');
    let mut out = io::stdout().lock();
    out.write_all(&bytes).and_then(|()| out.flush()).context("standard output")
}
