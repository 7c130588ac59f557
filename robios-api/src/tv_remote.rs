//! The receiver of a TV remote control.

use std::time::Duration;

use robios_sys::robios6::{
    DEFAULT_MODE, MANCHESTER_CODE, PULSE_CODE, RAW_CODE, REPCODE_MODE, SLOPPY_MODE, SPACE_CODE, semantics,
};

use crate::device::Device;
use crate::robot::{release, robios};
use crate::{Error, Result, Robot};

/// The receiver of a TV remote control; dropping it ends receiving.
#[derive(Debug)]
pub struct TvRemote {
    robot: Robot,
}

/// Code of a key of a remote control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TvCode(pub i32);

/// Bit encoding of a remote control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TvCoding {
    /// By the length of the pause between pulses.
    Space,
    /// By the length of the pulses.
    Pulse,
    /// By the direction of an edge.
    Manchester,
    /// A raw sequence of lengths.
    Raw,
}

/// Rule by which codes are accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TvMode {
    /// Only complete codes are accepted.
    Complete,
    /// Incomplete codes are accepted too.
    Sloppy,
    /// A special code repeats the last one.
    RepeatCode,
}

/// Settings of the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TvSettings {
    /// Bit encoding.
    pub coding: TvCoding,
    /// Number of bits of a code.
    pub bits: u8,
    /// Mask of the bits that toggle from one press to the next.
    pub toggle_mask: i32,
    /// Mask of the inverted bits.
    pub inverted_mask: i32,
    /// Rule by which codes are accepted.
    pub mode: TvMode,
    /// Number of codes that the buffer holds, 1 to 4.
    pub kept: u8,
    /// Time after which a held key repeats, in steps of 10 ms.
    pub repeat_delay: Duration,
}

impl Robot {
    /// Starts receiving with the settings of the device table.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no receiver.
    #[track_caller]
    pub fn tv_remote(&self) -> Result<TvRemote> {
        self.checked_tv_remote(robios!(self, IRTVInitHDT(semantics::IRTV)))
    }

    /// Starts receiving with the given settings.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no receiver.
    #[track_caller]
    pub fn tv_remote_with(&self, settings: TvSettings) -> Result<TvRemote> {
        let coding = match settings.coding {
            TvCoding::Space => SPACE_CODE,
            TvCoding::Pulse => PULSE_CODE,
            TvCoding::Manchester => MANCHESTER_CODE,
            TvCoding::Raw => RAW_CODE,
        };
        let mode = match settings.mode {
            TvMode::Complete => DEFAULT_MODE,
            TvMode::Sloppy => SLOPPY_MODE,
            TvMode::RepeatCode => REPCODE_MODE,
        };
        let TvSettings { bits, toggle_mask, inverted_mask, kept, repeat_delay, .. } = settings;
        let delay = i32::try_from(repeat_delay.as_millis() / 10).unwrap_or(i32::MAX);
        let (bits, kept) = (bits.into(), kept.into());
        self.checked_tv_remote(robios!(self, IRTVInit(coding, bits, toggle_mask, inverted_mask, mode, kept, delay)))
    }

    /// The receiver, if the initialisation returned 0.
    fn checked_tv_remote(&self, code: i32) -> Result<TvRemote> {
        if code == 0 { Ok(TvRemote { robot: self.clone() }) } else { Err(Error::Unavailable(Device::TvRemote)) }
    }
}

impl TvRemote {
    /// The code of the key that is held down, without waiting.
    #[track_caller]
    pub fn pressed(&self) -> Option<TvCode> {
        code_of(robios!(&self.robot, IRTVPressed()))
    }

    /// The next code that has been received, without waiting.
    #[track_caller]
    pub fn read(&self) -> Option<TvCode> {
        code_of(robios!(&self.robot, IRTVRead()))
    }

    /// Waits for the next code; `None` immediately if the receiver is off.
    #[track_caller]
    pub fn wait(&self) -> Option<TvCode> {
        code_of(robios!(&self.robot, IRTVGet()))
    }

    /// Discards received codes.
    #[track_caller]
    pub fn drop_received(&self) {
        let () = robios!(&self.robot, IRTVFlush());
    }
}

impl Drop for TvRemote {
    fn drop(&mut self) {
        release!(&self.robot, IRTVTerm());
    }
}

/// Converts the code returned by a call; 0 is none.
fn code_of(code: i32) -> Option<TvCode> {
    (code != 0).then_some(TvCode(code))
}
