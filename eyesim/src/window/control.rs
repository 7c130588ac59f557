//! Queue of the pages' requests to the thread that advances the run.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use parking_lot::{Condvar, Mutex, MutexGuard};
use sim_core::record::Action;
use sim_core::time::Time;
use sim_view::window::PendingCommand;

/// Passes the pages' requests to the thread that advances the run, which checks for them between two slots.
#[derive(Default)]
pub struct Control {
    is_changed: AtomicBool,
    requests: Mutex<PendingRequests>,
    changed: Condvar,
}

/// Pending requests to a run.
#[derive(Default)]
pub struct PendingRequests {
    /// The run pauses before the next slot.
    pub is_paused: bool,
    /// The run advances to this time as fast as possible, even while paused.
    pub skip_to: Option<Time>,
    /// Number of slots to run while paused.
    pub steps: u32,
    /// Simulated seconds per second of wall-clock time; none for as fast as possible.
    pub speed: Option<f64>,
    /// Interventions in order, each with the command of a page to be answered.
    pub actions: Vec<(Action, PendingCommand)>,
    /// An update of the pages is due.
    pub is_show_due: bool,
    /// The run must end because another run begins.
    pub is_ending: bool,
    /// The run is over or has not begun: interventions are refused.
    pub is_over: bool,
}

impl Control {
    /// Changes the requests and wakes the thread that waits for them.
    pub fn ask<T>(&self, change: impl FnOnce(&mut PendingRequests) -> T) -> T {
        let answer = change(&mut self.requests.lock());
        self.is_changed.store(true, Ordering::Release);
        self.changed.notify_all();
        answer
    }

    /// Returns true if something was requested since the last call of [`Self::requests`].
    fn is_changed(&self) -> bool {
        self.is_changed.load(Ordering::Acquire)
    }

    /// Locks the requests and marks them as seen.
    pub fn requests(&self) -> MutexGuard<'_, PendingRequests> {
        self.is_changed.store(false, Ordering::Release);
        self.requests.lock()
    }

    /// Waits for a request, at most for `time`.
    pub fn wait(&self, time: Duration) {
        let mut requests = self.requests.lock();
        if !self.is_changed() {
            self.changed.wait_for(&mut requests, time);
        }
    }
}
