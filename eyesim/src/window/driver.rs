//! Advances a run that pages watch and control: paces, pauses and steps the run, applies the interventions that pages
//! request, and shows the run's state.

use std::mem::take;
use std::sync::Arc;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use sim_core::record::Action;
use sim_core::time::Time;
use sim_host::executive::dispatcher::Boundary;
use sim_host::executive::scheduler::{Progress, Scheduler};
use sim_view::protocol::RunState;
use sim_view::window::PendingCommand;

use super::control::Control;
use super::show::{Moment, Show};

/// Maximum wait without a check for requests.
const MAX_WAIT: Duration = Duration::from_millis(20);

/// Delay beyond which a run no longer catches up with its pace.
const MAX_DELAY: Duration = Duration::from_millis(250);

/// Minimum period over which the speed is measured.
const RATE_PERIOD: Duration = Duration::from_millis(500);

/// Interval at which a run at full speed checks for requests: short enough for users, long enough that its cost is
/// negligible.
const CHECK_INTERVAL: Duration = Duration::from_millis(5);

/// Minimum time between two updates of the pages at full speed: users cannot follow more updates.
const PERIOD_AT_FULL_SPEED: Duration = Duration::from_millis(125);

/// At full speed at most 1 / `INVERSE_SHARE_AT_FULL_SPEED` of the time goes into updates of the pages.
const INVERSE_SHARE_AT_FULL_SPEED: u32 = 25;

/// Advances a run with the pace, pauses, steps and interventions that its pages request.
pub struct Driver {
    control: Arc<Control>,
    show: Arc<Mutex<Show>>,
    is_paused: bool,
    speed: Option<f64>,
    /// Time to which the run advances at full speed; until then it has neither a pace nor pauses.
    skip_to: Option<Time>,
    /// Wall-clock and simulated time at which the current pace began.
    anchor: Option<(Instant, Time)>,
    /// Simulated time that the run has reached.
    now: Time,
    /// True if the latest change has not been shown to the pages yet.
    has_unshown_change: bool,
    /// Earliest instant of the next periodic update of the pages; changes are shown at once.
    next_update: Option<Instant>,
    rate: Rate,
}

impl Driver {
    /// Creates a driver that takes requests from `control` and shows the run with `show`.
    pub fn new(control: Arc<Control>, show: Arc<Mutex<Show>>) -> Self {
        Self {
            control,
            show,
            is_paused: false,
            speed: None,
            skip_to: None,
            anchor: None,
            now: Time::ZERO,
            has_unshown_change: true,
            next_update: None,
            rate: Rate::default(),
        }
    }

    /// Advances the run to its end.
    pub fn drive(&mut self, run: &mut Scheduler) {
        while self.advance(run) == Progress::Paused {}
    }

    /// Applies the requested pace and pause; returns the other requests.
    fn take_requests(&mut self) -> TakenRequests {
        let mut requests = self.control.requests();
        self.skip_to = requests.skip_to;
        let (is_paused, speed) =
            if self.skip_to.is_some() { (false, None) } else { (requests.is_paused, requests.speed) };
        if (self.is_paused, self.speed) != (is_paused, speed) {
            (self.is_paused, self.speed) = (is_paused, speed);
            self.anchor = None;
            self.has_unshown_change = true;
        }
        TakenRequests {
            is_ending: requests.is_ending,
            is_show_due: take(&mut requests.is_show_due),
            actions: take(&mut requests.actions),
        }
    }

    fn present(&mut self, run: &Scheduler, is_idle: bool) {
        let start = Instant::now();
        let state = match (self.is_paused, is_idle) {
            (true, _) => RunState::Paused,
            (_, true) => RunState::Idle,
            _ => RunState::Running,
        };
        let rate = if self.is_paused { 0.0 } else { self.rate.measure(start, self.now) };
        let (run, world) = (run.run(), &run.run().world());
        let (now, speed) = (self.now, self.speed);
        self.show.lock().present(Moment { run, world, now, state, speed, rate, ends: &[], results: None });
        let is_full_speed = self.speed.is_none() && !self.is_paused;
        // The texts of the update are serialised on another thread, but on the same processors.
        let min_delay = if is_full_speed {
            (INVERSE_SHARE_AT_FULL_SPEED * start.elapsed()).max(PERIOD_AT_FULL_SPEED)
        } else {
            start.elapsed()
        };
        self.next_update = Some(start + min_delay);
        self.has_unshown_change = false;
    }

    /// Returns true if the run has programs and all of them have ended.
    fn is_finished(run: &Scheduler) -> bool {
        let run = run.run();
        let mut programs = run.ids_with_program().peekable();
        programs.peek().is_some() && programs.all(|id| run.robot(id).ending.is_some())
    }

    /// Wall-clock time at which the slot at `next` is due, with `factor` simulated seconds per second of wall-clock
    /// time.
    fn due(&mut self, next: Time, factor: f64) -> Instant {
        let (real, simulated) = *self.anchor.get_or_insert_with(|| (Instant::now(), self.now));
        let seconds = (next - simulated).seconds() / factor;
        real + Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX / 4)
    }

    /// Advances simulated time with the clock while nothing happens, at most to the slot before `next`.
    fn follow_clock(&mut self, slot: Time, next: Option<Time>, factor: f64) {
        let (real, simulated) = *self.anchor.get_or_insert_with(|| (Instant::now(), self.now));
        let reached = simulated + Time::from_seconds_ceil(real.elapsed().as_secs_f64() * factor);
        let reached = reached.floor_to(slot).min(next.map_or(Time::NEVER, |next| next - slot));
        self.now = self.now.max(reached);
    }

    /// Runs the slot at `next`, which was due at `due`; at full speed also the slots that follow, for
    /// [`CHECK_INTERVAL`].
    fn run_slot(&mut self, run: &mut Scheduler, next: Time, due: Option<Instant>) -> Progress {
        if due.is_some_and(|due| due.elapsed() > MAX_DELAY) {
            self.anchor = None;
        }
        if self.is_paused || self.speed.is_some() {
            run.advance_to(next + Time(1))
        } else {
            run.advance_within(self.skip_to.unwrap_or(Time::NEVER), CHECK_INTERVAL)
        }
    }

    /// Waits until a slot is due or requested, or an intervention is pending. Then runs slots or applies the
    /// interventions.
    fn advance(&mut self, run: &mut Scheduler) -> Progress {
        let boundary @ Boundary { limit, slot, .. } = run.boundary();
        let next = boundary.next_within_limit();
        self.now = self.now.max(boundary.following);
        loop {
            let requests = self.take_requests();
            if requests.is_ending || run.run().interrupt().is_set() {
                run.interrupt();
                return Progress::Over;
            }
            if !requests.actions.is_empty() {
                return self.apply(run, requests.actions);
            }
            let is_over = boundary.next.is_some() && next.is_none() || next.is_none() && Self::is_finished(run);
            if let Some(time) = self.skip_to.filter(|time| next.is_none_or(|next| next >= *time)) {
                if !is_over {
                    // The first slot that does not begin before `time`, or the last one before the limit.
                    let start = (time + slot - Time(1)).min(limit - Time(1)).floor_to(slot);
                    self.now = self.now.max(start);
                }
                self.control.update(|requests| requests.skip_to = None);
                continue;
            }
            let is_idle = next.is_none();
            let may_show = self.next_update.is_none_or(|instant| instant <= Instant::now());
            if self.has_unshown_change
                || requests.is_show_due && may_show && (!self.is_paused || self.show.lock().has_new_looks())
            {
                self.present(run, is_idle && !is_over);
            }
            match (self.is_paused, next) {
                (true, _) if self.take_step() => {
                    self.has_unshown_change = true;
                    match next {
                        _ if is_over => return Progress::Over,
                        Some(next) if next <= self.now => return self.run_slot(run, next, None),
                        _ => self.now += slot,
                    }
                }
                (true, _) => self.control.wait(MAX_WAIT),
                (false, _) if is_over => return Progress::Over,
                (false, Some(next)) => {
                    let Some(factor) = self.speed else { return self.run_slot(run, next, None) };
                    let due = self.due(next, factor);
                    let remaining = due.saturating_duration_since(Instant::now());
                    if remaining.is_zero() {
                        return self.run_slot(run, next, Some(due));
                    }
                    self.follow_clock(slot, Some(next), factor);
                    self.control.wait(remaining.min(MAX_WAIT));
                }
                (false, None) => {
                    if let Some(factor) = self.speed {
                        self.follow_clock(slot, None, factor);
                        if self.now >= limit {
                            return Progress::Over;
                        }
                    }
                    self.control.wait(MAX_WAIT);
                }
            }
        }
    }

    /// Applies interventions to the run and answers the pages that requested them.
    fn apply(&mut self, run: &mut Scheduler, actions: Vec<(Action, PendingCommand)>) -> Progress {
        self.has_unshown_change = true;
        for (action, pending) in actions {
            match run.act(self.now, &action) {
                Ok(()) => pending.accept(),
                Err(refusal) => pending.refuse(refusal.to_string()),
            }
        }
        if run.is_ending() { Progress::Over } else { Progress::Paused }
    }

    /// Consumes one requested single step; returns false if none is pending.
    fn take_step(&self) -> bool {
        let mut requests = self.control.requests();
        let has_step = requests.steps > 0;
        requests.steps = requests.steps.saturating_sub(1);
        has_step
    }
}

/// Requests that [`Driver::take_requests`] returns.
struct TakenRequests {
    is_ending: bool,
    is_show_due: bool,
    actions: Vec<(Action, PendingCommand)>,
}

/// Measures simulated seconds per second of wall-clock time.
#[derive(Default)]
struct Rate {
    window_start: Option<(Instant, Time)>,
    last: f64,
}

impl Rate {
    fn measure(&mut self, real: Instant, simulated: Time) -> f64 {
        let (start, start_time) = *self.window_start.get_or_insert((real, simulated));
        let seconds = (real - start).as_secs_f64();
        if seconds >= RATE_PERIOD.as_secs_f64() {
            self.last = (simulated - start_time).seconds() / seconds;
            self.window_start = Some((real, simulated));
        }
        self.last
    }
}
