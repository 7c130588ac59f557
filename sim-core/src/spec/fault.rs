//! Injected faults of a scene. See `docs/faults.md`.

use crate::RobotId;
use crate::spec::Span;

/// A fault of a robot, at a given instant or at random instants.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultSpec {
    /// Name, unique in its scene; if empty, [`FaultSpec::title`] makes one. The title is the key of the fault's random
    /// numbers.
    pub name: String,
    /// The robot.
    pub robot: RobotId,
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Instants at which it begins.
    pub time: FaultTime,
    /// Its duration in seconds; `None` for a fault that lasts until the end of the run.
    pub duration: Option<f64>,
    /// Location of its table in the file.
    pub span: Span,
}

impl Default for FaultSpec {
    fn default() -> Self {
        let (name, kind, time) = (String::new(), FaultKind::default(), FaultTime::default());
        Self { name, robot: RobotId(1), kind, time, duration: None, span: Span::default() }
    }
}

impl FaultSpec {
    /// Its name, or the word for its kind.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { self.kind.word() } else { &self.name }
    }
}

/// Instants at which a fault begins, in seconds of virtual time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultTime {
    /// Once, with a probability.
    Once {
        /// The instant.
        at: f64,
        /// Probability that the fault occurs at all.
        probability: f64,
    },
    /// Repeatedly, as a Poisson process that pauses while the fault lasts.
    Random {
        /// Mean rate per minute while the fault is absent; positive.
        per_minute: f64,
    },
}

impl Default for FaultTime {
    fn default() -> Self {
        Self::Once { at: 0.0, probability: 1.0 }
    }
}

/// Kind of a fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum FaultKind {
    /// The robot's program ends, its motors stop, its radio is silent; the body stays.
    #[default]
    Dies,
    /// A sensor detects nothing.
    SensorOff {
        /// Name of the sensor.
        sensor: String,
    },
    /// A range sensor repeats the reading that it has when the fault begins.
    SensorStuck {
        /// Name of the sensor.
        sensor: String,
    },
    /// Wheels slip.
    Slip {
        /// Wheels that slip.
        wheels: SlippingWheels,
        /// Fraction of a wheel's distance that is lost.
        share: f64,
    },
    /// The radio neither sends nor receives.
    RadioOff,
    /// A parameter of the noise models has another value.
    Noise {
        /// Table and key of the noise profile, such as `psd.sigma_mm`.
        parameter: String,
        /// Value in the profile's unit.
        value: f64,
    },
}

impl FaultKind {
    /// Word for the kind in files.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Dies => "dies",
            Self::SensorOff { .. } => "sensor_off",
            Self::SensorStuck { .. } => "sensor_stuck",
            Self::Slip { .. } => "slip",
            Self::RadioOff => "radio_off",
            Self::Noise { .. } => "noise",
        }
    }
}

/// Wheels that slip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlippingWheels {
    /// All wheels.
    #[default]
    All,
    /// Wheels on the left.
    Left,
    /// Wheels on the right.
    Right,
}
