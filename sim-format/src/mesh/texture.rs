//! Images: png, jpg and bmp, identified by their first bytes.

use std::io::Cursor;

use png::{BitDepth, Transformations};
use sim_core::scene::Texture;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;

use super::bmp::Bmp;

/// Maximum number of pixels of an image: 4096 times 4096.
const MAX_PIXELS: u64 = 1 << 24;

/// Bytes that the png decoder may allocate in addition to the image itself.
const MAX_BYTES: usize = 16 << 24;

/// Error of an image that cannot be shown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum TextureError {
    /// The format is not supported, or the bytes are damaged.
    #[error("it is not a readable png, jpg or bmp image: {0}")]
    Format(String),
    /// The image has more than [`MAX_PIXELS`].
    #[error("it has {0} x {1} pixels, more than {MAX_PIXELS}")]
    Size(u64, u64),
}

/// A decoded image: rows from the top, with adjacent channels of a pixel.
pub(super) struct Pixels {
    /// Width and height.
    pub(super) size: [u32; 2],
    /// Channels of each pixel: either grey, or red, green and blue; with or without opacity.
    samples: Samples,
}

enum Samples {
    Bits8(Vec<u8>),
    Bits16(Vec<u16>),
}

/// Decodes an image to a texture of 8 bits a channel.
pub(super) fn read_texture(bytes: &[u8]) -> Result<Texture, TextureError> {
    let image = decode(bytes)?;
    let [width, height] = image.size;
    let pixels = match &image.samples {
        Samples::Bits8(samples) => rgba(samples, image.channels(samples), u8::MAX).collect(),
        // Rounds to the nearest 8-bit level.
        Samples::Bits16(samples) => rgba(samples, image.channels(samples), u16::MAX)
            .map(|pixel| pixel.map(|level| ((u32::from(level) + 128) / 257) as u8))
            .collect(),
    };
    Texture::new(width, height, pixels).ok_or_else(|| unreadable("it is empty"))
}

/// Decodes a png, jpg or bmp image; the first bytes determine the format.
pub(super) fn decode(bytes: &[u8]) -> Result<Pixels, TextureError> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes),
        [0xff, 0xd8, ..] => decode_jpg(bytes),
        [b'B', b'M', ..] => decode_bmp(bytes),
        _ => Err(unreadable("its first bytes are of another format")),
    }
}

fn decode_png(bytes: &[u8]) -> Result<Pixels, TextureError> {
    let limits = png::Limits { bytes: MAX_BYTES };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Converts palettes and samples below 8 bits to 8 bits, and transparent colours to a channel of opacity.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let size = checked_size(reader.info().width, reader.info().height)?;
    let mut samples = vec![0; reader.output_buffer_size().ok_or_else(|| unreadable("it is too large"))?];
    let frame = reader.next_frame(&mut samples).map_err(unreadable)?;
    samples.truncate(frame.buffer_size());
    let samples = match frame.bit_depth {
        BitDepth::Sixteen => {
            Samples::Bits16(samples.as_chunks().0.iter().map(|level| u16::from_be_bytes(*level)).collect())
        }
        _ => Samples::Bits8(samples),
    };
    Ok(Pixels { size, samples })
}

fn decode_jpg(bytes: &[u8]) -> Result<Pixels, TextureError> {
    let mut decoder = zune_jpeg::JpegDecoder::new(ZCursor::new(bytes));
    decoder.decode_headers().map_err(unreadable)?;
    let (width, height) = decoder.dimensions().ok_or_else(|| unreadable("it has no size"))?;
    let size = checked_size(width, height)?;
    let colour_space = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => ColorSpace::Luma,
        _ => ColorSpace::RGB,
    };
    decoder.set_options(DecoderOptions::default().jpeg_set_out_colorspace(colour_space));
    Ok(Pixels { size, samples: Samples::Bits8(decoder.decode().map_err(unreadable)?) })
}

fn decode_bmp(bytes: &[u8]) -> Result<Pixels, TextureError> {
    let image = Bmp::open(bytes).map_err(unreadable)?;
    let [width, height] = image.size;
    let size = checked_size(width, height)?;
    Ok(Pixels { size, samples: Samples::Bits8(image.decode().map_err(unreadable)?) })
}

fn unreadable(reason: impl std::fmt::Display) -> TextureError {
    TextureError::Format(reason.to_string())
}

/// The size of an image; an error for more than [`MAX_PIXELS`], before memory is allocated.
fn checked_size(width: impl TryInto<u64>, height: impl TryInto<u64>) -> Result<[u32; 2], TextureError> {
    let [width, height] = [width.try_into().unwrap_or(u64::MAX), height.try_into().unwrap_or(u64::MAX)];
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(columns), Ok(rows)) if u64::from(columns) * u64::from(rows) <= MAX_PIXELS => Ok([columns, rows]),
        _ => Err(TextureError::Size(width, height)),
    }
}

impl Pixels {
    /// Number of channels of a pixel: 1 to 4.
    fn channels<T>(&self, samples: &[T]) -> usize {
        let [width, height] = self.size.map(|side| side as usize);
        (samples.len() / (width * height).max(1)).clamp(1, 4)
    }

    /// Returns the sum of the channels of each pixel, including opacity if `with_opacity`, the sum of a white pixel,
    /// the value of white in one channel, and flags that are true for pixels that are not opaque (empty if all are
    /// opaque).
    pub(super) fn sums(&self, with_opacity: bool) -> (Vec<u32>, u32, u32, Vec<bool>) {
        match &self.samples {
            Samples::Bits8(samples) => sums(samples, self.channels(samples), u8::MAX, with_opacity),
            Samples::Bits16(samples) => sums(samples, self.channels(samples), u16::MAX, with_opacity),
        }
    }

    /// Red, green and blue of each pixel, 0 to 65535.
    pub(super) fn rgb16(&self) -> Vec<[u16; 3]> {
        let colours = |[red, green, blue, _]: [u16; 4]| [red, green, blue];
        match &self.samples {
            Samples::Bits8(samples) => rgba(samples, self.channels(samples), u8::MAX)
                .map(|pixel| colours(pixel.map(|level| 257 * u16::from(level))))
                .collect(),
            Samples::Bits16(samples) => rgba(samples, self.channels(samples), u16::MAX).map(colours).collect(),
        }
    }
}

/// [`Pixels::sums`] for samples of one type.
fn sums<T: Copy + Into<u32>>(
    samples: &[T],
    channels: usize,
    opaque: T,
    with_opacity: bool,
) -> (Vec<u32>, u32, u32, Vec<bool>) {
    let white: u32 = opaque.into();
    let has_opacity = channels.is_multiple_of(2);
    let summed_channels = if has_opacity && !with_opacity { channels - 1 } else { channels };
    let sum = |pixel: &[T]| pixel[..summed_channels].iter().map(|level| (*level).into()).sum();
    let is_transparent = |pixel: &[T]| pixel[channels - 1].into() < white;
    let transparency =
        if has_opacity { samples.chunks_exact(channels).map(is_transparent).collect() } else { Vec::new() };
    (samples.chunks_exact(channels).map(sum).collect(), white * summed_channels as u32, white, transparency)
}

/// Red, green, blue and opacity of each pixel; grey pixels have equal colours, pixels without opacity are `opaque`.
fn rgba<T: Copy>(samples: &[T], channels: usize, opaque: T) -> impl Iterator<Item = [T; 4]> {
    samples.chunks_exact(channels).map(move |pixel| match *pixel {
        [grey] => [grey, grey, grey, opaque],
        [grey, opacity] => [grey, grey, grey, opacity],
        [red, green, blue] => [red, green, blue, opaque],
        [red, green, blue, opacity, ..] => [red, green, blue, opacity],
        [] => [opaque; 4],
    })
}

#[cfg(test)]
mod tests {
    use image::{ImageFormat, RgbaImage};

    use super::*;

    fn encoded_image(format: ImageFormat) -> Vec<u8> {
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
            let texture = read_texture(&encoded_image(format)).expect("an image");
            assert_eq!(texture.size(), (16, 8));
            for (column, colour) in [(1, [0, 0, 255, 255]), (14, [200, 100, 50, 255u8])] {
                let pixel = texture.pixel(column, 4);
                let is_close = pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= tolerance);
                assert!(is_close, "{format:?}: {pixel:?} is not {colour:?}");
            }
        }
    }

    #[test]
    fn broken_and_oversized_images_are_errors() {
        let png = encoded_image(ImageFormat::Png);
        for bytes in [&b""[..], b"GIF89a", &png[..png.len() / 2], &png[..20], b"BM", b"\xff\xd8\xff"] {
            assert!(matches!(read_texture(bytes), Err(TextureError::Format(_))), "{bytes:?}");
        }
        // A bmp header that claims 65535 x 65535 pixels.
        let mut oversized = encoded_image(ImageFormat::Bmp);
        oversized[18..26].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
        assert_eq!(read_texture(&oversized), Err(TextureError::Size(65535, 65535)));
    }
}
