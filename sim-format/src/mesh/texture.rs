//! Images: png, jpg and bmp, identified by their first bytes.

use std::io::Cursor;

use image::{DynamicImage, ImageReader, Limits};

use sim_core::scene::Texture;

/// Greatest number of pixels of an image: 4096 times 4096.
const MAX_PIXELS: u64 = 1 << 24;

/// Greatest memory that a decoder may allocate in addition to the image, in bytes.
const MAX_BYTES: u64 = 16 * MAX_PIXELS;

/// Reason why an image cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum TextureError {
    /// Unsupported format or invalid data.
    #[error("it is no png, jpg or bmp image that can be read: {0}")]
    Format(String),
    /// The image is too large.
    #[error("it has {0} x {1} pixels")]
    Size(u32, u32),
}

/// Decodes the image in `bytes` as a texture.
pub(super) fn read_texture(bytes: &[u8]) -> Result<Texture, TextureError> {
    let image = decode(bytes)?.into_rgba8();
    let (width, height) = image.dimensions();
    let pixels = image.pixels().map(|pixel| pixel.0).collect();
    Texture::new(width, height, pixels).ok_or_else(|| TextureError::Format("it is empty".to_owned()))
}

/// Decodes the image in `bytes`, with any pixel format.
pub(super) fn decode(bytes: &[u8]) -> Result<DynamicImage, TextureError> {
    let unreadable = |error: &dyn std::fmt::Display| TextureError::Format(error.to_string());
    let open = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| unreadable(&error));
    let (width, height) = open()?.into_dimensions().map_err(|error| unreadable(&error))?;
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(TextureError::Size(width, height));
    }
    let mut reader = open()?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    reader.decode().map_err(|error| unreadable(&error))
}

#[cfg(test)]
mod tests {
    use image::{ImageFormat, RgbaImage};

    use super::*;

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut image = RgbaImage::from_pixel(16, 8, image::Rgba([200, 100, 50, 255]));
        for x in 0..8 {
            for y in 0..8 {
                image.put_pixel(x, y, image::Rgba([0, 0, 255, 255]));
            }
        }
        let mut bytes = Cursor::new(Vec::new());
        image::DynamicImage::from(image).into_rgb8().write_to(&mut bytes, format).expect("an image");
        bytes.into_inner()
    }

    #[test]
    fn three_formats_are_read() {
        for (format, tolerance) in [(ImageFormat::Png, 0), (ImageFormat::Bmp, 0), (ImageFormat::Jpeg, 8)] {
            let texture = read_texture(&encoded(format)).expect("an image");
            assert_eq!(texture.size(), (16, 8));
            for (column, colour) in [(1, [0, 0, 255, 255]), (14, [200, 100, 50, 255u8])] {
                let pixel = texture.pixel(column, 4);
                let near = pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= tolerance);
                assert!(near, "{format:?}: {pixel:?} is not {colour:?}");
            }
        }
    }

    #[test]
    fn broken_and_oversized_images_are_errors() {
        let png = encoded(ImageFormat::Png);
        for bytes in [&b""[..], b"GIF89a", &png[..png.len() / 2], &png[..20], b"BM", b"\xff\xd8\xff"] {
            assert!(matches!(read_texture(bytes), Err(TextureError::Format(_))), "{bytes:?}");
        }
        // A bmp header that claims 65535 x 65535 pixels.
        let mut bomb = encoded(ImageFormat::Bmp);
        bomb[18..26].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
        assert_eq!(read_texture(&bomb), Err(TextureError::Size(65535, 65535)));
    }
}
