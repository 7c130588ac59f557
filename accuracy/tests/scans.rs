//! The core's scanner, compared with brute force for every ray, over walls, robots and objects at the time of the call.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use accuracy::oracle;
use accuracy::world::{self, Random};
use glam::DVec2;
use sim_core::contact::Body;
use sim_core::drive::{Command, DriveKind, Model, Motion};
use sim_core::math;
use sim_core::object::{Part, Properties, Resistance, Shape};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Bounds, Segment, Walls};
use sim_core::sensor::{Fan, Mount, Scan};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};

/// Tolerance of a reading against brute force, in metres.
const TOLERANCE: f64 = 1e-9;

const SIDE: f64 = 6.0;

fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.05,
        max_wheel_rate: 1e3,
        ticks_per_turn: 540.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: 10.0,
        max_turn: 100.0,
        body_radius: 0.1,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 1.0,
        traction: 0.6,
    }
}

/// Distance along a ray to a disc, in metres, by the quadratic equation; 0 if the ray begins inside.
fn distance_to_disc(origin: DVec2, direction: DVec2, centre: DVec2, radius: f64) -> Option<f64> {
    let from_centre = origin - centre;
    let c = from_centre.length_squared() - radius * radius;
    if c <= 0.0 {
        return Some(0.0);
    }
    let half_b = from_centre.dot(direction);
    let discriminant = half_b * half_b - c;
    (discriminant >= 0.0 && half_b < 0.0).then(|| -half_b - discriminant.sqrt())
}

/// Direction of ray `ray` of `points` in the world frame, as documented.
fn direction(heading: f64, sweep: f64, points: u32, ray: u32) -> DVec2 {
    let steps = if sweep > TAU - 1e-9 || points.is_multiple_of(2) { points } else { points - 1 };
    let angle = sweep / f64::from(steps.max(1)) * (f64::from(points / 2) - f64::from(ray));
    DVec2::new(math::cos(heading + angle), math::sin(heading + angle))
}

/// Expected readings of a horizontal scan, by brute force over robots, discs and walls, all slightly enlarged or
/// reduced.
struct Truth<'a> {
    walls: &'a [Segment],
    robots: Vec<Body>,
    discs: Vec<(DVec2, f64)>,
    range: f64,
}

impl Truth<'_> {
    fn check(&self, origin: DVec2, direction: DVec2, found: Option<f64>, context: &str) {
        let bodies = self.robots.iter().map(|body| (body.centre, body.radius)).chain(self.discs.iter().copied());
        let bodies: Vec<_> = bodies.collect();
        let nearest = |extension: f64, enlargement: f64| {
            let wall = oracle::nearest_wall(self.walls, origin, direction, 1e9, extension).map(|hit| hit.0);
            let body = bodies
                .iter()
                .filter_map(|&(centre, radius)| distance_to_disc(origin, direction, centre, radius + enlargement));
            body.chain(wall).fold(f64::INFINITY, f64::min)
        };
        let (min, max) = (nearest(1e-9, 1e-12), nearest(-1e-9, -1e-12));
        match found {
            // On a ray that grazes a disc, a smaller radius moves the hit by about the square root of the change.
            Some(metres) => assert!(
                min - TOLERANCE <= metres && metres <= max.min(self.range) + 1e-5_f64.min(TOLERANCE + (max - min)),
                "{context}: {metres} instead of {min} to {max}"
            ),
            None => assert!(max > self.range - TOLERANCE, "{context}: nothing for {min} to {max}"),
        }
    }
}

#[test]
fn scans_of_rooms_match_brute_force() {
    for (seed, corner) in (0..).zip([DVec2::ZERO, DVec2::new(-300.0, 40.0)]) {
        for scene in [world::room_with_boxes(seed, corner, SIDE, 12), world::maze(seed, corner, 10, 0.6)] {
            let walls = Arc::new(Walls::new(scene));
            let none = std::iter::empty();
            let world = World::new(Arc::clone(&walls), Time::from_millis(50), none);
            let mut random = Random::new(seed);
            let room = Bounds { min: corner, max: corner + DVec2::splat(SIDE) };
            let truth = Truth { walls: walls.segments(), robots: vec![], discs: vec![], range: 4.0 };
            for turn in 0..60 {
                let heading = if turn < 8 { f64::from(turn) * PI / 4.0 } else { random.between(-40.0, 40.0) };
                let pose = Pose { position: random.point_in(room), ..Pose::new(0.0, 0.0, heading) };
                let (x, y, angle) = (random.between(-0.1, 0.1), random.between(-0.1, 0.1), random.between(-1.0, 1.0));
                let sweep = if random.chance(0.5) { TAU } else { random.between(0.1, 6.0) };
                let points = 1 + random.below(400) as u32;
                let fan = Fan { sweep, points, tilt: 0.0, height: 0.1, range: truth.range };
                let scan = Scan::new(Mount::new(x, y, angle), fan);
                let found = scan.distances(&world, RobotId(1), &pose, Time::ZERO);
                assert_eq!(found.len(), points as usize);
                let (sin, cos) = (math::sin(heading), math::cos(heading));
                let origin = pose.position + DVec2::new(cos * x - sin * y, sin * x + cos * y);
                for (ray, metres) in (0..).zip(found) {
                    let direction = direction(heading + angle, sweep, points, ray);
                    truth.check(origin, direction, metres, &format!("ray {ray} of {points} at {pose:?}"));
                }
            }
        }
    }
}

#[test]
fn scans_detect_moving_bodies_at_the_time_of_the_call() {
    let mut random = Random::new(77);
    for round in 0..6 {
        let walls = Arc::new(Walls::new(world::room_with_boxes(round, DVec2::ZERO, SIDE, 0)));
        let model = Arc::new(model());
        let mut motions: Vec<_> = (0..12)
            .map(|index| {
                let (column, row) = (index % 4, index / 4);
                let pose = Pose::new(1.0 + column as f64, 1.0 + 1.3 * row as f64, random.between(-PI, PI));
                Motion::new(RobotId::from_index(index), Arc::clone(&model), Arc::clone(&walls), pose)
            })
            .collect();
        let ball = Arc::new(Properties {
            mass: 0.05,
            centre_of_mass: DVec2::ZERO,
            parts: vec![Part { shape: Shape::Disc { radius: 0.05 }, object_from_part: Pose::default() }],
            resistance: Resistance::Rolling(0.02),
            restitution: 0.5,
            contact_friction: 0.3,
            lift: 0.0,
        });
        let balls = [Pose::new(1.5, 1.6, 0.0), Pose::new(3.5, 3.0, 0.0), Pose::new(0.4, 5.0, 0.0)];
        let mut world = World::new(Arc::clone(&walls), Time::from_millis(50), &mut motions)
            .with_objects(balls.map(|pose| (Arc::clone(&ball), pose)));
        world.set_object_velocity(ObjectId(1), random.direction(), 0.0);
        for motion in &mut motions {
            let twist = Twist::new(random.between(-0.6, 0.6), random.between(-2.0, 2.0));
            motion.command(Time(10_001), Command::Twist(twist), &[]).expect("valid");
        }
        for slot in 0..8 {
            if slot == 4 {
                motions[2].place(world.slot_start() + Time(900), Pose::new(5.5, 5.5, 0.0)).expect("valid");
            }
            for call in 0..4 {
                let at = world.slot_start() + Time(call * 12_345);
                let scanner_index = random.below(motions.len());
                let id = RobotId::from_index(scanner_index);
                let pose = motions[scanner_index].pose(at);
                let fan = Fan { sweep: TAU, points: 360, tilt: 0.0, height: 0.1, range: f64::INFINITY };
                let found = Scan::new(Mount::default(), fan).distances(&world, id, &pose, at);
                // The truth uses the published motion of the other robots.
                let others = (0..motions.len()).map(RobotId::from_index).filter(|other| *other != id);
                let truth = Truth {
                    walls: walls.segments(),
                    robots: others.map(|other| world.body(other, at)).collect(),
                    discs: (1..=3).map(|n| (world.object_pose(ObjectId(n), at).position, 0.05)).collect(),
                    range: f64::INFINITY,
                };
                // The published motion equals the true motion except in the slots of the commands and of the placement.
                if slot > 0 && slot != 4 {
                    for body in &truth.robots {
                        let centre = motions[body.robot.index()].pose(at).position;
                        assert!((centre - body.centre).length() < 1e-12, "{} at {at:?}", body.robot);
                    }
                }
                for (ray, metres) in (0..).zip(found) {
                    let direction = direction(pose.heading.radians(), TAU, 360, ray);
                    truth.check(pose.position, direction, metres, &format!("ray {ray} of {id} at {at:?}"));
                }
            }
            world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
        }
    }
}

#[test]
fn tilted_rays_pass_over_low_walls_and_hit_the_floor() {
    let wall_at = |x: f64| Segment::new(DVec2::new(x, -5.0), DVec2::new(x, 5.0));
    let walls = Walls::new(vec![wall_at(1.0), wall_at(2.0), wall_at(4.0)]).with_heights(vec![0.1, 0.3, f64::INFINITY]);
    let world = World::new(Arc::new(walls), Time::from_millis(50), std::iter::empty());
    // Checks the reading of one ray along x from the origin. `expected` is the horizontal distance, or `None` if there
    // is no return within 9 m along the ray.
    let check_reading = |height: f64, tilt: f64, expected: Option<f64>| {
        let fan = Fan { sweep: 0.0, points: 1, tilt, height, range: 9.0 };
        let found = Scan::new(Mount::default(), fan).distances(&world, RobotId(1), &Pose::default(), Time::ZERO)[0];
        let expected = expected.map(|horizontal| horizontal / math::cos(tilt));
        match (found, expected) {
            (Some(metres), Some(expected)) => {
                assert!((metres - expected).abs() < 1e-12, "{height} m, {tilt}: {metres} instead of {expected}");
            }
            _ => assert_eq!(found, expected, "{height} m, {tilt}"),
        }
    };
    check_reading(0.05, 0.0, Some(1.0));
    check_reading(0.1, 0.0, Some(1.0));
    check_reading(0.2, 0.0, Some(2.0));
    check_reading(0.5, 0.0, Some(4.0));
    // A ray that rises from a height of 5 cm passes over the first wall above a slope of 5 cm per metre, and over the
    // second wall above a slope of 12.5 cm per metre.
    let slope = |rise: f64| math::atan(rise);
    check_reading(0.05, slope(0.049), Some(1.0));
    check_reading(0.05, slope(0.051), Some(2.0));
    check_reading(0.05, slope(0.126), Some(4.0));
    check_reading(0.05, slope(2.0), Some(4.0));
    // A horizontal distance of 4 m is 9 m along a ray at 63.6 degrees.
    check_reading(0.05, slope(2.1), None);
    // A ray that falls from a height of 20 cm passes over the first wall and hits the second, or hits the first wall,
    // or hits the floor before the first wall.
    check_reading(0.2, -slope(0.09), Some(2.0));
    check_reading(0.2, -slope(0.0999), Some(2.0));
    check_reading(0.2, -slope(0.1001), Some(1.0));
    check_reading(0.2, -slope(0.11), Some(1.0));
    check_reading(0.2, -slope(0.25), Some(0.8));
    check_reading(0.0, -0.1, Some(0.0));
    // This ray passes over the two low walls and hits nothing within its range.
    let fan = Fan { sweep: 0.0, points: 1, tilt: -0.01, height: 0.5, range: 3.0 };
    let found = Scan::new(Mount::default(), fan).distances(&world, RobotId(1), &Pose::default(), Time::ZERO);
    assert_eq!(found, [None]);
}

#[test]
fn tilted_scan_equals_a_level_scan_divided_by_the_cosine() {
    let mut random = Random::new(3);
    let walls = Arc::new(Walls::new(world::room_with_boxes(1, DVec2::ZERO, SIDE, 8)));
    let world = World::new(Arc::clone(&walls), Time::from_millis(50), std::iter::empty());
    let room = Bounds { min: DVec2::splat(0.2), max: DVec2::splat(SIDE - 0.2) };
    for _ in 0..200 {
        let (tilt, height) = (random.between(-0.5, 0.5), random.between(0.0, 0.4));
        let pose = Pose { position: random.point_in(room), ..Pose::new(0.0, 0.0, random.between(-PI, PI)) };
        let range = random.between(1.0, 9.0);
        let fan = |tilt, range| Fan { sweep: TAU, points: 45, tilt, height, range };
        let level = Scan::new(Mount::default(), fan(0.0, f64::INFINITY));
        let tilted = Scan::new(Mount::default(), fan(tilt, range));
        let level = level.distances(&world, RobotId(1), &pose, Time::ZERO);
        let tilted = tilted.distances(&world, RobotId(1), &pose, Time::ZERO);
        for (horizontal, found) in level.into_iter().zip(tilted) {
            let floor = if tilt < 0.0 { height / math::tan(-tilt) } else { f64::INFINITY };
            let expected = horizontal.expect("walls all around").min(floor) / math::cos(tilt);
            match found {
                Some(metres) => assert!((metres - expected).abs() < TOLERANCE && metres <= range, "{expected}"),
                None => assert!(expected > range - TOLERANCE, "{expected} of {range}"),
            }
        }
    }
}
