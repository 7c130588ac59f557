//! PSD distance sensors; programs see all range sensors as PSDs.
//!
//! Source: RoBIOS 6 library, position sensing devices.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::PSD_OUT_OF_RANGE;
use robios_sys::robios6::hdt_type::HDT_PSD;
use sim_core::device::psd::{Measured, Psds};
use sim_core::time::Time;
use sim_core::world::World;

use super::handle::MAX_DEVICES;
use super::hint::Mistake;
use super::os;
use super::robot::Robot;
use sim_core::record::Event;

/// Product of the raw byte and the distance in millimetres, see [`raw_from_distance`].
const RAW_MM: f64 = 20_400.0;

/// Return value of `PSDGetSignal` if there is no sensor, or no value yet.
pub(super) const NO_SIGNAL: f32 = -1.0;

/// Converts a distance in metres for `PSDGet`: whole millimetres, [`PSD_OUT_OF_RANGE`] for no return.
pub fn mm_from_distance(metres: Option<f64>) -> i32 {
    metres.map_or(PSD_OUT_OF_RANGE, |metres| {
        (sim_core::unit::mm_from_metres(metres).round() as i32).min(PSD_OUT_OF_RANGE)
    })
}

/// Converts a distance in metres for `PSDGetRaw`: 20 400 divided by the millimetres, at most 255 (from 80 mm down), 0
/// for no return.
///
/// As for the real sensor, nearer objects give larger values. The constant is our choice: with it, the range of the
/// Sharp GP2D02, 80 to 800 mm, uses the whole byte.
pub fn raw_from_distance(metres: Option<f64>) -> i32 {
    // A distance of 0 yields infinity, which the conversion saturates.
    metres.map_or(0, |metres| i32::from((RAW_MM / sim_core::unit::mm_from_metres(metres)).round() as u8))
}

/// `PSDInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    match robot.robios.table.find(HDT_PSD, semantics).map(|device| device.index) {
        Some(index) => match robot.robios.psds.open(index) {
            0 => robot.refuse_call(Call::PSDInit, 0, |robot| {
                format!(
                    "a handle is a bit, and the first {MAX_DEVICES} range sensors of `{}` have them all",
                    robot.spec.file
                )
            }),
            handle => handle,
        },
        None => robot.refuse_missing_device(Call::PSDInit, 0, HDT_PSD, semantics),
    }
}

/// `PSDRelease`
pub fn release(robot: &mut Robot) -> i32 {
    robot.robios.psds.release_all();
    robot.devices.psds = Psds::default();
    0
}

/// `PSDStart`
pub fn start(robot: &mut Robot, handles: i32, is_continuous: bool) -> i32 {
    if robot.robios.psds.devices(handles).is_none() {
        return robot.fail_call(Call::PSDStart, -1);
    }
    let Robot { state, .. } = robot;
    if state.devices.psds.start(handles as u32, is_continuous, state.now) {
        return 0;
    }
    robot.hint_at(Mistake::PsdBusy);
    robot.fail_call(Call::PSDStart, 1)
}

/// `PSDStop`
pub fn stop(robot: &mut Robot) -> i32 {
    robot.state.devices.psds.stop(robot.state.now);
    0
}

/// `PSDCheck`
pub fn check(robot: &mut Robot) -> i32 {
    robot.state.devices.psds.stamp(robot.state.now).is_some().into()
}

/// `PSDGet`
pub fn get(robot: &mut Robot, world: &World, handle: i32) -> i32 {
    distance(robot, world, handle, Call::PSDGet).map_or_else(|stamp| stamp, mm_from_distance)
}

/// `PSDGetRaw`
pub fn get_raw(robot: &mut Robot, world: &World, handle: i32) -> i32 {
    distance(robot, world, handle, Call::PSDGetRaw).map_or_else(|stamp| stamp, raw_from_distance)
}

/// `PSDGetSignal`
pub fn get_signal(robot: &mut Robot, world: &World, handle: i32) -> f32 {
    let Some((index, Measured { measured_at, reading })) = measurement(robot, world, handle, Call::PSDGetSignal) else {
        return NO_SIGNAL;
    };
    record_signal(robot, index, measured_at, reading.signal);
    reading.signal as f32
}

/// Distance measured by a sensor in metres, `None` for no return or no value; `Err` with the time stamp for handle 0.
fn distance(robot: &mut Robot, world: &World, handle: i32, call: Call) -> Result<Option<f64>, i32> {
    if handle == 0 {
        if !robot.robios.psds.is_any_open() {
            robot.hint_at(Mistake::PsdNotOpen);
        }
        return Err(robot.state.devices.psds.stamp(robot.state.now).map_or(0, os::hundredths));
    }
    let Some((index, Measured { measured_at, reading })) = measurement(robot, world, handle, call) else {
        return Ok(None);
    };
    record_distance(robot, index, measured_at, reading.distance);
    Ok(reading.distance)
}

/// Index and measurement of the sensor with this handle; `None`, with a hint, if there is no such sensor or no
/// measurement yet.
fn measurement(robot: &mut Robot, world: &World, handle: i32, call: Call) -> Option<(usize, Measured)> {
    let Some(index) = robot.robios.psds.device(handle) else {
        robot.hint_at(Mistake::PsdNotOpen);
        robot.fail_call(call, PSD_OUT_OF_RANGE);
        return None;
    };
    let measured = robot.measured_range(world, index);
    if measured.is_none() {
        robot.hint_at(Mistake::PsdNotStarted);
    }
    Some((index, measured?))
}

/// Records that a program reads a distance.
pub(super) fn record_distance(robot: &mut Robot, index: usize, measured_at: Time, distance_m: Option<f64>) {
    let device = robot.state.spec.range_name(index);
    robot
        .state
        .journal
        .record(robot.state.now, &Event::Distance { device, distance_m, measured_s: measured_at.seconds() });
}

/// Records that a program reads a signal.
pub(super) fn record_signal(robot: &mut Robot, index: usize, measured_at: Time, signal: f64) {
    let device = robot.state.spec.range_name(index);
    robot.state.journal.record(robot.state.now, &Event::Signal { device, signal, measured_s: measured_at.seconds() });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_of_distances() {
        assert_eq!(mm_from_distance(Some(0.1234)), 123);
        assert_eq!(mm_from_distance(Some(0.1236)), 124);
        assert_eq!([mm_from_distance(None), mm_from_distance(Some(50.0))], [9999, 9999]);
        assert_eq!([0.8, 0.2, 0.08, 0.0].map(|metres| raw_from_distance(Some(metres))), [26, 102, 255, 255]);
        assert_eq!(raw_from_distance(None), 0);
    }
}
