//! Submarines in a pool: motion, contacts and depth in programs, reports, traces and pictures.
#![allow(clippy::disallowed_methods, reason = "angles by hand, compared within a tolerance")]

use tests::{Scratch, number, root};

fn pool() -> String {
    root().join("sims/pool.sim").to_str().expect("UTF-8").to_owned()
}

#[test]
fn a_lap_of_the_pool_on_mako() {
    let scratch = Scratch::new();
    let report = scratch.report(&pool(), &["--trace", "trace.jsonl", "--plot", "lap.svg"], 0);
    let robot = &report["robots"][0];
    assert_eq!(robot["outcome"], "finished", "{robot:#}");
    assert_eq!(robot["contacts"], 0, "{robot:#}");
    assert_eq!(number(robot, "depth_m"), 0.0, "it has surfaced");
    let [dx, dy] = [number(robot, "pose.x_m") - 2.0, number(robot, "pose.y_m") - 1.5];
    assert!(dx.hypot(dy) < 1.0, "it is back: {robot:#}");
    // The submarine goes once around the middle, through all quarters, about 0.9 m above the floor.
    let trace = scratch.trace("trace.jsonl");
    let of = |kind: &'static str| trace.iter().filter(move |event| event["event"] == kind);
    let positions: Vec<[f64; 2]> =
        of("pose").map(|event| [number(event, "x_m") - 5.0, number(event, "y_m") - 3.0]).collect();
    let turned = |[[x, y], [to_x, to_y]]: [[f64; 2]; 2]| (x * to_y - y * to_x).atan2(x * to_x + y * to_y);
    let around: f64 = positions.windows(2).map(|pair| turned([pair[0], pair[1]])).sum();
    assert!((around - std::f64::consts::TAU).abs() < 0.5, "around by {around} rad");
    let under_way = of("posture").filter(|event| (15.0..50.0).contains(&number(event, "t_s")));
    for event in under_way {
        assert!((0.85..0.95).contains(&number(event, "lift_m")), "{event}");
    }
    assert!(scratch.read("lap.svg").contains("r1, 0.00 m deep"));
}

#[test]
fn the_lap_is_the_same_on_threads_in_processes_and_for_every_slot() {
    let scratch = Scratch::new();
    // 40 s, in the middle of the lap, is the end of a slot for each slot length.
    let lap = |args: &[&str]| scratch.report(&pool(), &[&["--until", "40"], args].concat(), 0);
    let first = lap(&[]);
    for slot in ["1", "200"] {
        assert_eq!(lap(&["--slot", slot])["robots"], first["robots"], "slots of {slot} ms");
    }
    for args in [["--threads", "1"], ["--threads", "2"], ["--exec", "process"]] {
        assert_eq!(lap(&args)["digest"], first["digest"], "{args:?}");
    }
}

/// Hits a wall obliquely, slides along it, sinks to the floor and rises there; prints its position.
const BUMP: &str = r#"
#include "eyebot.h"
int main() {
    int x, y, z, phi;
    for (int i = 0; i < 6; i++) {
        MOTORDrive(1, 100); MOTORDrive(3, 100);
        MOTORDrive(2, i < 3 ? -60 : 60); MOTORDrive(4, i < 3 ? -60 : 60);
        OSWait(1500);
        SIMGetRobot(0, &x, &y, &z, &phi);
        printf("%d %d %d %d\n", x, y, z, phi);
    }
    for (int i = 1; i <= 4; i++) MOTORDrive(i, 0);
    OSWait(5000);
    return 0;
}
"#;

/// A pool of 10 x 6 m as a TOML table, with a robot at `x_mm` = 7000 that heads for the right wall.
fn table(water: &str) -> String {
    format!(
        "[world]\nfloor_mm = [10000, 6000]\nwall = [{{ from_mm = [10000, 0], to_mm = [10000, 6000] }}]\n{water}\n\
         [[robot]]\ntype = \"Mako\"\nprogram = \"bump.c\"\nx_mm = 7000\ny_mm = 3000\nheading_deg = 20\n"
    )
}

#[test]
fn it_slides_along_a_wall_and_stays_between_floor_and_surface() {
    let scratch = Scratch::new();
    scratch.write("bump.c", BUMP);
    scratch.write("bump.scene.toml", &table("water_mm = 800"));
    // A slot ends at 12 s for each slot length.
    let report = scratch.report("bump.scene.toml", &["--trace", "trace.jsonl", "--until", "12"], 0);
    let robot = &report["robots"][0];
    // The body is a disc of 0.6 m radius; the skin of contacts is 1 micrometre.
    assert!((number(robot, "pose.x_m") - 9.4).abs() < 2e-6, "{robot:#}");
    assert!(number(robot, "pose.y_m") > 4.2 && robot["contacts"] == 1, "{robot:#}");
    let lifts: Vec<f64> = scratch
        .trace("trace.jsonl")
        .iter()
        .filter(|event| event["event"] == "posture")
        .map(|event| number(event, "lift_m"))
        .collect();
    // The water is 0.8 m deep, and the hull 0.3 m high.
    assert!(lifts.contains(&0.0) && lifts.iter().all(|lift| (0.0..=0.5).contains(lift)), "{lifts:?}");
    for slot in ["1", "200"] {
        let same = scratch.report("bump.scene.toml", &["--slot", slot, "--until", "12"], 0);
        assert_eq!(same["robots"], report["robots"], "slots of {slot} ms");
    }
}

#[test]
fn programs_learn_that_thrusters_have_no_speeds_and_no_encoders() {
    let scratch = Scratch::new();
    scratch.write(
        "bump.c",
        "#include \"eyebot.h\"\nint main() { printf(\"%d\\n\", VWSetSpeed(100, 0)); return ENCODERRead(1) < 0; }\n",
    );
    scratch.write("bump.scene.toml", &table("water_mm = 2000"));
    let ran = scratch.eyesim(&["run", "bump.scene.toml"]);
    assert!(ran.stderr.contains("thrusters can be driven only by their motors"), "{}", ran.stderr);
    assert!(ran.stderr.contains("`ENCODERRead`: `Mako` has no device of this kind"), "{}", ran.stderr);
}

#[test]
fn a_submarine_needs_water_over_its_hull() {
    let scratch = Scratch::new();
    scratch.write("bump.c", BUMP);
    for (water, message) in [
        ("", "robot 1 has thrusters, and the world no water"),
        ("water_mm = 200", "the water is 200 mm deep, the hull of robot 1 300 mm high"),
    ] {
        scratch.write("dry.scene.toml", &table(water));
        let ran = scratch.eyesim(&["check", "dry.scene.toml"]);
        assert!(ran.code != Some(0) && ran.stdout.contains(message), "{ran:?}");
    }
}

#[test]
fn worlds_with_water_are_converted() {
    let scratch = Scratch::new();
    scratch.write("a.wld", "floor 3000 2000\nwater 1250\n0 0 3000 0\n");
    for (from, to, line) in [("a.wld", "b.toml", "water_mm = 1250"), ("b.toml", "c.wld", "water 1250")] {
        let ran = scratch.eyesim(&["convert", from, "-o", to]);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        assert!(scratch.read(to).lines().any(|read| read == line), "{}", scratch.read(to));
    }
}

/// Prints the height of each object, then the reading of Mako's front PSD at the surface and on the floor; then pushes
/// the buoy. The numbers of objects follow those of robots.
const LOOK: &str = r#"
#include "eyebot.h"
int main() {
    int x, y, z, phi;
    for (int i = 1; i <= SIMGetObjectCount(); i++) {
        SIMGetObject(i + 1, &x, &y, &z, &phi);
        printf("object %d at height %d\n", i, z);
    }
    printf("at the surface %d\n", PSDGet(1));
    MOTORDrive(2, -100); MOTORDrive(4, -100);
    OSWait(8000);
    SIMGetRobot(0, &x, &y, &z, &phi);
    printf("at height %d %d\n", z, PSDGet(1));
    MOTORDrive(1, 100); MOTORDrive(3, 100);
    OSWait(15000);
    MOTORDrive(1, 0); MOTORDrive(3, 0);
    OSWait(20000);
    SIMGetObject(2, &x, &y, &z, &phi);
    printf("pushed %s, height %d\n", x > 4500 ? "away" : "not", z);
    return 0;
}
"#;

#[test]
fn objects_float_by_their_buoyancy() {
    let scratch = Scratch::new();
    scratch.write("look.c", LOOK);
    // A cube of 0.4 m displaces 0.064 m3. With a mass of 32 kg half of its height is under water.
    let cube = |mass: u32| {
        format!(
            "name Cube{mass}\ncollider box 0 200 0 400 400 400\nmass {mass} 0 200 0\nbuoyancy 0.064\nfriction 0.4\n"
        )
    };
    scratch.write("light.esObj", &cube(32));
    scratch.write("heavy.esObj", &cube(80));
    scratch.write("pool.wld", "floor 12000 6000\nwater 2000\n12000 0 12000 6000\n");
    scratch.write(
        "float.sim",
        "world pool.wld\nobject light.esObj\nobject heavy.esObj\nCube32 4000 3000 0\nCube80 4000 500 0\nMako 2000 3000 0 look.c\n",
    );
    let ran = scratch.eyesim(&["run", "float.sim"]);
    for line in ["object 1 at height 1800", "object 2 at height 0", "at the surface 1225", "at height 0 9425"] {
        assert!(ran.stdout.lines().any(|read| read.ends_with(line)), "{line}: {ran:?}");
    }
    assert!(ran.stdout.contains("pushed away, height 1800"), "{ran:?}");
}
