//! The radio: messages between robots.
//!
//! The channel is defined by the scene: messages may be late, lost, or arrive with inverted bits.

use std::time::Duration;

use robios_sys::robios6::{BROADCAST, MAXMSGLEN, RadioIOParameters, RadioStatus as RawStatus};
use robios_sys::{ByteBuffer, ByteSlice};

use crate::device::Device;
#[cfg(feature = "serde")]
use crate::encoding;
use crate::error::checked;
use crate::os::RobotNumber;
use crate::robot::{ProgramState, locked, release, robios};
use crate::serial::Baud;
use crate::{Error, Result, Robot};

/// Maximum length of a message in bytes: `MAXMSGLEN`.
pub const MAX_MESSAGE: usize = MAXMSGLEN as usize;

/// Polling interval of calls that wait for a message with a timeout.
pub(crate) const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// The radio, switched on; dropping the last instance switches it off.
#[derive(Debug)]
pub struct Radio {
    robot: Robot,
}

/// Settings of the radio, applied before it is switched on; `None` leaves a setting unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RadioSettings {
    /// Bit rate of sending and receiving; a receiver with another rate receives nothing. Initially the scene's rate.
    pub speed: Option<Baud>,
    /// Address of the radio. Initially the robot's number.
    pub id: Option<RobotNumber>,
}

/// A message that was received.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Address of the sender.
    pub from: RobotNumber,
    /// Payload; the channel may have inverted bits.
    pub bytes: Vec<u8>,
}

/// State of the radio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RadioStatus {
    /// The radio's address.
    pub id: RobotNumber,
    /// Number of messages sent.
    pub sent: u32,
    /// Number of messages received.
    pub received: u32,
    /// Number of messages that wait to be received.
    pub waiting: u32,
}

impl RobotNumber {
    /// The broadcast address.
    pub const ALL: Self = Self(BROADCAST as u8);
}

impl Message {
    /// Payload as text.
    ///
    /// # Errors
    /// [`Error::Garbled`] if the payload is not UTF-8.
    pub fn text(&self) -> Result<&str> {
        let garbled = |_error| Error::Garbled { from: self.from, bytes: self.bytes.clone(), expected: "text" };
        std::str::from_utf8(&self.bytes).map_err(garbled)
    }
}

impl ProgramState {
    /// Counts a new [`Radio`]; returns true for the first one, for which the caller switches the radio on.
    pub(crate) fn add_radio(&self) -> bool {
        let mut radios = locked(&self.radios);
        *radios += 1;
        *radios == 1
    }

    /// Counts a dropped [`Radio`]; returns true for the last one, after which the caller switches the radio off.
    pub(crate) fn remove_radio(&self) -> bool {
        let mut radios = locked(&self.radios);
        *radios -= 1;
        *radios == 0
    }
}

impl Robot {
    /// Switches the radio on.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// # use robios_api::RobotNumber;
    /// fn ask(robot: &Robot) -> Result {
    ///     let radio = robot.radio()?;
    ///     radio.send(RobotNumber(2), b"where are you?")?;
    ///     match radio.receive_within(1.seconds())? {
    ///         Some(answer) => writeln!(robot.lcd(), "{}: {}", answer.from, answer.text()?),
    ///         None => writeln!(robot.lcd(), "no answer"),
    ///     }
    ///     Ok(())
    /// }
    /// # let fake = robios_api::fake::Fake::new().message(200.millis(), RobotNumber(2), *b"here");
    /// # let run = fake.run(ask).expect_finished();
    /// # assert_eq!(run.lcd_line(0), "2: here");
    /// # assert_eq!(run.sent()[0].bytes, b"where are you?");
    /// ```
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn radio(&self) -> Result<Radio> {
        self.radio_with(RadioSettings::default())
    }

    /// Switches the radio on, with these settings.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call, for example for other settings while the radio is on.
    #[track_caller]
    pub fn radio_with(&self, settings: RadioSettings) -> Result<Radio> {
        if settings != RadioSettings::default() {
            let mut parameters = self.radio_parameters()?;
            parameters.speed = settings.speed.map_or(parameters.speed, Baud::rate);
            parameters.id = settings.id.map_or(parameters.id, |id| id.0.into());
            checked("RADIOSetIoctl", Device::Radio, robios!(self, RADIOSetIoctl(&parameters)))?;
        }
        // The radio is counted before the call, at whose end another task may run and request the radio as well.
        if self.common().add_radio()
            && let Err(error) = checked("RADIOInit", Device::Radio, robios!(self, RADIOInit()))
        {
            self.common().remove_radio();
            return Err(error);
        }
        Ok(Radio { robot: self.clone() })
    }

    #[track_caller]
    fn radio_parameters(&self) -> Result<RadioIOParameters> {
        let mut parameters = RadioIOParameters::default();
        checked("RADIOGetIoctl", Device::Radio, robios!(self, RADIOGetIoctl(&mut parameters)))?;
        Ok(parameters)
    }
}

impl Radio {
    /// Sends a message to one robot; does not wait. Success does not mean that the message arrives.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more than [`MAX_MESSAGE`] bytes; [`Error::Refused`] with 1 while the radio's send
    /// buffer is full.
    #[track_caller]
    pub fn send(&self, to: RobotNumber, bytes: &[u8]) -> Result {
        if bytes.len() > MAX_MESSAGE {
            return Err(Error::OutOfRange {
                what: "length of a message in bytes",
                value: bytes.len().to_string(),
                accepted: "up to 35",
            });
        }
        checked("RADIOSend", Device::Radio, robios!(&self.robot, RADIOSend(to.0, ByteSlice::from(bytes))))
    }

    /// Sends a message to all robots; does not wait.
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
        let (mut from, mut len, mut buffer) = (0, 0, [0; MAX_MESSAGE]);
        let code = robios!(&self.robot, RADIORecv(&mut from, &mut len, ByteBuffer::from(&mut buffer[..])));
        checked("RADIORecv", Device::Radio, code)?;
        let len = usize::try_from(len).unwrap_or(0).min(MAX_MESSAGE);
        Ok(Message { from: RobotNumber(from), bytes: buffer[..len].to_vec() })
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
        let count: i32 = robios!(&self.robot, RADIOCheck());
        usize::try_from(count).unwrap_or(0)
    }

    /// State of the radio.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn status(&self) -> Result<RadioStatus> {
        let mut raw = RawStatus::default();
        checked("RADIOGetStatus", Device::Radio, robios!(&self.robot, RADIOGetStatus(&mut raw)))?;
        let [sent, received, waiting] = [raw.sent, raw.received, raw.waiting].map(|count| count.max(0) as u32);
        Ok(RadioStatus { id: RobotNumber(raw.id.clamp(0, 255) as u8), sent, received, waiting })
    }

    /// Current settings of the radio.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn settings(&self) -> Result<RadioSettings> {
        let parameters = self.robot.radio_parameters()?;
        let speed = Baud::ALL.into_iter().find(|speed| speed.rate() == parameters.speed);
        Ok(RadioSettings { speed, id: u8::try_from(parameters.id).ok().map(RobotNumber) })
    }
}

/// Typed messages, encoded by `postcard` without a checksum. Requires the feature `serde`.
#[cfg(feature = "serde")]
impl Radio {
    /// Sends a value to one robot; does not wait.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// # use robios_api::RobotNumber;
    /// #[derive(serde::Serialize, serde::Deserialize)]
    /// struct Pose {
    ///     x_mm: i16,
    ///     y_mm: i16,
    /// }
    ///
    /// fn tell(robot: &Robot) -> Result {
    ///     let radio = robot.radio()?;
    ///     radio.send_as(RobotNumber::ALL, &Pose { x_mm: 300, y_mm: -20 })?;
    ///     match radio.receive_as::<Pose>() {
    ///         Ok((from, pose)) => writeln!(robot.lcd(), "{from} at {} {}", pose.x_mm, pose.y_mm),
    ///         Err(Error::Garbled { from, .. }) => writeln!(robot.lcd(), "{from}?"),
    ///         Err(error) => return Err(error),
    ///     }
    ///     Ok(())
    /// }
    /// # let fake = || robios_api::fake::Fake::new();
    /// # let run = fake().message(200.millis(), RobotNumber(3), [3, 4]).run(tell).expect_finished();
    /// # assert_eq!(run.lcd_line(0), "3 at -2 2");
    /// # let run = fake().message(200.millis(), RobotNumber(3), [3]).run(tell).expect_finished();
    /// # assert_eq!(run.lcd_line(0), "3?");
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if the value takes more than [`MAX_MESSAGE`] bytes or cannot be encoded; otherwise see
    /// [`send`](Self::send).
    #[track_caller]
    pub fn send_as<T: serde::Serialize>(&self, to: RobotNumber, value: &T) -> Result {
        self.send(to, &encoding::encoded(value)?)
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
        encoding::decoded(message)
    }
}

impl Drop for Radio {
    fn drop(&mut self) {
        if self.robot.common().remove_radio() {
            release!(&self.robot, RADIOTerm());
        }
    }
}
