//! Programs in separate processes: digests equal those on threads, and a crash ends only its own robot.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tests::{Ran, Scratch, write_crowd, write_package, write_scene};

/// Runs `sim` with `args`, which must end with `code`; returns the digest and the robots.
fn run(scratch: &Scratch, sim: &str, args: &[&str], code: i32) -> (Value, Value) {
    let mut report = scratch.report(sim, args, code);
    (report["digest"].take(), report["robots"].take())
}

/// Runs `sim` on threads and in processes, and asserts that all results are equal.
fn assert_same(scratch: &Scratch, sim: &str, args: &[&str], code: i32) -> Value {
    let on_threads = run(scratch, sim, args, code);
    let in_processes = run(scratch, sim, &[args, &["--exec", "process"]].concat(), code);
    assert_eq!(on_threads.1, in_processes.1, "{sim} {args:?}");
    assert_eq!(on_threads.0, in_processes.0, "{sim} {args:?}");
    in_processes.1
}

#[test]
fn example_programs_give_the_digest_that_they_give_on_threads() {
    for program in ["avoid", "follow-wall", "avoid-c/avoid.c"] {
        let scratch = Scratch::new();
        write_crowd(&scratch, 4, &format!("%sim%/example-programs/{program}"));
        assert_same(&scratch, "crowd.sim", &["--until", "10"], 0);
    }
}

#[test]
fn output_that_bypasses_the_simulator_is_truncated_and_escaped() {
    let scratch = Scratch::new();
    let program = "#include <string.h>\n#include <sys/syscall.h>\n#include <unistd.h>\n#include \"eyebot.h\"\nstatic char many[3 << 20];\n\
        int main(void)\n{\n    syscall(SYS_write, 2, \"\\033[2Jraw\\n\", 8);\n    memset(many, 'x', sizeof many);\n\
        syscall(SYS_write, 1, many, sizeof many);\n    return 0;\n}\n";
    scratch.write("raw.c", program);
    write_scene(&scratch, &["raw.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--exec", "process"]);
    assert_eq!(ran.code, Some(0), "{:.2000}", ran.stderr);
    assert!(ran.stderr.contains("?[2Jraw\n") && !ran.stderr.contains('\x1b'), "{:.2000}", ran.stderr);
    assert!(ran.stderr.contains("more than 1048 kB past the simulator"), "{:.2000}", ran.stderr);
    assert!(ran.stderr.len() < 2 << 20, "{} bytes", ran.stderr.len());
}

const MANY_CALLS: &str = r#"
    #include <assert.h>
    #include <stdio.h>
    #include <stdlib.h>
    #include <string.h>
    #include <time.h>
    #include "eyebot.h"
    static int ticks, nested;
    static void tick(void) { ticks++; nested += OSGetCount() > 0; LCDSetPos(3, 0); LCDPutInt(ticks); }
    int main(int argc, char **argv)
    {
        int i, h, m, s, t, key;
        PositionType pos;
        image grey, edges;
        VWHandle vw = VWInit(VW_DRIVE, 1);
        TimerHandle timer = OSAttachTimer(7, tick);
        PSDHandle psd = PSDInit(PSD_FRONT);
        PSDStart(psd, TRUE);
        for (i = 0; i < argc; i++) printf("%d %s\n", i, argv[i]);
        fprintf(stderr, "to standard error\n");
        VWDriveStraight(vw, 0.3, 0.2);
        while (!VWDriveDone(vw)) OSWait(5);
        VWDriveTurn(vw, 1.0, 0.5);
        VWDriveWait(vw);
        VWGetPosition(vw, &pos);
        LCDPrintf("%.3f %.3f %.3f %d\n", pos.x, pos.y, pos.phi, PSDGet(psd));
        memset(grey, 0, sizeof grey);
        grey[30][40] = 255;
        IPLaplace(&grey, &edges);
        LCDPrintf("%d %d\n", edges[30][39], edges[30][40]);
        OSGetTime(&h, &m, &s, &t);
        LCDPrintf("%s %s %d\n", OSVersion(), OSMachineName(), s);
        LCDPutString(NULL);
        srand(OSMachineID());
        printf("%d %ld %d\n", rand(), (long)time(NULL), nested);
        LCDMenu("A", "B", " ", "END");
        OSDetachTimer(timer);
        key = KEYGet();
        if (OSMachineID() == 2) exit(3);
        if (OSMachineID() == 3) abort();
        if (OSMachineID() == 4) assert(key == 0);
        printf("the end\n");
        return 0;
    }"#;

#[test]
fn timers_keys_console_arguments_exit_codes_and_assertions_work_as_on_threads() {
    let scratch = Scratch::new();
    scratch.write("prog.c", MANY_CALLS);
    write_scene(&scratch, &["prog.c"; 4]);
    let robots = assert_same(&scratch, "scene.sim", &["--keys", "9:KEY4", "--args", "1:\"a b\" c"], 1);
    assert_eq!(robots[0]["outcome"], "finished", "{robots:#}");
    assert_eq!(robots[1]["exit_code"], 3);
    assert!(robots[3]["reason"].as_str().is_some_and(|reason| reason.contains("key == 0")), "{robots:#}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--exec", "process", "--keys", "9:KEY4", "--args", "1:\"a b\" c"]);
    let said = ran.stdout + &ran.stderr;
    for words in ["1 a b", "2 c", "the end", "to standard error"] {
        assert!(said.contains(words), "`{words}`: {said}");
    }
    // The report gives the reason and location of the program's wait, as on a thread.
    let robots = assert_same(&scratch, "scene.sim", &[], 1);
    let waits = robots[0]["reason"].as_str().expect("a reason");
    assert!(waits.contains("waits for") && waits.contains("prog.c:"), "{waits}");
}

#[test]
fn a_rust_program_that_panics_in_a_process_ends_as_on_a_thread() {
    let scratch = Scratch::new();
    write_package(
        &scratch,
        "bad",
        "use robios_api::prelude::*;\nrobios_api::program!(main);\nfn main(robot: &Robot) -> Result {\n\
         let drive = robot.drive()?;\n    drive.straight(0.2.metres(), 0.2.metres_per_second())?.wait()?;\n\
         let list: Vec<usize> = (0..10).collect();\n    panic!(\"there is no {}\", list[10 + robot.arguments().len()]);\n}\n",
    );
    write_scene(&scratch, &["bad", "bad"]);
    let robots = assert_same(&scratch, "scene.sim", &[], 1);
    let reason = robots[1]["reason"].as_str().expect("a reason");
    assert!(reason.contains("panicked") && reason.contains("out of bounds"), "{reason}");
}

/// Runs `source` as robot 2 in processes, between two robots that drive for five seconds; returns the report and the
/// output.
fn break_one(source: &str, args: &[&str]) -> (Value, Ran) {
    let scratch = Scratch::new();
    scratch.write("broken.c", source);
    scratch.write(
        "good.c",
        "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveTurn(vw, 1.5708, 1);\n\
         VWDriveWait(vw); VWDriveStraight(vw, 0.5, 0.1); VWDriveWait(vw); return 0; }\n",
    );
    write_scene(&scratch, &["good.c", "broken.c", "good.c"]);
    let mut all = vec!["run", "scene.sim", "--exec", "process", "--report", "r.json"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    for good in [0, 2] {
        let robot = &report["robots"][good];
        assert_eq!(robot["outcome"], "finished", "{ran:#?}");
        assert!((tests::number(robot, "path_m") - 0.5).abs() < 1e-6, "it has driven to its end: {robot:#}");
    }
    (report, ran)
}

/// The reason of robot 2 in the report.
fn reason(report: &Value) -> &str {
    report["robots"][1]["reason"].as_str().expect("a reason")
}

#[test]
fn a_null_write_ends_only_its_robot_and_is_reported_with_its_line() {
    let (report, ran) = break_one(
        "#include \"eyebot.h\"\nint main(void) {\n    int *p = 0;\n    VWHandle vw = VWInit(VW_DRIVE, 1);\n    VWSetSpeed(vw, 0.1, 0);\n\
         OSWait(100);\n    *p = 1;\n    return 0;\n}\n",
        &[],
    );
    assert_eq!(report["robots"][1]["outcome"], "failed");
    for words in ["segmentation fault at address 0x0", "broken.c:7", "OSWait"] {
        assert!(reason(&report).contains(words), "`{words}`: {}", reason(&report));
    }
    assert!((ran.stdout + &ran.stderr).contains("r2"));
    // The robot's motors stopped at its last virtual time, 1 s.
    let path = tests::number(&report["robots"][1], "path_m");
    assert!((path - 0.1).abs() < 0.002, "{path}");
}

#[test]
fn an_endless_loop_and_a_sleep_in_the_kernel_end_only_their_robot() {
    let (report, _) = break_one(
        "#include \"eyebot.h\"\nint main(void) {\n    OSWait(50);\n    while (1)\n        ;\n    return 0;\n}\n",
        &["--timeout", "0.5"],
    );
    assert_eq!(report["robots"][1]["outcome"], "timeout");
    assert!(reason(&report).contains("broken.c:4") || reason(&report).contains("broken.c:5"), "{}", reason(&report));
    let (report, _) = break_one(
        "#include <signal.h>\n#include <unistd.h>\n#include <sys/syscall.h>\n#include \"eyebot.h\"\nint main(void) {\n\
         sigset_t all; sigfillset(&all); sigprocmask(SIG_BLOCK, &all, 0);\n    OSWait(50);\n    syscall(SYS_pause);\n    return 0;\n}\n",
        &["--timeout", "0.5"],
    );
    assert_eq!(report["robots"][1]["outcome"], "timeout", "one that takes no signal, too");
}

#[test]
fn a_program_that_stops_its_own_process_is_reported_and_ended() {
    for stop in ["raise(SIGSTOP)", "kill(getpid(), SIGSTOP); for (;;)", "for (;;) raise(SIGSTOP)"] {
        let start = Instant::now();
        let (report, _) = break_one(
            &format!(
                "#include <signal.h>\n#include <unistd.h>\n#include \"eyebot.h\"\nint main(void) {{\n    OSWait(50);\n    {stop};\n    \
                 return 0;\n}}\n"
            ),
            &["--timeout", "600"],
        );
        assert!(start.elapsed() < Duration::from_secs(300), "it does not wait for the timeout");
        assert_eq!(report["robots"][1]["outcome"], "failed", "{stop}");
        assert!(reason(&report).contains("stopped its own process by a signal (SIGSTOP)"), "{}", reason(&report));
    }
}

#[test]
fn a_stack_overflow_and_a_direct_exit_end_only_their_robot() {
    let (report, _) = break_one(
        "#include \"eyebot.h\"\nint deep(int n) { volatile char pad[4096]; pad[0] = n; return deep(n + 1) + pad[0]; }\n\
         int main(void) { OSWait(10); return deep(0); }\n",
        &[],
    );
    assert!(reason(&report).contains("stack overflow"), "{}", reason(&report));
    let (report, _) = break_one(
        "#include <unistd.h>\n#include <sys/syscall.h>\n#include \"eyebot.h\"\nint main(void) { OSWait(10); syscall(SYS_exit_group, 3); return 0; }\n",
        &[],
    );
    assert!(reason(&report).contains("exit code 3"), "{}", reason(&report));
    let (report, _) = break_one(
        "#include <pthread.h>\n#include \"eyebot.h\"\nstatic void tick(void) { *(volatile int *)8 = 1; }\n\
         int main(void) { OSAttachTimer(10, tick); OSWait(100); return 0; }\n",
        &[],
    );
    assert!(reason(&report).contains("address 0x8") && reason(&report).contains("broken.c:3"), "{}", reason(&report));
}

#[test]
fn a_library_that_cannot_be_loaded_gives_the_same_message_in_a_process() {
    let scratch = Scratch::new();
    let source = scratch.write("classic.c", "int VWInit(int, int); int main(void) { return VWInit(1, 1); }\n");
    let library = scratch.path().join("prog.so");
    let built = Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&source).status();
    assert!(built.expect("a C compiler").success());
    write_scene(&scratch, &["prog.so"]);
    let on_thread = scratch.eyesim(&["run", "scene.sim"]);
    let in_process = scratch.eyesim(&["run", "scene.sim", "--exec", "process"]);
    assert_eq!((on_thread.code, &on_thread.stderr), (Some(1), &in_process.stderr));
    // A crash before `main` starts.
    scratch.write("early.c", "#include \"eyebot.h\"\n__attribute__((constructor)) static void f(void) { *(volatile int *)0 = 1; }\nint main(void) { return 0; }\n");
    write_scene(&scratch, &["early.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--exec", "process"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stderr.contains("r1") && ran.stderr.contains("segmentation fault"), "{ran:#?}");
}

#[allow(clippy::zombie_processes, reason = "the tests wait for it; where they fail, nothing is left to be told")]
/// Starts a run in real time of `robots` robots whose programs wait for a minute; returns the run and the processes of
/// its robots.
fn start(scratch: &Scratch, robots: usize) -> (Child, Vec<u32>) {
    scratch.write("prog.c", "#include \"eyebot.h\"\nint main(void) { OSWait(6000); return 0; }\n");
    write_scene(scratch, &vec!["prog.c"; robots]);
    let mut command = scratch.command(&[
        "run",
        "scene.sim",
        "--exec",
        "process",
        "--speed",
        "1",
        "--report",
        "r.json",
        "--trace",
        "t.jsonl",
    ]);
    let host = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("eyesim starts");
    let deadline = Instant::now() + Duration::from_secs(100);
    loop {
        let children = children_of(host.id());
        // The run handles signals once a program has started.
        let trace = std::fs::read_to_string(scratch.path().join("t.jsonl")).unwrap_or_default();
        if children.len() == robots && trace.contains("program_started") {
            return (host, children);
        }
        assert!(Instant::now() < deadline, "no children: {children:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The processes whose parent is `parent`.
fn children_of(parent: u32) -> Vec<u32> {
    let processes = std::fs::read_dir("/proc").expect("/proc").flatten();
    let pids = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    pids.filter(|pid| stat(*pid).is_some_and(|(_, its_parent)| its_parent == parent)).collect()
}

/// State and parent of a process; `None` if it does not exist.
fn stat(pid: u32) -> Option<(char, u32)> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    let mut words = text.rsplit_once(')')?.1.split_whitespace();
    Some((words.next()?.chars().next()?, words.next()?.parse().ok()?))
}

fn kill(signal: &str, pid: u32) {
    let status = Command::new("kill").args([signal, &pid.to_string()]).status();
    assert!(status.expect("kill").success());
}

/// Waits until the processes have ended.
fn assert_gone(pids: &[u32]) {
    let deadline = Instant::now() + Duration::from_secs(100);
    // A process whose parent was killed may remain as a zombie until init collects it.
    let is_running = |pid: &&u32| stat(**pid).is_some_and(|(state, _)| state != 'Z');
    while let Some(pid) = pids.iter().find(is_running) {
        assert!(Instant::now() < deadline, "process {pid} is left");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_child_that_is_killed_from_outside_is_reported_and_the_interrupt_leaves_no_process() {
    let scratch = Scratch::new();
    let (mut host, children) = start(&scratch, 3);
    kill("-KILL", children[1]);
    std::thread::sleep(Duration::from_millis(300));
    kill("-INT", host.id());
    assert_eq!(host.wait().expect("the process ends").code(), Some(130));
    assert_gone(&children);
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let killed = report["robots"]
        .as_array()
        .expect("robots")
        .iter()
        .filter(|robot| robot["reason"].as_str().is_some_and(|reason| reason.contains("killed by signal 9")));
    assert_eq!(killed.count(), 1, "{report:#}");
}

#[test]
fn a_host_that_is_killed_leaves_no_process() {
    let scratch = Scratch::new();
    let (mut host, children) = start(&scratch, 2);
    kill("-KILL", host.id());
    host.wait().expect("the process ends");
    assert_gone(&children);
}

#[test]
fn many_robots_in_processes_give_the_same_digest_twenty_times() {
    let scratch = Scratch::new();
    write_crowd(&scratch, 6, "%sim%/example-programs/avoid");
    let (first, _) = run(&scratch, "crowd.sim", &["--until", "5"], 0);
    for round in 0..20 {
        let threads = ["1", "2", "8"][round % 3];
        let args = ["--until", "5", "--exec", "process", "--threads", threads];
        assert_eq!(run(&scratch, "crowd.sim", &args, 0).0, first, "round {round}, {threads} threads");
    }
}
