//! Reference model of the scheduler in steps of one millisecond, and a test that model and scheduler run the same
//! tasks at the same times.

use proptest::prelude::*;
use sim_core::time::Time;

use super::scheduler::{LEVELS, NextTask, Policy, Scheduler};

const TICK_MS: i64 = 10;

/// Maximum time for which the model searches for a task that continues.
const HORIZON_MS: i64 = 2_000;

/// The processor of one robot. Every ready task without the processor has a ticket; among equal priorities, the lowest
/// ticket is next.
struct ReferenceScheduler {
    is_preemption_permitted: bool,
    is_preemptive_policy: bool,
    tasks: Vec<TaskState>,
    owner: Option<usize>,
    slice_end: i64,
    now: i64,
    last_ticket: i64,
}

struct TaskState {
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
enum Action {
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
        let state = |priority| TaskState { priority, is_suspended: true, activity: Activity::Run, ticket: None };
        let mut tasks: Vec<TaskState> = std::iter::once(0).chain(priorities.iter().copied()).map(state).collect();
        tasks[0].is_suspended = false;
        Self {
            is_preemption_permitted: policy == Policy::Preempt { is_permitted: true },
            is_preemptive_policy: policy != Policy::Coop,
            tasks,
            owner: Some(0),
            slice_end: TICK_MS,
            now: 0,
            last_ticket: 0,
        }
    }

    fn enqueue(&mut self, task: usize, at_front: bool) {
        self.last_ticket += 1;
        self.tasks[task].ticket = Some(if at_front { -self.last_ticket } else { self.last_ticket });
    }

    fn dispatch(&mut self) {
        let numbered = self.tasks.iter().enumerate();
        let ready = numbered.filter_map(|(index, task)| Some((std::cmp::Reverse(task.priority), task.ticket?, index)));
        self.owner = ready.min().map(|(_, _, index)| index);
        if let Some(owner) = self.owner {
            self.tasks[owner].ticket = None;
        }
        self.slice_end = self.now / TICK_MS * TICK_MS + TICK_MS;
    }

    fn change(&mut self, task: usize, change: impl FnOnce(&mut TaskState)) {
        let is_ready = |state: &TaskState| !state.is_suspended && !matches!(state.activity, Activity::Block(_));
        let was_ready = is_ready(&self.tasks[task]);
        change(&mut self.tasks[task]);
        match (was_ready, is_ready(&self.tasks[task])) {
            (false, true) => self.enqueue(task, false),
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
                self.change(task, |state| state.activity = Activity::Run);
            }
        }
    }

    /// Switches tasks if necessary, while no call is in progress.
    fn settle(&mut self) {
        let Some(owner) = self.owner else { return self.dispatch() };
        if self.now >= self.slice_end {
            let priority = self.tasks[owner].priority;
            if self.is_preemption_permitted
                && self.tasks.iter().any(|task| task.ticket.is_some() && task.priority == priority)
            {
                self.enqueue(owner, false);
                let peers = self.tasks.iter().enumerate().filter(|(_, task)| task.priority == priority);
                let next = peers.filter_map(|(index, task)| Some((task.ticket?, index))).min().map(|(_, index)| index);
                self.owner = next;
                self.tasks[next.unwrap()].ticket = None;
            }
            self.slice_end = self.now / TICK_MS * TICK_MS + TICK_MS;
        }
        let owner = self.owner.unwrap();
        let priority = self.tasks[owner].priority;
        if self.is_preemption_permitted
            && self.tasks.iter().any(|task| task.ticket.is_some() && task.priority > priority)
        {
            self.enqueue(owner, true);
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

    fn apply(&mut self, task_index: usize, cost_ms: i64, action: Action) {
        self.tasks[task_index].activity = Activity::Run;
        (0..cost_ms).for_each(|_| self.tick());
        match action {
            Action::Compute => {}
            Action::Wait(ms) => self.tasks[task_index].activity = Activity::Busy(self.now + ms),
            Action::Block(ms) => {
                let wake = ms.map_or(i64::MAX, |ms| self.now + ms);
                self.change(task_index, |state| state.activity = Activity::Block(wake));
            }
            Action::Ready(task) => self.change(task, |state| state.is_suspended = false),
            Action::Suspend(task) => self.change(task, |state| state.is_suspended = true),
            Action::Wake(task) => self.change(task, |state| state.activity = Activity::Run),
            Action::Reschedule => {
                if let Some(owner) = self.owner {
                    self.enqueue(owner, false);
                }
                self.dispatch();
            }
            Action::Permit(is_permitted) => self.is_preemption_permitted = is_permitted && self.is_preemptive_policy,
        }
        self.settle();
    }
}

fn time(ms: i64) -> Time {
    if ms == i64::MAX { Time::NEVER } else { Time::from_millis(ms) }
}

fn apply(scheduler: &mut Scheduler, task_index: u32, now: i64, action: Action) {
    let number = |task: usize| task as u32;
    scheduler.resume(task_index);
    scheduler.advance_in_call(time(now));
    match action {
        Action::Compute => {}
        Action::Wait(ms) => scheduler.wait(task_index, time(now + ms)),
        Action::Block(ms) => scheduler.block(task_index, ms.map_or(Time::NEVER, |ms| time(now + ms))),
        Action::Ready(task) => scheduler.make_ready(number(task)),
        Action::Suspend(task) => scheduler.suspend(number(task)),
        Action::Wake(task) => scheduler.resume(number(task)),
        Action::Reschedule => scheduler.reschedule(),
        Action::Permit(is_permitted) => scheduler.set_preemption(is_permitted),
    }
    scheduler.advance(time(now));
}

fn actions(tasks: usize) -> impl Strategy<Value = Action> {
    prop_oneof![
        2 => Just(Action::Compute),
        4 => (1..200i64).prop_map(Action::Wait),
        2 => (1..60i64).prop_map(|ms| Action::Block(Some(ms))),
        1 => Just(Action::Block(None)),
        4 => (0..tasks).prop_map(Action::Ready),
        1 => (0..tasks).prop_map(Action::Suspend),
        2 => (0..tasks).prop_map(Action::Wake),
        1 => Just(Action::Reschedule),
        1 => any::<bool>().prop_map(Action::Permit),
    ]
}

const TASKS: usize = 7;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn model_and_scheduler_run_the_same_tasks_at_the_same_times(
        is_preemptive in any::<bool>(),
        priorities in proptest::collection::vec(1..4usize, TASKS - 1),
        calls in proptest::collection::vec((actions(TASKS), 1..25i64, 0..3i64), 1..80),
    ) {
        let policy = if is_preemptive { Policy::Preempt { is_permitted: true } } else { Policy::Coop };
        let mut reference = ReferenceScheduler::new(policy, &priorities);
        let mut scheduler = Scheduler::new(policy, 0, 0, Time::ZERO);
        for (index, priority) in priorities.iter().enumerate() {
            prop_assert!(*priority < LEVELS);
            scheduler.add(index as u32 + 1, *priority);
        }
        for (call, cost_ms, parts) in calls {
            let start = reference.now;
            let expected = reference.next_task();
            // Time may pass in parts, as when scheduler steps intervene.
            for part in 1..=parts {
                let to = expected.map_or(HORIZON_MS / 2, |(_, at)| at - start) * part / (parts + 1);
                if to > 0 {
                    scheduler.advance(time(start + to));
                }
            }
            let found = loop {
                match scheduler.next() {
                    NextTask::Run(task) => break Some(task),
                    NextTask::NotBefore(at) if at > time(start + HORIZON_MS) => break None,
                    NextTask::NotBefore(at) => {
                        prop_assert!(expected.is_none_or(|(_, due)| at <= time(due)), "not later than somebody goes on");
                        scheduler.advance(at);
                    }
                }
            };
            prop_assert_eq!(found, expected.map(|(task, _)| task as u32));
            let Some((task_index, at)) = expected else { return Ok(()) };
            reference.apply(task_index, cost_ms, call);
            apply(&mut scheduler, task_index as u32, at + cost_ms, call);
        }
    }
}
