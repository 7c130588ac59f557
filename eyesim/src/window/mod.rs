//! The window of a run: shows the run to pages and carries out their commands.
//!
//! [`scene`], [`snapshot`], [`detail`] and `layer` convert a run that rests between two slots to the protocol of
//! `sim_view`. [`feed`] reports events, and [`driver`] advances the run as its pages request. Watching draws no random
//! numbers and does not change the run.
#![forbid(unsafe_code)]

mod action;
pub mod control;
pub mod control_panel;
pub mod detail;
mod device;
pub mod driver;
pub mod feed;
mod layer;
pub mod recording;
pub mod scene;
pub mod show;
pub mod snapshot;
mod surface;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sim_core::pose::Pose;
use sim_view::protocol;

/// Data URL of a PNG file.
fn png_url(file: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(file))
}

/// Pose in the plane in the page's protocol.
fn planar(pose: &Pose) -> protocol::Pose {
    protocol::Pose { x_m: pose.position.x, y_m: pose.position.y, phi_rad: pose.heading.radians() }
}
