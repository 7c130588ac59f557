//! A value that moves smoothly from one target to the next.

use crate::time::Time;

/// Quintic smoothstep: rises from 0 to 1 with `fraction`, with slope and curvature 0 at both ends; constant beyond.
pub(super) fn smooth(fraction: f64) -> f64 {
    let s = fraction.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

/// Elapsed fraction of a span at `at`; 1 for a span of length 0.
pub(super) fn elapsed_fraction(at: Time, start: Time, span: Time) -> f64 {
    if span <= Time::ZERO { 1.0 } else { (at - start).seconds() / span.seconds() }
}

/// A number as a function of time: a sum of smooth steps, so that slope and curvature stay continuous at a new target.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SmoothValue {
    base: f64,
    steps: Vec<(Time, Time, f64)>,
}

impl SmoothValue {
    pub fn at(&self, at: Time) -> f64 {
        self.steps
            .iter()
            .fold(self.base, |sum, (start, span, by)| sum + by * smooth(elapsed_fraction(at, *start, *span)))
    }

    /// Final value.
    pub fn goal(&self) -> f64 {
        self.steps.iter().fold(self.base, |sum, (_, _, by)| sum + by)
    }

    /// Adds a step that starts at `start` and reaches `goal` within `span`.
    pub fn aim(&mut self, start: Time, span: Time, goal: f64) {
        let by = goal - self.goal();
        if by != 0.0 {
            self.steps.push((start, span, by));
        }
    }

    /// Returns true if the value is constant from `at` on.
    pub fn is_still(&self, at: Time) -> bool {
        self.steps.iter().all(|(start, span, _)| *start + *span <= at)
    }

    /// Drops the history before `at`. Values from `at` on stay bit-identical, because the sum starts with the oldest
    /// step.
    pub fn forget(&mut self, at: Time) {
        let done = self.steps.iter().take_while(|(start, span, _)| *start + *span <= at).count();
        self.base = self.steps.drain(..done).fold(self.base, |sum, (_, _, by)| sum + by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glide_comes_to_its_goal_and_forgets_without_a_trace() {
        let mut glide = SmoothValue::default();
        glide.aim(Time(0), Time(100), 0.3);
        glide.aim(Time(50), Time(100), 0.1);
        assert_eq!(glide.at(Time(0)), 0.0);
        assert!((glide.at(Time(50)) - 0.15).abs() < 1e-15);
        assert!((glide.at(Time(150)) - 0.1).abs() < 1e-15 && glide.is_still(Time(150)) && !glide.is_still(Time(149)));
        let mut forgot = glide.clone();
        forgot.forget(Time(120));
        for at in 120..160 {
            assert_eq!(glide.at(Time(at)), forgot.at(Time(at)));
        }
        assert_eq!((smooth(-1.0), smooth(0.5), smooth(2.0)), (0.0, 0.5, 1.0));
    }
}
