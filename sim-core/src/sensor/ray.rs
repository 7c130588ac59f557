use glam::DVec2;

use crate::{
    RobotId,
    pose::Pose,
    time::Time,
    world::{Ray, RayHit, World},
};

/// Where a sensor sits on the body and looks: a pose in the robot's frame (origin at the centre, x forward, y left).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mount {
    /// The sensor's frame, x along its line of sight, in the robot's.
    pub robot_from_sensor: Pose,
}

impl Mount {
    /// A sensor at (`x`, `y`) metres that looks along `angle` radians, counter-clockwise from ahead.
    pub fn new(x: f64, y: f64, angle: f64) -> Self {
        Self { robot_from_sensor: Pose::new(x, y, angle) }
    }

    /// Origin in the world, and unit vector of the line of sight, of the sensor on a robot at `world_from_robot`.
    pub fn ray(&self, world_from_robot: &Pose) -> (DVec2, DVec2) {
        let forward = world_from_robot.heading.direction();
        let mount = &self.robot_from_sensor;
        (world_from_robot.position + forward.rotate(mount.position), forward.rotate(mount.heading.direction()))
    }
}

/// A sensor that sees along one ray: a PSD, or an infrared proximity switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Where it sits.
    pub mount: Mount,
    /// How far it sees, m.
    pub range: f64,
}

impl Beam {
    /// What the sensor of robot `by`, whose centre is at `world_from_robot` at the instant `at`, sees first.
    ///
    /// Walls and the bodies of other robots; not its own. `None` when nothing lies within `range`; 0 when the sensor's
    /// origin lies inside another body. Noise is added by the caller.
    ///
    /// Source: Koestler & Bräunl, section 4.1; nothing within range gives `None`: our choice.
    pub fn sight(&self, world: &World, by: RobotId, world_from_robot: &Pose, at: Time) -> Option<RayHit> {
        let (origin, direction) = self.mount.ray(world_from_robot);
        world.cast(by, &Ray::flat(origin, direction, self.range), at)
    }

    /// Distance along the beam to what the sensor sees first, m.
    pub fn distance(&self, world: &World, by: RobotId, world_from_robot: &Pose, at: Time) -> Option<f64> {
        self.sight(world, by, world_from_robot, at).map(|hit| hit.distance)
    }

    /// Whether anything is within range: what an infrared switch tells.
    pub fn is_interrupted(&self, world: &World, by: RobotId, world_from_robot: &Pose, at: Time) -> bool {
        self.sight(world, by, world_from_robot, at).is_some()
    }
}
