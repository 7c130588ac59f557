//! One robot of a run: the robot of the simulation, and what its running program keeps, waits for and how it ended.

use std::ops::{Deref, DerefMut};

use robios_sys::{Robios6Call, SupportCall};
use sim_core::simulation;
use sim_core::time::Time;

use super::Robios;
use super::call::Call;
use super::support::Generators;
use super::task::{TaskWait, Tasks};
use super::timer::Timers;
use crate::program::site::Site;

/// One robot with what its running program keeps; one lock guards it all.
pub struct Robot {
    /// The robot as the simulation knows it.
    pub state: simulation::Robot,
    /// What RoBIOS keeps for its program.
    pub robios: Robios,
    /// The name of its program; empty for a robot without one.
    pub program: String,
    /// The generators that its program draws from.
    pub generators: Generators,
    /// The timers that its program has attached.
    pub timers: Timers,
    /// Its tasks; a program that starts none has one.
    pub tasks: Tasks,
    /// How its program ended, once that is known.
    pub ending: Option<Ending>,
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
pub struct Waiting {
    /// The call that waits.
    pub call: Call,
    /// What for.
    pub waits_for: Waits,
    /// Since when, in virtual time.
    pub since: Time,
    /// Where the program called it.
    pub site: Site,
}

/// What a robot can wait for.
#[derive(Clone, Debug, PartialEq)]
pub enum Waits {
    /// A point in virtual time.
    Time(Time),
    /// The end of the drive in progress.
    Drive,
    /// A key, as the user calls it.
    Key(String),
    /// Something else that only the outside could give, as the user calls it.
    Input(String),
    /// A message by radio.
    Message,
    /// Something that only another task could give.
    Task(TaskWait),
    /// The semaphore of RoBIOS 6 with this number.
    Semaphore(u32),
    /// To be made ready by another task.
    Ready,
}

/// How a robot's program ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// `main` returned, or the program called `exit`.
    Exited {
        /// Its exit code; 0 is success.
        code: i32,
    },
    /// It broke off: a panic, `abort`, a call that the simulator refuses.
    Failed {
        /// Why, as the user is told.
        reason: String,
    },
    /// It was stopped by the watchdog.
    Overdue {
        /// Where, as the user is told.
        reason: String,
    },
    /// It was stopped with the run.
    Stopped,
}

impl Robot {
    /// A robot at its start, whose program has this name.
    pub fn new(state: simulation::Robot, robios: Robios, program: String) -> Self {
        let generators = Generators::new(state.seed(), state.id);
        let (timers, tasks) = (Timers::default(), Tasks::default());
        Self { state, robios, program, generators, timers, tasks, ending: None }
    }

    /// Tells the user when the program has ended before a drive that it commanded.
    pub fn hint_at_pending_drive(&mut self) {
        if self.motion.drive_end().is_some_and(|end| end > self.now) {
            let wait = if self.robios.vw.begun.is_some() { "VWWait" } else { "VWDriveWait" };
            self.hint(&format!(
                "the program ended while it drove, which stops the motors: `{wait}` waits for the end of a drive"
            ));
        }
    }

    /// Tells the user when `main` has ended before other tasks of RoBIOS 6, which end with it.
    pub fn hint_at_living_tasks(&mut self) {
        let is_by_main = !self.tasks.is_leaving() && matches!(self.ending, None | Some(Ending::Exited { .. }));
        if is_by_main && self.tasks.scheduler().is_some() && self.tasks.has_others() {
            let others = self.tasks.others_in_words();
            self.hint(&format!("the program ended with `main`, before {others}: `OSSuspend(0)` lets `main` wait"));
        }
    }

    /// Records that its program begins.
    pub fn record_start(&mut self) {
        self.state.record_start(&self.program);
    }
}

impl Waiting {
    /// True where the task leaves the processor to others under the scheduler of RoBIOS 6; in any other wait it keeps what it has.
    pub fn leaves_processor(&self) -> bool {
        let is_sleep = matches!(self.call, Call::Robios6(Robios6Call::OSSleep) | Call::Support(SupportCall::sleep_us));
        is_sleep || self.waits_for.is_for_task()
    }
}

impl Waits {
    /// True for what only another task of the robot could give.
    pub fn is_for_task(&self) -> bool {
        matches!(self, Self::Task(_) | Self::Semaphore(_) | Self::Ready)
    }

    /// True where another task may end the wait by force.
    pub fn is_interruptible(&self) -> bool {
        match self {
            Self::Task(wait) => wait.is_interruptible(),
            Self::Semaphore(_) | Self::Ready => false,
            _ => true,
        }
    }
}

impl std::fmt::Display for Waits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Time(time) => write!(f, "{time} of virtual time"),
            Self::Drive => f.write_str("the end of its drive"),
            Self::Key(key) => f.write_str(key),
            Self::Input(what) => f.write_str(what),
            Self::Message => f.write_str("a message"),
            Self::Task(wait) => wait.fmt(f),
            Self::Semaphore(number) => write!(f, "semaphore {number}"),
            Self::Ready => f.write_str("to be made ready"),
        }
    }
}
