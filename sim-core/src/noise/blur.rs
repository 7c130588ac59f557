//! Blur of a lens.

/// Standard deviation below which no level changes, in pixels.
const MIN_SIGMA: f64 = 1e-3;

/// Filter weights of a row of pixels, from the middle to one side; both sides together sum to 1.
///
/// The discrete analogue of the Gaussian, exp(-t) I_n(t) with t = `sigma`^2: its variance is exactly `sigma`^2 for any `sigma`, and
/// blurring twice adds variances; a sampled Gaussian has neither property below one pixel. The weights are cut off beyond four standard
/// deviations and a pixel. Source: Lindeberg 1990, "Scale-space for discrete signals"; the modified Bessel functions I_n by Miller's
/// backward recurrence.
fn weights(sigma: f64) -> Vec<f32> {
    let t = sigma * sigma;
    let radius = (4.0 * sigma).ceil() as usize + 1;
    // Far enough out that the arbitrary start values of the recurrence have no influence.
    let first = 2 * radius + 10;
    let mut bessel = vec![0.0; first + 2];
    bessel[first] = 1.0;
    for n in (1..=first).rev() {
        bessel[n - 1] = bessel[n + 1] + 2.0 * n as f64 / t * bessel[n];
        if bessel[n - 1] > 1e100 {
            bessel.iter_mut().for_each(|value| *value *= 1e-100);
        }
    }
    bessel.truncate(radius + 1);
    let sum = bessel[0] + 2.0 * bessel[1..].iter().sum::<f64>();
    bessel.into_iter().map(|value| (value / sum) as f32).collect()
}

/// Blurs a picture of rows of `width` pixels with a Gaussian point spread function of standard deviation `sigma` in pixels;
/// the picture is mirrored at its borders.
///
/// Filters rows, then columns, in single precision, and rounds to levels at the end. A picture of one colour is unchanged.
///
/// # Panics
/// If the number of pixels is not a multiple of `width`.
pub fn blur<const CHANNELS: usize>(sigma: f64, width: usize, pixels: &mut [[u8; CHANNELS]]) {
    if sigma < MIN_SIGMA || pixels.is_empty() {
        return;
    }
    assert!(width > 0 && pixels.len().is_multiple_of(width), "whole rows");
    let height = pixels.len() / width;
    let weights = weights(sigma);
    let mut rows = Vec::with_capacity(pixels.len());
    let columns = mirrored(width, weights.len() - 1);
    for row in pixels.chunks_exact(width) {
        let sample = |column: usize| row[columns[column]].map(f32::from);
        rows.extend((0..width).map(|column| spread(&weights, column, sample)));
    }
    let order = mirrored(height, weights.len() - 1);
    for (row, out) in pixels.chunks_exact_mut(width).enumerate() {
        for (column, pixel) in out.iter_mut().enumerate() {
            let sample = |row: usize| rows[order[row] * width + column];
            // A conversion to an integer saturates.
            *pixel = spread(&weights, row, sample).map(|sample| sample.round() as u8);
        }
    }
}

/// Weighted sum of the levels around the pixel `at`; the argument of `level` counts from the start of the margin.
fn spread<const CHANNELS: usize>(
    weights: &[f32],
    at: usize,
    level: impl Fn(usize) -> [f32; CHANNELS],
) -> [f32; CHANNELS] {
    let middle = at + weights.len() - 1;
    let mut sum = level(middle).map(|level| level * weights[0]);
    for (distance, weight) in weights.iter().enumerate().skip(1) {
        let (before, behind) = (level(middle - distance), level(middle + distance));
        for channel in 0..CHANNELS {
            sum[channel] += (before[channel] + behind[channel]) * weight;
        }
    }
    sum
}

/// Indices 0 to `size` - 1 with a mirrored margin at both ends: ... 1 0 | 0 1 2 | 2 1 ...
fn mirrored(size: usize, margin: usize) -> Vec<usize> {
    let index = |at: usize| {
        // The first index is `margin` before 0; adding whole periods keeps the dividend positive.
        let at = (at + 2 * size * margin - margin) % (2 * size);
        at.min(2 * size - 1 - at)
    };
    (0..size + 2 * margin).map(index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_is_that_of_sigma() {
        for sigma in [0.05, 0.3, 0.6, 1.0, 2.5, 8.0] {
            let weights = weights(sigma);
            let sum: f64 = weights.iter().skip(1).map(|weight| 2.0 * f64::from(*weight)).sum();
            assert!((sum + f64::from(weights[0]) - 1.0).abs() < 1e-6, "{sigma}: {weights:?}");
            let variance: f64 =
                weights.iter().enumerate().map(|(n, weight)| 2.0 * (n * n) as f64 * f64::from(*weight)).sum();
            // The tolerance covers the tails beyond four standard deviations.
            assert!((variance / (sigma * sigma) - 1.0).abs() < 2e-3, "{sigma}: {variance}");
        }
    }

    #[test]
    fn weights_are_bessel_functions() {
        // exp(-1) I_n(1), Abramowitz & Stegun, table 9.8.
        let expected = [0.465_759_6, 0.207_910_4, 0.049_938_8, 0.008_155_3];
        for (weight, expected) in weights(1.0).iter().zip(expected) {
            assert!((weight - expected).abs() < 1e-5, "{weight} is not {expected}");
        }
    }

    #[test]
    fn one_colour_stays_as_it_is() {
        for sigma in [0.0, 0.5, 3.0, 20.0] {
            let mut pixels = vec![[17, 128, 255]; 7 * 3];
            blur(sigma, 7, &mut pixels);
            assert_eq!(pixels, vec![[17, 128, 255]; 7 * 3], "{sigma}");
        }
    }

    #[test]
    fn a_point_spreads_evenly_and_keeps_its_light() {
        let mut pixels = vec![[0_u8]; 41 * 31];
        pixels[15 * 41 + 20] = [255];
        blur(1.5, 41, &mut pixels);
        let at = |column: usize, row: usize| f64::from(pixels[row * 41 + column][0]);
        assert_eq!((at(17, 15), at(20, 12)), (at(23, 15), at(20, 18)));
        assert_eq!((at(18, 14), at(22, 16)), (at(19, 13), at(21, 17)), "round");
        let peak = f64::from(weights(1.5)[0]);
        assert!((at(20, 15) - 255.0 * peak * peak).abs() <= 0.5);
    }

    #[test]
    fn light_is_kept_at_the_border() {
        // A bright edge along the border of a dark picture: nothing leaves the picture.
        let (width, height) = (16, 9);
        let mut pixels = vec![[0_u8, 40]; width * height];
        (0..height).for_each(|row| pixels[row * width] = [250, 40]);
        blur(2.0, width, &mut pixels);
        let sum: f64 = pixels.iter().map(|pixel| f64::from(pixel[0])).sum();
        let expected = 250.0 * height as f64;
        assert!((sum - expected).abs() <= 0.5 * (width * height) as f64, "{sum} is not {expected}");
        assert!(pixels.iter().all(|pixel| pixel[1] == 40));
        let row: Vec<u8> = pixels[..width].iter().map(|pixel| pixel[0]).collect();
        assert!(row.is_sorted_by(|a, b| a >= b) && row[0] > 80, "{row:?}");
    }

    #[test]
    fn a_picture_smaller_than_the_spread_becomes_even() {
        let mut pixels = [[0_u8], [100]];
        blur(10.0, 1, &mut pixels);
        assert!(pixels[0][0].abs_diff(50) <= 1 && pixels[1][0].abs_diff(50) <= 1, "{pixels:?}");
        let mut none: [[u8; 3]; 0] = [];
        blur(1.0, 5, &mut none);
    }

    #[test]
    fn blurring_twice_adds_variances() {
        let mut once: Vec<[u8; 1]> = (0..64 * 64).map(|at| [(at * 37 % 256) as u8]).collect();
        let mut twice = once.clone();
        blur(1.0, 64, &mut once);
        blur(0.6, 64, &mut twice);
        blur(0.8, 64, &mut twice);
        // Each blur rounds to levels.
        assert!(once.iter().zip(&twice).all(|(a, b)| a[0].abs_diff(b[0]) <= 1));
    }
}
