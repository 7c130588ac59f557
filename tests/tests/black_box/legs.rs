//! Robots with legs, driven by programs of both generations, in Rust and in Python.
#![allow(clippy::disallowed_methods, reason = "angles by hand, compared within what is printed")]

use std::process::Command;

use serde_json::Value;
use tests::{Scratch, number, root};

/// Biped: height of the hips, length of the thighs, length of the shanks, height of the ankles, in mm.
const BIPED: [f64; 4] = [780.0, 400.0, 400.0, 60.0];

/// Robot types: a biped, a four-legged robot without feet, and a robot on wheels, in a large room.
const TYPES: &str = r#"
[world]
floor_mm = [8000, 8000]

[[robot_type]]
name = "Biped"
diameter_mm = 400
drive = { kind = "legged" }
legs = { step_height_mm = 50, gait = [{ name = "walk", duty = 0.6, offsets = [0, 0.5] }, { name = "stroll", period_ms = 2000 }] }
leg = [
    { name = "LEFT", y_mm = 100, z_mm = 780, thigh_mm = 400, shank_mm = 400, foot = { heel_mm = 60, toe_mm = 160, height_mm = 60 } },
    { name = "RIGHT", y_mm = -100, z_mm = 780, thigh_mm = 400, shank_mm = 400, foot = { heel_mm = 60, toe_mm = 160, height_mm = 60 } },
]

[[robot_type]]
name = "Beetle"
diameter_mm = 1000
drive = { kind = "legged" }
leg = [
    { name = "FL", x_mm = 400, y_mm = 250, z_mm = 700, thigh_mm = 450, shank_mm = 450 },
    { name = "FR", x_mm = 400, y_mm = -250, z_mm = 700, thigh_mm = 450, shank_mm = 450 },
    { name = "RL", x_mm = -400, y_mm = 250, z_mm = 700, thigh_mm = 450, shank_mm = 450 },
    { name = "RR", x_mm = -400, y_mm = -250, z_mm = 700, thigh_mm = 450, shank_mm = 450 },
]

[[robot_type]]
name = "Cart"
diameter_mm = 200
"#;

/// Writes a scene with these robots: type, program and further keys. All have x = 2 m; their y is 2 m, 4 m, and so on.
fn scene(scratch: &Scratch, robots: &[(&str, &str, &str)]) {
    let mut text = TYPES.to_owned();
    for ((kind, program, more), at) in robots.iter().zip(1..) {
        text += &format!(
            "[[robot]]\ntype = \"{kind}\"\nprogram = \"{program}\"\nx_mm = 2000\ny_mm = {}\n{more}\n",
            2000 * at
        );
    }
    scratch.write("legs.scene.toml", &text);
}

/// Runs the scene and returns the report and the trace.
fn run(scratch: &Scratch, args: &[&str]) -> (Value, Vec<Value>) {
    let report = scratch.report("legs.scene.toml", &[&["--trace", "trace.jsonl"], args].concat(), 0);
    (report, scratch.trace("trace.jsonl"))
}

/// The lines that a robot printed.
fn printed(trace: &[Value], robot: u64) -> Vec<&str> {
    let lines = trace.iter().filter(|event| event["event"] == "stdout" && event["robot"] == robot);
    lines.map(|event| event["text"].as_str().expect("a text")).collect()
}

/// The hints of a run to the user.
fn hints(scratch: &Scratch) -> String {
    let ran = scratch.eyesim(&["run", "legs.scene.toml"]);
    let hints = ran.stderr.lines().filter_map(|line| line.split_once("hint: "));
    hints.map(|(_, hint)| format!("{hint}\n")).collect()
}

/// Knee angle of a leg that stands with its hip above its ankle, in degrees. The thigh's angle is half of it.
fn standing_knee() -> f64 {
    let [hip, thigh, _, ankle] = BIPED;
    2.0 * ((hip - ankle) / (2.0 * thigh)).acos().to_degrees()
}

#[test]
fn joint_angles_and_link_poses_of_a_standing_biped_match_trigonometry() {
    let scratch = Scratch::new();
    scratch.write(
        "stand.c",
        r#"#include <stdio.h>
#include "eyebot.h"
int main(void)
{
  float angle, mm, pose[6];
  int joint, link;
  for (joint = 1; LEGGetJoint(2, joint, &angle) == 0; joint++)
    printf("%.4f\n", angle + 0.0);
  for (link = 1; LEGGetLink(2, link, pose) == 0; link++)
    printf("%.3f %.3f %.3f %.4f %.4f %.4f\n", pose[0], pose[1], pose[2], pose[3], pose[4], pose[5]);
  printf("%d %d %.3f\n", LEGCount(), LEGGetFoot(1), LEGGetHeight(&mm) == 0 ? mm : -1);
  return 0;
}
"#,
    );
    scene(&scratch, &[("Biped", "stand.c", "api = 6"), ("Biped", "stand.c", "api = 7")]);
    let (_, trace) = run(&scratch, &[]);
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').map(|word| word.parse().expect("a number")).collect() };
    let (knee, half) = (standing_knee(), 0.5 * standing_knee());
    let [hip, thigh, _, ankle] = BIPED;
    let (ahead, down) = (thigh * half.to_radians().sin(), thigh * half.to_radians().cos());
    let expected = [
        vec![0.0],
        vec![0.0],
        vec![half],
        vec![knee],
        vec![half],
        vec![0.0, -100.0, hip, 0.0, half, 0.0],
        vec![ahead, -100.0, hip - down, 0.0, -half, 0.0],
        vec![0.0, -100.0, ankle, 0.0, 0.0, 0.0],
        vec![2.0, 1.0, 0.0],
    ];
    for robot in [1, 2] {
        let lines = printed(&trace, robot);
        assert_eq!(lines.len(), expected.len(), "{lines:?}");
        for (line, expected) in lines.iter().zip(&expected) {
            for (read, expected) in numbers(line).into_iter().zip(expected) {
                assert!((read - expected).abs() < 6e-4, "{line}: {expected}");
            }
        }
    }
}

#[test]
fn the_record_of_a_stop_does_not_depend_on_what_the_program_does_meanwhile() {
    let scratch = Scratch::new();
    let walk = |wait: &str| {
        format!(
            "#include \"eyebot.h\"\nint main(void)\n{{\n  int i;\n  LEGSetSpeed(400, 0, 0);\n  OSWait(2300);\n  \
             LEGSetSpeed(0, 0, 0);\n  {wait}\n  return 0;\n}}\n"
        )
    };
    scratch.write("sleep.c", &walk("i = 0; OSWait(8000 + i);"));
    scratch.write("poll.c", &walk("for (i = 0; i < 160; i++) OSWait(50);"));
    for kind in ["Biped", "Beetle"] {
        let [sleeping, polling] = ["sleep.c", "poll.c"].map(|program| {
            scene(&scratch, &[(kind, program, "api = 7")]);
            let (report, trace) = run(&scratch, &[]);
            let records = trace.into_iter().filter(|event| {
                ["posture", "footfall", "body_height", "joint", "pose"].iter().any(|name| event["event"] == *name)
            });
            (report["robots"][0]["footfalls"].clone(), records.collect::<Vec<_>>())
        });
        let after_stop = |record: &&Value| number(record, "t_s") > 2.4;
        assert!(polling.1.iter().filter(after_stop).count() > 5, "{kind} ends its steps after the stop");
        for (slept, polled) in sleeping.1.iter().zip(&polling.1) {
            assert_eq!(slept, polled, "{kind} at {} s", polled["t_s"]);
        }
        assert_eq!(sleeping.1.len(), polling.1.len(), "{kind}");
        assert_eq!(sleeping.0, polling.0);
    }
}

#[test]
fn vw_functions_and_odometry_are_those_of_any_robot() {
    let scratch = Scratch::new();
    scratch.write(
        "six.c",
        r#"#include <stdio.h>
#include "eyebot.h"
int main(void)
{
  PositionType at;
  VWHandle vw = VWInit(VW_DRIVE, 1);
  VWDriveStraight(vw, 2.0, 0.2);
  VWDriveWait(vw);
  VWGetPosition(vw, &at);
  printf("%.6f %.6f %.6f\n", at.x, at.y, at.phi);
  VWDriveTurn(vw, 1.5, 0.3);
  VWDriveWait(vw);
  return 0;
}
"#,
    );
    scratch.write(
        "seven.c",
        "#include <stdio.h>\n#include \"eyebot.h\"\nint main()\n{\n  int x, y, phi;\n  VWStraight(2000, 200);\n  VWWait();\n  \
         VWGetPosition(&x, &y, &phi);\n  printf(\"%d %d %d\\n\", x, y, phi);\n  return 0;\n}\n",
    );
    scene(
        &scratch,
        &[("Biped", "six.c", "api = 6"), ("Biped", "seven.c", "api = 7"), ("Beetle", "seven.c", "api = 7")],
    );
    let (report, trace) = run(&scratch, &[]);
    assert_eq!(printed(&trace, 1), ["2.000000 0.000000 0.000000"]);
    assert_eq!((printed(&trace, 2), printed(&trace, 3)), (vec!["2000 0 0"], vec!["2000 0 0"]));
    for (robot, phi) in report["robots"].as_array().expect("robots").iter().zip([1.5_f32, 0.0, 0.0]) {
        assert!((number(robot, "pose.x_m") - 4.0).abs() < 1e-9, "{robot:#}");
        assert!((number(robot, "pose.phi_rad") - f64::from(phi)).abs() < 1e-9, "{robot:#}");
        assert_eq!((number(robot, "contacts"), number(robot, "touches")), (0.0, 0.0), "{robot:#}");
        // The walk takes more than 10 s, at one step per second and foot. The first and the last step may be missing.
        assert!(number(robot, "footfalls") >= 18.0, "{robot:#}");
    }
}

/// Walks, changes the gait, corrects steps, and prints the state of the legs throughout.
const WALK: &str = r#"#include <stdio.h>
#include "eyebot.h"
int main()
{
  float angle, mm;
  int i, leg;
  LEGSetSpeed(200, 50, 5);
  for (i = 0; i < 60; i++) {
    OSWait(77);
    if (i == 20) printf("gait %d\n", LEGSetGait(2));
    if (i == 30) printf("step %d\n", LEGSetStep(80));
    if (i == 40) printf("correct %d\n", LEGCorrect(1, 40, -20, 30));
    if (i == 50) LEGSetSpeed(0, 0, 0);
    for (leg = 1; leg <= LEGCount(); leg++) {
      LEGGetJoint(leg, 4, &angle);
      LEGGetHeight(&mm);
      printf("%d %.5f %.4f %d\n", leg, angle, mm, LEGGetFoot(leg));
    }
  }
  return 0;
}
"#;

#[test]
fn a_walk_is_the_same_on_threads_in_processes_and_for_every_slot() {
    let scratch = Scratch::new();
    scratch.write("walk.c", WALK);
    scene(&scratch, &[("Biped", "walk.c", "api = 7"), ("Biped", "walk.c", "api = 7")]);
    let walked = |args: &[&str]| {
        let (report, trace) = run(&scratch, args);
        // Poses and postures are recorded at the ends of slots.
        let of_slots = ["pose", "posture", "slot", "header"];
        let events = trace.iter().filter(|event| !of_slots.iter().any(|kind| event["event"] == **kind));
        let events: Vec<String> = events
            .map(|event| {
                let mut event = event.clone();
                let fields = event.as_object_mut().expect("an object");
                ["seq", "digest"].iter().for_each(|name| drop(fields.remove(*name)));
                event.to_string()
            })
            .collect();
        (report["digest"].clone(), events)
    };
    let (digest, events) = walked(&[]);
    assert!(events.iter().filter(|line| line.contains("\"footfall\"")).count() > 10, "{events:?}");
    for args in [&["--threads", "1"][..], &["--threads", "4"], &["--exec", "process"]] {
        assert_eq!(walked(args).0, digest, "{args:?}");
    }
    for slot in ["1", "7.3", "1000"] {
        let (_, same) = walked(&["--slot", slot]);
        // The run ends at the end of a slot, so its end depends on the slot length.
        assert_eq!(same[..same.len() - 1], events[..events.len() - 1], "slots of {slot} ms");
    }
    let ran = scratch.eyesim(&["run", "legs.scene.toml", "--trace", "again.jsonl", "--record", "walk.mcap"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let verified = scratch.eyesim(&["replay", "again.jsonl", "--verify"]);
    assert!(
        verified.code == Some(0) && verified.stdout.contains("the same digest"),
        "{}{}",
        verified.stdout,
        verified.stderr
    );
    assert!(std::fs::metadata(scratch.path().join("walk.mcap")).expect("a recording").len() > 10_000);
}

#[test]
fn feet_alternate_and_tread_a_stride_apart() {
    let scratch = Scratch::new();
    scratch.write(
        "ahead.c",
        "#include \"eyebot.h\"\nint main()\n{\n  LEGSetSpeed(200, 0, 0);\n  OSWait(8000);\n  return 0;\n}\n",
    );
    scene(&scratch, &[("Biped", "ahead.c", "api = 7")]);
    let (report, trace) = run(&scratch, &[]);
    let steps: Vec<&Value> = trace.iter().filter(|event| event["event"] == "footfall").collect();
    assert_eq!(number(&report["robots"][0], "footfalls"), steps.len() as f64);
    for pair in steps.windows(2) {
        assert_ne!(pair[0]["leg"], pair[1]["leg"], "{pair:?}");
    }
    for side in ["LEFT", "RIGHT"] {
        let of_side: Vec<&&Value> = steps.iter().filter(|event| event["leg"] == side).collect();
        assert!(of_side.len() >= 7, "{steps:?}");
        // The first cycle is half as long, and the last step follows the stop command.
        for pair in of_side[1..6].windows(2) {
            let stride = number(pair[1], "x_m") - number(pair[0], "x_m");
            assert!((stride - 0.2).abs() < 1e-6, "{pair:?}");
            let out = number(pair[0], "y_m") - 2.0;
            assert!((out - if side == "LEFT" { 0.1 } else { -0.1 }).abs() < 1e-6 && number(pair[0], "z_m") == 0.0);
        }
    }
    let postures: Vec<&Value> = trace.iter().filter(|event| event["event"] == "posture").collect();
    assert!(
        postures.len() > 100
            && postures.iter().all(|event| event["joints_rad"].as_array().is_some_and(|all| all.len() == 10))
    );
}

#[test]
fn motions_beyond_the_legs_are_refused_and_reported() {
    let scratch = Scratch::new();
    let wrong = r#"#include <stdio.h>
#include <limits.h>
#include "eyebot.h"
#define TRY(call) printf("%d\n", call)
static float room[6], angle;
int main(void)
{
  TRY(LEGSetGait(0)); TRY(LEGSetGait(3)); TRY(LEGSetGait(INT_MIN));
  TRY(LEGGetJoint(0, 1, &angle)); TRY(LEGGetJoint(1, 6, &angle)); TRY(LEGGetJoint(1, 1, 0));
  TRY(LEGGetLink(99, 1, room)); TRY(LEGGetLink(1, 4, room)); TRY(LEGGetLink(1, 1, 0));
  TRY(LEGGetHeight(0)); TRY(LEGGetFoot(-1)); TRY(LEGGetFoot(INT_MAX));
  TRY(LEGSetStep(-1)); TRY(LEGSetStep(INT_MAX));
  TRY(LEGCorrect(3, 0, 0, 0)); TRY(LEGCorrect(1, INT_MAX, 0, 0)); TRY(LEGCorrect(1, 0, 0, INT_MIN));
  TRY(LEGSetGait(1)); TRY(LEGSetSpeed(INT_MAX, INT_MIN, INT_MAX));
  return 0;
}
"#;
    scratch.write("wrong.c", wrong);
    for api in ["api = 6", "api = 7"] {
        scene(&scratch, &[("Biped", "wrong.c", api)]);
        let (_, trace) = run(&scratch, &[]);
        assert_eq!(printed(&trace, 1), [&["-1"; 17][..], &["0"; 2]].concat(), "{api}");
        let hints = hints(&scratch);
        for words in [
            "`LEGSetGait` returned -1: there is no gait 0, there are: 1 (walk), 2 (stroll)\n",
            "`LEGGetJoint` returned -1: there is no leg 0, there are: 1 (LEFT), 2 (RIGHT)\n",
            "`LEGGetLink` returned -1: there is no leg 99, there are: 1 (LEFT), 2 (RIGHT)\n",
            "`LEGSetStep` returned -1: a length is not one that a leg can do",
            "`LEGCorrect` returned -1: there is no leg 3, there are: 1 (LEFT), 2 (RIGHT)\n",
        ] {
            assert!(hints.contains(words), "{api}: {words}\n{hints}");
        }
        scene(&scratch, &[("Cart", "wrong.c", api)]);
        let (_, trace) = run(&scratch, &[]);
        assert_eq!(printed(&trace, 1), ["-1"; 19], "{api}");
        assert!(self::hints(&scratch).contains("`LEGSetSpeed` returned -1: "), "{api}");
    }
}

#[test]
fn extreme_numbers_do_no_harm() {
    let scratch = Scratch::new();
    scratch.write(
        "extreme.c",
        r#"#include <limits.h>
#include <stdio.h>
#include "eyebot.h"
#define ASK(call) \
  for (n = 0; n < (int)(sizeof values / sizeof *values); n++) { \
    int u = values[n], x = -1, y = -1, phi = -1; \
    (void)(call); \
    OSWait(300); \
    SIMSetRobot(0, 2000, 2000, 0, 0); \
    VWSetPosition(0, 0, 0); \
    VWStraight(200, 400); \
    VWWait(); \
    VWGetPosition(&x, &y, &phi); \
    LEGGetHeight(&mm); \
    if (x != 200 || y != 0 || phi != 0 || !(mm > -300 && mm < 300)) \
      printf("%s with %d: then at %d/%d/%d, %f mm high\n", #call, u, x, y, phi, mm); \
  }
int main(void)
{
  static const int values[] = { INT_MIN, -65536, -1, 0, 1, 2, 3, 300, 65536, INT_MAX };
  float numbers[6], mm;
  int n;
  ASK(LEGSetGait(u))
  ASK(LEGSetSpeed(u, 0, 0))
  ASK(LEGSetSpeed(0, u, 0))
  ASK(LEGSetSpeed(u, u, u))
  ASK(LEGSetStep(u))
  ASK(LEGGetJoint(u, 1, numbers))
  ASK(LEGGetJoint(1, u, numbers))
  ASK(LEGGetLink(u, 1, numbers))
  ASK(LEGGetLink(1, u, numbers))
  ASK(LEGGetFoot(u))
  ASK(LEGCorrect(u, 0, 0, 0))
  ASK(LEGCorrect(1, u, 0, 0))
  ASK(LEGCorrect(1, 0, u, 0))
  ASK(LEGCorrect(2, 0, 0, u))
  printf("done\n");
  return 0;
}
"#,
    );
    scene(&scratch, &[("Biped", "extreme.c", "api = 7")]);
    let (_, trace) = run(&scratch, &[]);
    assert_eq!(printed(&trace, 1), ["done"]);
    let postures = trace.iter().filter(|event| event["event"] == "posture");
    let mut numbers = postures.flat_map(|event| event["joints_rad"].as_array().expect("angles"));
    // Non-finite numbers are written as null.
    assert!(numbers.clone().count() > 1000 && numbers.all(Value::is_number));
}

#[test]
fn a_speed_beyond_the_legs_is_slowed_down_as_a_whole() {
    let scratch = Scratch::new();
    scratch.write(
        "fast.c",
        "#include \"eyebot.h\"\nint main()\n{\n  LEGSetSpeed(2000000000, 1000000000, 0);\n  OSWait(2000);\n  return 0;\n}\n",
    );
    scene(&scratch, &[("Biped", "fast.c", "api = 7")]);
    let (report, _) = run(&scratch, &[]);
    let robot = &report["robots"][0];
    let [dx, dy] = ["pose.x_m", "pose.y_m"].map(|path| number(robot, path) - 2.0);
    assert!(dx > 0.2 && dx < 2.0 && (dy - 0.5 * dx).abs() < 1e-9, "{robot:#}");
}

#[test]
fn leg_functions_give_the_same_in_python() {
    if !Command::new("python3").arg("-V").output().is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: no python3");
        return;
    }
    let scratch = Scratch::new();
    scratch.write(
        "walk.py",
        "from eye import *\nLEGSetSpeed(200, 0, 0)\nfor i in range(5):\n    OSWait(300)\n    \
         print(f\"{LEGGetJoint(1, 4):.4f} {LEGGetLink(2, 2)[2]:.3f} {LEGGetHeight():.3f} {LEGGetFoot(1)}\")\n\
         print(LEGGetJoint(3, 1), LEGGetLink(1, 9), LEGCount(), LEGSetGait(9))\n",
    );
    scratch.write(
        "walk.c",
        r#"#include <stdio.h>
#include "eyebot.h"
int main()
{
  float angle, pose[6], mm;
  int i;
  LEGSetSpeed(200, 0, 0);
  for (i = 0; i < 5; i++) {
    OSWait(300);
    LEGGetJoint(1, 4, &angle);
    LEGGetLink(2, 2, pose);
    LEGGetHeight(&mm);
    printf("%.4f %.3f %.3f %d\n", angle, pose[2], mm, LEGGetFoot(1));
  }
  printf("None None 2 -1\n");
  return 0;
}
"#,
    );
    scene(&scratch, &[("Biped", "walk.py", ""), ("Biped", "walk.c", "api = 7")]);
    let (_, trace) = run(&scratch, &[]);
    assert_eq!(printed(&trace, 1), printed(&trace, 2));
    assert_eq!(printed(&trace, 1).len(), 6);
}

#[test]
fn the_example_walks_on_two_and_on_four_legs() {
    let report = Scratch::new().report(
        root().join("sims/walk.scene.toml").to_str().expect("the checkout's path is text"),
        &[],
        0,
    );
    for robot in report["robots"].as_array().expect("robots") {
        assert_eq!(robot["outcome"], "finished", "{robot:#}");
        assert!(number(robot, "footfalls") > 10.0 && number(robot, "touches") == 0.0, "{robot:#}");
    }
}
