//! Inverse model of a wide sonar: a fuzzy set of the points that may have echoed, and its shadow on the plane of a map.
//!
//! Source: Gois and Hiller, sections 2 and 3. Their Eq. 1 has the domains of beta and r exchanged: here beta is in
//! [0, 2 pi) and r in [0, r_max].

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

use nalgebra::Vector3;

use crate::math;

/// Position and line of sight of a sonar, in the frame of the map (z up, m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarPose {
    /// Position, m.
    pub origin: Vector3<f64>,
    /// Unit vector along the line of sight.
    pub axis: Vector3<f64>,
}

impl SonarPose {
    /// Pose at `origin` with the line of sight at `yaw` (counter-clockwise from x) and `pitch` (upwards), rad.
    pub fn new(origin: Vector3<f64>, yaw: f64, pitch: f64) -> Self {
        let horizontal = math::cos(pitch);
        Self { origin, axis: Vector3::new(horizontal * math::cos(yaw), horizontal * math::sin(yaw), math::sin(pitch)) }
    }

    /// The point on the line of sight at `distance` m.
    pub fn ahead(&self, distance: f64) -> Vector3<f64> {
        self.origin + self.axis * distance
    }

    /// Angle between the line of sight and the direction to `point`, rad in [0, pi]; 0 at the sonar itself.
    pub fn angle_to(&self, point: &Vector3<f64>) -> f64 {
        let offset = point - self.origin;
        let length = offset.norm();
        if length == 0.0 { 0.0 } else { math::acos(offset.dot(&self.axis) / length) }
    }
}

/// Choice between the two points at which a vertical line meets the sphere of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The point with the greater membership, or the lower one if both are equal: the supremum of the paper.
    MostPossible,
    /// The lower point, for any pitch of the sonar: the ground is not above this point (our choice).
    Lower,
}

/// The inverse model of a sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarModel {
    /// Angle from the line of sight at which the gain has fallen to a quarter, rad.
    pub half_angle: f64,
    /// Maximum error of a reading as a fraction of it: two standard deviations of the Gaussian over r (our choice).
    pub epsilon: f64,
    /// Maximum distance that the sonar measures, m: r_max.
    pub max: f64,
    /// Memberships below this value are treated as 0.
    pub min_membership: f64,
}

/// Projection of a reading's fuzzy set at a point of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// The maximum membership over all heights at that point.
    pub membership: f64,
    /// The height of the maximum membership, m.
    pub height: f64,
}

impl SonarModel {
    /// The SRF08 by Devantech: a beam of about 55 degrees between its points of -6 dB, up to 6 m.
    ///
    /// Readings have an error of at most 3 %, and the cut is at a membership of 0.05 (our choice).
    pub fn srf08() -> Self {
        Self { half_angle: 27.5 / 180.0 * PI, epsilon: 0.03, max: 6.0, min_membership: 0.05 }
    }

    /// Membership of the angle `alpha` (rad) from the line of sight in the set A: the beam gain, a Gaussian; 0 beyond a
    /// right angle.
    pub fn membership_of_alpha(&self, alpha: f64) -> f64 {
        let ratio = alpha / self.half_angle;
        if alpha > FRAC_PI_2 { 0.0 } else { math::exp(-2.0 * LN_2 * ratio * ratio) }
    }

    /// Membership of a rotation about the line of sight in the set B: always 1.
    pub fn membership_of_beta(&self, _beta: f64) -> f64 {
        1.0
    }

    /// Membership of the distance `r` in the set R of a reading `measured`, both m: a Gaussian of the relative error;
    /// 0 outside [0, r_max].
    pub fn membership_of_r(&self, r: f64, measured: f64) -> f64 {
        if !(0.0..=self.max).contains(&r) {
            return 0.0;
        }
        let ratio = 2.0 * (r - measured) / (self.epsilon * measured);
        math::exp(-0.5 * ratio * ratio)
    }

    /// Membership of a point in the set S of a reading (Eq. 2): the product of the memberships in A, B and R.
    pub fn membership(&self, sonar: &SonarPose, measured: f64, point: &Vector3<f64>) -> f64 {
        let r = (point - sonar.origin).norm();
        self.membership_of_alpha(sonar.angle_to(point))
            * self.membership_of_beta(0.0)
            * self.membership_of_r(r, measured)
    }

    /// Shadow of a reading at the point (x, y) of the plane: the supremum of S over z. The distance is taken as exact,
    /// so S is a spherical cap, and `side` chooses one of its points. `None` if the membership is below
    /// [`min_membership`](Self::min_membership).
    ///
    /// Source: Gois and Hiller, section 3, with R neglected and the projection in closed form.
    pub fn shadow(&self, sonar: &SonarPose, measured: f64, x: f64, y: f64, side: Side) -> Option<Shadow> {
        let (cosine, height) = cap_point(sonar, measured, x, y, side)?;
        let membership = self.membership_of_alpha(math::acos(cosine));
        (membership >= self.min_membership).then_some(Shadow { membership, height })
    }

    /// Shadow with the errors of the distance (R): the maximum of S over `steps` + 1 equally spaced heights, from the
    /// maximum distance below the sonar to the same distance above it. This method is for comparison; it takes about
    /// `steps` times as long as [`shadow`](Self::shadow).
    pub fn shadow_with_range(&self, sonar: &SonarPose, measured: f64, x: f64, y: f64, steps: usize) -> Option<Shadow> {
        let max_distance = measured * (1.0 + 2.0 * self.epsilon);
        let height = |step: usize| sonar.origin.z + max_distance * (2.0 * step as f64 / steps as f64 - 1.0);
        (0..=steps)
            .map(|step| {
                let point = Vector3::new(x, y, height(step));
                Shadow { membership: self.membership(sonar, measured, &point), height: point.z }
            })
            .max_by(|a, b| a.membership.total_cmp(&b.membership))
            .filter(|shadow| shadow.membership >= self.min_membership)
    }

    /// Angle from the line of sight at which the membership in A is [`min_membership`](Self::min_membership), rad.
    pub fn aperture(&self) -> f64 {
        (self.half_angle * (-math::ln(self.min_membership) / (2.0 * LN_2)).sqrt()).min(FRAC_PI_2)
    }

    /// Extent of the points within the aperture: minimum and maximum of x and of y, relative to the sonar, as fractions
    /// of the maximum distance. The intervals are slightly larger, so that rounding excludes no point.
    pub(crate) fn extents(&self, sonar: &SonarPose) -> [[f64; 2]; 2] {
        let aperture = self.aperture();
        let max_component = |along: f64| {
            let angle = math::acos(along.clamp(-1.0, 1.0));
            if angle <= aperture { 1.0 } else { math::cos(angle - aperture).max(0.0) }
        };
        [sonar.axis.x, sonar.axis.y].map(|along| [-max_component(-along) - 1e-6, max_component(along) + 1e-6])
    }
}

/// Point above or below (x, y) on the cap of a reading, as the cosine of its angle from the line of sight and its
/// height in m. `None` if there is no such point or if the cosine is not above 0.
pub fn cap_point(sonar: &SonarPose, measured: f64, x: f64, y: f64, side: Side) -> Option<(f64, f64)> {
    let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
    let square = measured * measured - dx * dx - dy * dy;
    if square < 0.0 || measured <= 0.0 {
        return None;
    }
    let is_upper = side == Side::MostPossible && sonar.axis.z > 0.0;
    let rise = if is_upper { square.sqrt() } else { -square.sqrt() };
    let cosine = (dx * sonar.axis.x + dy * sonar.axis.y + rise * sonar.axis.z) / measured;
    (cosine > 0.0).then_some((cosine, sonar.origin.z + rise))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn down(height: f64) -> SonarPose {
        SonarPose::new(Vector3::new(0.0, 0.0, height), 0.0, -FRAC_PI_2)
    }

    #[test]
    fn memberships_are_1_at_the_reading_and_fall_as_defined() {
        let model = SonarModel::srf08();
        assert_eq!(model.membership_of_alpha(0.0), 1.0);
        assert!((model.membership_of_alpha(model.half_angle) - 0.25).abs() < 1e-15);
        assert_eq!(model.membership_of_alpha(1.6), 0.0);
        assert_eq!(model.membership_of_r(2.0, 2.0), 1.0);
        assert!((model.membership_of_r(2.06, 2.0) - math::exp(-2.0)).abs() < 1e-12);
        assert_eq!(model.membership_of_r(6.1, 6.1), 0.0);
        assert!((model.membership_of_alpha(model.aperture()) - model.min_membership).abs() < 1e-12);
        let sonar = down(3.0);
        assert_eq!(model.membership(&sonar, 2.0, &sonar.ahead(2.0)), 1.0);
    }

    #[test]
    fn shadow_of_a_downward_sonar_is_a_cap() {
        let model = SonarModel::srf08();
        let middle = model.shadow(&down(3.0), 2.0, 0.0, 0.0, Side::MostPossible).unwrap();
        assert!((middle.membership - 1.0).abs() < 1e-12 && (middle.height - 1.0).abs() < 1e-12);
        // The cap has the radius 2 m. At 0.6 m from the axis it is higher than in its middle.
        let off_axis = model.shadow(&down(3.0), 2.0, 0.0, 1.2 * 0.5, Side::MostPossible).unwrap();
        assert!((off_axis.height - (3.0 - (4.0f64 - 0.36).sqrt())).abs() < 1e-12);
        assert!((off_axis.membership - model.membership_of_alpha(math::asin(0.3))).abs() < 1e-12);
        assert_eq!(model.shadow(&down(3.0), 2.0, 1.9, 0.0, Side::MostPossible), None);
        assert_eq!(model.shadow(&down(3.0), 2.0, 2.1, 0.0, Side::MostPossible), None);
    }

    #[test]
    fn shadow_of_a_level_sonar_is_a_crescent_with_the_lower_heights() {
        let model = SonarModel::srf08();
        let level = SonarPose::new(Vector3::new(0.0, 0.0, 1.0), 0.0, 0.0);
        let tip = model.shadow(&level, 2.0, 2.0, 0.0, Side::MostPossible).unwrap();
        assert!((tip.membership - 1.0).abs() < 1e-12 && (tip.height - 1.0).abs() < 1e-7);
        let nearer = model.shadow(&level, 2.0, 1.8, 0.0, Side::MostPossible).unwrap();
        assert!(nearer.membership < 1.0 && (nearer.height - (1.0 - 0.76f64.sqrt())).abs() < 1e-12);
        assert_eq!(model.shadow(&level, 2.0, -2.0, 0.0, Side::MostPossible), None);
    }

    /// Neglecting R changes the height by less than the width of R, so the paper neglects R.
    #[test]
    fn neglecting_range_errors_changes_little_for_steep_beams() {
        let model = SonarModel::srf08();
        for (yaw, pitch) in [(0.0, -FRAC_PI_2), (0.4, -1.2), (1.0, -0.9)] {
            let sonar = SonarPose::new(Vector3::new(0.3, -0.2, 2.5), yaw, pitch);
            let tip = sonar.ahead(2.2);
            for (dx, dy) in [(0.0, 0.0), (0.2, 0.1), (-0.3, 0.2), (0.0, -0.4)] {
                let (x, y) = (tip.x + dx, tip.y + dy);
                let analytic = model.shadow(&sonar, 2.2, x, y, Side::MostPossible);
                let exact = model.shadow_with_range(&sonar, 2.2, x, y, 4000);
                let (Some(analytic), Some(exact)) = (analytic, exact) else { panic!("within the beam") };
                assert!((analytic.membership - exact.membership).abs() < 0.03, "{analytic:?} {exact:?}");
                assert!((analytic.height - exact.height).abs() < 2.0 * model.epsilon * 2.2, "{analytic:?} {exact:?}");
            }
        }
    }
}
