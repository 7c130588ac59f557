//! Limits on the resources of a program: they are reported, and the run goes on or ends in time.

use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;
use tests::{Scratch, write_scene};

const FLOOD: &str = r#"
    #include <stdio.h>
    #include "eyebot.h"
    int main(void)
    {
        int i;
        for (i = 0;; i++) {
            printf("flood %d\n", i);
            if (i % 2) fprintf(stderr, "and %d\n", i);
        }
    }"#;

#[test]
fn output_beyond_the_limit_is_cut_told_once_and_counted() {
    for exec in ["thread", "process"] {
        let scratch = Scratch::new();
        scratch.write("flood.c", FLOOD);
        scratch.write("quiet.c", "#include \"eyebot.h\"\nint main(void) { OSWait(100); return 0; }\n");
        write_scene(&scratch, &["flood.c", "quiet.c"]);
        let args = ["run", "scene.sim", "--exec", exec, "--until", "2", "--trace", "t.jsonl", "--report", "r.json"];
        let ran = scratch.eyesim(&[&args[..], &["--output-limit", "0.02"]].concat());
        let said = ran.stdout.clone() + &ran.stderr;
        assert_eq!(ran.code, Some(0), "{said}");
        assert_eq!(said.matches("the program has printed 0.02 MB").count(), 1, "{said}");
        assert!(said.len() < 100_000, "{} bytes on the terminal", said.len());
        let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
        let cut = |robot: usize| report["robots"][robot]["output_cut_bytes"].as_u64().expect("a number");
        assert!(cut(0) > 100_000, "{}", cut(0));
        assert_eq!(cut(1), 0);
        let of_flood = |line: &&Value| line["event"] == "stdout" || line["event"] == "stderr";
        let trace = scratch.trace("t.jsonl");
        let texts = trace.iter().filter(of_flood).map(|line| line["text"].as_str().expect("a text").len() + 1);
        assert!((19_000..=20_000).contains(&texts.sum::<usize>()), "the limit is used, and not more");
    }
}

#[test]
fn pipes_and_devices_in_place_of_programs_are_refused_at_once() {
    let include = "#include \"pipe.h\"\n#include \"eyebot.h\"\nint main(void) { return 0; }\n";
    for (program, pipe, device) in [
        ("pipe.c", Some("pipe.c"), None),
        ("pipe.so", Some("pipe.so"), None),
        ("pipe.py", Some("pipe.py"), None),
        ("zero.so", None, Some("zero.so")),
        ("zero.c", None, Some("zero.c")),
        ("include.c", Some("pipe.h"), None),
        ("device.c", None, Some("pipe.h")),
    ] {
        let scratch = Scratch::new();
        write_scene(&scratch, &[program]);
        scratch.write("include.c", include);
        scratch.write("device.c", include);
        if let Some(pipe) = pipe {
            let made = Command::new("mkfifo").arg(scratch.path().join(pipe)).status().expect("mkfifo");
            assert!(made.success());
        }
        if let Some(device) = device {
            let path = scratch.path().join(device);
            std::os::unix::fs::symlink("/dev/zero", path).expect("a link");
        }
        let start = Instant::now();
        for args in [&["run", "scene.sim"][..], &["run", "scene.sim", "--api", "6"], &["check", "scene.sim"]] {
            let ran = scratch.eyesim(args);
            let said = ran.stdout + &ran.stderr;
            let is_check = args[0] == "check" && ran.code == Some(0);
            assert!(ran.code == Some(2) || is_check, "{program} {args:?} {:?}: {said}", ran.code);
            assert!(is_check || said.contains("not a file"), "{program} {args:?}: {said}");
        }
        assert!(start.elapsed() < Duration::from_secs(100), "{program}: nobody waits for a pipe");
    }
}

#[test]
fn what_a_program_says_of_its_failure_steers_no_terminal() {
    let programs = [
        ("fail.c", "#include \"eyebot.h\"\nint main(void) { OSPanic(\"\\033]0;owned\\007 bad\"); return 0; }\n"),
        (
            "fail.cpp",
            "#include <stdexcept>\n#include \"eyebot.h\"\nint main() { throw std::runtime_error(\"\\033[2Jbad\"); }\n",
        ),
        ("fail.py", "from eye import *\nraise ValueError('\\033[2Jbad')\n"),
        ("refused.c", "#include \"eyebot.h\"\nint main(void) { return \x1b[2J; }\n"),
    ];
    for (name, text) in programs {
        let scratch = Scratch::new();
        write_scene(&scratch, &[name]);
        scratch.write(name, text);
        let ran = scratch.eyesim(&["run", "scene.sim", "--until", "5"]);
        let said = ran.stdout + &ran.stderr;
        assert!(matches!(ran.code, Some(1 | 2)), "{name} {:?}: {said:?}", ran.code);
        assert!(said.contains("2J") || said.contains("owned"), "{name}: {said:?}");
        assert!(!said.contains('\x1b') && !said.contains('\x07'), "{name}: {said:?}");
    }
}

/// Runs a program beside one that drives, on threads: outcomes of both, and messages.
fn beside_a_good_one(program: &str, args: &[&str]) -> (Value, String) {
    let scratch = Scratch::new();
    scratch.write("bad.c", program);
    let drive = "VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 0.1, 0.5); VWDriveWait(vw);";
    scratch.write("good.c", &format!("#include \"eyebot.h\"\nint main(void) {{ {drive} return 0; }}\n"));
    write_scene(&scratch, &["good.c", "bad.c"]);
    let ran = scratch.eyesim(&[&["run", "scene.sim", "--report", "r.json"], args].concat());
    (serde_json::from_str(&scratch.read("r.json")).expect("a report"), ran.stdout + &ran.stderr)
}

#[test]
fn a_program_that_takes_no_signal_is_left_behind() {
    let program = "#include <signal.h>\n#include <unistd.h>\n#include <sys/syscall.h>\n#include \"eyebot.h\"\n\
                   int main(void) { unsigned long all = ~0UL; OSWait(200);\n\
                   syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, 0, 8); for (;;); }\n";
    let start = Instant::now();
    let (report, said) = beside_a_good_one(program, &["--timeout", "0.5"]);
    assert_eq!(report["robots"][1]["outcome"], "timeout", "{said}");
    let reason = report["robots"][1]["reason"].as_str().expect("a reason");
    assert!(reason.contains("blocks the signals"), "{reason}");
    assert_eq!(report["robots"][0]["outcome"], "finished", "{said}");
    assert!(start.elapsed() < Duration::from_secs(100));
}

#[test]
fn a_programs_floats_are_not_the_hosts() {
    let program = |set: &str| {
        format!(
            "#define _GNU_SOURCE\n#include <fenv.h>\n#include <math.h>\n#include \"eyebot.h\"\nint main(void) {{\n{set};\n\
             VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveCurve(vw, 0.7, 1.1, 0.3); VWDriveWait(vw); \
             volatile double one = 1, three = 3; LCDPrintf(\"%d\", one / three > 0x1.5555555555555p-2); return 0; }}\n"
        )
    };
    let end = |set: &str| {
        let (report, said) = beside_a_good_one(&program(set), &[]);
        let robot = &report["robots"][1];
        assert_eq!(robot["outcome"], "finished", "{set}: {said}");
        (robot["pose"].clone(), robot["odometry"].clone(), robot["lcd"][0].as_str().map(|text| text.trim().to_owned()))
    };
    let plain = end("");
    assert_eq!(plain.2.as_deref(), Some("0"));
    let upwards = end("fesetround(FE_UPWARD)");
    assert_eq!((&upwards.0, &upwards.1), (&plain.0, &plain.1), "the robot drives as ever");
    assert_eq!(upwards.2.as_deref(), Some("1"), "and the program computes as it likes");
    let trapping = end("feenableexcept(FE_DIVBYZERO | FE_OVERFLOW | FE_UNDERFLOW | FE_INVALID)");
    assert_eq!(trapping, plain);
}
