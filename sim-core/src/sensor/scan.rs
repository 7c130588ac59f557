use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::Mount;
use crate::{
    RobotId,
    pose::{Pose, Pose3},
    time::Time,
    world::{Ray, Tilt, World},
};

/// A laser scanner: a fan of rays in the robot's frame, from left to right.
///
/// In a fan of n rays, ray i is (n/2 - i) spacings to the left of the line of sight, with n/2 rounded down, so ray n/2
/// points exactly ahead. The fan turns with the robot. A full turn has n spacings and begins straight behind (for an
/// even n). A smaller sweep begins half of the sweep to the left. For an odd n it ends half of the sweep to the right;
/// for an even n it ends one spacing earlier. So the spacing is 1 degree for 180 degrees and 180 or 181 points.
///
/// A tilted fan is a cone: all of its rays rise or fall at the same angle. Distances are measured along the rays.
///
/// Source: `LIDARGet` of RoBIOS-7 for the middle and the order of the points; spacing and tilt are our choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    mount: Mount,
    spacing: f64,
    range: f64,
    height: f64,
    tilt: Tilt,
    /// Unit vectors in the sensor's frame.
    rays: Vec<DVec2>,
}

/// Parameters of a [`Scan`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Angle that the scan covers, half of it on either side of the line of sight, rad; limited to a full turn.
    pub sweep: f64,
    /// Number of rays.
    pub points: u32,
    /// Angle of the rays above the horizontal, rad; limited to 89 degrees up or down.
    pub tilt: f64,
    /// Height of the sensor above the floor, m; 0 or more.
    pub height: f64,
    /// Range along a ray, m; may be infinite.
    pub range: f64,
}

/// Steepest tilt, rad.
const MAX_TILT: f64 = 89.0 / 360.0 * TAU;

impl Scan {
    /// A scanner at `mount`; the middle of its fan points along the mount's line of sight.
    pub fn new(mount: Mount, fan: Fan) -> Self {
        let Fan { sweep, points, tilt, height, range } = fan;
        let sweep = sweep.clamp(0.0, TAU);
        // The conversion of a full turn from degrees may have been rounded.
        let is_closed = sweep >= TAU - 1e-9;
        let spacings = if is_closed || points.is_multiple_of(2) { points } else { points - 1 };
        let spacing = if spacings > 0 { sweep / f64::from(spacings) } else { 0.0 };
        let tilt = Tilt::new(tilt.clamp(-MAX_TILT, MAX_TILT));
        let bearing = |ray| bearing(points, spacing, ray);
        let rays = (0..points).map(|ray| Pose::new(0.0, 0.0, bearing(ray)).heading.direction()).collect();
        Self { mount, spacing, range, height: height.max(0.0), tilt, rays }
    }

    /// Range along a ray, m; may be infinite.
    pub fn range(&self) -> f64 {
        self.range
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Returns true if the scanner has no rays.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Mounting pose.
    pub fn mount(&self) -> &Mount {
        &self.mount
    }

    /// Angle between neighbouring rays, rad.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Direction of ray `ray` in the sensor's frame, rad counter-clockwise from the line of sight.
    pub fn bearing(&self, ray: u32) -> f64 {
        bearing(self.rays.len() as u32, self.spacing, ray)
    }

    /// Height of the scanner above the floor when mounted on the body, m.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Direction of ray `ray` in the sensor's frame, a unit vector: x along the line of sight, z up.
    ///
    /// # Panics
    /// If the ray does not exist.
    pub fn direction(&self, ray: u32) -> DVec3 {
        self.tilt.direction(self.rays[ray as usize])
    }

    /// Distances measured by the scanner of the robot `observer`, whose centre is at `world_from_robot` at the instant
    /// `at`. For each ray, this is the distance along the ray to the first hit, m, or `None` if nothing is within
    /// range. All rays are cast at the same instant.
    ///
    /// [`Ray::tilted`] constructs the rays (our choice). They do not hit the robot itself. The caller adds noise.
    pub fn distances(&self, world: &World, observer: RobotId, world_from_robot: &Pose, at: Time) -> Vec<Option<f64>> {
        let (origin, ahead) = self.mount.ray(world_from_robot);
        let caster = world.caster_near(observer, at, self.len(), origin, self.range);
        let origin = origin.extend(self.height);
        let measure = |ray: &DVec2| {
            let ray = Ray::tilted(origin, ahead.rotate(*ray), &self.tilt, self.range);
            caster.cast(&ray).map(|hit| hit.distance)
        };
        self.rays.iter().map(measure).collect()
    }

    /// Like [`Scan::distances`], for a scanner at `world_from_sensor`, with any roll and pitch, instead of at its
    /// mount. [`Ray::new`] constructs the rays, which hit bodies up to their heights.
    ///
    /// The fan, tilt included, is fixed in the sensor's frame.
    pub fn distances_from(
        &self,
        world: &World,
        observer: RobotId,
        world_from_sensor: &Pose3,
        at: Time,
    ) -> Vec<Option<f64>> {
        let origin = world_from_sensor.position.truncate();
        let caster = world.caster_near(observer, at, self.len(), origin, self.range);
        let measure = |ray: &DVec2| {
            let direction = world_from_sensor.rotation * self.tilt.direction(*ray);
            let ray = Ray::new(world_from_sensor.position, direction, self.range);
            caster.cast(&ray).map(|hit| hit.distance)
        };
        self.rays.iter().map(measure).collect()
    }
}

fn bearing(points: u32, spacing: f64, ray: u32) -> f64 {
    (f64::from(points / 2) - f64::from(ray)) * spacing
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn bearings(sweep_deg: f64, points: u32) -> Vec<f64> {
        let fan = Fan { sweep: sweep_deg.to_radians(), points, tilt: 0.0, height: 0.1, range: 9.0 };
        let scan = Scan::new(Mount::default(), fan);
        assert_eq!(scan.len(), points as usize);
        (0..points).map(|ray| (scan.bearing(ray) * 180.0 / PI * 1e9).round() / 1e9).collect()
    }

    #[test]
    fn the_middle_ray_points_ahead_and_the_first_rays_to_the_left() {
        assert_eq!(bearings(360.0, 4), [180.0, 90.0, 0.0, -90.0]);
        assert_eq!(bearings(360.0, 5), [144.0, 72.0, 0.0, -72.0, -144.0]);
        assert_eq!(bearings(180.0, 4), [90.0, 45.0, 0.0, -45.0]);
        assert_eq!(bearings(180.0, 5), [90.0, 45.0, 0.0, -45.0, -90.0]);
        assert_eq!(bearings(90.0, 1), [0.0]);
        assert_eq!(bearings(90.0, 2), [45.0, 0.0]);
        assert_eq!(bearings(90.0, 0), [0.0; 0]);
        assert_eq!(bearings(0.0, 3), [0.0; 3]);
        assert_eq!(bearings(720.0, 4), [180.0, 90.0, 0.0, -90.0]);
        let degrees = bearings(360.0, 360);
        assert_eq!((degrees[0], degrees[180], degrees[90], degrees[359]), (180.0, 0.0, 90.0, -179.0));
    }
}
