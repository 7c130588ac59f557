//! Serial interfaces.

use robios_sys::robios6::{
    NONE, RTSCTS, SER4800, SER9600, SER19200, SER38400, SER57600, SER115200, SERIAL1, SERIAL2, SERIAL3,
};

use crate::device::Device;
use crate::error::checked;
use crate::robot::robios;
use crate::{Error, Result, Robot};

/// An open serial interface.
#[derive(Debug)]
pub struct Serial {
    robot: Robot,
    interface: i32,
}

/// Name of a serial interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SerialAt {
    /// The first.
    Serial1,
    /// The second.
    Serial2,
    /// The third.
    Serial3,
}

/// Rate of a serial interface, or of the radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Baud {
    /// 4,800 baud.
    B4800,
    /// 9,600 baud.
    B9600,
    /// 19,200 baud.
    B19200,
    /// 38,400 baud.
    B38400,
    /// 57,600 baud.
    B57600,
    /// 115,200 baud.
    B115200,
}

impl Baud {
    /// All rates.
    pub const ALL: [Self; 6] = [Self::B4800, Self::B9600, Self::B19200, Self::B38400, Self::B57600, Self::B115200];

    /// Value of the rate in RoBIOS.
    pub(crate) const fn rate(self) -> i32 {
        match self {
            Self::B4800 => SER4800,
            Self::B9600 => SER9600,
            Self::B19200 => SER19200,
            Self::B38400 => SER38400,
            Self::B57600 => SER57600,
            Self::B115200 => SER115200,
        }
    }
}

/// Handshake of a serial interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handshake {
    /// None.
    None,
    /// By the lines RTS and CTS.
    RtsCts,
}

impl Robot {
    /// Opens a serial interface.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no such interface.
    #[track_caller]
    pub fn serial(&self, at: SerialAt, baud: Baud, handshake: Handshake) -> Result<Serial> {
        let interface = match at {
            SerialAt::Serial1 => SERIAL1,
            SerialAt::Serial2 => SERIAL2,
            SerialAt::Serial3 => SERIAL3,
        };
        let handshake = match handshake {
            Handshake::None => NONE,
            Handshake::RtsCts => RTSCTS,
        };
        checked("OSInitRS232", Device::Serial, robios!(self, OSInitRS232(baud.rate(), handshake, interface)))?;
        Ok(Serial { robot: self.clone(), interface })
    }
}

impl Serial {
    /// Sends bytes with one call for each byte, since `OSSendRS232` takes only text.
    ///
    /// # Errors
    /// [`Error::Refused`] at the first byte that is not accepted.
    #[track_caller]
    pub fn send(&self, bytes: &[u8]) -> Result {
        for byte in bytes {
            let code = robios!(&self.robot, OSSendCharRS232(*byte, self.interface));
            checked("OSSendCharRS232", Device::Serial, code)?;
        }
        Ok(())
    }

    /// Sends text in one call.
    ///
    /// # Errors
    /// [`Error::Refused`] if the text is not accepted.
    #[track_caller]
    pub fn send_text(&self, text: &str) -> Result {
        let code = robios!(&self.robot, OSSendRS232(text.into(), self.interface));
        checked("OSSendRS232", Device::Serial, code)
    }

    /// Waits for a byte.
    ///
    /// # Errors
    /// [`Error::Refused`] if nothing can be received.
    #[track_caller]
    pub fn receive(&self) -> Result<u8> {
        let mut byte = 0;
        let code = robios!(&self.robot, OSRecvRS232(&mut byte, self.interface));
        checked("OSRecvRS232", Device::Serial, code)?;
        Ok(byte)
    }

    /// Number of bytes received and not yet read.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn bytes_received(&self) -> Result<usize> {
        count_of("OSCheckInRS232", robios!(&self.robot, OSCheckInRS232(self.interface)))
    }

    /// Number of bytes not yet sent.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn bytes_unsent(&self) -> Result<usize> {
        count_of("OSCheckOutRS232", robios!(&self.robot, OSCheckOutRS232(self.interface)))
    }

    /// Discards received bytes.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn drop_received(&self) -> Result {
        checked("OSFlushInRS232", Device::Serial, robios!(&self.robot, OSFlushInRS232(self.interface)))
    }

    /// Discards bytes not yet sent.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn drop_unsent(&self) -> Result {
        checked("OSFlushOutRS232", Device::Serial, robios!(&self.robot, OSFlushOutRS232(self.interface)))
    }
}

/// Converts the count returned by a call to a result; a negative count is a failure.
fn count_of(call: &'static str, code: i32) -> Result<usize> {
    usize::try_from(code).map_err(|_negative| Error::Refused { call, device: Device::Serial, code })
}
