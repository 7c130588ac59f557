//! Multi-tasking: tasks of RoBIOS 6 and their semaphores.
//!
//! Source: RoBIOS 6 library, multi-tasking; `docs/tasks.md` describes our choices where the source is silent.

use parking_lot::MutexGuard;
use robios_sys::robios6::{COOP, MAX_PRI, MIN_PRI, NOTASK, PREEMPT};
use robios_sys::{Callback, Robios6Call as Call, Stop};
use sim_core::time::Time;

use super::call;
use super::caller::{Caller, Poll};
use super::flow::Flow;
use super::robot::{Ending, Robot, Wait, WaitReason};
use super::task::scheduler::{Policy, Scheduler};
use super::task::semaphore::{PassOutcome, Semaphore};
use super::task::{MAIN, MAX_TASKS, Origin, Task};
use super::text;
use crate::program::site::Site;

/// Maximum stack that a task may request, in bytes; the stack of each task is twice as large as this maximum.
const MAX_STACK: i32 = 4 << 20;

/// Maximum length of the name of a task, in characters; the rest is cut.
const MAX_NAME: usize = 40;

/// Arguments of `OSSpawn`.
pub struct Spawn<'a> {
    /// Name of the task in messages.
    pub name: Option<&'a [u8]>,
    /// Function that the task runs.
    pub code: Option<Callback>,
    /// Minimum size of the task's stack in bytes.
    pub stack_bytes: i32,
    /// Priority, 1 to 8.
    pub priority: i32,
    /// The program's own number for the task.
    pub uid: i32,
}

/// Outcome of a call that acts on tasks.
enum Answer {
    /// The call returns the contained value, once it is the calling task's turn.
    Returned(i32),
    /// The calling task is suspended; the call returns 0 when the task is ready again.
    Suspended,
}

impl<F: Flow> Caller<F> {
    /// `OSSpawn`
    pub(super) fn create_task(&self, spawn: &Spawn<'_>) -> Result<i32, Stop> {
        let site = self.flow().call_site();
        let call = Call::OSSpawn.into();
        self.run_in_call(call, |caller| {
            let mut robot = caller.spend(call)?;
            let task = add_task(&mut robot, spawn, site.clone());
            caller.note_hints(&mut robot, Some(&site));
            drop(robot);
            let Some(task) = task else { return Ok(0) };
            let code = spawn.code.unwrap_or(Callback::NONE);
            if let Err(error) = caller.flow().start_task(task, code) {
                let mut robot = caller.robot();
                robot.tasks.forget(task);
                robot.refuse_call(Call::OSSpawn, 0, |_| format!("the system has no room for a task: {error}"));
                caller.note_hints(&mut robot, Some(&site));
                return Ok(0);
            }
            caller.take_turns(caller.robot(), call)?;
            Ok(task.cast_signed())
        })
    }

    /// `OSSuspend`
    pub(super) fn suspend_task(&self, task: i32) -> Result<i32, Stop> {
        self.call_on_tasks(Call::OSSuspend, |robot| {
            let number = match find_task(robot, Call::OSSuspend, task) {
                Ok(number) => number,
                Err(answer) => return Answer::Returned(answer),
            };
            if number == robot.tasks.current().number {
                return Answer::Suspended;
            }
            change_scheduler(robot, |scheduler| scheduler.suspend(number));
            Answer::Returned(0)
        })
    }

    /// `OSYield`
    pub(super) fn yield_task(&self) -> Result<i32, Stop> {
        self.call_on_tasks(Call::OSYield, |robot| match is_started(robot, Call::OSYield) {
            true => Answer::Suspended,
            false => Answer::Returned(-1),
        })
    }

    /// `OSReschedule`
    pub(super) fn reschedule(&self) -> Result<i32, Stop> {
        self.call_on_tasks(Call::OSReschedule, |robot| {
            let is_started = is_started(robot, Call::OSReschedule);
            if is_started && can_yield(robot, Call::OSReschedule) {
                change_scheduler(robot, Scheduler::reschedule);
            }
            Answer::Returned(if is_started { 0 } else { -1 })
        })
    }

    /// `OSRun`
    pub(super) fn run_task(&self, task: i32) -> Result<i32, Stop> {
        self.call_on_tasks(Call::OSRun, |robot| {
            let answer = make_ready(robot, Call::OSRun, task);
            if answer == 0 && can_yield(robot, Call::OSRun) {
                change_scheduler(robot, Scheduler::reschedule);
            }
            Answer::Returned(answer)
        })
    }

    /// `OSKill`
    pub(super) fn kill_task(&self, task: i32) -> Result<i32, Stop> {
        let site = self.flow().call_site();
        let call = call::Call::from(Call::OSKill);
        self.run_in_call(call, |caller| {
            let mut robot = caller.spend(call)?;
            let found = find_task(&mut robot, Call::OSKill, task);
            caller.note_hints(&mut robot, Some(&site));
            let number = match found {
                Ok(number) => number,
                Err(answer) => return Ok(answer),
            };
            let is_caller = number == robot.tasks.current().number;
            if number == MAIN && !(is_caller && robot.timers.in_callback) {
                robot.ending.get_or_insert(Ending::Exited { code: 0 });
                return Err(Stop);
            }
            if is_caller {
                return caller.end_task(robot).map(|()| 0);
            }
            if robot.tasks.find(number.cast_signed()).is_some_and(Task::is_unwinding) {
                return Ok(0);
            }
            let now = robot.now;
            robot.tasks.kill(now, number);
            let robot = caller.switch_to(robot, number)?;
            caller.take_turns(robot, call)?;
            Ok(0)
        })
    }

    /// `OSExit`
    pub(super) fn exit(&self, code: i32) -> Result<i32, Stop> {
        let call = call::Call::from(Call::OSExit);
        self.run_in_call(call, |caller| {
            let mut robot = caller.spend(call)?;
            if robot.tasks.scheduler().is_none() || robot.tasks.current().number == MAIN {
                super::os::exit(&mut robot, code);
                return Err(Stop);
            }
            caller.end_task(robot).map(|()| 0)
        })
    }

    /// Ends the calling task by [`Stop`]; the other tasks continue. Does nothing if the task is ending already.
    fn end_task(&self, mut robot: MutexGuard<'_, Robot>) -> Result<(), Stop> {
        if robot.tasks.current().is_unwinding() {
            return Ok(());
        }
        if robot.timers.in_callback {
            let name = robot.tasks.name(robot.tasks.current().number);
            let location = self.location_suffix(&self.flow().call_site());
            return Err(self.fail(robot, format!("a timer's function would end {name}, which it interrupts{location}")));
        }
        let (now, number) = (robot.now, robot.tasks.current().number);
        robot.tasks.kill(now, number);
        robot.tasks.take_kill();
        Err(Stop)
    }

    /// `OSSemInit`
    pub(super) fn make_semaphore(&self, mut semaphore: Option<&mut i32>, count: i32) -> Result<i32, Stop> {
        let site = self.flow().call_site();
        self.call(Call::OSSemInit, |robot, _| make_semaphore(robot, semaphore.as_deref_mut(), count, site.clone()))
    }

    /// `OSSemP`
    pub(super) fn pass_semaphore(&self, semaphore: i32) -> Result<i32, Stop> {
        let site = self.flow().call_site();
        let number = u32::try_from(semaphore).unwrap_or(0);
        self.wait(Call::OSSemP, |robot, _| {
            // A timer callback is not a task: it cannot wait in a queue.
            let is_task = !robot.timers.in_callback;
            let tasks = &mut robot.tasks;
            let outcome = if is_task { tasks.pass_semaphore(number, &site) } else { tasks.semaphores.try_pass(number) };
            match outcome {
                PassOutcome::Passed => Poll::Ready(0),
                PassOutcome::Closed => Poll::Pending { at: Time::NEVER, reason: WaitReason::Semaphore(number) },
                PassOutcome::Unknown => Poll::Ready(refuse_unknown_semaphore(robot, Call::OSSemP)),
            }
        })
    }

    /// Carries out a call that acts on tasks, after which it may be another task's turn.
    fn call_on_tasks(&self, call: Call, act: impl FnOnce(&mut Robot) -> Answer) -> Result<i32, Stop> {
        let site = self.flow().call_site();
        let call = call::Call::from(call);
        self.run_in_call(call, |caller| {
            let mut robot = caller.spend(call)?;
            let answer = act(&mut robot);
            caller.note_hints(&mut robot, Some(&site));
            match answer {
                Answer::Returned(answer) => caller.take_turns(robot, call).map(|()| answer),
                Answer::Suspended if robot.timers.in_callback => Err(caller.fail_in_callback(robot, (call, &site))),
                Answer::Suspended if robot.tasks.current().is_unwinding() => Err(caller.fail_in_unwinding(robot, call)),
                Answer::Suspended => {
                    let (now, number) = (robot.now, robot.tasks.current().number);
                    robot.tasks.note_suspension(Wait { call, reason: WaitReason::Ready, since: now, site });
                    change_scheduler(&mut robot, |scheduler| scheduler.suspend(number));
                    let mut robot = caller.await_turn(robot)?;
                    robot.tasks.end_wait();
                    Ok(0)
                }
            }
        })
    }

    /// Fails the program: a killed task waits before it has ended.
    pub(super) fn fail_in_unwinding(&self, robot: MutexGuard<'_, Robot>, call: call::Call) -> Stop {
        let name = robot.tasks.name(robot.tasks.current().number);
        self.fail(robot, format!("{name} was killed and would wait in {} before it has ended", call.description()))
    }

    /// Fails the program: none of its tasks can continue.
    pub(super) fn end_deadlock(&self, robot: MutexGuard<'_, Robot>) -> Stop {
        let reason = format!("deadlock: {}", self.flow().waits_of(&robot));
        self.fail(robot, reason)
    }
}

impl Robot {
    /// Returns true if every task waits for another task, and no timer callback is attached that could wake a task.
    pub(super) fn is_deadlocked(&self) -> bool {
        let is_blocked = |number| self.tasks.scheduler().is_none_or(|scheduler| !scheduler.is_ready(number));
        self.timers.next_due() == Time::NEVER && self.tasks.iter().all(|task| is_blocked(task.number))
    }
}

/// `OSMTInit`
pub fn start(robot: &mut Robot, mode: u8) -> i32 {
    let policy = match i32::from(mode) {
        COOP => Policy::Coop,
        PREEMPT => Policy::Preempt { is_permitted: false },
        _ => {
            return robot
                .refuse_call(Call::OSMTInit, -1, |_| format!("mode {mode} is neither COOP (0) nor PREEMPT (1)"));
        }
    };
    let now = robot.now;
    if robot.tasks.start(now, policy) {
        return 0;
    }
    robot.refuse_call(Call::OSMTInit, -1, |robot| {
        let is_started = robot.tasks.scheduler().is_some();
        let reason = if is_started { "multi-tasking was started before" } else { "the program has threads already" };
        reason.to_owned()
    })
}

/// `OSMTStatus`
pub fn status(robot: &Robot) -> i32 {
    match robot.tasks.scheduler().map(Scheduler::policy) {
        None => NOTASK,
        Some(Policy::Coop) => COOP,
        Some(Policy::Preempt { .. }) => PREEMPT,
    }
}

/// `OSReady`, `OSRun`
pub fn make_ready(robot: &mut Robot, call: Call, task: i32) -> i32 {
    match find_task(robot, call, task) {
        Ok(number) => {
            change_scheduler(robot, |scheduler| scheduler.make_ready(number));
            0
        }
        Err(answer) => answer,
    }
}

/// `OSPermit`, `OSForbid`
pub fn set_preemption(robot: &mut Robot, call: Call, is_permitted: bool) -> i32 {
    if !is_started(robot, call) {
        return -1;
    }
    change_scheduler(robot, |scheduler| scheduler.set_preemption(is_permitted));
    0
}

/// `OSGetUID`
pub fn uid(robot: &mut Robot, task: i32) -> i32 {
    match robot.tasks.find(task) {
        Some(task) => task.origin.uid,
        None => {
            robot.refuse_call(Call::OSGetUID, 0, |_| "its argument is not a task, or the task has ended".to_owned())
        }
    }
}

/// `OSSemV`
pub fn release_semaphore(robot: &mut Robot, semaphore: i32) -> i32 {
    let number = u32::try_from(semaphore).unwrap_or(0);
    let now = robot.now;
    robot.tasks.scheduler_at(now);
    if robot.tasks.semaphores.get(number).is_none() {
        return refuse_unknown_semaphore(robot, Call::OSSemV);
    }
    if robot.tasks.release_semaphore(number) {
        return 0;
    }
    robot.refuse_call(Call::OSSemV, -1, |_| format!("semaphore {number} cannot count beyond {}", i32::MAX))
}

fn refuse_unknown_semaphore(robot: &mut Robot, call: Call) -> i32 {
    robot.refuse_call(call, -1, |_| "its argument is not a semaphore that `OSSemInit` has initialised".to_owned())
}

fn make_semaphore(robot: &mut Robot, semaphore: Option<&mut i32>, count: i32, site: Site) -> i32 {
    let Some(pointer) = semaphore else {
        return robot.refuse_call(Call::OSSemInit, -1, |_| "the semaphore is a null pointer".to_owned());
    };
    if count < 0 {
        return robot
            .refuse_call(Call::OSSemInit, -1, |_| format!("{count} tasks cannot pass: the count is 0 or more"));
    }
    let previous = u32::try_from(*pointer).unwrap_or(0);
    if robot.tasks.semaphores.get(previous).is_some_and(Semaphore::has_waiters) {
        robot.hint(&format!(
            "`OSSemInit` initialises semaphore {previous} again: the tasks that wait for it never continue"
        ));
    }
    match robot.tasks.semaphores.create(count, site) {
        Some(number) => {
            *pointer = number.cast_signed();
            0
        }
        None => robot.refuse_call(Call::OSSemInit, -1, |_| "there are too many semaphores".to_owned()),
    }
}

/// Adds the task that `OSSpawn` requests and returns its number; `None` if the request is refused.
fn add_task(robot: &mut Robot, spawn: &Spawn<'_>, site: Site) -> Option<u32> {
    let Spawn { stack_bytes, priority, uid, .. } = *spawn;
    let reason = if robot.tasks.scheduler().is_none() {
        Some(NOT_STARTED.to_owned())
    } else if spawn.code.is_none() {
        Some("the task's function is a null pointer".to_owned())
    } else if !(MIN_PRI..=MAX_PRI).contains(&priority) {
        Some(format!("priority {priority} is not within MIN_PRI ({MIN_PRI}) and MAX_PRI ({MAX_PRI})"))
    } else if !(0..=MAX_STACK).contains(&stack_bytes) {
        Some(format!("a stack of {stack_bytes} bytes is not within 0 and {MAX_STACK}"))
    } else {
        None
    };
    if let Some(reason) = reason {
        robot.refuse_call(Call::OSSpawn, 0, |_| reason);
        return None;
    }
    let name = text(spawn.name.unwrap_or_default()).chars().take(MAX_NAME).collect();
    let now = robot.now;
    let task = robot.tasks.create(now, Origin { name, uid, site }, priority as usize);
    if task.is_none() {
        robot.refuse_call(Call::OSSpawn, 0, |_| format!("a robot has at most {MAX_TASKS} tasks"));
    }
    task
}

/// Number of the task that a program passes; 0 is the calling task.
fn find_task(robot: &mut Robot, call: Call, task: i32) -> Result<u32, i32> {
    if !is_started(robot, call) {
        return Err(-1);
    }
    let number = robot.tasks.find(task).map(|task| task.number);
    number
        .ok_or_else(|| robot.refuse_call(call, -1, |_| "its argument is not a task, or the task has ended".to_owned()))
}

const NOT_STARTED: &str = "there is no multi-tasking before `OSMTInit`";

/// Returns true if multi-tasking has been started; otherwise refuses the call.
fn is_started(robot: &mut Robot, call: Call) -> bool {
    let is_started = robot.tasks.scheduler().is_some();
    if !is_started {
        robot.refuse_call(call, -1, |_| NOT_STARTED.to_owned());
    }
    is_started
}

/// Returns true if the calling task can yield. A timer callback, which belongs to no task, and a task that is ending
/// cannot.
fn can_yield(robot: &mut Robot, call: Call) -> bool {
    if robot.timers.in_callback {
        robot.skip_call(call, |_| "a timer's function cannot yield".to_owned());
    }
    !robot.timers.in_callback && !robot.tasks.current().is_unwinding()
}

/// Applies `change` to the scheduler, if there is one.
fn change_scheduler(robot: &mut Robot, change: impl FnOnce(&mut Scheduler)) {
    let now = robot.now;
    if let Some(scheduler) = robot.tasks.scheduler_at(now) {
        change(scheduler);
    }
}
