//! Robots and movable objects that a user adds to a run and removes from it: equal results on threads and in processes,
//! in sensors and in the numbers that programs use.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tests::{Ran, Scratch, number};

fn write_interventions(scratch: &Scratch, actions: &[(f64, Value)]) {
    let header = json!({"event": "header", "schema": 1, "eyesim_version": env!("CARGO_PKG_VERSION"), "seed": 0, "slot_us": 50_000, "robots": []});
    let line = |(t_s, action): &(f64, Value)| {
        json!({"t_s": t_s, "event": "intervention", "action": action}).to_string() + "\n"
    };
    let lines: String = actions.iter().map(line).collect();
    scratch.write("interventions.jsonl", &format!("{header}\n{lines}"));
}

fn add_robot(kind: &str, program_of: Option<u32>, x_m: f64, y_m: f64) -> Value {
    json!({"do": "add_robot", "kind": kind, "program_of": program_of, "x_m": x_m, "y_m": y_m, "phi_rad": 0.0})
}

fn add_object(kind: &str, x_m: f64, y_m: f64) -> Value {
    json!({"do": "add_object", "kind": kind, "x_m": x_m, "y_m": y_m, "phi_rad": 0.0})
}

fn remove_robot(robot: u32) -> Value {
    json!({"do": "remove_robot", "robot": robot})
}

fn remove_object(object: u32) -> Value {
    json!({"do": "remove_object", "object": object})
}

/// Writes a scene with these lines of robots in a room of 4 m; each robot has a camera and a front distance sensor.
fn scene(robots: &str, programs: &[(&str, &str)]) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write(
        "bot.robi",
        "name Bot\ndiameter 180\nspeed 600\nturn 300\naxis 0\npsd PSD_FRONT -200 60 0 30 0\ncamera 60 0 60 0 0 80 60\n\
         wheel 54 3600 1100 90\ndrive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n",
    );
    scratch.write("scene.sim", &format!("world room.wld\n{robots}"));
    programs.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
    scratch
}

/// Drives, sends and receives forever.
const TALK: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    RADIOInit();
    for (int i = 0; i < 12; i++) {
        BYTE mes[MAXMSGLEN] = {i}, id, len;
        VWDriveStraight(vw, i % 2 ? -0.2 : 0.2, 0.4);
        RADIOSend(BROADCAST, 1, mes);
        OSWait(50);
        while (RADIOCheck()) { RADIORecv(&id, (int *) &len, mes); LCDPrintf("%d.%d ", id, mes[0]); }
    }
    return 0;
}
"#;

#[test]
fn a_run_with_spawned_robots_is_the_same_on_threads_and_in_processes() {
    let scratch = scene("robi bot.robi talk.c 500 500 0\nrobi bot.robi talk.c 500 1500 0\n", &[("talk.c", TALK)]);
    write_interventions(
        &scratch,
        &[
            (1.0, add_robot("Bot", Some(1), 0.5, 2.5)),
            (1.0, add_object("Golf", 0.65, 2.5)),
            (1.5, add_robot("S4", Some(2), 0.5, 3.5)),
            (2.05, remove_robot(2)),
            (3.0, remove_object(1)),
            (4.0, remove_robot(3)),
            (4.5, add_robot("Bot", Some(3), 0.5, 1.5)),
        ],
    );
    let run = |args: &[&str]| {
        let args = [&["--repeat", "interventions.jsonl", "--trace", "trace.jsonl"], args].concat();
        scratch.report("scene.sim", &args, 0)
    };
    let report = run(&["--threads", "1"]);
    let outcomes: Vec<&str> = report["robots"]
        .as_array()
        .map_or(Vec::new(), |robots| robots.iter().filter_map(|robot| robot["outcome"].as_str()).collect());
    assert_eq!(outcomes, ["finished", "removed", "removed", "finished", "finished"]);
    let times = |key: &str| -> Vec<f64> { (1..4).map(|robot| number(&report["robots"][robot], key)).collect() };
    assert_eq!(report["robots"][1]["removed_s"], 2.05);
    assert_eq!(report["robots"][1]["added_s"], Value::Null);
    assert_eq!(times("virtual_time_s")[0], 2.05);
    assert_eq!((&report["robots"][2]["added_s"], &report["objects"][0]["added_s"]), (&json!(1.0), &json!(1.0)));
    assert!(number(&report["objects"][0], "pose.x_m") > 0.7, "the robot has pushed the ball: {:#}", report["objects"]);
    let messages = scratch.trace("trace.jsonl").into_iter();
    let messages: Vec<Value> = messages.filter(|line| line["event"] == "radio_received").collect();
    let from =
        |from: u32| messages.iter().filter(move |line| line["from"] == from).filter_map(|line| line["t_s"].as_f64());
    assert!(from(3).count() > 5 && from(3).all(|t| t > 1.0 && t < 4.7), "the third is heard while it is there");
    assert!(from(2).all(|t| t < 2.7), "the second is not heard any more: {messages:#?}");
    for args in [&["--threads", "2"][..], &["--exec", "process"], &["--exec", "process", "--threads", "1"]] {
        let other = run(args);
        assert_eq!(other["robots"], report["robots"], "{args:?}");
        assert_eq!(other["digest"], report["digest"], "{args:?}");
    }
}

/// Every second, shows the number of the body in the middle of the image.
const SEE: &str = r#"
#include "eyebot.h"
static int labels[60 * 80];
int main(void) {
    static colimage image;
    CAMInit(NORMAL);
    for (int i = 0; i < 4; i++) {
        OSWait(100);
        CAMGetColFrame(&image, 0);
        CAMGetLabels(labels);
        LCDPrintf("%d ", labels[30 * 80 + 40] - CAM_BODY);
    }
    return 0;
}
"#;

#[test]
fn cameras_see_spawned_robots_and_objects_only_while_they_exist() {
    let scratch = scene("robi bot.robi see.c 500 2000 0\n", &[("see.c", SEE)]);
    write_interventions(
        &scratch,
        &[
            (1.5, add_object("Crate", 1.5, 2.0)),
            (2.5, remove_object(1)),
            (2.5, add_robot("Bot", None, 1.0, 2.0)),
            (3.5, remove_robot(2)),
        ],
    );
    let report = scratch.report("scene.sim", &["--repeat", "interventions.jsonl"], 0);
    let lcd: Vec<&str> = report["robots"][0]["lcd"]
        .as_array()
        .map_or(Vec::new(), |lines| lines.iter().filter_map(Value::as_str).collect());
    let lcd = lcd.concat();
    let seen: Vec<i64> = lcd.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    // The scene starts with one robot, so programs number the crate 2 and the robot added after it 3.
    assert!(matches!(seen[..], [wall, 2, 3, again] if wall < 0 && again == wall), "{lcd}");
}

const NUMBERS: &str = r#"
#include "eyebot.h"
int main(void) {
    for (int i = 0; i < 3; i++) {
        OSWait(1000);
        int x = -1, y = -1, z, phi, a = -1;
        SIMGetRobot(3, &x, &y, &z, &phi);
        SIMGetObject(4, &a, &y, &z, &phi);
        LCDPrintf("%d %d %d %d; ", SIMGetRobotCount(), SIMGetObjectCount(), x, a);
    }
    SIMSetObject(4, 3000, 3000, 0, 0);
    OSWait(200);
    return 0;
}
"#;

#[test]
fn programs_of_robios_7_see_spawned_entities_under_new_numbers() {
    let robots = "robi bot.robi numbers.c 500 500 0\nrobi bot.robi numbers.c 500 1500 0\n";
    let scratch = scene(robots, &[("numbers.c", NUMBERS)]);
    write_interventions(
        &scratch,
        &[(1.5, add_robot("Bot", None, 1.2, 1.0)), (1.5, add_object("Can", 2.0, 1.0)), (2.5, remove_robot(3))],
    );
    let report = scratch.report("scene.sim", &["--repeat", "interventions.jsonl"], 0);
    let lcd = report["robots"][0]["lcd"].to_string();
    assert!(lcd.contains("2 0 -1 -1; 2 0 1200 2000; 2 0 -1 2000;"), "{lcd}");
    assert_eq!(number(&report["objects"][0], "pose.x_m"), 3.0);
}

/// Computes forever, until the robot is removed.
const STAYS: &str = r#"
#include "eyebot.h"
struct Stays { ~Stays() { for (volatile int i = 0; ; i = i + 1); } };
int main() { Stays stays; KEYGet(); return 0; }
"#;

#[test]
fn a_removed_program_that_does_not_exit_is_abandoned() {
    let robots = "robi bot.robi talk.c 500 500 0\nrobi bot.robi stays.cpp 500 1500 0\n";
    let scratch = scene(robots, &[("talk.c", TALK), ("stays.cpp", STAYS)]);
    write_interventions(&scratch, &[(1.0, remove_robot(2))]);
    for exec in ["thread", "process"] {
        let began = Instant::now();
        let ran: Ran = scratch.eyesim(&[
            "run",
            "scene.sim",
            "--repeat",
            "interventions.jsonl",
            "--exec",
            exec,
            "--report",
            "r.json",
        ]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        assert!(ran.stderr.contains("did not exit: its thread is abandoned"), "{ran:#?}");
        assert!(began.elapsed() < Duration::from_secs(200), "it is not waited for");
        let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
        let outcomes = [0, 1].map(|robot: usize| report["robots"][robot]["outcome"].clone());
        assert_eq!(outcomes, ["finished", "removed"], "{exec}");
    }
}

/// Sends ten messages at once, and drives on after its end.
const SEND: &str = r#"
#include "eyebot.h"
int main(void) {
    RADIOInit();
    for (int i = 0; i < 10; i++) RADIOSend(2, "a message");
    VWSetSpeed(300, 0);
    return 0;
}
"#;

/// Sends ten messages, and drives until it is stopped.
const SEND_FOREVER: &str = r#"
#include "eyebot.h"
int main(void) {
    RADIOInit();
    for (int i = 0; i < 10; i++) RADIOSend(2, "a message");
    VWSetSpeed(300, 0);
    for (;;) OSWait(100);
}
"#;

/// Counts messages for 4 s.
const COUNT: &str = r#"
#include "eyebot.h"
int main(void) {
    int from;
    char text[32];
    RADIOInit();
    OSWait(4000);
    int count = 0;
    for (; RADIOCheck() > 0; count++) RADIOReceive(&from, text, 32);
    LCDPrintf("%d", count);
    return 0;
}
"#;

#[test]
fn a_removed_robot_sends_no_more_and_keeps_its_pose_and_outcome() {
    let programs = [("send.c", SEND), ("forever.c", SEND_FOREVER), ("count.c", COUNT)];
    let scratch = scene("", &programs);
    let run = |program: &str, fault: &str| {
        let robot = |program: &str, y_mm: u32| {
            format!("[[robot]]\ntype = \"S4\"\nprogram = \"{program}\"\nx_mm = 500\ny_mm = {y_mm}\n")
        };
        let world = "[world]\nfloor_mm = [4000, 4000]\n[radio]\nmedium = \"aloha\"\nbaud = 300\n";
        let text = format!("{world}{}{}{fault}", robot(program, 500), robot("count.c", 1500));
        scratch.write("radio.scene.toml", &text);
        write_interventions(&scratch, &[(1.0, remove_robot(1))]);
        let report = scratch.report("radio.scene.toml", &["--repeat", "interventions.jsonl", "--until", "5"], 0);
        let [removed, counts] = [0, 1].map(|index| report["robots"][index].clone());
        let lcd = counts["lcd"][0].as_str().unwrap_or_default().to_owned();
        let ended_at = number(&removed, "virtual_time_s");
        (removed["outcome"].clone(), number(&removed, "pose.x_m"), lcd, ended_at)
    };
    // The second of the messages of half a second is on the air.
    let (outcome, x, count, ended_at) = run("forever.c", "");
    assert!(outcome == "removed" && (x - 0.8).abs() < 0.01 && count == "2", "{outcome} {x} {count}");
    assert!((ended_at - 1.0).abs() < 0.1, "{ended_at}");
    let (outcome, x, _, ended_at) = run("send.c", "");
    assert!(outcome == "finished" && (x - 0.8).abs() < 0.01 && ended_at < 0.1, "{outcome} {x} {ended_at}");
    let (outcome, x, ..) = run("forever.c", "[[fault]]\nkind = \"dies\"\nat_s = 0.5\n");
    assert!(outcome == "halted" && (x - 0.65).abs() < 0.01, "{outcome} {x}");
    let (outcome, x, _, ended_at) = run("send.c", "[[fault]]\nkind = \"dies\"\nat_s = 0.5\n");
    assert!(outcome == "finished" && (x - 0.65).abs() < 0.01 && ended_at < 0.1, "{outcome} {x} {ended_at}");
}
