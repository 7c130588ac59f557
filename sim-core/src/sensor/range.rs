use super::{Echo, Sonar};
use crate::pose::Pose3;

/// What a range sensor makes of the surfaces before it.
#[derive(Clone, Debug, PartialEq)]
pub enum RangeModel {
    /// An infrared triangulation sensor: the distance along one ray, whatever the surface. Source: Koestler & Bräunl,
    /// section 4.1.
    Psd {
        /// How far it sees, m.
        range: f64,
    },
    /// A laser range finder: see [`Echo::time_of_flight`].
    Laser(Echo),
    /// A narrow ultrasonic sensor: see [`Echo::time_of_flight`].
    Ultrasonic(Echo),
    /// A sensor of reflected light: see [`Echo::reflectance`].
    Reflectance(Echo),
    /// An ultrasonic sensor with a beam.
    Sonar(Sonar),
}

/// A range sensor on a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeSensor {
    /// The sensor's frame, x along its line of sight, in the frame of what bears it.
    pub mount: Pose3,
    /// What bears it: a link, by its place in the robot's list of links; `None` for the body.
    pub link: Option<usize>,
    /// What it measures.
    pub model: RangeModel,
}

/// What a range sensor measures at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The distance that it reads, m; `None` where it reads none. Laser, ultrasonic and reflectance sensors read their
    /// greatest distance then.
    pub distance: Option<f64>,
    /// What the distance was made of: the signal of a reflectance sensor, 1/m; the energy of a sonar's echo, of which
    /// a perfect reflector 1 m ahead returns 1; for the others 1 with an echo and 0 without.
    pub signal: f64,
}
