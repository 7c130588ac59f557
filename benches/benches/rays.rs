//! Rays per second against fixed walls: the 2D index compared with brute force.

use accuracy::course::model;
use accuracy::oracle;
use benches::Ray;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use sim_core::RobotId;
use sim_core::drive::Motion;
use sim_core::pose::Pose;
use sim_core::scene::{Segment, Walls};
use sim_core::sensor::{Fan, Mount, Scan};
use sim_core::time::Time;
use sim_core::world::World;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;

fn rays(criterion: &mut Criterion) {
    let beyond: Vec<Ray> = benches::psd_rays(10_000)
        .into_iter()
        .map(|ray| Ray { origin: ray.origin + DVec2::new(30.0, 0.0), ..ray })
        .collect();
    compare(criterion, "psd", &benches::walls(), &benches::psd_rays(10_000));
    compare(criterion, "psd-maze", &benches::maze(), &benches::psd_rays(10_000));
    compare(criterion, "lidar", &benches::walls(), &benches::lidar_rays(28));
    compare(criterion, "out-of-reach", &benches::walls(), &beyond);
}

fn compare(criterion: &mut Criterion, name: &str, segments: &[Segment], rays: &[Ray]) {
    let walls = Walls::new(segments.to_vec());
    let mut group = criterion.benchmark_group(format!("rays/{name}"));
    group.throughput(Throughput::Elements(rays.len() as u64));
    group.bench_function("index", |bencher| {
        bencher.iter(|| {
            for ray in rays {
                black_box(walls.cast(ray.origin, ray.direction, ray.range));
            }
        });
    });
    group.sample_size(10);
    group.bench_function("brute-force", |bencher| {
        bencher.iter(|| {
            for ray in rays {
                black_box(oracle::nearest_wall(segments, ray.origin, ray.direction, ray.range, 0.0));
            }
        });
    });
    group.finish();
}

fn build(criterion: &mut Criterion) {
    let segments = benches::walls();
    let mut group = criterion.benchmark_group("rays/build");
    group.throughput(Throughput::Elements(segments.len() as u64));
    group.bench_function("index", |bencher| bencher.iter(|| Walls::new(black_box(segments.clone()))));
    group.finish();
}

/// A world with the walls and `robots` robots among them.
fn world(robots: u32) -> World {
    let walls = Arc::new(Walls::new(benches::walls()));
    let rays = benches::psd_rays(robots as usize);
    let motion = |index: usize| {
        let start = Pose { position: rays[index].origin, ..Pose::default() };
        Motion::new(RobotId::from_index(index), Arc::new(model()), Arc::clone(&walls), start)
    };
    let mut motions: Vec<Motion> = (0..rays.len()).map(motion).collect();
    World::new(Arc::clone(&walls), Time::from_millis(50), &mut motions)
}

/// Complete scans as by `LIDARGet`, with walls only, and with other robots.
fn scans(criterion: &mut Criterion) {
    let (walls, crowd) = (world(0), world(100));
    let rays = benches::lidar_rays(28);
    let poses: Vec<Pose> =
        rays.iter().step_by(360).map(|ray| Pose { position: ray.origin, ..Pose::default() }).collect();
    let scan = |tilt| Scan::new(Mount::default(), Fan { sweep: TAU, points: 360, tilt, height: 0.1, range: 30.0 });
    let mut group = criterion.benchmark_group("rays/scan");
    group.throughput(Throughput::Elements(rays.len() as u64));
    let (level, tilted) = (scan(0.0), scan(0.1));
    let cases = [("level", &walls, &level), ("tilted", &walls, &tilted)];
    let among_robots = [("crowd-level", &crowd, &level), ("crowd-tilted", &crowd, &tilted)];
    for (name, world, scan) in cases.into_iter().chain(among_robots) {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for pose in &poses {
                    black_box(scan.distances(world, RobotId(1), pose, Time::ZERO));
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, rays, scans, build);
criterion_main!(benches);
