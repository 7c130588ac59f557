//! The four keys below the display, touches of the display, and scripts of key presses and touches.
//!
//! Source: RoBIOS 6 library, key input, and RoBIOS-7 library, keys.

use robios_sys::robios6::{ANYKEY, KEY1, KEY2, KEY3, KEY4, NOKEY};
use robios_sys::robios7::{
    KEY_INVALID, KEY_LIST1, KEY_LIST2, KEY_LIST3, KEY_LIST4, KEY_LIST5, KEY_LIST6, KEY_LIST7, KEY_LIST8, KEY_LISTDN,
    KEY_LISTTL, KEY_LISTUP,
};
use robios_sys::{Out, Robios6Call as Call, Robios7Call};
use sim_core::RobotId;
use sim_core::device::key::{UnknownKey, UserInput};
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, WaitReason};
use super::screen::Screen;
use sim_core::record::Event;

/// The keys from left to right: their names and codes, one bit each.
pub const KEYS: [(&str, i32); 4] = [("KEY1", KEY1), ("KEY2", KEY2), ("KEY3", KEY3), ("KEY4", KEY4)];

/// The lines of a list menu: their names and codes, one bit each.
const LIST_KEYS: [(&str, i32); 11] = [
    ("KEY_LIST1", KEY_LIST1),
    ("KEY_LIST2", KEY_LIST2),
    ("KEY_LIST3", KEY_LIST3),
    ("KEY_LIST4", KEY_LIST4),
    ("KEY_LIST5", KEY_LIST5),
    ("KEY_LIST6", KEY_LIST6),
    ("KEY_LIST7", KEY_LIST7),
    ("KEY_LIST8", KEY_LIST8),
    ("KEY_LISTDN", KEY_LISTDN),
    ("KEY_LISTUP", KEY_LISTUP),
    ("KEY_LISTTL", KEY_LISTTL),
];

/// Maximum time of a press in a script, in seconds (about 30 years).
const MAX_SECONDS: f64 = 1e9;

/// Names of the keys in an OR of codes, as shown to the user: `KEY1`, `KEY1 or KEY3`, `any key`.
pub fn name(codes: i32) -> String {
    if codes & all_keys() == all_keys() {
        return "any key".to_owned();
    }
    let named = KEYS.iter().chain(&LIST_KEYS).filter(|(_, code)| code & codes != 0);
    named.map(|(name, _)| *name).collect::<Vec<_>>().join(" or ")
}

/// Returns true if a program can wait for these codes.
pub fn is_key(codes: i32) -> bool {
    codes & all_keys() != 0 && (codes & !all_keys() == 0 || codes == ANYKEY)
}

/// OR of the codes of the four keys.
pub fn all_keys() -> i32 {
    KEYS.iter().fold(0, |codes, (_, code)| codes | code)
}

/// One press in a script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Press {
    /// Robot whose key is pressed; `None` for all robots.
    pub robot: Option<RobotId>,
    /// Virtual time of the press.
    pub at: Time,
    /// Key or pixel that is pressed.
    pub touch: UserInput,
}

/// Error in a script of key presses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// The text does not have the form of a press.
    #[error("`{0}` is not a key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`")]
    Form(String),
    /// The key is unknown.
    #[error(transparent)]
    Key(#[from] UnknownKey),
    /// The time is invalid.
    #[error("`{0}` is not a time: expected seconds from 0 to 1e9, such as `2.5`")]
    Time(String),
    /// The robot's number is invalid.
    #[error("`{0}` is not a robot: expected its number from 1, such as `2` or `r2`")]
    Robot(String),
}

/// Parses a script: presses `TIME:KEY` or `ROBOT:TIME:KEY` separated by commas, times in seconds of virtual time. `KEY`
/// is one of the four keys, `TOUCH(X,Y)`, or a key of a remote control.
///
/// # Errors
/// The first [`ScriptError`].
pub fn parse_script(script: &str) -> Result<Vec<Press>, ScriptError> {
    let mut depth = 0;
    let is_end = |letter: char| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        letter == ',' && depth <= 0
    };
    script.split(is_end).map(str::trim).filter(|press| !press.is_empty()).map(parse_press).collect()
}

fn parse_press(press: &str) -> Result<Press, ScriptError> {
    let parts: Vec<&str> = press.split(':').map(str::trim).collect();
    let (robot, at, key) = match parts[..] {
        [at, key] => (None, at, key),
        [robot, at, key] => (Some(parse_robot(robot)?), at, key),
        _ => return Err(ScriptError::Form(press.to_owned())),
    };
    Ok(Press { robot, at: parse_time(at)?, touch: key.parse()? })
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

/// `KEYGetBuf`
pub fn get_into(robot: &mut Robot, buffer: &mut Out<u8>) -> Poll<i32> {
    if buffer.is_null() {
        return Poll::Ready(robot.fail_call(Call::KEYGetBuf, -1));
    }
    match wait_for(robot, ANYKEY) {
        Poll::Ready(code) => {
            buffer.set(code as u8);
            Poll::Ready(0)
        }
        pending => pending,
    }
}

/// `KEYRead`
pub fn read(robot: &mut Robot) -> i32 {
    take_key(robot, !0).map_or(NOKEY, |code| record_key(robot, code))
}

/// `KEYWait`
pub fn wait(robot: &mut Robot, codes: i32) -> Poll<i32> {
    if !is_key(codes) {
        return Poll::Ready(robot.fail_call(Call::KEYWait, -1));
    }
    match wait_for(robot, codes) {
        Poll::Ready(_) => Poll::Ready(0),
        pending => pending,
    }
}

/// Waits for a key of an OR of codes and returns its code. Earlier presses of other keys are discarded.
pub fn wait_for(robot: &mut Robot, codes: i32) -> Poll<i32> {
    match take_key(robot, codes) {
        Some(code) => Poll::Ready(record_key(robot, code)),
        None => {
            let screen = &robot.robios.screen;
            let is_awaited = |touch| key_under(touch, screen).is_some_and(|code| code & codes != 0);
            Poll::Pending { at: robot.devices.keys.next(is_awaited), reason: WaitReason::Key(name(codes)) }
        }
    }
}

/// Takes the earliest press of a key of `codes` (an OR) and discards earlier presses of other keys.
fn take_key(robot: &mut Robot, codes: i32) -> Option<i32> {
    let Robot { state, robios, .. } = robot;
    let keys = &mut state.devices.keys;
    let mut take = || keys.take(state.now, |touch| key_under(touch, &robios.screen));
    std::iter::from_fn(&mut take).find(|code| code & codes != 0)
}

/// `KEYWait` of RoBIOS-7
pub fn wait_for_one(robot: &mut Robot, codes: i32) -> Poll<i32> {
    let key_codes = KEYS.iter().chain(&LIST_KEYS).fold(0, |codes, (_, code)| codes | code);
    if codes & key_codes == 0 {
        return Poll::Ready(robot.refuse_call(Robios7Call::KEYWait, KEY_INVALID, |_| format!("{codes} is not a key")));
    }
    wait_for(robot, codes & key_codes)
}

/// `KEYGetXY`
pub fn wait_for_touch(robot: &mut Robot, x: &mut Out<i32>, y: &mut Out<i32>) -> Poll<i32> {
    match take_touch(robot) {
        Some(point) => {
            [x, y].into_iter().zip(point).for_each(|(out, pixel)| out.set(pixel));
            Poll::Ready(0)
        }
        None => Poll::Pending { at: robot.devices.keys.next(|_| true), reason: WaitReason::Key("a touch".to_owned()) },
    }
}

/// `KEYReadXY`
pub fn read_touch(robot: &mut Robot, x: &mut Out<i32>, y: &mut Out<i32>) -> i32 {
    let Some(point) = take_touch(robot) else { return 1 };
    [x, y].into_iter().zip(point).for_each(|(out, pixel)| out.set(pixel));
    0
}

/// Takes the earliest touch of the display and returns its pixel. A key press is a touch of the key's centre; a touch
/// outside the display is discarded with a hint.
fn take_touch(robot: &mut Robot) -> Option<[i32; 2]> {
    while let Some(touch) = robot.state.devices.keys.take_any(robot.state.now) {
        let size = robot.screen().size().map(i32::from);
        let point = match touch {
            UserInput::Key(number) => robot.screen().key_centre(usize::from(number) - 1),
            UserInput::Touch(point) => point,
            UserInput::Remote(_) => continue,
        };
        if point.iter().zip(size).all(|(pixel, end)| (0..end).contains(pixel)) {
            robot.record(Event::Key { key: &touch.to_string() });
            return Some(point);
        }
        robot.hint(&format!("{touch} is beside the display of {} x {} pixels", size[0], size[1]));
    }
    None
}

/// Code of the key or list line under a touch, if any. The display of RoBIOS 6 is not touch-sensitive.
fn key_under(touch: UserInput, screen: &Option<Box<Screen>>) -> Option<i32> {
    let code = match (touch, screen) {
        (UserInput::Key(number), _) => KEYS[usize::from(number) - 1].1,
        (UserInput::Touch(point), Some(screen)) => match screen.key_at(point) {
            Some(index) => KEYS[index].1,
            None => screen.list_key_at(point),
        },
        (UserInput::Touch(_), None) | (UserInput::Remote(_), _) => 0,
    };
    (code != 0).then_some(code)
}

/// Records that the program has received a key, and returns its code.
fn record_key(robot: &mut Robot, code: i32) -> i32 {
    robot.record(Event::Key { key: &name(code) });
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_keys() {
        assert_eq!([name(KEY2), name(KEY1 | KEY3), name(ANYKEY)], ["KEY2", "KEY1 or KEY3", "any key"]);
        assert!(is_key(KEY1 | KEY4) && is_key(ANYKEY) && is_key(all_keys()));
        assert!(!is_key(0) && !is_key(0x100) && !is_key(KEY1 | 0x100));
    }

    #[test]
    fn scripts() {
        let touch = |robot: Option<u32>, at, touch| Press { robot: robot.map(RobotId), at: Time(at), touch };
        let press = |robot, at, key| touch(robot, at, UserInput::Key(key));
        assert_eq!(
            parse_script("2.5:KEY1, r2:4:key4 ,3 : 0.000001:KEY2,"),
            Ok(vec![press(None, 2_500_000, 1), press(Some(2), 4_000_000, 4), press(Some(3), 1, 2)])
        );
        assert_eq!(
            parse_script("1:TOUCH(120,40),r2:3: touch( 0 , 65535 ) ,4:KEY4"),
            Ok(vec![
                touch(None, 1_000_000, UserInput::Touch([120, 40])),
                touch(Some(2), 3_000_000, UserInput::Touch([0, 65_535])),
                press(None, 4_000_000, 4)
            ])
        );
        assert_eq!(parse_script(""), Ok(vec![]));
    }

    #[test]
    fn errors_in_scripts() {
        let no_key = |word: &str| {
            format!(
                "`{word}` is not a key: expected `KEY1`, `KEY2`, `KEY3`, `KEY4`, `TOUCH(X,Y)` with a pixel of the display, \
                 or a key of a remote control such as `IRTV_OK`"
            )
        };
        for (script, message) in [
            (
                "KEY1",
                "`KEY1` is not a key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`",
            ),
            ("1:KEY5", &no_key("KEY5")),
            ("1:TOUCH", &no_key("TOUCH")),
            ("1:TOUCH(-1,0)", &no_key("TOUCH(-1,0)")),
            ("1:TOUCH(1,65536)", &no_key("TOUCH(1,65536)")),
            ("1:TOUCH(1,2", &no_key("TOUCH(1,2")),
            ("1:TOUCH(1,2)3", &no_key("TOUCH(1,2)3")),
            ("-1:KEY1", "`-1` is not a time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("nan:KEY1", "`nan` is not a time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("0:1:KEY1", "`0` is not a robot: expected its number from 1, such as `2` or `r2`"),
            ("x:1:KEY1", "`x` is not a robot: expected its number from 1, such as `2` or `r2`"),
        ] {
            assert_eq!(parse_script(script).unwrap_err().to_string(), message);
        }
    }
}
