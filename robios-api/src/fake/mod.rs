//! A fake robot for unit tests of robot programs: no simulator, no files, no world.
//!
//! A [`Fake`] describes the robot's devices and scripted events in virtual time; [`Fake::run`] runs a program on it
//! from start to end and returns a [`Run`], the record of the program's behaviour. A script is a function that returns
//! the state of a device at a [`Moment`]. Programs without end are stopped at a limit of virtual time. The robot is
//! ideal: drives take exactly their time, and there are no obstacles.
//!
//! ```
//! use robios_api::fake::Fake;
//! use robios_api::prelude::*;
//!
//! fn approach(robot: &Robot) -> Result {
//!     let front = robot.psd(PsdAt::Front)?;
//!     robot.wait_for_key(Key::Key4);
//!     let drive = robot.drive()?;
//!     drive.straight(0.4.metres(), 0.2.metres_per_second())?.wait()?;
//!     if front.distance().is_some() {
//!         writeln!(robot.lcd(), "wall");
//!     }
//!     Ok(())
//! }
//!
//! let run = Fake::new()
//!     .psd(PsdAt::Front, |now| Some(1.metres() - now.position.x))
//!     .key(2.5.seconds(), Key::Key4)
//!     .run(approach)
//!     .expect_finished();
//! assert_eq!(run.lcd_line(0), "wall");
//! assert!((run.position().x - 0.4.metres()).abs() < 1.millimetres());
//! assert_eq!(run.calls_of("VWDriveStraight").count(), 1);
//! ```

mod camera;
mod lcd;
mod leg;
mod motion;
mod radio;
mod robios;
mod robios7;
mod robot;
mod task;

use std::ffi::{CString, c_char, c_int, c_void};
use std::fmt::{self, Display, Formatter};
use std::panic::Location;
use std::sync::Arc;
use std::time::Duration;

use robios_sys::{Host, Program, Robios6Table, Robios7Table, SupportTable};

use crate::Robot;
use crate::call_site::{self, LastCallSite};
use crate::device::{BumperAt, InfraredAt, PsdAt};
use crate::drive::Position;
use crate::entry::{self, Machine, Outcome};
use crate::key::Key;
use crate::lcd::Pixel;
use crate::psd::Signal;
use crate::radio::Message;
use crate::unit::{Angle, Length};
use robot::FakeRobot;

pub use leg::FakeLeg;
pub use radio::Sent;

/// An instant of a run, for scripts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Virtual time since the robot's start.
    pub time: Duration,
    /// True position: starts at 0 and is not changed by `set_position`.
    pub position: Position,
}

type Script<T> = Box<dyn Fn(&Moment) -> T + Send>;

/// Name of a distance sensor in either generation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PsdName {
    /// RoBIOS 6: name of the sensor.
    At(PsdAt),
    /// RoBIOS-7: number of the sensor.
    Number(u8),
}

impl From<PsdAt> for PsdName {
    fn from(at: PsdAt) -> Self {
        Self::At(at)
    }
}

impl From<crate::robios7::PsdAt> for PsdName {
    fn from(at: crate::robios7::PsdAt) -> Self {
        Self::Number(at.number())
    }
}

/// Description of a fake robot: its devices and scripted events.
pub struct Fake {
    psds: Vec<(PsdName, Script<Option<Length>>)>,
    signals: Vec<(PsdName, Script<Signal>)>,
    lidar: Option<robios7::Scanner>,
    camera: camera::CameraScripts,
    touches: robios7::Touches,
    /// Script of the state of each leg.
    legs: Vec<Script<FakeLeg>>,
    body_height: Option<Script<Length>>,
    bumpers: Vec<(BumperAt, Vec<Duration>)>,
    infrareds: Vec<(InfraredAt, Script<bool>)>,
    keys: Vec<(Duration, Key)>,
    /// Messages with their times in microseconds, in order of time.
    messages: Vec<(u64, Message)>,
    answers: Option<radio::Answers>,
    arguments: Vec<String>,
    /// Text of the standard input.
    input: String,
    limit: Duration,
    seed: u64,
}

impl Default for Fake {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Fake {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fake").field("keys", &self.keys).field("limit", &self.limit).finish_non_exhaustive()
    }
}

impl Fake {
    /// A robot with drive, two motors and encoders, servos, compass and display, without other sensors. The limit of
    /// its virtual time is 60 s.
    ///
    /// At full power of the motors the robot drives at 0.5 m/s. Its wheels are 0.1 m apart, and its encoders have 1,000
    /// counts per metre. At the start, north is to its left.
    pub fn new() -> Self {
        Self {
            psds: Vec::new(),
            signals: Vec::new(),
            lidar: None,
            camera: camera::CameraScripts::default(),
            touches: Vec::new(),
            legs: Vec::new(),
            body_height: None,
            bumpers: Vec::new(),
            infrareds: Vec::new(),
            keys: Vec::new(),
            messages: Vec::new(),
            answers: None,
            arguments: Vec::new(),
            input: String::new(),
            limit: Duration::from_secs(60),
            seed: 1,
        }
    }

    /// Adds a distance sensor with the script of its distances; `None` is out of range.
    ///
    /// The sensor rounds to whole millimetres like the real one; in RoBIOS 6 it measures every 60 ms, in RoBIOS-7 on
    /// request.
    pub fn psd(
        mut self,
        at: impl Into<PsdName>,
        distance: impl Fn(&Moment) -> Option<Length> + Send + 'static,
    ) -> Self {
        self.psds.push((at.into(), Box::new(distance)));
        self
    }

    /// Sets the script of a distance sensor's signal; by default it is 1 for a distance in range, otherwise 0.
    pub fn signal(mut self, at: impl Into<PsdName>, signal: impl Fn(&Moment) -> Signal + Send + 'static) -> Self {
        self.signals.push((at.into(), Box::new(signal)));
        self
    }

    /// The signal of the distance sensor at `index` in `psds`, at a moment.
    fn signal_of(&self, index: usize, moment: &Moment) -> f32 {
        let (name, distance) = &self.psds[index];
        match self.signals.iter().find(|(at, _)| at == name) {
            Some((_, signal)) => signal(moment).0 as f32,
            None => f32::from(u8::from(distance(moment).is_some())),
        }
    }

    /// Adds a laser scanner with the script of its distances by direction in the robot's frame.
    pub fn lidar(mut self, distance: impl Fn(&Moment, Angle) -> Option<Length> + Send + 'static) -> Self {
        self.lidar = Some(Box::new(distance));
        self
    }

    /// Touches the display at the given time; only in RoBIOS-7.
    pub fn touch(mut self, time: Duration, at: Pixel) -> Self {
        self.touches.push((time, at));
        self.touches.sort_by_key(|(time, _)| *time);
        self
    }

    /// Adds a bumper with the times of its contacts, in order.
    pub fn bumper(mut self, at: BumperAt, times: impl Into<Vec<Duration>>) -> Self {
        self.bumpers.push((at, times.into()));
        self
    }

    /// Adds an infrared sensor with the script of its state.
    pub fn infrared(mut self, at: InfraredAt, is_near: impl Fn(&Moment) -> bool + Send + 'static) -> Self {
        self.infrareds.push((at, Box::new(is_near)));
        self
    }

    /// Presses a key at the given time.
    pub fn key(mut self, time: Duration, key: Key) -> Self {
        self.keys.push((time, key));
        self.keys.sort_by_key(|(time, _)| *time);
        self
    }

    /// Sets the text of the standard input.
    pub fn input(mut self, text: impl Into<String>) -> Self {
        self.input = text.into();
        self
    }

    /// Adds an argument of the program.
    pub fn argument(mut self, argument: impl Into<String>) -> Self {
        self.arguments.push(argument.into());
        self
    }

    /// Sets the limit of virtual time at which the program is stopped; 60 s by default.
    ///
    /// A loop that makes no call takes no virtual time and is not stopped.
    pub fn until(mut self, limit: Duration) -> Self {
        self.limit = limit;
        self
    }

    /// Sets the seed of the robot's random numbers.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Runs a program of RoBIOS 6.
    pub fn run<O: Outcome>(self, main: impl FnOnce(&Robot) -> O) -> Run {
        self.run_machine(main)
    }

    /// Runs a program of RoBIOS-7.
    pub fn run_robios7<O: Outcome>(self, main: impl FnOnce(&crate::robios7::Robot) -> O) -> Run {
        self.run_machine(main)
    }

    fn run_machine<M: Machine, O: Outcome>(self, main: impl FnOnce(&M) -> O) -> Run {
        self.run_with(M::GENERATION, |last_call_site, host, context, argc, argv| {
            let recorder = call_site::Recorder::Fake(last_call_site);
            // SAFETY: host, context and arguments live until the call returns, and meet the contract of
            // `robios_sys::Run`.
            unsafe { entry::run_for(recorder, host, context, argc, argv, main) }
        })
    }

    /// Runs the program of a loaded library.
    ///
    /// # Safety
    /// `program` is the `eyesim_program` of a library that stays loaded, and upholds its contract.
    ///
    /// # Panics
    /// If the program was built against another version of the ABI.
    pub unsafe fn run_library(self, program: &Program) -> Run {
        if let Err(incompatibility) = program.check() {
            panic!("{incompatibility}");
        }
        self.run_with(program.generation, |_, host, context, argc, argv| {
            // SAFETY: the caller vouches for the program; host, context and arguments live until the call returns.
            unsafe { (program.run)(host, context, argc, argv) }
        })
    }

    fn run_with(
        mut self,
        generation: u32,
        program: impl FnOnce(Arc<LastCallSite>, *const Host, *mut c_void, c_int, *const *const c_char) -> c_int,
    ) -> Run {
        static SUPPORT: SupportTable = SupportTable::of::<FakeRobot>();
        static ROBIOS: Robios6Table = Robios6Table::of::<FakeRobot>();
        static ROBIOS7: Robios7Table = Robios7Table::of::<FakeRobot>();
        static HOST: Host = Host::of_robios6(&SUPPORT, &ROBIOS);
        static HOST7: Host = Host::of_robios7(&SUPPORT, &ROBIOS7);
        let host = if generation == 7 { &HOST7 } else { &HOST };
        let arguments: Vec<CString> = std::iter::once("program".to_owned())
            .chain(std::mem::take(&mut self.arguments))
            .map(|argument| CString::new(argument.replace('\0', "")).unwrap_or_default())
            .collect();
        let mut argv: Vec<*const c_char> = arguments.iter().map(|argument| argument.as_ptr()).collect();
        argv.push(std::ptr::null());
        let robot = FakeRobot::new(self, generation);
        let context = std::ptr::from_ref(&robot).cast_mut().cast();
        let code = program(robot.last_call_site.clone(), host, context, arguments.len() as c_int, argv.as_ptr());
        robot.end_tasks();
        robot.finish(code)
    }
}

/// Reason for the end of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The program's function returned without an error.
    Finished,
    /// The program panicked, returned an error, or did something that a robot program must not do.
    Failed {
        /// The exit code that a simulator would show.
        exit_code: i32,
        /// Description of the failure.
        reason: String,
    },
    /// The program was stopped at the limit of virtual time.
    TimeUp {
        /// The call in progress, with its location if the program is compiled into the test.
        during: String,
    },
}

impl Display for End {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finished => f.write_str("finished"),
            Self::Failed { exit_code, reason } => write!(f, "failed with exit code {exit_code}: {reason}"),
            Self::TimeUp { during } => write!(f, "still running when the time was up, in {during}"),
        }
    }
}

/// A call made by a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Call {
    /// Virtual time at the end of the call.
    pub time: Duration,
    /// Name of the function in RoBIOS.
    pub name: &'static str,
    /// The call with arguments and result, in the units of RoBIOS: `VWDriveStraight(1, 0.4, 0.2) = 0`.
    pub text: String,
    /// Location of the call, if the program is compiled into the test.
    pub location: Option<&'static Location<'static>>,
}

impl Display for Call {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4} s {}", self.time.as_secs_f64(), self.text)
    }
}

/// Record of a program's behaviour, from its start to its end.
#[derive(Clone, Debug)]
pub struct Run {
    end: End,
    time: Duration,
    position: Position,
    lcd: Vec<String>,
    console: String,
    sent: Vec<Sent>,
    calls: Vec<Call>,
}

impl Run {
    /// Reason for the program's end.
    pub fn end(&self) -> &End {
        &self.end
    }

    /// Returns the run if the program's function returned without an error.
    ///
    /// # Panics
    /// If the program ended otherwise; the message shows its end, its console and its last calls.
    #[track_caller]
    pub fn expect_finished(self) -> Self {
        assert!(self.end == End::Finished, "the program {}", self.summary());
        self
    }

    /// Returns the run if the program was stopped at the limit of virtual time, as expected of a program without end.
    ///
    /// # Panics
    /// If the program ended otherwise; the message shows its end, its console and its last calls.
    #[track_caller]
    pub fn expect_time_up(self) -> Self {
        assert!(matches!(self.end, End::TimeUp { .. }), "the program {}", self.summary());
        self
    }

    /// Reason of the program's failure.
    ///
    /// # Panics
    /// If the program did not fail; the message shows its end, its console and its last calls.
    #[track_caller]
    pub fn expect_failed(&self) -> &str {
        match &self.end {
            End::Failed { reason, .. } => reason,
            _ => panic!("the program {}", self.summary()),
        }
    }

    fn summary(&self) -> String {
        let start = self.calls.len().saturating_sub(10);
        let calls: Vec<String> = self.calls[start..].iter().map(|call| format!("  {call}")).collect();
        format!("{}\nconsole:\n{}\nlast calls:\n{}", self.end, self.console, calls.join("\n"))
    }

    /// Virtual time at the end.
    pub fn time(&self) -> Duration {
        self.time
    }

    /// True position at the end; it starts at 0.
    pub fn position(&self) -> Position {
        self.position
    }

    /// Text of a line of the display at the end of the run, without trailing blanks. Row 0 is at the top; a row beyond
    /// the display is empty.
    ///
    /// The display has 7 lines of 16 characters in RoBIOS 6, and 20 lines of 40 in RoBIOS-7 for every font; the last
    /// line is the menu.
    pub fn lcd_line(&self, row: usize) -> &str {
        self.lcd.get(row).map_or("", String::as_str)
    }

    /// All text written to the console.
    pub fn console(&self) -> &str {
        &self.console
    }

    /// All messages sent by radio, in order.
    pub fn sent(&self) -> &[Sent] {
        &self.sent
    }

    /// All calls, in order of their ends.
    pub fn calls(&self) -> &[Call] {
        &self.calls
    }

    /// The calls of one function, by its name in RoBIOS.
    pub fn calls_of<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Call> {
        self.calls.iter().filter(move |call| call.name == name)
    }
}
