//! The same inputs and seed give the same digest: on one thread and two, watched or not, in debug and in release.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tests::{Scratch, eyesim_path, write_crowd};

const AVOID: &str = "%sim%/example-programs/avoid";
const AVOID_C: &str = "%sim%/example-programs/avoid-c/avoid.c";

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

/// Twenty runs, in turn on one thread, two and more than there are processors.
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
fn who_watches_changes_nothing() {
    let scratch = Scratch::new();
    write_crowd(&scratch, 9, AVOID);
    let first = digest(&scratch, &[]);
    assert_eq!(digest(&scratch, &["--trace", "t.jsonl"]), first);
    assert_eq!(digest(&scratch, &["-v"]), first);
    assert_eq!(digest(&scratch, &["-v", "--only", "PSD*", "--trace", "t.jsonl", "--plot", "p.svg"]), first);
    assert_eq!(digest(&scratch, &["--speed", "20"]), first, "nor does pacing");
    // The trace says the same.
    let trace = scratch.trace("t.jsonl");
    assert_eq!(trace.last().expect("a trace has lines")["digest"], Value::String(first));
}

/// The binary of the other profile beside the one under test, if it has been built from this state of the sources.
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
            "skipped: eyesim is not built in the other profile (cargo build -p sim-host, with and without --release)"
        );
        return;
    };
    let scratch = Scratch::new();
    write_crowd(&scratch, 20, AVOID);
    assert_eq!(digest(&scratch, &[]), digest_with(&other, &scratch, &[]), "{} is out of date?", other.display());
}
