//! Results of suites in JUnit format.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::suite::{CaseResult, RowOutcome};

/// Cases of a suite.
pub(in crate::cli) struct Cases<'r> {
    /// Name of the suite.
    pub suite: &'r str,
    /// Results of the cases that have run.
    pub results: Vec<&'r CaseResult>,
    /// Names of the selected cases that have not run.
    pub missing: Vec<&'r str>,
}

/// The JUnit document of these suites.
pub(in crate::cli) fn document<'r>(
    suites: impl Iterator<Item = Cases<'r>>,
    elapsed: Duration,
) -> anyhow::Result<String> {
    let mut report = Report::new("eyesim");
    report.set_time(elapsed);
    for Cases { suite: name, results, missing } in suites {
        let mut suite = TestSuite::new(name);
        suite.set_time(results.iter().map(|result| seconds(result.real_time_s)).sum());
        results.into_iter().for_each(|result| _ = suite.add_test_case(case(name, result)));
        for missing in missing {
            let mut status = TestCaseStatus::skipped();
            status.set_message("not run");
            let mut case = TestCase::new(missing, status);
            case.set_classname(name);
            suite.add_test_case(case);
        }
        report.add_test_suite(suite);
    }
    Ok(report.to_string()?)
}

fn case(suite: &str, result: &CaseResult) -> TestCase {
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
    case.set_classname(suite).set_time(seconds(result.real_time_s)).set_assertions(row.checks.len());
    if !result.output.is_empty() {
        case.set_system_out(result.output.join("\n"));
    }
    case
}

fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}
