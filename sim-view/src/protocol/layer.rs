//! Layers that the programs of robots show.

use serde::{Deserialize, Serialize};

use super::Pose;

/// A layer that the program of a robot shows. It replaces an earlier layer of the same name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Layer {
    /// Number of the run.
    pub run: u32,
    /// Number of the robot.
    pub robot: u32,
    /// Name of the layer.
    pub name: String,
    /// Virtual time at which the program showed it.
    pub t_s: f64,
    /// World pose of the frame of its coordinates.
    pub frame: Pose,
    /// Its content.
    pub content: LayerContent,
}

/// Content of a layer. Numbers are little endian, in base64.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LayerContent {
    /// A grid of square cells.
    Grid {
        /// Corner with the smallest coordinates.
        corner_m: [f64; 2],
        /// Side of a cell.
        cell_m: f64,
        /// Number of cells along x.
        columns: u32,
        /// Number of cells along y.
        rows: u32,
        /// A byte for each cell, row by row from the smallest y: 0 (free) to 100 (occupied), or 255 (unknown).
        cells: String,
    },
    /// Points.
    Points {
        /// x, y and z of each point in metres, `f32`.
        positions: String,
    },
    /// A line through points.
    Line {
        /// x, y and z of each point in metres, `f32`.
        positions: String,
    },
}
