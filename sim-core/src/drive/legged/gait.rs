//! In which order and how long the feet are in the air.

use super::curve::{HEEL_OFF, TOE_OFF};
use crate::time::Time;

/// Instants in one period at which something about the feet is decided.
pub(super) const GRID: i64 = 48;

/// A gait: the order and the timing of the feet.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Its name.
    pub name: String,
    /// From one lift-off of a foot to the next of the same foot.
    pub period: Time,
    /// Share of the period that a foot is on the ground, above 0 and below 1.
    pub duty: f64,
    /// When in the period each leg lifts off, as a share of it, 0 to 1; taken to the nearest 48th.
    pub offsets: Vec<f64>,
    /// Legs with feet move as people's do: see [`natural_angles`](super::natural_angles).
    pub is_natural: bool,
}

impl Gait {
    /// At which instants of the grid a leg lifts off: those with this remainder.
    pub(super) fn slot(&self, leg: usize) -> i64 {
        let offset = self.offsets.get(leg).copied().unwrap_or(0.0);
        ((offset * GRID as f64).round() as i64).rem_euclid(GRID)
    }

    /// How many instants of the grid before its lift-off a foot begins to roll over its toe in a natural gait.
    pub(super) fn rolling(&self) -> i64 {
        ((TOE_OFF - HEEL_OFF) / TOE_OFF * self.duty * GRID as f64).round() as i64
    }

    /// How long a foot is in the air in a cycle of length `period`.
    pub(super) fn swing(&self, period: Time) -> Time {
        Time(((1.0 - self.duty) * period.0 as f64).round() as i64).max(Time(1))
    }
}

/// The clock of a walk: instants of decision, 48 a period, counted from 0.
///
/// The first cycle of a walk from rest takes half the time, so that no foot has to stay behind for more than half of a
/// stride. Our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clock {
    /// From when on it counts: the first instant of its own comes after that.
    pub opened: Time,
    /// Instant 0, not after `opened`.
    since: Time,
    /// Length of the first cycle, and of the others.
    first: Time,
    period: Time,
    pub gait: usize,
}

impl Clock {
    /// A walk that begins at `at`: the first foot to lift off does so soon.
    pub fn starting(at: Time, gait: &Gait, index: usize) -> Self {
        let first = Time(gait.period.0 / 2).max(Time(GRID));
        let slots = (0..gait.offsets.len()).map(|leg| gait.slot(leg));
        let ahead = slots.min().unwrap_or(0) - 1;
        let clock = Self { opened: at, since: at, first, period: gait.period, gait: index };
        // `ahead` may be -1, an instant before the clock's 0.
        Self { since: at - (clock.instant(ahead) - at), ..clock }
    }

    /// This clock going on in another gait at `at`, at the same share of the period.
    pub fn changed(&self, at: Time, gait: &Gait, index: usize) -> Self {
        let share = self.cycles(at) - self.cycles(at).floor();
        let since = at - Time((share * gait.period.0 as f64).round() as i64);
        Self { opened: at, since, first: gait.period, period: gait.period, gait: index }
    }

    /// Instant `index` of its grid.
    pub fn instant(&self, index: i64) -> Time {
        if index <= GRID {
            self.since + Time((index * self.first.0).div_euclid(GRID))
        } else {
            self.since + self.first + Time(((index - GRID) * self.period.0).div_euclid(GRID))
        }
    }

    /// The first instant of its grid after `at`, and after it was opened.
    pub fn next_after(&self, at: Time) -> i64 {
        let at = at.max(self.opened);
        let mut index = ((self.cycles(at) * GRID as f64).floor() as i64 - 1).max(0);
        while self.instant(index) <= at {
            index += 1;
        }
        index
    }

    /// The first instant after `at` at which a leg with this slot lifts off.
    pub fn next_slot(&self, at: Time, slot: i64) -> Time {
        let index = self.next_after(at);
        self.instant(index + (slot - index).rem_euclid(GRID))
    }

    /// Length of the cycle with instant `index`.
    pub fn period_at(&self, index: i64) -> Time {
        if index < GRID { self.first } else { self.period }
    }

    /// Cycles that have gone by since instant 0.
    pub fn cycles(&self, at: Time) -> f64 {
        let since = at - self.since;
        if since <= self.first {
            since.seconds() / self.first.seconds()
        } else {
            1.0 + (since - self.first).seconds() / self.period.seconds()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gait() -> Gait {
        Gait {
            name: "walk".to_owned(),
            period: Time(1_000_001),
            duty: 0.6,
            offsets: vec![0.5, 0.0, 0.25],
            is_natural: false,
        }
    }

    #[test]
    fn the_first_foot_lifts_off_soon_and_the_first_cycle_is_short() {
        let clock = Clock::starting(Time(7_000), &gait(), 0);
        let first = clock.next_slot(Time(7_000), gait().slot(1));
        assert!(first > Time(7_000) && first - Time(7_000) <= Time(1_000_001 / 48), "{first:?}");
        let second = clock.next_slot(first, gait().slot(1));
        let third = clock.next_slot(second, gait().slot(1));
        assert_eq!(third - second, Time(1_000_001));
        assert_eq!(clock.next_slot(first, gait().slot(2)) - first, Time(500_000 / 4));
    }

    #[test]
    fn instants_ascend_and_none_is_passed_over() {
        let clock = Clock::starting(Time(-3), &gait(), 0);
        let mut at = Time(-3);
        for index in clock.next_after(at)..200 {
            assert_eq!(clock.next_after(at), index);
            assert!(clock.instant(index) > at);
            at = clock.instant(index);
        }
    }

    #[test]
    fn a_change_of_gait_keeps_the_share_of_the_period() {
        let clock = Clock::starting(Time(0), &gait(), 0);
        let slow = Gait { period: Time(3_000_000), ..gait() };
        let at = Time(5_345_678);
        let changed = clock.changed(at, &slow, 1);
        assert!((changed.cycles(at) - clock.cycles(at).fract()).abs() < 1e-6);
    }
}
