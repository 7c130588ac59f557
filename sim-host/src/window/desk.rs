//! Dispatch of the pages' commands to the run, to the thread that advances it, or to the [`Starter`] of runs.

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sim_view::protocol::{Command, Seed};
use sim_view::window::{Asked, Window};

use super::action::action_from_page;
use super::control::Control;

/// Time between two updates of the pages: 60 a second.
const TICK: Duration = Duration::from_micros(16_667);

/// Time between two updates while no page is connected.
const LAZY_TICK: Duration = Duration::from_millis(200);

/// Restarts runs.
pub trait Starter: Send {
    /// Starts a run with this seed; answers `asked` once it is known if the run can start.
    fn restart(&mut self, seed: Seed, asked: Asked);

    /// Called often, at least every 200 ms.
    fn tick(&mut self);
}

/// Thread that dispatches the commands of pages until it is dropped.
pub struct Desk {
    window: Arc<Window>,
    is_closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Desk {
    /// Starts the thread for the commands of `window`.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn open(
        window: Arc<Window>,
        control: Arc<Control>,
        mut starter: impl Starter + 'static,
    ) -> std::io::Result<Self> {
        let is_closing = Arc::new(AtomicBool::new(false));
        let thread = std::thread::Builder::new().name("desk".into()).spawn({
            let (window, is_closing) = (Arc::clone(&window), Arc::clone(&is_closing));
            move || serve(&window, &control, &mut starter, &is_closing)
        })?;
        Ok(Self { window, is_closing, thread: Some(thread) })
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        self.is_closing.store(true, Ordering::Release);
        self.window.commands().wake();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been reported already.
            let _ = thread.join();
        }
    }
}

fn serve(window: &Window, control: &Control, starter: &mut impl Starter, is_closing: &AtomicBool) {
    let mut shown = Instant::now();
    while !is_closing.load(Ordering::Acquire) {
        let tick = if window.has_pages() { TICK } else { LAZY_TICK };
        match window.commands().recv_timeout(tick.saturating_sub(shown.elapsed())) {
            Some(asked) => obey(asked, control, starter),
            None => {
                shown = Instant::now();
                control.ask(|wishes| wishes.is_show_due = true);
                starter.tick();
            }
        }
    }
}

fn obey(asked: Asked, control: &Control, starter: &mut impl Starter) {
    match asked.command.clone() {
        Command::Run {} => {
            control.ask(|wishes| (wishes.is_paused, wishes.steps) = (false, 0));
            asked.accept();
        }
        Command::Pause {} => {
            control.ask(|wishes| wishes.is_paused = true);
            asked.accept();
        }
        Command::Step {} => {
            let is_over = control.ask(|wishes| {
                if !wishes.is_over {
                    (wishes.is_paused, wishes.steps) = (true, wishes.steps + 1);
                }
                wishes.is_over
            });
            if is_over { asked.refuse(OVER) } else { asked.accept() }
        }
        Command::Speed { factor } if factor.is_none_or(|factor| SPEEDS.contains(&factor)) => {
            control.ask(|wishes| wishes.speed = factor);
            asked.accept();
        }
        Command::Speed { .. } => {
            let (least, most) = (SPEEDS.start(), SPEEDS.end());
            asked.refuse(format!("expected a factor from {least} to {most}, or none for as fast as possible"));
        }
        Command::Restart { seed } => starter.restart(seed, asked),
        Command::Act { action } => control.ask(|wishes| {
            if wishes.is_over {
                return asked.refuse(OVER);
            }
            wishes.actions.push((action_from_page(action), asked));
        }),
    }
}

/// Accepted speeds, in simulated seconds for each second of real time: slower, nothing seems to happen; faster, an idle run
/// would reach the end of simulated time within days.
pub const SPEEDS: RangeInclusive<f64> = 0.001..=10_000.0;

const OVER: &str = "the run is over: start it again";
