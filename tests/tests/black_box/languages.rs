//! docs/four-languages.md: the programs on the page equal the files, and all drive the same path.

use serde_json::Value;
use tests::{Scratch, number, root};

/// File names of the programs on the page.
const PROGRAMS: [&str; 4] = ["approach-robios6.c", "approach-robios7.c", "approach.py", "src/lib.rs"];

#[test]
fn the_page_shows_the_files() {
    let page = std::fs::read_to_string(root().join("docs/four-languages.md")).expect("the page");
    for program in PROGRAMS {
        let path = root().join("example-programs/approach").join(program);
        let text = std::fs::read_to_string(&path).expect("a program");
        // The page omits the unit test.
        let source = text.split("\n#[cfg(test)]").next().expect("a part");
        assert!(page.contains(&format!("\n{source}```\n")), "copy `{program}` to docs/four-languages.md");
    }
}

#[test]
fn four_languages_drive_one_path() {
    let scene = root().join("sims/approach.sim");
    let report = Scratch::new().report(scene.to_str().expect("UTF-8"), &[], 0);
    let robots = report["robots"].as_array().expect("robots");
    assert_eq!(robots.len(), PROGRAMS.len());
    let first = &robots[0];
    // The robot drives from x = 400 mm until a sensor 60 mm ahead of its centre is 300 mm from the wall of a 4 m room.
    // Then it drives an arc.
    let straight = 4.0 - 0.4 - 0.06 - 0.3;
    assert!((number(first, "path_m") - (straight + 0.4)).abs() < 1e-3, "{first:#}");
    for robot in robots {
        let lcd = |robot: &Value, row: usize| robot["lcd"][row].as_str().expect("text").trim_end().to_owned();
        assert_eq!(robot["outcome"], "finished", "{robot:#}");
        assert_eq!((lcd(robot, 0), lcd(robot, 1)), (lcd(first, 0), lcd(first, 1)), "{robot:#}");
        for field in ["odometry.x_m", "odometry.y_m", "odometry.phi_rad", "path_m"] {
            assert!((number(robot, field) - number(first, field)).abs() < 1e-3, "{field}: {robot:#}");
        }
    }
}
