//! Driver of the range sensors: measures with a chosen set of sensors in cycles of 60 ms.
//!
//! A value exists only after a complete cycle, and is measured at the end of the cycle. The program's first read
//! computes the value, from what is then known of the world at the end of the cycle; [`Psds::settle`] computes the
//! values of the last cycle at the end of a measurement. [`Ranges::read`](super::range::Ranges::read) adds the errors.
//! Source: RoBIOS 6 library, position sensing devices.

use std::iter::successors;
use std::ops::Range;

use super::cycle::Cycle;
use crate::sensor::Reading;
use crate::time::Time;

/// Length of a measuring cycle. Source: RoBIOS manual, about 60 ms.
pub const CYCLE: Time = Time::from_millis(60);

/// A set of range sensors: bit `i` is sensor `i` of the robi, where the PSDs come first.
pub type SensorSet = u32;

/// The driver of all range sensors of a robot.
#[derive(Clone, Debug, Default)]
pub struct Psds {
    measurement: Option<Measurement>,
    /// Latest measurements by sensor, up to the last sensor that was ever started.
    readings: Vec<Latest>,
    /// End of the latest cycle completed since the last start.
    stamp: Option<Time>,
    /// Sensors that were read in the latest cycle.
    read: SensorSet,
    /// Sensors that were read in the cycle before the latest, and so will probably be read in the latest. The first
    /// read measures with all of them, because the rays of one instant share work.
    expected: SensorSet,
    /// Revision of the robot's motion at the last measurement. A contact that is resolved at the end of a slot can
    /// change the motion of that slot; a value that is computed but not yet read is then computed again. `None` after a
    /// change of sensors or their errors.
    revision: Option<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Measurement {
    sensors: SensorSet,
    cycle: Cycle,
    /// End of the cycle that was in progress at the last [`Psds::advance`]; nothing changes before this end.
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
    /// Until the first cycle is complete, [`stamp`](Self::stamp) is `None` and [`read`](Self::read) returns older
    /// values.
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

    /// The latest value of sensor `index` of a robot whose motion has this revision; `None` if the sensor has never
    /// completed a cycle. `measure` computes the readings of a set of sensors at an instant.
    pub fn read(&mut self, index: usize, now: Time, revision: u64, measure: impl Measure) -> Option<Measured> {
        self.advance(now);
        let measured_at = self.readings.get(index)?.measured_at?;
        if self.is_missing(index, measured_at, revision) {
            self.measure(self.expected | 1 << index, measured_at, revision, measure);
        }
        self.read |= 1 << index;
        let reading = self.readings[index].value?;
        Some(Measured { measured_at, reading })
    }

    /// Returns true if the value of a sensor that measured at `measured_at` must be computed.
    fn is_missing(&self, index: usize, measured_at: Time, revision: u64) -> bool {
        // The value of an earlier measurement is final.
        let is_final = self.read >> index & 1 == 1 || self.stamp != Some(measured_at);
        let is_current = is_final || self.revision == Some(revision);
        self.readings
            .get(index)
            .is_some_and(|it| it.measured_at == Some(measured_at) && (it.value.is_none() || !is_current))
    }

    /// Computes the missing values of those of `sensors` that measured at `measured_at`.
    fn measure(&mut self, sensors: SensorSet, measured_at: Time, revision: u64, measure: impl Measure) {
        let is_missing = |index: &usize| self.is_missing(*index, measured_at, revision);
        let missing = members(sensors).filter(is_missing).fold(0, |set, index| set | 1 << index);
        self.revision = Some(revision);
        if missing != 0 {
            measure(missing, measured_at, &mut |index, reading| self.readings[index].value = Some(reading));
        }
    }

    /// Drops the values that the program has not read yet; the first read computes them again. Must be called if
    /// sensors or their errors change.
    pub fn forget_unread(&mut self) {
        self.revision = None;
    }

    /// Addresses of the heap memory that [`Psds::read`] touches.
    pub(crate) fn hot_memory(&self) -> Range<*const u8> {
        let Range { start, end } = self.readings.as_ptr_range();
        start.cast()..end.cast()
    }

    /// End of the measurement in progress; [`Time::NEVER`] if there is none or it is continuous.
    /// [`settle`](Self::settle) must be called at this time, because the world keeps only a short history.
    #[inline]
    pub fn due(&self) -> Time {
        self.measurement.map_or(Time::NEVER, |measurement| measurement.cycle.last_end())
    }

    /// Computes the values of a measurement that ended by `now`.
    pub fn settle(&mut self, now: Time, revision: u64, measure: impl Measure) {
        if now < self.due() {
            return;
        }
        let Some(Measurement { sensors, .. }) = self.measurement else { return };
        self.advance(now);
        if let Some(measured_at) = self.stamp {
            self.measure(sensors, measured_at, revision, measure);
            self.read |= sensors;
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
            self.expected = std::mem::take(&mut self.read);
            for index in members(sensors) {
                self.readings[index] = Latest { measured_at: Some(measured_at), value: None };
            }
        }
        if cycle.is_over(now) {
            self.measurement = None;
        }
    }
}

/// Computes the readings of a set of sensors at an instant, and passes each with its sensor to the given function.
pub trait Measure: FnOnce(SensorSet, Time, &mut dyn FnMut(usize, Reading)) {}

impl<F: FnOnce(SensorSet, Time, &mut dyn FnMut(usize, Reading))> Measure for F {}

/// The sensors of a set, in order.
pub(crate) fn members(sensors: SensorSet) -> impl Iterator<Item = usize> + Clone {
    let next = |rest: &SensorSet| (*rest != 0).then_some(*rest);
    successors(next(&sensors), move |rest| next(&(rest & (rest - 1)))).map(|rest| rest.trailing_zeros() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Measures in a world in which sensor i reads i metres plus one metre per second of virtual time.
    fn measure(sensors: SensorSet, at: Time, store: &mut dyn FnMut(usize, Reading)) {
        let reading = |index| Reading { distance: Some(index as f64 + at.seconds()), signal: 1.0 };
        members(sensors).for_each(|index| store(index, reading(index)));
    }

    /// Fails the test if a value has to be computed.
    fn unexpected(_: SensorSet, _: Time, _: &mut dyn FnMut(usize, Reading)) {
        panic!("the value is known");
    }

    fn measured(measured_at: Time, metres: f64) -> Option<Measured> {
        Some(Measured { measured_at, reading: Reading { distance: Some(metres), signal: 1.0 } })
    }

    #[test]
    fn a_value_is_measured_at_the_end_of_its_cycle() {
        let mut psds = Psds::default();
        assert!(psds.start(0b101, true, Time(1_000)));
        assert_eq!(psds.read(0, Time(60_999), 5, measure), None);
        assert_eq!(psds.stamp(Time(60_999)), None);
        let first = psds.read(2, Time(61_000), 5, measure);
        assert_eq!(first, measured(Time(61_000), 2.061));
        let later = psds.read(2, Time(120_999), 5, unexpected);
        assert_eq!(later, first);
        assert_eq!(psds.read(2, Time(121_000), 5, measure).unwrap().measured_at, Time(121_000));
        assert_eq!(psds.read(1, Time(121_000), 5, measure), None, "not started");
        assert_eq!(psds.due(), Time::NEVER);
    }

    #[test]
    fn sensors_that_were_read_in_the_last_cycle_measure_together() {
        let mut psds = Psds::default();
        psds.start(0b111, true, Time(0));
        let revision = 5;
        let sets = |psds: &mut Psds, index, now| {
            let mut set = 0;
            let found = psds.read(index, now, revision, |sensors, at, store| {
                set = sensors;
                measure(sensors, at, store);
            });
            (set, found)
        };
        assert_eq!(sets(&mut psds, 0, Time(60_000)), (0b001, measured(Time(60_000), 0.06)));
        assert_eq!(sets(&mut psds, 2, Time(60_000)), (0b100, measured(Time(60_000), 2.06)));
        assert_eq!(sets(&mut psds, 2, Time(120_000)), (0b101, measured(Time(120_000), 2.12)));
        assert_eq!(psds.read(0, Time(120_001), 5, unexpected), measured(Time(120_000), 0.12));
        assert_eq!(sets(&mut psds, 2, Time(180_000)), (0b101, measured(Time(180_000), 2.18)));
        psds.forget_unread();
        assert_eq!(psds.read(2, Time(180_001), 5, unexpected), measured(Time(180_000), 2.18));
        assert_eq!(sets(&mut psds, 0, Time(180_001)), (0b001, measured(Time(180_000), 0.18)));
        assert_eq!(sets(&mut psds, 2, Time(240_000)), (0b101, measured(Time(240_000), 2.24)));
        assert_eq!(
            psds.read(2, Time(250_000), 6, unexpected),
            measured(Time(240_000), 2.24),
            "a value that was read stays"
        );
        let moved = |sensors: SensorSet, _: Time, store: &mut dyn FnMut(usize, Reading)| {
            assert_eq!(sensors, 0b001, "only the value that was not read is computed with the changed motion");
            store(0, Reading { distance: None, signal: 0.0 });
        };
        assert_eq!(psds.read(0, Time(250_000), 6, moved).unwrap().reading.distance, None);
    }

    #[test]
    fn a_single_measurement_is_kept_until_the_next() {
        let mut psds = Psds::default();
        psds.start(1, false, Time(0));
        assert_eq!(psds.due(), Time(60_000));
        assert!(!psds.start(1, false, Time(59_999)));
        psds.settle(Time(60_000), 5, measure);
        assert_eq!(psds.due(), Time::NEVER);
        let reading = measured(Time(60_000), 0.06);
        assert_eq!(psds.read(0, Time(9_000_000), 5, unexpected), reading);
        assert!(psds.start(1, true, Time(9_000_000)));
        assert_eq!(psds.stamp(Time(9_000_001)), None, "nothing new is valid yet");
        assert_eq!(psds.read(0, Time(9_000_001), 5, measure), reading, "the old value stays");
    }

    #[test]
    fn a_value_of_an_earlier_measurement_stays() {
        let mut psds = Psds::default();
        psds.start(0b01, false, Time(0));
        psds.settle(Time(60_000), 5, measure);
        let reading = psds.read(0, Time(60_000), 5, unexpected);
        psds.start(0b10, true, Time(100_000));
        assert_eq!(psds.read(1, Time(160_000), 6, measure), measured(Time(160_000), 1.16));
        assert_eq!(psds.read(1, Time(220_000), 6, measure), measured(Time(220_000), 1.22));
        psds.forget_unread();
        assert_eq!(psds.read(0, Time(230_000), 7, unexpected), reading);
    }

    #[test]
    fn stop_completes_the_cycle_in_progress() {
        let mut psds = Psds::default();
        psds.start(1, true, Time(0));
        psds.stop(Time(130_000));
        assert!(!psds.start(1, true, Time(179_999)));
        assert!(psds.start(1, true, Time(180_000)));
        assert_eq!(psds.read(0, Time(180_000), 5, measure).unwrap().measured_at, Time(180_000));
    }
}
