//! The display: 128 x 64 pixels, 7 lines of 16 characters, the last one for the menu.

use std::fmt::Arguments;

use robios_sys::ByteSlice;
use robios_sys::robios6::{BitImage, CURSOR, ColImage, Image, NOCURSOR, NONSCROLLING, SCROLLING};

use crate::device::Device;
use crate::error::checked;
use crate::key::Key;
use crate::robot::robios;
use crate::{Result, Robot};

/// The display, written to with `write!` and `writeln!`; writing returns no result.
///
/// ```
/// # use robios_api::prelude::*;
/// fn hello(robot: &Robot) -> Result {
///     writeln!(robot.lcd(), "hello");
///     write!(robot.lcd().at(3, 10), "{:.2}", 0.5)?;
///     Ok(())
/// }
/// # let run = robios_api::fake::Fake::new().run(hello);
/// # assert_eq!((run.lcd_line(0), run.lcd_line(3)), ("hello", "          0.50"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Lcd<'r>(pub(crate) &'r Robot);

/// A text position on the display, see [`Lcd::at`].
#[derive(Clone, Copy, Debug)]
pub struct LcdPlace<'r> {
    robot: &'r Robot,
    row: u8,
    column: u8,
}

/// Behaviour of text that overflows the last line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overflow {
    /// Text continues in the first line.
    Wrap,
    /// All lines move up.
    Scroll,
}

/// Visibility of the cursor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cursor {
    /// The cursor is shown.
    Shown,
    /// The cursor is hidden.
    Hidden,
}

/// Effect of drawing on a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Clears the pixel.
    White,
    /// Sets the pixel.
    Black,
    /// Inverts the pixel.
    Invert,
}

impl Ink {
    fn code(self) -> i32 {
        match self {
            Self::White => 0,
            Self::Black => 1,
            Self::Invert => 2,
        }
    }
}

/// A pixel of a display or an image: x from the left, y from the top. The display of RoBIOS 6 has (0, 0) to (127, 63);
/// shapes may extend beyond it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixel {
    /// From the left.
    pub x: i32,
    /// From the top.
    pub y: i32,
}

impl<'r> Lcd<'r> {
    /// Writes formatted text at the cursor; called by `write!` and `writeln!`. `\n` starts a new line.
    #[track_caller]
    pub fn write_fmt(&self, text: Arguments<'_>) {
        let text = text.to_string();
        let _: i32 = robios!(self.0, LCDPutString(ByteSlice::from(text.as_str())));
    }

    /// A text position to write to: row 0 (top) to 6, column 0 (left) to 15.
    pub fn at(&self, row: u8, column: u8) -> LcdPlace<'r> {
        LcdPlace { robot: self.0, row, column }
    }

    /// Moves the cursor: row 0 (top) to 6, column 0 (left) to 15.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if the position is not on the display.
    #[track_caller]
    pub fn move_cursor(&self, row: u8, column: u8) -> Result {
        checked("LCDSetPos", Device::Lcd, robios!(self.0, LCDSetPos(row.into(), column.into())))
    }

    /// Row and column of the cursor.
    #[track_caller]
    pub fn cursor(&self) -> (u8, u8) {
        let (mut row, mut column) = (0, 0);
        let _: i32 = robios!(self.0, LCDGetPos(&mut row, &mut column));
        (row as u8, column as u8)
    }

    /// Clears the display and the menu; the cursor goes to the top left.
    #[track_caller]
    pub fn clear(&self) {
        let _: i32 = robios!(self.0, LCDClear());
    }

    /// Sets the text mode.
    #[track_caller]
    pub fn set_mode(&self, overflow: Overflow, cursor: Cursor) {
        let overflow = match overflow {
            Overflow::Wrap => NONSCROLLING,
            Overflow::Scroll => SCROLLING,
        };
        let cursor = match cursor {
            Cursor::Shown => CURSOR,
            Cursor::Hidden => NOCURSOR,
        };
        let _: i32 = robios!(self.0, LCDMode(overflow | cursor));
    }

    /// Writes the texts above the keys, at most 4 characters each; `""` leaves a text unchanged, `" "` clears it.
    #[track_caller]
    pub fn menu(&self, texts: [&str; 4]) {
        let [first, second, third, fourth] = texts.map(ByteSlice::from);
        let _: i32 = robios!(self.0, LCDMenu(first, second, third, fourth));
    }

    /// Writes the text above one key, at most 4 characters.
    #[track_caller]
    pub fn menu_entry(&self, key: Key, text: &str) {
        let position = key as i32 + 1;
        let _: i32 = robios!(self.0, LCDMenuI(position, ByteSlice::from(text)));
    }

    /// Sets, clears or inverts a pixel.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if it is not on the display.
    #[track_caller]
    pub fn set_pixel(&self, pixel: Pixel, ink: Ink) -> Result {
        let code = match ink {
            Ink::Invert => robios!(self.0, LCDInvertPixel(pixel.y, pixel.x)),
            ink => robios!(self.0, LCDSetPixel(pixel.y, pixel.x, ink.code())),
        };
        checked("LCDSetPixel", Device::Lcd, code)
    }

    /// Returns true if a pixel is set; `None` if it is not on the display.
    #[track_caller]
    pub fn pixel(&self, pixel: Pixel) -> Option<bool> {
        match robios!(self.0, LCDGetPixel(pixel.y, pixel.x)) {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    /// Draws a line, both ends included; parts outside of the display are clipped.
    #[track_caller]
    pub fn line(&self, from: Pixel, to: Pixel, ink: Ink) {
        let _: i32 = robios!(self.0, LCDLine(from.x, from.y, to.x, to.y, ink.code()));
    }

    /// Fills a rectangle, all edges included; parts outside of the display are clipped.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if `bottom_right` does not lie below and to the right of `top_left`.
    #[track_caller]
    pub fn area(&self, top_left: Pixel, bottom_right: Pixel, ink: Ink) -> Result {
        let code = robios!(self.0, LCDArea(top_left.x, top_left.y, bottom_right.x, bottom_right.y, ink.code()));
        checked("LCDArea", Device::Lcd, code)
    }

    /// Sets all pixels: 64 rows of 16 bytes, the left pixel in the highest bit, 1 is black.
    #[track_caller]
    pub fn put_image(&self, image: &BitImage) {
        let _: i32 = robios!(self.0, LCDPutImage(image));
    }

    /// Shows the upper 54 rows of a grey image at the left of the display.
    #[track_caller]
    pub fn put_graphic(&self, image: &Image) {
        let _: i32 = robios!(self.0, LCDPutGraphic(image));
    }

    /// Shows the upper 54 rows of a colour image in black and white, which overwrites the image.
    #[track_caller]
    pub fn put_color_graphic(&self, image: &mut ColImage) {
        let _: i32 = robios!(self.0, LCDPutColorGraphic(image));
    }
}

impl LcdPlace<'_> {
    /// Writes formatted text at the position; called by `write!` and `writeln!`.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if the position is not on the display.
    #[track_caller]
    pub fn write_fmt(&self, text: Arguments<'_>) -> Result {
        let text = text.to_string();
        let (row, column) = (self.row.into(), self.column.into());
        let code = robios!(self.robot, LCDSetString(row, column, ByteSlice::from(text.as_str())));
        checked("LCDSetString", Device::Lcd, code)
    }
}
