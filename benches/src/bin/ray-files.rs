//! Writes the walls and rays of the bench `rays` for peers in other languages: `ray-files FOLDER`.
//!
//! Each file is a flat list of little-endian doubles: `walls.f64` (ax, ay, bx, by), and one file `NAME.f64` each for
//! psd and lidar (origin x, y, direction x, y, range, distance by brute force or infinity). For each set of the bench
//! `terrain`, the folder `terrain-NAME` has `triangles.f64` (three corners) and `rays.f64` (origin, direction, range).
#![forbid(unsafe_code)]

use std::path::Path;
use std::process::ExitCode;
use std::{env, fs, io};

use accuracy::oracle;
use benches::terrain;

fn main() -> ExitCode {
    let Some(folder) = env::args_os().nth(1) else {
        eprintln!("usage: ray-files FOLDER");
        return ExitCode::from(2);
    };
    match write(Path::new(&folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cannot write to `{}`: {error}", folder.display());
            ExitCode::from(2)
        }
    }
}

fn write(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    let walls = benches::walls();
    let ends: Vec<f64> = walls.iter().flat_map(|wall| [wall.a.x, wall.a.y, wall.b.x, wall.b.y]).collect();
    write_doubles(&folder.join("walls.f64"), &ends)?;
    for (name, rays) in [("psd", benches::psd_rays(100_000)), ("lidar", benches::lidar_rays(280))] {
        let numbers: Vec<f64> = rays
            .iter()
            .flat_map(|ray| {
                let hit = oracle::nearest_wall(&walls, ray.origin, ray.direction, ray.range, 0.0);
                let distance = hit.map_or(f64::INFINITY, |(metres, _)| metres);
                [ray.origin.x, ray.origin.y, ray.direction.x, ray.direction.y, ray.range, distance]
            })
            .collect();
        write_doubles(&folder.join(name).with_extension("f64"), &numbers)?;
    }
    let corners: Vec<f64> = terrain::terrain().as_flattened().iter().flat_map(|corner| corner.to_array()).collect();
    for (name, rays) in terrain::terrain_rays() {
        let folder = folder.join(format!("terrain-{name}"));
        fs::create_dir_all(&folder)?;
        write_doubles(&folder.join("triangles.f64"), &corners)?;
        write_doubles(&folder.join("rays.f64"), &rays.iter().flat_map(|ray| ray.numbers()).collect::<Vec<_>>())?;
    }
    Ok(())
}

fn write_doubles(path: &Path, numbers: &[f64]) -> io::Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    fs::write(path, bytes)
}
