//! Receiver for a TV remote control, which every robot has. A script can press the keys of RoBIOS-7; programs of RoBIOS
//! 6, where codes depend on the make of the remote control, receive nothing.
//!
//! Sources: RoBIOS 6 library, infrared remote control; RoBIOS-7 library, IR remote control.

use robios_sys::robios6::hdt_type::HDT_IRTV;
use robios_sys::robios6::{DEFAULT_MODE, RAW_CODE, REPCODE_MODE, SLOPPY_MODE, SPACE_CODE};
use robios_sys::robios7::{
    IRTV_0, IRTV_1, IRTV_2, IRTV_3, IRTV_4, IRTV_5, IRTV_6, IRTV_7, IRTV_8, IRTV_9, IRTV_BLUE, IRTV_DOWN, IRTV_GREEN,
    IRTV_LEFT, IRTV_OK, IRTV_POWER, IRTV_RED, IRTV_RIGHT, IRTV_UP, IRTV_YELLOW,
};
use robios_sys::{Out, Robios6Call as Call};
use sim_core::device::key::{REMOTE_KEYS, UserInput};
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, WaitReason};
use sim_core::record::Event;

/// Codes of the keys of a remote control, in the order of [`REMOTE_KEYS`].
const KEYS: [i32; REMOTE_KEYS.len()] = [
    IRTV_0,
    IRTV_1,
    IRTV_2,
    IRTV_3,
    IRTV_4,
    IRTV_5,
    IRTV_6,
    IRTV_7,
    IRTV_8,
    IRTV_9,
    IRTV_RED,
    IRTV_GREEN,
    IRTV_YELLOW,
    IRTV_BLUE,
    IRTV_LEFT,
    IRTV_RIGHT,
    IRTV_UP,
    IRTV_DOWN,
    IRTV_OK,
    IRTV_POWER,
];

/// Settings of the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Coding of bits, `SPACE_CODE` to `RAW_CODE`.
    pub type_code: i32,
    /// Bits of a code.
    pub length: i32,
    /// Bits that toggle.
    pub tog_mask: i32,
    /// Bits that are inverted.
    pub inv_mask: i32,
    /// Mode: an OR of `SLOPPY_MODE` and `REPCODE_MODE`, or `DEFAULT_MODE`.
    pub mode: i32,
    /// Codes that the buffer holds, 1 to 4.
    pub bufsize: i32,
    /// Hundredths of a second before a key repeats; -1 means never.
    pub delay: i32,
}

/// Settings in the table of devices: for the remote control that came with the EyeBot.
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
    if robot.robios.table.find(HDT_IRTV, semantics).is_none() {
        return robot.fail_call(Call::IRTVInitHDT, -1);
    }
    robot.robios.irtv = Some(STANDARD);
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
        return robot.fail_call(Call::IRTVInit, -1);
    }
    robot.robios.irtv = Some(settings);
    0
}

/// `IRTVGet`: waits forever if the receiver is on.
pub fn get(robot: &mut Robot) -> Poll<i32> {
    if robot.robios.irtv.is_none() {
        return Poll::Ready(robot.fail_call(Call::IRTVGet, 0));
    }
    wait_for_key(Time::NEVER)
}

/// Waits for a key of a remote control; polls again at `at`.
fn wait_for_key(at: Time) -> Poll<i32> {
    Poll::Pending { at, reason: WaitReason::Input("a key of a TV remote control, which nobody presses".to_owned()) }
}

/// `IRTVGet` of RoBIOS-7
pub fn get_7(robot: &mut Robot) -> Poll<i32> {
    match read_7(robot) {
        0 => wait_for_key(robot.devices.remote.next(|_| true)),
        code => Poll::Ready(code),
    }
}

/// `IRTVRead` of RoBIOS-7
pub fn read_7(robot: &mut Robot) -> i32 {
    let Some(touch) = robot.state.devices.remote.take_any(robot.state.now) else { return 0 };
    robot.record(Event::Key { key: &touch.to_string() });
    if let UserInput::Remote(key) = touch { KEYS[usize::from(key)] } else { 0 }
}

/// `IRTVFlush` of RoBIOS-7
pub fn flush_7(robot: &mut Robot) -> i32 {
    while robot.state.devices.remote.take_any(robot.state.now).is_some() {}
    0
}

/// `IRTVGetStatus`: all 0 while the receiver is off.
pub fn status(robot: &mut Robot, out: [&mut Out<i32>; 7]) {
    let values = robot.robios.irtv.map_or([0; 7], |settings| {
        let Settings { type_code, length, tog_mask, inv_mask, mode, bufsize, delay } = settings;
        [type_code, length, tog_mask, inv_mask, mode, bufsize, delay]
    });
    out.into_iter().zip(values).for_each(|(out, value)| out.set(value));
}
