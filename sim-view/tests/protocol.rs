//! Protocol between server and page.

#![allow(clippy::unwrap_used, reason = "a test fails by them")]

mod common;

use std::time::Duration;

use common::*;
use serde_json::json;
use sim_view::protocol::{Action, Build, Command, Layer, LayerContent, PROTOCOL, Pose, Seed};
use sim_view::{Look, PendingCommand, Window};

fn next(window: &Window) -> PendingCommand {
    let mut pending = None;
    until("a command", || {
        pending = window.commands().recv_timeout(Duration::from_millis(50));
        pending.is_some()
    });
    pending.unwrap()
}

#[test]
fn hello_is_answered_with_the_whole_state() {
    let window = local();
    assert!(!window.has_pages());
    window.show_scene(scene(1));
    window.show(snapshot(2.5), vec![]);
    window.add_events(vec![event(1, "contact", 1)], 0);
    let (mut page, welcome) = Client::hello(&window, None);
    assert_eq!(
        welcome,
        json!({ "type": "welcome", "protocol": PROTOCOL, "version": "1.2.3", "title": "a scene", "may_act": true })
    );
    let message = page.receive();
    assert_eq!(
        (&message["type"], &message["run"], &message["robots"][0]["name"]),
        (&json!("scene"), &json!(1), &json!("one"))
    );
    let message = page.receive();
    assert_eq!((&message["type"], &message["t_s"]), (&json!("snapshot"), &json!(2.5)));
    let received = page.receive();
    let expected =
        json!({ "number": 1, "t_s": 1.0, "robot": 1, "kind": "contact", "text": "event \"1\"", "fields": { "n": 1 } });
    assert_eq!(received, json!({ "type": "events", "events": [expected], "missed": 0 }));
    assert!(window.has_pages());
    window.build(Build::Failed { output: "no".into() });
    assert_eq!(page.receive(), json!({ "type": "build", "state": "failed", "output": "no" }));
    drop(page);
    until("the page has gone", || !window.has_pages());
}

#[test]
fn layers_go_to_pages_that_have_selected_the_robot() {
    let window = local();
    window.show_scene(scene(1));
    let layer = |robot, name: &str, t_s| Layer {
        run: 1,
        robot,
        name: name.into(),
        t_s,
        frame: Pose { x_m: 1.0, y_m: 2.0, phi_rad: 0.5 },
        content: LayerContent::Points { positions: String::new() },
    };
    window.show_layers(vec![layer(1, "map", 0.1), layer(1, "path", 0.2), layer(2, "map", 0.3)]);
    window.show_layers(vec![layer(1, "map", 0.4)]);
    let (mut page, _) = Client::hello(&window, None);
    assert_eq!(page.receive()["type"], "scene");
    page.send_json(&json!({ "type": "look", "robot": 1, "camera": false, "calls": false }));
    let frame = json!({ "x_m": 1.0, "y_m": 2.0, "phi_rad": 0.5 });
    let expected = |robot: u32, name: &str, t_s: f64| {
        let content = json!({ "kind": "points", "positions": "" });
        json!({ "type": "layer", "run": 1, "robot": robot, "name": name, "t_s": t_s, "frame": frame, "content": content })
    };
    assert_eq!(page.receive(), expected(1, "map", 0.4), "the last one of its name");
    assert_eq!(page.receive(), expected(1, "path", 0.2));
    window.show_layers(vec![layer(2, "map", 0.5), layer(1, "path", 0.6)]);
    assert_eq!(page.receive(), expected(1, "path", 0.6));
    page.send_json(&json!({ "type": "look", "robot": 2, "camera": false, "calls": false }));
    assert_eq!(page.receive(), expected(2, "map", 0.5));
    page.send_json(&json!({ "type": "look", "robot": 1, "camera": false, "calls": false }));
    assert_eq!([page.receive(), page.receive()], [expected(1, "map", 0.4), expected(1, "path", 0.6)], "again");
    window.show_scene(scene(2));
    assert_eq!(page.receive()["type"], "scene");
    window.build(Build::Done);
    assert_eq!(page.receive()["type"], "build", "another run has no layers yet");
}

#[test]
fn first_message_decides() {
    let window = class();
    let version = format!("the page speaks version 99 of the protocol, the server {PROTOCOL}: load the page again");
    for (first, code, why) in [
        (json!({ "type": "hello", "protocol": 99, "token": "wrong" }), 4406, version.as_str()),
        (json!({ "type": "hello", "protocol": PROTOCOL, "token": "wrong" }), 4401, "the token is wrong"),
        (json!({ "type": "hello", "protocol": PROTOCOL, "token": "" }), 4401, "the token is wrong"),
        (
            json!({ "type": "look", "robot": 1, "camera": true, "calls": true }),
            4400,
            "the first message is not `hello`",
        ),
    ] {
        let mut page = Client::connect(&window);
        page.send_json(&first);
        assert_eq!(page.receive_close(), Some((code, why.into())), "{first}");
    }
    assert!(!window.has_pages());
    assert!(window.looks().is_empty());
    let mut silent = Client::connect(&window);
    assert_eq!(silent.receive_close(), Some((4408, "no `hello` within 5 s".into())));
}

#[test]
fn only_pages_with_the_token_may_act() {
    let window = class();
    assert_eq!(window.url(), format!("http://{}/#token=secret", window.address()));
    assert_eq!(window.public_url(), format!("http://{}/", window.address()));
    let (mut watcher, welcome) = Client::hello(&window, None);
    assert_eq!(welcome["may_act"], false);
    watcher.act(7);
    assert_eq!(watcher.receive_answer(), (7, Some("this page may only watch: it has no token".into())));
    assert!(window.commands().try_recv().is_none());
    let (mut teacher, welcome) = Client::hello(&window, Some("secret"));
    assert_eq!(welcome["may_act"], true);
    teacher.act(8);
    let pending = next(&window);
    assert_eq!(pending.command, Command::Step {});
    pending.accept();
    assert_eq!(teacher.receive_answer(), (8, None));
    watcher.look(Some(1), false);
    until("watchers may look", || !window.looks().is_empty());
}

#[test]
fn answers_have_the_numbers_of_their_commands() {
    let window = local();
    let (mut page, _) = Client::hello(&window, None);
    let placement = json!({ "do": "place_robot", "robot": 1, "x_m": 0.1, "y_m": 0.2, "phi_rad": 0.3 });
    for (number, command) in [
        (1, json!({ "command": "act", "action": placement })),
        (2, json!({ "command": "speed", "factor": null })),
        (3, json!({ "command": "restart", "seed": { "number": "18446744073709551615" } })),
    ] {
        page.send_json(&json!({ "type": "act", "number": number, "command": command }));
    }
    let pending = [next(&window), next(&window), next(&window)];
    let action = Action::PlaceRobot { robot: 1, x_m: 0.1, y_m: 0.2, phi_rad: 0.3 };
    assert_eq!(pending[0].command, Command::Act { action });
    assert_eq!(pending[1].command, Command::Speed { factor: None });
    assert_eq!(pending[2].command, Command::Restart { seed: Seed::Number("18446744073709551615".into()) });
    let [first, second, third] = pending;
    second.refuse("not now");
    assert_eq!(page.receive_answer(), (2, Some("not now".into())));
    first.accept();
    assert_eq!(page.receive_answer(), (1, None));
    drop(third);
    assert_eq!(page.receive_answer(), (3, Some("the run accepts no more commands".into())));
}

#[test]
fn selections_of_all_pages_are_merged() {
    let window = local();
    let (mut one, _) = Client::hello(&window, None);
    let (mut other, _) = Client::hello(&window, None);
    one.look(Some(2), true);
    other.send_json(&json!({ "type": "look", "robot": 2, "camera": true, "calls": false }));
    let both = vec![Look { robot: 2, camera: true, calls: true }];
    until("both", || window.looks() == both);
    other.look(Some(1), false);
    let apart = vec![Look { robot: 1, camera: false, calls: false }, Look { robot: 2, camera: false, calls: true }];
    until("apart", || window.looks() == apart);
    drop(one);
    until("one has gone", || window.looks() == apart[..1]);
    other.look(None, false);
    until("none", || window.looks().is_empty());
}

#[test]
fn a_selection_ends_the_wait_for_commands() {
    let window = local();
    let (mut page, _) = Client::hello(&window, None);
    page.look(Some(1), false);
    assert!(window.commands().recv_timeout(Duration::from_secs(3600)).is_none());
    let commands = window.commands().clone();
    std::thread::scope(|scope| {
        scope.spawn(|| commands.wake());
        assert!(window.commands().recv_timeout(Duration::from_secs(3600)).is_none());
    });
}

#[test]
fn the_display_is_sent_once_to_each_page() {
    let window = local();
    window.show(snapshot(0.0), vec![detail(1, 0.0, Some("data:a")), detail(2, 0.0, Some("data:b"))]);
    let (mut page, _) = Client::hello(&window, None);
    page.receive_type("snapshot");
    page.look(Some(1), false);
    let message = page.receive_type("detail");
    assert_eq!((&message["robot"], &message["lcd"]["url"]), (&json!(1), &json!("data:a")));
    window.show(snapshot(1.0), vec![detail(1, 1.0, None)]);
    let message = page.receive_type("detail");
    assert_eq!((&message["t_s"], &message["lcd"]), (&json!(1.0), &json!(null)));

    let (mut late, _) = Client::hello(&window, None);
    late.look(Some(1), false);
    let message = late.receive_type("detail");
    assert_eq!((&message["t_s"], &message["lcd"]["url"]), (&json!(1.0), &json!("data:a")));

    // A picture is not lost if a later detail without a picture overtakes its detail.
    window.show(snapshot(2.0), vec![detail(1, 2.0, Some("data:c"))]);
    window.show(snapshot(3.0), vec![detail(1, 3.0, None)]);
    for page in [&mut page, &mut late] {
        let mut pictures = Vec::new();
        loop {
            let message = page.receive_type("detail");
            pictures.extend(message["lcd"]["url"].as_str().map(String::from));
            if message["t_s"] == 3.0 {
                break;
            }
        }
        assert_eq!(pictures, ["data:c"]);
    }

    page.look(Some(2), false);
    assert_eq!(page.receive_type("detail")["lcd"]["url"], "data:b");
    page.look(Some(1), false);
    assert_eq!(page.receive_type("detail")["lcd"]["url"], "data:c");

    // No state of the previous run is kept.
    window.show_scene(scene(2));
    let mut of_next_run = detail(1, 0.0, None);
    of_next_run.run = 2;
    window.show(snapshot(0.0), vec![of_next_run]);
    let message = page.receive_type("detail");
    assert_eq!((&message["run"], &message["lcd"]), (&json!(2), &json!(null)));
}

#[test]
fn events_are_kept_and_counted() {
    let window = local();
    window.show_scene(scene(1));
    window.add_events((1..=25_000).map(|number| event(number, "contact", 1)).collect(), 0);
    let (mut page, _) = Client::hello(&window, None);
    let (mut missed, mut numbers) = (0, Vec::new());
    while numbers.len() < 20_000 {
        let message = page.receive_type("events");
        missed += message["missed"].as_u64().unwrap();
        let events = message["events"].as_array().unwrap();
        assert!(events.len() <= 1_000);
        numbers.extend(events.iter().map(|event| event["number"].as_u64().unwrap()));
    }
    assert_eq!(missed, 5_000);
    assert!(numbers.iter().copied().eq(5_001..=25_000));

    for omitted in [0, 7] {
        window.add_events(vec![event(25_001, "contact", 1)], omitted);
        let message = page.receive_type("events");
        assert_eq!((&message["events"][0]["number"], &message["missed"]), (&json!(25_001), &json!(omitted)));
    }

    window.show_scene(scene(2));
    window.add_events(vec![event(1, "contact", 1)], 0);
    let (mut late, _) = Client::hello(&window, None);
    for page in [&mut page, &mut late] {
        assert_eq!(page.receive_type("scene")["run"], 2);
        let message = page.receive_type("events");
        assert_eq!(message["events"].as_array().unwrap().len(), 1);
        assert_eq!((&message["events"][0]["number"], &message["missed"]), (&json!(1), &json!(0)));
    }
}

#[test]
fn events_before_the_scene_of_a_run_follow_it() {
    let window = local();
    window.show_scene(scene(1));
    window.begin_run(2);
    window.add_events(vec![event(1, "contact", 1)], 0);
    let (mut page, _) = Client::hello(&window, None);
    window.show_scene(scene(2));
    let (scene, events) = (page.receive(), page.receive());
    assert_eq!((&scene["run"], &events["events"][0]["number"]), (&json!(2), &json!(1)));
}

#[test]
fn calls_go_to_pages_that_request_them() {
    let window = local();
    window.show_scene(scene(1));
    let (mut page, _) = Client::hello(&window, None);
    page.look(Some(2), true);
    until("the look", || !window.looks().is_empty());
    window.add_events(vec![event(1, "call", 1), event(2, "call", 2), event(3, "contact", 1)], 0);
    let received = page.receive_type("events");
    let numbers: Vec<_> = received["events"].as_array().unwrap().iter().map(|event| event["number"].clone()).collect();
    assert_eq!(numbers, [2, 3]);
    let (mut other, _) = Client::hello(&window, None);
    assert_eq!(other.receive_type("events")["events"].as_array().unwrap().len(), 1);
}

#[test]
fn a_reconnected_page_gets_the_whole_state_again() {
    let window = local();
    window.show_scene(scene(1));
    window.show(snapshot(1.0), vec![]);
    window.add_events(vec![event(1, "contact", 1)], 0);
    for _ in 0..3 {
        let (mut page, _) = Client::hello(&window, None);
        for kind in ["scene", "snapshot", "events"] {
            assert_eq!(page.receive()["type"], kind);
        }
    }
}

#[test]
fn a_stalled_page_delays_no_other_page() {
    const LAST: u32 = 600;
    let window = local();
    window.show_scene(scene(1));
    let (mut stalled, _) = Client::hello(&window, None);
    let (mut page, _) = Client::hello(&window, None);
    page.act(1);
    next(&window).accept();
    page.receive_answer();
    // 60 MB, far more than a system buffers for a connection.
    for number in 1..=LAST {
        let mut big = snapshot(f64::from(number));
        big.state = sim_view::protocol::RunState::Ended { why: "x".repeat(100_000), digest: String::new() };
        window.show(big, vec![]);
        std::thread::sleep(Duration::from_millis(5));
    }
    window.add_events(vec![event(1, "contact", 1)], 0);
    while page.receive_type("snapshot")["t_s"] != f64::from(LAST) {}
    let mut count = 0;
    loop {
        count += 1;
        if stalled.receive_type("snapshot")["t_s"] == f64::from(LAST) {
            break;
        }
    }
    assert!(count < LAST / 2, "{count} snapshots have waited for the page");
    assert_eq!(stalled.receive_type("events")["events"][0]["number"], 1);
}

#[test]
fn a_silent_page_is_disconnected() {
    let window = local();
    let (_silent, _) = Client::hello(&window, None);
    let (mut page, _) = Client::hello(&window, None);
    page.look(Some(1), false);
    until("one page is there", || window.looks().len() == 1);
    // A page that reads answers the server's pings.
    std::thread::scope(|scope| {
        scope.spawn(|| page.receive_close());
        until("the silent one is gone", || window.pages() == 1);
        assert_eq!(window.looks().len(), 1, "who answers stays");
        drop(window);
    });
}

#[test]
fn closing_sends_a_close_frame() {
    let window = local();
    let (mut page, _) = Client::hello(&window, None);
    let mut silent = Client::connect(&window);
    let address = window.address();
    drop(window);
    for page in [&mut page, &mut silent] {
        assert_eq!(page.receive_close(), Some((1001, "the simulator has ended".into())));
    }
    assert!(std::net::TcpStream::connect(address).is_err(), "nobody listens any more");
}
