//! Likelihoods of scans on a map of occupied cells, as functions of the robot's pose ([`PoseLikelihood`]).
//!
//! [`Points`] is the likelihood of points on surfaces, from a laser scanner, from infrared sensors, or from lines
//! through sonar arcs. [`Ranges`] is the likelihood of distances from wide sonars, which measure the distance of the
//! nearest surface in the beam. Both treat an error of several standard deviations as an outlier, and ignore readings
//! without an echo.
//!
//! Source: Thrun, Burgard & Fox 2005, section 6.4 (likelihood field) and 6.3 (beam model, with the cases "hit" and
//! "random" only).

use std::f64::consts::TAU;

use crate::distance::distances;
use crate::grid::{Cell, Grid, GridGeometry};
use crate::localise::PoseLikelihood;
use crate::math;
use crate::pose::{Point, Vector, direction};

/// Error distribution of a reading.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Error {
    /// Standard deviation, including the error of the map, m.
    pub sigma: f64,
    /// Ratio of the likelihood of an outlier to that of a reading without an error, in (0, 1).
    pub outlier: f64,
}

impl Error {
    /// Log-likelihood of an error in m, relative to the log-likelihood of no error.
    fn log(&self, error: f64) -> f64 {
        let normalised = error / self.sigma;
        math::ln((1.0 - self.outlier) * math::exp(-0.5 * normalised * normalised) + self.outlier)
    }
}

/// Log-likelihood of a measured point on a surface for each position, from the distance to the centre of the nearest
/// occupied cell.
#[derive(Clone, PartialEq, Debug)]
pub struct LikelihoodField {
    logs: Grid<f64>,
    /// Log-likelihood outside the map.
    outside: f64,
}

impl LikelihoodField {
    /// The field of a map.
    pub fn new<T>(map: &Grid<T>, is_occupied: impl Fn(&T) -> bool, error: &Error) -> Self {
        let logs = distances(map, is_occupied).map(|distance| error.log(*distance));
        Self { logs, outside: error.log(f64::INFINITY) }
    }

    /// Log-likelihood of a point, by bilinear interpolation between the centres of the cells.
    pub fn log(&self, point: Point) -> f64 {
        let frame = self.logs.frame();
        let position = frame.in_cells(point) - Vector::repeat(0.5);
        let (column, row) = (position.x.floor(), position.y.floor());
        if !(0.0..(frame.columns() - 1) as f64).contains(&column) || !(0.0..(frame.rows() - 1) as f64).contains(&row) {
            return self.outside;
        }
        let (x, y) = (position.x - column, position.y - row);
        let cell = Cell::new(column as usize, row as usize);
        let corner = |right: usize, up: usize| self.logs[Cell::new(cell.column + right, cell.row + up)];
        let interpolate = |from: f64, to: f64, fraction: f64| from + fraction * (to - from);
        interpolate(interpolate(corner(0, 0), corner(1, 0), x), interpolate(corner(0, 1), corner(1, 1), x), y)
    }
}

/// Points on surfaces, grouped by reading.
#[derive(Clone, PartialEq, Debug)]
pub struct Points<'a> {
    /// Likelihood field of the map.
    pub field: &'a LikelihoodField,
    /// Points of each reading in the robot's frame. All readings have the same weight, for any number of points.
    pub readings: Vec<Vec<Point>>,
}

impl PoseLikelihood for Points<'_> {
    fn at(&self, position: Point, headings: &[f64]) -> Vec<f64> {
        let at_heading = |heading: &f64| {
            let ahead = direction(*heading);
            let left = Vector::new(-ahead.y, ahead.x);
            let point_log = |point: &Point| self.field.log(position + ahead * point.x + left * point.y);
            let reading_log = |points: &Vec<Point>| points.iter().map(point_log).sum::<f64>() / points.len() as f64;
            self.readings.iter().filter(|points| !points.is_empty()).map(reading_log).sum()
        };
        headings.iter().map(at_heading).collect()
    }
}

/// Number of directions in a view, half a degree apart.
const BINS: usize = 720;

/// Likelihood of distances measured by sonars on the rim of a round robot.
#[derive(Clone, PartialEq, Debug)]
pub struct Ranges<'a> {
    /// Middles of the occupied cells.
    pub occupied: &'a [Point],
    /// Length of a cell's side, m.
    pub cell: f64,
    /// The robot's radius, on which the sonars sit, m.
    pub radius: f64,
    /// The angle between the axis and the edge of a beam, rad.
    pub half_angle: f64,
    /// For each sonar: its direction in the robot's frame, rad, and the measured distance from the rim, m.
    pub readings: Vec<(f64, f64)>,
    /// Error distribution of a distance.
    pub error: Error,
}

impl Ranges<'_> {
    /// Distance from `position` to the nearest occupied cell in each of [`BINS`] directions; infinite if there is none.
    fn view(&self, position: Point) -> Vec<f64> {
        let mut view = vec![f64::INFINITY; BINS];
        for point in self.occupied {
            let offset = point - position;
            let distance = offset.norm();
            let (middle, half_width) =
                (bin(math::atan2(offset.y, offset.x)), bin(0.5 * self.cell / distance).min(0.5 * BINS as f64));
            for index in (middle - half_width).round() as i64..=(middle + half_width).round() as i64 {
                let nearest = &mut view[index.rem_euclid(BINS as i64) as usize];
                *nearest = nearest.min(distance);
            }
        }
        view
    }

    /// Directions in a beam: number of bins from the axis, and unit vector.
    fn beam(&self) -> Vec<(i64, Vector)> {
        let half = bin(self.half_angle).floor() as i64;
        (-half..=half).map(|index| (index, direction(index as f64 * TAU / BINS as f64))).collect()
    }

    /// Expected reading of a sonar whose heading is rounded to the nearest bin; infinite if nothing is in its beam.
    fn expected_distance(&self, view: &[f64], beam: &[(i64, Vector)], heading: f64) -> f64 {
        let middle = bin(heading).round() as i64;
        let (rim, slope) = (Vector::new(self.radius, 0.0), math::tan(self.half_angle));
        let distances = beam.iter().filter_map(|(index, direction)| {
            let distance = view[(middle + index).rem_euclid(BINS as i64) as usize];
            let offset = direction * distance - rim;
            // The beam begins at the rim, so it is narrower than a beam of the same angle from the robot's centre.
            (distance.is_finite() && offset.y.abs() <= offset.x * slope).then(|| offset.norm())
        });
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// Angle in bins of half a degree.
fn bin(angle: f64) -> f64 {
    angle * BINS as f64 / TAU
}

impl PoseLikelihood for Ranges<'_> {
    fn at(&self, position: Point, headings: &[f64]) -> Vec<f64> {
        let (view, beam) = (self.view(position), self.beam());
        let reading_log = |heading: f64, (angle, distance): &(f64, f64)| {
            self.error.log(self.expected_distance(&view, &beam, heading + angle) - distance)
        };
        headings
            .iter()
            .map(|heading| self.readings.iter().map(|reading| reading_log(*heading, reading)).sum())
            .collect()
    }
}

/// Middles of the occupied cells of a map.
pub fn occupied_points<T>(map: &Grid<T>, is_occupied: impl Fn(&T) -> bool) -> Vec<Point> {
    let frame: &GridGeometry = map.frame();
    map.iter().filter(|(_, value)| is_occupied(value)).map(|(cell, _)| frame.centre(cell)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_6;

    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::line::supercover;
    use crate::localise::Belief;
    use crate::pose::{Pose, wrapped};

    const ERROR: Error = Error { sigma: 0.03, outlier: 0.05 };
    const RADIUS: f64 = 0.12;

    /// A map of walls with cells of 25 mm.
    fn map(walls: &[[f64; 4]]) -> Grid<bool> {
        let mut map = Grid::new(GridGeometry::new(Point::new(-1.0, -1.0), 0.025, 320, 240), false);
        let frame = *map.frame();
        for &[x0, y0, x1, y1] in walls {
            for cell in supercover(&frame, Point::new(x0, y0), Point::new(x1, y1)) {
                map[cell] = true;
            }
        }
        map
    }

    /// A room of 4 m x 3 m with a board across one corner.
    const ROOM: [[f64; 4]; 5] =
        [[0.0, 0.0, 4.0, 0.0], [4.0, 0.0, 4.0, 3.0], [4.0, 3.0, 0.0, 3.0], [0.0, 3.0, 0.0, 0.0], [0.0, 2.2, 0.8, 3.0]];
    /// Walls along x whose ends are out of range.
    const CORRIDOR: [[f64; 4]; 2] = [[-1.0, 0.0, 6.9, 0.0], [-1.0, 1.5, 6.9, 1.5]];

    /// Points on the walls, 5 cm apart, in the frame of the robot at `pose` and up to `range` from it, like those of a
    /// 360 degree scanner.
    fn points(walls: &[[f64; 4]], pose: &Pose, range: f64) -> Vec<Vec<Point>> {
        let points_on = |wall: &[f64; 4]| {
            let (from, to) = (Point::new(wall[0], wall[1]), Point::new(wall[2], wall[3]));
            let count = ((to - from).norm() / 0.05) as usize;
            (0..=count).map(move |index| from + (to - from) * (index as f64 / count as f64)).collect::<Vec<Point>>()
        };
        let readings = walls.iter().flat_map(points_on).map(|point| vec![pose.inward(point)]);
        readings.filter(|point| point[0].coords.norm() < range).collect()
    }

    /// Readings of sonars 15 degrees apart: the distance of the nearest point in the beam.
    fn ranges(walls: &[[f64; 4]], pose: &Pose) -> Vec<(f64, f64)> {
        let half = 0.5 * FRAC_PI_6;
        let points_on = |wall: &[f64; 4]| {
            let (from, to) = (Point::new(wall[0], wall[1]), Point::new(wall[2], wall[3]));
            (0..=4000).map(move |index| from + (to - from) * (f64::from(index) / 4000.0)).collect::<Vec<Point>>()
        };
        let points: Vec<Point> = walls.iter().flat_map(points_on).map(|point| pose.inward(point)).collect();
        let distance_at = |angle: f64| {
            let sonar = Pose { position: Point::from(direction(angle) * RADIUS), heading: angle };
            let in_beam = |point: &Point| {
                let (distance, angle) = crate::sonar::polar(sonar, *point);
                (angle.abs() <= half).then_some(distance)
            };
            points.iter().filter_map(in_beam).fold(f64::INFINITY, f64::min)
        };
        let readings = (0..24).map(|index| f64::from(index) * half).map(|angle| (angle, distance_at(angle)));
        readings.filter(|(_, distance)| *distance < 4.0).collect()
    }

    fn prior(truth: &Pose, offset: [f64; 3], sigmas: [f64; 3]) -> Belief {
        let mean = Pose::new(truth.position.x + offset[0], truth.position.y + offset[1], truth.heading + offset[2]);
        let variances = Vector3::from(sigmas.map(|sigma| sigma * sigma));
        Belief { mean, covariance: Matrix3::from_diagonal(&variances) }
    }

    fn check(found: &Belief, truth: &Pose, tolerance: f64, name: &str) {
        let distance = (found.mean.position - truth.position).norm();
        let heading_error = wrapped(found.mean.heading - truth.heading).abs();
        assert!(distance < tolerance && heading_error < tolerance, "{name}: {distance} m and {heading_error} rad off");
    }

    #[test]
    fn pose_offset_is_corrected_in_a_room() {
        let map = map(&ROOM);
        let (field, occupied) = (
            LikelihoodField::new(&map, |is_occupied| *is_occupied, &ERROR),
            occupied_points(&map, |is_occupied| *is_occupied),
        );
        for (truth, offset) in [
            (Pose::new(1.3, 1.1, 0.4), [0.12, -0.08, 0.1]),
            (Pose::new(2.9, 1.9, -2.0), [-0.1, 0.1, -0.12]),
            (Pose::new(0.9, 0.6, 3.1), [0.05, 0.14, 0.15]),
        ] {
            let prior = prior(&truth, offset, [0.1, 0.1, 0.1]);
            let scan = Points { field: &field, readings: points(&ROOM, &truth, 3.0) };
            check(&prior.corrected(&scan), &truth, 0.015, "points");
            let readings = ranges(&ROOM, &truth);
            let scan = Ranges {
                occupied: &occupied,
                cell: 0.025,
                radius: RADIUS,
                half_angle: 0.5 * FRAC_PI_6,
                readings,
                error: ERROR,
            };
            check(&prior.corrected(&scan), &truth, 0.02, "ranges");
        }
    }

    /// A tenth of the readings are outliers.
    #[test]
    fn outliers_do_not_move_the_pose() {
        let map = map(&ROOM);
        let occupied = occupied_points(&map, |is_occupied| *is_occupied);
        let truth = Pose::new(1.3, 1.1, 0.4);
        let mut readings = ranges(&ROOM, &truth);
        for index in [3, 17] {
            readings[index].1 *= 0.4;
        }
        let scan = Ranges {
            occupied: &occupied,
            cell: 0.025,
            radius: RADIUS,
            half_angle: 0.5 * FRAC_PI_6,
            readings,
            error: ERROR,
        };
        check(&prior(&truth, [0.08, -0.05, 0.08], [0.1, 0.1, 0.1]).corrected(&scan), &truth, 0.02, "outliers");
    }

    /// Along a corridor the position and its variance do not change; across it and in heading the pose is corrected.
    #[test]
    fn corridor_corrects_only_across_and_heading() {
        let map = map(&CORRIDOR);
        let (field, occupied) = (
            LikelihoodField::new(&map, |is_occupied| *is_occupied, &ERROR),
            occupied_points(&map, |is_occupied| *is_occupied),
        );
        let truth = Pose::new(3.0, 0.7, 0.2);
        let prior = prior(&truth, [0.2, 0.08, 0.08], [0.15, 0.08, 0.08]);
        let points_scan = Points { field: &field, readings: points(&CORRIDOR, &truth, 2.0) };
        let readings = ranges(&CORRIDOR, &truth).into_iter().filter(|(_, distance)| *distance < 2.0).collect();
        let ranges_scan = Ranges {
            occupied: &occupied,
            cell: 0.025,
            radius: RADIUS,
            half_angle: 0.5 * FRAC_PI_6,
            readings,
            error: ERROR,
        };
        for (name, found) in [("points", prior.corrected(&points_scan)), ("ranges", prior.corrected(&ranges_scan))] {
            let along = found.mean.position.x - prior.mean.position.x;
            let (across, heading_error) =
                (found.mean.position.y - truth.position.y, found.mean.heading - truth.heading);
            assert!(along.abs() < 0.01, "{name}: moved along by {along}");
            assert!(found.covariance[(0, 0)].sqrt() > 0.9 * 0.15, "{name}: {}", found.covariance);
            assert!(across.abs() < 0.015 && heading_error.abs() < 0.02, "{name}: {across} m, {heading_error} rad");
        }
    }

    #[test]
    fn empty_map_keeps_the_prior() {
        let map = map(&[]);
        let field = LikelihoodField::new(&map, |is_occupied| *is_occupied, &ERROR);
        let truth = Pose::new(1.3, 1.1, 0.4);
        let prior = prior(&truth, [0.1, 0.0, 0.1], [0.1, 0.1, 0.1]);
        let found = prior.corrected(&Points { field: &field, readings: points(&ROOM, &truth, 3.0) });
        assert!((found.mean.position - prior.mean.position).norm() < 1e-9, "{found:?}");
        assert!((found.covariance[(2, 2)].sqrt() / 0.1 - 1.0).abs() < 0.03, "{found:?}");
    }
}
