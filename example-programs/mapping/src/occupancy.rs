//! Three-dimensional occupancy grid after Moravec and Elfes, with separate certainties for empty and for occupied.
//!
//! Source: Moravec and Elfes 1985, *High resolution maps from wide angle sonar*, with a third dimension (Gois and
//! Hiller, sections 3 and 4). Across the beam, certainties are weighted by the gain of [`SonarModel`].

use crate::inverse::{SonarModel, SonarPose};
use crate::math;
use crate::tsk::{Partition, Place};

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
    empty: Vec<f64>,
    occupied: Vec<f64>,
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
    /// certainty of being occupied rises. Returns the number of boxes touched.
    pub fn fuse(&mut self, model: &SonarModel, sonar: &SonarPose, measured: f64) -> usize {
        let reach = model.epsilon * measured;
        let most = measured + reach + 0.5 * (self.step + 2.0 * self.partition.cell);
        let least_cosine = math::cos(model.aperture());
        // Extents of the beam along x and y: only columns within them are looked at.
        let [east, north] =
            [sonar.axis.x, sonar.axis.y].map(|along| extent(along, model.aperture()).map(|share| share * most));
        let [east, north] = [east, north].map(|[low, high]| low - 1e-9..high + 1e-9);
        let gains = Gains::new(model, least_cosine);
        let mut touched = 0;
        let mut hits = Vec::new();
        for place in self.partition.places_around(sonar.origin.x, sonar.origin.y, most) {
            let Some(slot) = self.partition.slot(place) else { continue };
            let (x, y) = self.partition.centre(place);
            let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
            let level = dx * dx + dy * dy;
            if !(east.contains(&dx) && north.contains(&dy)) || level > most * most {
                continue;
            }
            for layer in 0..self.layers {
                let dz = self.middle(layer) - sonar.origin.z;
                let r = (level + dz * dz).sqrt();
                let along = dx * sonar.axis.x + dy * sonar.axis.y + dz * sonar.axis.z;
                if r > most || along < least_cosine * r {
                    continue;
                }
                // Half the extent of a box along the ray through its middle: the box is met from r - half to r + half.
                let sides = (dx.abs() + dy.abs()) * self.partition.cell + dz.abs() * self.step;
                let band = reach + if r > 0.0 { 0.5 * sides / r } else { 0.0 };
                if r > measured + band {
                    continue;
                }
                let beam_gain = gains.at(if r > 0.0 { along / r } else { 1.0 });
                touched += 1;
                let index = slot * self.layers + layer;
                if r < measured - band {
                    let nearness = r / (measured - band);
                    let empty = beam_gain * (1.0 - nearness * nearness);
                    self.empty[index] += empty - self.empty[index] * empty;
                } else {
                    let ratio = (r - measured) / band;
                    hits.push((index, beam_gain * (1.0 - ratio * ratio)));
                }
            }
        }
        self.occupy(&mut hits);
        touched
    }

    /// The upper face of the highest occupied box at (x, y), m: the paper's projection onto the plane. `None` where no
    /// box is occupied, or outside.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.place(x, y))?;
        let layer = (0..self.layers).rev().find(|layer| self.is_occupied(slot, *layer))?;
        Some(self.middle(layer) + self.step / 2.0)
    }

    /// The middle of the box at (x, y) that is most certainly occupied, m: another projection than the paper's. `None` where none
    /// is occupied, or outside.
    pub fn likeliest_height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.place(x, y))?;
        let certainty = |layer: &usize| {
            let index = slot * self.layers + layer;
            self.occupied[index] - self.empty[index]
        };
        (0..self.layers)
            .filter(|layer| self.is_occupied(slot, *layer))
            .max_by(|a, b| certainty(a).total_cmp(&certainty(b)))
            .map(|layer| self.middle(layer))
    }

    /// The mean height at (x, y) of the boxes that are occupied, weighted by how much more certainly they are occupied than empty, m:
    /// another projection than the paper's. `None` where none is occupied, or outside.
    pub fn mean_height(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.place(x, y))?;
        let weighted = (0..self.layers).filter(|layer| self.is_occupied(slot, *layer)).map(|layer| {
            let index = slot * self.layers + layer;
            (self.occupied[index] - self.empty[index], self.middle(layer))
        });
        let (sum, total) = weighted.fold((0.0, 0.0), |(sum, total), (weight, z)| (sum + weight * z, total + weight));
        (total > 0.0).then(|| sum / total)
    }

    /// Certainty (empty, occupied) of the box of a cell with the height `z`; `None` outside.
    pub fn certainty(&self, place: Place, z: f64) -> Option<(f64, f64)> {
        let layer = ((z - self.bottom) / self.step).floor();
        let index = self.partition.slot(place)? * self.layers + layer as usize;
        ((0.0..self.layers as f64).contains(&layer)).then(|| (self.empty[index], self.occupied[index]))
    }

    /// Raises the certainties for one echo: the boxes of a reading gain no more than 1 in total.
    fn occupy(&mut self, hits: &mut [(usize, f64)]) {
        for (index, gain) in &mut *hits {
            *gain *= 1.0 - self.empty[*index];
        }
        let total: f64 = hits.iter().map(|(_, gain)| gain).sum();
        if total <= 0.0 {
            return;
        }
        for (index, gain) in &*hits {
            let gain = gain / total;
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

/// The gain of a beam as a function of the cosine of the angle from its axis, tabulated: a reading asks for it at thousands of boxes.
/// Linear between the entries, off by less than 1e-4.
struct Gains {
    least_cosine: f64,
    step: f64,
    entries: [f64; Self::STEPS + 2],
}

impl Gains {
    const STEPS: usize = 512;

    fn new(model: &SonarModel, least_cosine: f64) -> Self {
        let step = (1.0 - least_cosine) / Self::STEPS as f64;
        let gain = |index: usize| model.membership_of_alpha(math::acos(least_cosine + step * index as f64));
        Self { least_cosine, step, entries: std::array::from_fn(gain) }
    }

    fn at(&self, cosine: f64) -> f64 {
        let place = ((cosine - self.least_cosine) / self.step).clamp(0.0, Self::STEPS as f64);
        let (index, share) = (place as usize, place.fract());
        self.entries[index] + share * (self.entries[index + 1] - self.entries[index])
    }
}

/// Least and greatest coordinate along a direction of the unit cone whose axis has the coordinate `along`, with its apex at 0.
fn extent(along: f64, aperture: f64) -> [f64; 2] {
    let greatest = |along: f64| {
        let angle = math::acos(along);
        if angle <= aperture { 1.0 } else { math::cos(angle - aperture).max(0.0) }
    };
    [-greatest(-along), greatest(along)]
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
        assert!(grid.fuse(&SonarModel::srf08(), &down(), 1.45) > 0);
        let (empty, occupied) = grid.certainty((0, 0), 1.05).unwrap();
        assert!(empty > 0.3 && occupied == 0.0, "half way: {empty} {occupied}");
        let (empty, occupied) = grid.certainty((0, 0), 0.55).unwrap();
        assert!(empty == 0.0 && occupied > 0.0, "at the echo: {empty} {occupied}");
        assert_eq!(grid.certainty((0, 0), 0.25), Some((0.0, 0.0)), "behind it");
        assert_eq!(grid.certainty((0, 0), 2.05), None, "above the grid");
        let total: f64 = grid.occupied.iter().sum();
        assert!((total - 1.0).abs() < 1e-12, "one reading, one echo: {total}");
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
    fn tabulated_gains_are_those_of_the_model() {
        for least in [0.4, 0.05, 1e-9] {
            let model = SonarModel { least, ..SonarModel::srf08() };
            let gains = Gains::new(&model, math::cos(model.aperture()));
            for percent in 0..=100 {
                let alpha = model.aperture() * f64::from(percent) / 100.0;
                let (tabulated, exact) = (gains.at(math::cos(alpha)), model.membership_of_alpha(alpha));
                assert!((tabulated - exact).abs() < 1e-4, "{least}, {alpha}: {tabulated} {exact}");
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
