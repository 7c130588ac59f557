//! Periodic measurements: the value of a sensor exists only after a complete cycle.

use crate::time::Time;

/// A measurement in progress: cycle n (from 1) ends n periods after the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    start: Time,
    period: Time,
    /// Number of the last cycle; `i64::MAX` in continuous mode.
    last: i64,
}

impl Cycle {
    /// A measurement that starts at `start` and takes one cycle, or runs continuously until stopped.
    pub fn new(start: Time, period: Time, is_continuous: bool) -> Self {
        Self { start, period, last: if is_continuous { i64::MAX } else { 1 } }
    }

    /// Number of cycles that are complete at `now`.
    #[inline]
    pub fn completed(&self, now: Time) -> i64 {
        ((now - self.start).0.max(0) / self.period.0).min(self.last)
    }

    /// End of cycle `n`.
    #[inline]
    pub fn end(&self, n: i64) -> Time {
        self.start + Time(self.period.0.saturating_mul(n))
    }

    /// End of the last cycle; [`Time::NEVER`] in continuous mode.
    #[inline]
    pub fn last_end(&self) -> Time {
        if self.last == i64::MAX { Time::NEVER } else { self.end(self.last) }
    }

    /// End of the latest complete cycle; `None` before the end of the first.
    #[inline]
    pub fn latest_end(&self, now: Time) -> Option<Time> {
        let completed = self.completed(now);
        (completed > 0).then(|| self.end(completed))
    }

    /// Returns true if the last cycle is complete.
    #[inline]
    pub fn is_over(&self, now: Time) -> bool {
        self.completed(now) == self.last
    }

    /// Makes the cycle in progress at `now` the last one.
    pub fn stop(&mut self, now: Time) {
        self.last = self.last.min(self.completed(now) + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_end_at_multiples_of_the_period() {
        let cycle = Cycle::new(Time(1_000), Time(60_000), true);
        assert_eq!(cycle.latest_end(Time(60_999)), None);
        assert_eq!(cycle.latest_end(Time(61_000)), Some(Time(61_000)));
        assert_eq!(cycle.latest_end(Time(200_000)), Some(Time(181_000)));
        assert_eq!(cycle.last_end(), Time::NEVER);
        assert_eq!(cycle.latest_end(Time(0)), None, "before the start");
    }

    #[test]
    fn a_single_measurement_ends_after_one_cycle() {
        let cycle = Cycle::new(Time(0), Time(60_000), false);
        assert!(!cycle.is_over(Time(59_999)));
        assert!(cycle.is_over(Time(60_000)));
        assert_eq!(cycle.latest_end(Time(10_000_000)), Some(Time(60_000)));
    }

    #[test]
    fn stop_completes_the_cycle_in_progress() {
        let mut cycle = Cycle::new(Time(0), Time(60_000), true);
        cycle.stop(Time(70_000));
        assert_eq!(cycle.last_end(), Time(120_000));
        cycle.stop(Time(500_000));
        assert_eq!(cycle.latest_end(Time(500_000)), Some(Time(120_000)), "a second stop changes nothing");
    }
}
