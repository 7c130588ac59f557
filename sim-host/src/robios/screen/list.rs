//! A list menu: lines over the whole width from the upper edge down, each of them a key.

use super::canvas::{BLACK, Canvas, Ink};
use super::font::{Family, Font, Size, Variation};
use super::menu::{self, MenuLabel};
use super::page::draw_glyph;

/// Height of a line in pixels: two rows of text of size 12.
pub const ROW: u16 = 26;

/// Left margin of a line's text in pixels.
const INDENT: i32 = 6;

const FONT: Font = Font { family: Family::Helvetica, variation: Variation::Normal, size: Size::Medium };

/// A line of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListLine {
    /// Text and colours.
    pub entry: MenuLabel,
    /// Code of the line's key; 0 for none.
    pub key: i32,
}

/// Number of lines that fit above the menu on a display of `height` rows of pixels.
pub fn max_lines(height: u16) -> usize {
    (height.saturating_sub(menu::HEIGHT) / ROW).into()
}

/// Draws the lines.
pub fn draw(lines: &[ListLine], canvas: &mut Canvas) {
    let right = canvas.size()[0] as i32 - 1;
    for (top, line) in (0..).step_by(ROW.into()).zip(lines) {
        canvas.fill_area([0, top], [right, top + i32::from(ROW) - 1], Ink::Colour(line.entry.paper));
        canvas.draw_rectangle([0, top], [right, top + i32::from(ROW) - 1], Ink::Colour(BLACK));
        let y = top + (i32::from(ROW) - i32::from(FONT.size.cell()[1])) / 2;
        let mut x = INDENT;
        for character in line.entry.text.chars().filter(|character| !character.is_control()) {
            let end = x + i32::from(FONT.advance(character));
            if end > right {
                break;
            }
            draw_glyph(canvas, [x, y], FONT, character, line.entry.ink);
            x = end;
        }
    }
}
