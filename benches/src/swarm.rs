//! Scene of the swarm: one robot per square metre, on a grid in a rectangular arena with walls on all sides, each with
//! a different heading.
//!
//! The robots' type and program are in `swarm/`. The scene never changes, so results of different versions of eyesim
//! are comparable.

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

/// Side of the square for one robot, mm.
const CELL: usize = 1000;

/// Headings of neighbours in the list differ by the golden angle, degrees.
const GOLDEN_ANGLE: f64 = 137.5;

/// Writes `swarm.sim` for `robots` robots, and the files that it names, into `folder`; creates the folder.
///
/// # Errors
/// If a file cannot be written.
pub fn write(robots: usize, folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for file in ["swarm.c", "swarm.robi", "swarm.toml"] {
        fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("swarm").join(file), folder.join(file))?;
    }
    fs::write(folder.join("swarm.wld"), world(robots))?;
    fs::write(folder.join("swarm.sim"), scene(robots))
}

/// Number of robots in a row of the grid.
fn columns(robots: usize) -> usize {
    robots.isqrt().max(1)
}

/// The arena: a rectangle of whole cells with a wall on each side.
fn world(robots: usize) -> String {
    let (width, height) = (CELL * columns(robots), CELL * robots.div_ceil(columns(robots)));
    format!(
        "floor {width} {height}\n0 0 {width} 0\n{width} 0 {width} {height}\n{width} {height} 0 {height}\n0 {height} 0 0\n"
    )
}

/// The sim file: each robot in the centre of its cell.
fn scene(robots: usize) -> String {
    let mut sim = String::from("world swarm.wld\n");
    for index in 0..robots {
        let (x, y) = (CELL * (index % columns(robots)) + CELL / 2, CELL * (index / columns(robots)) + CELL / 2);
        let heading = (index as f64 * GOLDEN_ANGLE) % 360.0;
        // Writing to a string cannot fail.
        let _ = writeln!(sim, "robi swarm.robi swarm.c {x} {y} {heading}");
    }
    sim
}
