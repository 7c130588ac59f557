//! Robot types, with all properties of a robi and its companion.

use serde_json::Value as Json;
use toml::Value;

use super::device::{HDT, SERIALS};
use super::kind::{Bounded, Custom, Kind, PartialTable, ReadContext, TABLE, TABLES, TEXT, Word, Words};
use super::legs::leg_keys;
use super::sensor::{POINT_3D, range_sensor_keys};
use super::{Definitions, Form, Keys};
use crate::Diagnostic;
use crate::code::Code;
use crate::line::Quantity;
use crate::robi::{default_wheelbase, drive_devices};
use crate::spec::{HullSpec, LinkSpec, MotorSpec, RobiSpec, SpannedText, WheelSpec};
use crate::table::{Reader, Section};
use sim_core::drive::DriveKind;

/// Maximum number of links of a robot, ten times more than any robot needs.
const MAX_LINKS: usize = 256;

impl Form for RobiSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("RobotTypeForm", "A robot type: only a file, or the properties of a `.robi` and its companion.");
        keys.key("file", "A `.robi`, with the companion beside it; excludes all other keys.")
            .nullable(TEXT, &mut None::<SpannedText>);
        keys.key("name", "Name by which robots refer to the type; required without a `file`.")
            .required_or_replaced(TEXT, &mut self.name);
        keys.key("diameter_mm", "Diameter of the body in mm; default: 180.")
            .always_printed(Quantity::size("diameter"), &mut self.diameter);
        limit_keys(keys, self);
        keys.key(
            "axis_mm",
            "Position of the wheel axis on the robot's x axis in mm, positive ahead of the centre; default: 0.",
        )
        .optional(Quantity::coordinate("axis offset"), &mut self.axis_offset);
        keys.key("centre_of_mass_mm", "Centre of mass, x forward, y left, z up, in mm; default: 0.")
            .optional(POINT_3D, &mut self.centre_of_mass);
        keys.key("model", "Appearance of the body.").nullable(TABLE, &mut self.model);
        keys.key("collider", "Three-dimensional shape of the body; contacts use the disc.")
            .list(TABLES, &mut self.colliders);
        keys.mention_first(&["wheel", "drive", "psd"]);
        keys.key("body", "Mass, traction and friction.").always_printed(PartialTable(body_keys), self);
        keys.key("wheel", "The wheels, which are all equal.").always_printed(TABLE, &mut self.wheel);
        if keys.reading().is_some() {
            self.drive.wheelbase = default_wheelbase_of(self);
        }
        keys.key("drive", "The drive.").always_printed(PartialTable(full_drive_keys), self);
        structure_keys(keys, self);
        keys.key("psd", "PSD distance sensors.").list(TABLES, &mut self.psds);
        device_list_keys(keys, self);
        if let Some((reader, _)) = keys.reading() {
            reader.check_devices(self);
        }
    }
}

/// Reads a robot type from a file that contains nothing else.
pub(crate) fn read_robot_type(file: &str, text: &str) -> (RobiSpec, Vec<Diagnostic>) {
    let mut robi = RobiSpec::with_defaults(file);
    let (mut reader, root) = Reader::parse(file, text);
    reader.table(Section::root(&root), |keys| robi.keys(keys));
    (robi, reader.sink.finish())
}

/// Declares the keys of a companion except for the PSDs.
pub(crate) fn companion(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    limit_keys(keys, robi);
    keys.key("body", "Mass, traction and friction.").always_printed(PartialTable(body_keys), robi);
    keys.key("wheel", "The wheels, which are all equal.").always_printed(TABLE, &mut robi.wheel);
    keys.key("drive", "The drive.").always_printed(PartialTable(drive_keys), robi);
    structure_keys(keys, robi);
    device_list_keys(keys, robi);
}

/// Declares the maximum speeds.
fn limit_keys(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    keys.key("max_speed_mm_per_s", "Maximum speed in mm/s; default: 600.")
        .always_printed(Quantity::speed("largest speed"), &mut robi.max_speed);
    keys.key("max_turn_deg_per_s", "Maximum turning speed in degrees/s; default: 300.")
        .always_printed(Quantity::rate("largest turning speed"), &mut robi.max_turn);
}

/// Declares the surface of the body, the links, the legs and the hull.
fn structure_keys(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    keys.key("surface", "Reflection properties of the body.").optional(TABLE, &mut robi.surface);
    keys.key("link", "Links: parts on which sensors are mounted.").list(LINKS, &mut robi.links);
    leg_keys(keys, robi);
    keys.key("hull", "The hull under water; for `kind = \"thrusters\"`.").optional(TABLE, &mut robi.hull);
}

/// Declares all devices except for the PSDs.
fn device_list_keys(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    range_sensor_keys(keys, &mut robi.ranges);
    keys.key("camera", "The camera.").nullable(TABLE, &mut robi.camera);
    keys.key("lidar", "The laser scanner.").nullable(TABLE, &mut robi.lidar);
    keys.key("infrared", "Infrared switches.").list(TABLES, &mut robi.infrareds);
    keys.key("bumper", "Bumpers.").list(TABLES, &mut robi.bumpers);
    keys.key("servo", "Servos.").list(TABLES, &mut robi.servos);
    keys.key("compass", "The compass.").nullable(TABLE, &mut robi.compass);
    keys.key("lcd", "The colour display of RoBIOS-7.").optional(TABLE, &mut robi.lcd);
    keys.key("input", "Readings of inputs that no simulated device drives.").optional(TABLE, &mut robi.inputs);
    keys.key("serial", "Devices at the serial interfaces 1 to 16.").list(SERIALS, &mut robi.serials);
    keys.key("hdt", "Numbers by which programs address devices.").list(HDT, &mut robi.hdt);
}

fn body_keys(robi: &mut RobiSpec, keys: &mut Keys<'_>) {
    keys.form("BodyForm", "Mass, traction and friction of a robot.");
    keys.key("mass_kg", "Mass in kg; default: 1.").always_printed(Bounded(Quantity::mass("mass")), &mut robi.mass);
    keys.key("traction", "Coefficient of friction between wheels and floor; default: 0.6.")
        .always_printed(Bounded(Quantity::number("traction", 0.0, 100.0)), &mut robi.traction);
    keys.key("friction", "Coefficient of friction between body and walls; default: 0.3.")
        .optional(Bounded(Quantity::number("friction", 0.0, 100.0)), &mut robi.friction);
}

impl Form for WheelSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("WheelForm", "The wheels.");
        keys.key("diameter_mm", "Diameter in mm; default: 50.")
            .always_printed(Quantity::size("wheel diameter"), &mut self.diameter);
        keys.key("max_rate_deg_per_s", "Maximum turning rate in degrees/s; default: 3600.")
            .always_printed(Quantity::rate("largest rate"), &mut self.max_rate);
        keys.key("ticks_per_turn", "Encoder counts per turn; default: 1000.")
            .always_printed(Quantity::number("encoder ticks", 1e-3, 1e9), &mut self.ticks_per_turn);
        keys.key("track_mm", "Distance between left and right wheels in mm; default: 90.")
            .always_printed(Quantity::size("track"), &mut self.track);
    }
}

/// Declares all keys of a drive.
fn full_drive_keys(robi: &mut RobiSpec, keys: &mut Keys<'_>) {
    keys.form("DriveForm", "The drive.");
    keys.key("kind", "Its kind; default: differential.").always_printed(Word, &mut robi.drive.kind);
    let wheelbase = default_wheelbase_of(robi);
    let drive = &mut robi.drive;
    let mut steering = drive.steering.take().map(|text| SpannedText { text, ..SpannedText::default() });
    if keys.reading().is_some() {
        (drive.motors, drive.steering) = drive_devices(drive.kind);
        drive.wheelbase = wheelbase;
    }
    keys.key(
        "motor",
        "Motors: left, right; of a car one; of an omni drive front left, front right, back left, back right; thrusters: left, \
         front, right, back.",
    )
    .non_empty_list(Motors(drive.motors.len()), &mut drive.motors);
    keys.key("steering", "The servo that steers a car.").nullable(TEXT, &mut steering);
    if let Some((reader, _)) = keys.reading()
        && let Some(servo) = steering
    {
        if drive.kind == DriveKind::Ackermann {
            drive.steering = Some(servo.text);
        } else {
            let message = "only an ackermann drive has a servo that steers; it is left out";
            reader.sink.warn(Code::TomlConflict, servo.span, message, "`kind = \"ackermann\"`");
        }
    }
    drive_keys(robi, keys);
}

/// Default wheelbase of a robot type.
fn default_wheelbase_of(robi: &RobiSpec) -> f64 {
    default_wheelbase(robi.drive.kind, robi.diameter, robi.wheel.track)
}

/// Declares the keys of a drive other than its kind and its devices.
fn drive_keys(robi: &mut RobiSpec, keys: &mut Keys<'_>) {
    let default = default_wheelbase_of(robi);
    let drive = &mut robi.drive;
    let mut wheelbase = Some(drive.wheelbase).filter(|wheelbase| *wheelbase != default && keys.reading().is_none());
    keys.key(
        "wheelbase_mm",
        "Distance between front and rear wheels in mm; default: 0.6 of the diameter for a car, otherwise the track.",
    )
    .nullable(Quantity::size("wheelbase"), &mut wheelbase);
    drive.wheelbase = wheelbase.unwrap_or(drive.wheelbase);
    let steer = Quantity::angle("largest steering angle").within(0.1, 85.0);
    keys.key("max_steer_deg", "Steering angle at the servo's ends in degrees; default: 45.")
        .always_printed(Bounded(steer), &mut drive.max_steer);
    keys.key("wheel_lag_ms", "Time constant between a wheel's command and its speed in ms; default: 0.")
        .optional(Bounded(Quantity::milliseconds("lag of the wheels")), &mut drive.wheel_lag);
}

/// Coefficients of linear and of quadratic drag.
const DRAG: [Quantity; 2] = [Quantity::number("linear drag", 1e-6, 1e6), Quantity::number("quadratic drag", 0.0, 1e6)];

impl Form for HullSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("HullForm", "A hull under water. Drags are linear and quadratic, in N per m/s and per (m/s)^2.");
        keys.key("thrust_n", "Force of a thruster at its maximum rate in N; default: 20.")
            .optional(Bounded(Quantity::number("thrust", 1e-6, 1e6)), &mut self.thrust);
        let [ahead, sideways, turn, up] = &mut self.drag;
        keys.key("drag_ahead", "Drag ahead and backwards; default: [10, 40].").optional(DRAG, ahead);
        keys.key("drag_aside", "Drag to the side; default: [30, 150].").optional(DRAG, sideways);
        keys.key("drag_turn", "Drag of a turn, in N m per rad/s and per (rad/s)^2; default: [4, 12].")
            .optional(DRAG, turn);
        keys.key("drag_up", "Drag up and down; default: [30, 150].").optional(DRAG, up);
    }
}

impl Words for DriveKind {
    const NAME: &'static str = "DriveKindForm";
    const ABOUT: &'static str = "Kinds of drives.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (DriveKind::Differential, "differential", "Two wheels."),
        (DriveKind::Ackermann, "ackermann", "A car."),
        (DriveKind::Omni, "omni", "Four Mecanum wheels."),
        (DriveKind::Legged, "legged", "Legs."),
        (DriveKind::Thrusters, "thrusters", "Four thrusters under water."),
    ];
}

impl Form for MotorSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("MotorForm", "A motor with its encoder.");
        keys.key("name", "Its name, such as `MOTOR_LEFT`.").required(TEXT, &mut self.motor);
        keys.key("encoder", "The name of its encoder, such as `QUAD_LEFT`.").nullable(TEXT, &mut self.encoder);
    }
}

/// Motors of a drive; the field is their number.
struct Motors(usize);

impl Kind<Vec<MotorSpec>> for Motors {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<MotorSpec>>) -> Option<Vec<MotorSpec>> {
        let ReadContext { reader, section, key } = context;
        let sections = reader.sections(section, key);
        let (count, expected) = (sections.len(), self.0);
        let motors: Vec<MotorSpec> =
            sections.into_iter().filter_map(|section| reader.form(section, MotorSpec::defaults())).collect();
        if count != 0 && count != expected {
            let message = format!("the drive has {count} of {expected} motors");
            let span = reader.key_span(section, key);
            reader.sink.error(Code::RobiDriveArity, span, message, format!("{expected} motors"));
        }
        Some(motors).filter(|motors| motors.len() == expected)
    }

    fn print(&self, motors: &Vec<MotorSpec>) -> Value {
        TABLES.print(motors)
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        Kind::<Vec<MotorSpec>>::describe(&TABLES, definitions)
    }
}

/// At most `MAX_LINKS` links.
const LINKS: Custom<Vec<LinkSpec>> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        let sections = reader.sections(section, key);
        if sections.len() > MAX_LINKS {
            let message = format!("the robot has {} links", sections.len());
            let span = reader.key_span(section, key);
            reader.sink.error(Code::NumberRange, span, message, format!("at most {MAX_LINKS} links"));
            return None;
        }
        Some(sections.into_iter().filter_map(|section| reader.form(section, LinkSpec::defaults())).collect())
    },
    print: |links| TABLES.print(links),
    describe: |definitions| Kind::<Vec<LinkSpec>>::describe(&TABLES, definitions),
};
