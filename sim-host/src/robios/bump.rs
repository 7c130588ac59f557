//! Bumpers: arcs of the body's edge that detect the beginning of a contact.
//!
//! Source: RoBIOS 6 library, bumper and infrared sensors.

use robios_sys::robios6::hdt_type::HDT_BUMP;
use robios_sys::{Out, Robios6Call as Call};
use sim_core::sensor::Bumper;
use sim_core::simulation;
use sim_core::time::Time;

use super::handle::Handles;
use super::os;
use super::robot::Robot;
use sim_core::device::switch::SensorId;
use sim_core::record::Event;

/// State of a robot's bumpers.
#[derive(Clone, Debug, Default)]
pub struct Bumpers {
    handles: Handles,
    /// For each bumper, the time before which contacts have been reported.
    reported_until: Vec<Time>,
}

/// `BUMPInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    let Some(index) = robot.robios.table.find(HDT_BUMP, semantics).map(|device| device.index) else {
        return robot.refuse_missing_device(Call::BUMPInit, 0, HDT_BUMP, semantics);
    };
    let bumpers = &mut robot.robios.bumpers;
    if !bumpers.handles.is_open(index) {
        bumpers.reported_until.resize(bumpers.reported_until.len().max(index + 1), Time::ZERO);
        bumpers.reported_until[index] = robot.state.now;
    }
    bumpers.handles.open(index)
}

/// `BUMPRelease`
pub fn release(robot: &mut Robot, handles: i32) -> i32 {
    match robot.robios.bumpers.handles.release(handles) {
        0 => 0,
        unopened => robot.fail_call(Call::BUMPRelease, unopened),
    }
}

/// `BUMPCheck`: the switch closes when a contact begins; a lasting contact is reported once.
pub fn check(robot: &mut Robot, handle: i32, stamp: &mut Out<i32>) -> i32 {
    let Some(index) = robot.robios.bumpers.handles.device(handle) else {
        return robot.refuse_handle(Call::BUMPCheck, -1, handle, Call::BUMPInit);
    };
    let reported_until = robot.robios.bumpers.reported_until[index];
    robot.robios.bumpers.reported_until[index] = robot.now + Time(1);
    let is_on = robot.devices.switches.is_on(SensorId::Bumper(index));
    let simulation::Robot { spec, motion, now, .. } = &mut robot.state;
    let first = spec.bumpers.get(index).filter(|_| is_on).and_then(|spec| {
        let bumper = Bumper { bearing: 0.5 * (spec.from + spec.to), half_angle: 0.5 * (spec.to - spec.from) };
        let impacts = motion.impacts(reported_until, *now);
        impacts.into_iter().find(|impact| impact.fresh && bumper.is_pressed_by(impact))
    });
    if let Some(impact) = first {
        stamp.set(os::hundredths(impact.time));
    }
    let device = robot.robios.table.name(HDT_BUMP, index);
    robot.state.journal.record(robot.state.now, &Event::Reading { device, value: first.is_some().into() });
    if first.is_some() { 0 } else { -1 }
}
