//! Programs that crash: the message names robot, program and line, and the record up to the crash is complete.

use serde_json::Value;
use tests::{Ran, Scratch, write_scene};

/// Runs `source` as robot 2 between two robots that drive; returns the report, the output and the lines of the trace.
fn run(source: &str, args: &[&str]) -> (Value, Ran, Vec<Value>) {
    let scratch = Scratch::new();
    scratch.write("broken.c", source);
    scratch.write(
        "good.c",
        "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWSetSpeed(vw, 0.1, 0.5);\n\
         for (;;) OSWait(5); }\n",
    );
    write_scene(&scratch, &["good.c", "broken.c", "good.c"]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json", "--trace", "t.jsonl"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    (serde_json::from_str(&scratch.read("r.json")).expect("a report"), ran, scratch.trace("t.jsonl"))
}

/// The reason of robot 2 in the report.
fn reason(report: &Value) -> &str {
    report["robots"][1]["reason"].as_str().expect("a reason")
}

#[test]
fn a_null_write_is_reported_at_once_with_its_line() {
    let (report, ran, trace) = run(
        "#include \"eyebot.h\"\nint main(void) {\n    int *p = 0;\n    OSWait(100);\n    *p = 1;\n    return 0;\n}\n",
        &[],
    );
    assert_eq!(report["robots"][1]["outcome"], "failed");
    assert!(reason(&report).contains("segmentation fault at address 0x0"), "{}", reason(&report));
    assert!(reason(&report).contains("broken.c:5"), "{}", reason(&report));
    assert!(reason(&report).contains("OSWait"), "{}", reason(&report));
    let said = ran.stdout + &ran.stderr;
    assert!(said.contains("broken.c") && said.contains("r2"), "{said}");
    // The trace has poses of the other robots up to the slot of the crash, at 1.0 s.
    let last = trace.iter().filter(|line| line["event"] == "pose").filter_map(|line| line["t_s"].as_f64()).next_back();
    assert!(last >= Some(1.0), "{last:?}");
}

#[test]
fn a_missing_argument_is_named_with_the_option_that_gives_it() {
    let program = "#include \"eyebot.h\"\n#include <stdlib.h>\nint main(int argc, char **argv) {\n    int n = atoi(argv[1]) + \
                   atoi(argv[2]);\n    OSWait(n);\n    return 0;\n}\n";
    let (report, ..) = run(program, &["--exec", "fiber"]);
    let words = "at broken.c:4; `argv[1]` is NULL, since the program has no arguments: `--args 2:VALUE` gives it one";
    assert!(reason(&report).ends_with(words), "{}", reason(&report));
    let (report, ..) = run(program, &["--exec", "process", "--args", "2:7"]);
    let words = "`argv[2]` is NULL, since the program has only 1 argument: `--args 2:\"VALUE VALUE\"` gives it 2";
    assert!(reason(&report).ends_with(words), "{}", reason(&report));
    let (report, ..) = run(&program.replace("argv[2]", "argv[4]"), &["--exec", "fiber", "--args", "2:7 8 9"]);
    let words = "only 3 arguments: `--args 2:\"VALUE VALUE VALUE VALUE\"` gives it 4";
    assert!(reason(&report).ends_with(words), "{}", reason(&report));
    let scratch = Scratch::new();
    scratch.write("b.cpp", "#include <string>\nint main(int argc, char **argv)\n{\n  std::string name = argv[1];\n  return name.size();\n}\n");
    scratch.write("scene.sim", "S4 500 500 0 b.cpp\n");
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    let said = ran.stdout + &ran.stderr;
    assert!(
        said.contains("at b.cpp:4; `argv[1]` is NULL, since the program has no arguments: `--args 1:VALUE`"),
        "{said}"
    );
}

#[test]
fn an_endless_loop_is_stopped_with_its_line() {
    let (report, ran, trace) = run(
        "#include \"eyebot.h\"\nint main(void) {\n    OSWait(50);\n    while (1)\n        ;\n    return 0;\n}\n",
        &["--timeout", "0.5"],
    );
    assert_eq!(report["robots"][1]["outcome"], "timeout");
    assert!(reason(&report).contains("broken.c:4") || reason(&report).contains("broken.c:5"), "{}", reason(&report));
    assert!((ran.stdout + &ran.stderr).contains("broken.c"));
    let last = trace.iter().filter(|line| line["event"] == "pose").filter_map(|line| line["t_s"].as_f64()).next_back();
    assert!(last >= Some(0.5), "{last:?}");
}

#[test]
fn a_loop_that_waits_for_a_timer_gets_the_advice_to_make_calls() {
    let program = "#include \"eyebot.h\"\nvolatile int n;\nvoid tick(void) { n++; }\n\
                   int main(void) {\n    OSAttachTimer(10, tick);\n    while (n < 5)\n        ;\n    return 0;\n}\n";
    let (report, ..) = run(program, &["--timeout", "0.5"]);
    assert_eq!(report["robots"][1]["outcome"], "timeout");
    assert!(reason(&report).ends_with("such as `OSWait(10)`"), "{}", reason(&report));
}

#[test]
fn a_function_of_a_timer_that_loops_gets_the_advice_to_return() {
    let program = "#include \"eyebot.h\"\nvoid tick(void) {\n    for (;;) ;\n}\nint main(void) {\n    OSAttachTimer(10, tick);\n    \
                   for (;;) OSWait(10);\n}\n";
    for execution in ["fiber", "process"] {
        let (report, ..) = run(program, &["--timeout", "0.5", "--exec", execution]);
        let words = "the program and its other timers wait until this function of a timer returns";
        assert!(reason(&report).contains("at broken.c:3") && reason(&report).ends_with(words), "{}", reason(&report));
    }
}

#[test]
fn the_timeout_applies_between_two_waits_also_for_a_single_robot() {
    let scratch = Scratch::new();
    let scene = write_scene(&scratch, &["busy.c"]);
    scratch.write(
        "busy.c",
        "#include \"eyebot.h\"\nint main(void) {\n    volatile int i;\n    int n;\n    for (n = 0; n < 25; n++) {\n\
         for (i = 0; i < 20000000; i++)\n;\n OSWait(50);\n    }\n OSMTStatus();\n    return 0;\n}\n",
    );
    // The program uses a second or more of processor time, but less than half a second between any two calls.
    scratch.report(scene.to_str().expect("UTF-8"), &["--timeout", "0.5"], 0);
}

#[test]
fn a_stack_overflow_is_distinguished_from_other_crashes() {
    let (report, ..) = run(
        "#include \"eyebot.h\"\nint deep(int n) { volatile char pad[4096]; pad[0] = n; return deep(n + 1) + pad[0]; }\n\
         int main(void) { return deep(0); }\n",
        &[],
    );
    assert!(reason(&report).contains("stack overflow"), "{}", reason(&report));
}

#[test]
fn a_division_by_zero_and_a_wild_pointer_are_reported() {
    let (report, ..) =
        run("#include \"eyebot.h\"\nint main(void) { volatile int zero = 0; return 100 / zero; }\n", &[]);
    assert!(reason(&report).contains("arithmetic"), "{}", reason(&report));
    let (report, ..) = run(
        "#include \"eyebot.h\"\nint main(void) {\n VWHandle vw = VWInit(VW_DRIVE, 1);\n\
         VWGetPosition(vw, (PositionType *)16);\n return 0; }\n",
        &[],
    );
    assert!(reason(&report).contains("VWGetPosition"), "{}", reason(&report));
}

/// On a fiber, the call fills the picture on the stack of the worker, above which there is no frame of the program.
#[test]
fn an_image_written_through_a_wild_pointer_names_the_line_of_the_call() {
    let scratch = Scratch::new();
    scratch.write(
        "broken.c",
        "#include \"eyebot.h\"\nint main(void) {\n    CAMInit(QVGA);\n    OSWait(10);\n    CAMGet((BYTE *)4096);\n    return 0;\n}\n",
    );
    let scene = write_scene(&scratch, &["broken.c"]);
    let robi = scratch.read("bot.robi") + "camera 60 0 60 0 0 320 240\n";
    scratch.write("bot.robi", &robi);
    for exec in ["fiber", "thread"] {
        let report = scratch.report(scene.to_str().expect("UTF-8"), &["--exec", exec], 1);
        let reason = report["robots"][0]["reason"].as_str().expect("a reason");
        assert!(reason.contains("segmentation fault") && reason.contains("broken.c:5, last"), "{exec}: {reason}");
    }
}

/// The stack of a crashed function of the C library contains return addresses of the last call of RoBIOS.
#[test]
fn a_crash_in_the_c_library_names_the_programs_line() {
    let scratch = Scratch::new();
    let text = "#include \"eyebot.h\"\n#include <stdio.h>\nint main(void) {\n    int x;\n    VWStraight(100, 100);\n    VWWait();\n    \
                FILE *f = fopen(\"none.txt\", \"r\");\n    fscanf(f, \"%d\", &x);\n    return 0;\n}\n";
    scratch.write("broken.c", text);
    let text = "#include \"eyebot.h\"\nint main(void) {\n    int n = 1;\n    VWStraight(100, 100);\n    VWWait();\n    n = n + 1;\n    \
                LCDPrintf(\"%s\", n);\n    return 0;\n}\n";
    scratch.write("format.c", text);
    let scene = write_scene(&scratch, &["broken.c", "format.c"]);
    for exec in ["fiber", "thread", "process"] {
        let report = scratch.report(scene.to_str().expect("UTF-8"), &["--exec", exec], 1);
        for (robot, line) in ["broken.c:8, last", "format.c:7, last"].into_iter().enumerate() {
            let reason = report["robots"][robot]["reason"].as_str().expect("a reason");
            assert!(reason.contains(line), "{exec}: {reason}");
        }
    }
}

#[test]
fn a_wait_for_a_key_that_never_comes_names_key_time_and_line() {
    let scratch = Scratch::new();
    scratch.write(
        "prog.c",
        "#include \"eyebot.h\"\nint main(void) {\n    OSWait(231);\n    KEYWait(KEY4);\n    return 0;\n}\n",
    );
    write_scene(&scratch, &["prog.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let said = ran.stdout + &ran.stderr;
    assert!(said.contains("KEY4") && said.contains("since 2.31") && said.contains("prog.c:4"), "{said}");
    let ran = scratch.eyesim(&["run", "scene.sim", "--keys", "3:KEY4"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

#[test]
fn a_crash_in_a_thread_that_is_not_a_task_ends_the_run_with_a_message() {
    let scratch = Scratch::new();
    scratch.write(
        "prog.c",
        "#define _GNU_SOURCE\n#include <dlfcn.h>\n#include <pthread.h>\n#include \"eyebot.h\"\n\
         static void *bad(void *p) { OSWait(10); *(volatile int *)p = 1; return p; }\n\
         int main(void) {\n\
           pthread_t t;\n\
           int (*create)(pthread_t *, void *, void *(*)(void *), void *) =\n\
             dlsym(dlopen(\"libc.so.6\", RTLD_NOW), \"pthread_create\");\n\
           create(&t, 0, bad, 0);\n\
           for (;;) OSWait(10);\n\
         }\n",
    );
    write_scene(&scratch, &["prog.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--until", "1e9"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stderr.contains("a thread that a robot program started"), "{ran:#?}");
}

#[test]
fn a_library_that_cannot_be_loaded_fails_the_robot_by_name() {
    let scratch = Scratch::new();
    let source = scratch.write("classic.c", "int VWInit(int, int); int main(void) { return VWInit(1, 1); }\n");
    let library = scratch.path().join("prog.so");
    let built = std::process::Command::new("cc").args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&source).status();
    assert!(built.expect("a C compiler").success());
    write_scene(&scratch, &["prog.so"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    for word in ["r1", "prog.so", "VWInit", "eyesim cc"] {
        assert!(ran.stderr.contains(word), "`{word}`: {ran:#?}");
    }
}

/// Runs `source` on a single robot in a scene of 5 s; returns the report.
fn run_alone(source: &str, args: &[&str]) -> Value {
    let scratch = Scratch::new();
    scratch.write("alone.c", source);
    write_scene(&scratch, &["alone.c"]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json", "--until", "5"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert!(ran.code.is_some_and(|code| code < 2), "{ran:#?}");
    serde_json::from_str(&scratch.read("r.json")).expect("a report")
}

#[test]
fn a_program_that_prints_without_end_comes_to_the_end_of_its_run() {
    for printing in ["printf(\"x\")", "puts(\"a line\")", "fprintf(stderr, \"far? \")"] {
        let source =
            format!("#include \"eyebot.h\"\n#include <stdio.h>\nint main(void) {{\n  for (;;)\n    {printing};\n}}\n");
        let report = run_alone(&source, &["--output-limit", "0.01"]);
        assert_eq!(report["robots"][0]["outcome"], "running", "{report:#}");
        assert_eq!(report["sim_time_s"], 5.0);
    }
}

#[test]
fn an_unfinished_line_is_shown_before_the_failure_of_its_own_robot() {
    let source = "#include \"eyebot.h\"\n#include <stdio.h>\nint main(void) {\n  int id = OSMachineID(), *none = NULL;\n  printf(\"robot %d\", id);\n\
                  \x20 fprintf(stderr, \"error %d\", id);\n  OSWait(100);\n  if (id == 2)\n    return *none;\n  OSWait(1000);\n  printf(\" ends\\n\");\n\
                  \x20 return 0;\n}\n";
    let digests = ["fiber", "thread"].map(|exec| {
        let scratch = Scratch::new();
        scratch.write("part.c", source);
        write_scene(&scratch, &["part.c", "part.c", "part.c"]);
        let ran = scratch.eyesim(&["run", "scene.sim", "--exec", exec]);
        let lines: Vec<&str> = ran.stdout.lines().filter(|line| line.starts_with('[')).collect();
        assert_eq!(lines, ["[r2 1.000 s] robot 2"], "{exec}: {ran:#?}");
        assert!(ran.stderr.contains("[r2 1.000 s] error 2\n"), "{exec}: {ran:#?}");
        ran.stdout.lines().find(|line| line.starts_with("digest")).map(str::to_owned)
    });
    assert_eq!(digests[0], digests[1]);
    let alone = ["fiber", "process"].map(|exec| {
        let report = run_alone(
            "#include <stdio.h>\nint main(void) { printf(\"part\"); for (;;); }\n",
            &["--exec", exec, "--timeout", "0.3"],
        );
        report["digest"].clone()
    });
    assert_eq!(alone[0], alone[1]);
}

#[test]
fn memory_written_beyond_its_end_is_reported_where_it_is_freed() {
    let source = |bytes: usize| {
        format!(
            "#include \"eyebot.h\"\nint main(void) {{\n  volatile int n = {bytes};\n  char *a = malloc(10), *b = malloc(10);\n\
             \x20 for (int i = 0; i < n; i++)\n    ((volatile char *)a)[i] = 'x';\n  free(a);\n  free(b);\n  LCDPrintf(\"end\\n\");\n\
             \x20 return 0;\n}}\n"
        )
    };
    // Memory behind the newest block belongs to the C library, which checks it when the program allocates more.
    let newest = "#include \"eyebot.h\"\nint main(void) {\n  volatile int *a = malloc(16), n = 400;\n  for (int i = 0; i < n; i++)\n    a[i] = i;\n\
                  \x20 char *b = malloc(100);\n  LCDPrintf(\"%d %d\\n\", a[0], b != 0);\n  return 0;\n}\n";
    for exec in ["auto", "thread", "process"] {
        let robot = |bytes: usize| run_alone(&source(bytes), &["--exec", exec])["robots"][0].clone();
        let inside = robot(10);
        let hints = inside["hints"].as_array().expect("a list");
        assert!(inside["outcome"] == "finished" && hints.is_empty(), "{exec}: {inside:#}");
        let small = robot(11);
        assert_eq!(small["outcome"], "finished", "{exec}: {small:#}");
        let hint = small["hints"].to_string();
        assert!(hint.contains("beyond the end of these 10 bytes") && hint.contains("alone.c:7"), "{exec}: {hint}");
        let far = run_alone(newest, &["--exec", exec])["robots"][0].clone();
        let reason = far["reason"].as_str().expect("a reason");
        let message = "far beyond the end of the 16 bytes reserved at alone.c:3";
        assert!(far["outcome"] == "failed" && reason.contains(message), "{exec}: {reason}");
        let large = robot(400);
        assert_eq!(large["outcome"], "failed", "{exec}: {large:#}");
        let reason = large["reason"].as_str().expect("a reason");
        assert!(reason.contains("written beyond its end") && reason.contains("alone.c:8"), "{exec}: {reason}");
    }
}

#[test]
fn memory_that_is_reallocated_is_not_reported() {
    let source = r#"#include "eyebot.h"
#include <assert.h>
int main(void)
{
  char *made, *line = malloc(10), *whole;
  size_t room = 10, len = 0, i;
  FILE *file = fopen("long.txt", "w");
  for (i = 0; i < 9000; i++)
    fputc('a' + i % 7, file);
  fclose(file);
  file = fopen("long.txt", "r");
  made = malloc(8);
  made = reallocarray(made, 8, 4);
  memset(made, 1, 32);
  free(made);
  made = malloc(5000);
  room = 5000;
  len = getline(&made, &room, file);
  memset(made, 2, room);
  line = realloc(line, 20000);
  memset(line, 3, 20000);
  whole = NULL;
  room = 0;
  rewind(file);
  len += getdelim(&whole, &room, 'g', file);
  assert(len == 9007 && strlen(whole) == 7 && getline(&whole, &room, stdin) == -1);
  free(made);
  free(whole);
  free(line);
  fclose(file);
  return 0;
}
"#;
    for (first, exec) in [("", "fiber"), ("#define _GNU_SOURCE\n", "fiber"), ("#define _GNU_SOURCE\n", "process")] {
        let robot = run_alone(&format!("{first}{source}"), &["--exec", exec])["robots"][0].clone();
        let hints = robot["hints"].to_string();
        assert!(robot["outcome"] == "finished" && !hints.contains("beyond"), "{exec}: {robot:#}");
    }
}
