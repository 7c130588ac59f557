//! Noise profiles as specs.

use std::sync::Arc;

use super::{Span, SpannedText};
use crate::noise::keys::{CAMERA, COMPASS, DEVICE_NOISE, DRIVE, Keys, ODOMETRY, RADIO, RANGE};
use crate::noise::{Profile, RangeKind};

/// A built-in noise profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// Name of the preset.
    pub name: &'static str,
    /// Parameters of the preset, as in a [`NoiseSpec`].
    pub entries: Arc<[NoiseEntry]>,
}

impl Default for Preset {
    /// Returns the preset `none`: no errors.
    fn default() -> Self {
        Self { name: "none", entries: Arc::new([]) }
    }
}

impl Preset {
    /// Noise models of all devices.
    pub fn profile(&self) -> Profile {
        with_entries(Profile::default(), &self.entries)
    }
}

/// Source of the noise profile of a scene or a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum NoiseRef {
    /// A preset.
    Preset(Preset),
    /// Name of a file that has not been read.
    File(SpannedText),
    /// A profile: a table of the scene, or the content of a file.
    Profile(Arc<NoiseSpec>),
}

impl NoiseRef {
    /// The profile; `None` if it sets no parameter, so that all devices are exact, or if its file has not been read.
    pub fn profile(&self) -> Option<Profile> {
        match self {
            Self::Preset(preset) => (!preset.entries.is_empty()).then(|| preset.profile()),
            Self::File(_) => None,
            Self::Profile(spec) => {
                let is_none = spec.base.entries.is_empty() && spec.entries.is_empty();
                (!is_none).then(|| spec.profile())
            }
        }
    }
}

/// A noise profile: a preset and the changes to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseSpec {
    /// Name of the file.
    pub file: String,
    /// Preset that the profile starts from.
    pub base: Preset,
    /// Changes in the order of the sections; those of individual sensors come last, by name.
    pub entries: Vec<NoiseEntry>,
}

/// One parameter of a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseEntry {
    /// The section.
    pub section: NoiseSection,
    /// The key.
    pub key: &'static str,
    /// The value in SI units; a percentage as a fraction.
    pub value: f64,
    /// Location in the file.
    pub span: Span,
}

/// A section of a profile.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseSection {
    /// All distance sensors of a kind.
    Range(RangeKind),
    /// The compass.
    Compass,
    /// The camera.
    Camera,
    /// Errors between command and motion.
    Drive,
    /// Errors between motion and odometry.
    Odometry,
    /// Reception of the radio.
    Radio,
    /// The distance sensor with this name.
    Sensor(String),
}

impl NoiseSpec {
    /// Noise models of all devices.
    pub fn profile(&self) -> Profile {
        with_entries(self.base.profile(), &self.entries)
    }
}

/// `profile` with the parameters of `entries`.
fn with_entries(mut profile: Profile, entries: &[NoiseEntry]) -> Profile {
    for NoiseEntry { section, key, value, .. } in entries {
        let (key, value) = (*key, *value);
        match section {
            NoiseSection::Range(kind) => set(&[RANGE, DEVICE_NOISE], &mut profile.ranges[*kind as usize], key, value),
            NoiseSection::Compass => set(&[COMPASS], &mut profile.compass, key, value),
            NoiseSection::Camera => set(&[CAMERA], &mut profile.camera, key, value),
            NoiseSection::Drive => set(&[DRIVE], &mut profile.motion, key, value),
            NoiseSection::Odometry => set(&[ODOMETRY], &mut profile.motion, key, value),
            NoiseSection::Radio => set(&[RADIO], &mut profile.radio, key, value),
            NoiseSection::Sensor(name) => {
                let entry = [RANGE, DEVICE_NOISE].into_iter().flatten().find(|entry| entry.name == key);
                let change = entry.map(|entry| (entry.accessor, value));
                profile.sensors.entry(name.clone()).or_default().extend(change);
            }
        }
    }
    profile
}

/// Sets the parameter of `model` that belongs to `key`.
fn set<M>(keys: &[Keys<M>], model: &mut M, key: &str, value: f64) {
    if let Some(known) = keys.iter().copied().flatten().find(|known| known.name == key) {
        *(known.accessor)(model) = value;
    }
}
