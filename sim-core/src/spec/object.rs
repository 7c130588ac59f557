//! Types of passive objects.

use std::sync::Arc;

use glam::DVec3;

use super::{Collider, ModelSpec, Surface, stem};
use crate::scene::Mesh;

/// Mass of an object type that does not say, in kg, as in EyeSim VR's graphics library.
pub const DEFAULT_OBJECT_MASS: f64 = 1.0;

/// Friction between floor and an object type that does not say: cardboard on a hard floor. Source: our choice.
pub const DEFAULT_FRICTION: f64 = 0.4;

/// Rolling resistance of an object type of spheres alone that does not say: a ball on short carpet. Source: our choice.
pub const DEFAULT_ROLLING: f64 = 0.02;

/// Restitution of an object type that does not say. Source: our choice.
pub const DEFAULT_RESTITUTION: f64 = 0.3;

/// Diameter and height of an object without a collider, in metres.
const DEFAULT_SIZE: f64 = 0.1;

/// Names of the built-in object types.
pub const BUILT_IN_OBJECTS: [&str; 4] = ["Can", "Soccer", "Crate", "Golf"];

/// A type of passive object: built in, or an `.esObj` file, or a mesh alone.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectType {
    /// The file that describes it: an `.esObj`, or the sim file that names a mesh alone; of a built-in type, its name.
    pub file: String,
    /// Name under which scenes place it.
    pub name: String,
    /// Its looks.
    pub model: Option<ModelSpec>,
    /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
    pub scale: f64,
    /// Its shape; where the file gives none, a default.
    pub colliders: Vec<Collider>,
    /// Mass in kg; positive.
    pub mass: f64,
    /// Centre of mass in the object's frame, in metres.
    pub centre_of_mass: DVec3,
    /// True for what nothing can move.
    pub is_fixed: bool,
    /// Coefficient of sliding friction on the floor; not negative.
    pub friction: f64,
    /// Coefficient of rolling resistance: deceleration over gravity; `None` for what slides.
    pub rolling: Option<f64>,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f64,
    /// Red, green, blue where no mesh shows it.
    pub colour: Option<[u8; 3]>,
    /// How it reflects.
    pub surface: Surface,
    /// What range sensors in space see of it.
    pub solid: Solid,
    /// Volume in cubic metres by which it floats; 0 for none. Without meaning on dry land.
    pub buoyancy: f64,
}

impl Default for ObjectType {
    /// What a file says that leaves all out: an upright cylinder.
    fn default() -> Self {
        Self {
            file: String::new(),
            name: String::new(),
            model: None,
            scale: 1.0,
            colliders: vec![Collider::Cylinder {
                centre: DVec3::new(0.0, 0.0, 0.5 * DEFAULT_SIZE),
                radius: 0.5 * DEFAULT_SIZE,
                height: DEFAULT_SIZE,
            }],
            mass: DEFAULT_OBJECT_MASS,
            centre_of_mass: DVec3::ZERO,
            is_fixed: false,
            friction: DEFAULT_FRICTION,
            rolling: None,
            restitution: DEFAULT_RESTITUTION,
            colour: None,
            surface: Surface::default(),
            solid: Solid::Colliders,
            buoyancy: 0.0,
        }
    }
}

impl ObjectType {
    /// An object type with the defaults for all that a file leaves out, named by the file's stem.
    pub fn with_defaults(file: &str) -> Self {
        Self { file: file.to_owned(), name: stem(file).to_owned(), ..Self::default() }
    }
}

/// What range sensors in space see of an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Solid {
    /// Its colliders.
    #[default]
    Colliders,
    /// Its mesh; contacts stay those of the colliders. `None` as long as the mesh has not been read.
    Mesh(Option<Arc<Mesh>>),
}
