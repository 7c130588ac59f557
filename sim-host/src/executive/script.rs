//! A run in which a hand does again what it did in another one.

use std::collections::VecDeque;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::record::Action;
use sim_core::time::Time;

use super::conductor::End;
use super::gate::{Boundary, Gate, Intervention, Pass};
use super::intervene::Refusal;
use super::pace::Pace;

/// Actions with the times at which they happen.
#[derive(Default)]
pub struct Script {
    /// In order of time.
    actions: VecDeque<(Time, Action)>,
    /// The user interrupted the run there.
    interrupted: Option<Time>,
    pace: Option<Pace>,
    refused: Arc<Refused>,
}

/// What was refused of a script.
pub type Refused = Mutex<Vec<(Time, Refusal)>>;

impl Script {
    /// These actions, each at its time: at the start of the slot that contains it.
    pub fn new(actions: impl IntoIterator<Item = (Time, Action)>) -> Self {
        let mut actions: Vec<_> = actions.into_iter().collect();
        actions.sort_by_key(|(at, _)| *at);
        Self { actions: actions.into(), ..Self::default() }
    }

    /// This script of a run that the user interrupted at the start of the slot at `end`.
    pub fn interrupted(self, end: Time) -> Self {
        Self { interrupted: Some(end), ..self }
    }

    /// This script at this pace.
    pub fn paced(self, pace: Option<Pace>) -> Self {
        Self { pace, ..self }
    }

    /// What is refused while the run goes on: it is another run than the one that the script was recorded in.
    pub fn refused(&self) -> Arc<Refused> {
        Arc::clone(&self.refused)
    }

    /// The actions that happen before the next slot in which anything happens without them.
    fn due(&mut self, boundary: &Boundary<'_>) -> Option<(Time, Vec<Intervention>)> {
        let slot = boundary.world.slot();
        let start = |at: Time| at.floor_to(slot).max(boundary.following);
        let (first, _) = self.actions.front()?;
        let at = start(*first);
        if boundary.next.is_some_and(|next| at > next) {
            return None;
        }
        let mut due = Vec::new();
        while let Some((time, action)) = self.actions.pop_front_if(|(other, _)| start(*other) == at) {
            let refused = Arc::clone(&self.refused);
            let answer = Box::new(move |outcome: Result<(), Refusal>| {
                refused.lock().extend(outcome.err().map(|refusal| (time, refusal)));
            });
            due.push(Intervention { action, answer });
        }
        Some((at, due))
    }
}

impl Gate for Script {
    fn wait(&mut self, boundary: &Boundary<'_>) -> Pass {
        if let Some((at, actions)) = self.due(boundary) {
            let is_over = self.pace.as_mut().is_some_and(|pace| !pace.wait_until(at.min(boundary.until)));
            return if is_over { Pass::End(End::Interrupted) } else { Pass::Act { at, actions } };
        }
        if self.interrupted.is_some_and(|end| boundary.following >= end) {
            return Pass::End(End::Interrupted);
        }
        match &mut self.pace {
            Some(pace) => pace.wait(boundary),
            None => Pass::Begin,
        }
    }
}
