//! The errors of all devices of a robot.

use std::collections::BTreeMap;

use super::{Angle, Image, Motion, Radio, Range};

/// Kinds of devices that measure distances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RangeKind {
    /// Position sensitive device.
    Psd,
    /// Laser range finder.
    Laser,
    /// Ultrasonic sensor of one ray.
    Ultrasonic,
    /// Reflectance sensor.
    Reflectance,
    /// Sonar with a beam.
    Sonar,
    /// Laser scanner.
    Lidar,
}

impl RangeKind {
    /// All kinds, in the order of a profile.
    pub const ALL: [Self; 6] = [Self::Psd, Self::Laser, Self::Ultrasonic, Self::Reflectance, Self::Sonar, Self::Lidar];

    /// True for those whose type gives them a noise N of their own, after France et al.
    pub const fn has_own_noise(self) -> bool {
        !matches!(self, Self::Psd | Self::Lidar)
    }

    /// Its section of a profile.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Psd => "psd",
            Self::Laser => "laser",
            Self::Ultrasonic => "ultrasonic",
            Self::Reflectance => "reflectance",
            Self::Sonar => "sonar",
            Self::Lidar => "lidar",
        }
    }
}

/// Where the number that a key of a profile sets has its place in the model.
pub type Place<M> = fn(&mut M) -> &mut f64;

/// How far the devices of a robot are from perfect. The default: not at all.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Sensors of distance by their kind, in the order of [`RangeKind::ALL`].
    pub ranges: [Range; RangeKind::ALL.len()],
    /// What is different of single sensors of distance, by their names.
    pub sensors: BTreeMap<String, Vec<(Place<Range>, f64)>>,
    /// The compass.
    pub compass: Angle,
    /// The camera.
    pub camera: Image,
    /// Drive and odometry.
    pub motion: Motion,
    /// What the radio receives.
    pub radio: Radio,
}

impl Profile {
    /// The errors of the sensor of this kind and name.
    pub fn range(&self, kind: RangeKind, name: &str) -> Range {
        let mut range = self.ranges[kind as usize];
        for (place, value) in self.sensors.get(name).into_iter().flatten() {
            *place(&mut range) = *value;
        }
        range
    }
}
