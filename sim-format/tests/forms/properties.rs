//! Round trips: every printed spec reads back unchanged.

use proptest::prelude::*;
use sim_core::spec::{CameraSpec, Lens, SimSpec};
use sim_format::print::{print_companion, print_esobj, print_maze, print_robi, print_scene, print_world};
use sim_format::{Code, content, load_scene, read_companion, read_esobj, read_maze, read_robi, read_scene, read_world};

use super::Overlay;

/// Checks that the printed scene reads back unchanged and without diagnostics.
fn reads_back(sim: &SimSpec) -> Result<(), TestCaseError> {
    let printed = print_scene(sim);
    let (read, reported) = read_scene("a.scene.toml", &printed);
    prop_assert_eq!(reported, vec![], "{}", printed);
    prop_assert_eq!(content::sim(&read), content::sim(sim), "{}", printed);
    Ok(())
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        (-100_000..100_000_i32).prop_map(|whole| whole.to_string()),
        (-1e5..1e5_f64).prop_map(|number| format!("{number:.3}")),
        (-1e5..1e5_f64).prop_map(|number| format!("{number}")),
    ]
}

fn size() -> impl Strategy<Value = String> {
    prop_oneof![
        (1..10_000_u32).prop_map(|whole| whole.to_string()),
        (0.01..1e4_f64).prop_map(|number| format!("{number}"))
    ]
}

/// World without local frames, whose coordinates are decimals.
fn world() -> impl Strategy<Value = String> {
    let looks = (size(), size(), prop::option::of(any::<[u8; 3]>()));
    let wall = (prop::collection::vec(number(), 4), prop::option::of(looks)).prop_map(|(ends, looks)| {
        let looks = looks.map_or(String::new(), |(thickness, height, colour)| {
            let colour = colour.map_or(String::new(), |[r, g, b]| format!(" {r} {g} {b}"));
            format!(" {thickness} {height}{colour}")
        });
        format!("{}{looks}", ends.join(" "))
    });
    let start = prop::collection::vec(number(), 3).prop_map(|pose| format!("position {}", pose.join(" ")));
    (size(), size(), prop::collection::vec(prop_oneof![wall, start], 0..20))
        .prop_map(|(width, height, lines)| format!("floor {width} {height}\n{}\n", lines.join("\n")))
}

fn maze() -> impl Strategy<Value = String> {
    let cell = prop::sample::select(vec![" ", "_", "s", "U", "o", "X", "d", "L"]);
    let side = prop::sample::select(vec![" ", "|"]);
    (2..6_usize, 2..6_usize).prop_flat_map(move |(columns, rows)| {
        prop::collection::vec((cell.clone(), side.clone()), columns * rows).prop_map(move |cells| {
            let row =
                |cells: &[(&str, &str)]| cells.iter().map(|(cell, side)| format!("{cell}{side}")).collect::<String>();
            let rows = cells
                .chunks(columns)
                .map(|cells| format!("|{}\n", row(&cells[..columns - 1]) + cells[columns - 1].0 + "|"));
            format!("{}\n{}180\n", " _".repeat(columns), rows.collect::<String>())
        })
    })
}

fn robi() -> impl Strategy<Value = String> {
    let psd = prop::collection::vec(number(), 4).prop_map(|values| values.join(" "));
    let parts = (prop::collection::vec(size(), 7), prop::collection::vec(psd, 0..4), 0..3_usize, any::<bool>());
    parts.prop_map(|(sizes, psds, drive, is_vr)| {
        let drive = ["DIFFERENTIAL_DRIVE", "ACKERMANN_DRIVE", "OMNI_DRIVE"][drive];
        let [a, b, c, d, e, f, g] = &sizes[..] else { unreachable!("seven sizes") };
        let psds = psds.iter().enumerate().map(|(id, psd)| format!("psd PSD_{id} {} {psd}\n", id + 1));
        let psds: String = psds.collect();
        let vr = if is_vr { format!("mass {a} {b} {c} {d}\ncollider sphere {e} {f} {g} {a}\n") } else { String::new() };
        format!("drive {drive}\nname Some type\ndiameter {a}\nspeed {b}\nturn {c}\n{psds}wheel {d} {e} {f} {g}\n{vr}")
    })
}

/// Links and range sensors of an inline robot type, as tables.
fn sensors() -> impl Strategy<Value = String> {
    let mount = (prop::collection::vec(number(), 6), prop::sample::select(vec!["body", "mast", "head", "eye"]));
    let mount = mount.prop_map(|(values, on)| {
        let keys = ["x_mm", "y_mm", "z_mm", "roll_deg", "pitch_deg", "yaw_deg"];
        let pose: String = keys.iter().zip(&values).map(|(key, value)| format!(", {key} = {value}")).collect();
        format!("on = \"{on}\"{pose}")
    });
    let echo = (1..900_u32, 901..9_000_u32, 0.0..90.0_f64, 0.0..1.0_f64);
    let echo = echo.prop_map(|(min, max, alpha, sigma)| {
        format!("min_mm = {min}, max_mm = {max}, incidence_deg = {alpha}, sigma = {sigma}, mean = {}", sigma - 0.5)
    });
    let sonar =
        (0.1..90.0_f64, 0.0..0.1_f64, 1..4096_u32, prop::option::of((0.0..90.0_f64, 0.01..90.0_f64, 0.0..1.0_f64)));
    let sonar = sonar.prop_map(|(half, threshold, rays, lobes)| {
        let lobes = lobes.map_or(String::new(), |(angle, width, gain)| {
            format!(", side_lobes = {{ angle_deg = {angle}, half_width_deg = {width}, gain = {gain} }}")
        });
        format!("preset = \"SRF08\", half_angle_deg = {half}, threshold = {threshold}, rays = {rays}{lobes}")
    });
    (prop::collection::vec(mount, 7), prop::collection::vec(echo, 3), sonar, size()).prop_map(
        |(mounts, echoes, sonar, range)| {
            let [a, b, c, d, e, f, g] = &mounts[..] else { unreachable!("seven poses") };
            let [laser, ultrasonic, reflectance] = &echoes[..] else { unreachable!("three echoes") };
            // Links in any order, but without cycles.
            let [a, b] = [a.replace("eye", "mast").replace("head", "mast"), b.replace("head", "body").replace("eye", "body")];
            let b = b.replace("\"mast\"", "\"body\"");
            format!(
                "servo = {{ name = \"SERVO1\" }}\n\
                 link = [{{ name = \"head\", {a}, axis = \"y\", servo = \"SERVO1\" }}, {{ name = \"mast\", {b} }}, \
                 {{ name = \"eye\", on = \"head\", servo = \"SERVO1\" }}]\n\
                 psd = [{{ name = \"PSD_FRONT\", on = \"eye\", pitch_deg = -30, range_mm = {range} }}]\n\
                 laser = [{{ name = \"L\", {c}, {laser} }}]\nultrasonic = [{{ name = \"U\", id = 7, {d}, {ultrasonic} }}]\n\
                 reflectance = [{{ name = \"R\", {e}, {reflectance} }}]\n\
                 sonar = [{{ name = \"S\", {f}, {sonar} }}, {{ name = \"T\" }}]\n\
                 lidar = {{ {g}, range_mm = {range} }}\nsurface = {{ reflectivity = 0.5, specular = 0.25 }}\n"
            )
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn worlds_read_back_as_they_were_printed(text in world()) {
        let world = read_world("a.wld", &text).0;
        let printed = print_world(&world);
        prop_assert_eq!(&printed.lost, &Vec::<String>::new());
        let read = read_world("a.wld", &printed.text).0;
        prop_assert_eq!(content::world(&read), content::world(&world), "{}", printed.text);
        let mut sim = SimSpec::default();
        sim.inline.world = Some(world.clone());
        let toml = print_scene(&sim);
        let read = read_scene("a.scene.toml", &toml).0.inline.world.expect("a world");
        prop_assert_eq!(content::world(&read), content::world(&world), "{}", toml);
    }

    #[test]
    fn mazes_read_back_as_they_were_printed(text in maze()) {
        let world = read_maze("a.maz", &text).0;
        let printed = print_maze(&world).expect("a maze");
        prop_assert_eq!(content::world(&read_maze("a.maz", &printed).0), content::world(&world), "{}", printed);
    }

    #[test]
    fn robot_types_read_back_as_they_were_printed(text in robi()) {
        let robi = read_robi("a.robi", &text).0;
        let mut sim = SimSpec::default();
        sim.inline.robot_types.push((robi.clone(), sim_core::spec::Span::default()));
        let toml = print_scene(&sim);
        let (read, reported) = read_scene("a.scene.toml", &toml);
        // The missing floor is the only expected diagnostic.
        let others: Vec<_> = reported.iter().filter(|diagnostic| diagnostic.code != Code::TomlMissing).collect();
        prop_assert!(others.is_empty(), "{:?}\n{}", others, toml);
        prop_assert_eq!(content::robi(&read.inline.robot_types[0].0), content::robi(&robi), "{}", toml);
        let printed = print_robi(&robi);
        let mut read = read_robi("a.robi", &printed.text).0;
        read_companion("a.toml", &print_companion(&robi), &mut read);
        prop_assert!(!printed.lost.is_empty() || content::robi(&read) == content::robi(&robi), "{}", printed.text);
    }

    #[test]
    fn range_sensors_read_back_as_they_were_printed(text in sensors()) {
        let head = "[[robot_type]]\nname = \"A\"\n";
        let (sim, reported) = read_scene("a.scene.toml", &format!("{head}{text}"));
        let others: Vec<_> = reported.iter().filter(|diagnostic| diagnostic.code != Code::TomlMissing).collect();
        prop_assert!(others.is_empty(), "{:?}\n{}", others, text);
        let robi = &sim.inline.robot_types[0].0;
        prop_assert!(robi.links.len() == 3 && robi.ranges.len() >= 4);
        let toml = print_scene(&sim);
        let read = read_scene("a.scene.toml", &toml).0;
        prop_assert_eq!(content::robi(&read.inline.robot_types[0].0), content::robi(robi), "{}", toml);
        // The same keys as a companion beside a robi.
        let printed = print_robi(robi);
        let companion = print_companion(robi);
        let mut read = read_robi("a.robi", &printed.text).0;
        let reported = read_companion("a.toml", &companion, &mut read);
        prop_assert_eq!(reported, vec![], "{}", companion);
        prop_assert_eq!(&read.links.len(), &robi.links.len());
        let (read, robi) = (content::robi(&read), content::robi(robi));
        prop_assert_eq!((read.links, read.ranges, read.lidar, read.surface, read.psds),
            (robi.links, robi.ranges, robi.lidar, robi.surface, robi.psds), "{}", companion);
    }

    #[test]
    fn cameras_read_back_as_they_were_printed(
        values in prop::collection::vec(number(), 3), angles in prop::collection::vec(-360.0..360.0_f64, 6),
        image in prop::option::of((1..65_536_u32, 1..65_536_u32)), fov in prop::option::of(1.0..170.0_f64),
        fisheye in 1.0..360.0_f64, samples in 1..=8_u32, has_servos in any::<bool>(),
    ) {
        let [x, y, z] = &values[..] else { unreachable!("three numbers") };
        let lens = fov.map_or(format!("fisheye_deg = {fisheye}"), |fov| format!("fov_deg = {fov}"));
        let image = image.map(|(width, height)| format!("image_px = [{width}, {height}]"));
        let joint = |name: &str, at: usize| match has_servos {
            true => format!(
                "{name}_servo = {{ name = \"S{at}\", from_deg = {}, to_deg = {} }}", angles[at], angles[at + 1]
            ),
            false => format!("{name}_deg = {}", angles[at]),
        };
        let position = [format!("x_mm = {x}"), format!("y_mm = {y}"), format!("z_mm = {z}")];
        let others = [joint("pan", 0), joint("tilt", 2), lens, format!("samples = {samples}")];
        let keys: Vec<String> = position.into_iter().chain(others).chain(image).collect();
        let head = "[world]\nfile = \"a.wld\"\n[[robot_type]]\nname = \"A\"\n";
        let text = format!("{head}camera = {{ {} }}\n", keys.join(", "));
        let (sim, reported) = read_scene("a.scene.toml", &text);
        prop_assert_eq!(reported, vec![], "{}", text);
        let printed = print_scene(&sim);
        prop_assert_eq!(content::sim(&read_scene("a.scene.toml", &printed).0), content::sim(&sim), "{}", printed);
        let robi = &sim.inline.robot_types[0].0;
        let camera = robi.camera.as_ref().expect("a camera");
        prop_assert_eq!((camera.samples, matches!(camera.lens, Lens::Pinhole { .. })), (samples, fov.is_some()));
        // In a companion, the same keys override a robi with other values.
        let mut read = read_robi("a.robi", "camera 1 2 3 4 5\nfisheye 99\ndrive DIFFERENTIAL_DRIVE\n").0;
        let text = format!("[camera]\n{}\n", keys.join("\n"));
        prop_assert_eq!(read_companion("a.toml", &text, &mut read), vec![], "{}", text);
        let expected = CameraSpec { span: sim_core::spec::Span::default(), ..camera.clone() };
        prop_assert_eq!(content::robi(&read).camera, Some(expected), "{}", text);
    }

    #[test]
    fn looks_read_back_as_they_were_printed(
        azimuth in -360.0..360.0_f64, elevation in 1.0..90.0_f64, ambient in 0.0..=1.0_f64, shadows in any::<bool>(),
        colours in prop::collection::vec(any::<[u8; 3]>(), 4), is_stated in any::<[bool; 3]>(), is_file in any::<bool>(),
    ) {
        let light = format!("light = {{ azimuth_deg = {azimuth}, elevation_deg = {elevation}, ambient = {ambient}, shadows = {shadows} }}\n");
        let sky = format!("sky = {{ horizon = {:?}, zenith = {:?}, ground = {:?} }}\n", colours[0], colours[1], colours[2]);
        let colour = format!("colour = {:?}\n", colours[3]);
        let lines = [light, sky, colour];
        let stated = lines.iter().zip(is_stated).filter(|(_, is_stated)| *is_stated);
        let stated: String = stated.map(|(line, _)| line.as_str()).collect();
        let world = if is_file { "file = \"a.wld\"" } else { "floor_mm = [900, 900]" };
        let text = format!("[world]\n{world}\n{stated}");
        let (sim, reported) = read_scene("a.scene.toml", &text);
        prop_assert_eq!(reported, vec![], "{}", text);
        reads_back(&sim)?;
        let files = Overlay::of(&[("a.scene.toml", &text), ("a.wld", "floor 900 900\n0 0 9 0\n")]);
        let looks = load_scene("a.scene.toml", &files).scene.world.looks;
        prop_assert_eq!(looks.light.shadows, is_stated[0] && shadows);
        prop_assert_eq!(looks.colour, is_stated[2].then_some(colours[3]));
    }

    #[test]
    fn surfaces_and_terrain_read_back_as_they_were_printed(
        fractions in prop::collection::vec(0..=1_000_u32, 6), position in prop::collection::vec(number(), 3), scale in size(),
        is_placed in any::<bool>(), is_solid in any::<bool>(),
    ) {
        let surface = |at: usize| {
            let [a, b] = [fractions[at], fractions[at + 1]].map(|fraction| f64::from(fraction) / 1e3);
            format!("surface = {{ reflectivity = {a}, specular = {b} }}")
        };
        let terrain = match is_placed {
            true => format!("{{ file = \"h.obj\", offset_mm = [{}], scale_mm = {scale} }}", position.join(", ")),
            false => "\"h.obj\"".to_owned(),
        };
        let solid = if is_solid { "model = { file = \"a.obj\" }\nsolid = \"mesh\"\n" } else { "" };
        let text = format!(
            "[world]\nfloor_mm = [900, 900]\n{}\nterrain = {terrain}\n\
             wall = [{{ from_mm = [0, 0], to_mm = [9, 9], {} }}, {{ from_mm = [0, 0], to_mm = [5, 9] }}]\n\
             [[object_type]]\nname = \"A\"\nscale_mm = {scale}\n{}\n{solid}",
            surface(0), surface(2), surface(4),
        );
        let (sim, reported) = read_scene("a.scene.toml", &text);
        prop_assert_eq!(reported, vec![], "{}", text);
        reads_back(&sim)?;
    }

    #[test]
    fn terrains_read_back_as_they_were_printed(
        kind in 0..4_usize, position in prop::collection::vec(number(), 3), sizes in prop::collection::vec(size(), 8),
        seed in prop::option::of(0..=i64::MAX), count in prop::option::of(0..=1000_u32), turn in 0..4_u32,
        is_stated in any::<[bool; 8]>(),
    ) {
        let [a, b, c, d, e, f, g, h] = <[String; 8]>::try_from(sizes).expect("eight");
        let key = |index: usize, text: String| if is_stated[index] { text } else { String::new() };
        let extent = key(0, format!("offset_mm = [{}], ", position.join(", "))) + &key(1, format!("size_mm = [{a}, {b}], "));
        let function = |name: &str| {
            let seed = seed.map_or(String::new(), |seed| format!("seed = {seed}, "));
            let grid = key(2, format!("cell_mm = {c}, ")) + &key(3, format!("relief_mm = {d}, length_mm = {e}, "));
            let clear = key(4, format!("clear = [{{ x_mm = {f}, y_mm = {g}, radius_mm = {h} }}], "));
            format!("{extent}{seed}{grid}{clear}function = \"{name}\"")
        };
        let terrain = match kind {
            0 => format!("{extent}image = \"a.png\", height_mm = {}", position[0]),
            1 => function("hills"),
            2 => {
                let count = count.map_or(String::new(), |count| format!("boulders = {count}, "));
                let ranges = key(5, format!("radius_mm = [{h}, {h}], ")) + &key(6, format!("height_mm = [{g}, {g}], "));
                format!("{count}{ranges}{}", function("boulders"))
            }
            _ => {
                let rest = key(5, format!(", landing_mm = {f}")) + &key(6, ", down = true".to_owned());
                let stairs = format!(
                    "stairs = [{{ from_mm = [{c}, {d}], direction_deg = {}, count = {}, step_height_mm = {e}, \
                     step_depth_mm = {f}, width_mm = {g}{rest} }}], ",
                    90 * turn, count.unwrap_or(0) + 1 - count.unwrap_or(0) / 1000,
                );
                let block = key(7, format!("block = [{{ from_mm = [-1, -2], to_mm = [{c}, {d}], height_mm = {e} }}], "));
                format!("{extent}{}{block}", if is_stated[2] || !is_stated[7] { stairs } else { String::new() })
            }
        };
        let terrain = terrain.trim_end_matches(", ");
        let text = format!("[world]\nfloor_mm = [900, 900]\nterrain = {{ {terrain} }}\n");
        let (sim, reported) = read_scene("a.scene.toml", &text);
        prop_assert_eq!(reported, vec![], "{}", text);
        reads_back(&sim)?;
    }

    #[test]
    fn radios_read_back_as_they_were_printed(
        medium in prop::option::of(prop::sample::select(vec!["free", "aloha", "token_ring"])),
        baud in prop::option::of(1..=1_000_000_000_u32), latency in prop::option::of(0..=3_600_000_000_i64),
        range in prop::option::of(size()), line_of_sight in prop::option::of(any::<bool>()),
        errors in prop::option::of((0.0..=1.0_f64, 0.0..=1.0_f64)),
    ) {
        let latency = latency.map(|micros| format!("latency_ms = {}.{:03}", micros / 1_000, micros % 1_000));
        let keys = [
            medium.map(|medium| format!("medium = \"{medium}\"")),
            baud.map(|baud| format!("baud = {baud}")),
            latency,
            range.map(|range| format!("range_mm = {range}")),
            line_of_sight.map(|sight| format!("line_of_sight = {sight}")),
        ];
        let keys: Vec<String> = keys.into_iter().flatten().collect();
        let noise = errors.map_or(String::new(), |(bits, packets)| {
            format!("[scene.noise.radio]\nbit_error_rate = {bits}\npacket_loss = {packets}\n")
        });
        let text = format!("[world]\nfile = \"a.wld\"\n{noise}[radio]\n{}\n", keys.join("\n"));
        let (sim, reported) = read_scene("a.scene.toml", &text);
        prop_assert_eq!(reported, vec![], "{}", text);
        prop_assert_eq!(sim.radio.baud, baud.unwrap_or(115_200));
        let radio_noise = sim.run.noise.as_ref().and_then(|noise| noise.profile()).map(|profile| profile.radio);
        prop_assert_eq!(radio_noise.map(|radio| (radio.bit_error_rate, radio.packet_loss)), errors);
        reads_back(&sim)?;
    }

    #[test]
    fn object_types_read_back_as_they_were_printed(
        scale in size(), values in prop::collection::vec(number(), 3), radius in size(), is_fixed in any::<bool>()
    ) {
        let fixed = if is_fixed { "fixed\n" } else { "" };
        let values = values.join(" ");
        let text = format!("name A\nscale {scale}\nmass 2 0 0 0\ncollider sphere {values} {radius}\n{fixed}");
        let object = read_esobj("a.esObj", &text).0;
        let printed = print_esobj(&object);
        let read = read_esobj("a.esObj", &printed.text).0;
        prop_assert!(!printed.lost.is_empty() || content::object(&read) == content::object(&object), "{}", printed.text);
        prop_assert_eq!(read.scale, object.scale, "{}", printed.text);
    }

    #[test]
    fn robots_with_numbers_may_be_listed_in_any_order(
        kinds in prop::collection::vec((0..4_usize, any::<u32>(), any::<u32>()), 1..9), seed in 0..1_000_u32,
    ) {
        // The first random number orders the robots by their numbers, the second by their positions in the file.
        let rank = |by: fn(&(usize, u32, u32)) -> u32| -> Vec<usize> {
            let mut order: Vec<usize> = (0..kinds.len()).collect();
            order.sort_by_key(|index| (by(&kinds[*index]), *index));
            order
        };
        let robot = |id: usize, kind: usize| {
            let start = ["", "start = \"U\"", "layout = { kind = \"random\" }", "x_mm = 900\ny_mm = 200\nheading_deg = 7"][kind];
            format!("[[robot]]\ntype = \"S4\"\nid = {id}\nprogram = \"{id}.c\"\n{start}\n")
        };
        let positions: Vec<String> = (0..9).map(|x| {
            let letter = if x % 3 == 0 { ", letter = \"U\"" } else { "" };
            format!("{{ x_mm = {}, y_mm = 500{letter} }}", 400 * x + 300)
        }).collect();
        let head = format!("[scene]\nseed = {seed}\n[world]\nfloor_mm = [4000, 4000]\nstart = [{}]\n", positions.join(", "));
        let by_number = rank(|kind| kind.1);
        let lines: Vec<String> = (1..).zip(&by_number).map(|(id, index)| robot(id, kinds[*index].0)).collect();
        let shuffled: String = rank(|kind| kind.2).into_iter().map(|index| lines[index].as_str()).collect();
        let load = |robots: &str| load_scene("a.scene.toml", &Overlay::of(&[("a.scene.toml", &format!("{head}{robots}"))]));
        let (straight, shuffled) = (load(&lines.concat()), load(&shuffled));
        prop_assert!(!straight.has_errors(), "{:?}", straight.diagnostics);
        prop_assert_eq!(straight.scene.robots.len(), kinds.len());
        for (id, robot) in (1..).zip(&straight.scene.robots) {
            let program = format!("{id}.c");
            prop_assert_eq!((robot.id.0, robot.program_name()), (id, program.as_str()));
        }
        prop_assert_eq!(content::scene(&shuffled.scene), content::scene(&straight.scene));
    }

    #[test]
    fn scenes_read_back_as_they_were_printed(
        poses in prop::collection::vec((prop::collection::vec(number(), 3), prop::collection::vec(".*", 0..3)), 0..10),
        seed in prop::option::of(0..1_u64 << 63),
        slot in prop::option::of(1..3_600_000_000_i64),
        until in prop::option::of(1..1_000_000_000_000_i64),
        turn in prop::option::of(0..10_usize),
    ) {
        let mut text = String::from("[world]\nfile = \"a.wld\"\n");
        for (index, (pose, _)) in poses.iter().enumerate() {
            let [x, y, phi] = &pose[..] else { unreachable!("three numbers") };
            text += "[[robot]]\ntype = \"S4\"\nprogram = \"a b.c\"\n";
            text += &format!("x_mm = {x}\ny_mm = {y}\nheading_deg = {phi}\n");
            if let Some(turn) = turn {
                text += &format!("id = {}\n", (index + turn) % poses.len() + 1);
            }
        }
        let mut sim = read_scene("a.scene.toml", &text).0;
        for (line, (_, arguments)) in sim.robots.iter_mut().zip(&poses) {
            line.arguments.clone_from(arguments);
        }
        sim.run.seed = seed;
        sim.run.slot = slot.map(sim_core::time::Time);
        sim.run.until = until.map(sim_core::time::Time);
        reads_back(&sim)?;
    }
}
