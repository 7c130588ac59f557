//! Readings of range sensors in programs of both generations and in Python, compared with closed forms.
#![allow(clippy::disallowed_methods, reason = "distances by hand, compared within millimetres")]

use std::process::Command;

use tests::{Scratch, root};

/// Height of the sensors on the arm, in metres.
const HEIGHT: f64 = 0.3;
/// Distance of the step's face, in metres.
const FACE: f64 = 0.5;
/// Height of the step, in metres.
const STEP: f64 = 0.2;

fn scene(name: &str) -> String {
    root().join("sims").join(name).to_str().expect("the checkout's path is text").to_owned()
}

/// The lines that each robot printed.
fn printed(scratch: &Scratch, sim: &str, args: &[&str]) -> Vec<Vec<String>> {
    let trace = [&["--trace", "trace.jsonl"], args].concat();
    let report = scratch.report(sim, &trace, 0);
    let count = report["robots"].as_array().expect("robots").len();
    let mut lines = vec![Vec::new(); count];
    for event in scratch.trace("trace.jsonl").iter().filter(|event| event["event"] == "stdout") {
        let robot = event["robot"].as_u64().expect("a robot") as usize;
        lines[robot - 1].push(event["text"].as_str().expect("a text").to_owned());
    }
    lines
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.trim_end_matches(':').parse().ok()).collect()
}

/// Distance and incidence angle of the hit of a ray inclined by `down` rad below the horizon. The end wall is out of
/// range of all sensors.
fn met(down: f64) -> (f64, f64) {
    let at_face = HEIGHT - FACE * down.tan();
    if at_face > STEP {
        return ((HEIGHT - STEP) / down.sin(), std::f64::consts::FRAC_PI_2 - down);
    }
    if at_face > 0.0 { (FACE / down.cos(), down) } else { (HEIGHT / down.sin(), std::f64::consts::FRAC_PI_2 - down) }
}

/// Readings of the laser, ultrasonic and reflectance sensor, and the signal of the reflectance sensor.
fn readings(down: f64) -> [f64; 4] {
    let (distance, incidence) = met(down);
    let echo = |[min, max]: [f64; 2], limit: f64| {
        let is_heard = (min..=max).contains(&distance) && incidence <= limit.to_radians();
        1e3 * if is_heard { distance } else { max }
    };
    let signal = if distance < 1.0 { (1.0 - distance) / distance.powi(2) * incidence.cos().powi(2) } else { 0.0 };
    let recovered = 2.0 / (1.0 + (1.0 + 4.0 * signal).sqrt());
    [echo([0.0, 2.0], 45.0), echo([0.1, 1.0], 15.0), 1e3 * recovered, signal]
}

/// Angle of the arm below the horizon at a position of its servo, in rad.
fn arm(position: f64) -> f64 {
    let fraction = if position <= 127.0 { (position - 127.0) / 127.0 } else { (position - 128.0) / 127.0 };
    (30.0 - 30.0 * fraction).to_radians()
}

/// Compares lines `POSITION LASER ULTRASONIC REFLECTANCE SIGNAL` with the closed forms.
fn assert_sweep(lines: &[String]) {
    assert_eq!(lines.len(), 22, "{lines:?}");
    for line in lines {
        let read = numbers(line);
        let expected = readings(arm(read[0]));
        for (read, expected) in read[1..4].iter().zip(&expected) {
            // Readings are whole millimetres.
            assert!((read - expected).abs() <= 0.501, "{line}: {expected:?}");
        }
        assert!((read[4] - expected[3]).abs() < 0.002, "{line}: {expected:?}");
    }
}

#[test]
fn readings_of_the_papers_sensors_at_the_step_match_closed_forms() {
    let lines = &printed(&Scratch::new(), &scene("step.scene.toml"), &[])[0][1..];
    assert_sweep(lines);
    let column = |at: usize| lines.iter().map(move |line| numbers(line)[at]);
    // The laser loses the floor beyond 45 degrees of incidence. The ultrasonic sensor detects only the face of the
    // step.
    assert!(column(1).take(6).all(|mm| mm < 500.0) && column(1).skip(6).take(5).all(|mm| mm == 2000.0));
    assert!(column(2).all(|mm| mm == 1000.0 || (500.0..520.0).contains(&mm)));
    assert!(column(2).any(|mm| mm < 1000.0));
    // At an oblique surface, the reflectance sensor reads too far.
    assert!(lines.iter().map(|line| numbers(line)).all(|read| read[1] == 2000.0 || read[3] >= read[1]));
}

/// Writes the scene of the step with another program.
fn with_program(scratch: &Scratch, program: &str, text: &str, api: &str) {
    let sim = std::fs::read_to_string(root().join("sims/step.scene.toml")).expect("the scene");
    scratch.write(program, text);
    let sim = sim.replace("%sim%/example-programs/step-sweep/step-sweep.c", program).replace("api = 7", api);
    scratch.write("step.scene.toml", &sim);
}

/// For each position of the arm, reads all sensors of the arm in one cycle.
const SWEEP6: &str = r#"#include "eyebot.h"
#include <stdio.h>
int main(void)
{
  PSDHandle sensors[3], all = 0;
  ServoHandle arm = SERVOInit(SERVO2);
  int i, position;
  for (i = 0; i < 3; i++)
    all |= sensors[i] = PSDInit(2 + i);
  for (position = 0; position <= 255; position += 12) {
    SERVOSet(arm, position);
    PSDStart(all, FALSE);
    while (!PSDCheck())
      ;
    printf("%d %d %d %d %.3f\n", position, PSDGet(sensors[0]), PSDGet(sensors[1]), PSDGet(sensors[2]),
           PSDGetSignal(sensors[2]));
  }
  return 0;
}
"#;

#[test]
fn robios_6_reads_them_in_cycles() {
    let scratch = Scratch::new();
    with_program(&scratch, "sweep.c", SWEEP6, "api = 6");
    assert_sweep(&printed(&scratch, "step.scene.toml", &[])[0]);
}

#[test]
fn python_programs_read_the_sensors() {
    if !Command::new("python3").arg("-V").output().is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: no python3");
        return;
    }
    let scratch = Scratch::new();
    let program = "from eye import *\nfor position in range(0, 256, 12):\n    SERVOSet(2, position)\n    \
                   print(position, PSDGet(2), PSDGet(3), PSDGet(4), f\"{PSDGetSignal(4):.3f}\")\n";
    with_program(&scratch, "sweep.py", program, "api = 7");
    assert_sweep(&printed(&scratch, "step.scene.toml", &[])[0]);
}

/// A reading belongs to the end of its cycle. The arm turns after that, so only the next cycle measures the new
/// position.
const LATE: &str = r#"#include "eyebot.h"
#include <stdio.h>
int main(void)
{
  PSDHandle laser = PSDInit(2);
  ServoHandle arm = SERVOInit(SERVO2);
  SERVOSet(arm, 0);
  PSDStart(laser, TRUE);
  while (!PSDCheck())
    ;
  SERVOSet(arm, 60);
  printf("%d\n", PSDGet(laser));
  OSWait(7);
  printf("%d\n", PSDGet(laser));
  return 0;
}
"#;

#[test]
fn a_reading_uses_the_angle_at_its_instant() {
    for slot in ["1", "50", "1000"] {
        let scratch = Scratch::new();
        with_program(&scratch, "late.c", LATE, "api = 6");
        let lines = printed(&scratch, "step.scene.toml", &["--slot", slot]).remove(0);
        let expected = [0.0, 60.0].map(|position| readings(arm(position))[0].round().to_string());
        assert_eq!(lines, expected, "slots of {slot} ms");
    }
}

/// Calls with wrong handles and numbers and too small buffers, and the scanner in RoBIOS 6.
const EDGES: &str = r#"#include "eyebot.h"
#include <stdio.h>
int main(void)
{
  int distances[182], i, points;
  PSDHandle sonar = PSDInit(5);
  for (i = 0; i < 182; i++)
    distances[i] = -7;
  printf("%d %.0f %.0f\n", PSDInit(99), PSDGetSignal(sonar), PSDGetSignal(12345));
  printf("%d %d %d\n", LIDARScan(0, 10), LIDARScan(distances, 0), LIDARScan(distances, -5));
  points = LIDARScan(distances, 3);
  printf("%d %d %d\n", points, distances[2] > 0, distances[3]);
  points = LIDARScan(distances, 182);
  printf("%d %d %d %d\n", points, distances[0], distances[90], distances[180]);
  return 0;
}
"#;

#[test]
fn our_functions_check_their_arguments() {
    let scratch = Scratch::new();
    with_program(&scratch, "edges.c", EDGES, "api = 6");
    let lines = printed(&scratch, "step.scene.toml", &[]).remove(0);
    // The scanner is 1 m from the walls at its sides; these and the step ahead are 200 mm high, like the scanner.
    assert_eq!(lines, ["0 -1 -1", "-1 -1 -1", "180 1 -7", "180 1000 500 -7"]);
}

#[test]
fn a_sonar_on_a_servo_hears_the_same_from_c_and_from_rust() {
    let scratch = Scratch::new();
    let sim = std::fs::read_to_string(root().join("sims/sonar-sweep.sim")).expect("the scene");
    // Runs both programs one after the other, each at the first robot's place.
    let [c, rust] = ["sonar-sweep-c", "sonar-sweep "].map(|program| {
        let is_kept = |line: &&str| !line.starts_with("robi") || line.contains(program);
        let lines: Vec<&str> = sim.lines().filter(is_kept).collect();
        scratch.write("one.sim", &(lines.join("\n").replace("600 2300 0", "600 700 0") + "\n"));
        printed(&scratch, "one.sim", &[]).remove(0)
    });
    assert_eq!(c.len(), 19);
    assert_eq!(c, rust);
    // The sensor head is 60 mm ahead of the robot's centre. A table is 340 mm in front of the head, a wall 700 mm to
    // its right.
    assert_eq!((numbers(&c[9])[1], numbers(&c[0])[1]), (340.0, 700.0), "{c:?}");
    let both = printed(&scratch, &scene("sonar-sweep.sim"), &[]);
    assert!(both.iter().all(|lines| lines.len() == 19));
}

/// Writes a scene with a robot that has 34 range sensors, the PSD and lasers 2 to 34, and runs `program`.
fn many_sensors(scratch: &Scratch, program: &str, api: &str) {
    with_program(scratch, "many.c", &format!("#include \"eyebot.h\"\n#include <stdio.h>\n{program}"), api);
    let sim = scratch.read("step.scene.toml");
    scratch.write("step.scene.toml", &sim.replace("%sim%/robis/watcher.robi", "many.robi"));
    scratch.write("many.robi", &std::fs::read_to_string(root().join("robis/watcher.robi")).expect("the robi"));
    let lasers =
        (2..=34).map(|id| format!("[[laser]]\nname = \"L{id}\"\nid = {id}\nz_mm = 300\nmax_mm = {}\n", 100 + id));
    scratch.write("many.toml", &lasers.collect::<String>());
}

#[test]
fn more_sensors_than_handles_are_reported() {
    let scratch = Scratch::new();
    let program =
        "int main(void)\n{\n  printf(\"%d %d %d\\n\", PSDInit(2), PSDInit(31), PSDInit(32));\n  return 0;\n}\n";
    many_sensors(&scratch, program, "api = 6");
    assert_eq!(printed(&scratch, "step.scene.toml", &[])[0], ["2 1073741824 0"]);
    let ran = scratch.eyesim(&["run", "step.scene.toml"]);
    assert!(ran.stderr.contains("a handle is a bit, and the first 31 range sensors of `many.robi`"), "{ran:#?}");
}

#[test]
fn all_of_many_sensors_have_numbers_in_robios_7() {
    let scratch = Scratch::new();
    let program = "int main(void)\n{\n  printf(\"%d %d %d %d\\n\", PSDGet(2), PSDGet(31), PSDGet(34), PSDGet(35));\n  return 0;\n}\n";
    many_sensors(&scratch, program, "api = 7");
    assert_eq!(printed(&scratch, "step.scene.toml", &[])[0], ["102 131 134 0"]);
}
