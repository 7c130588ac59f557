//! Devices of a robot other than distance sensors, and equipment connected to its inputs.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::sync::Arc;

use serde_json::{Value as Json, json};
use toml::de::DeValue;
use toml::{Spanned, Table, Value};

use super::kind::{Bounded, Custom, Integer, Kind, ReadContext, TABLE, TEXT, array_schema, integer_schema};
use super::sensor::{device_keys, number_key, position_keys};
use super::{Definitions, Form, Keys, definition};
use crate::code::Code;
use crate::line::Quantity;
use crate::print::number::shortest;
use crate::spec::{
    BumperSpec, CameraSpec, CompassSpec, DEFAULT_LENS, InfraredSpec, InputSpec, JointSpec, LcdSpec, Lens,
    MAX_FIELD_OF_VIEW_DEG, MAX_SAMPLES, SerialLine, SerialSpec, ServoSpec, SpannedText,
};
use crate::table::Reader;
use sim_core::unit::{degrees_from_radians, radians_from_degrees};

/// Default range within which an infrared switch responds, in metres.
const DEFAULT_INFRARED_RANGE: f64 = 0.1;
/// Minimum width and height of the display in pixels, which a menu with some text above it needs.
const MIN_LCD_SIDE: i64 = 64;
/// Maximum width of the display in pixels.
const MAX_LCD_WIDTH: i64 = 1920;
/// Maximum height of the display in pixels.
const MAX_LCD_HEIGHT: i64 = 1200;
/// Maximum width and height of an image in pixels.
const MAX_PIXELS: i64 = 65_536;
/// Number of digital lines, and of serial interfaces, numbered from 1.
const LINES: u8 = 16;
/// Maximum voltage of a battery.
const MAX_VOLTAGE: f64 = 1000.0;

impl Form for InfraredSpec {
    fn defaults() -> Self {
        Self { range: DEFAULT_INFRARED_RANGE, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("InfraredForm", "An infrared switch.");
        keys.span(&mut self.span);
        device_keys(keys, "Its name, such as `IR_LEFT`.", &mut self.name, &mut self.id);
        position_keys(keys, [Quantity::coordinate("coordinate of the sensor"); 3], &mut self.position);
        keys.key("angle_deg", "Direction in degrees, counter-clockwise from forward; default: 0.")
            .optional(Quantity::angle("angle of the sensor"), &mut self.angle);
        keys.key("range_mm", "Range in mm; default: 100.")
            .always_printed(Quantity::size("range of the sensor"), &mut self.range);
    }
}

impl Form for BumperSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ArcForm", "A bumper: an arc of the body.");
        keys.span(&mut self.span);
        device_keys(keys, "Its name, such as `BUMP_FRONT`.", &mut self.name, &mut self.id);
        keys.key("from_deg", "Angle at which the arc begins, in degrees counter-clockwise from forward.")
            .required(BUMPER_END, &mut self.from);
        keys.key("to_deg", "Angle at which the arc ends, counter-clockwise.").required(ArcEnd(self.from), &mut self.to);
    }
}

const BUMPER_END: Bounded = Bounded(Quantity::angle("end of the bumper").within(-360.0, 360.0));

/// End of an arc that begins at the angle in the field and runs counter-clockwise, by at most a full turn.
struct ArcEnd(f64);

impl ArcEnd {
    /// Adds or subtracts full turns until the end is after the begin by at most a full turn.
    fn normalised(&self, mut to: f64) -> f64 {
        while to <= self.0 {
            to += TAU;
        }
        while to > self.0 + TAU {
            to -= TAU;
        }
        to
    }
}

impl Kind<f64> for ArcEnd {
    fn read(&self, context: ReadContext<'_, '_>, old: Option<&f64>) -> Option<f64> {
        BUMPER_END.read(context, old).map(|to| self.normalised(to))
    }

    /// Prints an angle from -360 to 360 degrees that reads back as `end`.
    fn print(&self, end: &f64) -> Value {
        let reads_back = |degrees: f64| self.normalised(radians_from_degrees(degrees)) == *end;
        let approximate = degrees_from_radians(*end);
        let candidates = [approximate, approximate - 360.0].map(|approximate| shortest(approximate, reads_back));
        let valid = candidates.into_iter().find(|to| reads_back(*to) && (-360.0..=360.0).contains(to));
        valid.unwrap_or(if approximate > 360.0 { approximate - 360.0 } else { approximate }).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        BUMPER_END.describe(definitions)
    }
}

const SERVO_END: Bounded = Bounded(Quantity::angle("end of the servo").within(-360.0, 360.0));

impl Form for ServoSpec {
    /// A servo that turns by a quarter turn to either side.
    fn defaults() -> Self {
        Self { from: -TAU / 4.0, to: TAU / 4.0, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ServoForm", "A servo.");
        keys.span(&mut self.span);
        device_keys(keys, "Its name, such as `SERVO1`.", &mut self.name, &mut self.id);
        keys.key("from_deg", "Angle at position 0 in degrees; default: -90.").always_printed(SERVO_END, &mut self.from);
        keys.key("to_deg", "Angle at position 255 in degrees; default: 90.").always_printed(SERVO_END, &mut self.to);
    }
}

impl Form for CompassSpec {
    fn defaults() -> Self {
        Self { name: "COMPASS".to_owned(), ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("CompassForm", "The compass.");
        keys.span(&mut self.span);
        keys.key("name", "Its name; default: `COMPASS`.").always_printed(TEXT, &mut self.name);
        number_key(keys, &mut self.id);
        keys.key("north_deg", "Direction in the world in which it reads 0, in degrees; default: 0.")
            .optional(Quantity::angle("north"), &mut self.north);
    }
}

impl Form for LcdSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LcdForm", "The colour display of RoBIOS-7.");
        keys.key("width_px", "Pixels in a row; default: 480.")
            .always_printed(MIN_LCD_SIDE..=MAX_LCD_WIDTH, &mut self.width);
        keys.key("height_px", "Rows of pixels; default: 320.")
            .always_printed(MIN_LCD_SIDE..=MAX_LCD_HEIGHT, &mut self.height);
    }
}

impl Form for InputSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("InputForm", "Readings of inputs that no simulated device drives.");
        let (channels, latches, lines) = (
            Numbered { name: "A/D channel", numbers: 0..=15, max: 1023 },
            Numbered { name: "latch", numbers: 0..=255, max: 255 },
            Numbered { name: "digital line", numbers: 1..=LINES, max: 1 },
        );
        keys.key("analog", "A/D converter: values 0 to 1023 by channels 0 to 15.").list(channels, &mut self.analog);
        keys.key("latch", "Input latches: values 0 to 255 by numbers.").list(latches, &mut self.latches);
        keys.key("digital", "Digital lines: 0 or 1 by numbers 1 to 16.").list(lines, &mut self.digital);
        let voltage = Quantity::number("voltage of the battery", 0.0, MAX_VOLTAGE);
        keys.key("voltage_v", "Voltage of the battery; default: 7.2.").optional(voltage, &mut self.voltage);
        keys.key("microphone", "Reading of the microphone; default: 128.").optional(0..=255, &mut self.microphone);
        keys.key("parallel_data", "Data register of the parallel port; default: 0.")
            .optional(0..=255, &mut self.parallel_data);
        keys.key("parallel_status", "Status register of the parallel port; default: 0.")
            .optional(0..=255, &mut self.parallel_status);
        self.analog.sort_unstable();
        self.latches.sort_unstable();
        self.digital.sort_unstable();
    }
}

/// Table whose keys are numbers, such as `3 = 512`.
struct Numbered {
    /// Name of the numbered items in messages.
    name: &'static str,
    numbers: RangeInclusive<u8>,
    /// Maximum value.
    max: i64,
}

impl<T: Integer> Kind<Vec<(u8, T)>> for Numbered {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<(u8, T)>>) -> Option<Vec<(u8, T)>> {
        let mut values = Vec::new();
        for (key, value) in context.reader.section(context.section, context.key)?.table {
            let Some(number) = context.reader.number_of(key, &self.numbers, self.name) else { continue };
            let value = context.reader.as_integer(key.get_ref(), value, 0, self.max);
            values.extend(value.and_then(|value| Some((number, T::try_from(value).ok()?))));
        }
        Some(values)
    }

    fn print(&self, values: &Vec<(u8, T)>) -> Value {
        sorted_table(values.iter().map(|(number, value)| (number.to_string(), value.number().into())))
    }

    fn describe(&self, _: &mut Definitions) -> Json {
        json!({ "type": "object", "additionalProperties": integer_schema::<T>() })
    }
}

/// Table with its entries sorted by key.
pub(crate) fn sorted_table(entries: impl Iterator<Item = (String, Value)>) -> Value {
    Table::from_iter(entries.collect::<BTreeMap<String, Value>>()).into()
}

/// Devices connected to the serial interfaces: `1 = "loopback"`, `2 = { file = "gps.txt" }`.
pub(crate) const SERIALS: Custom<Vec<SerialSpec>> = Custom {
    read: |context| {
        let mut serials = Vec::new();
        for (key, value) in context.reader.section(context.section, context.key)?.table {
            let Some(interface) = context.reader.number_of(key, &(1..=LINES), "serial interface") else { continue };
            let line = context.reader.serial_line(key.get_ref(), value);
            serials.extend(line.map(|line| SerialSpec { interface, line }));
        }
        serials.sort_by_key(|serial| serial.interface);
        Some(serials)
    },
    print: |serials| {
        let line = |line: &SerialLine| match line {
            SerialLine::Loopback => "loopback".into(),
            SerialLine::File { path, .. } => Table::from_iter([("file".to_owned(), TEXT.print(path))]).into(),
        };
        sorted_table(serials.iter().map(|serial| (serial.interface.to_string(), line(&serial.line))))
    },
    describe: |definitions| {
        let word = definition(definitions, "SerialWord", |_| {
            let loopback =
                json!({ "description": "All sent bytes are received back.", "type": "string", "const": "loopback" });
            json!({ "description": "A device that needs no file.", "oneOf": [loopback] })
        });
        let line = definition(definitions, "SerialForm", |_| {
            let mut word = word;
            word["description"] = "A word.".into();
            let file = json!({
                "description": "A device that sends the bytes of a file.",
                "type": "object",
                "properties": { "file": { "description": "The file.", "type": "string" } },
                "required": ["file"],
            });
            json!({ "description": "Device at a serial interface.", "anyOf": [word, file] })
        });
        json!({ "type": "object", "additionalProperties": line })
    },
};

impl Reader {
    fn serial_line(&mut self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<SerialLine> {
        match value.get_ref() {
            DeValue::String(word) if word == "loopback" => Some(SerialLine::Loopback),
            DeValue::Table(_) => {
                let (section, mut path) = (self.as_section("serial", value)?, SpannedText::default());
                let is_complete = self.table(section, |keys| keys.key("file", "The file.").required(TEXT, &mut path));
                is_complete.then(|| SerialLine::File { path, bytes: Arc::default() })
            }
            _ => {
                self.wrong_type(key, value, "`\"loopback\"` or `{ file = \"NAME\" }`");
                None
            }
        }
    }
}

/// Numbers of devices by name, as in a hardware description table.
pub(crate) const HDT: Custom<Vec<(String, i32)>> = Custom {
    read: |context| {
        let mut entries = Vec::new();
        for (key, value) in context.reader.section(context.section, context.key)?.table {
            let id = context.reader.as_integer(key.get_ref(), value, i64::from(i32::MIN), i64::from(i32::MAX));
            entries.extend(id.map(|id| (key.get_ref().to_string(), id as i32)));
        }
        entries.sort();
        Some(entries)
    },
    print: |entries| sorted_table(entries.iter().map(|(name, id)| (name.clone(), (*id).into()))),
    describe: |_| json!({ "type": "object", "additionalProperties": integer_schema::<i32>() }),
};

const CAMERA_POSITION: [Quantity; 3] = [
    Quantity::coordinate("x of the camera"),
    Quantity::coordinate("y of the camera"),
    Quantity::coordinate("z of the camera"),
];
const FIELD_OF_VIEW: Quantity = Quantity::angle("field of view").within(1.0, MAX_FIELD_OF_VIEW_DEG);
const FISHEYE: Quantity = Quantity::angle("field of view").within(1.0, 360.0);

impl Form for CameraSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("CameraForm", "The camera.");
        keys.span(&mut self.span);
        position_keys(keys, CAMERA_POSITION, &mut self.position);
        let about = [
            "Turn about the vertical axis in degrees, counter-clockwise; default: 0.",
            "The servo that pans, instead of `pan_deg`.",
        ];
        joint_keys(keys, ["pan_deg", "pan_servo"], about, &mut self.pan);
        let about = ["Turn upwards in degrees; default: 0.", "The servo that tilts, instead of `tilt_deg`."];
        joint_keys(keys, ["tilt_deg", "tilt_servo"], about, &mut self.tilt);
        keys.key("image_px", "Size of the largest image: width and height in pixels.")
            .nullable(PIXELS, &mut self.image);
        lens_keys(keys, &mut self.lens);
        keys.key("samples", "Samples per side of a pixel, whose colours are averaged; default: 2.")
            .optional(1..=i64::from(MAX_SAMPLES), &mut self.samples);
    }
}

/// Declares the keys of a camera joint: a fixed angle, or a servo that turns the camera.
fn joint_keys(keys: &mut Keys<'_>, [angle, servo]: [&'static str; 2], about: [&'static str; 2], joint: &mut JointSpec) {
    let (mut fixed_angle, mut servo_joint) = match joint {
        _ if keys.reading().is_some() => (None, None),
        JointSpec::Fixed(angle) => (Some(*angle).filter(|angle| *angle != 0.0), None),
        JointSpec::Servo { .. } => (None, Some(joint.clone())),
    };
    keys.key(angle, about[0]).nullable(Quantity::angle("angle of the camera"), &mut fixed_angle);
    keys.key(servo, about[1]).nullable(TABLE, &mut servo_joint);
    if let Some((reader, section)) = keys.reading() {
        if section.get(servo).is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_))) {
            reader.exclude(section, servo, &[angle]);
        }
        servo_joint.or(fixed_angle.map(JointSpec::Fixed)).into_iter().for_each(|read| *joint = read);
    }
}

/// A joint with a servo.
impl Form for JointSpec {
    fn defaults() -> Self {
        Self::Servo { name: String::new(), from: 0.0, to: 0.0 }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("JointForm", "A servo that turns the camera.");
        let Self::Servo { name, from, to } = self else { return };
        keys.key("name", "Its name, such as `SERVO1`.").required(TEXT, name);
        keys.key("from_deg", "Angle at position 0 in degrees.").required(SERVO_END, from);
        keys.key("to_deg", "Angle at position 255 in degrees.").required(SERVO_END, to);
    }
}

fn lens_keys(keys: &mut Keys<'_>, lens: &mut Lens) {
    let (mut pinhole, mut fisheye) = match *lens {
        _ if keys.reading().is_some() => (None, None),
        Lens::Pinhole { fov } => (Some(fov).filter(|_| *lens != DEFAULT_LENS), None),
        Lens::Fisheye { fov } => (None, Some(fov)),
    };
    keys.key("fov_deg", "Horizontal field of view in degrees; default: 60.")
        .nullable(Bounded(FIELD_OF_VIEW), &mut pinhole);
    keys.key("fisheye_deg", "Horizontal field of view of a fisheye lens in degrees, instead of `fov_deg`.")
        .nullable(Bounded(FISHEYE), &mut fisheye);
    if let Some((reader, section)) = keys.reading() {
        if fisheye.is_some() {
            reader.exclude(section, "fisheye_deg", &["fov_deg"]);
        }
        let read = fisheye.map(|fov| Lens::Fisheye { fov }).or(pinhole.map(|fov| Lens::Pinhole { fov }));
        read.into_iter().for_each(|read| *lens = read);
    }
}

/// Width and height of an image.
const PIXELS: Custom<[u32; 2]> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        let items = reader.array(section, key, "an array of 2 integers")?;
        let [width, height] = items else {
            let span = reader.key_span(section, key);
            let message = format!("`{key}` has {} values", items.len());
            reader.sink.error(Code::TomlType, span, message, "an array of 2 integers");
            return None;
        };
        let [width, height] = [width, height].map(|side| reader.as_integer(key, side, 1, MAX_PIXELS));
        Some([width? as u32, height? as u32])
    },
    print: |sides| sides.to_vec().into(),
    describe: |_| array_schema(integer_schema::<u32>(), 2),
};
