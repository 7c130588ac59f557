//! State that changes with every slot.

use serde::{Deserialize, Serialize};

/// A run at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Snapshot {
    /// Number of the run, as in the scene.
    pub run: u32,
    /// Simulated time: the start of a slot.
    pub t_s: f64,
    /// State of the run.
    pub state: RunState,
    /// Requested speed: simulated seconds for each second of real time; none for as fast as possible.
    pub speed: Option<f64>,
    /// Measured speed: simulated seconds for each second of real time.
    pub rate: f64,
    /// All robots that are in the world, in order of their numbers.
    pub robots: Vec<RobotState>,
    /// All movable objects that are in the world, in order of their numbers.
    pub objects: Vec<ObjectState>,
    /// Noise-free beams of the range and infrared sensors.
    pub beams: Vec<Beam>,
    /// The checks of the scene, in the order of the file.
    pub checks: Vec<CheckState>,
}

/// A check of the scene at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct CheckState {
    /// Its name.
    pub name: String,
    /// Its verdict so far.
    pub verdict: CheckVerdict,
    /// The verdict in words.
    pub text: String,
    /// Current value of a metric that changes over time; none for other checks.
    pub value: Option<f64>,
}

/// Verdict of a check so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum CheckVerdict {
    /// The verdict depends on the rest of the run.
    Open,
    /// The check is met, whatever the rest of the run.
    Met,
    /// The check can no longer be met.
    Failed,
}

/// State of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RunState {
    /// The run advances.
    Running,
    /// The run is paused.
    Paused,
    /// Nothing will happen before a user intervention, such as a key press.
    Idle,
    /// The run is over.
    Ended {
        /// Reason, in words.
        why: String,
        /// Digest of the run.
        digest: String,
    },
}

/// A robot at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RobotState {
    /// Its number.
    pub id: u32,
    /// Pieces of motion until the slot's end, in order of time; the first covers the snapshot's time.
    pub motion: Vec<MotionPiece>,
    /// Height of its frame above the floor's plane.
    pub lift_m: f64,
    /// Angles of its joints, one for each joint of [`Robot::links`](super::Robot::links).
    pub joints_rad: Vec<f64>,
    /// State of its program.
    pub standing: Standing,
    /// Its virtual time.
    pub now_s: f64,
    /// Reason why its program waits or has ended; empty if there is none.
    pub why: String,
    /// True if the wheels are stalled.
    pub is_stalled: bool,
}

/// State of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "the names say it")]
pub enum Standing {
    Running,
    Waiting,
    Finished,
    Failed,
    NoProgram,
}

/// Piece of motion of a body, with constant rates in the body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MotionPiece {
    /// Start time.
    pub t_s: f64,
    /// Pose of the robot's frame at the start.
    pub from: Pose,
    /// Forward speed.
    pub v_m_per_s: f64,
    /// Speed to the left.
    pub left_m_per_s: f64,
    /// Turning speed.
    pub omega_rad_per_s: f64,
    /// Duration; the body is at rest afterwards.
    pub lasts_s: f64,
}

/// A pose in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Pose {
    /// World x coordinate.
    pub x_m: f64,
    /// World y coordinate.
    pub y_m: f64,
    /// Heading, counter-clockwise from x, including whole turns.
    pub phi_rad: f64,
}

/// A movable object at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ObjectState {
    /// Its number.
    pub id: u32,
    /// Its pose.
    pub pose: Pose,
}

/// A beam of a range or infrared sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Beam {
    /// Number of the robot.
    pub robot: u32,
    /// Index of the sensor in [`Robot::sensors`](super::Robot::sensors).
    pub sensor: u32,
    /// Origin of the beam.
    pub from_m: [f64; 3],
    /// End of the beam: the measured point, or the end of the range if there is no hit.
    pub to_m: [f64; 3],
    /// True if the beam hits something within its range.
    pub is_hit: bool,
}

/// Details of one robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Detail {
    /// Number of the run.
    pub run: u32,
    /// Number of the robot.
    pub robot: u32,
    /// Simulated time.
    pub t_s: f64,
    /// True pose.
    pub pose: Pose,
    /// Pose according to its odometry.
    pub odometry: Pose,
    /// Picture of the display; none if unchanged since the previous detail.
    pub lcd: Option<Picture>,
    /// The lines of text on the display, the menu last.
    pub lcd_text: Vec<String>,
    /// Noise-free picture of its camera, if the page requests it.
    pub camera: Option<Picture>,
    /// Latest readings of its devices and latest commands of its program.
    pub readings: Vec<Reading>,
    /// Its sensors, in the order of the scene.
    pub sensors: Vec<SensorState>,
    /// Parameters of its noise models.
    pub noise: Vec<Parameter>,
    /// Scan of its laser scanner.
    pub scan: Option<Scan>,
}

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Picture {
    /// Its PNG as a `data:` URL.
    pub url: String,
    /// Width and height.
    pub size_px: [u32; 2],
}

/// Latest reading of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Reading {
    /// Name of the device or of the quantity: `PSD_FRONT`, `odometry x`.
    pub name: String,
    /// Its value; none when there was nothing to measure.
    pub value: Option<f64>,
    /// Unit of the value; empty for a count.
    pub unit: String,
    /// Virtual time of the reading.
    pub at_s: f64,
}

/// State of a sensor.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct SensorState {
    /// Its name.
    pub name: String,
    /// True if the sensor is switched on.
    pub is_on: bool,
}

/// Parameter of a noise model that can be set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Parameter {
    /// Table and key of the noise profile, such as `psd.sigma_mm`.
    pub name: String,
    /// Short description.
    pub what: String,
    /// Its value.
    pub value: f64,
    /// Minimum and maximum value.
    pub range: [f64; 2],
    /// Unit of the value; empty for a ratio.
    pub unit: String,
}

/// A scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Scan {
    /// Position of the scanner in the world frame.
    pub from_m: [f64; 3],
    /// Points that it would measure now, in the world frame.
    pub points_m: Vec<[f64; 3]>,
}
