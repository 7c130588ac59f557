//! Virtual time: instants and spans in whole microseconds, so that sums are exact for every slot length.

use std::ops::{Add, AddAssign, Sub};

/// An instant or a span of virtual time, in microseconds.
///
/// Virtual time starts at 0 for every robot. Microseconds are our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct Time(pub i64);

/// System tick of RoBIOS, 10 ms: timers, tasks and motion controllers step at its multiples.
///
/// Source: RoBIOS 6 manual, system tick of 100 Hz.
pub const TICK: Time = Time(10_000);

impl Time {
    /// The start of every run.
    pub const ZERO: Self = Self(0);
    /// An instant later than any instant of a run.
    pub const NEVER: Self = Self(i64::MAX);

    /// The span of `n` milliseconds.
    pub const fn from_millis(n: i64) -> Self {
        Self(n.saturating_mul(1_000))
    }

    /// The span in seconds: for spans below 2^53 us (285 years), the `f64` nearest to the exact quotient by 10^6.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / 1e6
    }

    /// The first whole microsecond not before `seconds`; [`Time::NEVER`] for an instant out of range, 0 for NaN.
    pub fn from_seconds_ceil(seconds: f64) -> Self {
        // `as` saturates and maps NaN to 0.
        let micros = (seconds * 1e6).floor() as i64;
        let mut time = Self(micros);
        // The product may be rounded up or down, so only the exact comparison decides.
        while time < Self::NEVER && time.seconds() < seconds {
            time.0 += 1;
        }
        time
    }

    /// The last multiple of `step` that is not after this instant.
    pub fn floor_to(self, step: Time) -> Self {
        Self(self.0.div_euclid(step.0) * step.0)
    }

    /// This instant plus a span; [`Time::NEVER`] on overflow.
    pub fn saturating_add(self, span: Time) -> Self {
        Self(self.0.saturating_add(span.0))
    }
}

impl Add for Time {
    type Output = Self;
    fn add(self, span: Self) -> Self {
        self.saturating_add(span)
    }
}

impl AddAssign for Time {
    fn add_assign(&mut self, span: Self) {
        *self = *self + span;
    }
}

impl Sub for Time {
    type Output = Self;
    fn sub(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl std::fmt::Display for Time {
    /// Formats the time in seconds with three decimals, `2.350 s`; `for ever` for [`Time::NEVER`].
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Self::NEVER { f.write_str("for ever") } else { write!(f, "{:.3} s", self.seconds()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_seconds_ceil_is_never_early() {
        for micros in [0, 1, 3, 7, 1_000_001, 4_150_000, 8_300_000, 16_100_000, 123_456_789_012] {
            let exact = Time(micros);
            assert_eq!(Time::from_seconds_ceil(exact.seconds()), exact);
            assert_eq!(Time::from_seconds_ceil(exact.seconds() + 3e-7), Time(micros + 1));
        }
        assert_eq!(Time::from_seconds_ceil(f64::INFINITY), Time::NEVER);
        assert_eq!(Time::from_seconds_ceil(1e300), Time::NEVER);
    }

    #[test]
    fn floor_to_keeps_multiples_of_the_step() {
        assert_eq!(Time(20_000).floor_to(TICK), Time(20_000));
        assert_eq!(Time(19_999).floor_to(TICK), Time(10_000));
    }
}
