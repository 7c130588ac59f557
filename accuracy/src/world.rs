//! Random scenes and rays for comparing the core with the oracles; the same seed gives the same scene.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_core::{Rng, SeedableRng};
use sim_core::math;
use sim_core::scene::{Bounds, Segment, Walls};
use sim_core::time::Time;
use sim_core::world::World;

/// Random number generator with a fixed seed.
pub struct Random(ChaCha8Rng);

impl Random {
    /// Generator with this `seed`.
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform number in [`low`, `high`).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + unit * (high - low)
    }

    /// Uniform integer below `count`, which must be positive.
    pub fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    /// Returns true with this `probability`.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// Uniform point in the rectangle.
    pub fn point_in(&mut self, bounds: Bounds) -> DVec2 {
        DVec2::new(self.between(bounds.min.x, bounds.max.x), self.between(bounds.min.y, bounds.max.y))
    }

    /// A unit vector of uniform direction.
    pub fn direction(&mut self) -> DVec2 {
        let (sin, cos) = math::sin_cos(self.between(0.0, TAU));
        DVec2::new(cos, sin)
    }

    /// A unit vector of uniform direction in space.
    pub fn direction_in_space(&mut self) -> DVec3 {
        let up = self.between(-1.0, 1.0);
        (self.direction() * (1.0 - up * up).sqrt()).extend(up)
    }
}

/// A world without walls, robots and objects.
pub fn empty() -> World {
    World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), std::iter::empty())
}

/// A closed square room of `side` metres with its lower left corner at `corner`. It contains `boxes` boxes, of 4 walls
/// each, with sides of 0.2 to 1 m and random orientations, which may overlap.
pub fn room_with_boxes(seed: u64, corner: DVec2, side: f64, boxes: usize) -> Vec<Segment> {
    let mut random = Random::new(seed);
    let room = Bounds { min: corner, max: corner + DVec2::splat(side) };
    let middle = corner + DVec2::new(0.0, 0.5 * side);
    let mut walls = Segment::new(middle, middle + DVec2::new(side, 0.0)).thickened(side).to_vec();
    for _ in 0..boxes {
        let half = random.direction() * random.between(0.1, 0.5);
        let centre = random.point_in(room.grown(-0.75_f64.min(0.5 * side)));
        walls.extend(Segment::new(centre - half, centre + half).thickened(random.between(0.2, 1.0)));
    }
    walls
}

/// A maze of `size` by `size` square cells of `cell` metres with its lower left corner at `corner`: a closed border,
/// and a wall of one cell's length on each inner edge with probability 0.5.
pub fn maze(seed: u64, corner: DVec2, size: usize, cell: f64) -> Vec<Segment> {
    let mut random = Random::new(seed);
    let corner_at = |column: usize, row: usize| corner + DVec2::new(column as f64, row as f64) * cell;
    let mut walls = Vec::new();
    for line in 0..=size {
        for position in 0..size {
            let is_border = line == 0 || line == size;
            if is_border || random.chance(0.5) {
                walls.push(Segment::new(corner_at(line, position), corner_at(line, position + 1)));
            }
            if is_border || random.chance(0.5) {
                walls.push(Segment::new(corner_at(position, line), corner_at(position + 1, line)));
            }
        }
    }
    walls
}

/// The walls as upright rectangles of 1 m, two triangles each.
pub fn extruded(walls: &[Segment]) -> Vec<[DVec3; 3]> {
    let side = |wall: &Segment| {
        let [a, b] = [wall.a, wall.b].map(|end| end.extend(0.0));
        let [c, d] = [b, a].map(|foot| foot + DVec3::Z);
        [[a, b, c], [a, c, d]]
    };
    walls.iter().flat_map(side).collect()
}

/// Faces of a box around the origin with these half sizes. Each face is divided into `squares` by `squares` squares of
/// two triangles; `transform` is applied to all points.
pub fn cuboid(half: DVec3, squares: u32, transform: impl Fn(DVec3) -> DVec3) -> Vec<[DVec3; 3]> {
    let coordinate = |step: u32| (2.0 * f64::from(step) - f64::from(squares)) / f64::from(squares);
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |column: u32, row: u32| {
                let mut coordinates = DVec3::splat(side);
                coordinates[(axis + 1) % 3] = coordinate(column);
                coordinates[(axis + 2) % 3] = coordinate(row);
                transform(coordinates * half)
            };
            for cell in 0..squares * squares {
                let (column, row) = (cell % squares, cell / squares);
                let [a, b] = [corner(column, row), corner(column + 1, row)];
                let [c, d] = [corner(column, row + 1), corner(column + 1, row + 1)];
                triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }
    triangles
}
