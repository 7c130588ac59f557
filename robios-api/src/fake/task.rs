//! Tasks of a fake robot: each on its own thread, one at a time.
//!
//! The running task is chosen within calls, by priority and by the order of becoming ready, never by the operating
//! system.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex};
use std::thread::JoinHandle;

use robios_sys::robios6::{COOP, MAX_PRI, MIN_PRI, NOTASK, PREEMPT};
use robios_sys::{Callback, Stop};

use super::robot::{FakeRobot, State, TIMER_TICK_US};
use crate::robot::locked;

/// The task that runs `main`.
const MAIN: usize = 0;

/// Run token: its holder runs, and passes it on to another task.
#[derive(Default)]
pub(super) struct RunToken {
    holder: Mutex<usize>,
    handover: Condvar,
}

impl RunToken {
    fn pass_to(&self, task: usize) {
        let mut holder = locked(&self.holder);
        *holder = task;
        self.handover.notify_all();
    }

    fn wait_for(&self, task: usize) {
        let holder = locked(&self.holder);
        // The lock is never poisoned: nothing panics while it is held.
        drop(self.handover.wait_while(holder, |holder| *holder != task));
    }
}

/// All tasks of a robot.
pub(super) struct TaskTable {
    mode: Option<i32>,
    is_permitted: bool,
    entries: Vec<TaskEntry>,
    current: usize,
    slice_end_us: u64,
    /// Number of transitions to ready so far.
    ready_count: u64,
    semaphores: Vec<Semaphore>,
    threads: Vec<JoinHandle<()>>,
    /// The other tasks must then end.
    has_main_returned: bool,
}

struct TaskEntry {
    name: String,
    priority: i32,
    uid: i32,
    code: Callback,
    status: Status,
    /// The task does not run until it is made ready, also after its sleep or its wait.
    is_suspended: bool,
    /// Order of becoming ready: lower is earlier.
    ready_order: u64,
    has_begun: bool,
    /// The task that has killed this one, and resumes when this one has ended.
    killer: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Status {
    Ready,
    AsleepUntil(u64),
    AtSemaphore(usize),
    Ended,
}

struct Semaphore {
    permits: i32,
    waiting: VecDeque<usize>,
}

impl TaskTable {
    pub(super) fn new() -> Self {
        let main = TaskEntry {
            name: "main".to_owned(),
            priority: MIN_PRI - 1,
            uid: 0,
            code: Callback::NONE,
            status: Status::Ready,
            is_suspended: false,
            ready_order: 0,
            has_begun: true,
            killer: None,
        };
        Self {
            mode: None,
            is_permitted: false,
            entries: vec![main],
            current: MAIN,
            slice_end_us: TIMER_TICK_US,
            ready_count: 0,
            semaphores: Vec::new(),
            threads: Vec::new(),
            has_main_returned: false,
        }
    }

    /// Returns true if the running task must end.
    pub(super) fn must_running_task_end(&self) -> bool {
        self.has_main_returned || self.entries[self.current].killer.is_some()
    }

    fn is_preemption_on(&self) -> bool {
        self.mode == Some(PREEMPT) && self.is_permitted
    }

    fn make_ready(&mut self, task: usize) {
        if self.entries[task].status == Status::Ended {
            return;
        }
        self.ready_count += 1;
        self.entries[task].status = Status::Ready;
        self.entries[task].ready_order = self.ready_count;
    }

    /// Makes the tasks ready whose sleep is over.
    fn wake(&mut self, now_us: u64) {
        let mut due: Vec<(u64, usize)> = self.sleepers().filter(|(time_us, _)| *time_us <= now_us).collect();
        due.sort_unstable();
        due.into_iter().for_each(|(_, task)| self.make_ready(task));
    }

    fn sleepers(&self) -> impl Iterator<Item = (u64, usize)> {
        self.entries.iter().enumerate().filter_map(|(index, task)| match task.status {
            Status::AsleepUntil(time_us) => Some((time_us, index)),
            _ => None,
        })
    }

    /// The ready task of the highest priority; ties go to the one that has been ready longest.
    fn next(&self) -> Option<usize> {
        let is_ready = |task: &TaskEntry| task.status == Status::Ready && !task.is_suspended;
        let ready = self.entries.iter().enumerate().filter(|(_, task)| is_ready(task));
        ready.min_by_key(|(_, task)| (-task.priority, task.ready_order)).map(|(index, _)| index)
    }

    fn switch_to(&mut self, task: usize, now_us: u64) {
        self.current = task;
        self.slice_end_us = now_us / TIMER_TICK_US * TIMER_TICK_US + TIMER_TICK_US;
    }

    /// Index of a task by its number, 0 for the running task; `None` if the task has ended.
    fn index(&self, number: i32) -> Option<usize> {
        let index = if number == 0 { self.current } else { usize::try_from(number).ok()? };
        self.entries.get(index).filter(|task| task.status != Status::Ended).map(|_| index)
    }

    fn semaphore(&mut self, number: i32) -> Option<(usize, &mut Semaphore)> {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        self.semaphores.get_mut(index).map(|semaphore| (index, semaphore))
    }

    /// Message that names what each task waits for.
    fn deadlock_message(&self) -> String {
        let waiting = self.entries.iter().filter(|task| task.status != Status::Ended);
        let parts = waiting.map(|task| match task.status {
            Status::AtSemaphore(index) => format!("`{}` waits at semaphore {}", task.name, index + 1),
            _ => format!("`{}` is suspended", task.name),
        });
        format!("no task can run: {}", parts.collect::<Vec<_>>().join(", "))
    }
}

impl State {
    /// Wakes tasks and renews an expired time slice; returns true if another task must run now.
    fn update_preemption(&mut self) -> bool {
        let now_us = self.now_us;
        self.tasks.wake(now_us);
        let current = self.tasks.current;
        if now_us >= self.tasks.slice_end_us {
            self.tasks.switch_to(current, now_us);
            self.tasks.make_ready(current);
        }
        self.tasks.next() != Some(current)
    }
}

/// Pointer to a fake robot, for the thread of one of its tasks.
struct FakeRobotPtr(*const FakeRobot);

// SAFETY: all of a fake robot is `Send`, see `is_send` below, and only the holder of the run token accesses it. The
// token is passed under a lock, so the next holder sees the writes of the previous one.
unsafe impl Send for FakeRobotPtr {}

const fn is_send<T: Send>() {}
const _: () = is_send::<FakeRobot>();

impl FakeRobot {
    /// In preemptive mode, lets another task run if one has precedence. Called at the end of a call or of a part of a
    /// wait.
    pub(super) fn yield_if_preempted(&self) -> Result<(), Stop> {
        let is_preempted = {
            let state = &mut *self.state.borrow_mut();
            state.tasks.is_preemption_on() && !state.is_in_callback && state.update_preemption()
        };
        if is_preempted { self.run_next() } else { Ok(()) }
    }

    /// Time until which the running task keeps the processor: `until_us`, or an earlier end of its time slice.
    pub(super) fn slice_end(&self, until_us: u64) -> u64 {
        let state = self.state.borrow();
        if state.tasks.is_preemption_on() && !state.is_in_callback {
            until_us.min(state.tasks.slice_end_us.max(state.now_us))
        } else {
            until_us
        }
    }

    /// Lets the next task run; returns when this task runs again.
    fn run_next(&self) -> Result<(), Stop> {
        let next = self.next_task()?;
        self.switch(next)
    }

    /// The next task to run; advances virtual time until one is ready.
    fn next_task(&self) -> Result<usize, Stop> {
        loop {
            let until_us = {
                let state = &mut *self.state.borrow_mut();
                let now_us = state.now_us;
                state.tasks.wake(now_us);
                if let Some(next) = state.tasks.next() {
                    return Ok(next);
                }
                let wake_us = state.tasks.sleepers().map(|(time_us, _)| time_us).min();
                let timer_us = state.timers.iter().map(|timer| timer.next_us).min();
                let Some(until_us) = wake_us.into_iter().chain(timer_us).min() else {
                    state.is_over = true;
                    let message = state.tasks.deadlock_message();
                    state.failure.get_or_insert(message);
                    return Err(Stop);
                };
                until_us
            };
            self.advance_with_timers(until_us)?;
        }
    }

    fn switch(&self, next: usize) -> Result<(), Stop> {
        let current = {
            let state = &mut *self.state.borrow_mut();
            let current = state.tasks.current;
            if next == current {
                return Ok(());
            }
            state.tasks.switch_to(next, state.now_us);
            current
        };
        self.begin(next);
        self.run_token.pass_to(next);
        self.run_token.wait_for(current);
        let state = self.state.borrow();
        if state.is_over || state.tasks.must_running_task_end() { Err(Stop) } else { Ok(()) }
    }

    /// Body of a task's thread.
    fn run_thread(&self, task: usize) {
        self.run_token.wait_for(task);
        let callback = {
            let state = self.state.borrow();
            (!state.is_over && !state.tasks.has_main_returned).then(|| state.tasks.entries[task].code)
        };
        // SAFETY: the program is in its `run`, in a call in which one of its tasks passed the run token to this one;
        // nothing is borrowed.
        let result = callback.map_or(Ok(()), |callback| unsafe { callback.call() });
        let killer = {
            let state = &mut *self.state.borrow_mut();
            let killer = state.tasks.entries[task].killer.take();
            state.tasks.entries[task].status = Status::Ended;
            state.is_over |= result.is_err() && killer.is_none() && !state.tasks.has_main_returned;
            if state.is_over || state.tasks.has_main_returned { Some(MAIN) } else { killer }
        };
        let next = killer.filter(|killer| *killer != task).unwrap_or_else(|| self.next_task().unwrap_or(MAIN));
        {
            let state = &mut *self.state.borrow_mut();
            state.tasks.switch_to(next, state.now_us);
        }
        self.begin(next);
        self.run_token.pass_to(next);
    }

    /// Starts the thread of a task that has none.
    fn begin(&self, task: usize) {
        let state = &mut *self.state.borrow_mut();
        if !std::mem::replace(&mut state.tasks.entries[task].has_begun, true) {
            let robot = FakeRobotPtr(self);
            // SAFETY: the robot lives until `end_tasks` has joined the thread.
            let body = move || unsafe { (*{ robot }.0).run_thread(task) };
            let name = state.tasks.entries[task].name.replace('\0', "");
            let thread = std::thread::Builder::new().name(name).spawn(body).expect("the system has room for a thread");
            state.tasks.threads.push(thread);
        }
    }

    /// Ends all tasks after `main` has returned, and joins their threads.
    pub(super) fn end_tasks(&self) {
        let count = {
            let state = &mut *self.state.borrow_mut();
            state.tasks.has_main_returned = true;
            state.tasks.entries.len()
        };
        for task in 1..count {
            let is_alive = {
                let state = &mut *self.state.borrow_mut();
                let entry = &state.tasks.entries[task];
                let is_alive = entry.has_begun && entry.status != Status::Ended;
                state.tasks.current = if is_alive { task } else { MAIN };
                is_alive
            };
            if is_alive {
                self.run_token.pass_to(task);
                self.run_token.wait_for(MAIN);
            }
        }
        let threads = std::mem::take(&mut self.state.borrow_mut().tasks.threads);
        threads.into_iter().for_each(|thread| drop(thread.join()));
    }

    /// Sets the status of the running task and lets the next task run; fails inside a timer's function, which must not
    /// wait.
    fn block(&self, name: &str, status: Status) -> Result<(), Stop> {
        {
            let state = &mut *self.state.borrow_mut();
            if state.is_in_callback {
                return Err(state.refuse_wait(name));
            }
            let current = state.tasks.current;
            state.tasks.entries[current].status = status;
        }
        self.run_next()
    }

    pub(super) fn start_tasks(&self, mode: u8) -> Result<i32, Stop> {
        self.act(|state| {
            let mode = i32::from(mode);
            if state.tasks.mode.is_some() || ![COOP, PREEMPT].contains(&mode) {
                return -1;
            }
            state.tasks.mode = Some(mode);
            0
        })
    }

    pub(super) fn task_mode(&self) -> Result<i32, Stop> {
        self.act(|state| state.tasks.mode.unwrap_or(NOTASK))
    }

    pub(super) fn spawn_task(&self, name: Option<&[u8]>, code: Callback, priority: i32, uid: i32) -> Result<i32, Stop> {
        self.act(|state| {
            if state.tasks.mode.is_none() || !(MIN_PRI..=MAX_PRI).contains(&priority) {
                return 0;
            }
            state.tasks.entries.push(TaskEntry {
                name: String::from_utf8_lossy(name.unwrap_or_default()).into_owned(),
                priority,
                uid,
                code,
                status: Status::Ready,
                is_suspended: true,
                ready_order: 0,
                has_begun: false,
                killer: None,
            });
            state.tasks.entries.len() as i32 - 1
        })
    }

    pub(super) fn ready_task(&self, number: i32) -> Result<i32, Stop> {
        let code = self.act(|state| match state.tasks.index(number) {
            Some(task) if state.tasks.mode.is_some() => {
                let entry = &mut state.tasks.entries[task];
                if std::mem::take(&mut entry.is_suspended) && entry.status == Status::Ready {
                    state.tasks.make_ready(task);
                }
                0
            }
            _ => -1,
        })?;
        self.yield_if_preempted()?;
        Ok(code)
    }

    pub(super) fn suspend_task(&self, name: &str, number: i32) -> Result<i32, Stop> {
        enum Target {
            None,
            Running,
            Other,
        }
        let target = self.act(|state| {
            let task = state.tasks.index(number).filter(|_| state.tasks.mode.is_some());
            let Some(task) = task else { return Target::None };
            state.tasks.entries[task].is_suspended = true;
            if task == state.tasks.current { Target::Running } else { Target::Other }
        })?;
        match target {
            Target::None => return Ok(-1),
            Target::Running => self.block(name, Status::Ready)?,
            Target::Other => {}
        }
        Ok(0)
    }

    pub(super) fn reschedule(&self) -> Result<i32, Stop> {
        let has_tasks = self.act(|state| {
            let current = state.tasks.current;
            state.tasks.make_ready(current);
            state.tasks.mode.is_some()
        })?;
        if !has_tasks {
            return Ok(-1);
        }
        self.block("OSReschedule", Status::Ready)?;
        Ok(0)
    }

    pub(super) fn run_task(&self, number: i32) -> Result<i32, Stop> {
        match self.ready_task(number)? {
            0 => self.reschedule(),
            code => Ok(code),
        }
    }

    pub(super) fn task_uid(&self, number: i32) -> Result<i32, Stop> {
        self.act(|state| state.tasks.index(number).map_or(0, |task| state.tasks.entries[task].uid))
    }

    pub(super) fn kill_task(&self, number: i32) -> Result<i32, Stop> {
        enum Target {
            None,
            NotBegun,
            Running,
            Other(usize),
        }
        let target = self.act(|state| {
            let current = state.tasks.current;
            let Some(task) = state.tasks.index(number).filter(|task| *task != MAIN) else { return Target::None };
            state.tasks.semaphores.iter_mut().for_each(|semaphore| semaphore.waiting.retain(|waiter| *waiter != task));
            if !state.tasks.entries[task].has_begun {
                state.tasks.entries[task].status = Status::Ended;
                return Target::NotBegun;
            }
            state.tasks.entries[task].killer = Some(current);
            if task == current { Target::Running } else { Target::Other(task) }
        })?;
        match target {
            Target::None => Ok(-1),
            Target::NotBegun => Ok(0),
            Target::Running => Err(Stop),
            Target::Other(task) => {
                self.switch(task)?;
                Ok(0)
            }
        }
    }

    pub(super) fn sleep_task(&self, hundredths: i32) -> Result<i32, Stop> {
        let end_us = self.act(|state| state.now_us + hundredths.max(0) as u64 * TIMER_TICK_US)?;
        self.sleep_until("OSSleep", end_us)
    }

    /// Waits until `end_us` while other tasks run.
    pub(super) fn sleep_until(&self, call: &'static str, end_us: u64) -> Result<i32, Stop> {
        let has_tasks = self.state.borrow().tasks.mode.is_some();
        if has_tasks {
            self.block(call, Status::AsleepUntil(end_us))?;
        } else {
            self.wait(call, Some(end_us))?;
        }
        Ok(0)
    }

    pub(super) fn permit_tasks(&self, is_permitted: bool) -> Result<i32, Stop> {
        let code = self.act(|state| {
            state.tasks.is_permitted = is_permitted;
            if state.tasks.mode.is_some() { 0 } else { -1 }
        })?;
        self.yield_if_preempted()?;
        Ok(code)
    }

    pub(super) fn make_semaphore(&self, permits: i32) -> Result<Option<i32>, Stop> {
        self.act(|state| {
            if permits < 0 {
                return None;
            }
            state.tasks.semaphores.push(Semaphore { permits, waiting: VecDeque::new() });
            Some(state.tasks.semaphores.len() as i32)
        })
    }

    pub(super) fn take_permit(&self, number: i32) -> Result<i32, Stop> {
        let outcome = self.act(|state| {
            let current = state.tasks.current;
            let (index, semaphore) = state.tasks.semaphore(number)?;
            if semaphore.permits > 0 {
                semaphore.permits -= 1;
                return Some(None);
            }
            if !state.is_in_callback {
                semaphore.waiting.push_back(current);
            }
            Some(Some(index))
        })?;
        match outcome {
            None => Ok(-1),
            Some(None) => Ok(0),
            Some(Some(index)) => self.block("OSSemP", Status::AtSemaphore(index)).map(|()| 0),
        }
    }

    /// Returns a permit, also for a task that is ending, whose destructors return its permits.
    pub(super) fn return_permit(&self, number: i32) -> Result<i32, Stop> {
        let is_ending = {
            let state = self.state.borrow();
            state.is_over || state.tasks.must_running_task_end()
        };
        if !is_ending {
            self.act(|_| ())?;
        }
        let code = {
            let state = &mut *self.state.borrow_mut();
            match state.tasks.semaphore(number) {
                None => -1,
                Some((_, semaphore)) => {
                    match semaphore.waiting.pop_front() {
                        Some(task) => state.tasks.make_ready(task),
                        None => semaphore.permits += 1,
                    }
                    0
                }
            }
        };
        if is_ending {
            return Err(Stop);
        }
        self.yield_if_preempted()?;
        Ok(code)
    }
}
