//! Encoder of images as PNG. It is deterministic: equal pixels give equal bytes.

use png::{BitDepth, ColorType, Encoder};

/// Encodes red, green and blue of each pixel.
///
/// # Panics
/// Like the functions below, if the number of bytes or levels does not match `size` (width, height).
pub fn colour(size: [u32; 2], bytes: &[u8]) -> Vec<u8> {
    encode(size, ColorType::Rgb, BitDepth::Eight, None, bytes)
}

/// Encodes red, green, blue and opacity of each pixel.
pub fn colour_and_opacity(size: [u32; 2], bytes: &[u8]) -> Vec<u8> {
    encode(size, ColorType::Rgba, BitDepth::Eight, None, bytes)
}

/// Encodes a grey level of each pixel.
pub fn grey(size: [u32; 2], bytes: &[u8]) -> Vec<u8> {
    encode(size, ColorType::Grayscale, BitDepth::Eight, None, bytes)
}

/// Encodes a grey level of 16 bits of each pixel.
pub fn grey16(size: [u32; 2], levels: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = levels.iter().flat_map(|level| level.to_be_bytes()).collect();
    encode(size, ColorType::Grayscale, BitDepth::Sixteen, None, &bytes)
}

/// Encodes a label of each pixel. If no label exceeds 255, labels are indices into a palette of distinct colours, a
/// common format of segmented images (for example of PASCAL VOC). Otherwise labels are grey levels of 16 bits.
pub fn labels(size: [u32; 2], labels: &[i32]) -> Vec<u8> {
    let indices: Option<Vec<u8>> = labels.iter().map(|label| u8::try_from(*label).ok()).collect();
    match indices {
        Some(indices) => {
            let palette: Vec<u8> = (0..=255).flat_map(colour_of_label).collect();
            encode(size, ColorType::Indexed, BitDepth::Eight, Some(palette), &indices)
        }
        None => grey16(size, &labels.iter().map(|label| u16::try_from(*label).unwrap_or(u16::MAX)).collect::<Vec<_>>()),
    }
}

/// Colour of a label, distinct from the colours of labels with similar numbers.
fn colour_of_label(label: u8) -> [u8; 3] {
    match label {
        0 => [0x9c, 0xc4, 0xe4],
        1 => [0x6b, 0x6b, 0x6b],
        2 => [0xd8, 0xd0, 0xc0],
        // Successive hues differ by about the golden angle, 137.5 degrees; even labels are lighter than odd ones.
        _ => {
            let hue = u32::from(label) * 1373 % 3600;
            let (sector, rest) = (hue / 600, hue % 600);
            let max = if label.is_multiple_of(2) { 255 } else { 190 };
            let (rising, falling) = (max * rest / 600, max * (600 - rest) / 600);
            let rgb = match sector {
                0 => [max, rising, 0],
                1 => [falling, max, 0],
                2 => [0, max, rising],
                3 => [0, falling, max],
                4 => [rising, 0, max],
                _ => [max, 0, falling],
            };
            rgb.map(|channel| channel as u8)
        }
    }
}

fn encode(
    [width, height]: [u32; 2],
    colour: ColorType,
    depth: BitDepth,
    palette: Option<Vec<u8>>,
    bytes: &[u8],
) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if let Some(palette) = palette {
        encoder.set_palette(palette);
    }
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(bytes)?;
        writer.finish()
    });
    written.expect("the number of pixels matches the size");
    file
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn encoded_images_can_be_decoded() {
        let decoded = image::load_from_memory(&colour([2, 1], &[1, 2, 3, 4, 5, 6])).expect("a picture");
        assert_eq!(decoded.to_rgb8().into_raw(), [1, 2, 3, 4, 5, 6]);
        let decoded = image::load_from_memory(&grey16([1, 2], &[1234, 65535])).expect("a picture");
        assert_eq!(decoded.to_luma16().into_raw(), [1234, 65535]);
    }

    #[test]
    fn labels_keep_their_numbers() {
        let read = |file: &[u8]| {
            let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a picture");
            let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
            reader.next_frame(&mut bytes).expect("pixels");
            (reader.info().color_type, bytes)
        };
        assert_eq!(read(&labels([3, 1], &[0, 11, 255])), (ColorType::Indexed, vec![0, 11, 255]));
        assert_eq!(read(&labels([2, 1], &[1, 256])), (ColorType::Grayscale, vec![0, 1, 1, 0]));
        let colours: BTreeSet<[u8; 3]> = (0..=255).map(colour_of_label).collect();
        assert_eq!(colours.len(), 256, "all differ");
    }
}
