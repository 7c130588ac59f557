//! Rays among triangles and walls: speed and error of both indices in one table, compared with parry and, if it is
//! installed, Embree.
//!
//! A custom harness: one table contains all values to compare, measured within one run.
#![forbid(unsafe_code)]

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use std::{env, fs};

use accuracy::{oracle, world};
use benches::terrain::{self, Ray3, Triangle};
use glam::DVec3;
use sim_core::scene::{MeshIndex, Segment, Walls};

/// Number of repetitions of each set of rays. The fastest counts, since other load on the machine can only slow it
/// down.
const REPEATS: usize = 15;

/// A scene, sets of rays, and the distances of some of the rays by brute force.
struct Scene {
    name: &'static str,
    triangles: Vec<Triangle>,
    /// The walls from which the triangles are extruded; empty if there are none.
    walls: Vec<Segment>,
    sets: Vec<Set>,
    /// Rays aimed at shared edges; a ray without a hit has leaked.
    edges: Vec<Ray3>,
}

struct Set {
    name: &'static str,
    rays: Vec<Ray3>,
    /// Index of a ray and its distance by brute force, infinite without a hit.
    truth: Vec<(usize, f64)>,
}

/// Casts a list of rays repeatedly. Returns the seconds, as the sum of the minimum for each part of the list, and the
/// distances, infinite without a hit.
type Caster<'a> = Box<dyn Fn(&[Ray3], usize) -> (f64, Vec<f64>) + 'a>;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let is_smoke_test = arguments.iter().any(|argument| argument == "--test");
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    for scene in scenes(is_smoke_test) {
        println!("{}: {} triangles", scene.name, scene.triangles.len());
        let start = Instant::now();
        let index = MeshIndex::new(&scene.triangles);
        println!("  index built in {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
        let eyesim = |ray: &Ray3| index.cast(ray.origin, ray.direction, ray.range).map(|hit| hit.distance);
        let walls = Walls::new(scene.walls.clone());
        let eyesim_2d = |ray: &Ray3| {
            let hit = walls.cast(ray.origin.truncate(), ray.direction.truncate(), ray.range);
            hit.map(|hit| hit.distance)
        };
        if is_smoke_test {
            assert_errors(&scene, &timed(eyesim));
            if !walls.is_empty() {
                assert_errors(&scene, &timed(eyesim_2d));
            }
            continue;
        }
        let mut casters: Vec<(&str, Caster)> = vec![
            ("eyesim", timed(eyesim)),
            ("parry3d", timed(single_precision(&scene.triangles))),
            ("parry3d-f64", timed(double_precision(&scene.triangles))),
        ];
        if let Some(python) = env::var_os("EMBREE_PYTHON") {
            casters.insert(1, ("embree", embree(&scene.triangles, python.clone(), "fast")));
            casters.insert(2, ("embree-robust", embree(&scene.triangles, python, "robust")));
        }
        if !walls.is_empty() {
            casters.insert(0, ("eyesim 2D", timed(eyesim_2d)));
            casters.push(("brute force", timed(brute_force(&scene.walls))));
        }
        casters.retain(|(name, _)| filter.is_none_or(|filter| name.contains(filter.as_str())));
        println!("  {:<12} {:<13} {:>9} {:>10} {:>15}", "rays", "caster", "Mrays/s", "error, m", "lost or found");
        for set in &scene.sets {
            for (name, caster) in &casters {
                let (seconds, distances) = caster(&set.rays, REPEATS);
                let rate = set.rays.len() as f64 / seconds / 1e6;
                let (lost, error) = errors(set, &distances);
                println!(
                    "  {:<12} {name:<13} {rate:>9.2} {error:>10.1e} {lost:>6} of {:>5}",
                    set.name,
                    set.truth.len()
                );
            }
        }
        for (name, caster) in casters.iter().filter(|_| !scene.edges.is_empty()) {
            let percent = 100.0 * leaks(&scene, caster) as f64 / scene.edges.len() as f64;
            println!("  {:<12} {name:<13} {percent:>8.3} % of {} leak", "edges", scene.edges.len());
        }
    }
}

fn scenes(is_smoke_test: bool) -> Vec<Scene> {
    let thinned = |rays: Vec<Ray3>| {
        let step = if is_smoke_test { 1000 } else { 1 };
        rays.into_iter().step_by(step).collect::<Vec<_>>()
    };
    let hills = terrain::terrain();
    let sets = terrain::terrain_rays()
        .into_iter()
        .map(|(name, rays)| Set::new(name, &hills, thinned(rays), if is_smoke_test { 20 } else { 250 }))
        .collect();
    let edges = terrain::edge_rays(if is_smoke_test { 1000 } else { 200_000 });
    let walls = benches::walls();
    let triangles = world::extruded(&walls);
    let level = |rays: &[benches::Ray]| thinned(terrain::level_rays(rays));
    let wall_sets = vec![
        Set::new("psd", &triangles, level(&benches::psd_rays(100_000)), 20),
        Set::new("lidar", &triangles, level(&benches::lidar_rays(280)), 20),
    ];
    let maze = benches::maze();
    let diagonals = terrain::diagonal_rays(&maze, if is_smoke_test { 1000 } else { 200_000 });
    let maze = world::extruded(&maze);
    vec![
        Scene { name: "terrain", triangles: hills, walls: Vec::new(), sets, edges },
        Scene { name: "300 walls, extruded", triangles, walls, sets: wall_sets, edges: Vec::new() },
        Scene {
            name: "maze on a grid, extruded",
            triangles: maze,
            walls: Vec::new(),
            sets: Vec::new(),
            edges: diagonals,
        },
    ]
}

impl Set {
    fn new(name: &'static str, triangles: &[Triangle], rays: Vec<Ray3>, step: usize) -> Self {
        let truth = (0..rays.len())
            .step_by(step)
            .map(|at| {
                let Ray3 { origin, direction, range } = rays[at];
                let hit = oracle::nearest_triangle(triangles, origin, direction, range, 0.0);
                (at, hit.map_or(f64::INFINITY, |(metres, _)| metres))
            })
            .collect();
        Self { name, rays, truth }
    }
}

/// Number of rays that are timed together: few enough that other programs seldom interrupt them.
const CHUNK: usize = 4000;

fn timed<'a>(cast: impl Fn(&Ray3) -> Option<f64> + 'a) -> Caster<'a> {
    Box::new(move |rays, repeats| {
        let mut distances = vec![f64::INFINITY; rays.len()];
        let mut seconds = 0.0;
        for (rays, distances) in rays.chunks(CHUNK).zip(distances.chunks_mut(CHUNK)) {
            let mut fastest = f64::INFINITY;
            for _ in 0..repeats {
                let start = Instant::now();
                for (ray, distance) in rays.iter().zip(&mut *distances) {
                    *distance = cast(ray).unwrap_or(f64::INFINITY);
                }
                fastest = fastest.min(start.elapsed().as_secs_f64());
            }
            seconds += fastest;
        }
        (seconds, distances)
    })
}

/// Tests each wall in double precision, by Cramer's rule.
fn brute_force(walls: &[Segment]) -> impl Fn(&Ray3) -> Option<f64> {
    |ray| {
        let (origin, direction) = (ray.origin.truncate(), ray.direction.truncate());
        oracle::nearest_wall(walls, origin, direction, ray.range, 0.0).map(|(metres, _)| metres)
    }
}

/// Corners as a list, three for each triangle, and the corner numbers of each triangle, as parry requires.
fn corners(triangles: &[Triangle]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let numbers = (0_u32..).step_by(3).take(triangles.len()).map(|first| [first, first + 1, first + 2]).collect();
    (triangles.as_flattened().to_vec(), numbers)
}

fn single_precision(triangles: &[Triangle]) -> impl Fn(&Ray3) -> Option<f64> {
    use parry3d::math::Vector;
    use parry3d::query::{Ray, RayCast};
    let (points, numbers) = corners(triangles);
    let vector = |at: DVec3| Vector::new(at.x as f32, at.y as f32, at.z as f32);
    let mesh = parry3d::shape::TriMesh::new(points.into_iter().map(vector).collect(), numbers).expect("a mesh");
    move |ray| {
        let local = Ray::new(vector(ray.origin), vector(ray.direction));
        mesh.cast_local_ray(&local, ray.range as f32, false).map(f64::from)
    }
}

fn double_precision(triangles: &[Triangle]) -> impl Fn(&Ray3) -> Option<f64> {
    use parry3d_f64::math::Vector;
    use parry3d_f64::query::{Ray, RayCast};
    let (points, numbers) = corners(triangles);
    let vector = |at: DVec3| Vector::new(at.x, at.y, at.z);
    let mesh = parry3d_f64::shape::TriMesh::new(points.into_iter().map(vector).collect(), numbers).expect("a mesh");
    move |ray| mesh.cast_local_ray(&Ray::new(vector(ray.origin), vector(ray.direction)), ray.range, false)
}

/// Casts rays with Embree's single-ray query, by the script in `peers/`.
fn embree(triangles: &[Triangle], python: OsString, mode: &'static str) -> Caster<'static> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("terrain-rays");
    fs::create_dir_all(&folder).expect("the target folder can be written");
    write(&folder, "triangles", triangles.as_flattened().iter().flat_map(|corner| corner.to_array()));
    Box::new(move |rays, repeats| {
        write(&folder, "rays", rays.iter().flat_map(Ray3::numbers));
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/embree_rays.py");
        let output = Command::new(&python)
            .arg(script)
            .arg("--mesh")
            .arg(&folder)
            .args([repeats, CHUNK].map(|number| number.to_string()))
            .arg(mode)
            .output();
        let output = output.expect("EMBREE_PYTHON names a Python");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let seconds = String::from_utf8_lossy(&output.stdout).trim().parse().expect("seconds");
        let bytes = fs::read(folder.join("distances.f64")).expect("the script writes distances");
        (seconds, bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
    })
}

fn write(folder: &Path, name: &str, numbers: impl Iterator<Item = f64>) {
    let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
    fs::write(folder.join(name).with_extension("f64"), bytes).expect("the target folder can be written");
}

/// Number of rays whose hits disagree (a hit against none, or distances that differ by more than 1 mm), and the maximum
/// error of the other rays, m.
fn errors(set: &Set, distances: &[f64]) -> (usize, f64) {
    let agree = |one: f64, other: f64| one == other || (one - other).abs() <= 1e-3;
    let (same, other): (Vec<_>, Vec<_>) = set.truth.iter().partition(|(at, truth)| agree(distances[*at], *truth));
    let error = |(at, truth): &(usize, f64)| if truth.is_finite() { (distances[*at] - truth).abs() } else { 0.0 };
    (other.len(), same.iter().map(error).fold(0.0, f64::max))
}

/// Number of rays aimed at shared edges without a hit.
fn leaks(scene: &Scene, caster: &Caster) -> usize {
    caster(&scene.edges, 1).1.iter().filter(|distance| distance.is_infinite()).count()
}

fn assert_errors(scene: &Scene, caster: &Caster) {
    for set in &scene.sets {
        let (lost, error) = errors(set, &caster(&set.rays, 1).1);
        assert!(lost == 0 && error < 1e-9, "{}, {}: {lost} lost, error {error} m", scene.name, set.name);
        println!("  {:<12} within 1e-9 m", set.name);
    }
    assert_eq!(leaks(scene, caster), 0, "no ray slips through a shared edge");
}
