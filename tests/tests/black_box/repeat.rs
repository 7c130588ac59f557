//! User interventions in a run: their effect, their record, and repetitions of runs from their traces.

use serde_json::{Value, json};
use tests::{Ran, Scratch, number, write_scene};

/// Writes a trace that contains only interventions, each at a time in seconds.
fn write_interventions(scratch: &Scratch, name: &str, actions: &[(f64, Value)]) {
    let header = json!({"event": "header", "schema": 1, "eyesim_version": env!("CARGO_PKG_VERSION"), "seed": 0, "slot_us": 50_000, "robots": []});
    let line = |(t_s, action): &(f64, Value)| {
        json!({"t_s": t_s, "event": "intervention", "action": action}).to_string() + "\n"
    };
    let lines: String = actions.iter().map(line).collect();
    scratch.write(name, &format!("{header}\n{lines}"));
}

/// Runs `sim` with the interventions `actions`; writes `trace.jsonl` and returns the report.
fn run(scratch: &Scratch, sim: &str, actions: &[(f64, Value)], args: &[&str], code: i32) -> Value {
    write_interventions(scratch, "interventions.jsonl", actions);
    let all = [&["--repeat", "interventions.jsonl", "--trace", "trace.jsonl"][..], args].concat();
    scratch.report(sim, &all, code)
}

fn verify(scratch: &Scratch, trace: &str, args: &[&str]) -> Ran {
    scratch.eyesim(&[&["replay", trace, "--verify"][..], args].concat())
}

/// Repeats the last run from its trace and asserts that the results are equal.
fn assert_same_again(scratch: &Scratch, report: &Value, args: &[&str]) {
    let ran = verify(scratch, "trace.jsonl", args);
    let digest = report["digest"].as_str().expect("a digest");
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), &*format!("the same digest: {digest}\n")), "{ran:#?}");
    assert_eq!(ran.stderr, "");
}

/// The events of this kind in the trace.
fn events(scratch: &Scratch, kind: &str) -> Vec<Value> {
    scratch.trace("trace.jsonl").into_iter().filter(|line| line["event"] == kind).collect()
}

fn place_robot(robot: u32, x_m: f64, y_m: f64, phi_rad: f64) -> Value {
    json!({"do": "place_robot", "robot": robot, "x_m": x_m, "y_m": y_m, "phi_rad": phi_rad})
}

fn set_noise(robot: Option<u32>, parameter: &str, value: f64) -> Value {
    json!({"do": "set_noise", "robot": robot, "parameter": parameter, "value": value})
}

fn switch(robot: u32, sensor: &str, on: bool) -> Value {
    json!({"do": "switch_sensor", "robot": robot, "sensor": sensor, "on": on})
}

fn press(robot: u32, key: &str) -> Value {
    json!({"do": "press", "robot": robot, "key": key})
}

const TWICE: &str = r#"
#include "eyebot.h"
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    VWDriveStraight(vw, 1.0, 0.2);
    VWDriveWait(vw);
    VWDriveStraight(vw, 0.5, 0.5);
    VWDriveWait(vw);
    return 0;
}
"#;

#[test]
fn a_placed_robot_continues_from_its_new_pose() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    let actions = [(1.0, place_robot(1, 2.0, 2.5, std::f64::consts::FRAC_PI_2))];
    let mut poses = Vec::new();
    for args in [&[][..], &["--slot", "10"], &["--slot", "1"], &["--exec", "process"], &["--speed", "50"]] {
        let report = run(&scratch, "scene.sim", &actions, args, 0);
        let robot = &report["robots"][0];
        // The drive in progress ends at once where the robot is placed. The next drive covers 0.5 m along y.
        let (x, y) = (number(robot, "pose.x_m"), number(robot, "pose.y_m"));
        assert!((x - 2.0).abs() < 1e-9 && (y - 3.0).abs() < 1e-9, "{robot:#}");
        // The intervention does not affect odometry, which measures 0.2 m and 0.5 m, within the distance driven during
        // a call.
        assert!((number(robot, "odometry.x_m") - 0.7).abs() < 1e-3, "{robot:#}");
        assert!((number(robot, "virtual_time_s") - 2.0).abs() < 0.01, "{robot:#}");
        let [placed] = &events(&scratch, "placed")[..] else { panic!("one robot is placed once") };
        assert_eq!((placed["t_s"].as_f64(), placed["by"].as_u64()), (Some(1.0), Some(0)));
        let [intervention] = &events(&scratch, "intervention")[..] else { panic!("one intervention") };
        assert_eq!(*intervention, json!({"t_s": 1.0, "seq": 0, "event": "intervention", "action": actions[0].1}));
        assert_same_again(&scratch, &report, &[]);
        poses.push(robot["pose"].clone());
    }
    assert!(poses.iter().all(|pose| *pose == poses[0]), "the same bits: {poses:#?}");
}

#[test]
fn a_key_press_by_a_user_wakes_the_waiting_program() {
    let scratch = Scratch::new();
    scratch.write("key.c", "#include \"eyebot.h\"\nint main(void) { KEYWait(KEY2); KEYGet(); return 0; }\n");
    write_scene(&scratch, &["key.c", "key.c"]);
    let actions = [(0.05, press(2, "KEY2")), (3.0, press(1, "KEY1")), (3.0, press(1, "key2")), (4.5, press(1, "KEY4"))];
    let report = run(&scratch, "scene.sim", &actions, &[], 1);
    let outcomes: Vec<_> = report["robots"].as_array().expect("robots").iter().map(|it| &it["outcome"]).collect();
    assert_eq!(outcomes, ["finished", "waiting"]);
    let keys: Vec<_> =
        events(&scratch, "key").iter().map(|it| (it["robot"].clone(), it["key"].clone(), it["t_s"].clone())).collect();
    assert_eq!(
        keys,
        [
            (json!(2), json!("KEY2"), json!(0.05)),
            (json!(1), json!("KEY2"), json!(3.0)),
            (json!(1), json!("KEY4"), json!(4.5))
        ]
    );
    for args in [&["--threads", "1"][..], &["--threads", "2"]] {
        assert_same_again(&scratch, &report, args);
    }
}

#[test]
fn remote_keys_and_touches_reach_programs_of_robios_7() {
    let scratch = Scratch::new();
    let program = "#include \"eyebot.h\"\nint main() { int x, y; int key = IRTVGet(); KEYGetXY(&x, &y);\n\
                   LCDPrintf(\"%d %d %d\", key == IRTV_OK, x, y); return 0; }\n";
    scratch.write("remote.c", program);
    write_scene(&scratch, &["remote.c"]);
    let actions = [(1.0, press(1, "IRTV_OK")), (2.0, press(1, "TOUCH(12,34)"))];
    let report = run(&scratch, "scene.sim", &actions, &["--api", "7"], 0);
    let line = report["robots"][0]["lcd"][0].as_str().expect("a line");
    assert_eq!(line.trim_end(), "1 12 34");
    assert_same_again(&scratch, &report, &[]);
}

#[test]
fn errors_begin_and_end_when_a_user_sets_them() {
    let scratch = Scratch::new();
    let drive = "#include \"eyebot.h\"\nint main(void) { VWHandle vw = VWInit(VW_DRIVE, 1); VWSetSpeed(vw, 0.2, 0); OSWait(300);\n\
                 VWSetSpeed(vw, 0, 0); OSWait(10); return 0; }\n";
    scratch.write("drive.c", drive);
    write_scene(&scratch, &["drive.c", "drive.c"]);
    let exact = run(&scratch, "scene.sim", &[], &[], 0);
    let slip =
        [(1.0, set_noise(Some(1), "drive.slip_percent", 10.0)), (2.0, set_noise(None, "drive.slip_percent", 0.0))];
    let report = run(&scratch, "scene.sim", &slip, &[], 0);
    let x = |report: &Value, robot: usize| number(&report["robots"][robot], "pose.x_m");
    // For one second the robot drives at 0.9 times 0.2 m/s.
    assert!((x(&exact, 0) - x(&report, 0) - 0.02).abs() < 1e-9, "{} {}", x(&exact, 0), x(&report, 0));
    assert_eq!(x(&exact, 1), x(&report, 1), "the other one has none");
    assert_same_again(&scratch, &report, &[]);
    let fine = run(&scratch, "scene.sim", &slip, &["--slot", "5"], 0);
    assert_eq!(fine["robots"], report["robots"], "the same bits for other slots");
}

const SENSE: &str = r#"
#include "eyebot.h"
int main(void) {
    PSDHandle psd = PSDInit(PSD_FRONT);
    QuadHandle quad = QUADInit(QUAD_LEFT);
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PSDStart(psd, TRUE);
    VWSetSpeed(vw, 0.1, 0);
    for (int i = 0; i < 8; i++) {
        OSWait(50);
        PSDGet(psd);
        QUADRead(quad);
    }
    return 0;
}
"#;

#[test]
fn a_sensor_that_is_switched_off_measures_and_counts_nothing() {
    let scratch = Scratch::new();
    scratch.write("sense.c", SENSE);
    write_scene(&scratch, &[]);
    scratch.write("scene.sim", "world room.wld\nrobi bot.robi sense.c 3300 2000 0\n");
    let read = |kind: &str, field: &str| -> Vec<Option<f64>> {
        events(&scratch, kind).iter().map(|line| line[field].as_f64()).collect()
    };
    run(&scratch, "scene.sim", &[], &[], 0);
    let (distances, ticks) = (read("distance", "distance_m"), read("reading", "value"));
    assert!(distances.iter().all(Option::is_some) && distances.len() == 8, "{distances:?}");
    let off = [
        (1.2, switch(1, "PSD_FRONT", false)),
        (1.2, switch(1, "QUAD_LEFT", false)),
        (1.3, switch(1, "QUAD_LEFT", false)),
        (2.2, switch(1, "PSD_FRONT", true)),
        (2.2, switch(1, "QUAD_LEFT", true)),
    ];
    let report = run(&scratch, "scene.sim", &off, &[], 0);
    let expected: Vec<_> = (0..8).map(|i| if (2..4).contains(&i) { None } else { distances[i] }).collect();
    assert_eq!(read("distance", "distance_m"), expected);
    let found = read("reading", "value");
    let [before, after] = [&ticks, &found].map(|list| list.iter().map(|it| it.expect("ticks")).collect::<Vec<_>>());
    assert_eq!(after[..2], before[..2]);
    assert_eq!(after[2], after[3], "it stands");
    // The encoder misses the counts of one second, rounded to whole counts.
    let per_second = (before[7] - before[5]) / 1.0;
    assert!((4..8).all(|i| (before[i] - after[i] - per_second).abs() <= 2.0), "{before:?} {after:?}");
    assert_same_again(&scratch, &report, &[]);
}

#[test]
fn an_object_that_is_put_elsewhere_is_seen_there() {
    let scratch = Scratch::new();
    let look = "#include \"eyebot.h\"\nint main(void) { PSDHandle psd = PSDInit(PSD_FRONT); PSDStart(psd, TRUE);\n\
                for (int i = 0; i < 4; i++) { OSWait(50); LCDPrintf(\"%d \", PSDGet(psd)); } return 0; }\n";
    scratch.write("look.c", look);
    write_scene(&scratch, &["look.c"]);
    scratch
        .write("box.esObj", "name Box\nmass 1 0 50 0\ncollider box 0 50 0 100 100 100\nfriction 0.5\nrestitution 0\n");
    scratch.write("box.sim", "world room.wld\nobject box.esObj\nBox 3000 3000 0\nrobi bot.robi look.c 400 400 0\n");
    let action = |x_m: f64| json!({"do": "place_object", "object": 1, "x_m": x_m, "y_m": 0.4, "phi_rad": 0.0});
    let report = run(&scratch, "box.sim", &[(0.7, action(0.7)), (1.2, action(0.9))], &[], 0);
    // The robot's centre is at 400 mm and the sensor 60 mm ahead of it. The near side of the box is 50 mm before the
    // middle of the box.
    let line = report["robots"][0]["lcd"][0].as_str().expect("a line");
    assert_eq!(line.split_whitespace().collect::<Vec<_>>(), ["9999", "190", "390", "390"]);
    assert_eq!(number(&report["objects"][0], "pose.x_m"), 0.9);
    let placements = events(&scratch, "object_placed");
    assert_eq!(
        placements.iter().map(|it| (it["t_s"].as_f64(), it["by"].as_u64())).collect::<Vec<_>>(),
        [(Some(0.7), Some(0)), (Some(1.2), Some(0))]
    );
    assert_same_again(&scratch, &report, &[]);
}

#[test]
fn a_user_ends_the_run() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    let report = run(&scratch, "scene.sim", &[(1.5, json!({"do": "end"}))], &[], 130);
    assert_eq!((report["sim_time_s"].as_f64(), &report["robots"][0]["outcome"]), (Some(1.5), &json!("interrupted")));
    assert!((number(&report["robots"][0], "pose.x_m") - 0.7).abs() < 1e-3);
    assert_eq!(events(&scratch, "intervention").len(), 1);
    assert_same_again(&scratch, &report, &[]);
    let at_once = run(&scratch, "scene.sim", &[(0.0, json!({"do": "end"}))], &[], 130);
    assert_eq!(at_once["sim_time_s"].as_f64(), Some(0.0));
    assert_same_again(&scratch, &at_once, &[]);
}

#[test]
fn impossible_interventions_are_refused_without_effect() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    let plain = scratch.report("scene.sim", &[], 0);
    let refused = [
        (press(2, "KEY1"), "there is no robot 2"),
        (press(0, "KEY1"), "there is no robot 0"),
        (press(1, "KEY5"), "`KEY5` is not a key"),
        (place_robot(1, 1e300, 0.0, 0.0), "is not a valid pose"),
        (place_robot(1, 0.0, 0.0, 1e7), "is not a valid pose"),
        (json!({"do": "place_object", "object": 1, "x_m": 0, "y_m": 0, "phi_rad": 0}), "there is no movable object 1"),
        (set_noise(None, "psd.sigma", 1.0), "has no number `psd.sigma`"),
        (set_noise(Some(1), "radio.packet_loss", 2.0), "cannot be 2"),
        (set_noise(Some(4_294_967_295), "radio.packet_loss", 0.5), "there is no robot 4294967295"),
        (
            switch(1, "PSD_BACK", false),
            "robot 1 has no sensor `PSD_BACK`: it has `PSD_FRONT`, `QUAD_LEFT`, `QUAD_RIGHT`",
        ),
    ];
    let actions: Vec<_> = refused.iter().map(|(action, _)| (1.0, action.clone())).collect();
    write_interventions(&scratch, "interventions.jsonl", &actions);
    let ran = scratch.eyesim(&[
        "run",
        "scene.sim",
        "--repeat",
        "interventions.jsonl",
        "--trace",
        "trace.jsonl",
        "--report",
        "report.json",
    ]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let lines: Vec<_> = ran.stderr.lines().filter(|line| line.starts_with("--repeat: ")).collect();
    assert_eq!(lines.len(), refused.len(), "{ran:#?}");
    for (line, (action, why)) in lines.iter().zip(&refused) {
        assert!(line.contains(why), "{action}: {line}");
    }
    assert!(events(&scratch, "intervention").is_empty());
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
    assert_eq!(report["digest"], plain["digest"], "nothing has happened");
    // An intervention after the end of the run has no effect either.
    let late = run(&scratch, "scene.sim", &[(5.0, press(1, "KEY1"))], &["--until", "3"], 0);
    assert!(events(&scratch, "intervention").is_empty());
    assert_eq!(late["sim_time_s"].as_f64(), Some(3.0));
    // An empty list of interventions changes nothing.
    assert_eq!(run(&scratch, "scene.sim", &[], &[], 0)["digest"], plain["digest"]);
}

const BUSY: &str = r#"
#include "eyebot.h"
int main(void) {
    PSDHandle psd = PSDInit(PSD_FRONT);
    QuadHandle quad = QUADInit(QUAD_LEFT);
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PSDStart(psd, TRUE);
    for (int i = 0; i < 1000; i++) {
        int mm = PSDGet(psd);
        if (mm < 300) VWDriveTurn(vw, 1.0 + 0.01 * (OSGetCount() % 7), 2.0);
        else VWDriveStraight(vw, 0.2, 0.4);
        if (KEYRead() == KEY1) VWDriveWait(vw);
        LCDPrintf("%d %d\n", mm, QUADRead(quad));
        OSWait(7 + i % 3);
    }
    return 0;
}
"#;

/// Linear congruential generator of numbers below a bound; it uses the high bits.
fn numbers(seed: u64) -> impl FnMut(u32) -> u32 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1;
    move |bound| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(bound)) as u32
    }
}

/// Thirty random interventions within 40 s, at the starts of slots of 50 ms.
fn random_interventions(seed: u64) -> Vec<(f64, Value)> {
    let mut below = numbers(seed);
    let mut actions: Vec<(f64, Value)> = (0..30)
        .map(|_| {
            let t_s = f64::from(below(800)) * 0.05;
            let (robot, position) = (1 + below(3), [(); 3].map(|()| f64::from(below(1000)) * 1e-3));
            let [x_m, y_m, phi_rad] = [0.2 + 3.6 * position[0], 0.2 + 3.6 * position[1], 7.0 * position[2]];
            let action = match below(6) {
                0 => press(robot, ["KEY1", "KEY4", "TOUCH(10,10)", "IRTV_OK"][below(4) as usize]),
                1 => place_robot(robot, x_m, y_m, phi_rad),
                2 => json!({"do": "place_object", "object": 1, "x_m": x_m, "y_m": y_m, "phi_rad": phi_rad}),
                3 => set_noise((below(2) == 0).then_some(robot), "psd.sigma_mm", 20.0 * position[0]),
                4 => set_noise(
                    Some(robot),
                    ["drive.slip_percent", "drive.v_sigma_percent", "odometry.v_sigma_mm_s"][below(3) as usize],
                    9.0 * position[1],
                ),
                _ => switch(robot, ["PSD_FRONT", "QUAD_LEFT"][below(2) as usize], below(2) == 0),
            };
            // Rounded to the microsecond, like times in a trace.
            ((t_s * 1e6).round() / 1e6, action)
        })
        .collect();
    actions.sort_by(|a, b| a.0.total_cmp(&b.0));
    actions
}

#[test]
fn thirty_interventions_of_all_kinds_repeat_to_the_same_digest() {
    let scratch = Scratch::new();
    scratch.write("busy.c", BUSY);
    write_scene(&scratch, &[]);
    scratch.write(
        "box.esObj",
        "name Box\nmass 0.3 0 50 0\ncollider box 0 50 0 100 100 100\nfriction 0.5\nrestitution 0.2\n",
    );
    scratch.write(
        "busy.sim",
        "world room.wld\nobject box.esObj\nBox 2000 2000 0\nrobi bot.robi busy.c 400 400 0\nrobi bot.robi busy.c 2400 400 90\n\
         robi bot.robi busy.c 1400 2400 180\n",
    );
    let plain = scratch.report("busy.sim", &["--until", "45"], 0)["digest"].clone();
    for seed in 1..=4_u64 {
        let interventions = random_interventions(seed);
        let args = ["--until", "45", "--seed", "3", "--noise", "mild"];
        let args = if seed % 2 == 0 { &args[..] } else { &args[..4] };
        let report = run(&scratch, "busy.sim", &interventions, args, 0);
        assert_eq!(events(&scratch, "intervention").len(), 30, "seed {seed}");
        assert_ne!(report["digest"], plain);
        assert_same_again(&scratch, &report, &["--threads", "1"]);
        assert_same_again(&scratch, &report, &["--threads", "2"]);
        // The trace of the repeated run serves as a list of interventions for another repetition.
        std::fs::rename(scratch.path().join("trace.jsonl"), scratch.path().join("first.jsonl")).expect("a trace");
        let all = [&["--repeat", "first.jsonl", "--exec", "process"][..], args].concat();
        assert_eq!(scratch.report("busy.sim", &all, 0)["digest"], report["digest"], "seed {seed}");
    }
}

#[test]
fn runs_that_diverge_are_distinguished_by_the_first_slot() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    let report =
        run(&scratch, "scene.sim", &[(1.0, place_robot(1, 2.0, 2.0, 0.0))], &["--noise", "mild", "--slot", "20"], 0);
    assert_same_again(&scratch, &report, &[]);
    let trace = scratch.read("trace.jsonl");

    // Without the intervention, the slot that begins with it differs.
    let without: String =
        trace.lines().filter(|line| !line.contains("\"intervention\"")).map(|line| format!("{line}\n")).collect();
    scratch.write("without.jsonl", &without);
    let ran = verify(&scratch, "without.jsonl", &[]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stdout.starts_with("the runs diverge in the slot that ends at 1.02"), "{ran:#?}");

    // Only the existing part of a truncated trace is compared.
    let half = &trace[..trace.len() / 2];
    scratch.write("half.jsonl", half);
    let ran = verify(&scratch, "half.jsonl", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(
        ran.stdout.starts_with("the same digest until ") && ran.stdout.ends_with("where the trace was cut off\n"),
        "{ran:#?}"
    );

    // The digests of an earlier version cannot be compared.
    scratch.write("old.jsonl", &trace.replace("\"digest_version\":2,", ""));
    let ran = verify(&scratch, "old.jsonl", &[]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(
        ran.stderr.contains("the digests of `old.jsonl` have version 1, those of this eyesim version 2"),
        "{ran:#?}"
    );

    // In another working folder, eyesim finds the scene beside the trace.
    let elsewhere = Scratch::new();
    let path = scratch.path().join("trace.jsonl");
    let ran = elsewhere.eyesim(&["replay", path.to_str().expect("text"), "--verify"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");

    // The message names a file that has changed.
    scratch.write("twice.c", &TWICE.replace("0.5, 0.5", "0.4, 0.5"));
    let ran = verify(&scratch, "trace.jsonl", &[]);
    assert_eq!(ran.code, Some(1), "{ran:#?}");
    assert!(ran.stderr.ends_with("`twice.c` has changed since the trace was recorded\n"), "{ran:#?}");
    std::fs::remove_file(scratch.path().join("scene.sim")).expect("it was there");
    let ran = verify(&scratch, "trace.jsonl", &[]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("there is no `scene.sim`, the scene of this trace"), "{ran:#?}");
}

#[test]
fn a_file_that_is_not_a_trace_is_reported_before_anything_runs() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    scratch.write("empty.jsonl", "");
    for (trace, why) in [
        ("empty.jsonl", "is not a trace: it is empty"),
        ("scene.sim", "its first line is not JSON"),
        ("none.jsonl", "cannot read the trace"),
    ] {
        for args in [&["replay", trace, "--verify"][..], &["run", "scene.sim", "--repeat", trace]] {
            let ran = scratch.eyesim(args);
            assert_eq!(ran.code, Some(2), "{ran:#?}");
            assert!(ran.stderr.contains(why), "{args:?}: {ran:#?}");
        }
    }
    write_interventions(&scratch, "interventions.jsonl", &[]);
    let ran = verify(&scratch, "interventions.jsonl", &[]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("has no arguments to repeat the run"), "{ran:#?}");
    let ran =
        scratch.eyesim(&["run", "scene.sim", "--repeat", "interventions.jsonl", "--trace", "interventions.jsonl"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    assert!(ran.stderr.contains("would overwrite"), "{ran:#?}");
}

#[test]
fn compressed_and_filtered_traces_repeat_a_run() {
    let scratch = Scratch::new();
    scratch.write("twice.c", TWICE);
    write_scene(&scratch, &["twice.c"]);
    let actions = [(1.0, place_robot(1, 2.0, 2.5, 0.0))];
    let report = run(&scratch, "scene.sim", &actions, &[], 0);
    let digest = report["digest"].as_str().expect("a digest");
    let write = |interventions: &str, args: &[&str]| {
        let repeated = scratch.report("scene.sim", &[&["--repeat", interventions][..], args].concat(), 0);
        assert_eq!(repeated["digest"], digest, "{args:?}");
    };
    write("interventions.jsonl", &["--trace", "whole.jsonl.zst"]);
    let bytes = |name: &str| std::fs::read(scratch.path().join(name)).expect("a file");
    assert!(bytes("whole.jsonl.zst").len() < bytes("trace.jsonl").len());
    let diff = scratch.eyesim(&["diff", "trace.jsonl", "whole.jsonl.zst"]);
    assert_eq!((diff.code, diff.stdout.as_str()), (Some(0), "equal runs\n"), "{diff:#?}");
    write("whole.jsonl.zst", &[]);
    let verified = verify(&scratch, "whole.jsonl.zst", &[]);
    assert_eq!((verified.code, verified.stderr.as_str()), (Some(0), ""), "{verified:#?}");
    assert!(verified.stdout.contains(digest), "{verified:#?}");
    let html = scratch.eyesim(&["replay", "whole.jsonl.zst", "--html", "whole.html"]);
    assert_eq!(html.code, Some(0), "{html:#?}");

    write("interventions.jsonl", &["--trace", "few.jsonl", "--trace-only", "contact, program_started"]);
    let lines = scratch.trace("few.jsonl");
    let kinds: std::collections::BTreeSet<&str> = lines.iter().filter_map(|line| line["event"].as_str()).collect();
    assert_eq!(
        kinds.into_iter().collect::<Vec<_>>(),
        ["end", "header", "intervention", "program_ended", "program_started", "slot"]
    );
    assert_eq!(lines[0]["only"], json!(["contact", "program_started"]));
    write("few.jsonl", &[]);
    let verified = verify(&scratch, "few.jsonl", &[]);
    assert_eq!(verified.code, Some(0), "{verified:#?}");
    assert!(verified.stdout.contains(digest), "{verified:#?}");
    assert!(
        verified.stderr.contains("only the events that `--trace-only contact,program_started` selected"),
        "{verified:#?}"
    );
    let diff = scratch.eyesim(&["diff", "trace.jsonl", "few.jsonl"]);
    assert_eq!(diff.code, Some(2), "{diff:#?}");
    assert!(diff.stderr.contains("all kinds of events in A, `contact,program_started` in B"), "{diff:#?}");
}
