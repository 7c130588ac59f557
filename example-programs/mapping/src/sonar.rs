//! A reading of a sonar, and the cells of its beam.

use crate::grid::{Cell, Frame};
use crate::math;
use crate::pose::{Point, Pose, wrapped};

/// A reading of a sonar.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Echo {
    /// Pose of the sonar in the map's frame; its x axis is the middle of the beam.
    pub sonar: Pose,
    /// Distance to the surface that echoed, in metres; `None` without an echo.
    pub distance: Option<f64>,
}

/// A sonar's beam: a cone, or its section in the plane of the map.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Beam {
    /// The angle between the middle and the edge, in radians.
    pub half_angle: f64,
    /// Least distance that is heard, in metres.
    pub nearest: f64,
    /// Maximum distance that is heard, in metres.
    pub farthest: f64,
}

/// A cell within a beam.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InBeam {
    /// The cell.
    pub cell: Cell,
    /// Distance from the sonar to the middle of the cell, in metres.
    pub distance: f64,
    /// Angle from the middle of the beam, counter-clockwise, in radians.
    pub angle: f64,
}

impl Beam {
    /// The cells of `frame` whose middle lies in the beam of `sonar`, up to `reach` metres from it, row by row.
    pub fn cells(&self, frame: &Frame, sonar: Pose, reach: f64) -> impl Iterator<Item = InBeam> + use<> {
        let (frame, half_angle) = (*frame, self.half_angle);
        frame.disc(sonar.position, reach).filter_map(move |cell| {
            let (distance, angle) = polar(sonar, frame.centre(cell));
            (angle.abs() <= half_angle).then_some(InBeam { cell, distance, angle })
        })
    }
}

/// The distance and the direction of a point as seen from `pose`, in metres and radians in [-pi, pi).
pub fn polar(pose: Pose, point: Point) -> (f64, f64) {
    let offset = point - pose.position;
    (math::hypot(offset.x, offset.y), wrapped(math::atan2(offset.y, offset.x) - pose.heading))
}
