//! Layers that programs show in the window and in recordings: grids, points and lines.
//!
//! A layer is a copy of a program's data with the pose of its frame.

use sim_core::pose::Pose;
use sim_core::time::Time;

/// A layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Virtual time at which it was shown.
    pub at: Time,
    /// Pose of the layer's frame in the world.
    pub world_from_frame: Pose,
    /// Its content.
    pub shape: Shape,
}

/// Content of a layer, in the layer's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A grid.
    Grid(Grid),
    /// Points, m.
    Points(Vec<[f64; 3]>),
    /// A line through points, m.
    Line(Vec<[f64; 3]>),
}

/// A grid of square cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Corner with the smallest coordinates, m.
    pub corner: [f64; 2],
    /// Side of a cell, m.
    pub cell: f64,
    /// Number of cells along x.
    pub columns: u32,
    /// Number of cells along y.
    pub rows: u32,
    /// The cells, row by row from the smallest y: 0 (free) to 100 (occupied), or 255 (unknown).
    pub cells: Vec<u8>,
}
