//! Layers of the simulator's window, such as the map or the path that a program has computed.

use robios_sys::ByteSlice;
use robios_sys::support::layer::{MAX_CELLS, MAX_POINTS, ODOMETRY, WORLD};

use crate::device::Device;
use crate::error::{Error, Result, checked};
use crate::robot::{Robot, support};
use crate::unit::Length;

/// Shows grids, points and lines in the window and in recordings. Real robots have no such layers.
///
/// A layer belongs to the robot and has a name of 1 to 32 bytes; it replaces the robot's layer of the same name. A
/// robot has at most 16 layers. The data are copied. The simulation is not affected, and no virtual time passes.
///
/// ```
/// use robios_api::prelude::*;
/// use robios_api::{LayerFrame, LayerGrid};
///
/// fn show(robot: &Robot) -> Result {
///     let cells = [0, 0, 100, LayerGrid::UNKNOWN];
///     let grid = LayerGrid { corner: [Length::ZERO; 2], cell: 50.millimetres(), columns: 2, cells: &cells };
///     robot.layers().grid("map", LayerFrame::Odometry, &grid)?;
///     robot.layers().line("path", LayerFrame::Odometry, &[[0.0, 0.0], [0.5, 0.2]])
/// }
/// robios_api::fake::Fake::new().run(show).expect_finished();
/// ```
#[derive(Debug)]
pub struct Layers<'r>(pub(crate) &'r Robot);

/// Frame of a layer's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerFrame {
    /// The frame of the world.
    World,
    /// The frame of the robot's odometry. It is fixed in the world at the robot's start, and again whenever the program
    /// sets the odometry.
    Odometry,
}

/// A grid of square cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerGrid<'a> {
    /// Corner with the smallest x and y.
    pub corner: [Length; 2],
    /// Side of a cell.
    pub cell: Length,
    /// Number of cells along x.
    pub columns: usize,
    /// The cells, row by row from the smallest y, each row from the smallest x: 0 (free) to 100 (occupied), or
    /// [`Self::UNKNOWN`]; at most 1,048,576.
    pub cells: &'a [u8],
}

impl LayerGrid<'_> {
    /// Value of an unknown cell.
    pub const UNKNOWN: u8 = robios_sys::support::layer::UNKNOWN;

    /// Value of a cell that is occupied with a probability, which is limited to [0, 1]; [`Self::UNKNOWN`] for NaN.
    pub fn cell_of(probability: f64) -> u8 {
        if probability.is_nan() { Self::UNKNOWN } else { (100.0 * probability.clamp(0.0, 1.0)).round() as u8 }
    }
}

/// A point of a layer in m: `[x, y]`, or `[x, y, z]` with the height z.
pub trait LayerPoint: Copy + private::Sealed {
    /// Number of coordinates.
    #[doc(hidden)]
    const DIMENSIONS: i32;
    /// The coordinates.
    #[doc(hidden)]
    fn coordinates(&self) -> &[f64];
}

mod private {
    pub trait Sealed {}
    impl Sealed for [f64; 2] {}
    impl Sealed for [f64; 3] {}
}

impl LayerPoint for [f64; 2] {
    const DIMENSIONS: i32 = 2;
    fn coordinates(&self) -> &[f64] {
        self
    }
}

impl LayerPoint for [f64; 3] {
    const DIMENSIONS: i32 = 3;
    fn coordinates(&self) -> &[f64] {
        self
    }
}

impl Layers<'_> {
    /// Shows a grid.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if a row is incomplete or there are too many cells; [`Error::Refused`] if another limit is
    /// exceeded.
    #[track_caller]
    pub fn grid(&self, name: &str, frame: LayerFrame, grid: &LayerGrid<'_>) -> Result {
        let LayerGrid { corner, cell, columns, cells } = *grid;
        if columns == 0 || cells.is_empty() || cells.len() % columns != 0 || cells.len() > MAX_CELLS {
            let value = format!("{} cells in rows of {columns}", cells.len());
            return Err(Error::OutOfRange { what: "grid", value, accepted: "whole rows, up to 1048576 cells" });
        }
        let [x, y, cell] = [corner[0], corner[1], cell].map(Length::as_metres);
        let (columns, rows) = (columns as i32, (cells.len() / columns) as i32);
        let [name, cells] = [ByteSlice::from(name), ByteSlice::from(cells)];
        let code = support!(self.0, show_grid(name, frame.number(), x, y, cell, columns, rows, cells));
        checked("show_grid", Device::Layers, code)
    }

    /// Shows points.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for more than 65,536 points; [`Error::Refused`] for a coordinate that is NaN or beyond 1e6
    /// m, or an invalid name.
    #[track_caller]
    pub fn points<P: LayerPoint>(&self, name: &str, frame: LayerFrame, points: &[P]) -> Result {
        let (count, bytes) = coordinates(points)?;
        let [name, bytes] = [ByteSlice::from(name), ByteSlice::from(&bytes[..])];
        let code = support!(self.0, show_points(name, frame.number(), P::DIMENSIONS, count, bytes));
        checked("show_points", Device::Layers, code)
    }

    /// Shows a line through points, such as a path, or a profile of the ground.
    ///
    /// # Errors
    /// See [`Self::points`].
    #[track_caller]
    pub fn line<P: LayerPoint>(&self, name: &str, frame: LayerFrame, points: &[P]) -> Result {
        let (count, bytes) = coordinates(points)?;
        let [name, bytes] = [ByteSlice::from(name), ByteSlice::from(&bytes[..])];
        let code = support!(self.0, show_line(name, frame.number(), P::DIMENSIONS, count, bytes));
        checked("show_line", Device::Layers, code)
    }
}

impl LayerFrame {
    fn number(self) -> i32 {
        match self {
            Self::World => WORLD,
            Self::Odometry => ODOMETRY,
        }
    }
}

/// Number and bytes of points.
fn coordinates<P: LayerPoint>(points: &[P]) -> Result<(i32, Vec<u8>)> {
    if points.len() > MAX_POINTS {
        let value = points.len().to_string();
        return Err(Error::OutOfRange { what: "number of points", value, accepted: "0 to 65536" });
    }
    let bytes = points.iter().flat_map(|point| point.coordinates()).flat_map(|number| number.to_le_bytes());
    Ok((points.len() as i32, bytes.collect()))
}
