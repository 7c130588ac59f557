//! Serial interfaces.

use robios_sys::robios7::MAX_SERIAL;
use robios_sys::{ByteBuffer, ByteSlice};

use super::Robot;
use crate::Result;
use crate::device::Device;
use crate::error::checked;
use crate::robot::{release, robios7};
use crate::serial::Handshake;

/// Rate of a serial interface, in baud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Baud(pub u32);

/// An open serial interface; dropping the value closes it.
#[derive(Debug)]
pub struct Serial {
    robot: Robot,
    number: u8,
}

impl Robot {
    /// Opens the serial interface with this number, 1 to 16.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if the robot has no such interface, or does not support the rate.
    #[track_caller]
    pub fn serial(&self, number: u8, baud: Baud, handshake: Handshake) -> Result<Serial> {
        let handshake = i32::from(handshake == Handshake::RtsCts);
        let baud = i32::try_from(baud.0).unwrap_or(i32::MAX);
        let code = robios7!(self, SERInit(number.into(), baud, handshake));
        checked("SERInit", Device::Numbered("serial interface", number), code)?;
        Ok(Serial { robot: self.clone(), number })
    }
}

impl Serial {
    /// Sends bytes.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the bytes.
    #[track_caller]
    pub fn send(&self, bytes: &[u8]) -> Result {
        let code = robios7!(self.robot, SERSend(self.number.into(), ByteSlice::from(bytes)));
        checked("SERSend", Device::Numbered("serial interface", self.number), code)
    }

    /// Waits for a byte and returns it.
    #[track_caller]
    pub fn wait(&self) -> u8 {
        robios7!(self.robot, SERReceiveChar(self.number.into()))
    }

    /// Bytes received and not yet read, at most 255; does not wait.
    #[track_caller]
    pub fn read(&self) -> Vec<u8> {
        let mut buffer = [0; MAX_SERIAL];
        let len: i32 = robios7!(self.robot, SERReceive(self.number.into(), ByteBuffer::from(&mut buffer[..])));
        buffer[..usize::try_from(len).unwrap_or(0).min(MAX_SERIAL)].to_vec()
    }

    /// Returns true if bytes have been received and not yet read.
    #[track_caller]
    pub fn has_received(&self) -> bool {
        robios7!(self.robot, SERCheck(self.number.into())) != 0_u8
    }

    /// Discards received bytes.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the call.
    #[track_caller]
    pub fn drop_received(&self) -> Result {
        let code = robios7!(self.robot, SERFlush(self.number.into()));
        checked("SERFlush", Device::Numbered("serial interface", self.number), code)
    }
}

impl Drop for Serial {
    fn drop(&mut self) {
        release!(&self.robot.0, robios7, SERClose(self.number.into()));
    }
}
