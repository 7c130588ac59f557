//! Corrects a pose from odometry by comparing readings with a map.
//!
//! A [`Belief`] is a normal distribution of the robot's pose. [`Belief::moved`] adds a motion measured by odometry, with its errors.
//! [`Belief::corrected`] multiplies it by the likelihood of a scan at each pose around, and takes mean and covariance of the
//! product. A direction in which the scan says nothing (along a corridor) keeps the mean and the variance of odometry; no threshold
//! decides this. The likelihood is a [`PoseLikelihood`]: that of points on a map, or that of sonar ranges
//! ([`measurement`](crate::measurement)).
//!
//! Source: Olson 2009, "Real-time correlative scan matching", sections III (product of likelihood and odometry over a grid of
//! poses) and III.E (covariance from the grid); motion: Thrun, Burgard & Fox 2005, section 5.4. The window that follows the
//! distribution instead of a fixed pyramid is our choice.

use nalgebra::{Matrix3, Vector3};

use crate::math;
use crate::pose::{Point, Pose, rotated, wrapped};

/// Log-likelihood of a scan as a function of the robot's pose.
pub trait PoseLikelihood {
    /// Log-likelihood at a position with each of the headings, in radians; a constant for all poses may be left out.
    fn at(&self, position: Point, headings: &[f64]) -> Vec<f64>;
}

/// Errors of odometry: standard deviations that grow with the motion.
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

/// Half of the window in which poses are compared, in standard deviations.
const WINDOW: f64 = 3.0;
/// Poses along x and y: steps of 0.75 standard deviations, with which the moments of a normal distribution are exact to 1e-4.
const POSITIONS: usize = 9;
/// Headings.
const HEADINGS: usize = 13;
/// Maximum number of windows, each around the mean of the one before.
const WINDOWS: usize = 4;
/// Least standard deviations of x, y (m) and heading (rad): finer differences have no effect on a map.
const LEAST: [f64; 3] = [5e-4, 5e-4, 5e-4];

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
        // An error of the heading before the motion swings its end around; half of the error of this motion does.
        let lever = Vector3::new(-offset.y, offset.x, 0.0);
        let jacobian = Matrix3::new(1.0, 0.0, lever.x, 0.0, 1.0, lever.y, 0.0, 0.0, 1.0);
        let turned = math::hypot(noise.turn * step.heading, noise.drift * distance);
        let swing = 0.5 * lever + Vector3::new(0.0, 0.0, 1.0);
        let slipped = (noise.distance * distance).powi(2);
        let covariance = jacobian * self.covariance * jacobian.transpose()
            + swing * swing.transpose() * turned.powi(2)
            + Matrix3::from_diagonal(&Vector3::new(slipped, slipped, 0.0));
        Self { mean, covariance }
    }

    /// Distribution after a scan: mean and covariance of the product of this distribution and the scan's likelihood.
    pub fn corrected(&self, scan: &impl PoseLikelihood) -> Self {
        let prior = self.covariance + Matrix3::from_diagonal(&Vector3::from(LEAST.map(|least| least * least)));
        let Some(information) = prior.try_inverse() else { return *self };
        let mut window = Window { middle: self.mean, half: prior.diagonal().map(|variance| WINDOW * variance.sqrt()) };
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
                // The grid cannot show deviations below half of its step.
                let sigma = math::hypot(belief.covariance[(axis, axis)].sqrt(), 0.5 * steps[axis]);
                window.half[axis] = window.half[axis].min(WINDOW * sigma.max(LEAST[axis]));
            }
        }
        found
    }
}

/// Poses that are compared: a grid around the middle.
struct Window {
    middle: Pose,
    half: Vector3<f64>,
}

impl Window {
    fn steps(&self) -> Vector3<f64> {
        let intervals = |count: usize| (count - 1) as f64;
        (2.0 * self.half).component_div(&Vector3::new(intervals(POSITIONS), intervals(POSITIONS), intervals(HEADINGS)))
    }

    /// Mean and covariance over the grid, and whether the grid is fine enough for them: the steps are at most a standard deviation.
    fn moments(&self, prior: &Pose, information: &Matrix3<f64>, scan: &impl PoseLikelihood) -> (Belief, bool) {
        let steps = self.steps();
        let offsets = |axis: usize, count: usize| {
            (0..count).map(move |index| index as f64 * steps[axis] - self.half[axis]).collect::<Vec<f64>>()
        };
        let turns = offsets(2, HEADINGS);
        let headings: Vec<f64> = turns.iter().map(|turn| self.middle.heading + turn).collect();
        let mut samples = Vec::with_capacity(POSITIONS * POSITIONS * HEADINGS);
        for x in offsets(0, POSITIONS) {
            for y in offsets(1, POSITIONS) {
                let position = self.middle.position + crate::pose::Vector::new(x, y);
                for (log, turn) in scan.at(position, &headings).into_iter().zip(&turns) {
                    let off = position - prior.position;
                    let off = Vector3::new(off.x, off.y, wrapped(self.middle.heading + turn - prior.heading));
                    samples.push((Vector3::new(x, y, *turn), log - 0.5 * off.dot(&(information * off))));
                }
            }
        }
        let most = samples.iter().map(|(_, log)| *log).fold(f64::NEG_INFINITY, f64::max);
        let weigh = |log: f64| math::exp(log - most);
        let total: f64 = samples.iter().map(|(_, log)| weigh(*log)).sum();
        let mean = samples.iter().map(|(offset, log)| offset * weigh(*log)).sum::<Vector3<f64>>() / total;
        let square = |(offset, log): &(Vector3<f64>, f64)| (offset - mean) * (offset - mean).transpose() * weigh(*log);
        let covariance = samples.iter().map(square).sum::<Matrix3<f64>>() / total;
        let position = self.middle.position + mean.xy();
        let heading = wrapped(self.middle.heading + mean.z);
        let is_fine = (0..3).all(|axis| steps[axis] <= covariance[(axis, axis)].sqrt().max(LEAST[axis]));
        (Belief { mean: Pose { position, heading }, covariance }, is_fine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A normal likelihood with the given information (inverse of a covariance) about its middle.
    struct Normal(Pose, Vector3<f64>);

    impl PoseLikelihood for Normal {
        fn at(&self, position: Point, headings: &[f64]) -> Vec<f64> {
            let off = position - self.0.position;
            let log = |heading: &f64| {
                let off = Vector3::new(off.x, off.y, wrapped(heading - self.0.heading));
                -0.5 * off.component_mul(&off).dot(&self.1)
            };
            headings.iter().map(log).collect()
        }
    }

    fn belief(sigmas: [f64; 3]) -> Belief {
        let variances = Vector3::from(sigmas.map(|sigma| sigma * sigma));
        Belief { mean: Pose::new(1.0, 2.0, 0.5), covariance: Matrix3::from_diagonal(&variances) }
    }

    /// The product of two normal distributions is known: information adds.
    #[test]
    fn normal_distributions_multiply() {
        let prior = belief([0.1, 0.05, 0.1]);
        let sigmas = Vector3::new(0.02, 0.1, 0.005);
        let scan = Normal(Pose::new(1.1, 1.98, 0.6), sigmas.map(|sigma| 1.0 / (sigma * sigma)));
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
            assert!((found - mean).abs() < 0.02 * sigma, "axis {axis}: {found} for {mean}");
        }
        let sigma = found.covariance.diagonal().map(f64::sqrt);
        assert!((sigma.x / expected(0.0, 0.1, 0.0, 0.02).1 - 1.0).abs() < 0.02, "{sigma}");
        assert!((sigma.z / expected(0.0, 0.1, 0.0, 0.005).1 - 1.0).abs() < 0.02, "{sigma}");
    }

    #[test]
    fn where_a_scan_says_nothing_odometry_stays() {
        let prior = belief([0.2, 0.1, 0.05]);
        let along_x = Normal(Pose::new(5.0, 2.05, 0.5), Vector3::new(0.0, 1e4, 0.0));
        let found = prior.corrected(&along_x);
        assert!((found.mean.position.x - 1.0).abs() < 1e-9 && (found.mean.heading - 0.5).abs() < 1e-9, "{found:?}");
        assert!((found.covariance[(0, 0)].sqrt() / 0.2 - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.mean.position.y - 2.05).abs() < 1e-3 && found.covariance[(1, 1)].sqrt() < 0.011, "{found:?}");
    }

    #[test]
    fn errors_grow_with_the_motion_and_swing_with_the_heading() {
        let noise = OdometryNoise { turn: 0.1, drift: 0.02, distance: 0.05 };
        let start = Belief::certain(Pose::new(0.0, 0.0, std::f64::consts::FRAC_PI_2));
        let turned = start.moved(&Pose::new(3.0, 1.0, 0.0), &Pose::new(3.0, 1.0, 1.0), &noise);
        assert!((turned.covariance[(2, 2)].sqrt() - 0.1).abs() < 1e-12 && turned.covariance[(0, 0)] == 0.0);
        // 2 m ahead, along y of the map: the error of the heading moves the end along x.
        let back = Pose::new(3.0, 1.0, 0.0);
        let uncertain = Belief { covariance: turned.covariance, ..start };
        let moved = uncertain.moved(&back, &Pose::new(5.0, 1.0, 0.0), &noise);
        assert!((moved.mean.position - Point::new(0.0, 2.0)).norm() < 1e-12);
        let expected = (0.2_f64.powi(2) + 0.04_f64.powi(2) + 0.1_f64.powi(2)).sqrt();
        assert!((moved.covariance[(0, 0)].sqrt() - expected).abs() < 1e-12, "{}", moved.covariance);
        assert!((moved.covariance[(1, 1)].sqrt() - 0.1).abs() < 1e-12);
    }
}
