//! Corrects a robot's odometry pose by comparing readings with a map.
//!
//! A [`Belief`] is a normal distribution of the robot's pose. [`Belief::moved`] adds a motion measured by odometry,
//! with its errors. [`Belief::corrected`] multiplies the distribution by the likelihood of a scan at a grid of poses
//! around its mean. The result is the mean and the covariance of the product. Along a direction on which the scan has
//! no information (such as the axis of a corridor), the mean and the variance of odometry remain, without any
//! threshold. [`measurement`](crate::measurement) has two [`PoseLikelihood`]s: one of points on surfaces, one of sonar
//! ranges.
//!
//! Source: Olson 2009, "Real-time correlative scan matching", sections III (product of likelihood and odometry over a
//! grid of poses) and III.E (covariance from the grid); motion: Thrun, Burgard & Fox 2005, section 5.4. The window that
//! follows the distribution, instead of a fixed pyramid of grids, is our choice.

use nalgebra::{Matrix3, Vector3};

use crate::math;
use crate::pose::{Point, Pose, rotated, wrapped};

/// Log-likelihood of a scan as a function of the robot's pose.
pub trait PoseLikelihood {
    /// Log-likelihood at a position with each of the headings, in radians; a constant for all poses may be left out.
    fn at(&self, position: Point, headings: &[f64]) -> Vec<f64>;
}

/// Errors of odometry: standard deviations in proportion to the motion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OdometryNoise {
    /// Error of the heading per angle turned, rad/rad.
    pub turn: f64,
    /// Error of the heading per distance, rad/m.
    pub drift: f64,
    /// Error of the position along each axis per distance, m/m.
    pub distance: f64,
}

/// Normal distribution of a pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Belief {
    /// The mean.
    pub mean: Pose,
    /// Covariance of x, y (m) and heading (rad).
    pub covariance: Matrix3<f64>,
}

/// Half width of the window of poses, in standard deviations.
const WINDOW: f64 = 3.0;
/// Number of positions along x and along y. With these steps of 0.75 standard deviations, the moments of a normal
/// distribution are exact to 1e-4.
const POSITIONS: usize = 9;
/// Number of headings.
const HEADINGS: usize = 13;
/// Maximum number of windows; each is centred at the mean of the previous one.
const WINDOWS: usize = 4;
/// Minimum standard deviations of x, y (m) and heading (rad); smaller differences have no effect on a map.
const MIN_SIGMAS: [f64; 3] = [5e-4, 5e-4, 5e-4];

impl Belief {
    /// A pose that is known exactly.
    pub fn certain(mean: Pose) -> Self {
        Self { mean, covariance: Matrix3::zeros() }
    }

    /// Distribution after a motion between two poses of odometry, both in the frame of odometry.
    pub fn moved(&self, from: &Pose, to: &Pose, noise: &OdometryNoise) -> Self {
        let step = Pose { position: from.inward(to.position), heading: wrapped(to.heading - from.heading) };
        let mean = self.mean.then(&step);
        let offset = rotated(step.position.coords, self.mean.heading);
        let distance = offset.norm();
        // Heading errors turn the end of the motion about its start: by the heading error before the motion, and by
        // half of the heading error of the motion.
        let lever = Vector3::new(-offset.y, offset.x, 0.0);
        let jacobian = Matrix3::new(1.0, 0.0, lever.x, 0.0, 1.0, lever.y, 0.0, 0.0, 1.0);
        let heading_sigma = math::hypot(noise.turn * step.heading, noise.drift * distance);
        let heading_effect = 0.5 * lever + Vector3::new(0.0, 0.0, 1.0);
        let position_variance = (noise.distance * distance).powi(2);
        let covariance = jacobian * self.covariance * jacobian.transpose()
            + heading_effect * heading_effect.transpose() * heading_sigma.powi(2)
            + Matrix3::from_diagonal(&Vector3::new(position_variance, position_variance, 0.0));
        Self { mean, covariance }
    }

    /// Distribution after a scan: mean and covariance of the product of this distribution and the scan's likelihood.
    pub fn corrected(&self, scan: &impl PoseLikelihood) -> Self {
        let prior = self.covariance + Matrix3::from_diagonal(&Vector3::from(MIN_SIGMAS.map(|sigma| sigma * sigma)));
        let Some(information) = prior.try_inverse() else { return *self };
        let mut window =
            Window { middle: self.mean, half_widths: prior.diagonal().map(|variance| WINDOW * variance.sqrt()) };
        let mut found = *self;
        for _ in 0..WINDOWS {
            let (belief, is_fine) = window.moments(&self.mean, &information, scan);
            found = belief;
            if is_fine {
                break;
            }
            let steps = window.steps();
            window.middle = belief.mean;
            for axis in 0..3 {
                // Half a step is added, since the grid cannot resolve smaller deviations.
                let sigma = math::hypot(belief.covariance[(axis, axis)].sqrt(), 0.5 * steps[axis]);
                window.half_widths[axis] = window.half_widths[axis].min(WINDOW * sigma.max(MIN_SIGMAS[axis]));
            }
        }
        found
    }
}

/// A grid of poses around `middle`.
struct Window {
    middle: Pose,
    half_widths: Vector3<f64>,
}

impl Window {
    /// Steps of the grid along x, y and heading.
    fn steps(&self) -> Vector3<f64> {
        let intervals = |count: usize| (count - 1) as f64;
        (2.0 * self.half_widths).component_div(&Vector3::new(
            intervals(POSITIONS),
            intervals(POSITIONS),
            intervals(HEADINGS),
        ))
    }

    /// Mean and covariance over the grid, and true if the grid is fine enough: its steps are at most one standard
    /// deviation.
    fn moments(&self, prior: &Pose, information: &Matrix3<f64>, scan: &impl PoseLikelihood) -> (Belief, bool) {
        let steps = self.steps();
        let offsets = |axis: usize, count: usize| {
            (0..count).map(move |index| index as f64 * steps[axis] - self.half_widths[axis]).collect::<Vec<f64>>()
        };
        let turns = offsets(2, HEADINGS);
        let headings: Vec<f64> = turns.iter().map(|turn| self.middle.heading + turn).collect();
        let mut samples = Vec::with_capacity(POSITIONS * POSITIONS * HEADINGS);
        for x in offsets(0, POSITIONS) {
            for y in offsets(1, POSITIONS) {
                let position = self.middle.position + crate::pose::Vector::new(x, y);
                for (log, turn) in scan.at(position, &headings).into_iter().zip(&turns) {
                    let offset = position - prior.position;
                    let offset = Vector3::new(offset.x, offset.y, wrapped(self.middle.heading + turn - prior.heading));
                    samples.push((Vector3::new(x, y, *turn), log - 0.5 * offset.dot(&(information * offset))));
                }
            }
        }
        let max_log = samples.iter().map(|(_, log)| *log).fold(f64::NEG_INFINITY, f64::max);
        let weight = |log: f64| math::exp(log - max_log);
        let total: f64 = samples.iter().map(|(_, log)| weight(*log)).sum();
        let mean = samples.iter().map(|(offset, log)| offset * weight(*log)).sum::<Vector3<f64>>() / total;
        let square = |(offset, log): &(Vector3<f64>, f64)| (offset - mean) * (offset - mean).transpose() * weight(*log);
        let covariance = samples.iter().map(square).sum::<Matrix3<f64>>() / total;
        let position = self.middle.position + mean.xy();
        let heading = wrapped(self.middle.heading + mean.z);
        let is_fine = (0..3).all(|axis| steps[axis] <= covariance[(axis, axis)].sqrt().max(MIN_SIGMAS[axis]));
        (Belief { mean: Pose { position, heading }, covariance }, is_fine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A normal likelihood with a mean and the diagonal of the information matrix (the inverse of the covariance).
    struct NormalLikelihood(Pose, Vector3<f64>);

    impl PoseLikelihood for NormalLikelihood {
        fn at(&self, position: Point, headings: &[f64]) -> Vec<f64> {
            let offset = position - self.0.position;
            let log = |heading: &f64| {
                let offset = Vector3::new(offset.x, offset.y, wrapped(heading - self.0.heading));
                -0.5 * offset.component_mul(&offset).dot(&self.1)
            };
            headings.iter().map(log).collect()
        }
    }

    fn belief(sigmas: [f64; 3]) -> Belief {
        let variances = Vector3::from(sigmas.map(|sigma| sigma * sigma));
        Belief { mean: Pose::new(1.0, 2.0, 0.5), covariance: Matrix3::from_diagonal(&variances) }
    }

    /// The information matrix of a product of two normal distributions is the sum of their information matrices.
    #[test]
    fn correction_by_a_normal_likelihood_gives_the_exact_product() {
        let prior = belief([0.1, 0.05, 0.1]);
        let sigmas = Vector3::new(0.02, 0.1, 0.005);
        let scan = NormalLikelihood(Pose::new(1.1, 1.98, 0.6), sigmas.map(|sigma| 1.0 / (sigma * sigma)));
        let found = prior.corrected(&scan);
        let expected = |prior: f64, prior_sigma: f64, scan: f64, scan_sigma: f64| {
            let (a, b) = (1.0 / (prior_sigma * prior_sigma), 1.0 / (scan_sigma * scan_sigma));
            ((a * prior + b * scan) / (a + b), 1.0 / (a + b).sqrt())
        };
        for (axis, (found, (mean, sigma))) in [
            (found.mean.position.x, expected(1.0, 0.1, 1.1, 0.02)),
            (found.mean.position.y, expected(2.0, 0.05, 1.98, 0.1)),
            (found.mean.heading, expected(0.5, 0.1, 0.6, 0.005)),
        ]
        .into_iter()
        .enumerate()
        {
            assert!((found - mean).abs() < 0.02 * sigma, "axis {axis}: {found} instead of {mean}");
        }
        let sigma = found.covariance.diagonal().map(f64::sqrt);
        assert!((sigma.x / expected(0.0, 0.1, 0.0, 0.02).1 - 1.0).abs() < 0.02, "{sigma}");
        assert!((sigma.z / expected(0.0, 0.1, 0.0, 0.005).1 - 1.0).abs() < 0.02, "{sigma}");
    }

    #[test]
    fn direction_without_information_keeps_odometry() {
        let prior = belief([0.2, 0.1, 0.05]);
        let along_x = NormalLikelihood(Pose::new(5.0, 2.05, 0.5), Vector3::new(0.0, 1e4, 0.0));
        let found = prior.corrected(&along_x);
        assert!((found.mean.position.x - 1.0).abs() < 1e-9 && (found.mean.heading - 0.5).abs() < 1e-9, "{found:?}");
        assert!((found.covariance[(0, 0)].sqrt() / 0.2 - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.mean.position.y - 2.05).abs() < 1e-3 && found.covariance[(1, 1)].sqrt() < 0.011, "{found:?}");
    }

    #[test]
    fn motion_adds_errors_and_heading_errors_move_the_position() {
        let noise = OdometryNoise { turn: 0.1, drift: 0.02, distance: 0.05 };
        let start = Belief::certain(Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        let turned = start.moved(&Pose::new(3.0, 1.0, 0.0), &Pose::new(3.0, 1.0, 1.0), &noise);
        assert!((turned.covariance[(2, 2)].sqrt() - 0.1).abs() < 1e-12 && turned.covariance[(0, 0)] == 0.0);
        // The robot moves 2 m forwards, along y of the map: the error of the heading moves the end along x.
        let back = Pose::new(3.0, 1.0, 0.0);
        let uncertain = Belief { covariance: turned.covariance, ..start };
        let moved = uncertain.moved(&back, &Pose::new(5.0, 1.0, 0.0), &noise);
        assert!((moved.mean.position - Point::new(0.0, 2.0)).norm() < 1e-12);
        let expected = (0.2_f64.powi(2) + 0.04_f64.powi(2) + 0.1_f64.powi(2)).sqrt();
        assert!((moved.covariance[(0, 0)].sqrt() - expected).abs() < 1e-12, "{}", moved.covariance);
        assert!((moved.covariance[(1, 1)].sqrt() - 0.1).abs() < 1e-12);
    }
}
