//! `legs`: closure error of the legs' kinematic chains, and slip of standing feet, in walks of the biped and of ALDURO.
//!
//! The study computes the position of each foot from the joint angles with its own trigonometry. It compares standing
//! feet with their footholds, with their positions at touch-down and with the floor, and swinging feet with the path of
//! the gait. A second method, for comparison, interpolates the joint angles between samples.

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

/// Duration of a walk, s.
const SECONDS: f64 = 20.0;
/// Interval between the postures of a walk.
const POSTURE_INTERVAL: Time = Time::from_millis(1);
/// Sample intervals of the method that interpolates joint angles.
const SAMPLE_INTERVALS: [Time; 5] =
    [Time::from_millis(2), Time::from_millis(5), Time::from_millis(10), Time::from_millis(20), Time::from_millis(50)];
/// Time between two commands of a walk with several commands ([`CHANGES`]); not a simple fraction of a gait's period.
const COMMAND_INTERVAL: Time = Time(1_234_567);

/// A robot with legs and its limits.
struct Walker {
    name: &'static str,
    legs: Arc<Legs>,
    /// Maximum speed, m/s, and turning speed, rad/s.
    limits: [f64; 2],
}

/// Commanded twists (vx, vy, omega) of a walk, as fractions of the limits; after the last one, the first follows again.
type Course = &'static [[f64; 3]];

const AHEAD: Course = &[[0.9, 0.0, 0.0]];
const CURVE: Course = &[[0.5, 0.0, 0.4]];
const CHANGES: Course = &[[0.8, 0.0, 0.1], [0.2, -0.2, -0.5], [0.0, 0.0, 0.0], [-0.4, 0.1, 0.4], [0.5, 0.3, 0.0]];
/// Courses of the walks in the study's tables, with their names.
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
    /// Distance between a standing foot's foothold and its contact point as computed from the joint angles.
    closure: f64,
    /// Distance of a standing foot from its position at touch-down.
    slip: f64,
    /// Distance of a standing foot's contact point above or below the floor, or depth of any foot's heel, toe or tip
    /// below the floor, whichever is larger.
    floor: f64,
    /// Distance of a swinging foot from the path of the gait.
    swing: f64,
}

/// Name of an error measure, and the function that reads its value.
type Measure = (&'static str, fn(&Errors) -> f64);

impl Errors {
    /// Error measures in the study's tables.
    const MEASURES: [Measure; 4] = [
        ("standing feet, from the foothold", |errors| errors.closure),
        ("standing feet, slip", |errors| errors.slip),
        ("feet and floor", |errors| errors.floor),
        ("swinging feet, from the gait's path", |errors| errors.swing),
    ];
}

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    for walker in [biped(), alduro()] {
        let errors_of_walks: Vec<Errors> = COURSES.iter().map(|(_, course)| walker.errors(course, None)).collect();
        let times: Vec<f64> = COURSES.iter().map(|(_, course)| walker.time(course, None, effort)).collect();
        for (measure, value) in Errors::MEASURES {
            for (((course, _), errors), time_ns) in COURSES.iter().zip(&errors_of_walks).zip(&times) {
                rows.push(row(format!("{}: {measure}", walker.name), (*course).to_owned(), value(errors), *time_ns));
            }
        }
        for sample_interval in SAMPLE_INTERVALS {
            let slip = walker.errors(CURVE, Some(sample_interval)).slip;
            let setting = format!("curve, samples every {} ms", sample_interval.0 / 1_000);
            let time_ns = walker.time(CURVE, Some(sample_interval), effort);
            rows.push(row(format!("{}: interpolated angles, slip", walker.name), setting, slip, time_ns));
        }
        figures.push(height_figure(&walker));
    }
    Outcome { rows, figures }
}

fn row(method: String, setting: String, error: f64, time_ns: f64) -> Row {
    Row { study: STUDY.name, method, setting, error, unit: "m", time_ns, per: "posture" }
}

/// Gives the command, if any, that fell due after the previous posture and no later than `at`.
fn give_due_command(course: Course, motion: &mut Motion, at: Time) {
    let (index, count) = (at.0.div_euclid(COMMAND_INTERVAL.0), course.len() as i64);
    let is_due = at.0 - index * COMMAND_INTERVAL.0 < POSTURE_INTERVAL.0 && (index == 0 || count > 1);
    if is_due {
        let (speed, turn) = (motion.model().max_speed, motion.model().max_turn);
        let [vx, vy, omega] = course[(index % count) as usize];
        let twist = Twist { vx: vx * speed, vy: vy * speed, omega: omega * turn };
        motion.command(Time(index * COMMAND_INTERVAL.0), Command::Twist(twist), &[]).expect("legs obey any twist");
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

    /// Maximum errors of a walk with the exact postures, or with joint angles interpolated between samples.
    fn errors(&self, course: Course, sample_interval: Option<Time>) -> Errors {
        let mut motion = self.motion();
        let mut postures = Postures::new(sample_interval);
        let mut errors = Errors::default();
        // For each standing foot: world position at touch-down of the point of the sole under the ankle.
        let mut touch_downs: Vec<Option<DVec3>> = vec![None; self.legs.legs.len()];
        for index in 0..(SECONDS / POSTURE_INTERVAL.seconds()) as i64 {
            let at = Time(index * POSTURE_INTERVAL.0);
            give_due_command(course, &mut motion, at);
            let pose = motion.pose(at);
            let exact = motion.stance(at);
            let (joints, lift) = postures.at(&mut motion, at, &exact);
            let mut first = 0;
            for ((leg, foot), touch_down) in self.legs.legs.iter().zip(&exact.feet).zip(&mut touch_downs) {
                let angles = &joints[first..first + leg.joint_count()];
                first += leg.joint_count();
                let sole_in_world = |from_ankle| in_world(&pose, lift, sole_point(leg, angles, from_ankle));
                let point = sole_in_world(foot.sole.from_ankle);
                let distance = (point - foot.point).length();
                let ends = leg.foot.map_or([0.0, 0.0], |foot| [-foot.heel, foot.toe]);
                errors.floor = ends.iter().fold(errors.floor, |depth, end| depth.max(-sole_in_world(*end).z));
                if !foot.is_down {
                    errors.swing = errors.swing.max(distance);
                    *touch_down = None;
                    continue;
                }
                errors.closure = errors.closure.max(distance);
                errors.floor = errors.floor.max(point.z.abs());
                // A standing foot rolls from heel to toe along its yaw direction, and the contact point moves along the
                // sole. The point of the flat sole under the ankle does not move.
                let direction = DVec2::from_angle(pose.heading.radians() + angles[0]).extend(0.0);
                let under_ankle = point - foot.sole.from_ankle * direction;
                errors.slip = errors.slip.max((under_ankle - *touch_down.get_or_insert(under_ankle)).length());
            }
        }
        errors
    }

    /// Computing time of one posture in a walk, ns.
    fn time(&self, course: Course, sample_interval: Option<Time>, effort: Effort) -> f64 {
        let count = (SECONDS / POSTURE_INTERVAL.seconds()) as i64;
        let walk = || {
            let mut motion = self.motion();
            let mut postures = Postures::new(sample_interval);
            let mut sum = 0.0;
            for index in 0..count {
                let at = Time(index * POSTURE_INTERVAL.0);
                give_due_command(course, &mut motion, at);
                let joints = match sample_interval {
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

/// Joint angles and lift, exact or interpolated between samples.
struct Postures {
    /// Interval between samples; `None` for exact postures.
    sample_interval: Option<Time>,
    /// Index of the current sample interval, and the stances at its ends.
    samples: Option<(i64, Stance, Stance)>,
}

impl Postures {
    fn new(sample_interval: Option<Time>) -> Self {
        Self { sample_interval, samples: None }
    }

    fn at(&mut self, motion: &mut Motion, at: Time, exact: &Stance) -> (Vec<f64>, f64) {
        let Some(interval) = self.sample_interval else { return (exact.joints.clone(), exact.lift) };
        let index = at.0.div_euclid(interval.0);
        if self.samples.as_ref().is_none_or(|(stored, ..)| *stored != index) {
            let mut stance = |index: i64| motion.stance(Time(index * interval.0));
            let before = stance(index);
            self.samples = Some((index, before, stance(index + 1)));
        }
        let (_, before, after) = self.samples.as_ref().expect("samples have been taken");
        let fraction = (at.0 - index * interval.0) as f64 / interval.0 as f64;
        let interpolated = |from: f64, to: f64| from + fraction * (to - from);
        let joints = before.joints.iter().zip(&after.joints).map(|(from, to)| interpolated(*from, *to)).collect();
        (joints, interpolated(before.lift, after.lift))
    }
}

/// Point of the sole `from_ankle` m in front of the ankle, or the tip of a leg without a foot, in the robot's frame.
fn sole_point(leg: &Leg, angles: &[f64], from_ankle: f64) -> DVec3 {
    let (pitch, knee) = (angles[2], angles[3]);
    // Direction at `angle` from straight down, in the plane of the leg: x forwards, y up.
    let direction_at = |angle: f64| DVec2::new(math::sin(angle), -math::cos(angle));
    let mut point = direction_at(pitch) * leg.thigh + direction_at(pitch - knee) * leg.shank;
    if let Some(foot) = leg.foot {
        let tilt = pitch - knee + angles[4];
        point += DVec2::new(math::cos(tilt), math::sin(tilt)) * from_ankle + direction_at(tilt) * foot.height;
    }
    let (sin_roll, cos_roll) = math::sin_cos(angles[1]);
    let (sin_yaw, cos_yaw) = math::sin_cos(angles[0]);
    let (x, y, z) = (point.x, -point.y * sin_roll, point.y * cos_roll);
    leg.hip + DVec3::new(cos_yaw * x - sin_yaw * y, sin_yaw * x + cos_yaw * y, z)
}

fn in_world(pose: &Pose, lift: f64, point: DVec3) -> DVec3 {
    pose.transform_point(point.truncate()).extend(point.z + lift)
}

/// Plot of the heights of the feet's contact points, from the joint angles, over two periods of a steady walk.
fn height_figure(walker: &Walker) -> Figure {
    let mut motion = walker.motion();
    give_due_command(AHEAD, &mut motion, Time::ZERO);
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
    let legs = Legs { legs, gaits: vec![gait], step_height: 0.0, radius: 0.03, underside: 0.9 };
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
    let legs = Legs { legs, gaits: vec![gait], step_height: 0.2, radius: 0.06, underside: 1.8 };
    Walker { name: "ALDURO", legs: Arc::new(legs), limits: [0.6, 15_f64.to_radians()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standing_feet_do_not_slip() {
        for walker in [biped(), alduro()] {
            for (name, course) in COURSES {
                let errors = walker.errors(course, None);
                // Only rounding remains, at coordinates of up to 30 m.
                for (measure, value) in &Errors::MEASURES[..3] {
                    let found = value(&errors);
                    assert!(found < 1e-13, "{} {name}: {measure}: {found}", walker.name);
                }
                // A swinging foot may lag behind the gait's path, by less than 0.2 m.
                assert!(errors.swing < 0.2, "{} {name}: {}", walker.name, errors.swing);
            }
        }
    }

    #[test]
    fn slip_of_interpolated_angles_falls_with_the_sample_interval() {
        for walker in [biped(), alduro()] {
            let slips = SAMPLE_INTERVALS.map(|interval| walker.errors(CURVE, Some(interval)).slip);
            assert!(slips.is_sorted() && slips[0] > 1e-8, "{}: {slips:?}", walker.name);
        }
    }
}
