//! Robots and movable objects that are added to a running simulation and removed from it.

use std::num::NonZeroUsize;

use serde_json::Value;
use sim_core::record::{Action, Outcome};
use sim_core::time::Time;
use sim_host::executive::scheduler::Ended;
use sim_host::launch::{Observers, Options, Scene};
use sim_host::record::TraceFile;

const ROBI: &str = "diameter 200\nspeed 600\nturn 300\npsd PSD_FRONT -200 60 0 30 0\ncamera 0 0 80 0 0 80 60\n\
                    wheel 54 3600 1100 90\n\
                    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

/// Shows its start time, and drives 1 m in 2 s.
const DRIVE: &str = r#"
#include "eyebot.h"
int main(void) {
    LCDPrintf("%d ", OSGetCount());
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 1.0, 0.5);
    VWDriveWait(vw);
    return 0;
}
"#;

/// Shows the reading of its distance sensor every second, 4 times.
const LOOK: &str = r#"
#include "eyebot.h"
int main(void) {
    PSDHandle psd = PSDInit(PSD_FRONT);
    PSDStart(psd, TRUE);
    for (int i = 0; i < 4; i++) {
        OSWait(100);
        LCDPrintf("%d ", PSDGet(psd));
    }
    return 0;
}
"#;

/// Beginning of a program that prints a line when it is unwound.
const LEAVE: &str = r#"
#include <stdio.h>
#include <pthread.h>
#include "eyebot.h"
static void bye(void *name) { printf("%s leaves\n", (char *) name); }
"#;

/// Waits for a key.
const KEY: &str = r#"
int main(void) { pthread_cleanup_push(bye, "key"); KEYGet(); pthread_cleanup_pop(1); return 0; }
"#;

struct RunResult {
    ended: Ended,
    /// Lines of the trace.
    lines: Vec<Value>,
    /// Reason why each action was refused; `None` if it was carried out.
    answers: Vec<Option<String>>,
}

impl RunResult {
    fn of(&self, robot: u32) -> impl Iterator<Item = &Value> {
        self.lines.iter().filter(move |line| line["robot"] == robot)
    }

    fn lcd(&self, robot: usize) -> String {
        self.ended.robots[robot - 1].panel.lines().join("")
    }

    fn digest(&self) -> String {
        self.ended.digest.to_string()
    }
}

fn room(robots: &str, programs: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let room = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    let sim = format!("world room.wld\n{robots}");
    let mut files = vec![("room.wld", room), ("bot.robi", ROBI), ("scene.sim", &sim)];
    files.extend(programs);
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

/// Runs the scene for at most 10 s with these actions and their times in ms.
fn run(folder: &tempfile::TempDir, workers: usize, actions: &[(i64, Action)]) -> RunResult {
    let folder = folder.path();
    let until = Some(Time::from_millis(10_000));
    let options = Options { workers: NonZeroUsize::new(workers), until, ..Options::default() };
    let scene = Scene::open(folder.join("scene.sim"), options).expect("a scene");
    assert!(scene.diagnostics().is_empty(), "{:?}", scene.diagnostics());
    let ready = scene.load().unwrap_or_else(|error| panic!("{error}"));
    let trace_file = folder.join("trace.jsonl");
    let trace = TraceFile::create(&trace_file, &ready.trace_header()).expect("a trace");
    let running = ready.start(Observers { sinks: vec![Box::new(trace)], ..Observers::default() });
    let mut running = running.unwrap_or_else(|error| panic!("{error}"));
    let mut answers = Vec::new();
    for (ms, action) in actions {
        let at = Time::from_millis(*ms);
        running.scheduler.advance_to(at);
        answers.push(running.scheduler.act(at, action).err().map(|refusal| refusal.to_string()));
    }
    running.scheduler.advance_to(Time::NEVER);
    let ended = running.finish().ended;
    let text = std::fs::read_to_string(trace_file).expect("a trace");
    let lines = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    RunResult { ended, lines, answers }
}

fn add_robot(kind: &str, program_of: Option<u32>, x_m: f64, y_m: f64) -> Action {
    Action::AddRobot { kind: kind.into(), program_of, x_m, y_m, phi_rad: 0.0 }
}

fn add_object(kind: &str, x_m: f64, y_m: f64) -> Action {
    Action::AddObject { kind: kind.into(), x_m, y_m, phi_rad: 0.0 }
}

#[test]
fn a_spawned_robot_drives() {
    let scene = room("robi bot.robi drive.c 500 500 0\n", &[("drive.c", DRIVE)]);
    let actions = [(2050, add_robot("bot", Some(1), 0.5, 1.5)), (2500, add_robot("bot", None, 2.0, 3.0))];
    let ran = run(&scene, 1, &actions);
    assert_eq!(ran.answers, [None, None]);
    let outcomes: Vec<_> = ran.ended.robots.iter().map(|robot| robot.outcome).collect();
    assert_eq!(outcomes, [Outcome::Finished, Outcome::Finished, Outcome::NoProgram]);
    assert_eq!((ran.lcd(1).trim(), ran.lcd(2).trim()), ("0", "205"), "virtual time goes on for the new one");
    let position = ran.ended.robots[1].pose.position;
    assert!((position.x - 1.5).abs() < 1e-9 && position.y == 1.5, "it has driven its metre: {position}");
    let elapsed = ran.ended.robots[1].virtual_time.seconds() - 2.05;
    let first = ran.ended.robots[0].virtual_time.seconds();
    assert!((elapsed - first).abs() < 1e-6, "as long as the first one took: {elapsed} s, {first} s");
    let mut events = ran.of(2).map(|line| (line["event"].as_str().unwrap_or_default(), line["t_s"].as_f64()));
    assert_eq!(events.next(), Some(("program_started", Some(2.05))));
    assert_eq!(events.next(), Some(("pose", Some(2.05))), "where it came");
    for workers in [2, 3] {
        assert_eq!(run(&scene, workers, &actions).digest(), ran.digest());
    }
}

#[test]
fn checks_count_the_calls_of_a_spawned_robot() {
    let suite =
        "[suite]\nscene = \"scene.sim\"\n[[check]]\nkind = \"calls\"\nfunction = \"VWInit\"\nmin = 2\nmax = 2\n";
    let scene = room("robi bot.robi drive.c 500 500 0\n", &[("drive.c", DRIVE), ("all.suite.toml", suite)]);
    let until = Some(Time::from_millis(10_000));
    let checks = Some(scene.path().join("all.suite.toml"));
    let opened = Scene::open(scene.path().join("scene.sim"), Options { until, checks, ..Options::default() });
    let ready = opened.expect("a scene").load().unwrap_or_else(|error| panic!("{error}"));
    let mut running = ready.start(Observers::default()).unwrap_or_else(|error| panic!("{error}"));
    let at = Time::from_millis(2050);
    running.scheduler.advance_to(at);
    running.scheduler.act(at, &add_robot("bot", Some(1), 0.5, 1.5)).expect("a second robot");
    running.scheduler.advance_to(Time::NEVER);
    assert_eq!(running.finish().report.checks[0].message, "2 times");
}

#[test]
fn sensors_detect_spawned_entities_but_not_removed_ones() {
    let scene = room("robi bot.robi look.c 500 2000 0\n", &[("look.c", LOOK)]);
    let ran = run(
        &scene,
        2,
        &[
            (1500, add_object("Crate", 1.2, 2.0)),
            (2500, Action::RemoveObject { object: 1 }),
            (2550, add_robot("LabBot", None, 1.1, 2.0)),
            (3500, Action::RemoveRobot { robot: 2 }),
        ],
    );
    assert_eq!(ran.answers, [None, None, None, None]);
    let lcd = ran.lcd(1);
    let read: Vec<i32> = lcd.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    let [empty, crate_at, robot_at, again] = read[..] else { panic!("{lcd}") };
    assert_eq!(empty, again, "the far wall: {lcd}");
    assert!((robot_at - (1100 - 130 - 560)).abs() <= 1, "a LabBot of 260 mm ahead: {lcd}");
    assert!(crate_at < empty && crate_at > 300, "a crate ahead: {lcd}");
    assert_eq!(ran.ended.robots[1].outcome, Outcome::NoProgram);
}

#[test]
fn a_removed_robot_is_not_an_obstacle() {
    let robots = "robi bot.robi drive.c 500 500 0\nrobi bot.robi key.c 1000 500 0\n";
    let key = format!("{LEAVE}{KEY}");
    let scene = room(robots, &[("drive.c", DRIVE), ("key.c", &key)]);
    let stuck = run(&scene, 1, &[(5000, Action::RemoveRobot { robot: 2 })]);
    assert_eq!(stuck.ended.robots[0].contacts, 1);
    assert!((stuck.ended.robots[0].pose.position.x - 1.5).abs() < 1e-9, "the way became free, and it went on");
    let free = run(&scene, 1, &[(0, Action::RemoveRobot { robot: 2 })]);
    assert_eq!(free.ended.robots[0].contacts, 0);
    assert_eq!(
        free.ended.robots.iter().map(|robot| robot.outcome).collect::<Vec<_>>(),
        [Outcome::Finished, Outcome::Removed]
    );
}

#[test]
fn a_spawned_object_is_pushed() {
    let scene = room("robi bot.robi drive.c 500 500 0\n", &[("drive.c", DRIVE)]);
    let actions = [(500, add_object("Golf", 1.2, 0.5))];
    let ran = run(&scene, 1, &actions);
    assert_eq!(ran.answers, [None]);
    assert!(ran.ended.objects[0].position.x > 1.6, "{}", ran.ended.objects[0].position);
    assert_eq!(ran.digest(), run(&scene, 2, &actions).digest());
}

#[test]
fn the_program_of_a_removed_robot_exits_from_any_wait() {
    for (name, program) in [
        ("KEYGet", "KEYGet();"),
        ("OSWait", "OSWait(100000);"),
        ("AUTime", "for (;;) OSGetCount();"),
        ("OSSemP", "OSReady(OSSpawn(\"other\", other, 4000, 3, 1)); struct sem s; OSSemInit(&s, 0); OSSemP(&s);"),
        ("sleep", "for (;;) OSSleep(10);"),
    ] {
        let text = format!(
            "{LEAVE}void other(void) {{ for (;;) OSSleep(10); }}\nint main(void) {{ OSMTInit(COOP); pthread_cleanup_push(bye, \"{name}\"); {program} \
             pthread_cleanup_pop(1); return 0; }}\n"
        );
        let robots = "robi bot.robi drive.c 500 500 0\nrobi bot.robi wait.c 500 1500 0\n";
        let scene = room(robots, &[("drive.c", DRIVE), ("wait.c", &text)]);
        let actions = [(1050, Action::RemoveRobot { robot: 2 })];
        let ran = run(&scene, 1, &actions);
        assert_eq!(ran.ended.robots[1].outcome, Outcome::Removed, "{name}");
        assert_eq!(ran.ended.robots[0].outcome, Outcome::Finished, "{name}");
        assert_eq!(ran.ended.robots[1].virtual_time, Time::from_millis(1050), "{name}");
        assert_eq!(ran.digest(), run(&scene, 2, &actions).digest(), "{name}");
    }
}

#[test]
fn invalid_actions_are_refused() {
    let robots = "robi bot.robi drive.c 500 500 0\nrobi bot.robi key.c 3000 3000 0\n";
    let key = format!("{LEAVE}{KEY}");
    let scene = room(robots, &[("drive.c", DRIVE), ("key.c", &key)]);
    let actions = [
        (100, add_robot("Tank", None, 1.0, 1.0)),
        (100, add_robot("bot", Some(7), 1.0, 1.0)),
        (100, add_robot("bot", None, f64::NAN, 1.0)),
        (100, add_robot("bot", None, 0.05, 1.0)),
        (100, add_robot("bot", None, 3.1, 3.0)),
        (100, add_object("Piano", 1.0, 1.0)),
        (100, Action::RemoveRobot { robot: 3 }),
        (100, add_robot("bot", None, 1.0, 2.0)),
        (100, add_robot("bot", Some(3), 1.0, 3.0)),
        (100, Action::RemoveRobot { robot: 3 }),
        (100, Action::RemoveObject { object: 1 }),
        (100, Action::RemoveRobot { robot: 2 }),
        (100, Action::RemoveRobot { robot: 2 }),
        (100, Action::RemoveRobot { robot: 1 }),
    ];
    let ran = run(&scene, 1, &actions);
    let answers: Vec<&str> = ran.answers.iter().map(|answer| answer.as_deref().unwrap_or("done")).collect();
    insta::assert_snapshot!(answers.join("\n"), @r"
    there is no type of robots `Tank`, accepted: bot, LabBot, S4, Mako
    there is no robot 7
    x NaN m, y 1 m, phi 0 rad is not a valid pose: expected up to 1e6 m from the origin, and a heading up to 1e6 rad
    there is no room for a robot: a wall or a fixed object is in its place
    there is no room for a robot: robot 2 is in its place
    there is no type of movable objects `Piano`, accepted: Can, Soccer, Crate, Golf
    there is no robot 3
    done
    robot 3 has no program
    done
    there is no movable object 1
    done
    there is no robot 2
    robot 1 is the last one: a world has at least one robot
    ");
    let done: Vec<_> = actions.iter().zip(&ran.answers).filter(|(_, answer)| answer.is_none()).collect();
    let done: Vec<_> = done.into_iter().map(|(action, _)| action.clone()).collect();
    let ran_alone = run(&scene, 1, &done);
    assert_eq!(ran.digest(), ran_alone.digest(), "what was refused is not recorded");
}

#[test]
fn a_fault_of_a_spawned_robot_ends_the_run() {
    let crash =
        "#include \"eyebot.h\"\nint main(void) { if (OSGetCount() > 100) *(volatile int *) 8 = 1; KEYGet(); }\n";
    let scene = room("robi bot.robi crash.c 500 500 0\n", &[("crash.c", crash)]);
    let ran = run(&scene, 1, &[(2000, add_robot("bot", Some(1), 0.5, 1.5))]);
    assert_eq!(ran.ended.robots[1].outcome, Outcome::Failed);
    let reason = ran.ended.robots[1].reason.as_deref().unwrap_or_default();
    assert!(reason.contains("crash.c:2"), "{reason}");
    assert_eq!(ran.ended.robots[0].outcome, Outcome::Interrupted);
}
