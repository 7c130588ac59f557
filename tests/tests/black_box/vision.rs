//! The example programs with a camera behave in their scenes as documented, even with realistic noise.
#![allow(clippy::disallowed_methods, reason = "geometry by hand, compared within millimetres")]

use std::f64::consts::PI;
use std::thread;

use serde_json::Value;
use tests::{Scratch, number, root};

/// Path of a sample scene.
fn scene(name: &str) -> String {
    root().join("sims").join(name).to_str().expect("the checkout's path is text").to_owned()
}

fn place(body: &Value) -> [f64; 2] {
    ["pose.x_m", "pose.y_m"].map(|path| number(body, path))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

/// Calls `check` with each of `seeds`, on two threads.
fn for_seeds(seeds: std::ops::RangeInclusive<u32>, check: impl Fn(u32) + Sync) {
    thread::scope(|scope| {
        for part in 0..2 {
            let (check, seeds) = (&check, seeds.clone());
            let half = move || seeds.filter(|seed| seed % 2 == part).for_each(check);
            thread::Builder::new().name(format!("seeds {part}")).spawn_scoped(scope, half).expect("a thread");
        }
    });
}

/// Runs the ball follower from the start for this seed; it must come to the ball without kicking it.
#[track_caller]
fn assert_reaches_the_ball(program: &[&str], seed: u32) {
    let seed = seed.to_string();
    let args = [&["--noise", "real", "--seed", &seed], program].concat();
    let report = Scratch::new().report(&scene("follow-ball.scene.toml"), &args, 0);
    let (robot, ball) = (&report["robots"][0], &report["objects"][0]);
    assert_eq!(robot["outcome"], "finished", "seed {seed}: {robot:#}");
    // The bodies touch at a distance of 0.143 m. The program stops when the ball is 0.13 m from the camera, 0.062 m
    // ahead of the robot's centre.
    let gap = distance(place(robot), place(ball));
    assert!((0.143..0.24).contains(&gap), "seed {seed}: the ball is {gap} m away: {robot:#}");
    let start = [2.2, 1.7];
    assert!(distance(place(ball), start) < 0.02, "seed {seed}: the ball has moved: {ball:#}");
}

#[test]
fn the_ball_is_found_from_eight_starts() {
    for_seeds(1..=8, |seed| assert_reaches_the_ball(&[], seed));
}

#[test]
fn programs_in_rust_and_for_robios6_find_the_ball_too() {
    for program in ["follow-ball", "follow-ball-c/follow-ball-robios6.c"] {
        let program = format!("1={}/example-programs/{program}", root().display());
        for_seeds(21..=22, |seed| assert_reaches_the_ball(&["--program", &program], seed));
    }
}

/// Positions of robot 1 at the ends of the slots.
fn path(trace: &[Value]) -> Vec<[f64; 2]> {
    let poses = trace.iter().filter(|line| line["event"] == "pose" && line["robot"] == 1);
    poses.map(|pose| ["x_m", "y_m"].map(|key| number(pose, key))).collect()
}

/// Number of turns of a path around a point.
fn rounds(path: &[[f64; 2]], around: [f64; 2]) -> f64 {
    let bearing = |at: &[f64; 2]| (at[1] - around[1]).atan2(at[0] - around[0]);
    let steps = path.windows(2).map(|pair| (bearing(&pair[1]) - bearing(&pair[0]) + PI).rem_euclid(2.0 * PI) - PI);
    steps.sum::<f64>() / (2.0 * PI)
}

/// Runs a scene, in which robot 1 must go at least once around `middle`, and returns its path.
fn around(name: &str, middle: [f64; 2], args: &[&str]) -> Vec<[f64; 2]> {
    let scratch = Scratch::new();
    let report = scratch.report(&scene(name), &[&["--trace", "t.jsonl"], args].concat(), 0);
    assert_eq!(report["robots"][0]["outcome"], "finished", "{report:#}");
    assert_eq!(report["robots"][0]["contacts"], 0);
    let path = path(&scratch.trace("t.jsonl"));
    assert!(rounds(&path, middle) > 1.0, "{} rounds", rounds(&path, middle));
    path
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

#[test]
fn the_line_is_followed_once_around() {
    // The line, as sim-format/examples/textures.rs draws it.
    let line: Vec<[f64; 2]> = (0..500)
        .map(|step| {
            let (sin, cos) = (2.0 * PI * f64::from(step) / 500.0).sin_cos();
            [1.5 + 1.15 * cos, 1.176 + 0.62 * sin + 0.18 * (cos * cos - sin * sin)]
        })
        .collect();
    let off = |at: &[f64; 2]| line.iter().map(|point| distance(*point, *at)).fold(f64::INFINITY, f64::min);
    for args in [&[][..], &["--noise", "real"]] {
        let farthest = largest(around("follow-line.sim", [1.5, 1.1], args).iter().map(off));
        println!("{args:?}: at most {:.0} mm from the line", 1000.0 * farthest);
        assert!(farthest < 0.03, "{args:?}: {farthest} m from the line");
    }
}

#[test]
fn the_lane_is_kept_once_around() {
    // Distance from the middle of the right lane. It is 0.185 m outside the middle of the road, which is a rounded
    // rectangle.
    let off = |[x, y]: &[f64; 2]| {
        let (x, y) = ((x - 3.0).abs() - 1.3, (y - 2.0).abs() - 0.3);
        let from_corner = distance([x.max(0.0), y.max(0.0)], [0.0; 2]) + x.max(y).min(0.0);
        (from_corner - 0.9 - 0.185).abs()
    };
    for args in [&[][..], &["--noise", "real"]] {
        let farthest = largest(around("follow-lane.sim", [3.0, 2.0], args).iter().map(off));
        println!("{args:?}: at most {:.0} mm from the middle of the lane", 1000.0 * farthest);
        // The robot has a radius of 93 mm, so its whole body stays in a lane of 370 mm.
        assert!(farthest < 0.09, "{args:?}: {farthest} m from the middle of the lane");
    }
}

/// Output of robot 1, with times.
fn printed(trace: &[Value]) -> Vec<String> {
    let lines = trace.iter().filter(|line| line["event"] == "stdout" && line["robot"] == 1);
    lines.map(|line| line["text"].as_str().expect("a text").to_owned()).collect()
}

/// The numbers of a line of text.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

/// First time after `from_s` at which robot 2 is beyond x = `edge` in the direction of `sign`.
fn passes(trace: &[Value], edge: f64, sign: f64, from_s: f64) -> f64 {
    let mut poses = trace.iter().filter(|line| line["event"] == "pose" && line["robot"] == 2);
    let pose = poses.find(|pose| number(pose, "t_s") > from_s && sign * (number(pose, "x_m") - edge) > 0.0);
    number(pose.expect("it passes"), "t_s")
}

#[test]
fn motion_is_detected_at_its_time_and_position() {
    let scratch = Scratch::new();
    let path = scene("motion.sim");
    scratch.report(&path, &["--noise", "real", "--trace", "t.jsonl"], 0);
    let trace = scratch.trace("t.jsonl");
    let observations: Vec<Vec<f64>> = printed(&trace).iter().map(|line| numbers(line)).collect();
    assert_eq!(observations.len(), 2, "there and back: {observations:?}");
    // The camera is 1.14 m from the path and sees 30 degrees to either side. The radius of the passing robot is 0.09 m.
    let half_width = 1.14 / 3.0_f64.sqrt() + 0.09;
    let enters = passes(&trace, 2.0 - half_width, 1.0, 0.0);
    let returns = passes(&trace, 2.0 + half_width, -1.0, passes(&trace, 2.0 + half_width, 1.0, 0.0));
    for ([at, column, ..], truth, columns) in
        [(&observations[0], enters, 1.0..20.0), (&observations[1], returns, 60.0..81.0)].map(
            |(observations, truth, columns)| {
                (<[f64; 3]>::try_from(observations.as_slice()).expect("time, column, row"), truth, columns)
            },
        )
    {
        assert!((-0.1..0.8).contains(&(at - truth)), "seen at {at} s, came at {truth} s");
        assert!(columns.contains(&column), "column {column}");
    }
}

#[test]
fn noise_alone_is_not_detected_as_motion() {
    let scratch = Scratch::new();
    let sim = std::fs::read_to_string(scene("motion.sim")).expect("a scene");
    let watcher: Vec<&str> = sim.lines().filter(|line| !line.contains("passer-by")).collect();
    scratch.write("alone.sim", &watcher.join("\n"));
    scratch.report("alone.sim", &["--noise", "real", "--trace", "t.jsonl"], 0);
    assert_eq!(printed(&scratch.trace("t.jsonl")), Vec::<String>::new());
}

#[test]
fn each_robot_finds_the_ball_of_its_colour() {
    let run = |args: &[&str]| Scratch::new().report(&scene("own-balls.scene.toml"), args, 0);
    let report = run(&["--threads", "1"]);
    let (robots, balls) = (report["robots"].as_array().expect("robots"), report["objects"].as_array().expect("balls"));
    assert_eq!((robots.len(), balls.len()), (4, 4));
    for (robot, ball) in robots.iter().zip(balls) {
        let gap = distance(place(robot), place(ball));
        assert!((0.143..0.24).contains(&gap), "{gap} m: {robot:#}");
    }
    for threads in ["2", "4"] {
        assert_eq!(run(&["--threads", threads])["digest"], report["digest"], "{threads} threads");
    }
    assert_ne!(run(&["--noise", "real"])["digest"], report["digest"]);
}
