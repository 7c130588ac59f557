//! `eyesim sweep`: rows depend only on the case, even if a sweep is stopped and continued; damaged files.
//!
//! `EYESIM_SWEEP_CASES=5000` sets the number of cases in the test with `kill -9`.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tests::{Ran, Scratch};

const SCENE: &str = r#"[world]
floor_mm = [3000, 2000]
wall = [{ from_mm = [0, 0], to_mm = [3000, 0] }, { from_mm = [0, 2000], to_mm = [3000, 2000] }]

[[robot]]
type = "S4"
x_mm = 500
y_mm = 500
"#;

/// Drives along a side and back, and prints its odometry.
const PROGRAM: &str = r#"#include "eyebot.h"
#include "speed.h"
int main() {
    int x, y, phi;
    VWStraight(1000, SPEED);
    VWWait();
    VWTurn(180, 90);
    VWWait();
    VWStraight(1000, SPEED);
    VWWait();
    VWGetPosition(&x, &y, &phi);
    printf("METRIC x_mm=%d\n", x);
    return 0;
}
"#;

const HEADER: &str = "#define SPEED 400\n";

/// Writes a suite with `cases` cases, some of which fail.
fn suite(cases: usize) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.scene.toml", SCENE);
    scratch.write("square.c", PROGRAM);
    scratch.write("speed.h", HEADER);
    let seeds = cases / 2;
    let text = format!(
        "[suite]\nscene = \"room.scene.toml\"\nprograms = [\"1=square.c\"]\n[matrix]\nnoise = [\"none\", \"harsh\"]\nseed = \"1..{seeds}\"\n\
         [[check]]\nname = \"comes back\"\nkind = \"visits\"\nplaces_mm = [[1500, 500], [500, 500]]\nwithin_mm = 60\n"
    );
    scratch.write("a.suite.toml", &text);
    scratch
}

/// Runs `eyesim sweep`, which must end with this exit code.
fn sweep(scratch: &Scratch, args: &[&str], code: i32) -> Ran {
    let ran = scratch.eyesim(&[&["sweep"], args].concat());
    assert_eq!(ran.code, Some(code), "{args:?}: {ran:#?}");
    ran
}

/// Runs `eyesim sweep` on the suite, with output into a folder.
fn into(scratch: &Scratch, folder: &str, args: &[&str]) -> Ran {
    sweep(scratch, &[&["a.suite.toml", "-o", folder], args].concat(), 0)
}

/// Merges the rows of a folder.
fn merged(scratch: &Scratch, folder: &str) -> String {
    sweep(scratch, &["merge", folder, "-o", "merged.jsonl"], 0);
    scratch.read("merged.jsonl")
}

fn rows(scratch: &Scratch, folder: &str) -> Vec<Value> {
    merged(scratch, folder).lines().map(|line| serde_json::from_str(line).expect("a row")).collect()
}

const WHOLE: &str = "rows-1-of-1.jsonl";

fn file_of(folder: &str) -> String {
    format!("{folder}/{WHOLE}")
}

/// Starts a sweep and waits until its file has `lines` lines.
fn start(scratch: &Scratch, folder: &str, args: &[&str], lines: usize) -> Child {
    let mut command = scratch.command(&[&["sweep", "a.suite.toml", "-o", folder], args].concat());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("eyesim starts");
    let path = scratch.path().join(file_of(folder));
    let begin = Instant::now();
    loop {
        let has = fs::read(&path).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count());
        if has >= lines || child.try_wait().expect("a child").is_some() {
            return child;
        }
        assert!(begin.elapsed() < Duration::from_secs(300), "{has} of {lines} lines");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill").success());
}

#[test]
fn rows_are_those_of_the_test() {
    let scratch = suite(12);
    let ran = into(&scratch, "out", &[]);
    assert!(
        ran.stdout.starts_with("12 of 12 cases have rows in out/rows-1-of-1.jsonl: ")
            && ran.stdout.contains(" failed, in "),
        "{ran:#?}"
    );
    assert_eq!(scratch.eyesim(&["test", "a.suite.toml", "-q", "--report", "r.json"]).code, Some(1));
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let mut expected = report["suites"][0]["rows"].as_array().expect("rows").clone();
    // The order of merged rows is that of their values: `harsh` before `none`.
    expected.rotate_left(6);
    assert_eq!(rows(&scratch, "out"), expected);
    let before = scratch.read(&file_of("out"));
    let ran = into(&scratch, "out", &[]);
    assert!(ran.stderr.contains("12 of 12 cases have their rows already"), "{ran:#?}");
    assert_eq!(scratch.read(&file_of("out")), before);
}

#[test]
fn rows_do_not_depend_on_shards_processes_or_workers() {
    let scratch = suite(120);
    into(&scratch, "one", &["-j", "1"]);
    let expected = merged(&scratch, "one");
    assert_eq!(expected.lines().count(), 120);
    into(&scratch, "two", &["-j", "2"]);
    assert_eq!(merged(&scratch, "two"), expected);
    into(&scratch, "apart", &["-j", "2", "--isolate"]);
    assert_eq!(merged(&scratch, "apart"), expected);
    // Four sweeps run at a time, all with the same output folder.
    let mut running: Vec<Child> = Vec::new();
    for index in 1..=100 {
        let shard = format!("{index}/100");
        let mut command = scratch.command(&["sweep", "a.suite.toml", "-o", "many", "-j", "1", "--shard", &shard]);
        running.push(command.stdout(Stdio::null()).spawn().expect("eyesim starts"));
        if running.len() == 4 || index == 100 {
            assert!(running.drain(..).all(|mut child| child.wait().expect("the process ends").success()), "{shard}");
        }
    }
    assert_eq!(merged(&scratch, "many"), expected);
    let ran = sweep(&scratch, &["status", "many"], 0);
    assert!(ran.stdout.starts_with("120 of 120 cases have rows: "), "{ran:#?}");
}

#[test]
fn programs_in_processes_of_their_own_give_the_same_rows() {
    let scratch = suite(6);
    let python = "from eye import *\nVWStraight(1000, 400)\nVWWait()\nVWTurn(180, 90)\nVWWait()\nVWStraight(1000, 400)\nVWWait()\n\
                  x, y, phi = VWGetPosition()\nprint(f'METRIC x_mm={x}')\n";
    scratch.write("square.py", python);
    into(&scratch, "c", &[]);
    into(&scratch, "isolated", &["--isolate"]);
    assert_eq!(rows(&scratch, "isolated"), rows(&scratch, "c"));
    let text = scratch.read("a.suite.toml").replace("square.c", "square.py");
    scratch.write("a.suite.toml", &text);
    into(&scratch, "python", &[]);
    // Digests depend on the name of the program.
    let of = |folder| {
        let rows = rows(&scratch, folder);
        rows.iter().map(|row| (row["case"].clone(), row["outcome"].clone(), row["points"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(of("python"), of("c"));
}

#[test]
fn kill_9_and_a_torn_line_lose_nothing() {
    let cases = std::env::var("EYESIM_SWEEP_CASES").map_or(300, |cases| cases.parse().expect("a number"));
    let scratch = suite(cases);
    into(&scratch, "whole", &[]);
    for part in 1..=3 {
        let mut child = start(&scratch, "out", &["-j", "2"], part * cases / 20);
        assert!(child.try_wait().expect("a child").is_none(), "the sweep was over before it was killed");
        signal(&child, "-KILL");
        child.wait().expect("the process ends");
    }
    // Simulates a loss of power, which cuts off the end of a file.
    let path = scratch.path().join(file_of("out"));
    let file = fs::File::options().write(true).open(&path).expect("the file");
    file.set_len(fs::metadata(&path).expect("the file").len() - 40).expect("a shorter file");
    let ran = into(&scratch, "out", &[]);
    assert_eq!(ran.stderr.matches("the last line was incomplete").count(), 1, "{ran:#?}");
    assert!(ran.stderr.contains(&format!("of {cases} cases have their rows already")), "{ran:#?}");
    assert_eq!(merged(&scratch, "out"), merged(&scratch, "whole"));
    let lines = scratch.read(&file_of("out")).lines().count();
    assert_eq!(lines, cases + 1, "no case ran twice");
}

#[test]
fn sigterm_and_ctrl_c_end_with_130() {
    let scratch = suite(400);
    for (name, lines) in [("-TERM", 20), ("-INT", 60)] {
        let child = start(&scratch, "out", &["-j", "1"], lines);
        signal(&child, name);
        let ran = Ran::from(child.wait_with_output().expect("the process ends"));
        assert_eq!(ran.code, Some(130), "{ran:#?}");
        assert!(ran.stderr.contains("interrupted: ") && ran.stderr.contains("the same command continues"), "{ran:#?}");
        assert!(scratch.read(&file_of("out")).ends_with("}\n"), "whole lines");
    }
    sweep(&scratch, &["status", "out"], 1);
    into(&scratch, "out", &[]);
    assert_eq!(rows(&scratch, "out").len(), 400);
}

#[test]
fn the_same_suite_from_elsewhere_has_the_same_keys() {
    let scratch = suite(4);
    into(&scratch, "out", &[]);
    let here = sweep(&scratch, &["plan", "a.suite.toml"], 0);
    let elsewhere = sweep(&Scratch::new(), &["plan", &scratch.path().join("a.suite.toml").display().to_string()], 0);
    assert_eq!(here.stdout, elsewhere.stdout);
    let first: Value = serde_json::from_str(here.stdout.lines().next().expect("a case")).expect("a line");
    let row = rows(&scratch, "out").into_iter().find(|row| row["case"] == first["case"]).expect("its row");
    assert_eq!(row["key"], first["key"]);
    // A single case, selected by its key or by its name.
    for word in [&first["key"], &first["case"]] {
        let ran = sweep(&scratch, &["case", "a.suite.toml", word.as_str().expect("a word")], 0);
        assert_eq!(serde_json::from_str::<Value>(&ran.stdout).expect("a row"), row);
    }
    let ran = sweep(&scratch, &["case", "a.suite.toml", "0123"], 2);
    assert!(ran.stderr.contains("`0123` is neither a key nor a case"), "{ran:#?}");
}

#[test]
fn a_changed_suite_does_not_mix_with_old_rows() {
    let scratch = suite(4);
    into(&scratch, "out", &[]);
    let before = scratch.read(&file_of("out"));
    let text = scratch.read("a.suite.toml");
    let refused = || {
        let ran = sweep(&scratch, &["a.suite.toml", "-o", "out"], 2);
        assert!(
            ran.stderr.contains("out/rows-1-of-1.jsonl:2: the row of `") && ran.stderr.contains("nor are 3 others"),
            "{ran:#?}"
        );
        assert_eq!(scratch.read(&file_of("out")), before, "nothing is lost");
    };
    scratch.write("a.suite.toml", &text.replace("within_mm = 60", "within_mm = 61"));
    refused();
    scratch.write("a.suite.toml", &format!("{text}[limits]\nprocessor_s = 30\n"));
    refused();
    scratch.write("a.suite.toml", &text);
    scratch.write("square.c", &PROGRAM.replace("180, 90", "180, 80"));
    refused();
    scratch.write("square.c", PROGRAM);
    scratch.write("speed.h", &HEADER.replace("400", "300"));
    refused();
    scratch.write("speed.h", HEADER);
    // A suite with more seeds continues.
    scratch.write("a.suite.toml", &text.replace("1..2", "1..3"));
    let ran = into(&scratch, "out", &[]);
    assert!(ran.stderr.contains("4 of 6 cases have their rows already"), "{ran:#?}");
    // With more seeds, other cases belong to a shard. The rows of the old ones remain valid.
    scratch.write("a.suite.toml", &text);
    for shard in ["1/2", "2/2"] {
        into(&scratch, "shards", &["--shard", shard]);
    }
    scratch.write("a.suite.toml", &text.replace("1..2", "1..3"));
    into(&scratch, "shards", &["--shard", "1/2"]);
    let ran = sweep(&scratch, &["status", "shards"], 1);
    assert!(ran.stdout.contains("5 of 6 cases have rows") && ran.stdout.contains("shard 2/2: 2 of 3"), "{ran:#?}");
    into(&scratch, "shards", &["--shard", "2/2"]);
    sweep(&scratch, &["status", "shards"], 0);
    assert_eq!(merged(&scratch, "shards"), merged(&scratch, "out"));
    // The file of this suite contains the rows of another suite.
    let other = suite(8);
    into(&other, "out", &[]);
    fs::copy(other.path().join(file_of("out")), scratch.path().join(file_of("out"))).expect("a copy");
    sweep(&scratch, &["a.suite.toml", "-o", "out"], 2);
}

#[test]
fn malformed_files_are_reported() {
    let scratch = suite(4);
    into(&scratch, "out", &[]);
    let good = scratch.read(&file_of("out"));
    let reports = |text: &str, what: &str| {
        scratch.write(&file_of("out"), text);
        for args in [&["a.suite.toml", "-o", "out"][..], &["status", "out"], &["merge", "out", "-o", "m.csv"]] {
            let ran = sweep(&scratch, args, 2);
            assert!(ran.stderr.contains("out/rows-1-of-1.jsonl") && ran.stderr.contains(what), "{what}: {ran:#?}");
        }
        assert_eq!(scratch.read(&file_of("out")), text, "the file is left as it is");
    };
    let mut lines: Vec<&str> = good.lines().collect();
    lines[2] = &lines[2][..100];
    reports(&(lines.join("\n") + "\n"), ":3:100: EOF while parsing");
    reports(&good.replace(env!("CARGO_PKG_VERSION"), "0.0.1"), "the rows are of eyesim 0.0.1");
    reports("milk, bread\n", ":1:1: the file does not begin with a sweep header");
    reports("milk, bread", ":1:1: the file does not begin with a sweep header");
    reports(&good.replace("\"schema\":1", "\"schema\":2"), "the row is of schema 2, not 1");
    reports(&good.replace("\"outcome\":\"passed\"", "\"outcome\":\"splendid\""), "unknown variant `splendid`");
    // An edited key differs from the key of the case.
    scratch.write(&file_of("out"), &good.replace("\"key\":\"", "\"key\":\"f"));
    assert!(sweep(&scratch, &["a.suite.toml", "-o", "out"], 2).stderr.contains("is not of this suite"));
    // A truncated first line.
    scratch.write(&file_of("out"), "{\"swe");
    assert!(into(&scratch, "out", &[]).stderr.contains("the last line was incomplete"));
    assert_eq!(scratch.read(&file_of("out")).lines().count(), 5);
}

#[test]
fn wrong_arguments_and_positions_are_reported() {
    let scratch = suite(4);
    let reports = |args: &[&str], what: &str| {
        let ran = sweep(&scratch, args, 2);
        assert!(ran.stderr.contains(what), "{what}: {ran:#?}");
    };
    for shard in ["0/0", "3/2", "0/2", "1", "x/2"] {
        reports(&["a.suite.toml", "-o", "out", "--shard", shard], "expected I/N with I from 1 to N");
    }
    reports(&["a.suite.toml"], "--output");
    reports(&[], "eyesim sweep");
    reports(&["a.suite.toml", "-o", "square.c"], "`square.c` is not a folder");
    reports(&["a.suite.toml", "-o", "/proc/out"], "/proc/out");
    reports(&["room.scene.toml", "-o", "out"], "is a scene");
    reports(&["a.zip", "-o", "out"], "is an archive: unpack it");
    reports(&["nowhere.suite.toml", "-o", "out"], "nowhere.suite.toml");
    reports(&["status", "nowhere"], "`nowhere`");
    fs::create_dir(scratch.path().join("empty")).expect("a folder");
    reports(&["status", "empty"], "has no rows of a sweep");
    reports(&["merge", "empty", "-o", "m.csv"], "has no rows of a sweep");
    assert!(Command::new("mkfifo").arg(scratch.path().join("empty").join(WHOLE)).status().expect("mkfifo").success());
    reports(&["status", "empty"], "is not a file");
    reports(&["a.suite.toml", "-o", "empty"], "is not a file");
    let text = scratch.read("a.suite.toml");
    scratch.write("a.suite.toml", &text.replace("seed = \"1..2\"", "seed = 1\nexclude = [{ seed = 1 }]"));
    reports(&["a.suite.toml", "-o", "out"], "leaves no case");
    scratch.write("a.suite.toml", &text);
    scratch.write("square.c", &PROGRAM.replace("VWWait();", "VWWait()"));
    reports(&["a.suite.toml", "-o", "out"], "cannot be run");
    reports(&["a.suite.toml", "-o", "out"], "square.c:6");
}

#[test]
fn a_full_disk_is_reported_and_the_sweep_continues() {
    let scratch = suite(600);
    sweep(&scratch, &["plan", "a.suite.toml"], 0);
    // A limit of 300 kB for files has the effect of a full disk.
    let command = format!("ulimit -f 300; exec {} sweep a.suite.toml -o out", tests::eyesim_path().display());
    let ran =
        Ran::from(Command::new("bash").args(["-c", &command]).current_dir(scratch.path()).output().expect("bash"));
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(
        ran.stderr.contains("out/rows-1-of-1.jsonl") && ran.stderr.contains("the same command continues"),
        "{ran:#?}"
    );
    into(&scratch, "out", &[]);
    assert_eq!(rows(&scratch, "out").len(), 600);
}

#[test]
fn two_sweeps_of_one_shard_at_once_are_reported() {
    let scratch = suite(4000);
    let mut first = start(&scratch, "out", &["-j", "1"], 2);
    signal(&first, "-STOP");
    let ran = sweep(&scratch, &["a.suite.toml", "-o", "out"], 2);
    assert!(ran.stderr.contains("another `eyesim sweep` runs this shard"), "{ran:#?}");
    // A different shard may run at the same time.
    sweep(&scratch, &["a.suite.toml", "-o", "out", "--shard", "4000/4000"], 0);
    assert!(first.try_wait().expect("a child").is_none(), "the first sweep was over before the second began");
    signal(&first, "-TERM");
    signal(&first, "-CONT");
    assert_eq!(first.wait().expect("the process ends").code(), Some(130));
    sweep(&scratch, &["status", "out"], 1);
}

#[test]
fn status_names_the_shards_that_lack_rows() {
    let scratch = suite(20);
    for shard in ["2/5", "4/5"] {
        into(&scratch, "out", &["--shard", shard]);
    }
    let file = "out/rows-4-of-5.jsonl";
    let text = scratch.read(file);
    let kept: Vec<&str> = text.lines().take(3).collect();
    scratch.write(file, &(kept.join("\n") + "\n"));
    let ran = sweep(&scratch, &["status", "out"], 1);
    assert!(ran.stdout.starts_with("6 of 20 cases have rows: "), "{ran:#?}");
    assert!(ran.stdout.contains("shard 4/5: 2 of 4 cases"), "{ran:#?}");
    assert!(ran.stdout.contains("not begun: 3 of 5 shards (1,3,5)"), "{ran:#?}");
    // A shard without cases.
    let ran = into(&scratch, "other", &["--shard", "21/30"]);
    assert!(ran.stdout.contains("0 of 0 cases have rows") && ran.stdout.contains("none"), "{ran:#?}");
}

#[test]
fn merged_tables_contain_the_rows_of_the_sweep() {
    let scratch = suite(4);
    into(&scratch, "out", &[]);
    let ran = sweep(&scratch, &["merge", "out", "-o", "rows.csv"], 0);
    assert!(ran.stdout.starts_with("4 rows in rows.csv: "), "{ran:#?}");
    let csv = scratch.read("rows.csv");
    let head = "case,variant,seed,outcome,points,max_points,message,at_s,sim_time_s,digest,key,noise,check.comes back,value.comes back,r1.x_mm\r\n";
    assert!(csv.starts_with(head), "{csv}");
    assert!(csv.contains("\"noise=none,seed=1\",noise=none,1,passed,1,1,,,"), "{csv}");
    assert_eq!(csv.lines().count(), 5);
    // The merge of two folders with equal rows contains each row once. If rows differ, the merge fails.
    into(&scratch, "again", &["--shard", "1/2"]);
    sweep(&scratch, &["merge", "again", "out", "-o", "both.csv"], 0);
    assert_eq!(scratch.read("both.csv"), csv);
    let ran = sweep(&scratch, &["merge", "again", "-o", "half.csv"], 0);
    assert!(ran.stderr.contains("2 of 4 cases of `a.suite.toml` have no row"), "{ran:#?}");
    let text = scratch.read("again/rows-1-of-2.jsonl");
    let digest = text.split("\"digest\":\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a digest");
    scratch.write("again/rows-1-of-2.jsonl", &text.replace(digest, &"0".repeat(digest.len())));
    let ran = sweep(&scratch, &["merge", "again", "out", "-o", "both.csv"], 2);
    for part in ["has two digests", digest, "again/rows-1-of-2.jsonl:2", "out/rows-1-of-1.jsonl:"] {
        assert!(ran.stderr.contains(part), "{part}: {ran:#?}");
    }
    scratch.write("again/rows-1-of-2.jsonl", &text.replace("\"points\":1.0", "\"points\":0.5"));
    let ran = sweep(&scratch, &["merge", "again", "out", "-o", "both.csv"], 2);
    assert!(ran.stderr.contains("has two results"), "{ran:#?}");
    assert_eq!(scratch.read("both.csv"), csv, "a table is written as a whole or not at all");
    sweep(&scratch, &["merge", "out", "-o", "rows.parquet"], 0);
    let parquet = std::fs::read(scratch.path().join("rows.parquet")).expect("a table");
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    let ran = sweep(&scratch, &["merge", "out", "-o", "rows.xlsx"], 2);
    assert!(ran.stderr.contains("expected NAME.csv, NAME.parquet or NAME.jsonl"), "{ran:#?}");
    let ran = sweep(&scratch, &["merge", "out", "-o", "out/rows-1-of-1.jsonl"], 2);
    assert!(ran.stderr.contains("would overwrite the input"), "{ran:#?}");
}

#[test]
fn cases_that_could_not_be_run_are_reported_and_run_again() {
    let scratch = suite(4);
    // A check whose program prints no verdict.
    scratch.write("judge.py", "1 / 0\n");
    let text = scratch.read("a.suite.toml") + "[[check]]\nname = \"way\"\nkind = \"script\"\nprogram = \"judge.py\"\n";
    scratch.write("a.suite.toml", &text);
    let ran = sweep(&scratch, &["a.suite.toml", "-o", "out"], 1);
    assert!(ran.stdout.contains(": 4 error, in ") && ran.stderr.contains("way: "), "{ran:#?}");
    let ran = sweep(&scratch, &["status", "out"], 1);
    assert!(
        ran.stdout.contains("4 of 4 cases have rows: 4 error") && ran.stdout.contains("shard 1/1: 0 of 4 cases"),
        "{ran:#?}"
    );
    scratch.write("judge.py", "import json\nprint(json.dumps({'passed': True, 'message': 'so be it'}))\n");
    // The same suite at another path.
    sweep(&scratch, &["./a.suite.toml", "-o", "out"], 0);
    let ran = sweep(&scratch, &["merge", "out", "-o", "rows.csv"], 0);
    assert!(ran.stdout.starts_with("4 rows in rows.csv: ") && !ran.stderr.contains("warning"), "{ran:#?}");
    let rows = rows(&scratch, "out");
    assert!(rows.len() == 4 && rows.iter().all(|row| row["outcome"] != "error"), "{rows:#?}");
}

#[test]
fn traces_are_kept() {
    let scratch = suite(12);
    let kept = |folder: &str| {
        let names = fs::read_dir(scratch.path().join(folder).join("traces")).expect("a folder");
        let mut names: Vec<String> =
            names.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    into(&scratch, "none", &[]);
    assert!(!scratch.path().join("none/traces").exists());
    for (folder, keep) in [("failed", "failed"), ("all", "all")] {
        into(&scratch, folder, &["--keep", keep]);
        assert_eq!(merged(&scratch, folder), merged(&scratch, "none"), "a trace changes no row");
        let rows = rows(&scratch, folder);
        let wanted = rows.iter().filter(|row| keep == "all" || row["outcome"] != "passed");
        let mut wanted: Vec<String> =
            wanted.map(|row| format!("{}.jsonl.zst", row["key"].as_str().expect("a key"))).collect();
        wanted.sort();
        assert!(!wanted.is_empty());
        assert_eq!(kept(folder), wanted);
    }
    let name = &kept("failed")[0];
    let files = [format!("failed/traces/{name}"), format!("all/traces/{name}")];
    let ran = scratch.eyesim(&["diff", &files[0], &files[1]]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}
