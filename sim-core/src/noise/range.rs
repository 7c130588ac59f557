//! Noise models of distance sensors and laser scanners.

use super::{EventStreams, Purpose, Stream};
use crate::RobotId;
use crate::math;
use crate::time::Time;

/// Noise model of a distance sensor. The default has no errors.
///
/// The errors are applied in this order to a distance d (or no return) at the time t since the start of the run:
///
/// 1. with probability `dropout` the reading is no return;
/// 2. otherwise, with probability `outlier`, the reading is uniform over the sensor's range, even if there was no
///    return;
/// 3. otherwise no return stays no return, and a distance becomes d + `bias` + B + `drift` exp(-t / `drift_time`) + s
///    G. Here s is the [standard deviation](Self::sigma_at) at d, G is standard normal for each reading, and B is
///    normal with the standard deviation `bias_sigma`, drawn once for each sensor;
/// 4. a distance is rounded to a multiple of `step`, then clamped to the sensor's range.
///
/// Source: additive Gaussian noise from Koestler & Bräunl, section 5; the rest is our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeNoise {
    /// Standard deviation of each reading, m.
    pub sigma: f64,
    /// Standard deviation of each reading as a fraction of the distance.
    pub sigma_share: f64,
    /// Coefficient k of a standard deviation k d^2 of each reading, 1/m. It models a sensor with constant noise on a
    /// signal proportional to 1/d.
    pub sigma_per_m: f64,
    /// Error of all readings of all sensors, m.
    pub bias: f64,
    /// Standard deviation of B, the constant error that differs between sensors, m.
    pub bias_sigma: f64,
    /// Step to which readings are rounded, m; 0: not rounded.
    pub step: f64,
    /// Probability of a reading that is independent of the distance.
    pub outlier: f64,
    /// Probability of a reading without return.
    pub dropout: f64,
    /// Error at the start of the run, m, which decays exponentially.
    pub drift: f64,
    /// Time constant of the decay, s; positive.
    pub drift_time: f64,
    /// Factor on the noise N of the sensor model (France et al.); 0 for no such noise. [`RangeErrors::device_noise`]
    /// applies it, [`RangeErrors::reading`] does not.
    pub device: f64,
}

impl Default for RangeNoise {
    fn default() -> Self {
        Self {
            sigma: 0.0,
            sigma_share: 0.0,
            sigma_per_m: 0.0,
            bias: 0.0,
            bias_sigma: 0.0,
            step: 0.0,
            outlier: 0.0,
            dropout: 0.0,
            drift: 0.0,
            drift_time: 60.0,
            device: 0.0,
        }
    }
}

impl RangeNoise {
    /// Standard deviation s of a reading at a distance d, in metres:
    /// s^2 = `sigma`^2 + (`sigma_share` d)^2 + (`sigma_per_m` d^2)^2.
    pub fn sigma_at(&self, distance: f64) -> f64 {
        math::hypot(math::hypot(self.sigma, self.sigma_share * distance), self.sigma_per_m * distance * distance)
    }
}

/// The errors of one distance sensor or laser scanner.
#[derive(Clone, Debug)]
pub struct RangeErrors {
    model: RangeNoise,
    reading_streams: EventStreams,
    device_streams: EventStreams,
    /// Constant error of this sensor, m.
    offset: f64,
    has_exact_readings: bool,
}

impl RangeErrors {
    /// The errors of the sensor called `device` on `robot`, in a run with `seed`.
    pub fn new(model: RangeNoise, seed: u64, robot: RobotId, device: &str) -> Self {
        let deviate = || EventStreams::new(seed, robot, Purpose::DeviceConstant, device).at(0).normal();
        Self {
            model,
            reading_streams: EventStreams::new(seed, robot, Purpose::Range, device),
            device_streams: EventStreams::new(seed, robot, Purpose::Signal, device),
            offset: model.bias + if model.bias_sigma == 0.0 { 0.0 } else { model.bias_sigma * deviate() },
            has_exact_readings: RangeNoise { drift_time: 0.0, device: 0.0, ..model }
                == RangeNoise { drift_time: 0.0, ..RangeNoise::default() },
        }
    }

    /// Noise N = `sigma` G + `mean` of the sensor model for the reading with this [index](EventStreams::index), times
    /// the factor [`RangeNoise::device`]; G is standard normal. Source: France et al. (1999), section 4.3.
    pub fn device_noise(&self, index: u64, sigma: f64, mean: f64) -> f64 {
        if self.model.device == 0.0 {
            return 0.0;
        }
        self.model.device * (sigma * self.device_streams.at(index).normal() + mean)
    }

    /// Returns true if [`RangeErrors::reading`] adds no errors; [`RangeErrors::device_noise`] may add some.
    pub fn has_exact_readings(&self) -> bool {
        self.has_exact_readings
    }

    /// Reading of the sensor at the time `at` for the true distance `exact`, in metres; `None` means no return. The
    /// reading lies within `range`, or equals `exact` if the model has no errors.
    ///
    /// The reading depends only on the arguments; `index` is the [index](EventStreams::index) of the reading.
    pub fn reading(&self, index: u64, at: Time, range: [f64; 2], exact: Option<f64>) -> Option<f64> {
        self.scan(index, at, range).point(exact)
    }

    /// Errors of the scan with this index. The points of the scan are read in order; each has an independent error, and
    /// all have the sensor's constant error and its drift.
    pub fn scan(&self, index: u64, at: Time, range: [f64; 2]) -> ScanErrors<'_> {
        let stream_and_offset = (!self.has_exact_readings).then(|| {
            let drift = self.model.drift;
            let present_drift =
                if drift == 0.0 { 0.0 } else { drift * math::exp(-at.seconds() / self.model.drift_time) };
            (self.reading_streams.at(index), self.offset + present_drift)
        });
        ScanErrors { model: &self.model, range, stream_and_offset }
    }
}

/// The errors of one scan.
#[derive(Clone, Debug)]
pub struct ScanErrors<'a> {
    model: &'a RangeNoise,
    range: [f64; 2],
    /// Random stream, and the error that all points have in common, m; `None` if all readings are exact.
    stream_and_offset: Option<(Stream, f64)>,
}

impl ScanErrors<'_> {
    /// Reading of the next point for the true distance `exact`.
    pub fn point(&mut self, exact: Option<f64>) -> Option<f64> {
        let Some((stream, offset)) = &mut self.stream_and_offset else { return exact };
        // All four numbers are always drawn, so that a changed probability does not change later numbers.
        let (dropout_draw, outlier_draw, outlier_position, normal) =
            (stream.unit(), stream.unit(), stream.unit(), stream.normal());
        let (model, [low, high]) = (self.model, self.range);
        let distance = if dropout_draw < model.dropout {
            return None;
        } else if outlier_draw < model.outlier {
            low + (high - low) * outlier_position
        } else {
            let exact = exact?;
            exact + *offset + model.sigma_at(exact) * normal
        };
        Some(quantised(distance, model.step).max(low).min(high))
    }
}

/// The multiple of `step` nearest to `value`; `value` itself if `step` is 0.
pub(super) fn quantised(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: [f64; 2] = [0.05, 4.0];

    fn errors(model: RangeNoise) -> RangeErrors {
        RangeErrors::new(model, 7, RobotId(2), "PSD_FRONT")
    }

    fn readings(model: RangeNoise, exact: Option<f64>) -> impl Iterator<Item = Option<f64>> {
        let errors = errors(model);
        (0..10_000).map(move |index| errors.reading(index, Time::ZERO, LIMITS, exact))
    }

    #[test]
    fn default_noise_gives_exact_readings() {
        for exact in [None, Some(0.0), Some(1.234_567_890_123), Some(100.0)] {
            let model = RangeNoise { drift_time: 3.0, device: 1.0, ..RangeNoise::default() };
            assert!(readings(model, exact).all(|reading| reading == exact), "even out of range");
        }
        assert_eq!(errors(RangeNoise::default()).device_noise(3, 0.01, 0.5), 0.0);
    }

    #[test]
    fn no_return_stays_no_return_except_for_outliers() {
        let model = RangeNoise { sigma: 0.1, sigma_share: 0.1, bias: -1.0, step: 0.1, ..RangeNoise::default() };
        assert!(readings(model, None).all(|reading| reading.is_none()));
        let outliers = readings(RangeNoise { outlier: 0.25, ..model }, None).flatten().count();
        assert!((2_300..2_700).contains(&outliers), "{outliers} of 10000 at a quarter");
        assert!(readings(RangeNoise { outlier: 1.0, ..model }, None).all(|reading| reading.is_some()));
    }

    #[test]
    fn parts_of_the_standard_deviation_add_as_variances() {
        let model = RangeNoise { sigma: 0.02, sigma_share: 0.06, sigma_per_m: 0.09, ..RangeNoise::default() };
        // The parts are 0.02, 0.03 and 0.0225 at 0.5 m, and 0.02, 0.12 and 0.36 at 2 m.
        assert!((model.sigma_at(0.5) - 0.042_5).abs() < 1e-15, "{}", model.sigma_at(0.5));
        assert!((model.sigma_at(2.0) - 0.38).abs() < 1e-15, "{}", model.sigma_at(2.0));
        assert_eq!(RangeNoise { sigma_per_m: 0.0, ..model }.sigma_at(0.5), math::hypot(0.02, 0.03), "bit-identical");
    }

    #[test]
    fn dropouts_take_precedence_over_outliers() {
        let model = RangeNoise { outlier: 1.0, dropout: 1.0, ..RangeNoise::default() };
        assert!(readings(model, Some(1.0)).all(|reading| reading.is_none()));
    }

    #[test]
    fn readings_stay_in_range() {
        for exact in [0.0, 0.05, 3.99, 4.0, 1e9] {
            let model = RangeNoise { sigma: 1.0, step: 0.03, outlier: 0.1, ..RangeNoise::default() };
            let [low, high] = LIMITS;
            assert!(readings(model, Some(exact)).flatten().all(|reading| (low..=high).contains(&reading)));
        }
    }

    #[test]
    fn drawn_bias_is_constant_for_a_sensor_and_differs_between_sensors() {
        let model = RangeNoise { bias: 0.01, bias_sigma: 0.002, ..RangeNoise::default() };
        let offset = |robot, name| {
            let errors = RangeErrors::new(model, 7, RobotId(robot), name);
            let read = |index| errors.reading(index, Time::ZERO, LIMITS, Some(1.0)).map(|reading| reading - 1.0);
            assert_eq!(read(1), read(2));
            read(1).expect("a distance")
        };
        let offsets = [offset(1, "A"), offset(1, "B"), offset(2, "A")];
        assert!(offsets[0] != offsets[1] && offsets[0] != offsets[2], "{offsets:?}");
        assert!(offsets.iter().all(|offset| (offset - 0.01).abs() < 5.0 * 0.002), "{offsets:?}");
    }

    #[test]
    fn drift_decays_with_its_time_constant() {
        let errors = errors(RangeNoise { drift: 0.1, drift_time: 20.0, ..RangeNoise::default() });
        for (seconds, offset) in [(0, 0.1), (20, 0.1 / std::f64::consts::E), (2_000_000, 0.0)] {
            let at = Time::from_millis(seconds * 1000);
            let reading = errors.reading(9, at, LIMITS, Some(2.0)).expect("a distance");
            assert!((reading - 2.0 - offset).abs() < 1e-15, "{seconds} s: {reading}");
        }
    }

    #[test]
    fn outlier_and_dropout_probabilities_do_not_change_other_readings() {
        let model = RangeNoise { sigma: 0.01, ..RangeNoise::default() };
        let with_outliers = RangeNoise { outlier: 0.1, dropout: 0.2, ..model };
        let equal = readings(model, Some(2.0)).zip(readings(with_outliers, Some(2.0))).filter(|(a, b)| a == b).count();
        assert!((7_000..7_400).contains(&equal), "{equal} of 10000 at 0.9 times 0.8");
    }

    #[test]
    fn values_are_rounded_to_the_nearest_step() {
        assert_eq!([0.24, 0.25, -0.25, 0.26].map(|value| quantised(value, 0.5)), [0.0, 0.5, -0.5, 0.5]);
        assert_eq!(quantised(0.24, 0.0), 0.24);
    }

    #[test]
    fn points_of_a_scan_differ_and_the_first_equals_the_single_reading() {
        let errors = errors(RangeNoise { sigma: 0.01, ..RangeNoise::default() });
        let mut scan = errors.scan(5, Time::ZERO, LIMITS);
        let points = [scan.point(Some(1.0)), scan.point(Some(1.0))];
        assert_eq!(points[0], errors.reading(5, Time::ZERO, LIMITS, Some(1.0)));
        assert_ne!(points[0], points[1]);
    }

    #[test]
    fn readings_match_golden_values() {
        let model = RangeNoise {
            sigma: 0.01,
            sigma_share: 0.01,
            bias: 0.005,
            bias_sigma: 0.01,
            drift: 0.1,
            device: 0.5,
            ..RangeNoise::default()
        };
        let errors = errors(model);
        let found = [
            errors.reading(1, Time::from_millis(60), LIMITS, Some(1.0)).unwrap_or_default(),
            errors.reading(2, Time::from_millis(120), LIMITS, Some(3.0)).unwrap_or_default(),
            errors.device_noise(1, 0.01, 0.002),
        ];
        assert_eq!(found, GOLDEN, "{found:?}");
    }

    const GOLDEN: [f64; 3] = [1.099510784396984, 3.0970863903032564, 0.0003095802652095729];
}
