//! The robot of a program: access to its devices and services, and the macros that call the ABI.

use std::cell::Cell;
use std::ffi::c_void;
use std::panic::Location;
use std::rc::Rc;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use robios_sys::{ByteBuffer, Host, Robios6Table, Robios7Table, Status, SupportTable};

use crate::audio::Audio;
use crate::call_site;
use crate::console::Console;
use crate::image::ImageSize;
use crate::layer::Layers;
use crate::lcd::Lcd;
use crate::port::Ports;
use crate::psd::PsdState;
use crate::random::Random;
use crate::robios7::DeviceSettings;
use crate::task::TaskState;

/// The robot, from which all devices and services are obtained.
///
/// Clones refer to the same robot. The value belongs to one task: each [task](Robot::multi_tasking) gets its own.
#[derive(Clone)]
pub struct Robot(pub(crate) Rc<Inner>);

/// State shared by all clones of a task's robot and its devices.
pub(crate) struct Inner {
    /// `None` once the task has ended: calls of a device that outlives the task, for example in a thread-local
    /// variable, then do nothing.
    tables: Cell<Option<Tables>>,
    is_stopped: Cell<bool>,
    pub(crate) robios7: DeviceSettings,
    pub(crate) common: Arc<ProgramState>,
}

/// State shared by all tasks of a program. None of its locks is held during a call.
pub(crate) struct ProgramState {
    arguments: Vec<String>,
    call_site: call_site::Recorder,
    pub(crate) psd: Mutex<PsdState>,
    /// Number of [`Radio`](crate::Radio)s, of either generation.
    pub(crate) radios: Mutex<usize>,
    /// Size of the last image in RoBIOS 6.
    pub(crate) image_size: Mutex<ImageSize>,
    pub(crate) tasks: Mutex<TaskState>,
    /// Exit code of a failure that was already reported, for example by a timer's function or a task.
    pub(crate) failure: OnceLock<i32>,
}

/// Locks a value, also after a panic in a thread that held the lock. A panic leaves no change to a value of this crate
/// half done, since every such change is a single step. Changes to the value of a [`Shared`](crate::Shared) remain as
/// far as they were made.
pub(crate) fn locked<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Tables and context of the host, valid for all tasks until the program's `run` returns, see [`Robot::new`].
#[derive(Clone, Copy)]
pub(crate) struct Tables {
    pub support: *const SupportTable,
    /// Null in a program of RoBIOS-7, which has no [`Robot`].
    pub robios: *const Robios6Table,
    /// Null in a program of RoBIOS 6, which has no [`robios7::Robot`](crate::robios7::Robot).
    pub robios7: *const Robios7Table,
    pub context: *mut c_void,
}

// SAFETY: the tables are constant, and the context is only passed back to the host, which accepts calls from every task
// of its robot.
unsafe impl Send for Tables {}
// SAFETY: as for `Send`.
unsafe impl Sync for Tables {}

/// Panic payload that unwinds a program after [`Status::STOP`].
pub(crate) struct Stopped;

impl Robot {
    /// Creates the robot of `main`.
    ///
    /// # Safety
    /// `host` and `context` are the arguments of the program's `run`, only functions of the program's generation are
    /// called, and [`close`](Self::close) is called before `run` returns.
    pub(crate) unsafe fn new(
        host: *const Host,
        context: *mut c_void,
        arguments: Vec<String>,
        call_site: call_site::Recorder,
    ) -> Self {
        // SAFETY: the caller vouches for `host`.
        let host = unsafe { &*host };
        let tables = Tables { support: host.support, robios: host.robios6, robios7: host.robios7, context };
        let common = ProgramState {
            arguments,
            call_site,
            psd: Mutex::default(),
            radios: Mutex::default(),
            image_size: Mutex::new(ImageSize::EYECAM),
            tasks: Mutex::default(),
            failure: OnceLock::new(),
        };
        Self::of_task(tables, Arc::new(common))
    }

    /// Creates the robot of one task. The caller must close it before the task ends.
    pub(crate) fn of_task(tables: Tables, common: Arc<ProgramState>) -> Self {
        Self(Rc::new(Inner {
            tables: Cell::new(Some(tables)),
            is_stopped: Cell::new(false),
            robios7: DeviceSettings::default(),
            common,
        }))
    }

    /// State shared by all tasks of the program.
    pub(crate) fn common(&self) -> &Arc<ProgramState> {
        &self.0.common
    }

    /// Disconnects from the host: later calls do nothing.
    pub(crate) fn close(&self) {
        self.0.tables.set(None);
    }

    pub(crate) fn tables(&self) -> Option<Tables> {
        self.0.tables.get()
    }

    /// Unwinds the program unless the status is [`Status::OK`].
    ///
    /// During unwinding (a call in a `drop`) a second unwinding would abort the host: the call then returns a result of
    /// 0 instead.
    pub(crate) fn unwind_if_stopped(&self, status: Status) {
        if status != Status::OK {
            self.0.is_stopped.set(true);
            if !std::thread::panicking() {
                std::panic::resume_unwind(Box::new(Stopped));
            }
        }
    }

    /// Records the location of a call. After the first call that was answered with [`Status::STOP`] the location is
    /// kept: calls made while the program unwinds do not replace it.
    pub(crate) fn record_call_site(&self, location: &'static Location<'static>) {
        if !self.0.is_stopped.get() {
            self.0.common.call_site.record(location);
        }
    }

    /// Command line arguments of the program, without its name.
    pub fn arguments(&self) -> &[String] {
        &self.0.common.arguments
    }

    /// The display: 128 x 64 pixels, 7 lines of 16 characters.
    pub fn lcd(&self) -> Lcd<'_> {
        Lcd(self)
    }

    /// The console of the robot: whole lines, shown and recorded with the robot's name and virtual time.
    pub fn console(&self) -> Console<'_> {
        Console::output(self)
    }

    /// The console for error messages.
    pub fn console_error(&self) -> Console<'_> {
        Console::error(self)
    }

    /// The next line of standard input (`--stdin`) without its end; `None` at the end of the input.
    ///
    /// Use it instead of `std::io::stdin`, which would read the host's own input. Invalid UTF-8 is replaced.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// fn greet(robot: &Robot) {
    ///     while let Some(name) = robot.read_line() {
    ///         writeln!(robot.console(), "hello {name}");
    ///     }
    /// }
    /// # assert_eq!(robios_api::fake::Fake::new().input("Ada\nGrace").run(greet).console(), "hello Ada\nhello Grace\n");
    /// ```
    #[track_caller]
    pub fn read_line(&self) -> Option<String> {
        let mut line = Vec::new();
        let mut buffer = [0; 256];
        loop {
            let count: i32 = support!(self, input(ByteBuffer::from(&mut buffer[..])));
            let count = usize::try_from(count).unwrap_or_default().min(buffer.len());
            line.extend_from_slice(&buffer[..count]);
            if count == 0 || line.ends_with(b"\n") {
                break;
            }
        }
        let text = String::from_utf8_lossy(&line);
        let text = text.strip_suffix('\n').unwrap_or(&text);
        let text = text.strip_suffix('\r').unwrap_or(text);
        (!line.is_empty()).then(|| text.to_owned())
    }

    /// The robot's own random numbers.
    pub fn random(&self) -> Random<'_> {
        Random::new(self)
    }

    /// Layers of the simulator's window, which real robots do not have.
    pub fn layers(&self) -> Layers<'_> {
        Layers(self)
    }

    /// Loudspeaker and microphone.
    pub fn audio(&self) -> Audio<'_> {
        Audio(self)
    }

    /// Latches, parallel port and analogue inputs.
    pub fn ports(&self) -> Ports<'_> {
        Ports(self)
    }
}

impl std::fmt::Debug for Robot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Robot").field("arguments", &self.0.common.arguments).finish_non_exhaustive()
    }
}

/// Calls a function of the RoBIOS 6 table and returns its result; unwinds the program if the host stops it.
///
/// Pointers among the arguments must come from references that live until the call returns.
macro_rules! robios {
    ($robot:expr, $name:ident($($argument:expr),* $(,)?)) => {
        $crate::robot::call!($robot, robios, $name($($argument),*))
    };
}
pub(crate) use robios;

/// Calls a function of the RoBIOS-7 table for a [`robios7::Robot`](crate::robios7::Robot), as [`robios!`] does.
macro_rules! robios7 {
    ($robot:expr, $name:ident($($argument:expr),* $(,)?)) => {
        $crate::robot::call!(&$robot.0, robios7, $name($($argument),*))
    };
}
pub(crate) use robios7;

/// Calls a function of the support table, as [`robios!`] does.
macro_rules! support {
    ($robot:expr, $name:ident($($argument:expr),* $(,)?)) => {
        $crate::robot::call!($robot, support, $name($($argument),*))
    };
}
pub(crate) use support;

macro_rules! call {
    ($robot:expr, $table:ident, $name:ident($($argument:expr),*)) => {{
        let robot: &$crate::Robot = $robot;
        robot.record_call_site(std::panic::Location::caller());
        let mut result = Default::default();
        if let Some(tables) = robot.tables() {
            // SAFETY: table and context are valid as long as the robot is not closed; pointers among the arguments
            // come from references that live until the call returns.
            let status = unsafe { ((*tables.$table).$name)(tables.context, $($argument,)* &mut result) };
            robot.unwind_if_stopped(status);
        }
        result
    }};
}
pub(crate) use call;

/// Calls a function of a RoBIOS table from a `drop`, without unwinding. Returns true if the host executed the call.
macro_rules! release {
    ($robot:expr, $name:ident($($argument:expr),* $(,)?)) => {
        $crate::robot::release!($robot, robios, $name($($argument),*))
    };
    ($robot:expr, $table:ident, $name:ident($($argument:expr),* $(,)?)) => {{
        let robot: &$crate::Robot = $robot;
        match robot.tables() {
            Some(tables) => {
                // SAFETY: as in `call!`; the result may be null.
                let status = unsafe {
                    ((*tables.$table).$name)(tables.context, $($argument,)* std::ptr::null_mut())
                };
                status == robios_sys::Status::OK
            }
            None => false,
        }
    }};
}
pub(crate) use release;
