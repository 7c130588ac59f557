/// Acoustic properties of a surface, for sonar.
///
/// A fraction `specular` of the returned energy leaves only in the mirror direction, the rest in all directions by
/// Lambert's law. Every surface scatters light diffusely, so the other sensors use only distance and incidence angle.
///
/// Source: France et al. 1999, section 3.3: real surfaces combine a diffuse and a specular part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Fraction of the incident energy that is returned, 0 to 1.
    pub reflectivity: f64,
    /// Fraction of the returned energy that is reflected specularly, 0 to 1.
    pub specular: f64,
}

impl Surface {
    /// A rough surface: returns all energy, diffusely.
    pub const ROUGH: Self = Self { reflectivity: 1.0, specular: 0.0 };

    /// A smooth surface: a perfect mirror. For ultrasound, most indoor surfaces are nearly perfect mirrors (France et
    /// al., section 3.4).
    pub const SMOOTH: Self = Self { reflectivity: 1.0, specular: 1.0 };
}

impl Default for Surface {
    /// Returns [`Surface::ROUGH`].
    fn default() -> Self {
        Self::ROUGH
    }
}
