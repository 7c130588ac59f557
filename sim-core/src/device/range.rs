//! Readings of the range sensors and of the laser scanner at an instant.
//!
//! Lists of range sensors contain the PSDs first, then the sensors of the other kinds. Only [`Ranges::read`] and
//! [`Ranges::scan`] give readings with errors.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::RobotId;
use crate::build;
use crate::drive::legged::Stance;
use crate::drive::{DriveKind, Motion};
use crate::noise::{EventStreams, Profile, RangeErrors, RangeKind};
use crate::pose::{Heading, Link, Pose, Pose3};
use crate::sensor::{Fan, Mount, Posture, RangeModel, RangeSensor, Reading, Scan};
use crate::spec::{LIDAR, LidarSpec, RobiSpec};
use crate::time::Time;
use crate::world::{RayCaster, World};

use super::psd::{CYCLE, SensorSet, members};
use super::servo::Servos;

/// Range sensors of a robot and the links that carry them: the links of its legs, then the links of the robi.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    /// Shared by the robots of a type.
    sensors: Arc<[RangeSensor]>,
    links: Vec<Link>,
    /// Angles of each servo at positions 0 and 255, rad.
    swings: Vec<[f64; 2]>,
    /// `None` if all readings are exact.
    errors: Option<Box<Errors>>,
}

/// Errors of the range sensors of a robot.
#[derive(Clone, Debug)]
struct Errors {
    /// For each sensor, its errors, and sigma and mean of the noise of the sensor's type.
    sensors: Vec<(RangeErrors, [f64; 2])>,
    lidar: RangeErrors,
}

/// Reading of a sensor that does not exist.
const NO_RETURN: Reading = Reading { distance: None, signal: 0.0 };

/// Event period of a laser scanner: one microsecond, since scans are made on request and not in cycles.
const SCAN: Time = Time(1);

/// Pose, range and exact distance of a sensor at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorView {
    /// Pose of the sensor; its x axis is the viewing direction.
    pub world_from_sensor: Pose3,
    /// Maximum distance that the sensor measures, m.
    pub range: f64,
    /// Distance without errors, m; `None` if out of range.
    pub distance: Option<f64>,
}

/// A laser scanner of a robot.
#[derive(Clone, Debug)]
pub enum Scanner {
    /// A level scanner on the body; its fan can be tilted.
    Level(Scan),
    /// A scanner at any pose, on the body or on a link.
    InSpace {
        /// Its rays.
        scan: Scan,
        /// Pose of the scanner's frame in the frame of the body or link that carries it.
        mount: Pose3,
        /// The link, `None` for the body.
        link: Option<usize>,
    },
}

impl Ranges {
    /// The sensors that a robi describes.
    pub fn new(spec: &RobiSpec) -> Self {
        Self {
            sensors: build::range_sensors(spec).into(),
            links: build::links(spec),
            swings: spec.all_servos().into_iter().map(|servo| servo.swing).collect(),
            errors: None,
        }
    }

    /// Sets the noise models of these sensors of `spec` from `profile`, for `robot` in a run with `seed`.
    pub fn set_errors(&mut self, spec: &RobiSpec, profile: &Profile, seed: u64, robot: RobotId) {
        let errors_of = |kind, name: &str| RangeErrors::new(profile.range(kind, name), seed, robot, name);
        let psds = spec.psds.iter().map(|psd| (errors_of(RangeKind::Psd, &psd.name), [0.0; 2]));
        let others = spec.ranges.iter();
        let others = others.map(|it| (errors_of((&it.model).into(), &it.name), [it.sigma, it.mean]));
        let sensors = psds.chain(others).collect();
        let errors = Errors { sensors, lidar: errors_of(RangeKind::Lidar, LIDAR) };
        self.errors = Some(Box::new(errors));
    }

    /// Reading of sensor `index` while it is switched off.
    pub fn no_return(&self, index: usize) -> Reading {
        self.sensors.get(index).map_or(NO_RETURN, |sensor| sensor.model.no_return())
    }

    /// Ray caster at `at` for the sensors of `sensors` on the body with this motion.
    pub fn caster<'a>(&self, sensors: SensorSet, motion: &mut Motion, world: &'a World, at: Time) -> RayCaster<'a> {
        // A sonar casts many rays, so it collects its nearby robots itself.
        let is_shared = |it: &&RangeSensor| it.link.is_none() && !matches!(it.model, RangeModel::Sonar(_));
        let on_body = members(sensors).filter_map(|index| self.sensors.get(index)).filter(is_shared);
        let reach = on_body.clone().map(|it| it.mount.position.truncate().length() + it.model.limits()[1]);
        let (count, reach) = (on_body.count(), reach.fold(0.0, f64::max));
        world.caster_near(motion.id(), at, count, motion.pose(at).position, reach)
    }

    /// Reading of sensor `index` at the instant of `caster`, with the servo angles just before this instant. A sensor
    /// that does not exist has no return.
    pub fn read(&self, index: usize, servos: &Servos, motion: &mut Motion, caster: &RayCaster) -> Reading {
        let at = caster.at();
        let Some(sensor) = self.sensors.get(index) else { return NO_RETURN };
        let errors = self.errors.as_ref().and_then(|errors| errors.sensors.get(index));
        let event = errors.map_or(0, |_| EventStreams::index(at, CYCLE));
        let noise = errors.map_or(0.0, |(errors, [sigma, mean])| errors.device_noise(event, *sigma, *mean));
        let reading = if sensor.is_level_psd() {
            let (centre, forward) = motion.centre_and_forward(at);
            sensor.read_level(caster, (centre, forward, motion.lift(at)), noise)
        } else {
            let world_from_robot = motion.pose(at);
            let (angles, lift) = self.angles_and_lift(sensor.link, servos, motion, at);
            let posture = Posture { world_from_robot, links: &self.links, angles: &angles, lift };
            sensor.read(caster, &posture, noise)
        };
        errors.map_or(reading, |(errors, _)| errors.reading_of(event, at, &sensor.model, reading))
    }

    /// Pose of each sensor in the world at `at`, and its distance without errors.
    pub fn views(&self, servos: &Servos, motion: &mut Motion, world: &World, at: Time) -> Vec<SensorView> {
        let stance = motion.stance(at);
        let angles = self.joint_angles(servos, &stance.joints, at);
        let world_from_robot = motion.pose(at);
        let posture = Posture { world_from_robot, links: &self.links, angles: &angles, lift: stance.lift };
        let caster = world.caster(motion.id(), at);
        let view = |sensor: &RangeSensor| {
            let Reading { distance, signal } = sensor.read(&caster, &posture, 0.0);
            let world_from_sensor = sensor.world_from_sensor(&posture);
            SensorView {
                world_from_sensor,
                range: sensor.model.limits()[1],
                distance: distance.filter(|_| signal > 0.0),
            }
        };
        self.sensors.iter().map(view).collect()
    }

    /// Pose of the scanner in the world at `at`, and the distance along each of its rays without errors.
    pub fn exact_scan(
        &self,
        scanner: &Scanner,
        servos: &Servos,
        motion: &mut Motion,
        world: &World,
        at: Time,
    ) -> (Pose3, Vec<Option<f64>>) {
        let world_from_robot = motion.pose(at);
        match scanner {
            Scanner::Level(scan) => {
                let planar = world_from_robot.compose(&scan.mount().robot_from_sensor);
                let distances = scan.distances(world, motion.id(), &world_from_robot, at);
                (Pose3::from_planar(&planar, scan.height()), distances)
            }
            Scanner::InSpace { scan, mount, link } => {
                let (angles, lift) = self.angles_and_lift(*link, servos, motion, at);
                let posture = Posture { world_from_robot, links: &self.links, angles: &angles, lift };
                let world_from_scanner = posture.world_from(mount, *link);
                let distances = scan.distances_from(world, motion.id(), &world_from_scanner, at);
                (world_from_scanner, distances)
            }
        }
    }

    /// Pose of the scanner in the world at `at`, and the readings of its rays in metres from left to right; `None` for
    /// a ray without return within the range.
    pub fn scan(
        &self,
        scanner: &Scanner,
        servos: &Servos,
        motion: &mut Motion,
        world: &World,
        at: Time,
    ) -> (Pose3, Vec<Option<f64>>) {
        let (world_from_scanner, exact) = self.exact_scan(scanner, servos, motion, world, at);
        let Some(errors) = &self.errors else { return (world_from_scanner, exact) };
        let mut errors = errors.lidar.scan(EventStreams::index(at, SCAN), at, [0.0, scanner.fan().range()]);
        (world_from_scanner, exact.into_iter().map(|point| errors.point(point)).collect())
    }

    /// Direction of ray `ray` of the scanner at `at`, rad counter-clockwise from straight ahead of the robot: the ray's
    /// direction in the fan, turned by the yaw of the scanner.
    pub fn bearing(&self, scanner: &Scanner, ray: u32, servos: &Servos, motion: &mut Motion, at: Time) -> f64 {
        let yaw = match scanner {
            Scanner::Level(scan) => scan.mount().robot_from_sensor.heading.remainder(),
            Scanner::InSpace { mount, link, .. } => {
                let (angles, lift) = self.angles_and_lift(*link, servos, motion, at);
                let posture = Posture { world_from_robot: Pose::default(), links: &self.links, angles: &angles, lift };
                posture.world_from(mount, *link).angles()[2]
            }
        };
        let bearing = scanner.fan().bearing(ray) + yaw;
        // A ray straight behind a scanner that is not turned keeps its sign.
        if bearing.abs() > PI { Heading::new(bearing).remainder() } else { bearing }
    }

    /// Angles of all joints at `at`, rad (an empty list for a sensor on the body), and height of the robot's frame, m.
    fn angles_and_lift(&self, link: Option<usize>, servos: &Servos, motion: &mut Motion, at: Time) -> (Vec<f64>, f64) {
        let Stance { joints, lift, .. } = motion.stance(at);
        (if link.is_some() { self.joint_angles(servos, &joints, at) } else { Vec::new() }, lift)
    }

    /// Angles of all joints, rad: the servos' angles just before `at`, then the angles `leg_joints` of the legs.
    pub fn joint_angles(&self, servos: &Servos, leg_joints: &[f64], at: Time) -> Vec<f64> {
        let angle = |(index, swing): (usize, &[f64; 2])| servos.angle_before(index, *swing, at);
        self.swings.iter().enumerate().map(angle).chain(leg_joints.iter().copied()).collect()
    }
}

impl Scanner {
    /// The scanner that a robi describes, with `points` rays over `sweep` rad, raised by `tilt` rad.
    pub fn new(spec: &RobiSpec, lidar: &LidarSpec, [sweep, tilt]: [f64; 2], points: u32) -> Self {
        let LidarSpec { mount, range, .. } = lidar;
        let fan = Fan { sweep, points, tilt, height: mount.position.z, range: *range };
        // A walking body and a submarine move up and down, so the height of their scanner varies.
        if mount.is_level() && !matches!(spec.drive.kind, DriveKind::Legged | DriveKind::Thrusters) {
            return Self::Level(Scan::new(Mount::new(mount.position.x, mount.position.y, mount.yaw), fan));
        }
        let (mount, link) = build::scanner_mount(spec, lidar);
        Self::InSpace { scan: Scan::new(Mount::default(), fan), mount, link }
    }

    /// Fan of the scanner: number and directions of its rays.
    pub fn fan(&self) -> &Scan {
        match self {
            Self::Level(scan) | Self::InSpace { scan, .. } => scan,
        }
    }
}
