//! The pictures of docs/camera.md equal the output of the page's commands.

use tests::{Scratch, root};

/// Maximum mean difference, in levels, of pictures that count as equal. A better filter or edge changes less; anything
/// that moves changes more.
const SAME: f64 = 0.5;

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn the_pictures_of_cameras_are_those_of_the_commands() {
    let page = std::fs::read_to_string(root().join("docs/camera.md")).expect("docs/camera.md");
    let mut count = 0;
    for line in page.lines().filter_map(|line| line.strip_prefix("eyesim shot sims/")) {
        let (scene, rest) = line.split_once(' ').expect("a scene and options");
        let (options, picture) = rest.split_once(" -o ").expect("a picture");
        let scene = root().join("sims").join(scene);
        let options: Vec<&str> = options.split_whitespace().collect();
        let scratch = Scratch::new();
        let arguments = [&["shot", scene.to_str().expect("text")], &options[..], &["-o", "a.png"]].concat();
        let ran = scratch.eyesim(&arguments);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        let open = |path| image::open(path).expect("a picture").into_rgb8();
        let (drawn, committed) = (open(scratch.path().join("a.png")), open(root().join(picture)));
        assert_eq!(drawn.dimensions(), committed.dimensions(), "{picture}");
        let difference: u64 = drawn.iter().zip(committed.iter()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = difference as f64 / drawn.len() as f64;
        assert!(mean < SAME, "`{picture}` differs by {mean} levels: write it again with `eyesim shot sims/{line}`");
        count += 1;
    }
    assert_eq!(count, 3);
}
