//! `rays-2d`: distances along rays to walls, by the spatial index and by brute force in double and in single precision.

use glam::{DVec2, Vec2};
use sim_core::scene::{Bounds, Segment, Walls};

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::oracle;
use crate::wide::Wide;
use crate::world::{self, Random};

pub const STUDY: Study =
    Study { name: "rays-2d", title: "Ray casting among vertical walls: error and time by number of walls", run };

/// Numbers of boxes in the room. Each box has 4 walls; the room adds 4 more.
const BOXES: [usize; 5] = [2, 24, 74, 249, 2_499];
/// Floor area per wall, m^2: that of 300 walls in a room of 20 m.
const AREA: f64 = 400.0 / 300.0;
/// Range of the rays, m.
const RANGE: f64 = 30.0;

fn run(effort: Effort) -> Outcome {
    let settings = BOXES.map(|boxes| measure_room(effort, boxes));
    let methods = (0..METHODS).flat_map(|method| settings.iter().map(move |rows| rows[method].clone()));
    methods.collect::<Vec<_>>().into()
}

const METHODS: usize = 3;

/// A ray, and the true distance along it to the nearest wall, m.
struct Case {
    origin: DVec2,
    direction: DVec2,
    truth: f64,
}

/// Errors and times of the three methods in a room with boxes.
fn measure_room(effort: Effort, boxes: usize) -> [Row; METHODS] {
    let count = 4 * (boxes + 1);
    let side = (AREA * count as f64).sqrt();
    let segments = world::room_with_boxes(51, DVec2::ZERO, side, boxes);
    // With more walls there are fewer rays, so that each setting takes about the same time.
    let cases = cases(&segments, side, effort.of(10_000).min(effort.of(20_000_000) / count));
    let brute_force_cases = &cases[..cases.len().min(effort.of(300_000) / count).max(10)];
    let measured = |method: &str, cases: &[Case], cast: &dyn Fn(&Case) -> f64| {
        let error = cases.iter().map(|case| (cast(case) - case.truth).abs()).fold(0.0, f64::max);
        let time_ns = nanoseconds(effort.of(50), cases.len(), || cases.iter().map(cast).sum::<f64>());
        let setting = format!("{count} walls");
        Row { study: STUDY.name, method: method.to_owned(), setting, error, unit: "m", time_ns, per: "ray" }
    };
    let walls = Walls::new(segments.clone());
    let single: Vec<[Vec2; 2]> = segments.iter().map(|wall| [wall.a.as_vec2(), wall.b.as_vec2()]).collect();
    [
        measured("index", &cases, &|case| {
            walls.cast(case.origin, case.direction, RANGE).map_or(RANGE, |hit| hit.distance)
        }),
        measured("brute-force", brute_force_cases, &|case| {
            oracle::nearest_wall(&segments, case.origin, case.direction, RANGE, 0.0).map_or(RANGE, |(metres, _)| metres)
        }),
        measured("single precision", brute_force_cases, &|case| {
            let (origin, direction) = (case.origin.as_vec2(), case.direction.as_vec2());
            let distances = single.iter().filter_map(|wall| cast_f32(wall, origin, direction));
            f64::from(distances.fold(RANGE as f32, f32::min))
        }),
    ]
}

fn cases(walls: &[Segment], side: f64, count: usize) -> Vec<Case> {
    let mut random = Random::new(52);
    let inside = Bounds { min: DVec2::ZERO, max: DVec2::splat(side) };
    let mut case = || {
        let (origin, direction) = (random.point_in(inside), random.direction());
        let truths = walls.iter().filter_map(|wall| exact(wall, origin, direction));
        Case { origin, direction, truth: truths.fold(RANGE, f64::min) }
    };
    (0..count.max(10)).map(|_| case()).collect()
}

/// Distance along the ray to a wall by Cramer's rule, as in the oracle but in `f32`; `None` if the ray misses the wall.
fn cast_f32(&[a, b]: &[Vec2; 2], origin: Vec2, direction: Vec2) -> Option<f32> {
    let (to_wall, along) = (a - origin, b - a);
    let determinant = direction.perp_dot(along);
    let t = to_wall.perp_dot(along) / determinant;
    let u = to_wall.perp_dot(direction) / determinant;
    (t >= 0.0 && (0.0..=1.0).contains(&u)).then_some(t)
}

/// Distance along the ray to a wall, in double-double arithmetic (32 digits). A first test in double precision skips
/// walls that the ray misses by more than a micrometre.
fn exact(wall: &Segment, origin: DVec2, direction: DVec2) -> Option<f64> {
    oracle::nearest_wall(std::slice::from_ref(wall), origin, direction, RANGE, 1e-6)?;
    let to_wide = |point: DVec2| [point.x, point.y].map(Wide::from);
    let difference = |[ax, ay]: [Wide; 2], [bx, by]: [Wide; 2]| [ax - bx, ay - by];
    let cross = |[ax, ay]: [Wide; 2], [bx, by]: [Wide; 2]| ax * by - ay * bx;
    let (to_wall, along) = (difference(to_wide(wall.a), to_wide(origin)), difference(to_wide(wall.b), to_wide(wall.a)));
    let determinant = cross(to_wide(direction), along);
    let t = (cross(to_wall, along) / determinant).rounded();
    let u = (cross(to_wall, to_wide(direction)) / determinant).rounded();
    (t >= 0.0 && (0.0..=1.0).contains(&u)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_is_exact_within_rounding_and_single_precision_is_not() {
        let rows = run(Effort::Quick).rows;
        assert_eq!(rows.len(), METHODS * BOXES.len());
        for row in &rows {
            // A ray that grazes its wall amplifies rounding.
            let bound = if row.method == "single precision" { 0.1 } else { 1e-11 };
            assert!(row.error < bound && row.time_ns > 0.0, "{row:?}");
        }
        let max_error =
            |method: &str| rows.iter().filter(|row| row.method == method).map(|row| row.error).fold(0.0, f64::max);
        assert!(max_error("single precision") > 1e5 * max_error("index"), "{rows:?}");
    }

    #[test]
    fn reference_is_exact() {
        let wall = Segment::new(DVec2::new(3.0, -1.0), DVec2::new(3.0, 5.0));
        assert_eq!(exact(&wall, DVec2::ZERO, DVec2::X), Some(3.0));
        assert_eq!(exact(&wall, DVec2::ZERO, DVec2::new(0.6, 0.8)), Some(3.0 / 0.6));
        assert_eq!(exact(&wall, DVec2::ZERO, DVec2::NEG_X), None);
        assert_eq!(exact(&wall, DVec2::new(0.0, 6.0), DVec2::X), None);
    }
}
