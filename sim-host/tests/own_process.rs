//! A library user's binary whose runs have robots in their own processes.

use std::process::ExitCode;

use sim_core::time::Time;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::program::Exec;
use sim_host::launch::{Observers, Options, Scene, serve_child};

mod common;

/// A custom `main`, since the robots' processes are started from this binary.
fn main() -> ExitCode {
    if let Some(code) = serve_child() {
        return code;
    }
    if common::has_compiler() {
        in_processes_the_same_happens();
        println!("test in_processes_the_same_happens ... ok");
        a_process_that_computes_tells_its_line_and_goes_on();
        println!("test a_process_that_computes_tells_its_line_and_goes_on ... ok");
    }
    ExitCode::SUCCESS
}

/// Computes in its line 6 until it has used 3 s of the processor.
const BUSY: &str = r#"
#include <sys/resource.h>
int main(void) {
    struct rusage used;
    volatile unsigned long n = 0;
    do for (int i = 0; i < 100000000; i++) n++; while (getrusage(RUSAGE_SELF, &used), used.ru_utime.tv_sec < 3);
    return 0;
}
"#;

fn a_process_that_computes_tells_its_line_and_goes_on() {
    let folder = common::scene(&[BUSY]);
    let options = Options { exec: Exec::Process, ..Options::default() };
    let ready = Scene::open(folder.path().join("scene.sim"), options).and_then(Scene::load);
    let running = ready.and_then(|ready| ready.start(Observers::default()));
    let mut running = running.unwrap_or_else(|error| panic!("{error}"));
    let (sender, messages) = std::sync::mpsc::channel();
    running.scheduler.listen_to_computing(move |words| sender.send(words.to_owned()).expect("a listener"));
    running.scheduler.advance_to(Time::NEVER);
    let finished = running.finish();
    assert_eq!(finished.report.robots[0].exit_code, Some(0), "{:?}", finished.report.robots[0].reason);
    drop(finished);
    assert!(messages.iter().any(|words| words == "r1 computes at p0.c:6"), "the line is not reported");
}

fn in_processes_the_same_happens() {
    let folder = common::scene(&[common::DRIVE, common::DRIVE]);
    let options = Options { exec: Exec::Process, ..Options::default() };
    let scene = Scene::open(folder.path().join("scene.sim"), options);
    let finished = scene.and_then(Scene::load).and_then(|ready| ready.run()).unwrap_or_else(|error| panic!("{error}"));
    assert!(matches!(finished.ended.end, EndReason::Finished), "{:?}", finished.ended.end);
    assert_eq!(finished.report.digest, common::run(folder.path()).digest);
}
