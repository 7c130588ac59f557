//! Three-dimensional occupancy grid after Moravec and Elfes, with separate certainties for empty and for occupied.
//!
//! Source: Moravec and Elfes 1985, *High resolution maps from wide angle sonar*, with a third dimension (Gois and
//! Hiller, sections 3 and 4). Across the beam, certainties are weighted by the gain of [`SonarModel`].

use std::f64::consts::LN_2;
use std::ops::Range;

use crate::inverse::{SonarModel, SonarPose};
use crate::math;
use crate::tsk::{CellIndex, Partition};

/// The grid: boxes stacked over the cells of a partition.
#[derive(Clone, Debug)]
pub struct OccupancyGrid {
    partition: Partition,
    /// Height of a box, m.
    step: f64,
    /// The lowest face of the lowest box, m.
    bottom: f64,
    layers: usize,
    /// Certainty that a box is empty: cell by cell in the order of the partition's slots, in each from the bottom up.
    empty: Vec<f32>,
    occupied: Vec<f32>,
}

impl OccupancyGrid {
    /// A grid without readings: `layers` boxes of `step` m above each cell, from the height `bottom` m upwards.
    pub fn new(partition: Partition, bottom: f64, step: f64, layers: usize) -> Self {
        let count = partition.columns * partition.rows * layers;
        Self { partition, step, bottom, layers, empty: vec![0.0; count], occupied: vec![0.0; count] }
    }

    /// The cells.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Fuses a reading: boxes within the beam and nearer than the reading become emptier, those at its distance more occupied. A box
    /// is at the distance if any of its points is, seen along the ray through its middle, so that coarse boxes smear a reading no farther
    /// than they are large. The more boxes there are at that distance, and the more certainly a box is empty, the less its
    /// certainty of being occupied rises.
    pub fn fuse(&mut self, model: &SonarModel, sonar: &SonarPose, measured: f64) {
        let reach = model.epsilon * measured;
        let widest = reach + 0.5 * (self.step + 2.0 * self.partition.cell);
        let max_distance = measured + widest;
        let beam = BeamParameters {
            along_z: sonar.axis.z as f32,
            min_cosine: math::cos(model.aperture()) as f32,
            steepness: (2.0 * LN_2 / (model.half_angle * model.half_angle)) as f32,
            measured: measured as f32,
            reach: reach as f32,
            step: self.step as f32,
        };
        let [east, north] = model.extents(sonar).map(|range| range.map(|fraction| fraction * max_distance));
        let mut hits = Vec::new();
        for index in self.partition.cells_within(sonar.origin.x, sonar.origin.y, east, north) {
            let Some(slot) = self.partition.slot(index) else { continue };
            let (x, y) = self.partition.centre(index);
            let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
            let level = dx * dx + dy * dy;
            let along = dx * sonar.axis.x + dy * sonar.axis.y;
            let Some(section) = section(along, level, sonar.axis.z, model.aperture()) else { continue };
            let column = Column {
                level: level as f32,
                along: along as f32,
                spread: ((dx.abs() + dy.abs()) * self.partition.cell) as f32,
                first: (self.middle(0) - sonar.origin.z) as f32,
            };
            let base = slot * self.layers;
            let emptied = self.layers_between(sonar.origin.z, section, shell(measured, level));
            for (layer, empty) in emptied.clone().zip(&mut self.empty[base..][emptied]) {
                let gain = beam.empties(&column, layer as u32);
                *empty += gain - *empty * gain;
            }
            let (outer, inner) = (shell(max_distance, level), shell((measured - widest).max(0.0), level));
            let (low, high) = (-inner.1, inner.1);
            // Two caps of the shell, one layer of overlap apart or joined to one where the inner sphere does not reach.
            let lower = self.layers_between(sonar.origin.z, section, (outer.0, low));
            let upper = self.layers_between(sonar.origin.z, section, (high, outer.1));
            let upper = upper.start.max(lower.end)..upper.end;
            for layer in lower.chain(upper) {
                let gain = beam.hits(&column, layer as u32);
                if gain > 0.0 {
                    hits.push((base + layer, gain));
                }
            }
        }
        self.occupy(&mut hits);
    }

    /// Layers whose middles may lie in both ranges of heights above `origin`, m, with one more at each end against rounding.
    fn layers_between(&self, origin: f64, first: (f64, f64), second: (f64, f64)) -> Range<usize> {
        let layer = |dz: f64| ((origin + dz - self.bottom) / self.step - 0.5).clamp(-2.0, self.layers as f64 + 2.0);
        let (low, high) = (first.0.max(second.0), first.1.min(second.1));
        if low > high {
            return 0..0;
        }
        let from = (layer(low).floor() - 1.0).max(0.0) as usize;
        let to = (layer(high).ceil() + 2.0).clamp(0.0, self.layers as f64) as usize;
        from.min(to)..to
    }

    /// The upper face of the highest occupied box at (x, y), m: the paper's projection onto the plane. `None` where no
    /// box is occupied, or outside.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let layer = (0..self.layers).rev().find(|layer| self.is_occupied(slot, *layer))?;
        Some(self.middle(layer) + self.step / 2.0)
    }

    /// The middle of the box at (x, y) that is most certainly occupied, m: another projection than the paper's. `None` where none
    /// is occupied, or outside.
    pub fn likeliest_height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let certainty = |layer: &usize| {
            let index = slot * self.layers + layer;
            f64::from(self.occupied[index]) - f64::from(self.empty[index])
        };
        (0..self.layers)
            .filter(|layer| self.is_occupied(slot, *layer))
            .max_by(|a, b| certainty(a).total_cmp(&certainty(b)))
            .map(|layer| self.middle(layer))
    }

    /// The mean height at (x, y) of the boxes that are occupied, weighted by how much more certainly they are occupied than empty, m:
    /// another projection than the paper's. `None` where none is occupied, or outside.
    pub fn mean_height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let weighted = (0..self.layers).filter(|layer| self.is_occupied(slot, *layer)).map(|layer| {
            let index = slot * self.layers + layer;
            (f64::from(self.occupied[index]) - f64::from(self.empty[index]), self.middle(layer))
        });
        let (sum, total) = weighted.fold((0.0, 0.0), |(sum, total), (weight, z)| (sum + weight * z, total + weight));
        (total > 0.0).then(|| sum / total)
    }

    /// Certainty (empty, occupied) of the box of a cell with the height `z`; `None` outside.
    pub fn certainty(&self, cell_index: CellIndex, z: f64) -> Option<(f64, f64)> {
        let layer = ((z - self.bottom) / self.step).floor();
        let index = self.partition.slot(cell_index)? * self.layers + layer as usize;
        ((0.0..self.layers as f64).contains(&layer))
            .then(|| (f64::from(self.empty[index]), f64::from(self.occupied[index])))
    }

    /// Raises the certainties for one echo: the boxes of a reading gain no more than 1 in total.
    fn occupy(&mut self, hits: &mut [(usize, f32)]) {
        for (index, gain) in &mut *hits {
            *gain *= 1.0 - self.empty[*index];
        }
        let total: f64 = hits.iter().map(|(_, gain)| f64::from(*gain)).sum();
        if total <= 0.0 {
            return;
        }
        for (index, gain) in &*hits {
            let gain = gain / total as f32;
            self.occupied[*index] += gain - self.occupied[*index] * gain;
        }
    }

    fn middle(&self, layer: usize) -> f64 {
        self.bottom + (layer as f64 + 0.5) * self.step
    }

    fn is_occupied(&self, slot: usize, layer: usize) -> bool {
        let index = slot * self.layers + layer;
        self.occupied[index] > self.empty[index]
    }
}

/// Numbers of a reading, in single precision: a grid of fine boxes has hundreds of millions of them in its beams.
struct BeamParameters {
    /// Component of the line of sight along z.
    along_z: f32,
    /// Cosine of the aperture.
    min_cosine: f32,
    /// Factor k of the gain exp(-k alpha^2).
    steepness: f32,
    measured: f32,
    /// Maximum error of the reading, m.
    reach: f32,
    /// Height of a box, m.
    step: f32,
}

/// A column of boxes as seen from a sonar.
struct Column {
    /// Squared horizontal distance, m^2.
    level: f32,
    /// Horizontal part of the product of the direction and the line of sight, m.
    along: f32,
    /// Horizontal part of the product of the direction and a box's sides, m^2.
    spread: f32,
    /// Height of the middle of the lowest box above the sonar, m.
    first: f32,
}

impl BeamParameters {
    /// Distance of the box in a layer, its gain (0 outside the beam), and half the range of distances that count as in it.
    #[inline]
    fn look(&self, column: &Column, layer: u32) -> (f32, f32, f32) {
        let dz = column.first + layer as f32 * self.step;
        // A box at the sonar itself has some direction.
        let r = (column.level + dz * dz).sqrt().max(1e-6);
        let cosine = (column.along + dz * self.along_z) / r;
        // Half the extent of a box along the ray through its middle: the box is met from r - half to r + half.
        let band = self.reach + 0.5 * (column.spread + dz.abs() * self.step) / r;
        let gain = if cosine < self.min_cosine { 0.0 } else { gaussian(self.steepness, cosine) };
        (r, gain, band)
    }

    /// Share by which a box becomes emptier.
    #[inline]
    fn empties(&self, column: &Column, layer: u32) -> f32 {
        let (r, gain, band) = self.look(column, layer);
        let nearness = r / (self.measured - band);
        if r < self.measured - band { gain * (1.0 - nearness * nearness) } else { 0.0 }
    }

    /// Weight of a box at the distance of the echo.
    fn hits(&self, column: &Column, layer: u32) -> f32 {
        let (r, gain, band) = self.look(column, layer);
        let ratio = (r - self.measured) / band;
        gain * (1.0 - ratio * ratio).max(0.0)
    }
}

/// exp(-`steepness` alpha^2) of the angle with this cosine, at most a right angle; within 1e-4.
///
/// Series of the squared arc cosine about 1, and of the exponential of a 16th, without branches, so that compilers use vectors.
#[inline]
fn gaussian(steepness: f32, cosine: f32) -> f32 {
    let u = (1.0 - cosine).max(0.0);
    let square =
        u * (2.0 + u * (1.0 / 3.0 + u * (4.0 / 45.0 + u * (1.0 / 35.0 + u * (16.0 / 1575.0 + u * (8.0 / 2079.0))))));
    let t = (steepness * square / 16.0).min(1.0);
    let root = 1.0 - t * (1.0 - t * (0.5 - t * (1.0 / 6.0 - t * (1.0 / 24.0 - t * (1.0 / 120.0)))));
    let second = root * root;
    let fourth = second * second;
    let eighth = fourth * fourth;
    eighth * eighth
}

/// Heights above and below its apex at which a vertical line is within a cone: `along` is the horizontal part of the product of direction
/// and axis, `level` the squared horizontal distance. `None` if the line misses it.
fn section(along: f64, level: f64, axis_z: f64, aperture: f64) -> Option<(f64, f64)> {
    let cosine = math::cos(aperture);
    // Within: along + dz axis_z >= 0 and q dz^2 + 2 b dz + d >= 0.
    let (q, b, d) = (axis_z * axis_z - cosine * cosine, along * axis_z, along * along - cosine * cosine * level);
    let square = b * b - q * d;
    if q.abs() < 1e-9 || (square < 0.0 && q > 0.0) {
        return Some((f64::NEG_INFINITY, f64::INFINITY));
    }
    if square < 0.0 {
        return None;
    }
    let root = square.sqrt();
    let (low, high) = ((-b - root) / q, (-b + root) / q);
    let (low, high) = (low.min(high), low.max(high));
    if q > 0.0 {
        return Some(if axis_z < 0.0 { (f64::NEG_INFINITY, low) } else { (high, f64::INFINITY) });
    }
    (along + 0.5 * (low + high) * axis_z >= 0.0).then_some((low, high))
}

/// Heights above and below the middle of a sphere at which a vertical line is within it, 0 and 0 if it misses it.
fn shell(radius: f64, level: f64) -> (f64, f64) {
    let half = (radius * radius - level).max(0.0).sqrt();
    (-half, half)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::Vector3;

    use super::*;

    fn grid() -> OccupancyGrid {
        OccupancyGrid::new(Partition { cell: 0.25, columns: 12, rows: 12, low: (-6, -6) }, 0.0, 0.1, 20)
    }

    fn down() -> SonarPose {
        SonarPose::new(Vector3::new(0.1, 0.1, 2.0), 0.0, -FRAC_PI_2)
    }

    #[test]
    fn a_reading_empties_the_beam_and_occupies_its_end() {
        let mut grid = grid();
        assert_eq!((grid.height(0.1, 0.1), grid.likeliest_height(0.1, 0.1)), (None, None));
        grid.fuse(&SonarModel::srf08(), &down(), 1.45);
        let (empty, occupied) = grid.certainty((0, 0), 1.05).unwrap();
        assert!(empty > 0.3 && occupied == 0.0, "half way: {empty} {occupied}");
        let (empty, occupied) = grid.certainty((0, 0), 0.55).unwrap();
        assert!(empty == 0.0 && occupied > 0.0, "at the echo: {empty} {occupied}");
        assert_eq!(grid.certainty((0, 0), 0.25), Some((0.0, 0.0)), "behind it");
        assert_eq!(grid.certainty((0, 0), 2.05), None, "above the grid");
        let total: f32 = grid.occupied.iter().sum();
        assert!((total - 1.0).abs() < 1e-5, "one reading, one echo: {total}");
    }

    #[test]
    fn what_was_seen_to_be_empty_is_hardly_occupied_later() {
        let (mut first, mut second) = (grid(), grid());
        for _ in 0..5 {
            second.fuse(&SonarModel::srf08(), &down(), 1.95);
        }
        for grid in [&mut first, &mut second] {
            grid.fuse(&SonarModel::srf08(), &down(), 1.15);
        }
        let at = |grid: &OccupancyGrid| grid.certainty((0, 0), 0.85).unwrap().1;
        assert!(at(&second) < at(&first));
    }

    #[test]
    fn heights_are_those_of_the_highest_and_of_the_likeliest_box() {
        let mut grid = grid();
        for _ in 0..3 {
            grid.fuse(&SonarModel::srf08(), &down(), 1.45);
        }
        let likeliest = grid.likeliest_height(0.1, 0.1).unwrap();
        assert!((likeliest - 0.55).abs() < 0.051, "{likeliest}");
        let highest = grid.height(0.1, 0.1).unwrap();
        assert!(highest >= likeliest + 0.049);
        let mean = grid.mean_height(0.1, 0.1).unwrap();
        assert!((mean - 0.55).abs() < 0.051 && mean < highest, "{mean}");
        assert_eq!(grid.mean_height(9.0, 0.1), None);
    }

    #[test]
    fn gains_are_those_of_the_model() {
        let model = SonarModel::srf08();
        let steepness = (2.0 * LN_2 / (model.half_angle * model.half_angle)) as f32;
        for percent in 0..=100 {
            let alpha = std::f64::consts::FRAC_PI_2 * f64::from(percent) / 100.0;
            let gain = f64::from(gaussian(steepness, math::cos(alpha) as f32));
            assert!((gain - model.membership_of_alpha(alpha)).abs() < 1e-4, "{alpha}: {gain}");
        }
    }

    /// What is skipped column by column is what a look at each box would not change.
    #[test]
    fn every_box_has_what_its_distance_and_angle_say() {
        let (cell, step, layers) = (0.2, 0.15, 20);
        let partition = Partition { cell, columns: 24, rows: 24, low: (-12, -12) };
        for (pitch, min, measured) in [
            (-FRAC_PI_2, 0.05, 1.3),
            (-1.1, 0.05, 1.4),
            (-0.9, 0.6, 1.2),
            (0.0, 0.3, 1.0),
            (0.8, 0.2, 1.1),
            (1.4, 1e-3, 0.1),
        ] {
            let model = SonarModel { least: min, ..SonarModel::srf08() };
            let sonar = SonarPose::new(Vector3::new(0.03, -0.04, 1.41), 0.7, pitch);
            let mut grid = OccupancyGrid::new(partition, 0.0, step, layers);
            grid.fuse(&model, &sonar, measured);
            let mut hits = Vec::new();
            for cell_index in partition.cells() {
                for layer in 0..layers {
                    let index = partition.slot(cell_index).unwrap() * layers + layer;
                    let (x, y) = partition.centre(cell_index);
                    let offset = Vector3::new(x, y, grid.middle(layer)) - sonar.origin;
                    let r = offset.norm();
                    let cosine = offset.dot(&sonar.axis) / r;
                    let extent = (offset.x.abs() + offset.y.abs()) * cell + offset.z.abs() * step;
                    let band = model.epsilon * measured + 0.5 * extent / r;
                    let near_edge = (cosine - math::cos(model.aperture())).abs() < 1e-6;
                    let gain = if math::acos(cosine) > model.aperture() {
                        0.0
                    } else {
                        model.membership_of_alpha(math::acos(cosine))
                    };
                    let nearness = r / (measured - band);
                    let empty = if r < measured - band { gain * (1.0 - nearness * nearness) } else { 0.0 };
                    let found = f64::from(grid.empty[index]);
                    assert!(
                        near_edge || (found - empty).abs() < 3e-4,
                        "{pitch} {cell_index:?} {layer}: {found} {empty}"
                    );
                    let ratio = (r - measured) / band;
                    hits.push((index, (1.0 - ratio * ratio).max(0.0) * gain * (1.0 - empty)));
                }
            }
            let total: f64 = hits.iter().map(|(_, gain)| gain).sum();
            assert!(total > 0.0);
            for (index, gain) in hits {
                let found = f64::from(grid.occupied[index]);
                assert!((found - gain / total).abs() < 1e-2 / total, "{pitch} {index}: {found} {}", gain / total);
            }
        }
    }

    /// Wide cells straight below must not smear a reading over heights: the boxes are thin along the ray.
    #[test]
    fn coarse_cells_keep_the_height_of_a_reading() {
        let partition = Partition { cell: 1.2, columns: 2, rows: 2, low: (-1, -1) };
        let mut grid = OccupancyGrid::new(partition, 0.0, 0.1, 20);
        let sonar = SonarPose::new(Vector3::new(0.6, 0.6, 2.0), 0.0, -FRAC_PI_2);
        grid.fuse(&SonarModel::srf08(), &sonar, 1.45);
        let certainty = |z: f64| grid.certainty((0, 0), z).unwrap().1;
        assert!(certainty(0.55) > 0.0);
        assert_eq!((certainty(0.75), certainty(0.35)), (0.0, 0.0), "two boxes off");
    }
}
