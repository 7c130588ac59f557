//! Robots whose programs are code of this process; the programs make their calls as messages.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use parking_lot::Mutex;
use robios_sys::wire::Malformed;
use robios_sys::{Robios7Call, Status};
use sim_core::RobotId;
use sim_core::record::Outcome;
use sim_core::time::Time;
use sim_host::launch::settings::ProgramOption;
use sim_host::launch::{Observers, Options, Scene};
use sim_host::program::embedded::{Calls, EmbeddedCode, EmbeddedEnd, EmbeddedProgram};
use sim_host::record::report::Report;

const SCENE: &str = "[world]\nfloor_mm = [4000, 3000]\n[[robot]]\ntype = \"S4\"\nx_mm = 1000\ny_mm = 1500\n";

/// Body of a call with one number, from line 12 of a file.
fn request(call: Robios7Call, argument: i32) -> Vec<u8> {
    let mut body = Vec::new();
    for number in [7, call.index() as u32, 0, 0, 12, 5] {
        body.extend_from_slice(&number.to_le_bytes());
    }
    body.extend_from_slice(b"it.py");
    body.extend_from_slice(&argument.to_le_bytes());
    body
}

fn wait(calls: &dyn Calls, ms: i32) -> Status {
    calls.call(&request(Robios7Call::OSWait, ms), &mut Vec::new()).expect("a call")
}

type Main = dyn Fn(&Program, Arc<dyn Calls>) -> EmbeddedEnd + Send + Sync;

/// A program that is a closure.
struct Program {
    main: Box<Main>,
    /// Channel that `stop` notifies.
    stopped: (SyncSender<RobotId>, Mutex<Receiver<RobotId>>),
}

impl EmbeddedCode for Program {
    fn run(&self, robot: RobotId, arguments: &[String], calls: Arc<dyn Calls>) -> EmbeddedEnd {
        assert_eq!((robot, arguments), (RobotId(1), &["one".to_owned(), "two".to_owned()][..]));
        (self.main)(self, calls)
    }

    fn call_back(&self, _: RobotId, _: u64) -> Status {
        Status::STOP
    }

    fn stop(&self, robot: RobotId) {
        self.stopped.0.send(robot).expect("somebody listens");
    }
}

/// Runs a robot with this program.
fn run(main: impl Fn(&Program, Arc<dyn Calls>) -> EmbeddedEnd + Send + Sync + 'static, until: Time) -> Report {
    let (sender, receiver) = sync_channel(1);
    let code = Arc::new(Program { main: Box::new(main), stopped: (sender, Mutex::new(receiver)) });
    let options = Options {
        programs: vec![ProgramOption::parse("1=main()").expect("a program")],
        embedded: vec![EmbeddedProgram { reference: "main()".into(), name: "main".into(), code }],
        arguments: vec!["1:one two".into()],
        until: Some(until),
        timeout: 0.2,
        ..Options::default()
    };
    let scene = Scene::from_text("room.scene.toml", SCENE, options).expect("a scene");
    let mut running = scene.load().expect("programs").start(Observers::default()).expect("a run");
    running.scheduler.advance_to(Time::NEVER);
    running.finish().report
}

#[test]
fn calls_take_virtual_time_and_end_with_the_program() {
    let kept: Arc<Mutex<Option<Arc<dyn Calls>>>> = Arc::default();
    let keep = Arc::clone(&kept);
    let main = move |_: &Program, calls: Arc<dyn Calls>| {
        assert_eq!(wait(&*calls, 300), Status::OK);
        assert_eq!(calls.call(b"nonsense", &mut Vec::new()), Err(Malformed));
        let other = Arc::clone(&calls);
        let thread = std::thread::Builder::new().name("other".into()).spawn(move || wait(&*other, 100));
        let of_thread = thread.expect("a thread").join().expect("a status");
        assert_eq!(of_thread, Status::STOP, "another thread");
        *keep.lock() = Some(calls);
        EmbeddedEnd::Exited(3)
    };
    let report = run(main, Time::from_millis(5_000));
    let [robot] = &report.robots[..] else { panic!("one robot") };
    assert_eq!((robot.outcome, robot.exit_code, &*robot.program), (Outcome::Failed, Some(3), "main()"));
    assert!((0.3..0.35).contains(&robot.virtual_time_s), "{}", robot.virtual_time_s);
    let calls = kept.lock().take().expect("the calls");
    assert_eq!(wait(&*calls, 100), Status::STOP, "the program has ended");
}

#[test]
fn a_computing_program_is_stopped_with_its_location() {
    let main = |program: &Program, _: Arc<dyn Calls>| {
        let message = program.stopped.1.lock().recv_timeout(Duration::from_secs(60));
        assert_eq!(message, Ok(RobotId(1)));
        EmbeddedEnd::Overdue("it.py:7".into())
    };
    let report = run(main, Time::from_millis(5_000));
    assert_eq!(report.robots[0].outcome, Outcome::Timeout);
    let reason = report.robots[0].reason.as_deref().unwrap_or_default();
    assert!(reason.contains("without a RoBIOS call") && reason.contains("it.py:7"), "{reason}");
}

#[test]
fn a_call_stops_at_the_end_of_the_run() {
    let main = |_: &Program, calls: Arc<dyn Calls>| {
        while wait(&*calls, 100) == Status::OK {}
        EmbeddedEnd::Exited(0)
    };
    assert_eq!(run(main, Time::from_millis(1_000)).robots[0].outcome, Outcome::Running);
}
