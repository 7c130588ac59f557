//! What pages have asked of a run, on its way from the desk to who advances the run.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use parking_lot::{Condvar, Mutex, MutexGuard};
use sim_core::record::Action;
use sim_view::window::Asked;

/// The way from those who ask to who advances the run, who looks at it between two slots.
#[derive(Default)]
pub struct Control {
    is_stirred: AtomicBool,
    wishes: Mutex<Wishes>,
    stirred: Condvar,
}

/// What is asked of a run.
#[derive(Default)]
pub struct Wishes {
    /// It is to stop before the next slot.
    pub is_paused: bool,
    /// So many slots are to be run while it is paused.
    pub steps: u32,
    /// Simulated seconds for each second of real time; none for as fast as possible.
    pub speed: Option<f64>,
    /// What is to be done to it, in order, and who is told what becomes of it.
    pub actions: Vec<(Action, Asked)>,
    /// Pages are to be shown how it stands.
    pub is_show_due: bool,
    /// It is to end, since another one begins.
    pub is_ending: bool,
    /// It is over, or has not begun: nothing can be done to it.
    pub is_over: bool,
}

impl Control {
    /// Asks for something.
    pub fn ask<T>(&self, wish: impl FnOnce(&mut Wishes) -> T) -> T {
        let answer = wish(&mut self.wishes.lock());
        self.is_stirred.store(true, Ordering::Release);
        self.stirred.notify_all();
        answer
    }

    /// True once something was asked since the last [`Self::wishes`].
    fn is_stirred(&self) -> bool {
        self.is_stirred.load(Ordering::Acquire)
    }

    /// What was asked for.
    pub fn wishes(&self) -> MutexGuard<'_, Wishes> {
        self.is_stirred.store(false, Ordering::Release);
        self.wishes.lock()
    }

    /// Waits until something is asked for, or for this long.
    pub fn wait(&self, time: Duration) {
        let mut wishes = self.wishes.lock();
        if !self.is_stirred() {
            self.stirred.wait_for(&mut wishes, time);
        }
    }
}
