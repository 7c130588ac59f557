//! Scenes and object types of all dialects, from a local corpus of real files if present, with all their diagnostics.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use sim_format::{Code, FileError, Files, Loaded, Severity, load_object, load_scene};

/// Corpus beside the repository, with one of its folders as the installation.
struct Corpus {
    root: PathBuf,
}

impl Corpus {
    /// Finds the corpus; prints a note and returns `None` if it is absent.
    fn find() -> Option<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/eyesim/corpus");
        if !root.is_dir() {
            eprintln!("skipped: no corpus at {}", root.display());
            return None;
        }
        Some(Self { root })
    }

    /// Sorted paths, below the corpus, of all files with the extension.
    fn files(&self, extension: &str) -> Vec<String> {
        let mut open = vec![self.root.clone()];
        let mut files = Vec::new();
        while let Some(path) = open.pop() {
            if path.is_dir() {
                open.extend(fs::read_dir(&path).into_iter().flatten().flatten().map(|entry| entry.path()));
            } else if path.extension().is_some_and(|found| found.eq_ignore_ascii_case(extension)) {
                let below = path.strip_prefix(&self.root).expect("a path below the corpus");
                files.push(below.to_string_lossy().replace('\\', "/"));
            }
        }
        files.sort();
        files
    }
}

impl Files for Corpus {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        fs::read(self.root.join(path)).map_err(|error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => FileError::Missing,
            _ => FileError::Unreadable(error.to_string()),
        })
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.root.join(folder)).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    fn home(&self) -> Option<&str> {
        Some("vr-2018/Test Assets")
    }
}

/// Diagnostic of a line: `E` or `W` for the severity, the code, the line.
type Reported = (char, &'static str, u32);

/// Diagnostics of the sim file itself, in order; only the first of successive equal ones.
fn reported(file: &str, loaded: &Loaded) -> Vec<Reported> {
    let of_sim = loaded.diagnostics.iter().filter(|diagnostic| diagnostic.file == file);
    let mut reported: Vec<_> = of_sim
        .map(|diagnostic| {
            let severity = if diagnostic.severity == Severity::Error { 'E' } else { 'W' };
            (severity, diagnostic.code.name(), diagnostic.span.line)
        })
        .collect();
    reported.sort_by_key(|(_, _, line)| *line);
    reported.dedup_by_key(|(severity, code, _)| (*severity, *code));
    reported
}

/// Known defects of the corpus; its other scenes have none.
const DEFECTS: &[(&str, &[Reported])] = &[
    // Absolute paths of the author's machine; the files were moved along with the scene.
    ("vr-2018/123.sim", &[('W', "sim-robot-missing", 0), ('W', "file-moved", 4)]),
    ("vr-2018/Test Assets/MySim.sim", &[('W', "file-moved", 4)]),
    ("vr-2018/Test Assets/examples/random/Random1.sim", &[('W', "file-moved", 2)]),
    ("vr-2018/Test Assets/examples/random/Random3.sim", &[('W', "file-moved", 2), ('W', "sim-start-wall", 4)]),
    ("vr-2018/older/7832648/RobotVR-Build/examples/SPEED.sim", &[('W', "file-moved", 5)]),
    ("vr-2018/test.sim", &[('W', "file-moved", 4)]),
    ("vr-2018/older/31051b1/Test Assets/sims/test.sim", &[('W', "file-moved", 2)]),
    ("vr-2018/older/6f4cc45/Test Assets/test.sim", &[('W', "file-moved", 2)]),
    ("vr-2025/Sims/Straight.sim", &[('W', "file-moved", 5)]),
    ("vr-2025/Sims/Track_1_Objects.sim", &[('W', "file-moved", 8)]),
    ("vr-2018/older/3b2ffd9/Test Assets/test.sim", &[('W', "file-moved", 4)]),
    ("vr-2018/older/d3e0685/Test Assets/test.sim", &[('W', "sim-robot-missing", 0), ('W', "file-moved", 4)]),
    // Robot files missing in the corpus.
    ("vr-2018/Test Assets/examples/drivemodes/Ackermann.sim", &[('E', "file-missing", 5)]),
    ("vr-2018/Test Assets/examples/drivemodes/Diff.sim", &[('E', "file-missing", 5)]),
    ("vr-2018/Test Assets/examples/drivemodes/Omni.sim", &[('E', "file-missing", 5)]),
    ("vr-2018/Test Assets/examples/maze/MazeSearch.sim", &[('E', "file-missing", 5)]),
    // Worlds missing in the corpus.
    ("vr-2018/older/7d098b2/RobotVR-Build/examples/SPEED.sim", &[('E', "file-missing", 2)]),
    ("vr-2018/older/f906f0a/SavedSim.sim", &[('E', "file-missing", 4)]),
    // A template with placeholder names.
    (
        "vr-2018/Test Assets/sims/Example.sim",
        &[('E', "file-missing", 14), ('W', "file-missing", 17), ('W', "sim-type-unknown", 28)],
    ),
    // The start of the maze has another letter.
    ("vr-2018/Test Assets/simple.sim", &[('W', "sim-start-letter", 3)]),
    ("vr-2018/Test Assets/sims/test.sim", &[('W', "sim-object-wall", 10)]),
    // Scenes without a world or without robots.
    ("vr-2018/Test Assets/test.sim", &[('W', "sim-world-missing", 0)]),
    ("vr-2018/older/32112ae/Test Assets/test.sim", &[('W', "sim-world-missing", 0), ('W', "sim-start-wall", 5)]),
    ("vr-2018/older/31051b1/SavedSim.sim", &[('W', "sim-robot-missing", 0)]),
    ("vr-2018/older/da2768c/SavedSim.sim", &[('W', "sim-robot-missing", 0)]),
    ("vr-2018/older/e431a50/test.sim", &[('W', "sim-robot-missing", 0)]),
    // Ninety-two crates of a type that no line loads.
    (
        "vr-crate/LLMEyesim/eyesim/generator/legacy/maze_sim_16x16.sim",
        &[('W', "sim-robot-missing", 0), ('W', "sim-type-unknown", 3)],
    ),
];

#[test]
fn every_scene_has_its_known_defects() {
    let Some(corpus) = Corpus::find() else { return };
    let defects: BTreeMap<&str, &[_]> = DEFECTS.iter().copied().collect();
    let files = corpus.files("sim");
    assert!(files.len() >= 38, "only {} scenes", files.len());
    assert!(defects.keys().all(|name| files.iter().any(|file| file == name)), "a scene of the list is missing");
    for file in files {
        let loaded = load_scene(&file, &corpus);
        let expected = defects.get(file.as_str()).copied().unwrap_or_default();
        assert_eq!(reported(&file, &loaded), expected, "{file}");
        let missing = |code| loaded.diagnostics.iter().any(|diagnostic| diagnostic.code == code);
        assert!(!missing(Code::SimKeyword) && !missing(Code::WordExtra), "{file}: every line is understood");
    }
}

/// The numbers of loaded robots and objects equal the numbers of lines that place them, counted on the text.
#[test]
fn every_line_that_places_an_entity_is_read() {
    let Some(corpus) = Corpus::find() else { return };
    for file in corpus.files("sim") {
        let loaded = load_scene(&file, &corpus);
        if loaded.has_errors() || loaded.diagnostics.iter().any(|found| found.code == Code::SimTypeUnknown) {
            continue;
        }
        let text = String::from_utf8(corpus.read(&file).expect("a scene")).expect("a text");
        let lines = text.lines().map(|line| line.trim().to_lowercase());
        let count = |names: &[&str]| {
            let is_entity = |line: &String| line.split_whitespace().next().is_some_and(|word| names.contains(&word));
            lines.clone().filter(is_entity).count()
        };
        let robots = count(&["labbot", "s4", "s4bot", "s4blue"]);
        let classic =
            lines.clone().filter(|line| line.starts_with("robi") && line.split_whitespace().count() > 2).count();
        assert_eq!(loaded.scene.robots.len(), robots + classic, "{file}");
        let signs = count(&["stopsign", "speedlimitsign", "10speedlimitsign", "can", "soccer", "crate", "golf"]);
        let meshes = lines.clone().filter(|line| line.ends_with(".ms3d")).count();
        let of_maze = loaded.scene.world.objects.len();
        assert_eq!(loaded.scene.objects.len(), signs + meshes + of_maze, "{file}");
        assert_eq!(loaded.scene.markers.len(), count(&["marker"]), "{file}");
        assert_eq!(loaded.scene.settings.shows_beams, count(&["settings"]) > 0, "{file}");
    }
}

#[test]
fn every_object_file_is_read() {
    let Some(corpus) = Corpus::find() else { return };
    let files = corpus.files("esobj");
    assert!(files.len() >= 5, "only {} object files", files.len());
    for file in files {
        let (object, loaded) = load_object(&file, &corpus);
        let object = object.expect("a file");
        let codes: Vec<&str> = loaded.diagnostics.iter().map(|diagnostic| diagnostic.code.name()).collect();
        // A stray `0` on a line.
        let expected: &[&str] = if file.ends_with("Boxes.esObj") { &["esobj-keyword"] } else { &[] };
        assert_eq!(codes, expected, "{file}");
        assert_eq!(object.colliders.len(), 1, "{file}");
        let is_crate = object.name == "Crate1";
        assert_eq!((object.is_fixed, object.mass), (is_crate, if is_crate { 1.0 } else { 2.0 }), "{file}");
        // From signs of 7.5 mm width to a crate that fills the cell of a maze.
        let reach = object.colliders[0].reach();
        assert!((0.003..0.26).contains(&reach), "{file}: {reach} m");
    }
}
