//! `camera-noise`: mean of each colour channel and pooled standard deviation of all channels over many pictures with
//! noise, compared with the closed forms of the noise model.
//!
//! The picture without noise shows the room with its shadows. The closed form blurs it with a separately computed
//! kernel (power series of the Bessel functions). It then computes mean and standard deviation of each channel as sums
//! over the 256 levels, weighted with their probabilities. The distribution of the levels is the normal distribution,
//! rounded and clamped, mixed with salt and pepper and with random colours. If the simulator's noise has this
//! distribution, the errors fall as 1 / sqrt(n) with the number n of pictures; otherwise they stop falling.

use std::f64::consts::PI;
use std::time::Instant;

use sim_core::RobotId;
use sim_core::camera::{Camera, Lens, Picture, View};
use sim_core::math;
use sim_core::noise::{ImageErrors, ImageNoise};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study};
use crate::figure::{Figure, Mark, Scale, Series};
use crate::room;
use crate::statistics::normal_cdf;
use crate::world;

pub const STUDY: Study = Study {
    name: "camera-noise",
    title: "Mean and spread of pixels over many pictures, against the noise model's closed form",
    run,
};

/// Noise of the presets `real` and `harsh`; a test compares them with the presets.
pub const MODELS: [(&str, ImageNoise); 2] = [
    ("real", ImageNoise { blur: 0.6, sigma: 4.0, salt_and_pepper: 0.000_5, salt: 0.5, hundreds_and_thousands: 0.0 }),
    ("harsh", ImageNoise { blur: 1.5, sigma: 12.0, salt_and_pepper: 0.01, salt: 0.5, hundreds_and_thousands: 0.005 }),
];
/// Numbers of pictures; each series begins with all pictures of the previous series.
const COUNTS: [u64; 4] = [1, 10, 100, 1_000];
const SIZE: [u32; 2] = [80, 60];
const SEED: u64 = 264_001;

fn run(_: Effort) -> Outcome {
    let exact = exact_picture();
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (name, model) in MODELS {
        let measured = measure(&exact, model);
        for (quantity, errors, expected) in [
            ("mean of each channel", measured.map(|errors| errors.mean), measured.map(|errors| errors.expected_mean)),
            (
                "deviation of all channels",
                measured.map(|errors| errors.sigma),
                measured.map(|errors| errors.expected_sigma),
            ),
        ] {
            // One picture has no standard deviation.
            let first = usize::from(quantity.starts_with("deviation"));
            let method = format!("{quantity}, `{name}`");
            let points =
                |values: [f64; COUNTS.len()]| COUNTS.map(|count| count as f64).into_iter().zip(values).skip(first);
            series.push(Series { name: method.clone(), mark: Mark::LineAndDots, points: points(errors).collect() });
            let line = points(expected).collect();
            series.push(Series { name: format!("{method}, expected"), mark: Mark::Line, points: line });
            for index in first..COUNTS.len() {
                rows.push(Row {
                    study: STUDY.name,
                    method: method.clone(),
                    setting: match COUNTS[index] {
                        1 => "1 picture".to_owned(),
                        count => format!("{count} pictures"),
                    },
                    error: errors[index],
                    unit: "grey levels",
                    time_ns: measured[index].time_ns,
                    per: "series of pictures",
                });
            }
        }
    }
    let figure = Figure {
        name: "camera-noise-pictures".to_owned(),
        title: "Error of a pixel's mean and standard deviation".to_owned(),
        x_label: "pictures".to_owned(),
        y_label: "error, grey levels".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

/// A view of the room, with shadows and without noise.
fn exact_picture() -> Picture<[u8; 3]> {
    let scenery = room::scenery(room::light());
    let posed = scenery.pose_at(&world::empty(), Time::ZERO);
    let stand = room::stands(1)[0];
    let view = View::new(stand.pose(), Lens::Pinhole { fov: room::FIELD }, SIZE).expect("a view of the room");
    Camera::default().colour(&posed, &view, None, 2)
}

/// Differences of the measured moments after a number of pictures from the closed form, in grey levels.
#[derive(Clone, Copy, Debug, Default)]
struct MomentErrors {
    /// Root mean square error of the channels' means.
    mean: f64,
    /// Expected value of `mean` if the noise has the distribution of the closed form.
    expected_mean: f64,
    /// Error of the standard deviation, pooled over all channels.
    sigma: f64,
    /// Expected value of `sigma` if the noise has the distribution of the closed form.
    expected_sigma: f64,
    /// Computing time of the noise in all these pictures, ns.
    time_ns: f64,
}

/// Errors of the moments after each number of pictures in [`COUNTS`].
fn measure(exact: &Picture<[u8; 3]>, model: ImageNoise) -> [MomentErrors; COUNTS.len()] {
    let [width, _] = exact.size().map(|side| side as usize);
    let table: Vec<Moments> = (0..=255).map(|level| Moments::of(&model, level)).collect();
    let levels = blurred(model.blur, width, exact.pixels());
    let truth: Vec<&Moments> = levels.iter().map(|level| &table[usize::from(*level)]).collect();
    let errors = ImageErrors::new(model, SEED, RobotId(1), "CAMERA");
    let mut sums = vec![(0.0, 0.0); truth.len()];
    let mut frame = 0;
    let mut time_ns = 0.0;
    COUNTS.map(|count| {
        while frame < count {
            let mut picture = exact.pixels().to_vec();
            let start = Instant::now();
            errors.expose(frame, width, &mut picture);
            time_ns += start.elapsed().as_secs_f64() * 1e9;
            for ((sum, squares), level) in sums.iter_mut().zip(picture.as_flattened()) {
                let level = f64::from(*level);
                *sum += level;
                *squares += level * level;
            }
            frame += 1;
        }
        MomentErrors { time_ns, ..moment_errors(&sums, &truth, count as f64) }
    })
}

fn moment_errors(sums: &[(f64, f64)], truth: &[&Moments], count: f64) -> MomentErrors {
    let channels = truth.len() as f64;
    let mean_over_channels = |term: &dyn Fn(f64, f64, &Moments) -> f64| {
        let terms = sums.iter().zip(truth).map(|((sum, squares), truth)| term(*sum, *squares, truth));
        terms.sum::<f64>() / channels
    };
    let mean = mean_over_channels(&|sum, _, truth| (sum / count - truth.mean) * (sum / count - truth.mean)).sqrt();
    let variance = mean_over_channels(&|_, _, truth| truth.variance);
    let expected_mean = (variance / count).sqrt();
    if count == 1.0 {
        return MomentErrors { mean, expected_mean, ..MomentErrors::default() };
    }
    let measured_variance = mean_over_channels(&|sum, squares, _| (squares - sum * sum / count) / (count - 1.0));
    // Variance of a channel's sample variance.
    let variance_of_variance =
        |truth: &Moments| (truth.fourth - truth.variance * truth.variance * (count - 3.0) / (count - 1.0)) / count;
    let pooled_error = (mean_over_channels(&|_, _, truth| variance_of_variance(truth)) / channels).sqrt();
    // The mean magnitude of a normally distributed error is sqrt(2 / pi) times its standard deviation.
    let mean_magnitude = (2.0 / PI).sqrt() * pooled_error;
    MomentErrors {
        mean,
        expected_mean,
        sigma: (measured_variance.sqrt() - variance.sqrt()).abs(),
        expected_sigma: mean_magnitude / (2.0 * variance.sqrt()),
        time_ns: 0.0,
    }
}

/// Mean, variance and fourth central moment of the level of a channel with noise, in grey levels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moments {
    mean: f64,
    variance: f64,
    fourth: f64,
}

impl Moments {
    /// Closed form for a channel whose level after the blur is `level`.
    fn of(model: &ImageNoise, level: u8) -> Self {
        let level = f64::from(level);
        // The level is k if the normally distributed value is within half a level of k; the lowest and the highest
        // level include the tails.
        let below = |edge: f64| normal_cdf((edge - level) / model.sigma);
        let normal = |k: f64| {
            let high = if k == 255.0 { 1.0 } else { below(k + 0.5) };
            high - if k == 0.0 { 0.0 } else { below(k - 0.5) }
        };
        let extremes = |k: f64| match k {
            0.0 => 1.0 - model.salt,
            255.0 => model.salt,
            _ => 0.0,
        };
        let (hit, random) = (model.salt_and_pepper, model.hundreds_and_thousands);
        let probability = |k: f64| (1.0 - random) * ((1.0 - hit) * normal(k) + hit * extremes(k)) + random / 256.0;
        let expectation =
            |term: &dyn Fn(f64) -> f64| (0..=255).map(|k| probability(k.into()) * term(k.into())).sum::<f64>();
        let mean = expectation(&|k| k);
        let squared = |k: f64| (k - mean) * (k - mean);
        Self { mean, variance: expectation(&squared), fourth: expectation(&|k| squared(k) * squared(k)) }
    }
}

/// Levels of all channels after the blur, computed in double precision from the documented formula.
///
/// The weights are exp(-t) I_n(t) with t = `sigma`^2, up to a distance n of four standard deviations (rounded up) plus
/// one pixel, scaled to the sum 1. Borders are mirrored.
fn blurred(sigma: f64, width: usize, pixels: &[[u8; 3]]) -> Vec<u8> {
    let radius = (4.0 * sigma).ceil() as i64 + 1;
    let half = 0.5 * sigma * sigma;
    // I_n(t) is the sum over k of (t / 2)^(2 k + n) / (k! (k + n)!).
    let bessel = |n: i64| {
        let mut term = (1..=n).map(|k| half / k as f64).product::<f64>();
        let mut sum = term;
        for k in 1..60 {
            term *= half * half / (k * (k + n)) as f64;
            sum += term;
        }
        sum
    };
    let weights: Vec<f64> = (-radius..=radius).map(|n| bessel(n.abs()) * math::exp(-2.0 * half)).collect();
    let weight_sum: f64 = weights.iter().sum();
    let height = pixels.len() / width;
    let mirrored = |index: i64, size: usize| {
        let index = index.rem_euclid(2 * size as i64) as usize;
        index.min(2 * size - 1 - index)
    };
    let (mut levels, mut rows) = (Vec::new(), Vec::new());
    for index in 0..pixels.len() {
        let (column, row) = ((index % width) as i64, index / width);
        rows.push([0, 1, 2].map(|channel| {
            let taps = weights.iter().zip(column - radius..);
            taps.map(|(weight, tap)| weight * f64::from(pixels[row * width + mirrored(tap, width)][channel]))
                .sum::<f64>()
        }));
    }
    for index in 0..pixels.len() {
        let (column, row) = (index % width, (index / width) as i64);
        levels.extend([0, 1, 2].map(|channel| {
            let taps = weights.iter().zip(row - radius..);
            let sum: f64 =
                taps.map(|(weight, tap)| weight * rows[mirrored(tap, height) * width + column][channel]).sum();
            (sum / (weight_sum * weight_sum)).round() as u8
        }));
    }
    levels
}

#[cfg(test)]
mod tests {
    use sim_core::noise::blur;

    use super::*;

    #[test]
    fn models_match_the_presets() {
        for (name, model) in MODELS {
            assert_eq!(sim_format::preset(name).expect("a preset").profile().camera, model, "{name}");
        }
    }

    #[test]
    fn moments_match_hand_computed_values() {
        let exact = ImageNoise { sigma: 1e-9, ..ImageNoise::default() };
        assert_eq!(Moments::of(&exact, 70), Moments { mean: 70.0, variance: 0.0, fourth: 0.0 });
        let salt = Moments::of(&ImageNoise { salt_and_pepper: 1.0, ..exact }, 70);
        assert!((salt.mean - 127.5).abs() < 1e-9 && (salt.variance - 127.5 * 127.5).abs() < 1e-6, "{salt:?}");
        let colours = Moments::of(&ImageNoise { hundreds_and_thousands: 1.0, ..exact }, 70);
        // The variance of a discrete uniform distribution is (256^2 - 1) / 12.
        assert!((colours.mean - 127.5).abs() < 1e-9 && (colours.variance - 5_461.25).abs() < 1e-6, "{colours:?}");
        // Rounding adds 1/12 to the variance; at the lowest level, half of the distribution is clamped.
        let middle = Moments::of(&ImageNoise { sigma: 4.0, ..exact }, 128);
        assert!((middle.variance - 16.0 - 1.0 / 12.0).abs() < 1e-6, "{middle:?}");
        let lowest = Moments::of(&ImageNoise { sigma: 4.0, ..exact }, 0).mean;
        assert!((lowest - 4.0 / std::f64::consts::TAU.sqrt()).abs() < 0.01, "{lowest}");
    }

    #[test]
    fn separately_computed_blur_matches_sim_core() {
        let exact = exact_picture();
        for (_, model) in MODELS {
            let expected = blurred(model.blur, SIZE[0] as usize, exact.pixels());
            let mut found = exact.pixels().to_vec();
            blur(model.blur, SIZE[0] as usize, &mut found);
            let differing =
                expected.iter().zip(found.as_flattened()).filter(|(expected, found)| expected != found).count();
            // In single precision, a sum near the middle between two levels may be rounded to the other level.
            assert!(differing < expected.len() / 1_000, "{differing} of {}", expected.len());
        }
    }

    #[test]
    fn errors_of_pixels_have_their_expected_size() {
        for (name, model) in MODELS {
            let found = measure(&exact_picture(), model)[2];
            // With 14,400 channels, the relative standard error is below 1 %, but larger with rare white and black
            // pixels.
            assert!((found.mean / found.expected_mean - 1.0).abs() < 0.05, "{name}: {found:?}");
        }
    }

    #[test]
    fn wrong_sigma_is_detected() {
        let (_, model) = MODELS[0];
        let wrong = ImageNoise { sigma: 1.03 * model.sigma, ..model };
        let table: Vec<Moments> = (0..=255).map(|level| Moments::of(&model, level)).collect();
        let difference = Moments::of(&wrong, 128).variance.sqrt() - table[128].variance.sqrt();
        let found = measure(&exact_picture(), model)[3];
        assert!(found.sigma < 0.3 * difference, "3 % of sigma is {difference} levels: {found:?}");
    }
}
