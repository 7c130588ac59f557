//! VS Code: the problem matchers that `eyesim new` writes find the mistakes in a run's output, and the debugger stops
//! in a program.

use std::process::Command;

use serde_json::Value;
use tests::Scratch;

/// Creates a new program in the folder `maze` and changes it: file, old text, new text.
fn project(scratch: &Scratch, lang: &str, changes: &[(&str, &str, &str)]) {
    let ran = scratch.eyesim(&["new", "maze", "--lang", lang, "--api", "7"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for (name, old, new) in changes {
        let name = format!("maze/{name}");
        let text = scratch.read(&name);
        assert!(text.contains(old), "{name} has `{old}`");
        scratch.write(&name, &text.replacen(old, new, 1));
    }
}

fn json(scratch: &Scratch, name: &str) -> Value {
    serde_json::from_str(&scratch.read(name)).expect("JSON")
}

/// Returns true if a command is installed.
fn is_there(command: &str) -> bool {
    Command::new(command).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Problems that the matchers of the task `label` find in its terminal output, as `FILE:LINE SEVERITY MESSAGE`.
fn problems(scratch: &Scratch, label: &str) -> Vec<String> {
    let tasks = json(scratch, "maze/.vscode/tasks.json");
    let task = tasks["tasks"].as_array().expect("tasks").iter().find(|task| task["label"] == label).expect("the task");
    let words = task["args"].as_array().expect("arguments").iter().map(|word| word.as_str().expect("a word"));
    let line = [&[task["command"].as_str().expect("a command")], &words.collect::<Vec<_>>()[..]].concat().join(" ");
    // VS Code runs tasks in a terminal, where eyesim prints for humans unless the task's environment forbids it.
    let mut command = Command::new("script");
    command.args(["-q", "-c", &line, "/dev/null"]).current_dir(scratch.path().join("maze"));
    for (name, value) in tasks["options"]["env"].as_object().expect("an environment") {
        command.env(name, value.as_str().expect("text"));
    }
    let output = command.output().expect("script, of util-linux, runs");
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let found = Command::new("node").args(["-e", MATCH, &task["problemMatcher"].to_string(), &printed]).output();
    let found = found.expect("node runs");
    assert!(found.status.success(), "{found:?}");
    let lines: Vec<String> = String::from_utf8_lossy(&found.stdout).lines().map(str::to_owned).collect();
    assert!(!lines.is_empty(), "no problem in {printed}");
    lines
}

/// Applies matchers like VS Code: each matcher to each line; of a matcher with several patterns, the next pattern to
/// the next line.
const MATCH: &str = r"
const matchers = [].concat(JSON.parse(process.argv[1])), lines = process.argv[2].split(/\r?\n/);
for (let start = 0; start < lines.length; start++)
  for (const matcher of matchers) {
    const problem = { severity: matcher.severity };
    const fits = [].concat(matcher.pattern).every((pattern, index) => {
      const found = new RegExp(pattern.regexp).exec(lines[start + index] ?? '');
      for (const part of ['file', 'line', 'severity', 'message'])
        if (found && pattern[part]) problem[part] = found[pattern[part]];
      return found;
    });
    if (fits) console.log(`${problem.file}:${problem.line} ${problem.severity} ${problem.message}`);
  }
";

/// The problems of a C program with `changes`.
fn of_c(label: &str, changes: &[(&str, &str, &str)]) -> Option<Vec<String>> {
    if !is_there("node") || !is_there("script") {
        println!("skipped: needs node and script");
        return None;
    }
    let scratch = Scratch::new();
    project(&scratch, "c", changes);
    Some(problems(&scratch, label))
}

#[test]
fn mistakes_in_a_program_are_found() {
    let Some(found) = of_c("run", &[("maze.c", "VWWait();", "VWWait()")]) else { return };
    assert!(found[0].starts_with("maze.c:") && found[0].contains(" error expected ';'"), "{found:?}");
    let Some(found) = of_c("run", &[("maze.c", "eyebot.h", "eyebott.h")]) else { return };
    assert!(found[0].starts_with("maze.c:2 error "), "{found:?}");
}

#[test]
fn mistakes_in_a_scene_are_found() {
    for label in ["run", "check"] {
        let Some(found) = of_c(label, &[("maze.sim", "S4", "S5")]) else { return };
        assert_eq!(found, ["maze.sim:4 error there is no type `S5`; write `S4`"]);
    }
}

#[test]
fn faults_of_a_program_are_found() {
    let Some(found) = of_c("run", &[("maze.c", "int wall,", "int *nowhere = 0;\n  *nowhere = 3;\n  int wall,")]) else {
        return;
    };
    assert_eq!(found, ["maze.c:9 error null pointer used (segmentation fault at address 0x0)"]);
}

#[test]
fn mistakes_in_python_are_found() {
    if !is_there("node") || !is_there("script") || !is_there("python3") {
        println!("skipped: needs node, script and python3");
        return;
    }
    let scratch = Scratch::new();
    project(&scratch, "python", &[("maze.py", "VWWait()", "VWWat()")]);
    let found = problems(&scratch, "run");
    assert!(
        found[0].starts_with("maze.py:") && found[0].contains("NameError: name 'VWWat' is not defined"),
        "{found:?}"
    );
    assert!(!scratch.path().join("maze/.vscode/launch.json").exists(), "gdb knows nothing of Python");
}

#[test]
fn mistakes_in_rust_are_found() {
    if !is_there("node") || !is_there("script") {
        println!("skipped: needs node and script");
        return;
    }
    let scratch = Scratch::new();
    // Without the dependency, the compiler finds the first mistake in less than half a minute.
    project(&scratch, "rust", &[("Cargo.toml", "robios-api =", "# robios-api =")]);
    let found = problems(&scratch, "run");
    assert!(found[0].starts_with("src/lib.rs:") && found[0].contains(" error "), "{found:?}");
}

#[test]
fn the_editor_s_debugger_stops_in_a_program() {
    if !is_there("gdb") {
        println!("skipped: needs gdb");
        return;
    }
    let scratch = Scratch::new();
    project(&scratch, "c", &[]);
    let launch = json(&scratch, "maze/.vscode/launch.json");
    let graphic = &launch["configurations"][1];
    let text = |value: &Value| value.as_str().expect("text").to_owned();
    let mut gdb = Command::new("gdb");
    gdb.args(["-batch", "-nx"]).current_dir(scratch.path().join("maze"));
    for setup in graphic["setupCommands"].as_array().expect("commands") {
        gdb.args(["-ex", &text(&setup["text"])]);
    }
    gdb.args(["-ex", "break maze.c:18", "-ex", "run", "-ex", "print wall", "--args", &text(&graphic["program"])]);
    gdb.args(graphic["args"].as_array().expect("arguments").iter().map(text));
    let output = gdb.output().expect("gdb runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(printed.contains("maze.c:18") && printed.contains("$1 = 1"), "{printed}");
    // The configuration for a terminal is a shell command.
    let mut shell = Command::new("sh");
    let command = format!("{} -- -batch -ex 'print wall'", text(&launch["configurations"][0]["command"]));
    let output = shell.args(["-c", &command]).current_dir(scratch.path().join("maze")).output().expect("sh runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(printed.contains("main () at maze.c:"), "{printed}{}", String::from_utf8_lossy(&output.stderr));
}
