//! Rendering of a room: frames per second, compared with MuJoCo and PyBullet if they are installed.
//!
//! This bench has its own harness instead of criterion: the renderers take turns within one run, and one table compares
//! them.
#![forbid(unsafe_code)]

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use std::{env, fs};

use accuracy::camera::{Agreement, Reference, Shot};
use accuracy::{room, world};
use sim_core::camera::{Camera, Lens, Light, PosedScenery, Scenery, View};
use sim_core::scene::Mesh;
use sim_core::time::Time;

const VIEWS: usize = 10;
const SIZES: [[u32; 2]; 3] = [[80, 60], [160, 120], [320, 240]];
/// Number of turns of each renderer; its fastest repetition in all turns counts.
const TURNS: usize = 3;
/// Number of repetitions of all views in a turn, after a first one.
const REPEATS: usize = 10;

/// A renderer with one kind of shadows, and its results.
struct Row {
    renderer: &'static str,
    /// Kind of shadows, an option of the peers' script.
    shadows: &'static str,
    /// Time for all views.
    seconds: f64,
    /// Mean difference of the renderer's pictures from ours, grey levels.
    difference: f64,
}

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let scenery_with = |shadows| room::scenery(Light { shadows, ..room::light() });
    let sceneries = [scenery_with(false), scenery_with(true)];
    if arguments.iter().any(|argument| argument == "--test") {
        sceneries.iter().for_each(assert_matches_reference);
        return;
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("camera");
    write_scene(&folder, &room::room());
    let python = env::var_os("CAMERA_PYTHON");
    if python.is_none() {
        println!("no peers: CAMERA_PYTHON names no Python with MuJoCo and PyBullet");
    }
    println!(
        "{:<10} {:<13} {:<8} {:>9} {:>14} {:>16}",
        "size", "renderer", "shadows", "frames/s", "eyesim/peer", "differs by"
    );
    for size in SIZES {
        for scenery in &sceneries {
            let posed = scenery.pose_at(&world::empty(), Time::ZERO);
            for row in rows(&folder, python.as_deref(), &posed, size) {
                print(size, &row);
            }
        }
    }
}

/// Prints a row with our speed-up over its renderer; `our_seconds` is our time for all views.
fn print([width, height]: [u32; 2], (row, our_seconds): &(Row, f64)) {
    let rate = VIEWS as f64 / row.seconds;
    let (speed_up, levels) = (row.seconds / our_seconds, row.difference);
    let size = format!("{width}x{height}");
    println!("{size:<10} {:<13} {:<8} {rate:>9.0} {speed_up:>14.2} {levels:>9.1} levels", row.renderer, row.shadows);
}

/// Measures our renderer (first row) and its peers; returns each row with our time for all views.
fn rows(folder: &Path, python: Option<&OsStr>, posed: &PosedScenery, size: [u32; 2]) -> Vec<(Row, f64)> {
    let peers: &[(&str, &str)] = if posed.scenery().light().shadows {
        &[("mujoco", "1024"), ("mujoco-boxes", "1024"), ("mujoco", "default"), ("pybullet", "default")]
    } else {
        &[("mujoco", "none"), ("mujoco-boxes", "none"), ("pybullet", "none")]
    };
    let shadows = if posed.scenery().light().shadows { "exact" } else { "none" };
    let row = |&(renderer, shadows)| Row { renderer, shadows, seconds: f64::INFINITY, difference: 0.0 };
    let mut rows: Vec<Row> = std::iter::once(&("eyesim", shadows)).chain(peers).map(row).collect();
    let mut ours = Vec::new();
    for _ in 0..TURNS {
        for row in &mut rows {
            let Some((seconds, pixels)) = (match (row.renderer, python) {
                ("eyesim", _) => Some(eyesim(posed, size)),
                (_, python) => python.map(|python| peer(python, folder, row, size)),
            }) else {
                continue;
            };
            row.seconds = row.seconds.min(seconds);
            if row.renderer == "eyesim" {
                ours.clone_from(&pixels);
            }
            let levels = pixels.iter().zip(&ours).map(|(one, other)| f64::from(one.abs_diff(*other)));
            row.difference = levels.sum::<f64>() / ours.len() as f64;
        }
    }
    fs::write(folder.join("eyesim.rgb"), &ours).expect("the target folder can be written");
    let our_seconds = rows[0].seconds;
    rows.into_iter().filter(|row| row.seconds.is_finite()).map(|row| (row, our_seconds)).collect()
}

fn views(size: [u32; 2]) -> Vec<View> {
    let view = |stand: room::Stand| View::new(stand.pose(), Lens::Pinhole { fov: room::FIELD }, size).expect("a view");
    room::stands(VIEWS).into_iter().map(view).collect()
}

/// Renders all views with the core; returns the seconds of the fastest repetition, and the pixels.
fn eyesim(posed: &PosedScenery, size: [u32; 2]) -> (f64, Vec<u8>) {
    let views = views(size);
    let mut camera = Camera::default();
    let mut seconds = f64::INFINITY;
    let mut pixels = Vec::new();
    // The first repetition warms up and does not count, as in the peers' script.
    for repetition in 0..=REPEATS {
        let start = Instant::now();
        let pictures: Vec<_> = views.iter().map(|view| camera.colour(posed, view, None, 1)).collect();
        if repetition > 0 {
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        pixels = pictures.iter().flat_map(|picture| picture.pixels().as_flattened()).copied().collect();
    }
    (seconds, pixels)
}

/// Renders all views with a peer, by the script in `peers/`; returns the same as [`eyesim`].
fn peer(python: &OsStr, folder: &Path, row: &Row, [width, height]: [u32; 2]) -> (f64, Vec<u8>) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/camera_peers.py");
    let output = Command::new(python)
        .args([script.as_os_str(), folder.as_os_str()])
        .args([row.renderer, &format!("{width}x{height}"), row.shadows, &REPEATS.to_string()])
        .output()
        .expect("CAMERA_PYTHON names a Python");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let seconds = text.lines().last().and_then(|line| line.trim().parse().ok()).expect("seconds");
    (seconds, fs::read(folder.join(row.renderer).with_extension("rgb")).expect("the script writes pictures"))
}

/// Writes the input of the peers' script.
fn write_scene(folder: &Path, mesh: &Mesh) {
    fs::create_dir_all(folder).expect("the target folder can be written");
    let faces = mesh.triangles.iter().flat_map(|triangle| {
        let corners = mesh.corners(triangle).into_iter().zip(triangle.uv.unwrap_or_default());
        let numbers = corners.flat_map(|(at, uv)| [at.x, at.y, at.z, f64::from(uv.x), f64::from(uv.y)]);
        std::iter::once(f64::from(triangle.material)).chain(numbers)
    });
    write(folder, "faces", faces);
    let views = room::stands(VIEWS).into_iter().flat_map(|stand| [stand.eye, stand.forward, stand.left]);
    write(folder, "views", views.flat_map(|vector| vector.to_array()));
    write(folder, "fov", [room::FIELD].into_iter());
    let light = room::light();
    write(folder, "light", light.sun_direction.to_array().into_iter().chain([light.ambient, light.diffuse]));
    for (number, material) in mesh.materials.iter().enumerate() {
        let texture = material.texture.as_ref().expect("all materials have a texture");
        let (width, height) = texture.size();
        let pixels = (0..width * height).flat_map(|index| texture.pixel(index % width, index / width));
        let file = folder.join(format!("texture{number}.rgba"));
        fs::write(file, pixels.collect::<Vec<u8>>()).expect("the target folder can be written");
    }
}

fn write(folder: &Path, name: &str, numbers: impl Iterator<Item = f64>) {
    let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
    fs::write(folder.join(name).with_extension("f64"), bytes).expect("the target folder can be written");
}

/// Smoke test: renders each view once in the smallest size, and compares every seventh pixel with the reference.
fn assert_matches_reference(scenery: &Scenery) {
    let posed = scenery.pose_at(&world::empty(), Time::ZERO);
    let reference = Reference::new(&posed, None);
    let mut camera = Camera::default();
    for view in views(SIZES[0]) {
        let shot = Shot::take(&mut camera, &posed, &view, None);
        Agreement::of_some(&shot, &reference, &view, 7).assert_right("room");
    }
    println!("camera, shadows {}: within a grey level", scenery.light().shadows);
}
