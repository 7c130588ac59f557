//! The compass: the direction clockwise from north, measured in cycles of 100 ms.
//!
//! Source: RoBIOS 6 library, compass. The length of a cycle is our choice. North is the world's y axis (our choice),
//! unless the companion of the robi states another direction.

use super::cycle::Cycle;
use crate::drive::Motion;
use crate::noise::{CompassErrors, EventStreams};
use crate::pose::Heading;
use crate::spec::CompassSpec;
use crate::time::Time;

/// Length of a measuring cycle.
pub const CYCLE: Time = Time::from_millis(100);

/// The compass of a robot.
#[derive(Clone, Debug, Default)]
pub struct Compass {
    cycle: Option<Cycle>,
    measured_at: Option<Time>,
    /// Angle measured at `measured_at`, once computed.
    angle: Option<f64>,
    /// `None` if the compass is exact.
    pub errors: Option<CompassErrors>,
}

impl Compass {
    /// Starts measuring at `now`, for one cycle or continuously; returns false if the compass is already measuring.
    pub fn start(&mut self, is_continuous: bool, now: Time) -> bool {
        self.advance(now);
        let can_start = self.cycle.is_none();
        if can_start {
            (self.measured_at, self.angle) = (None, None);
            self.cycle = Some(Cycle::new(now, CYCLE, is_continuous));
        }
        can_start
    }

    /// Stops measuring at the end of the cycle in progress.
    pub fn stop(&mut self, now: Time) {
        self.advance(now);
        if let Some(cycle) = &mut self.cycle {
            cycle.stop(now);
        }
    }

    /// Returns true if a cycle has been completed since the last start.
    pub fn is_valid(&mut self, now: Time) -> bool {
        self.advance(now);
        self.measured_at.is_some()
    }

    /// The latest value, rad clockwise from north; `None` before the end of the first cycle. `measure` computes the
    /// value at an instant.
    pub fn read(&mut self, now: Time, measure: impl FnOnce(Time) -> f64) -> Option<f64> {
        self.advance(now);
        let measured_at = self.measured_at?;
        Some(*self.angle.get_or_insert_with(|| measure(measured_at)))
    }

    /// End of the measurement in progress; [`Time::NEVER`] if there is none or it is continuous. See
    /// [`super::psd::Psds::due`].
    #[inline]
    pub fn due(&self) -> Time {
        self.cycle.map_or(Time::NEVER, |cycle| cycle.last_end())
    }

    /// Discards all measurements, but not the noise model.
    pub fn reset(&mut self) {
        *self = Self { errors: self.errors.take(), ..Self::default() };
    }

    fn advance(&mut self, now: Time) {
        let Some(cycle) = self.cycle else { return };
        let Some(measured_at) = cycle.latest_end(now) else { return };
        if self.measured_at != Some(measured_at) {
            (self.measured_at, self.angle) = (Some(measured_at), None);
        }
        if cycle.is_over(now) {
            self.cycle = None;
        }
    }
}

/// Reading of the compass at `at`, rad clockwise from north, not wrapped; 0 for a robot without a compass.
pub fn measure(compass: Option<&CompassSpec>, motion: &mut Motion, at: Time, errors: Option<&CompassErrors>) -> f64 {
    let Some(compass) = compass else { return 0.0 };
    let exact = angle_from_heading(motion.pose(at).heading, compass.north);
    errors.map_or(exact, |errors| errors.reading(EventStreams::index(at, CYCLE), exact))
}

/// Clockwise angle in rad from `north` to the heading; `north` is a world direction, rad counter-clockwise from x.
fn angle_from_heading(heading: Heading, north: f64) -> f64 {
    Heading::new(north).remainder() - heading.remainder()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn angles_run_clockwise_from_north() {
        let reading = |heading: f64| angle_from_heading(Heading::new(heading), PI / 2.0);
        assert_eq!([PI / 2.0, 0.0, -PI / 2.0].map(reading), [0.0, PI / 2.0, PI]);
    }

    #[test]
    fn a_value_exists_after_a_complete_cycle() {
        let mut compass = Compass::default();
        assert!(compass.start(true, Time(0)));
        assert!(!compass.start(true, Time(10)), "already measuring");
        assert_eq!(compass.read(Time(99_999), |_| 1.0), None);
        assert_eq!(compass.read(Time(250_000), |at| at.seconds()), Some(0.2));
        compass.stop(Time(250_000));
        assert_eq!(compass.due(), Time(300_000));
        assert_eq!(compass.read(Time(900_000), |at| at.seconds()), Some(0.3));
        assert!(compass.start(false, Time(900_000)) && !compass.is_valid(Time(999_999)));
    }
}
