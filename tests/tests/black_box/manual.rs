//! Programs for EyeSim VR as users write them from its manual alone, in C and in Python: mowing in lanes, wall
//! following, DistBug and lane following. S4 and LabBot run them unchanged. True poses show whether they drive as
//! intended.
#![allow(clippy::disallowed_methods, reason = "distances and angles, compared within centimetres")]

use std::f64::consts::TAU;
use std::process::Command;

use tests::{Scratch, root};

/// Radii of S4 and LabBot in metres, as in their robi files.
const ROBOTS: [(&str, f64); 2] = [("S4", 0.093), ("LabBot", 0.130)];

/// True poses `[x, y, phi]` of a program of `fixtures/manual` on a robot, every 50 ms. `line` is the robot's line after
/// its type.
fn drive(program: &str, extension: &str, world: &str, robot: &str, line: &str) -> Vec<[f64; 3]> {
    let scratch = Scratch::new();
    let fixture =
        |name: &str| std::fs::read_to_string(root().join("tests/fixtures/manual").join(name)).expect("a fixture");
    let source = format!("{program}.{extension}");
    scratch.write(&source, &fixture(&source));
    scratch.write(world, &fixture(world));
    road().save(scratch.path().join("road.png")).expect("a picture");
    // EyeSim VR runs the compiled program; the simulator compiles the source file beside it.
    let run = if extension == "c" { format!("{program}.x") } else { source };
    scratch.write("my.sim", &format!("# {program}\nworld {world}\nsettings VIS TRACE\n{robot} {line} {run}\n"));
    scratch.report("my.sim", &["--until", "240", "--trace", "t.jsonl"], 0);
    let trace = scratch.trace("t.jsonl");
    let field = |event: &serde_json::Value, name: &str| event[name].as_f64().expect("a number");
    let poses = trace.iter().filter(|event| event["event"] == "pose" && event["robot"] == 1);
    poses.map(|event| ["x_m", "y_m", "phi_rad"].map(|name| field(event, name))).collect()
}

/// Runs a program in each language on each robot, and passes the poses and the robot's radius to a check.
fn on_each(program: &str, world: &str, line: &str, check: impl Fn(&[[f64; 3]], f64)) {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_python = Command::new(&python).arg("--version").output().is_ok_and(|out| out.status.success());
    for (robot, radius) in ROBOTS {
        for extension in ["c", "py"] {
            if extension == "py" && !has_python {
                println!("skipped {program}.py: there is no `{python}`");
                continue;
            }
            println!("{program}.{extension} on {robot}");
            check(&drive(program, extension, world, robot, line), radius);
        }
    }
}

/// Distance from the middle of the road, in metres. The middle is a rectangle of 2.1 m by 1.2 m with rounded corners,
/// around (1.5, 1.0).
fn off_road(x: f64, y: f64) -> f64 {
    let (dx, dy) = ((x - 1.5).abs() - 0.6, (y - 1.0).abs() - 0.15);
    dx.max(0.0).hypot(dy.max(0.0)) + dx.max(dy).min(0.0) - 0.45
}

/// The floor of `road.wld`, 5 mm per pixel: a dark road, 0.3 m wide with its white edge lines of 20 mm, on grass.
fn road() -> image::RgbImage {
    image::RgbImage::from_fn(600, 400, |column, row| {
        let off = off_road((f64::from(column) + 0.5) * 0.005, (f64::from(row) + 0.5) * 0.005).abs();
        image::Rgb(match off {
            0.0..0.13 => [70, 70, 70],
            0.13..0.15 => [255, 255, 255],
            _ => [60, 140, 60],
        })
    })
}

/// Distance from a point to the nearest of these segments, in metres.
fn to_walls([x, y, _]: [f64; 3], corners: &[[f64; 2]]) -> f64 {
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    let distances = ends.map(|(a, b)| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let along = (((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (x - a[0] - along * dx).hypot(y - a[1] - along * dy)
    });
    distances.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_lawn_is_mowed_in_lanes() {
    on_each("lawn", "box.wld", "300 300 90", |poses, radius| {
        // Squares of 50 mm that the robot's body covered, among those that it can reach from its corner.
        let mut squares = 0;
        let mut missed = Vec::new();
        for (column, row) in (0..40).flat_map(|column| (0..40).map(move |row| (column, row))) {
            let (x, y) = (f64::from(column) * 0.05 + 0.025, f64::from(row) * 0.05 + 0.025);
            if !(0.25..1.85).contains(&x) || !(0.25..1.75).contains(&y) {
                continue;
            }
            squares += 1;
            if !poses.iter().any(|pose| (pose[0] - x).hypot(pose[1] - y) <= radius) {
                missed.push((x, y));
            }
        }
        assert!(missed.is_empty(), "{} of {squares} squares are not mowed: {missed:?}", missed.len());
        let mut lanes: Vec<i64> = poses
            .iter()
            .filter(|pose| (0.8..1.2).contains(&pose[1]))
            .map(|pose| (pose[0] * 100.0).round() as i64)
            .collect();
        lanes.dedup();
        let length = poses.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum::<f64>();
        assert!((11..=12).contains(&lanes.len()), "lanes at {lanes:?} cm");
        assert!((16.0..22.0).contains(&length), "{length} m: mowed twice, or not at all");
    });
}

#[test]
fn the_wall_is_followed_all_round() {
    let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.5], [2.0, 1.5], [2.0, 3.0], [0.0, 3.0]];
    on_each("wall", "rooms.wld", "600 600 90", |poses, radius| {
        let start = poses.iter().position(|&pose| to_walls(pose, &corners) < 0.35).expect("the wall is reached");
        for pose in &poses[start..] {
            let distance = to_walls(*pose, &corners);
            assert!((radius..0.45).contains(&distance), "{distance} m from the wall at {pose:?}");
        }
        for corner in corners {
            let is_near = |pose: &[f64; 3]| (pose[0] - corner[0]).hypot(pose[1] - corner[1]) < 0.55;
            assert!(poses[start..].iter().any(is_near), "never near the corner {corner:?}");
        }
        let (first, last) = (poses[start], poses.last().expect("a pose"));
        assert!((first[0] - last[0]).hypot(first[1] - last[1]) < 0.4, "ends at {last:?}, began at {first:?}");
    });
}

#[test]
fn distbug_goes_round_two_obstacles_to_its_goal() {
    on_each("distbug", "obstacles.wld", "500 1000 0", |poses, _| {
        let [x, y, _] = *poses.last().expect("a pose");
        // LabBot touches the boxes and slides along them, which makes its odometry wrong by some centimetres.
        assert!((x - 3.5).hypot(y - 1.0) < 0.15, "ends at {x}, {y}");
        for box_x in [1.4, 2.6] {
            let beside = poses.iter().filter(|pose| (pose[0] - box_x).abs() < 0.05);
            assert!(beside.clone().count() > 0 && beside.clone().all(|pose| pose[1] < 0.9), "passes x = {box_x} m");
        }
    });
}

#[test]
fn the_lane_is_kept_for_a_lap() {
    on_each("lane", "road.wld", "1000 400 0", |poses, _| {
        for [x, y, _] in poses {
            let off = off_road(*x, *y);
            assert!(off.abs() < 0.13, "{off} m from the road's middle at {x}, {y}");
        }
        let bearings: Vec<f64> = poses.iter().map(|pose| (pose[1] - 1.0).atan2(pose[0] - 1.5)).collect();
        let turned: f64 =
            bearings.windows(2).map(|pair| (pair[1] - pair[0] + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0).sum();
        assert!(turned > TAU, "{} of a lap", turned / TAU);
    });
}
