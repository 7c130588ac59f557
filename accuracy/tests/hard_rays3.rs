//! Hard cases of rays among triangles: rays through shared edges and corners, rays in the planes of triangles, and tiny
//! triangles in a large world.

use accuracy::oracle;
use accuracy::world::{Random, cuboid};
use glam::{DMat3, DVec3};
use sim_core::math;
use sim_core::scene::MeshIndex;

type Triangle = [DVec3; 3];

/// Tolerance of distances, m.
const TOLERANCE: f64 = 1e-9;

/// Closed surface from a grid of squares whose last column joins the first and whose last row joins the first; `point`
/// maps a corner's column and row to its position.
fn closed_surface(columns: usize, rows: usize, point: impl Fn(usize, usize) -> DVec3) -> Vec<Triangle> {
    let square = |cell: usize| {
        let (column, row) = (cell % columns, cell / columns);
        let (next, above) = ((column + 1) % columns, (row + 1) % rows);
        let [a, b, c, d] = [point(column, row), point(next, row), point(column, above), point(next, above)];
        [[a, b, d], [a, d, c]]
    };
    (0..columns * rows).flat_map(square).collect()
}

/// Torus with a tube of radius 1 m around a circle of radius 3 m.
fn torus() -> Vec<Triangle> {
    let angle = |number: usize, count: usize| std::f64::consts::TAU * number as f64 / count as f64;
    closed_surface(24, 12, |column, row| {
        let ((sin, cos), (up, out)) = (math::sin_cos(angle(column, 24)), math::sin_cos(angle(row, 12)));
        DVec3::new((3.0 + out) * cos, (3.0 + out) * sin, up)
    })
}

/// Point on an edge of a random triangle: a corner, the midpoint, a quarter point or a random point of the edge.
fn point_of_an_edge(triangles: &[Triangle], random: &mut Random) -> DVec3 {
    let [a, b, c] = triangles[random.below(triangles.len())];
    match random.below(4) {
        0 => a,
        1 => 0.5 * (b + c),
        2 => c + 0.25 * (a - c),
        _ => a + random.between(0.0, 1.0) * (b - a),
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh_through_an_edge() {
    let rotation = DMat3::from_cols_array(&[2.0, 2.0, -1.0, -1.0, 2.0, 2.0, 2.0, -1.0, 2.0]) * (1.0 / 3.0);
    let half = DVec3::new(2.0, 1.5, 1.25);
    let far = DVec3::new(1e4, -1e4, 0.0);
    let meshes = [
        ("axis-aligned box", cuboid(half, 4, |point| point), DVec3::ZERO),
        ("axis-aligned box, 10 km away", cuboid(half, 4, |point| point + far), far),
        ("rotated box", cuboid(half, 5, |point| rotation * point), DVec3::ZERO),
        ("torus", torus(), DVec3::new(3.0, 0.0, 0.0)),
    ];
    let mut random = Random::new(61);
    for (name, triangles, inside) in meshes {
        let index = MeshIndex::new(&triangles);
        for ray in 0..500_000 {
            // Every other ray starts at a point of a grid with a spacing of 0.25 m.
            let offset = if ray % 2 == 0 {
                DVec3::new(random.below(5) as f64, random.below(5) as f64, random.below(3) as f64)
                    - DVec3::new(2.0, 2.0, 1.0)
            } else {
                DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0))
            };
            let origin = inside + 0.25 * offset;
            let target = point_of_an_edge(&triangles, &mut random);
            let to_target = target - origin;
            let hit = index.cast(origin, to_target.normalize_or(DVec3::X), f64::INFINITY);
            // A ray inside the torus may miss a surface that it only grazes.
            let farthest = if name == "torus" { f64::INFINITY } else { to_target.length() + TOLERANCE };
            assert!(hit.is_some_and(|hit| hit.distance <= farthest), "{name}: {hit:?} from {origin} to {target}");
        }
    }
}

#[test]
fn rays_along_an_axis_miss_a_box_only_outside() {
    let half = DVec3::splat(2.0);
    let index = MeshIndex::new(&cuboid(half, 4, |point| point));
    // The rays form a grid with a spacing of 0.25 m that extends 0.5 m beyond the box. Many pass through edges and
    // corners of the mesh's squares (1 m wide); some lie in the planes of faces.
    for cell in 0..21 * 21 {
        let (u, v) = (f64::from(cell % 21) * 0.25 - 2.5, f64::from(cell / 21) * 0.25 - 2.5);
        for axis in 0..3 {
            let mut origin = DVec3::ZERO;
            origin[(axis + 1) % 3] = u;
            origin[(axis + 2) % 3] = v;
            for side in [-1.0, 1.0] {
                origin[axis] = -5.0 * side;
                let distance = index.cast(origin, DVec3::AXES[axis] * side, f64::INFINITY).map(|hit| hit.distance);
                let expected = (f64::max(u.abs(), v.abs()) <= 2.0).then_some(3.0);
                assert_eq!(distance, expected, "from {origin} along axis {axis}");
            }
        }
    }
}

#[test]
fn tiny_boxes_are_hit_in_a_large_world() {
    let mut random = Random::new(62);
    let ground = |z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(1e4 * x, 1e4 * y, z);
        [
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)],
            [corner(-1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        ]
    };
    let mut triangles = ground(-1.0).to_vec();
    let positions: Vec<DVec3> = (0..40)
        .map(|_| DVec3::new(random.between(-9e3, 9e3), random.between(-9e3, 9e3), random.between(0.0, 2.0)))
        .collect();
    // The boxes are 2 mm wide and are spread over 18 km.
    for position in &positions {
        triangles.extend(cuboid(DVec3::splat(1e-3), 1, |point| point + *position));
    }
    let index = MeshIndex::new(&triangles);
    for position in positions {
        for _ in 0..50 {
            let target = position + 9e-4 * random.direction_in_space();
            let origin = position + random.between(0.01, 5.0) * random.direction_in_space();
            let to_target = target - origin;
            let hit =
                index.cast(origin, to_target.normalize_or(DVec3::X), f64::INFINITY).expect("the index finds the box");
            let (truth, number) =
                oracle::nearest_triangle(&triangles, origin, to_target.normalize_or(DVec3::X), f64::INFINITY, 1e-11)
                    .expect("brute force finds the box");
            assert!((hit.distance - truth).abs() < TOLERANCE, "{hit:?} instead of {truth}, triangle {number}");
        }
    }
}

#[test]
fn meshes_of_few_triangles_match_brute_force() {
    assert_eq!(MeshIndex::new(&[]).cast(DVec3::ZERO, DVec3::X, f64::INFINITY), None);
    let mut random = Random::new(63);
    for count in 1..20 {
        let triangles: Vec<Triangle> =
            (0..count).map(|_| [(); 3].map(|()| 3.0 * random.direction_in_space())).collect();
        let index = MeshIndex::new(&triangles);
        for _ in 0..500 {
            let (origin, direction) = (5.0 * random.direction_in_space(), random.direction_in_space());
            let brute_force = |margin| {
                oracle::nearest_triangle(&triangles, origin, direction, 20.0, margin).map_or(20.0, |hit| hit.0)
            };
            let distance = index.cast(origin, direction, 20.0).map_or(20.0, |hit| hit.distance);
            let (min, max) = (brute_force(1e-10) - TOLERANCE, brute_force(-1e-10) + TOLERANCE);
            assert!(distance >= min && distance <= max, "{distance}, not in [{min}, {max}]: {origin} {direction}");
        }
    }
}
