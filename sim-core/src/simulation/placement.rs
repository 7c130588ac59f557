//! Requests of robots to put something elsewhere.

use crate::pose::Pose;
use crate::time::Time;
use crate::{ObjectId, RobotId};

/// What a robot wants to be put elsewhere at the slot's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// When it was asked for.
    pub time: Time,
    /// Who asked.
    pub by: RobotId,
    /// What.
    pub what: Placeable,
    /// Where to.
    pub pose: Pose,
}

/// What can be put elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placeable {
    /// Another robot.
    Robot(RobotId),
    /// A movable object.
    Object(ObjectId),
}
