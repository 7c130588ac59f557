//! `imperfect-motion`: a minute of driving with wheel lag, unequal wheels, slip and noise, compared with a reference in
//! double-double arithmetic.
//!
//! The reference draws the same random numbers as the simulator for each tick of 10 ms, and computes lag, wheel speeds
//! and arcs with its own formulas. It shares only the random streams and `math::hypot` with the simulator.

use std::sync::Arc;

use sim_core::RobotId;
use sim_core::drive::{Command, Imperfection, Model, Motion};
use sim_core::math;
use sim_core::noise::{EventStreams, Purpose, TwistNoise};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Walls;
use sim_core::time::{TICK, Time};
use sim_core::world::World;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::course::{EndPose, model};
use crate::wide::Wide;

pub const STUDY: Study =
    Study { name: "imperfect-motion", title: "Position after a minute of driving with wheel lag and noise", run };

/// Duration of the drive.
const DURATION: Time = Time::from_millis(60_000);
const SEED: u64 = 2718;
const ROBOT: RobotId = RobotId(1);
/// Speeds (m/s) and turning speeds (rad/s) of the commands, which cycle through this list.
const TWISTS: [(f64, f64); 5] = [(0.3, 0.0), (0.2, 0.9), (-0.1, -0.4), (0.25, -0.7), (0.0, 1.1)];
/// Time of the first command; no command is at a tick.
const FIRST_COMMAND: Time = Time(3_217);
/// Time between commands.
const COMMAND_INTERVAL: Time = Time(1_303_331);
/// Lengths of slots and steps.
const LENGTHS: [Time; 4] = [Time(100), Time(1_000), Time(10_000), Time(50_000)];

/// Name of the last case, which has all errors.
const ALL_ERRORS: &str = "lag and noise";

/// A robot with lag and a noise model of its drive.
struct Case {
    name: &'static str,
    lag: f64,
    imperfection: Imperfection,
}

fn cases() -> Vec<Case> {
    let wheels = Imperfection { diameters: [0.004, -0.003, 0.0, 0.0], slip: 0.02, ..Imperfection::default() };
    let noise = TwistNoise { speed: 0.01, speed_share: 0.1, turn: 0.05, turn_share: 0.1 };
    let random = Imperfection { slip_deviation: 0.05, command: noise, odometry: noise, ..wheels };
    let case = |name, lag, imperfection| Case { name, lag, imperfection };
    vec![
        case("lag", 0.08, Imperfection::default()),
        case("unequal wheels that slip", 0.0, wheels),
        case("noise", 0.0, random),
        case(ALL_ERRORS, 0.08, random),
    ]
}

/// A time interval with a constant speed (m/s) and turning speed (rad/s), true and by odometry.
struct Interval {
    seconds: f64,
    truth: [Wide; 2],
    odometry: [Wide; 2],
}

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    for case in cases() {
        let ends = ends(&case.intervals());
        let lengths = if case.name == ALL_ERRORS { &LENGTHS[..] } else { &LENGTHS[3..] };
        for length in lengths {
            let error = case.error(&ends, *length);
            let time_ns = nanoseconds(effort.of(10), 1, || case.simulate(*length).0) / DURATION.seconds();
            rows.push(row(case.name, format!("slots of {}", duration(*length)), error, time_ns));
        }
    }
    let last_case = cases().pop().expect("there are cases");
    let intervals = last_case.intervals();
    let [truth, _] = ends(&intervals);
    for (name, is_euler) in [("Euler", true), ("Runge-Kutta", false)] {
        for step in &LENGTHS[..3] {
            let found = integrate(&intervals, step.seconds(), is_euler);
            let time_ns =
                nanoseconds(effort.of(10), 1, || integrate(&intervals, step.seconds(), is_euler)) / DURATION.seconds();
            let setting = format!("steps of {}", duration(*step));
            rows.push(row(&format!("{name}, {}", last_case.name), setting, truth.distance(&found), time_ns));
        }
    }
    rows.into()
}

fn row(method: &str, setting: String, error: f64, time_ns: f64) -> Row {
    let (unit, per) = ("m", "simulated second");
    Row { study: STUDY.name, method: method.to_owned(), setting, error, unit, time_ns, per }
}

fn duration(length: Time) -> String {
    if length.0 % 1_000 == 0 { format!("{} ms", length.0 / 1_000) } else { format!("{} us", length.0) }
}

fn commands() -> impl Iterator<Item = (Time, Twist)> {
    let twists = TWISTS.iter().cycle().map(|(v, w)| Twist::new(*v, *w));
    (0..)
        .map(|index| Time(FIRST_COMMAND.0 + index * COMMAND_INTERVAL.0))
        .zip(twists)
        .take_while(|(at, _)| *at < DURATION)
}

impl Case {
    fn model(&self) -> Model {
        Model { axis_offset: 0.0, wheel_lag: self.lag, ..model() }
    }

    /// Error of the simulator's final pose or of its odometry, whichever is larger, m.
    fn error(&self, [truth, odometry]: &[EndPose; 2], slot: Time) -> f64 {
        let (pose, found_odometry) = self.simulate(slot);
        truth.distance(&pose).max(odometry.distance(&found_odometry))
    }

    /// True pose and odometry at the end, by the simulator.
    fn simulate(&self, slot: Time) -> (Pose, Pose) {
        let walls = Arc::new(Walls::new(Vec::new()));
        let mut motion = Motion::new(ROBOT, Arc::new(self.model()), Arc::clone(&walls), Pose::default())
            .with_imperfection(SEED, self.imperfection)
            .expect("errors within their ranges");
        let mut world = World::new(walls, slot, [&mut motion]);
        let mut commands = commands().peekable();
        while world.slot_start() < DURATION {
            let end = world.slot_end();
            while let Some((at, twist)) = commands.next_if(|(at, _)| *at < end) {
                motion.command(at, Command::Twist(twist), &[]).expect("a twist within the limits");
            }
            world.advance(&mut [&mut motion]);
        }
        (motion.pose(DURATION), motion.odometry(DURATION))
    }

    /// Intervals of constant speed of the whole drive, by the reference.
    fn intervals(&self) -> Vec<Interval> {
        let model = self.model();
        let (radius, track) = (Wide::from(0.5) * Wide::from(model.wheel_diameter), Wide::from(model.track));
        let one_half = Wide::from(0.5);
        let lag_factor = if self.lag > 0.0 { exp(-(Wide::from(0.01) / Wide::from(self.lag))) } else { Wide::default() };
        let Imperfection { diameters, slip, slip_deviation, command, odometry, .. } = self.imperfection;
        let streams = |purpose, name| EventStreams::new(SEED, ROBOT, purpose, name);
        let slip_streams = streams(Purpose::Command, "slip");
        let (command_streams, odometry_streams) = (streams(Purpose::Command, ""), streams(Purpose::Odometry, ""));
        let mut commands = commands().peekable();
        let (mut commanded_rates, mut rates) = ([Wide::default(); 2], [Wide::default(); 2]);
        let mut intervals = Vec::new();
        let mut now = Time::ZERO;
        while now < DURATION {
            if self.lag > 0.0 && now.0 % TICK.0 == 0 {
                rates = std::array::from_fn(|side| {
                    commanded_rates[side] + lag_factor * (rates[side] - commanded_rates[side])
                });
            }
            if let Some((_, twist)) = commands.next_if(|(at, _)| *at == now) {
                let (v, turn) = (Wide::from(twist.vx), one_half * track * Wide::from(twist.omega));
                commanded_rates = [(v - turn) / radius, (v + turn) / radius];
                if self.lag == 0.0 {
                    rates = commanded_rates;
                }
            }
            let next_tick = Time((now.0 / TICK.0 + 1) * TICK.0);
            let next = commands.peek().map_or(next_tick, |(at, _)| next_tick.min(*at)).min(DURATION);
            let twist =
                |[left, right]: [Wide; 2]| [one_half * radius * (left + right), radius * (right - left) / track];
            let tick = (now.0 / TICK.0) as u64;
            let mut stream = slip_streams.at(tick);
            let ground = std::array::from_fn(|side| {
                let random_slip = if slip_deviation > 0.0 { slip_deviation * stream.normal() } else { 0.0 };
                let one = Wide::from(1.0);
                rates[side] * (one + Wide::from(diameters[side])) * (one - (Wide::from(slip) + Wide::from(random_slip)))
            });
            let nominal = twist(rates);
            let is_moving = nominal.iter().any(|part| part.rounded() != 0.0);
            let with_noise = |base: [Wide; 2], noise: &TwistNoise, streams: &EventStreams| {
                let mut stream = streams.at(tick);
                // The random number for the sideways speed is drawn but not used.
                let [speed_draw, _, turn_draw] = [(); 3].map(|()| stream.normal());
                let [v, w] = nominal.map(Wide::rounded);
                let errors = [
                    math::hypot(noise.speed, noise.speed_share * v) * speed_draw,
                    math::hypot(noise.turn, noise.turn_share * w) * turn_draw,
                ];
                if is_moving { [0, 1].map(|part| base[part] + Wide::from(errors[part])) } else { base }
            };
            intervals.push(Interval {
                seconds: (next - now).seconds(),
                truth: with_noise(twist(ground), &command, &command_streams),
                odometry: with_noise(nominal, &odometry, &odometry_streams),
            });
            now = next;
        }
        intervals
    }
}

/// End poses of the robot and of its odometry, computed with 30 digits from the arcs of all intervals.
fn ends(intervals: &[Interval]) -> [EndPose; 2] {
    let mut ends = [EndPose::default(); 2];
    for interval in intervals {
        // Durations are whole microseconds; the rounding restores their exact number.
        let seconds = Wide::from((interval.seconds * 1e6).round()) / Wide::from(1e6);
        for (end, [v, w]) in ends.iter_mut().zip([interval.truth, interval.odometry]) {
            let (sin, cos) = end.heading.sin_cos();
            let angle = w * seconds;
            end.heading = end.heading + angle;
            let (x, y) = if w.rounded() == 0.0 {
                (cos, sin)
            } else {
                let (sin_end, cos_end) = end.heading.sin_cos();
                ((sin_end - sin) / angle, (cos - cos_end) / angle)
            };
            end.x = end.x + v * seconds * x;
            end.y = end.y + v * seconds * y;
        }
    }
    ends
}

/// End pose of the robot by Euler's method or the Runge-Kutta method, in steps of at most `step` s.
fn integrate(intervals: &[Interval], step: f64, is_euler: bool) -> Pose {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for interval in intervals {
        let [v, w] = interval.truth.map(Wide::rounded);
        let steps = (interval.seconds / step - 1e-9).ceil().max(1.0);
        let step = interval.seconds / steps;
        for _ in 0..steps as u64 {
            let (sin, cos) = math::sin_cos(heading);
            let next = heading + w * step;
            let (dx, dy) = if is_euler {
                (cos, sin)
            } else {
                let (sin_middle, cos_middle) = math::sin_cos(heading + 0.5 * w * step);
                let (sin_end, cos_end) = math::sin_cos(next);
                ((cos + 4.0 * cos_middle + cos_end) / 6.0, (sin + 4.0 * sin_middle + sin_end) / 6.0)
            };
            x += v * step * dx;
            y += v * step * dy;
            heading = next;
        }
    }
    Pose::new(x, y, heading)
}

/// Exponential function of a number between -1 and 0, by its power series.
fn exp(x: Wide) -> Wide {
    let one = Wide::from(1.0);
    (1..=30).rev().fold(one, |sum, power| one + x * sum / Wide::from(f64::from(power)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_matches_published_values() {
        assert!((exp(Wide::from(-1.0)).rounded() - 0.367_879_441_171_442_33).abs() < 1e-16);
        assert_eq!(exp(Wide::default()).rounded(), 1.0);
    }

    #[test]
    fn core_matches_the_reference_for_any_slot_length() {
        for case in cases() {
            let ends = ends(&case.intervals());
            let (pose, found_odometry) = case.simulate(LENGTHS[3]);
            // The tolerance covers the rounding errors of 6,000 ticks.
            let error = case.error(&ends, LENGTHS[3]);
            assert!(error < 1e-12, "{}: {error}", case.name);
            assert!(
                ends[0].distance(&found_odometry) > 0.1 || case.name == "lag",
                "{}: errors have no effect",
                case.name
            );
            assert_eq!(case.simulate(LENGTHS[1]), (pose, found_odometry), "{}", case.name);
        }
    }
}
