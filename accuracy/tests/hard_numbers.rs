//! NaN, infinities and extreme numbers as arguments of commands, placements, controllers and rays.
//!
//! Criterion: each number is rejected, or accepted with all poses finite; afterwards the robot moves as usual.

use std::sync::Arc;

use accuracy::course::model;
use glam::DVec2;
use sim_core::drive::{Command, DriveKind, Gains, Model, Motion, Pid};
use sim_core::object::{Part, Properties, Resistance, Shape};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Segment, Walls};
use sim_core::time::Time;
use sim_core::world::{Ray, World};
use sim_core::{ObjectId, RobotId};

/// NaN, infinities, numbers of extreme magnitude, both zeros and -1.
const EXTREME_NUMBERS: [f64; 18] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    1e300,
    -1e300,
    1e13,
    -1e13,
    1e12,
    -1e12,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    1e-300,
    0.0,
    -0.0,
    -1.0,
];

fn robots() -> Vec<Motion> {
    let walls = Arc::new(Walls::new(vec![Segment::new(DVec2::new(2.0, -3.0), DVec2::new(2.0, 3.0))]));
    let kinds = [DriveKind::Differential, DriveKind::Ackermann, DriveKind::Omni];
    let models = kinds.into_iter().flat_map(|kind| [0.0, 0.05].map(|wheel_lag| Model { kind, wheel_lag, ..model() }));
    models.map(|model| Motion::new(RobotId(1), Arc::new(model), walls.clone(), Pose::default())).collect()
}

fn is_finite(motion: &mut Motion, at: Time) -> bool {
    let state = motion.state(at);
    let numbers = [
        state.world_from_axle.position.x,
        state.world_from_axle.position.y,
        state.world_from_axle.heading.remainder(),
        state.odometry.position.x,
        state.odometry.position.y,
        state.odometry.heading.remainder(),
        state.path_length,
        motion.drive_remaining(at),
        motion.steering(at),
    ];
    let speed = motion.speed(at);
    numbers.iter().chain(&state.wheels).all(|number| number.is_finite()) && speed.is_finite()
}

/// Call to a robot with an extreme number; returns true if the number was accepted.
type Call = Box<dyn Fn(&mut Motion, Time, f64) -> bool>;

fn command(command_of: impl Fn(f64) -> Command + 'static) -> Call {
    Box::new(move |motion, at, number| motion.command(at, command_of(number), &[]).is_ok())
}

fn calls() -> Vec<(&'static str, Call)> {
    let twist = |vx, vy, omega| Twist { vx, vy, omega };
    let drive = |displacement, duration| Command::Drive { displacement, duration };
    let gains = |index: usize, number: f64| {
        let mut values = [2.0, 0.3, 2.0, 0.3];
        values[index] = number;
        let [vv, tv, vw, tw] = values;
        Gains { vv, tv, vw, tw }
    };
    let mut calls: Vec<(&'static str, Call)> = vec![
        ("wheels", command(|n| Command::Wheels([n, 1.0, 1.0, 1.0]))),
        ("all wheels", command(|n| Command::Wheels([n; 4]))),
        ("wheel", command(|n| Command::Wheel { wheel: 0, rate: n })),
        ("wheel speed", command(|n| Command::WheelSpeed { wheel: 0, rate: n })),
        ("steer", command(Command::Steer)),
        ("v", command(move |n| Command::Twist(twist(n, 0.0, 0.1)))),
        ("sideways", command(move |n| Command::Twist(twist(0.1, n, 0.1)))),
        ("omega", command(move |n| Command::Twist(twist(0.1, 0.0, n)))),
        ("length", command(move |n| drive(twist(n, 0.0, 0.1), 1.0))),
        ("side", command(move |n| drive(twist(0.1, n, 0.1), 1.0))),
        ("angle", command(move |n| drive(twist(0.1, 0.0, n), 1.0))),
        ("turn on the spot", command(move |n| drive(twist(0.0, 0.0, n), 0.0))),
        ("duration", command(move |n| drive(twist(0.1, 0.0, 0.1), n))),
        ("x", Box::new(|motion, at, n| motion.place(at, Pose::new(n, 0.0, 0.0)).is_ok())),
        ("y", Box::new(|motion, at, n| motion.place(at, Pose::new(0.0, n, 0.0)).is_ok())),
        ("phi", Box::new(|motion, at, n| motion.place(at, Pose::new(0.0, 0.0, n)).is_ok())),
        ("odometry x", Box::new(|motion, at, n| motion.set_odometry(at, Pose::new(n, 0.0, 0.0)).is_ok())),
        ("odometry y", Box::new(|motion, at, n| motion.set_odometry(at, Pose::new(0.0, n, 0.0)).is_ok())),
        ("odometry phi", Box::new(|motion, at, n| motion.set_odometry(at, Pose::new(0.0, 0.0, n)).is_ok())),
    ];
    for index in 0..4 {
        calls.push(("gains", Box::new(move |motion, at, n| motion.start_control(at, gains(index, n)).is_ok())));
    }
    for index in 0..3 {
        let pid = move |n: f64| {
            let mut values = [2.0, 1.0, 0.01];
            values[index] = n;
            Pid { p: values[0], i: values[1], d: values[2] }
        };
        calls.push(("pid", Box::new(move |motion, at, n| motion.start_wheel_control(at, 0, pid(n)).is_ok())));
    }
    calls
}

#[test]
fn motion_rejects_extreme_numbers_or_stays_finite() {
    for (name, call) in calls() {
        for number in EXTREME_NUMBERS {
            for (robot, mut motion) in robots().into_iter().enumerate() {
                let start = Time(3);
                motion.command(start, Command::Twist(Twist::new(0.1, 0.05)), &[]).expect("valid");
                motion.start_wheel_control(start, 0, Pid { p: 1.0, i: 1.0, d: 0.0 }).expect("valid");
                let at = Time(33_333);
                let (revision, before) = (motion.revision(), motion.state(at));
                let is_accepted = call(&mut motion, at, number);
                let context = format!("{name} {number} of robot {robot}");
                assert!(!is_accepted || number.is_finite() || name.ends_with("phi"), "{context} was taken");
                if !is_accepted {
                    assert_eq!(
                        (motion.revision(), motion.state(at)),
                        (revision, before),
                        "{context} changed something"
                    );
                }
                // Without lag, motion is not computed tick by tick, so the test looks a day ahead, beyond the ends of
                // drives.
                let ahead = if motion.model().wheel_lag > 0.0 { 1_000_000 } else { 86_400_000_000 };
                for delay in [0, 1, 10_000, 500_000, ahead] {
                    assert!(
                        is_finite(&mut motion, at + Time(delay)),
                        "{context}: {:?}",
                        motion.state(at + Time(delay))
                    );
                }
                motion.contacts(at + Time(ahead));
                // After a reset, the robot drives as usual.
                let reset_time = at + Time(ahead);
                motion.stop_control(reset_time);
                motion.stop_wheel_control(reset_time, 0).expect("a wheel");
                motion.place(reset_time, Pose::default()).expect("valid");
                motion.set_odometry(reset_time, Pose::default()).expect("valid");
                let drive = Command::Drive { displacement: Twist::new(0.5, 0.5), duration: 1.0 };
                motion.command(reset_time, drive, &[]).expect("valid");
                let end = motion.drive_end().unwrap_or_else(|| panic!("{context}: the drive has no end"));
                let target = Pose::default().moved(Twist::new(0.5, 0.5)).position;
                let found = motion.odometry(end).position;
                // With a lag a curve deviates slightly.
                assert!((found - target).length() < 0.02, "{context}: {found} instead of {target}");
            }
        }
    }
}

#[test]
fn world_rejects_extreme_numbers_or_stays_finite() {
    let ball = Arc::new(Properties {
        mass: 0.1,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape: Shape::Disc { radius: 0.05 }, object_from_part: Pose::default() }],
        resistance: Resistance::Rolling(0.02),
        restitution: 0.5,
        contact_friction: 0.3,
        lift: 0.0,
    });
    for number in EXTREME_NUMBERS {
        let walls = Arc::new(Walls::new(vec![Segment::new(DVec2::new(2.0, -3.0), DVec2::new(2.0, 3.0))]));
        let mut motion = Motion::new(RobotId(1), Arc::new(model()), walls.clone(), Pose::default());
        let world = World::new(walls, Time::from_millis(50), [&mut motion]);
        let mut world = world.with_objects([(ball.clone(), Pose::new(0.5, 0.5, 0.0))]);
        let object = ObjectId(1);
        for pose in [Pose::new(number, 0.5, 0.0), Pose::new(0.5, number, 0.0), Pose::new(0.5, 0.5, number)] {
            let is_accepted = world.place_object(object, pose).is_ok();
            assert!(!is_accepted || pose.position.is_finite(), "{pose:?}");
            world.advance(&mut [&mut motion]);
            let found = world.object_pose(object, world.slot_start());
            assert!(found.position.is_finite() && found.heading.remainder().is_finite(), "{found:?} after {pose:?}");
        }
        world.place_object(object, Pose::new(0.5, 0.5, 0.0)).expect("valid");
        world.advance(&mut [&mut motion]);
        for (origin, direction, range) in [
            (DVec2::new(number, 0.1), DVec2::X, 5.0),
            (DVec2::new(0.1, number), DVec2::Y, 5.0),
            (DVec2::ZERO, DVec2::X, number),
            (DVec2::ZERO, DVec2::new(number, 0.0), 5.0),
            (DVec2::ZERO, DVec2::new(0.5, number), 5.0),
        ] {
            let hit = world.cast(RobotId(1), &Ray::flat(origin, direction, range), world.slot_start());
            let is_sound = hit.is_none_or(|hit| hit.distance >= 0.0 && hit.distance.is_finite());
            assert!(is_sound, "{hit:?} from {origin} along {direction} to {range}");
        }
        motion.command(world.slot_start(), Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("valid");
        let start = motion.pose(world.slot_start()).position.x;
        world.advance(&mut [&mut motion]);
        assert!((motion.pose(world.slot_start()).position.x - start - 0.01).abs() < 1e-12);
    }
}
