//! A long drive, computed by the core and by the integrators of other simulators; its end pose is known to 30 digits.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec2;
use sim_core::RobotId;
use sim_core::drive::{Command, DriveKind, Model, Motion};
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Walls;
use sim_core::time::Time;
use sim_core::world::World;

use crate::wide::Wide;
use crate::world::Random;

/// One drive of a course: a straight line, a curve or a turn on the spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Displacement: arc length, m, and angle, rad.
    pub displacement: Twist,
    /// Duration in whole seconds, so that the drive begins and ends at the end of a step of every integrator.
    pub seconds: u32,
}

/// Sequence of drives from the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Course(pub Vec<Drive>);

impl Course {
    /// A course of 600 s: straight lines, curves and turns on the spot in turn, of 1 to 8 s each, with random speeds of
    /// up to 0.5 m/s and 2 rad/s, forwards and backwards; the seed is fixed.
    pub fn ten_minutes() -> Self {
        let mut random = Random::new(600);
        let mut drives = Vec::new();
        let mut remaining = 600;
        while remaining > 0 {
            let seconds = (1 + random.below(8) as u32).min(remaining);
            let (speed, turn) = (random.between(-0.5, 0.5), random.between(-2.0, 2.0));
            let twist = match drives.len() % 3 {
                0 => Twist::new(speed, 0.0),
                1 => Twist::new(speed, turn),
                _ => Twist::new(0.0, turn),
            };
            drives.push(Drive { displacement: twist.scaled(f64::from(seconds)), seconds });
            remaining -= seconds;
        }
        Self(drives)
    }

    /// The first `seconds` of this course; the last drive is shortened.
    pub fn first(&self, seconds: u32) -> Self {
        let mut remaining = seconds;
        let mut drives = Vec::new();
        for drive in &self.0 {
            let kept_seconds = drive.seconds.min(remaining);
            if kept_seconds > 0 {
                let fraction = f64::from(kept_seconds) / f64::from(drive.seconds);
                drives.push(Drive { displacement: drive.displacement.scaled(fraction), seconds: kept_seconds });
            }
            remaining -= kept_seconds;
        }
        Self(drives)
    }

    /// Duration of the course in seconds.
    pub fn seconds(&self) -> u32 {
        self.0.iter().map(|drive| drive.seconds).sum()
    }

    /// End pose of the course by the closed form of each drive, with 30 digits.
    pub fn end(&self) -> EndPose {
        let mut end = EndPose::default();
        for Drive { displacement: Twist { vx, vy, omega }, .. } in &self.0 {
            let (vx, vy, angle) = (Wide::from(*vx), Wide::from(*vy), Wide::from(*omega));
            let (sin, cos) = end.heading.sin_cos();
            end.heading = end.heading + angle;
            let (along_x, along_y) = if *omega == 0.0 {
                (cos, sin)
            } else {
                let (sin_end, cos_end) = end.heading.sin_cos();
                ((sin_end - sin) / angle, (cos - cos_end) / angle)
            };
            end.x = end.x + vx * along_x - vy * along_y;
            end.y = end.y + vx * along_y + vy * along_x;
        }
        end
    }
}

/// End pose with 30 digits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndPose {
    /// x of the position, m.
    pub x: Wide,
    /// y of the position, m.
    pub y: Wide,
    /// Heading including whole turns, rad.
    pub heading: Wide,
}

impl EndPose {
    /// Distance to a pose's position, in metres.
    pub fn distance(&self, pose: &Pose) -> f64 {
        let [x, y] = pose.position.to_array().map(Wide::from);
        math::hypot((x - self.x).rounded(), (y - self.y).rounded())
    }

    /// Angle between this heading and a pose's, in radians, up to half a turn.
    pub fn angle(&self, pose: &Pose) -> f64 {
        let (sin, cos) = (Wide::from(pose.heading.remainder()) - self.heading).sin_cos();
        math::atan2(sin.rounded(), cos.rounded()).abs()
    }
}

/// Shortest interval between two queries of the pose.
const MIN_QUERY_INTERVAL: Time = Time(100);

/// True pose at the end of the course by the core, in slots of length `slot` and in a world without walls.
///
/// Each drive is commanded when the previous one has ended. The pose is queried after each slot, or after every 100 us
/// if slots are shorter.
///
/// # Panics
/// If a drive of the course is not finite.
pub fn core(course: &Course, slot: Time) -> Pose {
    let walls = Arc::new(Walls::new(Vec::new()));
    let mut motion = Motion::new(RobotId(1), Arc::new(model()), Arc::clone(&walls), Pose::default());
    let mut world = World::new(walls, slot, [&mut motion]);
    let (mut now, mut last_query) = (Time::ZERO, Time::ZERO);
    for drive in &course.0 {
        let command = Command::Drive { displacement: drive.displacement, duration: f64::from(drive.seconds) };
        motion.command(now, command, &[]).expect("a drive within the limits");
        now = motion.drive_end().expect("nothing is in the way");
        while world.slot_end() <= now {
            world.advance(&mut [&mut motion]);
            if world.slot_start() - last_query >= MIN_QUERY_INTERVAL {
                last_query = world.slot_start();
                motion.pose(last_query);
            }
        }
    }
    motion.pose(now)
}

/// End pose by Euler's method in steps of `step` seconds, which must divide a second: heading and speed in a step are
/// those at its start.
pub fn euler(course: &Course, step: f64) -> Pose {
    integrate(course, step, |twist, heading, step| velocity(twist, heading) * step)
}

/// End pose by the classical fourth-order Runge-Kutta method in steps of `step` seconds, which must divide a second.
pub fn runge_kutta(course: &Course, step: f64) -> Pose {
    integrate(course, step, |twist, heading, step| {
        // The heading grows linearly, so both midpoint slopes are equal.
        let middle = velocity(twist, heading + 0.5 * step * twist.omega);
        let (first, last) = (velocity(twist, heading), velocity(twist, heading + step * twist.omega));
        (first + 4.0 * middle + last) * (step / 6.0)
    })
}

/// Velocity in the world frame, m/s.
fn velocity(twist: Twist, heading: f64) -> DVec2 {
    let (sin, cos) = math::sin_cos(heading);
    DVec2::new(cos, sin).rotate(DVec2::new(twist.vx, twist.vy))
}

/// End pose by steps of `step` seconds; `displacement` returns the displacement in a step for (twist, heading, step).
fn integrate(course: &Course, step: f64, displacement: impl Fn(Twist, f64, f64) -> DVec2) -> Pose {
    let (mut position, mut heading) = (DVec2::ZERO, 0.0_f64);
    for drive in &course.0 {
        let seconds = f64::from(drive.seconds);
        let twist = drive.displacement.scaled(1.0 / seconds);
        let steps = (seconds / step).round() as u64;
        for _ in 0..steps {
            position += displacement(twist, heading, step);
            heading += step * twist.omega;
        }
    }
    Pose { position, ..Pose::new(0.0, 0.0, heading) }
}

/// End pose by odometry that reads the encoders every `period` and treats the motion between two readings as an
/// arc. Encoders have `ticks_per_turn` counts for each turn of a wheel, or are exact if it is `None`.
///
/// # Panics
/// If a drive of the course is not finite.
pub fn odometry(course: &Course, period: Time, ticks_per_turn: Option<f64>) -> Pose {
    let model = Model { ticks_per_turn: ticks_per_turn.unwrap_or(1.0), ..model() };
    let angle_per_tick = 2.0 * PI / model.ticks_per_turn;
    let mut motion =
        Motion::new(RobotId(1), Arc::new(model.clone()), Arc::new(Walls::new(Vec::new())), Pose::default());
    let mut world = World::new(Arc::new(Walls::new(Vec::new())), period, [&mut motion]);
    let (mut pose, mut last_angles) = (Pose::default(), [0.0; 4]);
    let mut now = Time::ZERO;
    let mut read_encoders = |motion: &mut Motion, at: Time| {
        let angles = motion.wheel_angles(at);
        let angles = if ticks_per_turn.is_some() {
            angles.map(|angle| (angle / angle_per_tick).floor() * angle_per_tick)
        } else {
            angles
        };
        let rotations = std::array::from_fn(|i| angles[i] - last_angles[i]);
        last_angles = angles;
        pose = pose.moved(model.twist_from_wheels(&rotations, 0.0));
        pose
    };
    for drive in &course.0 {
        let command = Command::Drive { displacement: drive.displacement, duration: f64::from(drive.seconds) };
        motion.command(now, command, &[]).expect("a drive within the limits");
        now = motion.drive_end().expect("nothing is in the way");
        while world.slot_end() <= now {
            let end = world.slot_end();
            read_encoders(&mut motion, end);
            world.advance(&mut [&mut motion]);
        }
    }
    read_encoders(&mut motion, now)
}

/// Small differential drive that is fast enough for any course.
pub fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.05,
        max_wheel_rate: 100.0,
        ticks_per_turn: 1_000.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: f64::INFINITY,
        max_turn: f64::INFINITY,
        body_radius: 0.08,
        wheel_lag: 0.0,
        max_steering: 0.5,
        mass: 1.0,
        traction: 0.6,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn core_is_exact_for_any_slot_length() {
        let course = Course::ten_minutes();
        assert_eq!(course.seconds(), 600);
        let end = course.end();
        let expected = core(&course, Time(1_000_000));
        // Within a picometre and a picoradian after 130 drives.
        assert!(end.distance(&expected) < 1e-12 && end.angle(&expected) < 1e-12, "{} m", end.distance(&expected));
        for slot in [1_000, 7_919, 50_000, 200_000] {
            assert_eq!(core(&course, Time(slot)), expected, "slots of {slot} us");
        }
        let short = course.first(2);
        assert_eq!(core(&short, Time(1)), core(&short, Time(1_000_000)));
    }

    #[test]
    fn integrators_converge_with_their_order() {
        let course = Course::ten_minutes().first(60);
        let end = course.end();
        assert!(end.distance(&core(&course, Time(10_000))) < 1e-13);
        let error = |integrator: fn(&Course, f64) -> Pose, step| end.distance(&integrator(&course, step));
        for (integrator, order) in [(euler as fn(&Course, f64) -> Pose, 1.0), (runge_kutta, 4.0)] {
            let (coarse, fine) = (error(integrator, 0.1), error(integrator, 0.05));
            let found = (coarse / fine).log2();
            assert!((found - order).abs() < 0.2, "order {found} instead of {order}: {coarse} and {fine} m");
        }
    }

    #[test]
    fn odometry_error_comes_from_ticks_only() {
        let course = Course::ten_minutes().first(60);
        let end = course.end();
        let exact = end.distance(&odometry(&course, Time(10_000), None));
        // The time at the end of a drive is rounded to a microsecond, so one period contains parts of two drives.
        assert!(exact < 1e-7, "arcs of constant twist lose nothing: {exact} m");
        let [fine, coarse] = [10_000.0, 100.0].map(|ticks| end.distance(&odometry(&course, Time(10_000), Some(ticks))));
        assert!(fine < coarse && fine > exact && coarse < 0.2, "{fine} and {coarse} m");
    }
}
