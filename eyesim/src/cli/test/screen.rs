//! Output of `eyesim test`: progress, failures and a short summary, like pytest's.

use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use console::Term;
use owo_colors::{OwoColorize as _, Style};
use sim_core::record::Outcome;
use sim_host::record::log::Printable;

use super::{SuiteRun, picture};
use crate::cli::diagnostic::{Colour, Screen};
use crate::cli::output::put;
use crate::suite::summary::{Rate, Variant};
use crate::suite::{Case, CaseResult, Row, RowOutcome};

/// Maximum number of failures with details.
const MAX_DETAILED: usize = 10;
/// Maximum number of lines of the short summary.
const MAX_LISTED: usize = 60;
/// Maximum number of variants of a suite whose rates are printed.
const MAX_VARIANTS: usize = 40;
/// Maximum number of lines of an error's details, such as the output of a compiler.
const MAX_DETAIL_LINES: usize = 30;
/// Width of lines, in columns.
const WIDTH: usize = 80;
/// Minimum time between two updates of the progress line.
const PERIOD: Duration = Duration::from_millis(100);

/// Standard output of `eyesim test`.
pub(super) struct Console {
    is_verbose: bool,
    is_quiet: bool,
    has_colour: bool,
    width: usize,
    suite: String,
    column: usize,
    count: usize,
    done: usize,
    last_flush: Instant,
    text: String,
}

impl Console {
    /// Creates the console; it prints a line for each case if `is_verbose`, and no progress if `is_quiet`.
    pub fn new(is_verbose: bool, is_quiet: bool) -> Self {
        let is_terminal = std::io::stdout().is_terminal();
        let width = if is_terminal { usize::from(Term::stdout().size().1).clamp(40, 120) } else { WIDTH };
        Self {
            is_verbose,
            is_quiet,
            has_colour: Screen::of_stdout(Colour::Auto).has_colour,
            width,
            suite: String::new(),
            column: 0,
            count: 0,
            done: 0,
            last_flush: Instant::now(),
            text: String::new(),
        }
    }

    /// Prints a line. Control characters of programs are shown as escapes.
    pub fn line(&mut self, line: &str) {
        self.text.push_str(&format!("{}\n", Printable(line)));
        self.flush();
    }

    /// Prints a line in a style.
    fn styled(&mut self, line: &str, style: Style) {
        let line = Printable(line).to_string();
        let line = if self.has_colour { line.style(style).to_string() } else { line };
        self.text.push_str(&line);
        self.text.push('\n');
        self.flush();
    }

    /// Prints a heading across the whole width.
    fn heading(&mut self, title: &str, sign: char, style: Style) {
        let remaining = self.width.saturating_sub(title.chars().count() + 2);
        let side = |count: usize| sign.to_string().repeat(count.max(3));
        self.styled(&format!("{} {title} {}", side(remaining / 2), side(remaining - remaining / 2)), style);
    }

    /// Prints the numbers of cases that were found and selected.
    pub fn collected(&mut self, paths: &[PathBuf], selected_count: usize, case_count: usize, jobs: usize) {
        if self.is_quiet {
            return;
        }
        self.heading("eyesim test", '=', Style::new().bold());
        let suites = if paths.len() == 1 { String::new() } else { format!(" of {} suites", paths.len()) };
        let deselected = if selected_count < case_count {
            format!(" / {} deselected / {selected_count} selected", case_count - selected_count)
        } else {
            String::new()
        };
        let cases = if case_count == 1 { "case" } else { "cases" };
        self.line(&format!("collected {case_count} {cases}{suites}{deselected}, {jobs} at a time"));
        self.line("");
    }

    /// Begins the progress of a suite.
    pub fn begin(&mut self, suite: &str, count: usize) {
        (self.suite, self.count, self.done, self.column) = (suite.to_owned(), count, 0, 0);
        if !self.is_quiet && !self.is_verbose {
            self.text.push_str(&format!("{} ", Printable(suite)));
            self.column = suite.chars().count() + 1;
            self.flush();
        }
    }

    /// Shows that a case is done.
    pub fn show_done(&mut self, row: &Row) {
        self.done += 1;
        if self.is_quiet {
            return;
        }
        let (letter, word, style) = match row.outcome {
            RowOutcome::Passed => (".", "PASSED", Style::new().green()),
            RowOutcome::Failed => ("F", "FAILED", Style::new().red()),
            RowOutcome::Error => ("E", "ERROR", Style::new().red()),
            RowOutcome::Interrupted => ("!", "INTERRUPTED", Style::new().yellow()),
        };
        let paint = |text: &str| if self.has_colour { text.style(style).to_string() } else { text.to_owned() };
        if self.is_verbose {
            let name = format!("{}::{}", self.suite, row.case);
            self.text.push_str(&format!("{} {} {}\n", Printable(&name), paint(word), self.percent()));
        } else {
            self.text.push_str(&paint(letter));
            self.column += 1;
            if self.column >= self.width.saturating_sub(8) {
                self.text.push_str(&format!(" {}\n", self.percent()));
                self.column = 0;
            }
        }
        if self.last_flush.elapsed() >= PERIOD {
            self.flush();
        }
    }

    /// Ends the progress of a suite.
    pub fn end(&mut self) {
        if !self.is_quiet && !self.is_verbose && self.column > 0 {
            let blank = " ".repeat(self.width.saturating_sub(self.column + 7));
            self.text.push_str(&format!("{blank} {}\n", self.percent()));
        }
        self.flush();
    }

    fn percent(&self) -> String {
        format!("[{:3}%]", 100 * self.done / self.count.max(1))
    }

    fn flush(&mut self) {
        self.last_flush = Instant::now();
        put(&self.text);
        self.text.clear();
    }

    /// Prints the first failures in detail: what failed, where, and how to view it.
    pub fn failures(&mut self, runs: &[SuiteRun]) {
        let failures = grouped_failures(runs);
        if failures.is_empty() {
            return;
        }
        self.line("");
        self.heading("FAILURES", '=', Style::new());
        for failure in failures.iter().take(MAX_DETAILED) {
            let name = failure.name();
            let name =
                if runs.len() > 1 { &name } else { name.split_once("::").map_or(name.as_str(), |(_, case)| case) };
            self.heading(name, '_', Style::new().red().bold());
            self.failure(failure.run, failure.result);
        }
        if failures.len() > MAX_DETAILED {
            self.line("");
            let more = failures.len() - MAX_DETAILED;
            self.line(&format!("... and {more} more: -k selects cases, --html and --report have all"));
        }
    }

    fn failure(&mut self, run: &SuiteRun, result: &CaseResult) {
        let row = &result.row;
        if row.checks.is_empty() || row.robots.iter().any(|robot| robot.outcome.is_failure()) {
            self.styled(&format!("E   {}", row.message), Style::new().red());
        }
        if row.points == 0.0 && row.checks.iter().any(|check| check.points > 0.0) {
            self.line("    no points, since a program failed");
        }
        let lines: Vec<&str> = row.details.lines().collect();
        lines.iter().take(MAX_DETAIL_LINES).for_each(|line| self.line(&format!("    {line}")));
        if lines.len() > MAX_DETAIL_LINES {
            self.line(&format!("    ... {} more lines", lines.len() - MAX_DETAIL_LINES));
        }
        let width = row.checks.iter().map(|check| check.name.chars().count()).max().unwrap_or_default();
        for check in &row.checks {
            let (verdict, style) = if check.passed { ("passed", Style::new()) } else { ("FAILED", Style::new().red()) };
            let points = format!("{}/{}", number(check.points), number(check.max_points));
            self.styled(&format!("{verdict}  {:width$}  {points:>5}  {}", check.name, check.message), style);
        }
        let case = run.cases.iter().find(|case| case.name == row.case);
        let picture = case.map(|case| picture::lines(case, result)).unwrap_or_default();
        if !picture.is_empty() {
            let time = row.at_s.map(|at| format!(" at {at:.3} s")).unwrap_or_default();
            let position = row.x_m.zip(row.y_m).map(|(x, y)| format!(", X: ({:.0}, {:.0}) mm{time}", 1e3 * x, 1e3 * y));
            self.line(&format!("  o: start{}", position.unwrap_or_default()));
            picture.iter().for_each(|line| self.line(&format!("  {line}")));
        }
        if !result.output.is_empty() {
            self.line("  the programs' last lines:");
            let skipped = result.output.len().saturating_sub(8);
            result.output.iter().skip(skipped).for_each(|line| self.line(&format!("    {line}")));
        }
        if let Some(command) = row.view_command() {
            self.styled(&format!("to see it: {command}"), Style::new().bold());
        }
    }

    /// Prints rates over seeds, a line for each failure, and the last line.
    pub fn summary(&mut self, runs: &[SuiteRun], elapsed: Duration, is_interrupted: bool) {
        let count = runs.iter().flat_map(SuiteRun::failures).count();
        if !self.is_quiet || count > 0 {
            self.rates(runs);
        }
        if count > 0 {
            self.heading("short test summary info", '=', Style::new());
            let failures = grouped_failures(runs);
            for failure in failures.iter().take(MAX_LISTED) {
                let row = &failure.result.row;
                let word = if row.outcome == RowOutcome::Error { "ERROR" } else { "FAILED" };
                self.line(&format!("{word} {} - {}", failure.name(), row.message));
            }
            if failures.len() > MAX_LISTED {
                self.line(&format!("... and {} more", failures.len() - MAX_LISTED));
            }
        }
        let missing: usize = runs.iter().map(SuiteRun::missing).sum();
        if is_interrupted {
            self.heading("interrupted: the cases above have run", '!', Style::new().yellow());
        }
        let count_of = |outcome| {
            let rows = runs.iter().flat_map(|run| run.results.values());
            rows.filter(|result| result.row.outcome == outcome).count()
        };
        let counts = [
            (count_of(RowOutcome::Failed), "failed"),
            (count_of(RowOutcome::Passed), "passed"),
            (count_of(RowOutcome::Error), "errors"),
            (count_of(RowOutcome::Interrupted), "interrupted"),
        ];
        let parts: Vec<String> =
            counts.iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}")).collect();
        let mut parts = if parts.is_empty() { no_cases_message(runs) } else { parts.join(", ") };
        if missing > 0 {
            parts.push_str(&format!(", {missing} not run"));
        }
        if !runs
            .iter()
            .flat_map(|run| run.results.values())
            .any(|result| result.row.outcome == RowOutcome::Error || !result.row.checks.is_empty())
        {
            parts.push_str(", without any check");
        }
        let points: f64 = runs.iter().flat_map(|run| &run.variants).map(|variant| variant.points).sum();
        let max: f64 = runs.iter().flat_map(|run| &run.variants).map(|variant| variant.max_points).sum();
        let points = if max > 0.0 { format!(", {} of {} points", number(points), number(max)) } else { String::new() };
        let is_passed = runs.iter().all(SuiteRun::is_passed);
        let tolerated = if count > 0 && is_passed { ", pass rate met" } else { "" };
        let style = if is_passed { Style::new().green().bold() } else { Style::new().red().bold() };
        self.heading(&format!("{parts}{tolerated}{points} in {:.2}s", elapsed.as_secs_f64()), '=', style);
    }

    /// Prints, for suites with several cases per variant, the share of cases that meets each check.
    fn rates(&mut self, runs: &[SuiteRun]) {
        for run in runs.iter().filter(|run| run.variants.iter().any(|variant| variant.rate.count > 1)) {
            self.line("");
            let needed = run.suite.spec.pass_rate;
            self.line(&format!("{}: {} of the seeds must pass", run.name(), percent(needed)));
            for variant in run.variants.iter().take(MAX_VARIANTS) {
                self.variant(variant, run.variants.len() == 1);
            }
            if run.variants.len() > MAX_VARIANTS {
                self.line(&format!("... and {} more variants", run.variants.len() - MAX_VARIANTS));
            }
        }
    }

    fn variant(&mut self, variant: &Variant, shows_all_checks: bool) {
        let (verdict, style) =
            if variant.passed { ("passed", Style::new().green()) } else { ("FAILED", Style::new().red()) };
        let points = format!("{}/{} points", number(variant.points), number(variant.max_points));
        // `run` is the name of a variant without settings.
        let name = if variant.name == "run" { "all checks" } else { &variant.name };
        self.styled(&format!("{verdict}  {name}: {}, {points}", rate_text(&variant.rate)), style);
        let shown = variant.checks.iter().filter(|(_, rate)| shows_all_checks || rate.passed < rate.count);
        for (name, rate) in shown {
            self.line(&format!("          {name}: {}", rate_text(rate)));
        }
    }
}

/// A failure, and the number of further cases that failed in the same way.
struct Failure<'r> {
    run: &'r SuiteRun,
    result: &'r CaseResult,
    others: usize,
}

impl Failure<'_> {
    /// `a.suite.toml::seed=3`, with the number of further cases.
    fn name(&self) -> String {
        let others = match self.others {
            0 => String::new(),
            1 => " and 1 other case".to_owned(),
            count => format!(" and {count} other cases"),
        };
        format!("{}::{}{others}", self.run.name(), self.result.row.case)
    }
}

/// Message if no case ran, for example ``no cases ran: `a.suite.toml` has 20, from `seed=1` to `seed=20` ``.
fn no_cases_message(runs: &[SuiteRun]) -> String {
    let cases = runs.iter().find_map(|run| Some((run, run.cases.first()?, run.cases.last()?)));
    let range = |(run, first, last): (&SuiteRun, &Case, &Case)| {
        format!(": `{}` has {}, from `{}` to `{}`", run.name(), run.cases.len(), first.name, last.name)
    };
    format!("no cases ran{}", cases.map(range).unwrap_or_default())
}

/// The failures, grouped: cases that could not be run for the same reason form one group, and so do cases of a variant
/// in which the same checks and the same programs failed.
fn grouped_failures(runs: &[SuiteRun]) -> Vec<Failure<'_>> {
    let mut failures: Vec<Failure<'_>> = Vec::new();
    for run in runs {
        let run_start = failures.len();
        for result in run.failures() {
            let is_same = |other: &&mut Failure<'_>| {
                let [a, b] = [&other.result.row, &result.row];
                match b.outcome {
                    _ if a.outcome != b.outcome => false,
                    RowOutcome::Error => a.message == b.message && a.details == b.details,
                    _ => a.variant == b.variant && verdicts_of(a).eq(verdicts_of(b)),
                }
            };
            match failures[run_start..].iter_mut().find(is_same) {
                Some(failure) => failure.others += 1,
                None => failures.push(Failure { run, result, others: 0 }),
            }
        }
    }
    failures
}

/// Key for grouping failures: the verdicts of the checks and the outcomes of the programs.
fn verdicts_of(row: &Row) -> impl Iterator<Item = (bool, Option<Outcome>)> {
    let checks = row.checks.iter().map(|check| (check.passed, None));
    checks.chain(row.robots.iter().map(|robot| (robot.outcome.is_failure(), Some(robot.outcome))))
}

/// Text of a rate: `9 of 10 (90 %, 95 % interval 60 to 98 %)`.
pub(super) fn rate_text(rate: &Rate) -> String {
    let Rate { passed, count, low, high } = rate;
    // Near 0 and 100 % a rounded bound would suggest that the rate is exactly known.
    let bound = |fraction: f64| {
        let digits = usize::from((0.0 < fraction && fraction < 0.01) || (0.99 < fraction && fraction < 1.0));
        format!("{:.digits$}", 100.0 * fraction)
    };
    let interval = format!("95 % interval {} to {} %", bound(*low), bound(*high));
    format!("{passed} of {count} ({}, {interval})", percent(rate.share()))
}

/// Text of a fraction: `90 %`.
pub(in crate::cli) fn percent(fraction: f64) -> String {
    format!("{} %", number(100.0 * fraction))
}

/// A number with at most two digits after the point.
pub(in crate::cli) fn number(number: f64) -> String {
    let text = format!("{number:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
