//! RoBIOS 6 of the classic EyeBot controllers and the classic simulator: types, constants, functions.
//!
//! Units are metres, radians and seconds for driving, millimetres for PSD sensors, hundredths of a second for time.

mod constant;
mod function;

pub use constant::*;
pub use function::{Robios6, Robios6Call, Robios6Table};

use std::fmt::{self, Formatter};

use crate::param::ShowOut;
use crate::wire::Plain;

/// `BYTE`: an unsigned 8-bit number.
pub type Byte = u8;
/// `char` used as a character: its bits, independent of the signedness of C's `char`.
pub type Char = u8;
/// `BOOL`: 0 is false, everything else true.
pub type Bool = i32;
/// A device's number in `hdt_sem.h`, see the constants of [`semantics`].
pub type DeviceSemantics = i32;
/// A kind of device in the hardware description table, see [`hdt_type`].
pub type TypeID = i32;
/// Handle of `MOTORInit`; 0 is none.
pub type MotorHandle = i32;
/// Handle of `QUADInit`; 0 is none.
pub type QuadHandle = i32;
/// Handle of `SERVOInit`; 0 is none.
pub type ServoHandle = i32;
/// Handle of `PSDInit`: one bit; 0 is none.
pub type PSDHandle = i32;
/// Handle of `VWInit`; 0 is none.
pub type VWHandle = i32;
/// Handle of `BUMPInit`; 0 is none.
pub type BumpHandle = i32;
/// Handle of `IRInit`; 0 is none.
pub type IRHandle = i32;
/// Handle of `OSAttachTimer`; 0 is none.
pub type TimerHandle = i32;
/// A task of the program: in C a `struct tcb *`, across the ABI its number; 0 is the current one or none.
pub type Task = i32;
/// A semaphore of the program: in C a `struct sem *`, across the ABI its number; 0 if it is not initialised.
pub type Semaphore = i32;
/// `meter`: a length in metres.
pub type Metre = f32;
/// `radians`: an angle in radians, counter-clockwise.
pub type Radian = f32;
/// `meterPerSec`: a speed in metres per second.
pub type MetrePerSecond = f32;
/// `radPerSec`: a rate of turn in radians per second, counter-clockwise.
pub type RadianPerSecond = f32;

/// Columns of an [`Image`], border included.
pub const IMAGE_COLUMNS: usize = 82;
/// Rows of an [`Image`], border included.
pub const IMAGE_ROWS: usize = 62;
/// `image`: 80 x 60 grey values of 0 to 255, row 0 at the top, with a border of 1 pixel that is undefined.
pub type Image = [[u8; IMAGE_COLUMNS]; IMAGE_ROWS];
/// `colimage`: like [`Image`], each pixel red, green, blue.
pub type ColImage = [[[u8; 3]; IMAGE_COLUMNS]; IMAGE_ROWS];
/// The whole LCD, 1 bit a pixel: 64 rows of 16 bytes, the left pixel in the highest bit, 1 is black.
pub type BitImage = [u8; 1024];
/// 80 x 60 grey values without a border.
pub type MonoFrame = [u8; 4800];
/// 80 x 60 pixels of red, green, blue without a border.
pub type ColorFrame = [u8; 14400];
/// 160 x 120 values behind the camera's colour filter; rows of green and blue alternate with rows of red and green.
pub type BayerFrame = [u8; 19200];

/// Columns of the LCD in pixels.
pub const LCD_WIDTH: usize = 128;
/// Rows of the LCD in pixels.
pub const LCD_HEIGHT: usize = 64;
/// Columns of the LCD in characters.
pub const LCD_COLUMNS: usize = 16;
/// Rows of the LCD in characters; the last is the menu's.
pub const LCD_ROWS: usize = 7;

/// Position and heading of a robot on the ground, in the frame that `VWInit` or `VWSetPosition` has set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct PositionType {
    /// Forward at heading 0, in metres.
    pub x: f32,
    /// Left at heading 0, in metres.
    pub y: f32,
    /// Heading in radians, counter-clockwise.
    pub phi: f32,
}

impl ShowOut for PositionType {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{{{}, {}, {}}}", self.x, self.y, self.phi)
    }
}

/// Speed of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct SpeedType {
    /// Forward, in metres per second.
    pub v: f32,
    /// Rate of turn in radians per second, counter-clockwise.
    pub w: f32,
}

impl ShowOut for SpeedType {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{{{}, {}}}", self.v, self.w)
    }
}

/// Settings of the radio.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct RadioIOParameters {
    /// `SERIAL1` to `SERIAL3`.
    pub interface: i32,
    /// `SER9600` to `SER115200`.
    pub speed: i32,
    /// The machine's id, 1 to 255.
    pub id: i32,
    /// 1: the remote control is active.
    pub remote_on: i32,
    /// 0 off, 1 full, 2 reduced.
    pub image_transfer: i32,
    /// 0 off to 100 everything.
    pub debug: i32,
}

impl ShowOut for RadioIOParameters {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("...")
    }
}

/// State of the radio. The fields are our choice; those of the original RoBIOS are not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct RadioStatus {
    /// The machine's id.
    pub id: i32,
    /// Messages sent.
    pub sent: i32,
    /// Messages received.
    pub received: i32,
    /// Messages waiting to be received.
    pub waiting: i32,
}

impl ShowOut for RadioStatus {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("...")
    }
}

/// One row of the hardware description table: a device that the robot has.
///
/// In C it is a struct of the program's own library, which the next call overwrites.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct HDTEntry {
    /// Kind of device, see [`hdt_type`].
    pub type_id: TypeID,
    /// Device of its kind, see [`semantics`].
    pub semantics: DeviceSemantics,
    /// Its name, at most 15 characters, filled up with 0.
    pub name: [u8; 16],
}

impl ShowOut for HDTEntry {
    fn show_out(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{{{}, {}, \"{}\"}}", self.type_id, self.semantics, self.name.escape_ascii())
    }
}

macro_rules! plain {
    ($($kind:ty),*) => {$(
        // SAFETY: `repr(C)` of numbers whose sizes leave no gap, see the test below.
        unsafe impl Plain for $kind {}
    )*};
}
plain!(PositionType, SpeedType, RadioIOParameters, RadioStatus, HDTEntry);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structs_passed_between_processes_have_no_padding() {
        assert_eq!(size_of::<PositionType>(), 3 * 4);
        assert_eq!(size_of::<SpeedType>(), 2 * 4);
        assert_eq!(size_of::<RadioIOParameters>(), 6 * 4);
        assert_eq!(size_of::<RadioStatus>(), 4 * 4);
        assert_eq!(size_of::<HDTEntry>(), 2 * 4 + 16);
    }
}
