//! Servos: they hold the position that they were set to; the steering servo of an Ackermann drive steers.
//!
//! Source: RoBIOS 6 library, servos; section 4.1 of Koestler & Bräunl for the steering.

use std::collections::VecDeque;

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::HDT_SERVO;
use sim_core::drive::{Command, HISTORY};
use sim_core::time::Time;
use sim_core::world::World;

use super::handle::Handles;
use super::robot::Robot;
use sim_core::record::Event;

/// The servos of a robot.
#[derive(Clone, Debug, Default)]
pub struct Servos {
    handles: Handles,
    /// Positions 0 to 255 by servo; the middle as long as nothing was set.
    positions: Vec<u8>,
    /// The latest changes, in order.
    changes: VecDeque<Change>,
    /// By servo what positions 0 and 255 of RoBIOS-7 mean, as far as `SERVORange` has set any.
    ranges: Vec<[u8; 2]>,
}

/// A servo is turned.
#[derive(Clone, Copy, Debug)]
struct Change {
    at: Time,
    servo: usize,
    /// Where it stood before.
    from: u8,
}

/// All that a servo can do.
const WHOLE_RANGE: [u8; 2] = [0, 255];

/// Position of a servo that was never set.
const MIDDLE: u8 = 127;

impl Servos {
    /// Position of servo `index`, 0 to 255.
    pub fn position(&self, index: usize) -> u8 {
        self.positions.get(index).copied().unwrap_or(MIDDLE)
    }

    /// Angle (rad) of servo `index` just before `at`, with the angles of `swing` at positions 0 and 255. A servo turns at once.
    pub fn angle_before(&self, index: usize, swing: [f64; 2], at: Time) -> f64 {
        let since = self.changes.partition_point(|change| change.at < at);
        let next = self.changes.iter().skip(since).find(|change| change.servo == index);
        let position = next.map_or_else(|| self.position(index), |change| change.from);
        let [from, to] = swing;
        0.5 * (from + to) - 0.5 * (to - from) * steering_from_position(position)
    }

    /// Turns servo `index` at `now`.
    fn turn(&mut self, index: usize, position: u8, now: Time) {
        let change = Change { at: now, servo: index, from: self.position(index) };
        // Sensors on servos are read as late as the world remembers what they saw.
        while self.changes.front().is_some_and(|oldest| oldest.at + HISTORY < now) {
            self.changes.pop_front();
        }
        self.changes.push_back(change);
        self.positions.resize(self.positions.len().max(index + 1), MIDDLE);
        self.positions[index] = position;
    }

    /// What positions 0 and 255 of RoBIOS-7 mean.
    pub fn range(&self, index: usize) -> [u8; 2] {
        self.ranges.get(index).copied().unwrap_or(WHOLE_RANGE)
    }

    /// Sets what positions 0 and 255 of RoBIOS-7 mean.
    pub fn set_range(&mut self, index: usize, range: [u8; 2]) {
        self.ranges.resize(self.ranges.len().max(index + 1), WHOLE_RANGE);
        self.ranges[index] = range;
    }
}

/// `SERVOInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    match robot.devices.table.find(HDT_SERVO, semantics).map(|device| device.index) {
        Some(index) => robot.devices.servos.handles.open(index),
        None => robot.has_no(Call::SERVOInit, 0, HDT_SERVO, semantics),
    }
}

/// `SERVORelease`
pub fn release(robot: &mut Robot, handles: i32) -> i32 {
    match robot.devices.servos.handles.release(handles) {
        0 => 0,
        left => robot.failed(Call::SERVORelease, left),
    }
}

/// `SERVOSet`
pub fn set(robot: &mut Robot, world: &World, handles: i32, position: i32) -> i32 {
    let servos = robot.devices.servos.handles.all(handles);
    let (Some(servos), Ok(position)) = (servos, u8::try_from(position)) else {
        return robot.failed(Call::SERVOSet, -1);
    };
    for index in servos {
        turn(robot, world, index, position);
    }
    0
}

/// Turns servo `index`.
pub(super) fn turn(robot: &mut Robot, world: &World, index: usize, position: u8) {
    robot.devices.servos.turn(index, position, robot.now);
    let device = robot.devices.table.name(HDT_SERVO, index);
    robot.journal.record(robot.now, &Event::Servo { device, position: position.into() });
    if robot.spec.drive.steering.as_deref() == Some(device) {
        let angle = steering_from_position(position) * robot.motion.model().max_steering;
        // Never refused: the angle is finite, and only a drive that steers has a steering servo.
        let _ = robot.command(world, Command::Steer(angle));
    }
}

/// Part of the greatest steering angle, left positive: 0 is 1, 127 and 128 are 0, 255 is -1.
///
/// Source: RoBIOS 6 gives 127 as straight, EyeSim VR 128; so both are, and left and right are alike.
pub fn steering_from_position(position: u8) -> f64 {
    let position = f64::from(position);
    if position <= 127.0 { (127.0 - position) / 127.0 } else { (128.0 - position) / 127.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_has_the_angle_that_it_had_just_before() {
        let mut servos = Servos::default();
        let angle = |servos: &Servos, at| servos.angle_before(1, [-1.0, 3.0], Time(at));
        assert_eq!(angle(&servos, 0), 1.0, "the middle");
        servos.turn(1, 0, Time(1_000));
        servos.turn(0, 9, Time(1_500));
        servos.turn(1, 255, Time(2_000));
        let angles = [1_000, 1_001, 2_000, 2_001, 90_000].map(|at| angle(&servos, at));
        assert_eq!(angles, [1.0, -1.0, -1.0, 3.0, 3.0]);
        // What is out of memory is dropped when the servo is turned again.
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
