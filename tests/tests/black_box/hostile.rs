//! The catalogue of hostile programs: the simulator ends each in time, reports it, and no other robot's record changes.
//!
//! `cargo test` runs a sample. `EYESIM_HOSTILE=all cargo test --workspace --test black_box hostile::` runs all programs in
//! processes, on threads and on fibers. `INSTA_UPDATE=always` also writes docs/hostile.md, the table of their messages.

mod cases;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cases::{Case, Language};
use serde_json::Value;
use tests::{Scratch, eyesim_path, root, write_package, write_scene};

/// Real time in seconds after which a run counts as hanging. A loaded machine takes ten times as long as an idle one.
const HANGS_S: u64 = 100;

/// Programs that stop the whole process, as Ctrl-Z does. If such a program runs on a thread, no process remains that
/// could report it.
const ONLY_APART: [&str; 2] = ["raise(SIGSTOP)", "raise(SIGTSTP)"];

/// Result of a run with a hostile program as robot 2 of three.
#[derive(Debug)]
struct RunResult {
    code: Option<i32>,
    signal: Option<i32>,
    /// Outcome and reason of robot 2, or the last line that eyesim printed.
    text: String,
    /// The complete output.
    said: String,
    /// Poses of the other robots in the trace, one per line.
    others: Vec<String>,
    /// True if the trace ends like that of a complete run.
    has_end: bool,
    seconds: u64,
}

const GOOD: &str = "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWDriveTurn(vw, 1.5, 1); VWDriveWait(vw);\n\
                    VWDriveStraight(vw, 0.5, 0.05); VWDriveWait(vw); return 0; }\n";

fn file_of(language: Language) -> &'static str {
    match language {
        Language::C | Language::C7 => "bad.c",
        Language::Cpp => "bad.cpp",
        Language::Python => "bad.py",
        Language::Rust => "bad",
    }
}

/// The package with the Rust cases, written once.
fn rust_package() -> PathBuf {
    static WRITTEN: Mutex<Option<Scratch>> = Mutex::new(None);
    let mut written = WRITTEN.lock().expect("no test panics meanwhile");
    let scratch = written.get_or_insert_with(|| {
        let scratch = Scratch::new();
        write_package(&scratch, "bad", cases::RUST);
        scratch
    });
    scratch.path().join("bad")
}

/// Runs the case beside two good robots, within limits and, if the machine permits it, in its own process namespace.
fn run(case: &Case, exec: &str) -> RunResult {
    let scratch = Scratch::new();
    scratch.write("good.c", GOOD);
    let package = (case.language == Language::Rust).then(rust_package);
    let bad = package.as_ref().map_or(file_of(case.language), |path| path.to_str().expect("UTF-8"));
    if package.is_none() {
        scratch.write(bad, &case.source);
    }
    write_scene(&scratch, &[]);
    // The other robots are too far away for the hostile robot to reach them.
    let scene = format!(
        "world room.wld\nrobi bot.robi good.c 600 600 0\nrobi bot.robi {bad} 2000 3600 0\nrobi bot.robi good.c 3400 600 0\n"
    );
    scratch.write("scene.sim", &scene);
    let mut args =
        vec!["run", "scene.sim", "--exec", exec, "--timeout", "0.5", "--until", "4", "--output-limit", "0.1"];
    args.extend(["--report", "r.json", "--trace", "t.jsonl", "--quiet"]);
    let rust_case = format!("2:{}", case.source);
    if package.is_some() {
        args.extend(["--args", &rust_case]);
    }
    // A process namespace protects the other processes of this machine from signals to all processes.
    let limits = "ulimit -c 0; ulimit -n 512; ulimit -v 6000000; ulimit -f 400000";
    let shell = format!(
        "{limits}; if unshare -p -f --mount-proc true 2>/dev/null; \
         then exec timeout -s KILL {HANGS_S} unshare -p -f --mount-proc --kill-child sh -c '\"$@\"; exit $?' sh \"$@\"; \
         else exec timeout -s KILL {HANGS_S} \"$@\"; fi"
    );
    let start = Instant::now();
    let mut command = Command::new("sh");
    command.args(["-c", &shell, "sh"]).arg(eyesim_path()).args(&args).current_dir(scratch.path()).stdin(Stdio::null());
    command.env(cases::CONSTRUCTOR, if package.is_some() { &case.source } else { "" });
    let output = command.output().expect("a shell");
    let seconds = start.elapsed().as_secs();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let said = text(&output.stdout) + &text(&output.stderr);
    let read = |name: &str| fs::read_to_string(scratch.path().join(name)).unwrap_or_default();
    let lines: Vec<Value> = read("t.jsonl").lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let is_of_others = |line: &&Value| line["event"] == "pose" && (line["robot"] == 1 || line["robot"] == 3);
    RunResult {
        code: output.status.code(),
        signal: output.status.signal(),
        text: in_words(&read("r.json"), &text(&output.stderr), &scratch),
        said,
        others: lines.iter().filter(is_of_others).map(ToString::to_string).collect(),
        has_end: lines.last().is_some_and(|line| line["event"] == "end"),
        seconds,
    }
}

/// Outcome and reason of robot 2 in the report, or else the last line that eyesim printed.
fn in_words(report: &str, stderr: &str, scratch: &Scratch) -> String {
    let report: Value = serde_json::from_str(report).unwrap_or_default();
    let robot = &report["robots"][1];
    let words = match robot["outcome"].as_str() {
        Some(outcome) => format!("{outcome}: {}", robot["reason"].as_str().unwrap_or_default()),
        None => stderr.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default().to_owned(),
    };
    let words = words.replace(&format!("{}/", scratch.path().display()), "");
    let words = without_kits(&words);
    without_chance(words.trim_end_matches([':', ' ']))
}

/// `words` without the folders of the shim's sources, which depend on the machine.
fn without_kits(words: &str) -> String {
    let is_kit = |word: &str| word.contains("/eyesim/kits/");
    let short = |word: &str| word.rsplit('/').next().unwrap_or_default().to_owned();
    words.split(' ').map(|word| if is_kit(word) { short(word) } else { word.to_owned() }).collect::<Vec<_>>().join(" ")
}

/// `words` with `...` in place of text that depends on the run: addresses above the program's first pages, and names of
/// temporary files.
fn without_chance(words: &str) -> String {
    let mut kept = String::with_capacity(words.len());
    let mut rest = words;
    while let Some(start) =
        ["address 0x", "/.eyesim-"].iter().filter_map(|mark| Some(rest.find(mark)? + mark.len())).min()
    {
        let length = rest[start..].find(|letter: char| !letter.is_ascii_alphanumeric()).unwrap_or(rest.len() - start);
        let (before, after) = (&rest[..start], &rest[start + length..]);
        kept += before;
        kept += if length > 4 { "..." } else { &rest[start..start + length] };
        rest = after;
    }
    kept + rest
}

/// Description of what is wrong with the result of a case; `None` if it is right.
fn mistake(case: &Case, result: &RunResult, reference: &[String]) -> Option<String> {
    let RunResult { code, text, said, others, has_end, seconds, .. } = result;
    let is_expected = |words: &&str| text.contains(*words) || said.contains(*words);
    let whole = *has_end && others == reference;
    if *seconds >= HANGS_S || *code == Some(137) && !has_end && said.is_empty() && *seconds >= HANGS_S / 2 {
        return Some("hangs".to_owned());
    }
    // If the program damaged the trace itself, its lines prove nothing; the exit code must report the damage.
    let is_trace_harmed = *code == Some(2);
    if !is_trace_harmed && !reference.starts_with(others) {
        return Some("changes another robot's record".to_owned());
    }
    if *code == Some(0) && !whole {
        return Some("ends with 0 without a whole record".to_owned());
    }
    if *code == Some(0) && !text.starts_with("finished") && !text.starts_with("running") {
        return Some("ends with 0 although the program failed".to_owned());
    }
    if *code != Some(0) && said.trim().is_empty() && result.signal.is_none() && *code != Some(137) {
        return Some("ends without a message".to_owned());
    }
    if said.contains('\x1b') || said.contains('\x07') {
        return Some("steers the terminal".to_owned());
    }
    let is_expected = case.expected.is_empty() || case.expected.iter().any(is_expected);
    (!is_expected && code.is_some_and(|code| code < 128)).then(|| format!("expected one of {:?}", case.expected))
}

/// Executors of a case, in the order of the table's columns.
fn flows(case: &Case) -> &'static [&'static str] {
    match case.language {
        Language::Python => &["process"],
        _ if ONLY_APART.contains(&case.name.as_str()) => &["process"],
        Language::C | Language::C7 => &["process", "thread", "fiber"],
        Language::Cpp | Language::Rust => &["process", "thread"],
    }
}

/// Runs the cases on all their executors; returns each case's message for each executor, and the mistakes.
fn run_all(cases: &[Case]) -> (Vec<Vec<String>>, Vec<String>) {
    let harmless = "#include \"eyebot.h\"\nint main(void) { OSWait(20); return 0; }\n".to_owned();
    let harmless = Case { class: "", name: String::new(), language: Language::C, source: harmless, expected: &[] };
    let reference = run(&harmless, "thread");
    assert!(reference.code == Some(0) && reference.has_end && reference.others.len() > 100, "{reference:#?}");
    let next = AtomicUsize::new(0);
    let results = Mutex::new((vec![Vec::new(); cases.len()], Vec::new()));
    let work = || {
        while let Some((index, case)) =
            Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, cases.get(at)?)))
        {
            for exec in flows(case) {
                let result = run(case, exec);
                let mut results = results.lock().expect("no run has panicked");
                if let Some(mistake) = mistake(case, &result, &reference.others) {
                    let said: String =
                        result.said.chars().rev().take(600).collect::<Vec<_>>().into_iter().rev().collect();
                    let line = format!(
                        "{} / {} ({exec}): {mistake}; exit code {:?}, {} s, reported `{}`\n{said}",
                        case.class, case.name, result.code, result.seconds, result.text
                    );
                    results.1.push(line);
                }
                let end = result.code.map_or("a signal".to_owned(), |code| code.to_string());
                results.0[index].push(format!("{end}: {}", result.text));
            }
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    results.into_inner().expect("no run has panicked")
}

fn has_python() -> bool {
    Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success())
}

/// The cases to run: by default every 20th and the first of each class, without Rust. `EYESIM_HOSTILE` selects all
/// (`all`), a class, or the cases whose names contain its value.
fn chosen() -> Vec<Case> {
    let filter = std::env::var("EYESIM_HOSTILE").unwrap_or_default();
    let mut classes = BTreeSet::new();
    let cases = cases::all().into_iter().enumerate().filter(|(index, case)| match filter.as_str() {
        "all" => true,
        "" => (classes.insert(case.class) || index % 20 == 0) && case.language != Language::Rust,
        part => case.class == part || case.name.contains(part),
    });
    cases.map(|(_, case)| case).filter(|case| case.language != Language::Python || has_python()).collect()
}

#[test]
fn hostile_programs_are_ended_in_time_and_reported_and_change_no_other_robot() {
    let cases = chosen();
    let (texts, mistakes) = run_all(&cases);
    let is_all = std::env::var("EYESIM_HOSTILE").is_ok_and(|wanted| wanted == "all");
    if is_all && std::env::var("INSTA_UPDATE").is_ok_and(|how| how == "always") {
        fs::write(root().join("docs/hostile.md"), page(&cases, &texts)).expect("the page can be written");
    }
    assert!(mistakes.is_empty(), "{} of {} cases:\n{}", mistakes.len(), cases.len(), mistakes.join("\n\n"));
}

#[test]
fn the_page_lists_every_case() {
    let cases = cases::all();
    assert!(cases.len() >= 185, "{}", cases.len());
    let names: BTreeSet<(&str, &str)> = cases.iter().map(|case| (case.class, case.name.as_str())).collect();
    assert_eq!(names.len(), cases.len(), "each name once");
    let page = fs::read_to_string(root().join("docs/hostile.md")).expect("the page");
    let missing: Vec<_> =
        cases.iter().filter(|case| !page.contains(&format!("| {} | {} |", case.class, case.name))).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

/// The text of docs/hostile.md.
fn page(cases: &[Case], texts: &[Vec<String>]) -> String {
    let mut page = String::from(
        "# Hostile programs\n\n\
         Each robot program of this table runs as robot 2 between two robots with correct programs (`--timeout 0.5`). It\n\
         runs three times: in its own process, on a thread of `eyesim`, and on a fiber of `eyesim` (only programs in C; on a thread\n\
         if the program cannot run on a fiber). No run hangs, no run ends with exit code 0 without a complete trace, and no run changes the trace of another\n\
         robot. A cell gives the exit code of `eyesim`, then the outcome of robot 2 and its reason.\n\n\
         `--exec auto`, the default, chooses a process for programs whose imports show that they could end or stop `eyesim`. On a\n\
         thread or fiber (`--exec thread` or `fiber`) such a program may end `eyesim` with a signal. Programs that stop their\n\
         process (`raise(SIGSTOP)`) are therefore not run on threads and fibers.\n\n\
         `EYESIM_HOSTILE=all INSTA_UPDATE=always cargo test --workspace --test black_box hostile::` writes the table; the programs are in\n\
         `tests/tests/black_box/hostile/cases.rs`.\n\n\
         | class | program | in a process | on a thread | on a fiber |\n|---|---|---|---|---|\n",
    );
    for (case, texts) in cases.iter().zip(texts) {
        let cell = |index: usize| texts.get(index).map_or("", String::as_str).replace('|', "\\|").replace('<', "&lt;");
        let _ = writeln!(page, "| {} | {} | {} | {} | {} |", case.class, case.name, cell(0), cell(1), cell(2));
    }
    page
}
