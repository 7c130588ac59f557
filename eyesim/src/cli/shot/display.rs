//! Picture of a robot's display, optionally in a frame with its keys.

use sim_host::robios::panel::Panel;
use sim_host::robios::screen::canvas::{Canvas, Ink, Rgb};
use sim_host::robios::screen::font::{Family, Font, Size, Variation};
use sim_host::robios::screen::{menu, page};

/// Picture of the display, enlarged by `scale` (`None`: 4 for a classic display, otherwise 2). With a caption, the
/// display is in a frame with the caption and the keys.
pub fn picture(panel: &Panel, scale: Option<u8>, caption: Option<&Caption>) -> Canvas {
    let scale = scale.map_or(if matches!(panel, Panel::Classic(_)) { 4 } else { 2 }, usize::from);
    let display = enlarged(&panel.picture(), scale);
    caption.map_or_else(|| display.clone(), |caption| framed(&display, caption))
}

/// Text above the display in the frame.
pub struct Caption {
    /// Number and name of the robot.
    pub name: String,
    /// Virtual time at which the picture is taken.
    pub time: String,
}

/// Width of the frame at the sides.
const SIDE: usize = 16;
/// Height of the frame above the display, with the caption.
const TOP: usize = 28;
/// Height of the frame below the display, with the keys.
const BOTTOM: usize = 46;
/// Colour of the frame.
const BODY: Rgb = [0x2b, 0x2f, 0x36];
/// Colour of its edges, and of the display's edges.
const EDGE: Rgb = [0x11, 0x13, 0x16];
/// Colour of the keys.
const KEY: Rgb = [0x58, 0x5f, 0x69];
/// Colour of text on frame and keys.
const INK: Rgb = [0xe8, 0xea, 0xed];

const LABEL: Font = Font { family: Family::Helvetica, variation: Variation::Normal, size: Size::Normal };

/// Enlarges each pixel to a square of `scale` x `scale`.
fn enlarged(display: &Canvas, scale: usize) -> Canvas {
    let [width, height] = display.size();
    let mut picture = Canvas::new(width * scale, height * scale, EDGE);
    let rows = display.pixels().chunks(width).flat_map(|row| std::iter::repeat_n(row, scale));
    let pixels = rows.flat_map(|row| row.iter().flat_map(|pixel| std::iter::repeat_n(*pixel, scale)));
    picture.show([0, 0], width * scale, pixels);
    picture
}

/// Draws the display in its frame, with each of the four keys below the columns in which a touch presses that key.
fn framed(display: &Canvas, caption: &Caption) -> Canvas {
    let [width, height] = display.size();
    let (left, right) = (SIDE as i32, (SIDE + width) as i32 - 1);
    let (top, bottom) = (TOP as i32, (TOP + height) as i32 - 1);
    let mut picture = Canvas::new(width + 2 * SIDE, height + TOP + BOTTOM, BODY);
    let [outer_right, outer_bottom] = picture.size().map(|side| side as i32 - 1);
    picture.draw_rectangle([0, 0], [outer_right, outer_bottom], Ink::Colour(EDGE));
    picture.draw_rectangle([left - 2, top - 2], [right + 2, bottom + 2], Ink::Colour(EDGE));
    picture.draw_rectangle([left - 1, top - 1], [right + 1, bottom + 1], Ink::Colour(EDGE));
    picture.show([left, top], width, display.pixels().iter().copied());
    let row = i32::from(LABEL.size.cell()[1]);
    let caption_top = (top - row) / 2;
    write(&mut picture, [left, caption_top], &caption.name);
    write(&mut picture, [right + 1 - text_width(&caption.time), caption_top], &caption.time);
    for index in 0..menu::KEYS {
        let [start, end] = menu::columns(index, width).map(|column| left + column as i32);
        let (key_left, key_right) = (start + 6, end - 7);
        let (key_top, key_bottom) = (bottom + 10, outer_bottom - 8);
        picture.fill_area([key_left, key_top + 2], [key_right, key_bottom - 2], Ink::Colour(KEY));
        picture.fill_area([key_left + 2, key_top], [key_right - 2, key_bottom], Ink::Colour(KEY));
        let label = format!("KEY{}", index + 1);
        let label_position =
            [(key_left + key_right + 1 - text_width(&label)) / 2, (key_top + key_bottom + 1 - row) / 2];
        write(&mut picture, label_position, &label);
    }
    picture
}

/// Width of a text on the frame, in pixels.
fn text_width(text: &str) -> i32 {
    text.chars().map(|character| i32::from(LABEL.advance(character))).sum()
}

fn write(picture: &mut Canvas, [mut x, y]: [i32; 2], text: &str) {
    for character in text.chars() {
        page::draw_glyph(picture, [x, y], LABEL, character, INK);
        x += i32::from(LABEL.advance(character));
    }
}
