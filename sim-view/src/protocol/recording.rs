//! A finished run that a page replays.

use serde::{Deserialize, Serialize};

use super::{Event, Scene, Standing};

/// A recorded run: `GET /recording.json` of a replay, and the text of the element `recording` in a single-file page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Recording {
    /// The world and all bodies that were in it at any time.
    pub scene: Scene,
    /// Simulated time at the end.
    pub duration_s: f64,
    /// Reason why the run ended, in words.
    pub why: String,
    /// Digest of the run; empty if the trace is not complete.
    pub digest: String,
    /// Notices for the user: the trace is truncated, or the scene's files have changed since.
    pub remarks: Vec<String>,
    /// Histories of the robots, in the order of the scene.
    pub robots: Vec<RobotHistory>,
    /// Tracks of the movable objects, in the order of the scene.
    pub objects: Vec<Track>,
    /// Events in order.
    pub events: Vec<Event>,
    /// Number of events omitted because their kinds are too frequent.
    pub events_left_out: u32,
}

/// History of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RobotHistory {
    /// Its poses.
    pub track: Track,
    /// Its postures; empty for a robot that has no legs and is not in the water.
    pub postures: Postures,
    /// States of its program, in order of time.
    pub standings: Vec<StandingChange>,
    /// Texts on its display, in order of time.
    pub lcd: Vec<DisplayChange>,
}

/// Poses of a body over time, thinned: linear interpolation between two points is accurate to 2 mm and 1 degree.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Track {
    /// Times of the points, in order; two points have the same time where the body was placed elsewhere. Before the
    /// first point the body is not in the world; after the last it stays there.
    pub t_s: Vec<f64>,
    /// World x coordinates, one for each time.
    pub x_m: Vec<f64>,
    /// World y coordinates, one for each time.
    pub y_m: Vec<f64>,
    /// Headings, counter-clockwise from x, including whole turns, one for each time.
    pub phi_rad: Vec<f64>,
    /// Time of its removal from the world; none if it was not removed.
    pub until_s: Option<f64>,
}

/// Postures of a robot over time, at most 50 a second.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Postures {
    /// Times, in order. Before the first, the robot is at rest in its standing posture.
    pub t_s: Vec<f64>,
    /// Heights of the robot's frame above the floor's plane, one for each time.
    pub lift_m: Vec<f64>,
    /// Angles of all joints at each time, one time after the other.
    pub joints_rad: Vec<f64>,
}

/// State of a program from a time on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct StandingChange {
    /// Time at which the state begins.
    pub t_s: f64,
    /// The state.
    pub standing: Standing,
    /// Reason; empty if there is none.
    pub why: String,
}

/// Contents of a display from a time on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct DisplayChange {
    /// Time at which the contents appear.
    pub t_s: f64,
    /// The lines of text, the menu last.
    pub lines: Vec<String>,
}
