//! The example programs of RoBIOS-7 behave in their scenes as documented.

use serde_json::Value;
use tests::{Scratch, number, root};

/// Runs a sample scene, in which every program must finish.
fn run(scene: &str, args: &[&str]) -> Value {
    let path = root().join("sims").join(scene);
    let report = Scratch::new().report(path.to_str().expect("UTF-8"), args, 0);
    for robot in report["robots"].as_array().expect("robots") {
        assert_eq!(robot["outcome"], "finished", "{robot:#}");
    }
    report
}

fn place(robot: &Value) -> [f64; 2] {
    ["pose.x_m", "pose.y_m"].map(|path| number(robot, path))
}

#[track_caller]
fn assert_near(robot: &Value, goal: [f64; 2], within: f64) {
    let [x, y] = place(robot);
    let [dx, dy] = [x - goal[0], y - goal[1]];
    assert!(dx * dx + dy * dy < within * within, "{robot:#}");
    assert_eq!(robot["contacts"], 0, "{robot:#}");
}

#[test]
fn the_quad_tree_leads_through_the_flat() {
    let report = run("quad-tree.sim", &[]);
    let robot = &report["robots"][0];
    assert_near(robot, [3.6, 2.6], 0.03);
    // The straight line to the goal is 3.9 m. The way around the walls, along the centres of squares, is longer, but
    // less than twice as long.
    assert!((4.0..7.0).contains(&number(robot, "path_m")), "{robot:#}");
}

#[test]
fn an_unreachable_goal_is_reported() {
    // 6 m is beyond the grid of 5.12 m.
    for (scene, goal) in [("quad-tree.sim", "5000 5000"), ("brushfire.sim", "6000 6000"), ("brushfire.sim", "-10 500")]
    {
        let path = root().join("sims").join(scene);
        let report = Scratch::new().report(path.to_str().expect("UTF-8"), &["--args", &format!("1:{goal}")], 1);
        assert_eq!(report["robots"][0]["outcome"], "failed", "{report:#}");
        assert!(report["robots"][0]["lcd"].to_string().contains("no way"), "{report:#}");
    }
}

#[test]
fn brushfire_leads_through_the_maze() {
    let report = run("brushfire.sim", &[]);
    assert_near(&report["robots"][0], [1.26, 1.26], 0.03);
    let other = run("brushfire.sim", &["--args", "2340 2340"]);
    assert_near(&other["robots"][0], [2.34, 2.34], 0.03);
}

#[test]
fn distbug_gets_around_obstacles_that_it_does_not_know() {
    let report = run("distbug.sim", &[]);
    let robot = &report["robots"][0];
    assert_near(robot, [3.6, 1.5], 0.05);
    assert!(robot["lcd"].to_string().contains("goal after"), "{robot:#}");
    assert_eq!(robot["contacts"], 0, "{robot:#}");
    // This goal is inside a wall of the pocket (worlds/bug.wld). The robot drives once around the pocket and then
    // prints that there is no way.
    let path = root().join("sims/distbug.sim");
    let report = Scratch::new().report(path.to_str().expect("UTF-8"), &["--args", "2350 -550"], 1);
    assert!(report["robots"][0]["lcd"].to_string().contains("no way"), "{report:#}");
}

#[test]
fn the_laser_scanner_leads_around_the_course() {
    let report = run("follow-wall-lidar.sim", &[]);
    let robot = &report["robots"][0];
    assert_eq!(robot["contacts"], 0, "{robot:#}");
    // The robot drives through three corridors and back.
    assert!((15.0..40.0).contains(&number(robot, "path_m")), "{robot:#}");
}

#[test]
fn the_swarm_collects_every_ball() {
    let report = run("collect.sim", &[]);
    let objects = report["objects"].as_array().expect("objects");
    assert_eq!(objects.len(), 12);
    for object in objects {
        assert!(number(object, "pose.x_m") < 0.9 && number(object, "pose.y_m") < 0.9, "{object:#}");
    }
    let collected = |robot: &Value| -> u32 {
        let line =
            robot["lcd"][0].as_str().expect("text").trim().strip_prefix("collected ").expect("a count").to_owned();
        line.parse().expect("a number")
    };
    let counts: Vec<u32> = report["robots"].as_array().expect("robots").iter().map(collected).collect();
    assert_eq!(counts.iter().sum::<u32>(), 12, "{counts:?}");
    assert!(counts.iter().all(|count| *count > 0), "all of them work: {counts:?}");
}
