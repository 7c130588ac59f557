//! The scheduler as the owner of a run uses it: boundaries between slots, actions at them, and runs that observing does
//! not change.

use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use sim_core::record::{Action, Digest, Event, Kind, KindSet, Outcome, Record};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_host::executive::dispatcher::{Boundary, EndReason};
use sim_host::executive::scheduler::{Ended, Progress, Scheduler, SnapshotError};
use sim_host::launch::{Observers, Options, Ready, Scene};
use sim_host::record::{RecordError, Sink};

const WAIT: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 0.2, 0.2);
    VWDriveWait(vw);
    KEYWait(KEY1);
    return 0;
}
"#;

/// A run of two robots that drive for a second and wait for a key.
fn ready() -> Ready {
    let folder = tempfile::tempdir().expect("a folder");
    let sim = "world room.wld\nrobi bot.robi wait.c 500 500 0\nrobi bot.robi wait.c 500 1500 0\n";
    let robi = "diameter 200\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let room = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    for (name, text) in [("room.wld", room), ("bot.robi", robi), ("scene.sim", sim), ("wait.c", WAIT)] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let scene = Scene::open(folder.path().join("scene.sim"), Options::default());
    scene.and_then(Scene::load).unwrap_or_else(|error| panic!("{error}"))
}

/// Result of a run that `owner` advances.
fn run_by(owner: impl FnOnce(&mut Scheduler), sinks: Vec<Box<dyn Sink>>) -> Ended {
    let running = ready().start(Observers { sinks, ..Observers::default() });
    let mut running = running.unwrap_or_else(|error| panic!("{error}"));
    owner(&mut running.scheduler);
    running.finish().ended
}

/// Result of a run that is advanced in one call.
fn run() -> Ended {
    run_by(|scheduler| assert_eq!(scheduler.advance_to(Time::NEVER), Progress::Paused), Vec::new())
}

fn press(scheduler: &mut Scheduler, at: Time, robot: u32, key: &str) -> Result<(), String> {
    let action = Action::Press { robot, key: key.to_owned() };
    scheduler.act(at, &action).map_err(|why| why.to_string())
}

fn has_compiler() -> bool {
    let there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: `cc` is not installed");
    }
    there
}

/// Robots whose calls are recorded.
#[derive(Default)]
struct Callers(BTreeSet<RobotId>);

impl Sink for Callers {
    fn interest(&self) -> KindSet {
        Kind::Call.set()
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        assert!(matches!(record.event, Event::Call { .. }));
        self.0.insert(record.robot);
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

#[test]
fn pausing_and_observing_every_slot_changes_nothing() {
    if !has_compiler() {
        return;
    }
    let plain = run();
    assert!(matches!(plain.end, EndReason::Stuck), "{:?}", plain.end);
    let mut boundaries = Vec::new();
    let callers = Arc::new(Mutex::new(Callers::default()));
    let owner = |scheduler: &mut Scheduler| {
        loop {
            let Boundary { following, next, .. } = scheduler.boundary();
            let run = scheduler.run();
            assert_eq!(run.world().slot_start(), following);
            boundaries.push((following, next));
            // Robots are suspended, so their state can be read; the recording of a robot's calls changes nothing
            // either.
            run.set_verbose(RobotId(2), true);
            assert_eq!(run.robot(RobotId(1)).id, RobotId(1));
            let Some(next) = next else { return };
            assert_eq!(scheduler.advance_to(next), Progress::Paused);
            assert_eq!(scheduler.boundary().following, following, "no slot starts before it");
            assert_eq!(scheduler.advance_to(next + Time(1)), Progress::Paused);
            assert!(scheduler.boundary().following > next, "the slot has been run");
        }
    };
    let watched = run_by(owner, vec![Box::new(Arc::clone(&callers))]);
    assert_eq!((watched.digest, watched.time), (plain.digest, plain.time));
    assert!(matches!(watched.end, EndReason::Stuck), "{:?}", watched.end);
    assert_eq!(callers.lock().0, BTreeSet::from([RobotId(2)]), "the other one's calls nobody wants");
    assert_eq!(boundaries.first(), Some(&(Time::ZERO, Some(Time::ZERO))), "it stands before the first slot");
    assert_eq!(boundaries.last(), Some(&(plain.time, None)), "and then where nothing happens any more");
    assert!(boundaries.is_sorted() && boundaries.len() > 20, "{boundaries:?}");
}

#[test]
fn a_run_waiting_for_user_input_continues_after_it() {
    if !has_compiler() {
        return;
    }
    let mut answers = Vec::new();
    let owner = |scheduler: &mut Scheduler| {
        assert_eq!(scheduler.advance_to(Time::NEVER), Progress::Paused);
        assert_eq!(scheduler.boundary().next, None);
        // The time is within a slot: the action happens at the slot's start.
        let at = Time(7_012_345);
        answers = ["KEY1", "KEY9", "KEY1"]
            .into_iter()
            .zip([1, 1, 2])
            .map(|(key, robot)| press(scheduler, at, robot, key))
            .collect();
        assert_eq!(scheduler.advance_to(Time::NEVER), Progress::Paused);
    };
    let ended = run_by(owner, Vec::new());
    assert!(matches!(ended.end, EndReason::Finished), "{:?}", ended.end);
    for robot in &ended.robots {
        assert_eq!(robot.outcome, Outcome::Finished);
        assert!((7.0..7.05).contains(&robot.virtual_time.seconds()), "{}", robot.virtual_time);
    }
    assert_eq!((answers.len(), &answers[0], &answers[2]), (3, &Ok(()), &Ok(())));
    assert!(answers[1].as_ref().is_err_and(|why| why.starts_with("`KEY9` is not a key")), "{answers:?}");
}

#[test]
fn refused_actions_do_not_advance_time() {
    if !has_compiler() {
        return;
    }
    let plain = run();
    let mut answers = Vec::new();
    let owner = |scheduler: &mut Scheduler| {
        scheduler.advance_to(Time::NEVER);
        let boundary = scheduler.boundary();
        for at in [Time::from_millis(30_000), Time::from_millis(30_000), boundary.limit] {
            answers.push(press(scheduler, at, 3, "KEY1"));
            assert_eq!(scheduler.boundary(), boundary);
        }
    };
    let ended = run_by(owner, Vec::new());
    assert_eq!((ended.digest, ended.time), (plain.digest, plain.time));
    let over = Err("the run is over by then".to_owned());
    let nobody = Err("there is no robot 3".to_owned());
    assert_eq!(answers, [nobody.clone(), nobody, over]);
}

#[test]
fn actions_happen_no_later_than_the_next_due_slot() {
    if !has_compiler() {
        return;
    }
    let mut answers = Vec::new();
    let owner = |scheduler: &mut Scheduler| {
        let at = Time::from_millis(500_000);
        answers = [1, 2].map(|robot| press(scheduler, at, robot, "KEY1")).into();
        scheduler.advance_to(Time::NEVER);
    };
    let ended = run_by(owner, Vec::new());
    // Both keys are pressed before the first slot, and kept until the drive is over.
    assert!(matches!(ended.end, EndReason::Finished), "{:?}", ended.end);
    assert!(ended.time < Time::from_millis(1_200), "{}", ended.time);
    assert_eq!(answers, [Ok(()), Ok(())]);
}

#[test]
fn the_owner_can_end_a_run_at_any_time() {
    if !has_compiler() {
        return;
    }
    for end in [Time::ZERO, Time::from_millis(500)] {
        for is_interrupted in [true, false] {
            let owner = |scheduler: &mut Scheduler| {
                scheduler.advance_to(end);
                if is_interrupted {
                    scheduler.interrupt();
                    assert_eq!(scheduler.advance_to(Time::NEVER), Progress::Over);
                }
            };
            let ended = run_by(owner, Vec::new());
            assert!(matches!(ended.end, EndReason::Interrupted), "{:?}", ended.end);
            assert_eq!(ended.time, end);
            assert!(ended.robots.iter().all(|robot| robot.outcome == Outcome::Interrupted));
        }
    }
}

#[test]
fn a_run_pauses_when_its_time_budget_is_used_up() {
    if !has_compiler() {
        return;
    }
    let plain = run();
    let owner = |scheduler: &mut Scheduler| {
        while let Boundary { next: Some(next), slot, .. } = scheduler.boundary() {
            assert_eq!(scheduler.advance_within(Time::NEVER, Duration::ZERO), Progress::Paused);
            assert_eq!(scheduler.boundary().following, next + slot, "one slot is run, however short the time");
        }
    };
    let ended = run_by(owner, Vec::new());
    assert_eq!((ended.digest, ended.time), (plain.digest, plain.time));
}

#[test]
fn programs_of_a_dropped_run_exit() {
    if !has_compiler() {
        return;
    }
    for end in [Time::ZERO, Time::from_millis(500)] {
        let callers = Arc::new(Mutex::new(Callers::default()));
        let sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&callers))];
        let running = ready().start(Observers { sinks, ..Observers::default() });
        let mut running = running.unwrap_or_else(|error| panic!("{error}"));
        running.scheduler.advance_to(end);
        drop(running);
        // The last flow that exits drops the run, and with it the sinks.
        let start = Instant::now();
        while Arc::strong_count(&callers) > 1 {
            assert!(start.elapsed() < Duration::from_secs(60), "a program has not left");
            std::thread::yield_now();
        }
    }
}

/// Digest of the run so far.
#[derive(Default)]
struct LastDigest(Option<Digest>);

impl Sink for LastDigest {
    fn interest(&self) -> KindSet {
        KindSet::NONE
    }

    fn record(&mut self, _: &Record<'_>) -> Result<(), RecordError> {
        Ok(())
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, _: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        self.0 = digest.or(self.0);
        Ok(())
    }
}

/// A run without programs and a copy of it continue in the same way: user actions have bit-identical effects in both.
#[test]
fn a_run_without_programs_can_be_copied() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "[world]\nfloor_mm = [4000, 4000]\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n\
                 [[object]]\ntype = \"Can\"\nx_mm = 800\ny_mm = 500\n";
    let path = folder.path().join("still.scene.toml");
    std::fs::write(&path, scene).expect("a file");
    let last = Arc::new(Mutex::new(LastDigest::default()));
    let sinks: Vec<Box<dyn Sink>> = vec![Box::new(Arc::clone(&last))];
    let ready = Scene::open(&path, Options::default()).and_then(Scene::load);
    let running = ready.and_then(|ready| ready.start(Observers { sinks, ..Observers::default() }));
    let mut running = running.unwrap_or_else(|error| panic!("{error}"));
    let run = &mut running.scheduler;
    let placement = Action::PlaceObject { object: 1, x_m: 0.62, y_m: 0.5, phi_rad: 1.0 };
    run.act(Time::ZERO, &placement).expect("a place");
    run.advance_to(Time::from_millis(400));

    let at = run.boundary().following;
    let mut simulation = run.snapshot().expect("nobody has a program");
    assert_eq!(simulation.now(), at);
    let robot = Action::PlaceRobot { robot: 1, x_m: 1.0, y_m: 1.0, phi_rad: 0.5 };
    let object = Action::AddObject { kind: "Can".to_owned(), x_m: 1.12, y_m: 1.0, phi_rad: 0.0 };
    for action in [robot, object] {
        simulation.act(&action).expect("it is done");
        run.act(at, &action).expect("it is done");
    }
    let end = at + Time::from_millis(500);
    simulation.advance_to(end);
    run.advance_to(end);
    let states = |world: &World| [1, 2].map(|id| format!("{:?}", world.object_state(ObjectId(id))));
    assert_eq!(states(&run.run().world()), states(simulation.world()));
    assert_eq!(run.run().robot(RobotId(1)).motion.pose(end), simulation.pose(RobotId(1)));
    assert_eq!(last.lock().0, Some(simulation.digest()), "what was recorded is the same");
}

/// A copy of a run has the faults that are still to come.
#[test]
fn a_copy_of_a_run_has_its_pending_faults() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "[world]\nfloor_mm = [4000, 4000]\nwall = [{ from_mm = [2000, 0], to_mm = [2000, 4000] }]\n\
                 [[robot]]\ntype = \"S4\"\nx_mm = 1500\ny_mm = 500\n\
                 [[fault]]\nkind = \"sensor_off\"\nsensor = \"PSD_FRONT\"\nat_s = 0.2\n";
    let path = folder.path().join("fault.scene.toml");
    std::fs::write(&path, scene).expect("a file");
    let ready = Scene::open(&path, Options::default()).and_then(Scene::load);
    let running = ready.and_then(|ready| ready.start(Observers::default()));
    let running = running.unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = running.scheduler.snapshot().expect("nobody has a program");
    assert!(simulation.range(RobotId(1), 0).is_some());
    simulation.advance_to(Time::from_millis(200));
    assert_eq!(simulation.range(RobotId(1), 0), None);
}

#[test]
fn a_run_with_programs_cannot_be_copied() {
    if !has_compiler() {
        return;
    }
    let refused = |scheduler: &mut Scheduler| {
        let error = scheduler.snapshot().expect_err("it has programs");
        assert_eq!(error, SnapshotError::Programs(vec![RobotId(1), RobotId(2)]));
        assert_eq!(error.to_string(), "a run with programs cannot be copied, those of r1, r2");
    };
    run_by(refused, Vec::new());
}
