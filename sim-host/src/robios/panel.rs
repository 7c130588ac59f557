//! The display of a robot, of either generation.

use super::lcd::{self, Lcd};
use super::screen::Screen;
use super::screen::canvas::{Canvas, Ink, Rgb};

/// Colour of a clear pixel of the classic display: the green-grey of a reflective LCD.
const CLEAR: Rgb = [0x9c, 0xac, 0x84];
/// Colour of a set pixel of the classic display.
const SET: Rgb = [0x26, 0x30, 0x24];

/// Display of a robot.
pub enum Panel {
    /// 128 x 64 pixels, black or white.
    Classic(Box<Lcd>),
    /// The colour display of RoBIOS-7.
    Colour(Box<Screen>),
}

/// Borrowed [`Panel`].
#[derive(Clone, Copy)]
pub enum PanelRef<'a> {
    /// 128 x 64 pixels, black or white.
    Classic(&'a Lcd),
    /// The colour display of RoBIOS-7.
    Colour(&'a Screen),
}

impl Panel {
    /// Borrows the display.
    pub fn as_ref(&self) -> PanelRef<'_> {
        match self {
            Self::Classic(lcd) => PanelRef::Classic(lcd),
            Self::Colour(screen) => PanelRef::Colour(screen),
        }
    }

    /// Lines of text; the last one is the menu.
    pub fn lines(&self) -> Vec<String> {
        self.as_ref().lines()
    }

    /// Pixels of the display.
    pub fn picture(&self) -> Canvas {
        self.as_ref().picture()
    }
}

impl PanelRef<'_> {
    /// Lines of text; the last one is the menu.
    pub fn lines(self) -> Vec<String> {
        match self {
            Self::Classic(lcd) => lcd.lines().to_vec(),
            Self::Colour(screen) => screen.lines(),
        }
    }

    /// Pixels of the display.
    pub fn picture(self) -> Canvas {
        match self {
            Self::Classic(lcd) => classic_picture(lcd),
            Self::Colour(screen) => screen.picture(),
        }
    }
}

fn classic_picture(lcd: &Lcd) -> Canvas {
    let mut canvas = Canvas::new(lcd::WIDTH, lcd::HEIGHT, CLEAR);
    for y in 0..lcd::HEIGHT as i32 {
        for x in 0..lcd::WIDTH as i32 {
            if lcd.pixel(y, x) == Ok(true) {
                canvas.draw_pixel(x, y, Ink::Colour(SET));
            }
        }
    }
    canvas
}
