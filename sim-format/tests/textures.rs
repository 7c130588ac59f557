//! The images of floors in `worlds/textures`.

use std::path::Path;

#[allow(dead_code, reason = "the command itself is not called")]
#[path = "../examples/textures.rs"]
mod drawn;

#[test]
fn the_images_are_those_that_the_command_draws() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../worlds/textures");
    for (name, draw) in drawn::FLOORS {
        let committed = image::open(folder.join(name)).expect("an image").into_rgb8();
        assert!(
            committed == drawn::turned(&draw()),
            "write `{name}` again with `cargo run -p sim-format --example textures`"
        );
    }
}

#[test]
fn the_terrains_are_those_that_the_command_draws() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../worlds/textures");
    for (name, draw) in drawn::TERRAINS {
        let committed = image::open(folder.join(name)).expect("an image");
        assert!(matches!(committed, image::DynamicImage::ImageLuma16(_)), "`{name}` is grey, of 16 bits");
        assert!(
            committed.into_luma16() == draw(),
            "write `{name}` again with `cargo run -p sim-format --example textures`"
        );
    }
}

#[test]
fn a_robot_starts_on_the_line() {
    let start = glam::DVec2::new(1.5, 0.376);
    let nearest = drawn::track_line().into_iter().map(|point| point.distance(start)).fold(f64::INFINITY, f64::min);
    assert!(nearest < 0.001, "{nearest} m from the line");
}
