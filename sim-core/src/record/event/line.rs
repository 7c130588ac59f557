//! Record: an event with its time and its robot, a line of the trace.

use crate::RobotId;
use crate::time::Time;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Event;

/// Pseudo robot for events of the world: its journal comes before those of all robots.
pub const WORLD: RobotId = RobotId(0);

/// An event with its virtual time and its robot. Serialises to a line of the trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    /// Virtual time of the robot.
    pub time: Time,
    /// Robot of the event; [`WORLD`] for an event of the world.
    pub robot: RobotId,
    /// Sequence number of the event; each robot counts its events from 0. `None` for a note.
    pub sequence: Option<u64>,
    /// The event.
    pub event: Event<'a>,
}

impl Serialize for Record<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t_s", &self.time.seconds())?;
        if self.robot != WORLD {
            map.serialize_entry("robot", &self.robot.0)?;
        }
        if let Some(sequence) = self.sequence {
            map.serialize_entry("seq", &sequence)?;
        }
        map.serialize_entry("event", self.event.kind().name())?;
        self.event.serialize_fields(&mut map)?;
        map.end()
    }
}
