//! Tasks of a robot: which task runs, which are ready, and what each of them waits for.
//!
//! One task runs at a time. The threads of a program take turns in order of their numbers: at the first call that ends
//! at or after a tick of the global 10 ms grid, and whenever the running thread has to wait. Once RoBIOS 6
//! multi-tasking has started, its [`scheduler`] decides instead. All of this is a function of virtual time and of the
//! tasks' calls; the executor implements the transfer of control from one task to another.

#[cfg(test)]
mod oracle;
pub mod scheduler;
pub mod semaphore;

use std::fmt;
use std::ops::Range;

use robios_sys::robios6::IDLE_PRI;
use robios_sys::support::wait;
use sim_core::time::{TICK, Time};

use scheduler::{NextTask, Policy, Scheduler};
use semaphore::{PassOutcome, Semaphores};

use crate::program::site::Site;

use super::robot::{Robot, Wait, WaitReason};

/// Number of the task that runs `main`.
pub const MAIN: u32 = 1;

/// Maximum number of tasks that a robot has at a time; our choice.
pub const MAX_TASKS: usize = 256;

/// Tasks of one robot.
pub struct Tasks {
    /// Tasks that have not ended, in order of their numbers; the task of `main` is the first and stays to the end.
    list: Vec<Task>,
    /// Index of the running task.
    current: usize,
    /// Number that was assigned last.
    last_number: u32,
    /// Tick at which the time slice ends and other threads get their turn.
    slice_end: Time,
    /// Number of waits in queues so far.
    queued_waits: u64,
    /// Task that exited first, once the program must end: then every task exits instead of continuing.
    first_exiting: Option<u32>,
    /// Scheduler of RoBIOS 6, once multi-tasking has started.
    scheduler: Option<Scheduler>,
    /// No task runs under the scheduler: virtual time passes until one can.
    is_idle: bool,
    /// Semaphores of RoBIOS 6.
    pub semaphores: Semaphores,
}

/// One task.
pub struct Task {
    /// Number of the task, from 1; never reused.
    pub number: u32,
    /// The wait in progress, if the task's call waits.
    pub waiting: Option<Wait>,
    /// Earliest time at which the awaited condition may hold, during a wait.
    wake: Time,
    /// Place in a queue of waiting tasks.
    queue: Option<Queue>,
    /// Another task has interrupted the wait.
    is_interrupted: bool,
    /// The task has exited with the whole program.
    has_exited: bool,
    /// Arguments of `OSSpawn`; the default for `main` and for threads.
    pub origin: Origin,
    /// Progress of `OSKill` on the task.
    kill_state: KillState,
    /// The task has been granted the semaphore that it waits for.
    has_semaphore: bool,
}

/// Origin of a task.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// Name of the task; may be empty.
    pub name: String,
    /// Number that the program gave the task.
    pub uid: i32,
    /// Location in the program of the call that spawned the task.
    pub site: Site,
}

/// Progress of killing a task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum KillState {
    /// The task has not been killed.
    #[default]
    None,
    /// The task is notified when it next runs; task `killer`, if any, waits until it has ended.
    Requested { killer: Option<u32> },
    /// The task unwinds: no other task runs.
    Unwinds { killer: Option<u32> },
}

/// Place in the queue of tasks that wait for `key`.
struct Queue {
    key: u64,
    position: u64,
    is_woken: bool,
}

/// A wait for other tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaskWait {
    /// Kind of the wait, one of [`robios_sys::support::wait`].
    pub kind: i32,
    /// Task that holds the awaited resource, or whose end is awaited; 0 if there is none.
    pub holder: u32,
}

impl Default for Tasks {
    fn default() -> Self {
        Self {
            list: vec![Task::new(MAIN)],
            current: 0,
            last_number: MAIN,
            slice_end: TICK,
            queued_waits: 0,
            first_exiting: None,
            scheduler: None,
            is_idle: false,
            semaphores: Semaphores::default(),
        }
    }
}

impl Task {
    fn new(number: u32) -> Self {
        Self {
            number,
            waiting: None,
            wake: Time::ZERO,
            queue: None,
            is_interrupted: false,
            has_exited: false,
            origin: Origin::default(),
            kill_state: KillState::None,
            has_semaphore: false,
        }
    }

    /// Returns true while a killed task unwinds: only its destructors run, and no other task.
    pub fn is_unwinding(&self) -> bool {
        matches!(self.kill_state, KillState::Unwinds { .. })
    }

    fn is_ready(&self, now: Time) -> bool {
        self.waiting.is_none() || self.wake <= now
    }

    fn waits_for(&self, reason: &WaitReason) -> bool {
        self.waiting.as_ref().is_some_and(|waiting| waiting.reason == *reason)
    }
}

impl Tasks {
    /// Addresses of the running task.
    pub fn hot_memory(&self) -> Range<*const u8> {
        let Range { start, end } = std::slice::from_ref(self.current()).as_ptr_range();
        start.cast()..end.cast()
    }

    /// The running task.
    pub fn current(&self) -> &Task {
        &self.list[self.current]
    }

    /// Tasks that have not ended, or had not ended when the program's exit began; in order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = &Task> {
        self.list.iter()
    }

    /// Returns true for a robot whose only task is `main`, without a scheduler of RoBIOS 6.
    #[inline]
    pub fn is_single(&self) -> bool {
        self.list.len() == 1 && self.scheduler.is_none()
    }

    /// Returns true if there are tasks other than the running task.
    pub fn has_others(&self) -> bool {
        self.list.len() > 1
    }

    /// Returns true if every task waits.
    pub fn are_all_waiting(&self) -> bool {
        if self.scheduler.is_some() { self.is_idle } else { self.list.iter().all(|task| task.waiting.is_some()) }
    }

    /// Returns true if every task has waited since `time` or longer.
    pub fn have_all_waited_since(&self, time: Time) -> bool {
        self.are_all_waiting()
            && self.list.iter().all(|task| task.waiting.as_ref().is_some_and(|wait| wait.since <= time))
    }

    /// Returns true if every task waits, one of them for `reason`.
    pub fn are_all_waiting_one_for(&self, reason: &WaitReason) -> bool {
        self.are_all_waiting() && self.list.iter().any(|task| task.waits_for(reason))
    }

    /// Adds a ready task, the last in order, and returns its number; `None` if there are [`MAX_TASKS`].
    pub fn spawn(&mut self, now: Time) -> Option<u32> {
        if self.list.len() >= MAX_TASKS {
            return None;
        }
        if !self.has_others() {
            self.begin_slice(now);
        }
        self.last_number += 1;
        self.list.push(Task::new(self.last_number));
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.add(self.last_number, scheduler.priority(self.list[self.current].number));
            scheduler.make_ready(self.last_number);
        }
        Some(self.last_number)
    }

    /// Makes the running task wait until `wake`.
    pub fn wait(&mut self, now: Time, mut waiting: Wait, wake: Time) {
        self.advance_in_call(now);
        let number = self.list[self.current].number;
        match &mut self.scheduler {
            Some(scheduler) if waiting.is_blocking() => scheduler.block(number, wake),
            Some(scheduler) => scheduler.wait(number, wake),
            None => {}
        }
        let task = &mut self.list[self.current];
        if let (Some(Wait { reason: WaitReason::Task(previous), .. }), WaitReason::Task(wait)) =
            (&task.waiting, &mut waiting.reason)
        {
            // The holder may have changed since the wait began.
            wait.holder = previous.holder;
        }
        task.waiting = Some(waiting);
        task.wake = wake;
    }

    /// Ends the wait of the running task.
    pub fn end_wait(&mut self) {
        let task = &mut self.list[self.current];
        task.waiting = None;
        task.queue = None;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.resume(task.number);
        }
    }

    /// Returns true, once, if the wait of the running task was interrupted.
    pub fn take_interrupt(&mut self) -> bool {
        std::mem::take(&mut self.list[self.current].is_interrupted)
    }

    /// Thread that continues when the running thread has to wait: the next ready thread in order, otherwise the thread
    /// with the earliest wake time. In a tie the running thread is preferred.
    pub fn next_thread(&self, now: Time) -> NextThread {
        let indices_from =
            |first: usize| (first..first + self.list.len()).map(|step| (self.current + step) % self.list.len());
        let ready = indices_from(1).find(|index| self.list[*index].is_ready(now));
        let next = ready.or_else(|| indices_from(0).min_by_key(|index| self.list[*index].wake));
        match next {
            Some(index) if index != self.current => NextThread::Other(self.list[index].number),
            _ => NextThread::Same,
        }
    }

    /// Number of the next ready task after the running task, in order.
    pub fn next_ready(&self, now: Time) -> Option<u32> {
        let count = self.list.len();
        let mut others = (1..count).map(|step| &self.list[(self.current + step) % count]);
        others.find(|task| task.is_ready(now)).map(|task| task.number)
    }

    /// Thread whose turn begins at the end of a call: the next ready thread, if the time slice is over.
    pub fn next_turn(&mut self, now: Time) -> Option<u32> {
        if !self.has_others() || now < self.slice_end {
            return None;
        }
        self.begin_slice(now);
        self.next_ready(now)
    }

    /// Makes task `number` the running task.
    pub fn switch_to(&mut self, number: u32, now: Time) {
        if let Ok(index) = self.list.binary_search_by_key(&number, |task| task.number) {
            self.current = index;
            self.begin_slice(now);
        }
    }

    fn begin_slice(&mut self, now: Time) {
        self.slice_end = now.floor_to(TICK) + TICK;
    }

    /// Puts the running task at the end of the queue of `key`, unless it is in a queue; returns true if it has been
    /// woken.
    pub fn enqueue_or_check(&mut self, key: u64) -> bool {
        let queue = &mut self.list[self.current].queue;
        if queue.is_none() {
            self.queued_waits += 1;
        }
        queue.get_or_insert(Queue { key, position: self.queued_waits, is_woken: false }).is_woken
    }

    /// Wakes the first task in the queue of `key` and returns its number. The task now holds the awaited resource.
    pub fn wake_first(&mut self, key: u64) -> Option<u32> {
        let position_of =
            |task: &Task| task.queue.as_ref().filter(|queue| queue.is_waiting_for(key)).map(|queue| queue.position);
        let (_, index) = self.list.iter().enumerate().filter_map(|(i, task)| Some((position_of(task)?, i))).min()?;
        let task = &mut self.list[index];
        let number = task.number;
        task.wake = Time::ZERO;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.resume(number);
        }
        if let Some(queue) = &mut task.queue {
            queue.is_woken = true;
        }
        for task in
            self.list.iter_mut().filter(|task| task.queue.as_ref().is_some_and(|queue| queue.is_waiting_for(key)))
        {
            if let Some(Wait { reason: WaitReason::Task(wait), .. }) = &mut task.waiting
                && wait.holder != 0
            {
                wait.holder = number;
            }
        }
        Some(number)
    }

    /// Interrupts the wait of task `number`; returns false if it is not in an interruptible wait.
    pub fn interrupt(&mut self, number: u32) -> bool {
        let Ok(index) = self.list.binary_search_by_key(&number, |task| task.number) else { return false };
        let task = &mut self.list[index];
        let is_woken = task.queue.as_ref().is_some_and(|queue| queue.is_woken);
        let Some(waiting) = &task.waiting else { return false };
        if is_woken || !waiting.reason.is_interruptible() {
            return false;
        }
        task.queue = None;
        task.wake = Time::ZERO;
        task.is_interrupted = true;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.resume(number);
        }
        true
    }

    /// Makes the tasks that wait for the world check their conditions.
    pub fn recheck_world(&mut self, now: Time) {
        self.recheck(now, |reason| !reason.is_for_task());
    }

    /// Makes the tasks that wait for the end of a drive check it again.
    pub fn recheck_drive(&mut self, now: Time) {
        self.recheck(now, |reason| *reason == WaitReason::Drive);
    }

    fn recheck(&mut self, now: Time, is_affected: impl Fn(&WaitReason) -> bool) {
        self.advance_in_call(now);
        self.recheck_from(Time::ZERO, is_affected);
    }

    fn recheck_from(&mut self, time: Time, is_affected: impl Fn(&WaitReason) -> bool) {
        for task in &mut self.list {
            if task.waiting.as_ref().is_some_and(|waiting| is_affected(&waiting.reason)) {
                task.wake = task.wake.min(time);
                if let Some(scheduler) = &mut self.scheduler {
                    scheduler.advance_wake(task.number, time);
                }
            }
        }
    }

    /// Makes the tasks that wait for a message check at `visible`, when one becomes visible.
    pub fn recheck_radio(&mut self, visible: Time) {
        self.recheck_from(visible, |reason| *reason == WaitReason::Message);
    }

    /// Makes the tasks that wait for input check at `at`, when there is some.
    pub fn recheck_input(&mut self, at: Time) {
        self.recheck_from(at, |reason| matches!(reason, WaitReason::Key(_) | WaitReason::Input(_)));
    }

    /// Returns true if the running task waits, and some task waits for something that the scheduler step can cause: the
    /// end of the drive, a message, or user input.
    fn awaits_step(&self) -> bool {
        let is_from_step = |reason: &WaitReason| {
            matches!(reason, WaitReason::Drive | WaitReason::Message | WaitReason::Key(_) | WaitReason::Input(_))
        };
        let awaits = |task: &Task| task.waiting.as_ref().is_some_and(|waiting| is_from_step(&waiting.reason));
        let is_waiting = if self.scheduler.is_some() { self.is_idle } else { self.current().waiting.is_some() };
        is_waiting && self.list.iter().any(awaits)
    }

    /// Earliest time at which a wait may be over, given the end of the drive. `None` unless the scheduler step can end
    /// it.
    pub fn earliest_wake(&mut self, drive_end: Time) -> Option<Time> {
        if !self.awaits_step() {
            return None;
        }
        if let Some(scheduler) = &mut self.scheduler {
            let drive_waits = self.list.iter().filter(|task| task.waits_for(&WaitReason::Drive));
            drive_waits.for_each(|task| scheduler.reset_wake(task.number, drive_end));
            return Some(if let NextTask::NotBefore(time) = scheduler.next() { time } else { Time::ZERO });
        }
        self.list.iter().map(|task| if task.waits_for(&WaitReason::Drive) { drive_end } else { task.wake }).min()
    }

    /// Begins the program's exit; the running task is the first to exit.
    pub fn begin_exit(&mut self) {
        let number = self.current().number;
        self.first_exiting.get_or_insert(number);
    }

    /// The task that exited first, if the program had several.
    pub fn first_exiting(&self) -> Option<u32> {
        self.first_exiting.filter(|_| self.has_others())
    }

    /// Prefix `` task `x`:  `` of an error message, if RoBIOS 6 multi-tasking is on and the running task, or the first
    /// to exit, is not `main`; otherwise empty.
    pub fn prefix(&self) -> String {
        let number = self.first_exiting().unwrap_or(self.current().number);
        if self.scheduler.is_none() || number == MAIN { String::new() } else { format!("{}: ", self.name(number)) }
    }

    /// Returns true once the program must end.
    pub fn is_exiting(&self) -> bool {
        self.first_exiting.is_some()
    }

    /// Ends the running task, which is not `main`, and returns the number of the task that continues. During the
    /// program's exit that task is `main`, and the last wait of the ended task is kept.
    pub fn end_current(&mut self, now: Time) -> u32 {
        if self.is_exiting() {
            self.list[self.current].has_exited = true;
            self.switch_to(MAIN, now);
            return MAIN;
        }
        let number = self.current().number;
        if let Some(scheduler) = &mut self.scheduler {
            let killer = self.list[self.current].killer();
            scheduler.advance_in_call(now);
            scheduler.remove(number);
            self.list.remove(self.current);
            let killer = killer.filter(|killer| self.list.iter().any(|task| task.number == *killer));
            let next = match killer {
                // In a timer callback: the wait that it interrupts continues.
                Some(killer) if self.is_idle => killer,
                Some(killer) => {
                    scheduler.run_out_of_turn(killer);
                    killer
                }
                None => {
                    scheduler.advance(now);
                    if let NextTask::Run(next) = scheduler.next() { next } else { MAIN }
                }
            };
            self.switch_to(next, now);
            return next;
        }
        let count = self.list.len();
        let others = (1..count).map(|step| &self.list[(self.current + step) % count]);
        let next = self.next_ready(now).or_else(|| others.min_by_key(|task| task.wake).map(|task| task.number));
        let next = next.unwrap_or(MAIN);
        self.list.retain(|task| task.number != number);
        self.switch_to(next, now);
        next
    }

    /// Starts multi-tasking; returns false if it has started already, or the program has threads.
    pub fn start(&mut self, now: Time, policy: Policy) -> bool {
        if self.scheduler.is_some() || self.has_others() {
            return false;
        }
        self.scheduler = Some(Scheduler::new(policy, MAIN, IDLE_PRI as usize, now));
        true
    }

    /// Scheduler of RoBIOS 6, once multi-tasking has started.
    pub fn scheduler(&self) -> Option<&Scheduler> {
        self.scheduler.as_ref()
    }

    /// The scheduler, advanced to `now`, so that its state can be changed.
    pub fn scheduler_at(&mut self, now: Time) -> Option<&mut Scheduler> {
        self.advance_in_call(now);
        self.scheduler.as_mut()
    }

    /// Advances the scheduler to virtual time `now`, within a call or a timer callback.
    fn advance_in_call(&mut self, now: Time) {
        match &mut self.scheduler {
            Some(scheduler) if self.is_idle => scheduler.advance(now),
            Some(scheduler) => scheduler.advance_in_call(now),
            None => {}
        }
    }

    /// Task that continues at `now`, while no call is in progress; for programs with a scheduler.
    pub fn next_task(&mut self, now: Time) -> NextTask {
        self.is_idle = false;
        let Some(scheduler) = &mut self.scheduler else { return NextTask::Run(self.list[self.current].number) };
        scheduler.advance(now);
        let next = scheduler.next();
        self.is_idle = matches!(next, NextTask::NotBefore(_));
        next
    }

    /// Adds a suspended task and returns its number; `None` if there are [`MAX_TASKS`] or there is no scheduler.
    pub fn create(&mut self, now: Time, origin: Origin, priority: usize) -> Option<u32> {
        self.advance_in_call(now);
        let scheduler = self.scheduler.as_mut().filter(|_| self.list.len() < MAX_TASKS)?;
        self.last_number += 1;
        scheduler.add(self.last_number, priority);
        self.list.push(Task { origin, ..Task::new(self.last_number) });
        Some(self.last_number)
    }

    /// Removes a task that could not be started.
    pub fn forget(&mut self, number: u32) {
        self.list.retain(|task| task.number != number);
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.remove(number);
        }
    }

    /// Task with this number, 0 for the running task; `None` if it has ended or never existed.
    pub fn find(&self, number: i32) -> Option<&Task> {
        match u32::try_from(number) {
            Ok(0) => Some(self.current()),
            Ok(number) => self.index(number).map(|index| &self.list[index]),
            Err(_) => None,
        }
    }

    fn index(&self, number: u32) -> Option<usize> {
        self.list.binary_search_by_key(&number, |task| task.number).ok()
    }

    /// Names of the tasks other than `main` that have not ended, as shown to the user.
    pub fn names_of_others(&self) -> String {
        let others = self.list.iter().filter(|task| task.number != MAIN).map(|task| self.name(task.number));
        others.collect::<Vec<_>>().join(", ")
    }

    /// Name of a task as shown to the user: `` task `left` ``, with its number if several have that name.
    pub fn name(&self, number: u32) -> String {
        let name_of = |task: &Task| task.origin.name.clone();
        let name = self.index(number).map(|index| name_of(&self.list[index])).unwrap_or_default();
        let is_shared = self.list.iter().any(|task| task.number != number && task.origin.name == name);
        match (number, name.as_str()) {
            (MAIN, "") if self.scheduler.is_some() => "`main`".to_owned(),
            (_, "") => format!("task {number}"),
            _ if is_shared => format!("task `{name}` ({number})"),
            _ => format!("task `{name}`"),
        }
    }

    /// Records the wait of the running task for the end of its own suspension.
    pub fn note_suspension(&mut self, waiting: Wait) {
        self.list[self.current].waiting = Some(waiting);
    }

    /// Kills a task. It runs before all other tasks, to unwind; then the running task continues, unless it is the
    /// killed one.
    pub fn kill(&mut self, now: Time, number: u32) {
        self.advance_in_call(now);
        let current = self.current().number;
        let Some(index) = self.index(number) else { return };
        let task = &mut self.list[index];
        task.kill_state = KillState::Requested { killer: Some(current).filter(|killer| *killer != number) };
        task.queue = None;
        let held = std::mem::take(&mut task.has_semaphore);
        if let Some(Wait { reason: WaitReason::Semaphore(semaphore), .. }) = task.waiting.take() {
            self.semaphores.dequeue(semaphore, number);
            if held {
                self.release_semaphore(semaphore);
            }
        }
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.run_out_of_turn(number);
        }
    }

    /// Returns true, once, if the running task has been killed and must unwind.
    pub fn take_kill(&mut self) -> bool {
        let task = &mut self.list[self.current];
        let KillState::Requested { killer } = task.kill_state else { return false };
        task.kill_state = KillState::Unwinds { killer };
        true
    }

    /// Returns true once the running task must end while the other tasks continue.
    pub fn is_killed(&self) -> bool {
        self.current().kill_state != KillState::None
    }

    /// Releases semaphore `number`: the first waiting task passes, or the count rises. Returns false if there is no
    /// such semaphore or its count is at its limit.
    pub fn release_semaphore(&mut self, number: u32) -> bool {
        let Some(first) = self.semaphores.release(number) else { return false };
        let Some(index) = first.and_then(|first| self.index(first)) else { return true };
        let task = &mut self.list[index];
        (task.has_semaphore, task.wake) = (true, Time::ZERO);
        let (task, site) = (task.number, task.waiting.as_ref().map(|waiting| waiting.site.clone()));
        self.semaphores.note_passing(number, self.name(task), site.unwrap_or_default());
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.resume(task);
        }
        true
    }

    /// Passes semaphore `number` for the running task, which called at `site`, or puts the task at the end of its
    /// queue.
    pub fn pass_semaphore(&mut self, number: u32, site: &Site) -> PassOutcome {
        let task = &mut self.list[self.current];
        if std::mem::take(&mut task.has_semaphore) {
            return PassOutcome::Passed;
        }
        let task = task.number;
        let outcome = self.semaphores.pass(number, task);
        if outcome == PassOutcome::Passed {
            self.semaphores.note_passing(number, self.name(task), site.clone());
        }
        outcome
    }

    /// Number of a task other than `main` that has not exited yet.
    pub fn next_to_exit(&self) -> Option<u32> {
        self.list.iter().skip(1).find(|task| !task.has_exited).map(|task| task.number)
    }
}

/// Thread of the program that continues next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextThread {
    /// The running thread.
    Same,
    /// The thread with this number.
    Other(u32),
}

impl Task {
    fn killer(&self) -> Option<u32> {
        match self.kill_state {
            KillState::Requested { killer } | KillState::Unwinds { killer } => killer,
            KillState::None => None,
        }
    }
}

impl Queue {
    /// Returns true if this is a place in the queue of `key` whose task has not been woken.
    fn is_waiting_for(&self, key: u64) -> bool {
        self.key == key && !self.is_woken
    }
}

impl TaskWait {
    /// Returns true if another task may interrupt the wait.
    pub fn is_interruptible(self) -> bool {
        matches!(self.kind, wait::CONDITION | wait::SEMAPHORE | wait::END)
    }
}

impl TaskWait {
    /// Describes the wait; `name_of` names the holder.
    pub fn describe(self, name_of: impl Fn(u32) -> String) -> String {
        let resource = match self.kind {
            wait::MUTEX => "a mutex",
            wait::CONDITION => "a condition to be signalled",
            wait::SEMAPHORE => "a semaphore",
            wait::RWLOCK => "a read-write lock",
            wait::BARRIER => "the others at a barrier",
            wait::ONCE => "an initialisation",
            wait::STREAM => "a stream",
            wait::END => return format!("the end of {}", name_of(self.holder)),
            wait::ENDS => "the end of all other tasks",
            _ => "another task",
        };
        match (self.kind, self.holder) {
            (_, 0) => resource.to_owned(),
            (wait::ONCE, holder) => format!("{resource} by {}", name_of(holder)),
            (wait::STREAM, holder) => format!("{resource} locked by {}", name_of(holder)),
            (_, holder) => format!("{resource} held by {}", name_of(holder)),
        }
    }
}

impl fmt::Display for TaskWait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe(|number| format!("task {number}")))
    }
}

impl Robot {
    /// Returns true if the suspended program waits for something that the scheduler step can cause.
    pub fn awaits_step(&self) -> bool {
        // A call made by a timer callback does not wait, whatever the interrupted call waits for.
        !self.timers.in_callback && self.tasks.awaits_step()
    }

    /// Earliest time at which a wait of a task may be over, given the effects of the slot that ends at `slot_end`;
    /// `None` if the scheduler step cannot have changed this time.
    pub fn earliest_wake_after(&mut self, slot_end: Time) -> Option<Time> {
        if !self.awaits_step() {
            return None;
        }
        // Placing a robot elsewhere ends its drive.
        let is_done = self.motion.is_drive_done(slot_end);
        let drive_end = if is_done { Some(slot_end) } else { self.motion.drive_end() };
        let drive_end = drive_end.unwrap_or(Time::NEVER).max(slot_end);
        let wake = self.tasks.earliest_wake(drive_end)?;
        Some(wake.min(self.timers.next_due()).min(self.devices.due()))
    }
}
