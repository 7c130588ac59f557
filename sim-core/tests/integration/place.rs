//! Placements of robots and objects: changed and unchanged state, and the view of other robots.

use std::{f64::consts::PI, sync::Arc};

use glam::DVec2;
use proptest::prelude::*;
use sim_core::{
    ObjectId, RobotId,
    contact::{SKIN, Thing},
    drive::{Command, DriveKind, Gains, Model, Motion},
    object::{Part, Properties, Resistance, Shape},
    pose::{PlacementError, Pose, Twist},
    scene::{Segment, Walls},
    time::Time,
    world::{Contact, Ray, World},
};

const RADIUS: f64 = 0.1;
const SLOT: Time = Time::from_millis(50);
const CRATE: ObjectId = ObjectId(1);
const BALL: ObjectId = ObjectId(2);

fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.05,
        max_wheel_rate: 1e3,
        ticks_per_turn: 540.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.02,
        max_speed: 10.0,
        max_turn: 100.0,
        body_radius: RADIUS,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 2.0,
        traction: 0.5,
    }
}

fn room(size: f64) -> Vec<Segment> {
    let corner = |x: f64, y: f64| DVec2::new(x * size, y * size);
    let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect()
}

struct Scene {
    world: World,
    motions: Vec<Motion>,
    contacts: Vec<Contact>,
}

impl Scene {
    /// Robots at `poses` in a room of 4 m.
    fn new(poses: &[Pose]) -> Self {
        Self::with(model(), SLOT, poses)
    }

    fn with(model: Model, slot: Time, poses: &[Pose]) -> Self {
        let walls = Arc::new(Walls::new(room(4.0)));
        let model = Arc::new(model);
        let mut motions: Vec<_> = (0..)
            .map(RobotId::from_index)
            .zip(poses)
            .map(|(id, pose)| Motion::new(id, model.clone(), walls.clone(), *pose))
            .collect();
        let world = World::new(walls, slot, &mut motions);
        Self { world, motions, contacts: Vec::new() }
    }

    /// Adds a crate of 10 cm and a ball of 4 cm.
    fn with_objects(mut self, crate_at: Pose, ball_at: Pose) -> Self {
        let object = |shape, resistance| {
            Arc::new(Properties {
                mass: 0.2,
                centre_of_mass: DVec2::ZERO,
                parts: vec![Part { shape, object_from_part: Pose::default() }],
                resistance,
                restitution: 0.5,
                contact_friction: 0.3,
                lift: 0.0,
            })
        };
        let crate_ = object(Shape::Rectangle { half: DVec2::splat(0.05) }, Resistance::Sliding(0.4));
        let ball = object(Shape::Disc { radius: 0.02 }, Resistance::Rolling(0.02));
        self.world = self.world.with_objects([(crate_, crate_at), (ball, ball_at)]);
        self
    }

    fn command(&mut self, robot: usize, at: Time, command: Command) {
        let touching = self.world.touching(&mut self.motions[robot], at);
        self.motions[robot].command(at, command, &touching).expect("a valid command");
    }

    fn drive(&mut self, robot: usize, at: Time, v: f64, omega: f64) {
        self.command(robot, at, Command::Twist(Twist::new(v, omega)));
    }

    fn advance(&mut self) {
        let mut active: Vec<_> = self.motions.iter_mut().filter(|motion| motion.is_active()).collect();
        self.contacts.extend(self.world.advance(&mut active));
    }

    fn run(&mut self, seconds: f64) {
        let end = self.world.slot_start() + Time::from_seconds_ceil(seconds);
        while self.world.slot_start() < end {
            self.advance();
        }
    }

    fn position(&mut self, robot: usize) -> DVec2 {
        let now = self.world.slot_start();
        self.motions[robot].pose(now).position
    }

    fn sees(&self, origin: DVec2, direction: DVec2, at: Time) -> (f64, Thing) {
        let hit = self.world.cast(RobotId(9), &Ray::flat(origin, direction, 9.0), at).expect("walls all around");
        (hit.distance, hit.thing)
    }
}

#[test]
fn placement_changes_only_the_true_pose() {
    for wheel_lag in [0.0, 0.1] {
        let lame = Model { wheel_lag, ..model() };
        let mut scene = Scene::with(lame, SLOT, &[Pose::new(1.0, 1.0, 0.5)]);
        let gains = Gains { vv: 7.0, tv: 0.3, vw: 7.0, tw: 0.1 };
        scene.motions[0].start_control(Time::ZERO, gains).expect("valid gains");
        scene.command(0, Time(7), Command::Drive { displacement: Twist::new(0.8, 1.0), duration: 2.0 });
        let at = Time(712_345);
        let before = scene.motions[0].state(at);
        let target = Pose::new(3.0, 0.7, -2.0);
        scene.motions[0].place(at, target).expect("a valid place");
        let motion = &mut scene.motions[0];
        let after = motion.state(at);
        let pose = motion.pose(at);
        assert!((pose.position - target.position).length() < 1e-15 && pose.heading == target.heading, "{pose:?}");
        assert_eq!(
            (after.odometry, after.wheels, after.path_length),
            (before.odometry, before.wheels, before.path_length)
        );
        assert_eq!(motion.state(at - Time(1)).world_from_axle.heading.turns(), 0, "what has been stays");
        assert!(motion.pose(at - Time(1)).position.distance(target.position) > 1.0);
        assert!(motion.is_drive_done(at) && !motion.is_moving(at) && motion.drive_remaining(at) == 0.0);
        assert_eq!(motion.speed(at), Twist::ZERO);
        scene.run(1.0);
        assert_eq!(scene.motions[0].pose(Time(1_700_000)), pose, "it stays");
        assert_eq!(scene.motions[0].state(Time(1_700_000)), after);
    }
}

#[test]
fn placement_sets_the_whole_turns() {
    let mut motion = Motion::new(RobotId(1), Arc::new(model()), Arc::new(Walls::new(vec![])), Pose::default());
    let displacement = Twist::new(0.0, 9.0 * PI);
    motion.command(Time::ZERO, Command::Drive { displacement, duration: 1.0 }, &[]).expect("valid");
    let at = motion.drive_end().expect("the drive ends");
    motion.place(at, Pose::new(1.0, 0.0, PI / 2.0)).expect("a valid place");
    let heading = motion.pose(at).heading;
    assert_eq!((heading.turns(), heading.remainder()), (0, PI / 2.0));
    assert!((motion.odometry(at).heading.radians() - 9.0 * PI).abs() < 1e-14);
}

#[test]
fn invalid_placements_are_rejected() {
    let mut scene = Scene::new(&[Pose::new(1.0, 1.0, 0.0)]).with_objects(Pose::new(2.0, 2.0, 0.0), Pose::default());
    for bad in [f64::NAN, f64::INFINITY, -2e9, 1e300] {
        for pose in [Pose::new(bad, 0.0, 0.0), Pose::new(0.0, bad, 0.0)] {
            assert_eq!(scene.motions[0].place(Time::ZERO, pose), Err(PlacementError));
            assert_eq!(scene.world.place_object(CRATE, pose), Err(PlacementError));
        }
    }
    assert!(!scene.motions[0].is_active(), "nothing has changed");
    assert_eq!(scene.motions[0].pose(Time::ZERO), Pose::new(1.0, 1.0, 0.0));
}

#[test]
fn other_robots_see_a_placement_from_the_next_slot_on() {
    let mut scene = Scene::new(&[Pose::new(1.0, 1.0, 0.0), Pose::new(1.0, 3.0, 0.0)]);
    let at = Time(20_000);
    scene.motions[0].place(at, Pose::new(3.0, 1.0, 1.0)).expect("valid");
    // Halfway between the two positions.
    let (middle, old, new) = (DVec2::new(2.0, 0.5), DVec2::new(1.0, 0.5), DVec2::new(3.0, 0.5));
    let first = Thing::Robot(RobotId(1));
    let looks = |scene: &Scene, at: Time| {
        [old, middle, new].map(|point| matches!(scene.sees(point, DVec2::Y, at), (_, thing) if thing == first))
    };
    for micros in [0, 19_999, 20_000, 49_999] {
        assert_eq!(looks(&scene, Time(micros)), [true, false, false], "{micros} us");
        assert_eq!(scene.world.robot_pose(RobotId(1), Time(micros)), Pose::new(1.0, 1.0, 0.0));
    }
    scene.advance();
    for (micros, expected) in
        [(0, [true, false, false]), (49_999, [true, false, false]), (50_000, [false, false, true])]
    {
        assert_eq!(looks(&scene, Time(micros)), expected, "{micros} us");
    }
    let observed_pose = scene.world.robot_pose(RobotId(1), Time(50_000));
    assert!(
        (observed_pose.position - DVec2::new(3.0, 1.0)).length() < 1e-15 && observed_pose.heading.remainder() == 1.0
    );
    assert!((scene.sees(new, DVec2::Y, Time(50_000)).0 - 0.4).abs() < 1e-12);
    scene.run(0.3);
    assert_eq!(looks(&scene, scene.world.slot_start()), [false, false, true]);
    assert_eq!(scene.contacts, []);
}

#[test]
fn placement_touches_nothing_between_the_two_poses() {
    // Robot 1 is placed from one side of robot 2 to the other, while robot 2 drives across the line between them.
    let mut scene = Scene::new(&[Pose::new(0.5, 1.0, 0.0), Pose::new(2.0, 0.98, PI / 2.0)]);
    scene.drive(0, Time::ZERO, 0.2, 0.0);
    scene.drive(1, Time::ZERO, 0.5, 0.0);
    scene.motions[0].place(Time(31_000), Pose::new(3.5, 1.0, PI)).expect("valid");
    scene.advance();
    assert_eq!(scene.contacts, []);
    assert!((scene.position(0) - DVec2::new(3.5, 1.0)).length() < 1e-15);
    // Robot 1 is placed outside the room and then back in it, through walls.
    scene.motions[0].place(Time(60_000), Pose::new(-7.0, 1.0, PI)).expect("valid");
    scene.advance();
    scene.motions[0].place(Time(110_000), Pose::new(0.5, 3.0, PI)).expect("valid");
    scene.drive(0, Time(110_000), 0.1, 0.0);
    scene.advance();
    assert_eq!(scene.contacts, []);
    assert!((scene.position(0) - DVec2::new(0.496, 3.0)).length() < 1e-12);
}

#[test]
fn robot_placed_in_front_of_another_is_touched() {
    let mut scene = Scene::new(&[Pose::new(0.5, 1.0, 0.0), Pose::new(2.0, 3.0, 0.0)]);
    scene.drive(0, Time::ZERO, 0.5, 0.0);
    // Robot 2 is placed 5 mm in front of robot 1.
    scene.motions[1].place(Time(20_000), Pose::new(0.5 + 0.01 + 0.005 + 2.0 * RADIUS, 1.0, 0.0)).expect("valid");
    scene.advance();
    let contact = scene.contacts[0];
    assert_eq!((scene.contacts.len(), contact.robot, contact.with), (1, RobotId(1), Thing::Robot(RobotId(2))));
    assert!((contact.time.seconds() - 0.03).abs() < 1e-5, "{contact:?}");
    assert!((scene.position(0).x - (0.515 - SKIN)).abs() < 1e-8);
    // When the blocking robot is placed elsewhere at the end of the slot, the path is free at once.
    let end = scene.world.slot_end();
    scene.motions[1].place(end, Pose::new(2.0, 3.0, 0.0)).expect("valid");
    scene.advance();
    assert!(!scene.motions[0].is_stalled(end));
    scene.run(0.1);
    assert!((scene.position(0).x - (0.515 + 0.05)).abs() < 1e-5);
}

/// Distance that a robot covers in 0.4 s at 0.5 m/s with this heading, if the robot is placed so that it overlaps a
/// resting robot by `depth` m.
fn distance_out_of_a_robot(depth: f64, heading: f64) -> f64 {
    let mut scene = Scene::new(&[Pose::new(1.0, 2.0, 0.0), Pose::new(2.0, 2.0, 0.0)]);
    let deep = Pose::new(2.0 - (2.0 * RADIUS - depth), 2.0, heading);
    scene.motions[0].place(Time(10_000), deep).expect("valid");
    scene.advance();
    assert!(!scene.motions[0].is_stalled(SLOT), "it only stands there");
    scene.drive(0, SLOT, 0.5, 0.0);
    let stalls = scene.motions[0].is_stalled(SLOT);
    scene.run(0.4);
    let distance = scene.position(0).distance(deep.position);
    assert_eq!(distance < 0.1, stalls, "{depth} m deep, heading {heading}: {distance} m");
    distance
}

#[test]
fn robot_placed_into_a_robot_can_leave_but_not_go_deeper() {
    let headings: Vec<f64> = (0..12).map(|step| f64::from(step) * PI / 6.0).collect();
    for depth in [0.05, 0.15, 0.199] {
        for &heading in &headings {
            let leaves = heading > PI / 2.0 - 1e-9 && heading < 1.5 * PI + 1e-9;
            let distance = distance_out_of_a_robot(depth, heading);
            assert!(
                (distance - if leaves { 0.2 } else { 0.0 }).abs() < 1e-9,
                "{depth} m deep, heading {heading}: {distance}"
            );
        }
    }
    // With equal centres, rounding decides the direction towards the other robot.
    let exits = headings.iter().filter(|&&heading| distance_out_of_a_robot(2.0 * RADIUS, heading) > 0.1).count();
    assert!(exits >= 5, "{exits} of 12 headings");
}

#[test]
fn robot_placed_into_a_wall_can_leave_but_not_go_deeper() {
    for depth in [1e-7, 0.05, 0.1] {
        for heading in 0..12 {
            let angle = f64::from(heading) * PI / 6.0;
            let mut scene = Scene::new(&[Pose::new(2.0, 2.0, 0.0)]);
            let deep = Pose::new(4.0 - RADIUS + depth, 2.0, angle);
            scene.motions[0].place(Time(10_000), deep).expect("valid");
            scene.drive(0, Time(10_000), 0.5, 0.0);
            scene.run(0.3);
            let moved = scene.position(0) - deep.position;
            // With its centre on the wall's line the robot may leave to either side.
            let is_on_line = depth > RADIUS - 1e-12;
            let leaves = heading % 6 == 3 || is_on_line || (4..9).contains(&heading);
            assert_eq!(moved.length() > 0.1, leaves, "{depth} m deep, heading {angle}: {moved}");
            assert!(moved.is_finite() && (leaves || moved.length() < 1e-6));
        }
    }
}

#[test]
fn placement_of_a_blocked_robot_is_replayed() {
    // Robot 2 stops robot 1 before the time of the placement; the placement is then replayed.
    let mut scene = Scene::new(&[Pose::new(1.0, 1.0, 0.0), Pose::new(1.0 + 2.0 * RADIUS + 0.005, 1.0, PI)]);
    scene.drive(0, Time::ZERO, 0.5, 0.0);
    scene.motions[0].place(Time(30_000), Pose::new(3.0, 3.0, PI / 2.0)).expect("valid");
    scene.drive(0, Time(40_000), 0.1, 0.0);
    scene.advance();
    assert_eq!(scene.contacts.len(), 1);
    assert!((scene.position(0) - DVec2::new(3.0, 3.001)).length() < 1e-12);
    assert!((scene.motions[0].path_length(SLOT) - 0.006).abs() < 2e-6);
}

#[test]
fn contact_after_a_placement_is_new() {
    // Contact with robot 2 and the crate, placement back, and contact again, all within 100 ms.
    let start = [Pose::new(1.0, 1.0, 0.0), Pose::new(1.0 + 2.0 * RADIUS + 0.001, 1.0, 0.0)];
    for is_place in [true, false] {
        let crate_at = Pose::new(1.0 - RADIUS - 0.051, 1.0, 0.0);
        let mut scene = Scene::with(model(), Time(10_000), &start).with_objects(crate_at, Pose::new(3.0, 3.0, 0.0));
        for round in 0..3 {
            let at = Time(round * 30_000);
            for (wait, v) in [(0, 0.4), (10_000, 0.0), (10_001, -0.4), (20_000, 0.0)] {
                while at + Time(wait) >= scene.world.slot_end() {
                    scene.advance();
                }
                scene.drive(0, at + Time(wait), v, 0.0);
            }
            if is_place {
                scene.motions[0].place(at + Time(25_000), start[0]).expect("valid");
            }
            scene.world.place_object(CRATE, crate_at).expect("valid");
        }
        scene.run(0.1);
        let with = |thing| scene.contacts.iter().filter(|contact| contact.with == thing).count();
        let times = if is_place { 3 } else { 1 };
        assert_eq!(with(Thing::Robot(RobotId(2))), times, "{:?}", scene.contacts);
        assert_eq!(with(Thing::Object(CRATE)), times, "{:?}", scene.contacts);
    }
}

#[test]
fn published_poses_match_true_poses_during_the_slot() {
    let mut scene = Scene::new(&[Pose::new(1.0, 1.0, 0.3), Pose::new(3.0, 3.0, 3.0)]);
    scene.drive(0, Time::ZERO, 0.4, 1.3);
    scene.command(1, Time(3), Command::Drive { displacement: Twist::new(0.0, -3.0), duration: 0.13 });
    scene.advance();
    for slot in 1..6 {
        for micros in [0, 1, 17_003, 31_000, 49_999] {
            let at = Time(slot * 50_000 + micros);
            for robot in [0, 1] {
                let truth = scene.motions[robot].pose(at);
                let observed_pose = scene.world.robot_pose(RobotId::from_index(robot), at);
                assert!(
                    (observed_pose.position - truth.position).length() < 1e-15,
                    "{observed_pose:?} instead of {truth:?} at {at:?}"
                );
                let difference = observed_pose.heading.turned(-truth.heading.remainder()).remainder();
                assert!(
                    difference.abs() < 1e-15 && observed_pose.heading.turns() == truth.heading.turns(),
                    "{observed_pose:?}, {truth:?}"
                );
                let body = scene.world.body(RobotId::from_index(robot), at);
                assert_eq!(body.centre, observed_pose.position);
            }
        }
        scene.advance();
    }
}

#[test]
fn object_placement_takes_effect_in_the_next_slot() {
    let mut scene = Scene::new(&[]).with_objects(Pose::new(1.0, 1.0, 0.0), Pose::new(2.0, 2.0, 0.0));
    scene.run(0.2);
    assert_eq!(scene.world.moved_objects(), []);
    let (now, end) = (scene.world.slot_start(), scene.world.slot_end());
    scene.world.place_object(CRATE, Pose::new(9.0, 9.0, 9.0)).expect("valid");
    let target = Pose::new(3.0, 0.5, -1.0);
    scene.world.place_object(CRATE, target).expect("valid");
    assert_eq!(scene.world.object_pose(CRATE, now), Pose::new(1.0, 1.0, 0.0));
    scene.advance();
    assert_eq!(scene.world.moved_objects(), [CRATE], "the other one sleeps on");
    assert_eq!(scene.world.object_pose(CRATE, end - Time(1)), Pose::new(1.0, 1.0, 0.0));
    assert_eq!(scene.world.object_pose(CRATE, end), target);
    assert_eq!(scene.sees(DVec2::new(3.0, 2.0), DVec2::NEG_Y, end).1, Thing::Object(CRATE));
    assert_ne!(scene.sees(DVec2::new(1.0, 2.0), DVec2::NEG_Y, end).1, Thing::Object(CRATE));
    for _ in 0..10 {
        scene.advance();
        assert_eq!(scene.world.moved_objects(), []);
        assert_eq!(scene.world.object_state(CRATE).world_from_object, target);
    }
    assert!(!scene.world.is_object_moving());
}

#[test]
fn ball_placed_into_a_wall_is_pushed_out_before_the_world_rests() {
    for slot in [1_000, 7_500, 50_000] {
        let mut scene =
            Scene::with(model(), Time(slot), &[]).with_objects(Pose::new(1.0, 1.0, 0.0), Pose::new(2.0, 2.0, 0.0));
        scene.world.place_object(BALL, Pose::new(3.99, 2.0, 0.0)).expect("valid");
        scene.advance();
        let mut slots = 0;
        while scene.world.is_object_moving() {
            scene.advance();
            slots += 1;
            assert!(slots * slot < 10_000_000, "it comes to rest");
        }
        let x = scene.world.object_state(BALL).world_from_object.position.x;
        assert!(x < 4.0 - 0.02 + 1e-4, "{x} in slots of {slot} us");
    }
}

#[test]
fn placed_object_rests_and_can_be_pushed() {
    let mut scene =
        Scene::new(&[Pose::new(2.0, 1.0, 0.0)]).with_objects(Pose::new(1.0, 1.0, 0.0), Pose::new(1.0, 2.0, 0.0));
    scene.world.set_object_velocity(BALL, DVec2::new(1.0, 0.0), 0.0);
    scene.run(0.5);
    assert!(scene.world.is_object_moving());
    // 2 mm outside the robot's rim.
    let target = Pose::new(2.0 + RADIUS + 0.02 + 0.002, 1.0, 0.0);
    scene.world.place_object(BALL, target).expect("valid");
    scene.advance();
    assert_eq!(scene.world.object_state(BALL).world_from_object, target);
    assert!(scene.world.object_state(BALL).is_resting());
    let now = scene.world.slot_start();
    scene.drive(0, now, 0.3, 0.0);
    scene.run(0.5);
    assert_eq!(scene.contacts.len(), 1);
    assert!(scene.world.object_state(BALL).world_from_object.position.x > target.position.x + 0.1);
}

#[test]
fn objects_placed_into_obstacles_are_pushed_out_slowly() {
    let robot = Pose::new(2.0, 2.0, 0.0);
    let beside = Pose::new(1.0, 1.0, 0.0);
    let cases = [
        (Pose::new(4.0, 2.0, 0.3), beside),
        (Pose::new(4.0, 4.0, 0.0), beside),
        (robot, beside),
        (Pose::new(2.05, 2.0, 0.0), robot),
        (beside, beside),
        (Pose::new(-5.0, 2.0, 0.0), Pose::new(1e9, -1e9, 0.0)),
    ];
    for (crate_at, ball_at) in cases {
        let mut scene = Scene::new(&[robot]).with_objects(Pose::new(0.5, 3.5, 0.0), Pose::new(3.5, 0.5, 0.0));
        scene.run(0.1);
        scene.world.place_object(CRATE, crate_at).expect("valid");
        scene.world.place_object(BALL, ball_at).expect("valid");
        for _ in 0..100 {
            scene.advance();
            for object in [CRATE, BALL] {
                let state = scene.world.object_state(object);
                assert!(state.world_from_object.position.is_finite() && state.omega.is_finite(), "{state:?}");
                assert!(state.velocity.length() < 2.0, "{crate_at:?}, {ball_at:?}: {state:?}");
            }
        }
        assert!(!scene.world.is_object_moving(), "{crate_at:?}, {ball_at:?}: it comes to rest");
        assert_eq!(scene.position(0), robot.position);
        // The robot can drive on.
        let now = scene.world.slot_start();
        scene.drive(0, now, -0.3, 0.0);
        scene.run(0.5);
        assert!(scene.position(0).x < 1.9, "{crate_at:?}, {ball_at:?}");
    }
}

/// Entries of a script: microseconds since the previous entry, robot or object, and a pose or a speed.
fn script() -> impl Strategy<Value = Vec<(i64, usize, bool, [f64; 3])>> {
    let number = || prop_oneof![8 => 0.0..4.0_f64, 1 => -1e9..1e9_f64, 1 => Just(2.0)];
    let entry = (1_i64..120_000, 0_usize..4, any::<bool>(), [number(), number(), number()]);
    prop::collection::vec(entry, 1..40)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_placements_give_finite_numbers(
        script in script(),
        slot in prop_oneof![Just(1_000_i64), Just(50_000), Just(333_333)],
        wheel_lag in prop_oneof![2 => Just(0.0), 1 => Just(0.08)],
    ) {
        let poses = [Pose::new(1.0, 1.0, 0.0), Pose::new(3.0, 3.0, 1.0), Pose::new(1.0, 3.0, 2.0)];
        let mut scene = Scene::with(Model { wheel_lag, ..model() }, Time(slot), &poses)
            .with_objects(Pose::new(2.0, 2.0, 0.0), Pose::new(2.0, 1.0, 0.0));
        let mut at = Time::ZERO;
        for (wait, robot, is_place, [x, y, phi]) in script {
            at += Time(wait);
            while at >= scene.world.slot_end() {
                scene.advance();
                let now = scene.world.slot_start();
                for (index, motion) in scene.motions.iter_mut().enumerate() {
                    let (truth, seen) = (motion.pose(now), scene.world.robot_pose(RobotId::from_index(index), now));
                    prop_assert!(truth.position.is_finite() && truth.heading.radians().is_finite(), "{truth:?}");
                    let tolerance = 1e-15 * (1.0 + truth.position.length());
                    prop_assert!(truth.position.distance(seen.position) <= tolerance, "{truth:?} seen as {seen:?}");
                }
            }
            match (robot, is_place) {
                (3, true) => scene.world.place_object(CRATE, Pose::new(x, y, phi)).expect("valid"),
                (3, false) => scene.world.place_object(BALL, Pose::new(y, x, phi)).expect("valid"),
                (_, true) => scene.motions[robot].place(at, Pose::new(x, y, phi)).expect("valid"),
                (_, false) => scene.drive(robot, at, 0.4 * (x - 2.0).clamp(-2.0, 2.0), y.clamp(-9.0, 9.0) - 2.0),
            }
            for object in [CRATE, BALL] {
                let pose = scene.world.object_pose(object, at);
                prop_assert!(pose.position.is_finite() && pose.heading.radians().is_finite(), "{pose:?}");
            }
        }
    }

    #[test]
    fn placements_of_a_single_robot_are_bit_identical_for_every_slot_length(script in script(), lag in any::<bool>()) {
        let run = |slot: i64| {
            let lame = Model { wheel_lag: if lag { 0.08 } else { 0.0 }, ..model() };
            let mut scene = Scene::with(lame, Time(slot), &[Pose::new(1.0, 1.0, 0.0)]);
            let mut at = Time::ZERO;
            let mut states = Vec::new();
            for &(wait, _, is_place, [x, y, phi]) in &script {
                at += Time(wait);
                while at >= scene.world.slot_end() {
                    scene.advance();
                }
                if is_place {
                    scene.motions[0].place(at, Pose::new(x, y, phi)).expect("valid");
                } else {
                    scene.drive(0, at, 0.4 * (x - 2.0).clamp(-2.0, 2.0), y.clamp(-9.0, 9.0) - 2.0);
                }
                states.push((scene.motions[0].state(at), scene.motions[0].contacts(at)));
            }
            states
        };
        let reference = run(50_000);
        for slot in [700, 10_000, 1_000_000] {
            prop_assert_eq!(&run(slot), &reference, "slots of {} us", slot);
        }
    }
}
