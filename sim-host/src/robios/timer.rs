//! Timers that a program attaches: callbacks on the global grid of its generation's tick.

use robios_sys::Callback;
use sim_core::time::Time;

/// The tick of RoBIOS-7: timers run at 1 kHz.
pub const MILLISECOND: Time = Time::from_millis(1);

/// Maximum number of timers of a robot; our choice.
const MAX_TIMERS: usize = 32;

/// Timers that a program has attached.
#[derive(Default)]
pub struct Timers {
    list: Vec<Timer>,
    next_handle: i32,
    /// A callback is running: callbacks are never nested, and may not wait.
    pub in_callback: bool,
    /// The last callback was stopped before it returned.
    pub was_stopped_in_callback: bool,
    /// Timers are held from `OSDisable` to `OSEnable`: a timer that becomes due in between runs once, at `OSEnable`.
    pub are_held: bool,
}

struct Timer {
    handle: i32,
    period: Time,
    next: Time,
    callback: Callback,
}

impl Timers {
    /// Attaches `callback` to every `scale`-th point of the global grid of `tick` after `now`; returns the handle, or 0
    /// if the list is full or `scale` is not positive.
    pub fn attach(&mut self, now: Time, tick: Time, scale: i32, callback: Callback) -> i32 {
        if self.list.len() >= MAX_TIMERS || scale <= 0 {
            return 0;
        }
        let period = Time(tick.0 * i64::from(scale));
        self.next_handle += 1;
        self.list.push(Timer { handle: self.next_handle, period, next: now.floor_to(tick) + period, callback });
        self.next_handle
    }

    /// Removes a timer; returns false if no timer has this handle.
    pub fn detach(&mut self, handle: i32) -> bool {
        let old_count = self.list.len();
        self.list.retain(|timer| timer.handle != handle);
        self.list.len() < old_count
    }

    /// Returns true if no timer is attached.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Time of the next callback; [`Time::NEVER`] without timers, while they are held, and inside a callback.
    #[inline]
    pub fn next_due(&self) -> Time {
        if self.list.is_empty() || self.in_callback || self.are_held {
            return Time::NEVER;
        }
        self.list.iter().map(|timer| timer.next).min().unwrap_or(Time::NEVER)
    }

    /// Takes the timers due at `now`, in order of attachment; returns the handle of each, once even if it was due several
    /// times.
    pub fn take_due(&mut self, now: Time) -> Vec<i32> {
        let mut due = Vec::new();
        for timer in &mut self.list {
            if timer.next <= now {
                due.push(timer.handle);
                timer.skip_past(now);
            }
        }
        due
    }

    /// Callback of a timer; `None` if it has been detached.
    pub fn callback(&self, handle: i32) -> Option<Callback> {
        self.list.iter().find(|timer| timer.handle == handle).map(|timer| timer.callback)
    }

    /// Ends the running callbacks at `now`. Timers that became due while the callbacks ran skip this time, so that the
    /// program itself continues however long its callbacks take.
    pub fn end_callbacks(&mut self, now: Time) {
        self.in_callback = false;
        self.list.iter_mut().for_each(|timer| timer.skip_past(now));
    }
}

impl Timer {
    /// Moves the next due time of the timer past `now`.
    fn skip_past(&mut self, now: Time) {
        if self.next <= now {
            let missed = (now - self.next).0 / self.period.0;
            self.next += Time((missed + 1) * self.period.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn callbacks_are_due_on_the_global_grid() {
        let mut timers = Timers::default();
        assert_eq!(timers.attach(Time(2_300), MILLISECOND, 5, Callback::NONE), 1);
        assert_eq!(timers.attach(Time(2_300), MILLISECOND, 0, Callback::NONE), 0);
        assert_eq!(timers.next_due(), Time(7_000));
        assert_eq!(timers.take_due(Time(6_999)).len(), 0);
        assert_eq!(timers.take_due(Time(7_000)).len(), 1);
        assert_eq!(timers.next_due(), Time(12_000));
        assert!(timers.callback(1).is_some());
        assert!(timers.detach(1) && !timers.detach(1));
        assert!(timers.callback(1).is_none(), "a detached timer does not run, even if it was due");
    }

    #[test]
    fn ticks_during_callbacks_are_dropped() {
        let mut timers = Timers::default();
        timers.attach(Time(0), MILLISECOND, 1, Callback::NONE);
        timers.attach(Time(0), MILLISECOND, 2, Callback::NONE);
        assert_eq!(timers.take_due(Time(1_000)).len(), 1);
        timers.in_callback = true;
        assert_eq!(timers.next_due(), Time::NEVER, "never nested");
        timers.end_callbacks(Time(4_000));
        assert_eq!(timers.next_due(), Time(5_000));
        assert_eq!(timers.take_due(Time(5_000)).len(), 1);
    }

    #[test]
    fn held_timers_run_once_when_they_are_released() {
        let mut timers = Timers::default();
        timers.attach(Time(0), MILLISECOND, 1, Callback::NONE);
        timers.are_held = true;
        assert_eq!(timers.next_due(), Time::NEVER);
        timers.are_held = false;
        assert_eq!(timers.next_due(), Time(1_000));
        assert_eq!(timers.take_due(Time(9_500)).len(), 1);
        assert_eq!(timers.next_due(), Time(10_000));
    }
}
