//! Conservative culling along a ray: the walls of a cell are tested in `f32`, eight at a time.
//!
//! Culling uses margins wider than all rounding; the exact test in `ray`, in `f64`, decides which walls are hit.

use std::ops::RangeInclusive;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, f64x2};
use glam::DVec2;

use super::super::{
    Segment,
    grid::{Cells, Grid},
};
use super::WallId;
use super::ray::{Nearest, Ray};

/// Number of walls in a batch.
const WIDTH: usize = 8;

/// The walls of each cell of a grid.
///
/// Positions are in cells, relative to a point half a cell outside the grid's lower left corner. A position rounded to
/// whole numbers is then the column and row of a cell, counted from 1. A ring of sentinel cells around the grid ends
/// every walk.
#[derive(Clone, Debug)]
pub(super) struct WallBatches {
    /// Origin of the positions.
    corner: DVec2,
    cells_per_metre: f64,
    columns: usize,
    rows: usize,
    /// Index of the first batch of each cell, sentinel ring included.
    first: Vec<u32>,
    batches: Vec<WallBatch>,
    /// Bound of the `f32` error. Together with the [margin](super::Walls) of the walls, it covers at least 16 units in
    /// the last place of the largest coordinate (32 units in a square grid). On each axis, the coordinate of a wall's
    /// end, the ray's direction and the product of both contribute 1 unit each; the sums over the axes and with the
    /// ray's own position add 4, and the comparison of two such numbers 6.
    slack: f32,
}

/// Up to eight walls of a cell, coordinate by coordinate; unused lanes are NaN and compare as false.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct WallBatch {
    ax: [f32; WIDTH],
    ay: [f32; WIDTH],
    bx: [f32; WIDTH],
    by: [f32; WIDTH],
    walls: [u32; WIDTH],
    /// Index of the cell's next batch, or [`OUTSIDE`].
    next: u32,
}

/// Index of the sentinel batch of the ring, which ends walks and lists.
const OUTSIDE: u32 = 0;

/// Index of the shared batch of all cells without walls.
const EMPTY_CELL: u32 = 1;

const NO_WALL: u32 = u32::MAX;

const EMPTY: WallBatch = WallBatch {
    ax: [f32::NAN; WIDTH],
    ay: [f32::NAN; WIDTH],
    bx: [f32::NAN; WIDTH],
    by: [f32::NAN; WIDTH],
    walls: [NO_WALL; WIDTH],
    next: OUTSIDE,
};

/// Rounding constant: adding it to a position in cells puts the nearest whole number into the lowest bits.
const ROUNDING_BIAS: f64 = (1_u64 << 52) as f64;

/// Keeps 0 times infinity from becoming NaN; too small to change any result.
const TINY: f64 = 1e-300;

impl WallBatches {
    /// The batches of the walls that `cells` lists for each cell of `grid`.
    pub fn new(grid: &Grid, cells: &Cells<u32>, segments: &[Segment]) -> Self {
        let cells_per_metre = 1.0 / grid.cell();
        let corner = grid.bounds().min - DVec2::splat(0.5 * grid.cell());
        let (columns, rows) = (grid.columns() + 2, grid.rows() + 2);
        let mut first = vec![OUTSIDE; columns * rows];
        let mut batches = vec![EMPTY; 2];
        for row in 0..grid.rows() {
            for column in 0..grid.columns() {
                let entry = &mut first[(row + 1) * columns + column + 1];
                let walls = cells.entries(grid.index(column, row));
                *entry = if walls.is_empty() { EMPTY_CELL } else { batches.len() as u32 };
                batches
                    .extend(walls.chunks(WIDTH).map(|chunk| WallBatch::new(chunk, segments, corner, cells_per_metre)));
                let count = walls.len().div_ceil(WIDTH);
                let start = batches.len() - count;
                for (next, batch) in (start + 1..).zip(&mut batches[start..]).take(count.saturating_sub(1)) {
                    batch.next = next as u32;
                }
            }
        }
        let slack = (columns + rows) as f32 / (1 << 19) as f32;
        Self { corner, cells_per_metre, columns, rows, first, batches, slack }
    }

    /// Offers to `nearest` each wall that `ray` may hit, approximately in order of distance, until no nearer one can
    /// follow.
    ///
    /// `start`, the point `passed` metres along the ray, lies within the grid, or outside it by no more than rounding.
    #[expect(clippy::too_many_arguments, reason = "called once")]
    #[inline(always)]
    pub fn walk<S: Simd>(
        &self,
        simd: S,
        segments: &[Segment],
        ray: &Ray,
        start: DVec2,
        passed: f64,
        mut nearest: Nearest,
        accepts: &impl Fn(WallId, f64) -> bool,
    ) -> Nearest {
        let direction = ray.direction;
        let position = (start - self.corner) * self.cells_per_metre;
        let biased = position + DVec2::splat(ROUNDING_BIAS);
        let [column, row] = [biased.x, biased.y].map(|whole| whole.to_bits().wrapping_sub(ROUNDING_BIAS.to_bits()));
        if column >= self.columns as u64 || row >= self.rows as u64 {
            return nearest;
        }
        let mut cell = row as usize * self.columns + column as usize;
        // Distances to the next borders; a cell extends half a cell to either side of its centre.
        let from_middle = position - (biased - DVec2::splat(ROUNDING_BIAS));
        // Distance along the ray between successive borders on each axis.
        let spacing = DVec2::ONE / direction.abs();
        let ahead = DVec2::new(along(from_middle.x, direction.x), along(from_middle.y, direction.y));
        let exits = (DVec2::splat(0.5) - ahead + DVec2::splat(TINY)) * spacing;
        let (mut exits, spacing) =
            (f64x2::simd_from(simd, exits.to_array()), f64x2::simd_from(simd, spacing.to_array()));
        let zero = f64x2::splat(simd, 0.0);
        // A ray through a corner of cells continues in the opposite cell: the walls at the corner are in all four.
        let (by_column, by_row) = (step(1, direction.x), step(self.columns, direction.y));
        let strides = [0, by_column, by_row, by_column.wrapping_add(by_row)];

        let probe = Probe::new(simd, direction, position, self.slack);
        let mut limit = (nearest.distance - passed) * self.cells_per_metre;
        loop {
            let Some(&first) = self.first.get(cell) else { return nearest };
            if first == OUTSIDE {
                return nearest;
            }
            let [column_exit, row_exit]: [f64; 2] = exits.into();
            // Not `min`, which needs extra code for NaN.
            let exit = if column_exit < row_exit { column_exit } else { row_exit };
            // A wall that the ray hits behind this cell is found in a later one.
            let reach = probe.reach(simd, if limit < exit { limit } else { exit });
            let mut next = first;
            loop {
                let batch = &self.batches[next as usize];
                let hit_lanes = probe.may_hit(simd, batch, &reach);
                if hit_lanes != 0 {
                    offer(segments, ray, batch, hit_lanes, &mut nearest, accepts);
                    limit = (nearest.distance - passed) * self.cells_per_metre;
                }
                next = batch.next;
                if next == OUTSIDE {
                    break;
                }
            }
            if limit <= exit {
                return nearest;
            }
            // Vectors replace an unpredictable branch: either border may come first.
            let is_next = exits.simd_le(f64x2::simd_from(simd, [row_exit, column_exit]));
            cell = cell.wrapping_add(strides[is_next.to_bitmask() as usize & 3]);
            exits += is_next.select(spacing, zero);
        }
    }

    /// Appends the walls in these columns and rows of the grid to `walls`, possibly with duplicates.
    pub fn collect(&self, (columns, rows): (RangeInclusive<usize>, RangeInclusive<usize>), walls: &mut Vec<WallId>) {
        for row in rows {
            for column in columns.clone() {
                let mut next = self.first[(row + 1) * self.columns + column + 1];
                while next != OUTSIDE {
                    let batch = &self.batches[next as usize];
                    walls.extend(batch.walls.iter().filter(|&&wall| wall != NO_WALL).map(|&wall| WallId(wall)));
                    next = batch.next;
                }
            }
        }
    }
}

/// Offers the walls of a batch in the lanes of `hit_lanes` to `nearest`.
// Not inlined, because the walk needs the registers.
#[cold]
#[inline(never)]
fn offer(
    segments: &[Segment],
    ray: &Ray,
    batch: &WallBatch,
    mut hit_lanes: u32,
    nearest: &mut Nearest,
    accepts: &impl Fn(WallId, f64) -> bool,
) {
    let mut found = *nearest;
    while hit_lanes != 0 {
        let wall = batch.walls[hit_lanes.trailing_zeros() as usize % WIDTH];
        found.offer(WallId(wall), ray.distance(&segments[wall as usize]), accepts);
        hit_lanes &= hit_lanes - 1;
    }
    *nearest = found;
}

/// Distance from the cell's centre on an axis, positive in the direction of the ray (the sign of `direction`).
#[inline(always)]
fn along(from_middle: f64, direction: f64) -> f64 {
    f64::from_bits(from_middle.to_bits() ^ direction.to_bits() & (1 << 63))
}

/// Difference (wrapping) between the index of the next cell in the ray's direction and the index of the current cell.
#[inline(always)]
fn step(stride: usize, direction: f64) -> usize {
    if direction.is_sign_negative() { stride.wrapping_neg() } else { stride }
}

impl WallBatch {
    fn new(walls: &[u32], segments: &[Segment], corner: DVec2, cells_per_metre: f64) -> Self {
        let mut batch = EMPTY;
        for (index, &wall) in walls.iter().enumerate() {
            let [a, b] =
                [segments[wall as usize].a, segments[wall as usize].b].map(|end| (end - corner) * cells_per_metre);
            (batch.ax[index], batch.ay[index]) = (a.x as f32, a.y as f32);
            (batch.bx[index], batch.by[index]) = (b.x as f32, b.y as f32);
            batch.walls[index] = wall;
        }
        batch
    }
}

/// A ray in units of cells.
struct Probe<S: Simd> {
    x: f32x8<S>,
    y: f32x8<S>,
    /// Coordinate of the ray's line to its left.
    side: f32x8<S>,
    /// Coordinate of the ray's start along its line, negated.
    behind: f32,
    slack: f32,
}

/// A part of a ray that begins at its start.
struct Reach<S: Simd> {
    /// Coordinate of its middle along the ray's line, negated.
    behind: f32x8<S>,
    /// Half of its length, and the slack.
    half: f32x8<S>,
}

impl<S: Simd> Probe<S> {
    #[inline(always)]
    fn new(simd: S, direction: DVec2, position: DVec2, slack: f32) -> Self {
        let (side, start) = (direction.perp_dot(position) as f32, direction.dot(position));
        Self {
            x: f32x8::splat(simd, direction.x as f32),
            y: f32x8::splat(simd, direction.y as f32),
            side: f32x8::splat(simd, side),
            behind: -start as f32,
            slack,
        }
    }

    /// The first `length` cells of the ray.
    #[inline(always)]
    fn reach(&self, simd: S, length: f64) -> Reach<S> {
        let half = (0.5 * length) as f32;
        Reach { behind: f32x8::splat(simd, self.behind - half), half: f32x8::splat(simd, half + 2.0 * self.slack) }
    }

    /// Bit mask of the walls whose ends lie on both sides of the ray, or on it, and that cross it within `reach`.
    #[inline(always)]
    fn may_hit(&self, simd: S, batch: &WallBatch, reach: &Reach<S>) -> u32 {
        let Self { x, y, side, slack, .. } = *self;
        let (ax, ay) = (f32x8::simd_from(simd, batch.ax), f32x8::simd_from(simd, batch.ay));
        let (bx, by) = (f32x8::simd_from(simd, batch.bx), f32x8::simd_from(simd, batch.by));
        let a_side = x.mul_sub(ay, y.mul_add(ax, side));
        let b_side = x.mul_sub(by, y.mul_add(bx, side));
        let a_ahead = x.mul_add(ax, y.mul_add(ay, reach.behind));
        let b_ahead = x.mul_add(bx, y.mul_add(by, reach.behind));
        let (across, along) = (a_side - b_side, (a_ahead - b_ahead));
        let width = across.abs();
        // Two numbers have different signs if the absolute value of their sum is less than that of their difference.
        let crosses = (a_side + b_side).abs().simd_le(width + f32x8::splat(simd, 2.0 * slack));
        // The crossing is at `a_ahead - along * a_side / across`; both sides of the comparison are multiplied by
        // `width`. Errors of the sides by up to `slack` shift it by up to 6 `slack * along / width` if `width` exceeds
        // 3 `slack`. Otherwise the wall is excluded only if both ends lie outside the reach.
        let offset = a_ahead.mul_sub(across, along * a_side).abs();
        let is_within = offset.simd_le(reach.half.mul_add(width, f32x8::splat(simd, 8.0 * slack) * along.abs()));
        (crosses & is_within).to_bitmask() as u32
    }
}
