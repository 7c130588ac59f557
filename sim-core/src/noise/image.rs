//! Errors of images.

use super::{EventStreams, Purpose, blur};
use crate::RobotId;

/// Noise model of a camera's images. The default has no errors.
///
/// First the whole picture is blurred with the standard deviation `blur`; then each pixel is changed in this order:
///
/// 1. `sigma` G is added to each channel (red, green, blue, or grey), with G standard normal; the sum is rounded and
///    clamped to 0 to 255;
/// 2. with probability `salt_and_pepper` it becomes white (with probability `salt`) or black;
/// 3. with probability `hundreds_and_thousands` it gets a random colour, each channel uniform over 0 to 255.
///
/// Source: Koestler & Bräunl, section 5; the blur and the order are our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageNoise {
    /// Standard deviation of the lens's point spread, in pixels; see [`blur`].
    pub blur: f64,
    /// Standard deviation of the added noise, in levels of 0 to 255.
    pub sigma: f64,
    /// Probability that a pixel becomes white or black.
    pub salt_and_pepper: f64,
    /// Fraction of white pixels among the pixels that become white or black.
    pub salt: f64,
    /// Probability that a pixel gets a random colour.
    pub hundreds_and_thousands: f64,
}

impl Default for ImageNoise {
    fn default() -> Self {
        Self { blur: 0.0, sigma: 0.0, salt_and_pepper: 0.0, salt: 0.5, hundreds_and_thousands: 0.0 }
    }
}

/// The errors of one camera.
#[derive(Clone, Debug)]
pub struct ImageErrors {
    model: ImageNoise,
    row_streams: EventStreams,
}

impl ImageErrors {
    /// The errors of the camera called `device` on `robot`, in a run with `seed`.
    pub fn new(model: ImageNoise, seed: u64, robot: RobotId, device: &str) -> Self {
        Self { model, row_streams: EventStreams::new(seed, robot, Purpose::Image, device) }
    }

    /// Changes an exact picture to the camera's image number `frame`: blurs it, then adds the errors of each row. Rows
    /// have `width` pixels, the top row first.
    ///
    /// # Panics
    /// If the number of pixels is not a multiple of `width`, or there are more than 65536 rows.
    pub fn expose<const CHANNELS: usize>(&self, frame: u64, width: usize, pixels: &mut [[u8; CHANNELS]]) {
        blur(self.model.blur, width, pixels);
        for (row, pixels) in pixels.chunks_exact_mut(width.max(1)).enumerate() {
            self.apply(frame, u16::try_from(row).expect("at most 65536 rows"), pixels);
        }
    }

    /// Adds the errors to row `row` of frame `frame`, whose pixels have `CHANNELS` bytes each.
    ///
    /// The errors are a function of frame and row, so rows may be processed in any order and by several threads.
    pub fn apply<const CHANNELS: usize>(&self, frame: u64, row: u16, pixels: &mut [[u8; CHANNELS]]) {
        let ImageNoise { sigma, salt_and_pepper, salt, hundreds_and_thousands, .. } = self.model;
        if sigma > 0.0 {
            let mut stream = self.row_streams.at(stream_index(frame, row, 0));
            for level in pixels.as_flattened_mut() {
                // The conversion to an integer saturates.
                *level = (f64::from(*level) + sigma * stream.normal()).round() as u8;
            }
        }
        if salt_and_pepper > 0.0 {
            let mut stream = self.row_streams.at(stream_index(frame, row, 1));
            for pixel in &mut *pixels {
                let (is_hit, is_white) = (stream.unit() < salt_and_pepper, stream.unit() < salt);
                if is_hit {
                    *pixel = [if is_white { 255 } else { 0 }; CHANNELS];
                }
            }
        }
        if hundreds_and_thousands > 0.0 {
            let mut stream = self.row_streams.at(stream_index(frame, row, 2));
            for pixel in pixels {
                let (is_hit, colour) = (stream.unit() < hundreds_and_thousands, stream.bits().to_le_bytes());
                if is_hit {
                    pixel.copy_from_slice(&colour[..CHANNELS]);
                }
            }
        }
    }
}

/// Index of the random stream for one kind of error in one row; unique for frame, row and kind.
fn stream_index(frame: u64, row: u16, kind: u64) -> u64 {
    frame << 18 | u64::from(row) << 2 | kind
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row<const CHANNELS: usize>(model: ImageNoise, frame: u64, row: u16) -> Vec<[u8; CHANNELS]> {
        let mut pixels = vec![[100; CHANNELS]; 1000];
        ImageErrors::new(model, 7, RobotId(1), "CAMERA").apply(frame, row, &mut pixels);
        pixels
    }

    #[test]
    fn default_noise_keeps_the_image() {
        assert!(row::<3>(ImageNoise::default(), 3, 4).iter().all(|pixel| *pixel == [100; 3]));
    }

    #[test]
    fn errors_depend_on_frame_and_row_and_are_reproducible() {
        let model =
            ImageNoise { sigma: 5.0, salt_and_pepper: 0.1, hundreds_and_thousands: 0.1, ..ImageNoise::default() };
        assert_eq!(row::<3>(model, 3, 4), row::<3>(model, 3, 4));
        assert_ne!(row::<3>(model, 3, 4), row::<3>(model, 3, 5));
        assert_ne!(row::<3>(model, 3, 4), row::<3>(model, 4, 4));
    }

    #[test]
    fn blur_comes_before_pixel_noise() {
        let model = ImageNoise { blur: 1.0, salt_and_pepper: 0.2, ..ImageNoise::default() };
        let picture: Vec<[u8; 3]> = (0..40 * 30).map(|index| [if index % 40 < 20 { 60 } else { 180 }; 3]).collect();
        let mut frame = picture.clone();
        ImageErrors::new(model, 7, RobotId(1), "CAMERA").expose(5, 40, &mut frame);
        let mut blurred = picture;
        blur(1.0, 40, &mut blurred);
        let is_hit = |pixel: [u8; 3]| pixel == [0; 3] || pixel == [255; 3];
        let mut hits = 0;
        for (row, (frame, blurred)) in frame.chunks_exact(40).zip(blurred.chunks_exact_mut(40)).enumerate() {
            ImageErrors::new(model, 7, RobotId(1), "CAMERA").apply(5, row as u16, blurred);
            assert_eq!(frame, blurred, "row {row}");
            hits += frame.iter().filter(|pixel| is_hit(**pixel)).count();
        }
        // If salt and pepper were added before the blur, their pixels would be grey.
        assert!((180..300).contains(&hits), "{hits} of 1200");
    }

    #[test]
    fn levels_are_clamped() {
        let model = ImageNoise { sigma: 1e6, ..ImageNoise::default() };
        let levels = row::<1>(model, 0, 0);
        let (dark, bright) =
            (levels.iter().filter(|l| l[0] == 0).count(), levels.iter().filter(|l| l[0] == 255).count());
        assert!(dark > 400 && bright > 400 && dark + bright >= 999, "{dark} dark, {bright} bright");
    }

    #[test]
    fn salt_is_white_and_pepper_is_black() {
        let pixels = |salt| row::<3>(ImageNoise { salt_and_pepper: 1.0, salt, ..ImageNoise::default() }, 0, 0);
        assert!(pixels(1.0).iter().all(|pixel| *pixel == [255; 3]));
        assert!(pixels(0.0).iter().all(|pixel| *pixel == [0; 3]));
    }

    #[test]
    fn hundreds_and_thousands_have_random_colours() {
        let model = ImageNoise { hundreds_and_thousands: 1.0, ..ImageNoise::default() };
        let colours: std::collections::BTreeSet<[u8; 3]> = row(model, 0, 0).into_iter().collect();
        assert!(colours.len() > 990, "{} colours of 1000", colours.len());
        assert!(row::<1>(model, 0, 0).iter().any(|grey| grey[0] > 200), "greys, too");
    }

    #[test]
    fn pixels_match_golden_values() {
        let model = ImageNoise {
            sigma: 5.0,
            salt_and_pepper: 0.3,
            salt: 0.25,
            hundreds_and_thousands: 0.3,
            ..ImageNoise::default()
        };
        let found: Vec<[u8; 3]> = row(model, 2, 1)[6..12].to_vec();
        assert_eq!(found, GOLDEN, "{found:?}");
    }

    const GOLDEN: [[u8; 3]; 6] = [[229, 3, 100], [11, 23, 146], [95, 99, 97], [167, 195, 56], [0, 0, 0], [0, 0, 0]];
}
