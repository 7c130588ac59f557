//! Noise profiles in TOML.

use toml::{Table, Value};

use super::number::shortest;
use super::text;
use crate::line::Quantity;
use crate::noise::form::{NoiseForm, PresetForm, ProfileForm};
use crate::spec::{NoiseEntry, NoiseRef, NoiseSection, NoiseSpec};
use sim_core::noise::RangeKind;
use sim_core::noise::keys::{CAMERA, COMPASS, DRIVE, Keys, ODOMETRY, OWN, RADIO, RANGE};

/// The text of a noise profile.
pub fn print_noise(spec: &NoiseSpec) -> String {
    // Serialising plain structs cannot fail.
    text::document(&Table::try_from(profile_form(spec)).unwrap_or_default())
}

pub(super) fn noise_form(noise: &NoiseRef) -> NoiseForm {
    match noise {
        NoiseRef::Preset(preset) => NoiseForm::Name(preset.name.to_owned()),
        NoiseRef::File(path) => NoiseForm::Name(path.text.clone()),
        NoiseRef::Profile(spec) => NoiseForm::Profile(profile_form(spec).into()),
    }
}

fn profile_form(spec: &NoiseSpec) -> ProfileForm {
    let base = match spec.base.name {
        "mild" => PresetForm::Mild,
        "real" => PresetForm::Real,
        "harsh" => PresetForm::Harsh,
        _ => PresetForm::None,
    };
    // Always: a file is known by it to be a profile.
    let mut form = ProfileForm { base: Some(base), ..ProfileForm::default() };
    for entry in &spec.entries {
        let section = match &entry.section {
            NoiseSection::Range(RangeKind::Psd) => &mut form.psd,
            NoiseSection::Range(RangeKind::Laser) => &mut form.laser,
            NoiseSection::Range(RangeKind::Ultrasonic) => &mut form.ultrasonic,
            NoiseSection::Range(RangeKind::Reflectance) => &mut form.reflectance,
            NoiseSection::Range(RangeKind::Sonar) => &mut form.sonar,
            NoiseSection::Range(RangeKind::Lidar) => &mut form.lidar,
            NoiseSection::Compass => &mut form.compass,
            NoiseSection::Camera => &mut form.camera,
            NoiseSection::Drive => &mut form.drive,
            NoiseSection::Odometry => &mut form.odometry,
            NoiseSection::Radio => &mut form.radio,
            NoiseSection::Sensor(name) => form.sensor.entry(name.clone()).or_default(),
        };
        section.insert(entry.key.to_owned(), Value::Float(number(entry)));
    }
    form
}

/// The number of an entry in the unit of its key.
fn number(entry: &NoiseEntry) -> f64 {
    let quantity = match entry.section {
        NoiseSection::Range(_) | NoiseSection::Sensor(_) => {
            quantity(RANGE, entry.key).or_else(|| quantity(OWN, entry.key))
        }
        NoiseSection::Compass => quantity(COMPASS, entry.key),
        NoiseSection::Camera => quantity(CAMERA, entry.key),
        NoiseSection::Drive => quantity(DRIVE, entry.key),
        NoiseSection::Odometry => quantity(ODOMETRY, entry.key),
        NoiseSection::Radio => quantity(RADIO, entry.key),
    };
    // A reader gives no key that its section has not.
    quantity.map_or(entry.value, |quantity| {
        shortest(entry.value / quantity.si(1.0), |number| quantity.si(number) == entry.value)
    })
}

fn quantity<M>(keys: Keys<M>, name: &str) -> Option<&'static Quantity> {
    keys.iter().find(|key| key.name == name).map(|key| &key.quantity)
}
