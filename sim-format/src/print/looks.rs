//! What only cameras see of a world, as forms of a scene.

use super::number::degrees;
use super::scene::unless;
use crate::scene::form::{LightForm, SkyForm};
use crate::spec::{LightSpec, SkySpec};

/// What no other form has a place for.
pub(super) const LOOKS: &str = "the light and the colours of the world";

pub(super) fn light_form(light: &LightSpec) -> Option<LightForm> {
    let usual = LightSpec::default();
    unless(*light, usual).map(|light| LightForm {
        azimuth_deg: unless(light.azimuth, usual.azimuth).map(degrees),
        elevation_deg: unless(light.elevation, usual.elevation).map(degrees),
        ambient: unless(light.ambient, usual.ambient),
        shadows: unless(light.shadows, usual.shadows),
    })
}

pub(super) fn sky_form(sky: &SkySpec) -> Option<SkyForm> {
    let usual = SkySpec::default();
    unless(*sky, usual).map(|sky| SkyForm {
        horizon: unless(sky.horizon, usual.horizon),
        zenith: unless(sky.zenith, usual.zenith),
        ground: unless(sky.ground, usual.ground),
    })
}
