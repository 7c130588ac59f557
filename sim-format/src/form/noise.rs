//! Noise profiles: a preset and the parameters that differ from it.

use std::collections::BTreeMap;

use serde_json::{Value as Json, json};
use toml::de::DeValue;
use toml::{Table, Value};

use super::device::sorted_table;
use super::kind::{Custom, Kind, ReadContext, TABLE, TEXT};
use super::{Definitions, Form, Keys, definition, or_null, print};
use crate::Span;
use crate::code::Code;
use crate::line::{self, Quantity};
use crate::noise::{PRESETS, preset};
use crate::path;
use crate::print::number::shortest;
use crate::spec::{NoiseEntry, NoiseRef, NoiseSection, NoiseSpec, Preset};
use crate::table::{Reader, Section};
use sim_core::noise::RangeKind;
use sim_core::noise::keys::{CAMERA, COMPASS, DEVICE_NOISE, DRIVE, Keys as NoiseKeys, ODOMETRY, RADIO, RANGE};

/// Noise of a scene or robot: `noise = "mild"`, `noise = "FILE.toml"` or an inline profile.
pub(crate) const NOISE: Custom<NoiseRef> = Custom {
    read: |context| {
        let ReadContext { reader, section, key } = context;
        if section.get(key).is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_))) {
            let part = reader.section(section, key)?;
            if part.table.is_empty() {
                reader.warn_empty_profile(part.span);
            }
            let spec = NoiseSpec { file: reader.sink.file().to_owned(), ..NoiseSpec::default() };
            return reader.form(part, spec).map(|spec| NoiseRef::Profile(spec.into()));
        }
        let reference = reader.reference(section, key)?;
        if path::extension(&reference.text) == "toml" {
            return Some(NoiseRef::File(reference));
        }
        reader.preset(&reference.text, reference.span, ", or a file NAME.toml").map(NoiseRef::Preset)
    },
    print: |noise| match noise {
        NoiseRef::Preset(preset) => preset.name.into(),
        NoiseRef::File(path) => TEXT.print(path),
        NoiseRef::Profile(spec) => print(&**spec).into(),
    },
    describe: |definitions| {
        definition(definitions, "NoiseForm", |definitions| {
            let name =
                json!({ "description": "`none`, `mild`, `real`, `harsh`, `course`, or a file.", "type": "string" });
            let mut profile = Kind::<NoiseSpec>::describe(&TABLE, definitions);
            profile["description"] = "Inline table.".into();
            json!({ "description": "A noise profile.", "anyOf": [name, profile] })
        })
    },
};

impl Reader {
    /// Preset named `name`; reports an unknown name.
    fn preset(&mut self, name: &str, span: Span, alternative: &str) -> Option<Preset> {
        let preset = preset(name);
        if preset.is_none() {
            let message = format!("`{name}` is not a noise profile");
            let expected = format!("one of {}{alternative}", PRESETS.join(", "));
            let suggestion = line::nearest(name, PRESETS).map(|name| format!("write `{name}`"));
            self.sink.error(Code::TomlChoice, span, message, expected).suggestion = suggestion;
        }
        preset
    }

    /// Warns that a profile has no content.
    pub(crate) fn warn_empty_profile(&mut self, span: Span) {
        let expected = "`base = \"none\"` or another preset, or sections such as `[psd]`";
        self.sink.warn(Code::NoiseEmpty, span, "the noise profile is empty: there are no errors", expected);
    }
}

impl Form for NoiseSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("ProfileForm", "An inline noise profile: a preset and the changed numbers.");
        // The key is always printed, since it marks a file as a profile.
        keys.key("base", "Preset to start from; default: `none`.").always_printed(PRESET, &mut self.base);
        let entries = &mut self.entries;
        let about = [
            "PSD sensors.",
            "Laser range finders.",
            "Ultrasonic sensors of one ray.",
            "Reflectance sensors.",
            "Sonars with a beam.",
            "The laser scanner; each of its points is a reading.",
        ];
        for (kind, about) in RangeKind::ALL.into_iter().zip(about) {
            keys.key(kind.name(), about).list(SectionParameters(NoiseSection::Range(kind)), entries);
        }
        keys.key("compass", "The compass.").list(SectionParameters(NoiseSection::Compass), entries);
        keys.key("camera", "The camera.").list(SectionParameters(NoiseSection::Camera), entries);
        keys.key("drive", "Errors between commands and motion.").list(SectionParameters(NoiseSection::Drive), entries);
        keys.key("odometry", "Errors between motion and odometry.")
            .list(SectionParameters(NoiseSection::Odometry), entries);
        keys.key("radio", "Errors of received messages.").list(SectionParameters(NoiseSection::Radio), entries);
        keys.key("sensor", "Changed numbers of individual sensors, by name.").list(SENSORS, entries);
        entries.sort_by(|a, b| a.section.cmp(&b.section));
    }
}

/// A preset, by its name.
const PRESET: Custom<Preset> = Custom {
    read: |context| {
        let base = context.reader.reference(context.section, context.key)?;
        context.reader.preset(&base.text, base.span, "")
    },
    print: |preset| preset.name.into(),
    describe: |definitions| {
        definition(
            definitions,
            "PresetForm",
            |_| json!({ "description": "A preset.", "type": "string", "enum": PRESETS }),
        )
    },
};

/// Parameters of one section of a profile.
struct SectionParameters(NoiseSection);

impl SectionParameters {
    /// Name and description of the section's definition in the schema.
    fn definition(&self) -> (&'static str, &'static str) {
        match &self.0 {
            NoiseSection::Range(kind) if !kind.has_device_noise() => ("RangeNoiseForm", "Errors of distance sensors."),
            NoiseSection::Range(_) | NoiseSection::Sensor(_) => {
                ("EchoNoiseForm", "Errors of distance sensors whose model contains noise.")
            }
            NoiseSection::Compass => ("CompassNoiseForm", "Errors of a compass."),
            NoiseSection::Camera => ("CameraNoiseForm", "Errors of the images of a camera."),
            NoiseSection::Drive => ("DriveNoiseForm", "Errors between commands and motion."),
            NoiseSection::Odometry => ("OdometryNoiseForm", "Errors between motion and odometry."),
            NoiseSection::Radio => ("RadioNoiseForm", "Errors of the messages that a radio receives."),
        }
    }

    /// The section's keys: name, description, and quantity with unit and bounds.
    fn quantities(&self) -> Vec<(&'static str, &'static str, &'static Quantity)> {
        fn described<M>(keys: NoiseKeys<M>) -> impl Iterator<Item = (&'static str, &'static str, &'static Quantity)> {
            keys.iter().map(|key| (key.name, key.about, &key.quantity))
        }
        match &self.0 {
            NoiseSection::Range(kind) if !kind.has_device_noise() => described(RANGE).collect(),
            NoiseSection::Range(_) | NoiseSection::Sensor(_) => {
                described(RANGE).chain(described(DEVICE_NOISE)).collect()
            }
            NoiseSection::Compass => described(COMPASS).collect(),
            NoiseSection::Camera => described(CAMERA).collect(),
            NoiseSection::Drive => described(DRIVE).collect(),
            NoiseSection::Odometry => described(ODOMETRY).collect(),
            NoiseSection::Radio => described(RADIO).collect(),
        }
    }

    fn read_section(&self, reader: &mut Reader, mut part: Section<'_, '_>) -> Vec<NoiseEntry> {
        let mut entries = Vec::new();
        for (key, _, quantity) in self.quantities() {
            if let Some(value) = reader.number(&mut part, key, quantity) {
                let span = reader.key_span(&part, key);
                entries.push(NoiseEntry { section: self.0.clone(), key, value, span });
            }
        }
        reader.unknown_keys(&part);
        entries
    }
}

impl Kind<Vec<NoiseEntry>> for SectionParameters {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<NoiseEntry>>) -> Option<Vec<NoiseEntry>> {
        let part = context.reader.section(context.section, context.key)?;
        Some(self.read_section(context.reader, part))
    }

    fn print(&self, entries: &Vec<NoiseEntry>) -> Value {
        let quantities = self.quantities().into_iter().map(|(key, _, quantity)| (key, quantity));
        let quantities: BTreeMap<&str, &Quantity> = quantities.collect();
        let number = |entry: &NoiseEntry| match quantities.get(entry.key) {
            Some(quantity) => shortest(entry.value / quantity.si(1.0), |number| quantity.si(number) == entry.value),
            // The reader admits only keys of the section.
            None => entry.value,
        };
        let of_section = entries.iter().filter(|entry| entry.section == self.0);
        Table::from_iter(of_section.map(|entry| (entry.key.to_owned(), number(entry).into()))).into()
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        let (name, about) = self.definition();
        definition(definitions, name, |_| {
            let keys = self.quantities().into_iter().map(|(key, about, quantity)| {
                let [minimum, maximum] = quantity.bounds();
                let mut schema = or_null(json!({ "type": "number", "minimum": minimum, "maximum": maximum }));
                schema["description"] = about.into();
                (key.to_owned(), schema)
            });
            let keys: Definitions = keys.collect();
            json!({ "description": about, "type": "object", "properties": keys, "additionalProperties": false })
        })
    }
}

/// Parameters of individual sensors.
const SENSORS: Custom<Vec<NoiseEntry>> = Custom {
    read: |context| {
        let mut entries = Vec::new();
        for (name, value) in context.reader.section(context.section, context.key)?.table {
            if let Some(part) = context.reader.as_section(context.key, value) {
                let sensor = NoiseSection::Sensor(name.get_ref().to_string());
                entries.extend(SectionParameters(sensor).read_section(context.reader, part));
            }
        }
        Some(entries)
    },
    print: |entries| {
        let names = entries.iter().filter_map(|entry| match &entry.section {
            NoiseSection::Sensor(name) => Some(name.clone()),
            _ => None,
        });
        sorted_table(names.map(|name| (name.clone(), SectionParameters(NoiseSection::Sensor(name)).print(entries))))
    },
    describe: |definitions| {
        let sensor = SectionParameters(NoiseSection::Sensor(String::new()));
        json!({ "type": "object", "additionalProperties": sensor.describe(definitions) })
    },
};
