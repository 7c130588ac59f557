//! Noise profiles: error models of a robot's devices.
//!
//! A profile starts from a preset and changes some of its parameters, first for each kind of device, then for
//! individual sensors. The presets are profiles themselves, compiled in.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::line;
use super::path;
use super::spec::{LIDAR, NoiseRef, NoiseSection, NoiseSpec, Preset, RobiSpec, RobotSpec};
use super::table::{Reader, Section};

/// Maximum number of names listed in a message.
const MAX_LISTED: usize = 32;

/// Suffix of file names that identifies a profile without reading its content.
pub const NOISE_EXTENSION: &str = ".noise.toml";

/// Names of the presets: [`LEVELS`], and `course`, whose only errors are bounded errors at the targets of drives.
pub const PRESETS: [&str; 5] = ["none", "mild", "real", "harsh", "course"];

/// Names of the presets for all kinds of errors, from the smallest errors to the largest. `none` has no errors; `mild`
/// represents good, well-maintained devices; `real` follows data sheets and published measurements of devices of this
/// class; `harsh` represents bad light, a slippery floor and worn devices.
pub const LEVELS: [&str; 4] = ["none", "mild", "real", "harsh"];

/// Preset named `name`.
pub fn preset(name: &str) -> Option<Preset> {
    // The text of every preset names `none` as its base, even the text of `none`: reading it would recurse forever.
    if name == Preset::default().name {
        return Some(Preset::default());
    }
    let name = PRESETS.into_iter().find(|known| *known == name)?;
    let entries = read_noise(name, preset_text(name)?).0.entries.into();
    Some(Preset { name, entries })
}

/// Text of the preset named `name`, with the reasons for its numbers.
pub fn preset_text(name: &str) -> Option<&'static str> {
    match name {
        "none" => Some(include_str!("none.toml")),
        "mild" => Some(include_str!("mild.toml")),
        "real" => Some(include_str!("real.toml")),
        "harsh" => Some(include_str!("harsh.toml")),
        "course" => Some(include_str!("course.toml")),
        _ => None,
    }
}

/// Returns true for a TOML file that is a noise profile: its name ends in `.noise.toml`, or it has `base` at its top
/// level.
pub fn is_noise(path: &str, text: &str) -> bool {
    path.to_lowercase().ends_with(NOISE_EXTENSION)
        || path::extension(path) == "toml" && super::table::has_top_key(text, &["base"])
}

/// Reads a noise profile.
///
/// Unknown keys and an empty profile give a warning; a value of the wrong type or out of range is an error.
pub fn read_noise(file: &str, text: &str) -> (NoiseSpec, Vec<Diagnostic>) {
    let (mut reader, root) = Reader::parse(file, text);
    if root.is_empty() && reader.sink.is_empty() {
        let span = reader.span(0..0);
        reader.warn_empty_profile(span);
    }
    let spec = NoiseSpec { file: file.to_owned(), ..NoiseSpec::default() };
    let spec = reader.form(Section::root(&root), spec).unwrap_or_default();
    (spec, reader.sink.finish())
}

/// Warns about each sensor that a profile names although no robot with this profile has it.
pub fn unknown_sensors(robots: &[RobotSpec]) -> Vec<Diagnostic> {
    let mut profiles: Vec<(&Arc<NoiseSpec>, BTreeSet<&str>)> = Vec::new();
    for robot in robots {
        let Some(NoiseRef::Profile(spec)) = &robot.noise else { continue };
        let index = profiles.iter().position(|(known, _)| Arc::ptr_eq(known, spec)).unwrap_or_else(|| {
            profiles.push((spec, BTreeSet::new()));
            profiles.len() - 1
        });
        let RobiSpec { psds, ranges, lidar, .. } = &*robot.robi;
        let names = psds.iter().map(|psd| &*psd.name).chain(ranges.iter().map(|range| &*range.name));
        profiles[index].1.extend(names.chain(lidar.as_ref().map(|_| LIDAR)));
    }
    let mut diagnostics = Vec::new();
    for (spec, names) in profiles {
        let mut sink = Sink::new(&spec.file);
        let mut last_reported = None;
        for entry in &spec.entries {
            let NoiseSection::Sensor(name) = &entry.section else { continue };
            if last_reported == Some(name) || names.contains(name.as_str()) {
                continue;
            }
            last_reported = Some(name);
            let message = format!("no robot with this profile has a distance sensor `{name}`");
            let listed_names: Vec<&str> = names.iter().copied().take(MAX_LISTED).collect();
            let expected = if listed_names.is_empty() {
                "a robot with sensors".into()
            } else {
                format!("one of {}", listed_names.join(", "))
            };
            let suggestion = line::nearest(name, names.iter().copied()).map(|name| format!("write `{name}`"));
            sink.warn(Code::NoiseSensor, entry.span, message, expected).suggestion = suggestion;
        }
        diagnostics.extend(sink.finish());
    }
    diagnostics
}
