//! What only cameras see of a world: its light, its sky, the colour of its floor.

use crate::line::Quantity;
use crate::spec::{LightSpec, LooksSpec, SkySpec};
use crate::table::{Reader, Section};

const AZIMUTH: Quantity = Quantity::angle("azimuth of the sun").within(-360.0, 360.0);
const ELEVATION: Quantity = Quantity::angle("elevation of the sun").within(1.0, 90.0);
const AMBIENT: Quantity = Quantity::number("share of ambient light", 0.0, 1.0);

impl Reader<'_> {
    /// `colour`, `light` and `sky` of a world.
    pub(super) fn looks(&mut self, section: &mut Section<'_, '_>) -> LooksSpec {
        let colour = self.shades(section, "colour");
        let light = self.section_like(section, "light", "azimuth_deg = -120, shadows = true");
        let light = light.map(|light| self.light(light)).unwrap_or_default();
        let sky = self.section_like(section, "sky", "horizon = [200, 210, 220], ground = [90, 90, 80]");
        let sky = sky.map(|sky| self.sky(sky)).unwrap_or_default();
        LooksSpec { colour, light, sky }
    }

    fn light(&mut self, mut section: Section<'_, '_>) -> LightSpec {
        let mut light = LightSpec::default();
        self.set(&mut section, "azimuth_deg", &AZIMUTH, &mut light.azimuth);
        self.set(&mut section, "elevation_deg", &ELEVATION, &mut light.elevation);
        self.set(&mut section, "ambient", &AMBIENT, &mut light.ambient);
        light.shadows = self.flag(&mut section, "shadows").unwrap_or(light.shadows);
        self.unknown_keys(&section);
        light
    }

    fn sky(&mut self, mut section: Section<'_, '_>) -> SkySpec {
        let usual = SkySpec::default();
        let sky = SkySpec {
            horizon: self.shades(&mut section, "horizon").unwrap_or(usual.horizon),
            zenith: self.shades(&mut section, "zenith").unwrap_or(usual.zenith),
            ground: self.shades(&mut section, "ground").unwrap_or(usual.ground),
        };
        self.unknown_keys(&section);
        sky
    }
}
