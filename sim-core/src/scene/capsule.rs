use glam::DVec3;

/// All points within `radius` of the straight piece between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The ends of the piece, in metres.
    pub ends: [DVec3; 2],
    /// In metres; not negative.
    pub radius: f64,
}
