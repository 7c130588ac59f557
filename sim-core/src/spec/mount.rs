//! Mounting of devices: poses in three dimensions, links, joints of the camera.

use glam::DVec3;

use super::{Axis, SpannedText};
use crate::spec::Span;

/// Pan or tilt of a camera.
#[derive(Clone, Debug, PartialEq)]
pub enum JointSpec {
    /// Fixed angle in radians.
    Fixed(f64),
    /// Driven by a servo.
    Servo {
        /// Name of the servo, such as `SERVO1`.
        name: String,
        /// Angle at position 0, in radians.
        from: f64,
        /// Angle at position 255, in radians.
        to: f64,
    },
}

impl Default for JointSpec {
    fn default() -> Self {
        Self::Fixed(0.0)
    }
}

/// Name of the body in references to links.
pub const BODY: &str = "body";

/// A pose on the body or on a link: x forward, y left, z up in the frame of the body or link.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MountSpec {
    /// The link; `None` for the body.
    pub link: Option<SpannedText>,
    /// Position of the origin, in metres.
    pub position: DVec3,
    /// Rotation about x, the left side upwards, in radians; the first of the three rotations.
    pub roll: f64,
    /// Rotation of x upwards, in radians; the second of the three rotations.
    pub pitch: f64,
    /// Rotation about z, counter-clockwise, in radians; the third of the three rotations.
    pub yaw: f64,
}

impl MountSpec {
    /// Returns true for a device on the body with a horizontal line of sight.
    pub fn is_level(&self) -> bool {
        self.link.is_none() && self.roll == 0.0 && self.pitch == 0.0
    }
}

/// Joint of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkJointSpec {
    /// Axis of rotation in the link's frame; positive angles about y turn x upwards, like a positive pitch.
    pub axis: Axis,
    /// Name of the servo that sets the angle.
    pub servo: SpannedText,
}

/// A rigid part on the body or on another link.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkSpec {
    /// Name of the link; never [`BODY`].
    pub name: String,
    /// Pose on the parent link or the body at servo angle 0.
    pub mount: MountSpec,
    /// Joint; `None` for a fixed link.
    pub joint: Option<LinkJointSpec>,
    /// Location in the file.
    pub span: Span,
}
