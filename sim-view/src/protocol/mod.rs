//! What server and page say to each other: JSON texts over a WebSocket, documented in `docs/window.md`.
//!
//! Lengths in metres, angles in radians, times in seconds, each with its unit in its name; world x to the right, y upwards, z
//! above the floor. Colours are red, green and blue from 0 to 255. The page's types are made from these
//! (`page/src/protocol/`) by the tests of this crate with `UPDATE_TYPES=1`.

mod action;
mod event;
mod recording;
mod request;
mod scene;
mod state;
#[cfg(test)]
mod typescript;

pub use action::Action;
pub use event::{Event, Events};
pub use recording::{Life, Recording, Shown, Stood, Track};
pub use request::{Command, Request, Seed};
pub use scene::{
    Body, Camera, Floor, Ground, Image, Lcd, Light, Material, Mesh, Object, Part, Place, Point, Robot, Scene, Sensor,
    SensorKind, Sky, Spot, Workshop,
};
pub use state::{
    Beam, Detail, Leg, ObjectState, Parameter, Picture, Pose, Reading, RobotState, RunState, Scan, SensorState,
    Snapshot, Standing,
};

use serde::{Deserialize, Serialize};

/// Version of the protocol: a page of another version is told to load itself again.
pub const PROTOCOL: u32 = 1;

/// What the server says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Message {
    /// The first message: the answer to [`Request::Hello`].
    Welcome(Welcome),
    /// What there is to see: after the welcome, and whenever a run starts or its bodies change.
    Scene(Box<Scene>),
    /// Where everything is now. A page that is slow gets fewer.
    Snapshot(Snapshot),
    /// More of the robot that the page has chosen.
    Detail(Box<Detail>),
    /// What has happened since the last ones.
    Events(Events),
    /// How the building of programs goes.
    Build(Build),
    /// What became of a command of this page.
    Answer(Answer),
}

/// Who speaks to the page, and what it may do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Welcome {
    /// [`PROTOCOL`].
    pub protocol: u32,
    /// Version of the simulator.
    pub version: String,
    /// Name of the scene.
    pub title: String,
    /// False for a page that only watches: its commands are refused.
    pub may_act: bool,
}

/// How the building of programs goes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum Build {
    /// Programs are being built; the run starts after it.
    Running,
    /// All is built.
    Done,
    /// It failed: what was run before stays as it is.
    Failed {
        /// What the compiler said.
        output: String,
    },
}

/// What became of a command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Answer {
    /// The page's number of the command.
    pub number: u32,
    /// Why it was refused; none when it was carried out.
    pub refused: Option<String>,
}
