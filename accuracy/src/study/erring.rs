//! `erring`: a minute of driving with wheel lag, unequal wheels, slip and noise, against a reference in double-double numbers.
//!
//! The reference draws the same random numbers for each tick of 10 ms and computes lag, wheels and arcs with its own formulas. It shares
//! only the random streams with the simulator.

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
use crate::course::{End, model};
use crate::wide::Wide;

pub const STUDY: Study =
    Study { name: "erring", title: "Position after a minute of driving with wheel lag and noise", run };

const SPAN: Time = Time::from_millis(60_000);
const SEED: u64 = 2718;
const ME: RobotId = RobotId(1);
/// Speed and turning speed of the commands, in turn.
const TWISTS: [(f64, f64); 5] = [(0.3, 0.0), (0.2, 0.9), (-0.1, -0.4), (0.25, -0.7), (0.0, 1.1)];
/// First command and time between commands: no command is given at a tick.
const FIRST: Time = Time(3_217);
const BETWEEN: Time = Time(1_303_331);
/// Slots and steps.
const LENGTHS: [Time; 4] = [Time(100), Time(1_000), Time(10_000), Time(50_000)];

/// The case of all errors together, the last one.
const ALL_ERRORS: &str = "lag and noise";

/// A robot with errors.
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

/// Constant twists from one instant to the next, of the body and of its odometry: speed and turning speed.
struct Stretch {
    seconds: f64,
    truth: [Wide; 2],
    odometry: [Wide; 2],
}

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    for case in cases() {
        let ends = ends(&case.stretches());
        let lengths = if case.name == ALL_ERRORS { &LENGTHS[..] } else { &LENGTHS[3..] };
        for length in lengths {
            let error = case.error(&ends, *length);
            let time_ns = nanoseconds(effort.of(10), 1, || case.by_core(*length).0) / SPAN.seconds();
            rows.push(row(case.name, format!("slots of {}", duration(*length)), error, time_ns));
        }
    }
    let all = cases().pop().expect("there are cases");
    let stretches = all.stretches();
    let [truth, _] = ends(&stretches);
    for (name, is_euler) in [("Euler", true), ("Runge-Kutta", false)] {
        for step in &LENGTHS[..3] {
            let found = integrate(&stretches, step.seconds(), is_euler);
            let time_ns =
                nanoseconds(effort.of(10), 1, || integrate(&stretches, step.seconds(), is_euler)) / SPAN.seconds();
            let setting = format!("steps of {}", duration(*step));
            rows.push(row(&format!("{name}, {}", all.name), setting, truth.distance(&found), time_ns));
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
    (0..).map(|index| Time(FIRST.0 + index * BETWEEN.0)).zip(twists).take_while(|(at, _)| *at < SPAN)
}

impl Case {
    fn model(&self) -> Model {
        Model { axis_offset: 0.0, wheel_lag: self.lag, ..model() }
    }

    /// Error of the simulator's final pose or of its odometry, whichever is larger, m.
    fn error(&self, [truth, odometry]: &[End; 2], slot: Time) -> f64 {
        let (pose, by_wheels) = self.by_core(slot);
        truth.distance(&pose).max(odometry.distance(&by_wheels))
    }

    /// True pose and odometry at the end, by the simulator.
    fn by_core(&self, slot: Time) -> (Pose, Pose) {
        let walls = Arc::new(Walls::new(Vec::new()));
        let mut motion = Motion::new(ME, Arc::new(self.model()), Arc::clone(&walls), Pose::default())
            .with_imperfection(SEED, self.imperfection)
            .expect("errors within their ranges");
        let mut world = World::new(walls, slot, [&mut motion]);
        let mut commands = commands().peekable();
        while world.slot_start() < SPAN {
            let end = world.slot_end();
            while let Some((at, twist)) = commands.next_if(|(at, _)| *at < end) {
                motion.command(at, Command::Twist(twist), &[]).expect("a twist within the limits");
            }
            world.advance(&mut [&mut motion]);
        }
        (motion.pose(SPAN), motion.odometry(SPAN))
    }

    /// The twists of the whole minute.
    fn stretches(&self) -> Vec<Stretch> {
        let model = self.model();
        let (radius, track) = (Wide::from(0.5) * Wide::from(model.wheel_diameter), Wide::from(model.track));
        let half = Wide::from(0.5);
        let kept = if self.lag > 0.0 { exp(-(Wide::from(0.01) / Wide::from(self.lag))) } else { Wide::default() };
        let Imperfection { diameters, slip, slip_deviation, command, odometry, .. } = self.imperfection;
        let events = |purpose, name| EventStreams::new(SEED, ME, purpose, name);
        let slips = events(Purpose::Command, "slip");
        let (of_command, of_odometry) = (events(Purpose::Command, ""), events(Purpose::Odometry, ""));
        let mut commands = commands().peekable();
        let (mut set, mut rates) = ([Wide::default(); 2], [Wide::default(); 2]);
        let mut stretches = Vec::new();
        let mut now = Time::ZERO;
        while now < SPAN {
            if self.lag > 0.0 && now.0 % TICK.0 == 0 {
                rates = std::array::from_fn(|side| set[side] + kept * (rates[side] - set[side]));
            }
            if let Some((_, twist)) = commands.next_if(|(at, _)| *at == now) {
                let (v, turn) = (Wide::from(twist.vx), half * track * Wide::from(twist.omega));
                set = [(v - turn) / radius, (v + turn) / radius];
                if self.lag == 0.0 {
                    rates = set;
                }
            }
            let next_tick = Time((now.0 / TICK.0 + 1) * TICK.0);
            let next = commands.peek().map_or(next_tick, |(at, _)| next_tick.min(*at)).min(SPAN);
            let twist = |[left, right]: [Wide; 2]| [half * radius * (left + right), radius * (right - left) / track];
            let tick = (now.0 / TICK.0) as u64;
            let mut stream = slips.at(tick);
            let ground = std::array::from_fn(|side| {
                let drawn = if slip_deviation > 0.0 { slip_deviation * stream.normal() } else { 0.0 };
                let one = Wide::from(1.0);
                rates[side] * (one + Wide::from(diameters[side])) * (one - (Wide::from(slip) + Wide::from(drawn)))
            });
            let believed = twist(rates);
            let moves = believed.iter().any(|part| part.rounded() != 0.0);
            let with = |base: [Wide; 2], noise: &TwistNoise, events: &EventStreams| {
                let mut stream = events.at(tick);
                // The number for the sideways speed is drawn and not used.
                let [ahead, _, round] = [(); 3].map(|()| stream.normal());
                let [v, w] = believed.map(Wide::rounded);
                let noises = [
                    math::hypot(noise.speed, noise.speed_share * v) * ahead,
                    math::hypot(noise.turn, noise.turn_share * w) * round,
                ];
                if moves { [0, 1].map(|part| base[part] + Wide::from(noises[part])) } else { base }
            };
            stretches.push(Stretch {
                seconds: (next - now).seconds(),
                truth: with(twist(ground), &command, &of_command),
                odometry: with(believed, &odometry, &of_odometry),
            });
            now = next;
        }
        stretches
    }
}

/// End poses of the body and of its odometry: the arc of each stretch with 30 digits.
fn ends(stretches: &[Stretch]) -> [End; 2] {
    let mut ends = [End::default(); 2];
    for stretch in stretches {
        // Whole microseconds, exactly.
        let seconds = Wide::from((stretch.seconds * 1e6).round()) / Wide::from(1e6);
        for (end, [v, w]) in ends.iter_mut().zip([stretch.truth, stretch.odometry]) {
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

/// End pose of the body by the methods of Euler or of Runge and Kutta in steps of at most `step` s.
fn integrate(stretches: &[Stretch], step: f64, is_euler: bool) -> Pose {
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for stretch in stretches {
        let [v, w] = stretch.truth.map(Wide::rounded);
        let steps = (stretch.seconds / step - 1e-9).ceil().max(1.0);
        let step = stretch.seconds / steps;
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

/// Exponential function of a number between -1 and 0, by its series.
fn exp(x: Wide) -> Wide {
    let one = Wide::from(1.0);
    (1..=30).rev().fold(one, |sum, power| one + x * sum / Wide::from(f64::from(power)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_that_of_the_textbook() {
        assert!((exp(Wide::from(-1.0)).rounded() - 0.367_879_441_171_442_33).abs() < 1e-16);
        assert_eq!(exp(Wide::default()).rounded(), 1.0);
    }

    #[test]
    fn erring_drives_end_where_the_reference_does_in_slots_of_any_length() {
        for case in cases() {
            let ends = ends(&case.stretches());
            let (pose, by_wheels) = case.by_core(LENGTHS[3]);
            // Rounding of 6,000 ticks.
            let error = case.error(&ends, LENGTHS[3]);
            assert!(error < 1e-12, "{}: {error}", case.name);
            assert!(ends[0].distance(&by_wheels) > 0.1 || case.name == "lag", "{}: errors have no effect", case.name);
            assert_eq!(case.by_core(LENGTHS[1]), (pose, by_wheels), "{}", case.name);
        }
    }
}
