//! Camera settings that change the levels of images.
//!
//! Three numbers from 0 to 255, where 128 is neutral: brightness, offset and contrast for grey images; brightness, hue and
//! saturation for colour images. Source: the camera of the EyeBot; the effect of the numbers is our choice.

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
    /// Brightness; offset or hue; contrast or saturation.
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
    /// Changes the pixels of a colour image: multiplies by brightness / 128; turns the hue about the grey axis by (hue - 128) / 128 of
    /// half a turn, from red towards green; multiplies the distance from grey by saturation / 128.
    pub fn colour(&self, pixels: &mut [[u8; 3]]) {
        if self.numbers == [NEUTRAL; 3] {
            return;
        }
        let [brightness, hue, saturation] = self.fractions();
        let turned = DMat3::from_cols_array_2d(&turned_about_grey(PI * (hue - 1.0)));
        let grey = DMat3::from_cols(DVec3::ONE, DVec3::ONE, DVec3::ONE) * (1.0 / 3.0);
        let change = (turned * saturation + grey * (1.0 - saturation)) * brightness;
        for pixel in pixels {
            *pixel = (change * DVec3::from(pixel.map(f64::from))).to_array().map(level);
        }
    }

    /// Changes the pixels of a grey image: multiplies by brightness / 128; adds offset - 128; multiplies the distance from 128 by
    /// contrast / 128.
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

    /// Adapts an automatic brightness after an image with mean level `mean`: moves the brightness halfway to the value
    /// that would give a mean of 128, within 1 to 255.
    pub fn follow(&mut self, mean: f64) {
        if self.is_automatic {
            let brightness = f64::from(self.numbers[0]);
            let gain = brightness * MIDDLE_LEVEL / mean.max(1.0);
            self.numbers[0] = level(0.5 * (brightness + gain)).max(1);
        }
    }

    /// Settings as multiples of the neutral one.
    fn fractions(&self) -> [f64; 3] {
        self.numbers.map(|number| f64::from(number) / f64::from(NEUTRAL))
    }
}

/// Columns of the rotation about the grey axis by `angle`, from red towards green.
fn turned_about_grey(angle: f64) -> [[f64; 3]; 3] {
    let (along, across) = ((1.0 - math::cos(angle)) / 3.0, math::sin(angle) / 3.0_f64.sqrt());
    let same = math::cos(angle) + along;
    [
        [same, along + across, along - across],
        [along - across, same, along + across],
        [along + across, along - across, same],
    ]
}

fn level(level: f64) -> u8 {
    // A conversion to an integer saturates.
    level.round() as u8
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
    fn the_middle_changes_nothing() {
        assert_eq!(colour([128; 3], [1, 100, 255]), [1, 100, 255]);
        assert_eq!(grey([128; 3], 37), 37);
    }

    #[test]
    fn colours_change_as_said() {
        assert_eq!(colour([64, 128, 128], [10, 100, 200]), [5, 50, 100], "half as bright");
        assert_eq!(colour([255, 128, 128], [200, 0, 0]), [255, 0, 0], "limited");
        assert_eq!(colour([128, 128, 0], [30, 60, 90]), [60, 60, 60], "without colour");
        // 85 / 128, about 2/3, of half a turn is a third of a turn: red becomes green, and green becomes blue.
        let third = 128 + 85;
        assert_eq!(colour([128, third, 128], [240, 0, 0]).map(|level| level / 10), [0, 24, 0]);
        assert_eq!(colour([128, third, 128], [90; 3]), [90; 3], "grey stays grey");
    }

    #[test]
    fn greys_change_as_said() {
        assert_eq!(grey([64, 128, 128], 100), 50);
        assert_eq!(grey([128, 138, 128], 100), 110);
        assert_eq!(grey([128, 128, 64], 100), 114, "half as far from 128");
        assert_eq!(grey([0, 128, 128], 200), 0);
    }

    #[test]
    fn the_brightness_comes_to_where_the_mean_is_in_the_middle() {
        for (scene, wanted) in [(64.0, 255), (100.0, 164), (250.0, 66), (10.0, 255)] {
            let mut levels = Levels { is_automatic: true, ..Levels::default() };
            for _ in 0..12 {
                let mean = (scene * f64::from(levels.numbers[0]) / 128.0).min(255.0);
                levels.follow(mean);
            }
            assert!(levels.numbers[0].abs_diff(wanted) <= 1, "{scene}: {levels:?}");
        }
        let mut dark = Levels { numbers: [0, 128, 128], is_automatic: true };
        (0..12).for_each(|_| dark.follow(100.0 * f64::from(dark.numbers[0]) / 128.0));
        assert!(dark.numbers[0] > 150, "it comes back from nothing: {dark:?}");
        let mut manual = Levels::default();
        manual.follow(10.0);
        assert_eq!(manual, Levels::default());
    }
}
