//! Runs a thousand seeds on all cores: the position error of the odometry of a robot with noise.
//!
//! `cargo run --release -p sim-format --example seeds`

use std::sync::atomic::{AtomicU64, Ordering};

use sim_core::RobotId;
use sim_core::drive::Command;
use sim_core::pose::Twist;
use sim_core::simulation::{Options, Simulation};
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_format::{MemoryFiles, load_scene};

const SCENE: &str = r#"
[world]
floor_mm = [8000, 8000]

[[robot]]
type = "S4"
x_mm = 4000
y_mm = 4000
noise = "real"
"#;

/// Position error of the odometry after 10 s on a circle, m.
fn miss(scene: &SceneSpec, seed: u64) -> f64 {
    let (robot, options) = (RobotId(1), Options { seed: Some(seed), ..Options::default() });
    let mut simulation = Simulation::new(scene, &options).expect("a robot that can be simulated");
    let start = simulation.pose(robot);
    simulation.command(robot, Command::Twist(Twist::new(0.3, 0.5))).expect("the robot drives");
    simulation.advance_to(Time::from_millis(10_000));
    let odometry = start.compose(&simulation.odometry(robot));
    (simulation.pose(robot).position - odometry.position).length()
}

fn main() {
    const SEEDS: u64 = 1_000;
    let files: MemoryFiles = [("a.scene.toml", SCENE)].into_iter().collect();
    let scene = load_scene("a.scene.toml", &files).scene;
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicU64::new(0);
    let work = || {
        let seeds = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed)).take_while(|seed| *seed < SEEDS);
        seeds.map(|seed| miss(&scene, seed)).collect::<Vec<f64>>()
    };
    let mut misses: Vec<f64> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("no run panics")).collect()
    });
    misses.sort_unstable_by(f64::total_cmp);
    let quantile = |part: f64| misses[(part * (misses.len() - 1) as f64) as usize];
    println!(
        "{SEEDS} seeds, miss in m: median {:.4}, 90 % below {:.4}, most {:.4}",
        quantile(0.5),
        quantile(0.9),
        quantile(1.0)
    );
}
