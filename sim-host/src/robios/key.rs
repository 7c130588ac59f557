//! The four keys below the display, pressed by a script.
//!
//! A press is kept until the program reads it, in the order of the presses. Source: RoBIOS 6 library, key input; that
//! presses are kept is our choice, so that a script need not know when the program looks.

use std::collections::VecDeque;

use robios_sys::robios6::{ANYKEY, KEY1, KEY2, KEY3, KEY4, NOKEY};
use robios_sys::{Out, Robios6Call as Call};
use sim_core::RobotId;
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, Waits};
use crate::record::Event;

/// The keys from left to right: their names and codes, one bit each.
pub const KEYS: [(&str, i32); 4] = [("KEY1", KEY1), ("KEY2", KEY2), ("KEY3", KEY3), ("KEY4", KEY4)];

/// Latest time of a press in a script, in seconds: 30 years.
const MAX_SECONDS: f64 = 1e9;

/// The keys of one robot: presses to come and presses not yet read.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    /// In order of time; of equal times in the order given.
    presses: VecDeque<(Time, i32)>,
}

impl Keys {
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
    pub fn take(&mut self, now: Time) -> Option<i32> {
        self.presses.pop_front_if(|(at, _)| *at <= now).map(|(_, code)| code)
    }

    /// Takes the earliest press by `now` of a key of `codes` (an OR), and forgets those of other keys before it.
    pub fn take_of(&mut self, codes: i32, now: Time) -> Option<i32> {
        while let Some(code) = self.take(now) {
            if code & codes != 0 {
                return Some(code);
            }
        }
        None
    }

    /// When a key of `codes` is pressed next; [`Time::NEVER`] if the script has no such press.
    pub fn next_of(&self, codes: i32) -> Time {
        self.presses.iter().find(|(_, code)| code & codes != 0).map_or(Time::NEVER, |(at, _)| *at)
    }
}

/// How the user calls the keys of an OR of codes: `KEY1`, `KEY1 or KEY3`, `any key`.
pub fn name(codes: i32) -> String {
    let names: Vec<&str> = KEYS.iter().filter(|(_, code)| code & codes != 0).map(|(name, _)| *name).collect();
    if names.len() == KEYS.len() { "any key".to_owned() } else { names.join(" or ") }
}

/// True if a program can wait for these codes.
pub fn is_key(codes: i32) -> bool {
    codes & all_keys() != 0 && (codes & !all_keys() == 0 || codes == ANYKEY)
}

/// The OR of all keys.
pub fn all_keys() -> i32 {
    KEYS.iter().fold(0, |codes, (_, code)| codes | code)
}

/// One press of a script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// Whose key; `None` for all robots.
    pub robot: Option<RobotId>,
    /// When, in virtual time.
    pub at: Time,
    /// Code of the key.
    pub code: i32,
}

/// What is wrong with a script of key presses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// Not of the form of a press.
    #[error("`{0}` is no key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`")]
    Form(String),
    /// Not a key.
    #[error("`{0}` is no key: expected `KEY1`, `KEY2`, `KEY3` or `KEY4`")]
    Key(String),
    /// Not a time.
    #[error("`{0}` is no time: expected seconds from 0 to 1e9, such as `2.5`")]
    Time(String),
    /// Not a robot's number.
    #[error("`{0}` is no robot: expected its number from 1, such as `2` or `r2`")]
    Robot(String),
}

/// Reads a script: presses `TIME:KEY` or `ROBOT:TIME:KEY` separated by commas, times in seconds of virtual time.
///
/// # Errors
/// The first [`ScriptError`].
pub fn parse_script(script: &str) -> Result<Vec<Press>, ScriptError> {
    script.split(',').map(str::trim).filter(|press| !press.is_empty()).map(parse_press).collect()
}

fn parse_press(press: &str) -> Result<Press, ScriptError> {
    let parts: Vec<&str> = press.split(':').map(str::trim).collect();
    let (robot, at, key) = match parts[..] {
        [at, key] => (None, at, key),
        [robot, at, key] => (Some(parse_robot(robot)?), at, key),
        _ => return Err(ScriptError::Form(press.to_owned())),
    };
    Ok(Press { robot, at: parse_time(at)?, code: parse_key(key)? })
}

fn parse_robot(robot: &str) -> Result<RobotId, ScriptError> {
    let number = robot.strip_prefix(['r', 'R']).unwrap_or(robot);
    let id = number.parse().ok().filter(|id| *id > 0);
    id.map(RobotId).ok_or_else(|| ScriptError::Robot(robot.to_owned()))
}

fn parse_time(seconds: &str) -> Result<Time, ScriptError> {
    let parsed: Option<f64> = seconds.parse().ok().filter(|seconds| (0.0..=MAX_SECONDS).contains(seconds));
    parsed.map(|seconds| Time((seconds * 1e6).round() as i64)).ok_or_else(|| ScriptError::Time(seconds.to_owned()))
}

fn parse_key(key: &str) -> Result<i32, ScriptError> {
    let found = KEYS.iter().find(|(name, _)| name.eq_ignore_ascii_case(key));
    found.map(|(_, code)| *code).ok_or_else(|| ScriptError::Key(key.to_owned()))
}

/// `KEYGetBuf`
pub fn get_into(robot: &mut Robot, buffer: &mut Out<u8>) -> Poll<i32> {
    if buffer.is_null() {
        return Poll::Ready(robot.failed(Call::KEYGetBuf, -1));
    }
    match wait_for(robot, ANYKEY) {
        Poll::Ready(code) => {
            buffer.set(code as u8);
            Poll::Ready(0)
        }
        until => until,
    }
}

/// `KEYRead`
pub fn read(robot: &mut Robot) -> i32 {
    robot.devices.keys.take(robot.now).map_or(NOKEY, |code| taken(robot, code))
}

/// `KEYWait`
pub fn wait(robot: &mut Robot, codes: i32) -> Poll<i32> {
    if !is_key(codes) {
        return Poll::Ready(robot.failed(Call::KEYWait, -1));
    }
    match wait_for(robot, codes) {
        Poll::Ready(_) => Poll::Ready(0),
        until => until,
    }
}

/// Waits for a key of an OR of codes; its code. Presses of other keys before it are forgotten.
pub fn wait_for(robot: &mut Robot, codes: i32) -> Poll<i32> {
    match robot.devices.keys.take_of(codes, robot.now) {
        Some(code) => Poll::Ready(taken(robot, code)),
        None => Poll::Until { at: robot.devices.keys.next_of(codes), waits_for: Waits::Key(name(codes)) },
    }
}

fn taken(robot: &mut Robot, code: i32) -> i32 {
    robot.record(Event::Key { key: &name(code) });
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presses_are_kept_until_read() {
        let mut keys = Keys::scripted([(Time(20), KEY4), (Time(10), KEY1), (Time(10), KEY2)]);
        assert_eq!(keys.take(Time(9)), None);
        assert_eq!([keys.take(Time(30)), keys.take(Time(30))], [Some(KEY1), Some(KEY2)]);
        keys.press(Time(15), KEY3);
        assert_eq!([keys.take(Time(30)), keys.take(Time(30)), keys.take(Time(30))], [Some(KEY3), Some(KEY4), None]);
    }

    #[test]
    fn waiting_for_one_key_forgets_the_others() {
        let mut keys = Keys::scripted([(Time(10), KEY1), (Time(20), KEY2), (Time(30), KEY1)]);
        assert_eq!(keys.next_of(KEY2), Time(20));
        assert_eq!(keys.next_of(ANYKEY), Time(10));
        assert_eq!(keys.next_of(KEY4), Time::NEVER);
        assert_eq!(keys.take_of(KEY2, Time(10)), None);
        assert_eq!(keys.take_of(KEY2, Time(20)), Some(KEY2));
        assert_eq!(keys.take(Time(30)), Some(KEY1));
    }

    #[test]
    fn names_of_keys() {
        assert_eq!([name(KEY2), name(KEY1 | KEY3), name(ANYKEY)], ["KEY2", "KEY1 or KEY3", "any key"]);
        assert!(is_key(KEY1 | KEY4) && is_key(ANYKEY) && is_key(all_keys()));
        assert!(!is_key(0) && !is_key(0x100) && !is_key(KEY1 | 0x100));
    }

    #[test]
    fn scripts() {
        let press = |robot: Option<u32>, at, code| Press { robot: robot.map(RobotId), at: Time(at), code };
        assert_eq!(
            parse_script("2.5:KEY1, r2:4:key4 ,3 : 0.000001:KEY2,"),
            Ok(vec![press(None, 2_500_000, KEY1), press(Some(2), 4_000_000, KEY4), press(Some(3), 1, KEY2)])
        );
        assert_eq!(parse_script(""), Ok(vec![]));
    }

    #[test]
    fn mistakes_in_scripts() {
        for (script, message) in [
            (
                "KEY1",
                "`KEY1` is no key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`",
            ),
            ("1:KEY5", "`KEY5` is no key: expected `KEY1`, `KEY2`, `KEY3` or `KEY4`"),
            ("-1:KEY1", "`-1` is no time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("nan:KEY1", "`nan` is no time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("0:1:KEY1", "`0` is no robot: expected its number from 1, such as `2` or `r2`"),
            ("x:1:KEY1", "`x` is no robot: expected its number from 1, such as `2` or `r2`"),
        ] {
            assert_eq!(parse_script(script).unwrap_err().to_string(), message);
        }
    }
}
