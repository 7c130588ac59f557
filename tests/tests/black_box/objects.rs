//! Movable objects in whole runs: a ball is kicked into a goal, and crates are pushed or stall the wheels. The trace
//! records these events.

#![allow(clippy::disallowed_methods, reason = "distances by hand, compared within a tolerance")]

use serde_json::Value;
use tests::{Scratch, number, root, write_scene};

fn soccer(args: &[&str]) -> Value {
    let scene = root().join("sims/soccer.sim");
    Scratch::new().report(scene.to_str().expect("the checkout's path is text"), args, 0)
}

fn ball(report: &Value) -> [f64; 2] {
    ["pose.x_m", "pose.y_m"].map(|path| number(&report["objects"][0], path))
}

#[test]
fn the_ball_is_kicked_into_the_goal() {
    let report = soccer(&[]);
    let [x, y] = ball(&report);
    // The whole ball is behind the goal line at 2.6 m, between the posts.
    assert!(x > 2.65 && (0.45..0.95).contains(&y), "the ball lies at {x} {y}");
    let robots = report["robots"].as_array().expect("a report has robots");
    assert_eq!(robots.len(), 4);
    for robot in robots {
        assert_eq!(robot["outcome"], "finished", "{robot:#}");
    }
    assert_eq!(robots[0]["contacts"], 1, "the kick");
    for args in [&["--threads", "1"][..], &["--threads", "2"], &["--threads", "4"]] {
        assert_eq!(soccer(args)["digest"], report["digest"], "{args:?}");
    }
    for slot in ["1", "7.3", "20"] {
        let [other_x, other_y] = ball(&soccer(&["--slot", slot]));
        // When this limit was set, the positions were equal to the bit.
        let off = ((other_x - x).powi(2) + (other_y - y).powi(2)).sqrt();
        assert!(off < 0.001, "slots of {slot} ms: {other_x} {other_y} instead of {x} {y}");
    }
}

const PUSH: &str = r#"
#include "eyebot.h"
int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  VWSetSpeed(vw, 0.2, 0);
  OSWait(300);
  LCDSetPrintf(0, 0, "stalled %d", VWStalled(vw));
  VWDriveStraight(vw, -0.1, 0.2);
  VWDriveWait(vw);
  VWRelease(vw);
  return 0;
}
"#;

const CRATE: &str = "collider box 0 50 0 100 100 100\nfriction 0.5\nrestitution 0\n";

#[test]
fn a_light_crate_moves_and_a_heavy_one_stalls_the_wheels() {
    for (mass, is_stalled) in [(0.3, "0"), (5.0, "1")] {
        let scratch = Scratch::new();
        scratch.write("push.c", PUSH);
        write_scene(&scratch, &["push.c"]);
        scratch.write("box.esObj", &format!("name Box\nmass {mass} 0 50 0\n{CRATE}"));
        scratch.write("push.sim", "world room.wld\nobject box.esObj\nBox 700 400 0\nrobi bot.robi push.c 400 400 0\n");
        let report = scratch.report("push.sim", &["--trace", "trace.jsonl"], 0);
        let lcd = report["robots"][0]["lcd"][0].as_str().expect("a line");
        assert_eq!(lcd.trim(), format!("stalled {is_stalled}"), "{report:#}");
        let pushed = number(&report["objects"][0], "pose.x_m") - 0.7;
        if is_stalled == "0" {
            // The robot drives 0.6 m, of which 0.16 m lead to the crate.
            assert!((pushed - 0.44).abs() < 0.01, "{pushed}");
        } else {
            assert!((0.0..0.01).contains(&pushed), "{pushed}");
        }
        let lines = scratch.trace("trace.jsonl");
        let poses: Vec<_> = lines.iter().filter(|line| line["event"] == "object").collect();
        assert_eq!((poses[0]["t_s"].as_f64(), poses[0]["object"].as_u64()), (Some(0.0), Some(1)));
        assert!(poses[0].get("robot").is_none());
        assert!(poses.len() > 1);
        let contact = lines.iter().find(|line| line["event"] == "contact").expect("a contact");
        assert_eq!(contact["with"]["object"], 1);
    }
}

#[test]
fn a_fixed_object_is_a_wall() {
    let scratch = Scratch::new();
    scratch.write("push.c", PUSH);
    write_scene(&scratch, &["push.c"]);
    scratch.write("post.esObj", "name Post\nfixed\ncollider cylinder 0 50 0 50 100\n");
    scratch.write("push.sim", "world room.wld\nobject post.esObj\nPost 700 400 0\nrobi bot.robi push.c 400 400 0\n");
    let report = scratch.report("push.sim", &[], 0);
    assert_eq!(report["objects"], Value::Array(vec![]));
    assert_eq!(report["robots"][0]["lcd"][0].as_str().expect("a line").trim(), "stalled 1");
    // The robot stops at 0.56 m and drives back by 0.1 m.
    assert!((number(&report["robots"][0], "pose.x_m") - 0.46).abs() < 1e-3, "{report:#}");
}
