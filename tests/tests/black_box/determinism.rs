//! Equal inputs and seeds give equal digests: on one thread and two, watched or not, in debug and release builds.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tests::{Scratch, eyesim_path, write_crowd};

const AVOID: &str = "%sim%/example-programs/avoid";
const AVOID_C: &str = "%sim%/example-programs/avoid-c/avoid.c";

/// Drives about without reading sensors.
const BUMP_C: &str = r#"
#include "eyebot.h"
int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  int turn = 0;

  for (;;) {
    VWSetSpeed(vw, turn % 4 == 3 ? -0.2 : 0.3, turn % 3 - 1.0);
    turn += VWStalled(vw) ? 1 : OSMachineID() % 5 == 0;
    OSWait(20);
  }
}
"#;

/// Runs `crowd.sim` of `scratch` with `binary` and returns the run's digest.
fn digest_with(binary: &Path, scratch: &Scratch, args: &[&str]) -> String {
    let mut command = Command::new(binary);
    command.args(["run", "crowd.sim", "--report", "report.json", "--until", "10"]).args(args);
    let output = command.current_dir(scratch.path()).output().expect("eyesim starts");
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
    report["digest"].as_str().expect("a digest").to_owned()
}

fn digest(scratch: &Scratch, args: &[&str]) -> String {
    digest_with(eyesim_path(), scratch, args)
}

/// Makes twenty runs, on one, two and eight threads, and asserts equal digests. Another seed must change the digest.
fn assert_same_twenty_times(robots: usize) {
    let scratch = Scratch::new();
    write_crowd(&scratch, robots, AVOID);
    let first = digest(&scratch, &["--threads", "1"]);
    for run in 1..20 {
        let threads = ["2", "1", "8"][run % 3];
        assert_eq!(digest(&scratch, &["--threads", threads]), first, "run {run}, {threads} threads");
    }
    assert_ne!(digest(&scratch, &["--seed", "1"]), first, "another seed is another run");
}

#[test]
fn one_robot_gives_the_same_digest_twenty_times() {
    assert_same_twenty_times(1);
}

#[test]
fn a_hundred_robots_give_the_same_digest_twenty_times() {
    assert_same_twenty_times(100);
}

#[test]
fn c_programs_with_random_numbers_give_the_same_digest_on_one_thread_and_two() {
    let scratch = Scratch::new();
    write_crowd(&scratch, 30, AVOID_C);
    let first = digest(&scratch, &["--threads", "1"]);
    for threads in ["2", "2", "2", "1"] {
        assert_eq!(digest(&scratch, &["--threads", threads]), first);
    }
}

#[test]
fn the_end_of_a_slot_gives_the_same_digest_on_any_number_of_workers() {
    let scratch = Scratch::new();
    scratch.write("bump.c", BUMP_C);
    // The crowd is large enough that workers share loops over the robots, and dense enough that robots collide and
    // block each other.
    let mut sim = String::from("world crowd.wld\n");
    for index in 0..160 {
        let (x, y) = (400 * (index % 16) + 300, 400 * (index / 16) + 300);
        sim += &format!("robi %sim%/robis/ring.robi bump.c {x} {y} {}\n", index * 137 % 360);
    }
    scratch.write("crowd.sim", &sim);
    scratch.write("crowd.wld", "floor 6600 4200\n0 0 6600 0\n6600 0 6600 4200\n6600 4200 0 4200\n0 4200 0 0\n");
    let first = digest(&scratch, &["--exec", "fiber", "--threads", "1", "--trace", "t.jsonl"]);
    let contacts = scratch.trace("t.jsonl").iter().filter(|line| line["event"] == "contact").count();
    assert!(contacts > 100, "{contacts} contacts");
    for args in [["fiber", "2"], ["fiber", "3"], ["fiber", "2"], ["thread", "2"]] {
        assert_eq!(digest(&scratch, &["--exec", args[0], "--threads", args[1]]), first, "{args:?}");
    }
}

#[test]
fn observers_do_not_change_the_digest() {
    let scratch = Scratch::new();
    write_crowd(&scratch, 9, AVOID);
    let first = digest(&scratch, &[]);
    assert_eq!(digest(&scratch, &["--trace", "t.jsonl"]), first);
    assert_eq!(digest(&scratch, &["-v"]), first);
    assert_eq!(digest(&scratch, &["-v", "--only", "PSD*", "--trace", "t.jsonl", "--plot", "p.svg"]), first);
    assert_eq!(digest(&scratch, &["--speed", "20"]), first, "nor does pacing");
    // The trace contains the same digest.
    let trace = scratch.trace("t.jsonl");
    assert_eq!(trace.last().expect("a trace has lines")["digest"], Value::String(first));
}

/// The binary of the other profile, if it exists; it may be out of date.
fn other_profile() -> Option<PathBuf> {
    let here = eyesim_path();
    let (folder, name) = (here.parent()?, here.file_name()?);
    let other = if folder.ends_with("release") { "debug" } else { "release" };
    let path = folder.with_file_name(other).join(name);
    path.is_file().then_some(path)
}

#[test]
fn debug_and_release_give_the_same_digest() {
    let Some(other) = other_profile() else {
        println!(
            "skipped: eyesim is not built in the other profile (cargo build -p eyesim, with and without --release)"
        );
        return;
    };
    let scratch = Scratch::new();
    write_crowd(&scratch, 20, AVOID);
    assert_eq!(digest(&scratch, &[]), digest_with(&other, &scratch, &[]), "{} is out of date?", other.display());
}

#[test]
fn robots_with_numbers_give_the_same_run_in_any_listed_order() {
    const RING: &str = "%sim%/robis/ring.robi";
    const WALL_C: &str = "%sim%/example-programs/follow-wall-c/follow-wall.c";
    const SQUARE_C: &str = "%sim%/example-programs/square-c/square.c";
    let scratch = Scratch::new();
    let robots = [
        (1, RING, AVOID_C, "x_mm = 500\ny_mm = 500\nheading_deg = 30"),
        (2, RING, WALL_C, "noise = { base = \"harsh\", psd = { sigma_mm = 20 } }"),
        (3, RING, AVOID, "layout = { kind = \"random\", clearance_mm = 100 }"),
        (4, "S4", SQUARE_C, ""),
        (5, RING, AVOID_C, "layout = { kind = \"random\" }"),
        (6, RING, AVOID_C, ""),
    ];
    let run = |name: &str, indices: [usize; 6], has_ids: bool| {
        let mut scene = "[scene]\nseed = 3\nnoise = \"real\"\n[world]\nfloor_mm = [3000, 3000]\n\
                         wall = [{ from_mm = [0, 0], to_mm = [3000, 0] }, { from_mm = [3000, 0], to_mm = [3000, 3000] },\n\
                         { from_mm = [3000, 3000], to_mm = [0, 3000] }, { from_mm = [0, 3000], to_mm = [0, 0] }]\n\
                         start = [{ x_mm = 1500, y_mm = 300 }, { x_mm = 2500, y_mm = 1500, heading_deg = 90 },\n\
                         { x_mm = 1500, y_mm = 1500, heading_deg = 200 }]\n"
            .to_owned();
        for (id, kind, program, keys) in indices.map(|index| robots[index]) {
            let id = if has_ids { format!("id = {id}\n") } else { String::new() };
            scene += &format!("[[robot]]\ntype = \"{kind}\"\nprogram = \"{program}\"\n{id}{keys}\n");
        }
        scratch.write(name, &scene);
        let report = scratch.report(name, &["--until", "10", "--trace", "t.jsonl"], 0);
        // The traces' first lines differ, since they name the file.
        let trace = scratch.read("t.jsonl");
        let (_, events) = trace.split_once('\n').expect("a header");
        (report["digest"].clone(), report["robots"].clone(), events.to_owned())
    };
    let first = run("a.scene.toml", [0, 1, 2, 3, 4, 5], true);
    assert_eq!(first.1.as_array().expect("robots").len(), robots.len());
    assert!(first.1.as_array().into_iter().flatten().any(|robot| robot["path_m"].as_f64() > Some(1.0)), "they drive");
    assert_eq!(run("b.scene.toml", [5, 4, 3, 2, 1, 0], true), first);
    assert_eq!(run("c.scene.toml", [2, 5, 0, 4, 1, 3], true), first);
    assert_eq!(run("d.scene.toml", [0, 1, 2, 3, 4, 5], false), first, "that is what they are without numbers");
    assert_ne!(run("e.scene.toml", [5, 4, 3, 2, 1, 0], false).0, first.0, "it is the numbers that count");
}
