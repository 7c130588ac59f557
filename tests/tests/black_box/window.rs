//! The window of the real binary: messages to pages, effects of page requests, and watching without side effects.
#![allow(clippy::disallowed_methods, reason = "compared within tolerances")]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use sim_view::protocol::{
    Action, Build, Command, Layer, LayerContent, Message, PROTOCOL, Recording, Request, RunState, Scene, Seed,
    Snapshot, Standing, Welcome,
};
use tests::{Scratch, number, write_package, write_scene};
use tungstenite::WebSocket;

/// Time limit of every step, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(300);

/// Drives and turns forever; shows a number on its display.
const ROVER: &str = "#include \"eyebot.h\"\nint main(void) {\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  PSDHandle psd = \
                     PSDInit(PSD_FRONT);\n  PSDStart(psd, TRUE);\n  for (int i = 0;; i++) {\n    VWDriveStraight(vw, 0.2, \
                     0.3);\n    VWDriveWait(vw);\n    VWDriveTurn(vw, 1.0, 1.5);\n    VWDriveWait(vw);\n    \
                     LCDPrintf(\"%d %d\\n\", i, PSDGet(psd));\n  }\n}\n";

/// Waits for a key.
const WAITER: &str = "#include \"eyebot.h\"\nint main(void) {\n  LCDMenu(\"GO\", \"\", \"\", \"END\");\n  KEYWait(KEY1);\n  \
                      LCDPrintf(\"pressed\\n\");\n  return 0;\n}\n";

/// Does not move, and shows a map of two cells ten times a second.
const MAPPER: &str = "#include \"eyebot.h\"\n#include \"eyesim.h\"\nint main(void) {\n  unsigned char cells[2] = {0, EYESIM_UNKNOWN};\n  \
                      for (;;) {\n    cells[0] = (cells[0] + 1) % 100;\n    eyesim_show_grid(\"map\", EYESIM_ODOMETRY, 0.5, 0, 0.1, 2, 1, \
                      cells);\n    OSWait(10);\n  }\n}\n";

/// A process that serves pages until it is dropped.
struct Served {
    child: Child,
    /// Output before the process serves pages.
    lines: Vec<String>,
    port: u16,
}

impl Served {
    /// Starts `eyesim` with these arguments, `--no-open` and a free port.
    fn start(scratch: &Scratch, args: &[&str]) -> Self {
        let mut command = scratch.command(args);
        command.args(["--no-open", "--port", "0"]).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("eyesim starts");
        let mut output = BufReader::new(child.stdout.take().expect("its output"));
        let mut lines = Vec::new();
        let count = if args.contains(&"--listen") { 2 } else { 1 };
        for _ in 0..count {
            let mut line = String::new();
            output.read_line(&mut line).expect("it says where it serves");
            lines.push(line.trim_end().to_owned());
        }
        // The output of programs is discarded, so that it cannot fill the pipe.
        let drain = move || std::io::copy(&mut output, &mut std::io::sink());
        std::thread::Builder::new().name("drain".into()).spawn(drain).expect("a thread");
        let (_, rest) = lines[0].split_once("127.0.0.1:").unwrap_or_else(|| panic!("an address: {lines:?}"));
        let port = rest.split('/').next().expect("a port").parse().expect("a port");
        Self { child, lines, port }
    }

    fn page(&self) -> Page {
        Page::open(self.port, None)
    }

    /// Content of a downloaded file.
    fn get(&self, path: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        let request = format!("GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n", self.port);
        stream.write_all(request.as_bytes()).expect("a request");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").expect("a head") + 4;
        let head = String::from_utf8_lossy(&answer[..end]).into_owned();
        assert!(head.starts_with("HTTP/1.1 200"), "{head}{}", String::from_utf8_lossy(&answer[end..]));
        answer.split_off(end)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page and the messages that it has received.
struct Page {
    socket: WebSocket<TcpStream>,
    number: u32,
    welcome: Option<Welcome>,
    scene: Option<Scene>,
    snapshot: Option<Snapshot>,
    events: Vec<sim_view::protocol::Event>,
    lcd_text: Vec<String>,
    layers: Vec<Layer>,
    builds: Vec<Build>,
}

impl Page {
    fn open(port: u16, token: Option<&str>) -> Self {
        let stream = TcpStream::connect(("127.0.0.1", port)).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a socket");
        let request = tungstenite::http::Request::builder()
            .uri(format!("ws://127.0.0.1:{port}/ws"))
            .header("Host", format!("127.0.0.1:{port}"))
            .header("Origin", format!("http://127.0.0.1:{port}"))
            .header("Connection", "Upgrade")
            .header("Upgrade", "websocket")
            .header("Sec-WebSocket-Version", "13")
            .header("Sec-WebSocket-Key", tungstenite::handshake::client::generate_key())
            .body(())
            .expect("a request");
        let (socket, _) = tungstenite::client(request, stream).expect("a page is let in");
        let mut page = Self {
            socket,
            number: 0,
            welcome: None,
            scene: None,
            snapshot: None,
            events: Vec::new(),
            lcd_text: Vec::new(),
            layers: Vec::new(),
            builds: Vec::new(),
        };
        page.send(&Request::Hello { protocol: PROTOCOL, token: token.map(str::to_owned) });
        page
    }

    fn send(&mut self, request: &Request) {
        let text = serde_json::to_string(request).expect("JSON");
        self.socket.send(tungstenite::Message::text(text)).expect("a page may speak");
    }

    /// Receives the next message and applies it; returns the message if it is an answer.
    fn take(&mut self) -> Option<sim_view::protocol::Answer> {
        let message = loop {
            match self.socket.read().expect("a message comes in time") {
                tungstenite::Message::Text(text) => break text,
                tungstenite::Message::Close(frame) => panic!("the server has hung up: {frame:?}"),
                _ => {}
            }
        };
        match serde_json::from_str(&message).expect("a message of the protocol") {
            Message::Welcome(welcome) => self.welcome = Some(welcome),
            Message::Scene(scene) => self.scene = Some(*scene),
            Message::Snapshot(snapshot) => self.snapshot = Some(snapshot),
            Message::Detail(detail) => self.lcd_text = detail.lcd_text,
            Message::Layer(layer) => self.layers.push(layer),
            Message::Events(mut events) => self.events.append(&mut events.events),
            Message::Build(build) => self.builds.push(build),
            Message::Answer(answer) => return Some(answer),
        }
        None
    }

    /// Receives messages until a condition is true.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            assert!(start.elapsed() < PATIENCE, "{what} does not come: {:?}", self.snapshot);
            self.take();
        }
    }

    /// Sends a command; returns the error message if the command is rejected.
    fn ask(&mut self, command: Command) -> Option<String> {
        self.number += 1;
        let number = self.number;
        self.send(&Request::Act { number, command });
        loop {
            if let Some(answer) = self.take()
                && answer.number == number
            {
                return answer.refused;
            }
        }
    }

    fn act(&mut self, action: Action) -> Option<String> {
        self.ask(Command::Act { action })
    }

    fn t_s(&self) -> f64 {
        self.snapshot.as_ref().map_or(-1.0, |snapshot| snapshot.t_s)
    }

    fn state(&self) -> Option<&RunState> {
        self.snapshot.as_ref().map(|snapshot| &snapshot.state)
    }

    fn digest(&self) -> Option<String> {
        match self.state()? {
            RunState::Ended { digest, .. } => Some(digest.clone()),
            _ => None,
        }
    }

    fn seed(&self) -> String {
        self.scene.as_ref().expect("a scene").seed.clone()
    }

    fn run(&self) -> u32 {
        self.snapshot.as_ref().map_or(0, |snapshot| snapshot.run)
    }
}

fn scene_of(programs: &[(&str, &str)]) -> Scratch {
    let scratch = Scratch::new();
    for (name, text) in programs {
        scratch.write(name, text);
    }
    write_scene(&scratch, &programs.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    scratch
}

#[test]
fn a_page_receives_the_scene_and_then_snapshots() {
    let scratch = scene_of(&[("rover.c", ROVER), ("waiter.c", WAITER)]);
    let served = Served::start(&scratch, &["view", "scene.sim"]);
    let mut page = served.page();
    page.until("a moving robot", |page| {
        let robots = page.snapshot.iter().flat_map(|snapshot| &snapshot.robots);
        robots.flat_map(|robot| &robot.motion).any(|piece| piece.v_m_per_s > 0.2)
    });
    assert!(page.welcome.as_ref().is_some_and(|welcome| welcome.may_act && welcome.title == "scene"));
    let scene = page.scene.clone().expect("a scene");
    assert_eq!((scene.run, scene.robots.len(), scene.slot_s), (1, 2, 0.05));
    assert!(scene.parts.len() > 4 && !scene.meshes.is_empty() && scene.ground.is_some());
    assert_eq!(scene.robots[0].sensors[0].name, "PSD_FRONT");
    let before = page.t_s();
    page.until("a later snapshot", |page| page.t_s() > before + 0.2);
    let snapshot = page.snapshot.clone().expect("a snapshot");
    assert_eq!((snapshot.robots.len(), snapshot.beams.len(), snapshot.speed), (2, 2, Some(1.0)));
    assert_eq!(snapshot.robots[1].standing, Standing::Waiting);
    assert!(snapshot.robots[1].why.starts_with("waits for KEY1"), "{}", snapshot.robots[1].why);
    assert!(page.events.iter().any(|event| event.kind == "program_started"));
    page.send(&Request::Look { robot: Some(2), camera: false, calls: false });
    page.until("a display", |page| page.lcd_text.iter().any(|line| line.contains("GO")));
}

#[test]
fn a_run_pauses_steps_and_changes_its_speed() {
    let scratch = scene_of(&[("rover.c", ROVER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--paused"]);
    let mut page = served.page();
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    assert_eq!(page.t_s(), 0.0);
    for slot in 1..=3 {
        assert_eq!(page.ask(Command::Step {}), None);
        page.until("the slot", |page| (page.t_s() - 0.05 * f64::from(slot)).abs() < 1e-9);
        assert_eq!(page.state(), Some(&RunState::Paused));
    }
    assert_eq!(page.ask(Command::Speed { factor: Some(0.5) }), None);
    page.until("the speed", |page| page.snapshot.as_ref().is_some_and(|snapshot| snapshot.speed == Some(0.5)));
    assert!(page.ask(Command::Speed { factor: Some(0.0) }).is_some_and(|why| why.contains("from 0.001 to 10000")));
    assert_eq!(page.ask(Command::Run {}), None);
    page.until("the run", |page| page.state() == Some(&RunState::Running) && page.t_s() > 0.3);
    assert_eq!(page.ask(Command::Speed { factor: None }), None);
    page.until("full speed", |page| page.t_s() > 20.0);
    assert_eq!(page.ask(Command::Pause {}), None);
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
}

#[test]
fn a_run_skips_to_a_time_and_is_shown_meanwhile() {
    let scratch = scene_of(&[("rover.c", ROVER), ("waiter.c", WAITER)]);
    write_scene(&scratch, &["waiter.c"]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--at", "5.01"]);
    let mut page = served.page();
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    assert_eq!(page.t_s(), 5.05, "an idle run also gets there");
    drop(served);
    write_scene(&scratch, &["rover.c"]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--at", "1e8"]);
    let mut page = served.page();
    page.until("the run", |page| page.state() == Some(&RunState::Running) && page.t_s() > 1.0);
    assert_eq!(page.act(Action::Press { robot: 1, key: "KEY1".into() }), None);
    assert_eq!(page.ask(Command::Pause {}), None);
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    assert!(page.t_s() < 1e8);
}

#[test]
fn a_key_of_the_page_reaches_the_program() {
    let scratch = scene_of(&[("waiter.c", WAITER)]);
    let served = Served::start(&scratch, &["view", "scene.sim"]);
    let mut page = served.page();
    page.until("the wait", |page| page.state() == Some(&RunState::Idle));
    let refused = page.act(Action::Press { robot: 7, key: "KEY1".into() });
    assert!(refused.is_some_and(|why| why.contains("no robot 7")));
    assert_eq!(page.act(Action::Press { robot: 1, key: "KEY1".into() }), None);
    page.until("the end", |page| page.digest().is_some());
    let robot = &page.snapshot.as_ref().expect("a snapshot").robots[0];
    assert_eq!(robot.standing, Standing::Finished);
    for kind in ["intervention", "key", "program_ended"] {
        page.until(kind, |page| page.events.iter().any(|event| event.kind == kind));
    }
    page.send(&Request::Look { robot: Some(1), camera: false, calls: false });
    page.until("the display after the end", |page| page.lcd_text.iter().any(|line| line.contains("pressed")));
    assert!(page.act(Action::End {}).is_some_and(|why| why.contains("over")));
}

#[test]
fn a_line_typed_in_the_page_reaches_the_program_and_is_repeated() {
    const READER: &str = "#include \"eyebot.h\"\nint main(void) {\n  char name[20]; int mm, n = 0;\n  scanf(\"%19s\", name);\n  \
                          scanf(\"%d\", &mm);\n  while (getchar() != 'q') n++;\n  VWStraight(mm, 100);\n  VWWait();\n  \
                          LCDPrintf(\"%s %d %d\\n\", name, mm, n);\n  return 0;\n}\n";
    let scratch = scene_of(&[("reader.c", READER), ("waiter.c", WAITER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--paused"]);
    let mut page = served.page();
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    let line = |robot, line: &str| Action::Type { robot, line: line.to_owned() };
    assert!(page.act(line(7, "x")).is_some_and(|why| why.contains("no robot 7")));
    assert_eq!(page.act(line(1, "Ada")), None);
    assert_eq!(page.ask(Command::Speed { factor: None }), None);
    assert_eq!(page.ask(Command::Run {}), None);
    page.until("the wait", |page| {
        let robots = page.snapshot.as_ref().map(|snapshot| &snapshot.robots);
        robots.is_some_and(|robots| robots[0].why.starts_with("waits for a line typed"))
    });
    assert_eq!(page.act(line(1, "100 ü")), None);
    assert_eq!(page.act(line(1, "q")), None);
    page.until("the end", |page| {
        page.snapshot.as_ref().is_some_and(|snapshot| snapshot.robots[0].standing == Standing::Finished)
    });
    page.send(&Request::Look { robot: Some(1), camera: false, calls: false });
    // The program also reads the rest of its line: a blank, two bytes and the line's end.
    page.until("what was read", |page| page.lcd_text.iter().any(|line| line.contains("Ada 100 4")));
    assert!(page.act(line(1, "x")).is_some_and(|why| why.contains("runs no program")));
    assert!(page.events.iter().any(|event| event.text == "the user types `Ada` to r1"));
    assert_eq!(page.act(Action::End {}), None);
    page.until("the end of the run", |page| page.digest().is_some());
    scratch.write("t.jsonl", &String::from_utf8(served.get("/files/trace.jsonl")).expect("text"));
    let verified = scratch.eyesim(&["replay", "--verify", "t.jsonl"]);
    assert_eq!(verified.code, Some(0), "{verified:#?}");
    assert!(verified.stdout.contains("same digest"), "{verified:#?}");
}

#[test]
fn runs_start_again_with_any_seed() {
    start_again(&[]);
}

#[test]
fn runs_in_processes_start_again_with_any_seed() {
    start_again(&["--exec", "process"]);
}

fn start_again(more: &[&str]) {
    let scratch = scene_of(&[("rover.c", ROVER)]);
    let served = Served::start(&scratch, &[&["view", "scene.sim", "--seed", "5"], more].concat());
    let mut page = served.page();
    page.until("a run", |page| page.t_s() > 0.1);
    assert_eq!(page.seed(), "5");
    for (run, seed, expected) in [
        (2, Seed::Same, Some("5")),
        (3, Seed::Number("18446744073709551615".into()), Some("18446744073709551615")),
        (4, Seed::New, None),
    ] {
        assert_eq!(page.ask(Command::Restart { seed }), None);
        page.until("the next run", |page| page.run() == run && page.t_s() > 0.1);
        match expected {
            Some(expected) => assert_eq!(page.seed(), expected),
            None => assert_ne!(page.seed(), "5"),
        }
    }
    assert!(
        page.ask(Command::Restart { seed: Seed::Number("five".into()) }).is_some_and(|why| why.contains("not a seed"))
    );
    assert_eq!(page.run(), 4);
}

#[test]
fn watched_by_three_pages_a_run_is_the_same() {
    let scratch = scene_of(&[("rover.c", ROVER), ("rover2.c", ROVER)]);
    let args = ["--until", "60", "--seed", "3", "--noise", "real"];
    let report = scratch.report("scene.sim", &args, 0);
    let served = Served::start(&scratch, &[&["view", "scene.sim", "--paused", "--speed", "max"][..], &args].concat());
    let (mut one, mut two) = (served.page(), served.page());
    // This page never receives its messages.
    let mut stalled = served.page();
    stalled.send(&Request::Look { robot: Some(1), camera: true, calls: true });
    one.send(&Request::Look { robot: Some(1), camera: false, calls: true });
    two.send(&Request::Look { robot: Some(2), camera: false, calls: false });
    one.until("a scene", |page| page.scene.is_some() && page.snapshot.is_some());
    assert_eq!(one.ask(Command::Run {}), None);
    one.until("the end", |page| page.digest().is_some());
    two.until("the end", |page| page.digest().is_some());
    assert_eq!(one.digest().as_deref(), report["digest"].as_str());
    assert_eq!(one.digest(), two.digest());
}

#[test]
fn a_run_with_thirty_interventions_is_run_again_with_the_same_digest() {
    let scratch = scene_of(&[("rover.c", ROVER), ("waiter.c", WAITER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--paused", "--noise", "mild"]);
    let mut page = served.page();
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    for number in 0..30 {
        let x_m = 1.0 + 0.05 * f64::from(number);
        let action = match number % 5 {
            0 => Action::PlaceRobot { robot: 1, x_m, y_m: 2.0, phi_rad: x_m },
            1 => Action::SetNoise { robot: None, parameter: "psd.sigma_mm".into(), value: f64::from(number) },
            2 => Action::SwitchSensor { robot: 1, sensor: "PSD_FRONT".into(), on: number % 2 == 0 },
            3 => Action::Press { robot: 2, key: "KEY4".into() },
            _ => Action::PlaceRobot { robot: 2, x_m, y_m: 3.0, phi_rad: 0.0 },
        };
        assert_eq!(page.act(action), None, "intervention {number}");
        let before = page.t_s();
        assert_eq!(page.ask(Command::Step {}), None);
        page.until("a slot", |page| page.t_s() > before);
    }
    let scene = String::from_utf8(served.get("/files/scene.toml")).expect("text");
    assert!(scene.contains("rover.c"), "{scene}");
    scratch.write("now.scene.toml", &scene);
    let checked = scratch.eyesim(&["check", "now.scene.toml"]);
    assert_eq!(checked.code, Some(0), "{checked:#?}\n{scene}");
    assert_eq!(page.act(Action::RemoveRobot { robot: 2 }), None);
    page.until("one robot", |page| page.scene.as_ref().is_some_and(|scene| scene.robots.len() == 1));
    assert_eq!(page.act(Action::End {}), None);
    page.until("the end", |page| page.digest().is_some());
    let trace = String::from_utf8(served.get("/files/trace.jsonl")).expect("text");
    assert_eq!(trace.lines().filter(|line| line.contains("\"event\":\"intervention\"")).count(), 32);
    scratch.write("trace.jsonl", &trace);
    let verified = scratch.eyesim(&["replay", "trace.jsonl", "--verify"]);
    assert_eq!(verified.code, Some(0), "{verified:#?}");
    assert!(verified.stdout.contains(&page.digest().expect("a digest")), "{verified:#?}");
    let recording: Recording = serde_json::from_slice(&served.get("/files/run.recording.json")).expect("a recording");
    assert_eq!((recording.robots.len(), Some(recording.digest)), (2, page.digest()));
    assert!(recording.robots[1].track.until_s.is_some(), "it was there before it was removed");
}

#[test]
fn saving_a_program_restarts_the_run_if_it_compiles() {
    let scratch = scene_of(&[("rover.c", ROVER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--watch", "--seed", "9"]);
    let mut page = served.page();
    page.until("a run", |page| page.t_s() > 0.1);
    save(&scratch, "rover.c", "#include \"eyebot.h\"\nint main(void) { retrun 0; }\n");
    page.until("the compiler's word", |page| page.builds.iter().any(|build| matches!(build, Build::Failed { .. })));
    let Some(Build::Failed { output }) = page.builds.last() else { panic!("{:?}", page.builds) };
    assert!(output.contains("retrun"), "{output}");
    let before = page.t_s();
    page.until("the old run", |page| page.t_s() > before + 0.1);
    assert_eq!(page.run(), 1);
    save(&scratch, "rover.c", WAITER);
    page.until("the new run", |page| page.run() == 2 && page.state() == Some(&RunState::Idle));
    assert_eq!(page.seed(), "9");
    // The time until a change becomes visible is only printed, not tested.
    save(&scratch, "rover.c", &format!("{ROVER}// changed\n"));
    let saved = std::time::Instant::now();
    page.until("the change", |page| page.run() == 3 && page.t_s() > 0.0);
    println!("a change of a C file drives in the window after {:.2} s", saved.elapsed().as_secs_f64());
    // A program of a scene that has never run is watched, too.
    let failures = |page: &Page| page.builds.iter().filter(|build| matches!(build, Build::Failed { .. })).count();
    let before = failures(&page);
    scratch.write("other.c", "int main(void) { retrun 0; }\n");
    save(&scratch, "scene.sim", &scratch.read("scene.sim").replace("rover.c", "other.c"));
    page.until("the compiler's word", |page| failures(page) > before);
    save(&scratch, "other.c", WAITER);
    page.until("the run of the other program", |page| page.run() == 4 && page.state() == Some(&RunState::Idle));
}

#[test]
fn saving_a_source_of_a_rust_package_restarts_the_run() {
    let scratch = Scratch::new();
    write_scene(&scratch, &["watched"]);
    write_package(&scratch, "watched", "robios_api::program!(main);\nfn main(_: &robios_api::prelude::Robot) {}\n");
    let served = Served::start(&scratch, &["view", "scene.sim", "--watch"]);
    let mut page = served.page();
    let failures = |page: &Page| page.builds.iter().filter(|build| matches!(build, Build::Failed { .. })).count();
    page.until("a run", |page| page.run() == 1);
    // A module whose file comes later.
    let program = scratch.read("watched/src/lib.rs");
    save(&scratch, "watched/src/lib.rs", &format!("mod part;\n{program}"));
    page.until("the compiler's word", |page| failures(page) == 1);
    save(&scratch, "watched/src/part.rs", "broken\n");
    page.until("the compiler's next word", |page| failures(page) == 2);
    save(&scratch, "watched/src/part.rs", "// whole\n");
    page.until("the new run", |page| page.run() == 2);
}

/// Replaces a file in one step, as editors do: the window sees the old file or the new file.
fn save(scratch: &Scratch, name: &str, text: &str) {
    let new = scratch.write("saved", text);
    std::fs::rename(new, scratch.path().join(name)).expect("one file in place of the other");
}

#[test]
fn a_page_that_connects_late_gets_the_trails() {
    let scratch = scene_of(&[("rover.c", ROVER)]);
    let served = Served::start(&scratch, &["view", "scene.sim"]);
    let mut page = served.page();
    // Events before the first page are kept.
    page.until("some way", |page| page.t_s() > 1.0 && !page.events.is_empty());
    assert_eq!(page.events[0].number, 1, "{:?}", page.events);
    let trails: serde_json::Value = serde_json::from_slice(&served.get("/files/trails.json")).expect("trails");
    assert_eq!(trails["run"], 1);
    let line = trails["trails"][0][0].as_array().expect("a line");
    let robots = page.scene.as_ref().expect("a scene").robots.len();
    assert_eq!(trails["trails"].as_array().map(Vec::len), Some(robots));
    assert!(line.len() > 1 && line[0] != line[line.len() - 1], "{trails}");
    assert!(line.iter().all(|point| point.as_array().is_some_and(|point| point.len() == 2)), "{trails}");
}

#[test]
fn a_page_that_comes_after_the_end_gets_the_colour_display() {
    let program = "#include \"eyebot.h\"\nint main(void) {\n  VWStraight(10, 100);\n  VWWait();\n  return 0;\n}\n";
    let scratch = scene_of(&[("seven.c", program)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--speed", "max", "--trace", "t.jsonl"]);
    let start = Instant::now();
    let trace = scratch.path().join("t.jsonl");
    let is_over = || std::fs::read_to_string(&trace).is_ok_and(|text| text.contains("\"event\":\"end\""));
    while !is_over() {
        assert!(start.elapsed() < PATIENCE, "the run never ends");
        std::thread::sleep(Duration::from_millis(20));
    }
    let mut page = served.page();
    page.until("the end", |page| matches!(page.state(), Some(RunState::Ended { .. })));
    assert!(page.scene.as_ref().expect("a scene").robots[0].lcd.has_colours);
}

#[test]
fn the_reason_for_the_end_gives_the_line_of_a_crash() {
    let program = "#include \"eyebot.h\"\nint main(void) {\n  OSWait(10);\n  *(volatile int *)0 = 1;\n  return 0;\n}\n";
    let scratch = scene_of(&[("crash.c", program), ("rover.c", ROVER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--speed", "max", "--exec", "thread"]);
    let mut page = served.page();
    page.until("the end", |page| page.digest().is_some());
    let Some(RunState::Ended { why, .. }) = page.state() else { panic!("{:?}", page.state()) };
    assert!(why.starts_with("a program failed; r1 (`crash.c`): "), "{why}");
    assert!(why.contains("crash.c:4"), "{why}");
}

#[test]
fn a_page_that_connects_late_gets_the_last_layer() {
    let scratch = scene_of(&[("mapper.c", MAPPER)]);
    let served = Served::start(&scratch, &["view", "scene.sim"]);
    let look = |page: &mut Page| page.send(&Request::Look { robot: Some(1), camera: false, calls: false });
    let mut page = served.page();
    look(&mut page);
    page.until("a map that changes", |page| page.layers.len() > 2);
    assert!(page.layers.windows(2).all(|two| two[0].t_s < two[1].t_s && two[0].content != two[1].content));
    assert_eq!(page.ask(Command::Pause {}), None);
    page.until("the pause", |page| page.state() == Some(&RunState::Paused));
    let mut late = served.page();
    look(&mut late);
    late.until("a map", |page| !page.layers.is_empty());
    page.until("the last map", |page| page.layers.last() == late.layers.first());
    let last = page.layers.last().expect("a map");
    assert!(last.t_s > page.t_s() - 0.15, "{} s at {} s", last.t_s, page.t_s());
    let LayerContent::Grid { corner_m, cell_m, columns, rows, .. } = last.content else { panic!("{last:?}") };
    assert_eq!((last.name.as_str(), corner_m, cell_m, columns, rows), ("map", [0.5, 0.0], 0.1, 2, 1));
    let start = page.snapshot.as_ref().expect("a snapshot").robots[0].motion[0].from;
    let off = [last.frame.x_m - start.x_m, last.frame.y_m - start.y_m, last.frame.phi_rad - start.phi_rad];
    assert!(off.iter().all(|off| off.abs() < 0.1), "{last:?} of a robot that rests at {start:?}");
}

#[test]
fn a_class_watches_and_the_teacher_acts() {
    let scratch = scene_of(&[("waiter.c", WAITER)]);
    let served = Served::start(&scratch, &["view", "scene.sim", "--listen", "127.0.0.1"]);
    let (_, token) = served.lines[1].split_once("#token=").expect("the teacher's token");
    assert!(served.lines[1].starts_with("teacher: ") && token.len() >= 32, "{:?}", served.lines);
    assert!(served.lines[0].starts_with("class: ") && !served.lines[0].contains("token"), "{:?}", served.lines);
    let mut pupil = served.page();
    pupil.until("a welcome", |page| page.welcome.is_some());
    assert!(pupil.welcome.as_ref().is_some_and(|welcome| !welcome.may_act));
    assert!(pupil.act(Action::Press { robot: 1, key: "KEY1".into() }).is_some());
    let mut teacher = Page::open(served.port, Some(token));
    assert_eq!(teacher.act(Action::Press { robot: 1, key: "KEY1".into() }), None);
    pupil.until("the end", |page| page.digest().is_some());
}

#[test]
fn a_recorded_run_is_served() {
    let scratch = scene_of(&[("waiter.c", WAITER), ("rover.c", ROVER)]);
    let report = scratch.report("scene.sim", &["--until", "20", "--trace", "t.jsonl"], 0);
    let served = Served::start(&scratch, &["replay", "t.jsonl"]);
    let recording: Recording = serde_json::from_slice(&served.get("/recording.json")).expect("a recording");
    assert_eq!((recording.duration_s, recording.remarks.len()), (20.0, 0), "{:?}", recording.remarks);
    assert_eq!(report["digest"], *recording.digest);
    let track = &recording.robots[1].track;
    assert!(track.t_s.len() > 10 && track.t_s.len() < 400, "{} points", track.t_s.len());
    assert!(track.t_s.is_sorted(), "{:?}", track.t_s);
    for (last, path) in [(track.x_m.last(), "pose.x_m"), (track.y_m.last(), "pose.y_m")] {
        let truth = number(&report["robots"][1], path);
        assert!(last.is_some_and(|last| (last - truth).abs() < 2e-3), "within 2 mm: {last:?}, {truth}");
    }
    let display = recording.robots[0].lcd.last().expect("a display");
    assert!(display.lines.iter().any(|line| line.contains("GO")), "{display:?}");
    assert_eq!(recording.robots[0].standings[0].standing, Standing::Running);
    drop(served);

    // The existing part of a truncated trace is shown, and the error is reported.
    let whole = scratch.read("t.jsonl");
    scratch.write("cut.jsonl", &whole[..whole.len() / 2]);
    scratch.write("scene.sim", &(std::fs::read_to_string(scratch.path().join("scene.sim")).expect("a scene") + "\n"));
    let served = Served::start(&scratch, &["replay", "cut.jsonl"]);
    let recording: Recording = serde_json::from_slice(&served.get("/recording.json")).expect("a recording");
    assert!(recording.digest.is_empty() && recording.duration_s < 20.0);
    let remarks = recording.remarks.join("; ");
    assert!(remarks.contains("cut off") && remarks.contains("`scene.sim` has changed"), "{remarks}");
}

#[test]
fn files_that_are_not_traces_are_refused() {
    let scratch = Scratch::new();
    for (name, text, words) in [
        ("empty.jsonl", "", "it is empty"),
        ("garbage.jsonl", "\u{1}\u{2}\n{}\n", "not JSON"),
        ("other.jsonl", "{}\n", "header"),
    ] {
        scratch.write(name, text);
        let ran = scratch.eyesim(&["replay", name, "--no-open"]);
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stderr.contains(name) && ran.stderr.contains(words), "{ran:#?}");
    }
    let ran = scratch.eyesim(&["replay", "none.jsonl", "--no-open"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("none.jsonl"), "{ran:#?}");
}

#[test]
fn an_occupied_port_and_a_missing_program_are_reported() {
    let scratch = scene_of(&[("rover.c", ROVER)]);
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port().to_string();
    let ran = scratch.eyesim(&["view", "scene.sim", "--no-open", "--port", &port]);
    assert!(ran.code == Some(2) && ran.stderr.contains(&port) && ran.stderr.contains("taken"), "{ran:#?}");
    std::fs::remove_file(scratch.path().join("rover.c")).expect("a file");
    let ran = scratch.eyesim(&["view", "scene.sim", "--no-open", "--port", "0"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("rover.c"), "{ran:#?}");
}

#[test]
fn a_scene_without_robots_is_shown_too() {
    let scratch = Scratch::new();
    write_scene(&scratch, &[]);
    let served = Served::start(&scratch, &["view", "scene.sim"]);
    let mut page = served.page();
    page.until("the empty room", |page| page.state() == Some(&RunState::Idle));
    let scene = page.scene.as_ref().expect("a scene");
    assert!(scene.robots.is_empty() && scene.parts.len() == 4, "{} parts", scene.parts.len());
    let before = page.t_s();
    page.until("time", |page| page.t_s() > before + 0.1);
}

/// Product of two quaternions (x, y, z, w).
fn turned([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// Heights of the links of `robot` above the origin of its frame at these joint angles, computed as a page does.
fn link_heights(robot: &sim_view::protocol::Robot, joints_rad: &[f64]) -> Vec<f64> {
    let mut frames: Vec<([f64; 3], [f64; 4])> = Vec::new();
    for link in &robot.links {
        let (at, frame) = link.parent.map_or(([0.0; 3], [0.0, 0.0, 0.0, 1.0]), |parent| frames[parent as usize]);
        let angle = link.joint.map_or(0.0, |joint| joints_rad[joint as usize]);
        let ([x, y, z], half) = (link.origin.position_m, 0.5 * angle);
        let [vx, vy, vz, _] = turned(turned(frame, [x, y, z, 0.0]), [-frame[0], -frame[1], -frame[2], frame[3]]);
        let [ax, ay, az] = link.axis.map(|part| part * half.sin());
        let turn = turned(turned(frame, link.origin.rotation), [ax, ay, az, half.cos()]);
        frames.push(([at[0] + vx, at[1] + vy, at[2] + vz], turn));
    }
    frames.iter().map(|([_, _, z], _)| *z).collect()
}

#[test]
fn legs_move_in_the_page_and_in_a_replay() {
    let scratch = Scratch::new();
    scratch
        .write("walk.c", "#include \"eyebot.h\"\nint main() { LEGSetSpeed(500, 0, 0); OSWait(1000000); return 0; }\n");
    let text = "[world]\nfloor_mm = [20000, 4000]\n[[robot]]\ntype = \"%sim%/robis/biped.robi\"\nprogram = \
                \"walk.c\"\nx_mm = 1000\ny_mm = 2000\napi = 7\n";
    scratch.write("walk.scene.toml", text);
    let served = Served::start(&scratch, &["view", "walk.scene.toml"]);
    let mut page = served.page();
    page.until("a stride", |page| page.snapshot.as_ref().is_some_and(|snapshot| snapshot.t_s > 3.0));
    let (scene, snapshot) = (page.scene.clone().expect("a scene"), page.snapshot.clone().expect("a snapshot"));
    let on_links =
        scene.parts.iter().filter(|part| matches!(part.place, sim_view::protocol::Attachment::Link { robot: 1, .. }));
    assert_eq!(on_links.count(), 6, "thigh, shank and foot of two legs");
    let (robot, state) = (&scene.robots[0], &snapshot.robots[0]);
    assert_eq!((robot.links.len(), robot.standing_rad.len(), state.joints_rad.len()), (10, 10, 10));
    let is_striding =
        state.joints_rad.iter().zip(&robot.standing_rad).any(|(angle, still)| (angle - still).abs() > 0.1);
    assert!(is_striding, "{:?}", state.joints_rad);
    // One of the ankles is as high as in a standing robot, since its foot is on the ground; none is lower.
    let ankles = |joints: &[f64], lift: f64| {
        let heights = link_heights(robot, joints);
        [heights[4] + lift, heights[9] + lift]
    };
    let [still, _] = ankles(&robot.standing_rad, 0.0);
    let walking = ankles(&state.joints_rad, state.lift_m);
    assert!(still > 0.02 && still < 0.12, "{still}");
    let lowest = walking[0].min(walking[1]);
    assert!((lowest - still).abs() < 0.06 && walking.iter().all(|ankle| *ankle < still + 0.4), "{walking:?}, {still}");
    drop(served);

    scratch.report("walk.scene.toml", &["--until", "2", "--trace", "trace.jsonl"], 0);
    let served = Served::start(&scratch, &["replay", "trace.jsonl"]);
    let recording: Recording = serde_json::from_slice(&served.get("/recording.json")).expect("a recording");
    let postures = &recording.robots[0].postures;
    assert!(postures.t_s.len() > 10 && postures.t_s.is_sorted(), "{:?}", postures.t_s);
    assert_eq!(postures.joints_rad.len(), 10 * postures.t_s.len());
    assert_eq!(postures.lift_m.len(), postures.t_s.len());
}
