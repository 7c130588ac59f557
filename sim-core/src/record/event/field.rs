//! Types of event fields.

use crate::record::Action;
use serde::{Deserialize, Serialize, Serializer};

/// State of a robot's program at the end of a run. Digests depend on the order of the variants: add new ones at the
/// end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The program ended normally with exit code 0.
    Finished,
    /// The run reached its time limit while the program was running.
    Running,
    /// The program waits for an event that cannot happen any more.
    Waiting,
    /// The user ended the run.
    Interrupted,
    /// The program panicked, crashed, could not be loaded or ended with a nonzero exit code.
    Failed,
    /// The program computed for too long without a RoBIOS call.
    Timeout,
    /// The robot has no program.
    NoProgram,
    /// The robot was removed from the world before its program ended.
    Removed,
    /// A fault of the scene stopped the robot before its program ended.
    Halted,
}

impl Outcome {
    /// Name in the report and the trace, such as `finished`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Running => "running",
            Self::Waiting => "waiting",
            Self::Interrupted => "interrupted",
            Self::Failed => "failed",
            Self::Timeout => "timeout",
            Self::NoProgram => "no_program",
            Self::Halted => "halted",
            Self::Removed => "removed",
        }
    }

    /// Returns true if the outcome is a failure of the program; the run's exit code is then 1.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Waiting | Self::Failed | Self::Timeout)
    }
}

/// Obstacle that a robot touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Obstacle {
    /// A wall or another immovable object.
    Wall,
    /// The robot with this number.
    Robot(u32),
    /// The movable object with this number.
    Object(u32),
    /// Terrain.
    Terrain,
}

/// An [`Action`] as JSON text: a string in the canonical form, a JSON object in the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct ActionText<'a>(pub &'a str);

impl ActionText<'_> {
    /// Parses the action; `None` if the text is not an action.
    pub fn action(self) -> Option<Action> {
        Action::from_json(&serde_json::from_str(self.0).ok()?).ok()
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

/// A list of numbers: little-endian `f64` bytes in the canonical form, JSON numbers in the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub struct FloatList<'a>(&'a [u8]);

impl<'a> FloatList<'a> {
    /// List of the numbers with these little-endian bytes.
    pub fn new(bytes: &'a [[u8; 8]]) -> Self {
        Self(bytes.as_flattened())
    }

    /// The numbers.
    pub fn iter(self) -> impl Iterator<Item = f64> + use<'a> {
        self.0.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes))
    }
}

impl Serialize for FloatList<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.collect_seq(self.iter())
        } else {
            serializer.serialize_newtype_struct("FloatList", self.0)
        }
    }
}
