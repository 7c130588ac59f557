//! Errors of RoBIOS calls, with the devices that they concern.

use crate::device::Device;
use crate::os::RobotNumber;

/// The result of most calls.
pub type Result<T = (), E = Error> = std::result::Result<T, E>;

/// Error of a call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The robot has no such device, or the device is in use, for example a motor by the driving interface.
    #[error("the robot has no {0}, or it is in use already (the robi file lists its devices)")]
    Unavailable(Device),
    /// RoBIOS refused the call.
    #[error("`{call}` was refused for the {device} with {code}")]
    Refused {
        /// The RoBIOS function.
        call: &'static str,
        /// The device.
        device: Device,
        /// Return code of the function.
        code: i32,
    },
    /// A value is out of range; no call was made.
    #[error("`{value}` is not a valid {what}, accepted: {accepted}")]
    OutOfRange {
        /// Kind of value that was expected.
        what: &'static str,
        /// The value.
        value: String,
        /// Accepted values.
        accepted: &'static str,
    },
    /// The requested combination is not possible; no call was made.
    #[error("{what} is not possible, instead: {instead}")]
    Unsuitable {
        /// Requested combination.
        what: &'static str,
        /// Replacement to use.
        instead: &'static str,
    },
    /// A message is not of the expected kind, for example because bits were inverted in transmission.
    #[error("the message of {} bytes from robot {from} is not {expected}", bytes.len())]
    Garbled {
        /// Sender of the message.
        from: RobotNumber,
        /// Received bytes.
        bytes: Vec<u8>,
        /// Expected kind of content.
        expected: &'static str,
    },
    /// A started sensor delivered no result in time.
    #[error("the {0} gave no result within a second")]
    NoResult(Device),
}

/// Converts the return code of a RoBIOS function to a result: 0 is success.
pub(crate) fn checked(call: &'static str, device: Device, code: i32) -> Result {
    if code == 0 { Ok(()) } else { Err(Error::Refused { call, device, code }) }
}
