//! Single motors, and the encoders of their wheels.
//!
//! Source: RoBIOS 6 library, servos and motors, encoders.

use std::f64::consts::PI;

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::{HDT_MOTOR, HDT_QUAD};
use sim_core::simulation;
use sim_core::world::World;

use super::robot::Robot;
use sim_core::record::Event;

/// `MOTORInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    if robot.robios.vw.is_open {
        return robot.refuse_call(Call::MOTORInit, 0, |_| "`VWInit` holds the motors until `VWRelease`".to_owned());
    }
    match robot.robios.table.find(HDT_MOTOR, semantics).map(|device| device.index) {
        Some(index) => robot.robios.motors.open(index),
        None => robot.refuse_missing_device(Call::MOTORInit, 0, HDT_MOTOR, semantics),
    }
}

/// `MOTORRelease`
pub fn release(robot: &mut Robot, world: &World, handles: i32) -> i32 {
    let motors = robot.robios.motors.devices(handles);
    let remaining = robot.robios.motors.release(handles);
    match motors {
        Some(motors) => set(robot, world, motors, 0),
        None => _ = robot.fail_call(Call::MOTORRelease, remaining),
    }
    remaining
}

/// `MOTORDrive`
pub fn drive(robot: &mut Robot, world: &World, handles: i32, percent: i32) -> i32 {
    let Some(motors) = robot.robios.motors.devices(handles) else {
        return robot.refuse_handle(Call::MOTORDrive, -1, handles, Call::MOTORInit);
    };
    set(robot, world, motors, percent.clamp(-100, 100));
    0
}

/// Sets motors to a percentage of the wheels' maximum rate.
fn set(robot: &mut Robot, world: &World, motors: impl Iterator<Item = usize>, percent: i32) {
    robot.tasks.recheck_drive(robot.state.now);
    robot.state.set_motors(world, motors, percent);
}

/// `QUADInit`
pub fn quad_init(robot: &mut Robot, semantics: i32) -> i32 {
    let Some(index) = robot.robios.table.find(HDT_QUAD, semantics).map(|device| device.index) else {
        return robot.refuse_missing_device(Call::QUADInit, 0, HDT_QUAD, semantics);
    };
    if !robot.robios.quads.is_open(index) {
        reset(robot, index);
        reset_distance(robot, index);
    }
    robot.robios.quads.open(index)
}

/// `QUADRelease`
pub fn quad_release(robot: &mut Robot, handles: i32) -> i32 {
    if robot.robios.quads.release(handles) == 0 { 0 } else { robot.fail_call(Call::QUADRelease, -1) }
}

/// `QUADReset`
pub fn quad_reset(robot: &mut Robot, handles: i32) -> i32 {
    let Some(quads) = robot.robios.quads.devices(handles) else {
        return robot.refuse_handle(Call::QUADReset, -1, handles, Call::QUADInit);
    };
    quads.for_each(|index| reset(robot, index));
    0
}

/// `QUADRead`
pub fn quad_read(robot: &mut Robot, handle: i32) -> i32 {
    let Some(index) = robot.robios.quads.device(handle) else {
        return robot.refuse_handle(Call::QUADRead, 0, handle, Call::QUADInit);
    };
    count(robot, index)
}

/// Counts of encoder `index` since its reset.
pub(super) fn count(robot: &mut Robot, index: usize) -> i32 {
    let simulation::Robot { now, motion, devices, .. } = &mut robot.state;
    let ticks = devices.encoders.count(index, motion, *now);
    record_ticks(robot, index, ticks);
    // The program's counter has 32 bits and wraps.
    ticks as i32
}

/// Sets encoder `index` to 0.
pub(super) fn reset(robot: &mut Robot, index: usize) {
    let simulation::Robot { now, motion, devices, .. } = &mut robot.state;
    devices.encoders.reset_count(index, motion, *now);
}

/// `QUADGetMotor`
pub fn quad_motor(robot: &mut Robot, semantics: i32) -> i32 {
    let table = &robot.robios.table;
    let index = table.find(HDT_QUAD, semantics).map(|device| device.index);
    let motor = index.and_then(|index| table.of_kind(HDT_MOTOR).find(|motor| motor.index == index));
    motor.map(|motor| motor.number()).unwrap_or_else(|| robot.fail_call(Call::QUADGetMotor, 0))
}

/// `QUADODORead`
pub fn odometer_read(robot: &mut Robot, handle: i32) -> f32 {
    let Some(index) = robot.robios.quads.device(handle) else {
        robot.refuse_handle(Call::QUADODORead, 0, handle, Call::QUADInit);
        return 0.0;
    };
    let simulation::Robot { now, motion, devices, .. } = &mut robot.state;
    let ticks = devices.encoders.distance(index, motion, *now);
    record_ticks(robot, index, ticks);
    let model = robot.motion.model();
    (ticks as f64 / model.ticks_per_turn * PI * model.wheel_diameter) as f32
}

/// `QUADODOReset`
pub fn odometer_reset(robot: &mut Robot, handles: i32) -> i32 {
    let Some(quads) = robot.robios.quads.devices(handles) else {
        return robot.refuse_handle(Call::QUADODOReset, -1, handles, Call::QUADInit);
    };
    quads.for_each(|index| reset_distance(robot, index));
    0
}

fn record_ticks(robot: &mut Robot, index: usize, value: i64) {
    let device = robot.state.spec.drive.motors[index].encoder.as_deref().unwrap_or_default();
    robot.state.journal.record(robot.state.now, &Event::Reading { device, value });
}

/// Sets the distance of encoder `index` to 0.
fn reset_distance(robot: &mut Robot, index: usize) {
    let simulation::Robot { now, motion, devices, .. } = &mut robot.state;
    devices.encoders.reset_distance(index, motion, *now);
}
