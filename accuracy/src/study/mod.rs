//! Studies: each measures error and time of several methods for one task at several settings.
//!
//! Errors depend only on the code and the [`Effort`], and are the same in every run; times depend on the machine. The
//! caller makes tables, files and plots from the [`Outcome`]s.

mod camera;
mod camera_noise;
mod contact;
mod drive;
pub mod france;
mod imperfect_motion;
mod legs;
mod maps;
mod moving_target;
mod noise;
mod objects;
mod radio;
mod range_sensors;
mod rays2d;
mod rays3d;
mod reflectance;
mod shadow;
mod slide;
mod sonar;
mod stopwatch;

use serde::Serialize;

use crate::figure::Figure;

pub use stopwatch::nanoseconds;

/// Number of repetitions of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// As many repetitions as for the published figures.
    Full,
    /// The same settings with a tenth of the repetitions, but at least one.
    Quick,
}

impl Effort {
    /// Number of repetitions: `full`, or a tenth of it, at least 1.
    pub fn of(self, full: usize) -> usize {
        match self {
            Self::Full => full,
            Self::Quick => (full / 10).max(1),
        }
    }
}

/// Error and time of a method at one setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the study.
    pub study: &'static str,
    /// Method that was measured; the rows of one method are one curve in the plot.
    pub method: String,
    /// Setting, with its unit: `slot of 50 ms`.
    pub setting: String,
    /// Error, in `unit`; finite and not negative. It is the maximum over all cases, unless the study states otherwise.
    pub error: f64,
    /// Unit of the error.
    pub unit: &'static str,
    /// Wall-clock time of one operation, nanoseconds; `per` names the operation.
    pub time_ns: f64,
    /// Operation that was timed: `ray`.
    pub per: &'static str,
}

/// Result of a study.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Rows in the order of a table: method by method.
    pub rows: Vec<Row>,
    /// Plots in addition to the plot of error against time, which is made from the rows.
    pub figures: Vec<Figure>,
}

impl From<Vec<Row>> for Outcome {
    fn from(rows: Vec<Row>) -> Self {
        Self { rows, figures: Vec::new() }
    }
}

/// A study and the function that runs it.
#[derive(Clone, Copy)]
pub struct Study {
    /// Name of the study, in its rows and in the file name of its plot.
    pub name: &'static str,
    /// Subject of the measurement, in one line.
    pub title: &'static str,
    /// Runs the measurement.
    pub run: fn(Effort) -> Outcome,
}

/// All studies, in the order of the report.
#[rustfmt::skip]
pub const STUDIES: &[Study] = &[
    drive::DRIVE,
    drive::ODOMETRY,
    imperfect_motion::STUDY,
    contact::STUDY,
    slide::STUDY,
    objects::STUDY,
    objects::CONSERVED,
    legs::STUDY,
    rays2d::STUDY,
    rays3d::STUDY,
    range_sensors::STUDY,
    sonar::STUDY,
    reflectance::STUDY,
    moving_target::STUDY,
    noise::STUDY,
    radio::STUDY,
    radio::LATENCY,
    camera::STUDY,
    camera_noise::STUDY,
    shadow::STUDY,
    maps::STUDY,
];
