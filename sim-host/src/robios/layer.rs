//! Layers that a robot's program shows: the calls `show_grid`, `show_points` and `show_line`.
//!
//! Limits and the meaning of cells are those of [`robios_sys::support::layer`] (our choice; cells as in
//! `nav_msgs/OccupancyGrid` of ROS). Nothing in the simulation depends on a layer, and layers are not events of the
//! run.

use std::collections::BTreeMap;
use std::sync::Arc;

use robios_sys::SupportCall;
use robios_sys::support::layer::{
    MAX_CELLS, MAX_COORDINATE, MAX_LAYERS, MAX_NAME, MAX_POINTS, OCCUPIED, ODOMETRY, UNKNOWN, WORLD,
};
use sim_core::pose::Pose;

use super::robot::Robot;
use crate::record::layer::{Grid, Layer, Shape};

/// The layers of a robot, by name.
pub type Layers = BTreeMap<String, Arc<Layer>>;

/// Name and frame of a layer, as the program passes them.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    /// Its name.
    pub name: Option<&'a [u8]>,
    /// Number of its frame.
    pub frame: i32,
}

/// Size and position of a grid, as the program passes them.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Corner with the smallest coordinates, m.
    pub corner: [f64; 2],
    /// Side of a cell, m.
    pub cell: f64,
    /// Number of cells along x and along y.
    pub size: [i32; 2],
}

/// Reason why a layer is not shown.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayerError {
    /// The name is missing or too long.
    #[error("the name of a layer has 1 to {MAX_NAME} bytes of UTF-8")]
    Name,
    /// There is no such frame.
    #[error("there is no frame {0}, accepted: {WORLD} for the world, {ODOMETRY} for odometry")]
    Frame(i32),
    /// The robot has the maximum number of layers.
    #[error("a robot has at most {MAX_LAYERS} layers: show the new content under the name of an old one")]
    TooMany,
    /// The number of cells is out of range.
    #[error("a grid of {0} x {1} cells: accepted are 1 to {MAX_CELLS} cells in all")]
    Size(i32, i32),
    /// The side of the cells is not positive, or the grid is too far away.
    #[error("cells of {cell} m at ({x}, {y}) m: expected a side above 0, and corners within {MAX_COORDINATE} m of the origin", cell = .0.cell, x = .0.corner[0], y = .0.corner[1])]
    Place(Extent),
    /// A cell has a value without a meaning.
    #[error("cell {index} is {value}, accepted: 0 (free) to {OCCUPIED} (occupied), {UNKNOWN} (unknown)")]
    Cell {
        /// Index of the first such cell.
        index: usize,
        /// Its value.
        value: u8,
    },
    /// Points have neither 2 nor 3 coordinates.
    #[error("points of {0} coordinates, accepted: 2 or 3")]
    Dimensions(i32),
    /// There are too many points, or a negative number of them.
    #[error("{0} points: accepted are 0 to {MAX_POINTS}")]
    Count(i32),
    /// A coordinate is not a number or too large.
    #[error("point {0} is not within {MAX_COORDINATE} m of the origin")]
    Point(usize),
    /// The data are missing or of another length.
    #[error("there are {found} bytes instead of {expected}")]
    Data {
        /// Number of bytes passed; 0 for a null pointer.
        found: usize,
        /// Number of bytes according to the sizes.
        expected: usize,
    },
}

impl PartialEq for Extent {
    fn eq(&self, other: &Self) -> bool {
        let bits = |extent: &Self| [extent.corner[0], extent.corner[1], extent.cell].map(f64::to_bits);
        bits(self) == bits(other) && self.size == other.size
    }
}

/// `show_grid`
pub fn show_grid(robot: &mut Robot, label: Label<'_>, extent: Extent, cells: Option<&[u8]>) -> i32 {
    let shape = grid(extent, cells).map(Shape::Grid);
    show(robot, SupportCall::show_grid, label, shape)
}

/// `show_points`
pub fn show_points(robot: &mut Robot, label: Label<'_>, size: [i32; 2], coordinates: Option<&[u8]>) -> i32 {
    let shape = points(size, coordinates).map(Shape::Points);
    show(robot, SupportCall::show_points, label, shape)
}

/// `show_line`
pub fn show_line(robot: &mut Robot, label: Label<'_>, size: [i32; 2], coordinates: Option<&[u8]>) -> i32 {
    let shape = points(size, coordinates).map(Shape::Line);
    show(robot, SupportCall::show_line, label, shape)
}

fn show(robot: &mut Robot, call: SupportCall, label: Label<'_>, shape: Result<Shape, LayerError>) -> i32 {
    let shown = shape.and_then(|shape| insert(robot, label, shape));
    robot.answer_call(call, 1, shown)
}

/// Replaces the robot's layer of this name.
fn insert(robot: &mut Robot, label: Label<'_>, shape: Shape) -> Result<(), LayerError> {
    let name = label.name.and_then(|name| std::str::from_utf8(name).ok());
    let name = name.filter(|name| (1..=MAX_NAME).contains(&name.len())).ok_or(LayerError::Name)?;
    let world_from_frame = match label.frame {
        WORLD => Pose::default(),
        ODOMETRY => robot.robios.vw.world_from_odometry,
        other => return Err(LayerError::Frame(other)),
    };
    let layers = &mut robot.robios.layers;
    if layers.len() == MAX_LAYERS && !layers.contains_key(name) {
        return Err(LayerError::TooMany);
    }
    let layer = Arc::new(Layer { at: robot.state.now, world_from_frame, shape });
    layers.insert(name.to_owned(), Arc::clone(&layer));
    if let Some(frames) = &robot.robios.camera_output.frames {
        frames.store_layer(robot.state.id, name, layer);
    }
    Ok(())
}

/// Checks the grid of a program.
fn grid(extent: Extent, cells: Option<&[u8]>) -> Result<Grid, LayerError> {
    let Extent { corner, cell, size: [columns, rows] } = extent;
    let size_error = || LayerError::Size(columns, rows);
    let [width, height] = [columns, rows].map(|count| usize::try_from(count).unwrap_or(0));
    let count = width.checked_mul(height).filter(|count| (1..=MAX_CELLS).contains(count)).ok_or_else(size_error)?;
    let length = cell * width.max(height) as f64;
    // The negation also rejects NaN.
    let is_near = |low: f64| low.abs() <= MAX_COORDINATE && (low + length).abs() <= MAX_COORDINATE;
    if !(cell > 0.0 && corner.into_iter().all(is_near)) {
        return Err(LayerError::Place(extent));
    }
    let cells = cells.unwrap_or_default();
    if cells.len() != count {
        return Err(LayerError::Data { found: cells.len(), expected: count });
    }
    let is_invalid = |value: &u8| *value > OCCUPIED && *value != UNKNOWN;
    if let Some(index) = cells.iter().position(is_invalid) {
        return Err(LayerError::Cell { index, value: cells[index] });
    }
    Ok(Grid { corner, cell, columns: width as u32, rows: height as u32, cells: cells.to_vec() })
}

/// Checks the points of a program; points with 2 coordinates get the height 0.
fn points([dimensions, count]: [i32; 2], coordinates: Option<&[u8]>) -> Result<Vec<[f64; 3]>, LayerError> {
    if !(2..=3).contains(&dimensions) {
        return Err(LayerError::Dimensions(dimensions));
    }
    let dimensions = dimensions as usize;
    let valid_count = usize::try_from(count).ok().filter(|count| *count <= MAX_POINTS);
    let expected = size_of::<f64>() * dimensions * valid_count.ok_or(LayerError::Count(count))?;
    let bytes = coordinates.unwrap_or_default();
    if bytes.len() != expected {
        return Err(LayerError::Data { found: bytes.len(), expected });
    }
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)).collect();
    let point = |(index, point): (usize, &[f64])| {
        let is_near = point.iter().all(|coordinate| coordinate.abs() <= MAX_COORDINATE);
        let height = point.get(2).copied().unwrap_or(0.0);
        is_near.then_some([point[0], point[1], height]).ok_or(LayerError::Point(index))
    };
    numbers.chunks_exact(dimensions).enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(size: [i32; 2]) -> Extent {
        Extent { corner: [-1.0, 2.0], cell: 0.5, size }
    }

    fn bytes(numbers: &[f64]) -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    #[test]
    fn a_grid_is_copied_unchanged() {
        let cells = [0, 100, 255, 50, 1, 99];
        let grid = grid(extent([3, 2]), Some(&cells)).expect("a grid");
        assert_eq!(grid, Grid { corner: [-1.0, 2.0], cell: 0.5, columns: 3, rows: 2, cells: cells.to_vec() });
    }

    #[test]
    fn a_grid_beyond_its_limits_is_refused() {
        for size in [[0, 1], [1, 0], [-1, -1], [1025, 1024], [i32::MAX, i32::MAX], [i32::MIN, 1]] {
            assert_eq!(grid(extent(size), None), Err(LayerError::Size(size[0], size[1])));
        }
        let largest = vec![0; MAX_CELLS];
        assert!(grid(extent([1024, 1024]), Some(&largest)).is_ok());
        for (found, cells) in [(0, None), (3, Some(&[0_u8; 3][..])), (5, Some(&[0; 5]))] {
            assert_eq!(grid(extent([2, 2]), cells), Err(LayerError::Data { found, expected: 4 }));
        }
        let cells = [0, 101, 200];
        assert_eq!(grid(extent([3, 1]), Some(&cells)), Err(LayerError::Cell { index: 1, value: 101 }));
        for cell in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e6] {
            let extent = Extent { cell, ..extent([2, 1]) };
            assert_eq!(grid(extent, Some(&[0, 0])), Err(LayerError::Place(extent)));
        }
        for corner in [[f64::NAN, 0.0], [0.0, f64::NEG_INFINITY], [1e6, 0.0]] {
            let extent = Extent { corner, ..extent([1, 1]) };
            assert_eq!(grid(extent, Some(&[0])), Err(LayerError::Place(extent)));
        }
    }

    #[test]
    fn points_have_two_or_three_coordinates() {
        let numbers = bytes(&[1.0, 2.0, 3.0, -4.0, 5.0, 6.0]);
        assert_eq!(points([2, 3], Some(&numbers)), Ok(vec![[1.0, 2.0, 0.0], [3.0, -4.0, 0.0], [5.0, 6.0, 0.0]]));
        assert_eq!(points([3, 2], Some(&numbers)), Ok(vec![[1.0, 2.0, 3.0], [-4.0, 5.0, 6.0]]));
        assert_eq!(points([3, 0], None), Ok(vec![]));
        for dimensions in [1, 4, 0, -2, i32::MAX] {
            assert_eq!(points([dimensions, 1], None), Err(LayerError::Dimensions(dimensions)));
        }
        for count in [-1, i32::MIN, MAX_POINTS as i32 + 1, i32::MAX] {
            assert_eq!(points([2, count], None), Err(LayerError::Count(count)));
        }
        assert_eq!(points([2, 2], Some(&numbers)), Err(LayerError::Data { found: 48, expected: 32 }));
        assert_eq!(points([2, 2], None), Err(LayerError::Data { found: 0, expected: 32 }));
        for wrong in [f64::NAN, f64::INFINITY, -1.1e6] {
            assert_eq!(points([2, 2], Some(&bytes(&[0.0, 0.0, 0.0, wrong]))), Err(LayerError::Point(1)));
        }
    }
}
