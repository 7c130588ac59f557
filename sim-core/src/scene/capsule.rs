use glam::DVec3;

/// A capsule: all points within `radius` of the segment between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Ends of the segment, in metres.
    pub ends: [DVec3; 2],
    /// Radius in metres; not negative.
    pub radius: f64,
}
