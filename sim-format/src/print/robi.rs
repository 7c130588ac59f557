//! Printing of robot types as `.robi` with a companion.

use std::fmt::Write;

use glam::DVec3;
use toml::Table;

use super::number::{degrees, written, written_degrees, written_mm};
use super::sim::quoted;
use super::{Printed, text};
use crate::form::print_non_defaults;
use crate::form::robot::companion;
use crate::form::sensor::psd_keys;
use crate::robi::DRIVES;
use crate::spec::{Axis, Collider, JointSpec, PsdSpec, RobiSpec};
use crate::{content, read_companion, read_robi};
use sim_core::drive::DriveKind;

/// Text of a robi, in the classic dialect unless the dialect of EyeSim VR represents more properties.
///
/// Properties that the robi cannot represent go to the companion ([`print_companion`]); properties that the companion
/// cannot represent either are lost.
pub fn print_robi(robi: &RobiSpec) -> Printed {
    let companion = print_companion(robi);
    let [classic, vr] = [classic_text(robi), vr_text(robi)].map(|text| {
        let lost = differences(robi, &read_back(robi, &text, &companion));
        Printed { text, lost }
    });
    if vr.lost.len() < classic.lost.len() { vr } else { classic }
}

/// Text of the companion that belongs to the text of [`print_robi`].
pub fn print_companion(robi: &RobiSpec) -> String {
    let mut table =
        print_non_defaults(|keys| companion(keys, &mut robi.clone()), |keys| companion(keys, &mut RobiSpec::default()));
    // Keep only the keys that the robi itself does not represent.
    if let Some(camera) = table.get_mut("camera").and_then(toml::Value::as_table_mut) {
        camera.retain(|key, _| matches!(key, "fov_deg" | "fisheye_deg" | "samples"));
        if camera.is_empty() {
            table.remove("camera");
        }
    }
    if !robi.psds.is_empty() {
        let psds = robi.psds.iter().cloned();
        let tables = psds.map(|mut psd| {
            (
                psd.name.clone(),
                print_non_defaults(|keys| psd_keys(keys, &mut psd), |keys| psd_keys(keys, &mut PsdSpec::default()))
                    .into(),
            )
        });
        table.insert("psd".to_owned(), Table::from_iter(tables).into());
    }
    text::document(&table)
}

/// The robot type as read from a robi and its companion.
fn read_back(robi: &RobiSpec, text: &str, companion: &str) -> RobiSpec {
    let mut read = read_robi(&robi.file, text).0;
    read_companion(&robi.file, companion, &mut read);
    read
}

/// Descriptions of the properties in which two robot types differ.
fn differences(a: &RobiSpec, b: &RobiSpec) -> Vec<String> {
    let (a, b) = (content::robi(a), content::robi(b));
    let properties = [
        (a.name != b.name, "the name"),
        (a.diameter != b.diameter, "the diameter of the body"),
        ((a.max_speed, a.max_turn) != (b.max_speed, b.max_turn), "the largest speeds"),
        (a.axis_offset != b.axis_offset, "the position of the axis"),
        (a.wheel != b.wheel, "the wheels"),
        (a.drive != b.drive, "the drive"),
        (a.links != b.links, "the links"),
        (a.legs != b.legs, "the legs"),
        (a.psds != b.psds, "the PSDs"),
        (a.ranges != b.ranges, "the range sensors"),
        (a.surface != b.surface, "the surface"),
        (a.camera != b.camera, "the camera"),
        (a.lidar != b.lidar, "the laser scanner"),
        (a.model != b.model, "the position of the mesh"),
        (a.colliders != b.colliders, "the colliders"),
        (a.mass != b.mass, "the mass"),
        (a.centre_of_mass != b.centre_of_mass, "the centre of mass"),
        (a.traction != b.traction, "the traction"),
        (a.friction != b.friction, "the friction of the body"),
        (a.infrareds != b.infrareds, "the infrared switches"),
        (a.bumpers != b.bumpers, "the bumpers"),
        (a.servos != b.servos, "the servos"),
        (a.compass != b.compass, "the compass"),
        (a.lcd != b.lcd, "the display"),
        (a.serials != b.serials, "the serial interfaces"),
        ((a.inputs, a.hdt) != (b.inputs, b.hdt), "the inputs and numbers of devices"),
    ];
    properties
        .into_iter()
        .filter(|(differs, _)| *differs)
        .map(|(_, property)| format!("{property} of the robot type"))
        .collect()
}

/// Text of a robi in the classic dialect.
fn classic_text(robi: &RobiSpec) -> String {
    let mut out = first_lines(robi);
    let _ = writeln!(out, "axis {}", written_mm(robi.axis_offset));
    if let Some(model) = &robi.model {
        let _ = writeln!(out, "model {}", quoted(&model.path.text).unwrap_or_default());
    }
    device_lines(&mut out, robi, robi.wheel.track);
    out
}

/// Text of a robi in the dialect of EyeSim VR.
fn vr_text(robi: &RobiSpec) -> String {
    let mut out = first_lines(robi);
    let _ = writeln!(out, "mass {} {}", written(robi.mass), unity(robi.centre_of_mass));
    if let Some(model) = &robi.model {
        let turns = model.rotations.to_array().map(written_degrees).join(" ");
        let _ = writeln!(out, "model {} {} {turns}", quoted(&model.path.text).unwrap_or_default(), unity(model.offset));
    }
    for collider in &robi.colliders {
        let _ = match *collider {
            Collider::Box { centre, size } => {
                writeln!(out, "collider box {} {}", unity(DVec3::new(size.x, -size.y, size.z)), unity(centre))
            }
            Collider::Sphere { centre, radius } => {
                writeln!(out, "collider sphere {} {}", written_mm(radius), unity(centre))
            }
            Collider::Capsule { centre, radius, height, axis: Axis::Z } => {
                writeln!(out, "collider capsule {} {} {}", written_mm(radius), written_mm(height), unity(centre))
            }
            Collider::Capsule { .. } | Collider::Cylinder { .. } => Ok(()),
        };
    }
    let _ = writeln!(out, "axis {} {}", written_mm(0.5 * robi.wheel.diameter), written_mm(robi.axis_offset));
    let is_omni = robi.drive.kind == DriveKind::Omni;
    device_lines(&mut out, robi, if is_omni { robi.wheel.track } else { 0.5 * robi.wheel.track });
    out
}

/// The first lines, which are the same in all dialects.
fn first_lines(robi: &RobiSpec) -> String {
    let motors = robi.drive.motors.iter().flat_map(|motor| [Some(motor.motor.as_str()), motor.encoder.as_deref()]);
    let names = motors.flatten().chain(robi.drive.steering.as_deref());
    let kind = DRIVES.iter().find(|(_, kind, _)| *kind == robi.drive.kind).map_or("", |(word, ..)| *word);
    let mut out = format!("drive {kind}");
    names.for_each(|name| {
        let _ = write!(out, " {name}");
    });
    let _ = write!(out, "\nname {}\ndiameter {}\n", robi.name, written_mm(robi.diameter));
    let _ = write!(out, "speed {}\nturn {}\n", written_mm(robi.max_speed), written_degrees(robi.max_turn));
    out
}

/// Appends the lines of the PSDs, the camera and the wheels; `track` is the last number of the wheels' line.
fn device_lines(out: &mut String, robi: &RobiSpec, track: f64) {
    for psd in &robi.psds {
        let id = psd.id.map(|id| format!("{id} ")).unwrap_or_default();
        let position = psd.position.to_array().map(written_mm).join(" ");
        let _ = writeln!(out, "psd {} {id}{position} {}", psd.name, written_degrees(psd.angle));
    }
    if let Some(camera) = &robi.camera {
        let position = camera.position.to_array().map(written_mm).join(" ");
        let joint = |joint: &JointSpec| match joint {
            JointSpec::Fixed(angle) => written_degrees(*angle),
            JointSpec::Servo { name, from, to } => {
                format!("{name}({:+},{:+})", degrees(*from), degrees(*to))
            }
        };
        let _ = write!(out, "camera {position} {} {}", joint(&camera.pan), joint(&camera.tilt));
        if let Some([width, height]) = camera.image {
            let _ = write!(out, " {width} {height}");
        }
        out.push('\n');
    }
    let wheel = &robi.wheel;
    let (diameter, rate) = (written_mm(wheel.diameter), written_degrees(wheel.max_rate));
    let _ = writeln!(out, "wheel {diameter} {rate} {} {}", written(wheel.ticks_per_turn), written_mm(track));
}

/// Position in the axes of Unity: X right, Y up, Z forward.
fn unity(point: DVec3) -> String {
    [0.0 - point.y, point.z, point.x].map(written_mm).join(" ")
}
