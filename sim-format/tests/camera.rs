//! The camera of a robot: time and pose of its exposures, their numbers, depths and labels.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DVec3;
use sim_core::build::{NoMeshes, Visuals};
use sim_core::camera::{Label, Picture, Scenery};
use sim_core::device::camera::{CameraError, READ_OUT, Setting};
use sim_core::drive::Command;
use sim_core::pose::{Pose, Twist};
use sim_core::simulation::{Options, Robot, Simulation};
use sim_core::spec::{RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_format::{MemoryFiles, MeshReader, load_scene, read_robi};

const ROBOT: RobotId = RobotId(1);

/// Simulation of a robot at (1, 0.5), facing y, with a camera 100 mm ahead, 50 mm to the left and 200 mm high.
fn bench() -> (Simulation, Arc<Scenery>) {
    let robi = "name Rover\ndiameter 200\nspeed 5000\nturn 720\nwheel 100 3600 1000 100\n\
                drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n\
                camera 100 50 200 SERVO1(-90,90) SERVO2(-45,45) 80 60\n";
    let (robi, _) = read_robi("rover.robi", robi);
    let robot = RobotSpec { robi: Arc::new(robi), start: Pose::new(1.0, 0.5, FRAC_PI_2), ..robot_of("S4") };
    let scene = SceneSpec { robots: vec![robot], ..SceneSpec::default() };
    let visuals = Visuals::new(&scene, &mut NoMeshes);
    let options = Options { slot: Some(Time::from_millis(100_000)), ..Options::default() };
    let simulation = Simulation::new(&scene, &options).expect("a robot that can be simulated");
    (simulation, Arc::clone(visuals.scenery()))
}

/// The only robot of a scene, of a built-in type.
fn robot_of(kind: &str) -> RobotSpec {
    let text = format!("[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"{kind}\"\nx_mm = 1000\ny_mm = 1500\n");
    scene(&text).robots.remove(0)
}

fn scene(text: &str) -> SceneSpec {
    let files: MemoryFiles = [("a.scene.toml", text)].into_iter().collect();
    let loaded = load_scene("a.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    loaded.scene
}

fn switch_on(simulation: &mut Simulation, size: [u32; 2]) {
    simulation.with_robot(ROBOT, |robot, _| robot.devices.camera.switch_on(Setting { size, ..Setting::default() }));
}

fn take(simulation: &mut Simulation, scenery: &Arc<Scenery>) -> Result<Picture<[u8; 3]>, CameraError> {
    simulation.with_robot(ROBOT, |robot, world| robot.take_colour(world, scenery))
}

#[test]
fn an_image_is_exposed_where_the_robot_was_a_sixtieth_of_a_second_ago() {
    let (mut simulation, scenery) = bench();
    switch_on(&mut simulation, [8, 6]);
    let early = take(&mut simulation, &scenery).map(|_| simulation.robot(ROBOT).devices.camera.last().map(|it| it.at));
    assert_eq!(early, Ok(Some(Time::ZERO)), "nothing was before");
    simulation.command(ROBOT, Command::Twist(Twist::new(3.0, 0.0))).expect("it drives");
    simulation.advance_to(Time(100_000) + READ_OUT);
    take(&mut simulation, &scenery).expect("an image");
    let exposure = simulation.robot(ROBOT).devices.camera.last().expect("the last image");
    assert_eq!((exposure.number, exposure.at), (2, Time(100_000)));
    // The robot is 300 mm farther. The camera is ahead and to the left; facing y, left is -x.
    let position = exposure.view.world_from_camera().position;
    assert!((position - DVec3::new(0.95, 0.9, 0.2)).length() < 1e-12, "{position}");
}

#[test]
fn servos_turn_the_camera() {
    let (mut simulation, _) = bench();
    simulation.advance_to(Time(200_000));
    simulation.with_robot(ROBOT, |robot, world| {
        robot.turn_servo(world, 0, 255);
        robot.turn_servo(world, 1, 0);
    });
    let ahead = |robot: &mut Robot, at| robot.camera_view(at, None).expect("a view").world_from_camera().forward();
    let before = simulation.with_robot(ROBOT, |robot, _| ahead(robot, Time(200_000)));
    assert!((before - DVec3::Y).length() < 1e-12, "not yet: {before}");
    // Pan to the left of y is -x; 45 degrees downwards.
    let after = simulation.with_robot(ROBOT, |robot, _| ahead(robot, Time(200_001)));
    let expected = DVec3::new(-1.0, 0.0, -1.0) * 0.5_f64.sqrt();
    assert!((after - expected).length() < 1e-12, "{after}");
}

#[test]
fn number_at_returns_the_number_that_an_image_had() {
    let (mut simulation, scenery) = bench();
    switch_on(&mut simulation, [8, 6]);
    for at in [100_000, 200_000, 900_000] {
        simulation.advance_to(Time(at) + READ_OUT);
        take(&mut simulation, &scenery).expect("an image");
    }
    let camera = &simulation.robot(ROBOT).devices.camera;
    // Old exposures are forgotten: for earlier instants the number of the last one is returned.
    assert_eq!([850_000, 900_000, 900_001].map(|at| camera.number_at(Time(at))), [3, 3, 4]);
    assert_eq!(camera.number_at(Time::ZERO), 3);
}

#[test]
fn without_a_camera_or_an_image_there_is_a_reason() {
    let (mut simulation, scenery) = bench();
    assert_eq!(take(&mut simulation, &scenery).err(), Some(CameraError::Off));
    switch_on(&mut simulation, [8, 6]);
    assert_eq!(simulation.depth(ROBOT).err(), Some(CameraError::NotTaken));
    take(&mut simulation, &scenery).expect("an image");
    assert_eq!(simulation.depth(ROBOT).map(|depth| depth.size()), Ok([8, 6]));
    switch_on(&mut simulation, [8, 6]);
    assert_eq!(simulation.labels(ROBOT).err(), Some(CameraError::NotTaken), "a new start");
    let off = |simulation: &mut Simulation| simulation.with_robot(ROBOT, |robot, _| robot.devices.camera.switch_off());
    assert_eq!([off(&mut simulation), off(&mut simulation)], [true, false]);
    assert_eq!(simulation.image(ROBOT).err(), Some(CameraError::NoScenery));
    assert_eq!(simulation.robot(ROBOT).devices.camera.setting, None, "nothing has changed");
}

/// Robot with a camera that sees another robot, a ball, a stone and a wall.
const SIGHT: &str = r#"
[world]
floor_mm = [4000, 3000]
wall = [{ from_mm = [3500, 0], to_mm = [3500, 3000] }]

[[robot]]
type = "LabBot"
x_mm = 1000
y_mm = 1500

[[robot]]
type = "S4"
x_mm = 2000
y_mm = 1800

[[object]]
type = "Soccer"
x_mm = 2000
y_mm = 1250
"#;

#[test]
fn colours_depths_and_labels_are_of_one_image() {
    let scene = scene(SIGHT);
    let mut simulation = Simulation::new(&scene, &Options::default()).expect("robots");
    simulation.set_visuals(Visuals::new(&scene, &mut MeshReader::new(&MemoryFiles::default())));
    simulation.advance_to(Time::from_millis(1_000));
    let image = simulation.image(ROBOT).expect("an image");
    let (depth, labels) = (simulation.depth(ROBOT).expect("depths"), simulation.labels(ROBOT).expect("labels"));
    assert_eq!((image.size(), depth.size(), labels.size()), ([320, 240], [320, 240], [320, 240]));
    let seen: std::collections::BTreeSet<Label> = labels.pixels().iter().copied().collect();
    let ball = Label::Object(ObjectId(1));
    let expected = [Label::Sky, Label::Ground, Label::Wall(0), ball, Label::Robot(RobotId(2))];
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), expected);
    for (depth, label) in depth.pixels().iter().zip(labels.pixels()) {
        assert_eq!(depth.is_infinite(), *label == Label::Sky, "only the sky is infinitely far away");
    }
    // The ball is at its true position as seen from the camera: nearest on the line to its centre.
    let view = simulation.robot(ROBOT).devices.camera.last().expect("an exposure").view;
    let nearest = depth.pixels().iter().zip(labels.pixels()).filter(|(_, label)| **label == ball);
    let nearest = nearest.map(|(depth, _)| *depth).fold(f32::INFINITY, f32::min);
    let expected = (view.world_from_camera().position - DVec3::new(2.0, 1.25, 0.1)).length();
    assert!((f64::from(nearest) - expected).abs() < 0.15, "{nearest} m to its surface, {expected} m to its middle");
}
