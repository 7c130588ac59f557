//! PSD distance sensors of RoBIOS-7: each call measures, in millimetres.
//!
//! Source: RoBIOS-7 library, distance sensors.

use robios_sys::Robios7Call as Call;
use robios_sys::robios6::hdt_type::HDT_PSD;
use sim_core::sensor::Reading;
use sim_core::world::World;

use super::psd::{NO_SIGNAL, mm_from_distance, raw_from_distance, record_distance, record_signal};
use super::robot::Robot;

/// Names of sensors 1 to 7. Source: EyeSim VR; RoBIOS-7's header has the first four.
const NAMES: [&str; 7] =
    ["PSD_FRONT", "PSD_LEFT", "PSD_RIGHT", "PSD_BACK", "PSD_FRONT2", "PSD_LEFTDIAG", "PSD_RIGHTDIAG"];

/// `PSDGet`
pub fn get(robot: &mut Robot, world: &World, psd: i32) -> i32 {
    distance(robot, world, Call::PSDGet, psd).map_or(0, mm_from_distance)
}

/// `PSDGetRaw`
pub fn get_raw(robot: &mut Robot, world: &World, psd: i32) -> i32 {
    distance(robot, world, Call::PSDGetRaw, psd).map_or(0, raw_from_distance)
}

/// `PSDGetSignal`
pub fn get_signal(robot: &mut Robot, world: &World, psd: i32) -> f32 {
    let Some((index, reading)) = read(robot, world, Call::PSDGetSignal, psd) else { return NO_SIGNAL };
    record_signal(robot, index, robot.now, reading.signal);
    reading.signal as f32
}

/// Current distance of a sensor in metres, `Some(None)` for no return; `None` if there is no such sensor.
fn distance(robot: &mut Robot, world: &World, call: Call, psd: i32) -> Option<Option<f64>> {
    let (index, reading) = read(robot, world, call, psd)?;
    record_distance(robot, index, robot.now, reading.distance);
    Some(reading.distance)
}

/// Index of a sensor and its current reading; `None` if there is no such sensor.
fn read(robot: &mut Robot, world: &World, call: Call, psd: i32) -> Option<(usize, Reading)> {
    let Some(index) = robot.find_numbered(call, HDT_PSD, psd, &NAMES) else {
        robot.fail_call(call, 0);
        return None;
    };
    Some((index, robot.read_range(world, index)))
}
