//! Queue of the pages' requests to the thread that advances the run.

use std::time::Duration;

use parking_lot::{Condvar, Mutex, MutexGuard};
use sim_core::record::Action;
use sim_core::time::Time;
use sim_view::window::PendingCommand;

/// Passes the pages' requests to the thread that advances the run, which checks for them between two slots.
#[derive(Default)]
pub struct Control {
    requests: Mutex<PendingRequests>,
    new_request: Condvar,
}

/// Pending requests to a run.
#[derive(Default)]
pub struct PendingRequests {
    /// True if something was requested since the last call of [`Control::wait`].
    is_new: bool,
    /// True if the run must pause before the next slot.
    pub is_paused: bool,
    /// Time to which the run must advance as fast as possible, even while paused.
    pub skip_to: Option<Time>,
    /// Number of slots to run while paused.
    pub steps: u32,
    /// Simulated seconds per second of wall-clock time; none for as fast as possible.
    pub speed: Option<f64>,
    /// Interventions in order, each with the command of a page to be answered.
    pub actions: Vec<(Action, PendingCommand)>,
    /// True if an update of the pages is due.
    pub is_show_due: bool,
    /// True if the run must end because another run begins.
    pub is_ending: bool,
    /// True if the run is over or has not begun: interventions are refused.
    pub is_over: bool,
}

impl Control {
    /// Updates the requests and wakes the thread that waits for them.
    pub fn update<T>(&self, change: impl FnOnce(&mut PendingRequests) -> T) -> T {
        let mut requests = self.requests.lock();
        requests.is_new = true;
        self.new_request.notify_all();
        change(&mut requests)
    }

    /// Locks the requests.
    pub fn requests(&self) -> MutexGuard<'_, PendingRequests> {
        self.requests.lock()
    }

    /// Returns at once if something was requested since the last call of this function; otherwise waits for a request,
    /// at most for `timeout`.
    pub fn wait(&self, timeout: Duration) {
        let mut requests = self.requests.lock();
        if !requests.is_new {
            self.new_request.wait_for(&mut requests, timeout);
        }
        requests.is_new = false;
    }
}
