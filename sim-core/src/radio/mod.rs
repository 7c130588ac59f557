//! Messages between robots: the channel that carries them, and the station of each robot.
//!
//! Within a slot a robot sends and receives only through its own [`Station`]. At the slot's end the [`Channel`] takes
//! the sent messages. It decides for each message and station whether and when the message is received, and with which
//! bit errors; the result is a [`Delivery`].
//!
//! Source: Koestler & Bräunl, sections 5.1 and 6.2; for the rules of time, design section 7.

mod air;
mod channel;
mod ring;
mod station;
#[cfg(test)]
mod tests;

pub use channel::Channel;
pub use ring::SILENCE;
pub use station::{BUFFER, Full, Message, Station};

use crate::RobotId;
use crate::time::Time;

/// Medium access of the stations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medium {
    /// Each station has a frequency of its own: no interference.
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
    /// Bits a second, ten per byte; positive. A RoBIOS 6 program may set another speed for its own station.
    pub baud: u32,
    /// Time from the end of a transmission to its arrival; not negative.
    pub latency: Time,
    /// Range of a station, m; `None` for no limit.
    pub range: Option<f64>,
    /// True if walls block messages.
    pub line_of_sight: bool,
}

impl Default for RadioModel {
    /// A free medium of 115200 baud without limits: our choice.
    fn default() -> Self {
        Self { medium: Medium::Free, baud: 115_200, latency: Time::ZERO, range: None, line_of_sight: false }
    }
}

/// Bytes of a frame in addition to its payload: start, type, destination, source, next sender, length, checksum.
///
/// Source: the network of the EyeBot.
pub const HEADER: usize = 7;

/// Bits on the air for a byte: start, eight of data, stop.
pub const BITS_PER_BYTE: u64 = 10;

/// Duration of the transmission of a message of `bytes` bytes, in whole microseconds, rounded up; at least one.
pub fn air_time(bytes: usize, baud: u32) -> Time {
    let bits = (bytes as u128 + HEADER as u128) * u128::from(BITS_PER_BYTE);
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

/// A message that a station has sent.
#[derive(Clone, Debug, PartialEq)]
pub struct SentMessage {
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Number of the message, counted per sender from 1.
    pub sequence: u64,
    /// Destination.
    pub to: Address,
    /// Payload.
    pub payload: Vec<u8>,
    /// Time of sending: the end of the call.
    pub sent: Time,
    /// Start of the transmission, after the earlier messages of the station; `None` if the medium decides it (token).
    pub begins: Option<Time>,
    /// Speed of the sender, baud.
    pub baud: u32,
    /// Robots that cannot receive the message, with the reason, in the order of their ids; judged by the motions that
    /// are published when the message is sent.
    pub out_of_reach: Vec<(RobotId, Loss)>,
}

/// Reason why a message was not received.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loss {
    /// Lost by the channel (P_p).
    Packet,
    /// The receiver was too far away.
    Range,
    /// A wall blocked it.
    Sight,
    /// Another message was on the air at the same time, or the receiver was sending.
    Collision,
    /// The receiver uses another speed.
    Baud,
    /// No other station with this address was on.
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
    /// The receiver; the sender itself for [`Loss::Nobody`] and [`Loss::Unsent`].
    pub to: RobotId,
    /// The sender.
    pub from: RobotId,
    /// Address of the sender's station.
    pub address: u32,
    /// Number of the message, counted per sender.
    pub sequence: u64,
    /// Time of arrival: sending plus delay.
    pub arrives: Time,
    /// Time from which the receiver can see the message.
    pub visible: Time,
    /// The received bytes, or the reason of the loss.
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

/// A station that is on, as the channel knows it.
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
    /// Present state; `None` if it is off.
    pub member: Option<StationInfo>,
    /// Times when it was switched off since the last report, in order.
    pub switched_off: Vec<SwitchedOff>,
}

/// A station was switched off: messages whose transmission had not begun by then are never sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SwitchedOff {
    /// The robot.
    pub robot: RobotId,
    /// Time of switching off.
    pub at: Time,
    /// Number of the last message that the station had accepted by then.
    pub last_sequence: u64,
}

impl Loss {
    /// Name of the loss in a trace.
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
