//! RoBIOS-7 programs that drive, measure and read the ground truth: results of calls compared with true poses.
#![allow(clippy::disallowed_methods, reason = "arcs by hand, compared within a micrometre")]

use std::f64::consts::{PI, TAU};

use serde_json::Value;
use tests::{Ran, Scratch, number};

/// The beginning of each program: a macro that ends it with the line of a failed check, and some time at rest.
const BEGIN: &str = r#"#include "eyebot.h"
#include <stdio.h>
#include <stdlib.h>
#define CHECK(condition) do { if (!(condition)) { printf("line %d: %s\n", __LINE__, #condition); exit(1); } } while (0)
#define IS(value, expected) do { int is = (value), should = (expected); if (is != should) { \
    printf("line %d: %s is %d, not %d\n", __LINE__, #value, is, should); exit(1); } } while (0)
static inline void rest(void) { for (int i = 0; i < 60; i++) VWDone(); }
#line 1
"#;

/// A closed room of 4 m by 4 m.
const ROOM: &str = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";

/// A plane without walls, 400 m by 400 m.
const PLANE: &str = "floor 400000 400000\n";

/// Writes a folder with a world, a sim file with these lines, and `mine.c`.
fn scene(world: &str, lines: &str, program: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("world.wld", world);
    scratch.write("mine.c", &format!("{BEGIN}{program}"));
    scratch.write("scene.sim", &format!("world world.wld\n{lines}"));
    scratch
}

/// Runs the scene to the end of its programs, which must succeed; returns the report and the trace.
fn run(scratch: &Scratch) -> (Value, Vec<Value>) {
    run_until(scratch, "600")
}

fn run_until(scratch: &Scratch, until: &str) -> (Value, Vec<Value>) {
    let args = ["run", "scene.sim", "--report", "report.json", "--trace", "trace.jsonl", "--until", until];
    let ran = scratch.eyesim(&args);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    (serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON"), scratch.trace("trace.jsonl"))
}

/// Result of a run of `program` on an S4 robot in the room.
fn messages(program: &str) -> Ran {
    let scratch = scene(ROOM, "S4 1000 1000 0 mine.c\n", program);
    scratch.eyesim(&["run", "scene.sim", "--until", "600"])
}

fn events<'a>(trace: &'a [Value], event: &'a str) -> impl Iterator<Item = &'a Value> {
    trace.iter().filter(move |line| line["event"] == event)
}

/// The pose after an arc with `[length in m, angle in rad]`.
fn moved([x, y, phi]: [f64; 3], [length, angle]: [f64; 2]) -> [f64; 3] {
    let chord = if angle == 0.0 { length } else { length * (angle / 2.0).sin() / (angle / 2.0) };
    let along = phi + angle / 2.0;
    [x + chord * along.cos(), y + chord * along.sin(), phi + angle]
}

/// Drives: the call of the program, and `[length in m, angle in rad]`.
fn drives() -> Vec<(String, [f64; 2])> {
    let mut drives = Vec::new();
    let straights = [(500, 200), (-500, 200), (1, 1), (-7, 3), (40_000, 600), (-33_333, 500), (123, -50), (0, 100)];
    for (mm, v) in straights.iter().chain(&[(2_000, 9_999), (499, 77)]) {
        drives.push((format!("VWStraight({mm}, {v})"), [f64::from(*mm) / 1e3, 0.0]));
    }
    for (degrees, omega) in [(90, 60), (-90, 60), (180, 45), (-180, 90), (360, 100), (1, 1), (3_600, 300), (-721, 7)] {
        drives.push((format!("VWTurn({degrees}, {omega})"), [0.0, f64::from(degrees).to_radians()]));
    }
    let curves =
        [(500, 90, 200), (-500, 90, 200), (500, -90, 100), (-700, -33, 100), (300, 720, 100), (50_000, -37, 600)];
    for (mm, degrees, v) in curves.iter().chain(&[(800, 0, 300), (100, 1, 5)]) {
        drives
            .push((format!("VWCurve({mm}, {degrees}, {v})"), [f64::from(*mm) / 1e3, f64::from(*degrees).to_radians()]));
    }
    for (dx, dy) in [(500, 0), (500, 200), (300, -299), (-400, 100), (-400, -400), (0, 400), (38_000, 1), (0, 0)] {
        let (x, y) = (f64::from(dx) / 1e3, f64::from(dy) / 1e3);
        // The circle through both points whose tangent at the start is along x: its radius, and the angle between the
        // points seen from its centre.
        let sense = if dx < 0 { -1.0 } else { 1.0 };
        let arc = if dy == 0 {
            [x, 0.0]
        } else {
            let radius = (x * x + y * y) / (2.0 * y);
            let angle = 2.0 * y.atan2(x.abs());
            [sense * radius * angle, sense * angle]
        };
        drives.push((format!("VWDrive({dx}, {dy}, 300)"), arc));
    }
    drives
}

#[test]
fn drives_end_on_the_mark() {
    let drives = drives();
    let mut program = String::from("int main(void)\n{\n    int x, y, phi;\n");
    for (call, arc) in &drives {
        let [x, y, phi] = moved([0.0; 3], *arc);
        let (x, y, phi) = ((1e3 * x).round() as i32, (1e3 * y).round() as i32, phi.to_degrees().round() as i32);
        let phi = (phi + 179).rem_euclid(360) - 179;
        program += &format!(
            "    IS(VWSetPosition(0, 0, 0), 0); IS({call}, 0); IS(VWWait(), 0); IS(VWDone(), 1); IS(VWRemain(), 0);\n    \
             VWGetPosition(&x, &y, &phi); IS(x, {x}); IS(y, {y}); IS(phi, {phi}); rest();\n"
        );
    }
    let scratch = scene(PLANE, "S4 200000 200000 30 mine.c\n", &(program + "    return 0;\n}\n"));
    let (_, trace) = run_until(&scratch, "5000");
    let belief: Vec<&Value> = events(&trace, "odometry").collect();
    assert_eq!(belief.len(), drives.len());
    let mut truth = [200.0, 200.0, PI / 6.0];
    for ((call, arc), odometry) in drives.iter().zip(belief) {
        let close = |value: &Value, [x, y, phi]: [f64; 3]| {
            let turned = (number(value, "phi_rad") - phi) / TAU;
            let off = (number(value, "x_m") - x).abs().max((number(value, "y_m") - y).abs());
            assert!(off < 1e-6 && (turned - turned.round()).abs() * TAU < 1e-6, "{call}: {value}, not {x} {y} {phi}");
        };
        close(odometry, moved([0.0; 3], *arc));
        truth = moved(truth, *arc);
        // After each drive the robot rests for more than a slot.
        let at = number(odometry, "t_s") + 0.05;
        let rested = events(&trace, "pose").filter(|pose| number(pose, "t_s") <= at).last();
        if let Some(rested) = rested {
            close(rested, truth);
        }
    }
}

#[test]
fn a_thousand_squares_end_where_they_began() {
    let program = "int main(void)\n{\n    int x, y, phi;\n    for (int i = 0; i < 4000; i++) {\n        VWStraight(500, 600); \
                   VWWait(); VWTurn(90, 300); VWWait();\n    }\n    VWGetPosition(&x, &y, &phi); IS(x, 0); IS(y, 0); \
                   IS(phi, 0); rest();\n    return 0;\n}\n";
    let scratch = scene(PLANE, "S4 20000 20000 30 mine.c\n", program);
    let (report, _) = run_until(&scratch, "12000");
    let robot = &report["robots"][0];
    assert!((number(robot, "pose.x_m") - 20.0).abs() < 1e-9 && (number(robot, "pose.y_m") - 20.0).abs() < 1e-9);
    assert!((number(robot, "pose.phi_rad") - PI / 6.0).abs() < 1e-9, "{robot:#}");
    assert!((number(robot, "path_m") - 2000.0).abs() < 1e-6, "{robot:#}");
}

#[test]
fn vwremain_is_0_only_when_the_drive_is_done() {
    let program = "static void follow(int whole)\n{\n    int left = VWRemain(), before = whole, count = 0;\n    \
                   CHECK(left > whole * 9 / 10 && left <= whole);\n    while ((left = VWRemain()) > 0) {\n        CHECK(left <= before); \
                   before = left; count++;\n    }\n    IS(VWDone(), 1); CHECK(count > 50); CHECK(before < 10);\n}\nint main(void)\n{\n    \
                   int v, w;\n    IS(VWDone(), 1); IS(VWRemain(), 0); IS(VWWait(), 0);\n    VWStraight(500, 200); follow(500);\n    \
                   VWStraight(-500, 200); follow(500);\n    VWTurn(-90, 60); follow(90);\n    VWCurve(400, 60, 200); follow(400);\n    \
                   VWTurn(3, 1); VWWait(); IS(VWSetSpeed(100, -45), 0); VWGetSpeed(&v, &w); IS(v, 100); IS(w, -45);\n    \
                   VWGetSpeed(NULL, &w); VWGetPosition(NULL, NULL, NULL); VWSetSpeed(5000, 0); VWGetSpeed(&v, &w); IS(v, 400);\n    \
                   VWSetSpeed(0, 0); return 0;\n}\n";
    run(&scene(PLANE, "S4 20000 20000 0 mine.c\n", program));
}

#[test]
fn impossible_drives_are_refused_and_explained() {
    let ran = messages(
        "int main(void)\n{\n    IS(VWStraight(0.3, 0.2), 1); IS(VWTurn(90, 0), 1); IS(VWCurve(0, 90, 100), 1); \
                        IS(VWDrive(100, 0, 0), 1);\n    IS(VWDone(), 1); IS(VWControl(70, 30, 70, 10), 0); \
                        IS(VWControl(70, 0, 70, 10), 1); IS(VWControlOff(), 0);\n    VWStraight(1, 1); VWWait(); for (int i = 0; i < 4; i++) { VWTurn(2, 1); VWWait(); \
                        VWStraight(1, 1); VWWait(); } \
                        VWStraight(300, 100); VWTurn(90, 90); VWWait();\n    return 0;\n}\n",
    );
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for part in [
        "`VWStraight` returned 1: its speed is 0: RoBIOS-7 takes whole mm/s",
        "`VWCurve` returned 1: a curve takes a length",
        "RoBIOS-7 takes millimetres, not metres",
        "RoBIOS-7 takes degrees, not radians",
        "write `VWWait()` above this line",
    ] {
        assert!(ran.stderr.contains(part), "{part}: {ran:#?}");
    }
}

#[test]
fn a_good_program_gets_no_hint() {
    let ran = messages(
        "int main(void)\n{\n    int d[360];\n    VWStraight(1000, 200); while (!VWDone()) { if (PSDGet(PSD_FRONT) < 2500) break; \
                        LIDARGet(d); }\n    for (int i = 0; i < 4; i++) { VWTurn(3, 3); VWWait(); } VWTurn(90, 60); VWWait(); \
                        VWSetSpeed(100, 10); rest(); VWSetSpeed(0, 0); return 0;\n}\n",
    );
    assert_eq!((ran.code, ran.stderr.contains("hint")), (Some(0), false), "{ran:#?}");
}

#[test]
fn a_wall_stalls_both_wheels() {
    let program = "int main(void)\n{\n    IS(VWStalled(), 0); VWStraight(5000, 600); IS(VWStalled(), 0);\n    \
                   while (PSDGet(1) > 34) ;\n    rest(); IS(VWStalled(), 3); IS(VWDone(), 0); CHECK(VWRemain() > 2000);\n    \
                   MOTORDrive(1, 0); IS(VWDone(), 1); IS(VWRemain(), 0); IS(VWStalled(), 2);\n    \
                   MOTORDrive(2, 0); IS(VWStalled(), 0); IS(VWStraight(-100, 100), 0); IS(VWWait(), 0); return 0;\n}\n";
    run(&scene(ROOM, "S4 1000 1000 0 mine.c\n", program));
}

#[test]
fn motors_and_encoders_count_to_the_tick() {
    let program = "int main(void)\n{\n    int v, w;\n    IS(ENCODERRead(1), 0); IS(MOTORSpeed(1, 1100), 0); IS(MOTORSpeed(2, 550), 0);\n    \
                   for (int i = 0; i < 100; i++) { ENCODERRead(1); ENCODERRead(2); }\n    CHECK(ENCODERRead(2) > 50); IS(ENCODERReset(2), 0); \
                   CHECK(ENCODERRead(2) < 2); CHECK(ENCODERRead(1) > 100);\n    IS(MOTORDrive(1, 50), 0); IS(MOTORDrive(2, 50), 0); VWGetSpeed(&v, &w); \
                   CHECK(v > 100 && w == 0);\n    IS(VWStraight(100, 100), 0); IS(VWWait(), 0); VWGetSpeed(&v, &w); IS(v, 0);\n    \
                   IS(MOTORDriveRaw(1, -127), 0); IS(MOTORDriveRaw(2, -127), 0); VWGetSpeed(&v, &w); CHECK(v < -100 && w == 0);\n    \
                   IS(MOTORPID(1, 10, 50, 0), 0); IS(MOTORPID(1, 256, 0, 0), 1); IS(MOTORPIDOff(1), 0);\n    \
                   IS(MOTORDrive(3, 1), 1); IS(MOTORDrive(0, 1), 1); IS(MOTORDrive(-5, 1), 1); IS(MOTORSpeed(5, 1), 1); IS(MOTORPID(4, 1, 1, 1), 1);\n    \
                   IS(ENCODERRead(3), 0); IS(ENCODERReset(7), 1); IS(SERVOSet(1, 0), 0); IS(SERVOSet(2, 255), 0); IS(SERVOSet(3, 0), 1);\n    \
                   IS(SERVOSet(1, 256), 1); IS(SERVORange(1, 55, 155), 0); IS(SERVOSet(1, 255), 0); IS(SERVOSetRaw(1, 255), 0);\n    \
                   MOTORDrive(1, 0); MOTORDrive(2, 0); return 0;\n}\n";
    let scratch = scene(PLANE, "S4 20000 20000 0 mine.c\n", program);
    let (_, trace) = run(&scratch);
    for (motor, encoder, speed) in [("MOTOR_LEFT", "QUAD_LEFT", 1100.0), ("MOTOR_RIGHT", "QUAD_RIGHT", 550.0)] {
        let start = events(&trace, "output").find(|line| line["device"] == motor).expect("a motor that is set");
        let readings = events(&trace, "reading").filter(|line| line["device"] == encoder);
        for reading in readings.filter(|line| number(line, "t_s") > number(start, "t_s")).take(100) {
            let turned = speed * (number(reading, "t_s") - number(start, "t_s"));
            assert_eq!(number(reading, "value"), (turned + 1e-6).floor(), "{reading}");
        }
    }
    let servo: Vec<f64> = events(&trace, "servo").map(|line| number(line, "position")).collect();
    assert_eq!(servo, [0.0, 255.0, 155.0, 255.0]);
}

#[test]
fn a_car_steers_by_its_servo_and_does_not_turn_on_the_spot() {
    let robi = "name Car\ndiameter 200\nspeed 1000\nturn 300\nwheel 100 3600 1000 100\n\
                drive ACKERMANN_DRIVE MOTOR_DRIVE QUAD_DRIVE SERVO_STEER\n";
    let program = "int main(void)\n{\n    int x, y, phi, v, w;\n    IS(VWTurn(90, 60), 1); IS(VWStraight(300, 300), 0); VWWait(); VWGetPosition(&x, &y, &phi); IS(x, 300);\n    \
                   IS(SERVOSet(1, 0), 0); IS(MOTORDrive(1, 20), 0); IS(MOTORDrive(2, 20), 1); VWGetSpeed(&v, &w); CHECK(v > 0 && w > 0);\n    \
                   SERVOSet(1, 255); VWGetSpeed(&v, &w); CHECK(v > 0 && w < 0); SERVOSet(1, 128); VWGetSpeed(&v, &w); IS(w, 0); MOTORDrive(1, 0); return 0;\n}\n";
    let scratch = scene(PLANE, "robi car.robi mine.c 20000 20000 0\n", program);
    scratch.write("car.robi", robi);
    run(&scratch);
}

#[test]
fn psds_answer_to_numbers_of_the_robi_or_to_names() {
    let program = "int main(void)\n{\n    IS(PSDGet(PSD_FRONT), 2940); IS(PSDGet(2), 2955); IS(PSDGet(3), 955); IS(PSDGet(PSD_BACK), 940);\n    \
                   IS(PSDGet(0), 0); IS(PSDGet(5), 0); IS(PSDGet(-1), 0); IS(PSDGetRaw(4), 22); IS(PSDGetRaw(9), 0);\n    \
                   VWTurn(180, 300); VWWait(); IS(PSDGet(1), 940); return 0;\n}\n";
    run(&scene(ROOM, "S4 1000 1000 0 mine.c\n", program));
    let robi = "name Bot\ndiameter 180\nspeed 600\nturn 300\npsd PSD_RIGHT -210 0 -45 0 -90\npsd PSD_FRONT -200 60 0 0 0\n\
                wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let program = "int main(void)\n{\n    int d[360];\n    IS(PSDGet(PSD_FRONT), 440); IS(PSDGet(PSD_LEFT), 0); IS(PSDGet(PSD_RIGHT), 9999); \
                   IS(MOTORDrive(2, 0), 0); IS(ENCODERRead(2), 0); IS(SERVOSet(1, 9), 1);\n    IS(LIDARGet(d), 1); LIDARSet(360, 0, 360); return 0;\n}\n";
    let scratch = scene(ROOM, "robi bot.robi mine.c 3500 1000 0\n", program);
    scratch.write("bot.robi", robi);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("`bot.robi` has no number 2, it has: 1 (PSD_FRONT), 3 (PSD_RIGHT)"), "{ran:#?}");
    assert!(ran.stderr.contains("has no laser scanner"), "{ran:#?}");
}

#[test]
fn scans_turn_with_the_robot() {
    let program = "static int d[65536];\nint main(void)\n{\n    IS(LIDARGet(NULL), 1); IS(LIDARGet(d), 0);\n    \
                   IS(d[0], 1500); IS(d[90], 1000); IS(d[180], 2500); IS(d[270], 3000);\n    VWTurn(-90, 90); VWWait(); IS(LIDARGet(d), 0); \
                   IS(d[180], 3000); IS(d[90], 2500);\n    LIDARSet(180, 0, 3); IS(LIDARGet(d), 0); IS(d[0], 2500); IS(d[1], 3000); IS(d[2], 1500);\n    \
                   d[3] = 7; LIDARSet(0, 0, 3); LIDARSet(90, 0, 0); LIDARSet(90, 0, 70000); LIDARSet(90, 91, 9); IS(LIDARGet(d), 0); IS(d[1], 3000); \
                   IS(d[3], 7);\n    LIDARSet(360, 0, 65536); IS(LIDARGet(d), 0); IS(d[32768], 3000);\n    \
                   LIDARSet(90, -45, 1); IS(LIDARGet(d), 0); IS(d[0], 141);\n    SIMSetRobot(0, 20000, 2000, 0, 0); LIDARSet(360, 0, 4); \
                   IS(LIDARGet(d), 0); IS(d[0], 9999); IS(d[2], 9999); return 0;\n}\n";
    let scratch = scene(ROOM, "S4 1000 1500 90 mine.c\n", program);
    let (_, trace) = run(&scratch);
    let first = events(&trace, "scan").next().expect("a scan");
    assert_eq!((number(first, "points"), number(first, "nearest_m")), (360.0, 1.0));
    assert!((number(first, "bearing_rad") - PI / 2.0).abs() < 1e-12, "{first}");
}

/// Writes a scene with two robots with programs, one without, a can and a stone.
fn scene_with_others(program: &str, second: &str) -> Scratch {
    let lines = "object stone.esObj\nS4 1000 1000 90 mine.c\nS4 3000 1000 0 second.c\nLabBot 3000 3000 180\n\
                 stone 500 3500 45\ncan 2000 2000 0\n";
    let scratch = scene(ROOM, lines, program);
    scratch.write("stone.esObj", "obj stone.obj\nname stone\nmass 9\ncollider cylinder 0 0 50 100 100 z\nfixed\n");
    scratch.write("second.c", &format!("{BEGIN}{second}"));
    scratch
}

const IDLE: &str = "int main(void) { rest(); return VWStalled(); }\n";

#[test]
fn objects_are_numbered_after_the_robots_in_robios7() {
    let program = "static void pose(void get(int, int *, int *, int *, int *), int id, int x, int y, int phi)\n{\n    int a = -1, b = -1, c = -1, d = -1;\n    \
                   get(id, &a, &b, &c, &d); IS(a, x); IS(b, y); IS(c, 0); IS(d, phi); get(id, NULL, NULL, NULL, NULL);\n}\n\
                   static void get_object(int id, int *x, int *y, int *z, int *phi) { SIMGetObject(id, x, y, z, phi); }\n\
                   int main(void)\n{\n    int x = 7, y = 7, phi = 7;\n    IS(SIMGetRobotCount(), 3); IS(SIMGetObjectCount(), 2);\n    pose(SIMGetRobot, 0, 1000, 1000, 90); \
                   pose(SIMGetRobot, 1, 1000, 1000, 90); pose(SIMGetRobot, 2, 3000, 1000, 0); pose(SIMGetRobot, 3, 3000, 3000, 180);\n    \
                   pose(get_object, 4, 500, 3500, 45); pose(get_object, 5, 2000, 2000, 0);\n    SIMGetRobot(4, &x, &y, NULL, &phi); \
                   SIMGetObject(3, &x, &y, &phi); SIMGetObject(6, &x, &y, NULL, &phi); SIMGetRobot(-1, &x, NULL, NULL, NULL); IS(x, 7); IS(y, 7); IS(phi, 7);\n    \
                   SIMGetPose(&x, &y, &phi); IS(x, 1000); IS(phi, 90); SIMSetObject(4, 1, 1, 0, 0); rest(); pose(get_object, 4, 500, 3500, 45); return 0;\n}\n";
    let ran = scene_with_others(program, IDLE).eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("there is no robot 4, accepted: 0 for the robot itself, 1 to 3"), "{ran:#?}");
    assert!(
        ran.stderr.contains("there is no object 3: the objects' numbers follow those of the robots, here from 4 to 5"),
        "{ran:#?}"
    );
    assert!(ran.stderr.contains("object 4 is fixed"), "{ran:#?}");
}

#[test]
fn programs_place_robots_and_objects() {
    let program = "int main(void)\n{\n    int x, y, phi;\n    VWStraight(300, 300); VWWait(); SIMSetRobot(0, 500, 600, 0, -90); SIMGetRobot(0, &x, &y, NULL, &phi); \
                   IS(x, 500); IS(y, 600); IS(phi, -90);\n    VWGetPosition(&x, &y, &phi); IS(x, 300); IS(phi, 0); IS(PSDGet(1), 540);\n    \
                   VWStraight(-300, 300); VWWait(); SIMGetRobot(1, &x, &y, NULL, &phi); IS(y, 900);\n    \
                   SIMSetRobot(2, 3500, 2500, 0, 0); SIMSetRobot(2, 3500, 2500, 0, 180); SIMSetRobot(3, 2500, 3500, 0, 270); \
                   SIMSetObject(5, 1500, 600, 0, 30);\n    SIMGetRobot(2, &x, &y, NULL, &phi); IS(x, 3000); rest(); SIMGetRobot(2, &x, &y, NULL, &phi); IS(x, 3500); IS(y, 2500); \
                   IS(phi, 180);\n    SIMGetRobot(3, &x, &y, NULL, &phi); IS(x, 2500); IS(phi, -90); SIMGetObject(5, &x, &y, NULL, &phi); IS(x, 1500); IS(y, 600); IS(phi, 30);\n    \
                   VWTurn(90, 90); VWWait(); rest(); return 0;\n}\n";
    // The second robot waits for the end of a drive. The drive ends when the robot is moved.
    let second = "int main(void)\n{\n    int x, y, phi;\n    VWTurn(30000, 1); VWWait(); SIMGetRobot(0, &x, &y, NULL, &phi); IS(x, 3500); IS(phi, 180); IS(VWDone(), 1); \
                  return 0;\n}\n";
    let scratch = scene_with_others(program, second);
    let (report, trace) = run(&scratch);
    assert_eq!(number(&report["robots"][2], "pose.x_m"), 2.5);
    assert!(number(&report, "sim_time_s") < 20.0, "nobody waits for a drive that is over");
    let placements: Vec<_> = events(&trace, "placed").map(|line| (number(line, "robot"), number(line, "by"))).collect();
    assert_eq!(placements, [(1.0, 1.0), (2.0, 1.0), (2.0, 1.0), (3.0, 1.0)]);
    assert_eq!(events(&trace, "object_placed").count(), 1);
    let ran = scratch.eyesim(&["run", "scene.sim", "--plot", "run.svg"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let lines = scratch.read("run.svg").matches("<polyline").count();
    assert!(lines >= 4, "a line before and after the jump, {lines}");
}

#[test]
fn of_simultaneous_placements_that_of_the_higher_robot_number_takes_effect() {
    let program = |y: i32| {
        format!(
            "int main(void)\n{{\n    for (int i = 0; i < 40; i++) {{ SIMSetRobot(3, 1000 + 20 * i, {y}, 0, i); SIMSetObject(5, 2000, {y}, 0, 0); }}\n    rest(); return 0;\n}}\n"
        )
    };
    let scratch = scene_with_others(&program(2500), &program(3500));
    let digest = |threads: &str| {
        scratch.report("scene.sim", &["--threads", threads], 0)["digest"].as_str().expect("a digest").to_owned()
    };
    let first = digest("1");
    assert!((0..3).all(|_| digest("2") == first));
    let report = scratch.report("scene.sim", &[], 0);
    assert_eq!(number(&report["robots"][2], "pose.y_m"), 3.5, "at the same time that of the higher number");
}
