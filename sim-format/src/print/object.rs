//! Printing of object types as `.esObj`.

use std::fmt::Write;

use glam::DVec3;

use super::Printed;
use super::number::{shortest, written};
use super::sim::quoted;
use crate::spec::{Axis, Collider, ObjectType};
use crate::{content, read_esobj};
use sim_core::unit::metres_from_mm;

/// Text of an object file.
pub fn print_esobj(object: &ObjectType) -> Printed {
    let text = text_of(object);
    let read = read_esobj(&object.file, &text).0;
    Printed { lost: differences(object, &read), text }
}

fn text_of(object: &ObjectType) -> String {
    let mut out = String::new();
    if let Some(model) = &object.model {
        let _ = writeln!(out, "obj {}", quoted(&model.path.text).unwrap_or_default());
    }
    let _ = writeln!(out, "name {}", quoted(&object.name).unwrap_or_default());
    let scale = object.scale;
    let _ = writeln!(out, "scale {}", written(scale));
    // The file states lengths in units of the mesh.
    let factor = metres_from_mm(scale);
    let length = |metres: f64| written(shortest(metres / factor, |units| units * factor == metres));
    let position = |position: DVec3| [0.0 - position.y, position.z, position.x].map(length).join(" ");
    let _ = writeln!(out, "mass {} {}", written(object.mass), position(object.centre_of_mass));
    for collider in &object.colliders {
        let _ = match *collider {
            Collider::Box { centre, size } => {
                writeln!(out, "collider box {} {}", position(centre), position(DVec3::new(size.x, -size.y, size.z)))
            }
            Collider::Sphere { centre, radius } => {
                writeln!(out, "collider sphere {} {}", position(centre), length(radius))
            }
            Collider::Capsule { centre, radius, height, axis } => {
                let axis = match axis {
                    Axis::X => "z",
                    Axis::Y => "x",
                    Axis::Z => "y",
                };
                writeln!(out, "collider capsule {} {} {} {axis}", position(centre), length(radius), length(height))
            }
            Collider::Cylinder { centre, radius, height } => {
                writeln!(out, "collider cylinder {} {} {}", position(centre), length(radius), length(height))
            }
        };
    }
    if object.is_fixed {
        out.push_str("fixed\n");
    }
    let _ = writeln!(out, "friction {}", written(object.friction));
    if let Some(rolling) = object.rolling {
        let _ = writeln!(out, "rolling {}", written(rolling));
    }
    let _ = writeln!(out, "restitution {}", written(object.restitution));
    if let Some([red, green, blue]) = object.colour {
        let _ = writeln!(out, "colour {red} {green} {blue}");
    }
    if object.displaced_volume != 0.0 {
        let _ = writeln!(out, "buoyancy {}", written(object.displaced_volume));
    }
    out
}

/// Descriptions of the properties in which two object types differ.
fn differences(a: &ObjectType, b: &ObjectType) -> Vec<String> {
    let (a, b) = (content::object(a), content::object(b));
    let properties = [
        (a.name != b.name, "the name"),
        (a.model != b.model, "the position of the mesh"),
        (a.scale != b.scale, "the scale"),
        (a.colliders != b.colliders, "the last digits of the colliders"),
        ((a.mass, a.centre_of_mass, a.is_fixed) != (b.mass, b.centre_of_mass, b.is_fixed), "the mass"),
        ((a.friction, a.rolling, a.restitution) != (b.friction, b.rolling, b.restitution), "the friction"),
        (a.colour != b.colour, "the colour"),
        (a.surface != b.surface, "the surface"),
        (a.sensor_shape != b.sensor_shape, "`solid = \"mesh\"`"),
        (a.displaced_volume != b.displaced_volume, "the buoyancy"),
    ];
    properties
        .into_iter()
        .filter(|(differs, _)| *differs)
        .map(|(_, property)| format!("{property} of the object type"))
        .collect()
}
