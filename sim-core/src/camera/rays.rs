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
    valid_for: Option<(Lens, [u32; 2])>,
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
    /// Fills the table for `view`; does nothing if the table is valid, or if the lens is a pinhole.
    pub fn prepare(&mut self, view: &View, tiles: [u32; 2]) {
        let valid_for = Some((view.lens(), view.size()));
        if self.valid_for == valid_for || matches!(view.lens(), Lens::Pinhole { .. }) {
            return;
        }
        self.valid_for = valid_for;
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
                for (axis, component) in self.axes.iter_mut().zip(ray.to_array()) {
                    axis.push(component as f32);
                }
            }
        }
        self.cones.clear();
        for row in 0..tiles[1] {
            for column in 0..tiles[0] {
                self.cones.push(self.compute_cone(column, row));
            }
        }
    }

    fn compute_cone(&self, column: u32, row: u32) -> Cone {
        let pixels = (0..TILE * TILE).map(|pixel| self.ray([column * TILE + pixel % TILE, row * TILE + pixel / TILE]));
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
    pub fn cone(&self, tile: usize) -> Cone {
        self.cones[tile]
    }
}

/// The rays of a tile's pixels in lens space, row by row.
///
/// For a pinhole (`FLAT`), x and y are pixels relative to the tile's centre, at which linear forms are evaluated in
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
    /// For a pinhole, the centre of the tile in lens space; otherwise the centre of the cone of its rays.
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

    /// Value of a linear form at the middle, and the bound of its deviation from that value at other rays of the tile.
    #[inline(always)]
    pub fn middle_and_deviation<const FLAT: bool>(&self, form: DVec3) -> (f64, f64) {
        let middle = form.dot(self.middle);
        let size = if FLAT { form.x.abs() + form.y.abs() } else { form.length() };
        (middle, size * self.radius)
    }

    /// Tolerance of the test of a ray against an edge: 1e-4 pixels, or 2e-6 rad for a fisheye. The ray hits the face if
    /// its dot products with the edges are at least the negative of this value. The tolerance exceeds the rounding of
    /// `f32`, so that nothing shows through between faces that share an edge or a corner.
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

    /// Loads the rays of a tile of a fisheye.
    pub fn load_curved(&mut self, table: &RayTable, tile: [u32; 2]) {
        let start = table.index_of(tile.map(|index| index * TILE));
        let side = TILE as usize;
        for row in 0..side {
            let (source, target) = (start + row * table.stride, row * side..(row + 1) * side);
            let is_shown = &table.is_shown[source..source + side];
            for (axis, components) in table.axes.iter().enumerate() {
                let row_from = |index: usize| &components[index..index + side];
                let rays = self.axes[axis][target.clone()].iter_mut().zip(row_from(source)).zip(is_shown);
                rays.for_each(|((ray, component), is_shown)| *ray = if *is_shown { *component } else { 0.0 });
                let neighbours = [(source + 1, source - 1), (source + table.stride, source - table.stride)];
                for (step, (next, previous)) in self.steps.iter_mut().zip(neighbours) {
                    let steps = step[axis][target.clone()].iter_mut().zip(row_from(next)).zip(row_from(previous));
                    steps.for_each(|((step, next), previous)| *step = 0.5 * (next - previous));
                }
            }
        }
    }

    /// Values of a [local](Window::local) form at one vector of rays, which begins at pixel `first`.
    #[inline(always)]
    pub fn value<S: Simd, const FLAT: bool>(&self, simd: S, [x, y, z]: [f32; 3], first: usize) -> S::f32s {
        let pixels = first..first + S::f32s::LEN;
        let x_term = S::f32s::from_slice(simd, &self.axes[0][pixels.clone()]) * x;
        let y_term = S::f32s::from_slice(simd, &self.axes[1][pixels.clone()]) * y;
        if FLAT {
            (x_term + z) + y_term
        } else {
            (x_term + y_term) + S::f32s::from_slice(simd, &self.axes[2][pixels]) * z
        }
    }

    /// Differences between the values at the next column (`axis` 0) or the next row (1) and the [values](Self::value).
    #[inline(always)]
    pub fn step<S: Simd, const FLAT: bool>(&self, simd: S, form: [f32; 3], first: usize, axis: usize) -> S::f32s {
        if FLAT {
            return S::f32s::splat(simd, form[axis]);
        }
        let pixels = first..first + S::f32s::LEN;
        let [x, y, z] = &self.steps[axis];
        (S::f32s::from_slice(simd, &x[pixels.clone()]) * form[0]
            + S::f32s::from_slice(simd, &y[pixels.clone()]) * form[1])
            + S::f32s::from_slice(simd, &z[pixels]) * form[2]
    }
}
