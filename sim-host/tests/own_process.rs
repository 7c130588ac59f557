//! A library user's binary whose runs have robots in their own processes.

use std::process::ExitCode;

use sim_host::executive::dispatcher::End;
use sim_host::executive::program::Exec;
use sim_host::launch::{Options, Scene, serve_child};

mod common;

/// A custom `main`, since the robots' processes are started from this binary.
fn main() -> ExitCode {
    if let Some(code) = serve_child() {
        return code;
    }
    if common::has_compiler() {
        in_processes_the_same_happens();
        println!("test in_processes_the_same_happens ... ok");
    }
    ExitCode::SUCCESS
}

fn in_processes_the_same_happens() {
    let folder = common::scene(&[common::DRIVE, common::DRIVE]);
    let options = Options { exec: Exec::Process, ..Options::default() };
    let scene = Scene::open(folder.path().join("scene.sim"), options);
    let finished = scene.and_then(Scene::load).and_then(|ready| ready.run()).unwrap_or_else(|error| panic!("{error}"));
    assert!(matches!(finished.ended.end, End::Finished), "{:?}", finished.ended.end);
    assert_eq!(finished.report.digest, common::run(folder.path()).digest);
}
