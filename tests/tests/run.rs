//! The command `eyesim run`: rejected input, interruption, and remaining files.

use std::process::Stdio;
use std::time::Duration;

use tests::{Ran, Scratch, write_scene};

/// A folder with one robot that runs `source`.
fn scene(source: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("prog.c", &format!("#include <stdio.h>\n#include \"eyebot.h\"\nint main(void) {{\n{source}\n}}\n"));
    write_scene(&scratch, &["prog.c"]);
    scratch
}

/// Starts a run, sends SIGINT as soon as it has printed a line, and waits for its end.
fn interrupted(scratch: &Scratch, args: &[&str]) -> Ran {
    let mut all = vec!["run", "scene.sim", "--report", "r.json", "--trace", "t.jsonl"];
    all.extend(args);
    let child = scratch.command(&all).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("eyesim starts");
    let trace = scratch.path().join("t.jsonl");
    let is_running = || std::fs::read_to_string(&trace).is_ok_and(|text| text.contains("ready"));
    while !is_running() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // SAFETY: kill takes no pointer; the child has not been waited for, so its process id is still valid.
    unsafe { libc::kill(i32::try_from(child.id()).expect("a process number"), libc::SIGINT) };
    Ran::from(child.wait_with_output().expect("eyesim ends"))
}

#[test]
fn ctrl_c_ends_the_run_with_table_report_and_trace() {
    for (source, args) in [
        ("puts(\"ready\"); for (;;) OSWait(10);", &["--until", "1e9"][..]),
        ("puts(\"ready\"); OSWait(10000); return 0;", &["--speed", "1"][..]),
        ("puts(\"ready\"); OSWait(5); for (;;);", &["--timeout", "1000"][..]),
    ] {
        let scratch = scene(source);
        let ran = interrupted(&scratch, args);
        assert_eq!(ran.code, Some(130), "{source}: {ran:#?}");
        assert!(ran.stdout.contains("digest"), "{source}: the table is there: {ran:#?}");
        assert!(scratch.read("r.json").contains("\"outcome\""), "{source}");
        assert_eq!(scratch.trace("t.jsonl").last().expect("lines")["event"], "end", "{source}");
    }
}

#[test]
fn outputs_do_not_overwrite_inputs_or_each_other() {
    let scratch = scene("return 0;");
    for input in ["scene.sim", "room.wld", "bot.robi", "prog.c", "./prog.c"] {
        let before = scratch.read(input);
        let ran = scratch.eyesim(&["run", "scene.sim", "--report", input]);
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stderr.contains("would overwrite"), "{ran:#?}");
        assert_eq!(scratch.read(input), before);
    }
    let ran = scratch.eyesim(&["run", "scene.sim", "--report", "x", "--trace", "x"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--plot", "missing/p.svg"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("no folder `missing`"), "{ran:#?}");
}

#[test]
fn a_report_that_cannot_be_written_keeps_no_plot_from_being_written() {
    let scratch = scene("return 0;");
    let ran = scratch.eyesim(&["run", "scene.sim", "--report", "/dev/full", "--plot", "p.svg"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(scratch.read("p.svg").contains("</svg>"));
}

#[test]
fn a_closed_output_pipe_is_not_an_error() {
    let scratch = scene("int i; for (i = 0; i < 100000; i++) puts(\"line\"); return 0;");
    let mut child =
        scratch.command(&["run", "scene.sim", "--report", "r.json"]).stdout(Stdio::piped()).spawn().expect("starts");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("ends").code(), Some(0));
    assert!(scratch.read("r.json").contains("finished"));
}

#[test]
fn wrong_arguments_are_named_with_what_is_accepted() {
    let scratch = scene("return 0;");
    for (args, expected) in [
        (&["--slot", "-1"][..], "0.001"),
        (&["--until", "nan"][..], "seconds"),
        (&["--speed", "0"][..], "max"),
        (&["--args", "9:x"][..], "robot 1 alone"),
        (&["--keys", "1:KEY9"][..], "KEY1"),
        (&["--costs", "none.toml"][..], "none.toml"),
    ] {
        let mut all = vec!["run", "scene.sim"];
        all.extend(args);
        let ran = scratch.eyesim(&all);
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:#?}");
        assert!(ran.stderr.contains(expected), "{args:?}: {ran:#?}");
    }
}

#[test]
fn a_drive_against_a_wall_ends_as_a_wait_that_nothing_can_end() {
    let scratch = scene("VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 9, 0.5); VWDriveWait(vw); return 0;");
    let report = scratch.report("scene.sim", &["--contact", "stall"], 1);
    let robot = &report["robots"][0];
    assert_eq!(robot["outcome"], "waiting");
    assert!(robot["reason"].as_str().expect("a reason").contains("stall"), "{robot:#}");
    assert_eq!(robot["contacts"], 1);
    // A robot of 180 mm diameter in a room of 4 m.
    assert!((tests::number(robot, "pose.x_m") - 3.91).abs() < 2e-6, "{robot:#}");
}

#[test]
fn a_drive_against_a_wall_ends_when_the_wheels_have_turned_far_enough() {
    let scratch = scene(
        "VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 9, 0.5); OSWait(1000); int stalled = VWStalled(vw); VWDriveWait(vw); return stalled == 1 ? 0 : 3;",
    );
    let report = scratch.report("scene.sim", &[], 0);
    let robot = &report["robots"][0];
    assert_eq!(robot["contacts"], 1);
    assert!((tests::number(robot, "pose.x_m") - 3.91).abs() < 2e-6, "{robot:#}");
    // 9 m at 0.5 m/s, plus the costs of calls.
    let end = tests::number(robot, "virtual_time_s");
    assert!((18.0..18.1).contains(&end), "{robot:#}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--contact", "push"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("slide or stall"), "{ran:#?}");
}

#[test]
fn a_program_of_the_command_line_takes_the_place_of_the_scenes() {
    let scratch = scene("return 3;");
    let echo = "#include \"eyebot.h\"\nint main(int argc, char **argv) { LCDPrintf(\"%s %s\", argv[0], argv[1]); return 0; }\n";
    scratch.write("sims/other.c", echo);
    write_scene(&scratch, &["prog.c", "prog.c"]);
    let args = ["--program", "2=sims/other.c", "--args", "2:new"];
    let report = scratch.report("scene.sim", &args, 1);
    assert_eq!(report["robots"][0]["exit_code"], 3);
    assert_eq!(report["robots"][1]["program"], "sims/other.c");
    assert_eq!(report["robots"][1]["lcd"][0].as_str().map(str::trim_end), Some("other new"));
    let ran = scratch.eyesim(&["run", "scene.sim", "--program", "1=none.c"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("--program: program `none.c` is not found"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--program", "sims/other.c"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("every robot has a program"), "{ran:#?}");
}

#[test]
fn programs_of_other_systems_are_named_or_replaced() {
    let scratch = scene("return 0;");
    scratch.write("drive.rs", "fn main() {}\n");
    write_scene(&scratch, &["drive.rs"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("a Rust source: name the folder of its Cargo package"), "{ran:#?}");
    std::fs::copy(tests::eyesim_path(), scratch.path().join("prog.x")).expect("an executable");
    write_scene(&scratch, &["prog.x"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("prog.x` is an executable for "), "{ran:#?}");
    assert!(ran.stderr.contains("prog.c` beside it is used instead"), "{ran:#?}");
}
