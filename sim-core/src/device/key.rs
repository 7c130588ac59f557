//! User input: keys below the display, touches of the display, and keys of a TV remote control.
//!
//! Inputs are queued until the program reads them. So the inputs that a program reads do not depend on when the program
//! polls (our choice).

use std::collections::VecDeque;
use std::str::FromStr;

use crate::time::Time;

/// Number of keys below the display.
pub const KEYS: u8 = 4;

/// Names of the keys of a remote control.
pub const REMOTE_KEYS: [&str; 20] = [
    "IRTV_0",
    "IRTV_1",
    "IRTV_2",
    "IRTV_3",
    "IRTV_4",
    "IRTV_5",
    "IRTV_6",
    "IRTV_7",
    "IRTV_8",
    "IRTV_9",
    "IRTV_RED",
    "IRTV_GREEN",
    "IRTV_YELLOW",
    "IRTV_BLUE",
    "IRTV_LEFT",
    "IRTV_RIGHT",
    "IRTV_UP",
    "IRTV_DOWN",
    "IRTV_OK",
    "IRTV_POWER",
];

/// Maximum coordinate of a touch, in pixels; no display is this large.
const MAX_PIXEL: i32 = 65_535;

/// A press of a key or a touch of the display. Its text is, for example, `KEY1`, `TOUCH(120,40)` or `IRTV_OK`; parsing
/// ignores case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UserInput {
    /// Press of a key below the display: 1 to [`KEYS`], from the left.
    Key(u8),
    /// Touch of the display at a pixel: x from the left, y from the top.
    Touch([i32; 2]),
    /// Press of the remote control's key with this index in [`REMOTE_KEYS`].
    Remote(u8),
}

/// The text does not name a [`UserInput`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a key: expected `KEY1`, `KEY2`, `KEY3`, `KEY4`, `TOUCH(X,Y)` with a pixel of the display, or a key of a remote control such as `IRTV_OK`"
)]
pub struct UnknownKey(pub String);

impl std::fmt::Display for UserInput {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Key(number) => write!(f, "KEY{number}"),
            Self::Touch([x, y]) => write!(f, "TOUCH({x},{y})"),
            Self::Remote(index) => f.write_str(REMOTE_KEYS.get(usize::from(*index)).copied().unwrap_or_default()),
        }
    }
}

impl FromStr for UserInput {
    type Err = UnknownKey;

    fn from_str(text: &str) -> Result<Self, UnknownKey> {
        let keys = (1..=KEYS).map(Self::Key).chain((0..REMOTE_KEYS.len() as u8).map(Self::Remote));
        let key = keys.into_iter().find(|key| key.to_string().eq_ignore_ascii_case(text));
        key.or_else(|| parse_pixel(text).map(Self::Touch)).ok_or_else(|| UnknownKey(text.to_owned()))
    }
}

/// Parses the pixel of `TOUCH(120,40)`.
fn parse_pixel(text: &str) -> Option<[i32; 2]> {
    let (word, pixel) = text.strip_suffix(')')?.split_once('(')?;
    let (x, y) = pixel.split_once(',')?;
    let coordinate = |text: &str| text.trim().parse().ok().filter(|pixel| (0..=MAX_PIXEL).contains(pixel));
    word.trim().eq_ignore_ascii_case("TOUCH").then_some([coordinate(x)?, coordinate(y)?])
}

/// Queue of future and unread inputs, ordered by time; inputs of equal time keep the order of insertion.
///
/// A reader passes `key_of`, which maps an input to a key of the reader. Inputs for which `key_of` returns `None` stay
/// in the queue.
#[derive(Clone, Debug, Default)]
pub struct InputQueue {
    inputs: VecDeque<(Time, UserInput)>,
}

impl InputQueue {
    /// Adds an input at the time `at`.
    pub fn press(&mut self, at: Time, input: UserInput) {
        let index = self.inputs.partition_point(|(earlier, _)| *earlier <= at);
        self.inputs.insert(index, (at, input));
    }

    /// Removes the earliest input up to `now` for which `key_of` returns a key, and returns the key.
    pub fn take<K>(&mut self, now: Time, key_of: impl Fn(UserInput) -> Option<K>) -> Option<K> {
        let is_key = |(at, input): &(Time, UserInput)| *at <= now && key_of(*input).is_some();
        let (_, input) = self.inputs.remove(self.inputs.iter().position(is_key)?)?;
        key_of(input)
    }

    /// Removes and returns the earliest input of any kind up to `now`.
    pub fn take_any(&mut self, now: Time) -> Option<UserInput> {
        self.take(now, Some)
    }

    /// Time of the earliest input in the queue for which `matches` returns true; [`Time::NEVER`] if there is none.
    pub fn next(&self, matches: impl Fn(UserInput) -> bool) -> Time {
        self.inputs.iter().find(|(_, input)| matches(*input)).map_or(Time::NEVER, |(at, _)| *at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queue_of<const N: usize>(presses: [(i64, UserInput); N]) -> InputQueue {
        let mut queue = InputQueue::default();
        presses.into_iter().for_each(|(at, input)| queue.press(Time(at), input));
        queue
    }

    #[test]
    fn presses_are_kept_until_read() {
        let mut keys = queue_of([(20, UserInput::Key(4)), (10, UserInput::Key(1)), (10, UserInput::Key(2))]);
        assert_eq!(keys.take_any(Time(9)), None);
        assert_eq!([(); 2].map(|()| keys.take_any(Time(30))), [Some(UserInput::Key(1)), Some(UserInput::Key(2))]);
        keys.press(Time(15), UserInput::Key(3));
        assert_eq!([(); 3].map(|()| keys.take_any(Time(30))), [Some(UserInput::Key(3)), Some(UserInput::Key(4)), None]);
    }

    #[test]
    fn touches_that_are_no_key_stay_in_the_queue() {
        let [key, edge, middle] = [UserInput::Key(1), UserInput::Touch([0, 9]), UserInput::Touch([5, 5])];
        let key_of = |input: UserInput| match input {
            UserInput::Key(number) => Some(number),
            input => (input == edge).then_some(2),
        };
        let mut keys = queue_of([(1, middle), (2, edge), (3, key), (4, middle)]);
        let next_key = |keys: &InputQueue| keys.next(|input| key_of(input).is_some());
        assert_eq!([keys.next(|_| true), next_key(&keys)], [Time(1), Time(2)]);
        assert_eq!([keys.take(Time(9), key_of), keys.take(Time(9), key_of)], [Some(2), Some(1)]);
        assert_eq!((keys.take(Time(9), key_of), next_key(&keys)), (None, Time::NEVER));
        assert_eq!([keys.take_any(Time(3)), keys.take_any(Time(3))], [Some(middle), None]);
        assert_eq!((keys.next(|_| true), keys.take_any(Time(4))), (Time(4), Some(middle)));
    }

    #[test]
    fn inputs_are_printed_and_parsed() {
        let inputs = [
            UserInput::Key(1),
            UserInput::Key(4),
            UserInput::Touch([0, 65_535]),
            UserInput::Remote(0),
            UserInput::Remote(18),
        ];
        let texts = ["KEY1", "KEY4", "TOUCH(0,65535)", "IRTV_0", "IRTV_OK"];
        assert_eq!(inputs.map(|input| input.to_string()), texts);
        assert_eq!(texts.map(str::parse), inputs.map(Ok));
        assert_eq!(["key2", " touch( 5 ,6 )", "irtv_power"].map(str::parse), {
            [Ok(UserInput::Key(2)), Ok(UserInput::Touch([5, 6])), Ok(UserInput::Remote(19))]
        });
        for text in ["", "KEY0", "KEY5", "KEY", "TOUCH", "TOUCH(-1,0)", "TOUCH(1,65536)", "TOUCH(1,2", "TOUCH(1,2)3"] {
            assert_eq!(text.parse::<UserInput>(), Err(UnknownKey(text.to_owned())));
        }
    }
}
