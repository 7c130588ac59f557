//! Forms of what only cameras see of a world.

use schemars::JsonSchema;
use serde::Serialize;

use super::Number;

/// The light: a sun, and an even light from everywhere.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LightForm {
    /// Direction in degrees in which the sun stands, counter-clockwise from x; -120 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub(crate) azimuth_deg: Option<Number>,
    /// Its angle above the floor in degrees; 50 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1.0, max = 90.0))]
    pub(crate) elevation_deg: Option<Number>,
    /// Share of the light that comes evenly from everywhere; 0.4 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) ambient: Option<Number>,
    /// Whether things cast shadows; false if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shadows: Option<bool>,
}

/// What is seen where nothing stands: red, green and blue, 0 to 255.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SkyForm {
    /// The sky at the horizon.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) horizon: Option<[u8; 3]>,
    /// The sky straight above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) zenith: Option<[u8; 3]>,
    /// The ground beyond the floor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) ground: Option<[u8; 3]>,
}
