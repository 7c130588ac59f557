//! `eyesim plot` draws pictures of files.

use std::path::Path;

use tests::{Ran, Scratch, root, write_scene};

/// Draws `file` in the folder of `scratch` as `picture`.
fn plot(scratch: &Scratch, file: &str, picture: &str, more: &[&str]) -> Ran {
    let mut args = vec!["plot", file, "-o", picture];
    args.extend(more);
    scratch.eyesim(&args)
}

/// Number of elements of an SVG that contain `text`.
fn count(svg: &str, text: &str) -> usize {
    svg.split('<').filter(|element| element.contains(text)).count()
}

/// Width and height in the header of a PNG.
fn png_size(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).expect("a picture");
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    (number(16), number(20))
}

#[test]
fn a_sim_is_drawn_with_walls_robots_beams_and_programs() {
    let scratch = Scratch::new();
    write_scene(&scratch, &["drive.c", "folder/wait.c", "drive.c"]);
    let ran = plot(&scratch, "scene.sim", "scene.svg", &[]);
    assert_eq!((ran.code, ran.stdout.as_str(), ran.stderr.as_str()), (Some(0), "", ""), "programs are not looked for");
    let svg = scratch.read("scene.svg");
    assert_eq!(count(&svg, "stroke=\"#333333\" stroke-width=\"8\""), 4 + 1, "walls, and one in the legend");
    for (colour, name) in [("#0072B2", "r1 Bot drive.c"), ("#D55E00", "r2 Bot wait.c"), ("#009E73", "r3 Bot drive.c")] {
        // The body and its outline appear twice: in the world and in the legend.
        assert_eq!(count(&svg, &format!("fill=\"{colour}\" stroke=\"none\"")), 2, "{name}");
        assert!(svg.contains(&format!("\n{name}\n")), "{name}");
    }
    for word in ["r1", "r2", "r3", "scene.sim: 4.00 m x 4.00 m, 4 walls", "PSD, up to its range", "0.5 m"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
}

#[test]
fn pictures_are_to_scale_and_have_the_requested_size() {
    let scratch = Scratch::new();
    // A long corridor; one wall has a thickness and a colour.
    scratch.write("hall.wld", "floor 12000 2000\n0 0 12000 0\n0 0 0 2000\n3000 500 5000 500 400 200 200 30 30\n");
    assert_eq!(plot(&scratch, "hall.wld", "hall.svg", &["--size", "1400x700", "--title", "A <hall>"]).code, Some(0));
    let svg = scratch.read("hall.svg");
    assert!(svg.starts_with("<svg width=\"1400\" height=\"700\""), "{}", &svg[..80]);
    assert!(svg.contains("\nA &lt;hall&gt;\n"));
    let length = |line: &str| {
        let list = line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("points");
        let numbers: Vec<f64> = list.split([',', ' ']).filter_map(|word| word.parse().ok()).collect();
        ((numbers[2] - numbers[0]).powi(2) + (numbers[3] - numbers[1]).powi(2)).sqrt()
    };
    let walls: Vec<f64> = svg
        .split('<')
        .filter(|element| element.contains("stroke=\"#333333\" stroke-width=\"8\""))
        .map(length)
        .collect();
    // The walls are 12 m and 2 m long. The last one is in the legend. Two units are half a pixel.
    assert!((walls[0] - 6.0 * walls[1]).abs() <= 12.0, "{walls:?}");
    let thick = svg.split('<').find(|element| element.contains("fill=\"#C81E1E\"")).expect("the red wall");
    let sides = length(thick);
    let scale = walls[0] / 12.0;
    assert!((sides - 2.0 * scale).abs() <= 3.0 || (sides - 0.4 * scale).abs() <= 3.0, "{sides} units, {scale} a metre");

    assert_eq!(plot(&scratch, "hall.wld", "hall.png", &["--size", "1400x700"]).code, Some(0));
    assert_eq!(png_size(&scratch.path().join("hall.png")), (1400, 700));
    // The default picture of a corridor is long.
    assert_eq!(plot(&scratch, "hall.wld", "long.png", &[]).code, Some(0));
    let (width, height) = png_size(&scratch.path().join("long.png"));
    assert!(width > 2 * height, "{width} x {height}");
}

#[test]
fn an_image_on_the_floor_and_a_mesh_are_shown() {
    let scratch = Scratch::new();
    // A BMP file of one red pixel.
    let mut bmp =
        b"BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x18\0\0\0\0\0\x04\0\0\0".to_vec();
    bmp.extend([0; 16]);
    bmp.extend([0, 0, 255, 0]);
    std::fs::write(scratch.path().join("Red.bmp"), bmp).expect("an image");
    scratch.write("red.wld", "floor 1000 1000\nfloor_texture red.bmp\n");
    let ran = plot(&scratch, "red.wld", "red.svg", &[]);
    assert_eq!(ran.code, Some(0));
    assert!(ran.stderr.contains("file-case"), "{}", ran.stderr);
    assert_eq!(count(&scratch.read("red.svg"), "image x="), 1);

    scratch.write("box.obj", "v -1 0 -2\nv 1 0 -2\nv 1 0 2\nv -1 0 2\nf 1 2 3 4\n");
    scratch.write("box.esObj", "obj box.obj\nname Tub\nscale 0.1\ncollider sphere 0 0 0 1000\n");
    let ran = plot(&scratch, "box.esObj", "box.svg", &[]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let svg = scratch.read("box.svg");
    assert!(svg.contains("\nTub\n") && svg.contains("\noutline of a mesh\n"), "{svg}");
}

#[test]
fn mistakes_are_reported_and_the_rest_is_drawn() {
    let scratch = Scratch::new();
    scratch.write("a.wld", "floor 1000 1000\n0 0 1000 0\nush 1 2 3\n");
    let ran = plot(&scratch, "a.wld", "a.svg", &[]);
    assert_eq!(ran.code, Some(0), "a warning");
    assert!(ran.stderr.contains("wld-keyword") && ran.stderr.contains("a.wld"), "{}", ran.stderr);
    scratch.write("a.sim", "world a.wld\nrobi none.robi p.c 500 500 0\n");
    let ran = plot(&scratch, "a.sim", "b.svg", &[]);
    assert_eq!(ran.code, Some(2), "an error");
    assert!(ran.stderr.contains("file-missing"), "{}", ran.stderr);
    assert!(scratch.read("b.svg").contains("a.sim: 1.00 m x 1.00 m, 1 wall\n"), "what could be read is drawn");
}

#[test]
fn invalid_requests_are_reported() {
    let scratch = Scratch::new();
    scratch.write("a.wld", "floor 1000 1000\n");
    scratch.write("a.svg.wld", "floor 1000 1000\n");
    let says = |file: &str, picture: &str, more: &[&str], words: &[&str]| {
        let ran = plot(&scratch, file, picture, more);
        assert_eq!(ran.code, Some(2), "{file} {picture}: {ran:#?}");
        for word in words {
            assert!(ran.stderr.contains(word), "{file} {picture}: `{word}` in {}", ran.stderr);
        }
    };
    says("a.wld", "a.pdf", &[], &["a.pdf", ".svg or .png"]);
    says("a.wld", "none/a.svg", &[], &["there is no folder `none`"]);
    says("a.wld", "a.svg", &["--size", "10x10"], &["1200x900"]);
    says("b.wld", "b.svg", &[], &["b.wld", "file-missing"]);
    says("a.doc", "b.svg", &[], &["a.doc", ".robi"]);
    assert!(!scratch.path().join("b.svg").exists(), "nothing is written where there is nothing to draw");
    // The input may be an image.
    scratch.write("t.wld", "floor 1000 1000\nfloor_texture t.png\n");
    std::fs::write(scratch.path().join("t.png"), b"no image").expect("a file");
    says("t.wld", "t.png", &[], &["would overwrite the input"]);
    assert_eq!(scratch.read("t.png"), "no image");
}

#[test]
fn every_data_file_can_be_drawn() {
    let scratch = Scratch::new();
    let mut drawn = 0;
    for folder in ["sims", "worlds", "robis"] {
        for entry in std::fs::read_dir(root().join(folder)).expect("a folder of data") {
            let path = entry.expect("an entry").path();
            let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
            if !["sim", "wld", "maz", "robi", "esObj"].contains(&extension.as_str()) {
                continue;
            }
            let ran = plot(&scratch, &path.to_string_lossy(), "picture.svg", &[]);
            assert_eq!(ran.code, Some(0), "{}: {}", path.display(), ran.stderr);
            drawn += 1;
        }
    }
    assert!(drawn > 20, "{drawn} pictures");
}

#[test]
fn a_real_building_has_all_its_walls() {
    let world = root().join("../shared/eyesim/corpus/vr-2018/Test Assets/worlds/worlds/uwa-ee4.wld");
    if !world.is_file() {
        eprintln!("skipped: no corpus at {}", world.display());
        return;
    }
    let scratch = Scratch::new();
    assert_eq!(plot(&scratch, &world.to_string_lossy(), "uwa.svg", &[]).code, Some(0));
    let svg = scratch.read("uwa.svg");
    assert_eq!(count(&svg, "stroke=\"#333333\" stroke-width=\"8\""), 443 + 1);
    assert!(svg.contains("443 walls\n"));
}
