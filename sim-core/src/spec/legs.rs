//! Legs and gaits of a robot type.

use glam::DVec3;

use super::SpannedText;
use crate::drive::legged::Foot;
use crate::spec::Span;

/// Default duty factor of a gait: at most one of four feet is in the air at a time, with a margin. Source: our choice.
pub const DEFAULT_DUTY: f64 = 0.8;
/// Default period of a gait, in seconds. Source: our choice.
pub const DEFAULT_PERIOD: f64 = 1.0;
/// Default height of a step, in metres. Source: our choice.
pub const DEFAULT_STEP_HEIGHT: f64 = 0.03;
/// Default radius of thighs and shanks, in metres. Source: our choice.
pub const DEFAULT_LIMB_RADIUS: f64 = 0.02;

/// The legs of a robot type and their gaits.
#[derive(Clone, Debug, PartialEq)]
pub struct LegsSpec {
    /// Height to which a foot is lifted, in metres.
    pub step_height: f64,
    /// Radius of thighs and shanks, in metres.
    pub radius: f64,
    /// Gaits; if empty, the default gait.
    pub gaits: Vec<GaitSpec>,
    /// Legs.
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
    /// Name of the gait.
    pub name: String,
    /// Time from one lift-off of a foot to its next lift-off, in seconds.
    pub period: f64,
    /// Duty factor: fraction of the period during which a foot is on the ground.
    pub duty: f64,
    /// Phase at which each leg lifts off, as a fraction of the period; if empty, the legs lift off evenly, one after
    /// the other.
    pub offsets: Vec<f64>,
    /// True for the natural, human-like foot curve of `docs/legged.md`, which requires two legs with feet; false for
    /// the plain foot curve.
    pub has_natural_curve: bool,
    /// Location in the file.
    pub span: Span,
}

/// A leg.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LegSpec {
    /// Name of the leg.
    pub name: SpannedText,
    /// Position of the hip while the robot stands, in metres.
    pub hip: DVec3,
    /// Length from hip to knee, in metres.
    pub thigh: f64,
    /// Length from knee to ankle or tip, in metres.
    pub shank: f64,
    /// Foot.
    pub foot: Option<Foot>,
    /// Diameter of the wheel that replaces the foot, in metres.
    pub wheel: Option<f64>,
    /// Location in the file.
    pub span: Span,
}
