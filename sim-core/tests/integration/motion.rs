//! Closed forms of a robot's motion, and their independence of the slot length.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec2;
use sim_core::{
    RobotId,
    contact::{SKIN, Thing},
    drive::{Command, CommandError, DriveKind, Model, Motion},
    pose::{Pose, Twist},
    scene::{Segment, Walls},
    time::Time,
    world::World,
};

/// A differential robot of the size of an EyeBot.
fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.054,
        max_wheel_rate: 62.8,
        ticks_per_turn: 1100.0,
        track: 0.09,
        wheelbase: 0.093,
        axis_offset: 0.0,
        max_speed: 0.6,
        max_turn: 300.0_f64.to_radians(),
        body_radius: 0.093,
        wheel_lag: 0.0,
        max_steering: PI / 4.0,
        mass: 1.0,
        traction: 0.6,
    }
}

fn robot(model: Model, walls: Vec<Segment>, pose: Pose) -> Motion {
    model.check().expect("a valid model");
    Motion::new(RobotId(1), Arc::new(model), Arc::new(Walls::new(walls)), pose)
}

fn drive(v: f64, omega: f64, duration: f64) -> Command {
    Command::Drive { displacement: Twist::new(v * duration, omega * duration), duration }
}

fn room(size: f64) -> Vec<Segment> {
    let corner = |x: f64, y: f64| DVec2::new(x * size, y * size);
    let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect()
}

#[test]
fn square_drive_returns_to_its_start() {
    let mut motion = robot(Model { axis_offset: 0.03, ..model() }, vec![], Pose::new(1.0, 2.0, 0.3));
    let mut at = Time(17);
    for _ in 0..4 {
        for command in [drive(0.2, 0.0, 2.0), drive(0.0, PI / 2.0, 1.0)] {
            motion.command(at, command, &[]).expect("a valid command");
            at = motion.drive_end().expect("the drive ends");
            assert!(motion.is_drive_done(at) && !motion.is_drive_done(at - Time(1)));
        }
    }
    assert_eq!(at, Time(17 + 12_000_000));
    let end = motion.pose(at);
    assert!((end.position - DVec2::new(1.0, 2.0)).length() < 1e-15, "within rounding: {end:?}");
    assert!((end.heading.radians() - 0.3 - 2.0 * PI).abs() < 1e-15);
    assert!((motion.path_length(at) - 1.6).abs() < 1e-15);
    assert_eq!(motion.odometry(at).heading.turns(), 1);
}

#[test]
fn drive_ends_exactly_at_the_commanded_length() {
    let mut motion = robot(model(), vec![], Pose::default());
    let displacement = Twist::new(0.1 + 0.2, 0.7);
    motion.command(Time(5), Command::Drive { displacement, duration: 1.0 / 3.0 }, &[]).expect("a valid command");
    let end = motion.drive_end().expect("the drive ends");
    assert_eq!(motion.pose(end), Pose::default().moved(displacement));
    assert_eq!(motion.odometry(end), Pose::default().moved(displacement));
    assert_eq!(motion.drive_remaining(end), 0.0);
    assert!(motion.drive_remaining(end - Time(1)) > 0.0);
    assert_eq!(motion.speed(end), Twist::ZERO);
}

#[test]
fn a_lasting_contact_does_not_push_its_beginning_out_of_the_log() {
    let mut motion = robot(model(), room(2.0), Pose::new(1.9, 1.0, 0.0));
    let mut world = World::new(Arc::new(Walls::new(room(2.0))), Time::from_millis(50), [&mut motion]);
    for slot in 0..60 {
        let twist = Twist::new(0.3, if slot % 2 == 0 { 0.6 } else { -0.6 });
        motion.command(world.slot_start(), Command::Twist(twist), &[]).expect("a valid command");
        world.advance(&mut [&mut motion]);
    }
    let now = world.slot_start();
    let impacts = motion.impacts(Time::ZERO, now);
    assert_eq!((motion.contacts(now), impacts.iter().filter(|impact| impact.fresh).count()), (1, 1), "{impacts:?}");
}

#[test]
fn robot_stops_one_skin_before_the_wall_and_stalls() {
    let mut motion = robot(model(), room(2.0), Pose::new(1.0, 1.0, 0.0));
    motion.command(Time::ZERO, drive(0.5, 0.0, 10.0), &[]).expect("a valid command");
    assert_eq!(motion.drive_end(), None);
    let at = Time::from_millis(9_000);
    assert!((motion.pose(at).position.x - (2.0 - 0.093 - SKIN)).abs() < 1e-12);
    assert!(motion.is_stalled(at) && !motion.is_drive_done(at) && !motion.is_moving(at));
    assert!((motion.drive_remaining(at) - (5.0 - 0.907)).abs() < 2e-6);
    assert_eq!(motion.contacts(at), 1);
    let impact = motion.impacts(Time::ZERO, at)[0];
    assert!(matches!(impact.thing, Thing::Wall(_)) && impact.bearing.abs() < 1e-9);
    assert!((impact.time.seconds() - 0.907 / 0.5).abs() < 1e-5);
    // Towards the wall again, along the wall, and away from it.
    motion.command(at, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("a valid command");
    assert!(motion.is_stalled(at));
    assert_eq!(motion.contacts(at), 1);
    motion.command(at + Time(1), drive(0.0, PI / 2.0, 1.0), &[]).expect("a valid command");
    let turned = motion.drive_end().expect("a disc turns in contact");
    motion.command(turned, drive(0.5, 0.0, 1.0), &[]).expect("a valid command");
    let along = motion.drive_end().expect("a disc drives along a wall");
    assert!((motion.pose(along).position.y - 1.5).abs() < 1e-9);
    motion.command(along, drive(0.5, PI / 2.0, 0.5), &[]).expect("a valid command");
    assert!(motion.drive_end().is_some());
    assert_eq!(motion.contacts(Time::from_millis(20_000)), 1);
}

#[test]
fn rejected_commands_change_nothing() {
    let mut motion = robot(model(), vec![], Pose::default());
    motion.command(Time::ZERO, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("a valid command");
    let revision = motion.revision();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let commands = [
            Command::Twist(Twist::new(bad, 0.0)),
            Command::Twist(Twist::new(0.0, bad)),
            Command::Wheels([bad, 0.0, 0.0, 0.0]),
            Command::Drive { displacement: Twist::new(bad, 0.0), duration: 1.0 },
            Command::Drive { displacement: Twist::new(1.0, 0.0), duration: bad },
        ];
        for command in commands {
            assert_eq!(motion.command(Time(7), command, &[]), Err(CommandError::NotFinite));
        }
        assert!(motion.set_odometry(Time(7), Pose { position: DVec2::splat(bad), ..Pose::default() }).is_err());
    }
    assert_eq!(motion.command(Time(7), Command::Steer(0.1), &[]), Err(CommandError::NoSteering));
    let sideways = Twist { vy: 0.1, ..Twist::ZERO };
    assert_eq!(motion.command(Time(7), Command::Twist(sideways), &[]), Err(CommandError::Sideways));
    assert_eq!(motion.revision(), revision);
}

/// Poses of a script of commands, read at fixed instants, in a world that is advanced in slots of `slot`.
fn script(slot: Time) -> Vec<Pose> {
    let walls = Arc::new(Walls::new(room(2.0)));
    let lame = Model { wheel_lag: 0.08, ..model() };
    let mut motions = [
        Motion::new(RobotId(1), Arc::new(model()), walls.clone(), Pose::new(0.5, 0.5, 0.2)),
        Motion::new(RobotId(2), Arc::new(lame), walls.clone(), Pose::new(1.5, 1.5, -2.0)),
    ];
    let mut world = World::new(walls, slot, &mut motions);
    let mut commands = vec![];
    for n in 0_i64..40 {
        let (v, omega) = (0.3 * ((n * 7 % 11) as f64 / 5.0 - 1.0), (n * 5 % 7) as f64 / 2.0 - 1.5);
        let command = if n % 3 == 0 { drive(v, omega, 0.031) } else { Command::Twist(Twist::new(v, omega)) };
        commands.push((Time(1_000 + n * 50_021), command));
    }
    let mut poses = Vec::new();
    let mut next = 0;
    while next < commands.len() {
        while next < commands.len() && commands[next].0 < world.slot_end() {
            let (at, command) = commands[next];
            for motion in &mut motions {
                let touching = world.touching(motion, at);
                motion.command(at, command, &touching).expect("a valid command");
                poses.extend([motion.pose(at), motion.odometry(at)]);
            }
            next += 1;
        }
        world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
    }
    poses
}

#[test]
fn poses_are_bit_identical_for_every_slot_length() {
    let reference = script(Time::from_millis(50));
    for slot in [100, 1_000, 10_000, 20_000, 200_000, 1_000_000] {
        assert_eq!(script(Time(slot)), reference, "slots of {slot} us");
    }
}

#[test]
fn poses_match_the_golden_hash() {
    // FNV-1a over the bits: a golden value that changes only with the motion model.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for pose in script(Time::from_millis(50)) {
        for value in [pose.position.x, pose.position.y, pose.heading.remainder()] {
            for byte in value.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    assert_eq!(hash, 0xcb88_9eb9_d401_972a, "{hash:#x}");
}

#[test]
fn zero_tiny_and_backward_drives_end() {
    for length in [0.0, 5e-324, 1e-300, 1e-6, -1e-6, -0.3, 1e-9] {
        let mut motion = robot(model(), vec![], Pose::default());
        let displacement = Twist::new(length, 0.0);
        motion.command(Time(3), Command::Drive { displacement, duration: length.abs() / 0.2 }, &[]).expect("valid");
        let end = motion.drive_end().expect("the drive ends");
        assert!(end.seconds() <= 3e-6 + length.abs() / 0.2 + 1e-6, "{length} m end at {end:?}");
        assert_eq!(motion.pose(end).position, DVec2::new(length, 0.0));
        assert!(motion.is_drive_done(end));
        let mut motion = robot(model(), vec![], Pose::default());
        let displacement = Twist::new(0.0, length);
        motion.command(Time(3), Command::Drive { displacement, duration: 0.0 }, &[]).expect("valid");
        let end = motion.drive_end().expect("the drive ends");
        assert_eq!(motion.pose(end).heading.radians(), length);
    }
}

#[test]
fn limits_lengthen_the_duration_of_drives() {
    let mut motion = robot(model(), vec![], Pose::default());
    let displacement = Twist::new(0.6, 0.3);
    motion.command(Time::ZERO, Command::Drive { displacement, duration: 0.0 }, &[]).expect("valid");
    assert_eq!(motion.drive_end(), Some(Time::from_millis(1_000)));
    let speed = motion.speed(Time::from_millis(500));
    assert!(
        (speed.vx - 0.6).abs() < 1e-15 && (speed.omega - 0.3).abs() < 1e-15,
        "the curve keeps its shape: {speed:?}"
    );
}

#[test]
fn motion_follows_the_arc_at_every_turning_speed() {
    for exponent in -300..=4 {
        let omega = 10.0_f64.powi(exponent);
        let fast = Model { max_turn: f64::INFINITY, max_wheel_rate: 1e9, ..model() };
        let mut motion = robot(fast, vec![], Pose::default());
        motion.command(Time::ZERO, Command::Twist(Twist::new(0.5, omega)), &[]).expect("valid");
        let pose = motion.pose(Time::from_millis(2_000));
        let angle = 2.0 * omega;
        assert!((pose.heading.radians() - angle).abs() <= 1e-15 * angle.max(1.0), "heading at {omega} rad/s");
        let (x, y) = if angle < 1e-3 {
            // The series of the arc, accurate beyond double precision.
            (1.0 - angle * angle / 6.0, angle / 2.0 - angle.powi(3) / 24.0)
        } else {
            let radius = 0.5 / omega;
            (radius * libm::sin(angle), radius * (1.0 - libm::cos(angle)))
        };
        assert!((pose.position - DVec2::new(x, y)).length() < 1e-13, "{pose:?} at {omega} rad/s");
    }
}

#[test]
fn million_turns_return_to_the_start() {
    let mut motion = robot(Model { axis_offset: 0.04, ..model() }, vec![], Pose::new(0.0, 0.0, 1.0));
    let mut world = World::new(Arc::new(Walls::new(vec![])), Time::from_millis(1_000), [&mut motion]);
    let mut at = Time::ZERO;
    // The robot turns by quarter turns, like a program that drives around a square forever.
    for _ in 0..4_000_000 {
        let displacement = Twist::new(0.0, PI / 2.0);
        motion.command(at, Command::Drive { displacement, duration: 0.0 }, &[]).expect("valid");
        at = motion.drive_end().expect("the drive ends");
        if at >= world.slot_end() {
            world.advance(&mut [&mut motion]);
        }
    }
    let pose = motion.pose(at);
    assert_eq!(pose.heading.turns(), 1_000_000);
    assert!((pose.heading.remainder() - 1.0).abs() < 1e-9, "{pose:?}");
    assert!(pose.position.length() < 1e-9, "within 1 nm: {pose:?}");
}

#[test]
fn square_drive_closes_ten_kilometres_from_the_origin() {
    let start = Pose::new(1e4, -1e4, 0.7);
    let mut motion = robot(model(), vec![], start);
    let mut at = Time::ZERO;
    for _ in 0..100 {
        for command in [drive(0.2, 0.0, 1.0), drive(0.0, PI / 2.0, 1.0)] {
            motion.command(at, command, &[]).expect("valid");
            at = motion.drive_end().expect("the drive ends");
        }
    }
    let end = motion.pose(at);
    assert!((end.position - start.position).length() < 1e-9, "{end:?}");
    assert!((end.heading.remainder() - 0.7).abs() < 1e-12);
}

#[test]
fn ackermann_drive_rejects_impossible_curves() {
    let car = Model { kind: DriveKind::Ackermann, wheelbase: 0.16, axis_offset: -0.08, ..model() };
    let mut motion = robot(car, vec![], Pose::default());
    let turn = Command::Drive { displacement: Twist::new(0.0, 1.0), duration: 1.0 };
    assert_eq!(motion.command(Time::ZERO, turn, &[]), Err(CommandError::TurnOnSpot));
    assert_eq!(motion.command(Time::ZERO, Command::Twist(Twist::new(0.0, 1.0)), &[]), Err(CommandError::TurnOnSpot));
    let tight = Command::Drive { displacement: Twist::new(0.15, 1.0), duration: 1.0 };
    assert_eq!(motion.command(Time::ZERO, tight, &[]), Err(CommandError::TooTight { min_radius_mm: 160 }));
    let wide = Command::Drive { displacement: Twist::new(0.16, 1.0), duration: 1.0 };
    motion.command(Time::ZERO, wide, &[]).expect("the tightest curve");
    // A twist whose curve is too tight is driven at the maximum steering angle.
    motion.command(Time(1), Command::Twist(Twist::new(0.1, 3.0)), &[]).expect("valid");
    assert_eq!(motion.steering(Time(1)), PI / 4.0);
    assert!((motion.speed(Time(1)).omega - 0.1 / 0.16).abs() < 1e-12);
    // Motor and servo: the steering angle does not change when the motor stops.
    motion.command(Time(2), Command::Halt, &[]).expect("valid");
    motion.command(Time(3), Command::Steer(-0.3), &[]).expect("valid");
    motion.command(Time(4), Command::Wheels([2.0, 9.0, 9.0, 9.0]), &[]).expect("valid");
    let speed = motion.speed(Time(4));
    assert!((speed.vx - 0.054).abs() < 1e-15);
    assert!((speed.omega + 0.054 * libm::tan(0.3) / 0.16).abs() < 1e-15);
    assert_eq!(motion.wheel_angles(Time(1_000_004))[1..], [0.0; 3]);
}

#[test]
fn omni_drive_moves_sideways() {
    let omni = Model { kind: DriveKind::Omni, ..model() };
    let mut motion = robot(omni, vec![], Pose::new(0.0, 0.0, PI / 2.0));
    let displacement = Twist { vx: 0.0, vy: 0.3, omega: 0.0 };
    motion.command(Time::ZERO, Command::Drive { displacement, duration: 1.0 }, &[]).expect("valid");
    let end = motion.drive_end().expect("the drive ends");
    assert!((motion.pose(end).position - DVec2::new(-0.3, 0.0)).length() < 1e-15);
    let wheels = motion.wheel_angles(end);
    assert!((wheels[1] - 0.3 / 0.027).abs() < 1e-12 && (wheels[0] + wheels[1]).abs() < 1e-12, "{wheels:?}");
}

#[test]
fn wheels_turn_with_the_path_and_stop_at_a_wall() {
    let mut motion = robot(model(), room(2.0), Pose::new(1.0, 1.0, 0.0));
    motion.command(Time::ZERO, Command::Wheels([10.0, 10.0, 0.0, 0.0]), &[]).expect("valid");
    let at = Time::from_millis(60_000);
    let distance = motion.pose(at).position.x - 1.0;
    assert!((motion.wheel_angles(at)[0] - distance / 0.027).abs() < 1e-12);
    assert!((motion.odometry(at).position.x - distance).abs() < 1e-15);
    assert_eq!(motion.path_length(at), distance);
    motion.set_odometry(at, Pose::new(5.0, 6.0, 0.5)).expect("valid");
    assert_eq!(motion.odometry(at), Pose::new(5.0, 6.0, 0.5));
    assert!(motion.is_stalled(at) && motion.contacts(at) == 1, "setting the odometry moves nothing");
}

#[test]
fn robot_can_back_out_of_a_corner() {
    let mut motion = robot(model(), room(2.0), Pose::new(1.5, 1.5, PI / 4.0));
    motion.command(Time::ZERO, Command::Twist(Twist::new(0.3, 0.0)), &[]).expect("valid");
    let mut at = Time::from_millis(5_000);
    assert!(motion.is_stalled(at));
    for _ in 0..8 {
        motion.command(at, drive(0.0, 0.6, 1.0), &[]).expect("valid");
        at = motion.drive_end().expect("a disc turns in a corner");
    }
    for heading in 0..24 {
        let angle = f64::from(heading) * PI / 12.0;
        let mut motion = motion.clone();
        let turn = angle - motion.pose(at).heading.remainder();
        motion.command(at, Command::Drive { displacement: Twist::new(0.0, turn), duration: 1.0 }, &[]).expect("valid");
        let turned = motion.drive_end().expect("the drive ends");
        motion.command(turned, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("valid");
        let end = motion.pose(turned + Time::from_millis(100)).position;
        // The robot can leave the corner with headings between the directions straight away from each of the two walls.
        let leaves = (12..=18).contains(&heading);
        assert_eq!((end - motion.pose(turned).position).length() > 1e-3, leaves, "heading {angle}");
    }
}

#[test]
fn robot_passes_a_gap_one_millimetre_wider_than_itself() {
    let width = 2.0 * 0.093 + 1e-3;
    let at = |x: f64, y: f64| DVec2::new(x, y);
    let walls = vec![
        Segment::new(at(1.0, width / 2.0), at(3.0, width / 2.0)),
        Segment::new(at(1.0, -width / 2.0), at(3.0, -width / 2.0)),
        Segment::new(at(1.0, width / 2.0), at(1.0, 1.0)),
        Segment::new(at(1.0, -width / 2.0), at(1.0, -1.0)),
    ];
    let mut through = robot(model(), walls.clone(), Pose::default());
    through.command(Time::ZERO, drive(0.5, 0.0, 8.0), &[]).expect("valid");
    assert!(through.drive_end().is_some());
    let mut beside = robot(model(), walls, Pose::new(0.0, 0.6e-3, 0.0));
    beside.command(Time::ZERO, drive(0.5, 0.0, 8.0), &[]).expect("valid");
    assert_eq!(beside.drive_end(), None);
}

#[test]
fn drive_with_wheel_lag_ends_at_its_target() {
    let lame = Model { wheel_lag: 0.1, ..model() };
    for (command, length, angle) in [(drive(0.2, 0.0, 2.0), 0.4, 0.0), (drive(0.2, 0.5, 2.0), 0.4, 1.0)] {
        let mut motion = robot(lame.clone(), vec![], Pose::default());
        motion.command(Time(2_345), command, &[]).expect("valid");
        let end = motion.drive_end().expect("the drive ends");
        assert!(end > Time::from_millis(2_090) && end < Time::from_millis(2_130), "the lag is made up later: {end:?}");
        assert!(!motion.is_drive_done(end - Time(1)) && motion.is_drive_done(end));
        assert!((motion.path_length(end) - length).abs() < 1e-12);
        assert!((motion.pose(end).heading.radians() - angle).abs() < 1e-9);
        let later = end + Time::from_millis(500);
        assert_eq!(motion.pose(later), motion.pose(end), "the mark is held");
    }
}

#[test]
fn queries_about_the_future_change_nothing() {
    let lame = Model { wheel_lag: 0.1, ..model() };
    for model in [model(), lame] {
        let mut curious = robot(model.clone(), room(2.0), Pose::new(1.0, 1.0, 0.4));
        let mut patient = curious.clone();
        for n in 0..50 {
            let at = Time(n * 70_003);
            let command = Command::Twist(Twist::new(0.3 - 0.02 * (n % 17) as f64, (n % 5) as f64 - 1.7));
            for motion in [&mut curious, &mut patient] {
                motion.command(at, command, &[]).expect("valid");
            }
            curious.drive_end();
            curious.pose(at + Time::from_millis(5_000));
            assert_eq!(curious.pose(at), patient.pose(at));
        }
        assert_eq!(curious.state(Time(9_000_000)), patient.state(Time(9_000_000)));
    }
}
