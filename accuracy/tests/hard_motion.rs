//! Hard cases of motion: extreme numbers, very long durations, positions far from the origin, and slots from a
//! microsecond to a second.

use std::f64::consts::PI;
use std::sync::Arc;

use accuracy::course::model;
use accuracy::wide::Wide;
use glam::DVec2;
use sim_core::RobotId;
use sim_core::drive::{Command, DriveKind, Gains, Imperfection, Model, Motion, Pid, State};
use sim_core::math;
use sim_core::noise::TwistNoise;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Segment, Walls};
use sim_core::time::Time;
use sim_core::world::World;

fn robot(model: Model, walls: Vec<Segment>, start: Pose) -> Motion {
    model.check().expect("a valid model");
    Motion::new(RobotId(1), Arc::new(model), Arc::new(Walls::new(walls)), start)
}

fn room(corner: DVec2, size: f64) -> Vec<Segment> {
    let point = |x: f64, y: f64| corner + DVec2::new(x, y) * size;
    let corners = [point(0.0, 0.0), point(1.0, 0.0), point(1.0, 1.0), point(0.0, 1.0)];
    (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect()
}

fn drive(length: f64, angle: f64, duration: f64) -> Command {
    Command::Drive { displacement: Twist::new(length, angle), duration }
}

/// Unequal wheels, slip and noise, large enough to change every state of a moving robot.
fn imperfection() -> Imperfection {
    let noise = TwistNoise { speed: 0.02, speed_share: 0.05, turn: 0.1, turn_share: 0.05 };
    Imperfection {
        diameters: [0.01, -0.02, 0.0, 0.03],
        slip: 0.02,
        slip_deviation: 0.05,
        command: noise,
        odometry: noise,
        ..Imperfection::default()
    }
}

/// States at each command of a fixed sequence and 3.217 ms later, for one robot in a small room with slots of `slot`.
fn run_commands(mut motion: Motion, slot: Time) -> Vec<State> {
    let mut world = World::new(small_room(), slot, [&mut motion]);
    let commands = [
        (1, drive(0.01, 0.0, 0.04)),
        (45_000, drive(0.004, 0.3, 0.0)),
        (70_001, drive(0.0, -0.2, 0.02)),
        (93_333, Command::Twist(Twist::new(0.8, 0.4))),
        (140_000, Command::Twist(Twist::new(5.0, 0.1))),
        (190_007, drive(-0.02, 0.02, 0.1)),
        (240_000, Command::Wheels([9.0, 7.0, -3.0, 1.0])),
        (270_000, Command::WheelSpeed { wheel: 0, rate: -12.0 }),
        (333_333, Command::Halt),
    ];
    let mut states = Vec::new();
    for (at, command) in commands {
        let at = Time(at);
        while world.slot_end() <= at {
            world.advance(&mut [&mut motion]);
        }
        states.push(motion.state(at));
        motion.command(at, command, &[]).expect("a valid command");
        states.push(motion.state(at + Time(3_217)));
    }
    states
}

fn small_room() -> Arc<Walls> {
    Arc::new(Walls::new(room(DVec2::splat(-0.1), 0.2)))
}

/// Criterion: poses, odometry, wheel angles and path lengths are exactly equal for slots of any length. The commands
/// are drives, speeds and wheel rates near walls. Robots have lag, controllers, wheel controllers and imperfections.
#[test]
fn states_have_equal_bits_for_any_slot_length() {
    let lagging_model = Model { wheel_lag: 0.04, axis_offset: 0.01, ..model() };
    let omni = Model { kind: DriveKind::Omni, ..model() };
    let new = |model: Model| Motion::new(RobotId(1), Arc::new(model), small_room(), Pose::new(0.0, -0.01, 0.7));
    let controlled = || {
        let mut motion = new(lagging_model.clone());
        motion.start_control(Time::ZERO, Gains { vv: 3.0, tv: 0.2, vw: 3.0, tw: 0.2 }).expect("valid");
        motion.start_wheel_control(Time::ZERO, 0, Pid { p: 2.0, i: 30.0, d: 0.001 }).expect("valid");
        motion
    };
    let imperfect = |motion: Motion| motion.with_imperfection(5, imperfection()).expect("valid");
    let robots: [(&str, Motion); 6] = [
        ("plain", new(model())),
        ("lag", new(lagging_model.clone())),
        ("controllers", controlled()),
        ("imperfect", imperfect(new(model()))),
        ("imperfect controllers", imperfect(controlled())),
        ("imperfect omni", imperfect(new(omni))),
    ];
    for (name, motion) in robots {
        let reference = run_commands(motion.clone(), Time(50_000));
        assert!(reference.iter().any(|state| state.path_length > 0.0));
        for slot in [1, 17, 1_000, 9_999, 10_000, 200_000, 1_000_000] {
            assert!(run_commands(motion.clone(), Time(slot)) == reference, "{name} in slots of {slot} us");
        }
    }
}

/// Criterion: a drive ends at its angle and within 1e-12 m of the end of its arc, at 1e-300 to 1e4 rad/s in both
/// directions.
#[test]
fn drives_end_exactly_at_any_turning_speed() {
    let fast_model = Model { max_wheel_rate: 1e9, ..model() };
    for exponent in -300..=4 {
        for sign in [1.0, -1.0] {
            let omega = sign * 10.0_f64.powi(exponent);
            let mut motion = robot(fast_model.clone(), vec![], Pose::default());
            motion.command(Time(7), drive(1.0, 2.0 * omega, 2.0), &[]).expect("valid");
            let end = motion.drive_end().expect("the drive ends");
            assert!((end - Time(2_000_007)).0.abs() <= 1, "{end:?} at {omega} rad/s");
            let pose = motion.pose(end);
            assert!((pose.heading.radians() - 2.0 * omega).abs() <= 4e-16 * (2.0 * omega).abs().max(1.0));
            // End of the arc: for small angles by the series, otherwise with 30 digits.
            let angle = 2.0 * omega;
            let expected = if angle.abs() < 1e-5 {
                DVec2::new(1.0 - angle * angle / 6.0, angle / 2.0)
            } else {
                let (sin, cos) = Wide::from(angle).sin_cos();
                let wide = Wide::from(angle);
                DVec2::new((sin / wide).rounded(), ((Wide::from(1.0) - cos) / wide).rounded())
            };
            assert!((pose.position - expected).length() < 1e-12, "{pose:?} instead of {expected} at {omega} rad/s");
        }
    }
}

/// Criterion: after a million turns on a circle in one piece of motion, the position is exact except for the rounding
/// of the angle, which is the commanded turning speed times the time.
#[test]
fn million_turns_stay_on_the_circle() {
    let mut motion = robot(Model { axis_offset: 0.02, ..model() }, vec![], Pose::new(3.0, 4.0, 0.2));
    let (v, omega) = (0.4, 2.5);
    motion.command(Time::ZERO, Command::Twist(Twist::new(v, omega)), &[]).expect("valid");
    let at = Time(2_513_274_122_872); // A million turns, to the microsecond.
    let state = motion.state(at);
    assert!((999_999..=1_000_001).contains(&state.world_from_axle.heading.turns()));
    let angle = Wide::from(omega) * (Wide::from(at.0 as f64) / Wide::from(1e6));
    let (sin, cos) = (angle + Wide::from(0.2)).sin_cos();
    let pose = state.world_from_axle;
    let (found_sin, found_cos) = math::sin_cos(pose.heading.remainder());
    // The angle of 6e6 rad is rounded to 1e-9 rad, less than a ten-millionth of a degree.
    assert!((found_sin - sin.rounded()).abs() < 2e-9 && (found_cos - cos.rounded()).abs() < 2e-9);
    let start = robot(Model { axis_offset: 0.02, ..model() }, vec![], Pose::new(3.0, 4.0, 0.2)).state(Time::ZERO);
    assert!((pose.position - start.world_from_axle.position).length() < 1e-6, "{pose:?}");
    assert!((state.path_length - v * at.seconds()).abs() < 1e-3 * 1e-6, "{} m", state.path_length);
}

/// Criterion: relative to its start, a course with curves at coordinates of 10 km ends within 1e-9 m of the same course
/// at the origin (1e4 m are rounded to 2e-12 m).
#[test]
fn course_ten_kilometres_away_is_the_same() {
    let lagging_model = Model { wheel_lag: 0.05, axis_offset: 0.03, ..model() };
    for (model, imperfection) in
        [(model(), Imperfection::default()), (lagging_model, Imperfection::default()), (model(), imperfection())]
    {
        let run = |offset: DVec2| {
            let start = Pose { position: offset, ..Pose::new(0.0, 0.0, 0.3) };
            let mut motion = robot(model.clone(), vec![], start).with_imperfection(3, imperfection).expect("valid");
            let mut at = Time::ZERO;
            for n in 0..200 {
                let command = drive(0.3 - 0.01 * f64::from(n % 50), 0.1 * f64::from(n % 17) - 0.8, 0.5);
                motion.command(at, command, &[]).expect("valid");
                at = motion.drive_end().expect("the drive ends");
            }
            (motion.pose(at).position - offset, at)
        };
        let (here, end_here) = run(DVec2::ZERO);
        let (there, end_there) = run(DVec2::new(1e4, -1e4));
        assert_eq!(end_here, end_there);
        assert!((here - there).length() < 1e-9, "{here} and {there}");
    }
}

/// Criterion: a million drives of a micrometre add up to a metre within 1e-10 m; a drive back by a metre returns to the
/// start.
#[test]
fn million_drives_of_a_micrometre_add_up_to_a_metre() {
    let mut motion = robot(model(), vec![], Pose::new(0.0, 0.0, 0.5));
    let mut world = World::new(Arc::new(Walls::new(vec![])), Time::from_millis(50), [&mut motion]);
    let mut at = Time::ZERO;
    for _ in 0..1_000_000 {
        motion.command(at, drive(1e-6, 0.0, 1e-5), &[]).expect("valid");
        at = motion.drive_end().expect("the drive ends");
        while world.slot_end() <= at {
            world.advance(&mut [&mut motion]);
        }
    }
    let expected = DVec2::new(math::cos(0.5), math::sin(0.5));
    assert!((motion.pose(at).position - expected).length() < 1e-10, "{:?}", motion.pose(at));
    assert!((motion.odometry(at).position - DVec2::X).length() < 1e-10);
    motion.command(at, drive(-1.0, 0.0, 1.0), &[]).expect("valid");
    let end = motion.drive_end().expect("the drive ends");
    assert!(motion.pose(end).position.length() < 1e-10);
}

/// Criterion: drives of zero or vanishing length end within two ticks without motion, also with lag and imperfections.
/// A drive of negative length goes as far back as the drive of the opposite length goes forward.
#[test]
fn zero_and_negative_drives_end() {
    let lagging_model = Model { wheel_lag: 0.05, ..model() };
    for (model, imperfection) in
        [(model(), Imperfection::default()), (lagging_model, Imperfection::default()), (model(), imperfection())]
    {
        let new = || robot(model.clone(), vec![], Pose::default()).with_imperfection(8, imperfection).expect("valid");
        for (length, angle) in [(0.0, 0.0), (-0.0, -0.0), (5e-324, 0.0), (0.0, -5e-324), (1e-300, 1e-300)] {
            let mut motion = new();
            motion.command(Time(11), drive(length, angle, 0.0), &[]).expect("valid");
            let end = motion.drive_end().unwrap_or_else(|| panic!("the drive of {length} m, {angle} rad does not end"));
            assert!(end <= Time(20_000), "{end:?}");
            assert!(motion.pose(end).position.length() < 1e-12 && motion.is_drive_done(end));
        }
        for length in [1e-6, 1e-9, 0.2] {
            let ends = [length, -length].map(|length| {
                let mut motion = new();
                motion.command(Time::ZERO, drive(length, 0.0, 1.0), &[]).expect("valid");
                let end = motion.drive_end().expect("the drive ends");
                motion.state(end).wheels[0]
            });
            assert!((ends[0] + ends[1]).abs() <= 1e-12 * length && ends[0] > 0.0, "{ends:?}");
        }
    }
}

/// Criterion: a robot whose controllers demand more than the maximum speed reaches this speed and does not exceed it.
/// Afterwards the robot reaches a lower commanded speed within 0.3 s, so there is no integrator windup. With gains of
/// any size all numbers stay finite.
#[test]
fn saturated_controllers_keep_the_limit_and_recover() {
    let lagging_model = Model { wheel_lag: 0.06, max_wheel_rate: 20.0, ..model() };
    let limit = 0.5; // m/s
    let mut motion = robot(lagging_model.clone(), vec![], Pose::default());
    motion.start_control(Time::ZERO, Gains { vv: 3.0, tv: 0.1, vw: 3.0, tw: 0.1 }).expect("valid");
    motion.command(Time::ZERO, Command::Twist(Twist::new(40.0, 0.0)), &[]).expect("valid");
    for second in 1..=60 {
        let speed = motion.speed(Time(second * 1_000_000)).vx;
        assert!(speed <= limit + 1e-9 && speed > limit - 1e-3, "{speed} m/s");
    }
    let at = Time(60_000_000);
    motion.command(at, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("valid");
    let speed = motion.speed(at + Time(300_000)).vx;
    assert!((speed - 0.1).abs() < 0.02, "{speed} m/s");
    // A drive that demands more than the maximum speed takes longer and ends at its target.
    motion.command(at + Time(1_000_000), drive(0.5, 0.0, 1e-9), &[]).expect("valid");
    let before = motion.path_length(at + Time(1_000_000));
    let end = motion.drive_end().expect("the drive ends");
    assert!((motion.path_length(end) - before - 0.5).abs() < 1e-9 && end > at + Time(1_900_000));
    for factor in [0.0, 1e-300, 1e12] {
        for integral_time in [1e-12, 1.0, 1e12] {
            let mut motion = robot(lagging_model.clone(), room(DVec2::splat(-1.0), 2.0), Pose::default());
            let gains = Gains { vv: factor, tv: integral_time, vw: factor, tw: integral_time };
            motion.start_control(Time::ZERO, gains).expect("valid");
            motion.command(Time::ZERO, Command::Twist(Twist::new(0.3, 0.5)), &[]).expect("valid");
            for step in 0..500 {
                let state = motion.state(Time(step * 10_000));
                let numbers = [state.world_from_axle.position.x, state.world_from_axle.position.y, state.wheels[0]];
                assert!(numbers.iter().all(|number| number.is_finite()), "{state:?} with {gains:?}");
                assert!(state.world_from_axle.position.abs().max_element() < 1.0);
            }
        }
    }
}

/// Criterion: after a year at rest, a robot moves exactly as at the start.
#[test]
fn drive_after_a_year_is_the_same() {
    let year = Time(365 * 86_400 * 1_000_000);
    let ends = [Time::ZERO, year].map(|start| {
        let mut motion = robot(model(), vec![], Pose::new(0.0, 0.0, PI / 3.0));
        motion.command(start, drive(0.7, 1.3, 1.1), &[]).expect("valid");
        let end = motion.drive_end().expect("the drive ends");
        (end - start, motion.state(start + Time(543_210)), motion.pose(end))
    });
    assert_eq!(ends[0], ends[1]);
}
