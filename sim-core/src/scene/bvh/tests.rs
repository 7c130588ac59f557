use std::f64::consts::{PI, TAU};

use accuracy::oracle;
use accuracy::world::Random;
use proptest::prelude::*;

use super::*;
use crate::math;

type Triangle = [DVec3; 3];

fn unit_vector(random: &mut Random) -> DVec3 {
    let z = random.between(-1.0, 1.0);
    let (sin, cos) = math::sin_cos(random.between(0.0, TAU));
    let horizontal = (1.0 - z * z).sqrt();
    DVec3::new(horizontal * cos, horizontal * sin, z).normalize_or(DVec3::Z)
}

fn point(random: &mut Random, reach: f64) -> DVec3 {
    DVec3::new(random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach))
}

fn random_triangles(seed: u64, count: usize, reach: f64, size: f64) -> Vec<Triangle> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            let middle = point(&mut random, reach);
            [(); 3].map(|()| middle + point(&mut random, size))
        })
        .collect()
}

/// Hills on a grid of `cells` by `cells` squares of 1 m with a corner at the origin.
fn hills(cells: usize) -> Vec<Triangle> {
    let corner = |column: usize, row: usize| {
        let (x, y) = (column as f64, row as f64);
        DVec3::new(x, y, math::sin(0.7 * x) + math::cos(0.4 * y + 0.3 * x))
    };
    let square = |column: usize, row: usize| {
        let (a, b) = (corner(column, row), corner(column + 1, row));
        let (c, d) = (corner(column, row + 1), corner(column + 1, row + 1));
        [[a, b, d], [a, d, c]]
    };
    (0..cells * cells).flat_map(|cell| square(cell % cells, cell / cells)).collect()
}

/// The surface of a box, twelve triangles, corners counter-clockwise from outside.
fn cuboid(low: DVec3, high: DVec3) -> Vec<Triangle> {
    let corner = |bits: usize| {
        let coordinate = |axis: usize| if bits >> axis & 1 == 0 { low[axis] } else { high[axis] };
        DVec3::new(coordinate(0), coordinate(1), coordinate(2))
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = [[0, 1, 2], [0, 2, 3]];
    faces.iter().flat_map(|face| halves.map(|half| half.map(|index: usize| corner(face[index])))).collect()
}

/// A sphere of radius 1: an octahedron whose faces are each subdivided `times` times into four.
fn sphere(times: u32) -> Vec<Triangle> {
    let mut faces: Vec<Triangle> = (0..8)
        .map(|octant| {
            let sign = |bit: i32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
            [DVec3::X * sign(0), DVec3::Y * sign(1), DVec3::Z * sign(2)]
        })
        .collect();
    for _ in 0..times {
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize_or_zero);
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    faces
}

/// A mesh, indexed once for each available SIMD level.
struct Levels {
    triangles: Vec<Triangle>,
    indices: Vec<MeshIndex>,
}

/// All available SIMD levels, from scalar to the widest.
fn levels(triangles: &[Triangle]) -> Levels {
    let mut levels = vec![Level::fallback(), Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(fearless_simd::Simd::level));
    let indices = levels.into_iter().map(|level| MeshIndex::at_level(triangles, level)).collect();
    Levels { triangles: triangles.to_vec(), indices }
}

/// The nearest triangle by the index's own exact test, without a tree: distance as bits, and number.
fn without_tree(levels: &Levels, origin: DVec3, direction: DVec3, range: f64) -> Option<(u64, u32)> {
    let frame = levels.indices[0].frame.as_ref()?;
    let reciprocal = direction.recip();
    let entry = frame.enter(origin, direction, reciprocal, range)?;
    let mut ray = Ray::new(&entry, direction, reciprocal, range - entry.distance, frame);
    for (number, corners) in (0..).zip(&levels.triangles).filter(|(_, corners)| has_area(corners)) {
        ray.test(corners, number, (0, 0));
    }
    ray.nearest().map(|nearest| ((entry.distance + nearest.distance).min(range).to_bits(), nearest.triangle))
}

/// Result of all levels; checks that it is bit-identical to the exact test of every triangle.
fn cast(levels: &Levels, origin: DVec3, direction: DVec3, range: f64) -> Option<MeshHit> {
    let expected = without_tree(levels, origin, direction, range);
    for index in &levels.indices {
        let found = index.cast(origin, direction, range).map(|hit| (hit.distance.to_bits(), hit.triangle));
        assert_eq!(found, expected, "{:?}: {origin:?} {direction:?} {range}", index.level);
    }
    levels.indices[0].cast(origin, direction, range)
}

/// Like [`cast`]; also compares the distance with the oracle's answer within `tolerance` metres.
fn check(levels: &Levels, origin: DVec3, direction: DVec3, range: f64, tolerance: f64) {
    let hit = cast(levels, origin, direction, range);
    let nearest = |range, wider| oracle::nearest_triangle(&levels.triangles, origin, direction, range, wider);
    let (loose, strict) = (nearest(range + tolerance, 1e-11), nearest(range - tolerance, -1e-11));
    let distance = hit.map_or(f64::INFINITY, |hit| hit.distance);
    let low = loose.map_or(f64::INFINITY, |(metres, _)| metres);
    let high = strict.map_or(f64::INFINITY, |(metres, _)| metres);
    assert!(
        distance >= low - tolerance && distance <= high + tolerance,
        "{distance}, not in [{low}, {high}]: {origin:?} {direction:?} {range}"
    );
}

#[test]
fn a_triangle_is_hit_from_both_sides() {
    let index = MeshIndex::new(&[[DVec3::ZERO, DVec3::X, DVec3::Y]]);
    let target = DVec3::new(0.25, 0.25, 0.0);
    for side in [DVec3::Z, -DVec3::Z] {
        let hit = index.cast(target + 3.0 * side, -side, 3.0);
        assert_eq!(hit, Some(MeshHit { distance: 3.0, triangle: 0, normal: side }));
        assert_eq!(index.cast(target + 3.0 * side, -side, 2.999), None);
        assert_eq!(index.cast(target + 3.0 * side, side, f64::INFINITY), None);
    }
    let slanted = DVec3::new(0.6, 0.0, -0.8);
    let hit = index.cast(DVec3::new(-0.35, 0.25, 0.8), slanted, 2.0).unwrap();
    assert!((hit.distance - 1.0).abs() < 1e-15, "within rounding: {hit:?}");
}

#[test]
fn hits_of_random_triangles_match_brute_force() {
    let mut random = Random::new(11);
    for (seed, count, size) in [(1, 1, 3.0), (2, 9, 3.0), (3, 200, 1.0), (4, 700, 0.2), (5, 60, 9.0)] {
        let levels = levels(&random_triangles(seed, count, 5.0, size));
        for _ in 0..400 {
            check(&levels, point(&mut random, 6.0), unit_vector(&mut random), random.between(0.1, 20.0), 1e-9);
        }
        for _ in 0..50 {
            let direction = DVec3::AXES[random.below(3)] * if random.chance(0.5) { 1.0 } else { -1.0 };
            check(&levels, point(&mut random, 6.0), direction, f64::INFINITY, 1e-9);
        }
    }
}

#[test]
fn hits_of_a_terrain_match_brute_force() {
    let levels = levels(&hills(24));
    let mut random = Random::new(12);
    for _ in 0..600 {
        let origin = DVec3::new(random.between(-5.0, 29.0), random.between(-5.0, 29.0), random.between(-3.0, 6.0));
        check(&levels, origin, unit_vector(&mut random), 60.0, 1e-9);
    }
}

#[test]
fn rays_from_far_away_hit() {
    let levels = levels(&hills(16));
    let mut random = Random::new(13);
    for far in [1e2, 1e4, 1e6, 1e8] {
        for _ in 0..100 {
            let target = DVec3::new(random.between(4.0, 12.0), random.between(4.0, 12.0), 0.0);
            let mut up = unit_vector(&mut random);
            up.z = 1.0;
            let up = up.normalize_or_zero();
            let hit = cast(&levels, target + far * up, -up, f64::INFINITY).expect("the hills have no holes");
            let hit_point = target + (far - hit.distance) * up;
            let truth = oracle::nearest_triangle(&levels.triangles, target + 30.0 * up, -up, 60.0, 1e-12).unwrap().0;
            let expected = target + (30.0 - truth) * up;
            // If a grazing ray meets two slopes, rounding of the origin determines which one it hits.
            let is_grazing = hit.normal.dot(up) < 0.05;
            assert!(
                is_grazing || (hit_point - expected).length() < 1e-14 * far + 1e-9,
                "{far}: {hit_point} instead of {expected}"
            );
        }
    }
}

#[test]
fn hits_scale_with_the_mesh() {
    let terrain = hills(6);
    let mut random = Random::new(14);
    let rays: Vec<_> = (0..100).map(|_| (point(&mut random, 6.0) + 3.0, unit_vector(&mut random))).collect();
    let unscaled = levels(&terrain);
    // Powers of two scale without rounding.
    for scale in [1e-30, 1e-3, 1e6, 1e90_f64].map(|scale| f64::from_bits(scale.to_bits() >> 52 << 52)) {
        let scaled = levels(&terrain.iter().map(|corners| corners.map(|corner| corner * scale)).collect::<Vec<_>>());
        for &(origin, direction) in &rays {
            let expected = cast(&unscaled, origin, direction, 40.0).map(|hit| (hit.distance * scale, hit.triangle));
            let found = cast(&scaled, origin * scale, direction, 40.0 * scale).map(|hit| (hit.distance, hit.triangle));
            assert_eq!(found, expected, "scale {scale:e}");
        }
    }
}

/// Direction of a ray from `origin` towards a random corner or edge of the mesh.
fn direction_to_edge(triangles: &[Triangle], origin: DVec3, random: &mut Random) -> DVec3 {
    let [a, b, c] = triangles[random.below(triangles.len())];
    let target = match random.below(4) {
        0 => a,
        1 => 0.5 * (b + c),
        2 => a + 0.25 * (b - a),
        _ => b + random.between(0.0, 1.0) * (c - b),
    };
    (target - origin).normalize_or_zero()
}

#[test]
fn no_ray_slips_through_a_shared_edge() {
    let mut random = Random::new(15);
    let closed = [sphere(3), cuboid(DVec3::new(-2.0, -3.0, 0.0), DVec3::new(4.0, 5.0, 2.5)), sphere(0)];
    for triangles in closed {
        let levels = levels(&triangles);
        for turn in 0..1500 {
            let origin = if turn % 3 == 0 { DVec3::new(0.125, -0.25, 0.25) } else { point(&mut random, 0.1) + 0.12 };
            let direction = direction_to_edge(&triangles, origin, &mut random);
            let hit = cast(&levels, origin, direction, f64::INFINITY).expect("a closed mesh has no holes");
            let truth = oracle::nearest_triangle(&triangles, origin, direction, 99.0, 1e-12).unwrap().0;
            assert!((hit.distance - truth).abs() < 1e-9, "{hit:?} instead of {truth}");
        }
        let middle = DVec3::new(0.125, -0.25, 0.25);
        for axis in DVec3::AXES {
            for direction in [axis, -axis] {
                assert!(cast(&levels, middle, direction, f64::INFINITY).is_some(), "along {direction}");
            }
        }
    }
}

#[test]
fn vertical_rays_hit_the_corners_of_a_grid() {
    let levels = levels(&hills(12));
    for index in 0..13 * 13 {
        let (x, y) = (f64::from(index % 13), f64::from(index / 13));
        let height = math::sin(0.7 * x) + math::cos(0.4 * y + 0.3 * x);
        for (z, direction) in [(10.0, -DVec3::Z), (-10.0, DVec3::Z)] {
            let hit = cast(&levels, DVec3::new(x, y, z), direction, 50.0).expect("corners belong to triangles");
            assert!((hit.distance - (height - z).abs()).abs() < 1e-14, "{hit:?} at {x}, {y}");
        }
    }
}

#[test]
fn the_first_of_equal_triangles_is_hit() {
    let mut triangles = random_triangles(6, 30, 2.0, 2.0);
    let copy = triangles.clone();
    triangles.extend_from_slice(&copy);
    triangles.extend(copy.iter().map(|&[a, b, c]| [b, c, a]));
    let levels = levels(&triangles);
    let mut random = Random::new(16);
    let hits = (0..500).filter_map(|_| cast(&levels, point(&mut random, 3.0), unit_vector(&mut random), 9.0));
    let numbers: Vec<u32> = hits.map(|hit| hit.triangle % 60).collect();
    assert!(numbers.len() > 100 && numbers.iter().all(|&number| number < 30), "{numbers:?}");
}

#[test]
fn triangles_without_area_keep_their_numbers() {
    let wall = |x: f64| [DVec3::new(x, -1.0, -1.0), DVec3::new(x, 1.0, -1.0), DVec3::new(x, 0.0, 2.0)];
    let with_corner = |corner: DVec3| [corner, wall(1.0)[1], wall(1.0)[2]];
    let triangles = [
        with_corner(DVec3::NAN),
        with_corner(DVec3::INFINITY),
        with_corner(DVec3::splat(1e101)),
        [DVec3::ONE; 3],
        [DVec3::X, 2.0 * DVec3::X, 3.0 * DVec3::X],
        [wall(1.0)[0], wall(1.0)[0], wall(1.0)[1]],
        wall(2.0),
    ];
    let levels = levels(&triangles);
    let hit = cast(&levels, DVec3::ZERO, DVec3::X, f64::INFINITY).unwrap();
    assert_eq!((hit.distance, hit.triangle), (2.0, 6));
    assert_eq!(levels.indices[0].len(), 7);
    assert_eq!(levels.indices[0].bounds(), Some((DVec3::new(2.0, -1.0, -1.0), DVec3::new(2.0, 1.0, 2.0))));
    let invisible = MeshIndex::new(&triangles[..6]);
    let hit = invisible.cast(DVec3::ZERO, DVec3::X, 9.0);
    assert_eq!((hit, invisible.bounds(), invisible.is_empty()), (None, None, false));
    assert!(MeshIndex::new(&[]).is_empty());
}

#[test]
fn invalid_rays_hit_nothing() {
    let index = MeshIndex::new(&[[DVec3::new(1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 0.0, 2.0)]]);
    assert!(index.cast(DVec3::ZERO, DVec3::X, 1.0).is_some());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let (mut origin, mut direction) = (DVec3::ZERO, DVec3::X);
            origin[axis] = bad;
            direction[axis] = bad;
            assert_eq!(index.cast(origin, DVec3::X, 2.0), None);
            assert_eq!(index.cast(DVec3::ZERO, direction, 2.0), None);
        }
    }
    for (direction, range) in [(DVec3::X, f64::NAN), (DVec3::X, -1.0), (DVec3::ZERO, 2.0), (1.1 * DVec3::X, 2.0)] {
        assert_eq!(index.cast(DVec3::ZERO, direction, range), None);
    }
    assert_eq!(index.cast(DVec3::splat(1e99), DVec3::X, f64::INFINITY), None);
}

#[test]
fn a_ray_that_starts_on_a_surface_hits_it_at_once() {
    let mut random = Random::new(17);
    for reach in [1.0, 1e4] {
        for seed in 0..40 {
            let corners = random_triangles(100 + seed, 1, reach, 1.0);
            let levels = levels(&corners);
            let [a, b, c] = corners[0];
            for _ in 0..25 {
                let (u, v) = (random.between(0.05, 0.45), random.between(0.05, 0.45));
                let direction = unit_vector(&mut random);
                let hit = cast(&levels, a + u * (b - a) + v * (c - a), direction, 9.0);
                let distance = hit.map(|hit| hit.distance);
                // If rounding puts the origin above the surface, the distance is the origin's height divided by the
                // cosine of the incidence angle.
                assert!(distance.is_some_and(|metres| metres < 1e-9 * reach), "{distance:?} towards {direction}")
            }
        }
    }
}

#[test]
fn a_ray_in_a_triangles_plane_hits_where_it_enters() {
    let triangle = [[DVec3::new(1.0, -1.0, 0.5), DVec3::new(3.0, 0.0, 0.5), DVec3::new(1.0, 1.0, 0.5)]];
    let levels = levels(&triangle);
    let cast = |x: f64, y: f64, direction| cast(&levels, DVec3::new(x, y, 0.5), direction, 9.0);
    let distance = |x, y, direction| cast(x, y, direction).map(|hit| hit.distance);
    assert_eq!(distance(0.0, 0.0, DVec3::X), Some(1.0));
    assert_eq!(distance(0.0, 1.0, DVec3::X), Some(1.0), "through a corner");
    assert_eq!(distance(0.0, 1.5, DVec3::X), None);
    assert_eq!(distance(5.0, 0.0, -DVec3::X), Some(2.0));
    assert_eq!(distance(2.0, 3.0, -DVec3::Y), Some(2.5));
    assert_eq!(distance(1.0, 3.0, -DVec3::Y), Some(2.0), "along an edge");
    assert_eq!(distance(2.0, 0.0, DVec3::X), Some(0.0), "from inside the triangle");
    assert_eq!(distance(4.0, 0.0, DVec3::X), None, "away from it");
    assert_eq!(cast(0.0, 0.0, DVec3::X).unwrap().normal, DVec3::Z);
}

#[test]
fn hits_of_slivers_lie_on_the_slivers() {
    let mut random = Random::new(18);
    for thickness in [1e-6, 1e-10, 1e-13, 1e-16] {
        let triangles: Vec<Triangle> = (0..40)
            .map(|_| {
                let (a, b) = (point(&mut random, 2.0), point(&mut random, 2.0));
                [a, b, 0.5 * (a + b) + thickness * unit_vector(&mut random)]
            })
            .collect();
        let levels = levels(&triangles);
        for _ in 0..400 {
            let origin = point(&mut random, 3.0);
            let direction = direction_to_edge(&triangles, origin, &mut random);
            if let Some(hit) = cast(&levels, origin, direction, 20.0) {
                let [a, b, _] = triangles[hit.triangle as usize];
                let (hit_point, along) = (origin + hit.distance * direction, (b - a).normalize_or_zero());
                let distance = (hit_point - a).reject_from(along).length();
                // For a ray almost parallel to the sliver, the position of the hit is undetermined.
                let is_parallel = direction.cross(along).length() < 1e-3;
                assert!(is_parallel || distance < thickness + 1e-9, "{distance} from a sliver of {thickness}");
            }
        }
    }
}

#[test]
fn coinciding_and_nested_triangles_make_no_deep_tree() {
    let mut triangles = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 500];
    // Nested triangles, each half as large as the previous one.
    triangles.extend((0..300).map(|step| {
        let size = f64::from_bits((1023 - step) << 52);
        [DVec3::ZERO, DVec3::X * size, DVec3::new(0.0, size, size)]
    }));
    let levels = levels(&triangles);
    let mut random = Random::new(19);
    for _ in 0..300 {
        check(&levels, point(&mut random, 2.0), unit_vector(&mut random), 9.0, 1e-9);
    }
}

#[test]
fn distances_in_a_room_match_its_planes() {
    let mut random = Random::new(20);
    for far in [0.0, 1e4] {
        let low = DVec3::new(far, -far, 0.0);
        let size = DVec3::new(4.0, 3.0, 2.5);
        let index = MeshIndex::new(&cuboid(low, low + size));
        for _ in 0..5000 {
            let fractions =
                DVec3::new(random.between(0.01, 0.99), random.between(0.01, 0.99), random.between(0.01, 0.99));
            let (origin, direction) = (low + fractions * size, unit_vector(&mut random));
            let expected = (0..3).fold(f64::INFINITY, |minimum: f64, axis| {
                let wall = if direction[axis] > 0.0 { low[axis] + size[axis] } else { low[axis] };
                minimum.min(((wall - origin[axis]) / direction[axis]).abs())
            });
            let hit = index.cast(origin, direction, f64::INFINITY).unwrap();
            assert!((hit.distance - expected).abs() < 1e-9, "{hit:?} instead of {expected}");
            assert!(hit.normal.dot(direction) < 0.0 && hit.normal.abs().max_element() == 1.0, "{hit:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Coordinates on a coarse grid give shared corners, coplanar and degenerate triangles, and rays along edges and
    /// planes.
    #[test]
    fn all_levels_agree_with_the_test_of_every_triangle(
        corners in prop::collection::vec(prop::array::uniform9(-3_i8..4), 1..60),
        rays in prop::collection::vec((prop::array::uniform3(-8_i8..9), prop::array::uniform3(-2_i8..3)), 1..20),
    ) {
        let triangles: Vec<Triangle> = corners
            .iter()
            .map(|numbers| [0, 3, 6].map(|start| DVec3::from_array([0, 1, 2].map(|axis| f64::from(numbers[start + axis])))))
            .collect();
        let levels = levels(&triangles);
        for (origin, direction) in rays {
            let origin = DVec3::from_array(origin.map(|number| 0.5 * f64::from(number)));
            let direction = DVec3::from_array(direction.map(f64::from)).normalize_or(DVec3::X);
            cast(&levels, origin, direction, 20.0);
        }
    }

    #[test]
    fn distances_inside_a_rotated_box_match_its_planes(
        angle in 0.0..PI, x in -0.9..0.9_f64, y in -0.9..0.9_f64, bearing in 0.0..TAU,
    ) {
        let rotation = glam::DMat3::from_rotation_z(angle);
        let faces = cuboid(DVec3::NEG_ONE, DVec3::ONE);
        let triangles: Vec<Triangle> = faces.iter().map(|face| face.map(|corner| rotation * corner)).collect();
        let (sin, cos) = math::sin_cos(bearing);
        let direction = DVec3::new(cos, sin, 0.0);
        let origin = rotation * DVec3::new(x, y, 0.0);
        let hit = cast(&levels(&triangles), origin, rotation * direction, 9.0).expect("the box is closed");
        let to_plane = |coordinate: f64, component: f64| {
            if component == 0.0 { f64::INFINITY } else { (component.signum() - coordinate) / component }
        };
        prop_assert!((hit.distance - to_plane(x, cos).min(to_plane(y, sin))).abs() < 1e-12);
    }
}
