//! Noise profiles: what errors the devices of a robot have.
//!
//! A profile starts from a preset and changes some of its numbers, by the kind of the device and then of single sensors. The
//! presets are profiles themselves, compiled in.

pub(super) mod form;

use std::collections::BTreeSet;
use std::sync::Arc;

use toml::de::DeValue;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::line;
use super::path;
use super::spec::{LIDAR, NoiseEntry, NoiseRef, NoiseSection, NoiseSpec, Preset, RobiSpec, RobotSpec};
use super::table::{Reader, Section};
use sim_core::noise::RangeKind;
use sim_core::noise::keys::{CAMERA, COMPASS, DRIVE, Key, Keys, ODOMETRY, OWN, RADIO, RANGE};

/// Names that a message lists at most.
const MAX_LISTED: usize = 32;

/// Ending of the names of profiles by which they are known without a look at their content.
pub const NOISE_EXTENSION: &str = ".noise.toml";

/// Names of the presets, from the least errors to the most: none; good devices, well looked after; what data sheets and published
/// measurements say of devices of this class; bad light, a slippery floor, worn devices.
pub const PRESETS: [&str; 4] = ["none", "mild", "real", "harsh"];

/// The preset of this name.
pub fn preset(name: &str) -> Option<Preset> {
    // Its text, like that of all presets, says that it stands on this one.
    if name == Preset::default().name {
        return Some(Preset::default());
    }
    let name = PRESETS.into_iter().find(|known| *known == name)?;
    let entries = read_noise(name, preset_text(name)?).0.entries.into();
    Some(Preset { name, entries })
}

/// The preset of this name as a text, with the reasons for its numbers.
pub fn preset_text(name: &str) -> Option<&'static str> {
    match name {
        "none" => Some(include_str!("none.toml")),
        "mild" => Some(include_str!("mild.toml")),
        "real" => Some(include_str!("real.toml")),
        "harsh" => Some(include_str!("harsh.toml")),
        _ => None,
    }
}

/// True for a TOML file that is a noise profile: its name ends in `.noise.toml`, or it has `base` at its top level.
pub fn is_noise(path: &str, text: &str) -> bool {
    path.to_lowercase().ends_with(NOISE_EXTENSION)
        || path::extension(path) == "toml" && super::table::has_top_key(text, &["base"])
}

/// Reads a noise profile.
///
/// Unknown keys are warned about, and so is an empty profile; a value of the wrong type or out of range is an error.
pub fn read_noise(file: &str, text: &str) -> (NoiseSpec, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    if root.is_empty() && reader.sink.is_empty() {
        let span = reader.span(0..0);
        reader.warn_of_empty(span);
    }
    let mut spec = reader.noise(Section::root(&root));
    file.clone_into(&mut spec.file);
    (spec, reader.sink.finish())
}

/// Warnings of profiles that name sensors which none of the robots with the profile has.
pub fn unknown_sensors(robots: &[RobotSpec]) -> Vec<Diagnostic> {
    let mut profiles: Vec<(&Arc<NoiseSpec>, BTreeSet<&str>)> = Vec::new();
    for robot in robots {
        let Some(NoiseRef::Profile(spec)) = &robot.noise else { continue };
        let place = profiles.iter().position(|(known, _)| Arc::ptr_eq(known, spec)).unwrap_or_else(|| {
            profiles.push((spec, BTreeSet::new()));
            profiles.len() - 1
        });
        let RobiSpec { psds, ranges, lidar, .. } = &*robot.robi;
        let names = psds.iter().map(|psd| &*psd.name).chain(ranges.iter().map(|range| &*range.name));
        profiles[place].1.extend(names.chain(lidar.as_ref().map(|_| LIDAR)));
    }
    let mut diagnostics = Vec::new();
    for (spec, names) in profiles {
        let mut sink = Sink::new(&spec.file);
        let mut last = None;
        for entry in &spec.entries {
            let NoiseSection::Sensor(name) = &entry.section else { continue };
            if last == Some(name) || names.contains(name.as_str()) {
                continue;
            }
            last = Some(name);
            let message = format!("no robot with this profile has a sensor of distance `{name}`");
            let listed: Vec<&str> = names.iter().copied().take(MAX_LISTED).collect();
            let expected =
                if listed.is_empty() { "a robot with sensors".into() } else { format!("one of {}", listed.join(", ")) };
            let nearest = line::nearest(name, names.iter().copied()).map(|name| format!("write `{name}`"));
            sink.warn(Code::NoiseSensor, entry.span, message, expected).suggestion = nearest;
        }
        diagnostics.extend(sink.finish());
    }
    diagnostics
}

impl Reader<'_> {
    /// `noise = "mild"`, `noise = "FILE.toml"` or a profile in place; that is of the file `file`.
    pub(super) fn noise_ref(&mut self, section: &mut Section<'_, '_>, file: &str) -> Option<NoiseRef> {
        if section.get("noise").is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_))) {
            let part = self.section(section, "noise")?;
            if part.table.is_empty() {
                self.warn_of_empty(part.span);
            }
            let mut spec = self.noise(part);
            file.clone_into(&mut spec.file);
            return Some(NoiseRef::Profile(spec.into()));
        }
        let reference = self.reference(section, "noise")?;
        if path::extension(&reference.text) == "toml" {
            return Some(NoiseRef::File(reference));
        }
        let preset = self.preset(&reference.text, reference.span, ", or a file NAME.toml");
        preset.map(NoiseRef::Preset)
    }

    fn preset(&mut self, name: &str, span: super::Span, or: &str) -> Option<Preset> {
        let preset = preset(name);
        if preset.is_none() {
            let message = format!("`{name}` is no noise profile");
            let expected = format!("one of {}{or}", PRESETS.join(", "));
            let suggestion = line::nearest(name, PRESETS).map(|name| format!("write `{name}`"));
            self.sink.error(Code::TomlChoice, span, message, expected).suggestion = suggestion;
        }
        preset
    }

    fn warn_of_empty(&mut self, span: super::Span) {
        let expected = "`base = \"none\"` or another preset, or sections such as `[psd]`";
        self.sink.warn(Code::NoiseEmpty, span, "the noise profile is empty: there are no errors", expected);
    }

    /// A whole profile.
    fn noise(&mut self, mut section: Section<'_, '_>) -> NoiseSpec {
        let mut spec = NoiseSpec::default();
        if let Some(base) = self.reference(&mut section, "base") {
            spec.base = self.preset(&base.text, base.span, "").unwrap_or_default();
        }
        for kind in RangeKind::ALL {
            if let Some(part) = self.section(&mut section, kind.name()) {
                let own: Keys<_> = if kind.has_own_noise() { OWN } else { &[] };
                self.entries(part, &NoiseSection::Range(kind), &[RANGE, own], &mut spec);
            }
        }
        if let Some(part) = self.section(&mut section, "compass") {
            self.entries(part, &NoiseSection::Compass, &[COMPASS], &mut spec);
        }
        if let Some(part) = self.section(&mut section, "camera") {
            self.entries(part, &NoiseSection::Camera, &[CAMERA], &mut spec);
        }
        if let Some(part) = self.section(&mut section, "drive") {
            self.entries(part, &NoiseSection::Drive, &[DRIVE], &mut spec);
        }
        if let Some(part) = self.section(&mut section, "odometry") {
            self.entries(part, &NoiseSection::Odometry, &[ODOMETRY], &mut spec);
        }
        if let Some(part) = self.section(&mut section, "radio") {
            self.entries(part, &NoiseSection::Radio, &[RADIO], &mut spec);
        }
        if let Some(sensors) = self.section(&mut section, "sensor") {
            for (name, value) in sensors.table {
                if let Some(part) = self.as_section("sensor", value) {
                    let sensor = NoiseSection::Sensor(name.get_ref().to_string());
                    self.entries(part, &sensor, &[RANGE, OWN], &mut spec);
                }
            }
        }
        self.unknown_keys(&section);
        spec.entries.sort_by(|a, b| a.section.cmp(&b.section));
        spec
    }

    /// Those of `keys` that a section has.
    fn entries<M: 'static>(
        &mut self,
        mut part: Section<'_, '_>,
        section: &NoiseSection,
        keys: &[Keys<M>],
        spec: &mut NoiseSpec,
    ) {
        for Key { name, quantity, .. } in keys.iter().copied().flatten() {
            if let Some(value) = self.number(&mut part, name, quantity) {
                let span = self.key_span(&part, name);
                spec.entries.push(NoiseEntry { section: section.clone(), key: name, value, span });
            }
        }
        self.unknown_keys(&part);
    }
}
