//! Steps a robot without a program: drives it, reads its sensors and camera, then branches from a snapshot.
//!
//! `cargo run --release -p sim-format --example step`

use sim_core::RobotId;
use sim_core::drive::Command;
use sim_core::pose::Twist;
use sim_core::simulation::{Options, Simulation};
use sim_core::time::Time;
use sim_format::{MemoryFiles, load_scene};

const SCENE: &str = r#"
[world]
floor_mm = [4000, 3000]
wall = [{ from_mm = [4000, 0], to_mm = [4000, 3000] }]

[[robot]]
type = "S4"
x_mm = 1000
y_mm = 1500
noise = "real"
"#;

/// Drives straight ahead at `v` m/s until an obstacle is nearer than 0.4 m, at most 10 s; returns the time and the
/// robot's x.
fn drive(simulation: &mut Simulation, v: f64) -> (Time, f64) {
    let robot = RobotId(1);
    simulation.command(robot, Command::Twist(Twist::new(v, 0.0))).expect("the robot drives");
    let end = simulation.now() + Time::from_millis(10_000);
    while simulation.now() < end && simulation.range(robot, 0).is_none_or(|distance| distance > 0.4) {
        simulation.advance_to(simulation.now() + Time::from_millis(50));
    }
    let x = simulation.pose(robot).position.x;
    (simulation.now(), x)
}

fn main() {
    let files: MemoryFiles = [("room.scene.toml", SCENE)].into_iter().collect();
    let loaded = load_scene("room.scene.toml", &files);
    assert!(!loaded.has_errors(), "{:?}", loaded.diagnostics);

    let mut simulation = Simulation::new(&loaded.scene, &Options::default()).expect("a robot that can be simulated");
    simulation.advance_to(Time::from_millis(1_000));
    let snapshot = simulation.clone();
    for v in [0.1, 0.2, 0.4] {
        let mut branch = snapshot.clone();
        let (at, x) = drive(&mut branch, v);
        println!("{v} m/s: {at} x = {x:.3} m, digest {}", branch.digest());
    }
    assert_eq!(simulation.digest(), snapshot.digest(), "no branch has changed what it came from");
}
