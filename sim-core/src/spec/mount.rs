//! Where devices sit: poses in space, links, joints of the camera.

use glam::DVec3;

use super::{Axis, PathRef};
use crate::spec::Span;

/// Pan or tilt of a camera.
#[derive(Clone, Debug, PartialEq)]
pub enum JointSpec {
    /// Fixed angle in radians.
    Fixed(f64),
    /// Driven by a servo.
    Servo {
        /// Name of the servo, `SERVO1`.
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

/// Name of the body among the links.
pub const BODY: &str = "body";

/// A pose on the body or on a link: x forward, y left, z up there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MountSpec {
    /// The link; `None`: the body.
    pub on: Option<PathRef>,
    /// Place of the origin, in metres.
    pub position: DVec3,
    /// Turn about x, the left side upwards, in radians; the first of the three turns.
    pub roll: f64,
    /// Turn of x upwards, in radians; the second.
    pub pitch: f64,
    /// Turn about z, counter-clockwise, in radians; the third.
    pub yaw: f64,
}

impl MountSpec {
    /// True for what sits on the body and looks along the floor.
    pub fn is_level(&self) -> bool {
        self.on.is_none() && self.roll == 0.0 && self.pitch == 0.0
    }
}

/// What turns a link.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnSpec {
    /// About which axis of the link: about y, positive angles turn x upwards, as a pitch does.
    pub axis: Axis,
    /// Name of the servo whose angle it has.
    pub servo: PathRef,
}

/// A rigid part on the body or on another link.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkSpec {
    /// Its name; never [`BODY`].
    pub name: String,
    /// Where it is while its servo stands at angle 0.
    pub mount: MountSpec,
    /// What turns it; `None` for a fixed one.
    pub turn: Option<TurnSpec>,
    /// Where it is written.
    pub span: Span,
}
