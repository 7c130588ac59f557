use serde_json::json;
use sim_core::RobotId;
use sim_core::record::Kind;
use sim_core::spec::{CheckKind, CountLimits, ExpectedOutput};
use sim_core::time::Time;

use super::metric::judge;
use super::prints::Search;
use super::tally::Count;
use super::wording;

/// Returns true if the search in these lines succeeds, and the explanation of its result.
fn search(expected: &ExpectedOutput, lines: &str) -> (bool, String) {
    let mut search = Search::new(expected);
    lines.lines().for_each(|line| _ = search.take(line));
    (search.is_found(), search.explain(RobotId(1), "printed"))
}

fn numbers(rows: &[&[f64]], tolerance: f64) -> ExpectedOutput {
    ExpectedOutput::Numbers { rows: rows.iter().map(|row| row.to_vec()).collect(), tolerance }
}

#[test]
fn patterns_match_whole_lines() {
    for (pattern, line, is_match) in [
        ("goal", "goal", true),
        ("goal", "goal!", false),
        ("goal*", "goal!", true),
        ("*goal", "the goal", true),
        ("*goal", "the goal!", false),
        ("x=* y=*", "x=1 y=2", true),
        ("x=* y=*", "y=2 x=1", false),
        ("a*a", "a", false),
        ("*ab*ab*", "abab", true),
        ("*ab*ab*", "aab", false),
    ] {
        assert_eq!(search(&ExpectedOutput::Pattern(pattern.into()), line).0, is_match, "{pattern} {line}");
    }
}

#[test]
fn grids_are_found_between_other_lines_and_differences_are_named() {
    let grid = numbers(&[&[0.0, 1.0, 2.0], &[1.0, 2.0, 3.0]], 0.0);
    assert!(search(&grid, "distances\n7 7 7\n[0, 1, 2]\n\n[1, 2, 3]\nready").0);
    assert!(search(&grid, "row 0: 0 1 2\nrow 1: 1 2 3\n").0, "a number before the row is allowed");
    let (is_found, why) = search(&grid, "0 1 2\n1 9 3\n");
    assert_eq!((is_found, why.as_str()), (false, "row 2, number 2: r1 printed 9, not 2"));
    assert_eq!(search(&grid, "0 1 2\n1 2\n").1, "row 2, r1 printed 2 numbers, not 3");
    assert_eq!(search(&grid, "").1, "r1 printed nothing");
    assert_eq!(search(&grid, "hello\n").1, "r1 printed no 2 rows of numbers in one line");
}

#[test]
fn numbers_have_a_tolerance() {
    let one = numbers(&[&[0.3]], 0.1);
    assert!(search(&one, "about 0.4 m").0 && search(&one, "x=0.2").0 && !search(&one, "0.41").0);
    assert!(!search(&numbers(&[&[1.0]], 0.0), "nan inf x1 1e5 1.0.0").0);
    assert!(search(&numbers(&[&[-1e-3]], 0.0), "v=-1e-3.").0);
}

#[test]
fn too_many_events_are_not_called_late() {
    let by = Some(Time::from_millis(60_000));
    let kind = |max| CheckKind::Event { robot: None, event: Kind::Beep, count: CountLimits { min: 1, max }, by };
    // Beeps at 0 s and at 100 s.
    let count = Count { number: 2, at: Some(100.0), ..Count::default() };
    assert_eq!(wording::of_count(&kind(Some(1)), &count), "2 times, not 1 to 1 times, too often since 100.000 s");
    let count = Count { number: 1, at: Some(100.0), ..Count::default() };
    assert_eq!(wording::of_count(&kind(Some(1)), &count), "`beep` only at 100.000 s, not by 60 s");
    assert!(!count.is_met(&kind(None)));
}

#[test]
fn numbers_are_found_by_path_and_points_are_partial() {
    let report = json!({ "robots": [{ "path_m": 2.5, "reason": null, "lcd": ["a"] }], "sim_time_s": 10.0 });
    let passed = |path: &str, min, max| judge(&report, path, [min, max], None).fraction == 1.0;
    assert!(passed("robots[0].path_m", Some(2.5), Some(2.5)) && passed("sim_time_s", None, Some(10.0)));
    assert!(!passed("robots[0].path_m", Some(2.6), None) && !passed("robots[0].path_m", None, Some(2.4)));
    for (full, zero, fraction) in [(3.0, 5.0, 1.0), (1.0, 4.0, 0.5), (1.0, 2.0, 0.0), (5.0, 0.0, 0.5)] {
        assert_eq!(judge(&report, "robots[0].path_m", [None; 2], Some((full, zero))).fraction, fraction);
    }
    for (path, why) in [
        ("robot", "the report has no `robot`; it has robots, sim_time_s"),
        ("robots[1].path_m", "`robots` has 1 entries, counted from 0"),
        ("robots[0].path", "`robots[0]` has no `path`; it has lcd, path_m, reason"),
        ("robots[0", "`robots[0` has no `]`"),
        ("robots[-1]", "`-1` in `robots[-1]` is not an index from 0"),
        ("robots[0]x", "`robots[0]x`: expected `.` or `[` after `robots[0]`"),
        ("robots[0].reason", "`robots[0].reason` has no value in this run"),
        ("robots[0].lcd[0]", "`robots[0].lcd[0]` is the text `a`, not a number"),
        ("sim_time_s.x", "`sim_time_s` has no parts"),
    ] {
        let verdict = judge(&report, path, [None; 2], None);
        assert_eq!((verdict.fraction, verdict.message.as_str()), (0.0, why));
    }
}
