//! A reading of a sonar, and the cells of its beam.

use crate::grid::{Cell, GridGeometry};
use crate::math;
use crate::pose::{Point, Pose, wrapped};

/// A reading of a sonar.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Echo {
    /// Pose of the sonar in the map's frame; its x axis is the axis of the beam.
    pub sonar: Pose,
    /// Distance of the surface that caused the echo, in metres; `None` without an echo.
    pub distance: Option<f64>,
}

/// A sonar's beam: a cone, or its section in the plane of the map.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Beam {
    /// The angle between the axis and the edge, in radians.
    pub half_angle: f64,
    /// Minimum distance that the sonar measures, in metres.
    pub nearest: f64,
    /// Maximum distance that the sonar measures, in metres.
    pub farthest: f64,
}

/// A cell within a beam.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InBeam {
    /// The cell.
    pub cell: Cell,
    /// Distance from the sonar to the centre of the cell, in metres.
    pub distance: f64,
    /// Angle from the axis of the beam, counter-clockwise, in radians.
    pub angle: f64,
}

impl Beam {
    /// The cells of `frame` whose centre lies in the beam of a sonar at `sonar`, at most `max_distance` metres away,
    /// row by row.
    pub fn cells(&self, frame: &GridGeometry, sonar: Pose, max_distance: f64) -> impl Iterator<Item = InBeam> + use<> {
        let (frame, half_angle) = (*frame, self.half_angle);
        frame.disc(sonar.position, max_distance).filter_map(move |cell| {
            let (distance, angle) = polar(sonar, frame.centre(cell));
            (angle.abs() <= half_angle).then_some(InBeam { cell, distance, angle })
        })
    }
}

/// Polar coordinates of a point in the frame of `pose`: distance in metres, angle in radians in [-pi, pi).
pub fn polar(pose: Pose, point: Point) -> (f64, f64) {
    let offset = point - pose.position;
    (math::hypot(offset.x, offset.y), wrapped(math::atan2(offset.y, offset.x) - pose.heading))
}
