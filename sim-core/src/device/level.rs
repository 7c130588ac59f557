//! Camera settings that change the levels of images.
//!
//! The settings are three numbers from 0 to 255, where 128 is neutral. They are brightness, offset and contrast for
//! grey images, and brightness, hue and saturation for colour images. Source: the camera of the EyeBot; the effect of
//! the numbers is our choice.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::math;

/// Neutral setting: the image is unchanged.
pub const NEUTRAL: u8 = 128;

/// Middle of the range of levels, and the mean level that the automatic brightness aims at.
const MIDDLE_LEVEL: f64 = 128.0;

/// Level settings of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// Brightness, then offset or hue, then contrast or saturation.
    pub numbers: [u8; 3],
    /// True if the brightness adapts to the scene.
    pub is_automatic: bool,
}

impl Default for Levels {
    fn default() -> Self {
        Self { numbers: [NEUTRAL; 3], is_automatic: false }
    }
}

impl Levels {
    /// Changes the pixels of a colour image: multiplies by brightness / 128, then rotates by (hue - 128) / 128 of half
    /// a turn about the grey axis, from red towards green, then multiplies the distance from grey by saturation / 128.
    pub fn colour(&self, pixels: &mut [[u8; 3]]) {
        if self.numbers == [NEUTRAL; 3] {
            return;
        }
        let [brightness, hue, saturation] = self.fractions();
        let rotation = DMat3::from_cols_array_2d(&rotation_about_grey(PI * (hue - 1.0)));
        let grey = DMat3::from_cols(DVec3::ONE, DVec3::ONE, DVec3::ONE) * (1.0 / 3.0);
        let change = (rotation * saturation + grey * (1.0 - saturation)) * brightness;
        for pixel in pixels {
            *pixel = (change * DVec3::from(pixel.map(f64::from))).to_array().map(level);
        }
    }

    /// Changes the pixels of a grey image: multiplies by brightness / 128, then adds offset - 128, then multiplies the
    /// distance from 128 by contrast / 128.
    pub fn grey(&self, pixels: &mut [[u8; 1]]) {
        if self.numbers == [NEUTRAL; 3] {
            return;
        }
        let [brightness, offset, contrast] = self.fractions();
        for [pixel] in pixels {
            let bright = f64::from(*pixel) * brightness + MIDDLE_LEVEL * (offset - 1.0);
            *pixel = level((bright - MIDDLE_LEVEL) * contrast + MIDDLE_LEVEL);
        }
    }

    /// Adapts an automatic brightness to an image with the mean level `mean`: moves the brightness halfway to the value
    /// that would give a mean of 128, within 1 to 255.
    pub fn adapt_brightness(&mut self, mean: f64) {
        if self.is_automatic {
            let brightness = f64::from(self.numbers[0]);
            let target = brightness * MIDDLE_LEVEL / mean.max(1.0);
            self.numbers[0] = level(0.5 * (brightness + target)).max(1);
        }
    }

    /// Settings as multiples of the neutral setting.
    fn fractions(&self) -> [f64; 3] {
        self.numbers.map(|number| f64::from(number) / f64::from(NEUTRAL))
    }
}

/// Columns of the rotation about the grey axis by `angle`, from red towards green.
fn rotation_about_grey(angle: f64) -> [[f64; 3]; 3] {
    let (symmetric, skew) = ((1.0 - math::cos(angle)) / 3.0, math::sin(angle) / 3.0_f64.sqrt());
    let diagonal = math::cos(angle) + symmetric;
    [
        [diagonal, symmetric + skew, symmetric - skew],
        [symmetric - skew, diagonal, symmetric + skew],
        [symmetric + skew, symmetric - skew, diagonal],
    ]
}

/// The nearest level from 0 to 255.
fn level(value: f64) -> u8 {
    // A conversion to an integer saturates.
    value.round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colour(numbers: [u8; 3], pixel: [u8; 3]) -> [u8; 3] {
        let mut pixels = [pixel];
        Levels { numbers, is_automatic: false }.colour(&mut pixels);
        pixels[0]
    }

    fn grey(numbers: [u8; 3], pixel: u8) -> u8 {
        let mut pixels = [[pixel]];
        Levels { numbers, is_automatic: false }.grey(&mut pixels);
        pixels[0][0]
    }

    #[test]
    fn neutral_settings_change_nothing() {
        assert_eq!(colour([128; 3], [1, 100, 255]), [1, 100, 255]);
        assert_eq!(grey([128; 3], 37), 37);
    }

    #[test]
    fn settings_change_colours_as_documented() {
        assert_eq!(colour([64, 128, 128], [10, 100, 200]), [5, 50, 100], "half as bright");
        assert_eq!(colour([255, 128, 128], [200, 0, 0]), [255, 0, 0], "limited");
        assert_eq!(colour([128, 128, 0], [30, 60, 90]), [60, 60, 60], "without colour");
        // 85 / 128, about 2/3, of half a turn is a third of a turn: red becomes green, and green becomes blue.
        let third = 128 + 85;
        assert_eq!(colour([128, third, 128], [240, 0, 0]).map(|level| level / 10), [0, 24, 0]);
        assert_eq!(colour([128, third, 128], [90; 3]), [90; 3], "grey stays grey");
    }

    #[test]
    fn settings_change_greys_as_documented() {
        assert_eq!(grey([64, 128, 128], 100), 50);
        assert_eq!(grey([128, 138, 128], 100), 110);
        assert_eq!(grey([128, 128, 64], 100), 114, "half as far from 128");
        assert_eq!(grey([0, 128, 128], 200), 0);
    }

    #[test]
    fn automatic_brightness_converges_to_a_mean_of_128() {
        for (scene, expected) in [(64.0, 255), (100.0, 164), (250.0, 66), (10.0, 255)] {
            let mut levels = Levels { is_automatic: true, ..Levels::default() };
            for _ in 0..12 {
                let mean = (scene * f64::from(levels.numbers[0]) / 128.0).min(255.0);
                levels.adapt_brightness(mean);
            }
            assert!(levels.numbers[0].abs_diff(expected) <= 1, "{scene}: {levels:?}");
        }
        let mut dark = Levels { numbers: [0, 128, 128], is_automatic: true };
        (0..12).for_each(|_| dark.adapt_brightness(100.0 * f64::from(dark.numbers[0]) / 128.0));
        assert!(dark.numbers[0] > 150, "the brightness recovers from 0: {dark:?}");
        let mut manual = Levels::default();
        manual.adapt_brightness(10.0);
        assert_eq!(manual, Levels::default());
    }
}
