//! The index of moving bodies, compared with brute force over all bodies.

use accuracy::world::Random;
use glam::DVec2;
use proptest::prelude::*;
use sim_core::RobotId;
use sim_core::scene::{Bounds, BoundsIndex};

/// Returns true if a ray hits a rectangle enlarged by `margin`, by the separating axis theorem.
fn meets(bounds: &Bounds, origin: DVec2, direction: DVec2, range: f64, margin: f64) -> bool {
    let half = 0.5 * (bounds.max - bounds.min) + DVec2::splat(margin);
    let from_centre = origin - 0.5 * (bounds.min + bounds.max);
    let end = from_centre + direction * range;
    let is_separated =
        |low: f64, high: f64, half_extent: f64| low.min(high) > half_extent || low.max(high) < -half_extent;
    let distance = direction.perp_dot(from_centre).abs();
    let max_distance = half.x * direction.y.abs() + half.y * direction.x.abs();
    !(is_separated(from_centre.x, end.x, half.x)
        || is_separated(from_centre.y, end.y, half.y)
        || distance > max_distance)
}

fn check(list: &[(RobotId, Bounds)], rays: &[(DVec2, DVec2, f64)], queries: &[Bounds]) {
    let mut moving = BoundsIndex::default();
    moving.rebuild(list);
    let mut sorted = list.to_vec();
    sorted.sort_by_key(|body| body.0);

    for &(origin, direction, range) in rays {
        let mut found = Vec::new();
        moving.along_ray(origin, direction, range, |id| {
            found.push(id);
            f64::INFINITY
        });
        found.sort();
        for (id, bounds) in &sorted {
            let count = found.iter().filter(|&other| other == id).count();
            // A body that the ray misses by less than the body's size may also be visited.
            let size = (bounds.max - bounds.min).length();
            let (must, may) = [-1e-9, 1e-9 + size].map(|margin| meets(bounds, origin, direction, range, margin)).into();
            assert!(
                count <= usize::from(may) && count >= usize::from(must),
                "{id} {count} times on the ray from {origin} along {direction}, {range} m: {bounds:?}"
            );
        }
    }
    for query in queries {
        let mut found = Vec::new();
        moving.for_each_in(*query, |id| found.push(id));
        let expected: Vec<_> = sorted.iter().filter(|body| body.1.overlaps(query)).map(|body| body.0).collect();
        assert_eq!(found, expected, "{query:?}");
    }
    let mut found = Vec::new();
    for (one, bounds) in &sorted {
        moving.visit_in(bounds, |other| found.extend((other > *one).then_some((*one, other))));
    }
    found.sort();
    let mut expected = Vec::new();
    for (index, (one, bounds)) in sorted.iter().enumerate() {
        let later = sorted[index + 1..].iter().filter(|other| other.1.overlaps(bounds));
        expected.extend(later.map(|(other, _)| (*one, *other)));
    }
    assert_eq!(found, expected);
}

#[test]
fn random_bodies_match_brute_force() {
    for (seed, corner) in (0..).zip([DVec2::ZERO, DVec2::new(-5.0, -5.0), DVec2::new(1e4, -1e4)]) {
        let mut random = Random::new(seed);
        let arena = Bounds { min: corner, max: corner + DVec2::splat(10.0) };
        // First only bodies with a radius of 0.1 m; then one body in twenty has a radius of 1 m to 10 m.
        for large_fraction in [0.0, 0.05] {
            let list: Vec<_> = (0..200)
                .map(|index| {
                    let radius = if random.chance(large_fraction) { random.between(1.0, 10.0) } else { 0.1 };
                    (RobotId::from_index(index), Bounds::of_disc(random.point_in(arena), radius))
                })
                .collect();
            let rays: Vec<_> = (0..1000)
                .map(|_| (random.point_in(arena.grown(1.0)), random.direction(), random.between(0.0, 4.0)))
                .collect();
            let queries: Vec<_> =
                (0..200).map(|_| Bounds::of_disc(random.point_in(arena), random.between(0.0, 1.0))).collect();
            check(&list, &rays, &queries);
        }
    }
}

fn point() -> impl Strategy<Value = DVec2> {
    let coordinate = || prop_oneof![(-8..=8_i32).prop_map(|steps| f64::from(steps) * 0.25), -2.0..2.0_f64];
    (coordinate(), coordinate()).prop_map(DVec2::from)
}

fn bounds() -> impl Strategy<Value = Bounds> {
    (point(), point(), 0.0..1.0_f64)
        .prop_map(|(one, other, fraction)| Bounds::of_points([one, one.lerp(other, fraction * fraction * fraction)]))
}

proptest! {
    #[test]
    fn arbitrary_bodies_match_brute_force(
        bodies in prop::collection::vec(bounds(), 0..40),
        rays in prop::collection::vec((point(), -4..=4_i32, -4..=4_i32, 0.0..8.0_f64), 10),
        queries in prop::collection::vec(bounds(), 10),
    ) {
        // The bodies are in descending order of their ids; the index sorts them.
        let list: Vec<_> = (0..bodies.len()).rev().map(RobotId::from_index).zip(bodies).collect();
        let rays: Vec<_> = rays
            .into_iter()
            .filter_map(|(origin, dx, dy, range)| {
                let direction = DVec2::new(f64::from(dx), f64::from(dy)).try_normalize()?;
                Some((origin, direction, range))
            })
            .collect();
        check(&list, &rays, &queries);
    }
}
