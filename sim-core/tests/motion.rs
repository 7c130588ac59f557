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
    }
}

fn robot(model: Model, walls: Vec<Segment>, pose: Pose) -> Motion {
    model.check().expect("a sound model");
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
fn a_square_ends_where_it_began() {
    let mut motion = robot(Model { axis_offset: 0.03, ..model() }, vec![], Pose::new(1.0, 2.0, 0.3));
    let mut at = Time(17);
    for _ in 0..4 {
        for command in [drive(0.2, 0.0, 2.0), drive(0.0, PI / 2.0, 1.0)] {
            motion.command(at, command, &[]).expect("a sound command");
            at = motion.drive_end().expect("an end");
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
fn a_drive_ends_at_its_commanded_length_not_at_speed_times_time() {
    let mut motion = robot(model(), vec![], Pose::default());
    let displacement = Twist::new(0.1 + 0.2, 0.7);
    motion.command(Time(5), Command::Drive { displacement, duration: 1.0 / 3.0 }, &[]).expect("a sound command");
    let end = motion.drive_end().expect("an end");
    assert_eq!(motion.pose(end), Pose::default().moved(displacement));
    assert_eq!(motion.odometry(end), Pose::default().moved(displacement));
    assert_eq!(motion.drive_remaining(end), 0.0);
    assert!(motion.drive_remaining(end - Time(1)) > 0.0);
    assert_eq!(motion.speed(end), Twist::ZERO);
}

#[test]
fn a_robot_stops_a_skin_before_the_wall_and_stalls() {
    let mut motion = robot(model(), room(2.0), Pose::new(1.0, 1.0, 0.0));
    motion.command(Time::ZERO, drive(0.5, 0.0, 10.0), &[]).expect("a sound command");
    assert_eq!(motion.drive_end(), None);
    let at = Time::from_millis(9_000);
    assert!((motion.pose(at).position.x - (2.0 - 0.093 - SKIN)).abs() < 1e-12);
    assert!(motion.is_stalled(at) && !motion.is_drive_done(at) && !motion.is_moving(at));
    assert!((motion.drive_remaining(at) - (5.0 - 0.907)).abs() < 2e-6);
    assert_eq!(motion.contacts(at), 1);
    let impact = motion.impacts(Time::ZERO, at)[0];
    assert!(matches!(impact.thing, Thing::Wall(_)) && impact.bearing.abs() < 1e-9);
    assert!((impact.time.seconds() - 0.907 / 0.5).abs() < 1e-5);
    // Against the wall again, along it, and away.
    motion.command(at, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("a sound command");
    assert!(motion.is_stalled(at));
    assert_eq!(motion.contacts(at), 1);
    motion.command(at + Time(1), drive(0.0, PI / 2.0, 1.0), &[]).expect("a sound command");
    let turned = motion.drive_end().expect("a disc turns in contact");
    motion.command(turned, drive(0.5, 0.0, 1.0), &[]).expect("a sound command");
    let along = motion.drive_end().expect("a disc drives along a wall");
    assert!((motion.pose(along).position.y - 1.5).abs() < 1e-9);
    motion.command(along, drive(0.5, PI / 2.0, 0.5), &[]).expect("a sound command");
    assert!(motion.drive_end().is_some());
    assert_eq!(motion.contacts(Time::from_millis(20_000)), 1);
}

#[test]
fn refused_commands_change_nothing() {
    let mut motion = robot(model(), vec![], Pose::default());
    motion.command(Time::ZERO, Command::Twist(Twist::new(0.1, 0.0)), &[]).expect("a sound command");
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
                motion.command(at, command, &touching).expect("a sound command");
                poses.extend([motion.pose(at), motion.odometry(at)]);
            }
            next += 1;
        }
        world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
    }
    poses
}

#[test]
fn poses_are_equal_to_the_bit_for_every_slot_length() {
    let reference = script(Time::from_millis(50));
    for slot in [100, 1_000, 10_000, 20_000, 200_000, 1_000_000] {
        assert_eq!(script(Time(slot)), reference, "slots of {slot} us");
    }
}
