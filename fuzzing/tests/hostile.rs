//! Inputs made to break a reader: huge numbers, huge names, deep nesting, very many lines.
//!
//! For each input, the reader must keep the invariants of [`fuzzing`]; one of them bounds the number of diagnostics per
//! file. No test measures time: the inputs are so large that a reader of quadratic complexity would not finish (40,000
//! lines squared take minutes). Calls to the file system during a load are counted.

use std::cell::Cell;
use std::fmt::Write;

use fuzzing::archive::Archive;
use fuzzing::{TARGETS, check};
use sim_format::{Code, FileError, Files, Loaded};

const MANY: usize = 40_000;

/// Extreme numbers, and words that are not numbers.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1e9",
    "-1e9",
    "1.0000000001e9",
    "1e308",
    "-1e308",
    "1e309",
    "1e-308",
    "5e-324",
    "1e-400",
    "nan",
    "-nan",
    "inf",
    "-infinity",
    "0x10",
    "1_000",
    "1e",
    "+",
    "--1",
    "9223372036854775808",
    "-9223372036854775809",
    "4294967296",
    "٣",
    "½",
    "1,5",
];

/// Lines of each format with a placeholder `#` for each number.
const LINES: &[(&str, &[&str])] = &[
    (
        "world",
        &[
            "# # # #",
            "# # # # # #",
            "# # # # # # # # #",
            "floor # #",
            "width #",
            "height #",
            "push # # #",
            "position # # #",
        ],
    ),
    ("maze", &["#", "| |\n#", " _\n|#|", " _\n|S|\n#"]),
    (
        "robi",
        &[
            "diameter #",
            "speed #",
            "turn #",
            "axis #",
            "axis # #",
            "psd P # # # # #",
            "psd # P # # # # # #",
            "psd P # # # #",
            "camera # # # # # # #",
            "camera 0 0 0 S(#,#) # 1 1",
            "wheel # # # #",
            "wheel drive # # # #",
            "wheel turn # # # #",
            "axel drive # #",
            "axel turn # #",
            "mass # # # #",
            "collider box # # # # # #",
            "collider sphere # # # #",
            "collider capsule # # # # #",
            "lidar # #",
            "lidar # # #",
            "fisheye #",
            "model a.obj # # # # # #",
        ],
    ),
    (
        "companion",
        &[
            "drive.wheelbase_mm = #",
            "drive.max_steer_deg = #",
            "drive.wheel_lag_ms = #",
            "psd.range_mm = #",
            "[[infrared]]\nname = \"I\"\nid = #\nx_mm = #\nangle_deg = #\nrange_mm = #",
            "[[bumper]]\nname = \"B\"\nfrom_deg = #\nto_deg = #",
            "[[servo]]\nname = \"S\"\nfrom_deg = #\nto_deg = #",
            "compass.north_deg = #",
            "input.parallel_data = #",
            "input.analog = { # = # }",
            "hdt.X = #",
        ],
    ),
    (
        "esobj",
        &[
            "scale #",
            "mass # # # #",
            "capsule # # # # # y",
            "sphere # # # #",
            "box # # # # # #",
            "buoyancy #",
            "collider capsule # # # # # z",
            "obj a.obj # # # # # #",
        ],
    ),
    (
        "sim",
        &[
            "robi a.robi a.so # # #",
            "object # # # # a.ms3d",
            "S4 # # #",
            "S4 S #",
            "S4 S # p",
            "LabBot # # # p",
            "can # # #",
            "marker # #",
            "marker # # # # #",
            "marker # # # # # #",
        ],
    ),
    (
        "scene",
        &[
            "scene.seed = #",
            "scene.slot_ms = #",
            "scene.until_s = #",
            "scene.costs.robios6.OSWait = #",
            "world.floor_mm = [#, #]",
            "world.maze = \" _\\n|_|\"\nworld.cell_mm = #",
            "[[world.wall]]\nfrom_mm = [#, #]\nto_mm = [#, #]\nthickness_mm = #\nheight_mm = #\ncolour = [#, #, #]",
            "[[world.start]]\nx_mm = #\ny_mm = #\nheading_deg = #",
            "[[robot_type]]\nname = \"B\"\ndiameter_mm = #\nmax_speed_mm_per_s = #\nmax_turn_deg_per_s = #\naxis_mm = #",
            "[[robot_type]]\nname = \"B\"\nwheel = { diameter_mm = #, max_rate_deg_per_s = #, ticks_per_turn = #, track_mm = # }",
            "[[object_type]]\nname = \"B\"\nmass_kg = #\nfriction = #\nrolling = #\nrestitution = #\nmodel.scale_mm = #",
            "[[object_type]]\nname = \"B\"\ncollider = [{ kind = \"box\", centre_mm = [#, #, #], size_mm = [#, #, #] }]",
            "[[object_type]]\nname = \"B\"\ncollider = [{ kind = \"capsule\", radius_mm = #, height_mm = #, axis = \"z\" }]",
            "[[robot]]\ntype = \"S4\"\nx_mm = #\ny_mm = #\nheading_deg = #",
            "[[robot]]\ntype = \"S4\"\ncount = #\nlayout = { kind = \"line\", from_mm = [#, #], to_mm = [#, #], heading_deg = # }",
            "[[robot]]\ntype = \"S4\"\ncount = #\nlayout = { kind = \"grid\", from_mm = [#, #], spacing_mm = [#, #], columns = # }",
            "[[robot]]\ntype = \"S4\"\ncount = #\nlayout = { kind = \"circle\", centre_mm = [#, #], radius_mm = #, first_deg = # }",
            "[[robot]]\ntype = \"S4\"\ncount = #\nlayout = { kind = \"random\", from_mm = [#, #], to_mm = [#, #], clearance_mm = # }",
            "[[marker]]\nx_mm = #\ny_mm = #\nopacity = #\ncolour = [#, #, #]",
        ],
    ),
    ("costs", &["[robios6]\nOSWait = #", "robios7 = { \"*\" = # }"]),
    (
        "noise",
        &[
            "psd.sigma_mm = #\npsd.sigma_percent = #\npsd.bias_mm = #\npsd.bias_sigma_mm = #\npsd.step_mm = #",
            "base = \"real\"\npsd = { outlier = #, dropout = #, drift_mm = #, drift_s = # }",
            "[sensor]\nA = { sigma_mm = #, device = # }",
            "[drive]\nleft_percent = #\ndiameter_sigma_percent = #\nslip_percent = #\nomega_sigma_deg_s = #",
            "[odometry]\nv_sigma_mm_s = #\nstep_mm = #\nstep_deg = #",
        ],
    ),
    ("mesh", &["v # # #", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf # # #", "v 0 0 0\nf #/#/# #//# #/#", "vt # #\nvn # # #"]),
];

#[test]
fn numbers_of_any_size_hold() {
    for (target, lines) in LINES {
        for line in *lines {
            for number in NUMBERS {
                check(target, line.replace('#', number).as_bytes());
                // One number at a time, so that one error does not hide another.
                let positions: Vec<usize> = line.match_indices('#').map(|(position, _)| position).collect();
                for &position in &positions {
                    let one = format!("{}{number}{}", &line[..position], line[position + 1..].replace('#', "1"));
                    let one = one.replace('#', "1");
                    check(target, one.as_bytes());
                }
            }
        }
    }
}

#[test]
fn a_name_of_a_quarter_megabyte_is_handled() {
    let name = "n".repeat(1 << 18);
    for target in TARGETS {
        for line in [
            "#",
            "world #",
            "floor_texture #",
            "name #",
            "model #",
            "drive #",
            "obj #",
            "[#]",
            "# = 1",
            "-- # --",
            "|#",
            "S4 S #",
            "robi # # 1 2 3",
            "object 1 2 3 0 #",
            "psd # 1 2 3 4 5",
            "camera 1 2 3 #(1,2) 4",
            "usemtl #",
            "mtllib #",
            "\"#",
            "v #",
        ] {
            check(target.name, line.replace('#', &name).as_bytes());
        }
    }
}

#[test]
fn deep_nesting_is_handled() {
    for target in ["companion", "scene", "costs", "noise"] {
        check(target, format!("a = {}", "[".repeat(MANY)).as_bytes());
        check(target, format!("a = {}", "{a=".repeat(MANY)).as_bytes());
        check(target, format!("a{} = 1", ".a".repeat(MANY)).as_bytes());
        check(target, format!("[a{}]", ".a".repeat(MANY)).as_bytes());
    }
    check("world", "push 1 1 1\n".repeat(10 * MANY).as_bytes());
    check("world", format!("{}{}0 0 1 1", "push 1 1 1\n".repeat(MANY), "pop\n".repeat(MANY + 1)).as_bytes());
    check("robi", format!("camera 1 2 3 {}", "S(".repeat(MANY)).as_bytes());
    check("sim", format!("world {}", "\"'".repeat(MANY)).as_bytes());
}

#[test]
fn very_many_lines_are_handled() {
    let lines: &[(&str, &str)] = &[
        ("world", "0 0 1 #\n"),
        ("world", "0 0 1 # 10 300 1 2 3\n"),
        ("world", "position 1 2 #\n"),
        ("world", "floor # #\n"),
        ("world", "mistake #\n"),
        ("maze", "|S|_|_|\n"),
        ("maze", "||\n"),
        ("maze", "\n"),
        ("robi", "psd P# # 1 2 3 4\n"),
        ("robi", "collider sphere 1 2 3 #\n"),
        ("robi", "wheel 1 2 3 #\n"),
        ("companion", "[[servo]]\nname = \"S#\"\n"),
        ("companion", "hdt.a# = #\n"),
        ("companion", "a# = 1\n"),
        ("scene", "[[robot]]\ntype = \"T#\"\nx_mm = #\ny_mm = 1\n"),
        ("scene", "[[robot_type]]\nname = \"T#\"\n"),
        ("scene", "[[world.wall]]\nfrom_mm = [0, 0]\nto_mm = [1, #]\n"),
        ("costs", "[robios6.a#]\n"),
        ("costs", "robios6.A# = #\n"),
        ("noise", "sensor.A#.sigma_mm = #\n"),
        ("noise", "[psd#]\n"),
        ("esobj", "collider sphere 1 2 3 #\n"),
        ("sim", "robi a#.robi a.so # 2 3\n"),
        ("sim", "robi a#.robi\n"),
        ("sim", "object a#.esObj\n"),
        ("sim", "S4 # 2 3 p#.x\n"),
        ("sim", "unknown# 1 2 3\n"),
        ("sim", "marker # 2 3 4 5\n"),
        ("mesh", "v 1 2 #\nf -1 -2 -3\n"),
        ("mesh", "usemtl m#\n"),
        ("mesh", "mtllib m#\n"),
    ];
    for (target, line) in lines {
        let mut text = String::new();
        for number in 0..MANY {
            text += &line.replace('#', &number.to_string());
        }
        check(target, text.as_bytes());
    }
}

#[test]
fn very_long_rows_are_handled() {
    check("maze", format!("{}\n|{}|\n", " _".repeat(MANY), "_ ".repeat(MANY)).as_bytes());
    check("maze", format!(" _\n|{}", "S ".repeat(MANY)).as_bytes());
    check("world", "1 ".repeat(MANY).as_bytes());
    check("sim", format!("S4 1 2 3 p{}", " a".repeat(MANY)).as_bytes());
    check("robi", format!("drive {}", "X ".repeat(MANY)).as_bytes());
    check("mesh", format!("v 0 0 0\nv 0 0 1\nv 0 1 0\nf{}", " 1 2 3".repeat(MANY)).as_bytes());
    check("companion", format!("input.analog = {{ {} }}", "1 = 1, ".repeat(MANY)).as_bytes());
}

/// Counts the calls to an archive's file system.
struct Counted {
    archive: Archive,
    calls: Cell<usize>,
}

impl Files for Counted {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        self.calls.set(self.calls.get() + 1);
        self.archive.read(path)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        self.calls.set(self.calls.get() + 1);
        self.archive.list(folder)
    }

    fn home(&self) -> Option<&str> {
        self.archive.home()
    }
}

fn load(text: &str) -> (Loaded, usize) {
    let files = Counted { archive: Archive::new(text.as_bytes()), calls: Cell::new(0) };
    let loaded = sim_format::load_scene(files.archive.first(), &files);
    (loaded, files.calls.get())
}

const ROBOT: &str = "-- a.robi --\ndiameter 100\nwheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";

#[test]
fn the_file_of_a_type_with_many_robots_is_read_once() {
    let mut sim = String::from("-- a.sim --\nworld w.wld\n");
    for number in 0..MANY {
        writeln!(sim, "robi a.robi p.so {} {} 0", 200 * (number % 316) + 100, 200 * (number / 316) + 100).unwrap();
    }
    let (loaded, calls) = load(&format!("{sim}-- w.wld --\nfloor 64000 64000\n{ROBOT}"));
    assert_eq!((loaded.scene.robots.len(), loaded.diagnostics.len()), (MANY, 0));
    assert!(calls < 20, "{calls} calls");
    check("load_scene", format!("{sim}-- w.wld --\nfloor 64000 64000\n{ROBOT}").as_bytes());
}

#[test]
fn diagnostics_of_robots_on_one_spot_are_truncated() {
    let sim = format!("-- a.sim --\nworld w.wld\n{}", "robi a.robi p.so 500 500 0\n".repeat(MANY / 10));
    let (loaded, _) = load(&format!("{sim}-- w.wld --\nfloor 1000 1000\n0 0 1000 0\n{ROBOT}"));
    assert_eq!(loaded.scene.robots.len(), MANY / 10);
    assert!(loaded.diagnostics.len() < 2000, "{} diagnostics", loaded.diagnostics.len());
    assert!(loaded.diagnostics.iter().any(|diagnostic| diagnostic.code == Code::FileMore));
}

#[test]
fn missing_files_cost_a_fixed_number_of_file_calls_each() {
    let scene = |robots: usize| {
        let mut sim = String::from("-- a.sim --\nworld w.wld\n");
        for number in 0..robots {
            writeln!(sim, "robi types/a{number}.robi p.so 500 500 0").unwrap();
        }
        load(&format!("{sim}-- w.wld --\nfloor 1000 1000\n"))
    };
    let (few, calls_for_few) = scene(1000);
    let (_, calls_for_many) = scene(10_000);
    assert!(few.has_errors());
    assert!(calls_for_many <= 10 * calls_for_few, "{calls_for_few} calls for 1000, {calls_for_many} for 10000 files");
}
