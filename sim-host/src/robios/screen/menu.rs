//! The four keys at the lower edge of the display.

use super::canvas::{BLACK, Canvas, Ink, Rgb};
use super::font::{Family, Font, Size, Variation};
use super::page::draw_glyph;

/// Height of the menu in pixels. A display of 240 pixel rows has room for 16 rows of text of size 12 above it.
pub const HEIGHT: u16 = 32;

/// Number of keys.
pub const KEYS: usize = 4;

/// Text and colours of a menu key or of a line of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MenuLabel {
    /// Label; `\n` separates its lines.
    pub text: String,
    /// Colour of the text.
    pub ink: Rgb,
    /// Colour of the key.
    pub paper: Rgb,
}

/// Default colours of the keys from left to right: the colours of the remote control's buttons.
const PAPERS: [Rgb; KEYS] = [[0xff, 0, 0], [0, 0xff, 0], [0xff, 0xff, 0], [0x40, 0x80, 0xff]];

/// Entries of a menu whose labels are empty.
pub fn entries() -> [MenuLabel; KEYS] {
    PAPERS.map(|paper| MenuLabel { text: String::new(), ink: BLACK, paper })
}

/// Columns of key `index` on a display of `width` pixels: its first column and the next key's first column.
pub fn columns(index: usize, width: usize) -> [usize; 2] {
    [index * width / KEYS, (index + 1) * width / KEYS]
}

/// Draws the menu at the lower edge.
pub fn draw(entries: &[MenuLabel; KEYS], canvas: &mut Canvas) {
    let [width, height] = canvas.size();
    let top = height.saturating_sub(HEIGHT.into()) as i32;
    let bottom = height as i32 - 1;
    for (index, entry) in entries.iter().enumerate() {
        let [left, right] = columns(index, width).map(|column| column as i32);
        canvas.fill_area([left, top], [right - 1, bottom], Ink::Colour(entry.paper));
        canvas.draw_rectangle([left, top], [right - 1, bottom], Ink::Colour(BLACK));
        draw_label(entry, [left + 2, top + 1], [right - 3, bottom - 1], canvas);
    }
}

/// Draws a key's text in the middle of its field. In the normal size, the text is split into two lines if necessary. If
/// it does not fit, it is drawn in the smallest size and truncated.
fn draw_label(entry: &MenuLabel, [left, top]: [i32; 2], [right, bottom]: [i32; 2], canvas: &mut Canvas) {
    let (width, height) = (right - left + 1, bottom - top + 1);
    let font = |size| Font { family: Family::Helvetica, variation: Variation::Bold, size };
    let text_width = |line: &str, font: Font| -> i32 { line.chars().map(|c| i32::from(font.advance(c))).sum() };
    let fits = |lines: &[&str], font: Font| {
        let rows = lines.len() as i32 * i32::from(font.size.cell()[1]);
        rows <= height && lines.iter().all(|line| text_width(line, font) <= width)
    };
    let lines: Vec<&str> = entry.text.split('\n').map(str::trim).collect();
    // Split at the space nearest to the middle.
    let halves = entry.text.char_indices().filter(|(_, character)| *character == ' ');
    let halves = halves.min_by_key(|(index, _)| index.abs_diff(entry.text.len() / 2));
    let halves = halves.map(|(index, _)| vec![entry.text[..index].trim(), entry.text[index..].trim()]);
    let (lines, font) = match halves {
        _ if fits(&lines, font(Size::Normal)) => (lines, font(Size::Normal)),
        Some(halves) if fits(&halves, font(Size::Normal)) => (halves, font(Size::Normal)),
        _ => (lines, font(Size::Tiny)),
    };
    let row_height = i32::from(font.size.cell()[1]);
    let text_top = top + ((height - lines.len() as i32 * row_height) / 2).max(0);
    for (y, line) in
        (text_top..).step_by(row_height as usize).zip(&lines).take_while(|(y, _)| y + row_height <= bottom + 1)
    {
        let mut x = left + ((width - text_width(line, font)) / 2).max(0);
        for character in line.chars().filter(|character| !character.is_control()) {
            let end = x + i32::from(font.advance(character));
            if end > right + 1 {
                break;
            }
            draw_glyph(canvas, [x, y], font, character, entry.ink);
            x = end;
        }
    }
}
