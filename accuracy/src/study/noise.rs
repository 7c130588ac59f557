//! `noise`: convergence of random numbers to their distribution, and the cost of one number.
//!
//! The error is the Kolmogorov-Smirnov distance between the sample and its distribution. For numbers drawn from the
//! distribution the distance falls approximately as 0.87 / sqrt(n); if it stops falling, the numbers follow another
//! distribution. Normal numbers by the inverse distribution function, the simulator's method, are compared with normal
//! numbers by Box and Muller (1958) and with the sum of twelve uniform numbers, which is only approximately normal.

use std::f64::consts::PI;

use sim_core::RobotId;
use sim_core::math::{cos, ln};
use sim_core::noise::{EventStreams, Purpose, RangeErrors, RangeNoise, Stream};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};
use crate::statistics::{kolmogorov_distance, normal_cdf};

pub const STUDY: Study =
    Study { name: "noise", title: "Random numbers: distance from their distribution, and time per number", run };

/// Sample sizes; each sample begins with the previous one.
const COUNTS: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
const SEED: u64 = 42;

/// Names of the settings in the rows.
const SETTINGS: [&str; COUNTS.len()] = ["1e2 numbers", "1e3 numbers", "1e4 numbers", "1e5 numbers", "1e6 numbers"];

/// Method of drawing numbers: name, distribution, and a function that draws as many numbers as its argument states.
struct Method {
    name: &'static str,
    cdf: fn(f64) -> f64,
    draw: fn(usize) -> Vec<f64>,
}

const METHODS: [Method; 6] = [
    Method { name: "uniform", cdf: |x| x.clamp(0.0, 1.0), draw: |count| successive(1, count, Stream::unit) },
    Method { name: "normal by the quantile", cdf: normal_cdf, draw: |count| successive(2, count, Stream::normal) },
    Method { name: "normal, stream per event", cdf: normal_cdf, draw: first_of_events },
    Method { name: "reading of a sensor", cdf: |x| normal_cdf((x - DISTANCE) / SIGMA), draw: readings },
    Method { name: "normal of Box and Muller", cdf: normal_cdf, draw: |count| successive(3, count, box_muller) },
    Method { name: "sum of twelve uniform", cdf: normal_cdf, draw: |count| successive(4, count, sum_of_twelve) },
];

/// Distance of the target, m.
const DISTANCE: f64 = 2.0;
/// Standard deviation of the sensor's readings, m.
const SIGMA: f64 = 0.01;

fn run(effort: Effort) -> Outcome {
    let max_count = COUNTS[COUNTS.len() - 1];
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for Method { name, cdf, draw } in METHODS {
        let sample = draw(max_count);
        let time_ns = nanoseconds(effort.of(100), 10_000, || draw(10_000));
        let mut points = Vec::new();
        for (count, setting) in COUNTS.into_iter().zip(SETTINGS) {
            let error = kolmogorov_distance(&mut sample[..count].to_vec(), cdf);
            points.push((count as f64, error));
            rows.push(Row {
                study: STUDY.name,
                method: name.to_owned(),
                setting: setting.to_owned(),
                error,
                unit: "of probability",
                time_ns,
                per: "number",
            });
        }
        series.push(Series { name: name.to_owned(), mark: Mark::LineAndDots, points });
    }
    let bound = COUNTS.map(|count| (count as f64, 1.358 / (count as f64).sqrt()));
    series.push(Series { name: "exceeded by one in twenty".to_owned(), mark: Mark::Line, points: bound.to_vec() });
    let figure = Figure {
        name: "noise-distance".to_owned(),
        title: "Distance of a sample from its distribution".to_owned(),
        x_label: "numbers in the sample".to_owned(),
        y_label: "maximum difference of probability".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

fn streams() -> EventStreams {
    EventStreams::new(SEED, RobotId(1), Purpose::Range, "PSD_FRONT")
}

/// Successive numbers from the stream of one event.
fn successive(event: u64, count: usize, mut next: impl FnMut(&mut Stream) -> f64) -> Vec<f64> {
    let mut stream = streams().at(event);
    (0..count).map(|_| next(&mut stream)).collect()
}

/// First number of each of `count` events.
fn first_of_events(count: usize) -> Vec<f64> {
    let streams = streams();
    (0..count as u64).map(|index| streams.at(index).normal()).collect()
}

/// Readings of a PSD with Gaussian noise.
fn readings(count: usize) -> Vec<f64> {
    let errors = RangeErrors::new(RangeNoise { sigma: SIGMA, ..RangeNoise::default() }, SEED, RobotId(1), "PSD_FRONT");
    let read = |index| errors.reading(index, Time::ZERO, [0.0, 4.0], Some(DISTANCE));
    (0..count as u64).filter_map(read).collect()
}

/// One of the two normal numbers that the method of Box and Muller computes from two uniform numbers.
fn box_muller(stream: &mut Stream) -> f64 {
    let (radius, angle) = (1.0 - stream.unit(), stream.unit());
    (-2.0 * ln(radius)).sqrt() * cos(2.0 * PI * angle)
}

/// Number of mean 0 and variance 1 within [-6, 6].
fn sum_of_twelve(stream: &mut Stream) -> f64 {
    (0..12).map(|_| stream.unit()).sum::<f64>() - 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_methods_but_the_sum_of_twelve_follow_their_distribution() {
        let rows = run(Effort::Quick).rows;
        assert_eq!(rows.len(), METHODS.len() * COUNTS.len());
        let last =
            |method: &str| rows.iter().rfind(|row| row.method == method).unwrap_or_else(|| panic!("`{method}`")).error;
        for Method { name, .. } in &METHODS[..5] {
            // The distance exceeds 1.63 / sqrt(n) with probability 0.01.
            assert!(last(name) < 1.63e-3, "{name}: {}", last(name));
        }
        // The distribution of the sum differs from the normal one by 0.0023.
        assert!(last("sum of twelve uniform") > 1.8e-3);
    }
}
