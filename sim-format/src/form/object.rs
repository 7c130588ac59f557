//! Object types, with all properties of an `.esObj`.

use super::kind::{Bounded, Channels, TABLE, TABLES, TEXT, Word, Words};
use super::sensor::POINT_3D;
use super::{Form, Keys};
use crate::line::Quantity;
use crate::spec::{Collider, DEFAULT_ROLLING, ObjectType, SensorShape, SpannedText};

/// Length of one unit of a mesh.
pub(crate) const MESH_UNIT: Quantity = Quantity::coordinate("length of the mesh's unit").within(1e-6, 1e9);

impl Form for ObjectType {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ObjectTypeForm", "An object type: only a file, or the properties of an `.esObj`.");
        keys.key("file", "An `.esObj`; excludes all other keys.").nullable(TEXT, &mut None::<SpannedText>);
        keys.key("name", "Name by which objects refer to the type; required without a `file`.")
            .required_or_replaced(TEXT, &mut self.name);
        keys.key("model", "Its appearance.").nullable(TABLE, &mut self.model);
        keys.key("scale_mm", "Length of the mesh's unit in mm; default: 1000.").optional(MESH_UNIT, &mut self.scale);
        keys.key("collider", "Its shape; default: an upright cylinder, 100 mm wide and 100 mm high.")
            .non_empty_list(TABLES, &mut self.colliders);
        keys.key("mass_kg", "Mass in kg; default: 1.").always_printed(Bounded(Quantity::mass("mass")), &mut self.mass);
        keys.key("centre_of_mass_mm", "Centre of mass, x forward, y left, z up, in mm; default: 0.")
            .optional(POINT_3D, &mut self.centre_of_mass);
        keys.key("fixed", "The object cannot be moved; default: false.").flag(&mut self.is_fixed);
        keys.key("friction", "Coefficient of sliding friction on the floor; default: 0.4.")
            .always_printed(Bounded(Quantity::number("friction", 0.0, 1e6)), &mut self.friction);
        keys.key(
            "rolling",
            "Coefficient of rolling resistance; default: 0.02 if all colliders are spheres, otherwise none: the object slides.",
        )
        .nullable(Bounded(Quantity::number("rolling resistance", 0.0, 1e6)), &mut self.rolling);
        keys.key("restitution", "Coefficient of restitution; default: 0.3.")
            .always_printed(Bounded(Quantity::number("restitution", 0.0, 1.0)), &mut self.restitution);
        keys.key("colour", "Red, green and blue, 0 to 255.").nullable(Channels, &mut self.colour);
        keys.key("surface", "Reflection properties.").optional(TABLE, &mut self.surface);
        let mut sensor_shape = if matches!(self.sensor_shape, SensorShape::Mesh(_)) {
            SensorShapeWord::Mesh
        } else {
            SensorShapeWord::Colliders
        };
        keys.key("solid", "Shape that range sensors detect; default: its colliders.").optional(Word, &mut sensor_shape);
        keys.key("buoyancy_m3", "Displaced volume in cubic metres, for floating; default: 0.")
            .optional(Bounded(Quantity::number("volume", 0.0, 1e6)), &mut self.displaced_volume);
        if let Some((reader, section)) = keys.reading() {
            let is_ball = self.colliders.iter().all(|collider| matches!(collider, Collider::Sphere { .. }));
            self.rolling = self.rolling.or(is_ball.then_some(DEFAULT_ROLLING));
            match (sensor_shape, &self.model) {
                (SensorShapeWord::Colliders, _) => {}
                (SensorShapeWord::Mesh, Some(_)) => self.sensor_shape = SensorShape::Mesh(None),
                (SensorShapeWord::Mesh, None) => reader.missing(section, "model"),
            }
        }
    }
}

/// Shape of an object that range sensors detect.
#[derive(Clone, Copy, PartialEq)]
enum SensorShapeWord {
    Colliders,
    Mesh,
}

impl Words for SensorShapeWord {
    const NAME: &'static str = "SolidForm";
    const ABOUT: &'static str = "Shape of an object for range sensors.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (SensorShapeWord::Colliders, "colliders", "Its colliders."),
        (SensorShapeWord::Mesh, "mesh", "Its mesh; contacts still use the colliders."),
    ];
}
