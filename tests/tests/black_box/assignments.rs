//! Assignments of a course with ten submissions each: their suites give the right verdicts for every seed.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tests::{Scratch, root};

/// Seeds of the runs; the environment variable `EYESIM_SEEDS=1..20` sets twenty.
fn seeds() -> String {
    std::env::var("EYESIM_SEEDS").unwrap_or_else(|_| "1..3".to_owned())
}

/// Runs the suite of an assignment with each submission. The first line of a submission contains its expected rows.
fn judge(assignment: &str) {
    let folder = root().join("tests/fixtures/assignments").join(assignment);
    let scratch = Scratch::new();
    let copy = |name: &str| scratch.write(name, &fs::read_to_string(folder.join(name)).expect("a file"));
    copy(&format!("{assignment}.scene.toml"));
    let suite_name = format!("{assignment}.suite.toml");
    copy(&suite_name);
    let suite = scratch.read(&suite_name);
    assert!(suite.contains("\"1..3\""), "seeds of the suite");
    scratch.write(&suite_name, &suite.replace("1..3", &seeds()));
    let mut count = 0;
    for entry in fs::read_dir(&folder).expect("the folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "c") {
            submission(&scratch, &suite_name, &path);
            count += 1;
        }
    }
    assert_eq!(count, 10, "submissions of {assignment}");
}

fn submission(scratch: &Scratch, suite: &str, path: &Path) {
    let text = fs::read_to_string(path).expect("a program");
    let expected = text.lines().next().and_then(|line| line.strip_prefix("// expected: ")).expect("a verdict");
    let name = path.file_name().expect("a name").to_str().expect("plain text");
    scratch.write(name, &text);
    let program = format!("1={name}");
    let ran = scratch.eyesim(&["test", suite, "--program", &program, "--report", "r.json"]);
    let (outcome, checks) = expected.split_once(": ").unwrap_or((expected, ""));
    assert_eq!(ran.code, Some(i32::from(outcome != "passed")), "{name}: {ran:#?}");
    let checks: BTreeSet<&str> = checks.split(", ").filter(|check| !check.is_empty()).collect();
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let rows = report["suites"][0]["rows"].as_array().expect("rows");
    assert!(rows.len() >= 6, "{name}");
    for row in rows {
        assert_eq!(row["outcome"], outcome, "{name}: {row:#}");
        let is_failure =
            |robot: &Value| !["finished", "running"].contains(&robot["outcome"].as_str().expect("an outcome"));
        let has_failed = row["robots"].as_array().expect("robots").iter().any(is_failure);
        assert_eq!(has_failed, expected == "failed", "{name}: {row:#}");
        let failed: BTreeSet<&str> = row["checks"]
            .as_array()
            .expect("checks")
            .iter()
            .filter(|check| check["passed"] == false)
            .map(|check| check["name"].as_str().expect("a name"))
            .collect();
        if outcome != "failed" || !checks.is_empty() {
            assert_eq!(failed, checks, "{name}: {row:#}");
        }
        let message = row["message"].as_str().expect("a message");
        assert_eq!(message.is_empty(), outcome == "passed", "{name}: {row:#}");
    }
}

#[test]
fn reach_a_goal() {
    judge("reach");
}

#[test]
fn drive_laps() {
    judge("laps");
}

#[test]
fn cover_a_lawn() {
    judge("coverage");
}

#[test]
fn print_a_grid() {
    judge("grid");
}
