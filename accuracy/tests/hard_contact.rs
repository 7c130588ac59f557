//! Hard cases of contact: robots that start in contact, wedged robots and head-on collisions, at very low and very high
//! speeds, far from the origin and with several slot lengths.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use accuracy::course::model;
use accuracy::oracle;
use accuracy::touch::{Approach, Case};
use accuracy::world::{Random, room_with_boxes};
use glam::DVec2;
use sim_core::RobotId;
use sim_core::contact::{Path, SKIN, first_contact};
use sim_core::drive::{Command, Model, Motion};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Segment, Walls};
use sim_core::time::Time;
use sim_core::world::World;

/// Radius of the robots, m.
const RADIUS: f64 = 0.08;

fn wall(ax: f64, ay: f64, bx: f64, by: f64) -> Segment {
    Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by))
}

fn robot(walls: &[Segment], start: Pose) -> Motion {
    let fast_model = Model { max_wheel_rate: 1e9, ..model() };
    Motion::new(RobotId(1), Arc::new(fast_model), Arc::new(Walls::new(walls.to_vec())), start)
}

fn drive(length: f64, angle: f64, duration: f64) -> Command {
    Command::Drive { displacement: Twist::new(length, angle), duration }
}

/// Criterion: at coordinates of 10 km, the instant of each contact is exact within 1e-8 s. The error is the rounding
/// error of a coordinate of 1e4 m (2e-12 m), divided by the speed of approach.
#[test]
fn contacts_ten_kilometres_away_are_exact() {
    let mut random = Random::new(21);
    let offset = DVec2::new(-1e4, 1e4);
    for approach in Approach::ALL {
        for _ in 0..300 {
            let case = Case::draw(&mut random, approach);
            let start = Pose { position: case.start.position + offset, ..case.start };
            let wall = Segment::new(case.wall.a + offset, case.wall.b + offset);
            let found = first_contact(&Path::new(&start, case.twist), case.radius, &wall, f64::INFINITY);
            let found = found.unwrap_or_else(|| panic!("missed {case:?}")).seconds;
            assert!((found - case.instant).abs() < 1e-8, "{found} for {case:?}");
        }
    }
}

/// Criterion: a robot that drives head on towards many walls, at 1 um/s to 1 km/s, stops at a gap of one skin from the
/// first wall, even if it would cross all walls within one slot. At speeds too low to reach the wall, it covers speed
/// times time.
#[test]
fn first_of_many_walls_stops_the_robot_at_any_speed() {
    let walls: Vec<_> = (1..=50).map(|n| wall(0.2 * f64::from(n), -1.0, 0.2 * f64::from(n), 1.0)).collect();
    for slot in [1_000, 50_000, 1_000_000] {
        for speed in [1e-6, 0.1, 1.0, 50.0, 1e3] {
            let mut motion = robot(&walls, Pose::default());
            let mut world = World::new(Arc::new(Walls::new(walls.clone())), Time(slot), [&mut motion]);
            motion.command(Time(3), Command::Twist(Twist::new(speed, 0.0)), &[]).expect("valid");
            for _ in 0..20 {
                world.advance(&mut [&mut motion]);
                let x = motion.pose(world.slot_start()).position.x;
                assert!(x <= 0.2 - RADIUS - SKIN + 1e-15, "{x} m at {speed} m/s in slots of {slot} us");
            }
            let elapsed = (world.slot_start() - Time(3)).seconds();
            let x = motion.pose(world.slot_start()).position.x;
            let expected = (0.2 - RADIUS - SKIN).min(speed * elapsed);
            assert!((x - expected).abs() < 1e-12, "{x} m at {speed} m/s in slots of {slot} us");
        }
    }
}

/// Criterion: two robots that meet head on stop at a gap of one skin, even if they would pass through each other within
/// one slot. The ratio of the distances that they travel is the ratio of their speeds, within 1 um of distance.
#[test]
fn head_on_robots_stop_at_a_gap_of_one_skin_at_any_speed_and_slot() {
    for slot in [1_000, 50_000, 1_000_000] {
        for (left, right) in [(0.5, 0.5), (100.0, 1.0), (1e3, 1e3), (1e-3, 1e3), (0.7, 0.0)] {
            let walls = Arc::new(Walls::new(vec![]));
            let fast_model = Arc::new(Model { max_wheel_rate: 1e9, ..model() });
            let mut motions = [
                Motion::new(RobotId(1), Arc::clone(&fast_model), Arc::clone(&walls), Pose::new(-1.0, 0.0, 0.0)),
                Motion::new(RobotId(2), fast_model, Arc::clone(&walls), Pose::new(1.0, 0.0, PI)),
            ];
            let mut world = World::new(walls, Time(slot), &mut motions);
            for (motion, speed) in motions.iter_mut().zip([left, right]) {
                motion.command(Time::ZERO, Command::Twist(Twist::new(speed, 0.0)), &[]).expect("valid");
            }
            while world.slot_start() < Time(4_000_000) {
                world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
                let at = world.slot_start();
                let gap = motions[1].pose(at).position.x - motions[0].pose(at).position.x - 2.0 * RADIUS;
                assert!(gap > SKIN - 1e-9, "gap {gap} at {left} and {right} m/s in slots of {slot} us");
            }
            let at = world.slot_start();
            let [a, b] = motions.each_mut().map(|motion| motion.pose(at).position.x);
            assert!(((b - a - 2.0 * RADIUS) - SKIN).abs() < 2e-9, "gap at {left} and {right} m/s");
            let expected = (2.0 - 2.0 * RADIUS - SKIN) * left / (left + right);
            assert!((a + 1.0 - expected).abs() < 1e-6, "{a} instead of {expected} at {left} and {right} m/s");
        }
    }
}

/// Criterion: a robot that starts in contact, or overlaps a wall nearly up to its centre, moves the commanded distance
/// if it heads away from the wall or parallel to it, and does not move if it heads into the wall.
#[test]
fn robots_that_start_in_contact_do_not_move_into_the_wall() {
    let walls = [wall(-5.0, 0.0, 5.0, 0.0)];
    for depth in [-SKIN, 0.0, 1e-9, 0.01, 0.079] {
        for direction in 0..8 {
            let heading = f64::from(direction) * PI / 4.0;
            let mut motion = robot(&walls, Pose::new(0.0, RADIUS - depth, heading));
            motion.command(Time(9), drive(0.3, 0.0, 1.0), &[]).expect("valid");
            let can_move = direction <= 4;
            assert_eq!(motion.drive_end().is_some(), can_move, "depth {depth}, heading {heading}");
            let moved = (motion.pose(Time(3_000_000)).position - DVec2::new(0.0, RADIUS - depth)).length();
            assert!(
                (moved - if can_move { 0.3 } else { 0.0 }).abs() < 1e-12,
                "depth {depth}, heading {heading}: {moved}"
            );
            // A turn on the spot is unobstructed.
            let mut motion = robot(&walls, Pose::new(0.0, RADIUS - depth, heading));
            motion.command(Time(9), drive(0.0, 9.0, 1.0), &[]).expect("valid");
            assert!(motion.drive_end().is_some(), "depth {depth}");
        }
    }
}

/// Criterion: in corners from 2 to 178 degrees, a robot that drives along the bisector stops at a gap of one skin from
/// both walls. It can then turn on the spot by 360 degrees in ten commands, and reverses out by the commanded distance.
#[test]
fn wedged_robot_reverses_out_of_corners_of_any_angle() {
    for degrees in [2.0, 10.0, 45.0, 60.0, 90.0, 120.0, 178.0_f64] {
        let half = 0.5 * degrees.to_radians();
        let (sin, cos) = sim_core::math::sin_cos(half);
        let walls = [wall(0.0, 0.0, -20.0 * cos, 20.0 * sin), wall(0.0, 0.0, -20.0 * cos, -20.0 * sin)];
        let start = -RADIUS / sin - 0.1;
        let mut motion = robot(&walls, Pose::new(start, 0.0, 0.0));
        motion.command(Time::ZERO, Command::Twist(Twist::new(0.2, 0.0)), &[]).expect("valid");
        let mut at = Time::from_millis(10_000);
        let wedged = motion.pose(at);
        let gap = oracle::clearance(&walls, wedged.position, RADIUS);
        assert!((gap - SKIN).abs() < 1e-12, "{degrees} degrees: gap {gap}");
        assert!((wedged.position.x + (RADIUS + SKIN) / sin).abs() < 1e-9);
        for _ in 0..10 {
            motion.command(at, drive(0.0, TAU / 10.0, 0.1), &[]).expect("valid");
            at = motion.drive_end().expect("the wedged robot turns");
        }
        motion.command(at, drive(0.5, 0.0, 1.0), &[]).expect("valid");
        assert_eq!(motion.drive_end(), None, "{degrees} degrees: the wedged robot moves deeper");
        motion.command(at + Time(1), drive(-0.5, 0.0, 1.0), &[]).expect("valid");
        let end = motion.drive_end().unwrap_or_else(|| panic!("{degrees} degrees: the robot does not reverse out"));
        assert!((motion.pose(end).position.x - wedged.position.x + 0.5).abs() < 1e-9);
        assert_eq!(motion.contacts(end), 1);
    }
}

/// Criterion: a robot drives 100 m without contact through a passage that is 1 mm wider than the robot, at the origin
/// and 10 km away. If it starts 0.6 mm off the centre line, the entrance stops it.
#[test]
fn robot_drives_through_a_passage_one_millimetre_wider_than_itself() {
    let half_width = RADIUS + 0.5e-3;
    for (offset, angle) in [(DVec2::ZERO, 0.0), (DVec2::new(1e4, 1e4), 0.7), (DVec2::new(-1e4, 3.0), -2.9)] {
        let frame = Pose { position: offset, ..Pose::new(0.0, 0.0, angle) };
        let point = |x: f64, y: f64| frame.transform_point(DVec2::new(x, y));
        let walls = [
            Segment::new(point(1.0, half_width), point(110.0, half_width)),
            Segment::new(point(1.0, -half_width), point(110.0, -half_width)),
            Segment::new(point(1.0, half_width), point(1.0, 2.0)),
            Segment::new(point(1.0, -half_width), point(1.0, -2.0)),
        ];
        let mut centred = robot(&walls, frame);
        centred.command(Time::ZERO, drive(100.0, 0.0, 100.0), &[]).expect("valid");
        let end = centred.drive_end().expect("the passage is wide enough");
        assert_eq!(centred.contacts(end), 0);
        let gap = oracle::clearance(&walls, centred.pose(end).position, RADIUS);
        assert!((gap - 0.5e-3).abs() < 1e-10, "gap {gap}");
        let mut off_centre = robot(&walls, Pose { position: point(0.0, 0.6e-3), ..frame });
        off_centre.command(Time::ZERO, drive(100.0, 0.0, 100.0), &[]).expect("valid");
        assert_eq!(off_centre.drive_end(), None);
        let gap = oracle::clearance(&walls, off_centre.pose(Time(200_000_000)).position, RADIUS);
        assert!((gap - SKIN).abs() < 1e-11, "gap {gap}");
    }
}

/// Criterion: in a thousand random drives among boxes, the gap between the robot and each wall is never smaller than
/// the skin, except for rounding of 1e-12 m. Poses and numbers of contacts are equal for slots of 1 ms and of 1 s.
#[test]
fn thousand_drives_among_boxes_keep_a_gap_of_one_skin() {
    let walls = room_with_boxes(3, DVec2::splat(-2.0), 4.0, 12);
    let mut random = Random::new(8);
    let start = (0..10_000)
        .map(|_| DVec2::new(random.between(-1.8, 1.8), random.between(-1.8, 1.8)))
        .find(|point| oracle::clearance(&walls, *point, RADIUS) > 0.01)
        .expect("a free place");
    let drives: Vec<_> = (0..1_000)
        .map(|_| {
            let (v, omega) = (random.between(-1.0, 2.0), random.between(-4.0, 4.0));
            Command::Twist(if random.chance(0.2) { Twist::new(0.0, omega) } else { Twist::new(v, omega) })
        })
        .collect();
    let run = |slot: i64| {
        let mut motion = robot(&walls, Pose { position: start, ..Pose::default() });
        let mut world = World::new(Arc::new(Walls::new(walls.clone())), Time(slot), [&mut motion]);
        let mut poses = Vec::new();
        for (n, command) in (0_i64..).zip(&drives) {
            let at = Time(n * 217_003);
            while world.slot_end() <= at {
                world.advance(&mut [&mut motion]);
            }
            motion.command(at, *command, &[]).expect("valid");
            for part in 0..20 {
                let pose = motion.pose(at + Time(part * 10_850));
                let gap = oracle::clearance(&walls, pose.position, RADIUS);
                assert!(gap > SKIN - 1e-12, "gap {gap} in drive {n}");
                poses.push(pose);
            }
        }
        (poses, motion.contacts(Time(1_000 * 217_003)))
    };
    let (poses, contacts) = run(1_000);
    assert!(contacts > 50, "{contacts} contacts: too few for a test");
    assert_eq!(run(1_000_000), (poses, contacts));
}
