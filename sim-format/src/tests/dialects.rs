//! Scenes and objects in every dialect.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::super::*;
use super::{Memory, S4, codes};
use sim_core::pose::Pose;

const SIGN: &str = "# EyeSim Object File\nobj Stop.obj\nname StopSign\nscale 0.025\nmass 2  0 0 0\n\
    collider capsule 0 7500 0  150 14200 y\nbuoyancy 0\n";

fn scout() -> String {
    S4.replace("name  S4 plus", "name Scout")
}

/// Loads the scene `text` with a maze of three starts, an empty world, a robot type `Scout` and an object type
/// `StopSign`.
fn load(text: &str) -> Loaded {
    let files = Memory::new(&[
        ("sims/a.sim", text),
        ("sims/m.maz", " _____\n|S U S|\n|_____|\n1000"),
        ("sims/w.wld", "floor 9000 9000"),
        ("sims/scout.robi", &scout()),
        ("sims/signs/stop.esObj", SIGN),
        ("worlds/Crate/Boxes.esObj", "name Crate1\nmass 1 0 0 0\ncollider box 0 100 0 360 200 360\nfixed\n"),
    ]);
    load_scene("sims/a.sim", &files)
}

/// Loads the scene `text`, which must not cause diagnostics.
fn scene(text: &str) -> SceneSpec {
    let loaded = load(text);
    assert_eq!(loaded.diagnostics, [], "{text}");
    loaded.scene
}

#[test]
fn dialect_of_a_line_determines_the_generation() {
    let scene = scene(
        "world w.wld\nrobi scout.robi a.c 500 500 0\nrobi scout.robi\nLabBot 1000 1000 0 b.x\nScout 2000 2000 0 c.x\n",
    );
    let generations: Vec<_> = scene.robots.iter().map(|robot| (robot.api, robot.dialect)).collect();
    assert_eq!(generations, [(None, Some(6)), (None, Some(7)), (None, Some(7))]);
}

#[test]
fn built_in_robots_start_at_a_pose_or_at_a_letter() {
    let scene =
        scene("maze m.maz\nlabbot 500 500 180 a.x\nS4 s\nS4 S 90 prog.py\nS4 u 02-prey.py\nsettings vis Trace\n");
    let starts: Vec<Pose> = scene.robots.iter().map(|robot| robot.start).collect();
    let expected = [
        Pose::new(0.5, 0.5, PI),
        Pose::new(0.5, 1.5, FRAC_PI_2),
        Pose::new(2.5, 1.5, FRAC_PI_2),
        Pose::new(1.5, 1.5, FRAC_PI_2),
    ];
    assert_eq!(starts, expected);
    let programs: Vec<&str> = scene.robots.iter().map(RobotSpec::program_name).collect();
    assert_eq!(programs, ["a.x", "", "prog.py", "02-prey.py"]);
    let names: Vec<&str> = scene.robots.iter().map(|robot| robot.robi.name.as_str()).collect();
    assert_eq!(names, ["LabBot", "S4", "S4", "S4"]);
    assert_eq!(scene.settings, Settings { shows_beams: true, shows_trace: true });
}

#[test]
fn stated_heading_replaces_the_heading_of_the_letter() {
    let scene = scene("maze m.maz\nS4 U 65 a.py\nS4 S 0\n");
    let headings: Vec<f64> = scene.robots.iter().map(|robot| robot.start.heading.radians()).collect();
    assert_eq!(headings, [sim_core::unit::radians_from_degrees(65.0), 0.0]);
}

#[test]
fn classic_robots_take_the_remaining_starts() {
    let scene = scene("maze m.maz\nS4 U 90\nrobi scout.robi a.so\nrobi scout.robi a.so\n");
    let positions: Vec<DVec2> = scene.robots.iter().map(|robot| robot.start.position).collect();
    assert_eq!(positions, [DVec2::new(1.5, 1.5), DVec2::new(0.5, 1.5), DVec2::new(2.5, 1.5)]);
}

#[test]
fn robots_share_a_cell_if_a_letter_has_too_few_starts() {
    let loaded = load("maze m.maz\nS4 U\nS4 U\n");
    assert_eq!(codes(&loaded.diagnostics), ["sim-start-overlap"]);
    assert_eq!(loaded.scene.robots[0].start, loaded.scene.robots[1].start);
}

#[test]
fn loaded_types_are_placed_by_the_names_in_their_files() {
    let scene = scene(
        "world w.wld\nrobot scout.robi\nobject signs/stop.esObj\nStopSign 2230 4673 90\nScout 500 600 90 a.x\n\
         S4 2000 2000 0\nScout 3000 3000 0\ncan 1000 1000 0\nStopSign 5000 5000 0\n",
    );
    let ids: Vec<String> = scene.robots.iter().map(|robot| format!("{} {}", robot.id, robot.robi.name)).collect();
    assert_eq!(ids, ["r1 Scout", "r2 S4", "r3 Scout"]);
    let names: Vec<&str> = scene.objects.iter().map(|object| object.kind.name.as_str()).collect();
    assert_eq!(names, ["StopSign", "Can", "StopSign"], "in the order of their lines");
    assert_eq!(scene.objects[0].pose, Pose::new(2.23, 4.673, FRAC_PI_2));
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].kind, &scene.objects[2].kind));
}

#[test]
fn keywords_of_2018_load_types() {
    let scene = scene("world w.wld\nrobi scout.robi\nobj signs/stop.esObj\nStopSign 1000 1000 0\nScout 500 600 90\n");
    assert_eq!((scene.robots.len(), scene.objects.len()), (1, 1));
}

#[test]
fn a_type_without_a_name_is_named_by_its_file() {
    let files = Memory::new(&[
        ("a.sim", "world w.wld\nobj customObject.esObj\nS4 100 100 0\ncustomObject 1000 500 180\n"),
        ("w.wld", "floor 9000 9000"),
        ("customObject.esObj", "mass 1\nsphere 0 50 0 50\n"),
    ]);
    let loaded = load_scene("a.sim", &files);
    assert_eq!((loaded.diagnostics, loaded.scene.objects.len()), (vec![], 1));
}

#[test]
fn inputs_do_not_contain_built_in_types() {
    let loaded = load("world w.wld\nobject signs/stop.esObj\nobject ./signs/stop.esObj\nS4 500 500 0\n");
    let inputs: Vec<&str> = loaded.inputs.iter().map(|input| input.path.as_str()).collect();
    assert_eq!(inputs, ["sims/a.sim", "sims/w.wld", "sims/signs/stop.esObj"]);
}

#[test]
fn a_scene_without_a_world_has_the_box_of_eyesim_vr() {
    let loaded = load("labbot 1000 1000 0\n");
    assert_eq!(codes(&loaded.diagnostics), ["sim-world-missing"]);
    assert!(!loaded.has_errors());
    let world = &loaded.scene.world;
    assert_eq!((world.floor, world.walls.len()), (DVec2::splat(2.0), 4));
    assert!(world.walls.iter().all(|wall| (wall.from - wall.to).length() == 2.0), "{:?}", world.walls);
    // A reference to a missing world is an error.
    let loaded = load("world none.wld\nlabbot 1000 1000 0\n");
    assert_eq!((codes(&loaded.diagnostics), loaded.has_errors()), (vec!["file-missing"], true));
}

#[test]
fn robots_of_unknown_types_keep_their_numbers() {
    let loaded = load("world w.wld\nLabBott 500 500 0 a.x\nCrate1 700 700 0\nS4 2000 2000 0 b.x\n");
    assert_eq!(codes(&loaded.diagnostics), ["sim-type-unknown", "sim-type-unknown"]);
    let severities: Vec<Severity> = loaded.diagnostics.iter().map(|diagnostic| diagnostic.severity).collect();
    assert_eq!(severities, [Severity::Error, Severity::Warning]);
    assert_eq!(loaded.diagnostics[0].suggestion.as_deref(), Some("write `LabBot`"));
    let expected = "load it above with `object ../worlds/Crate/Boxes.esObj`";
    assert_eq!(loaded.diagnostics[1].suggestion.as_deref(), Some(expected));
    assert_eq!(loaded.scene.robots[0].id.to_string(), "r2");
}

#[test]
fn diagnostics_of_many_lines_are_limited() {
    let text = format!("world w.wld\nS4 500 500 0\n{}", "Nobody 100 100 0\n".repeat(1500));
    let loaded = load(&text);
    assert_eq!(loaded.diagnostics.len(), 1001);
    assert_eq!(loaded.diagnostics[1000].code, Code::FileMore);
}

#[test]
fn mesh_without_object_file_has_the_colliders_of_the_built_in_type() {
    let scene = scene("world w.wld\nrobi scout.robi a.so 500 500 0\nobject 800 800 0 0.1 %sim%/objects/can/can.ms3d\n");
    let object = &scene.objects[0];
    let can = builtin::object("can").expect("built in");
    assert_eq!((object.friction, object.kind.mass, &object.kind.colliders), (0.1, can.mass, &can.colliders));
    let model = object.kind.model.as_ref().expect("a mesh");
    assert_eq!((model.path.text.as_str(), object.kind.file.as_str()), ("%sim%/objects/can/can.ms3d", "sims/a.sim"));
}

#[test]
fn letters_of_a_maze_place_built_in_objects() {
    let files = Memory::new(&[("a.sim", "maze m.maz\nS4 S\n"), ("m.maz", " _____\n|S|o|X|\n|_|_|_|\n")]);
    let loaded = load_scene("a.sim", &files);
    assert_eq!(loaded.diagnostics, []);
    let names: Vec<&str> = loaded.scene.objects.iter().map(|object| object.kind.name.as_str()).collect();
    assert_eq!(names, ["Soccer", "Crate"]);
}

#[test]
fn marker_colour_is_optional() {
    let scene = scene("world w.wld\nS4 500 500 0\nmarker 1000 500\nMarker 1 2 10 20 30\nmarker 3 4 1 2 3 4\n");
    let colours: Vec<[u8; 4]> = scene.markers.iter().map(|marker| marker.colour).collect();
    assert_eq!(colours, [[255, 0, 0, 255], [10, 20, 30, 255], [1, 2, 3, 4]]);
    assert_eq!(scene.markers[0].position, DVec2::new(1.0, 0.5));
}

#[test]
fn stop_sign_is_converted_to_metres() {
    let (sign, diagnostics) = read_esobj("stop.esObj", SIGN);
    assert_eq!((diagnostics, sign.name.as_str(), sign.mass), (vec![], "StopSign", 2.0));
    let [Collider::Capsule { centre, radius, height, axis: Axis::Z }] = sign.colliders[..] else {
        panic!("an upright capsule, not {:?}", sign.colliders)
    };
    // 0.025 mm per unit: the centre at 187.5 mm, 7.5 mm wide, 355 mm high.
    let is_close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    assert!((centre - DVec3::new(0.0, 0.0, 0.1875)).length() < 1e-12, "{centre}");
    assert!(is_close(radius, 0.00375) && is_close(height, 0.355) && is_close(sign.scale, 0.025), "{radius} {height}");
}

#[test]
fn old_and_new_collider_lines_are_equal_and_axes_are_converted() {
    let old = "scale 2\nmass 3 1 2 3\nbox 10 20 30 1 2 3\nsphere 1 2 3 4\ncapsule 0 1 0 5 40 z\ncapsule 0 0 0 5 1 x\n";
    let new = old.replace("\nbox", "\ncollider box").replace("\nsphere", "\ncollider sphere");
    let (object, diagnostics) = read_esobj("a.esObj", old);
    assert_eq!((&object, diagnostics), (&read_esobj("a.esObj", &new).0, vec![]));
    let mm = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * 0.002;
    // The axes X right, Y up, Z forward become -y, z, x.
    assert_near(object.centre_of_mass, mm(3.0, -1.0, 2.0));
    let [Collider::Box { centre, size }, Collider::Sphere { centre: sphere_centre, radius }, lying, transverse] =
        object.colliders[..]
    else {
        panic!("{:?}", object.colliders)
    };
    assert_near(centre, mm(30.0, -10.0, 20.0));
    assert_near(size, mm(3.0, 1.0, 2.0));
    assert_near(sphere_centre, mm(3.0, -1.0, 2.0));
    assert!((radius - 0.008).abs() < 1e-12);
    assert!(matches!(lying, Collider::Capsule { axis: Axis::X, .. }));
    // Lower than wide: becomes a sphere.
    assert!(matches!(transverse, Collider::Capsule { axis: Axis::Y, height, radius, .. } if height == 2.0 * radius));
}

fn assert_near(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-12, "{a} is not {b}");
}

#[test]
fn only_balls_roll() {
    let rolling = |text: &str| read_esobj("a.esObj", text).0.rolling;
    assert_eq!(rolling("mass 1\nsphere 0 5 0 5\n"), Some(DEFAULT_ROLLING));
    assert_eq!(rolling("mass 1\nsphere 0 5 0 5\nrolling 0.1\n"), Some(0.1));
    assert_eq!(rolling("mass 1\nsphere 0 5 0 5\nbox 0 5 0 5 5 5\n"), None);
}

#[test]
fn fixed_objects_may_overlap_walls_and_each_other() {
    let text = "maze m.maz\nobject ../worlds/Crate/Boxes.esObj\nS4 S\nCrate1 2500 1000 0\nCrate1 2500 900 0\n";
    assert_eq!(load(text).diagnostics, []);
    // A robot must not overlap an object.
    assert_eq!(codes(&load(&format!("{text}Crate1 500 1500 0\n")).diagnostics), ["sim-object-overlap"]);
}

#[test]
fn a_pile_of_objects_is_an_error() {
    let pile = |count| load(&format!("maze m.maz\nS4 S\n{}", "can 900 1200 0\n".repeat(count)));
    assert!(!pile(201).has_errors());
    assert!(pile(202).diagnostics.iter().any(|it| it.message.starts_with("more than 200 objects start inside")));
    assert!(pile(202).has_errors());
}

#[test]
fn specs_of_all_dialects() {
    let vr = "world a.maz\nsettings VIS\nrobot a.robi\nobj a.esObj\nLabBot 1 2 3 a.x\nS4 S 90 b.py\nScout 4 5 6 c.exe\n\
              can 1 2 3\nmarker 1 2 3 4 5\n";
    insta::assert_debug_snapshot!("sim-vr", read_sim("s.sim", vr));
    insta::assert_debug_snapshot!("esobj", read_esobj("stop.esObj", SIGN));
}
