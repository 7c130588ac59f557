//! Shapes and appearance of robots and objects.

use glam::{DVec2, DVec3};

use super::SpannedText;

/// A mesh file, and the pose of the mesh in the frame of the body that it depicts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelSpec {
    /// The mesh file.
    pub path: SpannedText,
    /// Position of the mesh's origin in the body's frame (x forward, y left, z up), in metres.
    pub offset: DVec3,
    /// Rotation angles about the axes of the mesh file (X right, Y up, Z forward), in radians, as given in the line.
    pub rotations: DVec3,
}

/// An axis of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Forward.
    X,
    /// To the left.
    Y,
    /// Upwards.
    Z,
}

/// A part of a body's shape, in the body's frame (x forward, y left, z up), in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Collider {
    /// A box along the axes of the frame.
    Box {
        /// Its centre.
        centre: DVec3,
        /// Its full side lengths; all positive.
        size: DVec3,
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
    },
    /// A cylinder with hemispheres at its ends.
    Capsule {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
        /// Its full length including the hemispheres; at least twice the radius.
        height: f64,
        /// Axis of its length.
        axis: Axis,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its centre.
        centre: DVec3,
        /// Its radius; positive.
        radius: f64,
        /// Its full height; positive.
        height: f64,
    },
}

impl Default for Collider {
    /// Returns a collider that is a point.
    fn default() -> Self {
        Self::Sphere { centre: DVec3::ZERO, radius: 0.0 }
    }
}

impl Collider {
    /// Height of its highest point in the frame of its body, in metres.
    pub fn top(&self) -> f64 {
        match *self {
            Collider::Box { centre, size } => centre.z + 0.5 * size.z,
            Collider::Sphere { centre, radius } => centre.z + radius,
            Collider::Capsule { centre, height, axis: Axis::Z, .. } | Collider::Cylinder { centre, height, .. } => {
                centre.z + 0.5 * height
            }
            Collider::Capsule { centre, radius, .. } => centre.z + radius,
        }
    }

    /// This collider, raised by `lift` metres.
    pub fn raised(mut self, lift: f64) -> Self {
        let (Self::Box { centre, .. }
        | Self::Sphere { centre, .. }
        | Self::Cylinder { centre, .. }
        | Self::Capsule { centre, .. }) = &mut self;
        centre.z += lift;
        self
    }

    /// Height of its lowest point in the frame of its body, in metres.
    pub fn bottom(&self) -> f64 {
        match *self {
            Collider::Box { centre, .. }
            | Collider::Sphere { centre, .. }
            | Collider::Capsule { centre, .. }
            | Collider::Cylinder { centre, .. } => 2.0 * centre.z - self.top(),
        }
    }

    /// Radius of the smallest disc about the frame's origin that contains the collider seen from above, in metres.
    pub fn reach(&self) -> f64 {
        match *self {
            Collider::Box { centre, size } => (centre.truncate().abs() + 0.5 * size.truncate()).length(),
            Collider::Sphere { centre, radius } | Collider::Cylinder { centre, radius, .. } => {
                centre.truncate().length() + radius
            }
            Collider::Capsule { centre, radius, height, axis } => {
                let half = (0.5 * height - radius).max(0.0);
                let core = match axis {
                    Axis::X => DVec2::new(half, 0.0),
                    Axis::Y => DVec2::new(0.0, half),
                    Axis::Z => DVec2::ZERO,
                };
                (centre.truncate().abs() + core).length() + radius
            }
        }
    }
}
