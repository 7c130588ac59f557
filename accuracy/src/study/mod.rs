//! Studies: the error and the time of one thing by several methods at several settings, measured on the spot.
//!
//! Errors are functions of the code alone, the same at every call; times are of this machine at this moment. Tables, files
//! and pictures are made of the [`Outcome`]s by whoever asked for them.

mod camera;
mod contact;
mod drive;
mod figure;
pub mod france;
mod moving_target;
mod noise;
mod radio;
mod range_sensors;
mod rays2d;
mod rays3d;
mod reflectance;
mod sonar;
mod stopwatch;

use serde::Serialize;

pub use figure::{Figure, Mark, Scale, Series};
pub use stopwatch::nanoseconds;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What the published figures are made of.
    Full,
    /// A tenth of it or less: the same settings, fewer repetitions.
    Quick,
}

impl Effort {
    /// `full` repetitions, or a tenth of them, at least 1.
    pub fn of(self, full: usize) -> usize {
        match self {
            Self::Full => full,
            Self::Quick => (full / 10).max(1),
        }
    }
}

/// A method at a setting: how far off it is, and how long it takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the study.
    pub study: &'static str,
    /// What was measured; the rows of one method are a line in the plot.
    pub method: String,
    /// At which setting, with its unit: `slot of 50 ms`.
    pub setting: String,
    /// Distance from the truth, in `unit`; finite and not negative. What is taken over many cases is the greatest, where
    /// the study does not say otherwise.
    pub error: f64,
    /// Unit of the error.
    pub unit: &'static str,
    /// Real time of one `per`, nanoseconds.
    pub time_ns: f64,
    /// What the time is the time of: `ray`.
    pub per: &'static str,
}

/// What a study has found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// In the order in which a table shows them: method by method.
    pub rows: Vec<Row>,
    /// Pictures besides the plot of error against time, which is made of the rows.
    pub figures: Vec<Figure>,
}

impl From<Vec<Row>> for Outcome {
    fn from(rows: Vec<Row>) -> Self {
        Self { rows, figures: Vec::new() }
    }
}

/// Something that is measured.
#[derive(Clone, Copy)]
pub struct Study {
    /// Its name: of its rows, and of its picture's file.
    pub name: &'static str,
    /// What is measured, in a line.
    pub title: &'static str,
    /// Measures it.
    pub run: fn(Effort) -> Outcome,
}

/// All studies, in the order of the report.
#[rustfmt::skip]
pub const STUDIES: &[Study] = &[
    drive::DRIVE,
    drive::ODOMETRY,
    contact::STUDY,
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
];
