//! Untrusted programs in a sandbox: the actions denied to them, as the current user and, if that is root, as an
//! ordinary one; equal digests with and without the sandbox; no changed files and no remaining processes.

use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::CommandExt as _;
use std::process::Command;

use serde_json::Value;
use tests::stranger::{chown_all, listing, processes_in, users};
use tests::{Ran, Scratch, write_crowd, write_scene};

const PROBE: &str = include_str!("sandbox/probe.c");
const FUZZ: &str = include_str!("sandbox/fuzz.c");

/// Runs `eyesim` as a user, with its cache in the scratch folder. Limits protect the machine from holes in the sandbox.
fn run_as(scratch: &Scratch, user: Option<u32>, args: &[&str]) -> Ran {
    let script = "ulimit -t 120; exec timeout -k 5 120 \"$@\"";
    let mut command = Command::new("sh");
    command.args(["-c", script, "sh"]).arg(eyesim(scratch)).args(args).current_dir(scratch.path().join("run"));
    command.env("EYESIM_CACHE", scratch.path().join("cache")).env("HOME", scratch.path().join("cache"));
    command.env("TMPDIR", scratch.path().join("tmp")).env("EYESIM_SECRET", "the seeds").env("LD_PRELOAD", "");
    if let Some(user) = user {
        command.uid(user).gid(user);
        chown_all(scratch.path(), user);
    }
    Ran::from(command.output().expect("a shell"))
}

/// A copy of the binary that every user can execute.
fn eyesim(scratch: &Scratch) -> std::path::PathBuf {
    let copy = scratch.path().join("eyesim");
    if !copy.exists() {
        tests::copy_eyesim(&copy);
    }
    copy
}

/// Creates folders: `run` with its programs in `programs`, a victim's folder, and folders that eyesim writes to.
fn folders() -> Scratch {
    let scratch = Scratch::new();
    std::fs::set_permissions(scratch.path(), std::fs::Permissions::from_mode(0o755)).expect("a mode");
    for folder in ["run/programs", "cache", "tmp", "victim/folder", "victim/programs"] {
        std::fs::create_dir_all(scratch.path().join(folder)).expect("a folder");
    }
    scratch.write("victim/secret.txt", "hidden");
    let sim = write_scene(&scratch, &["programs/good.c", "programs/bad.c", "programs/good.c"]);
    for name in ["room.wld", "bot.robi", "scene.sim"] {
        std::fs::rename(sim.with_file_name(name), scratch.path().join("run").join(name)).expect("a file of the scene");
    }
    scratch.write(
        "run/programs/good.c",
        "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveTurn(vw, 1.5708, 1);\n\
         VWDriveWait(vw); VWDriveStraight(vw, 0.3, 0.2); VWDriveWait(vw); return 0; }\n",
    );
    scratch
}

/// Runs the scene as `user` with `bad` as the program of robot 2 in a sandbox. Checks that the other robots reach their
/// goals, that nothing in the run's folder and the victim's folder changes, and that no process remains. Returns the
/// report and the output.
fn run_bad(scratch: &Scratch, bad: &str, user: Option<u32>, more: &[&str]) -> (Value, Ran) {
    scratch.write("run/programs/bad.c", bad);
    if let Some(user) = user {
        chown_all(scratch.path(), user);
    }
    let list = || ["victim", "run"].map(|folder| listing(&scratch.path().join(folder)));
    let before = list();
    let report = scratch.path().join("tmp/report.json");
    let report = report.to_str().expect("a path in UTF-8");
    let args = [&["run", "scene.sim", "--sandbox", "--timeout", "1", "--report", report], more].concat();
    let ran = run_as(scratch, user, &args);
    assert_eq!(list(), before, "nothing outside of scratch folders is touched");
    let report: Value = serde_json::from_str(&scratch.read("tmp/report.json")).unwrap_or_else(|_| panic!("{ran:#?}"));
    std::fs::remove_file(scratch.path().join("tmp/report.json")).expect("a report");
    for good in [0, 2] {
        assert_eq!(report["robots"][good]["outcome"], "finished", "{ran:#?}");
    }
    let remaining: Vec<_> = std::fs::read_dir(scratch.path().join("tmp")).expect("a folder").collect();
    assert!(remaining.is_empty(), "{remaining:?}");
    assert_eq!(processes_in(scratch.path()), Vec::<String>::new(), "nothing is left running");
    (report, ran)
}

#[test]
fn a_program_in_a_sandbox_reaches_only_its_own_files() {
    if tests::lacks_sandbox() {
        return;
    }
    for user in users() {
        let scratch = folders();
        scratch.write("victim/programs/data.txt", "");
        scratch.write("run/programs/data.txt", "own");
        let victim = scratch.path().join("victim");
        // The second argument names `run`, the probe's own folder.
        let probe = PROBE.replace("of(victim, \"programs/data.txt\")", "of(argv[2], \"programs/data.txt\")");
        let arguments = format!("2:{} {}", victim.display(), scratch.path().join("run").display());
        let (report, ran) = run_bad(&scratch, &probe, user, &["--args", &arguments]);
        let said = ran.stdout.clone() + &ran.stderr;
        assert_eq!(report["robots"][1]["outcome"], "finished", "{ran:#?}");
        assert_eq!(report["sandbox"]["level"], "full");
        assert!(!said.contains("OPEN") && !said.contains("CANNOT") && !said.contains("HAS NO"), "{user:?}: {ran:#?}");
        assert!(said.matches(": closed").count() >= 50, "{ran:#?}");
    }
}

#[test]
fn digests_are_those_without_a_sandbox() {
    if tests::lacks_sandbox() {
        return;
    }
    for program in ["avoid-c/avoid.c", "follow-wall-c/follow-wall.c"] {
        let scratch = Scratch::new();
        write_crowd(&scratch, 3, &format!("%sim%/example-programs/{program}"));
        let plain = scratch.report("crowd.sim", &["--until", "5"], 0);
        let roofed = scratch.report("crowd.sim", &["--until", "5", "--sandbox"], 0);
        assert_eq!(plain["digest"], roofed["digest"], "{program}");
        assert!(plain.get("sandbox").is_none() && roofed["sandbox"]["closed"]["files"].is_string());
    }
}

#[test]
fn a_python_program_is_restricted_as_well() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = folders();
    scratch.write(
        "run/programs/bad.py",
        "from eye import *\nimport os, socket\n\
         for name in ('/etc/passwd', '../victim/secret.txt', '../../victim/secret.txt'):\n    try: open(name); print('OPEN', name)\n    except Exception: print('closed')\n\
         try: socket.socket(); print('OPEN socket')\nexcept Exception: print('closed')\n\
         try: os.fork(); print('OPEN fork')\nexcept Exception: print('closed')\n\
         try: os.kill(os.getppid(), 0); print('OPEN kill')\nexcept Exception: print('closed')\n\
         open('own.txt', 'w').write('x')\nprint('the end')\n",
    );
    scratch.write("run/programs/bad.c", "int main(void) { return 0; }\n");
    let ran = run_as(&scratch, None, &["run", "scene.sim", "--sandbox", "--program", "2=programs/bad.py"]);
    let said = ran.stdout.clone() + &ran.stderr;
    assert!(said.contains("the end") && !said.contains("OPEN"), "{ran:#?}");
    assert_eq!(said.matches("closed").count(), 6, "{ran:#?}");
}

/// Programs that crash or flood: name, statements, and a text in the reason of robot 2, which is empty if the program
/// ends well.
const HOSTILE: &[(&str, &str, &str)] = &[
    ("null write", "*(volatile int *)0 = 1;", "segmentation fault"),
    ("stack overflow", "extern int deep(int); deep(1);", "stack overflow"),
    ("SIGSTOP", "raise(SIGSTOP);", "stopped its own process"),
    (
        "signals blocked",
        "sigset_t all; sigfillset(&all); sigprocmask(SIG_BLOCK, &all, 0); for (;;) ;",
        "without a RoBIOS call",
    ),
    ("endless loop", "for (;;) ;", "without a RoBIOS call"),
    ("exit at once", "syscall(SYS_exit_group, 0);", "without a message"),
    ("threads", "for (;;) { pthread_t t; pthread_create(&t, 0, idle, 0); }", ""),
    ("fork bomb", "for (;;) if (fork() < 0) return 3;", "exit code 3"),
    (
        "memory bomb",
        "for (;;) { char *p = malloc(64 << 20); if (!p) return 4; *p = 1; if (++count > 100) return 5; }",
        "exit code 4",
    ),
    (
        "a gigabyte past the simulator",
        "static char b[1 << 20]; memset(b, 'x', sizeof b); for (int i = 0; i < 1024; i++) write(1, b, sizeof b);",
        "",
    ),
    (
        "a long file",
        "FILE *f = fopen(\"f\", \"w\"); static char b[1 << 20]; signal(SIGXFSZ, SIG_IGN); for (;;) if (fwrite(b, 1, sizeof b, f) < sizeof b) return 6;",
        "exit code 6",
    ),
    (
        "many files",
        "for (int i = 0;; i++) { char n[32]; sprintf(n, \"%d\", i); int f = open(n, O_CREAT | O_WRONLY, 0600); static char b[1 << 20]; write(f, b, sizeof b); close(f); }",
        "exceed the limits of its sandbox",
    ),
    (
        "deep folders",
        "for (;;) { mkdir(\"d\", 0700); if (chdir(\"d\")) for (;;) ; }",
        "exceed the limits of its sandbox",
    ),
    ("sockets", "return socket(2, 1, 0) < 0 ? 7 : 0;", "exit code 7"),
    (
        "turn page of another",
        "char n[64]; for (int p = getppid() - 50; p < getppid() + 200; p++) { sprintf(n, \"/proc/self/task/%d\", p); if (!access(n, F_OK)) continue; for (int f = 0; f < 20; f++) { sprintf(n, \"/proc/%d/fd/%d\", p, f); if (open(n, O_RDWR) >= 0) return 9; } } return 8;",
        "exit code 8",
    ),
    (
        "own turn page forged",
        "for (int f = 3; f < 9; f++) { unsigned *p = mmap(0, 4096, 3, MAP_SHARED, f, 0); if (p != MAP_FAILED) { p[3] = 0xffffff; p[4] = 0xffffffff; p[2] = 1; for (;;) ; } } return 1;",
        "an invalid message",
    ),
    ("clock asked", "struct timespec t; syscall(SYS_clock_gettime, 0, &t); return 0;", ""),
    ("escapes", "write(2, \"\\x1b[2J<script>\", 12);", ""),
];

/// A program with the statements `what`.
fn program(what: &str) -> String {
    format!(
        "#define _GNU_SOURCE\n#include \"eyebot.h\"\n#include <fcntl.h>\n#include <pthread.h>\n#include <signal.h>\n#include <stdio.h>\n\
         #include <stdlib.h>\n#include <string.h>\n#include <time.h>\n#include <sys/mman.h>\n#include <sys/socket.h>\n#include <sys/stat.h>\n\
         #include <sys/syscall.h>\n#include <unistd.h>\n\
         int count;\nint deep(int n) {{ volatile char big[4096]; big[0] = n; return deep(n + 1) + big[0]; }}\n\
         void *idle(void *x) {{ for (;;) pause(); return x; }}\n\
         void *fill(void *x) {{ static char b[1 << 20]; char n[32]; for (int i = 0; i < 200; i++) {{ sprintf(n, \"%d\", i);\n\
         int f = open(n, O_CREAT | O_WRONLY, 0600); write(f, b, sizeof b); close(f); }} return idle(x); }}\nint main(void)\n{{\n    OSWait(1);\n    {what}\n    return 0;\n}}\n"
    )
}

#[test]
fn hostile_programs_end_only_their_robots() {
    if tests::lacks_sandbox() {
        return;
    }
    for user in users() {
        let scratch = folders();
        for (name, what, reason) in HOSTILE {
            let (report, ran) = run_bad(&scratch, &program(what), user, &[]);
            let robot = &report["robots"][1];
            let said = robot["reason"].as_str().unwrap_or_default();
            assert!(said.contains(reason), "{name} as {user:?}: `{said}`\n{ran:#?}");
            assert!(ran.stderr.len() < 2 << 20 && !ran.stderr.contains('\x1b'), "{name}");
        }
    }
}

#[test]
fn limits_hold_while_main_waits_in_a_call() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = folders();
    let waits = program("pthread_t t; pthread_create(&t, 0, fill, 0); for (;;) OSWait(1000);");
    // In real time the run ends long after the thread has written its files.
    let (report, ran) = run_bad(&scratch, &waits, None, &["--speed", "1", "--until", "60"]);
    let said = report["robots"][1]["reason"].as_str().unwrap_or_default();
    assert!(said.contains("exceed the limits of its sandbox"), "`{said}`\n{ran:#?}");
}

/// Random system calls change nothing outside the sandbox and no other robot. `EYESIM_FUZZ_SEED` sets the first seed,
/// and `EYESIM_FUZZ_SECONDS=600 cargo test --workspace --test black_box sandbox::random` sets the duration.
#[test]
fn random_system_calls_reach_nothing() {
    if tests::lacks_sandbox() {
        return;
    }
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let (seconds, mut seed) = (number("EYESIM_FUZZ_SECONDS").unwrap_or(0), number("EYESIM_FUZZ_SEED").unwrap_or(1));
    let start = std::time::Instant::now();
    loop {
        for user in users() {
            let scratch = folders();
            println!("seed {seed} as {user:?}");
            let arguments = format!("2:{seed} 20000 {}", scratch.path().join("victim").display());
            run_bad(&scratch, FUZZ, user, &["--args", &arguments]);
            seed += 1;
        }
        if start.elapsed().as_secs() >= seconds {
            break;
        }
    }
}

#[test]
fn a_compiler_cannot_read_files_outside_the_sandbox() {
    if tests::lacks_sandbox() {
        return;
    }
    for user in users() {
        let scratch = folders();
        let secret = scratch.path().join("victim/secret.txt");
        let secret = secret.display();
        let link = scratch.path().join("run/programs/link.c");
        std::os::unix::fs::symlink(scratch.path().join("victim/secret.txt"), &link).expect("a link");
        let sources = [
            format!("#include \"{secret}\"\n"),
            "#include \"../../victim/secret.txt\"\n".to_owned(),
            "#include \"link.c\"\n".to_owned(),
            format!("__asm__(\".incbin \\\"{secret}\\\"\");\n"),
            "__asm__(\".incbin \\\"/etc/shadow\\\"\");\n".to_owned(),
            "#include \"/etc/passwd\"\n".to_owned(),
        ];
        for source in sources {
            scratch.write("run/programs/bad.c", &format!("{source}int main(void) {{ return 0; }}\n"));
            let ran = run_as(&scratch, user, &["run", "scene.sim", "--sandbox"]);
            assert_eq!(ran.code, Some(2), "{source}: {ran:#?}");
            assert!(
                (ran.stderr.contains("ermission denied") || ran.stderr.contains("file not found"))
                    && !ran.stderr.contains("hidden"),
                "{source}: {ran:#?}"
            );
        }
        let ran = run_as(&scratch, user, &["run", "scene.sim", "--sandbox", "--program", "2=programs/link.c"]);
        assert!(ran.code == Some(2) && ran.stderr.contains("is a link out of its folder"), "{ran:#?}");
    }
}

#[test]
fn unsupported_levels_and_options_are_refused_and_doctor_reports_the_level() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = Scratch::new();
    write_scene(&scratch, &["prog.c"]);
    scratch.write("prog.c", "int main(void) { return 0; }\n");
    let refused = |args: &[&str]| {
        let ran = scratch.eyesim(&[&["run", "scene.sim"], args].concat());
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        ran.stderr
    };
    assert!(refused(&["--sandbox=none"]).contains("expected full, calls or limits"));
    assert!(refused(&["--sandbox", "--exec", "thread"]).contains("cannot be used with"));
    assert!(refused(&["--sandbox", "--program", "1=%sim%/example-programs/avoid"]).contains("is a Rust package"));
    assert!(refused(&["--sandbox", "--allow-execute"]).contains("cannot be used with"));
    for level in ["full", "calls", "limits"] {
        let report = scratch.report("scene.sim", &[&format!("--sandbox={level}")], 0);
        assert_eq!(report["sandbox"]["level"], level);
    }
    let ran = scratch.eyesim(&["doctor"]);
    assert!(ran.stdout.contains("sandbox       full: closes files by Landlock"), "{ran:#?}");
}
