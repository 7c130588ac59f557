//! The example programs behave in their scenes as documented.

use std::collections::VecDeque;
use std::f64::consts::PI;

use serde_json::Value;
use tests::{Scratch, number, root};

/// Path of a sample scene.
fn scene(name: &str) -> String {
    root().join("sims").join(name).to_str().expect("the checkout's path is text").to_owned()
}

/// Runs a sample scene and returns its robots, which must all have `outcome`.
fn run(name: &str, args: &[&str], outcome: &str) -> Vec<Value> {
    let report = Scratch::new().report(&scene(name), args, 0);
    let robots = report["robots"].as_array().expect("a report has robots").clone();
    for robot in &robots {
        assert_eq!(robot["outcome"], outcome, "{robot:#}");
    }
    robots
}

fn pose(robot: &Value) -> [f64; 3] {
    ["pose.x_m", "pose.y_m", "pose.phi_rad"].map(|path| number(robot, path))
}

fn contacts(robot: &Value) -> u64 {
    robot["contacts"].as_u64().expect("a count")
}

/// A line of the display, without surrounding blanks.
fn lcd(robot: &Value, row: usize) -> &str {
    robot["lcd"][row].as_str().expect("a line of text").trim()
}

/// The first number in a line of the display.
fn lcd_number(robot: &Value, row: usize) -> f64 {
    let word = lcd(robot, row).split_whitespace().find_map(|word| word.parse().ok());
    word.unwrap_or_else(|| panic!("a number in `{}`", lcd(robot, row)))
}

fn distance(a: [f64; 3], b: [f64; 2]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
}

#[test]
fn a_square_ends_where_it_started_whatever_the_slot() {
    let starts = [[1.0, 1.8, 0.0], [2.6, 1.8, 0.0]];
    let robots = run("square.sim", &[], "finished");
    for (robot, start) in robots.iter().zip(starts) {
        for (end, start) in pose(robot).into_iter().zip(start) {
            assert!((end - start).abs() < 1e-6, "{robot:#}");
        }
        assert!((number(robot, "path_m") - 1.6).abs() < 1e-6);
        assert_eq!(contacts(robot), 0);
    }
    for slot in ["1", "7.3", "50", "200"] {
        let same = run("square.sim", &["--slot", slot], "finished");
        for (robot, same) in robots.iter().zip(&same) {
            assert_eq!(pose(robot).map(f64::to_bits), pose(same).map(f64::to_bits), "slots of {slot} ms");
            assert_eq!(robot["odometry"], same["odometry"], "slots of {slot} ms");
        }
    }
}

#[test]
fn wall_followers_pass_the_course() {
    let scratch = Scratch::new();
    for program in ["follow-wall-c/follow-wall.c", "follow-wall"] {
        scratch.write(
            "course.sim",
            &format!(
                "world %sim%/worlds/corridor.wld\nrobi %sim%/robis/ring.robi %sim%/example-programs/{program} 400 500 0\n"
            ),
        );
        let report = scratch.report("course.sim", &["--until", "60"], 0);
        let robot = &report["robots"][0];
        assert_eq!(contacts(robot), 0, "{program}");
        // The path leads through the lower and the middle corridor into the upper one, at 12 m/min minus the time for
        // the turns.
        assert!(number(robot, "path_m") > 10.5, "{program}: {robot:#}");
        assert!(number(robot, "pose.y_m") > 2.4, "{program}: {robot:#}");
    }
    assert_eq!(contacts(&run("follow-wall.sim", &[], "finished")[0]), 0);
}

#[test]
fn left_hand_rule_reaches_the_goal() {
    let robot = &run("maze-left-hand.sim", &[], "finished")[0];
    assert!(distance(pose(robot), [3.5 * 0.36, 3.5 * 0.36]) < 0.01, "{robot:#}");
    assert_eq!(contacts(robot), 0);
    assert_eq!(lcd(robot, 1), "goal: 12 cells");
    // The robot starts looking up and ends looking left. Its pose is in the world frame, its odometry in the frame of
    // its start.
    assert!((number(robot, "pose.phi_rad").abs() - PI).abs() < 1e-6);
    assert!((number(robot, "odometry.phi_rad") - PI / 2.0).abs() < 1e-6);
    // It also reaches any other cell, with at most twice the steps of a path around all walls.
    for goal in ["6 6", "0 6", "6 0"] {
        let robot = &run("maze-left-hand.sim", &["--args", goal], "finished")[0];
        let cells: Vec<f64> = goal.split(' ').filter_map(|cell| cell.parse().ok()).collect();
        assert!(distance(pose(robot), [(cells[0] + 0.5) * 0.36, (cells[1] + 0.5) * 0.36]) < 0.01, "{goal}: {robot:#}");
        assert_eq!(contacts(robot), 0, "{goal}");
        assert!(number(robot, "virtual_time_s") < 2.0 * 96.0 * 3.0, "{goal}");
    }
}

/// Number of steps from the lower left cell to the nearest of the four middle cells of a maze, by breadth-first search
/// in its drawing.
fn shortest_way(maze: &str) -> usize {
    let mut rows: Vec<&[u8]> = maze.lines().map(str::as_bytes).collect();
    // The last line is the size of a cell; the first one is the upper border.
    rows.pop();
    let cells = rows.len() - 1;
    let is_open = |x: usize, y: usize, direction: usize| {
        // Row in the drawing and column of the cell. A `_` or a capital means a wall below the cell.
        let (row, column) = (cells - y, 2 * x + 1);
        match direction {
            0 => rows[row][column + 1] != b'|',
            1 => rows[row][column - 1] != b'|',
            2 => rows[row - 1][column] != b'_',
            _ => rows[row][column] != b'_' && !rows[row][column].is_ascii_uppercase(),
        }
    };
    let mut steps = vec![vec![None; cells]; cells];
    steps[0][0] = Some(0);
    let mut queue = VecDeque::from([(0, 0)]);
    while let Some((x, y)) = queue.pop_front() {
        let here: usize = steps[x][y].expect("queued cells have been reached");
        if [x, y].iter().all(|c| (cells / 2 - 1..=cells / 2).contains(c)) {
            return here;
        }
        for direction in (0..4).filter(|&direction| is_open(x, y, direction)) {
            let (x, y) = match direction {
                0 => (x + 1, y),
                1 => (x - 1, y),
                2 => (x, y + 1),
                _ => (x, y - 1),
            };
            if steps[x][y].is_none() {
                steps[x][y] = Some(here + 1);
                queue.push_back((x, y));
            }
        }
    }
    panic!("no way to the middle");
}

#[test]
fn the_micro_mouse_races_along_the_shortest_path() {
    let robot = &run("maze-flood-fill.sim", &[], "finished")[0];
    let is_in_the_middle = |coordinate: f64| {
        let cells = coordinate / 0.36 - 0.5;
        (cells - cells.round()).abs() * 0.36 < 0.01 && (7.0..=8.0).contains(&cells.round())
    };
    let [x, y, _] = pose(robot);
    assert!(is_in_the_middle(x) && is_in_the_middle(y), "{robot:#}");
    assert_eq!(contacts(robot), 0);
    let maze = std::fs::read_to_string(root().join("worlds/micromouse.maz")).expect("our maze");
    assert_eq!(lcd(robot, 2), format!("race: {} cells", shortest_way(&maze)));
    assert_eq!(lcd(robot, 6), "GOAL");
    // The way to the goal, the way back and the race consist of whole cells.
    let driven = number(robot, "path_m") / 0.36;
    let said = lcd_number(robot, 0) + lcd_number(robot, 1) + lcd_number(robot, 2);
    assert!((driven - said).abs() < 1e-3, "{driven} cells driven, {said} said");
}

#[test]
fn avoiders_drive_a_minute_without_a_contact() {
    for robot in run("avoid.sim", &["--until", "58"], "running") {
        assert_eq!(contacts(&robot), 0, "{robot:#}");
        assert!(number(&robot, "path_m") > 5.0, "{robot:#}");
    }
    // With other seeds there are at most two contacts: a robot may miss the end of a wall of 20 mm between its beams.
    let seeds = ["1", "2", "3", "4", "5", "6", "7"];
    let all: u64 = seeds
        .iter()
        .flat_map(|seed| run("avoid.sim", &["--until", "58", "--seed", seed], "running"))
        .map(|robot| contacts(&robot))
        .sum();
    assert!(all <= 2, "{all} contacts in 56 minutes of driving");
}

#[test]
fn the_car_parks_between_the_others() {
    let robot = &run("park.sim", &[], "finished")[0];
    assert_eq!(contacts(robot), 0);
    // The gap is from 1.7 m to 2.6 m. The axis of the street is at 0.58 m, 0.38 m to the left of the axis of the gap.
    let [x, y, phi] = pose(robot);
    assert!((x - 2.15).abs() < 0.03 && (y - 0.20).abs() < 1e-6 && phi.abs() < 1e-6, "{robot:#}");
    assert_eq!(lcd(robot, 0), "gap of 0.40 m");
    assert_eq!(lcd(robot, 2), "parked");
}

#[test]
fn mecanum_wheels_drive_a_square_without_turning() {
    let scratch = Scratch::new();
    let report = scratch.report(&scene("mecanum-square.sim"), &["--trace", "t.jsonl"], 0);
    let robot = &report["robots"][0];
    assert_eq!(robot["outcome"], "finished");
    let [x, y, _] = pose(robot);
    assert!(distance(pose(robot), [1.5, 1.5]) < 0.005, "{robot:#}");
    let trace = scratch.trace("t.jsonl");
    let poses: Vec<&Value> = trace.iter().filter(|line| line["event"] == "pose").collect();
    assert!(poses.iter().all(|line| number(line, "phi_rad") == 0.0), "it never turns");
    let far = poses.iter().any(|line| number(line, "x_m") > 1.99 && number(line, "y_m") > 1.99);
    assert!(far, "it has been to the opposite corner");
    // The odometry is exact to one encoder count, 0.08 mm.
    let words: Vec<f64> = lcd(robot, 3).split_whitespace().map(|word| word.parse().expect("a number")).collect();
    assert!((words[0] - (x - 1.5)).abs() < 5e-4 && (words[1] - (y - 1.5)).abs() < 5e-4, "{robot:#}");
}

#[test]
fn every_bump_is_detected() {
    let robot = &run("bounce.sim", &[], "finished")[0];
    assert!(contacts(robot) >= 4, "{robot:#}");
    assert_eq!(lcd_number(robot, 0), contacts(robot) as f64);
    // After an oblique contact the robot slides on, and its wheels slip by less than half of their speed, which is no
    // stall.
    let stalls = lcd_number(robot, 1);
    assert!(stalls >= 1.0 && stalls <= contacts(robot) as f64, "the wheels stall at steep bumps: {stalls}");
}

#[test]
fn bumps_into_robots_are_detected_too() {
    let robots = Scratch::new().report(&scene("demo.sim"), &["--until", "45"], 0);
    let feeler = &robots["robots"][3];
    assert!(contacts(feeler) > 0);
    assert_eq!(lcd_number(feeler, 0), contacts(feeler) as f64, "{feeler:#}");
}

#[test]
fn the_metronome_beats_and_obeys_its_keys() {
    let scratch = Scratch::new();
    let keys = ["--keys", "5:KEY2, 10:KEY1, 12:KEY4", "--trace", "t.jsonl"];
    let report = scratch.report(&scene("metronome.sim"), &keys, 0);
    let robot = &report["robots"][0];
    assert_eq!(lcd(robot, 2), "end");
    assert!((number(robot, "virtual_time_s") - 12.0).abs() < 0.1);
    let trace = scratch.trace("t.jsonl");
    let beats: Vec<f64> = trace.iter().filter(|line| line["event"] == "tone").map(|line| number(line, "t_s")).collect();
    assert_eq!(lcd_number(robot, 1), beats.len() as f64);
    // A beat every 0.5 s for 5 s, every 0.25 s for 5 s, and every 0.5 s for 2 s; each change restarts the beat.
    assert!((32..=34).contains(&beats.len()), "{beats:?}");
    let gaps: Vec<f64> = beats.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps[..8].iter().all(|gap| (gap - 0.5).abs() < 0.01), "{gaps:?}");
    assert!(gaps[12..24].iter().all(|gap| (gap - 0.25).abs() < 0.01), "{gaps:?}");
    assert_eq!(trace.iter().filter(|line| line["event"] == "key").count(), 3);
    let keys = "1:KEY2, 2:KEY2, 3:KEY2, 4:KEY2, 5:KEY2, 6:KEY2, 7:KEY2, 8:KEY4";
    let report = scratch.report(&scene("metronome.sim"), &["--keys", keys], 0);
    assert_eq!(lcd(&report["robots"][0], 0), "every 10 ms");
}

#[test]
fn the_controller_speeds_up_a_robot_with_lag() {
    let robot = &run("step-response.sim", &[], "finished")[0];
    // In open loop, 90 % of the speed takes 80 ms times ln 10 = 184 ms. Add less than one tick until the command takes
    // effect, and up to 10 ms, the period at which the program reads the speed.
    let open_loop = lcd_number(robot, 0);
    assert!((184.0..=210.0).contains(&open_loop), "{robot:#}");
    assert!(lcd_number(robot, 1) < 0.6 * open_loop, "{robot:#}");
    assert_eq!(lcd(robot, 2), "at 0.500 m");
    assert!(number(robot, "odometry.phi_rad").abs() < 1e-9);
}

#[test]
fn the_demo_moves_every_robot_and_draws_them() {
    let scratch = Scratch::new();
    let report = scratch.report(&scene("demo.sim"), &["--until", "45", "--plot", "p.svg"], 0);
    let plot = scratch.read("p.svg");
    for robot in report["robots"].as_array().expect("robots") {
        assert!(number(robot, "path_m") > 1.0, "{robot:#}");
        assert!(plot.contains(&format!("r{} ", robot["id"])), "the plot names {}", robot["id"]);
    }
    assert!(report["robots"].as_array().expect("robots").len() >= 6);
}

#[test]
fn all_scenes_are_free_of_mistakes() {
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("sims")).expect("a folder of scenes") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "sim" || extension == "toml") {
            let ran = Scratch::new().eyesim(&["check", "--strict", path.to_str().expect("text")]);
            assert_eq!(ran.code, Some(0), "{}: {ran:#?}", path.display());
            count += 1;
        }
    }
    assert!(count >= 10, "{count} scenes");
}
