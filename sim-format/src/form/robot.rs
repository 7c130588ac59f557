//! Types of robots: all that a robi with its companion can say.

use glam::DVec3;
use schemars::SchemaGenerator;
use serde_json::Value as Json;
use toml::Value;

use super::device::{Hdt, Serials};
use super::kind::{At, Bounded, Kind, PART, PARTS, TEXT, Word, Words};
use super::legs::legs;
use super::sensor::{PLACE, ranges};
use super::{Form, Keys};
use crate::code::Code;
use crate::line::Quantity;
use crate::robi::{drive_devices, usual_wheelbase};
use crate::spec::{DriveSpec, LcdSpec, LinkSpec, MotorSpec, PathRef, RobiSpec, Surface, WheelSpec};
use sim_core::drive::DriveKind;

/// Most links of a robot: none needs a tenth of them.
const MAX_LINKS: usize = 256;

impl Form for RobiSpec {
    const NAME: &'static str = "RobotTypeForm";
    const ABOUT: &'static str = "A robot type: a file alone, or all that a `.robi` and its companion can say.";

    fn usual() -> Self {
        Self::with_defaults("")
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.key("file", "A `.robi`, with the companion beside it; no other key then.")
            .maybe(TEXT, &mut None::<PathRef>);
        keys.key("name", "Name under which robots have it; required without a `file`.").expected(TEXT, &mut self.name);
        keys.key("diameter_mm", "Diameter of the body in mm; 180 if left out.")
            .always(Quantity::size("diameter"), &mut self.diameter);
        keys.key("max_speed_mm_per_s", "Largest speed in mm/s; 600 if left out.")
            .always(Quantity::speed("largest speed"), &mut self.max_speed);
        keys.key("max_turn_deg_per_s", "Largest turning speed in degrees/s; 300 if left out.")
            .always(Quantity::rate("largest turning speed"), &mut self.max_turn);
        keys.key(
            "axis_mm",
            "Place of the wheel axis on the robot's x axis in mm, positive ahead of the centre; 0 if left out.",
        )
        .unless(0.0, Quantity::coordinate("axis offset"), &mut self.axis_offset);
        keys.key("centre_of_mass_mm", "Centre of mass, x forward, y left, z up, in mm; 0 if left out.").unless(
            DVec3::ZERO,
            PLACE,
            &mut self.centre_of_mass,
        );
        keys.key("model", "The body's looks.").maybe(PART, &mut self.model);
        keys.key("collider", "The body's shape in space; contacts are those of the disc.")
            .list(PARTS, &mut self.colliders);
        keys.mention(&["wheel", "drive", "psd"]);
        body(keys, self);
        keys.key("wheel", "The wheels, all alike.").always(PART, &mut self.wheel);
        let mut drive = Drive { spec: self.drive.clone(), diameter: self.diameter, track: self.wheel.track };
        if keys.reading().is_some() {
            drive.spec.wheelbase = drive.usual_wheelbase();
        }
        keys.key("drive", "The drive.").always(PART, &mut drive);
        self.drive = drive.spec;
        frame(keys, self);
        keys.key("psd", "PSD distance sensors.").list(PARTS, &mut self.psds);
        devices(keys, self);
    }
}

/// The keys of a companion in three parts, between which a robot type has some more: mass and traction.
pub(crate) fn body(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    let mut body = Body { mass: robi.mass, traction: robi.traction };
    keys.key("body", "Mass and traction.").always(PART, &mut body);
    Body { mass: robi.mass, traction: robi.traction } = body;
}

/// What devices sit on, and what it stands on.
pub(crate) fn frame(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    keys.key("surface", "How the body reflects.").unless(Surface::default(), PART, &mut robi.surface);
    keys.key("link", "Links: parts that sensors sit on.").list(Links, &mut robi.links);
    legs(keys, robi);
}

/// Its devices but for the PSDs.
pub(crate) fn devices(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    ranges(keys, &mut robi.ranges);
    keys.key("camera", "The camera.").maybe(PART, &mut robi.camera);
    keys.key("lidar", "The laser scanner.").maybe(PART, &mut robi.lidar);
    keys.key("infrared", "Infrared switches.").list(PARTS, &mut robi.infrareds);
    keys.key("bumper", "Bumpers.").list(PARTS, &mut robi.bumpers);
    keys.key("servo", "Servos.").list(PARTS, &mut robi.servos);
    keys.key("compass", "The compass.").maybe(PART, &mut robi.compass);
    keys.key("lcd", "The colour display of RoBIOS-7.").unless(LcdSpec::default(), PART, &mut robi.lcd);
    keys.key("input", "What inputs read that nothing simulated drives.").unless(
        Default::default(),
        PART,
        &mut robi.inputs,
    );
    keys.key("serial", "What is connected to serial interfaces 1 to 16.").list(Serials, &mut robi.serials);
    keys.key("hdt", "Numbers under which programs ask for devices.").list(Hdt, &mut robi.hdt);
}

/// Mass and traction of a robot.
#[derive(Clone)]
struct Body {
    mass: f64,
    traction: f64,
}

impl Form for Body {
    const NAME: &'static str = "BodyForm";
    const ABOUT: &'static str = "Mass and traction of a robot.";

    fn usual() -> Self {
        Self { mass: 0.0, traction: 0.0 }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.key("mass_kg", "Mass in kg; 1 if left out.").always(Bounded(Quantity::mass("mass")), &mut self.mass);
        keys.key("traction", "Coefficient of friction between wheels and floor; 0.6 if left out.")
            .always(Bounded(Quantity::number("traction", 0.0, 100.0)), &mut self.traction);
    }
}

impl Form for WheelSpec {
    const NAME: &'static str = "WheelForm";
    const ABOUT: &'static str = "The wheels.";

    fn usual() -> Self {
        RobiSpec::usual().wheel
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.key("diameter_mm", "Diameter in mm; 50 if left out.")
            .always(Quantity::size("wheel diameter"), &mut self.diameter);
        keys.key("max_rate_deg_per_s", "Largest turning rate in degrees/s; 3600 if left out.")
            .always(Quantity::rate("largest rate"), &mut self.max_rate);
        keys.key("ticks_per_turn", "Encoder ticks per turn; 1000 if left out.")
            .always(Quantity::number("encoder ticks", 1e-3, 1e9), &mut self.ticks_per_turn);
        keys.key("track_mm", "Distance between left and right wheels in mm; 90 if left out.")
            .always(Quantity::size("track"), &mut self.track);
    }
}

/// The drive of a robot type, with what its usual wheelbase depends on.
#[derive(Clone)]
struct Drive {
    spec: DriveSpec,
    diameter: f64,
    track: f64,
}

impl Drive {
    fn usual_wheelbase(&self) -> f64 {
        usual_wheelbase(self.spec.kind, self.diameter, self.track)
    }
}

impl Form for Drive {
    const NAME: &'static str = "DriveForm";
    const ABOUT: &'static str = "The drive.";

    fn usual() -> Self {
        let RobiSpec { drive, diameter, wheel, .. } = RobiSpec::usual();
        Self { spec: drive, diameter, track: wheel.track }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.key("kind", "Its kind; differential if left out.").always(Word, &mut self.spec.kind);
        let wheelbase = self.usual_wheelbase();
        let drive = &mut self.spec;
        let mut steering = drive.steering.take().map(|text| PathRef { text, ..PathRef::default() });
        if keys.reading().is_some() {
            (drive.motors, drive.steering) = drive_devices(drive.kind);
            drive.wheelbase = wheelbase;
        }
        keys.key(
            "motor",
            "Motors: left, right; of a car one; of an omni drive front left, front right, back left, back right.",
        )
        .items(Motors(drive.motors.len()), &mut drive.motors);
        keys.key("steering", "The servo that steers a car.").maybe(TEXT, &mut steering);
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
        drive_keys(keys, drive, wheelbase);
    }
}

/// What a drive has besides its kind and its devices; `wheelbase` is the usual one.
pub(crate) fn drive_keys(keys: &mut Keys<'_>, drive: &mut DriveSpec, wheelbase: f64) {
    keys.key(
        "wheelbase_mm",
        "Distance between front and rear wheels in mm; of a car 0.6 of the diameter if left out, else the track.",
    )
    .unless(wheelbase, Quantity::size("wheelbase"), &mut drive.wheelbase);
    let steer = Quantity::angle("largest steering angle").within(0.1, 85.0);
    keys.key("max_steer_deg", "Steering angle at the servo's ends in degrees; 45 if left out.")
        .always(Bounded(steer), &mut drive.max_steer);
    keys.key("wheel_lag_ms", "Time constant between a wheel's command and its speed in ms; 0 if left out.").unless(
        0.0,
        Bounded(Quantity::milliseconds("lag of the wheels")),
        &mut drive.wheel_lag,
    );
}

impl Words for DriveKind {
    const NAME: &'static str = "DriveKindForm";
    const ABOUT: &'static str = "Kinds of drives.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (DriveKind::Differential, "differential", "Two wheels."),
        (DriveKind::Ackermann, "ackermann", "A car."),
        (DriveKind::Omni, "omni", "Four Mecanum wheels."),
        (DriveKind::Legged, "legged", "Legs."),
    ];
}

impl Form for MotorSpec {
    const NAME: &'static str = "MotorForm";
    const ABOUT: &'static str = "A motor with its encoder.";

    fn usual() -> Self {
        Self::default()
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.key("name", "Its name, such as `MOTOR_LEFT`.").required(TEXT, &mut self.motor);
        keys.key("encoder", "The name of its encoder, such as `QUAD_LEFT`.").maybe(TEXT, &mut self.encoder);
    }
}

/// As many motors as the drive has.
struct Motors(usize);

impl Kind<Vec<MotorSpec>> for Motors {
    fn read(&self, at: At<'_, '_>, _: Option<&Vec<MotorSpec>>) -> Option<Vec<MotorSpec>> {
        let At { reader, section, key } = at;
        let sections = reader.sections(section, key);
        let (count, expected) = (sections.len(), self.0);
        let motors: Vec<MotorSpec> =
            sections.into_iter().filter_map(|section| reader.form(section, MotorSpec::usual())).collect();
        if count != 0 && count != expected {
            let message = format!("the drive has {count} of {expected} motors");
            let span = reader.key_span(section, key);
            reader.sink.error(Code::RobiDriveArity, span, message, format!("{expected} motors"));
        }
        Some(motors).filter(|motors| motors.len() == expected)
    }

    fn print(&self, motors: &Vec<MotorSpec>) -> Value {
        PARTS.print(motors)
    }

    fn describe(&self, generator: &mut SchemaGenerator) -> Json {
        Kind::<Vec<MotorSpec>>::describe(&PARTS, generator)
    }
}

/// Links, of which no robot has too many.
struct Links;

impl Kind<Vec<LinkSpec>> for Links {
    fn read(&self, at: At<'_, '_>, _: Option<&Vec<LinkSpec>>) -> Option<Vec<LinkSpec>> {
        let At { reader, section, key } = at;
        let sections = reader.sections(section, key);
        if sections.len() > MAX_LINKS {
            let message = format!("the robot has {} links", sections.len());
            let span = reader.key_span(section, key);
            reader.sink.error(Code::NumberRange, span, message, format!("at most {MAX_LINKS} links"));
            return None;
        }
        Some(sections.into_iter().filter_map(|section| reader.form(section, LinkSpec::usual())).collect())
    }

    fn print(&self, links: &Vec<LinkSpec>) -> Value {
        PARTS.print(links)
    }

    fn describe(&self, generator: &mut SchemaGenerator) -> Json {
        Kind::<Vec<LinkSpec>>::describe(&PARTS, generator)
    }
}
