//! Noise against its specification: mean, variance and distribution of every model and preset, bits of the generator, independence
//! of streams; and the power of the tests to detect violations.
//!
//! Seeds are fixed, so each test passes always or never. A p-value below [`LEAST`] fails.

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

/// Significance level: the smallest of some hundred p-values lies below it by chance for one seed in a hundred.
const LEAST: f64 = 1e-4;
const MILLION: u64 = 1_000_000;
const SEED: u64 = 2026;
const ROBOT: RobotId = RobotId(1);
/// Limits wide enough that no reading is clamped.
const WIDE: [f64; 2] = [0.0, 100.0];

#[track_caller]
fn passes(what: &str, p: f64) {
    assert!(p > LEAST, "{what}: p = {p:e}");
}

fn events(purpose: Purpose, name: &str) -> EventStreams {
    EventStreams::new(SEED, ROBOT, purpose, name)
}

/// First normal number of each of `count` events.
fn normals(count: u64) -> Vec<f64> {
    let events = events(Purpose::Range, "PSD_FRONT");
    (0..count).map(|index| events.at(index).normal()).collect()
}

/// Test of normality: the smallest p-value of mean, variance and distribution.
fn normality(sample: &mut [f64], mean: f64, sigma: f64) -> f64 {
    let moments = Moments::of(sample);
    let of_mean = moments.mean_is(mean, sigma * sigma);
    let of_variance = moments.variance_is(sigma * sigma);
    let of_distribution = kolmogorov(sample, |x| normal_cdf((x - mean) / sigma));
    of_mean.min(of_variance).min(of_distribution)
}

/// The presets that have all kinds of errors, from the smallest to the largest.
fn presets() -> impl Iterator<Item = Preset> {
    LEVELS.into_iter().filter_map(preset)
}

#[test]
fn bits_are_even_and_so_are_their_patterns() {
    let of_events = events(Purpose::Range, "PSD_FRONT");
    let mut in_turn = events(Purpose::Signal, "PSD_FRONT").at(0);
    let mut draw: [Box<dyn FnMut(u64) -> u64>; 2] =
        [Box::new(|index| of_events.at(index).bits()), Box::new(|_| in_turn.bits())];
    for (name, draw) in ["of events", "in turn"].into_iter().zip(&mut draw) {
        let mut ones = [0_u64; 64];
        let mut bytes = vec![[0.0_f64; 256]; 8];
        for index in 0..MILLION / 2 {
            let bits = draw(index);
            for (place, count) in ones.iter_mut().enumerate() {
                *count += bits >> place & 1;
            }
            for (place, byte) in bits.to_le_bytes().into_iter().enumerate() {
                bytes[place][usize::from(byte)] += 1.0;
            }
        }
        for (place, count) in ones.into_iter().enumerate() {
            passes(&format!("bit {place} {name}"), binomial(count, MILLION / 2, 0.5));
        }
        let expected = [(MILLION / 2) as f64 / 256.0; 256];
        for (place, counts) in bytes.iter().enumerate() {
            passes(&format!("byte {place} {name}"), chi_squared(counts, &expected));
        }
    }
}

#[test]
fn uniform_numbers_are_uniform() {
    let events = events(Purpose::Range, "PSD_FRONT");
    let mut sample: Vec<f64> = (0..MILLION).map(|index| events.at(index).unit()).collect();
    let moments = Moments::of(&sample);
    passes("mean", moments.mean_is(0.5, 1.0 / 12.0));
    passes("variance", moments.variance_is(1.0 / 12.0));
    passes("distribution", kolmogorov(&mut sample, |x| x));
}

#[test]
fn normal_numbers_are_normal() {
    passes("of events", normality(&mut normals(MILLION), 0.0, 1.0));
    let mut stream = events(Purpose::Image, "CAMERA").at(3);
    let mut in_turn: Vec<f64> = (0..MILLION).map(|_| stream.normal()).collect();
    passes("in turn", normality(&mut in_turn, 0.0, 1.0));
    let far = in_turn.iter().filter(|z| z.abs() > 4.0).count() as u64;
    passes("tails", binomial(far, MILLION, 2.0 * normal_cdf(-4.0)));
}

#[test]
fn the_tests_would_notice() {
    let sample = normals(MILLION);
    let with = |change: &dyn Fn(f64) -> f64| sample.iter().map(|z| change(*z)).collect::<Vec<_>>();
    let caught = |what: &str, p: f64| assert!(p < LEAST, "{what} is not noticed: p = {p}");
    caught("a variance of 1 % more", normality(&mut with(&|z| z * 1.01_f64.sqrt()), 0.0, 1.0));
    caught("a variance of 1 % less", normality(&mut with(&|z| z * 0.99_f64.sqrt()), 0.0, 1.0));
    caught("a mean of 0.5 % of sigma", normality(&mut with(&|z| z + 0.005), 0.0, 1.0));
    let uniform = with(&|z| (normal_cdf(z) - 0.5) * 12.0_f64.sqrt());
    caught("a uniform distribution", kolmogorov(&mut uniform.clone(), normal_cdf));
    let moments = Moments::of(&uniform);
    assert!(moments.mean_is(0.0, 1.0).min(moments.variance_is(1.0)) > LEAST, "which has the right mean and variance");
    // The sum of four uniform numbers has the right mean and variance, and is approximately normal.
    let sums: Vec<f64> =
        sample.chunks(4).map(|four| four.iter().map(|z| normal_cdf(*z) - 0.5).sum::<f64>() * 3.0_f64.sqrt()).collect();
    caught("a sum of four uniform numbers", kolmogorov(&mut sums.clone(), normal_cdf));
    caught("tails that are cut at 4 sigma", binomial(0, MILLION, 2.0 * normal_cdf(-4.0)));
    caught("a probability of 0.0105 for 0.01", binomial(10_500, MILLION, 0.01));
    caught("a bit of 50.25 %", binomial(502_500, MILLION, 0.5));
    let near: Vec<f64> = sample.windows(2).map(|pair| pair[0] * 0.01 + pair[1]).collect();
    caught("a correlation of 1 %", uncorrelated(&sample[1..], &near).max(uncorrelated(&sample[..near.len()], &near)));
    let mut counts = [1000.0; 256];
    (counts[0], counts[1]) = (1600.0, 400.0);
    caught("one byte of 256 that comes too often", chi_squared(&counts, &[1000.0; 256]));
}

#[test]
fn streams_of_neighbouring_keys_are_uncorrelated() {
    const PAIRS: u64 = 200_000;
    let of = |seed, robot, purpose, name: &str, step: u64| -> Vec<f64> {
        let events = EventStreams::new(seed, RobotId(robot), purpose, name);
        (0..PAIRS).map(|index| events.at(index + step).normal()).collect()
    };
    let base = of(SEED, 1, Purpose::Range, "PSD_FRONT", 0);
    let others = [
        ("the next event", of(SEED, 1, Purpose::Range, "PSD_FRONT", 1)),
        ("the event after the next", of(SEED, 1, Purpose::Range, "PSD_FRONT", 2)),
        ("an event 2^32 later", of(SEED, 1, Purpose::Range, "PSD_FRONT", 1 << 32)),
        ("the next seed", of(SEED + 1, 1, Purpose::Range, "PSD_FRONT", 0)),
        ("the next robot", of(SEED, 2, Purpose::Range, "PSD_FRONT", 0)),
        ("the next purpose", of(SEED, 1, Purpose::Signal, "PSD_FRONT", 0)),
        ("another name", of(SEED, 1, Purpose::Range, "PSD_FRONU", 0)),
    ];
    for (what, other) in &others {
        passes(what, uncorrelated(&base, other));
        // Independence requires uncorrelated squares as well.
        let square = |sample: &[f64]| sample.iter().map(|z| z * z).collect::<Vec<_>>();
        passes(&format!("{what}, squares"), uncorrelated(&square(&base), &square(other)));
    }
    let events = events(Purpose::Range, "PSD_FRONT");
    let in_turn: Vec<(f64, f64)> = (0..PAIRS)
        .map(|index| {
            let mut stream = events.at(index);
            (stream.normal(), stream.normal())
        })
        .collect();
    let (first, second): (Vec<f64>, Vec<f64>) = in_turn.into_iter().unzip();
    passes("two numbers of one event", uncorrelated(&first, &second));
}

/// Readings for the true distance `exact`, without drop-outs.
fn readings(errors: &RangeErrors, count: u64, exact: f64) -> Vec<f64> {
    (0..count).filter_map(|index| errors.reading(index, Time::ZERO, WIDE, Some(exact))).collect()
}

fn sensor(model: RangeNoise) -> RangeErrors {
    RangeErrors::new(model, SEED, ROBOT, "PSD_FRONT")
}

#[test]
fn readings_are_normal_about_the_distance() {
    for exact in [5.0_f64, 50.0] {
        let model =
            RangeNoise { sigma: 0.003, sigma_share: 0.001, sigma_square: 0.000_1, bias: 0.01, ..RangeNoise::default() };
        let parts = [model.sigma, model.sigma_share * exact, model.sigma_square * exact * exact];
        let sigma = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let mut sample = readings(&sensor(model), MILLION, exact);
        passes(&format!("at {exact} m"), normality(&mut sample, exact + 0.01, sigma));
    }
}

#[test]
fn steps_have_the_probabilities_of_their_cells() {
    let model = RangeNoise { sigma: 0.02, step: 0.01, ..RangeNoise::default() };
    let sample = readings(&sensor(model), MILLION, 5.003);
    passes("steps", cells(&sample, 0.01, |x| normal_cdf((x - 5.003) / 0.02)));
}

/// p-value of a sample that consists of numbers of the distribution `cdf` rounded to multiples of `step`.
fn cells(sample: &[f64], step: f64, cdf: impl Fn(f64) -> f64) -> f64 {
    let place = |x: f64| (x / step).round() as i64;
    let [low, high] =
        [sample.iter().copied().fold(f64::INFINITY, f64::min), sample.iter().copied().fold(0.0, f64::max)];
    let (low, high) = (place(low), place(high));
    let mut counts = vec![0.0; (high - low + 1) as usize];
    for x in sample {
        assert!((x - place(*x) as f64 * step).abs() < 1e-9, "{x} is no multiple of {step}");
        counts[(place(*x) - low) as usize] += 1.0;
    }
    let edge = |place: i64| (place as f64 - 0.5) * step;
    let share = |place: i64| {
        let below = if place == low { 0.0 } else { cdf(edge(place)) };
        let above = if place == high { 1.0 } else { cdf(edge(place + 1)) };
        (above - below) * sample.len() as f64
    };
    chi_squared(&counts, &(low..=high).map(share).collect::<Vec<_>>())
}

#[test]
fn outliers_and_drop_outs_come_as_often_as_they_say() {
    let model = RangeNoise { outlier: 0.01, dropout: 0.003, ..RangeNoise::default() };
    let errors = sensor(model);
    let (mut none, mut strays) = (0, Vec::new());
    for index in 0..MILLION {
        match errors.reading(index, Time::ZERO, WIDE, Some(5.0)) {
            None => none += 1,
            Some(5.0) => {}
            Some(stray) => strays.push(stray),
        }
    }
    passes("drop-outs", binomial(none, MILLION, 0.003));
    passes("outliers", binomial(strays.len() as u64, MILLION - none, 0.01));
    passes("where they are", kolmogorov(&mut strays, |x| x / 100.0));
}

#[test]
fn the_bias_of_the_making_is_normal_between_sensors() {
    let model = RangeNoise { bias: 0.01, bias_sigma: 0.005, ..RangeNoise::default() };
    let offset = |name: u64| {
        let errors = RangeErrors::new(model, SEED, RobotId(1 + (name % 100) as u32), &format!("S{}", name / 100));
        errors.reading(0, Time::ZERO, WIDE, Some(5.0)).expect("a distance") - 5.0
    };
    let mut sample: Vec<f64> = (0..MILLION).map(offset).collect();
    passes("bias", normality(&mut sample, 0.01, 0.005));
}

#[test]
fn the_noise_of_the_sensor_itself_is_that_of_the_paper() {
    let errors = sensor(RangeNoise { device: 1.0, ..RangeNoise::default() });
    let mut sample: Vec<f64> = (0..MILLION).map(|index| errors.device_noise(index, 0.01, 0.002)).collect();
    passes("N = sigma G + m", normality(&mut sample, 0.002, 0.01));
    let half = sensor(RangeNoise { device: 0.5, ..RangeNoise::default() });
    assert_eq!(half.device_noise(7, 0.01, 0.002), 0.5 * errors.device_noise(7, 0.01, 0.002));
}

#[test]
fn a_drift_moves_the_mean_alone() {
    let errors = sensor(RangeNoise { sigma: 0.01, drift: 0.1, drift_time: 30.0, ..RangeNoise::default() });
    let at = Time::from_millis(45_000);
    let sample = (0..MILLION).filter_map(|index| errors.reading(index, at, WIDE, Some(5.0)));
    passes(
        "at 1.5 time constants",
        normality(&mut sample.collect::<Vec<_>>(), 5.0 + 0.1 * 0.223_130_160_148_429_83, 0.01),
    );
}

#[test]
fn every_kind_of_every_preset_reads_as_it_says() {
    // Near enough that no reading is clamped, although the standard deviation may grow with the square of the distance.
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
            // At the start of the run the drift has its full size. A model with `bias_sigma` alone shows the sensor's own bias.
            let made = sensor(RangeNoise { bias_sigma: model.bias_sigma, ..RangeNoise::default() });
            let offset = made.reading(0, Time::ZERO, WIDE, Some(0.5)).expect("a distance") - 0.5;
            let (mean, sigma) = (EXACT + model.bias + offset + model.drift, model.sigma_at(EXACT));
            let sample = readings(&errors, MILLION, EXACT);
            let count = sample.len() as u64;
            passes(&format!("{what}: drop-outs"), binomial(MILLION - count, MILLION, model.dropout));
            if model.device > 0.0 {
                let mut own: Vec<f64> = (0..MILLION).map(|index| errors.device_noise(index, 0.01, 0.0)).collect();
                passes(&format!("{what}: noise of its own"), normality(&mut own, 0.0, 0.01 * model.device));
            }
            if sigma == 0.0 {
                let reading = if model.step > 0.0 { (mean / model.step).round() * model.step } else { mean };
                let mut strays: Vec<f64> = sample.into_iter().filter(|read| (read - reading).abs() > 1e-12).collect();
                passes(&format!("{what}: outliers"), binomial(strays.len() as u64, count, model.outlier));
                if !strays.is_empty() {
                    // The step is at most a thousandth of the range.
                    let moments = Moments::of(&strays);
                    passes(&format!("{what}: mean of outliers"), moments.mean_is(50.0, 1e4 / 12.0));
                    passes(&format!("{what}: where outliers are"), kolmogorov(&mut strays, |x| x / 100.0));
                }
                continue;
            }
            let cdf = |x: f64| (1.0 - model.outlier) * normal_cdf((x - mean) / sigma) + model.outlier * x / 100.0;
            // Rounding adds a twelfth of the squared step to the variance if the step is no coarser than the noise.
            let strays = model.outlier * (50.0 - mean);
            let variance = (1.0 - model.outlier) * (sigma * sigma + strays.powi(2))
                + model.outlier * (100.0 * 100.0 / 12.0 + (50.0 - mean - strays).powi(2));
            let moments = Moments::of(&sample);
            if sigma > model.step {
                let rounding = model.step * model.step / 12.0;
                passes(&format!("{what}: mean"), moments.mean_is(mean + strays, variance + rounding));
                passes(&format!("{what}: variance"), moments.variance_is(variance + rounding));
            }
            let of_distribution =
                if model.step > 0.0 { cells(&sample, model.step, cdf) } else { kolmogorov(&mut sample.clone(), cdf) };
            passes(&format!("{what}: distribution"), of_distribution);
        }
    }
}

/// Published bounds of the error of a single reading of a Sharp GP2Y0A21, at 3.09 standard deviations: distance and bound, m. Source:
/// Malheiros, Gonçalves & Costa 2009.
const SHARP: [(f64, f64); 2] = [(0.08, 0.0025), (0.8, 0.1854)];
/// Distance, m, at which the manufacturer's bound of a SRF08, m, is compared.
const SRF08: (f64, f64) = (3.0, 0.04);

/// Share of normal errors beyond `bound`, in percent.
fn percent_beyond(bound: f64, sigma: f64) -> f64 {
    if sigma == 0.0 { 0.0 } else { 200.0 * normal_cdf(-bound / sigma) }
}

/// Log-likelihood that a reading with the standard deviation `published` loses on average under a model with `sigma`, in nats: the
/// Kullback-Leibler divergence of two normal distributions with one mean.
fn nats_lost(published: f64, sigma: f64) -> f64 {
    ln(sigma / published) + 0.5 * (published / sigma).powi(2) - 0.5
}

#[test]
fn the_table_of_published_figures_is_that_of_the_presets() {
    let page = include_str!("../../docs/noise.md");
    let bounds = |sigmas: [f64; 2]| {
        let shares = [0, 1].map(|at| percent_beyond(SHARP[at].1, sigmas[at]));
        format!("{:.1} mm, {:.1} mm | {:.1} %, {:.1} %", 1e3 * sigmas[0], 1e3 * sigmas[1], shares[0], shares[1])
    };
    let published = SHARP.map(|(_, bound)| bound / 3.09);
    let mut lines = vec![format!("| published | {} | 0, 0 | few |", bounds(published))];
    for preset in presets().skip(1) {
        let profile = preset.profile();
        let sigmas = SHARP.map(|(distance, _)| profile.range(RangeKind::Psd, "").sigma_at(distance));
        let lost = [0, 1].map(|at| nats_lost(published[at], sigmas[at]));
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
fn a_share_beyond_a_bound_and_a_lost_likelihood_are_those_of_a_sample() {
    // A model of half the true standard deviation.
    let (published, sigma) = (0.06, 0.03);
    let sample = readings(&sensor(RangeNoise { sigma: published, ..RangeNoise::default() }), MILLION, 5.0);
    let beyond = sample.iter().filter(|read| (*read - 5.0).abs() > 0.1).count() as u64;
    passes("share", binomial(beyond, MILLION, percent_beyond(0.1, published) / 100.0));
    let log_density = |z: f64, sigma: f64| -0.5 * (z / sigma).powi(2) - ln(sigma);
    let lost = sample.iter().map(|read| log_density(read - 5.0, published) - log_density(read - 5.0, sigma));
    let mean = lost.sum::<f64>() / MILLION as f64;
    // Four standard errors of the mean: the terms have a variance of (0.5 (4 - 1))^2 * 2.
    assert!((mean - nats_lost(published, sigma)).abs() < 4.0 * 2.13e-3, "{mean}");
}

#[test]
fn compasses_of_every_preset_read_as_they_say() {
    for preset in presets().skip(1) {
        let model = preset.profile().compass;
        let smooth = CompassNoise { step: 0.0, bias_sigma: 0.0, ..model };
        let errors = CompassErrors::new(smooth, SEED, ROBOT, "COMPASS");
        let mut sample: Vec<f64> = (0..MILLION).map(|index| errors.reading(index, 1.0)).collect();
        passes(preset.name, normality(&mut sample, 1.0 + model.bias, model.sigma));
        let stepped = CompassErrors::new(CompassNoise { bias_sigma: 0.0, ..model }, SEED, ROBOT, "COMPASS");
        let sample: Vec<f64> = (0..MILLION).map(|index| stepped.reading(index, 1.0)).collect();
        passes(preset.name, cells(&sample, model.step, |x| normal_cdf((x - 1.0 - model.bias) / model.sigma)));
    }
}

#[test]
fn the_bias_of_the_making_is_normal_between_compasses() {
    let model = CompassNoise { bias: 0.02, bias_sigma: 0.05, ..CompassNoise::default() };
    let offset = |robot| CompassErrors::new(model, SEED, RobotId(robot), "COMPASS").reading(0, 1.0) - 1.0;
    let mut sample: Vec<f64> = (1..=1_000_000).map(offset).collect();
    passes("bias", normality(&mut sample, 0.02, 0.05));
}

#[test]
fn images_of_every_preset_are_as_they_say() {
    const GREY: u8 = 128;
    let of_presets = presets().skip(1).map(|preset| preset.profile().camera);
    let all = ImageNoise { blur: 2.0, sigma: 10.0, salt_and_pepper: 0.02, salt: 0.3, hundreds_and_thousands: 0.03 };
    let count = 1_000_000;
    for model in of_presets.chain([all]) {
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
        passes("levels", cells(&levels, 1.0, cdf));
        let moments = Moments::of(&levels);
        let variance = model.sigma * model.sigma + 1.0 / 12.0;
        passes("mean", moments.mean_is(GREY.into(), variance));
        passes("variance", moments.variance_is(variance));
        let pixels = frame(ImageNoise { sigma: 0.0, hundreds_and_thousands: 0.0, ..model });
        let hits = |colour: [u8; 3]| pixels.iter().filter(|pixel| **pixel == colour).count() as u64;
        let (salt, pepper) = (hits([255; 3]), hits([0; 3]));
        passes("salt and pepper", binomial(salt + pepper, MILLION, model.salt_and_pepper));
        passes("salt", binomial(salt, salt + pepper, model.salt));
        let pixels = frame(ImageNoise { sigma: 0.0, salt_and_pepper: 0.0, ..model });
        let coloured: Vec<[u8; 3]> = pixels.into_iter().filter(|pixel| *pixel != [GREY; 3]).collect();
        passes("hundreds and thousands", binomial(coloured.len() as u64, MILLION, model.hundreds_and_thousands));
        if coloured.len() > 1000 {
            for channel in 0..3 {
                let mut counts = [0.0; 256];
                coloured.iter().for_each(|pixel| counts[usize::from(pixel[channel])] += 1.0);
                passes("colours", chi_squared(&counts, &[coloured.len() as f64 / 256.0; 256]));
            }
        }
    }
}

/// exp(-t) I_0(t) by its power series: the central weight of a discrete Gaussian of variance t.
fn middle_weight(t: f64) -> f64 {
    let mut term = sim_core::math::exp(-t);
    let mut sum = 0.0;
    for k in 1..100 {
        sum += term;
        term *= (0.5 * t / f64::from(k)) * (0.5 * t / f64::from(k));
    }
    sum
}

#[test]
fn the_blur_of_every_preset_is_as_it_says() {
    const DEVIATION: f64 = 30.0;
    let of_presets = presets().map(|preset| preset.profile().camera.blur);
    for blur in of_presets.chain([2.0, 5.0]) {
        // A filter scales the variance of white noise by the sum of its squared weights in each direction; for a discrete Gaussian that
        // sum is the central weight of a Gaussian of twice the variance.
        let white = ImageNoise { sigma: DEVIATION, ..ImageNoise::default() };
        let mut pixels = vec![[128_u8]; 1_000_000];
        ImageErrors::new(white, SEED, ROBOT, "CAMERA").expose(0, 1000, &mut pixels);
        let model = ImageNoise { blur, ..ImageNoise::default() };
        ImageErrors::new(model, SEED, ROBOT, "CAMERA").expose(0, 1000, &mut pixels);
        let levels: Vec<f64> = pixels.as_flattened().iter().map(|level| f64::from(*level)).collect();
        let share = middle_weight(2.0 * blur * blur);
        let rounding = 1.0 / 12.0;
        let expected = (DEVIATION * DEVIATION + rounding) * share * share + if blur > 0.0 { rounding } else { 0.0 };
        // Five standard deviations of the variance of this many pixels, of which neighbours are correlated.
        let independent = 1e6 / (std::f64::consts::TAU * blur * blur).max(1.0);
        let tolerance = 5.0 * (2.0 / independent).sqrt();
        let Moments { mean, variance, .. } = Moments::of(&levels);
        assert!((mean - 128.0).abs() < 0.2, "blur {blur}: mean {mean}");
        assert!((variance / expected - 1.0).abs() < tolerance, "blur {blur}: variance {variance}, not {expected}");
    }
}

#[test]
fn wheels_of_every_preset_are_as_they_say() {
    for preset in presets().skip(1) {
        let motion: MotionNoise = preset.profile().motion;
        let of = |robot| motion.imperfection(DriveKind::Omni, SEED, RobotId(robot)).diameters;
        let mut sample: Vec<f64> = (1..=250_000).flat_map(of).collect();
        passes(preset.name, normality(&mut sample, motion.left, motion.diameter_sigma));
    }
}

/// Commanded twist for 1e6 ticks.
const ORDER: Twist = Twist { vx: 0.2, vy: 0.0, omega: 1.0 };
const TRACK: f64 = 0.1;

/// True and odometric twists of each tick of 100 robots that follow `order` for 10,000 ticks.
fn ticks(kind: DriveKind, order: Twist, imperfection: Imperfection) -> [Vec<Twist>; 2] {
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
    let [mut truth, mut belief] = [Vec::new(), Vec::new()];
    for robot in 1..=100 {
        let motion = drive::Motion::new(RobotId(robot), Arc::clone(&model), Arc::clone(&walls), Pose::default());
        let mut motion = motion.with_imperfection(SEED, imperfection).expect("a sound imperfection");
        motion.command(Time::ZERO, Command::Twist(order), &[]).expect("a sound command");
        let mut before = motion.pose(Time::ZERO);
        for tick in 0..10_000 {
            belief.push(motion.speed(Time(tick * TICK.0)));
            let after = motion.pose(Time((tick + 1) * TICK.0));
            truth.push(twist_between(before, after));
            before = after;
        }
    }
    [truth, belief]
}

/// Constant twist that leads from one pose to another in a tick.
fn twist_between(before: Pose, after: Pose) -> Twist {
    let angle = after.heading.radians() - before.heading.radians();
    let half = 0.5 * angle;
    // Chord of the arc, in the direction of the mean heading.
    let stretch = if half == 0.0 { 1.0 } else { half / sin(half) };
    let way = before.heading.turned(half).direction();
    let chord = after.position - before.position;
    Twist { vx: chord.dot(way) * stretch, vy: way.perp_dot(chord) * stretch, omega: angle }.scaled(1.0 / TICK.seconds())
}

/// Checks that twists are normal about `mean` with the deviations of `noise`, and their components independent.
fn check_twists(what: &str, twists: &[Twist], mean: Twist, noise: TwistNoise) {
    let of = |part: fn(&Twist) -> f64| twists.iter().map(part).collect::<Vec<_>>();
    let speed = |x: f64| hypot(noise.speed, noise.speed_share * x);
    let turning = hypot(noise.turn, noise.turn_share * mean.omega);
    let (ahead, aside, turn) = (of(|twist| twist.vx), of(|twist| twist.vy), of(|twist| twist.omega));
    for (part, sample, mean, sigma) in
        [("speed", &ahead, mean.vx, speed(mean.vx)), ("turning speed", &turn, mean.omega, turning)]
    {
        if sigma > 0.0 {
            passes(&format!("{what}: {part} of two ticks"), uncorrelated(&sample[1..], &sample[..sample.len() - 1]));
            passes(&format!("{what}: {part}"), normality(&mut sample.clone(), mean, sigma));
        } else {
            assert!(sample.iter().all(|x| (x - mean).abs() < 1e-9), "{what}: {part}");
        }
    }
    if speed(mean.vx) > 0.0 && turning > 0.0 {
        passes(&format!("{what}: speed and turning speed"), uncorrelated(&ahead, &turn));
    }
    if mean.vy != 0.0 {
        passes(&format!("{what}: speed aside"), normality(&mut aside.clone(), mean.vy, speed(mean.vy)));
    } else {
        assert!(aside.iter().all(|speed| speed.abs() < 1e-9), "{what}: nothing moves it aside");
    }
}

#[test]
fn drives_and_odometry_of_every_preset_err_as_they_say() {
    for preset in presets() {
        let MotionNoise { command, odometry, .. } = preset.profile().motion;
        let [truth, belief] =
            ticks(DriveKind::Differential, ORDER, Imperfection { command, odometry, ..Imperfection::default() });
        check_twists(&format!("command of {}", preset.name), &truth, ORDER, command);
        check_twists(&format!("odometry of {}", preset.name), &belief, ORDER, odometry);
        let (ways, beliefs): (Vec<f64>, Vec<f64>) =
            truth.iter().zip(&belief).map(|(truth, belief)| (truth.vx, belief.vx)).unzip();
        if odometry != TwistNoise::default() {
            passes("command and odometry", uncorrelated(&ways, &beliefs));
        }
    }
}

#[test]
fn twists_of_an_omni_drive_err_along_all_axes() {
    let command = TwistNoise { speed: 0.02, speed_share: 0.05, turn: 0.1, turn_share: 0.05 };
    let odometry = TwistNoise { speed: 0.01, speed_share: 0.2, turn: 0.3, turn_share: 0.0 };
    let order = Twist { vy: -0.3, ..ORDER };
    let [truth, belief] = ticks(DriveKind::Omni, order, Imperfection { command, odometry, ..Imperfection::default() });
    check_twists("command", &truth, order, command);
    check_twists("odometry", &belief, order, odometry);
}

#[test]
fn wheels_of_every_preset_slip_as_they_say() {
    for preset in presets() {
        let MotionNoise { slip, slip_sigma, .. } = preset.profile().motion;
        if slip_sigma == 0.0 {
            assert_eq!(slip, 0.0, "{}", preset.name);
            continue;
        }
        let imperfection = Imperfection { slip, slip_deviation: slip_sigma, ..Imperfection::default() };
        let [truth, belief] = ticks(DriveKind::Differential, ORDER, imperfection);
        assert!(belief.iter().all(|twist| *twist == belief[0]), "encoders count the wheels");
        let [mut left, mut right] = [-0.5 * TRACK, 0.5 * TRACK].map(|y| {
            let of = |twist: &Twist| twist.vx + y * twist.omega;
            truth.iter().map(|twist| 1.0 - of(twist) / of(&ORDER)).collect::<Vec<_>>()
        });
        passes("left and right", uncorrelated(&left, &right));
        passes(&format!("left wheel of {}", preset.name), normality(&mut left, slip, slip_sigma));
        passes(&format!("right wheel of {}", preset.name), normality(&mut right, slip, slip_sigma));
    }
}
