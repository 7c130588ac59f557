//! Robots among movable objects: pushing, kicking, stalling, sensing; slots of any length.

use std::sync::Arc;

use glam::DVec2;
use sim_core::{
    ObjectId, RobotId,
    contact::Thing,
    drive::{Command, DriveKind, Model, Motion},
    object::{GRAVITY, Part, Properties, Resistance, Shape},
    pose::{Pose, Twist},
    scene::Walls,
    time::Time,
    world::{Contact, Ray, World},
};

const RADIUS: f64 = 0.1;
const BOX: ObjectId = ObjectId(1);

fn model() -> Model {
    Model {
        kind: DriveKind::Differential,
        wheel_diameter: 0.05,
        max_wheel_rate: 1e6,
        ticks_per_turn: 540.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: 1e3,
        max_turn: 1e3,
        body_radius: RADIUS,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 2.0,
        traction: 0.5,
    }
}

fn object(shape: Shape, mass: f64, resistance: Resistance, restitution: f64) -> Arc<Properties> {
    Arc::new(Properties {
        mass,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape, object_from_part: Pose::default() }],
        resistance,
        restitution,
        contact_friction: 0.3,
        lift: 0.0,
    })
}

/// A crate of 10 cm.
fn crate_(mass: f64, friction: f64) -> Arc<Properties> {
    object(Shape::Rectangle { half: DVec2::splat(0.05) }, mass, Resistance::Sliding(friction), 0.0)
}

struct Scene {
    world: World,
    motions: Vec<Motion>,
    contacts: Vec<Contact>,
}

impl Scene {
    fn new(slot: Time, robots: &[Pose], objects: Vec<(Arc<Properties>, Pose)>) -> Self {
        let walls = Arc::new(Walls::new(vec![]));
        let model = Arc::new(model());
        let mut motions: Vec<_> = (0..)
            .map(RobotId::from_index)
            .zip(robots)
            .map(|(id, pose)| Motion::new(id, model.clone(), walls.clone(), *pose))
            .collect();
        let world = World::new(walls, slot, &mut motions).with_objects(objects);
        Self { world, motions, contacts: Vec::new() }
    }

    fn command(&mut self, robot: usize, command: Command) {
        let at = self.world.slot_start();
        let touching = self.world.touching(&mut self.motions[robot], at);
        self.motions[robot].command(at, command, &touching).expect("a valid command");
    }

    fn run(&mut self, seconds: f64) {
        let end = self.world.slot_start() + Time::from_seconds_ceil(seconds);
        while self.world.slot_start() < end {
            let mut active: Vec<_> = self.motions.iter_mut().filter(|motion| motion.is_active()).collect();
            self.contacts.extend(self.world.advance(&mut active));
        }
    }

    fn robot(&mut self, robot: usize) -> Pose {
        let now = self.world.slot_start();
        self.motions[robot].pose(now)
    }

    fn object(&self) -> DVec2 {
        self.world.object_state(BOX).world_from_object.position
    }
}

fn ahead(v: f64) -> Command {
    Command::Twist(Twist::new(v, 0.0))
}

const SLOT: Time = Time::from_millis(50);

#[test]
fn pushing_a_light_crate_keeps_the_path_bit_identical() {
    let objects = vec![(crate_(0.1, 0.4), Pose::new(0.3, 0.0, 0.0))];
    let mut scene = Scene::new(SLOT, &[Pose::default()], objects);
    scene.command(0, ahead(0.1));
    scene.run(5.0);
    // The impact reduces the speed by no more than traction restores in one step.
    let x = scene.robot(0).position.x;
    assert!((x - 0.5).abs() < 1e-6, "{x}");
    let gap = scene.object().x - 0.05 - (x + RADIUS);
    assert!(gap.abs() < 2e-4, "the crate is in front of the robot: gap {gap}");
    let pieces = scene.motions[0].revision();
    scene.run(1.0);
    assert_eq!(scene.motions[0].revision(), pieces, "no new piece while it pushes steadily");
    assert!((scene.robot(0).position.x - x - 0.1).abs() < 1e-15);
    assert_eq!(scene.contacts.len(), 1);
    assert_eq!(scene.contacts[0].with, Thing::Object(BOX));
    scene.command(0, Command::Halt);
    scene.run(1.0);
    assert!(!scene.world.is_object_moving());
}

#[test]
fn heavy_crate_stalls_the_wheels_and_does_not_move() {
    // Traction 0.5 * 2 kg, floor friction 0.5 * 3 kg.
    let objects = vec![(crate_(3.0, 0.5), Pose::new(0.3, 0.0, 0.0))];
    let mut scene = Scene::new(SLOT, &[Pose::default()], objects);
    scene.command(0, ahead(0.2));
    scene.run(2.0);
    let now = scene.world.slot_start();
    assert!(scene.motions[0].is_stalled(now));
    assert!(!scene.motions[0].is_moving(now));
    let (object, robot) = (scene.object().x, scene.robot(0).position.x);
    // After the impact both move at 0.08 m/s, until the excess of friction, 0.5 kg times gravity, stops them.
    let distance = 0.08 * 0.08 / (2.0 * 0.5 * GRAVITY / 5.0);
    assert!((object - 0.3 - distance).abs() < 2e-4, "{object} instead of {}", 0.3 + distance);
    let wheels = scene.motions[0].wheel_angles(now);
    scene.run(60.0);
    assert_eq!((scene.object().x, scene.robot(0).position.x), (object, robot), "nothing creeps");
    let now = scene.world.slot_start();
    assert_eq!(scene.motions[0].wheel_angles(now), wheels);
    assert!((robot + RADIUS + 0.05 - object).abs() < 2e-4);
    assert_eq!(scene.contacts.len(), 1, "one lasting contact");
    scene.command(0, ahead(-0.2));
    assert!(!scene.motions[0].is_stalled(now), "away it may go at once");
    scene.run(1.0);
    assert!((scene.robot(0).position.x - (robot - 0.2)).abs() < 1e-12);
}

#[test]
fn kicked_ball_leaves_with_the_speed_of_the_impact() {
    for restitution in [0.0, 0.6] {
        let ball = object(Shape::Disc { radius: 0.02 }, 0.05, Resistance::Rolling(0.0), restitution);
        let mut scene = Scene::new(SLOT, &[Pose::default()], vec![(ball, Pose::new(0.2, 0.0, 0.0))]);
        scene.command(0, ahead(0.4));
        scene.run(0.3);
        scene.command(0, Command::Halt);
        scene.run(0.7);
        let speed = scene.world.object_state(BOX).velocity.x;
        let blow = (1.0 + restitution) * 2.0 * 0.4 / 2.05;
        // Without restitution the robot accelerates the object to its own speed again.
        let expected = if restitution == 0.0 { 0.4 } else { blow };
        assert!((speed - expected).abs() < 2e-4, "{speed} instead of {expected}");
    }
}

#[test]
fn push_near_the_traction_limit_continues_slower() {
    // Traction of 0.5 * 2 kg against friction of 0.5 * 1.9 kg: the impact reduces the speed much, and traction restores
    // it slowly.
    let objects = vec![(crate_(1.9, 0.5), Pose::new(0.3, 0.0, 0.0))];
    let mut scene = Scene::new(SLOT, &[Pose::default()], objects);
    scene.command(0, ahead(0.3));
    scene.run(0.5 + 0.02);
    let now = scene.world.slot_start();
    let speed = scene.motions[0].speed(now).vx;
    let after_blow = 2.0 / 3.9 * 0.3;
    let gain = (0.5 * 2.0 - 0.5 * 1.9) * GRAVITY / 3.9;
    assert!(speed > after_blow - 0.02 && speed < after_blow + 0.05 * gain + 0.02, "{speed} near {after_blow}");
    scene.run(3.0);
    let now = scene.world.slot_start();
    assert!((scene.motions[0].speed(now).vx - 0.3).abs() < 1e-3, "{:?}", scene.motions[0].speed(now));
}

#[test]
fn slowed_drive_ends_at_its_target() {
    let objects = vec![(crate_(1.5, 0.4), Pose::new(0.3, 0.0, 0.0))];
    let mut scene = Scene::new(SLOT, &[Pose::default()], objects);
    scene.command(0, Command::Drive { displacement: Twist::new(0.5, 0.0), duration: 2.5 });
    let end = scene.motions[0].drive_end();
    scene.run(2.6);
    assert_ne!(scene.motions[0].drive_end(), end);
    scene.run(2.0);
    let now = scene.world.slot_start();
    assert!(scene.motions[0].is_drive_done(now));
    assert!((scene.robot(0).position.x - 0.5).abs() < 1e-12, "{:?}", scene.robot(0));
    let wheels = scene.motions[0].wheel_angles(now);
    assert!((wheels[0] - 0.5 / 0.025).abs() < 1e-9, "the wheels have turned as far as the robot went");
    assert_eq!(scene.motions[0].odometry(now).position.x, scene.robot(0).position.x);
}

#[test]
fn slot_length_changes_pushing_only_slightly() {
    let outcome = |slot: Time| {
        let objects = vec![
            (crate_(0.5, 0.4), Pose::new(0.3, 0.03, 0.2)),
            (object(Shape::Disc { radius: 0.03 }, 0.1, Resistance::Rolling(0.02), 0.5), Pose::new(0.5, 0.0, 0.0)),
        ];
        let mut scene = Scene::new(slot, &[Pose::default(), Pose::new(1.5, 0.02, 3.0)], objects);
        scene.command(0, ahead(0.3));
        scene.command(1, ahead(0.2));
        scene.run(2.0);
        scene.run(0.0);
        let ball = scene.world.object_state(ObjectId(2)).world_from_object.position;
        (scene.object(), ball, scene.robot(0).position)
    };
    let reference = outcome(Time::from_millis(1));
    for slot in [Time(500), Time(1_250), Time::from_millis(10), Time::from_millis(50), Time::from_millis(100)] {
        let other = outcome(slot);
        let distances = [(other.0 - reference.0), (other.1 - reference.1), (other.2 - reference.2)].map(DVec2::length);
        println!("slots of {slot}: {distances:?}");
        assert!(distances.iter().all(|metres| *metres < 5e-3), "{slot}: {distances:?}");
    }
}

#[test]
fn rays_hit_objects_at_their_published_poses() {
    let ball = object(Shape::Disc { radius: 0.02 }, 0.05, Resistance::Rolling(0.1), 0.5);
    let objects = vec![(ball, Pose::new(0.0, 0.5, 0.0)), (crate_(1.0, 0.5), Pose::new(1.0, 0.0, 0.0))];
    let mut scene = Scene::new(SLOT, &[Pose::new(-1.0, 0.0, 0.0)], objects);
    let see = |scene: &Scene, from: DVec2, along: DVec2, at: Time| {
        scene.world.cast(RobotId(1), &Ray::flat(from, along, 5.0), at)
    };
    let hit = see(&scene, DVec2::ZERO, DVec2::X, Time::ZERO).expect("the crate");
    assert_eq!((hit.distance, hit.thing), (0.95, Thing::Object(ObjectId(2))));
    let inside = see(&scene, DVec2::new(1.01, 0.01), DVec2::Y, Time::ZERO).expect("from inside");
    assert_eq!(inside.distance, 0.0);
    scene.world.set_object_velocity(BOX, DVec2::new(0.0, -0.4), 0.0);
    let at = Time::from_millis(20);
    let hit = see(&scene, DVec2::ZERO, DVec2::Y, at).expect("the ball");
    let distance = 0.4 * 0.02 - 0.5 * 0.1 * GRAVITY * 0.02 * 0.02;
    assert!((hit.distance - (0.5 - distance - 0.02)).abs() < 1e-12, "{hit:?}");
    scene.run(0.05);
    let late = see(&scene, DVec2::ZERO, DVec2::Y, at).expect("the ball as it was");
    assert_eq!(late, hit);
    let truth = scene.world.object_state(BOX).world_from_object.position;
    let public = scene.world.object_pose(BOX, scene.world.slot_start()).position;
    assert!((truth - public).length() < 1e-12);
}

#[test]
fn robot_at_rest_is_not_pushed() {
    let ball = object(Shape::Disc { radius: 0.05 }, 5.0, Resistance::Rolling(0.01), 0.5);
    let mut scene = Scene::new(SLOT, &[Pose::default()], vec![(ball, Pose::new(0.5, 0.0, 0.0))]);
    scene.world.set_object_velocity(BOX, DVec2::new(-1.0, 0.0), 0.0);
    scene.run(2.0);
    assert_eq!(scene.robot(0), Pose::default());
    // The ball moves 0.35 m to the robot, rebounds at half its speed, and moves away from the robot for the rest of the
    // time.
    let deceleration = 0.01 * GRAVITY;
    let there = (1.0 - 2.0 * deceleration * 0.35).sqrt();
    let remaining_distance = 0.5 * there - deceleration * (2.0 - (1.0 - there) / deceleration);
    let velocity = scene.world.object_state(BOX).velocity.x;
    assert!((velocity - remaining_distance).abs() < 1e-3, "{velocity} instead of {remaining_distance}");
}

#[test]
fn a_robot_regains_its_speed_when_its_obstacle_has_gone() {
    let speed = |scene: &mut Scene| {
        let now = scene.world.slot_start();
        scene.motions[0].speed(now).vx
    };
    // A crate that the robot cannot push is removed.
    let mut scene = Scene::new(SLOT, &[Pose::default()], vec![(crate_(50.0, 0.9), Pose::new(0.3, 0.0, 0.0))]);
    scene.command(0, ahead(0.3));
    scene.run(2.0);
    assert_eq!(speed(&mut scene), 0.0);
    scene.world.remove_object(BOX);
    scene.run(0.2);
    assert_eq!(speed(&mut scene), 0.3);
    // A ball rebounds and rolls away faster than the robot.
    let ball = object(Shape::Disc { radius: 0.05 }, 1.0, Resistance::Rolling(0.001), 1.0);
    let mut scene = Scene::new(SLOT, &[Pose::default()], vec![(ball, Pose::new(0.5, 0.0, 0.0))]);
    scene.command(0, ahead(2.0));
    scene.run(0.25);
    assert!(speed(&mut scene) < 1.5);
    scene.run(0.5);
    assert_eq!(speed(&mut scene), 2.0);
}

#[test]
fn scene_without_objects_builds_no_bodies() {
    let scene = Scene::new(SLOT, &[Pose::default()], vec![]);
    assert_eq!(scene.world.object_count(), 0);
    assert_eq!(scene.world.moved_objects(), &[]);
}
