//! Laser, ultrasonic and reflectance sensors of France et al. 1999.

use glam::DVec3;

use super::Reading;
use crate::math;

/// Standard deviation of the paper's relative noise N; the mean of N is 0. N scales the distance of laser and
/// ultrasonic sensors, and the signal of reflectance sensors. Source: France et al. 1999, section 5.
pub const FRANCE_1999_SIGMA: f64 = 0.01;

/// Tolerance of the incidence limit for rounding of poses and normals, rad.
const ANGLE_ROUNDING: f64 = 1e-10;

/// A sensor with one ray that detects an echo only within ranges of distance and incidence, ends included.
///
/// Source: France et al. 1999, section 5, with the paper's values in the three constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// Minimum measurable distance, m.
    pub min: f64,
    /// Maximum measurable distance, m; also the reading if there is no echo.
    pub max: f64,
    /// Maximum angle between the ray and the surface's normal, rad.
    pub max_incidence: f64,
}

impl Echo {
    /// The laser range finder: 0 to 2 m, 45 degrees.
    pub const LASER: Self = Self { min: 0.0, max: 2.0, max_incidence: std::f64::consts::FRAC_PI_4 };

    /// The ultrasonic sensor: 0.1 to 1 m, 15 degrees.
    pub const ULTRASONIC: Self = Self { min: 0.1, max: 1.0, max_incidence: std::f64::consts::PI / 12.0 };

    /// The reflectance sensor: 0 to 1 m, 90 degrees.
    pub const REFLECTANCE: Self = Self { min: 0.0, max: 1.0, max_incidence: std::f64::consts::FRAC_PI_2 };

    /// Returns true if the sensor detects a surface at `distance` (m) with the incidence angle `incidence` (rad).
    pub fn detects(&self, distance: f64, incidence: f64) -> bool {
        (self.min..=self.max).contains(&distance) && incidence <= self.max_incidence + ANGLE_ROUNDING
    }

    /// Reading of a laser or ultrasonic sensor. `hit` is (distance d in m, incidence in rad), `noise` the paper's N.
    /// With an echo, the distance is d (1 + N) and the signal is 1. Without an echo, the distance is the maximum and
    /// the signal is 0.
    ///
    /// Source: France et al., section 5. The distance is never below 0: our choice.
    pub fn time_of_flight(&self, hit: Option<(f64, f64)>, noise: f64) -> Reading {
        match hit {
            Some((distance, incidence)) if self.detects(distance, incidence) => {
                Reading { distance: Some((distance * (1.0 + noise)).max(0.0)), signal: 1.0 }
            }
            _ => Reading { distance: Some(self.max), signal: 0.0 },
        }
    }

    /// Reading of a reflectance sensor for a hit at (distance in m, incidence in rad), with the paper's `noise` N. The
    /// signal is that of [`reflected_signal`], the distance that of [`recovered_distance`]. Without an echo, the signal
    /// is 0 and the distance is the maximum.
    ///
    /// Source: France et al., Eq. 1 and section 5.
    pub fn reflectance(&self, hit: Option<(f64, f64)>, noise: f64) -> Reading {
        match hit {
            Some((distance, incidence)) if self.detects(distance, incidence) => {
                let signal = reflected_signal(distance, incidence, self.max, noise);
                Reading { distance: Some(recovered_distance(signal, self.max)), signal }
            }
            _ => Reading { distance: Some(self.max), signal: 0.0 },
        }
    }
}

/// Incidence angle, 0 to pi/2 rad: the angle between a ray along `direction` and the normal of the surface that the ray
/// hits, for either orientation of the normal.
///
/// The computation from sine and cosine is equally accurate at normal and at grazing incidence.
pub fn incidence(direction: DVec3, normal: DVec3) -> f64 {
    math::atan2(direction.cross(normal).length(), direction.dot(normal).abs())
}

/// Signal of a reflectance sensor, 1/m: s = cos^2(alpha) (1 + N) (max - d) / d^2, at least 0. It is infinite at d = 0.
///
/// `distance` d and `max` in m, `incidence` alpha in rad up to pi/2, `noise` N.
///
/// Source: France et al., Eq. 1; the lower bound is from the same section.
pub fn reflected_signal(distance: f64, incidence: f64, max: f64, noise: f64) -> f64 {
    let cos = if incidence >= std::f64::consts::FRAC_PI_2 { 0.0 } else { math::cos(incidence) };
    let strength = cos * cos * (1.0 + noise);
    if strength <= 0.0 || distance >= max {
        return 0.0;
    }
    // Divides twice by d, since d^2 of a small d may round to 0.
    (max - distance) / distance / distance * strength
}

/// Distance at which a surface at normal incidence gives this `signal` (1/m), in m; 0 for an infinite signal, `max` for
/// signal 0.
///
/// The distance is the positive root d of s d^2 + d - max = 0 for the signal s, computed as
/// 2 max / (1 + sqrt(1 + 4 s max)). This form stays accurate as s goes to 0; the form in the paper,
/// (-1 + sqrt(1 + 4 s max)) / (2 s), loses all digits.
///
/// Source: France et al., section 5.
pub fn recovered_distance(signal: f64, max: f64) -> f64 {
    2.0 * max / (1.0 + (1.0 + 4.0 * signal.max(0.0) * max).sqrt())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use super::*;

    fn distance(reading: Reading) -> f64 {
        reading.distance.expect("the paper's sensors always read a distance")
    }

    #[test]
    fn limits_are_inclusive() {
        for (echo, limit) in [(Echo::LASER, FRAC_PI_4), (Echo::ULTRASONIC, PI / 12.0)] {
            let read = |d: f64, alpha: f64| distance(echo.time_of_flight(Some((d, alpha)), 0.0));
            assert_eq!([read(echo.min, 0.0), read(echo.max, 0.0)], [echo.min, echo.max]);
            assert_eq!(echo.time_of_flight(Some((echo.max, 0.0)), 0.0).signal, 1.0);
            assert_eq!(echo.time_of_flight(Some((echo.max + 1e-12, 0.0)), 0.0).signal, 0.0);
            assert_eq!([read(0.5, limit - 1e-9), read(0.5, limit), read(0.5, limit + 1e-9)], [0.5, 0.5, echo.max]);
            assert_eq!(distance(echo.time_of_flight(None, 0.0)), echo.max);
        }
        assert_eq!(distance(Echo::ULTRASONIC.time_of_flight(Some((0.1 - 1e-12, 0.0)), 0.0)), 1.0, "in the dead zone");
        assert_eq!(distance(Echo::LASER.time_of_flight(Some((1.0, 0.0)), 0.03)), 1.03);
        assert_eq!(distance(Echo::LASER.time_of_flight(Some((1.0, 0.0)), -2.0)), 0.0);
    }

    #[test]
    fn incidence_is_accurate_at_normal_and_grazing_incidence() {
        let normal = DVec3::new(0.0, 0.0, 1.0);
        for angle in [0.0, 1e-12, 1e-9, 0.3, FRAC_PI_4, FRAC_PI_4 + 1e-9, 1.5, FRAC_PI_2 - 1e-9, FRAC_PI_2 - 1e-12] {
            let (sin, cos) = math::sin_cos(angle);
            for direction in [DVec3::new(sin, 0.0, -cos), DVec3::new(0.0, -sin, cos)] {
                assert!((incidence(direction, normal) - angle).abs() < 3e-16, "{angle}");
            }
        }
    }

    #[test]
    fn signal_and_recovered_distance_are_inverse_at_all_distances() {
        let max = 1.0;
        for exponent in 0..150 {
            for d in [libm::pow(10.0, -f64::from(exponent)), 1.0 - libm::pow(10.0, -f64::from(exponent) / 20.0)] {
                let found = recovered_distance(reflected_signal(d, 0.0, max, 0.0), max);
                // Near the maximum distance the signal, a small difference of distances, loses digits; d does not.
                assert!((found - d).abs() <= 4e-16 * d, "{d}: {found}");
            }
        }
    }

    #[test]
    fn limits_of_the_signal_are_defined() {
        assert_eq!(reflected_signal(0.0, 0.0, 1.0, 0.0), f64::INFINITY);
        assert_eq!(recovered_distance(f64::INFINITY, 1.0), 0.0);
        assert_eq!(reflected_signal(1.0, 0.0, 1.0, 0.0), 0.0);
        assert_eq!(recovered_distance(0.0, 1.0), 1.0);
        assert_eq!(reflected_signal(0.0, FRAC_PI_2, 1.0, 0.0), 0.0);
        assert_eq!(reflected_signal(0.5, 0.0, 1.0, -1.5), 0.0, "clamped");
        assert_eq!(recovered_distance(-3.0, 1.0), 1.0);
        // Half way: s = 0.5 / 0.25 = 2, and 2 / (1 + 3) gives 0.5 back.
        let half = Echo::REFLECTANCE.reflectance(Some((0.5, 0.0)), 0.0);
        assert_eq!((half.signal, half.distance), (2.0, Some(0.5)));
        // At 60 degrees the signal is a quarter of 2, and the distance is 2 / (1 + sqrt(3)).
        let oblique = Echo::REFLECTANCE.reflectance(Some((0.5, PI / 3.0)), 0.0);
        assert!((oblique.signal - 0.5).abs() < 1e-15);
        assert!((distance(oblique) - 2.0 / (1.0 + 3.0_f64.sqrt())).abs() < 1e-15);
        let grazing = Echo::REFLECTANCE.reflectance(Some((0.5, FRAC_PI_2)), 0.0);
        assert_eq!((grazing.signal, grazing.distance), (0.0, Some(1.0)));
    }
}
