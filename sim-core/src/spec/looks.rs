//! Appearance of a world, for cameras only: light, sky, and colour of the floor.

use crate::unit::radians_from_degrees;

/// Default colour of the floor: light grey, distinct from the colour of the walls. Source: our choice.
pub const DEFAULT_FLOOR_COLOUR: [u8; 3] = [196, 192, 184];

/// Appearance of a world, for cameras only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LooksSpec {
    /// Red, green, blue of a floor without an image; `None`: [`DEFAULT_FLOOR_COLOUR`].
    pub colour: Option<[u8; 3]>,
    /// The light.
    pub light: LightSpec,
    /// Background.
    pub sky: SkySpec,
}

/// The light: a sun, and uniform ambient light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSpec {
    /// Direction of the sun in the floor plane, counter-clockwise from x, in radians.
    pub azimuth: f64,
    /// Elevation of the sun above the floor plane, in radians: above 0, at most a right angle.
    pub elevation: f64,
    /// Fraction of the ambient light, 0 to 1.
    pub ambient: f64,
    /// True if bodies cast shadows.
    pub shadows: bool,
}

impl Default for LightSpec {
    /// A high sun from one side, so that walls in the four directions have four shades; no shadows. Source: our choice.
    fn default() -> Self {
        Self {
            azimuth: radians_from_degrees(-120.0),
            elevation: radians_from_degrees(50.0),
            ambient: 0.4,
            shadows: false,
        }
    }
}

/// Background colours where a camera sees no body: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkySpec {
    /// The sky at the horizon.
    pub horizon: [u8; 3],
    /// The sky straight above.
    pub zenith: [u8; 3],
    /// The ground beyond the floor.
    pub ground: [u8; 3],
}

impl Default for SkySpec {
    /// A light blue sky over a ground of dull green. Source: our choice.
    fn default() -> Self {
        Self { horizon: [206, 222, 236], zenith: [104, 154, 208], ground: [132, 138, 122] }
    }
}
