//! Verdicts on the checks of a scene. [`sim_core::check`] judges checks on motion, and a [`Tally`] judges checks on
//! events; the report and the user's programs decide all others.

mod metric;
mod prints;
pub mod script;
mod tally;
mod wording;

use sim_core::RobotId;
use sim_core::check::{Finding, Monitor};
use sim_core::record::Outcome;
use sim_core::spec::{CheckKind, CheckSpec, ExpectedOutput, ProgramOutput};
use sim_core::time::Time;

use crate::record::Report;
use crate::record::report::{CheckReport, RobotReport};
pub use script::Evidence;
use tally::Count;
pub use tally::Tally;

/// Result of one check, and the parts of its message.
struct Verdict {
    is_met: bool,
    /// Fraction of the points, 0 to 1.
    fraction: f64,
    /// Instant of the deciding event, s.
    at: Option<f64>,
    /// Point of this event, m.
    position: Option<[f64; 2]>,
    /// The value that was judged.
    value: Option<f64>,
    message: String,
}

impl Verdict {
    fn new(is_met: bool, message: String) -> Self {
        Self { is_met, fraction: if is_met { 1.0 } else { 0.0 }, at: None, position: None, value: None, message }
    }
}

/// Results of all checks of a scene, in the scene's order; all get 0 points if a required check is not met. `findings`
/// are the findings on motion, `tally` contains the counts of events, `report` describes the run, and `evidence` is the
/// data that the programs of checks may read.
pub fn results(
    checks: &[CheckSpec],
    findings: impl Iterator<Item = (usize, Finding)>,
    tally: Option<&Tally>,
    report: &Report,
    evidence: Option<Evidence<'_>>,
) -> Vec<CheckReport> {
    if checks.is_empty() {
        return Vec::new();
    }
    let mut motion_findings: Vec<Option<Finding>> = vec![None; checks.len()];
    findings.for_each(|(index, finding)| motion_findings[index] = Some(finding));
    let mut json = serde_json::to_value(report).unwrap_or_default();
    if let Some(fields) = json.as_object_mut() {
        // Results of checks are not known yet.
        fields.retain(|name, _| !["checks", "points", "max_points"].contains(&name.as_str()));
    }
    let script_verdict = |check: &CheckSpec| {
        let mut json = json.clone();
        if let Some(fields) = json.as_object_mut() {
            // A verdict must not depend on the command line or on wall-clock time.
            fields.retain(|name, _| !["argv", "real_time_s"].contains(&name.as_str()));
        }
        script::judge(&check.kind, check.points, &json, evidence)
    };
    let result = |(index, check): (usize, &CheckSpec)| {
        let mut is_broken = false;
        let verdict = match (&motion_findings[index], &check.kind) {
            (Some(finding), kind) => verdict_of_finding(kind, finding),
            (None, CheckKind::Script { .. }) => script_verdict(check).unwrap_or_else(|message| {
                is_broken = true;
                Verdict::new(false, message)
            }),
            (None, CheckKind::Metric { path, min, max, full, zero }) => {
                metric::judge(&json, path, [*min, *max], full.zip(*zero))
            }
            (None, CheckKind::Outcome { robot, outcome }) => judge_outcome(report, *robot, *outcome),
            (None, CheckKind::Prints { robot, output: ProgramOutput::Display, expected }) => {
                judge_display(report, *robot, expected)
            }
            (None, kind) => verdict_of_count(kind, tally.and_then(|tally| tally.count(index))),
        };
        CheckReport {
            name: check.title().to_owned(),
            kind: check.kind.word().to_owned(),
            passed: verdict.is_met,
            broken: is_broken,
            points: verdict.fraction * check.points,
            max_points: check.points,
            at_s: verdict.at,
            x_m: verdict.position.map(|point| point[0]),
            y_m: verdict.position.map(|point| point[1]),
            value: verdict.value,
            series: None,
            message: verdict.message,
        }
    };
    let mut results: Vec<CheckReport> = checks.iter().enumerate().map(result).collect();
    let mut is_required_check_missed = false;
    for (check, result) in checks.iter().zip(&mut results).filter(|(check, result)| check.is_required && !result.passed)
    {
        is_required_check_missed = true;
        let name = check.title();
        result.message = format!("{}; without `{name}` there are no points at all", result.message);
    }
    if is_required_check_missed {
        results.iter_mut().for_each(|result| result.points = 0.0);
    }
    results
}

/// Verdict of a check during a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The rest of the run may still decide the check.
    Open,
    /// The check is met, and no later event can change this.
    Met,
    /// The check can no longer be met.
    Failed,
}

/// State of a check during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// The verdict so far.
    pub progress: Progress,
    /// Message for the user.
    pub message: String,
    /// Current value of a swarm metric.
    pub value: Option<f64>,
}

/// State of all checks of a scene at `now`, in the scene's order, from the findings and events so far.
pub fn standings(checks: &[CheckSpec], monitor: Option<&Monitor>, tally: Option<&Tally>, now: Time) -> Vec<Standing> {
    let mut findings: Vec<Option<Finding>> = vec![None; checks.len()];
    monitor.into_iter().flat_map(Monitor::findings).for_each(|(index, finding)| findings[index] = Some(finding));
    let mut values: Vec<Option<f64>> = vec![None; checks.len()];
    for (index, series) in monitor.into_iter().flat_map(Monitor::series) {
        values[index] = Some(series.last().map_or(0.0, |[_, value]| *value));
    }
    let standing = |(index, check): (usize, &CheckSpec)| {
        let count = tally.and_then(|tally| tally.count(index));
        let (progress, message) = match (&findings[index], count) {
            (Some(finding), _) => {
                let is_violated = !finding.is_met && finding.at.is_some();
                let message = wording::of_finding(&check.kind, finding).replace("at the end", "now");
                (progress(&check.kind, finding.is_met, is_violated, now), message)
            }
            (None, Some(count)) => {
                let is_met = count.is_met(&check.kind);
                let is_violated = !is_met && count.is_too_many(&check.kind);
                (progress(&check.kind, is_met, is_violated, now), wording::of_count(&check.kind, count))
            }
            (None, None) => (Progress::Open, "judged at the end of the run".to_owned()),
        };
        Standing { progress, message, value: values[index] }
    };
    checks.iter().enumerate().map(standing).collect()
}

/// Returns true if a check of this kind stays met once it is met.
fn stays_met(kind: &CheckKind) -> bool {
    match kind {
        CheckKind::Reach { .. }
        | CheckKind::Visits { .. }
        | CheckKind::Laps { .. }
        | CheckKind::Coverage { .. }
        | CheckKind::Prints { output: ProgramOutput::Stdout, .. } => true,
        CheckKind::Event { count, .. } | CheckKind::Calls { count, .. } | CheckKind::Message { count, .. } => {
            count.max.is_none()
        }
        _ => false,
    }
}

/// Returns true if a check of this kind stays violated once it is violated.
fn stays_violated(kind: &CheckKind) -> bool {
    match kind {
        CheckKind::StaysIn { .. }
        | CheckKind::Clearance { .. }
        | CheckKind::Contacts { .. }
        | CheckKind::Event { .. }
        | CheckKind::Calls { .. }
        | CheckKind::Message { .. } => true,
        CheckKind::OdometryError { at_end, .. } | CheckKind::Swarm { at_end, .. } => !at_end,
        _ => false,
    }
}

fn progress(kind: &CheckKind, is_met: bool, is_violated: bool, now: Time) -> Progress {
    let by = match kind {
        CheckKind::Reach { by, .. }
        | CheckKind::Visits { by, .. }
        | CheckKind::Laps { by, .. }
        | CheckKind::Coverage { by, .. } => *by,
        CheckKind::Event { by, count, .. } => by.filter(|_| count.min > 0),
        _ => None,
    };
    match is_met {
        true if stays_met(kind) => Progress::Met,
        false if is_violated && stays_violated(kind) || by.is_some_and(|by| now > by) => Progress::Failed,
        _ => Progress::Open,
    }
}

fn verdict_of_finding(kind: &CheckKind, finding: &Finding) -> Verdict {
    let Finding { is_met, at, position, value } = *finding;
    let position = position.map(|point| point.to_array());
    let message = wording::of_finding(kind, finding);
    Verdict { at, position, value: value.filter(|value| value.is_finite()), ..Verdict::new(is_met, message) }
}

fn verdict_of_count(kind: &CheckKind, count: Option<&Count>) -> Verdict {
    let Some(count) = count else {
        return Verdict::new(false, "it was not evaluated".to_owned());
    };
    let is_met = count.is_met(kind);
    let message = wording::of_count(kind, count);
    let (at, position) = (count.at, count.position);
    Verdict { at, position, value: Some(count.number as f64), ..Verdict::new(is_met, message) }
}

fn judge_outcome(report: &Report, robot: Option<RobotId>, expected: Outcome) -> Verdict {
    let is_concerned = |other: &&RobotReport| match robot {
        Some(id) => other.id == id.0,
        None => other.outcome != Outcome::NoProgram,
    };
    let concerned: Vec<&RobotReport> = report.robots.iter().filter(is_concerned).collect();
    let deviating = concerned.iter().find(|robot| robot.outcome != expected);
    match deviating {
        _ if concerned.is_empty() => Verdict::new(false, "no robot has a program".to_owned()),
        None => Verdict::new(true, wording::spaced(expected.name())),
        Some(robot) => {
            let reason = robot.reason.as_ref().map(|reason| format!(": {reason}")).unwrap_or_default();
            let (found, wanted) = (wording::spaced(robot.outcome.name()), wording::spaced(expected.name()));
            let at = Some(robot.virtual_time_s);
            Verdict { at, ..Verdict::new(false, format!("r{} is `{found}`, not `{wanted}`{reason}", robot.id)) }
        }
    }
}

fn judge_display(report: &Report, robot: RobotId, expected: &ExpectedOutput) -> Verdict {
    let mut search = prints::Search::new(expected);
    let lines = report.robots.iter().find(|other| other.id == robot.0).map_or(&[][..], |other| &other.lcd);
    lines.iter().for_each(|line| _ = search.take(line));
    Verdict::new(search.is_found(), search.explain(robot, "shows"))
}

#[cfg(test)]
mod tests;
