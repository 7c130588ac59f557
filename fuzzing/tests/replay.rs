//! All committed inputs, and a local corpus of EyeSim files if present, checked against the invariants of their
//! readers.

use std::fs;
use std::path::{Path, PathBuf};

use fuzzing::{TARGETS, check};

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Files in `folder` and below it, in the order of their paths; none if the folder does not exist.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(folder) else { continue };
        for entry in entries {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

fn replay(target: &str, path: &Path) {
    // Shown if the check panics.
    println!("{target}: {}", path.display());
    check(target, &fs::read(path).expect("a readable file"));
}

#[test]
fn seeds_and_regressions_cause_no_failure() {
    for target in TARGETS {
        let seeds = files_below(&root().join("fuzz/seeds").join(target.name));
        assert!(!seeds.is_empty(), "`{}` has no seeds", target.name);
        let findings = files_below(&root().join("fuzz/regressions").join(target.name));
        for path in seeds.iter().chain(&findings) {
            replay(target.name, path);
        }
    }
}

#[test]
fn every_target_has_its_binary_and_every_input_its_target() {
    let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    let manifest = fs::read_to_string(root().join("fuzz/Cargo.toml")).expect("the manifest of the fuzz targets");
    for name in &names {
        assert!(manifest.contains(&format!("path = \"fuzz_targets/{name}.rs\"")), "`{name}` is not in fuzz/Cargo.toml");
        let source = fs::read_to_string(root().join(format!("fuzz/fuzz_targets/{name}.rs"))).expect("its source");
        assert!(source.contains(&format!("check(\"{name}\", input)")), "{source}");
    }
    for folder in ["seeds", "regressions"] {
        for path in files_below(&root().join("fuzz").join(folder)) {
            let parent = path.parent().and_then(Path::file_name).and_then(|name| name.to_str()).unwrap_or_default();
            assert!(names.contains(&parent), "{} belongs to no target", path.display());
        }
    }
}

#[test]
fn files_of_eyesim_cause_no_failure() {
    let corpus = root().join("../shared/eyesim/corpus");
    let files = files_below(&corpus);
    if files.is_empty() {
        println!("skipped: there are no files of EyeSim at {}", corpus.display());
        return;
    }
    for path in files {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
        let target = match extension.as_str() {
            "wld" => "world",
            "maz" | "maze" => "maze",
            "robi" => "robi",
            "sim" => "sim",
            "esobj" => "esobj",
            _ => continue,
        };
        replay(target, &path);
    }
}
