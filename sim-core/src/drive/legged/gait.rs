//! Gaits: order and timing of the swing phases.

use super::curve::{HEEL_OFF, TOE_OFF};
use crate::time::Time;

/// Decision instants per gait period.
pub(super) const GRID: i64 = 48;

/// A gait: the order and the timing of the feet.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Its name.
    pub name: String,
    /// Time from one lift-off of a foot to its next lift-off.
    pub period: Time,
    /// Duty factor: fraction of the period for which a foot is on the ground, above 0 and below 1.
    pub duty: f64,
    /// Phase of the lift-off of each leg, as a fraction of the period, 0 to 1; rounded to the nearest 48th.
    pub offsets: Vec<f64>,
    /// True if legs with feet follow human joint angles: see [`natural_angles`](super::natural_angles).
    pub is_natural: bool,
}

impl Gait {
    /// Index of the lift-off of a leg on the grid of decision instants, modulo [`GRID`].
    pub(super) fn slot(&self, leg: usize) -> i64 {
        let offset = self.offsets.get(leg).copied().unwrap_or(0.0);
        ((offset * GRID as f64).round() as i64).rem_euclid(GRID)
    }

    /// Duration of the toe roll-off before lift-off in a natural gait, in decision instants.
    pub(super) fn rolling(&self) -> i64 {
        ((TOE_OFF - HEEL_OFF) / TOE_OFF * self.duty * GRID as f64).round() as i64
    }

    /// Duration of the swing phase in a cycle of length `period`.
    pub(super) fn swing(&self, period: Time) -> Time {
        Time(((1.0 - self.duty) * period.0 as f64).round() as i64).max(Time(1))
    }
}

/// The clock of a walk: decision instants, 48 per period, counted from 0.
///
/// The first cycle of a walk from rest takes half the time, so that no foot trails by more than half a
/// stride. Our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clock {
    /// Start of validity: the first decision instant of the clock comes after `opened`.
    pub opened: Time,
    /// Time of instant 0; at most one instant after `opened`.
    since: Time,
    /// Length of the first cycle; all later cycles have the length `period`.
    first: Time,
    period: Time,
    pub gait: usize,
}

impl Clock {
    /// Clock of a walk that begins at `at`; the first lift-off follows soon.
    pub fn starting(at: Time, gait: &Gait, index: usize) -> Self {
        let first = Time(gait.period.0 / 2).max(Time(GRID));
        let slots = (0..gait.offsets.len()).map(|leg| gait.slot(leg));
        let ahead = slots.min().unwrap_or(0) - 1;
        let clock = Self { opened: at, since: at, first, period: gait.period, gait: index };
        // `ahead` may be -1, one instant before instant 0 of the clock.
        Self { since: at - (clock.instant(ahead) - at), ..clock }
    }

    /// Clock of another gait that continues this one from `at` on, at the same phase.
    pub fn changed(&self, at: Time, gait: &Gait, index: usize) -> Self {
        let phase = self.cycles(at) - self.cycles(at).floor();
        let since = at - Time((phase * gait.period.0 as f64).round() as i64);
        Self { opened: at, since, first: gait.period, period: gait.period, gait: index }
    }

    /// Time of decision instant `index`.
    pub fn instant(&self, index: i64) -> Time {
        if index <= GRID {
            self.since + Time((index * self.first.0).div_euclid(GRID))
        } else {
            self.since + self.first + Time(((index - GRID) * self.period.0).div_euclid(GRID))
        }
    }

    /// Index of the first decision instant after `at` and after `opened`.
    pub fn next_after(&self, at: Time) -> i64 {
        let at = at.max(self.opened);
        let mut index = ((self.cycles(at) * GRID as f64).floor() as i64 - 1).max(0);
        while self.instant(index) <= at {
            index += 1;
        }
        index
    }

    /// The first instant after `at` at which a leg with this lift-off index lifts off.
    pub fn next_slot(&self, at: Time, slot: i64) -> Time {
        let index = self.next_after(at);
        self.instant(index + (slot - index).rem_euclid(GRID))
    }

    /// Length of the cycle that contains instant `index`.
    pub fn period_at(&self, index: i64) -> Time {
        if index < GRID { self.first } else { self.period }
    }

    /// Number of cycles since instant 0.
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
