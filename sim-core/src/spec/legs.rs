//! Legs and gaits of a robot type.

use glam::DVec3;

use super::PathRef;
use crate::drive::legged::Foot;
use crate::spec::Span;

/// Duty factor of a gait that does not say: one foot of four in the air at a time, with some time to spare. Source: our
/// choice.
pub const DEFAULT_DUTY: f64 = 0.8;
/// Period of a gait that does not say, in seconds. Source: our choice.
pub const DEFAULT_PERIOD: f64 = 1.0;
/// Height of a step of legs that do not say, in metres. Source: our choice.
pub const DEFAULT_STEP_HEIGHT: f64 = 0.03;
/// Radius of thighs and shanks of legs that do not say, in metres. Source: our choice.
pub const DEFAULT_LIMB_RADIUS: f64 = 0.02;

/// The legs of a robot type and what they can do.
#[derive(Clone, Debug, PartialEq)]
pub struct LegsSpec {
    /// How high a foot is lifted, in metres.
    pub step_height: f64,
    /// Radius of thighs and shanks, in metres.
    pub radius: f64,
    /// Its gaits; none: the default one.
    pub gaits: Vec<GaitSpec>,
    /// Its legs.
    pub legs: Vec<LegSpec>,
}

impl Default for LegsSpec {
    fn default() -> Self {
        Self { step_height: DEFAULT_STEP_HEIGHT, radius: DEFAULT_LIMB_RADIUS, gaits: Vec::new(), legs: Vec::new() }
    }
}

/// A gait.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaitSpec {
    /// Its name.
    pub name: String,
    /// Time from one lift-off of a foot to its next, in seconds.
    pub period: f64,
    /// Share of it that a foot is on the ground.
    pub duty: f64,
    /// Share of it after which each leg lifts off; empty: one after the other.
    pub offsets: Vec<f64>,
    /// Legs with feet move as people's do.
    pub is_natural: bool,
    /// Where it is written.
    pub span: Span,
}

/// A leg.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LegSpec {
    /// Its name.
    pub name: PathRef,
    /// Place of its hip while the robot stands, in metres.
    pub hip: DVec3,
    /// Length from hip to knee, in metres.
    pub thigh: f64,
    /// Length from knee to ankle or tip, in metres.
    pub shank: f64,
    /// Its foot.
    pub foot: Option<Foot>,
    /// Diameter of the wheel in the place of a foot, in metres.
    pub wheel: Option<f64>,
    /// Where it is written.
    pub span: Span,
}
