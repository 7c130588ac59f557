//! An event with its time and its robot: a line of the trace.

use crate::RobotId;
use crate::time::Time;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Event;

/// Stands in place of a robot for what belongs to the world: its journal comes before those of all robots.
pub const WORLD: RobotId = RobotId(0);

/// An event with its virtual time and its robot. Serialises to a line of the trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<'a> {
    /// Virtual time of the robot.
    pub time: Time,
    /// Whose event; [`WORLD`] for that of no robot.
    pub robot: RobotId,
    /// Number of the event among its robot's, from 0; none for a note.
    pub sequence: Option<u64>,
    /// What happened.
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
