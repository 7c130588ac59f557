//! The companion of a robi: a TOML file beside it, for what the classic format cannot say.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use glam::DVec3;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::Span;
use super::code::Code;
use super::diagnostic::Diagnostic;
use super::given::Given;
use super::line::{self, Quantity};
use super::range::{PITCH, model_name};
use super::robi::{LIDAR_SWEEP, LIDAR_TILT, MAX_LIDAR_POINTS};
use super::spec::{
    BumperSpec, CompassSpec, InfraredSpec, LIDAR, LidarSpec, RobiSpec, SerialLine, SerialSpec, ServoSpec,
};
use super::table::{Reader, Section};

/// Distance below which an infrared switch answers when the file does not say, in metres.
const DEFAULT_INFRARED_RANGE: f64 = 0.1;
/// Servo angles at positions 0 and 255 when the file does not say, in radians: a half turn in all.
const DEFAULT_SERVO: [f64; 2] = [-TAU / 4.0, TAU / 4.0];
/// Fewest pixels of the display in either direction: a menu with some text above it.
const MIN_LCD_SIDE: i64 = 64;
/// Most pixels of the display in a row.
const MAX_LCD_WIDTH: i64 = 1920;
/// Most rows of pixels of the display.
const MAX_LCD_HEIGHT: i64 = 1200;
/// Digital lines, and serial interfaces, numbered from 1.
const LINES: u8 = 16;
/// Greatest voltage of a battery.
const MAX_VOLTAGE: f64 = 1000.0;
/// Names that a message lists at most.
const MAX_LISTED: usize = 32;

/// Reads the companion `text` of a robi into `robi`, on top of what the robi itself says.
///
/// `file` is the companion's name. Unknown keys are warned about; a value of the wrong type or out of range is an error and
/// leaves the default.
pub fn read_companion(file: &str, text: &str, robi: &mut RobiSpec) -> Vec<Diagnostic> {
    let (mut reader, root) = Reader::parse(file, text);
    reader.companion(&root, robi);
    reader.sink.finish()
}

impl Reader<'_> {
    fn companion(&mut self, table: &DeTable<'_>, robi: &mut RobiSpec) {
        let mut root = Section::root(table);
        if let Some(section) = self.section(&mut root, "drive") {
            self.drive(section, robi);
        }
        if let Some(section) = self.section(&mut root, "psd") {
            self.psd(section, robi);
        }
        self.devices(&mut root, robi);
        self.unknown_keys(&root);
        self.settle_devices(robi);
    }

    /// What a companion says in the same words as a scene that describes the type in place.
    pub(super) fn devices(&mut self, parent: &mut Section<'_, '_>, robi: &mut RobiSpec) {
        if let Some(section) = self.section(parent, "body") {
            self.body(section, robi);
        }
        if let Some(section) = self.section(parent, "surface") {
            robi.surface = self.surface(section);
        }
        self.links(parent, robi);
        self.legs(parent, robi);
        self.ranges(parent, robi);
        if let Some(section) = self.section(parent, "camera") {
            self.camera(section, robi);
        }
        if let Some(section) = self.section(parent, "lidar") {
            self.lidar(section, robi);
        }
        for section in self.sections(parent, "infrared") {
            robi.infrareds.extend(self.infrared(section));
        }
        for section in self.sections(parent, "bumper") {
            robi.bumpers.extend(self.bumper(section));
        }
        for section in self.sections(parent, "servo") {
            robi.servos.extend(self.servo(section));
        }
        if let Some(section) = self.section(parent, "compass") {
            robi.compass = Some(self.compass(section));
        }
        if let Some(section) = self.section(parent, "lcd") {
            self.lcd(section, robi);
        }
        if let Some(section) = self.section(parent, "input") {
            self.input(section, robi);
        }
        if let Some(section) = self.section(parent, "serial") {
            self.serial(&section, robi);
        }
        if let Some(section) = self.section(parent, "hdt") {
            self.hdt(section, robi);
        }
    }

    fn body(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        self.set(&mut section, "mass_kg", &Quantity::mass("mass"), &mut robi.mass);
        self.set(&mut section, "traction", &Quantity::number("traction", 0.0, 100.0), &mut robi.traction);
        self.unknown_keys(&section);
    }

    /// The scanner that a classic robi cannot name, or changes to that of the robi.
    fn lidar(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let lidar = robi.lidar.get_or_insert(LidarSpec::new(section.span));
        self.mount(&mut section, &mut lidar.mount);
        self.set(&mut section, "range_mm", &Quantity::size("range of the scanner"), &mut lidar.range);
        self.set(&mut section, "tilt_deg", &LIDAR_TILT, &mut lidar.tilt);
        self.set(&mut section, "sweep_deg", &LIDAR_SWEEP, &mut lidar.sweep);
        if let Some(points) = self.integer(&mut section, "points", 1, i64::from(MAX_LIDAR_POINTS)) {
            lidar.points = points as u32;
        }
        self.unknown_keys(&section);
    }

    fn drive(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        self.drive_keys(&mut section, robi);
        self.unknown_keys(&section);
    }

    /// What the drive has besides its kind and its devices.
    pub(super) fn drive_keys(&mut self, section: &mut Section<'_, '_>, robi: &mut RobiSpec) {
        let drive = &mut robi.drive;
        self.set(section, "wheelbase_mm", &Quantity::size("wheelbase"), &mut drive.wheelbase);
        let steer = Quantity::angle("largest steering angle").within(0.1, 85.0);
        self.set(section, "max_steer_deg", &steer, &mut drive.max_steer);
        self.set(section, "wheel_lag_ms", &Quantity::milliseconds("lag of the wheels"), &mut drive.wheel_lag);
    }

    /// `range_mm` for all sensors, and a table for each that differs.
    fn psd(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let quantity = Quantity::size("range of the PSDs");
        if let Some(range) = self.number(&mut section, "range_mm", &quantity) {
            robi.psds.iter_mut().for_each(|psd| psd.range = range);
        }
        let names: Vec<String> = robi.psds.iter().map(|psd| psd.name.clone()).collect();
        let places: BTreeMap<&str, usize> = names.iter().map(String::as_str).zip(0..).collect();
        let names = || names.iter().map(String::as_str).take(MAX_LISTED).chain(["range_mm"]);
        for (key, value) in section.table {
            if key.get_ref() == "range_mm" {
                continue;
            }
            let span = self.span(key.span());
            let Some(psd) = places.get(key.get_ref().as_ref()).and_then(|place| robi.psds.get_mut(*place)) else {
                let message = format!("`{}` is neither a PSD of the robi nor `range_mm`", key.get_ref());
                let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
                let suggestion = line::nearest(key.get_ref(), names()).map(|name| format!("write `{name}`"));
                self.sink.warn(Code::TomlKey, span, message, expected).suggestion = suggestion;
                continue;
            };
            if !matches!(value.get_ref(), DeValue::Table(_)) {
                self.wrong_type(key.get_ref(), value, "a table");
            } else if let Some(mut section) = self.as_section("psd", value) {
                self.set(&mut section, "range_mm", &quantity, &mut psd.range);
                self.set(&mut section, "pitch_deg", &PITCH, &mut psd.pitch);
                psd.on = self.on(&mut section).or(psd.on.take());
                self.unknown_keys(&section);
            }
        }
    }

    fn infrared(&mut self, mut section: Section<'_, '_>) -> Option<InfraredSpec> {
        let (name, id) = self.device(&mut section);
        let coordinate = Quantity::coordinate("coordinate of the sensor");
        let [mut x, mut y, mut z, mut angle, mut range] = [0.0, 0.0, 0.0, 0.0, DEFAULT_INFRARED_RANGE];
        self.set(&mut section, "x_mm", &coordinate, &mut x);
        self.set(&mut section, "y_mm", &coordinate, &mut y);
        self.set(&mut section, "z_mm", &coordinate, &mut z);
        self.set(&mut section, "angle_deg", &Quantity::angle("angle of the sensor"), &mut angle);
        self.set(&mut section, "range_mm", &Quantity::size("range of the sensor"), &mut range);
        self.unknown_keys(&section);
        Some(InfraredSpec { name: name?, id, position: DVec3::new(x, y, z), angle, range, span: section.span })
    }

    fn bumper(&mut self, mut section: Section<'_, '_>) -> Option<BumperSpec> {
        let (name, id) = self.device(&mut section);
        let angle = Quantity::angle("end of the bumper").within(-360.0, 360.0);
        let ends = [self.required(&mut section, "from_deg", &angle), self.required(&mut section, "to_deg", &angle)];
        self.unknown_keys(&section);
        let [Some(from), Some(mut to)] = ends else {
            return None;
        };
        while to <= from {
            to += TAU;
        }
        while to > from + TAU {
            to -= TAU;
        }
        Some(BumperSpec { name: name?, id, from, to, span: section.span })
    }

    fn servo(&mut self, mut section: Section<'_, '_>) -> Option<ServoSpec> {
        let (name, id) = self.device(&mut section);
        let [mut from, mut to] = DEFAULT_SERVO;
        let angle = Quantity::angle("end of the servo").within(-360.0, 360.0);
        self.set(&mut section, "from_deg", &angle, &mut from);
        self.set(&mut section, "to_deg", &angle, &mut to);
        self.unknown_keys(&section);
        Some(ServoSpec { name: name?, id, from, to, span: section.span })
    }

    fn compass(&mut self, mut section: Section<'_, '_>) -> CompassSpec {
        let name = self.text(&mut section, "name").unwrap_or_else(|| "COMPASS".to_owned());
        let id = self.id(&mut section);
        let mut north = 0.0;
        self.set(&mut section, "north_deg", &Quantity::angle("north"), &mut north);
        self.unknown_keys(&section);
        CompassSpec { name, id, north, span: section.span }
    }

    fn lcd(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let lcd = &mut robi.lcd;
        for (key, most, pixels) in
            [("width_px", MAX_LCD_WIDTH, &mut lcd.width), ("height_px", MAX_LCD_HEIGHT, &mut lcd.height)]
        {
            if let Some(value) = self.integer(&mut section, key, MIN_LCD_SIDE, most) {
                *pixels = value as u16;
            }
        }
        self.unknown_keys(&section);
    }

    fn input(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let inputs = &mut robi.inputs;
        if let Some(channels) = self.section(&mut section, "analog") {
            let values = self.numbered(&channels, 0..=15, 1023, "A/D channel");
            inputs.analog.extend(values);
        }
        if let Some(latches) = self.section(&mut section, "latch") {
            let values = self.numbered(&latches, 0..=255, 255, "latch");
            inputs.latches.extend(values.into_iter().map(|(number, value)| (number, value as u8)));
        }
        if let Some(lines) = self.section(&mut section, "digital") {
            let values = self.numbered(&lines, 1..=LINES, 1, "digital line");
            inputs.digital.extend(values.into_iter().map(|(number, value)| (number, value as u8)));
        }
        let voltage = Quantity::number("voltage of the battery", 0.0, MAX_VOLTAGE);
        self.set(&mut section, "voltage_v", &voltage, &mut inputs.voltage);
        for (key, register) in [
            ("microphone", &mut inputs.microphone),
            ("parallel_data", &mut inputs.parallel_data),
            ("parallel_status", &mut inputs.parallel_status),
        ] {
            if let Some(value) = self.integer(&mut section, key, 0, 255) {
                *register = value as u8;
            }
        }
        self.unknown_keys(&section);
        inputs.analog.sort_unstable();
        inputs.latches.sort_unstable();
        inputs.digital.sort_unstable();
    }

    /// What is connected to the serial interfaces: `1 = "loopback"`, `2 = { file = "gps.txt" }`.
    fn serial(&mut self, section: &Section<'_, '_>, robi: &mut RobiSpec) {
        for (key, value) in section.table {
            let Some(interface) = self.number_of(key, 1..=LINES, "serial interface") else { continue };
            let line = match value.get_ref() {
                DeValue::String(word) if word == "loopback" => Some(SerialLine::Loopback),
                DeValue::Table(_) => self.as_section("serial", value).and_then(|section| self.serial_file(section)),
                _ => {
                    self.wrong_type(key.get_ref(), value, "`\"loopback\"` or `{ file = \"NAME\" }`");
                    None
                }
            };
            robi.serials.extend(line.map(|line| SerialSpec { interface, line }));
        }
        robi.serials.sort_by_key(|serial| serial.interface);
    }

    fn serial_file(&mut self, mut section: Section<'_, '_>) -> Option<SerialLine> {
        let path = self.required_reference(&mut section, "file");
        self.unknown_keys(&section);
        Some(SerialLine::File { path: path?, bytes: Arc::default() })
    }

    /// A table whose keys are numbers: `3 = 512`.
    fn numbered(
        &mut self,
        section: &Section<'_, '_>,
        numbers: RangeInclusive<u8>,
        largest: u16,
        what: &str,
    ) -> Vec<(u8, u16)> {
        let mut values = Vec::new();
        for (key, value) in section.table {
            let Some(number) = self.number_of(key, numbers.clone(), what) else { continue };
            if let Some(value) = self.as_integer(key.get_ref(), value, 0, i64::from(largest)) {
                values.push((number, value as u16));
            }
        }
        values
    }

    /// The number that a key is.
    fn number_of(&mut self, key: &Spanned<DeString<'_>>, numbers: RangeInclusive<u8>, what: &str) -> Option<u8> {
        let number = key.get_ref().parse().ok().filter(|number| numbers.contains(number));
        if number.is_none() {
            let message = format!("`{}` is no {what}", key.get_ref());
            let expected = format!("a number from {} to {}", numbers.start(), numbers.end());
            self.sink.error(Code::TomlKey, self.span(key.span()), message, expected);
        }
        number
    }

    fn hdt(&mut self, section: Section<'_, '_>, robi: &mut RobiSpec) {
        for (key, value) in section.table {
            if let Some(id) = self.as_integer(key.get_ref(), value, i64::from(i32::MIN), i64::from(i32::MAX)) {
                robi.hdt.push((key.get_ref().to_string(), id as i32));
            }
        }
        robi.hdt.sort();
    }

    /// Devices that a program could not tell apart.
    pub(super) fn doubles(&mut self, robi: &RobiSpec) {
        let psds = robi.psds.iter().map(|device| ("PSD", &*device.name, device.id, device.span));
        let ranges =
            robi.ranges.iter().map(|device| (model_name(&device.model), &*device.name, device.id, device.span));
        // Errors know a scanner, which has no name, by this one.
        let lidar = robi.lidar.iter().map(|lidar| ("lidar", LIDAR, None, lidar.span));
        self.doubles_of(lidar.chain(psds).chain(ranges));
        let infrareds = robi.infrareds.iter();
        self.doubles_of(infrareds.map(|device| ("infrared", &*device.name, device.id, device.span)));
        self.doubles_of(robi.bumpers.iter().map(|device| ("bumper", &*device.name, device.id, device.span)));
        self.doubles_of(robi.servos.iter().map(|device| ("servo", &*device.name, device.id, device.span)));
    }

    fn doubles_of<'d>(&mut self, devices: impl Iterator<Item = (&'static str, &'d str, Option<i32>, Span)>) {
        let mut given = Given::default();
        for (kind, name, id, span) in devices {
            if given.line_of(name, id).is_some() {
                let message = format!("the name or number of {kind} `{name}` was already given");
                self.sink.warn(Code::RobiDeviceTwice, span, message, "each name and each number once");
            }
            given.add(name, id, span.line);
        }
    }

    pub(super) fn device(&mut self, section: &mut Section<'_, '_>) -> (Option<String>, Option<i32>) {
        let name = self.text(section, "name");
        if name.is_none() && !section.has("name") {
            self.missing(section, "name");
        }
        (name, self.id(section))
    }

    fn id(&mut self, section: &mut Section<'_, '_>) -> Option<i32> {
        self.integer(section, "id", i64::from(i32::MIN), i64::from(i32::MAX)).map(|id| id as i32)
    }
}
