//! Scenes shared by the benches.
#![forbid(unsafe_code)]

pub mod swarm;
pub mod terrain;

use accuracy::world::{self, Random};
use glam::DVec2;
use sim_core::math;
use sim_core::scene::{Bounds, Segment};

/// A ray as sensors cast it: lengths in metres, world frame.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub origin: DVec2,
    /// Unit vector.
    pub direction: DVec2,
    /// Range.
    pub range: f64,
}

/// Side of the room of [`walls`].
const SIDE: f64 = 20.0;

/// 300 walls: a room of 20 m by 20 m with 74 boxes.
pub fn walls() -> Vec<Segment> {
    world::room_with_boxes(1, DVec2::ZERO, SIDE, 74)
}

/// About 300 walls on a square grid, like a maze with cells of 1 m.
pub fn maze() -> Vec<Segment> {
    world::maze(1, DVec2::ZERO, 15, 1.0)
}

/// `count` rays of a PSD with a range of 2 m, from random points of the room in random directions.
pub fn psd_rays(count: usize) -> Vec<Ray> {
    let mut random = Random::new(2);
    let room = Bounds { min: DVec2::ZERO, max: DVec2::splat(SIDE) };
    (0..count).map(|_| Ray { origin: random.point_in(room), direction: random.direction(), range: 2.0 }).collect()
}

/// `sweeps` full turns of a lidar of 360 points with a range of 30 m, each from a different point of the room.
pub fn lidar_rays(sweeps: usize) -> Vec<Ray> {
    let mut random = Random::new(3);
    let room = Bounds { min: DVec2::ZERO, max: DVec2::splat(SIDE) };
    let mut sweep = move || {
        let origin = random.point_in(room);
        (0..360_u32).map(move |degree| {
            let (sin, cos) = math::sin_cos(f64::from(degree).to_radians());
            Ray { origin, direction: DVec2::new(cos, sin), range: 30.0 }
        })
    };
    (0..sweeps).flat_map(|_| sweep()).collect()
}
