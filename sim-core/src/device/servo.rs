//! Servos hold the commanded position.
//!
//! A servo turns instantly. Source: RoBIOS 6 library, servos; section 4.1 of Koestler & Bräunl for the steering.

use std::collections::VecDeque;

use crate::drive::HISTORY;
use crate::time::Time;

/// The servos of a robot.
#[derive(Clone, Debug, Default)]
pub struct Servos {
    /// Positions 0 to 255 by servo; [`INITIAL_POSITION`] if never set.
    positions: Vec<u8>,
    /// The latest changes, in order.
    changes: VecDeque<Change>,
}

/// One change of a servo's position.
#[derive(Clone, Copy, Debug)]
struct Change {
    at: Time,
    servo: usize,
    /// Position before the change.
    from: u8,
}

/// Position of a servo that was never set.
const INITIAL_POSITION: u8 = 127;

impl Servos {
    /// Position of servo `index`, 0 to 255.
    pub fn position(&self, index: usize) -> u8 {
        self.positions.get(index).copied().unwrap_or(INITIAL_POSITION)
    }

    /// Angle of servo `index` just before `at`, rad; `swing` gives the angles at positions 0 and 255.
    pub fn angle_before(&self, index: usize, swing: [f64; 2], at: Time) -> f64 {
        let since = self.changes.partition_point(|change| change.at < at);
        let next = self.changes.iter().skip(since).find(|change| change.servo == index);
        let position = next.map_or_else(|| self.position(index), |change| change.from);
        let [from, to] = swing;
        0.5 * (from + to) - 0.5 * (to - from) * steering_from_position(position)
    }

    /// Turns servo `index` to `position` at `now`.
    pub fn turn(&mut self, index: usize, position: u8, now: Time) {
        let change = Change { at: now, servo: index, from: self.position(index) };
        // Sensors on servos may be read at instants as old as the world's history.
        while self.changes.front().is_some_and(|oldest| oldest.at + HISTORY < now) {
            self.changes.pop_front();
        }
        self.changes.push_back(change);
        self.positions.resize(self.positions.len().max(index + 1), INITIAL_POSITION);
        self.positions[index] = position;
    }
}

/// Steering angle as a fraction of the maximum, left positive: position 0 gives 1, 127 and 128 give 0, 255 gives -1.
///
/// Source: straight is 127 in RoBIOS 6 and 128 in EyeSim VR; here both are straight, so that left and right are
/// symmetric.
pub fn steering_from_position(position: u8) -> f64 {
    let position = f64::from(position);
    if position <= 127.0 { (127.0 - position) / 127.0 } else { (128.0 - position) / 127.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_before_excludes_a_change_at_the_same_instant() {
        let mut servos = Servos::default();
        let angle = |servos: &Servos, at| servos.angle_before(1, [-1.0, 3.0], Time(at));
        assert_eq!(angle(&servos, 0), 1.0, "the middle");
        servos.turn(1, 0, Time(1_000));
        servos.turn(0, 9, Time(1_500));
        servos.turn(1, 255, Time(2_000));
        let angles = [1_000, 1_001, 2_000, 2_001, 90_000].map(|at| angle(&servos, at));
        assert_eq!(angles, [1.0, -1.0, -1.0, 3.0, 3.0]);
        // Changes older than the history are dropped at the next turn of a servo.
        servos.turn(1, 128, Time(1_000_000));
        assert_eq!((servos.changes.len(), angle(&servos, 1_000_000), angle(&servos, 1_000_001)), (1, 3.0, 1.0));
    }

    #[test]
    fn steering_is_symmetric() {
        assert_eq!([0, 127, 128, 255].map(steering_from_position), [1.0, 0.0, 0.0, -1.0]);
        for position in 0..=255 {
            assert_eq!(steering_from_position(position), -steering_from_position(255 - position));
        }
    }
}
