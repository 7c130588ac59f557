//! `eyesim debug` with gdb in batch mode: breakpoints by source line; virtual time stops while the debugger waits.

use std::process::Command;

use serde_json::Value;
use tests::{Ran, Scratch, write_scene};

/// Drives 0.2 m, reads the time, and drives on.
const PROGRAM: &str = r#"#include "eyebot.h"

static int twice(int number)
{
  return 2 * number;
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  int before, after;
  VWDriveStraight(vw, 0.2, 0.1);
  before = OSGetCount();
  after = OSGetCount() + twice(21);
  VWDriveWait(vw);
  LCDPrintf("%d", after - before);
  return 0;
}
"#;

fn has_gdb() -> bool {
    let there = Command::new("gdb").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: gdb is not installed");
    }
    there
}

/// Debugs robot 2 of three, in batch mode.
fn debug(scratch: &Scratch, args: &[&str], commands: &[&str]) -> Ran {
    scratch.write("drive.c", PROGRAM);
    write_scene(scratch, &["drive.c", "drive.c", "drive.c"]);
    let mut all = vec!["debug", "scene.sim", "--robot", "2", "--report", "debug.json"];
    all.extend(args);
    all.extend(["--", "-batch"]);
    all.extend(commands.iter().flat_map(|command| ["-ex", command]));
    Ran::from(scratch.command(&all).output().expect("eyesim starts"))
}

fn report(scratch: &Scratch, name: &str) -> Value {
    serde_json::from_str(&scratch.read(name)).expect("a report")
}

#[test]
fn a_program_stops_at_a_line_and_a_function_and_the_run_is_the_same() {
    if !has_gdb() {
        return;
    }
    let scratch = Scratch::new();
    let line = 1 + PROGRAM.lines().position(|line| line.contains("after = OSGetCount")).expect("a line");
    let stop = format!("drive.c:{line}");
    let commands = ["print before", "continue", "print number", "finish", "shell sleep 2", "continue"];
    let ran = debug(&scratch, &["--break", &stop, "--break", "twice"], &commands);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let output = format!("{}{}", ran.stdout, ran.stderr);
    assert!(output.contains(&format!("drive.c:{line}\n")), "{output}");
    assert!(output.contains("twice (number=21)"), "{output}");
    assert!(output.contains("Value returned is $3 = 42"), "{output}");
    // Two seconds at the prompt take no virtual time: the run equals one by `eyesim run`.
    let debugged = report(&scratch, "debug.json");
    let plain = scratch.report("scene.sim", &[], 0);
    assert_eq!(debugged["digest"], plain["digest"], "{debugged:#}");
    assert!(debugged["robots"].as_array().expect("robots").iter().all(|robot| robot["outcome"] == "finished"));
}

#[test]
fn without_a_breakpoint_the_debugger_stops_at_the_beginning() {
    if !has_gdb() {
        return;
    }
    let scratch = Scratch::new();
    let ran = debug(&scratch, &[], &["backtrace 1", "kill"]);
    let output = format!("{}{}", ran.stdout, ran.stderr);
    assert!(output.contains("main ()") && output.contains("drive.c:"), "{output}");
    // After the debugger exits, its robot ends and the others continue.
    assert_eq!(ran.code, Some(1), "{output}");
    let report = report(&scratch, "debug.json");
    let outcomes: Vec<&str> =
        report["robots"].as_array().expect("robots").iter().filter_map(|r| r["outcome"].as_str()).collect();
    assert_eq!(outcomes, ["finished", "failed", "finished"], "{report:#}");
    assert!(
        report["robots"][1]["reason"]
            .as_str()
            .is_some_and(|reason| reason.contains("the debugger exited before the program"))
    );
}

#[test]
fn invalid_debug_requests_are_refused_with_a_reason() {
    let scratch = Scratch::new();
    write_scene(&scratch, &["drive.c"]);
    scratch.write("drive.c", PROGRAM);
    let fails = |args: &[&str], path: Option<&str>| {
        let mut command = scratch.command(&[&["debug", "scene.sim"], args].concat());
        if let Some(path) = path {
            command.env("PATH", path);
        }
        let ran = Ran::from(command.output().expect("eyesim starts"));
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        ran.stderr
    };
    assert!(fails(&[], Some("/nowhere")).contains("the package `gdb`"));
    if has_gdb() {
        assert!(fails(&["--robot", "7"], None).contains("there is no robot 7"));
        assert!(fails(&["--program", "1=drive.py"], None).contains("is a Python program"));
    }
}
