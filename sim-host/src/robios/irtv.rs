//! The receiver for a TV remote control: every robot has one. A script presses the keys that RoBIOS-7 knows; programs of RoBIOS
//! 6, where codes depend on the make of the remote control, receive nothing.
//!
//! Sources: RoBIOS 6 library, infrared remote control; RoBIOS-7 library, IR remote control.

use std::collections::VecDeque;

use robios_sys::robios6::hdt_type::HDT_IRTV;
use robios_sys::robios6::{DEFAULT_MODE, RAW_CODE, REPCODE_MODE, SLOPPY_MODE, SPACE_CODE};
use robios_sys::robios7::{
    IRTV_0, IRTV_1, IRTV_2, IRTV_3, IRTV_4, IRTV_5, IRTV_6, IRTV_7, IRTV_8, IRTV_9, IRTV_BLUE, IRTV_DOWN, IRTV_GREEN,
    IRTV_LEFT, IRTV_OK, IRTV_POWER, IRTV_RED, IRTV_RIGHT, IRTV_UP, IRTV_YELLOW,
};
use robios_sys::{Out, Robios6Call as Call};
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, Waits};
use sim_core::record::Event;

/// Keys of a remote control: their names and codes.
const KEYS: [(&str, i32); 20] = [
    ("IRTV_0", IRTV_0),
    ("IRTV_1", IRTV_1),
    ("IRTV_2", IRTV_2),
    ("IRTV_3", IRTV_3),
    ("IRTV_4", IRTV_4),
    ("IRTV_5", IRTV_5),
    ("IRTV_6", IRTV_6),
    ("IRTV_7", IRTV_7),
    ("IRTV_8", IRTV_8),
    ("IRTV_9", IRTV_9),
    ("IRTV_RED", IRTV_RED),
    ("IRTV_GREEN", IRTV_GREEN),
    ("IRTV_YELLOW", IRTV_YELLOW),
    ("IRTV_BLUE", IRTV_BLUE),
    ("IRTV_LEFT", IRTV_LEFT),
    ("IRTV_RIGHT", IRTV_RIGHT),
    ("IRTV_UP", IRTV_UP),
    ("IRTV_DOWN", IRTV_DOWN),
    ("IRTV_OK", IRTV_OK),
    ("IRTV_POWER", IRTV_POWER),
];

/// Name of a key; of no key, nothing.
pub fn name(code: i32) -> &'static str {
    KEYS.iter().find(|(_, key)| *key == code).map_or("", |(name, _)| name)
}

/// Code of the key of this name.
pub fn code(name: &str) -> Option<i32> {
    KEYS.iter().find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, code)| *code)
}

/// Presses of a remote control's keys, in order of time: those to come and those not yet read.
#[derive(Clone, Debug, Default)]
pub struct Remote {
    presses: VecDeque<(Time, i32)>,
}

impl Remote {
    /// Keys that are pressed at these times.
    pub fn scripted(presses: impl IntoIterator<Item = (Time, i32)>) -> Self {
        let mut presses: Vec<_> = presses.into_iter().collect();
        presses.sort_by_key(|(at, _)| *at);
        Self { presses: presses.into() }
    }

    /// Adds a press at `at`.
    pub fn press(&mut self, at: Time, code: i32) {
        let place = self.presses.partition_point(|(earlier, _)| *earlier <= at);
        self.presses.insert(place, (at, code));
    }

    /// Takes the earliest press that has happened by `now`.
    fn take(&mut self, now: Time) -> Option<i32> {
        self.presses.pop_front_if(|(at, _)| *at <= now).map(|(_, code)| code)
    }
}

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
    if robot.robios.table.find(HDT_IRTV, semantics).is_none() {
        return robot.failed(Call::IRTVInitHDT, -1);
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
        return robot.failed(Call::IRTVInit, -1);
    }
    robot.robios.irtv = Some(settings);
    0
}

/// `IRTVGet`: waits, for ever, once the receiver is on.
pub fn get(robot: &mut Robot) -> Poll<i32> {
    if robot.robios.irtv.is_none() {
        return Poll::Ready(robot.failed(Call::IRTVGet, 0));
    }
    no_key(Time::NEVER)
}

/// The wait for a key of a remote control.
fn no_key(at: Time) -> Poll<i32> {
    Poll::Until { at, waits_for: Waits::Input("a key of a TV remote control, which nobody presses".to_owned()) }
}

/// `IRTVGet` of RoBIOS-7
pub fn get_7(robot: &mut Robot) -> Poll<i32> {
    match read_7(robot) {
        0 => no_key(robot.robios.remote.presses.front().map_or(Time::NEVER, |(at, _)| *at)),
        code => Poll::Ready(code),
    }
}

/// `IRTVRead` of RoBIOS-7
pub fn read_7(robot: &mut Robot) -> i32 {
    let code = robot.robios.remote.take(robot.now).unwrap_or(0);
    if code != 0 {
        robot.record(Event::Key { key: name(code) });
    }
    code
}

/// `IRTVFlush` of RoBIOS-7
pub fn flush_7(robot: &mut Robot) -> i32 {
    while robot.robios.remote.take(robot.now).is_some() {}
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
