//! Entry of a robot's calls into the simulator: the behaviour that all RoBIOS calls share.
//!
//! A call costs virtual time and acts at its end. If its end lies in a later slot, the flow is suspended first. Timer
//! callbacks that become due before the end run inside the call. The other modules of this folder define only the
//! effect of each call.

use std::any::Any;

use parking_lot::MutexGuard;
use robios_sys::{CallContext, CallRecord, Callback, Stop, SupportCall};
use sim_core::time::Time;
use sim_core::world::World;

use super::call::Call;
use super::flow::Flow;
use super::robot::{Ending, Robot, Wait, WaitReason};
use super::task::NextThread;
use super::task::scheduler::NextTask;
use crate::program::site::Site;
use sim_core::record::Event;

/// Handle through which a program makes the calls of its robot.
pub struct Caller<F> {
    flow: F,
}

/// Result of polling the condition of a waiting call.
pub enum Poll<R> {
    /// The wait is over.
    Ready(R),
    /// The wait is not over: poll again at `at` ([`Time::NEVER`] if nothing known can end the wait).
    Pending {
        /// Earliest time at which the condition may hold.
        at: Time,
        /// Reason of the wait, as shown to the user.
        reason: WaitReason,
    },
}

impl<R> Poll<R> {
    /// Maps the result with `change`.
    pub fn map<S>(self, change: impl FnOnce(R) -> S) -> Poll<S> {
        match self {
            Self::Ready(result) => Poll::Ready(change(result)),
            Self::Pending { at, reason } => Poll::Pending { at, reason },
        }
    }
}

impl<F: Flow> Caller<F> {
    /// Creates the handle for the robot of `flow`.
    pub fn new(flow: F) -> Self {
        Self { flow }
    }

    /// The robot's flow in its run.
    pub(super) fn flow(&self) -> &F {
        &self.flow
    }

    /// Lets the call's cost of virtual time pass, then runs `act` at the call's end.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    pub(crate) fn call<R: Copy>(
        &self,
        call: impl Into<Call>,
        mut act: impl FnMut(&mut Robot, &World) -> R,
    ) -> Result<R, Stop> {
        let mut result = Err(Stop);
        self.act(call.into(), &mut |robot, world| result = Ok(act(robot, world)))?;
        result
    }

    /// Implements [`Caller::call`] without its type parameters, so that all calls share the compiled code.
    fn act(&self, call: Call, act: &mut dyn FnMut(&mut Robot, &World)) -> Result<(), Stop> {
        self.run_in_call(call, |caller| {
            let mut robot = caller.spend(call)?;
            caller.flow.run_effect(&mut || act(&mut robot, caller.flow.world()));
            caller.note_hints(&mut robot, None);
            caller.take_turns(robot, call)
        })
    }

    /// Lets the call's cost pass, then calls `poll` at the call's end and whenever the awaited condition may hold.
    ///
    /// # Errors
    /// [`Stop`] if the program must end; waiting inside a timer callback ends the program as failed.
    pub(crate) fn wait<R>(
        &self,
        call: impl Into<Call>,
        mut poll: impl FnMut(&mut Robot, &World) -> Poll<R>,
    ) -> Result<R, Stop> {
        let mut result = None;
        let poll = &mut |robot: &mut Robot, world: &World| poll(robot, world).map(|value| result = Some(value));
        self.wait_polling(call.into(), true, poll)?;
        result.ok_or(Stop)
    }

    /// Calls `poll` now and whenever the awaited condition may hold; only the wait takes virtual time.
    ///
    /// # Errors
    /// See [`Caller::wait`].
    pub(super) fn wait_untimed<R>(
        &self,
        call: SupportCall,
        mut poll: impl FnMut(&mut Robot, &World) -> Poll<R>,
    ) -> Result<R, Stop> {
        let mut result = None;
        let poll = &mut |robot: &mut Robot, world: &World| poll(robot, world).map(|value| result = Some(value));
        self.wait_polling(call.into(), false, poll)?;
        result.ok_or(Stop)
    }

    /// Implements [`Caller::wait`] and [`Caller::wait_untimed`] without their type parameters, so that all calls share
    /// the compiled code. If `has_cost`, the virtual time that `call` costs passes first.
    fn wait_polling(
        &self,
        call: Call,
        has_cost: bool,
        poll: &mut dyn FnMut(&mut Robot, &World) -> Poll<()>,
    ) -> Result<(), Stop> {
        let site = self.flow.call_site();
        self.run_in_call(call, |caller| {
            let robot = if has_cost { caller.spend(call)? } else { caller.robot() };
            caller.wait_in(robot, (call, site), poll)
        })
    }

    /// Waits in `call`, made at `site`, until `poll` is ready; the robot's other tasks run during the wait.
    fn wait_in<'a>(
        &'a self,
        mut robot: MutexGuard<'a, Robot>,
        (call, site): (Call, Site),
        poll: &mut dyn FnMut(&mut Robot, &World) -> Poll<()>,
    ) -> Result<(), Stop> {
        let since = robot.now;
        loop {
            let (polled, wake) = self.poll_once(robot, (call, &site, since), poll)?;
            robot = polled;
            let Some(wake) = wake else { return self.take_turns(robot, call) };
            if robot.tasks.current().is_unwinding() {
                robot = self.pass_until(robot, wake, false)?;
                continue;
            }
            let now = robot.now;
            robot = match robot.tasks.next_thread(now) {
                _ if robot.tasks.scheduler().is_some() => self.await_turn(robot)?,
                NextThread::Same => self.wait_until(robot, wake)?,
                NextThread::Other(task) => self.switch_to(robot, task)?,
            };
            if robot.tasks.take_interrupt() {
                robot.tasks.end_wait();
                return Err(Stop);
            }
        }
    }

    /// Polls the condition that `call`, made at `site`, has awaited since `since`. If the condition is not met, makes
    /// the task wait and returns the time of the next poll. This function is separate so that the stack of a suspended
    /// robot is small: the cache lines of the stack are loaded again in each slot.
    ///
    /// # Errors
    /// [`Stop`] if the task may not wait.
    #[inline(never)]
    fn poll_once<'a>(
        &'a self,
        mut robot: MutexGuard<'a, Robot>,
        (call, site, since): (Call, &Site, Time),
        poll: &mut dyn FnMut(&mut Robot, &World) -> Poll<()>,
    ) -> Result<(MutexGuard<'a, Robot>, Option<Time>), Stop> {
        let polled = poll(&mut robot, self.flow.world());
        self.note_hints(&mut robot, Some(site));
        let Poll::Pending { at, reason } = polled else {
            robot.tasks.end_wait();
            return Ok((robot, None));
        };
        if robot.timers.in_callback {
            return Err(self.fail_in_callback(robot, (call, site)));
        }
        // Virtual time advances by at least 1 us; otherwise a condition whose time has passed is polled forever.
        let (now, wake) = (robot.now, at.max(robot.now + Time(1)));
        if !robot.tasks.current().is_unwinding() {
            robot.tasks.wait(now, Wait { call, reason, since, site: site.clone() }, wake);
        } else if reason.is_for_task() {
            return Err(self.fail_in_unwinding(robot, call));
        }
        Ok((robot, Some(wake)))
    }

    /// Lets virtual time pass until `wake` for a waiting task. Ends the task's wait if a timer callback aborts it and
    /// the program continues.
    fn wait_until<'a>(&'a self, robot: MutexGuard<'a, Robot>, wake: Time) -> Result<MutexGuard<'a, Robot>, Stop> {
        self.pass_until(robot, wake, false).inspect_err(|_| {
            if !self.flow.is_exiting() {
                self.robot().tasks.end_wait();
            }
        })
    }

    /// Ends `call`: if the time slice of its task is over, the other ready tasks run first.
    #[inline]
    pub(super) fn take_turns(&self, robot: MutexGuard<'_, Robot>, call: Call) -> Result<(), Stop> {
        if robot.tasks.is_single() { Ok(()) } else { self.take_turns_among(robot, call) }
    }

    /// Like [`Caller::take_turns`], for a robot that has other tasks.
    #[inline(never)]
    fn take_turns_among(&self, mut robot: MutexGuard<'_, Robot>, call: Call) -> Result<(), Stop> {
        // The program prints inside its C library, whose streams no other task may use until the print ends.
        if call == Call::Support(SupportCall::console) || robot.timers.in_callback {
            return Ok(());
        }
        if robot.tasks.scheduler().is_some() {
            return if robot.tasks.current().is_unwinding() { Ok(()) } else { self.await_turn(robot).map(drop) };
        }
        let now = robot.now;
        match robot.tasks.next_turn(now) {
            Some(task) => self.switch_to(robot, task).map(drop),
            None => Ok(()),
        }
    }

    /// Lets the other ready tasks run first, if it is their turn.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    pub(super) fn yield_if_due(&self, call: SupportCall) -> Result<(), Stop> {
        self.run_in_call(call.into(), |caller| caller.take_turns(caller.robot(), call.into()))
    }

    /// Lets the other ready tasks run first.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    pub(super) fn yield_turn(&self, call: SupportCall) -> Result<(), Stop> {
        self.run_in_call(call.into(), |caller| {
            let robot = caller.spend(call.into())?;
            let mut robot = robot;
            let now = robot.now;
            if !robot.timers.in_callback
                && let Some(scheduler) = robot.tasks.scheduler_at(now)
            {
                scheduler.reschedule();
                return caller.take_turns(robot, call.into());
            }
            match robot.tasks.next_ready(now) {
                Some(task) if !robot.timers.in_callback => caller.switch_to(robot, task).map(drop),
                _ => Ok(()),
            }
        })
    }

    /// Lets other tasks run, and virtual time pass, until it is the calling task's turn; for RoBIOS 6 with
    /// multi-tasking.
    pub(super) fn await_turn<'a>(&'a self, mut robot: MutexGuard<'a, Robot>) -> Result<MutexGuard<'a, Robot>, Stop> {
        loop {
            let now = robot.now;
            let next = robot.tasks.next_task(now);
            robot = match next {
                NextTask::Run(task) if task == robot.tasks.current().number => return Ok(robot),
                NextTask::Run(task) => self.switch_to(robot, task)?,
                NextTask::NotBefore(Time::NEVER) if robot.is_deadlocked() => return Err(self.end_deadlock(robot)),
                NextTask::NotBefore(time) => self.pass_until(robot, time, false)?,
            };
        }
    }

    /// Hands the run token to another task of the robot; returns when the calling task has it back.
    pub(super) fn switch_to<'a>(
        &'a self,
        mut robot: MutexGuard<'a, Robot>,
        task: u32,
    ) -> Result<MutexGuard<'a, Robot>, Stop> {
        let now = robot.now;
        robot.tasks.switch_to(task, now);
        drop(robot);
        self.flow.switch(task);
        let mut robot = self.robot();
        let is_exiting = robot.tasks.is_exiting() || self.flow.is_exiting();
        if is_exiting || robot.tasks.take_kill() { Err(Stop) } else { Ok(robot) }
    }

    /// Starts a further task, which runs `code` at its turn. Returns its number, or 0 if the robot has too many tasks.
    ///
    /// # Errors
    /// [`Stop`] if the system lacks the resources for another task.
    pub(super) fn spawn(&self, call: SupportCall, code: Callback) -> Result<i32, Stop> {
        self.run_in_call(call.into(), |caller| {
            let mut robot = caller.robot();
            let now = robot.now;
            let Some(task) = robot.tasks.spawn(now) else { return Ok(0) };
            drop(robot);
            match caller.flow.start_task(task, code) {
                Ok(()) => Ok(i32::try_from(task).unwrap_or(i32::MAX)),
                Err(error) => {
                    let reason = format!("the system has no room for task {task}: {error}");
                    Err(caller.fail(caller.robot(), reason))
                }
            }
        })
    }

    /// Lets `span` of virtual time pass, for a sleep of the program outside RoBIOS.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    pub(crate) fn sleep(&self, span: Time) -> Result<(), Stop> {
        let end = self.act_untimed(SupportCall::sleep_us, |robot| robot.now + span);
        self.wait(SupportCall::sleep_us, |robot, _| {
            if robot.now >= end { Poll::Ready(()) } else { Poll::Pending { at: end, reason: WaitReason::Time(end) } }
        })
    }

    /// Runs `act` without virtual time, even for a program that must stop. Meanwhile the thread is marked as executing
    /// host code, so that the watchdog does not park it while it holds the robot's lock.
    pub(crate) fn act_untimed<R>(&self, call: SupportCall, act: impl FnOnce(&mut Robot) -> R) -> R {
        // These lines need almost no stack: they also serve a program whose stack is exhausted.
        self.flow.enter(call.into());
        let mut robot = self.robot();
        let result = act(&mut robot);
        self.note_hints(&mut robot, None);
        drop(robot);
        self.flow.leave();
        result
    }

    /// Records the line of the program at which hints were given in the call in progress; `site` is the location of the
    /// call, if known.
    #[inline]
    pub(super) fn note_hints(&self, robot: &mut Robot, site: Option<&Site>) {
        if !robot.new_hints.is_empty() {
            let site = site.cloned().unwrap_or_else(|| self.flow.call_site());
            std::mem::take(&mut robot.new_hints).iter().for_each(|text| self.flow.note_hint(text, &site));
        }
    }

    /// Fails the program: `call`, made at `site`, would wait inside a timer callback.
    pub(super) fn fail_in_callback(&self, robot: MutexGuard<'_, Robot>, (call, site): (Call, &Site)) -> Stop {
        let location = self.location_suffix(site);
        self.fail(robot, format!("{} would wait inside a timer callback{location}", call.description()))
    }

    /// The location of `site` in the program, for the end of a message: ` at maze.c:88`, or nothing if it is not known.
    pub(super) fn location_suffix(&self, site: &Site) -> String {
        self.flow.location_of(site).map(|line| format!(" at {line}")).unwrap_or_default()
    }

    /// Ends the robot's program as failed, for a reason that is shown to the user.
    pub(crate) fn fail(&self, mut robot: MutexGuard<'_, Robot>, reason: String) -> Stop {
        robot.ending.get_or_insert(Ending::Failed { reason });
        Stop
    }

    /// Locks the state of this caller's robot.
    pub(crate) fn robot(&self) -> MutexGuard<'_, Robot> {
        self.flow.robot()
    }

    /// Runs `body` inside a call of the program. A stopped program gets [`Stop`]; an exhausted stack ends the
    /// program.
    #[inline]
    pub(super) fn run_in_call<R>(&self, call: Call, body: impl FnOnce(&Self) -> Result<R, Stop>) -> Result<R, Stop> {
        if !self.flow.enter(call) {
            return Err(self.overflow(call));
        }
        let result = if self.flow.is_exiting() { Err(Stop) } else { body(self) };
        self.flow.leave();
        result
    }

    /// Refuses the call of a forbidden function: the call costs its time, fails and is recorded. Returns false for any
    /// other function.
    ///
    /// # Errors
    /// [`Stop`] if the program must end.
    #[cold]
    fn refuse_if_forbidden(&self, table: u32, index: usize) -> Result<bool, Stop> {
        let call = Call::of_table(table, index).filter(|call| self.flow.forbidden().contains(*call));
        call.map(|call| self.call(call, |robot, _| robot.record_forbidden(call))).transpose().map(|done| done.is_some())
    }

    /// Ends the program, whose stack is too small for the call.
    #[cold]
    fn overflow(&self, call: Call) -> Stop {
        let robot = self.robot();
        let task = robot.tasks.scheduler().map(|_| robot.tasks.name(robot.tasks.current().number));
        let task = task.map(|task| format!(" of {task}")).unwrap_or_default();
        self.fail(robot, format!("stack overflow in `{}`{task}", call.name()))
    }

    /// Lets the virtual time that `call` costs pass.
    #[inline]
    pub(super) fn spend(&self, call: Call) -> Result<MutexGuard<'_, Robot>, Stop> {
        self.spend_time(self.flow.cost(call))
    }

    /// Lets `span` of virtual time pass, as the work of the call in progress.
    #[inline]
    pub(super) fn spend_time(&self, span: Time) -> Result<MutexGuard<'_, Robot>, Stop> {
        let mut robot = self.robot();
        if robot.ending.is_some() {
            return Err(Stop);
        }
        let end = robot.now + span;
        // The usual case: the call ends in this slot, and nothing becomes due before its end.
        if end < self.flow.slot_end().min(robot.timers.next_due()).min(robot.devices.due()) {
            robot.now = end;
            return Ok(robot);
        }
        self.pass_until(robot, end, true)
    }

    /// Lets virtual time pass until `end`. Runs the timer callbacks that become due before then, and computes the
    /// measurements that sensors complete before then.
    ///
    /// If the time is the call's own work (`is_work`), callbacks delay its end by their duration. Otherwise the robot
    /// waits: the function returns early after each callback, and when the scheduler step may have fulfilled the
    /// awaited condition.
    fn pass_until<'a>(
        &'a self,
        mut robot: MutexGuard<'a, Robot>,
        mut end: Time,
        is_work: bool,
    ) -> Result<MutexGuard<'a, Robot>, Stop> {
        loop {
            let (tick, measured) = (robot.timers.next_due(), robot.devices.due());
            let target = end.min(tick).min(measured).max(robot.now);
            if target >= self.flow.slot_end() {
                drop(robot);
                self.flow.suspend(target)?;
                robot = self.robot();
                if target >= self.flow.slot_end() {
                    // Woken early: the scheduler step may have fulfilled the awaited condition.
                    robot.now = robot.now.max(self.flow.slot_start());
                    let now = robot.now;
                    robot.tasks.recheck_world(now);
                    return Ok(robot);
                }
            }
            robot.now = target;
            if target >= measured {
                robot.settle(self.flow.world());
                continue;
            }
            if tick > end {
                return Ok(robot);
            }
            robot = self.run_timers(robot)?;
            if !is_work {
                return Ok(robot);
            }
            end += robot.now - target;
        }
    }

    /// Runs the callbacks of all timers that are due; they may call RoBIOS, which takes virtual time.
    fn run_timers<'a>(&'a self, mut robot: MutexGuard<'a, Robot>) -> Result<MutexGuard<'a, Robot>, Stop> {
        let now = robot.now;
        let due = robot.timers.take_due(now);
        robot.timers.in_callback = true;
        drop(robot);
        // A callback may detach a timer whose turn is still to come.
        let callback_of = |handle| self.robot().timers.callback(handle);
        let result = due.into_iter().filter_map(callback_of).try_for_each(|callback| self.flow.call_back(callback));
        let mut robot = self.robot();
        let now = robot.now;
        robot.timers.end_callbacks(now);
        robot.timers.was_stopped_in_callback = result.is_err();
        result.map(|()| robot)
    }
}

impl<F: Flow> CallContext for Caller<F> {
    fn is_logging(&self) -> bool {
        self.flow.is_verbose()
    }

    fn log_call(&self, record: &CallRecord<'_>) {
        let arguments = record.arguments.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let result = record.result.map_or_else(|| "stopped".to_owned(), ToString::to_string);
        self.act_untimed(SupportCall::console, |robot| {
            let event = Event::Call { function: record.name, arguments: &arguments, result: &result };
            robot.state.journal.record(robot.state.now, &event);
        });
    }

    #[inline]
    fn forbid(&self, table: u32, index: usize) -> Result<bool, Stop> {
        if self.flow.forbidden().is_empty() { Ok(false) } else { self.refuse_if_forbidden(table, index) }
    }

    fn unavailable(&self, name: &'static str) {
        let text = format!("`{name}` is not simulated: it returns the result of a robot without that device");
        self.act_untimed(SupportCall::console, |robot| robot.hint(&text));
    }

    fn panicked(&self, name: &'static str, _: Box<dyn Any + Send>) {
        let reason = format!("internal error of eyesim in `{name}`");
        self.act_untimed(SupportCall::failed, |robot| {
            robot.ending.get_or_insert(Ending::Failed { reason });
        });
    }
}
