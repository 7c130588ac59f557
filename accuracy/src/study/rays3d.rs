//! `rays-3d`: distances along rays to triangles, by the index and by brute force, and to walls, which are segments in
//! the plane or triangles.

use glam::{DVec2, DVec3};
use sim_core::scene::{Bounds, MeshIndex, Segment, Walls};

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::oracle;
use crate::world::{self, Random};

pub const STUDY: Study =
    Study { name: "rays-3d", title: "Distance along a ray among triangles, against their number", run };

/// Numbers n of squares along an edge of each of the six faces of the room, which has 12 n^2 triangles.
const SQUARES: [u32; 4] = [3, 9, 29, 91];
/// Numbers of boxes in the room with boxes; each has 4 walls.
const BOXES: [usize; 4] = [4, 24, 249, 2_499];
/// Half sizes of the room, m.
const HALF: DVec3 = DVec3::new(2.0, 1.5, 1.25);
/// Side of the room with boxes, m.
const SIDE: f64 = 50.0;
/// Range of the rays among walls, m.
const RANGE: f64 = 10.0;

fn run(effort: Effort) -> Outcome {
    let in_rooms = by_method(SQUARES.into_iter().map(|squares| in_room(effort, squares)));
    let among_walls = by_method(BOXES.into_iter().map(|boxes| among_walls(effort, boxes)));
    in_rooms.chain(among_walls).collect::<Vec<_>>().into()
}

/// A ray, and the true distance along it to the nearest surface in metres, infinite if there is none.
struct Case {
    origin: DVec3,
    direction: DVec3,
    truth: f64,
}

/// Row with the error and the time of `cast`, which returns metres. `None`, for a ray without a hit, is treated as a
/// hit at the range.
fn row(method: &str, setting: String, effort: Effort, cases: &[Case], cast: impl Fn(&Case) -> Option<f64>) -> Row {
    let distance = |case: &Case| cast(case).unwrap_or(RANGE);
    let error = |case: &Case| (distance(case) - case.truth.min(RANGE)).abs();
    let time_ns = nanoseconds(effort.of(50), cases.len(), || cases.iter().map(distance).sum::<f64>());
    let error = cases.iter().map(error).fold(0.0, f64::max);
    Row { study: STUDY.name, method: method.to_owned(), setting, error, unit: "m", time_ns, per: "ray" }
}

/// Rows for rays from random points in the room in random directions.
fn in_room(effort: Effort, squares: u32) -> [Row; 2] {
    let triangles = world::cuboid(HALF, squares, world_from_room);
    let setting = format!("{} triangles", triangles.len());
    let index = MeshIndex::new(&triangles);
    let by_index = row("index", setting.clone(), effort, &room_cases(effort.of(20_000)), |case| {
        index.cast(case.origin, case.direction, RANGE).map(|hit| hit.distance)
    });
    // With more triangles there are fewer rays, so that each setting takes about the same time.
    let brute_force_cases = room_cases((effort.of(1_000_000) / triangles.len()).clamp(5, 1_000));
    let by_brute_force = row("brute-force", setting, effort, &brute_force_cases, |case| {
        oracle::nearest_triangle(&triangles, case.origin, case.direction, RANGE, 1e-12).map(|(metres, _)| metres)
    });
    [by_index, by_brute_force]
}

/// Transforms a point from the room's frame to the world frame by a rotation whose matrix is integers divided by 3.
fn world_from_room(local: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = local;
    DVec3::new(2.0 * x - y + 2.0 * z, 2.0 * x + 2.0 * y - z, -x + 2.0 * y + 2.0 * z) / 3.0
}

fn room_cases(count: usize) -> Vec<Case> {
    let mut random = Random::new(41);
    let mut case = || {
        let fractions = DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        let direction = random.direction_in_space().normalize_or(DVec3::X);
        // Of the three faces that the ray approaches, it hits the nearest along its direction.
        let origin = 0.99 * fractions * HALF;
        let wall_distances = (HALF.copysign(direction) - origin) / direction;
        Case {
            origin: world_from_room(origin),
            direction: world_from_room(direction),
            truth: wall_distances.min_element(),
        }
    };
    (0..count).map(|_| case()).collect()
}

/// Rows for rays at a height of 0.5 m among walls, as segments in the plane and as triangles.
fn among_walls(effort: Effort, boxes: usize) -> [Row; 2] {
    let segments = world::room_with_boxes(42, DVec2::ZERO, SIDE, boxes);
    let cases = wall_cases(&segments, effort.of(5_000));
    let setting = format!("{} walls", segments.len());
    let index = MeshIndex::new(&world::extruded(&segments));
    let walls = Walls::new(segments);
    let in_2d = row("walls in 2D", setting.clone(), effort, &cases, |case| {
        walls.cast(case.origin.truncate(), case.direction.truncate(), RANGE).map(|hit| hit.distance)
    });
    let in_3d = row("walls as triangles", setting, effort, &cases, |case| {
        index.cast(case.origin, case.direction, RANGE).map(|hit| hit.distance)
    });
    [in_2d, in_3d]
}

fn wall_cases(walls: &[Segment], count: usize) -> Vec<Case> {
    let mut random = Random::new(43);
    let inside = Bounds { min: DVec2::ZERO, max: DVec2::splat(SIDE) };
    let mut case = || {
        let (origin, direction) = (random.point_in(inside), random.direction());
        let truth =
            oracle::nearest_wall(walls, origin, direction, RANGE, 0.0).map_or(f64::INFINITY, |(metres, _)| metres);
        Case { origin: origin.extend(0.5), direction: direction.extend(0.0), truth }
    };
    (0..count).map(|_| case()).collect()
}

/// Rows of the pairs, sorted by method: the first rows of all pairs, then the second rows.
fn by_method(pairs: impl Iterator<Item = [Row; 2]>) -> impl Iterator<Item = Row> {
    let (first, second): (Vec<_>, Vec<_>) = pairs.map(|[first, second]| (first, second)).unzip();
    first.into_iter().chain(second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_exact_within_rounding() {
        let rows = run(Effort::Quick).rows;
        assert_eq!(rows.len(), 16);
        // Within a nanometre: a ray that grazes its wall may amplify rounding a thousandfold.
        assert!(rows.iter().all(|row| row.error < 1e-9 && row.time_ns > 0.0), "{rows:?}");
    }

    #[test]
    fn room_has_the_surface_area_of_its_sides() {
        let [small, large] = [1, 5].map(|squares| world::cuboid(HALF, squares, world_from_room));
        assert_eq!((small.len(), large.len()), (12, 300));
        let area = |triangles: &[[DVec3; 3]]| -> f64 {
            triangles.iter().map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
        };
        // The room is 4 m by 3 m by 2.5 m.
        for triangles in [small, large] {
            assert!((area(&triangles) - 2.0 * (12.0 + 7.5 + 10.0)).abs() < 1e-12, "{}", area(&triangles));
        }
    }
}
