//! Hostile clients: the server refuses or survives them, and continues to serve all other clients.

#![allow(clippy::unwrap_used, reason = "a test fails by them")]

mod common;

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use common::*;
use serde_json::json;
use sim_view::{Access, Download, OpenError, Page, Window};
use tungstenite::Message;

/// A page connected before the attack, which must still work after it.
struct Witness {
    page: Client,
    number: u32,
}

impl Witness {
    fn new(window: &Window) -> Witness {
        Witness { page: Client::hello(window, None).0, number: 0 }
    }

    /// Checks that this page, and another page that connects now, can watch and act.
    fn check(&mut self, window: &Window) {
        self.check_alone(window);
        Witness::new(window).check_alone(window);
    }

    fn check_alone(&mut self, window: &Window) {
        self.number += 1;
        let t_s = f64::from(self.number);
        window.show(snapshot(t_s), vec![]);
        while self.page.receive_type("snapshot")["t_s"] != t_s {}
        self.page.act(self.number);
        let mut pending = None;
        until("the command", || {
            pending = window.commands().recv_timeout(Duration::from_millis(50));
            pending.is_some()
        });
        pending.unwrap().accept();
        assert_eq!(self.page.receive_answer(), (u64::from(self.number), None));
    }
}

#[test]
fn origins_and_hosts() {
    let window = local();
    let port = window.address().port();
    let socket = |host: &str, origin: &str| {
        let upgrade = ["Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13"];
        let head =
            format!("{host}{origin}{}\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n", upgrade.join("\r\n"));
        let mut stream = TcpStream::connect(window.address()).unwrap();
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        stream.write_all(format!("GET /ws HTTP/1.1\r\n{head}").as_bytes()).unwrap();
        let mut answer = [0; 2048];
        let length = stream.read(&mut answer).unwrap();
        String::from_utf8_lossy(&answer[..length]).into_owned()
    };
    let host = format!("Host: 127.0.0.1:{port}\r\n");
    let localhost = format!("Host: localhost:{port}\r\n");
    let rebound = format!("Host: evil.example:{port}\r\n");
    for (host, origin) in [
        (&host, format!("Origin: http://127.0.0.1:{port}\r\n")),
        (&localhost, format!("Origin: http://localhost:{port}\r\n")),
    ] {
        let answer = socket(host, &origin);
        assert!(answer.starts_with("HTTP/1.1 101 "), "{host}{origin}{answer}");
    }
    for (host, origin) in [
        (&host, String::new()),
        (&host, "Origin: null\r\n".into()),
        (&host, "Origin: http://evil.example\r\n".into()),
        (&host, format!("Origin: http://evil.example:{port}\r\n")),
        (&host, format!("Origin: https://127.0.0.1:{port}\r\n")),
        (&host, "Origin: http://127.0.0.1\r\n".into()),
        (&host, format!("Origin: http://127.0.0.1:{port}.evil.example\r\n")),
        (&host, format!("Origin: http://127.0.0.1:{port}\r\nOrigin: http://evil.example\r\n")),
        (&host, format!("Host: evil.example\r\nOrigin: http://127.0.0.1:{port}\r\n")),
        (&host, format!("Origin: http://localhost:{port}\r\n")),
        (&rebound, format!("Origin: http://evil.example:{port}\r\n")),
        (&rebound, format!("Origin: http://127.0.0.1:{port}\r\n")),
        (&String::new(), format!("Origin: http://127.0.0.1:{port}\r\n")),
    ] {
        let answer = socket(host, &origin);
        let is_refused = answer.starts_with("HTTP/1.1 403 ") || answer.starts_with("HTTP/1.1 400 ");
        assert!(is_refused, "{host}{origin}{answer}");
    }
    assert!(!window.has_pages());
}

#[test]
fn requests() {
    let window = local();
    let host = format!("Host: {}", window.address());
    window.offer("run.jsonl", Download::new("application/jsonl", || Ok(b"{}\n".to_vec())));
    window.offer("scene.toml", Download::new("application/toml", || Err("the run is over".into())));
    window.offer("panics", Download::new("text/plain", || panic!("on purpose")));
    for (path, status, content) in [
        ("/", "200 OK", "<title>p</title>"),
        ("/page.js", "200 OK", "1"),
        ("/other.js", "404 Not Found", "there is no such file"),
        ("/../Cargo.toml", "404 Not Found", "there is no such file"),
        ("/%2e%2e/Cargo.toml", "404 Not Found", "there is no such file"),
        ("/files/run.jsonl", "200 OK", "{}\n"),
        ("/files/scene.toml", "503 Service Unavailable", "the run is over"),
        ("/files/panics", "500 Internal Server Error", "it could not be generated"),
        ("/files/other", "404 Not Found", "there is no such file"),
        ("/recording.json", "404 Not Found", "there is no such file"),
    ] {
        let answer = get(&window, path, &[&host]);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status}\r\n")), "{path}: {answer}");
        assert!(answer.ends_with(&format!("\r\n\r\n{content}")), "{path}: {answer}");
        for header in [
            "content-security-policy: default-src 'none'; script-src 'self';",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cross-origin-resource-policy: same-origin",
        ] {
            assert!(answer.contains(header), "{path}: {header}: {answer}");
        }
        assert!(!answer.contains("access-control"), "{path}: {answer}");
    }
    let saved = get(&window, "/files/run.jsonl", &[&host]);
    assert!(saved.contains("content-disposition: attachment; filename=\"run.jsonl\""), "{saved}");
    window.offer("recording.json", Download::new("application/json", || Ok(b"{}".to_vec())));
    assert!(get(&window, "/recording.json", &[&host]).ends_with("\r\n\r\n{}"));

    for head in ["Host: evil.example", "Host: 127.0.0.1", "Host: localhost:1"] {
        let answer = get(&window, "/files/run.jsonl", &[head]);
        assert!(answer.starts_with("HTTP/1.1 403 ") && answer.contains("is not an address of this server"), "{answer}");
    }
    for other in ["Origin: http://evil.example", "Sec-Fetch-Site: cross-site", "Sec-Fetch-Site: same-site"] {
        let answer = get(&window, "/files/run.jsonl", &[&host, other]);
        assert!(answer.starts_with("HTTP/1.1 403 "), "{answer}");
    }
    let answer =
        request(&window, &format!("POST / HTTP/1.1\r\n{host}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"));
    assert!(answer.starts_with("HTTP/1.1 405 "), "{answer}");
    for garbage in
        ["\0\0\0\0\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "\x16\x03\x01\x02\0\x01\0\x01\u{fc}\r\n\r\n"]
    {
        let answer = request(&window, garbage);
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 400 "), "{garbage:?}: {answer}");
    }
    let long = format!("X: {}", "x".repeat(1_000_000));
    let answer = get(&window, "/", &[&host, &long]);
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 431 "), "{answer}");
    Witness::new(&window).check(&window);
}

#[test]
fn a_missing_page_shows_the_reason() {
    let window = Window::open(options("127.0.0.1:0", Access::Local), Page::missing("there is no Node.js")).unwrap();
    let answer = get(&window, "/", &[&format!("Host: {}", window.address())]);
    assert!(answer.starts_with("HTTP/1.1 503 ") && answer.ends_with("there is no Node.js"), "{answer}");
    Witness::new(&window).check(&window);
}

#[test]
fn malformed_messages_are_refused() {
    let window = local();
    let mut witness = Witness::new(&window);
    let hello = |client: &mut Client| client.send_json(&json!({ "type": "hello", "protocol": 2, "token": null }));
    let nested = format!("{}{}", "[".repeat(30_000), "]".repeat(30_000));
    let deep = format!(r#"{{"type":"act","number":1,"command":{}}}"#, nested);
    for (text, why) in [
        ("", "EOF"),
        ("{", "EOF"),
        ("nonsense", "expected"),
        ("null", "invalid type"),
        ("[]", "missing field `type`"),
        (r#"{"type":"shout"}"#, "unknown variant `shout`"),
        (r#"{"type":"look","robot":1,"camera":false,"calls":false,"more":1}"#, "unknown field `more`"),
        (r#"{"type":"look","robot":-1,"camera":false,"calls":false}"#, "invalid value"),
        (r#"{"type":"look","robot":4294967296,"camera":false,"calls":false}"#, "invalid value"),
        (r#"{"type":"act","number":1,"command":{"command":"run","x":1}}"#, "unknown field `x`"),
        (r#"{"type":"act","number":1,"command":{"command":"speed","factor":1e999}}"#, "number out of range"),
        (r#"{"type":"act","number":1,"command":{"command":"act","action":{"do":"fly"}}}"#, "unknown variant `fly`"),
        (r#"{"type":"hello","protocol":2,"token":null}"#, "`hello` must be the first message"),
        (&nested, "invalid type: sequence"),
        (&deep, "recursion limit exceeded"),
    ] {
        for is_first in [true, false] {
            let mut client = Client::connect(&window);
            if !is_first {
                hello(&mut client);
            }
            client.send_text(text);
            if is_first && text.contains("hello") {
                continue;
            }
            let (code, reason) = client.receive_close().unwrap();
            assert_eq!(code, 4400, "{reason}");
            assert!(reason.contains(why), "{why}: {reason}");
        }
    }
    let mut client = Client::connect(&window);
    client.send(Message::binary(vec![0xff; 1000])).unwrap();
    assert_eq!(client.receive_close(), Some((1003, "messages must be text".into())));
    witness.check(&window);
}

#[test]
fn too_long_messages_are_refused() {
    let window = local();
    let mut witness = Witness::new(&window);
    for bytes in [65_537, 10_000_000] {
        let (mut client, _) = Client::hello(&window, None);
        // The server reads only the length of the message, and may disconnect before the message is sent completely.
        let sent = client.send(Message::text("x".repeat(bytes)));
        if let Some(close) = client.receive_close() {
            assert_eq!(close, (1009, "messages have at most 65536 bytes".into()), "{sent:?}");
        }
        witness.check(&window);
    }
    let (mut client, _) = Client::hello(&window, None);
    client.send_text(&format!("{}{{", " ".repeat(65_535)));
    assert_eq!(client.receive_close().unwrap().0, 4400, "65,536 bytes are read");
}

#[test]
fn a_thousand_connections() {
    let window = local();
    let mut witness = Witness::new(&window);
    let mut held = Vec::new();
    for number in 0..1_000 {
        // If the system allows fewer descriptors, the test opens fewer connections.
        let Ok(mut stream) = TcpStream::connect(window.address()) else { break };
        if number % 2 == 0 {
            // A client that sends its request slowly.
            let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: ");
        }
        held.push(stream);
        if number % 100 == 99 {
            witness.check(&window);
        }
    }
    assert!(held.len() >= 400, "{}", held.len());
    witness.check(&window);
    for mut stream in held {
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        let mut answer = Vec::new();
        let is_over = match stream.read_to_end(&mut answer) {
            Ok(_) => true,
            Err(error) => error.kind() != std::io::ErrorKind::WouldBlock,
        };
        assert!(is_over, "a connection without a request lasts");
    }
    witness.check(&window);
}

#[test]
fn too_many_pages_are_refused() {
    let window = local();
    let mut pages: Vec<_> = (0..64).map(|_| Client::hello(&window, None).0).collect();
    let mut others: Vec<_> = (0..100).map(|_| Client::try_connect(&window)).collect();
    let mut turned_away = 0;
    for other in &mut others {
        match other {
            Ok(client) => {
                turned_away += 1;
                assert_eq!(client.receive_close(), Some((1013, "64 pages are open already".into())));
            }
            Err(why) => assert!(why.contains("503"), "{why}"),
        }
    }
    assert!(turned_away > 0);
    assert_eq!(window.pages(), 64);
    window.show(snapshot(1.0), vec![]);
    for page in &mut pages {
        page.receive_type("snapshot");
    }
    drop((pages, others));
    until("all have gone", || window.pages() == 0);
    Witness::new(&window).check(&window);
}

#[test]
fn a_flood_of_commands_is_refused() {
    let window = local();
    let mut witness = Witness::new(&window);
    let (mut flood, _) = Client::hello(&window, None);
    for number in 1..=200 {
        flood.act(number);
    }
    for number in 33..=200 {
        assert_eq!(flood.receive_answer(), (number, Some("too many commands of this page are waiting".into())));
    }
    for number in 1..=32 {
        window.commands().try_recv().unwrap().accept();
        assert_eq!(flood.receive_answer(), (number, None));
    }
    witness.check(&window);
    // Many pages send commands that the simulation does not take: 256 commands wait, all others are refused.
    let mut pages: Vec<_> = (0..10).map(|_| Client::hello(&window, None).0).collect();
    for (page, robot) in pages.iter_mut().zip(1..) {
        (1..=32).for_each(|number| page.act(number));
        page.look(Some(robot), false);
        until("the page has been heard", || window.looks().len() == robot as usize);
    }
    for page in &mut pages[8..] {
        for number in 1..=32 {
            assert_eq!(page.receive_answer(), (number, Some("too many commands are waiting".into())));
        }
    }
    assert_eq!(std::iter::from_fn(|| window.commands().try_recv()).map(|pending| pending.accept()).count(), 256);
    for page in &mut pages[..8] {
        (1..=32).for_each(|number| assert_eq!(page.receive_answer(), (number, None)));
    }
}

#[test]
fn ports_and_addresses() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let error = Window::open(options(&address, Access::Local), page()).err().unwrap();
    assert!(matches!(error, OpenError::Taken(_)));
    assert!(error.to_string().starts_with(&format!("`{address}` is taken by another program")), "{error}");
    let error = Window::open(options("192.0.2.1:0", Access::Local), page()).err().unwrap();
    assert!(matches!(error, OpenError::NoAddress(_)), "{error}");
    let error = Window::open(options("127.0.0.1:0", Access::Class { token: String::new() }), page()).err().unwrap();
    assert!(matches!(error, OpenError::NoToken), "{error}");
    for address in ["[::1]:0", "0.0.0.0:0", "[::]:0"] {
        if address.contains("::") && TcpListener::bind("[::1]:0").is_err() {
            eprintln!("skipped: no IPv6 here");
            continue;
        }
        let window = Window::open(options(address, Access::Local), page()).unwrap();
        let url = window.url();
        assert!(!url.contains("0.0.0.0") && !url.contains("[::]"), "{url}");
        if address.contains("::1") {
            assert_eq!(url, format!("http://[::1]:{}/", window.address().port()));
            Witness::new(&window).check(&window);
        }
    }
}
