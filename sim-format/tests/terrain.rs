//! Terrain, from a scene to the readings of sensors.

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::DVec3;
use image::{DynamicImage, GrayImage, ImageFormat, Luma, RgbImage};
use sim_core::RobotId;
use sim_core::build;
use sim_core::contact::Thing;
use sim_core::scene::HeightField;
use sim_core::time::Time;
use sim_core::world::{Ray, World};
use sim_format::{FileError, Files, Loaded, Severity, load_scene};

struct Folder(BTreeMap<String, Vec<u8>>);

impl Files for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        self.0.get(path).cloned().ok_or(FileError::Missing)
    }

    fn list(&self, _: &str) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).expect("an image");
    bytes.into_inner()
}

/// Loads a world of 4 m by 3 m with this terrain.
fn with_image(terrain: &str, image: Vec<u8>) -> Loaded {
    let text = format!("[world]\nfloor_mm = [4000, 3000]\nterrain = {{ {terrain} }}\n");
    let files = [("a.scene.toml".to_owned(), text.into_bytes()), ("a.png".to_owned(), image)];
    load_scene("a.scene.toml", &Folder(files.into()))
}

fn with(terrain: &str) -> Loaded {
    with_image(terrain, Vec::new())
}

fn field(loaded: &Loaded) -> &HeightField {
    let codes = codes(loaded);
    build::height_field(&loaded.scene.world).unwrap_or_else(|| panic!("a field, but {codes:?}"))
}

/// Codes of the diagnostics except for the missing robot, errors in capitals.
fn codes(loaded: &Loaded) -> Vec<String> {
    let reported = loaded.diagnostics.iter().filter(|diagnostic| diagnostic.code.name() != "sim-robot-missing");
    reported
        .map(|diagnostic| match diagnostic.severity {
            Severity::Error => diagnostic.code.name().to_uppercase(),
            Severity::Warning => diagnostic.code.name().to_owned(),
        })
        .collect()
}

#[test]
fn rays_hit_the_terrain_at_the_height_of_its_field() {
    let loaded = with(
        "function = \"boulders\", seed = 9, relief_mm = 300, boulders = 20, \
         clear = [{ x_mm = 500, y_mm = 500, radius_mm = 300 }]",
    );
    assert_eq!(codes(&loaded), [""; 0]);
    let field = field(&loaded);
    let world = World::new(build::obstacles(&loaded.scene), Time::from_millis(10), []);
    let world = world.with_space(build::space(&loaded.scene));
    for step in 0..400 {
        let (x, y) = (0.0051 + 3.987 * f64::from(step) / 400.0, 0.0037 + 2.981 * f64::from(step * 37 % 400) / 400.0);
        let down =
            world.cast(RobotId(1), &Ray::new(DVec3::new(x, y, 3.0), DVec3::NEG_Z, 10.0), Time::ZERO).expect("ground");
        assert!((3.0 - down.distance - field.height(x, y)).abs() < 1e-9, "at {x}, {y}");
        assert!(down.face.expect("a face").normal.distance(field.normal(x, y)) < 1e-9, "at {x}, {y}");
        assert_eq!(down.thing, Thing::Fixed(0));
    }
    assert_eq!(field.height(0.5, 0.5), 0.0);
    assert!(field.height_bounds().1 > 0.3);
}

#[test]
fn heights_of_images_of_8_and_16_bits_are_proportional_to_brightness() {
    let terrain = "image = \"a.png\", offset_mm = [1000, 0, 100], size_mm = [2000, 3000], height_mm = 510";
    let mut grey = GrayImage::new(3, 2);
    for (column, row, shade) in [(0, 0, 255), (1, 0, 100), (2, 1, 1)] {
        grey.put_pixel(column, row, Luma([shade]));
    }
    let of_8 = with_image(terrain, png(grey.clone()));
    assert_eq!(codes(&of_8), [""; 0]);
    let heights = [(1.0, 3.0, 0.61), (2.0, 3.0, 0.3), (3.0, 0.0, 0.102), (1.0, 0.0, 0.1), (9.0, -9.0, 0.102)];
    for (x, y, height) in heights {
        assert!((field(&of_8).height(x, y) - height).abs() < 1e-12, "at {x}, {y}: {}", field(&of_8).height(x, y));
    }
    let of_16 = with_image(terrain, png(DynamicImage::from(grey).into_luma16()));
    assert_eq!(field(&of_16), field(&of_8), "257 times 8 bits are 16");
    let mut fine = image::ImageBuffer::<Luma<u16>, Vec<u16>>::new(2, 2);
    fine.put_pixel(0, 1, Luma([1]));
    let fine = with_image(terrain, png(fine));
    assert!((field(&fine).height(1.0, 0.0) - 0.1 - 0.51 / 65535.0).abs() < 1e-15);
}

#[test]
fn colour_images_give_their_brightness_as_height_with_a_warning() {
    let mut image = RgbImage::new(2, 2);
    image.put_pixel(0, 1, image::Rgb([255, 0, 0]));
    let red = with_image("image = \"a.png\", height_mm = 1000", png(image));
    assert_eq!(codes(&red), ["terrain-colour"]);
    assert!((field(&red).height(0.0, 0.0) - 0.2126).abs() < 1e-5);
    let mut image = RgbImage::new(2, 2);
    image.put_pixel(0, 1, image::Rgb([51; 3]));
    let grey = with_image("image = \"a.png\", height_mm = 1000", png(image));
    assert_eq!(codes(&grey), [""; 0], "three equal channels are grey");
    assert!((field(&grey).height(0.0, 0.0) - 0.2).abs() < 1e-12);
}

#[test]
fn invalid_terrains_are_reported() {
    let image = "image = \"a.png\", height_mm = 100";
    let grey = |width, height| png(GrayImage::new(width, height));
    let broken = grey(9, 9)[..30].to_vec();
    let cases = [
        (with_image(image, grey(1, 1)), "TERRAIN-SIZE"),
        (with_image(image, grey(1, 9)), "TERRAIN-SIZE"),
        (with_image(image, grey(1100, 1100)), "TERRAIN-SIZE"),
        (with_image(image, Vec::new()), "TERRAIN-IMAGE"),
        (with_image(image, broken), "TERRAIN-IMAGE"),
        (with_image(image, b"no image".to_vec()), "TERRAIN-IMAGE"),
        (with("image = \"b.png\", height_mm = 100"), "FILE-MISSING"),
        (with("image = \"a.png\""), "TOML-MISSING"),
        (with("image = \"a.png\", height_mm = nan"), "NUMBER-RANGE"),
        (with("function = \"hills\", size_mm = [0, 100]"), "NUMBER-RANGE"),
        (with("function = \"hills\", size_mm = [inf, 100]"), "NUMBER-RANGE"),
        (with("function = \"hills\", size_mm = [1e9, 1e9]"), "TERRAIN-SIZE"),
        (with("function = \"hills\", seed = -1"), "NUMBER-RANGE"),
        (with("function = \"hills\", boulders = 3"), "TOML-CONFLICT"),
        (with("function = \"hill\""), "TOML-CHOICE"),
        (with("function = \"boulders\", radius_mm = [200, 100]"), "NUMBER-RANGE"),
        (with("function = \"hills\", image = \"a.png\""), "TOML-CONFLICT"),
        (
            with("stairs = [{ from_mm = [0, 0], count = 0, step_height_mm = 1, step_depth_mm = 1, width_mm = 1 }]"),
            "NUMBER-RANGE",
        ),
        (
            with(
                "stairs = [{ from_mm = [0, 0], direction_deg = 45, count = 1, step_height_mm = 1, step_depth_mm = 1, width_mm = 1 }]",
            ),
            "NUMBER-RANGE",
        ),
        (with("block = [{ from_mm = [0, 0], to_mm = [0, 100], height_mm = 100 }]"), "NUMBER-RANGE"),
        (with("offset_mm = [0, 0, 0]"), "TOML-MISSING"),
    ];
    for (number, (loaded, code)) in cases.iter().enumerate() {
        assert_eq!(codes(loaded), [*code], "case {number}: {:#?}", loaded.diagnostics);
        assert!(loaded.diagnostics.iter().any(|diagnostic| diagnostic.span.line == 3), "case {number}");
    }
}

#[test]
fn seeds_go_from_0_to_2_to_the_63_minus_1() {
    let of_seed = |seed: &str| with(&format!("function = \"boulders\", {seed}cell_mm = 100"));
    let [none, zero, one, last] = ["", "seed = 0, ", "seed = 1, ", "seed = 9223372036854775807, "].map(of_seed);
    assert_eq!(field(&none), field(&zero));
    assert_ne!(field(&zero), field(&one));
    assert_ne!(field(&last), field(&one));
    assert_eq!(codes(&of_seed("seed = 9223372036854775808, ")), ["NUMBER-RANGE"]);
}

#[test]
fn robots_on_wheels_that_start_on_rough_ground_are_warned_about_once() {
    let text = |radius: u32| {
        format!(
            "[world]\nfloor_mm = [4000, 3000]\n\
             terrain = {{ function = \"hills\", clear = [{{ x_mm = 1000, y_mm = 1000, radius_mm = {radius} }}] }}\n\
             [[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 1000\n\
             [[robot]]\ntype = \"S4\"\nx_mm = 1300\ny_mm = 1000\n"
        )
    };
    let of =
        |radius| codes(&load_scene("a.scene.toml", &Folder([("a.scene.toml".to_owned(), text(radius).into())].into())));
    assert_eq!(of(10), ["terrain-wheels"]);
    assert_eq!(of(200), ["terrain-wheels"]);
    assert_eq!(of(500), [""; 0]);
}
