//! The part of a result that a student may see, and the student's page.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use super::Student;
use crate::cli::run::forbidden_calls;
use crate::cli::test::page::{FOOT, Sheet, escaped, failure, head, heat_map};
use crate::cli::test::screen::{number, percent};
use crate::grade::Grader;
use crate::suite::summary::Variant;
use crate::suite::{CaseResult, RowOutcome};

/// Style sheet of the grading pages.
pub(super) const STYLE: &str = include_str!("page.css");
/// Maximum number of failures with details.
const MAX_DETAILED: usize = 40;

/// Results as the student may see them: without anything that reveals a hidden seed, and with commands that show the
/// archives in the student's folder.
pub(super) struct View {
    /// Results, in the order of the cases.
    pub results: Vec<CaseResult>,
    /// Names of the archives in the student's folder that repeat failures, each with the path of its scene.
    pub replays: Vec<(String, PathBuf)>,
}

impl View {
    /// The view of a student's result.
    pub(super) fn of(grader: &Grader, student: &Student) -> Self {
        let mut hidden: Vec<u64> = Vec::new();
        for case in grader.cases().iter().filter(|case| grader.is_hidden(case)) {
            let seed = case.options.seed.unwrap_or_default();
            if !hidden.contains(&seed) {
                hidden.push(seed);
            }
        }
        let mut view = Self { results: student.graded.results.clone(), replays: Vec::new() };
        for (case, result) in grader.cases().iter().zip(&mut view.results) {
            let seed = case.options.seed.unwrap_or_default();
            if grader.is_hidden(case) {
                let number = hidden.iter().position(|other| *other == seed).map_or(0, |number| number + 1);
                hide(result, seed, number);
            } else if !result.row.words.is_empty() && result.row.outcome != RowOutcome::Passed {
                let replay = view.replays.iter().find(|(_, scene)| *scene == case.scene);
                let name = replay.map_or_else(
                    || match view.replays.len() {
                        0 => "replay.zip".to_owned(),
                        count => format!("replay-{}.zip", count + 1),
                    },
                    |(name, _)| name.clone(),
                );
                if replay.is_none() {
                    view.replays.push((name.clone(), case.scene.clone()));
                }
                // The archive has the program, but not the suite.
                let is_not_in_archive = |word: &String| {
                    ["--program=", "--exec=", "--checks="].iter().any(|option| word.starts_with(option))
                };
                result.row.words.retain(|word| !is_not_in_archive(word));
                result.row.words[0] = name;
            }
        }
        view
    }
}

/// Removes everything from the result that reveals its seed.
fn hide(result: &mut CaseResult, seed: u64, number: usize) {
    let row = &mut result.row;
    row.case = row.case.replace(&format!("seed={seed}"), &format!("hidden {number}"));
    row.settings.iter_mut().filter(|(name, _)| name == "seed").for_each(|(_, label)| *label = format!("h{number}"));
    (row.seed, row.digest, row.key) = (0, None, String::new());
    row.words.clear();
    result.traces.clear();
    result.output.clear();
}

/// The page of a student.
pub(super) fn page(grader: &Grader, student: &Student, view: &View) -> String {
    let mut html = head(&format!("{}: eyesim grade", student.submission.name), STYLE);
    let verdict = student.verdict();
    // Writing to a string cannot fail.
    _ = write!(
        html,
        "<h1>{}</h1>\n<p>{}</p>\n<p class=\"score\">{} of {} points</p>\n",
        escaped(&student.submission.name),
        escaped(&title(grader)),
        number(student.points()),
        number(student.max_points())
    );
    if let Some(problem) = &student.graded.problem {
        _ = writeln!(html, "<p>Nothing was run:</p>\n<pre>{}</pre>", escaped(problem));
    } else {
        for (robots, files) in &student.graded.programs {
            let files: Vec<String> = files.iter().map(|file| format!("<code>{}</code>", escaped(file))).collect();
            _ = writeln!(html, "<p>Program of robot {}: {}</p>", escaped(robots), files.join(", "));
        }
    }
    let forbidden = forbidden_of(&view.results);
    if !forbidden.is_empty() {
        _ = writeln!(html, "<p>Forbidden functions called, in all cases together: {}</p>", escaped(&forbidden));
    }
    if !student.graded.notes.is_empty() {
        html.push_str("<p>Files that were left out:</p>\n<ul>\n");
        student.graded.notes.iter().for_each(|note| _ = writeln!(html, "<li>{}</li>", escaped(note)));
        html.push_str("</ul>\n");
    }
    if student.graded.problem.is_some() {
        html.push_str(FOOT);
        return html;
    }
    if student.variants.iter().any(|variant| !variant.checks.is_empty()) {
        rubric(&mut html, student);
    }
    let sheet = Sheet { cases: grader.cases(), results: view.results.iter().collect() };
    student.variants.iter().for_each(|variant| heat_map(&mut html, &sheet, variant));
    let failures: Vec<&CaseResult> =
        view.results.iter().filter(|result| result.row.outcome != RowOutcome::Passed).collect();
    if verdict != "passed" || !failures.is_empty() {
        details(&mut html, &failures, view);
    }
    html.push_str(FOOT);
    html
}

/// Calls of forbidden functions in all results together, in words; empty if there are none.
pub(super) fn forbidden_of(results: &[CaseResult]) -> String {
    let mut calls_by_robot: BTreeMap<u32, BTreeMap<String, u64>> = BTreeMap::new();
    for robot in results.iter().flat_map(|result| &result.row.robots) {
        for (name, count) in &robot.forbidden_calls {
            *calls_by_robot.entry(robot.id).or_default().entry(name.clone()).or_default() += count;
        }
    }
    let texts: Vec<String> =
        calls_by_robot.iter().map(|(id, calls)| format!("r{id} {}", forbidden_calls(calls))).collect();
    texts.join("; ")
}

/// Name of the suite without its folder and extension.
pub(super) fn title(grader: &Grader) -> String {
    let file = &grader.suite().spec.file;
    let name = file.rsplit('/').next().unwrap_or(file);
    name.strip_suffix(sim_format::suite::SUITE_EXTENSION).unwrap_or(name).to_owned()
}

/// Mean points of a check over the cases of a variant, and its maximum points.
pub(super) fn points_of_check(results: &[CaseResult], variant: &Variant, index: usize) -> (f64, f64) {
    let variant_results = || results.iter().filter(|result| result.row.variant == variant.name);
    let check = |result: &CaseResult| Some((result.row.points, result.row.checks.get(index)?.clone()));
    // A case in which a program failed has no points, even if checks are met.
    // The sum of no numbers is -0 in Rust.
    let points = variant_results()
        .filter_map(check)
        .filter(|(case_points, _)| *case_points > 0.0)
        .fold(0.0, |sum, (_, check)| sum + check.points);
    let max_points = variant_results().filter_map(check).map(|(_, check)| check.max_points).fold(0.0, f64::max);
    (points / variant_results().count().max(1) as f64, max_points)
}

fn rubric(html: &mut String, student: &Student) {
    html.push_str("<h2>Points</h2>\n<table class=\"list\">\n<tr><th>check</th><th class=\"number\">passed</th><th class=\"number\">points</th></tr>\n");
    let has_variants = student.variants.len() > 1;
    for variant in &student.variants {
        for (index, (name, rate)) in variant.checks.iter().enumerate() {
            let (points, max_points) = points_of_check(&student.graded.results, variant, index);
            let class = if rate.passed == rate.count { "passed" } else { "failed" };
            let suffix = if has_variants { format!(" ({})", variant.name) } else { String::new() };
            _ = writeln!(
                html,
                "<tr class=\"{class}\"><td>{}{}</td><td class=\"number\">{} of {} ({})</td><td class=\"number\">{} of {}</td></tr>",
                escaped(name),
                escaped(&suffix),
                rate.passed,
                rate.count,
                percent(rate.share()),
                number(points),
                number(max_points)
            );
        }
    }
    html.push_str("</table>\n<p>A case has no points if a program fails or a required check is not met.</p>\n");
}

fn details(html: &mut String, failures: &[&CaseResult], view: &View) {
    html.push_str("<h2>What failed</h2>\n");
    if !view.replays.is_empty() {
        let names: Vec<String> =
            view.replays.iter().map(|(name, _)| format!("<a href=\"{0}\">{0}</a>", escaped(name))).collect();
        _ = writeln!(
            html,
            "<p>Each command below shows a failure in the window, in the folder of {}.</p>",
            names.join(", ")
        );
    }
    // An error that all cases share, such as the compiler's, is shown once.
    let mut listed: Vec<&CaseResult> = Vec::new();
    for result in failures {
        let is_same = |other: &&CaseResult| {
            result.row.outcome == RowOutcome::Error
                && (&other.row.message, &other.row.details) == (&result.row.message, &result.row.details)
        };
        if !listed.iter().any(is_same) {
            listed.push(result);
        }
    }
    let repeated = failures.len() - listed.len();
    for (index, result) in listed.iter().take(MAX_DETAILED).enumerate() {
        let mut text = String::new();
        failure(&mut text, result);
        html.push_str(&if index == 0 { text.replacen("<details ", "<details open ", 1) } else { text });
    }
    if repeated > 0 {
        _ = writeln!(html, "<p>{repeated} more cases end with the same error.</p>");
    }
    if listed.len() > MAX_DETAILED {
        _ = writeln!(html, "<p>... and {} more.</p>", listed.len() - MAX_DETAILED);
    }
}
