//! Real time: so many virtual seconds for each second of it.

use std::time::{Duration, Instant};

use sim_core::time::Time;

use super::interrupt::Interrupt;

/// So many virtual seconds for each second of real time, counted from the first wait on.
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

    /// Sleeps until real time has reached the virtual time `due`; false if the run is interrupted before.
    pub fn wait_until(&mut self, due: Time, interrupt: &Interrupt) -> bool {
        let start = *self.start.get_or_insert_with(Instant::now);
        let due = start + Duration::try_from_secs_f64(due.seconds() / self.factor).unwrap_or(Duration::MAX / 4);
        while !interrupt.is_set() {
            let left = due.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return true;
            }
            std::thread::sleep(left.min(Self::NAP));
        }
        false
    }
}
