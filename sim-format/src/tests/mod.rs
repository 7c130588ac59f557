//! Readers against hand-computed values.

mod dialects;
mod keys;
mod maze;
mod mesh;
mod mistakes;
mod properties;
mod robi;

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::*;
use sim_core::pose::Pose;

/// Files in memory.
#[derive(Default)]
pub(super) struct Memory {
    files: MemoryFiles,
}

impl Memory {
    pub(super) fn new(files: &[(&str, &str)]) -> Self {
        Self { files: files.iter().map(|(path, text)| (*path, *text)).collect() }
    }
}

impl Files for Memory {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        match self.files.read(path) {
            Ok(_) if path.starts_with("locked") => Err(FileError::Unreadable("permission denied".to_owned())),
            result => result,
        }
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.files.list(folder)
    }

    fn home(&self) -> Option<&str> {
        Some("/home/eyesim")
    }
}

fn world(text: &str) -> WorldSpec {
    let (world, diagnostics) = read_world("w.wld", text);
    assert_eq!(diagnostics, [], "{text}");
    world
}

fn maze(text: &str) -> WorldSpec {
    let (maze, mut diagnostics) = read_maze("m.maz", text);
    diagnostics.retain(|diagnostic| diagnostic.code != Code::MazCellFirst); // tested in `cell_size_depends_on_the_dialect`
    assert_eq!(diagnostics, [], "{text}");
    maze
}

fn wall_ends(world: &WorldSpec) -> Vec<[f64; 4]> {
    world.walls.iter().map(|wall| [wall.from.x, wall.from.y, wall.to.x, wall.to.y]).collect()
}

pub(super) fn codes(diagnostics: &[Diagnostic]) -> Vec<&'static str> {
    diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect()
}

/// Asserts equality to within a nanometre and a nanoradian.
fn assert_near(a: &Pose, b: &Pose) {
    let distance = (a.position - b.position).length();
    let angle = (a.heading.radians() - b.heading.radians()).abs();
    assert!(distance < 1e-9 && angle < 1e-9, "{a:?} is not {b:?}");
}

#[test]
fn push_turns_clockwise_and_can_be_nested() {
    // A quarter turn clockwise: local x points down, local y to the right.
    let text = "floor 9000 9000\npush 1000 5000 90\n0 0 200 0\npush 100 0 90\n0 0 0 50\nposition 10 0 0\npop\n0 0 0 100\npop\n0 0 1 1\n";
    let world = world(text);
    let expected = [[1.0, 5.0, 1.0, 4.8], [1.0, 4.9, 1.0, 4.85], [1.0, 5.0, 1.1, 5.0], [0.0, 0.0, 0.001, 0.001]];
    for (wall, expected) in wall_ends(&world).iter().zip(expected) {
        for (a, b) in wall.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{wall:?} is not {expected:?}");
        }
    }
    assert_near(&world.starts[0].pose, &Pose::new(0.99, 4.9, -PI));
}

#[test]
fn walls_with_six_and_nine_numbers_are_read() {
    let world =
        world("width 3100 ; BIGW\r\nheight 1530\r\n180\t0 \t180 515 18 100 255 128 0\r\n0 0 5 5 20 300;x\r\n1 2 3 4");
    assert_eq!(world.floor, DVec2::new(3.1, 1.53));
    let looks: Vec<_> = world.walls.iter().map(|wall| (wall.thickness, wall.height, wall.colour)).collect();
    assert_eq!(looks, [(0.018, 0.1, Some([255, 128, 0])), (0.02, 0.3, None), (0.0, DEFAULT_WALL_HEIGHT, None)]);
    assert_eq!(world.walls[2].span, Span { start: 83, end: 90, line: 5, column: 1 });
}

#[test]
fn maze_pieces_are_merged_into_long_walls() {
    let maze = maze(" ___\n| | |\n|S__|\n500\n");
    assert_eq!((maze.floor, maze.cell), (DVec2::new(1.0, 1.0), Some(0.5)));
    let expected =
        [[0.0, 0.0, 0.0, 1.0], [0.5, 0.5, 0.5, 1.0], [1.0, 0.0, 1.0, 1.0], [0.0, 1.0, 1.0, 1.0], [0.0, 0.0, 1.0, 0.0]];
    assert_eq!(wall_ends(&maze), expected);
    assert_eq!(maze.starts[0].pose, Pose::new(0.25, 0.25, FRAC_PI_2));
    assert_eq!(maze.starts[0].letter, Some('S'));
}

#[test]
fn maze_letters_give_headings_and_objects() {
    let maze = maze("720\n _________\n|u|r|d|lXo|\n|_________|\n");
    let headings: Vec<f64> = maze.starts.iter().map(|start| start.pose.heading.remainder()).collect();
    assert_eq!(headings, [FRAC_PI_2, 0.0, -FRAC_PI_2, -PI]);
    // The letter X is in a wall column, so it belongs to the fourth cell, on its left.
    let objects: Vec<_> =
        maze.objects.iter().map(|object| (object.kind.written().text.as_str(), object.pose.position)).collect();
    let y = 1.5 * 0.72;
    assert_eq!(objects[0], ("Crate", DVec2::new(3.5 * 0.72, y)));
    assert_eq!(objects[1], ("Soccer", DVec2::new(4.5 * 0.72, y)));
    assert!(
        wall_ends(&maze).contains(&[3.0 * 0.72, 0.72, 4.0 * 0.72, 0.72]),
        "the wall below X: {:?}",
        wall_ends(&maze)
    );
}

#[test]
fn cell_size_defaults_to_360_mm_and_the_last_one_is_used() {
    assert_eq!(maze(" _\n|_|").cell, Some(0.36));
    assert_eq!(maze("360\n _\n|_|\n").cell, Some(0.36));
    let (maze, diagnostics) = read_maze("m.maz", "360\n _\n|_|\n720");
    assert_eq!((maze.cell, codes(&diagnostics)), (Some(0.72), vec!["maz-cell-twice"]));
}

#[test]
fn cell_size_depends_on_the_dialect() {
    let read = |text: &str, dialect, cell| {
        let (maze, diagnostics) = read_maze_with("m.maz", text, CellRules { dialect, cell });
        (maze.cell.expect("a maze"), codes(&diagnostics))
    };
    let (first, last) = ("720\n _\n|_|\n", " _\n|_|\n720\n");
    let none: Vec<&str> = Vec::new();
    assert_eq!(read(first, None, None), (0.72, vec!["maz-cell-first"]), "nobody says which reading is meant");
    assert_eq!(read(first, Some(Dialect::Vr2023), None), (0.72, none.clone()));
    assert_eq!(read(first, Some(Dialect::Classic), None), (0.72, none.clone()));
    assert_eq!(read(first, Some(Dialect::Vr2018), None), (0.36, vec!["maz-cell-first"]));
    assert_eq!(read(first, Some(Dialect::Vr2018), Some(0.5)), (0.5, none.clone()));
    for dialect in [None, Some(Dialect::Vr2018), Some(Dialect::Vr2023)] {
        assert_eq!(read(last, dialect, None), (0.72, none.clone()), "{dialect:?}");
        assert_eq!(read("360\n _\n|_|\n", dialect, None), (0.36, none.clone()), "both readings agree");
        assert_eq!(read("720\n _\n|_|\n720\n\n", dialect, None), (0.72, none.clone()));
    }
    assert_eq!(read("720\n _\n|_|\n500\n", Some(Dialect::Vr2018), None), (0.5, vec!["maz-cell-first"]));
    assert_eq!(read("720\n _\n|_|\n500\n", None, None), (0.5, vec!["maz-cell-twice"]));
}

#[test]
fn dialect_of_a_sim_file_is_detected_if_its_form_is_unambiguous() {
    let dialect = |text: &str| read_sim("a.sim", text).0.run.dialect;
    let of_2018 = Some(Dialect::Vr2018);
    assert_eq!(dialect("world a.wld\nrobi Own.robi\nOwn 1 2 3 p.x\n"), of_2018);
    assert_eq!(dialect("obj can.esObj\nS4 1 2 3 p.x\n"), of_2018);
    assert_eq!(dialect("robot Own.robi\nOwn 1 2 3 p.x\n"), None);
    assert_eq!(dialect("robi Own.robi\nobject can.esObj\n"), None, "forms of both");
    assert_eq!(dialect("robi Own.robi\nOwn S 90 p.x\n"), None, "letter and heading came later");
    assert_eq!(dialect("robi Own.robi\nOwn s p.x\n"), of_2018);
    assert_eq!(dialect("robi Own.robi p.c 1 2 3\nS4 1 2 3\n"), None, "a classic line loads no type");
}

const S4: &str = "# comment\nname  S4 plus \ndiameter 186\nspeed 600\nturn 300\nmodel S4.ms3d\naxis 40\n\
    psd PSD_FRONT -200 60 20 30 0\npsd PSD_LEFT 56 45 30 90\ncamera 45 0 72 SERVO1(-90, +90) -5 80 60\n\
    wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

#[test]
fn classic_robi_is_read() {
    let (robi, diagnostics) = read_robi("robis/S4.robi", S4);
    assert_eq!(diagnostics, []);
    assert_eq!((robi.name.as_str(), robi.diameter, robi.max_speed, robi.axis_offset), ("S4 plus", 0.186, 0.6, 0.04));
    assert!((robi.max_turn - 300.0 * PI / 180.0).abs() < 1e-12);
    let wheel = WheelSpec { diameter: 0.054, max_rate: 20.0 * PI, ticks_per_turn: 1100.0, track: 0.09 };
    assert_eq!(robi.wheel, wheel);
    assert_eq!((robi.psds[0].id, robi.psds[1].id), (Some(-200), None));
    assert_eq!(robi.psds[1].position, DVec3::new(0.056, 0.045, 0.03));
    assert_eq!((robi.psds[1].angle, robi.psds[1].range), (FRAC_PI_2, 0.8));
    let camera = robi.camera.expect("a camera");
    assert_eq!(camera.pan, JointSpec::Servo { name: "SERVO1".to_owned(), from: -FRAC_PI_2, to: FRAC_PI_2 });
    assert_eq!(camera.image, Some([80, 60]));
    assert_eq!(robi.drive.kind, DriveKind::Differential);
    assert_eq!(robi.drive.motors[1].encoder.as_deref(), Some("QUAD_RIGHT"));
}

const COMPANION: &str = r#"
[drive]
wheelbase_mm = 250
max_steer_deg = 30
wheel_lag_ms = 50
[psd]
range_mm = 2000
PSD_LEFT = { range_mm = 500.0 }
[[infrared]]
name = "IR_LF"
x_mm = 60
angle_deg = 45
[[bumper]]
name = "BUMP_BACK"
id = 7
from_deg = 135
to_deg = -135
[[servo]]
name = "SERVO3"
from_deg = 45
to_deg = -45
[compass]
north_deg = 90
[input]
parallel_data = 0xff
analog = { 3 = 512, 0 = 1 }
latch.1 = 8
digital = { 16 = 1, 2 = 0 }
voltage_v = 6.9
microphone = 200
[serial]
16 = { file = "gps.txt" }
1 = "loopback"
[hdt]
MOTOR_LEFT = 12
"#;

#[test]
fn companion_is_read() {
    let (mut robi, _) = read_robi("S4.robi", S4);
    assert_eq!(read_companion("S4.toml", COMPANION, &mut robi), []);
    assert_eq!((robi.drive.wheelbase, robi.drive.max_steer, robi.drive.wheel_lag), (0.25, PI / 6.0, 0.05));
    assert_eq!((robi.psds[0].range, robi.psds[1].range), (2.0, 0.5));
    let infrared = &robi.infrareds[0];
    assert_eq!((infrared.name.as_str(), infrared.position.x, infrared.range), ("IR_LF", 0.06, 0.1));
    let bumper = &robi.bumpers[0];
    assert_eq!((bumper.id, bumper.from, bumper.to), (Some(7), 0.75 * PI, 1.25 * PI));
    assert_eq!((robi.servos[0].from, robi.servos[0].to), (PI / 4.0, -PI / 4.0));
    assert_eq!(robi.compass.map(|compass| compass.north), Some(FRAC_PI_2));
    assert_eq!((robi.inputs.analog, robi.inputs.latches), (vec![(0, 1), (3, 512)], vec![(1, 8)]));
    assert_eq!(robi.inputs.digital, [(2, 0), (16, 1)]);
    assert_eq!((robi.inputs.voltage, robi.inputs.microphone), (6.9, 200));
    assert_eq!((robi.serials[0].interface, &robi.serials[0].line), (1, &SerialLine::Loopback));
    let SerialLine::File { path, bytes } = &robi.serials[1].line else { panic!("{:?}", robi.serials) };
    assert_eq!((robi.serials[1].interface, path.text.as_str(), bytes.len()), (16, "gps.txt", 0));
    assert_eq!((robi.inputs.parallel_data, robi.hdt), (0xff, vec![("MOTOR_LEFT".to_owned(), 12)]));
}

#[test]
fn files_of_serial_devices_are_inputs() {
    let files = Memory::new(&[
        ("robis/S4.robi", S4),
        ("robis/S4.toml", "[serial]\n3 = { file = \"gps.txt\" }\n4 = { file = \"none.txt\" }\n"),
        ("robis/gps.txt", "$GPGGA\n"),
    ]);
    let (robi, loaded) = load_robi("robis/S4.robi", &files);
    let [gps, none] = &robi.unwrap().serials[..] else { panic!("two interfaces") };
    assert!(matches!(&gps.line, SerialLine::File { bytes, .. } if **bytes == *b"$GPGGA\n"));
    assert!(matches!(&none.line, SerialLine::File { bytes, .. } if bytes.is_empty()));
    assert!(loaded.inputs.iter().any(|input| input.path == "robis/gps.txt"));
    let codes: Vec<Code> = loaded.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    assert_eq!(codes, [Code::FileMissing]);
}

#[test]
fn robots_take_the_starts_in_order() {
    let files = Memory::new(&[
        (
            "sims/a.sim",
            "maze ..\\worlds\\m.maz\nrobi %sim%/robis/S4.robi a.so\nROBI %sim%/robis/S4.robi \"b c.so\" 100 200 -90\nrobi %SIM%/robis/S4.robi a.so\n",
        ),
        ("worlds/m.maz", " ___\n|U R|\n|___|\n1000"),
        ("/home/eyesim/robis/S4.robi", S4),
        ("/home/eyesim/robis/S4.toml", "psd.range_mm = 1500"),
    ]);
    let loaded = load_scene("sims/a.sim", &files);
    assert_eq!(loaded.diagnostics, []);
    let starts: Vec<Pose> = loaded.scene.robots.iter().map(|robot| robot.start).collect();
    assert_eq!(starts, [Pose::new(0.5, 1.5, FRAC_PI_2), Pose::new(0.1, 0.2, -FRAC_PI_2), Pose::new(1.5, 1.5, 0.0)]);
    assert_eq!(loaded.scene.robots[1].program_name(), "b c.so");
    assert_eq!(loaded.scene.robots[1].span.line, 3);
    assert_eq!(loaded.scene.robots[2].robi.psds[0].range, 1.5);
    assert_eq!(loaded.scene.folder, "sims");
    let inputs: Vec<&str> = loaded.inputs.iter().map(|input| input.path.as_str()).collect();
    let expected = ["sims/a.sim", "worlds/m.maz", "/home/eyesim/robis/S4.robi", "/home/eyesim/robis/S4.toml"];
    assert_eq!(inputs, expected);
}

#[test]
fn worlds_of_another_arrangement_of_folders_are_found_with_a_note() {
    let wall = "floor 1000 1000\n";
    let files = Memory::new(&[
        ("x/sims/a.sim", "world ../../worlds/small/w.wld\nS4 500 500 0\n"),
        ("x/sims/w.wld", wall),
        ("x/sims/b.sim", "world ../../worlds/small/home.wld\nS4 500 500 0\n"),
        ("x/sims/c.sim", "world home.wld\nS4 500 500 0\n"),
        ("x/sims/d.sim", "world %sim%/worlds/home.wld\nS4 500 500 0\n"),
        ("/home/eyesim/worlds/home.wld", wall),
        ("/home/eyesim/sims/e.sim", "world ../worlds/home.wld\nS4 500 500 0\n"),
    ]);
    let load = |path: &str| {
        let loaded = load_scene(path, &files);
        (codes(&loaded.diagnostics).join(" "), loaded.inputs[1].path.clone(), loaded.notes)
    };
    let note = "x/sims/c.sim: `home.wld` is that of the installation, `/home/eyesim/worlds/home.wld`";
    let home = "/home/eyesim/worlds/home.wld".to_owned();
    assert_eq!(load("x/sims/a.sim"), ("file-moved".to_owned(), "x/sims/w.wld".to_owned(), vec![]));
    assert_eq!(load("x/sims/b.sim"), ("file-moved".to_owned(), home.clone(), vec![]));
    assert_eq!(load("x/sims/c.sim"), (String::new(), home.clone(), vec![note.to_owned()]));
    assert_eq!(load("x/sims/d.sim"), (String::new(), home.clone(), vec![]));
    assert_eq!(load("/home/eyesim/sims/e.sim"), (String::new(), home, vec![]));
}

#[test]
fn missing_file_error_lists_tried_paths() {
    let files = Memory::new(&[("a/b.sim", "world w.wld\nrobi r.robi p.so 1 2 3\n"), ("a/v.wld", "")]);
    let loaded = load_scene("a/b.sim", &files);
    assert_eq!(codes(&loaded.diagnostics), ["file-missing", "file-missing"]);
    let message = &loaded.diagnostics[0].message;
    for path in ["`a/w.wld`", "`w.wld`", "`/home/eyesim/w.wld`", "`/home/eyesim/worlds/w.wld`"] {
        assert!(message.contains(path), "{message}");
    }
    assert_eq!(loaded.diagnostics[0].suggestion.as_deref(), Some("there is `a/v.wld`"));
    assert!(loaded.has_errors());
    let suggests = |world: &str, suggestion: &str| {
        let files = Memory::new(&[("a/b.sim", &format!("world {world}\n")), ("a/Room.WLD", ""), ("a/rooms/x.wld", "")]);
        assert_eq!(load_scene("a/b.sim", &files).diagnostics[0].suggestion.as_deref(), Some(suggestion), "{world}");
    };
    suggests("room", "there is `a/Room.WLD`");
    suggests("~/x.wld", "`~` and variables such as `$HOME` are not expanded: write the whole path");
}

#[test]
fn file_names_are_found_in_other_letter_case() {
    let files = Memory::new(&[
        ("a.sim", "world Worlds\\Field.WLD\nrobi S4.ROBI p.so 1 2 3\n"),
        ("worlds/field.wld", "floor 10 10"),
        ("s4.robi", S4),
    ]);
    let loaded = load_scene("a.sim", &files);
    assert_eq!(codes(&loaded.diagnostics), ["file-case", "file-case"]);
    assert!(!loaded.has_errors());
    assert_eq!(loaded.scene.robots.len(), 1);
}

#[test]
fn a_robot_without_a_start_is_an_error() {
    let files = Memory::new(&[
        ("a.sim", "world w.wld\nrobi S4.robi p.so\nrobi S4.robi p.so\n"),
        ("w.wld", "floor 1000 1000\nposition 500 500 0\n"),
        ("S4.robi", S4),
    ]);
    let loaded = load_scene("a.sim", &files);
    assert_eq!(codes(&loaded.diagnostics), ["sim-start-missing"]);
    assert_eq!(loaded.diagnostics[0].span.line, 3);
}

#[test]
fn files_of_another_machine_are_found_beside_the_sim() {
    let files = Memory::new(&[
        ("x/a.sim", "world \"C:\\My Files\\w.wld\"\nrobi /home/student/S4.robi p.so 1 2 3\n"),
        ("x/w.wld", "floor 1000 1000"),
        ("x/S4.robi", S4),
    ]);
    let loaded = load_scene("x/a.sim", &files);
    assert_eq!(codes(&loaded.diagnostics), ["file-moved", "file-moved"]);
    assert_eq!(loaded.scene.robots.len(), 1);
}

#[test]
fn files_saved_with_txt_are_read_by_the_extension_before_it() {
    let files = Memory::new(&[
        ("a.sim.txt", "world w.wld\nrobi S4.robi p.so 100 100 3\n"),
        ("w.wld.txt", "floor 1000 1000\n0 0 1 0 10 200 255\n"),
        ("S4.robi", S4),
    ]);
    let loaded = load_scene("a.sim.txt", &files);
    assert_eq!(codes(&loaded.diagnostics), ["file-moved", "wld-wall-arity"]);
    assert_eq!(loaded.diagnostics[0].message, "`w.wld` is not found; `w.wld.txt` is used instead");
    assert_eq!(loaded.scene.world.floor, DVec2::ONE);
    assert_eq!(codes(&load_world("w.wld.txt", &files).diagnostics), ["wld-wall-arity"]);
}

#[test]
fn use_of_an_installed_world_is_noted_and_a_similar_file_is_named() {
    let load = |world: &str, near: &str, text: &str| {
        let sim = format!("world {world}\nS4 500 500 0\n");
        let installed = ("/home/eyesim/worlds/w.wld", "floor 1000 1000");
        load_scene("x/sims/a.sim", &Memory::new(&[("x/sims/a.sim", &sim), installed, (near, text)]))
    };
    let alone = load("w.wld", "x/sims/v.wld", "");
    assert_eq!(alone.diagnostics, []);
    assert_eq!(alone.notes, ["x/sims/a.sim: `w.wld` is that of the installation, `/home/eyesim/worlds/w.wld`"]);
    for near in ["x/sims/maps/w.wld", "x/worlds/W.wld"] {
        let shadowed = load("w.wld", near, "floor 2000 1000");
        assert_eq!(codes(&shadowed.diagnostics), ["file-moved"], "{near}");
        let relative = if near.contains("maps") { "maps/w.wld" } else { "../worlds/W.wld" };
        let expected = format!("write `{relative}`, if that file is meant");
        assert_eq!(shadowed.diagnostics[0].suggestion, Some(expected));
        assert_eq!(load("w.wld", near, "floor 1000 1000").diagnostics, [], "a copy");
    }
    let explicit = load("%sim%/worlds/w.wld", "x/worlds/w.wld", "floor 2000 1000");
    assert_eq!((explicit.diagnostics, explicit.notes), (vec![], vec![]));
    let own = load("../worlds/w.wld", "x/worlds/w.wld", "floor 2000 1000");
    assert_eq!((own.diagnostics, own.notes), (vec![], vec![]));
}

#[test]
fn robot_type_is_read_once_under_all_its_paths() {
    let files = Memory::new(&[
        ("a.sim", "world w.wld\nrobi S4.robi p.so 100 1 0\nrobi ./S4.robi p.so 300 2 0\nrobi S4.robi p.so 500 3 0\n"),
        ("w.wld", "floor 1000 1000"),
        ("S4.robi", &format!("{S4}frobnicate\n")),
    ]);
    let loaded = load_scene("a.sim", &files);
    assert_eq!(codes(&loaded.diagnostics), ["robi-keyword"]);
    assert_eq!((loaded.scene.robots.len(), loaded.inputs.len()), (3, 3));
}

#[test]
fn text_that_is_not_utf8_is_read_with_a_warning() {
    let mut files = Memory::new(&[]);
    files.files.insert("w.wld", b"floor 10 10\r\n; M\xfcller\r\n0 0 5 5\r\n".to_vec());
    let loaded = load_world("w.wld", &files);
    assert_eq!(codes(&loaded.diagnostics), ["file-encoding"]);
    assert_eq!((loaded.diagnostics[0].span.line, loaded.diagnostics[0].span.column), (2, 4));
    assert_eq!(loaded.scene.world.walls.len(), 1);
}

#[test]
fn omni_and_ackermann_robis_are_read() {
    let omni = "diameter 300\nwheel 100 360 7300 220\n\
                drive OMNI_DRIVE MOTOR_FL QUAD_FL MOTOR_FR QUAD_FR MOTOR_BL QUAD_BL MOTOR_BR QUAD_BR\n";
    let (robi, diagnostics) = read_robi("o.robi", omni);
    assert_eq!((diagnostics, robi.drive.motors.len(), robi.drive.wheelbase), (vec![], 4, 0.22));
    let car = "diameter 300\nwheel 100 360 7300 220\ndrive ACKERMANN_DRIVE M Q S\n";
    let (robi, diagnostics) = read_robi("folder/car.robi", car);
    assert_eq!((diagnostics, robi.name.as_str()), (vec![], "car"));
    let motor = MotorSpec { motor: "M".to_owned(), encoder: Some("Q".to_owned()) };
    assert_eq!((robi.drive.motors, robi.drive.steering.as_deref()), (vec![motor], Some("S")));
    assert!((robi.drive.wheelbase - 0.18).abs() < 1e-12, "0.6 of the diameter: {}", robi.drive.wheelbase);
}

#[test]
fn specs_match_snapshots() {
    insta::assert_debug_snapshot!(
        "world",
        read_world("w.wld", "floor 2000 1000\nfloor_texture \"a b.png\"\nposition 1 2 90\n0 0 1 1 2 3 4 5 6\n").0
    );
    insta::assert_debug_snapshot!("maze", read_maze("m.maz", " _\n|S|\n|o|\n|X|\n100").0);
    let (mut robi, _) = read_robi("S4.robi", S4);
    read_companion("S4.toml", COMPANION, &mut robi);
    insta::assert_debug_snapshot!("robi", robi);
    let sim = "world a.wld\nrobi a.robi a.so\nrobi b.robi b.so 1 2 3\nobject 1 2 3 0.5 can.ms3d\n";
    insta::assert_debug_snapshot!("sim", read_sim("s.sim", sim).0);
}
