//! Checks of scenes: every kind on its page, exact instants for every slot length, verdicts and messages.
#![allow(clippy::disallowed_methods, reason = "geometry by hand, compared within a micrometre")]

use std::collections::BTreeSet;

use serde_json::Value;
use tests::{Scratch, root};

/// Blocks of a page in this language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let fence = format!("```{language}\n");
    page.split(&fence).skip(1).filter_map(|rest| rest.split_once("\n```")).map(|(block, _)| block).collect()
}

/// Kinds of checks in the schema.
fn kinds() -> BTreeSet<String> {
    let schema: Value = serde_json::from_str(&Scratch::new().eyesim(&["schema"]).stdout).expect("a schema");
    let variants = schema["$defs"]["CheckForm"]["oneOf"].as_array().expect("variants").clone();
    variants.iter().map(|variant| variant["properties"]["kind"]["const"].as_str().expect("a word").to_owned()).collect()
}

#[test]
fn the_page_has_a_passing_example_of_every_kind_of_check() {
    let page = std::fs::read_to_string(root().join("docs/checks.md")).expect("the page");
    let scratch = Scratch::new();
    for (language, comment) in [("c", "// "), ("python", "# ")] {
        for program in blocks(&page, language) {
            let name = program.lines().next().and_then(|line| line.strip_prefix(comment));
            scratch.write(name.expect("the name of a program"), program);
        }
    }
    let examples = blocks(&page, "toml");
    scratch.write("room.scene.toml", &[&blocks(&page, "scene.toml")[..], &examples[..]].concat().join("\n\n"));
    let report = scratch.report("room.scene.toml", &[], 0);
    let checks = report["checks"].as_array().expect("checks");
    let shown: BTreeSet<String> =
        checks.iter().map(|check| check["kind"].as_str().expect("a kind").to_owned()).collect();
    assert_eq!(shown, kinds());
    for kind in kinds() {
        assert!(page.contains(&format!("\n## {kind}\n")), "{kind}");
    }
    assert_eq!(report["points"], report["max_points"], "{checks:#?}");
}

/// A scene with these checks: a floor with one robot at (500, 500) that runs `program`.
fn scene(program: &str, checks: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("drive.c", &format!("#include \"eyebot.h\"\nint main() {{\n{program}\nreturn 0;\n}}\n"));
    let world = "[world]\nfloor_mm = [3000, 2000]\nwall = [{ from_mm = [2000, 0], to_mm = [2000, 2000] }]\n";
    let robot = "[[robot]]\ntype = \"S4\"\nprogram = \"drive.c\"\nx_mm = 500\ny_mm = 500\n";
    scratch.write("a.scene.toml", &format!("{world}{robot}{checks}"));
    scratch
}

/// A curve, then a straight line, both at speeds that are no multiples of any slot length.
const CURVE: &str = "VWCurve(700, 80, 170); VWWait(); VWStraight(400, 230); VWWait(); OSWait(2000);";

#[test]
fn verdicts_and_instants_are_the_same_for_every_slot_length() {
    // End of the curve, and the end of the line after it, where y is maximal, in closed form. The robot turns left by
    // 80 degrees.
    let turn = 80_f64.to_radians();
    let (radius, (sin, cos)) = (0.7 / turn, turn.sin_cos());
    let end = [500.0 + 1e3 * radius * sin, 500.0 + 1e3 * radius * (1.0 - cos)];
    let top = [end[0] + 400.0 * cos, end[1] + 400.0 * sin];
    // Discs beside the midpoint of the line. Their radius is the distance to the line, slightly more, or slightly less.
    let middle = [0.5 * (end[0] + top[0]), 0.5 * (end[1] + top[1])];
    let beside = [middle[0] + 100.0 * sin, middle[1] - 100.0 * cos];
    let disc = |name: &str, radius: f64| {
        format!("[[check]]\nname = \"{name}\"\nkind = \"reach\"\nat_mm = {beside:?}\nwithin_mm = {radius:.7}\n")
    };
    let grazing = disc("inside", 100.001) + &disc("outside", 99.999) + &disc("deep", 150.0);
    let others = format!(
        "[[check]]\nname = \"visits\"\nkind = \"visits\"\nplaces_mm = [{end:?}, {top:?}]\nwithin_mm = 3\n\
         [[check]]\nname = \"leaves\"\nkind = \"stays_in\"\narea_mm = [[0, 0], [3000, {:.7}]]\n\
         [[check]]\nname = \"stays\"\nkind = \"stays_in\"\narea_mm = [[0, 0], [3000, {:.7}]]\n\
         [[check]]\nname = \"near\"\nkind = \"clearance\"\nmin_mm = 900\n\
         [[check]]\nname = \"follows\"\nkind = \"follows_wall\"\ngap_mm = [900, 1200]\nshare_percent = 30\n\
         [[check]]\nname = \"covers\"\nkind = \"coverage\"\nwidth_mm = 150\nshare_percent = 3\n\
         [[check]]\nname = \"gate\"\nkind = \"laps\"\ngate_mm = [[700, 800], [700, 0]]\n\
         [[check]]\nname = \"odometry\"\nkind = \"odometry_error\"\nmax_mm = 20\n\
         [[check]]\nname = \"stop\"\nkind = \"reach\"\nat_mm = {top:?}\nwithin_mm = 1\nstay_s = 1.5\n",
        top[1] - 0.001,
        top[1] + 0.001,
    );
    let scratch = scene(CURVE, &(grazing + &others));
    for noise in ["none", "real"] {
        let run = |slot: &str| {
            let args = ["run", "a.scene.toml", "--slot", slot, "--noise", noise, "--report", "r.json"];
            let ran = scratch.eyesim(&args);
            assert_eq!(ran.code, Some(1), "{ran:#?}");
            serde_json::from_str::<Value>(&scratch.read("r.json")).expect("a report")["checks"].clone()
        };
        let checks = run("50");
        for slot in ["1", "7.3", "100", "200"] {
            assert_eq!(run(slot), checks, "slots of {slot} ms, noise {noise}");
        }
        if noise == "none" {
            let failed: Vec<&str> = checks
                .as_array()
                .expect("checks")
                .iter()
                .filter(|check| check["passed"] == false)
                .map(|check| check["name"].as_str().expect("a name"))
                .collect();
            assert_eq!(failed, ["outside", "leaves", "near"], "{checks:#}");
            let follows = checks[6]["value"].as_f64().expect("a share");
            assert!(follows > 0.3 && follows < 1.0, "{checks:#}");
        }
    }
}

#[test]
fn instants_are_those_of_the_closed_form() {
    let checks = "[[check]]\nkind = \"reach\"\nat_mm = [1000, 500]\nwithin_mm = 100\n[[check]]\nkind = \"clearance\"\nmin_mm = 800\n";
    let scratch = scene("VWStraight(800, 200); VWWait();", checks);
    scratch.eyesim(&["run", "a.scene.toml", "--report", "r.json", "--trace", "t.jsonl"]);
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let start =
        scratch.trace("t.jsonl").iter().find(|event| event["event"] == "drive_straight").expect("a drive")["t_s"]
            .as_f64()
            .expect("a time");
    let at = |index: usize| report["checks"][index]["at_s"].as_f64().expect("an instant") - start;
    assert!((at(0) - 2.0).abs() < 1e-6, "400 mm at 200 mm/s: {} s", at(0));
    // The gap to the wall at x = 2000 is 800 mm when the robot's centre is at 1200 mm minus its radius.
    let gap = report["checks"][1]["x_m"].as_f64().expect("a place");
    assert!((at(1) - (gap - 0.5) / 0.2).abs() < 1e-6, "{} s at {gap} m", at(1));
    let message = report["checks"][1]["message"].as_str().expect("words");
    assert!(message.contains("the gap of r1 fell below 800 mm at "), "{message}");
}

#[test]
fn failed_checks_report_what_happened_where_and_when() {
    let checks = "[[check]]\nname = \"the goal\"\nkind = \"reach\"\nat_mm = [2500, 500]\nwithin_mm = 100\npoints = 4\n\
                  [[check]]\nname = \"touches nothing\"\nkind = \"contacts\"\npoints = 3\n\
                  [[check]]\nname = \"tells\"\nkind = \"prints\"\ntext = \"found\"\n\
                  [[check]]\nname = \"a short way\"\nkind = \"metric\"\npath = \"robots[0].path_m\"\nfull = 0\nzero = 4\npoints = 2\n";
    let scratch = scene("printf(\"lost\\n\"); VWStraight(3000, 300); VWWait();", checks);
    let ran = scratch.eyesim(&["run", "a.scene.toml", "--slot=20", "--report", "r.json"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let lines: Vec<&str> = ran.stdout.lines().skip_while(|line| !line.starts_with("checks: ")).collect();
    let [head, goal, touches, tells, path, view] = lines[..] else { panic!("{lines:#?}") };
    assert!(head.starts_with("checks: 0 of 4 passed, 1.") && head.ends_with(" of 10 points"), "{head}");
    assert!(
        goal.starts_with("FAILED  the goal")
            && goal.contains("r1 was never within 100 mm of (2500, 500) mm; its smallest distance from the centre was"),
        "{goal}"
    );
    assert!(
        touches.starts_with("FAILED  touches nothing")
            && touches.contains("r1 touched a wall at ")
            && touches.contains("(2000, 500) mm"),
        "{touches}"
    );
    assert!(tells.contains("r1 printed no `found` in one line"), "{tells}");
    assert!(path.starts_with("FAILED  a short way") && path.contains("/2"), "{path}");
    assert!(view.starts_with("to see it: eyesim view a.scene.toml --slot=20 --at "), "{view}");
}

#[test]
fn without_a_required_check_there_are_no_points() {
    let of = |least: i32| {
        format!(
            "[[check]]\nname = \"sets out\"\nkind = \"reach\"\nat_mm = [{least}, 500]\nwithin_mm = 10\npoints = 0\nrequired = true\n\
             [[check]]\nname = \"touches nothing\"\nkind = \"contacts\"\npoints = 3\n"
        )
    };
    for (least, code, points, told) in [(900, 0, 3.0, false), (1500, 1, 0.0, true)] {
        let scratch = scene("VWStraight(500, 300); VWWait();", &of(least));
        let report = scratch.report("a.scene.toml", &[], code);
        assert_eq!((&report["points"], &report["max_points"]), (&points.into(), &3.0.into()), "{report:#}");
        assert_eq!(report["checks"][1]["passed"], true, "the other check is met");
        let message = report["checks"][0]["message"].as_str().expect("a message");
        assert_eq!(message.ends_with("; without `sets out` there are no points at all"), told, "{message}");
    }
}

#[test]
fn checks_change_neither_the_run_nor_its_digest() {
    let checks =
        "[[check]]\nkind = \"calls\"\nfunction = \"VWStraight\"\n[[check]]\nkind = \"clearance\"\nmin_mm = 0\n";
    let digests = ["", checks].map(|checks| {
        let report = scene(CURVE, checks).report("a.scene.toml", &["--noise", "real"], 0);
        report["digest"].clone()
    });
    assert_eq!(digests[0], digests[1]);
}

#[test]
fn objects_reach_positions_and_a_removed_goal_causes_no_failure() {
    let ball = "[[object]]\ntype = \"Golf\"\nx_mm = 700\ny_mm = 500\n\
                [[check]]\nkind = \"reach\"\nobject = 1\nat_mm = [900, 500]\nwithin_mm = 20\n\
                [[check]]\nkind = \"stays_in\"\nobject = 1\narea_mm = [[650, 450], [750, 550]]\n";
    let scratch = scene("VWStraight(500, 200); VWWait();", ball);
    let reports = ["1", "50", "200"].map(|slot| scratch.report("a.scene.toml", &["--slot", slot], 1)["checks"].clone());
    assert_eq!(reports[0][0]["passed"], true, "{:#}", reports[0]);
    assert_eq!(reports[0][1]["passed"], false, "{:#}", reports[0]);
    assert_eq!((&reports[0], &reports[0]), (&reports[1], &reports[2]));
}

#[test]
fn mistakes_in_checks_are_reported_with_their_locations() {
    for (check, message) in [
        ("kind = \"reech\"", "`reech` is not a valid `kind`"),
        ("name = \"x\"", "`check` has no `kind`"),
        ("kind = \"reach\"", "a check has no `at_mm`"),
        ("kind = \"reach\"\nat_mm = [1, 2]", "a check has no `within_mm`"),
        ("kind = \"reach\"\nat_mm = [1, nan]\nwithin_mm = 1", "`NaN` is out of range"),
        ("kind = \"reach\"\nat_mm = [1, 2]\nwithin_mm = -1", "`-1` is out of range"),
        ("kind = \"reach\"\nat_mm = [1, 2]\narea_mm = [[0, 0], [1, 1]]", "`at_mm` and `area_mm` exclude each other"),
        ("kind = \"reach\"\narea_mm = [[0, 0], [1, 0]]", "`area_mm` is not an area"),
        ("kind = \"reach\"\narea_mm = [[0, 0, 0]]", "array"),
        (
            "kind = \"reach\"\nrobot = 1\nobject = 1\nat_mm = [1, 2]\nwithin_mm = 1",
            "`robot` and `object` exclude each other",
        ),
        ("kind = \"reach\"\nobject = 1\nat_mm = [1, 2]\nwithin_mm = 1", "is about o1, which the scene does not have"),
        ("kind = \"contacts\"\nrobot = 2", "check `contacts` is about r2, which the scene does not have"),
        ("kind = \"contacts\"\npoints = -1", "`-1` is out of range"),
        ("kind = \"visits\"\nplaces_mm = []\nwithin_mm = 1", "`places_mm` is empty"),
        ("kind = \"laps\"\ngate_mm = [[1, 1], [1, 1]]", "`gate_mm` is not a gate"),
        ("kind = \"follows_wall\"\ngap_mm = [5, 1]", "has its least value above its greatest"),
        ("kind = \"coverage\"\nwidth_mm = 5\ncell_mm = 1", "the area has 6000000 squares"),
        ("kind = \"metric\"\npath = \"points\"", "a metric has no limit"),
        ("kind = \"metric\"\npath = \"points\"\nmin = 2\nmax = 1", "`min` is greater than `max`"),
        ("kind = \"metric\"\npath = \"points\"\nmin = 2\nfull = 1\nzero = 0", "exclude `full` and `zero`"),
        ("kind = \"prints\"", "has 0 of `text`, `pattern` and `numbers`"),
        ("kind = \"prints\"\ntext = \"a\"\nnumbers = [1]", "has 2 of `text`, `pattern` and `numbers`"),
        ("kind = \"prints\"\nnumbers = [[]]", "has an empty row"),
        ("kind = \"event\"\nevent = \"beeb\"", "`beeb` is not a valid `event`"),
        ("kind = \"calls\"\nfunction = \"VWStraigt\"", "there is no function `VWStraigt`"),
        ("kind = \"calls\"\nfunction = \"VWStraight\"\nmin = 3\nmax = 2", "is less than `min`"),
        ("kind = \"outcome\"\nis = \"won\"", "`won` is not a valid `is`"),
    ] {
        let scratch = scene("", &format!("[[check]]\n{check}\n"));
        for command in ["run", "check"] {
            let ran = scratch.eyesim(&[command, "a.scene.toml"]);
            let text = ran.stdout + &ran.stderr;
            assert!(ran.code != Some(0) && text.contains(message) && text.contains("a.scene.toml"), "{check}: {text}");
        }
    }
}

#[test]
fn names_are_unique_and_scenes_with_checks_convert_and_read_back() {
    let twice = "[[check]]\nname = \"a\"\nkind = \"contacts\"\n[[check]]\nname = \"a\"\nkind = \"contacts\"\n";
    let ran = scene("", twice).eyesim(&["check", "a.scene.toml"]);
    assert!((ran.stdout + &ran.stderr).contains("is named `a`, too"));
    let page = std::fs::read_to_string(root().join("docs/checks.md")).expect("the page");
    let scratch = scene(
        "",
        &blocks(&page, "toml")
            .join("\n\n")
            .replace("to = 2", "")
            .replace("kind = \"calls\"\nrobot = 1", "kind = \"calls\""),
    );
    scratch.write("turns.py", "");
    let converted = |from: &str, to: &str| {
        let ran = scratch.eyesim(&["convert", from, "-o", to]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        scratch.read(to)
    };
    let once = converted("a.scene.toml", "b.scene.toml");
    assert_eq!(once.matches("[[check]]").count(), blocks(&page, "toml").join("\n").matches("[[check]]").count());
    assert_eq!(converted("b.scene.toml", "c.scene.toml"), once);
}

#[test]
fn the_first_setting_fixes_the_frame_of_odometry_and_later_ones_count() {
    let check = |program: &str, max: f64, at_end: bool| {
        let checks = format!("[[check]]\nkind = \"odometry_error\"\nmax_mm = {max}\nat_end = {at_end}\n");
        let scratch = scene(program, &checks);
        scratch.eyesim(&["run", "a.scene.toml", "--report", "r.json"]);
        let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
        report["checks"][0].clone()
    };
    let start = "VWSetPosition(5000, 700, 90); VWStraight(300, 200); VWWait();";
    let anchored = check(start, 0.001, false);
    assert_eq!(anchored["passed"], true, "{anchored:#}");
    let wrong = format!("{start} VWSetPosition(5000, 1100, 90); VWStraight(100, 200); VWWait();");
    let corrected = check(&wrong, 50.0, false);
    assert_eq!(corrected["passed"], false, "{corrected:#}");
    assert!((corrected["value"].as_f64().expect("an error") - 0.1).abs() < 1e-6, "{corrected:#}");
    assert!((corrected["x_m"].as_f64().expect("a place") - 0.8).abs() < 1e-6, "where it was set: {corrected:#}");
    let back = format!("{wrong} VWSetPosition(5000, 1100, 90);");
    assert_eq!(check(&back, 50.0, true)["passed"], true, "only the end counts");
}

#[test]
fn the_gap_between_two_robots_is_that_of_two_circles_that_pass() {
    let scratch = scene("VWStraight(1000, 200); VWWait();", "");
    let other = "[[robot]]\ntype = \"S4\"\nprogram = \"drive.c\"\nx_mm = 1500\ny_mm = 900\nheading_deg = 180\n";
    let scene = scratch.read("a.scene.toml");
    let run = |min: f64, slot: &str| {
        let check = format!("[[check]]\nkind = \"clearance\"\nto = \"robots\"\nmin_mm = {min}\n");
        scratch.write("b.scene.toml", &format!("{scene}{other}{check}"));
        scratch.eyesim(&["run", "b.scene.toml", "--slot", slot, "--report", "r.json"]);
        let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
        report["checks"][0].clone()
    };
    // The paths are 400 mm apart, and the robots pass each other at x = 1000.
    let gap = 1e3 * run(0.0, "50")["value"].as_f64().expect("a gap");
    for (min, is_met) in [(gap - 0.001, true), (gap + 0.001, false)] {
        let checks = ["1", "50", "200"].map(|slot| run(min, slot));
        assert_eq!(checks[0]["passed"], is_met, "{:#}", checks[0]);
        assert!(checks[0] == checks[1] && checks[0] == checks[2], "{checks:#?}");
    }
    let position = run(gap + 0.001, "50")["x_m"].as_f64().expect("a place");
    assert!((position - 1.0).abs() < 0.02, "{position} m");
}

#[test]
fn passages_of_a_gate_backwards_are_subtracted() {
    let laps = |gate: &str, min: u64| {
        let checks = format!("[[check]]\nkind = \"laps\"\ngate_mm = {gate}\nmin = {min}\n");
        let scratch = scene(
            "for (int i = 0; i < 3; i++) { VWStraight(400, 300); VWWait(); VWStraight(-400, 300); VWWait(); }",
            &checks,
        );
        scratch.eyesim(&["run", "a.scene.toml", "--report", "r.json"]);
        let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
        (report["checks"][0]["passed"].clone(), report["checks"][0]["value"].clone())
    };
    assert_eq!(laps("[[700, 800], [700, 0]]", 1), (true.into(), 0.0.into()), "once ahead, then back");
    assert_eq!(laps("[[700, 800], [700, 0]]", 2).0, false);
    assert_eq!(laps("[[700, 0], [700, 800]]", 1), (false.into(), 0.0.into()));
    assert_eq!(laps("[[700, 800], [700, 600]]", 1).0, false, "beside the gate");
}

#[test]
fn checks_of_a_run_of_no_duration_use_the_start_positions() {
    let checks = "[[check]]\nkind = \"reach\"\nat_mm = [500, 500]\nwithin_mm = 1\n\
                  [[check]]\nkind = \"stays_in\"\narea_mm = [[1000, 0], [2000, 1000]]\n";
    let scratch = scene("", checks);
    let text = scratch.read("a.scene.toml").replace("program = \"drive.c\"\n", "");
    scratch.write("a.scene.toml", &text);
    let report = scratch.report("a.scene.toml", &[], 1);
    assert_eq!(
        (&report["checks"][0]["passed"], &report["checks"][1]["passed"]),
        (&true.into(), &false.into()),
        "{report:#}"
    );
    assert_eq!(report["checks"][1]["at_s"], 0.0);
}

#[test]
fn the_command_to_see_it_begins_at_the_earliest_failure() {
    let checks = "[[check]]\nkind = \"prints\"\ntext = \"never\"\n\
                  [[check]]\nname = \"late\"\nkind = \"stays_in\"\nat_mm = [500, 500]\nwithin_mm = 900\n\
                  [[check]]\nname = \"early\"\nkind = \"stays_in\"\nat_mm = [500, 500]\nwithin_mm = 400\n";
    let scratch = scene("VWStraight(1000, 100); VWWait();", checks);
    let ran = scratch.eyesim(&["run", "a.scene.toml", "-v", "--robot", "1", "--only=VW*"]);
    let view = ran.stdout.lines().chain(ran.stderr.lines()).find(|line| line.starts_with("to see it")).expect("a hint");
    // The limit of 400 mm at 100 mm/s takes 4 s; the hint is one second earlier.
    assert_eq!(view, "to see it: eyesim view a.scene.toml --at 3.0");
}

#[test]
fn metrics_of_swarms_are_the_same_for_every_slot_length_and_are_drawn() {
    let checks = "[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 1500\n\
                  [[check]]\nname = \"spread\"\nkind = \"swarm\"\nof = \"spread\"\nmax = 600\nfrom_s = 1\n\
                  [[check]]\nname = \"in touch\"\nkind = \"swarm\"\nof = \"groups\"\nwithin_mm = 1100\nmax = 1\n\
                  [[check]]\nname = \"in+touch\"\nkind = \"swarm\"\nof = \"order\"\nmin = 1\n\
                  [[check]]\nname = \"explored\"\nkind = \"swarm\"\nof = \"coverage\"\nwidth_mm = 100\nmin = 0.5\nat_end = true\n";
    let scratch = scene("VWStraight(1000, 200); VWWait(); OSWait(3000);", checks);
    let checks_of =
        |slot: &str| scratch.report("a.scene.toml", &["--slot", slot, "--plot", "run.svg"], 1)["checks"].clone();
    let first = checks_of("50");
    for slot in ["1", "200", "700"] {
        assert_eq!(checks_of(slot), first, "slot {slot}");
    }
    // The robots start 1 m apart, each 0.5 m from their midpoint. Then one drives 1 m aside in 5 s. Half of their
    // distance exceeds 600 mm after 663 mm, at 3.317 s. Their distance exceeds 1.1 m after 458 mm, at 2.291 s.
    let last =
        |index: usize| first[index]["series"].as_array().and_then(|series| series.last()).expect("values").clone();
    assert!((last(0)[1].as_f64().expect("m") - 0.5 * 2_f64.sqrt()).abs() < 1e-6, "{}", last(0));
    let at = |index: usize| first[index]["at_s"].as_f64().expect("an instant");
    assert!((at(0) - 3.4).abs() < 1e-9 && (at(1) - 2.3).abs() < 1e-9, "{} {}", at(0), at(1));
    assert_eq!((&first[2]["passed"], &first[3]["passed"]), (&Value::Bool(true), &Value::Bool(false)));
    let chart = scratch.read("run-in-touch.svg");
    assert!(chart.contains("simulated time, s") && chart.contains("polyline"), "{chart}");
    assert!(scratch.read("run-in-touch-2.svg").contains("in+touch"));
}

#[test]
fn printed_metrics_are_in_the_report_and_cannot_pass_a_check() {
    let check = "[[check]]\nkind = \"metric\"\npath = \"robots[0].metrics.laps\"\nmin = 1\n";
    let scratch =
        scene("printf(\"METRIC laps=1\\nMETRIC laps=4\\nMETRIC oops\\n\"); VWStraight(2000, 300); VWWait();", check);
    scratch.write("drive.c", &scratch.read("drive.c").replace("int main", "#include <stdio.h>\nint main"));
    let ran = scratch.eyesim(&["run", "a.scene.toml", "--report", "-"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let report: Value = serde_json::from_str(&ran.stdout).expect("standard output has the report alone");
    let robot = &report["robots"][0];
    assert_eq!(robot["metrics"], serde_json::json!({"laps": 4.0}));
    let message = report["checks"][0]["message"].as_str().expect("a message");
    assert!(message.contains("checks cannot use metrics that the program itself prints"), "{message}");
    assert!(ran.stderr.contains("`METRIC oops` is not kept: expected `METRIC name=value`"), "{}", ran.stderr);
    assert!(ran.stderr.contains("finished"), "the table: {}", ran.stderr);
    // The robot starts at 500 mm and hits the wall at 2 m.
    assert_eq!((&robot["start"]["x_m"], &robot["contacts"]), (&serde_json::json!(0.5), &serde_json::json!(1)));
    let times = robot["contact_times_s"].as_array().expect("times");
    let at = times[0].as_f64().expect("a time");
    assert!(times.len() == 1 && (4.0..6.0).contains(&at), "1.4 m at 0.3 m/s: {times:?}");
}

/// Entry of the report for a check by this shell script, and the exit code of the run.
fn of_script(script: &str, keys: &str) -> (Value, Option<i32>) {
    let scratch = scene(
        "VWStraight(300, 200); VWWait();",
        &format!("[[check]]\nkind = \"script\"\nprogram = \"tools/grade\"\n{keys}\n"),
    );
    scratch.write("tools/grade", &format!("#!/bin/sh\n{script}\n"));
    let ran = scratch.eyesim(&["run", "a.scene.toml", "--report", "r.json"]);
    let report: Value = serde_json::from_str(&scratch.read("r.json")).unwrap_or_else(|_| panic!("{ran:#?}"));
    (report["checks"][0].clone(), ran.code)
}

#[test]
fn programs_of_the_user_judge_runs() {
    let sees = "set -e\ngrep -q '\"path_m\":0.3' \"$2\"\ngrep -q drive_straight \"$3\"\n! grep -q real_time \"$2\"\ntest \"$1\" = '-x y'\n\
                echo debugging; echo '{\"passed\": true, \"points\": 3, \"at_s\": 1.5, \"message\": \"good way\"}'";
    let (check, code) = of_script(sees, "arguments = [\"-x y\"]\npoints = 4");
    assert_eq!(
        (&check["passed"], &check["points"], &check["at_s"]),
        (&true.into(), &3.0.into(), &1.5.into()),
        "{check:#}"
    );
    assert_eq!((&check["message"], &check["broken"], code), (&"good way".into(), &false.into(), Some(0)), "{check:#}");
    let (check, code) = of_script("echo '{\"passed\": false}'", "");
    assert_eq!((&check["passed"], &check["points"], &check["broken"]), (&false.into(), &0.0.into(), &false.into()));
    assert_eq!((&check["message"], code), (&"not passed".into(), Some(1)), "{check:#}");
}

#[test]
fn a_check_whose_program_gives_no_verdict_is_an_error() {
    for (script, keys, said) in [
        ("echo nonsense >&2; exit 3", "", "ended with exit status: 3: nonsense"),
        ("true", "", "printed no verdict; expected a line such as"),
        ("echo hello", "", "found `hello`"),
        ("echo '{\"passed\": \"yes\"}'", "", "expected a boolean"),
        ("echo '{\"points\": 1}'", "", "missing field `passed`"),
        ("echo '{\"passed\": true, \"point\": 1}'", "", "unknown field `point`"),
        ("echo '{\"passed\": true, \"points\": NaN}'", "", "is not a verdict"),
        ("echo '{\"passed\": true, \"points\": 1e999}'", "", "is not a verdict"),
        ("echo '{\"passed\": true, \"points\": 1e308}'", "", "points; expected 0 to 1"),
        ("echo '{\"passed\": true, \"points\": -1}'", "", "gives -1 points; expected 0 to 1"),
        ("sleep 1000 & sleep 1000", "timeout_s = 0.2", "had not ended after 0.2 s"),
        ("cat /dev/zero", "timeout_s = 60", "printed more than 1048 kB"),
        ("cat /dev/zero >&2", "timeout_s = 60", "printed more than 1048 kB"),
        ("kill -9 $$", "", "signal: 9"),
    ] {
        let (check, code) = of_script(script, keys);
        let message = check["message"].as_str().expect("a message");
        assert!(message.contains(said), "{script}: {message}");
        assert_eq!((&check["broken"], &check["passed"], code), (&true.into(), &false.into(), Some(1)), "{script}");
    }
}

#[test]
fn programs_of_checks_are_searched_before_the_run() {
    let scratch = scene("", "[[check]]\nkind = \"script\"\nprogram = \"grade\"\n");
    let check = |said: &str| {
        for command in ["check", "run"] {
            let ran = scratch.eyesim(&[command, "a.scene.toml"]);
            assert!(ran.code != Some(0) && (ran.stdout.clone() + &ran.stderr).contains(said), "{said}: {ran:#?}");
        }
    };
    check("`grade` does not exist");
    scratch.write("grade", "no program");
    check("`grade` cannot be started: expected a program in Python");
    std::fs::remove_file(scratch.path().join("grade")).expect("a file");
    std::fs::create_dir(scratch.path().join("grade")).expect("a folder");
    check("`grade` is not a file");
}
