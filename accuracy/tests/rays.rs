//! The ray index of the core, compared with brute force in random and degenerate scenes.

use accuracy::oracle;
use accuracy::world::{self, Random};
use glam::{DVec2, Vec2Swizzles};
use proptest::prelude::*;
use sim_core::math;
use sim_core::scene::{Bounds, Segment, WallId, Walls};

/// Tolerance of a reading against brute force, in metres.
const TOLERANCE: f64 = 1e-9;

/// Checks one ray: the hit is not farther than with slightly shortened walls, and not nearer than with slightly
/// extended walls. Away from the ends of walls these two distances are equal.
fn check(walls: &Walls, origin: DVec2, direction: DVec2, range: f64) {
    let found = walls.cast(origin, direction, range);
    let distance = found.map_or(f64::INFINITY, |hit| hit.distance);
    let brute_force = |range, extension| {
        oracle::nearest_wall(walls.segments(), origin, direction, range, extension).map_or(f64::INFINITY, |hit| hit.0)
    };
    let (min, max) = (brute_force(range + TOLERANCE, 1e-10), brute_force(range - TOLERANCE, -1e-10));
    assert!(
        min * (1.0 - 1e-14) - TOLERANCE <= distance && distance * (1.0 - 1e-14) <= max + TOLERANCE,
        "from {origin} along {direction}, {range} m: {found:?}, brute force {min} to {max}"
    );
    if let Some(hit) = found {
        let end = origin + direction * hit.distance;
        assert!(
            walls.segment(hit.wall).distance(end) < TOLERANCE + 1e-14 * hit.distance,
            "{hit:?} of {origin} along {direction}"
        );
    }
}

/// Unit vector from `origin` to `target`, within rounding.
fn direction_to(origin: DVec2, target: DVec2) -> Option<DVec2> {
    (target - origin).try_normalize()
}

#[test]
fn random_rays_match_brute_force() {
    for (seed, corner) in (0..).zip([DVec2::ZERO, DVec2::new(-10.0, -3.0), DVec2::new(1e4, -1e4)]) {
        let room = Bounds { min: corner, max: corner + DVec2::splat(20.0) };
        for scene in [world::room_with_boxes(seed, corner, 20.0, 74), world::maze(seed, corner, 12, 20.0 / 12.0)] {
            let walls = Walls::new(scene);
            let mut random = Random::new(seed);
            for _ in 0..18_000 {
                let origin = random.point_in(room.grown(1.0));
                let range = if random.chance(0.9) { 2.0 } else { f64::INFINITY };
                check(&walls, origin, random.direction(), range);
            }
        }
    }
}

#[test]
fn no_ray_passes_through_a_corner() {
    // 0.18 m is the cell size of a micro-mouse maze. Rays begin in the centre of a cell, on a border or corner of
    // cells, or anywhere.
    for (seed, corner) in (10..).zip([DVec2::ZERO, DVec2::new(0.1, -0.7), DVec2::new(-1e4, 1e4)]) {
        for cell in [0.18, 1.0] {
            let size = 12;
            let walls = Walls::new(world::maze(seed, corner, size, cell));
            let mut random = Random::new(seed);
            for _ in 0..4_000 {
                let half_steps = DVec2::new(random.below(2 * size + 1) as f64, random.below(2 * size + 1) as f64);
                let origin = if random.chance(0.7) {
                    corner + half_steps * (0.5 * cell)
                } else {
                    random.point_in(walls.bounds().unwrap())
                };
                let wall = &walls.segments()[random.below(walls.len())];
                let Some(direction) = direction_to(origin, wall.a) else { continue };
                let distance = (wall.a - origin).length();
                let hit = walls.cast(origin, direction, f64::INFINITY);
                assert!(
                    hit.is_some_and(|hit| hit.distance <= distance + TOLERANCE),
                    "from {origin} at the corner {}, {distance} m away: {hit:?}",
                    wall.a
                );
                check(&walls, origin, direction, f64::INFINITY);
                // Rays slightly beside the corner, where only one of its walls is hit, and rays along the axes.
                check(&walls, origin, direction_to(origin, wall.a + DVec2::splat(1e-7)).unwrap(), f64::INFINITY);
                for axis in [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y] {
                    check(&walls, origin, axis, 2.0);
                }
            }
        }
    }
}

#[test]
fn rays_at_corners_do_not_leave_a_closed_polygon() {
    for (centre, radius) in [(DVec2::ZERO, 1.0), (DVec2::new(1e4, 1e4), 3.0), (DVec2::new(5.0, -2.0), 1e-3)] {
        for corners in [3_u32, 4, 7, 64, 1000] {
            let corner = |number: u32| {
                let (sin, cos) = math::sin_cos(f64::from(number % corners) * 1.234_567 % std::f64::consts::TAU);
                centre + DVec2::new(cos, sin) * radius
            };
            // A polygon in which each corner belongs to two walls. With 7 or more corners its walls cross (a star).
            let walls = Walls::new((0..corners).map(|n| Segment::new(corner(n), corner(n + 1))).collect());
            let mut random = Random::new(u64::from(corners));
            for _ in 0..500 {
                let target = corner(random.below(corners as usize) as u32);
                let origin = centre + random.direction() * random.between(0.0, 1e-3 * radius);
                let Some(direction) = direction_to(origin, target) else { continue };
                let distance = (target - origin).length();
                let hit = walls.cast(origin, direction, 2.0 * radius);
                assert!(
                    hit.is_some_and(|hit| hit.distance <= distance + TOLERANCE),
                    "{corners} corners: from {origin} at {target}, {distance} m: {hit:?}"
                );
            }
        }
    }
}

#[test]
fn rays_along_walls_end_at_the_nearer_end() {
    let mut random = Random::new(5);
    for corner in [DVec2::ZERO, DVec2::new(3.0, 70.0), DVec2::new(-1e4, 1e4)] {
        for _ in 0..5_000 {
            let (start, direction) = (corner + random.direction() * random.between(0.0, 9.0), random.direction());
            let [gap_before, length, gap_after] = [(); 3].map(|()| random.between(0.1, 5.0));
            let (near, far) = (start + direction * gap_before, start + direction * (gap_before + length));
            let ends = if random.chance(0.5) { (near, far) } else { (far, near) };
            let walls = Walls::new(vec![Segment::new(ends.0, ends.1)]);
            let distance = |origin: DVec2, direction| walls.cast(origin, direction, 20.0).map(|hit| hit.distance);
            let forward = distance(start, direction).expect("the wall is ahead");
            assert!((forward - gap_before).abs() < TOLERANCE, "{forward} m, expected {gap_before}");
            let end = far + direction * gap_after;
            let backward = distance(end, -direction).expect("the wall is ahead");
            assert!((backward - gap_after).abs() < TOLERANCE, "{backward} m, expected {gap_after}");
            assert_eq!(distance(start, -direction), None);
            let on_wall = start + direction * (gap_before + 0.5 * length);
            assert_eq!((distance(on_wall, direction), distance(on_wall, -direction)), (Some(0.0), Some(0.0)));
        }
    }
}

#[test]
fn rays_that_begin_on_a_wall_have_distance_0() {
    let mut random = Random::new(6);
    for corner in [DVec2::ZERO, DVec2::new(1e4, -1e4)] {
        let walls = Walls::new(world::room_with_boxes(3, corner, 20.0, 74));
        for _ in 0..5_000 {
            let wall = walls.segments()[random.below(walls.len())];
            let origin = match random.below(4) {
                0 => wall.a,
                1 => wall.b,
                _ => wall.a + (wall.b - wall.a) * random.between(0.0, 1.0),
            };
            let direction = if random.chance(0.2) { direction_to(wall.a, wall.b).unwrap() } else { random.direction() };
            assert_eq!(walls.cast(origin, direction, 2.0).map(|hit| hit.distance), Some(0.0), "on {wall:?}");
        }
    }
}

#[test]
fn walls_on_cell_borders_are_hit() {
    // Parallel walls with many spacings, so that some walls and some rays coincide with borders of the index's cells.
    for lines in 2..40_u32 {
        let pitch = 1.0 / f64::from(lines);
        let horizontal = (0..=lines).map(|line| {
            let y = f64::from(line) * pitch;
            Segment::new(DVec2::new(0.0, y), DVec2::new(1.0, y))
        });
        let upright: Vec<_> = horizontal.clone().map(|wall| Segment::new(wall.a.yx(), wall.b.yx())).collect();
        let walls = Walls::new(horizontal.chain(upright).collect());
        for line in 0..=lines {
            let coordinate = f64::from(line) * pitch;
            for (origin, direction) in [
                (DVec2::new(-1.0, coordinate), DVec2::X),
                (DVec2::new(2.0, coordinate), DVec2::NEG_X),
                (DVec2::new(coordinate, -1.0), DVec2::Y),
                (DVec2::new(coordinate, 2.0), DVec2::NEG_Y),
            ] {
                let hit = walls.cast(origin, direction, 3.0).map(|hit| hit.distance);
                assert_eq!(hit, Some(1.0), "{lines} lines, from {origin} along {direction}");
            }
            let diagonal = direction_to(DVec2::new(coordinate - 1.0, -1.0), DVec2::new(coordinate, 0.0)).unwrap();
            let hit = walls.cast(DVec2::new(coordinate - 1.0, -1.0), diagonal, 3.0).map(|hit| hit.distance);
            assert!(hit.is_some_and(|metres| (metres - 2.0_f64.sqrt()).abs() < TOLERANCE), "{lines} lines: {hit:?}");
        }
    }
}

#[test]
fn degenerate_scenes_match_brute_force() {
    let point = Segment::new(DVec2::new(3.0, 4.0), DVec2::new(3.0, 4.0));
    let direction = DVec2::new(0.6, 0.8);
    for scene in [vec![point], vec![point; 1000]] {
        let walls = Walls::new(scene);
        let hit = walls.cast(DVec2::ZERO, direction, 9.0).unwrap();
        assert!((hit.distance - 5.0).abs() < TOLERANCE && hit.wall == WallId(0), "{hit:?}");
        assert_eq!(walls.cast(DVec2::ZERO, DVec2::X, 9.0), None);
    }
    // Three scenes with 300 walls of a millimetre: walls around the origin and two far away; walls with centres on one
    // line; the walls on this line and a wall 2 * 10^50 m long.
    let mut random = Random::new(9);
    let tiny = |random: &mut Random, centre: DVec2| {
        let half = random.direction() * 5e-4;
        Segment::new(centre - half, centre + half)
    };
    let mut far: Vec<_> = (0..300).map(|_| random.direction()).collect();
    far.extend([DVec2::splat(-1e7), DVec2::splat(1e7)]);
    let far: Vec<_> = far.into_iter().map(|centre| tiny(&mut random, centre)).collect();
    let line: Vec<_> = (0..300).map(|index| tiny(&mut random, DVec2::new(f64::from(index) * 30.0, 0.0))).collect();
    let mut huge = line.clone();
    huge.push(Segment::new(DVec2::new(-1e50, 1e49), DVec2::new(1e50, 1e49)));
    for scene in [far, line, huge] {
        let walls = Walls::new(scene);
        for _ in 0..300 {
            let wall = walls.segments()[random.below(300)];
            let origin = wall.a + random.direction();
            check(&walls, origin, direction_to(origin, wall.nearest_point(origin)).unwrap(), 2.0);
            check(&walls, origin, random.direction(), f64::INFINITY);
        }
    }
}

#[test]
fn rays_from_far_away_hit_a_wall() {
    let walls = Walls::new(vec![Segment::new(DVec2::new(0.0, -1.0), DVec2::new(0.0, 1.0))]);
    for far in [1e3, 1e6, 1e9, 1e12, 1e15] {
        let hit = walls.cast(DVec2::new(-far, 0.25), DVec2::X, f64::INFINITY);
        assert_eq!(hit.map(|hit| hit.distance), Some(far));
        assert_eq!(walls.cast(DVec2::new(-far, 0.25), DVec2::NEG_X, f64::INFINITY), None);
    }
    assert_eq!(walls.cast(DVec2::splat(f64::MAX), DVec2::X, f64::INFINITY), None);
}

/// Coordinates on a coarse grid, random coordinates, and arbitrary numbers.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-8..=8_i32).prop_map(|steps| f64::from(steps) * 0.25),
        4 => -2.0..2.0_f64,
        1 => prop::num::f64::ANY,
    ]
}

fn point() -> impl Strategy<Value = DVec2> {
    (coordinate(), coordinate()).prop_map(DVec2::from)
}

proptest! {
    #[test]
    fn arbitrary_scenes_match_brute_force(
        ends in prop::collection::vec((point(), point()), 0..40),
        rays in prop::collection::vec((point(), -4..=4_i32, -4..=4_i32, 0.0..8.0_f64), 20),
    ) {
        let segments: Vec<_> = ends.iter().map(|&(a, b)| Segment::new(a, b)).collect();
        let is_near_origin = |point: DVec2| point.abs().max_element() <= 2.0;
        let is_comparable = segments.iter().all(|segment| is_near_origin(segment.a) && is_near_origin(segment.b));
        let walls = Walls::new(segments);
        for (origin, dx, dy, range) in rays {
            let Some(direction) = DVec2::new(f64::from(dx), f64::from(dy)).try_normalize() else { continue };
            if is_comparable && is_near_origin(origin) {
                check(&walls, origin, direction, range);
            } else if let Some(hit) = walls.cast(origin, direction, range) {
                prop_assert!((0.0..=range).contains(&hit.distance), "{:?}", hit);
            }
        }
    }

    #[test]
    fn query_visits_walls_with_an_end_in_the_rectangle(
        ends in prop::collection::vec((point(), point()), 0..40),
        corners in (point(), point()),
    ) {
        let segments: Vec<_> = ends.iter().map(|&(a, b)| Segment::new(a, b)).collect();
        let walls = Walls::new(segments);
        let bounds = Bounds::of_points([corners.0, corners.1]);
        let mut visited = Vec::new();
        walls.for_each_in(bounds, |id, _| visited.push(id));
        prop_assert!(visited.is_sorted_by(|one, other| one < other), "{:?}", visited);
        for (number, segment) in (0..).zip(walls.segments()) {
            let is_usable = [segment.a, segment.b].iter().all(|end| end.abs().cmple(DVec2::splat(1e100)).all());
            let must_be_visited = is_usable && (bounds.contains(segment.a) || bounds.contains(segment.b));
            prop_assert!(!must_be_visited || visited.contains(&WallId(number)), "{:?} in {:?}", segment, bounds);
        }
    }
}
