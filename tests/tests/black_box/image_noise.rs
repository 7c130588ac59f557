//! The pictures of docs/image-noise.md equal the output of the page's commands, and their noise is that of the
//! profiles.
//!
//! With `--nocapture` the test prints the table of the page.

use std::fs;
use std::path::Path;
use std::process::Command;

use image::RgbImage;
use tests::{Scratch, eyesim_path, root};

/// Names of the pictures in the order of the page; each is also the name of its profile.
const NAMES: [&str; 5] = ["none", "gaussian", "salt-and-pepper", "hundreds-and-thousands", "blur"];
/// Standard deviation in the profiles, in levels.
const SIGMA: f64 = 20.0;
/// Fraction of the pixels that impulse noise changes in the profiles.
const HITS: f64 = 0.05;

/// Writes the pictures like the page's first command.
fn write(folder: &Path) {
    for name in NAMES {
        let profile = format!("docs/image-noise/{name}.toml");
        let output = Command::new(eyesim_path())
            .args([
                "shot",
                "sims/image-noise.scene.toml",
                "--robot",
                "1",
                "--size",
                "200x150",
                "--noise",
                &profile,
                "-o",
            ])
            .arg(folder.join(format!("{name}.png")))
            .current_dir(root())
            .output()
            .expect("eyesim starts");
        assert!(output.status.success(), "{name}: {output:?}");
    }
}

fn read(folder: &Path, name: &str) -> RgbImage {
    image::open(folder.join(format!("{name}.png"))).unwrap_or_else(|error| panic!("{name}: {error}")).into_rgb8()
}

fn committed() -> std::path::PathBuf {
    root().join("docs/image-noise")
}

/// Difference of a picture from the original.
struct Statistics {
    /// Mean of the channels' differences, in levels.
    mean: f64,
    deviation: f64,
    /// Standard deviation over the channels whose original level is far from black and white, so that noise does not
    /// clip them.
    uncut: f64,
    /// Fraction of pixels that differ.
    changed: f64,
    white: f64,
    black: f64,
}

impl Statistics {
    fn new(original: &RgbImage, picture: &RgbImage) -> Self {
        assert_eq!(original.dimensions(), picture.dimensions());
        let differences = |is_taken: &dyn Fn(u8) -> bool| -> Vec<f64> {
            let levels = original.as_raw().iter().zip(picture.as_raw());
            levels.filter(|(from, _)| is_taken(**from)).map(|(from, to)| f64::from(*to) - f64::from(*from)).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let deviation = |values: &[f64]| {
            let mean = mean(values);
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
        };
        let pixels = original.width() * original.height();
        let fraction = |is_counted: &dyn Fn([u8; 3], [u8; 3]) -> bool| {
            let count = original.pixels().zip(picture.pixels()).filter(|(from, to)| is_counted(from.0, to.0)).count();
            count as f64 / f64::from(pixels)
        };
        let all = differences(&|_| true);
        let clear = (4.0 * SIGMA) as u8;
        Self {
            mean: mean(&all),
            deviation: deviation(&all),
            uncut: deviation(&differences(&|level| (clear..=255 - clear).contains(&level))),
            changed: fraction(&|from, to| from != to),
            white: fraction(&|_, to| to == [255; 3]),
            black: fraction(&|_, to| to == [0; 3]),
        }
    }

    /// Row of the picture in the table of the page.
    fn row(&self, name: &str) -> String {
        let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);
        let Self { mean, deviation, uncut, changed, white, black } = self;
        format!(
            "| `{name}` | {mean:.2} | {deviation:.2} | {uncut:.2} | {} | {} | {} |",
            percent(*changed),
            percent(*white),
            percent(*black)
        )
    }
}

#[test]
fn the_pictures_are_those_that_the_command_writes() {
    let scratch = Scratch::new();
    write(scratch.path());
    for name in NAMES {
        let is_same = fs::read(scratch.path().join(format!("{name}.png"))).expect("a picture")
            == fs::read(committed().join(format!("{name}.png"))).expect("a picture of the page");
        assert!(is_same, "{name}.png: write it again with the command in docs/image-noise.md");
    }
}

#[test]
fn the_table_of_the_page_matches_the_pictures() {
    let page = fs::read_to_string(root().join("docs/image-noise.md")).expect("a page");
    let original = read(&committed(), "none");
    let rows = NAMES.map(|name| Statistics::new(&original, &read(&committed(), name)).row(name));
    println!("{}", rows.join("\n"));
    for row in rows {
        assert!(page.contains(&row), "docs/image-noise.md should say:\n{row}");
    }
}

/// Asserts that a value is within four standard errors of the profile's value.
#[track_caller]
fn assert_near(found: f64, said: f64, standard_error: f64) {
    assert!((found - said).abs() < 4.0 * standard_error, "{found}, said is {said}, standard error {standard_error}");
}

#[test]
fn the_noise_of_the_images_matches_the_profiles() {
    let original = read(&committed(), "none");
    let of = |name| Statistics::new(&original, &read(&committed(), name));
    let pixels = f64::from(original.width() * original.height());
    let error = |fraction: f64| (fraction * (1.0 - fraction) / pixels).sqrt();

    let gaussian = of("gaussian");
    // Rounding adds 1/12 to the variance. At least half of the channels are not clipped.
    assert_near(gaussian.uncut, (SIGMA * SIGMA + 1.0 / 12.0).sqrt(), SIGMA / (1.5 * pixels * 2.0).sqrt());

    // No original pixel is completely white or black, so every changed pixel is counted.
    let exact = of("none");
    assert_eq!([exact.changed, exact.white, exact.black, exact.mean, exact.deviation], [0.0; 5]);
    let impulses = of("salt-and-pepper");
    assert_near(impulses.white, HITS / 2.0, error(HITS / 2.0));
    assert_near(impulses.black, HITS / 2.0, error(HITS / 2.0));
    assert_eq!(impulses.changed, impulses.white + impulses.black, "all others are as they were");

    assert_near(of("hundreds-and-thousands").changed, HITS, error(HITS));

    // A blur moves light but creates none; only at the picture's edges light is lost or added.
    let blur = of("blur");
    assert!(blur.mean.abs() < 0.5 && blur.deviation > 1.0, "{}, {}", blur.mean, blur.deviation);
}
