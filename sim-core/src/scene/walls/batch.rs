//! Conservative culling along a ray: the walls of a cell are tested in `f32`, four at a time.
//!
//! Culling uses margins wider than all rounding; the exact test in `ray`, in `f64`, decides which walls are hit.

use std::ops::RangeInclusive;

use glam::{DVec2, Vec4};

use super::super::{
    Segment,
    grid::{Cells, Grid},
};
use super::WallId;

/// Number of walls in a batch.
const WIDTH: usize = 4;

/// The walls of each cell of a grid.
///
/// Positions are in cells, relative to a point half a cell outside the grid's lower left corner. A position rounded to
/// whole numbers is then the column and row of a cell, counted from 1. A ring of sentinel cells around the grid ends every
/// walk.
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
    /// Bound of the `f32` error. Together with the [margin](super::Walls) of the walls, it covers 16 units in the last
    /// place of the largest coordinate. On each axis, the coordinate of a wall's end, the ray's direction and the product of
    /// both contribute 1 unit each; the sum over the axes and the ray's own position add 1 unit each. For a grid of 3 by 3
    /// cells, ring included, 5 units remain for the margin.
    slack: f32,
}

/// Up to four walls of a cell, coordinate by coordinate; unused lanes are NaN and compare as false.
#[derive(Clone, Debug)]
struct WallBatch {
    ax: Vec4,
    ay: Vec4,
    bx: Vec4,
    by: Vec4,
    walls: [u32; WIDTH],
    /// Index of the cell's next batch, or [`OUTSIDE`].
    next: u32,
}

/// Index of the sentinel batch of the ring, which ends walks and lists.
const OUTSIDE: u32 = 0;

/// Index of the shared batch of all cells without walls.
const EMPTY_CELL: u32 = 1;

const NO_WALL: u32 = u32::MAX;

const EMPTY: WallBatch =
    WallBatch { ax: Vec4::NAN, ay: Vec4::NAN, bx: Vec4::NAN, by: Vec4::NAN, walls: [NO_WALL; WIDTH], next: OUTSIDE };

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
        let slack = (columns + rows) as f32 / (1 << 20) as f32;
        Self { corner, cells_per_metre, columns, rows, first, batches, slack }
    }

    /// Calls `test` with each wall that the ray from `start` along `direction` may hit, approximately in order of
    /// distance and possibly several times. `test` returns the distance up to which the walk must continue.
    ///
    /// `start` lies within the grid, or outside it by no more than rounding. Distances are measured from a point `passed`
    /// metres before `start`; the walk begins with the limit `farthest`.
    #[inline(always)]
    pub fn walk(
        &self,
        start: DVec2,
        direction: DVec2,
        passed: f64,
        farthest: f64,
        mut test: impl FnMut(WallId) -> f64,
    ) {
        let position = (start - self.corner) * self.cells_per_metre;
        let biased = position + DVec2::splat(ROUNDING_BIAS);
        let [column, row] = [biased.x, biased.y].map(|whole| whole.to_bits().wrapping_sub(ROUNDING_BIAS.to_bits()));
        if column >= self.columns as u64 || row >= self.rows as u64 {
            return;
        }
        let mut cell = row as usize * self.columns + column as usize;
        // Distances to the next borders; a cell extends half a cell to either side of its middle.
        let from_middle = position - (biased - DVec2::splat(ROUNDING_BIAS));
        // Distance along the ray between successive borders on each axis.
        let spacing = DVec2::ONE / direction.abs();
        let ahead = DVec2::new(along(from_middle.x, direction.x), along(from_middle.y, direction.y));
        let mut exits = (DVec2::splat(0.5) - ahead + DVec2::splat(TINY)) * spacing;
        let (by_column, by_row) = (step(1, direction.x), step(self.columns, direction.y));

        let probe = Probe::new(direction, position, self.slack);
        let cells_to = |distance: f64| (distance - passed) * self.cells_per_metre;
        let mut limit = cells_to(farthest);
        let mut end = probe.end(limit);
        loop {
            let Some(&first) = self.first.get(cell) else { return };
            if first == OUTSIDE {
                return;
            }
            let mut next = first;
            loop {
                let batch = &self.batches[next as usize];
                let mut hit_lanes = probe.may_hit(batch, end);
                if hit_lanes != 0 {
                    while hit_lanes != 0 {
                        let wall = batch.walls[hit_lanes.trailing_zeros() as usize % WIDTH];
                        limit = cells_to(test(WallId(wall)));
                        hit_lanes &= hit_lanes - 1;
                    }
                    end = probe.end(limit);
                }
                next = batch.next;
                if next == OUTSIDE {
                    break;
                }
            }
            // Not `min`, which needs extra code for NaN.
            let exit = if exits.x < exits.y { exits.x } else { exits.y };
            if limit <= exit {
                return;
            }
            // Bit masks replace an unpredictable branch: either border may come first.
            let is_column = u64::from(exits.x < exits.y).wrapping_neg();
            cell = cell.wrapping_add((by_column as u64 & is_column | by_row as u64 & !is_column) as usize);
            exits.x += f64::from_bits(spacing.x.to_bits() & is_column);
            exits.y += f64::from_bits(spacing.y.to_bits() & !is_column);
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

/// Distance from the cell's middle on an axis, positive in the direction of the ray (the sign of `direction`).
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
struct Probe {
    x: Vec4,
    y: Vec4,
    /// Minimum and maximum signed offset, positive to the left of the ray, of a point that may lie on the ray's line.
    right: Vec4,
    left: Vec4,
    /// Coordinate of the ray's start along its line.
    start: f64,
    /// `start` minus the slack.
    behind: Vec4,
    slack: f32,
}

impl Probe {
    #[inline(always)]
    fn new(direction: DVec2, position: DVec2, slack: f32) -> Self {
        let (side, start) = (direction.perp_dot(position) as f32, direction.dot(position));
        Self {
            x: Vec4::splat(direction.x as f32),
            y: Vec4::splat(direction.y as f32),
            right: Vec4::splat(side - slack),
            left: Vec4::splat(side + slack),
            start,
            behind: Vec4::splat(start as f32 - slack),
            slack,
        }
    }

    /// Coordinate along the ray's line beyond which hits are ignored.
    #[inline(always)]
    fn end(&self, limit: f64) -> Vec4 {
        Vec4::splat((self.start + limit) as f32 + self.slack)
    }

    /// Bit mask of the walls whose ends lie on both sides of the ray, or on it, and that are neither behind its start
    /// nor beyond its end.
    #[inline(always)]
    fn may_hit(&self, batch: &WallBatch, end: Vec4) -> u32 {
        let Self { x, y, .. } = *self;
        let (a_side, b_side) = (x * batch.ay - y * batch.ax, x * batch.by - y * batch.bx);
        let (a_ahead, b_ahead) = (x * batch.ax + y * batch.ay, x * batch.bx + y * batch.by);
        let crosses = a_side.min(b_side).cmple(self.left) & a_side.max(b_side).cmpge(self.right);
        let is_ahead = a_ahead.max(b_ahead).cmpge(self.behind) & a_ahead.min(b_ahead).cmple(end);
        (crosses & is_ahead).bitmask()
    }
}
