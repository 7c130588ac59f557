//! Notifier: wakes the supervisor from flows, from the scheduler step and from signal handlers.

use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// An eventfd on which one thread waits, and which any code may notify, including signal handlers.
pub struct Notifier {
    fd: OwnedFd,
    /// A flow has failed since the last [`Notifier::take_failure`].
    has_broken_flow: AtomicBool,
}

impl Notifier {
    /// Creates a notifier that has not been notified.
    ///
    /// # Errors
    /// The process has no file descriptor left.
    pub fn new() -> io::Result<Self> {
        // SAFETY: eventfd takes no pointer; a descriptor that is not negative is new and has no other owner.
        let fd = unsafe { libc::eventfd(0, libc::EFD_CLOEXEC | libc::EFD_NONBLOCK) };
        if fd < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: `fd` was just opened by this function, which hands its ownership over.
        Ok(Self { fd: unsafe { OwnedFd::from_raw_fd(fd) }, has_broken_flow: AtomicBool::new(false) })
    }

    /// Wakes the waiting thread; async-signal-safe, and idempotent until the next [`wait`](Self::wait).
    pub fn notify(&self) {
        let one = 1u64;
        // SAFETY: `one` has eight bytes; write is async-signal-safe. An error (a full counter) means that the notifier
        // is already notified.
        unsafe { libc::write(self.fd.as_raw_fd(), (&raw const one).cast(), 8) };
    }

    /// Wakes the waiting thread because a flow has failed; async-signal-safe.
    pub fn notify_break(&self) {
        self.has_broken_flow.store(true, Ordering::Release);
        self.notify();
    }

    /// Returns true if a flow has failed since the last call.
    pub fn take_failure(&self) -> bool {
        self.has_broken_flow.swap(false, Ordering::AcqRel)
    }

    /// Waits until notified or until `timeout` has passed, and clears the notification. Returns true if notified.
    pub fn wait(&self, timeout: Duration) -> bool {
        let mut poll = libc::pollfd { fd: self.fd.as_raw_fd(), events: libc::POLLIN, revents: 0 };
        let millis = i32::try_from(timeout.as_millis()).unwrap_or(i32::MAX);
        // SAFETY: `poll` is one valid pollfd, and the count is 1.
        let ready = unsafe { libc::poll(&mut poll, 1, millis) };
        if ready <= 0 {
            return false;
        }
        let mut count = 0u64;
        // SAFETY: `count` has the eight bytes that an eventfd writes.
        unsafe { libc::read(self.fd.as_raw_fd(), (&raw mut count).cast(), 8) == 8 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_notifications_wake_once() {
        let notifier = Notifier::new().unwrap();
        assert!(!notifier.wait(Duration::ZERO));
        notifier.notify();
        notifier.notify();
        assert!(notifier.wait(Duration::from_secs(5)));
        assert!(!notifier.wait(Duration::ZERO));
    }
}
