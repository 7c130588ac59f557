//! Maps and mazes of other programs: occupancy grids, images, MovingAI maps, micro-mouse mazes, worlds of Gazebo.

use std::collections::{BTreeSet, VecDeque};

use glam::DVec2;
use proptest::prelude::*;
use sim_core::pose::Pose;
use sim_core::spec::{StartSpec, WorldSpec};
use sim_format::map::{Cell, Grid, load_scenarios, read_scenarios};
use sim_format::print::print_world;
use sim_format::{
    CellRules, ConvertOptions, Converted, Loaded, MemoryFiles, Severity, convert_with, load_scene, load_world,
    load_world_with, read_world,
};

const YAML: &str = "image: a.pgm\nresolution: 0.05\norigin: [-1.0, -0.5, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
                    free_thresh: 0.196\n";
/// Three columns and two rows: the lower left cell is occupied, the upper right one unknown.
const PGM: &str = "P2\n# by hand\n3 2\n255\n254 254 205\n0 254 254\n";

fn load(files: &[(&str, &[u8])]) -> Loaded {
    let all: MemoryFiles = files.iter().map(|(path, bytes)| (*path, *bytes)).collect();
    load_world(files[0].0, &all)
}

fn codes(loaded: &Loaded) -> Vec<&'static str> {
    loaded.diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect()
}

fn load_yaml(yaml: &str, image: &[u8]) -> Loaded {
    load(&[("m.yaml", yaml.as_bytes()), ("a.pgm", image)])
}

/// The ends of the walls in millimetres, in the order of the world.
fn ends(world: &WorldSpec) -> Vec<[i64; 4]> {
    let mm = |metres: f64| (metres * 1000.0).round() as i64;
    world.walls.iter().map(|wall| [wall.from.x, wall.from.y, wall.to.x, wall.to.y].map(mm)).collect()
}

fn convert(files: &MemoryFiles, from: &str, to: &str, options: ConvertOptions) -> Converted {
    convert_with(from, to, options, files, &|_, _| None)
}

#[test]
fn walls_go_around_the_free_cells_and_close_the_border() {
    let loaded = load_yaml(YAML, PGM.as_bytes());
    assert_eq!(codes(&loaded), [""; 0]);
    let world = &loaded.scene.world;
    assert_eq!(world.floor, DVec2::new(3.0 * 0.05, 2.0 * 0.05));
    // Free cells are on the left of the walls. Vertical walls come before horizontal ones.
    let expected = [
        [0, 100, 0, 50],
        [50, 50, 50, 0],
        [100, 50, 100, 100],
        [150, 0, 150, 50],
        [50, 0, 150, 0],
        [0, 50, 50, 50],
        [150, 50, 100, 50],
        [100, 100, 0, 100],
    ];
    assert_eq!(ends(world), expected);
    let note = &loaded.notes[0];
    for words in ["3 x 2 cells of 50 mm", "4 free, 1 occupied, 1 unknown", "8 walls", "at (1000, 500) mm"] {
        assert!(note.contains(words), "{note}");
    }
}

#[test]
fn a_turned_map_lies_on_its_floor() {
    let turned = YAML.replace("[-1.0, -0.5, 0.0]", "[2.0, 3.0, 1.5707963267948966]");
    let loaded = load_yaml(&turned, b"P1 3 2 111 111");
    assert!(loaded.scene.world.walls.is_empty());
    let loaded = load_yaml(&turned, b"P1 3 2 000 100");
    let world = &loaded.scene.world;
    assert!((world.floor - DVec2::new(0.1, 0.15)).abs().max_element() < 1e-12, "{}", world.floor);
    let (low, high) = world.bounds();
    assert!(low.abs().max_element() < 1e-12 && (high - world.floor).abs().max_element() < 1e-12);
    // The note gives the position of the map's point (0, 0). The corner (2, 3) of the grid is the lower right corner of
    // the floor.
    assert!(loaded.notes[0].contains("at (-1900, -3000) mm"), "{}", loaded.notes[0]);
}

#[test]
fn variants_of_the_yaml_give_the_same_map() {
    let plain = load_yaml(YAML, PGM.as_bytes()).scene.world;
    let same = [
        YAML.replace('\n', "\r\n"),
        YAML.trim_end().to_owned(),
        format!("\u{feff}---\n# made by hand\n{YAML}...\n"),
        YAML.replace("origin: [-1.0, -0.5, 0.0]", "origin:\n  - -1.0\n  - -0.5\n  - 0.0"),
        YAML.replace("origin: [-1.0, -0.5, 0.0]", "origin:\n- -1\n- -0.5\n- 0 # yaw"),
        YAML.replace("origin: [-1.0, -0.5, 0.0]", "origin: [-1.0,\n   -0.5,\n  0.0]"),
        YAML.replace("origin: [-1.0, -0.5, 0.0]", "origin: [ -1e0 , -5.0e-1,0. ]   # a comment"),
        YAML.replace("image: a.pgm", "image: \"a.pgm\"   ").replace("negate: 0", "negate: false"),
        YAML.replace("image: a.pgm", "'image': 'a.pgm'\t").replace("resolution: ", "resolution:\t"),
        format!("{YAML}mode: trinary\n"),
        format!("{YAML}mode: scale\n"),
        YAML.lines().rev().map(|line| format!("{line}  \n")).collect(),
    ];
    for yaml in same {
        let loaded = load_yaml(&yaml, PGM.as_bytes());
        assert_eq!((codes(&loaded), ends(&loaded.scene.world)), (vec![], ends(&plain)), "{yaml}");
    }
    let negated = load_yaml(&YAML.replace("negate: 0", "negate: 1"), b"P2 3 2 255 1 1 50 255 1 1");
    assert_eq!(ends(&negated.scene.world), ends(&plain));
    let raw = load_yaml(&format!("{YAML}mode: raw"), b"P2 3 2 255 0 0 255 100 0 0");
    assert_eq!(ends(&raw.scene.world), ends(&plain));
}

#[test]
fn mistakes_of_a_map_are_reported_with_their_locations() {
    type Expected = (&'static str, u32, u32, Severity);
    let (warning, error) = (Severity::Warning, Severity::Error);
    let cases: [(String, &[Expected]); 15] = [
        (String::new(), &[("map-key", 0, 0, error); 1]),
        (YAML.replace("image: a.pgm\n", ""), &[("map-key", 0, 0, error)]),
        (YAML.replace("a.pgm", "b.pgm"), &[("file-missing", 1, 8, error)]),
        (YAML.replace("resolution: 0.05\n", ""), &[("map-key", 0, 0, error)]),
        (YAML.replace("0.05", "0"), &[("number-range", 2, 13, error)]),
        (YAML.replace("0.05", ".nan"), &[("number-range", 2, 13, error)]),
        (YAML.replace("0.05", "NaN"), &[("number-range", 2, 13, error)]),
        (YAML.replace("0.05", "fine"), &[("number-invalid", 2, 13, error)]),
        (YAML.replace("-0.5", "-.inf"), &[("number-range", 3, 16, error)]),
        (YAML.replace(", 0.0]", ", 0.0, 1]"), &[("map-key", 3, 10, error)]),
        (YAML.replace("negate: 0", "negate: maybe"), &[("map-key", 4, 9, error)]),
        (YAML.replace("free_thresh", "free_tresh"), &[("map-key", 0, 0, warning), ("map-key", 6, 1, warning)]),
        (format!("{YAML}mode: gray\n"), &[("map-key", 7, 7, error)]),
        (format!("{YAML}negate: 0\n"), &[("map-key", 7, 1, warning)]),
        (format!("{YAML}{{image: a}}\n"), &[("map-key", 7, 1, warning)]),
    ];
    for (yaml, expected) in cases {
        let loaded = load_yaml(&yaml, PGM.as_bytes());
        let reported: Vec<Expected> = loaded
            .diagnostics
            .iter()
            .map(|diagnostic| {
                (diagnostic.code.name(), diagnostic.span.line, diagnostic.span.column, diagnostic.severity)
            })
            .collect();
        let is_empty = yaml.is_empty();
        assert!(reported == expected || is_empty && reported.contains(&expected[0]), "{yaml}\n{reported:?}");
    }
}

#[test]
fn every_variant_of_netpbm_is_read() {
    let expected = ends(&load_yaml(YAML, b"P1\n3 2\n0 0 1\n1 0 0\n").scene.world);
    assert_eq!(expected.len(), 8);
    let wide: Vec<u8> = [254_u16, 254, 0, 0, 254, 254].iter().flat_map(|level| (level * 257).to_be_bytes()).collect();
    let images: [Vec<u8>; 10] = [
        b"P1 3 2 001100".to_vec(),
        b"P1#c\r\n3 2\r\n001\r\n100\r\n".to_vec(),
        b"P4\n3 2\n\x20\x80".to_vec(),
        b"P4 3 2 \x3f\x9f\n".to_vec(),
        b"P2\n3 2 # wide and high\n255\n254 254 0\n0 254 254".to_vec(),
        b"P2\t3\t2\t15\t15 15 0 0 15 15   \n\n".to_vec(),
        b"P2 3 2 65535 65535 65000 0 0 65000 65535\n".to_vec(),
        b"P5\n3 2\n255\n\xfe\xfe\x00\x00\xfe\xfe".to_vec(),
        b"P5\n# CREATOR: map\n3 2\n1\n\x01\x01\x00\x00\x01\x01\n".to_vec(),
        [b"P5 3 2 65535\n".to_vec(), wide].concat(),
    ];
    for image in images {
        let loaded = load_yaml(YAML, &image);
        let text = image.escape_ascii().to_string();
        assert_eq!((codes(&loaded), ends(&loaded.scene.world)), (vec![], expected.clone()), "{text}");
    }
    let bitmap = load(&[("a.pbm", b"P1 3 2 001100")]);
    assert_eq!(bitmap.scene.world.floor, DVec2::new(3.0 * 0.05, 0.1), "pixels of 50 mm");
}

#[test]
fn a_png_is_a_map_too() {
    let mut png = Vec::new();
    let levels = [254, 254, 205, 0, 254, 254];
    let image = image::GrayImage::from_raw(3, 2, levels.to_vec()).expect("six pixels");
    image.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).expect("an image");
    let plain = load_yaml(YAML, PGM.as_bytes());
    assert_eq!(load_yaml(YAML, &png).scene.world.walls, plain.scene.world.walls);
    // Clear pixels are unknown in the mode `scale`.
    let pixels = levels.iter().flat_map(|level| [*level; 3].into_iter().chain([if *level == 205 { 9 } else { 255 }]));
    let image = image::RgbaImage::from_raw(3, 2, pixels.collect()).expect("six pixels");
    let mut clear = Vec::new();
    image.write_to(&mut std::io::Cursor::new(&mut clear), image::ImageFormat::Png).expect("an image");
    let loaded = load_yaml(&format!("{YAML}mode: scale"), &clear);
    assert_eq!(loaded.scene.world.walls, plain.scene.world.walls);
}

#[test]
fn broken_images_are_errors_and_allocate_no_memory() {
    let images: [(&[u8], &str); 12] = [
        (b"", "map-image"),
        (b"hello", "map-image"),
        (b"P6 1 1 255 abc", "map-image"),
        (b"P2", "map-image"),
        (b"P2 3", "map-image"),
        (b"P2 3 x 255 1", "map-image"),
        (b"P2 3 2 255 0 0 0 0 0", "map-image"),
        (b"P2 3 2 70000 0 0 0 0 0 0", "map-size"),
        (b"P5 3 2 255\n12345", "map-image"),
        (b"P5 8000000 8000000 255\n", "map-size"),
        (b"P1 8192 8192 0", "map-image"),
        (b"P1 3 2 001200", "map-image"),
    ];
    for (image, code) in images {
        let loaded = load_yaml(YAML, image);
        let text = image.escape_ascii().to_string();
        assert_eq!((codes(&loaded), loaded.has_errors()), (vec![code], true), "{text}");
        assert_eq!(loaded.diagnostics[0].file, "a.pgm");
    }
    let reported = &load_yaml(YAML, b"P2\n3 2\n255\n0 0 0\n0 x 0\n").diagnostics[0];
    assert_eq!((reported.span.line, reported.span.column), (5, 3), "{reported}");
    let reported = &load_yaml(YAML, b"P2\n# \xff\n3 2\n255\n0 0 0\n0 x 0\n").diagnostics[0];
    assert!(reported.span.line == 0 && reported.message.ends_with("at byte 23"), "{reported}");
    let reported = &load_yaml(YAML, b"P5 3 2 255\n123456789").diagnostics[0];
    assert_eq!((reported.severity, reported.message.contains("3 bytes")), (Severity::Warning, true), "{reported}");
}

#[test]
fn a_map_with_too_many_walls_is_refused() {
    let side = 1500;
    let mut image = format!("P5 {side} {side} 255\n").into_bytes();
    image.extend((0..side * side).map(|at| if (at / side + at % side) % 2 == 0 { 0 } else { 254 }));
    assert_eq!(codes(&load_yaml(YAML, &image)), ["map-size"]);
}

#[test]
fn conversion_between_grids_keeps_the_origin() {
    let files: MemoryFiles = [("m.yaml", YAML.as_bytes()), ("a.pgm", PGM.as_bytes())].into_iter().collect();
    let converted = convert(&files, "m.yaml", "sub/b.yaml", ConvertOptions::default());
    let [yaml, image] = &converted.outputs[..] else { panic!("{:?}", converted.diagnostics) };
    assert_eq!((yaml.path.as_str(), image.path.as_str()), ("sub/b.yaml", "sub/b.pgm"));
    assert_eq!(image.bytes, b"P5\n3 2\n255\n\xfe\xfe\xcd\x00\xfe\xfe");
    let expected = "image: b.pgm\nmode: trinary\nresolution: 0.05\norigin: [-1, -0.5, 0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    assert_eq!(yaml.text(), expected);
    let converted = convert(&files, "m.yaml", "b.pbm", ConvertOptions::default());
    assert_eq!(converted.outputs[0].bytes, b"P4\n3 2\n\x20\x80");
    let lost: Vec<&str> = converted.diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
    assert_eq!(lost, ["convert-lost"; 2]);
}

#[test]
fn a_room_becomes_a_map() {
    let room = "floor 1000 600\n0 0 1000 0\n1000 0 1000 600\n1000 600 0 600\n0 600 0 0\n\
                500 0 500 300\n200 310 300 310 40 200\nposition 100 100 0\n";
    let files: MemoryFiles = [("r.wld", room)].into_iter().collect();
    let options = ConvertOptions { map_cell: Some(0.1), ..ConvertOptions::default() };
    let converted = convert(&files, "r.wld", "r.yaml", options);
    let [yaml, image] = &converted.outputs[..] else { panic!("{:?}", converted.diagnostics) };
    assert!(yaml.text().contains("resolution: 0.1\norigin: [-0.1, -0.1, 0]"), "{}", yaml.text());
    let head = b"P5\n12 8\n255\n".len();
    let rows: Vec<String> = image.bytes[head..]
        .chunks(12)
        .map(|row| {
            row.iter()
                .map(|level| match level {
                    0 => '#',
                    254 => '.',
                    _ => '?',
                })
                .collect()
        })
        .collect();
    let expected = [
        "?##########?",
        "#..........#",
        "#..........#",
        "#..#.......#",
        "#..#..#....#",
        "#.....#....#",
        "#.....#....#",
        "?##########?",
    ];
    // The thick wall covers parts of two rows; the thin one fills the cells on its right.
    assert_eq!(rows, expected, "\n{}", rows.join("\n"));
}

#[test]
fn a_scene_becomes_a_map_of_what_its_robots_reach() {
    let scene = "[world]\nfloor_mm = [1000, 1000]\nwall = [{ from_mm = [0, 0], to_mm = [1000, 0] }, \
                 { from_mm = [1000, 0], to_mm = [1000, 1000] }, { from_mm = [1000, 1000], to_mm = [0, 1000] }, \
                 { from_mm = [0, 1000], to_mm = [0, 0] }, { from_mm = [500, 0], to_mm = [500, 1000] }]\n\
                 [[robot]]\ntype = \"S4\"\nx_mm = 250\ny_mm = 500\n";
    let files: MemoryFiles = [("s.scene.toml", scene)].into_iter().collect();
    let options = ConvertOptions { map_cell: Some(0.25), ..ConvertOptions::default() };
    let converted = convert(&files, "s.scene.toml", "s.pgm", options);
    let text = |bytes: &[u8]| {
        bytes
            .iter()
            .map(|level| match level {
                0 => '#',
                254 => '.',
                _ => '?',
            })
            .collect::<String>()
    };
    let image = &converted.outputs[0].bytes;
    assert!(image.starts_with(b"P5\n5 6\n255\n"), "{}", image.escape_ascii());
    // The right half cannot be reached.
    assert_eq!(text(&image[11..16]), "?##??");
    assert_eq!(text(&image[16..21]), "#..#?");
}

/// Grid whose cells are free if their bits are true.
fn grid_of(columns: usize, bits: &[bool], cell: f64) -> Grid {
    let cells = bits.iter().map(|bit| if *bit { Cell::Free } else { Cell::Occupied }).collect();
    Grid { size: [columns, bits.len() / columns], cell, origin: Pose::default(), cells }
}

/// The grid without the margin that holds walls on the edge of the floor.
fn free_cells(grid: &Grid) -> BTreeSet<(i64, i64)> {
    let corner = (grid.origin.position / grid.cell).round();
    let [columns, rows] = grid.size;
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let free = all.filter(|(column, row)| grid.at(*column, *row) == Cell::Free);
    free.map(|(column, row)| (column as i64 + corner.x as i64, row as i64 + corner.y as i64)).collect()
}

proptest! {
    #[test]
    fn a_map_becomes_a_world_and_the_same_map(
        (columns, bits) in (1_usize..12).prop_flat_map(|columns| {
            (Just(columns), (1_usize..12).prop_flat_map(move |rows| prop::collection::vec(any::<bool>(), columns * rows)))
        }),
        mm in 1_u32..2000,
        yaw in prop_oneof![Just(0.0), -4.0..4.0_f64],
    ) {
        let cell = f64::from(mm) / 1000.0;
        let grid = grid_of(columns, &bits, cell);
        let image: String = grid.cells.chunks(columns).rev().map(|row| {
            row.iter().map(|cell| if *cell == Cell::Free { '0' } else { '1' }).collect::<String>() + "\n"
        }).collect();
        let image = format!("P1\n{columns} {}\n{image}", grid.size[1]);
        let yaml = YAML.replace("0.05", &cell.to_string()).replace(", 0.0]", &format!(", {yaw}]"));
        let loaded = load_yaml(&yaml, image.as_bytes());
        prop_assert!(!loaded.has_errors(), "{:?}", loaded.diagnostics);
        let mut world = loaded.scene.world;
        // Each wall has free space on its left and none on its right, so there are as many upwards as downwards.
        let sum = world.walls.iter().fold(DVec2::ZERO, |sum, wall| sum + (wall.to - wall.from));
        prop_assert!(sum.abs().max_element() < 1e-9 * (1.0 + cell * 1000.0), "closed: {}", sum);
        if yaw != 0.0 {
            return Ok(());
        }
        let free = free_cells(&grid);
        let centre = |(column, row): &(i64, i64)| (DVec2::new(*column as f64, *row as f64) + 0.5) * cell;
        world.starts = free.iter().map(centre).map(|at| StartSpec { pose: Pose::new(at.x, at.y, 0.0), ..StartSpec::default() }).collect();
        let again = Grid::of_world(&world, cell).expect("a small map");
        prop_assert_eq!(free_cells(&again), if free.is_empty() { free_cells(&again) } else { free.clone() });
        // Through the text of a `.wld`, too.
        let (read, reported) = read_world("a.wld", &print_world(&world).text);
        prop_assert!(reported.is_empty(), "{:?}", reported);
        prop_assert_eq!(Grid::of_world(&read, cell).expect("a small map"), again);
    }
}

// Micro-mouse mazes.

const POSTS: &str =
    "o---o---o---o\n|       | G |\no   o   o   o\n|   |       |\no   o   o---o\n| S |       |\no---o---o---o\n";
const EYESIM: &str = " _____\n|   | |\n| |  _|\n|S|___|\n";
const NUMBERS: &str = "0 0 0 1 1 1\n0 1 0 1 0 1\n0 2 1 0 0 1\n1 0 0 0 1 1\n1 1 0 0 0 1\n1 2 1 1 0 0\n2 0 1 1 1 0\n\
                       2 1 0 1 1 0\n2 2 1 1 0 1\n";

#[test]
fn a_maze_is_the_same_in_every_form() {
    let drawing = load(&[("a.maz", EYESIM.as_bytes())]);
    let expected: BTreeSet<[i64; 4]> = ends(&drawing.scene.world).into_iter().collect();
    let forms: [(&str, String); 12] = [
        ("a.txt", POSTS.to_owned()),
        ("a.maz", POSTS.to_owned()),
        ("a.map", POSTS.replace('o', "+")),
        ("a.txt", POSTS.replace('\n', "\r\n")),
        ("a.txt", POSTS.trim_end().to_owned()),
        ("a.txt", format!("/* a maze\n{POSTS}*/\nint maze[] = {{ 0x0E }};\n")),
        ("a.txt", POSTS.lines().map(|line| format!("  {line}  \n")).collect()),
        (
            "a.txt",
            POSTS.replace("---", "-").replace("   ", " ").replace(" S ", "S").replace(" G ", "G").replace("| S", "|S"),
        ),
        ("a.txt", POSTS.replace("|       | G", "|\t| G")),
        ("a.num", NUMBERS.to_owned()),
        ("a.num", NUMBERS.lines().rev().map(|line| line.replace(' ', "\t") + "\r\n").collect()),
        ("a.maz", format!("# by hand\n\n{NUMBERS}")),
    ];
    for (name, text) in forms {
        let loaded = load(&[(name, text.as_bytes())]);
        assert_eq!(codes(&loaded), [""; 0], "{text}\n{:?}", loaded.diagnostics);
        let walls: BTreeSet<[i64; 4]> = ends(&loaded.scene.world).into_iter().collect();
        assert_eq!((walls, loaded.scene.world.floor), (expected.clone(), drawing.scene.world.floor), "{text}");
        let start = loaded.scene.world.starts[0];
        assert_eq!((start.pose, start.letter), (drawing.scene.world.starts[0].pose, Some('S')), "{text}");
    }
    let loaded = load(&[("a.txt", POSTS.as_bytes())]);
    assert!(loaded.notes[0].contains("3 x 3 cells; start in cell (0, 0); goal (2, 2); 6 steps"), "{:?}", loaded.notes);
    let rules = CellRules { dialect: None, cell: Some(0.18) };
    let files: MemoryFiles = [("a.txt", POSTS)].into_iter().collect();
    let world = load_world_with("a.txt", rules, &files).scene.world;
    assert_eq!((world.floor, world.cell), (DVec2::splat(3.0 * 0.18), Some(0.18)));
}

#[test]
fn mistakes_of_mazes_are_reported_with_their_locations() {
    let cases: [(&str, String, &str, u32, u32); 12] = [
        ("a.txt", POSTS.replace("o---o---o---o\n|       | G", "o---o---o-- o\n|       | G"), "maz-posts", 1, 10),
        ("a.txt", POSTS.replace("o   o   o   o", "o   o       o"), "maz-posts", 3, 1),
        ("a.txt", POSTS.replace("|   |       |", "|   | x     |"), "maz-letter", 4, 7),
        ("a.txt", POSTS.replace("|   |       |", "|   |       |   |"), "maz-posts", 4, 17),
        ("a.txt", POSTS.strip_suffix("o---o---o---o\n").expect("a border").to_owned(), "maz-posts", 6, 1),
        ("a.txt", POSTS.replace("|       | G |", "|     S | G |"), "maz-letter", 6, 3),
        ("a.txt", POSTS.replace("| G |\n", "| G  \n"), "maz-gap", 0, 0),
        ("a.num", NUMBERS.replace("0 0 0 1 1 1", "0 0 1 1 1 1"), "maz-shared", 1, 1),
        ("a.num", NUMBERS.replace("0 1 0 1 0 1\n", ""), "maz-numbers", 0, 0),
        ("a.num", NUMBERS.replace("0 1 0 1 0 1\n", "0 1 0 1 0 1 1\n0 1 0 1 0 1\n"), "maz-numbers", 2, 1),
        ("a.num", NUMBERS.replace("0 1 0 1 0 1\n", "0 1 0 2 0 1\n0 1 0 1 0 1\n"), "maz-numbers", 2, 1),
        ("a.num", format!("{NUMBERS}0 0 0 1 1 1\n"), "maz-numbers", 10, 1),
    ];
    for (name, text, code, line, column) in cases {
        let loaded = load(&[(name, text.as_bytes())]);
        let reported: Vec<_> =
            loaded.diagnostics.iter().map(|it| (it.code.name(), it.span.line, it.span.column)).collect();
        assert!(reported.contains(&(code, line, column)), "{text}\n{reported:?}");
        assert!(loaded.diagnostics.iter().all(|it| it.severity == Severity::Warning), "{reported:?}");
    }
}

/// Random walls of a maze of `side` times `side` cells, as bits for north, east, south and west, in columns from the
/// south-west corner. The border is closed, and the start is open to the north only.
fn random_maze(side: usize, mut seed: u64, share: u64) -> Vec<u8> {
    let mut draw = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 33) % 100 < share
    };
    let mut walls = vec![0_u8; side * side];
    for x in 0..side {
        for y in 0..side {
            let is_start = x == 0 && y == 0;
            let north = y + 1 == side || !is_start && draw();
            let east = x + 1 == side || is_start || draw();
            walls[x * side + y] |=
                u8::from(north) | u8::from(east) << 1 | u8::from(y == 0) << 2 | u8::from(x == 0) << 3;
            if north && y + 1 < side {
                walls[x * side + y + 1] |= 4;
            }
            if east && x + 1 < side {
                walls[(x + 1) * side + y] |= 8;
            }
        }
    }
    walls
}

/// The drawing of a maze with posts.
fn drawn(walls: &[u8], side: usize, goals: &[[usize; 2]]) -> String {
    let mut text = String::new();
    for y in (0..side).rev() {
        for x in 0..side {
            text.push_str(if walls[x * side + y] & 1 == 1 { "o---" } else { "o   " });
        }
        text.push_str("o\n");
        for x in 0..side {
            text.push(if walls[x * side + y] & 8 == 8 { '|' } else { ' ' });
            text.push_str(match [x, y] {
                [0, 0] => " S ",
                cell if goals.contains(&cell) => " G ",
                _ => "   ",
            });
        }
        text.push_str("|\n");
    }
    text + &"o---".repeat(side) + "o\n"
}

/// Steps from the start to the nearest goal of a drawing, by walking over its characters, without the reader.
fn steps_on_characters(text: &str, goals: &[[usize; 2]]) -> Option<u32> {
    let rows: Vec<Vec<char>> = text.lines().map(|line| line.chars().collect()).collect();
    let cell_of = |[x, y]: [usize; 2]| (rows.len() - 2 - 2 * y, 4 * x + 2);
    let mut costs = vec![vec![u32::MAX; rows[0].len()]; rows.len()];
    let start = cell_of([0, 0]);
    costs[start.0][start.1] = 0;
    let mut open = VecDeque::from([start]);
    while let Some((row, column)) = open.pop_front() {
        let cost = costs[row][column] + 1;
        for (between, next) in [
            ((row - 1, column), (row.wrapping_sub(2), column)),
            ((row + 1, column), (row + 2, column)),
            ((row, column - 2), (row, column.wrapping_sub(4))),
            ((row, column + 2), (row, column + 4)),
        ] {
            if rows[between.0][between.1] == ' ' && costs[next.0][next.1] > cost {
                costs[next.0][next.1] = cost;
                open.push_back(next);
            }
        }
    }
    goals
        .iter()
        .map(|goal| cell_of(*goal))
        .map(|(row, column)| costs[row][column])
        .filter(|cost| *cost < u32::MAX)
        .min()
}

const MIDDLE: [[usize; 2]; 4] = [[7, 7], [7, 8], [8, 7], [8, 8]];

#[test]
fn shortest_paths_agree_with_a_search_on_the_drawing() {
    let mut open = 0;
    for seed in 0..60 {
        for side in [16, 32] {
            let walls = random_maze(side, seed, 25 + seed % 20);
            let goals: &[[usize; 2]] = if side == 16 { &MIDDLE } else { &[[20, 11], [21, 11]] };
            let text = drawn(&walls, side, goals);
            let expected = steps_on_characters(&text, goals);
            open += usize::from(expected.is_some());
            let words = match expected {
                Some(steps) => format!("; {steps} steps from cell to cell"),
                None => "; no path leads".to_owned(),
            };
            let loaded = load(&[("a.txt", text.as_bytes())]);
            assert!(
                codes(&loaded).is_empty() && loaded.notes[0].contains(&words),
                "{text}\n{:?} {words}",
                loaded.notes
            );
            let binary = load(&[("a.maz", &walls)]);
            assert_eq!(codes(&binary), [""; 0], "{:?}", binary.diagnostics);
            assert_eq!(ends(&binary.scene.world), ends(&loaded.scene.world));
            if side == 16 {
                assert!(binary.notes[0].contains(&words), "{:?}", binary.notes);
            }
        }
    }
    assert!(open > 60, "most goals can be reached: {open}");
}

#[test]
fn a_binary_maze_in_another_order_is_read_with_a_warning() {
    let walls = random_maze(16, 3, 30);
    let expected = ends(&load(&[("a.maz", &walls)]).scene.world);
    // By rows from the north-west corner.
    let rows: Vec<u8> = (0..16).rev().flat_map(|y| (0..16).map(move |x| x * 16 + y)).map(|at| walls[at]).collect();
    // West, east, south, north in the bits 0 to 3.
    let turned = |walls: &[u8]| {
        walls.iter().map(|bits| bits >> 3 & 1 | bits & 2 | bits & 4 | (bits & 1) << 3).collect::<Vec<u8>>()
    };
    for other in [rows.clone(), turned(&walls), turned(&rows)] {
        let loaded = load(&[("a.maz", &other)]);
        assert_eq!(codes(&loaded), ["maz-bytes"], "{:?}", loaded.diagnostics);
        assert_eq!(ends(&loaded.scene.world), expected);
    }
}

#[test]
fn mistakes_of_binary_mazes_are_reported_with_their_bytes() {
    let walls = random_maze(16, 5, 30);
    for length in [1, 255, 257, 1023, 5000] {
        let bytes: Vec<u8> = walls.iter().copied().cycle().take(length).collect();
        let loaded = load(&[("a.maz", &bytes)]);
        assert!(codes(&loaded).contains(&"maz-bytes") && loaded.has_errors(), "{length}: {:?}", loaded.diagnostics);
        assert!(loaded.diagnostics[0].message.contains(&format!("{length} bytes")));
    }
    let mut broken = walls.clone();
    let at = (0..255).find(|at| at % 16 < 15 && broken[*at] & 1 == 0).expect("an open side");
    broken[at] |= 1;
    let loaded = load(&[("a.maz", &broken)]);
    assert_eq!(codes(&loaded), ["maz-shared"]);
    assert!(loaded.diagnostics[0].message.contains(&format!("byte {at} (0x")), "{}", loaded.diagnostics[0]);
    let mut flags = walls.clone();
    flags[17] |= 0x80;
    let loaded = load(&[("a.maz", &flags)]);
    assert_eq!(codes(&loaded), ["maz-bytes"]);
    assert!(loaded.diagnostics[0].message.contains("byte 17"), "{}", loaded.diagnostics[0]);
    assert_eq!(loaded.scene.world, load(&[("a.maz", &walls)]).scene.world);
}

// MovingAI.

const MAP: &str = "type octile\nheight 3\nwidth 4\nmap\n....\n.@T.\nG..S\n";

#[test]
fn a_map_of_movingai_is_a_world() {
    let loaded = load(&[("a.map", MAP.as_bytes())]);
    assert_eq!((codes(&loaded), loaded.scene.world.floor), (vec![], DVec2::new(4.0 * 0.36, 3.0 * 0.36)));
    let expected: BTreeSet<[i64; 4]> = [
        [0, 1080, 0, 0],
        [360, 360, 360, 720],
        [1080, 720, 1080, 360],
        [1440, 0, 1440, 1080],
        [0, 0, 1440, 0],
        [1080, 360, 360, 360],
        [360, 720, 1080, 720],
        [1440, 1080, 0, 1080],
    ]
    .into();
    assert_eq!(ends(&loaded.scene.world).into_iter().collect::<BTreeSet<_>>(), expected);
    let same = [
        MAP.replace('\n', "\r\n"),
        MAP.trim_end().to_owned(),
        MAP.replace("....\n", "....   \n"),
        MAP.replace("height 3\nwidth 4", "width\t4\nheight  3"),
        format!("{MAP}\n\n"),
    ];
    for text in same {
        let again = load(&[("a.map", text.as_bytes())]);
        assert_eq!((codes(&again), again.scene.world), (vec![], loaded.scene.world.clone()), "{text}");
    }
    let wrong = [
        (MAP.replace("....", "..x."), vec!["map-cell"]),
        (MAP.replace("....", "..."), vec!["map-size"]),
        (MAP.replace("height 3", "height 4"), vec!["map-size"]),
        (MAP.replace("height 3\n", ""), vec!["map-key"]),
        (MAP.replace("height 3", "height many"), vec!["map-key", "map-key"]),
        (MAP.replace("type octile", "type hexagonal"), vec!["map-key"]),
        (MAP.replace("height 3\nwidth 4", "height 900000\nwidth 900000"), vec!["map-size"]),
        (MAP.replace("\nmap\n", "\n"), vec!["map-key"; 3].into_iter().chain(["map-size"]).collect()),
    ];
    for (text, expected) in wrong {
        let mut found = codes(&load(&[("a.map", text.as_bytes())]));
        found.sort_unstable();
        assert_eq!(found, expected, "{text}");
    }
}

#[test]
fn a_scene_names_a_map() {
    let scene = "[world]\nfile = \"a.map\"\ncell_mm = 500\n[[robot]]\ntype = \"S4\"\nx_mm = 250\ny_mm = 250\n";
    let files: MemoryFiles = [("s.scene.toml", scene), ("a.map", MAP)].into_iter().collect();
    let loaded = load_scene("s.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    assert_eq!((loaded.scene.world.floor, loaded.notes.len()), (DVec2::new(2.0, 1.5), 1));
    let sim: MemoryFiles = [("s.sim", "world a.map\nS4 200 200 0\n"), ("a.map", MAP)].into_iter().collect();
    assert_eq!(load_scene("s.sim", &sim).scene.world.walls.len(), 8);
}

/// Costs by relaxing all steps until nothing changes.
fn relaxed(rows: &[Vec<char>], from: [usize; 2]) -> Vec<Vec<f64>> {
    let is_free = |x: i64, y: i64| {
        let row = usize::try_from(y).ok().and_then(|y| rows.get(y));
        row.zip(usize::try_from(x).ok()).and_then(|(row, x)| row.get(x)).is_some_and(|cell| *cell == '.')
    };
    let mut costs = vec![vec![f64::INFINITY; rows[0].len()]; rows.len()];
    costs[from[1]][from[0]] = 0.0;
    loop {
        let before = costs.clone();
        for y in 0..rows.len() as i64 {
            for x in 0..rows[0].len() as i64 {
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                    let may = is_free(x, y) && is_free(x + dx, y + dy) && is_free(x + dx, y) && is_free(x, y + dy);
                    if may {
                        let length = f64::from((dx * dx + dy * dy) as i32).sqrt();
                        let cost = costs[(y + dy) as usize][(x + dx) as usize] + length;
                        costs[y as usize][x as usize] = costs[y as usize][x as usize].min(cost);
                    }
                }
            }
        }
        if costs == before {
            return costs;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn lengths_of_scenarios_agree_with_brute_force(
        (columns, bits) in (2_usize..12).prop_flat_map(|columns| {
            (Just(columns), (2_usize..12).prop_flat_map(move |rows| prop::collection::vec(0_u8..4, columns * rows)))
        }),
    ) {
        let rows: Vec<Vec<char>> = bits.chunks(columns)
            .map(|row| row.iter().map(|bit| if *bit == 0 { '@' } else { '.' }).collect()).collect();
        let Some(at) = bits.iter().position(|bit| *bit != 0) else { return Ok(()) };
        let from = [at % columns, at / columns];
        let costs = relaxed(&rows, from);
        let text: String = rows.iter().map(|row| row.iter().collect::<String>() + "\n").collect();
        let map = format!("type octile\nheight {}\nwidth {columns}\nmap\n{text}", rows.len());
        let mut scenarios = String::from("version 1\n");
        let mut reachable = 0;
        for (y, row) in costs.iter().enumerate() {
            for (x, cost) in row.iter().enumerate() {
                let cost = if cost.is_finite() { reachable += 1; *cost } else { 0.0 };
                scenarios.push_str(&format!("0\tmaps/x/a.map\t{columns}\t{}\t{}\t{}\t{x}\t{y}\t{cost:.8}\n", rows.len(), from[0], from[1]));
            }
        }
        let files: MemoryFiles = [("a.map.scen", scenarios), ("a.map", map)].into_iter().collect();
        let loaded = load_scenarios("a.map.scen", &files).1;
        let note = format!("{reachable} of {} lengths are those of shortest paths on `a.map`", bits.len());
        prop_assert!(loaded.notes[0].ends_with(&note), "{:?}\n{}\n{}", loaded.notes, note, text);
        prop_assert_eq!(loaded.diagnostics.len(), (bits.len() - reachable).min(1001));
    }
}

#[test]
fn scenarios_become_a_suite() {
    let scenarios = "version 1.0\n0\tmaps/a.map\t4\t3\t0\t0\t3\t2\t4.41421356\n1 maps/a.map 4 3 0 1 3 1 4.82842712\n";
    let files: MemoryFiles = [("a.map.scen", scenarios), ("a.map", MAP)].into_iter().collect();
    let wrong = load_scenarios("a.map.scen", &files).1;
    // Around the block: 2 + 2 + 1 steps, since no corner is cut.
    assert_eq!(wrong.diagnostics.len(), 2, "{:?}", wrong.diagnostics);
    let scenarios = scenarios.replace("4.41421356", "5").replace("4.82842712", "5.0");
    let mut files: MemoryFiles = [("a.map.scen", scenarios.as_str()), ("a.map", MAP)].into_iter().collect();
    let converted = convert(&files, "a.map.scen", "a.suite.toml", ConvertOptions::default());
    assert_eq!(converted.diagnostics, []);
    assert_eq!(
        converted.outputs.iter().map(|it| it.path.as_str()).collect::<Vec<_>>(),
        ["a.suite.toml", "a.scene.toml"]
    );
    for output in &converted.outputs {
        files.insert(output.path.clone(), output.bytes.clone());
    }
    let suite = sim_format::suite::load_suite("a.suite.toml", &files);
    assert_eq!(suite.loaded.diagnostics, [], "{}", converted.outputs[0].text());
    assert_eq!(suite.suite.matrix.cases().len(), 2);
    let arguments = suite.suite.arguments(&suite.suite.matrix.axes(), &suite.suite.matrix.cases()[1]);
    assert_eq!(arguments, ["--scenario 2 --goal 1260 540 --optimum 1800"]);
}

#[test]
fn invalid_scenario_lines_are_reported() {
    let line = "0\ta.map\t4\t3\t0\t0\t3\t2\t5\n";
    for (text, location) in [
        (String::new(), (0, 0)),
        (line.to_owned(), (1, 1)),
        (format!("version 2\n{line}"), (1, 1)),
        ("version 1\n0 a.map 4 3 0 0 3 2\n".to_owned(), (2, 1)),
        (format!("version 1\n{}", line.replace('5', "long")), (2, 21)),
        (format!("version 1\n{}", line.replace('5', "NaN")), (2, 21)),
        (format!("version 1\n{}", line.replace("3\t2\t5", "4\t2\t5")), (2, 1)),
        (format!("version 1\n{}", line.replace("0\ta", "-1\ta")), (2, 1)),
    ] {
        let (_, reported) = read_scenarios("a.scen", &text);
        let locations: Vec<_> = reported
            .iter()
            .map(|diagnostic| (diagnostic.code.name(), diagnostic.span.line, diagnostic.span.column))
            .collect();
        assert_eq!(locations, [("scen-line", location.0, location.1)], "{text}");
    }
}

// Gazebo.

fn sdf(models: &str) -> String {
    format!("<?xml version='1.0'?>\n<sdf version='1.6'>\n<world name='default'>\n{models}</world>\n</sdf>\n")
}

fn model(pose: &str, geometry: &str) -> String {
    format!(
        "<model name='m'><static>1</static><pose frame=''>{pose}</pose><link name='l'><collision name='c'><geometry>{geometry}\
         </geometry></collision><visual name='v'><geometry>{geometry}</geometry></visual></link></model>\n"
    )
}

#[test]
fn cylinders_become_polygons_close_to_their_circles() {
    let geometry = "<cylinder><radius>0.075</radius><length>1</length></cylinder>";
    let models: String = ["-2 3", "-1.85 3"].map(|at| model(&format!("{at} 0.0 0 0 0"), geometry)).concat();
    let loaded = load(&[("w.world", sdf(&models).as_bytes())]);
    assert_eq!(codes(&loaded), [""; 0]);
    let world = &loaded.scene.world;
    assert!(world.walls.iter().all(|wall| wall.height == 0.5 && wall.thickness == 0.0));
    let low = DVec2::new(-2.0, 3.0);
    let centre = DVec2::new(world.floor.x - 0.15, world.floor.y) * 0.5;
    let half = world.walls.len() / 2;
    for wall in &world.walls[..half] {
        let corner = wall.from.distance(centre) - 0.075;
        let side = (0.5 * (wall.from + wall.to)).distance(centre) - 0.075;
        assert!((0.0..=5e-4).contains(&corner) && (-5e-4..=0.0).contains(&side), "{corner} {side}");
    }
    let shift = centre - low;
    let words = format!("at ({}, {}) mm of the world", (shift.x * 1e6).round() / 1e3, (shift.y * 1e6).round() / 1e3);
    assert!(
        loaded.notes[0].contains("2 cylinders, 0 boxes") && loaded.notes[0].contains(&words),
        "{:?} {words}",
        loaded.notes
    );
}

#[test]
fn poses_of_models_links_and_collisions_add_up() {
    let text = sdf("<model name='a'><pose>1 2 0 0 0 1.5707963267948966</pose><link name='l'><pose>1 0 0 0 0 0</pose>\
         <collision name='c'><pose>0 1 0.1 0 0 0</pose><geometry><box><size>0.4 0.2 0.2</size></box></geometry></collision>\
         </link></model><model name='b'><link name='l'><collision name='c'><geometry><sphere><radius>0.001</radius></sphere>\
         </geometry></collision></link></model><model name='floor'><link name='l'><collision name='c'><geometry><plane>\
         <normal>0 0 1</normal><size>9 9</size></plane></geometry></collision></link></model>");
    let loaded = load(&[("w.sdf", text.as_bytes())]);
    assert_eq!(codes(&loaded), [""; 0]);
    // The box is at (1, 2) + turned (1, 1) = (0, 3), and is 0.2 wide and 0.4 high. The world begins at the left of the
    // box and below the sphere.
    let world = &loaded.scene.world;
    assert!((world.floor - DVec2::new(0.2, 3.2)).abs().max_element() < 0.002, "{}", world.floor);
    let (low, high) = world.walls[..4]
        .iter()
        .fold((DVec2::MAX, DVec2::MIN), |(low, high), wall| (low.min(wall.from), high.max(wall.from)));
    assert!((high - low - DVec2::new(0.2, 0.4)).abs().max_element() < 1e-9, "{low} {high}");
    assert!((world.walls[0].height - 0.2).abs() < 1e-12);
    // A saved state moves the model.
    let moved = text.replace(
        "</world>",
        "<state world_name='default'><model name='a'><pose>5 2 0 0 0 0</pose></model></state></world>",
    );
    let loaded = load(&[("w.sdf", moved.as_bytes())]);
    assert!((loaded.scene.world.floor.x - 6.2).abs() < 0.002, "{}", loaded.scene.world.floor);
}

#[test]
fn mistakes_of_worlds_are_reported_with_their_locations() {
    let cylinder = "<cylinder><radius>0.1</radius><length>1</length></cylinder>";
    let good = model("0 0 0 0 0 0", cylinder);
    for (text, code, line) in [
        (String::from("<sdf>"), "sdf-syntax", 1),
        (String::from("<sdf>\n<world></sdf>"), "sdf-syntax", 2),
        (String::from("<robot/>"), "sdf-syntax", 1),
        (String::from("<!-- -->"), "sdf-syntax", 0),
        (sdf(""), "sdf-shape", 0),
        (sdf(&format!("{good}<include><uri>model://x</uri></include>")), "sdf-shape", 5),
        (sdf(&format!("{good}{}", model("0 0 0 1 0 0", cylinder))), "sdf-shape", 5),
        (sdf(&format!("{good}{}", model("0 0 5 0 0 0", cylinder))), "sdf-shape", 5),
        (sdf(&format!("{good}{}", model("0 0 0", cylinder))), "sdf-shape", 5),
        (sdf(&format!("{good}{}", model("0 x 0 0 0 0", cylinder))), "number-invalid", 5),
        (sdf(&format!("{good}{}", model("0 NaN 0 0 0 0", cylinder))), "number-invalid", 5),
        (sdf(&format!("{good}{}", model("0 0 0 0 0 0", "<mesh><uri>a.dae</uri></mesh>"))), "sdf-shape", 5),
        (sdf(&format!("{good}{}", model("0 0 0 0 0 0", &cylinder.replace("0.1", "-1")))), "sdf-shape", 5),
    ] {
        let loaded = load(&[("w.world", text.as_bytes())]);
        let reported: Vec<_> =
            loaded.diagnostics.iter().map(|diagnostic| (diagnostic.code.name(), diagnostic.span.line)).collect();
        assert!(reported.contains(&(code, line)), "{text}\n{reported:?}");
    }
    let deep = "<sdf>".repeat(100_000);
    assert_eq!(codes(&load(&[("w.sdf", deep.as_bytes())])), ["sdf-syntax"]);
    // A `.world` that is not XML is read as a list of walls.
    assert_eq!(codes(&load(&[("w.world", b"floor 1000 1000\n0 0 1000 0\n")])), [""; 0]);
}
