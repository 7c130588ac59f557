//! Client of the page's protocol, without a browser.
#![allow(clippy::unwrap_used, reason = "a test fails by them")]
#![allow(dead_code, reason = "each test binary uses a part of it")]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::{Value, json};
use sim_view::protocol::{
    AddableTypes, Detail, Event, Lcd, Light, PROTOCOL, Picture, Robot, RunState, Scene, Sky, Snapshot,
};
use sim_view::{Access, Options, Page, Window};
use tungstenite::client::IntoClientRequest;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Message, WebSocket};

/// Timeout longer than anything takes here; only a failing test waits for it.
pub const TIMEOUT: Duration = Duration::from_secs(40);

pub fn options(address: &str, access: Access) -> Options {
    Options { address: address.parse().unwrap(), access, title: "a scene".into(), version: "1.2.3".into() }
}

pub fn page() -> Page {
    Page::of([("index.html".to_owned(), b"<title>p</title>".to_vec()), ("page.js".to_owned(), b"1".to_vec())])
}

pub fn local() -> Window {
    Window::open(options("127.0.0.1:0", Access::Local), page()).unwrap()
}

pub fn class() -> Window {
    Window::open(options("127.0.0.1:0", Access::Class { token: "secret".into() }), page()).unwrap()
}

pub fn scene(run: u32) -> Scene {
    Scene {
        run,
        title: "a scene".into(),
        seed: "1".into(),
        slot_s: 0.05,
        bounds_m: [[0.0; 2], [1.0; 2]],
        images: vec![],
        meshes: vec![],
        parts: vec![],
        ground: None,
        light: Light { towards: [0.0, 0.0, 1.0], ambient: 0.5, diffuse: 0.5, shadows: false },
        sky: Sky { horizon: [0; 3], zenith: [0; 3] },
        robots: vec![Robot {
            id: 1,
            name: "one".into(),
            kind: "S4".into(),
            program: String::new(),
            colour: [1, 2, 3],
            body: sim_view::protocol::Body { radius_m: 0.1, height_m: 0.1 },
            links: vec![],
            standing_rad: vec![],
            sensors: vec![],
            camera: None,
            lcd: Lcd { size_px: [128, 64], has_colours: false },
        }],
        objects: vec![],
        addable_types: AddableTypes::default(),
    }
}

pub fn snapshot(t_s: f64) -> Snapshot {
    let (robots, objects, beams, checks) = (vec![], vec![], vec![], vec![]);
    Snapshot { run: 1, t_s, state: RunState::Running, speed: Some(1.0), rate: 1.0, robots, objects, beams, checks }
}

pub fn detail(robot: u32, t_s: f64, lcd: Option<&str>) -> Detail {
    let lcd = lcd.map(|url| Picture { url: url.into(), size_px: [1, 1] });
    Detail { run: 1, robot, t_s, lcd, ..Detail::default() }
}

pub fn event(number: u32, kind: &str, robot: u32) -> Event {
    let (text, fields) = (format!("event \"{number}\""), json!({ "n": number }));
    Event { number, t_s: f64::from(number), robot: Some(robot), kind: kind.into(), text, fields }
}

/// Client end of a socket.
pub struct Client {
    socket: WebSocket<TcpStream>,
}

impl Client {
    /// Opens a socket as a page of this server does.
    pub fn connect(window: &Window) -> Client {
        Client::try_connect(window).unwrap()
    }

    pub fn try_connect(window: &Window) -> Result<Client, String> {
        let host = window.address().to_string();
        let mut request = format!("ws://{host}/ws").into_client_request().unwrap();
        request.headers_mut().insert("Origin", format!("http://{host}").parse().unwrap());
        let stream = TcpStream::connect(window.address()).map_err(|error| error.to_string())?;
        stream.set_read_timeout(Some(TIMEOUT)).unwrap();
        stream.set_write_timeout(Some(TIMEOUT)).unwrap();
        let config = WebSocketConfig::default().max_message_size(None).max_frame_size(None);
        match tungstenite::client::client_with_config(request, stream, Some(config)) {
            Ok((socket, _)) => Ok(Client { socket }),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Opens a socket and sends the hello; returns the welcome as well.
    pub fn hello(window: &Window, token: Option<&str>) -> (Client, Value) {
        let mut client = Client::connect(window);
        client.send_json(&json!({ "type": "hello", "protocol": PROTOCOL, "token": token }));
        let welcome = client.receive();
        assert_eq!(welcome["type"], "welcome", "{welcome}");
        (client, welcome)
    }

    pub fn send_json(&mut self, message: &Value) {
        self.send_text(&message.to_string());
    }

    pub fn send_text(&mut self, text: &str) {
        self.send(Message::text(text)).unwrap();
    }

    pub fn send(&mut self, message: Message) -> tungstenite::Result<()> {
        self.socket.send(message)
    }

    pub fn look(&mut self, robot: Option<u32>, calls: bool) {
        self.send_json(&json!({ "type": "look", "robot": robot, "camera": false, "calls": calls }));
    }

    pub fn act(&mut self, number: u32) {
        self.send_json(&json!({ "type": "act", "number": number, "command": { "command": "step" } }));
    }

    /// Receives the next message.
    pub fn receive(&mut self) -> Value {
        match self.next() {
            Ok(message) => message,
            Err(end) => panic!("closed: {end:?}"),
        }
    }

    /// Receives the next message of this type; others are skipped.
    pub fn receive_type(&mut self, kind: &str) -> Value {
        loop {
            let message = self.receive();
            if message["type"] == kind {
                return message;
            }
        }
    }

    /// Receives the next answer; returns its number and refusal.
    pub fn receive_answer(&mut self) -> (u64, Option<String>) {
        let answer = self.receive_type("answer");
        (answer["number"].as_u64().unwrap(), answer["refused"].as_str().map(String::from))
    }

    /// Receives the server's close frame; returns its code and reason. None if the server only ends the connection.
    pub fn receive_close(&mut self) -> Option<(u16, String)> {
        loop {
            if let Err(end) = self.next() {
                return end;
            }
        }
    }

    fn next(&mut self) -> Result<Value, Option<(u16, String)>> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => return Ok(serde_json::from_str(&text).unwrap()),
                Ok(Message::Close(frame)) => {
                    return Err(frame.map(|frame| (frame.code.into(), frame.reason.to_string())));
                }
                Ok(_) => {}
                Err(tungstenite::Error::Io(error)) if error.kind() == std::io::ErrorKind::WouldBlock => {
                    panic!("nothing came")
                }
                Err(_) => return Err(None),
            }
        }
    }
}

/// Sends the text of a request and returns the text of the answer.
pub fn request(window: &Window, text: &str) -> String {
    let mut stream = TcpStream::connect(window.address()).unwrap();
    stream.set_read_timeout(Some(TIMEOUT)).unwrap();
    stream.write_all(text.as_bytes()).unwrap();
    let mut answer = Vec::new();
    // The server may reset the connection after it has sent the whole answer.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

/// `GET` with these header lines beside `Connection: close`.
pub fn get(window: &Window, path: &str, head: &[&str]) -> String {
    let head: String = head.iter().map(|line| format!("{line}\r\n")).collect();
    request(window, &format!("GET {path} HTTP/1.1\r\n{head}Connection: close\r\n\r\n"))
}

/// Waits until a condition holds.
pub fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begin = std::time::Instant::now();
    while !holds() {
        assert!(begin.elapsed() < TIMEOUT, "{what}: never");
        std::thread::sleep(Duration::from_millis(5));
    }
}
