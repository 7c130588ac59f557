//! Motors and encoders of RoBIOS-7: addressed by number, each motor with its own controller.
//!
//! Source: RoBIOS-7 library, servos and motors. Our choice: setting a motor ends a drive in progress, and the other
//! motors keep their rates.

use std::f64::consts::TAU;

use robios_sys::Robios7Call as Call;
use robios_sys::robios6::hdt_type::{HDT_MOTOR, HDT_QUAD};
use sim_core::drive::{Command, Pid};
use sim_core::world::World;

use super::motor;
use super::robot::Robot;
use sim_core::record::Event;

/// Full-scale value of `MOTORDriveRaw`.
const FULL_RAW: i32 = 127;

/// `MOTORDrive`
pub fn drive(robot: &mut Robot, world: &World, motor: i32, percent: i32) -> i32 {
    set(robot, world, Call::MOTORDrive, motor, f64::from(percent.clamp(-100, 100)) / 100.0)
}

/// `MOTORDriveRaw`
pub fn drive_raw(robot: &mut Robot, world: &World, motor: i32, raw: i32) -> i32 {
    set(robot, world, Call::MOTORDriveRaw, motor, f64::from(raw.clamp(-FULL_RAW, FULL_RAW)) / f64::from(FULL_RAW))
}

/// `MOTORSpeed`
pub fn speed(robot: &mut Robot, world: &World, motor: i32, ticks_per_s: i32) -> i32 {
    let Some(wheel) = find(robot, Call::MOTORSpeed, motor) else { return 1 };
    let rate = f64::from(ticks_per_s) / robot.motion.model().ticks_per_turn * TAU;
    let outcome = robot.command(world, Command::WheelSpeed { wheel, rate });
    let device = &robot.state.spec.drive.motors[wheel].motor;
    robot.state.journal.record(robot.state.now, &Event::Output { device, value: ticks_per_s.into() });
    robot.answer_call(Call::MOTORSpeed, 1, outcome)
}

/// `MOTORPID`: out = p/10 e + i/10 (integral of e) - d/1000 (derivative of the wheel's rate), where e is the error of
/// the wheel's rate and time is in seconds. The scale is our choice.
pub fn start_control(robot: &mut Robot, motor: i32, [p, i, d]: [i32; 3]) -> i32 {
    let Some(wheel) = find(robot, Call::MOTORPID, motor) else { return 1 };
    if [p, i, d].iter().any(|factor| !(0..=255).contains(factor)) {
        return robot.refuse_call(Call::MOTORPID, 1, |_| "each parameter must be 0 to 255".to_owned());
    }
    let pid = Pid { p: f64::from(p) / 10.0, i: f64::from(i) / 10.0, d: f64::from(d) / 1000.0 };
    let outcome = robot.state.motion.start_wheel_control(robot.state.now, wheel, pid);
    robot.answer_call(Call::MOTORPID, 1, outcome)
}

/// `MOTORPIDOff`
pub fn stop_control(robot: &mut Robot, motor: i32) -> i32 {
    let Some(wheel) = find(robot, Call::MOTORPIDOff, motor) else { return 1 };
    let outcome = robot.state.motion.stop_wheel_control(robot.state.now, wheel);
    robot.answer_call(Call::MOTORPIDOff, 1, outcome)
}

/// `ENCODERRead`
pub fn encoder(robot: &mut Robot, quad: i32) -> i32 {
    match robot.find_numbered(Call::ENCODERRead, HDT_QUAD, quad, &[]) {
        Some(index) => motor::count(robot, index),
        None => robot.fail_call(Call::ENCODERRead, 0),
    }
}

/// `ENCODERReset`
pub fn reset_encoder(robot: &mut Robot, quad: i32) -> i32 {
    let Some(index) = robot.find_numbered(Call::ENCODERReset, HDT_QUAD, quad, &[]) else {
        return robot.fail_call(Call::ENCODERReset, 1);
    };
    motor::reset(robot, index);
    0
}

/// Drives a motor at a fraction of the wheels' maximum rate.
fn set(robot: &mut Robot, world: &World, call: Call, motor: i32, fraction: f64) -> i32 {
    let Some(wheel) = find(robot, call, motor) else { return 1 };
    let rate = fraction * robot.motion.model().max_wheel_rate;
    let outcome = robot.command(world, Command::Wheel { wheel, rate });
    let device = &robot.state.spec.drive.motors[wheel].motor;
    robot.state.journal.record(robot.state.now, &Event::Motor { device, percent: (100.0 * fraction).round() as i32 });
    robot.answer_call(call, 1, outcome)
}

fn find(robot: &mut Robot, call: Call, motor: i32) -> Option<usize> {
    let found = robot.find_numbered(call, HDT_MOTOR, motor, &[]);
    if found.is_none() {
        robot.fail_call(call, 1);
    }
    found
}
