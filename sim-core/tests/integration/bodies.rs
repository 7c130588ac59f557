//! Contacts between robots: which robots stop, where, and when they continue.

use std::{f64::consts::PI, sync::Arc};

use accuracy::world::Random;
use glam::DVec2;
use sim_core::{
    RobotId,
    contact::{SKIN, Thing},
    drive::{Command, DriveKind, Model, Motion},
    pose::{Pose, Twist},
    scene::{Segment, Walls},
    sensor::{Beam, Mount},
    time::Time,
    world::{Contact, World},
};

const RADIUS: f64 = 0.1;

/// A robot with practically unlimited speed.
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
        max_steering: PI / 4.0,
        mass: 1.0,
        traction: 0.6,
    }
}

/// Robots in a world, with slots of 50 ms by default.
struct Scene {
    world: World,
    motions: Vec<Motion>,
    contacts: Vec<Contact>,
}

impl Scene {
    fn new(poses: &[Pose]) -> Self {
        Self::with(poses, vec![], model(), Time::from_millis(50))
    }

    fn with(poses: &[Pose], walls: Vec<Segment>, model: Model, slot: Time) -> Self {
        let walls = Arc::new(Walls::new(walls));
        let model = Arc::new(model);
        let mut motions: Vec<_> = (0..)
            .map(RobotId::from_index)
            .zip(poses)
            .map(|(id, pose)| Motion::new(id, model.clone(), walls.clone(), *pose))
            .collect();
        let world = World::new(walls, slot, &mut motions);
        Self { world, motions, contacts: Vec::new() }
    }

    fn command(&mut self, robot: usize, at: Time, command: Command) {
        let touching = self.world.touching(&mut self.motions[robot], at);
        self.motions[robot].command(at, command, &touching).expect("a valid command");
    }

    fn twist(&mut self, robot: usize, v: f64, omega: f64) {
        self.command(robot, self.world.slot_start(), Command::Twist(Twist::new(v, omega)));
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

    fn gap(&mut self, a: usize, b: usize) -> f64 {
        (self.position(a) - self.position(b)).length() - 2.0 * RADIUS
    }

    fn is_stalled(&mut self, robot: usize) -> bool {
        let now = self.world.slot_start();
        self.motions[robot].is_stalled(now)
    }
}

/// Returns true if the gap is the skin, plus the tolerance of the contact search.
fn is_skin(gap: f64) -> bool {
    gap > 0.0 && gap < SKIN + 2e-9
}

#[test]
fn head_on_collision_stops_both_robots() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 0.0, PI)]);
    scene.twist(0, 0.3, 0.0);
    scene.twist(1, 0.1, 0.0);
    scene.run(5.0);
    assert!(is_skin(scene.gap(0, 1)), "gap {}", scene.gap(0, 1));
    assert!((scene.position(0).x - 0.3 / 0.4 * 0.8).abs() < 2e-6, "the distances have the ratio of the speeds");
    assert!(scene.is_stalled(0) && scene.is_stalled(1));
    assert_eq!(scene.contacts.len(), 2, "{:?}", scene.contacts);
    assert!(scene.contacts.iter().all(|contact| contact.time == Time(1_999_998)), "{:?}", scene.contacts);
    assert_eq!(scene.contacts[0].with, Thing::Robot(RobotId(2)));
    assert!((scene.contacts[0].point - DVec2::new(0.7, 0.0)).length() < 1e-5);
}

#[test]
fn robot_at_rest_blocks_another_and_does_not_move() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 0.05, 0.0)]);
    scene.twist(0, 0.5, 0.0);
    scene.run(4.0);
    assert!(is_skin(scene.gap(0, 1)));
    assert_eq!(scene.position(1), DVec2::new(1.0, 0.05));
    assert!(scene.is_stalled(0) && !scene.is_stalled(1));
    let now = scene.world.slot_start();
    assert_eq!((scene.motions[0].contacts(now), scene.motions[1].contacts(now)), (1, 0));
    // Pushing again is not a new contact. The robot can drive back.
    scene.twist(0, 0.2, 0.0);
    scene.run(1.0);
    let now = scene.world.slot_start();
    assert!(is_skin(scene.gap(0, 1)) && scene.motions[0].contacts(now) == 1);
    let position = scene.position(0);
    scene.twist(0, -0.2, 0.0);
    scene.run(1.0);
    assert!((scene.position(0) - position + DVec2::new(0.2, 0.0)).length() < 1e-12 && !scene.is_stalled(0));
}

#[test]
fn contact_with_a_robot_is_known_at_the_end_of_its_slot() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 0.0, 0.0)]);
    // 0.8 m at 0.51 m/s: within the slot from 1.55 s to 1.6 s.
    scene.twist(0, 0.5, 0.0);
    scene.twist(1, -0.01, 0.0);
    scene.run(1.6);
    let [impact] = scene.motions[0].impacts(Time::ZERO, Time::from_millis(1_600))[..] else { panic!("one impact") };
    assert!((impact.time.seconds() - 0.8 / 0.51).abs() < 1e-5, "{impact:?}");
    assert_eq!(impact.known_at, Time::from_millis(1_600));
    // If a query ends after the impact but before the end of its slot, the next query returns the impact.
    assert_eq!(scene.motions[0].impacts(Time::from_millis(1_590), Time::from_millis(1_600)), [impact]);
    assert_eq!(scene.motions[0].impacts(Time::from_millis(1_601), Time::from_millis(1_650)), []);
}

#[test]
fn blocked_drive_continues_to_its_target_when_the_path_is_free() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(0.5, 0.0, PI / 2.0)]);
    let drive = Command::Drive { displacement: Twist::new(1.0, 0.0), duration: 2.0 };
    scene.command(0, Time::ZERO, drive);
    scene.run(3.0);
    assert!(scene.is_stalled(0) && scene.motions[0].drive_end().is_none());
    let now = scene.world.slot_start();
    assert!((scene.motions[0].drive_remaining(now) - 0.7).abs() < 1e-5);
    scene.twist(1, 0.5, 0.0);
    scene.run(3.0);
    assert!((scene.position(0) - DVec2::new(1.0, 0.0)).length() < 1e-12, "{:?}", scene.position(0));
    let now = scene.world.slot_start();
    assert!(scene.motions[0].is_drive_done(now) && scene.motions[0].drive_remaining(now) == 0.0);
    assert_eq!(scene.motions[0].contacts(now), 1);
}

#[test]
fn pursuing_robots_never_overlap() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(0.5, 0.0, 0.0)]);
    scene.twist(0, 0.5, 0.0);
    scene.twist(1, 0.2, 0.0);
    for _ in 0..200 {
        scene.advance();
        assert!(scene.gap(0, 1) > 0.0, "gap {}", scene.gap(0, 1));
    }
    assert!(scene.gap(0, 1) < 0.5 * 0.05, "the follower stays close behind");
    assert!((scene.position(1).x - 2.5).abs() < 1e-9, "the one in front is not held up");
}

#[test]
fn commands_after_a_contact_start_at_the_contact_position() {
    let mut scene =
        Scene::with(&[Pose::new(0.0, 0.0, 0.0), Pose::new(0.5, 0.0, 0.0)], vec![], model(), Time::from_millis(1_000));
    // Contact after 0.3 s; the command at 0.4 s drives towards the other robot again, the command at 0.5 s drives back.
    scene.twist(0, 1.0, 0.0);
    scene.command(0, Time::from_millis(400), Command::Twist(Twist::new(2.0, 0.1)));
    scene.command(0, Time::from_millis(500), Command::Twist(Twist::new(-0.5, 0.0)));
    let pose = scene.motions[0].pose(Time::from_millis(390));
    assert!(pose.position.x > 0.3, "before the slot's end the pose ignores the contact: {pose:?}");
    scene.advance();
    let truth = 0.3 - SKIN - 0.5 * 0.5;
    assert!((scene.position(0).x - truth).abs() < 1e-8, "{:?}", scene.position(0));
    assert_eq!(scene.position(0).y, 0.0);
    let now = scene.world.slot_start();
    assert!((scene.motions[0].odometry(now).position.x - truth).abs() < 1e-8, "the wheels stood still as well");
    assert_eq!(scene.contacts.len(), 1);
}

#[test]
fn three_robots_in_a_row_stop_in_sequence() {
    let poses = [Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 0.0, 0.0), Pose::new(2.0, 0.0, 0.0)];
    let mut scene = Scene::with(&poses, vec![], model(), Time::from_millis(10_000));
    scene.twist(0, 1.0, 0.0);
    scene.twist(1, 0.5, 0.0);
    scene.advance();
    // The second robot reaches the third after 1.6 s and stops; the first robot also reaches the second at 1.6 s.
    assert!(is_skin(scene.gap(0, 1)) && is_skin(scene.gap(1, 2)));
    assert_eq!(scene.position(2), DVec2::new(2.0, 0.0));
}

#[test]
fn overlapping_bodies_can_separate_but_not_go_deeper() {
    for (v, moves) in [(0.2, false), (-0.2, true)] {
        let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(0.15, 0.0, 0.0)]);
        scene.twist(0, v, 0.0);
        scene.run(1.0);
        assert_eq!(scene.position(0).x != 0.0, moves);
        assert!(moves || scene.is_stalled(0));
    }
}

#[test]
fn fast_bodies_do_not_tunnel_in_a_long_slot() {
    let mut scene = Scene::with(
        &[Pose::new(-50.0, 0.0, 0.0), Pose::new(50.0, 0.0, PI), Pose::new(0.0, 90.0, -PI / 2.0)],
        vec![],
        model(),
        Time::from_millis(1_000),
    );
    scene.twist(0, 100.0, 0.0);
    scene.twist(1, 100.0, 0.0);
    // The third robot passes the point at which the other two have collided.
    scene.twist(2, 100.0, 0.0);
    scene.advance();
    assert!(is_skin(scene.gap(0, 1)), "{}", scene.gap(0, 1));
    assert!(scene.position(0).x.abs() < 0.11);
    assert!(is_skin(scene.gap(0, 2).min(scene.gap(1, 2))));
}

#[test]
fn order_of_motions_has_no_effect() {
    let mut random = Random::new(3);
    let poses: Vec<_> =
        (0..30).map(|i| Pose::new(f64::from(i % 6) * 0.25, f64::from(i / 6) * 0.25, random.between(-PI, PI))).collect();
    let run = |order: i32| {
        let mut random = Random::new(4);
        let mut scene = Scene::new(&poses);
        for _ in 0..60 {
            for robot in 0..poses.len() {
                let at = scene.world.slot_start() + Time(random.below(50_000) as i64);
                let command = Command::Twist(Twist::new(random.between(-1.0, 1.0), random.between(-3.0, 3.0)));
                scene.command(robot, at, command);
            }
            let mut active: Vec<_> = scene.motions.iter_mut().collect();
            match order {
                1 => active.reverse(),
                2 => active.sort_by_key(|motion| motion.id().0 * 17 % 31),
                _ => {}
            }
            scene.contacts.extend(scene.world.advance(&mut active));
            for a in 0..poses.len() {
                for b in 0..a {
                    assert!(scene.gap(a, b) > 0.0, "{a} and {b} overlap by {}", -scene.gap(a, b));
                }
            }
        }
        let positions: Vec<_> = (0..poses.len()).map(|robot| scene.position(robot)).collect();
        (positions, scene.contacts)
    };
    let reference = run(0);
    assert!(reference.1.len() > 100, "a crowd: {} contacts", reference.1.len());
    assert!(reference == run(1) && reference == run(2));
}

#[test]
fn other_robots_are_seen_at_their_published_poses() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(1.0, 0.0, 0.0)]);
    let beam = Beam { mount: Mount::new(0.05, 0.0, 0.0), range: 2.0 };
    let see = |scene: &mut Scene, at: Time| {
        let pose = scene.motions[0].pose(at);
        beam.distance(&scene.world, RobotId(1), &pose, at)
    };
    assert_eq!(see(&mut scene, Time::ZERO), Some(0.85));
    // A command within the slot is published at its end.
    scene.command(1, Time::from_millis(10), Command::Twist(Twist::new(0.5, 0.0)));
    assert_eq!(see(&mut scene, Time::from_millis(40)), Some(0.85));
    scene.advance();
    let now = Time::from_millis(50);
    assert!((see(&mut scene, now).expect("in range") - 0.87).abs() < 1e-12);
    assert!((see(&mut scene, now + Time::from_millis(20)).expect("in range") - 0.88).abs() < 1e-12);
    // The published motion of a past instant does not change.
    assert_eq!(see(&mut scene, Time::from_millis(40)), Some(0.85));
    scene.advance();
    assert_eq!(see(&mut scene, Time::from_millis(40)), Some(0.85));
    assert!((see(&mut scene, now).expect("in range") - 0.87).abs() < 1e-12);
    scene.run(3.0);
    assert_eq!(see(&mut scene, Time::from_millis(3_050)), None, "out of range");
}

#[test]
fn ray_from_inside_another_body_has_distance_zero() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0), Pose::new(0.3, 0.0, 0.0)]);
    let cast = |scene: &mut Scene, x: f64, angle: f64, range: f64| {
        let pose = scene.motions[0].pose(Time::ZERO);
        Beam { mount: Mount::new(x, 0.0, angle), range }.cast(&scene.world, RobotId(1), &pose, Time::ZERO)
    };
    assert_eq!(cast(&mut scene, 0.25, 2.0, 1.0).map(|hit| hit.distance), Some(0.0));
    assert_eq!(cast(&mut scene, 0.0, PI, 5.0), None);
    let hit = cast(&mut scene, 0.0, 0.0, 0.2).expect("the range is closed");
    assert!((hit.distance - 0.2).abs() < 1e-15 && hit.thing == Thing::Robot(RobotId(2)));
    assert_eq!(cast(&mut scene, 0.0, 0.0, 0.2 - 1e-9), None);
}

#[test]
fn robots_with_wheel_lag_block_each_other_and_are_released() {
    let lagging = Model { wheel_lag: 0.05, ..model() };
    for slot in [Time::from_millis(50), Time(7_000)] {
        let poses = [Pose::new(0.0, 0.0, 0.0), Pose::new(0.5, 0.0, PI / 2.0)];
        let mut scene = Scene::with(&poses, vec![], lagging.clone(), slot);
        scene.twist(0, 0.5, 0.0);
        scene.run(2.0);
        assert!(is_skin(scene.gap(0, 1)), "gap {}", scene.gap(0, 1));
        let now = scene.world.slot_start();
        assert_eq!(scene.motions[0].contacts(now), 1, "slots of {slot}");
        scene.twist(1, 0.5, 0.0);
        scene.run(2.0);
        assert!(scene.position(0).x > 0.6, "{:?}", scene.position(0));
    }
}

#[test]
fn world_at_rest_can_skip_slots() {
    let mut scene = Scene::new(&[Pose::new(0.0, 0.0, 0.0)]);
    scene.command(0, Time::ZERO, Command::Drive { displacement: Twist::new(0.1, 0.0), duration: 0.2 });
    scene.run(0.5);
    assert!(!scene.motions[0].is_active());
    scene.world.advance_to(Time::from_millis(3_600_000));
    scene.twist(0, 1.0, 0.0);
    scene.run(1.0);
    assert!((scene.position(0).x - 1.1).abs() < 1e-9);
}
