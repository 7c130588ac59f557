//! Motors, wheel encoders and servos.

use robios_sys::robios6::{MotorHandle, QuadHandle, ServoHandle};

use crate::device::{Device, EncoderAt, MotorAt, ServoAt};
use crate::error::checked;
use crate::robot::{release, robios};
use crate::unit::{Length, Ratio};
use crate::{Error, Result, Robot};

/// A motor; dropping the value stops the motor.
#[derive(Debug)]
pub struct Motor {
    robot: Robot,
    at: MotorAt,
    handle: MotorHandle,
}

/// A wheel encoder.
#[derive(Debug)]
pub struct Encoder {
    robot: Robot,
    at: EncoderAt,
    handle: QuadHandle,
}

/// A servo.
#[derive(Debug)]
pub struct Servo {
    robot: Robot,
    at: ServoAt,
    handle: ServoHandle,
}

/// Position of a servo: 0 is one end of its range, 255 the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ServoPosition(pub u8);

impl ServoPosition {
    /// One end.
    pub const MIN: Self = Self(0);
    /// The middle.
    pub const MIDDLE: Self = Self(127);
    /// The other end.
    pub const MAX: Self = Self(255);
}

/// Count of a wheel encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticks(pub i32);

impl Robot {
    /// Initialises a motor.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such motor or the driving interface uses it.
    #[track_caller]
    pub fn motor(&self, at: MotorAt) -> Result<Motor> {
        match robios!(self, MOTORInit(at.semantics())) {
            0 => Err(Error::Unavailable(Device::Motor(at))),
            handle => Ok(Motor { robot: self.clone(), at, handle }),
        }
    }

    /// Initialises a wheel encoder; its count starts at 0.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such encoder.
    #[track_caller]
    pub fn encoder(&self, at: EncoderAt) -> Result<Encoder> {
        match robios!(self, QUADInit(at.semantics())) {
            0 => Err(Error::Unavailable(Device::Encoder(at))),
            handle => Ok(Encoder { robot: self.clone(), at, handle }),
        }
    }

    /// Initialises a servo.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such servo.
    #[track_caller]
    pub fn servo(&self, at: ServoAt) -> Result<Servo> {
        match robios!(self, SERVOInit(at.semantics())) {
            0 => Err(Error::Unavailable(Device::Servo(at))),
            handle => Ok(Servo { robot: self.clone(), at, handle }),
        }
    }

    /// The motor that belongs to an encoder; `None` if the robot has no such encoder.
    #[track_caller]
    pub fn motor_of(&self, encoder: EncoderAt) -> Option<MotorAt> {
        match robios!(self, QUADGetMotor(encoder.semantics())) {
            0 => None,
            semantics => Some(MotorAt::from_semantics(semantics)),
        }
    }
}

impl Motor {
    /// Sets the motor's power as a ratio of full power, -100 (full backwards) to 100 percent, rounded to whole percent.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more than 100 percent.
    #[track_caller]
    pub fn set(&self, power: Ratio) -> Result {
        if power.abs() <= Ratio::percent(100.0) {
            let code = robios!(&self.robot, MOTORDrive(self.handle, power.as_percent().round() as i32));
            return checked("MOTORDrive", Device::Motor(self.at), code);
        }
        Err(Error::OutOfRange { what: "power of a motor", value: power.to_string(), accepted: "-100 to 100 %" })
    }
}

impl Encoder {
    /// Count since the reset; it increases when the wheel turns forward.
    #[track_caller]
    pub fn ticks(&self) -> Ticks {
        Ticks(robios!(&self.robot, QUADRead(self.handle)))
    }

    /// Sets the count to 0.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn reset(&self) -> Result {
        checked("QUADReset", Device::Encoder(self.at), robios!(&self.robot, QUADReset(self.handle)))
    }

    /// Distance rolled by the wheel since [`reset_distance`](Self::reset_distance).
    #[track_caller]
    pub fn distance(&self) -> Length {
        Length::from_robios(robios!(&self.robot, QUADODORead(self.handle)))
    }

    /// Sets the rolled distance to 0; the count is unchanged.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn reset_distance(&self) -> Result {
        checked("QUADODOReset", Device::Encoder(self.at), robios!(&self.robot, QUADODOReset(self.handle)))
    }
}

impl Servo {
    /// Turns the servo.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn set(&self, position: ServoPosition) -> Result {
        let code = robios!(&self.robot, SERVOSet(self.handle, position.0.into()));
        checked("SERVOSet", Device::Servo(self.at), code)
    }
}

impl Drop for Motor {
    fn drop(&mut self) {
        release!(&self.robot, MOTORRelease(self.handle));
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        release!(&self.robot, QUADRelease(self.handle));
    }
}

impl Drop for Servo {
    fn drop(&mut self) {
        release!(&self.robot, SERVORelease(self.handle));
    }
}
