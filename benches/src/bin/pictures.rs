//! Renders pictures of the room for counters: `pictures WIDTHxHEIGHT none|exact REPEATS` renders the ten views of the
//! bench `camera` without shadows or with them, and prints the shortest time for a pixel and a hash of all pixels.
#![forbid(unsafe_code)]

use std::env;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::process::ExitCode;
use std::time::Instant;

use accuracy::{room, world};
use sim_core::camera::{Camera, Lens, Light, View};
use sim_core::time::Time;

const VIEWS: usize = 10;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let Some((size, shadows, repeats)) = parsed(&arguments) {
        render(size, shadows, repeats);
        return ExitCode::SUCCESS;
    }
    eprintln!("usage: pictures WIDTHxHEIGHT none|exact REPEATS");
    ExitCode::from(2)
}

fn parsed(arguments: &[String]) -> Option<([u32; 2], bool, usize)> {
    let [size, shadows, repeats] = arguments else { return None };
    let (width, height) = size.split_once('x')?;
    let shadows = ["none", "exact"].iter().position(|kind| kind == shadows)? == 1;
    Some(([width.parse().ok()?, height.parse().ok()?], shadows, repeats.parse().ok()?))
}

fn render(size: [u32; 2], shadows: bool, repeats: usize) {
    let scenery = room::scenery(Light { shadows, ..room::light() });
    let posed = scenery.pose_at(&world::empty(), Time::ZERO);
    let view = |stand: room::Stand| View::new(stand.pose(), Lens::Pinhole { fov: room::FIELD }, size).expect("a view");
    let views: Vec<View> = room::stands(VIEWS).into_iter().map(view).collect();
    let (mut camera, mut seconds, mut pictures) = (Camera::default(), f64::INFINITY, Vec::new());
    for _ in 0..repeats {
        let start = Instant::now();
        pictures = views.iter().map(|view| camera.colour(&posed, view, None, 1)).collect();
        seconds = seconds.min(start.elapsed().as_secs_f64());
    }
    let mut hash = DefaultHasher::new();
    pictures.iter().for_each(|picture| picture.pixels().as_flattened().hash(&mut hash));
    let pixels = VIEWS * size[0] as usize * size[1] as usize;
    println!("{:.2} ns a pixel, pixels {:016x}", 1e9 * seconds / pixels as f64, hash.finish());
}
