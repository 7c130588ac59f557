//! Appearance of surfaces: colour and texture.

use std::sync::Arc;

/// Appearance of the faces that use this material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the material file.
    pub name: String,
    /// Red, green, blue of the diffuse colour, 0 to 1; it multiplies the texture's colours.
    pub colour: [f32; 3],
    /// Opacity, from 0 (transparent) to 1 (opaque).
    pub opacity: f32,
    /// Image on the faces, shared by all materials with the same image.
    pub texture: Option<Arc<Texture>>,
}

impl Default for Material {
    /// Light grey without an image: the appearance of faces without a material.
    fn default() -> Self {
        Self { name: String::new(), colour: [0.8; 3], opacity: 1.0, texture: None }
    }
}

/// An image of red, green, blue and opacity, 0 to 255 each.
#[derive(Clone, PartialEq, Eq)]
pub struct Texture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl Texture {
    /// The image of `width` times `height` pixels, row by row from the top, each from the left; `None` if the number of
    /// `pixels` differs from that product or is 0.
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (count > 0 && count == pixels.len() as u64).then_some(Self { width, height, pixels })
    }

    /// The image turned by 180 degrees.
    pub fn turned(&self) -> Self {
        Self { pixels: self.pixels.iter().rev().copied().collect(), ..*self }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The pixel in `column` from the left and `row` from the top.
    ///
    /// # Panics
    /// If the pixel lies outside the image.
    pub fn pixel(&self, column: u32, row: u32) -> [u8; 4] {
        assert!(column < self.width && row < self.height, "a pixel of the image");
        self.pixels[row as usize * self.width as usize + column as usize]
    }

    /// The pixel at texture coordinates: `u` to the right and `v` upwards from the lower left corner, 1 for the full
    /// width or height. Outside 0 to 1 the image repeats. Coordinates that are not finite give the lower left pixel.
    pub fn sample(&self, u: f64, v: f64) -> [u8; 4] {
        let texel = |coordinate: f64, size: u32| {
            let fraction = coordinate - coordinate.floor();
            // A cast saturates; NaN becomes 0.
            ((fraction * f64::from(size)) as u32).min(size - 1)
        };
        self.pixel(texel(u, self.width), self.height - 1 - texel(v, self.height))
    }
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Texture({} x {})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_begin_at_the_lower_left_corner_and_repeat() {
        let [a, b, c, d] = [1, 2, 3, 4].map(|grey| [grey, grey, grey, 255]);
        let image = Texture::new(2, 2, vec![a, b, c, d]).expect("four pixels");
        let corners = [(0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9)].map(|(u, v)| image.sample(u, v));
        assert_eq!(corners, [c, d, a, b]);
        assert_eq!((image.sample(1.1, -0.1), image.sample(-0.1, 3.9)), (a, b));
        assert_eq!((image.sample(1.0, f64::NAN), image.sample(f64::INFINITY, -1e300)), (c, c));
    }

    #[test]
    fn an_image_with_missing_pixels_is_rejected() {
        assert!(Texture::new(0, 5, Vec::new()).is_none());
        assert!(Texture::new(2, 2, vec![[0; 4]; 3]).is_none());
        assert!(Texture::new(u32::MAX, u32::MAX, vec![[0; 4]; 1]).is_none());
    }
}
