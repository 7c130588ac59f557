//! Messages between robots: the channel that carries them, and the station of each robot.
//!
//! Within a slot a robot sends and receives by its own [`Station`] alone. At the slot's end the [`Channel`] takes what was sent,
//! decides which station hears it, when and how, and hands each its [`Delivery`]s.
//!
//! Source: Koestler & Bräunl, sections 5.1 and 6.2; the rules of time are those of design section 7.

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

/// How stations share the medium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Medium {
    /// Everybody has a frequency of its own: nobody disturbs anybody.
    #[default]
    Free,
    /// One frequency, and everybody sends when it likes: of messages that overlap at a receiver none is heard (unslotted ALOHA).
    Aloha,
    /// One frequency, and who has the token sends: the virtual token ring of the EyeBot.
    TokenRing,
}

/// What carries the messages of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// How stations share it.
    pub medium: Medium,
    /// Bits a second, of which a byte takes ten; positive. A program of RoBIOS 6 may set another one for its own station.
    pub baud: u32,
    /// From the end of a transmission to its arrival; not negative.
    pub latency: Time,
    /// How far a message is heard, m; `None`: everywhere.
    pub range: Option<f64>,
    /// True where walls stop messages.
    pub line_of_sight: bool,
}

impl Default for Model {
    /// A free medium of 115200 baud without limits: our choice.
    fn default() -> Self {
        Self { medium: Medium::Free, baud: 115_200, latency: Time::ZERO, range: None, line_of_sight: false }
    }
}

/// Bytes of a frame besides its payload: start, type, destination, source, next sender, length, checksum.
///
/// Source: the network of the EyeBot.
pub const HEADER: usize = 7;

/// Bits on the air for a byte: start, eight of data, stop.
pub const BITS_PER_BYTE: u64 = 10;

/// How long a message of `bytes` bytes is on the air, in whole microseconds, rounded up; at least one.
pub fn air_time(bytes: usize, baud: u32) -> Time {
    let bits = (bytes as u128 + HEADER as u128) * u128::from(BITS_PER_BYTE);
    let micros = (bits * 1_000_000).div_ceil(baud.max(1).into());
    i64::try_from(micros).map_or(Time::NEVER, Time)
}

/// To whom a message goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Address {
    /// Every station.
    All,
    /// The stations of this address.
    One(u32),
}

/// A message that a station has sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Sending {
    /// Who sent it.
    pub from: RobotId,
    /// The address of its station.
    pub address: u32,
    /// Its number among those of the sender, from 1.
    pub sequence: u64,
    /// To whom.
    pub to: Address,
    /// The bytes.
    pub payload: Vec<u8>,
    /// When it was sent: the end of the call.
    pub sent: Time,
    /// When its transmission begins, behind those that the station sent before; `None` where the medium decides (a token).
    pub begins: Option<Time>,
    /// Speed of the sender.
    pub baud: u32,
    /// Who cannot hear it, and why, in the order of their ids; as the sender sees the others when it sends.
    pub out_of_reach: Vec<(RobotId, Loss)>,
}

/// Why a message was not heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Loss {
    /// The channel lost it (P_p).
    Packet,
    /// The receiver was too far away.
    Range,
    /// A wall stood between.
    Sight,
    /// Another message was on the air at the same time, or the receiver itself sent.
    Collision,
    /// The receiver listens at another speed.
    Baud,
    /// Nobody of this address was on.
    Nobody,
    /// The receiver was switched off before it came.
    Off,
    /// The receiver's buffer was full.
    Overflow,
    /// The sender was switched off before it was sent.
    Unsent,
    /// The run ended before it came.
    End,
}

/// What becomes of a message at one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Delivery {
    /// The receiver; the sender itself for [`Loss::Nobody`] and [`Loss::Unsent`].
    pub to: RobotId,
    /// The sender.
    pub from: RobotId,
    /// The address of the sender's station.
    pub address: u32,
    /// Its number among those of the sender.
    pub sequence: u64,
    /// When it arrives: a = send + delay.
    pub arrives: Time,
    /// From when on the receiver may know of it.
    pub visible: Time,
    /// The bytes as they arrive, or why they do not.
    pub outcome: Result<Arrived, Loss>,
}

/// The bytes of a message that arrives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Arrived {
    /// The bytes, some of them perhaps not as they were sent.
    pub payload: Vec<u8>,
    /// How many bits are inverted.
    pub bit_errors: u32,
}

/// What stations that are on tell the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// Whose station.
    pub robot: RobotId,
    /// Its address.
    pub address: u32,
    /// Its speed.
    pub baud: u32,
}

/// What a station tells the channel after it was switched on or off.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Whose station.
    pub robot: RobotId,
    /// How it stands now; `None` when it is off.
    pub member: Option<Member>,
    /// When it was switched off since it told last, in the order of time.
    pub offs: Vec<Off>,
}

/// A station was switched off: what it had not begun to send by then is never sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Off {
    /// Whose station.
    pub robot: RobotId,
    /// When.
    pub at: Time,
    /// The number of the last message that it had been given by then.
    pub last_sequence: u64,
}

impl Loss {
    /// Its word in a trace.
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
