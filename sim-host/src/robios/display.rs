//! Display functions of RoBIOS 6, based on the model in [`super::lcd`].
//!
//! Source: RoBIOS 6 library, LCD output. Text written at a position leaves the cursor after the text.

use robios_sys::robios6::{BitImage, CURSOR, ColImage, Image, SCROLLING};
use robios_sys::{Out, Robios6Call as Call};

use super::lcd::{Ink, InvalidPosition, Lcd};
use super::robot::Robot;
use super::{image, text};
use sim_core::record::Event;

/// Columns of the part of an image that is shown.
const SHOWN_COLUMNS: usize = 80;

/// Maximum width and number of decimals of `LCDPutFloatS` and `LCDPutIntS`: all characters of the display.
const MAX_FORMAT: i32 = 112;

/// Writes text at the cursor.
pub fn write(robot: &mut Robot, characters: &[u8]) {
    let (row, column) = robot.robios.lcd.position();
    let event = Event::LcdText { row: row as u8, column: column as u8, text: &text(characters) };
    robot.state.journal.record(robot.state.now, &event);
    robot.robios.lcd.write(characters);
}

/// `LCDPrintf`, `LCDPutString`
pub fn put(robot: &mut Robot, call: Call, characters: Option<&[u8]>) -> i32 {
    let Some(characters) = characters else { return robot.fail_call(call, -1) };
    write(robot, characters);
    0
}

/// `LCDSetPrintf`, `LCDSetString`, `LCDSetChar`
pub fn put_at(robot: &mut Robot, call: Call, [row, column]: [i32; 2], characters: Option<&[u8]>) -> i32 {
    let Some(characters) = characters else { return robot.fail_call(call, -1) };
    match robot.robios.lcd.set_position(row, column) {
        Ok(()) => put(robot, call, Some(characters)),
        Err(InvalidPosition) => robot.fail_call(call, -1),
    }
}

/// `LCDClear`
pub fn clear(robot: &mut Robot) -> i32 {
    robot.robios.lcd.clear();
    robot.record(Event::LcdClear {});
    0
}

/// `LCDPutIntS`
pub fn put_int(robot: &mut Robot, value: i32, spaces: i32) -> i32 {
    let width = spaces.clamp(0, MAX_FORMAT) as usize;
    put(robot, Call::LCDPutIntS, Some(format!("{value:width$}").as_bytes()))
}

/// `LCDPutFloatS`
pub fn put_float(robot: &mut Robot, value: f32, spaces: i32, decimals: i32) -> i32 {
    let (width, decimals) = (spaces.clamp(0, MAX_FORMAT) as usize, decimals.clamp(0, MAX_FORMAT) as usize);
    let number =
        if value.is_nan() { format!("{:>width$}", "nan") } else { format!("{:width$.decimals$}", f64::from(value)) };
    put(robot, Call::LCDPutFloatS, Some(number.as_bytes()))
}

/// `LCDMode`
pub fn set_mode(robot: &mut Robot, mode: i32) -> i32 {
    robot.robios.lcd.is_scrolling = mode & SCROLLING != 0;
    robot.robios.lcd.has_cursor = mode & CURSOR != 0;
    0
}

/// `LCDSetPos`
pub fn set_position(robot: &mut Robot, row: i32, column: i32) -> i32 {
    match robot.robios.lcd.set_position(row, column) {
        Ok(()) => 0,
        Err(InvalidPosition) => robot.fail_call(Call::LCDSetPos, -1),
    }
}

/// `LCDGetPos`
pub fn position(robot: &mut Robot, row: &mut Out<i32>, column: &mut Out<i32>) -> i32 {
    if row.is_null() || column.is_null() {
        return robot.fail_call(Call::LCDGetPos, -1);
    }
    let position = robot.robios.lcd.position();
    row.set(position.0 as i32);
    column.set(position.1 as i32);
    0
}

/// `LCDMenu`
pub fn set_menu(robot: &mut Robot, texts: [Option<&[u8]>; 4]) -> i32 {
    for (position, text) in (1..).zip(texts) {
        set_menu_text(robot, position, text.unwrap_or_default());
    }
    0
}

/// `LCDMenuI`
pub fn set_menu_entry(robot: &mut Robot, position: i32, text: Option<&[u8]>) -> i32 {
    match text {
        Some(text) if (1..=4).contains(&position) => set_menu_text(robot, position, text),
        _ => return robot.fail_call(Call::LCDMenuI, -1),
    }
    0
}

fn set_menu_text(robot: &mut Robot, position: i32, characters: &[u8]) {
    if !characters.is_empty() && robot.robios.lcd.set_menu(position, characters).is_ok() {
        robot.record(Event::LcdMenu { position: position as u8, text: &text(characters) });
    }
}

/// `LCDPutGraphic`
pub fn put_grey(robot: &mut Robot, grey: Option<&Image>) -> i32 {
    let Some(grey) = grey else { return robot.fail_call(Call::LCDPutGraphic, -1) };
    let changed = robot.robios.lcd.show_grey(image::shown_pixels(grey), SHOWN_COLUMNS);
    record_drawing(robot, Call::LCDPutGraphic, changed)
}

/// `LCDPutColorGraphic`: overwrites the image with what the display shows, in black and white.
pub fn put_colour(robot: &mut Robot, colour: Option<&mut ColImage>) -> i32 {
    let Some(colour) = colour else { return robot.fail_call(Call::LCDPutColorGraphic, -1) };
    let dithered = image::dither(&image::grey_from_colour(colour));
    for (row, levels) in colour.iter_mut().zip(&dithered) {
        row.iter_mut().zip(levels).for_each(|(pixel, level)| *pixel = [*level; 3]);
    }
    let changed = robot.robios.lcd.show_grey(image::shown_pixels(&dithered), SHOWN_COLUMNS);
    record_drawing(robot, Call::LCDPutColorGraphic, changed)
}

/// `LCDPutImage`
pub fn put_picture(robot: &mut Robot, picture: Option<&BitImage>) -> i32 {
    let Some(picture) = picture else { return robot.fail_call(Call::LCDPutImage, -1) };
    let changed = robot.robios.lcd.show_picture(picture);
    record_drawing(robot, Call::LCDPutImage, changed)
}

/// `LCDGetPixel`
pub fn pixel(robot: &mut Robot, row: i32, column: i32) -> i32 {
    match robot.robios.lcd.pixel(row, column) {
        Ok(is_black) => is_black.into(),
        Err(InvalidPosition) => robot.fail_call(Call::LCDGetPixel, -1),
    }
}

/// `LCDSetPixel`, `LCDInvertPixel`, `LCDLine`, `LCDArea`: draws with the ink of `code`.
pub fn draw(
    robot: &mut Robot,
    call: Call,
    code: i32,
    shape: impl FnOnce(&mut Lcd, Ink) -> Result<u32, InvalidPosition>,
) -> i32 {
    match Ink::try_from(code).and_then(|ink| shape(&mut robot.robios.lcd, ink)) {
        Ok(changed) => record_drawing(robot, call, changed),
        Err(InvalidPosition) => robot.fail_call(call, -1),
    }
}

fn record_drawing(robot: &mut Robot, call: Call, changed_pixels: u32) -> i32 {
    robot.record(Event::LcdGraphics { function: call.name(), changed_pixels });
    0
}
