//! Triangles in space, and rays among them.

use std::f64::consts::{FRAC_PI_4, TAU};

use accuracy::world::Random;
use glam::{DVec2, DVec3};
use sim_core::math;
use sim_core::scene::Segment;

/// Three corners in metres.
pub type Triangle = [DVec3; 3];

/// A ray in space.
#[derive(Clone, Copy, Debug)]
pub struct Ray3 {
    /// Origin, m.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Range, m.
    pub range: f64,
}

impl Ray3 {
    /// The ray as numbers: origin, direction, range.
    pub fn numbers(&self) -> [f64; 7] {
        let ([x, y, z], [dx, dy, dz]) = (self.origin.to_array(), self.direction.to_array());
        [x, y, z, dx, dy, dz, self.range]
    }
}

/// Number of cells along a side of the terrain, of half a metre each.
const CELLS: usize = 224;
const CELL: f64 = 0.5;
const SIDE: f64 = CELLS as f64 * CELL;

/// Height of the terrain at a point: hills of several sizes, at most 5.4 m from the lowest to the highest point.
fn height(x: f64, y: f64) -> f64 {
    let wave = |a: f64, b: f64, phase: f64| math::sin(a * x + b * y + phase);
    1.5 * wave(0.11, 0.07, 0.3) + 0.8 * wave(-0.21, 0.33, 1.0) + 0.3 * wave(0.9, 0.7, 2.0) + 0.1 * wave(2.9, -3.7, 0.5)
}

fn grid_point(column: usize, row: usize) -> DVec3 {
    let (x, y) = (column as f64 * CELL, row as f64 * CELL);
    DVec3::new(x, y, height(x, y))
}

/// 100,352 triangles: hills on a square of 112 m.
pub fn terrain() -> Vec<Triangle> {
    let square = |cell: usize| {
        let (column, row) = (cell % CELLS, cell / CELLS);
        let (a, b) = (grid_point(column, row), grid_point(column + 1, row));
        let (c, d) = (grid_point(column, row + 1), grid_point(column + 1, row + 1));
        [[a, b, d], [a, d, c]]
    };
    (0..CELLS * CELLS).flat_map(square).collect()
}

/// A point `above` m over the terrain, at least 6 m from its border.
fn over_terrain(random: &mut Random, above: f64) -> DVec3 {
    let at = DVec2::new(random.between(6.0, SIDE - 6.0), random.between(6.0, SIDE - 6.0));
    at.extend(height(at.x, at.y) + above)
}

fn towards(azimuth: f64, elevation: f64) -> DVec3 {
    let ((sin, cos), (up, horizontal)) = (math::sin_cos(azimuth), math::sin_cos(elevation));
    DVec3::new(horizontal * cos, horizontal * sin, up)
}

/// The rays among the terrain, by kind.
pub fn terrain_rays() -> Vec<(&'static str, Vec<Ray3>)> {
    vec![("camera", camera()), ("psd", bundles()), ("lidar", lidar()), ("incoherent", incoherent())]
}

/// Rays of pictures of 160 by 120 pixels, row by row, by cameras 2 m above the ground that look down by 10 degrees.
fn camera() -> Vec<Ray3> {
    let mut random = Random::new(31);
    let picture = |origin: DVec3, azimuth: f64| {
        let (sin, cos) = math::sin_cos(azimuth);
        let (forward, left) = (towards(azimuth, -0.17), DVec3::new(-sin, cos, 0.0));
        let up = forward.cross(left);
        (0..160 * 120).map(move |pixel| {
            let (column, row) = (f64::from(pixel % 160), f64::from(pixel / 160));
            let direction = forward + left * (79.5 - column) / 160.0 + up * (59.5 - row) / 160.0;
            Ray3 { origin, direction: direction.normalize_or_zero(), range: 200.0 }
        })
    };
    (0..6).flat_map(|_| picture(over_terrain(&mut random, 2.0), random.between(0.0, TAU))).collect()
}

/// Eight rays around each of many robots, 20 cm above the ground, with a range of 2 m.
fn bundles() -> Vec<Ray3> {
    let mut random = Random::new(32);
    let mut robot = move || {
        let (origin, heading) = (over_terrain(&mut random, 0.2), random.between(0.0, TAU));
        (0..8).map(move |beam| {
            let azimuth = heading + f64::from(beam) * FRAC_PI_4;
            Ray3 { origin, direction: towards(azimuth, 0.0), range: 2.0 }
        })
    };
    (0..12_500).flat_map(|_| robot()).collect()
}

/// Rays of full turns of 360 points in 8 layers from -15 to 6 degrees, 1 m above the ground, with a range of 60 m.
fn lidar() -> Vec<Ray3> {
    let mut random = Random::new(33);
    let mut turn = move || {
        let origin = over_terrain(&mut random, 1.0);
        (0..8 * 360).map(move |point| {
            let (layer, degree) = (f64::from(point / 360), f64::from(point % 360));
            let direction = towards(degree.to_radians(), (3.0 * layer - 15.0).to_radians());
            Ray3 { origin, direction, range: 60.0 }
        })
    };
    (0..35).flat_map(|_| turn()).collect()
}

/// Rays from random points up to 5 m above the ground in random directions, with a range of 100 m.
fn incoherent() -> Vec<Ray3> {
    let mut random = Random::new(34);
    let mut ray = move || {
        let above = random.between(0.1, 5.0);
        let origin = over_terrain(&mut random, above);
        let direction = random.direction_in_space().normalize_or_zero();
        Ray3 { origin, direction, range: 100.0 }
    };
    (0..100_000).map(|_| ray()).collect()
}

/// Rays from above aimed exactly at corners and at points of edges that triangles of the terrain share. Their range
/// ends 1 m beyond the point. A ray without a hit has leaked.
pub fn edge_rays(count: usize) -> Vec<Ray3> {
    let mut random = Random::new(35);
    let mut ray = |turn: usize| {
        let (column, row) = (1 + random.below(CELLS - 2), 1 + random.below(CELLS - 2));
        let corner = grid_point(column, row);
        let other = [grid_point(column + 1, row), grid_point(column, row + 1), grid_point(column + 1, row + 1)];
        let fraction = [0.0, 0.5, 0.25, random.between(0.0, 1.0)][turn % 4];
        let target = corner + fraction * (other[random.below(3)] - corner);
        // Every third ray points straight down, like those of sensors on a grid.
        let horizontal_offset = if turn.is_multiple_of(3) {
            DVec3::ZERO
        } else {
            random.direction().extend(0.0) * random.between(0.0, 6.0)
        };
        let origin = target + horizontal_offset + 8.0 * DVec3::Z;
        let offset = target - origin;
        Ray3 { origin, direction: offset.normalize_or_zero(), range: offset.length() + 1.0 }
    };
    (0..count).map(&mut ray).collect()
}

/// The rays of a PSD among extruded walls, at half the height of the walls.
pub fn level_rays(rays: &[crate::Ray]) -> Vec<Ray3> {
    rays.iter()
        .map(|ray| Ray3 { origin: ray.origin.extend(0.5), direction: ray.direction.extend(0.0), range: ray.range })
        .collect()
}

/// Rays from the centres of the cells of a maze on a grid of 1 m, aimed exactly at points of the diagonals that divide
/// its walls into triangles. Their range ends 1 mm beyond the point. A ray without a hit has leaked.
pub fn diagonal_rays(walls: &[Segment], count: usize) -> Vec<Ray3> {
    let mut random = Random::new(36);
    let mut ray = || {
        let wall = walls[random.below(walls.len())];
        let fraction = [0.25, 0.5, 0.75][random.below(3)];
        let target = wall.a.lerp(wall.b, fraction).extend(fraction);
        let mut cell = || random.below(9) as f64 - 4.0;
        let origin = (wall.a.floor() + DVec2::new(0.5 + cell(), 0.5 + cell())).extend(0.5);
        let offset = target - origin;
        Ray3 { origin, direction: offset.normalize_or_zero(), range: offset.length() + 1e-3 }
    };
    (0..count).map(|_| ray()).collect()
}
