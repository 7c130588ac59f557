//! Forms of legs and gaits.

use schemars::JsonSchema;
use serde::Serialize;

use super::Number;

/// What the legs of a robot do; for `kind = "legged"`.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LegsForm {
    /// How high a foot is lifted over the higher of the places that it steps from and to, in mm; 30 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) step_height_mm: Option<Number>,
    /// Radius of thighs and shanks in mm: what of them may touch; 20 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) radius_mm: Option<Number>,
    /// Gaits, the first is the one that it starts with; if left out, one foot after the other.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) gait: Vec<GaitForm>,
}

impl LegsForm {
    /// Says nothing that is not so without it.
    pub(crate) fn is_usual(&self) -> bool {
        self.step_height_mm.is_none() && self.radius_mm.is_none() && self.gait.is_empty()
    }
}

/// A gait.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct GaitForm {
    /// Its name.
    pub(crate) name: String,
    /// Time from one lift-off of a foot to its next in ms; 1000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 10.0, max = 3.6e6))]
    pub(crate) period_ms: Option<Number>,
    /// Share of the period that a foot is on the ground; 0.8 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.05, max = 0.98))]
    pub(crate) duty: Option<Number>,
    /// Share of the period after which each leg lifts off; if left out, one after the other at equal distances.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) offsets: Vec<Number>,
    /// What the joints follow: the path of the foot alone (plain), if left out, or joint angles of people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) curve: Option<CurveForm>,
}

/// What the joints of a gait follow.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CurveForm {
    /// The path of the foot alone.
    #[allow(dead_code, reason = "the schema says what may be written; what is left out is not printed")]
    Plain,
    /// Joint angles of people, for two legs with feet.
    Natural,
}

/// A leg: yaw and roll in the hip, thigh, knee, shank, and a foot with its ankle, a wheel or a bare tip.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LegForm {
    /// Its name; sensors sit on the links `NAME.thigh`, `NAME.shank` and with a foot `NAME.foot`.
    pub(crate) name: String,
    /// Place of the hip forward of the robot's centre in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place of the hip to the left in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Height of the hip while the robot stands, in mm.
    pub(crate) z_mm: Number,
    /// Length from hip to knee in mm.
    pub(crate) thigh_mm: Number,
    /// Length from knee to ankle or tip in mm.
    pub(crate) shank_mm: Number,
    /// Its foot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) foot: Option<FootForm>,
    /// Diameter in mm of a wheel in the place of a foot, which rolls along and is never lifted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) wheel_mm: Option<Number>,
}

/// A flat foot.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FootForm {
    /// From the ankle back to the heel in mm.
    pub(crate) heel_mm: Number,
    /// From the ankle ahead to the toe on which it rolls off, in mm.
    pub(crate) toe_mm: Number,
    /// Height of the ankle above the sole in mm.
    pub(crate) height_mm: Number,
}
