//! Three-dimensional occupancy grid after Moravec and Elfes, with separate certainties for empty and for occupied.
//!
//! Source: Moravec and Elfes 1985, *High resolution maps from wide angle sonar*, with a third dimension (Gois and
//! Hiller, sections 3 and 4). Across the beam, certainties are weighted by the beam gain of [`SonarModel`].

use std::f64::consts::LN_2;
use std::ops::Range;

use crate::inverse::{SonarModel, SonarPose};
use crate::math;
use crate::tsk::{CellIndex, Partition};

/// The grid: voxels stacked over the cells of a partition.
#[derive(Clone, Debug)]
pub struct OccupancyGrid {
    partition: Partition,
    /// Height of a voxel, m.
    voxel_height: f64,
    /// Height of the lower faces of the lowest voxels, m.
    bottom: f64,
    layers: usize,
    /// Certainty of each voxel of being empty: cell by cell in the order of the partition's slots, in each cell from
    /// the bottom up.
    empty: Vec<f32>,
    /// Certainty of each voxel of being occupied, in the same order.
    occupied: Vec<f32>,
}

impl OccupancyGrid {
    /// A grid without readings: above each cell `layers` voxels of the height `voxel_height` m, from the height
    /// `bottom` m upwards.
    pub fn new(partition: Partition, bottom: f64, voxel_height: f64, layers: usize) -> Self {
        let count = partition.columns * partition.rows * layers;
        Self { partition, voxel_height, bottom, layers, empty: vec![0.0; count], occupied: vec![0.0; count] }
    }

    /// The cells.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Fuses a reading. In voxels of the beam that are nearer than the reading, the certainty of being empty rises. In
    /// voxels at the reading's distance, the certainty of being occupied rises: less if more voxels are at that
    /// distance, and less if the voxel is more certainly empty. A voxel is at a distance if the ray through its centre
    /// meets the voxel there, so coarse voxels smear a reading by no more than their extent.
    pub fn fuse(&mut self, model: &SonarModel, sonar: &SonarPose, measured: f64) {
        let range_error = model.epsilon * measured;
        let max_half_band = range_error + 0.5 * (self.voxel_height + 2.0 * self.partition.cell);
        let max_distance = measured + max_half_band;
        let beam = BeamParameters {
            along_z: sonar.axis.z as f32,
            min_cosine: math::cos(model.aperture()) as f32,
            steepness: (2.0 * LN_2 / (model.half_angle * model.half_angle)) as f32,
            measured: measured as f32,
            range_error: range_error as f32,
            voxel_height: self.voxel_height as f32,
        };
        let [east, north] = model.extents(sonar).map(|range| range.map(|fraction| fraction * max_distance));
        let mut hits = Vec::new();
        for index in self.partition.cells_within(sonar.origin.x, sonar.origin.y, east, north) {
            let Some(slot) = self.partition.slot(index) else { continue };
            let (x, y) = self.partition.centre(index);
            let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
            let horizontal_sq = dx * dx + dy * dy;
            let dot_horizontal = dx * sonar.axis.x + dy * sonar.axis.y;
            let Some(in_cone) = cone_interval(dot_horizontal, horizontal_sq, sonar.axis.z, model.aperture()) else {
                continue;
            };
            let column = Column {
                horizontal_sq: horizontal_sq as f32,
                dot_horizontal: dot_horizontal as f32,
                extent_xy: ((dx.abs() + dy.abs()) * self.partition.cell) as f32,
                lowest_dz: (self.voxel_centre(0) - sonar.origin.z) as f32,
            };
            let base = slot * self.layers;
            let emptied = self.layers_between(sonar.origin.z, in_cone, sphere_interval(measured, horizontal_sq));
            for (layer, empty) in emptied.clone().zip(&mut self.empty[base..][emptied]) {
                let increment = beam.empty_increment(&column, layer as u32);
                *empty += increment - *empty * increment;
            }
            let (outer, inner) = (
                sphere_interval(max_distance, horizontal_sq),
                sphere_interval((measured - max_half_band).max(0.0), horizontal_sq),
            );
            let (low, high) = (-inner.1, inner.1);
            // Two layer ranges, below and above the inner sphere. Layers in both ranges (where the column misses that
            // sphere) are taken once.
            let lower = self.layers_between(sonar.origin.z, in_cone, (outer.0, low));
            let upper = self.layers_between(sonar.origin.z, in_cone, (high, outer.1));
            let upper = upper.start.max(lower.end)..upper.end;
            for layer in lower.chain(upper) {
                let weight = beam.hit_weight(&column, layer as u32);
                if weight > 0.0 {
                    hits.push((base + layer, weight));
                }
            }
        }
        self.occupy(&mut hits);
    }

    /// Layers whose centres may lie in both intervals of heights relative to `origin`, m, with one more at each end
    /// because of rounding.
    fn layers_between(&self, origin: f64, first: (f64, f64), second: (f64, f64)) -> Range<usize> {
        let layer =
            |dz: f64| ((origin + dz - self.bottom) / self.voxel_height - 0.5).clamp(-2.0, self.layers as f64 + 2.0);
        let (low, high) = (first.0.max(second.0), first.1.min(second.1));
        if low > high {
            return 0..0;
        }
        let from = (layer(low).floor() - 1.0).max(0.0) as usize;
        let to = (layer(high).ceil() + 2.0).clamp(0.0, self.layers as f64) as usize;
        from.min(to)..to
    }

    /// Height of the upper face of the highest occupied voxel at (x, y), m: the paper's projection onto the plane.
    /// `None` where no voxel is occupied, or outside.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let layer = (0..self.layers).rev().find(|layer| self.is_occupied(slot, *layer))?;
        Some(self.voxel_centre(layer) + self.voxel_height / 2.0)
    }

    /// Height of the centre of the most certainly occupied voxel at (x, y), m; not in the paper. `None` where no voxel
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
            .map(|layer| self.voxel_centre(layer))
    }

    /// Mean height of the occupied voxels at (x, y), m, weighted by the certainty of being occupied minus that of being
    /// empty; not in the paper. `None` where no voxel is occupied, or outside.
    pub fn mean_height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let weighted = (0..self.layers).filter(|layer| self.is_occupied(slot, *layer)).map(|layer| {
            let index = slot * self.layers + layer;
            (f64::from(self.occupied[index]) - f64::from(self.empty[index]), self.voxel_centre(layer))
        });
        let (sum, total) = weighted.fold((0.0, 0.0), |(sum, total), (weight, z)| (sum + weight * z, total + weight));
        (total > 0.0).then(|| sum / total)
    }

    /// Certainties (empty, occupied) of the voxel of a cell that contains the height `z`; `None` outside.
    pub fn certainty(&self, cell_index: CellIndex, z: f64) -> Option<(f64, f64)> {
        let layer = ((z - self.bottom) / self.voxel_height).floor();
        let index = self.partition.slot(cell_index)? * self.layers + layer as usize;
        ((0.0..self.layers as f64).contains(&layer))
            .then(|| (f64::from(self.empty[index]), f64::from(self.occupied[index])))
    }

    /// Raises the certainties of being occupied for one echo; `hits` are voxels with their weights. The increments of a
    /// reading are at most 1 in total.
    fn occupy(&mut self, hits: &mut [(usize, f32)]) {
        for (index, weight) in &mut *hits {
            *weight *= 1.0 - self.empty[*index];
        }
        let total: f64 = hits.iter().map(|(_, weight)| f64::from(*weight)).sum();
        if total <= 0.0 {
            return;
        }
        for (index, weight) in &*hits {
            let increment = weight / total as f32;
            self.occupied[*index] += increment - self.occupied[*index] * increment;
        }
    }

    fn voxel_centre(&self, layer: usize) -> f64 {
        self.bottom + (layer as f64 + 0.5) * self.voxel_height
    }

    fn is_occupied(&self, slot: usize, layer: usize) -> bool {
        let index = slot * self.layers + layer;
        self.occupied[index] > self.empty[index]
    }
}

/// Values that are constant for one reading, in single precision for speed: with a fine grid, the beams contain
/// hundreds of millions of voxels.
struct BeamParameters {
    /// Component of the line of sight along z.
    along_z: f32,
    /// Cosine of the aperture.
    min_cosine: f32,
    /// Factor k of the beam gain exp(-k alpha^2), with the angle alpha from the line of sight.
    steepness: f32,
    measured: f32,
    /// Maximum error of the reading, m.
    range_error: f32,
    /// Height of a voxel, m.
    voxel_height: f32,
}

/// A column of voxels as seen from a sonar.
struct Column {
    /// Squared horizontal distance of the column from the sonar, m^2.
    horizontal_sq: f32,
    /// Horizontal terms of the dot product of (column minus sonar) and the line of sight, m.
    dot_horizontal: f32,
    /// (|dx| + |dy|) times the side of a cell, m^2: horizontal part of the voxel's extent along the ray, times the
    /// distance.
    extent_xy: f32,
    /// Height of the lowest voxel's centre relative to the sonar, m.
    lowest_dz: f32,
}

impl BeamParameters {
    /// Distance of the voxel in a layer, its beam gain (0 outside the beam), and half the width of the band of
    /// distances at which a reading belongs to the voxel.
    #[inline]
    fn geometry(&self, column: &Column, layer: u32) -> (f32, f32, f32) {
        let dz = column.lowest_dz + layer as f32 * self.voxel_height;
        // Avoids a division by zero for a voxel at the sonar; its direction is arbitrary.
        let r = (column.horizontal_sq + dz * dz).sqrt().max(1e-6);
        let cosine = (column.dot_horizontal + dz * self.along_z) / r;
        // Error of the reading plus half the extent of the voxel along the ray through its centre.
        let band = self.range_error + 0.5 * (column.extent_xy + dz.abs() * self.voxel_height) / r;
        let gain = if cosine < self.min_cosine { 0.0 } else { gaussian(self.steepness, cosine) };
        (r, gain, band)
    }

    /// Increment of a voxel's certainty of being empty.
    #[inline]
    fn empty_increment(&self, column: &Column, layer: u32) -> f32 {
        let (r, gain, band) = self.geometry(column, layer);
        let nearness = r / (self.measured - band);
        if r < self.measured - band { gain * (1.0 - nearness * nearness) } else { 0.0 }
    }

    /// Weight of a voxel in the echo; 0 unless it is at the echo's distance.
    fn hit_weight(&self, column: &Column, layer: u32) -> f32 {
        let (r, gain, band) = self.geometry(column, layer);
        let ratio = (r - self.measured) / band;
        gain * (1.0 - ratio * ratio).max(0.0)
    }
}

/// exp(-`steepness` alpha^2), where the angle alpha has this cosine and is at most a right angle; exact to 1e-4.
///
/// Uses series for acos^2 about 1 and for the exponential function of a 16th of the exponent; the 16th power of the
/// latter is the result. There are no branches, so compilers can vectorise it.
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

/// Interval of heights, relative to the apex of a cone, in which a vertical line is inside the cone; `None` if the line
/// misses the cone.
///
/// `dot_horizontal` is the horizontal part of the dot product of (line minus apex) and the cone's axis, `horizontal_sq`
/// the squared horizontal distance of the line from the apex.
fn cone_interval(dot_horizontal: f64, horizontal_sq: f64, axis_z: f64, aperture: f64) -> Option<(f64, f64)> {
    let cosine = math::cos(aperture);
    // Points at the height dz inside the cone: dot_horizontal + dz axis_z >= 0 and q dz^2 + 2 b dz + d >= 0.
    let (q, b, d) = (
        axis_z * axis_z - cosine * cosine,
        dot_horizontal * axis_z,
        dot_horizontal * dot_horizontal - cosine * cosine * horizontal_sq,
    );
    let discriminant = b * b - q * d;
    if q.abs() < 1e-9 || (discriminant < 0.0 && q > 0.0) {
        return Some((f64::NEG_INFINITY, f64::INFINITY));
    }
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let (low, high) = ((-b - root) / q, (-b + root) / q);
    let (low, high) = (low.min(high), low.max(high));
    if q > 0.0 {
        return Some(if axis_z < 0.0 { (f64::NEG_INFINITY, low) } else { (high, f64::INFINITY) });
    }
    (dot_horizontal + 0.5 * (low + high) * axis_z >= 0.0).then_some((low, high))
}

/// Interval of heights, relative to the centre of a sphere, in which a vertical line is inside the sphere; (0, 0) if it
/// misses the sphere.
fn sphere_interval(radius: f64, horizontal_sq: f64) -> (f64, f64) {
    let half = (radius * radius - horizontal_sq).max(0.0).sqrt();
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
    fn reading_marks_the_beam_empty_and_its_end_occupied() {
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
    fn voxels_known_as_empty_gain_less_occupancy() {
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
    fn projections_give_highest_likeliest_and_mean_height() {
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
    fn beam_gain_matches_the_model() {
        let model = SonarModel::srf08();
        let steepness = (2.0 * LN_2 / (model.half_angle * model.half_angle)) as f32;
        for percent in 0..=100 {
            let alpha = std::f64::consts::FRAC_PI_2 * f64::from(percent) / 100.0;
            let gain = f64::from(gaussian(steepness, math::cos(alpha) as f32));
            assert!((gain - model.membership_of_alpha(alpha)).abs() < 1e-4, "{alpha}: {gain}");
        }
    }

    /// The layer limits of a column skip only voxels that a computation of all voxels would leave unchanged.
    #[test]
    fn fuse_matches_computation_voxel_by_voxel() {
        let (cell, voxel_height, layers) = (0.2, 0.15, 20);
        let partition = Partition { cell, columns: 24, rows: 24, low: (-12, -12) };
        for (pitch, min_membership, measured) in [
            (-FRAC_PI_2, 0.05, 1.3),
            (-1.1, 0.05, 1.4),
            (-0.9, 0.6, 1.2),
            (0.0, 0.3, 1.0),
            (0.8, 0.2, 1.1),
            (1.4, 1e-3, 0.1),
        ] {
            let model = SonarModel { min_membership, ..SonarModel::srf08() };
            let sonar = SonarPose::new(Vector3::new(0.03, -0.04, 1.41), 0.7, pitch);
            let mut grid = OccupancyGrid::new(partition, 0.0, voxel_height, layers);
            grid.fuse(&model, &sonar, measured);
            let mut hits = Vec::new();
            for cell_index in partition.cells() {
                for layer in 0..layers {
                    let index = partition.slot(cell_index).unwrap() * layers + layer;
                    let (x, y) = partition.centre(cell_index);
                    let offset = Vector3::new(x, y, grid.voxel_centre(layer)) - sonar.origin;
                    let r = offset.norm();
                    let cosine = offset.dot(&sonar.axis) / r;
                    let extent = (offset.x.abs() + offset.y.abs()) * cell + offset.z.abs() * voxel_height;
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

    /// Wide cells straight below do not smear a reading over heights, since the voxels are thin along the ray.
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
