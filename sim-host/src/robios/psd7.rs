//! PSD distance sensors as RoBIOS-7 has them: read at once, in millimetres.
//!
//! Source: RoBIOS-7 library, distance sensors.

use robios_sys::Robios7Call as Call;
use robios_sys::robios6::hdt_type::HDT_PSD;
use sim_core::world::World;

use super::psd::{measure, mm_from_distance, raw_from_distance};
use super::robot::Robot;
use crate::record::Event;

/// The sensors 1 to 7 by name. Source: EyeSim VR; RoBIOS-7's header has the first four.
const NAMES: [&str; 7] =
    ["PSD_FRONT", "PSD_LEFT", "PSD_RIGHT", "PSD_BACK", "PSD_FRONT2", "PSD_LEFTDIAG", "PSD_RIGHTDIAG"];

/// `PSDGet`
pub fn get(robot: &mut Robot, world: &World, psd: i32) -> i32 {
    see(robot, world, Call::PSDGet, psd).map_or(0, mm_from_distance)
}

/// `PSDGetRaw`
pub fn get_raw(robot: &mut Robot, world: &World, psd: i32) -> i32 {
    see(robot, world, Call::PSDGetRaw, psd).map_or(0, raw_from_distance)
}

/// What a sensor sees now: a distance in metres or nothing; `None` if there is no such sensor.
fn see(robot: &mut Robot, world: &World, call: Call, psd: i32) -> Option<Option<f64>> {
    let Some(index) = robot.find_numbered(call, HDT_PSD, psd, &NAMES) else {
        robot.failed(call, 0);
        return None;
    };
    let Robot { now, motion, spec, journal, .. } = robot;
    let metres = measure(&spec.psds, motion, world, index, *now);
    let event = Event::Distance { device: &spec.psds[index].name, distance_m: metres, measured_s: now.seconds() };
    journal.record(*now, &event);
    Some(metres)
}
