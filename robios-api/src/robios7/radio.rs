//! The radio: texts between robots.

use std::time::Duration;

use robios_sys::robios7::MAX_RADIO_IDS;
use robios_sys::{ByteBuffer, ByteSlice};

use super::Robot;
use crate::device::Device;
#[cfg(feature = "serde")]
use crate::encoding;
use crate::error::checked;
use crate::os::RobotNumber;
use crate::radio::{Message, POLL_INTERVAL};
use crate::robot::{release, robios7};
use crate::{Error, Result};

/// Maximum length of a message in bytes, a choice of this simulator.
pub const MAX_MESSAGE: usize = 1023;

/// The radio, switched on; dropping the last instance switches it off.
#[derive(Debug)]
pub struct Radio {
    robot: Robot,
}

impl Robot {
    /// Switches the radio on.
    ///
    /// ```
    /// # use robios_api::robios7::prelude::*;
    /// # use robios_api::RobotNumber;
    /// fn greet(robot: &Robot) -> Result {
    ///     let radio = robot.radio()?;
    ///     radio.broadcast(b"who is there?")?;
    ///     while let Some(answer) = radio.receive_within(1.seconds())? {
    ///         writeln!(robot.lcd(), "{}: {}", answer.from, answer.text()?);
    ///     }
    ///     Ok(())
    /// }
    /// # let fake = robios_api::fake::Fake::new().message(200.millis(), RobotNumber(2), *b"me");
    /// # let run = fake.message(300.millis(), RobotNumber(3), *b"me too").run_robios7(greet).expect_finished();
    /// # assert_eq!((run.lcd_line(0), run.lcd_line(1)), ("2: me", "3: me too"));
    /// ```
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn radio(&self) -> Result<Radio> {
        let common = self.0.common();
        if common.add_radio()
            && let Err(error) = checked("RADIOInit", Device::Radio, robios7!(self, RADIOInit()))
        {
            common.remove_radio();
            return Err(error);
        }
        Ok(Radio { robot: self.clone() })
    }
}

impl Radio {
    /// Sends bytes, such as UTF-8 text, to one robot; does not wait. Success does not mean that they arrive.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more than [`MAX_MESSAGE`] bytes, or a 0 among them, which would end the message;
    /// [`Error::Refused`] while the radio's send buffer is full.
    #[track_caller]
    pub fn send(&self, to: RobotNumber, bytes: &[u8]) -> Result {
        if bytes.len() > MAX_MESSAGE {
            return Err(Error::OutOfRange {
                what: "length of a message in bytes",
                value: bytes.len().to_string(),
                accepted: "up to 1023",
            });
        }
        if bytes.contains(&0) {
            return Err(Error::OutOfRange {
                what: "byte of a message",
                value: "0".to_owned(),
                accepted: "1 to 255; `send_as` sends anything",
            });
        }
        checked("RADIOSend", Device::Radio, robios7!(self.robot, RADIOSend(to.0.into(), ByteSlice::from(bytes))))
    }

    /// Sends bytes to all robots; does not wait.
    ///
    /// # Errors
    /// See [`send`](Self::send).
    #[track_caller]
    pub fn broadcast(&self, bytes: &[u8]) -> Result {
        self.send(RobotNumber::ALL, bytes)
    }

    /// Waits for a message.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn receive(&self) -> Result<Message> {
        let (mut from, mut buffer) = (0, [0; MAX_MESSAGE + 1]);
        let code = robios7!(self.robot, RADIOReceive(&mut from, ByteBuffer::from(&mut buffer[..])));
        checked("RADIOReceive", Device::Radio, code)?;
        let len = buffer.iter().position(|byte| *byte == 0).unwrap_or(MAX_MESSAGE);
        Ok(Message { from: RobotNumber(from.clamp(0, 255) as u8), bytes: buffer[..len].to_vec() })
    }

    /// Returns the next waiting message, if any.
    ///
    /// # Errors
    /// See [`receive`](Self::receive).
    #[track_caller]
    pub fn try_receive(&self) -> Result<Option<Message>> {
        if self.waiting() == 0 { Ok(None) } else { self.receive().map(Some) }
    }

    /// Waits for a message for at most `span`; `None` at the timeout. Polls every millisecond.
    ///
    /// # Errors
    /// See [`receive`](Self::receive).
    #[track_caller]
    pub fn receive_within(&self, span: Duration) -> Result<Option<Message>> {
        let end = self.robot.now() + span;
        loop {
            let message = self.try_receive()?;
            if message.is_some() || self.robot.now() >= end {
                return Ok(message);
            }
            self.robot.sleep(POLL_INTERVAL);
        }
    }

    /// Number of messages that wait to be received.
    #[track_caller]
    pub fn waiting(&self) -> usize {
        let count: i32 = robios7!(self.robot, RADIOCheck());
        usize::try_from(count).unwrap_or(0)
    }

    /// The robot's address.
    #[track_caller]
    pub fn id(&self) -> RobotNumber {
        let id: i32 = robios7!(self.robot, RADIOGetID());
        RobotNumber(id.clamp(0, 255) as u8)
    }

    /// Addresses of all robots whose radio is on, including this one. In the slot in which this radio was switched on, waits
    /// for the end of the slot.
    #[track_caller]
    pub fn robots(&self) -> Vec<RobotNumber> {
        let mut ids = [0_i32; MAX_RADIO_IDS];
        let buffer = ByteBuffer { data: ids.as_mut_ptr().cast(), len: ids.len() };
        let count: i32 = robios7!(self.robot, RADIOStatus(buffer));
        let count = usize::try_from(count).unwrap_or(0).min(MAX_RADIO_IDS);
        ids[..count].iter().map(|id| RobotNumber((*id).clamp(0, 255) as u8)).collect()
    }
}

/// Typed messages, encoded by `postcard` and `cobs`, without a 0 byte and without a checksum. Requires the feature
/// `serde`.
#[cfg(feature = "serde")]
impl Radio {
    /// Sends a value to one robot; does not wait.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if the value takes more than [`MAX_MESSAGE`] bytes or cannot be encoded; otherwise see
    /// [`send`](Self::send).
    #[track_caller]
    pub fn send_as<T: serde::Serialize>(&self, to: RobotNumber, value: &T) -> Result {
        self.send(to, &encoding::encoded_without_zero(value)?)
    }

    /// Waits for a value and returns it with the address of its sender.
    ///
    /// # Errors
    /// [`Error::Garbled`] if the bytes of the message are not exactly one encoded value. Inverted bits cause this error
    /// or a wrong value; only a checksum in the value detects a wrong value. Otherwise see [`receive`](Self::receive).
    #[track_caller]
    pub fn receive_as<T: serde::de::DeserializeOwned>(&self) -> Result<(RobotNumber, T)> {
        let message = self.receive()?;
        Ok((message.from, self.decode(&message)?))
    }

    /// Decodes the value of a message.
    ///
    /// # Errors
    /// [`Error::Garbled`], see [`receive_as`](Self::receive_as).
    pub fn decode<T: serde::de::DeserializeOwned>(&self, message: &Message) -> Result<T> {
        encoding::decoded_without_zero(message)
    }
}

impl Drop for Radio {
    fn drop(&mut self) {
        if self.robot.0.common().remove_radio() {
            release!(&self.robot.0, robios7, RADIORelease());
        }
    }
}
