//! Scenes with robots without a program, and with programs that get arguments from the scene.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::Command;

use sim_core::pose::Pose;
use sim_core::record::Outcome;
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::scheduler::{Ended, Progress};
use sim_host::launch::{Observers, Options, Scene};
use sim_host::record::TraceFile;

const ROBI: &str = "diameter 200\nspeed 600\nturn 300\npsd PSD_FRONT -200 60 0 30 0\nwheel 54 3600 1100 90\n\
                    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// Measures the distance ahead, then drives against the obstacle.
const RAM: &str = r#"
#include "eyebot.h"
int main(void) {
    PSDHandle psd = PSDInit(PSD_FRONT);
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PSDStart(psd, TRUE);
    OSWait(20);
    LCDPrintf("%d", PSDGet(psd));
    VWDriveStraight(vw, 0.7, 0.5);
    OSWait(300);
    return 0;
}
"#;

/// Shows the arguments of its `main`.
const ECHO: &str = r#"
#include "eyebot.h"
int main(int argc, char **argv) {
    LCDPrintf("%d", argc);
    for (int i = 0; i < argc; i++) LCDPrintf(" %s", argv[i]);
    return argv[argc] != 0;
}
"#;

/// A folder with the scene: three robots on a line, 600 mm from each other, in a room of 4 m.
fn scene(programs: [&str; 3]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut sim = String::from("world room.wld\n");
    for (index, program) in programs.iter().enumerate() {
        sim += &format!("robi bot.robi {program} {} 2000 0\n", 1000 + 600 * index);
    }
    let room = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    let files = [("room.wld", room), ("bot.robi", ROBI), ("scene.sim", &sim), ("ram.c", RAM), ("echo.c", ECHO)];
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

/// Runs the scene after `change`; the trace goes to `trace.jsonl` in its folder.
fn run(folder: &Path, workers: usize, change: impl FnOnce(&mut SceneSpec)) -> Ended {
    let until = Some(Time::from_millis(60_000));
    let options = Options { workers: NonZeroUsize::new(workers), until, ..Options::default() };
    let mut scene = Scene::open(folder.join("scene.sim"), options).expect("a scene");
    assert!(scene.diagnostics().is_empty(), "{:?}", scene.diagnostics());
    change(scene.spec_mut());
    let ready = scene.load().unwrap_or_else(|error| panic!("{error}"));
    let trace = TraceFile::create(&folder.join("trace.jsonl"), &ready.trace_header()).expect("a trace");
    let running = ready.start(Observers { sinks: vec![Box::new(trace)], ..Observers::default() });
    let mut running = running.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(running.scheduler.advance_to(Time::NEVER), Progress::Paused);
    running.finish().ended
}

/// Trace lines of robot `robot`: event and time.
fn events(folder: &Path, robot: u32) -> Vec<(String, f64)> {
    let text = std::fs::read_to_string(folder.join("trace.jsonl")).expect("a trace");
    let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
    let event = |line: serde_json::Value| {
        (line["event"].as_str().expect("an event").to_owned(), line["t_s"].as_f64().expect("a time"))
    };
    lines.filter(|line| line["robot"] == robot).map(event).collect()
}

fn has_compiler() -> bool {
    let there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: `cc` is not installed");
    }
    there
}

#[test]
fn a_robot_without_a_program_is_detected_and_hit() {
    if !has_compiler() {
        return;
    }
    let folder = scene(["ram.c", "ram.c", "ram.c"]);
    let mut digests = Vec::new();
    for workers in [1, 2, 8] {
        let ended = run(folder.path(), workers, |scene| scene.robots[1].program = None);
        assert!(matches!(ended.end, EndReason::Finished), "{:?}", ended.end);
        let [ram, stands, other] = &ended.robots[..] else { panic!("three robots") };
        // From 60 mm ahead of the centre to the body of radius 100 mm: 600 - 60 - 100.
        assert_eq!(ram.panel.lines()[0].trim_end(), "440");
        assert_eq!((ram.outcome, ram.contacts), (Outcome::Finished, 1));
        assert!((ram.pose.position.x - 1.4).abs() < 2e-6, "it stops where the bodies meet: {:?}", ram.pose);
        assert_eq!((stands.outcome, stands.exit_code, &stands.reason), (Outcome::NoProgram, None, &None));
        assert_eq!((stands.pose, stands.path), (Pose::new(1.6, 2.0, 0.0), 0.0));
        assert!((other.pose.position.x - 2.9).abs() < 1e-6, "its way is free: {:?}", other.pose);
        digests.push(ended.digest);
    }
    assert_eq!([digests[0], digests[0]], digests[1..], "for any number of threads");
    let expected = [("program_started".to_owned(), 0.0), ("program_ended".to_owned(), 0.0)];
    assert_eq!(events(folder.path(), 2), expected);
    // Its start is recorded in the first slot, together with the other robots' starts.
    let text = std::fs::read_to_string(folder.path().join("trace.jsonl")).expect("a trace");
    let offset_of = |part: &str| text.find(part).unwrap_or_else(|| panic!("`{part}` in {text}"));
    let start = offset_of(r#""robot":2,"seq":0,"event":"program_started","program":"""#);
    assert!(start < offset_of(r#"{"event":"slot""#), "{text}");
}

#[test]
fn a_scene_without_programs_ends_immediately() {
    let folder = scene(["ram.c", "ram.c", "ram.c"]);
    let ended = run(folder.path(), 2, |scene| scene.robots.iter_mut().for_each(|robot| robot.program = None));
    assert!(matches!(ended.end, EndReason::Finished), "{:?}", ended.end);
    assert_eq!(ended.time, Time::ZERO, "no slot is run");
    assert!(ended.robots.iter().all(|robot| robot.outcome == Outcome::NoProgram));
    for robot in 1..=3 {
        assert_eq!(events(folder.path(), robot).len(), 2, "start and end are recorded");
    }
}

#[test]
fn the_arguments_of_the_scene_reach_main() {
    if !has_compiler() {
        return;
    }
    let folder = scene(["echo.c", "echo.c", "echo.c"]);
    let ended = run(folder.path(), 2, |scene| {
        scene.robots[0].arguments = vec!["-k".into(), "0 5".into()];
        scene.robots[2].arguments = vec![String::new()];
    });
    let panels: Vec<String> = ended.robots.iter().map(|robot| robot.panel.lines().remove(0)).collect();
    assert_eq!(panels, ["3 echo -k 0 5", "1 echo", "2 echo"]);
    assert!(ended.robots.iter().all(|robot| robot.exit_code == Some(0)), "argv ends with a null pointer");
}

#[test]
fn the_arguments_of_the_scene_reach_a_rust_program() {
    let square = Path::new(env!("CARGO_MANIFEST_DIR")).join("../example-programs/square").display().to_string();
    let folder = scene([&square, &square, &square]);
    let ended = run(folder.path(), 2, |scene| {
        scene.robots[0].arguments = vec!["0.1".into()];
        scene.robots[2].arguments = vec!["wide".into()];
    });
    let [own, default, wrong] = &ended.robots[..] else { panic!("three robots") };
    assert!((own.path - 0.4).abs() < 1e-6, "four sides of 0.1 m: {}", own.path);
    assert!((default.path - 1.6).abs() < 1e-6, "four sides of 0.4 m: {}", default.path);
    assert_eq!(wrong.outcome, Outcome::Failed);
    assert!(wrong.reason.as_ref().is_some_and(|reason| reason.contains("side `wide`")), "{:?}", wrong.reason);
}
