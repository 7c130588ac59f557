//! The companion of a robi: a TOML file beside it, for what the classic format cannot say.

use std::f64::consts::TAU;
use std::ops::Range;

use glam::DVec3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Span;
use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::line::{self, Quantity};
use super::robi::{LIDAR_SWEEP, LIDAR_TILT, MAX_LIDAR_POINTS};
use super::spec::{BumperSpec, CompassSpec, InfraredSpec, LidarSpec, RobiSpec, ServoSpec};

/// Distance below which an infrared switch answers when the file does not say, in metres.
const DEFAULT_INFRARED_RANGE: f64 = 0.1;
/// Servo angles at positions 0 and 255 when the file does not say, in radians: a half turn in all.
const DEFAULT_SERVO: [f64; 2] = [-TAU / 4.0, TAU / 4.0];

/// Reads the companion `text` of a robi into `robi`, on top of what the robi itself says.
///
/// `file` is the companion's name. Unknown keys are warned about; a value of the wrong type or out of range is an error and
/// leaves the default.
pub fn read_companion(file: &str, text: &str, robi: &mut RobiSpec) -> Vec<Diagnostic> {
    let whole = text.len();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = Reader { sink: Sink::new(file), starts: line_starts(text), offset: whole - text.len(), text };
    let (root, errors) = DeTable::parse_recoverable(text);
    for error in errors {
        let span = reader.span(error.span().unwrap_or(0..0));
        reader.sink.error(
            Code::TomlSyntax,
            span,
            error.message().trim(),
            "TOML: `key = value` lines and `[section]` lines",
        );
    }
    reader.root(root.get_ref(), robi);
    reader.sink.finish()
}

/// Byte at which each line begins.
fn line_starts(text: &str) -> Vec<usize> {
    std::iter::once(0).chain(text.match_indices('\n').map(|(place, _)| place + 1)).collect()
}

struct Reader<'t> {
    sink: Sink,
    /// The text without byte order mark.
    text: &'t str,
    /// Length of the byte order mark.
    offset: usize,
    starts: Vec<usize>,
}

/// A table and the keys of it that have been asked for.
struct Section<'a, 'i> {
    name: &'static str,
    table: &'a DeTable<'i>,
    span: Span,
    known: Vec<&'static str>,
}

impl<'a, 'i> Section<'a, 'i> {
    fn get(&mut self, key: &'static str) -> Option<&'a Spanned<DeValue<'i>>> {
        self.known.push(key);
        self.table.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value)
    }
}

impl Reader<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        let mut start = range.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = self.starts.partition_point(|begin| *begin <= start).max(1);
        let column = self.text[self.starts[line - 1]..start].chars().count() + 1;
        let end = range.end.clamp(start, self.text.len());
        Span { start: self.offset + start, end: self.offset + end, line: line as u32, column: column as u32 }
    }

    fn root(&mut self, table: &DeTable<'_>, robi: &mut RobiSpec) {
        let mut root = Section { name: "", table, span: Span::default(), known: Vec::new() };
        if let Some(section) = self.section(&mut root, "body") {
            self.body(section, robi);
        }
        if let Some(section) = self.section(&mut root, "drive") {
            self.drive(section, robi);
        }
        if let Some(section) = self.section(&mut root, "psd") {
            self.psd(section, robi);
        }
        if let Some(section) = self.section(&mut root, "lidar") {
            self.lidar(section, robi);
        }
        for section in self.sections(&mut root, "infrared") {
            robi.infrareds.extend(self.infrared(section));
        }
        for section in self.sections(&mut root, "bumper") {
            robi.bumpers.extend(self.bumper(section));
        }
        for section in self.sections(&mut root, "servo") {
            robi.servos.extend(self.servo(section));
        }
        if let Some(section) = self.section(&mut root, "compass") {
            robi.compass = Some(self.compass(section));
        }
        if let Some(section) = self.section(&mut root, "input") {
            self.input(section, robi);
        }
        if let Some(section) = self.section(&mut root, "hdt") {
            self.hdt(section, robi);
        }
        self.unknown_keys(&root);
        self.doubles(robi);
    }

    fn body(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        self.set(&mut section, "mass_kg", &Quantity::mass("mass"), &mut robi.mass);
        self.set(&mut section, "traction", &Quantity::number("traction", 0.0, 100.0), &mut robi.traction);
        self.unknown_keys(&section);
    }

    /// The scanner that a classic robi cannot name, or changes to that of the robi.
    fn lidar(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let lidar = robi.lidar.get_or_insert(LidarSpec { points: 360, tilt: 0.0, sweep: TAU, span: section.span });
        self.set(&mut section, "tilt_deg", &LIDAR_TILT, &mut lidar.tilt);
        self.set(&mut section, "sweep_deg", &LIDAR_SWEEP, &mut lidar.sweep);
        if let Some(points) = self.integer(&mut section, "points", 1, i64::from(MAX_LIDAR_POINTS)) {
            lidar.points = points as u32;
        }
        self.unknown_keys(&section);
    }

    fn drive(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let drive = &mut robi.drive;
        self.set(&mut section, "wheelbase_mm", &Quantity::size("wheelbase"), &mut drive.wheelbase);
        let steer = Quantity::angle("largest steering angle").within(0.1, 85.0);
        self.set(&mut section, "max_steer_deg", &steer, &mut drive.max_steer);
        self.set(&mut section, "wheel_lag_ms", &Quantity::milliseconds("lag of the wheels"), &mut drive.wheel_lag);
        self.unknown_keys(&section);
    }

    /// `range_mm` for all sensors, and a table for each that differs.
    fn psd(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let quantity = Quantity::size("range of the PSDs");
        if let Some(range) = self.number(&mut section, "range_mm", &quantity) {
            robi.psds.iter_mut().for_each(|psd| psd.range = range);
        }
        for (key, value) in section.table {
            if key.get_ref() == "range_mm" {
                continue;
            }
            let span = self.span(key.span());
            let Some(psd) = robi.psds.iter_mut().find(|psd| psd.name == key.get_ref().as_ref()) else {
                let names = robi.psds.iter().map(|psd| psd.name.as_str()).chain(["range_mm"]).collect::<Vec<_>>();
                let message = format!("`{}` is neither a PSD of the robi nor `range_mm`", key.get_ref());
                let expected = format!("one of {}", names.join(", "));
                let suggestion = line::nearest(key.get_ref(), names).map(|name| format!("write `{name}`"));
                self.sink.warn(Code::TomlKey, span, message, expected).suggestion = suggestion;
                continue;
            };
            if let Some(mut section) = self.as_section("psd", value) {
                self.set(&mut section, "range_mm", &quantity, &mut psd.range);
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

    fn input(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        let inputs = &mut robi.inputs;
        if let Some(channels) = self.section(&mut section, "analog") {
            let values = self.numbered(&channels, 15, 1023, "A/D channel");
            inputs.analog.extend(values);
        }
        if let Some(latches) = self.section(&mut section, "latch") {
            let values = self.numbered(&latches, 255, 255, "latch");
            inputs.latches.extend(values.into_iter().map(|(number, value)| (number, value as u8)));
        }
        for (key, register) in
            [("parallel_data", &mut inputs.parallel_data), ("parallel_status", &mut inputs.parallel_status)]
        {
            if let Some(value) = self.integer(&mut section, key, 0, 255) {
                *register = value as u8;
            }
        }
        self.unknown_keys(&section);
        inputs.analog.sort_unstable();
        inputs.latches.sort_unstable();
    }

    /// A table whose keys are numbers: `3 = 512`.
    fn numbered(&mut self, section: &Section<'_, '_>, highest: u8, largest: u16, what: &str) -> Vec<(u8, u16)> {
        let mut values = Vec::new();
        for (key, value) in section.table {
            let Some(number) = key.get_ref().parse::<u8>().ok().filter(|number| *number <= highest) else {
                let message = format!("`{}` is no {what}", key.get_ref());
                self.sink.error(Code::TomlKey, self.span(key.span()), message, format!("a number from 0 to {highest}"));
                continue;
            };
            if let Some(value) = self.as_integer(key.get_ref(), value, 0, i64::from(largest)) {
                values.push((number, value as u16));
            }
        }
        values
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
    fn doubles(&mut self, robi: &RobiSpec) {
        let infrareds = robi.infrareds.iter().map(|device| ("infrared", &device.name, device.id, device.span));
        let bumpers = robi.bumpers.iter().map(|device| ("bumper", &device.name, device.id, device.span));
        let servos = robi.servos.iter().map(|device| ("servo", &device.name, device.id, device.span));
        let mut seen: Vec<(&str, &String, Option<i32>)> = Vec::new();
        for (kind, name, id, span) in infrareds.chain(bumpers).chain(servos) {
            let is_same =
                |old: &&(&str, &String, Option<i32>)| old.0 == kind && (old.1 == name || id.is_some() && old.2 == id);
            if seen.iter().any(|old| is_same(&old)) {
                let message = format!("the name or number of {kind} `{name}` was already given");
                self.sink.warn(Code::RobiDeviceTwice, span, message, "each name and each number once");
            }
            seen.push((kind, name, id));
        }
    }

    fn device(&mut self, section: &mut Section<'_, '_>) -> (Option<String>, Option<i32>) {
        let name = self.text(section, "name");
        if name.is_none() && !section.table.iter().any(|(key, _)| key.get_ref() == "name") {
            self.missing(section, "name");
        }
        (name, self.id(section))
    }

    fn id(&mut self, section: &mut Section<'_, '_>) -> Option<i32> {
        self.integer(section, "id", i64::from(i32::MIN), i64::from(i32::MAX)).map(|id| id as i32)
    }

    fn missing(&mut self, section: &Section<'_, '_>, key: &str) {
        let message = format!("`{}` has no `{key}`", section.name);
        self.sink.error(Code::TomlMissing, section.span, message, format!("a line `{key} = ...`"));
    }

    fn required(&mut self, section: &mut Section<'_, '_>, key: &'static str, quantity: &Quantity) -> Option<f64> {
        if !section.table.iter().any(|(name, _)| name.get_ref() == key) {
            section.known.push(key);
            self.missing(section, key);
            return None;
        }
        self.number(section, key, quantity)
    }

    fn set(&mut self, section: &mut Section<'_, '_>, key: &'static str, quantity: &Quantity, place: &mut f64) {
        if let Some(value) = self.number(section, key, quantity) {
            *place = value;
        }
    }

    fn number(&mut self, section: &mut Section<'_, '_>, key: &'static str, quantity: &Quantity) -> Option<f64> {
        let value = section.get(key)?;
        let span = self.span(value.span());
        let Some(number) = float(value.get_ref()) else {
            self.wrong_type(key, value, &quantity.expected());
            return None;
        };
        let checked = quantity.check(number);
        if checked.is_none() {
            let message = format!("{} `{number}` is out of range", quantity.name);
            self.sink.error(Code::NumberRange, span, message, quantity.expected());
        }
        checked
    }

    fn integer(&mut self, section: &mut Section<'_, '_>, key: &'static str, low: i64, high: i64) -> Option<i64> {
        let value = section.get(key)?;
        self.as_integer(key, value, low, high)
    }

    fn as_integer(&mut self, key: &str, value: &Spanned<DeValue<'_>>, low: i64, high: i64) -> Option<i64> {
        let expected = format!("an integer from {low} to {high}");
        let DeValue::Integer(digits) = value.get_ref() else {
            self.wrong_type(key, value, &expected);
            return None;
        };
        let number = i64::from_str_radix(digits.as_str(), digits.radix()).ok();
        let number = number.filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let message = format!("{key} `{digits}` is out of range");
            self.sink.error(Code::NumberRange, self.span(value.span()), message, expected);
        }
        number
    }

    fn text(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> Option<String> {
        let value = section.get(key)?;
        let text = value.get_ref().as_str().filter(|text| !text.is_empty());
        if text.is_none() {
            self.wrong_type(key, value, "a text that is not empty, between double quotes");
        }
        text.map(str::to_owned)
    }

    fn section<'a, 'i>(&mut self, parent: &mut Section<'a, 'i>, key: &'static str) -> Option<Section<'a, 'i>> {
        let value = parent.get(key)?;
        self.as_section(key, value)
    }

    fn as_section<'a, 'i>(&mut self, key: &'static str, value: &'a Spanned<DeValue<'i>>) -> Option<Section<'a, 'i>> {
        let span = self.span(value.span());
        match value.get_ref() {
            DeValue::Table(table) => Some(Section { name: key, table, span, known: Vec::new() }),
            _ => {
                self.wrong_type(key, value, "a table");
                None
            }
        }
    }

    /// The tables of an array `[[key]]`; a single `[key]` counts as one.
    fn sections<'a, 'i>(&mut self, parent: &mut Section<'a, 'i>, key: &'static str) -> Vec<Section<'a, 'i>> {
        let Some(value) = parent.get(key) else {
            return Vec::new();
        };
        match value.get_ref() {
            DeValue::Array(items) => items.iter().filter_map(|item| self.as_section(key, item)).collect(),
            _ => self.as_section(key, value).into_iter().collect(),
        }
    }

    fn wrong_type(&mut self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let message = format!("`{key}` is of type {}", value.get_ref().type_str());
        self.sink.error(Code::TomlType, self.span(value.span()), message, expected);
    }

    fn unknown_keys(&mut self, section: &Section<'_, '_>) {
        for (key, _) in section.table {
            let name = key.get_ref().as_ref();
            if section.known.contains(&name) {
                continue;
            }
            let place = if section.name.is_empty() { String::new() } else { format!(" in `{}`", section.name) };
            let message = format!("unknown key `{name}`{place}");
            let expected = format!("one of {}", section.known.join(", "));
            let suggestion = line::nearest(name, section.known.iter().copied()).map(|key| format!("write `{key}`"));
            self.sink.warn(Code::TomlKey, self.span(key.span()), message, expected).suggestion = suggestion;
        }
    }
}

fn float(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(digits) => {
            i64::from_str_radix(digits.as_str(), digits.radix()).ok().map(|number| number as f64)
        }
        DeValue::Float(digits) => digits.as_str().parse().ok(),
        _ => None,
    }
}
