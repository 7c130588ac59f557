//! Readings of the three sensors of France et al. (1999) on the leg of a robot that walks on a floor towards a step.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::{
    RobotId,
    contact::Thing,
    math,
    object::{Figure as Body, Shape, Solid},
    pose::{Link, Pose, Pose3},
    scene::{Surface, Walls},
    sensor::{Echo, Posture, RangeModel, RangeSensor, incidence},
    time::Time,
    world::{Ray, Space, World},
};

/// Readings at one instant of the walk; the three sensors are at the same point of the leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start of the walk, s.
    pub seconds: f64,
    /// Distance along the ray to the surface that it hits, m.
    pub exact: f64,
    /// Incidence angle, rad.
    pub incidence: f64,
    /// True if the ray hits the step, false for the floor.
    pub is_on_step: bool,
    /// Reading of the laser range finder, m.
    pub laser: f64,
    /// Reading of the ultrasonic sensor, m.
    pub ultrasonic: f64,
    /// Reading of the reflectance sensor, m.
    pub reflectance: f64,
}

/// Duration of the walk, s.
pub const WALK: f64 = 12.0;
/// Speed of the robot, m/s.
const SPEED: f64 = 0.1;
/// Period of the gait, s.
const GAIT_PERIOD: f64 = 1.5;
/// x of the step's front face, m; the walk starts at 0.
const STEP_X: f64 = 2.0;
/// Height of the step, m.
const STEP_HEIGHT: f64 = 0.25;

/// Samples of the walk, `period` seconds apart.
///
/// The shin hangs from the knee, which is 0.45 m above the floor, and swings about the knee. The sensors are on the
/// shin, 0.15 m from the knee, and point ahead and down by 12 to 57 degrees. This gives incidence angles on the floor
/// from 33 to 78 degrees, as in the paper. The readings have no noise.
///
/// Source: France et al. 1999, section 6.3 (the sensors and the range of incidence angles). The dimensions of robot,
/// gait and step are our choice.
///
/// # Panics
/// If `period` is 0, or so small that the samples exceed the maximum size of a vector. With a negative `period` there
/// are no samples.
pub fn walk(period: f64) -> Vec<Sample> {
    let world = world_with_step();
    let robot_from_knee = Pose3 { position: DVec3::new(0.0, 0.0, 0.45), ..Pose3::IDENTITY };
    let shin = [Link { parent: None, origin: robot_from_knee, axis: DVec3::Y, joint: Some(0) }];
    let mount = Pose3 { position: DVec3::new(0.0, 0.0, -0.15), ..Pose3::IDENTITY };
    let count = (WALK / period) as usize;
    let sample_at = |seconds: f64| {
        // A positive pitch about y lowers the shin's x axis.
        let pitch = (34.5 + 22.5 * math::sin(TAU * seconds / GAIT_PERIOD)) / 180.0 * PI;
        let world_from_robot = Pose::new(SPEED * seconds, 0.0, 0.0);
        let posture = Posture { world_from_robot, links: &shin, angles: &[pitch], lift: 0.0 };
        let read = |model| {
            let sensor = RangeSensor { mount, link: Some(0), model };
            let reading = sensor.read(&world.caster(ROBOT, Time::ZERO), &posture, 0.0);
            reading.distance.expect("these sensors always read a distance")
        };
        let ray = posture.world_from(&mount, Some(0));
        let hit = world
            .cast(ROBOT, &Ray::new(ray.position, ray.forward(), 9.0), Time::ZERO)
            .expect("the ray falls onto something");
        Sample {
            seconds,
            exact: hit.distance,
            incidence: incidence(ray.forward(), hit.face.expect("a ray in space meets faces").normal),
            is_on_step: hit.thing != Thing::Floor,
            laser: read(RangeModel::Laser(Echo::LASER)),
            ultrasonic: read(RangeModel::Ultrasonic(Echo::ULTRASONIC)),
            reflectance: read(RangeModel::Reflectance(Echo::REFLECTANCE)),
        }
    };
    (0..count).map(|index| sample_at(index as f64 * period)).collect()
}

const ROBOT: RobotId = RobotId(1);

/// World with a floor and a step across the robot's path.
fn world_with_step() -> World {
    let half = DVec2::new(0.5, 2.0);
    let solid = Solid::Prism {
        footprint: Shape::Rectangle { half },
        body_from_footprint: Pose::new(STEP_X + half.x, 0.0, 0.0),
        bottom: 0.0,
        top: STEP_HEIGHT,
    };
    let step = Body { solids: vec![solid], surface: Surface::default() };
    let walls = Arc::new(Walls::new(Vec::new()));
    let space = Space { fixed: vec![(Pose::default(), Arc::new(step))], ..Space::default() };
    World::new(walls, Time::from_millis(50), std::iter::empty()).with_space(space)
}
