//! The robot's virtual time. It replaces `std::time::Instant` and `std::thread::sleep`, which use the host's time.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use std::sync::{Arc, Mutex, TryLockError};
use std::time::Duration;

use robios_sys::robios6::TimerHandle;
use robios_sys::{Callback, Status};

use crate::device::Device;
use crate::error::checked;
use crate::robot::{ProgramState, Tables, locked, release, robios, support};
use crate::{Error, Result, Robot, entry};

/// Period of the grid on which RoBIOS calls timers.
const TIMER_TICK: Duration = Duration::from_millis(10);

/// A time of day on the robot's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct TimeOfDay {
    /// 0 to 23.
    pub hours: u8,
    /// 0 to 59.
    pub minutes: u8,
    /// 0 to 59.
    pub seconds: u8,
    /// 0 to 99.
    pub hundredths: u8,
}

impl Robot {
    /// Virtual time since the robot's start, in whole microseconds.
    #[track_caller]
    pub fn now(&self) -> Duration {
        let now_us: i64 = support!(self, time_us());
        Duration::from_micros(now_us.max(0) as u64)
    }

    /// Lets virtual time pass; parts of a microsecond are rounded up.
    #[track_caller]
    pub fn sleep(&self, span: Duration) {
        let span_us = i64::try_from(span.as_nanos().div_ceil(1000)).unwrap_or(i64::MAX);
        let _: i32 = support!(self, sleep_us(span_us));
    }

    /// Sleeps until a virtual time, counted from the robot's start; returns immediately if this time is past.
    #[track_caller]
    pub fn sleep_until(&self, time: Duration) {
        let now = self.now();
        if time > now {
            self.sleep(time - now);
        }
    }

    /// Ticker for periodic loops: [`Ticker::wait`] waits for the next multiple of the period.
    ///
    /// A period of 0 is taken as 1 us.
    pub fn ticker(&self, period: Duration) -> Ticker {
        Ticker { robot: self.clone(), period_us: period.as_nanos().div_ceil(1000).max(1) as u64 }
    }

    /// Calls a function periodically, until the returned timer is dropped.
    ///
    /// The function runs inside the call that is in progress when the timer is due, and is never re-entered. It must be
    /// short and must not wait. It gets the robot; devices can be moved into it.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// fn count(robot: &Robot) -> Result {
    ///     let mut count = 0;
    ///     let _timer = robot.every(500.millis(), move |robot| {
    ///         count += 1;
    ///         writeln!(robot.lcd(), "{count}");
    ///     })?;
    ///     robot.sleep(2.2.seconds());
    ///     Ok(())
    /// }
    /// # assert_eq!(robios_api::fake::Fake::new().run(count).expect_finished().lcd_line(3), "4");
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if the period is 0 or not a multiple of 10 ms; [`Error::Unavailable`] if there are too
    /// many timers already; [`Error::Unsuitable`] with [multi-tasking](Self::multi_tasking): see
    /// [`Tasks::every`](crate::Tasks::every).
    #[track_caller]
    pub fn every(&self, period: Duration, function: impl FnMut(&Robot) + 'static) -> Result<Timer> {
        let scale = scale_of(period)?;
        let job = TimerJob::new(self, Box::new(function))?;
        let handle = robios!(self, OSAttachTimer(scale, TimerJob::callback(&job)));
        Timer::attached(job, handle, |robot, handle| release!(robot, OSDetachTimer(handle)))
    }

    /// Holds timers back until the guard is dropped, like disabling interrupts.
    #[track_caller]
    pub fn hold_timers(&self) -> TimerGuard {
        let _: i32 = robios!(self, OSDisable());
        TimerGuard { robot: self.clone() }
    }

    /// The robot's clock; it starts at 0:00:00.
    #[track_caller]
    pub fn clock(&self) -> TimeOfDay {
        let (mut hours, mut minutes, mut seconds, mut hundredths) = (0, 0, 0, 0);
        let _: i32 = robios!(self, OSGetTime(&mut hours, &mut minutes, &mut seconds, &mut hundredths));
        let [hours, minutes, seconds, hundredths] =
            [hours, minutes, seconds, hundredths].map(|part: i32| part.clamp(0, 255) as u8);
        TimeOfDay { hours, minutes, seconds, hundredths }
    }

    /// Sets the robot's clock, ignoring the hundredths. Virtual time is not affected.
    ///
    /// # Errors
    /// [`Error::Refused`] for an hour outside 0 to 23, or a minute or second outside 0 to 59.
    #[track_caller]
    pub fn set_clock(&self, time: TimeOfDay) -> Result {
        let code = robios!(self, OSSetTime(time.hours.into(), time.minutes.into(), time.seconds.into()));
        checked("OSSetTime", Device::Clock, code)
    }

    /// Writes the clock to the LCD, at the cursor.
    #[track_caller]
    pub fn show_clock(&self) {
        let _: i32 = robios!(self, OSShowTime());
    }
}

/// Waits for the multiples of a period of virtual time, see [`Robot::ticker`].
#[derive(Clone, Debug)]
pub struct Ticker {
    robot: Robot,
    period_us: u64,
}

impl Ticker {
    /// Waits until the next multiple of the period since the robot's start; missed multiples are skipped.
    #[track_caller]
    pub fn wait(&self) {
        let now_us = self.robot.now().as_micros() as u64;
        self.robot.sleep(Duration::from_micros(self.period_us - now_us % self.period_us));
    }
}

/// Number of timer ticks in a period.
fn scale_of(period: Duration) -> Result<i32> {
    let scale = i32::try_from(period.as_nanos() / TIMER_TICK.as_nanos()).unwrap_or(0);
    if scale == 0 || period != TIMER_TICK * scale as u32 {
        return Err(Error::OutOfRange {
            what: "period of a timer",
            value: format!("{period:?}"),
            accepted: "multiples of 10 ms from 10 ms on",
        });
    }
    Ok(scale)
}

/// A timer of [`Robot::every`]; dropping it ends its calls and frees its function.
#[must_use = "a timer that is dropped calls nothing"]
pub struct Timer {
    robot: Robot,
    handle: TimerHandle,
    /// An `Rc<TimerJob>` or an `Arc<SendTimerJob>`.
    job: Option<Box<dyn Any>>,
    detach: fn(&Robot, TimerHandle) -> bool,
}

impl Timer {
    /// Creates the timer whose job the host has registered under `handle`; a handle of 0 means that there are too many
    /// timers. `detach` unregisters the job and returns true if the host executed the call.
    pub(crate) fn attached(
        job: Rc<TimerJob>,
        handle: TimerHandle,
        detach: fn(&Robot, TimerHandle) -> bool,
    ) -> Result<Self> {
        match handle {
            0 => Err(Error::Unavailable(Device::Timer)),
            handle => Ok(Self { robot: job.robot.clone(), handle, job: Some(Box::new(job)), detach }),
        }
    }

    /// Creates a timer whose function may be called on the thread of any task.
    #[track_caller]
    pub(crate) fn of_any_task(robot: &Robot, period: Duration, function: Box<SendTimerFunction>) -> Result<Self> {
        let scale = scale_of(period)?;
        let Some(tables) = robot.tables() else { return Err(Error::Unavailable(Device::Timer)) };
        let job = Arc::new(SendTimerJob { tables, common: Arc::clone(robot.common()), function: Mutex::new(function) });
        let callback = Callback { code: Some(call_send_job), data: Arc::as_ptr(&job).cast_mut().cast() };
        match robios!(robot, OSAttachTimer(scale, callback)) {
            0 => Err(Error::Unavailable(Device::Timer)),
            handle => {
                let detach = |robot: &Robot, handle: TimerHandle| release!(robot, OSDetachTimer(handle));
                Ok(Self { robot: robot.clone(), handle, job: Some(Box::new(job)), detach })
            }
        }
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        if !(self.detach)(&self.robot, self.handle) {
            // The host may still hold the pointer: the function is leaked.
            std::mem::forget(self.job.take());
        }
    }
}

impl std::fmt::Debug for Timer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Timer").field("handle", &self.handle).finish_non_exhaustive()
    }
}

/// Guard that holds timers back, see [`Robot::hold_timers`].
#[derive(Debug)]
#[must_use = "timers are held back only while it lives"]
pub struct TimerGuard {
    robot: Robot,
}

impl Drop for TimerGuard {
    fn drop(&mut self) {
        release!(&self.robot, OSEnable());
    }
}

/// Function of a timer, with its robot.
pub(crate) struct TimerJob {
    robot: Robot,
    function: RefCell<Box<TimerFunction>>,
}

impl TimerJob {
    pub(crate) fn new(robot: &Robot, function: Box<TimerFunction>) -> Result<Rc<Self>> {
        robot.count_timer()?;
        Ok(Rc::new(Self { robot: robot.clone(), function: RefCell::new(function) }))
    }

    /// The callback for the host; the job must exist until the callback is detached.
    pub(crate) fn callback(job: &Rc<Self>) -> Callback {
        Callback { code: Some(call_job), data: Rc::as_ptr(job).cast_mut().cast() }
    }
}

impl Drop for TimerJob {
    fn drop(&mut self) {
        locked(&self.robot.common().tasks).timers -= 1;
    }
}

/// Function of a timer.
pub(crate) type TimerFunction = dyn FnMut(&Robot);

/// Function of a timer that may be called on the thread of any task.
struct SendTimerJob {
    tables: Tables,
    common: Arc<ProgramState>,
    function: Mutex<Box<SendTimerFunction>>,
}

/// Function of a timer in a program with tasks.
pub(crate) type SendTimerFunction = dyn FnMut(&Robot) + Send;

impl SendTimerJob {
    fn run(&self, robot: &Robot) {
        // See `TimerJob::run`.
        match self.function.try_lock() {
            Ok(mut function) => function(robot),
            Err(TryLockError::Poisoned(function)) => function.into_inner()(robot),
            Err(TryLockError::WouldBlock) => {}
        }
    }
}

impl TimerJob {
    fn run(&self) {
        // The host never nests these calls; a nested call would be skipped.
        if let Ok(mut function) = self.function.try_borrow_mut() {
            function(&self.robot);
        }
    }
}

/// Callback of a timer, called by the host.
///
/// # Safety
/// `data` is the `TimerJob` of a [`Timer`] that has not been detached, on the thread of its robot.
unsafe extern "C" fn call_job(data: *mut c_void) -> Status {
    let job = data.cast_const().cast::<TimerJob>();
    // SAFETY: the timer holds one reference to the job that the pointer came from. A second one keeps the job alive if
    // the function drops its own timer.
    let job = unsafe {
        Rc::increment_strong_count(job);
        Rc::from_raw(job)
    };
    let robot = job.robot.clone();
    catch_failure(&robot, || {
        job.run();
        drop(job);
    })
}

/// Callback of a timer of [`Timer::of_any_task`], called by the host.
///
/// # Safety
/// `data` is the `SendTimerJob` of a [`Timer`] that has not been detached, on the thread of a task of its robot.
unsafe extern "C" fn call_send_job(data: *mut c_void) -> Status {
    let job = data.cast_const().cast::<SendTimerJob>();
    // SAFETY: as in `call_job`.
    let job = unsafe {
        Arc::increment_strong_count(job);
        Arc::from_raw(job)
    };
    let robot = Robot::of_task(job.tables, Arc::clone(&job.common));
    let status = catch_failure(&robot, || {
        job.run(&robot);
        drop(job);
    });
    robot.close();
    status
}

/// Calls a timer's function and catches its panics.
fn catch_failure(robot: &Robot, function: impl FnOnce()) -> Status {
    match catch_unwind(AssertUnwindSafe(function)) {
        Ok(()) => Status::OK,
        Err(payload) => {
            entry::report_callback_panic(robot, payload);
            Status::STOP
        }
    }
}
