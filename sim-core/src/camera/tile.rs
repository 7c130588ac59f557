//! Visibility in a tile: the face shown by each pixel.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::face::Face;
use super::optics::TILE;
use super::rays::{PIXELS, Rays, Window};

/// Face numbers reserved for pixels that show the sky or the ground.
pub const SKY: u32 = u32::MAX;
pub const GROUND: u32 = u32::MAX - 1;

/// Number of the face shown by each pixel of a tile, row by row.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Column and row of the first pixel.
    pub origin: [u32; 2],
    pub shown: [u32; PIXELS],
}

impl Tile {
    /// Column and row in the image of a pixel of the tile.
    pub fn pixel(&self, pixel: usize) -> [u32; 2] {
        [self.origin[0] + pixel as u32 % TILE, self.origin[1] + pixel as u32 / TILE]
    }
}

/// Margin by which a face must be nearer to cover an earlier one, so that the first of several coplanar faces is
/// visible. The margin is relative to the maximum reciprocal distance of the face in the tile. It shifts the line where
/// two faces intersect by less than 1e-5 pixels.
const COPLANAR: f64 = 5e-7;

/// Finds the face shown by each pixel of a tile. The candidates are the faces of the tile, given by all `faces` and the
/// numbers of those in the tile, and the ground, whose plane is `ground`.
pub fn find_visible(
    level: Level,
    is_flat: bool,
    (rays, window): (&Rays, &Window),
    ground: DVec3,
    faces: (&[Face], &[u32]),
    shown: &mut [u32; PIXELS],
) {
    if is_flat {
        dispatch!(level, simd => nearest::<_, true>(simd, rays, window, ground, faces, shown));
    } else {
        dispatch!(level, simd => nearest::<_, false>(simd, rays, window, ground, faces, shown));
    }
}

// Vector code has no closures: only functions that are always inlined are compiled for the processor
// that is dispatched to. The number of lanes depends on the processor.
#[inline(always)]
fn nearest<S: Simd, const FLAT: bool>(
    simd: S,
    rays: &Rays,
    window: &Window,
    ground: DVec3,
    (faces, list): (&[Face], &[u32]),
    shown: &mut [u32; PIXELS],
) {
    let lanes = S::f32s::LEN;
    let mut nearest = [0.0_f32; PIXELS];
    *shown = [SKY; PIXELS];
    // Lower bound of the reciprocal distances in `nearest`: a face with smaller ones in the whole tile can be skipped.
    let mut min_nearest = 0.0;
    let (middle, deviation) = window.middle_and_deviation::<FLAT>(ground);
    if middle + deviation > 0.0 {
        let form = window.local::<FLAT>(ground);
        let zero = S::f32s::splat(simd, 0.0);
        let mut first = 0;
        while first < PIXELS {
            let pixels = first..first + lanes;
            let nearness = rays.value::<S, FLAT>(simd, form, first);
            let is_ground = nearness.simd_gt(zero);
            is_ground.select(nearness, zero).store_slice(&mut nearest[pixels.clone()]);
            is_ground.select(S::u32s::splat(simd, GROUND), S::u32s::splat(simd, SKY)).store_slice(&mut shown[pixels]);
            first += lanes;
        }
        min_nearest = (middle - deviation) - 1e-6 * (middle.abs() + deviation);
    }
    for &number in list {
        let face = &faces[number as usize];
        let (middle, deviation) = window.middle_and_deviation::<FLAT>(face.plane);
        if middle + deviation <= min_nearest {
            continue;
        }
        let margin = (COPLANAR * (middle.abs() + deviation)) as f32;
        let plane = window.local::<FLAT>(face.plane);
        let is_filled = fills_tile::<FLAT>(face, window);
        if is_filled {
            min_nearest = f64::max(min_nearest, (middle - deviation) - 1e-6 * (middle.abs() + deviation));
        }
        let edges = [
            window.local::<FLAT>(face.edges[0]),
            window.local::<FLAT>(face.edges[1]),
            window.local::<FLAT>(face.edges[2]),
        ];
        let min_edges = [
            -window.slack::<FLAT>(face.edges[0]) as f32,
            -window.slack::<FLAT>(face.edges[1]) as f32,
            -window.slack::<FLAT>(face.edges[2]) as f32,
        ];
        let mut first = 0;
        while first < PIXELS {
            let pixels = first..first + lanes;
            let nearness = rays.value::<S, FLAT>(simd, plane, first);
            let previous = S::f32s::from_slice(simd, &nearest[pixels.clone()]);
            let mut is_seen = nearness.simd_gt(previous + margin);
            if !is_filled {
                is_seen = is_seen
                    & rays.value::<S, FLAT>(simd, edges[0], first).simd_ge(min_edges[0])
                    & rays.value::<S, FLAT>(simd, edges[1], first).simd_ge(min_edges[1])
                    & rays.value::<S, FLAT>(simd, edges[2], first).simd_ge(min_edges[2]);
            }
            is_seen.select(nearness, previous).store_slice(&mut nearest[pixels.clone()]);
            let previous = S::u32s::from_slice(simd, &shown[pixels.clone()]);
            is_seen.select(S::u32s::splat(simd, number), previous).store_slice(&mut shown[pixels]);
            first += lanes;
        }
    }
}

/// Returns true if all rays of the tile hit the face.
#[inline(always)]
fn fills_tile<const FLAT: bool>(face: &Face, window: &Window) -> bool {
    let is_inside = |edge: DVec3| {
        let (middle, deviation) = window.middle_and_deviation::<FLAT>(edge);
        middle - deviation > window.slack::<FLAT>(edge)
    };
    is_inside(face.edges[0]) & is_inside(face.edges[1]) & is_inside(face.edges[2])
}
