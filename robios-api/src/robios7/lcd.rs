//! The colour display.

use std::fmt::{self, Arguments, Display, Formatter};

use robios_sys::ByteSlice;
use robios_sys::robios7 as sys;

use super::{ColorImage, GrayImage, ImageSize, Robot};
use crate::Result;
use crate::device::Device;
use crate::error::checked;
use crate::key::Key;
use crate::lcd::Pixel;
use crate::robot::robios7;

/// The colour display, written to with `write!` and `writeln!`; writing returns no result.
///
/// ```
/// # use robios_api::robios7::prelude::*;
/// fn hello(robot: &Robot) -> Result {
///     robot.lcd().set_color(Color::YELLOW, Color::NAVY);
///     writeln!(robot.lcd(), "hello");
///     write!(robot.lcd().at(3, 10), "{:.2}", 0.5)?;
///     Ok(())
/// }
/// # let run = robios_api::fake::Fake::new().run_robios7(hello);
/// # assert_eq!((run.lcd_line(0), run.lcd_line(3)), ("hello", "          0.50"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Lcd<'r>(pub(super) &'r Robot);

/// A text position on the display, see [`Lcd::at`].
#[derive(Clone, Copy, Debug)]
pub struct LcdPlace<'r> {
    robot: &'r Robot,
    row: u8,
    column: u8,
}

/// A colour of 24 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Color {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
}

macro_rules! colors {
    ($($NAME:ident),* $(,)?) => {$(
        #[doc = concat!("`", stringify!($NAME), "`")]
        pub const $NAME: Self = Self::from_robios(sys::$NAME);
    )*};
}

impl Color {
    colors! {
        RED, GREEN, BLUE, WHITE, GRAY, BLACK, SILVER, LIGHTGRAY, DARKGRAY, NAVY, CYAN, TEAL, MAGENTA, PURPLE, MAROON,
        YELLOW, OLIVE, ORANGE,
    }

    /// Creates a colour from its components.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    pub(crate) const fn from_robios(color: sys::Color) -> Self {
        let [_, red, green, blue] = color.to_be_bytes();
        Self { red, green, blue }
    }

    pub(crate) const fn to_robios(self) -> sys::Color {
        i32::from_be_bytes([0, self.red, self.green, self.blue])
    }
}

impl Display for Color {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "#{:06X}", self.to_robios())
    }
}

/// Font of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Font {
    /// Without serifs.
    Helvetica,
    /// With serifs.
    Times,
    /// All characters of one width.
    Courier,
}

/// Style of a font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FontStyle {
    /// Upright, of normal weight.
    Normal,
    /// Bold.
    Bold,
    /// Slanted.
    Italics,
}

/// Size of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FontSize {
    /// 8 points.
    S8,
    /// 12 points.
    S12,
    /// 14 points.
    S14,
    /// 18 points.
    S18,
    /// 24 points.
    S24,
}

/// Filling of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// The shape is filled.
    Filled,
    /// Only its outline is drawn.
    Outline,
}

/// A mode of the display. [`Lcd::set_mode`] sets one mode and leaves modes of other kinds unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LcdMode {
    /// Text that overflows the last line moves all lines up.
    Scrolling,
    /// Text that overflows the last line continues in the first.
    Wrapping,
    /// Each call is shown immediately.
    AutoRefresh,
    /// Drawings are shown by [`Lcd::refresh`].
    ManualRefresh,
    /// Text is drawn over the existing content.
    Transparent,
    /// Text has a background.
    Opaque,
    /// The menu is shown.
    MenuShown,
    /// The menu is not shown.
    MenuHidden,
}

impl LcdMode {
    const fn code(self) -> i32 {
        match self {
            Self::Scrolling => sys::LCD_SCROLLING,
            Self::Wrapping => sys::LCD_NOSCROLLING,
            Self::AutoRefresh => sys::LCD_AUTOREFRESH,
            Self::ManualRefresh => sys::LCD_NOAUTOREFRESH,
            Self::Transparent => sys::LCD_BGCOL_TRANSPARENT,
            Self::Opaque => sys::LCD_BGCOL_NOTRANSPARENT,
            Self::MenuShown => sys::LCD_SHOWMENU,
            Self::MenuHidden => sys::LCD_HIDEMENU,
        }
    }
}

impl<'r> Lcd<'r> {
    /// Writes formatted text at the cursor; called by `write!` and `writeln!`. `\n` starts a new line.
    #[track_caller]
    pub fn write_fmt(&self, text: Arguments<'_>) {
        let text = text.to_string();
        let _: i32 = robios7!(self.0, LCDPrintf(ByteSlice::from(text.as_str())));
    }

    /// A text position to write to: row and column of characters, from 0 at the top left.
    pub fn at(&self, row: u8, column: u8) -> LcdPlace<'r> {
        LcdPlace { robot: self.0, row, column }
    }

    /// Moves the cursor: row and column of characters, from 0 at the top left. The simulator gives a hint at a position
    /// that is not on the display.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the position.
    #[track_caller]
    pub fn move_cursor(&self, row: u8, column: u8) -> Result {
        checked("LCDSetPos", Device::Lcd, robios7!(self.0, LCDSetPos(row.into(), column.into())))
    }

    /// Row and column of the cursor.
    #[track_caller]
    pub fn cursor(&self) -> (u8, u8) {
        let (mut row, mut column) = (0, 0);
        let _: i32 = robios7!(self.0, LCDGetPos(&mut row, &mut column));
        (row as u8, column as u8)
    }

    /// Clears the display; the cursor goes to the top left.
    #[track_caller]
    pub fn clear(&self) {
        let _: i32 = robios7!(self.0, LCDClear());
    }

    /// Sets the colours of text.
    #[track_caller]
    pub fn set_color(&self, text: Color, background: Color) {
        let _: i32 = robios7!(self.0, LCDSetColor(text.to_robios(), background.to_robios()));
    }

    /// Sets the font of text.
    #[track_caller]
    pub fn set_font(&self, font: Font, style: FontStyle) {
        let font = match font {
            Font::Helvetica => sys::HELVETICA,
            Font::Times => sys::TIMES,
            Font::Courier => sys::COURIER,
        };
        let style = match style {
            FontStyle::Normal => sys::NORMAL,
            FontStyle::Bold => sys::BOLD,
            FontStyle::Italics => sys::ITALICS,
        };
        let _: i32 = robios7!(self.0, LCDSetFont(font, style));
    }

    /// Sets the size of text.
    #[track_caller]
    pub fn set_font_size(&self, size: FontSize) {
        let size = match size {
            FontSize::S8 => 8,
            FontSize::S12 => 12,
            FontSize::S14 => 14,
            FontSize::S18 => 18,
            FontSize::S24 => 24,
        };
        let _: i32 = robios7!(self.0, LCDSetFontSize(size));
    }

    /// Sets a mode.
    #[track_caller]
    pub fn set_mode(&self, mode: LcdMode) {
        let _: i32 = robios7!(self.0, LCDSetMode(mode.code()));
    }

    /// Sets the labels of the keys; an empty text clears a label.
    #[track_caller]
    pub fn menu(&self, texts: [&str; 4]) {
        let [first, second, third, fourth] = texts.map(ByteSlice::from);
        let _: i32 = robios7!(self.0, LCDMenu(first, second, third, fourth));
    }

    /// Sets the label of one key, with its colours.
    #[track_caller]
    pub fn menu_item(&self, key: Key, text: &str, color: Color, background: Color) {
        let number = 1 + Key::ALL.iter().position(|other| *other == key).unwrap_or(0) as i32;
        let (color, background) = (color.to_robios(), background.to_robios());
        let _: i32 = robios7!(self.0, LCDMenuI(number, ByteSlice::from(text), color, background));
    }

    /// Size of the display: number of columns as `x`, number of rows as `y`.
    #[track_caller]
    pub fn size(&self) -> Pixel {
        let mut size = Pixel { x: 0, y: 0 };
        let _: i32 = robios7!(self.0, LCDGetSize(&mut size.x, &mut size.y));
        size
    }

    /// Colours one pixel; all drawing functions clip at the edges of the display.
    #[track_caller]
    pub fn set_pixel(&self, pixel: Pixel, color: Color) {
        let _: i32 = robios7!(self.0, LCDPixel(pixel.x, pixel.y, color.to_robios()));
    }

    /// The colour of one pixel; black outside of the display.
    #[track_caller]
    pub fn pixel(&self, pixel: Pixel) -> Color {
        Color::from_robios(robios7!(self.0, LCDGetPixel(pixel.x, pixel.y)))
    }

    /// Draws a line, both ends included.
    #[track_caller]
    pub fn line(&self, from: Pixel, to: Pixel, color: Color) {
        let _: i32 = robios7!(self.0, LCDLine(from.x, from.y, to.x, to.y, color.to_robios()));
    }

    /// Draws a rectangle between two corners.
    #[track_caller]
    pub fn area(&self, corner: Pixel, opposite: Pixel, color: Color, fill: Fill) {
        let fill = i32::from(fill == Fill::Filled);
        let _: i32 = robios7!(self.0, LCDArea(corner.x, corner.y, opposite.x, opposite.y, color.to_robios(), fill));
    }

    /// Draws a circle with a radius in pixels.
    #[track_caller]
    pub fn circle(&self, centre: Pixel, radius_px: u16, color: Color, fill: Fill) {
        let fill = i32::from(fill == Fill::Filled);
        let _: i32 = robios7!(self.0, LCDCircle(centre.x, centre.y, radius_px.into(), color.to_robios(), fill));
    }

    /// Inverts a line, both ends included.
    #[track_caller]
    pub fn invert_line(&self, from: Pixel, to: Pixel) {
        let _: i32 = robios7!(self.0, LCDLineInvert(from.x, from.y, to.x, to.y));
    }

    /// Inverts a filled rectangle.
    #[track_caller]
    pub fn invert_area(&self, corner: Pixel, opposite: Pixel) {
        let _: i32 = robios7!(self.0, LCDAreaInvert(corner.x, corner.y, opposite.x, opposite.y));
    }

    /// Inverts a filled circle.
    #[track_caller]
    pub fn invert_circle(&self, centre: Pixel, radius_px: u16) {
        let _: i32 = robios7!(self.0, LCDCircleInvert(centre.x, centre.y, radius_px.into()));
    }

    /// Shows a colour image with its upper left corner at a pixel.
    #[track_caller]
    pub fn image(&self, at: Pixel, image: &ColorImage) {
        self.image_start(at, image.size());
        let (columns, rows) = image.size().to_robios7();
        let _: i32 = robios7!(self.0, LCDImage(columns, rows, ByteSlice::from(image.bytes())));
    }

    /// Shows a grey image with its upper left corner at a pixel.
    #[track_caller]
    pub fn gray_image(&self, at: Pixel, image: &GrayImage) {
        self.image_start(at, image.size());
        let (columns, rows) = image.size().to_robios7();
        let _: i32 = robios7!(self.0, LCDImageGray(columns, rows, ByteSlice::from(image.bytes())));
    }

    /// Shows an image of two values with its upper left corner at a pixel: 0 is white, everything else black.
    #[track_caller]
    pub fn binary_image(&self, at: Pixel, image: &GrayImage) {
        self.image_start(at, image.size());
        let (columns, rows) = image.size().to_robios7();
        let _: i32 = robios7!(self.0, LCDImageBinary(columns, rows, ByteSlice::from(image.bytes())));
    }

    #[track_caller]
    fn image_start(&self, at: Pixel, size: ImageSize) {
        let (columns, rows) = size.to_robios7();
        let _: i32 = robios7!(self.0, LCDImageStart(at.x, at.y, columns, rows));
    }

    /// Shows the drawings made in [`LcdMode::ManualRefresh`].
    #[track_caller]
    pub fn refresh(&self) {
        let _: i32 = robios7!(self.0, LCDRefresh());
    }
}

impl LcdPlace<'_> {
    /// Writes formatted text at the position; called by `write!` and `writeln!`. The simulator gives a hint at a position
    /// that is not on the display.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the position.
    #[track_caller]
    pub fn write_fmt(&self, text: Arguments<'_>) -> Result {
        let text = text.to_string();
        let (row, column) = (self.row.into(), self.column.into());
        let code = robios7!(self.robot, LCDSetPrintf(row, column, ByteSlice::from(text.as_str())));
        checked("LCDSetPrintf", Device::Lcd, code)
    }
}
