//! The README's programs behave as described there.

use std::fs;

use tests::{Scratch, number, root};

/// The first block of the README in `language`.
fn block(language: &str) -> String {
    let readme = fs::read_to_string(root().join("README.md")).expect("a README");
    let start = format!("\n```{language}\n");
    let (_, rest) = readme.split_once(&start).unwrap_or_else(|| panic!("no block in `{language}`"));
    rest.split_once("\n```").expect("a block ends").0.to_owned() + "\n"
}

/// Checks the final state of robot 1 in the README's scene.
fn check(report: &serde_json::Value) {
    let robot = &report["robots"][0];
    assert!((number(robot, "pose.x_m") - 3.3).abs() < 1e-6, "drove half a metre: {robot:#}");
    assert_eq!(robot["contacts"], 0);
    let line = robot["lcd"][0].as_str().expect("a line of text").trim();
    assert!(line.starts_with("wall in ") && line.ends_with(" mm"), "`{line}`");
    let millimetres: f64 = line[8..line.len() - 3].parse().expect("a number");
    assert!((550.0..700.0).contains(&millimetres), "the sensor sits ahead of the centre: `{line}`");
}

#[test]
fn the_picture_is_the_one_that_the_first_command_draws() {
    let readme = fs::read_to_string(root().join("README.md")).expect("a README");
    assert!(readme.contains("run sims/demo.sim --until 45 --plot"), "the command that this test runs");
    let scratch = Scratch::new();
    let plot = scratch.path().join("demo.svg");
    let mut command = scratch.command(&["run", "sims/demo.sim", "--until", "45", "--plot"]);
    let output = command.arg(&plot).current_dir(root()).output().expect("eyesim starts");
    assert!(output.status.success(), "{output:?}");
    let committed = fs::read_to_string(root().join("docs/demo.svg")).expect("the README's picture");
    assert!(scratch.read("demo.svg") == committed, "draw docs/demo.svg again with the README's first command");
}

#[test]
fn the_robot_is_the_one_that_its_command_draws() {
    for page in ["README.md", "docs/plot.md"] {
        let text = fs::read_to_string(root().join(page)).expect("a page");
        assert!(text.contains("robis/feeler.robi") && text.contains("feeler.svg"), "{page}: what this test draws");
    }
    let scratch = Scratch::new();
    let picture = scratch.path().join("feeler.svg");
    let mut command = scratch.command(&["plot", "robis/feeler.robi", "-o"]);
    let output = command.arg(&picture).current_dir(root()).output().expect("eyesim starts");
    assert!(output.status.success(), "{output:?}");
    let committed = fs::read_to_string(root().join("docs/feeler.svg")).expect("the picture of the pages");
    assert!(scratch.read("feeler.svg") == committed, "draw docs/feeler.svg again with the command in docs/plot.md");
}

#[test]
fn the_first_program_in_c_runs() {
    let scratch = Scratch::new();
    scratch.write("hello.c", &block("c"));
    scratch.write("hello.sim", &block("text"));
    check(&scratch.report("hello.sim", &[], 0));
}

#[test]
fn the_first_program_in_rust_runs() {
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["new", "hello", "--lang", "rust"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    scratch.write("hello/src/lib.rs", &block("rust"));
    scratch.write("hello.sim", &block("text").replace("hello.c", "hello"));
    check(&scratch.report("hello.sim", &[], 0));
}

#[test]
fn the_unit_test_of_a_new_program_in_rust_passes() {
    for api in ["6", "7"] {
        let scratch = Scratch::new();
        let ran = scratch.eyesim(&["new", "hello", "--lang", "rust", "--api", api]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut test = std::process::Command::new(cargo);
        test.args(["test", "--offline", "--target-dir"]).arg(env!("CARGO_TARGET_TMPDIR")).arg("--manifest-path");
        test.arg(scratch.path().join("hello/Cargo.toml"));
        let output = test.output().expect("cargo runs");
        let said = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && said.contains("it_turns_before_four_walls ... ok"), "{said}");
    }
}
