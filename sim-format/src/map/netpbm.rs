//! Grey images of Netpbm, PGM (`P2`, `P5`) and PBM (`P1`, `P4`), as map servers write them.

use super::grid::MAX_CELLS;
use super::{byte_suffix, span_of_bytes};
use crate::code::Code;
use crate::diagnostic::Sink;

/// A grey image, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// Brightness of each pixel, from 0, black, to `white`.
    pub(crate) levels: Vec<u32>,
    /// Brightness of white pixels.
    pub(crate) white: u32,
    /// Grey value of white in the file, such as 255 for 8 bits.
    pub(crate) max_grey: u32,
    /// For each pixel, true if it is not opaque; empty if all are opaque.
    pub(crate) is_transparent: Vec<bool>,
}

const FORM: &str =
    "a PGM (`P2` or `P5`) or PBM (`P1` or `P4`): width, height, greatest grey value (1 to 65535), pixels";

/// Returns true for the first bytes of a PGM or PBM.
pub(crate) fn is_netpbm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'1' | b'2' | b'4' | b'5', next, ..] if next.is_ascii_whitespace() || *next == b'#')
}

/// Reads a PGM or PBM; `None`, with an error, if it cannot be read. Missing pixels are an error, extra bytes a warning.
pub(crate) fn read_netpbm(sink: &mut Sink, bytes: &[u8]) -> Option<Image> {
    let mut words = Words { bytes, position: 2 };
    let kind = match bytes {
        _ if is_netpbm(bytes) => bytes[1],
        [b'P', b'3' | b'6' | b'7', ..] => {
            let message = "the image has colours (PPM or PAM)";
            sink.error(Code::MapImage, span_of_bytes(bytes, 0, 2), message, FORM);
            return None;
        }
        _ => {
            let message = "the file does not begin with `P1`, `P2`, `P4` or `P5`";
            sink.error(Code::MapImage, Default::default(), message, FORM);
            return None;
        }
    };
    let is_bitmap = matches!(kind, b'1' | b'4');
    let is_raw = matches!(kind, b'4' | b'5');
    let columns = words.next_number(sink, "the width", MAX_CELLS)?;
    let rows = words.next_number(sink, "the height", MAX_CELLS)?;
    let max_grey = if is_bitmap { 1 } else { words.next_number(sink, "the greatest grey value", 65535)? };
    if columns == 0 || rows == 0 || columns * rows > MAX_CELLS {
        let message = format!("the image has {columns} x {rows} pixels");
        sink.error(Code::MapSize, Default::default(), message, "1 to 67,108,864 pixels, such as 8192 x 8192");
        return None;
    }
    if max_grey == 0 {
        let message = "the greatest grey value is 0";
        sink.error(Code::MapImage, span_of_bytes(bytes, words.position - 1, 1), message, "1 to 65535");
        return None;
    }
    let size = [columns as usize, rows as usize];
    let levels = match (is_raw, is_bitmap) {
        (true, true) => raw_bits(sink, &words, size)?,
        (true, false) => raw_levels(sink, &words, size, max_grey)?,
        (false, true) => text_bits(sink, words, size)?,
        (false, false) => text_levels(sink, words, size, max_grey)?,
    };
    Some(Image { size, levels, white: max_grey as u32, max_grey: max_grey as u32, is_transparent: Vec::new() })
}

/// The words of a header or of pixels in text, without comments from `#` to the end of the line.
struct Words<'b> {
    bytes: &'b [u8],
    position: usize,
}

impl<'b> Words<'b> {
    /// Skips blanks and comments.
    fn skip_blanks(&mut self) {
        while let Some(byte) = self.bytes.get(self.position) {
            if *byte == b'#' {
                let rest = &self.bytes[self.position..];
                self.position += rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
            } else if byte.is_ascii_whitespace() {
                self.position += 1;
            } else {
                break;
            }
        }
    }

    /// The next word and its position; `None` at the end of the file.
    fn next_word(&mut self) -> Option<(usize, &'b [u8])> {
        self.skip_blanks();
        let start = self.position;
        let rest = self.bytes.get(start..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'#').unwrap_or(rest.len());
        self.position += length;
        Some((start, &rest[..length]))
    }

    /// The next word as a number up to `max`; reports any other word.
    fn next_number(&mut self, sink: &mut Sink, name: &str, max: u64) -> Option<u64> {
        let Some((start, word)) = self.next_word() else {
            let message = format!("the file ends after {} bytes, before {name}", self.bytes.len());
            sink.error(Code::MapImage, Default::default(), message, FORM);
            return None;
        };
        let value = std::str::from_utf8(word).ok().filter(|word| word.bytes().all(|byte| byte.is_ascii_digit()));
        match value.and_then(|word| word.parse::<u64>().ok()) {
            Some(value) if value <= max => Some(value),
            Some(value) => {
                let message = format!("{name} is {value}{}", byte_suffix(self.bytes, start));
                sink.error(Code::MapSize, span_of_bytes(self.bytes, start, word.len()), message, format!("0 to {max}"));
                None
            }
            None => {
                let word_text = String::from_utf8_lossy(&word[..word.len().min(20)]).into_owned();
                let message = format!("`{word_text}` is not a whole number ({name}){}", byte_suffix(self.bytes, start));
                sink.error(Code::MapImage, span_of_bytes(self.bytes, start, word.len()), message, FORM);
                None
            }
        }
    }
}

/// The bytes of the pixels, after the single blank that ends the header; reports too few and too many bytes.
fn raw_pixels<'b>(sink: &mut Sink, words: &Words<'b>, byte_count: usize) -> Option<&'b [u8]> {
    let pixels = words.bytes.get(words.position + 1..).unwrap_or_default();
    if pixels.len() < byte_count {
        let message =
            format!("the pixels end at byte {}: {} of {byte_count} bytes are there", words.bytes.len(), pixels.len());
        sink.error(Code::MapImage, Default::default(), message, "as many pixels as width times height");
        return None;
    }
    if pixels[byte_count..].iter().any(|byte| !byte.is_ascii_whitespace()) {
        let message = format!("{} bytes after the last pixel are left over", pixels.len() - byte_count);
        sink.warn(
            Code::MapImage,
            Default::default(),
            message,
            "one image in a file, as wide and high as its header says",
        );
    }
    Some(&pixels[..byte_count])
}

fn raw_bits(sink: &mut Sink, words: &Words<'_>, [columns, rows]: [usize; 2]) -> Option<Vec<u32>> {
    let bytes_per_row = columns.div_ceil(8);
    let pixels = raw_pixels(sink, words, bytes_per_row * rows)?;
    let bits = pixels
        .chunks_exact(bytes_per_row)
        .flat_map(|row| (0..columns).map(|column| row[column / 8] >> (7 - column % 8) & 1));
    Some(bits.map(|bit| u32::from(bit == 0)).collect())
}

fn raw_levels(sink: &mut Sink, words: &Words<'_>, [columns, rows]: [usize; 2], max_grey: u64) -> Option<Vec<u32>> {
    let grey = |value: u16| u32::from(value).min(max_grey as u32);
    if max_grey < 256 {
        let pixels = raw_pixels(sink, words, columns * rows)?;
        return Some(pixels.iter().map(|byte| grey(u16::from(*byte))).collect());
    }
    let pixels = raw_pixels(sink, words, 2 * columns * rows)?;
    Some(pixels.as_chunks().0.iter().map(|pair| grey(u16::from_be_bytes(*pair))).collect())
}

/// Pixels as the digits 0 and 1 in text, which may follow each other without blanks.
fn text_bits(sink: &mut Sink, mut words: Words<'_>, [columns, rows]: [usize; 2]) -> Option<Vec<u32>> {
    if words.bytes.len() < columns * rows {
        return report_too_few(sink, words.bytes, words.bytes.len(), columns * rows);
    }
    let mut levels = Vec::with_capacity(columns * rows);
    while levels.len() < columns * rows {
        words.skip_blanks();
        let Some(byte) = words.bytes.get(words.position) else {
            return report_too_few(sink, words.bytes, levels.len(), columns * rows);
        };
        if !matches!(byte, b'0' | b'1') {
            let message =
                format!("`{}` is not a pixel{}", byte.escape_ascii(), byte_suffix(words.bytes, words.position));
            sink.error(
                Code::MapImage,
                span_of_bytes(words.bytes, words.position, 1),
                message,
                "`0` (white) or `1` (black)",
            );
            return None;
        }
        levels.push(u32::from(*byte == b'0'));
        words.position += 1;
    }
    warn_of_left_over(sink, words);
    Some(levels)
}

fn text_levels(sink: &mut Sink, mut words: Words<'_>, [columns, rows]: [usize; 2], max_grey: u64) -> Option<Vec<u32>> {
    // A pixel takes at least two bytes, except the last one.
    if words.bytes.len().div_ceil(2) < columns * rows {
        return report_too_few(sink, words.bytes, words.bytes.len() / 2, columns * rows);
    }
    let mut levels = Vec::with_capacity(columns * rows);
    while levels.len() < columns * rows {
        words.skip_blanks();
        if words.position >= words.bytes.len() {
            return report_too_few(sink, words.bytes, levels.len(), columns * rows);
        }
        levels.push(words.next_number(sink, "a pixel", max_grey)? as u32);
    }
    warn_of_left_over(sink, words);
    Some(levels)
}

fn report_too_few<T>(sink: &mut Sink, bytes: &[u8], count: usize, pixel_count: usize) -> Option<T> {
    let message =
        format!("the file ends after {} bytes: at most {count} of {pixel_count} pixels are there", bytes.len());
    sink.error(Code::MapImage, Default::default(), message, "as many pixels as width times height");
    None
}

fn warn_of_left_over(sink: &mut Sink, mut words: Words<'_>) {
    if let Some((start, word)) = words.next_word() {
        let message = format!("something is left over after the last pixel{}", byte_suffix(words.bytes, start));
        let span = span_of_bytes(words.bytes, start, word.len());
        sink.warn(Code::MapImage, span, message, "one image in a file, as wide and high as its header says");
    }
}
