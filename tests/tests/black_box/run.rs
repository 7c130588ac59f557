//! The command `eyesim run`: rejected input, interruption, and remaining files.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::process::CommandExt as _;
use std::process::{Command, Stdio};
use std::time::Duration;

use tests::{Ran, Scratch, write_scene};

/// A folder with one robot that runs `source`.
fn scene(source: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("prog.c", &format!("#include <stdio.h>\n#include \"eyebot.h\"\nint main(void) {{\n{source}\n}}\n"));
    write_scene(&scratch, &["prog.c"]);
    scratch
}

/// Starts a run, sends `signal` as soon as `ready` is in its trace, and waits for its end.
fn interrupted(scratch: &Scratch, args: &[&str], signal: i32) -> Ran {
    let mut all = vec!["run", "scene.sim", "--report", "r.json", "--trace", "t.jsonl"];
    all.extend(args);
    let mut command = scratch.command(&all);
    // SAFETY: signal is async-signal-safe. These tests may run under `nohup`, which would be passed on.
    unsafe {
        command.pre_exec(|| {
            libc::signal(libc::SIGHUP, libc::SIG_DFL);
            Ok(())
        })
    };
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("eyesim starts");
    let trace = scratch.path().join("t.jsonl");
    let is_running = || std::fs::read_to_string(&trace).is_ok_and(|text| text.contains("ready"));
    while !is_running() {
        std::thread::sleep(Duration::from_millis(5));
    }
    // SAFETY: kill takes no pointer; the child has not been waited for, so its process id is still valid.
    unsafe { libc::kill(i32::try_from(child.id()).expect("a process number"), signal) };
    Ran::from(child.wait_with_output().expect("eyesim ends"))
}

#[test]
fn ctrl_c_ends_the_run_with_table_report_and_trace() {
    for (source, args, signal) in [
        ("puts(\"ready\"); for (;;) OSWait(10);", &["--until", "1e9"][..], libc::SIGINT),
        ("puts(\"ready\"); OSWait(10000); return 0;", &["--speed", "1"][..], libc::SIGHUP),
        ("puts(\"ready\"); OSWait(5); for (;;);", &["--timeout", "1000"][..], libc::SIGTERM),
    ] {
        let scratch = scene(source);
        let ran = interrupted(&scratch, args, signal);
        assert_eq!(ran.code, Some(130), "{source}: {ran:#?}");
        assert!(ran.stdout.contains("digest"), "{source}: the table is printed: {ran:#?}");
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
    // Two names of one file.
    std::fs::hard_link(scratch.path().join("prog.c"), scratch.path().join("link.c")).expect("a link");
    std::os::unix::fs::symlink("r.json", scratch.path().join("later")).expect("a link");
    for outputs in [["--trace", "link.c", "--report", "r.json"], ["--trace", "later", "--report", "r.json"]] {
        let ran = scratch.eyesim(&[&["run", "scene.sim"], &outputs[..]].concat());
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stderr.contains("would overwrite"), "{ran:#?}");
    }
    let ran = scratch.eyesim(&["run", "scene.sim", "--plot", "missing/p.svg"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("no folder `missing`"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--report", "/proc/r.json", "--trace", "new.jsonl"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("--report `/proc/r.json` cannot be written"), "{ran:#?}");
    assert!(!scratch.path().join("new.jsonl").exists(), "the run has not begun");
}

#[test]
fn the_plot_is_written_even_if_the_report_cannot_be_written() {
    let scratch = scene("return 0;");
    let ran = scratch.eyesim(&["run", "scene.sim", "--report", "/dev/full", "--plot", "p.svg"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(scratch.read("p.svg").contains("</svg>"));
    let error = "error: cannot write the report `/dev/full`: No space left on device (os error 28)";
    assert_eq!(ran.stderr.lines().last(), Some(error));
}

#[test]
fn a_missing_temporary_folder_is_named() {
    let scratch = scene("return 0;");
    let ran = scratch.command(&["run", "scene.sim"]).env("TMPDIR", "/missing").output().expect("eyesim starts");
    let ran = Ran::from(ran);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(
        ran.stderr.contains("no folder in $TMPDIR to load programs from: ") && ran.stderr.contains("/missing/"),
        "{ran:#?}"
    );
}

#[test]
fn an_argument_that_is_not_text_is_named() {
    let scratch = scene("return 0;");
    let mut command = scratch.command(&["run", "scene.sim", "--until"]);
    let ran = Ran::from(command.arg(OsStr::from_bytes(b"1\xff")).output().expect("eyesim starts"));
    assert_eq!((ran.code, &*ran.stderr), (Some(2), "error: an argument is not UTF-8: \"1\\xFF\"\n"));
}

#[test]
fn a_hyphen_is_not_a_file_name() {
    let scratch = scene("return 0;");
    for args in [
        &["run", "scene.sim", "--trace", "-"][..],
        &["run", "scene.sim", "--record", "-"],
        &["run", "scene.sim", "--frames", "-"],
        &["test", "--report", "-"],
        &["test", "--junit", "-"],
        &["sweep", "a.suite.toml", "-o", "-"],
        &["cc", "prog.c", "-o", "-"],
    ] {
        let ran = scratch.eyesim(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {ran:#?}");
        assert!(ran.stderr.contains("standard output is not supported here"), "{args:?}: {ran:#?}");
        assert!(!scratch.path().join("-").exists(), "{args:?}");
    }
}

#[test]
fn a_small_stack_is_refused() {
    let command = format!("ulimit -s 512; exec {} explain", tests::eyesim_path().display());
    let ran = Ran::from(Command::new("sh").args(["-c", &command]).output().expect("sh starts"));
    let error = "error: the stack is limited to 512 KiB, expected at least 1024: `ulimit -s`\n";
    assert_eq!((ran.code, &*ran.stderr), (Some(2), error));
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
fn output_files_are_written_even_if_standard_streams_are_full() {
    let scratch = scene("OSWait(100); return 0;");
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
    let outputs = ["--report", "r.json", "--plot", "p.svg"];
    for (args, is_stdout, code) in [(&["run", "scene.sim"][..], true, 2), (&["run", "scene.sim", "-v"][..], false, 0)] {
        let mut command = scratch.command(&[args, &outputs].concat());
        let command = if is_stdout { command.stdout(full()) } else { command.stderr(full()) };
        assert_eq!(command.output().expect("it runs").status.code(), Some(code), "{args:?}");
        assert!(scratch.read("r.json").contains("finished") && scratch.read("p.svg").contains("</svg>"), "{args:?}");
    }
    let mut command = scratch.command(&["new", "maze"]);
    assert_eq!(command.stdout(full()).output().expect("it runs").status.code(), Some(2));
    assert!(scratch.read("maze/maze.sim").contains("maze"));
}

#[test]
fn a_program_can_change_its_working_folder() {
    let scratch = scene("chdir(\"/\"); OSWait(100); return 0;");
    let source = scratch.read("prog.c");
    scratch.write("prog.c", &format!("#include <unistd.h>\n{source}"));
    let report = scratch.report("scene.sim", &["--trace", "t.jsonl"], 0);
    assert_eq!(report["robots"][0]["outcome"], "finished");
    assert_eq!(scratch.trace("t.jsonl").last().expect("lines")["event"], "end");
}

#[test]
fn processes_that_a_program_forks_have_no_robot() {
    let body = "int status; pid_t child = fork(); if (child == 0) { OSWait(10); VWSetSpeed(VWInit(VW_DRIVE, 1), 1, 0); for (;;) OSWait(10); }\n\
                waitpid(child, &status, 0); child = fork(); if (child == 0) _exit(3); waitpid(child, &status, 0); OSWait(100); printf(\"child %d\\n\", WEXITSTATUS(status)); return 0;";
    let scratch = scene(body);
    let source = scratch.read("prog.c");
    scratch.write("prog.c", &format!("#include <unistd.h>\n#include <sys/wait.h>\n{source}"));
    scratch.write(
        "fork.py",
        "from eye import *\nimport os\nif os.fork() == 0:\n    VWSetSpeed(100, 0)\n    OSWait(5000)\nos.wait()\nOSWait(100)\n",
    );
    let ran = scratch.eyesim(&["run", "scene.sim", "--report", "r.json"]);
    assert!(ran.stdout.contains("child 3") && ran.stderr.contains("forked"), "{ran:#?}");
    let report = scratch.report("scene.sim", &[], 0);
    assert_eq!(report["robots"][0]["path_m"], 0.0, "{report:#}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--program", "1=fork.py", "--report", "r.json"]);
    assert!(ran.code == Some(0) && ran.stderr.contains("forked"), "{ran:#?}");
}

#[test]
fn wrong_arguments_are_named_with_what_is_accepted() {
    let scratch = scene("return 0;");
    for (args, expected) in [
        (&["--slot", "-1"][..], "0.001"),
        (&["--slot", "0.0015"][..], "multiple of 0.001"),
        (&["--threads", "30000"][..], "1 to 1024"),
        (&["--until", "nan"][..], "seconds"),
        (&["--speed", "0"][..], "max"),
        (&["--args", "9:x"][..], "only robot 1"),
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
fn a_program_that_waits_for_a_stalled_drive_ends_as_waiting() {
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
fn program_option_replaces_the_program_of_the_scene() {
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

#[test]
fn unknown_functions_of_only_are_reported() {
    let scratch = scene("OSWait(5); return 0;");
    let ran = scratch.eyesim(&["run", "scene.sim", "-v", "--only", "OSWait,VWStraigt"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("--only: there is no function `VWStraigt`, did you mean `VWStraight`?"), "{ran:#?}");
    // Services, which `-v` shows too, have names as well.
    let ran = scratch.eyesim(&["run", "scene.sim", "-v", "--only", "os*, console"]);
    assert!(ran.code == Some(0) && ran.stderr.contains("OSWait(5) = 0"), "{ran:#?}");
}

#[test]
fn a_missing_installation_is_reported() {
    let scratch = Scratch::new();
    let run = |args: &[&str]| {
        Ran::from(
            scratch.command(args).env("EYESIM_HOME", scratch.path().join("none")).output().expect("eyesim starts"),
        )
    };
    let ran = run(&["run", "--example", "demo"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("none/sims`: name an installation in $EYESIM_HOME"), "{ran:#?}");
    let ran = run(&["doctor"]);
    assert!(ran.stdout.starts_with("missing  installation"), "{ran:#?}");
}
