//! Forms of shapes and looks, and of the types of objects.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Number, SolidForm, SurfaceForm};

/// A mesh file and how it is put into the body's frame.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ModelForm {
    /// The mesh file.
    pub(crate) file: String,
    /// Place of the mesh's origin, x forward, y left, z up, in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Turns about the axes of the mesh file, in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) turns_deg: Option<[Number; 3]>,
}

/// A part of a body's shape.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum ColliderForm {
    /// A box along the axes.
    Box {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its full sizes along x, y and z in mm.
        size_mm: [Number; 3],
    },
    /// A sphere.
    Sphere {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
    },
    /// A cylinder with half spheres at its ends.
    Capsule {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
        /// Its full length in mm, with the half spheres.
        height_mm: Number,
        /// Along which it lies; z if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<AxisForm>,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its centre, x forward, y left, z up, in mm; 0 if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        centre_mm: Option<[Number; 3]>,
        /// Its radius in mm.
        radius_mm: Number,
        /// Its full height in mm.
        height_mm: Number,
    },
}

/// An axis of a body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AxisForm {
    /// Forward.
    X,
    /// To the left.
    Y,
    /// Upwards.
    Z,
}

/// An object type: a file alone, or all that an `.esObj` can say.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObjectTypeForm {
    /// An `.esObj`; no other key then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) file: Option<String>,
    /// Name under which objects have it; required without a `file`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) name: Option<String>,
    /// Its looks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) model: Option<ModelForm>,
    /// Length of the mesh's unit in mm; 1000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scale_mm: Option<Number>,
    /// Its shape; an upright cylinder 100 mm wide and high if left out.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) collider: Vec<ColliderForm>,
    /// Mass in kg; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 1e6))]
    pub(crate) mass_kg: Option<Number>,
    /// Centre of mass, x forward, y left, z up, in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) centre_of_mass_mm: Option<[Number; 3]>,
    /// Nothing can move it; false if left out.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub(crate) fixed: bool,
    /// Coefficient of sliding friction on the floor; 0.4 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) friction: Option<Number>,
    /// Coefficient of rolling resistance; 0.02 if left out of a type of spheres alone, which rolls, else none: it slides.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) rolling: Option<Number>,
    /// Coefficient of restitution; 0.3 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) restitution: Option<Number>,
    /// Red, green and blue, 0 to 255.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) colour: Option<[u8; 3]>,
    /// How it reflects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) surface: Option<SurfaceForm>,
    /// What range sensors see of it; its colliders if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) solid: Option<SolidForm>,
    /// Volume in cubic metres by which it floats; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e6))]
    pub(crate) buoyancy_m3: Option<Number>,
}
