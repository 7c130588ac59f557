/// What a surface does to the wave of a sonar.
///
/// A share `specular` of what it returns leaves in the mirror's direction alone, the rest in all directions by Lambert's
/// law. Light is taken to be scattered by every surface: the other sensors ask for distance and incidence only.
///
/// Source: France et al. 1999, section 3.3: real surfaces combine a diffuse and a specular part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Share of the arriving energy that is returned, 0 to 1.
    pub reflectivity: f64,
    /// Share of the returned energy that leaves as from a mirror, 0 to 1.
    pub specular: f64,
}

impl Surface {
    /// Rough: everything is returned, in all directions.
    pub const ROUGH: Self = Self { reflectivity: 1.0, specular: 0.0 };

    /// Smooth: a perfect mirror. To ultrasound, most surfaces in a room are nearly that (France et al., section 3.4).
    pub const SMOOTH: Self = Self { reflectivity: 1.0, specular: 1.0 };
}

impl Default for Surface {
    /// [`Surface::ROUGH`].
    fn default() -> Self {
        Self::ROUGH
    }
}
