//! Rooms and their starts: four training rooms, for which the settings are chosen, and three held-out rooms.

use std::fmt::Write as _;

use anyhow::ensure;
use mapping::pose::{Point, Pose};
use sim_format::load_scene;
use sim_host::files::DiskFiles;
use sim_host::launch::Options;

use crate::run::{Job, Run, Scene, root};

/// Number of starts in each of the three held-out rooms.
pub const STARTS: usize = 6;

/// A room: its walls from point to point, in mm, and starts in it, in mm and degrees.
pub struct Room {
    name: &'static str,
    walls: Vec<[[f64; 2]; 2]>,
    starts: Vec<[f64; 3]>,
}

/// Walls around closed outlines.
fn outlines(outlines: &[&[[f64; 2]]]) -> Vec<[[f64; 2]; 2]> {
    let walls = |outline: &&[[f64; 2]]| {
        let next = outline.iter().cycle().skip(1).copied();
        outline.iter().copied().zip(next).map(|(from, to)| [from, to]).collect::<Vec<_>>()
    };
    outlines.iter().flat_map(walls).collect()
}

/// Four training rooms with three starts each.
pub fn training() -> Vec<Room> {
    vec![
        Room {
            name: "study",
            walls: outlines(&[
                &[[0.0, 0.0], [3600.0, 0.0], [3600.0, 2800.0], [2300.0, 2800.0], [2300.0, 2300.0], [0.0, 2300.0]],
                &[[1400.0, 900.0], [2100.0, 900.0], [2100.0, 1300.0], [1400.0, 1300.0]],
            ]),
            starts: vec![[500.0, 500.0, 0.0], [3000.0, 2000.0, 180.0], [800.0, 1800.0, 35.0]],
        },
        Room {
            name: "attic",
            walls: outlines(&[
                &[[0.0, 0.0], [4500.0, 0.0], [4000.0, 3200.0], [0.0, 2600.0]],
                &[[2600.0, 1200.0], [3000.0, 1500.0], [2700.0, 1900.0], [2300.0, 1600.0]],
            ]),
            starts: vec![[600.0, 700.0, 0.0], [3600.0, 700.0, 120.0], [1200.0, 2100.0, 300.0]],
        },
        Room {
            name: "corner",
            walls: outlines(&[&[
                [0.0, 0.0],
                [4200.0, 0.0],
                [4200.0, 1800.0],
                [2200.0, 1800.0],
                [2200.0, 3800.0],
                [0.0, 3800.0],
            ]]),
            starts: vec![[600.0, 600.0, 10.0], [3500.0, 900.0, 90.0], [1100.0, 3100.0, 0.0]],
        },
        Room {
            name: "passage",
            walls: outlines(&[&[
                [0.0, 500.0],
                [2000.0, 500.0],
                [2000.0, 0.0],
                [2900.0, 0.0],
                [2900.0, 500.0],
                [5200.0, 500.0],
                [5200.0, 1900.0],
                [3900.0, 1900.0],
                [3900.0, 1500.0],
                [3300.0, 1500.0],
                [3300.0, 1900.0],
                [0.0, 1900.0],
            ]]),
            starts: vec![[500.0, 1200.0, 0.0], [2500.0, 1100.0, 15.0], [4600.0, 1100.0, 180.0]],
        },
    ]
}

/// The held-out rooms: the room and the corridor of the scenes, parallel to the grid, and a hall at an angle to the
/// grid, with an oblique wall.
///
/// # Errors
/// If a scene cannot be read.
pub fn held_out() -> anyhow::Result<Vec<Room>> {
    let starts = |at: [[f64; 2]; STARTS], heading: f64| at.iter().map(|[x, y]| [*x, *y, heading]).collect();
    let room = [[600.0, 600.0], [3000.0, 700.0], [3000.0, 2200.0], [600.0, 2200.0], [1300.0, 1500.0], [2900.0, 1500.0]];
    let corridor =
        [[500.0, 700.0], [1000.0, 1100.0], [2700.0, 600.0], [3600.0, 600.0], [4600.0, 1000.0], [5600.0, 900.0]];
    let hall = [[600.0, 600.0], [2600.0, 500.0], [4300.0, 700.0], [4200.0, 1900.0], [2200.0, 3000.0], [700.0, 2600.0]];
    let outline: &[[f64; 2]] =
        &[[0.0, 0.0], [5000.0, 0.0], [5000.0, 2500.0], [3200.0, 2900.0], [3200.0, 3800.0], [0.0, 3800.0]];
    let pillar: &[[f64; 2]] = &[[1500.0, 1400.0], [2100.0, 1400.0], [2100.0, 2000.0], [1500.0, 2000.0]];
    Ok(vec![
        Room { name: "room", walls: of_scene("sims/sonar-map.scene.toml")?, starts: starts(room, 0.0) },
        Room {
            name: "corridor",
            walls: of_scene("sims/sonar-map-corridor.scene.toml")?,
            starts: starts(corridor, 0.0),
        },
        Room { name: "hall", walls: outlines(&[outline, pillar]), starts: starts(hall, 23.0) },
    ])
}

/// The walls of a scene.
fn of_scene(file: &str) -> anyhow::Result<Vec<[[f64; 2]; 2]>> {
    let mut files = DiskFiles::with_home(root());
    let path = files.name(&root().join(file));
    let loaded = load_scene(&path, &files);
    ensure!(!loaded.has_errors(), "`{path}` has mistakes");
    let walls = loaded.scene.world.walls.iter();
    Ok(walls.map(|wall| [wall.from, wall.to].map(|end| [1e3 * end.x, 1e3 * end.y])).collect())
}

/// A start in a room, with a seed and a noise profile.
pub struct Case {
    /// Name: room, number of the start, noise.
    pub name: String,
    /// Name of the room and the start.
    pub start_name: String,
    /// Pose of the start in the room.
    pub start: Pose,
    /// Walls in the frame of the start, m.
    pub walls: Vec<[Point; 2]>,
    scene: String,
    seed: u64,
    noise: String,
}

/// The cases of all rooms and starts, each with the next seed.
pub fn cases(rooms: &[Room], first: u64, noise: &str) -> Vec<Case> {
    let starts = rooms.iter().flat_map(|room| room.starts.iter().enumerate().map(move |start| (room, start)));
    starts.zip(first..).map(|((room, (index, start)), seed)| case(room, index, *start, seed, noise)).collect()
}

/// Distance of the map's edges from the outermost walls, m: one and a half cells, so that a wall parallel to the grid
/// passes through the centres of cells.
const MARGIN: f64 = 0.075;

fn case(room: &Room, index: usize, [x, y, heading]: [f64; 3], seed: u64, noise: &str) -> Case {
    let start = Pose::new(x / 1e3, y / 1e3, heading.to_radians());
    let inward = |[x, y]: [f64; 2]| start.inward(Point::new(x / 1e3, y / 1e3));
    let walls: Vec<[Point; 2]> = room.walls.iter().map(|wall| wall.map(inward)).collect();
    let ends = || walls.iter().flatten();
    let low = |axis: usize| ends().map(|end| end[axis]).fold(f64::INFINITY, f64::min) - MARGIN;
    let high = |axis: usize| ends().map(|end| end[axis]).fold(f64::NEG_INFINITY, f64::max) + MARGIN;
    let arguments: Vec<String> =
        [low(0), low(1), high(0), high(1)].iter().map(|edge| format!("\"{}\"", (1e3 * edge).round())).collect();
    let size = |axis: usize| room.walls.iter().flatten().map(|end| end[axis]).fold(0.0, f64::max);
    let floor = [size(0), size(1)];
    let mut scene = format!("[scene]\nuntil_s = 1200\n\n[world]\nfloor_mm = {floor:?}\nwall = [\n");
    // Writing to a string cannot fail.
    for [from, to] in &room.walls {
        let _ = writeln!(scene, "    {{ from_mm = {from:?}, to_mm = {to:?} }},");
    }
    let _ = writeln!(
        scene,
        "]\n\n[[robot]]\ntype = \"%sim%/robis/sectors.robi\"\nprogram = \"%sim%/example-programs/sonar-map\"\n\
         arguments = [{}, \"50\"]\nx_mm = {x}\ny_mm = {y}\nheading_deg = {heading}",
        arguments.join(", ")
    );
    let start_name = format!("{}-{}", room.name, index + 1);
    let name = format!("{start_name}-{noise}");
    Case { name, start_name, start, walls, scene, seed, noise: noise.to_owned() }
}

impl Case {
    /// The run of the drive.
    pub fn run(&self, job: &Job) -> Run {
        let options = Options { seed: Some(self.seed), noise: Some(self.noise.clone()), ..job.options() };
        Run { name: self.name.clone(), scene: Scene::Text(self.scene.clone()), options }
    }

    /// Geometry of the map's grid, as in the robot's arguments, m.
    pub fn frame(&self) -> mapping::grid::GridGeometry {
        let ends = || self.walls.iter().flatten();
        let round = |edge: f64| (1e3 * edge).round() / 1e3;
        let low = |axis: usize| round(ends().map(|end| end[axis]).fold(f64::INFINITY, f64::min) - MARGIN);
        let high = |axis: usize| round(ends().map(|end| end[axis]).fold(f64::NEG_INFINITY, f64::max) + MARGIN);
        mapping::grid::GridGeometry::covering(Point::new(low(0), low(1)), Point::new(high(0), high(1)), 0.05)
    }
}
