//! Gaits: order and timing of the swing phases.

use super::curve::{HEEL_OFF, TOE_OFF};
use crate::time::Time;

/// Decision instants per gait period.
pub(super) const GRID: i64 = 48;

/// A gait: the order and the timing of the steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    /// Name of the gait.
    pub name: String,
    /// Time from one lift-off of a foot to its next lift-off.
    pub period: Time,
    /// Duty factor: fraction of the period for which a foot is on the ground, above 0 and below 1.
    pub duty: f64,
    /// Phase of the lift-off of each leg, as a fraction of the period, 0 to 1; the simulation rounds it to the nearest
    /// 48th.
    pub offsets: Vec<f64>,
    /// True if legs with feet follow human joint angles: see [`natural_angles`](super::natural_angles).
    pub is_natural: bool,
}

impl Gait {
    /// Index of the decision instant, modulo [`GRID`], at which a leg lifts off.
    pub(super) fn lift_off_index(&self, leg: usize) -> i64 {
        let offset = self.offsets.get(leg).copied().unwrap_or(0.0);
        ((offset * GRID as f64).round() as i64).rem_euclid(GRID)
    }

    /// Duration of the roll-off over the toe before lift-off in a natural gait, in decision instants.
    pub(super) fn roll_off_instants(&self) -> i64 {
        ((TOE_OFF - HEEL_OFF) / TOE_OFF * self.duty * GRID as f64).round() as i64
    }

    /// Duration of the swing phase in a cycle of length `period`.
    pub(super) fn swing_duration(&self, period: Time) -> Time {
        Time(((1.0 - self.duty) * period.0 as f64).round() as i64).max(Time(1))
    }
}

/// Clock of a walk: gives the decision instants, 48 per period, indexed from 0.
///
/// The first cycle of a walk from rest takes half a period, so that no foot stays behind its neutral position by more
/// than half a stride. Our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clock {
    /// Start of validity: decision instants of the clock are after `valid_from`.
    pub valid_from: Time,
    /// Time of instant 0; at most one interval between instants after `valid_from`.
    origin: Time,
    /// Length of the first cycle; all later cycles have the length `period`.
    first_period: Time,
    period: Time,
    /// Index of the gait.
    pub gait: usize,
}

impl Clock {
    /// Clock of a walk that begins at `at`; the first lift-off is at the next instant.
    pub fn starting(at: Time, gait: &Gait, index: usize) -> Self {
        let first_period = Time(gait.period.0 / 2).max(Time(GRID));
        let lift_offs = (0..gait.offsets.len()).map(|leg| gait.lift_off_index(leg));
        let start_index = lift_offs.min().unwrap_or(0) - 1;
        let clock = Self { valid_from: at, origin: at, first_period, period: gait.period, gait: index };
        // `start_index` may be -1, one instant before instant 0 of the clock.
        Self { origin: at - (clock.instant(start_index) - at), ..clock }
    }

    /// Clock of another gait that continues this one from `at` on, at the same phase.
    pub fn with_gait(&self, at: Time, gait: &Gait, index: usize) -> Self {
        let phase = self.cycles(at) - self.cycles(at).floor();
        let origin = at - Time((phase * gait.period.0 as f64).round() as i64);
        Self { valid_from: at, origin, first_period: gait.period, period: gait.period, gait: index }
    }

    /// Time of decision instant `index`.
    pub fn instant(&self, index: i64) -> Time {
        if index <= GRID {
            self.origin + Time((index * self.first_period.0).div_euclid(GRID))
        } else {
            self.origin + self.first_period + Time(((index - GRID) * self.period.0).div_euclid(GRID))
        }
    }

    /// Index of the first decision instant after `at` and after `valid_from`.
    pub fn next_after(&self, at: Time) -> i64 {
        let at = at.max(self.valid_from);
        let mut index = ((self.cycles(at) * GRID as f64).floor() as i64 - 1).max(0);
        while self.instant(index) <= at {
            index += 1;
        }
        index
    }

    /// The first instant after `at` at which a leg with this lift-off index lifts off.
    pub fn next_lift_off(&self, at: Time, lift_off_index: i64) -> Time {
        let index = self.next_after(at);
        self.instant(index + (lift_off_index - index).rem_euclid(GRID))
    }

    /// Length of the cycle that contains instant `index`.
    pub fn period_at(&self, index: i64) -> Time {
        if index < GRID { self.first_period } else { self.period }
    }

    /// Number of cycles from instant 0 to `at`.
    pub fn cycles(&self, at: Time) -> f64 {
        let elapsed = at - self.origin;
        if elapsed <= self.first_period {
            elapsed.seconds() / self.first_period.seconds()
        } else {
            1.0 + (elapsed - self.first_period).seconds() / self.period.seconds()
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
    fn first_lift_off_is_at_the_next_instant_and_first_cycle_is_half_a_period() {
        let clock = Clock::starting(Time(7_000), &gait(), 0);
        let first = clock.next_lift_off(Time(7_000), gait().lift_off_index(1));
        assert!(first > Time(7_000) && first - Time(7_000) <= Time(1_000_001 / 48), "{first:?}");
        let second = clock.next_lift_off(first, gait().lift_off_index(1));
        let third = clock.next_lift_off(second, gait().lift_off_index(1));
        assert_eq!(third - second, Time(1_000_001));
        assert_eq!(clock.next_lift_off(first, gait().lift_off_index(2)) - first, Time(500_000 / 4));
    }

    #[test]
    fn next_after_finds_every_instant_in_order() {
        let clock = Clock::starting(Time(-3), &gait(), 0);
        let mut at = Time(-3);
        for index in clock.next_after(at)..200 {
            assert_eq!(clock.next_after(at), index);
            assert!(clock.instant(index) > at);
            at = clock.instant(index);
        }
    }

    #[test]
    fn change_of_gait_keeps_the_phase() {
        let clock = Clock::starting(Time(0), &gait(), 0);
        let slow = Gait { period: Time(3_000_000), ..gait() };
        let at = Time(5_345_678);
        let changed = clock.with_gait(at, &slow, 1);
        assert!((changed.cycles(at) - clock.cycles(at).fract()).abs() < 1e-6);
    }
}
