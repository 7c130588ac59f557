use glam::DVec2;

use crate::{
    RobotId,
    pose::Pose,
    time::Time,
    world::{Ray, RayHit, World},
};

/// Mounting pose of a sensor on the body, in the robot's frame (origin at the centre, x forward, y left).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mount {
    /// Sensor frame, x along the line of sight, in the robot's frame.
    pub robot_from_sensor: Pose,
}

impl Mount {
    /// A sensor at (`x`, `y`) metres with its line of sight at `angle` radians, counter-clockwise from ahead.
    pub fn new(x: f64, y: f64, angle: f64) -> Self {
        Self { robot_from_sensor: Pose::new(x, y, angle) }
    }

    /// Origin and unit direction, in the world frame, of the line of sight of a sensor on a robot at
    /// `world_from_robot`.
    pub fn ray(&self, world_from_robot: &Pose) -> (DVec2, DVec2) {
        let forward = world_from_robot.heading.direction();
        let mount = &self.robot_from_sensor;
        (world_from_robot.position + forward.rotate(mount.position), forward.rotate(mount.heading.direction()))
    }
}

/// A sensor with one ray: a PSD, or an infrared proximity sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Mounting pose.
    pub mount: Mount,
    /// Range, m.
    pub range: f64,
}

impl Beam {
    /// First hit of the sensor of the robot `observer`, whose centre is at `world_from_robot` at the instant `at`.
    ///
    /// The sensor detects walls, fixed bodies, objects and other robots, but not its own robot and not meshes. The
    /// result is `None` if nothing lies within `range`, and has distance 0 if the sensor's origin lies inside another
    /// body. The caller adds noise.
    ///
    /// Source: Koestler & Bräunl, section 4.1; `None` if nothing is within range: our choice.
    pub fn cast(&self, world: &World, observer: RobotId, world_from_robot: &Pose, at: Time) -> Option<RayHit> {
        let (origin, direction) = self.mount.ray(world_from_robot);
        world.cast(observer, &Ray::flat(origin, direction, self.range), at)
    }

    /// Distance along the beam to the first hit, m.
    pub fn distance(&self, world: &World, observer: RobotId, world_from_robot: &Pose, at: Time) -> Option<f64> {
        self.cast(world, observer, world_from_robot, at).map(|hit| hit.distance)
    }

    /// Returns true if anything lies within range: the reading of an infrared proximity sensor.
    pub fn is_interrupted(&self, world: &World, observer: RobotId, world_from_robot: &Pose, at: Time) -> bool {
        self.cast(world, observer, world_from_robot, at).is_some()
    }
}
