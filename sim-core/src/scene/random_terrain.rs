//! Random terrain from a seed: smooth relief with boulders on it.

use std::f64::consts::TAU;

use glam::DVec2;

use super::{FieldError, HeightField};
use crate::noise::{Purpose, Stream};
use crate::{RobotId, math};

/// Maximum number of boulders of a terrain.
pub const MAX_BOULDERS: u32 = 100_000;

/// Maximum number of octaves of the relief; each octave has half the wavelength and half the amplitude of the previous
/// one.
const OCTAVES: u32 = 4;

/// Minimum wavelength of an octave, in cells; octaves with shorter waves, which the grid cannot resolve, are omitted.
const MIN_WAVELENGTH_CELLS: f64 = 4.0;

/// Number of random positions tried for a boulder before it is omitted.
const TRIES: u32 = 64;

/// Minimum ratio of a boulder's width to its length.
const MIN_ASPECT: f64 = 0.6;

/// Parameters of random terrain; in metres, world frame.
///
/// The relief is gradient noise of up to four octaves, shifted and scaled to heights from `base` to
/// `base + relief_height`. Boulders (domes with elliptical outlines) lie on the relief. All random numbers come from
/// streams keyed by seed and purpose, so that more boulders do not change any other number. The terrain is
/// bit-identical on every machine.
///
/// Source: Perlin, "Improving noise", SIGGRAPH 2002 (weights of the gradient noise). The directions of the gradients,
/// the boulders and all other numbers are our choice; Gois and Hiller, section 5, only call their terrains "randomly
/// generated".
#[derive(Clone, Debug, PartialEq)]
pub struct RandomTerrain {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Corner with the minimum x and y.
    pub origin: DVec2,
    /// Width along x and along y; positive.
    pub size: DVec2,
    /// Height of the lowest ground.
    pub base: f64,
    /// Maximum size of the grid's cells, positive: each side is divided into the smallest possible number of equal
    /// cells.
    pub cell: f64,
    /// Height of the smooth relief from its lowest to its highest point; not negative.
    pub relief_height: f64,
    /// Approximate length of the longest hills; positive.
    pub hill_length: f64,
    /// Boulders on the relief.
    pub boulders: Option<Boulders>,
    /// Discs in which the ground is level at `base`; the relief rises to its full height between one and two radii, and
    /// no boulder reaches into a disc.
    pub clear: Vec<Disc>,
}

/// Boulders of a [`RandomTerrain`]: lengths and heights are uniformly distributed between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boulders {
    /// Number of boulders; at most [`MAX_BOULDERS`].
    pub count: u32,
    /// Minimum and maximum half length, in metres; the half width is 0.6 to 1 times the half length.
    pub radius: [f64; 2],
    /// Minimum and maximum height above the surrounding relief, in metres.
    pub height: [f64; 2],
}

/// A disc on the plane, in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disc {
    /// Centre, world frame.
    pub centre: DVec2,
    /// Radius; positive.
    pub radius: f64,
}

impl RandomTerrain {
    /// Generates the terrain; also returns the number of omitted boulders, for which no free position was found outside
    /// the clear discs.
    ///
    /// # Errors
    /// [`FieldError`] if the size is not positive, or gives too many cells.
    pub fn field(&self) -> Result<(HeightField, u32), FieldError> {
        let [columns, rows] = self.cell_counts()?;
        let grid_lines = |low: f64, size: f64, count: usize| -> Vec<f64> {
            (0..=count).map(|index| low + size * (index as f64 / count as f64)).collect()
        };
        let xs = grid_lines(self.origin.x, self.size.x, columns);
        let ys = grid_lines(self.origin.y, self.size.y, rows);
        let mut heights = self.relief_heights(&xs, &ys);
        let omitted = self.add_boulders(&xs, &ys, &mut heights);
        heights.iter_mut().for_each(|height| *height += self.base);
        Ok((HeightField::new(xs, ys, heights)?, omitted))
    }

    /// Number of cells along x and along y.
    fn cell_counts(&self) -> Result<[usize; 2], FieldError> {
        let counts = self.size.to_array().map(|side| (side / self.cell * (1.0 - 1e-12)).ceil().max(1.0));
        let cells = counts[0] * counts[1];
        if !(self.size.min_element() > 0.0 && self.cell > 0.0) {
            return Err(FieldError::Small);
        }
        if cells > super::MAX_CELLS as f64 {
            return Err(FieldError::Large(cells as usize));
        }
        Ok(counts.map(|count| count as usize))
    }

    /// Heights of the relief above the base, without boulders.
    fn relief_heights(&self, xs: &[f64], ys: &[f64]) -> Vec<f64> {
        let mut heights = vec![0.0; xs.len() * ys.len()];
        if self.relief_height <= 0.0 {
            return heights;
        }
        let octaves = (0..OCTAVES).map(|octave| (octave, self.hill_length / f64::from(1 << octave)));
        for (octave, length) in
            octaves.filter(|(octave, length)| *octave == 0 || *length >= MIN_WAVELENGTH_CELLS * self.cell)
        {
            let amplitude = 1.0 / f64::from(1 << octave);
            let lattice = Lattice::new(self.seed, octave, self.size / length);
            let points = ys.iter().flat_map(|y| xs.iter().map(move |x| DVec2::new(*x, *y)));
            for (height, point) in heights.iter_mut().zip(points) {
                *height += amplitude * lattice.value((point - self.origin) / length);
            }
        }
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let scale = if high > low { self.relief_height / (high - low) } else { 0.0 };
        let points = ys.iter().flat_map(|y| xs.iter().map(move |x| DVec2::new(*x, *y)));
        for (height, point) in heights.iter_mut().zip(points) {
            *height = ((*height - low) * scale).min(self.relief_height) * self.relief_weight(point);
        }
        heights
    }

    /// Factor on the height of the relief at a point: 0 in the clear discs, 1 from twice their radius on.
    fn relief_weight(&self, point: DVec2) -> f64 {
        let weight = |disc: &Disc| {
            let fraction = (point.distance(disc.centre) / disc.radius - 1.0).clamp(0.0, 1.0);
            fraction * fraction * (3.0 - 2.0 * fraction)
        };
        self.clear.iter().map(weight).fold(1.0, f64::min)
    }

    /// Adds the boulders to the heights; returns the number of omitted boulders.
    fn add_boulders(&self, xs: &[f64], ys: &[f64], heights: &mut [f64]) -> u32 {
        let Some(boulders) = &self.boulders else { return 0 };
        let mut domes = vec![0.0_f64; heights.len()];
        let mut omitted = 0;
        for number in 0..boulders.count {
            let Some(boulder) = self.boulder(boulders, number) else {
                omitted += 1;
                continue;
            };
            let covered = |lines: &[f64], middle: f64| {
                let first = lines.partition_point(|line| *line < middle - boulder.radius);
                first..lines.partition_point(|line| *line <= middle + boulder.radius)
            };
            for row in covered(ys, boulder.centre.y) {
                for column in covered(xs, boulder.centre.x) {
                    let dome = &mut domes[row * xs.len() + column];
                    *dome = dome.max(boulder.height(DVec2::new(xs[column], ys[row])));
                }
            }
        }
        heights.iter_mut().zip(&domes).for_each(|(height, dome)| *height += dome);
        omitted
    }

    /// Boulder `number`; `None` if none of the tried positions is free.
    fn boulder(&self, boulders: &Boulders, number: u32) -> Option<Boulder> {
        let mut stream = Stream::new(self.seed, RobotId(0), Purpose::Terrain, 0, u64::from(number));
        let mut draw = |low: f64, high: f64| low + (high - low) * stream.unit();
        let radius = draw(boulders.radius[0], boulders.radius[1]);
        let height = draw(boulders.height[0], boulders.height[1]);
        let aspect = draw(MIN_ASPECT, 1.0);
        let (sin, cos) = math::sin_cos(draw(0.0, TAU));
        let (low, high) = (self.origin, self.origin + self.size);
        (0..TRIES).find_map(|_| {
            let centre = DVec2::new(draw(low.x, high.x), draw(low.y, high.y));
            let is_free = self.clear.iter().all(|disc| centre.distance(disc.centre) >= disc.radius + radius);
            is_free.then_some(Boulder { centre, radius, aspect, axis: DVec2::new(cos, sin), top: height })
        })
    }
}

/// A dome with an elliptical outline.
struct Boulder {
    centre: DVec2,
    /// Half length.
    radius: f64,
    /// Ratio of width to length.
    aspect: f64,
    /// Unit vector along its length.
    axis: DVec2,
    /// Maximum height.
    top: f64,
}

impl Boulder {
    fn height(&self, point: DVec2) -> f64 {
        let offset = (point - self.centre) / self.radius;
        let lateral = self.axis.perp_dot(offset) / self.aspect;
        let along = self.axis.dot(offset);
        self.top * (1.0 - along * along - lateral * lateral).max(0.0)
    }
}

/// Gradient noise over a lattice of unit squares.
struct Lattice {
    columns: usize,
    /// Unit gradients of the lattice points, row by row.
    gradients: Vec<DVec2>,
}

impl Lattice {
    /// A lattice of `size` squares, counted from the origin; each row of gradients has a separate random stream.
    fn new(seed: u64, octave: u32, size: DVec2) -> Self {
        let [columns, rows] = size.to_array().map(|side| side as usize + 2);
        let mut gradients = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            let mut stream = Stream::new(seed, RobotId(0), Purpose::Terrain, octave + 1, row as u64);
            gradients.extend((0..columns).map(|_| {
                let (sin, cos) = math::sin_cos(TAU * stream.unit());
                DVec2::new(cos, sin)
            }));
        }
        Self { columns, gradients }
    }

    fn value(&self, point: DVec2) -> f64 {
        let rows = self.gradients.len() / self.columns;
        let column = (point.x as usize).min(self.columns - 2);
        let row = (point.y as usize).min(rows - 2);
        let part = point - DVec2::new(column as f64, row as f64);
        let corner = |right: usize, up: usize| {
            let gradient = self.gradients[(row + up) * self.columns + column + right];
            gradient.dot(part - DVec2::new(right as f64, up as f64))
        };
        let weight = part.to_array().map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
        let mix = |a: f64, b: f64, fraction: f64| a + fraction * (b - a);
        mix(mix(corner(0, 0), corner(1, 0), weight[0]), mix(corner(0, 1), corner(1, 1), weight[0]), weight[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terrain(seed: u64) -> RandomTerrain {
        let boulders = Boulders { count: 30, radius: [0.2, 0.6], height: [0.1, 0.4] };
        RandomTerrain {
            seed,
            origin: DVec2::new(-1.0, 2.0),
            size: DVec2::new(10.0, 6.0),
            base: 0.05,
            cell: 0.1,
            relief_height: 0.2,
            hill_length: 3.0,
            boulders: Some(boulders),
            clear: vec![
                Disc { centre: DVec2::new(0.0, 3.0), radius: 0.8 },
                Disc { centre: DVec2::new(8.0, 7.0), radius: 0.5 },
            ],
        }
    }

    #[test]
    fn equal_seeds_give_equal_terrains_and_different_seeds_different_ones() {
        let field = |seed| terrain(seed).field().expect("a field").0;
        assert_eq!(field(0), field(0));
        assert_ne!(field(0), field(1));
        assert_ne!(field(i64::MAX as u64), field(i64::MAX as u64 - 1));
    }

    #[test]
    fn a_terrain_is_bit_identical_on_every_machine() {
        // Digest for seed 7, the same on every machine.
        let (field, _) = terrain(7).field().expect("a field");
        let mut digest = 0xcbf2_9ce4_8422_2325_u64;
        for row in 0..field.size().1 {
            for column in 0..field.size().0 {
                digest = (digest ^ field.corner(column, row).z.to_bits()).wrapping_mul(0x0100_0000_01b3);
            }
        }
        assert_eq!(format!("{digest:016x}"), "71ecd76356f8ae1a");
    }

    #[test]
    fn relief_has_its_height_and_discs_are_level() {
        for seed in [0, 1, 7, i64::MAX as u64] {
            let mut terrain = terrain(seed);
            let (field, omitted) = terrain.field().expect("a field");
            assert_eq!(omitted, 0);
            for disc in &terrain.clear {
                for step in 0..100 {
                    let (sin, cos) = math::sin_cos(f64::from(step));
                    // A cell that overlaps the edge of the disc may rise.
                    let radius = (disc.radius - 0.15) * f64::from(step) / 100.0;
                    let point = disc.centre + radius * DVec2::new(cos, sin);
                    assert_eq!(field.height(point.x, point.y), 0.05);
                }
            }
            let highest = field.height_bounds().1;
            assert!(highest <= 0.05 + 0.2 + 0.4 && highest > 0.25, "{highest}");
            terrain.clear.clear();
            terrain.boulders = None;
            let (low, high) = terrain.field().expect("a field").0.height_bounds();
            assert!((low - 0.05).abs() < 1e-15 && (high - 0.25).abs() < 1e-12, "{low} to {high}");
        }
    }

    #[test]
    fn another_boulder_does_not_move_the_others() {
        let mut fewer = terrain(3);
        let mut more = terrain(3);
        (fewer.boulders.as_mut().unwrap().count, more.boulders.as_mut().unwrap().count) = (5, 6);
        let (fewer, more) = (fewer.field().expect("a field").0, more.field().expect("a field").0);
        let (columns, rows) = fewer.size();
        let corners = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let changed: Vec<_> = corners.filter(|(c, r)| fewer.corner(*c, *r) != more.corner(*c, *r)).collect();
        assert!(!changed.is_empty() && changed.iter().all(|(c, r)| more.corner(*c, *r).z > fewer.corner(*c, *r).z));
        let spread = |index: fn(&(usize, usize)) -> usize| {
            changed.iter().map(index).max().unwrap() - changed.iter().map(index).min().unwrap()
        };
        assert!(
            spread(|(c, _)| *c) <= 12 && spread(|(_, r)| *r) <= 12,
            "only one boulder is new: {} corners",
            changed.len()
        );
    }

    #[test]
    fn omitted_boulders_are_counted() {
        let mut terrain = terrain(1);
        terrain.clear = vec![Disc { centre: DVec2::new(4.0, 5.0), radius: 20.0 }];
        let (field, omitted) = terrain.field().expect("a field");
        assert_eq!((omitted, field.height_bounds()), (30, (0.05, 0.05)));
    }

    #[test]
    fn a_field_without_size_or_with_too_many_cells_is_an_error() {
        let field_size =
            |size: DVec2, cell| RandomTerrain { size, cell, ..terrain(1) }.field().map(|(field, _)| field.size());
        assert_eq!(field_size(DVec2::new(0.0, 1.0), 0.1), Err(FieldError::Small));
        assert_eq!(field_size(DVec2::new(f64::NAN, 1.0), 0.1), Err(FieldError::Number));
        assert_eq!(field_size(DVec2::new(1000.0, 1000.0), 0.1), Err(FieldError::Large(100_000_000)));
        assert_eq!(field_size(DVec2::new(0.01, 0.01), 0.1), Ok((2, 2)));
        assert_eq!(field_size(DVec2::new(0.3, 0.7), 0.1), Ok((4, 8)));
    }
}
