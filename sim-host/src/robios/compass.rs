//! The compass: degrees clockwise from north, measured in cycles of 100 ms.
//!
//! Source: RoBIOS 6 library, compass; the length of a cycle and the direction of north (along the world's y axis where the
//! robi's companion does not say) are our choice, the sense of rotation is that of every compass.

use robios_sys::Robios6Call as Call;
use robios_sys::robios6::hdt_type::HDT_COMPASS;
use sim_core::drive::Motion;
use sim_core::noise::{AngleErrors, Events};
use sim_core::pose::Heading;
use sim_core::spec::CompassSpec;
use sim_core::time::Time;
use sim_core::unit;

use super::cycle::Cycle;
use super::robot::Robot;
use super::switch::Sensor;
use sim_core::record::Event;

/// Length of a measuring cycle.
pub const CYCLE: Time = Time::from_millis(100);

/// The compass of a robot.
#[derive(Clone, Debug, Default)]
pub struct Compass {
    /// True between `COMPASSInit` and `COMPASSRelease`.
    pub is_open: bool,
    cycle: Option<Cycle>,
    taken: Option<Time>,
    /// Degrees measured at `taken`, once computed.
    degrees: Option<i32>,
    /// `None` where it is exact.
    pub errors: Option<AngleErrors>,
}

impl Compass {
    /// Starts measuring at `now`, once or in cycles without end; false if it is already measuring or not open.
    pub fn start(&mut self, is_continuous: bool, now: Time) -> bool {
        self.advance(now);
        let can_start = self.is_open && self.cycle.is_none();
        if can_start {
            (self.taken, self.degrees) = (None, None);
            self.cycle = Some(Cycle::new(now, CYCLE, is_continuous));
        }
        can_start
    }

    /// Ends the measurement with the cycle in progress.
    pub fn stop(&mut self, now: Time) {
        self.advance(now);
        if let Some(cycle) = &mut self.cycle {
            cycle.stop(now);
        }
    }

    /// True if a cycle has been completed since the last start.
    pub fn is_valid(&mut self, now: Time) -> bool {
        self.advance(now);
        self.taken.is_some()
    }

    /// The latest value in degrees, `None` before the end of the first cycle. `measure` gives the value at an instant.
    pub fn read(&mut self, now: Time, measure: impl FnOnce(Time) -> i32) -> Option<i32> {
        self.advance(now);
        let taken = self.taken?;
        Some(*self.degrees.get_or_insert_with(|| measure(taken)))
    }

    /// When the measurement ends that is not without end, see [`super::psd::Psds::due`].
    pub fn due(&self) -> Time {
        self.cycle.map_or(Time::NEVER, |cycle| cycle.last_end())
    }

    fn advance(&mut self, now: Time) {
        let Some(cycle) = self.cycle else { return };
        let Some(taken) = cycle.latest(now) else { return };
        if self.taken != Some(taken) {
            (self.taken, self.degrees) = (Some(taken), None);
        }
        if cycle.is_over(now) {
            self.cycle = None;
        }
    }
}

/// `COMPASSInit`
pub fn init(robot: &mut Robot, semantics: i32) -> i32 {
    if robot.devices.table.find(HDT_COMPASS, semantics).is_none() {
        return robot.has_no(Call::COMPASSInit, 1, HDT_COMPASS, semantics);
    }
    robot.devices.compass.is_open = true;
    0
}

/// `COMPASSStart`
pub fn start(robot: &mut Robot, is_continuous: bool) -> i32 {
    if robot.devices.compass.start(is_continuous, robot.now) { 0 } else { robot.failed(Call::COMPASSStart, 1) }
}

/// `COMPASSCheck`
pub fn check(robot: &mut Robot) -> i32 {
    let is_on = robot.devices.switches.is_on(Sensor::Compass);
    (robot.devices.compass.is_valid(robot.now) && is_on).into()
}

/// `COMPASSStop`
pub fn stop(robot: &mut Robot) -> i32 {
    robot.devices.compass.stop(robot.now);
    if robot.devices.compass.is_open { 0 } else { robot.failed(Call::COMPASSStop, 1) }
}

/// `COMPASSRelease`
pub fn release(robot: &mut Robot) -> i32 {
    let compass = &mut robot.devices.compass;
    let (was_open, errors) = (compass.is_open, compass.errors.take());
    *compass = Compass { errors, ..Compass::default() };
    if was_open { 0 } else { robot.failed(Call::COMPASSRelease, 1) }
}

/// `COMPASSCalibrate`: the simulated compass needs none.
pub fn calibrate(robot: &mut Robot) -> i32 {
    if robot.devices.compass.is_open { 0 } else { robot.failed(Call::COMPASSCalibrate, 1) }
}

/// `COMPASSGet`
pub fn get(robot: &mut Robot) -> i32 {
    let degrees = read(robot);
    if let Some(compass) = &robot.spec.compass {
        let angle_rad = degrees.map(|degrees| unit::radians_from_degrees(degrees.into()));
        robot.journal.record(robot.now, &Event::Angle { device: &compass.name, angle_rad });
    }
    degrees.unwrap_or_else(|| robot.failed(Call::COMPASSGet, -1))
}

/// Computes the value of a measurement that has just ended, before the world forgets how the robot stood.
pub fn settle(robot: &mut Robot) {
    if robot.now >= robot.devices.compass.due() {
        read(robot);
    }
}

fn read(robot: &mut Robot) -> Option<i32> {
    let Robot { now, motion, spec, devices, .. } = robot;
    let is_on = devices.switches.is_on(Sensor::Compass);
    let compass = &mut devices.compass;
    let errors = compass.errors.clone();
    let degrees = compass.read(*now, |at| measure(spec.compass.as_ref(), motion, at, errors.as_ref()));
    degrees.filter(|_| is_on)
}

fn measure(compass: Option<&CompassSpec>, motion: &mut Motion, at: Time, errors: Option<&AngleErrors>) -> i32 {
    let Some(compass) = compass else { return 0 };
    let exact = angle_from_heading(motion.pose(at).heading, compass.north);
    whole_degrees(errors.map_or(exact, |errors| errors.reading(Events::index(at, CYCLE), exact)))
}

/// Angle of a robot of this heading clockwise from `north` (a world direction in radians, counter-clockwise from x).
fn angle_from_heading(heading: Heading, north: f64) -> f64 {
    Heading::new(north).remainder() - heading.remainder()
}

/// What a compass tells of an angle: whole degrees, 0 to 359.
fn whole_degrees(angle: f64) -> i32 {
    (unit::degrees_from_radians(angle).round() as i32).rem_euclid(360)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn degrees_run_clockwise_from_north() {
        let reading = |heading: f64| whole_degrees(angle_from_heading(Heading::new(heading), PI / 2.0));
        assert_eq!([PI / 2.0, 0.0, -PI / 2.0, PI].map(reading), [0, 90, 180, 270]);
        assert_eq!(reading(PI / 2.0 + 0.001), 0, "359.94 rounds to 0, not to 360");
    }

    #[test]
    fn a_value_needs_a_cycle() {
        let mut compass = Compass { is_open: true, ..Compass::default() };
        assert!(compass.start(true, Time(0)));
        assert!(!compass.start(true, Time(10)), "already measuring");
        assert_eq!(compass.read(Time(99_999), |_| 1), None);
        assert_eq!(compass.read(Time(250_000), |at| at.0 as i32), Some(200_000));
        compass.stop(Time(250_000));
        assert_eq!(compass.due(), Time(300_000));
        assert_eq!(compass.read(Time(900_000), |at| at.0 as i32), Some(300_000));
        assert!(compass.start(false, Time(900_000)) && !compass.is_valid(Time(999_999)));
        assert!(!Compass::default().start(true, Time(0)), "not open");
    }
}
