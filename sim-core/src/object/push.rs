//! Robots among the objects: what pushes them, and what that makes of a robot's motion.

use glam::DVec2;

use crate::{ObjectId, RobotId};

/// A robot among the objects during a step: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pusher {
    /// Whose body.
    pub robot: RobotId,
    /// Centre at the step's start, m.
    pub centre: DVec2,
    /// Mean velocity of the centre that it is on its way with, m/s.
    pub velocity: DVec2,
    /// Turning speed, rad/s.
    pub omega: f64,
    /// Radius, m.
    pub radius: f64,
    /// Mass, kg.
    pub mass: f64,
    /// True for a body that nothing pushes.
    pub is_immovable: bool,
}

/// What a step has made of a robot's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Velocity of the centre that the objects leave it, m/s.
    pub velocity: DVec2,
    /// Turning speed, rad/s.
    pub omega: f64,
    /// The object that it presses hardest, if it presses one.
    pub touch: Option<Touch>,
}

/// An object in contact with a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Which object.
    pub object: ObjectId,
    /// Impulse of the step, N s.
    pub impulse: f64,
    /// Direction from the robot's centre to the contact, a unit vector in the world.
    pub direction: DVec2,
}
