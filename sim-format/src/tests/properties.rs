//! Properties of the readers for arbitrary texts.

use std::collections::BTreeSet;
use std::fmt::Write;

use glam::DVec3;
use proptest::prelude::*;

use super::super::*;
use sim_core::sensor::RangeModel;
use sim_core::unit::{metres_from_mm, radians_from_degrees};

const VALID: [&str; 10] = [
    "floor 4000 3000\npush 10 20 90\n0 0 100 0\n0 0 10 10 5 200 1 2 3\npop\nposition 1 2 3\nfloor_texture \"a b.png\"\n",
    "360\n _____\n|S|  X|\n|o_.u_|\n|_____|\n720\n",
    "  __ __\n |S |x |\n |__|__|\n",
    super::S4,
    super::robi::VR,
    super::robi::NEWEST,
    "world %sim%\\a.wld\nrobi a.robi 'b c.so' 1 2 3\nobject 1 2 3 0.1 x.ms3d\nsettings VIS\n",
    "maze m.maz\nsettings VIS trace\nrobot a.robi\nobject C:\\s/s.esObj\nS4 S 90 a.py\nlabbot 1 2 3 \"b c.x\"\nScout 1 2 3 02.x\n\
     Sign 5 5 0\ncan 1 2 3\nmarker 1 2 255 0 0 9\n",
    "obj a.obj\nname \"A b\"\nscale 0.025\nmass 2 0 0 0\ncollider capsule 0 7500 0 150 14200 y\nbox 0 1 0 2 2 2\n\
     sphere 0 0 0 5\nbuoyancy 0\nfixed\nfriction 0.5\nrolling 0.1\nrestitution 1\ncolour 1 2 3\n",
    "servo = [{ name = \"S\" }]\nlink = [{ name = \"a\", on = \"b\", servo = \"S\", axis = \"x\" }, { name = \"b\", roll_deg = 3 }]\n\
     laser = [{ name = \"L\", on = \"a\", min_mm = 1, max_mm = 2 }]\nultrasonic = [{ name = \"U\" }]\n\
     reflectance = [{ name = \"R\" }]\nsonar = [{ name = \"N\", side_lobes = { angle_deg = 9, half_width_deg = 1, gain = 1 } }]\n\
     lidar = { on = \"b\", z_mm = 9, range_mm = 5 }\nsurface = { specular = 1 }\n",
];

/// Reads `text` with every reader and checks the invariants of any text.
fn read_all(text: &str) {
    let (world, world_diagnostics) = read_world("f", text);
    let (maze, maze_diagnostics) = read_maze("f", text);
    let (mut robi, robi_diagnostics) = read_robi("f", text);
    let companion_diagnostics = read_companion("f", text, &mut robi);
    let (sim, sim_diagnostics) = read_sim("f", text);
    let (object, object_diagnostics) = read_esobj("f", text);
    // Reads a scene with the files that it refers to, and places all its entities.
    let loaded =
        load_scene("a.sim", &super::Memory::new(&[("a.sim", text), ("a.robi", super::S4), ("s.esObj", VALID[5])]));
    for placed in &loaded.scene.objects {
        assert!(placed.pose.position.is_finite() && placed.friction >= 0.0, "{placed:?}");
    }
    assert!(loaded.scene.robots.iter().all(|robot| robot.start.position.is_finite()));
    assert!(object.mass > 0.0 && object.scale > 0.0 && object.centre_of_mass.abs().max_element() <= MAX_LENGTH);
    assert!(!object.colliders.is_empty());
    for collider in &object.colliders {
        let (centre, sizes) = match *collider {
            Collider::Box { centre, size } => (centre, size.to_array()),
            Collider::Sphere { centre, radius } => (centre, [radius; 3]),
            Collider::Capsule { centre, radius, height, .. } => (centre, [radius, height, height - 1.999 * radius]),
            Collider::Cylinder { centre, radius, height } => (centre, [radius, radius, height]),
        };
        assert!(centre.abs().max_element() <= MAX_LENGTH, "{collider:?}");
        assert!(sizes.iter().all(|size| *size > 0.0 && *size <= MAX_LENGTH), "{collider:?}");
    }
    for world in [&world, &maze] {
        assert!(world.floor.is_finite() && world.floor.max_element() <= MAX_LENGTH);
        for wall in &world.walls {
            assert!(wall.from.abs().max(wall.to.abs()).max_element() <= MAX_LENGTH && wall.from != wall.to, "{wall:?}");
            assert!(wall.thickness >= 0.0 && wall.height > 0.0, "{wall:?}");
        }
        assert!(world.starts.iter().all(|start| start.pose.position.is_finite()));
    }
    assert!(robi.diameter > 0.0 && robi.wheel.diameter > 0.0 && robi.wheel.track > 0.0 && robi.drive.wheelbase > 0.0);
    assert!(robi.mass > 0.0 && robi.traction >= 0.0 && robi.max_speed > 0.0 && robi.max_turn > 0.0);
    assert!(robi.diameter <= MAX_LENGTH && robi.drive.wheelbase.is_finite() && robi.axis_offset.is_finite());
    assert!(robi.centre_of_mass.is_finite() && robi.colliders.iter().all(|collider| collider.reach().is_finite()));
    assert!(robi.camera.as_ref().is_none_or(|camera| camera.position.is_finite()));
    assert!(robi.lidar.as_ref().is_none_or(|lidar| lidar.points > 0 && lidar.sweep > 0.0 && lidar.tilt.is_finite()));
    assert!(robi.psds.iter().all(|psd| psd.position.is_finite() && psd.range > 0.0));
    for range in &robi.ranges {
        let MountSpec { position, roll, pitch, yaw, .. } = range.mount;
        assert!(position.is_finite() && roll.is_finite() && pitch.is_finite() && yaw.is_finite(), "{range:?}");
        let (min, max) = match &range.model {
            RangeModel::Laser(echo) | RangeModel::Ultrasonic(echo) | RangeModel::Reflectance(echo) => {
                (echo.min, echo.max)
            }
            RangeModel::Sonar(sonar) => (sonar.min, sonar.max),
            RangeModel::Psd { range } => (0.0, *range),
        };
        assert!(0.0 <= min && min < max && max <= MAX_LENGTH && range.sigma.is_finite(), "{range:?}");
    }
    // Links can be ordered with parents first, and sensors are on existing links.
    assert_eq!(sim_core::build::links(&robi).len(), robi.links.len());
    assert_eq!(sim_core::build::range_sensors(&robi).len(), robi.psds.len() + robi.ranges.len());
    assert!(sim.robots.iter().all(|robot| !matches!(robot.start, StartRef::Pose(pose) if !pose.position.is_finite())));
    for diagnostic in [
        world_diagnostics,
        maze_diagnostics,
        robi_diagnostics,
        companion_diagnostics,
        sim_diagnostics,
        object_diagnostics,
    ]
    .concat()
    {
        let Span { start, end, .. } = diagnostic.span;
        assert!(text.get(start..end).is_some(), "{diagnostic:?} does not lie in the text");
        assert!(!diagnostic.message.is_empty() && !diagnostic.expected.is_empty());
    }
}

/// One of the valid texts with some bytes changed, removed or duplicated.
fn mutated() -> impl Strategy<Value = Vec<u8>> {
    let change = (any::<prop::sample::Index>(), 0..4_u8, any::<u8>());
    (0..VALID.len(), prop::collection::vec(change, 1..8)).prop_map(|(text_index, changes)| {
        let mut bytes = VALID[text_index].as_bytes().to_vec();
        for (index, kind, byte) in changes {
            let index = index.index(bytes.len().max(1));
            match kind {
                0 if index < bytes.len() => bytes[index] = byte,
                1 if index < bytes.len() => drop(bytes.remove(index)),
                2 => bytes.insert(index, byte),
                _ => bytes.extend_from_within(index..),
            }
        }
        bytes
    })
}

/// Words of files: numbers, keywords and others, valid and invalid.
fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<f64>().prop_map(|number| number.to_string()),
        (-10_000..10_000_i32).prop_map(|number| number.to_string()),
        prop::sample::select(
            &[
                "floor",
                "push",
                "pop",
                "position",
                "psd",
                "wheel",
                "drive",
                "camera",
                "robi",
                "object",
                "S4",
                "can",
                "marker",
                "settings",
                "mass",
                "capsule",
                "collider",
                "scale",
                "y",
                "s",
                "inf",
                "nan",
                "1e308",
                "x",
                "\"",
                "S1(-1,1)",
                "(",
                "[drive]",
                "=",
                "360",
                "|",
                "_",
                ";",
                "#",
                "\n",
                "\t",
                "-0",
                "1e9",
                "OMNI_DRIVE",
                "ACKERMANN_DRIVE",
                "collider",
                "box",
                "capsule",
                "mass",
                "axis",
                "axel",
                "turn",
                "lidar",
                "fisheye",
                "model"
            ][..]
        )
        .prop_map(str::to_owned),
    ]
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_all(&decode(&bytes).0);
    }

    #[test]
    fn arbitrary_texts_never_panic(text in "\\PC{0,200}") {
        read_all(&text);
    }

    #[test]
    fn mutated_files_never_panic(bytes in mutated()) {
        read_all(&decode(&bytes).0);
    }

    #[test]
    fn words_in_any_order_never_panic(words in prop::collection::vec(word(), 0..60)) {
        read_all(&words.join(" "));
        read_all(&words.join("\n"));
    }

    #[test]
    fn worlds_round_trip(walls in prop::collection::vec(prop::array::uniform4(-1_000_000..1_000_000_i32), 0..40)) {
        let walls: Vec<_> = walls.into_iter().filter(|wall| wall[..2] != wall[2..]).collect();
        let mut text = String::from("floor 5000 4000\r\n");
        for [a, b, c, d] in &walls {
            write!(text, " {a}\t{b} {c}  {d} ;comment\r\n").unwrap();
        }
        let (world, diagnostics) = read_world("w", &text);
        prop_assert_eq!(diagnostics, vec![]);
        let read: Vec<_> = world.walls.iter().map(|wall| [wall.from.x, wall.from.y, wall.to.x, wall.to.y]).collect();
        let written: Vec<_> = walls.iter().map(|wall| wall.map(|mm| metres_from_mm(f64::from(mm)))).collect();
        prop_assert_eq!(read, written);
    }

    #[test]
    fn psds_round_trip(psds in prop::collection::vec((-900..900_i32, -900..900_i32, 0..900_i32, -360..360_i32), 0..9)) {
        let mut text = String::from("wheel 50 3600 1000 90\ndrive DIFFERENTIAL_DRIVE A B C D\n");
        for (id, (x, y, z, angle)) in psds.iter().enumerate() {
            writeln!(text, "psd PSD{id} {id} {x} {y} {z} {angle}").unwrap();
        }
        let (robi, diagnostics) = read_robi("r", &text);
        prop_assert_eq!(diagnostics, vec![]);
        let read: Vec<_> = robi.psds.iter().map(|psd| (psd.position.to_array(), psd.angle)).collect();
        let written: Vec<_> = psds
            .iter()
            .map(|&(x, y, z, angle)| {
                ([x, y, z].map(|mm| metres_from_mm(f64::from(mm))), radians_from_degrees(f64::from(angle)))
            })
            .collect();
        prop_assert_eq!(read, written);
    }

    /// Coordinates in the axes of EyeSim VR are converted to ours, with both forms of `psd`.
    #[test]
    fn robis_of_eyesim_vr_round_trip(
        sizes in prop::collection::vec(prop::array::uniform3(1..900_i32), 1..6),
        positions in prop::collection::vec(prop::array::uniform3(-900..900_i32), 6),
        is_newest in any::<bool>(),
    ) {
        let mut text = String::from("drive DIFFERENTIAL_DRIVE\ndiameter 400\nwheel 50 3600 1000 45\n");
        for (index, (size, [right, up, forward])) in sizes.iter().zip(&positions).enumerate() {
            let [x, y, z] = size;
            writeln!(text, "collider box {x} {y} {z} {right} {up} {forward}").unwrap();
            let id = index + 1;
            if is_newest {
                writeln!(text, "psd {id} PSD{id} {right} {up} {forward} 0 {x} 0").unwrap();
            } else {
                writeln!(text, "psd PSD{id} {id} {right} {up} {forward} {x}").unwrap();
            }
        }
        let (robi, diagnostics) = read_robi("r", &text);
        prop_assert_eq!(diagnostics, vec![]);
        prop_assert_eq!(robi.wheel.track, 0.09);
        let metres = |mm: i32| metres_from_mm(f64::from(mm));
        for ((collider, psd), (size, position)) in robi.colliders.iter().zip(&robi.psds).zip(sizes.iter().zip(&positions)) {
            let [right, up, forward] = position.map(metres);
            let [x, y, z] = size.map(metres);
            let (centre, box_size) = (DVec3::new(forward, -right, up), DVec3::new(z, x, y));
            prop_assert_eq!(*collider, Collider::Box { centre, size: box_size });
            // The coordinates of a PSD are in our axes in the file, too.
            prop_assert_eq!(psd.position, DVec3::new(right, up, forward));
            prop_assert_eq!(psd.angle, radians_from_degrees(f64::from(size[0])));
        }
        prop_assert_eq!(robi.colliders.len(), sizes.len());
    }

    /// The walls of a maze consist of exactly the drawn pieces, and no wall continues another one.
    #[test]
    fn mazes_round_trip(rows in 1..7_usize, columns in 1..7_usize, bits in prop::collection::vec(any::<bool>(), 200)) {
        let mut bits = bits.into_iter().cycle();
        let mut drawn = BTreeSet::new();
        let mut text = String::new();
        for row in 0..=rows {
            for column in 0..=2 * columns {
                let is_wall = bits.next() == Some(true);
                let y = (rows - row) as i64;
                let x = (column / 2) as i64;
                text.push(match (column % 2, is_wall) {
                    (0, true) if row > 0 => {
                        drawn.insert((x, y, false));
                        '|'
                    }
                    (1, true) => {
                        drawn.insert((x, y, true));
                        '_'
                    }
                    _ => ' ',
                });
            }
            // A line of blanks only would not be read as a row.
            if row > 0 {
                text.replace_range(text.len() - 2 * columns - 1..text.len() - 2 * columns, "|");
                drawn.insert((0, (rows - row) as i64, false));
            } else {
                text.replace_range(1..2, "_");
                drawn.insert((0, rows as i64, true));
            }
            text.push('\n');
        }
        text.push_str("1000");
        let (maze, diagnostics) = read_maze("m", &text);
        // Most of these mazes have a gap in the border.
        let others = diagnostics.iter().filter(|diagnostic| diagnostic.code != Code::MazGap);
        prop_assert_eq!(others.count(), 0);
        let mut read = BTreeSet::new();
        let mut ends = BTreeSet::new();
        for wall in &maze.walls {
            let is_horizontal = wall.from.y == wall.to.y;
            let (low, high) = (wall.from.min(wall.to), wall.from.max(wall.to));
            let [from, to] = [low, high].map(|end| (end.x as i64, end.y as i64));
            let length = (to.0 - from.0) + (to.1 - from.1);
            for step in 0..length {
                let piece = if is_horizontal { (from.0 + step, from.1, true) } else { (from.0, from.1 + step, false) };
                prop_assert!(read.insert(piece), "{piece:?} twice");
            }
            for end in [from, to] {
                prop_assert!(ends.insert((end, is_horizontal)), "two walls in line meet at {end:?}");
            }
        }
        prop_assert_eq!(read, drawn);
    }
}
