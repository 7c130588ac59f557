//! Robots as inputs of the objects' solver, and the effect of a step on their motion.

use glam::DVec2;

use crate::{ObjectId, RobotId};

/// A robot during a step of the objects: a moving disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pusher {
    /// The robot.
    pub robot: RobotId,
    /// Centre at the start of the step, m.
    pub centre: DVec2,
    /// Mean velocity that the centre would have during the step without objects, m/s.
    pub velocity: DVec2,
    /// Turning speed, rad/s.
    pub omega: f64,
    /// Radius, m.
    pub radius: f64,
    /// Mass, kg.
    pub mass: f64,
    /// True if objects cannot move this body.
    pub is_immovable: bool,
}

/// Effect of a step on a robot's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Velocity of the centre after the step, m/s.
    pub velocity: DVec2,
    /// Turning speed, rad/s.
    pub omega: f64,
    /// The object with the strongest contact, if there is one.
    pub contact: Option<ObjectContact>,
}

/// An object in contact with a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectContact {
    /// The object.
    pub object: ObjectId,
    /// Impulse during the step, N s.
    pub impulse: f64,
    /// Direction from the robot's centre to the contact, a unit vector in the world.
    pub direction: DVec2,
}
