//! Images in PNM files: PBM, PGM and PPM, plain and binary.
//!
//! Source: Netpbm's formats P1 to P6.

use super::picture::Size;

/// An image read from a file, of the requested size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Digit of the format, `P1` to `P6`.
    pub kind: u8,
    /// The pixels: 1 byte per pixel for kinds 1, 2, 4 and 5, otherwise 3.
    pub pixels: Vec<u8>,
}

/// Reason why a file cannot be read as a PNM image.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PnmError {
    /// The file does not begin with `P1` to `P6`.
    #[error("it is not a PNM file, which begins with P1 to P6")]
    Kind,
    /// The file is a PAM file (P7), which is not supported.
    #[error("it is a PAM file (P7), expected P1 to P6")]
    Pam,
    /// A number of the header is missing or out of range.
    #[error("its {0} is missing or out of range, expected {1}")]
    Header(&'static str, &'static str),
    /// A sample is not a number, or exceeds the maximum in the header.
    #[error("pixel {0} is not a number from 0 to {1}")]
    Sample(u64, u32),
    /// The file has too few bytes for the pixels that the header states.
    #[error("it ends before the {0} pixels of its head")]
    Short(u64),
}

/// Reads the image in `file` and crops it to `size` at the right and bottom, or fills it up with black there.
///
/// Samples are scaled to 0..=255; black in a PBM file (bit 1) becomes 0.
///
/// # Errors
/// [`PnmError`] if the file is not a PNM file or is damaged.
pub fn read(file: &[u8], size: Size) -> Result<Picture, PnmError> {
    let (kind, rest) = match file {
        [b'P', b'7', ..] => return Err(PnmError::Pam),
        [b'P', kind @ b'1'..=b'6', rest @ ..] => (kind - b'0', rest),
        _ => return Err(PnmError::Kind),
    };
    let mut text = TextReader { rest };
    let expected_side = "a whole number above 0";
    let width = text.number(u32::MAX).filter(|number| *number > 0).ok_or(PnmError::Header("width", expected_side))?;
    let height = text.number(u32::MAX).filter(|number| *number > 0).ok_or(PnmError::Header("height", expected_side))?;
    let max = match kind {
        1 | 4 => 1,
        _ => text
            .number(65_535)
            .filter(|number| *number > 0)
            .ok_or(PnmError::Header("greatest value", "a whole number from 1 to 65535"))?,
    };
    let depth = if matches!(kind, 3 | 6) { 3 } else { 1 };
    let pixels = u64::from(width) * u64::from(height);
    // A byte holds at most 8 pixels: no memory is allocated for pixels that the file cannot contain.
    if pixels > 8 * file.len() as u64 {
        return Err(PnmError::Short(pixels));
    }
    let (width, samples) = (width as usize, pixels as usize * depth);
    let sample = |index: usize, value: Option<u32>| {
        let value = value.filter(|value| *value <= max).ok_or(PnmError::Sample((index / depth) as u64, max))?;
        Ok(((value * 255 + max / 2) / max) as u8)
    };
    // One whitespace character ends the header of a binary file.
    let data = text.rest.get(1..).unwrap_or_default();
    let short = PnmError::Short(pixels);
    let levels: Vec<u8> = match kind {
        // The digits of a plain bitmap need no whitespace between them.
        1 => {
            (0..samples).map(|index| sample(index, text.digit()).map(|level| 255 - level)).collect::<Result<_, _>>()?
        }
        2 | 3 => (0..samples).map(|index| sample(index, text.number(max))).collect::<Result<_, _>>()?,
        4 => {
            let row = width.div_ceil(8);
            let rows = data.get(..row * height as usize).ok_or(short)?.chunks_exact(row);
            rows.flat_map(|row| {
                (0..width).map(|column| if row[column / 8] >> (7 - column % 8) & 1 == 1 { 0 } else { 255 })
            })
            .collect()
        }
        _ if max < 256 => {
            let data = data.get(..samples).ok_or(short)?;
            data.iter()
                .enumerate()
                .map(|(index, level)| sample(index, Some((*level).into())))
                .collect::<Result<_, _>>()?
        }
        _ => {
            let levels = data.get(..2 * samples).ok_or(short)?.as_chunks().0.iter().enumerate();
            levels
                .map(|(index, level)| sample(index, Some(u16::from_be_bytes(*level).into())))
                .collect::<Result<_, _>>()?
        }
    };
    Ok(Picture { kind, pixels: crop_or_fill(&levels, width * depth, size.width * depth, size.height) })
}

/// Reader of decimal numbers that are separated by whitespace and comments.
struct TextReader<'f> {
    rest: &'f [u8],
}

impl TextReader<'_> {
    /// Skips whitespace, and comments from `#` to the end of the line.
    fn skip_whitespace(&mut self) {
        loop {
            match self.rest {
                [byte, rest @ ..] if byte.is_ascii_whitespace() => self.rest = rest,
                [b'#', ..] => {
                    let end = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
                    self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
                }
                _ => return,
            }
        }
    }

    /// Reads the next number; `None` if there is none, or if it exceeds `max`.
    fn number(&mut self, max: u32) -> Option<u32> {
        self.skip_whitespace();
        let length = self.rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (digits, rest) = self.rest.split_at(length);
        self.rest = rest;
        std::str::from_utf8(digits).ok()?.parse().ok().filter(|number| *number <= max)
    }

    /// Reads the next character as a decimal digit; `None` if it is none. A bitmap has only the digits 0 and 1.
    fn digit(&mut self) -> Option<u32> {
        self.skip_whitespace();
        let (digit, rest) = self.rest.split_first()?;
        self.rest = rest;
        char::from(*digit).to_digit(10)
    }
}

/// Crops rows of `from_width` bytes to `height` rows of `width` bytes, or fills them up with zeros.
fn crop_or_fill(bytes: &[u8], from_width: usize, width: usize, height: usize) -> Vec<u8> {
    let mut result = vec![0; width * height];
    let common = width.min(from_width);
    for (to, from) in result.chunks_exact_mut(width).zip(bytes.chunks_exact(from_width.max(1))) {
        to[..common].copy_from_slice(&from[..common]);
    }
    result
}

/// Encodes a colour image as a binary PPM file.
pub fn write_colour(size: Size, pixels: &[u8]) -> Vec<u8> {
    write("P6", size, pixels)
}

/// Encodes a grey image as a binary PGM file.
pub fn write_grey(size: Size, pixels: &[u8]) -> Vec<u8> {
    write("P5", size, pixels)
}

fn write(kind: &str, size: Size, pixels: &[u8]) -> Vec<u8> {
    let mut file = format!("{kind}\n{} {}\n255\n", size.width, size.height).into_bytes();
    file.extend_from_slice(pixels);
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_BY_TWO: Size = Size { width: 2, height: 2 };

    fn pixels(file: &[u8]) -> (u8, Vec<u8>) {
        let picture = read(file, TWO_BY_TWO).unwrap();
        (picture.kind, picture.pixels)
    }

    #[test]
    fn all_six_kinds() {
        assert_eq!(pixels(b"P1\n2 2\n1 0\n01\n"), (1, vec![0, 255, 255, 0]));
        assert_eq!(pixels(b"P2 2 2 255 1 2 3 4"), (2, vec![1, 2, 3, 4]));
        assert_eq!(pixels(b"P3 2 2 255 1 2 3 4 5 6 7 8 9 10 11 12"), (3, (1..=12).collect()));
        assert_eq!(pixels(b"P4 2 2\n\x80\x40"), (4, vec![0, 255, 255, 0]));
        assert_eq!(pixels(b"P5 2 2 255\n\x01\x02\x03\x04"), (5, vec![1, 2, 3, 4]));
        assert_eq!(pixels(b"P6 2 2 255\n\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b\x0c"), (6, (1..=12).collect()));
    }

    #[test]
    fn comments_and_other_ranges() {
        let head = b"P2\n# by hand\n2 # columns\n2\n# rows\n15\n";
        assert_eq!(pixels(&[head.as_slice(), b"0 5 10 15"].concat()), (2, vec![0, 85, 170, 255]));
        assert_eq!(pixels(b"P5 2 2 65535\n\x00\x00\x80\x80\xff\xff\x01\x01"), (5, vec![0, 128, 255, 1]));
        assert_eq!(pixels(b"P5 2 2 1000\n\x00\x00\x01\xf4\x03\xe8\x00\x04"), (5, vec![0, 128, 255, 1]));
    }

    #[test]
    fn other_sizes_are_cropped_or_filled() {
        assert_eq!(pixels(b"P2 3 1 255 1 2 3"), (2, vec![1, 2, 0, 0]));
        assert_eq!(pixels(b"P2 1 3 255 1 2 3"), (2, vec![1, 0, 2, 0]));
        assert_eq!(pixels(b"P3 1 1 255 1 2 3"), (3, [&[1, 2, 3], [0; 9].as_slice()].concat()));
    }

    #[test]
    fn damaged_files_are_rejected() {
        let file = b"P6 2 2 255\n\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b\x0c";
        for length in 0..file.len() {
            assert!(read(&file[..length], TWO_BY_TWO).is_err(), "cut after {length} bytes");
        }
        for file in [
            "",
            "P",
            "P8 1 1 255 1",
            "P2 1 1 0 0",
            "P2 1 1 70000 1",
            "P2 -1 1 255 1",
            "P2 1 1 255 x",
            "P1 1 1 2",
            "P5 4000000000 4000000000 255\n",
            "P4 99999 99999\n",
            "P7\nWIDTH 1\nHEIGHT 1\nDEPTH 1\nMAXVAL 255\nENDHDR\n0",
            "P2 1 1 99999999999 1",
        ] {
            assert!(read(file.as_bytes(), TWO_BY_TWO).is_err(), "{file}");
        }
        assert_eq!(
            read(b"P4 99999 99999\n", TWO_BY_TWO).unwrap_err().to_string(),
            "it ends before the 9999800001 pixels of its head"
        );
    }

    #[test]
    fn written_files_are_read_back() {
        let size = Size { width: 3, height: 2 };
        let (grey, colour): (Vec<u8>, Vec<u8>) = ((0..6).collect(), (0..18).collect());
        assert_eq!(read(&write_grey(size, &grey), size).unwrap(), Picture { kind: 5, pixels: grey });
        assert_eq!(read(&write_colour(size, &colour), size).unwrap(), Picture { kind: 6, pixels: colour });
        assert_eq!(write_grey(size, b"abcdef"), b"P5\n3 2\n255\nabcdef");
    }
}
