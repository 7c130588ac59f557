//! Protocol between server and page: JSON texts over a WebSocket, documented in `docs/window.md`.
//!
//! Lengths are in metres, angles in radians, times in seconds, each with its unit in its name. In the world, seen from
//! above, x points to the right and y to the top; z is the height above the floor. Colours are red, green and blue from
//! 0 to 255. The page's types (`page/src/protocol/`) are generated from these types by the tests of this crate with
//! `INSTA_UPDATE=always`.

mod action;
mod event;
mod layer;
mod recording;
mod request;
mod scene;
mod state;
#[cfg(test)]
mod typescript;

pub use action::Action;
pub use event::{Event, Events};
pub use layer::{Layer, LayerContent};
pub use recording::{DisplayChange, Postures, Recording, RobotHistory, StandingChange, Track};
pub use request::{Command, Request, Seed};
pub use scene::{
    AddableTypes, Attachment, Body, Camera, Floor, Ground, Image, Lcd, Light, Link, Material, Mesh, Object, Part,
    Point, Robot, Scene, Sensor, SensorKind, Sky, Spot,
};
pub use state::{
    Beam, CheckState, CheckVerdict, Detail, MotionPiece, ObjectState, Parameter, Picture, Pose, Reading, RobotState,
    RunState, Scan, SensorState, Snapshot, Standing,
};

use serde::{Deserialize, Serialize};

/// Version of the protocol: the server requests a page of another version to reload.
pub const PROTOCOL: u32 = 2;

/// Message from the server to a page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Message {
    /// The first message: the answer to [`Request::Hello`].
    Welcome(Welcome),
    /// The scene: after the welcome, and whenever a run starts or its bodies change.
    Scene(Box<Scene>),
    /// Current state of the run. A slow page gets fewer snapshots.
    Snapshot(Snapshot),
    /// Details of the robot that the page has selected.
    Detail(Box<Detail>),
    /// A layer that the program of the selected robot shows. A slow page gets fewer of them.
    Layer(Layer),
    /// Events since the last message of this kind.
    Events(Events),
    /// Progress of building the programs.
    Build(Build),
    /// Outcome of a command of this page.
    Answer(Answer),
}

/// Version of the server, and the rights of the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Welcome {
    /// Version of the protocol: [`PROTOCOL`].
    pub protocol: u32,
    /// Version of the simulator.
    pub version: String,
    /// Name of the scene.
    pub title: String,
    /// False for a page that only watches: its commands are refused.
    pub may_act: bool,
}

/// Progress of building the programs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "state", rename_all = "snake_case")]
pub enum Build {
    /// Programs are being built; the run starts afterwards.
    Running,
    /// All programs are built.
    Done,
    /// The build failed; the previous run continues unchanged.
    Failed {
        /// Output of the compiler.
        output: String,
    },
}

/// Outcome of a command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Answer {
    /// Number that the page gave the command.
    pub number: u32,
    /// Reason for the refusal; `None` if the command was carried out.
    pub refused: Option<String>,
}
