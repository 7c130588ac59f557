//! `camera`: pictures of a furnished room, compared with a reference that averages many samples over each pixel.

use sim_core::RobotId;
use sim_core::camera::{Camera, Lens, Light, PosedScenery, View};
use sim_core::noise::{ImageErrors, ImageNoise};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::camera::Reference;
use crate::room;
use crate::world;

pub const STUDY: Study = Study { name: "camera", title: "Pictures of a room, against their size and samples", run };

/// Width and height, and samples along a pixel's side.
const SETTINGS: [([u32; 2], u32); 6] =
    [([80, 60], 1), ([160, 120], 1), ([320, 240], 1), ([160, 120], 2), ([160, 120], 3), ([160, 120], 4)];
/// Numbers of pictures with noise, and samples along a pixel's side in each.
const WITH_NOISE: [(u64, u32); 5] = [(1, 1), (1, 4), (10, 4), (100, 1), (100, 4)];
/// Noise of a pixel in the preset `real`, without the blur of the lens, which the mean of many pictures does not
/// remove.
const NOISE: ImageNoise =
    ImageNoise { blur: 0.0, sigma: 4.0, salt_and_pepper: 0.000_5, salt: 0.5, hundreds_and_thousands: 0.0 };
const SEED: u64 = 264_000;
/// Number of views of the room.
const VIEWS: usize = 6;
/// Samples along a pixel's side for the reference.
const REFERENCE_SAMPLES: u32 = 12;
/// Maximum number of pixels compared per view.
const MAX_PIXELS: usize = 60;

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    for shadows in [false, true] {
        let scenery = room::scenery(Light { shadows, ..room::light() });
        let posed = scenery.pose_at(&world::empty(), Time::ZERO);
        let settings = SETTINGS.map(|setting| row(&posed, shadows, setting, effort));
        rows.extend(settings);
        rows.push(brute_force(&posed, shadows));
        if shadows {
            rows.extend(WITH_NOISE.map(|(count, samples)| noisy(&posed, count, samples)));
        }
    }
    rows.into()
}

fn method(name: &str, shadows: bool) -> String {
    format!("{name}, {} shadows", if shadows { "with" } else { "without" })
}

fn views(size: [u32; 2]) -> Vec<View> {
    let view = |stand: room::Stand| View::new(stand.pose(), Lens::Pinhole { fov: room::FIELD }, size);
    room::stands(VIEWS).into_iter().filter_map(|stand| view(stand).ok()).collect()
}

/// Columns and rows of the compared pixels, spread over the image. The rows are at equal intervals. From one row to the
/// next, the column changes by a step of about 0.618 of the width. Step and width are coprime, so that no column occurs
/// twice.
fn compared_pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let coprime = |step: &u32| {
        let (mut a, mut b) = (width, *step);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a == 1
    };
    let golden = f64::from(width) * 0.618_034;
    let step = (golden as u32..=width).find(coprime).unwrap_or(1);
    let count = (MAX_PIXELS as u32).min(width).min(height);
    (0..count).map(move |k| [(step / 2 + k * step) % width, (2 * k + 1) * height / (2 * count)])
}

/// Mean magnitude of the differences from the reference, over all channels of the compared pixels, in grey levels.
fn error(reference: &Reference, views: &[View], mut colour: impl FnMut(&View, [u32; 2]) -> [f64; 3]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for view in views {
        for pixel @ [column, row] in compared_pixels(view.size()) {
            let truth = reference.pixel(view, column, row, REFERENCE_SAMPLES).unwrap_or_default();
            let found = colour(view, pixel);
            sum += (0..3).map(|channel| (found[channel] - truth[channel]).abs()).sum::<f64>();
            count += 3.0;
        }
    }
    sum / count
}

fn row(posed: &PosedScenery, shadows: bool, (size, samples): ([u32; 2], u32), effort: Effort) -> Row {
    let [width, height] = size;
    let views = views(size);
    let mut camera = Camera::default();
    let time_ns = nanoseconds(effort.of(50), views.len(), || {
        views.iter().map(|view| u64::from(camera.colour(posed, view, None, samples).pixels()[0][0])).sum::<u64>()
    });
    let pictures: Vec<_> = views.iter().map(|view| camera.colour(posed, view, None, samples)).collect();
    let picture_of =
        |view: &View| views.iter().position(|other| other == view).map_or(&pictures[0], |index| &pictures[index]);
    let error = error(&Reference::new(posed, None), &views, |view, [column, row]| {
        picture_of(view).pixel(column, row).map(f64::from)
    });
    let samples = if samples == 1 { String::new() } else { format!(", {samples} x {samples} samples") };
    let setting = format!("{width} x {height}{samples}");
    Row {
        study: STUDY.name,
        method: method("camera", shadows),
        setting,
        error,
        unit: "grey levels",
        time_ns,
        per: "picture",
    }
}

/// Row for the mean of `count` pictures with shadows and noise.
fn noisy(posed: &PosedScenery, count: u64, samples: u32) -> Row {
    let size @ [width, height] = [160, 120];
    let views = views(size);
    let mut camera = Camera::default();
    let mut means: Vec<Vec<[f64; 3]>> = Vec::new();
    let time_ns = nanoseconds(1, views.len(), || {
        let mean = |(number, view)| {
            let exact = camera.colour(posed, view, None, samples);
            let errors = ImageErrors::new(NOISE, SEED + number as u64, RobotId(1), "CAMERA");
            let mut mean = vec![[0.0; 3]; exact.pixels().len()];
            for frame in 0..count {
                let mut picture = exact.pixels().to_vec();
                errors.expose(frame, width as usize, &mut picture);
                for (mean, pixel) in mean.iter_mut().zip(&picture) {
                    *mean = std::array::from_fn(|channel| mean[channel] + f64::from(pixel[channel]) / count as f64);
                }
            }
            mean
        };
        means = views.iter().enumerate().map(mean).collect();
    });
    let error = error(&Reference::new(posed, None), &views, |view, [column, row]| {
        let number = views.iter().position(|other| other == view).unwrap_or_default();
        means[number][(row * width + column) as usize]
    });
    let samples = if samples == 1 { String::new() } else { format!(", {samples} x {samples} samples") };
    let pictures = if count == 1 { String::new() } else { format!(", mean of {count}") };
    Row {
        study: STUDY.name,
        method: "camera, with shadows and noise".to_owned(),
        setting: format!("{width} x {height}{samples}{pictures}"),
        error,
        unit: "grey levels",
        time_ns,
        per: "picture",
    }
}

/// Row for brute force: one ray per pixel and another for shadows. Each is tested against all bounding spheres, and
/// against all faces in the spheres that it hits.
fn brute_force(posed: &PosedScenery, shadows: bool) -> Row {
    let size @ [width, height] = [160, 120];
    let (views, reference) = (views(size), Reference::new(posed, None));
    let pixel_colour = |view: &View, [column, row]: [u32; 2]| reference.pixel(view, column, row, 1).unwrap_or_default();
    let pixels: Vec<[u32; 2]> = compared_pixels(size).collect();
    let time_of_pixel = nanoseconds(1, pixels.len() * views.len(), || {
        views
            .iter()
            .flat_map(|view| pixels.iter().map(move |pixel| (view, *pixel)))
            .map(|(view, pixel)| pixel_colour(view, pixel)[0])
            .sum::<f64>()
    });
    Row {
        study: STUDY.name,
        method: method("all faces", shadows),
        setting: format!("{width} x {height}"),
        error: error(&reference, &views, pixel_colour),
        unit: "grey levels",
        time_ns: time_of_pixel * f64::from(width * height),
        per: "picture",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compared_pixels_are_spread_over_the_image() {
        for (size @ [width, height], _) in SETTINGS {
            let compared_pixels: Vec<[u32; 2]> = compared_pixels(size).collect();
            assert_eq!(compared_pixels.len(), MAX_PIXELS);
            // Each ninth of the image has a ninth of the pixels, within one or two.
            for (left, top) in (0..9).map(|ninth| (ninth % 3, ninth / 3)) {
                let is_in = |[x, y]: &&[u32; 2]| x * 3 / width == left && y * 3 / height == top;
                let count = compared_pixels.iter().filter(is_in).count();
                assert!((5..=8).contains(&count), "{size:?}: {count} at {left}, {top}");
            }
            let columns: std::collections::BTreeSet<u32> = compared_pixels.iter().map(|[x, _]| *x).collect();
            assert_eq!(columns.len(), MAX_PIXELS, "{size:?}");
        }
    }

    #[test]
    fn more_samples_reduce_the_error() {
        let rows = run(Effort::Quick).rows;
        assert_eq!(rows.len(), 14 + WITH_NOISE.len());
        let noisy: Vec<f64> = rows[14..].iter().map(|row| row.error).collect();
        // A normal error with a standard deviation of 4 levels has a mean magnitude of 3.2; the mean of a hundred
        // pictures is nearly the picture without noise.
        assert!(noisy[0] > 3.0 && noisy[1] > 3.0 && noisy[1] < 4.0, "{noisy:?}");
        assert!((noisy[3] - rows[8].error).abs() < 0.2 && noisy[4] < 0.6 && noisy[4] < noisy[2], "{noisy:?}");
        for rows in rows[..14].chunks(7) {
            let [one_sample, sixteen_samples, brute_force] = [1, 5, 6].map(|index| rows[index].error);
            assert!(sixteen_samples < 0.5 * one_sample, "{sixteen_samples} for {one_sample}");
            assert!((one_sample - brute_force).abs() < 0.5, "rounded to whole levels: {one_sample}, {brute_force}");
        }
    }
}
