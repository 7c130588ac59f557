//! A run in step with real time.

use std::time::{Duration, Instant};

use super::conductor::End;
use super::gate::{Boundary, Gate, Pass};
use super::signal;

/// So many virtual seconds for each second of real time, from the first slot on.
pub struct Pace {
    factor: f64,
    start: Option<Instant>,
}

impl Pace {
    /// How long the pace sleeps without looking whether the user wants to stop.
    const NAP: Duration = Duration::from_millis(20);

    /// Virtual seconds for each second of real time, above 0.
    pub fn new(factor: f64) -> Self {
        Self { factor, start: None }
    }
}

impl Gate for Pace {
    /// Sleeps until real time has reached the next slot, or the user interrupts.
    fn wait(&mut self, boundary: &Boundary<'_>) -> Pass {
        let Some(next) = boundary.next.filter(|next| *next < boundary.until) else { return Pass::Begin };
        let start = *self.start.get_or_insert_with(Instant::now);
        let due = start + Duration::try_from_secs_f64(next.seconds() / self.factor).unwrap_or(Duration::MAX / 4);
        while !signal::is_interrupted() {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Pass::Begin;
            }
            std::thread::sleep(left.min(Self::NAP));
        }
        Pass::End(End::Interrupted)
    }
}
