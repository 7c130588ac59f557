//! Motors one by one, and the encoders of their wheels.
//!
//! Source: RoBIOS 6 library, servos and motors, encoders.

use std::f64::consts::{PI, TAU};

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::{HDT_MOTOR, HDT_QUAD};
use sim_core::drive::Command;
use sim_core::time::Time;
use sim_core::world::World;

use super::handle::Handles;
use super::robot::Robot;
use sim_core::record::Event;

/// Part of a tick that may be missing for the tick to count: far more than rounding, far less than can be driven.
const EDGE: f64 = 1e-9;

/// The motors that a program drives by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motors {
    handles: Handles,
    percent: [i32; 4],
}

impl Motors {
    /// True while the program holds a motor.
    pub fn is_open(&self) -> bool {
        self.handles.is_any_open()
    }
}

/// The encoders that a program reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quads {
    handles: Handles,
    /// Wheel angles in radians at which the counts were set to 0.
    count_start: [f64; 4],
    /// Wheel angles in radians at which the distances were set to 0.
    distance_start: [f64; 4],
    /// Wheel angles in radians that encoders stay at which are switched off.
    held: [Option<f64>; 4],
    /// Radians that wheels turned while their encoders were switched off.
    missed: [f64; 4],
}

/// `MOTORInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    if robot.devices.vw.is_open {
        return robot.refused(Call::MOTORInit, 0, |_| "`VWInit` holds the motors until `VWRelease`".to_owned());
    }
    match robot.devices.table.find(HDT_MOTOR, semantics).map(|device| device.index) {
        Some(index) => robot.devices.motors.handles.open(index),
        None => robot.has_no(Call::MOTORInit, 0, HDT_MOTOR, semantics),
    }
}

/// `MOTORRelease`
pub fn release(robot: &mut Robot, world: &World, handles: i32) -> i32 {
    let motors = robot.devices.motors.handles.all(handles);
    let left = robot.devices.motors.handles.release(handles);
    match motors {
        Some(motors) => set(robot, world, motors, 0),
        None => _ = robot.failed(Call::MOTORRelease, left),
    }
    left
}

/// `MOTORDrive`
pub fn drive(robot: &mut Robot, world: &World, handles: i32, percent: i32) -> i32 {
    let Some(motors) = robot.devices.motors.handles.all(handles) else { return robot.failed(Call::MOTORDrive, -1) };
    set(robot, world, motors, percent.clamp(-100, 100));
    0
}

/// Sets motors to a percentage of the wheels' greatest rate.
fn set(robot: &mut Robot, world: &World, motors: impl Iterator<Item = usize>, percent: i32) {
    for index in motors.filter(|index| *index < 4) {
        robot.devices.motors.percent[index] = percent;
        let device = &robot.spec.drive.motors[index].motor;
        robot.journal.record(robot.now, &Event::Motor { device, percent });
    }
    let full = robot.motion.model().max_wheel_rate;
    let rates = robot.devices.motors.percent.map(|percent| f64::from(percent) / 100.0 * full);
    // Never refused: the rates are finite.
    let _ = robot.command(world, Command::Wheels(rates));
}

/// `QUADInit`
pub fn quad_init(robot: &mut Robot, semantics: i32) -> i32 {
    let Some(index) = robot.devices.table.find(HDT_QUAD, semantics).map(|device| device.index) else {
        return robot.has_no(Call::QUADInit, 0, HDT_QUAD, semantics);
    };
    if !robot.devices.quads.handles.is_open(index) {
        let angle = angle_of(robot, index);
        robot.devices.quads.count_start[index] = angle;
        robot.devices.quads.distance_start[index] = angle;
    }
    robot.devices.quads.handles.open(index)
}

/// `QUADRelease`
pub fn quad_release(robot: &mut Robot, handles: i32) -> i32 {
    if robot.devices.quads.handles.release(handles) == 0 { 0 } else { robot.failed(Call::QUADRelease, -1) }
}

/// `QUADReset`
pub fn quad_reset(robot: &mut Robot, handles: i32) -> i32 {
    let Some(quads) = robot.devices.quads.handles.all(handles) else { return robot.failed(Call::QUADReset, -1) };
    quads.for_each(|index| reset(robot, index));
    0
}

/// `QUADRead`
pub fn quad_read(robot: &mut Robot, handle: i32) -> i32 {
    let Some(index) = robot.devices.quads.handles.one(handle) else { return robot.failed(Call::QUADRead, 0) };
    count(robot, index)
}

/// Ticks of encoder `index` since its reset.
pub(super) fn count(robot: &mut Robot, index: usize) -> i32 {
    let start = robot.devices.quads.count_start[index];
    let ticks = ticks_since(robot, index, start);
    record_ticks(robot, index, ticks);
    // Counters of 32 bits wrap.
    ticks as i32
}

/// Sets encoder `index` to 0.
pub(super) fn reset(robot: &mut Robot, index: usize) {
    robot.devices.quads.count_start[index] = angle_of(robot, index);
}

/// `QUADGetMotor`
pub fn quad_motor(robot: &mut Robot, semantics: i32) -> i32 {
    let table = &robot.devices.table;
    let index = table.find(HDT_QUAD, semantics).map(|device| device.index);
    let motor = index.and_then(|index| table.of_kind(HDT_MOTOR).find(|motor| motor.index == index));
    motor.map(|motor| motor.number()).unwrap_or_else(|| robot.failed(Call::QUADGetMotor, 0))
}

/// `QUADODORead`
pub fn odometer_read(robot: &mut Robot, handle: i32) -> f32 {
    let Some(index) = robot.devices.quads.handles.one(handle) else {
        robot.failed(Call::QUADODORead, 0);
        return 0.0;
    };
    let start = robot.devices.quads.distance_start[index];
    let ticks = ticks_since(robot, index, start);
    record_ticks(robot, index, ticks);
    let model = robot.motion.model();
    (ticks as f64 / model.ticks_per_turn * PI * model.wheel_diameter) as f32
}

/// `QUADODOReset`
pub fn odometer_reset(robot: &mut Robot, handles: i32) -> i32 {
    let Some(quads) = robot.devices.quads.handles.all(handles) else { return robot.failed(Call::QUADODOReset, -1) };
    quads.for_each(|index| robot.devices.quads.distance_start[index] = angle_of(robot, index));
    0
}

fn record_ticks(robot: &mut Robot, index: usize, value: i64) {
    let device = robot.spec.drive.motors[index].encoder.as_deref().unwrap_or_default();
    robot.journal.record(robot.now, &Event::Reading { device, value });
}

/// Switches encoder `index` on or off at `at`: while it is off it counts nothing.
pub(super) fn switch_encoder(robot: &mut Robot, index: usize, is_on: bool, at: Time) {
    let turned = robot.motion.wheel_angles(at)[index];
    let Quads { held, missed, .. } = &mut robot.devices.quads;
    if is_on {
        let held = held[index].take();
        missed[index] = held.map_or(missed[index], |held| turned - held);
    } else {
        held[index].get_or_insert(turned - missed[index]);
    }
}

/// Angle of a wheel as its encoder knows it, rad.
fn angle_of(robot: &mut Robot, index: usize) -> f64 {
    let Quads { held, missed, .. } = robot.devices.quads;
    held[index].unwrap_or_else(|| robot.motion.wheel_angles(robot.now)[index] - missed[index])
}

/// Whole ticks of a wheel's encoder since it stood at `start`, towards 0.
fn ticks_since(robot: &mut Robot, index: usize, start: f64) -> i64 {
    let turned = angle_of(robot, index) - start;
    let ticks = turned / TAU * robot.motion.model().ticks_per_turn;
    (ticks + EDGE.copysign(ticks)).trunc() as i64
}
