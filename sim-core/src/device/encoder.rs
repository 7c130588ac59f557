//! Encoders, which count the rotation of the wheels since a reset.

use std::f64::consts::TAU;

use crate::drive::Motion;
use crate::time::Time;

/// Tolerance for rounding when an encoder counts, in counts: far above rounding errors, far below any commanded motion.
const TOLERANCE: f64 = 1e-9;

/// Encoders of a robot, by wheel. Each encoder has two counters, which are reset separately: the count and the
/// distance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders {
    /// Wheel angles at the last reset of the counts, rad.
    count_start: [f64; 4],
    /// Wheel angles at the last reset of the distances, rad.
    distance_start: [f64; 4],
    /// Measured angles at which switched-off encoders are frozen, rad.
    frozen: [Option<f64>; 4],
    /// Angles by which wheels turned while their encoders were switched off, rad.
    missed: [f64; 4],
}

impl Encoders {
    /// Sets the count of encoder `index` to 0 at `at`.
    pub fn reset_count(&mut self, index: usize, motion: &mut Motion, at: Time) {
        self.count_start[index] = self.angle(index, motion, at);
    }

    /// Sets the distance of encoder `index` to 0 at `at`.
    pub fn reset_distance(&mut self, index: usize, motion: &mut Motion, at: Time) {
        self.distance_start[index] = self.angle(index, motion, at);
    }

    /// Counts of encoder `index` since the last reset of its count.
    pub fn count(&self, index: usize, motion: &mut Motion, at: Time) -> i64 {
        self.counts_since(self.count_start[index], index, motion, at)
    }

    /// Counts of encoder `index` since the last reset of its distance.
    pub fn distance(&self, index: usize, motion: &mut Motion, at: Time) -> i64 {
        self.counts_since(self.distance_start[index], index, motion, at)
    }

    /// Switches encoder `index` on or off at `at`; the encoder does not count while it is off.
    pub fn switch(&mut self, index: usize, is_on: bool, motion: &mut Motion, at: Time) {
        let wheel_angle = motion.wheel_angles(at)[index];
        let Self { frozen, missed, .. } = self;
        if is_on {
            let frozen = frozen[index].take();
            missed[index] = frozen.map_or(missed[index], |frozen| wheel_angle - frozen);
        } else {
            frozen[index].get_or_insert(wheel_angle - missed[index]);
        }
    }

    /// Wheel angle measured by an encoder, rad.
    fn angle(&self, index: usize, motion: &mut Motion, at: Time) -> f64 {
        self.frozen[index].unwrap_or_else(|| motion.wheel_angles(at)[index] - self.missed[index])
    }

    /// Whole counts of a wheel's encoder since the angle `start`, rounded towards 0.
    fn counts_since(&self, start: f64, index: usize, motion: &mut Motion, at: Time) -> i64 {
        let turned = self.angle(index, motion, at) - start;
        let counts = turned / TAU * motion.model().ticks_per_turn;
        (counts + TOLERANCE.copysign(counts)).trunc() as i64
    }
}
