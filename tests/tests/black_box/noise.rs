//! Noise in programs: readings of devices are independent, and wrong profiles are rejected with their location.
#![allow(clippy::disallowed_methods, reason = "compared within tolerances")]

use serde_json::Value;
use tests::{Scratch, number, root};

/// Reads two PSDs, a sonar, the compass and the scanner while it drives in a noisy circle.
///
/// The arguments set the number of readings of each device per cycle, and a reversed order. After all readings of a
/// cycle the program prints them, in a fixed order.
const LOOK: &str = r#"#include "eyebot.h"
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char *argv[])
{
  int often = argc > 1 ? atoi(argv[1]) : 1;
  int is_backwards = argc > 2;
  int read[4], cycle, time, i;
  PSDHandle front = PSDInit(PSD_FRONT), left = PSDInit(PSD_LEFT), sonar = PSDInit(40);
  VWHandle vw = VWInit(VW_DRIVE, 1);

  COMPASSInit(COMPASS);
  COMPASSStart(TRUE);
  PSDStart(front | left | sonar, TRUE);
  VWSetSpeed(vw, 0.15, 0.5);
  for (cycle = 1; cycle <= 40; cycle++) {
    /* Waits until the middle of a PSD cycle, away from the ends of the compass's cycles. */
    OSWait(30 * cycle + 3 - OSGetCount());
    for (time = 0; time < often; time++)
      for (i = 0; i < 4; i++) {
        int which = is_backwards ? 3 - i : i;
        read[which] = which == 0 ? PSDGet(front) : which == 1 ? PSDGet(left) : which == 2 ? PSDGet(sonar) : COMPASSGet();
      }
    printf("%d: %d %d %d %d\n", cycle, read[0], read[1], read[2], read[3]);
  }
  VWSetSpeed(vw, 0, 0);
  return 0;
}
"#;

/// Drives two legs of a path and prints each scan and its odometry.
const SCAN: &str = r#"#include "eyebot.h"
#include <stdio.h>

int main(void)
{
  int scan[16], leg, i, x, y, phi;
  for (leg = 0; leg < 2; leg++) {
    VWStraight(300, 150);
    while (!VWDone()) {
      LIDARGet(scan);
      VWGetPosition(&x, &y, &phi);
      printf("at %d %d %d:", x, y, phi);
      for (i = 0; i < 16; i++)
        printf(" %d", scan[i]);
      printf("; %d\n", PSDGet(PSD_FRONT));
      OSWait(100);
    }
    VWTurn(90, 45);
    VWWait();
  }
  return 0;
}
"#;

/// Two chambers of 2 m x 3 m that are not visible from each other.
const ROOM: &str = "floor 4000 3000\n0 0 4000 0\n4000 0 4000 3000\n4000 3000 0 3000\n0 3000 0 0\n2000 0 2000 3000\n";

const BODY: &str = "diameter 180\nspeed 600\nturn 300\naxis 0\nwheel 54 3600 1100 90\n\
                    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
const PSDS: &str = "psd PSD_FRONT -200 60 0 30 0\npsd PSD_LEFT -201 0 60 30 90\n";
const COMPANION: &str = "[psd]\nrange_mm = 3500\n[compass]\nnorth_deg = 90\n[[sonar]]\nname = \"SONAR\"\nid = 40\nz_mm = 100\n\
                         [lidar]\npoints = 16\nrange_mm = 4000\n";

/// A scene with robot 1 of the type `first` in the left chamber, and robot 2 with the same devices in the right one.
fn scene(noise: &str, arguments: &str, more: &str) -> String {
    format!(
        "[world]\nfile = \"room.wld\"\n[scene]\nnoise = {noise}\nuntil_s = 13\n\
         [[robot]]\ntype = \"first.robi\"\nprogram = \"look.c\"\napi = 6\narguments = [{arguments}]\n\
         x_mm = 1000\ny_mm = 1200\nheading_deg = 10\n\
         [[robot]]\ntype = \"second.robi\"\nprogram = \"scan.c\"\napi = 7\nx_mm = 2700\ny_mm = 1100\n{more}"
    )
}

fn write(scratch: &Scratch) {
    scratch.write("room.wld", ROOM);
    for name in ["first", "second"] {
        scratch.write(&format!("{name}.robi"), &format!("name {name}\n{PSDS}{BODY}"));
        scratch.write(&format!("{name}.toml"), COMPANION);
    }
    scratch.write("look.c", LOOK);
    scratch.write("scan.c", SCAN);
    scratch.write("a.scene.toml", &scene("\"harsh\"", "", ""));
}

/// Trace lines of each robot, starting with robot 1.
fn run(scratch: &Scratch, args: &[&str]) -> Vec<Vec<String>> {
    let args = [&["--trace", "t.jsonl"], args].concat();
    let report = scratch.report("a.scene.toml", &args, 0);
    let mut lines = vec![Vec::new(); report["robots"].as_array().expect("robots").len()];
    for event in scratch.trace("t.jsonl") {
        if let Some(robot) = event["robot"].as_u64() {
            lines[robot as usize - 1].push(event.to_string());
        }
    }
    lines
}

/// Output of the programs.
fn printed(lines: &[String]) -> Vec<String> {
    let event = |line: &String| serde_json::from_str::<Value>(line).expect("a line of a trace");
    let texts = lines.iter().map(event).filter(|event| event["event"] == "stdout");
    texts.map(|event| event["text"].as_str().expect("a text").to_owned()).collect()
}

#[test]
fn readings_err_only_where_a_profile_says_so() {
    let scratch = Scratch::new();
    write(&scratch);
    let harsh = run(&scratch, &[]);
    assert_eq!(printed(&harsh[0]).len(), 40, "{:#?}", harsh[0]);
    assert!(printed(&harsh[1]).len() > 20, "{:#?}", harsh[1]);
    let other_seed = run(&scratch, &["--seed", "1"]);
    let exact = run(&scratch, &["--noise", "none"]);
    for robot in 0..2 {
        assert_ne!(harsh[robot], other_seed[robot]);
        assert_ne!(harsh[robot], exact[robot]);
        assert_ne!(printed(&harsh[robot]), printed(&exact[robot]));
    }
    assert_eq!(run(&scratch, &["--noise", "none", "--seed", "1"]), exact, "nothing is drawn");
    scratch.write("a.scene.toml", &scene("\"none\"", "", ""));
    assert_eq!(run(&scratch, &[]), exact);
    scratch.write("a.scene.toml", &scene("\"none\"", "", "").replace("noise = \"none\"\n", ""));
    assert_eq!(run(&scratch, &[]), exact, "off by default");
    assert_eq!(run(&scratch, &["--noise", "harsh"]), harsh, "the command line goes first");
}

#[test]
fn another_sensor_changes_no_reading_of_any_other() {
    let scratch = Scratch::new();
    write(&scratch);
    let before = run(&scratch, &[]);
    for (robi, companion) in [
        // New sensors of every kind, before and after the existing ones.
        (format!("name first\npsd PSD_RIGHT -202 0 -60 30 -90\n{PSDS}{BODY}"), COMPANION.to_owned()),
        (format!("name first\n{PSDS}psd PSD_BACK -203 -60 0 30 180\n{BODY}"), COMPANION.to_owned()),
        (
            format!("name first\n{PSDS}{BODY}"),
            COMPANION.replace("[[sonar]]", "[[sonar]]\nname = \"OTHER\"\nid = 39\nz_mm = 50\n[[sonar]]")
                + "[[laser]]\nname = \"LASER\"\nid = 41\n[[ultrasonic]]\nname = \"ULTRA\"\nid = 42\n\
                   [[reflectance]]\nname = \"REFLECTANCE\"\nid = 43\n[[bumper]]\nname = \"BUMP\"\nfrom_deg = 0\nto_deg = 9\n",
        ),
    ] {
        scratch.write("first.robi", &robi);
        scratch.write("first.toml", &companion);
        let after = run(&scratch, &[]);
        assert_eq!(after[0], before[0], "{robi}{companion}");
        assert_eq!(after[1], before[1], "{robi}{companion}");
    }
}

#[test]
fn another_robot_changes_no_reading_of_the_others() {
    let scratch = Scratch::new();
    write(&scratch);
    let before = run(&scratch, &[]);
    // Walls around the place of the new robot, so that no other robot can see it.
    scratch.write("room.wld", &format!("{ROOM}2000 2500 2500 2500\n2500 2500 2500 3000\n"));
    let walled = run(&scratch, &[]);
    let third = "[[robot]]\ntype = \"first.robi\"\nprogram = \"look.c\"\napi = 6\nx_mm = 2250\ny_mm = 2750\n";
    scratch.write("a.scene.toml", &scene("\"harsh\"", "", third));
    let after = run(&scratch, &[]);
    assert_eq!(before[0], walled[0]);
    assert_eq!(after[..2], walled[..]);
    assert_ne!(printed(&after[2]), printed(&after[0]), "it has errors of its own");
}

#[test]
fn a_profile_of_one_sensor_changes_only_that_sensor() {
    let scratch = Scratch::new();
    write(&scratch);
    let before = run(&scratch, &[]);
    let own = "{ base = \"harsh\", sensor = { PSD_LEFT = { sigma_mm = 200 } } }";
    scratch
        .write("a.scene.toml", &scene("\"harsh\"", "", "").replacen("api = 6", &format!("api = 6\nnoise = {own}"), 1));
    let after = run(&scratch, &[]);
    assert_eq!(after[1], before[1], "robot 2 keeps the scene's");
    let changed: Vec<Value> = before[0]
        .iter()
        .zip(&after[0])
        .filter(|(before, after)| before != after)
        .map(|(before, _)| serde_json::from_str(before).expect("a line of a trace"))
        .filter(|event: &Value| event["event"] != "stdout")
        .collect();
    assert!(changed.len() > 20 && changed.iter().all(|event| event["device"] == "PSD_LEFT"), "{changed:#?}");
}

#[test]
fn how_often_and_in_what_order_sensors_are_read_changes_no_reading() {
    let scratch = Scratch::new();
    write(&scratch);
    let once = printed(&run(&scratch, &[])[0]);
    for arguments in ["\"3\"", "\"1\", \"backwards\"", "\"7\", \"backwards\""] {
        scratch.write("a.scene.toml", &scene("\"harsh\"", arguments, ""));
        assert_eq!(printed(&run(&scratch, &[])[0]), once, "arguments {arguments}");
    }
}

#[test]
fn noise_is_independent_of_threads_and_slots_and_repeatable() {
    let scratch = Scratch::new();
    write(&scratch);
    let third = "[[robot]]\ntype = \"first.robi\"\nprogram = \"look.c\"\napi = 6\ncount = 6\nlayout = { \
                 kind = \"random\", from_mm = [2300, 300], to_mm = [3700, 2700] }\n";
    let crowded = scene("\"harsh\"", "", third);
    scratch.write("a.scene.toml", &crowded);
    let first = run(&scratch, &["--threads", "1"]);
    for threads in ["1", "2", "8", "8", "64"] {
        assert_eq!(run(&scratch, &["--threads", threads]), first, "{threads} threads");
    }
    // A robot that sees only walls gets equal readings for every slot length; poses are recorded at the ends of slots.
    scratch.write("a.scene.toml", &scene("\"harsh\"", "", ""));
    let of = |slot| run(&scratch, &["--slot", slot]).iter().map(|lines| printed(lines)).collect::<Vec<_>>();
    let printed = of("50");
    for slot in ["1", "7", "1000"] {
        assert_eq!(of(slot), printed, "slots of {slot} ms");
    }
}

#[test]
fn invalid_profiles_are_refused_with_location_and_what_is_expected() {
    let scratch = Scratch::new();
    write(&scratch);
    for (profile, place_word, expected) in [
        ("[psd]\nsigma_mm = -3\n", "2:12: error[number-range]", "a number in mm from 0 to 1000000"),
        ("[compass]\n\nsigma_deg = nan\n", "3:13: error[number-range]", "a number in degrees from 0 to 360"),
        ("[drive]\nv_sigma_mm_s = inf\n", "2:16: error[number-range]", "a number in mm/s from 0 to 100000"),
        ("base = \"real\"\n[sonar]\noutlier = 1.5\n", "3:11: error[number-range]", "a number from 0 to 1"),
        ("[drive]\nslip_percent = 150\n", "2:16: error[number-range]", "a number in percent from -100 to 100"),
        ("[drive]\nleft_percent = -60\n", "2:16: error[number-range]", "a number in percent from -50 to 100"),
        ("[psd]\nsigma_mm = \"much\"\n", "2:12: error[toml-type]", "a number in mm"),
        ("psd = 3\n", "1:7: error[toml-type]", "a table"),
        ("base = \"raal\"\n", "1:8: error[toml-choice]", "one of none, mild, real, harsh"),
        ("[psd\n", "1:5: error[toml-syntax]", "TOML"),
    ] {
        scratch.write("wrong.noise.toml", profile);
        let ran = scratch.eyesim(&["run", "a.scene.toml", "--noise", "wrong.noise.toml"]);
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{profile}: {ran:#?}");
        assert!(ran.stderr.contains(&format!("wrong.noise.toml:{place_word}")), "{profile}: {ran:#?}");
        let checked = scratch.eyesim(&["check", "--format", "json", "wrong.noise.toml"]);
        let said: Value = serde_json::from_str(&checked.stdout).expect("JSON");
        let said = said[0]["expected"].as_str().expect("what is expected");
        assert!(said.starts_with(expected), "{profile}: {said}");
    }
}

#[test]
fn unused_entries_of_a_profile_are_warnings() {
    let scratch = Scratch::new();
    write(&scratch);
    for (profile, said) in [
        ("[psd]\nsgima_mm = 3\n", "2:1: warning[toml-key]: unknown key `sgima_mm` in `psd`"),
        ("[pds]\nsigma_mm = 3\n", "1:2: warning[toml-key]: unknown key `pds`"),
        ("[psd]\ndevice = 1\n", "2:1: warning[toml-key]: unknown key `device` in `psd`"),
        ("", "1:1: warning[noise-empty]"),
        ("[sensor.PSD_FORNT]\nsigma_mm = 3\n", "2:1: warning[noise-sensor]"),
    ] {
        scratch.write("vain.toml", profile);
        let ran = scratch.eyesim(&["run", "a.scene.toml", "--noise", "vain.toml", "--until", "0.1"]);
        assert_eq!(ran.code, Some(0), "{profile}: {ran:#?}");
        assert!(ran.stderr.contains(&format!("vain.toml:{said}")), "{profile}: {ran:#?}");
        let strict = scratch.eyesim(&["run", "a.scene.toml", "--noise", "vain.toml", "--strict"]);
        assert_eq!(strict.code, Some(2), "{profile}: {strict:#?}");
    }
}

#[test]
fn missing_and_invalid_profiles_are_refused() {
    let scratch = Scratch::new();
    write(&scratch);
    for (noise, said) in [
        ("nowhere.toml", "nowhere.toml: error[file-missing]: no such file"),
        (
            "raal",
            "--noise: `raal` is not a noise profile: expected one of none, mild, real, harsh, course, or a file NAME.toml",
        ),
        ("room.wld", "room.wld:1:7: error[toml-syntax]"),
    ] {
        let ran = scratch.eyesim(&["run", "a.scene.toml", "--noise", noise]);
        assert_eq!(ran.code, Some(2), "{noise}: {ran:#?}");
        assert!(ran.stderr.contains(said), "{noise}: {ran:#?}");
    }
    scratch.write("a.scene.toml", &scene("\"nowhere.toml\"", "", ""));
    let ran = scratch.eyesim(&["run", "a.scene.toml"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("a.scene.toml:4:9: error[file-missing]"), "{ran:#?}");
}

#[test]
fn the_return_error_grows_with_the_errors_of_the_drive() {
    let scratch = Scratch::new();
    let scene = root().join("sims/umbmark.scene.toml");
    let report = scratch.report(scene.to_str().expect("a text"), &[], 0);
    let robots = report["robots"].as_array().expect("robots");
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    let off = |robot: &Value, [x, y]: [f64; 2]| length(number(robot, "pose.x_m") - x, number(robot, "pose.y_m") - y);
    let starts = [[0.5, 0.5], [2.5, 0.5], [0.5, 2.5], [2.5, 2.5]];
    let off: Vec<f64> = robots.iter().zip(starts).map(|(robot, start)| off(robot, start)).collect();
    assert!(off[0] < 1e-9 && off.is_sorted(), "{off:?}");
    assert!(off[1] > 1e-4 && off[2] > 0.01 && off[3] > 0.1, "{off:?}");
    // The odometry is not affected.
    for robot in robots {
        assert!(length(number(robot, "odometry.x_m"), number(robot, "odometry.y_m")) < 0.1, "{robot:#}");
        assert_eq!(robot["contacts"], 0);
    }
}

#[test]
fn the_results_of_umbmark_do_not_depend_on_the_heading_at_the_start() {
    let scratch = Scratch::new();
    let results = [0, 90].map(|heading| {
        let scene = format!(
            "[world]\nfloor_mm = [6000, 6000]\n[[robot]]\ntype = \"%sim%/robis/scout.robi\"\n\
             program = \"%sim%/example-programs/umbmark/umbmark.c\"\nx_mm = 3000\ny_mm = 3000\n\
             heading_deg = {heading}\nnoise = \"harsh\"\n"
        );
        scratch.write("a.scene.toml", &scene);
        let ran = scratch.eyesim(&["run", "a.scene.toml"]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        ran.stdout.lines().filter(|line| line.contains("off by")).map(str::to_owned).collect::<Vec<_>>()
    });
    assert!(results[0].len() == 2 && results[0] == results[1], "{results:?}");
}

#[test]
fn the_picture_is_the_one_that_the_scene_draws() {
    let scratch = Scratch::new();
    let plot = scratch.path().join("noise.svg");
    let mut command = scratch.command(&["run", "sims/umbmark.scene.toml", "--plot"]);
    let output = command.arg(&plot).current_dir(root()).output().expect("eyesim starts");
    assert!(output.status.success(), "{output:?}");
    let committed = std::fs::read_to_string(root().join("docs/noise.svg")).expect("the page's picture");
    let advice = "draw it again: cargo run --release -- run sims/umbmark.scene.toml --plot docs/noise.svg";
    assert!(scratch.read("noise.svg") == committed, "{advice}");
}

#[test]
fn drives_miss_their_targets_within_the_bounds_of_the_course_and_odometry_shows_it() {
    const DRIVE: &str = "#include \"eyebot.h\"\n#include <stdio.h>\nint main() {\n int x, y, phi, i;\n \
        for (i = 0; i < 5; i++) {\n VWStraight(300, 200); VWWait(); VWTurn(-72, 80); VWWait();\n \
        VWGetPosition(&x, &y, &phi); printf(\"%d %d %d\\n\", x, y, phi);\n }\n return 0;\n}\n";
    let scratch = Scratch::new();
    scratch.write("drive.c", DRIVE);
    scratch.write("a.wld", "floor 4000 4000\n");
    scratch.write("a.sim", "world a.wld\nS4 2000 2000 0 drive.c\n");
    let run = |args: &[&str]| {
        let report = scratch.report("a.sim", &[&["--trace", "t.jsonl"], args].concat(), 0);
        let said = scratch.trace("t.jsonl").into_iter().filter(|event| event["event"] == "stdout");
        let said: Vec<Value> = said.map(|event| event["text"].clone()).collect();
        (said, report["robots"][0].clone())
    };
    let (exact, _) = run(&[]);
    let (first, robot) = run(&["--noise", "course", "--seed", "1"]);
    assert_ne!(run(&["--noise", "course", "--seed", "2"]).0, first);
    assert_ne!(first, exact);
    assert_eq!(run(&["--noise", "course", "--seed", "1", "--slot", "7"]).0, first, "for every slot length");
    // The sides of a pentagon have errors of at most 4 mm, and their directions of at most 2, 4, 6 and 8 degrees. A side
    // of 300 mm whose direction is wrong by an angle ends at most 300 mm times this angle beside its end.
    let off = |what: &str| (number(&robot, &format!("{what}.x_m")), number(&robot, &format!("{what}.y_m")));
    let ((x, y), (odometry_x, odometry_y)) = (off("pose"), off("odometry"));
    assert!((x - 2.0).hypot(y - 2.0) < 0.02 + 0.3 * 20_f64.to_radians(), "{robot:#}");
    assert!((x - 2.0 - odometry_x).hypot(y - 2.0 - odometry_y) < 1e-9, "{robot:#}");
}
