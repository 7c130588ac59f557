//! `eyesim check` over the EyeSim files beside the repository, if present. Only missing files cause losses.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tests::{Scratch, root};

/// A finding: file below the corpus, line, column, code.
type Finding<'a> = (&'a str, u64, u64, &'a str);

/// Errors: worlds and robot files that are named but exist nowhere. EyeSim cannot load these scenes either.
const ERRORS: &[Finding<'_>] = &[
    ("vr-2018/Test Assets/examples/drivemodes/Ackermann.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/drivemodes/Diff.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/drivemodes/Omni.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/maze/MazeSearch.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/sims/Example.sim", 14, 7, "file-missing"),
    ("vr-2018/older/7d098b2/RobotVR-Build/examples/SPEED.sim", 2, 7, "file-missing"),
    ("vr-2018/older/7d098b2/RobotVR-Build/examples/SPEED.sim", 5, 6, "file-missing"),
    ("vr-2018/older/f906f0a/SavedSim.sim", 4, 7, "file-missing"),
];

/// Mistakes that EyeSim ignores silently. The list omits files that moved with their scene, and meshes, programs and
/// types that are not in the collection.
const WARNINGS: &[Finding<'_>] = &[
    ("maze-course/maze1.maz", 1, 1, "maz-cell-first"),
    ("vr-2018/123.sim", 0, 0, "sim-robot-missing"),
    ("vr-2018/Test Assets/examples/random/Random3.sim", 4, 1, "sim-start-wall"),
    ("vr-2018/Test Assets/robots/Omni/Omni.robi", 0, 0, "robi-body-missing"),
    ("vr-2018/Test Assets/robots/Omni/Omni.robi", 32, 1, "robi-psd-order"),
    ("vr-2018/Test Assets/simple.sim", 3, 1, "sim-start-letter"),
    ("vr-2018/Test Assets/sims/test.sim", 10, 1, "sim-object-wall"),
    ("vr-2018/Test Assets/test.sim", 0, 0, "sim-world-missing"),
    ("vr-2018/Test Assets/worlds/mazes/regional1-1991.maz", 9, 17, "maz-letter"),
    ("vr-2018/Test Assets/worlds/mazes/reno-1993.maz", 1, 1, "maz-wide"),
    ("vr-2018/older/0ffb439/Test Assets/robots/LabBot.robi", 18, 1, "robi-name-reserved"),
    ("vr-2018/older/0ffb439/Test Assets/robots/LabBot.robi", 59, 1, "robi-drive-first"),
    ("vr-2018/older/31051b1/SavedSim.sim", 0, 0, "sim-robot-missing"),
    ("vr-2018/older/32112ae/Test Assets/test.sim", 0, 0, "sim-world-missing"),
    ("vr-2018/older/32112ae/Test Assets/test.sim", 5, 1, "sim-start-wall"),
    ("vr-2018/older/cd13c16/Test Assets/robots/LabBot.robi", 18, 1, "robi-name-reserved"),
    ("vr-2018/older/cd13c16/Test Assets/robots/LabBot.robi", 59, 1, "robi-drive-first"),
    ("vr-2018/older/d3e0685/Test Assets/test.sim", 0, 0, "sim-robot-missing"),
    ("vr-2018/older/da2768c/SavedSim.sim", 0, 0, "sim-robot-missing"),
    ("vr-2018/older/e431a50/Test Assets/robots/LabBot.robi", 21, 1, "robi-name-reserved"),
    ("vr-2018/older/e431a50/test.sim", 0, 0, "sim-robot-missing"),
    ("vr-2025/Sims/Updated_Objects/StopSign/STOP.obj", 3, 1, "file-case"),
    ("vr-2025/Sims/Updated_Objects/StopSign/stopsign.esObj", 4, 5, "file-case"),
    ("vr-2025/Sims/Updated_Robots/S4blue.robi", 1, 1, "robi-keyword"),
    ("vr-crate/LLMEyesim/eyesim/generator/legacy/maze_sim_16x16.sim", 0, 0, "sim-robot-missing"),
    ("vr-crate/LLMEyesim/eyesim/worlds/Crate/Boxes.esObj", 8, 1, "esobj-keyword"),
];

/// Codes of warnings about files that are not in the collection.
const ABSENT: [&str; 4] = ["file-missing", "file-moved", "program-missing", "sim-type-unknown"];

fn findings<'a>(all: &'a [Value], corpus: &str, severity: &str) -> BTreeSet<Finding<'a>> {
    let of_severity = all.iter().filter(|one| one["severity"] == severity);
    let finding = |one: &'a Value| {
        let text = |key: &str| one[key].as_str().expect("a text");
        let number = |key: &str| one[key].as_u64().expect("a number");
        let file = text("file").strip_prefix(corpus).expect("a file of the corpus").trim_start_matches('/');
        (file, number("line"), number("column"), text("code"))
    };
    of_severity.map(finding).collect()
}

#[test]
fn every_file_of_eyesim_is_checked_and_each_defect_named() {
    let corpus = root().join("../shared/eyesim/corpus");
    let Ok(corpus) = corpus.canonicalize() else {
        println!("skipped: there are no files of EyeSim at {}", corpus.display());
        return;
    };
    let path = corpus.to_str().expect("a path in UTF-8");
    let home: &Path = &corpus.join("vr-2018/Test Assets");
    let scratch = Scratch::new();
    let check = |args: &[&str]| {
        scratch.command(&[&["check"], args, &[path]].concat()).env("EYESIM_HOME", home).output().expect("eyesim starts")
    };
    let output = check(&["--format", "json"]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    let all: Vec<Value> = serde_json::from_slice(&output.stdout).expect("an array of diagnostics");
    assert_eq!(findings(&all, path, "error"), ERRORS.iter().copied().collect());
    let mut warnings = findings(&all, path, "warning");
    warnings.retain(|(_, _, _, code)| !ABSENT.contains(code) && !code.starts_with("mesh-"));
    assert_eq!(warnings, WARNINGS.iter().copied().collect());

    // The same diagnostics, one line each, for editors.
    let output = check(&["--format", "short"]);
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(lines.lines().filter(|line| line.contains(": error[")).count(), ERRORS.len(), "{lines}");
}

/// Programs that scenes name but that are not in the collection, by the names under which stand-ins are given.
const STAND_INS: &[(&str, &[&str])] = &[
    ("two-starts/01-w5_simulation.sim", &["02-prey", "03-predator.py"]),
    ("follow-leader/01-w5_simulation.sim", &["leader.py", "worker"]),
    ("maze-course/Maze.sim", &["maze_left"]),
    ("vr-2018/Test Assets/examples/omni/ODW-maze.sim", &["odw.dll"]),
    ("vr-2018/Test Assets/examples/omni/ODW-world.sim", &["odw"]),
    ("vr-2018/Test Assets/examples/pantilt/PanTilt.sim", &["servo"]),
    ("vr-2018/Test Assets/examples/random/Random1.sim", &["/Users/student/eyesim/examples/random/random.x"]),
    ("vr-2018/Test Assets/examples/random/Random3.sim", &["random.x"]),
    ("vr-2018/older/3b2ffd9/Test Assets/test.sim", &["list.x"]),
    ("vr-2018/older/6f4cc45/Test Assets/test.sim", &["test.exe"]),
    ("vr-2018/older/7832648/RobotVR-Build/examples/SPEED.sim", &["speed.dll"]),
];

/// Returns true if a scene has a robot; otherwise there is nothing to run.
fn has_robots(file: &str) -> bool {
    !WARNINGS.iter().any(|(name, _, _, code)| *name == file && *code == "sim-robot-missing")
}

#[test]
fn every_scene_of_eyesim_runs_with_stand_ins_for_its_missing_programs() {
    let Ok(corpus) = root().join("../shared/eyesim/corpus").canonicalize() else {
        println!("skipped: there are no files of EyeSim beside the repository");
        return;
    };
    let home: &Path = &corpus.join("vr-2018/Test Assets");
    let scratch = Scratch::new();
    scratch.write(
        "stand-in.c",
        "#include \"eyebot.h\"\nint main(void) { LCDPrintf(\"robot %d\", OSMachineID()); OSWait(10); return 0; }\n",
    );
    let mut count = 0;
    for path in sim_files(&corpus) {
        let file = path.strip_prefix(&corpus).expect("a file of the corpus").to_str().expect("UTF-8");
        let run = |stand_ins: &[&str]| {
            let programs = stand_ins.iter().flat_map(|name| ["--program".to_owned(), format!("{name}=stand-in.c")]);
            let mut command = scratch.command(&["run", path.to_str().expect("UTF-8"), "--report", "report.json"]);
            let output = command.args(programs).env("EYESIM_HOME", home).output().expect("eyesim starts");
            (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
        };
        let stand_ins = STAND_INS.iter().find(|(name, _)| *name == file).map(|(_, stand_ins)| *stand_ins);
        let (code, stderr) = run(&[]);
        if ERRORS.iter().any(|(name, ..)| *name == file) || !has_robots(file) {
            assert_eq!(code, Some(2), "{file}: {stderr}");
            continue;
        }
        // Without stand-ins only scenes without programs can run.
        assert_eq!(code, Some(if stand_ins.is_some() { 2 } else { 0 }), "{file}: {stderr}");
        let stand_ins = stand_ins.unwrap_or(&[""]);
        let (code, stderr) = run(stand_ins);
        assert_eq!(code, Some(0), "{file} with stand-ins for {stand_ins:?}: {stderr}");
        let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report");
        for robot in report["robots"].as_array().expect("robots") {
            assert_eq!(robot["outcome"], "finished", "{file}: {robot:#}");
            assert_eq!(robot["lcd"][0].as_str().expect("text").trim(), format!("robot {}", robot["id"]), "{file}");
        }
        count += 1;
    }
    assert!(count >= STAND_INS.len() + 10, "{count} scenes ran");
}

/// All sim files below a folder, in order.
fn sim_files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut files = BTreeSet::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of the corpus") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("sim")) {
                files.insert(path);
            }
        }
    }
    files
}
