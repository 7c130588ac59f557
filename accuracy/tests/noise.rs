//! Noise, compared with its specification: mean, variance and distribution of every model and of the presets in
//! [`LEVELS`], bits of the generator, independence of streams; and the power of the tests to detect violations.
//!
//! Seeds are fixed, so each test passes always or never. A test fails if a p-value is below [`SIGNIFICANCE`].

use std::sync::Arc;

use accuracy::statistics::{Moments, binomial, chi_squared, kolmogorov, normal_cdf, uncorrelated};
use sim_core::RobotId;
use sim_core::drive::{self, Command, DriveKind, Imperfection, Model};
use sim_core::math::{hypot, ln, sin};
use sim_core::noise::{
    CompassErrors, CompassNoise, EventStreams, ImageErrors, ImageNoise, MotionNoise, Purpose, RangeErrors, RangeKind,
    RangeNoise, TwistNoise,
};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Walls;
use sim_core::spec::Preset;
use sim_core::time::{TICK, Time};
use sim_format::{LEVELS, preset};

/// Significance level. For one seed in a hundred, the smallest of about a hundred p-values is below this level by
/// chance.
const SIGNIFICANCE: f64 = 1e-4;
const MILLION: u64 = 1_000_000;
const SEED: u64 = 2026;
const ROBOT: RobotId = RobotId(1);
/// Range of a sensor so wide that no reading is clamped.
const WIDE: [f64; 2] = [0.0, 100.0];

/// Asserts that the p-value `p` is above the significance level.
#[track_caller]
fn assert_p(what: &str, p: f64) {
    assert!(p > SIGNIFICANCE, "{what}: p = {p:e}");
}

fn streams(purpose: Purpose, name: &str) -> EventStreams {
    EventStreams::new(SEED, ROBOT, purpose, name)
}

/// First normal number of each of `count` events.
fn normals(count: u64) -> Vec<f64> {
    let streams = streams(Purpose::Range, "PSD_FRONT");
    (0..count).map(|index| streams.at(index).normal()).collect()
}

/// Test of normality: the minimum of the p-values of mean, variance and distribution.
fn normality(sample: &mut [f64], mean: f64, sigma: f64) -> f64 {
    let moments = Moments::of(sample);
    let mean_p = moments.mean_is(mean, sigma * sigma);
    let variance_p = moments.variance_is(sigma * sigma);
    let distribution_p = kolmogorov(sample, |x| normal_cdf((x - mean) / sigma));
    mean_p.min(variance_p).min(distribution_p)
}

/// The presets of [`LEVELS`], from the smallest errors to the largest.
fn presets() -> impl Iterator<Item = Preset> {
    LEVELS.into_iter().filter_map(preset)
}

#[test]
fn bits_and_bytes_are_uniform() {
    let event_streams = streams(Purpose::Range, "PSD_FRONT");
    let mut successive = streams(Purpose::Signal, "PSD_FRONT").at(0);
    let mut draw: [Box<dyn FnMut(u64) -> u64>; 2] =
        [Box::new(|index| event_streams.at(index).bits()), Box::new(|_| successive.bits())];
    for (name, draw) in ["of events", "in turn"].into_iter().zip(&mut draw) {
        let mut ones = [0_u64; 64];
        let mut bytes = vec![[0.0_f64; 256]; 8];
        for index in 0..MILLION / 2 {
            let bits = draw(index);
            for (bit, count) in ones.iter_mut().enumerate() {
                *count += bits >> bit & 1;
            }
            for (index, byte) in bits.to_le_bytes().into_iter().enumerate() {
                bytes[index][usize::from(byte)] += 1.0;
            }
        }
        for (bit, count) in ones.into_iter().enumerate() {
            assert_p(&format!("bit {bit} {name}"), binomial(count, MILLION / 2, 0.5));
        }
        let expected = [(MILLION / 2) as f64 / 256.0; 256];
        for (index, counts) in bytes.iter().enumerate() {
            assert_p(&format!("byte {index} {name}"), chi_squared(counts, &expected));
        }
    }
}

#[test]
fn uniform_numbers_are_uniform() {
    let streams = streams(Purpose::Range, "PSD_FRONT");
    let mut sample: Vec<f64> = (0..MILLION).map(|index| streams.at(index).unit()).collect();
    let moments = Moments::of(&sample);
    assert_p("mean", moments.mean_is(0.5, 1.0 / 12.0));
    assert_p("variance", moments.variance_is(1.0 / 12.0));
    assert_p("distribution", kolmogorov(&mut sample, |x| x));
}

#[test]
fn normal_numbers_are_normal() {
    assert_p("of events", normality(&mut normals(MILLION), 0.0, 1.0));
    let mut stream = streams(Purpose::Image, "CAMERA").at(3);
    let mut successive: Vec<f64> = (0..MILLION).map(|_| stream.normal()).collect();
    assert_p("in turn", normality(&mut successive, 0.0, 1.0));
    let far = successive.iter().filter(|z| z.abs() > 4.0).count() as u64;
    assert_p("tails", binomial(far, MILLION, 2.0 * normal_cdf(-4.0)));
}

#[test]
fn tests_detect_violations() {
    let sample = normals(MILLION);
    let changed = |change: &dyn Fn(f64) -> f64| sample.iter().map(|z| change(*z)).collect::<Vec<_>>();
    let assert_detected = |what: &str, p: f64| assert!(p < SIGNIFICANCE, "{what} is not noticed: p = {p}");
    assert_detected("a variance of 1 % more", normality(&mut changed(&|z| z * 1.01_f64.sqrt()), 0.0, 1.0));
    assert_detected("a variance of 1 % less", normality(&mut changed(&|z| z * 0.99_f64.sqrt()), 0.0, 1.0));
    assert_detected("a mean of 0.5 % of sigma", normality(&mut changed(&|z| z + 0.005), 0.0, 1.0));
    let uniform = changed(&|z| (normal_cdf(z) - 0.5) * 12.0_f64.sqrt());
    assert_detected("a uniform distribution", kolmogorov(&mut uniform.clone(), normal_cdf));
    let moments = Moments::of(&uniform);
    assert!(
        moments.mean_is(0.0, 1.0).min(moments.variance_is(1.0)) > SIGNIFICANCE,
        "which has the right mean and variance"
    );
    // The sum of four uniform numbers has the right mean and variance, and is approximately normal.
    let sums: Vec<f64> =
        sample.chunks(4).map(|four| four.iter().map(|z| normal_cdf(*z) - 0.5).sum::<f64>() * 3.0_f64.sqrt()).collect();
    assert_detected("a sum of four uniform numbers", kolmogorov(&mut sums.clone(), normal_cdf));
    assert_detected("tails that are cut at 4 sigma", binomial(0, MILLION, 2.0 * normal_cdf(-4.0)));
    assert_detected("a probability of 0.0105 for 0.01", binomial(10_500, MILLION, 0.01));
    assert_detected("a bit of 50.25 %", binomial(502_500, MILLION, 0.5));
    let correlated: Vec<f64> = sample.windows(2).map(|pair| pair[0] * 0.01 + pair[1]).collect();
    assert_detected(
        "a correlation of 1 %",
        uncorrelated(&sample[1..], &correlated).max(uncorrelated(&sample[..correlated.len()], &correlated)),
    );
    let mut counts = [1000.0; 256];
    (counts[0], counts[1]) = (1600.0, 400.0);
    assert_detected("one byte of 256 that comes too often", chi_squared(&counts, &[1000.0; 256]));
}

#[test]
fn streams_of_neighbouring_keys_are_uncorrelated() {
    const PAIRS: u64 = 200_000;
    let sample = |seed, robot, purpose, name: &str, step: u64| -> Vec<f64> {
        let streams = EventStreams::new(seed, RobotId(robot), purpose, name);
        (0..PAIRS).map(|index| streams.at(index + step).normal()).collect()
    };
    let base = sample(SEED, 1, Purpose::Range, "PSD_FRONT", 0);
    let others = [
        ("the next event", sample(SEED, 1, Purpose::Range, "PSD_FRONT", 1)),
        ("the event after the next", sample(SEED, 1, Purpose::Range, "PSD_FRONT", 2)),
        ("an event 2^32 later", sample(SEED, 1, Purpose::Range, "PSD_FRONT", 1 << 32)),
        ("the next seed", sample(SEED + 1, 1, Purpose::Range, "PSD_FRONT", 0)),
        ("the next robot", sample(SEED, 2, Purpose::Range, "PSD_FRONT", 0)),
        ("the next purpose", sample(SEED, 1, Purpose::Signal, "PSD_FRONT", 0)),
        ("another name", sample(SEED, 1, Purpose::Range, "PSD_FRONU", 0)),
    ];
    for (what, other) in &others {
        assert_p(what, uncorrelated(&base, other));
        // Independence requires uncorrelated squares as well.
        let square = |sample: &[f64]| sample.iter().map(|z| z * z).collect::<Vec<_>>();
        assert_p(&format!("{what}, squares"), uncorrelated(&square(&base), &square(other)));
    }
    let streams = streams(Purpose::Range, "PSD_FRONT");
    let successive: Vec<(f64, f64)> = (0..PAIRS)
        .map(|index| {
            let mut stream = streams.at(index);
            (stream.normal(), stream.normal())
        })
        .collect();
    let (first, second): (Vec<f64>, Vec<f64>) = successive.into_iter().unzip();
    assert_p("two numbers of one event", uncorrelated(&first, &second));
}

/// Readings for the true distance `exact`, without drop-outs.
fn readings(errors: &RangeErrors, count: u64, exact: f64) -> Vec<f64> {
    (0..count).filter_map(|index| errors.reading(index, Time::ZERO, WIDE, Some(exact))).collect()
}

fn sensor(model: RangeNoise) -> RangeErrors {
    RangeErrors::new(model, SEED, ROBOT, "PSD_FRONT")
}

#[test]
fn readings_are_normal_with_the_distance_as_mean() {
    for exact in [5.0_f64, 50.0] {
        let model =
            RangeNoise { sigma: 0.003, sigma_share: 0.001, sigma_per_m: 0.000_1, bias: 0.01, ..RangeNoise::default() };
        let parts = [model.sigma, model.sigma_share * exact, model.sigma_per_m * exact * exact];
        let sigma = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let mut sample = readings(&sensor(model), MILLION, exact);
        assert_p(&format!("at {exact} m"), normality(&mut sample, exact + 0.01, sigma));
    }
}

#[test]
fn rounded_readings_have_the_probabilities_of_their_steps() {
    let model = RangeNoise { sigma: 0.02, step: 0.01, ..RangeNoise::default() };
    let sample = readings(&sensor(model), MILLION, 5.003);
    assert_p("steps", rounded_distribution(&sample, 0.01, |x| normal_cdf((x - 5.003) / 0.02)));
}

/// p-value of the hypothesis that a sample has the distribution `cdf`, rounded to multiples of `step`.
fn rounded_distribution(sample: &[f64], step: f64, cdf: impl Fn(f64) -> f64) -> f64 {
    let step_index = |x: f64| (x / step).round() as i64;
    let [low, high] =
        [sample.iter().copied().fold(f64::INFINITY, f64::min), sample.iter().copied().fold(0.0, f64::max)];
    let (low, high) = (step_index(low), step_index(high));
    let mut counts = vec![0.0; (high - low + 1) as usize];
    for x in sample {
        assert!((x - step_index(*x) as f64 * step).abs() < 1e-9, "{x} is not a multiple of {step}");
        counts[(step_index(*x) - low) as usize] += 1.0;
    }
    let edge = |index: i64| (index as f64 - 0.5) * step;
    let expected_count = |index: i64| {
        let below = if index == low { 0.0 } else { cdf(edge(index)) };
        let above = if index == high { 1.0 } else { cdf(edge(index + 1)) };
        (above - below) * sample.len() as f64
    };
    chi_squared(&counts, &(low..=high).map(expected_count).collect::<Vec<_>>())
}

#[test]
fn outliers_and_dropouts_have_their_probabilities() {
    let model = RangeNoise { outlier: 0.01, dropout: 0.003, ..RangeNoise::default() };
    let errors = sensor(model);
    let (mut dropouts, mut outliers) = (0, Vec::new());
    for index in 0..MILLION {
        match errors.reading(index, Time::ZERO, WIDE, Some(5.0)) {
            None => dropouts += 1,
            Some(5.0) => {}
            Some(outlier) => outliers.push(outlier),
        }
    }
    assert_p("drop-outs", binomial(dropouts, MILLION, 0.003));
    assert_p("outliers", binomial(outliers.len() as u64, MILLION - dropouts, 0.01));
    assert_p("where they are", kolmogorov(&mut outliers, |x| x / 100.0));
}

#[test]
fn drawn_bias_is_normal_between_sensors() {
    let model = RangeNoise { bias: 0.01, bias_sigma: 0.005, ..RangeNoise::default() };
    let offset = |name: u64| {
        let errors = RangeErrors::new(model, SEED, RobotId(1 + (name % 100) as u32), &format!("S{}", name / 100));
        errors.reading(0, Time::ZERO, WIDE, Some(5.0)).expect("a distance") - 5.0
    };
    let mut sample: Vec<f64> = (0..MILLION).map(offset).collect();
    assert_p("bias", normality(&mut sample, 0.01, 0.005));
}

#[test]
fn device_noise_matches_the_paper() {
    let errors = sensor(RangeNoise { device: 1.0, ..RangeNoise::default() });
    let mut sample: Vec<f64> = (0..MILLION).map(|index| errors.device_noise(index, 0.01, 0.002)).collect();
    assert_p("N = sigma G + m", normality(&mut sample, 0.002, 0.01));
    let half = sensor(RangeNoise { device: 0.5, ..RangeNoise::default() });
    assert_eq!(half.device_noise(7, 0.01, 0.002), 0.5 * errors.device_noise(7, 0.01, 0.002));
}

#[test]
fn drift_changes_only_the_mean() {
    let errors = sensor(RangeNoise { sigma: 0.01, drift: 0.1, drift_time: 30.0, ..RangeNoise::default() });
    let at = Time::from_millis(45_000);
    let sample = (0..MILLION).filter_map(|index| errors.reading(index, at, WIDE, Some(5.0)));
    assert_p(
        "at 1.5 time constants",
        normality(&mut sample.collect::<Vec<_>>(), 5.0 + 0.1 * 0.223_130_160_148_429_83, 0.01),
    );
}

#[test]
fn readings_of_every_kind_and_preset_match_their_model() {
    // Small enough that no reading is clamped, although the standard deviation may grow with the square of the
    // distance.
    const EXACT: f64 = 0.5;
    for preset in presets() {
        let profile = preset.profile();
        for kind in RangeKind::ALL {
            let what = format!("{} of {}", kind.name(), preset.name);
            let model = profile.range(kind, "");
            let errors = sensor(model);
            if preset == Preset::default() {
                assert_eq!(
                    (model, errors.reading(3, Time::ZERO, WIDE, Some(EXACT))),
                    (RangeNoise::default(), Some(EXACT))
                );
                continue;
            }
            // At the start of the run the drift is at its maximum. A model with `bias_sigma` alone gives the bias that
            // was drawn for the sensor.
            let biased = sensor(RangeNoise { bias_sigma: model.bias_sigma, ..RangeNoise::default() });
            let offset = biased.reading(0, Time::ZERO, WIDE, Some(0.5)).expect("a distance") - 0.5;
            let (mean, sigma) = (EXACT + model.bias + offset + model.drift, model.sigma_at(EXACT));
            let sample = readings(&errors, MILLION, EXACT);
            let count = sample.len() as u64;
            assert_p(&format!("{what}: drop-outs"), binomial(MILLION - count, MILLION, model.dropout));
            if model.device > 0.0 {
                let mut device_noise: Vec<f64> =
                    (0..MILLION).map(|index| errors.device_noise(index, 0.01, 0.0)).collect();
                assert_p(&format!("{what}: noise of its own"), normality(&mut device_noise, 0.0, 0.01 * model.device));
            }
            if sigma == 0.0 {
                let reading = if model.step > 0.0 { (mean / model.step).round() * model.step } else { mean };
                let mut outliers: Vec<f64> = sample.into_iter().filter(|read| (read - reading).abs() > 1e-12).collect();
                assert_p(&format!("{what}: outliers"), binomial(outliers.len() as u64, count, model.outlier));
                if !outliers.is_empty() {
                    // The rounding of outliers is negligible: the step is at most a thousandth of the range.
                    let moments = Moments::of(&outliers);
                    assert_p(&format!("{what}: mean of outliers"), moments.mean_is(50.0, 1e4 / 12.0));
                    assert_p(&format!("{what}: where outliers are"), kolmogorov(&mut outliers, |x| x / 100.0));
                }
                continue;
            }
            let cdf = |x: f64| (1.0 - model.outlier) * normal_cdf((x - mean) / sigma) + model.outlier * x / 100.0;
            // Rounding adds a twelfth of the squared step to the variance if the step is no coarser than the noise.
            let mean_shift = model.outlier * (50.0 - mean);
            let variance = (1.0 - model.outlier) * (sigma * sigma + mean_shift.powi(2))
                + model.outlier * (100.0 * 100.0 / 12.0 + (50.0 - mean - mean_shift).powi(2));
            let moments = Moments::of(&sample);
            if sigma > model.step {
                let rounding = model.step * model.step / 12.0;
                assert_p(&format!("{what}: mean"), moments.mean_is(mean + mean_shift, variance + rounding));
                assert_p(&format!("{what}: variance"), moments.variance_is(variance + rounding));
            }
            let distribution_p = if model.step > 0.0 {
                rounded_distribution(&sample, model.step, cdf)
            } else {
                kolmogorov(&mut sample.clone(), cdf)
            };
            assert_p(&format!("{what}: distribution"), distribution_p);
        }
    }
}

/// Distances and published error bounds (3.09 standard deviations) of a single reading of a Sharp GP2Y0A21 at these
/// distances, m. Source: Malheiros, Gonçalves & Costa 2009.
const SHARP: [(f64, f64); 2] = [(0.08, 0.0025), (0.8, 0.1854)];
/// Distance, m, and the manufacturer's error bound at this distance for an SRF08, m.
const SRF08: (f64, f64) = (3.0, 0.04);

/// Percentage of normal errors whose magnitude exceeds `bound`.
fn percent_beyond(bound: f64, sigma: f64) -> f64 {
    if sigma == 0.0 { 0.0 } else { 200.0 * normal_cdf(-bound / sigma) }
}

/// Mean loss of log-likelihood, in nats, if readings with the standard deviation `published` are modelled with `sigma`:
/// the Kullback-Leibler divergence of two normal distributions with the same mean.
fn nats_lost(published: f64, sigma: f64) -> f64 {
    ln(sigma / published) + 0.5 * (published / sigma).powi(2) - 0.5
}

#[test]
fn table_of_published_bounds_matches_the_presets() {
    let page = include_str!("../../docs/noise.md");
    let bounds = |sigmas: [f64; 2]| {
        let percentages = [0, 1].map(|index| percent_beyond(SHARP[index].1, sigmas[index]));
        format!(
            "{:.1} mm, {:.1} mm | {:.1} %, {:.1} %",
            1e3 * sigmas[0],
            1e3 * sigmas[1],
            percentages[0],
            percentages[1]
        )
    };
    let published = SHARP.map(|(_, bound)| bound / 3.09);
    let mut lines = vec![format!("| published | {} | 0, 0 | few |", bounds(published))];
    for preset in presets().skip(1) {
        let profile = preset.profile();
        let sigmas = SHARP.map(|(distance, _)| profile.range(RangeKind::Psd, "").sigma_at(distance));
        let lost = [0, 1].map(|index| nats_lost(published[index], sigmas[index]));
        let sonar = percent_beyond(SRF08.1, profile.range(RangeKind::Sonar, "").sigma_at(SRF08.0));
        let bounds = bounds(sigmas);
        lines.push(format!("| `{}` | {bounds} | {:.1}, {:.1} | {sonar:.1} % |", preset.name, lost[0], lost[1]));
    }
    println!("{}", lines.join("\n"));
    for line in lines {
        assert!(page.contains(&line), "docs/noise.md has no line `{line}`");
    }
}

#[test]
fn percentage_and_lost_likelihood_match_a_sample() {
    // The model has half of the true standard deviation.
    let (published, sigma) = (0.06, 0.03);
    let sample = readings(&sensor(RangeNoise { sigma: published, ..RangeNoise::default() }), MILLION, 5.0);
    let beyond = sample.iter().filter(|read| (*read - 5.0).abs() > 0.1).count() as u64;
    assert_p("share", binomial(beyond, MILLION, percent_beyond(0.1, published) / 100.0));
    let log_density = |z: f64, sigma: f64| -0.5 * (z / sigma).powi(2) - ln(sigma);
    let lost = sample.iter().map(|read| log_density(read - 5.0, published) - log_density(read - 5.0, sigma));
    let mean = lost.sum::<f64>() / MILLION as f64;
    // Four standard errors of the mean: the terms have a variance of (0.5 (4 - 1))^2 * 2.
    assert!((mean - nats_lost(published, sigma)).abs() < 4.0 * 2.13e-3, "{mean}");
}

#[test]
fn compass_readings_of_every_preset_match_their_model() {
    for preset in presets().skip(1) {
        let model = preset.profile().compass;
        let smooth = CompassNoise { step: 0.0, bias_sigma: 0.0, ..model };
        let errors = CompassErrors::new(smooth, SEED, ROBOT, "COMPASS");
        let mut sample: Vec<f64> = (0..MILLION).map(|index| errors.reading(index, 1.0)).collect();
        assert_p(preset.name, normality(&mut sample, 1.0 + model.bias, model.sigma));
        let rounded = CompassErrors::new(CompassNoise { bias_sigma: 0.0, ..model }, SEED, ROBOT, "COMPASS");
        let sample: Vec<f64> = (0..MILLION).map(|index| rounded.reading(index, 1.0)).collect();
        assert_p(
            preset.name,
            rounded_distribution(&sample, model.step, |x| normal_cdf((x - 1.0 - model.bias) / model.sigma)),
        );
    }
}

#[test]
fn drawn_bias_is_normal_between_compasses() {
    let model = CompassNoise { bias: 0.02, bias_sigma: 0.05, ..CompassNoise::default() };
    let offset = |robot| CompassErrors::new(model, SEED, RobotId(robot), "COMPASS").reading(0, 1.0) - 1.0;
    let mut sample: Vec<f64> = (1..=1_000_000).map(offset).collect();
    assert_p("bias", normality(&mut sample, 0.02, 0.05));
}

#[test]
fn images_of_every_preset_match_their_model() {
    const GREY: u8 = 128;
    let preset_models = presets().skip(1).map(|preset| preset.profile().camera);
    let strong = ImageNoise { blur: 2.0, sigma: 10.0, salt_and_pepper: 0.02, salt: 0.3, hundreds_and_thousands: 0.03 };
    let count = 1_000_000;
    for model in preset_models.chain([strong]) {
        let frame = |model: ImageNoise| -> Vec<[u8; 3]> {
            let errors = ImageErrors::new(model, SEED, ROBOT, "CAMERA");
            let mut pixels = vec![[GREY; 3]; count];
            for (row, pixels) in (0..).zip(pixels.chunks_mut(1000)) {
                errors.apply(5, row, pixels);
            }
            pixels
        };
        let levels: Vec<f64> = frame(ImageNoise { sigma: model.sigma, ..ImageNoise::default() })
            .as_flattened()
            .iter()
            .map(|level| f64::from(*level))
            .collect();
        let cdf = |x: f64| normal_cdf((x - f64::from(GREY)) / model.sigma);
        assert_p("levels", rounded_distribution(&levels, 1.0, cdf));
        let moments = Moments::of(&levels);
        let variance = model.sigma * model.sigma + 1.0 / 12.0;
        assert_p("mean", moments.mean_is(GREY.into(), variance));
        assert_p("variance", moments.variance_is(variance));
        let pixels = frame(ImageNoise { sigma: 0.0, hundreds_and_thousands: 0.0, ..model });
        let hits = |colour: [u8; 3]| pixels.iter().filter(|pixel| **pixel == colour).count() as u64;
        let (salt, pepper) = (hits([255; 3]), hits([0; 3]));
        assert_p("salt and pepper", binomial(salt + pepper, MILLION, model.salt_and_pepper));
        assert_p("salt", binomial(salt, salt + pepper, model.salt));
        let pixels = frame(ImageNoise { sigma: 0.0, salt_and_pepper: 0.0, ..model });
        let coloured: Vec<[u8; 3]> = pixels.into_iter().filter(|pixel| *pixel != [GREY; 3]).collect();
        assert_p("hundreds and thousands", binomial(coloured.len() as u64, MILLION, model.hundreds_and_thousands));
        if coloured.len() > 1000 {
            for channel in 0..3 {
                let mut counts = [0.0; 256];
                coloured.iter().for_each(|pixel| counts[usize::from(pixel[channel])] += 1.0);
                assert_p("colours", chi_squared(&counts, &[coloured.len() as f64 / 256.0; 256]));
            }
        }
    }
}

/// Central weight exp(-t) I_0(t) of a discrete Gaussian of variance t, by its power series.
fn central_weight(t: f64) -> f64 {
    let mut term = sim_core::math::exp(-t);
    let mut sum = 0.0;
    for k in 1..100 {
        sum += term;
        term *= (0.5 * t / f64::from(k)) * (0.5 * t / f64::from(k));
    }
    sum
}

#[test]
fn blur_of_every_preset_matches_its_model() {
    const DEVIATION: f64 = 30.0;
    let preset_models = presets().map(|preset| preset.profile().camera.blur);
    for blur in preset_models.chain([2.0, 5.0]) {
        // A filter scales the variance of white noise by the sum of its squared weights in each direction; for a
        // discrete Gaussian, this sum is the central weight of a Gaussian of twice the variance.
        let white = ImageNoise { sigma: DEVIATION, ..ImageNoise::default() };
        let mut pixels = vec![[128_u8]; 1_000_000];
        ImageErrors::new(white, SEED, ROBOT, "CAMERA").expose(0, 1000, &mut pixels);
        let model = ImageNoise { blur, ..ImageNoise::default() };
        ImageErrors::new(model, SEED, ROBOT, "CAMERA").expose(0, 1000, &mut pixels);
        let levels: Vec<f64> = pixels.as_flattened().iter().map(|level| f64::from(*level)).collect();
        let variance_factor = central_weight(2.0 * blur * blur);
        let rounding = 1.0 / 12.0;
        let expected = (DEVIATION * DEVIATION + rounding) * variance_factor * variance_factor
            + if blur > 0.0 { rounding } else { 0.0 };
        // Five standard deviations of the sample variance; neighbouring pixels are correlated, so fewer pixels are
        // independent.
        let independent = 1e6 / (std::f64::consts::TAU * blur * blur).max(1.0);
        let tolerance = 5.0 * (2.0 / independent).sqrt();
        let Moments { mean, variance, .. } = Moments::of(&levels);
        assert!((mean - 128.0).abs() < 0.2, "blur {blur}: mean {mean}");
        assert!((variance / expected - 1.0).abs() < tolerance, "blur {blur}: variance {variance}, not {expected}");
    }
}

#[test]
fn wheel_diameters_of_every_preset_match_their_model() {
    for preset in presets().skip(1) {
        let motion: MotionNoise = preset.profile().motion;
        let diameters = |robot| motion.imperfection(DriveKind::Omni, SEED, RobotId(robot)).diameters;
        let mut sample: Vec<f64> = (1..=250_000).flat_map(diameters).collect();
        assert_p(preset.name, normality(&mut sample, motion.left, motion.diameter_sigma));
    }
}

/// Commanded twist.
const COMMANDED_TWIST: Twist = Twist { vx: 0.2, vy: 0.0, omega: 1.0 };
const TRACK: f64 = 0.1;

/// True and odometric twists of each tick of 100 robots that follow `commanded` for 10,000 ticks.
fn ticks(kind: DriveKind, commanded: Twist, imperfection: Imperfection) -> [Vec<Twist>; 2] {
    let model = Model {
        kind,
        wheel_diameter: 0.05,
        max_wheel_rate: 1e3,
        ticks_per_turn: 540.0,
        track: TRACK,
        wheelbase: TRACK,
        axis_offset: 0.0,
        max_speed: 2.0,
        max_turn: 10.0,
        body_radius: 0.08,
        wheel_lag: 0.0,
        max_steering: 1.0,
        mass: 1.0,
        traction: 0.6,
    };
    let (model, walls) = (Arc::new(model), Arc::new(Walls::new(vec![])));
    let [mut truth, mut odometric] = [Vec::new(), Vec::new()];
    for robot in 1..=100 {
        let motion = drive::Motion::new(RobotId(robot), Arc::clone(&model), Arc::clone(&walls), Pose::default());
        let mut motion = motion.with_imperfection(SEED, imperfection).expect("a valid imperfection");
        motion.command(Time::ZERO, Command::Twist(commanded), &[]).expect("a valid command");
        let mut before = motion.pose(Time::ZERO);
        for tick in 0..10_000 {
            odometric.push(motion.speed(Time(tick * TICK.0)));
            let after = motion.pose(Time((tick + 1) * TICK.0));
            truth.push(twist_between(before, after));
            before = after;
        }
    }
    [truth, odometric]
}

/// Constant twist that moves a robot from one pose to another in a tick.
fn twist_between(before: Pose, after: Pose) -> Twist {
    let angle = after.heading.radians() - before.heading.radians();
    let half = 0.5 * angle;
    // Chord of the arc, in the direction of the mean heading.
    let arc_per_chord = if half == 0.0 { 1.0 } else { half / sin(half) };
    let direction = before.heading.turned(half).direction();
    let chord = after.position - before.position;
    Twist { vx: chord.dot(direction) * arc_per_chord, vy: direction.perp_dot(chord) * arc_per_chord, omega: angle }
        .scaled(1.0 / TICK.seconds())
}

/// Checks that twists are normal with the mean `mean` and the deviations of `noise`, and that neither speed and turning
/// speed nor successive ticks are correlated.
fn check_twists(what: &str, twists: &[Twist], mean: Twist, noise: TwistNoise) {
    let component = |part: fn(&Twist) -> f64| twists.iter().map(part).collect::<Vec<_>>();
    let speed = |x: f64| hypot(noise.speed, noise.speed_share * x);
    let turning = hypot(noise.turn, noise.turn_share * mean.omega);
    let (forward, sideways, turning_speeds) =
        (component(|twist| twist.vx), component(|twist| twist.vy), component(|twist| twist.omega));
    for (part, sample, mean, sigma) in
        [("speed", &forward, mean.vx, speed(mean.vx)), ("turning speed", &turning_speeds, mean.omega, turning)]
    {
        if sigma > 0.0 {
            assert_p(&format!("{what}: {part} of two ticks"), uncorrelated(&sample[1..], &sample[..sample.len() - 1]));
            assert_p(&format!("{what}: {part}"), normality(&mut sample.clone(), mean, sigma));
        } else {
            assert!(sample.iter().all(|x| (x - mean).abs() < 1e-9), "{what}: {part}");
        }
    }
    if speed(mean.vx) > 0.0 && turning > 0.0 {
        assert_p(&format!("{what}: speed and turning speed"), uncorrelated(&forward, &turning_speeds));
    }
    if mean.vy != 0.0 {
        assert_p(&format!("{what}: speed aside"), normality(&mut sideways.clone(), mean.vy, speed(mean.vy)));
    } else {
        assert!(sideways.iter().all(|speed| speed.abs() < 1e-9), "{what}: nothing moves it aside");
    }
}

#[test]
fn command_and_odometry_noise_of_every_preset_match_their_model() {
    for preset in presets() {
        let MotionNoise { command, odometry, .. } = preset.profile().motion;
        let [truth, odometric] = ticks(
            DriveKind::Differential,
            COMMANDED_TWIST,
            Imperfection { command, odometry, ..Imperfection::default() },
        );
        check_twists(&format!("command of {}", preset.name), &truth, COMMANDED_TWIST, command);
        check_twists(&format!("odometry of {}", preset.name), &odometric, COMMANDED_TWIST, odometry);
        let (true_speeds, odometric_speeds): (Vec<f64>, Vec<f64>) =
            truth.iter().zip(&odometric).map(|(truth, odometric)| (truth.vx, odometric.vx)).unzip();
        if odometry != TwistNoise::default() {
            assert_p("command and odometry", uncorrelated(&true_speeds, &odometric_speeds));
        }
    }
}

#[test]
fn omni_drive_has_noise_along_all_axes() {
    let command = TwistNoise { speed: 0.02, speed_share: 0.05, turn: 0.1, turn_share: 0.05 };
    let odometry = TwistNoise { speed: 0.01, speed_share: 0.2, turn: 0.3, turn_share: 0.0 };
    let commanded = Twist { vy: -0.3, ..COMMANDED_TWIST };
    let [truth, odometric] =
        ticks(DriveKind::Omni, commanded, Imperfection { command, odometry, ..Imperfection::default() });
    check_twists("command", &truth, commanded, command);
    check_twists("odometry", &odometric, commanded, odometry);
}

#[test]
fn slip_of_every_preset_matches_its_model() {
    for preset in presets() {
        let MotionNoise { slip, slip_sigma, .. } = preset.profile().motion;
        if slip_sigma == 0.0 {
            assert_eq!(slip, 0.0, "{}", preset.name);
            continue;
        }
        let imperfection = Imperfection { slip, slip_deviation: slip_sigma, ..Imperfection::default() };
        let [truth, odometric] = ticks(DriveKind::Differential, COMMANDED_TWIST, imperfection);
        assert!(odometric.iter().all(|twist| *twist == odometric[0]), "encoders count the wheels");
        let [mut left, mut right] = [-0.5 * TRACK, 0.5 * TRACK].map(|y| {
            let wheel_speed = |twist: &Twist| twist.vx + y * twist.omega;
            truth.iter().map(|twist| 1.0 - wheel_speed(twist) / wheel_speed(&COMMANDED_TWIST)).collect::<Vec<_>>()
        });
        assert_p("left and right", uncorrelated(&left, &right));
        assert_p(&format!("left wheel of {}", preset.name), normality(&mut left, slip, slip_sigma));
        assert_p(&format!("right wheel of {}", preset.name), normality(&mut right, slip, slip_sigma));
    }
}
