//! Noise profile: the noise models of all devices of a robot.

use std::collections::BTreeMap;

use super::{CompassNoise, ImageNoise, MotionNoise, RadioNoise, RangeNoise};

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

    /// Returns true for kinds whose sensor model, after France et al., contains a noise term N.
    pub const fn has_device_noise(self) -> bool {
        !matches!(self, Self::Psd | Self::Lidar)
    }

    /// Name of this kind's section in a profile.
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

/// Accessor of the parameter in a noise model that a key of a profile sets.
pub type Accessor<M> = fn(&mut M) -> &mut f64;

/// Noise models of the devices of a robot. The default has no errors.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    /// Models of distance sensors by kind, in the order of [`RangeKind::ALL`].
    pub ranges: [RangeNoise; RangeKind::ALL.len()],
    /// Changed parameters of individual distance sensors, by the sensor's name.
    pub sensors: BTreeMap<String, Vec<(Accessor<RangeNoise>, f64)>>,
    /// The compass.
    pub compass: CompassNoise,
    /// The camera.
    pub camera: ImageNoise,
    /// Drive and odometry.
    pub motion: MotionNoise,
    /// Reception of the radio.
    pub radio: RadioNoise,
}

impl Profile {
    /// Noise model of the distance sensor of this kind and name.
    pub fn range(&self, kind: RangeKind, name: &str) -> RangeNoise {
        let mut range = self.ranges[kind as usize];
        for (accessor, value) in self.sensors.get(name).into_iter().flatten() {
            *accessor(&mut range) = *value;
        }
        range
    }
}
