//! PSD distance sensors, and all range sensors as PSDs: one driver that measures a chosen set of them in cycles of 60 ms.
//!
//! A value exists only at the end of a complete cycle and is a function of the world at that instant, computed when it is
//! first asked for. Source: RoBIOS 6 library, position sensing devices.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::PSD_OUT_OF_RANGE;
use robios_sys::robios6::hdt_type::HDT_PSD;
use sim_core::drive::Motion;
use sim_core::sensor::Reading;
use sim_core::time::Time;
use sim_core::world::World;

use super::Devices;
use super::cycle::Cycle;
use super::handle::{Handles, MAX_DEVICES};
use super::hint::Mistake;
use super::os;
use super::robot::Robot;
use super::switch::Sensor;
use sim_core::record::Event;

/// Length of a measuring cycle. Source: RoBIOS manual, about 60 ms.
pub const CYCLE: Time = Time::from_millis(60);

/// The raw byte times the distance in millimetres, see [`raw_from_distance`].
const RAW_MM: f64 = 20_400.0;

/// What `PSDGetSignal` answers where there is no sensor, or no value yet.
pub(super) const NO_SIGNAL: f32 = -1.0;

/// The driver of all PSD sensors of a robot.
#[derive(Clone, Debug, Default)]
pub struct Psds {
    handles: Handles,
    measurement: Option<Measurement>,
    /// By sensor, in the order of the robi, as far as any was ever opened.
    readings: Vec<Latest>,
    stamp: Option<Time>,
}

#[derive(Clone, Copy, Debug)]
struct Measurement {
    sensors: i32,
    cycle: Cycle,
}

/// A sensor's latest measurement.
#[derive(Clone, Copy, Debug, Default)]
struct Latest {
    taken: Option<Time>,
    /// What it gave, once computed.
    value: Option<Reading>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// When it was measured.
    pub taken: Time,
    /// What was read.
    pub reading: Reading,
}

/// What `PSDStart` answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Started {
    /// The measurement has started.
    Yes,
    /// Another one is in progress and goes on.
    Busy,
    /// A handle that is not open.
    WrongHandle,
}

impl Psds {
    /// Opens sensor `index`; its handle, or 0 beyond [`super::handle::MAX_DEVICES`].
    pub fn open(&mut self, index: usize) -> i32 {
        let handle = self.handles.open(index);
        if handle != 0 && self.readings.len() <= index {
            self.readings.resize_with(index + 1, Latest::default);
        }
        handle
    }

    /// Stops measuring and takes back all handles; old values are gone.
    pub fn release(&mut self) {
        *self = Self::default();
    }

    /// True once a sensor has been opened.
    pub fn is_open(&self) -> bool {
        self.handles.is_any_open()
    }

    /// The sensor of a handle.
    pub fn sensor(&self, handle: i32) -> Option<usize> {
        self.handles.one(handle)
    }

    /// Starts measuring with an OR of handles at `now`, once or in cycles without end.
    ///
    /// No value counts as valid until the first cycle is complete; the sensors keep their older values until then.
    pub fn start(&mut self, handles: i32, is_continuous: bool, now: Time) -> Started {
        self.advance(now);
        if self.handles.all(handles).is_none() {
            return Started::WrongHandle;
        }
        if self.measurement.is_some() {
            return Started::Busy;
        }
        self.stamp = None;
        self.measurement = Some(Measurement { sensors: handles, cycle: Cycle::new(now, CYCLE, is_continuous) });
        Started::Yes
    }

    /// Ends the measurement with the cycle in progress.
    pub fn stop(&mut self, now: Time) {
        self.advance(now);
        if let Some(measurement) = &mut self.measurement {
            measurement.cycle.stop(now);
        }
    }

    /// End of the latest cycle completed since the last start; `None` while there is none.
    pub fn stamp(&mut self, now: Time) -> Option<Time> {
        self.advance(now);
        self.stamp
    }

    /// The latest value of sensor `index`; `None` if it has never completed a cycle. `measure` gives what the sensor reads at
    /// an instant.
    pub fn read(&mut self, index: usize, now: Time, measure: impl FnOnce(usize, Time) -> Reading) -> Option<Measured> {
        self.advance(now);
        let latest = self.readings.get_mut(index)?;
        let taken = latest.taken?;
        let reading = *latest.value.get_or_insert_with(|| measure(index, taken));
        Some(Measured { taken, reading })
    }

    /// When the measurement ends that is not without end: then [`settle`](Self::settle) must be called, since the world does
    /// not remember for long what the sensors saw. [`Time::NEVER`] if there is none.
    pub fn due(&self) -> Time {
        self.measurement.map_or(Time::NEVER, |measurement| measurement.cycle.last_end())
    }

    /// Computes the values of a measurement that has ended by `now`.
    pub fn settle(&mut self, now: Time, mut measure: impl FnMut(usize, Time) -> Reading) {
        if now < self.due() {
            return;
        }
        let Some(Measurement { sensors, .. }) = self.measurement else { return };
        self.advance(now);
        for index in self.handles.all(sensors).into_iter().flatten() {
            self.read(index, now, &mut measure);
        }
    }

    /// Takes over the cycles that have been completed by `now`.
    fn advance(&mut self, now: Time) {
        let Some(Measurement { sensors, cycle }) = self.measurement else { return };
        let Some(taken) = cycle.latest(now) else { return };
        if self.stamp != Some(taken) {
            self.stamp = Some(taken);
            for index in self.handles.all(sensors).into_iter().flatten() {
                self.readings[index] = Latest { taken: Some(taken), value: None };
            }
        }
        if cycle.is_over(now) {
            self.measurement = None;
        }
    }
}

/// A distance in metres as `PSDGet` gives it: whole millimetres, [`PSD_OUT_OF_RANGE`] for nothing.
pub fn mm_from_distance(metres: Option<f64>) -> i32 {
    metres.map_or(PSD_OUT_OF_RANGE, |metres| {
        (sim_core::unit::mm_from_metres(metres).round() as i32).min(PSD_OUT_OF_RANGE)
    })
}

/// A distance in metres as `PSDGetRaw` gives it: 20 400 divided by the millimetres, at most 255 (from 80 mm down), 0 for
/// nothing.
///
/// The shape is that of the sensor (the nearer, the greater); the constant is our choice, so that the byte is used up over
/// the 80 to 800 mm of the Sharp GP2D02.
pub fn raw_from_distance(metres: Option<f64>) -> i32 {
    // A distance of 0 divides to infinity, which the conversion saturates.
    metres.map_or(0, |metres| i32::from((RAW_MM / sim_core::unit::mm_from_metres(metres)).round() as u8))
}

/// `PSDInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    match robot.devices.table.find(HDT_PSD, semantics).map(|device| device.index) {
        Some(index) => match robot.devices.psds.open(index) {
            0 => robot.refused(Call::PSDInit, 0, |robot| {
                format!(
                    "a handle is a bit, and the first {MAX_DEVICES} range sensors of `{}` have them all",
                    robot.spec.file
                )
            }),
            handle => handle,
        },
        None => robot.has_no(Call::PSDInit, 0, HDT_PSD, semantics),
    }
}

/// `PSDRelease`
pub fn release(robot: &mut Robot) -> i32 {
    robot.devices.psds.release();
    0
}

/// `PSDStart`
pub fn start(robot: &mut Robot, handles: i32, is_continuous: bool) -> i32 {
    match robot.devices.psds.start(handles, is_continuous, robot.now) {
        Started::Yes => 0,
        Started::Busy => {
            robot.hint_at(Mistake::PsdBusy);
            robot.failed(Call::PSDStart, 1)
        }
        Started::WrongHandle => robot.failed(Call::PSDStart, -1),
    }
}

/// `PSDStop`
pub fn stop(robot: &mut Robot) -> i32 {
    robot.devices.psds.stop(robot.now);
    0
}

/// `PSDCheck`
pub fn check(robot: &mut Robot) -> i32 {
    robot.devices.psds.stamp(robot.now).is_some().into()
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
    let Some((index, Measured { taken, reading })) = value(robot, world, handle, Call::PSDGetSignal) else {
        return NO_SIGNAL;
    };
    record_signal(robot, index, taken, reading.signal);
    reading.signal as f32
}

/// The distance that a sensor has measured in metres, `None` for nothing; or, for handle 0, the time stamp.
fn distance(robot: &mut Robot, world: &World, handle: i32, call: Call) -> Result<Option<f64>, i32> {
    if handle == 0 {
        if !robot.devices.psds.is_open() {
            robot.hint_at(Mistake::PsdNotOpen);
        }
        return Err(robot.devices.psds.stamp(robot.now).map_or(0, os::hundredths));
    }
    let Some((index, Measured { taken, reading })) = value(robot, world, handle, call) else { return Ok(None) };
    record_distance(robot, index, taken, reading.distance);
    Ok(reading.distance)
}

/// The sensor of a handle and what it has measured; `None`, and a hint, where there is none or nothing yet.
fn value(robot: &mut Robot, world: &World, handle: i32, call: Call) -> Option<(usize, Measured)> {
    let Some(index) = robot.devices.psds.sensor(handle) else {
        robot.hint_at(Mistake::PsdNotOpen);
        robot.failed(call, PSD_OUT_OF_RANGE);
        return None;
    };
    let Robot { now, motion, devices, .. } = robot;
    let measured = with_sensors(devices, motion, world, |psds, measure| psds.read(index, *now, measure));
    if measured.is_none() {
        robot.hint_at(Mistake::PsdNotStarted);
    }
    Some((index, measured?))
}

/// Computes the values of a measurement that has just ended, before the world forgets what the sensors saw.
pub fn settle(robot: &mut Robot, world: &World) {
    let Robot { now, motion, devices, .. } = robot;
    with_sensors(devices, motion, world, |psds, measure| psds.settle(*now, measure));
}

/// Does `act` with the driver and with what a sensor reads at an instant.
fn with_sensors<R>(
    devices: &mut Devices,
    motion: &mut Motion,
    world: &World,
    act: impl FnOnce(&mut Psds, &mut dyn FnMut(usize, Time) -> Reading) -> R,
) -> R {
    let Devices { psds, servos, ranges, switches, .. } = devices;
    act(psds, &mut |index, at| {
        let is_on = switches.is_on(Sensor::Range(index));
        if is_on { ranges.read(index, servos, motion, world, at) } else { ranges.nothing(index) }
    })
}

/// Records that a program reads a distance.
pub(super) fn record_distance(robot: &mut Robot, index: usize, taken: Time, distance_m: Option<f64>) {
    let device = robot.devices.table.name(HDT_PSD, index);
    robot.journal.record(robot.now, &Event::Distance { device, distance_m, measured_s: taken.seconds() });
}

/// Records that a program reads a signal.
pub(super) fn record_signal(robot: &mut Robot, index: usize, taken: Time, signal: f64) {
    let device = robot.devices.table.name(HDT_PSD, index);
    robot.journal.record(robot.now, &Event::Signal { device, signal, measured_s: taken.seconds() });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A world in which sensor i sees i metres plus the seconds of the instant.
    fn seen(index: usize, at: Time) -> Reading {
        Reading { distance: Some(index as f64 + at.seconds()), signal: 1.0 }
    }

    fn measured(taken: Time, metres: f64) -> Option<Measured> {
        Some(Measured { taken, reading: Reading { distance: Some(metres), signal: 1.0 } })
    }

    fn opened() -> Psds {
        let mut psds = Psds::default();
        assert_eq!([psds.open(0), psds.open(1), psds.open(2)], [1, 2, 4]);
        psds
    }

    #[test]
    fn a_value_is_as_old_as_its_cycle() {
        let mut psds = opened();
        assert_eq!(psds.start(0b101, true, Time(1_000)), Started::Yes);
        assert_eq!(psds.read(0, Time(60_999), seen), None);
        assert_eq!(psds.stamp(Time(60_999)), None);
        let at_once = psds.read(2, Time(61_000), seen);
        assert_eq!(at_once, measured(Time(61_000), 2.061));
        let later = psds.read(2, Time(120_999), |_, _| panic!("the value is known"));
        assert_eq!(later, at_once);
        assert_eq!(psds.read(2, Time(121_000), seen).unwrap().taken, Time(121_000));
        assert_eq!(psds.read(1, Time(121_000), seen), None, "not started");
        assert_eq!(psds.due(), Time::NEVER);
    }

    #[test]
    fn a_single_measurement_is_kept_until_the_next() {
        let mut psds = opened();
        psds.start(1, false, Time(0));
        assert_eq!(psds.due(), Time(60_000));
        assert_eq!(psds.start(1, false, Time(59_999)), Started::Busy);
        psds.settle(Time(60_000), seen);
        assert_eq!(psds.due(), Time::NEVER);
        let kept = measured(Time(60_000), 0.06);
        assert_eq!(psds.read(0, Time(9_000_000), |_, _| panic!("settled")), kept);
        assert_eq!(psds.start(1, true, Time(9_000_000)), Started::Yes);
        assert_eq!(psds.stamp(Time(9_000_001)), None, "nothing new is valid yet");
        assert_eq!(psds.read(0, Time(9_000_001), seen), kept, "the old value stays");
    }

    #[test]
    fn stop_completes_the_cycle_in_progress() {
        let mut psds = opened();
        psds.start(1, true, Time(0));
        psds.stop(Time(130_000));
        assert_eq!(psds.start(1, true, Time(179_999)), Started::Busy);
        assert_eq!(psds.start(1, true, Time(180_000)), Started::Yes);
        assert_eq!(psds.read(0, Time(180_000), seen).unwrap().taken, Time(180_000));
    }

    #[test]
    fn wrong_handles() {
        let mut psds = opened();
        assert_eq!(psds.start(0, true, Time(0)), Started::WrongHandle);
        assert_eq!(psds.start(8, true, Time(0)), Started::WrongHandle);
        assert_eq!(psds.sensor(3), None);
        psds.start(1, true, Time(0));
        psds.release();
        assert_eq!((psds.start(1, true, Time(0)), psds.is_open()), (Started::WrongHandle, false));
        assert_eq!(psds.read(7, Time(0), seen), None);
    }

    #[test]
    fn units() {
        assert_eq!(mm_from_distance(Some(0.1234)), 123);
        assert_eq!(mm_from_distance(Some(0.1236)), 124);
        assert_eq!([mm_from_distance(None), mm_from_distance(Some(50.0))], [9999, 9999]);
        assert_eq!([0.8, 0.2, 0.08, 0.0].map(|metres| raw_from_distance(Some(metres))), [26, 102, 255, 255]);
        assert_eq!(raw_from_distance(None), 0);
    }
}
