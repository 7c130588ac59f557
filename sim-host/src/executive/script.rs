//! Advances a run to its end at a given pace and replays its recorded interventions.

use std::collections::VecDeque;
use std::time::Duration;

use sim_core::record::Action;
use sim_core::time::Time;

use super::dispatcher::Boundary;
use super::intervene::Refusal;
use super::pace::Pace;
use super::scheduler::{Progress, Scheduler};

/// Timed interventions and the pace of a run; by default no interventions, and as fast as possible.
#[derive(Default)]
pub struct Script {
    /// Actions in order of time.
    actions: VecDeque<(Time, Action)>,
    /// Time at which the user interrupted the recorded run.
    interrupt_at: Option<Time>,
    pace: Option<Pace>,
    refused: Vec<(Time, Refusal)>,
}

impl Script {
    /// Creates a script of these actions; each is carried out at the start of the slot that contains its time. Faults
    /// are omitted: they belong to the scene and recur on their own.
    pub fn new(actions: impl IntoIterator<Item = (Time, Action)>) -> Self {
        let is_user_action = |(_, action): &(Time, Action)| !matches!(action, Action::Fault { .. });
        let mut actions: Vec<_> = actions.into_iter().filter(is_user_action).collect();
        actions.sort_by_key(|(at, _)| *at);
        Self { actions: actions.into(), ..Self::default() }
    }

    /// Interrupts the run at the first start of a slot that is not before `time`, as the user did in the recorded run.
    pub fn interrupt_at(self, time: Time) -> Self {
        Self { interrupt_at: Some(time), ..self }
    }

    /// Sets the pace; `None` for as fast as possible.
    pub fn paced(self, pace: Option<Pace>) -> Self {
        Self { pace, ..self }
    }

    /// Actions that this run has refused so far. If there are any, the run has diverged from the recorded one.
    pub fn refused(&self) -> &[(Time, Refusal)] {
        &self.refused
    }

    /// Advances the run to its next actions or, with a pace, to its next slot; returns earlier once little more than
    /// `budget` of wall-clock time has passed. Returns [`Progress::Over`] once nothing is left to do.
    pub fn advance(&mut self, scheduler: &mut Scheduler, budget: Duration) -> Progress {
        let boundary = scheduler.boundary();
        let start = self.actions.front().map(|(at, _)| slot_start(*at, &boundary));
        if let Some(at) = start.filter(|at| boundary.next.is_none_or(|next| *at <= next)) {
            return self.act(at, scheduler, &boundary);
        }
        if self.interrupt_at.is_some_and(|time| boundary.following >= time) {
            return interrupt(scheduler);
        }
        let Some(next) = boundary.next_within_limit() else { return Progress::Over };
        let after_next = next + Time(1);
        let horizon = if let Some(pace) = &mut self.pace {
            if !pace.wait_until(next, scheduler.run().interrupt()) {
                return interrupt(scheduler);
            }
            after_next
        } else {
            start.unwrap_or(Time::NEVER).min(self.interrupt_at.unwrap_or(Time::NEVER)).max(after_next)
        };
        scheduler.advance_within(horizon, budget)
    }

    /// Carries out the actions of the slot at `at`.
    fn act(&mut self, at: Time, scheduler: &mut Scheduler, boundary: &Boundary) -> Progress {
        if self.pace.as_mut().is_some_and(|pace| !pace.wait_until(at.min(boundary.limit), scheduler.run().interrupt()))
        {
            return interrupt(scheduler);
        }
        while let Some((time, action)) = self.actions.pop_front_if(|(time, _)| slot_start(*time, boundary) == at) {
            self.refused.extend(scheduler.act(at, &action).err().map(|refusal| (time, refusal)));
        }
        if scheduler.is_ending() { Progress::Over } else { Progress::Paused }
    }
}

/// Start of the slot that contains `at`, but not before `boundary.following`, the first slot that has not begun.
fn slot_start(at: Time, boundary: &Boundary) -> Time {
    at.floor_to(boundary.slot).max(boundary.following)
}

/// Interrupts the run, which is then over.
fn interrupt(scheduler: &mut Scheduler) -> Progress {
    scheduler.interrupt();
    Progress::Over
}
