//! The machine: its type, clock, timers and errors.

use std::time::Duration;

use robios_sys::robios7::{MAX_NAME, MAX_OUTPUT, PLATFORM, WALKER};
use robios_sys::{ByteBuffer, ByteSlice};

use super::Robot;
use crate::device::Device;
use crate::error::checked;
use crate::os::{MachineType, RobotNumber};
use crate::robot::{release, robios7};
use crate::time::{TimeOfDay, Timer, TimerJob};
use crate::unit::Frequency;
use crate::{Error, Result};

impl Robot {
    /// Calls a function periodically, until the returned timer is dropped.
    ///
    /// The function runs inside the call that is in progress when the timer is due, and is never re-entered. It must be
    /// short and must not wait. It gets the robot.
    ///
    /// ```
    /// # use robios_api::robios7::prelude::*;
    /// fn count(robot: &Robot) -> Result {
    ///     let mut count = 0;
    ///     let _timer = robot.every(1.millis(), move |robot| {
    ///         count += 1;
    ///         if count % 500 == 0 {
    ///             writeln!(robot.lcd(), "{count}");
    ///         }
    ///     })?;
    ///     robot.sleep(1.6.seconds());
    ///     Ok(())
    /// }
    /// # let run = robios_api::fake::Fake::new().run_robios7(count).expect_finished();
    /// # assert_eq!((run.lcd_line(1), run.lcd_line(2)), ("1000", "1500"));
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if the period is 0 or not a multiple of 1 ms; [`Error::Unavailable`] if there are too many
    /// timers already.
    #[track_caller]
    pub fn every(&self, period: Duration, mut function: impl FnMut(&Robot) + 'static) -> Result<Timer> {
        let scale = i32::try_from(period.as_millis()).unwrap_or(0);
        if scale == 0 || period != Duration::from_millis(scale as u64) {
            return Err(Error::OutOfRange {
                what: "period of a timer",
                value: format!("{period:?}"),
                accepted: "multiples of 1 ms from 1 ms on",
            });
        }
        let job = TimerJob::new(&self.0, Box::new(move |robot| function(&Self(robot.clone()))))?;
        let handle = robios7!(self, OSAttachTimer(scale, TimerJob::callback(&job)));
        Timer::attached(job, handle, |robot, handle| release!(robot, robios7, OSDetachTimer(handle)))
    }

    /// The robot's clock; it starts at 0:00:00.
    #[track_caller]
    pub fn clock(&self) -> TimeOfDay {
        let (mut hours, mut minutes, mut seconds, mut millis) = (0, 0, 0, 0);
        let _: i32 = robios7!(self, OSGetTime(&mut hours, &mut minutes, &mut seconds, &mut millis));
        let [hours, minutes, seconds, hundredths] =
            [hours, minutes, seconds, millis / 10].map(|part: i32| part.clamp(0, 255) as u8);
        TimeOfDay { hours, minutes, seconds, hundredths }
    }

    /// Sets the robot's clock, ignoring the hundredths. Virtual time is not affected.
    ///
    /// # Errors
    /// [`Error::Refused`] for an hour outside 0 to 23, or a minute or second outside 0 to 59.
    #[track_caller]
    pub fn set_clock(&self, time: TimeOfDay) -> Result {
        let code = robios7!(self, OSSetTime(time.hours.into(), time.minutes.into(), time.seconds.into()));
        checked("OSSetTime", Device::Clock, code)
    }

    /// Writes the clock to the display, at the cursor.
    #[track_caller]
    pub fn show_clock(&self) {
        let _: i32 = robios7!(self, OSShowTime());
    }

    /// Version of RoBIOS.
    #[track_caller]
    pub fn version(&self) -> String {
        let mut text = [0; MAX_NAME];
        let _: i32 = robios7!(self, OSVersion(ByteBuffer::from(&mut text[..])));
        text_of(&text)
    }

    /// The robot's name.
    #[track_caller]
    pub fn name(&self) -> String {
        let mut text = [0; MAX_NAME];
        let _: i32 = robios7!(self, OSMachineName(ByteBuffer::from(&mut text[..])));
        text_of(&text)
    }

    /// The robot's number.
    #[track_caller]
    pub fn id(&self) -> RobotNumber {
        let id: i32 = robios7!(self, OSMachineID());
        RobotNumber(id.clamp(0, 255) as u8)
    }

    /// Type of machine.
    #[track_caller]
    pub fn machine_type(&self) -> MachineType {
        match robios7!(self, OSMachineType()) {
            PLATFORM => MachineType::Platform,
            WALKER => MachineType::Walker,
            _ => MachineType::Vehicle,
        }
    }

    /// Clock rate of the robot's processor.
    #[track_caller]
    pub fn machine_speed(&self) -> Frequency {
        let rate: i32 = robios7!(self, OSMachineSpeed());
        Frequency::hertz(rate.into())
    }

    /// Shows an error on the display and in the record of the run, and waits for a key.
    #[track_caller]
    pub fn show_error(&self, message: &str, number: i32) {
        let _: i32 = robios7!(self, OSError(ByteSlice::from(message), number, 0));
    }

    /// Shows an error and blocks the robot forever.
    #[track_caller]
    pub fn halt(&self, message: &str, number: i32) -> ! {
        let _: i32 = robios7!(self, OSError(ByteSlice::from(message), number, 1));
        // Reached only if the host returns from a fatal error.
        loop {
            self.sleep(Duration::from_secs(1));
        }
    }

    /// Runs a shell command on the computer that runs the simulator, if allowed, and returns its output.
    ///
    /// # Errors
    /// [`Error::Refused`] if the command is not allowed or has failed.
    #[track_caller]
    pub fn execute(&self, command: &str) -> Result<String> {
        let mut output = [0; MAX_OUTPUT];
        let code = robios7!(self, OSExecute(ByteSlice::from(command), ByteBuffer::from(&mut output[..])));
        checked("OSExecute", Device::Shell, code)?;
        Ok(text_of(&output))
    }
}

/// Text in a buffer, up to the terminating 0.
fn text_of(buffer: &[u8]) -> String {
    let len = buffer.iter().position(|byte| *byte == 0).unwrap_or(buffer.len());
    String::from_utf8_lossy(&buffer[..len]).into_owned()
}
