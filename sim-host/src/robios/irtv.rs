//! The receiver for a TV remote control: every robot has one, but nobody presses a key of a remote control yet.
//!
//! Source: RoBIOS 6 library, infrared remote control.

use robios_sys::robios6::hdt_type::HDT_IRTV;
use robios_sys::robios6::{DEFAULT_MODE, RAW_CODE, REPCODE_MODE, SLOPPY_MODE, SPACE_CODE};
use robios_sys::{Out, Robios6Call as Call};
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, Waits};

/// Settings of the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How bits are told apart, `SPACE_CODE` to `RAW_CODE`.
    pub type_code: i32,
    /// Bits of a code.
    pub length: i32,
    /// Bits that toggle.
    pub tog_mask: i32,
    /// Bits that are inverted.
    pub inv_mask: i32,
    /// An OR of `SLOPPY_MODE` and `REPCODE_MODE`, or `DEFAULT_MODE`.
    pub mode: i32,
    /// Codes that are kept, 1 to 4.
    pub bufsize: i32,
    /// Hundredths of a second before a key repeats; -1: never.
    pub delay: i32,
}

/// Settings of the table of devices: the remote control that came with the EyeBot.
const STANDARD: Settings = Settings {
    type_code: SPACE_CODE,
    length: 15,
    tog_mask: 0,
    inv_mask: 0x03ff,
    mode: DEFAULT_MODE,
    bufsize: 1,
    delay: -1,
};

/// `IRTVInitHDT`
pub fn init_standard(robot: &mut Robot, semantics: i32) -> i32 {
    if robot.devices.table.find(HDT_IRTV, semantics).is_none() {
        return robot.failed(Call::IRTVInitHDT, -1);
    }
    robot.devices.irtv = Some(STANDARD);
    0
}

/// `IRTVInit`
pub fn init(robot: &mut Robot, settings: Settings) -> i32 {
    let Settings { type_code, length, mode, bufsize, .. } = settings;
    let is_valid = (SPACE_CODE..=RAW_CODE).contains(&type_code)
        && length > 0
        && (DEFAULT_MODE..=SLOPPY_MODE | REPCODE_MODE).contains(&mode)
        && (1..=4).contains(&bufsize);
    if !is_valid {
        return robot.failed(Call::IRTVInit, -1);
    }
    robot.devices.irtv = Some(settings);
    0
}

/// `IRTVGet`: waits, for ever, once the receiver is on.
pub fn get(robot: &mut Robot) -> Poll<i32> {
    if robot.devices.irtv.is_none() {
        return Poll::Ready(robot.failed(Call::IRTVGet, 0));
    }
    no_key()
}

/// The wait for a key of a remote control.
pub fn no_key() -> Poll<i32> {
    let waits_for = Waits::Input("a key of a TV remote control, which nobody has".to_owned());
    Poll::Until { at: Time::NEVER, waits_for }
}

/// `IRTVGetStatus`: all 0 while the receiver is off.
pub fn status(robot: &mut Robot, out: [&mut Out<i32>; 7]) {
    let values = robot.devices.irtv.map_or([0; 7], |settings| {
        let Settings { type_code, length, tog_mask, inv_mask, mode, bufsize, delay } = settings;
        [type_code, length, tog_mask, inv_mask, mode, bufsize, delay]
    });
    out.into_iter().zip(values).for_each(|(out, value)| out.set(value));
}
