//! Scheduler of RoBIOS 6: a state machine, driven only by virtual time, that determines which of a robot's tasks has
//! the processor.
//!
//! Priorities are strict; tasks of equal priority take turns (round robin), in order of readiness. A task that waits
//! for the world (a busy wait) keeps its fraction of the processor. A task that sleeps, waits for another task or is
//! suspended has none. Time slices end at the ticks of the global 10 ms grid.
//!
//! The transfer of control between tasks is not part of this model. It computes turns of tasks in busy waits in closed
//! form, and [`Scheduler::next`] names only tasks that have something to do.

use std::collections::VecDeque;

use sim_core::time::{TICK, Time};

/// Number of priorities, from `IDLE_PRI`, the priority of `main`, to `MAX_PRI`.
pub const LEVELS: usize = 9;

/// Rule for task switches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Only when the running task yields.
    Coop,
    /// Also when its time slice is over or a task of higher priority is ready, unless preemption is forbidden.
    Preempt {
        /// False from `OSForbid` to `OSPermit`.
        is_permitted: bool,
    },
}

/// Next task to continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextTask {
    /// This task, now.
    Run(u32),
    /// No task can continue before this time; [`Time::NEVER`] if none ever can.
    NotBefore(Time),
}

/// The processor of one robot and the tasks that share it.
#[derive(Clone, Debug)]
pub struct Scheduler {
    policy: Policy,
    /// All tasks, in order of their numbers.
    entries: Vec<TaskEntry>,
    /// Ready tasks without the processor, by priority; first come, first served.
    queues: [VecDeque<u32>; LEVELS],
    /// Task that has the processor; `None` if none is ready.
    owner: Option<u32>,
    slice_end: Time,
    now: Time,
}

#[derive(Clone, Debug)]
struct TaskEntry {
    number: u32,
    priority: usize,
    is_suspended: bool,
    activity: Activity,
}

/// Use of the processor by a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Activity {
    /// Computes.
    Run,
    /// Waits for the world, until this time.
    Busy(Time),
    /// Leaves the processor to the other tasks until this time, or until it is woken.
    Block(Time),
}

impl Scheduler {
    /// The processor from `now` on, with one task that owns it.
    pub fn new(policy: Policy, main: u32, priority: usize, now: Time) -> Self {
        let main_entry = TaskEntry { number: main, priority, is_suspended: false, activity: Activity::Run };
        Self {
            policy,
            entries: vec![main_entry],
            queues: Default::default(),
            owner: Some(main),
            slice_end: slice_end(now),
            now,
        }
    }

    /// Rule for task switches.
    pub fn policy(&self) -> Policy {
        self.policy
    }

    /// Forbids or permits preemption; no effect under [`Policy::Coop`].
    pub fn set_preemption(&mut self, is_now_permitted: bool) {
        if let Policy::Preempt { is_permitted } = &mut self.policy {
            *is_permitted = is_now_permitted;
        }
    }

    /// Adds a suspended task; its number must be higher than all previous numbers.
    pub fn add(&mut self, number: u32, priority: usize) {
        self.entries.push(TaskEntry {
            number,
            priority: priority.min(LEVELS - 1),
            is_suspended: true,
            activity: Activity::Run,
        });
    }

    /// Priority of a task; the priority of `main` if there is no such task.
    pub fn priority(&self, number: u32) -> usize {
        self.index(number).map_or(0, |index| self.entries[index].priority)
    }

    /// Returns true if the task is ready to run, or has the processor.
    pub fn is_ready(&self, number: u32) -> bool {
        self.index(number).is_some_and(|index| self.entries[index].is_ready())
    }

    /// Returns true if the task is suspended.
    pub fn is_suspended(&self, number: u32) -> bool {
        self.index(number).is_some_and(|index| self.entries[index].is_suspended)
    }

    /// Ends a task's suspension: it becomes the last task of its priority, unless it is still blocked.
    pub fn make_ready(&mut self, number: u32) {
        self.change(number, |entry| entry.is_suspended = false);
    }

    /// Suspends a task.
    pub fn suspend(&mut self, number: u32) {
        self.change(number, |entry| entry.is_suspended = true);
    }

    /// Ends a task's wait: it computes from now on.
    pub fn resume(&mut self, number: u32) {
        self.change(number, |entry| entry.activity = Activity::Run);
    }

    /// Puts a task into a busy wait for the world until `wake`.
    pub fn wait(&mut self, number: u32, wake: Time) {
        self.change(number, |entry| entry.activity = Activity::Busy(wake));
    }

    /// Blocks a task until `wake`: it leaves the processor to others.
    pub fn block(&mut self, number: u32, wake: Time) {
        self.change(number, |entry| entry.activity = Activity::Block(wake));
    }

    /// Brings the end of a task's busy wait forward to `wake`, if that is earlier.
    pub fn advance_wake(&mut self, number: u32, wake: Time) {
        if let Some(index) = self.index(number)
            && let Activity::Busy(at) = &mut self.entries[index].activity
        {
            *at = (*at).min(wake);
        }
    }

    /// Sets the end of a task's busy wait to `wake`.
    pub fn reset_wake(&mut self, number: u32, wake: Time) {
        if let Some(index) = self.index(number)
            && let Activity::Busy(at) = &mut self.entries[index].activity
        {
            *at = wake;
        }
    }

    /// Removes a task that has ended.
    pub fn remove(&mut self, number: u32) {
        self.suspend(number);
        self.entries.retain(|entry| entry.number != number);
    }

    /// Makes the owner of the processor yield: the next task of the highest priority gets it, possibly the same one.
    pub fn reschedule(&mut self) {
        if let Some(owner) = self.owner.take() {
            self.queue_of(owner).push_back(owner);
        }
        self.dispatch();
    }

    /// Assigns the processor to a task out of turn, for work that must precede all other work.
    pub fn run_out_of_turn(&mut self, number: u32) {
        if self.owner == Some(number) {
            return;
        }
        if let Some(owner) = self.owner.take() {
            self.queue_of(owner).push_front(owner);
        }
        self.change(number, |entry| (entry.is_suspended, entry.activity) = (false, Activity::Run));
        self.queues.iter_mut().for_each(|queue| queue.retain(|other| *other != number));
        self.owner = Some(number);
    }

    /// Advances to virtual time `now` within a call, whose task keeps the processor until the call's end.
    pub fn advance_in_call(&mut self, now: Time) {
        self.wake_sleepers(now);
        self.now = self.now.max(now);
    }

    /// Advances to virtual time `to` while no call is in progress.
    pub fn advance(&mut self, to: Time) {
        // A call has used up the slice: other tasks get their turn only now, at the call's end.
        if self.now >= self.slice_end {
            self.end_slice();
        }
        self.settle();
        loop {
            match self.next() {
                NextTask::NotBefore(time) if time <= to => self.pass_idle(time),
                NextTask::NotBefore(_) => return self.pass_idle(to),
                NextTask::Run(_) => return self.pass_within_call(to),
            }
        }
    }

    /// Next task to continue in the current state.
    pub fn next(&self) -> NextTask {
        let Some(owner) = self.owner.and_then(|number| self.index(number)).map(|index| &self.entries[index]) else {
            return NextTask::NotBefore(self.earliest_ready(0));
        };
        let wake = match owner.activity {
            Activity::Busy(wake) if wake > self.now => wake,
            _ => return NextTask::Run(owner.number),
        };
        if !self.is_permitted() {
            return NextTask::NotBefore(wake);
        }
        let peers = &self.queues[owner.priority];
        let first = if peers.is_empty() { wake } else { self.earliest_turn(wake, peers) };
        NextTask::NotBefore(first.min(self.earliest_ready(owner.priority)))
    }

    /// Earliest time at which one of the tasks that take turns has something to do in its own slice.
    fn earliest_turn(&self, owner_wake: Time, peers: &VecDeque<u32>) -> Time {
        let round = Time(TICK.0 * (peers.len() as i64 + 1));
        let own_turn = |task_index: usize, wake: Time| {
            let end = self.slice_end + Time(TICK.0 * task_index as i64);
            if wake == Time::NEVER {
                return Time::NEVER;
            }
            let rounds = if wake < end { 0 } else { (wake - end).0 / round.0 + 1 };
            let end = end + Time(round.0 * rounds);
            wake.max(if task_index == 0 && rounds == 0 { self.now } else { end - TICK })
        };
        let peer_turns = peers.iter().enumerate().map(|(task_index, number)| {
            let activity = self.index(*number).map(|index| self.entries[index].activity);
            own_turn(task_index + 1, if let Some(Activity::Busy(wake)) = activity { wake } else { Time::ZERO })
        });
        peer_turns.fold(own_turn(0, owner_wake), Time::min)
    }

    /// Earliest time at which a task of at least this priority becomes ready by itself.
    fn earliest_ready(&self, priority: usize) -> Time {
        let wakes = self.entries.iter().filter(|entry| entry.priority >= priority).map(TaskEntry::ready_at);
        wakes.min().unwrap_or(Time::NEVER)
    }

    /// Lets time pass until `to` while no task has anything to do: the tasks in a busy wait take turns.
    fn pass_idle(&mut self, to: Time) {
        let last_instant = Time(to.0 - 1).max(self.now);
        if last_instant >= self.slice_end {
            let ticks = (last_instant - self.slice_end).0 / TICK.0 + 1;
            self.rotate(ticks);
            self.slice_end += Time(TICK.0 * ticks);
        }
        self.advance_in_call(to);
        if to >= self.slice_end {
            self.end_slice();
        }
        self.settle();
    }

    /// Lets time pass until `to` within one call, or in a timer callback: no task switch happens before its end.
    fn pass_within_call(&mut self, to: Time) {
        self.advance_in_call(to);
        if to >= self.slice_end {
            self.end_slice();
        }
        self.settle();
    }

    fn end_slice(&mut self) {
        self.rotate(1);
        self.slice_end = slice_end(self.now);
    }

    /// Makes the tasks whose sleep ends by `to` ready, in order of their wake times.
    fn wake_sleepers(&mut self, to: Time) {
        let mut woken: Vec<(Time, u32)> = Vec::new();
        for entry in &mut self.entries {
            if let Activity::Block(wake) = entry.activity
                && wake <= to
            {
                entry.activity = Activity::Run;
                woken.push((wake, entry.number));
            }
        }
        woken.sort_unstable();
        for (_, number) in woken {
            if self.is_ready(number) {
                self.queue_of(number).push_back(number);
            }
        }
    }

    /// Passes the processor on `slices` times among the tasks of the owner's priority.
    fn rotate(&mut self, slices: i64) {
        let Some(owner) = self.owner.filter(|_| self.is_permitted()) else { return };
        let queue = self.queue_of(owner);
        let count = queue.len() as i64 + 1;
        queue.push_front(owner);
        queue.rotate_left((slices % count) as usize);
        self.owner = queue.pop_front();
    }

    /// Assigns a free processor if any task is ready; preempts the owner for a task of higher priority, if permitted.
    fn settle(&mut self) {
        match self.owner {
            None => self.dispatch(),
            Some(owner) if self.is_permitted() => {
                let priority = self.priority(owner);
                if self.queues[priority + 1..].iter().any(|queue| !queue.is_empty()) {
                    self.queue_of(owner).push_front(owner);
                    self.dispatch();
                }
            }
            Some(_) => {}
        }
    }

    fn dispatch(&mut self) {
        self.owner = self.queues.iter_mut().rev().find_map(VecDeque::pop_front);
        self.slice_end = slice_end(self.now);
    }

    fn is_permitted(&self) -> bool {
        self.policy == Policy::Preempt { is_permitted: true }
    }

    /// Changes the state of a task, and updates owner and queues if its readiness changes.
    fn change(&mut self, number: u32, change: impl FnOnce(&mut TaskEntry)) {
        let Some(index) = self.index(number) else { return };
        let entry = &mut self.entries[index];
        let was_ready = entry.is_ready();
        change(entry);
        match (was_ready, entry.is_ready()) {
            (false, true) => self.queue_of(number).push_back(number),
            (true, false) => {
                self.queue_of(number).retain(|other| *other != number);
                if self.owner == Some(number) {
                    self.dispatch();
                }
            }
            _ => {}
        }
    }

    fn queue_of(&mut self, number: u32) -> &mut VecDeque<u32> {
        let priority = self.priority(number);
        &mut self.queues[priority]
    }

    fn index(&self, number: u32) -> Option<usize> {
        self.entries.binary_search_by_key(&number, |entry| entry.number).ok()
    }
}

impl TaskEntry {
    fn is_ready(&self) -> bool {
        !self.is_suspended && !matches!(self.activity, Activity::Block(_))
    }

    /// Time at which the task becomes ready by itself.
    fn ready_at(&self) -> Time {
        match self.activity {
            Activity::Block(wake) if !self.is_suspended => wake,
            _ => Time::NEVER,
        }
    }
}

/// End of a slice that begins at `now`.
fn slice_end(now: Time) -> Time {
    now.floor_to(TICK) + TICK
}

#[cfg(test)]
mod tests {
    use super::*;

    const PREEMPTIVE: Policy = Policy::Preempt { is_permitted: true };

    /// A processor with tasks 2, 3, ... of these priorities, all ready; `main` (1) sleeps for ever.
    fn processor(policy: Policy, priorities: &[usize]) -> Scheduler {
        let mut scheduler = Scheduler::new(policy, 1, 0, Time::ZERO);
        for (number, priority) in (2..).zip(priorities) {
            scheduler.add(number, *priority);
            scheduler.make_ready(number);
        }
        scheduler.block(1, Time::NEVER);
        scheduler.advance(Time::ZERO);
        scheduler
    }

    #[test]
    fn equal_priorities_take_turns_at_ticks_and_lower_priorities_starve() {
        let mut scheduler = processor(PREEMPTIVE, &[3, 3, 2]);
        let mut turns = Vec::new();
        for ms in 1..=60 {
            scheduler.advance(Time::from_millis(ms));
            if let NextTask::Run(task) = scheduler.next()
                && turns.last() != Some(&task)
            {
                turns.push(task);
            }
        }
        assert_eq!(turns, [2, 3, 2, 3, 2, 3, 2]);
    }

    #[test]
    fn turns_in_busy_waits_are_computed_in_closed_form() {
        let mut scheduler = processor(PREEMPTIVE, &[3, 3, 3]);
        for (task, wake_s, slice_end_ms) in [(2, 1_000_000, 10), (3, 2_000_000, 20), (4, 3_000_000, 20)] {
            assert_eq!(scheduler.next(), NextTask::Run(task));
            scheduler.wait(task, Time::from_millis(1000 * wake_s));
            scheduler.advance(Time::from_millis(slice_end_ms));
        }
        // Slices of task 2 begin at 0, 30, 60 ms and so on: its slice of 1e9 ms began at 999,999,990 ms and ends then.
        assert_eq!(scheduler.next(), NextTask::NotBefore(Time::from_millis(1_000_000_020)));
        scheduler.advance(Time::from_millis(1_000_000_020));
        assert_eq!(scheduler.next(), NextTask::Run(2));
    }

    #[test]
    fn no_task_continues_if_all_wait_for_ever() {
        let mut scheduler = processor(PREEMPTIVE, &[3, 3]);
        scheduler.wait(2, Time::NEVER);
        scheduler.advance(Time::from_millis(10));
        scheduler.wait(3, Time::NEVER);
        assert_eq!(scheduler.next(), NextTask::NotBefore(Time::NEVER));
        scheduler.advance(Time::from_millis(1_000_000_000));
        assert_eq!(scheduler.next(), NextTask::NotBefore(Time::NEVER));
        scheduler.block(2, Time::NEVER);
        scheduler.block(3, Time::NEVER);
        assert_eq!(scheduler.next(), NextTask::NotBefore(Time::NEVER));
    }

    #[test]
    fn cooperative_tasks_keep_the_processor() {
        for policy in [Policy::Coop, Policy::Preempt { is_permitted: false }] {
            let mut scheduler = processor(policy, &[1, 8]);
            assert_eq!(scheduler.next(), NextTask::Run(3), "main gave way to the highest");
            scheduler.wait(3, Time::from_millis(95));
            assert_eq!(scheduler.next(), NextTask::NotBefore(Time::from_millis(95)));
            scheduler.advance(Time::from_millis(95));
            scheduler.resume(3);
            scheduler.reschedule();
            assert_eq!(scheduler.next(), NextTask::Run(3), "a lower one does not get it");
            scheduler.block(3, Time::from_millis(100));
            assert_eq!(scheduler.next(), NextTask::Run(2));
            scheduler.advance(Time::from_millis(200));
            assert_eq!(scheduler.next(), NextTask::Run(2), "not even when a higher one is ready");
            scheduler.set_preemption(true);
            scheduler.advance(Time::from_millis(200));
            assert_eq!(scheduler.next(), NextTask::Run(if policy == Policy::Coop { 2 } else { 3 }));
        }
    }

    #[test]
    fn a_suspended_task_continues_only_after_its_sleep_and_when_made_ready() {
        let mut scheduler = processor(PREEMPTIVE, &[3]);
        scheduler.block(2, Time::from_millis(50));
        scheduler.suspend(2);
        scheduler.advance(Time::from_millis(60));
        assert_eq!(scheduler.next(), NextTask::NotBefore(Time::NEVER));
        scheduler.make_ready(2);
        scheduler.advance(Time::from_millis(60));
        assert_eq!(scheduler.next(), NextTask::Run(2));
    }

    #[test]
    fn a_task_run_out_of_turn_preempts_all_others() {
        let mut scheduler = processor(PREEMPTIVE, &[5, 2]);
        scheduler.run_out_of_turn(3);
        assert_eq!(scheduler.next(), NextTask::Run(3));
        scheduler.remove(3);
        assert_eq!(scheduler.next(), NextTask::Run(2));
    }
}
