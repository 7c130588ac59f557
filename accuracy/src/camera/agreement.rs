use std::ops::AddAssign;

use glam::DVec2;
use sim_core::camera::{Camera, Label, Picture, View};
use sim_core::{RobotId, camera::PosedScenery};

use super::{Reference, Sight};

/// A camera's colour, depth and label pictures of one view.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Red, green and blue, one sample per pixel.
    pub colour: Picture<[u8; 3]>,
    /// Distance along each pixel's line of sight, m.
    pub depth: Picture<f32>,
    /// Label of the surface at each pixel.
    pub labels: Picture<Label>,
}

impl Shot {
    /// Renders the pictures with the core's camera.
    pub fn take(camera: &mut Camera, posed: &PosedScenery, view: &View, by: Option<RobotId>) -> Self {
        Self {
            colour: camera.colour(posed, view, by, 1),
            depth: camera.depth(posed, view, by),
            labels: camera.labels(posed, view, by),
        }
    }
}

/// Agreement of pictures with the reference.
#[derive(Clone, Debug, Default)]
pub struct Agreement {
    /// Number of pixels compared.
    pub pixels: usize,
    /// Number of pixels that differ from the reference at the pixel's centre: by another label, a depth error above
    /// [`DEPTH`], or a colour error of more than one grey level.
    pub differing: usize,
    /// Differing pixels that the reference cannot explain: their values are outside the range of the reference's values
    /// at the pixel's centre and at eight points around it, [`NEAR`] away in each axis. This range includes surfaces
    /// that coincide with the nearest one.
    pub wrong: Vec<Wrong>,
}

/// A wrong pixel.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// Column and row.
    pub at: [u32; 2],
    /// Colour, depth and label in the tested pictures.
    pub found: ([u8; 3], f32, Label),
    /// The reference at the pixel's centre.
    pub truth: Sight,
}

/// Distance of a silhouette from a pixel's centre, in pixels, up to which the surface on either side is accepted.
pub const NEAR: f64 = 0.01;
/// Relative tolerance of depths.
pub const DEPTH: f64 = 1e-5;
/// Relative difference of depths up to which two surfaces are treated as coincident, since rounding decides which is
/// nearer.
const COINCIDENT: f64 = 1e-6;

impl Agreement {
    /// Compares every pixel of `shot` with the reference.
    pub fn of(shot: &Shot, reference: &Reference, view: &View) -> Self {
        Self::of_some(shot, reference, view, 1)
    }

    /// Compares every `step`th pixel of `shot` with the reference.
    pub fn of_some(shot: &Shot, reference: &Reference, view: &View, step: usize) -> Self {
        let [width, height] = view.size();
        let mut agreement = Self::default();
        for pixel in (0..width * height).step_by(step) {
            let at @ [column, row] = [pixel % width, pixel / width];
            agreement.pixels += 1;
            let found =
                (*shot.colour.pixel(column, row), *shot.depth.pixel(column, row), *shot.labels.pixel(column, row));
            let middle = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let truth = reference.look(view, middle);
            if is_within(found, &[truth]) {
                continue;
            }
            agreement.differing += 1;
            let offsets = || [-NEAR, 0.0, NEAR].into_iter();
            let points = offsets().flat_map(|x| offsets().map(move |y| middle + DVec2::new(x, y)));
            let sights: Vec<Sight> = points.flat_map(|point| reference.sights(view, point, COINCIDENT)).collect();
            if !is_within(found, &sights) {
                agreement.wrong.push(Wrong { at, found, truth });
            }
        }
        agreement
    }

    /// Asserts that no pixel is wrong.
    ///
    /// # Panics
    /// If a pixel is wrong; the message states `what`, the name of the comparison, and the first wrong pixel.
    pub fn assert_right(&self, what: &str) {
        if let Some(wrong) = self.wrong.first() {
            panic!("{what}: {} of {} pixels are wrong: {wrong:?}", self.wrong.len(), self.pixels);
        }
    }

    /// Fraction of the pixels that differ.
    pub fn share(&self) -> f64 {
        self.differing as f64 / self.pixels.max(1) as f64
    }
}

impl AddAssign for Agreement {
    fn add_assign(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.differing += other.differing;
        self.wrong.extend(other.wrong);
    }
}

/// Returns true if the label of a pixel occurs among the sights, and its depth and its colour channels are, within the
/// tolerances, in the range of the sights.
fn is_within((colour, depth, label): ([u8; 3], f32, Label), sights: &[Sight]) -> bool {
    let is_in_range = |value: f64, slack: f64, property: &dyn Fn(&Sight) -> f64| {
        let min = sights.iter().map(property).fold(f64::INFINITY, f64::min);
        let max = sights.iter().map(property).fold(f64::NEG_INFINITY, f64::max);
        value >= min - slack && value <= max + slack
    };
    let depth = f64::from(depth);
    let slack = if depth.is_finite() { DEPTH * depth } else { 0.0 };
    sights.iter().any(|sight| sight.label == label)
        && is_in_range(depth, slack, &|sight| sight.depth)
        && (0..3)
            .all(|channel| is_in_range(f64::from(colour[channel]), 1.0, &|sight| (sight.colour[channel] + 0.5).floor()))
}
