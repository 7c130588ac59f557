//! Types of robots and objects that a scene describes in place: all that a robi with its companion and an esObj can say.

use std::collections::BTreeSet;

use glam::DVec3;

use super::inline_file;
use super::world::MESH_UNIT;
use crate::code::Code;
use crate::line::Quantity;
use crate::range::PITCH;
use crate::read_robi;
use crate::robi::WHEELBASE_OF_DIAMETER;
use crate::spec::{
    Axis, Collider, DEFAULT_PSD_RANGE, DEFAULT_ROLLING, DriveSpec, ModelSpec, MotorSpec, ObjectType, PsdSpec, RobiSpec,
    SimSpec, Solid,
};
use crate::table::{Reader, Section};
use sim_core::drive::DriveKind;

/// Kinds of drives.
const DRIVES: [&str; 4] = ["differential", "ackermann", "omni", "legged"];
/// The same in a robi.
const DRIVE_WORDS: [&str; 4] = ["DIFFERENTIAL_DRIVE", "ACKERMANN_DRIVE", "OMNI_DRIVE", "LEGGED_DRIVE"];
/// Shapes of colliders.
const SHAPES: [&str; 4] = ["box", "sphere", "capsule", "cylinder"];
/// What range sensors in space see of an object.
const SOLIDS: [&str; 2] = ["colliders", "mesh"];
const AXES: [&str; 3] = ["x", "y", "z"];

const PLACE: [Quantity; 3] = [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::coordinate("z")];
const SIZES: [Quantity; 3] = [Quantity::size("size"), Quantity::size("size"), Quantity::size("size")];
const TURNS: [Quantity; 3] = [Quantity::angle("turn"), Quantity::angle("turn"), Quantity::angle("turn")];

/// The wheelbase of a type that does not say, as in a robi.
pub(crate) fn default_wheelbase(robi: &RobiSpec) -> f64 {
    match robi.drive.kind {
        DriveKind::Ackermann => WHEELBASE_OF_DIAMETER * robi.diameter,
        _ => robi.wheel.track,
    }
}

impl Reader<'_> {
    /// A type of robots; `names` are those of the types before it.
    pub(super) fn robot_type(&mut self, mut section: Section<'_, '_>, names: &mut BTreeSet<String>, sim: &mut SimSpec) {
        if section.has("file") {
            sim.robot_types.extend(self.reference(&mut section, "file"));
            self.alone(&section);
            return;
        }
        section.get("file");
        let mut robi = RobiSpec::with_defaults(&sim.file);
        let name = self.required_reference(&mut section, "name");
        if let Some(name) = &name {
            robi.name.clone_from(&name.text);
            robi.file = inline_file(&sim.file, &name.text);
        }
        self.set(&mut section, "diameter_mm", &Quantity::size("diameter"), &mut robi.diameter);
        self.set(&mut section, "max_speed_mm_per_s", &Quantity::speed("largest speed"), &mut robi.max_speed);
        self.set(&mut section, "max_turn_deg_per_s", &Quantity::rate("largest turning speed"), &mut robi.max_turn);
        self.set(&mut section, "axis_mm", &Quantity::coordinate("axis offset"), &mut robi.axis_offset);
        if let Some([x, y, z]) = self.numbers(&mut section, "centre_of_mass_mm", &PLACE) {
            robi.centre_of_mass = DVec3::new(x, y, z);
        }
        if let Some(model) = self.section(&mut section, "model") {
            robi.model = self.model(model);
        }
        for collider in self.sections(&mut section, "collider") {
            robi.colliders.extend(self.collider(collider));
        }
        if let Some(wheel) = self.section(&mut section, "wheel") {
            self.wheel(wheel, &mut robi);
        }
        robi.drive.wheelbase = default_wheelbase(&robi);
        if let Some(drive) = self.section(&mut section, "drive") {
            self.drive_of_type(drive, &mut robi);
        }
        for psd in self.sections(&mut section, "psd") {
            robi.psds.extend(self.psd_of_type(psd));
        }
        self.devices(&mut section, &mut robi);
        self.unknown_keys(&section);
        self.settle_devices(&mut robi);
        let Some(name) = name else { return };
        if !names.insert(name.text.clone()) {
            let message = format!("a second type named `{}`; it is left out", name.text);
            self.sink.warn(Code::SimTypeTwice, name.span, message, "each name once");
            return;
        }
        sim.inline.robot_types.push((robi, section.span));
    }

    /// A type that is a file has no other keys.
    fn alone(&mut self, section: &Section<'_, '_>) {
        for (key, _) in section.table {
            if key.get_ref() != "file" {
                let span = self.span(key.span());
                let message = format!("`{}` and `file` exclude each other", key.get_ref());
                self.sink.error(Code::TomlConflict, span, message, "either `file` alone or the type in place");
            }
        }
    }

    fn wheel(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let wheel = &mut robi.wheel;
        self.set(&mut section, "diameter_mm", &Quantity::size("wheel diameter"), &mut wheel.diameter);
        self.set(&mut section, "max_rate_deg_per_s", &Quantity::rate("largest rate"), &mut wheel.max_rate);
        let ticks = Quantity::number("encoder ticks", 1e-3, 1e9);
        self.set(&mut section, "ticks_per_turn", &ticks, &mut wheel.ticks_per_turn);
        self.set(&mut section, "track_mm", &Quantity::size("track"), &mut wheel.track);
        self.unknown_keys(&section);
    }

    fn drive_of_type(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let kind = self.choice(&mut section, "kind", &DRIVES).unwrap_or_default();
        // The names that a robi without names has.
        let usual = read_robi("", &format!("drive {}\n", DRIVE_WORDS[kind])).0.drive;
        robi.drive =
            DriveSpec { kind: usual.kind, motors: usual.motors, steering: usual.steering, ..robi.drive.clone() };
        let motors = self.sections(&mut section, "motor");
        if !motors.is_empty() {
            let expected = robi.drive.motors.len();
            let count = motors.len();
            let span = self.key_span(&section, "motor");
            let motors: Vec<MotorSpec> = motors.into_iter().filter_map(|motor| self.motor(motor)).collect();
            if count != expected {
                let message = format!("the drive has {count} of {expected} motors");
                self.sink.error(Code::RobiDriveArity, span, message, format!("{expected} motors"));
            } else if motors.len() == expected {
                robi.drive.motors = motors;
            }
        }
        if let Some(steering) = self.reference(&mut section, "steering") {
            if robi.drive.kind == DriveKind::Ackermann {
                robi.drive.steering = Some(steering.text);
            } else {
                let message = "only an ackermann drive has a servo that steers; it is left out";
                self.sink.warn(Code::TomlConflict, steering.span, message, "`kind = \"ackermann\"`");
            }
        }
        robi.drive.wheelbase = default_wheelbase(robi);
        self.drive_keys(&mut section, robi);
        self.unknown_keys(&section);
    }

    fn motor(&mut self, mut section: Section<'_, '_>) -> Option<MotorSpec> {
        let motor = self.required_reference(&mut section, "name").map(|name| name.text);
        let encoder = self.text(&mut section, "encoder");
        self.unknown_keys(&section);
        Some(MotorSpec { motor: motor?, encoder })
    }

    fn psd_of_type(&mut self, mut section: Section<'_, '_>) -> Option<PsdSpec> {
        let (name, id) = self.device(&mut section);
        let position = self.position(&mut section);
        let [mut angle, mut pitch, mut range] = [0.0, 0.0, DEFAULT_PSD_RANGE];
        let on = self.on(&mut section);
        self.set(&mut section, "pitch_deg", &PITCH, &mut pitch);
        self.set(&mut section, "angle_deg", &Quantity::angle("angle of the sensor"), &mut angle);
        self.set(&mut section, "range_mm", &Quantity::size("range of the sensor"), &mut range);
        self.unknown_keys(&section);
        Some(PsdSpec { name: name?, id, position, angle, pitch, on, range, span: section.span })
    }

    pub(crate) fn position(&mut self, section: &mut Section<'_, '_>) -> DVec3 {
        let mut position = DVec3::ZERO;
        self.set(section, "x_mm", &PLACE[0], &mut position.x);
        self.set(section, "y_mm", &PLACE[1], &mut position.y);
        self.set(section, "z_mm", &PLACE[2], &mut position.z);
        position
    }

    pub(super) fn model(&mut self, mut section: Section<'_, '_>) -> Option<ModelSpec> {
        let path = self.required_reference(&mut section, "file");
        let offset = self.numbers(&mut section, "offset_mm", &PLACE).map_or(DVec3::ZERO, DVec3::from);
        let turns = self.numbers(&mut section, "turns_deg", &TURNS).map_or(DVec3::ZERO, DVec3::from);
        self.unknown_keys(&section);
        Some(ModelSpec { path: path?, offset, turns })
    }

    fn collider(&mut self, mut section: Section<'_, '_>) -> Option<Collider> {
        let kind = self.required_choice(&mut section, "kind", &SHAPES)?;
        let centre = self.numbers(&mut section, "centre_mm", &PLACE).map_or(DVec3::ZERO, DVec3::from);
        let radius = Quantity::size("radius");
        let collider = match SHAPES[kind] {
            "box" => {
                let size = self.required_numbers(&mut section, "size_mm", &SIZES).map(DVec3::from);
                size.map(|size| Collider::Box { centre, size })
            }
            "sphere" => {
                let radius = self.required(&mut section, "radius_mm", &radius);
                radius.map(|radius| Collider::Sphere { centre, radius })
            }
            "capsule" => {
                let radius = self.required(&mut section, "radius_mm", &radius);
                let height = self.required(&mut section, "height_mm", &Quantity::size("height"));
                let axis = match self.choice(&mut section, "axis", &AXES) {
                    Some(0) => Axis::X,
                    Some(1) => Axis::Y,
                    _ => Axis::Z,
                };
                // A shorter one is a sphere, as in robi files.
                radius.zip(height).map(|(radius, height)| Collider::Capsule {
                    centre,
                    radius,
                    height: height.max(2.0 * radius),
                    axis,
                })
            }
            _ => {
                let radius = self.required(&mut section, "radius_mm", &radius);
                let height = self.required(&mut section, "height_mm", &Quantity::size("height"));
                radius.zip(height).map(|(radius, height)| Collider::Cylinder { centre, radius, height })
            }
        };
        self.unknown_keys(&section);
        collider
    }

    pub(super) fn object_type(
        &mut self,
        mut section: Section<'_, '_>,
        names: &mut BTreeSet<String>,
        sim: &mut SimSpec,
    ) {
        if section.has("file") {
            sim.object_types.extend(self.reference(&mut section, "file"));
            self.alone(&section);
            return;
        }
        section.get("file");
        let mut object = ObjectType::with_defaults(&sim.file);
        let name = self.required_reference(&mut section, "name");
        if let Some(name) = &name {
            object.name.clone_from(&name.text);
            object.file = inline_file(&sim.file, &name.text);
        }
        if let Some(model) = self.section(&mut section, "model") {
            object.model = self.model(model);
        }
        self.set(&mut section, "scale_mm", &MESH_UNIT, &mut object.scale);
        let colliders = self.sections(&mut section, "collider");
        let colliders: Vec<Collider> = colliders.into_iter().filter_map(|collider| self.collider(collider)).collect();
        if !colliders.is_empty() {
            object.colliders = colliders;
        }
        self.set(&mut section, "mass_kg", &Quantity::mass("mass"), &mut object.mass);
        if let Some([x, y, z]) = self.numbers(&mut section, "centre_of_mass_mm", &PLACE) {
            object.centre_of_mass = DVec3::new(x, y, z);
        }
        object.is_fixed = self.flag(&mut section, "fixed").unwrap_or_default();
        self.set(&mut section, "friction", &Quantity::number("friction", 0.0, 1e6), &mut object.friction);
        let rolling = Quantity::number("rolling resistance", 0.0, 1e6);
        let is_ball = object.colliders.iter().all(|collider| matches!(collider, Collider::Sphere { .. }));
        object.rolling = self.number(&mut section, "rolling", &rolling).or(is_ball.then_some(DEFAULT_ROLLING));
        self.set(&mut section, "restitution", &Quantity::number("restitution", 0.0, 1.0), &mut object.restitution);
        object.colour = self.shades(&mut section, "colour").or(object.colour);
        if let Some(surface) = self.section(&mut section, "surface") {
            object.surface = self.surface(surface);
        }
        if self.choice(&mut section, "solid", &SOLIDS) == Some(1) {
            if object.model.is_some() {
                object.solid = Solid::Mesh(None);
            } else {
                self.missing(&section, "model");
            }
        }
        self.set(&mut section, "buoyancy_m3", &Quantity::number("volume", 0.0, 1e6), &mut object.buoyancy);
        self.unknown_keys(&section);
        let Some(name) = name else { return };
        if !names.insert(name.text.clone()) {
            let message = format!("a second type named `{}`; it is left out", name.text);
            self.sink.warn(Code::SimTypeTwice, name.span, message, "each name once");
            return;
        }
        sim.inline.object_types.push((object, section.span));
    }
}
