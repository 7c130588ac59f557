//! Rows: the result of a case in the schema that tests, sweeps and graders share.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use sim_core::record::Outcome;
use sim_host::record::report::CheckReport;

/// Version of the schema of rows.
pub const ROW_SCHEMA: u32 = 1;

/// Result of a case. It depends only on the case and its inputs, not on the machine, on other cases or on time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// [`ROW_SCHEMA`].
    pub schema: u32,
    /// Hash of the case, its inputs, its limits and the version of eyesim, as 32 hexadecimal digits; empty if the case
    /// could not be built.
    pub key: String,
    /// Path of the suite.
    pub suite: String,
    /// Name of the case: its settings, as `noise=real,seed=3`.
    pub case: String,
    /// Name without the seed: cases of one variant differ only in their seeds.
    pub variant: String,
    /// Path of the scene.
    pub scene: String,
    /// Seed of the run.
    pub seed: u64,
    /// Settings of the matrix, in its order.
    pub settings: Vec<(String, String)>,
    /// The verdict.
    pub outcome: RowOutcome,
    /// Reason of a failure or an error, one line; empty for a case that passed.
    pub message: String,
    /// Details of an error, such as the output of the compiler; empty if there are none.
    pub details: String,
    /// Instant that decided a failure, s.
    pub at_s: Option<f64>,
    /// x coordinate of the failure, m.
    pub x_m: Option<f64>,
    /// y coordinate of the failure, m.
    pub y_m: Option<f64>,
    /// Points of all checks together; 0 if a program failed.
    pub points: f64,
    /// Points of a case that passes.
    pub max_points: f64,
    /// Results of the checks, the scene's first.
    pub checks: Vec<CheckReport>,
    /// Ends of the programs.
    pub robots: Vec<RowRobot>,
    /// Simulated time at the end, s.
    pub sim_time_s: f64,
    /// Digest of the run; none if it did not start, or its end depended on the machine.
    pub digest: Option<String>,
    /// Arguments of `eyesim run` or `eyesim view` that repeat the case.
    pub words: Vec<String>,
}

/// Verdict on a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowOutcome {
    /// All checks are met, and no program failed.
    Passed,
    /// A check is not met, or a program failed.
    Failed,
    /// The case could not be run.
    Error,
    /// The user interrupted the case.
    Interrupted,
}

impl RowOutcome {
    /// Name of the outcome in rows.
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Error => "error",
            Self::Interrupted => "interrupted",
        }
    }
}

/// End of a robot's program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowRobot {
    /// Its number.
    pub id: u32,
    /// Its program.
    pub program: String,
    /// State of the program.
    pub outcome: Outcome,
    /// Reason in words, if there is one.
    pub reason: Option<String>,
    /// Last values of the metrics that its program printed, by name: for tables and plots, not for grades.
    pub metrics: BTreeMap<String, f64>,
    /// Number of calls of each forbidden function, by the name of the function.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub forbidden_calls: BTreeMap<String, u64>,
}

/// Path of a robot, m: polylines accurate to a few millimetres.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// Number of the robot.
    pub robot: u32,
    /// Lines: one from the start, and one from each pose at which it was placed.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// A row, with data that serve only its presentation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// The row.
    pub row: Row,
    /// Wall-clock time that the case took, s.
    pub real_time_s: f64,
    /// Paths of the robots of a case that did not pass.
    pub traces: Vec<Trace>,
    /// Last lines that its programs printed, for a case that did not pass.
    pub output: Vec<String>,
}

impl CaseResult {
    /// Returns true if the case did not run to its end, or a program failed.
    pub fn has_failed_program(&self) -> bool {
        self.row.outcome == RowOutcome::Error || self.row.robots.iter().any(|robot| robot.outcome.is_failure())
    }
}

impl Row {
    /// The command that shows in the window what led to the failure.
    pub fn view_command(&self) -> Option<String> {
        if self.words.is_empty() {
            return None;
        }
        let words: Vec<String> = self.words.iter().map(|word| sim_host::program::words::quoted(word)).collect();
        let option =
            self.at_s.map(|failure_time| format!(" --at {:.1}", (failure_time - 1.0).max(0.0))).unwrap_or_default();
        Some(format!("eyesim view {}{option}", words.join(" ")))
    }
}
