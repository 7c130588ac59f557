//! A single robot, for which the world skips most work, behaves bit-identically to a robot with a distant neighbour.

use std::sync::Arc;

use accuracy::{course::model, world::Random};
use glam::DVec2;
use sim_core::{
    RobotId,
    contact::Thing,
    drive::{Command, Gains, Imperfection, Model, Motion},
    noise::TwistNoise,
    object::{Part, Properties, Resistance, Shape},
    pose::{Pose, Twist},
    scene::{Segment, Walls},
    time::Time,
    world::{Ray, World},
};

const LONE: RobotId = RobotId(1);
const OTHER: RobotId = RobotId(2);

struct Scene {
    world: World,
    motions: Vec<Motion>,
}

impl Scene {
    fn new(kind: DriveVariant, slot: Time, poses: &[Pose]) -> Self {
        let corner = |x: f64, y: f64| DVec2::new(x, y);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let walls = Arc::new(Walls::new((0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect()));
        let wheel_lag = if kind == DriveVariant::Lagging { 0.05 } else { 0.0 };
        let model = Arc::new(Model { wheel_lag, ..model() });
        let noise = TwistNoise { speed: 0.05, turn: 0.05, ..TwistNoise::default() };
        let erring = Imperfection { command: noise, ..Imperfection::default() };
        let imperfection = if kind == DriveVariant::Erring { erring } else { Imperfection::default() };
        let mut motions: Vec<Motion> = (0..)
            .zip(poses)
            .map(|(index, pose)| {
                let motion = Motion::new(RobotId::from_index(index), Arc::clone(&model), Arc::clone(&walls), *pose);
                motion.with_imperfection(7, imperfection).expect("valid errors")
            })
            .collect();
        Self { world: World::new(walls, slot, &mut motions), motions }
    }

    /// Ends a slot; returns all observable state of the robot after it.
    fn advance(&mut self, ray: DVec2) -> String {
        let mut active: Vec<_> = self.motions.iter_mut().filter(|motion| motion.is_active()).collect();
        let contacts = self.world.advance(&mut active);
        let now = self.world.slot_start();
        let motion = &mut self.motions[0];
        let before = (now - Time(90_000)).max(Time::ZERO);
        let public = [before, now, self.world.slot_end() - Time(1)].map(|at| self.world.robot_pose(LONE, at));
        let hit = self.world.cast(OTHER, &Ray::flat(DVec2::ZERO, ray, 5.0), now);
        let truth = (motion.state(now), motion.speed(now), motion.is_active(), motion.is_stalled(now));
        let history = (motion.contacts(now), motion.impacts(before, now), motion.drive_end());
        format!("{contacts:?} {public:?} {hit:?} {truth:?} {history:?}")
    }
}

/// Hits of eight rays now and 90 ms ago, after an object has been added far away.
fn seen_beside_an_object(mut world: World) -> Vec<String> {
    let ball = Properties {
        mass: 1.0,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape: Shape::Disc { radius: 0.1 }, object_from_part: Pose::default() }],
        resistance: Resistance::Sliding(0.0),
        restitution: 1.0,
        contact_friction: 0.0,
        lift: 0.0,
    };
    world.add_object(Arc::new(ball), Pose::new(0.0, 1_000.0, 0.0), None).expect("a place");
    let now = world.slot_start();
    let instants = [now, (now - Time(90_000)).max(Time::ZERO)];
    let rays = (0..16).map(|index| {
        let (sin, cos) = sim_core::math::sin_cos(f64::from(index / 2) * std::f64::consts::FRAC_PI_4);
        let at = instants[index as usize % 2];
        format!(
            "{:?}",
            world.cast(OTHER, &Ray::flat(DVec2::new(-0.9 * cos, -0.9 * sin), DVec2::new(cos, sin), 5.0), at)
        )
    });
    rays.collect()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum DriveVariant {
    Perfect,
    Lagging,
    Erring,
}

#[test]
fn single_robot_is_bit_identical_to_a_robot_with_a_distant_neighbour() {
    let far = Pose::new(1_000.0, 0.0, 0.0);
    for (seed, kind) in [DriveVariant::Perfect, DriveVariant::Lagging, DriveVariant::Erring].into_iter().enumerate() {
        let mut contacts = 0;
        for slot in [317, 10_000, 50_000, 730_000] {
            let mut random = Random::new(seed as u64);
            let [mut alone, mut beside] =
                [&[Pose::default()][..], &[Pose::default(), far]].map(|poses| Scene::new(kind, Time(slot), poses));
            let count = (30_000_000 / slot).min(20_000);
            for index in 0..count {
                let at = alone.world.slot_start() + Time(random.below(slot as usize) as i64);
                let [v, omega] = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
                // A command about every 0.4 s.
                let is_command = random.chance((slot as f64 / 0.4e6).min(0.9));
                let choice = if is_command { random.below(14) } else { usize::MAX };
                for Scene { motions, .. } in [&mut alone, &mut beside] {
                    let motion = &mut motions[0];
                    match choice {
                        0..4 => _ = motion.command(at, Command::Twist(Twist::new(v, omega)), &[]),
                        4..10 => {
                            let displacement = Twist::new(v, omega);
                            _ = motion.command(at, Command::Drive { displacement, duration: 1.0 + v.abs() }, &[]);
                        }
                        10 => _ = motion.place(at, Pose::new(0.5 * v, 0.5 * omega, omega)),
                        11 => _ = motion.set_odometry(at, Pose::new(v, v, omega)),
                        12 => _ = motion.start_control(at, Gains { vv: 7.0, tv: 0.3, vw: 7.0, tw: 0.1 }),
                        13 => motion.stop_control(at),
                        _ => {}
                    }
                }
                let (sin, cos) = sim_core::math::sin_cos(index as f64);
                let [one, other] = [&mut alone, &mut beside].map(|scene| scene.advance(DVec2::new(cos, sin)));
                contacts += alone.motions[0].contacts(alone.world.slot_start());
                assert_eq!(one, other, "{kind:?}, slot {index} of {slot} us");
                if index % 41 == 0 {
                    let [one, other] = [&alone, &beside].map(|scene| seen_beside_an_object(scene.world.clone()));
                    assert_eq!(one, other, "{kind:?}, slot {index} of {slot} us, beside an object");
                }
            }
        }
        assert!(contacts > 0, "{kind:?} meets no wall");
    }
}

#[test]
fn removed_single_robot_is_dropped_once() {
    let slot = Time(50_000);
    let mut scene = Scene::new(DriveVariant::Erring, slot, &[Pose::default()]);
    scene.motions[0].command(Time::ZERO, Command::Twist(Twist::new(0.2, 0.5)), &[]).expect("a valid command");
    for _ in 0..3 {
        scene.world.advance(&mut [&mut scene.motions[0]]);
    }
    scene.world.remove_robot(LONE);
    for _ in 0..3 {
        scene.world.advance(&mut []);
        scene.world.advance_to(scene.world.slot_start() + Time(4 * slot.0));
    }
    let now = scene.world.slot_start();
    let mut motion = scene.motions[0].clone();
    motion = Motion::new(OTHER, Arc::new(model()), scene.world.walls().clone(), motion.pose(now)).starting_at(now);
    scene.world.add_robot(&mut motion, None);
    let eye = DVec2::new(-0.9, 0.0);
    let to_robot = motion.pose(now).position - eye;
    let hit = scene.world.cast(LONE, &Ray::flat(eye, to_robot.normalize_or_zero(), 5.0), now).expect("a robot");
    assert_eq!(hit.thing, Thing::Robot(OTHER));
}
