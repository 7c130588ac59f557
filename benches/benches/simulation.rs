//! Benches of the simulation without programs: `step` and `noisy-step` advance one robot by a slot and read its eight
//! range sensors, `restore` copies a snapshot back, `restart` starts a new simulation.

use criterion::{Criterion, criterion_group, criterion_main};
use sim_core::RobotId;
use sim_core::drive::Command;
use sim_core::pose::Twist;
use sim_core::simulation::{Options, Simulation};
use sim_core::spec::{NoiseRef, SceneSpec};
use sim_core::time::Time;
use sim_format::{MemoryFiles, load_scene, preset};

/// A closed room of 20 m with a robot that has range sensors in eight directions, and the noise profile `noise`.
fn scene(noise: &str) -> SceneSpec {
    let corners = ["[0, 0]", "[20000, 0]", "[20000, 20000]", "[0, 20000]"];
    let wall = |index: usize| format!("{{ from_mm = {}, to_mm = {} }}", corners[index], corners[(index + 1) % 4]);
    let walls: Vec<String> = (0..4).map(wall).collect();
    let sensor = |index: i32| format!("{{ name = \"PSD{index}\", angle_deg = {}, range_mm = 9999 }}", 45 * index);
    let sensors: Vec<String> = (0..8).map(sensor).collect();
    let scene = format!(
        "[world]\nfloor_mm = [20000, 20000]\nwall = [{}]\n\
         [[robot_type]]\nname = \"Eight\"\ndiameter_mm = 200\npsd = [{}]\n\
         drive = {{ kind = \"differential\" }}\n\
         [[robot]]\ntype = \"Eight\"\nx_mm = 10000\ny_mm = 10000\n",
        walls.join(", "),
        sensors.join(", ")
    );
    let files: MemoryFiles = [("eight.scene.toml", scene)].into_iter().collect();
    let mut loaded = load_scene("eight.scene.toml", &files);
    assert!(!loaded.has_errors(), "{:#?}", loaded.diagnostics);
    loaded.scene.robots[0].noise = preset(noise).map(NoiseRef::Preset);
    loaded.scene
}

fn simulation(noise: &str) -> Simulation {
    let mut simulation = Simulation::new(&scene(noise), &Options::default()).expect("a robot that can be simulated");
    // The robot drives in a circle forever.
    simulation.command(RobotId(1), Command::Twist(Twist::new(0.3, 0.5))).expect("it drives");
    simulation
}

/// Advances by a slot of 50 ms and reads the eight sensors; returns the sum of the readings, m.
fn step(simulation: &mut Simulation) -> f64 {
    simulation.advance_to(simulation.now() + Time::from_millis(50));
    (0..8).filter_map(|index| simulation.range(RobotId(1), index)).sum()
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    for (name, noise) in [("step", "none"), ("noisy-step", "mild")] {
        let mut stepped = simulation(noise);
        group.bench_function(name, |bencher| bencher.iter(|| step(&mut stepped)));
    }
    let mut restored = simulation("none");
    restored.advance_to(Time::from_millis(5_000));
    let snapshot = restored.clone();
    group.bench_function("restore", |bencher| bencher.iter(|| restored.clone_from(&snapshot)));
    let scene = scene("none");
    group.bench_function("restart", |bencher| {
        bencher.iter(|| restored.restarted(&scene, &Options::default()).expect("robots that can be simulated"))
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
