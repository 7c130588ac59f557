//! Robots that share a library, and programs that share a C library, do not share state.

use serde_json::Value;
use tests::{Ran, Scratch, number, write_scene};

/// Writes `source` as `prog.c`, runs it on `robots` robots, expects the exit code `code`, and returns the report and
/// what was printed.
fn run(source: &str, robots: usize, args: &[&str], code: i32) -> (Value, Ran) {
    let scratch = Scratch::new();
    scratch.write("prog.c", source);
    write_scene(&scratch, &vec!["prog.c"; robots]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert_eq!(ran.code, Some(code), "{ran:#?}");
    (serde_json::from_str(&scratch.read("r.json")).expect("a report"), ran)
}

/// First line of robot `index`'s display.
fn lcd(report: &Value, index: usize) -> String {
    report["robots"][index]["lcd"][0].as_str().expect("a line of text").trim_end().to_owned()
}

#[test]
fn globals_are_the_robots_own() {
    let source = r#"
        #include "eyebot.h"
        int counter;
        int main(void) {
            static int rounds = 0;
            while (rounds < 5) { counter++; rounds++; OSWait(7); }
            LCDPrintf("%d %d\n", counter, rounds);
            return 0;
        }"#;
    let (report, _) = run(source, 2, &["--threads", "2"], 0);
    assert_eq!([lcd(&report, 0), lcd(&report, 1)], ["5 5", "5 5"]);
}

const RANDOM: &str = r#"
    #include <stdlib.h>
    #include "eyebot.h"
    int main(void) {
        int i; unsigned sum = 0;
        for (i = 0; i < 50; i++) { sum = sum * 31 + rand() + random() + (unsigned)(1000 * drand48()); OSWait(1); }
        LCDPrintf("%08x ", sum);
        srand(7); sum = rand();
        srand(7);
        LCDPrintf("%d", sum == (unsigned)rand());
        return 0;
    }"#;

#[test]
fn random_numbers_are_the_robots_own_and_do_not_depend_on_threads() {
    let (one, _) = run(RANDOM, 2, &["--threads", "1", "--seed", "3"], 0);
    let (two, _) = run(RANDOM, 2, &["--threads", "2", "--seed", "3"], 0);
    let (other, _) = run(RANDOM, 2, &["--threads", "2", "--seed", "4"], 0);
    assert_ne!(lcd(&one, 0), lcd(&one, 1), "each robot has its own sequence");
    assert_eq!([lcd(&one, 0), lcd(&one, 1)], [lcd(&two, 0), lcd(&two, 1)], "the same on one thread and two");
    assert_ne!(lcd(&one, 0), lcd(&other, 0), "another seed, another sequence");
    assert!(lcd(&one, 0).ends_with(" 1"), "srand restarts the sequence: {}", lcd(&one, 0));
}

#[test]
fn exit_ends_only_its_robot() {
    let source = r#"
        #include <stdio.h>
        #include <stdlib.h>
        #include "eyebot.h"
        static void bye(void) { printf("bye\n"); }
        int main(void) {
            atexit(bye);
            if (OSMachineID() == 1) exit(0);
            OSWait(100);
            printf("still here at %d\n", OSGetCount());
            return 0;
        }"#;
    let (report, ran) = run(source, 2, &[], 0);
    assert_eq!(report["robots"][0]["outcome"], "finished");
    assert_eq!(report["robots"][1]["outcome"], "finished");
    assert!(number(&report["robots"][0], "virtual_time_s") < 0.1);
    assert!(number(&report["robots"][1], "virtual_time_s") > 1.0);
    assert!(ran.stdout.contains("still here at 100"), "{}", ran.stdout);
    assert_eq!(ran.stdout.matches("bye").count(), 2, "{}", ran.stdout);
}

#[test]
fn exit_codes_and_abort_fail_only_their_robot() {
    let source = r#"
        #include <assert.h>
        #include <stdlib.h>
        #include "eyebot.h"
        int main(void) {
            switch (OSMachineID()) {
                case 1: exit(3);
                case 2: abort();
                case 3: assert(OSMachineID() == 4);
            }
            OSWait(100);
            return 0;
        }"#;
    let (report, _) = run(source, 4, &[], 1);
    let outcomes: Vec<_> = (0..4).map(|i| report["robots"][i]["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["failed", "failed", "failed", "finished"]);
    assert_eq!(report["robots"][0]["exit_code"], 3);
    assert!(report["robots"][2]["reason"].as_str().unwrap().contains("OSMachineID() == 4"), "{report:#}");
}

#[test]
fn a_function_named_like_one_of_the_c_library_is_the_programs_own() {
    let scratch = Scratch::new();
    scratch.write(
        "prog.c",
        r#"
        #include "eyebot.h"
        int time(int x) { return x + 40; }
        double y1(double x) { return x + 0.5; }
        int index = 7;
        int main(void) { LCDPrintf("%d %.1f %d", time(2), y1(1.0), index); return 0; }"#,
    );
    write_scene(&scratch, &["prog.c"]);
    let report = scratch.report("scene.sim", &[], 0);
    assert_eq!(lcd(&report, 0), "42 1.5 7");
}

#[test]
fn time_is_virtual() {
    let source = r#"
        #include <stdio.h>
        #include <time.h>
        #include <unistd.h>
        #include "eyebot.h"
        int main(void) {
            time_t start = time(0);
            sleep(1000);
            usleep(500000);
            printf("%ld %d\n", (long)(time(0) - start), OSGetCount() / 10);
            return 0;
        }"#;
    let (_, ran) = run(source, 1, &["--until", "2000"], 0);
    assert!(ran.stdout.contains("1000 10005") || ran.stdout.contains("1001 10005"), "{}", ran.stdout);
    assert!(ran.stdout.contains("[r1 1000.5"), "the line carries its virtual time: {}", ran.stdout);
}
