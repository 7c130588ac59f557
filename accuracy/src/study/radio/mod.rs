//! `radio` and `radio-latency`: the channel compared with the formulas of its media, and the effect of the slot length.
//!
//! All messages go through the channel of `sim_core`, some of them also through stations, slot by slot. The study
//! measures the fraction of intact messages, the throughput, and the waiting time relative to its formula. The error is
//! the absolute difference from the formula. If measurement and formula differ only by chance, the mean error is a
//! quarter of the half width of the interval in the picture (0.8 of 3.29 standard errors). Sample sizes do not depend
//! on the effort, so pictures are always the same; only the number of repeated timings depends on it.

mod delivery;
mod latency;
mod medium;
mod stop_and_wait;

use sim_core::RobotId;
use sim_core::math::{exp, ln};
use sim_core::noise::{Purpose, RadioNoise, Stream};
use sim_core::radio::{Address, Channel, Medium, OutgoingMessage, RadioModel, StationInfo};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};
pub use latency::STUDY as LATENCY;

pub const STUDY: Study =
    Study { name: "radio", title: "Messages by radio: delivery, throughput and waiting against their formulas", run };

const SEED: u64 = 42;
const BAUD: u32 = 115_200;
/// Length of a RoBIOS 6 message in bytes.
const BYTES: usize = 35;
/// Number of standard deviations on either side that enclose 99.9 %.
const SIGMAS: f64 = 3.29;

fn run(effort: Effort) -> Outcome {
    let mut outcome = Outcome::default();
    for part in parts(effort) {
        outcome.figures.push(part.picture.figure());
        outcome.rows.extend(part.rows);
    }
    outcome
}

fn parts(effort: Effort) -> [Part; 5] {
    [
        delivery::measure(effort),
        stop_and_wait::against_loss(effort),
        stop_and_wait::against_bit_errors(effort),
        medium::aloha(effort),
        medium::token_ring(effort),
    ]
}

/// Result of one part of the study.
struct Part {
    rows: Vec<Row>,
    picture: Comparison,
}

/// Comparison with formulas. In its [`Figure`], formulas are lines, and measurements are dots with their intervals.
struct Comparison {
    name: &'static str,
    title: &'static str,
    /// Labels of x and y.
    labels: [&'static str; 2],
    x_scale: Scale,
    curves: Vec<(String, Vec<(f64, f64)>)>,
    points: Vec<Point>,
}

impl Comparison {
    fn figure(&self) -> Figure {
        let line =
            |(name, points): &(String, Vec<_>)| Series { name: name.clone(), mark: Mark::Line, points: points.clone() };
        let mut series: Vec<Series> = self.curves.iter().map(line).collect();
        let dots = self.points.iter().map(|point| (point.x, point.measured)).collect();
        series.push(Series { name: "measured".to_owned(), mark: Mark::Dots, points: dots });
        let bar = |point: &Point| {
            // NaN leaves a gap after each bar.
            [
                (point.x, point.measured - point.half_width),
                (point.x, point.measured + point.half_width),
                (f64::NAN, f64::NAN),
            ]
        };
        let bars = self.points.iter().flat_map(bar).collect();
        series.push(Series { name: "99.9 % interval".to_owned(), mark: Mark::Line, points: bars });
        let [x_label, y_label] = self.labels.map(str::to_owned);
        let (name, title) = (self.name.to_owned(), self.title.to_owned());
        Figure { name, title, x_label, y_label, x_scale: self.x_scale, y_scale: Scale::Linear, series }
    }
}

/// Measured value and the formula's prediction.
#[derive(Clone, Copy, Debug)]
struct Point {
    x: f64,
    measured: f64,
    /// Half width of the measured value's 99.9 % interval.
    half_width: f64,
    expected: f64,
}

fn row(method: &str, setting: String, point: &Point, time_ns: f64) -> Row {
    Row {
        study: STUDY.name,
        method: method.to_owned(),
        setting,
        error: (point.measured - point.expected).abs(),
        unit: "of 1",
        time_ns,
        per: "message",
    }
}

/// Channel with the stations of the robots 1 to `stations`, which are on and have the same noise.
fn channel(medium: Medium, noise: RadioNoise, stations: u32) -> Channel {
    let model = RadioModel { medium, baud: BAUD, ..RadioModel::default() };
    let mut channel = Channel::new(model, SEED, vec![noise; stations as usize]);
    for robot in 1..=stations {
        channel.set_member(RobotId(robot), Some(StationInfo { robot: RobotId(robot), address: robot, baud: BAUD }));
    }
    channel
}

fn sent_message(from: u32, sequence: u64, to: Address, payload: Vec<u8>, sent: Time) -> OutgoingMessage {
    let out_of_reach = Vec::new();
    OutgoingMessage {
        from: RobotId(from),
        address: from,
        sequence,
        to,
        payload,
        queued_at: sent,
        begins: None,
        baud: BAUD,
        out_of_reach,
    }
}

/// Formats `x` for a table, such as `0` or `0.3`; numbers below 0.01 are in scientific notation, such as `1e-4`.
fn format_number(x: f64) -> String {
    if x == 0.0 || x >= 0.01 { format!("{x}") } else { format!("{x:e}") }
}

/// 10 to the power of `x`.
fn ten_to(x: f64) -> f64 {
    exp(x * std::f64::consts::LN_10)
}

/// Stream of random numbers for one part of the study.
fn stream(part: u32, setting: u64) -> Stream {
    Stream::new(SEED, RobotId(part), Purpose::Program, 0, setting)
}

/// Random time between two events of a Poisson process, exponentially distributed with a mean of `mean` seconds.
fn interarrival_time(stream: &mut Stream, mean: f64) -> f64 {
    -ln(1.0 - stream.unit()) * mean
}

/// Mean of batch means, and half of its 99.9 % interval estimated from their spread.
fn mean_of(batches: &[f64]) -> (f64, f64) {
    let count = batches.len() as f64;
    let mean = batches.iter().sum::<f64>() / count;
    let variance = batches.iter().map(|batch| (batch - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, SIGMAS * (variance / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_match_the_formulas() {
        let mut count = 0;
        for Part { rows, picture } in parts(Effort::Quick) {
            let Comparison { name, points, .. } = &picture;
            assert!(rows.len() >= points.len(), "{name}");
            for Point { x, measured, half_width, expected } in points.iter().copied() {
                // With 100 points, one run in ten has a point outside its 99.9 % interval; hence the factor of 1.3.
                let distance = (measured - expected).abs();
                assert!(
                    distance <= 1.3 * half_width + 1e-9 * expected,
                    "{name} at {x}: {measured} +- {half_width}, not {expected}"
                );
                assert!(
                    half_width < 0.15 * expected.max(0.1),
                    "{name} at {x}: +- {half_width} of {expected} is too wide for a test"
                );
                count += 1;
            }
            let [.., dots, bars] = &picture.figure().series[..] else { panic!("{name}") };
            assert_eq!(3 * dots.points.len(), bars.points.len());
        }
        assert!(count > 80, "{count}");
    }
}
