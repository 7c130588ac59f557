//! Images in BMP files: 1 to 32 bits per pixel, with a palette, with bit masks or run-length encoded, with rows from
//! the bottom or from the top.
//!
//! Source: Microsoft's documentation of BITMAPFILEHEADER, BITMAPCOREHEADER and BITMAPINFOHEADER.

/// Description of a BMP image, from its headers.
pub(super) struct Bmp<'b> {
    /// Width and height.
    pub(super) size: [u32; 2],
    /// True if rows are stored from top to bottom.
    is_top_down: bool,
    depth: u16,
    compression: u32,
    /// Bits of red, green, blue and opacity in a pixel of 16 or 32 bits.
    masks: [u32; 4],
    palette: Vec<[u8; 3]>,
    /// The pixels.
    data: &'b [u8],
}

const RGB: u32 = 0;
const RLE8: u32 = 1;
const RLE4: u32 = 2;
const BIT_FIELDS: u32 = 3;
const ALPHA_BIT_FIELDS: u32 = 6;

impl<'b> Bmp<'b> {
    /// Reads the headers of an image.
    ///
    /// # Errors
    /// The reason, worded for the user.
    pub(super) fn open(bytes: &'b [u8]) -> Result<Self, &'static str> {
        const SHORT: &str = "it ends within its header";
        let u16_at = |offset: usize| Some(u16::from_le_bytes(*bytes.get(offset..)?.first_chunk()?));
        let u32_at = |offset: usize| Some(u32::from_le_bytes(*bytes.get(offset..)?.first_chunk()?));
        let (Some(data_offset), Some(header_size)) = (u32_at(10), u32_at(14)) else { return Err(SHORT) };
        // Headers of 12 bytes have sizes of 16 bits, and palette entries of three bytes.
        let has_core_header = header_size == 12;
        let sides = if has_core_header {
            [18, 20].map(|offset| u16_at(offset).map(|side| i32::from(side as i16)))
        } else {
            [18, 22].map(|offset| u32_at(offset).map(|side| side as i32))
        };
        let [Some(width), Some(height)] = sides else { return Err(SHORT) };
        let Some(depth) = u16_at(if has_core_header { 24 } else { 28 }) else { return Err(SHORT) };
        let [compression, colours] =
            if has_core_header { [0, 0] } else { [30, 46].map(|offset| u32_at(offset).unwrap_or(0)) };
        if width <= 0 || height == 0 {
            return Err("its width or height is 0");
        }
        let is_known = match compression {
            RGB => matches!(depth, 1 | 2 | 4 | 8 | 16 | 24 | 32),
            RLE8 => depth == 8,
            RLE4 => depth == 4,
            BIT_FIELDS | ALPHA_BIT_FIELDS => matches!(depth, 16 | 32),
            _ => false,
        };
        if !is_known {
            return Err("its bits for each pixel, or their compression, are of a kind that is not read");
        }
        let masks = match (compression, depth) {
            (BIT_FIELDS | ALPHA_BIT_FIELDS, _) => {
                let has_alpha = compression == ALPHA_BIT_FIELDS || header_size >= 56;
                [54, 58, 62, 66].map(|offset| u32_at(offset).filter(|_| offset < 66 || has_alpha).unwrap_or(0))
            }
            (_, 16) => [0x7c00, 0x03e0, 0x001f, 0],
            _ => [0x00ff_0000, 0x0000_ff00, 0x0000_00ff, 0],
        };
        let palette_offset =
            14 + header_size as usize + if header_size == 40 && compression == BIT_FIELDS { 12 } else { 0 };
        let max_colours = if depth <= 8 { 1_usize << depth } else { 0 };
        let count = if colours == 0 { max_colours } else { max_colours.min(colours as usize) };
        let entry_size = if has_core_header { 3 } else { 4 };
        let palette_entries = bytes.get(palette_offset..).unwrap_or_default().chunks_exact(entry_size).take(count);
        Ok(Self {
            size: [width as u32, height.unsigned_abs()],
            is_top_down: height < 0,
            depth,
            compression,
            masks,
            palette: palette_entries.map(|entry| [entry[2], entry[1], entry[0]]).collect(),
            data: bytes.get(data_offset as usize..).ok_or(SHORT)?,
        })
    }

    /// Red, green, blue and opacity of each pixel, row by row from the top.
    ///
    /// # Errors
    /// The reason, worded for the user.
    pub(super) fn decode(&self) -> Result<Vec<u8>, &'static str> {
        const SHORT: &str = "it ends before its last pixel";
        let [width, height] = self.size.map(|side| side as usize);
        let mut pixels = vec![255; 4 * width * height];
        let encoded = match self.compression {
            RLE8 | RLE4 => Some(self.decode_runs()),
            _ => None,
        };
        let bytes_per_row = (width * usize::from(self.depth)).div_ceil(32) * 4;
        for (row, out) in pixels.chunks_exact_mut(4 * width).enumerate() {
            let stored_row = if self.is_top_down { row } else { height - 1 - row };
            if let Some(indices) = &encoded {
                let row = indices.chunks_exact(width).nth(stored_row).ok_or(SHORT)?;
                self.look_up(row.iter().map(|index| usize::from(*index)), out);
                continue;
            }
            // Some writers omit the padding of the last row.
            let needed = (width * usize::from(self.depth)).div_ceil(8);
            let row_bytes =
                self.data.get(stored_row * bytes_per_row..stored_row * bytes_per_row + needed).ok_or(SHORT)?;
            match self.depth {
                depth @ (1 | 2 | 4 | 8) => {
                    let (depth, mask) = (usize::from(depth), (1_usize << depth) - 1);
                    let index = |column: usize| {
                        let bit = column * depth;
                        usize::from(row_bytes[bit / 8]) >> (8 - depth - bit % 8) & mask
                    };
                    self.look_up((0..width).map(index), out);
                }
                24 => {
                    out.chunks_exact_mut(4).zip(row_bytes.as_chunks::<3>().0).for_each(|(out, [blue, green, red])| {
                        out[..3].copy_from_slice(&[*red, *green, *blue]);
                    })
                }
                16 => {
                    let values = row_bytes.as_chunks().0.iter().map(|bytes| u16::from_le_bytes(*bytes).into());
                    out.chunks_exact_mut(4).zip(values).for_each(|(out, value)| self.unpack(value, out));
                }
                _ => {
                    let values = row_bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
                    out.chunks_exact_mut(4).zip(values).for_each(|(out, value)| self.unpack(value, out));
                }
            }
        }
        Ok(pixels)
    }

    /// Writes the colours of palette `indices`; black beyond the palette.
    fn look_up(&self, indices: impl Iterator<Item = usize>, out: &mut [u8]) {
        for (out, index) in out.chunks_exact_mut(4).zip(indices) {
            out[..3].copy_from_slice(self.palette.get(index).unwrap_or(&[0; 3]));
        }
    }

    /// Writes the channels of a pixel that is packed into bits.
    fn unpack(&self, value: u32, out: &mut [u8]) {
        for (out, mask) in out.iter_mut().zip(self.masks) {
            if mask != 0 {
                let (bits, max_bits) = ((value & mask) >> mask.trailing_zeros(), mask >> mask.trailing_zeros());
                *out = ((u64::from(bits) * 255 + u64::from(max_bits) / 2) / u64::from(max_bits)) as u8;
            }
        }
    }

    /// Palette indices of a run-length encoded image, row by row from the bottom; 0 for pixels that no run covers.
    fn decode_runs(&self) -> Vec<u8> {
        let [width, height] = self.size.map(|side| side as usize);
        let mut indices = vec![0; width * height];
        let (mut column, mut row) = (0, 0);
        let mut put_pixel = |column: &mut usize, row: usize, index: u8| {
            if *column < width && row < height {
                indices[row * width + *column] = index;
            }
            *column += 1;
        };
        let has_4_bits = self.compression == RLE4;
        let nibble = |byte: u8, index: usize| if index.is_multiple_of(2) { byte >> 4 } else { byte & 15 };
        let mut rest = self.data;
        while let [count, value, tail @ ..] = rest {
            rest = tail;
            match (*count, *value) {
                (0, 0) => (column, row) = (0, row + 1),
                (0, 1) => break,
                (0, 2) => {
                    let [right, up, tail @ ..] = rest else { break };
                    (column, row, rest) = (column + usize::from(*right), row + usize::from(*up), tail);
                }
                (0, length) => {
                    let length = usize::from(length);
                    let bytes = if has_4_bits { length.div_ceil(2) } else { length };
                    for index in 0..length {
                        let byte = rest.get(if has_4_bits { index / 2 } else { index }).copied().unwrap_or(0);
                        put_pixel(&mut column, row, if has_4_bits { nibble(byte, index) } else { byte });
                    }
                    // Literal pixels are padded to an even number of bytes.
                    rest = rest.get(bytes.next_multiple_of(2)..).unwrap_or_default();
                }
                (count, value) => {
                    for index in 0..usize::from(count) {
                        put_pixel(&mut column, row, if has_4_bits { nibble(value, index) } else { value });
                    }
                }
            }
            if row >= height {
                break;
            }
        }
        indices
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A file with a BITMAPINFOHEADER; `after_header` are the bytes between header and pixels.
    fn file(size: [i32; 2], depth: u16, compression: u32, after_header: &[u8], data: &[u8]) -> Vec<u8> {
        let mut file = b"BM\0\0\0\0\0\0\0\0".to_vec();
        file.extend((54 + after_header.len() as u32).to_le_bytes());
        file.extend(40_u32.to_le_bytes());
        size.iter().for_each(|side| file.extend(side.to_le_bytes()));
        file.extend(1_u16.to_le_bytes());
        file.extend(depth.to_le_bytes());
        file.extend(compression.to_le_bytes());
        file.extend([0; 20]);
        file.extend(after_header);
        file.extend(data);
        file
    }

    fn palette() -> Vec<u8> {
        (0..=255).flat_map(|level: u8| [level, level / 3, level ^ (level >> 4), 0]).collect()
    }

    /// Our pixels and those of the crate `image`.
    fn our_and_their_pixels(file: &[u8]) -> (Vec<u8>, Vec<u8>) {
        let ours = Bmp::open(file).and_then(|bmp| bmp.decode()).expect("an image");
        let theirs = image::load_from_memory_with_format(file, image::ImageFormat::Bmp).expect("an image");
        (ours, theirs.into_rgba8().into_raw())
    }

    #[test]
    fn all_depths_and_compressions_match_the_crate_image() {
        let masks = |masks: [u32; 3]| masks.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>();
        let data: Vec<u8> = (0..400_u32).map(|index| (index * 37 % 251) as u8).collect();
        for (depth, compression, after_header) in [
            (1, RGB, palette()[..8].to_vec()),
            (4, RGB, palette()[..64].to_vec()),
            (8, RGB, palette()),
            (16, RGB, Vec::new()),
            (16, BIT_FIELDS, masks([0xf800, 0x07e0, 0x001f])),
            (24, RGB, Vec::new()),
            (32, RGB, Vec::new()),
            (32, BIT_FIELDS, masks([0xff, 0xff00, 0x00ff_0000])),
        ] {
            for size in [[5, 3], [8, 2], [1, 1], [3, -4]] {
                let (ours, theirs) = our_and_their_pixels(&file(size, depth, compression, &after_header, &data));
                let is_close = ours.iter().zip(&theirs).all(|(a, b)| a.abs_diff(*b) <= 1);
                assert!(is_close && ours.len() == theirs.len(), "{depth} bits, {compression}, {size:?}");
            }
        }
        for (depth, compression, runs) in [
            (8, RLE8, &[3, 7, 0, 0, 0, 3, 1, 2, 3, 0, 0, 2, 1, 1, 2, 9, 0, 1][..]),
            (4, RLE4, &[5, 0x12, 0, 0, 0, 5, 0x12, 0x34, 0x50, 0, 0, 1]),
        ] {
            let (ours, theirs) =
                our_and_their_pixels(&file([5, 4], depth, compression, &palette()[..4 << depth], runs));
            // Pixels that no run covers are black in `theirs` and have the palette's first colour in `ours`; here that
            // colour is black.
            assert_eq!(ours, theirs, "{compression}");
        }
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_do_not_panic(
            width in -3..9_i32, height in -3..9_i32, depth in 0..40_u16, compression in 0..8_u32,
            rest in prop::collection::vec(any::<u8>(), 0..200), cut in 0..300_usize,
        ) {
            let mut file = file([width, height], depth, compression, &[], &rest);
            file.truncate(cut);
            _ = Bmp::open(&file).and_then(|bmp| bmp.decode());
        }
    }
}
