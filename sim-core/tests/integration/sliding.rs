//! Robots that slide along walls: closed forms, a reference with small time steps, degenerate cases, and bit-identical
//! motion for every slot length.

use std::{
    f64::consts::{FRAC_PI_2, FRAC_PI_4, PI},
    sync::Arc,
};

use accuracy::{course, oracle, slide::Case, world::Random};
use glam::DVec2;
use proptest::prelude::*;
use sim_core::{
    RobotId,
    contact::SKIN,
    drive::{Command, ContactRule, Imperfection, Model, Motion},
    math,
    noise::TwistNoise,
    object::{Part, Properties, Resistance, Shape},
    pose::{Pose, Twist},
    scene::{Bounds, Segment, Walls},
    time::Time,
    world::World,
};

const RADIUS: f64 = 0.1;

fn model() -> Model {
    Model {
        body_radius: RADIUS,
        axis_offset: 0.0,
        max_speed: 10.0,
        max_turn: 100.0,
        max_wheel_rate: 1e4,
        ..course::model()
    }
}

fn robot_of(model: Model, walls: &[Segment], friction: f64, pose: Pose) -> Motion {
    let motion = Motion::new(RobotId(1), Arc::new(model), Arc::new(Walls::new(walls.to_vec())), pose);
    motion.with_contact(ContactRule::Slide { friction }).expect("a friction")
}

fn robot(walls: &[Segment], friction: f64, pose: Pose) -> Motion {
    robot_of(model(), walls, friction, pose)
}

fn wall(ax: f64, ay: f64, bx: f64, by: f64) -> Segment {
    Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by))
}

fn twist(motion: &mut Motion, at: Time, v: f64, omega: f64) {
    motion.command(at, Command::Twist(Twist::new(v, omega)), &[]).expect("a valid command");
}

fn seconds(seconds: f64) -> Time {
    Time::from_seconds_ceil(seconds)
}

/// Pose below a wall along the x axis. The rim is `gap` m from the wall, and the heading is turned by `angle` from x
/// towards the wall.
fn below(gap: f64, angle: f64) -> Pose {
    Pose::new(0.0, -RADIUS - SKIN - gap, angle)
}

#[test]
fn sliding_speed_outside_the_friction_cone_matches_the_formula() {
    let walls = [wall(-10.0, 0.0, 10.0, 0.0)];
    for friction in [0.0, 0.1, 0.3, 1.0] {
        for degrees in [1.0_f64, 3.0, 20.0, 40.0, 44.0, 60.0, 80.0, 89.0] {
            let angle = degrees.to_radians();
            let mut motion = robot(&walls, friction, below(0.05, angle));
            twist(&mut motion, Time::ZERO, 0.3, 0.0);
            let impact_time = 0.05 / (0.3 * math::sin(angle));
            let along = (math::cos(angle) - friction * math::sin(angle)).max(0.0);
            let end = impact_time + 4.0;
            let expected = DVec2::new(0.3 * (impact_time * math::cos(angle) + 4.0 * along), -RADIUS - SKIN);
            let at = seconds(end);
            let found = motion.pose(at);
            assert!((found.position - expected).length() < 1e-6, "{degrees} degrees, {friction}: {found:?}");
            assert!((found.heading.radians() - angle).abs() < 1e-15, "nothing turns it");
            assert_eq!(motion.state(at).odometry, Pose::default().moved(Twist::new(0.3 * at.seconds(), 0.0)));
            // Slip ratio: slip speed divided by the speed of the push.
            let slip = math::hypot(math::sin(angle), math::cos(angle) - along);
            assert!((motion.slip(at) - slip).abs() < 1e-9, "{} instead of {slip}", motion.slip(at));
            assert_eq!(motion.is_stalled(at), slip > 0.5, "{degrees} degrees");
            assert_eq!(motion.contacts(at), 1);
        }
    }
}

#[test]
fn drives_along_a_wall_end_by_odometry_while_encoders_count() {
    let walls = [wall(-10.0, 0.0, 10.0, 0.0), wall(1.0, -5.0, 1.0, 5.0)];
    for angle in [0.05, 0.7, FRAC_PI_2] {
        let mut motion = robot(&walls, 0.3, below(0.02, angle));
        let mut free = robot(&[], 0.3, below(0.02, angle));
        for motion in [&mut motion, &mut free] {
            let drive = Command::Drive { displacement: Twist::new(3.0, 0.0), duration: 10.0 };
            motion.command(Time(3), drive, &[]).expect("a valid command");
        }
        let end = motion.drive_end();
        assert_eq!(end, Some(Time(10_000_003)));
        assert_eq!(end, free.drive_end());
        for at in [1_000_000, 5_000_000, 10_000_003, 11_000_000].map(Time) {
            assert_eq!(motion.wheel_angles(at), free.wheel_angles(at));
            assert_eq!(motion.odometry(at), free.odometry(at));
            assert_eq!(motion.drive_remaining(at), free.drive_remaining(at));
        }
        assert!(motion.is_stalled(Time(9_900_000)), "in the corner, or pressed");
        assert!(!motion.is_stalled(Time(10_000_003)), "at rest");
        assert!(motion.pose(Time(12_000_000)).position.x <= 1.0 - RADIUS);
    }
}

#[test]
fn disc_pushed_into_a_corner_rests() {
    let walls = [wall(-5.0, 0.0, 1.0, 0.0), wall(1.0, -5.0, 1.0, 0.0)];
    let corner = DVec2::splat(-RADIUS - SKIN) + DVec2::X;
    for friction in [0.0, 0.3] {
        for angle in [0.2, FRAC_PI_4, 1.2] {
            let mut motion = robot(&walls, friction, Pose::new(0.5, -0.5, angle));
            twist(&mut motion, Time::ZERO, 0.3, 0.0);
            let slides = math::cos(angle).min(math::sin(angle)) > friction * math::cos(angle).max(math::sin(angle));
            let at = Time::from_millis(30_000);
            let off = (motion.pose(at).position - corner).length();
            assert_eq!(off < 1e-9, slides, "{off} m off at {angle}");
            assert!(motion.contacts(at) <= 2);
            let earlier = motion.pose(at);
            assert_eq!(motion.pose(Time::from_millis(60_000)), earlier);
        }
    }
}

#[test]
fn disc_turns_around_the_end_of_a_wall_then_moves_straight() {
    let walls = [wall(-5.0, 0.0, 1.0, 0.0)];
    let angle = 0.6;
    let mut motion = robot(&walls, 0.0, below(0.0, angle));
    twist(&mut motion, Time::ZERO, 0.3, 0.0);
    let (arm, speed) = (RADIUS + SKIN, 0.3);
    let to_end = 1.0 / (speed * math::cos(angle));
    // alpha' = -v / r sin(alpha), from 90 degrees + 0.6 rad to 90 degrees, where the normal is perpendicular to the
    // push.
    let round = arm / speed * math::ln(math::tan(0.5 * (FRAC_PI_2 + angle)));
    let leave = to_end + round;
    let at_end = motion.pose(seconds(to_end)).position;
    assert!((at_end - DVec2::new(1.0, -arm)).length() < 1e-6, "{at_end}");
    let direction = DVec2::new(math::cos(angle), math::sin(angle));
    let left_at = DVec2::X - arm * direction.perp();
    for more in [0.0, 1.0, 3.0] {
        let found = motion.pose(seconds(leave + more)).position;
        assert!((found - left_at - direction * speed * more).length() < 1e-6, "{found} after {more} s");
    }
    assert!(!motion.is_stalled(seconds(leave + 1.0)));
    assert_eq!(motion.slip(seconds(leave + 1.0)), 0.0);
}

#[test]
fn turning_disc_rolls_along_a_wall_within_the_friction_cone() {
    let walls = [wall(-10.0, 0.0, 10.0, 0.0)];
    // The robot drives straight at the wall while it turns slowly: the rim rolls on the wall.
    let mut motion = robot(&walls, 1.0, below(0.0, FRAC_PI_2));
    twist(&mut motion, Time::ZERO, 0.3, 0.2);
    let at = Time::from_millis(1_000);
    // The normal points down, so the tangent points along x: the robot rolls in this direction at omega r.
    let expected = 0.2 * (RADIUS + SKIN);
    assert!((motion.pose(at).position.x - expected).abs() < 1e-12, "{:?}", motion.pose(at));
    assert!((motion.pose(at).heading.radians() - FRAC_PI_2 - 0.2).abs() < 1e-15);
    // Without friction the robot moves along the wall with the tangential component of the push: v / omega (1 - cos) to
    // the left.
    let mut motion = robot(&walls, 0.0, below(0.0, FRAC_PI_2));
    twist(&mut motion, Time::ZERO, 0.3, 0.2);
    let expected = -0.3 / 0.2 * (1.0 - math::cos(0.2));
    assert!((motion.pose(at).position.x - expected).abs() < 1e-12, "{:?}", motion.pose(at));
    // The robot leaves the wall when its heading is along the wall, and returns on its circle.
    let leave = FRAC_PI_2 / 0.2;
    let off = motion.pose(seconds(leave + 1.0)).position;
    let circle = DVec2::new(-1.5 - 1.5 * math::sin(0.2), -RADIUS - SKIN - 1.5 * (1.0 - math::cos(0.2)));
    assert!((off - circle).length() < 1e-6, "{off} instead of {circle}");
}

#[test]
fn turn_on_the_spot_in_contact_is_not_blocked() {
    let walls = [wall(-10.0, 0.0, 10.0, 0.0), wall(RADIUS + SKIN, -5.0, RADIUS + SKIN, 5.0)];
    let mut motion = robot(&walls, 0.3, below(0.0, 0.4));
    let before = motion.pose(Time::ZERO).position;
    motion
        .command(Time::ZERO, Command::Drive { displacement: Twist::new(0.0, 7.0), duration: 2.0 }, &[])
        .expect("valid");
    let end = motion.drive_end().expect("the drive ends");
    assert_eq!(motion.pose(end).position, before);
    assert!((motion.pose(end).heading.radians() - 7.4).abs() < 1e-14);
    assert!(!motion.is_stalled(Time(1_000_000)));
}

/// Cases, each with its name and duration in seconds.
fn cases() -> Vec<(&'static str, Case, f64)> {
    let radius = RADIUS;
    let long = vec![wall(-10.0, 0.0, 10.0, 0.0)];
    let corner = vec![wall(-5.0, 0.0, 1.0, 0.0), wall(1.0, -5.0, 1.0, 0.0)];
    let blunt = vec![wall(-5.0, 0.0, 0.5, 0.0), wall(0.5, 0.0, 3.0, -0.5)];
    let convex = vec![wall(-5.0, 0.0, 0.5, 0.0), wall(0.5, 0.0, 3.0, 2.0)];
    let ring: Vec<Segment> = (0..64)
        .map(|side| {
            let at = |side: i32| DVec2::from_angle(2.0 * PI * f64::from(side) / 64.0) * 0.5;
            Segment::new(at(side), at(side + 1))
        })
        .collect();
    let case = |walls: &Vec<Segment>, friction, start: Pose, v: f64, omega: f64| Case {
        walls: walls.clone(),
        radius,
        friction,
        start,
        twist: Twist::new(v, omega),
    };
    vec![
        ("along", case(&long, 0.3, below(0.01, 0.2), 0.3, 0.0), 4.0),
        ("grazing", case(&long, 0.3, below(0.0, 1e-9), 0.3, 0.0), 4.0),
        ("turning left", case(&long, 0.3, below(0.0, 0.2), 0.3, 0.7), 6.0),
        ("turning right", case(&long, 0.3, below(0.0, 2.4), 0.3, -0.9), 4.0),
        ("turning fast", case(&long, 0.2, below(0.0, 2.4), 0.05, -3.0), 3.0),
        ("into a corner", case(&corner, 0.3, Pose::new(0.5, -0.3, 0.5), 0.3, 0.0), 5.0),
        ("turning in a corner", case(&corner, 0.3, Pose::new(0.7, -0.2, 0.5), 0.3, 0.6), 6.0),
        ("concave", case(&blunt, 0.2, below(0.0, 0.3), 0.3, 0.0), 4.0),
        ("convex", case(&convex, 0.2, below(0.0, 0.8), 0.3, 0.0), 4.0),
        ("round an end", case(&vec![wall(-5.0, 0.0, 0.2, 0.0)], 0.3, below(0.0, 0.9), 0.3, 0.0), 3.0),
        ("round an end, turning", case(&vec![wall(-5.0, 0.0, 0.2, 0.0)], 0.2, below(0.0, 0.5), 0.3, 0.5), 3.0),
        ("round an end, turning away", case(&vec![wall(-5.0, 0.0, 0.2, 0.0)], 0.2, below(0.0, 1.0), 0.3, -0.4), 3.0),
        ("in a ring", case(&ring, 0.3, Pose::new(0.1, 0.05, 0.3), 0.3, 0.4), 10.0),
        ("round a pillar", case(&ring, 0.3, Pose::new(-0.8, 0.1, 0.0), 0.3, 0.0), 6.0),
    ]
}

#[test]
fn closed_forms_match_a_reference_with_small_time_steps() {
    for (name, case, span) in cases() {
        let mut motion = robot(&case.walls, case.friction, case.start);
        twist(&mut motion, Time::ZERO, case.twist.vx, case.twist.omega);
        let found = motion.pose(seconds(span)).position;
        let (reference, doubt) = case.extrapolated(span, 20_000);
        let error = (reference - found).length();
        println!("{name}: {error} m, the last step of the extrapolation {doubt} m");
        assert!(error < 1e-8, "{name}: {error} m off, doubt {doubt} m");
    }
}

#[test]
fn random_rooms_match_the_reference() {
    let mut random = Random::new(77);
    let bounds = Bounds { min: DVec2::splat(-0.6), max: DVec2::splat(0.6) };
    let outline = [
        wall(-0.8, -0.8, 0.8, -0.8),
        wall(0.8, -0.8, 0.8, 0.8),
        wall(0.8, 0.8, -0.8, 0.8),
        wall(-0.8, 0.8, -0.8, -0.8),
    ];
    let mut pressed = 0;
    for index in 0..1_200 {
        let count = 1 + random.below(4);
        let mut walls: Vec<_> =
            (0..count).map(|_| Segment::new(random.point_in(bounds), random.point_in(bounds))).collect();
        walls.extend(outline);
        let position = random.point_in(bounds);
        if oracle::clearance(&walls, position, RADIUS) < 1e-3 {
            continue;
        }
        let start = Pose { position, ..Pose::new(0.0, 0.0, random.between(-PI, PI)) };
        let omega = if random.chance(0.4) { 0.0 } else { random.between(-2.0, 2.0) };
        let friction = if random.chance(0.3) { 0.0 } else { random.between(0.0, 1.0) };
        let case = Case { walls, radius: RADIUS, friction, start, twist: Twist::new(random.between(0.1, 0.5), omega) };
        let mut motion = robot(&case.walls, friction, start);
        twist(&mut motion, Time::ZERO, case.twist.vx, omega);
        let found = motion.pose(Time(6_000_000)).position;
        pressed += u32::from(motion.contacts(Time(6_000_000)) > 0);
        // The finer steps are for the few cases in which a contact ends within a coarse step.
        let agrees = |steps| (case.by_steps(6.0, steps) - found).length() < 1e-6;
        assert!([10_000, 100_000, 1_000_000].into_iter().any(agrees), "case {index}: {found}, {case:?}");
    }
    assert!(pressed > 500, "{pressed} cases: too few for a test");
}

#[test]
fn forces_are_within_the_friction_cone_and_contacts_add_no_energy() {
    for (name, case, span) in cases() {
        let mut motion = robot(&case.walls, case.friction, case.start);
        twist(&mut motion, Time::ZERO, case.twist.vx, case.twist.omega);
        for part in 1..500 {
            let at = seconds(span * f64::from(part) / 500.0);
            let centre = motion.pose(at).position;
            let (before, after) = (motion.pose(at - Time(1)).position, motion.pose(at + Time(1)).position);
            let velocity = (after - before) / 2e-6;
            let slip = case.free_velocity(at.seconds()) - velocity;
            let is_touching = |wall: &&Segment| (centre - wall.nearest_point(centre)).length() < RADIUS + 2.0 * SKIN;
            let touched: Vec<&Segment> = case.walls.iter().filter(is_touching).collect();
            let [wall] = touched[..] else { continue };
            let offset = centre - wall.nearest_point(centre);
            let normal = offset.normalize_or_zero();
            let rim = normal.perp().dot(velocity) - case.twist.omega * offset.length();
            // The wall pushes the body as the slipping wheels push back.
            let (force, friction) = (-slip.dot(normal), -slip.dot(normal.perp()));
            // The sharpest turn changes the velocity by 1e-5 m/s in a microsecond.
            assert!(force > -2e-5, "{name} at {at}: the wall pulls, {force}");
            assert!(friction.abs() <= case.friction * force + 2e-5, "{name} at {at}: {friction} of {force}");
            assert!(friction * rim <= 2e-5, "{name} at {at}: friction drives, {friction} with {rim}");
            if friction.abs() < case.friction * force - 2e-5 {
                assert!(rim.abs() < 2e-5, "{name} at {at}: it slides within the cone, {rim}");
            }
        }
    }
}

#[test]
fn degenerate_cases_terminate_without_penetration() {
    let gap =
        |walls: &[Segment], motion: &mut Motion, at: Time| oracle::clearance(walls, motion.pose(at).position, RADIUS);
    // A drive exactly straight into a corner; contact with two walls at once; a corridor as wide as the robot.
    let corner = [wall(-5.0, 0.0, 1.0, 0.0), wall(1.0, -5.0, 1.0, 0.0)];
    let width = 2.0 * (RADIUS + SKIN);
    let corridor = [wall(-1.0, 0.0, 3.0, 0.0), wall(-1.0, -width, 3.0, -width)];
    let narrowing = [wall(-1.0, 0.0, 3.0, 0.0), wall(-1.0, -width - 1e-7, 3.0, -width + 1e-7)];
    let wedge = [wall(-1.0, 0.0, 3.0, 0.0), wall(-1.0, -width - 0.1, 3.0, -width + 0.1)];
    let zigzag: Vec<Segment> = (0..400)
        .map(|step| {
            let at = |step: i32| DVec2::new(f64::from(step) * 1e-3, if step % 2 == 0 { 0.0 } else { 1e-4 });
            Segment::new(at(step), at(step + 1))
        })
        .collect();
    let points: Vec<Segment> =
        (0..50).map(|step| wall(0.02 * f64::from(step), 0.0, 0.02 * f64::from(step), 0.0)).collect();
    let doubled: Vec<Segment> = corner.iter().chain(&corner).copied().collect();
    let scenes: [&[Segment]; 8] =
        [&corner, &corridor, &narrowing, &wedge, &zigzag, &points, &doubled, &[wall(-5.0, 0.0, 5.0, 0.0)]];
    for (index, walls) in scenes.into_iter().enumerate() {
        for angle in [0.0, 1e-16, 1e-12, 1e-9, 1e-6, 1e-3, 0.3, FRAC_PI_4, 1.0, FRAC_PI_2, 2.0, PI - 1e-9] {
            for omega in [0.0, 1e-12, -1e-9, 0.5, -0.5, 7.0] {
                for friction in [0.0, 0.3, 3.0] {
                    let mut motion = robot(walls, friction, below(0.0, angle));
                    twist(&mut motion, Time::ZERO, 0.3, omega);
                    for step in 1..=40 {
                        let at = Time::from_millis(100 * step);
                        let gap = gap(walls, &mut motion, at);
                        assert!(
                            gap > SKIN - 2e-9,
                            "gap {gap} at {at} in scene {index}, {angle} rad, {omega} rad/s, friction {friction}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn disc_inside_a_wall_can_leave_but_not_go_deeper() {
    let walls = [wall(-5.0, 0.0, 5.0, 0.0)];
    for depth in [1e-9, 1e-3, 0.05, 0.0999, 0.1] {
        for angle in [0.0, 0.5, FRAC_PI_2, 2.0, -0.5, -2.0] {
            let start = Pose::new(0.0, -RADIUS + depth, angle);
            let mut motion = robot(&walls, 0.2, start);
            twist(&mut motion, Time::ZERO, 0.3, 0.1);
            let mut before = start.position.y.abs();
            for step in 1..=50 {
                let now = motion.pose(Time::from_millis(100 * step)).position.y.abs();
                assert!(now >= before.min(RADIUS) - 1e-12, "{now} after {before} at depth {depth}, {angle} rad");
                before = now;
            }
        }
    }
}

#[test]
fn number_of_intervals_per_time_is_bounded() {
    // In a corridor that narrows to width 0 and at a chain of pins, the number of events is bounded.
    let walls = [wall(-1.0, 0.0, 3.0, 0.0), wall(-1.0, -0.3, 3.0, 0.0)];
    let mut motion = robot(&walls, 0.0, Pose::new(-0.8, -0.14, 0.0));
    twist(&mut motion, Time::ZERO, 0.3, 2.0);
    let mut world = World::new(Arc::new(Walls::new(walls.to_vec())), Time::from_millis(50), [&mut motion]);
    while world.slot_start() < Time::from_millis(600_000) {
        world.advance(&mut [&mut motion]);
    }
    let gap = oracle::clearance(&walls, motion.pose(world.slot_start()).position, RADIUS);
    assert!(gap > SKIN - 1e-9, "{gap}");
}

/// A room with a pillar and a wall that ends in it.
fn room() -> Vec<Segment> {
    vec![
        wall(0.0, 0.0, 1.2, 0.0),
        wall(1.2, 0.0, 1.2, 1.0),
        wall(1.2, 1.0, 0.0, 1.0),
        wall(0.0, 1.0, 0.0, 0.0),
        wall(0.6, 0.0, 0.62, 0.35),
        wall(0.3, 0.75, 0.33, 0.72),
        wall(0.9, 0.7, 0.9, 0.7),
    ]
}

fn commands() -> impl Strategy<Value = Vec<(i64, f64, f64, bool)>> {
    let angle = prop_oneof![Just(0.0), -4.0..4.0, -0.01..0.01];
    proptest::collection::vec((1_i64..900_000, -0.6..0.6, angle, any::<bool>()), 1..12)
}

fn run(slot: Time, commands: &[(i64, f64, f64, bool)], friction: f64, offset: f64, noise: bool) -> Vec<String> {
    let walls = room();
    let model = Model { axis_offset: offset, ..model() };
    let shared = Arc::new(Walls::new(walls.clone()));
    let motion = Motion::new(RobotId(1), Arc::new(model), shared.clone(), Pose::new(0.3, 0.4, 0.3));
    let errors = TwistNoise { speed: 0.02, turn: 0.05, ..TwistNoise::default() };
    let imperfection =
        if noise { Imperfection { command: errors, ..Imperfection::default() } } else { Imperfection::default() };
    let mut motion = motion
        .with_contact(ContactRule::Slide { friction })
        .and_then(|motion| motion.with_imperfection(5, imperfection))
        .expect("valid");
    let mut world = World::new(shared, slot, [&mut motion]);
    let mut found = Vec::new();
    let mut at = Time::ZERO;
    for (wait, v, omega, is_drive) in commands {
        let command = match is_drive {
            true => Command::Drive { displacement: Twist::new(*v, *omega), duration: 0.7 },
            false => Command::Twist(Twist::new(*v, *omega)),
        };
        motion.command(at, command, &[]).expect("valid");
        let end = at + Time(*wait);
        while world.slot_end() <= end {
            let until = world.slot_end();
            world.advance(&mut [&mut motion]);
            let centre = motion.pose(until).position;
            let position = world.robot_pose(RobotId(1), until).position;
            assert!((position - centre).length() < 1e-12, "what others see: {position} instead of {centre}");
            let gap = oracle::clearance(&walls, centre, RADIUS);
            assert!(gap > SKIN - 2e-9, "gap {gap} at {until}");
        }
        at = end;
        found.push(format!(
            "{:?} {} {} {}",
            motion.state(at),
            motion.contacts(at),
            motion.is_stalled(at),
            motion.slip(at)
        ));
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sliding_is_bit_identical_for_every_slot_length_without_penetration(
        commands in commands(), friction in prop_oneof![Just(0.0), 0.0..1.5], offset in prop_oneof![Just(0.0), -0.05..0.05],
        noise in any::<bool>()
    ) {
        let reference = run(Time::from_millis(50), &commands, friction, offset, noise);
        for slot in [1, 200] {
            prop_assert_eq!(&run(Time::from_millis(slot), &commands, friction, offset, noise), &reference, "slots of {} ms", slot);
        }
    }
}

#[test]
fn sliding_with_motion_errors_is_one_contact() {
    let walls = [wall(-10.0, 0.0, 10.0, 0.0)];
    let noise = TwistNoise { speed: 0.02, turn: 0.3, ..TwistNoise::default() };
    let motion = robot(&walls, 0.3, below(0.01, 0.15));
    let mut motion =
        motion.with_imperfection(3, Imperfection { command: noise, ..Imperfection::default() }).expect("valid");
    let mut world = World::new(Arc::new(Walls::new(walls.to_vec())), Time::from_millis(50), [&mut motion]);
    twist(&mut motion, Time::ZERO, 0.3, 0.0);
    let mut reported = 0;
    while world.slot_start() < Time::from_millis(6_000) {
        reported += world.advance(&mut [&mut motion]).len();
    }
    let at = world.slot_start();
    assert_eq!(reported, motion.contacts(at) as usize);
    assert!((1..=3).contains(&reported), "{reported} contacts");
    assert!(motion.pose(at).position.x > 1.0);
}

#[test]
fn published_pieces_match_the_true_pose() {
    let walls = [wall(-10.0, 0.0, 0.3, 0.0)];
    let mut motion = robot(&walls, 0.3, below(0.0, 0.5));
    let mut world = World::new(Arc::new(Walls::new(walls.to_vec())), Time::from_millis(50), [&mut motion]);
    twist(&mut motion, Time::ZERO, 0.3, 0.4);
    for _ in 0..100 {
        world.advance(&mut [&mut motion]);
        for part in 0..5 {
            let at = world.slot_start() + Time(part * 10_000);
            let pieces: Vec<_> = world.published_pieces(RobotId(1)).collect();
            let piece = pieces.iter().rfind(|piece| piece.start <= at).unwrap_or(&pieces[0]);
            let elapsed = (at - piece.start).seconds().min(piece.duration);
            let expected = piece.world_from_robot.moved(piece.twist.scaled(elapsed));
            let off = (expected.position - motion.pose(at).position).length();
            // Between a line and the circle of 0.3 m/s and 0.4 rad/s through its ends in 50 ms: v w t^2 / 8.
            assert!(off < 4e-5, "{off} m off at {at}");
        }
    }
}

#[test]
fn endless_drive_with_systematic_errors_needs_one_stage() {
    let unequal = Imperfection { diameters: [0.0, 0.1, 0.0, 0.0], ..Imperfection::default() };
    let motion = robot(&room(), 0.3, Pose::new(0.3, 0.4, 0.3));
    let mut motion = motion.with_imperfection(1, unequal).expect("valid");
    let displacement = Twist::new(1e11, 0.0);
    motion.command(Time::ZERO, Command::Drive { displacement, duration: 1e12 }, &[]).expect("valid");
    assert!(motion.drive_end().is_some());
    assert!(oracle::clearance(&room(), motion.pose(Time::from_millis(100_000)).position, RADIUS) > SKIN - 2e-9);
}

/// Robots that drive randomly in a room with crates of these masses; checks that no body penetrates another body or a
/// wall.
fn crowd(seed: u64, slot: Time, crates: &[f64]) {
    let walls = vec![
        wall(0.0, 0.0, 2.0, 0.0),
        wall(2.0, 0.0, 2.0, 1.5),
        wall(2.0, 1.5, 0.0, 1.5),
        wall(0.0, 1.5, 0.0, 0.0),
        wall(1.0, 0.4, 1.1, 1.0),
    ];
    let shared = Arc::new(Walls::new(walls.clone()));
    let mut random = Random::new(seed);
    let positions = [(0.2, 0.2), (0.5, 0.2), (0.2, 0.6), (1.5, 0.3), (1.7, 1.2), (0.5, 1.2)];
    let mut motions: Vec<Motion> = (0..)
        .zip(positions)
        .map(|(index, (x, y))| {
            let motion =
                Motion::new(RobotId::from_index(index), Arc::new(model()), shared.clone(), Pose::new(x, y, 0.0));
            motion.with_contact(ContactRule::Slide { friction: 0.3 }).expect("a friction")
        })
        .collect();
    let crate_of = |mass: f64| {
        Arc::new(Properties {
            mass,
            centre_of_mass: DVec2::ZERO,
            parts: vec![Part {
                shape: Shape::Rectangle { half: DVec2::splat(0.06) },
                object_from_part: Pose::default(),
            }],
            resistance: Resistance::Sliding(0.4),
            restitution: 0.0,
            contact_friction: 0.3,
            lift: 0.0,
        })
    };
    let objects = crates.iter().zip([0.75, 1.3]).map(|(mass, x)| (crate_of(*mass), Pose::new(x, 0.75, 0.2)));
    let mut world = World::new(shared, slot, &mut motions).with_objects(objects);
    while world.slot_start() < Time::from_millis(20_000) {
        let now = world.slot_start();
        for motion in &mut motions {
            if random.chance(0.03) {
                let command = Twist::new(random.between(-0.4, 0.4), random.between(-2.0, 2.0));
                let touching = world.touching(motion, now);
                motion.command(now, Command::Twist(command), &touching).expect("valid");
            }
        }
        world.advance(&mut motions.iter_mut().collect::<Vec<_>>());
        let at = world.slot_start();
        let centres: Vec<DVec2> = motions.iter_mut().map(|motion| motion.pose(at).position).collect();
        for (index, centre) in centres.iter().enumerate() {
            let gap = oracle::clearance(&walls, *centre, RADIUS);
            assert!(gap > SKIN - 2e-9, "wall: gap {gap} at {at}, seed {seed}");
            for other in &centres[..index] {
                let gap = (*centre - *other).length() - 2.0 * RADIUS;
                assert!(gap > SKIN - 2e-9, "robots: gap {gap} at {at}, seed {seed}");
            }
        }
    }
    let distance: f64 = motions.iter_mut().map(|motion| motion.path_length(world.slot_start())).sum();
    assert!(distance > 5.0, "{distance} m together");
}

#[test]
fn robots_in_a_crowd_never_overlap() {
    for seed in 0..12 {
        for slot in [7, 50] {
            crowd(seed, Time::from_millis(slot), &[]);
        }
    }
}

#[test]
fn robots_never_overlap_crates() {
    for seed in 0..6 {
        crowd(seed, Time::from_millis(50), &[0.2, 5.0]);
    }
}
