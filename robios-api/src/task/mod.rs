//! Multi-tasking: several tasks of one program, one of which runs at a time.
//!
//! Memory safety does not depend on the schedule: a task's function and the values that it shares are `Send`, each task
//! has its own [`Robot`], which no other task can reach, and shared values are locked.

mod semaphore;
mod shared;

pub use semaphore::{Permit, Semaphore};
pub use shared::{Shared, SharedGuard};

use std::ffi::c_void;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

use robios_sys::robios6::{COOP, PREEMPT};
use robios_sys::{ByteSlice, Callback, Status};

use crate::device::Device;
use crate::entry::{self, Outcome};
use crate::error::checked;
use crate::robot::{ProgramState, Tables, locked, release, robios};
use crate::time::Timer;
use crate::{Error, Result, Robot};

/// Scheduling mode of the tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskMode {
    /// `COOP`: tasks switch only when the running task yields or waits.
    Cooperative,
    /// `PREEMPT`: after [`Tasks::permit`] also when a time slice of 10 ms ends or a task of higher priority becomes
    /// ready.
    Preemptive,
}

/// Priority of a task: the ready task of highest priority runs. `main` has a lower priority than all other tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names are the numbers")]
pub enum Priority {
    P1 = 1,
    P2,
    P3,
    P4,
    P5,
    P6,
    P7,
    P8,
}

/// Settings of a new task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskSettings {
    /// Name of the task in messages.
    pub name: String,
    /// Priority of the task.
    pub priority: Priority,
    /// Requested stack in bytes; the actual stack is larger.
    pub stack_bytes: u32,
    /// Any number; [`Tasks::uid`] returns it.
    pub uid: i32,
}

/// Multi-tasking functions of the task that owns the robot.
#[derive(Clone, Copy, Debug)]
pub struct Tasks<'a>(&'a Robot);

/// Handle of a task, valid until the program ends. It can be passed to other tasks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use = "a task runs once it is made ready"]
pub struct Task(robios_sys::robios6::Task);

/// Guard that keeps pre-emption off, see [`Tasks::forbid`].
#[derive(Debug)]
#[must_use = "pre-emption is off only while it lives"]
pub struct PreemptionGuard<'a> {
    robot: &'a Robot,
    was_permitted: bool,
}

/// State shared by a program's tasks.
#[derive(Default)]
pub(crate) struct TaskState {
    is_on: bool,
    is_permitted: bool,
    /// Number of timers whose functions are bound to the thread of `main`.
    pub timers: usize,
    /// Tasks that have not ended, in order of creation.
    jobs: Vec<Arc<TaskJob>>,
}

impl TaskSettings {
    /// A task of this name and priority, with a stack of 256 KiB and the number 0.
    pub fn new(name: impl Into<String>, priority: Priority) -> Self {
        Self { name: name.into(), priority, stack_bytes: 256 * 1024, uid: 0 }
    }
}

impl Robot {
    /// Starts multi-tasking: the calling function becomes a task of lower priority than all others.
    ///
    /// The mode cannot be changed afterwards. The program ends when `main` returns. A task that panics or returns an
    /// error ends the program.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// use robios_api::{Priority, TaskMode};
    ///
    /// fn approach(robot: &Robot) -> Result {
    ///     let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
    ///     let nearest = tasks.shared(None)?;
    ///     let sensed = tasks.semaphore(0)?;
    ///
    ///     let (measured, done) = (nearest.clone(), sensed.clone());
    ///     let sense = tasks.spawn("sense", Priority::P2, move |robot| -> Result {
    ///         let front = robot.psd(PsdAt::Front)?;
    ///         loop {
    ///             *measured.lock(robot) = front.distance();
    ///             done.signal(robot);
    ///             robot.tasks().sleep(60.millis())?;
    ///         }
    ///     })?;
    ///     sense.ready(robot)?;
    ///     tasks.permit()?;
    ///
    ///     let drive = robot.drive()?;
    ///     drive.set_speed(0.2.metres_per_second(), 0.radians_per_second())?;
    ///     loop {
    ///         sensed.wait(robot);
    ///         if nearest.lock(robot).is_some_and(|distance| distance < 0.2.metres()) {
    ///             return drive.stop();
    ///         }
    ///     }
    /// }
    /// # let fake = robios_api::fake::Fake::new().psd(PsdAt::Front, |now| Some(1.metres() - now.position.x));
    /// # let run = fake.run(approach).expect_finished();
    /// # assert!((run.position().x - 0.8.metres()).abs() < 30.millimetres());
    /// ```
    ///
    /// # Errors
    /// [`Error::Refused`] if multi-tasking is on already; [`Error::Unsuitable`] while there are timers of
    /// [`every`](Self::every): see [`Tasks::every`].
    #[track_caller]
    pub fn multi_tasking(&self, mode: TaskMode) -> Result<Tasks<'_>> {
        if locked(&self.common().tasks).timers > 0 {
            return Err(Error::Unsuitable { what: "a timer of `Robot::every` with tasks", instead: "`Tasks::every`" });
        }
        let code = match mode {
            TaskMode::Cooperative => COOP,
            TaskMode::Preemptive => PREEMPT,
        };
        checked("OSMTInit", Device::Tasks, robios!(self, OSMTInit(code as u8)))?;
        locked(&self.common().tasks).is_on = true;
        Ok(Tasks(self))
    }

    /// Multi-tasking functions, for tasks other than the one that started multi-tasking.
    pub fn tasks(&self) -> Tasks<'_> {
        Tasks(self)
    }

    /// Ends all tasks after `main` has returned. Their resources are dropped in order of their creation, on every host.
    pub(crate) fn end_tasks(&self) {
        if !locked(&self.common().tasks).jobs.is_empty() {
            release!(self, OSForbid());
        }
        loop {
            let first = locked(&self.common().tasks).jobs.first().cloned();
            let Some(job) = first else { return };
            if let Some(task) = job.task.get() {
                release!(self, OSKill(*task));
            }
            job.remove();
        }
    }

    /// Adds one to the number of timers whose functions are bound to this thread.
    pub(crate) fn count_timer(&self) -> Result {
        let tasks = &mut *locked(&self.common().tasks);
        if tasks.is_on {
            return Err(Error::Unsuitable { what: "`Robot::every` with tasks", instead: "`Tasks::every`" });
        }
        tasks.timers += 1;
        Ok(())
    }
}

impl<'a> Tasks<'a> {
    /// Scheduling mode; `None` before multi-tasking was started.
    #[track_caller]
    pub fn mode(self) -> Option<TaskMode> {
        match robios!(self.0, OSMTStatus()) {
            COOP => Some(TaskMode::Cooperative),
            PREEMPT => Some(TaskMode::Preemptive),
            _ => None,
        }
    }

    /// Creates a task that is not yet ready to run: see [`Task::ready`].
    ///
    /// The function gets its own robot, from which it obtains its devices. It may return nothing or a `Result`, as
    /// `main` may.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if there are too many tasks or multi-tasking is off.
    #[track_caller]
    pub fn spawn<O: Outcome>(
        self,
        name: &str,
        priority: Priority,
        function: impl FnOnce(&Robot) -> O + Send + 'static,
    ) -> Result<Task> {
        self.spawn_with(TaskSettings::new(name, priority), function)
    }

    /// Like [`spawn`](Self::spawn), with all settings.
    ///
    /// # Errors
    /// See [`spawn`](Self::spawn).
    #[track_caller]
    pub fn spawn_with<O: Outcome>(
        self,
        settings: TaskSettings,
        function: impl FnOnce(&Robot) -> O + Send + 'static,
    ) -> Result<Task> {
        let Some(tables) = self.0.tables() else { return Err(Error::Unavailable(Device::Tasks)) };
        let job = Arc::new(TaskJob {
            tables,
            common: Arc::clone(self.0.common()),
            function: Mutex::new(Some(Box::new(move |robot| function(robot).failure()))),
            task: OnceLock::new(),
        });
        let callback = Callback { code: Some(begin), data: Arc::as_ptr(&job).cast_mut().cast() };
        locked(&self.0.common().tasks).jobs.push(Arc::clone(&job));
        let name = ByteSlice::from(settings.name.as_str());
        let stack = i32::try_from(settings.stack_bytes).unwrap_or(i32::MAX);
        match robios!(self.0, OSSpawn(name, callback, stack, settings.priority as i32, settings.uid)) {
            0 => {
                job.remove();
                Err(Error::Unavailable(Device::Tasks))
            }
            task => {
                let _already_set = job.task.set(task);
                Ok(Task(task))
            }
        }
    }

    /// Creates a semaphore with a number of initial permits.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn semaphore(self, permits: u32) -> Result<Semaphore> {
        Semaphore::new(self.0, permits)
    }

    /// Creates a value shared between tasks; one task at a time can lock it.
    ///
    /// # Errors
    /// See [`semaphore`](Self::semaphore), which this function calls.
    #[track_caller]
    pub fn shared<T>(self, value: T) -> Result<Shared<T>> {
        Shared::new(self.0, value)
    }

    /// The number given to this task at its creation; 0 for `main`.
    #[track_caller]
    pub fn uid(self) -> i32 {
        robios!(self.0, OSGetUID(0))
    }

    /// Lets the next ready task of the highest priority run; this one stays ready.
    ///
    /// # Errors
    /// [`Error::Refused`] without multi-tasking.
    #[track_caller]
    pub fn reschedule(self) -> Result {
        checked("OSReschedule", Device::Tasks, robios!(self.0, OSReschedule()))
    }

    /// Suspends this task until another makes it ready.
    ///
    /// # Errors
    /// [`Error::Refused`] without multi-tasking.
    #[track_caller]
    pub fn suspend_self(self) -> Result {
        checked("OSYield", Device::Tasks, robios!(self.0, OSYield()))
    }

    /// Sleeps for whole hundredths of a second, rounded up, while other tasks run; [`Robot::sleep`] is exact to the
    /// microsecond.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn sleep(self, span: Duration) -> Result {
        let hundredths = i32::try_from(span.as_nanos().div_ceil(10_000_000)).unwrap_or(i32::MAX);
        checked("OSSleep", Device::Tasks, robios!(self.0, OSSleep(hundredths)))
    }

    /// Switches pre-emption on; it is off at first.
    ///
    /// # Errors
    /// [`Error::Refused`] without multi-tasking.
    #[track_caller]
    pub fn permit(self) -> Result {
        checked("OSPermit", Device::Tasks, robios!(self.0, OSPermit()))?;
        locked(&self.0.common().tasks).is_permitted = true;
        Ok(())
    }

    /// Switches pre-emption off until the guard is dropped, which restores the previous state.
    ///
    /// # Errors
    /// [`Error::Refused`] without multi-tasking.
    #[track_caller]
    pub fn forbid(self) -> Result<PreemptionGuard<'a>> {
        checked("OSForbid", Device::Tasks, robios!(self.0, OSForbid()))?;
        let was_permitted = std::mem::replace(&mut locked(&self.0.common().tasks).is_permitted, false);
        Ok(PreemptionGuard { robot: self.0, was_permitted })
    }

    /// Calls a function periodically, as [`Robot::every`] does, in a program with tasks.
    ///
    /// The function runs inside the call that is in progress when the timer is due, on the thread of the task that made
    /// the call: it must be `Send`, and it obtains its devices from the robot that it gets. It may make tasks ready and
    /// signal semaphores, but must not wait.
    ///
    /// # Errors
    /// See [`Robot::every`].
    #[track_caller]
    pub fn every(self, period: Duration, function: impl FnMut(&Robot) + Send + 'static) -> Result<Timer> {
        Timer::of_any_task(self.0, period, Box::new(function))
    }
}

impl Task {
    /// Makes the task ready to run.
    ///
    /// # Errors
    /// [`Error::Refused`] if the task has ended.
    #[track_caller]
    pub fn ready(self, robot: &Robot) -> Result {
        checked("OSReady", Device::Tasks, robios!(robot, OSReady(self.0)))
    }

    /// Suspends the task until it is made ready again.
    ///
    /// # Errors
    /// [`Error::Refused`] if the task has ended.
    #[track_caller]
    pub fn suspend(self, robot: &Robot) -> Result {
        checked("OSSuspend", Device::Tasks, robios!(robot, OSSuspend(self.0)))
    }

    /// Makes the task ready and lets the next ready task of the highest priority run.
    ///
    /// # Errors
    /// [`Error::Refused`] if the task has ended.
    #[track_caller]
    pub fn run(self, robot: &Robot) -> Result {
        checked("OSRun", Device::Tasks, robios!(robot, OSRun(self.0)))
    }

    /// Cancels the task: it ends inside its current call, and its resources are dropped.
    ///
    /// # Errors
    /// [`Error::Refused`] if the task has ended.
    #[track_caller]
    pub fn kill(self, robot: &Robot) -> Result {
        checked("OSKill", Device::Tasks, robios!(robot, OSKill(self.0)))
    }

    /// The number given to the task at its creation.
    #[track_caller]
    pub fn uid(self, robot: &Robot) -> i32 {
        robios!(robot, OSGetUID(self.0))
    }
}

impl Drop for PreemptionGuard<'_> {
    fn drop(&mut self) {
        if self.was_permitted {
            locked(&self.robot.common().tasks).is_permitted = true;
            release!(self.robot, OSPermit());
        }
    }
}

/// A task that has not ended.
struct TaskJob {
    tables: Tables,
    common: Arc<ProgramState>,
    /// Function of the task; `None` once it has begun.
    function: Mutex<Option<Box<TaskFunction>>>,
    /// Number of the task, set once it is known.
    task: OnceLock<robios_sys::robios6::Task>,
}

/// Function of a task; returns the text of its failure.
type TaskFunction = dyn FnOnce(&Robot) -> Option<String> + Send;

impl TaskJob {
    fn begin(&self) -> Status {
        let Some(function) = locked(&self.function).take() else { return Status::OK };
        let robot = Robot::of_task(self.tables, Arc::clone(&self.common));
        let status = entry::run_task(&robot, || function(&robot));
        robot.close();
        self.remove();
        status
    }

    /// Removes the task from the list of those that have not ended.
    fn remove(&self) {
        let mut tasks = locked(&self.common.tasks);
        let index = tasks.jobs.iter().position(|job| std::ptr::eq(&**job, self));
        let job = index.map(|index| tasks.jobs.remove(index));
        // Values captured by the function may take the lock when they are dropped.
        drop(tasks);
        drop(job);
    }
}

/// Entry point of a task, called by the host when the task first runs.
///
/// # Safety
/// `data` is a [`TaskJob`] that has not begun, and its program's `main` has not returned.
unsafe extern "C" fn begin(data: *mut c_void) -> Status {
    let job = data.cast_const().cast::<TaskJob>();
    // SAFETY: the list of tasks holds one reference to the job; a second one keeps it alive until the task ends.
    let job = unsafe {
        Arc::increment_strong_count(job);
        Arc::from_raw(job)
    };
    job.begin()
}
