//! Types of passive objects.

use std::sync::Arc;

use glam::DVec3;

use super::{Collider, ModelSpec, Surface, stem};
use crate::scene::Mesh;

/// Default mass of an object type, in kg, as in EyeSim VR's graphics library.
pub const DEFAULT_OBJECT_MASS: f64 = 1.0;

/// Default coefficient of friction between floor and an object: cardboard on a hard floor. Source: our choice.
pub const DEFAULT_FRICTION: f64 = 0.4;

/// Default rolling resistance of an object made of spheres only: a ball on short carpet. Source: our choice.
pub const DEFAULT_ROLLING: f64 = 0.02;

/// Default restitution of an object type. Source: our choice.
pub const DEFAULT_RESTITUTION: f64 = 0.3;

/// Density of water, in kg/m³.
const WATER_DENSITY: f64 = 1000.0;

/// Diameter and height of an object without a collider, in metres.
const DEFAULT_SIZE: f64 = 0.1;

/// Names of the built-in object types.
pub const BUILT_IN_OBJECTS: [&str; 4] = ["Can", "Soccer", "Crate", "Golf"];

/// A type of passive object: built in, described by an `.esObj` file, or given only by a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectType {
    /// The file that describes it: an `.esObj`, or the sim file that names only a mesh. For a built-in type, the type's
    /// name.
    pub file: String,
    /// Name by which scenes refer to it.
    pub name: String,
    /// Mesh that cameras and the window show.
    pub model: Option<ModelSpec>,
    /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
    pub scale: f64,
    /// Shape; a default if the file does not describe one.
    pub colliders: Vec<Collider>,
    /// Mass in kg; positive.
    pub mass: f64,
    /// Centre of mass in the object's frame, in metres.
    pub centre_of_mass: DVec3,
    /// True if the object is immovable.
    pub is_fixed: bool,
    /// Coefficient of sliding friction on the floor; not negative.
    pub friction: f64,
    /// Coefficient of rolling resistance: deceleration as a fraction of gravity; `None` for an object that slides.
    pub rolling: Option<f64>,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f64,
    /// Red, green, blue if the colour does not come from a mesh.
    pub colour: Option<[u8; 3]>,
    /// Reflection properties.
    pub surface: Surface,
    /// Shape for three-dimensional range sensors.
    pub sensor_shape: SensorShape,
    /// Volume of water that the submerged object displaces, in cubic metres; 0 if it does not float. It has no effect
    /// on dry land.
    pub displaced_volume: f64,
    /// Height of the object's frame above the floor, in metres: greater than 0 for an object that
    /// [floats](Self::afloat).
    pub lift: f64,
}

impl Default for ObjectType {
    /// The type of a file without any entries: an upright cylinder.
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
            sensor_shape: SensorShape::Colliders,
            displaced_volume: 0.0,
            lift: 0.0,
        }
    }
}

impl ObjectType {
    /// An object type with all defaults, named by the file's stem.
    pub fn with_defaults(file: &str) -> Self {
        Self { file: file.to_owned(), name: stem(file).to_owned(), ..Self::default() }
    }

    /// This type floating in still water of depth `depth` (m). `None` if the object does not float: it is fixed, it is
    /// not lighter than the water that it displaces, or the water is too shallow.
    ///
    /// The submerged fraction of the colliders' height is the object's mass divided by the mass of the displaced volume
    /// of water: exact for upright prisms, our choice for other shapes.
    pub fn afloat(&self, depth: f64) -> Option<Self> {
        let submerged = self.mass / (WATER_DENSITY * self.displaced_volume);
        if self.is_fixed || submerged >= 1.0 {
            return None;
        }
        let bottom = self.colliders.iter().map(Collider::bottom).reduce(f64::min).unwrap_or_default();
        let top = self.colliders.iter().map(Collider::top).reduce(f64::max).unwrap_or_default();
        let lift = depth - bottom - submerged * (top - bottom);
        (lift > 0.0).then(|| Self { lift, ..self.clone() })
    }
}

/// Shape of an object for three-dimensional range sensors.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SensorShape {
    /// Its colliders.
    #[default]
    Colliders,
    /// Its mesh; contacts still use the colliders. `None` until the mesh has been read.
    Mesh(Option<Arc<Mesh>>),
}
