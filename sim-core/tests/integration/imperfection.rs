//! Imperfect motion: closed forms of systematic errors, statistics of random errors, and bit-identical motion for every
//! slot length.

use std::{f64::consts::PI, sync::Arc};

use accuracy::oracle;
use glam::DVec2;
use sim_core::{
    ObjectId, RobotId,
    contact::{SKIN, Thing},
    drive::{Command, DriveKind, Gains, Imperfection, Model, Motion, Wheels},
    math,
    noise::{DriveBound, Resolution, TwistNoise},
    object::{Part, Properties, Resistance, Shape},
    pose::{Pose, Twist},
    scene::{Segment, Walls},
    time::{TICK, Time},
    world::World,
};

fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.05,
        max_wheel_rate: 60.0,
        ticks_per_turn: 540.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: 0.6,
        max_turn: 5.0,
        body_radius: 0.08,
        wheel_lag: 0.0,
        max_steering: PI / 4.0,
        mass: 1.0,
        traction: 0.6,
    }
}

/// Robot 1 at the origin, facing along x.
fn robot(model: Model, walls: Vec<Segment>, seed: u64, imperfection: Imperfection) -> Motion {
    let motion = Motion::new(RobotId(1), Arc::new(model), Arc::new(Walls::new(walls)), Pose::default());
    motion.with_imperfection(seed, imperfection).expect("a valid imperfection")
}

fn drive(length: f64, angle: f64, duration: f64) -> Command {
    Command::Drive { displacement: Twist::new(length, angle), duration }
}

const NOISE: TwistNoise = TwistNoise { speed: 0.02, speed_share: 0.05, turn: 0.1, turn_share: 0.05 };

/// All kinds of errors that act while the robot moves.
fn all() -> Imperfection {
    Imperfection {
        diameters: [0.01, -0.015, 0.02, 0.003],
        slip: 0.03,
        slip_deviation: 0.04,
        command: NOISE,
        odometry: NOISE,
        resolution: Resolution { length: 1e-3, angle: 1e-3 },
        bound: DriveBound::default(),
    }
}

/// The systematic part of [`all`].
fn systematic() -> Imperfection {
    Imperfection { diameters: all().diameters, slip: all().slip, ..Imperfection::default() }
}

fn close(found: DVec2, expected: DVec2, metres: f64) {
    assert!((found - expected).length() < metres, "{found} instead of {expected}");
}

#[test]
fn unequal_wheels_drive_a_circle_of_known_radius() {
    let diameters: Wheels = [0.0, 0.01, 0.0, 0.0];
    let mut motion = robot(model(), vec![], 1, Imperfection { diameters, ..Imperfection::default() });
    motion.command(Time(3), drive(20.0, 0.0, 100.0), &[]).expect("valid");
    let radius = 0.1 * (2.0 + 0.01) / (2.0 * 0.01);
    for second in [1, 17, 99] {
        let at = Time(3) + Time::from_millis(1_000 * second);
        let angle = 0.2 * 1.005 * second as f64 / radius;
        let expected = DVec2::new(radius * math::sin(angle), radius * (1.0 - math::cos(angle)));
        close(motion.pose(at).position, expected, 1e-12);
        close(motion.odometry(at).position, DVec2::new(0.2 * second as f64, 0.0), 1e-13);
    }
    assert_eq!(motion.revision(), 1, "one piece");
    let end = motion.drive_end().expect("the drive ends");
    assert_eq!(end, Time(100_000_003), "drives end by what the wheels tell");
    assert_eq!(motion.odometry(end).position, DVec2::new(20.0, 0.0), "the mark itself");
    assert!((motion.path_length(end) - 20.1).abs() < 1e-12);
    assert!((motion.wheel_angles(end)[0] - 20.0 / 0.025).abs() < 1e-9, "encoders know nothing of it");
}

#[test]
fn slip_reduces_distance_and_angle() {
    let mut motion = robot(model(), vec![], 1, Imperfection { slip: 0.04, ..Imperfection::default() });
    motion.command(Time::ZERO, drive(0.5, 0.0, 1.0), &[]).expect("valid");
    motion.command(Time::from_millis(1_000), drive(0.0, PI, 1.0), &[]).expect("valid");
    let end = Time::from_millis(2_000);
    assert!(motion.is_drive_done(end));
    close(motion.pose(end).position, DVec2::new(0.48, 0.0), 1e-15);
    assert!((motion.pose(end).heading.radians() - 0.96 * PI).abs() < 1e-14);
    assert_eq!(motion.odometry(end).heading.radians(), PI);
    let mut spinning = robot(model(), vec![], 1, Imperfection { slip: 1.0, ..Imperfection::default() });
    spinning.command(Time::ZERO, Command::Wheels([9.0, 9.0, 0.0, 0.0]), &[]).expect("valid");
    assert_eq!(spinning.pose(end).position, DVec2::ZERO);
    assert_eq!(spinning.wheel_angles(end)[0], 18.0);
}

#[test]
fn drive_with_full_slip_ends_at_its_start() {
    let mut motion = robot(model(), vec![], 1, Imperfection { slip: 1.0, ..Imperfection::default() });
    motion.command(Time(7), drive(0.5, 1.0, 1.0), &[]).expect("valid");
    let end = motion.drive_end().expect("the drive ends");
    assert_eq!(end, Time(1_000_007));
    assert_eq!(motion.pose(end), Pose::default());
    assert_eq!(motion.path_length(end), 0.0);
    assert_eq!(motion.odometry(end), Pose::default().moved(Twist::new(0.5, 1.0)), "it believes that it has arrived");
    assert!(!motion.is_stalled(end) && motion.contacts(end) == 0);
}

#[test]
fn very_unequal_wheels_drive_the_circle_of_the_formula() {
    for [left, right] in [[1.0, -0.5], [-0.5, 0.0], [0.5, -0.5], [-0.9, 1.0]] {
        let diameters: Wheels = [left, right, 0.0, 0.0];
        let mut motion = robot(model(), vec![], 1, Imperfection { diameters, ..Imperfection::default() });
        motion.command(Time::ZERO, Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("valid");
        let radius = 0.1 * (2.0 + left + right) / (2.0 * (right - left));
        for second in [1, 17, 600] {
            let at = Time::from_millis(1_000 * second);
            let angle = 0.2 * (1.0 + 0.5 * (left + right)) * second as f64 / radius;
            let expected = DVec2::new(radius * math::sin(angle), radius * (1.0 - math::cos(angle)));
            close(motion.pose(at).position, expected, 1e-11);
            assert_eq!(motion.revision(), 1, "one piece");
        }
    }
}

#[test]
fn maximum_noise_does_not_move_robots_through_walls() {
    let huge = TwistNoise { speed: 100.0, speed_share: 10.0, turn: 873.0, turn_share: 10.0 };
    let imperfection = Imperfection {
        diameters: [1.0, -0.5, 1.0, -0.5],
        slip: -1.0,
        slip_deviation: 1.0,
        command: huge,
        odometry: huge,
        ..Imperfection::default()
    };
    for (seed, kind) in [DriveKind::Differential, DriveKind::Omni, DriveKind::Ackermann].into_iter().enumerate() {
        let mut motion = robot(Model { kind, ..model() }, room(0.5), seed as u64, imperfection);
        for (n, instant) in (0..3_000).map(|n| (n, Time(n * 3_331))) {
            // The robot drives back and forth, so that no wall holds it for long.
            if n % 60 == 0 {
                let speed = if n % 120 == 0 { 0.2 } else { -0.2 };
                motion.command(instant, Command::Twist(Twist::new(speed, 0.3)), &[]).expect("valid");
            }
            let pose = motion.pose(instant);
            assert!(pose.position.abs().max_element() < 0.5 - 0.08, "{kind:?} at {instant}: {pose:?}");
            assert!(motion.odometry(instant).position.is_finite());
        }
        assert!(motion.contacts(Time::from_millis(9_990)) > 10, "{kind:?}");
    }
}

#[test]
fn default_imperfection_is_bit_identical_to_none() {
    let perfect = Motion::new(RobotId(1), Arc::new(model()), Arc::new(Walls::new(vec![])), Pose::default());
    let mut motions = [perfect, robot(model(), vec![], 9, Imperfection::default())];
    let states = motions.each_mut().map(|motion| {
        motion.command(Time(5), drive(1.0, 2.0, 3.0), &[]).expect("valid");
        (motion.drive_end(), motion.state(Time(1_234_567)), motion.state(Time(4_000_000)))
    });
    assert_eq!(states[0], states[1]);
}

#[test]
fn check_names_the_invalid_number() {
    let motion = || robot(model(), vec![], 1, Imperfection::default());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -2.0, 1e9] {
        let noise = TwistNoise { turn: bad, ..TwistNoise::default() };
        for wrong in [
            Imperfection { diameters: [0.0, bad, 0.0, 0.0], ..Imperfection::default() },
            Imperfection { slip: bad, ..Imperfection::default() },
            Imperfection { slip_deviation: bad, ..Imperfection::default() },
            Imperfection { command: noise, ..Imperfection::default() },
            Imperfection { odometry: noise, ..Imperfection::default() },
            Imperfection { resolution: Resolution { length: bad, angle: 0.0 }, ..Imperfection::default() },
        ] {
            assert!(motion().with_imperfection(1, wrong).is_err(), "{wrong:?}");
        }
    }
}

/// Mean and variance.
fn moments(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (mean, values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (values.len() - 1) as f64)
}

/// Checks mean and variance of a sample, and its fraction within one standard deviation, to five standard errors.
fn check_normal(what: &str, values: &[f64], mean: f64, variance: f64) {
    let (count, deviation) = (values.len() as f64, variance.sqrt());
    let (found_mean, found_variance) = moments(values);
    let mean_error = 5.0 * deviation / count.sqrt();
    assert!((found_mean - mean).abs() < mean_error, "{what}: mean {found_mean} instead of {mean} +- {mean_error}");
    let ratio = found_variance / variance;
    assert!((ratio - 1.0).abs() < 5.0 * (2.0 / count).sqrt(), "{what}: variance {ratio} of {variance}");
    let within = values.iter().filter(|value| (*value - mean).abs() < deviation).count() as f64 / count;
    assert!((within - 0.682_689).abs() < 5.0 * (0.682_689 * 0.317_311 / count).sqrt(), "{what}: {within} within one");
}

/// Final true and odometry poses of a straight drive of `ticks` ticks at 0.2 m/s, for many seeds.
fn ends(imperfection: Imperfection, ticks: i64) -> Vec<(Pose, Pose)> {
    let seconds = (ticks * TICK.0) as f64 / 1e6;
    let end = Time(ticks * TICK.0);
    (0..4_000)
        .map(|seed| {
            let mut motion = robot(model(), vec![], seed, imperfection);
            motion.command(Time::ZERO, drive(0.2 * seconds, 0.0, seconds), &[]).expect("valid");
            (motion.pose(end), motion.odometry(end))
        })
        .collect()
}

fn check_spread(poses: &[Pose], noise: TwistNoise, ticks: f64) {
    let h = TICK.seconds();
    let of = |part: fn(&Pose) -> f64| poses.iter().map(part).collect::<Vec<_>>();
    let speed_squared = noise.speed * noise.speed + (noise.speed_share * 0.2) * (noise.speed_share * 0.2);
    let turn_squared = noise.turn * noise.turn;
    // The spread of the heading reduces the mean distance: a second-order effect.
    let lateral_variance = 0.04 * h.powi(4) * turn_squared * (ticks.powi(3) / 3.0 - ticks / 12.0);
    let heading = h * h * ticks * turn_squared;
    let shortening = 0.2 * ticks * h * heading / 4.0;
    check_normal("along", &of(|pose| pose.position.x), 0.2 * ticks * h - shortening, h * h * ticks * speed_squared);
    check_normal("across", &of(|pose| pose.position.y), 0.0, lateral_variance);
    check_normal("heading", &of(|pose| pose.heading.radians()), 0.0, heading);
}

#[test]
fn spread_of_command_noise_matches_the_formula() {
    let noise = TwistNoise { speed: 0.05, speed_share: 0.3, turn: 0.05, turn_share: 0.4 };
    let ends = ends(Imperfection { command: noise, ..Imperfection::default() }, 200);
    let (truth, odometry): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
    check_spread(&truth, noise, 200.0);
    assert!(odometry.iter().all(|pose| (pose.position - DVec2::new(0.4, 0.0)).length() < 1e-14));
}

#[test]
fn spread_of_odometry_noise_matches_the_formula() {
    let noise = TwistNoise { speed: 0.05, speed_share: 0.3, turn: 0.05, turn_share: 0.4 };
    let ends = ends(Imperfection { odometry: noise, ..Imperfection::default() }, 200);
    let (truth, odometry): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
    check_spread(&odometry, noise, 200.0);
    assert!(truth.iter().all(|pose| (pose.position - DVec2::new(0.4, 0.0)).length() < 1e-14));
}

#[test]
fn spread_of_slip_matches_the_formula() {
    let deviation = 0.05;
    let imperfection = Imperfection { slip: 0.1, slip_deviation: deviation, ..Imperfection::default() };
    let truth: Vec<_> = ends(imperfection, 100).into_iter().map(|end| end.0).collect();
    // The wheels slip independently. Half of each error enters the speed; the difference of both errors, divided by the
    // track, enters the turning speed.
    let distance = 0.2 * TICK.seconds() * deviation;
    let heading = 2.0 * (distance / 0.1) * (distance / 0.1) * 100.0;
    check_normal("heading", &truth.iter().map(|pose| pose.heading.radians()).collect::<Vec<_>>(), 0.0, heading);
    let shortening = 0.18 * heading / 4.0;
    let along: Vec<_> = truth.iter().map(|pose| pose.position.x).collect();
    check_normal("along", &along, 0.18 - shortening, 0.5 * distance * distance * 100.0);
}

#[test]
fn slip_command_and_odometry_noise_are_independent() {
    let noise = TwistNoise { speed: 0.05, turn: 0.05, ..TwistNoise::default() };
    let both = Imperfection { command: noise, odometry: noise, ..Imperfection::default() };
    let (truth, odometry): (Vec<_>, Vec<_>) = ends(both, 20).into_iter().unzip();
    let product: Vec<_> =
        truth.iter().zip(&odometry).map(|(a, b)| (a.position.x - 0.04) * (b.position.x - 0.04)).collect();
    let (covariance, of_product) = moments(&product);
    assert!(covariance.abs() < 5.0 * (of_product / product.len() as f64).sqrt(), "covariance {covariance}");
    // Noise of one kind does not change the other.
    let (alone, with) = (ends(Imperfection { odometry: TwistNoise::default(), ..both }, 20), ends(both, 20));
    assert!(alone.iter().zip(&with).all(|(a, b)| a.0 == b.0));
}

#[test]
fn robot_commanded_to_rest_has_no_noise() {
    let mut motion = robot(model(), vec![], 1, all());
    motion.command(Time(7), Command::Twist(Twist::new(0.2, 0.3)), &[]).expect("valid");
    let stop = Time(123_457);
    motion.command(stop, Command::Twist(Twist::ZERO), &[]).expect("valid");
    let (pose, state) = (motion.pose(stop), motion.state(stop));
    assert_eq!((motion.pose(Time(9_000_000)), motion.state(Time(9_000_000))), (pose, state));
    assert!(!motion.is_moving(stop));
    motion.place(Time(9_000_001), Pose::new(1.0, 2.0, 3.0)).expect("valid");
    assert_eq!(motion.pose(Time(9_500_000)), Pose::new(1.0, 2.0, 3.0));
    assert_eq!(motion.state(Time(9_500_000)).odometry, state.odometry);
}

#[test]
fn odometry_readings_are_quantised() {
    let resolution = Resolution { length: 0.01, angle: 0.1 };
    let mut motion = robot(model(), vec![], 1, Imperfection { resolution, ..Imperfection::default() });
    motion.command(Time::ZERO, Command::Twist(Twist::new(0.1, 0.4)), &[]).expect("valid");
    for instant in 0..200 {
        let at = Time(instant * 31_337);
        let (read, exact) = (motion.odometry(at), motion.state(at).odometry);
        for (read, exact, step) in [
            (read.position.x, exact.position.x, 0.01),
            (read.position.y, exact.position.y, 0.01),
            (read.heading.radians(), exact.heading.radians(), 0.1),
        ] {
            assert!((read - exact).abs() <= 0.5 * step + 1e-9);
            if step == 0.01 {
                assert!((read / step - (read / step).round()).abs() < 1e-9, "{read}");
            }
        }
    }
}

fn room(size: f64) -> Vec<Segment> {
    let corner = |x: f64, y: f64| DVec2::new(x * size, y * size);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect()
}

/// Poses of robots in a small room, where they often hit the walls, in slots of `slot`; the poses are also queried at
/// every multiple of `query_interval` microseconds.
fn script(slot: Time, query_interval: Option<i64>, imperfection: Imperfection) -> Vec<(Pose, Pose, Wheels, f64)> {
    let walls = Arc::new(Walls::new(room(0.5)));
    let lame = Model { wheel_lag: 0.05, axis_offset: 0.03, ..model() };
    let omni = Model { kind: DriveKind::Omni, ..model() };
    let car = Model { kind: DriveKind::Ackermann, ..model() };
    let mut results = Vec::new();
    // One robot at a time: contacts between robots depend on the slot.
    for (index, model) in [model(), lame, omni, car].into_iter().enumerate() {
        let motion = Motion::new(RobotId(1), Arc::new(model), walls.clone(), Pose::new(0.1, -0.05, 0.3));
        let mut motion = motion.with_imperfection(index as u64, imperfection).expect("valid");
        if index == 1 {
            motion.start_control(Time::ZERO, Gains { vv: 2.0, tv: 0.3, vw: 2.0, tw: 0.1 }).expect("valid");
        }
        let mut world = World::new(walls.clone(), slot, [&mut motion]);
        for n in 0..60_i64 {
            let at = Time(1_000 + n * 50_021);
            while world.slot_end() <= at {
                if let Some(step) = query_interval {
                    let mut instant = world.slot_start();
                    while instant < world.slot_end() {
                        motion.pose(instant);
                        motion.drive_end();
                        instant += Time(step);
                    }
                }
                world.advance(&mut [&mut motion]);
            }
            let touching = world.touching(&mut motion, at);
            let state = motion.state(at);
            results.push((motion.pose(at), state.odometry, state.wheels, motion.drive_remaining(at)));
            let (v, omega) = (0.5 * ((n * 7 % 11) as f64 / 5.0 - 1.0), (n * 5 % 7) as f64 / 2.0 - 1.5);
            let command = match n % 4 {
                0 => drive(0.1 * v, 0.1 * omega, 0.0),
                1 => Command::Twist(Twist::new(v, omega)),
                2 => Command::Wheels([20.0 * v, 15.0 * v, 0.0, 3.0 * omega]),
                _ => continue,
            };
            // The Ackermann drive rejects some of the commands.
            let _ = motion.command(at, command, &touching);
        }
    }
    results
}

#[test]
fn imperfect_poses_are_bit_identical_for_every_slot_length_and_query() {
    for imperfection in [all(), systematic()] {
        let reference = script(Time::from_millis(50), None, imperfection);
        for slot in [100, 1_000, 7_919, 10_000, 200_000, 1_000_000] {
            assert_eq!(script(Time(slot), None, imperfection), reference, "slots of {slot} us");
        }
        assert_eq!(script(Time::from_millis(20), Some(1_777), imperfection), reference, "often queried");
    }
}

#[test]
fn errors_neither_move_robots_into_walls_nor_lock_them_there() {
    let walls = room(0.5);
    for imperfection in [all(), systematic()] {
        for seed in 0..20 {
            let mut motion = robot(model(), walls.clone(), seed, imperfection);
            let mut at = Time::from_millis(5);
            for round in 0..20 {
                // The robot drives into a wall and stalls permanently.
                motion.command(at, drive(3.0, 0.0, 0.0), &[]).expect("valid");
                assert_eq!(motion.drive_end(), None, "round {round} of seed {seed}");
                at += Time::from_millis(6_000);
                assert!(motion.is_stalled(at), "round {round} of seed {seed}");
                let rest = motion.pose(at);
                assert_eq!(motion.pose(at + Time::from_millis(70)), rest);
                assert!(!motion.is_moving(at));
                // In this position the robot can turn on the spot in either direction: the errors do not lock it.
                let angle = if round % 2 == 0 { 2.3 } else { -2.1 };
                motion.command(at, drive(0.0, angle, 1.0), &[]).expect("valid");
                let end = motion.drive_end().unwrap_or_else(|| panic!("no end of turn {round} of seed {seed}"));
                for part in 0..=40 {
                    let instant = Time(at.0 + (end - at).0 * part / 40);
                    let gap = oracle::clearance(&walls, motion.pose(instant).position, 0.08);
                    assert!(gap > SKIN - 1e-9, "gap {gap} in round {round} of seed {seed}");
                }
                at = end;
            }
        }
    }
}

#[test]
fn robot_with_errors_can_turn_away_from_another() {
    // Because of the errors, the robot moves towards the other one as it turns left.
    let unequal = Imperfection { diameters: [0.0, 0.05, 0.0, 0.0], ..Imperfection::default() };
    for (seed, imperfection) in (0..10).map(|seed| (seed, all())).chain([(0, unequal)]) {
        let walls = Arc::new(Walls::new(vec![]));
        let mut motions = [0.0, 0.3].map(|x| {
            let id = RobotId(if x == 0.0 { 1 } else { 2 });
            let motion = Motion::new(id, Arc::new(model()), walls.clone(), Pose::new(x, 0.0, 0.0));
            motion.with_imperfection(seed, imperfection).expect("valid")
        });
        let mut world = World::new(walls, Time::from_millis(50), &mut motions);
        let command = |world: &World, motion: &mut Motion, command: Command| {
            let touching = world.touching(motion, world.slot_start());
            motion.command(world.slot_start(), command, &touching).expect("valid");
        };
        command(&world, &mut motions[0], drive(1.0, 0.0, 0.0));
        for slot in 0..100 {
            if slot == 60 {
                assert!(motions[0].is_stalled(world.slot_start()), "at the other one");
                command(&world, &mut motions[0], drive(0.0, 2.0, 1.0));
            }
            world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
            let gap = (motions[0].pose(world.slot_start()).position - DVec2::new(0.3, 0.0)).length() - 0.16;
            assert!(gap > SKIN - 1e-9, "gap {gap}");
        }
        assert!(motions[0].is_drive_done(world.slot_start()), "seed {seed}");
    }
}

#[test]
fn drive_end_of_a_long_noisy_drive_is_found_in_parts() {
    let mut motion = robot(model(), vec![], 1, Imperfection { command: NOISE, ..Imperfection::default() });
    let mut world = World::new(Arc::new(Walls::new(vec![])), Time::from_millis(1_000), [&mut motion]);
    motion.command(Time::ZERO, drive(15.0, 0.0, 1_500.0), &[]).expect("valid");
    let first = motion.drive_end().expect("an instant to ask again");
    assert!(first > Time::from_millis(999_000) && !motion.is_drive_done(first), "{first}");
    while world.slot_end() <= first {
        world.advance(&mut [&mut motion]);
    }
    let end = motion.drive_end().expect("the drive ends");
    assert!((end - Time::from_millis(1_500_000)).0.abs() <= 1, "{end:?}");
    assert!(motion.is_drive_done(end) && !motion.is_drive_done(end - Time(2)));
}

#[test]
fn robot_with_errors_pushes_a_light_crate_and_stalls_at_a_heavy_one() {
    for (mass, is_pushed) in [(0.2, true), (50.0, false)] {
        let crate_ = Arc::new(Properties {
            mass,
            centre_of_mass: DVec2::ZERO,
            parts: vec![Part {
                shape: Shape::Rectangle { half: DVec2::splat(0.1) },
                object_from_part: Pose::default(),
            }],
            resistance: Resistance::Sliding(0.4),
            restitution: 0.0,
            contact_friction: 0.3,
            lift: 0.0,
        });
        let scene = |slot: i64| {
            let mut motion = robot(model(), vec![], 5, all());
            let world = World::new(Arc::new(Walls::new(vec![])), Time::from_millis(slot), [&mut motion]);
            let mut world = world.with_objects([(crate_.clone(), Pose::new(0.3, 0.0, 0.0))]);
            motion.command(Time::ZERO, Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("valid");
            while world.slot_start() < Time::from_millis(2_000) {
                world.advance(&mut [&mut motion]);
            }
            (
                motion.state(world.slot_start()),
                motion.is_stalled(world.slot_start()),
                world.object_pose(ObjectId(1), world.slot_start()),
                motion.impacts(Time::ZERO, world.slot_start()),
            )
        };
        let (state, is_stalled, pose, impacts) = scene(50);
        assert_eq!(is_stalled, !is_pushed, "{state:?}");
        assert!(impacts.iter().any(|impact| matches!(impact.thing, Thing::Object(_))));
        assert_eq!(pose.position.x > 0.35, is_pushed, "{pose:?}");
        assert!(state.world_from_axle.position.x > if is_pushed { 0.25 } else { 0.1 }, "{state:?}");
        assert!(state.wheels[0] * 0.025 + 1e-9 >= state.world_from_axle.position.x * 0.9, "{state:?}");
        assert_eq!(
            (state, pose),
            {
                let other = scene(10);
                (other.0, other.2)
            },
            "slots of whole milliseconds"
        );
    }
}

#[test]
fn errors_set_at_the_start_equal_initial_errors() {
    for imperfection in [all(), systematic(), Imperfection::default()] {
        let ends = |mut motion: Motion| {
            motion.command(Time(3), drive(0.3, 0.2, 1.5), &[]).expect("valid");
            motion.command(Time::from_millis(900), Command::Twist(Twist::new(0.3, 1.0)), &[]).expect("valid");
            [Time::from_millis(500), Time::from_millis(2_000)].map(|at| (motion.state(at), motion.odometry(at)))
        };
        let mut set = robot(model(), room(4.0), 5, systematic());
        set.set_imperfection(Time::ZERO, 11, imperfection).expect("valid");
        assert_eq!(ends(robot(model(), room(4.0), 11, imperfection)), ends(set));
    }
}

#[test]
fn changed_errors_affect_only_later_motion() {
    let [before, change, end] = [480, 500, 1_500].map(Time::from_millis);
    let driving = |imperfection| {
        let mut motion = robot(model(), vec![], 3, imperfection);
        motion.command(Time::ZERO, Command::Twist(Twist::new(0.25, 0.0)), &[]).expect("valid");
        motion
    };
    let (mut perfect, mut slipping) = (driving(Imperfection::default()), driving(Imperfection::default()));
    slipping.set_imperfection(change, 3, Imperfection { slip: 0.1, ..Imperfection::default() }).expect("valid");
    assert!(slipping.is_active());
    assert_eq!([before, change].map(|at| perfect.state(at)), [before, change].map(|at| slipping.state(at)));
    // 0.125 m, then 0.9 times 0.25 m; odometry does not measure the slip.
    close(slipping.pose(end).position, DVec2::new(0.35, 0.0), 1e-12);
    close(slipping.odometry(end).position, DVec2::new(0.375, 0.0), 1e-12);

    // The effect of earlier errors remains after they end; the closed form continues from that pose.
    let (mut noisy, mut mended) = (driving(all()), driving(all()));
    mended.set_imperfection(change, 3, Imperfection::default()).expect("valid");
    assert_eq!([before, change].map(|at| noisy.state(at)), [before, change].map(|at| mended.state(at)));
    let expected = mended.pose(change).moved(Twist::new(0.25, 0.0));
    close(mended.pose(end).position, expected.position, 1e-12);
    assert_ne!(noisy.state(end), mended.state(end));

    let revision = mended.revision();
    let wrong = Imperfection { slip: f64::NAN, ..Imperfection::default() };
    assert!(mended.set_imperfection(end, 3, wrong).is_err());
    assert_eq!(mended.revision(), revision, "nothing has changed");
}

#[test]
fn drive_ends_at_its_target_if_errors_change() {
    let mut motion = robot(model(), vec![], 3, Imperfection::default());
    motion.command(Time::ZERO, drive(0.5, 0.0, 2.0), &[]).expect("valid");
    for (number, at) in (1..20).map(|number| (number, Time::from_millis(100 * number))) {
        let imperfection = if number % 2 == 0 { systematic() } else { all() };
        motion.set_imperfection(at, 3, imperfection).expect("valid");
    }
    // Wheel odometry decides when a drive ends.
    assert_eq!(motion.drive_end(), Some(Time::from_millis(2_000)));
}

/// Target errors of two successive drives, in runs with different seeds: m for straight lines, rad for turns. Checks
/// that odometry gives the same errors.
fn target_errors(bound: DriveBound, first: Twist, second: Twist) -> Vec<[f64; 2]> {
    let run = |seed| {
        let mut motion = robot(model(), vec![], seed, Imperfection { bound, ..Imperfection::default() });
        let mut at = Time::ZERO;
        [first, second].map(|displacement| {
            let before = motion.pose(at);
            motion.command(at, Command::Drive { displacement, duration: 2.0 }, &[]).expect("a drive");
            // A drive of length 0 ends at once.
            at = motion.drive_end().unwrap_or(at) + Time::from_millis(10);
            let (after, odometry) = (motion.pose(at), motion.odometry(at));
            close(odometry.position, after.position, 1e-12);
            assert_eq!(odometry.heading, after.heading);
            if displacement.vx == 0.0 {
                close(after.position, before.position, 1e-12);
                after.heading.radians() - before.heading.radians() - displacement.omega
            } else {
                assert_eq!(after.heading, before.heading, "a straight line stays straight");
                (after.position - before.position).length() - displacement.vx
            }
        })
    };
    (0..2000).map(run).collect()
}

/// Maximum distance of the empirical distribution of `sample` from the uniform one between -1 and 1 (Kolmogorov and
/// Smirnov).
fn off_uniform(mut sample: Vec<f64>) -> f64 {
    sample.sort_by(f64::total_cmp);
    let count = sample.len() as f64;
    let off = |(index, value): (usize, &f64)| {
        let fraction = (value + 1.0) / 2.0;
        (fraction - index as f64 / count).abs().max((fraction - (index + 1) as f64 / count).abs())
    };
    sample.iter().enumerate().map(off).fold(0.0, f64::max)
}

#[test]
fn target_errors_are_uniform_and_odometry_shows_them() {
    let bound = DriveBound { length: 0.004, angle: 2.0 * PI / 180.0 };
    let straight = Twist::new(1.0, 0.0);
    let turn = Twist::new(0.0, PI / 2.0);
    for (first, second) in [(straight, turn), (turn, straight), (straight, straight)] {
        let scale = |displacement: Twist| if displacement.vx == 0.0 { bound.angle } else { bound.length };
        let found = target_errors(bound, first, second);
        let errors = |index: usize, of: Twist| found.iter().map(|pair| pair[index] / scale(of)).collect::<Vec<f64>>();
        let [a, b] = [errors(0, first), errors(1, second)];
        for sample in [&a, &b] {
            assert!(sample.iter().all(|error| error.abs() <= 1.0 + 1e-9));
            // 2.2 / sqrt(n) is exceeded by chance once in 10,000 times.
            let off = off_uniform(sample.clone());
            assert!(off < 2.2 / (sample.len() as f64).sqrt(), "{off}");
        }
        // The mean of the product of two independent uniform numbers has the standard deviation 1 / (3 sqrt(n)).
        let mean = a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64;
        assert!(mean.abs() < 4.0 / 3.0 / (a.len() as f64).sqrt(), "{mean}");
    }
}

#[test]
fn target_error_is_at_most_the_length_of_the_drive() {
    let bound = DriveBound { length: 0.004, angle: 2.0 * PI / 180.0 };
    let small = Twist::new(0.001, 0.0);
    let errors = target_errors(bound, small, Twist::new(0.0, 0.01));
    assert!(errors.iter().all(|pair| pair[0].abs() <= 0.001 + 1e-12 && pair[1].abs() <= 0.01 + 1e-12));
    assert!(errors.iter().any(|pair| pair[0] < -0.000_999), "it may not move at all");
}

#[test]
fn speed_and_motor_commands_have_no_target_error() {
    let bound = DriveBound { length: 0.004, angle: 0.03 };
    let mut erring = robot(model(), vec![], 3, Imperfection { bound, ..Imperfection::default() });
    let mut exact = robot(model(), vec![], 3, Imperfection::default());
    for motion in [&mut erring, &mut exact] {
        motion.command(Time::ZERO, Command::Twist(Twist::new(0.3, 0.5)), &[]).expect("a speed");
    }
    let at = Time::from_millis(1234);
    assert_eq!(erring.pose(at), exact.pose(at));
}

#[test]
fn ackermann_drive_keeps_its_tightest_curve() {
    let bound = DriveBound { length: 0.004, angle: 0.03 };
    let car = Model { kind: DriveKind::Ackermann, ..model() };
    let radius = car.wheelbase / math::tan(car.max_steering);
    for seed in 0..50 {
        let mut motion = robot(car.clone(), vec![], seed, Imperfection { bound, ..Imperfection::default() });
        let command = Command::Drive { displacement: Twist::new(0.5 * radius, 0.5), duration: 2.0 };
        assert_eq!(motion.command(Time::ZERO, command, &[]), Ok(()));
    }
}
