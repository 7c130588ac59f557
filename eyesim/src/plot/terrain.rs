//! Uneven ground from above: coloured by height, shaded by a light from the upper left, with contours.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::scene::{Bounds, HeightField, Texture};

use super::colour::SHADE;
use super::drawing::{Backdrop, Drawing, Line, Symbol};
use super::viewport::metres;

/// Longer side of the image, in pixels.
const PIXELS: f64 = 900.0;
/// Approximate maximum number of contours.
const CONTOURS: f64 = 8.0;
/// Direction towards the light: from the upper left, as on relief maps.
const LIGHT: DVec3 = DVec3::new(-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2);
/// Fraction of ambient light.
const AMBIENT: f64 = 0.45;
/// Brightness of a contour relative to the ground.
const CONTOUR_BRIGHTNESS: f64 = 0.72;

/// Draws the ground, below all other shapes.
pub fn draw_terrain(drawing: &mut Drawing, field: &HeightField) {
    let Bounds { min, max } = field.bounds();
    drawing.include(min);
    drawing.include(max);
    let (low, high) = field.height_bounds();
    let step = contour_step(high - low);
    drawing.backdrop = image(field, step).map(|image| Backdrop { corners: [min, max], texture: Arc::new(image) });
    if let Some(step) = step {
        let line = Symbol::Line(Line::solid(SHADE, 1.0));
        drawing.add_legend(line, format!("ground {} m to {} m", metres(low, 0.01), metres(high, 0.01)));
        drawing.add_legend(line, format!("contour each {} m", metres(step, step)));
    }
}

/// Height between two contours: 1, 2 or 5 times a power of ten, in metres; none on level ground.
fn contour_step(range: f64) -> Option<f64> {
    let steps = (-3..4).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10.0_f64.powi(power)));
    steps.into_iter().find(|step| range / step <= CONTOURS).filter(|_| range > 1e-6)
}

fn image(field: &HeightField, step: Option<f64>) -> Option<Texture> {
    let Bounds { min, max } = field.bounds();
    let size = max - min;
    let pixel_size = size.max_element() / PIXELS;
    let [width, height] = (size / pixel_size).to_array().map(|pixels| pixels.ceil().max(1.0) as usize);
    let point = |column: usize, row: usize| {
        let fractions = DVec2::new((column as f64 + 0.5) / width as f64, 1.0 - (row as f64 + 0.5) / height as f64);
        min + fractions * size
    };
    let level_of = |point: DVec2| step.map_or(0, |step| (field.height(point.x, point.y) / step).floor() as i64);
    let levels: Vec<i64> =
        (0..height).flat_map(|row| (0..width).map(move |column| level_of(point(column, row)))).collect();
    let pixel = |column: usize, row: usize| {
        let at = point(column, row);
        let level = levels[row * width + column];
        let is_contour = [(column + 1, row), (column, row + 1)]
            .into_iter()
            .any(|(column, row)| column < width && row < height && levels[row * width + column] != level);
        let light = AMBIENT + (1.0 - AMBIENT) * field.normal(at.x, at.y).dot(LIGHT).max(0.0) / LIGHT.z;
        let brightness = light * if is_contour { CONTOUR_BRIGHTNESS } else { 1.0 };
        let [red, green, blue] =
            field.tint(field.height(at.x, at.y)).map(|shade| (255.0 * f64::from(shade) * brightness).min(255.0) as u8);
        [red, green, blue, 255]
    };
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    Texture::new(width as u32, height as u32, pixels.map(|(column, row)| pixel(column, row)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contour_steps_are_round_numbers() {
        assert_eq!(
            [0.0, 0.004, 0.3, 0.9, 7.0].map(contour_step),
            [None, Some(0.001), Some(0.05), Some(0.2), Some(1.0)]
        );
    }

    #[test]
    fn lit_side_is_lighter() {
        let roof = HeightField::new(vec![0.0, 1.0, 2.0], vec![0.0, 1.0], vec![0.0, 0.5, 0.0, 0.0, 0.5, 0.0]);
        let image = image(&roof.expect("a field"), None).expect("an image");
        let (width, height) = image.size();
        assert_eq!((width, height), (900, 450));
        let [left, right] = [225, 675].map(|column| image.pixel(column, 225)[0]);
        assert!(left > right + 40, "{left} and {right}");
    }
}
