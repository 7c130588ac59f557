//! What changes with every slot.

use serde::{Deserialize, Serialize};

/// A run at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Snapshot {
    /// Number of the run, as in the scene.
    pub run: u32,
    /// Simulated time: the start of a slot.
    pub t_s: f64,
    /// How the run stands.
    pub state: RunState,
    /// The speed that was asked for: simulated seconds for each second of real time; none for as fast as possible.
    pub speed: Option<f64>,
    /// Simulated seconds for each second of real time, as they are.
    pub rate: f64,
    /// All robots that are in the world, in order of their numbers.
    pub robots: Vec<RobotState>,
    /// All movable objects that are in the world, in order of their numbers.
    pub objects: Vec<ObjectState>,
    /// What the range sensors would measure now, without errors.
    pub beams: Vec<Beam>,
}

/// How a run stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "is", rename_all = "snake_case")]
pub enum RunState {
    /// It goes on.
    Running,
    /// It is paused.
    Paused,
    /// Nothing will happen before somebody does something, such as press a key.
    Idle,
    /// It is over.
    Ended {
        /// Why, in words.
        why: String,
        /// Its digest.
        digest: String,
    },
}

/// A robot at one instant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RobotState {
    /// Its number.
    pub id: u32,
    /// How it moves from the snapshot's time to the slot's end; the first leg holds at the snapshot's time.
    pub legs: Vec<Leg>,
    /// How its program stands.
    pub standing: Standing,
    /// Its virtual time.
    pub now_s: f64,
    /// What its program waits for, or why it ended; empty where there is nothing to say.
    pub why: String,
    /// Whether its wheels stall.
    pub is_stalled: bool,
}

/// How a program stands.
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

/// Motion at constant rates, in the body's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Leg {
    /// When it starts.
    pub t_s: f64,
    /// Where it starts: the pose of the robot's frame.
    pub from: Pose,
    /// Speed ahead.
    pub v_m_per_s: f64,
    /// Speed to the left.
    pub left_m_per_s: f64,
    /// Turning speed.
    pub omega_rad_per_s: f64,
    /// How long it lasts; then the body rests.
    pub lasts_s: f64,
}

/// A pose in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Pose {
    /// World coordinate to the right.
    pub x_m: f64,
    /// World coordinate upwards.
    pub y_m: f64,
    /// Heading, counter-clockwise from x; whole turns are in it.
    pub phi_rad: f64,
}

/// A movable object at one instant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ObjectState {
    /// Its number.
    pub id: u32,
    /// Where it is.
    pub pose: Pose,
}

/// A beam of a range sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Beam {
    /// Number of the robot.
    pub robot: u32,
    /// Place of the sensor in [`Robot::sensors`](super::Robot::sensors).
    pub sensor: u32,
    /// Where it begins.
    pub from_m: [f64; 3],
    /// Where it ends: at the point that is measured, else at the end of the range.
    pub to_m: [f64; 3],
    /// Whether it has met something.
    pub is_hit: bool,
}

/// More of one robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Detail {
    /// Number of the run.
    pub run: u32,
    /// Number of the robot.
    pub robot: u32,
    /// Simulated time.
    pub t_s: f64,
    /// Where it is.
    pub pose: Pose,
    /// Where it believes to be.
    pub odometry: Pose,
    /// The display; none while it shows what it showed in the detail before.
    pub lcd: Option<Picture>,
    /// The lines of text on the display, the menu last.
    pub lcd_text: Vec<String>,
    /// What its camera sees now, without errors, if the page wants it.
    pub camera: Option<Picture>,
    /// What its program has read last of each device, and what it commanded.
    pub readings: Vec<Reading>,
    /// Its sensors, in the order of the scene.
    pub sensors: Vec<SensorState>,
    /// Its error models.
    pub noise: Vec<Parameter>,
    /// The last scan of its laser scanner.
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

/// What was read of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Reading {
    /// Name of the device, or of what is read: `PSD_FRONT`, `odometry x`.
    pub name: String,
    /// Its value; none when there was nothing to measure.
    pub value: Option<f64>,
    /// Unit of the value; empty for a count.
    pub unit: String,
    /// When it was read.
    pub at_s: f64,
}

/// Whether a sensor is on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct SensorState {
    /// Its name.
    pub name: String,
    /// Off or on.
    pub is_on: bool,
}

/// A number of an error model that can be set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Parameter {
    /// Table and key of the noise profile, such as `psd.sigma_mm`.
    pub name: String,
    /// What it is, in a few words.
    pub what: String,
    /// Its value.
    pub value: f64,
    /// Least and greatest value.
    pub range: [f64; 2],
    /// Unit of the value; empty for a share.
    pub unit: String,
}

/// A scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Scan {
    /// Where the scanner is, in the world.
    pub from_m: [f64; 3],
    /// The points that it would measure now, in the world.
    pub points_m: Vec<[f64; 3]>,
}
