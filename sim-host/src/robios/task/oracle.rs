//! Reference model of the scheduler in steps of one millisecond, and a test that model and scheduler name the same
//! tasks at the same times.

use proptest::prelude::*;
use sim_core::time::Time;

use super::scheduler::{LEVELS, NextTask, Policy, Scheduler};

const TICK_MS: i64 = 10;

/// Maximum time for which the model searches for a task that continues.
const HORIZON_MS: i64 = 2_000;

/// The processor of one robot; every ready task has a ticket, and the lowest ticket among equal priorities is next.
struct ReferenceScheduler {
    permits: bool,
    can_permit: bool,
    tasks: Vec<Slot>,
    owner: Option<usize>,
    slice_end: i64,
    now: i64,
    tickets: i64,
}

struct Slot {
    priority: usize,
    is_suspended: bool,
    activity: Activity,
    ticket: Option<i64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Activity {
    Run,
    Busy(i64),
    Block(i64),
}

#[derive(Clone, Copy, Debug)]
enum Act {
    Compute,
    Wait(i64),
    Block(Option<i64>),
    Ready(usize),
    Suspend(usize),
    Wake(usize),
    Reschedule,
    Permit(bool),
}

impl ReferenceScheduler {
    fn new(policy: Policy, priorities: &[usize]) -> Self {
        let slot = |priority| Slot { priority, is_suspended: true, activity: Activity::Run, ticket: None };
        let mut tasks: Vec<Slot> = std::iter::once(0).chain(priorities.iter().copied()).map(slot).collect();
        tasks[0].is_suspended = false;
        Self {
            permits: policy == Policy::Preempt { is_permitted: true },
            can_permit: policy != Policy::Coop,
            tasks,
            owner: Some(0),
            slice_end: TICK_MS,
            now: 0,
            tickets: 0,
        }
    }

    fn queue(&mut self, task: usize, at_front: bool) {
        self.tickets += 1;
        self.tasks[task].ticket = Some(if at_front { -self.tickets } else { self.tickets });
    }

    fn dispatch(&mut self) {
        let all = self.tasks.iter().enumerate();
        let ready = all.filter_map(|(index, task)| Some((std::cmp::Reverse(task.priority), task.ticket?, index)));
        self.owner = ready.min().map(|(_, _, index)| index);
        if let Some(owner) = self.owner {
            self.tasks[owner].ticket = None;
        }
        self.slice_end = self.now / TICK_MS * TICK_MS + TICK_MS;
    }

    fn change(&mut self, task: usize, change: impl FnOnce(&mut Slot)) {
        let is_ready = |slot: &Slot| !slot.is_suspended && !matches!(slot.activity, Activity::Block(_));
        let before = is_ready(&self.tasks[task]);
        change(&mut self.tasks[task]);
        match (before, is_ready(&self.tasks[task])) {
            (false, true) => self.queue(task, false),
            (true, false) if self.owner == Some(task) => self.dispatch(),
            (true, false) => self.tasks[task].ticket = None,
            _ => {}
        }
    }

    /// Advances one millisecond; tasks whose sleep ends become ready.
    fn tick(&mut self) {
        self.now += 1;
        let now = self.now;
        for task in 0..self.tasks.len() {
            if matches!(self.tasks[task].activity, Activity::Block(wake) if wake <= now) {
                self.change(task, |slot| slot.activity = Activity::Run);
            }
        }
    }

    /// Makes the changes that may happen while no call is in progress.
    fn settle(&mut self) {
        let Some(owner) = self.owner else { return self.dispatch() };
        if self.now >= self.slice_end {
            let priority = self.tasks[owner].priority;
            if self.permits && self.tasks.iter().any(|task| task.ticket.is_some() && task.priority == priority) {
                self.queue(owner, false);
                let all = self.tasks.iter().enumerate().filter(|(_, task)| task.priority == priority);
                let next = all.filter_map(|(index, task)| Some((task.ticket?, index))).min().map(|(_, index)| index);
                self.owner = next;
                self.tasks[next.unwrap()].ticket = None;
            }
            self.slice_end = self.now / TICK_MS * TICK_MS + TICK_MS;
        }
        let owner = self.owner.unwrap();
        let priority = self.tasks[owner].priority;
        if self.permits && self.tasks.iter().any(|task| task.ticket.is_some() && task.priority > priority) {
            self.queue(owner, true);
            self.dispatch();
        }
    }

    /// Next task to continue, and its time; `None` if there is none within the horizon.
    fn next_task(&mut self) -> Option<(usize, i64)> {
        for _ in 0..HORIZON_MS {
            if let Some(owner) = self.owner
                && match self.tasks[owner].activity {
                    Activity::Busy(wake) => wake <= self.now,
                    _ => true,
                }
            {
                return Some((owner, self.now));
            }
            self.tick();
            self.settle();
        }
        None
    }

    fn act(&mut self, me: usize, cost_ms: i64, act: Act) {
        self.tasks[me].activity = Activity::Run;
        (0..cost_ms).for_each(|_| self.tick());
        match act {
            Act::Compute => {}
            Act::Wait(ms) => self.tasks[me].activity = Activity::Busy(self.now + ms),
            Act::Block(ms) => {
                let wake = ms.map_or(i64::MAX, |ms| self.now + ms);
                self.change(me, |slot| slot.activity = Activity::Block(wake));
            }
            Act::Ready(task) => self.change(task, |slot| slot.is_suspended = false),
            Act::Suspend(task) => self.change(task, |slot| slot.is_suspended = true),
            Act::Wake(task) => self.change(task, |slot| slot.activity = Activity::Run),
            Act::Reschedule => {
                if let Some(owner) = self.owner {
                    self.queue(owner, false);
                }
                self.dispatch();
            }
            Act::Permit(is_to_be) => self.permits = is_to_be && self.can_permit,
        }
        self.settle();
    }
}

fn time(ms: i64) -> Time {
    if ms == i64::MAX { Time::NEVER } else { Time::from_millis(ms) }
}

fn act(scheduler: &mut Scheduler, me: u32, now: i64, act: Act) {
    let number = |task: usize| task as u32;
    scheduler.run(me);
    scheduler.reach(time(now));
    match act {
        Act::Compute => {}
        Act::Wait(ms) => scheduler.wait(me, time(now + ms)),
        Act::Block(ms) => scheduler.block(me, ms.map_or(Time::NEVER, |ms| time(now + ms))),
        Act::Ready(task) => scheduler.ready(number(task)),
        Act::Suspend(task) => scheduler.suspend(number(task)),
        Act::Wake(task) => scheduler.run(number(task)),
        Act::Reschedule => scheduler.reschedule(),
        Act::Permit(is_to_be) => scheduler.permit(is_to_be),
    }
    scheduler.advance(time(now));
}

fn acts(tasks: usize) -> impl Strategy<Value = Act> {
    prop_oneof![
        2 => Just(Act::Compute),
        4 => (1..200i64).prop_map(Act::Wait),
        2 => (1..60i64).prop_map(|ms| Act::Block(Some(ms))),
        1 => Just(Act::Block(None)),
        4 => (0..tasks).prop_map(Act::Ready),
        1 => (0..tasks).prop_map(Act::Suspend),
        2 => (0..tasks).prop_map(Act::Wake),
        1 => Just(Act::Reschedule),
        1 => any::<bool>().prop_map(Act::Permit),
    ]
}

const TASKS: usize = 7;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn the_same_tasks_go_on_at_the_same_times(
        is_preemptive in any::<bool>(),
        priorities in proptest::collection::vec(1..4usize, TASKS - 1),
        calls in proptest::collection::vec((acts(TASKS), 1..25i64, 0..3i64), 1..80),
    ) {
        let policy = if is_preemptive { Policy::Preempt { is_permitted: true } } else { Policy::Coop };
        let mut reference = ReferenceScheduler::new(policy, &priorities);
        let mut scheduler = Scheduler::new(policy, 0, 0, Time::ZERO);
        for (index, priority) in priorities.iter().enumerate() {
            prop_assert!(*priority < LEVELS);
            scheduler.add(index as u32 + 1, *priority);
        }
        for (call, cost_ms, parts) in calls {
            let from = reference.now;
            let expected = reference.next_task();
            // Time may pass in parts, as when scheduler steps intervene.
            for part in 1..=parts {
                let to = expected.map_or(HORIZON_MS / 2, |(_, at)| at - from) * part / (parts + 1);
                if to > 0 {
                    scheduler.advance(time(from + to));
                }
            }
            let found = loop {
                match scheduler.next() {
                    NextTask::Run(task) => break Some(task),
                    NextTask::NotBefore(at) if at > time(from + HORIZON_MS) => break None,
                    NextTask::NotBefore(at) => {
                        prop_assert!(expected.is_none_or(|(_, due)| at <= time(due)), "not later than somebody goes on");
                        scheduler.advance(at);
                    }
                }
            };
            prop_assert_eq!(found, expected.map(|(task, _)| task as u32));
            let Some((me, at)) = expected else { return Ok(()) };
            reference.act(me, cost_ms, call);
            act(&mut scheduler, me as u32, at + cost_ms, call);
        }
    }
}
