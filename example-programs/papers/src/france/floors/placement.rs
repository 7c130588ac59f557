//! Placements of range sensors on the biped, the profile that they give, and its error where the robot is about to
//! step.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use sim_core::RobotId;
use sim_core::pose::Pose3;
use sim_core::sensor::{Echo, FRANCE_1999_SIGMA, RangeModel};
use sim_core::time::Time;
use sim_core::world::World;

use super::course::{Course, Instant, LINES, WAY};

/// Maximum number of sensors.
pub const SENSORS: usize = 3;
/// The laser range finder of the paper.
pub const LASER: Echo = Echo::LASER;
/// Height of the shoulder above the robot's frame, m: 0.818 of the height of 1.75 m (Drillis and Contini 1966).
const SHOULDER: f64 = 1.43;
/// Distance of the body's centre from a position whose height must be known, m: one step of the gait at its speed.
pub const STEP: f64 = 0.715;
/// Judged positions: first, last, and distance between two, m ahead of the start.
pub const JUDGED: (f64, f64, f64) = (1.5, WAY + 0.5, 0.05);
/// Difference of height that counts as a hazard, m.
const HAZARD: f64 = 0.05;

/// Link or body that bears a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MountPoint {
    /// On the right tibia.
    RightTibia,
    /// On the left tibia.
    LeftTibia,
    /// On the right thigh.
    RightThigh,
    /// On the left thigh.
    LeftThigh,
    /// On the body, between hip and shoulder.
    Body,
}

impl MountPoint {
    /// All mount points.
    pub const ALL: [Self; 5] = [Self::RightTibia, Self::LeftTibia, Self::RightThigh, Self::LeftThigh, Self::Body];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::RightTibia => "right tibia",
            Self::LeftTibia => "left tibia",
            Self::RightThigh => "right thigh",
            Self::LeftThigh => "left thigh",
            Self::Body => "body",
        }
    }

    /// The same mount point on the other side.
    pub fn mirrored(self) -> Self {
        match self {
            Self::RightTibia => Self::LeftTibia,
            Self::LeftTibia => Self::RightTibia,
            Self::RightThigh => Self::LeftThigh,
            Self::LeftThigh => Self::RightThigh,
            Self::Body => Self::Body,
        }
    }

    /// Index in the biped's list of links, which has five for each leg, the left one first; `None` for the body.
    pub fn link(self) -> Option<usize> {
        match self {
            Self::RightTibia => Some(8),
            Self::LeftTibia => Some(3),
            Self::RightThigh => Some(7),
            Self::LeftThigh => Some(2),
            Self::Body => None,
        }
    }

    /// Length of the link from its upper to its lower joint, m: ankle from knee, knee from hip, hip from shoulder.
    pub fn length(self) -> f64 {
        if self == Self::Body { SHOULDER - 0.9 } else { 0.43 }
    }
}

/// A sensor on the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Link or body.
    pub mount_point: MountPoint,
    /// Distance below the upper joint of the link, m.
    pub below: f64,
    /// Angle between the beam and straight down along the link or the body, degrees; 90 is straight ahead.
    pub tilt_deg: f64,
}

/// The laser of the scene `walker`: on the right tibia, 5 degrees down.
pub const SCENES: Sensor = Sensor { mount_point: MountPoint::RightTibia, below: 0.098, tilt_deg: 85.0 };

impl Sensor {
    /// Pose of the sensor in the world.
    pub fn ray(&self, instant: &Instant) -> Pose3 {
        let (x, top) = match self.mount_point {
            MountPoint::RightTibia | MountPoint::LeftTibia => (0.05, 0.0),
            MountPoint::RightThigh | MountPoint::LeftThigh => (0.07, 0.0),
            MountPoint::Body => (0.12, SHOULDER),
        };
        let pitch = self.tilt_deg.to_radians() - FRAC_PI_2;
        let mount = Pose3::from_angles(DVec3::new(x, 0.0, top - self.below), 0.0, pitch, 0.0);
        instant.bearers[self.mount_point as usize].then(&mount)
    }
}

/// Properties of the sensors and of the task under which they are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Name in tables.
    pub name: &'static str,
    /// Standard deviation of the noise N.
    pub sigma: f64,
    /// Largest incidence and range of the sensor.
    pub echo: Echo,
    /// Distance of the body's centre from a position whose height must be known, m.
    pub lead: f64,
}

/// The condition of the search.
pub const SEARCHED: Condition = Condition { name: "as searched", sigma: FRANCE_1999_SIGMA, echo: LASER, lead: STEP };

/// Exact reading of a sensor, m; `None` without an echo.
pub fn true_distance(world: &World, ray: &Pose3, echo: Echo) -> Option<f64> {
    let reading = RangeModel::Laser(echo).read(&world.caster(RobotId(1), Time::ZERO), ray, 0.0);
    reading.distance.filter(|distance| *distance < echo.max)
}

/// A point of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Number of the reading.
    pub reading: usize,
    /// Ahead of the start, m.
    pub x: f64,
    /// Above the level floor, m.
    pub z: f64,
}

/// The points that these sensors give, in the order of time.
pub fn points(course: &Course, sensors: &[Sensor], condition: &Condition) -> Vec<Point> {
    let mut points = Vec::new();
    for (reading, instant) in course.instants.iter().enumerate() {
        for (sensor, noise) in sensors.iter().zip(instant.noise) {
            let ray = sensor.ray(instant);
            // A leg may pass through the edge of a step: below the floor a sensor sees nothing.
            if course.field.height(ray.position.x, ray.position.y) > ray.position.z {
                continue;
            }
            let Some(distance) = true_distance(&course.world, &ray, condition.echo) else { continue };
            let point = course.ahead(ray.position + ray.forward() * (distance * (1.0 + condition.sigma * noise)));
            points.push(Point { reading, x: point.x, z: point.y });
        }
    }
    points
}

/// Error of a profile where the robot is about to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Root mean square error of the height, m.
    pub rms: f64,
    /// Number of judged positions that are higher or lower than the ground under the body by more than [`HAZARD`], and
    /// of those found.
    pub hazards: (usize, usize),
    /// Number of the other positions, and of those classified as hazards.
    pub safe: (usize, usize),
}

/// Positions of the judged positions, m ahead of the start.
fn judged_positions() -> impl Iterator<Item = f64> {
    let (first, last, apart) = JUDGED;
    (0..=((last - first) / apart).round() as usize).map(move |index| first + apart * index as f64)
}

/// The height of each judged position as the profile gives it when the body is `lead` before it: the mean of the points
/// within `radius`, else the height of the nearest point; `None` if no point is nearer than the body.
pub fn known<'a>(
    course: &'a Course,
    points: &'a [Point],
    radius: f64,
    lead: f64,
) -> impl Iterator<Item = (f64, Option<f64>)> + 'a {
    judged_positions().map(move |x| {
        let readings = course.instants.partition_point(|instant| instant.ahead <= x - lead);
        let points = &points[..points.partition_point(|point| point.reading < readings)];
        let (mut sum, mut count) = (0.0, 0);
        let mut nearest = (lead, None);
        for point in points {
            let distance = (point.x - x).abs();
            if distance <= radius {
                sum += point.z;
                count += 1;
            }
            if distance < nearest.0 {
                nearest = (distance, Some(point.z));
            }
        }
        (x, if count > 0 { Some(sum / f64::from(count)) } else { nearest.1 })
    })
}

/// Compares the known heights with the true ones under both feet. Where the profile gives none the robot expects the
/// height on which it stands.
pub fn score(course: &Course, points: &[Point], radius: f64, lead: f64) -> Score {
    let mut score = Score::default();
    let (mut squares, mut count) = (0.0, 0);
    for (x, height) in known(course, points, radius, lead) {
        for line in LINES {
            let (truth, here) = (course.height(x, line), course.height(x - lead, line));
            let expected = height.unwrap_or(here);
            squares += (expected - truth).powi(2);
            count += 1;
            let is_flagged = usize::from((expected - here).abs() > HAZARD);
            let group = if (truth - here).abs() > HAZARD { &mut score.hazards } else { &mut score.safe };
            *group = (group.0 + 1, group.1 + is_flagged);
        }
    }
    score.rms = (squares / f64::from(count)).sqrt();
    score
}

#[cfg(test)]
mod tests {
    use super::super::course::Floor;
    use super::*;

    const EXACT: Condition = Condition { sigma: 0.0, ..SEARCHED };
    /// A sensor of the body that looks down by 60 degrees.
    const DOWN: Sensor = Sensor { mount_point: MountPoint::Body, below: 0.2, tilt_deg: 30.0 };

    #[test]
    fn points_of_a_known_pose_lie_on_the_floor() {
        for floor in Floor::ALL {
            let course = Course::gliding(floor, 7, 0.0);
            let points = points(&course, &[DOWN], &EXACT);
            assert!(points.len() > 100, "{}", points.len());
            for point in points {
                // Within a micrometre of a vertical side the height is that of either end.
                let heights = [-1e-6, 1e-6].map(|side| course.height(point.x + side, 0.0));
                let [low, high] = [heights[0].min(heights[1]), heights[0].max(heights[1])];
                assert!(point.z > low - 1e-6 && point.z < high + 1e-6, "{floor:?} {point:?} {heights:?}");
            }
        }
    }

    /// Without points the error is that of a robot that expects the height on which it stands.
    #[test]
    fn a_sensor_without_hits_does_not_improve_the_score() {
        let course = Course::gliding(Floor::Stairs, 7, 0.0);
        let up = Sensor { tilt_deg: 170.0, ..DOWN };
        let [blind, with_up] =
            [&[][..], &[up]].map(|sensors| score(&course, &points(&course, sensors, &EXACT), 0.1, STEP));
        assert_eq!(blind, with_up);
        let squares: Vec<f64> =
            judged_positions().map(|x| (course.height(x, 0.0) - course.height(x - STEP, 0.0)).powi(2)).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!((blind.rms - rms).abs() < 1e-9, "{} {rms}", blind.rms);
        assert_eq!((blind.hazards.1, blind.safe.1), (0, 0));
    }

    /// The score of a profile with known errors contains these errors.
    #[test]
    fn known_errors_appear_in_the_score() {
        let course = Course::gliding(Floor::Uneven, 7, 0.0);
        let exact = points(&course, &[DOWN], &EXACT);
        let error = |points: &[Point]| score(&course, points, 0.02, STEP).rms;
        assert!(error(&exact) < 0.01, "{}", error(&exact));
        let raised: Vec<Point> = exact.iter().map(|point| Point { z: point.z + 0.1, ..*point }).collect();
        assert!((error(&raised) - 0.1).abs() < 0.01, "{}", error(&raised));
        let late: Vec<Point> = exact.iter().map(|point| Point { reading: point.reading + 100, ..*point }).collect();
        assert!(error(&late) > 2.0 * error(&exact), "{}", error(&late));
        // A noise of 1 % of 1.4 m along a ray that falls by 60 degrees.
        let noisy = error(&points(&course, &[DOWN], &SEARCHED));
        assert!(noisy > 0.01 && noisy < 0.03, "{noisy}");
        // A point of a hole is a hazard.
        let hole = [Point { reading: 0, x: 3.0, z: course.height(3.0 - STEP, 0.0) - 0.2 }];
        let flagged = score(&course, &hole, 0.02, STEP);
        assert!(flagged.hazards.1 + flagged.safe.1 > 0);
    }
}
