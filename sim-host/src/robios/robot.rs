//! One robot of a run: the robot of the simulation, and the state, waits and ending of its running program.

use std::mem::offset_of;
use std::ops::{Deref, DerefMut, Range};

use robios_sys::{Robios6Call, SupportCall};
use sim_core::simulation;
use sim_core::time::Time;

use super::Robios;
use super::call::Call;
use super::handle::Handles;
use super::storage::Storage;
use super::support::Generators;
use super::task::{TaskWait, Tasks};
use super::timer::Timers;
use super::vw;
use crate::program::site::Site;

/// A robot with the state of its running program, all guarded by one lock.
pub struct Robot {
    /// The robot of the simulation.
    pub state: simulation::Robot,
    /// State that RoBIOS keeps for its program.
    pub robios: Robios,
    /// Name of its program; empty for a robot without one.
    pub program: String,
    /// Random generators of its program.
    pub generators: Generators,
    /// Timers that its program has attached.
    pub timers: Timers,
    /// Its tasks; a program that starts none has only `main`.
    pub tasks: Tasks,
    /// Ending of its program, once known.
    pub ending: Option<Ending>,
    /// A task of the program has called a function of RoBIOS and has ended.
    pub has_called: bool,
    /// Hints given in the call in progress, not yet recorded with their line of the program.
    pub new_hints: Vec<String>,
}

impl Robot {
    /// Offsets of the fields that most calls access; a caller may prefetch them.
    pub const HOT_FIELDS: [Range<usize>; 6] = [
        offset_of!(Robot, state)..offset_of!(Robot, state.devices.scanner),
        range_of(offset_of!(Robot, robios.psds), size_of::<Handles>()),
        range_of(offset_of!(Robot, robios.vw), size_of::<vw::Vw>()),
        range_of(offset_of!(Robot, robios.storage), size_of::<Storage>()),
        range_of(offset_of!(Robot, timers), size_of::<Timers>()),
        range_of(offset_of!(Robot, tasks), size_of::<Tasks>()),
    ];

    /// Address ranges of the heap memory that most calls access; a caller may prefetch it.
    pub fn hot_memory(&self) -> impl Iterator<Item = Range<*const u8>> {
        self.state.hot_memory().chain([self.tasks.hot_memory()])
    }
}

/// Range of a field's bytes.
const fn range_of(offset: usize, size: usize) -> Range<usize> {
    offset..offset + size
}

impl Deref for Robot {
    type Target = simulation::Robot;

    fn deref(&self) -> &Self::Target {
        &self.state
    }
}

impl DerefMut for Robot {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.state
    }
}

/// A wait in progress.
#[derive(Clone, Debug)]
pub struct Wait {
    /// The call that waits.
    pub call: Call,
    /// Reason of the wait.
    pub reason: WaitReason,
    /// Virtual time at which the wait began.
    pub since: Time,
    /// Location in the program of the call.
    pub site: Site,
}

/// Reason of a wait.
#[derive(Clone, Debug, PartialEq)]
pub enum WaitReason {
    /// A point in virtual time.
    Time(Time),
    /// The end of the drive in progress.
    Drive,
    /// A key, as shown to the user.
    Key(String),
    /// Other external input, as shown to the user.
    Input(String),
    /// A message by radio.
    Message,
    /// An action of another task.
    Task(TaskWait),
    /// The semaphore of RoBIOS 6 with this number.
    Semaphore(u32),
    /// Another task must make this task ready.
    Ready,
}

/// Ending of a robot's program.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// `main` returned, or the program called `exit`.
    Exited {
        /// Its exit code; 0 is success.
        code: i32,
    },
    /// The program failed, for example by a panic, `abort`, `OSPanic`, or a call that the simulator refuses.
    Failed {
        /// The reason, as shown to the user.
        reason: String,
    },
    /// The watchdog stopped the program.
    Overdue {
        /// The location in the program, as shown to the user.
        reason: String,
    },
    /// The program was stopped with the run.
    Stopped,
}

impl Robot {
    /// Creates a robot at its start, whose program is named `program`.
    pub fn new(state: simulation::Robot, robios: Robios, program: String) -> Self {
        let generators = Generators::new(state.seed(), state.id);
        let (timers, tasks) = (Timers::default(), Tasks::default());
        let new_hints = Vec::new();
        let mut robot =
            Self { state, robios, program, generators, timers, tasks, ending: None, has_called: false, new_hints };
        vw::locate_odometry(&mut robot);
        robot
    }

    /// Records a hint to the user about a likely mistake that the call in progress has revealed. For a hint outside of
    /// calls, use the method `hint` of [`state`](Self::state).
    pub fn hint(&mut self, text: &str) {
        self.state.hint(text);
        self.new_hints.push(text.to_owned());
    }

    /// Gives a hint if the program has ended before the end of a drive that it commanded.
    pub fn hint_at_pending_drive(&mut self) {
        if self.motion.drive_end().is_some_and(|end| end > self.now)
            && let Some((_, wait_function)) = self.robios.vw.last_drive
        {
            self.state.hint(&format!(
                "the program ended while it drove, which stops the motors: `{wait_function}` waits for the end of a drive"
            ));
        }
    }

    /// Gives a hint if `main` has ended before other tasks of RoBIOS 6, which end with it.
    pub fn hint_at_unfinished_tasks(&mut self) {
        let is_ended_by_main = !self.tasks.is_exiting() && matches!(self.ending, None | Some(Ending::Exited { .. }));
        if is_ended_by_main && self.tasks.scheduler().is_some() && self.tasks.has_others() {
            let others = self.tasks.names_of_others();
            self.state
                .hint(&format!("the program ended with `main`, before {others}: `OSSuspend(0)` lets `main` wait"));
        }
    }

    /// Records the start of the program.
    pub fn record_start(&mut self) {
        self.state.record_start(&self.program);
    }
}

impl Wait {
    /// Returns true if the waiting task yields the processor to other tasks under the scheduler of RoBIOS 6; other
    /// waits are busy.
    pub fn is_blocking(&self) -> bool {
        let is_sleep = matches!(self.call, Call::Robios6(Robios6Call::OSSleep) | Call::Support(SupportCall::sleep_us));
        is_sleep || self.reason.is_for_task()
    }
}

impl WaitReason {
    /// Returns true if the task waits for an action of another task of the robot.
    pub fn is_for_task(&self) -> bool {
        matches!(self, Self::Task(_) | Self::Semaphore(_) | Self::Ready)
    }

    /// Returns true if another task may interrupt the wait.
    pub fn is_interruptible(&self) -> bool {
        match self {
            Self::Task(wait) => wait.is_interruptible(),
            Self::Semaphore(_) | Self::Ready => false,
            _ => true,
        }
    }
}

impl std::fmt::Display for WaitReason {
    /// Writes what the robot does: `waits for KEY4`, `sleeps until 2.350 s`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Time(Time::NEVER) => f.write_str("sleeps for ever"),
            Self::Time(time) => write!(f, "sleeps until {time}"),
            Self::Drive => f.write_str("waits for the end of its drive"),
            Self::Key(awaited) | Self::Input(awaited) => write!(f, "waits for {awaited}"),
            Self::Message => f.write_str("waits for a message"),
            Self::Task(wait) => write!(f, "waits for {wait}"),
            Self::Semaphore(number) => write!(f, "waits for semaphore {number}"),
            Self::Ready => f.write_str("waits to be made ready"),
        }
    }
}
