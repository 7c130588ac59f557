//! The example programs that communicate or have several tasks behave as documented.

use std::collections::BTreeMap;

use serde_json::Value;
use tests::{Scratch, number, root};

/// A run of a sample scene with these arguments; every robot's program must end.
struct SampleRun {
    robots: Vec<Value>,
    trace: Vec<Value>,
    digest: String,
}

fn run(name: &str, args: &[&str]) -> SampleRun {
    let scratch = Scratch::new();
    let scene = root().join("sims").join(name);
    let args = [&["--trace", "t.jsonl"], args].concat();
    let report = scratch.report(scene.to_str().expect("the checkout's path is text"), &args, 0);
    let robots = report["robots"].as_array().expect("a report has robots").clone();
    for robot in &robots {
        assert_eq!((&robot["outcome"], &robot["contacts"]), (&Value::from("finished"), &Value::from(0)), "{robot:#}");
    }
    let digest = report["digest"].as_str().expect("a digest").to_owned();
    SampleRun { robots, trace: scratch.trace("t.jsonl"), digest }
}

impl SampleRun {
    /// The events of this kind, in order.
    fn events(&self, kind: &str) -> impl Iterator<Item = &Value> {
        self.trace.iter().filter(move |line| line["event"] == kind)
    }

    /// Output of a robot.
    fn lines(&self, robot: u64) -> Vec<&str> {
        let lines = self.events("stdout").filter(|line| line["robot"] == robot);
        lines.map(|line| line["text"].as_str().expect("a text")).collect()
    }
}

fn whole(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("`{value}` is not a whole number"))
}

/// The numbers among the words of a text.
fn numbers(text: &str) -> Vec<u64> {
    text.split(' ').filter_map(|word| word.parse().ok()).collect()
}

/// Hop number in the data of a message of `token`; `None` if the message is not a token.
fn hop_of(data: &Value) -> Option<u64> {
    let bytes: Vec<u64> = data.as_array().expect("bytes").iter().map(whole).collect();
    (bytes[0] == u64::from(b'T')).then(|| bytes[1..].iter().rev().fold(0, |hop, byte| hop << 8 | byte))
}

#[test]
fn a_token_goes_round_ten_robots_a_thousand_times_and_none_is_lost() {
    let ran = run("token.scene.toml", &["--seed", "7007"]);
    assert_eq!(ran.robots.len(), 10);
    // Hop h goes from robot (h - 1) mod 10 + 1 to the next one, and no hop is skipped.
    let mut passed = 0;
    for line in ran.events("radio_received") {
        let Some(hop) = hop_of(&line["data"]) else { continue };
        assert_eq!(whole(&line["robot"]), hop % 10 + 1);
        assert_eq!(whole(&line["from"]), (hop - 1) % 10 + 1);
        assert!(hop <= passed + 1, "hop {hop} behind {passed}");
        passed = passed.max(hop);
    }
    assert_eq!(passed, 10_000);

    // The trace has exactly one fate of each message at its receiver.
    let mut fates: BTreeMap<(u64, u64), u64> = BTreeMap::new();
    let mut lost = 0;
    for kind in ["radio_arrived", "radio_lost"] {
        for line in ran.events(kind) {
            let earlier = fates.insert((whole(&line["from"]), whole(&line["message"])), whole(&line["robot"]));
            assert_eq!(earlier, None, "{line}");
            if kind == "radio_lost" {
                assert_eq!(line["cause"], "packet", "{line}");
                lost += 1;
            }
        }
    }
    let (mut sent, mut tokens) = (0, 0);
    for line in ran.events("radio_sent") {
        let fate = fates.get(&(whole(&line["robot"]), whole(&line["message"])));
        assert_eq!(fate.copied(), Some(whole(&line["to"])), "{line}");
        sent += 1;
        tokens += u64::from(hop_of(&line["data"]).is_some());
    }
    assert_eq!(fates.len(), sent);
    // One fifth of the messages is lost, within five standard deviations.
    let fraction = f64::from(lost) / sent as f64;
    assert!((fraction - 0.2).abs() < 5.0 * (0.2 * 0.8 / sent as f64).sqrt(), "{lost} of {sent} are lost");
    // Every further token of a hop is a repetition, which its robot has counted.
    let repeats: u64 = (1..=10).map(|robot| numbers(ran.lines(robot)[0])[1]).sum();
    assert_eq!(tokens, 10_000 + repeats);
    assert!((1..=10).all(|robot| numbers(ran.lines(robot)[0])[0] == 1000));
}

#[test]
fn a_convoy_keeps_to_the_trail_of_its_leader() {
    for seed in ["31", "415", "9265"] {
        let ran = run("convoy.scene.toml", &["--seed", seed]);
        assert!(ran.events("radio_lost").count() > 100, "a tenth of what 5 robots say is lost");
        // The figure of eight consists of two circles of 0.8 m radius.
        let off = |line: &Value| {
            let (x, y) = (number(line, "x_m"), number(line, "y_m") - 1.2);
            let off = |centre: f64| (((x - centre).powi(2) + y * y).sqrt() - 0.8).abs();
            off(1.2).min(off(2.8))
        };
        let farthest = ran.events("pose").map(off).fold(0.0, f64::max);
        assert!(farthest < 0.03, "seed {seed}: {farthest} m off the trail");
        // At the end all robots stand one behind the other on the left circle.
        let positions: Vec<[f64; 2]> =
            ran.robots.iter().map(|robot| ["pose.x_m", "pose.y_m"].map(|path| number(robot, path))).collect();
        for pair in positions.windows(2) {
            let gap = ((pair[0][0] - pair[1][0]).powi(2) + (pair[0][1] - pair[1][1]).powi(2)).sqrt();
            assert!((0.30..0.40).contains(&gap), "seed {seed}: a gap of {gap} m");
        }
        assert!((positions[0][0] - 0.4).abs() < 1e-3 && (positions[0][1] - 1.2).abs() < 1e-3, "{positions:?}");
    }
}

/// Walls that the three robots of `shared-map` must find, from the drawing of the maze. For each lane from the lowest
/// up: the walls at the left (above) and at the right (below) of its cells.
fn lanes(maze: &str) -> Vec<String> {
    let rows: Vec<&[u8]> = maze.lines().map(str::as_bytes).collect();
    let is_below = |row: usize, column: usize| rows[row][2 * column + 1] == b'_';
    let lane = |row: usize| {
        let mark = |column: usize| match (is_below(row - 1, column), is_below(row, column)) {
            (true, true) => '=',
            (true, false) => '\'',
            (false, true) => '.',
            (false, false) => '-',
        };
        (0..8).map(mark).collect::<String>()
    };
    (1..=3).rev().enumerate().map(|(index, row)| format!("lane {index} {}", lane(row))).collect()
}

#[test]
fn three_robots_agree_on_a_map() {
    let maze = std::fs::read_to_string(root().join("worlds/lanes.maz")).expect("our maze");
    let expected = lanes(&maze);
    let (mut lost, mut garbled, mut told_garbled) = (0, 0, 0);
    for seed in ["27", "182", "8182", "84590"] {
        let ran = run("shared-map.scene.toml", &["--seed", seed]);
        for robot in 1..=3 {
            let lines = ran.lines(robot);
            assert_eq!(lines[..3], expected, "seed {seed}, robot {robot}");
            told_garbled += numbers(lines[3])[1];
        }
        lost += ran.events("radio_lost").filter(|line| line["cause"] == "packet").count();
        garbled += ran.events("radio_arrived").filter(|line| line["bit_errors"] != 0).count() as u64;
    }
    assert!(lost > 100 && garbled > 20, "{lost} lost, {garbled} garbled");
    assert_eq!(told_garbled, garbled, "the checksum finds them all");
}

#[test]
fn a_control_task_uses_every_measurement_of_the_sensing_task() {
    let ran = run("sense-steer.sim", &[]);
    for (robot, report) in (1..).zip(&ran.robots) {
        let counts = numbers(ran.lines(robot)[0]);
        assert!(counts[0].abs_diff(1000) < 30, "a measurement every 60 ms: {counts:?}");
        assert!(counts[0].abs_diff(counts[1]) <= 1, "{counts:?}");
        assert!(number(report, "path_m") > 8.0, "{report:#}");
    }
    let in_processes = run("sense-steer.sim", &["--exec", "process"]);
    assert_eq!(in_processes.digest, ran.digest);
}

#[test]
fn the_classic_tasks_print_the_same_interleaving_every_time() {
    let ran = run("multi-tasking.sim", &[]);
    let preemptive = "master: ready
task 3: looks 1
task 1: step 1
task 2: step 1
task 1: step 2
task 2: step 2
task 1: step 3
task 3: looks 2
task 2: step 3
task 1: step 4
task 2: step 4
task 1: step 5
task 3: looks 3
task 2: step 5
task 1: step 6
task 2: step 6
master: done";
    let cooperative = "master: ready
task 1: step 1, sum 1
task 2: step 1, sum 3
task 1: step 2, sum 4
task 2: step 2, sum 6
task 1: step 3, sum 7
task 2: step 3, sum 9
task 1: step 4, sum 10
task 2: step 4, sum 12
task 1: done
task 2: done
task 3: step 1, sum 15
task 3: step 2, sum 18
task 3: step 3, sum 21
task 3: step 4, sum 24
task 3: done
master: done, sum 24";
    assert_eq!(ran.lines(1).join("\n"), preemptive);
    assert_eq!(ran.lines(2).join("\n"), cooperative);
    for slot in ["1", "7.3", "200"] {
        for threads in ["1", "2"] {
            let again = run("multi-tasking.sim", &["--slot", slot, "--threads", threads]);
            assert_eq!(
                [1, 2].map(|robot| again.lines(robot)),
                [1, 2].map(|robot| ran.lines(robot)),
                "slots of {slot} ms"
            );
        }
    }
    let again = run("multi-tasking.sim", &["--threads", "1"]);
    assert_eq!(again.digest, ran.digest);
}
