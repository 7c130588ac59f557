//! Results of a submission in Gradescope's format.
//!
//! Source: the specification of Gradescope's autograders, gradescope-autograders.readthedocs.io/en/latest/specs.

use std::fmt::Write as _;

use serde_json::{Value, json};
use sim_host::record::log::is_terminal_control;

use super::Student;
use super::student::{View, forbidden_of, points_of_check};
use crate::suite::{CaseResult, RowOutcome};

/// Maximum number of failures of a test that are listed.
const MAX_FAILURES: usize = 20;

/// The document `results.json`: a test for each check of each variant.
pub(super) fn document(student: &Student, view: &View) -> anyhow::Result<Vec<u8>> {
    let mut tests: Vec<Value> = Vec::new();
    let has_variants = student.variants.len() > 1;
    for variant in &student.variants {
        let suffix = if has_variants { format!(" ({})", variant.name) } else { String::new() };
        let results = || view.results.iter().filter(|result| result.row.variant == variant.name);
        if variant.checks.is_empty() {
            let text = student.graded.problem.clone().unwrap_or_else(|| failures(results(), None));
            tests.push(test(&format!("build and run{suffix}"), (0.0, variant.max_points), variant.passed, &text));
        }
        for (index, (name, rate)) in variant.checks.iter().enumerate() {
            let points = points_of_check(&student.graded.results, variant, index);
            let mut text = format!("met in {} of {} cases\n", rate.passed, rate.count);
            text.push_str(&failures(results(), Some(index)));
            tests.push(test(&format!("{name}{suffix}"), points, rate.passed == rate.count, &text));
        }
    }
    let mut output = format!("{} of {} cases passed\n", student.passed(), student.graded.results.len());
    student.graded.problem.iter().for_each(|problem| _ = writeln!(output, "{problem}"));
    let forbidden = forbidden_of(&view.results);
    if !forbidden.is_empty() {
        _ = writeln!(output, "forbidden functions called, in all cases together: {forbidden}");
    }
    student.graded.notes.iter().for_each(|note| _ = writeln!(output, "{note}"));
    let document = json!({
        "score": rounded(student.points()),
        "execution_time": student.graded.real_time_s.ceil() as u64,
        "output": escaped(&output),
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": { "eyesim_version": env!("CARGO_PKG_VERSION"), "max_score": rounded(student.max_points()) },
        "tests": tests,
    });
    let mut bytes = serde_json::to_vec_pretty(&document)?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn test(name: &str, (points, max_points): (f64, f64), passed: bool, output: &str) -> Value {
    json!({
        "name": escaped(name),
        "score": rounded(points),
        "max_score": rounded(max_points),
        "status": if passed { "passed" } else { "failed" },
        "output": escaped(output),
        "visibility": "visible",
    })
}

/// Reasons why cases fail a check; without a check, reasons why cases fail.
fn failures<'r>(results: impl Iterator<Item = &'r CaseResult>, check: Option<usize>) -> String {
    let mut listed: Vec<(String, String)> = Vec::new();
    for result in results.filter(|result| result.row.outcome != RowOutcome::Passed) {
        let row = &result.row;
        let check_report = check.and_then(|index| row.checks.get(index));
        let is_explained = !result.has_failed_program() && row.checks.iter().any(|check| !check.passed);
        let message = match check_report {
            Some(check) if !check.passed => check.message.clone(),
            Some(check) if row.points > 0.0 || check.max_points == 0.0 && is_explained => continue,
            // A program failed, a limit was exceeded, a required check is not met, or the case could not be run.
            _ if row.details.is_empty() => row.message.clone(),
            _ => format!("{}\n{}", row.message, row.details),
        };
        if !listed.iter().any(|(_, other)| *other == message) {
            listed.push((row.case.clone(), message));
        }
    }
    let mut text = String::new();
    for (case, message) in listed.iter().take(MAX_FAILURES) {
        _ = writeln!(text, "{case}: {message}");
    }
    if listed.len() > MAX_FAILURES {
        _ = writeln!(text, "... and {} more", listed.len() - MAX_FAILURES);
    }
    text
}

/// Rounds points to remove floating-point noise.
fn rounded(points: f64) -> f64 {
    (points * 1e4).round() / 1e4
}

/// Escapes characters that control terminals or reorder words.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if is_terminal_control(c) && c != '\n' && c != '\t' {
            escaped.extend(c.escape_default())
        } else {
            escaped.push(c)
        }
    }
    escaped
}
