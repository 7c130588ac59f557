//! Gates between the slots of a run: what they are told, what they may do, and that one which does nothing changes nothing.

use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::record::{Action, Digest, Event, Kind, KindSet, Outcome, Record};
use sim_core::time::Time;
use sim_host::cli::run::{Built, Company, RunArgs};
use sim_host::executive::conductor::End;
use sim_host::executive::gate::{Boundary, Gate, Intervention, Pass};
use sim_host::executive::run::Ended;
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

/// A gate made of a function.
struct By<F>(F);

impl<F: FnMut(&Boundary<'_>) -> Pass + Send> Gate for By<F> {
    fn wait(&mut self, boundary: &Boundary<'_>) -> Pass {
        (self.0)(boundary)
    }
}

/// Runs two robots that drive for a second and wait for a key.
fn run(gate: Option<Box<dyn Gate>>, sinks: Vec<Box<dyn Sink>>) -> Ended {
    let folder = tempfile::tempdir().expect("a folder");
    let sim = "world room.wld\nrobi bot.robi wait.c 500 500 0\nrobi bot.robi wait.c 500 1500 0\n";
    let robi = "diameter 200\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let room = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    for (name, text) in [("room.wld", room), ("bot.robi", robi), ("scene.sim", sim), ("wait.c", WAIT)] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let mut args = RunArgs::of_scene(&folder.path().join("scene.sim")).expect("a scene");
    (args.quiet, args.is_silent) = (true, true);
    let ready = Built::new(&args, |_| Ok(())).and_then(|built| built.load(&args));
    let ready = ready.unwrap_or_else(|error| panic!("{error:#}"));
    let company = Company { gate, sinks, is_quiet: true, ..Company::default() };
    ready.run(&args, company).unwrap_or_else(|error| panic!("{error:#}")).ended
}

fn with_gate(gate: impl FnMut(&Boundary<'_>) -> Pass + Send + 'static) -> Ended {
    run(Some(Box::new(By(gate))), Vec::new())
}

fn press(robot: u32, key: &str, answers: &Arc<Mutex<Vec<Result<(), String>>>>) -> Intervention {
    let answers = Arc::clone(answers);
    Intervention {
        action: Action::Press { robot, key: key.to_owned() },
        answer: Box::new(move |outcome| answers.lock().push(outcome.map_err(|why| why.to_string()))),
    }
}

fn has_compiler() -> bool {
    let there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: `cc` is not installed");
    }
    there
}

/// Whose calls are recorded.
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
fn a_gate_that_does_nothing_changes_nothing() {
    if !has_compiler() {
        return;
    }
    let plain = run(None, Vec::new());
    assert!(matches!(plain.end, End::Stuck), "{:?}", plain.end);
    let boundaries = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&boundaries);
    let callers = Arc::new(Mutex::new(Callers::default()));
    let gate = By(move |boundary: &Boundary<'_>| {
        assert_eq!(boundary.world.slot_start(), boundary.following);
        seen.lock().push((boundary.following, boundary.next));
        // Robots are suspended, so that their state can be looked at; who listens draws and changes nothing.
        boundary.run.listen_to(RobotId(2), true);
        assert_eq!(boundary.run.robot(RobotId(1)).id, RobotId(1));
        Pass::Begin
    });
    let watched = run(Some(Box::new(gate)), vec![Box::new(Arc::clone(&callers))]);
    assert_eq!((watched.digest, watched.time), (plain.digest, plain.time));
    assert!(matches!(watched.end, End::Stuck), "{:?}", watched.end);
    assert_eq!(callers.lock().0, BTreeSet::from([RobotId(2)]), "the other one's calls nobody wants");
    let boundaries = boundaries.lock();
    assert_eq!(boundaries.first(), Some(&(Time::ZERO, Some(Time::ZERO))), "it is asked before the first slot");
    assert_eq!(boundaries.last(), Some(&(plain.time, None)), "and when nothing happens any more");
    assert!(boundaries.is_sorted() && boundaries.len() > 20, "{boundaries:?}");
}

#[test]
fn a_run_that_waits_for_somebody_goes_on_when_he_acts() {
    if !has_compiler() {
        return;
    }
    let answers = Arc::default();
    let told = Arc::clone(&answers);
    let mut is_first = true;
    let ended = with_gate(move |boundary| {
        if boundary.next.is_some() || !std::mem::take(&mut is_first) {
            return Pass::Begin;
        }
        // Within a slot: it happens at its start.
        let at = Time(7_012_345);
        let actions = ["KEY1", "KEY9", "KEY1"].into_iter().zip([1, 1, 2]);
        Pass::Act { at, actions: actions.map(|(key, robot)| press(robot, key, &told)).collect() }
    });
    assert!(matches!(ended.end, End::Finished), "{:?}", ended.end);
    for robot in &ended.robots {
        assert_eq!(robot.outcome, Outcome::Finished);
        assert!((7.0..7.05).contains(&robot.virtual_time.seconds()), "{}", robot.virtual_time);
    }
    let answers = answers.lock();
    assert_eq!((answers.len(), &answers[0], &answers[2]), (3, &Ok(()), &Ok(())));
    assert!(answers[1].as_ref().is_err_and(|why| why.starts_with("`KEY9` is no key")), "{answers:?}");
}

#[test]
fn what_is_refused_lets_no_time_pass() {
    if !has_compiler() {
        return;
    }
    let plain = run(None, Vec::new());
    let answers = Arc::default();
    let told = Arc::clone(&answers);
    let mut tries = 0;
    let ended = with_gate(move |boundary| {
        if boundary.next.is_some() || tries == 3 {
            return Pass::Begin;
        }
        tries += 1;
        let at = if tries == 3 { boundary.until } else { Time::from_millis(30_000) };
        Pass::Act { at, actions: vec![press(3, "KEY1", &told)] }
    });
    assert_eq!((ended.digest, ended.time), (plain.digest, plain.time));
    let over = Err("the run is over by then".to_owned());
    let nobody = Err("there is no robot 3".to_owned());
    assert_eq!(*answers.lock(), [nobody.clone(), nobody, over]);
}

#[test]
fn an_action_never_comes_after_what_is_due() {
    if !has_compiler() {
        return;
    }
    let answers = Arc::default();
    let told = Arc::clone(&answers);
    let mut is_first = true;
    let ended = with_gate(move |_| {
        let at = Time::from_millis(500_000);
        if std::mem::take(&mut is_first) {
            Pass::Act { at, actions: vec![press(1, "KEY1", &told), press(2, "KEY1", &told)] }
        } else {
            Pass::Begin
        }
    });
    // Pressed before the first slot, and kept until the drive is over.
    assert!(matches!(ended.end, End::Finished), "{:?}", ended.end);
    assert!(ended.time < Time::from_millis(1_200), "{}", ended.time);
    assert_eq!(*answers.lock(), [Ok(()), Ok(())]);
}

#[test]
fn a_gate_ends_the_run_wherever_it_stands() {
    if !has_compiler() {
        return;
    }
    for end in [Time::ZERO, Time::from_millis(500)] {
        let ended = with_gate(
            move |boundary| {
                if boundary.following >= end { Pass::End(End::Interrupted) } else { Pass::Begin }
            },
        );
        assert!(matches!(ended.end, End::Interrupted), "{:?}", ended.end);
        assert_eq!(ended.time, end);
        assert!(ended.robots.iter().all(|robot| robot.outcome == Outcome::Interrupted));
    }
}
