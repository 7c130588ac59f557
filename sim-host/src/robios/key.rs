//! The four keys below the display and touches of it, pressed by a script.
//!
//! A press is kept until the program reads it, in the order of the presses. Source: RoBIOS 6 library, key input, and RoBIOS-7
//! library, keys; that presses are kept is our choice, so that a script need not know when the program looks.

use std::collections::VecDeque;

use robios_sys::robios6::{ANYKEY, KEY1, KEY2, KEY3, KEY4, NOKEY};
use robios_sys::robios7::{
    KEY_INVALID, KEY_LIST1, KEY_LIST2, KEY_LIST3, KEY_LIST4, KEY_LIST5, KEY_LIST6, KEY_LIST7, KEY_LIST8, KEY_LISTDN,
    KEY_LISTTL, KEY_LISTUP,
};
use robios_sys::{Out, Robios6Call as Call, Robios7Call};
use sim_core::RobotId;
use sim_core::time::Time;

use super::caller::Poll;
use super::robot::{Robot, Waits};
use super::screen::Screen;
use super::{Robios, irtv};
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

/// Latest time of a press in a script, in seconds: 30 years.
const MAX_SECONDS: f64 = 1e9;

/// Greatest coordinate of a touch in a script, in pixels: more than any display has.
const MAX_PIXEL: i32 = 65_535;

/// What a finger does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// It presses the key of this code.
    Key(i32),
    /// It touches the display at this pixel: x, y.
    Place([i32; 2]),
    /// It presses the key of this code on a TV remote control.
    Remote(i32),
}

impl Touch {
    /// The code of the key, 0 for a place: displays of RoBIOS 6 feel nothing.
    pub fn key(self) -> i32 {
        match self {
            Self::Key(code) => code,
            Self::Place(_) | Self::Remote(_) => 0,
        }
    }

    /// The code of the key of a remote control.
    pub fn remote_key(self) -> Option<i32> {
        match self {
            Self::Remote(code) => Some(code),
            Self::Key(_) | Self::Place(_) => None,
        }
    }
}

impl std::fmt::Display for Touch {
    /// As in a script.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Key(code) => f.write_str(&name(*code)),
            Self::Place([x, y]) => write!(f, "TOUCH({x},{y})"),
            Self::Remote(code) => f.write_str(irtv::name(*code)),
        }
    }
}

/// The keys of one robot: presses to come and presses not yet read.
///
/// Where a function is asked for keys, `key_of` says which key a touch is, 0 for none; such touches stay.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    /// In order of time; of equal times in the order given.
    presses: VecDeque<(Time, Touch)>,
}

impl Keys {
    /// Keys that are pressed at these times.
    pub fn scripted(presses: impl IntoIterator<Item = (Time, Touch)>) -> Self {
        let mut presses: Vec<_> = presses.into_iter().collect();
        presses.sort_by_key(|(at, _)| *at);
        Self { presses: presses.into() }
    }

    /// Adds a press at `at`.
    pub fn press(&mut self, at: Time, touch: Touch) {
        let place = self.presses.partition_point(|(earlier, _)| *earlier <= at);
        self.presses.insert(place, (at, touch));
    }

    /// Takes the earliest touch that has happened by `now`, of whatever.
    pub fn take_touch(&mut self, now: Time) -> Option<Touch> {
        self.presses.pop_front_if(|(at, _)| *at <= now).map(|(_, touch)| touch)
    }

    /// When the display or a key is touched next; [`Time::NEVER`] if the script has no more.
    pub fn next_touch(&self) -> Time {
        self.presses.front().map_or(Time::NEVER, |(at, _)| *at)
    }

    /// Takes the earliest press of a key that has happened by `now`.
    pub fn take(&mut self, now: Time, key_of: impl Fn(Touch) -> i32) -> Option<i32> {
        let is_key = |(at, touch): &(Time, Touch)| *at <= now && key_of(*touch) != 0;
        let (_, touch) = self.presses.remove(self.presses.iter().position(is_key)?)?;
        Some(key_of(touch))
    }

    /// Takes the earliest press by `now` of a key of `codes` (an OR), and forgets those of other keys before it.
    pub fn take_of(&mut self, codes: i32, now: Time, key_of: impl Fn(Touch) -> i32) -> Option<i32> {
        while let Some(code) = self.take(now, &key_of) {
            if code & codes != 0 {
                return Some(code);
            }
        }
        None
    }

    /// When a key of `codes` is pressed next; [`Time::NEVER`] if the script has no such press.
    pub fn next_of(&self, codes: i32, key_of: impl Fn(Touch) -> i32) -> Time {
        self.presses.iter().find(|(_, touch)| key_of(*touch) & codes != 0).map_or(Time::NEVER, |(at, _)| *at)
    }
}

/// How the user calls the keys of an OR of codes: `KEY1`, `KEY1 or KEY3`, `any key`.
pub fn name(codes: i32) -> String {
    if codes & all_keys() == all_keys() {
        return "any key".to_owned();
    }
    let named = KEYS.iter().chain(&LIST_KEYS).filter(|(_, code)| code & codes != 0);
    named.map(|(name, _)| *name).collect::<Vec<_>>().join(" or ")
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
    /// What.
    pub touch: Touch,
}

/// What is wrong with a script of key presses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// Not of the form of a press.
    #[error("`{0}` is no key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`")]
    Form(String),
    /// Not a key.
    #[error(
        "`{0}` is no key: expected `KEY1`, `KEY2`, `KEY3`, `KEY4`, `TOUCH(X,Y)` with a pixel of the display, or a key of a remote control such as `IRTV_OK`"
    )]
    Key(String),
    /// Not a time.
    #[error("`{0}` is no time: expected seconds from 0 to 1e9, such as `2.5`")]
    Time(String),
    /// Not a robot's number.
    #[error("`{0}` is no robot: expected its number from 1, such as `2` or `r2`")]
    Robot(String),
}

/// Reads a script: presses `TIME:KEY` or `ROBOT:TIME:KEY` separated by commas, times in seconds of virtual time; in place of
/// a key `TOUCH(X,Y)`, or a key of a remote control.
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
    Ok(Press { robot, at: parse_time(at)?, touch: parse_touch(key)? })
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

/// Reads a key, a place on the display or a key of a remote control, as in a script.
///
/// # Errors
/// [`ScriptError::Key`].
pub fn parse_touch(key: &str) -> Result<Touch, ScriptError> {
    let found = KEYS.iter().find(|(name, _)| name.eq_ignore_ascii_case(key)).map(|(_, code)| Touch::Key(*code));
    let remote = || irtv::code(key).map(Touch::Remote);
    found.or_else(|| parse_place(key).map(Touch::Place)).or_else(remote).ok_or_else(|| ScriptError::Key(key.to_owned()))
}

/// The place of `TOUCH(120,40)`.
fn parse_place(touch: &str) -> Option<[i32; 2]> {
    let (word, place) = touch.strip_suffix(')')?.split_once('(')?;
    let (x, y) = place.split_once(',')?;
    let coordinate = |text: &str| text.trim().parse().ok().filter(|pixel| (0..=MAX_PIXEL).contains(pixel));
    word.trim().eq_ignore_ascii_case("TOUCH").then_some([coordinate(x)?, coordinate(y)?])
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
    let Robios { keys, screen, .. } = &mut robot.robios;
    keys.take(robot.state.now, |touch| key_under(touch, screen)).map_or(NOKEY, |code| taken(robot, code))
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
    let Robios { keys, screen, .. } = &mut robot.robios;
    let key_of = |touch| key_under(touch, screen);
    match keys.take_of(codes, robot.state.now, key_of) {
        Some(code) => Poll::Ready(taken(robot, code)),
        None => Poll::Until { at: keys.next_of(codes, key_of), waits_for: Waits::Key(name(codes)) },
    }
}

/// `KEYWait` of RoBIOS-7
pub fn wait_for_one(robot: &mut Robot, codes: i32) -> Poll<i32> {
    let known = KEYS.iter().chain(&LIST_KEYS).fold(0, |codes, (_, code)| codes | code);
    if codes & known == 0 {
        return Poll::Ready(robot.refused(Robios7Call::KEYWait, KEY_INVALID, |_| format!("{codes} is no key")));
    }
    wait_for(robot, codes & known)
}

/// `KEYGetXY`
pub fn touched(robot: &mut Robot, x: &mut Out<i32>, y: &mut Out<i32>) -> Poll<i32> {
    match take_place(robot) {
        Some(place) => {
            [x, y].into_iter().zip(place).for_each(|(out, pixel)| out.set(pixel));
            Poll::Ready(0)
        }
        None => Poll::Until { at: robot.robios.keys.next_touch(), waits_for: Waits::Key("a touch".to_owned()) },
    }
}

/// `KEYReadXY`
pub fn read_place(robot: &mut Robot, x: &mut Out<i32>, y: &mut Out<i32>) -> i32 {
    let Some(place) = take_place(robot) else { return 1 };
    [x, y].into_iter().zip(place).for_each(|(out, pixel)| out.set(pixel));
    0
}

/// Takes the earliest touch of the display: that of a key is in its middle, and one beside the display is not felt.
fn take_place(robot: &mut Robot) -> Option<[i32; 2]> {
    while let Some(touch) = robot.robios.keys.take_touch(robot.now) {
        let size = robot.screen().size().map(i32::from);
        let place = match touch {
            Touch::Key(code) => {
                let index = KEYS.iter().position(|(_, key)| *key == code).unwrap_or_default();
                robot.screen().middle_of_key(index)
            }
            Touch::Place(place) => place,
            Touch::Remote(_) => continue,
        };
        if place.iter().zip(size).all(|(pixel, end)| (0..end).contains(pixel)) {
            robot.record(Event::Key { key: &touch.to_string() });
            return Some(place);
        }
        robot.hint(&format!("{touch} is beside the display of {} x {} pixels", size[0], size[1]));
    }
    None
}

/// The code of the key, or of the line of a list, that a touch presses on this display; 0 for none.
fn key_under(touch: Touch, screen: &Option<Box<Screen>>) -> i32 {
    match (touch, screen) {
        (Touch::Place(place), Some(screen)) => match screen.key_at(place) {
            Some(index) => KEYS[index].1,
            None => screen.list_key_at(place),
        },
        _ => touch.key(),
    }
}

fn taken(robot: &mut Robot, code: i32) -> i32 {
    robot.record(Event::Key { key: &name(code) });
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scripted<const N: usize>(presses: [(Time, i32); N]) -> Keys {
        Keys::scripted(presses.map(|(at, code)| (at, Touch::Key(code))))
    }

    #[test]
    fn presses_are_kept_until_read() {
        let mut keys = scripted([(Time(20), KEY4), (Time(10), KEY1), (Time(10), KEY2)]);
        let take = |keys: &mut Keys, now| keys.take(now, Touch::key);
        assert_eq!(take(&mut keys, Time(9)), None);
        assert_eq!([take(&mut keys, Time(30)), take(&mut keys, Time(30))], [Some(KEY1), Some(KEY2)]);
        keys.press(Time(15), Touch::Key(KEY3));
        assert_eq!([(); 3].map(|()| take(&mut keys, Time(30))), [Some(KEY3), Some(KEY4), None]);
    }

    #[test]
    fn waiting_for_one_key_forgets_the_others() {
        let mut keys = scripted([(Time(10), KEY1), (Time(20), KEY2), (Time(30), KEY1)]);
        let next_of = |keys: &Keys, codes| keys.next_of(codes, Touch::key);
        assert_eq!(next_of(&keys, KEY2), Time(20));
        assert_eq!(next_of(&keys, ANYKEY), Time(10));
        assert_eq!(next_of(&keys, KEY4), Time::NEVER);
        assert_eq!(keys.take_of(KEY2, Time(10), Touch::key), None);
        assert_eq!(keys.take_of(KEY2, Time(20), Touch::key), Some(KEY2));
        assert_eq!(keys.take(Time(30), Touch::key), Some(KEY1));
    }

    #[test]
    fn touches_that_are_no_key_wait_for_who_reads_touches() {
        let [key, edge, middle] = [Touch::Key(KEY1), Touch::Place([0, 9]), Touch::Place([5, 5])];
        let key_of = |touch: Touch| if touch == edge { KEY2 } else { touch.key() };
        let mut keys = Keys::scripted([(Time(1), middle), (Time(2), edge), (Time(3), key), (Time(4), middle)]);
        assert_eq!([keys.next_touch(), keys.next_of(ANYKEY, key_of)], [Time(1), Time(2)]);
        assert_eq!([keys.take(Time(9), key_of), keys.take(Time(9), key_of)], [Some(KEY2), Some(KEY1)]);
        assert_eq!(keys.take(Time(9), key_of), None);
        assert_eq!([keys.take_touch(Time(3)), keys.take_touch(Time(3))], [Some(middle), None]);
        assert_eq!((keys.next_touch(), keys.take_touch(Time(4))), (Time(4), Some(middle)));
        assert_eq!([key, middle].map(|touch| touch.to_string()), ["KEY1", "TOUCH(5,5)"]);
    }

    #[test]
    fn names_of_keys() {
        assert_eq!([name(KEY2), name(KEY1 | KEY3), name(ANYKEY)], ["KEY2", "KEY1 or KEY3", "any key"]);
        assert!(is_key(KEY1 | KEY4) && is_key(ANYKEY) && is_key(all_keys()));
        assert!(!is_key(0) && !is_key(0x100) && !is_key(KEY1 | 0x100));
    }

    #[test]
    fn scripts() {
        let touch = |robot: Option<u32>, at, touch| Press { robot: robot.map(RobotId), at: Time(at), touch };
        let press = |robot, at, code| touch(robot, at, Touch::Key(code));
        assert_eq!(
            parse_script("2.5:KEY1, r2:4:key4 ,3 : 0.000001:KEY2,"),
            Ok(vec![press(None, 2_500_000, KEY1), press(Some(2), 4_000_000, KEY4), press(Some(3), 1, KEY2)])
        );
        assert_eq!(
            parse_script("1:TOUCH(120,40),r2:3: touch( 0 , 65535 ) ,4:KEY4"),
            Ok(vec![
                touch(None, 1_000_000, Touch::Place([120, 40])),
                touch(Some(2), 3_000_000, Touch::Place([0, 65_535])),
                press(None, 4_000_000, KEY4)
            ])
        );
        assert_eq!(parse_script(""), Ok(vec![]));
    }

    #[test]
    fn mistakes_in_scripts() {
        let no_key = |word: &str| {
            format!(
                "`{word}` is no key: expected `KEY1`, `KEY2`, `KEY3`, `KEY4`, `TOUCH(X,Y)` with a pixel of the display, \
                 or a key of a remote control such as `IRTV_OK`"
            )
        };
        for (script, message) in [
            (
                "KEY1",
                "`KEY1` is no key press: expected `TIME:KEY` or `ROBOT:TIME:KEY`, such as `2.5:KEY1` or `r2:2.5:KEY1`",
            ),
            ("1:KEY5", &no_key("KEY5")),
            ("1:TOUCH", &no_key("TOUCH")),
            ("1:TOUCH(-1,0)", &no_key("TOUCH(-1,0)")),
            ("1:TOUCH(1,65536)", &no_key("TOUCH(1,65536)")),
            ("1:TOUCH(1,2", &no_key("TOUCH(1,2")),
            ("1:TOUCH(1,2)3", &no_key("TOUCH(1,2)3")),
            ("-1:KEY1", "`-1` is no time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("nan:KEY1", "`nan` is no time: expected seconds from 0 to 1e9, such as `2.5`"),
            ("0:1:KEY1", "`0` is no robot: expected its number from 1, such as `2` or `r2`"),
            ("x:1:KEY1", "`x` is no robot: expected its number from 1, such as `2` or `r2`"),
        ] {
            assert_eq!(parse_script(script).unwrap_err().to_string(), message);
        }
    }
}
