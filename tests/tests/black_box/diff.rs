//! `eyesim diff`: finds the first difference between two runs.

use tests::{Ran, Scratch, write_crowd};

/// Reads a PSD repeatedly while it drives.
const LOOK: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PSDHandle psd = PSDInit(PSD_FRONT);
    PSDStart(psd, TRUE);
    VWSetSpeed(vw, 0.1, 0.0);
    for (int i = 0; i < 40; i++) { OSWait(5); PSDGet(psd); }
    return 0;
}
"#;

/// Runs three robots and writes `NAME.jsonl` and `NAME.json`.
fn run(scratch: &Scratch, name: &str, args: &[&str]) {
    run_program(scratch, name, LOOK, args);
}

fn run_program(scratch: &Scratch, name: &str, program: &str, args: &[&str]) {
    let (trace, report) = (format!("{name}.jsonl"), format!("{name}.json"));
    scratch.write("look.c", program);
    let scene = write_crowd(scratch, 3, "look.c");
    let files = ["run", scene.to_str().expect("UTF-8"), "--trace", &trace, "--report", &report];
    let ran = scratch.eyesim(&[&files[..], args].concat());
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

fn diff(scratch: &Scratch, a: &str, b: &str) -> Ran {
    scratch.eyesim(&["diff", a, b])
}

#[test]
fn equal_runs_are_equal_for_any_number_of_workers() {
    let scratch = Scratch::new();
    run(&scratch, "a", &["--threads", "1"]);
    run(&scratch, "b", &["--threads", "2"]);
    let traces = diff(&scratch, "a.jsonl", "b.jsonl");
    assert_eq!((traces.code, traces.stdout.as_str()), (Some(0), "equal runs\n"), "{traces:#?}");
    let reports = diff(&scratch, "a.json", "b.json");
    assert_eq!(reports.code, Some(0), "{reports:#?}");
    assert!(reports.stdout.starts_with("equal runs: digest "), "{reports:#?}");
}

#[test]
fn one_bit_of_one_reading_is_named() {
    let scratch = Scratch::new();
    run(&scratch, "a", &[]);
    let text = scratch.read("a.jsonl");
    let is_reading = |line: &&str| line.contains("\"event\":\"distance\"") && line.contains("\"robot\":2");
    let line = text.lines().filter(is_reading).nth(7).expect("a reading of robot 2");
    let event: serde_json::Value = serde_json::from_str(line).expect("JSON");
    let value = event["distance_m"].as_f64().expect("a wall ahead");
    let changed = f64::from_bits(value.to_bits() ^ 1);
    let (old, new) = (format!("\"distance_m\":{value:?}"), format!("\"distance_m\":{changed:?}"));
    assert!(line.contains(&old), "{line}");
    scratch.write("b.jsonl", &text.replacen(line, &line.replace(&old, &new), 1));
    let ran = diff(&scratch, "a.jsonl", "b.jsonl");
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    let at = format!("the runs diverge at {:.6} s, ", event["t_s"].as_f64().expect("a time"));
    for part in [&at, ": r2\n", "`distance` differs in\n", &format!("distance_m: {value:?} in A, {changed:?} in B\n")] {
        assert!(ran.stdout.contains(part), "{part}: {}", ran.stdout);
    }
    assert!(!ran.stdout.contains("apart"), "no robot moved otherwise: {}", ran.stdout);
}

#[test]
fn runs_that_diverge_are_reported_with_their_cause_and_drawn() {
    let scratch = Scratch::new();
    run(&scratch, "a", &["--noise", "real"]);
    run(&scratch, "b", &["--noise", "real", "--seed", "7"]);
    let ran = scratch.eyesim(&["diff", "a.jsonl", "b.jsonl", "--plot", "paths.svg"]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stdout.starts_with("seed: 0 in A, 7 in B\n"), "{}", ran.stdout);
    assert!(ran.stdout.contains("the runs diverge at ") && ran.stdout.contains(" apart, at "), "{}", ran.stdout);
    assert!(scratch.read("paths.svg").contains("A: r3"));
    let reports = diff(&scratch, "a.json", "b.json");
    assert_eq!(reports.code, Some(1), "{reports:#?}");
    assert!(reports.stdout.contains("seed: 0 in A, 7 in B\n"), "{}", reports.stdout);
}

#[test]
fn a_longer_run_differs_and_a_truncated_trace_is_compared_up_to_its_end() {
    let scratch = Scratch::new();
    run(&scratch, "a", &[]);
    run(&scratch, "b", &["--until", "1"]);
    let shorter = diff(&scratch, "a.jsonl", "b.jsonl");
    assert_eq!(shorter.code, Some(1), "{shorter:#?}");
    assert!(shorter.stdout.contains("then in A: nothing more in this slot\n"), "{}", shorter.stdout);
    assert!(shorter.stdout.contains("then in B: {\"event\":\"program_ended\""), "{}", shorter.stdout);
    let text = scratch.read("a.jsonl");
    scratch.write("cut.jsonl", &text[..text.len() / 2]);
    let cut = diff(&scratch, "a.jsonl", "cut.jsonl");
    assert_eq!(cut.code, Some(0), "{cut:#?}");
    assert!(cut.stdout.starts_with("equal until ") && cut.stdout.ends_with(", where a trace breaks off\n"), "{cut:#?}");
}

#[test]
fn files_of_other_kinds_are_refused() {
    let scratch = Scratch::new();
    run(&scratch, "a", &[]);
    let refuses = |a: &str, b: &str, message: &str| {
        let ran = diff(&scratch, a, b);
        assert_eq!(ran.code, Some(2), "{ran:#?}");
        assert!(ran.stderr.contains(message), "{a} {b}: {}", ran.stderr);
    };
    refuses("a.json", "a.jsonl", "expected two traces or two reports");
    refuses("look.c", "a.jsonl", "`look.c` is not a report of a run, and `look.c` is not a trace");
    refuses("a.jsonl", "missing", "`missing`: No such file");
    refuses("/dev/zero", "a.jsonl", "`/dev/zero` is not a file");
}

#[test]
fn runs_of_different_slots_are_compared_by_their_positions() {
    let scratch = Scratch::new();
    run(&scratch, "a", &["--slot", "20"]);
    run(&scratch, "b", &["--slot", "50"]);
    let ran = diff(&scratch, "a.jsonl", "b.jsonl");
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stdout.starts_with("slot: 0.020 s in A, 0.050 s in B\n"), "{}", ran.stdout);
    assert!(ran.stdout.contains("only the positions of robots"), "{}", ran.stdout);
    assert!(!ran.stdout.contains("diverge") && !ran.stdout.contains("apart"), "{}", ran.stdout);
}

#[test]
fn robots_that_rest_at_the_common_ends_of_slots_are_compared() {
    let scratch = Scratch::new();
    let drive = |time: &str| {
        format!(
            "#include \"eyebot.h\"\nint main(void) {{\n    VWHandle vw = VWInit(VW_DRIVE, 1);\n    VWSetSpeed(vw, 0.1, 0.0);\n    \
             OSWait({time});\n    VWSetSpeed(vw, 0.0, 0.0);\n    OSWait(300);\n    return 0;\n}}\n"
        )
    };
    run_program(&scratch, "a", &drive("50"), &["--slot", "49"]);
    run_program(&scratch, "b", &drive("30"), &["--slot", "50"]);
    // The first common end is at 2.45 s.
    let ran = diff(&scratch, "a.jsonl", "b.jsonl");
    assert!(ran.stdout.contains("apart") && ran.stdout.contains("2.450 s"), "{}", ran.stdout);
}
