//! Switches of the sensors: a switched-off sensor detects nothing until it is switched on again, and a stuck sensor
//! repeats a reading.
//!
//! `docs/window.md` lists the value that each switched-off sensor returns to its program; these values are our choice.

use std::collections::{BTreeMap, BTreeSet};

use crate::sensor::Reading;
use crate::spec::{LIDAR, RobiSpec};

/// Name of a robot's camera among its sensors.
pub const CAMERA: &str = "CAMERA";

/// A sensor of a robot: its kind, and its index within the kind in the order of the robi.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SensorId {
    /// A PSD or another range sensor; the PSDs come first.
    Range(usize),
    /// An infrared proximity sensor.
    Infrared(usize),
    /// The laser scanner.
    Lidar,
    /// A bumper.
    Bumper(usize),
    /// The compass.
    Compass,
    /// The encoder of a motor.
    Encoder(usize),
    /// The camera.
    Camera,
}

/// Switched-off and stuck sensors of a robot; none at the start.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    off: BTreeSet<SensorId>,
    /// Range sensors that are stuck, by their index, with the reading that they repeat.
    stuck: BTreeMap<usize, Reading>,
}

impl Switches {
    /// Returns true unless `sensor` is switched off.
    pub fn is_on(&self, sensor: SensorId) -> bool {
        self.off.is_empty() || !self.off.contains(&sensor)
    }

    /// The reading that range sensor `index` repeats, if it is stuck.
    pub fn stuck_reading(&self, index: usize) -> Option<Reading> {
        if self.stuck.is_empty() { None } else { self.stuck.get(&index).copied() }
    }

    /// Makes range sensor `index` repeat `reading`, or measure again if `reading` is `None`.
    pub fn set_stuck(&mut self, index: usize, reading: Option<Reading>) {
        match reading {
            Some(reading) => drop(self.stuck.insert(index, reading)),
            None => drop(self.stuck.remove(&index)),
        }
    }

    /// Switches `sensor` on or off.
    pub fn set(&mut self, sensor: SensorId, is_on: bool) {
        if is_on {
            self.off.remove(&sensor);
        } else {
            self.off.insert(sensor);
        }
    }
}

/// Sensors of a robot of this type with their names, grouped by kind.
pub fn sensors(spec: &RobiSpec) -> impl Iterator<Item = (&str, SensorId)> {
    let ranges = spec.psds.iter().map(|psd| &*psd.name).chain(spec.ranges.iter().map(|range| &*range.name));
    let ranges = ranges.enumerate().map(|(index, name)| (name, SensorId::Range(index)));
    let lidar = spec.lidar.iter().map(|_| (LIDAR, SensorId::Lidar));
    let infrareds = spec.infrareds.iter().enumerate().map(|(index, it)| (&*it.name, SensorId::Infrared(index)));
    let bumpers = spec.bumpers.iter().enumerate().map(|(index, it)| (&*it.name, SensorId::Bumper(index)));
    let compass = spec.compass.iter().map(|it| (&*it.name, SensorId::Compass));
    let encoders = spec.drive.motors.iter().enumerate();
    let encoders = encoders.filter_map(|(index, motor)| Some((motor.encoder.as_deref()?, SensorId::Encoder(index))));
    let camera = spec.camera.iter().map(|_| (CAMERA, SensorId::Camera));
    ranges.chain(infrareds).chain(lidar).chain(bumpers).chain(compass).chain(encoders).chain(camera)
}
