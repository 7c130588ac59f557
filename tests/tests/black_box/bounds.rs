//! Resource limits of programs: an exceeded limit is reported, and the run continues or ends in time.

use std::process::{Command, Stdio};
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
fn output_beyond_the_limit_is_discarded_reported_once_and_counted() {
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
        assert!(cut(0) > 15_000, "{}", cut(0));
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
            let status = Command::new("mkfifo").arg(scratch.path().join(pipe)).status().expect("mkfifo");
            assert!(status.success());
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
fn messages_of_failed_programs_are_escaped() {
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

/// Runs a program beside a good one; returns the report and the output.
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
fn a_program_that_blocks_all_signals_is_abandoned() {
    let program = "#include <signal.h>\n#include <unistd.h>\n#include <sys/syscall.h>\n#include \"eyebot.h\"\n\
                   int main(void) { unsigned long all = ~0UL; OSWait(200);\n\
                   syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, 0, 8); for (;;); }\n";
    let start = Instant::now();
    let (report, said) = beside_a_good_one(program, &["--timeout", "0.5", "--exec", "thread"]);
    assert_eq!(report["robots"][1]["outcome"], "timeout", "{said}");
    let reason = report["robots"][1]["reason"].as_str().expect("a reason");
    assert!(reason.contains("blocks the signals"), "{reason}");
    assert_eq!(report["robots"][0]["outcome"], "finished", "{said}");
    assert!(start.elapsed() < Duration::from_secs(100));
}

#[test]
fn the_floating_point_environment_of_a_program_does_not_affect_the_host() {
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

const SYSTEM: &str = "#define _GNU_SOURCE\n#include <fcntl.h>\n#include <fenv.h>\n#include <setjmp.h>\n#include <signal.h>\n#include <stdio.h>\n\
                      #include <stdlib.h>\n#include <string.h>\n#include <sys/syscall.h>\n#include <unistd.h>\n#include \"eyebot.h\"\n";

/// Runs a program beside a good one, with this executor; returns the exit code, the program's reason with the output,
/// and the outcome of the good program.
fn run_beside_good(program: &str, exec: &str) -> (Option<i32>, String, Value) {
    let scratch = Scratch::new();
    scratch.write("bad.c", &format!("{SYSTEM}{program}\n"));
    let good = "int main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveStraight(vw, 0.1, 0.5); VWDriveWait(vw); return 0; }\n";
    scratch.write("good.c", &format!("#include \"eyebot.h\"\n{good}"));
    write_scene(&scratch, &["good.c", "bad.c"]);
    let args = ["run", "scene.sim", "--exec", exec, "--timeout", "0.5", "--report", "r.json", "--trace", "t.jsonl"];
    let ran = scratch.eyesim(&args);
    let report: Value = std::fs::read_to_string(scratch.path().join("r.json"))
        .map_or(Value::Null, |text| serde_json::from_str(&text).expect("a report"));
    let reason = report["robots"][1]["reason"].as_str().unwrap_or_default().to_owned();
    (ran.code, format!("{reason}\n{}{}", ran.stdout, ran.stderr), report["robots"][0]["outcome"].clone())
}

/// Programs that end in ways that are hard to report: the program, and a text that its message must contain with every
/// executor.
const ENDS: &[(&str, &str)] = &[
    (
        "static void h(int s) { (void)s; }\nint main(void) { OSWait(20); signal(SIGSEGV, h);\n*(volatile int *)0 = 1; return 0; }",
        "",
    ),
    ("int main(void) { OSWait(20); syscall(SYS_exit, 0); return 0; }", "ended its own thread without the C library"),
    ("int main(void) { OSWait(20); raise(SIGFPE); return 0; }", "the signal SIGFPE"),
    (
        "int main(void) { OSWait(20); feenableexcept(FE_DIVBYZERO); volatile double z = 0; z = 1 / z; return z > 1; }",
        "floating-point division by zero",
    ),
    (
        "__attribute__((optimize(\"stack-protector-all\"))) static void f(int n) { volatile char b[8]; memset((void *)b, 65, n); __asm__ volatile(\"\" : : \"r\"(b) : \"memory\"); }\n\
      int main(void) { OSWait(20); f(600); exit(0); }",
        "stack smashed",
    ),
    (
        "static jmp_buf j; static void t(void) { longjmp(j, 1); }\nint main(void) { if (setjmp(j) == 0) { OSAttachTimer(10, t); OSWait(50); } OSWait(9); return 0; }",
        "longjmp out of a timer's function",
    ),
    (
        "static void (*r(void))(void) { for (;;) ; }\nvoid f(void) __attribute__((ifunc(\"r\")));\nint main(void) { f(); return 0; }",
        "does not return",
    ),
];

#[test]
fn ends_that_are_hard_to_detect_are_reported_by_every_executor() {
    for (program, words) in ENDS {
        let is_ifunc = program.contains("ifunc");
        for exec in ["auto", "process", "thread"] {
            let (code, said, good) = run_beside_good(program, exec);
            assert_eq!(code, Some(1), "{exec} {program}: {said}");
            assert!(said.contains(words), "{exec} {program}: {said}");
            assert!(exec != "process" || is_ifunc || good == "finished", "{exec} {program}: {said}");
        }
    }
}

#[test]
fn calls_that_would_end_or_replace_eyesim_on_a_thread_are_reported() {
    for (program, words) in [
        ("syscall(SYS_exit_group, 0);", "exit_group"),
        ("{ char *a[] = {\"true\", 0}; execve(\"/bin/true\", a, 0); }", "execve"),
        ("__asm__ volatile(\"syscall\" : : \"a\"(231), \"D\"(7)); raise(0);", "exit_group"),
    ] {
        let (code, said, _) =
            run_beside_good(&format!("int main(void) {{ OSWait(20); {program} return 0; }}"), "thread");
        assert_eq!(code, Some(1), "{program}: {said}");
        assert!(said.contains(words) && said.contains("bad.c:12"), "{program}: {said}");
    }
}

#[test]
fn a_program_that_could_end_eyesim_runs_in_a_process_of_its_own() {
    let scratch = Scratch::new();
    scratch.write("bad.c", &format!("{SYSTEM}int main(void) {{ OSWait(20); syscall(SYS_exit_group, 0); }}\n"));
    scratch.write("good.c", "#include \"eyebot.h\"\nint main(void) { OSWait(100); return 0; }\n");
    write_scene(&scratch, &["good.c", "bad.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "-v", "--report", "r.json"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stderr.contains("program `bad` runs in a process: it uses `syscall`"), "{ran:#?}");
    assert!(!ran.stderr.contains("program `good` runs in a process"), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    assert_eq!(report["robots"][0]["outcome"], "finished");
}

#[test]
fn a_run_with_an_incomplete_record_fails() {
    for harm in [
        "unlink(\"t.jsonl\");",
        "truncate(\"t.jsonl\", 10);",
        "rename(\"bad.c\", \"t.jsonl\");",
        "{ int n = open(\"/dev/null\", O_RDWR); for (int i = 3; i < 64; i++) if (i != n) dup2(n, i); }",
    ] {
        for exec in ["auto", "thread"] {
            let (code, said, _) =
                run_beside_good(&format!("int main(void) {{ OSWait(20); {harm} OSWait(50); return 0; }}"), exec);
            let is_apart = exec == "auto" && harm.contains("dup2");
            assert!(if is_apart { code == Some(0) } else { code == Some(2) }, "{exec} {harm} {code:?}: {said}");
            assert!(is_apart || said.contains("it is not complete"), "{exec} {harm}: {said}");
        }
    }
}

#[test]
fn processes_of_programs_do_not_outlive_the_run() {
    let tag = format!("{}", std::process::id());
    for exec in ["auto", "thread"] {
        let sleeper = format!(
            "int main(void) {{ OSWait(20); if (syscall(SYS_fork) == 0) {{ setsid(); execl(\"/bin/sleep\", \"sleep\", \"9{tag}\", (char *)0); }}\n\
             usleep(1000); OSWait(50); return 0; }}"
        );
        let (_, said, _) = run_beside_good(&sleeper, exec);
        assert!(until(|| !runs(&format!("sleep 9{tag}"))), "{exec}: {said}");
    }
}

/// Time limit for the end of an interrupted run. An idle machine needs two seconds; the tests run beside others.
const INTERRUPT_LIMIT: Duration = Duration::from_secs(30);

/// Starts `command`, sends `signal` half a second after `begins` returns true, and returns the exit code and the time
/// until the end.
fn interrupted(command: &mut Command, signal: &str, begins: impl Fn() -> bool) -> (Option<i32>, Duration) {
    let mut host = command.stdout(Stdio::null()).spawn().expect("eyesim starts");
    let start = Instant::now();
    while !begins() {
        assert!(start.elapsed() < Duration::from_secs(200), "it does not begin");
        assert_eq!(host.try_wait().expect("a process"), None, "it ends by itself");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(500));
    let sent = Instant::now();
    assert!(Command::new("kill").args([signal, &host.id().to_string()]).status().expect("kill").success());
    (host.wait().expect("the process ends").code(), sent.elapsed())
}

#[test]
fn an_interrupt_ends_programs_in_every_language_with_a_whole_record() {
    let programs = [
        ("loop.py", "from eye import *\nOSWait(20)\nwhile True:\n    pass\n"),
        ("wait.py", "from eye import *\nwhile True:\n    OSWait(1)\n"),
        (
            "deaf.py",
            "from eye import *\nimport signal\nfor s in (2, 15, 23):\n    signal.signal(s, signal.SIG_IGN)\nOSWait(20)\n\
             while True:\n    try:\n        OSWait(1)\n    except BaseException:\n        pass\n",
        ),
        (
            "threads.py",
            "from eye import *\nimport threading\ndef spin():\n    while True:\n        OSWait(1)\n\
             for i in range(4):\n    threading.Thread(target=spin).start()\nspin()\n",
        ),
        (
            "asleep.py",
            "from eye import *\nimport threading, time\nOSWait(20)\n\
             threading.Thread(target=lambda: time.sleep(100000)).start()\nwhile True:\n    pass\n",
        ),
        ("asleep.c", "#include \"eyebot.h\"\nint main(void) { OSWait(2000000000); return 0; }\n"),
    ];
    let has_python = Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success());
    let programs = programs.iter().filter(|(name, _)| has_python || !name.ends_with(".py"));
    for ((name, program), signal) in programs.zip(["-INT", "-TERM"].iter().cycle()) {
        let scratch = Scratch::new();
        scratch.write(name, program);
        write_scene(&scratch, &[name, name]);
        let args = ["run", "scene.sim", "--timeout", "600", "--until", "1e8", "--speed", "1", "--trace", "t.jsonl"];
        let begins = || scratch.path().join("t.jsonl").exists();
        let (code, elapsed) = interrupted(&mut scratch.command(&args), signal, begins);
        assert_eq!(code, Some(130), "{name}");
        assert!(elapsed < INTERRUPT_LIMIT, "{name}: {elapsed:?}");
        println!("{signal} {elapsed:?} {name}");
        assert_eq!(scratch.trace("t.jsonl").last().expect("a line")["event"], "end", "{name}");
    }
}

#[test]
fn an_interrupt_ends_builds_and_loads_and_leaves_no_process() {
    let tag = format!("8{}", std::process::id());
    let resolver = "static void (*r(void))(void) { for (;;) ; }\nvoid f(void) __attribute__((ifunc(\"r\")));\n\
                    int main(void) { f(); return 0; }\n";
    let computes = "#include <stdio.h>\n#include \"eyebot.h\"\n\
                    int main(void) { OSWait(1); fclose(fopen(\"begun\", \"w\")); for (;;) ; }\n";
    let name = format!("bad{tag}");
    let child = format!("eyesim: r1 {name}");
    for (what, program, command) in [
        ("build", "int main(void) { return 0; }\n", "run"),
        ("load", resolver, "run"),
        ("build in the window", "int main(void) { return 0; }\n", "view"),
        ("load in the window", resolver, "view"),
        ("run in the window", computes, "view"),
    ] {
        let scratch = Scratch::new();
        scratch.write(&format!("{name}.c"), program);
        write_scene(&scratch, &[&format!("{name}.c")]);
        let begun = scratch.path().join("begun");
        let compiler = "case \"$*\" in *-c*) touch {begun:?}; sleep {tag} & wait;; esac\nexec cc \"$@\"\n";
        let compiler = compiler.replace("{begun:?}", &format!("{begun:?}")).replace("{tag}", &tag);
        let wrapper = scratch.write("slow-cc", &format!("#!/bin/sh\n{compiler}"));
        std::fs::set_permissions(&wrapper, std::os::unix::fs::PermissionsExt::from_mode(0o755)).expect("a script");
        let mut eyesim = scratch.command(&[command, "scene.sim", "--timeout", "600"]);
        if command == "view" {
            eyesim.args(["--no-open", "--port", "0"]);
        }
        if what.starts_with("build") {
            eyesim.env("CC", &wrapper).env("EYESIM_CACHE", scratch.path().join("cache"));
        }
        let begins = || if what.starts_with("load") { runs(&child) } else { begun.exists() };
        let (code, elapsed) = interrupted(&mut eyesim, "-TERM", begins);
        assert!(elapsed < INTERRUPT_LIMIT, "{what}: {elapsed:?}");
        println!("{what}: {code:?} after {elapsed:?}");
        assert_eq!(code, Some(130), "{what}");
        assert!(until(|| !runs(&format!("sleep {tag}")) && !runs(&child)), "{what}: processes are left");
        let is_unfinished = |path: std::path::PathBuf| path.to_string_lossy().contains("tmp-");
        let cache = std::fs::read_dir(scratch.path().join("cache")).into_iter().flatten().flatten();
        assert!(!cache.map(|entry| entry.path()).any(is_unfinished), "{what}: an unfinished build is left");
    }
}

/// Waits until `is_true` returns true; returns false if it does not within the time limit.
fn until(is_true: impl Fn() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(100) {
        if is_true() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

/// Returns true if another process has `words` in its command line.
fn runs(words: &str) -> bool {
    let processes = std::fs::read_dir("/proc").expect("processes").flatten();
    let own = std::process::id().to_string();
    let others = processes.filter(|process| *process.file_name() != *own);
    let lines = others.filter_map(|process| std::fs::read(process.path().join("cmdline")).ok());
    lines.into_iter().any(|line| String::from_utf8_lossy(&line).replace('\0', " ").contains(words))
}

#[test]
fn an_interrupt_ends_any_run_with_a_whole_record() {
    let programs = [
        "int main(void) { OSWait(20); for (;;) ; }",
        "int main(void) { for (;;) OSWait(1); }",
        "int main(void) { signal(SIGINT, SIG_IGN); signal(SIGTERM, SIG_IGN); OSWait(20); for (;;) ; }",
        "static void h(int s) { (void)s; }\nint main(void) { OSWait(20); signal(SIGSEGV, h); signal(SIGURG, SIG_IGN); *(volatile int *)0 = 1; }",
        "int main(void) { unsigned long all = ~0UL; OSWait(20); syscall(SYS_rt_sigprocmask, SIG_BLOCK, &all, 0, 8); for (;;) ; }",
        "static void end(void) { for (;;) OSWait(1); }\nint main(void) { atexit(end); OSWait(20); for (;;) syscall(SYS_pause); }",
    ];
    for (program, signal) in programs.iter().zip(["-INT", "-TERM"].iter().cycle()) {
        for exec in ["thread", "process"] {
            let scratch = Scratch::new();
            scratch.write("bad.c", &format!("{SYSTEM}{program}\n"));
            write_scene(&scratch, &["bad.c", "bad.c", "bad.c"]);
            let args = [
                "run",
                "scene.sim",
                "--exec",
                exec,
                "--timeout",
                "600",
                "--until",
                "1e8",
                "--speed",
                "1",
                "--trace",
                "t.jsonl",
            ];
            let begins = || scratch.path().join("t.jsonl").exists();
            let (code, elapsed) = interrupted(&mut scratch.command(&args), signal, begins);
            // On a thread the simulator replaces the program's SIGSEGV handler at once, so the crash may end the run
            // before the interrupt.
            let is_told_before = exec == "thread" && program.contains("SIGSEGV") && code == Some(1);
            assert!(code == Some(130) || is_told_before, "{exec} {program}: {code:?}");
            assert!(elapsed < INTERRUPT_LIMIT, "{exec} {program}: {elapsed:?}");
            println!("{exec} {signal} {elapsed:?} {program}");
            assert_eq!(scratch.trace("t.jsonl").last().expect("a line")["event"], "end", "{exec} {program}");
        }
    }
}

#[test]
fn a_build_script_that_loops_is_ended() {
    let scratch = Scratch::new();
    scratch.write(
        "bad/Cargo.toml",
        "[package]\nname = \"endless-build\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[lib]\ncrate-type = [\"cdylib\"]\n[workspace]\n",
    );
    scratch.write("bad/src/lib.rs", "");
    scratch.write("bad/build.rs", "fn main() { loop { std::thread::sleep(std::time::Duration::from_secs(1)); } }\n");
    write_scene(&scratch, &["bad"]);
    let ran = scratch.command(&["run", "scene.sim"]).env("EYESIM_BUILD_TIMEOUT", "5").output().expect("eyesim starts");
    let ran = tests::Ran::from(ran);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("cargo was stopped") && ran.stderr.contains("after 5 s"), "{ran:#?}");
}
