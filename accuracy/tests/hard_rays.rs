//! Hard cases of rays among walls: no ray passes through a wall, no wall is missed, and readings do not depend on the
//! world's origin.

use std::f64::consts::TAU;

use accuracy::world::{self, Random};
use glam::DVec2;
use sim_core::math;
use sim_core::scene::{Bounds, Segment, WallId, Walls};

/// Corners of a polygon around `centre` in counter-clockwise order; each is visible from `centre` and 0.5 to 2 m away.
fn corners(random: &mut Random, centre: DVec2, count: usize) -> Vec<DVec2> {
    let spacing = TAU / count as f64;
    (0..count)
        .map(|number| {
            let (sin, cos) = math::sin_cos(spacing * (number as f64 + random.between(-0.2, 0.2)));
            centre + DVec2::new(cos, sin) * random.between(0.5, 2.0)
        })
        .collect()
}

/// Closed polygon with these corners.
fn closed_polygon(corners: &[DVec2]) -> Vec<Segment> {
    (0..corners.len()).map(|index| Segment::new(corners[index], corners[(index + 1) % corners.len()])).collect()
}

/// Number that is `ulps` units in the last place above `value`, or below it if `ulps` is negative.
fn nudged(value: f64, ulps: i64) -> f64 {
    (0..ulps.abs()).fold(value, |value, _| if ulps > 0 { value.next_up() } else { value.next_down() })
}

/// Point after a rotation by `turn` and a translation by `offset`.
fn transformed(point: DVec2, turn: f64, offset: DVec2) -> DVec2 {
    let (sin, cos) = math::sin_cos(turn);
    DVec2::new(cos, sin).rotate(point) + offset
}

#[test]
fn no_ray_leaves_a_closed_polygon() {
    let mut random = Random::new(41);
    let mut rays = 0;
    // The units in the last place of these coordinates are 2e-16 m, 2e-12 m and 1e-10 m.
    for centre in [DVec2::ZERO, DVec2::new(1e4, -1e4), DVec2::new(-1e6, 1e6)] {
        for count in [3, 4, 5, 17, 60, 300, 1500] {
            let corners = corners(&mut random, centre, count);
            let walls = Walls::new(closed_polygon(&corners));
            for round in 0..50_000 {
                let origin =
                    if round % 2 == 0 { centre } else { centre + random.direction() * random.between(0.0, 0.05) };
                let (target, kind) = match round % 5 {
                    0 => (origin + random.direction(), "any direction"),
                    1 | 2 => (corners[random.below(count)], "a corner"),
                    3 => {
                        let corner = corners[random.below(count)];
                        let mut ulps = || random.below(7) as i64 - 3;
                        (DVec2::new(nudged(corner.x, ulps()), nudged(corner.y, ulps())), "next to a corner")
                    }
                    _ => {
                        let wall = walls.segments()[random.below(count)];
                        (wall.a + (wall.b - wall.a) * random.between(0.0, 1.0), "a wall")
                    }
                };
                let Some(direction) = (target - origin).try_normalize() else { continue };
                let hit = walls.cast(origin, direction, f64::INFINITY).unwrap_or_else(|| {
                    panic!("{count} corners: from {origin} along {direction} at {kind}, the ray leaves the polygon")
                });
                assert!(hit.distance <= 2.1, "{count} corners, at {kind}: {hit:?}");
                // Tolerance of a touch (see `Walls`): 8 * 2^-52 times the sum of the origin's coordinates, at most
                // 2 * 10^6 m.
                let error = walls.segment(hit.wall).distance(origin + direction * hit.distance);
                assert!(error < 4e-9, "{count} corners, at {kind}: {error} m off the wall");
                rays += 1;
            }
        }
    }
    assert!(rays > 1_000_000, "{rays} rays");
}

#[test]
fn ray_passes_through_a_slit_of_a_nanometre() {
    let mut random = Random::new(42);
    for _ in 0..2_000 {
        let (turn, offset) =
            (random.between(-4.0, 4.0), DVec2::new(random.between(-9.0, 9.0), random.between(-9.0, 9.0)));
        let point = |x: f64, y: f64| transformed(DVec2::new(x, y), turn, offset);
        let half_width = 0.5e-9;
        let walls = Walls::new(vec![
            Segment::new(point(1.0, half_width), point(9.0, half_width)),
            Segment::new(point(9.0, -half_width), point(1.0, -half_width)),
            Segment::new(point(10.0, -1.0), point(10.0, 1.0)),
        ]);
        let direction = transformed(DVec2::X, turn, DVec2::ZERO);
        let through = walls.cast(point(0.0, 0.0), direction, 20.0).expect("the last wall closes the slit");
        assert_eq!(through.wall, WallId(2), "turned by {turn}");
        assert!((through.distance - 10.0).abs() < 1e-9, "within 1 nm: {through:?}");
        let inside = walls.cast(point(5.0, 0.0), direction, 20.0).expect("the last wall closes the slit");
        assert!((inside.distance - 5.0).abs() < 1e-9, "within 1 nm: {inside:?}");
        // Rays across the slit hit its two walls, which are a nanometre apart.
        let left = transformed(DVec2::Y, turn, DVec2::ZERO);
        let across = walls.cast(point(5.0, -1.0), left, 20.0).expect("a wall");
        assert_eq!(across.wall, WallId(1));
        assert!((across.distance - (1.0 - half_width)).abs() < 1e-12, "within 1 pm: {across:?}");
        let from_inside = walls.cast(point(5.0, 0.0), left, 20.0).expect("a wall");
        assert!((from_inside.distance - half_width).abs() < 1e-13, "within 0.1 pm: {from_inside:?}");
    }
}

#[test]
fn grazing_rays_hit_a_wall_at_the_right_distance() {
    // The ray starts at y = 0, falls by `angle` per metre and hits the wall along y = -height at x = height / angle.
    // `angle` and `height` are powers of two, so they are exact. The direction's length differs from 1 by less
    // than 2^-41.
    for exponent in 20..45 {
        let angle = 1.0 / (1_u64 << exponent) as f64;
        for metres in [1.0, 4.0, 16.0] {
            let height = metres * angle;
            let walls = Walls::new(vec![Segment::new(DVec2::new(-1.0, -height), DVec2::new(20.0, -height))]);
            let hit = walls.cast(DVec2::ZERO, DVec2::new(1.0, -angle), 30.0).expect("the wall lies across the ray");
            // Rounding displaces the wall sideways by a few times 2^-52 m, and therefore the hit along the ray by this
            // distance divided by `angle`. If the wall is within the tolerance of a touch, the ray starts on the wall.
            let tolerance = 32.0 * f64::EPSILON / angle + 1e-9;
            let starts_on = height <= 64.0 * 21.0 * f64::EPSILON && hit.distance == 0.0;
            assert!(
                (hit.distance - metres).abs() <= tolerance || starts_on,
                "angle {angle}: {hit:?} instead of {metres}"
            );
        }
    }
}

#[test]
fn first_of_coincident_walls_is_hit_and_points_are_ignored() {
    let mut random = Random::new(43);
    let room = Bounds { min: DVec2::ZERO, max: DVec2::splat(20.0) };
    let single = world::room_with_boxes(7, DVec2::ZERO, 20.0, 40);
    let points = single.iter().map(|wall| Segment::new(wall.a, wall.a));
    let multiple = [&single[..], &single[..], &single[..]].concat().into_iter().chain(points).collect();
    let (single, multiple) = (Walls::new(single), Walls::new(multiple));
    for round in 0..40_000 {
        let origin = random.point_in(room);
        let direction = if round % 2 == 0 {
            random.direction()
        } else {
            (single.segments()[random.below(single.len())].b - origin).normalize_or(DVec2::X)
        };
        let (one, other) = (single.cast(origin, direction, 30.0), multiple.cast(origin, direction, 30.0));
        let (one, other) = (one.expect("a closed room"), other.expect("a closed room"));
        assert!((one.distance - other.distance).abs() < 1e-12, "within 1 pm: {one:?}, {other:?}");
        // At a corner, rounding decides which of the corner's walls is nearer.
        assert!(round % 2 == 1 || one == other, "not the first of three: {one:?}, {other:?}");
    }
}

#[test]
fn readings_do_not_depend_on_the_origin() {
    // Coordinates are multiples of 2^-20 m, so that the world can be moved along each axis by 2^13 m, 2^20 m and 2^30 m
    // (8 km, 1,000 km and 10^6 km) without rounding.
    let resolution = (1 << 20) as f64;
    let rounded = |point: DVec2| (point * resolution).round() / resolution;
    let scene: Vec<Segment> = world::room_with_boxes(5, DVec2::ZERO, 20.0, 74)
        .iter()
        .map(|wall| Segment::new(rounded(wall.a), rounded(wall.b)))
        .collect();
    let near = Walls::new(scene.clone());
    // A ray that misses a corner by a few units in the last place of the offset may hit this corner in the moved world.
    for (offset, ulp) in [(8192.0, 1e-12), (1_048_576.0, 2.4e-10), (1_073_741_824.0, 2.4e-7)] {
        let offset = DVec2::new(offset, -offset);
        let far = Walls::new(scene.iter().map(|wall| Segment::new(wall.a + offset, wall.b + offset)).collect());
        let mut random = Random::new(44);
        for _ in 0..20_000 {
            let origin = rounded(random.point_in(Bounds { min: DVec2::ZERO, max: DVec2::splat(20.0) }));
            let direction = random.direction();
            let (one, other) = (near.cast(origin, direction, 40.0), far.cast(origin + offset, direction, 40.0));
            if one == other {
                continue;
            }
            let hit = other.expect("a closed room");
            let wall = near.segment(hit.wall);
            let error = wall.distance(origin + direction * hit.distance);
            assert!(error <= 32.0 * ulp, "{one:?}, {other:?}: {error} m off the wall");
            let distances = [wall.a, wall.b, origin].into_iter().map(|end| direction.perp_dot(end - origin).abs());
            assert!(distances.fold(f64::INFINITY, f64::min) <= 32.0 * ulp, "not a corner: {one:?}, {other:?}");
        }
    }
}

#[test]
fn range_limit_is_exact() {
    let mut random = Random::new(45);
    let walls = Walls::new(world::maze(3, DVec2::new(-2.0, 0.3), 12, 0.36));
    let bounds = walls.bounds().expect("walls");
    for _ in 0..20_000 {
        let (origin, direction) = (random.point_in(bounds), random.direction());
        let hit = walls.cast(origin, direction, f64::INFINITY).expect("a closed maze");
        for range in [hit.distance, hit.distance.next_up(), 1e3, 1e30, f64::MAX] {
            assert_eq!(walls.cast(origin, direction, range), Some(hit), "range {range}");
        }
        for range in [0.0, f64::from_bits(1), f64::MIN_POSITIVE, 1e-12, hit.distance.next_down()] {
            assert_eq!(walls.cast(origin, direction, range), None, "range {range} of {hit:?}");
        }
    }
    // For an origin on a wall, no range is too short.
    let origin = walls.segments()[0].a;
    for range in [0.0, f64::from_bits(1), 1e-12] {
        assert_eq!(walls.cast(origin, DVec2::X, range).map(|hit| hit.distance), Some(0.0), "range {range}");
    }
}

/// Extreme and unusual numbers, as they occur in faulty programs and files.
const EXTREME_NUMBERS: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    1e101,
    -1e100,
    1e-310,
    -0.0,
    0.0,
    f64::MIN_POSITIVE,
    1.0,
    -1.0,
    0.6,
];

#[test]
fn extreme_numbers_give_no_false_hits() {
    let walls = Walls::new(world::room_with_boxes(2, DVec2::splat(-1.0), 2.0, 20));
    let mut hit_count = 0;
    for x in EXTREME_NUMBERS {
        for y in EXTREME_NUMBERS {
            for dx in EXTREME_NUMBERS {
                for dy in EXTREME_NUMBERS {
                    for range in EXTREME_NUMBERS {
                        let found = walls.cast(DVec2::new(x, y), DVec2::new(dx, dy), range);
                        let is_unit_vector = (math::hypot(dx, dy) - 1.0).abs() < 1e-5;
                        let is_ray = x.is_finite() && y.is_finite() && is_unit_vector && range >= 0.0;
                        assert!(is_ray || found.is_none(), "({x}, {y}) along ({dx}, {dy}), {range}: {found:?}");
                        if let Some(hit) = found {
                            assert!((0.0..=range).contains(&hit.distance), "{hit:?} within {range}");
                            hit_count += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(hit_count > 100, "{hit_count} of the rays hit a wall");
}

#[test]
fn extreme_walls_do_not_hide_other_walls() {
    let ordinary_wall = Segment::new(DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0));
    for a in EXTREME_NUMBERS {
        for b in EXTREME_NUMBERS {
            let extreme_walls = [
                Segment::new(DVec2::new(a, 3.0), DVec2::new(b, 3.0)),
                Segment::new(DVec2::new(-5.0, a), DVec2::new(-5.0, b)),
                Segment::new(DVec2::new(a, 7.0), DVec2::new(7.0, b)),
            ];
            for (index, extreme) in extreme_walls.into_iter().enumerate() {
                let walls = Walls::new(vec![extreme, ordinary_wall]);
                let hit = walls.cast(DVec2::new(0.0, 0.5), DVec2::X, 2.0);
                // The extreme wall itself may cross the ray before the ordinary wall. For a wall longer than 10^15 m,
                // the tolerance of a touch is about 2 m or more.
                let may_block = index == 2 || extreme.length() > 1e15;
                let is_extreme_wall = may_block && hit.is_some_and(|hit| hit.wall == WallId(0) && hit.distance <= 1.0);
                let is_ordinary_wall =
                    hit.is_some_and(|hit| hit.wall == WallId(1) && (hit.distance - 1.0).abs() < 1e-9);
                assert!(is_ordinary_wall || is_extreme_wall, "{extreme:?}: {hit:?}");
            }
        }
    }
}
