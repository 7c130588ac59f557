//! Programs written by `eyesim new`: scenes without diagnostics, builds without warnings, and runs that drive to four
//! walls.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use sim_format::load_scene;
use sim_host::files::DiskFiles;
use sim_host::program::{Builder, Cache, Kits, Loader, Prepared, SearchPath, Tools, find_program, prepare};

/// A folder that is kept between test runs, so that cargo need not build `robios-api` each time.
fn place(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(folder.join("programs"));
    fs::create_dir_all(folder.join("programs")).expect("a folder");
    folder
}

/// Writes a new program with the real command, reads its scene and builds the program that the scene names.
fn new(parent: &Path, name: &str, language: &str, api: &str) -> Arc<Prepared> {
    let folder = parent.join("programs");
    let eyesim = Command::new(env!("CARGO_BIN_EXE_eyesim"))
        .args(["new", name, "--lang", language, "--api", api, "--path"])
        .arg(&folder)
        .output()
        .expect("eyesim runs");
    assert!(eyesim.status.success(), "{}", String::from_utf8_lossy(&eyesim.stderr));
    let sim = folder.join(name).join(format!("{name}.sim"));
    let loaded = load_scene(&sim.display().to_string(), &DiskFiles::default());
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    let search = SearchPath { sim_folder: sim.parent().map(Path::to_owned), ..SearchPath::default() };
    let found = find_program(loaded.scene.robots[0].program_name(), &search).unwrap_or_else(|error| panic!("{error}"));
    let cache = Cache::open(&parent.join("cache")).expect("a cache");
    let builder = Builder::new(cache, Kits::of_robios(), Tools::of_environment());
    let prepared = prepare(&builder, &[found]).pop().expect("a result").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(prepared.output, "", "the compiler warns");
    assert_eq!(prepared.warnings, Vec::<String>::new());
    prepared
}

/// Runs the scene and checks the report: the program has reached its four walls and ended without a contact.
fn check_run(parent: &Path, name: &str) {
    let folder = parent.join("programs").join(name);
    let report = folder.join("report.json");
    let eyesim = Command::new(env!("CARGO_BIN_EXE_eyesim"))
        .arg("run")
        .arg(folder.join(format!("{name}.sim")))
        .arg("--report")
        .arg(&report)
        .env("EYESIM_CACHE", parent.join("cache"))
        .output()
        .expect("eyesim runs");
    assert!(eyesim.status.success(), "{}", String::from_utf8_lossy(&eyesim.stderr));
    let report: serde_json::Value = serde_json::from_slice(&fs::read(report).expect("a report")).expect("JSON");
    let robot = &report["robots"][0];
    assert_eq!((robot["outcome"].as_str(), robot["contacts"].as_u64()), (Some("finished"), Some(0)), "{robot}");
    assert!(robot["path_m"].as_f64().is_some_and(|path| path > 4.0), "{robot}");
    assert!(robot["lcd"].to_string().contains("wall 4"), "{robot}");
}

fn is_installed(tool: &str) -> bool {
    let there = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: `{tool}` is not installed");
    }
    there
}

/// Writes, builds and runs a new program of each generation.
fn check(language: &str, compiler: &str) {
    if !is_installed(compiler) {
        return;
    }
    let folder = place(&format!("new-{language}"));
    for (api, name) in [("6", "maze"), ("7", "wall")] {
        let prepared = new(&folder, name, language, api);
        assert_eq!(prepared.name, name);
        let mut loader = Loader::new().expect("a run folder");
        for _ in 0..12 {
            loader.load(&prepared, &[], None).unwrap_or_else(|error| panic!("{error}"));
        }
        check_run(&folder, name);
        check_editor_settings(&folder.join("programs").join(name));
    }
}

/// Checks that the compiler finds the API with the flags of `compile_flags.txt` alone, as clangd does.
fn check_editor_settings(folder: &Path) {
    let Ok(flags) = fs::read_to_string(folder.join("compile_flags.txt")) else { return };
    let mut sources = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_source = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "c" || extension == "cpp");
    let source = sources.find(is_source).expect("a source");
    let compiler = Command::new("cc")
        .current_dir(folder)
        .args(flags.lines())
        .args(["-Werror", "-fsyntax-only"])
        .arg(source)
        .output()
        .expect("a compiler");
    assert!(compiler.status.success(), "{}", String::from_utf8_lossy(&compiler.stderr));
}

#[test]
fn new_c_programs_build_and_run() {
    check("c", "cc");
}

#[test]
fn new_rust_programs_build_and_run() {
    check("rust", "cargo");
}
