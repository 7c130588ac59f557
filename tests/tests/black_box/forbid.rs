//! Forbidden functions: they fail as documented, without any effect, in every language and executor. The report counts
//! and names the calls, and a check can deduct points for them.

use std::collections::BTreeSet;

use robios_sys::Robios7Call;
use serde_json::{Value, json};
use tests::{Scratch, number, root};

const ROOM: &str =
    "[world]\nfloor_mm = [3000, 2000]\n\n[[robot]]\ntype = \"S4\"\nprogram = \"a.c\"\nx_mm = 500\ny_mm = 500\n";

/// Prints return values and outputs of forbidden functions, and drives 0.4 m.
const CHEAT: &str = "#include \"eyebot.h\"\n\
    int main(void) {\n\
    int x = 7, y = 7, z = 7, phi = 7;\n\
    SIMGetRobot(1, &x, &y, &z, &phi);\n\
    SIMSetRobot(1, 2500, 500, 0, 0); SIMSetRobot(0, 2500, 500, 0, 0);\n\
    printf(\"%d %d %d %d, %d robots, %d %d\\n\", x, y, z, phi, SIMGetRobotCount(), VWSetPosition(1, 2, 3), KEYGet());\n\
    VWStraight(400, 200); VWWait();\n\
    return 0;\n}\n";

fn room(forbid: &str, more: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("a.c", CHEAT);
    scratch.write("a.scene.toml", &format!("[scene]\n{forbid}\n{ROOM}{more}"));
    scratch
}

#[test]
fn a_forbidden_function_fails_without_effect_wherever_a_program_runs() {
    let scratch = room("forbid = [\"SIM*\", \"VWSetPosition\", \"keyget\"]", "");
    let mut digests = BTreeSet::new();
    for exec in ["fiber", "thread", "process"] {
        for program in ["1=a.c", "1=a.cpp"] {
            std::fs::copy(scratch.path().join("a.c"), scratch.path().join("a.cpp")).expect("a copy");
            let args = ["run", "a.scene.toml", "--exec", exec, "--program", program, "--report", "report.json"];
            let ran = scratch.eyesim(&args);
            assert_eq!(ran.code, Some(0), "{ran:#?}");
            assert!(ran.stdout.contains("7 7 7 7, 0 robots, 1 0"), "{ran:#?}");
            for said in [
                "`SIMSetRobot` did nothing: it is forbidden here",
                "called forbidden functions: `KEYGet` once, `SIMGetRobot` once, `SIMGetRobotCount` once, `SIMSetRobot` 2 times, \
                 `VWSetPosition` once",
            ] {
                assert!(ran.stderr.contains(said), "{ran:#?}");
            }
            let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report");
            let robot = &report["robots"][0];
            assert!((number(robot, "pose.x_m") - 0.9).abs() < 1e-3, "{robot:#}");
            let calls = json!({
                "KEYGet": 1, "SIMGetRobot": 1, "SIMGetRobotCount": 1, "SIMSetRobot": 2, "VWSetPosition": 1
            });
            assert_eq!(robot["forbidden_calls"], calls);
            // The record contains the name of the program.
            digests.insert((program, report["digest"].to_string()));
        }
    }
    assert_eq!(digests.len(), 2, "{digests:?}");
}

#[test]
fn it_is_forbidden_in_every_language_and_generation() {
    let scene = root().join("sims/approach.sim");
    let scratch = Scratch::new();
    let scene = scene.to_str().expect("UTF-8");
    // The Rust program ends with an error when a call is rejected.
    let ran = scratch.eyesim(&["run", scene, "--until", "3", "--forbid", "VW*", "--report", "report.json"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report");
    for robot in report["robots"].as_array().expect("robots") {
        let calls = robot["forbidden_calls"].as_object().expect("calls");
        assert!(!calls.is_empty() && calls.keys().all(|name| name.starts_with("VW")), "{robot:#}");
        assert_eq!(number(robot, "path_m"), 0.0, "{robot:#}");
    }
}

#[test]
fn every_function_can_be_forbidden() {
    let scratch = room("forbid = \"*\"", "");
    let program = std::fs::read_to_string(root().join("tests/fixtures/every-function.c")).expect("the program");
    scratch.write("a.c", &program);
    scratch.eyesim(&["run", "a.scene.toml", "--until", "100", "--report", "report.json", "--api", "7"]);
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report");
    let calls = report["robots"][0]["forbidden_calls"].as_object().expect("calls");
    let missing: Vec<&str> =
        Robios7Call::ALL.iter().map(|call| call.name()).filter(|name| !calls.contains_key(*name)).collect();
    assert!(missing.len() <= 12 && calls.len() > 100, "not called: {missing:?}");
    assert_eq!(number(&report["robots"][0], "path_m"), 0.0);
}

#[test]
fn a_scene_whose_forbidden_functions_nobody_calls_runs_as_without() {
    let digest = |forbid| {
        let scratch = room(forbid, "");
        scratch.write("a.c", "#include \"eyebot.h\"\nint main(void) { VWStraight(400, 200); VWWait(); return 0; }\n");
        let report = scratch.report("a.scene.toml", &[], 0);
        assert_eq!(report["robots"][0]["forbidden_calls"], json!({}));
        report["digest"].clone()
    };
    assert_eq!(digest("forbid = [\"SIM*\", \"OSExecute\"]"), digest(""));
}

/// A check of forbidden calls.
const CHECK: &str =
    "\n[[check]]\nname = \"no cheating\"\nkind = \"event\"\nevent = \"forbidden\"\nmax = 0\npoints = 2\n";

#[test]
fn a_check_says_what_a_forbidden_call_costs() {
    let scratch = room("forbid = [\"SIM*\"]", CHECK);
    scratch.write("a.c", &CHEAT.replace("KEYGet()", "0"));
    let ran = scratch.eyesim(&["run", "a.scene.toml", "--trace", "a.jsonl"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stdout.contains("FAILED  no cheating  0/2  4 times, allowed is none, first at"), "{ran:#?}");
    let forbidden_events: Vec<Value> =
        scratch.trace("a.jsonl").into_iter().filter(|line| line["event"] == "forbidden").collect();
    assert_eq!(forbidden_events.len(), 4);
    assert_eq!(forbidden_events[1]["function"], "SIMSetRobot");

    // A suite forbids the functions that its scene allows, and its commands that repeat a case forbid them too.
    let scratch = room("", "");
    scratch.write("a.c", &CHEAT.replace("KEYGet()", "0"));
    let suite = format!("[suite]\nscene = \"a.scene.toml\"\nforbid = [\"SIM*\"]\n[matrix]\nseed = 1\n{CHECK}");
    scratch.write("a.suite.toml", &suite);
    let ran = scratch.eyesim(&["test", "a.suite.toml", "--report", "rows.json"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let rows: Value = serde_json::from_str(&scratch.read("rows.json")).expect("rows");
    let row = &rows["suites"][0]["rows"][0];
    assert_eq!(row["points"], 0.0, "{row:#}");
    assert_eq!(row["robots"][0]["forbidden_calls"]["SIMSetRobot"], 2, "{row:#}");
    let words: Vec<&str> = row["words"].as_array().expect("words").iter().filter_map(Value::as_str).collect();
    assert!(words.contains(&"--forbid=SIM*"), "{words:?}");
    let again = scratch.report(words[0], &words[1..], 1);
    assert_eq!(again["digest"], row["digest"]);
}

#[test]
fn unknown_functions_are_reported_with_what_was_meant() {
    for (forbid, said, meant) in [
        ("forbid = [\"SIN*\"]", "there is no function `SIN*`", "did you mean `SIM*`?"),
        (
            "forbid = [\"SIM*\", \"VWSetPositon\"]",
            "there is no function `VWSetPositon`",
            "did you mean `VWSetPosition`?",
        ),
        ("forbid = [\"\"]", "", ""),
        ("forbid = [3]", "", ""),
        ("forbid = true", "", ""),
    ] {
        let scratch = room(forbid, "");
        for command in ["run", "check"] {
            let ran = scratch.eyesim(&[command, "a.scene.toml"]);
            assert!(ran.code != Some(0) && ran.code != Some(3), "{forbid}: {ran:#?}");
            let output = ran.stdout + &ran.stderr;
            assert!(output.contains(said) && output.contains(meant), "{forbid}: {output}");
        }
        let scratch = room("", "");
        scratch.write("a.suite.toml", &format!("[suite]\nscene = \"a.scene.toml\"\n{forbid}\n"));
        for command in ["test", "check"] {
            let ran = scratch.eyesim(&[command, "a.suite.toml"]);
            assert!(ran.code != Some(0) && ran.code != Some(3), "{forbid}: {ran:#?}");
            let output = ran.stdout + &ran.stderr;
            assert!(output.contains(said) && output.contains(meant), "{forbid}: {output}");
        }
    }
    let ran = room("", "").eyesim(&["run", "a.scene.toml", "--forbid", "OSWait,SINGetRobot"]);
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.stderr.contains("--forbid: there is no function `SINGetRobot`, did you mean `SIMGetRobot`?"),
        "{ran:#?}"
    );
}
