//! The data files of the repository, and a local corpus of real files if present.

use std::path::{Path, PathBuf};
use std::{fs, panic};

use glam::DVec2;
use sim_core::math;
use sim_core::scene::{Segment, Walls};
use sim_core::spec::{RobiSpec, WallSpec, WorldSpec};
use sim_format::{Diagnostic, FileError, Files, Severity, load_robi, load_scene, load_world};

/// The file system, with `home` as the installation.
struct Disk {
    home: String,
}

impl Files for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        if !Path::new(path).is_file() {
            return Err(FileError::Missing);
        }
        fs::read(path).map_err(|error| FileError::Unreadable(error.to_string()))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let folder = if folder.is_empty() { "." } else { folder };
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    fn home(&self) -> Option<&str> {
        Some(&self.home)
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn disk() -> Disk {
    Disk { home: root().to_string_lossy().into_owned() }
}

/// All files below `folder`, in order of their paths.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files.extend(files_below(&path));
        } else {
            files.push(path);
        }
    }
    files
}

fn name(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// Diagnostics of a file of any kind and of all files that it refers to.
fn load(path: &Path) -> Vec<Diagnostic> {
    let name = name(path);
    match path.extension().and_then(|extension| extension.to_str()).unwrap_or_default() {
        "sim" => load_scene(&name, &disk()).diagnostics,
        "robi" => load_robi(&name, &disk()).1.diagnostics,
        "maz" | "maze" => load_world(&name, &disk()).diagnostics,
        "wld" => load_world(&name, &disk()).diagnostics,
        _ => Vec::new(),
    }
}

fn world(file: &str) -> WorldSpec {
    let path = name(&root().join("worlds").join(file));
    let loaded = load_world(&path, &disk());
    assert_eq!(loaded.diagnostics, []);
    loaded.scene.world
}

fn robi(file: &str) -> RobiSpec {
    let (robi, loaded) = load_robi(&name(&root().join("robis").join(file)), &disk());
    assert_eq!(loaded.diagnostics, []);
    robi.expect("the robi is read")
}

fn segment(wall: &WallSpec) -> Segment {
    Segment::new(wall.from, wall.to)
}

fn walls(world: &WorldSpec) -> Walls {
    Walls::new(world.walls.iter().map(segment).collect())
}

#[test]
fn our_own_files_have_no_mistakes() {
    let mut count = 0;
    for folder in ["worlds", "robis"] {
        for path in files_below(&root().join(folder)) {
            assert_eq!(load(&path), [], "{}", path.display());
            count += usize::from(path.extension().is_some_and(|extension| extension != "md" && extension != "toml"));
        }
    }
    assert!(count >= 12, "only {count} files");
}

#[test]
fn our_worlds_are_closed_around_their_starts() {
    for file in [
        "empty.wld",
        "obstacles.wld",
        "corridor.wld",
        "parking.wld",
        "line.wld",
        "road.wld",
        "colours.wld",
        "small.maz",
        "micromouse.maz",
    ] {
        let world = world(file);
        let walls = walls(&world);
        assert!(!world.starts.is_empty(), "{file}");
        for start in &world.starts {
            for step in 0..3600 {
                let (sin, cos) = math::sin_cos(f64::from(step) * std::f64::consts::TAU / 3600.0);
                let hit = walls.cast(start.pose.position, DVec2::new(cos, sin), 100.0);
                assert!(
                    hit.is_some(),
                    "{file}: a way out of {:?} at {} degrees",
                    start.pose.position,
                    step as f64 / 10.0
                );
            }
        }
    }
}

#[test]
fn starts_of_our_worlds_have_room_for_the_intended_robot_sizes() {
    for (file, radius) in [
        ("empty.wld", 0.2),
        ("obstacles.wld", 0.2),
        ("corridor.wld", 0.2),
        ("parking.wld", 0.15),
        ("small.maz", 0.1),
        ("micromouse.maz", 0.1),
    ] {
        let world = world(file);
        for start in &world.starts {
            let centre = start.pose.position;
            let free = world.walls.iter().map(|wall| segment(wall).distance(centre)).fold(f64::INFINITY, f64::min);
            assert!(free > radius, "{file}: {centre:?} is {free} m from a wall");
        }
    }
}

/// Cells reachable from the first start of a maze, by their column and row from the lower left.
fn reachable(maze: &WorldSpec) -> Vec<(i32, i32)> {
    let cell = maze.cell.expect("a maze");
    let walls = walls(maze);
    let cell_of = |position: DVec2| ((position.x / cell).floor() as i32, (position.y / cell).floor() as i32);
    let centre = |(x, y): (i32, i32)| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * cell;
    let mut seen = vec![cell_of(maze.starts[0].pose.position)];
    let mut next = 0;
    while let Some(&(x, y)) = seen.get(next) {
        next += 1;
        for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
            let neighbour = (x + dx, y + dy);
            let direction = DVec2::new(f64::from(dx), f64::from(dy));
            if !seen.contains(&neighbour) && walls.cast(centre((x, y)), direction, cell).is_none() {
                seen.push(neighbour);
            }
        }
    }
    seen.sort_unstable();
    seen
}

#[test]
fn every_cell_of_our_mazes_can_be_reached() {
    for (file, size) in [("small.maz", 7), ("micromouse.maz", 16)] {
        let maze = world(file);
        assert_eq!(maze.floor, DVec2::splat(f64::from(size) * 0.36), "{file}");
        let all: Vec<(i32, i32)> = (0..size).flat_map(|x| (0..size).map(move |y| (x, y))).collect();
        assert_eq!(reachable(&maze), all, "{file}");
    }
}

#[test]
fn sample_robots_have_the_expected_drives_and_sensors() {
    use sim_core::spec::DriveKind::{Ackermann, Differential, Omni};
    for (file, kind, wheelbase, psds) in [
        ("scout.robi", Differential, 0.1, 4),
        ("ring.robi", Differential, 0.1, 8),
        ("lab.robi", Differential, 0.15, 3),
        ("car.robi", Ackermann, 0.2, 5),
        ("mecanum.robi", Omni, 0.24, 4),
        ("feeler.robi", Differential, 0.12, 1),
    ] {
        let robi = robi(file);
        assert_eq!((robi.drive.kind, robi.drive.wheelbase, robi.psds.len()), (kind, wheelbase, psds), "{file}");
        let radius = 0.5 * robi.diameter;
        assert!(
            robi.psds.iter().all(|psd| psd.position.truncate().length() <= radius),
            "{file}: a PSD outside the body"
        );
    }
    assert_eq!(robi("lab.robi").axis_offset, 0.04);
    assert_eq!(robi("lagging.robi").drive.wheel_lag, 0.08);
    assert!(robi("ring.robi").psds.iter().all(|psd| psd.range == 2.0));
    assert_eq!(robi("feeler.robi").bumpers.len(), 3);
}

/// Corpus of real files beside the repository; prints a note and returns `None` if it is absent.
fn corpus() -> Option<PathBuf> {
    let corpus = root().join("../shared/eyesim/corpus");
    if !corpus.is_dir() {
        eprintln!("skipped: no corpus at {}", corpus.display());
        return None;
    }
    Some(corpus)
}

#[test]
fn no_file_of_the_corpus_makes_a_reader_panic() {
    let Some(corpus) = corpus() else { return };
    let mut count = 0;
    for path in files_below(&corpus) {
        // Each reader must accept any text.
        let Ok(bytes) = fs::read(&path) else { continue };
        let (text, _) = sim_format::decode(&bytes);
        let outcome = panic::catch_unwind(|| {
            load(&path);
            sim_format::read_world("x", &text);
            sim_format::read_maze("x", &text);
            sim_format::read_sim("x", &text);
            let (mut robi, _) = sim_format::read_robi("x", &text);
            sim_format::read_companion("x", &text, &mut robi);
        });
        assert!(outcome.is_ok(), "{}", path.display());
        count += 1;
    }
    assert!(count > 100, "only {count} files");
}

#[test]
fn real_worlds_and_mazes_are_read_nearly_without_errors() {
    let Some(corpus) = corpus() else { return };
    let with_errors: Vec<String> = files_below(&corpus)
        .iter()
        .filter(|path| matches!(path.extension().and_then(|e| e.to_str()), Some("wld" | "maz" | "robi")))
        .flat_map(|path| load(path))
        .filter(|diagnostic| diagnostic.severity == Severity::Error)
        .map(|diagnostic| diagnostic.to_string())
        .collect();
    assert!(with_errors.is_empty(), "{with_errors:#?}");
}

#[test]
fn the_walls_of_a_real_building_meet() {
    let Some(corpus) = corpus() else { return };
    let files = files_below(&corpus);
    let mut found = 0;
    for path in files.iter().filter(|path| path.ends_with("uwa-ee4.wld")) {
        let world = load_world(&name(path), &disk()).scene.world;
        assert_eq!(world.walls.len(), 443, "{}", path.display());
        assert!(gaps(&world).iter().all(|gap| *gap < 0.012), "{}: {:?}", path.display(), gaps(&world));
        // With `push` turning the other way, ten wall ends would be unconnected.
        let text = sim_format::decode(&fs::read(path).expect("a readable file")).0;
        let (mirrored, _) = sim_format::read_world("x", &with_turns_negated(&text));
        let far: Vec<f64> = gaps(&mirrored).into_iter().filter(|gap| *gap > 0.012).collect();
        assert_eq!(far.len(), 10, "{}: {far:?}", path.display());
        assert!(far.iter().any(|gap| *gap > 1.0), "{}: {far:?}", path.display());
        found += 1;
    }
    assert!(found > 0, "uwa-ee4.wld is not in the corpus");
}

/// For each end of each wall, the distance to the nearest other wall, in metres.
fn gaps(world: &WorldSpec) -> Vec<f64> {
    let ends = world.walls.iter().enumerate().flat_map(|(index, wall)| [(index, wall.from), (index, wall.to)]);
    let gap = |(index, end): (usize, DVec2)| {
        let others = world.walls.iter().enumerate().filter(|(other, _)| *other != index);
        others.map(|(_, other)| segment(other).distance(end)).fold(f64::INFINITY, f64::min)
    };
    ends.map(gap).collect()
}

/// Text of a world with the angle of each `push` negated.
fn with_turns_negated(text: &str) -> String {
    let line = |line: &str| {
        let data = line.split(';').next().unwrap_or_default();
        match data.split_whitespace().collect::<Vec<_>>()[..] {
            ["push", x, y, phi] => format!("push {x} {y} {}\n", -phi.parse::<f64>().expect("an angle")),
            _ => format!("{line}\n"),
        }
    };
    text.lines().map(line).collect()
}
