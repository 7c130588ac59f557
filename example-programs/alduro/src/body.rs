//! Geometry of ALDURO, as in `robis/alduro.toml`: metres and radians in the robot's frame (x forward, y left, z up from
//! the ground).

use std::f64::consts::{FRAC_PI_2, PI};

use mapping::inverse::SonarPose;
use mapping::{math, pose};
use nalgebra::Vector3;

/// Mounting pose of a sonar on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    pub position: Vector3<f64>,
    pub yaw: f64,
    pub pitch: f64,
}

/// Estimated pose of the body, in the odometry frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub ground: pose::Pose,
    /// Height of the robot's frame, m.
    pub lift: f64,
}

/// Number of sonars: the maximum that one bus supports (Gois and Hiller, section 6).
pub const SONARS: usize = 16;
/// Number of sonars that look around; the others look down at the body's corners.
const AROUND: usize = 12;
/// Height of the sonars that look around, m: the maximum height to which a foot is lifted.
const RING_HEIGHT: f64 = 0.6;
/// Height of the sonars that look down, m.
const CORNER_HEIGHT: f64 = 1.2;
/// Radius of the ring of sonars that look around, m.
const RING: f64 = 0.8;
/// Elevation of the sonars that look around, rad; level ground must stay out of their beams.
const RING_PITCH: f64 = 25.0 / 180.0 * PI;
/// Position of the sonars that look down, m ahead of and beside the body's centre.
const CORNER: (f64, f64) = (1.5, 0.9);

/// Clearance around the centre of the robot that the operator requires, m. Feet reach 1.5 m ahead and behind, 1.9 m
/// with corrections. Less than 1.9 m is enough, since on the map the outlines of high obstacles are about one cell
/// (0.5 m) too wide.
pub const OPERATOR_CLEARANCE: f64 = 1.6;

/// Mounting pose of the sonar with this number, counted from 0.
///
/// # Panics
/// If `number` is [`SONARS`] or more.
pub fn mount(number: usize) -> Mount {
    if number < AROUND {
        let yaw = number as f64 * 2.0 * PI / AROUND as f64;
        let position = Vector3::new(RING * math::cos(yaw), RING * math::sin(yaw), RING_HEIGHT);
        return Mount { position, yaw, pitch: RING_PITCH };
    }
    let (x, y) = CORNER;
    let [x, y] = [[x, y], [x, -y], [-x, y], [-x, -y]][number - AROUND];
    Mount { position: Vector3::new(x, y, CORNER_HEIGHT), yaw: 0.0, pitch: -FRAC_PI_2 }
}

impl Pose {
    /// Transforms a point from the robot's frame to the odometry frame.
    pub fn in_odometry(&self, in_robot: &Vector3<f64>) -> Vector3<f64> {
        let point = self.ground.outward(in_robot.xy().into());
        Vector3::new(point.x, point.y, self.lift + in_robot.z)
    }

    /// Pose of a sonar in the odometry frame.
    pub fn sonar(&self, mount: &Mount) -> SonarPose {
        SonarPose::new(self.in_odometry(&mount.position), self.ground.heading + mount.yaw, mount.pitch)
    }
}

#[cfg(test)]
mod tests {
    use toml::Value;

    use super::*;
    use crate::SHANK;

    #[test]
    fn constants_of_the_program_match_the_robis() {
        for name in ["alduro", "alduro-wheels"] {
            let path = format!("{}/../../robis/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let robi: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
            let number = |table: &Value, key: &str| {
                let value = table.get(key).unwrap_or(&Value::Integer(0));
                value.as_float().unwrap_or_else(|| value.as_integer().unwrap() as f64)
            };
            let sonars = robi["sonar"].as_array().unwrap();
            assert_eq!(sonars.len(), SONARS);
            for sonar in sonars {
                let mount = mount(number(sonar, "id") as usize - 1);
                let position = ["x_mm", "y_mm", "z_mm"].map(|key| number(sonar, key) / 1e3);
                assert!((mount.position - Vector3::from(position)).norm() < 1e-3, "{path}: {sonar} is at {mount:?}");
                let turn = math::sin((mount.yaw - number(sonar, "yaw_deg").to_radians()) / 2.0);
                let tilt = mount.pitch - number(sonar, "pitch_deg").to_radians();
                assert!(turn.abs() < 1e-9 && tilt.abs() < 1e-9, "{path}: {sonar} looks to {mount:?}");
            }
            for leg in robi["leg"].as_array().unwrap() {
                assert_eq!(number(leg, "shank_mm"), SHANK * 1e3, "{path}");
            }
        }
    }
}
