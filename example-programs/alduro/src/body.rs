//! What the program knows of ALDURO, as `robis/alduro.toml` has it: metres and radians in the robot's frame (x forward, y left, z up from
//! the ground).

use std::f64::consts::{FRAC_PI_2, PI};

use mapping::inverse::SonarPose;
use mapping::{math, pose};
use nalgebra::Vector3;

/// A sonar on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    pub place: Vector3<f64>,
    pub yaw: f64,
    pub pitch: f64,
}

/// Where the body is believed to be, in the frame of the odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub ground: pose::Pose,
    /// Height of the robot's frame, m.
    pub lift: f64,
}

/// Sonars on a bus at most (Gois and Hiller, section 6).
pub const SONARS: usize = 16;
/// Those that look around; the others look down at the corners.
const AROUND: usize = 12;
/// Height of those that look around, m: as high as a foot is lifted at most.
const RING_HEIGHT: f64 = 0.6;
/// Height of those that look down, m.
const CORNER_HEIGHT: f64 = 1.2;
/// How far from the middle those sit that look around, m.
const RING: f64 = 0.8;
/// They look up by as much, so that they do not hear level ground, rad.
const RING_PITCH: f64 = 25.0 / 180.0 * PI;
/// Where those sit that look down, m ahead of and beside the middle.
const CORNER: (f64, f64) = (1.5, 0.9);

/// The room about the middle that the operator asks for, m. Feet reach out to 1.5 m ahead and behind, with corrections to 1.9 m; what is high
/// has outlines on the map that are about a cell (0.5 m) too wide.
pub const RADIUS: f64 = 1.6;

/// The sonar with this number, counted from 0.
///
/// # Panics
/// From [`SONARS`] on.
pub fn mount(number: usize) -> Mount {
    if number < AROUND {
        let yaw = number as f64 * 2.0 * PI / AROUND as f64;
        let place = Vector3::new(RING * math::cos(yaw), RING * math::sin(yaw), RING_HEIGHT);
        return Mount { place, yaw, pitch: RING_PITCH };
    }
    let (x, y) = CORNER;
    let [x, y] = [[x, y], [x, -y], [-x, y], [-x, -y]][number - AROUND];
    Mount { place: Vector3::new(x, y, CORNER_HEIGHT), yaw: 0.0, pitch: -FRAC_PI_2 }
}

impl Pose {
    /// A place of the robot's frame.
    pub fn place(&self, in_robot: &Vector3<f64>) -> Vector3<f64> {
        let place = self.ground.outward(in_robot.xy().into());
        Vector3::new(place.x, place.y, self.lift + in_robot.z)
    }

    /// Where a sonar is.
    pub fn sonar(&self, mount: &Mount) -> SonarPose {
        SonarPose::new(self.place(&mount.place), self.ground.heading + mount.yaw, mount.pitch)
    }
}

#[cfg(test)]
mod tests {
    use toml::Value;

    use super::*;
    use crate::SHANK;

    #[test]
    fn the_robis_have_what_the_program_knows() {
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
                let place = ["x_mm", "y_mm", "z_mm"].map(|key| number(sonar, key) / 1e3);
                assert!((mount.place - Vector3::from(place)).norm() < 1e-3, "{path}: {sonar} is at {mount:?}");
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
