//! `range-sensors`: readings of the three sensors of France et al. (1999) on one walk over a floor towards a step.

use super::france::{Sample, WALK, walk};
use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};

pub const STUDY: Study = Study {
    name: "range-sensors",
    title: "Laser, ultrasonic and reflectance sensor on a walking leg, above a floor and a step",
    run,
};

/// Interval between samples, s.
const PERIOD: f64 = 0.02;

fn run(effort: Effort) -> Outcome {
    let mut samples = Vec::new();
    let count = (WALK / PERIOD) as usize;
    // Three readings and one exact ray per sample.
    let time_ns = nanoseconds(effort.of(20), 4 * count, || samples = walk(PERIOD));
    let mut rows = Vec::new();
    let mut series = vec![curve("exact distance", &samples, |sample| sample.exact)];
    for (method, read, max) in SENSORS {
        for (ground, on_step) in [("floor", false), ("step", true)] {
            let samples_there: Vec<&Sample> = samples.iter().filter(|sample| sample.is_on_step == on_step).collect();
            let with_echo: Vec<&&Sample> = samples_there.iter().filter(|sample| read(sample) < max).collect();
            let absolute_error = |sample: &&&Sample| (read(sample) - sample.exact).abs();
            rows.push(Row {
                study: STUDY.name,
                method: method.to_owned(),
                setting: format!("{ground}: an echo in {} of {} samples", with_echo.len(), samples_there.len()),
                error: with_echo.iter().map(absolute_error).fold(0.0, f64::max),
                unit: "m",
                time_ns,
                per: "reading",
            });
        }
        series.push(curve(method, &samples, read));
    }
    let figure = Figure {
        name: "range-sensors-walk".to_owned(),
        title: "Readings of the sensors on the walk".to_owned(),
        x_label: "time, s".to_owned(),
        y_label: "distance, m".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

type Read = fn(&Sample) -> f64;

/// Name, reading, and reading without an echo (m) of each sensor.
const SENSORS: [(&str, Read, f64); 3] = [
    ("laser", |sample| sample.laser, 2.0),
    ("ultrasonic", |sample| sample.ultrasonic, 1.0),
    ("reflectance", |sample| sample.reflectance, 1.0),
];

fn curve(name: &str, samples: &[Sample], read: Read) -> Series {
    let points = samples.iter().map(|sample| (sample.seconds, read(sample))).collect();
    Series { name: name.to_owned(), mark: Mark::Line, points }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ultrasonic_detects_only_the_step_and_reflectance_reads_too_far() {
        let rows = run(Effort::Quick).rows;
        let row = |method: &str, ground: &str| {
            let matches_row = |row: &&Row| row.method == method && row.setting.starts_with(ground);
            rows.iter().find(matches_row).unwrap_or_else(|| panic!("{method} on the {ground}"))
        };
        assert!(row("ultrasonic", "floor").setting.contains("in 0 of"));
        assert!(!row("ultrasonic", "step").setting.contains("in 0 of"));
        for (ground, bias) in [("floor", 0.1), ("step", 0.005)] {
            assert_eq!((row("laser", ground).error, row("ultrasonic", ground).error), (0.0, 0.0), "without noise");
            assert!(row("reflectance", ground).error > bias, "the step is met nearly head on");
        }
    }
}
