//! Pacing of a run relative to wall-clock time.

use std::time::{Duration, Instant};

use sim_core::time::Time;

use super::interrupt::Interrupt;

/// Ratio of virtual to real time, measured from the first wait.
pub struct Pace {
    factor: f64,
    start: Option<Instant>,
}

impl Pace {
    /// Maximum sleep between two checks of the interrupt.
    const MAX_SLEEP: Duration = Duration::from_millis(20);

    /// Creates a pace of `factor` virtual seconds for each second of real time; `factor` must be above 0.
    pub fn new(factor: f64) -> Self {
        Self { factor, start: None }
    }

    /// Sleeps until real time has reached the virtual time `due`; returns false if the run is interrupted before.
    pub fn wait_until(&mut self, due: Time, interrupt: &Interrupt) -> bool {
        let start = *self.start.get_or_insert_with(Instant::now);
        let due = start + Duration::try_from_secs_f64(due.seconds() / self.factor).unwrap_or(Duration::MAX / 4);
        while !interrupt.is_set() {
            let remaining = due.saturating_duration_since(Instant::now());
            if remaining.is_zero() {
                return true;
            }
            std::thread::sleep(remaining.min(Self::MAX_SLEEP));
        }
        false
    }
}
