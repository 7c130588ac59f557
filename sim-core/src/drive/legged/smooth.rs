//! A value that moves smoothly from one target to the next.

use crate::time::Time;

/// Quintic smoothstep: rises from 0 at `fraction` 0 to 1 at `fraction` 1, with slope and curvature 0 at both ends. It
/// is constant outside this interval.
pub(super) fn smooth(fraction: f64) -> f64 {
    let s = fraction.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// Fraction of the time span `span` after `start` that has elapsed at `at`, not clamped; 1 for a span of length 0.
pub(super) fn elapsed_fraction(at: Time, start: Time, span: Time) -> f64 {
    if span <= Time::ZERO { 1.0 } else { (at - start).seconds() / span.seconds() }
}

/// A number as a function of time: a sum of smooth steps, so that slope and curvature are continuous even when the
/// target changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SmoothValue {
    base: f64,
    /// Start, duration and height of each step.
    steps: Vec<(Time, Time, f64)>,
    /// Instant from which the value is 0, for any steps.
    end: Option<Time>,
}

impl SmoothValue {
    pub fn at(&self, at: Time) -> f64 {
        if self.end.is_some_and(|end| end <= at) {
            return 0.0;
        }
        self.steps
            .iter()
            .fold(self.base, |sum, (start, span, change)| sum + change * smooth(elapsed_fraction(at, *start, *span)))
    }

    /// Final value.
    pub fn goal(&self) -> f64 {
        if self.end.is_some() {
            return 0.0;
        }
        self.steps.iter().fold(self.base, |sum, (_, _, change)| sum + change)
    }

    /// Adds a step that starts at `start` and reaches `goal` within `span`.
    pub fn move_to(&mut self, start: Time, span: Time, goal: f64) {
        let change = goal - self.goal();
        if change != 0.0 {
            self.steps.push((start, span, change));
        }
    }

    /// Sets the value to 0 from `at` on, without a transition.
    pub fn end(&mut self, at: Time) {
        self.end.get_or_insert(at);
    }

    /// Returns true if the value is constant from `at` on.
    pub fn is_constant_from(&self, at: Time) -> bool {
        self.end.map_or_else(|| self.steps.iter().all(|(start, span, _)| *start + *span <= at), |end| end <= at)
    }

    /// Drops the oldest steps if they have ended at `at`. Values from `at` on stay bit-identical, because the sum
    /// starts with the oldest step.
    pub fn forget(&mut self, at: Time) {
        let done = self.steps.iter().take_while(|(start, span, _)| *start + *span <= at).count();
        self.base = self.steps.drain(..done).fold(self.base, |sum, (_, _, change)| sum + change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_reaches_its_goal_and_is_unchanged_by_forgetting() {
        let mut value = SmoothValue::default();
        value.move_to(Time(0), Time(100), 0.3);
        value.move_to(Time(50), Time(100), 0.1);
        assert_eq!(value.at(Time(0)), 0.0);
        assert!((value.at(Time(50)) - 0.15).abs() < 1e-15);
        assert!(
            (value.at(Time(150)) - 0.1).abs() < 1e-15
                && value.is_constant_from(Time(150))
                && !value.is_constant_from(Time(149))
        );
        let mut forgot = value.clone();
        forgot.forget(Time(120));
        for at in 120..160 {
            assert_eq!(value.at(Time(at)), forgot.at(Time(at)));
        }
        value.end(Time(80));
        assert_eq!([79, 80, 150].map(|at| value.at(Time(at)) != 0.0), [true, false, false]);
        assert!(value.goal() == 0.0 && value.is_constant_from(Time(80)) && !value.is_constant_from(Time(79)));
        assert_eq!((smooth(-1.0), smooth(0.5), smooth(2.0)), (0.0, 0.5, 1.0));
    }
}
