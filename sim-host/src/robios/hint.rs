//! Hints about likely mistakes in a program, each given at most once per robot.

use std::collections::{BTreeMap, BTreeSet};

use super::call::Call;

/// Number of failures of one function after which the program is given a hint that it ignores them.
const IGNORED_FAILURES: u32 = 100;

/// Maximum plausible length of a drive in metres; a longer one is probably meant in millimetres.
pub const LONG_DRIVE: f64 = 100.0;

/// Maximum plausible turn in radians; a larger one is probably meant in degrees.
pub const LONG_TURN: f64 = 40.0;

/// A likely mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mistake {
    /// A drive of RoBIOS 6 of more than [`LONG_DRIVE`].
    LongDrive,
    /// A turn by many revolutions.
    LongTurn,
    /// The program reads a PSD sensor that it never opened.
    PsdNotOpen,
    /// `PSDStart` while the sensors are already measuring.
    PsdBusy,
    /// The program reads a PSD sensor that it never started.
    PsdNotStarted,
    /// A drive of RoBIOS-7 of a few millimetres at a few millimetres per second.
    Metres,
    /// A drive of RoBIOS 6 of length 0.
    NoLength,
    /// A drive of RoBIOS-7 of length 0.
    NoLengthInMm,
    /// A file stream of C++ cannot be opened.
    Unopened,
    /// A number of a drive of RoBIOS-7 is the integer to which C converts NaN.
    NoNumber,
    /// Turns of RoBIOS-7 by a few degrees at a few degrees per second, with drives between them.
    Radians,
    /// A drive replaces a drive that has just started.
    MissingWait,
    /// A message to an address that no robot has.
    UnknownAddress,
    /// A handle that is not open, in a call of the family that this function initialises.
    NotOpen(&'static str),
    /// An error code that the program ignores.
    IgnoredFailure,
}

/// Number of small turns, with drives between them, after which a program probably means radians.
const SMALL_TURNS: u32 = 3;

/// Hints that a robot has been given, and failures of its calls.
#[derive(Clone, Debug, Default)]
pub struct Hints {
    reported: Vec<Mistake>,
    /// Functions whose first failure with a reason has been reported.
    explained: BTreeSet<Call>,
    failures: BTreeMap<Call, u32>,
    turns: Turns,
}

/// Turns of a program that may be meant in radians.
#[derive(Clone, Copy, Debug, Default)]
struct Turns {
    /// Number of small turns that follow a drive.
    small: u32,
    /// True if the program has driven since its last turn.
    has_driven: bool,
    /// True if the program has turned by more than a small angle, so that it means degrees.
    has_large: bool,
}

impl Hints {
    /// Returns true at the first report of the mistake.
    pub fn is_first(&mut self, mistake: Mistake) -> bool {
        let is_first = !self.reported.contains(&mistake);
        if is_first {
            self.reported.push(mistake);
        }
        is_first
    }

    /// Counts a turn; returns true if all turns so far are small and at least `SMALL_TURNS` of them follow a drive.
    /// Small turns without drives between them are usually a scan or a correction of the heading.
    pub fn count_turn(&mut self, is_small: bool) -> bool {
        let turns = &mut self.turns;
        turns.has_large |= !is_small;
        turns.small += u32::from(is_small && turns.has_driven);
        turns.has_driven = false;
        !turns.has_large && turns.small >= SMALL_TURNS
    }

    /// Records that the program drives other than by a turn on the spot.
    pub fn note_drive(&mut self) {
        self.turns.has_driven = true;
    }

    /// Returns true at the first failure of `call` that has a reason.
    pub fn is_first_reason(&mut self, call: Call) -> bool {
        self.explained.insert(call)
    }

    /// Returns true if `call` has failed.
    pub fn has_failed(&self, call: Call) -> bool {
        self.failures.contains_key(&call)
    }

    /// Counts a failure of `call`; returns the text of the hint when one is due.
    pub fn count_failure(&mut self, call: Call) -> Option<String> {
        let count = self.failures.entry(call).or_default();
        *count += 1;
        let is_due = *count == IGNORED_FAILURES && self.is_first(Mistake::IgnoredFailure);
        is_due.then(|| {
            format!(
                "`{}` has failed {IGNORED_FAILURES} times and the program continues: check its return value",
                call.name()
            )
        })
    }
}

impl Mistake {
    /// Text of the hint, for mistakes that need no numbers.
    pub fn text(self) -> &'static str {
        match self {
            Self::LongDrive => "a drive of more than 100 m: RoBIOS 6 takes metres, not millimetres",
            Self::LongTurn => "a turn of more than 40 radians: RoBIOS 6 takes radians, not degrees",
            Self::PsdNotOpen => {
                "`PSDGet` with a handle that `PSDInit` did not give: is the sensor's name in the robi file, and was the \
                 result of `PSDInit` kept?"
            }
            Self::PsdBusy => {
                "`PSDStart` returned 1, busy: start all sensors with one call, `PSDStart(front | left | right, TRUE)`"
            }
            Self::PsdNotStarted => {
                "`PSDGet` before a first measurement gives 9999: call `PSDStart(handle, TRUE)` and wait 60 ms"
            }
            Self::Metres => "a drive of less than 5 mm at less than 5 mm/s: RoBIOS-7 takes millimetres, not metres",
            Self::Radians => {
                "all turns so far are small and slow (a few degrees, a few degrees/s): RoBIOS-7 takes degrees, not radians: \
                 a quarter turn is `VWTurn(90, 45)`"
            }
            Self::NoLength => {
                "a drive of 0 m goes nowhere; in C, whole numbers divided give a whole number: 1/2 is 0, 1.0/2 is 0.5"
            }
            Self::NoLengthInMm => {
                "a drive of 0 mm goes nowhere: RoBIOS-7 takes whole millimetres, such as 300; 0.3 becomes 0, and so does `1/2` in C (`1//2` in Python)"
            }
            Self::NoNumber => {
                "a speed, length or angle is not a number, or too large: it comes from a division by 0.0, or from the root of a negative \
                 number: check how it is calculated"
            }
            Self::Unopened => "a file cannot be opened",
            Self::MissingWait => "a drive replaces the previous one, which has just begun",
            Self::UnknownAddress => "a message to an address that no robot has",
            Self::NotOpen(_) => "a handle that is not open",
            Self::IgnoredFailure => "a function keeps failing: check its return value",
        }
    }
}

#[cfg(test)]
mod tests {
    use robios_sys::Robios6Call;

    use super::*;

    #[test]
    fn only_the_hundredth_failure_yields_a_hint() {
        let mut hints = Hints::default();
        let hinted: Vec<u32> =
            (1..=300).filter(|_| hints.count_failure(Robios6Call::MOTORDrive.into()).is_some()).collect();
        assert_eq!(hinted, [100]);
        assert!(hints.is_first(Mistake::PsdBusy) && !hints.is_first(Mistake::PsdBusy));
    }

    #[test]
    fn only_small_turns_between_drives_are_probably_in_radians() {
        let drive_and_turn = |hints: &mut Hints, is_small| {
            hints.note_drive();
            hints.count_turn(is_small)
        };
        let mut square = Hints::default();
        assert_eq!([1, 2, 3, 4].map(|_| drive_and_turn(&mut square, true)), [false, false, true, true]);
        let mut scan = Hints::default();
        scan.note_drive();
        assert_eq!([1, 2, 3, 4].map(|_| scan.count_turn(true)), [false; 4]);
        let mut degrees = Hints::default();
        drive_and_turn(&mut degrees, false);
        assert_eq!([1, 2, 3, 4].map(|_| drive_and_turn(&mut degrees, true)), [false; 4]);
    }
}
