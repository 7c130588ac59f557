//! Rays of a tile's pixels, for each lens.

use fearless_simd::Simd;
use std::f64::consts::PI;

use fearless_simd::prelude::*;
use glam::{DVec2, DVec3};

use super::optics::TILE;
use super::{Lens, View};

/// Number of pixels of a tile.
pub const PIXELS: usize = (TILE * TILE) as usize;

/// Cache of a fisheye's rays and of the cone around the rays of each tile, valid for one lens and size.
#[derive(Clone, Debug, Default)]
pub struct RayTable {
    made_for: Option<(Lens, [u32; 2])>,
    /// Ray components by axis, row by row, with a border of one ray around the pixels of the tiles.
    axes: [Vec<f32>; 3],
    /// For each ray, true if it is in the image; other rays only serve to compute differences between pixels.
    is_shown: Vec<bool>,
    stride: usize,
    cones: Vec<Cone>,
}

/// Bounding sphere of the rays of a tile, taken as points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cone {
    pub middle: DVec3,
    pub radius: f64,
}

impl RayTable {
    /// Fills the table for `view`; no-op if it is valid, and for a pinhole.
    pub fn prepare(&mut self, view: &View, tiles: [u32; 2]) {
        let made_for = Some((view.lens(), view.size()));
        if self.made_for == made_for || matches!(view.lens(), Lens::Pinhole { .. }) {
            return;
        }
        self.made_for = made_for;
        let [columns, rows] = tiles.map(|tiles| (tiles * TILE + 2) as usize);
        self.stride = columns;
        for axis in &mut self.axes {
            axis.clear();
        }
        self.is_shown.clear();
        for row in 0..rows {
            for column in 0..columns {
                let (angle, ray) = view.continued_ray(DVec2::new(column as f64 - 0.5, row as f64 - 0.5));
                self.is_shown.push(angle <= PI);
                for (axis, part) in self.axes.iter_mut().zip(ray.to_array()) {
                    axis.push(part as f32);
                }
            }
        }
        self.cones.clear();
        for down in 0..tiles[1] {
            for tile_column in 0..tiles[0] {
                self.cones.push(self.cone(tile_column, down));
            }
        }
    }

    fn cone(&self, column: u32, down: u32) -> Cone {
        let pixels = (0..TILE * TILE).map(|pixel| self.ray([column * TILE + pixel % TILE, down * TILE + pixel / TILE]));
        let middle = pixels.clone().sum::<DVec3>() / f64::from(TILE * TILE);
        let radius = pixels.map(|ray| ray.distance(middle)).fold(0.0, f64::max);
        Cone { middle, radius: radius + 1e-6 }
    }

    fn index_of(&self, [column, row]: [u32; 2]) -> usize {
        (row as usize + 1) * self.stride + column as usize + 1
    }

    /// The ray of a pixel; 0 outside the lens's image.
    pub fn ray(&self, pixel: [u32; 2]) -> DVec3 {
        let index = self.index_of(pixel);
        if !self.is_shown[index] {
            return DVec3::ZERO;
        }
        let [x, y, z] = &self.axes;
        DVec3::new(f64::from(x[index]), f64::from(y[index]), f64::from(z[index]))
    }

    /// The cone of tile `tile`.
    pub fn cone_of(&self, tile: usize) -> Cone {
        self.cones[tile]
    }
}

/// The rays of a tile's pixels in lens space, row by row.
///
/// For a pinhole (`FLAT`), x and y are pixels relative to the tile's middle, at which linear forms are evaluated in
/// `f64` (see [`Window::local`]).
#[derive(Clone, Debug)]
pub struct Rays {
    axes: [[f32; PIXELS]; 3],
    /// Differences to the next column and the next row; only for a fisheye.
    steps: [[[f32; PIXELS]; 3]; 2],
}

/// Middle and extent of a tile's rays, for linear forms.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// For a pinhole, the middle of the tile in lens space; otherwise the middle of its rays.
    middle: DVec3,
    /// Maximum distance of a ray from the middle; for a pinhole, on each axis.
    radius: f64,
}

impl Window {
    pub fn flat(tile: [u32; 2]) -> Self {
        let [x, y] = tile.map(|index| f64::from(index * TILE) + 0.5 * f64::from(TILE));
        Self { middle: DVec3::new(x, y, 1.0), radius: 0.5 * f64::from(TILE - 1) }
    }

    pub fn curved(cone: Cone) -> Self {
        Self { middle: cone.middle, radius: cone.radius }
    }

    /// Value of a linear form at the middle, and the bound of its deviation at other rays of the tile.
    #[inline(always)]
    pub fn range<const FLAT: bool>(&self, form: DVec3) -> (f64, f64) {
        let middle = form.dot(self.middle);
        let size = if FLAT { form.x.abs() + form.y.abs() } else { form.length() };
        (middle, size * self.radius)
    }

    /// Tolerance below 0 for an edge of a face that a ray hits: 1e-4 pixels, or 2e-6 rad for a fisheye. The tolerance
    /// exceeds the rounding of `f32`, so that nothing shows through between faces that share an edge or a corner.
    #[inline(always)]
    pub fn slack<const FLAT: bool>(&self, edge: DVec3) -> f64 {
        if FLAT { 1e-4 * (edge.x.abs() + edge.y.abs()) } else { 2e-6 * edge.length() }
    }

    /// A linear form in the tile's coordinates, for [`Rays::value`].
    #[inline(always)]
    pub fn local<const FLAT: bool>(&self, form: DVec3) -> [f32; 3] {
        let last = if FLAT { form.dot(self.middle) } else { form.z };
        [form.x as f32, form.y as f32, last as f32]
    }
}

impl Rays {
    /// Rays of any tile of a pinhole.
    pub fn flat() -> Self {
        let from_middle = |index: usize| index as f32 - 0.5 * (TILE - 1) as f32;
        let side = TILE as usize;
        let x = std::array::from_fn(|pixel| from_middle(pixel % side));
        let y = std::array::from_fn(|pixel| from_middle(pixel / side));
        Self { axes: [x, y, [1.0; PIXELS]], steps: [[[0.0; PIXELS]; 3]; 2] }
    }

    /// Loads the rays of a fisheye's tile.
    pub fn curve(&mut self, table: &RayTable, tile: [u32; 2]) {
        let start = table.index_of(tile.map(|index| index * TILE));
        let side = TILE as usize;
        for row in 0..side {
            let (at, to) = (start + row * table.stride, row * side..(row + 1) * side);
            let is_shown = &table.is_shown[at..at + side];
            for (axis, of_axis) in table.axes.iter().enumerate() {
                let from = |index: usize| &of_axis[index..index + side];
                let here = self.axes[axis][to.clone()].iter_mut().zip(from(at)).zip(is_shown);
                here.for_each(|((ray, part), is_shown)| *ray = if *is_shown { *part } else { 0.0 });
                let pairs = [(at + 1, at - 1), (at + table.stride, at - table.stride)];
                for (step, (behind, before)) in self.steps.iter_mut().zip(pairs) {
                    let changes = step[axis][to.clone()].iter_mut().zip(from(behind)).zip(from(before));
                    changes.for_each(|((change, behind), before)| *change = 0.5 * (behind - before));
                }
            }
        }
    }

    /// Values of a [local](Window::local) form on one vector of rays, from `first` on.
    #[inline(always)]
    pub fn value<S: Simd, const FLAT: bool>(&self, simd: S, [x, y, z]: [f32; 3], first: usize) -> S::f32s {
        let at = first..first + S::f32s::LEN;
        let across = S::f32s::from_slice(simd, &self.axes[0][at.clone()]) * x;
        let down = S::f32s::from_slice(simd, &self.axes[1][at.clone()]) * y;
        if FLAT { (across + z) + down } else { (across + down) + S::f32s::from_slice(simd, &self.axes[2][at]) * z }
    }

    /// Changes of the values to the next column (`axis` 0) or the next row (1).
    #[inline(always)]
    pub fn step<S: Simd, const FLAT: bool>(&self, simd: S, form: [f32; 3], first: usize, axis: usize) -> S::f32s {
        if FLAT {
            return S::f32s::splat(simd, form[axis]);
        }
        let at = first..first + S::f32s::LEN;
        let [x, y, z] = &self.steps[axis];
        (S::f32s::from_slice(simd, &x[at.clone()]) * form[0] + S::f32s::from_slice(simd, &y[at.clone()]) * form[1])
            + S::f32s::from_slice(simd, &z[at]) * form[2]
    }
}
