use std::ops::AddAssign;

use glam::DVec2;
use sim_core::camera::{Camera, Label, Picture, View};
use sim_core::{RobotId, camera::Still};

use super::{Reference, Sight};

/// What a camera's pictures of one view show.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Red, green, blue, a sample a pixel.
    pub colour: Picture<[u8; 3]>,
    /// Metres along the line of sight.
    pub depth: Picture<f32>,
    /// What is there.
    pub labels: Picture<Label>,
}

impl Shot {
    /// Of the core's camera.
    pub fn take(camera: &mut Camera, still: &Still, view: &View, by: Option<RobotId>) -> Self {
        Self {
            colour: camera.colour(still, view, by, 1),
            depth: camera.depth(still, view, by),
            labels: camera.labels(still, view, by),
        }
    }
}

/// How far pictures agree with the reference.
#[derive(Clone, Debug, Default)]
pub struct Agreement {
    /// Pixels that were compared.
    pub pixels: usize,
    /// Pixels that show something else than the reference in the pixel's middle: another label, a depth that is off by
    /// more than [`DEPTH`], or a colour that is off by more than a grey level.
    pub differing: usize,
    /// Those of them for which the reference shows it nowhere within [`NEAR`] of the middle, and that is no surface which lies in
    /// the one shown.
    pub wrong: Vec<Wrong>,
}

/// A pixel that is wrong.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// Its column and row.
    pub at: [u32; 2],
    /// Its colour, depth and label.
    pub found: ([u8; 3], f32, Label),
    /// What is there.
    pub truth: Sight,
}

/// How far from a pixel's middle, in pixels, the silhouette may be that it shows the wrong side of.
pub const NEAR: f64 = 0.01;
/// What a depth may be off, as a share of it.
pub const DEPTH: f64 = 1e-5;
/// What two depths differ by at most, as a share of them, of which rounding decides the nearer.
const RIVAL: f64 = 1e-6;

impl Agreement {
    /// Of these pictures with what there is to see, at each pixel.
    pub fn of(shot: &Shot, reference: &Reference, view: &View) -> Self {
        Self::of_some(shot, reference, view, 1)
    }

    /// The same, at every so manyth pixel.
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
            let steps = || [-NEAR, 0.0, NEAR].into_iter();
            let places = steps().flat_map(|x| steps().map(move |y| middle + DVec2::new(x, y)));
            let sights: Vec<Sight> = places.flat_map(|place| reference.sights(view, place, RIVAL)).collect();
            if !is_within(found, &sights) {
                agreement.wrong.push(Wrong { at, found, truth });
            }
        }
        agreement
    }

    /// Panics if a pixel is wrong.
    ///
    /// # Panics
    /// If so, naming `what` was compared and the first of the pixels.
    pub fn assert_right(&self, what: &str) {
        if let Some(wrong) = self.wrong.first() {
            panic!("{what}: {} of {} pixels are wrong: {wrong:?}", self.wrong.len(), self.pixels);
        }
    }

    /// Share of the pixels that differ.
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

/// Whether a pixel lies between these sights, give or take what counts as equal.
fn is_within((colour, depth, label): ([u8; 3], f32, Label), sights: &[Sight]) -> bool {
    let is_between = |value: f64, slack: f64, of: &dyn Fn(&Sight) -> f64| {
        let least = sights.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = sights.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
        value >= least - slack && value <= most + slack
    };
    let depth = f64::from(depth);
    let slack = if depth.is_finite() { DEPTH * depth } else { 0.0 };
    sights.iter().any(|sight| sight.label == label)
        && is_between(depth, slack, &|sight| sight.depth)
        && (0..3)
            .all(|channel| is_between(f64::from(colour[channel]), 1.0, &|sight| (sight.colour[channel] + 0.5).floor()))
}
