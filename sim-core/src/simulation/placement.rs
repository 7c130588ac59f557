//! Requests of robots to place another robot or an object.

use crate::pose::Pose;
use crate::time::Time;
use crate::{ObjectId, RobotId};

/// A robot's request to place another robot or an object at the end of the slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Time of the request.
    pub time: Time,
    /// Robot that has made the request.
    pub by: RobotId,
    /// Robot or object to place.
    pub what: Placeable,
    /// New pose.
    pub pose: Pose,
}

/// An entity that can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placeable {
    /// Another robot.
    Robot(RobotId),
    /// A movable object.
    Object(ObjectId),
}
