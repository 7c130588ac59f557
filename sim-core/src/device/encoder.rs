//! Encoders, which count the ticks of the wheels since a reset.

use std::f64::consts::TAU;

use crate::drive::Motion;
use crate::time::Time;

/// Fraction of a tick that may be missing when the tick is counted: far above rounding errors, far below any commanded
/// motion.
const TOLERANCE: f64 = 1e-9;

/// Encoders of a robot, by wheel. Each has two counters, one for ticks and one for distance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders {
    /// Wheel angles at the last reset of the tick counters, rad.
    count_start: [f64; 4],
    /// Wheel angles at the last reset of the distance counters, rad.
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

    /// Ticks of encoder `index` since its count was set to 0.
    pub fn count(&self, index: usize, motion: &mut Motion, at: Time) -> i64 {
        self.ticks_since(self.count_start[index], index, motion, at)
    }

    /// Ticks of encoder `index` since its distance was set to 0.
    pub fn distance(&self, index: usize, motion: &mut Motion, at: Time) -> i64 {
        self.ticks_since(self.distance_start[index], index, motion, at)
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

    /// Whole ticks of a wheel's encoder since the angle `start`, rounded towards 0.
    fn ticks_since(&self, start: f64, index: usize, motion: &mut Motion, at: Time) -> i64 {
        let turned = self.angle(index, motion, at) - start;
        let ticks = turned / TAU * motion.model().ticks_per_turn;
        (ticks + TOLERANCE.copysign(ticks)).trunc() as i64
    }
}
