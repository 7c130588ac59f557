//! Tasks of a fake robot: each on its own thread, one at a time.
//!
//! The running task is chosen within calls, by priority and by the order of becoming ready, never by the operating system.

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
    list: Vec<TaskEntry>,
    current: usize,
    slice_end_us: u64,
    /// Number of transitions to ready so far.
    ready_count: u64,
    semaphores: Vec<Semaphore>,
    threads: Vec<JoinHandle<()>>,
    /// `main` has returned: the other tasks must end.
    is_leaving: bool,
}

struct TaskEntry {
    name: String,
    priority: i32,
    uid: i32,
    code: Callback,
    status: Status,
    /// Order of becoming ready: lower is earlier.
    ready_order: u64,
    has_begun: bool,
    /// The task that has killed this one, and resumes when this one has ended.
    killer: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Status {
    Ready,
    Suspended,
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
            ready_order: 0,
            has_begun: true,
            killer: None,
        };
        Self {
            mode: None,
            is_permitted: false,
            list: vec![main],
            current: MAIN,
            slice_end_us: TIMER_TICK_US,
            ready_count: 0,
            semaphores: Vec::new(),
            threads: Vec::new(),
            is_leaving: false,
        }
    }

    /// Returns true if the running task must end.
    pub(super) fn is_leaving(&self) -> bool {
        self.is_leaving || self.list[self.current].killer.is_some()
    }

    fn rotates(&self) -> bool {
        self.mode == Some(PREEMPT) && self.is_permitted
    }

    fn make_ready(&mut self, task: usize) {
        if self.list[task].status == Status::Ended {
            return;
        }
        self.ready_count += 1;
        self.list[task].status = Status::Ready;
        self.list[task].ready_order = self.ready_count;
    }

    /// Makes the tasks ready whose sleep is over.
    fn wake(&mut self, now_us: u64) {
        let mut due: Vec<(u64, usize)> = self.sleepers().filter(|(time_us, _)| *time_us <= now_us).collect();
        due.sort_unstable();
        due.into_iter().for_each(|(_, task)| self.make_ready(task));
    }

    fn sleepers(&self) -> impl Iterator<Item = (u64, usize)> {
        self.list.iter().enumerate().filter_map(|(index, task)| match task.status {
            Status::AsleepUntil(time_us) => Some((time_us, index)),
            _ => None,
        })
    }

    /// The ready task of the highest priority; ties go to the one that has been ready longest.
    fn next(&self) -> Option<usize> {
        let ready = self.list.iter().enumerate().filter(|(_, task)| task.status == Status::Ready);
        ready.min_by_key(|(_, task)| (-task.priority, task.ready_order)).map(|(index, _)| index)
    }

    fn switch_to(&mut self, task: usize, now_us: u64) {
        self.current = task;
        self.slice_end_us = now_us / TIMER_TICK_US * TIMER_TICK_US + TIMER_TICK_US;
    }

    /// Index of a task by its number, 0 for the running task; `None` if the task has ended.
    fn index(&self, number: i32) -> Option<usize> {
        let index = if number == 0 { self.current } else { usize::try_from(number).ok()? };
        self.list.get(index).filter(|task| task.status != Status::Ended).map(|_| index)
    }

    fn semaphore(&mut self, number: i32) -> Option<(usize, &mut Semaphore)> {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        self.semaphores.get_mut(index).map(|semaphore| (index, semaphore))
    }

    /// Message that names what each task waits for.
    fn deadlock_message(&self) -> String {
        let waiting = self.list.iter().filter(|task| task.status != Status::Ended);
        let parts = waiting.map(|task| match task.status {
            Status::AtSemaphore(index) => format!("`{}` waits at semaphore {}", task.name, index + 1),
            _ => format!("`{}` is suspended", task.name),
        });
        format!("no task can run: {}", parts.collect::<Vec<_>>().join(", "))
    }
}

impl State {
    fn is_preempted(&mut self) -> bool {
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

// SAFETY: all of a fake robot is `Send`, see `is_send` below, and only the holder of the run token accesses it. The token is
// passed under a lock, so the next holder sees the writes of the previous one.
unsafe impl Send for FakeRobotPtr {}

const fn is_send<T: Send>() {}
const _: () = is_send::<FakeRobot>();

impl FakeRobot {
    /// Lets another task run in preemptive mode, at the end of a call or of a part of a wait.
    pub(super) fn turn(&self) -> Result<(), Stop> {
        let is_preempted = {
            let state = &mut *self.state.borrow_mut();
            state.tasks.rotates() && !state.is_in_callback && state.is_preempted()
        };
        if is_preempted { self.run_next() } else { Ok(()) }
    }

    /// Time until which the running task keeps the processor while it waits for `until_us`.
    pub(super) fn slice(&self, until_us: u64) -> u64 {
        let state = self.state.borrow();
        if state.tasks.rotates() && !state.is_in_callback {
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
            self.pass(until_us)?;
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
        if state.is_over || state.tasks.is_leaving() { Err(Stop) } else { Ok(()) }
    }

    /// Body of a task's thread.
    fn run_thread(&self, task: usize) {
        self.run_token.wait_for(task);
        let code = {
            let state = self.state.borrow();
            (!state.is_over && !state.tasks.is_leaving).then(|| state.tasks.list[task].code)
        };
        // SAFETY: the program is in its `run`, in a call in which one of its tasks passed the run token to this one; nothing is borrowed.
        let result = code.map_or(Ok(()), |code| unsafe { code.call() });
        let killer = {
            let state = &mut *self.state.borrow_mut();
            let killer = state.tasks.list[task].killer.take();
            state.tasks.list[task].status = Status::Ended;
            state.is_over |= result.is_err() && killer.is_none() && !state.tasks.is_leaving;
            if state.is_over || state.tasks.is_leaving { Some(MAIN) } else { killer }
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
        if !std::mem::replace(&mut state.tasks.list[task].has_begun, true) {
            let robot = FakeRobotPtr(self);
            // SAFETY: the robot lives until `end_tasks` has joined the thread.
            let life = move || unsafe { (*{ robot }.0).run_thread(task) };
            let name = state.tasks.list[task].name.replace('\0', "");
            let thread = std::thread::Builder::new().name(name).spawn(life).expect("the system has room for a thread");
            state.tasks.threads.push(thread);
        }
    }

    /// Ends all tasks after `main` has returned, and joins their threads.
    pub(super) fn end_tasks(&self) {
        let count = {
            let state = &mut *self.state.borrow_mut();
            state.tasks.is_leaving = true;
            state.tasks.list.len()
        };
        for task in 1..count {
            let is_there = {
                let state = &mut *self.state.borrow_mut();
                let it = &state.tasks.list[task];
                let is_there = it.has_begun && it.status != Status::Ended;
                state.tasks.current = if is_there { task } else { MAIN };
                is_there
            };
            if is_there {
                self.run_token.pass_to(task);
                self.run_token.wait_for(MAIN);
            }
        }
        let threads = std::mem::take(&mut self.state.borrow_mut().tasks.threads);
        threads.into_iter().for_each(|thread| drop(thread.join()));
    }

    /// Suspends the running task with a status; fails inside a timer's function, which must not wait.
    fn block(&self, name: &str, status: Status) -> Result<(), Stop> {
        {
            let state = &mut *self.state.borrow_mut();
            if state.is_in_callback {
                return Err(state.blocked(name));
            }
            let current = state.tasks.current;
            state.tasks.list[current].status = status;
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
            state.tasks.list.push(TaskEntry {
                name: String::from_utf8_lossy(name.unwrap_or_default()).into_owned(),
                priority,
                uid,
                code,
                status: Status::Suspended,
                ready_order: 0,
                has_begun: false,
                killer: None,
            });
            state.tasks.list.len() as i32 - 1
        })
    }

    pub(super) fn ready_task(&self, number: i32) -> Result<i32, Stop> {
        let code = self.act(|state| match state.tasks.index(number) {
            Some(task) if state.tasks.mode.is_some() => {
                if matches!(state.tasks.list[task].status, Status::Suspended | Status::AsleepUntil(_)) {
                    state.tasks.make_ready(task);
                }
                0
            }
            _ => -1,
        })?;
        self.turn()?;
        Ok(code)
    }

    pub(super) fn suspend_task(&self, name: &str, number: i32) -> Result<i32, Stop> {
        enum Which {
            None,
            Own,
            Other,
        }
        let which = self.act(|state| match state.tasks.index(number) {
            Some(task) if task == state.tasks.current && state.tasks.mode.is_some() => Which::Own,
            Some(task) if !matches!(state.tasks.list[task].status, Status::AtSemaphore(_)) => {
                state.tasks.list[task].status = Status::Suspended;
                Which::Other
            }
            _ => Which::None,
        })?;
        match which {
            Which::None => return Ok(-1),
            Which::Own => self.block(name, Status::Suspended)?,
            Which::Other => {}
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
        self.act(|state| state.tasks.index(number).map_or(0, |task| state.tasks.list[task].uid))
    }

    pub(super) fn kill_task(&self, number: i32) -> Result<i32, Stop> {
        enum Which {
            None,
            Own,
            Other(usize),
        }
        let which = self.act(|state| {
            let current = state.tasks.current;
            let Some(task) = state.tasks.index(number).filter(|task| *task != MAIN) else { return Which::None };
            state.tasks.semaphores.iter_mut().for_each(|semaphore| semaphore.waiting.retain(|it| *it != task));
            if !state.tasks.list[task].has_begun {
                state.tasks.list[task].status = Status::Ended;
                return Which::None;
            }
            state.tasks.list[task].killer = Some(current);
            if task == current { Which::Own } else { Which::Other(task) }
        })?;
        match which {
            Which::None => Ok(if self.state.borrow().tasks.index(number).is_some() { -1 } else { 0 }),
            Which::Own => Err(Stop),
            Which::Other(task) => {
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
        self.turn()?;
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
        let full = self.act(|state| {
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
        match full {
            None => Ok(-1),
            Some(None) => Ok(0),
            Some(Some(index)) => self.block("OSSemP", Status::AtSemaphore(index)).map(|()| 0),
        }
    }

    /// Also carried out for a task that is ending: its destructors return its permits.
    pub(super) fn return_permit(&self, number: i32) -> Result<i32, Stop> {
        let is_left = {
            let state = self.state.borrow();
            state.is_over || state.tasks.is_leaving()
        };
        if !is_left {
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
        if is_left {
            return Err(Stop);
        }
        self.turn()?;
        Ok(code)
    }
}
