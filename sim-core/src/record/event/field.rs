//! What the fields of events hold.

use crate::record::Action;
use serde::{Deserialize, Serialize, Serializer};

/// How a robot's program stands at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The program ended by itself with exit code 0.
    Finished,
    /// The run's time was over while the program ran.
    Running,
    /// The program waits for something that cannot come any more.
    Waiting,
    /// The user ended the run.
    Interrupted,
    /// The program panicked, faulted, could not be loaded or ended with another exit code than 0.
    Failed,
    /// The program computed for too long without a RoBIOS call.
    Timeout,
    /// The robot has no program: it only stands there.
    NoProgram,
    /// The robot was taken out of the world before its program ended.
    Removed,
}

impl Outcome {
    /// The word of the report and the trace, such as `finished`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Running => "running",
            Self::Waiting => "waiting",
            Self::Interrupted => "interrupted",
            Self::Failed => "failed",
            Self::Timeout => "timeout",
            Self::NoProgram => "no_program",
            Self::Removed => "removed",
        }
    }

    /// True where the program is to blame, so that the run's exit code is 1.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Waiting | Self::Failed | Self::Timeout)
    }
}

/// What a robot touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Obstacle {
    /// A wall or another thing that never moves.
    Wall,
    /// The robot with this number.
    Robot(u32),
    /// The movable object with this number.
    Object(u32),
    /// Terrain.
    Terrain,
}

/// An [`Action`] as JSON text: the text itself in the canonical form, the object in the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct ActionText<'a>(pub &'a str);

impl ActionText<'_> {
    /// The action; none if the text is not one.
    pub fn action(self) -> Option<Action> {
        serde_json::from_str(self.0).ok()
    }
}

impl Serialize for ActionText<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.action().filter(|_| serializer.is_human_readable()) {
            Some(action) => action.serialize(serializer),
            None => serializer.serialize_newtype_struct("ActionText", self.0),
        }
    }
}

/// A list of numbers: the bytes of its doubles, little endian, in the canonical form, the numbers in the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct Numbers<'a>(&'a [u8]);

impl<'a> Numbers<'a> {
    /// The list with these bytes.
    pub fn new(bytes: &'a [[u8; 8]]) -> Self {
        Self(bytes.as_flattened())
    }

    /// The numbers.
    pub fn iter(self) -> impl Iterator<Item = f64> + use<'a> {
        self.0.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes))
    }
}

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.collect_seq(self.iter())
        } else {
            serializer.serialize_newtype_struct("Numbers", self.0)
        }
    }
}
