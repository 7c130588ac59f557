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
/// Height of those that look around, m: a little more than what a step overcomes.
const RING_HEIGHT: f64 = 0.6;
/// Height of those that look down, m.
const CORNER_HEIGHT: f64 = 1.2;
/// How far from the middle those sit that look around, m.
const RING: f64 = 0.8;
/// They look up by as much, so that they hear neither level ground nor what a step overcomes, rad.
const RING_PITCH: f64 = 25.0 / 180.0 * PI;
/// Where those sit that look down, m ahead of and beside the middle.
const CORNER: (f64, f64) = (1.5, 0.9);

/// Radius of a circle about the middle within which feet, legs and body stay, m. What is high has outlines on the map that are about a cell
/// too wide, which is margin enough.
pub const RADIUS: f64 = 1.6;

/// The sonar with this number, counted from 0.
pub fn mount(number: usize) -> Mount {
    if number < AROUND {
        let yaw = number as f64 * 2.0 * PI / AROUND as f64;
        let place = Vector3::new(RING * math::cos(yaw), RING * math::sin(yaw), RING_HEIGHT);
        return Mount { place, yaw, pitch: RING_PITCH };
    }
    let (x, y) = CORNER;
    let [x, y] = [[x, y], [x, -y], [-x, y], [-x, -y]][number % 4];
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
