//! The compass: whole degrees clockwise from north.
//!
//! Source: RoBIOS 6 library, compass.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::HDT_COMPASS;
use sim_core::unit;

use super::robot::Robot;
use sim_core::device::switch::SensorId;
use sim_core::record::Event;

/// `COMPASSInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    if robot.robios.table.find(HDT_COMPASS, semantics).is_none() {
        return robot.refuse_missing_device(Call::COMPASSInit, 1, HDT_COMPASS, semantics);
    }
    robot.robios.has_compass = true;
    0
}

/// `COMPASSStart`
pub fn start(robot: &mut Robot, is_continuous: bool) -> i32 {
    let is_started = robot.robios.has_compass && robot.state.devices.compass.start(is_continuous, robot.state.now);
    if is_started { 0 } else { robot.fail_call(Call::COMPASSStart, 1) }
}

/// `COMPASSCheck`
pub fn check(robot: &mut Robot) -> i32 {
    let is_on = robot.devices.switches.is_on(SensorId::Compass);
    (robot.state.devices.compass.is_valid(robot.state.now) && is_on).into()
}

/// `COMPASSStop`
pub fn stop(robot: &mut Robot) -> i32 {
    robot.state.devices.compass.stop(robot.state.now);
    if robot.robios.has_compass { 0 } else { robot.fail_call(Call::COMPASSStop, 1) }
}

/// `COMPASSRelease`
pub fn release(robot: &mut Robot) -> i32 {
    robot.devices.compass.reset();
    if std::mem::take(&mut robot.robios.has_compass) { 0 } else { robot.fail_call(Call::COMPASSRelease, 1) }
}

/// `COMPASSCalibrate`: the simulated compass needs no calibration.
pub fn calibrate(robot: &mut Robot) -> i32 {
    if robot.robios.has_compass { 0 } else { robot.fail_call(Call::COMPASSCalibrate, 1) }
}

/// `COMPASSGet`
pub fn get(robot: &mut Robot) -> i32 {
    let degrees = read(robot);
    if let Some(compass) = &robot.state.spec.compass {
        let angle_rad = degrees.map(|degrees| unit::radians_from_degrees(degrees.into()));
        robot.state.journal.record(robot.state.now, &Event::Compass { device: &compass.name, angle_rad });
    }
    degrees.unwrap_or_else(|| robot.fail_call(Call::COMPASSGet, -1))
}

fn read(robot: &mut Robot) -> Option<i32> {
    let is_on = robot.devices.switches.is_on(SensorId::Compass);
    robot.read_compass().filter(|_| is_on).map(whole_degrees)
}

/// An angle in radians as a compass reading in whole degrees, 0 to 359; both are clockwise from north.
fn whole_degrees(angle_rad: f64) -> i32 {
    (unit::degrees_from_radians(angle_rad).round() as i32).rem_euclid(360)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn angles_are_rounded_to_whole_degrees_from_0_to_359() {
        assert_eq!([0.0, PI / 2.0, PI, -PI / 2.0].map(whole_degrees), [0, 90, 180, 270]);
        assert_eq!(whole_degrees(-0.001), 0, "359.94 rounds to 0, not to 360");
    }
}
