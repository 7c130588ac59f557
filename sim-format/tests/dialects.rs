//! Robot files, worlds and mazes of all dialects, from a local corpus of real files if present.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use sim_core::spec::{DriveKind, JointSpec, Lens, MotorSpec, RobiSpec, TypeRef, WorldSpec};
use sim_format::{Code, Diagnostic, Severity, decode, read_maze, read_robi, read_world};

/// Corpus beside the repository; prints a note and returns `None` if it is absent.
fn corpus() -> Option<PathBuf> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/eyesim/corpus");
    if !corpus.is_dir() {
        eprintln!("skipped: no corpus at {}", corpus.display());
        return None;
    }
    Some(corpus)
}

/// All files below `folder` with one of the `extensions`: relative path and text, sorted by path.
fn texts(folder: &Path, extensions: &[&str]) -> Vec<(String, String)> {
    let mut open = vec![folder.to_owned()];
    let mut texts = Vec::new();
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(&path).into_iter().flatten().flatten().map(|entry| entry.path()));
        } else if path.extension().and_then(|e| e.to_str()).is_some_and(|e| extensions.contains(&e)) {
            let bytes = fs::read(&path).expect("a file of the corpus");
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
            texts.push((name, decode(&bytes).0));
        }
    }
    texts.sort();
    texts
}

fn text(corpus: &Path, name: &str) -> String {
    decode(&fs::read(corpus.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))).0
}

/// Words of each line, without comments.
fn lines(text: &str) -> impl Iterator<Item = Vec<&str>> {
    let words = text.lines().map(|line| {
        let data = line.split([';', '#']).next().unwrap_or_default();
        data.split_whitespace().collect::<Vec<&str>>()
    });
    words.filter(|words| !words.is_empty())
}

fn count(text: &str, keyword: &str) -> usize {
    lines(text).filter(|words| words[0] == keyword).count()
}

/// Codes of the warnings, each once; panics on an error.
fn warnings(name: &str, diagnostics: &[Diagnostic]) -> Vec<Code> {
    let errors: Vec<_> = diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error).collect();
    assert!(errors.is_empty(), "{name}: {errors:#?}");
    diagnostics.iter().map(|diagnostic| diagnostic.code).collect::<BTreeSet<_>>().into_iter().collect()
}

#[test]
fn every_robot_file_keeps_its_devices() {
    let Some(corpus) = corpus() else { return };
    let files = texts(&corpus, &["robi"]);
    assert!(files.len() >= 18, "only {} robot files", files.len());
    for (name, text) in files {
        let (robi, diagnostics) = read_robi(&name, &text);
        warnings(&name, &diagnostics);
        assert_eq!(robi.psds.len(), count(&text, "psd"), "{name}");
        assert_eq!(robi.colliders.len(), count(&text, "collider"), "{name}");
        for (has, keyword) in [
            (robi.camera.is_some(), "camera"),
            (robi.lidar.is_some(), "lidar"),
            (robi.model.is_some(), "model"),
            (robi.camera.is_some_and(|camera| matches!(camera.lens, Lens::Fisheye { .. })), "fisheye"),
        ] {
            assert_eq!(usize::from(has), count(&text, keyword), "{name}: {keyword}");
        }
        // The wheels are within the body, including their rims.
        assert!(robi.wheel.track <= robi.diameter, "{name}: {} in {}", robi.wheel.track, robi.diameter);
    }
}

#[test]
fn every_world_keeps_its_walls() {
    let Some(corpus) = corpus() else { return };
    let files = texts(&corpus, &["wld"]);
    assert!(files.len() >= 45, "only {} worlds", files.len());
    for (name, text) in files {
        let (world, diagnostics) = read_world(&name, &text);
        warnings(&name, &diagnostics);
        let is_wall = |words: &Vec<&str>| {
            matches!(words.len(), 4 | 6 | 9) && words.iter().all(|word| word.parse::<f64>().is_ok())
        };
        assert_eq!(world.walls.len(), lines(&text).filter(is_wall).count(), "{name}");
        assert_eq!(world.starts.len(), count(&text, "position"), "{name}");
        assert_eq!(usize::from(world.texture.is_some()), count(&text, "floor_texture"), "{name}");
        assert!(world.floor.min_element() > 0.0, "{name}");
    }
}

fn mm(robi: f64) -> f64 {
    (robi * 1e6).round() / 1e3
}

fn robi(corpus: &Path, name: &str) -> (RobiSpec, Vec<Code>) {
    let (robi, diagnostics) = read_robi(name, &text(corpus, name));
    let codes = warnings(name, &diagnostics);
    (robi, codes)
}

#[test]
fn robots_of_every_dialect_are_what_their_files_say() {
    let Some(corpus) = corpus() else { return };
    let facts = |name: &str| {
        let (robi, codes) = robi(&corpus, name);
        (robi.name, mm(robi.diameter), mm(robi.wheel.track), mm(robi.axis_offset), mm(robi.drive.wheelbase), codes)
    };
    let classic_labbot = "vr-2018/older/7832648/RobotVR-Build/robots/LabBot.robi";
    assert_eq!(facts(classic_labbot), ("LabBot".to_owned(), 260.0, 145.0, 40.0, 145.0, vec![]));
    // A file between the dialects: its lines are classic, so 70 is taken literally.
    let between = "vr-2018/older/9840ff9/RobotVR-Build/robots/LabBot.robi";
    assert_eq!(facts(between), ("LabBot".to_owned(), 260.0, 70.0, 40.0, 70.0, vec![]));
    // Half of 140: EyeSim VR rounded the 145 of the classic file.
    let labbot = "vr-2018/Test Assets/robots/LabBot/LabBot.robi";
    assert_eq!(facts(labbot), ("LabBot2".to_owned(), 269.072, 140.0, 10.8, 140.0, vec![]));
    let classic_s4 = "vr-2018/older/c6c6bcb/Test Assets/robots/S4.robi";
    assert_eq!(facts(classic_s4), ("S4".to_owned(), 186.0, 90.0, 0.0, 90.0, vec![]));
    let s4 = "vr-2018/Test Assets/robots/S4/S4.robi";
    assert_eq!(facts(s4), ("S4Bot".to_owned(), 190.394, 90.0, 10.8, 90.0, vec![]));
    // The file begins with the words `Robi file:`.
    let blue = "vr-2025/Sims/Updated_Robots/S4blue.robi";
    assert_eq!(facts(blue), ("S4blue".to_owned(), 190.394, 90.0, 10.8, 90.0, vec![Code::RobiKeyword]));
    let odw = "vr-2018/Test Assets/examples/omni/odw.robi";
    assert_eq!(facts(odw), ("ODW".to_owned(), 375.0, 220.0, 0.0, 220.0, vec![]));
    let s4y = "vr-2018/Test Assets/examples/pantilt/S4Y.robi";
    assert_eq!(facts(s4y), ("S4Y".to_owned(), 186.0, 90.0, 0.0, 90.0, vec![]));
    let car = "vr-2018/Test Assets/robots/Ackermann/Ackermann.robi";
    assert_eq!(facts(car), ("Ackermann2".to_owned(), 258.155, 89.0, -94.0, 160.1, vec![]));
    // The file has no body and no drive devices, and its PSDs are numbered as in classic files. Its other values are
    // those of `odw`.
    let omni = "vr-2018/Test Assets/robots/Omni/Omni.robi";
    let codes = vec![Code::RobiBodyMissing, Code::RobiPsdOrder];
    assert_eq!(facts(omni), ("Omni1".to_owned(), 388.33, 220.0, 0.0, 220.0, codes));
    let [omni, odw] = [omni, odw].map(|name| robi(&corpus, name).0);
    assert_eq!((omni.drive.kind, &omni.drive.motors), (DriveKind::Omni, &odw.drive.motors));
    assert_eq!(omni.camera.map(|camera| camera.image), odw.camera.map(|camera| camera.image));
}

#[test]
fn devices_of_every_dialect_are_what_their_files_say() {
    let Some(corpus) = corpus() else { return };
    let assert_close =
        |a: DVec3, b: [f64; 3]| assert!((a * 1000.0 - DVec3::from_array(b)).length() < 1e-9, "{a} is not {b:?}");

    let (labbot, _) = robi(&corpus, "vr-2018/Test Assets/robots/LabBot/LabBot.robi");
    assert_eq!((labbot.mass, labbot.psds[2].id, labbot.max_speed), (50.0, Some(3), 0.4));
    assert_close(labbot.centre_of_mass, [-50.0, 0.0, 30.0]);
    assert_close(labbot.psds[1].position, [45.0, 27.0, 40.0]);
    assert_eq!(labbot.lidar.map(|lidar| (lidar.points, lidar.tilt)), Some((360, 0.0)));
    let model = labbot.model.expect("a model");
    assert_close(model.offset, [0.0, -14.0, 0.0]);
    let camera = labbot.camera.expect("a camera");
    assert!(
        matches!(camera.pan, JointSpec::Servo { ref name, from, to } if name == "SERVO1" && from == -to),
        "{camera:?}"
    );

    let (s4, _) = robi(&corpus, "vr-2018/Test Assets/robots/S4/S4.robi");
    assert_eq!(s4.camera.and_then(|camera| camera.image), Some([482, 162]));

    let (blue, _) = robi(&corpus, "vr-2025/Sims/Updated_Robots/S4blue.robi");
    let camera = blue.camera.expect("a camera");
    assert_close(camera.position, [62.0, 0.0, 60.0]);
    assert_eq!((camera.image, camera.lens), (Some([482, 162]), Lens::Fisheye { fov: 150.0_f64.to_radians() }));
    let ids: Vec<_> = blue.psds.iter().map(|psd| (psd.id, psd.angle.to_degrees().round())).collect();
    assert_eq!(ids, [(Some(1), 0.0), (Some(2), 90.0), (Some(3), -90.0), (Some(4), 180.0)]);

    let (s4y, _) = robi(&corpus, "vr-2018/Test Assets/examples/pantilt/S4Y.robi");
    assert!(s4y.psds.iter().all(|psd| psd.id.is_none()));
    let camera = s4y.camera.expect("a camera");
    assert!(matches!(camera.tilt, JointSpec::Servo { ref name, .. } if name == "SERVO2"), "{camera:?}");

    let (car, _) = robi(&corpus, "vr-2018/Test Assets/robots/Ackermann/Ackermann.robi");
    let motor = MotorSpec { motor: "MOTOR_DRIVE".to_owned(), encoder: Some("QUAD_DRIVE".to_owned()) };
    assert_eq!((car.drive.kind, car.drive.motors), (DriveKind::Ackermann, vec![motor]));
    assert_eq!((mm(car.wheel.diameter), car.wheel.ticks_per_turn), (40.0, 640.0));
}

/// Drawing of a maze's walls with cells of `pitch - 1` characters, without trailing blanks.
fn draw(maze: &WorldSpec, pitch: usize) -> Vec<String> {
    let cell = maze.cell.expect("a maze");
    let cell_of = |position: DVec2| [position.x, position.y].map(|at| (at / cell).round() as usize);
    let [columns, rows] = cell_of(maze.floor);
    let mut drawing = vec![vec![' '; pitch * columns + 1]; rows + 1];
    for wall in &maze.walls {
        let [from, to] = [wall.from.min(wall.to), wall.from.max(wall.to)].map(cell_of);
        for row in from[1]..to[1] {
            drawing[rows - row][pitch * from[0]] = '|';
        }
        for column in from[0]..to[0] {
            drawing[rows - from[1]][pitch * column + 1..pitch * (column + 1)].fill('_');
        }
    }
    drawing.iter().map(|row| row.iter().collect::<String>().trim_end().to_owned()).collect()
}

/// Rows of a drawing reduced to its walls: an upper-case letter means a wall below its cell. A letter or `_` in a wall
/// column belongs to the cell on its left.
fn walls_of(text: &str, pitch: usize) -> Vec<String> {
    let rows = text.lines().filter(|line| line.starts_with(['|', ' ', '_']) && !line.trim().is_empty());
    let walls = |row: &str| {
        let mut walls: Vec<char> = row.chars().map(|c| if matches!(c, '|' | '_') { c } else { ' ' }).collect();
        for (column, character) in row.chars().enumerate() {
            match character {
                '_' if column == 0 => walls[column] = ' ',
                '_' if column % pitch == 0 => {
                    walls[column] = ' ';
                    walls[column + 1 - pitch..column].fill('_');
                }
                'S' | 'U' | 'R' | 'D' | 'L' | 'O' | 'X' if column % pitch == 0 => walls[column - 1] = '_',
                'S' | 'U' | 'R' | 'D' | 'L' | 'O' | 'X' => walls[column] = '_',
                _ => {}
            }
        }
        walls.iter().collect::<String>().trim_end().to_owned()
    };
    rows.map(walls).collect()
}

#[test]
fn every_maze_equals_its_drawing() {
    let Some(corpus) = corpus() else { return };
    let files = texts(&corpus, &["maz", "maze"]);
    assert!(files.len() >= 22, "only {} mazes", files.len());
    for (name, text) in files {
        let (maze, diagnostics) = read_maze(&name, &text);
        let codes = warnings(&name, &diagnostics);
        let pitch = if codes.contains(&Code::MazWide) { 3 } else { 2 };
        assert_eq!(draw(&maze, pitch), walls_of(&text, pitch), "{name}");
        let body: String = text.lines().filter(|line| line.starts_with(['|', ' ', '_'])).collect();
        let letters = |of: &str| body.chars().filter(|c| of.contains(*c)).count();
        assert_eq!(maze.starts.len(), letters("sSuUrRdDlL"), "{name}");
        assert_eq!(maze.objects.len(), letters("oOxX"), "{name}");
        assert!(
            codes.iter().all(|code| matches!(code, Code::MazWide | Code::MazLetter | Code::MazCellFirst)),
            "{name}: {codes:?}"
        );
    }
}

#[test]
fn mazes_have_the_sizes_starts_and_objects_of_their_files() {
    let Some(corpus) = corpus() else { return };
    let maze = |name: &str| read_maze(name, &text(&corpus, name)).0;
    let mazes = "vr-2018/Test Assets/worlds/mazes";
    for (name, cell, columns, rows) in [
        ("two-starts/00-field.maz".to_owned(), 1.0, 10, 9),
        ("maze-course/maze1.maz".to_owned(), 0.72, 5, 5),
        (format!("{mazes}/maze1a.maz"), 0.36, 5, 5),
        (format!("{mazes}/soccer.maz"), 0.36, 18, 9),
        (format!("{mazes}/reno-1993.maz"), 0.36, 10, 10),
        (format!("{mazes}/size-example.maz"), 0.1, 16, 16),
        (format!("{mazes}/chicago-1986.maz"), 0.36, 16, 16),
        ("vr-2018/Test Assets/worlds/largeMaze/maze2.maz".to_owned(), 0.72, 16, 16),
        ("vr-2018/Test Assets/examples/omni/maze.maz".to_owned(), 0.36, 19, 5),
        ("vr-2018/older/241fa9b/Test Assets/worlds/test.maz".to_owned(), 0.36, 2, 4),
    ] {
        let maze = maze(&name);
        let floor = DVec2::new(f64::from(columns), f64::from(rows)) * cell;
        assert_eq!(maze.cell, Some(cell), "{name}");
        assert!((maze.floor - floor).length() < 1e-9, "{name}: {} is not {floor}", maze.floor);
    }

    let starts: Vec<_> = maze("two-starts/00-field.maz").starts.iter().map(|s| (s.letter, s.pose.position)).collect();
    // The second letter is in a wall column, so it belongs to the cell on its left.
    assert_eq!(starts, [(Some('U'), DVec2::new(3.5, 0.5)), (Some('S'), DVec2::new(5.5, 0.5))]);

    let objects: Vec<_> = maze("vr-2018/Test Assets/maze1.maz")
        .objects
        .iter()
        .map(|object| match &object.kind {
            TypeRef::Name(name) | TypeRef::File(name) => (name.text.clone(), (object.pose.position / 0.36).floor()),
        })
        .collect();
    let expected = [("Crate", (3, 3)), ("Soccer", (1, 2)), ("Soccer", (2, 1)), ("Crate", (4, 1))];
    assert_eq!(objects, expected.map(|(name, (x, y))| (name.to_owned(), DVec2::new(f64::from(x), f64::from(y)))));
}

#[test]
fn contest_mazes_are_closed() {
    let Some(corpus) = corpus() else { return };
    for name in ["chicago-1986", "regional1-1991", "reno-1993", "size-example", "maze1", "maze2", "square1"] {
        let name = format!("vr-2018/Test Assets/worlds/mazes/{name}.maz");
        let maze = read_maze(&name, &text(&corpus, &name)).0;
        let (low, high) = (DVec2::ZERO, maze.floor);
        for (from, to) in [
            (low, DVec2::new(high.x, 0.0)),
            (DVec2::new(high.x, 0.0), high),
            (DVec2::new(0.0, high.y), high),
            (low, DVec2::new(0.0, high.y)),
        ] {
            let is_border = maze.walls.iter().any(|wall| {
                let (a, b) = (wall.from.min(wall.to), wall.from.max(wall.to));
                (a - from).length() < 1e-9 && (b - to).length() < 1e-9
            });
            assert!(is_border, "{name}: no wall from {from} to {to}");
        }
    }
}
