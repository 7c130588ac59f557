//! Cases of the study: trials with moving bodies, and the error of their final states.

use std::sync::Arc;

use glam::DVec2;
use sim_core::object::{Bodies, GRAVITY, Part, Properties, Pusher, Resistance, Shape};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Segment, Walls};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId, drive::Command, drive::Model, drive::Motion, world::World};

use super::impact::{Impact, slide_and_turn, stopping_distance};
use crate::course::model;
use crate::world::Random;

/// Bodies after the last step, and the maximum depth, in m, to which the second of two objects entered a wall at x = 0.
pub type EndState = (Bodies, f64);

/// Objects with velocities among walls, and a robot that may push them.
pub struct Trial {
    pub name: &'static str,
    pub seconds: f64,
    pub walls: Vec<Segment>,
    pub objects: Vec<(Arc<Properties>, Pose)>,
    /// Velocity, m/s, and turning speed, rad/s, of each object.
    pub velocities: Vec<(DVec2, f64)>,
    pub pusher: Option<Push>,
}

/// A robot of 100 mm radius and 3 kg that drives from the origin along x.
pub struct Push {
    pub speed: f64,
    /// Time at which the robot is removed, s.
    pub until: f64,
}

/// A trial whose exact end is known.
pub struct Case {
    pub trial: Trial,
    error_of_end: Box<dyn Fn(&EndState) -> f64>,
}

impl Case {
    /// Error with steps of `step`.
    pub fn error(&self, step: Time) -> f64 {
        (self.error_of_end)(&self.trial.run(step))
    }
}

const RADIUS: f64 = 0.05;
const PUSHER_RADIUS: f64 = 0.1;
const FREE: Resistance = Resistance::Sliding(0.0);

/// Names of the cases with collisions of two objects.
pub const IMPACTS: [&str; 7] = [
    "10 g between 5 kg and a wall: depth",
    "equal discs, elastic",
    "5 kg on 10 g, elastic",
    "off centre, restitution 0.5",
    "grazing, elastic",
    "50 m/s on a disc, elastic",
    "a crate struck off its centre",
];

/// Number of runs of each case, which start differently so that the impact happens at different times within a step.
pub const STARTS: usize = 4;
/// Delay of the impact from one start to the next, s; not a simple multiple of a step.
const START_DELAY: f64 = 2.637e-3;

impl Trial {
    /// Runs the trial in steps of `step`.
    pub fn run(&self, step: Time) -> EndState {
        let mut bodies = Bodies::new(&Walls::new(self.walls.clone()), self.objects.clone());
        bodies.set_step(step);
        for (index, (velocity, omega)) in self.velocities.iter().enumerate() {
            bodies.set_velocity(ObjectId::from_index(index), *velocity, *omega);
        }
        let steps = (self.seconds / step.seconds()).round() as i64;
        let mut pushes = Vec::new();
        let mut depth = 0.0_f64;
        for index in 0..steps {
            let pushers = self.pusher.as_ref().and_then(|push| push.at(index as f64 * step.seconds()));
            bodies.step(pushers.as_slice(), &mut pushes);
            if self.objects.len() == 2 {
                depth = depth.max(RADIUS - position(&bodies, 1).x);
            }
        }
        (bodies, depth)
    }
}

impl Push {
    fn at(&self, seconds: f64) -> Option<Pusher> {
        // The margin of half a microsecond is for rounding.
        (seconds < self.until - 5e-7).then(|| Pusher {
            robot: RobotId(1),
            centre: DVec2::new(self.speed * seconds, 0.0),
            velocity: DVec2::new(self.speed, 0.0),
            omega: 0.0,
            radius: PUSHER_RADIUS,
            mass: 3.0,
            is_immovable: false,
        })
    }
}

/// Cases that test positions and velocities, for one of the starts.
pub fn moving(start: usize) -> Vec<Case> {
    let delay = start as f64 * START_DELAY;
    let mut cases = vec![
        to_rest(),
        sliding_and_turning(),
        rebound(delay),
        rough_wall(0.5, delay),
        rough_wall(0.0, delay),
        fast_ball(delay),
        pushed_crate(delay),
        squeezed_ball(delay),
    ];
    cases.extend(impacts().map(|(name, impact)| collision(name, impact, delay, motion_error)));
    cases
}

/// Cases that test momentum and energy, for one of the starts.
pub fn conserving(start: usize) -> Vec<Case> {
    let delay = start as f64 * START_DELAY;
    let collisions = impacts().map(|(name, impact)| collision(name, impact, delay, conservation_error));
    collisions.into_iter().chain([crowd(start)]).collect()
}

fn disc(radius: f64, mass: f64, resistance: Resistance, restitution: f64) -> Arc<Properties> {
    object(Shape::Disc { radius }, mass, resistance, restitution, 0.0)
}

fn object(shape: Shape, mass: f64, resistance: Resistance, restitution: f64, friction: f64) -> Arc<Properties> {
    Arc::new(Properties {
        mass,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape, object_from_part: Pose::default() }],
        resistance,
        restitution,
        contact_friction: friction,
        lift: 0.0,
    })
}

/// A long wall perpendicular to the x axis.
fn wall(x: f64) -> Vec<Segment> {
    vec![Segment::new(DVec2::new(x, -100.0), DVec2::new(x, 100.0))]
}

fn position(bodies: &Bodies, index: usize) -> DVec2 {
    bodies.state(ObjectId::from_index(index)).world_from_object.position
}

/// Trial with one object at the origin.
fn single_object(name: &'static str, properties: Arc<Properties>, velocity: (DVec2, f64), seconds: f64) -> Trial {
    let objects = vec![(properties, Pose::default())];
    Trial { name, seconds, walls: vec![], objects, velocities: vec![velocity], pusher: None }
}

fn to_rest() -> Case {
    let (direction, speed, friction) = (DVec2::new(0.6, 0.8), 0.77, 0.4);
    let distance = stopping_distance(speed, friction);
    let properties = disc(RADIUS, 0.5, Resistance::Sliding(friction), 0.5);
    let trial = single_object("a disc slides to rest", properties, (direction * speed, 0.0), 0.5);
    Case {
        trial,
        error_of_end: Box::new(move |(bodies, _)| (position(bodies, 0) - direction * distance).length() / distance),
    }
}

fn sliding_and_turning() -> Case {
    let (distance, angle) = slide_and_turn(1.0, 20.0, 0.1, 0.4);
    let properties = disc(0.1, 0.5, Resistance::Sliding(0.4), 0.5);
    let trial = single_object("a disc slides and turns to rest", properties, (DVec2::X, 20.0), 1.0);
    let error = move |(bodies, _): &EndState| {
        let pose = bodies.state(ObjectId(1)).world_from_object;
        let angle_error = pose.heading.radians() / angle - 1.0;
        ((pose.position - DVec2::new(distance, 0.0)).length() / distance).max(angle_error.abs())
    };
    Case { trial, error_of_end: Box::new(error) }
}

/// A disc slides to a wall, rebounds and slides to rest.
fn rebound(delay: f64) -> Case {
    let (friction, restitution, speed) = (0.3, 0.6, 2.5_f64);
    let gap = 0.45 + speed * delay;
    let arrival = (speed * speed - 2.0 * friction * GRAVITY * gap).sqrt();
    let rebound_distance = stopping_distance(restitution * arrival, friction);
    let properties = disc(RADIUS, 0.5, Resistance::Sliding(friction), restitution);
    let name = "a disc rebounds and slides to rest";
    let trial = Trial { walls: wall(gap + RADIUS), ..single_object(name, properties, (DVec2::X * speed, 0.0), 1.0) };
    let end = DVec2::new(gap - rebound_distance, 0.0);
    Case {
        trial,
        error_of_end: Box::new(move |(bodies, _)| (position(bodies, 0) - end).length() / (gap + rebound_distance)),
    }
}

/// A disc hits a wall with friction and slips during the whole impact, so the tangential impulse is the coefficient of
/// friction times the normal impulse.
fn rough_wall(restitution: f64, delay: f64) -> Case {
    let (friction, seconds, start) = (0.1, 0.6, DVec2::new(1.2, 0.9));
    let gap = 0.4531 + start.x * delay;
    let tangential_change = friction * (1.0 + restitution) * start.x;
    let velocity_after = DVec2::new(-restitution * start.x, start.y - tangential_change);
    let omega = -tangential_change * RADIUS / (0.5 * RADIUS * RADIUS);
    let impact_time = gap / start.x;
    let end = start * impact_time + velocity_after * (seconds - impact_time);
    let properties = object(Shape::Disc { radius: RADIUS }, 0.5, FREE, restitution, friction);
    let name = if restitution > 0.0 { "a rough wall, restitution 0.5" } else { "a rough wall, inelastic" };
    let trial = Trial { walls: wall(gap + RADIUS), ..single_object(name, properties, (start, 0.0), seconds) };
    let error = move |(bodies, _): &EndState| {
        let state = bodies.state(ObjectId(1));
        let velocity_error = (state.velocity - velocity_after).length().max((state.omega - omega).abs() * RADIUS);
        let position_error = (state.world_from_object.position - end).length();
        (velocity_error / start.length()).max(position_error / (start.length() * seconds))
    };
    Case { trial, error_of_end: Box::new(error) }
}

/// An elastic disc of 4 mm diameter moves to and fro between two walls at 50 m/s.
fn fast_ball(delay: f64) -> Case {
    let (radius, x, speed, seconds) = (0.002, 0.5173, 50.0, 0.05);
    let lane = x - radius;
    let start = -speed * delay;
    // The path, unfolded at both walls, repeats with the period 4 * lane.
    let unfolded = (start + speed * seconds + lane).rem_euclid(4.0 * lane);
    let end = if unfolded <= 2.0 * lane { unfolded - lane } else { 3.0 * lane - unfolded };
    let trial = Trial {
        walls: [wall(x), wall(-x)].concat(),
        objects: vec![(disc(radius, 0.01, FREE, 1.0), Pose::new(start, 0.0, 0.0))],
        ..single_object(
            "50 m/s between walls, elastic",
            disc(radius, 0.01, FREE, 1.0),
            (DVec2::X * speed, 0.0),
            seconds,
        )
    };
    Case { trial, error_of_end: Box::new(move |(bodies, _)| (position(bodies, 0).x - end).abs() / (speed * seconds)) }
}

/// A robot pushes a crate at constant speed until the robot is removed; then the crate slides to rest.
fn pushed_crate(delay: f64) -> Case {
    let (speed, until) = (0.2, 1.5);
    let start = 0.3137 + speed * delay;
    let end = speed * until + PUSHER_RADIUS + RADIUS + stopping_distance(speed, 0.4);
    let crate_ = object(Shape::Rectangle { half: DVec2::splat(RADIUS) }, 1.0, Resistance::Sliding(0.4), 0.0, 0.3);
    let trial = Trial {
        name: "a robot pushes a crate and leaves it",
        seconds: 2.0,
        walls: vec![],
        objects: vec![(crate_, Pose::new(start, 0.0, 0.0))],
        velocities: vec![],
        pusher: Some(Push { speed, until }),
    };
    let error = move |(bodies, _): &EndState| (position(bodies, 0) - DVec2::new(end, 0.0)).length() / (end - start);
    Case { trial, error_of_end: Box::new(error) }
}

fn impacts() -> [(&'static str, Impact); 5] {
    let equal =
        Impact { masses: [0.2, 0.2], contact_distance: 2.0 * RADIUS, speed: 1.5, offset: 0.0, restitution: 1.0 };
    [
        ("equal discs, elastic", equal),
        ("5 kg on 10 g, elastic", Impact { masses: [5.0, 0.01], ..equal }),
        ("off centre, restitution 0.5", Impact { masses: [0.2, 0.3], offset: 0.06, restitution: 0.5, ..equal }),
        ("grazing, elastic", Impact { offset: 0.0995, ..equal }),
        ("50 m/s on a disc, elastic", Impact { speed: 50.0, offset: 0.03, ..equal }),
    ]
}

/// Error of a collision as a function of the impact, the distance of the centres along x at the start (m), the duration
/// (s), and the bodies.
type CollisionError = fn(&Impact, f64, f64, &Bodies) -> f64;

fn collision(name: &'static str, impact: Impact, delay: f64, error: CollisionError) -> Case {
    let initial_distance = 0.4137 + impact.speed * delay;
    // The trial ends after the impact, and its duration is a multiple of every step.
    let seconds = if impact.speed > 10.0 { 0.05 } else { 0.5 };
    let disc_of_mass = |mass| disc(RADIUS, mass, FREE, impact.restitution);
    let objects = vec![
        (disc_of_mass(impact.masses[0]), Pose::new(-initial_distance, -impact.offset, 0.0)),
        (disc_of_mass(impact.masses[1]), Pose::default()),
    ];
    let velocities = vec![(DVec2::new(impact.speed, 0.0), 0.0)];
    let trial = Trial { name, seconds, walls: vec![], objects, velocities, pusher: None };
    Case { trial, error_of_end: Box::new(move |(bodies, _)| error(&impact, initial_distance, seconds, bodies)) }
}

/// Maximum relative error of the velocities and positions of both bodies. The scale of a body is the initial speed, or
/// its own speed after the impact if that is higher; positions are relative to the path at this speed.
fn motion_error(impact: &Impact, initial_distance: f64, seconds: f64, bodies: &Bodies) -> f64 {
    let (velocities, positions) = (impact.velocities(), impact.positions(initial_distance, seconds));
    let body_error = |index: usize| {
        let velocity = bodies.state(ObjectId::from_index(index)).velocity;
        // A light disc is faster than the heavy one that hits it.
        let scale = impact.speed.max(velocities[index].length());
        let position_error = (position(bodies, index) - positions[index]).length() / (scale * seconds);
        ((velocity - velocities[index]).length() / scale).max(position_error)
    };
    body_error(0).max(body_error(1))
}

/// Larger of the errors of momentum and energy, relative to their initial values.
fn conservation_error(impact: &Impact, _: f64, _: f64, bodies: &Bodies) -> f64 {
    let initial_momentum = impact.masses[0] * impact.speed;
    let momentum_of = |index: usize| bodies.state(ObjectId::from_index(index)).velocity * impact.masses[index];
    let momentum_error = momentum_of(0) + momentum_of(1) - DVec2::new(initial_momentum, 0.0);
    let expected: f64 = impact
        .velocities()
        .iter()
        .zip(impact.masses)
        .map(|(velocity, mass)| 0.5 * mass * velocity.length_squared())
        .sum();
    let energy = (bodies.energy() - expected) / (0.5 * initial_momentum * impact.speed);
    (momentum_error.length() / initial_momentum).max(energy.abs())
}

/// 36 elastic discs in a box of 1 m for 1 s; the error is the relative change of the energy.
fn crowd(start: usize) -> Case {
    let mut random = Random::new(36 + start as u64);
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let walls = (0..4).map(|side| Segment::new(corners[side], corners[(side + 1) % 4])).collect();
    let (mut objects, mut velocities, mut energy) = (Vec::new(), Vec::new(), 0.0);
    for index in 0..36_u32 {
        let mass = random.between(0.05, 0.5);
        let velocity = random.direction() * random.between(0.2, 2.0);
        energy += 0.5 * mass * velocity.length_squared();
        let (x, y) = (0.125 + 0.15 * f64::from(index % 6), 0.125 + 0.15 * f64::from(index / 6));
        objects.push((disc(0.04, mass, FREE, 1.0), Pose::new(x, y, 0.0)));
        velocities.push((velocity, 0.0));
    }
    let trial = Trial { name: "36 discs in a box, elastic", seconds: 1.0, walls, objects, velocities, pusher: None };
    Case { trial, error_of_end: Box::new(move |(bodies, _)| (bodies.energy() / energy - 1.0).abs()) }
}

/// A crate of 5 kg pushes a ball of 10 g into a wall; the error is the ball's maximum depth in the wall, in ball radii.
fn squeezed_ball(delay: f64) -> Case {
    let heavy = object(Shape::Rectangle { half: DVec2::splat(0.1) }, 5.0, FREE, 0.5, 0.0);
    let trial = Trial {
        name: "10 g between 5 kg and a wall: depth",
        seconds: 1.0,
        walls: wall(0.0),
        objects: vec![
            (heavy, Pose::new(0.3 + delay, 0.0, 0.0)),
            (disc(RADIUS, 0.01, FREE, 0.9), Pose::new(0.06, 0.0, 0.0)),
        ],
        velocities: vec![(DVec2::new(-1.0, 0.0), 0.0)],
        pusher: None,
    };
    Case { trial, error_of_end: Box::new(|(_, depth)| depth / RADIUS) }
}

/// A disc hits a crate off its centre; the trial ends when both are at rest.
pub fn struck_crate() -> Trial {
    let crate_ = object(Shape::Rectangle { half: DVec2::splat(RADIUS) }, 0.5, Resistance::Sliding(0.4), 0.3, 0.3);
    let disc = object(Shape::Disc { radius: 0.03 }, 0.2, Resistance::Sliding(0.1), 0.3, 0.3);
    Trial {
        name: "a crate struck off its centre",
        seconds: 1.5,
        walls: vec![],
        objects: vec![(crate_, Pose::new(0.3, 0.0, 0.0)), (disc, Pose::new(0.0, 0.03, 0.0))],
        velocities: vec![(DVec2::ZERO, 0.0), (DVec2::new(1.5, 0.0), 0.0)],
        pusher: None,
    }
}

/// Duration of [`robot_and_heavy_crate`], s.
pub const PUSH_SECONDS: f64 = 2.0;

/// Relative error of the distance that a robot and a crate cover together. The robot (2 kg, traction 0.5) drives at
/// 0.2 m/s against the crate (3 kg, friction 0.5), whose friction stops both. The slots are 50 ms long.
pub fn robot_and_heavy_crate() -> f64 {
    let (mass, crate_mass, speed, coefficient) = (2.0, 3.0, 0.2, 0.5);
    let common_speed = mass * speed / (mass + crate_mass);
    let expected =
        common_speed * common_speed * (mass + crate_mass) / (2.0 * coefficient * GRAVITY * (crate_mass - mass));
    let walls = Arc::new(Walls::new(vec![]));
    let model = Model { body_radius: PUSHER_RADIUS, axis_offset: 0.0, mass, traction: coefficient, ..model() };
    let mut motion = Motion::new(RobotId(1), Arc::new(model), Arc::clone(&walls), Pose::default());
    let half = DVec2::splat(RADIUS);
    let crate_ = object(Shape::Rectangle { half }, crate_mass, Resistance::Sliding(coefficient), 0.0, 0.3);
    let mut world =
        World::new(walls, Time::from_millis(50), [&mut motion]).with_objects([(crate_, Pose::new(0.3, 0.0, 0.0))]);
    motion.command(Time::ZERO, Command::Twist(Twist::new(speed, 0.0)), &[]).expect("a speed within the limits");
    while world.slot_start().seconds() < PUSH_SECONDS {
        world.advance(&mut [&mut motion]);
    }
    let covered = world.object_state(ObjectId(1)).world_from_object.position.x - 0.3;
    (covered - expected).abs() / expected
}
