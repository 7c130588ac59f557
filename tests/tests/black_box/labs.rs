//! The labs of the course: a solution gets all points, and a solution with a mistake loses exactly the points for that
//! mistake.
//!
//! `EYESIM_LABS=all` uses the twenty seeds of the suites; by default a few seeds are used.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tests::{Scratch, root};

/// Total points of a lab.
const POINTS: f64 = 10.0;

/// A solution, its points, and the checks that fail.
type Solution<'t> = (&'t str, f64, &'t [&'t str]);

/// Runs the suite of a lab with each solution as the program of `robot`, and compares all rows with the expected ones.
/// `few` are the seeds of a short test.
fn judge(folder: &str, few: &str, robot: &str, with_mistakes: [Solution<'_>; 2]) {
    let (_, name) = folder.split_once('-').expect("a number and a name");
    let scratch = Scratch::new();
    let lab = root().join("labs").join(folder);
    copy(&lab, &lab, &scratch);
    let suite_name = format!("{name}.suite.toml");
    let suite = scratch.read(&suite_name);
    assert!(suite.contains("\"1..20\""), "seeds of the suite");
    if std::env::var_os("EYESIM_LABS").is_none_or(|seeds| seeds != "all") {
        let few = if few.contains("..") { format!("\"{few}\"") } else { few.to_owned() };
        scratch.write(&suite_name, &suite.replace("\"1..20\"", &few));
    }
    let [c, python] = ["c", "py"].map(|extension| format!("{name}.{extension}"));
    let solutions = [(c.as_str(), POINTS, &[][..]), (&python, POINTS, &[])].into_iter().chain(with_mistakes);
    let mut known_names = BTreeSet::new();
    for (program, points, missed) in solutions {
        judge_solution(&scratch, &suite_name, &format!("{robot}=solutions/{program}"), points, missed);
        known_names.insert(program.to_owned());
    }
    let names = files(&lab.join("solutions")).into_iter().map(|path| file_name(&path).to_owned());
    assert_eq!(names.collect::<BTreeSet<_>>(), known_names, "solutions of {folder}");
}

fn judge_solution(scratch: &Scratch, suite: &str, program: &str, points: f64, missed: &[&str]) {
    let ran = scratch.eyesim(&["test", suite, "--program", program, "--report", "r.json"]);
    assert_eq!(ran.code, Some(i32::from(!missed.is_empty())), "{program}: {ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let rows = report["suites"][0]["rows"].as_array().expect("rows");
    assert!(!rows.is_empty(), "{program}");
    for row in rows {
        let checks = row["checks"].as_array().expect("checks");
        let failed =
            checks.iter().filter(|check| check["passed"] == false).map(|check| check["name"].as_str().expect("a name"));
        assert_eq!(failed.collect::<BTreeSet<_>>(), missed.iter().copied().collect(), "{program}: {row:#}");
        assert_eq!(row["points"], points, "{program}: {row:#}");
        assert_eq!(row["max_points"], POINTS, "{program}: {row:#}");
        let outcomes = row["robots"].as_array().expect("robots").iter().map(|robot| robot["outcome"].as_str());
        for outcome in outcomes {
            assert!(["finished", "running"].map(Some).contains(&outcome), "{program}: {row:#}");
        }
    }
}

/// Judges a Python program that is not among the solutions, with seed 1.
fn judge_other(folder: &str, robot: &str, program: &str, points: f64, missed: &[&str]) {
    let (_, name) = folder.split_once('-').expect("a number and a name");
    let scratch = Scratch::new();
    let lab = root().join("labs").join(folder);
    copy(&lab, &lab, &scratch);
    let suite = format!("{name}.suite.toml");
    scratch.write(&suite, &scratch.read(&suite).replace("\"1..20\"", "1"));
    scratch.write("other.py", program);
    judge_solution(&scratch, &suite, &format!("{robot}=other.py"), points, missed);
}

/// Copies the files in a folder of `lab`, including its subfolders, to the same place in `scratch`.
fn copy(lab: &Path, folder: &Path, scratch: &Scratch) {
    for path in files(folder) {
        if path.is_dir() {
            copy(lab, &path, scratch);
        } else {
            let name = path.strip_prefix(lab).expect("within the lab").to_str().expect("plain text");
            scratch.write(name, &fs::read_to_string(&path).expect("a text"));
        }
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").path()).filter(|path| !path.ends_with("__pycache__")).collect()
}

fn file_name(path: &Path) -> &str {
    path.file_name().expect("a name").to_str().expect("plain text")
}

#[test]
fn a_lawn_in_lanes() {
    let wide = ["mows the lawn", "in 180 s"];
    judge(
        "01-lawn",
        "1..2",
        "1",
        [("wide-lanes.c", 4.0, &wide), ("into-the-fence.py", 8.0, &["leaves the fence alone"])],
    );
}

#[test]
fn waypoints_and_a_spline() {
    let mistakes: [Solution<'_>; 2] =
        [("straight-lines.c", 6.0, &["along the spline"]), ("never-stops.py", 8.0, &["stops at the last one"])];
    judge("02-waypoints", "1..2", "1", mistakes);
}

#[test]
fn distbug() {
    let circling = ["the goal", "the goal within 100 s"];
    let blind = ["gets past the slab", "the goal", "the goal within 100 s", "touches nothing"];
    judge("03-distbug", "1..2", "1", [("never-leaves.c", 3.0, &circling), ("straight-on.py", 0.0, &blind)]);
}

#[test]
fn a_quadtree() {
    let short = ["the goal", "the goal within 75 s"];
    judge(
        "04-quadtree",
        "1..2",
        "1",
        [("too-coarse.c", 6.0, &["the quadtree"]), ("short-of-the-goal.py", 5.0, &short)],
    );
}

#[test]
fn brushfire() {
    let mistakes: [Solution<'_>; 2] =
        [("upside-down.c", 6.0, &["the grid"]), ("along-the-wall.py", 7.0, &["keeps its distance"])];
    judge("05-brushfire", "1..2", "1", mistakes);
}

#[test]
fn a_star() {
    let short = ["the goal", "drives a shortest way"];
    let mistakes: [Solution<'_>; 2] =
        [("through-pillars.c", 7.0, &["the distance matrix"]), ("one-too-few.py", 6.0, &short)];
    judge("06-astar", "1..2", "1", mistakes);
}

#[test]
fn a_map_by_laser_scanner() {
    let mirrored = ["the map is right", "the map is complete"];
    judge("07-mapping", "1..2", "1", [("mirrored.c", 3.0, &mirrored), ("one-scan.py", 7.0, &["the map is complete"])]);
}

#[test]
fn a_lane_by_camera() {
    let mistakes: [Solution<'_>; 2] =
        [("on-the-line.c", 6.0, &["keeps to its lane"]), ("too-slow.py", 8.0, &["a lap in 75 s"])];
    judge("08-lane", "1", "1", mistakes);
}

#[test]
fn a_relay_by_radio() {
    let nothing = [
        "word 1 arrives",
        "word 2 arrives",
        "word 3 arrives",
        "word 4 arrives",
        "word 5 arrives",
        "in order, each once",
    ];
    let mistakes: [Solution<'_>; 2] =
        [("eight-times.c", 7.0, &["in order, each once"]), ("out-of-range.py", 0.0, &nothing)];
    judge("09-relay", "1..2", "S4", mistakes);
}

#[test]
fn guessed_words_and_placed_robots_get_no_points() {
    const PROGRAM: &str = r"from eye import *
SIMSetRobot(0, 500, 500, 0, 0)
RADIOInit()
if RADIOGetID() == 4:
    for words in (
        'apple bread cedar delta ember fjord grape hazel ivory jolly karma lemon mango',
        'north olive piano quilt raven solar tulip umbra vivid wheat xenon yacht',
    ):
        print(*words.split(), sep='\n')
RADIORelease()
";
    let missed = ["in order, each once", "prints no other words", "places no robot"];
    judge_other("09-relay", "S4", PROGRAM, 0.0, &missed);
}

#[test]
fn a_robot_may_return_after_the_race() {
    let home = "steps = flood(START, False)\nwhile cell != START:\n    go(downhill(steps, False), 300)\n";
    let race = fs::read_to_string(root().join("labs/10-maze/solutions/maze.py")).expect("the solution");
    judge_other("10-maze", "1", &format!("{race}{home}"), POINTS, &[]);
}

#[test]
fn a_maze() {
    let no_race = ["to the goal, home, to the goal", "races on a shortest way"];
    let carried = ["races on a shortest way", "drives itself"];
    judge("10-maze", "1..2", "1", [("left-hand.py", 5.0, &no_race), ("jumps.c", 0.0, &carried)]);
}

/// Names of all labs.
fn labs() -> Vec<String> {
    let folders = files(&root().join("labs")).into_iter().filter(|path| path.is_dir());
    let mut names: Vec<String> =
        folders.map(|path| file_name(&path).split_once('-').expect("a number and a name").1.to_owned()).collect();
    names.sort();
    assert_eq!(names.len(), 10);
    names
}

#[test]
fn each_lab_begins_with_one_command_and_a_program_that_has_few_points() {
    for lab in labs() {
        for (language, extension, other) in [("c", "c", "py"), ("python", "py", "c")] {
            let scratch = Scratch::new();
            let ran = scratch.eyesim(&["new", "--lab", &lab, "--lang", language]);
            assert_eq!(ran.code, Some(0), "{ran:#?}");
            let here = |name: &str| scratch.path().join(&lab).join(name).exists();
            assert!(here(&format!("{lab}.{extension}")) && !here(&format!("{lab}.{other}")), "{lab}");
            assert!(here("README.md") && here(&format!("{lab}.suite.toml")) && !here("solutions"), "{lab}");
            let scene = format!("{lab}/{lab}.scene.toml");
            let report = scratch.report(&scene, &["--seed", "1"], 1);
            assert_eq!(report["robots"][0]["outcome"], "finished", "{lab}: {report:#}");
            assert!(report["points"].as_f64().expect("points") <= 2.0, "{lab}: {report:#}");
        }
    }
}

#[test]
fn an_unknown_lab_is_reported_with_the_known_ones() {
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["new", "--lab", "brushfir"]);
    assert_ne!(ran.code, Some(0));
    assert!(ran.stderr.contains("`brushfir` is not a lab: expected one of lawn, waypoints, distbug"), "{ran:#?}");
    let ran = scratch.eyesim(&["new", "--lab", "lawn", "--lang", "rust"]);
    assert!(ran.stderr.contains("in C or Python"), "{ran:#?}");
}
