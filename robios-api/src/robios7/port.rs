//! Digital and analogue inputs and outputs.

use std::fmt::{self, Display, Formatter};

use super::Robot;
use crate::device::Device;
use crate::error::checked;
use crate::port::AnalogValue;
use crate::robot::robios7;
use crate::{Error, Result};

/// Digital and analogue inputs and outputs.
#[derive(Clone, Copy, Debug)]
pub struct Ports<'r>(pub(super) &'r Robot);

/// Direction of a digital line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// An input.
    In,
    /// An output.
    Out,
    /// An input with pull-up: high when not driven.
    InPulledUp,
    /// An input with pull-down: low when not driven.
    InPulledDown,
}

/// A voltage, in hundredths of a volt as in RoBIOS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Voltage(i32);

impl Voltage {
    /// Value in volts.
    pub fn as_volts(self) -> f64 {
        f64::from(self.0) / 100.0
    }
}

impl Display for Voltage {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} V", self.as_volts())
    }
}

fn line_device(number: u8) -> Device {
    Device::Numbered("digital line", number)
}

impl Ports<'_> {
    /// Sets the direction of digital line 1 to 16.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such line.
    #[track_caller]
    pub fn set_direction(&self, number: u8, direction: Direction) -> Result {
        let direction = match direction {
            Direction::In => b'i',
            Direction::Out => b'o',
            Direction::InPulledUp => b'I',
            Direction::InPulledDown => b'J',
        };
        checked("DIGITALSetup", line_device(number), robios7!(self.0, DIGITALSetup(number.into(), direction)))
    }

    /// Returns true if digital line 1 to 16 is high.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such line.
    #[track_caller]
    pub fn is_high(&self, number: u8) -> Result<bool> {
        match robios7!(self.0, DIGITALRead(number.into())) {
            code @ (0 | 1) => Ok(code == 1),
            code => Err(Error::Refused { call: "DIGITALRead", device: line_device(number), code }),
        }
    }

    /// States of all digital lines, line 1 in the lowest bit.
    #[track_caller]
    pub fn lines(&self) -> u16 {
        let lines: i32 = robios7!(self.0, DIGITALReadAll());
        lines as u16
    }

    /// Makes an output high or low.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such line, or it is not an output.
    #[track_caller]
    pub fn set(&self, number: u8, is_high: bool) -> Result {
        checked("DIGITALWrite", line_device(number), robios7!(self.0, DIGITALWrite(number.into(), is_high.into())))
    }

    /// Reads analogue channel 0 to 8.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such channel.
    #[track_caller]
    pub fn analog(&self, channel: u8) -> Result<AnalogValue> {
        let value: i32 = robios7!(self.0, ANALOGRead(channel.into()));
        let device = Device::Numbered("analogue channel", channel);
        u16::try_from(value).map(AnalogValue).map_err(|_negative| Error::Refused {
            call: "ANALOGRead",
            device,
            code: value,
        })
    }

    /// The battery's voltage.
    #[track_caller]
    pub fn battery(&self) -> Voltage {
        Voltage(robios7!(self.0, ANALOGVoltage()))
    }
}
