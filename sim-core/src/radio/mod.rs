//! Messages between robots: the channel that carries them, and the station of each robot.
//!
//! Within a simulation slot a robot sends and receives only through its own [`Station`]. At the slot's end the
//! [`Channel`] takes the sent messages. It decides for each message and station whether and when the message is
//! received, and with which bit errors; the result is a [`Delivery`].
//!
//! Source: Koestler & Bräunl, sections 5.1 and 6.2. The timing rules are our choice: see docs/radio.md.

mod air;
mod channel;
mod ring;
mod station;
#[cfg(test)]
mod tests;

pub use channel::Channel;
pub use ring::SILENCE_FRAMES;
pub use station::{BUFFER_BYTES, BufferFull, ReceivedMessage, Station};

use crate::RobotId;
use crate::time::Time;

/// Medium access of the stations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medium {
    /// Each station sends on its own frequency, without interference.
    #[default]
    Free,
    /// All stations share one frequency and send at any time: messages that overlap at a receiver are all lost there
    /// (unslotted ALOHA).
    Aloha,
    /// All stations share one frequency and only the holder of the token sends: the virtual token ring of the EyeBot.
    TokenRing,
}

/// Radio model of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadioModel {
    /// Medium access.
    pub medium: Medium,
    /// Bits per second, [`BITS_PER_BYTE`] for each byte; positive. A RoBIOS 6 program may set another speed for its
    /// station.
    pub baud: u32,
    /// Time from the end of a transmission to its arrival; not negative.
    pub latency: Time,
    /// Range of a station, m; `None` for no limit.
    pub range: Option<f64>,
    /// True if walls block messages.
    pub line_of_sight: bool,
}

impl Default for RadioModel {
    /// Free medium with 115200 baud, no latency and unlimited range: our choice.
    fn default() -> Self {
        Self { medium: Medium::Free, baud: 115_200, latency: Time::ZERO, range: None, line_of_sight: false }
    }
}

/// Bytes of a frame in addition to its payload: start, type, destination, source, next sender, length, checksum.
///
/// Source: the network of the EyeBot.
pub const HEADER_BYTES: usize = 7;

/// Bits transmitted for a byte: a start bit, eight data bits, a stop bit.
pub const BITS_PER_BYTE: u64 = 10;

/// Duration of the transmission of a message with a payload of `bytes` bytes, rounded up to whole microseconds.
pub fn air_time(bytes: usize, baud: u32) -> Time {
    let bits = (bytes as u128 + HEADER_BYTES as u128) * u128::from(BITS_PER_BYTE);
    let micros = (bits * 1_000_000).div_ceil(baud.max(1).into());
    i64::try_from(micros).map_or(Time::NEVER, Time)
}

/// Destination of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Address {
    /// Every station.
    All,
    /// The stations with this address.
    One(u32),
}

/// A message that a program has queued at its station for transmission.
#[derive(Clone, Debug, PartialEq)]
pub struct OutgoingMessage {
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Sequence number of the message; each sender numbers its messages from 1.
    pub sequence: u64,
    /// Destination.
    pub to: Address,
    /// Payload.
    pub payload: Vec<u8>,
    /// Time when the program queued the message: the end of the call.
    pub queued_at: Time,
    /// Start of the transmission, after the earlier messages of the station; `None` in a token ring, which decides it
    /// later.
    pub begins: Option<Time>,
    /// Speed of the sender's station, baud.
    pub baud: u32,
    /// Robots that cannot receive the message, with the reason, in the order of their ids; computed from the motions
    /// that are published when the message is queued.
    pub out_of_reach: Vec<(RobotId, Loss)>,
}

/// Reason why a message was not received.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loss {
    /// The channel lost the message (with probability P_p), or the radio of the sender or receiver was silenced.
    Packet,
    /// The receiver was too far away.
    Range,
    /// A wall blocked the line of sight.
    Sight,
    /// Another message was on the air at the same time, or the receiver was transmitting.
    Collision,
    /// The receiver uses another baud rate.
    Baud,
    /// No other station with the destination's address was on.
    Nobody,
    /// The receiver was switched off before the message arrived.
    Off,
    /// The receiver's buffer was full.
    Overflow,
    /// The sender was switched off before the transmission began.
    Unsent,
    /// The run ended before the message arrived.
    End,
}

/// Outcome of a message at one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Delivery {
    /// The receiver. The sender itself for [`Loss::Nobody`] and [`Loss::Unsent`], and for [`Loss::End`] if the channel
    /// had not decided the message.
    pub to: RobotId,
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Sequence number of the message.
    pub sequence: u64,
    /// Time of arrival: end of the transmission plus latency.
    pub arrives: Time,
    /// Time from which the receiver's program can read the message.
    pub visible: Time,
    /// The received payload, or the reason for the loss.
    pub outcome: Result<Arrived, Loss>,
}

/// Payload of a message that arrives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrived {
    /// The bytes, possibly with bit errors.
    pub payload: Vec<u8>,
    /// Number of inverted bits.
    pub bit_errors: u32,
}

/// Address and speed of a station that is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StationInfo {
    /// The robot.
    pub robot: RobotId,
    /// Address of the station.
    pub address: u32,
    /// Speed of the station, baud.
    pub baud: u32,
}

/// Report of a station to the channel after it was switched on or off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StationChange {
    /// The robot.
    pub robot: RobotId,
    /// Present state; `None` if the station is off.
    pub member: Option<StationInfo>,
    /// Times at which the station was switched off since the last report, in order.
    pub switched_off: Vec<SwitchedOff>,
}

/// A station was switched off. Messages whose transmission begins later are never transmitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchedOff {
    /// The robot.
    pub robot: RobotId,
    /// Time of switching off.
    pub at: Time,
    /// Sequence number of the last message that the station had accepted by `at`.
    pub last_sequence: u64,
}

impl Loss {
    /// Name of the reason in a trace.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Packet => "packet",
            Self::Range => "range",
            Self::Sight => "sight",
            Self::Collision => "collision",
            Self::Baud => "baud",
            Self::Nobody => "nobody",
            Self::Off => "off",
            Self::Overflow => "overflow",
            Self::Unsent => "unsent",
            Self::End => "end",
        }
    }
}
