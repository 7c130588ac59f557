//! Scenes in every dialect, written as users write them, with programs: a robot arrives at the place that geometry
//! gives, and equal scenes in two dialects give equal runs.

#![allow(clippy::disallowed_methods, reason = "geometry by hand, compared within a millimetre")]

use std::f64::consts::{FRAC_PI_2, PI};

use serde_json::Value;
use tests::{Scratch, number};

/// A room of 4 m by 3 m.
const ROOM: &str = "floor 4000 3000\n0 0 4000 0\n4000 0 4000 3000\n4000 3000 0 3000\n0 3000 0 0\n";

/// Drives 300 mm ahead, turns left by 90 degrees, and drives 200 mm ahead.
const HOOK: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 0.3, 0.2); VWDriveWait(vw);
    VWDriveTurn(vw, 1.5707963268, 1.0); VWDriveWait(vw);
    VWDriveStraight(vw, 0.2, 0.2); VWDriveWait(vw);
    return 0;
}
"#;

/// Shows the readings of the four PSD sensors at the start.
const LOOK: &str = r#"
#include "eyebot.h"
int main(void) {
    static const DeviceSemantics names[] = { PSD_FRONT, PSD_LEFT, PSD_RIGHT, PSD_BACK };
    PSDHandle psd[4], all = 0;
    int i;
    for (i = 0; i < 4; i++) all |= psd[i] = PSDInit(names[i]);
    PSDStart(all, TRUE);
    OSWait(10);
    for (i = 0; i < 4; i++) if (psd[i]) LCDSetPrintf(i, 0, "%d", PSDGet(psd[i]));
    return 0;
}
"#;

/// Drives at random for 30 s and uses all devices of the robot.
const WANDER: &str = r#"
#include <stdlib.h>
#include "eyebot.h"
int main(void) {
    PSDHandle front = PSDInit(PSD_FRONT), left = PSDInit(PSD_LEFT), right = PSDInit(PSD_RIGHT);
    QuadHandle wheels[2] = { QUADInit(QUAD_LEFT), QUADInit(QUAD_RIGHT) };
    VWHandle vw = VWInit(VW_DRIVE, 1);
    if (!front || !left || !right || !wheels[0] || !wheels[1] || !vw) return 1;
    PSDStart(front | left | right, TRUE);
    while (OSGetCount() < 3000) {
        if (PSDGet(front) < 250) {
            double angle = 0.5 + 2.0 * rand() / RAND_MAX;
            VWDriveTurn(vw, PSDGet(left) < PSDGet(right) ? -angle : angle, 1.5);
            VWDriveWait(vw);
        } else {
            VWSetSpeed(vw, 0.25, 0.4 - 0.8 * rand() / RAND_MAX);
        }
        OSWait(10);
        LCDSetPrintf(0, 0, "%d %d %s", QUADRead(wheels[0]), QUADRead(wheels[1]), OSMachineName());
    }
    return 0;
}
"#;

/// A robot in the classic format; its axle is 10 mm ahead of the centre.
const CLASSIC: &str = "name Twin\ndiameter 186\nspeed 600\nturn 300\naxis 10\npsd PSD_FRONT 1 60 20 30 0\n\
    psd PSD_LEFT 2 56 45 30 90\npsd PSD_RIGHT 3 56 -45 30 -90\npsd PSD_BACK 4 -60 0 30 180\nwheel 54 3600 1100 90\n\
    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// The same robot in the format of EyeSim VR: the body is its collider, the track is half the wheel distance, motors
/// have no names.
const VR: &str = "drive DIFFERENTIAL_DRIVE\nname Twin\nmass 3 0 20 0\ncollider sphere 93 0 93 0\naxis 27 10\n\
    psd PSD_FRONT 1 60 20 30 0\npsd PSD_LEFT 2 56 45 30 90\npsd PSD_RIGHT 3 56 -45 30 -90\n\
    psd PSD_BACK 4 -60 0 30 180\nwheel 54 3600 1100 45\n";

/// The same robot in the format of 2022: the id is before the name, and there are three angles.
const VR_2022: &str = "drive DIFFERENTIAL_DRIVE\nname Twin\nmass 3 0 20 0\ncollider sphere 93 0 93 0\naxis 27 10\n\
    psd 1 PSD_FRONT 60 20 30 0 0 0\npsd 2 PSD_LEFT 56 45 30 0 90 0\npsd 3 PSD_RIGHT 56 -45 30 0 -90 0\n\
    psd 4 PSD_BACK -60 0 30 0 180 0\nwheel 54 3600 1100 45\n";

/// Creates a folder with the programs, the robots and the room.
fn scratch() -> Scratch {
    let scratch = Scratch::new();
    let files = [("hook.c", HOOK), ("look.c", LOOK), ("wander.c", WANDER), ("room.wld", ROOM)];
    let robots = [("classic.robi", CLASSIC), ("vr.robi", VR), ("vr2022.robi", VR_2022)];
    for (name, text) in files.into_iter().chain(robots) {
        scratch.write(name, text);
    }
    scratch
}

/// Runs `sim`, which must succeed, and returns the robots of the report.
fn run(scratch: &Scratch, sim: &str) -> Vec<Value> {
    scratch.write("scene.sim", sim);
    let report = scratch.report("scene.sim", &[], 0);
    report["robots"].as_array().expect("robots").clone()
}

/// The digest of a run of `sim`.
fn digest(scratch: &Scratch, sim: &str) -> String {
    scratch.write("scene.sim", sim);
    let report = scratch.report("scene.sim", &[], 0);
    assert!(number(&report["robots"][0], "path_m") > 1.0, "it moves: {report:#}");
    report["digest"].as_str().expect("a digest").to_owned()
}

/// Asserts that a robot is within 1 mm of (x, y) in millimetres and within 0.1 degrees of the heading.
fn assert_at(robot: &Value, x_mm: f64, y_mm: f64, phi_deg: f64) {
    let (x, y) = (number(robot, "pose.x_m") * 1000.0, number(robot, "pose.y_m") * 1000.0);
    assert!((x - x_mm).hypot(y - y_mm) < 1.0, "at ({x}, {y}), not at ({x_mm}, {y_mm}): {robot:#}");
    let turn = (number(robot, "pose.phi_rad").to_degrees() - phi_deg).rem_euclid(360.0);
    assert!(turn.min(360.0 - turn) < 0.1, "heading off by {turn} degrees: {robot:#}");
}

/// End of [`HOOK`] for a robot that starts at (x, y) in mm, with its axle `axle_mm` ahead of its centre.
fn end_of_hook(x: f64, y: f64, phi_deg: f64, axle_mm: f64) -> (f64, f64, f64) {
    let (sin, cos) = phi_deg.to_radians().sin_cos();
    // The robot turns about the midpoint of its axle. So the axle ends `ahead` and `left` of the start.
    let (ahead, left) = (300.0 + axle_mm, 200.0 - axle_mm);
    (x + ahead * cos - left * sin, y + ahead * sin + left * cos, phi_deg + 90.0)
}

/// Reading shown by [`LOOK`] in `row`.
fn reading(robot: &Value, row: usize) -> f64 {
    let text = robot["lcd"][row].as_str().expect("a line").trim();
    text.parse().unwrap_or_else(|_| panic!("`{text}` in {robot:#}"))
}

#[test]
fn names_of_eyesim_vr_place_robots() {
    let scratch = scratch();
    let robots = run(
        &scratch,
        "# EyeSim VR, both spellings of what loads a type\nworld room.wld\nsettings VIS trace\nrobi vr.robi\n\
         robot \"classic.robi\"\n\ns4 600 600 0 hook.c\nLabBot 1400 600 90 hook.c\nTwin 2400 600 30 hook.c\n\
         S4 2000 2000 45\nmarker 2000 1500 255 0 0\n",
    );
    let names: Vec<_> = robots.iter().map(|robot| robot["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["S4", "LabBot", "Twin", "S4"]);
    for (robot, (x, y, phi_deg)) in robots.iter().zip([
        end_of_hook(600.0, 600.0, 0.0, 0.0),
        // Axle position of LabBot in EyeSim VR.
        end_of_hook(1400.0, 600.0, 90.0, 10.8),
        end_of_hook(2400.0, 600.0, 30.0, 10.0),
        (2000.0, 2000.0, 45.0),
    ]) {
        assert_at(robot, x, y, phi_deg);
    }
    let outcomes: Vec<_> = robots.iter().map(|robot| robot["outcome"].as_str().expect("an outcome")).collect();
    assert_eq!(outcomes, ["finished", "finished", "finished", "no_program"]);
}

#[test]
fn a_scene_without_programs_says_so_and_takes_them_from_the_command_line() {
    let scratch = scratch();
    scratch.write("scene.sim", "world room.wld\nS4 1000 1000 0\nS4 2000 2000 0\n");
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("no robot has a program"), "{ran:#?}");
    assert!(ran.stdout.contains("2 robots: 2 no program\nsimulated 0.000 s in "), "{ran:#?}");
    assert!(!ran.stdout.contains("times real time"), "{ran:#?}");
    let report = scratch.report("scene.sim", &["--program", "2=hook.c"], 0);
    assert_at(&report["robots"][0], 1000.0, 1000.0, 0.0);
    assert_at(&report["robots"][1], 2300.0, 2200.0, 90.0);
    let report = scratch.report("scene.sim", &["--program", "hook.c"], 0);
    assert_at(&report["robots"][0], 1300.0, 1200.0, 90.0);
    assert_eq!(report["robots"][0]["program"], "hook.c");
}

#[test]
fn programs_of_eyesim_vr_are_found_by_their_source() {
    let scratch = scratch();
    // The magic number of a Mach-O file for Apple processors.
    std::fs::write(scratch.path().join("hook.x"), b"\xcf\xfa\xed\xfe\x0c\0\0\x01").expect("a file");
    let robots = run(&scratch, "world room.wld\nS4 600 600 0 hook.x\nS4 600 1600 0 hook.exe\nS4 2000 600 0 hook.dll\n");
    assert_at(&robots[0], 900.0, 800.0, 90.0);
    assert_at(&robots[1], 900.0, 1800.0, 90.0);
    assert_at(&robots[2], 2300.0, 800.0, 90.0);
}

/// A maze with cells of 500 mm. The `s` is in the highest of four rows. The `R`, with a wall below, is in the second
/// row from below.
const MAZE: &str = " _____\n|s    |\n| |_  |\n|  R  |\n|_____|\n500\n";

/// Drives two cells ahead and shows the reading of the front sensor.
const TWO_CELLS: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PSDHandle front = PSDInit(PSD_FRONT);
    PSDStart(front, TRUE);
    VWDriveStraight(vw, 1.0, 0.3); VWDriveWait(vw);
    OSWait(10);
    LCDSetPrintf(0, 0, "%d", PSDGet(front));
    return 0;
}
"#;

#[test]
fn a_start_letter_chooses_the_cell_and_the_angle_the_heading() {
    let scratch = scratch();
    scratch.write("maze.maz", MAZE);
    scratch.write("two.c", TWO_CELLS);
    let robots = run(&scratch, "world maze.maz\nS4 R look.c\nS4 S 0 two.c\n");
    assert_at(&robots[0], 750.0, 750.0, 0.0);
    assert_at(&robots[1], 1250.0, 1750.0, 0.0);
    assert_eq!(reading(&robots[1], 0), 1500.0 - 1250.0 - 60.0, "the sensor is 60 mm ahead of the centre");
    let robots = run(&scratch, "world maze.maz\nLabBot s look.c\nS4 r 180\n");
    assert_at(&robots[0], 250.0, 1750.0, 90.0);
    assert_eq!(robots[1]["outcome"], "no_program");
    assert_at(&robots[1], 750.0, 750.0, 180.0);
}

#[test]
fn classic_robots_take_the_starts_of_maze_and_world_in_order() {
    let scratch = scratch();
    scratch.write("maze.maz", " _____\n|  r  |\n|u   l|\n|_____|\n500\n");
    let robots =
        run(&scratch, "maze maze.maz\nrobi classic.robi look.c\nrobi classic.robi look.c\nrobi vr.robi look.c\n");
    assert_at(&robots[0], 750.0, 1250.0, 0.0);
    assert_at(&robots[1], 250.0, 750.0, 90.0);
    assert_at(&robots[2], 1250.0, 750.0, 180.0);

    // The frame is turned clockwise by 90 degrees: its x axis points down, its y axis to the right. Headings turn
    // clockwise.
    let world = "floor 3000 2000\n0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\nposition 500 500 0\n\
                 push 1500 1500 90\nposition 700 400 90\n-400 900 600 900 20 150\npop\n";
    scratch.write("frames.wld", world);
    let robots = run(&scratch, "world frames.wld\nrobi classic.robi look.c\nrobi classic.robi look.c\n");
    assert_at(&robots[0], 500.0, 500.0, 0.0);
    assert_at(&robots[1], 1900.0, 800.0, 0.0);
    // The wall is at x = 2400, 20 mm thick, from y = 900 to 1900. The second robot is at y = 800, so its ray passes the
    // wall and it reads the end of its range.
    assert_eq!(reading(&robots[1], 0), 9999.0);
    let robots = run(&scratch, "world frames.wld\nrobi classic.robi look.c 2000 1000 0\n");
    assert_eq!(reading(&robots[0], 0), 400.0 - 10.0 - 60.0);
}

#[test]
fn robots_touch_thick_walls_at_half_their_thickness() {
    let scratch = scratch();
    let walls = "2000 500 2000 1500 100 200\n2000 2000 2000 2800 40 200 255 0 0\n";
    scratch.write("thick.wld", &(ROOM.to_owned() + walls));
    scratch.write(
        "ram.c",
        "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 2, 0.3);\n\
         while (!VWStalled(vw)) OSWait(1); return 0; }\n",
    );
    let robots = run(&scratch, "world thick.wld\nS4 1500 1000 0 ram.c\nS4 1500 2400 0 ram.c\nS4 3000 500 -90 ram.c\n");
    assert_at(&robots[0], 2000.0 - 50.0 - 93.0, 1000.0, 0.0);
    assert_at(&robots[1], 2000.0 - 20.0 - 93.0, 2400.0, 0.0);
    assert_at(&robots[2], 3000.0, 93.0, -90.0);
}

#[test]
fn the_sensors_of_every_dialect_point_in_the_documented_directions() {
    let scratch = scratch();
    for robi in ["classic", "vr", "vr2022"] {
        scratch.write(&format!("{robi}.toml"), "[psd]\nrange_mm = 5000\n");
        let robots = run(&scratch, &format!("world room.wld\nrobi {robi}.robi look.c 1000 2000 0\n"));
        let readings: Vec<f64> = (0..4).map(|row| reading(&robots[0], row)).collect();
        assert_eq!(readings, [2940.0, 955.0, 1955.0, 940.0], "{robi}");
    }
}

/// Turns on the spot by the motors alone for a second, then by VW for a quarter turn, and shows the motion of the
/// wheels.
const TURN: &str = r#"
#include "eyebot.h"
int main(void) {
    MotorHandle left = MOTORInit(MOTOR_LEFT), right = MOTORInit(MOTOR_RIGHT);
    QuadHandle wheel = QUADInit(QUAD_RIGHT);
    VWHandle vw;
    MOTORDrive(left, -2); MOTORDrive(right, 2);
    OSWait(100);
    MOTORDrive(left | right, 0);
    LCDSetPrintf(0, 0, "%d", QUADRead(wheel));
    MOTORRelease(left | right);
    if (OSMachineID() == 2) return 0;
    vw = VWInit(VW_DRIVE, 1);
    QUADReset(wheel);
    VWDriveTurn(vw, 1.5707963268, 1.0); VWDriveWait(vw);
    LCDSetPrintf(1, 0, "%d", QUADRead(wheel));
    return 0;
}
"#;

#[test]
fn the_track_of_eyesim_vr_is_half_the_wheel_distance() {
    // Wheels of 54 mm diameter, 90 mm apart. For one second: 2 % of 3600 degrees/s; in EyeSim VR 2 % of 0.4 m/s at the
    // rim.
    let classic = 72_f64.to_radians();
    let vr = 0.008 / 0.027;
    for (robi, wheel) in [("classic", classic), ("vr", vr), ("vr2022", vr)] {
        let turn = 2.0 * wheel * 27.0 / 90.0;
        let scratch = scratch();
        scratch.write("turn.c", TURN);
        let sim = format!("world room.wld\nrobi {robi}.robi turn.c 1000 1000 0\nrobi {robi}.robi turn.c 2000 1000 0\n");
        let robots = run(&scratch, &sim);
        // The two motors start some calls apart, which causes at most 0.1 degrees.
        let (by_vw, by_motors) = (number(&robots[0], "pose.phi_rad"), number(&robots[1], "pose.phi_rad"));
        assert!((by_motors - turn).to_degrees().abs() < 0.1, "{robi}: {by_motors} instead of {turn}");
        assert!((by_vw - turn - FRAC_PI_2).to_degrees().abs() < 0.1, "{robi}: {by_vw}");
        // Counts of the right encoder, 1100 per turn of the wheel.
        assert!((reading(&robots[1], 0) - 1100.0 * wheel / (2.0 * PI)).abs() <= 1.0, "{robi}: {:#}", robots[1]);
        let quarter = (45.0 * FRAC_PI_2) / (54.0 * PI) * 1100.0;
        assert!((reading(&robots[0], 1) - quarter).abs() <= 1.0, "{robi}, {quarter}: {:#}", robots[0]);
    }
}

#[test]
fn one_robot_behaves_bit_identically_in_three_dialects() {
    let scratch = scratch();
    // Robot files of EyeSim VR give PSDs this range.
    scratch.write("classic.toml", "[psd]\nrange_mm = 9999\n");
    let classic = |robi: &str| format!("world room.wld\nrobi {robi}.robi wander.c 800 900 20\n");
    let vr = |robi: &str| format!("world room.wld\nrobi {robi}.robi\nTwin 800 900 20 wander.c\n");
    let first = digest(&scratch, &classic("classic"));
    for robi in ["classic", "vr", "vr2022"] {
        assert_eq!(digest(&scratch, &classic(robi)), first, "{robi}");
        assert_eq!(digest(&scratch, &vr(robi)), first, "{robi} in a sim file of EyeSim VR");
    }
    // Control: the digest must change if the robot does.
    scratch.write("vr.robi", &VR.replace("1100 45", "1100 45.001"));
    assert_ne!(digest(&scratch, &classic("vr")), first, "a thousandth of a millimetre");
}

#[test]
fn settings_for_the_window_do_not_change_the_digest() {
    let scratch = scratch();
    let scene = "S4 800 900 20 wander.c\n";
    let first = digest(&scratch, &format!("world room.wld\n{scene}"));
    let shown = "settings VIS TRACE\nmarker 900 900\nmarker 1000 900 0 255 0\nmarker 1100 900 0 255 0 128\n";
    assert_eq!(digest(&scratch, &format!("world room.wld\n{shown}{scene}")), first);
    scratch.write("room.png", "no image");
    scratch.write("room.wld", &format!("{ROOM}floor_texture room.png\n"));
    assert_eq!(digest(&scratch, &format!("world room.wld\n{scene}")), first);
}

/// A fixed post: 120 mm wide (X to the right), 300 mm high, 60 mm deep (Z forward).
const POST: &str = "name Post\nmass 5 0 0 0\ncollider box 0 150 0 120 300 60\nfixed\n";

#[test]
fn objects_of_every_dialect_stand_where_they_are_placed() {
    let scratch = scratch();
    scratch.write("things/post.esObj", POST);
    // Objects around the S4: a crate of 200 mm, a can of 66 mm, the post, and a ball of 100 mm in the classic format.
    let objects = "object things/post.esObj\ncrate 1500 1020 0\ncan 1056 1500 0\nPost 1056 500 0\n\
                   object 500 1000 0 0.3 ball.ms3d\n";
    let around = [1400.0 - 1060.0, 1500.0 - 33.0 - 1045.0, 955.0 - 500.0 - 60.0, 940.0 - 550.0];
    let readings = |robots: &[Value]| -> Vec<f64> { (0..4).map(|row| reading(&robots[0], row)).collect() };
    let robots = run(&scratch, &format!("world room.wld\n{objects}S4 1000 1000 0 look.c\n"));
    assert_eq!(readings(&robots), around);
    // After a quarter turn the post's narrow side faces the robot.
    let turned = objects.replace("Post 1056 500 0", "Post 1056 500 90");
    let robots = run(&scratch, &format!("world room.wld\n{turned}S4 1000 1000 0 look.c\n"));
    assert_eq!(readings(&robots)[2], 955.0 - 500.0 - 30.0);
    // A maze file contains a ball and a box as letters.
    scratch.write("field.maz", " _______\n|o     x|\n|_______|\n720\n");
    let robots = run(&scratch, "world field.maz\nS4 1440 1080 180 look.c\n");
    assert_eq!(reading(&robots[0], 0), 1440.0 - 60.0 - 360.0 - (50.0_f64.powi(2) - 20.0_f64.powi(2)).sqrt().round());
    assert_eq!(reading(&robots[0], 3), 2520.0 - 100.0 - 1500.0);
}

/// Drives 1 m ahead, against an obstacle.
const RAM: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 1.0, 0.2);
    OSWait(600);
    return 0;
}
"#;

#[test]
fn a_robot_pushes_a_can_and_stops_at_a_post() {
    let scratch = scratch();
    scratch.write("post.esObj", POST);
    scratch.write("ram.c", RAM);
    scratch.write(
        "scene.sim",
        "world room.wld\nobject post.esObj\nS4 600 600 0 ram.c\ncan 1000 600 0\nS4 600 1600 0 ram.c\nPost 1200 1600 0\n",
    );
    let report = scratch.report("scene.sim", &[], 0);
    let (pushes, stopped) = (&report["robots"][0], &report["robots"][1]);
    assert_at(pushes, 1600.0, 600.0, 0.0);
    assert_at(stopped, 1200.0 - 30.0 - 93.0, 1600.0, 0.0);
    let can = &report["objects"][0];
    assert_eq!(report["objects"].as_array().map(Vec::len), Some(1), "the post is a part of the world: {report:#}");
    // The can is in front of the robot, or a little ahead if it slid on.
    let ahead = number(can, "pose.x_m") * 1000.0 - (1600.0 + 93.0 + 33.0);
    assert!((-1.0..20.0).contains(&ahead), "{ahead} mm: {can:#}");
}

/// Shows the arguments of `main`.
const ECHO: &str = r#"
#include "eyebot.h"
int main(int argc, char **argv) {
    int i;
    for (i = 0; i < argc; i++) LCDPrintf("%s|", argv[i]);
    return 0;
}
"#;

#[test]
fn toml_scenes_pass_arguments_to_programs() {
    let scratch = scratch();
    scratch.write("echo.c", ECHO);
    scratch.write(
        "scene.scene.toml",
        "[world]\nfile = \"room.wld\"\n\n\
         [[robot]]\ntype = \"vr.robi\"\nprogram = \"hook.c\"\nx_mm = 600\ny_mm = 600\nheading_deg = 90\n\n\
         [[robot]]\ntype = \"S4\"\nprogram = \"echo.c\"\narguments = [\"-k\", \"0 5\"]\ncount = 2\n\
         layout = { kind = \"line\", from_mm = [1500, 2000], to_mm = [2000, 2000] }\n\n\
         [[robot]]\ntype = \"LabBot\"\nx_mm = 3000\ny_mm = 600\n\n\
         [[robot]]\ntype = \"S4\"\nprogram = \"%sim%/example-programs/square\"\narguments = [\"0.1\"]\n\
         x_mm = 3000\ny_mm = 2000\n",
    );
    let run = |args: &[&str]| {
        let report = scratch.report("scene.scene.toml", args, 0);
        report["robots"].as_array().expect("robots").clone()
    };
    let lcd_line = |robot: &Value| robot["lcd"][0].as_str().expect("a line").trim_end().to_owned();
    let robots = run(&[]);
    let (x, y, phi_deg) = end_of_hook(600.0, 600.0, 90.0, 10.0);
    assert_at(&robots[0], x, y, phi_deg);
    assert_eq!([lcd_line(&robots[1]), lcd_line(&robots[2])], ["echo|-k|0 5|", "echo|-k|0 5|"]);
    assert_at(&robots[1], 1500.0, 2000.0, 0.0);
    assert_at(&robots[2], 2000.0, 2000.0, 0.0);
    assert_eq!(robots[3]["outcome"], "no_program");
    // The Rust program drives a square with this side.
    assert!((number(&robots[4], "path_m") - 0.4).abs() < 1e-6, "{:#}", robots[4]);

    let robots = run(&["--args", "3:other", "--args", "5:0.2", "--program", "4=echo.c"]);
    assert_eq!([lcd_line(&robots[1]), lcd_line(&robots[2])], ["echo|-k|0 5|", "echo|other|"]);
    assert_eq!(lcd_line(&robots[3]), "echo|");
    assert!((number(&robots[4], "path_m") - 0.8).abs() < 1e-6, "{:#}", robots[4]);
}

#[test]
fn one_robot_behaves_bit_identically_in_a_toml_scene() {
    let scratch = scratch();
    // Robot files of EyeSim VR give PSDs this range.
    scratch.write("classic.toml", "[psd]\nrange_mm = 9999\n");
    let first = digest(&scratch, "world room.wld\nrobi classic.robi wander.c 800 900 20\n");
    for robi in ["classic", "vr", "vr2022"] {
        scratch.write(
            "own.scene.toml",
            &format!(
                "[world]\nfile = \"room.wld\"\n[[robot]]\ntype = \"{robi}.robi\"\nprogram = \"wander.c\"\n\
                 x_mm = 800\ny_mm = 900\nheading_deg = 20\n"
            ),
        );
        assert_eq!(scratch.report("own.scene.toml", &[], 0)["digest"], first, "{robi}");
    }
}

#[test]
fn each_line_determines_its_dialect_and_dialects_can_be_mixed() {
    let scratch = scratch();
    let robots = run(
        &scratch,
        "world room.wld\r\nrobi vr.robi\r\nrobi classic.robi hook.c 600 600 0\r\nTwin 600 1600 0 hook.c\r\n\
         S4\t2000   600 0 hook.c",
    );
    assert_eq!(robots.len(), 3);
    for (robot, (x, y)) in robots.iter().zip([(600.0, 600.0), (600.0, 1600.0), (2000.0, 600.0)]) {
        let axle = if robot["name"] == "S4" { 0.0 } else { 10.0 };
        let (x, y, phi_deg) = end_of_hook(x, y, 0.0, axle);
        assert_at(robot, x, y, phi_deg);
    }
}

/// Program that prints the heading, sets it to `phi` by SIMSetRobot, and prints it again.
fn turner(phi: i32) -> String {
    format!(
        "#include \"eyebot.h\"\nint main() {{\n    int x, y, z, phi;\n    SIMGetRobot(0, &x, &y, &z, &phi);\n    \
         LCDPrintf(\"%d\\n\", phi);\n    SIMSetRobot(0, 1000, 500, 0, {phi});\n    SIMGetRobot(0, &x, &y, &z, &phi);\n    \
         LCDPrintf(\"%d %d %d\\n\", x, y, phi);\n    VWStraight(300, 100);\n    VWWait();\n    return 0;\n}}\n"
    )
}

#[test]
fn heading_0_is_along_y_in_2018_and_along_x_today() {
    let scratch = Scratch::new();
    scratch.write("room.wld", ROOM);
    let reported = |scene: &str, args: &[&str]| {
        let robot = scratch.report(scene, args, 0)["robots"][0].clone();
        let lcd = |row: usize| robot["lcd"][row].as_str().expect("text").trim_end().to_owned();
        let end = ["x_m", "y_m"].map(|key| (number(&robot["pose"], key) * 1000.0).round());
        (lcd(0), lcd(1), end)
    };
    // According to the source of 2018, the returned heading is 360 - (90 - heading), and the set one is 90 - heading.
    let of_2018 = |first: &str, second: &str, end| (first.to_owned(), second.to_owned(), end);
    scratch.write("turn.c", &turner(0));
    scratch.write("a.sim", "world room.wld\nS4 500 500 0 turn.x\n");
    assert_eq!(reported("a.sim", &[]), of_2018("0", "1000 500 0", [1300.0, 500.0]));
    assert_eq!(reported("a.sim", &["--dialect", "vr2023"]), of_2018("0", "1000 500 0", [1300.0, 500.0]));
    assert_eq!(reported("a.sim", &["--dialect", "vr2018"]), of_2018("270", "1000 500 360", [1000.0, 800.0]));
    scratch.write("turn.c", &turner(90));
    assert_eq!(
        reported("a.sim", &["--dialect", "vr2018"]),
        of_2018("270", "1000 500 270", [1300.0, 500.0]),
        "clockwise"
    );
    scratch.write("turn.c", &turner(-45));
    let (_, reported_again, [x, y]) = reported("a.sim", &["--dialect", "vr2018"]);
    assert_eq!((reported_again.as_str(), x, y), ("1000 500 45", 788.0, 712.0));
    // The dialect also follows from a setting of the scene, or from a file that only EyeSim VR of 2018 supports.
    scratch.write("turn.c", &turner(0));
    let robot = "[[robot]]\ntype = \"S4\"\nprogram = \"turn.c\"\nx_mm = 500\ny_mm = 500\n";
    scratch.write("b.scene.toml", &format!("[scene]\ndialect = \"vr2018\"\n[world]\nfile = \"room.wld\"\n{robot}"));
    assert_eq!(reported("b.scene.toml", &[]).1, "1000 500 360");
    assert_eq!(reported("b.scene.toml", &["--dialect", "vr2023"]).1, "1000 500 0");
    scratch.write("tin.esObj", "name Tin\nobj tin.obj\nscale 1\nmass 1 0 0 0\ncapsule 0 50 0 30 100 y\n");
    scratch.write("c.sim", "world room.wld\nobj tin.esObj\nS4 500 500 0 turn.x\n");
    assert_eq!(reported("c.sim", &[]).1, "1000 500 360");
    let ran = scratch.eyesim(&["run", "c.sim"]);
    assert!(ran.stderr.contains("--dialect=vr2018 is used, --dialect=vr2023 selects today's conventions"), "{ran:#?}");
    assert_eq!(reported("c.sim", &["--dialect", "vr2023"]).1, "1000 500 0");
    let refused = scratch.eyesim(&["run", "c.sim", "--dialect", "vr2020"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("expected vr2018, vr2023 or classic"), "{refused:#?}");
}

/// Drives one cell of 360 mm and prints the reading of the front sensor.
const STEP: &str =
    "#include \"eyebot.h\"\nint main() { VWStraight(360, 200); VWWait(); LCDPrintf(\"%d\", PSDGet(1)); return 0; }\n";

#[test]
fn file_options_and_dialect_set_the_cell_size_of_a_maze() {
    let scratch = Scratch::new();
    scratch.write("step.c", STEP);
    scratch.write("m.maz", "720\n _____\n|   S |\n| |_| |\n|U____|\n");
    scratch.write("a.sim", "world m.maz\nS4 U 0 step.x\n");
    let x_of = |scene: &str, args: &[&str]| {
        let robot = scratch.report(scene, args, 0)["robots"][0].clone();
        (number(&robot, "pose.x_m") * 1000.0).round() - 360.0
    };
    assert_eq!(x_of("a.sim", &[]), 360.0, "half a cell of 720 mm");
    let ran = scratch.eyesim(&["run", "a.sim"]);
    assert!(ran.stderr.contains("maz-cell-first"), "{ran:#?}");
    assert_eq!(x_of("a.sim", &["--maze-cell", "360"]), 180.0);
    assert_eq!(x_of("a.sim", &["--maze-cell", "1000"]), 500.0);
    for args in [&["--dialect", "vr2023"], &["--maze-cell", "360"]] {
        let ran = scratch.eyesim(&[&["run", "a.sim", "--strict"][..], args].concat());
        assert_eq!(ran.code, Some(0), "the option sets the size, so there is no warning: {ran:#?}");
        let checked = scratch.eyesim(&[&["check", "a.sim", "m.maz", "--strict"][..], args].concat());
        assert!(!checked.stdout.contains("maz-cell-first"), "{checked:#?}");
    }
    // In 2018 only the last line, the last letter and heading 0 count.
    scratch.write("b.sim", "world m.maz\nS4 s step.x\n");
    let robot = scratch.report("b.sim", &["--dialect", "vr2018"], 0)["robots"][0].clone();
    let [x, y] = ["pose.x_m", "pose.y_m"].map(|key| (number(&robot, key) * 1000.0).round());
    assert_eq!((x, y), (180.0 + 360.0, 180.0));
    let robot = "[[robot]]\ntype = \"S4\"\nprogram = \"step.c\"\nx_mm = 360\ny_mm = 360\n";
    scratch.write("c.scene.toml", &format!("[world]\nfile = \"m.maz\"\ncell_mm = 500\n{robot}"));
    let report = scratch.report("c.scene.toml", &["--strict"], 0);
    // From x = 360 the robot drives 360 mm, in a row of 1500 mm.
    assert_eq!(report["robots"][0]["lcd"][0].as_str().map(str::trim), Some("720"), "{report:#}");
    scratch.write("d.scene.toml", &format!("[world]\nfile = \"room.wld\"\ncell_mm = 500\n{robot}"));
    scratch.write("room.wld", ROOM);
    let refused = scratch.eyesim(&["check", "d.scene.toml"]);
    assert!(
        refused.code == Some(2) && refused.stdout.contains("`room.wld` has none; expected a `.maz`"),
        "{refused:#?}"
    );
    scratch.write("e.sim", "world room.wld\nS4 500 500 0 step.x\n");
    let refused = scratch.eyesim(&["run", "e.sim", "--maze-cell", "360"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("is not a maze file"), "{refused:#?}");
}

#[test]
fn a_robot_that_leaves_through_a_gap_is_reported_with_its_instant() {
    let scratch = Scratch::new();
    scratch.write("out.c", "#include \"eyebot.h\"\nint main() { VWStraight(1000, 100); VWWait(); return 0; }\n");
    // Mazes with a gap: a lower-case `s` in the bottom row, and a missing `|` at the right.
    for (maze, heading, distance) in [(" ___\n|   |\n|s _|\n", 270, 180.0), (" ___\n|   |\n|__S\n", 0, 180.0)] {
        scratch.write("m.maz", maze);
        scratch.write("a.sim", &format!("world m.maz\nS4 S {heading} out.x\n"));
        let checked = scratch.eyesim(&["check", "m.maz"]);
        assert!(checked.stdout.contains("maz-gap"), "{checked:#?}");
        let left_floor_s =
            |slot: &str| number(&scratch.report("a.sim", &["--slot", slot], 0)["robots"][0], "left_floor_s");
        // The robot drives at 100 mm/s; it starts at the end of the call.
        assert!((left_floor_s("50") - distance / 100.0).abs() < 0.01, "{}", left_floor_s("50"));
        assert_eq!(left_floor_s("50"), left_floor_s("1"), "for any slot length");
        let ran = scratch.eyesim(&["run", "a.sim"]);
        assert_eq!(ran.stderr.matches("has left the floor at (").count(), 1, "{ran:#?}");
    }
    scratch.write("room.wld", ROOM);
    scratch.write("b.sim", "world room.wld\nS4 500 500 0 out.x\n");
    let report = scratch.report("b.sim", &[], 0);
    assert!(report["robots"][0]["left_floor_s"].is_null(), "{report:#}");
}
