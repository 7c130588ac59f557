//! Results of suites in the form of JUnit.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::SuiteRun;
use crate::suite::{CaseResult, RowOutcome};

/// The document of all suites.
pub(super) fn document(runs: &[SuiteRun], elapsed: Duration) -> anyhow::Result<String> {
    let mut report = Report::new("eyesim");
    report.set_time(elapsed);
    for run in runs.iter().filter(|run| !run.results.is_empty()) {
        let mut suite = TestSuite::new(run.name());
        suite.set_time(run.results.values().map(|result| seconds(result.real_time_s)).sum());
        run.results.values().for_each(|result| _ = suite.add_test_case(case(run, result)));
        for index in run.selected.iter().filter(|index| !run.results.contains_key(index)) {
            let mut status = TestCaseStatus::skipped();
            status.set_message("not run");
            let mut case = TestCase::new(run.cases[*index].name.as_str(), status);
            case.set_classname(run.name());
            suite.add_test_case(case);
        }
        report.add_test_suite(suite);
    }
    Ok(report.to_string()?)
}

fn case(run: &SuiteRun, result: &CaseResult) -> TestCase {
    let row = &result.row;
    let failure = |kind, name: &str| {
        let mut status = TestCaseStatus::non_success(kind);
        let checks = row.checks.iter().filter(|check| !check.passed);
        let mut lines: Vec<String> = checks.map(|check| format!("{}: {}", check.name, check.message)).collect();
        lines.extend(Some(row.details.clone()).filter(|details| !details.is_empty()));
        lines.extend(row.view_command().map(|command| format!("to see it: {command}")));
        status.set_message(row.message.as_str()).set_type(name).set_description(lines.join("\n"));
        status
    };
    let status = match row.outcome {
        RowOutcome::Passed => TestCaseStatus::success(),
        RowOutcome::Failed => failure(NonSuccessKind::Failure, "failed"),
        RowOutcome::Error => failure(NonSuccessKind::Error, "error"),
        RowOutcome::Interrupted => TestCaseStatus::skipped(),
    };
    let mut case = TestCase::new(row.case.as_str(), status);
    case.set_classname(run.name()).set_time(seconds(result.real_time_s)).set_assertions(row.checks.len());
    if !result.output.is_empty() {
        case.set_system_out(result.output.join("\n"));
    }
    case
}

fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}
