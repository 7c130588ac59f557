//! Page with the results of suites, for a browser: one file that contains no scripts and loads nothing.

use std::fmt::Write as _;
use std::time::Duration;

use glam::DVec2;
use sim_core::build::MeshSource as _;
use sim_format::MeshReader;
use sim_host::files::DiskFiles;
use sim_host::launch::Scene;
use sim_host::record::log::is_terminal_control;

use super::SuiteRun;
use super::screen::{number, percent, rate_text};
use crate::plot::{PictureKind, draw_trials};
use crate::suite::summary::Variant;
use crate::suite::{Case, CaseResult, Row, RowOutcome};

/// Maximum number of failures with details.
const MAX_DETAILED: usize = 100;
/// Maximum number of paths in a picture.
const MAX_PATHS: usize = 60;

const STYLE: &str = include_str!("page.css");

/// The page with the results of all suites.
pub(super) fn document(runs: &[SuiteRun], elapsed: Duration) -> String {
    let mut html = head("eyesim test", "");
    let count = |outcome| {
        let rows = runs.iter().flat_map(|run| run.results.values());
        rows.filter(|result| result.row.outcome == outcome).count()
    };
    let (passed, failed, errors) = (count(RowOutcome::Passed), count(RowOutcome::Failed), count(RowOutcome::Error));
    let missing: usize = runs.iter().map(SuiteRun::missing).sum();
    let missing = if missing > 0 { format!(", {missing} not run") } else { String::new() };
    // Writing to a string cannot fail.
    _ = write!(
        html,
        "<h1>eyesim test</h1>\n<p>{passed} passed, {failed} failed, {errors} errors{missing} in {:.2} s</p>\n",
        elapsed.as_secs_f64()
    );
    for run in runs.iter().filter(|run| !run.results.is_empty()) {
        suite(&mut html, run);
    }
    html.push_str(FOOT);
    html
}

/// Beginning of a page, with style rules in addition to those of all pages.
pub(in crate::cli) fn head(title: &str, style: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n<body>\n",
        escaped(title)
    )
}

/// End of a page.
pub(in crate::cli) const FOOT: &str = "</body>\n</html>\n";

/// Cases and results shown on a page.
pub(in crate::cli) struct Sheet<'r> {
    /// The cases.
    pub cases: &'r [Case],
    /// Results of those cases that have run.
    pub results: Vec<&'r CaseResult>,
}

fn suite(html: &mut String, run: &SuiteRun) {
    let verdict = match run.missing() {
        _ if run.is_failed() => "failed",
        0 => "passed",
        _ => "interrupted",
    };
    _ = write!(
        html,
        "<section>\n<h2><span class=\"{verdict}\">{verdict}</span> {}</h2>\n<p>{} of the seeds must pass.</p>\n",
        escaped(run.name()),
        percent(run.suite.spec.pass_rate)
    );
    let sheet = Sheet { cases: &run.cases, results: run.results.values().collect() };
    for variant in &run.variants {
        heat_map(html, &sheet, variant);
    }
    let failures: Vec<&CaseResult> = run.failures().collect();
    if !failures.is_empty() {
        html.push_str("<h3>Failures</h3>\n");
        failures.iter().take(MAX_DETAILED).for_each(|result| failure(html, result));
        if failures.len() > MAX_DETAILED {
            _ = writeln!(html, "<p>... and {} more.</p>", failures.len() - MAX_DETAILED);
        }
    }
    html.push_str("</section>\n");
}

/// Writes the table of a variant, with a row for each check and a column for each case, and a picture with the paths of
/// its failures.
pub(in crate::cli) fn heat_map(html: &mut String, sheet: &Sheet<'_>, variant: &Variant) {
    let variant_results = sheet.results.iter().filter(|result| result.row.variant == variant.name);
    let results: Vec<&CaseResult> = variant_results.copied().collect();
    let verdict = if variant.passed { "passed" } else { "failed" };
    let name = if variant.name == "run" { "all cases" } else { &variant.name };
    _ = write!(
        html,
        "<h3><span class=\"{verdict}\">{verdict}</span> {}</h3>\n<p>{}; {} of {} points</p>\n\
         <div class=\"wide\"><table class=\"map\">\n<tr><th></th>",
        escaped(name),
        rate_text(&variant.rate),
        number(variant.points),
        number(variant.max_points)
    );
    for result in &results {
        let seed = result.row.settings.iter().find(|(name, _)| name == "seed");
        let seed = seed.map_or_else(|| result.row.seed.to_string(), |(_, seed)| seed.clone());
        _ = write!(html, "<th title=\"{}\">{}</th>", escaped(&result.row.case), escaped(&seed));
    }
    html.push_str("<th>passed</th></tr>\n");
    for (index, (check, rate)) in variant.checks.iter().enumerate() {
        _ = write!(html, "<tr><th>{}</th>", escaped(check));
        for result in &results {
            let found = result.row.checks.get(index);
            let (class, sign, title) = match found {
                Some(check) if check.passed => ("passed", "\u{b7}", check.message.as_str()),
                Some(check) if check.points > 0.0 => ("partly", "\u{bd}", check.message.as_str()),
                Some(check) => ("failed", "\u{d7}", check.message.as_str()),
                None => ("error", "?", result.row.message.as_str()),
            };
            cell(html, &result.row, class, sign, title);
        }
        _ = writeln!(html, "<td>{}</td></tr>", percent(rate.share()));
    }
    html.push_str("<tr><th>case</th>");
    for result in &results {
        let (class, sign) = match result.row.outcome {
            RowOutcome::Passed => ("passed", "\u{b7}"),
            RowOutcome::Failed => ("failed", "\u{d7}"),
            RowOutcome::Error | RowOutcome::Interrupted => ("error", "?"),
        };
        cell(html, &result.row, class, sign, &result.row.message);
    }
    _ = writeln!(html, "<td>{}</td></tr>\n</table></div>", percent(variant.rate.share()));
    html.push_str(&trials(sheet, &results).unwrap_or_default());
}

fn cell(html: &mut String, row: &Row, class: &str, sign: &str, title: &str) {
    let target = if class == "passed" { sign.to_owned() } else { format!("<a href=\"#{}\">{sign}</a>", id(row)) };
    _ = write!(html, "<td class=\"{class}\" title=\"{}: {}\">{target}</td>", escaped(&row.case), escaped(title));
}

/// Picture of the world with the paths of the cases that failed.
fn trials(sheet: &Sheet<'_>, results: &[&CaseResult]) -> Option<String> {
    let failed: Vec<&&CaseResult> = results.iter().filter(|result| !result.traces.is_empty()).take(MAX_PATHS).collect();
    let first = failed.first()?;
    let case = sheet.cases.iter().find(|case| case.name == first.row.case)?;
    let scene = Scene::open(&case.scene, case.options.clone()).ok()?;
    let trials: Vec<(Vec<Vec<DVec2>>, Option<DVec2>)> = failed
        .iter()
        .map(|result| {
            let lines = result.traces.iter().flat_map(|trace| &trace.lines);
            let lines = lines.map(|line| line.iter().map(|point| DVec2::from(*point)).collect()).collect();
            (lines, result.row.x_m.zip(result.row.y_m).map(DVec2::from))
        })
        .collect();
    let floor = MeshReader::new(&DiskFiles::of_environment()).floor(&scene.spec().world);
    let drawing = draw_trials(scene.spec(), floor, &trials);
    let svg = String::from_utf8(PictureKind::Svg.render(&drawing, Some((720, 480))).ok()?).ok()?;
    let begin = svg.find("<svg")?;
    Some(format!(
        "<figure>{}<figcaption>Paths of the failures; crosses: where they failed.</figcaption></figure>\n",
        &svg[begin..]
    ))
}

pub(in crate::cli) fn failure(html: &mut String, result: &CaseResult) {
    let row = &result.row;
    _ = writeln!(
        html,
        "<details id=\"{}\"><summary><b>{}</b> {}</summary>",
        id(row),
        escaped(&row.case),
        escaped(&row.message)
    );
    if !row.details.is_empty() {
        _ = writeln!(html, "<pre>{}</pre>", escaped(&row.details));
    }
    if !row.checks.is_empty() {
        html.push_str("<table>\n");
        for check in &row.checks {
            let class = if check.passed { "passed" } else { "failed" };
            _ = writeln!(
                html,
                "<tr><td class=\"{class}\">{class}</td><td>{}</td><td>{}/{}</td><td>{}</td></tr>",
                escaped(&check.name),
                number(check.points),
                number(check.max_points),
                escaped(&check.message)
            );
        }
        html.push_str("</table>\n");
    }
    if !result.output.is_empty() {
        _ = writeln!(html, "<p>The programs' last lines:</p>\n<pre>{}</pre>", escaped(&result.output.join("\n")));
    }
    if let Some(command) = row.view_command() {
        _ = writeln!(html, "<p>To see it:</p>\n<pre>{}</pre>", escaped(&command));
    }
    html.push_str("</details>\n");
}

/// Identifier of a case within the page.
fn id(row: &Row) -> String {
    let name = format!("{}-{}", row.suite, row.case);
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect()
}

/// Escapes characters that are special in HTML.
pub(in crate::cli) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(c),
            c if is_terminal_control(c) => escaped.extend(c.escape_unicode()),
            c => escaped.push(c),
        }
    }
    escaped
}
