//! The index of moving bodies: 1,000 robots, one per square metre, in one slot.

use accuracy::world::Random;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use sim_core::RobotId;
use sim_core::scene::{Bounds, BoundsIndex};
use std::hint::black_box;

/// Discs with a radius of 0.1 m that move by up to 2.5 cm in the slot.
fn bodies(count: usize) -> (Bounds, Vec<(RobotId, Bounds)>) {
    let mut random = Random::new(4);
    let arena = Bounds { min: DVec2::ZERO, max: DVec2::splat((count as f64).sqrt()) };
    let body = |index| {
        let start = random.point_in(arena);
        let end = start + random.direction() * random.between(0.0, 0.025);
        (RobotId::from_index(index), Bounds::of_disc(start, 0.1).union(Bounds::of_disc(end, 0.1)))
    };
    (arena, (0..count).map(body).collect())
}

fn moving(criterion: &mut Criterion) {
    let (arena, list) = bodies(1000);
    let mut random = Random::new(5);
    let rays: Vec<_> = (0..8000).map(|_| (random.point_in(arena), random.direction())).collect();
    let mut index = BoundsIndex::default();
    index.rebuild(&list);
    let mut group = criterion.benchmark_group("moving");
    group.throughput(Throughput::Elements(list.len() as u64));
    group.bench_function("rebuild", |bencher| bencher.iter(|| index.rebuild(black_box(&list))));
    group.bench_function("pairs", |bencher| {
        bencher.iter(|| {
            for (one, bounds) in &list {
                index.visit_in(bounds, |other| {
                    black_box((one, other));
                });
            }
        });
    });
    group.throughput(Throughput::Elements(rays.len() as u64));
    group.bench_function("rays", |bencher| {
        bencher.iter(|| {
            for &(origin, direction) in &rays {
                index.along_ray(origin, direction, 2.0, |id| {
                    black_box(id);
                    2.0
                });
            }
        });
    });
    group.finish();
}

criterion_group!(benches, moving);
criterion_main!(benches);
