//! Companion of a robi: a TOML file beside the robi, for settings that the classic format lacks.

use std::collections::BTreeMap;

use toml::de::DeValue;

use super::Span;
use super::code::Code;
use super::diagnostic::Diagnostic;
use super::form::robot::companion;
use super::form::sensor::{RANGE_OF_PSDS, model_name, psd_keys};
use super::line;
use super::spec::{LIDAR, RobiSpec};
use super::table::{Reader, Section};
use super::used_names::UsedNames;

/// Maximum number of names listed in a message.
const MAX_LISTED: usize = 32;

/// Reads the companion `text` of a robi into `robi`; its values override those of the robi.
///
/// `file` is the companion's name. Unknown keys give a warning; a value of the wrong type or out of range is an error,
/// and the default applies.
pub fn read_companion(file: &str, text: &str, robi: &mut RobiSpec) -> Vec<Diagnostic> {
    let (mut reader, root) = Reader::parse(file, text);
    reader.table(Section::root(&root), |keys| {
        keys.mention_first(&["drive"]);
        if let Some((reader, root)) = keys.reading()
            && let Some(section) = reader.section(root, "psd")
        {
            reader.read_psds(section, robi);
        }
        companion(keys, robi);
    });
    reader.check_devices(robi);
    reader.sink.finish()
}

impl Reader {
    /// Reads `range_mm` for all PSDs, and a table for each PSD that differs.
    fn read_psds(&mut self, mut section: Section<'_, '_>, robi: &mut RobiSpec) {
        if let Some(range) = self.number(&mut section, "range_mm", &RANGE_OF_PSDS) {
            robi.psds.iter_mut().for_each(|psd| psd.range = range);
        }
        let names: Vec<String> = robi.psds.iter().map(|psd| psd.name.clone()).collect();
        let indices: BTreeMap<&str, usize> = names.iter().map(String::as_str).zip(0..).collect();
        let names = || names.iter().map(String::as_str).take(MAX_LISTED).chain(["range_mm"]);
        for (key, value) in section.table {
            if key.get_ref() == "range_mm" {
                continue;
            }
            let span = self.span(key.span());
            let Some(psd) = indices.get(key.get_ref().as_ref()).and_then(|index| robi.psds.get_mut(*index)) else {
                let message = format!("`{}` is neither a PSD of the robi nor `range_mm`", key.get_ref());
                let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
                let suggestion = line::nearest(key.get_ref(), names()).map(|name| format!("write `{name}`"));
                self.sink.warn(Code::TomlKey, span, message, expected).suggestion = suggestion;
                continue;
            };
            if !matches!(value.get_ref(), DeValue::Table(_)) {
                self.wrong_type(key.get_ref(), value, "a table");
            } else if let Some(section) = self.as_section("psd", value) {
                self.table(section, |keys| psd_keys(keys, psd));
            }
        }
    }

    /// Reports devices with the same name or number, which a program could not distinguish.
    pub(super) fn report_duplicates(&mut self, robi: &RobiSpec) {
        let psds = robi.psds.iter().map(|device| ("PSD", &*device.name, device.id, device.span));
        let ranges =
            robi.ranges.iter().map(|device| (model_name(&device.model), &*device.name, device.id, device.span));
        // The scanner has no name in files; noise profiles call it by the name `LIDAR`.
        let lidar = robi.lidar.iter().map(|lidar| ("lidar", LIDAR, None, lidar.span));
        self.report_duplicates_in(lidar.chain(psds).chain(ranges));
        let infrareds = robi.infrareds.iter();
        self.report_duplicates_in(infrareds.map(|device| ("infrared", &*device.name, device.id, device.span)));
        self.report_duplicates_in(robi.bumpers.iter().map(|device| ("bumper", &*device.name, device.id, device.span)));
        self.report_duplicates_in(robi.servos.iter().map(|device| ("servo", &*device.name, device.id, device.span)));
    }

    fn report_duplicates_in<'d>(&mut self, devices: impl Iterator<Item = (&'static str, &'d str, Option<i32>, Span)>) {
        let mut used_names = UsedNames::default();
        for (kind, name, id, span) in devices {
            if used_names.line_of(name, id).is_some() {
                let message = format!("the name or number of {kind} `{name}` was already given");
                self.sink.warn(Code::RobiDeviceTwice, span, message, "each name and each number once");
            }
            used_names.add(name, id, span.line);
        }
    }
}
