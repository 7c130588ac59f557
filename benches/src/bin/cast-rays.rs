//! Casts the rays of the benches a fixed number of times, for counters: `cast-rays SET TURNS`.
//!
//! A set is `psd`, `lidar` or `maze` among walls, or `terrain-camera`, `terrain-psd`, `terrain-lidar` or
//! `terrain-incoherent`. The output is the number of rays, the time of the fastest turn in ns per ray, and a hash of
//! the bits of all distances.
#![forbid(unsafe_code)]

use std::env;
use std::process::ExitCode;
use std::time::Instant;

use benches::terrain;
use sim_core::scene::{MeshIndex, Walls};

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [set, turns] = &arguments[..] else { return usage() };
    let Ok(turns) = turns.parse::<u32>() else { return usage() };
    let among_walls = |segments, rays: Vec<benches::Ray>| {
        let walls = Walls::new(segments);
        measure(&rays, turns, |ray| walls.cast(ray.origin, ray.direction, ray.range).map(|hit| hit.distance));
    };
    match set.as_str() {
        "psd" => among_walls(benches::walls(), benches::psd_rays(100_000)),
        "lidar" => among_walls(benches::walls(), benches::lidar_rays(280)),
        "maze" => among_walls(benches::maze(), benches::psd_rays(100_000)),
        _ => {
            let mut sets = terrain::terrain_rays().into_iter();
            let name = set.strip_prefix("terrain-").unwrap_or_default();
            let Some((_, rays)) = sets.find(|(other, _)| *other == name) else { return usage() };
            let mesh = MeshIndex::new(&terrain::terrain());
            measure(&rays, turns, |ray| mesh.cast(ray.origin, ray.direction, ray.range).map(|hit| hit.distance));
        }
    }
    ExitCode::SUCCESS
}

fn usage() -> ExitCode {
    eprintln!("usage: cast-rays psd|lidar|maze|terrain-camera|terrain-psd|terrain-lidar|terrain-incoherent TURNS");
    ExitCode::from(2)
}

fn measure<R>(rays: &[R], turns: u32, cast: impl Fn(&R) -> Option<f64>) {
    let (mut fastest, mut hash) = (f64::INFINITY, 0_u64);
    for _ in 0..turns {
        let start = Instant::now();
        hash = rays.iter().fold(0, |hash, ray| {
            let distance = cast(ray).unwrap_or(f64::INFINITY);
            (hash.rotate_left(5) ^ distance.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        });
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    println!("{} rays, {:.1} ns per ray, hash {hash:016x}", rays.len(), fastest / rays.len() as f64 * 1e9);
}
