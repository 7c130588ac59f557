//! Latches, the parallel port and the analogue inputs.

use crate::device::Device;
use crate::robot::robios;
use crate::{Error, Result, Robot};

/// Latches, parallel port and analogue inputs, as raw bytes.
#[derive(Clone, Copy, Debug)]
pub struct Ports<'r>(pub(crate) &'r Robot);

/// Value of an analogue input, 10 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AnalogValue(pub u16);

impl AnalogValue {
    /// Fraction of the full range, 0 to 1.
    pub fn fraction(self) -> f64 {
        f64::from(self.0) / 1023.0
    }
}

impl Ports<'_> {
    /// Reads input latch 0 to 3; 0 for other numbers.
    #[track_caller]
    pub fn input_latch(&self, number: u8) -> u8 {
        robios!(self.0, OSReadInLatch(number.into()))
    }

    /// Reads output latch 0 to 3; 0 for other numbers.
    #[track_caller]
    pub fn output_latch(&self, number: u8) -> u8 {
        robios!(self.0, OSReadOutLatch(number.into()))
    }

    /// Writes output latch 0 to 3: new = (old & `mask`) | `value`. Returns the old byte.
    #[track_caller]
    pub fn write_output_latch(&self, number: u8, mask: u8, value: u8) -> u8 {
        robios!(self.0, OSWriteOutLatch(number.into(), mask, value))
    }

    /// Reads the data byte of the parallel port.
    #[track_caller]
    pub fn parallel_data(&self) -> u8 {
        robios!(self.0, OSReadParData())
    }

    /// Writes the data byte of the parallel port.
    #[track_caller]
    pub fn write_parallel_data(&self, value: u8) {
        let () = robios!(self.0, OSWriteParData(value));
    }

    /// Reads the status byte of the parallel port.
    #[track_caller]
    pub fn parallel_status(&self) -> u8 {
        robios!(self.0, OSReadParSR())
    }

    /// Reads the control byte of the parallel port.
    #[track_caller]
    pub fn parallel_control(&self) -> u8 {
        robios!(self.0, OSReadParCTRL())
    }

    /// Writes the control byte of the parallel port.
    #[track_caller]
    pub fn write_parallel_control(&self, value: u8) {
        let () = robios!(self.0, OSWriteParCTRL(value));
    }

    /// Reads an analogue input, 0 to 15.
    ///
    /// # Errors
    /// [`Error::Refused`] for any other channel.
    #[track_caller]
    pub fn analog(&self, channel: u8) -> Result<AnalogValue> {
        let value: i32 = robios!(self.0, OSGetAD(channel.into()));
        match u16::try_from(value) {
            Ok(value) => Ok(AnalogValue(value)),
            Err(_negative) => Err(Error::Refused { call: "OSGetAD", device: Device::Analog, code: value }),
        }
    }

    /// Switches the analogue converter to idle.
    #[track_caller]
    pub fn idle_analog(&self) {
        let _: i32 = robios!(self.0, OSOffAD(1));
    }

    /// Switches the analogue converter off.
    #[track_caller]
    pub fn switch_analog_off(&self) {
        let _: i32 = robios!(self.0, OSOffAD(0));
    }
}
