//! Ultrasonic sensors with a beam; they detect the nearest echo in the beam.

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

use glam::DVec3;

use super::{Reading, incidence};
use crate::{
    RobotId, math,
    pose::Pose3,
    scene::Surface,
    time::Time,
    world::{HitSurface, Ray, RayCaster, RayHit, World},
};

/// Maximum incidence angle at which a mirror's echo returns to the sensor, rad. The angle is much greater than rounding
/// errors; at the longest ranges it shifts the echo by a few um.
const MAX_MIRROR_INCIDENCE: f64 = 1e-6;

/// Angle between successive points of a spiral that covers a disc evenly, rad: the golden angle.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// An ultrasonic sensor with a beam: one transducer sends and receives, with the same gain in both directions.
///
/// Gains apply to energy, one way, and are 1 along the line of sight. The energy of an echo is relative to the echo of
/// a perfect reflector 1 m ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sonar {
    /// Minimum measurable distance, m. Echoes from nearer surfaces return while the sensor still transmits.
    pub min: f64,
    /// Maximum measurable distance, m.
    pub max: f64,
    /// Half of the beam angle, rad. At this angle, as in data sheets of transducers, the main lobe has fallen by 6 dB:
    /// to half of the pressure and a quarter of the energy.
    pub half_angle: f64,
    /// Side lobes.
    pub side_lobes: Option<SideLobes>,
    /// Detection threshold of the energy of an echo.
    pub threshold: f64,
    /// Number of rays of the fan, and of the spiral; at least 1.
    pub rays: u32,
}

/// A ring of sensitivity around the main lobe.
///
/// Source: France et al. 1999, Figures 4 and 5 (the pattern); a single Gaussian ring: our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideLobes {
    /// Angle between the line of sight and the maximum of the ring, rad.
    pub angle: f64,
    /// Half width of the ring, where the gain has fallen by 6 dB from its maximum, rad.
    pub half_width: f64,
    /// Maximum gain of the ring, relative to the main lobe.
    pub gain: f64,
}

impl Sonar {
    /// The SRF08 by Devantech.
    ///
    /// The published values are 3 cm to 6 m and a beam of about 55 degrees, the angle between the -6 dB points of its
    /// 40 kHz transducers. According to Gois & Hiller, section 6, the range is "actually much larger" than 6 m. The
    /// threshold of 0.00186 is our estimate. With this threshold the sensor just detects a rod of 3 cm at 2 m, as
    /// reported for similar sensors, and would detect a wall up to 23 m. No side lobes are published. The number of 64
    /// rays is our choice.
    pub fn srf08() -> Self {
        Self {
            min: 0.03,
            max: 6.0,
            half_angle: 27.5 / 180.0 * PI,
            side_lobes: None,
            threshold: 0.015 / 2.015 / 4.0,
            rays: 64,
        }
    }

    /// Gain at `angle` rad from the line of sight: the maximum of the Gaussian of the main lobe and the Gaussian of the
    /// side lobes. It is 0 behind the sensor.
    ///
    /// Source: Gois & Hiller, section 2.1 (a Gaussian approximates the gain with very good precision).
    pub fn gain(&self, angle: f64) -> f64 {
        if angle > FRAC_PI_2 {
            return 0.0;
        }
        // The gain is a quarter at ratio 1.
        let lobe = |ratio: f64| math::exp(-(2.0 * LN_2) * ratio * ratio);
        let main = lobe(angle / self.half_angle);
        let side = self.side_lobes.map_or(0.0, |ring| ring.gain * lobe((angle - ring.angle) / ring.half_width));
        main.max(side)
    }

    /// Energy of the echo of a surface that a ray hits at `angle` rad from the line of sight. It is G^2 / d^2 times the
    /// reflectivity times (the diffuse fraction times cos(alpha) plus, at normal incidence, the specular fraction).
    ///
    /// G is the one-way gain, d the distance and alpha the incidence angle. A convex mirror spreads the energy over an
    /// area that is larger by a factor (1 + d / r) for each of its principal radii r.
    ///
    /// Source: France et al. 1999, sections 3.2 and 3.3 (loss with distance; diffuse and specular surfaces). From
    /// geometrical acoustics: a wall larger than the beam, specular or rough, returns 1 / d^2; a convex mirror spreads
    /// the energy.
    pub fn energy(&self, angle: f64, distance: f64, face: &HitSurface, alpha: f64) -> f64 {
        let Surface { reflectivity, specular } = face.surface;
        let spread = 1.0 + distance * face.curvature;
        let mirrored = if alpha <= MAX_MIRROR_INCIDENCE { specular / (spread.x * spread.y) } else { 0.0 };
        let scattered = (1.0 - specular) * math::cos(alpha).max(0.0);
        let ratio = self.gain(angle) / distance;
        ratio * ratio * reflectivity * (mirrored + scattered)
    }

    /// Reading of a sensor of the robot `observer` with the pose `world_from_sensor` at the instant `at`; the distance
    /// has the relative error `noise`, N of France et al. The robot itself returns no echo.
    ///
    /// The reading is the nearest echo above the threshold. Echoes are searched along the line of sight, towards the
    /// nearest point of every body in reach, along a horizontal fan of rays and, if this may not suffice, along a
    /// spiral of rays. The search towards the nearest points finds mirrors, and is exact for surfaces that face the
    /// sensor. In a world with meshes, a ray perpendicular to each surface that a ray of the fan or spiral hits is cast
    /// too. Second reflections are ignored.
    ///
    /// The fan covers the azimuths, and the spiral the part of the half space, from which an echo may be detected. The
    /// fan suffices if the sensor is level, all bodies that are nearer than the nearest echo so far are upright and
    /// reach up to the sensor, and the floor, if there is one, is a perfect mirror.
    ///
    /// Source: France et al. 1999, section 3.2 (a single reflection); Gois & Hiller, section 2.1 (the beam); rays and
    /// nearest points: our choice.
    pub fn read(&self, world: &World, observer: RobotId, world_from_sensor: &Pose3, at: Time, noise: f64) -> Reading {
        let (count, origin) = (self.rays as usize, world_from_sensor.position.truncate());
        let caster = world.caster_near(observer, at, count, origin, self.max);
        let mut search =
            EchoSearch { sonar: self, world, observer, caster, world_from_sensor, at, distance: self.max, energy: 0.0 };
        search.try_direction(world_from_sensor.forward(), 0.0);
        search.try_nearest_points();
        search.try_horizontal_fan();
        if !search.is_horizontal_fan_sufficient() {
            search.try_spiral();
        }
        match search.energy > 0.0 {
            true => Reading { distance: Some((search.distance * (1.0 + noise)).max(0.0)), signal: search.energy },
            false => Reading { distance: None, signal: 0.0 },
        }
    }

    /// Maximum distance at which a perfect reflector is detectable, at `angle` rad from the line of sight, m.
    fn max_distance_at(&self, angle: f64) -> f64 {
        (self.gain(angle) / self.threshold.sqrt()).min(self.max)
    }

    /// Angle from the line of sight beyond which no echo is detectable at more than the minimum distance, rad.
    fn aperture(&self) -> f64 {
        let min_distance = self.min * self.threshold.sqrt();
        let width =
            |gain: f64, half_width: f64| half_width * (math::ln((gain / min_distance).max(1.0)) / (2.0 * LN_2)).sqrt();
        let side = self.side_lobes.map_or(0.0, |ring| ring.angle + width(ring.gain, ring.half_width));
        width(1.0, self.half_angle).max(side).min(FRAC_PI_2)
    }
}

/// Search for the nearest echo of a sonar at one instant.
struct EchoSearch<'a> {
    sonar: &'a Sonar,
    world: &'a World,
    observer: RobotId,
    caster: RayCaster<'a>,
    world_from_sensor: &'a Pose3,
    at: Time,
    /// Distance of the nearest echo so far; initially the maximum distance.
    distance: f64,
    /// Energy of the nearest echo so far; 0 if there is none.
    energy: f64,
}

impl EchoSearch<'_> {
    /// Casts a ray along `direction`, `angle` rad from the line of sight, and keeps the echo if it is detectable and
    /// the nearest so far. Returns the surface that the ray hits, if the echo could be the nearest.
    fn try_direction(&mut self, direction: DVec3, angle: f64) -> Option<HitSurface> {
        let range = self.sonar.max_distance_at(angle).min(self.distance);
        if range < self.sonar.min {
            return None;
        }
        let ray = Ray::new(self.world_from_sensor.position, direction, range);
        let RayHit { distance, face, .. } = self.caster.cast(&ray)?;
        let face = face?;
        if distance < self.sonar.min || distance == self.distance && self.energy > 0.0 {
            return None;
        }
        let energy = self.sonar.energy(angle, distance, &face, incidence(direction, face.normal));
        if energy >= self.sonar.threshold && energy > 0.0 {
            (self.distance, self.energy) = (distance, energy);
        }
        Some(face)
    }

    fn try_nearest_points(&mut self) {
        let (origin, forward) = (self.world_from_sensor.position, self.world_from_sensor.forward());
        let mut points = Vec::new();
        self.world.for_each_nearest(self.observer, origin, self.distance, self.at, |point| {
            let offset = point - origin;
            let length = offset.length();
            // No echo can be detected from behind the sensor. If the sensor is inside a body, the direction is
            // undefined.
            if offset.dot(forward) > 0.0 && self.sonar.min <= length && length <= self.distance {
                points.push(offset / length);
            }
        });
        for direction in points {
            self.try_direction(direction, angle_between(direction, forward));
        }
    }

    /// Tries rays in the horizontal plane through the sensor, alternately on both sides, from the line of sight outwards.
    fn try_horizontal_fan(&mut self) {
        let aperture = self.sonar.aperture();
        let forward = self.world_from_sensor.forward();
        let is_level = forward.z == 0.0;
        let (middle, max_azimuth) = if is_level {
            (forward, aperture)
        } else {
            // The cosine of the angle from the line of sight is that of the azimuth times that of the pitch.
            let cos_pitch = forward.truncate().length();
            let cos_max_azimuth = math::cos(aperture) / cos_pitch;
            if cos_pitch == 0.0 || cos_max_azimuth > 1.0 {
                return;
            }
            let sin_max_azimuth = (1.0 - cos_max_azimuth * cos_max_azimuth).sqrt();
            ((forward.truncate() / cos_pitch).extend(0.0), math::atan2(sin_max_azimuth, cos_max_azimuth))
        };
        let left = DVec3::new(-middle.y, middle.x, 0.0);
        let last_ray = f64::from(self.sonar.rays.max(2) - 1);
        // The line of sight of a level sensor has been tried.
        for ray in u32::from(is_level)..self.sonar.rays {
            let ray = f64::from(ray);
            let side = if ray % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let azimuth = max_azimuth * (ray * 0.5).ceil() / (last_ray * 0.5).ceil();
            let (sin, cos) = math::sin_cos(azimuth);
            let direction = middle * cos + left * side * sin;
            self.try_ray(direction, if is_level { azimuth } else { angle_between(direction, forward) });
        }
    }

    /// Returns true if no ray outside the horizontal fan can find a nearer echo: the sensor is level, and on each
    /// surface that is nearer than the nearest echo the point at the sensor's height is the nearest.
    fn is_horizontal_fan_sufficient(&self) -> bool {
        let Pose3 { position, rotation } = *self.world_from_sensor;
        let is_mirror = self.world.floor_surface().is_none_or(|floor| floor.specular == 1.0);
        is_mirror
            && rotation.x_axis.z == 0.0
            && self.world.is_upright_near(self.observer, position, self.distance, self.at)
    }

    /// Tries a spiral of rays from the line of sight outwards.
    fn try_spiral(&mut self) {
        let aperture = self.sonar.aperture();
        let rotation = self.world_from_sensor.rotation;
        let last_ray = f64::from(self.sonar.rays.max(2) - 1);
        for ray in 1..self.sonar.rays {
            let ray = f64::from(ray);
            let (sin, cos) = math::sin_cos(ray * GOLDEN_ANGLE);
            let offset = rotation.y_axis * cos + rotation.z_axis * sin;
            let angle = aperture * (ray / last_ray).sqrt();
            let (sin, cos) = math::sin_cos(angle);
            self.try_ray(rotation.x_axis * cos + offset * sin, angle);
        }
    }

    /// Casts a ray along `direction`, `angle` rad from the line of sight. In a world with meshes, also casts a ray
    /// perpendicular to the surface that the first ray hits.
    fn try_ray(&mut self, direction: DVec3, angle: f64) {
        let hit = self.try_direction(direction, angle);
        if let Some(hit) = hit.filter(|_| self.world.has_meshes()) {
            self.try_direction(-hit.normal, angle_between(-hit.normal, self.world_from_sensor.forward()));
        }
    }
}

/// Angle between two unit vectors, 0 to pi rad.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    math::atan2(a.cross(b).length(), a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beam_falls_by_6_db_at_its_half_angle() {
        let sonar = Sonar::srf08();
        assert_eq!(sonar.gain(0.0), 1.0);
        assert!((sonar.gain(sonar.half_angle) - 0.25).abs() < 1e-15);
        assert!((sonar.gain(2.0 * sonar.half_angle) - 1.0 / 256.0).abs() < 1e-15);
        assert_eq!(sonar.gain(0.51 * PI), 0.0);
    }

    #[test]
    fn side_lobes_exceed_the_main_lobe_where_it_is_weak() {
        let ring = SideLobes { angle: 1.0, half_width: 0.1, gain: 0.05 };
        let sonar = Sonar { half_angle: 0.25, side_lobes: Some(ring), ..Sonar::srf08() };
        assert_eq!(sonar.gain(0.0), 1.0);
        assert_eq!(sonar.gain(1.0), 0.05);
        assert!(sonar.gain(0.7) < 0.01, "a dip lies between the lobes");
    }
}
