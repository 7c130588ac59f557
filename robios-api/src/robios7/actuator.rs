//! Motors, wheel encoders and servos, by their numbers.

use super::Robot;
use crate::actuator::{ServoPosition, Ticks};
use crate::device::Device;
use crate::error::checked;
use crate::robot::robios7;
use crate::unit::{Frequency, Ratio};
use crate::{Error, Result};

/// A motor.
#[derive(Clone, Copy, Debug)]
pub struct Motor<'r> {
    robot: &'r Robot,
    number: u8,
}

/// A wheel encoder.
#[derive(Clone, Copy, Debug)]
pub struct Encoder<'r> {
    robot: &'r Robot,
    number: u8,
}

/// A servo.
#[derive(Clone, Copy, Debug)]
pub struct Servo<'r> {
    robot: &'r Robot,
    number: u8,
}

/// Gains of a motor's PID controller, each 0 to 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotorGains {
    /// Proportional.
    pub p: u8,
    /// Integral.
    pub i: u8,
    /// Differential.
    pub d: u8,
}

impl Robot {
    /// Motor 1 to 4.
    pub fn motor(&self, number: u8) -> Motor<'_> {
        Motor { robot: self, number }
    }

    /// Wheel encoder 1 to 4.
    pub fn encoder(&self, number: u8) -> Encoder<'_> {
        Encoder { robot: self, number }
    }

    /// Servo 1 to 14.
    pub fn servo(&self, number: u8) -> Servo<'_> {
        Servo { robot: self, number }
    }
}

impl Motor<'_> {
    fn checked(&self, call: &'static str, code: i32) -> Result {
        checked(call, Device::Numbered("motor", self.number), code)
    }

    /// Sets the motor's power as a ratio of full power, -100 (full backwards) to 100 percent, rounded to whole percent.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more than 100 percent; [`Error::Refused`] if the robot has no such motor.
    #[track_caller]
    pub fn set(&self, power: Ratio) -> Result {
        if power.abs() <= Ratio::percent(100.0) {
            let percent = power.as_percent().round() as i32;
            return self.checked("MOTORDrive", robios7!(self.robot, MOTORDrive(self.number.into(), percent)));
        }
        Err(Error::OutOfRange { what: "power of a motor", value: power.to_string(), accepted: "-100 to 100 %" })
    }

    /// Sets the motor's speed in encoder counts per second, negative for backwards.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such motor.
    #[track_caller]
    pub fn set_ticks(&self, rate: Frequency) -> Result {
        let ticks = rate.as_hertz().round() as i32;
        self.checked("MOTORSpeed", robios7!(self.robot, MOTORSpeed(self.number.into(), ticks)))
    }

    /// Starts the motor's PID controller.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such motor.
    #[track_caller]
    pub fn start_control(&self, gains: MotorGains) -> Result {
        let MotorGains { p, i, d } = gains;
        self.checked("MOTORPID", robios7!(self.robot, MOTORPID(self.number.into(), p.into(), i.into(), d.into())))
    }

    /// Stops the motor's PID controller.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such motor.
    #[track_caller]
    pub fn stop_control(&self) -> Result {
        self.checked("MOTORPIDOff", robios7!(self.robot, MOTORPIDOff(self.number.into())))
    }
}

impl Encoder<'_> {
    /// Count since the reset; it increases when the wheel turns forward. 0 if the robot has no such encoder.
    #[track_caller]
    pub fn ticks(&self) -> Ticks {
        Ticks(robios7!(self.robot, ENCODERRead(self.number.into())))
    }

    /// Sets the count to 0.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such encoder.
    #[track_caller]
    pub fn reset(&self) -> Result {
        let code = robios7!(self.robot, ENCODERReset(self.number.into()));
        checked("ENCODERReset", Device::Numbered("encoder", self.number), code)
    }
}

impl Servo<'_> {
    /// Turns the servo.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such servo.
    #[track_caller]
    pub fn set(&self, position: ServoPosition) -> Result {
        let code = robios7!(self.robot, SERVOSet(self.number.into(), position.0.into()));
        checked("SERVOSet", Device::Numbered("servo", self.number), code)
    }

    /// Sets the raw positions of the servo for the positions 0 and 255.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such servo.
    #[track_caller]
    pub fn set_range(&self, low: u8, high: u8) -> Result {
        let code = robios7!(self.robot, SERVORange(self.number.into(), low.into(), high.into()));
        checked("SERVORange", Device::Numbered("servo", self.number), code)
    }
}
