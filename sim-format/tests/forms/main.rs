//! Our own form of a scene: reading, its schema, and conversion to and from all other formats.

mod properties;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use sim_core::radio::{Medium, RadioModel};
use sim_core::spec::Lens;
use sim_core::time::Time;
use sim_format::print::scene_schema;
use sim_format::suite::{check_suite, load_suite, print_suite, read_suite, suite_schema};
use sim_format::{
    Code, ConvertOptions, FileError, Files, MemoryFiles, Overrides, Severity, content, convert, convert_with,
    load_scene, load_scene_with, read_companion, read_robi, read_scene,
};

/// File system of the files below a folder, overlaid by those written in the test.
#[derive(Default)]
struct Overlay {
    root: Option<PathBuf>,
    written: RefCell<BTreeMap<String, String>>,
}

impl Overlay {
    fn of(files: &[(&str, &str)]) -> Self {
        let written = files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        Self { root: None, written: RefCell::new(written) }
    }

    fn write(&self, converted: &sim_format::Converted) {
        for output in &converted.outputs {
            self.written.borrow_mut().insert(output.path.clone(), output.text());
        }
    }
}

impl Files for Overlay {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        if let Some(text) = self.written.borrow().get(path) {
            return Ok(text.clone().into_bytes());
        }
        let root = self.root.as_ref().ok_or(FileError::Missing)?;
        fs::read(root.join(path)).map_err(|error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => FileError::Missing,
            _ => FileError::Unreadable(error.to_string()),
        })
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let entries = self.root.iter().flat_map(|root| fs::read_dir(root.join(folder)).into_iter().flatten().flatten());
        let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        let prefix = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        let written = self.written.borrow();
        let here = written.keys().filter_map(|path| path.strip_prefix(&prefix)).filter(|name| !name.contains('/'));
        names.extend(here.map(str::to_owned));
        names
    }

    fn home(&self) -> Option<&str> {
        self.root.as_ref().map(|_| "vr-2018/Test Assets")
    }
}

fn below(root: &Path, extension: &str) -> Vec<String> {
    let mut open = vec![root.to_owned()];
    let mut files = Vec::new();
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(&path).into_iter().flatten().flatten().map(|entry| entry.path()));
        } else if path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension)) {
            files.push(path.strip_prefix(root).expect("below").to_string_lossy().into_owned());
        }
    }
    files.sort();
    files
}

fn corpus() -> Option<Overlay> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/eyesim/corpus");
    if !root.is_dir() {
        eprintln!("skipped: no corpus at {}", root.display());
        return None;
    }
    Some(Overlay { root: Some(root), ..Overlay::default() })
}

#[test]
fn every_scene_of_the_corpus_goes_to_toml_and_back() {
    let Some(files) = corpus() else { return };
    let mut count = 0;
    for sim in below(files.root.as_ref().expect("a root"), "sim") {
        let first = load_scene(&sim, &files);
        if first.has_errors() {
            continue;
        }
        let (toml, back) = (sim.replace(".sim", "-there.scene.toml"), sim.replace(".sim", "-back.sim"));
        for (from, to) in [(&sim, &toml), (&toml, &back)] {
            let converted = convert(from, to, &files);
            assert!(!sim_format::has_errors(&converted.diagnostics), "{from}: {:?}", converted.diagnostics);
            assert!(
                converted.diagnostics.iter().all(|diagnostic| diagnostic.code != Code::ConvertLost),
                "{from}: something is lost"
            );
            files.write(&converted);
            let read = load_scene(to, &files);
            let text = &converted.outputs.last().expect("a file").text();
            assert!(!read.has_errors(), "{from}: {:?}\n{text}", read.diagnostics);
            assert_eq!(content::scene(&read.scene), content::scene(&first.scene), "{from} to {to}:\n{text}");
        }
        count += 1;
    }
    eprintln!("{count} scenes went to TOML and back");
    assert!(count >= 10, "{count} scenes");
}

#[test]
fn worlds_and_types_of_the_corpus_go_to_toml_and_back() {
    let Some(files) = corpus() else { return };
    let root = files.root.clone().expect("a root");
    for extension in ["wld", "maz", "robi", "esObj"] {
        for file in below(&root, extension) {
            let stem = file.rsplit_once('.').expect("an extension").0;
            let (toml, back) = (format!("{stem}-there.toml"), format!("{stem}-back.{extension}"));
            let there = convert(&file, &toml, &files);
            if sim_format::has_errors(&there.diagnostics) {
                continue;
            }
            files.write(&there);
            let again = convert(&toml, &back, &files);
            let text = &there.outputs[0].text();
            assert!(!sim_format::has_errors(&again.diagnostics), "{file}: {:?}\n{text}", again.diagnostics);
            files.write(&again);
            let text = &again.outputs[0].text();
            let lost = again.diagnostics.iter().any(|diagnostic| diagnostic.code == Code::ConvertLost);
            match extension {
                "wld" => {
                    let [old, new] = [&file, &back].map(|name| sim_format::load_world(name, &files).scene.world);
                    assert_eq!((old.walls.len(), old.starts.len()), (new.walls.len(), new.starts.len()), "{file}");
                    for (old, new) in old.walls.iter().zip(&new.walls) {
                        let distance = (old.from - new.from).length().max((old.to - new.to).length());
                        // Inside `push` frames, possibly no decimal reads back to the double.
                        assert!(distance <= 1e-12, "{file}: a wall moves by {distance} m");
                    }
                }
                "maz" => {
                    let [old, new] = [&file, &back].map(|name| sim_format::load_world(name, &files).scene.world);
                    assert_eq!(content::world(&new), content::world(&old), "{file}:\n{text}");
                }
                "robi" => {
                    let [old, new] = [&file, &back].map(|name| sim_format::load_robi(name, &files).0.expect("a robi"));
                    assert!(lost || content::robi(&new) == content::robi(&old), "{file}:\n{text}");
                }
                _ => {
                    let [old, new] =
                        [&file, &back].map(|name| sim_format::load_object(name, &files).0.expect("an object"));
                    assert!(lost || content::object(&new) == content::object(&old), "{file}:\n{text}");
                }
            }
        }
    }
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats")
}

#[test]
fn the_schema_of_the_docs_is_that_of_the_code() {
    let path = docs().join("scene.schema.json");
    if std::env::var("INSTA_UPDATE").is_ok_and(|how| how == "always") {
        fs::write(&path, scene_schema()).expect("the schema is written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(committed, scene_schema(), "write it again with INSTA_UPDATE=always, or with `eyesim schema`");
}

#[test]
fn the_schema_of_suites_is_that_of_the_code_and_suites_print_as_they_were_read() {
    let path = docs().join("suite.schema.json");
    if std::env::var("INSTA_UPDATE").is_ok_and(|how| how == "always") {
        fs::write(&path, suite_schema()).expect("the schema is written");
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(committed, suite_schema(), "write it again with INSTA_UPDATE=always, or with `eyesim schema suite`");
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/suite/all.suite.toml");
    let (suite, diagnostics) = read_suite("a.suite.toml", &fs::read_to_string(seed).expect("a suite"));
    assert_eq!(diagnostics, []);
    let printed = print_suite(&suite);
    let (mut again, diagnostics) = read_suite("a.suite.toml", &printed);
    assert_eq!(diagnostics, [], "{printed}");
    assert_eq!(again.matrix.cases(), suite.matrix.cases());
    assert_eq!(print_suite(&again), printed);
    // Only locations in the text differ.
    again.checks.clone_from(&suite.checks);
    assert_eq!((again.keys, again.arguments, again.limits), (suite.keys, suite.arguments, suite.limits));
}

/// Files of a suite in the folder `s`, whose scene and worlds are in other folders; `matrix` is its matrix.
fn suite_of(matrix: &str) -> Overlay {
    let suite = format!("[suite]\nscene = \"../scenes/a.scene.toml\"\n[matrix]\n{matrix}\n");
    let scene = "[world]\nfile = \"a.wld\"\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n";
    Overlay::of(&[
        ("s/a.suite.toml", &suite),
        ("scenes/a.scene.toml", scene),
        ("scenes/a.wld", "floor 1000 1000\n"),
        ("s/worlds/b.wld", "floor 3000 2000\n"),
    ])
}

#[test]
fn worlds_of_a_suite_are_relative_to_its_folder() {
    let loaded = load_suite("s/a.suite.toml", &suite_of("world = [\"worlds/b.wld\"]")).loaded;
    assert_eq!((loaded.diagnostics, loaded.scene.world.floor.to_array()), (Vec::new(), [3.0, 2.0]));
}

#[test]
fn further_values_of_a_suite_are_checked() {
    let matrix = "world = [\"worlds/b.wld\", \"worlds/nope.wld\"]\nnoise = [\"none\", \"mlid\"]\nseed = [1, 2]\n\
                  slot_ms = [20, 50]\nset = { \"robot[0].x_mm\" = [500, \"x\"] }\n\
                  exclude = [{ noise = \"nnoe\" }, { seed = 7 }, { slot_ms = 20.0 }]";
    let suite = check_suite("s/a.suite.toml", &suite_of(matrix));
    assert_eq!(suite.suite.matrix.cases().len(), 16, "half of the cases have another slot");
    let messages: Vec<&str> = suite.loaded.diagnostics.iter().map(|diagnostic| diagnostic.message.as_str()).collect();
    for part in ["`nnoe`, which is no value of `noise`", "`7`, which", "nope.wld` is not found", "noise profile `mlid`"]
    {
        assert_eq!(messages.iter().filter(|message| message.contains(part)).count(), 1, "{part}: {messages:?}");
    }
    let is_of_x = |message: &&&str| message.contains("`x_mm` is") && message.contains("(case world=");
    assert_eq!(messages.iter().filter(is_of_x).count(), 1, "{messages:?}");
    assert_eq!(messages.len(), 5, "{messages:?}");
}

/// Keys of a type in the schema, over all its variants.
fn keys_of_schema(schema: &serde_json::Value, name: &str) -> BTreeSet<String> {
    let form = if name.is_empty() { schema } else { &schema["$defs"][name] };
    let variants = form["oneOf"].as_array().cloned().unwrap_or_default();
    let parts = std::iter::once(form.clone()).chain(variants);
    let properties = parts.filter_map(|part| part["properties"].as_object().cloned());
    properties.flat_map(|keys| keys.into_iter().map(|(key, _)| key)).collect()
}

/// Keys known to the reader, from its message about the unknown key `zzz` in `text`.
fn keys_of_reader(text: &str) -> BTreeSet<String> {
    let reported = read_scene("a.scene.toml", text).1;
    let unknown = reported.iter().find(|diagnostic| diagnostic.code == Code::TomlKey);
    let unknown = unknown.unwrap_or_else(|| panic!("`zzz` is not reported in\n{text}\n{reported:?}"));
    let listed = unknown.expected.strip_prefix("one of ").expect("a list of keys");
    listed.split(", ").map(str::to_owned).collect()
}

#[test]
fn schema_and_reader_know_the_same_keys() {
    let schema: serde_json::Value = serde_json::from_str(&scene_schema()).expect("JSON");
    let robot = |inner: &str| format!("[[robot_type]]\nname = \"a\"\n{inner}\n");
    let legged = |inner: &str| robot(&format!("drive = {{ kind = \"legged\" }}\n{inner}"));
    let object = |inner: &str| format!("[[object_type]]\nname = \"a\"\n{inner}\n");
    let layouts = ["starts", "line", "grid", "circle", "random"]
        .map(|kind| format!("[[robot]]\ntype = \"S4\"\nlayout = {{ kind = \"{kind}\", zzz = 1 }}"));
    let colliders = ["box", "sphere", "capsule", "cylinder"]
        .map(|kind| object(&format!("collider = {{ kind = \"{kind}\", zzz = 1 }}")));
    let echoes =
        ["laser", "ultrasonic", "reflectance"].map(|kind| robot(&format!("{kind} = [{{ name = \"a\", zzz = 1 }}]")));
    let checks = [
        "reach",
        "visits",
        "stays_in",
        "laps",
        "clearance",
        "follows_wall",
        "coverage",
        "odometry_error",
        "contacts",
        "metric",
        "prints",
        "outcome",
        "event",
        "calls",
        "message",
        "script",
        "swarm\"\nof = \"groups",
        "swarm\"\nof = \"coverage",
    ]
    .map(|kind| format!("[[check]]\nkind = \"{kind}\"\nzzz = 1"));
    let faults = ["dies", "sensor_off", "sensor_stuck", "slip", "radio_off", "noise"]
        .map(|kind| format!("[[fault]]\nkind = \"{kind}\"\nzzz = 1"));
    let draws = ["uniform = [1, 2]", "normal = [1, 2]", "choice = [1]", "same_as = \"a\"", "random_maze = [1, 1]"]
        .map(|draw| format!("[world]\nmaze = {{ {draw}, zzz = 1 }}"));
    let noise = |section: &str| format!("[scene.noise.{section}]\nzzz = 1");
    let function = |name| format!("[world.terrain]\nfunction = \"{name}\"\nzzz = 1");
    let cases: &[(&str, Vec<String>)] = &[
        ("", vec!["zzz = 1".into()]),
        ("RunForm", vec!["[scene]\nzzz = 1".into()]),
        ("GenerationsForm", vec!["[scene.costs]\nzzz = { a = 1 }".into()]),
        ("ProfileForm", vec!["[scene.noise]\nzzz = 1".into(), "[[robot]]\ntype = \"S4\"\nnoise = { zzz = 1 }".into()]),
        ("RangeNoiseForm", ["psd", "lidar"].map(noise).to_vec()),
        ("EchoNoiseForm", ["laser", "ultrasonic", "reflectance", "sonar", "sensor.PSD_FRONT"].map(noise).to_vec()),
        ("CompassNoiseForm", vec![noise("compass")]),
        ("CameraNoiseForm", vec![noise("camera")]),
        ("DriveNoiseForm", vec![noise("drive")]),
        ("OdometryNoiseForm", vec![noise("odometry")]),
        ("RadioNoiseForm", vec![noise("radio")]),
        ("RadioForm", vec!["[radio]\nzzz = 1".into()]),
        ("WorldForm", vec!["[world]\nfile = \"a.wld\"\nzzz = 1".into()]),
        (
            "WallForm",
            vec![
                "[world]\nwall = [{ from_mm = [0, 0], to_mm = [1, 1], zzz = 1 }]".into(),
                "[world]\nwall = [{ layout = \"random\", length_mm = 5, zzz = 1 }]".into(),
            ],
        ),
        ("FaultForm", faults.to_vec()),
        ("ReachableForm", vec!["[[reachable]]\nzzz = 1".into()]),
        ("DrawForm", draws.to_vec()),
        ("StartForm", vec!["[world]\nstart = [{ x_mm = 0, y_mm = 0, zzz = 1 }]".into()]),
        ("SettingsForm", vec!["[settings]\nzzz = 1".into()]),
        ("RobotForm", vec!["[[robot]]\nzzz = 1".into()]),
        ("ObjectForm", vec!["[[object]]\nzzz = 1".into()]),
        ("CheckForm", checks.to_vec()),
        ("MarkerForm", vec!["[[marker]]\nzzz = 1".into()]),
        ("LayoutForm", layouts.to_vec()),
        ("RobotTypeForm", vec![robot("zzz = 1")]),
        ("ModelForm", vec![robot("model = { file = \"a\", zzz = 1 }")]),
        ("ColliderForm", colliders.to_vec()),
        ("BodyForm", vec![robot("body = { zzz = 1 }")]),
        ("WheelForm", vec![robot("wheel = { zzz = 1 }")]),
        ("DriveForm", vec![robot("drive = { zzz = 1 }")]),
        ("MotorForm", vec![robot("drive = { motor = [{ name = \"a\", zzz = 1 }] }")]),
        ("PsdForm", vec![robot("psd = [{ name = \"a\", zzz = 1 }]")]),
        ("InfraredForm", vec![robot("infrared = [{ name = \"a\", zzz = 1 }]")]),
        ("LinkForm", vec![robot("link = [{ name = \"a\", zzz = 1 }]")]),
        ("HullForm", vec![robot("drive = { kind = \"thrusters\" }\nhull = { zzz = 1 }")]),
        ("LegsForm", vec![legged("legs = { zzz = 1 }")]),
        ("GaitForm", vec![legged("legs = { gait = [{ zzz = 1 }] }")]),
        ("LegForm", vec![legged("leg = [{ zzz = 1 }]")]),
        ("FootForm", vec![legged("leg = [{ foot = { zzz = 1 } }]")]),
        ("EchoForm", echoes.to_vec()),
        ("SonarForm", vec![robot("sonar = [{ name = \"a\", zzz = 1 }]")]),
        ("SideLobesForm", vec![robot("sonar = [{ name = \"a\", side_lobes = { zzz = 1 } }]")]),
        ("SurfaceForm", vec![robot("surface = { zzz = 1 }"), object("surface = { zzz = 1 }")]),
        ("PlacedTerrainForm", vec!["[world.terrain]\nzzz = 1".into()]),
        ("ImageTerrainForm", vec!["[world.terrain]\nimage = \"a.png\"\nzzz = 1".into()]),
        ("FunctionTerrainForm", ["hills", "boulders"].map(function).to_vec()),
        ("DiscForm", vec!["[world.terrain]\nfunction = \"hills\"\nclear = [{ zzz = 1 }]".into()]),
        ("StepsTerrainForm", vec!["[world.terrain]\nblock = []\nzzz = 1".into()]),
        ("StairsForm", vec!["[world.terrain]\nstairs = [{ zzz = 1 }]".into()]),
        ("BlockForm", vec!["[world.terrain]\nblock = [{ zzz = 1 }]".into()]),
        ("CameraForm", vec![robot("camera = { zzz = 1 }")]),
        ("LightForm", vec!["[world.light]\nzzz = 1".into(), "[world]\nfile = \"a.wld\"\nlight = { zzz = 1 }".into()]),
        ("SkyForm", vec!["[world.sky]\nzzz = 1".into()]),
        ("JointForm", vec![robot("camera = { pan_servo = { zzz = 1 } }")]),
        ("LidarForm", vec![robot("lidar = { zzz = 1 }")]),
        ("ArcForm", vec![robot("bumper = [{ name = \"a\", zzz = 1 }]")]),
        ("ServoForm", vec![robot("servo = [{ name = \"a\", zzz = 1 }]")]),
        ("CompassForm", vec![robot("compass = { zzz = 1 }")]),
        ("InputForm", vec![robot("input = { zzz = 1 }")]),
        ("LcdForm", vec![robot("lcd = { zzz = 1 }")]),
        ("ObjectTypeForm", vec![object("zzz = 1")]),
    ];
    for (name, texts) in cases {
        let keys: BTreeSet<String> = texts.iter().flat_map(|text| keys_of_reader(text)).collect();
        assert_eq!(keys, keys_of_schema(&schema, name), "{name}: the reader's keys left, the schema's right");
    }
    let forms: BTreeSet<&str> = cases.iter().map(|(name, _)| *name).collect();
    for name in schema["$defs"].as_object().expect("types").keys() {
        let has_keys = !keys_of_schema(&schema, name).is_empty();
        assert!(!has_keys || forms.contains(name.as_str()), "no case for {name}");
    }
}

#[test]
fn the_examples_of_the_page_have_no_mistakes() {
    let page = fs::read_to_string(docs().join("scene.md")).expect("the page");
    let examples: Vec<&str> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```\n").next()).collect();
    assert_eq!(examples.len(), 4);
    let world = Path::new(env!("CARGO_MANIFEST_DIR")).join("../worlds/empty.wld");
    let world = fs::read_to_string(world).expect("worlds/empty.wld");
    for example in examples {
        let text = example.replace("%sim%/worlds/", "");
        let files = Overlay::of(&[("a.scene.toml", &text), ("empty.wld", &world)]);
        let loaded = load_scene("a.scene.toml", &files);
        assert_eq!(loaded.diagnostics, [], "{text}");
        assert!(!loaded.scene.robots.is_empty());
    }
}

/// Loads a scene of 4 m by 3 m followed by `rest`.
fn scene(rest: &str) -> sim_format::Loaded {
    let text = format!("[world]\nfloor_mm = [4000, 3000]\n{rest}");
    load_scene("a.scene.toml", &Overlay::of(&[("a.scene.toml", &text)]))
}

/// Start poses of the robots, in metres and degrees.
fn places(loaded: &sim_format::Loaded) -> Vec<(f64, f64, f64)> {
    let rounded = |value: f64| (value * 1e6).round() / 1e6;
    let of = |robot: &sim_core::spec::RobotSpec| {
        let (position, heading) = (robot.start.position, robot.start.heading.radians().to_degrees());
        (rounded(position.x), rounded(position.y), rounded(heading))
    };
    loaded.scene.robots.iter().map(of).collect()
}

#[test]
fn layouts_place_entities_as_documented() {
    let of = |layout: &str| {
        let loaded = scene(&format!("[[robot]]\ntype = \"S4\"\ncount = 4\nlayout = {{ {layout} }}\n"));
        assert_eq!(loaded.diagnostics, [], "{layout}");
        places(&loaded)
    };
    let line = of("kind = \"line\", from_mm = [500, 1000], to_mm = [3500, 1000], heading_deg = 90");
    assert_eq!(line, [(0.5, 1.0, 90.0), (1.5, 1.0, 90.0), (2.5, 1.0, 90.0), (3.5, 1.0, 90.0)]);
    let grid = of("kind = \"grid\", from_mm = [500, 500], spacing_mm = [1000, 800]");
    assert_eq!(grid, [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0), (0.5, 1.3, 0.0), (1.5, 1.3, 0.0)]);
    let row = of("kind = \"grid\", from_mm = [500, 500], spacing_mm = [1000, 800], columns = 3");
    assert_eq!(row[3], (0.5, 1.3, 0.0));
    let circle = of("kind = \"circle\", centre_mm = [2000, 1500], radius_mm = 1000, facing_deg = 180");
    assert_eq!(circle, [(3.0, 1.5, 180.0), (2.0, 2.5, 270.0), (1.0, 1.5, 360.0), (2.0, 0.5, 450.0)]);
}

#[test]
fn random_positions_keep_their_clearance_and_depend_on_the_seed() {
    let text = "[scene]\nseed = 5\n[world]\nfloor_mm = [4000, 3000]\n\
                wall = [{ from_mm = [2000, 0], to_mm = [2000, 3000] }]\n\
                [[robot]]\ntype = \"S4\"\ncount = 30\nlayout = { kind = \"random\", clearance_mm = 100 }\n\
                [[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 1500\n";
    let files = Overlay::of(&[("a.scene.toml", text)]);
    let loaded = load_scene("a.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    let robots = &loaded.scene.robots;
    assert_eq!(robots.len(), 31);
    for (index, robot) in robots.iter().enumerate() {
        let (radius, position) = (robot.robi.diameter / 2.0, robot.start.position);
        assert!(index == 30 || (position.x - 2.0).abs() >= radius + 0.1, "{position}");
        assert!(
            position.min_element() >= radius && position.x <= 4.0 - radius && position.y <= 3.0 - radius,
            "{position}"
        );
        for other in &robots[..index] {
            assert!(position.distance(other.start.position) >= 2.0 * radius + 0.1 - 1e-12, "{position}");
        }
    }
    assert_eq!(places(&load_scene("a.scene.toml", &files)), places(&loaded));
    let other = load_scene_with("a.scene.toml", Overrides { seed: Some(6), ..Overrides::default() }, &files);
    assert_ne!(places(&other), places(&loaded));
    assert_eq!(other.scene.run.seed, Some(6));
}

#[test]
fn invalid_scenes_are_reported() {
    let deep = format!("a = {}1{}", "[".repeat(10_000), "]".repeat(10_000));
    let long = format!("[world]\nfile = \"{}\"\n", "x".repeat(1_000_000));
    let robot = |rest: &str| format!("[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"S4\"\n{rest}\n");
    let cases: &[(&str, String, Code)] = &[
        ("nothing", String::new(), Code::TomlMissing),
        ("deep nesting", deep, Code::TomlSyntax),
        ("a long name", long, Code::FileMissing),
        ("a huge count", robot("count = 1000000000000"), Code::NumberRange),
        ("no count", robot("count = 0"), Code::NumberRange),
        ("many groups", robot(&"count = 60000\n[[robot]]\ntype = \"S4\"\n".repeat(3)), Code::SceneCount),
        ("NaN", robot("x_mm = nan\ny_mm = 1"), Code::NumberRange),
        ("infinity", robot("x_mm = 1\ny_mm = inf"), Code::NumberRange),
        ("a wrong type", robot("x_mm = \"1\"\ny_mm = true"), Code::TomlType),
        ("no room", robot("count = 1000\nlayout = { kind = \"random\" }"), Code::SceneRoom),
        ("tables that are none", "world = 3\nrobot = \"S4\"\n".into(), Code::TomlType),
        ("an object as a robot", robot("[[robot]]\ntype = \"Can\"\nx_mm = 1\ny_mm = 1"), Code::SimTypeUnknown),
        ("half a pose", robot("x_mm = 1"), Code::TomlMissing),
        ("a slot that is none", "[scene]\nslot_ms = 0.0001\n".into(), Code::NumberRange),
        ("a slot of parts", "[scene]\nslot_ms = 0.0015\n".into(), Code::NumberRange),
        ("a broken maze", "[world]\nmaze = \"\"\"\n _\n|?|\n\"\"\"\n".into(), Code::MazLetter),
    ];
    for (what, text, code) in cases {
        let loaded = load_scene("a.scene.toml", &Overlay::of(&[("a.scene.toml", text)]));
        let codes: Vec<Code> = loaded.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
        assert!(codes.contains(code), "{what}: {codes:?}");
        for diagnostic in &loaded.diagnostics {
            assert!(text.get(diagnostic.span.start..diagnostic.span.end).is_some(), "{what}: {:?}", diagnostic.span);
        }
    }
}

#[test]
fn a_mistake_has_one_message_and_a_suggestion() {
    let reported = |robot: &str| {
        let text = format!("[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"S4\"\ny_mm = 500\n{robot}\n");
        let reported = read_scene("a.scene.toml", &text).1;
        reported.into_iter().map(|it| (it.code, it.suggestion)).collect::<Vec<_>>()
    };
    let write = |text: &str| Some(format!("write `{text}`"));
    assert_eq!(reported("x_mm = 500mm"), [(Code::TomlSyntax, write("500"))]);
    for (written, number) in [("0500", "500"), ("-007", "-7"), (".5", "0.5"), ("5.", "5"), ("00.5", "0.5")] {
        assert_eq!(reported(&format!("x_mm = {written}")), [(Code::TomlSyntax, write(number))], "{written}");
    }
    assert_eq!(reported("x_mm = { unifrom = [1, 2] }"), [(Code::TomlType, write("uniform"))]);
    assert_eq!(reported("x_mm = 500\ncount = 0"), [(Code::NumberRange, None)]);
    assert_eq!(reported("x_mm = 500\ncount = 2.0"), [(Code::TomlType, None)]);
}

#[test]
fn mistakes_in_a_drawn_maze_have_their_own_lines() {
    let text = "[world]\nmaze = '''\n _ _\n|?  |\n|_ _|\n'''\n";
    let reported = read_scene("a.scene.toml", text).1;
    let letter =
        reported.iter().find(|diagnostic| diagnostic.code == Code::MazLetter).expect("a letter that means nothing");
    assert_eq!((letter.span.line, letter.span.column), (4, 2));
    assert_eq!(&text[letter.span.start..letter.span.end], "?");
    // A byte order mark within a file is a character of its line.
    let reported = read_scene("b.scene.toml", "[world]\nmaze = '''\n\u{feff} _?\n|  |\n|_ _|\n'''\n").1;
    let letter = reported.iter().find(|diagnostic| diagnostic.code == Code::MazLetter).expect("the same letter");
    assert_eq!((letter.span.line, letter.span.column), (3, 4));
}

#[test]
fn a_companion_is_not_a_scene() {
    assert!(!sim_format::is_scene("S4.toml", "[psd]\nrange_mm = 2000\n"));
    assert!(!sim_format::is_scene("costs.toml", "[robios6]\nPSDGet = 3\n"));
    assert!(sim_format::is_scene("a.toml", "[world]\nfile = \"a.wld\"\n"));
    assert!(sim_format::is_scene("A.SCENE.TOML", ""));
    assert!(!sim_format::is_scene("a.sim", "[world]\n"));
}

#[test]
fn the_generation_of_a_robot_precedes_that_of_the_scene() {
    let text = |scene: &str, robot: &str| {
        format!(
            "[scene]\n{scene}\n[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n\
             {robot}\n[[robot]]\ntype = \"S4\"\nx_mm = 900\ny_mm = 900\n"
        )
    };
    let load =
        |scene: &str, robot: &str| load_scene("a.scene.toml", &Overlay::of(&[("a.scene.toml", &text(scene, robot))]));
    let generation_of = |scene: &str, robot: &str| {
        let loaded = load(scene, robot);
        assert_eq!(loaded.diagnostics, []);
        loaded.scene.robots.iter().map(|robot| (robot.api, robot.dialect)).collect::<Vec<_>>()
    };
    assert_eq!(generation_of("", ""), [(None, None); 2]);
    assert_eq!(generation_of("api = 7", "api = 6"), [(Some(6), None), (Some(7), None)]);
    assert!(load("api = 5", "").has_errors() && load("", "api = \"7\"").has_errors());
}

#[test]
fn keys_that_a_sim_file_cannot_express_are_named() {
    let text = "[scene]\nseed = 3\napi = 6\ncosts = { robios6 = { PSDGet = 5 } }\ncontact = \"stall\"\n\
                wall_friction = 0.1\n[world]\nfloor_mm = [4000, 3000]\n\
                [radio]\nbaud = 9600\n[[fault]]\nkind = \"dies\"\nat_s = 5\n\
                [[reachable]]\nfrom = [500, 500]\nto = [1500, 1500]\nwidth_mm = 100\n\
                [[object]]\nname = \"goal\"\ntype = \"Can\"\nx_mm = 2000\ny_mm = 2000\n\
                [[robot_type]]\nname = \"Scout\"\ndiameter_mm = 120\n\
                [[robot]]\ntype = \"Scout\"\nprogram = \"a.c\"\narguments = [\"-v\"]\napi = 7\n\
                count = 2\nlayout = { kind = \"line\", from_mm = [500, 500], to_mm = [900, 500] }\n";
    let files = Overlay::of(&[("a.scene.toml", text)]);
    let converted = convert("a.scene.toml", "b.sim", &files);
    let is_lost = |diagnostic: &sim_format::Diagnostic| {
        (diagnostic.code, diagnostic.severity) == (Code::ConvertLost, Severity::Warning)
    };
    assert!(converted.diagnostics.iter().all(is_lost), "{:?}", converted.diagnostics);
    for what in [
        "the seed",
        "the cost table",
        "the generation of the API",
        "the radio",
        "the arguments of r1",
        "r1 is written for RoBIOS 7",
        "2 robots",
        "the faults",
        "the required routes",
        "the contact of robots",
        "the friction of the walls",
        "the names of robots and objects",
    ] {
        let is_named = converted.diagnostics.iter().any(|diagnostic| diagnostic.message.contains(what));
        assert!(is_named, "{what}: {:?}", converted.diagnostics);
    }
    let paths: Vec<&str> = converted.outputs.iter().map(|output| output.path.as_str()).collect();
    assert_eq!(paths, ["b.wld", "b-Scout.toml", "b-Scout.robi", "b.sim"]);
    files.write(&converted);
    let [old, new] = ["a.scene.toml", "b.sim"].map(|name| load_scene(name, &files));
    assert!(!new.has_errors(), "{:?}", new.diagnostics);
    assert_eq!(places(&new), places(&old));
    assert_eq!(content::robi(&new.scene.robots[0].robi), content::robi(&old.scene.robots[0].robi));
}

#[test]
fn a_conversion_that_changes_the_generation_names_it() {
    let lost = |dialect: &str, kind: &str| {
        let scene = format!(
            "[scene]\n{dialect}\n[world]\nfloor_mm = [2000, 2000]\n[[robot]]\ntype = \"{kind}\"\nprogram = \"p.c\"\n\
             x_mm = 500\ny_mm = 500\n"
        );
        let robi = "wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";
        let files = Overlay::of(&[("a.scene.toml", &scene), ("A.robi", robi)]);
        let converted = convert_with("a.scene.toml", "b.sim", ConvertOptions::default(), &files, &|_, robot| robot.api);
        let messages = converted.diagnostics.iter().map(|diagnostic| diagnostic.message.as_str());
        messages.filter_map(|message| Some(message.split_once("r1 is of ")?.1[..8].to_owned())).collect::<String>()
    };
    assert_eq!(lost("", "S4"), "RoBIOS 6");
    assert_eq!(lost("dialect = \"vr2023\"", "A.robi"), "RoBIOS 7");
    for (dialect, kind) in [("", "A.robi"), ("dialect = \"vr2018\"", "S4"), ("api = 6", "S4")] {
        assert_eq!(lost(dialect, kind), "", "{dialect}");
    }
}

#[test]
fn random_walls_are_placed_by_the_seed_in_a_world_file() {
    let text = "[world]\nfloor_mm = [4000, 3000]\n[[world.wall]]\ncount = 3\nlength_mm = 500\n\
                layout = { kind = \"random\", clearance_mm = 250 }\n[[robot]]\ntype = \"S4\"\nlayout = \"random\"\n";
    let files = Overlay::of(&[("a.scene.toml", text)]);
    let walls = |seed| {
        let options = ConvertOptions { seed: Some(seed), ..ConvertOptions::default() };
        files.write(&convert_with("a.scene.toml", "b.wld", options, &files, &|_, _| None));
        let written = sim_format::load_world("b.wld", &files).scene.world;
        let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
        let loaded = load_scene_with("a.scene.toml", overrides, &files).scene.world;
        let [written, loaded] = [written, loaded].map(|world| {
            let ends = world.walls.iter().flat_map(|wall| [wall.from.x, wall.from.y, wall.to.x, wall.to.y]);
            ends.map(|metres| (metres * 1e9).round()).collect::<Vec<_>>()
        });
        assert!(written.len() == 12 && written == loaded, "{written:?} are not {loaded:?}");
        written
    };
    assert_ne!(walls(1), walls(2));
}

#[test]
fn types_with_similar_names_get_files_of_their_own() {
    let types: String =
        ["My Bot", "My_Bot", "my bot"].map(|name| format!("[[robot_type]]\nname = \"{name}\"\n")).concat();
    let text = format!("[world]\nfloor_mm = [2000, 2000]\n{types}");
    let converted = convert("a.scene.toml", "x/b.sim", &Overlay::of(&[("a.scene.toml", &text)]));
    let paths: Vec<&str> = converted.outputs.iter().map(|output| output.path.as_str()).collect();
    let robis: Vec<&str> = paths.into_iter().filter(|path| path.ends_with(".robi")).collect();
    assert_eq!(robis, ["x/b-My_Bot.robi", "x/b-My_Bot-2.robi", "x/b-my_bot-3.robi"]);
}

#[test]
fn lines_of_a_sim_that_toml_writes_differently_keep_their_meaning() {
    let robi = "wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n";
    let files = Overlay::of(&[
        ("m.maz", " ___\n|S  |\n|___|\n"),
        ("old.sim", "world m.maz\nrobi A.robi\nLabBot x\n"),
        ("A.robi", robi),
        ("w.wld", "floor 2000 2000\n"),
        ("meshes.sim", "world w.wld\nS4 500 500 0\nobject 800 800 0 0.0 can.3ds\nobject 1200 800 0 0.1 tin\n"),
    ]);
    for name in ["old", "meshes"] {
        let (sim, toml) = (format!("{name}.sim"), format!("{name}.scene.toml"));
        files.write(&convert(&sim, &toml, &files));
        let [old, new] = [sim, toml].map(|name| load_scene(&name, &files));
        assert!(!old.has_errors() && !new.has_errors(), "{:?}", new.diagnostics);
        assert_eq!(places(&new), places(&old));
        let shapes = |loaded: &sim_format::Loaded| {
            let objects = loaded.scene.objects.iter();
            objects.map(|object| (object.kind.name.clone(), object.kind.colliders.clone())).collect::<Vec<_>>()
        };
        assert_eq!(shapes(&new), shapes(&old));
    }
}

#[test]
fn a_maze_with_water_and_a_texture_is_a_maze() {
    let text = "[world]\nmaze = \"\"\"\n _\n|_|\n\"\"\"\ntexture = \"a.png\"\ntexture_turned = true\nwater_mm = 50\n";
    let converted = convert("a.scene.toml", "a.maz", &Overlay::of(&[("a.scene.toml", text)]));
    let lost = converted.diagnostics.iter().filter(|diagnostic| diagnostic.code == Code::ConvertLost);
    assert_eq!((lost.count(), converted.outputs.len()), (2, 1), "{:?}", converted.diagnostics);
}

#[test]
fn a_start_letter_that_a_world_file_cannot_express_becomes_a_pose() {
    let text = "[world]\nfloor_mm = [2000, 2000]\nstart = [{ x_mm = 300, y_mm = 400, letter = \"S\" }]\n\
                [[robot]]\ntype = \"S4\"\nstart = \"S\"\n";
    let files = Overlay::of(&[("a.scene.toml", text)]);
    files.write(&convert("a.scene.toml", "b.sim", &files));
    let [old, new] = ["a.scene.toml", "b.sim"].map(|name| load_scene(name, &files));
    assert_eq!((new.diagnostics.as_slice(), places(&new)), (&[][..], places(&old)));
}

#[test]
fn references_are_rewritten_for_the_new_folder() {
    let files = Overlay::of(&[
        ("sims/a.sim", "world ../worlds/w.wld\nrobi r.robi p.c 200 200 0\nrobi r.robi %sim%/q.c 600 600 0\n"),
        ("worlds/w.wld", "floor 1000 1000\n"),
        ("sims/r.robi", "wheel 54 3600 1100 90\ndrive OMNI_DRIVE\n"),
        ("sims/p.c", ""),
    ]);
    let converted = convert("sims/a.sim", "other/deep/b.scene.toml", &files);
    let text = &converted.outputs[0].text();
    for line in ["\"../../worlds/w.wld\"", "\"../../sims/r.robi\"", "\"../../sims/p.c\"", "\"%sim%/q.c\""] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}

#[test]
fn references_without_an_exact_file_are_rewritten_too() {
    let files: MemoryFiles = [
        (
            "src/a.sim",
            "world Room.wld\nS4 300 500 0 left.x\nS4 700 500 0 right\nS4 1100 500 0 \"a.c, b.c\"\n\
             S4 1500 500 0 later.c\nS4 1900 500 0 here.x\nS4 2300 500 0 \"x,y.c\"\n",
        ),
        ("src/room.wld", "floor 3000 1000\n"),
        ("src/left.c", ""),
        ("src/right.c", ""),
        ("src/a.c", ""),
        ("src/x,y.c", ""),
        ("here.c", ""),
    ]
    .into_iter()
    .collect();
    let converted = convert("src/a.sim", "out/b.scene.toml", &files);
    let text = converted.outputs[0].text();
    let is_quoted = |line: &str| text.contains(&format!("= \"{line}\""));
    for path in ["Room.wld", "left.x", "right", "a.c,../src/b.c", "later.c", "x,y.c"] {
        assert!(is_quoted(&format!("../src/{path}")), "{path} is not in\n{text}");
    }
    assert!(is_quoted("here.x"), "{text}");
}

#[test]
fn a_companion_changes_the_camera_of_a_robi() {
    let robi = "drive DIFFERENTIAL_DRIVE\ncamera 0 60 100 0 -10 160 120\nfisheye 150\n";
    let read = |companion: &str| {
        let mut robi = read_robi("a.robi", robi).0;
        let reported = read_companion("a.toml", companion, &mut robi);
        (robi.camera.expect("a camera"), reported)
    };
    let (camera, reported) = read("[camera]\nfov_deg = 90\nsamples = 1\nz_mm = 70\nimage_px = [320, 240]\n");
    assert_eq!(reported, []);
    assert_eq!(camera.lens, Lens::Pinhole { fov: 90.0_f64.to_radians() });
    assert_eq!((camera.samples, camera.image, camera.position.to_array()), (1, Some([320, 240]), [0.06, 0.0, 0.07]));
    assert_eq!(read("[camera]\n").0, read("").0, "nothing stated, nothing changed");
    for companion in ["", "[camera]\nfisheye_deg = 120\n"] {
        let files = Overlay::of(&[("a.robi", robi), ("a.toml", companion)]);
        files.write(&convert("a.robi", "b.robi", &files));
        let [old, new] = ["a.robi", "b.robi"].map(|name| sim_format::load_robi(name, &files).0.expect("a robi"));
        assert_eq!(content::robi(&new).camera, content::robi(&old).camera);
    }
    let mut bare = read_robi("a.robi", "drive DIFFERENTIAL_DRIVE\n").0;
    assert_eq!(read_companion("a.toml", "[camera]\nz_mm = 100\n", &mut bare), []);
    assert_eq!(bare.camera.map(|camera| camera.lens), Some(sim_core::spec::DEFAULT_LENS), "a camera of its own");
}

#[test]
fn invalid_cameras_and_looks_are_reported_with_their_locations() {
    let reported = |text: &str| -> Vec<String> {
        let reported = read_scene("a.scene.toml", text).1;
        reported
            .iter()
            .map(|diagnostic| {
                format!(
                    "{}:{} {} {}; {}",
                    diagnostic.span.line,
                    diagnostic.span.column,
                    diagnostic.code,
                    diagnostic.message,
                    diagnostic.expected
                )
            })
            .collect()
    };
    let camera = |keys: &str| {
        reported(&format!("[world]\nfile = \"a.wld\"\n[[robot_type]]\nname = \"A\"\ncamera = {{ {keys} }}\n"))
    };
    assert_eq!(
        camera("fov_deg = 180"),
        ["5:22 number-range field of view `180` is out of range; a number in degrees from 1 to 170"]
    );
    assert_eq!(
        camera("fisheye_deg = 0"),
        ["5:26 number-range field of view `0` is out of range; a number in degrees from 1 to 360"]
    );
    assert_eq!(camera("samples = 9"), ["5:22 number-range samples `9` is out of range; an integer from 1 to 8"]);
    assert_eq!(
        camera("fov_deg = 50, fisheye_deg = 150"),
        ["5:12 toml-conflict `fov_deg` and `fisheye_deg` exclude each other; either `fov_deg` or `fisheye_deg`"]
    );
    let world = |keys: &str| reported(&format!("[world]\nfile = \"a.wld\"\n{keys}\n"));
    assert_eq!(
        world("light = { elevation_deg = 0 }"),
        ["3:27 number-range elevation of the sun `0` is out of range; a number in degrees from 1 to 90"]
    );
    assert_eq!(
        world("light = { ambient = nan }"),
        ["3:21 number-range share of ambient light `NaN` is out of range; a number from 0 to 1"]
    );
    assert_eq!(world("light = { shadows = 1 }"), ["3:21 toml-type `shadows` is of type integer; true or false"]);
    assert_eq!(
        world("sky = { zenith = [0, 0, 256] }"),
        ["3:25 number-range zenith `256` is out of range; an integer from 0 to 255"]
    );
    assert_eq!(
        world("sky = { ground = [1.5, 0, 0] }"),
        ["3:19 toml-type `ground` is of type float; an integer from 0 to 255"]
    );
    let colours = "an array of 3 integers from 0 to 255";
    assert_eq!(world("colour = \"grey\""), [format!("3:10 toml-type `colour` is of type string; {colours}")]);
    assert_eq!(world("colour = [1, 2]"), [format!("3:10 toml-type `colour` has 2 values; {colours}")]);
    assert_eq!(
        world("light = \"bright\""),
        ["3:9 toml-type `light` is of type string; a table such as `light = { azimuth_deg = -120, shadows = true }`"]
    );
    assert_eq!(
        world("sky = [0, 0, 9]"),
        [
            "3:7 toml-type `sky` is of type array; a table such as `sky = { horizon = [200, 210, 220], ground = [90, 90, 80] }`"
        ]
    );
    assert_eq!(
        reported("[world]\nfloor_mm = [9, 9]\ntexture = { file = \"a.png\" }\n"),
        ["3:11 toml-type `texture` is of type table; the name of an image file, between double quotes"]
    );
}

#[test]
fn the_scene_sets_the_parameters_of_the_radio() {
    let radio = |keys: &str| scene(&format!("[radio]\n{keys}\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n"));
    let all = radio("medium = \"token_ring\"\nbaud = 9600\nlatency_ms = 1.5\nrange_mm = 2500\nline_of_sight = true");
    assert_eq!(all.diagnostics, []);
    let stated = RadioModel {
        medium: Medium::TokenRing,
        baud: 9600,
        latency: Time(1_500),
        range: Some(2.5),
        line_of_sight: true,
    };
    assert_eq!(all.scene.radio, stated);
    assert_eq!(radio("medium = \"aloha\"").scene.radio, RadioModel { medium: Medium::Aloha, ..RadioModel::default() });
    assert_eq!(radio("medium = \"free\"").scene.radio, RadioModel::default());
    assert_eq!(scene("").scene.radio, RadioModel::default(), "nothing stated");
}

#[test]
fn invalid_radios_are_reported_with_their_locations() {
    let reported = |keys: &str| -> Vec<String> {
        let text = format!("[world]\nfile = \"a.wld\"\n[radio]\n{keys}\n");
        let reported = read_scene("a.scene.toml", &text).1;
        let of = |diagnostic: &sim_format::Diagnostic| {
            let suggestion = diagnostic.suggestion.as_ref().map_or(String::new(), |text| format!("; {text}"));
            let location = format!("{}:{}", diagnostic.span.line, diagnostic.span.column);
            format!("{location} {} {}; {}{suggestion}", diagnostic.code, diagnostic.message, diagnostic.expected)
        };
        reported.iter().map(of).collect()
    };
    assert_eq!(
        reported("medium = \"alhoa\""),
        ["4:10 toml-choice `alhoa` is not a valid `medium`; one of free, aloha, token_ring; write `aloha`"]
    );
    assert_eq!(reported("medium = 1"), ["4:10 toml-type `medium` is of type integer; one of free, aloha, token_ring"]);
    let bauds = "an integer from 1 to 1000000000";
    assert_eq!(reported("baud = 0"), [format!("4:8 number-range baud `0` is out of range; {bauds}")]);
    assert_eq!(reported("baud = 1000000001"), [format!("4:8 number-range baud `1000000001` is out of range; {bauds}")]);
    assert_eq!(reported("baud = 9600.5"), [format!("4:8 toml-type `baud` is of type float; {bauds}")]);
    let times = "a number in ms from 0 to 3600000";
    for number in ["-1", "nan", "inf", "3600001"] {
        let written = if number == "nan" { "NaN" } else { number };
        let expected = format!("4:14 number-range latency `{written}` is out of range; {times}");
        assert_eq!(reported(&format!("latency_ms = {number}")), [expected]);
    }
    assert_eq!(
        reported("latency_ms = 0.0005"),
        ["4:1 number-range latency `0.0005` ms is not a whole number of microseconds; a multiple of 0.001"]
    );
    let lengths = "a number in mm from 0.001 to 1000000000";
    for number in ["0", "-5", "nan", "inf"] {
        let written = if number == "nan" { "NaN" } else { number };
        let expected = format!("4:12 number-range range `{written}` is out of range; {lengths}");
        assert_eq!(reported(&format!("range_mm = {number}")), [expected]);
    }
    assert_eq!(reported("line_of_sight = 1"), ["4:17 toml-type `line_of_sight` is of type integer; true or false"]);
    assert_eq!(
        reported("range = 1"),
        ["4:1 toml-key unknown key `range` in `radio`; one of medium, baud, latency_ms, range_mm, line_of_sight; \
          write `range_mm`"]
    );
}

/// Loads a scene with two robots that have the given keys.
fn numbered(first: &str, second: &str) -> sim_format::Loaded {
    let robot = |keys: &str| format!("[[robot]]\ntype = \"S4\"\n{keys}\n");
    scene(&format!(
        "start = [{{ x_mm = 500, y_mm = 500 }}, {{ x_mm = 1500, y_mm = 500 }}]\n{}{}",
        robot(first),
        robot(second)
    ))
}

#[test]
fn robots_have_the_numbers_that_the_scene_gives_them() {
    let programs = |loaded: &sim_format::Loaded| -> Vec<(u32, String)> {
        loaded.scene.robots.iter().map(|robot| (robot.id.0, robot.program_name().to_owned())).collect()
    };
    let named = |first: &str, second: &str| {
        let loaded = numbered(&format!("program = \"a.c\"\n{first}"), &format!("program = \"b.c\"\n{second}"));
        assert_eq!(loaded.diagnostics, [], "{first}, {second}");
        assert_eq!(places(&loaded), [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0)], "the first number takes the first start");
        programs(&loaded)
    };
    let (straight, turned) =
        ([(1, "a.c".to_owned()), (2, "b.c".to_owned())], [(1, "b.c".to_owned()), (2, "a.c".to_owned())]);
    assert_eq!(named("", ""), straight);
    assert_eq!(named("id = 1", "id = 2"), straight);
    assert_eq!(named("id = 2", "id = 1"), turned);
    assert_eq!(named("id = 2", ""), turned, "the other one takes what is free");
    assert_eq!(named("", "id = 1"), turned);
    let group = "count = 3\nlayout = { kind = \"line\", from_mm = [500, 2000], to_mm = [2500, 2000] }";
    let loaded = numbered(group, "id = 2");
    assert_eq!(loaded.diagnostics, []);
    let stand = places(&loaded);
    assert_eq!(stand, [(0.5, 2.0, 0.0), (0.5, 0.5, 0.0), (1.5, 2.0, 0.0), (2.5, 2.0, 0.0)]);
}

#[test]
fn invalid_robot_numbers_are_reported_with_their_locations() {
    let reported = |first: &str, second: &str| -> Vec<String> {
        let reported = numbered(first, second).diagnostics;
        let of = |diagnostic: &sim_format::Diagnostic| {
            format!(
                "{}:{} {} {}; {}",
                diagnostic.span.line, diagnostic.span.column, diagnostic.code, diagnostic.message, diagnostic.expected
            )
        };
        reported.iter().map(of).collect()
    };
    let range = "an integer from 1 to 100000";
    for id in ["0", "-1", "100001", "99999999999999999999"] {
        assert_eq!(
            reported(&format!("id = {id}"), ""),
            [format!("6:6 number-range id `{id}` is out of range; {range}")]
        );
    }
    assert_eq!(reported("id = 1.0", ""), [format!("6:6 toml-type `id` is of type float; {range}")]);
    let each = "robot numbers go from 1 to the number of robots, 2, each once";
    assert_eq!(
        reported("id = 2", "id = 2"),
        [format!("9:1 robot-id-twice the number 2 is that of the robot of line 6; {each}")]
    );
    assert_eq!(reported("id = 1", "id = 3"), [format!("9:1 robot-id-gap the number 3 leaves a gap; {each}")]);
    assert_eq!(
        reported("id = 1\ncount = 2", ""),
        [
            "6:1 toml-conflict `id` and `count` exclude each other; either `id` or `count`",
            "8:1 sim-start-missing no start is left for this robot: the world has 2; `x_mm` and `y_mm`, a `layout`, or a \
             start in the world"
        ]
    );
}

#[test]
fn a_sim_has_robots_in_the_order_of_their_numbers() {
    let text = "[world]\nfloor_mm = [4000, 3000]\n\
                start = [{ x_mm = 500, y_mm = 500 }, { x_mm = 1500, y_mm = 500 }, { x_mm = 2500, y_mm = 500 }]\n\
                [[robot_type]]\nfile = \"s.robi\"\n\
                [[robot]]\ntype = \"s.robi\"\nprogram = \"a.c\"\nid = 4\n\
                [[robot]]\ntype = \"S4\"\nprogram = \"b.c\"\ncount = 2\n\
                [[robot]]\ntype = \"S4\"\nprogram = \"c.c\"\nid = 2\nx_mm = 2000\ny_mm = 2000\n";
    let files =
        Overlay::of(&[("a.scene.toml", text), ("s.robi", "wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE A B C D\n")]);
    let converted = convert("a.scene.toml", "b.sim", &files);
    files.write(&converted);
    let [old, new] = ["a.scene.toml", "b.sim"].map(|name| load_scene(name, &files));
    assert_eq!((old.diagnostics, new.diagnostics), (Vec::new(), Vec::new()));
    let programs: Vec<&str> = old.scene.robots.iter().map(|robot| robot.program_name()).collect();
    assert_eq!(programs, ["b.c", "c.c", "b.c", "a.c"]);
    let text = &converted.outputs.last().expect("a sim").text();
    assert_eq!(content::scene(&new.scene).robots, content::scene(&old.scene).robots, "{text}");
    let back = convert("b.sim", "c.scene.toml", &files);
    files.write(&back);
    let again = load_scene("c.scene.toml", &files).scene;
    assert_eq!(content::scene(&again).robots, content::scene(&old.scene).robots);
}

#[test]
fn files_that_cannot_become_each_other_are_refused() {
    let files = Overlay::of(&[("a.wld", "floor 1000 1000\n3 4 500 600\n"), ("a.sim", "")]);
    let code = |from, to| convert(from, to, &files).diagnostics.last().expect("a message").code;
    assert_eq!(code("a.wld", "b.robi"), Code::ConvertKind);
    assert_eq!(code("a.wld", "b.maz"), Code::ConvertMaze);
    assert_eq!(code("a.wld", "b.txt"), Code::ConvertKind, "mazes of others are read, not written");
    assert_eq!(code("a.wld", "b.doc"), Code::FileKind);
    assert!(convert("missing.sim", "b.toml", &files).outputs.is_empty());
}
