//! Robots and objects added to and removed from a running world.

use std::{f64::consts::PI, sync::Arc};

use accuracy::world::Random;
use glam::{DVec2, DVec3};
use sim_core::{
    ObjectId, RobotId,
    contact::Thing,
    drive::{Command, DriveKind, Model, Motion},
    object::{Figure, Part, Properties, Resistance, Shape, Solid},
    pose::{Pose, Twist},
    scene::{Segment, Surface, Walls},
    time::Time,
    world::{Lifetime, Ray, Space, ThickWall, World},
};

const RADIUS: f64 = 0.1;
const SLOT: Time = Time::from_millis(50);

fn model() -> Arc<Model> {
    Arc::new(Model {
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
    })
}

fn ball(radius: f64) -> Arc<Properties> {
    Arc::new(Properties {
        mass: 0.05,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape: Shape::Disc { radius }, object_from_part: Pose::default() }],
        resistance: Resistance::Rolling(0.02),
        restitution: 0.5,
        contact_friction: 0.3,
        lift: 0.0,
    })
}

/// A world with the motions of its robots; motions of removed robots are not advanced.
struct Scene {
    walls: Arc<Walls>,
    world: World,
    motions: Vec<Motion>,
}

impl Scene {
    fn new(robots: &[Pose], objects: &[Pose], walls: Vec<Segment>) -> Self {
        let walls = Arc::new(Walls::new(walls));
        let motion =
            |(index, pose): (usize, &Pose)| Motion::new(RobotId::from_index(index), model(), walls.clone(), *pose);
        let mut motions: Vec<_> = robots.iter().enumerate().map(motion).collect();
        let world = World::new(walls.clone(), SLOT, &mut motions);
        let world = world.with_objects(objects.iter().map(|pose| (ball(0.05), *pose)));
        Self { walls, world, motions }
    }

    fn add_robot(&mut self, pose: Pose) -> RobotId {
        let id = RobotId::from_index(self.motions.len());
        let start = self.world.slot_start();
        let mut motion = Motion::new(id, model(), self.walls.clone(), pose).starting_at(start);
        self.world.add_robot(&mut motion, None);
        self.motions.push(motion);
        id
    }

    fn add_object(&mut self, pose: Pose) -> ObjectId {
        self.world.add_object(ball(0.05), pose, None).expect("a place")
    }

    fn drive(&mut self, robot: RobotId, v: f64) {
        let at = self.world.slot_start();
        let motion = &mut self.motions[robot.index()];
        let touching = self.world.touching(motion, at);
        motion.command(at, Command::Twist(Twist::new(v, 0.0)), &touching).expect("a valid command");
    }

    fn run(&mut self, seconds: f64) {
        let end = self.world.slot_start() + Time::from_seconds_ceil(seconds);
        while self.world.slot_start() < end {
            let now = self.world.slot_start();
            let world = &self.world;
            let is_active = |motion: &&mut Motion| motion.is_active() && world.is_robot_present(motion.id(), now);
            let mut active: Vec<_> = self.motions.iter_mut().filter(is_active).collect();
            self.world.advance(&mut active);
        }
    }

    fn robot(&mut self, robot: RobotId) -> DVec2 {
        let now = self.world.slot_start();
        self.motions[robot.index()].pose(now).position
    }

    fn object(&self, object: ObjectId) -> DVec2 {
        self.world.object_state(object).world_from_object.position
    }
}

fn r(number: u32) -> RobotId {
    RobotId(number)
}

fn o(number: u32) -> ObjectId {
    ObjectId(number)
}

/// Hits of a ray in the plane and of a ray in three dimensions.
type RayHits = (Option<(f64, Thing)>, Option<f64>);

/// Hits of rays from random origins.
fn look(world: &World, at: Time) -> Vec<RayHits> {
    let mut random = Random::new(7);
    let ray = |_| {
        let origin = DVec2::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0));
        let angle = random.between(-PI, PI);
        let direction = Pose::new(0.0, 0.0, angle).heading.direction();
        let plane =
            world.cast(r(u32::MAX), &Ray::flat(origin, direction, 3.0), at).map(|hit| (hit.distance, hit.thing));
        let tilted = direction.extend(random.between(-0.3, 0.3)).normalize_or(DVec3::X);
        let space = world.cast(r(u32::MAX), &Ray::new(origin.extend(0.2), tilted, 3.0), at).map(|seen| seen.distance);
        (plane, space)
    };
    (0..400).map(ray).collect()
}

fn places() -> [Pose; 3] {
    [place(-1.0, 0.0), place(1.0, 0.3), place(0.2, -1.2)]
}

fn place(x: f64, y: f64) -> Pose {
    Pose::new(x, y, 0.0)
}

#[test]
fn rays_hit_only_bodies_that_are_present() {
    let balls = [place(0.0, 0.9), place(-0.6, -0.7)];
    let mut scene = Scene::new(&places()[..2], &balls[..1], vec![]);
    scene.run(1.0);
    let before = look(&scene.world, Time::from_millis(1000));
    assert_eq!(before, look(&Scene::new(&places()[..2], &balls[..1], vec![]).world, Time::ZERO));

    let (robot, ball) = (scene.add_robot(places()[2]), scene.add_object(balls[1]));
    assert_eq!((robot, ball), (r(3), o(2)));
    let with = look(&Scene::new(&places(), &balls, vec![]).world, Time::ZERO);
    assert_ne!(with, before);
    assert_eq!(look(&scene.world, Time::from_millis(1000)), with, "they are seen at once");
    assert_eq!(look(&scene.world, Time::from_millis(999)), before, "and not before they came");
    scene.run(0.5);
    assert_eq!(look(&scene.world, Time::from_millis(1500)), with, "and as long as they stay");

    scene.world.remove_robot(robot);
    scene.world.remove_object(ball);
    assert_eq!(look(&scene.world, Time::from_millis(1500)), before, "nobody sees what is gone");
    assert_eq!(look(&scene.world, Time::from_millis(1499)), with, "but before it went");
    scene.run(0.5);
    assert_eq!(look(&scene.world, Time::from_millis(2000)), before);

    let (robot, ball) = (scene.add_robot(places()[2]), scene.add_object(balls[1]));
    assert_eq!((robot, ball), (r(4), o(3)), "numbers are not used again");
    scene.run(0.2);
    assert_eq!(scene.world.robot_lifetime(r(3)).until, Time::from_millis(1500));
    assert_eq!(scene.world.robot_lifetime(r(1)), Lifetime::ALWAYS);
    assert_eq!(scene.world.object_lifetime(ball).since, Time::from_millis(2000));
}

#[test]
fn adding_and_removing_distant_bodies_changes_nothing() {
    let play = |has_guests: bool| {
        let mut scene = Scene::new(&[place(0.0, 0.0), place(1.0, 0.01)], &[place(0.5, 0.0)], vec![]);
        scene.drive(r(1), 0.3);
        scene.run(0.35);
        if has_guests {
            let (robot, ball) = (scene.add_robot(place(50.0, 50.0)), scene.add_object(place(60.0, 50.0)));
            scene.drive(robot, 0.2);
            scene.run(0.2);
            scene.world.remove_robot(robot);
            scene.world.remove_object(ball);
        } else {
            scene.run(0.2);
        }
        scene.run(4.0);
        (scene.robot(r(1)), scene.robot(r(2)), scene.object(o(1)))
    };
    assert_eq!(play(false), play(true));
}

#[test]
fn added_body_behaves_like_an_initial_body() {
    let play = |comes_late: bool| {
        let at = place(1.0, 0.03);
        let robots = [place(-1.0, 0.0), at];
        let mut scene = Scene::new(if comes_late { &robots[..1] } else { &robots }, &[], vec![]);
        scene.drive(r(1), 0.3);
        scene.run(2.05);
        let robot = if comes_late { scene.add_robot(at) } else { r(2) };
        scene.run(1.0);
        scene.drive(robot, -0.4);
        scene.run(2.0);
        (scene.robot(r(1)), scene.robot(robot))
    };
    assert_eq!(play(false), play(true));
    let (first, second) = play(true);
    assert!((first.distance(second) - 2.0 * RADIUS).abs() < 1e-5, "they stand against each other, within 10 um");
}

#[test]
fn removed_body_no_longer_blocks() {
    let mut scene = Scene::new(&[place(0.0, 0.0), place(1.0, 0.0)], &[], vec![]);
    scene.drive(r(1), 0.5);
    scene.run(3.0);
    assert!((scene.robot(r(1)).x - 0.8).abs() < 1e-5, "it stands against the other, within 10 um");
    scene.world.remove_robot(r(2));
    scene.run(1.05);
    assert!((scene.robot(r(1)).x - 1.3).abs() < 1e-5, "a slot later it goes on with 0.5 m/s");
    let at = scene.world.slot_start();
    assert_eq!(scene.world.touching(&mut scene.motions[0], at), []);
}

#[test]
fn first_added_object_can_be_pushed_and_removed() {
    let mut scene = Scene::new(&[place(0.0, 0.0)], &[], vec![]);
    scene.drive(r(1), 0.3);
    // Not at the start, because the `Quiescence` of a single robot extends far into the future; the new object must end
    // it.
    scene.run(1.05);
    let ball = scene.add_object(place(1.0, 0.0));
    assert_eq!((ball, scene.world.object_count()), (o(1), 1));
    scene.run(4.0);
    assert!(scene.object(ball).x > 1.3, "it is pushed along: {}", scene.object(ball));
    let robot = scene.robot(r(1)).x;
    scene.world.remove_object(ball);
    let last = scene.object(ball);
    assert!(!scene.world.is_object_moving());
    scene.run(1.0);
    assert_eq!(scene.object(ball), last, "where it was last is known");
    assert!((scene.robot(r(1)).x - robot - 0.3).abs() < 1e-3, "the robot goes on alone, within 1 mm");
}

#[test]
fn removing_a_ball_between_two_others_works() {
    let balls = [place(0.0, 0.0), place(0.12, 0.0), place(0.24, 0.0)];
    let mut scene = Scene::new(&[place(-1.0, 5.0)], &balls, vec![]);
    scene.world.set_object_velocity(o(1), DVec2::X * 0.5, 0.0);
    scene.run(0.1);
    scene.world.remove_object(o(2));
    let there = scene.object(o(2));
    scene.run(3.0);
    assert_eq!(scene.object(o(2)), there);
    assert!(scene.object(o(1)).x < scene.object(o(3)).x - 0.1 + 1e-4, "those that are left do not overlap");
}

#[test]
fn object_added_inside_a_wall_is_pushed_out() {
    let wall = Segment::new(DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0));
    let mut scene = Scene::new(&[place(0.0, 0.0)], &[], vec![wall]);
    scene.run(0.1);
    let stuck = scene.add_object(place(0.97, 0.0));
    assert!(scene.world.is_object_moving());
    scene.run(2.0);
    assert!((scene.object(stuck).x - 1.0).abs() > 0.05 - 1e-4, "{}", scene.object(stuck));
    assert!(scene.world.add_object(ball(0.05), Pose::new(f64::NAN, 0.0, 0.0), None).is_err());
    assert_eq!(scene.world.object_count(), 1);
}

#[test]
fn overlapped_by_disc_finds_every_kind_of_obstacle() {
    let thick = Segment::new(DVec2::new(-2.0, 2.0), DVec2::new(2.0, 2.0));
    let mut walls: Vec<Segment> = thick.thickened(0.6).into();
    walls.push(Segment::new(DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0)));
    // A fixed crate of 1 m around (-3, 0).
    let corners = [(-3.5, -0.5), (-2.5, -0.5), (-2.5, 0.5), (-3.5, 0.5)].map(|(x, y)| DVec2::new(x, y));
    walls.extend((0..4).map(|side| Segment::new(corners[side], corners[(side + 1) % 4])));
    let mut scene = Scene::new(&[place(0.0, 0.0)], &[place(0.0, -1.0)], walls);
    let thick_walls = vec![ThickWall::new(sim_core::scene::WallId(0), &thick, 0.6, 0.3)];
    let space = Space { thick_walls, outlines: Some(sim_core::scene::WallId(5)), ..Space::default() };
    scene.world = scene.world.with_space(space);

    let overlapped = |x, y| scene.world.overlapped_by_disc(DVec2::new(x, y), RADIUS);
    assert_eq!(overlapped(0.5, 0.5), None);
    assert!(matches!(overlapped(0.95, 0.0), Some(Thing::Wall(_))), "too near to a wall");
    assert!(matches!(overlapped(0.3, 2.0), Some(Thing::Wall(_))), "within a wall");
    assert!(matches!(overlapped(-3.0, 0.0), Some(Thing::Wall(_))), "within a crate");
    assert_eq!(overlapped(0.15, 0.0), Some(Thing::Robot(r(1))));
    assert_eq!(overlapped(0.2, 0.0), None, "who touches does not overlap");
    assert_eq!(overlapped(0.0, -0.9), Some(Thing::Object(o(1))));
    assert_eq!(overlapped(0.9, 0.0), None, "who touches a wall does not overlap");
    scene.world.remove_robot(r(1));
    scene.world.remove_object(o(1));
    assert_eq!(scene.world.overlapped_by_disc(DVec2::new(0.1, 0.0), RADIUS), None);
    assert_eq!(scene.world.overlapped_by_disc(DVec2::new(0.0, -1.0), RADIUS), None);
}

#[test]
fn added_bodies_have_their_given_shapes() {
    let mut scene = Scene::new(&[place(-1.0, 0.0)], &[place(0.0, 3.0)], vec![]);
    scene.run(0.1);
    let low = Arc::new(Figure::cylinder(RADIUS, 0.1, Surface::default()));
    let mut motion = Motion::new(r(2), model(), scene.walls.clone(), place(1.0, 0.0)).starting_at(SLOT + SLOT);
    scene.world.add_robot(&mut motion, Some(low));
    let footprint = Shape::Disc { radius: 0.05 };
    let prism = Solid::Prism { footprint, body_from_footprint: Pose::default(), bottom: 0.0, top: 0.1 };
    let low_body = Arc::new(Figure { solids: vec![prism], surface: Surface::default() });
    scene.world.add_object(ball(0.05), place(2.0, 0.0), Some(low_body)).expect("a place");
    let at = SLOT + SLOT;
    let sees = |x: f64, z: f64| scene.world.cast(r(9), &Ray::new(DVec3::new(x, 0.0, z), DVec3::X, 1.0), at).is_some();
    assert!(sees(0.5, 0.05) && !sees(0.5, 0.15), "a low robot");
    assert!(sees(1.5, 0.05) && !sees(1.5, 0.15), "a low object");
    assert!(sees(-1.5, 0.15), "the one from the start is as high as it takes");
    let beside = scene.world.cast(r(9), &Ray::new(DVec3::new(-0.5, 3.0, 9.0), DVec3::X, 1.0), at);
    assert!(beside.is_some(), "and so is its object");
}
