//! Dispatches the pages' commands to the thread that advances the run, or to the [`RunStarter`].

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sim_view::protocol::{Command, Seed};
use sim_view::window::{PendingCommand, Window};

use super::action::action_from_page;
use super::control::Control;

/// Time between two updates of the pages: 60 per second.
const TICK: Duration = Duration::from_micros(16_667);

/// Time between two updates while no page is connected.
const IDLE_TICK: Duration = Duration::from_millis(200);

/// Restarts runs.
pub trait RunStarter: Send {
    /// Starts a run with this seed; answers `pending` once it is known whether the run can start.
    fn restart(&mut self, seed: Seed, pending: PendingCommand);

    /// Called periodically, at least every 200 ms.
    fn tick(&mut self);
}

/// Thread that dispatches the commands of pages until it is dropped.
pub struct ControlPanel {
    window: Arc<Window>,
    is_closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl ControlPanel {
    /// Starts the thread for the commands of `window`.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn open(
        window: Arc<Window>,
        control: Arc<Control>,
        mut starter: impl RunStarter + 'static,
    ) -> std::io::Result<Self> {
        let is_closing = Arc::new(AtomicBool::new(false));
        let thread = std::thread::Builder::new().name("control-panel".into()).spawn({
            let (window, is_closing) = (Arc::clone(&window), Arc::clone(&is_closing));
            move || serve(&window, &control, &mut starter, &is_closing)
        })?;
        Ok(Self { window, is_closing, thread: Some(thread) })
    }
}

impl Drop for ControlPanel {
    fn drop(&mut self) {
        self.is_closing.store(true, Ordering::Release);
        self.window.commands().wake();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been reported already.
            let _ = thread.join();
        }
    }
}

fn serve(window: &Window, control: &Control, starter: &mut impl RunStarter, is_closing: &AtomicBool) {
    let mut last_shown = Instant::now();
    while !is_closing.load(Ordering::Acquire) {
        let tick = if window.has_pages() { TICK } else { IDLE_TICK };
        match window.commands().recv_timeout(tick.saturating_sub(last_shown.elapsed())) {
            Some(pending) => dispatch(pending, control, starter),
            None => {
                last_shown = Instant::now();
                control.update(|requests| requests.is_show_due = true);
                starter.tick();
            }
        }
    }
}

fn dispatch(pending: PendingCommand, control: &Control, starter: &mut impl RunStarter) {
    match pending.command.clone() {
        Command::Run {} => {
            control.update(|requests| (requests.is_paused, requests.steps) = (false, 0));
            pending.accept();
        }
        Command::Pause {} => {
            control.update(|requests| (requests.is_paused, requests.skip_to) = (true, None));
            pending.accept();
        }
        Command::Step {} => {
            let is_over = control.update(|requests| {
                if !requests.is_over {
                    (requests.is_paused, requests.skip_to, requests.steps) = (true, None, requests.steps + 1);
                }
                requests.is_over
            });
            if is_over { pending.refuse(RUN_IS_OVER) } else { pending.accept() }
        }
        Command::Speed { factor } if factor.is_none_or(|factor| SPEEDS.contains(&factor)) => {
            control.update(|requests| requests.speed = factor);
            pending.accept();
        }
        Command::Speed { .. } => {
            let (min, max) = (SPEEDS.start(), SPEEDS.end());
            pending.refuse(format!("expected a factor from {min} to {max}, or none for as fast as possible"));
        }
        Command::Restart { seed } => starter.restart(seed, pending),
        Command::Act { action } => control.update(|requests| {
            if requests.is_over {
                return pending.refuse(RUN_IS_OVER);
            }
            requests.actions.push((action_from_page(action), pending));
        }),
    }
}

/// Accepted speeds, in simulated seconds per second of wall-clock time. At a lower speed nothing would seem to happen.
/// At a far higher speed an idle run would soon reach the end of simulated time.
pub const SPEEDS: RangeInclusive<f64> = 0.001..=10_000.0;

const RUN_IS_OVER: &str = "the run is over: start it again";
