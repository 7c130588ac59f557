//! Golden digests: the run of every sample scene is bit-identical to the run with the recorded digest.
//!
//! A line of `goldens/digests.txt` describes a run: scene, digest, further options of `eyesim run`.
//! `INSTA_UPDATE=always` rewrites the file. Do this only for an intended change of runs, in a commit that lists the
//! changed runs and the reason.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;
use tests::{Scratch, root};

/// Virtual time at which each run ends, s.
const UNTIL: &str = "10";

/// A line of the list.
struct Golden {
    scene: String,
    digest: String,
    options: Vec<String>,
}

fn list_path() -> PathBuf {
    root().join("tests/goldens/digests.txt")
}

fn goldens() -> Vec<Golden> {
    let text = std::fs::read_to_string(list_path()).expect("the list of goldens");
    let golden = |line: &str| {
        let mut words = line.split_whitespace().map(str::to_owned);
        let (Some(scene), Some(digest)) = (words.next(), words.next()) else { panic!("`{line}`: scene and digest") };
        Golden { scene, digest, options: words.collect() }
    };
    text.lines().map(golden).collect()
}

/// Runs `golden` with `more` options and returns the digest.
fn digest(golden: &Golden, more: &[&str]) -> String {
    let scratch = Scratch::new();
    let scene = root().join("sims").join(&golden.scene);
    let options: Vec<String> =
        golden.options.iter().map(|word| word.replace("%tests%", &root().join("tests").to_string_lossy())).collect();
    let mut args = vec!["run", scene.to_str().expect("a path in UTF-8"), "--quiet", "--until", UNTIL];
    args.extend(["--report", "report.json"]);
    args.extend(options.iter().map(String::as_str));
    args.extend(more);
    let ran = scratch.eyesim(&args);
    assert!(ran.code.is_some(), "{}: {}", golden.scene, ran.stderr);
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
    report["digest"].as_str().expect("a digest").to_owned()
}

/// The goldens whose runs with `more` options have a different digest, and that digest. Two runs take place at a time.
fn changed(goldens: &[Golden], more: &[&str]) -> Vec<(usize, String)> {
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let index = next.fetch_add(1, Ordering::Relaxed)
            && let Some(golden) = goldens.get(index)
        {
            let digest = digest(golden, more);
            if digest != golden.digest {
                found.lock().expect("no run has panicked").push((index, digest));
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    found.into_inner().expect("no run has panicked")
}

fn assert_golden(more: &[&str]) {
    let mut goldens = goldens();
    let changed = changed(&goldens, more);
    if std::env::var("INSTA_UPDATE").is_ok_and(|how| how == "always") {
        changed.into_iter().for_each(|(index, digest)| goldens[index].digest = digest);
        let text = goldens.iter().fold(String::new(), |mut text, Golden { scene, digest, options }| {
            let _ = writeln!(text, "{}", format!("{scene} {digest} {}", options.join(" ")).trim_end());
            text
        });
        return std::fs::write(list_path(), text).expect("the list can be written");
    }
    let lines: Vec<String> =
        changed.iter().map(|(index, digest)| format!("{}: now {digest}", goldens[*index].scene)).collect();
    assert!(lines.is_empty(), "with {more:?} these runs have changed:\n{}", lines.join("\n"));
}

#[test]
fn every_sample_scene_has_its_golden_digest_on_fibers() {
    assert_golden(&[]);
}

#[test]
fn every_sample_scene_has_its_golden_digest_on_threads() {
    assert_golden(&["--exec", "thread"]);
}

#[test]
fn every_sample_scene_has_its_golden_digest_in_processes() {
    assert_golden(&["--exec", "process"]);
}

#[test]
fn every_sample_scene_is_in_the_list() {
    let entries = std::fs::read_dir(root().join("sims")).expect("the sample scenes");
    let files = entries.map(|entry| entry.expect("a file").file_name().to_string_lossy().into_owned());
    let scenes: BTreeSet<String> = files.filter(|name| name.ends_with(".sim") || name.ends_with(".toml")).collect();
    assert_eq!(goldens().into_iter().map(|golden| golden.scene).collect::<BTreeSet<_>>(), scenes);
}
