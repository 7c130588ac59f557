//! The user's programs that judge a run: they read the report and the trace, and print a verdict in JSON.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use parking_lot::Mutex;
use serde::Deserialize;
use serde_json::Value;
use sim_core::spec::CheckKind;

use super::Verdict;
use crate::executive::interrupt::Interrupt;
use crate::program::Tools;
use crate::program::command::{CommandLimits, output_within};
use crate::record::EventStore;

/// Maximum number of bytes that a program may print.
const MAX_OUTPUT: usize = 1 << 20;
/// Maximum number of characters of a program's message, and of quotations from its output.
const MAX_MESSAGE: usize = 400;

/// Data of a finished run that programs may read.
#[derive(Clone, Copy)]
pub struct Evidence<'r> {
    /// Events of the run.
    pub events: &'r Mutex<EventStore>,
    /// Ends programs that are running.
    pub interrupt: &'r Interrupt,
    /// True if check programs may run: the scene is the user's own.
    pub may_run_checks: bool,
}

/// The last line that a program prints on its standard output.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    passed: bool,
    points: Option<f64>,
    message: Option<String>,
    at_s: Option<f64>,
}

/// Path of a check's program.
///
/// # Errors
/// The program cannot be started.
pub fn path_of(folder: &str, program: &str) -> Result<PathBuf, String> {
    let path = Path::new(folder).join(program);
    command(&path).map(|_| path).map_err(|why| format!("`{program}` {why}"))
}

/// The command that runs the program at `path`.
fn command(path: &Path) -> Result<Command, String> {
    let metadata = fs::metadata(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => "does not exist".to_owned(),
        _ => format!("cannot be read: {error}"),
    })?;
    if !metadata.is_file() {
        return Err("is not a file".to_owned());
    }
    let path = std::path::absolute(path).map_err(|error| error.to_string())?;
    let mut head = Vec::new();
    let read = File::open(&path).and_then(|file| file.take(256).read_to_end(&mut head));
    read.map_err(|error| format!("cannot be read: {error}"))?;
    let head = String::from_utf8_lossy(&head);
    let interpreter_line = head.lines().next().and_then(|line| line.strip_prefix("#!")).unwrap_or_default().trim();
    let mut command = if path.extension().is_some_and(|extension| extension == "py") {
        let mut command = Command::new(Tools::of_environment().python.unwrap_or_else(|| "python3".into()));
        // Keeps Python from writing bytecode files beside the program.
        command.arg("-B").arg(&path);
        command
    } else if !interpreter_line.is_empty() {
        // Archives may lose the executable bit, without which the kernel refuses to run the program.
        let (interpreter, argument) =
            interpreter_line.split_once(char::is_whitespace).unwrap_or((interpreter_line, ""));
        let mut command = Command::new(interpreter);
        command.args(Some(argument.trim()).filter(|argument| !argument.is_empty())).arg(&path);
        command
    } else if metadata.permissions().mode() & 0o111 != 0 {
        Command::new(&path)
    } else {
        return Err("cannot be started: expected a program in Python (NAME.py), one that begins with `#!`, or one that may be executed (chmod +x)".to_owned());
    };
    command.env("PYTHONHASHSEED", "0");
    Ok(command)
}

/// Runs the program of a check of this kind and reads its verdict; `report` is the report of the run.
///
/// # Errors
/// The program does not print a verdict.
pub(super) fn judge(
    kind: &CheckKind,
    max_points: f64,
    report: &Value,
    evidence: Option<Evidence<'_>>,
) -> Result<Verdict, String> {
    let CheckKind::Script { program, arguments, timeout, folder } = kind else {
        return Err("it was not evaluated".to_owned());
    };
    let Evidence { events, interrupt, may_run_checks } = evidence.ok_or("it was not evaluated")?;
    let name = &program.text;
    if !may_run_checks {
        return Err(format!("`{name}` of the archive was not run: `--allow-execute` allows it"));
    }
    let mut command = command(&Path::new(folder).join(name)).map_err(|why| format!("`{name}` {why}"))?;
    let (_files, paths) = write_evidence(report, events)
        .map_err(|why| format!("report and trace for `{name}` cannot be written: {why}"))?;
    if !folder.is_empty() {
        command.current_dir(folder);
    }
    command.args(arguments).args(paths);
    let is_cancelled = || interrupt.is_set();
    let timeout = Duration::from_secs_f64(timeout.seconds());
    let limits = CommandLimits { timeout, max_output: MAX_OUTPUT, is_cancelled: &is_cancelled };
    let output = output_within(&mut command, &limits).map_err(|error| match error.kind() {
        io::ErrorKind::TimedOut | io::ErrorKind::FileTooLarge | io::ErrorKind::Interrupted => {
            format!("`{name}` gave no verdict: {error}")
        }
        _ => format!("`{name}` cannot be started: {error}"),
    })?;
    let [stdout, stderr] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    let last_line =
        |text: &str| text.lines().rev().find(|line| !line.trim().is_empty()).map(|line| truncated(line.trim()));
    if !output.status.success() {
        let reason = last_line(&stderr).map(|line| format!(": {line}")).unwrap_or_default();
        return Err(format!("`{name}` gave no verdict: it ended with {}{reason}", output.status));
    }
    let line = last_line(&stdout).ok_or_else(|| format!("`{name}` printed no verdict; expected {EXPECTED}"))?;
    let answer = stdout.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default().trim();
    let answer: Answer = serde_json::from_str(answer).map_err(|error| {
        format!("the last line of `{name}` is not a verdict: {error}; expected {EXPECTED}, found `{line}`")
    })?;
    let fraction = match answer.points {
        None => f64::from(u8::from(answer.passed)),
        Some(points) if !(0.0..=max_points).contains(&points) => {
            return Err(format!("`{name}` gives {points} points; expected 0 to {max_points}"));
        }
        Some(_) if max_points == 0.0 => 0.0,
        Some(points) => points / max_points,
    };
    let message = answer.message.unwrap_or_else(|| if answer.passed { "passed" } else { "not passed" }.to_owned());
    let at = answer.at_s.filter(|at| *at >= 0.0);
    Ok(Verdict { fraction, at, ..Verdict::new(answer.passed, truncated(&message)) })
}

const EXPECTED: &str = r#"a line such as {"passed": true, "points": 2, "message": "..."}"#;

fn truncated(text: &str) -> String {
    text.chars().take(MAX_MESSAGE).collect()
}

/// Writes the report and the trace into a new temporary folder. Returns the folder, which is removed when it is
/// dropped, and the paths of both files.
fn write_evidence(report: &Value, events: &Mutex<EventStore>) -> Result<(tempfile::TempDir, [PathBuf; 2]), String> {
    let trace = EventStore::trace(events).map_err(|error| error.to_string())?;
    let folder = tempfile::Builder::new().prefix("eyesim-check-").tempdir().map_err(|error| error.to_string())?;
    let paths = ["report.json", "trace.jsonl"].map(|name| folder.path().join(name));
    let texts = [report.to_string().into_bytes(), trace];
    for (path, text) in paths.iter().zip(&texts) {
        fs::write(path, text).map_err(|error| error.to_string())?;
    }
    Ok((folder, paths))
}
