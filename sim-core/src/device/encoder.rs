//! Encoders: they count the ticks of the wheels since a reset.

use std::f64::consts::TAU;

use crate::drive::Motion;
use crate::time::Time;

/// Largest missing part of a tick at which the tick still counts: far above rounding errors, far below any commanded
/// motion.
const EDGE: f64 = 1e-9;

/// Encoders of a robot, by wheel. Each has two counters, one for ticks and one for distance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders {
    /// Wheel angles at the last reset of the tick counters, rad.
    count_start: [f64; 4],
    /// Wheel angles at the last reset of the distance counters, rad.
    distance_start: [f64; 4],
    /// Wheel angles at which switched-off encoders are frozen, rad.
    held: [Option<f64>; 4],
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
        let turned = motion.wheel_angles(at)[index];
        let Self { held, missed, .. } = self;
        if is_on {
            let held = held[index].take();
            missed[index] = held.map_or(missed[index], |held| turned - held);
        } else {
            held[index].get_or_insert(turned - missed[index]);
        }
    }

    /// Wheel angle measured by an encoder, rad.
    fn angle(&self, index: usize, motion: &mut Motion, at: Time) -> f64 {
        self.held[index].unwrap_or_else(|| motion.wheel_angles(at)[index] - self.missed[index])
    }

    /// Whole ticks of a wheel's encoder since the angle `start`, rounded towards 0.
    fn ticks_since(&self, start: f64, index: usize, motion: &mut Motion, at: Time) -> i64 {
        let turned = self.angle(index, motion, at) - start;
        let ticks = turned / TAU * motion.model().ticks_per_turn;
        (ticks + EDGE.copysign(ticks)).trunc() as i64
    }
}
