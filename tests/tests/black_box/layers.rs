//! Layers that programs show: equal for every language and executor, without effect on the run.

use std::process::Command;

use tests::Scratch;

/// If it has an argument, the program shows a layer of each kind, then makes calls that are rejected, and prints all
/// results. `@CALL@` is a call of its generation.
const PROGRAM_C: &str = r#"#include "eyebot.h"
#include "eyesim.h"
#include <stdio.h>
int main(int argc, char **argv)
{
    static unsigned char cells[1025 * 1024];
    double line[] = {0, 0, 0.5, 0, 0.5, 0.1}, points[] = {1, 2, 0.0 / 0.0}, zero = 0;
    int i;
    cells[0] = EYESIM_OCCUPIED;
    cells[1] = EYESIM_UNKNOWN;
    @CALL@
    printf("begin\n");
    if (argc > 1) {
        for (i = 0; i < 3; i++)
            if (eyesim_show_grid("map", EYESIM_ODOMETRY, -1, -1, 0.05, 4 + i, 3, cells))
                return 3;
        if (eyesim_show_line("way", EYESIM_ODOMETRY, 2, 3, line) || eyesim_show_points("hits", EYESIM_WORLD, 3, 0, NULL))
            return 4;
    }
    printf("time %d\n", OSGetCount());
    printf("refused %d%d%d%d%d%d%d\n", eyesim_show_grid("map", EYESIM_WORLD, 0, 0, 1, 1025, 1024, cells),
           eyesim_show_grid("map", 7, 0, 0, 1, 1, 1, cells), eyesim_show_grid("map", EYESIM_WORLD, 0, 0, zero / zero, 1, 1, cells),
           eyesim_show_grid(NULL, EYESIM_WORLD, 0, 0, 1, 1, 1, cells), eyesim_show_points("hits", EYESIM_WORLD, 3, 1, points),
           eyesim_show_points("hits", EYESIM_WORLD, 3, -1, points), eyesim_show_line("way", EYESIM_WORLD, 4, 1, line));
    return argv[0] == NULL;
}
"#;

const PROGRAM_PYTHON: &str = r#"import sys
from eye import *
cells = [0] * 18
cells[0], cells[1] = EYESIM_OCCUPIED, EYESIM_UNKNOWN
print("begin")
if len(sys.argv) > 1:
    for columns in 4, 5, 6:
        assert eyesim_show_grid("map", EYESIM_ODOMETRY, -1, -1, 0.05, columns, 3, bytearray(cells)[: 3 * columns]) == 0
    assert eyesim_show_line("way", EYESIM_ODOMETRY, [(0, 0), (0.5, 0), (0.5, 0.1)]) == 0
    assert eyesim_show_points("hits", EYESIM_WORLD, []) == 0
print("time", OSGetCount())
print("refused ", *(
    eyesim_show_grid("map", EYESIM_WORLD, 0, 0, 1, 1025, 1024, bytes(1025 * 1024)),
    eyesim_show_grid("map", 7, 0, 0, 1, 1, 1, [0]),
    eyesim_show_grid("map", EYESIM_WORLD, 0, 0, float("nan"), 1, 1, [0]),
    eyesim_show_grid("", EYESIM_WORLD, 0, 0, 1, 1, 1, [0]),
    eyesim_show_points("hits", EYESIM_WORLD, [(1, 2, float("nan"))]),
    eyesim_show_points("hits", EYESIM_WORLD, [(0, 0)] * 65537),
    eyesim_show_line("way", EYESIM_WORLD, [(0, 0, 0, 0)]),
), sep="")
"#;

/// Writes a scene `a.scene.toml` with one robot that runs `program` with `arguments`, a TOML value.
fn scratch(name: &str, program: &str, arguments: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write(name, program);
    let robot = format!("type = \"S4\"\nprogram = \"{name}\"\narguments = [{arguments}]\n");
    let pose = "x_mm = 1000\ny_mm = 1000\nheading_deg = 0\n";
    scratch.write("a.scene.toml", &format!("[scene]\n[world]\nfloor_mm = [4000, 4000]\n[[robot]]\n{robot}{pose}"));
    scratch
}

/// Runs the scene and returns the digest, the lines that the program prints, and the recording.
fn run(scratch: &Scratch, args: &[&str]) -> (String, Vec<String>, Vec<u8>) {
    let report = scratch.report("a.scene.toml", &[args, &["--trace", "t.jsonl", "--record", "r.mcap"]].concat(), 0);
    let trace = scratch.trace("t.jsonl");
    let printed = trace.iter().filter(|event| event["event"] == "stdout");
    let printed = printed.map(|event| event["text"].as_str().expect("text").to_owned()).collect();
    let recording = std::fs::read(scratch.path().join("r.mcap")).expect("a recording");
    (report["digest"].as_str().expect("a digest").to_owned(), printed, recording)
}

fn has(recording: &[u8], topic: &str) -> bool {
    recording.windows(topic.len()).any(|window| window == topic.as_bytes())
}

#[test]
fn layers_take_no_time_and_change_no_digest() {
    let of_generation = |call: &str| PROGRAM_C.replace("@CALL@", call);
    let (six, seven) = (of_generation("LCDPutString(\"six\");"), of_generation("VWDone();"));
    let mut programs = vec![("six.c", six.clone()), ("seven.c", seven), ("six.cpp", six)];
    if Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success()) {
        programs.push(("seven.py", PROGRAM_PYTHON.to_owned()));
    }
    for (name, program) in programs {
        let silent = run(&scratch(name, &program, ""), &[]);
        assert_eq!(silent.1[2], "refused 1111111", "{name}: {:?}", silent.1);
        assert!(!has(&silent.2, "/grid/"), "{name}");
        let shown = scratch(name, &program, "\"show\"");
        let executors = if name.ends_with(".py") { &["process"][..] } else { &["fiber", "thread", "process"] };
        for executor in executors {
            let (digest, printed, recording) = run(&shown, &["--exec", executor]);
            assert_eq!((&digest, &printed), (&silent.0, &silent.1), "{name} with --exec {executor}");
            for topic in ["/robot/1/grid/map", "/robot/1/points/way", "/robot/1/points/hits"] {
                assert!(has(&recording, topic), "{name} with --exec {executor}: {topic}");
            }
        }
    }
}

#[test]
fn a_hint_names_the_reason_of_a_refusal() {
    let program = r#"#include "eyebot.h"
#include "eyesim.h"
int main(void)
{
    unsigned char cells[2] = {0, 101};
    LCDClear();
    eyesim_show_grid("map", EYESIM_WORLD, 0, 0, 0.05, 2, 1, cells);
    return 0;
}
"#;
    let ran = scratch("a.c", program, "").eyesim(&["run", "a.scene.toml"]);
    let hint = "`show_grid` returned 1: cell 1 is 101, accepted: 0 (free) to 100 (occupied), 255 (unknown)";
    assert!(ran.stderr.contains(hint) || ran.stdout.contains(hint), "{}{}", ran.stdout, ran.stderr);
}
