//! The tasks of a robot: who of them runs, who is ready, and who waits for what.
//!
//! One task runs at a time. Threads of a program take turns at the first call that ends at or after a tick of the global 10 ms grid,
//! in order of their numbers, and whenever the one that runs has to wait; once RoBIOS 6 has multi-tasking, its [`scheduler`] says
//! who runs. All of this is a function of virtual time and of what the tasks call; how control goes from one to the other is the
//! executor's.

#[cfg(test)]
mod oracle;
pub mod scheduler;
pub mod semaphore;

use std::fmt;

use robios_sys::robios6::IDLE_PRI;
use robios_sys::support::wait;
use sim_core::time::{TICK, Time};

use scheduler::{Next, Policy, Scheduler};
use semaphore::{Passing, Semaphores};

use crate::program::site::Site;

use super::robot::{Robot, Waiting, Waits};

/// The number of the task that runs `main`.
pub const MAIN: u32 = 1;

/// How many tasks a robot may have at a time; our choice.
pub const MAX_TASKS: usize = 256;

/// The tasks of one robot.
pub struct Tasks {
    /// Those that have not ended, in order of their numbers; `main`'s is the first and stays to the end.
    list: Vec<Task>,
    /// Which of them runs.
    current: usize,
    /// The number that was given last.
    last_number: u32,
    /// From this tick on the others get their turn.
    slice_end: Time,
    /// How many waits in queues have begun.
    queued: u64,
    /// The task that left first, once the program is to be left: nobody gets on any more, everybody leaves.
    first_to_leave: Option<u32>,
    /// Who runs when, once RoBIOS 6 has multi-tasking.
    scheduler: Option<Scheduler>,
    /// True while nobody runs under the scheduler: virtual time passes until somebody can.
    is_idle: bool,
    /// The semaphores of RoBIOS 6.
    pub semaphores: Semaphores,
}

/// One task.
pub struct Task {
    /// Its number, from 1; never given twice.
    pub number: u32,
    /// What it waits for, while a call waits.
    pub waiting: Option<Waiting>,
    /// When the wait's condition may hold, while it waits.
    wake: Time,
    /// Its place in a queue of tasks.
    queue: Option<Queue>,
    /// True when another task has ended its wait by force.
    is_interrupted: bool,
    /// True once it has left with the whole program.
    has_left: bool,
    /// What `OSSpawn` was told of it; the first line of `main` knows nothing.
    pub origin: Origin,
    /// How far it has been killed.
    killed: Killed,
    /// True once it has the semaphore that it waits for.
    has_semaphore: bool,
}

/// Where a task comes from.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// Its name; empty for one without.
    pub name: String,
    /// The number that the program gave it.
    pub uid: i32,
    /// Where it was spawned.
    pub site: Site,
}

/// How far a task has been killed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Killed {
    /// It lives.
    #[default]
    No,
    /// It is told at the next opportunity; this task waits for that, if any.
    Told { killer: Option<u32> },
    /// It unwinds: nobody else runs.
    Unwinds { killer: Option<u32> },
}

/// A place in the queue of those that wait for one thing.
struct Queue {
    key: u64,
    place: u64,
    is_woken: bool,
}

/// Something of other tasks' that a task waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaskWait {
    /// What, of [`robios_sys::support::wait`].
    pub kind: i32,
    /// The task that has it, 0 where that means nothing.
    pub holder: u32,
}

impl Default for Tasks {
    fn default() -> Self {
        Self {
            list: vec![Task::new(MAIN)],
            current: 0,
            last_number: MAIN,
            slice_end: TICK,
            queued: 0,
            first_to_leave: None,
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
            has_left: false,
            origin: Origin::default(),
            killed: Killed::No,
            has_semaphore: false,
        }
    }

    /// True while it unwinds because it was killed: only its destructors run, and nobody else.
    pub fn is_unwinding(&self) -> bool {
        matches!(self.killed, Killed::Unwinds { .. })
    }

    fn is_ready(&self, now: Time) -> bool {
        self.waiting.is_none() || self.wake <= now
    }

    fn waits_for(&self, what: &Waits) -> bool {
        self.waiting.as_ref().is_some_and(|waiting| waiting.waits_for == *what)
    }
}

impl Tasks {
    /// The task that runs.
    pub fn current(&self) -> &Task {
        &self.list[self.current]
    }

    /// Those that have not ended, or had not when the program was left; in order of their numbers.
    pub fn iter(&self) -> impl Iterator<Item = &Task> {
        self.list.iter()
    }

    /// True when there are others than the one that runs.
    pub fn has_others(&self) -> bool {
        self.list.len() > 1
    }

    /// True when every task waits.
    pub fn are_waiting(&self) -> bool {
        if self.scheduler.is_some() { self.is_idle } else { self.list.iter().all(|task| task.waiting.is_some()) }
    }

    /// True when every task waits, one of them for `what`.
    pub fn wait_for(&self, what: &Waits) -> bool {
        self.are_waiting() && self.list.iter().any(|task| task.waits_for(what))
    }

    /// Adds a task, ready, the last in order; its number. None when there are [`MAX_TASKS`].
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
            scheduler.ready(self.last_number);
        }
        Some(self.last_number)
    }

    /// The task that runs waits until `wake`.
    pub fn wait(&mut self, now: Time, mut waiting: Waiting, wake: Time) {
        self.reach(now);
        let number = self.list[self.current].number;
        match &mut self.scheduler {
            Some(scheduler) if waiting.leaves_processor() => scheduler.block(number, wake),
            Some(scheduler) => scheduler.wait(number, wake),
            None => {}
        }
        let task = &mut self.list[self.current];
        if let (Some(Waiting { waits_for: Waits::Task(before), .. }), Waits::Task(wait)) =
            (&task.waiting, &mut waiting.waits_for)
        {
            // Who has what it waits for may have changed since it asked.
            wait.holder = before.holder;
        }
        task.waiting = Some(waiting);
        task.wake = wake;
    }

    /// The wait of the task that runs is over.
    pub fn end_wait(&mut self) {
        let task = &mut self.list[self.current];
        task.waiting = None;
        task.queue = None;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.run(task.number);
        }
    }

    /// True, once, when the wait of the task that runs was ended by force.
    pub fn take_interrupt(&mut self) -> bool {
        std::mem::take(&mut self.list[self.current].is_interrupted)
    }

    /// Who goes on when the task that runs has to wait: the next one that is ready, in order, else the one whose wake is the
    /// earliest, which is the one that runs if no other is earlier.
    pub fn next_thread(&self, now: Time) -> NextThread {
        let after = |first: usize| (first..first + self.list.len()).map(|step| (self.current + step) % self.list.len());
        let ready = after(1).find(|index| self.list[*index].is_ready(now));
        let next = ready.or_else(|| after(0).min_by_key(|index| self.list[*index].wake));
        match next {
            Some(index) if index != self.current => NextThread::Other(self.list[index].number),
            _ => NextThread::Same,
        }
    }

    /// The next other task that is ready, in order.
    pub fn next_ready(&self, now: Time) -> Option<u32> {
        let count = self.list.len();
        let mut others = (1..count).map(|step| &self.list[(self.current + step) % count]);
        others.find(|task| task.is_ready(now)).map(|task| task.number)
    }

    /// Whose turn it is at the end of a call: another task's if the time slice is over and it is ready.
    pub fn whose_turn(&mut self, now: Time) -> Option<u32> {
        if !self.has_others() || now < self.slice_end {
            return None;
        }
        self.begin_slice(now);
        self.next_ready(now)
    }

    /// From now on task `number` runs.
    pub fn switch_to(&mut self, number: u32, now: Time) {
        if let Ok(index) = self.list.binary_search_by_key(&number, |task| task.number) {
            self.current = index;
            self.begin_slice(now);
        }
    }

    fn begin_slice(&mut self, now: Time) {
        self.slice_end = now.floor_to(TICK) + TICK;
    }

    /// Puts the task that runs at the end of the queue of `key`, if it is in none, and looks whether it was woken.
    pub fn look_in_queue(&mut self, key: u64) -> bool {
        let queue = &mut self.list[self.current].queue;
        if queue.is_none() {
            self.queued += 1;
        }
        queue.get_or_insert(Queue { key, place: self.queued, is_woken: false }).is_woken
    }

    /// Makes the first task in the queue of `key` ready; its number. What it waited for is now its own.
    pub fn wake_first(&mut self, key: u64) -> Option<u32> {
        let place_of = |task: &Task| task.queue.as_ref().filter(|queue| queue.is(key)).map(|queue| queue.place);
        let (_, index) = self.list.iter().enumerate().filter_map(|(i, task)| Some((place_of(task)?, i))).min()?;
        let task = &mut self.list[index];
        let number = task.number;
        task.wake = Time::ZERO;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.run(number);
        }
        if let Some(queue) = &mut task.queue {
            queue.is_woken = true;
        }
        for task in self.list.iter_mut().filter(|task| task.queue.as_ref().is_some_and(|queue| queue.is(key))) {
            if let Some(Waiting { waits_for: Waits::Task(wait), .. }) = &mut task.waiting
                && wait.holder != 0
            {
                wait.holder = number;
            }
        }
        Some(number)
    }

    /// Ends the wait of task `number` by force, if it is in one that can be; false if not.
    pub fn interrupt(&mut self, number: u32) -> bool {
        let Ok(index) = self.list.binary_search_by_key(&number, |task| task.number) else { return false };
        let task = &mut self.list[index];
        let is_woken = task.queue.as_ref().is_some_and(|queue| queue.is_woken);
        let Some(waiting) = &task.waiting else { return false };
        if is_woken || !waiting.waits_for.is_interruptible() {
            return false;
        }
        task.queue = None;
        task.wake = Time::ZERO;
        task.is_interrupted = true;
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.run(number);
        }
        true
    }

    /// Lets the tasks that wait for something of the world look whether it is there.
    pub fn look_at_world(&mut self, now: Time) {
        self.look_again(now, |waits_for| !waits_for.is_for_task());
    }

    /// Lets the tasks that wait for the end of a drive look at it again.
    pub fn look_at_drive(&mut self, now: Time) {
        self.look_again(now, |waits_for| *waits_for == Waits::Drive);
    }

    fn look_again(&mut self, now: Time, is_meant: impl Fn(&Waits) -> bool) {
        self.reach(now);
        self.look_from(Time::ZERO, is_meant);
    }

    fn look_from(&mut self, time: Time, is_meant: impl Fn(&Waits) -> bool) {
        for task in &mut self.list {
            if task.waiting.as_ref().is_some_and(|waiting| is_meant(&waiting.waits_for)) {
                task.wake = task.wake.min(time);
                if let Some(scheduler) = &mut self.scheduler {
                    scheduler.look_at(task.number, time);
                }
            }
        }
    }

    /// A message becomes visible at `visible`: the tasks that wait for one look then.
    pub fn look_at_radio(&mut self, visible: Time) {
        self.look_from(visible, |waits_for| *waits_for == Waits::Message);
    }

    /// Somebody gives input at `at`: the tasks that wait for some look then.
    pub fn look_at_input(&mut self, at: Time) {
        self.look_from(at, |waits_for| matches!(waits_for, Waits::Key(_) | Waits::Input(_)));
    }

    /// When the first wait may be over, given when the drive ends; none unless the task that runs waits, and one of them for
    /// something that the slot loop brings: the end of the drive, a message, or a hand's input.
    pub fn wake_with(&mut self, drive_end: Time) -> Option<Time> {
        let is_brought =
            |waits_for: &Waits| matches!(waits_for, Waits::Drive | Waits::Message | Waits::Key(_) | Waits::Input(_));
        let is_meant = |task: &Task| task.waiting.as_ref().is_some_and(|waiting| is_brought(&waiting.waits_for));
        let is_waiting = if self.scheduler.is_some() { self.is_idle } else { self.current().waiting.is_some() };
        if !is_waiting || !self.list.iter().any(is_meant) {
            return None;
        }
        if let Some(scheduler) = &mut self.scheduler {
            let of_drive = self.list.iter().filter(|task| task.waits_for(&Waits::Drive));
            of_drive.for_each(|task| scheduler.reset_wake(task.number, drive_end));
            return Some(if let Next::At(time) = scheduler.next() { time } else { Time::ZERO });
        }
        self.list.iter().map(|task| if task.waits_for(&Waits::Drive) { drive_end } else { task.wake }).min()
    }

    /// The program is to be left, the task that runs being the first to go.
    pub fn begin_leaving(&mut self) {
        let number = self.current().number;
        self.first_to_leave.get_or_insert(number);
    }

    /// The task that left first, where the program had several.
    pub fn first_to_leave(&self) -> Option<u32> {
        self.first_to_leave.filter(|_| self.has_others())
    }

    /// `` task `x`:  `` before what went wrong, where RoBIOS 6 has several tasks and it was not `main` that runs, or left first.
    pub fn prefix(&self) -> String {
        let number = self.first_to_leave().unwrap_or(self.current().number);
        if self.scheduler.is_none() || number == MAIN { String::new() } else { format!("{}: ", self.name(number)) }
    }

    /// True once the program is to be left.
    pub fn is_leaving(&self) -> bool {
        self.first_to_leave.is_some()
    }

    /// The task that runs, which is not `main`'s, has ended; the number of the one that goes on. While the program is left that
    /// is `main`'s, and what the one that has left waited for stays known.
    pub fn end_current(&mut self, now: Time) -> u32 {
        if self.is_leaving() {
            self.list[self.current].has_left = true;
            self.switch_to(MAIN, now);
            return MAIN;
        }
        let number = self.current().number;
        if let Some(scheduler) = &mut self.scheduler {
            let killer = self.list[self.current].killer();
            scheduler.reach(now);
            scheduler.remove(number);
            self.list.remove(self.current);
            let killer = killer.filter(|killer| self.list.iter().any(|task| task.number == *killer));
            let next = match killer {
                // In a timer's function: the wait that it interrupts goes on.
                Some(killer) if self.is_idle => killer,
                Some(killer) => {
                    scheduler.take_over(killer);
                    killer
                }
                None => {
                    scheduler.advance(now);
                    if let Next::Go(next) = scheduler.next() { next } else { MAIN }
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

    /// Starts multi-tasking; false if there is some already, be it threads.
    pub fn start(&mut self, now: Time, policy: Policy) -> bool {
        if self.scheduler.is_some() || self.has_others() {
            return false;
        }
        self.scheduler = Some(Scheduler::new(policy, MAIN, IDLE_PRI as usize, now));
        true
    }

    /// Who runs when, once RoBIOS 6 has multi-tasking.
    pub fn scheduler(&self) -> Option<&Scheduler> {
        self.scheduler.as_ref()
    }

    /// The same, for a change at `now`.
    pub fn scheduler_at(&mut self, now: Time) -> Option<&mut Scheduler> {
        self.reach(now);
        self.scheduler.as_mut()
    }

    /// Virtual time has come to `now`, within a call or a timer's callback.
    fn reach(&mut self, now: Time) {
        match &mut self.scheduler {
            Some(scheduler) if self.is_idle => scheduler.advance(now),
            Some(scheduler) => scheduler.reach(now),
            None => {}
        }
    }

    /// Who goes on at `now`, no call being in progress. Only under the scheduler.
    pub fn turn(&mut self, now: Time) -> Next {
        self.is_idle = false;
        let Some(scheduler) = &mut self.scheduler else { return Next::Go(self.list[self.current].number) };
        scheduler.advance(now);
        let next = scheduler.next();
        self.is_idle = matches!(next, Next::At(_));
        next
    }

    /// Adds a task that is not ready; its number. None when there are [`MAX_TASKS`].
    pub fn create(&mut self, now: Time, origin: Origin, priority: usize) -> Option<u32> {
        self.reach(now);
        let scheduler = self.scheduler.as_mut().filter(|_| self.list.len() < MAX_TASKS)?;
        self.last_number += 1;
        scheduler.add(self.last_number, priority);
        self.list.push(Task { origin, ..Task::new(self.last_number) });
        Some(self.last_number)
    }

    /// Takes a task back that could not be started.
    pub fn forget(&mut self, number: u32) {
        self.list.retain(|task| task.number != number);
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.remove(number);
        }
    }

    /// The task of this number, 0 being the one that runs; none if it has ended or never was.
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

    /// Those besides `main` that have not ended, as the user knows them.
    pub fn others_in_words(&self) -> String {
        let others = self.list.iter().filter(|task| task.number != MAIN).map(|task| self.name(task.number));
        others.collect::<Vec<_>>().join(", ")
    }

    /// The task as the user knows it: `` task `left` ``, with its number where several are called so.
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

    /// Notes what the task that runs waits for, where that is its own suspension.
    pub fn note_suspension(&mut self, waiting: Waiting) {
        self.list[self.current].waiting = Some(waiting);
    }

    /// Kills a task: it runs before all others, to unwind; then task `killer` goes on, if it is not the same.
    pub fn kill(&mut self, now: Time, number: u32) {
        self.reach(now);
        let current = self.current().number;
        let Some(index) = self.index(number) else { return };
        let task = &mut self.list[index];
        task.killed = Killed::Told { killer: Some(current).filter(|killer| *killer != number) };
        task.queue = None;
        let held = std::mem::take(&mut task.has_semaphore);
        if let Some(Waiting { waits_for: Waits::Semaphore(semaphore), .. }) = task.waiting.take() {
            self.semaphores.leave(semaphore, number);
            if held {
                self.release_semaphore(semaphore);
            }
        }
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.take_over(number);
        }
    }

    /// True, once, when the task that runs has been killed: it is to unwind.
    pub fn take_kill(&mut self) -> bool {
        let task = &mut self.list[self.current];
        let Killed::Told { killer } = task.killed else { return false };
        task.killed = Killed::Unwinds { killer };
        true
    }

    /// True once the task that runs is to end, the others going on.
    pub fn is_killed(&self) -> bool {
        self.current().killed != Killed::No
    }

    /// Lets the first task that waits at semaphore `number` pass, or one more later; false if there is none, or it is full.
    pub fn release_semaphore(&mut self, number: u32) -> bool {
        let Some(first) = self.semaphores.release(number) else { return false };
        let Some(index) = first.and_then(|first| self.index(first)) else { return true };
        let task = &mut self.list[index];
        (task.has_semaphore, task.wake) = (true, Time::ZERO);
        let (task, site) = (task.number, task.waiting.as_ref().map(|waiting| waiting.site.clone()));
        self.semaphores.note_passing(number, self.name(task), site.unwrap_or_default());
        if let Some(scheduler) = &mut self.scheduler {
            scheduler.run(task);
        }
        true
    }

    /// The task that runs, which called at `site`, passes semaphore `number`, or is put at the end of its queue.
    pub fn pass_semaphore(&mut self, number: u32, site: &Site) -> Passing {
        let task = &mut self.list[self.current];
        if std::mem::take(&mut task.has_semaphore) {
            return Passing::Passed;
        }
        let task = task.number;
        let passing = self.semaphores.pass(number, task);
        if passing == Passing::Passed {
            self.semaphores.note_passing(number, self.name(task), site.clone());
        }
        passing
    }

    /// A task that has yet to leave, besides `main`'s.
    pub fn next_to_leave(&self) -> Option<u32> {
        self.list.iter().skip(1).find(|task| !task.has_left).map(|task| task.number)
    }
}

/// Which of the threads of a program goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextThread {
    /// The one that runs.
    Same,
    /// The one of this number.
    Other(u32),
}

impl Task {
    fn killer(&self) -> Option<u32> {
        match self.killed {
            Killed::Told { killer } | Killed::Unwinds { killer } => killer,
            Killed::No => None,
        }
    }
}

impl Queue {
    /// True if this is a place in the queue of `key` that waits still.
    fn is(&self, key: u64) -> bool {
        self.key == key && !self.is_woken
    }
}

impl TaskWait {
    /// True where another task may end the wait by force.
    pub fn is_interruptible(self) -> bool {
        matches!(self.kind, wait::CONDITION | wait::SEMAPHORE | wait::END)
    }
}

impl TaskWait {
    /// What it is, who has it being called as `name_of` says.
    pub fn words(self, name_of: impl Fn(u32) -> String) -> String {
        let what = match self.kind {
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
            (_, 0) => what.to_owned(),
            (wait::ONCE, holder) => format!("{what} by {}", name_of(holder)),
            (wait::STREAM, holder) => format!("{what} locked by {}", name_of(holder)),
            (_, holder) => format!("{what} held by {}", name_of(holder)),
        }
    }
}

impl fmt::Display for TaskWait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words(|number| format!("task {number}")))
    }
}

impl Robot {
    /// When the first wait of its tasks may be over, given what the slot that ends at `slot_end` has brought; none where the slot
    /// loop cannot have changed that.
    pub fn wake_after(&mut self, slot_end: Time) -> Option<Time> {
        // What a callback calls is work, whatever the call that it interrupts waits for.
        if self.timers.in_callback {
            return None;
        }
        // Somebody who was put elsewhere has no drive any more.
        let is_done = self.motion.is_drive_done(slot_end);
        let drive_end = if is_done { Some(slot_end) } else { self.motion.drive_end() };
        let drive_end = drive_end.unwrap_or(Time::NEVER).max(slot_end);
        let wake = self.tasks.wake_with(drive_end)?;
        Some(wake.min(self.timers.next_due()).min(self.devices.due()))
    }
}
