//! `legs`: closure of the chains of legs, and slip of standing feet, over walks of the biped and of ALDURO.
//!
//! Trigonometry of our own computes each foot from the joint angles. Standing feet are compared with their footholds, with their
//! place at touch-down and with the floor, swinging feet with the path of the gait. Joint angles that are interpolated between samples
//! are the other method.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::drive::legged::{Foot, Gait, Leg, Legs, Stance};
use sim_core::drive::{Command, DriveKind, Model, Motion};
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Ground, Walls};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::course::model;
use crate::figure::{Figure, Mark, Scale, Series};

pub const STUDY: Study =
    Study { name: "legs", title: "Closure of leg chains and slip of standing feet over walks of 20 s", run };

/// Duration of a walk, s, and the interval of its postures.
const SECONDS: f64 = 20.0;
const POSTURE: Time = Time::from_millis(1);
/// Intervals of the samples between which joint angles are interpolated.
const SAMPLES: [Time; 5] =
    [Time::from_millis(2), Time::from_millis(5), Time::from_millis(10), Time::from_millis(20), Time::from_millis(50)];
/// Time between two commands of the walk with changes: it is no multiple of a gait's instants.
const CHANGE: Time = Time(1_234_567);

/// A robot with legs and its limits.
struct Walker {
    name: &'static str,
    legs: Arc<Legs>,
    /// Greatest speed, m/s, and turning speed, rad/s.
    limits: [f64; 2],
}

/// A walk: twists as shares of the limits, in turn.
type Course = &'static [[f64; 3]];

const AHEAD: Course = &[[0.9, 0.0, 0.0]];
const CURVE: Course = &[[0.5, 0.0, 0.4]];
const CHANGES: Course = &[[0.8, 0.0, 0.1], [0.2, -0.2, -0.5], [0.0, 0.0, 0.0], [-0.4, 0.1, 0.4], [0.5, 0.3, 0.0]];
/// Walks of the tables.
const COURSES: [(&str, Course); 6] = [
    ("ahead", AHEAD),
    ("backwards", &[[-0.5, 0.0, 0.0]]),
    ("sideways", &[[0.0, 0.4, 0.0]]),
    ("turn", &[[0.0, 0.0, 0.9]]),
    ("curve", CURVE),
    ("changes of the command", CHANGES),
];

/// Maximum errors of a walk, m.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    /// Distance of a standing foot's contact point, by its joint angles, from its foothold.
    closure: f64,
    /// Distance of a standing foot from where it touched down.
    slip: f64,
    /// Height of a standing foot's contact point above or below the floor, or depth of a heel, toe or tip in the floor.
    floor: f64,
    /// Distance of a swinging foot from the path of the gait.
    swing: f64,
}

/// Name of a measure, and the measure.
type Measure = (&'static str, fn(&Errors) -> f64);

impl Errors {
    /// Measures of the tables.
    const MEASURES: [Measure; 4] = [
        ("standing feet, from the foothold", |all| all.closure),
        ("standing feet, slip", |all| all.slip),
        ("feet and floor", |all| all.floor),
        ("swinging feet, from the gait's path", |all| all.swing),
    ];
}

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    for walker in [biped(), alduro()] {
        let all: Vec<Errors> = COURSES.iter().map(|(_, course)| walker.errors(course, None)).collect();
        let times: Vec<f64> = COURSES.iter().map(|(_, course)| walker.time(course, None, effort)).collect();
        for (measure, of) in Errors::MEASURES {
            for (((course, _), errors), time_ns) in COURSES.iter().zip(&all).zip(&times) {
                rows.push(row(format!("{}: {measure}", walker.name), (*course).to_owned(), of(errors), *time_ns));
            }
        }
        for sample in SAMPLES {
            let slip = walker.errors(CURVE, Some(sample)).slip;
            let setting = format!("curve, samples every {} ms", sample.0 / 1_000);
            let time_ns = walker.time(CURVE, Some(sample), effort);
            rows.push(row(format!("{}: interpolated angles, slip", walker.name), setting, slip, time_ns));
        }
        figures.push(heights(&walker));
    }
    Outcome { rows, figures }
}

fn row(method: String, setting: String, error: f64, time_ns: f64) -> Row {
    Row { study: STUDY.name, method, setting, error, unit: "m", time_ns, per: "posture" }
}

/// Gives the command, if any, of the last interval between postures before `at`.
fn command(course: Course, motion: &mut Motion, at: Time) {
    let (index, count) = (at.0.div_euclid(CHANGE.0), course.len() as i64);
    let is_due = at.0 - index * CHANGE.0 < POSTURE.0 && (index == 0 || count > 1);
    if is_due {
        let (speed, turn) = (motion.model().max_speed, motion.model().max_turn);
        let [ahead, aside, round] = course[(index % count) as usize];
        let twist = Twist { vx: ahead * speed, vy: aside * speed, omega: round * turn };
        motion.command(Time(index * CHANGE.0), Command::Twist(twist), &[]).expect("legs obey any twist");
    }
}

impl Walker {
    fn motion(&self) -> Motion {
        let [speed, turn] = self.limits;
        let model = Model {
            kind: DriveKind::Legged,
            axis_offset: 0.0,
            max_speed: speed.min(self.legs.max_speed(&self.legs.gaits[0])),
            max_turn: turn.min(self.legs.max_turn_rate(&self.legs.gaits[0])),
            ..model()
        };
        let walls = Arc::new(Walls::new(Vec::new()));
        Motion::new(RobotId(1), Arc::new(model), walls, Pose::new(1.0, -2.0, 0.7))
            .with_legs(Arc::clone(&self.legs), Arc::new(Ground::Flat))
    }

    /// Greatest errors of a walk, with the exact postures, or with joint angles interpolated between samples.
    fn errors(&self, course: Course, sample: Option<Time>) -> Errors {
        let mut motion = self.motion();
        let mut postures = Postures::new(sample);
        let mut errors = Errors::default();
        // Where the ankle was over the sole at touch-down, on the floor.
        let mut touched: Vec<Option<DVec3>> = vec![None; self.legs.legs.len()];
        for index in 0..(SECONDS / POSTURE.seconds()) as i64 {
            let at = Time(index * POSTURE.0);
            command(course, &mut motion, at);
            let pose = motion.pose(at);
            let exact = motion.stance(at);
            let (joints, lift) = postures.at(&mut motion, at, &exact);
            let mut first = 0;
            for ((leg, foot), touched) in self.legs.legs.iter().zip(&exact.feet).zip(&mut touched) {
                let angles = &joints[first..first + leg.joint_count()];
                first += leg.joint_count();
                let point_of = |ahead| in_world(&pose, lift, sole_point(leg, angles, ahead));
                let point = point_of(foot.sole.from_ankle);
                let off = (point - foot.point).length();
                let ends = leg.foot.map_or([0.0, 0.0], |foot| [-foot.heel, foot.toe]);
                errors.floor = ends.iter().fold(errors.floor, |depth, end| depth.max(-point_of(*end).z));
                if !foot.is_down {
                    errors.swing = errors.swing.max(off);
                    *touched = None;
                    continue;
                }
                errors.closure = errors.closure.max(off);
                errors.floor = errors.floor.max(point.z.abs());
                // The sole turns about its heel or toe in a vertical plane, of the direction of the yaw.
                let direction = DVec2::from_angle(pose.heading.radians() + angles[0]).extend(0.0);
                let place = point - foot.sole.from_ankle * direction;
                errors.slip = errors.slip.max((place - *touched.get_or_insert(place)).length());
            }
        }
        errors
    }

    /// Time of one posture in a walk, with the points of its feet, ns.
    fn time(&self, course: Course, sample: Option<Time>, effort: Effort) -> f64 {
        let count = (SECONDS / POSTURE.seconds()) as i64;
        let walk = || {
            let mut motion = self.motion();
            let mut postures = Postures::new(sample);
            let mut sum = 0.0;
            for index in 0..count {
                let at = Time(index * POSTURE.0);
                command(course, &mut motion, at);
                let joints = match sample {
                    None => motion.stance(at).joints,
                    Some(_) => postures.at(&mut motion, at, &Stance::default()).0,
                };
                sum += joints[0];
            }
            sum
        };
        nanoseconds(effort.of(10), count as usize, walk)
    }
}

/// Joint angles and lift: exact, or interpolated between samples.
struct Postures {
    every: Option<Time>,
    samples: Option<(i64, Stance, Stance)>,
}

impl Postures {
    fn new(every: Option<Time>) -> Self {
        Self { every, samples: None }
    }

    fn at(&mut self, motion: &mut Motion, at: Time, exact: &Stance) -> (Vec<f64>, f64) {
        let Some(every) = self.every else { return (exact.joints.clone(), exact.lift) };
        let index = at.0.div_euclid(every.0);
        if self.samples.as_ref().is_none_or(|(held, ..)| *held != index) {
            let mut stance = |index: i64| motion.stance(Time(index * every.0));
            let before = stance(index);
            self.samples = Some((index, before, stance(index + 1)));
        }
        let (_, before, after) = self.samples.as_ref().expect("samples have been taken");
        let share = (at.0 - index * every.0) as f64 / every.0 as f64;
        let between = |from: f64, to: f64| from + share * (to - from);
        let joints = before.joints.iter().zip(&after.joints).map(|(from, to)| between(*from, *to)).collect();
        (joints, between(before.lift, after.lift))
    }
}

/// Point of the sole `ahead` of the ankle, or the tip of a leg without a foot, in the robot's frame.
fn sole_point(leg: &Leg, angles: &[f64], ahead: f64) -> DVec3 {
    let (pitch, knee) = (angles[2], angles[3]);
    // In the plane of the leg: x ahead, y up.
    let hanging = |angle: f64| DVec2::new(math::sin(angle), -math::cos(angle));
    let mut point = hanging(pitch) * leg.thigh + hanging(pitch - knee) * leg.shank;
    if let Some(foot) = leg.foot {
        let tilt = pitch - knee + angles[4];
        point += DVec2::new(math::cos(tilt), math::sin(tilt)) * ahead + hanging(tilt) * foot.height;
    }
    let (sin_roll, cos_roll) = math::sin_cos(angles[1]);
    let (sin_yaw, cos_yaw) = math::sin_cos(angles[0]);
    let (x, y, z) = (point.x, -point.y * sin_roll, point.y * cos_roll);
    leg.hip + DVec3::new(cos_yaw * x - sin_yaw * y, sin_yaw * x + cos_yaw * y, z)
}

fn in_world(pose: &Pose, lift: f64, point: DVec3) -> DVec3 {
    pose.transform_point(point.truncate()).extend(point.z + lift)
}

/// Heights of the feet's points by joint angles over two periods of a steady walk.
fn heights(walker: &Walker) -> Figure {
    let mut motion = walker.motion();
    command(AHEAD, &mut motion, Time::ZERO);
    let period = walker.legs.gaits[0].period;
    let mut series: Vec<Series> = walker
        .legs
        .legs
        .iter()
        .map(|leg| Series { name: leg.name.to_lowercase().replace('_', " "), mark: Mark::Line, points: Vec::new() })
        .collect();
    for index in 0..=400 {
        let at = Time(2 * period.0 + index * period.0 / 200);
        let stance = motion.stance(at);
        let mut first = 0;
        for ((leg, foot), series) in walker.legs.legs.iter().zip(&stance.feet).zip(&mut series) {
            let point = sole_point(leg, &stance.joints[first..first + leg.joint_count()], foot.sole.from_ankle);
            first += leg.joint_count();
            series.points.push(((at.0 - 2 * period.0) as f64 / 1e6, point.z + stance.lift));
        }
    }
    Figure {
        name: format!("legs-{}", walker.name.to_lowercase()),
        title: format!("Heights of the feet's contact points, from joint angles: {}", walker.name),
        x_label: "time, s".to_owned(),
        y_label: "height above the floor, m".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    }
}

/// The biped of `robis/biped.toml`.
fn biped() -> Walker {
    let leg = |name: &str, y| Leg {
        name: name.to_owned(),
        hip: DVec3::new(0.0, y, 0.9),
        thigh: 0.429,
        shank: 0.43,
        foot: Some(Foot { heel: 0.055, toe: 0.16, height: 0.068 }),
        wheel: None,
    };
    let gait = Gait {
        name: "walk".to_owned(),
        period: Time::from_millis(1_100),
        duty: 0.6,
        offsets: vec![0.0, 0.5],
        is_natural: true,
    };
    let legs = vec![leg("LEFT", 0.09), leg("RIGHT", -0.09)];
    let legs = Legs { legs, gaits: vec![gait], step_height: 0.0, radius: 0.03, belly: 0.9 };
    Walker { name: "biped", legs: Arc::new(legs), limits: [1.5, 90_f64.to_radians()] }
}

/// ALDURO of `robis/alduro.toml`.
fn alduro() -> Walker {
    let leg = |name: &str, x, y| Leg {
        name: name.to_owned(),
        hip: DVec3::new(x, y, 1.8),
        thigh: 1.0,
        shank: 1.1,
        foot: None,
        wheel: None,
    };
    let gait = Gait {
        name: "creep".to_owned(),
        period: Time::from_millis(5_000),
        duty: 0.8,
        offsets: vec![0.25, 0.75, 0.0, 0.5],
        is_natural: false,
    };
    let legs = vec![
        leg("FRONT_LEFT", 0.9, 0.7),
        leg("FRONT_RIGHT", 0.9, -0.7),
        leg("BACK_LEFT", -0.9, 0.7),
        leg("BACK_RIGHT", -0.9, -0.7),
    ];
    let legs = Legs { legs, gaits: vec![gait], step_height: 0.2, radius: 0.06, belly: 1.8 };
    Walker { name: "ALDURO", legs: Arc::new(legs), limits: [0.6, 15_f64.to_radians()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standing_feet_keep_their_place_on_the_floor() {
        for walker in [biped(), alduro()] {
            for (name, course) in COURSES {
                let errors = walker.errors(course, None);
                // Rounding, at coordinates of up to 30 m.
                for (measure, of) in &Errors::MEASURES[..3] {
                    let found = of(&errors);
                    assert!(found < 1e-13, "{} {name}: {measure}: {found}", walker.name);
                }
                // The length of a foot: a swinging foot may stay behind its path, but not miss it.
                assert!(errors.swing < 0.2, "{} {name}: {}", walker.name, errors.swing);
            }
        }
    }

    #[test]
    fn interpolated_angles_slip_less_the_closer_their_samples() {
        for walker in [biped(), alduro()] {
            let slips = SAMPLES.map(|sample| walker.errors(CURVE, Some(sample)).slip);
            assert!(slips.is_sorted() && slips[0] > 1e-8, "{}: {slips:?}", walker.name);
        }
    }
}
