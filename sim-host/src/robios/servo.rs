//! Servos of RoBIOS 6, including the steering servo of an Ackermann drive.
//!
//! Source: RoBIOS 6 library, servos; section 4.1 of Koestler & Bräunl for the steering.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::HDT_SERVO;
use sim_core::world::World;

use super::handle::Handles;
use super::robot::Robot;

/// Servo handles and ranges of a program.
#[derive(Clone, Debug, Default)]
pub struct Servos {
    handles: Handles,
    /// For each servo, its raw positions for 0 and 255 in `SERVOSet` of RoBIOS-7; servos beyond the end of the list
    /// have the whole range.
    ranges: Vec<[u8; 2]>,
}

/// Range of a servo before `SERVORange`.
const WHOLE_RANGE: [u8; 2] = [0, 255];

impl Servos {
    /// The servo's raw positions for 0 and 255 in `SERVOSet` of RoBIOS-7.
    pub fn range(&self, index: usize) -> [u8; 2] {
        self.ranges.get(index).copied().unwrap_or(WHOLE_RANGE)
    }

    /// Sets the servo's raw positions for 0 and 255 in `SERVOSet` of RoBIOS-7.
    pub fn set_range(&mut self, index: usize, range: [u8; 2]) {
        self.ranges.resize(self.ranges.len().max(index + 1), WHOLE_RANGE);
        self.ranges[index] = range;
    }
}

/// `SERVOInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    match robot.robios.table.find(HDT_SERVO, semantics).map(|device| device.index) {
        Some(index) => robot.robios.servos.handles.open(index),
        None => robot.refuse_missing_device(Call::SERVOInit, 0, HDT_SERVO, semantics),
    }
}

/// `SERVORelease`
pub fn release(robot: &mut Robot, handles: i32) -> i32 {
    match robot.robios.servos.handles.release(handles) {
        0 => 0,
        unopened => robot.fail_call(Call::SERVORelease, unopened),
    }
}

/// `SERVOSet`
pub fn set(robot: &mut Robot, world: &World, handles: i32, position: i32) -> i32 {
    let Some(servos) = robot.robios.servos.handles.devices(handles) else {
        return robot.refuse_handle(Call::SERVOSet, -1, handles, Call::SERVOInit);
    };
    let Ok(position) = u8::try_from(position) else {
        return robot.refuse_call(Call::SERVOSet, -1, |_| format!("position {position} is not from 0 to 255"));
    };
    for index in servos {
        turn(robot, world, index, position);
    }
    0
}

/// Turns servo `index`.
pub(super) fn turn(robot: &mut Robot, world: &World, index: usize, position: u8) {
    if robot.state.turn_servo(world, index, position) {
        robot.tasks.recheck_drive(robot.state.now);
    }
}
