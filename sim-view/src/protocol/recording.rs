//! A run that is over, as a page plays it.

use serde::{Deserialize, Serialize};

use super::{Event, Scene, Standing};

/// A recorded run: `GET /recording.json` of a replay, and the text of the element `recording` in a page that is one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Recording {
    /// The world and all bodies that have ever been in it.
    pub scene: Scene,
    /// Simulated time at the end.
    pub duration_s: f64,
    /// Why the run ended, in words.
    pub why: String,
    /// Digest of the run; empty where the trace is not complete.
    pub digest: String,
    /// What the user should know: that the trace is cut off, or that the scene's files have changed since.
    pub remarks: Vec<String>,
    /// One for each robot of the scene, in the same order.
    pub robots: Vec<Life>,
    /// One for each movable object of the scene, in the same order.
    pub objects: Vec<Track>,
    /// What happened, in order.
    pub events: Vec<Event>,
    /// How many events are left out, of kinds that come too often to be kept.
    pub events_left_out: u32,
}

/// What became of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Life {
    /// Where it was.
    pub track: Track,
    /// How its program stood, from when on; in order of time.
    pub standings: Vec<Stood>,
    /// The texts on its display, from when on; in order of time.
    pub lcd: Vec<Shown>,
}

/// Where a body was. Thinned: between two points it is on the straight line and turns evenly, to within 2 mm and 1 degree.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Track {
    /// Times of the points, in order: two at the same time where the body was put elsewhere. Before the first point the body is
    /// not in the world; after the last it stays there.
    pub t_s: Vec<f64>,
    /// World coordinates to the right, one for each time.
    pub x_m: Vec<f64>,
    /// World coordinates upwards, one for each time.
    pub y_m: Vec<f64>,
    /// Headings, counter-clockwise from x, whole turns in them, one for each time.
    pub phi_rad: Vec<f64>,
    /// When it was taken out of the world; none if it never was.
    pub until_s: Option<f64>,
}

/// How a program stood.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Stood {
    /// From when on.
    pub t_s: f64,
    /// How.
    pub standing: Standing,
    /// Why; empty where there is nothing to say.
    pub why: String,
}

/// What a display showed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Shown {
    /// From when on.
    pub t_s: f64,
    /// Its lines of text, the menu last.
    pub lines: Vec<String>,
}
