//! What a noise profile says.

use std::sync::Arc;

use super::keys::{CAMERA, COMPASS, DRIVE, Keys, ODOMETRY, OWN, RADIO, RANGE};
use crate::format::Span;
use crate::format::spec::PathRef;
use crate::noise::{Profile, RangeKind};

/// A profile that is compiled in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// No errors.
    #[default]
    None,
    /// Good devices, well looked after.
    Mild,
    /// What data sheets and published measurements say of devices of this class.
    Real,
    /// Bad light, a slippery floor, worn devices.
    Harsh,
}

impl Preset {
    /// All presets, from the least errors to the most.
    pub const ALL: [Self; 4] = [Self::None, Self::Mild, Self::Real, Self::Harsh];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Mild => "mild",
            Self::Real => "real",
            Self::Harsh => "harsh",
        }
    }

    /// The preset of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// Its profile as a text, with the reasons for its numbers.
    pub const fn text(self) -> &'static str {
        match self {
            Self::None => include_str!("none.toml"),
            Self::Mild => include_str!("mild.toml"),
            Self::Real => include_str!("real.toml"),
            Self::Harsh => include_str!("harsh.toml"),
        }
    }

    /// Its profile; its base is `none`.
    pub fn spec(self) -> NoiseSpec {
        super::read_noise(self.name(), self.text()).0
    }
}

/// Where a scene or a robot takes its noise profile from.
#[derive(Clone, Debug, PartialEq)]
pub enum NoiseRef {
    /// A preset.
    Preset(Preset),
    /// A file.
    File(PathRef),
    /// The scene itself; or a file that was read.
    Profile(Arc<NoiseSpec>),
}

impl NoiseRef {
    /// The profile; `None` where there are no errors, or where it is a file that was not read.
    pub fn profile(&self) -> Option<Profile> {
        match self {
            Self::Preset(Preset::None) | Self::File(_) => None,
            Self::Preset(preset) => Some(preset.spec().profile()),
            Self::Profile(spec) => {
                let is_none = spec.base == Preset::None && spec.entries.is_empty();
                (!is_none).then(|| spec.profile())
            }
        }
    }
}

/// A noise profile: a preset and what is different from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseSpec {
    /// Name of the file.
    pub file: String,
    /// What it starts from.
    pub base: Preset,
    /// What it changes, in the order of the sections, single sensors last, by their names.
    pub entries: Vec<NoiseEntry>,
}

/// One number of a profile.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseEntry {
    /// The section.
    pub section: NoiseSection,
    /// The key.
    pub key: &'static str,
    /// The number in SI units; a percentage is a share.
    pub value: f64,
    /// Where it is written.
    pub span: Span,
}

/// A section of a profile.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NoiseSection {
    /// All sensors of distance of a kind.
    Range(RangeKind),
    /// The compass.
    Compass,
    /// The camera.
    Camera,
    /// What lies between command and motion.
    Drive,
    /// What lies between motion and odometry.
    Odometry,
    /// What the radio receives.
    Radio,
    /// The sensor of distance of this name.
    Sensor(String),
}

impl NoiseSpec {
    /// The errors of all devices.
    pub fn profile(&self) -> Profile {
        let mut profile = match self.base {
            Preset::None => Profile::default(),
            base => base.spec().profile(),
        };
        for NoiseEntry { section, key, value, .. } in &self.entries {
            let (key, value) = (*key, *value);
            match section {
                NoiseSection::Range(kind) => set(&[RANGE, OWN], &mut profile.ranges[*kind as usize], key, value),
                NoiseSection::Compass => set(&[COMPASS], &mut profile.compass, key, value),
                NoiseSection::Camera => set(&[CAMERA], &mut profile.camera, key, value),
                NoiseSection::Drive => set(&[DRIVE], &mut profile.motion, key, value),
                NoiseSection::Odometry => set(&[ODOMETRY], &mut profile.motion, key, value),
                NoiseSection::Radio => set(&[RADIO], &mut profile.radio, key, value),
                NoiseSection::Sensor(name) => {
                    let known = [RANGE, OWN].into_iter().flatten().find(|known| known.name == key);
                    let change = known.map(|known| (known.place, value));
                    profile.sensors.entry(name.clone()).or_default().extend(change);
                }
            }
        }
        profile
    }
}

/// Sets the number of `model` for which `key` stands.
fn set<M>(keys: &[Keys<M>], model: &mut M, key: &str, value: f64) {
    if let Some(known) = keys.iter().copied().flatten().find(|known| known.name == key) {
        *(known.place)(model) = value;
    }
}
