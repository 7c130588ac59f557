//! Decides whether the host spins for the next message of a child before it sleeps.

use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::time::Duration;

use super::channel::{Channel, Turn};
use crate::host;

/// Time for the code between two calls of a program in Python. Our choice.
const CODE_TIME: Duration = Duration::from_micros(50);

/// The same, and the time in which the kernel wakes the child on a processor that is idle. Our choice.
const WAKE_TIME: Duration = Duration::from_micros(200);

/// With more failures the host sleeps at once, except for one wait of [`PERIOD`]. Our choice.
const MAX_FAILURES: u32 = 6;

/// See [`MAX_FAILURES`].
const PERIOD: u32 = 32;

/// Number of children of this process.
static CHILDREN: AtomicUsize = AtomicUsize::new(0);

/// Spins of the host for the messages of one child.
///
/// To wake a thread on an idle processor takes several times as long as a call. But a thread that spins while no
/// processor is free keeps a child from running. So the host spins if there are two processors for each child, one for
/// the child and one for the thread that serves it, and as long as most spins end with a message. The child spins only
/// if the host does.
pub struct Spinning {
    /// Increased by each spin without a message by more than a spin with a message decreases it.
    failures: AtomicU32,
    /// Number of waits.
    waits: AtomicU32,
}

impl Spinning {
    /// Spins for the messages of a new child.
    pub fn of_child() -> Self {
        CHILDREN.fetch_add(1, Ordering::Relaxed);
        Self { failures: AtomicU32::new(0), waits: AtomicU32::new(0) }
    }
}

impl Drop for Spinning {
    fn drop(&mut self) {
        CHILDREN.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Spinning {
    /// Spins until the host has the turn on `channel`, or for a limited time, if that is worth it.
    pub fn spin(&self, channel: &Channel) {
        let failures = self.failures.load(Ordering::Relaxed);
        let is_probe = self.waits.fetch_add(1, Ordering::Relaxed).is_multiple_of(PERIOD);
        if 2 * CHILDREN.load(Ordering::Relaxed) > host::processors() || failures > MAX_FAILURES && !is_probe {
            return;
        }
        let limit = if channel.has_woken() { WAKE_TIME } else { CODE_TIME };
        let failures = match channel.spin_for(Turn::Host, limit) {
            true => failures.saturating_sub(1),
            false => (failures + 2).min(MAX_FAILURES + 2),
        };
        self.failures.store(failures, Ordering::Relaxed);
    }
}
