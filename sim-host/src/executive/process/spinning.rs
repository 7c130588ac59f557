//! Decides whether the host spins for the next message of a child before it sleeps.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::time::Duration;

use super::channel::{Channel, Turn};
use crate::host;

/// Time for the code between two calls of a program in Python. Our choice.
const CODE_TIME: Duration = Duration::from_micros(50);

/// Limit of a spin after the child had to be woken: [`CODE_TIME`] plus the time that the kernel needs to wake it on an
/// idle processor. Our choice.
const WAKE_TIME: Duration = Duration::from_micros(200);

/// Maximum value of [`Spinning::failures`] at which the host spins. With a greater value it sleeps at once, except in
/// one of [`PERIOD`] waits. Our choice.
const MAX_FAILURES: u32 = 6;

/// See [`MAX_FAILURES`].
const PERIOD: u32 = 32;

/// Number of children of this process.
static CHILDREN: AtomicUsize = AtomicUsize::new(0);

/// Spins of the host for the messages of one child.
///
/// To wake a thread on an idle processor takes several times as long as a call. But a thread that spins while no
/// processor is free keeps a child from running. So the host spins only if all of these hold:
///
/// - There are two processors for each child: one for the child and one for the thread that serves it.
/// - The child and the thread that serves it are not bound to one processor.
/// - Most recent spins ended with a message, or it is the one wait in [`PERIOD`] that tries a spin anyway; see
///   [`MAX_FAILURES`].
///
/// The child spins for an answer only if the host was awake when it got the turn.
pub struct Spinning {
    /// Each spin without a message increases this value by 2, up to [`MAX_FAILURES`] + 2; each spin with a message
    /// decreases it by 1, down to 0.
    failures: AtomicU32,
    /// Number of waits.
    waits: AtomicU32,
    /// The child and the thread that serves it are bound to one processor: a spin would keep the child from running.
    is_bound: AtomicBool,
}

impl Spinning {
    /// Creates the state for a new child, and counts the child.
    pub fn of_child() -> Self {
        CHILDREN.fetch_add(1, Ordering::Relaxed);
        Self { failures: AtomicU32::new(0), waits: AtomicU32::new(0), is_bound: AtomicBool::new(false) }
    }

    /// Records that the child and the thread that serves it are bound to the same processor: there are no more spins.
    pub fn note_binding(&self) {
        self.is_bound.store(true, Ordering::Relaxed);
    }

    /// Returns true if there is a processor for each child, and another one for each thread that serves a child.
    pub fn has_processors() -> bool {
        are_enough(host::processors(), CHILDREN.load(Ordering::Relaxed))
    }

    /// Spins until the host has the turn on `channel`, or for a limited time, if that is worth it.
    pub fn spin(&self, channel: &Channel) {
        if self.is_worth_it(Self::has_processors()) {
            let limit = if channel.has_woken() { WAKE_TIME } else { CODE_TIME };
            self.record(channel.spin_for(Turn::Host, limit));
        }
    }

    /// Counts a wait. Returns true if it may begin with a spin.
    fn is_worth_it(&self, has_processors: bool) -> bool {
        let is_probe = self.waits.fetch_add(1, Ordering::Relaxed).is_multiple_of(PERIOD);
        has_processors
            && !self.is_bound.load(Ordering::Relaxed)
            && (is_probe || self.failures.load(Ordering::Relaxed) <= MAX_FAILURES)
    }

    /// Records whether a spin has ended with a message.
    fn record(&self, has_message: bool) {
        let failures = self.failures.load(Ordering::Relaxed);
        let failures = if has_message { failures.saturating_sub(1) } else { (failures + 2).min(MAX_FAILURES + 2) };
        self.failures.store(failures, Ordering::Relaxed);
    }
}

impl Drop for Spinning {
    fn drop(&mut self) {
        CHILDREN.fetch_sub(1, Ordering::Relaxed);
    }
}

fn are_enough(processors: usize, children: usize) -> bool {
    processors / 2 >= children
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spins_end_when_most_are_in_vain_and_begin_again() {
        let spinning = Spinning::of_child();
        let spins = |waits: u32| (0..waits).filter(|_| spinning.is_worth_it(true)).count();
        assert_eq!(spins(PERIOD), PERIOD as usize);
        // One spin in vain among many does not matter.
        for has_message in [false, true, true, false, true, true] {
            spinning.record(has_message);
        }
        assert_eq!(spins(PERIOD), PERIOD as usize);
        (0..10).for_each(|_| spinning.record(false));
        assert_eq!(spins(10 * PERIOD), 10, "probes");
        (0..2).for_each(|_| spinning.record(true));
        assert_eq!(spins(PERIOD), PERIOD as usize);
    }

    #[test]
    fn spins_need_two_processors_for_each_child() {
        let expected = [(1, 1, false), (2, 1, true), (3, 2, false), (4, 2, true), (8, 5, false)];
        for (processors, children, is_enough) in expected {
            assert_eq!(are_enough(processors, children), is_enough, "{children} on {processors}");
        }
        let spinning = Spinning::of_child();
        assert!(spinning.is_worth_it(true) && !spinning.is_worth_it(false));
        spinning.note_binding();
        assert!(!spinning.is_worth_it(true), "the child shares its processor");
    }
}
