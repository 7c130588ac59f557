//! What can go wrong in a call, and with which device.

use crate::device::Device;
use crate::os::RobotNumber;

/// The result of most calls.
pub type Result<T = (), E = Error> = std::result::Result<T, E>;

/// A call that could not do what it was asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The robot has no such device, or it is in use: the driving interface takes motors and encoders.
    #[error("the robot has no {0}, or it is in use already (the robi file lists what there is)")]
    Unavailable(Device),
    /// RoBIOS did not carry the call out.
    #[error("`{call}` was refused for the {device} with {code}")]
    Refused {
        /// The RoBIOS function.
        call: &'static str,
        /// The device.
        device: Device,
        /// What the function returned.
        code: i32,
    },
    /// A value that the device cannot take; nothing was called.
    #[error("`{value}` is no {what}, accepted: {accepted}")]
    OutOfRange {
        /// What the value was for.
        what: &'static str,
        /// The value.
        value: String,
        /// What is accepted.
        accepted: &'static str,
    },
    /// What cannot go together; nothing was called.
    #[error("{what} is not possible, instead: {instead}")]
    Unsuitable {
        /// What was asked for, and with what.
        what: &'static str,
        /// What to use in its place.
        instead: &'static str,
    },
    /// A message that is none of the expected kind, as one whose bits were inverted on its way.
    #[error("the message of {} bytes from robot {from} is no {expected}", bytes.len())]
    Garbled {
        /// Its sender.
        from: RobotNumber,
        /// What was received.
        bytes: Vec<u8>,
        /// What it should have been.
        expected: &'static str,
    },
    /// A sensor that was started gave no result in time.
    #[error("the {0} gave no result within a second")]
    NoResult(Device),
}

/// Turns the return code of a RoBIOS function to a result: 0 is good.
pub(crate) fn checked(call: &'static str, device: Device, code: i32) -> Result {
    if code == 0 { Ok(()) } else { Err(Error::Refused { call, device, code }) }
}
