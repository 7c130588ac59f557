//! Records in a compact form, which can be passed to a sink later. Storing them takes a fraction of the time of writing
//! JSON lines.

use std::io;

use serde::{Deserialize, Serialize};
use sim_core::RobotId;
use sim_core::record::{Digest, Event, Record};
use sim_core::time::Time;

use super::sink::{RecordError, Sink};

/// Call of a method of [`Sink`], which postcard encodes; the events are in their canonical form.
#[derive(Serialize, Deserialize)]
pub enum Stored<'a> {
    /// [`Sink::record`].
    Event {
        time: i64,
        robot: u32,
        sequence: Option<u64>,
        #[serde(borrow)]
        event: Event<'a>,
    },
    /// [`Sink::end_slot`].
    Slot { end: i64, digest: Option<[u8; 32]> },
    /// [`Sink::finish`].
    End { end: i64, digest: [u8; 32] },
}

impl<'a> Stored<'a> {
    pub fn record(&Record { time, robot, sequence, event }: &Record<'a>) -> Self {
        Self::Event { time: time.0, robot: robot.0, sequence, event }
    }

    pub fn slot(end: Time, digest: Option<Digest>) -> Self {
        Self::Slot { end: end.0, digest: digest.map(|Digest(digest)| digest) }
    }

    pub fn end(end: Time, Digest(digest): Digest) -> Self {
        Self::End { end: end.0, digest }
    }

    /// Appends the encoded call to `bytes`.
    pub fn append_to(&self, bytes: &mut Vec<u8>) -> io::Result<()> {
        *bytes = postcard::to_extend(self, std::mem::take(bytes)).map_err(io::Error::other)?;
        Ok(())
    }

    /// Takes the first call off the encoded calls `bytes`; `None` if there is none left.
    pub fn take(bytes: &mut &'a [u8]) -> io::Result<Option<Self>> {
        if bytes.is_empty() {
            return Ok(None);
        }
        let (call, rest) = postcard::take_from_bytes(bytes).map_err(io::Error::other)?;
        *bytes = rest;
        Ok(Some(call))
    }

    /// Makes the call.
    pub fn pass_to(self, sink: &mut impl Sink) -> Result<(), RecordError> {
        match self {
            Self::Event { time, robot, sequence, event } => {
                sink.record(&Record { time: Time(time), robot: RobotId(robot), sequence, event })
            }
            Self::Slot { end, digest } => sink.end_slot(Time(end), digest.map(Digest)),
            Self::End { end, digest } => sink.finish(Time(end), Digest(digest)),
        }
    }
}
