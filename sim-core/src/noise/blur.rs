//! Lens blur: convolves an image with a discrete Gaussian.

/// Standard deviation in pixels below which the blur changes no pixel.
const MIN_SIGMA: f64 = 1e-3;

/// Filter weights from the central pixel to one side. The weights of the whole filter, both sides and the centre, sum
/// to 1.
///
/// The weight at a distance of n pixels is exp(-t) I_n(t), where t = `sigma`^2 and I_n is the modified Bessel function
/// of the first kind. This is the discrete analogue of the Gaussian. Its variance is exactly `sigma`^2 for any `sigma`,
/// and blurring twice adds variances; a sampled Gaussian has neither property for a `sigma` below one pixel. The filter
/// ends four standard deviations and one pixel from its centre. I_n is computed by Miller's backward recurrence.
/// Source: Lindeberg 1990, "Scale-space for discrete signals".
fn weights(sigma: f64) -> Vec<f32> {
    let t = sigma * sigma;
    let radius = (4.0 * sigma).ceil() as usize + 1;
    // `start` is so large that the arbitrary start values of the recurrence have no influence.
    let start = 2 * radius + 10;
    let mut bessel = vec![0.0; start + 2];
    bessel[start] = 1.0;
    for n in (1..=start).rev() {
        bessel[n - 1] = bessel[n + 1] + 2.0 * n as f64 / t * bessel[n];
        if bessel[n - 1] > 1e100 {
            bessel.iter_mut().for_each(|value| *value *= 1e-100);
        }
    }
    bessel.truncate(radius + 1);
    let sum = bessel[0] + 2.0 * bessel[1..].iter().sum::<f64>();
    bessel.into_iter().map(|value| (value / sum) as f32).collect()
}

/// Blurs a picture with a Gaussian point spread function of standard deviation `sigma` in pixels. The rows of the
/// picture have `width` pixels; the picture is mirrored at its borders.
///
/// Filters rows, then columns, in single precision, and rounds the result to whole levels. A picture of one colour is
/// unchanged.
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
    let mut filtered_rows = Vec::with_capacity(pixels.len());
    let mirrored_columns = mirrored(width, weights.len() - 1);
    for row in pixels.chunks_exact(width) {
        let sample = |column: usize| row[mirrored_columns[column]].map(f32::from);
        filtered_rows.extend((0..width).map(|column| filtered(&weights, column, sample)));
    }
    let mirrored_rows = mirrored(height, weights.len() - 1);
    for (row, out) in pixels.chunks_exact_mut(width).enumerate() {
        for (column, pixel) in out.iter_mut().enumerate() {
            let sample = |row: usize| filtered_rows[mirrored_rows[row] * width + column];
            // The conversion to `u8` saturates.
            *pixel = filtered(&weights, row, sample).map(|sample| sample.round() as u8);
        }
    }
}

/// Weighted sum of the levels around the pixel `pixel` of a row or column; `level` takes an index from the start of the
/// margin.
fn filtered<const CHANNELS: usize>(
    weights: &[f32],
    pixel: usize,
    level: impl Fn(usize) -> [f32; CHANNELS],
) -> [f32; CHANNELS] {
    let middle = pixel + weights.len() - 1;
    let mut sum = level(middle).map(|level| level * weights[0]);
    for (distance, weight) in weights.iter().enumerate().skip(1) {
        let (left, right) = (level(middle - distance), level(middle + distance));
        for channel in 0..CHANNELS {
            sum[channel] += (left[channel] + right[channel]) * weight;
        }
    }
    sum
}

/// Indices 0 to `size` - 1 with a mirrored margin at both ends: ... 1 0 | 0 1 2 | 2 1 ...
fn mirrored(size: usize, margin: usize) -> Vec<usize> {
    let index = |position: usize| {
        // Position 0 is `margin` pixels before index 0; adding whole periods keeps the dividend positive.
        let phase = (position + 2 * size * margin - margin) % (2 * size);
        phase.min(2 * size - 1 - phase)
    };
    (0..size + 2 * margin).map(index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_of_weights_is_sigma_squared() {
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
    fn weights_match_tabulated_bessel_functions() {
        // exp(-1) I_n(1), Abramowitz & Stegun, table 9.8.
        let expected = [0.465_759_6, 0.207_910_4, 0.049_938_8, 0.008_155_3];
        for (weight, expected) in weights(1.0).iter().zip(expected) {
            assert!((weight - expected).abs() < 1e-5, "{weight} is not {expected}");
        }
    }

    #[test]
    fn picture_of_one_colour_is_unchanged() {
        for sigma in [0.0, 0.5, 3.0, 20.0] {
            let mut pixels = vec![[17, 128, 255]; 7 * 3];
            blur(sigma, 7, &mut pixels);
            assert_eq!(pixels, vec![[17, 128, 255]; 7 * 3], "{sigma}");
        }
    }

    #[test]
    fn point_becomes_a_round_spot() {
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
    fn border_keeps_total_brightness() {
        // A bright column at the left border of a dark picture.
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
    fn picture_smaller_than_the_filter_becomes_uniform() {
        let mut pixels = [[0_u8], [100]];
        blur(10.0, 1, &mut pixels);
        assert!(pixels[0][0].abs_diff(50) <= 1 && pixels[1][0].abs_diff(50) <= 1, "{pixels:?}");
        let mut empty: [[u8; 3]; 0] = [];
        blur(1.0, 5, &mut empty);
    }

    #[test]
    fn blurring_twice_adds_variances() {
        let mut once: Vec<[u8; 1]> = (0..64 * 64).map(|index| [(index * 37 % 256) as u8]).collect();
        let mut twice = once.clone();
        blur(1.0, 64, &mut once);
        blur(0.6, 64, &mut twice);
        blur(0.8, 64, &mut twice);
        // Each blur rounds to whole levels.
        assert!(once.iter().zip(&twice).all(|(a, b)| a[0].abs_diff(b[0]) <= 1));
    }
}
