//! `eyesim lsp`, tested by a scripted editor.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdout, Command, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;
use tests::eyesim_path;

/// An editor and its language server.
struct Editor {
    server: Child,
    output: BufReader<ChildStdout>,
    folder: TempDir,
    requests: i64,
}

impl Editor {
    /// Starts the server in a fresh folder with these files. `encodings` are those that the editor supports.
    fn start(files: &[(&str, &str)], encodings: &Value) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        files.iter().for_each(|(name, text)| std::fs::write(folder.path().join(name), text).expect("a file"));
        let mut server = Command::new(eyesim_path())
            .args(["lsp", "--stdio"])
            .current_dir(&folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a server");
        let output = BufReader::new(server.stdout.take().expect("its output"));
        let mut editor = Self { server, output, folder, requests: 0 };
        let capabilities = json!({ "general": { "positionEncodings": encodings } });
        let answer =
            editor.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": capabilities }));
        assert_eq!(answer["serverInfo"]["name"], "eyesim");
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let input = self.server.stdin.as_mut().expect("its input");
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).and_then(|()| input.flush()).expect("it listens");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request and returns its result or its error.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.requests += 1;
        self.send(&json!({ "jsonrpc": "2.0", "id": self.requests, "method": method, "params": params }));
        loop {
            let message = self.receive();
            if message["id"] == self.requests {
                return if message["error"].is_null() { message["result"].clone() } else { message["error"].clone() };
            }
        }
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).expect("a header") > 0, "the server has ended");
            match line.trim_end().split_once(": ") {
                Some(("Content-Length", number)) => length = number.parse().expect("a length"),
                Some(_) => {}
                None => break,
            }
        }
        let mut text = vec![0; length];
        self.output.read_exact(&mut text).expect("a message");
        serde_json::from_slice(&text).expect("JSON")
    }

    /// The next diagnostics of a file.
    fn diagnostics_of(&mut self, name: &str) -> Vec<Value> {
        let uri = self.uri(name);
        loop {
            let message = self.receive();
            if message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == uri {
                return message["params"]["diagnostics"].as_array().expect("a list").clone();
            }
        }
    }

    fn uri(&self, name: &str) -> String {
        let path = self.folder.path().canonicalize().expect("a folder").join(name);
        let encoded = path.to_str().expect("a path").bytes().map(|byte| match byte {
            b' ' | 128.. => format!("%{byte:02X}"),
            _ => char::from(byte).to_string(),
        });
        format!("file://{}", encoded.collect::<String>())
    }

    fn open(&mut self, name: &str, text: &str) {
        let document = json!({ "uri": self.uri(name), "languageId": "eyesim", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn change(&mut self, name: &str, text: &str) {
        let document = json!({ "uri": self.uri(name), "version": 2 });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [{ "text": text }] }));
    }

    fn at(&mut self, method: &str, name: &str, line: u32, character: u32) -> Value {
        let params = json!({
            "textDocument": { "uri": self.uri(name) },
            "position": { "line": line, "character": character },
        });
        self.ask(method, params)
    }

    fn labels(&mut self, name: &str, line: u32, character: u32) -> Vec<String> {
        let items = self.at("textDocument/completion", name, line, character);
        let label = |item: &Value| item["label"].as_str().expect("a label").to_owned();
        items.as_array().expect("a list").iter().map(label).collect()
    }

    /// Ends the server and returns its exit code.
    fn end(mut self) -> Option<i32> {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        self.tell("exit", Value::Null);
        self.server.wait().expect("the process ends").code()
    }
}

const WORLD: &str = "floor 2000 2000\n0 0 2000 0\n";
const SIM: &str = "world a.wld\nS4 500 500 90 drive.c\n";

#[test]
fn mistakes_follow_the_typing_and_go_when_they_are_mended() {
    let mut editor =
        Editor::start(&[("a.wld", WORLD), ("drive.c", "int main(void) { return 0; }\n")], &json!(["utf-16"]));
    editor.open("x.sim", SIM);
    assert_eq!(editor.diagnostics_of("x.sim"), Vec::<Value>::new());
    editor.change("x.sim", "wrld a.wld\nS4 500 500 90 drive.c\n");
    let diagnostics = editor.diagnostics_of("x.sim");
    let (first, code) = (&diagnostics[0], diagnostics[0]["code"].as_str().expect("a code"));
    assert_eq!(
        (&first["range"]["start"], &first["severity"]),
        (&json!({ "line": 0, "character": 0 }), &json!(1)),
        "{first}"
    );
    assert!(code.starts_with("sim-") && first["message"].as_str().expect("a text").contains("world"), "{first}");
    editor.change("x.sim", SIM);
    assert_eq!(editor.diagnostics_of("x.sim"), Vec::<Value>::new());
    // The editor's text of the world differs from the file on disk.
    editor.open("a.wld", "floor 2000\n");
    assert_ne!(editor.diagnostics_of("a.wld"), Vec::<Value>::new());
    assert_eq!(editor.end(), Some(0));
}

#[test]
fn mistakes_of_named_files_appear_in_those_files() {
    let mut editor = Editor::start(&[("a.wld", "floor 2000 2000\nush 1 2 3\n"), ("drive.c", "")], &json!(["utf-8"]));
    editor.open("x.sim", SIM);
    let of_world = editor.diagnostics_of("a.wld");
    assert_eq!(of_world.len(), 1);
    assert_eq!(
        of_world[0]["range"],
        json!({ "start": { "line": 1, "character": 0 }, "end": { "line": 1, "character": 3 } })
    );
    std::fs::write(editor.folder.path().join("a.wld"), WORLD).expect("a file");
    let uri = editor.uri("a.wld");
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(editor.diagnostics_of("a.wld"), Vec::<Value>::new());
    assert_eq!(editor.end(), Some(0));
}

#[test]
fn words_are_completed_explained_and_linked_to_their_files() {
    let scene = "[world]\nfile = \"a.wld\"\n\n[[robot]]\ntype = \"S4\"\n\n[[check]]\nkind = \"reach\"\n";
    let mut editor = Editor::start(&[("a.wld", WORLD), ("drive.c", "")], &json!(null));
    editor.open("x.sim", SIM);
    editor.open("x.scene.toml", scene);
    // Mail programs add `.txt`.
    editor.open("y.sim.txt", "wrld a.wld\n");
    assert_ne!(editor.diagnostics_of("y.sim.txt"), Vec::<Value>::new());
    editor.open("y.scene.toml.txt", scene);
    assert_eq!(editor.labels("y.scene.toml.txt", 5, 0), editor.labels("x.scene.toml", 5, 0));
    let first = editor.labels("x.sim", 0, 2);
    assert!(first.iter().any(|label| label == "world") && first.iter().any(|label| label == "LabBot"), "{first:?}");
    let files = editor.labels("x.sim", 0, 8);
    assert!(files.iter().any(|label| label == "a.wld"), "{files:?}");
    let keys = editor.labels("x.scene.toml", 5, 0);
    assert!(keys.iter().any(|label| label == "x_mm") && !keys.iter().any(|label| label == "type"), "{keys:?}");
    let keys = editor.labels("x.scene.toml", 8, 0);
    assert!(keys.iter().any(|label| label == "by_s"), "{keys:?}");
    let hover = editor.at("textDocument/hover", "x.sim", 0, 1);
    assert!(hover["contents"]["value"].as_str().expect("a text").contains("the world"), "{hover}");
    for (name, line, character) in [("x.sim", 0, 8), ("x.scene.toml", 1, 10)] {
        let target = editor.at("textDocument/definition", name, line, character);
        assert_eq!(target["uri"], editor.uri("a.wld"), "{name}");
    }
    let program = editor.at("textDocument/definition", "x.sim", 1, 16);
    assert_eq!(program["uri"], editor.uri("drive.c"));
    assert_eq!(editor.end(), Some(0));
}

#[test]
fn invalid_requests_of_clients_do_no_harm() {
    let mut editor = Editor::start(&[("Cargo.toml", "")], &json!(["utf-16", "utf-32"]));
    assert_eq!(editor.ask("textDocument/rename", json!({}))["code"], -32601);
    assert_eq!(editor.ask("textDocument/hover", json!({ "what": 1 }))["code"], -32602);
    assert_eq!(editor.at("textDocument/hover", "never-opened.sim", 3, 4), Value::Null);
    editor.tell("textDocument/didOpen", json!({ "no": "document" }));
    // A TOML file that is not for eyesim gets no diagnostics.
    editor.open("Cargo.toml", "[package]\nname = 1\n");
    assert_eq!(editor.diagnostics_of("Cargo.toml"), Vec::<Value>::new());
    editor.open("ü b.wld", "floor 1 1\nwörld 𝒜 1\n");
    assert_eq!(editor.diagnostics_of("ü b.wld").len(), 1);
    assert!(editor.at("textDocument/completion", "ü b.wld", 999, 999).is_array());
    // Without `shutdown` the protocol requires a failure as the exit code.
    editor.tell("exit", Value::Null);
    assert_eq!(editor.server.wait().expect("the process ends").code(), Some(1));
}

#[test]
fn huge_messages_are_refused_from_their_header() {
    for greets in [false, true] {
        let mut server = Command::new(eyesim_path())
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("a server");
        let mut input = server.stdin.take().expect("its input");
        if greets {
            let text = json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": { "capabilities": {} } })
                .to_string();
            write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("it listens");
        }
        input.write_all(b"content-length: 67108865\r\n\r\n").expect("it listens");
        // The input stays open.
        let output = server.wait_with_output().expect("the process ends");
        let message = String::from_utf8(output.stderr).expect("text");
        assert_eq!(message, "error: standard input: a message of 67108865 bytes, expected at most 67108864\n");
        assert_eq!(output.status.code(), Some(2));
        drop(input);
    }
}
