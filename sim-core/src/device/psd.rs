//! Driver of the range sensors: measures with a chosen set of sensors in cycles of 60 ms.
//!
//! A value exists only at the end of a complete cycle. The value is a function of the world at that instant and is
//! computed lazily: [`Ranges::read`](super::range::Ranges::read) computes it and adds the errors. Source: RoBIOS 6
//! library, position sensing devices.

use std::ops::Range;

use super::cycle::Cycle;
use crate::sensor::Reading;
use crate::time::Time;

/// Length of a measuring cycle. Source: RoBIOS manual, about 60 ms.
pub const CYCLE: Time = Time::from_millis(60);

/// A set of range sensors: bit `i` is sensor `i` of the robi.
pub type SensorSet = u32;

/// The driver of all PSD sensors of a robot.
#[derive(Clone, Debug, Default)]
pub struct Psds {
    measurement: Option<Measurement>,
    /// Latest measurements by sensor, in the order of the robi, up to the last sensor that has ever measured.
    readings: Vec<Latest>,
    /// End of the latest cycle completed since the last start.
    stamp: Option<Time>,
}

#[derive(Clone, Copy, Debug)]
struct Measurement {
    sensors: SensorSet,
    cycle: Cycle,
    /// End of the cycle that was in progress at the last [`Psds::advance`]; nothing changes before.
    next: Time,
}

/// A sensor's latest measurement.
#[derive(Clone, Copy, Debug, Default)]
struct Latest {
    measured_at: Option<Time>,
    /// The reading, once computed.
    value: Option<Reading>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Instant of the measurement.
    pub measured_at: Time,
    /// The reading.
    pub reading: Reading,
}

impl Psds {
    /// Starts measuring with `sensors` at `now`, for one cycle or continuously. Returns false, without effect, if a
    /// measurement is in progress.
    ///
    /// Until the first cycle is complete, [`stamp`](Self::stamp) is `None` and [`read`](Self::read) returns older values.
    pub fn start(&mut self, sensors: SensorSet, is_continuous: bool, now: Time) -> bool {
        self.advance(now);
        if self.measurement.is_some() {
            return false;
        }
        let count = (SensorSet::BITS - sensors.leading_zeros()) as usize;
        if self.readings.len() < count {
            self.readings.resize_with(count, Latest::default);
        }
        self.stamp = None;
        let cycle = Cycle::new(now, CYCLE, is_continuous);
        self.measurement = Some(Measurement { sensors, cycle, next: cycle.end(1) });
        true
    }

    /// Stops measuring at the end of the cycle in progress.
    pub fn stop(&mut self, now: Time) {
        self.advance(now);
        if let Some(measurement) = &mut self.measurement {
            measurement.cycle.stop(now);
        }
    }

    /// End of the latest cycle completed since the last start; `None` if there is none.
    pub fn stamp(&mut self, now: Time) -> Option<Time> {
        self.advance(now);
        self.stamp
    }

    /// The latest value of sensor `index`; `None` if the sensor has never completed a cycle. `measure` computes the sensor's
    /// reading at an instant.
    pub fn read(&mut self, index: usize, now: Time, measure: impl FnOnce(usize, Time) -> Reading) -> Option<Measured> {
        self.advance(now);
        let latest = self.readings.get_mut(index)?;
        let measured_at = latest.measured_at?;
        let reading = *latest.value.get_or_insert_with(|| measure(index, measured_at));
        Some(Measured { measured_at, reading })
    }

    /// Addresses of the heap memory that [`Psds::read`] touches.
    pub(crate) fn hot_memory(&self) -> Range<*const u8> {
        let Range { start, end } = self.readings.as_ptr_range();
        start.cast()..end.cast()
    }

    /// End of the measurement in progress if it is not continuous, otherwise [`Time::NEVER`]. [`settle`](Self::settle)
    /// must be called at that time, because the world keeps only a short history.
    #[inline]
    pub fn due(&self) -> Time {
        self.measurement.map_or(Time::NEVER, |measurement| measurement.cycle.last_end())
    }

    /// Computes the values of a measurement that ended by `now`.
    pub fn settle(&mut self, now: Time, mut measure: impl FnMut(usize, Time) -> Reading) {
        if now < self.due() {
            return;
        }
        let Some(Measurement { sensors, .. }) = self.measurement else { return };
        self.advance(now);
        for index in members(sensors) {
            self.read(index, now, &mut measure);
        }
    }

    /// Updates time stamps and measurements to the cycles completed by `now`.
    fn advance(&mut self, now: Time) {
        let Some(Measurement { sensors, cycle, next }) = &mut self.measurement else { return };
        if now < *next {
            return;
        }
        let (sensors, cycle) = (*sensors, *cycle);
        *next = cycle.end(cycle.completed(now) + 1);
        let Some(measured_at) = cycle.latest_end(now) else { return };
        if self.stamp != Some(measured_at) {
            self.stamp = Some(measured_at);
            for index in members(sensors) {
                self.readings[index] = Latest { measured_at: Some(measured_at), value: None };
            }
        }
        if cycle.is_over(now) {
            self.measurement = None;
        }
    }
}

/// The sensors of a set, in order.
fn members(sensors: SensorSet) -> impl Iterator<Item = usize> {
    (0..SensorSet::BITS).filter(move |index| sensors >> index & 1 == 1).map(|index| index as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reading in a world in which sensor i measures i metres plus one metre per second of virtual time.
    fn measure(index: usize, at: Time) -> Reading {
        Reading { distance: Some(index as f64 + at.seconds()), signal: 1.0 }
    }

    fn measured(measured_at: Time, metres: f64) -> Option<Measured> {
        Some(Measured { measured_at, reading: Reading { distance: Some(metres), signal: 1.0 } })
    }

    #[test]
    fn a_value_is_measured_at_the_end_of_its_cycle() {
        let mut psds = Psds::default();
        assert!(psds.start(0b101, true, Time(1_000)));
        assert_eq!(psds.read(0, Time(60_999), measure), None);
        assert_eq!(psds.stamp(Time(60_999)), None);
        let first = psds.read(2, Time(61_000), measure);
        assert_eq!(first, measured(Time(61_000), 2.061));
        let later = psds.read(2, Time(120_999), |_, _| panic!("the value is known"));
        assert_eq!(later, first);
        assert_eq!(psds.read(2, Time(121_000), measure).unwrap().measured_at, Time(121_000));
        assert_eq!(psds.read(1, Time(121_000), measure), None, "not started");
        assert_eq!(psds.due(), Time::NEVER);
    }

    #[test]
    fn a_single_measurement_is_kept_until_the_next() {
        let mut psds = Psds::default();
        psds.start(1, false, Time(0));
        assert_eq!(psds.due(), Time(60_000));
        assert!(!psds.start(1, false, Time(59_999)));
        psds.settle(Time(60_000), measure);
        assert_eq!(psds.due(), Time::NEVER);
        let reading = measured(Time(60_000), 0.06);
        assert_eq!(psds.read(0, Time(9_000_000), |_, _| panic!("settled")), reading);
        assert!(psds.start(1, true, Time(9_000_000)));
        assert_eq!(psds.stamp(Time(9_000_001)), None, "nothing new is valid yet");
        assert_eq!(psds.read(0, Time(9_000_001), measure), reading, "the old value stays");
    }

    #[test]
    fn stop_completes_the_cycle_in_progress() {
        let mut psds = Psds::default();
        psds.start(1, true, Time(0));
        psds.stop(Time(130_000));
        assert!(!psds.start(1, true, Time(179_999)));
        assert!(psds.start(1, true, Time(180_000)));
        assert_eq!(psds.read(0, Time(180_000), measure).unwrap().measured_at, Time(180_000));
    }
}
