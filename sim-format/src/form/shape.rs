//! Shapes and appearance of bodies.

use glam::DVec3;

use super::kind::{TEXT, Word};
use super::sensor::POINT_3D;
use super::{Form, Keys, Variant, Variants};
use crate::line::Quantity;
use crate::spec::{Axis, Collider, ModelSpec};

const EXTENTS: [Quantity; 3] = [Quantity::size("size"); 3];
const ROTATIONS: [Quantity; 3] = [Quantity::angle("turn"); 3];

impl Form for ModelSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ModelForm", "A mesh file and its pose in the body's frame.");
        keys.key("file", "The mesh file.").required(TEXT, &mut self.path);
        keys.key("offset_mm", "Position of the mesh's origin, x forward, y left, z up, in mm; default: 0.")
            .optional(POINT_3D, &mut self.offset);
        rotation_key(keys, &mut self.rotations);
    }
}

/// Declares the rotations of a mesh.
pub(crate) fn rotation_key(keys: &mut Keys<'_>, rotations: &mut DVec3) {
    keys.key("turns_deg", "Rotations about the axes of the mesh file, in degrees; default: 0.")
        .optional(ROTATIONS, rotations);
}

impl Form for Collider {
    fn bare(&self) -> Self {
        Self::VARIANTS[self.variant_index()].2()
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ColliderForm", "A part of a body's shape.");
        if !keys.variant(self) {
            return;
        }
        let (Self::Box { centre, .. }
        | Self::Sphere { centre, .. }
        | Self::Capsule { centre, .. }
        | Self::Cylinder { centre, .. }) = self;
        keys.key("centre_mm", "Its centre, x forward, y left, z up, in mm; default: 0.").optional(POINT_3D, centre);
        match self {
            Self::Box { size, .. } => {
                keys.key("size_mm", "Its full sizes along x, y and z in mm.").required(EXTENTS, size)
            }
            Self::Sphere { radius, .. } => radius_key(keys, radius),
            Self::Capsule { radius, height, axis, .. } => {
                radius_key(keys, radius);
                keys.key("height_mm", "Its full length in mm, with the half spheres.")
                    .required(Quantity::size("height"), height);
                keys.key("axis", "Direction of its axis; default: z.").always_printed(Word, axis);
                // A shorter capsule becomes a sphere, as in robi files.
                *height = height.max(2.0 * *radius);
            }
            Self::Cylinder { radius, height, .. } => {
                radius_key(keys, radius);
                keys.key("height_mm", "Its full height in mm.").required(Quantity::size("height"), height);
            }
        }
    }
}

fn radius_key(keys: &mut Keys<'_>, radius: &mut f64) {
    keys.key("radius_mm", "Its radius in mm.").required(Quantity::size("radius"), radius);
}

impl Variants for Collider {
    const VARIANTS: &'static [Variant<Self>] = &[
        ("box", "A box along the axes.", || Self::Box { centre: DVec3::ZERO, size: DVec3::ZERO }),
        ("sphere", "A sphere.", || Self::Sphere { centre: DVec3::ZERO, radius: 0.0 }),
        ("capsule", "A cylinder with half spheres at its ends.", || Self::Capsule {
            centre: DVec3::ZERO,
            radius: 0.0,
            height: 0.0,
            axis: Axis::Z,
        }),
        ("cylinder", "An upright cylinder.", || Self::Cylinder { centre: DVec3::ZERO, radius: 0.0, height: 0.0 }),
    ];
}
