//! `shadow`: edges of shadows in pictures, with and without noise, compared with the projections of the true edges.
//!
//! A screen stands on grey ground, and cameras above the ground look down at the edge of its shadow. The truth is
//! geometry: the top edge of the screen, projected along the sun's rays onto the ground and then into the picture. In a
//! picture, the edge's position in a row (or column) is the sum of the pixels' dark fractions, computed from their grey
//! levels, so a half-covered pixel adds a half.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::camera::{Attachment, Camera, Ground, Label, Lens, Light, Part, PosedScenery, Scenery, Sky, View};
use sim_core::math;
use sim_core::noise::{ImageErrors, ImageNoise};
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Triangle};
use sim_core::time::Time;

use super::camera_noise::MODELS;
use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::room::FIELD;
use crate::world::{self, Random};

pub const STUDY: Study =
    Study { name: "shadow", title: "Edges of shadows in pictures with and without noise, against geometry", run };

/// Samples along a pixel's side, without noise.
const SAMPLES: [u32; 4] = [1, 2, 4, 8];
/// Samples along a pixel's side in pictures with noise.
const WITH_NOISE: u32 = 4;
/// Numbers of pictures with noise over which pixels are averaged.
const COUNTS: [u64; 3] = [1, 10, 100];
const SIZE: [u32; 2] = [80, 60];
const VIEWS: usize = 8;
const SEED: u64 = 264_002;
/// Number of pixels on each side of an edge from which its position is measured.
const WINDOW: f64 = 8.0;
/// Grey level of the ground under full light. Its levels in the sun (176) and in the shadow (80) are whole numbers.
const GREY: u8 = 200;
const LIGHT: Light =
    Light { sun_direction: DVec3::new(0.36, 0.48, 0.8), ambient: 0.4, fill: 0.0, diffuse: 0.6, shadows: true };
/// Height of the screen, which stands on the x axis, and half of its length, m.
const HEIGHT: f64 = 1.0;
const HALF_LENGTH: f64 = 20.0;

fn run(effort: Effort) -> Outcome {
    let scenery = scenery();
    let posed = scenery.pose_at(&world::empty(), Time::ZERO);
    let views = views();
    let mut rows: Vec<Row> = SAMPLES.iter().map(|samples| exact(&posed, &views, *samples, effort)).collect();
    for (name, model) in MODELS {
        rows.extend(COUNTS.map(|count| noisy(&posed, &views, name, model, count)));
    }
    rows.into()
}

fn scenery() -> Scenery {
    let [left, right] = [-HALF_LENGTH, HALF_LENGTH].map(|x| DVec3::new(x, 0.0, 0.0));
    let top = DVec3::new(0.0, 0.0, HEIGHT);
    let triangle = |corners| Triangle { corners, normals: None, uv: None, material: 0 };
    let mesh = Mesh {
        positions: vec![left, right, right + top, left + top],
        triangles: vec![triangle([0, 1, 2]), triangle([0, 2, 3])],
        materials: vec![Material { name: "screen".to_owned(), colour: [0.5; 3], opacity: 1.0, texture: None }],
    };
    let part = Part { mesh: Arc::new(mesh), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    let ground = Ground { colour: [GREY; 3], floor: None, spots: Vec::new() };
    Scenery::new(vec![part], Some(ground), LIGHT, Sky { horizon: [200, 210, 230], zenith: [90, 140, 220] })
}

/// Point of the shadow's edge: the shadow of the point at `x` m on the screen's top.
fn edge(x: f64) -> DVec3 {
    let top = DVec3::new(x, 0.0, HEIGHT);
    top - LIGHT.sun_direction * (HEIGHT / LIGHT.sun_direction.z)
}

/// Views of cameras 0.3 to 0.4 m above the ground that look steeply down at points of the edge from all sides.
fn views() -> Vec<View> {
    let mut random = Random::new(SEED);
    let mut view = || {
        let target = edge(random.between(-5.0, 5.0));
        let offset = random.direction() * random.between(0.02, 0.1);
        let position = target + offset.extend(random.between(0.3, 0.4));
        let pose = View::look_at(position, target).expect("two points");
        View::new(pose, Lens::Pinhole { fov: FIELD }, SIZE).expect("a view")
    };
    (0..VIEWS).map(|_| view()).collect()
}

/// The edge in a picture: its column as a linear function of the row, or its row as a linear function of the column if
/// `is_level`; both from the upper left corner.
#[derive(Clone, Copy, Debug)]
struct Line {
    is_level: bool,
    /// Value of the function at 0, pixels.
    start: f64,
    slope: f64,
    /// True if pixels of smaller index are in the shadow.
    is_dark_first: bool,
}

impl Line {
    /// Projects the edge through a pinhole camera.
    fn of(view: &View) -> Self {
        let [width, height] = view.size().map(f64::from);
        let focal = 0.5 * width / math::tan(0.5 * FIELD);
        let Pose3 { position, rotation } = *view.world_from_camera();
        let project = |point: DVec3| {
            let local = rotation.transpose() * (point - position);
            DVec2::new(0.5 * width - focal * local.y / local.x, 0.5 * height - focal * local.z / local.x)
        };
        // Two points of the edge, on both sides of the camera, and a point of the shadow 1 cm from the edge.
        let x = position.x - edge(0.0).x;
        let [a, b] = [x - 0.1, x + 0.1].map(|x| project(edge(x)));
        let dark = project(edge(x) + DVec3::new(0.0, 0.01, 0.0));
        let along = b - a;
        let is_level = along.x.abs() > along.y.abs();
        let [a, b, dark] = [a, b, dark].map(|point| if is_level { DVec2::new(point.y, point.x) } else { point });
        let slope = (b.x - a.x) / (b.y - a.y);
        let start = a.x - slope * a.y;
        Self { is_level, start, slope, is_dark_first: dark.x < start + slope * dark.y }
    }

    /// Position of the edge in row (or column) `index`, pixels.
    fn position(&self, index: u32) -> f64 {
        self.start + self.slope * (f64::from(index) + 0.5)
    }
}

/// Mean distance, in pixels, between the edges in pictures and their projections; `level` returns the grey level of a
/// view's pixel.
fn error(views: &[View], level: impl Fn(usize, [u32; 2]) -> f64) -> f64 {
    let [dark, bright] = [LIGHT.ambient, LIGHT.ambient + LIGHT.diffuse * LIGHT.sun_direction.z]
        .map(|brightness| brightness * f64::from(GREY));
    let (mut sum, mut count) = (0.0, 0.0);
    for (number, view) in views.iter().enumerate() {
        let line = Line::of(view);
        let [width, height] = view.size();
        let (across, along) = if line.is_level { (height, width) } else { (width, height) };
        for index in 0..along {
            let position = line.position(index);
            let (first, last) = ((position - WINDOW).floor(), (position + WINDOW).ceil());
            if first < 0.0 || last > f64::from(across) {
                continue;
            }
            let dark_fractions = (first as u32..last as u32).map(|coordinate| {
                let pixel = if line.is_level { [index, coordinate] } else { [coordinate, index] };
                (bright - level(number, pixel)) / (bright - dark)
            });
            let in_shadow: f64 = dark_fractions.sum();
            let found = if line.is_dark_first { first + in_shadow } else { last - in_shadow };
            sum += (found - position).abs();
            count += 1.0;
        }
    }
    sum / count
}

fn row(method: String, setting: String, error: f64, time_ns: f64) -> Row {
    Row { study: STUDY.name, method, setting, error, unit: "pixels", time_ns, per: "series of pictures" }
}

/// The edge in pictures without noise.
fn exact(posed: &PosedScenery, views: &[View], samples: u32, effort: Effort) -> Row {
    let mut camera = Camera::default();
    let time_ns = nanoseconds(effort.of(50), views.len(), || {
        views.iter().map(|view| u64::from(camera.colour(posed, view, None, samples).pixels()[0][0])).sum::<u64>()
    });
    let pictures: Vec<_> = views.iter().map(|view| camera.colour(posed, view, None, samples)).collect();
    let error = error(views, |number, [column, row]| f64::from(pictures[number].pixel(column, row)[1]));
    row("without noise".to_owned(), format!("{samples} x {samples} samples"), error, time_ns)
}

/// The edge in means of `count` pictures with noise.
fn noisy(posed: &PosedScenery, views: &[View], name: &str, model: ImageNoise, count: u64) -> Row {
    let width = SIZE[0] as usize;
    let mut camera = Camera::default();
    let mut means: Vec<Vec<f64>> = Vec::new();
    let time_ns = nanoseconds(1, views.len(), || {
        means = views
            .iter()
            .enumerate()
            .map(|(number, view)| {
                let exact = camera.colour(posed, view, None, WITH_NOISE);
                let errors = ImageErrors::new(model, SEED + number as u64, RobotId(1), "CAMERA");
                let mut mean = vec![0.0; exact.pixels().len()];
                for frame in 0..count {
                    let mut picture = exact.pixels().to_vec();
                    errors.expose(frame, width, &mut picture);
                    for (mean, pixel) in mean.iter_mut().zip(&picture) {
                        *mean += f64::from(pixel[1]) / count as f64;
                    }
                }
                mean
            })
            .collect();
    });
    let error = error(views, |number, [column, row]| means[number][row as usize * width + column as usize]);
    let pictures = if count == 1 { "1 picture".to_owned() } else { format!("mean of {count} pictures") };
    let setting = format!("{WITH_NOISE} x {WITH_NOISE} samples, {pictures}");
    row(format!("noise of `{name}`"), setting, error, time_ns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projected_edge_matches_rays() {
        for view in views() {
            let line = Line::of(&view);
            for index in [0, 20, 40] {
                let along = f64::from(index) + 0.5;
                let ground_point = |offset: f64| {
                    let across = line.position(index) + offset;
                    let point = if line.is_level { DVec2::new(along, across) } else { DVec2::new(across, along) };
                    let ray = view.direction(point).expect("a pinhole");
                    let origin = view.world_from_camera().position;
                    origin + ray * (origin.z / -ray.z)
                };
                // The edge is parallel to the screen, and the shadow lies between them.
                assert!((ground_point(0.0).y - edge(0.0).y).abs() < 1e-12, "{:?}", ground_point(0.0));
                let dark = if line.is_dark_first { -1.0 } else { 1.0 };
                assert!(ground_point(dark).y > edge(0.0).y && ground_point(-dark).y < edge(0.0).y);
            }
        }
    }

    #[test]
    fn measured_edge_matches_exact_areas() {
        // Pixels with exact areas, from 200 samples each; then with an edge moved by a quarter of a pixel.
        let views = views();
        let lines: Vec<Line> = views.iter().map(Line::of).collect();
        let mean_error = |shift: f64| {
            error(&views, |number, [column, row]| {
                let line = lines[number];
                let (coordinate, index) = if line.is_level { (row, column) } else { (column, row) };
                let cuts = (0..200)
                    .map(|part| line.start + shift + line.slope * (f64::from(index) + (f64::from(part) + 0.5) / 200.0));
                let below = cuts.map(|cut| (cut - f64::from(coordinate)).clamp(0.0, 1.0)).sum::<f64>() / 200.0;
                let dark = if line.is_dark_first { below } else { 1.0 - below };
                176.0 - 96.0 * dark
            })
        };
        assert!(mean_error(0.0) < 1e-9, "{}", mean_error(0.0));
        assert!((mean_error(0.25) - 0.25).abs() < 1e-9, "{}", mean_error(0.25));
    }

    #[test]
    fn more_samples_and_pictures_reduce_the_error() {
        let rows = run(Effort::Quick).rows;
        assert_eq!(rows.len(), SAMPLES.len() + MODELS.len() * COUNTS.len());
        let errors: Vec<f64> = rows.iter().map(|row| row.error).collect();
        // With one sample per pixel the error is at most half a pixel and a quarter on average; with s samples per side
        // it is at most an s-th of this.
        assert!(errors[0] < 0.3 && errors[3] < 0.04, "{errors:?}");
        assert!(errors[4..].chunks(3).all(|errors| errors[2] < 0.5 * errors[0] && errors[2] < 0.15), "{errors:?}");
    }
}
