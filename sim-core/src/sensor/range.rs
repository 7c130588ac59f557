use glam::DVec2;

use super::{Echo, Sonar, incidence};
use crate::{
    pose::{Link, Pose, Pose3, link_pose},
    world::{Ray, RayCaster},
};

/// Measuring principle of a range sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangeModel {
    /// An infrared triangulation sensor: the distance along one ray, for any surface. Source: Koestler & Bräunl,
    /// section 4.1.
    Psd {
        /// Range, m.
        range: f64,
    },
    /// A laser range finder: see [`Echo::time_of_flight`].
    Laser(Echo),
    /// A narrow ultrasonic sensor: see [`Echo::time_of_flight`].
    Ultrasonic(Echo),
    /// A reflectance sensor: see [`Echo::reflectance`].
    Reflectance(Echo),
    /// An ultrasonic sensor with a beam.
    Sonar(Sonar),
}

/// A range sensor on a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeSensor {
    /// Sensor frame, x along the line of sight, in the frame of the body or link that carries it.
    pub mount: Pose3,
    /// Link that carries the sensor, as an index in the robot's list of links; `None` for the body.
    pub link: Option<usize>,
    /// Measuring principle.
    pub model: RangeModel,
}

/// Posture of a robot, which determines the poses of its sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Posture<'a> {
    /// Pose of the robot's centre.
    pub world_from_robot: Pose,
    /// Links of the robot, each after its parent.
    pub links: &'a [Link],
    /// Joint angles, rad, in the order of [`Link::joint`]: servos, then legs.
    pub angles: &'a [f64],
    /// Height of the robot's frame above the plane z = 0, m; nonzero for a walking robot.
    pub lift: f64,
}

/// Reading of a range sensor at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Distance, m; `None` if out of range. Laser, ultrasonic and reflectance sensors give their maximum distance
    /// instead of `None`.
    pub distance: Option<f64>,
    /// Signal from which the distance was derived. For a reflectance sensor it is in 1/m. For a sonar it is the energy
    /// of the echo, relative to a perfect reflector 1 m ahead. For other sensors it is 1 with an echo and 0 without.
    pub signal: f64,
}

impl RangeModel {
    /// Reading of a sensor of the robot of `caster` at the pose `world_from_sensor`, at the instant of `caster`.
    /// `noise` is N of France et al.; N = 0 gives the exact reading.
    ///
    /// The sensor does not detect its own robot. N scales the distance, except for the reflectance sensor, where it
    /// scales the signal; for PSD and sonar this is our choice.
    pub fn read(&self, caster: &RayCaster, world_from_sensor: &Pose3, noise: f64) -> Reading {
        let hit = |range: f64| {
            let direction = world_from_sensor.forward();
            let hit = caster.cast(&Ray::new(world_from_sensor.position, direction, range))?;
            Some((hit.distance, incidence(direction, hit.face?.normal)))
        };
        match self {
            Self::Psd { range } => Reading::of_distance(hit(*range).map(|(distance, _)| distance), noise),
            Self::Laser(echo) | Self::Ultrasonic(echo) => echo.time_of_flight(hit(echo.max), noise),
            Self::Reflectance(echo) => echo.reflectance(hit(echo.max), noise),
            Self::Sonar(sonar) => sonar.read(caster.world(), caster.robot(), world_from_sensor, caster.at(), noise),
        }
    }

    /// Minimum and maximum measurable distance, m.
    pub fn limits(&self) -> [f64; 2] {
        match self {
            Self::Psd { range } => [0.0, *range],
            Self::Laser(echo) | Self::Ultrasonic(echo) | Self::Reflectance(echo) => [echo.min, echo.max],
            Self::Sonar(sonar) => [sonar.min, sonar.max],
        }
    }

    /// Reading without return.
    pub fn no_return(&self) -> Reading {
        let distance = match self {
            Self::Psd { .. } | Self::Sonar(_) => None,
            Self::Laser(echo) | Self::Ultrasonic(echo) | Self::Reflectance(echo) => Some(echo.max),
        };
        Reading { distance, signal: 0.0 }
    }
}

impl Posture<'_> {
    /// World pose of a device at `mount` on the link with index `link`, or on the body if `link` is `None`.
    ///
    /// # Panics
    /// Like [`link_pose`].
    pub fn world_from(&self, mount: &Pose3, link: Option<usize>) -> Pose3 {
        let world_from_robot = Pose3::from_planar(&self.world_from_robot, self.lift);
        match link {
            Some(link) => world_from_robot.then(&link_pose(self.links, self.angles, link)).then(mount),
            None => world_from_robot.then(mount),
        }
    }
}

impl RangeSensor {
    /// World pose of the sensor of a robot in this posture.
    ///
    /// # Panics
    /// Like [`link_pose`].
    pub fn world_from_sensor(&self, posture: &Posture) -> Pose3 {
        posture.world_from(&self.mount, self.link)
    }

    /// Returns true for a level PSD on the body, which measures in the plane (see [`RangeSensor::read`]).
    pub fn is_level_psd(&self) -> bool {
        matches!(self.model, RangeModel::Psd { .. }) && self.link.is_none() && self.mount.is_level()
    }

    /// Reading of a level PSD on the body of a robot with this centre, unit vector of the heading, and height.
    pub(crate) fn read_level(
        &self,
        caster: &RayCaster,
        (centre, forward, lift): (DVec2, DVec2, f64),
        noise: f64,
    ) -> Reading {
        let origin = centre + forward.rotate(self.mount.position.truncate());
        let direction = forward.rotate(self.mount.forward().truncate());
        let [_, range] = self.model.limits();
        let ray = Ray::flat(origin, direction, range).at_height(self.mount.position.z + lift);
        Reading::of_distance(caster.cast(&ray).map(|hit| hit.distance), noise)
    }

    /// Reading of the sensor of the robot of `caster` in this posture, with the `noise` N: see [`RangeModel::read`].
    ///
    /// A level PSD on the body measures in the plane, like a [`Beam`](super::Beam). Walls and bodies are infinitely
    /// high for this sensor, but meshes and floating objects have their true heights.
    ///
    /// # Panics
    /// Like [`link_pose`].
    pub fn read(&self, caster: &RayCaster, posture: &Posture, noise: f64) -> Reading {
        let &Posture { world_from_robot: Pose { position, heading }, lift, .. } = posture;
        if self.is_level_psd() {
            return self.read_level(caster, (position, heading.direction(), lift), noise);
        }
        self.model.read(caster, &self.world_from_sensor(posture), noise)
    }
}

impl Reading {
    pub(super) fn of_distance(distance: Option<f64>, noise: f64) -> Self {
        let distance = distance.map(|distance| (distance * (1.0 + noise)).max(0.0));
        Self { distance, signal: if distance.is_some() { 1.0 } else { 0.0 } }
    }
}
