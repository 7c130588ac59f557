//! Suites: the examples of the page, rows that depend only on the case, verdicts, messages and output files.

use std::io::{BufRead, BufReader};

use serde_json::Value;
use tests::{Ran, Scratch, root};

/// Blocks of a page in this language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).filter_map(|rest| rest.split_once("\n```")).map(|(block, _)| block).collect()
}

/// Writes the files of docs/suites.md: the scene, its program, and the suites `0.suite.toml` and `1.suite.toml`.
fn of_page() -> Scratch {
    let page = std::fs::read_to_string(root().join("docs/suites.md")).expect("the page");
    let scratch = Scratch::new();
    scratch.write("square.c", blocks(&page, "c")[0]);
    scratch.write("room.scene.toml", blocks(&page, "scene.toml")[0]);
    for (index, suite) in blocks(&page, "suite.toml").into_iter().enumerate() {
        scratch.write(&format!("{index}.suite.toml"), suite);
    }
    scratch
}

/// Runs `eyesim test`, which must end with this exit code.
fn test(scratch: &Scratch, args: &[&str], code: i32) -> Ran {
    let ran = scratch.eyesim(&[&["test"], args].concat());
    assert_eq!(ran.code, Some(code), "{args:?}: {ran:#?}");
    ran
}

fn rows(scratch: &Scratch, report: &str) -> Vec<Value> {
    let report: Value = serde_json::from_str(&scratch.read(report)).expect("a report");
    report["suites"][0]["rows"].as_array().expect("rows").clone()
}

#[test]
fn the_examples_of_the_page_pass() {
    let scratch = of_page();
    let ran = test(&scratch, &["0.suite.toml", "--report", "r.json"], 0);
    assert!(ran.stdout.contains("6 passed, 8 of 8 points"), "{ran:#?}");
    let ran = test(&scratch, &["1.suite.toml", "-v"], 0);
    assert_eq!(ran.stdout.matches("PASSED").count(), 3, "{ran:#?}");
    assert!(ran.stdout.contains("::robot[0].x_mm=500,side=1000,seed=2 PASSED"), "{ran:#?}");
    let ran = test(&scratch, &[], 0);
    assert!(ran.stdout.contains("collected 9 cases of 2 suites"), "{ran:#?}");
    assert!(scratch.eyesim(&["check", "0.suite.toml", "1.suite.toml", "--strict"]).code == Some(0));
}

/// The page's suite with a program that turns too far and, with some seeds, touches the walls.
fn failing() -> Scratch {
    let scratch = of_page();
    let suite =
        scratch.read("0.suite.toml").replace("within_mm = 100", "within_mm = 4").replace("\"mild\"", "\"harsh\"");
    scratch.write("0.suite.toml", &suite.replace("1..3", "1..8"));
    let program = scratch.read("square.c");
    scratch.write("square.c", &program.replace("return 0;", "printf(\"METRIC side_mm=%d\\n\", side);\n    return 0;"));
    scratch
}

#[test]
fn rows_do_not_depend_on_the_number_of_workers_or_on_isolation() {
    let scratch = failing();
    let run = |name: &str, args: &[&str]| {
        test(&scratch, &[&["0.suite.toml", "--report", name], args].concat(), 1);
        scratch.read(name)
    };
    let first = run("a.json", &["-j", "1"]);
    assert_eq!(run("b.json", &["-j", "2"]), first);
    assert_eq!(run("c.json", &["-j", "2", "--isolate"]), first);
    assert_eq!(run("d.json", &["-j", "5", "-q"]), first);
    let rows = rows(&scratch, "a.json");
    assert_eq!(rows.len(), 16);
    let keys: std::collections::BTreeSet<&str> = rows.iter().map(|row| row["key"].as_str().expect("a key")).collect();
    assert_eq!(keys.len(), 16, "a key for each case");
    let metrics: Vec<&Value> = rows.iter().map(|row| &row["robots"][0]["metrics"]["side_mm"]).collect();
    assert!(metrics.iter().all(|metric| metric.as_f64() == Some(1000.0)), "{metrics:?}");
    // A row equals the result of a separate run.
    let words: Vec<&str> =
        rows[9]["words"].as_array().expect("words").iter().map(|word| word.as_str().expect("a word")).collect();
    scratch.eyesim(&[&["run", "--report", "run.json"], &words[..]].concat());
    let report: Value = serde_json::from_str(&scratch.read("run.json")).expect("a report");
    assert_eq!(report["digest"], rows[9]["digest"]);
}

#[test]
fn a_failure_reports_the_check_the_location_and_the_command_to_view_it() {
    let scratch = failing();
    let ran = test(&scratch, &["0.suite.toml", "-k", "harsh and seed=1", "--junit", "j.xml", "--html", "pages"], 1);
    for part in [
        "FAILED  comes home",
        "0/3",
        "X: (",
        "to see it: eyesim view room.scene.toml",
        "--noise=harsh",
        "FAILED 0.suite.toml::noise=harsh,seed=1 - comes home: ",
    ] {
        assert!(ran.stdout.contains(part), "{part}: {}", ran.stdout);
    }
    let junit = scratch.read("j.xml");
    assert!(
        junit.contains("tests=\"1\"") && junit.contains("failures=\"1\"") && junit.contains("noise=harsh,seed=1"),
        "{junit}"
    );
    let page = scratch.read("pages/index.html");
    for part in ["<table class=\"map\">", "<svg", "comes home", "<details"] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("http:") || page.matches("http:").count() == page.matches("http://www.w3.org").count());
    // `--lf` runs only the failed cases; if there are none, it runs all.
    let ran = test(&scratch, &["0.suite.toml", "--lf"], 1);
    assert!(ran.stdout.contains("collected 16 cases / 15 deselected / 1 selected"), "{ran:#?}");
    // A failure that is not selected stays remembered, and a suite without failures does not run beside one with some.
    scratch.write("1.suite.toml", &scratch.read("0.suite.toml").replace("within_mm = 4", "within_mm = 400"));
    test(&scratch, &["0.suite.toml", "1.suite.toml", "-k", "none and seed=1"], 0);
    let ran = test(&scratch, &["0.suite.toml", "1.suite.toml", "--lf"], 1);
    assert!(ran.stdout.contains("collected 32 cases of 2 suites / 31 deselected / 1 selected"), "{ran:#?}");
}

#[test]
fn programs_that_crash_hang_or_do_not_compile_give_rows() {
    let scratch = of_page();
    let suite = scratch.read("0.suite.toml") + "\n[limits]\nslot_processor_s = 0.5\n";
    scratch.write("0.suite.toml", &suite.replace("\"none\", \"mild\"", "\"mild\""));
    let program =
        |body: &str| format!("#include \"eyebot.h\"\n#include <stdlib.h>\nint main() {{ {body} return 0; }}\n");
    let cases = [
        ("VWStraight(1000, 200) VWWait();", "E", "cannot be compiled"),
        ("for (volatile int i = 0;; i++);", "F", "processor time"),
        ("int *p = 0; *p = 1;", "F", "SIGSEGV"),
        ("abort();", "F", "abort"),
        ("KEYWait(KEY4);", "F", "KEY4"),
    ];
    for (body, letter, _) in cases {
        scratch.write("mine.c", &program(body));
        let ran = test(&scratch, &["0.suite.toml", "--program", "1=mine.c", "--report", "r.json"], 1);
        assert!(ran.stdout.contains(&format!("0.suite.toml {}", letter.repeat(3))), "{body}: {ran:#?}");
        let rows = rows(&scratch, "r.json");
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|row| !row["message"].as_str().expect("a message").is_empty()), "{rows:#?}");
        if letter == "E" {
            assert!(rows[2]["details"].as_str().expect("details").contains("mine.c:"), "{rows:#?}");
        }
    }
}

#[test]
fn a_program_that_writes_into_the_pools_connection_fails_only_its_case() {
    let scratch = of_page();
    let scribble = |text: &str| {
        let write = format!("for (int fd = 3; fd < 64; fd++) write(fd, {text});");
        format!("#include \"eyebot.h\"\n#include <unistd.h>\nint main(void) {{ {write} return 0; }}\n")
    };
    let long = "\"\\xff\\xff\\xff\\xff\\x7f\", 5";
    let empty = "\"\\0\\2\\0\\0\\0{}\", 7";
    for text in [long, empty] {
        scratch.write("square.c", &scribble(text));
        let ran = test(&scratch, &["0.suite.toml", "--report", "r.json"], 1);
        for row in rows(&scratch, "r.json") {
            assert_eq!(row["outcome"], "error", "{row:#}");
            let message = row["message"].as_str().expect("a message");
            assert!(message.contains("sent an invalid result"), "{message}\n{ran:#?}");
        }
    }
}

#[test]
fn an_input_that_changes_meanwhile_is_reported() {
    let scratch = of_page();
    let program =
        "import os\nfrom eye import *\nwith open('room.scene.toml', 'a') as scene:\n    scene.write('# changed\\n')\n";
    scratch.write("writes.py", program);
    let args = ["0.suite.toml", "-j", "1", "--program", "1=writes.py", "--report", "r.json"];
    test(&scratch, &args, 1);
    let rows = rows(&scratch, "r.json");
    let message = rows[rows.len() - 1]["message"].as_str().expect("a message");
    assert!(message.contains("`room.scene.toml` has changed since the first case"), "{message}");
}

#[test]
fn outputs_do_not_overwrite_programs() {
    let scratch = of_page();
    scratch.write("mine.c", "int main(void) { return 0; }\n");
    for option in ["--report", "--junit"] {
        let ran = test(&scratch, &["0.suite.toml", "--program", "1=mine.c", option, "mine.c"], 2);
        assert!(ran.stderr.contains("would overwrite the input `mine.c`"), "{ran:#?}");
    }
}

#[test]
fn cases_that_were_not_run_are_reported() {
    let scratch = failing();
    let files = ["--report", "r.json", "--junit", "r.xml", "--html", "h"];
    let ran = test(&scratch, &[&["0.suite.toml", "-x", "-j", "1"], &files[..]].concat(), 1);
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let missing = report["missing"].as_u64().expect("a number");
    assert!(missing > 0 && report["passed"] == false, "{report:#}");
    assert_eq!(missing as usize + report["suites"][0]["rows"].as_array().expect("rows").len(), 16);
    let words = format!("{missing} not run");
    assert!(ran.stdout.contains(&words) && scratch.read("h/index.html").contains(&words), "{ran:#?}");
    assert_eq!(scratch.read("r.xml").matches("message=\"not run\"").count(), missing as usize);
    // Without the missing cases nobody knows whether enough of the seeds pass.
    scratch.write("0.suite.toml", &scratch.read("0.suite.toml").replace("pass_rate = 0.8", "pass_rate = 0"));
    let ran = test(&scratch, &["0.suite.toml", "-x", "-j", "1"], 1);
    assert!(ran.stdout.contains(" not run") && !ran.stdout.contains("pass rate met"), "{ran:#?}");
}

#[test]
fn wrong_suites_are_reported() {
    let scratch = of_page();
    let base = scratch.read("0.suite.toml");
    let cases = [
        ("seed = \"1..3\"", "seed = \"1..1000000000\"", "suite-cases"),
        ("seed = \"1..3\"", "seed = \"1..300000\"\nslot_ms = [20, 50]", "suite-cases"),
        ("seed = \"1..3\"", "seed = true", "toml-type"),
        ("seed = \"1..3\"", "seed = [1, 1]", "toml-conflict"),
        ("seed = \"1..3\"", "slot_ms = [50, 20, 50.0]", "toml-conflict"),
        ("seed = \"1..3\"", "scene = [\"room.scene.toml\", \"./room.scene.toml\"]", "toml-conflict"),
        ("seed = \"1..3\"", "seed = 1\nexclude = [{ seed = 1 }]", "suite-cases"),
        ("seed = \"1..3\"", "seed = 1\nzip = [[\"noise\", \"world\"]]", "suite-axis"),
        ("until_s = 60", "arguments = [\"{kp}\"]", "suite-parameter"),
        ("scene = \"room.scene.toml\"", "scene = \"hall.scene.toml\"", "file-missing"),
        ("scene = \"room.scene.toml\"\n", "", "toml-missing"),
        ("within_mm = 100", "within_mm = 100\nrobot = 7", "check-body"),
        ("seed = \"1..3\"", "seed = 1\nset = { \"robot[4].x_mm\" = [1] }", "set-path"),
        ("seed = \"1..3\"", "seed = 1\nset = { \"robot[0].xmm\" = [1] }", "toml-key"),
        ("[suite]", "[suit]", "toml-missing"),
    ];
    for (old, new, code) in cases {
        assert!(base.contains(old), "{old}");
        scratch.write("w.suite.toml", &base.replace(old, new));
        let ran = test(&scratch, &["w.suite.toml"], 2);
        assert!(ran.stderr.contains(code), "{new}: {ran:#?}");
        assert!(scratch.eyesim(&["explain", code]).code == Some(0));
    }
    scratch.write("w.suite.toml", "");
    test(&scratch, &["w.suite.toml"], 2);
    test(&scratch, &["room.scene.toml"], 2);
    test(&scratch, &["nowhere.suite.toml"], 2);
    test(&scratch, &["0.suite.toml", "-k", "seed=99"], 5);
    let ran = test(&scratch, &["0.suite.toml", "-k", "(a"], 2);
    assert!(ran.stderr.contains("not closed"), "{ran:#?}");
    // Values that advance together may recur.
    scratch
        .write("w.suite.toml", &base.replace("seed =", "slot_ms = [50, 50]\nzip = [\"noise\", \"slot_ms\"]\nseed ="));
    test(&scratch, &["w.suite.toml", "--collect-only"], 0);
    scratch.write("w.suite.toml", &base.replace("until_s", "untils"));
    let ran = test(&scratch, &["w.suite.toml", "--collect-only"], 0);
    assert!(ran.stderr.contains("toml-key"), "an unknown key is a warning: {ran:#?}");
    assert!(
        scratch.eyesim(&["run", "room.scene.toml", "--set", "robot[0].y_mm=oops"]).stderr.contains("is not a value")
    );
}

#[test]
fn a_pipe_as_scene_and_a_full_disk_are_reported() {
    let scratch = of_page();
    let pipe = scratch.path().join("pipe.scene.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let suite = scratch.read("0.suite.toml");
    scratch.write("p.suite.toml", &suite.replace("room.scene.toml", "pipe.scene.toml"));
    let ran = test(&scratch, &["p.suite.toml"], 2);
    assert!(ran.stderr.contains("not a file"), "{ran:#?}");
    let ran = test(&scratch, &["0.suite.toml", "--report", "/dev/full"], 2);
    assert!(ran.stderr.contains("--report") && ran.stdout.contains("6 passed"), "{ran:#?}");
}

#[test]
fn ctrl_c_reports_the_cases_that_have_run() {
    let scratch = of_page();
    let suite = scratch.read("0.suite.toml").replace("until_s = 60", "until_s = 100000").replace("1..3", "1..100000");
    scratch.write("0.suite.toml", &suite.replace("1:KEY1", "100000:KEY1"));
    let mut command = scratch.command(&["test", "-v", "0.suite.toml", "--report", "r.json"]);
    let mut child = command.stdout(std::process::Stdio::piped()).spawn().expect("eyesim starts");
    let mut lines = BufReader::new(child.stdout.take().expect("a pipe")).lines().map(|line| line.expect("UTF-8"));
    assert!(lines.any(|line| line.contains("0.suite.toml::")), "no case has run");
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill").success());
    let rest: Vec<_> = lines.collect();
    assert_eq!(child.wait().expect("the process ends").code(), Some(130), "{rest:#?}");
    assert!(rest.iter().any(|line| line.contains("interrupted")), "{rest:#?}");
    assert!(scratch.read("r.json").contains("\"rows\""));
}

#[test]
fn a_new_project_has_a_suite_that_passes() {
    let scratch = Scratch::new();
    assert_eq!(scratch.eyesim(&["new", "walls", "--suite", "--api", "7"]).code, Some(0));
    let ran = test(&scratch, &["walls"], 0);
    assert!(ran.stdout.contains("10 passed"), "{ran:#?}");
}

#[test]
fn programs_of_checks_judge_cases_and_their_failures_are_errors() {
    let scratch = of_page();
    let suite = scratch.read("0.suite.toml");
    let check = "[[check]]\nname = \"way\"\nkind = \"script\"\nprogram = \"grade.py\"\npoints = 2\n";
    scratch.write("0.suite.toml", &format!("{suite}\n{check}"));
    let grade = "import json, sys\nreport = json.load(open(sys.argv[1]))\n\
                 print(json.dumps({'passed': report['seed'] != 2, 'message': f\"seed {report['seed']}\"}))\n";
    scratch.write("grade.py", grade);
    for args in [&["-j1"][..], &["--isolate"]] {
        test(&scratch, &[&["0.suite.toml", "--report", "r.json"], args].concat(), 1);
        for row in rows(&scratch, "r.json") {
            let is_passed = row["seed"] != 2;
            assert_eq!(row["outcome"], if is_passed { "passed" } else { "failed" }, "{row:#}");
        }
    }
    let key = |scratch: &Scratch| rows(scratch, "r.json")[0]["key"].clone();
    let before = key(&scratch);
    scratch.write("grade.py", "1 / 0\n");
    let ran = test(&scratch, &["0.suite.toml", "--report", "r.json"], 1);
    assert!(ran.stdout.contains("ZeroDivisionError"), "{ran:#?}");
    assert!(rows(&scratch, "r.json").iter().all(|row| row["outcome"] == "error"), "the student is not to blame");
    assert_ne!(key(&scratch), before, "the program is an input");
}

#[test]
fn keys_of_rows_do_not_depend_on_lines_of_checks() {
    let scratch = of_page();
    let key = || {
        test(&scratch, &["0.suite.toml", "-k", "none and seed=1", "--report", "r.json"], 0);
        rows(&scratch, "r.json")[0]["key"].clone()
    };
    let suite = scratch.read("0.suite.toml");
    let before = key();
    scratch.write("0.suite.toml", &suite.replace("[[check]]", "# a comment\n\n[[check]]"));
    assert_eq!(key(), before);
    scratch.write("0.suite.toml", &suite.replace("within_mm = 100", "within_mm = 101"));
    assert_ne!(key(), before);
}

#[test]
fn scenes_and_suites_name_each_others_commands() {
    let scratch = of_page();
    let ran = scratch.eyesim(&["run", "0.suite.toml"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("is a suite: `eyesim test 0.suite.toml` runs it"), "{ran:#?}");
    let ran = scratch.eyesim(&["test", "room.scene.toml"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("is a scene: `eyesim run room.scene.toml` runs it"), "{ran:#?}");
    // Mail programs add `.txt`.
    scratch.write("a.sim.txt", "world %sim%/worlds/empty.wld\n");
    for args in [&["a.sim.txt"][..], &["test", "a.sim.txt"]] {
        let ran = scratch.eyesim(args);
        assert!(ran.code == Some(2) && ran.stderr.contains("`eyesim run a.sim.txt`"), "{ran:#?}");
    }
}

#[test]
fn options_that_fit_no_robot_end_the_command_before_any_case() {
    let scratch = of_page();
    for (args, said) in [
        (&["0.suite.toml", "--program", "2=square.c"][..], "there is no robot 2: the scene has only robot 1"),
        (&["0.suite.toml", "--program", "maze=square.c"], "no robot has a program or a type `maze`"),
    ] {
        let ran = test(&scratch, args, 2);
        assert!(ran.stderr.contains(said) && !ran.stdout.contains("collected"), "{ran:#?}");
    }
    let scene = scratch.read("room.scene.toml").replace("program = \"square.c\"\n", "");
    scratch.write("room.scene.toml", &scene);
    let ran = test(&scratch, &["0.suite.toml"], 2);
    assert!(ran.stderr.contains("no robot of `room.scene.toml` has a program"), "{ran:#?}");
    test(&scratch, &["0.suite.toml", "--program", "1=square.c"], 0);
}

#[test]
fn a_hanging_case_reports_its_time_and_the_command_to_view_a_failure_includes_the_checks() {
    let scratch = of_page();
    let suite = scratch.read("0.suite.toml").replace("pass_rate", "# pass_rate");
    scratch.write("0.suite.toml", &format!("{suite}\n[limits]\nslot_processor_s = 0.2\n"));
    scratch.write("square.c", "#include \"eyebot.h\"\nint main(void) { OSWait(203); for (;;) ; }\n");
    let ran = test(&scratch, &["0.suite.toml", "-k", "none and seed=1", "--report", "r.json"], 1);
    let row = &rows(&scratch, "r.json")[0];
    assert_eq!((&row["at_s"], &row["outcome"]), (&serde_json::json!(2.0), &serde_json::json!("failed")), "{row:#}");
    assert!(ran.stdout.contains("--checks=0.suite.toml") && ran.stdout.contains("--at 1.0"), "{ran:#?}");

    scratch.write("square.c", "#include \"eyebot.h\"\nint main(void) { VWStraight(100, 200); VWWait(); return 0; }\n");
    test(&scratch, &["0.suite.toml", "-k", "none and seed=1", "--report", "r.json"], 1);
    let row = &rows(&scratch, "r.json")[0];
    let words: Vec<&str> = row["words"].as_array().expect("words").iter().filter_map(Value::as_str).collect();
    let report = scratch.report(words[0], &words[1..], 1);
    assert_eq!((&report["digest"], &report["checks"]), (&row["digest"], &row["checks"]));
    let ran = scratch.eyesim(&["run", "room.scene.toml", "--checks", "nowhere.suite.toml"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("--checks `nowhere.suite.toml`"), "{ran:#?}");
}
