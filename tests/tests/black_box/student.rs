//! Common mistakes of beginners: the message names the mistake and its correction.

use tests::{Scratch, write_scene};

/// Standard error and exit code of a run of one program.
fn messages(program: &str) -> (String, Option<i32>) {
    let scratch = Scratch::new();
    scratch.write("mine.c", program);
    write_scene(&scratch, &["mine.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    (ran.stderr, ran.code)
}

#[test]
fn the_program_is_named_in_place_of_the_scene() {
    let scratch = Scratch::new();
    scratch.write("mine.c", "int main(void) { return 0; }\n");
    let ran = scratch.eyesim(&["run", "mine.c"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert_eq!(ran.stderr.lines().count(), 1, "{ran:#?}");
    assert!(ran.stderr.contains("`mine.c` is not a scene"), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "."]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("`.` is a folder"), "{ran:#?}");
}

#[test]
fn a_sensor_is_read_before_it_is_initialised() {
    let (messages, code) = messages("#include \"eyebot.h\"\nint main(void) { PSDGet(PSD_FRONT); return 0; }\n");
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("`PSDGet` with a handle that `PSDInit` did not give"), "{messages}");
}

#[test]
fn millimetres_are_given_for_metres() {
    let program = "#include \"eyebot.h\"\nint main(void)\n{\n    VWHandle vw = VWInit(VW_DRIVE, 1);\n    \
                   VWDriveStraight(vw, 1000, 0.2);\n    return 0;\n}\n";
    let (messages, code) = messages(program);
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("RoBIOS 6 takes metres, not millimetres"), "{messages}");
}

#[test]
fn a_function_is_misspelt() {
    let program = "#include \"eyebot.h\"\nint main(void) { LCDPrint(\"hi\"); return 0; }\n";
    let (messages, code) = messages(program);
    assert_eq!(code, Some(2), "{messages}");
    assert!(messages.contains("`LCDPrint` is not defined; did you mean `LCDPrintf`?"), "{messages}");
}

#[test]
fn a_device_that_the_robot_lacks_is_reported() {
    let (messages, _) = messages("#include \"eyebot.h\"\nint main(void) { PSDInit(PSD_LEFT); return 0; }\n");
    assert!(messages.contains("has no `PSD_LEFT`; of this kind it has: PSD_FRONT"), "{messages}");
}

#[test]
fn a_scene_written_on_windows_runs() {
    let scratch = Scratch::new();
    scratch.write("sub/mine.c", "int main(void) { return 0; }\r\n");
    write_scene(&scratch, &["sub\\mine.dll"]);
    let scene = scratch.read("scene.sim").replace('\n', "\r\n");
    scratch.write("scene.sim", &scene);
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

/// The first line of `text` that contains `words`.
fn line_with<'a>(text: &'a str, words: &str) -> &'a str {
    text.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("no `{words}` in:\n{text}"))
}

#[test]
fn a_hint_has_the_line_of_the_program_on_the_terminal_and_in_the_report() {
    let c = "#include \"eyebot.h\"\nint main(void)\n{\n  VWTurn(90, 90);\n  VWStraight(100, 100);\n  return 0;\n}\n";
    let python = "from eye import *\n\n\nVWTurn(90, 90)\nVWStraight(100, 100)\n";
    for (name, text) in [("mine.c", c), ("mine.py", python)] {
        let scratch = Scratch::new();
        scratch.write(name, text);
        scratch.write("scene.sim", &format!("world %sim%/worlds/empty.wld\nS4 500 500 0 {name}\n"));
        for execution in ["fiber", "thread", "process"] {
            let ran = scratch.eyesim(&["run", "scene.sim", "--exec", execution, "--report", "report.json"]);
            let line = line_with(&ran.stderr, "hint: ");
            assert!(
                line.contains(&format!(" s] {name}:5: hint: this drive replaces the previous one")),
                "{execution}: {ran:#?}"
            );
            let report: serde_json::Value = serde_json::from_str(&scratch.read("report.json")).expect("a report");
            let hint = &report["robots"][0]["hints"][0];
            assert_eq!(hint["at"], format!("{name}:5"), "{execution}: {report:#}");
            assert!(
                hint["text"].as_str().expect("a text").starts_with("this drive replaces"),
                "{execution}: {report:#}"
            );
        }
    }
}

#[test]
fn standard_input_is_read_at_a_line() {
    let text = "#include <stdio.h>\n#include \"eyebot.h\"\nint main(void)\n{\n  int n = 0;\n  LCDClear();\n  scanf(\"%d\", &n);\n  return n;\n}\n";
    for execution in ["fiber", "thread", "process"] {
        let scratch = Scratch::new();
        scratch.write("mine.c", text);
        write_scene(&scratch, &["mine.c"]);
        let ran = scratch.eyesim(&["run", "scene.sim", "--exec", execution]);
        assert!(line_with(&ran.stderr, "standard input").contains(" s] mine.c:7: hint: "), "{execution}: {ran:#?}");
    }
}

#[test]
fn the_file_that_fopen_did_not_find_is_named_where_its_null_pointer_is_used() {
    let text = "#include <stdio.h>\nint main(void)\n{\n  char line[80];\n  FILE *map = fopen(\"map.txt\", \"r\");\n  fgets(line, 80, map);\n  return 0;\n}\n";
    for execution in ["fiber", "process"] {
        let scratch = Scratch::new();
        scratch.write("mine.c", text);
        write_scene(&scratch, &["mine.c"]);
        let ran = scratch.eyesim(&["run", "scene.sim", "--exec", execution]);
        let line = line_with(&ran.stderr, "null pointer used");
        let why = "at mine.c:6; `fopen` has returned NULL before: there is no file `map.txt` in `";
        assert!(line.contains(why) && line.contains("`, the folder in which eyesim runs"), "{execution}: {ran:#?}");
    }
}

#[test]
fn a_program_that_breaks_the_heap_ends_with_a_message() {
    let text = "#include <stdio.h>\n#include <stdlib.h>\nint main(void)\n{\n  int *map = malloc(4 * sizeof(int));\n  \
                for (int i = 0; i <= 400; i++)\n    map[i] = i;\n  printf(\"%d\\n\", map[3]);\n  free(map);\n  return 0;\n}\n";
    for execution in ["fiber", "thread", "process"] {
        let (messages, code) = {
            let scratch = Scratch::new();
            scratch.write("mine.c", text);
            write_scene(&scratch, &["mine.c"]);
            let ran = scratch.eyesim(&["run", "scene.sim", "--exec", execution]);
            (ran.stderr, ran.code)
        };
        assert_eq!(code, Some(1), "{execution}: {messages}");
        let line = line_with(&messages, "far beyond the end of the 16 bytes");
        assert!(line.contains("reserved at mine.c:5"), "{execution}: {messages}");
    }
}

#[test]
fn an_endless_loop_is_reported_with_its_line_and_what_to_do() {
    let scratch = Scratch::new();
    scratch.write("mine.c", "int main(void)\n{\n  while (1)\n    ;\n}\n");
    write_scene(&scratch, &["mine.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--timeout", "0.5"]);
    let line = line_with(&ran.stderr, "endless loop");
    assert!(line.contains("at mine.c:") && line.contains("put a call that waits into the loop"), "{ran:#?}");
}

#[test]
fn a_loop_that_waits_for_another_task_is_reported_with_what_to_do() {
    let scratch = Scratch::new();
    let text = "#include <pthread.h>\nvolatile int front = 9999;\nvoid *sense(void *none) { front = 0; return none; }\nint main(void)\n{\n  \
                pthread_t task;\n  pthread_create(&task, 0, sense, 0);\n  while (front > 300)\n    ;\n  return 0;\n}\n";
    scratch.write("mine.c", text);
    write_scene(&scratch, &["mine.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--timeout", "0.5"]);
    let line = line_with(&ran.stderr, "endless loop");
    assert!(line.contains("other tasks run only during calls") && !line.contains("leave it out"), "{ran:#?}");
}

#[test]
fn an_endless_loop_after_the_end_of_the_input_names_the_file_that_was_not_opened() {
    let scratch = Scratch::new();
    let text = "#include <stdio.h>\nint main(void)\n{\n  FILE *map = fopen(\"map.txt\", \"r\");\n  getchar();\n  while (map == NULL)\n    ;\n  \
                return 0;\n}\n";
    scratch.write("mine.c", text);
    write_scene(&scratch, &["mine.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--timeout", "0.5"]);
    let line = line_with(&ran.stderr, "endless loop");
    assert!(line.contains("before that it could not open a file: there is no file `map.txt`"), "{ran:#?}");
}

#[test]
fn a_program_without_a_call_gets_the_hint_that_its_robot_did_nothing() {
    let words = "has called no function of RoBIOS: its robot has done nothing";
    let (idle, code) = messages("int main(void) { return 0; }\n");
    assert!(code == Some(0) && idle.contains(&format!("r1 (`mine.c`) {words}")), "{idle}");
    let (busy, _) = messages("#include \"eyebot.h\"\nint main(void) { LCDClear(); return 0; }\n");
    assert!(!busy.contains(words), "{busy}");
}

#[test]
fn a_call_with_wrong_values_is_reported_for_the_generation_of_the_scene() {
    for (call, words) in [
        ("int x = 0; VWGetPosition(x, x, x);", "write `&` before its name"),
        (
            "int x, y; VWGetPosition(&x, &y);",
            "`VWGetPosition` is called with too few values: `int VWGetPosition(int *x, int *y, int *phi)`",
        ),
    ] {
        let scratch = Scratch::new();
        scratch.write("mine.c", &format!("#include \"eyebot.h\"\nint main(void)\n{{\n  {call}\n  return 0;\n}}\n"));
        scratch.write("scene.sim", "world %sim%/worlds/empty.wld\nS4 500 500 0 mine.c\n");
        let ran = scratch.eyesim(&["run", "scene.sim"]);
        assert!(line_with(&ran.stderr, "mine.c:4: ").contains(words), "{ran:#?}");
    }
}

#[test]
fn results_and_parentheses_that_python_drops_are_reported() {
    let scratch = Scratch::new();
    let text =
        "from eye import *\nx, y, phi = 0, 0, 0\nVWGetPosition(x, y, phi)\nx, y, phi = VWGetPosition()\nVWWait\n";
    scratch.write("mine.py", text);
    scratch.write("scene.sim", "world %sim%/worlds/empty.wld\nS4 500 500 0 mine.py\n");
    let ran = scratch.eyesim(&["run", "scene.sim"]);
    assert!(
        ran.stderr
            .contains("mine.py:3: hint: `VWGetPosition` returns what it reads: write `x, y, phi = VWGetPosition()`"),
        "{ran:#?}"
    );
    assert!(ran.stderr.contains("mine.py:5: hint: `VWWait` without `()` does nothing: write `VWWait()`"), "{ran:#?}");
    assert_eq!(ran.stderr.matches("hint: ").count(), 2, "{ran:#?}");
}

#[test]
fn ranges_that_run_backwards_and_numbers_of_jobs_are_reported() {
    let scratch = Scratch::new();
    scratch.write("mine.c", "int main(void) { return 0; }\n");
    write_scene(&scratch, &["mine.c"]);
    scratch.write("a.suite.toml", "[suite]\nscene = \"scene.sim\"\n\n[matrix]\nseed = \"20..1\"\n");
    let ran = scratch.eyesim(&["test", "a.suite.toml"]);
    let expected = "a.suite.toml:5:8: error[number-range]: the range `20..1` runs backwards; expected \"1..20\"";
    assert!(ran.stderr.contains(expected), "{ran:#?}");
    for jobs in ["0", "-1", "many"] {
        let ran = scratch.eyesim(&["test", "a.suite.toml", "-j", jobs]);
        assert!(ran.code == Some(2) && ran.stderr.contains("expected a whole number from 1"), "{ran:#?}");
    }
}
