//! `eyesim check` over the files of EyeSim that lie beside the repository, if they do: nothing of them is lost but what is missing.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;
use tests::{Scratch, root};

/// A file below the corpus, line, column, code.
type Finding<'a> = (&'a str, u64, u64, &'a str);

/// Worlds and robot files that lines name and nobody has: EyeSim, too, loses the scene to them.
const ERRORS: &[Finding<'_>] = &[
    ("vr-2018/Test Assets/examples/drivemodes/Ackermann.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/drivemodes/Diff.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/drivemodes/Omni.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/examples/maze/MazeSearch.sim", 5, 6, "file-missing"),
    ("vr-2018/Test Assets/sims/Example.sim", 14, 7, "file-missing"),
    ("vr-2018/older/31051b1/Test Assets/sims/test.sim", 2, 7, "file-missing"),
    ("vr-2018/older/6f4cc45/Test Assets/test.sim", 2, 7, "file-missing"),
    ("vr-2018/older/7d098b2/RobotVR-Build/examples/SPEED.sim", 2, 7, "file-missing"),
    ("vr-2018/older/7d098b2/RobotVR-Build/examples/SPEED.sim", 5, 6, "file-missing"),
    ("vr-2018/older/f906f0a/SavedSim.sim", 4, 7, "file-missing"),
];

/// What EyeSim passes over in silence. Not listed: files that moved with their scene, meshes, programs and types that the
/// collection does not hold.
const WARNINGS: &[Finding<'_>] = &[
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

/// Warnings about what the collection does not hold.
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

    // One line each for editors, the same ones.
    let output = check(&["--format", "short"]);
    let lines = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(lines.lines().filter(|line| line.contains(": error[")).count(), ERRORS.len(), "{lines}");
}
