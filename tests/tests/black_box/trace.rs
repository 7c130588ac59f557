//! The file of a trace: as lines and as a table, on full devices, in pipes, and at every end of a run.

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};

use tests::{Ran, Scratch, write_scene};

/// A folder with two robots that drive, read and print, and then run `end`.
fn scene(end: &str) -> Scratch {
    let scratch = Scratch::new();
    let source = format!(
        "#include <stdio.h>\n#include \"eyebot.h\"\nint main(void) {{\n\
         VWHandle vw = VWInit(VW_DRIVE, 1);\nPSDHandle psd = PSDInit(PSD_FRONT);\nPSDStart(psd, TRUE);\n\
         VWSetSpeed(vw, 0.1, 0.2);\nfor (int i = 0; i < 40; i++) {{ OSWait(5); PSDGet(psd); puts(\"\\\"line\\\" \\xc3\\xb6\"); }}\n\
         puts(\"ready\"); fflush(stdout);\n{end}\n}}\n"
    );
    scratch.write("prog.c", &source);
    write_scene(&scratch, &["prog.c", "prog.c"]);
    scratch
}

fn run(scratch: &Scratch, trace: &str, code: i32) -> Ran {
    let ran = scratch.eyesim(&["run", "scene.sim", "--until", "20", "--trace", trace]);
    assert_eq!(ran.code, Some(code), "{trace}: {ran:#?}");
    ran
}

/// Asserts that two traces are complete and have the same events.
fn assert_equal(scratch: &Scratch, a: &str, b: &str) {
    let ran = scratch.eyesim(&["diff", a, b]);
    assert_eq!((ran.code, ran.stdout.lines().last()), (Some(0), Some("equal runs")), "{a}, {b}: {ran:#?}");
}

#[test]
fn traces_as_tables_and_as_lines_are_equal() {
    let scratch = scene("return 0;");
    for name in ["t.jsonl", "trace", "t.jsonl.zst", "t.parquet", "ta ble \u{f6}'\".parquet"] {
        run(&scratch, name, 0);
        assert_equal(&scratch, "t.jsonl", name);
    }
    for args in [
        &["replay", "t.parquet", "--verify"][..],
        &["replay", "t.parquet", "--html", "t.html"],
        &["run", "scene.sim", "--repeat", "t.parquet"],
        &["run", "scene.sim", "--trace", "p.jsonl", "--trace-only", "poses"],
        &["run", "scene.sim", "--trace", "p.parquet", "--trace-only", "poses"],
    ] {
        let ran = scratch.eyesim(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {ran:#?}");
    }
    assert_equal(&scratch, "p.jsonl", "p.parquet");
}

#[test]
fn a_full_device_is_named() {
    let scratch = scene("return 0;");
    for name in ["full", "full.jsonl.zst", "full.parquet"] {
        std::os::unix::fs::symlink("/dev/full", scratch.path().join(name)).expect("a link");
        let ran = run(&scratch, name, 2);
        assert!(ran.stderr.contains(&format!("cannot write the trace `{name}`: No space left on device")), "{ran:#?}");
    }
    let ran = run(&scratch, "/proc/none.parquet", 2);
    assert!(ran.stderr.contains("--trace `/proc/none.parquet` cannot be written: "), "{ran:#?}");
}

#[test]
fn a_pipe_takes_a_table_and_its_closing_ends_the_run() {
    for name in ["t.jsonl", "t.parquet"] {
        // More than a pipe holds.
        let scratch = scene("for (int i = 0; i < 300; i++) { OSWait(5); printf(\"%0200d\\n\", i); }\nreturn 0;");
        assert!(Command::new("mkfifo").arg(scratch.path().join(name)).status().expect("mkfifo").success());
        let reader = |program: &str, trace: &str| {
            let script = format!("{program} < '{name}' > '{trace}'");
            Command::new("sh").args(["-c", &script]).current_dir(scratch.path()).spawn().expect("sh starts")
        };
        let mut copy = reader("cat", "copy");
        run(&scratch, name, 0);
        assert!(copy.wait().expect("cat ends").success());
        assert_equal(&scratch, "copy", "copy");
        let mut start = reader("head -c 5000", "start");
        let ran = run(&scratch, name, 2);
        assert!(ran.stderr.contains(&format!("cannot write the trace `{name}`: Broken pipe")), "{ran:#?}");
        start.wait().expect("head ends");
    }
}

#[test]
fn the_microphone_of_robios_6_is_in_the_trace() {
    let scratch = scene("return AUCaptureMic() != 512;");
    run(&scratch, "t.jsonl", 0);
    let is_reading = |line: &&serde_json::Value| line["device"] == "microphone" && line["robot"] == 1;
    let trace = scratch.trace("t.jsonl");
    let values: Vec<_> = trace.iter().filter(is_reading).map(|line| line["value"].as_i64()).collect();
    assert_eq!(values, [Some(512)]);
}

#[test]
fn a_signal_ends_the_wait_for_the_reader_of_a_pipe() {
    let scratch = scene("return 0;");
    assert!(Command::new("mkfifo").arg(scratch.path().join("fifo")).status().expect("mkfifo").success());
    let mut child = scratch
        .command(&["run", "scene.sim", "--trace", "t.jsonl", "--record", "fifo"])
        .stdout(Stdio::null())
        .spawn()
        .expect("eyesim starts");
    // The trace is created before the recording.
    while !scratch.path().join("t.jsonl").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    // SAFETY: kill takes no pointer; the child has not been waited for, so its process id is still valid.
    unsafe { libc::kill(child.id().cast_signed(), libc::SIGTERM) };
    assert_eq!(child.wait().expect("eyesim ends").code(), Some(130));
}

#[test]
fn a_trace_is_complete_at_every_end_of_a_run() {
    for (end, code) in
        [("for (;;) OSWait(5);", 130), ("*(volatile int *)8 = 0;", 1), ("return 3;", 1), ("for (;;) ;", 1)]
    {
        for name in ["t.jsonl", "t.parquet"] {
            let scratch = scene(end);
            let args = ["run", "scene.sim", "--until", "1e9", "--timeout", "1", "--trace", name];
            let mut child =
                scratch.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("eyesim starts");
            let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
            let mut line = String::new();
            while !line.contains("ready") {
                line.clear();
                assert!(output.read_line(&mut line).expect("text") > 0, "no `ready`");
            }
            if code == 130 {
                // SAFETY: kill takes no pointer; the child has not been waited for, so its process id is still valid.
                unsafe { libc::kill(child.id().cast_signed(), libc::SIGINT) };
            }
            std::io::copy(&mut output, &mut std::io::sink()).expect("a pipe");
            let ran = Ran::from(child.wait_with_output().expect("eyesim ends"));
            assert_eq!(ran.code, Some(code), "{end}: {ran:#?}");
            assert_equal(&scratch, name, name);
        }
    }
}
